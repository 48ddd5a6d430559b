"""Interface that every joint of the barrel ends implements.

Lengths are in m, forces in N and stresses in Pa. Values are floats or arrays (designs,).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import reduce
from math import floor, radians
from typing import Any, Literal, NamedTuple, Protocol, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Fault
from ..base.numeric import Array, maximum, real, where
from ..base.quantities import Quantity
from ..models import end_bending
from ..models.end_bending import ShellLayer
from ..models.layered_tube import LayeredTube

LEAST_METAL = 1e-3
"""Smallest permitted dimension of a turned part [m]. It applies to walls beside or under a groove
or thread, the wall of a rod, the bore of a laminated rod, and the gap between rod and bore. Our
choice for this size range."""

HARD = 830e6
"""Lowest tensile strength of a metal that counts as hard [Pa]. Our choice, to separate the grades
of [Shigley2011] table 8-16."""

NOT_BONDED = "the caps are not bonded"

ROUNDING = 1e-5
"""A value that misses its limit by at most this relative tolerance still meets it, because an
optimum often lies exactly on a limit."""


class JointSizes(Protocol):
    """Values of the design file's block `retention`, by key such as `thread.pitch`, in SI."""

    def __contains__(self, key: object) -> bool: ...

    def __getitem__(self, key: str) -> Array: ...

    def get(self, key: str, default: Array) -> Array:
        """The value of a key, or `default` if the design does not state it."""
        ...


class MaterialProperties(Protocol):
    """Material properties by material name, in SI."""

    def kind(self, name: str) -> str:
        """Kind of a material: metal, ply, polymer or adhesive."""
        ...

    def get(self, name: str, *properties: str, default: Array = None) -> Array:
        """The first of several properties that the material states; `default` if it states none."""
        ...

    def allowable(self, name: str, *properties: str, cold: bool = False) -> Array:
        """A strength after knock-downs, at the highest temperature or, if `cold`, at the lowest.

        None if it is not stated.
        """
        ...


class StatedValues(Protocol):
    """Read access to the values of a design file while it is checked; an unusable value is None.

    `loc` is the path of a value in the file, such as ``"retention", "thread", "pitch"``.
    """

    def has(self, *loc: str | int) -> bool:
        """Whether the file states a value here."""
        ...

    def number(self, *loc: str | int) -> float | None:
        """The number at a path in the file (SI), or its default."""
        ...

    def text(self, *loc: str | int) -> str | None:
        """The text at a path in the file."""
        ...

    def items(self, *loc: str | int) -> Sequence[Any]:
        """The entries of the list at a path in the file."""
        ...

    @property
    def at_head(self) -> bool:
        """Whether the joint holds the head, alone or as well as the cap."""
        ...


class KnownMaterials(Protocol):
    """Material data for the materials that a design file names."""

    def kind(self, name: str) -> str | None:
        """Kind of a material; None if the name is unknown."""
        ...

    def properties(self, name: str) -> Iterable[str]:
        """Names of the properties stated for a material; empty if its data are unreadable."""
        ...

    def numbers(self, name: str) -> Mapping[str, float]:
        """Properties of a material in SI, of a ply with all its elastic constants.

        Empty if its data are unreadable.
        """
        ...


class JointField(NamedTuple):
    """A key of `retention` that a joint uses.

    For a required key, `missing` and `remedy` are the messages for a file without it; for an
    optional key both are empty. A key that only this joint has also needs `quantity` and `help`.
    """

    key: str
    missing: str = ""
    remedy: str = ""
    quantity: str = ""
    help: str = ""


ON_METAL = ("yield of metal", "rupture of metal")
"""Strengths on which the factors of a metal joint are based: `Joint.judged`."""


class Usual(NamedTuple):
    """A ratio, computed by `number`, that is between `least` and `most` in sensible designs.

    `path` is the input that a warning names if the ratio is outside this range.
    """

    path: str
    meaning: str
    least: float
    most: float
    source: str
    number: Callable[[End], Array]


HELICAL = radians(70.0)
"""Largest winding angle of a layer whose fibres can carry the axial force of an end [rad]. Our
choice: from there on, less than an eighth of the fibre strength acts along the axis."""


class BarrelLayer(NamedTuple):
    """A layer of the barrel, with its winding angle [rad].

    A `helical` layer states an angle up to `HELICAL`, but not 0.
    """

    material: str
    thickness: Array
    angle: Array = 0.0
    helical: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """An end of the barrel with its joint, before loading.

    `material` is the material of the joint, `cap` the material of the cap. `layers` are the layers
    of the barrel, from the bore outwards.
    """

    sizes: JointSizes
    material: str | None
    cap: str
    layers: tuple[BarrelLayer, ...]
    inner_radius: Array
    outer_radius: Array
    barrel_length: Array
    plate: Array
    """Thickness of the end plate."""
    rod_radius: Array
    """Radius of the rod, which passes through the head."""
    head_length: Array | None
    """Length of the head's plug in the barrel; None at the end of the cap alone."""
    seal_depth: Array = 0.0
    """Depth of the groove for the static seal in the rim of the end plate; 0 without one."""
    seal_lip: Array | None = None
    """Thickness of the rim beside that groove, on either side; None without one."""
    ring_height: Array = 0.0
    """Height above the bore of the largest ring that enters the barrel."""
    sleeve: str | None = None
    """Metal of the sleeve into which the joint is cut; None without one."""
    cache: dict[str, Any] = field(default_factory=dict, init=False, compare=False, repr=False)
    """Intermediate results that the joint's functions store here to use again, under any key."""


class SleeveFit(NamedTuple):
    """Dimensions of a sleeve and of the winding on it [m].

    The sleeve extends from the end of the barrel, `bare` outside the winding and `inner` under it.
    At its tip, it is conical over the length `ramp`, which lifts the winding by `lift`. It takes
    the place of the innermost layer if it is `liner` and sleeve in one piece.
    """

    bare: Array
    inner: Array
    ramp: Array
    lift: Array
    liner: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class EndDimensions:
    """Dimensions of cap and barrel that the joint determines, for mass model and drawing.

    A skirt has `length`, `wall` thickness and an inner `radius`. Over this length, a barrel with a
    larger outer radius is turned down to this radius. A barrel that encloses the end plate extends
    by `beyond` past the chamber, and by `lip` past the plate. `groove` is the groove in its bore:
    distance from the chamber, axial width and radial depth. The innermost layer ends by `short`
    before the others. A skirt in the bore has the length `inner_length`; that of the cap lengthens
    the barrel. The outside of the head's plug is then `inset` from the bore. `own` are further
    dimensions for the drawing of the joint.
    """

    plate_radius: Array
    radius: Array
    length: Array = 0.0
    wall: Array = 0.0
    beyond: Array = 0.0
    lip: Array = 0.0
    inner_length: Array = 0.0
    inset: Array = 0.0
    groove: tuple[Array, ...] = ()
    short: Array = 0.0
    own: tuple[Array, ...] = ()
    sleeve: SleeveFit | None = None
    """The sleeve that has the joint, with its groove or turned-down outside."""


class EndSpan(NamedTuple):
    """Axial positions, in the drawing, of one end of the barrel and of the end plates [m].

    `face` is the inner face of the end plate, where the chamber ends, `inwards` the direction from
    it into the chamber (1 or -1), `outside` the outer face of this end's plate, and `opposite` that
    of the plate at the other end.
    """

    face: float
    inwards: int
    outside: float
    opposite: float

    def over(self, length: float, low: float, high: float) -> Polygon:
        """A rectangle between the radii `low` and `high`, over the last `length` of the barrel."""
        start, stop = sorted((self.face, self.face + self.inwards * length))
        return rectangle(start, stop, low, high)

    def beyond(self, near: float, far: float, low: float, high: float) -> Polygon:
        """A rectangle between two radii, from `near` to `far` outside the chamber."""
        start, stop = sorted(self.face - self.inwards * distance for distance in (near, far))
        return rectangle(start, stop, low, high)


Polygon: TypeAlias = tuple[tuple[float, float], ...]
"""Corners of a closed shape of the half-section: (axial position, radius) [m]."""


def rectangle(start: float, stop: float, low: float, high: float) -> Polygon:
    """A rectangle in the half-section, from `start` to `stop` and from radius `low` to `high`."""
    return ((start, low), (stop, low), (stop, high), (start, high))


def thread_line(
    *, start: float, length: float, pitch: float, root_radius: float, crest_radius: float
) -> Polygon:
    """Line of the flanks of a thread in the half-section, from root to crest and back [m].

    `start` is the axial position of its lower end. Only whole turns are drawn.

    >>> thread_line(start=0.0, length=2.5, pitch=1.0, root_radius=4.0, crest_radius=5.0)
    ((0.0, 4.0), (0.5, 5.0), (1.0, 4.0), (1.5, 5.0), (2.0, 4.0))
    """
    halves = 2 * floor(length / pitch * (1 + ROUNDING))
    radii = (root_radius, crest_radius)
    return tuple((start + k * pitch / 2, radii[k % 2]) for k in range(halves + 1))


LINE = "line"
"""Name of a drawn part that is only a line, such as the flanks of a thread, without a volume."""


class DrawnPart(NamedTuple):
    """A part as drawn in the half-section: a turned part, or a set of equal round bars.

    `bars` is the number of bars, 0 for a turned part. They are parallel to the axis, or `radial`. A
    part with the name `LINE` is only a line; it belongs to no part.
    """

    part: str
    material: str
    shape: Polygon
    bars: int = 0
    radial: bool = False


@dataclass(frozen=True, slots=True)
class Clamp:
    """Parts that clamp the barrel between both ends, such as tie rods.

    `preload` is the total preload at assembly [N], the mean of what tightening gives, and
    `greatest` the most of it. `added` is the force that supply pressure adds [N]. `closed` is the
    least preload, after settling, divided by the clamping force that proof pressure takes away, by
    temperature; the joint stays closed if it is above 1. `changes` are the changes of the preload
    at the lowest and the highest temperature [N], with the keys "cold" and "hot"; empty if unknown.
    """

    preload: Array
    greatest: Array
    added: Array
    closed: Mapping[str, Array]
    changes: Mapping[str, Array] = field(default_factory=dict)

    @property
    def largest(self) -> Array:
        """Largest total force at supply pressure and the temperature of assembly [N]."""
        return self.greatest + self.added


class Clamping(NamedTuple):
    """Axial stiffness of the parts that clamp the barrel [N/m], and their free growth [m/K].

    The growth is None if their thermal expansion is unknown. `tightening_factor` is the greatest
    divided by the least preload that tightening gives.
    """

    stiffness: Array
    growth: Array | None
    tightening_factor: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Loaded:
    """An end of the barrel under load.

    `force` is the largest force that separates cap and barrel [N]. `paths` are the axial forces in
    the barrel wall per unit pressure [m^2], by name of the load path: pressure without and with
    axial force. `line_stiffness` is the axial E t of the
    wall [N/m], and `expansion` its axial thermal expansion [1/K], None if unknown.
    """

    end: End
    materials: MaterialProperties
    force: Array
    paths: Mapping[str, Array]
    line_stiffness: Array
    expansion: Array | None
    warm_liner: Array | None
    """Axial stress of the innermost layer per kelvin of warming [Pa/K]; None if it is no metal of a
    layered wall, or unknown."""
    clamp: Clamp | None
    shells: tuple[ShellLayer, ...]
    """Stiffness of the barrel's layers against bending; empty if an elastic constant is unknown."""
    pressure: Array
    """Supply pressure [Pa]."""
    tube: Callable[[], LayeredTube | None]
    """The barrel as an exact layered tube; None if an elastic constant is unknown."""
    warmings: Mapping[str, Array]
    """Temperature changes since assembly, cold and hot [K]; empty without a temperature range."""
    since_cure: tuple[Array, ...]
    """Temperature changes since cure, cold and hot [K]; empty without a temperature of cure."""


class Pulsed(NamedTuple):
    """Stress in a metal part under pulsating pressure [Pa]: its range (`span`) and its mean."""

    place: str
    material: str
    span: Array
    mean: Array


class Life(NamedTuple):
    """Fatigue of a part: cycles to failure, and fatigue strength divided by stress amplitude."""

    cycles: Array
    factor: Array


StaticPlace: TypeAlias = Literal["", "rim", "bore"]
"""Place of a static seal: none, in the rim of a plug, or inside the barrel on head and spigot."""

Form: TypeAlias = Literal["skirts", "plugs", "wound", "plates"]
"""Form of a cap: a skirt over the barrel, a plug in its bore, a plug that the barrel is wound over,
or a plate."""

ENCLOSED: tuple[Form, ...] = ("plugs", "wound")
"""Forms of caps that the barrel encloses."""

Thermal = Callable[[Array, bool], Array]
"""Function that returns the strength divided by the load of a temperature change.
Its arguments are the change [K], and whether to use the strength at the lowest temperature."""


class Fatigue(NamedTuple):
    """Fatigue at the joint.

    `pulsed` are stresses that the evaluation still has to assess with the fatigue data of the
    metal. `lives` are the results, by part, for parts that the joint itself has assessed.
    """

    pulsed: tuple[Pulsed, ...] = ()
    lives: Mapping[str, Life] = {}


class WallPressures(NamedTuple):
    """Pressures at which the barrel yields and bursts at the joint [Pa].

    Both are dicts whose keys are locations, such as "barrel under the thread, ..." with the load
    path (pressure without or with axial force).
    """

    yields: Mapping[str, Array] = {}
    bursts: Mapping[str, Array] = {}


class EdgeBeside(NamedTuple):
    """The barrel where it leaves a joint and bends.

    `place` ends the names of its rows. `wall` is the barrel as a shell, `edge` its edge, and
    `growth` its growth far from the edge [m]. `metal_peak` is the stress of a metal layer divided
    by that far from the edge; None to calculate it from the shell.
    """

    place: str
    wall: end_bending.Shell
    edge: end_bending.Edge
    growth: Array
    metal_peak: Array | None = None


@dataclass(frozen=True, slots=True)
class Strength:
    """Safety factors (strength divided by load) of the joint at an end of the barrel.

    `working` is the elastic limit and `burst` the breaking load, each divided by the largest force;
    both are dicts whose keys are locations. `thermal` is a function for the factor under
    temperature alone, or the reason why that factor is unknown. `combined` is a function for the
    burst factor under the force, after a temperature change; None if it is unknown. `cured` is
    whether `thermal` counts the change since the cure of the winding, and not since assembly.
    """

    working: Mapping[str, Array]
    burst: Mapping[str, Array]
    thermal: Thermal | str
    combined: Thermal | None = None
    cured: bool = False


class BarrelOpening(NamedTuple):
    """BarrelOpening at an end of the barrel through which parts enter, and what closes it.

    An end `opens` "again" at any time, "once" if it is closed for good, as by a bond, or "never" if
    it is made with the barrel. `closing` is a sentence with the word {end} for cap or head.
    `diameter` is the narrowest place before the bore [m], None if the bore is the narrowest.
    `crossed` are name and axial width [m] of a recess that seals pass on their way; or None.
    """

    opens: Literal["again", "once", "never"]
    closing: str
    diameter: float | None = None
    crossed: tuple[str, float] | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Joint:
    """A joint of the barrel ends.

    Every joint must state the fields without default; a field that does not apply is empty,
    `nothing` or None. Masses and forces are for one end; both ends are equal.
    """

    name: str
    help: str
    noun: str
    """Noun for the joint in messages: `a bond`, or a plural such as `tie rods`."""
    fields: tuple[JointField, ...]
    """Keys of the block `retention` that the joint uses; any other key in a design file is an
    error."""
    kinds: tuple[str, ...]
    """Allowed kinds of the material `retention.material`; empty if the joint has no material."""
    without: Mapping[str, tuple[str, str]]
    """Error message and remedy for some keys that the joint does not use, by key. They replace the
    general message for an unused key."""
    faults: Callable[[StatedValues], Iterable[Fault]]
    """Function that yields errors in the values of a design file."""
    material_faults: Callable[[StatedValues, KnownMaterials], Iterable[Fault]]
    """Function that yields errors in a design file that depend on material properties."""
    opening: Callable[[StatedValues], BarrelOpening]
    """Function that describes how parts enter the barrel at this end."""
    form: Form
    fit: Callable[[End], EndDimensions]
    clamping: Callable[[End, MaterialProperties], Clamping] | None
    """Function that describes the parts that clamp the barrel; None if none do."""
    give: Callable[[End, MaterialProperties], Array] | None
    """Axial compliance of the joint at one end [m/N]; None if it is neglected."""
    mass: Callable[[End, MaterialProperties], Mapping[str, Array]]
    """Mass [kg] of the joint at one end, by part: barrel, caps or fastening."""
    outline: Callable[[End, EndDimensions, EndSpan], Iterable[DrawnPart]]
    """Parts of the joint in the half-section at one end."""
    notes: Callable[[End], Iterable[str]]
    """Sentences for the drawing on details that it does not show."""
    strength: Callable[[Loaded], Strength | str]
    """Strength of an end, or the reason why it cannot be assessed."""
    yields: Callable[[Loaded], Mapping[str, Array]]
    """Further safety factors against yielding (elastic limit divided by stress), by location."""
    wall: Callable[[Loaded], WallPressures]
    """Failure pressures of the barrel wall itself, where the joint weakens it."""
    beside: Callable[[Loaded], EdgeBeside | None] | None
    """Function for the barrel's edge beside the joint, None without known constants; or None if the
    barrel has no such edge."""
    fatigue: Callable[[Loaded], Fatigue]
    own: Callable[[Loaded], Mapping[str, Array | Mapping[str, Array]]]
    """Values of the metrics that only this joint has; `metrics` lists their names."""
    envelope: Callable[[Loaded, Mapping[str, Array]], Mapping[str, Array]] | None
    """Function that gives upper bounds of `Strength.working` from `Strength.burst`; or None. It is
    needed only if the working factor is not a convex function of the design's numbers; the bounds
    then serve to prove how good an optimum is."""
    metrics: Mapping[str, str]
    """Metrics that only this joint has, each with the text that says why other joints do not have
    it."""
    judged: tuple[str, str]
    """Words for the strengths on which the working factor and the burst factor are based."""
    models: Mapping[tuple[str, str], str]
    """Main model, such as `rod.section_area`, that computes a metric at a location; the keys are
    pairs (metric, location)."""
    usual: tuple[Usual, ...]
    warnings: Callable[[Loaded, Mapping[str, Quantity]], Iterable[tuple[str, str]]]
    """Function that yields a pair (metric, sentence) for each warning; its second argument has the
    quantities of all metrics."""

    @property
    def inner_skirt(self) -> bool:
        """Whether the caps also have a skirt in the bore, as long as `length`."""
        return any(field.key == "inner_wall" for field in self.fields)

    @property
    def static_seal(self) -> StaticPlace:
        """Where the static seal of the end is; an adhesive seals by itself."""
        if "adhesive" in self.kinds:
            return ""
        return "rim" if self.form in ENCLOSED else "bore"

    @property
    def plural(self) -> bool:
        """Whether the noun is plural."""
        return not self.noun.startswith(("a ", "an "))


RINGS = (("seals", "piston"), ("seals", "piston", "secondary"), ("seals", "static"))
"""Places of the rings that enter the barrel through its ends."""


class EnteringRing(NamedTuple):
    """Section of a free ring [m], its squeeze, and the tolerances of gland depth and section [m].

    The names are the keys of the ring in the design file.
    """

    section: Array
    squeeze: Array
    tolerance: Array = 0.0
    section_tolerance: Array = 0.0


def stated_rings(view: StatedValues) -> list[EnteringRing]:
    """The rings that enter through an end, as far as the file states their sizes."""
    stated = (
        [view.number(*place, key) for key in EnteringRing._fields]
        for place in RINGS
        if view.has(*place)
    )
    return [
        EnteringRing(section, squeeze, *(size or 0.0 for size in tolerances))
        for section, squeeze, *tolerances in stated
        if section is not None and squeeze is not None
    ]


def ring_height(rings: Iterable[EnteringRing]) -> Array:
    """Largest height of a free ring above the bore [m]; 0 without rings.

    Section times squeeze at nominal size. A thick ring in a shallow gland is higher by both
    tolerances.
    """
    heights = (
        ring.section * ring.squeeze + ring.tolerance + ring.section_tolerance for ring in rings
    )
    return reduce(maximum, heights, 0.0)


def nothing(*_: object) -> Iterator[Any]:
    """Yield nothing; replaces functions that do not apply to a joint."""
    return iter(())


def check(joints: Iterable[Joint]) -> None:
    """Refuse two joints that declare the same key or metric, or two models of one place.

    Raises
    ------
    ValueError
        two joints declare the same thing; the text names both
    """
    seen: dict[object, str] = {}
    for joint in joints:
        keys = [field.key for field in joint.fields if field.quantity]
        for claim in (*keys, *joint.metrics, *joint.models):
            if claim in seen:
                raise ValueError(f"joint {joint.name}: {claim} already belongs to {seen[claim]}")
            seen[claim] = joint.name


def chosen(stated: StatedValues, path: str) -> bool:
    """Whether the file gives several choices for this value."""
    return stated.has("choices", path)


_PARTS = ("retention.type", "retention.sleeve.material")
"""Choices of the parts of a joint."""


def judged_later(stated: StatedValues, varied: Iterable[str]) -> bool:
    """Whether some sizes are checked only later, when the search tries each combination of choices.

    `varied` are the PATHs of the sizes. They are checked later if one of them is a variable of the
    optimisation, and one of them, the type of joint or its sleeve has several choices.
    """
    paths = tuple(varied)
    free = any(stated.has("variables", path) for path in paths)
    return free and any(chosen(stated, path) for path in (*paths, *_PARTS))


def metal_strengths(
    materials: MaterialProperties, *names: str
) -> tuple[tuple[Array, Array], ...] | str:
    """Yield and ultimate strength of metals; or the first reason why one is unknown."""
    pairs = []
    for name in names:
        strength, ultimate = (
            materials.allowable(name, key) for key in ("yield_strength", "ultimate_strength")
        )
        if materials.kind(name) != "metal":
            return f"{name} is not a metal"
        if strength is None or ultimate is None:
            return f"{name} has no yield or ultimate strength"
        pairs.append((strength, ultimate))
    return tuple(pairs)


def notch_factor(materials: MaterialProperties, name: str, soft: float, hard: float) -> Array:
    """Fatigue notch factor of a metal: `soft` below the tensile strength `HARD`, else `hard`."""
    return where(real(materials.get(name, "ultimate_strength", default=0.0)) >= HARD, hard, soft)


def too_thin(
    lands: Mapping[str, Array],
    quantities: Mapping[str, Quantity],
    consequence: str = "",
) -> Iterator[tuple[str, str]]:
    """Warn of lands that are smaller than `LEAST_METAL`; an optimised design never has them.

    `lands` are dimensions [m], by metric. `consequence` ends the sentence.
    """
    for name, land in lands.items():
        least = float(np.min(np.real(land)))
        if least < LEAST_METAL * (1 - ROUNDING):
            label = quantities[name]
            yield (
                "retention_factor",
                f"{label.label}: {label.text(least)}, but {label.text(LEAST_METAL)} is needed"
                f"{consequence}",
            )


def models_at(joints: Iterable[Joint], metric: str) -> dict[str, str]:
    """Names of the main models of a metric, by location, collected from all joints."""
    return {
        place: model
        for joint in joints
        for (name, place), model in joint.models.items()
        if name == metric
    }


def judged_on(joints: Iterable[Joint], index: int) -> str:
    """Words that name the strengths on which the safety factors of all joints are based.

    `index` is 0 for the working factor, 1 for the burst factor.
    """
    return " or ".join(dict.fromkeys(joint.judged[index] for joint in joints))
