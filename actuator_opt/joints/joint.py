"""Interface that every joint of the barrel ends implements.

Lengths are in m, forces in N and stresses in Pa. Values are floats or arrays (designs,).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any, NamedTuple, Protocol, TypeAlias

from ..base.dataclass import dataclass
from ..base.errors import Fault
from ..base.numeric import Array
from ..base.quantities import Quantity

LEAST_METAL = 1e-3
"""Least dimension of a turned part [m]. It applies to walls beside or under a groove or thread, the
wall of a rod, the bore of a laminated rod, and the gap between rod and bore. Our choice for this
size range."""

NOT_BONDED = "the caps are not bonded"

ROUNDING = 1e-5
"""Relative tolerance within which an optimum on its limit still meets it."""


class JointSizes(Protocol):
    """Values of the block `retention` by key, such as `thread.pitch`, in SI."""

    def __contains__(self, key: object) -> bool: ...

    def __getitem__(self, key: str) -> Array: ...

    def get(self, key: str, default: Array) -> Array:
        """The number of a key, or `default` if the design does not state it."""
        ...


class MaterialProperties(Protocol):
    """Material properties by material name, in SI."""

    def kind(self, name: str) -> str:
        """Kind of a material: metal, ply, polymer or adhesive."""
        ...

    def get(self, name: str, *properties: str, default: Array = None) -> Array:
        """The first stated property of several; `default` if none is stated."""
        ...

    def allowable(self, name: str, *properties: str, cold: bool = False) -> Array:
        """A strength after knock-downs, at the hottest or (`cold`) coldest; None if not stated."""
        ...


class StatedValues(Protocol):
    """A design file during the check for faults: values by path in the file, None if unusable."""

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
        """The entries of a list."""
        ...


class KnownMaterials(Protocol):
    """Material data for the materials that a design file names."""

    def kind(self, name: str) -> str | None:
        """Kind of a material; None if the name is unknown."""
        ...

    def properties(self, name: str) -> Iterable[str]:
        """Names of the stated properties; empty if unreadable."""
        ...


class JointField(NamedTuple):
    """A key of `retention` that a joint uses.

    For a required key, `missing` and `remedy` are the messages for a file without it; for an
    optional key both are empty. A key that no other joint has states its `quantity` and `help`.
    """

    key: str
    missing: str = ""
    remedy: str = ""
    quantity: str = ""
    help: str = ""


class FactorBasis(NamedTuple):
    """Basis of a safety factor: which `measure` of strength is used, and `of` which parts."""

    measure: str
    of: str = ""


class Usual(NamedTuple):
    """A ratio with a usual range in sensible designs; `path` is the value to check."""

    path: str
    meaning: str
    least: float
    most: float
    source: str
    number: Callable[[End], Array]


class BarrelLayer(NamedTuple):
    """A layer of the barrel."""

    material: str
    thickness: Array


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
    cache: dict[str, Any] = field(default_factory=dict, init=False, compare=False, repr=False)
    """Intermediate results that a joint uses again, by keys that it chooses."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndDimensions:
    """Dimensions of cap and barrel that the joint determines, for mass model and drawing.

    A skirt has `length`, `wall` and an inner `radius`; a larger barrel is turned down to this
    radius. `own` are further dimensions that the outline of the joint needs.
    """

    plate_radius: Array
    radius: Array
    length: Array = 0.0
    wall: Array = 0.0
    own: tuple[Array, ...] = ()


class EndSpan(NamedTuple):
    """Position of an end in the drawing [m]: face of the barrel, direction into it (1 or -1).

    `outside` is the outer face of this end plate, `opposite` that of the plate at the other end.
    """

    face: float
    inwards: int
    outside: float
    opposite: float

    def over(self, length: float, low: float, high: float) -> Polygon:
        """A rectangle over the last `length` of the barrel at this end, between two radii."""
        start, stop = sorted((self.face, self.face + self.inwards * length))
        return rectangle(start, stop, low, high)


Polygon: TypeAlias = tuple[tuple[float, float], ...]
"""Corners of a closed shape of the half-section: (axial position, radius) [m]."""


def rectangle(start: float, stop: float, low: float, high: float) -> Polygon:
    """A rectangle of the half-section, along the axis and radially."""
    return ((start, low), (stop, low), (stop, high), (start, high))


class DrawnPart(NamedTuple):
    """A part of the half-section; `bars` counts round bars about the axis, 0 is a turned part."""

    part: str
    material: str
    shape: Polygon
    bars: int = 0


@dataclass(frozen=True, slots=True)
class Clamp:
    """Parts that clamp the barrel between both ends, such as tie rods.

    The values are total preload and largest total force at supply pressure [N], and the ratio of
    preload to the part of it that proof pressure takes away.
    """

    preload: Array
    largest: Array
    closed: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Loaded:
    """An end of the barrel under load.

    `force` is the largest separating force [N]. `paths` are the axial forces in the barrel wall per
    pressure [m^2], by load path. `line_stiffness` is the axial E t of the wall [N/m], and
    `expansion` its axial thermal expansion [1/K], None if unknown.
    """

    end: End
    materials: MaterialProperties
    force: Array
    paths: Mapping[str, Array]
    line_stiffness: Array
    expansion: Array | None
    clamp: Clamp | None


class Pulsed(NamedTuple):
    """Stress of a metal under pulsating pressure: range and mean [Pa]."""

    place: str
    material: str
    span: Array
    mean: Array


class Life(NamedTuple):
    """Fatigue of a part: cycles to failure, and strength over stress amplitude."""

    cycles: Array
    factor: Array


Thermal = Callable[[Array, bool], Array]
"""Function for strength over load by a temperature change [K] alone; True: at the coldest."""


class Fatigue(NamedTuple):
    """Pulsating stresses, assessed by metal data, and locations with their own fatigue strength."""

    pulsed: tuple[Pulsed, ...] = ()
    lives: Mapping[str, Life] = {}


class WallPressures(NamedTuple):
    """Pressures at which the barrel yields and bursts at the joint, by location [Pa]."""

    yields: Mapping[str, Array] = {}
    bursts: Mapping[str, Array] = {}


@dataclass(frozen=True, slots=True)
class Strength:
    """Strength over load of an end, by location.

    `working` are elastic limits and `burst` are breaking loads, both over the largest force.
    `thermal` gives strength over load by temperature alone, or the reason why it is unknown.
    """

    working: Mapping[str, Array]
    burst: Mapping[str, Array]
    thermal: Thermal | str


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
    """Keys of `retention` that the joint uses; any other key is a fault."""
    kinds: tuple[str, ...]
    """Allowed kinds of `retention.material`; empty: no material."""
    without: Mapping[str, tuple[str, str]]
    """Fault and remedy for some keys that the joint does not use, in place of the general text."""
    faults: Callable[[StatedValues], Iterable[Fault]]
    """Function that yields faults among the values of a design file."""
    material_faults: Callable[[StatedValues, KnownMaterials], Iterable[Fault]]
    """Function that yields faults that depend on the material library."""
    skirts: bool
    """Whether the caps have skirts over the outside of the barrel."""
    fit: Callable[[End], EndDimensions]
    stiffness: Callable[[End, MaterialProperties], Array] | None
    """Axial stiffness of the parts that clamp the barrel [N/m]; None if none do."""
    mass: Callable[[End, MaterialProperties], Mapping[str, Array]]
    """Mass [kg] of the joint at one end, by part: barrel, caps or fastening."""
    outline: Callable[[End, EndDimensions, EndSpan], Iterable[DrawnPart]]
    """Parts of the joint in the half-section at one end."""
    notes: Callable[[End], Iterable[str]]
    """Sentences on details that the drawing does not show."""
    strength: Callable[[Loaded], Strength | str]
    """Strength of an end, or the reason why it cannot be assessed."""
    yields: Callable[[Loaded], Mapping[str, Array]]
    """Further elastic limits over working stress, by location."""
    wall: Callable[[Loaded], WallPressures]
    """Strength of the barrel itself at the joint."""
    fatigue: Callable[[Loaded], Fatigue]
    own: Callable[[Loaded], Mapping[str, Array]]
    """Values of the metrics that only this joint has; `metrics` lists their names."""
    envelope: Callable[[Loaded, Mapping[str, Array]], Mapping[str, Array]] | None
    """Upper bound of `Strength.working`, from `burst`, if the working factor is not convex."""
    metrics: Mapping[str, str]
    """Metrics that only this joint has, with the reason why other joints lack them."""
    judged: tuple[FactorBasis, FactorBasis]
    """Bases of the working factor and of the burst factor."""
    models: Mapping[tuple[str, str], str]
    """Main model, such as `rod.section_area`, by metric and location."""
    usual: tuple[Usual, ...]
    warnings: Callable[[Loaded, Mapping[str, Quantity]], Iterable[tuple[str, str]]]
    """(metric, sentence) for each doubt; the second argument has the quantities of all metrics."""

    @property
    def plural(self) -> bool:
        """Whether the noun is plural."""
        return not self.noun.startswith(("a ", "an "))


def nothing(*_: object) -> Iterator[Any]:
    """Do nothing: for functions that do not apply to a joint."""
    return iter(())


def check(joints: Iterable[Joint]) -> None:
    """Refuse joints that declare the same metric, the same location of a model, or the same key.

    Raises
    ------
    ValueError
        two joints declare the same; the text names both
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


def judged_later(stated: StatedValues, varied: Iterable[str]) -> bool:
    """Whether choices vary all of these sizes (PATHs). The search then checks every combination."""
    paths = tuple(varied)
    free = any(stated.has("variables", path) for path in paths)
    return free and any(chosen(stated, path) for path in (*paths, "retention.type"))


def models_at(joints: Iterable[Joint], metric: str) -> dict[str, str]:
    """Main models of a metric by location, for all joints."""
    return {
        place: model
        for joint in joints
        for (name, place), model in joint.models.items()
        if name == metric
    }


def judged_on(joints: Iterable[Joint], index: int) -> str:
    """Basis of the working factor (index 0) or burst factor (1) for all joints, in words."""
    groups: dict[str, list[str]] = {}
    for joint in joints:
        judged = joint.judged[index]
        groups.setdefault(judged.measure, []).append(judged.of)
    return ", ".join(
        f"{measure} of {_alternatives(parts)}" if all(parts) else measure
        for measure, parts in groups.items()
    )


def _alternatives(parts: Sequence[str]) -> str:
    """Join parts with "or"; a comma precedes it if a part is itself a list.

    >>> _alternatives(["threads", "tie rods"]), _alternatives(["threads and skirt", "tie rods"])
    ('threads or tie rods', 'threads and skirt, or of tie rods')
    """
    return (", or of " if any(" and " in part for part in parts) else " or ").join(parts)
