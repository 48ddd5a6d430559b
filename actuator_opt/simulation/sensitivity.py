"""Sensitivity of a scenario's results to its parameters: central differences, ranked by effect.

The controller keeps its gains, unless the changed parameter belongs to the block `control`. An
effect refers to a change of 1 % in the parameter, or of 1 K in a temperature. Each difference is
computed again with half the step. If the two disagree, numerical noise or a jump dominates, and the
effect is marked as not reliable.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from time import perf_counter
from typing import Any, Literal, TypeAlias

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, Unsolvable, remedy
from ..base.progress import steps
from ..base.quantities import RESULTS, Quantity
from ..base.tables import Displayed
from ..design import paths
from ..design.build import with_values
from ..design.ideal import has_effect
from ..design.kinds import Fraction, ValueFault
from ..design.scenario.kinds import Records
from ..design.scenario.model import Scenario
from ..design.structure import Loc, child, child_at, leaves, number_of
from ..design.valve import Valve
from ..evaluation.build import prepare
from ..evaluation.kernel import PreparedDesign
from ..studies.plant import plant
from .linear import Tuned, tune
from .result import Simulation
from .run import run

STEP = 0.02
"""Relative step of a parameter (our choice: its effect is well above the error of a simulation)."""
AGREE = 0.1
"""Relative difference up to which the effects computed with the full and with half the step count
as equal."""
NOTHING = 0.05
"""Change of a result, in per cent per 1 % of a parameter, that counts as zero (our choice)."""
DESIGN = (
    "fluid.air_content", "fluid.temperature", "supply.pressure", "supply.return_pressure",
    "cylinder.bore", "rod.outer_diameter", "cylinder.dead_volume_a", "cylinder.dead_volume_b",
    "piston.leakage_conductance", "seals.piston.friction_coefficient",
    "seals.rod.friction_coefficient", "stiffness.seal_deflection", "valve.rated_flow",
    "valve.leakage_flow", "valve.natural_frequency", "valve.frequency_90deg",
    "valve.frequency_3db", "valve.damping_ratio", "valve.slew_rate", "control.gain",
    "load.mass", "load.inertia", "ideal.area_a", "ideal.area_b", "ideal.mass",
    "ideal.dead_volume_a", "ideal.dead_volume_b", "ideal.stiffness", "ideal.leakage",
)  # fmt: skip
"""PATHs of the design values that are varied by default."""
LEAST = {"hold_drift": 1e-7, "overshoot": 1e-5, "steady_state_ratio": 1e-5, "following_error": 1e-7}
"""Values of some results below which they count as rounding error [SI] (our choice)."""
_TIMES = ("start", "end", "phase", "frequency")
_APART = ("duration", "sample_time", "requirements", "analysis", "set", "unset")


@dataclass(frozen=True, slots=True)
class Effect:
    """Effect of a 1 % change of a parameter (1 K for a temperature)."""

    percent: float | None
    """Change of the result in per cent of its value; None if the result is zero."""
    change: float
    """Change of the result [SI]."""
    reliable: bool
    """Whether the effect with half the step agrees within 10 %, or both steps have no effect."""


@dataclass(frozen=True, slots=True)
class ParameterEffects:
    """A parameter with its effects on all results."""

    path: str
    origin: Literal["design", "scenario"]
    quantity: Quantity
    value: float
    unit: Literal["1 %", "1 K"]
    effects: Mapping[str, Effect]
    """Effects by name of the result."""

    @property
    def largest(self) -> float:
        """Largest reliable effect on any result [%]."""
        reliable = [
            effect
            for effect in self.effects.values()
            if effect.percent is not None and effect.reliable
        ]
        return max((abs(effect.percent or 0.0) for effect in reliable), default=0.0)


@dataclass(frozen=True, slots=True)
class Sensitivities(Displayed):
    """Effects of all parameters, the parameter with the largest effect first."""

    name: str
    results: Mapping[str, float]
    """Results of the unchanged scenario, by name."""
    parameters: tuple[ParameterEffects, ...]
    skipped: Mapping[str, str]
    """Parameters whose simulation failed, with the reason."""
    step: float
    runs: int
    seconds: float

    @property
    def in_short(self) -> tuple[str, str]:
        """The parameter with the largest effect."""
        first = f", the largest is {self.parameters[0].path}" if self.parameters else ""
        return self.name, f"effects of {len(self.parameters)} parameters{first}"

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return {
            "name": self.name,
            "results": dict(self.results),
            "parameters": [
                {
                    "path": parameter.path,
                    "origin": parameter.origin,
                    "value": parameter.value,
                    "unit": parameter.quantity.si_unit,
                    "per": parameter.unit,
                    "largest": parameter.largest,
                    "effects": {
                        name: {
                            "percent": effect.percent,
                            "change": effect.change,
                            "reliable": effect.reliable,
                        }
                        for name, effect in parameter.effects.items()
                    },
                }
                for parameter in self.parameters
            ],
            "skipped": dict(self.skipped),
            "step": self.step,
            "runs": self.runs,
            "seconds": self.seconds,
        }


def sensitivities(
    scenario: Scenario,
    subject: PreparedDesign,
    names: Sequence[str] | None = None,
    *,
    step: float = STEP,
    results: Sequence[str] | None = None,
    records: Records | None = None,
) -> Sensitivities:
    """Effects of parameters on the results of a scenario.

    Parameters
    ----------
    scenario, subject : inputs over time, and the design
    names : PATHs of the parameters, in design or scenario; default: those of `DESIGN`, and all
        numbers that the scenario states
    step : relative step of a parameter
    results : names of `quantities.RESULTS`; default: all results of the scenario
    records : columns of the files that the scenario's signals name

    Raises
    ------
    InputError
        a PATH that is not a number, an unknown result, or a step that is not positive
    Unsolvable
        the simulation of the unchanged scenario fails
    """
    begin = perf_counter()
    if not 0 < step < 0.5:
        message = f"relative step {step:g} of a parameter"
        raise InputError(Diagnostic(message, "give a share between 0 and 0.5, such as 0.02"))
    bench = _Bench.of(scenario, subject, {} if records is None else records)
    base = bench.base()
    reference = _results(base, results)
    ranked: list[ParameterEffects] = []
    skipped: dict[str, str] = {}
    for target in steps("varying each parameter", [*bench.targets(names)]):
        if target.value == 0:
            skipped[target.path] = "its value is 0, so a relative step does not change it"
            continue
        try:
            ranked.append(bench.parameter(target, reference, step))
        except (InputError, Unsolvable) as error:
            skipped[target.path] = str(error)
    ranked.sort(key=lambda target: -target.largest)
    return Sensitivities(
        scenario.name,
        reference,
        tuple(ranked),
        skipped,
        step,
        bench.runs,
        perf_counter() - begin,
    )


def _results(base: Simulation, requested: Sequence[str] | None) -> dict[str, float]:
    """The requested results, as far as they have a value."""
    for name in requested or ():
        if name not in RESULTS:
            raise InputError(Diagnostic(f"{name}: no such result", remedy(name, RESULTS)))
    names = RESULTS if requested is None else requested
    values = {name: base.values.get(name) for name in names}
    return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True, slots=True)
class _Target:
    """A number of the design or of the scenario that is varied."""

    path: str
    loc: Loc
    quantity: Quantity
    value: float
    origin: Literal["design", "scenario"]

    @property
    def amount(self) -> float:
        """Change to which effects refer: 1 % of the value, or 1 K for a temperature."""
        return 1.0 if _absolute(self.quantity) else 0.01 * abs(self.value)


_Slope: TypeAlias = tuple[float | None, float]
"""Change of a result for a change of a parameter by 1 % or 1 K: in per cent of the result, and in
SI."""


@dataclass(slots=True)
class _Bench:
    """A scenario and a design, simulated with changed numbers."""

    scenario: Scenario
    subject: PreparedDesign
    records: Records
    tuned: Tuned | None
    runs: int = 0

    @classmethod
    def of(cls, scenario: Scenario, subject: PreparedDesign, records: Records) -> _Bench:
        """Tune the controller for the unchanged scenario; keep its gains for all simulations."""
        return cls(scenario, subject, records, tune(scenario, plant(subject), records))

    def base(self) -> Simulation:
        """Simulation of the unchanged scenario."""
        self.runs += 1
        return run(self.scenario, plant(self.subject), self.records, self.tuned)

    def targets(self, names: Sequence[str] | None) -> Iterable[_Target]:
        """The numbers to vary."""
        if names is not None:
            yield from (self._target(name) for name in names)
            return
        design = self.subject.design
        numbers = paths.numbers(design)
        if design.valve is not None and _damping_follows(design.valve):
            del numbers["valve.damping_ratio"]
        known = [name for name in DESIGN if name in numbers and has_effect(name, design.ideal)]
        yield from map(self._target, known)
        for loc, _, value in leaves(self.scenario, Scenario):
            stated = _stated(self.scenario, loc)
            if number_of(value) is None or loc[0] in _APART or loc[-1] in _TIMES or not stated:
                continue
            yield self._target(paths.spell(loc, self.scenario))

    def _target(self, name: str) -> _Target:
        """The number with this PATH in the scenario or, if it has none, in the design."""
        design = self.subject.design
        try:
            resolved = paths.resolve(name, self.scenario, RESULTS, Scenario)
        except ValueFault:
            quantity, value = paths.quantity_of(name, design), paths.get(design, name)
            if isinstance(value, float):
                return _Target(paths.canonical(name, design), (), quantity, value, "design")
        else:
            number = number_of(child_at(self.scenario, resolved.loc))
            if number is not None and resolved.quantity is not None:
                return _Target(resolved.path, resolved.loc, resolved.quantity, number, "scenario")
        message = "no number is stated here"
        raise InputError(
            Diagnostic(message, "name a PATH for which the file states a number", path=name)
        )

    def parameter(
        self, target: _Target, reference: Mapping[str, float], step: float
    ) -> ParameterEffects:
        """Effects of one parameter, from two simulations, and two more if any result changes."""
        full_step = self._slopes(target, reference, step)
        moving = {name for name, slope in full_step.items() if _moves(slope, _least(name, step))}
        half_step = self._slopes(target, reference, 0.5 * step) if moving else full_step
        effects = {
            name: Effect(
                *slope, name in half_step and _same(slope, half_step[name], _least(name, step))
            )
            for name, slope in full_step.items()
        }
        per: Literal["1 %", "1 K"] = "1 K" if _absolute(target.quantity) else "1 %"
        return ParameterEffects(
            target.path, target.origin, target.quantity, target.value, per, effects
        )

    def _slopes(
        self, target: _Target, reference: Mapping[str, float], step: float
    ) -> dict[str, _Slope]:
        """Change of each result per unit of a parameter, if both simulations have this result."""
        units = step / 0.01
        high, low = (
            self._values(target, target.value + sign * units * target.amount) for sign in (1, -1)
        )
        slopes: dict[str, _Slope] = {}
        for name, value in reference.items():
            above, below = high.get(name), low.get(name)
            if above is None or below is None:
                continue
            change = (above - below) / (2 * units)
            zero = abs(value) < LEAST.get(name, 0.0) or value == 0
            slopes[name] = (None if zero else 100 * change / abs(value), change)
        return slopes

    def _values(self, target: _Target, value: float) -> Mapping[str, float | None]:
        """Results with a changed value of a parameter."""
        self.runs += 1
        scenario, subject = self.scenario, self.subject
        if target.origin == "scenario":
            scenario = _put(scenario, target.loc, value)
        else:
            old = paths.get(subject.design, target.path)
            new = Fraction(value) if isinstance(old, Fraction) else value
            design = with_values(subject.design, {target.path: new}, metrics=subject.quantities)
            subject = prepare(design, subject.materials, subject.plugins)
        actuator = plant(subject)
        gains_kept = not target.path.startswith("control.")
        tuned = self.tuned if gains_kept else tune(scenario, actuator, self.records)
        return run(scenario, actuator, self.records, tuned).values


def _damping_follows(valve: Valve) -> bool:
    """Whether the damping ratio of the spool follows from two frequencies that are stated."""
    other = valve.natural_frequency or valve.frequency_90deg
    return valve.frequency_3db is not None and other is not None


def _least(name: str, step: float) -> float:
    """Change of a result, per 1 % or 1 K, below which it counts as rounding error [SI]."""
    return LEAST.get(name, 0.0) * 0.01 / step


def _moves(slope: _Slope, least: float) -> bool:
    """Whether the change of a result exceeds rounding errors."""
    percent, change = slope
    return abs(change) > least if percent is None else abs(percent) > NOTHING


def _same(slope: _Slope, other: _Slope, least: float) -> bool:
    """Whether the effects with the full and with half the step agree, or are both zero."""
    if not (_moves(slope, least) or _moves(other, least)):
        return True
    index = 1 if slope[0] is None else 0
    first, second = slope[index] or 0.0, other[index] or 0.0
    return abs(first - second) <= AGREE * max(abs(first), abs(second))


def _absolute(quantity: Quantity) -> bool:
    """Whether a quantity has an arbitrary zero, so that relative changes are meaningless."""
    return quantity.dimension == "temperature"


def _put(node: Any, loc: Loc, value: float) -> Any:
    """A copy of a section of a file, with the number at one location replaced."""
    key, remaining_path = loc[0], loc[1:]
    old = child(node, key)
    new: Any = _put(old, remaining_path, value) if remaining_path else value
    if not remaining_path and isinstance(old, Fraction):
        new = Fraction(value)
    if isinstance(node, tuple):
        return tuple(new if k == key else item for k, item in enumerate(node))
    return node.model_copy(update={key: new})


def _stated(node: Any, loc: Loc) -> bool:
    """Whether a file states the value at a location; if not, it is a default."""
    for key in loc:
        if isinstance(key, str) and key not in node.model_fields_set:
            return False
        node = child(node, key)
    return True
