"""Shortfalls of duty cycles that miss a check, and single changes that cure them.

A cure is one number of the design: it is enough for the missed check, and no other check of the
duty cycles gets missed by it. The models of the cycles confirm each cure at its printed value.
Other limits of the design, such as strength, are not considered.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, floor, log10
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.errors import InputError
from ...base.quantities import Sense
from ...design.build import with_values
from ...design.duty import DutyCycle
from ...design.model import Design
from ...design.paths import quantity_of
from ...metrics import METRICS
from ..kernel import PreparedDesign, duty_numbers, duty_results, with_few_samples
from .study import CycleStudy, DutyStudy, Lack, Remedy, Shortfall, study as of_models

Bools = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
CHECKED = {
    "duty_supply_share": ("share",),
    "duty_suction_ratio": ("pressure_a_min", "pressure_b_min"),
    "duty_stroke_margin": ("position_min", "position_max"),
    "duty_fatigue": ("damage",),
}
"""Metrics of duty cycles that the check list limits, and the results of the cycles they need."""
LIFE = "the life"
"""Word for all cycles of a life."""
STEPS, FINER = 8, 4
"""Values tried for each number, evenly spaced by ratio; then, twice, within the first step that is
enough (our choice)."""
MOST = 4
"""Largest number of cures in a sentence, those with the least relative change first."""
DIGITS = 3
"""Significant digits of a cure."""
UNLIMITED = 1e3
"""Factor on the size of the valve, at which its pressure drop no longer counts."""
MISSED = 1e-6
"""A margin of at least -MISSED counts as met, as for all limits."""


class Candidate(NamedTuple):
    """A number of the design that may cure a cycle: its PATH, words, and range of factors."""

    path: str
    words: str
    lowest: float
    highest: float


def shortfalls(
    subject: PreparedDesign,
    duty: DutyStudy,
    limits: Mapping[str, tuple[Sense, float]],
    missed: Sequence[str],
) -> Iterator[Shortfall]:
    """Yield every missed check of every duty cycle, with its cures.

    Parameters
    ----------
    subject : the design
    duty : its duty cycles over time
    limits : sense and limit of those of `CHECKED` that are checked
    missed : those of them that are missed
    """
    model = _Model(subject, limits)
    assert subject.design.duty is not None
    cycles = {cycle.name: cycle for cycle in subject.design.duty.cycles}
    studies = {study.name: study for study in duty.cycles}
    for metric, cycle in model.present:
        if metric not in missed or model.present[metric, cycle][0] >= -MISSED:
            continue
        sample = time = None
        if metric == "duty_fatigue":
            lack = _fatigue(duty, model)
            reason = f"{LIFE}: {lack.words}"
            candidates = list(_life_candidates(subject.design))
        else:
            study, stated = studies[cycle], cycles[cycle]
            lack = _LACKS[metric](study, subject, limits[metric][1])
            sample, time = lack.sample, float(study.record.time[lack.sample])
            reason = f"{cycle}: at {time:.4g} s (sample {sample}) {lack.words}"
            candidates = list(_candidates(metric, stated, subject.design))
        candidates = [c for c in candidates if subject.numbers.get(c.path)]
        found = [model.cure((metric, cycle), candidate) for candidate in candidates]
        remedies = sorted(
            (remedy for remedy in found if remedy is not None),
            key=lambda remedy: abs(np.log(remedy.needed / remedy.now)),
        )
        tried = tuple(dict.fromkeys(c.words.removeprefix("a ") for c in candidates))
        yield Shortfall(
            metric, cycle, lack.what, sample, time, reason, tuple(remedies[:MOST]), tried
        )


# ---- shortfalls ----


class _Lack(NamedTuple):
    """A shortage of a cycle: its kind, the sample at which it is largest, and a sentence."""

    what: Lack
    sample: int
    words: str


def _force_or_flow(study: CycleStudy, subject: PreparedDesign, limit: float) -> _Lack:
    """Missing force or flow where the supply does not move the load with the permitted opening."""
    index = int(np.argmax(study.traces["share"]))
    at = {name: float(trace[index]) for name, trace in study.traces.items()}
    v = subject.values()
    sizeless = at["needed"]
    if subject.design.valve is not None:
        varied = {"valve.rated_flow": np.array([UNLIMITED * float(v["valve.rated_flow"])])}
        models, numbers = duty_numbers(subject, subject.values(varied))
        larger = next(x for x in of_models(models, numbers[:, 0]).cycles if x.name == study.name)
        sizeless = float(larger.traces["needed"][index])
    available = limit * at["supply"]
    pressure, flow = METRICS["duty_supply_needed"], METRICS["duty_flow_peak"]
    if sizeless >= available or not np.isfinite(at.get("opening", np.inf)):
        force = METRICS["duty_force_margin"].text
        area = at["reserve"] / (at["supply"] - at["needed"])
        parts = ""
        if sizeless < at["needed"]:
            parts = f", of which {pressure.text(at['needed'] - sizeless)} for the flow"
        words = (
            f"too little force: the supply gives {force((at['needed'] - available) * area)} less "
            f"than the load needs ({pressure.text(at['needed'])}{parts})"
        )
        return _Lack("force", index, words)
    share = float(v["duty.opening_limit"])
    passed = abs(at["flow"] - at["leakage"])
    possible = passed * np.sqrt((available - sizeless) / (at["needed"] - sizeless))
    words = (
        f"too little flow: at {100 * share:.3g} % opening the valve passes {flow.text(possible)} "
        f"of {flow.text(passed)} that the motion needs"
    )
    return _Lack("flow", index, words)


def _cavitation(study: CycleStudy, subject: PreparedDesign, limit: float) -> _Lack:
    """Where the pressure of a chamber falls below the limit."""
    lows = {name: int(np.argmin(study.traces[f"pressure_{name}"])) for name in "ab"}
    chamber = min(lows, key=lambda name: study.traces[f"pressure_{name}"][lows[name]])
    index = lows[chamber]
    low = float(study.traces[f"pressure_{chamber}"][index])
    pull = float(study.traces["force"][index]) * np.sign(float(study.traces["speed"][index]))
    cause = ", because the load pulls the piston" if pull < 0 else ""
    words = (
        f"cavitation in chamber {chamber.upper()}: its pressure falls to "
        f"{METRICS['duty_pressure_min'].text(low)}{cause}"
    )
    return _Lack("pressure", index, words)


def _travel(study: CycleStudy, subject: PreparedDesign, limit: float) -> _Lack:
    """Where the piston would pass its stop."""
    position = study.traces["position"]
    stroke = subject.design.cylinder.stroke
    low, high = int(np.argmin(position)), int(np.argmax(position))
    before, beyond = limit - float(position[low]), float(position[high]) + limit - stroke
    text = METRICS["duty_stroke_margin"].text
    stop, index, over = (
        ("extended", high, beyond) if beyond > before else ("retracted", low, before)
    )
    where = f"beyond the {stop} stop" if limit == 0 else f"too near the {stop} stop"
    words = f"too little travel: the piston would be {text(over)} {where}"
    return _Lack("travel", index, words)


_LACKS = {
    "duty_supply_share": _force_or_flow,
    "duty_suction_ratio": _cavitation,
    "duty_stroke_margin": _travel,
}


def _fatigue(duty: DutyStudy, model: _Model) -> _Lack:
    """The part with the largest damage, and the cycle that causes most of it."""
    part = max(model.damage, key=lambda place: model.damage[place])
    shares = {study.name: study.damage.get(part, 0.0) for study in duty.cycles}
    most = max(shares, key=lambda name: shares[name])
    damage = f"{model.damage[part]:.3g}"
    if len(shares) > 1:
        damage += f", {100 * shares[most] / model.damage[part]:.0f} % of it by {most}"
    words = f"too little fatigue strength: {part} reaches a damage of {damage}"
    return _Lack("fatigue strength", -1, words)


# ---- cures ----


def _candidates(metric: str, cycle: DutyCycle, design: Design) -> Iterator[Candidate]:
    """Numbers that may cure a check of one cycle."""
    own = f"duty.cycles[{cycle.name}]."
    assert design.duty is not None
    level = design.duty.pressure_path(cycle)
    if metric != "duty_stroke_margin":
        yield Candidate(level, "a supply pressure", 1.0, 3.0)
        if metric == "duty_supply_share":
            yield Candidate("valve.rated_flow", "a valve", 1.0, 8.0)
        else:
            yield Candidate("supply.return_pressure", "a return pressure", 1.0, 8.0)
        yield Candidate("cylinder.bore", "a bore", 0.5, 2.0)
    else:
        yield Candidate("cylinder.stroke", "a stroke", 0.5, 2.0)
    if cycle.record.joint and cycle.lever_arm is not None and design.linkage is None:
        yield Candidate(f"{own}lever_arm", "a lever arm", 0.4, 2.5)
    elif cycle.record.joint:
        yield Candidate("linkage.crank_radius", "a crank radius", 0.4, 2.5)
        if metric == "duty_stroke_margin":
            yield Candidate("linkage.base_radius", "a base radius", 0.8, 1.25)


def _life_candidates(design: Design) -> Iterator[Candidate]:
    """Numbers that may cure the fatigue of a part."""
    assert design.duty is not None
    for cycle in design.duty.cycles:
        if cycle.repeats:
            words = "a number of repeats" if len(design.duty.cycles) == 1 else (
                f"a number of repeats of {cycle.name}")  # fmt: skip
            yield Candidate(f"duty.cycles[{cycle.name}].repeats", words, 1e-4, 1.0)
    yield Candidate("supply.pressure", "a supply pressure", 0.5, 1.0)
    for index, ply in enumerate(design.barrel.layup):
        words = f"a thickness of layup[{index}] ({ply.material})"
        yield Candidate(f"barrel.layup[{index}].thickness", words, 1.0, 4.0)
    for path, words in (
        ("rod.outer_diameter", "a rod diameter"),
        ("rod.thread.diameter", "a rod thread"),
        ("piston.nut.diameter", "a thread of the piston nut"),
    ):
        yield Candidate(path, words, 1.0, 2.0)


class _Model:
    """Margins of all checks of duty cycles, as a function of one number.

    Attributes
    ----------
    present : margins (1,) of the design by metric and cycle
    damage : fatigue damage of the design by part
    """

    def __init__(self, subject: PreparedDesign, limits: Mapping[str, tuple[Sense, float]]) -> None:
        self._subject, self._limits = subject, limits
        self._few = with_few_samples(subject)
        self._known = self._faults({})  # a search that found no design may leave contradictions
        self._wanted = {result for metric in limits for result in CHECKED[metric]}
        results = duty_results(subject, subject.values(), self._wanted).metrics
        self.damage = {
            place: float(np.ravel(x)[0]) for place, x in results.get("duty_fatigue", {}).items()
        }
        self.present = self._margins(subject, {}, 1)

    def _margins(
        self, subject: PreparedDesign, varied: Mapping[str, Floats], count: int
    ) -> dict[tuple[str, str], Floats]:
        """Least margins (designs,) by metric and cycle."""
        results = duty_results(subject, subject.values(varied), self._wanted).metrics
        margins: dict[tuple[str, str], Floats] = {}
        for metric, (sense, limit) in self._limits.items():
            for place, value in results.get(metric, {}).items():
                cycle = LIFE if metric == "duty_fatigue" else place.partition(", ")[0]
                row = np.broadcast_to(np.real(np.asarray(value)), (count,))
                margin = limit - row if sense == "max" else row - limit
                known = np.nan_to_num(margin, nan=-np.inf)
                key = metric, cycle
                margins[key] = np.minimum(margins[key], known) if key in margins else known
        return margins

    def _enough(
        self, subject: PreparedDesign, target: tuple[str, str], path: str, values: Floats
    ) -> Bools:
        """Whether values of a number meet the target and miss no other check that is met now."""
        margins = self._margins(subject, {path: values}, values.size)
        enough = margins[target] >= 0
        for key, margin in margins.items():
            enough &= margin >= min(-MISSED, self.present[key][0])
        return enough

    def cure(self, target: tuple[str, str], candidate: Candidate) -> Remedy | None:
        """The nearest sufficient value of a number; None if none is within its range."""
        path, words = candidate.path, candidate.words
        now = float(self._subject.numbers[path])
        found = [
            needed
            for factor in (candidate.lowest, candidate.highest)
            if factor != 1 and (needed := self._nearest(target, path, now, factor)) is not None
        ]
        needed = min(found, key=lambda value: abs(np.log(value / now)), default=None)
        if needed is None:
            return None
        quantity = quantity_of(path, self._subject.design)
        return Remedy(path, words, now, needed, quantity.text(now), quantity.text(needed))

    def _nearest(
        self, target: tuple[str, str], path: str, now: float, factor: float
    ) -> float | None:
        """The sufficient value nearest to the present one, rounded away from it.

        Few samples of long cycles give candidates; if all samples refuse these, they are searched.
        """
        long = self._few is not self._subject
        for subject in (self._few, self._subject) if long else (self._subject,):
            candidates = self._rounded(subject, target, path, now, factor)
            if not candidates.size:
                return None
            enough = np.flatnonzero(self._enough(self._subject, target, path, candidates))
            for value in candidates[enough].tolist():
                if self._valid(path, value):
                    return float(value)
        return None

    def _rounded(
        self,
        subject: PreparedDesign,
        target: tuple[str, str],
        path: str,
        now: float,
        factor: float,
    ) -> Floats:
        """Rounded values around the first sufficient one, in order; none if none is sufficient."""
        first, last = now, now * factor
        for steps in (STEPS, FINER, FINER):
            values = np.geomspace(first, last, steps + 1)[1:]
            enough = np.flatnonzero(self._enough(subject, target, path, values))
            if not enough.size:
                return np.empty(0)
            at = int(enough[0])
            first, last = (first if at == 0 else float(values[at - 1])), float(values[at])
        quantity = quantity_of(path, self._subject.design)
        scale = quantity.to_display(1.0)
        finer = np.geomspace(first, last, FINER + 1)[1:]
        rounded = [_outward(value * scale, DIGITS, up=factor > 1) / scale for value in finer]
        return np.array([*rounded, _outward(last * scale, DIGITS + 2, up=factor > 1) / scale])

    def _valid(self, path: str, value: float) -> bool:
        """Whether a design file may have this value, whatever the bounds of a variable."""
        changes: dict[str, float | str | None] = {path: value}
        variable = self._subject.design.variables.get(path)
        if variable is not None and not variable.lower <= value <= variable.upper:
            side = "upper" if value > variable.upper else "lower"
            changes[f"variables.{path}.{side}"] = value
        return self._faults(changes) <= self._known

    def _faults(self, changes: Mapping[str, float | str | None]) -> frozenset[str | None]:
        """PATHs of the values that contradict each other after changes."""
        try:
            with_values(self._subject.design, changes, metrics=self._subject.quantities)
        except InputError as error:
            return frozenset(fault.path for fault in error.diagnostics)
        return frozenset()


def _outward(value: float, digits: int, *, up: bool) -> float:
    """A positive value rounded to significant digits, up or down.

    >>> _outward(23.04, 3, up=True), _outward(23.06, 3, up=False)
    (23.1, 23.0)
    """
    step = 10.0 ** (floor(log10(value)) - digits + 1)
    way = ceil if up else floor
    return float(f"{way(value / step - (1e-9 if up else -1e-9)) * step:.{digits}g}")
