"""CuPy without a GPU: arrays of NumPy, and the kernel's text compiled by the C compiler."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np

COMPILER = shutil.which("cc") or shutil.which("gcc")
DEFINITIONS = """
typedef struct { long long x; } Place;
static Place blockIdx, blockDim, threadIdx;
#define KERNEL static
"""
"""What CUDA gives every thread."""
LAUNCH = """
void launch(long long blocks, long long threads, void **a) {
    blockDim.x = threads;
    for (blockIdx.x = 0; blockIdx.x < blocks; blockIdx.x++)
        for (threadIdx.x = 0; threadIdx.x < threads; threadIdx.x++)
            run_designs(a[0], *(long long *)a[1], a[2], a[3], *(long long *)a[4], a[5],
                *(long long *)a[6], *(long long *)a[7], a[8], *(long long *)a[9], a[10], a[11]);
}
"""
"""Every thread of every block, one after another."""


class RawModule:
    """The kernel, compiled for this processor."""

    folder: Path

    def __init__(self, code, options):
        assert "--fmad=false" in options
        file, library = self.folder / "kernel.c", self.folder / "kernel.so"
        if not library.exists():
            file.write_text(DEFINITIONS + code + LAUNCH, "utf-8")
            flags = ["-O2", "-fno-math-errno", "-ffp-contract=off", "-shared", "-fPIC"]
            subprocess.run([COMPILER, *flags, file, "-o", library, "-lm"], check=True)
        self.library = ctypes.CDLL(str(library))

    def get_function(self, name):
        """The launch of the kernel."""
        assert name == "run_designs"
        return self.launch

    def launch(self, grid, block, arguments):
        """Run all threads; every argument must have the kernel's type."""
        kinds = "code int64 int32 int32 int64 float64 int64 int64 float64 int64 float64 float64"
        held = [np.ascontiguousarray(argument) for argument in arguments]
        for array, argument, kind in zip(held, arguments, kinds.split(), strict=True):
            assert array.dtype == {"code": np.uint16}.get(kind) or array.dtype.name == kind
            assert np.ndim(argument) == 0 or (argument.size and argument.flags.c_contiguous)
        places = (ctypes.c_void_p * len(held))(*(array.ctypes.data for array in held))
        self.library.launch(ctypes.c_longlong(*grid), ctypes.c_longlong(*block), places)


def cupy(folder, free=2**30, devices=None):
    """The module CuPy, as far as it is used; `devices` may raise an error of the driver."""
    runtime = SimpleNamespace(
        getDeviceCount=devices or (lambda: 1), memGetInfo=lambda: (free, 2 * free)
    )
    module = type("Compiled", (RawModule,), {"folder": folder})
    return SimpleNamespace(
        asarray=np.array, asnumpy=np.array, empty=lambda shape: np.full(shape, np.nan),
        RawModule=module, cuda=SimpleNamespace(runtime=runtime),
    )  # fmt: skip
