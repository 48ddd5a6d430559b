"""The kernel for a GPU: its text, compiled for this processor, gives the values of the machine."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

import cupy_on_host
import numpy as np
import pytest
from cli_runner import DESIGNS, KNEE, run
from hypothesis import given, settings, strategies as st
from test_recording import BINARY, SIZED, STEPS, UNARY, VALUES, grown, recorded

import actuator_opt as ao
from actuator_opt.base.errors import UsageError
from actuator_opt.base.polynomial import root_parts
from actuator_opt.base.symbolic import gpu, program as programs
from actuator_opt.optimisation.actuator import build
from actuator_opt.sweeps import chunk

pytestmark = [
    pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built"),
    pytest.mark.skipif(cupy_on_host.COMPILER is None, reason="no C compiler"),
]


@pytest.fixture(autouse=True)
def _forgotten():
    """Every test finds its own device."""
    gpu._kernel.cache_clear()
    yield
    gpu._kernel.cache_clear()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder of the compiled kernel."""
    return tmp_path_factory.mktemp("kernel")


@pytest.fixture
def device(folder, monkeypatch):
    """A CuPy that runs the kernel here."""
    monkeypatch.setitem(sys.modules, "cupy", cupy_on_host.cupy(folder))


def agree(made, points):
    """Compare the kernel with the machine: NaN and infinity in the same places, values to 1e-12."""
    with np.errstate(all="ignore"):
        np.testing.assert_allclose(
            gpu.values(made, points), made.values(points), rtol=1e-12, atol=1e-300
        )


def test_every_operation(device):
    """All values that matter, NaN, infinity and zeros of both signs among them."""
    numbers = np.array([0.0, -0.0, 1.0, -1.0, 0.3, -2.5, 700.0, np.inf, -np.inf, np.nan])
    for ufunc in UNARY:
        agree(recorded(ufunc, np.array([0.5]))[1], numbers[:, None])
    pairs = np.array(np.meshgrid(numbers, numbers)).reshape(2, -1).T
    for ufunc in BINARY:
        _, made = recorded(lambda x, ufunc=ufunc: ufunc(x[:1], x[1:]), np.array([0.5, 0.7]))
        agree(made, pairs)


@given(steps=STEPS, points=st.lists(st.tuples(*[SIZED] * 3), min_size=1, max_size=5))
def test_random_programs(folder, steps, points):
    """Chains of operations whose slots are used again, for one and for several designs."""
    _, made = recorded(
        lambda x: np.stack(np.broadcast_arrays(*grown(steps, list(x[:, None])))).ravel(),
        np.array([0.5, 0.7, 0.9]),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "cupy", cupy_on_host.cupy(folder))
        agree(made, np.array(points))


@given(lists=st.lists(VALUES, min_size=7, max_size=7), degree=st.integers(1, 6))
@settings(max_examples=30, deadline=None)
def test_roots(folder, lists, degree):
    """Polynomials of all degrees; coefficients that vanish or are not finite among them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "cupy", cupy_on_host.cupy(folder))
        _, made = recorded(
            lambda x: np.concatenate(root_parts(x[:, None])).ravel(), np.arange(1.0, degree + 2)
        )
        agree(made, np.array([lists[: degree + 1], np.arange(2.0, degree + 3)]))


def test_a_shipped_design_in_batches(folder, monkeypatch):
    """The knee at 300 points of its box; the device has memory for some 128 designs at once."""
    actuator = build(ao.read(KNEE).subject())
    problem, function = actuator.problem, actuator.recorded
    with np.errstate(all="ignore"):
        function(function.present[:, None])
    made = function.recording.program
    room = int(8 * made.slots * 130 / gpu.SHARE)
    monkeypatch.setitem(sys.modules, "cupy", cupy_on_host.cupy(folder, room))
    shares = np.random.default_rng(0).random((300, len(problem.lower)))
    points = np.repeat(function.present[None], 300, axis=0)
    points[:, : shares.shape[1]] = problem.lower + (problem.upper - problem.lower) * shares
    agree(made, points)
    assert gpu.values(made, points[:0]).shape == (0, len(made.outputs))


@pytest.mark.parametrize(
    "design", [pytest.param("knee_bonded.yaml", marks=pytest.mark.long), "steel_baseline.yaml"]
)
def test_a_sweep_has_the_same_rows_and_store(design, device, tmp_path, monkeypatch):
    """All numbers of the CSV agree to 1e-12; the processor reads the GPU's rows from the store."""
    monkeypatch.setattr(chunk, "RECORDED_FROM", 1)
    monkeypatch.setattr(chunk, "LEAST_RECORDED", 1)
    calls = []
    monkeypatch.setattr(gpu, "values", lambda *x, on=gpu.values: calls.append(len(x[1])) or on(*x))

    def swept(name, **options):
        file, vary = tmp_path / name, ["cylinder.bore=18..26 mm", "rod.outer_diameter=9..13 mm"]
        result = ao.sweep(DESIGNS / design, vary, method="lhs", n=400, csv=file, **options)
        return result, file.read_text(encoding="utf-8")

    _, expected = swept("processor.csv")
    assert not calls
    store = {"store": tmp_path / "rows.db"}
    result, table = swept("gpu.csv", engine="gpu", **store)
    assert result.to_dict()["engine"] == "gpu"
    assert max(calls) == 400
    for row, other in zip(table.splitlines(), expected.splitlines(), strict=True):
        for value, wanted in zip(row.split(","), other.split(","), strict=True):
            assert value == wanted or float(value) == pytest.approx(float(wanted), rel=1e-12)
    again, stored = swept("stored.csv", **store)
    assert (again.computed, stored) == (0, table)


def test_without_cupy_or_a_device_one_line_says_so(folder, monkeypatch):
    """What is missing, and what to do."""
    monkeypatch.setitem(sys.modules, "cupy", None)
    with pytest.raises(UsageError) as caught:
        gpu.require()
    assert str(caught.value).splitlines() == [
        "--engine gpu needs CuPy; pip install 'actuator-opt[gpu]'"
    ]

    def devices():
        raise RuntimeError("cudaErrorNoDevice:\n no CUDA-capable device is detected")

    monkeypatch.setitem(sys.modules, "cupy", cupy_on_host.cupy(folder, devices=devices))
    with pytest.raises(UsageError, match="no usable CUDA device") as caught:
        gpu.require()
    assert len(str(caught.value).splitlines()) == 1
    done = run("sweep", KNEE, "--vary", "cylinder.bore=20..22 mm:3", "--engine", "gpu")
    assert done.code == 2
    assert len(done.err.splitlines()) == 1
    assert "no usable CUDA device" in done.err


def test_a_damaged_program_is_refused(device):
    """A program that would use memory outside its slots never reaches the device."""
    _, made = recorded(np.sqrt, np.array([0.5]))
    made.code[0, 2] = 60_000
    with pytest.raises(ValueError, match="not a valid program"):
        gpu.values(made, np.ones((3, 1)))


def test_the_compiler_of_the_gpu_accepts_the_kernel():
    """Machine code for two generations of GPUs; it needs NVRTC, but no GPU."""
    nvrtc = pytest.importorskip("nvidia.cuda_nvrtc")
    (file,) = (Path(nvrtc.__path__[0]) / "lib").glob("libnvrtc.so.*")
    library, made = ctypes.CDLL(str(file)), ctypes.c_void_p()
    text = gpu.source().encode()
    assert not library.nvrtcCreateProgram(ctypes.byref(made), text, None, 0, None, None)
    for generation in ("sm_80", "sm_90"):
        options = [*gpu.OPTIONS, f"--gpu-architecture={generation}"]
        given_options = (ctypes.c_char_p * len(options))(*(x.encode() for x in options))
        assert not library.nvrtcCompileProgram(made, len(options), given_options)
