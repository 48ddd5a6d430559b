"""Values of a program for many designs on a CUDA GPU, through CuPy (extra `gpu`).

The kernel runs the operations of `machine.h`, which are those of the processor's machine: the GPU's
compiler takes the same text. Products and sums are rounded one by one on both. The functions of the
GPU's library (exp, pow, sin, ...) differ from those of the processor by a few units in the last
place, so results agree to rounding, not to the bit.

The kernel is compiled, and compared with the machine, by the C compiler in the tests. It has not
run on a GPU yet, and its speed was not measured.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..errors import Diagnostic, UsageError
from ..numeric import Array
from .program import MACHINE, Program

KERNEL: Final = Path(__file__).with_name("machine.cu")
"""Text of the kernel, which follows that of the machine."""
OPTIONS: Final = ("--std=c++14", "--fmad=false")
"""Each operation is rounded as in NumPy (no fused products)."""
THREADS: Final = 128
"""Number of designs in a block of threads."""
SHARE: Final = 0.5
"""Share of the GPU's free memory that the slots of a batch of designs may take."""


def source() -> str:
    """Return the text of the kernel with the machine."""
    return MACHINE.read_text("utf-8") + KERNEL.read_text("utf-8")


def require() -> None:
    """Find the GPU and compile the kernel, before long computations.

    Raises
    ------
    UsageError
        if CuPy is not installed, or there is no usable GPU
    """
    _kernel()


@lru_cache(maxsize=1)
def _kernel() -> tuple[Any, Any]:
    """CuPy and the compiled kernel."""
    try:
        import cupy
    except ImportError:
        message, remedy = "--engine gpu needs CuPy", "pip install 'actuator-opt[gpu]'"
        raise UsageError(Diagnostic(message, remedy)) from None
    try:
        cupy.cuda.runtime.getDeviceCount()
        return cupy, cupy.RawModule(code=source(), options=OPTIONS).get_function("run_designs")
    except Exception as error:  # missing drivers and devices raise many types
        reason = " ".join(str(error).split()) or type(error).__name__
        message = f"--engine gpu: no usable CUDA device ({reason[:200]})"
        raise UsageError(Diagnostic(message, "omit --engine to use the processor")) from None


def values(program: Program, points: Array) -> Array:
    """Outputs (points, outputs) at points (points, inputs), as `Program.values`.

    Raises
    ------
    UsageError
        if CuPy is not installed, or there is no usable GPU
    ValueError
        for a damaged program
    """
    cupy, kernel = _kernel()
    program.require_valid()
    tables = [
        cupy.asarray(np.ascontiguousarray(array, dtype=kind))
        for array, kind in (
            (program.code, np.uint16),
            (np.append(program.extra, 0), np.int32),  # no array of the device is empty
            (program.outputs, np.int32),
            (np.append(program.constants, 0.0), np.float64),
        )
    ]
    code, extra, outputs, constants = tables
    count, size = len(points), len(program.outputs)
    free, _ = cupy.cuda.runtime.memGetInfo()
    room = int(SHARE * free) // (8 * max(program.slots, 1))
    batch = max(min(count, room), THREADS)
    results = np.empty((count, size))
    for first in range(0, count, batch):
        part = np.ascontiguousarray(points[first : first + batch].T, dtype=float)
        designs = part.shape[1]
        slots = cupy.empty((program.slots, designs))
        rows = cupy.empty((size, designs))
        kernel(
            (-(-designs // THREADS),),
            (THREADS,),
            (
                code, np.int64(len(program.code)), extra, outputs, np.int64(size), constants,
                np.int64(program.slots), np.int64(program.inputs), cupy.asarray(part),
                np.int64(designs), slots, rows,
            ),
        )  # fmt: skip
        results[first : first + designs] = cupy.asnumpy(rows).T
    return results
