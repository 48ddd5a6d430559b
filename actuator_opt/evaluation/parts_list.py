"""The parts list: pieces and materials of each entry of the mass breakdown."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from ..design.choices import COMPONENTS
from ..design.model import Design
from ..design.seals import BACK_UPS
from ..design.standard_sizes import port
from ..joints.joint import ENCLOSED
from .geometry import bearing_of, joints_of, static_places
from .result import Evaluation
from .rods import end_material
from .weight import SECOND, STATED, STATED_MOVING


class ListedPart(NamedTuple):
    """An entry of the parts list; `pieces` is None for parts of several kinds."""

    part: str
    pieces: int | None
    material: str
    mass: float


def parts_list(evaluation: Evaluation) -> tuple[ListedPart, ...]:
    """All entries of the mass breakdown with their pieces and materials."""
    design = evaluation.design
    known = _entries(design) | _optional(design)
    return tuple(
        ListedPart(part, *known[part], mass) for part, mass in evaluation.mass_parts.items()
    )


def _joined(names: Iterable[str | None]) -> str:
    return ", ".join(dict.fromkeys(name for name in names if name))


def _entries(design: Design) -> dict[str, tuple[int | None, str]]:
    """Pieces and materials of the parts that every design has."""
    rod, fitting, clevis = design.rod, design.rod.fitting, design.clevis
    layers = [layer.material for layer in rod.layup]
    joints = {bonded: _of_joints(design, bonded=bonded) for bonded in (True, False)}
    held = [end_material(design), *joints[False]] if _fastened(design) else []
    bearing = bearing_of(design)
    eyes = "" if clevis is None else clevis.material
    if bearing is not None:
        eyes += f" with {bearing.name.upper()}, ISO 12240-1"
    return {
        "barrel": (1, _joined(layer.material for layer in design.barrel.layup)),
        "rod": (1, _joined(layers or [rod.material])),
        "piston": (1, design.piston.material),
        "caps": (2, _joined([design.caps.material, *joints[True]])),
        "glands": (2 if design.double_rod else 1, design.head.material),
        "seals": (_rings(design), _joined(_compounds(design))),
        "fastening": (None, _joined([*held, None if fitting is None else fitting.adhesive])),
        "clevises": (0 if clevis is None else 1 if design.double_rod else 2, eyes),
    }


def _of_joints(design: Design, *, bonded: bool) -> list[str | None]:
    """Materials of the joints of the ends that are bonded, or of the others."""
    ends = joints_of(design)
    return [end.section.material for end in ends if ("adhesive" in end.joint.kinds) == bonded]


def _fastened(design: Design) -> bool:
    """Whether a design has parts that fasten others: threads, fittings, nut, rings or tie rods."""
    parts = (design.rod.thread, design.rod.fitting, design.piston.nut)
    held = any("adhesive" not in end.joint.kinds for end in joints_of(design))
    return held or any(part is not None for part in parts)


def _optional(design: Design) -> dict[str, tuple[int | None, str]]:
    """Pieces and materials of the parts that only some designs have."""
    entries: dict[str, tuple[int | None, str]] = {}
    if design.double_rod:
        second = None if design.second_rod is None else design.second_rod.material
        entries[SECOND] = (1, second or design.rod.material)
    if design.cylinder.port_thread is not None:
        size = port(design.cylinder.port_thread)
        joints = joints_of(design)
        bosses = sum(end.count for end in joints if end.joint.form in ENCLOSED)
        entries["ports"] = (bosses, f"{design.caps.material}, {size.thread}, {size.standard}")
    if design.sensor is not None:
        entries["sensor"] = (1, design.sensor.type)
    for part in (STATED, STATED_MOVING):
        listed = [
            component
            for component in design.extra_masses
            if (component.place in ("piston", "rod")) == (part == STATED_MOVING)
        ]
        kinds = [COMPONENTS.get(component.kind, component.kind) for component in listed]
        entries[part] = (round(sum(component.count for component in listed)), _joined(kinds))
    return entries


def _rings(design: Design) -> int:
    """Number of seals, back-up rings, wipers and guide rings."""
    total = float(sum(place != "" for place in static_places(design)))
    rods = 2 if design.double_rod else 1
    for seal, places in ((design.seals.piston, 1), (design.seals.rod, rods)):
        for element in seal.elements().values():
            total += places * element.count * (1 + BACK_UPS[element.back_up])
        guides = 0.0 if seal.guide is None else seal.guide.count
        total += places * ((seal.wiper is not None) + guides)
    return round(total)


def _compounds(design: Design) -> list[str]:
    static = design.seals.static
    names = [*design.seals.piston.materials(), *design.seals.rod.materials()]
    return names if static is None else [*names, static.compound]
