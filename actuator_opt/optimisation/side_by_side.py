"""Runs of SLSQP from several starts side by side: one call of the model serves a step of them all.

A call costs little more for many points than for one, but NLopt asks for one point at a time. So
every run has a thread, which waits for its point until all the others wait for theirs. The points
are kept for the evaluator, which then meets them again as the runs are made one after the other:
what is found, and every decision on the way, is that of the runs alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from queue import SimpleQueue
from threading import Thread

import numpy as np

from . import nlopt_wrapper
from .descents import FEASIBLE
from .evaluator import Evaluator, LimitReached, Point
from .problem import Vector

ROUNDS = 60
"""Most points of a run looked at in advance: from a start of the sweep 10 to 60 do."""


def foresee(evaluator: Evaluator, starts: Sequence[Point], *, seed: int, most: int) -> None:
    """Let an evaluator know the points that SLSQP visits from some starts.

    Ends early where the first run meets no requirement, as then the others are not made, and at
    the evaluator's time limit.

    Parameters
    ----------
    evaluator : of the problem; without exact gradients, or with a limit of points, nothing is done
    starts : evaluated points
    seed, most : of the runs
    """
    if len(starts) < 2 or not evaluator.exact or evaluator.max_evaluations is not None:
        return
    asked: SimpleQueue[tuple[int, Vector | None]] = SimpleQueue()
    known: list[Point] = []
    runs = [_Run(k, start, evaluator, asked, known, seed, most) for k, start in enumerate(starts)]
    running = dict(enumerate(runs))
    evaluator.take_slopes(starts)
    try:
        for run in runs:
            run.thread.start()
        for _ in range(ROUNDS):
            wanted = _wanted(asked, running)
            if not wanted or runs[0].hopeless or evaluator.late:
                break
            batch = np.concatenate([evaluator.columns(z[:, None]) for z in wanted.values()], axis=1)
            parts = np.split(evaluator.problem.rows(batch), len(wanted), axis=1)
            for (k, z), part in zip(wanted.items(), parts, strict=True):
                evaluator.foreseen[z.tobytes()] = part
                running[k].answers.put(part)
    finally:
        for run in running.values():
            run.answers.put(None)
        for run in running.values():
            run.thread.join()


def _wanted(
    asked: SimpleQueue[tuple[int, Vector | None]], running: dict[int, _Run]
) -> dict[int, Vector]:
    """The next point of every run that goes on; takes out those that end."""
    wanted = {}
    for _ in range(len(running)):
        k, z = asked.get()
        if z is None:
            running.pop(k).thread.join()
        else:
            wanted[k] = z
    return dict(sorted(wanted.items()))


@dataclass
class _Run:
    """One run in its thread."""

    number: int
    start: Point
    evaluator: Evaluator
    asked: SimpleQueue[tuple[int, Vector | None]]
    known: list[Point]
    seed: int
    most: int
    answers: SimpleQueue[Vector | None] = field(default_factory=SimpleQueue)
    hopeless: bool = False
    """Whether it ended on a point that misses a requirement."""

    def __post_init__(self) -> None:
        self.thread = Thread(target=self.go, daemon=True)

    def go(self) -> None:
        """Run until the end, or until it is told to stop."""
        own = _Asking(self)
        try:
            run = nlopt_wrapper.run(
                own, self.start, "LD_SLSQP", most=self.most, seed=self.seed, known=self.known
            )
            self.hopeless = run.point.violation > FEASIBLE
            if not self.hopeless and run.arrived is None:
                self.known.append(run.point)
        finally:
            self.asked.put((self.number, None))


class _Asking(Evaluator):
    """An evaluator that gets its points from others."""

    def __init__(self, run: _Run) -> None:
        super().__init__(run.evaluator.problem)
        self.complex_works = run.evaluator.complex_works
        self.difference_rows = run.evaluator.difference_rows
        self.run = run
        self._cache[run.start.z.tobytes()] = run.start

    def point(self, z: Vector) -> Point:
        """The evaluated point at z (nf,), once the others have asked for theirs too."""
        found = self._cache.get(z.tobytes())
        if found is not None:
            return found
        self.run.asked.put((self.run.number, z))
        rows = self.run.answers.get()
        if rows is None:
            raise LimitReached
        return self.entered(z, rows)
