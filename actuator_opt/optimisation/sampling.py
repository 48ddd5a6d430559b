"""The global phase: a low-discrepancy sweep of the box, and its best starts.

A scrambled Halton sequence [Halton1960] [Owen2017]: the radical inverse of the index in one
prime base per variable, with seeded random digit permutations. It costs microseconds per
thousand points and needs neither tables nor SciPy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .evaluator import CHUNK, Evaluator, LimitReached
from .problem import Vector

KEEP = 256
"""Number of best points kept as candidate starts."""


def primes(count: int) -> list[int]:
    """Return the first `count` primes."""
    found: list[int] = []
    candidate = 2
    while len(found) < count:
        if all(candidate % p for p in found if p * p <= candidate):
            found.append(candidate)
        candidate += 1
    return found


class Halton:
    """Scrambled Halton points in the unit cube, the same for the same seed."""

    def __init__(self, dimension: int, seed: int, most: int = 2**31) -> None:
        generator = np.random.default_rng(seed)
        self.tables: list[Vector] = []
        for base in primes(dimension):
            digits = 1
            while base**digits < most:
                digits += 1
            order = generator.permuted(np.tile(np.arange(base), (digits, 1)), axis=1)
            self.tables.append(order * float(base) ** -np.arange(1, digits + 1)[:, None])
        self.shift = generator.random(dimension)  # the remaining digits, as one remainder
        self.most = most

    def points(self, first: int, count: int) -> Vector:
        """Points (dimension, count) from index `first`."""
        result = np.empty((len(self.tables), count))
        for row, table, shift in zip(result, self.tables, self.shift, strict=True):
            base = table.shape[1]
            index = np.arange(first, first + count)
            total = np.full(count, shift * float(base) ** -len(table))
            for digit in table:
                if not index[-1]:
                    total += digit[0]
                    continue
                index, remainder = np.divmod(index, base)
                total += digit[remainder]
            row[:] = total
        return np.minimum(result, 1.0 - 2**-53)


@dataclass(frozen=True)
class Sweep:
    """Result of a sweep of the box.

    Parameters
    ----------
    z : candidates (nf, k), the best first: least violation, then least objective
    violation, objective : of the candidates (k,)
    count, valid, feasible : points swept, points with finite values, feasible points
    spread : largest minus smallest objective seen, relative to its largest magnitude
    scale : largest magnitude among the candidates' objectives
    """

    z: Vector
    violation: Vector
    objective: Vector
    count: int
    valid: int
    feasible: int
    spread: float
    scale: float


def sweep(evaluator: Evaluator, samples: int, seed: int) -> Sweep:
    """Evaluate `samples` low-discrepancy points of the box, in chunks, and rank the best."""
    space = evaluator.space
    sequence = Halton(space.size, seed, most=max(2, samples))
    width = (space.upper - space.lower)[:, None]
    kept = (np.empty((space.size, 0)), np.empty(0), np.empty(0))
    count = valid = feasible = 0
    low, high = np.inf, -np.inf
    for first in range(0, samples, CHUNK):
        try:
            evaluator.check_limits()
        except LimitReached:
            break
        size = min(CHUNK, samples - first)
        z = space.lower[:, None] + width * sequence.points(first, size)
        rows = evaluator.batch(z)
        violation = evaluator.violations(rows, "sum")
        good = np.isfinite(violation)
        count, valid = count + size, valid + int(good.sum())
        feasible += int((violation == 0).sum())
        z, violation, objective = z[:, good], violation[good], rows[0, good]
        low = min(low, objective.min(initial=np.inf))
        high = max(high, objective.max(initial=-np.inf))
        merged = [
            np.concatenate(p, axis=-1) for p in zip(kept, (z, violation, objective), strict=True)
        ]
        order = np.lexsort((merged[2], merged[1]))[:KEEP]
        kept = (merged[0][:, order], merged[1][order], merged[2][order])
    largest = max(abs(low), abs(high)) if valid else 0.0
    spread = (high - low) / largest if largest > 0 else 0.0
    scale = float(np.abs(kept[2]).max(initial=0.0))
    return Sweep(*kept, count, valid, feasible, float(spread), scale)


def distinct(evaluator: Evaluator, z: Vector, wanted: int) -> list[Vector]:
    """Up to `wanted` distinct points of the ranked candidates (nf, k)."""
    space = evaluator.space
    unit = (z - space.lower[:, None]) / (space.upper - space.lower)[:, None]
    chosen: list[int] = []
    distance = 0.25 * np.sqrt(space.size)
    while len(chosen) < wanted and distance > 1e-3:
        for k in range(unit.shape[1]):
            if len(chosen) >= wanted:
                break
            gaps = unit[:, chosen] - unit[:, k : k + 1]
            if not chosen or np.sqrt((gaps**2).sum(axis=0)).min() >= distance:
                chosen.append(k)
        distance /= 2
    return [z[:, k].copy() for k in chosen]
