"""Results of an optimisation of an actuator."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, field, replace
from math import isfinite
from typing import Any, Literal, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError, remedy, shown
from ..base.quantities import INPUTS
from ..base.tables import Displayed, aligned
from ..design import choice_list
from ..design.model import Design
from ..evaluation.result import TABLES, Evaluation, Metric, PathValue
from ..metrics import of_metric
from ..rendering.tables import DataColumn, DataTable, coded
from . import price_table
from .price_table import Offers, Sensitivity, offers
from .problem import Robust


@dataclass(frozen=True, slots=True)
class VariableResult:
    """A free dimension at the optimum (SI); `at_bound` is ``"lower"``, ``"upper"`` or None."""

    path: str
    quantity: str
    value: float
    start: float | None
    lower: float
    upper: float
    at_bound: str | None

    def moved(self, value: float) -> VariableResult:
        """The same dimension with another value; `at_bound` is updated."""
        room = 1e-6 * max(abs(self.lower), abs(self.upper), self.upper - self.lower)
        bounds = {"lower": value - self.lower, "upper": self.upper - value}
        active_bound = next((name for name, distance in bounds.items() if distance <= room), None)
        return replace(self, value=value, at_bound=active_bound)


@dataclass(frozen=True, slots=True)
class Kkt:
    """Quality of the optimum by its Karush-Kuhn-Tucker conditions.

    `residual` is ‖∇f + Σλ∇g‖/‖∇f‖, with the objective f, the constraints g and their multipliers λ.
    `active` names the active limits, and `rank` is the rank of their gradients.
    """

    residual: float
    active: tuple[str, ...]
    rank: int
    curvature: str
    """Sign of the Hessian in the free directions, in words ("vertex", "positive definite", …)."""


@dataclass(frozen=True, slots=True)
class Infeasibility:
    """Explanation of an infeasible design: which limits conflict, and which changes are enough.

    A change is "enough" if it makes the design feasible. `joint` lists limits that are enough if
    they are all relaxed together. `sole` lists limits each of which is enough if it alone is
    relaxed. An entry of either contains requirement, origin, parameter (PATH), metric, sense,
    limit, needed (the relaxed limit that is enough; None if no change of this limit alone is
    enough), relaxation (margin given up, as a fraction of the limit), change (of the limit, a
    fraction), safety_factor (True for the check list and safety factors, whose relaxation is not
    advised) and both limits as text in the display unit. The text of `needed` is rounded towards
    the safe side, so that the printed value is enough. If the requirement is a torque at a lever,
    limit and needed are torques.

    An entry of `bounds` is a bound of a variable that is active once the limits in `joint` are
    relaxed. It contains variable, parameter (PATH), quantity, bound (side), value, gain, needed
    (the bound that is enough if it alone is moved; None if no value is enough), change and texts.
    The gain is the decrease of `total` (see below) per relative change of the bound: moving the
    bound by 1 % decreases `total` by 0.01 times the gain.

    An entry of `cures` is a single change that is enough, the most advisable first. It contains
    kind (dimension, choice, bound, number, requirement, safety factor), parameter (PATH), now and
    needed (SI, or a word), change, texts, and advised (False for safety factors). A cure of kind
    "dimension" is an input that is not a variable of the design. `together` lists dimensions, and
    bounds of variables, that are enough only if all of them change. If the change is a choice,
    `beside` lists, by PATH, the other inputs that must change at the same time. Each cure was
    confirmed by a feasible design; `objective` is the best objective found with it (SI), or None if
    it was not optimised. `untried` lists candidates that were not tried, `failed` changes that are
    not enough alone.

    `laws` lists geometrical conditions that conflict. `total` is the sum of the relaxations in
    `joint`. `sentence` is the advice in one line, and `evidence` states what is proven.
    """

    joint: tuple[Mapping[str, Any], ...]
    sole: tuple[Mapping[str, Any], ...]
    bounds: tuple[Mapping[str, Any], ...]
    laws: tuple[str, ...] = ()
    total: float | None = None
    sentence: str = ""
    evidence: str = ""
    cures: tuple[Mapping[str, Any], ...] = ()
    untried: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Certificate:
    """Largest distance of a design from the best possible design, with proof and evidence.

    The proof covers the limits in `covers`: no design that meets them has an objective below
    `lower_bound` (SI). `gap` is the distance of this design's objective from that bound, as a share
    of the objective. Without a proof both are None, and `sentence` gives the reason. `dropped`
    gives the reason for each limit that is not covered; dropping a limit can only lower the bound.
    `evidence` is not a proof but a statistic: how many starts of the search reached the same
    optimum.
    """

    sentence: str
    evidence: str
    lower_bound: float | None = None
    gap: float | None = None
    covers: tuple[str, ...] = ()
    dropped: Mapping[str, str] = field(default_factory=dict)
    boxes: int = 0

    def to_dict(self) -> dict[str, Any]:
        """The entry "certificate" in the output of `optimise --json` (SI)."""
        return asdict(self) | {"covers": list(self.covers), "dropped": dict(self.dropped)}


@dataclass(frozen=True, slots=True)
class RoundedVariable:
    """A variable before and after rounding (SI); a `discrete` variable can take only listed values.

    `plies` is the number of plies if the variable is the thickness of a layer. `sizes` is the name
    of the list or series from which the value is taken.
    """

    path: str
    quantity: str
    continuous: float
    value: float
    discrete: bool
    plies: int | None
    sizes: str | None = None


@dataclass(frozen=True, slots=True)
class RunnerUp:
    """A next best rounded design that is feasible; `values` gives its rounded variables by PATH."""

    objective: float
    cost: float
    percent: float | None
    values: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class SizeRemedy:
    """A small change of one number that makes better sizes possible.

    `change` contains parameter (PATH), limit and needed (the present and the changed number, SI),
    change (a fraction) and both numbers as text. `objective` and `values` (sizes by PATH) belong to
    a feasible design with this change.
    """

    change: Mapping[str, Any]
    sentence: str
    objective: float
    values: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Rounding:
    """The best design with whole plies, standard or other listed sizes, and what rounding costs.

    `name` is the kind of sizes ("whole plies", "sizes in steps", "standard sizes"). `cost` is the
    loss in the objective (≥ 0, in its SI unit); `percent` is this loss relative to the continuous
    optimum. Both are None, like `design` and `evaluation`, if no rounded design was feasible.
    `plies` gives the number of plies of every layer with a ply thickness. `tried` and `feasible`
    are the numbers of rounded designs tried and found feasible; `solves` is the number of re-
    optimisations. `complete` is True if the search did not stop at its time limit. The result is
    not proven to be the best, because branch and bound used local optima as bounds. `unmade` lists
    the PATHs of values that are not whole plies or allowed angles because the requested sizes leave
    them free; such a design cannot be built yet. `remedies` lists small changes of a limit, load or
    pressure that make better sizes possible; they are computed only if rounding costs much.
    """

    met: bool
    sentence: str
    remedy: str
    objective_before: float
    tried: int
    feasible: int
    solves: int
    complete: bool
    name: str = "whole plies"
    notes: tuple[str, ...] = ()
    objective_after: float | None = None
    cost: float | None = None
    percent: float | None = None
    variables: tuple[RoundedVariable, ...] = ()
    plies: Mapping[str, int] = field(default_factory=dict)
    runners_up: tuple[RunnerUp, ...] = ()
    design: Design | None = None
    evaluation: Evaluation | None = None
    unmade: tuple[str, ...] = ()
    remedies: tuple[SizeRemedy, ...] = ()

    def __str__(self) -> str:
        """Outcome, cost and the rounded variables as a table."""
        rows = [["variable", "continuous", "rounded", "plies"]]
        for v in self.variables:
            quantity = INPUTS[v.quantity]
            numbers = [quantity.text(x, 6) for x in (v.continuous, v.value)]
            rows.append([v.path, *numbers, "" if v.plies is None else str(v.plies)])
        cost = "" if self.percent is None else f"; rounding costs {self.percent:.3g} %"
        table = ["", aligned(rows, right=(1, 2, 3))] if self.variables else []
        return "\n".join([self.sentence + cost, *self.notes, *table])

    def to_dict(self) -> dict[str, Any]:
        """The entry "rounding" in the output of `optimise --json` (SI)."""
        keys = ("met", "remedy", "cost", "percent", "tried", "feasible", "solves")
        return {name: getattr(self, name) for name in keys} | {
            "sizes": self.name,
            "outcome": self.sentence,
            "complete": self.complete,
            "objective": {"continuous": self.objective_before, "rounded": self.objective_after},
            "variables": {
                v.path: {key: x for key, x in asdict(v).items() if key not in ("path", "quantity")}
                for v in self.variables
            },
            "plies": dict(self.plies),
            "runners_up": [asdict(row) for row in self.runners_up],
            "notes": list(self.notes),
            "unmade": list(self.unmade),
            "remedies": [asdict(remedy) for remedy in self.remedies],
            "evaluation": None if self.evaluation is None else self.evaluation.to_dict(),
        }


How: TypeAlias = Literal[
    "multistart", "few starts", "quick", "evaluated", "not possible", "not tried"
]
"""Method that gave the best design of a combination of choices (see `Combination`)."""


@dataclass(frozen=True, slots=True)
class Combination:
    """A combination of the choices, and its best design.

    `how` is the method that gave the design. "multistart" means a search from many starts, "few
    starts" one from up to three, and "quick" a search only from the nearest known design, which may
    miss the optimum. "evaluated" means that there are no variables, "not possible" that the values
    contradict each other, and "not tried" that the time limit was reached before. `feasible` is
    True if all requirements are met. `cost` is the difference of the objective from the best
    combination (in its SI unit), and `percent` the relative difference; both are None without a
    comparison. `rounded` is the objective with listed sizes if these were requested and if it beats
    all combinations solved before. `cost` then refers to the best rounded objective.
    """

    values: Mapping[str, choice_list.Value]
    how: How
    feasible: bool
    status: str
    objective: float | None = None
    cost: float | None = None
    percent: float | None = None
    rounded: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """The combination in JSON (SI)."""
        values = {path: choice_list.plain(value) for path, value in self.values.items()}
        return asdict(self) | {"values": values}


@dataclass(frozen=True, slots=True)
class Choices:
    """All combinations of the choices; the first is the best, and its design is the result."""

    sentence: str
    combinations: tuple[Combination, ...]
    notes: tuple[str, ...] = ()

    @property
    def best(self) -> Mapping[str, choice_list.Value]:
        """The chosen values by PATH."""
        return self.combinations[0].values

    def count(self, *how: How) -> int:
        """Number of combinations that were searched in the given ways (see `Combination`)."""
        return sum(combination.how in how for combination in self.combinations)

    @property
    def tried(self) -> int:
        """Number of combinations that were solved or evaluated."""
        return self.count("multistart", "few starts", "quick", "evaluated")

    @property
    def feasible(self) -> int:
        """Number of combinations that meet all requirements."""
        return sum(combination.feasible for combination in self.combinations)

    def to_dict(self) -> dict[str, Any]:
        """The entry "choices" in the output of `optimise --json` (SI)."""
        best, *runners_up = (combination.to_dict() for combination in self.combinations)
        return {
            "outcome": self.sentence,
            "combinations": len(self.combinations),
            "tried": self.tried,
            "feasible": self.feasible,
            "complete": self.count("not tried") == 0,
            "best": best.pop("values"),
            "found": best,
            "runners_up": runners_up,
            "notes": list(self.notes),
        }


@dataclass(frozen=True, slots=True)
class Optimisation(Displayed):
    """Result of an optimisation: best design, its quality, and the price of each requirement."""

    status: str
    sentence: str
    remedy: str
    objective_metric: str
    objective_value: float
    design: Design
    evaluation: Evaluation
    start: Evaluation
    variables: tuple[VariableResult, ...]
    kkt: Kkt | None
    sensitivities: tuple[Sensitivity, ...]
    infeasibility: Infeasibility | None
    evaluations: int
    samples: int
    starts: tuple[float | None, ...]
    """Objective that each start reached; None if its design misses a limit."""
    trace: tuple[tuple[int, float, float], ...]
    """Evaluation number, objective and worst violation at each improvement."""
    algorithm: str
    warnings: tuple[str, ...]
    seed: int
    seconds: float
    certificate: Certificate | None = None
    """If requested, how far the design is from the best possible design."""
    rounding: Rounding | None = None
    """The best design with listed sizes, if requested and if a continuous optimum exists."""
    choices: Choices | None = None
    """All combinations of the design's choices, if it has any."""
    robust: Robust | None = None
    models_run_by: str = "NumPy"
    """Engine that evaluated the models in the search: "compiled program" or "NumPy"."""

    def __getitem__(self, name: str) -> Metric | PathValue:
        """A metric or PATH of the design to build (see `Evaluation`)."""
        return self.best_evaluation[name]

    def __contains__(self, name: object) -> bool:
        """Whether the design to build has a metric or PATH of this name."""
        return name in self.best_evaluation

    def __iter__(self) -> Iterator[str]:
        """The names of all metrics."""
        return iter(self.best_evaluation)

    def _ipython_key_completions_(self) -> list[str]:
        return self.best_evaluation._ipython_key_completions_()

    @property
    def made(self) -> Rounding | None:
        """The rounding if it found a design with listed sizes (the design to build), else None."""
        return None if self.rounding is None or self.rounding.design is None else self.rounding

    @property
    def best(self) -> Design:
        """The design to build: with listed sizes if possible, else the continuous optimum."""
        return self.design if self.made is None or self.made.design is None else self.made.design

    @property
    def best_evaluation(self) -> Evaluation:
        """The evaluation of the design to build."""
        rounded = None if self.made is None else self.made.evaluation
        return self.evaluation if rounded is None else rounded

    @property
    def in_short(self) -> tuple[str, str]:
        """The objective of the design to build, the status, and the requirements that are met."""
        total = len(self.best_evaluation.requirements)
        met = sum(row.met for row in self.best_evaluation.requirements)
        status = self.status.replace("_", " ")
        return self.best_evaluation.name, f"{self.objective_text}, {status}, {met} of {total} met"

    @property
    def tight(self) -> tuple[str, ...]:
        """Limits that the design to build (see `best`) meets with almost no margin.

        Empty if the search already ensured a requested yield (share of actuators that meet all
        limits).
        """
        return () if self.robust and self.robust.reached else self.best_evaluation.tight

    @property
    def best_objective(self) -> float:
        """The objective of the design to build (SI)."""
        rounded = None if self.made is None else self.made.objective_after
        return self.objective_value if rounded is None else rounded

    @property
    def objective_text(self) -> str:
        """The objective of the design to build, with its unit; "no objective" without a value."""
        if not isfinite(self.best_objective):
            return "no objective"
        metric = self.best_evaluation.metrics.get(self.objective_metric)
        if metric is None:  # a weighted sum
            return f"objective {self.best_objective:.6g}"
        return f"{self.objective_metric} {metric.quantity.text(self.best_objective)}"

    @property
    def best_variables(self) -> tuple[VariableResult, ...]:
        """The free dimensions of the design to build."""
        rounded_values = (
            {} if self.made is None else {row.path: row.value for row in self.made.variables}
        )
        return tuple(
            v.moved(rounded_values[v.path]) if v.path in rounded_values else v
            for v in self.variables
        )

    @property
    def optimum(self) -> bool:
        """Whether the search ended at an optimum and the design to build meets all requirements."""
        return self.status == "optimal" and self.best_evaluation.met

    @property
    def shown(self) -> str:
        """Sentence on which design the outputs show; empty if no sizes were requested."""
        if self.rounding is None:
            return ""
        quantity, name = of_metric(self.objective_metric), self.rounding.name
        continuous_text, rounded_text = (
            quantity.text(x, 5) for x in (self.objective_value, self.best_objective)
        )
        if self.made is None:
            return (
                "this is the continuous optimum, which is not the design to build, because "
                f"{self.rounding.sentence}"
            )
        to_build = "the design to build" if self.rounding.met else "which misses a requirement"
        if self.rounding.met and self.rounding.unmade:
            names = ", ".join(self.rounding.unmade)
            to_build = f"which cannot be built yet, as {names} need whole plies or allowed angles"
        return (
            f"this is the design with {name} ({quantity.label} {rounded_text}), {to_build}; "
            f"prices refer to the continuous optimum ({continuous_text})"
        )

    @property
    def offers(self) -> Offers:
        """The most valuable changes of requirement, parameter and material, re-optimised."""
        maximised = self.design.objective.maximise is not None
        return offers(self.sensitivities, self.objective_value, maximised=maximised)

    @property
    def buys_most(self) -> tuple[str, ...]:
        """Sentences on the most valuable changes; empty without prices."""
        if not self.sensitivities:
            return ()
        maximised = self.design.objective.maximise is not None
        quantity = of_metric(self.objective_metric)
        return price_table.buys_most(
            self.offers, quantity, self.objective_value, maximised=maximised
        )

    def __str__(self) -> str:
        """Outcome, variables, and the evaluation of the best design, as tables."""
        rows = [["variable", "value", "lower", "upper", ""]]
        for v in self.best_variables:
            quantity = INPUTS[v.quantity]
            numbers = [quantity.text(x, 6) for x in (v.value, v.lower, v.upper)]
            rows.append([v.path, *numbers, f"at {v.at_bound} bound" if v.at_bound else ""])
        reason = "" if self.infeasibility is None else self.infeasibility.sentence
        sentences = [part for part in (self.sentence, reason, self.shown) if part]
        parts = [*sentences, "", aligned(rows, right=(1, 2, 3)), "", str(self.best_evaluation)]
        return "\n".join(parts if self.rounding is None else [*parts, "", str(self.rounding)])

    def table(self, name: str = "variables") -> DataTable:
        """A part of the optimum as a table, for arrays, CSV and data frames.

        Parameters
        ----------
        name : "variables", "prices" (objective per unit of the parameter, in `price_unit`), or a
            table of the design to build (see `Evaluation.table`)

        Raises
        ------
        UsageError : there is no table of this name
        """
        if name == "variables":
            variables = self.best_variables
            fields = ("path", "value", "lower", "upper", "start", "at_bound")
            columns = {field: [getattr(x, field) for x in variables] for field in fields}
            return DataTable.of(
                name,
                columns,
                quantities=[INPUTS[x.quantity] for x in variables],
                scaled=["value", "lower", "upper", "start"],
            )
        if name == "prices":
            return self._price_table()
        if name not in TABLES:
            names = ("variables", "prices", *TABLES)
            raise UsageError(Diagnostic(f'no table "{shown(name)}"', remedy(str(name), names)))
        return self.best_evaluation.table(name)

    def _price_table(self) -> DataTable:
        """The prices, each in the objective's unit per unit of its parameter."""
        rows, metric = self.sensitivities, self.evaluation.metrics.get(self.objective_metric)
        objective = of_metric(self.objective_metric) if metric is None else metric.quantity
        quantities = [self[row.parameter].quantity for row in rows]
        factors = (objective.to_display(1.0) - objective.to_display(0.0)) * np.array(
            [row.scale for row in rows]
        )
        columns: dict[str, list[Any] | DataColumn] = {
            key: [getattr(row, key) for row in rows]
            for key in ("parameter", "limit", "holds_until", "active")
        }
        si_units, display_units = (
            coded([_per(getattr(objective, unit), getattr(q, unit, "")) for q in quantities])
            for unit in ("si_unit", "unit")
        )
        unit_column = DataColumn("price_unit", si_units, None, display_units)
        for key in ("price", "price_up", "price_down"):
            si = np.array([getattr(row, key) for row in rows], dtype=float)
            columns[key] = DataColumn(key, si, None, si * factors)
            columns["price_unit"] = unit_column
        columns["percent_per_percent"] = [row.percent_per_percent for row in rows]
        for key in ("predicted_10", "resolved_10", "predicted_minus10", "resolved_minus10"):
            si = np.array([getattr(row, key) for row in rows], dtype=float)
            columns[key] = DataColumn(key, si, objective)
        columns["next_active"] = [row.next_active for row in rows]
        scaled = ["limit", "holds_until"]
        return DataTable.of("prices", columns, quantities=quantities, scaled=scaled)

    def columns(self) -> dict[str, list[Any]]:
        """The sensitivity table as columns (SI); `limit` is in its display `unit`."""
        names = (
            "parameter", "limit", "unit", "active", "price", "percent_per_percent",
            "predicted_10", "resolved_10", "predicted_minus10", "resolved_minus10",
            "holds_until", "next_active", "price_up", "price_down",
        )  # fmt: skip
        table = {name: [getattr(row, name) for row in self.sensitivities] for name in names}
        return table | {"limit": [row.limit / row.scale for row in self.sensitivities]}

    def to_dict(self) -> dict[str, Any]:
        """The output of `optimise --json` (SI): the keys of an evaluation and of an optimisation.

        Metrics, requirements, checks, objective and variables are those of the design to build;
        `evaluate` gives the same values for the saved file. Multipliers, prices and certificate are
        those of the continuous optimum.
        """
        evaluation, value = self.best_evaluation, self.best_objective
        data = evaluation.to_dict()
        reasons: dict[str, Any] = {}
        if self.infeasibility is not None:
            reasons = {"infeasibility": asdict(self.infeasibility)}
            if "duty" in data:  # said once, in the answer
                reasons["infeasibility"]["duty_cycles"] = data["duty"].pop("shortfalls")
        return (
            data
            | {
                "status": self.status,
                "outcome": self.sentence,
                "remedy": self.remedy,
                "shown": self._shown(),
                "warnings": [*evaluation.warnings, *self.warnings],
                "objective": {
                    "metric": self.objective_metric,
                    "value": value if isfinite(value) else None,
                },
                "variables": self._variables(),
                "kkt": None if self.kkt is None else asdict(self.kkt),
                "sensitivities": [row.to_dict(self.objective_value) for row in self.sensitivities],
                "what_buys_most": self.offers.to_dict() | {"sentence": " ".join(self.buys_most)},
                "certificate": None if self.certificate is None else self.certificate.to_dict(),
                "rounding": self._rounding(),
                "choices": None if self.choices is None else self.choices.to_dict(),
                "evaluations": self.evaluations,
                "algorithm": self.algorithm,
                "models_run_by": self.models_run_by,
                "seed": self.seed,
                "seconds": self.seconds,
            }
            | reasons
            | ({} if self.robust is None else {"robust": self.robust.to_dict()})
        )

    def _shown(self) -> dict[str, Any]:
        """Which design is shown: the continuous optimum, or the design with the requested sizes."""
        return {
            "design": "continuous" if self.made is None else "rounded",
            "sizes": None if self.rounding is None else self.rounding.name,
            "sentence": self.shown,
        }

    def _variables(self) -> dict[str, Any]:
        """By PATH, every variable's value and bounds, and which bound it has reached."""
        keys = ("value", "lower", "upper", "at_bound")
        return {v.path: {name: getattr(v, name) for name in keys} for v in self.best_variables}

    def _rounding(self) -> dict[str, Any] | None:
        """The rounding, together with the evaluation of the continuous optimum."""
        if self.rounding is None:
            return None
        return self.rounding.to_dict() | {"continuous_evaluation": self.evaluation.to_dict()}


def _per(unit: str, parameter: str) -> str:
    """Unit of a price.

    >>> _per("g", "mm"), _per("g", "kN/mm"), _per("g", ""), _per("", "mm"), _per("", "")
    ('g/mm', 'g/(kN/mm)', 'g', '1/mm', '')
    """
    if not parameter:
        return unit
    return f"{unit or 1}/{f'({parameter})' if set(parameter) & set('/*') else parameter}"
