"""PATHs: names of single values of a design in files, `--set`, scripts and reports.

``cylinder.bore`` · ``barrel.layup[1].thickness`` · ``load_cases[stance].force`` ·
``duty.cycles[walk].torque_scale`` · ``requirements.stiffness_min.min`` ·
``variables.cylinder.bore.upper`` · ``materials.NAME.PROPERTY``. A load case or duty cycle is given
by name or by its index from 0; the canonical PATH uses the name. All functions accept a `Design` or
its tree of dicts and lists; `resolve` also accepts other types of file, such as scenarios.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from ..base import errors, quantities, units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError
from ..base.quantities import Quantity
from ..metrics import METRICS, of_metric, split_case, term_of
from .kinds import Fraction, Section, ValueFault
from .model import Design
from .structure import KeyEntry, Loc, blocks, child, child_at, entries, leaves, number_of
from .uncertain import NUMBERS, quantity_of_entry

_PATH = re.compile(r"[^.\[\]=]+(\[[^\[\]=]+\])?(\.[^.\[\]=]+(\[[^\[\]=]+\])?)*")
_TOKEN = re.compile(r"\[([^\[\]]+)\]|([^.\[\]]+)")
_ENDS = {
    "variables": ("lower", "upper", "start", "step", "sizes"),
    "measured": ("lower", "upper", "record"),
    "uncertainty": ("distribution", *NUMBERS, "tolerance", "source"),
}
_LIMITS = ("min", "max")
LEAVE_OUT = "leave out this option"
"""Remedy for a PATH to unset that the file does not state."""
_TEXTS = ("waivers", "set")
_TABLES = (*_ENDS, *_TEXTS, "requirements", "materials", "objective")


NAMED_LISTS: tuple[Loc, ...] = (("load_cases",), ("duty", "cycles"), ("duty", "levels"))
"""Lists whose entries PATHs give by name."""


class _Token(NamedTuple):
    """One part of a PATH: a key, or the text in brackets."""

    text: str
    bracket: bool


@dataclass(frozen=True, slots=True)
class Target:
    """Value that a PATH names: canonical spelling, location in the tree, and quantity.

    `quantity` is None for a text. `entry` is None for values of tables with free names (variables,
    requirements, materials, …).
    """

    path: str
    loc: Loc
    quantity: Quantity | None
    entry: KeyEntry | None = None


def spell(loc: Loc, tree: Any = None) -> str:
    """The canonical PATH of a location; an entry of `NAMED_LISTS` by its name, if only it has it.

    >>> spell(("barrel", "layup", 1, "thickness"))
    'barrel.layup[1].thickness'
    """
    text = ""
    for depth, key in enumerate(loc):
        if not isinstance(key, int):
            text += f".{key}" if text else key
            continue
        name: object = key
        if loc[:depth] in NAMED_LISTS:
            names = _names(tree, loc[:depth])
            if key < len(names) and isinstance(names[key], str) and names.count(names[key]) == 1:
                name = names[key]
        text += f"[{name}]"
    return text


def _names(tree: Any, loc: Loc) -> list[Any]:
    items = child_at(tree, loc)
    return [child(item, "name") for item in items] if isinstance(items, (list, tuple)) else []


def resolve(
    path: str,
    tree: Any,
    metrics: Mapping[str, Quantity] | None = None,
    root: type[Section] = Design,
    *,
    near: bool = True,
) -> Target:
    """Find the value that `path` names in `tree`.

    `tree` is an object of type `root`, or its contents as dicts and lists. `near` states whether
    the remedy for an unknown PATH names similar ones, which takes time.

    Raises
    ------
    ValueFault
        if the PATH is malformed, unknown (the message suggests the most similar PATH), or names a
        block and not a value
    """
    path = path.strip()
    if len(path) > 200 or _PATH.fullmatch(path) is None:
        raise ValueFault(
            f'"{errors.shown(path)}": not a PATH',
            "write e.g. cylinder.bore or barrel.layup[0].angle",
        )
    head, _, rest = path.partition(".")
    if rest and head == "choices" and head in entries(root):
        raise ValueFault(f"{path}: is a list, not a value", "change the list in the file")
    if rest and head in _TABLES and head in entries(root):
        return _resolve_table(head, rest, tree, METRICS if metrics is None else metrics)
    tokens = [_Token(m[1] or m[2], m[1] is not None) for m in _TOKEN.finditer(path)]
    try:
        return _resolve_section(path, tokens, (tree, root), tree, root, ())
    except _UnknownPath as unknown:
        raise _no_such(path, unknown.candidates() if near else {}) from None


class _UnknownPath(Exception):
    """An unknown PATH; `candidates` gives the known ones with their meanings."""

    def __init__(self, candidates: Callable[[], Mapping[str, str]]) -> None:
        super().__init__()
        self.candidates = candidates


def _resolve_section(
    path: str,
    tokens: Sequence[_Token],
    whole: tuple[Any, type[Section]],
    node: Any,
    section: type[Section],
    loc: Loc,
) -> Target:
    """Find the value that `tokens` name in a block; `node` is None if the tree lacks the block."""
    keys, tree = entries(section), whole[0]
    if not tokens:
        raise _not_a_value(path, list(keys))
    name, rest = tokens[0].text, tokens[1:]
    entry = keys.get(name)
    if entry is None or tokens[0].bracket:

        def candidates() -> Mapping[str, str]:
            known = {spell((*loc, key), tree): entry.meaning for key, entry in keys.items()}
            known |= {spell(at, tree): entry.meaning for at, entry, _ in leaves(*whole)}
            return known | _limits(tree)

        raise _UnknownPath(candidates)
    node, loc = child(node, name), (*loc, name)
    if entry.shape in ("value", "choice"):
        if rest:
            raise ValueFault(f"{path}: {spell(loc, tree)} is a single value", "write only this")
        return Target(spell(loc, tree), loc, entry.quantity(node), entry)
    if entry.shape == "list":
        if not rest or not rest[0].bracket:
            more = "" if entry.section is None else ".…"
            raise ValueFault(f"{path}: {name} is a list", f"write {spell(loc)}[0]{more}")
        loc = (*loc, _index(path, rest[0].text, node, loc))
        node, rest = child(node, loc[-1]), rest[1:]
        if entry.section is None and not rest:
            return Target(spell(loc, tree), loc, entry.quantity(node), entry)
    if entry.section is None or entry.shape == "table":
        raise _not_a_value(path, ["NAME"])
    return _resolve_section(path, rest, whole, node, entry.section, loc)


def _index(path: str, text: str, node: Any, loc: Loc) -> int:
    """Index of a list entry, which is given by number or, for load cases, by name."""
    items = node if isinstance(node, (list, tuple)) else ()
    names = [child(item, "name") for item in items]
    if text in names:
        return names.index(text)
    index = units.whole(text)
    if index is not None and index < len(items):
        return index
    options = [str(n) for n in names if n is not None] or [str(i) for i in range(len(items))]
    message = f"{path}: {spell(loc)} has no entry {errors.shown(text)}"
    raise ValueFault(message, errors.remedy(text, options) or "it is empty")


def _resolve_table(head: str, rest: str, tree: Any, metrics: Mapping[str, Quantity]) -> Target:
    """Find the value that a PATH names in a table with free keys (PATHs, metrics, materials)."""
    path = f"{head}.{rest}"
    name, _, last = rest.rpartition(".")
    if head in _TEXTS:
        return Target(path, (head, rest), None)
    if head == "objective":
        if rest not in ("minimise", "maximise"):
            raise _no_such(path, {"objective.minimise": "", "objective.maximise": ""})
        return Target(path, (head, rest), None)
    if head in _ENDS:
        if not name or last not in _ENDS[head]:
            raise ValueFault(f"{path}: unknown PATH", f"end it with .{', .'.join(_ENDS[head])}")
        target = resolve(name, tree, metrics)
        quantity = None if last in ("record", "sizes") else target.quantity
        if head == "uncertainty" and target.quantity is not None:
            quantity = quantity_of_entry(last, target.quantity)
        return Target(f"{head}.{target.path}.{last}", (head, target.path, last), quantity)
    if head == "requirements":
        allowed: Mapping[str, Quantity] = metrics
        key = name or last
        if last not in _LIMITS and (name or split_case(key)[0] in allowed):
            raise ValueFault(f"{path}: unknown PATH", f"end it with .{' or .'.join(_LIMITS)}")
    else:
        allowed, key = quantities.MATERIAL_PROPERTIES, last
        if not name:
            raise ValueFault(f"{path}: unknown PATH", "write materials.NAME.PROPERTY")
    if (split_case(key)[0] if head == "requirements" else key) not in allowed:
        noun = "metric" if head == "requirements" else "material property"
        raise ValueFault(f'{path}: "{key}" is not a {noun}', errors.remedy(key, allowed))
    return Target(path, (head, name, last), allowed[key])


def _not_a_value(path: str, below: Sequence[str]) -> ValueFault:
    limit = _limit_of(path)
    remedy = f"add one of .{', .'.join(below[:8])}" + (f"; for a limit: {limit}" if limit else "")
    return ValueFault(f"{path}: names a block, not a value", remedy)


def _limit_of(path: str) -> str | None:
    """PATH of the limit of a metric, which a text gives by its key or its words in tables.

    >>> _limit_of("stiffness"), _limit_of("stiffness_min.max"), _limit_of("cylinder.bore")
    ('requirements.stiffness_min.min', 'requirements.stiffness_min.max', None)
    """
    name, _, side = path.rpartition(".")
    if side not in _LIMITS:
        name, side = path, ""
    for metric, quantity in METRICS.items():
        if name == metric or name.replace("_", " ") == term_of(metric):
            return f"requirements.{metric}.{side or quantity.worst}"
    return None


def _limits(tree: Any) -> dict[str, str]:
    """Stated limits by PATH, with the meaning of their metric."""
    block = child(tree, "requirements")
    return {
        f"requirements.{metric}.{side}": f"limit of the {of_metric(str(metric)).label}"
        for metric, limit in (block.items() if isinstance(block, Mapping) else ())
        for side in _LIMITS
        if child(limit, side) is not None
    }


def _no_such(path: str, candidates: Mapping[str, str]) -> ValueFault:
    remedy, limit = errors.remedy(path, candidates, 6), _limit_of(path) if candidates else None
    if limit is not None and f'"{limit}"' not in remedy:
        near = remedy.startswith("did you mean ")
        others = f" or {remedy.removeprefix('did you mean ')}" if near else "?"
        remedy = f'did you mean "{limit}"{others}'
    return ValueFault(f"{path}: unknown PATH", remedy)


def canonical(path: str, design: Design) -> str:
    """Canonical spelling of a PATH, as used in results and records; raises `InputError`."""
    return _target(path, design).path


def words_of(path: str) -> str:
    """The value that a PATH names, in plain words.

    >>> words_of("cylinder.stroke"), words_of("seals.rod.squeeze"), words_of("rod.wall[1].angle")
    ('stroke', 'rod seal squeeze', 'rod wall[1] angle')
    >>> words_of("load_cases[swing].force"), words_of("requirements.seal_gap.max")
    ('force swing', 'seal gap')
    >>> words_of("materials.t700_epoxy.youngs_modulus_1")
    'modulus along the fibre of t700_epoxy'
    """
    head, _, rest = path.partition(".")
    if head == "materials":
        material, _, name = rest.rpartition(".")
        label = quantities.MATERIAL_PROPERTIES[name].label if material else name
        return f"{label.partition(' (')[0]} of {material}"
    if head == "requirements":
        return term_of(rest.rpartition(".")[0])
    if head.startswith("load_cases["):
        return f"{rest} {head[len('load_cases[') : -1]}".replace("_", " ")
    if path.startswith(("duty.cycles[", "duty.levels[")):
        name, _, key = path.partition("[")[2].partition("].")
        return f"{key} {name}".replace("_", " ").replace(".", " ")
    if head == "seals":
        place, _, name = rest.partition(".")
        return f"{place} seal {name}".replace("_", " ").replace(".", " ")
    layer = path.endswith("].thickness")
    path = path.removeprefix("cylinder.")
    return (path.removesuffix(".thickness") if layer else path).replace(".", " ").replace("_", " ")


def quantity_of(path: str, design: Design) -> Quantity:
    """Quantity of the number at a PATH; raises `InputError` for a text or an unknown PATH."""
    target = _target(path, design)
    if target.quantity is None:
        raise InputError(
            Diagnostic(f"{target.path} is text, not a number", "name a number", path=path)
        )
    return target.quantity


def get(design: Design, path: str) -> float | str | None:
    """Value at a PATH: SI number, text, or None if an optional value is not set."""
    return value_at(path, design)[1]


def value_at(
    path: str, design: Design, metrics: Mapping[str, Quantity] | None = None
) -> tuple[Target, float | str | bool | None]:
    """The target of a PATH, and its value (see `get`); `metrics` may include the user's own."""
    target = _target(path, design, metrics)
    node = child_at(design, target.loc)
    number = number_of(node)
    return target, node if number is None else number


def _target(path: str, design: Design, metrics: Mapping[str, Quantity] | None = None) -> Target:
    try:
        return resolve(path, design, metrics)
    except ValueFault as fault:
        message = fault.message.removeprefix(f"{path}: ")
        raise InputError(Diagnostic(message, fault.remedy, path=path)) from None


def numbers(design: Design) -> dict[str, float]:
    """Every number of a design (SI), by its canonical PATH; optional values not set are left out.

    Positions stated as a fraction of the stroke stay fractions. Bounds of variables are left out.
    """
    values: dict[str, float] = {}
    for loc, _, value in leaves(design):
        number = number_of(value)
        if number is not None:
            values[spell(loc, design)] = number
    for metric, limit in design.requirements.items():
        for sense in _LIMITS:
            value = getattr(limit, sense)
            if value is not None:
                values[f"requirements.{metric}.{sense}"] = value
    for material, properties in design.materials.items():
        for name, value in properties.items():
            values[f"materials.{material}.{name}"] = value
    return values


def split_assignment(text: str) -> tuple[str, str]:
    """PATH and value of ``PATH=VALUE``; raises `UsageError`.

    >>> split_assignment("supply.pressure=120 bar")
    ('supply.pressure', '120 bar')
    """
    path, equals, value = text.partition("=")
    if not equals or not path.strip() or not value.strip():
        message = f'"{errors.shown(text)}": not PATH=VALUE'
        raise UsageError(Diagnostic(message, 'write e.g. --set "cylinder.bore=30 mm"'))
    return path.strip(), value.strip()


def put(tree: dict[str, Any], target: Target, value: object) -> None:
    """Set a value in a tree of dicts and lists; missing blocks are added.

    A number that replaces a position stated as a fraction of the stroke is itself such a fraction.
    A new objective replaces the existing objective.

    Raises
    ------
    ValueFault
        if the tree has a single value where the PATH needs a block
    """
    node: Any = tree
    for depth, key in enumerate(target.loc):
        if depth:
            above = target.loc[depth - 1]
            if child(node, above) is None:
                node[above] = {}
            node = child(node, above)
        if not isinstance(node, list if isinstance(key, int) else dict):
            message = f"{spell(target.loc[:depth])} is not a block"
            raise ValueFault(message, "correct it in the file first")
    key = target.loc[-1]
    if target.loc[0] == "objective":
        node.clear()  # a design has a single objective: the new objective replaces it
    if isinstance(value, float) and target.quantity is not None and target.entry is not None:
        is_share = target.quantity.name == "fraction"
        value = Fraction(value) if is_share and target.entry.name == "position" else value
    node[key] = value


def remove(tree: dict[str, Any], loc: Loc) -> None:
    """Remove a key or block from a tree, with the entries of other tables for its values."""
    name = spell(loc, tree)
    node = child_at(tree, loc[:-1]) or {}
    node.pop(loc[-1], None)
    needed = _LIMITS if loc[0] == "requirements" else tuple(node)
    if len(loc) > 2 and loc[0] in _TABLES and not any(key in node for key in needed):
        # an entry of a table that states no limit or value any more
        (tree.get(loc[0]) or {}).pop(loc[1], None)
    for table in filter(None, map(tree.get, _ENDS)):
        for path in list(table):
            if path == name or path.startswith((f"{name}.", f"{name}[")):
                del table[path]


def stated(
    path: str,
    tree: dict[str, Any],
    metrics: Mapping[str, Quantity] | None = None,
    root: type[Section] = Design,
) -> Loc:
    """Location of a key or block that a tree states, such as ``cushion`` or ``rod.fitting.wall``.

    Parameters
    ----------
    path : PATH of a value, of a block, or of an entry of a table with free names
    tree : dicts and lists
    metrics, root : as for `resolve`, which finds similar names for an unknown PATH

    Raises
    ------
    ValueFault
        if the PATH is unknown, names an entry of a list, or the tree does not state it

    >>> stated("variables.cylinder.bore", {"variables": {"cylinder.bore": {"lower": "9 mm"}}})
    ('variables', 'cylinder.bore')
    """
    loc = _stated(path, path.strip(), tree, ())
    if not loc:
        if path.strip() not in blocks(root):
            resolve(path, tree, metrics, root)
        raise ValueFault(f"{path}: is not stated, so it cannot be unset", LEAVE_OUT)
    if isinstance(loc[-1], int):
        raise ValueFault(f"{path}: an entry of a list cannot be unset", "change it in the file")
    return loc


def _stated(path: str, rest: str, node: Any, loc: Loc) -> Loc | None:
    """Location of the value below a node that the rest of a PATH names; None if there is none."""
    if not rest:
        return loc
    if isinstance(node, list):
        index = _TOKEN.match(rest)
        if index is None or index[1] is None:
            return None
        key = _index(path, index[1], node, loc)
        return _stated(path, rest[index.end() :].removeprefix("."), node[key], (*loc, key))
    for key, below in node.items() if isinstance(node, dict) else ():
        if rest == key or rest.startswith((f"{key}.", f"{key}[")):
            deeper = _stated(path, rest[len(key) :].removeprefix("."), below, (*loc, key))
            if deeper is not None:
                return deeper
    return None
