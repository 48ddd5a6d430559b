"""Robust optima: meet all limits with a stated probability.

The design is optimised repeatedly. At each optimum the margins of all limits are drawn. Each limit
then requires a reserve: the distance from its nominal margin to its quantile. The design is
optimised again with these reserves until they settle. The failure probability allowed for one limit
follows from how often any limit fails. An independent sample then verifies the last design.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ..base.errors import Diagnostic, UsageError
from ..base.progress import whole
from ..design.model import Design
from ..evaluation import PreparedDesign, prepare
from ..metrics import of_metric
from ..optimisation.problem import Robust, Round
from ..optimisation.result import Certificate, Optimisation
from .estimate import Rate
from .inputs import TOLERANCE, UncertainModel, inputs, read_by_models
from .study import draw

Held: TypeAlias = npt.NDArray[Any]
Search = Callable[[PreparedDesign, bool], Optimisation]
"""Search for an ordinary optimum of a design; the flag asks for prices."""

LEAST, MOST = 0.5, 0.9999
"""Range of probabilities a user may request."""
ROUNDS = 12
"""Maximum number of optimisation rounds."""
REFUSALS = 3
"""Maximum reductions of infeasible reserves to those of the nearest design."""
STILL = 2e-3
"""Relative change of the objective that counts as converged."""
FAR = 1.0
"""Drawn margin above which a limit needs no reserve, as it is far from active. Its reserve, of a
life say, could exceed what any other design can meet."""
AIM, ROOM = 0.85, 0.15
"""Target share of the allowed failures, and the tolerance on it. The requested yield then lies
outside the bounds of the last sample."""


@dataclass(frozen=True, slots=True)
class _Seen:
    """Draws at one design: how often all covered limits are met, and the reserves they imply."""

    model: UncertainModel
    covered: Held
    nominal: Held
    margins: Held

    @property
    def rate(self) -> float:
        """Return the share of draws that meet every covered limit."""
        return float((self.margins[self.covered] >= -TOLERANCE).all(axis=0).mean())

    def reserves(self, level: float) -> dict[str, float]:
        """Return the reserve by limit for which each limit alone fails with this probability."""
        found = {}
        for row in np.flatnonzero(self.covered):
            drawn = np.where(np.isnan(self.margins[row]), -np.inf, self.margins[row])
            low = float(np.quantile(drawn, level, method="inverted_cdf"))
            reserve = float(self.nominal[row]) - low
            if np.isfinite(self.nominal[row]) and reserve > 0 and low <= FAR:
                found[self.model.limits[row].name] = reserve
        return found


def robust(
    subject: PreparedDesign, target: float, search: Search, *, seed: int = 0
) -> Optimisation:
    """Return the best design that meets all limits with a stated probability.

    Parameters
    ----------
    subject : the prepared design
    target : probability, 0.5 to 0.9999
    search : search for an ordinary optimum
    seed : of the draws; the same seed gives the same design

    Raises
    ------
    UsageError
        a probability outside that range
    """
    require(target)
    plain = search(subject, False)
    if plain.status.startswith("interrupted"):
        return plain
    if not _solved(plain):
        return search(subject, True)
    fixed = _without_choices(subject, plain)
    way = _Way(fixed, target, search, seed, plain)
    way.walk()
    return way.result() if way.stopped is None else way.stopped


def require(target: float) -> None:
    """Reject a probability outside the range that the samples can verify."""
    if not LEAST <= target <= MOST:
        message = f"a yield of {target:g} is outside the valid range"
        raise UsageError(Diagnostic(message, f"write {LEAST:g} to {MOST:g}, e.g. 0.99"))


def _without_choices(subject: PreparedDesign, plain: Optimisation) -> PreparedDesign:
    """Return the design with the choices of its ordinary optimum fixed, and inputs to match."""
    if not subject.design.choices:
        return subject
    design = plain.design.model_copy(update={"choices": {}})
    found = _prepared(design, subject)
    read = read_by_models(found)
    kept = {path: entry for path, entry in design.uncertainty.items() if path in read}
    design = design.model_copy(update={"uncertainty": kept})
    return replace(_prepared(design, subject), reserves=subject.reserves)


def _prepared(design: Design, subject: PreparedDesign) -> PreparedDesign:
    found = prepare(design, plugins=subject.plugins)
    return replace(found, lenient=True)


class _Level:
    """Allowed failure probability of one limit, adjusted by how often any limit fails."""

    def __init__(self, aim: float) -> None:
        self.aim = self.value = aim
        self.last: tuple[float, float] | None = None

    def near(self, missed: float) -> bool:
        """Whether the failures are near the target, or below it with the level at its maximum."""
        return abs(missed - self.aim) <= ROOM * self.aim or (missed < self.aim == self.value)

    def follow(self, missed: float) -> None:
        """Set the level expected to give the target failure rate: a secant step in logarithms."""
        missed = max(missed, 1e-3 * self.aim)
        steep = 1.0
        if self.last is not None and self.last[0] != self.value:
            steep = np.log(self.last[1] / missed) / np.log(self.last[0] / self.value)
        self.last = (self.value, missed)
        step = (self.aim / missed) ** (1 / float(np.clip(steep, 1.0, 4.0)))
        self.value = min(self.aim, self.value * float(np.clip(step, 0.2, 5.0)))


class _Way:
    """The sequence of optima."""

    def __init__(
        self, subject: PreparedDesign, target: float, search: Search, seed: int, plain: Optimisation
    ) -> None:
        self.subject, self.target, self.search, self.seed = subject, target, search, seed
        self.plain = plain
        self.allowed = 1 - target
        self.count = round(float(np.clip(100 / self.allowed, 4096, 100_000)))
        first = self._see(plain.best, None)
        covered = first.model.own | (first.nominal >= -TOLERANCE)
        self.names = [limit.name for limit in first.model.limits]
        self.covered = covered
        self.left_out = tuple(
            name for name, held in zip(self.names, covered, strict=True) if not held
        )
        self.seen = replace(first, covered=covered)
        self.rounds = [Round(plain.best_objective, self.seen.rate)]
        self.found, self.reserves = plain, dict[str, float]()
        self.converged, self.refusals = False, 0
        self.refused: dict[str, float] = {}
        self.stopped: Optimisation | None = None
        self.level = _Level(AIM * self.allowed)

    def _see(self, design: Design, covered: Held | None) -> _Seen:
        subject = _prepared(design, self.subject)
        model = UncertainModel(subject, inputs(subject))
        tally = draw(model, self.count, self.seed, keep=self.count)
        nominal = model.nominal.margins[:, 0]
        held = model.own if covered is None else covered
        return _Seen(model, held, nominal, tally.kept.margins)

    def walk(self) -> None:
        """Optimise with the reserves of the previous design until they settle."""
        level = self.level
        self.converged = self.seen.rate >= 1 - level.aim
        asked = self.reserves if self.converged else self.seen.reserves(level.value)
        while not self.converged and len(self.rounds) <= ROUNDS:
            with whole("robust optimum", (len(self.rounds) - 1) / ROUNDS):
                found = self.search(replace(self.subject, reserves=asked), False)
            if found.status.startswith("interrupted"):
                self.stopped = found
                return
            if not _solved(found):
                self.refused = asked
                if self.refusals == REFUSALS:
                    return
                self.refusals += 1
                asked = self._nearer(self._see(found.best, self.covered), level.value)
                continue
            self.refused = {}
            seen = self._see(found.best, self.covered)
            before = self.rounds[-1].objective
            self.rounds.append(Round(found.best_objective, seen.rate))
            self._keep(found, seen, asked)
            still = abs(found.best_objective - before) <= STILL * abs(before)
            self.converged = still and level.near(1 - seen.rate)
            level.follow(1 - seen.rate)
            asked = seen.reserves(level.value)

    def _nearer(self, near: _Seen, level: float) -> dict[str, float]:
        """Return the reserves available at the least infeasible design.

        Its draws may still meet the target when one limit fails more and others less than the
        level. Then its own reserves are enough.
        """
        asked = near.reserves(level)
        if near.rate < self.target:
            return asked
        margins = dict(zip(self.names, near.nominal.tolist(), strict=True))
        return {name: max(min(kept, margins[name]), 0.0) for name, kept in asked.items()}

    def _keep(self, optimisation: Optimisation, seen: _Seen, reserves: dict[str, float]) -> None:
        """Keep the better design: yield counts before the objective."""
        sign = -1.0 if optimisation.design.objective.maximise is not None else 1.0

        def rank(one: Optimisation, at: _Seen) -> tuple[float, float]:
            missed = 1 - at.rate
            enough = AIM * (1 + ROOM / 2) * self.allowed
            return max(missed - enough, 0.0), sign * one.best_objective

        if rank(optimisation, seen) <= rank(self.found, self.seen):
            self.found, self.seen, self.reserves = optimisation, seen, reserves

    def result(self) -> Optimisation:
        """Return the last design with prices, verified with an independent sample."""
        found, reserves, seen = self._last()
        if self.plain.choices is not None:
            words = (
                f"{self.plain.choices.sentence}; all choices were compared without yield reserves"
            )
            found = replace(found, choices=replace(self.plain.choices, sentence=words))
        count = round(float(np.clip(200 / self.allowed, 10_000, 400_000)))
        rate = _covered_rate(seen.model, self.covered, count, self.seed)
        made = Robust(
            target=self.target,
            rate=rate.value,
            lower=rate.lower,
            upper=rate.upper,
            samples=count,
            converged=self.converged,
            nominal_objective=self.rounds[0].objective,
            nominal_rate=self.rounds[0].rate,
            reserves=reserves,
            rounds=tuple(self.rounds),
            left_out=self.left_out,
            sentence="",
        )
        made = replace(made, sentence=self._words(made, found))
        if found.certificate is not None:
            found = replace(found, certificate=self._proven(found.certificate))
        if made.reached and not self.refused:
            return replace(found, robust=made)
        sentence = f"{_none(found)} all requirements with the reserves for this yield"
        if not self.refused:
            sentence = f"the yield is below the requested {_percent(self.target)}"
        remedy = f"{found.remedy or 'relax a requirement'}, or request a lower yield"
        return replace(found, robust=made, sentence=sentence, remedy=remedy)

    def _last(self) -> tuple[Optimisation, dict[str, float], _Seen]:
        """Return the final design with its reserves: the best feasible, else the nearest one."""
        if self.seen.rate >= self.target:
            self.refused = {}
        reserves = self.refused or self.reserves
        found = self.search(replace(self.subject, reserves=reserves), True)
        seen = self._see(found.best, self.covered)
        if self.refused and seen.rate >= self.target:
            enough = self._nearer(seen, self.level.value)
            again = self.search(replace(self.subject, reserves=enough), True)
            if _solved(again):
                self.refused = {}
                return again, enough, self._see(again.best, self.covered)
        return found, reserves, seen

    def _proven(self, certificate: Certificate) -> Certificate:
        """Return a certificate that states what it does not cover."""
        if certificate.lower_bound is None:
            return certificate
        words = "the bound is for the limits themselves, without yield reserves"
        if self.plain.choices is not None:
            words += ", and for the chosen options only"
        return replace(certificate, sentence=f"{certificate.sentence}; {words}")

    def _wanting(self) -> str:
        """Name the limits whose required reserve most exceeds the margin of the last design."""
        margins = dict(zip(self.names, self.seen.nominal, strict=True))
        lacks = sorted((margins[x] - kept, x) for x, kept in self.refused.items())
        told = [f"{x} {100 * self.refused[x]:.2g} %" for lack, x in lacks[:3] if lack < 0]
        return ", ".join(told) or "those below"

    def _words(self, made: Robust, optimisation: Optimisation) -> str:
        quantity = of_metric(optimisation.objective_metric)
        before, after = (
            quantity.text(x, 5) for x in (made.nominal_objective, optimisation.best_objective)
        )
        shown = f"{_percent(made.rate)} ({_percent(made.lower)} to {_percent(made.upper)})"
        cost = (
            f"{quantity.label} is {after}, against {before} without reserves at a yield of "
            f"{_percent(made.nominal_rate)}"
        )
        rest = ""
        if self.plain.choices is not None:
            rest = "; choices come from the optimum without reserves: try others with --set"
        if made.left_out:
            rest += f"; not covered, as missed anyway: {', '.join(made.left_out)}"
        if self.refused:
            return (
                f"{_none(optimisation)} the reserves needed for a yield of"
                f" {_percent(self.target)}: "
                f"{self._wanting()}. The design shown meets all limits in {shown} of "
                f"{made.samples} independent draws; without reserves {quantity.label} is "
                f"{before} at a yield of {_percent(made.nominal_rate)}{rest}. The changes "
                "suggested assume these reserves, which grow when a limit is relaxed: apply "
                "them and optimise again"
            )
        if not made.reached:
            return (
                f"the reserves did not settle in {len(made.rounds) - 1} rounds: all limits are "
                f"met in {shown} of {made.samples} independent draws, not "
                f"{_percent(self.target)}; {cost}{rest}"
            )
        how = "" if self.converged else ", though the reserves did not settle"
        return (
            f"all limits are met in {shown} of {made.samples} independent draws, "
            f"{_percent(self.target)} requested{how}; {cost}{rest}"
        )


def _none(optimisation: Optimisation) -> str:
    """Return the start of a sentence that no design meets something."""
    sizes = "" if optimisation.rounding is None else f" of {optimisation.rounding.name}"
    return f"no design{sizes} meets"


def _solved(optimisation: Optimisation) -> bool:
    """Whether an optimum meets all limits with their reserves, in the requested sizes."""
    infeasible = optimisation.status == "infeasible" or optimisation.status.startswith("limit_inf")
    usable = optimisation.status != "undefined" and not optimisation.status.startswith(
        "interrupted"
    )
    made = optimisation.rounding is None or optimisation.rounding.met
    return not infeasible and usable and made and optimisation.evaluation.met


def _covered_rate(model: UncertainModel, covered: Held, count: int, seed: int) -> Rate:
    """Return how often all covered limits are met, in an independent sample."""
    model.own = covered
    return draw(model, count, seed, stream=1).rates()[-2]


def _percent(share: float) -> str:
    return f"{100 * share:.4g} %"
