"""Warm re-solves of a session against cold ones; run by hand.

    python benchmarks/session.py DESIGN.yaml [MORE.yaml ...] [--moves N] [--seed N] [--cold N]

Each move changes one to three priced numbers at random by up to 2 %. The warm optimum must agree
with the cold one to 1e-6 or be better, and there must be one wherever the cold search finds one.
Exit status 1 where a move fails. Then a table of times, medians and 95 % quantiles, as shares of
one cold `optimise(prices=False)` in the same run. All are processor time, which a busy machine
disturbs least.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

import actuator_opt as ao
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.solver import solve

SAME = 1e-6
"""Relative difference of two objectives that is none."""

MOST = 0.02
"""Largest relative change of a number."""

MOVED = 3
"""Most numbers changed at once."""

REACH = 0.25
"""Half width of the curve, as a share of its number."""

GOALS = {"warm solve": 0.04, "10 prices": 0.085, "curve of 21 values": 0.4}
"""Goals, as shares of one cold solve."""


class Move(NamedTuple):
    """A random move: what changed, the warm and the cold objective; None where none is found."""

    changes: dict[str, float]
    warm: float | None
    cold: float | None
    seconds: float
    how: str

    @property
    def verdict(self) -> str:
        """How the warm optimum compares."""
        if self.warm is None or self.cold is None:
            return "same" if self.warm is self.cold else "FAILED" if self.warm is None else "better"
        if abs(self.warm - self.cold) <= SAME * abs(self.cold):
            return "same"
        return "WORSE" if self.warm > self.cold else "better"


def moves(
    file: str, session: ao.Session, paths: list[str], count: int, seed: int
) -> Iterator[Move]:
    """Random moves, each solved warm and cold; an objective that is maximised counts negative."""
    random = np.random.default_rng(seed)
    goal = session.optimum.design.objective
    sign = 1.0 if goal.maximise is None else -1.0
    present = {path: ao.read(file).subject().numbers[path] for path in paths}
    for _ in range(count):
        chosen = random.choice(
            paths, size=min(len(paths), random.integers(1, MOVED + 1)), replace=False
        )
        changes = {str(path): present[path] * (1 + random.uniform(-MOST, MOST)) for path in chosen}
        began = time.process_time()
        warm = session.solve(changes)
        seconds = time.process_time() - began
        problem = build(ao.read(file).changed(changes).subject()).problem
        cold = solve(problem, starts=6, samples=2048, seed=0)
        yield Move(
            changes,
            sign * warm.objective_value if warm.status == "optimal" else None,
            cold.objective if cold.feasible else None,
            seconds,
            warm.algorithm,
        )


def timed(work: Callable[[], Any]) -> float:
    """Processor time of a call [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


def priced(file: str, session: ao.Session) -> list[str]:
    """The numbers in the price table of a design that the session can price."""
    rows = ao.optimise(file).sensitivities
    return [row.parameter for row in rows if row.limit and row.parameter in _numbers(session)]


def _numbers(session: ao.Session) -> set[str]:
    design = session.optimum.design
    return set(ao.Actuator(design).subject().numbers) - set(design.variables)


def table(
    file: str, session: ao.Session, paths: list[str], solves: list[float], cold: float
) -> None:
    """Print times as shares of a cold solve."""
    first = paths[0]
    value = ao.read(file).subject().numbers[first]
    rows = {
        "with its evaluation": solves,
        "warm solve": [
            timed(lambda k=k: session.bare_optimum({first: value * (1 + k / 1000)}))
            for k in range(-9, 10, 2)
        ],
        "prediction": [
            timed(lambda k=k: session.predict({first: value * (1 + k / 1000)})) for k in range(20)
        ][1:],
        "all prices": [timed(lambda: _anew(session).prices(paths))],
        "10 prices": [timed(lambda: _anew(session).prices(paths[:10]))],
        "curve of 21 values": [
            timed(lambda: session.curve(first, list(np.linspace(1 - REACH, 1 + REACH, 21) * value)))
        ],
    }
    print(f"  cold {1e3 * cold:.0f} ms; curve of {first}")
    for name, seconds in rows.items():
        low, high = np.quantile(seconds, [0.5, 0.95])
        goal = f"  goal {GOALS[name]}" if name in GOALS else ""
        print(f"  {name:20} {1e3 * low:8.1f} ({1e3 * high:.1f}) ms  {low / cold:.4f} of cold{goal}")


def _anew(session: ao.Session) -> ao.Session:
    """The session without the derivatives it has calculated."""
    session._warm._responses.clear()
    session._warm._optimum = None
    return session


def main() -> int:
    """Run the moves and print the table of every design; the number of moves that fail decides."""
    parser = argparse.ArgumentParser()
    parser.add_argument("designs", nargs="+")
    parser.add_argument("--moves", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cold", type=int, default=3, help="cold solves timed")
    asked = parser.parse_args()
    wrong = 0
    for file in asked.designs:
        wrong += judged(file, asked.moves, asked.seed, asked.cold)
    return int(wrong > 0)


def judged(file: str, count: int, seed: int, cold: int) -> int:
    """Print how the moves of a design end, and the times; the number of moves that fail."""
    alone = [timed(lambda: ao.optimise(file, prices=False)) for _ in range(cold)]
    session = ao.session(file)
    paths = priced(file, session)
    print(f"{file}: {len(paths)} priced numbers, {count} moves", flush=True)
    verdicts: dict[str, int] = {}
    hows: dict[str, int] = {}
    seconds = []
    for number, move in enumerate(moves(file, session, paths, count, seed)):
        verdicts[move.verdict] = verdicts.get(move.verdict, 0) + 1
        hows[move.how] = hows.get(move.how, 0) + 1
        seconds.append(move.seconds)
        if move.verdict != "same":
            print(f"    {number}: {move.verdict}: {move}", flush=True)
    print(f"  verdicts {verdicts}; by {hows}")
    table(file, session, paths, seconds, float(np.median(alone)))
    return verdicts.get("FAILED", 0) + verdicts.get("WORSE", 0)


if __name__ == "__main__":
    sys.exit(main())
