"""Array library of a sweep's screen: NumPy, or JAX where installed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ..base.errors import Diagnostic, UsageError
from ..base.numeric import Array

Engine: TypeAlias = Literal["numpy", "jax"]
ENGINES: tuple[Engine, ...] = get_args(Engine)

Scores: TypeAlias = Callable[[Array, Array], Array]
"""Estimated objective (n,) of numbers (axes, n) below a bound; infinite where ruled out."""

LEAST = 1024
"""Smallest batch of a compiled function; larger batches double, each compiled once."""


def usable_engine(name: str, *, reduced: bool) -> Engine:
    """Return the named engine, or NumPy where it is not installed.

    Raises
    ------
    UsageError
        an unknown name, or a full sweep, which always uses NumPy
    """
    if name not in ENGINES:
        raise UsageError(Diagnostic(f"--engine {name}: unknown", f"use {' or '.join(ENGINES)}"))
    if name != "numpy" and not reduced:
        message = f"--engine {name} only speeds up sweeps that keep the best designs"
        raise UsageError(Diagnostic(message, "add --reduce best:K, or omit --engine"))
    return "jax" if name == "jax" and array_library("jax") is not np else "numpy"


def array_library(engine: Engine) -> Any:
    """Return the array module of an engine; NumPy where it is not installed."""
    if engine == "jax":
        try:
            import jax.numpy as found
        except (ImportError, RuntimeError):  # not installed, or incompatible versions
            return np
        return found
    return np


def fused(scores: Scores) -> Scores:
    """Wrap a function of JAX arrays for NumPy arrays, compiled in double precision."""
    import jax

    compiled = jax.jit(scores)

    def padded(numbers: Array, limit: Array) -> Array:
        count = numbers.shape[1]
        size = max(LEAST, 1 << (count - 1).bit_length())
        with jax.enable_x64(True):
            found = compiled(np.pad(numbers, ((0, 0), (0, size - count)), mode="edge"), limit)
            return np.broadcast_to(np.asarray(found), size)[:count]

    return padded
