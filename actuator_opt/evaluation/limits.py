"""Limits of a design: its requirements, the forces of its load cases, and the check list.

The check list contains the usual professional checks of an actuator. Each check has a limit with
its source, unless only the user can set the limit. A requirement on the same metric in the same
sense replaces this limit. An entry in `waivers` removes a check; the report prints its reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from typing import Literal

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, array_of, real, where
from ..base.quantities import Sense
from ..design.material import HEAT, Material, allowable_factor, ply_constants
from ..design.model import Design, LoadCase
from ..metrics import METRICS
from ..metrics.table import CHECKS, ROWS
from .plugin import Plugin
from .values import Values


@dataclass(frozen=True, slots=True)
class MetricLimit:
    """A limit of a metric: a numeric input of the design, stated at `path`, or a constant.

    For a load case that states a joint torque and a lever arm, `path` is the PATH of the torque and
    `lever` the PATH of the arm; the limit is their ratio.
    """

    name: str
    metric: str
    sense: Sense
    path: str | None = None
    constant: float | None = None
    origin: Literal["requirement", "case", "check", "advice", "geometry"] = "requirement"
    case: str | None = None
    source: str = ""
    lever: str | None = None
    places: tuple[str, ...] | None = None
    """Locations (such as a seal or stroke position) at which the limit applies; None: all."""

    def value(self, v: Values) -> Array:
        """The limit in SI; an array if a number that defines it is varied."""
        if self.path is None:
            return self.constant
        return v[self.path] if self.lever is None else v[self.path] / v[self.lever]


ENDS = ("retracted", "extended")
OWN_PLACE = "position of the case"
"""Locations at which a joint torque is limited: the stops (`ENDS`), or, for a load case that states
its piston position or joint angle, that position (`OWN_PLACE`)."""


def requirement_limits(design: Design) -> list[MetricLimit]:
    """Limits in the design file: `requirements`, and the force or torque of every load case."""
    limits = []
    for metric, limit in design.requirements.items():
        for sense in ("min", "max"):
            if getattr(limit, sense) is not None:
                both = limit.min is not None and limit.max is not None
                name = f"{metric} ({sense})" if both else metric
                path = f"requirements.{metric}.{sense}"
                limits.append(MetricLimit(name, metric, sense, path))
    return limits + [_case_limit(case) for case in design.load_cases]


def _case_limit(case: LoadCase) -> MetricLimit:
    """Limit by the force of a load case, or by its joint torque if this acts through a linkage."""
    at = f"load_cases[{case.name}]"
    if case.through_linkage:
        at_position = case.angle is not None or case.position != "worst"
        return MetricLimit(
            name=f"torque[{case.name}]",
            metric="joint_torque_min",
            sense="min",
            path=f"{at}.joint_torque",
            origin="case",
            case=case.name,
            source="load case",
            places=(OWN_PLACE,) if at_position else ENDS,
        )
    path, lever = f"{at}.force", None
    if case.force is None:
        path, lever = f"{at}.joint_torque", f"{at}.lever_arm"
    return MetricLimit(
        name=f"force[{case.name}]",
        metric=f"{case.direction}_force",
        sense="min",
        path=path,
        origin="case",
        case=case.name,
        source="load case",
        lever=lever,
    )


def check_limits(design: Design) -> list[MetricLimit]:
    """Limits of the check list that the design neither replaces nor waives."""
    limits = []
    for metric, check in CHECKS:
        if check.limit is None or metric.name in design.waivers:
            continue
        requirement = design.requirements.get(metric.name)
        if requirement is not None and getattr(requirement, metric.worst) is not None:
            continue
        limits.append(
            MetricLimit(
                name=check.name,
                metric=metric.name,
                sense=metric.worst,
                path=f"requirements.{metric.name}.{metric.worst}",
                origin="advice" if check.advice else "check",
                source=check.source,
            )
        )
    return limits


def default_limits() -> dict[str, float]:
    """Limits of the check list by PATH, so that they can be varied like other numbers."""
    return {
        f"requirements.{metric.name}.{metric.worst}": check.limit
        for metric, check in CHECKS
        if check.limit is not None
    }


def geometry_limits() -> list[MetricLimit]:
    """Limits that keep wall thicknesses and clearances positive."""
    return [
        MetricLimit(
            name,
            name,
            "min",
            constant=row.least.value,
            origin="geometry",
            source=row.least.source,
        )
        for name, row in ROWS.items()
        if row.least is not None
    ]


def all_limits(design: Design, plugins: Iterable[Plugin] = ()) -> list[MetricLimit]:
    """All limits of a design: requirements, check list, geometry and user constraints."""
    constraints = [
        MetricLimit(plugin.name, plugin.name, plugin.sense, constant=0.0, source="user constraint")
        for plugin in plugins
        if plugin.sense is not None
    ]
    return requirement_limits(design) + constraints + check_limits(design) + geometry_limits()


def margin(value: Array, limit: Array, sense: Sense) -> Array:
    """Relative margin, ≥ 0 if the limit is met.

    It is (value − limit)/|limit| for a lower limit, with opposite sign for an upper limit (`max`).
    For a limit of zero it is the value itself, also with opposite sign for `max`.
    """
    scale = where(real(limit) == 0, 1.0 + 0 * limit, absolute(limit))
    difference = (value - limit) / scale
    return difference if sense == "min" else -difference


ALL_CASES = "all"
UNLIMITED = 1e300
"""Value that replaces infinity (a part without load), so that margins are finite."""


@dataclass(slots=True)
class MetricArrays:
    """Results of an evaluation: metric → location → array, and reasons for missing metrics.

    Values are floats or arrays (designs,), (cases, 1) or (cases, designs). A location is a ply, a
    seal, a part or a stroke position; it is "" if the metric has a single location. `applies` marks
    the load cases to which a metric applies. For a metric and location in `applies_at`, the marks
    there apply instead.
    """

    metrics: dict[str, dict[str, Array]] = field(default_factory=dict)
    why: dict[str, str] = field(default_factory=dict)
    applies: dict[str, Array] = field(default_factory=dict)
    applies_at: dict[tuple[str, str], Array] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)
    """Sentences that name the parts that a metric leaves out."""
    friction_parts: dict[str, Array] = field(default_factory=dict)
    """Running friction of each seal; the sum is `friction_running`."""

    def put(self, name: str, value: Array | dict[str, Array], cases: Array = None) -> None:
        """Record a metric: an array, or one array per location.

        `cases` marks the load cases to which the metric applies; None for all.

        Raises
        ------
        KeyError : `metrics.table` has no row with this name
        """
        if name not in METRICS:
            raise KeyError(f"metric {name}: add its row to metrics/table.py")
        self.metrics[name] = value if isinstance(value, dict) else {"": value}
        if cases is not None:
            self.applies[name] = cases

    def skip(self, name: str, why: str) -> None:
        """Record why a metric does not apply or is unknown."""
        self.why[name] = why


@dataclass(frozen=True, slots=True)
class LimitRow:
    """A limit in one load case at one location; `value`, `limit` and `margin` are (designs,)."""

    limit_of: MetricLimit
    case: str
    place: str
    value: Array
    limit: Array
    margin: Array
    case_index: int | None = None
    """Index of the load case; None if the value is the same for all load cases."""

    @property
    def label(self) -> str:
        """Name of the limit with load case and location; unique within a design."""
        where = ", ".join(p for p in (self.case if self.case != ALL_CASES else "", self.place) if p)
        return f"{self.limit_of.name} ({where})" if where else self.limit_of.name


def by_case(
    computed: MetricArrays, metric: str, array: Array, cases: tuple[str, ...], place: str = ""
) -> Iterator[tuple[str, Array]]:
    """Yield the name of each load case to which a metric applies, with its values (designs,)."""
    array = array_of(array)
    if array.ndim < 2:
        yield ALL_CASES, np.atleast_1d(array)
        return
    applies = computed.applies_at.get((metric, place), computed.applies.get(metric))
    for i, case in enumerate(cases):
        if applies is None or applies[i]:
            yield case, array[i]


def rows_of(limit: MetricLimit, computed: MetricArrays, v: Values) -> Iterator[LimitRow]:
    """Yield a row for each load case and location of a limit; no rows if its metric is missing."""
    bound = limit.value(v)
    for place, array in computed.metrics.get(limit.metric, {}).items():
        if limit.places is not None and place not in limit.places:
            continue
        for case, value in by_case(computed, limit.metric, array, v.cases, place):
            if limit.case is not None and case not in (ALL_CASES, limit.case):
                continue
            unlimited = real(value) == np.inf
            finite = where(unlimited, UNLIMITED, value)
            yield LimitRow(
                limit_of=limit,
                case=case,
                place=place,
                value=value,
                limit=bound,
                margin=margin(finite, bound, limit.sense),
                case_index=None if case == ALL_CASES else v.cases.index(case),
            )


def extremes(design: Design, numbers: Mapping[str, float]) -> tuple[float, float]:
    """Lowest and highest temperature of oil, load cases and environment [K]."""
    temperatures = [numbers["fluid.temperature"]]
    temperatures += [c.temperature for c in design.load_cases if c.temperature is not None]
    if design.environment is not None:
        temperatures += [design.environment.temperature_min, design.environment.temperature_max]
    return min(temperatures), max(temperatures)


def fixed_when_prepared(path: str) -> bool:
    """Whether `allowances` depend on the number at a PATH.

    They are computed when a design is prepared, and a later change of the number does not renew
    them.

    >>> [fixed_when_prepared(path) for path in ("fluid.temperature", "cylinder.bore")]
    [True, False]
    """
    block, _, key = path.rpartition(".")
    if block.startswith("materials."):
        return "knockdown" in key
    return key in ("temperature", "temperature_min", "temperature_max")


def allowances(
    materials: Mapping[str, Material],
    numbers: Mapping[str, float],
    *,
    temperatures: tuple[float, float],
    wet: bool,
) -> dict[tuple[str, str, bool], float]:
    """Share of every strength that remains after knock-downs.

    The knock-downs are for temperature, moisture, statistical basis of the data, and process.

    The keys are (material, property, cold); `cold` is True for the lowest and False for the highest
    of `temperatures`. `numbers` contains the material data by PATH, as changed by the design.
    """
    factors = {}
    for name, material in materials.items():
        stated = {key: numbers[f"materials.{name}.{key}"] for key in material.numbers}
        for key, entry in material.properties.items():
            if "strength" not in key:
                continue
            for cold, temperature in zip((True, False), temperatures, strict=True):
                factors[name, key, cold] = float(
                    allowable_factor(
                        stated, key, basis=entry.basis, temperature=temperature, wet=wet
                    )
                )
    return factors


class MaterialValues:
    """Materials of a design: properties, which may be arrays, and strengths after knock-downs."""

    def __init__(
        self,
        v: Values,
        materials: Mapping[str, Material],
        factors: Mapping[tuple[str, str, bool], float],
        constants: dict[str, dict[str, Array]],
    ) -> None:
        self._v = v
        self.materials = materials
        self._factors = factors
        self._constants = constants

    def material(self, name: str) -> Material:
        """Library entry of `name`."""
        return self.materials[name]

    def kind(self, name: str) -> str:
        """Kind of the material: metal, ply, polymer, adhesive, fluid or seal."""
        return self.materials[name].kind

    def names(self) -> list[str]:
        """All materials of the design."""
        return list(self.materials)

    def numbers(self, name: str) -> dict[str, Array]:
        """Stated properties of the material, SI; without those of heat flow, which `get` reads."""
        return {key: self._v[f"materials.{name}.{key}"] for key in self._mechanical(name)}

    def _mechanical(self, name: str) -> list[str]:
        return [key for key in self.materials[name].numbers if key not in HEAT]

    def ply_constants(self, name: str) -> dict[str, Array]:
        """Elastic constants and thermal expansions of a material as a ply; cached unless varied."""
        prefix = f"materials.{name}."
        if any(path.startswith(prefix) for path in self._v.varied):
            return ply_constants(self.numbers(name))
        if name not in self._constants:
            self._constants[name] = ply_constants(self.numbers(name))
        self._v.read.update(prefix + key for key in self._mechanical(name))
        return self._constants[name]

    def get(self, name: str, *properties: str, default: Array = None) -> Array:
        """The first of these properties that the material states; `default` if it has none."""
        for key in properties:
            if key in self.materials[name].numbers:
                return self._v[f"materials.{name}.{key}"]
        return default

    def allowable(self, name: str, *properties: str, cold: bool = False) -> Array:
        """A strength after all applicable knock-downs; None if not stated.

        The knock-downs are those for the highest temperature of oil, load cases and environment;
        with `cold`, for the lowest.
        """
        for key in properties:
            if key in self.materials[name].numbers:
                return self._v[f"materials.{name}.{key}"] * self._factors[name, key, cold]
        return None
