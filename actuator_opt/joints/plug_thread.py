"""Plugs screwed into the bore of the barrel.

The end plate is a plug inside the barrel. Outside its static seal, a threaded skirt of the plug
engages with a thread in the innermost layer of the barrel, which must be a metal. Unless stated,
the thread is as small as the rings of piston and plug allow, which pass it at nominal size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import sqrt

from ..base.errors import Fault
from ..base.numeric import Array, maximum, minimum
from ..base.quantities import Quantity, length_text
from ..models import mass, retaining_ring, thread
from .joint import (
    LINE,
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
    WallPressures,
    metal_strengths,
    notch_factor,
    ring_height,
    stated_rings,
    thread_line,
    too_thin,
)
from .plug import BEHIND_SEAL, behind_seal, innermost_faults
from .thread import CUT, CUT_HARD
from .winding import with_winding

LAND = "geometry_bore_thread"
"""Metric of the metal left under the thread in the bore."""

OPENING = "geometry_plug_opening"
"""Metric of the room that the thread leaves for the piston."""

MINOR = 1.25 * thread.HEIGHT
"""Nominal less minor diameter of the thread, in pitches [ISO68-1]."""


# --- faults of the file ---------------------------------------------------------------------


def _stated(view: StatedValues) -> tuple[float, float, float] | None:
    """Bore, pitch and diameter of the thread [m]; None if a size is missing or wrong."""
    bore, pitch = view.number("cylinder", "bore"), view.number("retention", "thread", "pitch")
    if bore is None or pitch is None:
        return None
    diameter = view.number("retention", "thread", "diameter")
    least = bore + 2 * ring_height(stated_rings(view)) + MINOR * pitch
    return bore, pitch, least if diameter is None else diameter


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report a thread that the piston cannot pass, or with less than one engaged turn."""
    sizes, length = _stated(view), view.number("retention", "length")
    if sizes is None:
        return
    bore, pitch, diameter = sizes
    least = (1 + thread.RUN_OUT) * pitch
    if length is not None and length < least:
        yield Fault(
            ("retention", "length"),
            f"{length_text(length)}: less than one turn of the thread engages at pitch "
            f"{length_text(pitch)}",
            f"write at least {length_text(least)}",
        )
    smallest = bore + MINOR * pitch
    if diameter < smallest * (1 - ROUNDING) and not view.has("variables", "cylinder.bore"):
        yield Fault(
            ("retention", "thread", "diameter"),
            f"{length_text(diameter)}: the piston, of {length_text(bore)}, cannot pass this thread",
            f"write at least {length_text(smallest)}, or remove the line to use this diameter",
        )


def _material_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report a thread that is not in a metal of known strength, or leaves too little of it."""
    sizes = _stated(view)
    depth = None if sizes is None else (sizes[2] - sizes[0]) / 2
    varied = ("barrel.layup[0].thickness", "retention.thread.pitch", "retention.thread.diameter")
    yield from innermost_faults(view, materials, "the thread of the plug", depth, varied)
    at = ("caps" if view.has("caps") else "piston", "material")
    name = view.text(*at)
    if name is not None and materials.kind(name) not in ("metal", None):
        yield Fault(
            at,
            f"{name}: the plug's thread needs a metal",
            "choose a metal, or use another joint (retention.type)",
        )


def _opening(view: StatedValues) -> BarrelOpening:
    """The minor diameter of the thread in the barrel, and its length."""
    sizes, length = _stated(view), view.number("retention", "length")
    closing = "Screw the {end} into the bore."
    if sizes is None or length is None:
        return BarrelOpening("again", closing)
    _, pitch, diameter = sizes
    return BarrelOpening("again", closing, diameter - MINOR * pitch, ("thread", length))


# --- dimensions and mass --------------------------------------------------------------------


def _diameter(end: End) -> Array:
    opening = 2 * (end.inner_radius + end.ring_height)
    return end.sizes.get("thread.diameter", opening + MINOR * end.sizes["thread.pitch"])


def _size(end: End) -> dict[str, Array]:
    return {"diameter": _diameter(end), "pitch": end.sizes["thread.pitch"]}


def _pitch_radius(end: End) -> Array:
    return mass.pitch_diameter(**_size(end)) / 2


def _root_radius(end: End) -> Array:
    """Radius of the root of the plug's thread."""
    return thread.root_diameter(**_size(end)) / 2


def _fit(end: End) -> EndDimensions:
    length = end.sizes["length"]
    return EndDimensions(
        plate_radius=end.inner_radius,
        radius=end.inner_radius,
        lip=length,
        beyond=end.plate + length,
        groove=(end.plate, length, _pitch_radius(end) - end.inner_radius),
    )


def _mass(end: End, materials: MaterialProperties) -> Mapping[str, Array]:
    """Mass of the plug's threaded skirt; the thread in the barrel counts at its pitch diameter."""
    outer, inner = _pitch_radius(end), _root_radius(end) - end.sizes["wall"]
    length = end.sizes["length"]
    skirt = mass.tube_mass(
        density=materials.get(end.cap, "density"),
        inner_diameter=2 * inner,
        outer_diameter=2 * outer,
        length=length,
    )
    cut = mass.layer_area(inner_radius=end.inner_radius, thickness=outer - end.inner_radius)
    return {
        "caps": skirt,
        "barrel": -materials.get(end.layers[0].material, "density") * cut * length,
    }


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    near, length, _ = (float(size) for size in fit.groove)
    inner = float(_root_radius(end) - end.sizes["wall"])
    shape = span.beyond(near, near + length, inner, float(_pitch_radius(end)))
    yield DrawnPart("caps", end.cap, shape)
    flanks = thread_line(
        start=min(x for x, _ in shape),
        length=length,
        pitch=float(end.sizes["thread.pitch"]),
        root_radius=float(_root_radius(end)),
        crest_radius=float(_diameter(end)) / 2,
    )
    yield DrawnPart(LINE, end.cap, flanks)


def _notes(end: End) -> Iterator[str]:
    text = f"M{1e3 * _diameter(end):.5g} x {1e3 * end.sizes['thread.pitch']:g}"
    yield (
        f"Thread of plug and bore: {text}, {1e3 * end.sizes['length']:.4g} long. Chamfer its inner "
        "end, which the seals of plug and piston pass at assembly."
    )


# --- strength -------------------------------------------------------------------------------


def _strengths(loaded: Loaded) -> tuple[tuple[Array, Array], ...] | str:
    """Yield and ultimate strength of barrel and plug; or the reason why one is unknown."""
    return metal_strengths(loaded.materials, loaded.end.layers[0].material, loaded.end.cap)


def _areas(end: End) -> tuple[Array, Array, Array]:
    """Strip areas of the barrel's and the plug's thread, and projected area of the flanks."""
    size = _size(end)
    engagement = thread.engaged_length(length=end.sizes["length"], pitch=size["pitch"])
    crested = {**size, "engagement": engagement, "crest_diameter": size["diameter"]}
    return (
        thread.female_strip_area(**crested),
        thread.male_strip_area(**size, engagement=engagement),
        thread.flank_area(**crested),
    )


def _under_thread(loaded: Loaded) -> tuple[Array, Array]:
    """Axial and bending stress of the barrel's metal at the thread; the result is cached."""
    end = loaded.end
    if "under_thread" not in end.cache:
        layer, size = end.layers[0], _size(end)
        end.cache["under_thread"] = thread.internal_wall_stresses(
            force=loaded.force,
            **size,
            engagement=thread.engaged_length(length=end.sizes["length"], pitch=size["pitch"]),
            bore_diameter=2 * end.inner_radius,
            outer_diameter=2 * (end.inner_radius + layer.thickness),
            poissons_ratio=loaded.materials.get(layer.material, "poissons_ratio"),
        )
    stresses: tuple[Array, Array] = end.cache["under_thread"]
    return stresses


def _land(end: End) -> Array:
    """Metal left under the thread in the bore [m]."""
    return end.inner_radius + end.layers[0].thickness - _diameter(end) / 2


def _skirt(loaded: Loaded) -> tuple[Array, Array, Array]:
    """Axial and hoop compression of the plug's skirt, and its bending stress at the plate."""
    end = loaded.end
    stresses: tuple[Array, Array, Array] = thread.skirt_stresses(
        force=loaded.force,
        root_diameter=2 * _root_radius(end),
        thickness=end.sizes["wall"],
        engagement=thread.engaged_length(
            length=end.sizes["length"], pitch=end.sizes["thread.pitch"]
        ),
        poissons_ratio=loaded.materials.get(end.cap, "poissons_ratio", default=0.3),
    )
    return stresses


def _spread(end: End, force: Array, thickness: Array) -> Array:
    """Hoop stress that the inclined flanks cause in a ring of this thickness."""
    engagement = thread.engaged_length(length=end.sizes["length"], pitch=end.sizes["thread.pitch"])
    return thread.spread_stress(force=force, thickness=thickness, engagement=engagement)


def _strength(loaded: Loaded) -> Strength | str:
    strengths, end, force = _strengths(loaded), loaded.end, loaded.force
    if isinstance(strengths, str):
        return strengths
    (wall, wall_ultimate), (plug, plug_ultimate) = strengths
    female, male, flanks = _areas(end)
    ratio = wall_ultimate * female / (plug_ultimate * male)
    of_male, of_female = thread.stripping_reductions(strength_ratio=ratio)
    axial, bending = _under_thread(loaded)
    working = {
        "thread in the bore": wall / sqrt(3) * female / force,
        "thread of the plug": plug / sqrt(3) * male / force,
        "flanks of the plug's thread": minimum(wall, plug) * flanks / force,
    }
    burst = {
        "thread in the bore": of_female * wall_ultimate / sqrt(3) * female / force,
        "thread of the plug": of_male * plug_ultimate / sqrt(3) * male / force,
        "plug under its thread": plug_ultimate / maximum(*_skirt(loaded)[:2]),
        **behind_seal(loaded, _root_radius(end) - end.sizes["wall"]),
        "barrel spread by the plug": wall / _spread(end, force, _land(end)),
        "barrel under the plug's thread": retaining_ring.collapse_factor(
            axial=axial, bending=bending, strength=wall_ultimate
        ),
    }
    return with_winding(loaded, working, burst)


def _yields(loaded: Loaded) -> Mapping[str, Array]:
    strengths = _strengths(loaded)
    if isinstance(strengths, str):
        return {}
    (wall, _), (plug, _) = strengths
    axial, _, bending = _skirt(loaded)
    return {
        "barrel under the plug's thread": wall / sum(_under_thread(loaded)),
        "plug under its thread": plug / (axial + bending),
    }


def _fatigue(loaded: Loaded) -> Fatigue:
    """Stress at both thread roots under pulsating force; notch factors as for `thread`.

    That of the plug is its axial compression, as if it were tension (`thread.skirt_stresses`).
    """
    strengths, end = _strengths(loaded), loaded.end
    if isinstance(strengths, str):
        return Fatigue()
    pulsed = []
    for place, name, stress in (
        ("thread root in the bore", end.layers[0].material, sum(_under_thread(loaded))),
        ("thread root of the plug", end.cap, _skirt(loaded)[0]),
    ):
        notch = notch_factor(loaded.materials, name, CUT, CUT_HARD)
        pulsed.append(Pulsed(place, name, notch * stress, stress / 2))
    return Fatigue(tuple(pulsed))


def _own(loaded: Loaded) -> Mapping[str, Array]:
    """Metal under the thread, and its opening less the bore [m]; optimisations limit both."""
    end = loaded.end
    opening = _diameter(end) - MINOR * end.sizes["thread.pitch"]
    return {LAND: _land(end), OPENING: opening - 2 * end.inner_radius}


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn of too little metal under the thread."""
    yield from too_thin({LAND: _land(loaded.end)}, quantities)


JOINT = Joint(
    name="plug_thread",
    help="plugs screwed into the bore of the innermost layer",
    noun="a plug's thread",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField(
            "thread", "missing: required by a plug's thread", 'add a block "thread:" with pitch'
        ),
        JointField("thread.diameter"),
        JointField("thread.pitch"),
        JointField("sleeve"),
    ),
    kinds=(),
    without={
        "material": (
            "has no effect on a plug's thread, which is cut into barrel and caps",
            "remove the line; change barrel.layup or caps.material",
        )
    },
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
    metrics={LAND: "no thread in the bore", OPENING: "no thread in the bore"},
    judged=ON_METAL,
    models={
        ("retention_factor", "thread in the bore"): "thread.female_strip_area",
        ("retention_factor", "thread of the plug"): "thread.male_strip_area",
        ("retention_factor", "flanks of the plug's thread"): "thread.flank_area",
        ("retention_burst_factor", "thread in the bore"): "thread.stripping_reductions",
        ("retention_burst_factor", "thread of the plug"): "thread.stripping_reductions",
        ("retention_burst_factor", "plug under its thread"): "thread.skirt_stresses",
        ("retention_burst_factor", BEHIND_SEAL): "end_plate.rim_tear_factor",
        ("retention_burst_factor", "barrel spread by the plug"): "thread.spread_stress",
        (
            "retention_burst_factor",
            "barrel under the plug's thread",
        ): "retaining_ring.collapse_factor",
        ("yield_factor", "barrel under the plug's thread"): "thread.internal_wall_stresses",
        ("yield_factor", "plug under its thread"): "thread.skirt_stresses",
    },
    usual=(),
    warnings=_warnings,
)
