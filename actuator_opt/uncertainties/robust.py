"""Robust optima: meet all limits with a stated probability.

The design is optimised repeatedly. At each optimum, random draws of the uncertain inputs show how
the margin of every limit scatters. Each limit then needs a reserve, which is its nominal margin
minus a low quantile of its drawn margins. The design is optimised again with these reserves until
they converge. In doing so, the failure probability allowed for each single limit is adjusted until
the permitted share of draws misses at least one limit. Further independent draws then verify the
last design.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError
from ..base.numeric import Array
from ..base.progress import whole
from ..design.model import Design
from ..evaluation import PreparedDesign, prepare
from ..metrics import of_metric
from ..optimisation.problem import Robust, Round
from ..optimisation.result import Certificate, Optimisation
from .estimate import Rate
from .inputs import TOLERANCE, UncertainModel, inputs, read_by_models
from .study import draw

Search = Callable[[PreparedDesign, bool], Optimisation]
"""Function that optimises a design without draws. The flag, if true, requests in addition how much
the objective would gain if each limit were relaxed."""

LEAST, MOST = 0.5, 0.9999
"""Range of yields that a user may request."""
ROUNDS = 12
"""Maximum number of optimisation rounds."""
REFUSALS = 3
"""If no design can provide the reserves, the search repeats with the reserves that the nearest
design needs. It does so at most this many times."""
STILL = 2e-3
"""Relative change of the objective that counts as converged."""
FAR = 1.0
"""If even the low quantile of the drawn margins exceeds this, the limit is far from active and
needs no reserve. For a service life, for example, the reserve could otherwise exceed the margins of
all other designs."""
AIM, ROOM = 0.85, 0.15
"""Failure rate at which the search aims, as a share of the allowed failure rate, and the relative
tolerance on it. The search aims at fewer failures than allowed so that the confidence bounds of the
verifying draws lie above the requested yield."""


@dataclass(frozen=True, slots=True)
class _DesignDraws:
    """Drawn margins of one design, and the reserves that follow from them."""

    model: UncertainModel
    covered: Array
    nominal: Array
    margins: Array

    @property
    def rate(self) -> float:
        """Return the share of draws that meet every limit that the yield covers."""
        return float((self.margins[self.covered] >= -TOLERANCE).all(axis=0).mean())

    def reserves(self, level: float) -> dict[str, float]:
        """Return, by limit, the reserve with which this limit fails with probability `level`."""
        reserves = {}
        for row in np.flatnonzero(self.covered):
            margins = np.where(np.isnan(self.margins[row]), -np.inf, self.margins[row])
            quantile = float(np.quantile(margins, level, method="inverted_cdf"))
            reserve = float(self.nominal[row]) - quantile
            if np.isfinite(self.nominal[row]) and reserve > 0 and quantile <= FAR:
                reserves[self.model.limits[row].name] = reserve
        return reserves


def robust(
    subject: PreparedDesign, target: float, search: Search, *, seed: int = 0
) -> Optimisation:
    """Return the best design that meets all limits with a stated probability.

    Parameters
    ----------
    subject : the prepared design
    target : requested yield, 0.5 to 0.9999
    search : function that optimises a design without draws
    seed : seed of the draws; the same seed gives the same design

    Raises
    ------
    UsageError
        if the probability is outside this range
    """
    require(target)
    ordinary = search(subject, False)
    if ordinary.status.startswith("interrupted"):
        return ordinary
    if not _solved(ordinary):
        return search(subject, True)
    fixed = _without_choices(subject, ordinary)
    robust_search = _RobustSearch(fixed, target, search, seed, ordinary)
    robust_search.iterate()
    return robust_search.result() if robust_search.stopped is None else robust_search.stopped


def require(target: float) -> None:
    """Reject a requested yield outside the range that draws can verify."""
    if not LEAST <= target <= MOST:
        message = f"a yield of {target:g} is outside the valid range"
        raise UsageError(Diagnostic(message, f"write {LEAST:g} to {MOST:g}, e.g. 0.99"))


def _without_choices(subject: PreparedDesign, ordinary: Optimisation) -> PreparedDesign:
    """Return the design with its choices fixed as in the ordinary optimum.

    Uncertain inputs that the fixed design does not use are removed.
    """
    if not subject.design.choices:
        return subject
    design = ordinary.design.model_copy(update={"choices": {}})
    prepared = _prepared(design, subject)
    paths_read = read_by_models(prepared)
    uncertainty = {path: entry for path, entry in design.uncertainty.items() if path in paths_read}
    design = design.model_copy(update={"uncertainty": uncertainty})
    return replace(_prepared(design, subject), reserves=subject.reserves)


def _prepared(design: Design, subject: PreparedDesign) -> PreparedDesign:
    prepared = prepare(design, plugins=subject.plugins)
    return replace(prepared, lenient=True)


class _FailureLevel:
    """Failure probability allowed for each limit, adjusted until a share `aim` of draws fails."""

    def __init__(self, aim: float) -> None:
        self.aim = self.value = aim
        self.last: tuple[float, float] | None = None

    def near(self, failure_rate: float) -> bool:
        """Whether the failure rate is near the aim, or below it at the largest possible level."""
        return abs(failure_rate - self.aim) <= ROOM * self.aim or (
            failure_rate < self.aim == self.value
        )

    def follow(self, failure_rate: float) -> None:
        """Set the level that should give the failure rate `aim`, by a secant step in logarithms."""
        failure_rate = max(failure_rate, 1e-3 * self.aim)
        slope = 1.0
        if self.last is not None and self.last[0] != self.value:
            slope = np.log(self.last[1] / failure_rate) / np.log(self.last[0] / self.value)
        self.last = (self.value, failure_rate)
        step = (self.aim / failure_rate) ** (1 / float(np.clip(slope, 1.0, 4.0)))
        self.value = min(self.aim, self.value * float(np.clip(step, 0.2, 5.0)))


class _RobustSearch:
    """Repeated optimisation; each uses reserves from draws at the previous optimum."""

    def __init__(
        self,
        subject: PreparedDesign,
        target: float,
        search: Search,
        seed: int,
        ordinary: Optimisation,
    ) -> None:
        self.subject, self.target, self.search, self.seed = subject, target, search, seed
        self.ordinary = ordinary
        self.allowed = 1 - target
        self.count = round(float(np.clip(100 / self.allowed, 4096, 100_000)))
        draws = self._drawn(ordinary.best, None)
        covered = draws.model.own | (draws.nominal >= -TOLERANCE)
        self.names = [limit.name for limit in draws.model.limits]
        self.covered = covered
        self.left_out = tuple(
            name for name, is_covered in zip(self.names, covered, strict=True) if not is_covered
        )
        self.draws = replace(draws, covered=covered)
        self.rounds = [Round(ordinary.best_objective, self.draws.rate)]
        self.best, self.reserves = ordinary, dict[str, float]()
        self.converged, self.refusals = False, 0
        self.infeasible: dict[str, float] = {}
        self.stopped: Optimisation | None = None
        self.level = _FailureLevel(AIM * self.allowed)

    def _drawn(self, design: Design, covered: Array | None) -> _DesignDraws:
        subject = _prepared(design, self.subject)
        model = UncertainModel(subject, inputs(subject))
        counts = draw(model, self.count, self.seed, keep=self.count)
        nominal = model.nominal.margins[:, 0]
        covered_limits = model.own if covered is None else covered
        return _DesignDraws(model, covered_limits, nominal, counts.kept.margins)

    def iterate(self) -> None:
        """Optimise with the reserves of the previous design until they converge."""
        level = self.level
        self.converged = self.draws.rate >= 1 - level.aim
        reserves = self.reserves if self.converged else self.draws.reserves(level.value)
        while not self.converged and len(self.rounds) <= ROUNDS:
            with whole("robust optimum", (len(self.rounds) - 1) / ROUNDS):
                optimisation = self.search(replace(self.subject, reserves=reserves), False)
            if optimisation.status.startswith("interrupted"):
                self.stopped = optimisation
                return
            if not _solved(optimisation):
                self.infeasible = reserves
                if self.refusals == REFUSALS:
                    return
                self.refusals += 1
                reserves = self._nearer(self._drawn(optimisation.best, self.covered), level.value)
                continue
            self.infeasible = {}
            draws = self._drawn(optimisation.best, self.covered)
            previous = self.rounds[-1].objective
            self.rounds.append(Round(optimisation.best_objective, draws.rate))
            self._keep(optimisation, draws, reserves)
            unchanged = abs(optimisation.best_objective - previous) <= STILL * abs(previous)
            self.converged = unchanged and level.near(1 - draws.rate)
            level.follow(1 - draws.rate)
            reserves = draws.reserves(level.value)

    def _nearer(self, nearest: _DesignDraws, level: float) -> dict[str, float]:
        """Return reserves for the next search, after one that found no feasible design.

        The draws at the least infeasible design, `nearest`, may still meet the requested yield: one
        limit fails more often than `level`, and others less often. Reserves no larger than the
        margins of this design are then enough.
        """
        reserves = nearest.reserves(level)
        if nearest.rate < self.target:
            return reserves
        margins = dict(zip(self.names, nearest.nominal.tolist(), strict=True))
        return {name: max(min(reserve, margins[name]), 0.0) for name, reserve in reserves.items()}

    def _keep(
        self, optimisation: Optimisation, draws: _DesignDraws, reserves: dict[str, float]
    ) -> None:
        """Keep this design if it is better than the kept design: in yield, or else in objective."""
        sign = -1.0 if optimisation.design.objective.maximise is not None else 1.0

        def rank(candidate: Optimisation, draws: _DesignDraws) -> tuple[float, float]:
            failure_rate = 1 - draws.rate
            target_failures = AIM * (1 + ROOM / 2) * self.allowed
            return max(failure_rate - target_failures, 0.0), sign * candidate.best_objective

        if rank(optimisation, draws) <= rank(self.best, self.draws):
            self.best, self.draws, self.reserves = optimisation, draws, reserves

    def result(self) -> Optimisation:
        """Return the final design, verified by independent draws, with the cost of each limit."""
        optimisation, reserves, draws = self._last()
        if self.ordinary.choices is not None:
            choices = self.ordinary.choices
            words = f"{choices.sentence}; the options were compared without margins for scatter"
            optimisation = replace(optimisation, choices=replace(choices, sentence=words))
        count = round(float(np.clip(200 / self.allowed, 10_000, 400_000)))
        rate = _covered_rate(draws.model, self.covered, count, self.seed)
        outcome = Robust(
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
        outcome = replace(outcome, sentence=self._words(outcome, optimisation))
        if optimisation.certificate is not None:
            optimisation = replace(optimisation, certificate=self._proven(optimisation.certificate))
        if outcome.reached and not self.infeasible:
            return replace(optimisation, robust=outcome)
        sentence = f"the yield is below the requested {_percent(self.target)}"
        if self.infeasible:
            none = _no_design_meets(optimisation)
            sentence = f"{none} all requirements with the margins that this yield needs"
        remedy = f"{optimisation.remedy or 'relax a requirement'}, or request a lower yield"
        return replace(optimisation, robust=outcome, sentence=sentence, remedy=remedy)

    def _last(self) -> tuple[Optimisation, dict[str, float], _DesignDraws]:
        """Return the best feasible design, or else the nearest, with its reserves and draws."""
        if self.draws.rate >= self.target:
            self.infeasible = {}
        reserves = self.infeasible or self.reserves
        optimisation = self.search(replace(self.subject, reserves=reserves), True)
        draws = self._drawn(optimisation.best, self.covered)
        if self.infeasible and draws.rate >= self.target:
            available = self._nearer(draws, self.level.value)
            retried = self.search(replace(self.subject, reserves=available), True)
            if _solved(retried):
                self.infeasible = {}
                return retried, available, self._drawn(retried.best, self.covered)
        return optimisation, reserves, draws

    def _proven(self, certificate: Certificate) -> Certificate:
        """Return the certificate with the remark that its bound does not include the reserves."""
        if certificate.lower_bound is None:
            return certificate
        words = "the bound applies to the limits themselves, without margins added for scatter"
        if self.ordinary.choices is not None:
            words += ", and for the chosen options only"
        return replace(certificate, sentence=f"{certificate.sentence}; {words}")

    def _shortfalls(self) -> str:
        """Name the limits whose required reserve most exceeds the margin of the kept design."""
        margins = dict(zip(self.names, self.draws.nominal, strict=True))
        shortfalls = sorted((margins[x] - reserve, x) for x, reserve in self.infeasible.items())
        limits_named = [
            f"{x} {100 * self.infeasible[x]:.2g} %"
            for shortfall, x in shortfalls[:3]
            if shortfall < 0
        ]
        return ", ".join(limits_named) or "those below"

    def _words(self, outcome: Robust, optimisation: Optimisation) -> str:
        quantity = of_metric(optimisation.objective_metric)
        before, after = (
            quantity.text(x, 5) for x in (outcome.nominal_objective, optimisation.best_objective)
        )
        yield_text = (
            f"{_percent(outcome.rate)} ({_percent(outcome.lower)} to {_percent(outcome.upper)})"
        )
        cost = (
            f"{quantity.label} is {after}; without margins for scatter it is {before}, at a "
            f"yield of {_percent(outcome.nominal_rate)}"
        )
        remarks = ""
        if self.ordinary.choices is not None:
            remarks = (
                "; the chosen options are those of the optimum without margins for scatter: try "
                "other options with --set"
            )
        if outcome.left_out:
            missed = ", ".join(outcome.left_out)
            remarks += (
                "; the yield does not include these limits, which the optimum misses even "
                f"without scatter: {missed}"
            )
        if self.infeasible:
            return (
                f"{_no_design_meets(optimisation)} the limits with the margins that a yield of "
                f"{_percent(self.target)} requires because of scatter ({self._shortfalls()}). The "
                f"design shown meets all limits in {yield_text} of {outcome.samples} "
                f"independent draws; without margins for scatter {quantity.label} is {before} "
                f"at a yield of {_percent(outcome.nominal_rate)}{remarks}. The suggested "
                "changes assume these margins. As the required margins grow when a limit is "
                "relaxed, apply the changes and optimise again"
            )
        if not outcome.reached:
            return (
                f"the margins added for scatter did not converge in {len(outcome.rounds) - 1} "
                f"rounds: all limits are met in {yield_text} of {outcome.samples} independent "
                f"draws, less than the {_percent(self.target)} requested; {cost}{remarks}"
            )
        remark = "" if self.converged else ", though the margins added for scatter did not converge"
        return (
            f"all limits are met in {yield_text} of {outcome.samples} independent draws "
            f"(requested: {_percent(self.target)}){remark}; {cost}{remarks}"
        )


def _no_design_meets(optimisation: Optimisation) -> str:
    """Return the beginning of a sentence: "no design of these sizes meets ..."."""
    sizes = "" if optimisation.rounding is None else f" of {optimisation.rounding.name}"
    return f"no design{sizes} meets"


def _solved(optimisation: Optimisation) -> bool:
    """Whether an optimisation succeeded: all limits met with their reserves, in requested sizes."""
    infeasible = optimisation.status == "infeasible" or optimisation.status.startswith("limit_inf")
    usable = optimisation.status != "undefined" and not optimisation.status.startswith(
        "interrupted"
    )
    rounded = optimisation.rounding is None or optimisation.rounding.met
    return not infeasible and usable and rounded and optimisation.evaluation.met


def _covered_rate(model: UncertainModel, covered: Array, count: int, seed: int) -> Rate:
    """Return how often independent draws meet all limits that the yield covers."""
    model.own = covered
    return draw(model, count, seed, stream=1).rates()[-2]


def _percent(share: float) -> str:
    return f"{100 * share:.4g} %"
