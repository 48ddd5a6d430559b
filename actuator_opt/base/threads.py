"""Linear algebra on one thread while a public function of the library runs.

The program's dense problems are small: 18 states, 30 variables, a few hundred nodes. OpenBLAS
splits even these among threads, which wait for each other on cores that other processes use too.
With four busy processes on two cores, a motor servo was tuned and simulated in 0.2 s on one thread,
and in 0.75 to 1.1 s on OpenBLAS' usual number. The command line sets the environment before NumPy
is imported. A library must not change the environment of its host, so it limits OpenBLAS only while
it runs, and restores the number afterwards.

A user who states a number of threads in the environment keeps it. Other libraries, such as MKL,
split small problems less and are left as they are.
"""

from __future__ import annotations

import ctypes
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

STATED: Final = ("OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS")
"""Environment variables by which OpenBLAS takes the number of threads of its user."""
_NAMES: Final = ("scipy_openblas_{}_num_threads64_", "scipy_openblas_{}_num_threads")
"""Names of the functions in the wheels of NumPy and SciPy, with 64-bit and 32-bit integers."""
_FOLDERS: Final = {
    "numpy": ("numpy.libs", "numpy/.dylibs"),
    "scipy": ("scipy.libs", "scipy/.dylibs"),
}
"""Folders of the libraries in a wheel (Linux and Windows, macOS), by package."""
_LOADED: Final = {"numpy": "numpy", "scipy": "scipy.linalg"}
"""For each package, the module whose import loads its library."""


class _Library(NamedTuple):
    get: Callable[[], int]
    set: Callable[[int], object]


@cache
def _library(package: str) -> _Library | None:
    """OpenBLAS as loaded by a package; None if the package has another library."""
    root = Path(str(sys.modules[package].__file__)).parents[1]
    for folder in _FOLDERS[package]:
        for file in sorted((root / folder).glob("*openblas*")):
            try:
                loaded = ctypes.CDLL(str(file), mode=getattr(os, "RTLD_NOLOAD", 0))
            except OSError:
                continue
            for name in _NAMES:
                functions = [getattr(loaded, name.format(verb), None) for verb in ("get", "set")]
                if None not in functions:
                    return _Library(*functions)  # type: ignore[arg-type]
    return None


def libraries() -> list[_Library]:
    """OpenBLAS libraries that are loaded now."""
    if any(name in os.environ for name in STATED):
        return []
    found = (_library(name) for name, module in _LOADED.items() if module in sys.modules)
    return [one for one in found if one is not None]


_lock = threading.Lock()
_depth = 0
_before: list[tuple[_Library, int]] = []


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit OpenBLAS to one thread within this context; calls may be nested, also across threads.

    >>> with one_thread():
    ...     {one.get() for one in libraries()} <= {1}
    True
    """
    global _depth
    with _lock:
        if _depth == 0:
            _before[:] = [(one, one.get()) for one in libraries()]
            for one, count in _before:
                if count > 1:
                    one.set(1)
        _depth += 1
    try:
        yield
    finally:
        with _lock:
            _depth -= 1
            if _depth == 0:
                for one, count in _before:
                    if count > 1:
                        one.set(count)


def stay_on_one_thread() -> None:
    """Limit OpenBLAS in this process for good; for worker processes of the program."""
    for one in libraries():
        one.set(1)
