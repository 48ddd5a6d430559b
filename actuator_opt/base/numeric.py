"""Small numerical helpers for all models.

Models accept floats, NumPy arrays, arrays of any array-API namespace, and complex numbers: the
derivative of a model is the imaginary part of its result for a tiny imaginary step [Squire1998].
These functions replace NumPy functions that are silently wrong for complex input or refuse it;
all comparisons use real parts.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any, ParamSpec, TypeAlias, TypeVar

import numpy as np

Array: TypeAlias = Any
"""A float, or an array of any array-API namespace, real or (under differentiation) complex."""

_PLAIN = (float, int, complex, np.generic)

STEP = 1e-30
"""Imaginary step of the complex-step derivative; its error is of the order of 1e-60."""


def namespace(*values: Array) -> Any:
    """Array-API namespace of the arguments: NumPy, unless an array belongs to another library."""
    for value in values:
        if type(value) is not np.ndarray and not isinstance(value, _PLAIN):
            return value.__array_namespace__()
    return np


def array_of(value: Array) -> Array:
    """The value as an array of its own array-API namespace."""
    return namespace(value).asarray(value)


def real(value: Array) -> Array:
    """The real part of a real or complex value."""
    if isinstance(value, (np.ndarray, float, int, complex)):
        return value.real
    xp = namespace(value)
    return xp.real(value) if xp.isdtype(value.dtype, "complex floating") else value


def where(condition: Array, yes: Array, no: Array) -> Array:
    """Elementwise choice; `condition` must only compare real parts."""
    if type(condition) is np.ndarray:  # the common case must be fast: models call it most often
        choice: Any = np.where(condition, yes, no)
        if choice.dtype.hasobject and type(choice) is np.ndarray:
            return choice.item()  # a single symbol
        return choice
    if isinstance(condition, (bool, np.bool_)):
        return yes if condition else no
    return namespace(condition, yes, no).where(condition, yes, no)


def absolute(value: Array) -> Array:
    """|value| with derivative sign(value); `abs` is silently wrong under a complex step."""
    return where(real(value) >= 0, value, -value)


def maximum(first: Array, second: Array) -> Array:
    """The larger value by real part, with its derivative."""
    return where(real(first) >= real(second), first, second)


def minimum(first: Array, second: Array) -> Array:
    """The smaller value by real part, with its derivative."""
    return where(real(first) <= real(second), first, second)


def clip(value: Array, lower: Array, upper: Array) -> Array:
    """Limit `value` to [lower, upper]. Use it for physical limits only, never to hide a fault."""
    return minimum(maximum(value, lower), upper)


def positive(value: Array) -> Array:
    """`value` if its real part is positive, else NaN; it marks invalid input without an error."""
    return where(real(value) > 0, value, np.nan)


def sqrt(value: Array) -> Array:
    """Square root; NaN for a negative real part, also under a complex step."""
    xp = namespace(value)
    if hasattr(xp, "real_sqrt"):  # of recorded symbols, which are real
        return xp.real_sqrt(value)
    negative = real(value) < 0
    root = xp.sqrt(where(negative, 0 * value + 1, value))
    return where(negative, 0 * root + np.nan, root)


def tangent(angle: Array) -> Array:
    """Tangent of an angle [rad], by functions that symbols have too."""
    xp = namespace(angle)
    return xp.sin(angle) / xp.cos(angle)


def magnitude(first: Array, second: Array) -> Array:
    """sqrt(first^2 + second^2); both arguments may carry a complex step."""
    return sqrt(first * first + second * second)


def angle(imaginary: Array, real_part: Array) -> Array:
    """arctan2(imaginary, real_part) with its derivative; `arctan2` refuses complex input."""
    xp = namespace(imaginary, real_part)
    y, x = real(imaginary), real(real_part)
    value = xp.atan2(xp.asarray(y, dtype=xp.float64), xp.asarray(x, dtype=xp.float64))
    dy, dx = imaginary - y, real_part - x
    return value + (x * dy - y * dx) / (x * x + y * y)


def expm1_quotient(value: Array) -> Array:
    """expm1(value)/value, which is 1 at 0; smooth, and valid under a complex step."""
    xp = namespace(value)
    small = (real(value) < 1e-5) & (real(value) > -1e-5)
    safe = where(small, 0 * value + 1, value)
    return where(small, 1 + value / 2 + value * value / 6, xp.expm1(safe) / safe)


def log1p_quotient(value: Array) -> Array:
    """log1p(value)/value, which is 1 at 0; valid under a complex step. NaN at -1 and below."""
    xp = namespace(value)
    undefined = real(value) <= -1
    small = (real(value) < 1e-5) & (real(value) > -1e-5)
    safe = where(small | undefined, 0 * value + 1, value)
    mean = where(small, 1 - value / 2 + value * value / 3, xp.log1p(safe) / safe)
    return where(undefined, np.nan, mean)


def sorted_unique(values: Array) -> Array:
    """The different values in rising order; `numpy.unique` would import `numpy.ma` at every start.

    >>> sorted_unique(np.array([3.0, 1.0, 3.0]))
    array([1., 3.])
    """
    ordered = np.sort(values)
    return ordered[np.append(True, ordered[1:] != ordered[:-1])]


def together(values: Sequence[Array], axis: int = 0) -> Array:
    """Stack arrays on a new axis after broadcasting them."""
    xp = namespace(*values)
    if len({value.shape for value in values}) > 1:
        values = xp.broadcast_arrays(*values)
    if xp is np and axis == 0:  # equal to `stack`, but takes a third of the time for a few designs
        return np.array(values)
    return xp.stack(values, axis=axis)


def group_width(points: Array) -> int | None:
    """Size of the groups of neighbouring columns with equal real parts; None if sizes differ.

    >>> group_width(np.array([[1 + 1j, 1 + 0j, 2 + 0j, 2 + 1j]]))
    2
    """
    sizes = np.diff(np.append(group_starts(points), points.shape[1]))
    return int(sizes[0]) if len(sizes) and (sizes == sizes[0]).all() else None


def group_starts(points: Array) -> Array:
    """First columns of the groups of neighbouring columns with equal real parts."""
    values = points.real
    new = np.append(True, (values[:, 1:] != values[:, :-1]).any(axis=0))
    return np.flatnonzero(new)


def duals_of(points: Array, width: int) -> Array:
    """Values and slopes (rows, groups, 1 + width) of complex columns (rows, groups * width).

    The columns of a group have equal real parts; each is a complex step of size `STEP` in one
    direction.
    """
    columns = points.reshape(len(points), -1, width)
    duals = np.empty((*columns.shape[:2], 1 + width))
    duals[:, :, 0], duals[:, :, 1:] = columns.real[:, :, 0], columns.imag
    duals[:, :, 1:] /= STEP
    return duals


def complexed(duals: Array) -> Array:
    """Complex columns (rows, groups * width) of values and slopes (rows, groups, 1 + width)."""
    rows, groups, size = duals.shape
    columns = np.empty((rows, groups, size - 1), dtype=complex)
    columns.real = duals[:, :, :1]
    np.multiply(duals[:, :, 1:], STEP, out=columns.imag)
    return columns.reshape(rows, -1)


def finished(active: Array) -> bool:
    """Whether a loop may end because none of its elements is active.

    Further rounds must not change elements that are not active: then a recording of more rounds is
    also correct for points that need fewer.
    """
    xp = namespace(active)
    recorded: bool = xp.finished(active) if hasattr(xp, "finished") else not bool(xp.any(active))
    return recorded


def stacked(rows: Sequence[Sequence[Array]]) -> list[Array]:
    """Stack each list of values (one per layer) into an array (layers, ...).

    All arrays have the same number of axes, so that they broadcast.
    """
    xp = namespace(*(value for row in rows for value in row))
    result = []
    for row in rows:
        if all(isinstance(value, (float, int)) for value in row):
            result.append(xp.asarray([float(value) for value in row]))
        else:
            result.append(together([xp.asarray(value) for value in row]))
    dims = max(value.ndim for value in result) - 1
    return [lifted(value, dims) for value in result]


def lifted(value: Array, dims: int) -> Array:
    """Insert axes of length 1 after the layer axis, until `dims` axes follow it."""
    missing = dims + 1 - value.ndim
    if missing <= 0:
        return value
    shape = (value.shape[0], *(1,) * missing, *value.shape[1:])
    if type(value) is np.ndarray:
        return value.reshape(shape)
    return namespace(value).reshape(value, shape)


def histories(*values: Array | Sequence[Array]) -> list[Array]:
    """Histories as arrays with time as their first axis; the samples of a list are stacked.

    All arrays get the same number of axes, so that they broadcast.

    >>> [history.shape for history in histories([0.0, 1.0, 2.0], np.ones((3, 4)))]
    [(3, 1), (3, 4)]
    """
    lists = [value if isinstance(value, tuple | list) else [value] for value in values]
    xp = namespace(*(sample for samples in lists for sample in samples))
    arrays = [
        together([xp.asarray(sample) for sample in value])
        if isinstance(value, tuple | list)
        else xp.asarray(value)
        for value in values
    ]
    dims = max(array.ndim for array in arrays) - 1
    return [lifted(array, dims) for array in arrays]


def over_time(values: Array, time: Array) -> Array:
    """Integral of a history over time by the trapezoid rule; both are `histories`."""
    return namespace(values, time).sum(_means(values) * (time[1:, ...] - time[:-1, ...]), axis=0)


def over_travel(values: Array, position: Array) -> Array:
    """Integral of a history over the distance travelled, sum of mean |x_(i+1) - x_i|.

    Both are `histories`. The samples must contain the turning points of the position.
    """
    steps = absolute(position[1:, ...] - position[:-1, ...])
    return namespace(values, position).sum(_means(values) * steps, axis=0)


def _means(values: Array) -> Array:
    """Mean of a history in each interval between samples."""
    return 0.5 * (values[1:, ...] + values[:-1, ...])


P = ParamSpec("P")
T = TypeVar("T")
_SIZE = re.compile(
    r"(?:.*_)?(?:bore|radius|diameter|thickness(?:es)?|length|width|section|stroke|span|pitch|gap"
    r"|depth|height|land|engagement|clearance|tolerance|roughness|travel|areas?|volume"
    r"|second_moments?|wetted_(?:back|front)|(?:edge|flank)_distance)(?:_[ab12])?"
)
"""Pattern of the argument names of lengths, areas, volumes and second moments, which are never
negative."""
_RATE = re.compile(r".*_per_.*")
PAIRS = (
    ("outer_radius", "inner_radius"),
    ("outer_diameter", "inner_diameter"),
    ("outer_diameter", "bore"),
    ("bore", "rod_diameter"),
    ("radius", "hole_radius"),
    ("edge_radius", "hub_radius"),
)
"""Pairs of arguments whose first must be larger than the second, so that no wall or annulus
vanishes."""


def sizes(function: Callable[..., object]) -> tuple[str, ...]:
    """Names of a function's arguments that are lengths, areas or volumes, judged by the names."""
    code = function.__code__
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    return tuple(name for name in names if _SIZE.fullmatch(name) and not _RATE.fullmatch(name))


def geometry(function: Callable[P, T]) -> Callable[P, T]:
    """Make a model return NaN if a size is negative or an inner size is not below the outer.

    Of an array, only the impossible elements become NaN. The thicknesses of `layers` are checked
    too. Symbols (`base.symbolic`) and arrays of libraries other than NumPy are not checked: with
    them, a model is traced once for many values, and the limits of the design already exclude
    impossible values.
    """
    names = sizes(function)
    pairs = [pair for pair in PAIRS if pair[0] in names and pair[1] in names]

    @functools.wraps(function)
    def checked(*args: P.args, **arguments: P.kwargs) -> T:
        values: dict[str, Any] = arguments
        impossible: Any = False
        for name in names:
            if name in values and not _possible(values[name]):
                values[name], mask = _checked(values[name])
                impossible = impossible | mask
        for greater, lesser in pairs:
            if greater in values and lesser in values:
                values[greater], mask = _masked(
                    real(values[greater]) <= real(values[lesser]), values[greater]
                )
                impossible = impossible | mask
        if "layers" in values and not all(_possible(layer.thickness) for layer in values["layers"]):
            layers = [_checked(layer.thickness) for layer in values["layers"]]
            values["layers"] = [
                layer if value is layer.thickness else replace(layer, thickness=value)
                for layer, (value, _) in zip(values["layers"], layers, strict=True)
            ]
            impossible = functools.reduce(lambda mask, layer: mask | layer[1], layers, impossible)
        result = function(*args, **arguments)
        return result if impossible is False else _with_nan(result, impossible)

    return checked


def _possible(value: Any) -> bool:
    """Whether no element of a size is negative; False also for types that it cannot handle."""
    if isinstance(value, float):
        return not value < 0
    if type(value) is np.ndarray and value.dtype.kind in "fc":
        return not np.fmin.reduce(value.real, axis=None, initial=0.0) < 0
    return value is None


def _checked(value: Any) -> tuple[Any, Any]:
    """Replace negative sizes by NaN; also return the mask of the replaced elements."""
    if not isinstance(value, tuple | list):
        return _masked(real(value) < 0, value)
    elements = [_checked(element) for element in value]
    impossible = functools.reduce(lambda mask, pair: mask | pair[1], elements, False)
    return type(value)(element for element, _ in elements), impossible


def _masked(impossible: Any, value: Any) -> tuple[Any, Any]:
    """Replace values by NaN where `impossible` is true; return them and the mask.

    If the condition is a single symbol, the value is returned unchanged and the mask is False.
    """
    if impossible is False:
        return value, False
    if impossible is True:
        return where(impossible, np.nan, value), impossible
    if isinstance(impossible, np.bool_ | np.ndarray) and impossible.dtype.kind == "b":
        if not impossible.any():
            return value, False
        return where(impossible, np.nan, value), impossible
    if isinstance(impossible, np.ndarray):  # symbols, recorded for all values
        return where(impossible, np.nan, value), impossible
    return value, False


def _with_nan(result: Any, impossible: Any) -> Any:
    """Replace the results for impossible geometries by NaN."""
    if isinstance(result, tuple | list):
        parts = [_with_nan(part, impossible) for part in result]
        return type(result)(*parts) if hasattr(result, "_fields") else type(result)(parts)
    if isinstance(result, dict):
        return {name: _with_nan(part, impossible) for name, part in result.items()}
    if is_dataclass(result) and not isinstance(result, type):
        known = [field.name for field in fields(result) if field.init]
        return replace(
            result, **{name: _with_nan(getattr(result, name), impossible) for name in known}
        )
    if isinstance(result, float | complex | np.floating | np.complexfloating):
        return where(impossible, np.nan, result)
    if isinstance(result, np.ndarray) and result.dtype.kind in "fcO":
        return np.where(impossible, np.nan, result)
    return result
