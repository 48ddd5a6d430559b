"""The `Evaluation`: all metrics and requirements of a design, for printing and export.

It also states the reserve of a design: which limits it meets without reserve, and which share of
the actuators built to the design is expected to meet all requirements. An optimum lies exactly on
some of its limits. With nominal dimensions it meets them, but because of tolerances, many of the
actuators built to it miss a limit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, field
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from ..base import quantities
from ..base.dataclass import LONGEST_REPR, dataclass
from ..base.errors import Diagnostic, InputError, UnknownName, UsageError, remedy, shown
from ..base.numeric import Array
from ..base.tables import Displayed, aligned
from ..design.model import Design
from ..design.paths import numbers, value_at
from ..metrics import METRICS
from ..metrics.table import ROWS
from ..rendering.tables import DataColumn, DataTable, coded
from .duty_cycles.study import DutyStudy
from .dynamics_study import DynamicsStudy
from .valve_study import ValveStudy
from .wall_study import WallStudy

NO_RESERVE = 1e-3
"""Relative margin below which a limit is met without reserve. Our choice: the width of a single
tolerance, such as IT7 at 20 mm, which is 21 um or 0.1 % (ISO 286-1). An optimum that lies on a
limit has a margin below 1e-6."""
NO_ROOM = 1e-6
"""As `NO_RESERVE`, but for a limit of 0, whose margin is the value itself in SI. It equals the
tolerance within which a limit counts as met."""
MOST_NAMED = 5
"""Largest number of limits without reserve that a sentence names."""


def without_reserve(margin: float | None, limit: float | None) -> bool:
    """Whether a met limit has a margin below `NO_RESERVE`.

    >>> without_reserve(-1e-9, 4.0), without_reserve(0.02, 4.0), without_reserve(0.0005, 0.0)
    (True, False, False)
    """
    return margin is not None and margin < (NO_RESERVE if limit else NO_ROOM)


def state_of(met: bool, margin: float | None, limit: float | None) -> State:
    """State of a checked limit: missed, met, or met without reserve."""
    if not met:
        return "missed"
    return "no_reserve" if without_reserve(margin, limit) else "met"


def count_words(count: int) -> str:
    """Number of limits without reserve, in words.

    >>> count_words(1), count_words(8)
    ('1 limit without reserve', '8 limits without reserve')
    """
    return f"{count} limit{'' if count == 1 else 's'} without reserve"


@dataclass(frozen=True, slots=True)
class YieldEstimate:
    """Share of the actuators built to a design that meet every requirement.

    Parameters
    ----------
    value, lower, upper : share and its exact 95 % confidence bounds; None if not estimated
    draws : number of independent samples
    with_checks : share that also passes every check; None if the design itself misses a check
    worst, worst_fails : requirement that fails most often, and the share of samples that fail it
    why : reason why there is no estimate
    """

    value: float | None = None
    lower: float | None = None
    upper: float | None = None
    draws: int = 0
    with_checks: float | None = None
    worst: str | None = None
    worst_fails: float | None = None
    why: str = ""

    def to_dict(self) -> dict[str, Any] | None:
        """The entry `reserve.yield` in JSON; None if not estimated."""
        if self.value is None:
            return None
        worst = None
        if self.worst is not None:
            worst = {"requirement": self.worst, "fails": self.worst_fails}
        return {
            "value": self.value, "lower": self.lower, "upper": self.upper, "draws": self.draws,
            "with_checks": self.with_checks, "worst": worst,
        }  # fmt: skip

    @property
    def sentence(self) -> str:
        """The estimate in a sentence, or the reason why it is missing."""
        if self.value is None or self.lower is None or self.upper is None:
            return f"Yield not estimated ({self.why}); `actuator-opt uncertainty` estimates it."
        shown = f"{percent(self.lower)} to {percent(self.upper)} %, {self.draws} samples"
        text = (
            f"About {percent(self.value)} % of the actuators built to this design would meet "
            f"every requirement ({shown})"
        )
        if self.with_checks is not None and self.with_checks < self.value:
            text += f", and {percent(self.with_checks)} % would also pass every check"
        if self.worst is not None and self.worst_fails:
            text += f"; {self.worst} is missed most often, by {percent(self.worst_fails)} % of them"
        return f"{text}."


UNKNOWN = YieldEstimate(why="an evaluation draws no samples")
"""Yield of an evaluation without samples."""


def sentences(names: Sequence[str], estimate: YieldEstimate, *, movable: bool) -> tuple[str, ...]:
    """Sentences that name the limits without reserve, the yield, and what to do about them.

    Parameters
    ----------
    names : limits without reserve
    estimate : the yield
    movable : whether the design has variables, so that `optimise` can add reserves
    """
    lines = []
    if names:
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        named = ", ".join(names[:MOST_NAMED])
        lines.append(f"Met without reserve (margin below {100 * NO_RESERVE:g} %): {named}{more}.")
    lines.append(estimate.sentence)
    estimated = estimate.value is not None
    if movable and (names or (estimated and estimate.value != 1)):
        lines.append("`actuator-opt optimise --yield 0.99` finds a design with reserves.")
    elif estimated and estimate.value != 1:
        lines.append("`actuator-opt uncertainty` shows which inputs cause the scatter.")
    return tuple(lines)


def percent(share: float) -> str:
    """Format a share in per cent, with a decimal below 10 and above 90.

    >>> percent(0.026), percent(0.436), percent(0.9967), percent(1.0), percent(0.0)
    ('2.6', '44', '99.7', '100', '0')
    """
    value = 100 * share
    near = 0 < value < 10 or 90 < value < 100
    return f"{value:.1f}" if near else f"{value:.0f}"


State: TypeAlias = Literal["met", "no_reserve", "missed", "not_checked"]
"""State of a limit; `no_reserve`: met, but with a margin below `NO_RESERVE`."""


class Valued:
    """Base class of a named value: its text, its number, and its repr such as ``<mass 265.1 g>``.

    A format such as ``f"{mass:.3f}"``, and comparisons such as ``mass < 0.3``, take the number.

    `value` is in SI; None without a value, for the reason `why`.
    """

    __slots__ = ()
    if TYPE_CHECKING:  # attributes of the subclasses

        @property
        def name(self) -> str:
            """Name of the metric, or PATH."""

        @property
        def value(self) -> float | str | None:
            """Number in SI, or a word."""

        @property
        def why(self) -> str | None:
            """Reason of a missing value."""

        @property
        def quantity(self) -> quantities.Quantity | None:
            """Symbol, unit and label; None for a word."""

    @property
    def text(self) -> str:
        """The value with its display unit, or the reason why it is missing."""
        value, quantity = self.value, self.quantity
        if value is None:
            return f"no value: {self.why}"
        if isinstance(value, str | bool):
            return str(value)
        return f"{value:g}" if quantity is None else quantity.text(value)

    def __float__(self) -> float:
        """The value in SI; raises `InputError` if it is missing or a word."""
        value = self.value
        if value is None or isinstance(value, str | bool):
            message = f"is not a number: {self.text}" if value is not None else self.text
            raise InputError(Diagnostic(message, "read .text or .value", path=self.name))
        return value

    def __format__(self, form: str) -> str:
        """The number (SI) or the word in this format; without a format, as `str`."""
        if not form:
            return str(self)
        return format(self.value if isinstance(self.value, str) else float(self), form)

    def __lt__(self, other: object) -> bool:
        """Whether the number (SI) is less than another; raises `InputError` without a number."""
        return float(self) < float(other) if isinstance(other, Real | Valued) else NotImplemented

    def __le__(self, other: object) -> bool:
        """As `__lt__`, or equal."""
        return float(self) <= float(other) if isinstance(other, Real | Valued) else NotImplemented

    def __gt__(self, other: object) -> bool:
        """Whether the number (SI) is greater than another; raises `InputError` without a number."""
        return float(self) > float(other) if isinstance(other, Real | Valued) else NotImplemented

    def __ge__(self, other: object) -> bool:
        """As `__gt__`, or equal."""
        return float(self) >= float(other) if isinstance(other, Real | Valued) else NotImplemented

    def __repr__(self) -> str:
        """Name and text, in one line."""
        return f"<{shown(f'{self.name} {self.text}', LONGEST_REPR - 2)}>"


@dataclass(frozen=True, slots=True, repr=False)
class PathValue(Valued):
    """A value of the design at a PATH; `definition` is its quantity, None for a word.

    It has the attributes of a `Metric`; no case, place, model or reference belongs to it.
    """

    name: str
    value: float | str | None
    definition: quantities.Quantity | None = None

    case = place = None
    model = reference = ""
    in_range = True

    @property
    def why(self) -> str | None:
        """The reason of a missing value."""
        return "the design does not state it" if self.value is None else None

    @property
    def quantity(self) -> quantities.Quantity | None:
        """Symbol, unit and label; None for a word."""
        return self.definition


@dataclass(frozen=True, slots=True, repr=False)
class Metric(Valued):
    """A metric at its governing load case and location (a ply, a seal, a part).

    `value` is in SI; if it is None, `why` is the reason. `by_case` has the worst value of each load
    case, `by_place` that of each location. `sense` states whether the smallest ("min") or the
    largest ("max") value governs; None if the values of all load cases and locations are equal.
    """

    name: str
    value: float | None
    why: str | None = None
    case: str | None = None
    place: str | None = None
    by_case: Mapping[str, float] = field(default_factory=dict)
    model: str = ""
    reference: str = ""
    in_range: bool = True
    definition: quantities.Quantity | None = None
    """Quantity of a user metric; None for built-in metrics."""
    sense: quantities.Sense | None = None
    by_place: Mapping[str, float] = field(default_factory=dict)

    @property
    def quantity(self) -> quantities.Quantity:
        """Symbol, unit and label."""
        return self.definition or METRICS[self.name]


@dataclass(frozen=True, slots=True)
class Requirement:
    """A limit with its value and margin (value − limit)/|limit|, with opposite sign for `max`."""

    name: str
    metric: str
    sense: Literal["min", "max"]
    limit: float
    value: float | None
    margin: float | None
    met: bool
    case: str | None = None
    place: str | None = None
    path: str = ""
    """PATH of the limit in the design (``requirements.stiffness_min.min``)."""

    @property
    def state(self) -> State:
        """Whether the requirement is met, and with a reserve (a margin of `NO_RESERVE`)."""
        return state_of(self.met, self.margin, self.limit)


@dataclass(frozen=True, slots=True)
class Check:
    """A line of the check list: met, missed, or not checked for a stated reason."""

    name: str
    status: Literal["met", "missed", "not_checked"]
    reason: str = ""
    metric: str | None = None
    sense: Literal["min", "max"] | None = None
    limit: float | None = None
    value: float | None = None
    margin: float | None = None
    case: str | None = None
    place: str | None = None
    source: str = ""
    """Source of the limit (a standard, a paper, or a choice)."""

    @property
    def state(self) -> State:
        """Status of the check; if met, whether with a reserve (a margin of `NO_RESERVE`)."""
        if self.status != "met":
            return self.status
        return state_of(True, self.margin, self.limit)

    @property
    def advice(self) -> bool:
        """Whether the limit is advice, which does not bind the optimiser (`CheckLine.advice`)."""
        row = ROWS.get(self.metric or "")
        return row is not None and row.check is not None and row.check.advice


@dataclass(frozen=True, slots=True)
class ModelUse:
    """A model that was used: source of its equation, valid range, and the metrics from it."""

    name: str
    equation: str
    reference: str
    valid_range: str
    used_at: str
    in_range: bool


@dataclass(frozen=True, slots=True)
class Unverified:
    """A library value used by the design that nobody has checked against its primary source."""

    material: str
    property: str
    value: str
    source: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class StrokeCurve:
    """Stiffness along the stroke in the governing load case.

    `position` is measured from the cap end [m]; the other arrays have a value for each position.
    `stiffness` is the total [N/m]. `contributions` are the compliances of the parts [m/N], such as
    oil, barrel, lines, rod and mount, whose sum is 1/stiffness.
    """

    case: str
    position: Array
    stiffness: Array
    contributions: Mapping[str, Array]

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON; compliances in m/N."""
        return {
            "case": self.case,
            "position": self.position.tolist(),
            "stiffness": self.stiffness.tolist(),
            "compliance": {name: c.tolist() for name, c in self.contributions.items()},
        }


@dataclass(frozen=True, slots=True)
class Outline:
    """Half-section of a part of the retracted actuator.

    The polygons are closed; their points are (axial position, radius) [m].
    """

    part: str
    material: str
    polygons: tuple[tuple[tuple[float, float], ...], ...]
    kind: Literal["metal", "composite", "polymer", "seal", "oil"]
    bars: int = 0
    """Number of round bars around the axis, such as tie rods; 0 for a turned part."""
    radial: bool = False
    """Whether the bars are radial, such as pins or ports, not parallel to the axis."""

    @property
    def sides(self) -> tuple[int, ...]:
        """Sides of the axis that show the part: 1 above, -1 below.

        The first bar is above the axis. If the number of bars is odd, none lies opposite.
        """
        return (1,) if self.bars % 2 else (1, -1)


_FATIGUE = ("fatigue_factor", "cycle_life")
"""Metrics whose requirement states how long the metal parts must last."""


@dataclass(frozen=True, slots=True)
class Evaluation(Displayed):
    """Complete results of a design: metrics, requirements, checks, drawing, and sources."""

    name: str
    version: str
    spec_hash: str
    design: Design
    metrics: Mapping[str, Metric]
    requirements: tuple[Requirement, ...]
    checks: tuple[Check, ...]
    warnings: tuple[str, ...]
    unverified: tuple[Unverified, ...]
    models: tuple[ModelUse, ...]
    mass_parts: Mapping[str, float]
    """Dry mass per part [kg] in assembly order; the sum is `mass`. Oil: `metrics["mass_oil"]`."""
    mass_leaves_out: tuple[str, ...]
    """Components that `mass` leaves out: no model weighs them, and the design states no mass."""
    curve: StrokeCurve
    outlines: tuple[Outline, ...]
    lengths: Mapping[str, float]
    """Dimensions for the drawing (m): bore, rod, barrel outer diameter, stroke, closed length…"""
    lines: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Lines of the drawing that bound no part, such as threads: (axial position, radius) [m]."""
    wall: WallStudy | None = None
    """Stresses through the thickness of the barrel; None with the wall model `as_published`."""
    dynamics: DynamicsStudy | None = None
    """Modes along the stroke, dynamic stiffness over frequency, and the position loop."""
    valve: ValveStudy | None = None
    """Curves of the valve about its null; None unless the design states the spool."""
    duty: DutyStudy | None = None
    """Duty cycles over time; None without the block `duty`."""
    friction_parts: Mapping[str, float] = field(default_factory=dict)
    """Running friction [N] of each seal in the governing case; wipers and guides are one entry."""
    yield_estimate: YieldEstimate = UNKNOWN
    """Share of the actuators built to the design that meet every requirement, if estimated."""

    def __getitem__(self, name: str) -> Metric | PathValue:
        """A metric by its name, or a value of the design by its PATH.

        Raises
        ------
        UnknownName
            a `KeyError` that suggests a similar name
        """
        metric = self.metrics.get(name) if isinstance(name, str) else None
        if metric is not None:
            return metric
        allowed = {metric.name: metric.quantity for metric in self.metrics.values()}
        message, help = f'no metric or PATH "{shown(name)}"', ""
        try:
            target, value = value_at(str(name), self.design, allowed)
        except InputError as error:
            help = error.diagnostics[0].remedy
        else:
            return PathValue(target.path, value, target.quantity)
        if str(name).isidentifier():
            help = remedy(str(name), allowed | dict.fromkeys(numbers(self.design), ""))
        raise UnknownName(Diagnostic(message, help))

    def __contains__(self, name: object) -> bool:
        """Whether there is a metric or PATH of this name."""
        try:
            self[name]  # type: ignore[index]
        except InputError:
            return False
        return True

    def __iter__(self) -> Iterator[str]:
        """The names of all metrics."""
        return iter(self.metrics)

    def _ipython_key_completions_(self) -> list[str]:
        """Names that a notebook offers after ``evaluation["``."""
        return [*self.metrics, *numbers(self.design)]

    @property
    def met(self) -> bool:
        """Whether every requirement is met."""
        return all(row.met for row in self.requirements)

    @property
    def tight(self) -> tuple[str, ...]:
        """Names of the limits that are met without reserve: first requirements, then checks."""
        required = {(row.metric, row.sense, row.limit) for row in self.requirements}
        names = [row.name for row in self.requirements if row.state == "no_reserve"]
        names += [
            check.name
            for check in self.checks
            if check.state == "no_reserve"
            and (check.metric, check.sense, check.limit) not in required
        ]
        return tuple(dict.fromkeys(names))

    @property
    def extrapolated(self) -> tuple[str, ...]:
        """Metrics that depend on a model outside its valid range."""
        return tuple(
            m.name for m in self.metrics.values() if m.value is not None and not m.in_range
        )

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of unverified library values, and of extrapolated metrics and models."""
        return {
            "unverified": len(self.unverified),
            "extrapolated": len(self.extrapolated),
            "extrapolated_models": sum(not model.in_range for model in self.models),
        }

    @property
    def below_one(self) -> dict[str, float]:
        """Factors below 1, of strength by load, for which neither file nor check has a limit.

        The fatigue factor is left out: it is that of endless life (see `limited_life`).
        """
        factors = {}
        for check in self.checks:
            name = check.metric or ""
            metric = self.metrics.get(name)
            if check.limit is not None or metric is None or metric.value is None:
                continue
            waived = name in self.design.waivers
            if waived or not name.endswith("_factor") or name == "fatigue_factor":
                continue
            if metric.quantity.worst == "min" and metric.value < 1:
                factors[name] = metric.value
        return factors

    @property
    def limited_life(self) -> float | None:
        """Pressure cycles that the metal parts last, if their life is limited.

        The check list asks for some cycles in any case. None if the fatigue strength bears endless
        cycles, if a requirement limits fatigue or life, or if duty cycles state the life.
        """
        factor, life = (self.metrics.get(name) for name in _FATIGUE)
        if factor is None or factor.value is None or factor.value >= 1 or life is None:
            return None
        asked = any(row.metric in _FATIGUE for row in self.requirements)
        checked = {check.metric: check.status for check in self.checks}
        missed = checked.get("cycle_life") != "met"
        stated = checked.get("duty_fatigue", "not_checked") != "not_checked"
        return None if asked or missed or stated else life.value

    @property
    def reserve_sentences(self) -> tuple[str, ...]:
        """Sentences on limits without reserve and the yield; empty if a requirement is missed."""
        if not self.met or not self.requirements:
            return ()
        movable = bool(self.design.variables)
        return sentences(self.tight, self.yield_estimate, movable=movable)

    @property
    def in_short(self) -> tuple[str, str]:
        """Mass, and the number of requirements that are met."""
        mass = self.metrics.get("mass")
        first = "" if mass is None else f"mass {mass.text}, "
        return self.name, f"{first}{self.tally}"

    @property
    def tally(self) -> str:
        """Sentence: number of requirements met and, if all are met, missed checks and advice."""
        total, met = len(self.requirements), sum(row.met for row in self.requirements)
        words = f"{met} of {total} requirements met"
        if met < total:
            return words
        missed = [check for check in self.checks if check.status == "missed"]
        for head, advice in (("checks missed", False), ("advice not followed", True)):
            if names := [check.name for check in missed if check.advice is advice]:
                more = f" and {len(names) - 1} more" if len(names) > 1 else ""
                words += f"; {head}: {names[0]}{more}"
        return words

    def __str__(self) -> str:
        """Requirements and metrics as a table."""
        rows = [["requirement", "limit", "value", "margin", "", "case"]]
        for r in self.requirements:
            quantity = self.metrics[r.metric].quantity
            sign = "≥" if r.sense == "min" else "≤"
            rows.append(
                [
                    r.name,
                    f"{sign} {quantity.text(r.limit)}",
                    "-" if r.value is None else quantity.text(r.value),
                    "-" if r.margin is None else f"{100 * r.margin:+.1f} %",
                    r.state.replace("_", " "),
                    r.case or "",
                ]
            )
        values = [["metric", "value", "case"]]
        for m in self.metrics.values():
            shown = m.why or "" if m.value is None else m.quantity.text(m.value)
            values.append([m.name, shown, m.case or ""])
        missed = [f"check missed: {c.name}" for c in self.checks if c.status == "missed"]
        head = [self.name, self.tally, *self.reserve_sentences, ""]
        return "\n".join([*head, aligned(rows, right=(1, 2, 3)), "", aligned(values), *missed])

    def to_dict(self) -> dict[str, Any]:
        """The object that `evaluate --json` writes (SI)."""
        return {
            "name": self.name,
            "version": self.version,
            "spec_hash": self.spec_hash,
            "metrics": {
                m.name: {
                    "value": m.value,
                    "unit": m.quantity.si_unit,
                    "label": m.quantity.label,
                    "model": m.model,
                    "reference": m.reference,
                    "in_range": m.in_range,
                    "case": m.case,
                    "place": m.place,
                    **({"by_place": dict(m.by_place)} if len(m.by_place) > 1 else {}),
                }
                | ({"why": m.why} if m.value is None else {})
                for m in self.metrics.values()
            },
            "checks": [asdict(check) for check in self.checks],
            "requirements": [asdict(row) for row in self.requirements],
            "reserve": {
                "without": list(self.tight),
                "below": NO_RESERVE,
                "yield": self.yield_estimate.to_dict(),
                "why": self.yield_estimate.why,
            },
            "counts": self.counts,
            "mass_parts": dict(self.mass_parts),
            "mass_leaves_out": list(self.mass_leaves_out),
            "warnings": list(self.warnings),
            "unverified": [asdict(value) for value in self.unverified],
            "wall": None if self.wall is None else self.wall.to_dict(),
            "stiffness_budget": self.curve.to_dict(),
            "dynamics": None if self.dynamics is None else self.dynamics.to_dict(),
            **({} if self.valve is None else {"valve": self.valve.to_dict()}),
            **({} if self.duty is None else {"duty": self.duty.to_dict()}),
        }

    def table(self, name: str = "metrics") -> DataTable:
        """A part of the evaluation as a table, for arrays, CSV and data frames.

        Parameters
        ----------
        name : "metrics", "requirements", "checks", "masses" or "models"

        Raises
        ------
        UsageError : there is no table of this name
        """
        if name not in _TABLES:
            raise UsageError(Diagnostic(f'no table "{shown(name)}"', remedy(str(name), _TABLES)))
        return _TABLES[name](self)

    def columns(self) -> dict[str, list[Any]]:
        """Metrics as columns (name, value, unit, case), in display units."""
        rows = list(self.metrics.values())
        return {
            "name": [m.name for m in rows],
            "value": [None if m.value is None else m.quantity.to_display(m.value) for m in rows],
            "unit": [m.quantity.unit for m in rows],
            "case": [m.case for m in rows],
        }


# ---- tables ----


def _rows(name: str, rows: Sequence[Any], fields: Sequence[str], **more: Any) -> DataTable:
    """A table of some attributes of objects."""
    columns = {field: [getattr(row, field) for row in rows] for field in fields}
    return DataTable.of(name, columns, **more)


def _metrics_table(evaluation: Evaluation) -> DataTable:
    metrics = [*evaluation.metrics.values()]
    fields = ["name", "value", "case", "place", "in_range", "why", "model", "reference"]
    quantities = [metric.quantity for metric in metrics]
    return _rows("metrics", metrics, fields, quantities=quantities, scaled=["value"])


def _limits_table(evaluation: Evaluation, name: str, fields: Sequence[str]) -> DataTable:
    rows = getattr(evaluation, name)
    quantities = [None if x.metric is None else evaluation.metrics[x.metric].quantity for x in rows]
    return _rows(name, rows, fields, quantities=quantities, scaled=["value", "limit"])


def _requirements_table(evaluation: Evaluation) -> DataTable:
    fields = ["name", "metric", "sense", "value", "limit", "margin", "met", "state", "case"]
    return _limits_table(evaluation, "requirements", [*fields, "place", "path"])


def _checks_table(evaluation: Evaluation) -> DataTable:
    fields = ["name", "state", "metric", "sense", "value", "limit", "margin", "reason", "case"]
    return _limits_table(evaluation, "checks", [*fields, "place", "source"])


def _masses_table(evaluation: Evaluation) -> DataTable:
    parts = evaluation.mass_parts
    masses = DataColumn("mass", np.array([*parts.values()], dtype=float), METRICS["mass"])
    return DataTable("masses", [DataColumn("part", coded([*parts])), masses])


def _models_table(evaluation: Evaluation) -> DataTable:
    fields = ["name", "equation", "reference", "valid_range", "used_at", "in_range"]
    return _rows("models", evaluation.models, fields)


_TABLES: dict[str, Callable[[Evaluation], DataTable]] = {
    "metrics": _metrics_table,
    "requirements": _requirements_table,
    "checks": _checks_table,
    "masses": _masses_table,
    "models": _models_table,
}
"""The tables of an evaluation by name."""
TABLES = tuple(_TABLES)
