"""Interface of a joint of the barrel ends: everything that the program requires of it.

Lengths in m, forces in N, stresses in Pa; numbers are floats or arrays (designs,).
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
"""Least wall beside or under a groove or thread, least rod wall, bore of a laminated rod, and gap
between rod and bore (m): a choice for turned parts in this size range."""

NOT_BONDED = "the caps are not bonded"

ROUNDING = 1e-5
"""Relative tolerance for an optimum on its limit."""


class JointSizes(Protocol):
    """Numbers of the joint by key, such as `thread.pitch`, in SI."""

    def __contains__(self, key: object) -> bool: ...

    def __getitem__(self, key: str) -> Array: ...

    def get(self, key: str, default: Array) -> Array:
        """The number of a key, or `default` if the design does not state it."""
        ...


class MaterialProperties(Protocol):
    """Material properties by material name, in SI."""

    def kind(self, name: str) -> str:
        """Kind of a material: metal, ply, polymer, adhesive."""
        ...

    def get(self, name: str, *properties: str, default: Array = None) -> Array:
        """The first stated property of several; `default` if none is stated."""
        ...

    def allowable(self, name: str, *properties: str, cold: bool = False) -> Array:
        """A strength after its knock-downs, hottest or coldest; None if not stated."""
        ...


class StatedValues(Protocol):
    """A design file during fault checks: values by place, None if unusable."""

    def has(self, *loc: str | int) -> bool:
        """Whether the file states a value here."""
        ...

    def number(self, *loc: str | int) -> float | None:
        """The SI number at a place, or its default."""
        ...

    def text(self, *loc: str | int) -> str | None:
        """The text at a place."""
        ...

    def items(self, *loc: str | int) -> Sequence[Any]:
        """The entries of a list."""
        ...


class KnownMaterials(Protocol):
    """Data of the materials that a design file names."""

    def kind(self, name: str) -> str | None:
        """Kind of a material; None if the name is unknown."""
        ...

    def properties(self, name: str) -> Iterable[str]:
        """Names of the stated properties; empty if unreadable."""
        ...


class JointField(NamedTuple):
    """A key of `retention` that a joint uses.

    `missing` and `remedy` are the fault of a file without a required key; both empty: optional. A
    key that no other joint has states its `quantity` and `help`.
    """

    key: str
    missing: str = ""
    remedy: str = ""
    quantity: str = ""
    help: str = ""


class FactorBasis(NamedTuple):
    """Basis of a safety factor: the `measure`, and the parts that it applies `of`."""

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
    """An end of the barrel with its joint.

    `material` is that of the joint, `cap` that of the cap; `layers` are those of the barrel, from
    the bore outwards.
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
    """Intermediate results of a joint that it uses again, by its own key."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndDimensions:
    """Dimensions that the joint gives cap and barrel, and all that the drawing uses.

    A skirt has `length`, `wall` and an inner `radius`, to which a larger barrel is turned down.
    `own` are further dimensions for the outline of the joint.
    """

    plate_radius: Array
    radius: Array
    length: Array = 0.0
    wall: Array = 0.0
    own: tuple[Array, ...] = ()


class EndSpan(NamedTuple):
    """Position of an end in the drawing [m]: barrel face, direction into the barrel (1 or -1).

    `outside` and `opposite` are the outer faces of this end plate and of the other.
    """

    face: float
    inwards: int
    outside: float
    opposite: float

    def over(self, length: float, low: float, high: float) -> Polygon:
        """A rectangle over the barrel's first `length`, between two radii."""
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

    Total preload and largest total force at supply pressure [N]; preload over its loss at proof.
    """

    preload: Array
    largest: Array
    closed: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Loaded:
    """An end under load.

    `force` is the largest separating force [N]; `paths` the axial forces in the barrel wall per
    pressure [m^2] by load path; `line_stiffness` the axial E t of the wall [N/m]; `expansion` its
    axial thermal expansion [1/K], None if unknown.
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
    """Cycles to failure, and strength over stress amplitude."""

    cycles: Array
    factor: Array


Thermal = Callable[[Array, bool], Array]
"""Strength over load under temperature change [K] alone, at the coldest (True) or the hottest."""


class Fatigue(NamedTuple):
    """Pulsating stresses, assessed by metal data, and places with their own fatigue strength."""

    pulsed: tuple[Pulsed, ...] = ()
    lives: Mapping[str, Life] = {}


class WallPressures(NamedTuple):
    """Pressures at which the barrel yields and bursts at the joint, by place [Pa]."""

    yields: Mapping[str, Array] = {}
    bursts: Mapping[str, Array] = {}


@dataclass(frozen=True, slots=True)
class Strength:
    """Strength over load of an end, by place.

    `working` are elastic limits and `burst` breaking loads over the largest force; `thermal` is
    strength over load by temperature, or why it is unknown.
    """

    working: Mapping[str, Array]
    burst: Mapping[str, Array]
    thermal: Thermal | str


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Joint:
    """A joint of the barrel ends.

    Every joint must state the fields without default; if not applicable as empty, `nothing` or
    None. Data of an end count once for each end.
    """

    name: str
    help: str
    noun: str
    """Noun in messages: `a bond`, or a plural."""
    fields: tuple[JointField, ...]
    """Keys of `retention` that it uses; any other key is a fault."""
    kinds: tuple[str, ...]
    """Allowed kinds of `retention.material`; empty: no material."""
    without: Mapping[str, tuple[str, str]]
    """Specific fault and remedy of an unused key, in place of the general text."""
    faults: Callable[[StatedValues], Iterable[Fault]]
    """Faults of the values of a file."""
    material_faults: Callable[[StatedValues, KnownMaterials], Iterable[Fault]]
    """Faults that depend on the material library."""
    skirts: bool
    """Whether the caps have skirts over the outside of the barrel."""
    fit: Callable[[End], EndDimensions]
    stiffness: Callable[[End, MaterialProperties], Array] | None
    """Axial stiffness of the clamp of the barrel between both ends [N/m]; None: no clamp."""
    mass: Callable[[End, MaterialProperties], Mapping[str, Array]]
    """Mass [kg] of the joint at one end, by part: barrel, caps or fastening."""
    outline: Callable[[End, EndDimensions, EndSpan], Iterable[DrawnPart]]
    """Its parts in the half-section at one end."""
    notes: Callable[[End], Iterable[str]]
    """Sentences on details that the section does not show."""
    strength: Callable[[Loaded], Strength | str]
    """Strength of an end, or why it cannot be assessed."""
    yields: Callable[[Loaded], Mapping[str, Array]]
    """Further elastic limits over working stress, by place."""
    wall: Callable[[Loaded], WallPressures]
    """Strength of the barrel itself at the joint."""
    fatigue: Callable[[Loaded], Fatigue]
    own: Callable[[Loaded], Mapping[str, Array]]
    """Names of its own metrics: the keys of `metrics`."""
    envelope: Callable[[Loaded, Mapping[str, Array]], Mapping[str, Array]] | None
    """Upper bound of `Strength.working` from `burst` if the former is not convex; None: unused."""
    metrics: Mapping[str, str]
    """Its own metrics, with the reason why other joints lack them; all joints give the factors."""
    judged: tuple[FactorBasis, FactorBasis]
    """Basis of the working and the burst factor."""
    models: Mapping[tuple[str, str], str]
    """Main model of a metric at a place, such as `rod.section_area`."""
    usual: tuple[Usual, ...]
    warnings: Callable[[Loaded, Mapping[str, Quantity]], Iterable[tuple[str, str]]]
    """Metric and sentence for each doubt; the argument has every metric by name."""

    @property
    def plural(self) -> bool:
        """Whether the noun is plural."""
        return not self.noun.startswith(("a ", "an "))


def nothing(*_: object) -> Iterator[Any]:
    """An empty function of a joint."""
    return iter(())


def check(joints: Iterable[Joint]) -> None:
    """Refuse joints that claim the same metric, place of a model or key.

    Raises
    ------
    ValueError
        duplicate claim, with both joints
    """
    seen: dict[object, str] = {}
    for joint in joints:
        keys = [field.key for field in joint.fields if field.quantity]
        for claim in (*keys, *joint.metrics, *joint.models):
            if claim in seen:
                raise ValueError(f"joint {joint.name}: {claim} already belongs to {seen[claim]}")
            seen[claim] = joint.name


def chosen(stated: StatedValues, path: str) -> bool:
    """Whether a file lists this value among its choices."""
    return stated.has("choices", path)


def judged_later(stated: StatedValues, varied: Iterable[str]) -> bool:
    """Whether choices vary these sizes (PATHs) in every combination, as the search keeps limits."""
    paths = tuple(varied)
    free = any(stated.has("variables", path) for path in paths)
    return free and any(chosen(stated, path) for path in (*paths, "retention.type"))


def models_at(joints: Iterable[Joint], metric: str) -> dict[str, str]:
    """Main models of a metric by place, for all joints."""
    return {
        place: model
        for joint in joints
        for (name, place), model in joint.models.items()
        if name == metric
    }


def judged_on(joints: Iterable[Joint], index: int) -> str:
    """Basis of the working (0) or burst factor (1) of all joints, in words."""
    groups: dict[str, list[str]] = {}
    for joint in joints:
        judged = joint.judged[index]
        groups.setdefault(judged.measure, []).append(judged.of)
    return ", ".join(
        f"{measure} of {_alternatives(parts)}" if all(parts) else measure
        for measure, parts in groups.items()
    )


def _alternatives(parts: Sequence[str]) -> str:
    """Parts as alternatives; lists among them are separated by commas.

    >>> _alternatives(["threads", "tie rods"]), _alternatives(["threads and skirt", "tie rods"])
    ('threads or tie rods', 'threads and skirt, or of tie rods')
    """
    return (", or of " if any(" and " in part for part in parts) else " or ").join(parts)
