"""Plugs in the barrel's bore, each held by a ring in a groove of the bore.

The end plate is a plug inside the barrel. From the pressure outwards, the barrel holds the plug
with its static seal, the ring in its groove, and a lip of the barrel. The groove is cut into the
innermost layer, which must be a metal. This layer carries the whole force at the groove, so the
layers around it, such as a hoop winding, need no axial strength. The ring has a gap, at which it
is closed to pass the bore.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import sqrt

from ..base.errors import Fault
from ..base.numeric import Array, minimum
from ..base.quantities import Quantity, length_text
from ..models import mass, retaining_ring as model
from .joint import (
    ON_METAL,
    ROUNDING,
    BarrelOpening,
    DrawnPart,
    End,
    EndDimensions,
    EndSpan,
    Fatigue,
    Joint,
    JointField,
    KnownMaterials,
    Loaded,
    MaterialProperties,
    Pulsed,
    StatedValues,
    Strength,
    Usual,
    WallPressures,
    metal_strengths,
    notch_factor,
    too_thin,
)
from .plug import behind_seal, innermost_faults
from .winding import WINDING_EDGE, with_winding

EDGE_BREAK = 0.2e-3
"""Largest edge break of the plug and of the groove [m], which moves the force on the ring inwards.
Our choice; the drawing states it."""

NOTCH, NOTCH_HARD = 3.0, 4.0
"""Fatigue notch factors of the groove's root, for metals below `HARD` and from `HARD` on. Our
choice, for a root radius of at least a tenth of the depth; no published value for such grooves."""

LANDS = ("geometry_ring_groove", "geometry_ring_opening")
"""Metrics of the metal left under the groove, and of the clearance between ring and rod."""

_OPENING = ("retention.groove_depth", "retention.ring_width")
"""PATHs of the joint's sizes that determine the clearance of the rod."""

ASSEMBLY = "ring_assembly_factor"
"""Metric of the ring's strength as it passes the bore."""


# --- faults of the file ---------------------------------------------------------------------


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report a ring that its groove does not hold, or that leaves no opening."""
    depth, width = (view.number("retention", key) for key in ("groove_depth", "ring_width"))
    if depth is not None and width is not None and width <= depth:
        yield Fault(
            ("retention", "ring_width"),
            f"{length_text(width)}: the ring vanishes in its groove, which is "
            f"{length_text(depth)} deep",
            f"write more than {length_text(depth)}; twice the depth is usual",
        )
    bore, rod = view.number("cylinder", "bore"), view.number("rod", "outer_diameter")
    if depth is None or width is None or bore is None or rod is None:
        return
    outer = bore / 2 + depth
    varied = ("cylinder.bore", "rod.outer_diameter", *_OPENING)
    least = rod / 2 if view.at_head and not any(view.has("variables", x) for x in varied) else 0.0
    if width >= (outer - least) * (1 - ROUNDING):
        what = "the ring would be inside the rod" if least else "the ring would have no opening"
        yield Fault(
            ("retention", "ring_width"),
            f"{length_text(width)}: {what}, as the outer radius of the ring is "
            f"{length_text(outer)}"
            + (f" and that of the rod {length_text(least)}" if least else ""),
            f"write less than {length_text(outer - least)}; twice the depth of the groove is usual",
        )


def _material_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report a groove that is not in a metal of known strength, or leaves too little of it."""
    depth = view.number("retention", "groove_depth")
    varied = ("barrel.layup[0].thickness", "retention.groove_depth")
    yield from innermost_faults(view, materials, "the groove of the retaining ring", depth, varied)


def _opening(view: StatedValues) -> BarrelOpening:
    """The groove, which is as wide as the ring is thick."""
    width = view.number("retention", "ring_thickness")
    crossed = None if width is None else ("groove", width)
    closing = "Push the {end} into the bore and set its split ring into the groove."
    return BarrelOpening("again", closing, crossed=crossed)


# --- dimensions and mass --------------------------------------------------------------------


def _fit(end: End) -> EndDimensions:
    sizes = end.sizes
    return EndDimensions(
        plate_radius=end.inner_radius,
        radius=end.inner_radius,
        lip=sizes["ring_thickness"] + sizes["length"],
        beyond=end.plate + sizes["ring_thickness"] + sizes["length"],
        groove=(end.plate, sizes["ring_thickness"], sizes["groove_depth"]),
    )


def _radii(end: End) -> tuple[Array, Array]:
    """Inner and outer radius of the ring."""
    outer = end.inner_radius + end.sizes["groove_depth"]
    return outer - end.sizes["ring_width"], outer


def _mass(end: End, materials: MaterialProperties) -> Mapping[str, Array]:
    """Mass of the ring; and, with a negative sign, that of the metal cut from the groove."""
    assert end.material is not None
    inner, outer = _radii(end)
    width, depth = end.sizes["ring_thickness"], end.sizes["groove_depth"]
    ring = mass.tube_mass(
        density=materials.get(end.material, "density"),
        inner_diameter=2 * inner,
        outer_diameter=2 * outer,
        length=width,
    )
    cut = mass.layer_area(inner_radius=end.inner_radius, thickness=depth) * width
    return {
        "fastening": ring,
        "barrel": -materials.get(end.layers[0].material, "density") * cut,
    }


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    assert end.material is not None
    inner, outer = (float(radius) for radius in _radii(end))
    start, width, _ = (float(size) for size in fit.groove)
    yield DrawnPart(
        "retaining rings", end.material, span.beyond(start, start + width, inner, outer)
    )


def _notes(end: End) -> Iterator[str]:
    sizes = end.sizes
    yield (
        f"Groove of the retaining ring: {2e3 * (end.inner_radius + sizes['groove_depth']):.4g} mm "
        f"diameter, {1e3 * sizes['ring_thickness']:.3g} mm wide, root radius at least "
        f"{1e2 * sizes['groove_depth']:.2g} mm."
    )
    yield (
        f"Split ring of rectangular section, edges broken by at most {1e3 * EDGE_BREAK:g} mm. "
        "Chamfer the groove's inner edge, which the seals of plug and piston pass at assembly."
    )


# --- strength -------------------------------------------------------------------------------


def _sizes(end: End) -> dict[str, Array]:
    """Sizes of groove and lip that the models share."""
    return {
        "bore_diameter": 2 * end.inner_radius,
        "groove_depth": end.sizes["groove_depth"],
        "lip_length": end.sizes["length"],
    }


def _ring(end: End, force: Array) -> dict[str, Array]:
    """Arguments of the models of dishing; the ring is split, and its groove does not hold it."""
    inner, outer = _radii(end)
    return {
        "force": model.SPLIT * force,
        "lever_length": end.sizes["groove_depth"] / 2 + EDGE_BREAK,
        "inner_radius": inner,
        "outer_radius": outer,
        "ring_thickness": end.sizes["ring_thickness"],
    }


def _under_groove(loaded: Loaded) -> tuple[Array, Array]:
    """Axial and bending stress of the metal under the groove; the result is cached."""
    cache, end = loaded.end.cache, loaded.end
    if "under_groove" not in cache:
        cache["under_groove"] = model.wall_stresses(
            force=loaded.force,
            **_sizes(end),
            thickness=end.layers[0].thickness,
            poissons_ratio=loaded.materials.get(end.layers[0].material, "poissons_ratio"),
        )
    stresses: tuple[Array, Array] = cache["under_groove"]
    return stresses


def _strengths(loaded: Loaded) -> tuple[tuple[Array, Array], ...] | str:
    """Yield and ultimate strength of wall and ring; or the reason why one of them is unknown."""
    if loaded.end.material is None:
        return "a retaining ring needs a metal: add retention.material"
    return metal_strengths(loaded.materials, loaded.end.layers[0].material, loaded.end.material)


def _strength(loaded: Loaded) -> Strength | str:
    strengths, end, force = _strengths(loaded), loaded.end, loaded.force
    if isinstance(strengths, str):
        return strengths
    (wall, wall_ultimate), (ring, ring_ultimate) = strengths
    sizes = _sizes(end)
    area = model.groove_area(
        bore_diameter=sizes["bore_diameter"], groove_depth=sizes["groove_depth"]
    )
    lip_shear = model.lip_shear(force=force, **sizes)
    lip_bending = model.lip_bending(force=force, **sizes)
    ring_shear = model.ring_shear(
        force=force,
        bore_diameter=sizes["bore_diameter"],
        ring_thickness=end.sizes["ring_thickness"],
    )
    axial, bending = _under_groove(loaded)
    working = {
        "groove flank": minimum(wall, ring) * area / force,
        "lip in shear": wall / sqrt(3) / lip_shear,
        "lip in bending": wall / lip_bending,
        "ring in shear": ring / sqrt(3) / ring_shear,
        "ring in dishing": ring / model.ring_dishing(**_ring(end, force)),
    }
    burst = {
        "lip in shear": wall_ultimate / sqrt(3) / lip_shear,
        "lip in bending": 1.5 * wall_ultimate / lip_bending,
        "ring in shear": ring_ultimate / sqrt(3) / ring_shear,
        "ring in dishing": ring_ultimate / model.plastic_dishing(**_ring(end, force)),
        "barrel under the groove": model.collapse_factor(
            axial=axial, bending=bending, strength=wall_ultimate
        ),
        **behind_seal(loaded, _ring(end, force)["inner_radius"]),
    }
    return with_winding(loaded, working, burst)


def _yields(loaded: Loaded) -> Mapping[str, Array]:
    strengths = _strengths(loaded)
    if isinstance(strengths, str):
        return {}
    return {"barrel under the groove": strengths[0][0] / sum(_under_groove(loaded))}


def _fatigue(loaded: Loaded) -> Fatigue:
    """Stress at the groove's root and in the dished ring under pulsating force.

    The notch factor multiplies the range of the stress, but not its mean.
    """
    strengths, end = _strengths(loaded), loaded.end
    if isinstance(strengths, str):
        return Fatigue()
    name, stress = end.layers[0].material, sum(_under_groove(loaded))
    notch = notch_factor(loaded.materials, name, NOTCH, NOTCH_HARD)
    assert end.material is not None
    dished = model.ring_dishing(**_ring(end, loaded.force))
    return Fatigue(
        (
            Pulsed("groove root", name, notch * stress, stress / 2),
            Pulsed("retaining ring", end.material, dished, dished / 2),
        )
    )


def _lands(loaded: Loaded) -> dict[str, Array]:
    """Metal left under the groove, and clearance of the rod [m]; optimisations limit both."""
    end = loaded.end
    lands = (
        end.layers[0].thickness - end.sizes["groove_depth"],
        _radii(end)[0] - end.rod_radius,
    )
    return dict(zip(LANDS, lands, strict=True))


def _own(loaded: Loaded) -> Mapping[str, Array]:
    """The lands; and yield strength divided by the stress of the ring as it passes the bore."""
    strengths, end, values = _strengths(loaded), loaded.end, _lands(loaded)
    assert end.material is not None
    modulus = loaded.materials.get(end.material, "youngs_modulus")
    if not isinstance(strengths, str) and modulus is not None:
        inner, outer = _radii(end)
        values[ASSEMBLY] = strengths[1][0] / model.springing(
            groove_depth=end.sizes["groove_depth"],
            inner_radius=inner,
            outer_radius=outer,
            youngs_modulus=modulus,
        )
    return values


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn of too little metal under the groove or clearance of the rod."""
    yield from too_thin(_lands(loaded), quantities)


_ABSENT = "no retaining ring"

JOINT = Joint(
    name="retaining_ring",
    help="plugs in the bore, each held by a split ring in a groove of the innermost layer",
    noun="a retaining ring",
    fields=(
        JointField("length"),
        JointField(
            "material",
            "missing: a retaining ring needs a metal",
            'add e.g. "material: steel_42crmo4"',
        ),
        JointField(
            "groove_depth",
            "missing: required by a retaining ring",
            'add e.g. "groove_depth: 0.8 mm"',
            quantity="groove_depth",
            help="radial depth of the groove that holds the retaining ring",
        ),
        JointField(
            "ring_thickness",
            "missing: required by a retaining ring",
            'add e.g. "ring_thickness: 1.5 mm"',
            quantity="ring_thickness",
            help="axial thickness of the retaining ring",
        ),
        JointField(
            "ring_width",
            "missing: required by a retaining ring",
            'add e.g. "ring_width: 2 mm"',
            quantity="ring_width",
            help="radial width of the retaining ring",
        ),
        JointField("sleeve"),
    ),
    kinds=("metal",),
    without={},
    faults=_faults,
    material_faults=_material_faults,
    opening=_opening,
    form="plugs",
    fit=_fit,
    clamping=None,
    give=None,
    mass=_mass,
    outline=_outline,
    notes=_notes,
    strength=_strength,
    yields=_yields,
    wall=lambda loaded: WallPressures(),
    beside=None,
    fatigue=_fatigue,
    own=_own,
    envelope=None,
    metrics=dict.fromkeys((*LANDS, ASSEMBLY), _ABSENT),
    judged=ON_METAL,
    models={
        ("retention_factor", "groove flank"): "retaining_ring.groove_area",
        ("retention_factor", "lip in shear"): "retaining_ring.lip_shear",
        ("retention_factor", "lip in bending"): "retaining_ring.lip_bending",
        ("retention_factor", "ring in shear"): "retaining_ring.ring_shear",
        ("retention_factor", "ring in dishing"): "retaining_ring.ring_dishing",
        ("retention_factor", WINDING_EDGE): "liner_transfer.edge_shear",
        ("retention_burst_factor", "lip in shear"): "retaining_ring.lip_shear",
        ("retention_burst_factor", "lip in bending"): "retaining_ring.lip_bending",
        ("retention_burst_factor", "ring in shear"): "retaining_ring.ring_shear",
        ("retention_burst_factor", "ring in dishing"): "retaining_ring.plastic_dishing",
        ("retention_burst_factor", "barrel under the groove"): "retaining_ring.collapse_factor",
        ("yield_factor", "barrel under the groove"): "retaining_ring.wall_stresses",
    },
    usual=(
        Usual(
            "retention.length",
            "lip length / groove depth",
            1.0,
            20.0,
            "our choice: DIN 472 rates a lip of three groove depths at full strength",
            lambda end: end.sizes["length"] / end.sizes["groove_depth"],
        ),
        Usual(
            "retention.ring_width",
            "ring width / groove depth",
            1.5,
            20.0,
            "our choice: at least half as far out of the groove as in it",
            lambda end: end.sizes["ring_width"] / end.sizes["groove_depth"],
        ),
    ),
    warnings=_warnings,
)
