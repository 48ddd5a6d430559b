"""Faults of the walls of barrel and rod: impossible layers, unsuitable materials.

Faults of `retention`: missing or unused keys, and faults that the joint reports.

Each joint declares its keys and checks in its module in `joints`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any

from ..base import quantities
from ..base.errors import Fault, InputError
from ..base.quantities import INPUTS
from ..joints.joint import Joint
from ..joints.kinds import JOINTS
from .material import PLY_CONSTANTS, PLY_REQUIRED, compliance_determinant, ply_constants
from .model import Ply, Retention
from .paths import spell
from .structure import (
    FileView,
    Loc,
    MaterialLookup,
    Properties,
    child,
    child_at,
    entries,
    length_text,
    lists_of,
    number_of,
)

PLY_STRENGTHS = (
    "strength_1_tension", "strength_1_compression", "strength_2_tension",
    "strength_2_compression", "strength_12",
)  # fmt: skip
"""Strengths that every failure criterion needs; other strengths have defaults."""

_WITHOUT_PLIES = ("isotropic", "as_published")
"""Wall models without failure of plies."""

_ELASTIC = (*PLY_CONSTANTS, "youngs_modulus", "poissons_ratio", "shear_modulus")


def signs(view: FileView) -> Iterator[Fault]:
    """A balanced pair has no sign, neither in its angle nor in its bounds."""
    for wall in lists_of(Ply):
        for index in range(len(view.items(*wall))):
            loc = (*wall, index, "angle")
            if view.flag(*wall, index, "balanced") is not True:
                continue
            bound = ("variables", spell(loc), "lower")
            stated = {loc: view.number(*loc), bound: number_of(child_at(view.tree, bound))}
            for place, angle in stated.items():
                if angle is not None and angle < 0:
                    text = quantities.INPUTS["winding_angle"].text
                    yield Fault(
                        place,
                        f"{text(angle)}: a balanced +-pair has no sign",
                        f'write {text(-angle)}, or add "balanced: false" for one signed ply'
                        if place == loc
                        else f'write 0 deg or more, or add "balanced: false" to {spell(loc[:-1])}',
                    )


def barrel_model(view: FileView) -> Iterator[Fault]:
    """The isotropic wall model has a single layer."""
    layers = len(view.items("barrel", "layup"))
    if view.text("barrel", "model") == "isotropic" and layers > 1:
        yield Fault(
            ("barrel", "model"),
            f"isotropic: the layup has {layers} layers, the model has one",
            "write auto, or keep one layer",
        )


def autofrettage(view: FileView) -> Iterator[Fault]:
    """The liner yields above the supply pressure, inside layers that contain it."""
    loc = ("barrel", "autofrettage_pressure")
    pressure, supply = view.number(*loc), view.number("supply", "pressure")
    if pressure is None:
        return
    text = quantities.INPUTS["autofrettage_pressure"].text
    if supply is not None and pressure <= supply:
        yield Fault(
            loc,
            f"{text(pressure)}: not above supply.pressure ({text(supply)})",
            f"write more than {text(supply)}",
        )
    elif len(view.items("barrel", "layup")) == 1:
        remedy = "remove the line, or wrap the liner"
        yield Fault(
            loc, "the wall is a single layer: nothing supports a liner", remedy, at_key=True
        )


def laminated_rod(view: FileView) -> Iterator[Fault]:
    """The bore of a laminated rod follows from its layers; fittings need both."""
    layers = len(view.items("rod", "layup"))
    if not layers:
        if view.has("rod", "fitting"):
            remedy = "remove it, or add the layers: rod.layup"
            yield Fault(
                ("rod", "fitting"), "only a rod with layup has fittings", remedy, at_key=True
            )
        return
    why = "the bore of a laminated rod follows from outer_diameter and its layers"
    if view.number("rod", "inner_diameter"):
        yield Fault(("rod", "inner_diameter"), why, "remove the line", at_key=True)
    moved = ("variables", "rod.inner_diameter")
    if child_at(view.tree, moved) is not None:
        remedy = "remove it; vary e.g. rod.layup[0].thickness"
        yield Fault(moved, why, remedy, at_key=True)
    outer = view.number("rod", "outer_diameter")
    parts = [view.number("rod", "layup", index, "thickness") for index in range(layers)]
    known = [part for part in parts if part is not None]
    if outer is None or len(known) < layers:
        return
    if 2 * sum(known) >= outer * (1 - 1e-9):
        yield Fault(
            ("rod", "layup"),
            f"layers of {length_text(sum(known))} leave no bore in a rod of {length_text(outer)}",
            f"write less than {length_text(outer / 2)} in total, or a larger rod.outer_diameter",
            at_key=True,
        )
        return
    wall, room = view.number("rod", "fitting", "wall"), outer / 2 - sum(known)
    if wall is not None and wall > room * (1 + 1e-9):
        yield Fault(
            ("rod", "fitting", "wall"),
            f"{length_text(wall)}: the bore has a radius of {length_text(room)}",
            f"write at most {length_text(room)}, or remove it: solid",
        )


CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    signs,
    barrel_model,
    autofrettage,
    laminated_rod,
)


def of_materials(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Faults of the walls that depend on the material library."""
    view = FileView(tree)
    yield from _kinds(view, materials)
    if isinstance(materials, Properties):
        known = _Known(view, materials)
        yield from _strengths(view, known)
        yield from _stiffness(view, known)


def _names(view: FileView, wall: Loc) -> list[str | None]:
    return [view.text(*wall, index, "material") for index in range(len(view.items(*wall)))]


def _kinds(view: FileView, materials: MaterialLookup) -> Iterator[Fault]:
    """Autofrettage needs a metal liner; a laminated rod needs metal fittings."""
    first = next(iter(_names(view, ("barrel", "layup"))), None)
    stated = view.number("barrel", "autofrettage_pressure") is not None
    if stated and first is not None and materials.kind(first) not in (None, "metal"):
        yield Fault(
            ("barrel", "autofrettage_pressure"),
            f"the innermost layer is {first}, not a metal liner that could yield",
            "remove the line, or add a metal liner",
            at_key=True,
        )
    wound = [name for name in _names(view, ("rod", "layup")) if name is not None]
    if any(materials.kind(name) == "ply" for name in wound) and not view.has("rod", "fitting"):
        yield Fault(
            ("rod", "fitting"),
            "missing: a laminated rod needs bonded end fittings",
            'add a block "fitting:" with adhesive, length',
        )


class _Known:
    """Properties of the library, overridden by the design."""

    def __init__(self, view: FileView, materials: Properties) -> None:
        self.own = child(view.tree, "materials")
        self.materials = materials

    def changed(self, name: str) -> dict[str, float]:
        """Properties that the design states; faulty values are left out."""
        own = child(self.own, name)
        pairs = own.items() if isinstance(own, Mapping) else ()
        return {key: value for key, value in pairs if isinstance(value, float)}

    def numbers(self, name: str) -> dict[str, float]:
        """All known properties; empty if the entry is missing or faulty (a separate fault)."""
        try:
            return {**self.materials.numbers(name), **self.changed(name)}
        except InputError:
            return {}


def known_numbers(view: FileView, materials: Properties, name: str) -> dict[str, float]:
    """Properties of a material from library and design; empty if missing or faulty."""
    return _Known(view, materials).numbers(name)


def _strengths(view: FileView, known: _Known) -> Iterator[Fault]:
    """Every ply of the barrel has the strengths of the selected criterion."""
    criterion = view.text("barrel", "criterion")
    if not view.has("barrel", "criterion") or view.text("barrel", "model") in _WITHOUT_PLIES:
        return
    for name in dict.fromkeys(_names(view, ("barrel", "layup"))):
        numbers = known.numbers(name) if name is not None else {}
        missing = [key for key in PLY_STRENGTHS if key not in numbers]
        if "youngs_modulus_1" in numbers and missing:
            yield Fault(
                ("barrel", "criterion"),
                f"{criterion}: {name} has no {', '.join(missing)}",
                f'add e.g. "{missing[0]}: 60 MPa" under materials.{name}, or use another material',
            )


def _stiffness(view: FileView, known: _Known) -> Iterator[Fault]:
    """Changed elastic constants keep the stiffness positive definite."""
    for name in known.own if isinstance(known.own, Mapping) else ():
        changed = [key for key in known.changed(name) if key in _ELASTIC]
        numbers = known.numbers(name) if changed else {}
        if "youngs_modulus_1" in numbers and not set(PLY_REQUIRED) <= set(numbers):
            continue
        constants = ply_constants(numbers)
        if constants and not compliance_determinant(constants) > 0:
            ratios = [key for key in changed if key.startswith("poissons")]
            yield Fault(
                ("materials", name, (ratios or changed)[-1]),
                "these elastic constants are impossible: the stiffness is not positive definite",
                "check the Poisson's ratios against the moduli: nu_12^2 < E_1/E_2 and similar",
            )


def elements(view: FileView) -> Iterator[Loc]:
    """Place of every sealing element the file states."""
    for name in ("piston", "rod"):
        yield ("seals", name)
        if view.has("seals", name, "secondary"):
            yield ("seals", name, "secondary")


def profiles(view: FileView) -> Iterator[Fault]:
    """Stated contact pressures: positions increase from 0, one stress each, sorted by pressure."""
    for loc in elements(view):
        last = -1.0
        for index, _ in enumerate(view.items(*loc, "contact")):
            at = (*loc, "contact", index)
            positions = view.items(*at, "positions")
            stresses = view.items(*at, "stresses")
            pressure = view.number(*at, "pressure")
            if pressure is not None and pressure <= last:
                yield Fault(
                    (*at, "pressure"),
                    f"{INPUTS['pressure'].text(pressure)}: not above the previous profile",
                    "sort the profiles by pressure, each once",
                )
            last = last if pressure is None else pressure
            known = [x for x in stresses if isinstance(x, float)]
            complete = known and len(known) == len(stresses)
            if complete and pressure is not None and max(known) <= pressure:
                yield Fault(
                    (*at, "stresses"),
                    f"nowhere above the sealed pressure ({INPUTS['pressure'].text(pressure)}): "
                    "this contact does not seal",
                    "state contact pressures that include the sealed pressure",
                )
            if len(positions) != len(stresses):
                yield Fault(
                    (*at, "stresses"),
                    f"{len(stresses)} stresses at {len(positions)} positions",
                    "write one stress for every position",
                )
            numbers = [x for x in positions if isinstance(x, float)]
            pairs = pairwise(numbers)
            if numbers and (numbers[0] != 0 or any(b <= a for a, b in pairs)):
                yield Fault(
                    (*at, "positions"),
                    "not from 0 upwards",
                    "begin with 0 mm at the sealed side, then increase",
                )


def reach(view: FileView) -> Iterator[Fault]:
    """Stated profiles extend from zero pressure to the supply pressure."""
    supply, text = view.number("supply", "pressure"), INPUTS["pressure"].text
    for loc in elements(view):
        count = len(view.items(*loc, "contact"))
        first = view.number(*loc, "contact", 0, "pressure")
        last = view.number(*loc, "contact", count - 1, "pressure")
        if first is not None and first > 0:
            yield Fault(
                (*loc, "contact", 0, "pressure"),
                f"{text(first)}: the profile without pressure is missing",
                "add a profile at 0 bar before it",
            )
        if last is not None and supply is not None and last < supply * (1 - 1e-9):
            yield Fault(
                (*loc, "contact", count - 1, "pressure"),
                f"{text(last)}: the profiles end below supply.pressure ({text(supply)})",
                "add a profile at the supply pressure",
            )


PROFILE_CHECKS = (profiles, reach)
_TYPE = ("retention", "type")


def joint_of(view: FileView) -> Joint | None:
    """The joint of a file; None if unknown."""
    return JOINTS.get(view.text(*_TYPE) or "")


def keys(view: FileView) -> Iterator[Fault]:
    """All keys that the joint needs are stated, and no others."""
    joint = joint_of(view)
    if joint is None:
        return
    yield from _unused(view, joint)
    for field in joint.fields:
        loc = ("retention", *field.key.split("."))
        needed = field.missing and all(view.has(*loc[:end]) for end in range(1, len(loc)))
        if needed and not view.has(*loc):
            yield Fault(loc, field.missing, field.remedy)


def _unused(view: FileView, joint: Joint) -> Iterator[Fault]:
    """Keys that neither the joint nor an alternative among the choices uses, except defaults."""
    offered = [JOINTS.get(name) for name in view.items("choices", ".".join(_TYPE))]
    used = _keys(one for one in (joint, *offered) if one is not None)
    for name, entry in entries(Retention).items():
        value = view.value("retention", name)
        if entry.required or name in used or value is None or value == entry.default:
            continue
        users = [one for one in JOINTS.values() if name in _keys([one])]
        message, remedy = joint.without.get(name) or (
            f"{joint.noun} {_have([joint])} no {name}, "
            f"only {' and '.join(user.noun for user in users)} {_have(users)}",
            f"remove the line, or write type: {' or '.join(user.name for user in users)}",
        )
        yield Fault(("retention", name), message, remedy, at_key=True)


def _keys(joints: Iterable[Joint]) -> set[str]:
    """Keys of `retention` that only some joints use."""
    return {field.key.partition(".")[0] for joint in joints for field in joint.fields}


def _have(joints: list[Joint]) -> str:
    return "have" if len(joints) > 1 or joints[0].plural else "has"


def skirts(view: FileView) -> Iterator[Fault]:
    """The skirts of both ends do not meet on the barrel."""
    joint = joint_of(view)
    if joint is None or not joint.skirts:
        return
    overlap, length = view.number("retention", "length"), view.number("barrel", "length")
    parts = [("cylinder", "stroke"), ("piston", "length"), ("head", "length")]
    known = [one for one in (view.number(*part) for part in parts) if one is not None]
    if length is None and len(known) == len(parts):
        length = sum(known)
    if overlap is not None and length is not None and 2 * overlap > length * (1 + 1e-9):
        yield Fault(
            ("retention", "length"),
            f"{length_text(overlap)}: the skirts of both ends meet on the barrel, which is "
            f"{length_text(length)} long",
            f"write at most {length_text(length / 2)}",
        )


def values(view: FileView) -> Iterator[Fault]:
    """Faults that the joint reports for the values of the file."""
    joint = joint_of(view)
    if joint is not None:
        yield from joint.faults(view)


class _KnownEnds:
    """The library, overridden by the properties that the design states."""

    def __init__(self, view: FileView, materials: MaterialLookup) -> None:
        self._view, self._materials = view, materials

    def kind(self, name: str) -> str | None:
        """Kind of a material; None if the name is unknown."""
        return self._materials.kind(name) if name in self._materials else None

    def properties(self, name: str) -> Iterable[str]:
        """Names of the stated properties; empty if unreadable."""
        if isinstance(self._materials, Properties):
            return known_numbers(self._view, self._materials, name)
        return ()


def of_end_materials(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Faults of the joint that depend on the material library."""
    view = FileView(tree)
    joint = joint_of(view)
    if joint is not None:
        yield from joint.material_faults(view, _KnownEnds(view, materials))
