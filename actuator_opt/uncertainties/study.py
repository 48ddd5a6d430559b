"""Uncertainty study: draw the uncertain inputs; estimate yield, indices and tornado."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from ..base.cluster import HERE, Cluster
from ..base.dataclass import dataclass
from ..base.errors import ActuatorError
from ..base.progress import tell
from ..evaluation import Evaluation, PreparedDesign
from ..evaluation.build import spec_hash
from ..evaluation.film import films_asked
from ..evaluation.kernel import with_few_samples
from ..evaluation.result import YieldEstimate
from ..optimisation.problem import Vector
from ..version import VERSION
from .estimate import Rate, exact, indices, quasi, replicated
from .inputs import CHUNK, Input, UncertainModel, chunks, inputs
from .result import LEAST, Index, LimitYield, StoredDraws, Swing, Uncertainty, number


def _notes(subject: PreparedDesign, uncertain_inputs: Sequence[Input]) -> Iterator[str]:
    """Yield notes on which inputs scatter in the study, and which do not."""
    drawn_paths = {entry.path for entry in uncertain_inputs}
    strengths = sorted(path for path in drawn_paths if "strength" in path)
    if not uncertain_inputs:
        yield (
            "no input is uncertain, so the yield is 100 % if the nominal design meets all "
            "requirements, and 0 % if not"
        )
    yield (
        "strengths do not scatter in this study: they stay at their allowables, with all "
        "knock-downs, so the estimated share of good parts is conservative"
        if not strengths
        else (
            "these strengths scatter, so the knock-down for their statistical basis, which "
            f"covers the same scatter, is left out: {', '.join(strengths)}; all other "
            "strengths stay at their allowables"
        )
    )
    yield (
        "squeeze, gland fill and extrusion gap are checked at the worst tolerances of ring "
        "and gland, so these tolerances do not scatter in addition"
    )
    for path in sorted(drawn_paths):
        place, _, last = path.rpartition(".")
        twice = {"section": "section_tolerance", "squeeze": "tolerance"}.get(last)
        if twice and place.startswith("seals.") and subject.numbers.get(f"{place}.{twice}", 0.0):
            yield (
                f"{path} scatters, but {place}.{twice}, at its worst value, already covers "
                f"the same scatter: to count it only once, set {place}.{twice} to 0"
            )
    yield "all inputs scatter independently, even properties of the same material"
    practice = [entry.path for entry in uncertain_inputs if entry.origin == "practice"]
    if practice:
        yield (
            "scatter assumed from common practice, without a verified source: "
            f"{', '.join(practice)}; state your own values in the block uncertainty"
        )
    if films_asked(subject.design):
        yield (
            "the effect of the uncertain inputs on oil films is linearised and limited "
            "to the range of the film tables"
        )


COUNT = 10_000
"""Default number of draws for the yield."""
ROWS = 1024
"""Default size of the base sample for the sensitivity indices; each point takes (inputs + 2)
evaluations."""
BLOCKS = 16
"""Number of independent randomisations of quasi-random draws."""
MOST_KEPT = 16_384
"""Maximum number of draws that are stored for quantiles, figures and tables. As the draws are
independent, a part of them gives unbiased results."""
ENDS = (0.05, 0.95)
"""Cumulative probabilities at which the tornado evaluates an input."""
POINTS = (0.01, 0.05, 0.5, 0.95, 0.99)
"""Cumulative probabilities at which margins are reported."""


RECORDED_FROM = 5000
"""Smallest number of draws for which recording the models saves time (our choice: recording costs
as much as some 2000 draws)."""


def uncertainty(
    subject: PreparedDesign,
    *,
    count: int = COUNT,
    seed: int = 0,
    quasi_random: bool = False,
    rows: int = ROWS,
    metrics: Sequence[str] = (),
    cluster: Cluster = HERE,
) -> Uncertainty:
    """Run an uncertainty study of a design.

    Parameters
    ----------
    subject : the prepared design
    count : number of draws for the yield
    seed : the same seed gives the same draws
    quasi_random : whether to draw scrambled Sobol points, in `BLOCKS` randomisations
    rows : size of the base sample for the sensitivity indices; 0 to omit them
    metrics : metrics to evaluate in addition to the margins; default: those of the objective
    cluster : workers for the chunks of draws and the randomisations of the indices; the rest, a few
        evaluations, runs in this process

    Raises
    ------
    InputError
        if an entry of ``uncertainty`` is invalid, or one of `metrics` does not apply to the design
    """
    began = time.perf_counter()
    uncertain_inputs = inputs(subject)
    model = UncertainModel(subject, uncertain_inputs, metrics or subject.design.objective.metrics)
    if count + rows * (len(uncertain_inputs) + 2) >= RECORDED_FROM:
        model.record()
    nominal = model.flat(model.nominal)[:, 0]  # before the model is sent: the first call records it
    blocks = BLOCKS if quasi_random else 1
    counts = draw(model, count, seed, blocks, cluster=cluster)
    rates = counts.rates()
    outputs = [*(limit.name for limit in model.limits), LEAST, *model.metrics]
    sensitivity_indices, dropped = _indices(model, outputs, rows, seed, cluster)
    return Uncertainty(
        name=subject.design.name,
        version=VERSION,
        spec_hash=spec_hash(subject),
        inputs=uncertain_inputs,
        count=counts.per_block * blocks,
        method=(f"scrambled Sobol points, {blocks} randomisations")
        if quasi_random
        else "independent draws",
        seed=seed,
        rate=rates[-2],
        rate_checks=rates[-1],
        limits=_limits(model, rates, counts.kept, nominal),
        nominal={name: number(x) for name, x in zip(outputs, nominal, strict=True)},
        units={name: subject.quantities[name].si_unit for name in model.metrics},
        indices=sensitivity_indices,
        swings=_swings(model, outputs),
        index_rows=rows,
        dropped=dropped,
        kept=counts.kept,
        notes=tuple(_notes(subject, uncertain_inputs)),
        seconds=time.perf_counter() - began,
    )


@dataclass(frozen=True, slots=True)
class HitCounts:
    """Numbers of draws that meet each limit, all requirements, and all limits, by block.

    A block is one randomisation of the quasi-random points, or all independent draws. `hits` is
    (m + 2, blocks): a row for each of m limits, a row for all requirements and a row for all
    limits. `per_block` is the number of draws in each block.
    """

    hits: Vector
    per_block: int
    kept: StoredDraws

    def rates(self) -> list[Rate]:
        """Return the probability that follows from each row of counts."""
        if self.hits.shape[1] == 1:
            return [exact(int(row[0]), self.per_block) for row in self.hits]
        return [replicated(row, self.per_block) for row in self.hits]


def draw(
    model: UncertainModel,
    count: int,
    seed: int,
    blocks: int = 1,
    stream: int = 0,
    keep: int = MOST_KEPT,
    cluster: Cluster = HERE,
) -> HitCounts:
    """Draw the inputs and count how often each limit is met.

    Parameters
    ----------
    model : design with its uncertain inputs
    count : number of draws
    seed, stream : seed and number of the stream; two streams of one seed are independent
    blocks : number of randomisations of quasi-random points; 1 for independent draws
    keep : maximum number of draws to store
    cluster : workers for the chunks
    """
    size, limits = len(model.inputs), len(model.limits)
    per_block = count if blocks == 1 else 1 << max(0, int(np.ceil(np.log2(count / blocks))))
    hits = np.zeros((limits + 2, blocks))
    stored: list[tuple[Vector, Vector]] = []
    count_drawn = 0

    def tasks() -> Iterator[tuple[Vector, int]]:
        space = keep
        for block in range(blocks):
            for points in _points(size, per_block, (seed, 2 + stream, block), blocks > 1):
                yield points, max(space, 0)
                space -= points.shape[1]

    for chunk_hits, count_in_chunk, values, margins in cluster.map(partial(_met, model), tasks()):
        hits[:, count_drawn // per_block] += chunk_hits
        if values.shape[1]:
            stored.append((values, margins))
        count_drawn += count_in_chunk
        tell("draws", count_drawn / (per_block * blocks))
    values, margins = (np.concatenate(part, axis=1) for part in zip(*stored, strict=True))
    return HitCounts(hits, per_block, StoredDraws(values, margins))


def _met(model: UncertainModel, task: tuple[Vector, int]) -> tuple[Vector, int, Vector, Vector]:
    """Evaluate a chunk of draws: points of the unit cube, and how many of them to store.

    Returns the numbers of draws that meet each limit (see `HitCounts`), the number of draws, and
    the inputs and margins of the draws to store.
    """
    points, space = task
    draws = model.at(points)
    met = draws.met
    joint = np.stack([met[model.own].all(axis=0), met.all(axis=0)])
    hits = np.concatenate([met, joint]).sum(axis=1)
    return hits, points.shape[1], draws.values[:, :space], draws.margins[:, :space]


def _points(size: int, count: int, seed: tuple[int, ...], scrambled: bool) -> Iterator[Vector]:
    """Yield points of the unit cube in chunks: independent, or scrambled Sobol points."""
    if scrambled and size:
        yield from chunks(quasi(size, count.bit_length() - 1, seed))
        return
    generator = np.random.default_rng(seed)
    for first in range(0, count, CHUNK):
        yield generator.random((min(CHUNK, count - first), size)).T


def _limits(
    model: UncertainModel, rates: list[Rate], stored: StoredDraws, nominal: Vector
) -> tuple[LimitYield, ...]:
    limit_yields = []
    numbers = model.subject.values()
    for row, limit in enumerate(model.limits):
        limit_yields.append(
            LimitYield(
                name=limit.name,
                metric=limit.metric,
                sense=limit.sense,
                limit=float(np.squeeze(limit.value(numbers))),
                required=bool(model.own[row]),
                margin=number(float(nominal[row])),
                rate=rates[row],
                margins=tuple(number(float(x)) for x in quantiles(stored.margins[row])),
            )
        )
    return tuple(limit_yields)


def quantiles(margins: Vector) -> Vector:
    """Return the quantiles of margins at `POINTS`; a draw without a value counts as the worst."""
    ordered = np.where(np.isnan(margins), -np.inf, margins)
    return np.quantile(ordered, POINTS, method="inverted_cdf")


def _indices(
    model: UncertainModel, outputs: Sequence[str], rows: int, seed: int, cluster: Cluster
) -> tuple[tuple[Index, ...], float]:
    if rows == 0 or not model.inputs:
        return (), 0.0
    estimate = indices(model.outputs, len(model.inputs), rows=rows, seed=seed, cluster=cluster)
    named = tuple(
        Index(entry.path, output, *(number(float(x[i, k])) for x in (
            estimate.first, estimate.total, estimate.first_half, estimate.total_half)))
        for k, output in enumerate(outputs)
        for i, entry in enumerate(model.inputs)
    )  # fmt: skip
    return named, estimate.dropped


def _swings(model: UncertainModel, outputs: Sequence[str]) -> tuple[Swing, ...]:
    """Return the outputs with one input at a time at its quantiles `ENDS`, all others nominal."""
    if not model.inputs:
        return ()
    values = np.repeat(
        np.array([[entry.value] for entry in model.inputs]), 2 * len(model.inputs), 1
    )
    for i, entry in enumerate(model.inputs):
        values[i, 2 * i : 2 * i + 2] = entry.distribution.at(np.array(ENDS))
    outputs_at_ends = model.flat(model.where(values))
    return tuple(
        Swing(
            entry.path, output, *(number(float(outputs_at_ends[k, 2 * i + end])) for end in (0, 1))
        )
        for k, output in enumerate(outputs)
        for i, entry in enumerate(model.inputs)
    )


DRAWS = 500
"""Number of draws for the estimate (our choice: its bounds are then within 4.5 % of the yield, and
it takes a few per cent of the time of an optimisation)."""

MOST_DRAWN = 5000
"""Samples of all duty cycles, above which draws use few of them (our choice: 100 000 would take 45
s)."""


def quick_yield(subject: PreparedDesign, evaluation: Evaluation, *, seed: int = 0) -> YieldEstimate:
    """Estimate the yield of a design from the first `DRAWS` independent draws of `uncertainty`.

    If duty cycles have more than `MOST_DRAWN` samples, few of them count (`with_few_samples`).

    Parameters
    ----------
    subject : the prepared design
    evaluation : evaluation of that design
    seed : the same seed gives the same draws

    Returns
    -------
    the estimate. It contains a reason instead of a value if the nominal design misses a
    requirement, if draws take too long, or if the block ``uncertainty`` is invalid
    """
    if not evaluation.met:
        return YieldEstimate(why="the design itself misses a requirement")
    if not {row.metric for row in evaluation.requirements} <= set(subject.quantities):
        return YieldEstimate(why="the Python functions of the design's custom metrics are missing")
    if films_asked(subject.design):
        return YieldEstimate(why="solving the oil films of the seals takes too long")
    try:
        model = UncertainModel(with_few_samples(subject, MOST_DRAWN), inputs(subject))
        counts = draw(model, DRAWS, seed)
    except ActuatorError as error:
        return YieldEstimate(why=error.diagnostics[0].message)
    *_, requirements, all_limits = rates = counts.rates()
    failure_rates = {
        limit.name: 1 - rate.value
        for limit, rate, required in zip(model.limits, rates, model.own, strict=False)
        if required
    }
    worst = max(failure_rates, key=lambda name: failure_rates[name], default=None)
    checked = all(check.status != "missed" for check in evaluation.checks)
    return YieldEstimate(
        value=requirements.value,
        lower=requirements.lower,
        upper=requirements.upper,
        draws=DRAWS,
        with_checks=all_limits.value if checked else None,
        worst=worst,
        worst_fails=None if worst is None else failure_rates[worst],
    )
