"""What the screen of a sweep computes with: NumPy, or JAX where it is installed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ..base.errors import Diagnostic, UsageError
from ..base.numeric import Array

Engine: TypeAlias = Literal["numpy", "jax"]
ENGINES: tuple[Engine, ...] = get_args(Engine)

Scores: TypeAlias = Callable[[Array, Array], Array]
"""Objective that numbers (axes, n) promise, (n,), to be below another; infinite where ruled out."""

LEAST = 1024
"""Designs of the smallest call of a compiled function; larger ones double, each compiled once."""


def usable_engine(name: str, *, reduced: bool) -> Engine:
    """The engine of this name, or NumPy where it is not installed.

    Raises
    ------
    UsageError
        there is none of this name, or every row is asked for, which the models make with NumPy
    """
    if name not in ENGINES:
        raise UsageError(Diagnostic(f"--engine {name}: unknown", f"use {' or '.join(ENGINES)}"))
    if name != "numpy" and not reduced:
        message = f"--engine {name} screens designs for their best alone"
        raise UsageError(Diagnostic(message, "add --reduce best:K, or leave it out"))
    return "jax" if name == "jax" and array_library("jax") is not np else "numpy"


def array_library(engine: Engine) -> Any:
    """The arrays of an engine; NumPy's where it is not installed."""
    if engine == "jax":
        try:
            import jax.numpy as found
        except (ImportError, RuntimeError):  # not there, or parts that do not fit together
            return np
        return found
    return np


def fused(scores: Scores) -> Scores:
    """A function of JAX arrays as one of NumPy arrays, compiled for JAX's device in doubles."""
    import jax

    compiled = jax.jit(scores)

    def padded(numbers: Array, limit: Array) -> Array:
        count = numbers.shape[1]
        size = max(LEAST, 1 << (count - 1).bit_length())
        with jax.enable_x64(True):
            found = compiled(np.pad(numbers, ((0, 0), (0, size - count)), mode="edge"), limit)
            return np.broadcast_to(np.asarray(found), size)[:count]

    return padded
