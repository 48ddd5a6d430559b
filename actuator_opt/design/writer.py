"""Write a design as YAML so that reading it again gives the same numbers, bit for bit.

If the design was read from a text, only changed values are replaced, so comments, units and layout
are kept. A text that cannot be edited in this way is rewritten. The start file of `init` is a
complete, commented design; every value has its unit.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any, NamedTuple

from ..base import quantities, units
from ..base.errors import InputError
from ..base.quantities import Quantity
from ..joints.kinds import JOINTS
from ..metrics import METRICS
from ..seals import o_ring
from ..seals.kinds import TYPES
from . import layup
from .build import build, to_tree
from .choice_list import quantity_of_choice
from .kinds import Boolean, Fraction, Section, Text
from .model import Design
from .paths import resolve
from .reader import FileSource, LoadedDesign
from .structure import Loc, child, child_at, entries, number_of, value_at
from .yaml_source import Document, parse

_PLAIN = re.compile(r"[^\W\d_][\w .()/+%-]*(?<! )")
_WORDS = frozenset(("y", "n", "yes", "no", "on", "off", "true", "false", "null", "none"))


def scalar(text: str) -> str:
    """Write a text as a YAML scalar that every YAML parser reads as this text.

    >>> scalar("robot knee"), scalar("no"), scalar("a: b")
    ('robot knee', "'no'", "'a: b'")
    """
    if _PLAIN.fullmatch(text) and text.lower() not in _WORDS:
        return text
    if text.isprintable():
        return "'" + text.replace("'", "''") + "'"
    return json.dumps(text, ensure_ascii=True)


def exact_text(value: float, quantity: Quantity | None, unit: str | None = None) -> str:
    """Shortest text with a unit that reads back as exactly `value` (SI).

    >>> exact_text(0.025, quantities.INPUTS["bore"])
    '25 mm'
    """
    if quantity is None or quantity.dimension == "count":
        return repr(int(value)) if value == int(value) else repr(value)
    share = quantity.name == "fraction"  # a position without "%" is a length
    for name in dict.fromkeys((unit, quantity.unit, quantity.si_unit)):
        if name is None or (share and not name):
            continue
        display_unit = units.unit(name, quantity.dimension) if name else units.Unit("", "", 1.0)
        for number in _candidates(value, display_unit):
            if display_unit.text_to_si(number) == value:
                return f"{number} {name}".rstrip()
    return f"{100 * value!r} %" if share else f"{value!r} {quantity.si_unit}".rstrip()


def _candidates(value: float, unit: units.Unit) -> Iterator[str]:
    """Yield texts in a unit for an SI value, shortest first; last, texts of neighbouring floats."""
    low = high = unit.from_si(value)
    for digits in (6, 9, 12, 15, 16, 17):
        yield f"{low:.{digits}g}"
    if not unit.offset:
        yield f"{Decimal(repr(float(value))) / Decimal(repr(unit.scale)):.17g}"
    for _ in range(4):
        low, high = math.nextafter(low, -math.inf), math.nextafter(high, math.inf)
        yield repr(low)
        yield repr(high)


def to_yaml(
    design: Design,
    source: FileSource | None = None,
    *,
    metrics: Mapping[str, Quantity] | None = None,
) -> str:
    """Text of a design file; reading it gives `design` again, bit for bit.

    Data files are named; see `data_file.moved` and `data_file.portable`.

    Parameters
    ----------
    design : design to write
    source : original text, to keep its comments
    metrics : allowed metrics; default: `metrics.METRICS`
    """
    metrics = METRICS if metrics is None else metrics
    if source is not None:
        text = _edited_text(design, source.document, metrics)
        text = text or _edited_text(design, _in_list_form(source.document), metrics)
        if text:
            return text
    writer = _Leaves(design, metrics)
    return "\n".join(_lines(_stated(to_tree(design), Design, design), (), writer, "")) + "\n"


_TABLES = (("variables",), ("requirements",), ("measured",), ("uncertainty",))
"""Tables whose entries are blocks with free names."""


class _CannotEdit(Exception):
    """The text cannot be edited: it has flow style, or blocks or plies were added or removed."""


class _Edit(NamedTuple):
    """Replacement of ``text[start:end]`` by `new`, inside `depth` nested blocks."""

    start: int
    end: int
    new: str
    depth: int


class _Leaves:
    """Writes the single values of a design as YAML."""

    def __init__(self, design: Design, metrics: Mapping[str, Quantity]) -> None:
        self.design = design
        self.metrics = metrics

    def quantity(self, loc: Loc, value: object) -> Quantity | None:
        """Quantity of the number at a location of a design file."""
        head = loc[0]
        if head in ("variables", "measured"):
            return resolve(str(loc[1]), self.design, self.metrics).quantity
        if head == "uncertainty":
            path = f"uncertainty.{loc[1]}.{loc[2]}"
            return resolve(path, self.design, self.metrics).quantity
        if head == "choices":
            return quantity_of_choice(str(loc[1]), value, self.design)
        if head == "requirements":
            return self.metrics[str(loc[1])]
        if head == "materials":
            return quantities.MATERIAL_PROPERTIES[str(loc[2])]
        section: type[Section] = Design
        entry = None
        for key in loc:
            if isinstance(key, str):
                entry = entries(section).get(key)
                section = (entry.section if entry else None) or section
        return entry.quantity(value) if entry else None

    def text(self, loc: Loc, value: Any, old: str | None = None) -> str:
        """YAML scalar of a value, in the unit of the text `old` that it replaces."""
        number = number_of(value)
        if number is None:
            return str(value).lower() if isinstance(value, bool) else scalar(value)
        unit = None
        quantity = self.quantity(loc, value)
        if old is not None and quantity is not None:
            try:
                unit = units.unit(units.split(old)[1], quantity.dimension).name
            except units.UnitError:
                unit = None
        return exact_text(number, quantity, unit)

    def same(self, loc: Loc, value: Any, old: str) -> bool:
        """Whether the text `old` already has this `value`."""
        number = number_of(value)
        if isinstance(value, bool):
            return Boolean.words.get(old.strip().lower()) == value
        if number is None:
            return bool(value == old)
        quantity = self.quantity(loc, value)
        if isinstance(value, Fraction) != ("%" in old) and loc[-1] == "position":
            return False
        try:
            return (units.parse(old, quantity.dimension) if quantity else float(old)) == number
        except (units.UnitError, ValueError):
            return False


def _is_default(key: str, value: Any, section: type[Section] | None, loc: Loc, design: Any) -> bool:
    """Whether a value equals its default and can therefore be left out of the file."""
    if loc[0] == "variables" and key == "start":
        target = resolve(str(loc[1]), design)
        return bool(number_of(value_at(design, target.loc)) == number_of(value))
    entry = entries(section).get(key) if section is not None else None
    if entry is None or entry.required:
        return False
    default = entry.default
    default = to_tree(default) if isinstance(default, Section) else default
    return bool(value == (list(default) if isinstance(default, tuple) else default))


def _below(section: type[Section] | None, key: str) -> type[Section] | None:
    entry = entries(section).get(key) if section is not None else None
    return entry.section if entry is not None else None


def _stated(
    node: dict[str, Any], section: type[Section] | None, design: Design, loc: Loc = ()
) -> dict[str, Any]:
    """Convert a block to a tree, without the values that equal their defaults."""
    stated: dict[str, Any] = {}
    table = loc in _TABLES
    for key, value in node.items():
        here = (*loc, key)
        if not table and _is_default(key, value, section, here, design):
            continue
        below = section if table else _below(section, key)
        if isinstance(value, dict):
            stated[key] = _stated(value, below, design, here)
        elif isinstance(value, list):
            stated[key] = [
                _stated(item, below, design, (*here, i)) if isinstance(item, dict) else item
                for i, item in enumerate(value)
            ]
        else:
            stated[key] = value
    return stated


def _lines(node: dict[str, Any], loc: Loc, writer: _Leaves, indent: str) -> Iterator[str]:
    """Write the lines of a block in YAML's block style."""
    for key, value in node.items():
        here = (*loc, key)
        name = key if re.fullmatch(r"[^\W\d]\w*[\w.\[\] +-]*", key) else scalar(key)
        if isinstance(value, dict):
            yield f"{indent}{name}:" if value else f"{indent}{name}: {{}}"
            yield from _lines(value, here, writer, indent + "  ")
        elif isinstance(value, list) and not isinstance(next(iter(value), None), dict):
            texts = (writer.text((*here, i), item) for i, item in enumerate(value))
            yield f"{indent}{name}: [{', '.join(texts)}]"
        elif isinstance(value, list):
            yield f"{indent}{name}:"
            for index, item in enumerate(value):
                block = list(_lines(item, (*here, index), writer, indent + "    "))
                yield f"{indent}  - {block[0].lstrip()}"
                yield from block[1:]
        else:
            yield f"{indent}{name}: {writer.text(here, value)}"


def _edited_text(design: Design, document: Document | None, metrics: Mapping[str, Quantity]) -> str:
    """Replace values in the document's text by those of the design; empty if impossible."""
    try:
        text = "" if document is None else _edited(design, document, metrics)
    except _CannotEdit:
        return ""
    return text if _reads_back(text, design, metrics) else ""


def _in_list_form(document: Document) -> Document | None:
    """Rewrite compact lay-ups of a document as lists of layers; None if nothing is compact."""
    text, newline = document.text, "\r\n" if "\r\n" in document.text else "\n"
    for shorthand in sorted(document.shorthands, key=lambda s: s.entry.start, reverse=True):
        start, end = shorthand.entry.start, shorthand.entry.end
        dash = text[text.rfind("\n", 0, start) + 1 : start]
        if re.fullmatch(r"[ ]*-[ ]+", dash) is None:
            return None  # a list in flow style
        layers = value_at(document.data, shorthand.wall)[shorthand.first :]
        blocks = [
            (newline + " " * len(dash)).join(
                f"{key}: {_as_read(value)}" for key, value in layer.items()
            )
            for layer in layers[: shorthand.layers]
        ]
        text = text[:start] + (newline + dash).join(blocks) + text[end:]
    try:
        return parse(text, document.file) if document.shorthands else None
    except InputError:
        return None


def _as_read(text: str) -> str:
    """Write a scalar of the file as YAML; booleans and numbers with a unit need no quotes."""
    plain = text == "false" or re.fullmatch(r"[+-]?[\w.]+ \w+", text)
    return text if plain else scalar(text)


def _reads_back(text: str, design: Design, metrics: Mapping[str, Quantity]) -> bool:
    try:
        document = layup.expanded(parse(text, ""))
    except InputError:
        return False
    built = build(document.data, metrics=metrics)
    reread = None if document.faults else built.design
    return reread is not None and to_tree(reread) == to_tree(design)


def _edited(design: Design, document: Document, metrics: Mapping[str, Quantity]) -> str:
    """Replace values in the document's text by those of the design."""
    writer = _Leaves(design, metrics)
    edits: list[_Edit] = []
    _compare(to_tree(design), document.data, (), Design, document, writer, edits)
    text = document.text
    # edit from the end backwards; at the same position, lines of inner blocks come first
    order = sorted(enumerate(edits), key=lambda pair: (pair[1].start, -pair[1].depth, pair[0]))
    for _, edit in reversed(order):
        text = text[: edit.start] + edit.new + text[edit.end :]
    return text


def _compare(
    node: dict[str, Any],
    old: Any,
    loc: Loc,
    section: type[Section] | None,
    document: Document,
    writer: _Leaves,
    edits: list[_Edit],
) -> None:
    """Compare a block with the document, and add the necessary edits to `edits`."""
    if not isinstance(old, dict) or any(key not in node for key in old):
        raise _CannotEdit
    table = loc in _TABLES
    for key, value in node.items():
        here = (*loc, key)
        below = section if table else _below(section, key)
        if key not in old:
            if table or not _is_default(key, value, section, here, writer.design):
                stated = _stated({key: value}, section, writer.design, loc)
                edits.append(_insertion(stated, loc, document, writer))
        elif isinstance(value, dict):
            _compare(value, old[key], here, below, document, writer, edits)
        elif isinstance(value, list):
            if not isinstance(old[key], list) or len(old[key]) != len(value):
                raise _CannotEdit
            for index, (item, old_item) in enumerate(zip(value, old[key], strict=True)):
                if isinstance(item, dict):
                    _compare(item, old_item, (*here, index), below, document, writer, edits)
                else:
                    edits += _replacement(item, old_item, (*here, index), document, writer)
        else:
            edits += _replacement(value, old[key], here, document, writer)


def _replacement(
    value: Any, old: Any, loc: Loc, document: Document, writer: _Leaves
) -> Iterator[_Edit]:
    """Yield the edit that replaces a value, if the value changed."""
    if not isinstance(old, str):
        raise _CannotEdit
    if writer.same(loc, value, old):
        return
    span = document.values[loc]
    if document.shorthand(loc) or document.text[span.start : span.start + 1] in ("|", ">"):
        raise _CannotEdit
    yield _Edit(span.start, span.end, writer.text(loc, value, old), len(loc))


def _insertion(stated: dict[str, Any], loc: Loc, document: Document, writer: _Leaves) -> _Edit:
    """The edit that adds new values at the end of a block, below its last line."""
    text = document.text
    block = document.values[loc]
    if document.shorthand(loc):
        raise _CannotEdit
    node = child_at(document.data, loc)
    if text[block.start : block.start + 1] == "{" or not node:
        raise _CannotEdit
    column = document.keys[(*loc, next(iter(node)))].column
    last = loc
    while isinstance(node, (dict, list)) and node:
        key = list(node)[-1] if isinstance(node, dict) else len(node) - 1
        last, node = (*last, key), child(node, key)
    end = document.values[last].end
    if not text.startswith("\n", end - 1):  # a block scalar ends at the start of the next line
        end = text.find("\n", end) + 1 or len(text)
    newline = "\r\n" if "\r\n" in text else "\n"
    lead = "" if text.startswith("\n", end - 1) else newline
    lines = (line + newline for line in _lines(stated, loc, writer, " " * (column - 1)))
    return _Edit(end, end, lead + "".join(lines), len(loc))


_TEXT = """\
# A hydraulic actuator: its design, load cases, variables and requirements.
#
# Every physical value has a unit (25 mm, 100 bar, 40 degC, 0.5 %); only 0, ratios and counts
# may be bare. Every value has a PATH, e.g. cylinder.bore or barrel.layup[1].thickness, for --set
# and the block `variables` below.
#
#   actuator-opt check FILE       all faults of this file
#   actuator-opt evaluate FILE    all metrics and checks of this design
#   actuator-opt optimise FILE    the lightest design that meets the requirements
name: @NAME@

fluid:
  material: iso_vg_32          # actuator-opt materials list
  temperature: 40 degC
  air_content: 0.5 %           # entrained air: lowers the stiffness of the oil

supply:
  pressure: 100 bar            # gauge, at the actuator's port
  return_pressure: 2 bar
  proof_ratio: 1.5             # proof pressure divided by supply pressure

environment:
  temperature_min: -20 degC
  temperature_max: 80 degC
  assembly_temperature: 20 degC
  cure_temperature: 120 degC   # stress-free temperature of the laminate
  trapped_rise: 5 K            # temperature rise of trapped oil

cylinder:
  bore: 25 mm
  stroke: 110 mm
  mount: cap_clevis            # or head_flange, head_trunnion, cap_flange
  port_diameter: 6 mm

barrel:
  model: auto                  # isotropic for one metal layer, else layered
  layup:                       # from the bore outwards; one isotropic layer = a metal barrel
    - material: al_6061_t6     # liner: leak-tight, wear surface of the piston seal
      thickness: 0.8 mm
    - material: t700_epoxy     # hoop layer: carries the pressure
      angle: 88 deg            # from the tube axis; a balanced +- pair
      thickness: 1.2 mm
                               # one entry can also state both composite layers, with
                               # plies: "+-88_3 / +-20_2" and ply_thickness: 0.2 mm
    - material: t700_epoxy     # axial layer: carries the end forces
      angle: 20 deg
      thickness: 0.8 mm

rod:
  material: steel_42crmo4
  outer_diameter: 12 mm
  inner_diameter: 4 mm         # 0 = solid
  extension: 25 mm             # length outside the head when retracted
  thread:
    diameter: 10 mm
    pitch: 1.5 mm

piston:
  material: al_7075_t6
  length: 18 mm
  clearance: 0.02 mm           # radial

head:
  material: al_7075_t6
  length: 22 mm
  clearance: 0.02 mm

caps:
  material: ti_6al4v           # low thermal expansion, suits carbon fibre
  thickness: 6 mm

retention:                     # joint of caps and head to the barrel
  type: bond                   # or @JOINTS@
  material: epoxy_structural
  length: 20 mm
  wall: 1.5 mm

clevis:
  material: al_7075_t6
  pin_diameter: 10 mm

seals:
  piston:
    type: o_ring               # or @SEALS@
    compound: nbr_70
    section: 3.53 mm
    squeeze: 12 %
    tolerance: 0.05 mm
  rod:
    type: o_ring
    compound: nbr_70
    section: 3.53 mm
    squeeze: 12 %
    tolerance: 0.05 mm
    # friction: film           # oil film instead of a friction coefficient
    # back_up: one             # needs back_up_material and back_up_thickness

lines:                         # between valve and chambers; optional
  - chamber: a                 # a: cap side, b: rod side
    length: 0.2 m
    inner_diameter: 6 mm
    outer_diameter: 8 mm
    material: steel_e235
  - chamber: b
    length: 0.2 m
    inner_diameter: 6 mm
    outer_diameter: 8 mm
    material: steel_e235

# valve:                       # optional: position loop, bandwidth and margins
#   rated_flow: 10 l/min       # through one edge, fully open, at rated_drop
#   rated_drop: 35 bar
#   leakage_flow: 0.2 l/min    # through one edge, spool centred, at leakage_drop (50 bar)
#   natural_frequency: 120 Hz
# ports:
#   end: valve                 # end of the lines under load excitation; or closed (default),
#                              # constant_pressure, reducing_valve
# control:
#   gain: 500 V/m              # signal per position error; default: half the ultimate gain

load:
  mass: 20 kg                  # moving mass, reflected to the rod
# linkage:                     # joint that the actuator drives: allows joint_angle, joint_speed,
#                              # load.inertia, and joint_torque without lever_arm
#   base_radius: 280 mm        # from joint axis to fixed pivot
#   crank_radius: 70 mm        # from joint axis to crank pin
#   angle_offset: 10 deg       # angle between the radii at joint angle 0; extending increases it

load_cases:                    # every requirement holds in the worst case
  - name: stance
    direction: push
    force: 3 kN                # or joint_torque: 120 N*m with lever_arm: 40 mm (or linkage)
    speed: 0.1 m/s
    position: worst            # or a length, or a share of the stroke (50 %)
    side_load: 20 N
#   frequency: 20 Hz           # load excitation, for dynamic_stiffness
  - name: swing
    direction: pull
    force: 1 kN
    speed: 0.15 m/s

variables:                     # dimensions that the optimiser varies; all others are fixed
  cylinder.bore:
    lower: 18 mm
    upper: 40 mm
  barrel.layup[1].thickness:
    lower: 0.2 mm
    upper: 4 mm
  barrel.layup[2].thickness:
    lower: 0.2 mm
    upper: 4 mm
  rod.outer_diameter:
    lower: 10 mm
    upper: 20 mm
  rod.inner_diameter:
    lower: 0 mm
    upper: 16 mm
  caps.thickness:
    lower: 3 mm
    upper: 12 mm

# choices:                     # PATH with the values to choose from; every
#   seals.rod.compound: [nbr_70, hnbr_75]      # combination is optimised, the best is kept
#   seals.rod.section: [2.62 mm, 3.53 mm]

requirements:                  # METRIC with min and/or max; every metric: actuator-opt list metrics
  stiffness_min:
    min: 4 kN/mm
  buckling_factor:
    min: 3.5
  seal_gap:
    max: 80 um
  friction_running:
    max: 350 N

objective:
  minimise: mass
"""


def init_text(name: str = "my actuator", from_design: LoadedDesign | Design | None = None) -> str:
    """A start file: the commented template, or an existing design under a new name.

    Raises
    ------
    ValueFault
        an invalid name
    """
    title = Text().validate(name)
    if from_design is None:
        joints = ", ".join(name for name in JOINTS if name != "bond")
        seals = ", ".join(name for name in TYPES if name != o_ring.TYPE.name)
        text = _TEXT.replace("@JOINTS@", joints).replace("@SEALS@", seals)
        return text.replace("@NAME@", scalar(title))
    if isinstance(from_design, Design):
        return to_yaml(from_design.model_copy(update={"name": title}))
    design = from_design.design.model_copy(update={"name": title})
    return to_yaml(design, from_design.source)
