"""What a joint of the barrel's ends is: every piece that the rest of the program asks for.

Lengths in m, forces in N, stresses in Pa; numbers are floats or arrays (designs,).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol, TypeAlias

from ..base.errors import Fault
from ..base.numeric import Array
from ..base.quantities import Quantity

LEAST_METAL = 1e-3
"""Least wall beside or under a groove or thread, least rod wall, bore of a laminated rod and room
between rod and bore (m): a choice for turned parts in this size range."""

NOT_BONDED = "the caps are not bonded"

ROUNDING = 1e-5
"""Relative room for an optimum that stands on the limit."""


class JointSizes(Protocol):
    """Numbers of the joint by key, such as `thread.pitch`, in SI."""

    def __contains__(self, key: object) -> bool: ...

    def __getitem__(self, key: str) -> Array: ...

    def get(self, key: str, default: Array) -> Array:
        """The number of a key, or `default` where the design does not state it."""
        ...


class Materials(Protocol):
    """Numbers of materials by name, in SI."""

    def kind(self, name: str) -> str:
        """Kind of a material: metal, ply, polymer, adhesive."""
        ...

    def get(self, name: str, *properties: str, default: Array = None) -> Array:
        """The first stated of some properties; `default` where none is."""
        ...

    def allowable(self, name: str, *properties: str, cold: bool = False) -> Array:
        """A strength after its knock-downs, hottest or coldest; None where none is stated."""
        ...


class Stated(Protocol):
    """A design file as the faults read it: values by place, None where unusable."""

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


class Known(Protocol):
    """What is known of the materials that a design file names."""

    def kind(self, name: str) -> str | None:
        """Kind of a material; None where there is none of this name."""
        ...

    def properties(self, name: str) -> Iterable[str]:
        """Names of its stated properties; none where they cannot be read."""
        ...


class JointField(NamedTuple):
    """A key of `retention` that a joint uses.

    `missing` and `remedy` are said where a file leaves out a key that the joint needs; both empty:
    it may. A key that no other joint has states its `quantity` and `help`.
    """

    key: str
    missing: str = ""
    remedy: str = ""
    quantity: str = ""
    help: str = ""


class Judged(NamedTuple):
    """What a safety factor is on: the `measure`, and `of` which parts."""

    measure: str
    of: str = ""


class Usual(NamedTuple):
    """A ratio that stays within a range in sensible designs; `path` is the value to look at."""

    path: str
    what: str
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
    """An end of the barrel and what is joined there.

    `material` is the one named beside the joint, `cap` the cap's; `layers` are those of the barrel,
    from the bore outwards.
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
    known: dict[str, Any] = field(default_factory=dict, init=False, compare=False, repr=False)
    """Results that a joint derives from these numbers and uses again, by a word of its own."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """Dimensions that the joint gives cap and barrel; the drawing knows these alone.

    A skirt has an inner `radius`, to which the barrel is turned down where its outside is larger,
    `length` and `wall`. `own` are further dimensions that the joint's outline needs.
    """

    plate_radius: Array
    radius: Array
    length: Array = 0.0
    wall: Array = 0.0
    own: tuple[Array, ...] = ()


class Span(NamedTuple):
    """Where an end lies in the drawing [m]: the barrel's face, the way into the barrel (1 or -1).

    `outside` and `opposite` are the outer faces of this plate and of the other end's.
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


class Drawn(NamedTuple):
    """A piece of the half-section; `bars` counts round bars about the axis, 0 is a turned part."""

    part: str
    material: str
    shape: Polygon
    bars: int = 0


@dataclass(frozen=True, slots=True)
class Clamp:
    """What clamps the barrel between both ends, such as tie rods.

    Preload and largest force of all at supply pressure [N]; preload over its loss at proof.
    """

    preload: Array
    largest: Array
    closed: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Loaded:
    """An end under load.

    `force` is the largest that tears it off [N], `paths` the axial forces in the barrel's wall per
    pressure [m^2] by load path; `line_stiffness` is E t of the wall along its axis [N/m],
    `expansion` its thermal expansion there [1/K], None where not known.
    """

    end: End
    materials: Materials
    force: Array
    paths: Mapping[str, Array]
    line_stiffness: Array
    expansion: Array | None
    clamp: Clamp | None


class Pulsed(NamedTuple):
    """Stress of a metal while the pressure comes and goes: range and mean [Pa]."""

    place: str
    material: str
    span: Array
    mean: Array


class Life(NamedTuple):
    """Cycles to failure, and strength over the stress amplitude."""

    cycles: Array
    factor: Array


Thermal = Callable[[Array, bool], Array]
"""Strength over load by a warming [K] alone, at the coldest (True) or the hottest."""


class Fatigue(NamedTuple):
    """What pulsates, judged by the metals' own data, and places with an endurance of their own."""

    pulsed: tuple[Pulsed, ...] = ()
    lives: Mapping[str, Life] = {}


class WallPressures(NamedTuple):
    """Pressures at which the barrel yields and bursts beside the joint, by place [Pa]."""

    yields: Mapping[str, Array] = {}
    bursts: Mapping[str, Array] = {}


@dataclass(frozen=True, slots=True)
class Strength:
    """Strength over load of an end, by place.

    `working` are elastic limits and `burst` breaking loads over the largest force, `thermal` is
    strength over load by temperature, or why there is none.
    """

    working: Mapping[str, Array]
    burst: Mapping[str, Array]
    thermal: Thermal | str


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Joint:
    """A joint of the barrel's ends.

    A field without default is a piece that every joint must give; what it does not have it gives
    as empty, `nothing` or None. Pieces of one end count once for each end.
    """

    name: str
    help: str
    noun: str
    """As messages name it: `a bond`, or a plural."""
    fields: tuple[JointField, ...]
    """Keys of `retention` that it uses; every other one is a fault."""
    kinds: tuple[str, ...]
    """Kinds of material that `retention.material` may be; empty: it has none."""
    without: Mapping[str, tuple[str, str]]
    """Fault and remedy of a key that it does not use, where the usual words say too little."""
    faults: Callable[[Stated], Iterable[Fault]]
    """Of the values of a file."""
    material_faults: Callable[[Stated, Known], Iterable[Fault]]
    """That show when the library is asked."""
    skirts: bool
    """Whether the caps have skirts over the barrel's outside."""
    fit: Callable[[End], Fit]
    stiffness: Callable[[End, Materials], Array] | None
    """Axial stiffness of what clamps the barrel between both ends [N/m]; None: nothing does."""
    mass: Callable[[End, Materials], Mapping[str, Array]]
    """Mass [kg] of one end's joint, by the part that it belongs to: barrel, caps or fastening."""
    outline: Callable[[End, Fit, Span], Iterable[Drawn]]
    """What it adds to the half-section at one end."""
    notes: Callable[[End], Iterable[str]]
    """Sentences on what the section does not show."""
    strength: Callable[[Loaded], Strength | str]
    """Or why it cannot be judged."""
    yields: Callable[[Loaded], Mapping[str, Array]]
    """Further elastic limits over working stress, by place."""
    wall: Callable[[Loaded], WallPressures]
    """What the barrel itself bears beside the joint."""
    fatigue: Callable[[Loaded], Fatigue]
    own: Callable[[Loaded], Mapping[str, Array]]
    """Its own metrics by name: the keys of `metrics`."""
    envelope: Callable[[Loaded, Mapping[str, Array]], Mapping[str, Array]] | None
    """`Strength.working` from above, from `burst`, where itself is not convex; None: not needed."""
    metrics: Mapping[str, str]
    """Its own metrics, with the reason why other joints have none; all give the factors."""
    judged: tuple[Judged, Judged]
    """What the working and the burst factor are on."""
    models: Mapping[tuple[str, str], str]
    """Leading model behind a metric at a place, such as `rod.section_area`."""
    usual: tuple[Usual, ...]
    warnings: Callable[[Loaded, Mapping[str, Quantity]], Iterable[tuple[str, str]]]
    """Metric and sentence for what is doubtful; given every metric by name."""

    @property
    def plural(self) -> bool:
        """Whether the noun is one."""
        return not self.noun.startswith(("a ", "an "))


def nothing(*_: object) -> Iterator[Any]:
    """A piece that a joint does not have."""
    return iter(())


def check(joints: Iterable[Joint]) -> None:
    """Refuse joints of which two claim one metric, place of a model or key.

    Raises
    ------
    ValueError
        what is claimed twice, and by which joint
    """
    seen: dict[object, str] = {}
    for joint in joints:
        own = [field.key for field in joint.fields if field.quantity]
        for claim in (*own, *joint.metrics, *joint.models):
            if claim in seen:
                raise ValueError(f"joint {joint.name}: {claim} is of {seen[claim]} already")
            seen[claim] = joint.name


def chosen(stated: Stated, path: str) -> bool:
    """Whether a file lists a value among its choices."""
    return stated.has("choices", path)


def judged_later(stated: Stated, moved: Iterable[str]) -> bool:
    """Whether these sizes (PATHs) move in every combination of choices: the search keeps limits."""
    paths = tuple(moved)
    free = any(stated.has("variables", path) for path in paths)
    return free and any(chosen(stated, path) for path in (*paths, "retention.type"))


def models_at(joints: Iterable[Joint], metric: str) -> dict[str, str]:
    """Leading models of a metric by place, of all joints."""
    return {
        place: model
        for joint in joints
        for (name, place), model in joint.models.items()
        if name == metric
    }


def judged_on(joints: Iterable[Joint], index: int) -> str:
    """What the working (0) or burst factor (1) of all joints is on, in words."""
    groups: dict[str, list[str]] = {}
    for joint in joints:
        judged = joint.judged[index]
        groups.setdefault(judged.measure, []).append(judged.of)
    return ", ".join(
        f"{measure} of {_alternatives(parts)}" if all(parts) else measure
        for measure, parts in groups.items()
    )


def _alternatives(parts: Sequence[str]) -> str:
    """Parts as alternatives; lists among them are kept apart.

    >>> _alternatives(["threads", "tie rods"]), _alternatives(["threads and skirt", "tie rods"])
    ('threads or tie rods', 'threads and skirt, or of tie rods')
    """
    return (", or of " if any(" and " in part for part in parts) else " or ").join(parts)
