"""Skirts of the caps screwed over the barrel: threads of barrel and skirts, and their walls.

The thread is cut into the outermost layer of the barrel. If `thread.diameter` is smaller than the
outer diameter of this layer, the layer is turned down to it. This layer is assumed to carry the
whole axial force. Oil pressure acts on it up to the ends of the barrel, as inner layers are assumed
to carry no pressure. The thread must be cut into metal and leave metal under it; otherwise the
design file is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi, sqrt

from ..base.dataclass import dataclass
from ..base.errors import Fault
from ..base.numeric import Array, minimum
from ..base.quantities import Quantity, length_text
from ..models import barrel, mass, thread
from ..models.rod import section_area
from ..models.strength import yield_utilisation
from . import overlap
from .joint import (
    LEAST_METAL,
    LINE,
    NOT_BONDED,
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
    judged_later,
    metal_strengths,
    notch_factor,
    thread_line,
    too_thin,
)

NEEDED = ("yield_strength", "ultimate_strength")
"""Material properties that a threaded metal needs."""

OTHERWISE = "bond the caps (type: bond), or clamp them (type: tie_rods)"

LANDS = ("geometry_barrel_thread", "geometry_skirt_thread")
CREST = "geometry_thread_crest"
"""Names of the three metrics of a thread: metal left under the barrel's thread root and under the
skirt's, and overlap of the thread flanks."""

CUT, CUT_HARD = 3.0, 3.8
"""Fatigue notch factors of a cut thread root, for metals below `HARD` and from `HARD` on.
[Shigley2011] table 8-16 has 2.8 for soft steel and 3.8 for hard steel. Here, every metal below
`HARD` has 3, even if it is not in the table."""


# --- faults of the file ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Stated:
    """Sizes as stated in the design file [m].

    They are the outer diameter of the barrel, the thickness of its outermost layer, diameter and
    pitch of the thread, and the wall thickness of the skirt.
    """

    outside: float
    layer: float
    diameter: float
    pitch: float
    wall: float


def _layer(view: StatedValues) -> tuple[str, str, int]:
    """Path in the file of the barrel's outermost layer."""
    return ("barrel", "layup", len(view.items("barrel", "layup")) - 1)


def _stated(view: StatedValues) -> _Stated | None:
    """Read the sizes of the joint; None if a size is missing or wrong."""
    count = len(view.items("barrel", "layup"))
    layers = [view.number("barrel", "layup", index, "thickness") for index in range(count)]
    thicknesses = [layer for layer in layers if layer is not None]
    bore, pitch = view.number("cylinder", "bore"), view.number("retention", "thread", "pitch")
    wall = view.number("retention", "wall")
    if bore is None or pitch is None or wall is None or not thicknesses or len(thicknesses) < count:
        return None
    outside = bore + 2 * sum(thicknesses)
    stated = view.number("retention", "thread", "diameter")
    return _Stated(outside, thicknesses[-1], outside if stated is None else stated, pitch, wall)


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report a thread that does not fit the barrel, or has less than one engaged turn."""
    pitch, length = view.number("retention", "thread", "pitch"), view.number("retention", "length")
    if pitch is not None and length is not None and length < (1 + thread.RUN_OUT) * pitch:
        yield Fault(
            ("retention", "length"),
            f"{length_text(length)}: less than one turn of the thread engages at pitch "
            f"{length_text(pitch)}",
            f"write at least {length_text((1 + thread.RUN_OUT) * pitch)}",
        )
    sizes = _stated(view)
    if sizes is None:
        return
    overlap = thread.crest_overlap(
        diameter=sizes.diameter,
        pitch=sizes.pitch,
        crest_diameter=min(sizes.diameter, sizes.outside),
    )
    if overlap < thread.LEAST_OVERLAP * (1 - ROUNDING) and not judged_later(
        view, _size_paths(view)
    ):
        text = length_text(sizes.outside)
        yield Fault(
            ("retention", "thread", "diameter"),
            f"{length_text(sizes.diameter)}: larger than the outer diameter of the barrel "
            f"({text}), into which the thread is cut",
            f"write at most {text}, or remove the line to use the outer diameter",
        )


def _material_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report a thread that is not in a metal of known strength, or leaves too little metal."""
    sizes, layer = _stated(view), _layer(view)
    caps = "caps" if view.has("caps") else "piston"  # the default material of the caps
    if _metal(view, materials, (*layer, "material")) and sizes is not None:
        yield from _layer_faults(view, sizes)
    if _metal(view, materials, (caps, "material")) and sizes is not None:
        yield from _skirt_wall_faults(view, sizes)
    yield from _cut_faults(
        view,
        materials,
        (*layer, "material"),
        "the outermost layer of the barrel, which is",
        f"barrel.layup[{layer[-1]}]",
    )
    yield from _cut_faults(view, materials, (caps, "material"), "the caps' skirts, which are", caps)


def _metal(view: StatedValues, materials: KnownMaterials, loc: tuple[str | int, ...]) -> bool:
    name = view.text(*loc)
    return name is not None and materials.kind(name) == "metal"


def _cut_faults(
    view: StatedValues, materials: KnownMaterials, loc: tuple[str | int, ...], part: str, path: str
) -> Iterator[Fault]:
    """Report a thread in a material (at `path`) that is not a metal or has no strengths."""
    name = view.text(*loc)
    kind = None if name is None else materials.kind(name)
    if name is None or kind is None:
        return
    if kind != "metal":
        description = (
            "of plies, whose fibres the thread would cut" if kind == "ply" else f"of a {kind}"
        )
        yield Fault(
            loc,
            f"{name}: the thread (retention.type) is cut into {part} {description}; "
            "a thread needs metal",
            f"make {path} of metal, {OTHERWISE}",
        )
        return
    properties = set(materials.properties(name))
    missing = [key for key in NEEDED if properties and key not in properties]
    if missing:
        yield Fault(
            loc,
            f"{name} has no {' nor '.join(missing)}: the strength of its thread cannot be computed",
            f'add e.g. "{missing[0]}: 355 MPa" under materials.{name}, {OTHERWISE}',
        )


def _layer_faults(view: StatedValues, sizes: _Stated) -> Iterator[Fault]:
    """Report a barrel layer with too little metal under its thread."""
    root = thread.root_diameter(diameter=min(sizes.diameter, sizes.outside), pitch=sizes.pitch)
    remaining = sizes.layer - (sizes.outside - root) / 2
    layer = _layer(view)
    if remaining < LEAST_METAL * (1 - ROUNDING) and not judged_later(view, _size_paths(view)):
        name = view.text(*layer, "material")
        rest = length_text(remaining) if remaining > 0 else "nothing"
        least = sizes.layer + LEAST_METAL - remaining
        yield Fault(
            (*layer, "thickness"),
            f"{length_text(sizes.layer)} of {name}: the thread leaves {rest} of it, "
            f"but {length_text(LEAST_METAL)} is needed",
            f"write a thickness of at least {length_text(least)} or a finer pitch, {OTHERWISE}",
        )


def _skirt_wall_faults(view: StatedValues, sizes: _Stated) -> Iterator[Fault]:
    """Report skirts with too little metal around their thread."""
    if sizes.wall < LEAST_METAL * (1 - ROUNDING) and not judged_later(view, ["retention.wall"]):
        yield Fault(
            ("retention", "wall"),
            f"{length_text(sizes.wall)}: a thread needs {length_text(LEAST_METAL)} of metal "
            "around it",
            f"write at least {length_text(LEAST_METAL)}",
        )


def _size_paths(view: StatedValues) -> Iterator[str]:
    """PATHs of the sizes that determine the barrel thread's crests and the metal under its root."""
    outermost = _layer(view)[-1]
    yield "retention.thread.pitch"
    yield f"barrel.layup[{outermost}].thickness"
    if view.has("retention", "thread", "diameter"):
        yield "retention.thread.diameter"
        yield "cylinder.bore"
        for index in range(outermost):
            yield f"barrel.layup[{index}].thickness"


# --- dimensions and mass --------------------------------------------------------------------


def _radius(end: End) -> Array:
    """Outer radius of the barrel under the skirt, after turning down."""
    if "thread.diameter" in end.sizes:
        return minimum(end.sizes["thread.diameter"] / 2, end.outer_radius)
    return end.outer_radius


def _fit(end: End) -> EndDimensions:
    return overlap.fit(end, _radius(end))


def _mass(end: End, materials: MaterialProperties) -> dict[str, Array]:
    """Mass of the skirt; and, with a negative sign, that of the ring turned off the barrel."""
    radius = _radius(end)
    caps = {"caps": overlap.weight(end, materials, radius)}
    if radius is end.outer_radius:
        return caps
    turned = mass.layer_area(inner_radius=radius, thickness=end.outer_radius - radius)
    ring = materials.get(end.layers[-1].material, "density") * turned * end.sizes["length"]
    return caps | {"barrel": -ring}


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    """Outline of the skirt at one end, and the flanks of its thread."""
    yield from overlap.outline(end, fit, span)
    sizes, length = _derived(end), float(fit.length)
    flanks = thread_line(
        start=min(span.face, span.face + span.inwards * length),
        length=length,
        pitch=float(end.sizes["thread.pitch"]),
        root_radius=float(sizes.root_diameter) / 2,
        crest_radius=min(float(sizes.diameter) / 2, float(end.outer_radius)),
    )
    yield DrawnPart(LINE, end.cap, flanks)


def _notes(end: End) -> Iterator[str]:
    sizes = end.sizes
    diameter = sizes.get("thread.diameter", None) or 2 * end.outer_radius
    text = f"M{1e3 * diameter:.5g} x {1e3 * sizes['thread.pitch']:g}"
    yield f"Thread of barrel and caps: {text}, {1e3 * sizes['length']:.4g} long."


# --- strength -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class EndThread:
    """The thread of an end: sizes [m], areas [m^2], and metals."""

    male: str
    female: str
    diameter: Array
    root_diameter: Array
    skirt_wall: Array
    """Wall thickness of the skirt around the thread."""
    engagement: Array
    male_area: Array
    female_area: Array
    flank_area: Array
    barrel_section: Array
    """Cross-section area of the threaded layer under the thread root."""
    skirt_section: Array
    layer_radius: Array
    """Inner radius of the threaded layer."""
    overlap: Array
    """Flank overlap of the thread, as a share of the overlap with full crests."""
    bore_radius: Array


def derive(end: End) -> EndThread:
    """Derive the thread of an end; later calls return the cached result."""
    if "thread" not in end.cache:
        end.cache["thread"] = _derived(end)
    end_thread: EndThread = end.cache["thread"]
    return end_thread


def _derived(end: End) -> EndThread:
    pitch = end.sizes["thread.pitch"]
    diameter = end.sizes.get("thread.diameter", 2 * end.outer_radius)
    radius, wall = _radius(end), end.sizes["wall"]
    size = {"diameter": diameter, "pitch": pitch}
    engagement = thread.engaged_length(length=end.sizes["length"], pitch=pitch)
    crested = {"engagement": engagement, "crest_diameter": 2 * radius}
    root = thread.root_diameter(**size)
    layer = end.outer_radius - end.layers[-1].thickness
    outer = 2 * (radius + wall)
    return EndThread(
        male=end.layers[-1].material,
        female=end.cap,
        diameter=diameter,
        root_diameter=root,
        skirt_wall=(outer - diameter) / 2,
        engagement=engagement,
        male_area=thread.male_strip_area(**size, engagement=engagement),
        female_area=thread.female_strip_area(**size, **crested),
        flank_area=thread.flank_area(**size, **crested),
        barrel_section=section_area(outer_diameter=root, inner_diameter=2 * layer),
        skirt_section=section_area(outer_diameter=outer, inner_diameter=diameter),
        layer_radius=layer,
        overlap=thread.crest_overlap(**size, crest_diameter=2 * radius),
        bore_radius=end.inner_radius,
    )


def _assessed(loaded: Loaded) -> EndThread | str:
    """The thread of an end, or the reason why it has no safety factor; the result is cached."""
    cache = loaded.end.cache
    if "assessed" not in cache:
        cache["assessed"] = _assessment(loaded)
    assessed: EndThread | str = cache["assessed"]
    return assessed


def _assessment(loaded: Loaded) -> EndThread | str:
    end_thread, materials = derive(loaded.end), loaded.materials
    strengths = metal_strengths(materials, end_thread.male, end_thread.female)
    if isinstance(strengths, str):
        return strengths
    return end_thread


def _strength(loaded: Loaded) -> Strength | str:
    end_thread, materials, force = _assessed(loaded), loaded.materials, loaded.force
    if isinstance(end_thread, str):
        return end_thread
    return Strength(
        _working(materials, end_thread, force), _burst(materials, end_thread, force), NOT_BONDED
    )


def _yields(loaded: Loaded) -> dict[str, Array]:
    end_thread = _assessed(loaded)
    if isinstance(end_thread, str):
        return overlap.yields(loaded)
    strength = loaded.materials.allowable(end_thread.female, "yield_strength")
    skirt = {"skirt under the thread": strength * end_thread.skirt_section / loaded.force}
    return skirt


def _lands(loaded: Loaded) -> dict[str, Array]:
    """Metal left under the thread roots of barrel and skirt [m], and flank overlap [-].

    Every optimisation has limits on these values.
    """
    end_thread = derive(loaded.end)
    walls = (end_thread.root_diameter / 2 - end_thread.layer_radius, end_thread.skirt_wall)
    return dict(zip(LANDS, walls, strict=True)) | {CREST: end_thread.overlap}


def _strengths(
    materials: MaterialProperties, end_thread: EndThread
) -> tuple[tuple[Array, Array], ...]:
    """Yield and ultimate strength of the metals of both threads, male before female."""
    strengths = metal_strengths(materials, end_thread.male, end_thread.female)
    assert not isinstance(strengths, str)
    return strengths


def _working(
    materials: MaterialProperties, end_thread: EndThread, force: Array
) -> dict[str, Array]:
    """Elastic limit divided by stress, for shear of both threads and for flank pressure."""
    (male, _), (female, _) = _strengths(materials, end_thread)
    return {
        "barrel thread": male / sqrt(3) * end_thread.male_area / force,
        "skirt thread": female / sqrt(3) * end_thread.female_area / force,
        "thread flanks": minimum(male, female) * end_thread.flank_area / force,
    }


def _burst(materials: MaterialProperties, end_thread: EndThread, force: Array) -> dict[str, Array]:
    """Breaking load divided by force, for both threads and for the skirt (tension, spreading)."""
    (_, male), (female_yield, female) = _strengths(materials, end_thread)
    ratio = female * end_thread.female_area / (male * end_thread.male_area)
    of_male, of_female = thread.stripping_reductions(strength_ratio=ratio)
    spread = thread.spread_stress(
        force=force, thickness=end_thread.skirt_wall, engagement=end_thread.engagement
    )
    return {
        "barrel thread": of_male * male / sqrt(3) * end_thread.male_area / force,
        "skirt thread": of_female * female / sqrt(3) * end_thread.female_area / force,
        "skirt under the thread": female * end_thread.skirt_section / force,
        "skirt spread by the thread": female_yield / spread,
    }


def _wall(loaded: Loaded) -> WallPressures:
    """Pressures at which the barrel yields and bursts under its thread, by load path.

    The threaded layer alone carries the axial forces. The pressure at its inner radius r_l is p
    r_i/r_l, with oil pressure p and bore radius r_i, as if the inner layers had no hoop stress.

    The pressure at yield ignores the skirt. At burst, layer and skirt are both plastic, and the
    skirt adds its own burst pressure p_s. The turns of the thread carry no hoop stress. By balance
    of forces, they transmit p_s to the layer as p_s d/d_3, with outer diameter d and root diameter
    d_3. The skirt is assumed to be free of axial force, which would lower p_s.
    """
    end_thread, materials = _assessed(loaded), loaded.materials
    if isinstance(end_thread, str):
        return WallPressures()
    yields, bursts = {}, {}
    size = {"inner_radius": end_thread.layer_radius, "outer_radius": end_thread.root_diameter / 2}
    inside = end_thread.bore_radius / end_thread.layer_radius
    (strength, ultimate), (skirt_strength, skirt_ultimate) = _strengths(materials, end_thread)
    support = (
        barrel.burst_pressure_thick(
            inner_radius=end_thread.diameter / 2,
            outer_radius=end_thread.diameter / 2 + end_thread.skirt_wall,
            yield_strength=skirt_strength,
            ultimate_strength=skirt_ultimate,
            axial_force_ratio=0.0,
        )
        * end_thread.diameter
        / end_thread.root_diameter
    )
    for path, axial in loaded.paths.items():
        hoop, radial, along = barrel.bore_stresses(pressure=inside, axial_force=axial, **size)
        stress = (hoop, radial, along, 0.0 * hoop)
        place = f"barrel under the thread, {path}"
        yields[place] = 1 / yield_utilisation(stress=stress, yield_strength=strength)
        ratio = axial / (inside * pi * end_thread.layer_radius * end_thread.layer_radius)
        layer_burst = barrel.burst_pressure_thick(
            **size, yield_strength=strength, ultimate_strength=ultimate, axial_force_ratio=ratio
        )
        bursts[place] = (layer_burst + support) / inside
    return WallPressures(yields, bursts)


def _fatigue(loaded: Loaded) -> Fatigue:
    """Axial stress at both thread roots under pulsating force.

    The notch factor multiplies the range of the stress, but not its mean.
    """
    end_thread = _assessed(loaded)
    if isinstance(end_thread, str):
        return Fatigue()
    pulsed = []
    for place, name, section in (
        ("barrel thread root", end_thread.male, end_thread.barrel_section),
        ("skirt thread root", end_thread.female, end_thread.skirt_section),
    ):
        stress = loaded.force / section
        notch = notch_factor(loaded.materials, name, CUT, CUT_HARD)
        pulsed.append(Pulsed(place, name, notch * stress, stress / 2))
    return Fatigue(tuple(pulsed))


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn of a thread that leaves too little metal."""
    lands = {name: land for name, land in _lands(loaded).items() if name in LANDS}
    consequence = ": such a thread cannot be cut, so its safety factors have no meaning"
    yield from too_thin(lands, quantities, consequence)


_ABSENT = "the caps are not threaded"

JOINT = Joint(
    name="thread",
    help="threaded skirts over the barrel",
    noun="a thread",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField("thread", "missing: required by a thread", 'add a block "thread:" with pitch'),
        JointField("thread.diameter"),
        JointField("thread.pitch"),
        JointField("sleeve"),
    ),
    kinds=(),
    without={
        "material": (
            "has no effect on a thread, which is cut into barrel and caps",
            "remove the line; change barrel.layup or caps.material",
        )
    },
    faults=_faults,
    material_faults=_material_faults,
    opening=lambda _: BarrelOpening("again", "Screw the {end} over the barrel."),
    form="skirts",
    fit=_fit,
    clamping=None,
    give=None,
    mass=_mass,
    outline=_outline,
    notes=_notes,
    strength=_strength,
    yields=_yields,
    wall=_wall,
    beside=overlap.edge_beside,
    fatigue=_fatigue,
    own=_lands,
    envelope=None,
    metrics={
        LANDS[0]: _ABSENT,
        LANDS[1]: _ABSENT,
        CREST: _ABSENT,
    },
    judged=ON_METAL,
    models={
        ("retention_factor", "barrel thread"): "thread.male_strip_area",
        ("retention_factor", "skirt thread"): "thread.female_strip_area",
        ("retention_factor", "thread flanks"): "thread.flank_area",
        ("retention_burst_factor", "barrel thread"): "thread.stripping_reductions",
        ("retention_burst_factor", "skirt thread"): "thread.stripping_reductions",
        ("retention_burst_factor", "skirt under the thread"): "rod.section_area",
        ("retention_burst_factor", "skirt spread by the thread"): "thread.spread_stress",
        ("yield_factor", "skirt under the thread"): "rod.section_area",
    },
    usual=(
        Usual(
            "retention.length",
            "turns of the thread",
            5.0,
            60.0,
            "our choice: of few turns, the two at start and run-out carry nothing; of many, the "
            "first ones carry most of the load",
            lambda end: end.sizes["length"] / end.sizes["thread.pitch"],
        ),
    ),
    warnings=_warnings,
)
