"""Skirts of the caps bonded over the outside of the barrel and into its bore.

Both skirts are equally long, and carry the force together. The skirt in the bore stands beyond the
chamber: that of the cap lengthens the barrel, and that of the head stands around the head's plug,
with a slot between them. Its inside is filled with oil, so that the pressure closes the bond of a
thin skirt; a skirt so thick that the barrel grows more than it is warned of. The energy
criterion for force and temperature together is not used: it needs the shares of both bonds in the
energy, which only equal skirts have in closed form.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from math import pi

import numpy as np

from ..base.errors import Fault
from ..base.numeric import Array, absolute, minimum
from ..base.quantities import Quantity, length_text
from ..models import end_bending, lap_joint, mass
from ..models.strength_modes import load_multiplier
from . import overlap
from .joint import (
    LEAST_METAL,
    ROUNDING,
    BarrelOpening,
    DrawnPart,
    End,
    EndDimensions,
    EndSpan,
    Fatigue,
    Joint,
    JointField,
    Loaded,
    MaterialProperties,
    StatedValues,
    Strength,
    WallPressures,
    judged_later,
    nothing,
)
from .overlap import Overlap

EDGES = (
    "outer bond at the skirts' edge",
    "inner bond at the skirts' edge",
    "outer bond at the barrel's edge",
    "inner bond at the barrel's edge",
)
"""Locations of the shear, in the order of `lap_joint.DoubleLap`."""
PEELS = ("peel at the outer skirt's edge", "peel at the inner skirt's edge")

OVERHANG = "geometry_inner_skirt"
"""Metric of the length of the head's plug less that of the skirt around it."""

SLOT = 1e-3
"""Width of the slot between the head's plug and the skirt around it [m]. Our choice: a narrow tool
for face grooves."""


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report an inner skirt that does not fit between bore and rod, or beside the piston."""
    if not view.at_head:
        return
    wall, length = (view.number("retention", key) for key in ("inner_wall", "length"))
    bore, rod = view.number("cylinder", "bore"), view.number("rod", "outer_diameter")
    if None not in (wall, bore, rod):
        room = (bore - rod) / 2 - SLOT - LEAST_METAL  # type: ignore[operator]
        sizes = ("retention.inner_wall", "cylinder.bore", "rod.outer_diameter")
        if wall > room * (1 + ROUNDING) and not judged_later(view, sizes):  # type: ignore[operator]
            remedy = f"write at most {length_text(room)}, or" if room > 0 else "write"
            yield Fault(
                ("retention", "inner_wall"),
                f"{length_text(wall)}: the inner skirt, its slot of {length_text(SLOT)} and "  # type: ignore[arg-type]
                f"{length_text(LEAST_METAL)} of the head's plug do not fit between bore and rod",
                f"{remedy} a larger cylinder.bore",
            )
    plug = view.number("head", "length")
    if length is None or plug is None or length <= plug * (1 + ROUNDING):
        return
    if not judged_later(view, ("retention.length", "head.length")):
        yield Fault(
            ("retention", "length"),
            f"{length_text(length)}: the inner skirt is longer than the head's plug, of "
            f"{length_text(plug)}, so the piston would meet it",
            f"write at most {length_text(plug)}, or a longer head.length",
        )


def _fit(end: End) -> EndDimensions:
    sizes, radius = end.sizes, end.outer_radius
    return EndDimensions(
        plate_radius=radius + sizes["wall"],
        radius=radius,
        length=sizes["length"],
        wall=sizes["wall"],
        inner_length=sizes["length"],
        inset=sizes["inner_wall"] + SLOT,
    )


def _inner_area(end: End) -> Array:
    """Cross-section area of the skirt in the bore."""
    wall = end.sizes["inner_wall"]
    return mass.layer_area(inner_radius=end.inner_radius - wall, thickness=wall)


def _mass(end: End, materials: MaterialProperties) -> dict[str, Array]:
    """Mass of both skirts."""
    inner = materials.get(end.cap, "density") * _inner_area(end) * end.sizes["length"]
    return {"caps": overlap.weight(end, materials, end.outer_radius) + inner}


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    """Outlines of both skirts at one end."""
    yield from overlap.outline(end, fit, span)
    outer = float(end.inner_radius)
    inner = outer - float(end.sizes["inner_wall"])
    yield DrawnPart("caps", end.cap, span.over(float(fit.length), inner, outer))


def _notes(end: End) -> Iterator[str]:
    inner = end.inner_radius - end.sizes["inner_wall"]
    volume = pi * inner * inner * end.sizes["length"]
    yield (
        f"The cap's skirt in the bore, {1e3 * end.sizes['inner_wall']:.3g} mm thick, encloses "
        f"{1e6 * volume:.2g} ml of oil: dead_volume_a must include it."
    )


def _sections(loaded: Loaded, bond: Overlap) -> dict[str, Array]:
    """E A of the barrel and of both skirts [N]."""
    end = loaded.end
    modulus = loaded.materials.get(end.cap, "youngs_modulus")
    outer = mass.layer_area(inner_radius=end.outer_radius, thickness=end.sizes["wall"])
    return {
        "tube_stiffness": bond.tube * pi * bond.diameter,
        "outer_stiffness": modulus * outer,
        "inner_stiffness": modulus * _inner_area(end),
    }


def _shear(loaded: Loaded, bond: Overlap, force: Array, strain: Array) -> lap_joint.DoubleLap:
    """Shear at all edges from a force and a free strain of the barrel relative to the skirts."""
    return lap_joint.double_lap(
        force=force,
        strain_difference=strain,
        outer_bond_diameter=2 * loaded.end.outer_radius,
        inner_bond_diameter=2 * loaded.end.inner_radius,
        **_sections(loaded, bond),
        **overlap.lag(loaded.materials, bond.adhesive, bond.length),
    )


def _loaded_edges(loaded: Loaded, bond: Overlap) -> lap_joint.DoubleLap:
    """Shear under the largest force, and its shares in the skirts; the result is cached."""
    cache = loaded.end.cache
    if "double_lap" not in cache:
        cache["double_lap"] = _shear(loaded, bond, loaded.force, 0.0)
    edges: lap_joint.DoubleLap = cache["double_lap"]
    return edges


def _thermal_factor(loaded: Loaded, bond: Overlap, warming: Array, cold: bool) -> Array:
    """Bond strength divided by the largest shear that a temperature change causes at the edges."""
    strength = loaded.materials.allowable(bond.adhesive, "bond_strength", cold=cold)
    factor: Array = None
    for stress in _shear(loaded, bond, 0.0, 1.0)[: len(EDGES)]:
        edge = load_multiplier(absolute(stress * bond.mismatch * warming) / strength)
        factor = edge if factor is None else minimum(factor, edge)
    return factor


def _strength(loaded: Loaded) -> Strength | str:
    bond, materials, end = overlap.of_skirt(loaded), loaded.materials, loaded.end
    if isinstance(bond, str):
        return bond
    strength = materials.allowable(bond.adhesive, "bond_strength")
    edges = {
        place: load_multiplier(absolute(stress) / strength)
        for place, stress in zip(EDGES, _loaded_edges(loaded, bond), strict=False)
    }
    plies = overlap.peel(loaded, PEELS[0], edges[EDGES[0]]) | overlap.peel(
        loaded, PEELS[1], edges[EDGES[1]], layer=0, thickness=end.sizes["inner_wall"]
    )
    area = 2 * pi * (end.inner_radius + end.outer_radius) * end.sizes["length"]
    thermal = bond.thermal(materials)
    return Strength(
        edges | plies,
        {"": strength * area / loaded.force},
        thermal if isinstance(thermal, str) else partial(_thermal_factor, loaded, bond),
    )


def _yields(loaded: Loaded) -> dict[str, Array]:
    """Yield strength divided by stress, of both skirts."""
    bond = overlap.of_skirt(loaded)
    strength = loaded.materials.allowable(loaded.end.cap, "yield_strength")
    if isinstance(bond, str) or strength is None:
        return {}
    edges, sections = _loaded_edges(loaded, bond), _sections(loaded, bond)
    modulus = loaded.materials.get(loaded.end.cap, "youngs_modulus")
    return {
        "outer skirt": strength * sections["outer_stiffness"] / modulus / edges.outer_force,
        "inner skirt": strength * sections["inner_stiffness"] / modulus / edges.inner_force,
    }


def _own(loaded: Loaded) -> dict[str, Array]:
    """Length of the head's plug less that of the skirt around it [m]; optimisations limit it."""
    head = loaded.end.head_length
    return {} if head is None else {OVERHANG: head - loaded.end.sizes["length"]}


def _opened(loaded: Loaded) -> bool:
    """Whether the pressure in an inner skirt is too low to make it follow the barrel beside it.

    Pressure widens the skirt alone by p r^2/(E t), with its middle radius r, and the barrel beside
    it by w. If w is larger, the barrel pulls at the bond. The adhesive's give and the outer skirt,
    which both help, are left out.
    """
    end, modulus = loaded.end, loaded.materials.get(loaded.end.cap, "youngs_modulus")
    if not loaded.shells or modulus is None:
        return False
    wall = end_bending.shell(layers=loaded.shells, inner_radius=end.inner_radius)
    beside = end_bending.free_growth(
        wall=wall, pressure=loaded.pressure, bore_radius=end.inner_radius, line_force=0.0
    )
    thickness = end.sizes["inner_wall"]
    middle = end.inner_radius - thickness / 2
    alone = loaded.pressure * middle * middle / (modulus * thickness)
    return bool(np.any(np.real(alone) < np.real(beside)))


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn that force and heat are checked apart, and of a bond that the pressure opens."""
    if _opened(loaded):
        yield (
            "retention_factor",
            "the pressure opens the bond of the inner skirt, which is not checked: the barrel "
            "grows more than the skirt. Write a smaller inner_wall or a thicker barrel",
        )
    if not isinstance(overlap.of_skirt(loaded), str):
        yield (
            "retention_burst_factor",
            "force and temperature act on the bonds together, but are checked apart: no energy "
            "criterion is known for two unequal skirts",
        )


JOINT = Joint(
    name="double_lap",
    help="bonded skirts over the barrel and in its bore",
    noun="a double-lap bond",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField(
            "material",
            "missing: a double-lap bond needs an adhesive",
            'add e.g. "material: epoxy_structural"',
        ),
        JointField(
            "inner_wall",
            "missing: required by a double-lap bond",
            'add e.g. "inner_wall: 1 mm"',
            quantity="wall_thickness",
            help="thickness of the skirt in the bore",
        ),
    ),
    kinds=("adhesive",),
    without={},
    faults=_faults,
    material_faults=nothing,
    opening=lambda _: BarrelOpening("once", "Bond both skirts of the {end} to the barrel."),
    form="skirts",
    fit=_fit,
    clamping=None,
    mass=_mass,
    outline=_outline,
    notes=_notes,
    give=None,
    strength=_strength,
    yields=_yields,
    wall=lambda loaded: WallPressures(),
    beside=overlap.edge_beside,
    fatigue=lambda loaded: Fatigue(),
    own=_own,
    envelope=overlap.mean_envelope,
    metrics={OVERHANG: "no skirt in the bore"},
    judged=("peak bond shear", "mean bond shear"),
    models={
        **{("retention_factor", place): "lap_joint.double_lap" for place in EDGES},
        **{("retention_factor", place): "lap_joint.edge_peel" for place in PEELS},
        ("yield_factor", "outer skirt"): "lap_joint.double_lap",
        ("yield_factor", "inner skirt"): "lap_joint.double_lap",
    },
    usual=(),
    warnings=_warnings,
)
