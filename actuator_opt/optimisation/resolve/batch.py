"""Many solvers side by side: one model call evaluates a step of every one of them.

A solver is a generator: it yields the coordinates of the point it needs, receives that point with
its gradients, and returns its result. Each sees only its own points, so its result is the same
alone or beside others.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Generic, TypeAlias, TypeVar

from ..evaluator import Point
from ..problem import Vector

Result = TypeVar("Result")

Steps: TypeAlias = Generator[Vector, Point, Result]
"""A solver: yields coordinates (nf,), receives the evaluated point, returns its result."""

Answer: TypeAlias = Callable[[Mapping[int, Vector]], Sequence[Point]]
"""Evaluates the point requested by each solver, by number."""


class Batch(Generic[Result]):
    """Solvers under way.

    Parameters
    ----------
    solvers : all of them
    answer : evaluates a point for each solver that asks, in one model call

    Attributes
    ----------
    wanted : the coordinates that the solvers still running ask for, by number
    results : of the solvers that have ended, by number
    """

    def __init__(self, solvers: Sequence[Steps[Result]], answer: Answer) -> None:
        self.wanted: dict[int, Vector] = {}
        self.results: dict[int, Result] = {}
        self._solvers, self._answer = solvers, answer
        for number in range(len(solvers)):
            self._advance(number, None)

    def step(self) -> None:
        """Answer every solver that is still running."""
        wanted, self.wanted = self.wanted, {}
        for number, point in zip(wanted, self._answer(wanted), strict=True):
            self._advance(number, point)

    def drop(self, number: int) -> None:
        """End a solver without a result."""
        del self.wanted[number]
        self._solvers[number].close()

    def _advance(self, number: int, point: Point | None) -> None:
        solver = self._solvers[number]
        try:
            self.wanted[number] = next(solver) if point is None else solver.send(point)
        except StopIteration as end:
            self.results[number] = end.value


def run_batch(solvers: Sequence[Steps[Result]], answer: Answer) -> list[Result]:
    """The result of every solver, in order."""
    batch = Batch(solvers, answer)
    while batch.wanted:
        batch.step()
    return [batch.results[number] for number in range(len(solvers))]
