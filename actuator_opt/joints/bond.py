"""Skirts of the caps bonded over the outside of the barrel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from ..base.numeric import Array
from ..base.quantities import Quantity
from ..models import lap_joint
from . import overlap
from .joint import (
    End,
    EndDimensions,
    Fatigue,
    Joint,
    JointField,
    Loaded,
    MaterialProperties,
    Strength,
    WallPressures,
    nothing,
)
from .overlap import BOND_THICKNESS, Overlap, mismatch

AT_SKIRT = "bond at the skirt's edge"
PEEL = "peel of the plies at the skirt's edge"
TO_YOUNG = 2.6
"""Young's modulus divided by shear modulus, 2 (1 + nu), of an adhesive that states no Young's
modulus: Poisson's ratio 0.3, our choice."""


def _fit(end: End) -> EndDimensions:
    return overlap.fit(end, end.outer_radius)


def _mass(end: End, materials: MaterialProperties) -> dict[str, Array]:
    return {"caps": overlap.weight(end, materials, end.outer_radius)}


def _overlap(loaded: Loaded) -> Overlap | str:
    """The bonded overlap of skirt and barrel, or the reason why it cannot be assessed."""
    end, materials = loaded.end, loaded.materials
    if end.material is None:
        return "a bond needs an adhesive: add retention.material"
    modulus = materials.get(end.cap, "youngs_modulus")
    adhesive = (materials.get(end.material, key) for key in ("bond_strength", "shear_modulus"))
    if any(value is None for value in (modulus, *adhesive)):
        return "the adhesive has no bond strength or shear modulus, or the caps have no modulus"
    return Overlap(
        adhesive=end.material,
        diameter=2 * end.outer_radius,
        length=end.sizes["length"],
        tube=loaded.line_stiffness,
        metal=modulus * end.sizes["wall"],
        mismatch=mismatch(materials, end.cap, loaded.expansion),
        names=("barrel", "skirt"),
    )


def _strength(loaded: Loaded) -> Strength | str:
    overlap = _overlap(loaded)
    if isinstance(overlap, str):
        return overlap
    edges = overlap.edge_factors(loaded.materials, loaded.force)
    ductile = overlap.ductile(loaded.materials)
    return Strength(
        edges | _peel(loaded, edges[AT_SKIRT]),
        {"": overlap.mean_factor(loaded.materials, loaded.force)},
        overlap.thermal(loaded.materials),
        partial(overlap.ultimate_factor, loaded.materials, loaded.force) if ductile else None,
    )


def _peel(loaded: Loaded, edge: Array) -> dict[str, Array]:
    """Strength across the outermost plies divided by the peel stress at the skirt's edge.

    `edge` is the bond strength divided by the shear stress there. A metal barrel has no such row,
    as the peel strength of adhesives is not part of their data.
    """
    end, materials = loaded.end, loaded.materials
    assert end.material is not None
    ply = end.layers[-1].material
    strength = materials.allowable(ply, "strength_2_tension")
    ratio = materials.get(end.cap, "poissons_ratio")
    if materials.kind(ply) != "ply" or strength is None or ratio is None:
        return {}
    shear_modulus = materials.get(end.material, "shear_modulus")
    peel = lap_joint.edge_peel(
        shear=materials.allowable(end.material, "bond_strength") / edge,
        adhesive_modulus=materials.get(
            end.material, "youngs_modulus", default=TO_YOUNG * shear_modulus
        ),
        bond_thickness=materials.get(end.material, "bond_thickness", default=BOND_THICKNESS),
        skirt_modulus=materials.get(end.cap, "youngs_modulus"),
        skirt_poissons_ratio=ratio,
        skirt_thickness=end.sizes["wall"],
    )
    return {PEEL: strength / peel}


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn that force and heat are checked apart if the adhesive's data allow no more."""
    overlap = _overlap(loaded)
    if not isinstance(overlap, str) and not overlap.ductile(loaded.materials):
        yield (
            "retention_burst_factor",
            "force and temperature act on the bond together, but are checked apart: state "
            f"plastic_shear_strain of {loaded.end.material} to check both",
        )


def _envelope(loaded: Loaded, burst: Mapping[str, Array]) -> dict[str, Array]:
    """Two upper bounds of the bond's safety factor.

    One is computed from the stiffness of the barrel wall alone, the other from that of the skirt.
    They are equal if the two are equally stiff.
    """
    overlap = _overlap(loaded)
    if isinstance(overlap, str):
        return {}
    (mean,) = burst.values()
    return {
        f"bond of the {name}": mean / overlap.least_peak_ratio(loaded.materials, stiffness)
        for name, stiffness in zip(overlap.names, (overlap.tube, overlap.metal), strict=True)
    }


JOINT = Joint(
    name="bond",
    help="bonded skirts over the barrel",
    noun="a bond",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField(
            "material",
            "missing: a bond needs an adhesive",
            'add e.g. "material: epoxy_structural"',
        ),
    ),
    kinds=("adhesive",),
    without={},
    faults=nothing,
    material_faults=nothing,
    form="skirts",
    fit=_fit,
    clamping=None,
    give=None,
    mass=_mass,
    outline=overlap.outline,
    notes=nothing,
    strength=_strength,
    yields=overlap.yields,
    wall=lambda loaded: WallPressures(),
    fatigue=lambda loaded: Fatigue(overlap.beside_pulsed(loaded)),
    own=lambda loaded: {},
    envelope=_envelope,
    metrics={},
    judged=("the elastic peak shear of a bond", "mean bond shear"),
    models={
        ("retention_factor", "bond at the skirt's edge"): "lap_joint.bond_edge_shear",
        ("retention_factor", "bond at the barrel's edge"): "lap_joint.bond_edge_shear",
        ("retention_factor", PEEL): "lap_joint.edge_peel",
        ("yield_factor", overlap.BESIDE): "end_bending.edge_stresses",
    },
    usual=(),
    warnings=_warnings,
)
