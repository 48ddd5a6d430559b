"""The caps' screwed joint: a thread on the barrel, one in the skirts, both walls under it.

The thread is cut into the barrel's outermost layer, which is turned down to `thread.diameter` where
that is smaller. It is taken to carry all of the force. Oil stands under it up to the ends of the
barrel; inner layers are taken to hold none of its pressure there. Files in which a thread cannot
be cut are refused by `design.thread_faults`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi, sqrt

from ..design.model import Design
from ..models import barrel, thread, yielding
from ..models.rod import section_area
from ..numeric import Array, minimum, real, where
from .allow import Stock
from .geometry import Geometry
from .values import Values

LANDS = ("geometry_barrel_thread", "geometry_skirt_thread")
CREST = "geometry_thread_crest"
"""Metrics of the metal left under both roots, and of the overlap of their flanks."""

HARD = 830e6
"""Tensile strength from which a metal counts as hard [Pa] (a choice, for the grades of
[Shigley2011] table 8-16)."""

CUT, CUT_HARD = 3.0, 3.8
"""Fatigue notch factors of a cut thread root: [Shigley2011] table 8-16 has 2.8 for soft steel and
3.8 for hard steel; 3 below `HARD` covers other metals too, for which no table was found."""


@dataclass(frozen=True, slots=True)
class Thread:
    """The thread of a screwed design: sizes [m], areas [m^2], and the metals it is cut into."""

    male: str
    female: str
    diameter: Array
    root_diameter: Array
    skirt_wall: Array
    """Wall of the skirts over the thread."""
    engagement: Array
    male_area: Array
    female_area: Array
    flank_area: Array
    barrel_section: Array
    """Section of the threaded layer under its root."""
    skirt_section: Array
    layer_radius: Array
    """Inner radius of the threaded layer."""
    overlap: Array
    """Of the flanks, over that of full crests."""
    bore_radius: Array


def derive(v: Values, design: Design, g: Geometry) -> Thread | None:
    """The thread of a design; None where the caps are not screwed on."""
    if not screwed(design):
        return None
    pitch = v["retention.thread.pitch"]
    diameter = v.get("retention.thread.diameter", 2 * g.outer_radius)
    size = {"diameter": diameter, "pitch": pitch}
    engagement = thread.engaged_length(length=g.skirt_length, pitch=pitch)
    crested = {"engagement": engagement, "crest_diameter": 2 * g.skirt_radius}
    root = thread.root_diameter(**size)
    layer = g.outer_radius - g.thicknesses[-1]
    outer = 2 * (g.skirt_radius + g.skirt_wall)
    return Thread(
        male=design.barrel.layup[-1].material,
        female=design.caps.material,
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
        overlap=thread.crest_overlap(**size, crest_diameter=2 * g.skirt_radius),
        bore_radius=g.inner_radius,
    )


def screwed(design: Design) -> bool:
    """Whether the caps are screwed onto the barrel."""
    held = design.retention
    return held is not None and held.type == "thread" and held.thread is not None


def lands(v: Values, design: Design, g: Geometry) -> dict[str, Array]:
    """Metal left under either root and overlap of the flanks, limits that no search gives up."""
    cut = derive(v, design, g)
    if cut is None:
        return {}
    walls = (cut.root_diameter / 2 - cut.layer_radius, cut.skirt_wall)
    return dict(zip(LANDS, walls, strict=True)) | {CREST: cut.overlap}


def _strengths(stock: Stock, name: str) -> tuple[Array, Array]:
    return (
        stock.allowable(name, "yield_strength"),
        stock.allowable(name, "ultimate_strength"),
    )


def judged(v: Values, design: Design, stock: Stock, g: Geometry) -> Thread | str:
    """The thread of a design, or why it has no factor."""
    cut = derive(v, design, g)
    if cut is None:
        return "the caps are not screwed on"
    for name in (cut.male, cut.female):
        if stock.material(name).kind != "metal":
            return f"{name} is no metal: a thread is cut into metal only"
        if any(strength is None for strength in _strengths(stock, name)):
            return f"{name} states no yield or ultimate strength"
    return cut


def factors(stock: Stock, cut: Thread, force: Array) -> dict[str, Array]:
    """Elastic limit over stress: both threads in shear, and their flanks."""
    male, female = (_strengths(stock, name)[0] for name in (cut.male, cut.female))
    return {
        "barrel thread": male / sqrt(3) * cut.male_area / force,
        "skirt thread": female / sqrt(3) * cut.female_area / force,
        "thread flanks": minimum(male, female) * cut.flank_area / force,
    }


def burst_factors(stock: Stock, cut: Thread, force: Array) -> dict[str, Array]:
    """Strength at rupture over the force: both threads, and the skirt they tear and spread."""
    male, female = (_strengths(stock, name)[1] for name in (cut.male, cut.female))
    ratio = female * cut.female_area / (male * cut.male_area)
    of_male, of_female = thread.stripping_reductions(strength_ratio=ratio)
    spread = thread.spread_stress(force=force, thickness=cut.skirt_wall, engagement=cut.engagement)
    return {
        "barrel thread": of_male * male / sqrt(3) * cut.male_area / force,
        "skirt thread": of_female * female / sqrt(3) * cut.female_area / force,
        "skirt under the thread": female * cut.skirt_section / force,
        "skirt spread by the thread": _strengths(stock, cut.female)[0] / spread,
    }


def barrel_pressures(
    stock: Stock, cut: Thread, paths: Mapping[str, Array]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Pressures at which the barrel yields and bursts under its thread, by load path.

    `paths` are axial forces per pressure. The layer carries them alone, with the pressure
    p r_i/r_l on its inner radius r_l that inner layers without hoop stress would leave.

    It yields as if the skirt were not there. At burst both are plastic, and the skirt adds the
    pressure p_s that it would burst at: the turns, cut through, carry no hoop stress and pass it
    on as p_s d/d_3 (balance of forces; no axial force is taken in the skirt, which lowers p_s).
    """
    yields, bursts = {}, {}
    size = {"inner_radius": cut.layer_radius, "outer_radius": cut.root_diameter / 2}
    inside = cut.bore_radius / cut.layer_radius
    strength, ultimate = _strengths(stock, cut.male)
    skirt_strength, skirt_ultimate = _strengths(stock, cut.female)
    support = (
        barrel.burst_pressure_thick(
            inner_radius=cut.diameter / 2,
            outer_radius=cut.diameter / 2 + cut.skirt_wall,
            yield_strength=skirt_strength,
            ultimate_strength=skirt_ultimate,
            axial_force_ratio=0.0,
        )
        * cut.diameter
        / cut.root_diameter
    )
    for path, axial in paths.items():
        hoop, radial, along = barrel.bore_stresses(pressure=inside, axial_force=axial, **size)
        stress = (hoop, radial, along, 0.0 * hoop)
        place = f"barrel under the thread, {path}"
        yields[place] = 1 / yielding.yield_utilisation(stress=stress, yield_strength=strength)
        ratio = axial / (inside * pi * cut.layer_radius * cut.layer_radius)
        alone = barrel.burst_pressure_thick(
            **size, yield_strength=strength, ultimate_strength=ultimate, axial_force_ratio=ratio
        )
        bursts[place] = (alone + support) / inside
    return yields, bursts


def root_stresses(
    stock: Stock, cut: Thread, force: Array
) -> Iterator[tuple[str, str, Array, Array]]:
    """Place, metal, range and mean of the axial stress at either root while the force pulsates.

    The notch raises the range alone.
    """
    for place, name, section in (
        ("barrel thread root", cut.male, cut.barrel_section),
        ("skirt thread root", cut.female, cut.skirt_section),
    ):
        stress = force / section
        hard = real(stock.get(name, "ultimate_strength", default=0.0)) >= HARD
        yield place, name, where(hard, CUT_HARD, CUT) * stress, stress / 2
