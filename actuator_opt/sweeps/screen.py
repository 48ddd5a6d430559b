"""Screen of a sweep: fast closed-form expressions exclude most designs before full evaluation.

The models run once with symbols instead of numbers. The objective and those limits that become
closed-form expressions of the varied numbers are compiled for NumPy, or for JAX if it is chosen and
installed: JAX compiles them into one function, on the processor too. Designs that pass are
evaluated in full, so a screen never changes the result. The models themselves run on a GPU as
recorded programs (`base.symbolic.gpu`), without JAX.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError
from ..base.numeric import Array
from ..base.symbolic import Symbol, vectorised
from ..base.symbolic.expression import needed
from ..design import Design
from ..design.model import Variable
from ..evaluation import prepare
from ..evaluation.build import TOLERANCE
from ..optimisation.actuator import build
from ..optimisation.certificate.certify import TracedLimit, trace
from ..optimisation.certificate.relaxation import Unknown

Engine: TypeAlias = Literal["numpy", "jax", "gpu"]


ENGINES: tuple[Engine, ...] = get_args(Engine)


Scores: TypeAlias = Callable[[Array, Array], Array]
"""Function that estimates the objective of each of n designs, (n,), from their numbers, (axes, n),
with one row per varied number. Excluded designs get inf. The second argument is the objective that
a design must not exceed."""


LEAST_BATCH = 1024
"""Smallest batch of designs for a compiled function. Larger batches double in size, so that the
function is compiled only once for each size."""


def usable_engine(name: str, *, reduced: bool) -> Engine:
    """Return the named engine, or NumPy if JAX is named but not installed.

    Raises
    ------
    UsageError
        if the name is unknown, or the engine does not suit a full or a reduced sweep
    """
    if name not in ENGINES:
        names = f"{', '.join(ENGINES[:-1])} or {ENGINES[-1]}"
        raise UsageError(Diagnostic(f"--engine {name}: unknown", f"use {names}"))
    if name == "jax" and not reduced:
        message = f"--engine {name} only speeds up sweeps that keep the best designs"
        raise UsageError(Diagnostic(message, "add --reduce best:K, or omit --engine"))
    if name == "gpu":
        if reduced:
            message = f"--engine {name} only speeds up sweeps that keep all designs"
            raise UsageError(Diagnostic(message, "omit --reduce or --engine"))
        return "gpu"
    return "jax" if name == "jax" and array_library("jax") is not np else "numpy"


def array_library(engine: Engine) -> Any:
    """Return the array module of an engine; NumPy where it is not installed."""
    if engine == "jax":
        try:
            import jax.numpy as library
        except (ImportError, RuntimeError):  # not installed, or incompatible versions
            return np
        return library
    return np


def fused(scores: Scores) -> Scores:
    """Compile a function of JAX arrays in double precision; the result takes NumPy arrays."""
    import jax

    compiled = jax.jit(scores)

    def padded(numbers: Array, limit: Array) -> Array:
        count = numbers.shape[1]
        size = max(LEAST_BATCH, 1 << (count - 1).bit_length())
        with jax.enable_x64(True):
            scores = compiled(np.pad(numbers, ((0, 0), (0, size - count)), mode="edge"), limit)
            return np.broadcast_to(np.asarray(scores), size)[:count]

    return padded


ROOM = 2 * TOLERANCE
"""A design is excluded if its relative margin to a limit is below minus this value, which exceeds
rounding errors."""

CLOSE = 1e-9
"""Relative tolerance in comparing objectives, which also exceeds rounding errors."""

TEST_POINTS = 512
"""Number of random designs with which the limits that exclude most designs are found."""


@dataclass(frozen=True)
class Limits:
    """Compiled expressions of some limits, with their bounds.

    The sign of a limit is 1 for a lower bound and -1 for an upper bound.
    """

    compiled: Any
    bounds: Array
    signs: Array

    def missed(self, numbers: Array) -> Iterator[Array]:
        """Yield for each limit which designs miss it: (n,), or one value that applies to all."""
        with np.errstate(all="ignore"):
            for value, bound, sign in zip(
                self.compiled(numbers), self.bounds, self.signs, strict=True
            ):
                yield sign * (value - bound) < -ROOM * (abs(bound) or 1.0)


@dataclass(frozen=True)
class Screen:
    """Compiled objective and limits for n designs that differ only in their varied numbers.

    These numbers are arrays (axes, n), with one row per varied number.

    `stages` are groups of limits. Each stage checks only the designs that passed the stages before
    it. The stages are compiled for arrays of `library`.
    """

    objective: Any
    stages: tuple[Limits, ...]
    library: Any = np

    def scores(self, numbers: Array, limit: Array) -> Array:
        """Return the estimated objective of each design, (n,).

        It is inf for a design that misses a limit or whose objective exceeds `limit`, and -inf if
        the estimate is not a number.
        """
        scores = self.bounded_objective(numbers, limit) + np.zeros(numbers.shape[1])
        for stage in self.stages:
            candidates = np.flatnonzero(scores < np.inf)
            passed = np.ones(len(candidates), dtype=bool)
            for missed in stage.missed(numbers[:, candidates]):
                passed &= ~missed
            scores[candidates[~passed]] = np.inf
        return scores

    def bounded_objective(self, numbers: Array, limit: Array) -> Array:
        """Return the objective, (n,) or one value for all designs; it is inf if above `limit`."""
        arrays = self.library
        with np.errstate(all="ignore"):
            objective, *others = self.objective(numbers)
        for other in others:
            objective = arrays.maximum(objective, other)
        objective = arrays.where(arrays.isnan(objective), -np.inf, objective)
        return arrays.where(objective > rounded_up(limit), np.inf, objective)

    def scores_at_once(self, numbers: Array, limit: Array) -> Array:
        """Return `scores`, but check every limit for every design, as compiled code must."""
        scores = self.bounded_objective(numbers, limit)
        for stage in self.stages:
            for missed in stage.missed(numbers):
                scores = self.library.where(missed, np.inf, scores)
        return scores


def rounded_up(objective: Array) -> Array:
    """Return an objective plus a rounding tolerance; designs above the sum are certainly worse."""
    return objective + CLOSE * abs(objective)


def screen(
    design: Design, paths: Sequence[str], ends: Array, engine: Engine = "numpy"
) -> Scores | None:
    """Return a screen for designs whose numbers at `paths` vary between `ends` (axes, 2).

    None if the objective is no closed-form expression of these numbers, or if a number cannot vary
    as an array.
    """
    variables = {
        path: Variable(lower=float(low), upper=float(high), start=float((low + high) / 2))
        for path, (low, high) in zip(paths, ends, strict=True)
    }
    try:
        actuator = build(prepare(design.model_copy(update={"variables": variables})))
        traced = trace(actuator, ends.mean(axis=1))
    except (InputError, Unknown):
        return None
    names = {symbol: f"v[{k}]" for k, symbol in enumerate(traced.variables.values())}
    objectives = list(dict.fromkeys(traced.objectives))
    if not objectives or not all(_is_closed(objective, names) for objective in objectives):
        return None
    claims = list(
        {
            (claim.value, claim.bound, claim.limit.sense): claim
            for claim in traced.claims
            if _is_closed(claim.value, names)
        }.values()
    )
    shares = np.random.default_rng(0).random((len(paths), TEST_POINTS))
    points = ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * shares
    first = _decisive(_limits(claims, names), points) if claims else []
    others = [claim for k, claim in enumerate(claims) if k not in first]
    stages = [[claims[k] for k in first], others]
    library = array_library(engine)
    compiled = Screen(
        vectorised("objective", "v", {}, objectives, known=names, library=library),
        tuple(_limits(stage, names, library) for stage in stages if stage),
        library,
    )
    return compiled.scores if library is np else fused(compiled.scores_at_once)


def _limits(
    claims: Sequence[TracedLimit], names: Mapping[Symbol, str], library: Any = np
) -> Limits:
    values = [claim.value for claim in claims]
    return Limits(
        vectorised("limits", "v", {}, values, known=names, library=library),
        np.array([claim.bound for claim in claims]),
        np.array([1.0 if claim.limit.sense == "min" else -1.0 for claim in claims]),
    )


def _decisive(limits: Limits, points: Array) -> list[int]:
    """Return the indices of a few limits that exclude every point which any limit excludes."""
    missed = np.stack(
        [np.broadcast_to(limit_missed, points.shape[1]) for limit_missed in limits.missed(points)]
    )
    chosen = []
    while missed.any():
        chosen.append(int(missed.sum(axis=1).argmax()))
        missed = missed & ~missed[chosen[-1]]
    return chosen


def _is_closed(value: Any, names: dict[Symbol, str]) -> bool:
    """Whether a value, computed with symbols, depends only on the varied numbers."""
    if not isinstance(value, Symbol):
        return True
    return all(node in names for node in needed([value]) if node.op == "variable")
