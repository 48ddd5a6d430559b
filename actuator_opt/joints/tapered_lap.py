"""Skirts of the caps bonded over the outside of the barrel, tapered to their free end.

A taper lowers shear and peel at the skirt's edge, and leaves the shear at the barrel's edge as it
is. Keys, adhesive and mass are those of `bond`; the taper adds its length and the thickness of its
tip.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from math import pi

import numpy as np

from ..base.errors import Fault
from ..base.numeric import Array, absolute, maximum, minimum, sqrt
from ..base.quantities import Quantity, length_text
from ..models import lap_joint
from ..models.strength_modes import load_multiplier
from . import overlap
from .joint import (
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

AT_TIP = "tapered bond at the skirt's tip"
AT_TUBE = "tapered bond at the barrel's edge"
PEEL = "peel of the plies at the skirt's tip"
TAPER = "taper of the skirt"

REST = "geometry_taper"
"""Metric of the length of the skirt that does not taper."""

LONG = 3.0
"""Number of decay lengths that the skirt's full wall must reach from the barrel's edge, for the
energy criterion to hold there: 95 % of the shear is within them."""


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report a taper that is longer than the skirt."""
    length, taper = (view.number("retention", key) for key in ("length", "taper_length"))
    if length is None or taper is None or taper <= length * (1 + ROUNDING):
        return
    if not judged_later(view, ("retention.length", "retention.taper_length")):
        yield Fault(
            ("retention", "taper_length"),
            f"{length_text(taper)}: the taper is longer than the skirt, which overlaps the barrel "
            f"by {length_text(length)}",
            f"write at most {length_text(length)}",
        )


def _fit(end: End) -> EndDimensions:
    return overlap.fit(end, end.outer_radius)


def _mass(end: End, materials: MaterialProperties) -> dict[str, Array]:
    """Mass of the skirt: that of a plain one, less what the taper removes.

    The outer radius falls by (1 - tip) t over the taper; the cut has the section of a triangle.
    """
    sizes, density = end.sizes, materials.get(end.cap, "density")
    fall = (1 - sizes["tip"]) * sizes["wall"]
    radius = end.outer_radius + sizes["wall"] - fall / 3  # of the triangle's centroid
    cut = pi * radius * fall * sizes["taper_length"]
    return {"caps": overlap.weight(end, materials, end.outer_radius) - density * cut}


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    """Outline of the skirt at one end."""
    length, inner = float(fit.length), float(fit.radius)
    outer = inner + float(fit.wall)
    tip = inner + float(end.sizes["tip"]) * float(fit.wall)
    full = length - float(end.sizes["taper_length"])
    corners = [(0.0, inner), (length, inner), (length, tip), (full, outer), (0.0, outer)]
    if full <= 0:
        corners.pop()
    shape = tuple((span.face + span.inwards * x, r) for x, r in corners)
    yield DrawnPart("caps", end.cap, shape)


def _notes(end: End) -> Iterator[str]:
    sizes = end.sizes
    yield (
        f"Skirts taper over {1e3 * sizes['taper_length']:.4g} mm to "
        f"{1e3 * sizes['tip'] * sizes['wall']:.3g} mm at their free end."
    )


def _shear(loaded: Loaded, bond: Overlap, force: Array, strain: Array) -> lap_joint.TaperedLap:
    """Shear at both edges from a force and a free strain of the barrel relative to the skirt."""
    sizes = loaded.end.sizes
    return lap_joint.tapered_lap(
        line_force=force / (pi * bond.diameter),
        strain_difference=strain,
        taper_length=sizes["taper_length"],
        tip=sizes["tip"],
        skirt_stiffness=bond.metal,
        tube_stiffness=bond.tube,
        **overlap.lag(loaded.materials, bond.adhesive, sizes["length"]),
    )


def _loaded_edges(loaded: Loaded, bond: Overlap) -> lap_joint.TaperedLap:
    """Shear under the largest force; the result is cached."""
    cache = loaded.end.cache
    if "tapered_lap" not in cache:
        cache["tapered_lap"] = _shear(loaded, bond, loaded.force, 0.0)
    edges: lap_joint.TaperedLap = cache["tapered_lap"]
    return edges


def _yields(loaded: Loaded) -> dict[str, Array]:
    """Yield strength divided by stress, of the skirt, its taper, and the barrel beside it.

    Shear is largest at an edge, so that N_s <= tau x at a distance x from the tip. The stress of
    the taper is thus at most tau l/t, with its length l and the full wall t.
    """
    bond, end = overlap.of_skirt(loaded), loaded.end
    strength = loaded.materials.allowable(end.cap, "yield_strength")
    if isinstance(bond, str) or strength is None:
        return overlap.yields(loaded)
    stress = maximum(*_loaded_edges(loaded, bond)) * end.sizes["taper_length"] / end.sizes["wall"]
    return overlap.yields(loaded) | {TAPER: strength / stress}


def _thermal_factor(loaded: Loaded, bond: Overlap, warming: Array, cold: bool) -> Array:
    """Bond strength divided by the larger shear that a temperature change causes at the edges."""
    strength = loaded.materials.allowable(bond.adhesive, "bond_strength", cold=cold)
    edges = _shear(loaded, bond, 0.0, 1.0)
    at_tip, at_tube = (
        load_multiplier(absolute(stress * bond.mismatch * warming) / strength) for stress in edges
    )
    return minimum(at_tip, at_tube)


def _strength(loaded: Loaded) -> Strength | str:
    bond, materials = overlap.of_skirt(loaded), loaded.materials
    if isinstance(bond, str):
        return bond
    strength = materials.allowable(bond.adhesive, "bond_strength")
    edges = _loaded_edges(loaded, bond)
    at_tip = strength / edges.at_tip
    sizes = loaded.end.sizes
    plies = overlap.peel(loaded, PEEL, at_tip, thickness=sizes["tip"] * sizes["wall"])
    thermal = bond.thermal(materials)
    return Strength(
        {AT_TIP: at_tip, AT_TUBE: strength / edges.at_tube} | plies,
        {"": bond.mean_factor(materials, loaded.force)},
        thermal if isinstance(thermal, str) else partial(_thermal_factor, loaded, bond),
        partial(bond.ultimate_factor, materials, loaded.force) if bond.ductile(materials) else None,
    )


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn of limits of the energy criterion.

    At the tip, the criterion of a skirt without taper is a lower bound: the taper takes
    int N_s^2/2 d(1/K_s) of the energy that reaches the edge. At the barrel's edge it needs a long
    end of full wall.
    """
    yield from overlap.apart(loaded)
    bond = overlap.of_skirt(loaded)
    if isinstance(bond, str) or not bond.ductile(loaded.materials):
        return
    sizes = loaded.end.sizes
    common = overlap.lag(loaded.materials, bond.adhesive, sizes["length"])
    flex = 1 / bond.metal + 1 / bond.tube
    needed = LONG / sqrt(common["shear_modulus"] / common["bond_thickness"] * flex)
    length, rest, full = (
        float(np.min(np.real(size)))
        for size in (sizes["length"], sizes["length"] - sizes["taper_length"], needed)
    )
    if rest < full * (1 - ROUNDING):
        remedy = (
            f"write a taper_length of at most {length_text(length - full)}"
            if length > full
            else "no taper is short enough for this length"
        )
        yield (
            "retention_burst_factor",
            "force and temperature together are checked for a skirt of full wall at the barrel's "
            f"edge, but it tapers within {length_text(full)} of this edge: {remedy}",
        )


JOINT = Joint(
    name="tapered_lap",
    help="bonded skirts over the barrel that taper to their free end",
    noun="a tapered bond",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField(
            "material",
            "missing: a tapered bond needs an adhesive",
            'add e.g. "material: epoxy_structural"',
        ),
        JointField(
            "tip",
            "missing: required by a tapered bond",
            'add e.g. "tip: 0.2"',
            quantity="thickness_ratio",
            help="thickness of a tapered skirt's tip, as a share of its wall",
        ),
        JointField(
            "taper_length",
            "missing: required by a tapered bond",
            'add e.g. "taper_length: 8 mm"',
            quantity="part_length",
            help="length over which a skirt tapers to its free end",
        ),
    ),
    kinds=("adhesive",),
    without={},
    faults=_faults,
    material_faults=nothing,
    opening=lambda _: BarrelOpening("once", "Bond the tapered skirt of the {end} over the barrel."),
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
    own=lambda loaded: {REST: loaded.end.sizes["length"] - loaded.end.sizes["taper_length"]},
    envelope=overlap.mean_envelope,
    metrics={REST: "the skirts do not taper"},
    judged=("peak bond shear", "mean bond shear"),
    models={
        ("retention_factor", AT_TIP): "lap_joint.tapered_lap",
        ("retention_factor", AT_TUBE): "lap_joint.tapered_lap",
        ("retention_factor", PEEL): "lap_joint.edge_peel",
        ("yield_factor", TAPER): "lap_joint.tapered_lap",
    },
    usual=(),
    warnings=_warnings,
)
