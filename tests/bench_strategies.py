"""How sure and how quick each strategy of the optimiser is, over problems of known optimum.

Run by hand: ``python tests/bench_strategies.py [PROBLEM ...] [--starts N] [--most N]
[--only STRATEGY,...] [--write FILE]``; the committed result is ``tests/strategies.md``. Every
algorithm runs as ``--algorithm NAME`` gives it, from one random start each time, the same starts
for all; the default strategy runs whole (its own sweep and starts), once per seed. A run succeeds
that meets everything within 1e-6 and comes within 1e-4 of the optimum. The points of the sweep,
which are one batch, are not among the evaluations but in the time.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import numpy as np

if __name__ == "__main__":
    sys.path[0:0] = [
        str(Path(__file__).resolve().parent.parent),
        str(Path(__file__).resolve().parent / "cases"),
    ]

import problems

from actuator_opt import api as verbs
from actuator_opt.base.errors import UsageError
from actuator_opt.optimisation import actuator, nlopt_wrapper, solution
from actuator_opt.optimisation.problem import BoxProblem, Space
from actuator_opt.optimisation.run import SAMPLES
from actuator_opt.optimisation.solver import solve

DESIGNS = Path(__file__).resolve().parent.parent / "designs"
NEAR = 1e-4
"""Relative distance to the known optimum that still counts as found."""
SURE = 0.99
"""Probability of success that effort is counted up to."""
DEAR = {"servo_knee": 10}
"""Designs that get only every so-manieth start: position loops make each evaluation dear."""

ENDLESS = ("LN_NEWUOA_BOUND",)
"""Left out: between two evaluations it can spend minutes inside NLopt, where no limit reaches it
(152 s for 897 evaluations of HS71)."""


@dataclass(frozen=True)
class Case:
    """A problem and its optimum; None where only the best of all runs is known."""

    name: str
    problem: BoxProblem
    optimum: float | None = None


GENERIC: dict[str, tuple[Callable[[], BoxProblem], float]] = {
    "rosen_suzuki": (problems.rosen_suzuki, -44.0),
    "hs71": (problems.hs71, 17.0140173),
    "stepped_cantilever": (lambda: problems.stepped_cantilever().problem, 1.33995636),
    "pressure_vessel": (lambda: problems.pressure_vessel().problem, 5885.332774),
    "piston_lever": (problems.piston_lever, 8.412698323),
    "thrust_bearing": (problems.thrust_bearing, 1625.442759),
    "two_pieces": (problems.two_pieces, 4 - 0.3 * math.sqrt(2)),
}
"""Problems with published or closed optima: makers and optima."""


def shipped() -> list[str]:
    """Names of the shipped designs with variables and without choices, the cheap ones first."""
    designs = {p.stem: verbs.read(p).design for p in sorted(DESIGNS.glob("*.yaml"))}
    names = [name for name, one in designs.items() if one.variables and not one.choices]
    return sorted(names, key=lambda name: DEAR.get(name, 1))


def case(name: str) -> Case:
    """A generic problem or a shipped design by name, without its own start."""
    if name in GENERIC:
        make, optimum = GENERIC[name]
        return Case(name, replace(make(), start=None), optimum)
    built = actuator.build(verbs.read(DESIGNS / f"{name}.yaml").subject())
    return Case(name, replace(built.problem, start=None))


def strategies(problem: BoxProblem) -> list[str]:
    """Every algorithm that suits the problem, within AUGLAG where it takes no constraints."""
    found = ["auto", "auto from one start"]
    for name, algorithm in nlopt_wrapper.ALGORITHMS.items():
        for text in (name, f"AUGLAG+{name}"):
            if name in ENDLESS or (algorithm.scope != "local" and text != name):
                continue
            try:
                found.append(nlopt_wrapper.suit(text, problem))
                break
            except UsageError:
                pass
    return list(dict.fromkeys(found))


def starts(problem: BoxProblem, count: int) -> list[np.ndarray]:
    """Random points of the box where the model has values, the same for every strategy."""
    random, space = np.random.default_rng(0), Space(problem)
    found: list[np.ndarray] = []
    while len(found) < count:
        z = space.lower + random.random(space.size) * (space.upper - space.lower)
        x = space.to_x(z[:, None])
        if np.isfinite(problem.rows(x)).all():
            found.append(x[:, 0])
    return found


@dataclass(frozen=True)
class Trial:
    """One run: what it reached and what that took (processor seconds)."""

    objective: float
    violation: float
    evaluations: int
    seconds: float
    fault: str = ""


def trial(problem: BoxProblem, strategy: str, x: np.ndarray, seed: int, most: int) -> Trial:
    """One run of a strategy; whatever it throws is its result."""
    began = time.process_time()
    given, more = {"samples": SAMPLES}, problem
    if strategy != "auto":
        given, more = (
            {"samples": 0, "starts": 1, "max_evaluations": most},
            replace(problem, start=x),
        )
    try:
        found = solve(more, algorithm=strategy.split()[0], seed=seed, **given)
    except Exception as error:  # that it throws is what the table shall tell
        fault = type(error).__name__
        return Trial(math.inf, math.inf, 0, time.process_time() - began, fault)
    spent = time.process_time() - began
    return Trial(found.objective, found.violation, found.evaluations, spent)


@dataclass(frozen=True)
class Row:
    """What a strategy did on a problem."""

    strategy: str
    runs: int
    successes: int
    evaluations: float
    seconds: float
    faults: str

    @property
    def repeats(self) -> float:
        """Runs needed to find the optimum with probability 0.99."""
        if self.successes in (0, self.runs):
            return 1.0 if self.successes else math.inf
        return max(1.0, math.log(1 - SURE) / math.log(1 - self.successes / self.runs))


def rows(
    known: Case, count: int, most: int, only: Iterable[str] | None = None
) -> tuple[float, list[Row]]:
    """The optimum, and every strategy over the same starts, the least effort first."""
    points = starts(known.problem, count)
    names = list(only or strategies(known.problem))
    trials = {
        name: [trial(known.problem, name, x, k, most) for k, x in enumerate(points)]
        for name in names
    }
    best = known.optimum
    if best is None:
        met = [t.objective for ts in trials.values() for t in ts if t.violation <= solution.MET]
        best = min(met, default=math.nan)

    def row(name: str) -> Row:
        done = trials[name]
        good = [
            t.violation <= solution.MET and t.objective - best <= NEAR * abs(best) for t in done
        ]
        return Row(
            name,
            len(done),
            sum(good),
            median(t.evaluations for t in done),
            median(t.seconds for t in done),
            ", ".join(sorted({t.fault for t in done if t.fault})),
        )

    table = [row(name) for name in names]
    table.sort(key=lambda r: (r.repeats * r.seconds, -r.successes, r.seconds))
    return best, table


def markdown(known: Case, best: float, table: list[Row], most: int) -> str:
    """A problem's table."""
    n, m = len(known.problem.names), len(known.problem.constraint_names)
    e = len(known.problem.equality_names)
    size = f"{n} variables, {m} margins" + (f", {e} equality" if e else "")
    source = "" if known.optimum is not None else " (best of all runs)"
    lines = [
        f"### {known.name}",
        "",
        f"{size}; optimum {best:.9g}{source}; at most {most} evaluations from one start",
        "",
        "| strategy | found | evaluations | time, ms | evaluations to 99 % | time to 99 %, ms |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    for row in table:
        sure = ["-", "-"]
        if row.successes:
            sure = [f"{row.repeats * v:.0f}" for v in (row.evaluations, 1e3 * row.seconds)]
        fault = f" ({row.faults})" if row.faults else ""
        lines.append(
            f"| {row.strategy}{fault} | {row.successes}/{row.runs} | {row.evaluations:.0f} | "
            f"{1e3 * row.seconds:.0f} | {sure[0]} | {sure[1]} |"
        )
    return "\n".join([*lines, ""])


def main() -> None:
    """Run what is asked for; tables to standard output and to the file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("problems", nargs="*", help="default: all generic ones and shipped designs")
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--most", type=int, default=10000, help="evaluations of one run")
    parser.add_argument("--only", help="strategies, with commas between")
    parser.add_argument("--write", type=Path, help="Markdown file")
    asked = parser.parse_args()
    only = asked.only and asked.only.split(",")
    parts = []
    for name in asked.problems or [*GENERIC, *shipped()]:
        known = case(name)
        count = max(2, asked.starts // DEAR.get(name, 1))
        parts.append(markdown(known, *rows(known, count, asked.most, only), asked.most))
        print(parts[-1], flush=True)
    if asked.write is not None:
        asked.write.write_text("\n".join(parts))


if __name__ == "__main__":
    main()
