"""Evaluate, optimise and price a design; search a Pareto front."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..design import Design
from .actuator import Actuator, Plugins, answered, located, place
from .reports import ReportArguments, page_of, report_files

if TYPE_CHECKING:
    from ..optimisation.pareto import ParetoFront


from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..base.tables import Displayed
from ..evaluation import Evaluation, PreparedDesign, evaluate as evaluate_subject, prepare
from ..evaluation.plugin import Plugin
from ..evaluation.result import YieldEstimate
from .actuator import as_actuator

if TYPE_CHECKING:
    from ..optimisation.prices import Sensitivity
    from ..optimisation.result import Optimisation
    from ..pages import ReportFile
    from ..rendering.blocks import Page


def evaluate(
    design: Actuator | Design | str | Path, *, plugins: Plugins = (), seed: int | None = None
) -> Evaluation:
    """Every metric, requirement and check of a design.

    Parameters
    ----------
    design : the design
    plugins : the user's own metrics and constraints
    seed : of the draws of a quick yield estimate (`with_yield`); None: no estimate
    """
    actuator = as_actuator(design, plugins)
    evaluation = evaluate_subject(actuator.subject())
    if seed is None:
        return evaluation
    return with_yield(evaluation, plugins=actuator.plugins, seed=seed)


def with_yield(
    evaluation: Evaluation, *, plugins: tuple[Plugin, ...] = (), seed: int = 0
) -> Evaluation:
    """An evaluation with a quick estimate of its yield (`uncertainties.quick`).

    Parameters
    ----------
    evaluation : of a design
    plugins : the user's own metrics it was evaluated with
    seed : of the draws
    """
    from ..uncertainties.study import quick_yield

    subject = replace(prepare(evaluation.design, plugins=plugins), lenient=True)
    return replace(evaluation, yield_estimate=quick_yield(subject, evaluation, seed=seed))


def optimise(
    design: Actuator | Design | str | Path,
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
    certify: bool = False,
    yield_target: float | None = None,
) -> Optimisation:
    """Find the best design; parameters as `optimisation.run.optimise`.

    With a `yield_target`, all limits are met with that probability under the design's uncertain
    inputs (`uncertainties.robust`); `robust` of the result has the details. Without one,
    `best_evaluation` has a quick estimate of its yield (`uncertainties.quick`).
    """
    from ..optimisation.run import optimise as run

    actuator, subject = answered(design, plugins)

    def search(subject: PreparedDesign, last: bool) -> Optimisation:
        return run(
            subject,
            fault=place(actuator),
            algorithm=algorithm,
            starts=starts,
            seed=seed,
            prices=prices and last,
            max_seconds=max_seconds,
            whole_plies=whole_plies,
            standard_sizes=standard_sizes,
            certify=certify and last,
            explain=last,
            keep_interrupted=keep_interrupted,
        )

    with located(actuator):
        if yield_target is None:
            return estimated(search(subject, True), actuator.plugins)
        from ..uncertainties.robust import robust

        return estimated(robust(subject, yield_target, search, seed=seed), actuator.plugins)


def estimated(optimisation: Optimisation, plugins: tuple[Plugin, ...]) -> Optimisation:
    """An optimum with its yield: from its own sample, else a quick estimate."""
    best, sample = optimisation.best_evaluation, optimisation.robust
    if sample is not None:
        known = YieldEstimate(
            value=sample.rate,
            lower=sample.lower,
            upper=sample.upper,
            draws=sample.samples,
            with_checks=None if sample.left_out else sample.rate,
        )
        best = replace(best, yield_estimate=known)
    elif optimisation.status.startswith("interrupted"):
        best = replace(best, yield_estimate=YieldEstimate(why="the search was interrupted"))
    else:
        best = with_yield(best, plugins=plugins, seed=optimisation.seed)
    if optimisation.made is None:
        return replace(optimisation, evaluation=best)
    return replace(optimisation, rounding=replace(optimisation.made, evaluation=best))


def sensitivity(
    design: Actuator | Design | str | Path, *, seed: int = 0, plugins: Plugins = ()
) -> tuple[Sensitivity, ...]:
    """Prices of requirements and parameters at the design's optimum."""
    return optimise(design, seed=seed, plugins=plugins).sensitivities


@dataclass(frozen=True, slots=True)
class Prices(Displayed):
    """The prices of an optimum, as shown by `sensitivity`."""

    optimisation: Optimisation

    def to_dict(self) -> dict[str, Any]:
        """The `sensitivity --json` object; prices are of the continuous optimum."""
        data = replace(self.optimisation, rounding=None).to_dict()
        keys = ["name", "version", "status", "outcome", "objective", "sensitivities"]
        keys += ["what_buys_most", "kkt", "infeasibility"]
        return {key: data[key] for key in keys if key in data}

    def page(self) -> Page:
        """Prices and movements, or why there is no optimum."""
        from ..pages.report import prices_page

        return prices_page(self.optimisation)

    def report(self, **paper: Any) -> list[ReportFile]:
        """Write the report of the optimum."""
        from .reports import report_design

        return report_design(self.optimisation, **paper)


def pareto(
    design: Actuator | Design | str | Path,
    objectives: Sequence[str],
    *,
    n: int = 50,
    seed: int = 0,
    checks: int = 3,
    plugins: Plugins = (),
) -> ParetoFront:
    """Evenly spread designs of the Pareto front, with the knee.

    Parameters
    ----------
    design : as `optimise`
    objectives : two to four of ``METRIC:min`` or ``METRIC:max``
    n : designs requested
    seed : same seed, same front
    checks : independent searches between designs, which reveal merely local ones
    plugins : the user's metrics and constraints
    """
    from ..optimisation.pareto import pareto as run

    actuator, subject = answered(design, plugins)
    with located(actuator):
        return run(subject, objectives, count=n, seed=seed, checks=checks, fault=place(actuator))


def write_front_csv(front: ParetoFront, path: str | Path) -> ReportFile:
    """Write the designs of a front as CSV, units in the header."""
    from ..pages.pareto import series
    from ..rendering.series import write_csv

    return write_csv(series(front), Path(path))


def write_front(front: ParetoFront, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
    """Write the page of a front (PDF and PNG) and its figure (PNG and SVG).

    A front without designs writes nothing. Parameters as `report`.
    """
    from ..pages.pareto import front_figure, front_outcome, page
    from ..rendering import paper as printed
    from ..rendering.paper import write_ink

    if not front.points:
        return []
    origin, place = page_of(front.subject, "_pareto", **paper)
    files = printed.write(page(front), origin, result=front_outcome(front), **place)
    pictures = write_ink(front_figure(front), place["folder"], f"{place['stem']}_figure")
    return files + report_files(pictures)
