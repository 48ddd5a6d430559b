"""Skirts of the caps bonded over the outside of the barrel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from ..base.numeric import Array
from ..base.quantities import Quantity
from . import overlap
from .joint import (
    BarrelOpening,
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

AT_SKIRT = "bond at the skirt's edge"
PEEL = "peel of the plies at the skirt's edge"


def _fit(end: End) -> EndDimensions:
    return overlap.fit(end, end.outer_radius)


def _mass(end: End, materials: MaterialProperties) -> dict[str, Array]:
    return {"caps": overlap.weight(end, materials, end.outer_radius)}


def _strength(loaded: Loaded) -> Strength | str:
    bond = overlap.of_skirt(loaded)
    if isinstance(bond, str):
        return bond
    edges = bond.edge_factors(loaded.materials, loaded.force)
    ductile = bond.ductile(loaded.materials)
    return Strength(
        edges | overlap.peel(loaded, PEEL, edges[AT_SKIRT]),
        {"": bond.mean_factor(loaded.materials, loaded.force)},
        bond.thermal(loaded.materials),
        partial(bond.ultimate_factor, loaded.materials, loaded.force) if ductile else None,
    )


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn that force and heat are checked apart if the adhesive's data allow no more."""
    yield from overlap.apart(loaded)


def _envelope(loaded: Loaded, burst: Mapping[str, Array]) -> dict[str, Array]:
    """Two upper bounds of the bond's safety factor.

    One is computed from the stiffness of the barrel wall alone, the other from that of the skirt.
    They are equal if the two are equally stiff.
    """
    bond = overlap.of_skirt(loaded)
    if isinstance(bond, str):
        return {}
    (mean,) = burst.values()
    return {
        f"bond of the {name}": mean / bond.least_peak_ratio(loaded.materials, stiffness)
        for name, stiffness in zip(bond.names, (bond.tube, bond.metal), strict=True)
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
    opening=lambda _: BarrelOpening("once", "Bond the skirt of the {end} over the barrel."),
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
    beside=overlap.edge_beside,
    fatigue=lambda loaded: Fatigue(),
    own=lambda loaded: {},
    envelope=_envelope,
    metrics={},
    judged=("peak bond shear", "mean bond shear"),
    models={
        ("retention_factor", "bond at the skirt's edge"): "lap_joint.bond_edge_shear",
        ("retention_factor", "bond at the barrel's edge"): "lap_joint.bond_edge_shear",
        ("retention_factor", PEEL): "lap_joint.edge_peel",
    },
    usual=(),
    warnings=_warnings,
)
