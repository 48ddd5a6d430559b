"""Runs of SLSQP from several starts side by side: one call of the model serves a step of them all.

A call costs little more for many points than for one, but NLopt asks for one point at a time. So
every run has a thread, which waits for its point until all the others wait for theirs. The points
are kept for the evaluator, which then meets them again as the runs are made one after the other:
what is found, and every decision on the way, is that of the runs alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from queue import SimpleQueue
from threading import Thread

import numpy as np
import numpy.typing as npt

from . import nlopt_wrapper
from .descents import FEASIBLE
from .evaluator import Evaluator, LimitReached, Point
from .problem import Vector

ROUNDS = 60
"""Most points of a run looked at in advance: from a start of the sweep 10 to 60 do."""


@dataclass(frozen=True)
class Task:
    """Runs of one problem: its evaluator, and the points with slopes that they start from."""

    evaluator: Evaluator
    starts: list[Point]


Rows = Callable[[npt.NDArray[np.complex128], npt.NDArray[np.intp]], npt.NDArray[np.generic]]
"""Rows (rows, k) of points (n, k), each of the task with this index (k,)."""


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
    evaluator.take_slopes(starts)
    task = Task(evaluator, list(starts))
    run_together([task], lambda batch, _: evaluator.problem.rows(batch), seed=seed, most=most)


def run_together(
    tasks: Sequence[Task],
    rows: Rows,
    *,
    seed: int,
    most: int,
    tolerance: float = 1e-9,
    rounds: int = ROUNDS,
) -> list[list[Point]]:
    """The best points that runs of SLSQP end on or get to, for each task and start.

    The evaluators foresee every point visited. Of a task whose first run meets no requirement the
    others are ended there, as all are at the time limit of the first evaluator.

    Parameters
    ----------
    tasks : with exact gradients
    rows : of all of them in one call
    seed, most, tolerance : of the runs
    rounds : most points of a run
    """
    asked: SimpleQueue[tuple[int, Vector | None]] = SimpleQueue()
    runs: list[_Run] = []
    for number, task in enumerate(tasks):
        known: list[Point] = []
        runs += [
            _Run(len(runs) + k, number, start, task.evaluator, asked, known, seed, most, tolerance)
            for k, start in enumerate(task.starts)
        ]
    running = {run.number: run for run in runs}
    firsts = {run.task: run for run in reversed(runs)}
    try:
        for run in runs:
            run.thread.start()
        for _ in range(rounds):
            wanted = _wanted(asked, running)
            for k in [k for k in wanted if firsts[running[k].task].hopeless]:
                del wanted[k]
                _ended(running.pop(k))
            if not wanted or tasks[0].evaluator.late:
                break
            _answer(wanted, running, rows)
    finally:
        for run in running.values():
            run.answers.put(None)
        for run in running.values():
            run.thread.join()
    return [[run.best for run in runs if run.task == k] for k in range(len(tasks))]


def _ended(run: _Run) -> None:
    """Tell a run that waits to stop."""
    run.answers.put(None)
    run.thread.join()
    run.asked.get()


def _answer(wanted: dict[int, Vector], running: dict[int, _Run], rows: Rows) -> None:
    """Give every run the rows at the point it asked for."""
    parts = [running[k].evaluator.columns(z[:, None]) for k, z in wanted.items()]
    sizes = [part.shape[1] for part in parts]
    owners = np.repeat([running[k].task for k in wanted], sizes).astype(np.intp)
    found = rows(np.concatenate(parts, axis=1), owners)
    for (k, z), part in zip(
        wanted.items(), np.split(found, np.cumsum(sizes)[:-1], axis=1), strict=True
    ):
        running[k].evaluator.foreseen[z.tobytes()] = part
        running[k].answers.put(part)


def _wanted(
    asked: SimpleQueue[tuple[int, Vector | None]], running: dict[int, _Run]
) -> dict[int, Vector]:
    """The next point of every run that goes on; takes out those that end, for the others to know.

    All others wait meanwhile, so that every time they know the same.
    """
    wanted, ended = {}, []
    for _ in range(len(running)):
        k, z = asked.get()
        if z is None:
            ended.append(running.pop(k))
        else:
            wanted[k] = z
    for run in sorted(ended, key=lambda one: one.number):
        run.thread.join()
        if run.new:
            run.known.append(run.best)
    return dict(sorted(wanted.items()))


@dataclass
class _Run:
    """One run in its thread."""

    number: int
    task: int
    start: Point
    evaluator: Evaluator
    asked: SimpleQueue[tuple[int, Vector | None]]
    known: list[Point]
    seed: int
    most: int
    tolerance: float
    answers: SimpleQueue[npt.NDArray[np.generic] | None] = field(default_factory=SimpleQueue)
    hopeless: bool = False
    """Whether it ended on a point that misses a requirement."""
    new: bool = False
    """Whether it ended on one that misses none, and is not known."""

    def __post_init__(self) -> None:
        self.best = self.start
        self.thread = Thread(target=self.go, daemon=True)

    def go(self) -> None:
        """Run until the end, or until it is told to stop."""
        own = _Asking(self)
        try:
            run = nlopt_wrapper.run(
                own, self.start, "LD_SLSQP", most=self.most, seed=self.seed, known=self.known,
                tolerance=self.tolerance,
            )  # fmt: skip
            self.best = run.point
            self.hopeless = run.point.violation > FEASIBLE
            self.new = not self.hopeless and run.arrived is None
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
