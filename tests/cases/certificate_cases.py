"""Relaxations of designs, and designs that meet every limit: what the certificate tests share."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from actuator_opt.design import read_design
from actuator_opt.evaluation import prepare
from actuator_opt.optimisation.actuator import ActuatorProblem, build
from actuator_opt.optimisation.certificate.certify import Relaxed, relax, trace
from actuator_opt.optimisation.certificate.intervals import Box, Layout
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.solver import solve

DESIGNS = Path(__file__).parents[2] / "designs"
HEAVIER = 1.5
"""Objective of the heaviest design that a relaxation must let be, over the best."""


@dataclass(frozen=True)
class Case:
    """A design with its best variables, and the relaxation of all that are not much heavier."""

    actuator: ActuatorProblem
    x: np.ndarray
    objective: float
    relaxed: Relaxed
    layout: Layout
    root: Box

    def atoms(self, x) -> np.ndarray:
        """Every atom of the relaxation at a design."""
        return self.relaxed.atoms(self.actuator, x)

    def designs(self, count: int, seed: int) -> np.ndarray:
        """Designs (count, variables) that meet every limit: random walks from the inside."""
        rng, problem = np.random.default_rng(seed), self.actuator.problem
        starts = [self.x] + [_inside(problem, room, self.x) for room in (0.001, 0.02)]
        walkers = np.repeat(np.stack(starts, axis=1), 60, axis=1)
        found: list[np.ndarray] = []
        for _ in range(30):
            size = 10 ** rng.uniform(-4, -0.7, walkers.shape[1])
            some = rng.random(walkers.shape) < rng.uniform(0.1, 1, walkers.shape[1])
            steps = np.exp(size * some * rng.standard_normal(walkers.shape))
            tried = np.clip(walkers * steps, problem.lower[:, None], problem.upper[:, None])
            rows = np.nan_to_num(problem.rows(tried), nan=-1.0)
            good = (rows[1:] >= 0).all(axis=0) & (rows[0] <= HEAVIER * self.objective)
            walkers[:, good] = tried[:, good]
            found.append(tried[:, good])
        every = np.concatenate(found, axis=1).T
        return np.vstack([self.x, every[rng.permutation(len(every))[: count - 1]]])


def _inside(problem: BoxProblem, room: float, start) -> np.ndarray:
    """The best design with some room at every limit."""

    def evaluate(points) -> PointValues:
        values = problem.evaluate(points)
        return replace(values, constraints=values.constraints - room)

    tighter = replace(problem, evaluate=evaluate, start=start)
    return solve(tighter, starts=1, samples=64).x


@cache
def case(name: str, *changes: tuple[str, str]) -> Case:
    """A design of the repository, with changes of its entries."""
    design = read_design(DESIGNS / f"{name}.yaml", overrides=changes).design
    actuator = build(prepare(design))
    best = solve(actuator.problem, samples=512, starts=3)
    relaxed = relax(trace(actuator, best.x), HEAVIER * best.objective)
    layout = Layout(relaxed.relaxation)
    root = Box.whole(layout).tightened(layout)
    return Case(actuator, best.x, best.objective, relaxed, layout, root)
