"""Check barrel, rod and joint: impossible layers, unsuitable materials, unsuitable keys.

Each joint of caps and head has a module in `joints`. That module declares the keys of the block
`retention` that the joint uses, and the checks of their values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from ..base import quantities
from ..base.errors import Fault, InputError
from ..base.quantities import length_text
from ..joints import sleeve
from ..joints.joint import Joint
from ..joints.kinds import JOINTS
from .double_rod import has_second_rod, rod_size
from .material import PLY_CONSTANTS, PLY_REQUIRED, compliance_determinant, ply_constants
from .model import EndRetention, Ply
from .paths import spell
from .structure import (
    FileView,
    Loc,
    MaterialLookup,
    Properties,
    child,
    child_at,
    entries,
    how_to_add,
    lists_of,
    number_of,
)

PLY_STRENGTHS = (
    "strength_1_tension", "strength_1_compression", "strength_2_tension",
    "strength_2_compression", "strength_12",
)  # fmt: skip
"""Strengths that every failure criterion needs; other strengths have default values."""

_WITHOUT_PLIES = ("isotropic", "as_published")
"""Wall models that do not predict the failure of plies."""

_ELASTIC = (*PLY_CONSTANTS, "youngs_modulus", "poissons_ratio", "shear_modulus")


def signs(view: FileView) -> Iterator[Fault]:
    """Check that the angle of a balanced pair is not negative, and neither is its lower bound."""
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
                        f"{text(angle)}: the angle of a balanced +-pair has no sign",
                        f'write {text(-angle)}, or add "balanced: false" for one signed ply'
                        if place == loc
                        else f'write 0 deg or more, or add "balanced: false" to {spell(loc[:-1])}',
                    )


def barrel_model(view: FileView) -> Iterator[Fault]:
    """Check that the isotropic wall model is used with a single layer."""
    layers = len(view.items("barrel", "layup"))
    if view.text("barrel", "model") == "isotropic" and layers > 1:
        yield Fault(
            ("barrel", "model"),
            f"isotropic: this model supports a single layer, but the layup has {layers}",
            "write auto, or keep one layer",
        )


def autofrettage(view: FileView) -> Iterator[Fault]:
    """Check that autofrettage exceeds the supply pressure, and that layers surround the liner."""
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
        remedy = "remove the line, or add layers around the liner"
        yield Fault(
            loc,
            "the wall is a single layer, so nothing around it keeps a liner compressed",
            remedy,
            at_key=True,
        )


def laminated_rod(view: FileView) -> Iterator[Fault]:
    """Check that the layers of a laminated rod leave a bore, which the file itself must not state.

    Also check that the fittings fit into this bore, and that no other rod states fittings.
    """
    layers = len(view.items("rod", "layup"))
    if not layers:
        if view.has("rod", "fitting"):
            remedy = "remove it, or add the layers as rod.layup"
            yield Fault(
                ("rod", "fitting"), "only a rod with layup has fittings", remedy, at_key=True
            )
        return
    why = "the bore of a laminated rod follows from outer_diameter and its layers"
    if view.number("rod", "inner_diameter"):
        yield Fault(("rod", "inner_diameter"), why, "remove the line", at_key=True)
    variable = ("variables", "rod.inner_diameter")
    if child_at(view.tree, variable) is not None:
        remedy = "remove it; vary e.g. rod.layup[0].thickness"
        yield Fault(variable, why, remedy, at_key=True)
    outer = view.number("rod", "outer_diameter")
    parts = [view.number("rod", "layup", index, "thickness") for index in range(layers)]
    thicknesses = [part for part in parts if part is not None]
    if outer is None or len(thicknesses) < layers:
        return
    total = sum(thicknesses)
    if 2 * total >= outer * (1 - 1e-9):
        yield Fault(
            ("rod", "layup"),
            f"layers of {length_text(total)} leave no bore in a rod of {length_text(outer)}",
            f"write less than {length_text(outer / 2)} in total, or increase rod.outer_diameter",
            at_key=True,
        )
        return
    wall, room = view.number("rod", "fitting", "wall"), outer / 2 - total
    if wall is not None and wall > room * (1 + 1e-9):
        yield Fault(
            ("rod", "fitting", "wall"),
            f"{length_text(wall)}: too thick for a bore with a radius of {length_text(room)}",
            f"write at most {length_text(room)}, or remove it for a solid fitting",
        )


CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    signs,
    barrel_model,
    autofrettage,
    laminated_rod,
)


def of_materials(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Yield faults of the walls that depend on the material library."""
    view = FileView(tree)
    yield from _kinds(view, materials)
    if isinstance(materials, Properties):
        properties = _StatedProperties(view, materials)
        yield from _strengths(view, properties)
        yield from _stiffness(view, properties)


def _names(view: FileView, wall: Loc) -> list[str | None]:
    return [view.text(*wall, index, "material") for index in range(len(view.items(*wall)))]


def _kinds(view: FileView, materials: MaterialLookup) -> Iterator[Fault]:
    """Check for a metal liner under autofrettage, and for metal fittings in a laminated rod."""
    first = next(iter(_names(view, ("barrel", "layup"))), None)
    stated = view.number("barrel", "autofrettage_pressure") is not None
    if stated and first is not None and materials.kind(first) not in (None, "metal"):
        yield Fault(
            ("barrel", "autofrettage_pressure"),
            f"the innermost layer is {first}, not a metal liner that could yield",
            "remove the line, or add a metal liner",
            at_key=True,
        )
    layer_names = [name for name in _names(view, ("rod", "layup")) if name is not None]
    if any(materials.kind(name) == "ply" for name in layer_names) and not view.has(
        "rod", "fitting"
    ):
        yield Fault(
            ("rod", "fitting"),
            "missing: a laminated rod needs bonded end fittings",
            'add a block "fitting:" with adhesive and length',
        )


class _StatedProperties:
    """Properties of the library's materials; those that the design states replace them."""

    def __init__(self, view: FileView, materials: Properties) -> None:
        self.block = child(view.tree, "materials")
        self.materials = materials

    def changed(self, name: str) -> dict[str, float]:
        """Properties that the design states; faulty values are omitted."""
        block = child(self.block, name)
        pairs = block.items() if isinstance(block, Mapping) else ()
        return {key: value for key, value in pairs if isinstance(value, float)}

    def numbers(self, name: str) -> dict[str, float]:
        """All known properties; empty if the entry is missing or faulty (a separate fault)."""
        try:
            return {**self.materials.numbers(name), **self.changed(name)}
        except InputError:
            return {}


def known_numbers(view: FileView, materials: Properties, name: str) -> dict[str, float]:
    """Properties of a material from library and design; empty if missing or faulty."""
    return _StatedProperties(view, materials).numbers(name)


def _strengths(view: FileView, properties: _StatedProperties) -> Iterator[Fault]:
    """Check that every ply of the barrel has the strengths that the failure criterion needs."""
    criterion = view.text("barrel", "criterion")
    if not view.has("barrel", "criterion") or view.text("barrel", "model") in _WITHOUT_PLIES:
        return
    for name in dict.fromkeys(_names(view, ("barrel", "layup"))):
        numbers = properties.numbers(name) if name is not None else {}
        missing = [key for key in PLY_STRENGTHS if key not in numbers]
        if "youngs_modulus_1" in numbers and missing:
            yield Fault(
                ("barrel", "criterion"),
                f"{criterion}: {name} has no {', '.join(missing)}",
                f'add e.g. "{missing[0]}: 60 MPa" under materials.{name}, or use another material',
            )


def _stiffness(view: FileView, properties: _StatedProperties) -> Iterator[Fault]:
    """Check that elastic constants changed by the design give a positive definite stiffness."""
    for name in properties.block if isinstance(properties.block, Mapping) else ():
        changed = [key for key in properties.changed(name) if key in _ELASTIC]
        numbers = properties.numbers(name) if changed else {}
        if "youngs_modulus_1" in numbers and not set(PLY_REQUIRED) <= set(numbers):
            continue
        constants = ply_constants(numbers)
        if constants and not compliance_determinant(constants) > 0:
            ratios = [key for key in changed if key.startswith("poissons")]
            yield Fault(
                ("materials", name, (ratios or changed)[-1]),
                "these elastic constants are impossible: the stiffness is not positive definite",
                "correct the Poisson's ratios or the moduli: nu_12^2 < E_1/E_2 and similar",
            )


_BLOCK = "retention"


class EndView(FileView):
    """Reads a file in which `retention` is the block of one end, such as `retention.cap`.

    The module of a joint thus finds all its keys under `retention`, and PATHs in `variables` and
    `choices` too. `at` is the location of the block.
    """

    def __init__(self, view: FileView, *at: str) -> None:
        super().__init__(view.tree, view.root)
        self.at = at

    def value(self, *loc: str | int) -> Any:
        """Value at a location; if not stated, its default."""
        return super().value(*self._placed(loc))

    def has(self, *loc: str | int) -> bool:
        """Whether the file states a value at this location."""
        return super().has(*self._placed(loc))

    def _placed(self, loc: Loc) -> Loc:
        if loc[0] == _BLOCK:
            return (*self.at, *loc[1:])
        if loc[0] in ("choices", "variables"):
            return (loc[0], *(self._text(str(key)) for key in loc[1:]))
        if loc == ("rod", "outer_diameter") and self.at[-1] == "cap":
            return rod_size(self, "cap")[0] if has_second_rod(self) else loc
        return loc

    def _text(self, text: str) -> str:
        return text.replace(f"{_BLOCK}.", f"{'.'.join(self.at)}.")

    def located(self, fault: Fault) -> Fault:
        """A fault with location and texts that name the block of this end."""
        return replace(
            fault,
            loc=self._placed(fault.loc),
            message=self._text(fault.message),
            remedy=self._text(fault.remedy),
        )

    @property
    def at_head(self) -> bool:
        """Whether a rod passes an end that the joint holds: the head, or the cap of two rods."""
        return self.at[-1] != "cap" or has_second_rod(self)

    @property
    def joint(self) -> Joint | None:
        """The joint that the file names; None if unknown."""
        return JOINTS.get(self.text(_BLOCK, "type") or "")

    @property
    def sleeved(self) -> bool:
        """Whether the joint is cut into a sleeve."""
        return self.has(_BLOCK, sleeve.KEY) and self.joint is not None and _uses_sleeve(self.joint)

    @property
    def cut(self) -> EndView:
        """The view of the part into which the joint is cut: the sleeve instead of the barrel."""
        return SleeveView(FileView(self.tree, self.root), *self.at) if self.sleeved else self


def _uses_sleeve(joint: Joint) -> bool:
    return sleeve.KEY in _keys([joint])


class SleeveView(EndView):
    """Reads a file in which the sleeve of an end is the only layer of the barrel."""

    _LAYER, _KEYS = ("barrel", "layup", 0), ("wall", "material")

    def value(self, *loc: str | int) -> Any:
        """Value at a location; if not stated, its default."""
        if loc == self._LAYER[:2]:
            return [super().value(*self.at, sleeve.KEY)]
        return super().value(*loc)

    def _placed(self, loc: Loc) -> Loc:
        if loc[:3] == self._LAYER:
            keys = ("wall" if key == "thickness" else key for key in loc[3:])
            return (*self.at, sleeve.KEY, *keys)
        return super()._placed(loc)

    def _text(self, text: str) -> str:
        place = f"{_BLOCK}.{sleeve.KEY}"
        for name, here in (
            ("barrel.layup[0].thickness", f"{place}.wall"),
            ("barrel.layup[0]", place),
            ("the innermost layer", "the sleeve"),
            ("the outermost layer of the barrel", "the sleeve"),
        ):
            text = text.replace(name, here)
        return super()._text(text)


def ends(view: FileView) -> tuple[EndView, ...]:
    """The view of each end, or one view if both ends have the same joint."""
    names = [name for name in ("cap", "head") if view.has(_BLOCK, name)]
    if not names:
        return (EndView(view, _BLOCK),)
    return tuple(EndView(view, _BLOCK, name) for name in names)


def keys(view: FileView) -> Iterator[Fault]:
    """Check that `retention` states all input keys that its joint needs, and no others."""
    if not view.has(_BLOCK):
        return
    yield from _both_or_each(view)
    for end in ends(view):
        if (joint := end.joint) is not None:
            yield from map(end.located, _keys_of_end(end, joint))


def _both_or_each(view: FileView) -> Iterator[Fault]:
    """Check that a file states one joint for both ends, or one joint for each end."""
    views, own = ends(view), entries(EndRetention)
    if views[0].at == (_BLOCK,):
        for name, entry in own.items():
            if entry.required and not view.has(_BLOCK, name):
                yield Fault((_BLOCK, name), "missing", how_to_add(name, entry))
        return
    if len(views) == 1:
        stated = views[0].at[-1]
        other = "head" if stated == "cap" else "cap"
        message = f"missing: {stated} has a joint of its own, so {other} needs one too"
        yield Fault((_BLOCK, other), message, f'add a block "{other}:" with its type and length')
    for name, entry in own.items():
        value = view.value(_BLOCK, name)
        if value is not None and value != entry.default:
            remedy = "move the line into cap: or head:"
            yield Fault((_BLOCK, name), "without effect beside cap and head", remedy, at_key=True)
    for end in views:
        if (joint := end.joint) is not None and joint.clamping is not None:
            message = f"{joint.noun} clamp both ends, so they cannot hold one end alone"
            remedy = f"write type: {joint.name} under retention, without cap and head"
            yield Fault((*end.at, "type"), message, remedy)


def _keys_of_end(end: EndView, joint: Joint) -> Iterator[Fault]:
    yield from _unused(end, joint)
    for field in joint.fields:
        loc = (_BLOCK, *field.key.split("."))
        needed = field.missing and all(end.has(*loc[:stop]) for stop in range(1, len(loc)))
        if needed and not end.has(*loc):
            yield Fault(loc, field.missing, field.remedy)


def _unused(end: EndView, joint: Joint) -> Iterator[Fault]:
    """Yield a fault for each stated key that the joint does not use.

    Keys that an alternative joint in `choices` uses are allowed, as are default values.
    """
    alternatives = [JOINTS.get(name) for name in end.items("choices", f"{_BLOCK}.type")]
    used = _keys(candidate for candidate in (joint, *alternatives) if candidate is not None)
    for name, entry in entries(EndRetention).items():
        value = end.value(_BLOCK, name)
        if entry.required or name in used or value is None or value == entry.default:
            continue
        users = [candidate for candidate in JOINTS.values() if name in _keys([candidate])]
        message, remedy = joint.without.get(name) or (
            f"{joint.noun} {_have([joint])} no {name}, "
            f"only {' and '.join(user.noun for user in users)} {_have(users)}",
            f"remove the line, or write type: {' or '.join(user.name for user in users)}",
        )
        yield Fault((_BLOCK, name), message, remedy, at_key=True)


def _keys(joints: Iterable[Joint]) -> set[str]:
    """Keys of `retention` that these joints use."""
    return {field.key.partition(".")[0] for joint in joints for field in joint.fields}


def _have(joints: list[Joint]) -> str:
    return "have" if len(joints) > 1 or joints[0].plural else "has"


def skirts(view: FileView, spigot: float) -> Iterator[Fault]:
    """Check that the skirts of cap and head, which overlap the barrel, do not meet on it.

    The cap's `spigot` [m] lengthens the barrel.
    """
    with_skirts = [end for end in ends(view) if end.joint and end.joint.form == "skirts"]
    overlaps = [end.number(_BLOCK, "length") for end in with_skirts]
    length = view.number("barrel", "length")
    parts = [("cylinder", "stroke"), ("piston", "length"), ("head", "length")]
    lengths = [number for number in (view.number(*part) for part in parts) if number is not None]
    if length is None and len(lengths) == len(parts):
        length = sum(lengths)
    length = None if length is None else length + spigot
    known = [overlap for overlap in overlaps if overlap is not None]
    if not known or len(known) < len(overlaps) or length is None:
        return
    both = view.has(_BLOCK, "cap")
    if (sum(known) if both else 2 * known[0]) > length * (1 + 1e-9):
        rest = length - sum(known[:-1]) if both else length / 2
        yield Fault(
            (*with_skirts[-1].at, "length"),
            f"{length_text(known[-1])}: the skirts of both ends meet on the barrel, which is "
            f"{length_text(length)} long",
            f"write at most {length_text(rest)}",
        )


def values(view: FileView) -> Iterator[Fault]:
    """Yield the faults that the modules of the joints find in the file's values."""
    for end in ends(view):
        if (joint := end.joint) is not None:
            yield from map(end.cut.located, joint.faults(end.cut))
            if end.sleeved:
                yield from map(end.located, sleeve.faults(end))


class _EndMaterials:
    """The library, where properties that the design states replace those of the library."""

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

    def numbers(self, name: str) -> Mapping[str, float]:
        """Stated properties, and all elastic constants of a ply; empty if unreadable."""
        if not isinstance(self._materials, Properties) or name not in self._materials:
            return {}
        stated = known_numbers(self._view, self._materials, name)
        return {**stated, **ply_constants(stated)}


def of_end_materials(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Yield the faults of the joint that depend on the material library."""
    view = FileView(tree)
    for end in ends(view):
        if (joint := end.joint) is not None:
            known = _EndMaterials(view, materials)
            yield from map(end.cut.located, joint.material_faults(end.cut, known))
            if end.sleeved:
                yield from map(end.located, sleeve.material_faults(end, known))
