"""Robust optima: limits met at a stated probability, by a sequence of ordinary optima.

At each optimum the margins of all limits are drawn; each limit then keeps a reserve, the distance
from its margin at the design to its own quantile, and the design is optimised again with these
reserves, until they come to rest. How likely a single limit may fail follows from how often any
fails. An independent sample tells what the last design does.
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
from ..optimisation.result import Certificate, Optimisation
from ..optimisation.robustness import Robust, Round
from .estimate import Rate
from .inputs import inputs, read_by_models
from .model import TOLERANCE, Model
from .study import draw

Held: TypeAlias = npt.NDArray[Any]
Search = Callable[[PreparedDesign, bool], Optimisation]
"""An ordinary optimum of a subject; with prices or without."""

LEAST, MOST = 0.5, 0.9999
"""Probabilities that may be asked for."""
ROUNDS = 12
"""Most optima on the way."""
REFUSALS = 3
"""How often reserves that no design keeps are asked anew, as the nearest design needs them."""
STILL = 2e-3
"""Relative change of the objective that counts as rest."""
FAR = 1.0
"""Margin of the draw that counts beyond which a limit needs no reserve: it is far from active, and
one that is measured there, of a life say, may ask for more than any other design has."""
AIM, ROOM = 0.85, 0.15
"""Share of the failures allowed that is aimed at, and how far from it is near enough: what is
asked for then lies outside the bounds of the last sample."""


@dataclass(frozen=True, slots=True)
class _Seen:
    """What draws at a design tell: all covered limits hold, reserves at a level of failure."""

    model: Model
    covered: Held
    nominal: Held
    margins: Held

    @property
    def rate(self) -> float:
        """Share of the draws at which every covered limit holds."""
        return float((self.margins[self.covered] >= -TOLERANCE).all(axis=0).mean())

    def reserves(self, level: float) -> dict[str, float]:
        """Margin to keep by the name of the limit, so that it alone fails with this probability."""
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
    """The best design whose limits all hold with a stated probability.

    Parameters
    ----------
    subject : the prepared design
    target : probability, 0.5 to 0.9999
    search : an ordinary optimum
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
    """Refuse a probability that is none, or that no sample of ours can show."""
    if not LEAST <= target <= MOST:
        message = f"a yield of {target:g} cannot be asked for"
        raise UsageError(Diagnostic(message, f"write {LEAST:g} to {MOST:g}, e.g. 0.99"))


def _without_choices(subject: PreparedDesign, plain: Optimisation) -> PreparedDesign:
    """The subject with the choices that its plain optimum made, and what scatters with them."""
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
    """Probability with which a single limit may fail, steered by how often any fails."""

    def __init__(self, aim: float) -> None:
        self.aim = self.value = aim
        self.last: tuple[float, float] | None = None

    def near(self, missed: float) -> bool:
        """Whether as many fail as are aimed at; fewer where a single limit may not fail more."""
        return abs(missed - self.aim) <= ROOM * self.aim or (missed < self.aim == self.value)

    def follow(self, missed: float) -> None:
        """Take the level at which the failures aimed at are expected: a secant in logarithms."""
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
        model = Model(subject, inputs(subject))
        tally = draw(model, self.count, self.seed, keep=self.count)
        nominal = model.nominal.margins[:, 0]
        held = model.own if covered is None else covered
        return _Seen(model, held, nominal, tally.kept.margins)

    def walk(self) -> None:
        """Optimise with the reserves of the design before, until nothing changes any more."""
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
        """Reserves of the design that misses those asked for by least.

        Where enough of its draws hold all the same, one limit fails more and others less than
        the level: what it has is then enough.
        """
        asked = near.reserves(level)
        if near.rate < self.target:
            return asked
        margins = dict(zip(self.names, near.nominal.tolist(), strict=True))
        return {name: max(min(kept, margins[name]), 0.0) for name, kept in asked.items()}

    def _keep(self, found: Optimisation, seen: _Seen, reserves: dict[str, float]) -> None:
        """Remember the best design: enough yield before little of the objective."""
        sign = -1.0 if found.design.objective.maximise is not None else 1.0

        def rank(one: Optimisation, at: _Seen) -> tuple[float, float]:
            missed = 1 - at.rate
            enough = AIM * (1 + ROOM / 2) * self.allowed
            return max(missed - enough, 0.0), sign * one.best_objective

        if rank(found, seen) <= rank(self.found, self.seen):
            self.found, self.seen, self.reserves = found, seen, reserves

    def result(self) -> Optimisation:
        """The last design with prices, held against an independent sample."""
        found, reserves, seen = self._last()
        if self.plain.choices is not None:
            words = f"{self.plain.choices.sentence}; all of it without the reserves of the yield"
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
        sentence = f"{_none(found)} meets every requirement with the reserves of the yield"
        if not self.refused:
            sentence = f"the yield found is below the {_percent(self.target)} asked for"
        remedy = f"{found.remedy or 'relax a requirement'}, or ask for a lower yield"
        return replace(found, robust=made, sentence=sentence, remedy=remedy)

    def _last(self) -> tuple[Optimisation, dict[str, float], _Seen]:
        """The design to show with its reserves: the best kept, else the nearest there is."""
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
        """A certificate with what it does not speak of."""
        if certificate.lower_bound is None:
            return certificate
        words = "that bound is of the limits themselves, without the reserves of the yield"
        if self.plain.choices is not None:
            words += ", and of the choices made"
        return replace(certificate, sentence=f"{certificate.sentence}; {words}")

    def _wanting(self) -> str:
        """Limits whose reserve is furthest beyond what the last design with reserves has."""
        margins = dict(zip(self.names, self.seen.nominal, strict=True))
        lacks = sorted((margins[x] - kept, x) for x, kept in self.refused.items())
        told = [f"{x} {100 * self.refused[x]:.2g} %" for lack, x in lacks[:3] if lack < 0]
        return ", ".join(told) or "those below"

    def _words(self, made: Robust, found: Optimisation) -> str:
        quantity = of_metric(found.objective_metric)
        before, after = (
            quantity.text(x, 5) for x in (made.nominal_objective, found.best_objective)
        )
        shown = f"{_percent(made.rate)} ({_percent(made.lower)} to {_percent(made.upper)})"
        cost = (
            f"{quantity.label} {after} instead of {before} without reserves, where "
            f"{_percent(made.nominal_rate)} hold"
        )
        rest = ""
        if self.plain.choices is not None:
            rest = "; the choices are those of the optimum without reserves: try others by --set"
        if made.left_out:
            rest += f"; not covered: {', '.join(made.left_out)}, missed anyway"
        if self.refused:
            return (
                f"{_none(found)} keeps the reserves with which all limits hold with "
                f"{_percent(self.target)}: {self._wanting()}. At the design shown they hold "
                f"in {shown} of {made.samples} independent draws; without reserves "
                f"{quantity.label} is {before}, and {_percent(made.nominal_rate)} hold{rest}. What "
                "would be enough is told for these reserves, which grow with what a limit allows: "
                "ask again with it"
            )
        if not made.reached:
            return (
                f"the reserves did not settle in {len(made.rounds) - 1} rounds: all limits hold in "
                f"{shown} of {made.samples} independent draws, not {_percent(self.target)}; "
                f"{cost}{rest}"
            )
        how = "" if self.converged else ", though the reserves did not settle"
        return (
            f"all limits hold in {shown} of {made.samples} independent draws, asked "
            f"{_percent(self.target)}{how}; {cost}{rest}"
        )


def _none(found: Optimisation) -> str:
    """What was looked for and not found."""
    sizes = "" if found.rounding is None else f" of {found.rounding.name}"
    return f"no design{sizes} was found that"


def _solved(found: Optimisation) -> bool:
    """Whether an optimum keeps all its limits with their reserves, in the sizes asked for."""
    infeasible = found.status == "infeasible" or found.status.startswith("limit_inf")
    usable = found.status != "undefined" and not found.status.startswith("interrupted")
    made = found.rounding is None or found.rounding.met
    return not infeasible and usable and made and found.evaluation.met


def _covered_rate(model: Model, covered: Held, count: int, seed: int) -> Rate:
    """How often all covered limits hold, in a sample of its own."""
    model.own = covered
    return draw(model, count, seed, stream=1).rates()[-2]


def _percent(share: float) -> str:
    return f"{100 * share:.4g} %"
