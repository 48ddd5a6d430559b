"""Laws every array model keeps: array = scalar, complex step, any namespace, no side effect.

The points are in `model_samples`; a public function without one fails here.
"""

from __future__ import annotations

import copy
import inspect

import array_api_strict as strict
import numpy as np
import pytest
from model_samples import (
    SAMPLES,
    SCALAR_ONLY,
    called,
    cases,
    leaves,
    public_functions,
)
from samples_dynamics import ROOTS

STEP = 1e-30
CASES = [pytest.param(function, sample, id=label) for label, function, sample in cases()]
ANY_NAMESPACE = [
    pytest.param(*case.values, kind, id=f"{case.id}-{word}")
    for case in CASES
    for word, kind in (("real", strict.float64), ("complex", strict.complex128))
    if case.id not in ROOTS and (word == "complex" or case.id.endswith("-0"))
]
"""Every sample with complex numbers, the first of each function with real numbers too."""
ROWS, COLUMNS = np.array([[0.99], [1.0], [1.01]]), np.array([[1.0, 1.005]])


def plain(value):
    """Convert an array of any namespace to a real NumPy array."""
    return np.real(np.asarray(value.tolist() if hasattr(value, "tolist") else value))


def test_every_public_function_has_a_sample():
    """Each public model function is in SAMPLES, or in SCALAR_ONLY with a reason; none is stale."""
    assert {*SAMPLES, *SCALAR_ONLY} == set(public_functions())
    assert all(SCALAR_ONLY.values())


@pytest.mark.parametrize(("function", "sample"), CASES)
def test_array_equals_scalar(function, sample):
    """Columns and rows broadcast, each element is the scalar call's; no argument is written to."""
    numbers = leaves(sample)
    arrays = [v * (ROWS if i % 2 else COLUMNS) for i, v in enumerate(numbers)]
    before = copy.deepcopy(arrays)
    together = [np.broadcast_to(a, (3, 2)) for a in called(function, sample, arrays, 2)]
    for array, kept in zip(arrays, before, strict=True):
        np.testing.assert_array_equal(array, kept)
    for row, column in ((0, 0), (1, 1), (2, 0)):
        factors = (float(COLUMNS[0, column]), float(ROWS[row, 0]))
        scaled = [v * factors[i % 2] for i, v in enumerate(numbers)]
        one = called(function, sample, scaled, 0)
        for array, scalar in zip(together, one, strict=True):
            assert np.ndim(scalar) == 0
            assert array[row, column] == pytest.approx(scalar, rel=1e-12)


@pytest.mark.parametrize(("function", "sample"), CASES)
def test_complex_step_equals_central_difference(function, sample):
    """The imaginary part under a tiny imaginary step is the slope, for every argument at once."""
    values = np.array(leaves(sample))
    size = len(values)
    batch = np.repeat(values.astype(complex)[:, None], size, axis=1)
    batch[np.arange(size), np.arange(size)] += 1j * STEP
    change = np.diag(1e-5 * np.abs(values))
    exact = called(function, sample, batch, 1)
    high = called(function, sample, values[:, None] + change, 1)
    low = called(function, sample, values[:, None] - change, 1)
    for derivative, above, below in zip(exact, high, low, strict=True):
        slope = np.broadcast_to(np.imag(derivative) / STEP * np.abs(values), (size,))
        with np.errstate(invalid="ignore"):  # infinite less infinite: no liner
            difference = np.nan_to_num(np.broadcast_to(above - below, (size,)) / 2e-5)
        scale = np.max(np.abs(np.nan_to_num(above, posinf=0.0)))
        np.testing.assert_allclose(slope, difference, rtol=1e-5, atol=1e-6 * scale)


@pytest.mark.parametrize(("function", "sample", "kind"), ANY_NAMESPACE)
def test_any_array_namespace(function, sample, kind):
    """Strict array-API arrays give the scalar numbers: only standard functions are used.

    Functions that find roots with LAPACK are left out (`samples_dynamics.ROOTS` says which).
    """
    numbers = leaves(sample)
    ours = called(function, sample, [strict.asarray([[v]], dtype=kind) for v in numbers], 2)
    for array, scalar in zip(ours, called(function, sample, numbers, 0), strict=True):
        assert plain(array).ravel()[0] == pytest.approx(plain(scalar).ravel()[0], rel=1e-9)


def test_arguments_are_named():
    """Physical arguments are keyword-only; only functions of one quantity take it by position."""
    for name, function in sorted(public_functions().items()):
        arguments = inspect.signature(function).parameters.values()
        positional = [a for a in arguments if a.kind is not inspect.Parameter.KEYWORD_ONLY]
        assert not positional or len(arguments) == 1, name
