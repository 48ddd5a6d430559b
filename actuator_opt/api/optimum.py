"""Evaluates and optimises a design, computes prices of its limits, and finds Pareto fronts.

A price is the change of the best objective per unit change of a limit or parameter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base.arguments import guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError
from ..base.tables import Displayed
from ..design import Design
from ..evaluation import Evaluation, PreparedDesign, evaluate as evaluate_subject, prepare
from ..evaluation.plugin import Plugin
from ..evaluation.result import YieldEstimate
from .actuator import (
    Actuator,
    Plugins,
    Result,
    as_actuator,
    checked_design,
    fault_of,
    located,
    workers_for,
)
from .reports import ReportArguments, page_of, report_files

if TYPE_CHECKING:
    from ..optimisation.pareto import ParetoFront
    from ..optimisation.price_table import Sensitivity
    from ..optimisation.result import Optimisation
    from ..pages import ReportFile
    from ..rendering.blocks import Page


@guarded
def evaluate(
    design: Actuator | Design | Result | str | Path,
    *,
    plugins: Plugins = (),
    seed: int | None = None,
) -> Evaluation:
    """Compute every metric, requirement and check of a design.

    Parameters
    ----------
    design : the design: a file, its text, a `Design`, an `Actuator`, or the result of `evaluate` or
        `optimise` (its design to build)
    plugins : the user's own metrics and constraints
    seed : seed of the samples for a quick estimate of the yield (see `with_yield`); None: no
        estimate
    """
    actuator = as_actuator(design, plugins)
    evaluation = evaluate_subject(actuator.subject())
    if seed is None:
        return evaluation
    return with_yield(evaluation, plugins=actuator.plugins, seed=seed)


@guarded
def write_duty(evaluation: Evaluation, path: str | Path) -> ReportFile:
    """Write the traces of all duty cycles as CSV, with units in the header.

    Raises
    ------
    UsageError : the design states no duty cycles
    """
    from ..pages.duty import series
    from ..rendering.series import write_csv

    columns = series(evaluation)
    if not columns:
        message = f"{evaluation.name} states no duty cycles"
        raise UsageError(Diagnostic(message, "add duty.cycles to the design, or leave out --csv"))
    return write_csv(columns, Path(path))


def with_yield(
    evaluation: Evaluation, *, plugins: tuple[Plugin, ...] = (), seed: int = 0
) -> Evaluation:
    """Add a quick estimate of the yield to an evaluation (`uncertainties.study.quick_yield`).

    The yield is the probability that an actuator built to the design meets all limits.

    Parameters
    ----------
    evaluation : evaluation of a design
    plugins : the user's own metrics in the evaluation
    seed : seed of the samples
    """
    from ..uncertainties.study import quick_yield

    subject = replace(prepare(evaluation.design, plugins=plugins), lenient=True)
    return replace(evaluation, yield_estimate=quick_yield(subject, evaluation, seed=seed))


@guarded
def optimise(
    design: Actuator | Design | Result | str | Path,
    *,
    algorithm: str = "auto",
    starts: int = 6,
    seed: int = 0,
    plugins: Plugins = (),
    prices: bool = True,
    max_seconds: float | None = None,
    whole_plies: bool = False,
    keep_interrupted: bool = False,
    standard_sizes: bool = False,
    shop: bool = False,
    certify: bool = False,
    yield_target: float | None = None,
    scheduler: str | None = None,
) -> Optimisation:
    """Find the best design: variables and choices within their bounds that meet all limits.

    Parameters
    ----------
    design : the design, as for `evaluate`, with an objective and variables or choices
    algorithm : "auto" or an NLopt name such as ``LD_SLSQP``
    starts : number of local searches, each from one of the best points of a global sweep
    seed : seed of sweep and stochastic algorithms; the same seed gives the same result
    plugins : the user's own metrics and constraints
    prices : whether to compute the prices of requirements and parameters, and to re-optimise with
        each of them changed by ±10 %
    max_seconds : time limit of the search; the best design so far is kept
    whole_plies : whether to find also the best design with whole plies and allowed angles
    keep_interrupted : whether the best design so far is kept after Ctrl-C; not for designs with
        choices
    standard_sizes : whether to find also the best design with standard sizes for all variables that
        have them
    shop : whether to find also the best design whose other variables are in steps of a workshop
    certify : whether to prove how far the design is from the best possible design
    yield_target : probability (0 to 1) with which the optimum shall meet all limits under the
        design's uncertain inputs (`uncertainties.robust`); the result's `robust` has the details.
        None: `best_evaluation` contains a quick estimate of the yield
    scheduler : address of a Dask scheduler, used instead of this process for combinations of
        choices (extra `cluster`)

    Raises
    ------
    InputError : the design has a fault, or neither variables nor choices
    UsageError : an option is invalid, or a scheduler is given for a design without choices
    """
    from ..optimisation.run import optimise as run

    actuator, subject = checked_design(design, plugins)
    if scheduler is not None and not actuator.design.choices:
        message = "--scheduler only speeds up designs with choices, and this design has none"
        raise UsageError(Diagnostic(message, "omit --scheduler"))

    def search(subject: PreparedDesign, last: bool) -> Optimisation:
        return run(
            subject,
            fault=fault_of(actuator),
            algorithm=algorithm,
            starts=starts,
            seed=seed,
            prices=prices and last,
            max_seconds=max_seconds,
            whole_plies=whole_plies,
            standard_sizes=standard_sizes,
            shop=shop,
            certify=certify and last,
            explain=last,
            keep_interrupted=keep_interrupted,
            cluster=cluster,
        )

    with located(actuator), workers_for(actuator, scheduler) as cluster:
        if yield_target is None:
            return estimated(search(subject, True), actuator.plugins)
        from ..uncertainties.robust import robust

        return estimated(robust(subject, yield_target, search, seed=seed), actuator.plugins)


def estimated(optimisation: Optimisation, plugins: tuple[Plugin, ...]) -> Optimisation:
    """Add the yield to an optimum: that of its robust search, or else a quick estimate."""
    best, sample = optimisation.best_evaluation, optimisation.robust
    if sample is not None:
        yield_estimate = YieldEstimate(
            value=sample.rate,
            lower=sample.lower,
            upper=sample.upper,
            draws=sample.samples,
            with_checks=None if sample.left_out else sample.rate,
        )
        best = replace(best, yield_estimate=yield_estimate)
    elif optimisation.status.startswith("interrupted"):
        best = replace(best, yield_estimate=YieldEstimate(why="the search was interrupted"))
    else:
        best = with_yield(best, plugins=plugins, seed=optimisation.seed)
    if optimisation.made is None:
        return replace(optimisation, evaluation=best)
    return replace(optimisation, rounding=replace(optimisation.made, evaluation=best))


@guarded
def sensitivity(
    design: Actuator | Design | Result | str | Path, *, seed: int = 0, plugins: Plugins = ()
) -> tuple[Sensitivity, ...]:
    """Compute the prices of requirements and parameters at the design's optimum.

    A price is the change of the best objective per unit change of a limit or parameter.
    """
    return optimise(design, seed=seed, plugins=plugins).sensitivities


@dataclass(frozen=True, slots=True)
class Prices(Displayed):
    """The prices of requirements and parameters at an optimum, as shown by `sensitivity`."""

    optimisation: Optimisation

    @property
    def in_short(self) -> tuple[str, str]:
        """The number of prices, and the objective of the optimum."""
        optimisation = self.optimisation
        count = len(optimisation.sensitivities)
        return optimisation.design.name, f"{count} prices at {optimisation.objective_text}"

    def to_dict(self) -> dict[str, Any]:
        """The object of `sensitivity --json`; prices are those of the optimum before rounding."""
        data = replace(self.optimisation, rounding=None).to_dict()
        keys = ["name", "version", "status", "outcome", "objective", "sensitivities"]
        keys += ["what_buys_most", "kkt", "infeasibility"]
        return {key: data[key] for key in keys if key in data}

    def page(self) -> Page:
        """The page: the prices and how the optimum moves, or the reason why no optimum exists."""
        from ..pages.report import prices_page

        return prices_page(self.optimisation)

    def report(self, **paper: Any) -> list[ReportFile]:
        """Write the report of the optimum to which the prices belong."""
        from .reports import report_design

        return report_design(self.optimisation, **paper)


@guarded
def pareto(
    design: Actuator | Design | Result | str | Path,
    objectives: Sequence[str],
    *,
    n: int = 50,
    seed: int = 0,
    checks: int = 3,
    plugins: Plugins = (),
    scheduler: str | None = None,
) -> ParetoFront:
    """Search for evenly spread designs on the Pareto front, and for its knee.

    Parameters
    ----------
    design : as for `optimise`
    objectives : two to four of ``METRIC:min`` or ``METRIC:max``
    n : number of designs requested
    seed : seed of the search; the same seed gives the same front
    checks : number of additional independent searches, which reveal designs that are only locally
        best
    plugins : the user's metrics and constraints
    scheduler : address of a Dask scheduler, used instead of this process for the designs between
        the ends of the front and for the checks (extra `cluster`)
    """
    from ..optimisation.pareto import pareto as run

    actuator, subject = checked_design(design, plugins)
    fault = fault_of(actuator)
    with located(actuator), workers_for(actuator, scheduler) as cluster:
        return run(
            subject, objectives, count=n, seed=seed, checks=checks, fault=fault, cluster=cluster
        )


@guarded
def write_front_csv(front: ParetoFront, path: str | Path) -> ReportFile:
    """Write the designs of a front as CSV, with units in the header."""
    from ..pages.pareto import series
    from ..rendering.series import write_csv

    return write_csv(series(front), Path(path))


@guarded
def write_front(front: ParetoFront, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
    """Write the page of a front (PDF and PNG) and its figure (PNG and SVG).

    Nothing is written for a front without designs. Parameters as for `report`.
    """
    from ..pages.pareto import front_figure, front_outcome, page
    from ..rendering import paper as printed
    from ..rendering.paper import write_ink

    if not front.points:
        return []
    origin, fault_of = page_of(front.subject, "_pareto", **paper)
    files = printed.write(page(front), origin, result=front_outcome(front), **fault_of)
    pictures = write_ink(front_figure(front), fault_of["folder"], f"{fault_of['stem']}_figure")
    return files + report_files(pictures)
