"""Points of a sweep, each computed from its number: full factorial, Sobol, Latin hypercube.

Only the axes are stored. A sweep of any size thus takes the same memory, can start at any point and
has the same points in any number of processes.
"""

from __future__ import annotations

import contextlib
import math
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from functools import lru_cache
from typing import Literal, TypeAlias, get_args

import numpy as np

from ..base import units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError, shown
from ..base.numeric import Array
from ..base.quantities import Quantity
from ..design import Design, with_values
from ..design.data_file import DataFile
from ..design.materials import load_library
from ..design.paths import canonical, get, quantity_of

Metrics: TypeAlias = Mapping[str, Quantity] | None
_RANGE = re.compile(r"(?P<first>.+?)\.\.(?P<last>.+?)(?::(?P<count>[^:]*))?")
FORM = 'write PATH=A..B:N or PATH=a,b,c, e.g. --vary cylinder.bore="18..40 mm:12"'
MOST_LISTED = 10_000
"""Maximum number of values in a list."""
MOST_TESTED = 32
"""Maximum number of values of a list that are tested; from longer lists, every n-th value."""
DESCRIPTIVE = frozenset({"name", "notes", "reproduces", "waivers", "objective"})
"""Blocks of a design that affect neither metrics nor limits."""


@dataclass(frozen=True)
class SweepAxis:
    """A varied PATH with its values: numbers (SI), or texts such as names of materials.

    A design is built for each text. A range has its two ends as `values`, and `count` points;
    `count` is None if the sweep method chooses the points.
    """

    path: str
    values: Array | None = None
    texts: tuple[str, ...] = ()
    range: bool = False
    count: int | None = None

    @property
    def listed(self) -> bool:
        """Whether the axis has a list of values instead of a range."""
        return not self.range

    @property
    def size(self) -> int:
        """Return the number of values in a full factorial."""
        if self.range:
            return self.count or 0
        return len(self.texts) if self.values is None else len(self.values)

    def numbers(self) -> Array:
        """Return the values of a numeric axis in a full factorial."""
        assert self.values is not None
        if not self.range:
            return self.values
        return self.at(np.arange(self.count or 2))

    def at(self, places: Array) -> Array:
        """Return the values at some indices of `numbers`, without computing all of them."""
        assert self.values is not None
        if not self.range:
            values: Array = self.values[places]
            return values
        low, high = self.values
        last = (self.count or 2) - 1
        interpolated: Array = low + places * ((high - low) / last)
        return np.where(places == last, high, interpolated)

    @property
    def ends(self) -> tuple[float, float]:
        """Return the least and the greatest number."""
        assert self.values is not None
        return float(self.values.min()), float(self.values.max())


def read_axis(text: str, design: Design, metrics: Metrics = None) -> SweepAxis:
    """Return the axis for a user's text: ``PATH=A..B:N`` or ``PATH=a,b,c``.

    Numbers without a unit take the unit of the last number; if this has none, all are SI. `metrics`
    are the metrics that the design may use, including the user's own.

    Raises
    ------
    UsageError
        if the text does not have this form
    InputError
        if the PATH is unknown, or a value does not suit it
    """
    path, sign, values = text.partition("=")
    if not sign or not path.strip() or not values.strip():
        raise UsageError(Diagnostic(f"--vary {shown(text)}: no values", FORM))
    path = _canonical(path, design)
    match = _RANGE.fullmatch(values.strip())
    if match is None:
        parts = [part.strip() for part in values.split(",")]
        return _listed(path, _with_unit(parts), design, metrics)
    first, last, count = match["first"].strip(), match["last"].strip(), match["count"]
    steps = _steps(text, count)
    ends = [_number(path, end, design, metrics) for end in _with_unit([first, last])]
    if ends[0] == ends[1]:
        raise UsageError(
            Diagnostic(f"--vary {shown(text)}: both ends of the range are equal", FORM)
        )
    return SweepAxis(path, np.array(ends), range=True, count=steps)


def _canonical(path: str, design: Design) -> str:
    if not isinstance(path, str):
        message = f"a PATH must be a text, not {shown(repr(path))}"
        raise InputError(Diagnostic(message, "write e.g. cylinder.bore"))
    path = canonical(path.strip(), design)
    if path.partition(".")[0] in DESCRIPTIVE:
        message = "is descriptive text that no model uses"
        raise InputError(Diagnostic(message, "vary a dimension, a material or a limit", path=path))
    return path


def given_axis(path: str, values: object, design: Design, metrics: Metrics = None) -> SweepAxis:
    """Return the axis for values from a script; parameters and errors as for `read_axis`.

    Parameters
    ----------
    values : a text as in `read_axis`; or a list or one-dimensional array of numbers (SI) and texts,
        each with its own unit

    Raises
    ------
    InputError
        also if an array is empty, not one-dimensional or not finite, or a text lacks its unit
    """
    if isinstance(values, str):
        return read_axis(f"{path}={values}", design, metrics)
    path = _canonical(path, design)
    given = one_dimensional(path, values, design)
    if not isinstance(given, np.ndarray):
        return _listed(path, given, design, metrics)
    numbers = _checked(path, given, design, metrics)
    unique, first = np.unique(numbers, return_index=True)
    if len(unique) < len(numbers):
        place = int(np.setdiff1d(np.arange(len(numbers)), first)[0])
        message = f"the value at index {place} is given twice"
        raise InputError(Diagnostic(message, "remove it", path=path))
    return SweepAxis(path, numbers)


def one_dimensional(path: str, values: object, design: Design) -> Array | list[str]:
    """Values as an array of numbers, or all as texts (bare: SI) if there is a text among them.

    Raises
    ------
    InputError
        the values are empty, not one-dimensional, neither numbers nor texts, or not finite, or a
        text lacks its unit; the message states PATH and index
    """
    advice = "give a list or a one-dimensional array of numbers (SI) or texts"
    array = np.asarray(values) if hasattr(values, "__array__") else None
    if array is not None and array.ndim != 1:
        message = f"an array of {array.ndim} dimensions cannot be varied"
        raise InputError(Diagnostic(message, advice, path=path))
    if array is None and (not isinstance(values, Sequence) or isinstance(values, str | bytes)):
        raise InputError(Diagnostic(f"{shown(repr(values))} is not a list", advice, path=path))
    if array is None or array.dtype.kind not in "fiu":
        items = list(values) if array is None else array.tolist()  # type: ignore[call-overload]
        numbers = [x if isinstance(x, str) else _scalar(path, k, x) for k, x in enumerate(items)]
        if any(isinstance(x, str) for x in numbers):
            _require_units(path, numbers, design)
            return [x if isinstance(x, str) else repr(x) for x in numbers]
        array = np.array(numbers)
    if not len(array):
        raise InputError(Diagnostic("has no values", advice, path=path))
    finite = np.isfinite(array)
    if not finite.all():
        place = int(finite.argmin())
        message = f"the value at index {place} is {array[place]}"
        raise InputError(Diagnostic(message, "give finite numbers", path=path))
    return array.astype(float)


def _require_units(path: str, values: Sequence[str | float], design: Design) -> None:
    """Refuse a text that is a number without the unit that its PATH needs.

    Raises
    ------
    InputError
        it states the index of the text
    """
    try:
        quantity = quantity_of(path, design)
    except InputError:  # a word, such as the name of a material
        return
    for index, text in enumerate(values if quantity.si_unit else ()):
        if isinstance(text, str) and _bare(text) is not None:
            message = f'the text at index {index} has no unit: "{shown(text)}"'
            advice = (
                f'write e.g. "{shown(text)} {quantity.unit}", or a number in {quantity.si_unit}'
            )
            raise InputError(Diagnostic(message, advice, path=path))


def _scalar(path: str, index: int, item: object) -> float:
    """A number of a list; raises `InputError` for anything else."""
    if isinstance(item, int | float | np.integer | np.floating) and not isinstance(item, bool):
        with contextlib.suppress(OverflowError):
            return float(item)
    message = f"the value at index {index} is not a number: {shown(repr(item))}"
    raise InputError(Diagnostic(message, "give numbers (SI) or texts", path=path))


def _checked(path: str, numbers: Array, design: Design, metrics: Metrics) -> Array:
    """Numbers whose least and greatest suit their PATH, and so do those between.

    Raises
    ------
    InputError
        it states the index of the value
    """
    whole = np.flatnonzero(numbers != np.round(numbers))[:1]  # the first that no count can take
    for place in dict.fromkeys([int(numbers.argmin()), int(numbers.argmax()), *map(int, whole)]):
        try:
            _number(path, repr(float(numbers[place])), design, metrics)
        except InputError as error:
            raise InputError(
                [
                    replace(x, message=f"value at index {place}: {x.message}", path=path)
                    for x in error.diagnostics
                ]
            ) from None
    return numbers


def _steps(text: str, count: str | None) -> int | None:
    if count is None:
        return None
    steps = units.whole(count)
    if steps is None or steps < 2:
        raise UsageError(
            Diagnostic(
                f"--vary {shown(text)}: {shown(count) or 'no number of'} steps", "give 2 or more"
            )
        )
    return steps


def _with_unit(texts: list[str]) -> list[str]:
    """Return the values with units: numbers without a unit take that of the last value."""
    try:
        unit = units.split(texts[-1])[1]
    except units.UnitError:
        return texts
    return [f"{text} {unit}" if unit and _bare(text) is not None else text for text in texts]


def _number(path: str, text: str, design: Design, metrics: Metrics) -> float:
    """Return a value as the design stores it, after checking that it suits its PATH."""
    value = _value(path, text, design, metrics)
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        message = f"{path}: {shown(text)} is not a number, so it cannot have a range"
        raise InputError(Diagnostic(message, "list its values: PATH=a,b,c"))
    if not _is_number(path, text, value, design, metrics):
        message = (
            f"{shown(text)} has another unit or type than the value in the design, so "
            "it cannot be the end of a range"
        )
        remedy = "list the values: PATH=a,b,c, or set one such value with --set first"
        raise InputError(Diagnostic(message, remedy, path=path))
    return float(value)


def _is_number(path: str, text: str, value: float, design: Design, metrics: Metrics) -> bool:
    """Whether a number in SI fully describes a value; for 50 % of a stroke, 0.5 does not."""
    design_with_text = _design_with(design, path, text, metrics)
    return design_with_text == _design_with(design, path, repr(float(value)), metrics)


def _value(
    path: str, text: str, design: Design, metrics: Metrics
) -> float | int | str | bool | None:
    return get(_design_with(design, path, text, metrics), path)


def _design_with(design: Design, path: str, text: str, metrics: Metrics) -> Design:
    number = _bare(text)
    value = text if number is None else number
    return with_values(
        design, {path: value}, materials=load_library(), metrics=metrics, contradictions=False
    )


def _bare(text: str) -> float | None:
    """Return the number that a text without a unit states; None for any other text."""
    try:
        number, unit = units.split(text)
    except units.UnitError:
        return None
    return None if unit else number


def _listed(
    path: str, parts: list[str], design: Design, metrics: Metrics, *, distinct: bool = True
) -> SweepAxis:
    """The axis of listed values; `distinct` refuses equal values, such as 20 mm and 2 cm."""
    if not all(parts):
        raise UsageError(Diagnostic(f"--vary {path}: one of the values is empty", FORM))
    if len(parts) > MOST_LISTED:
        raise UsageError(
            Diagnostic(
                f"--vary {path}: {len(parts)} values are too many for a list", "write a range"
            )
        )
    values = [_value(path, part, design, metrics) for part in dict.fromkeys(parts)]
    if any(isinstance(value, DataFile) for value in values):
        message = "the name of a file cannot be varied"
        remedy = "run once per file with --set"
        raise InputError(Diagnostic(message, remedy, path=path))
    if distinct and len(set(values)) < len(parts):
        raise UsageError(Diagnostic(f"--vary {path}: a value is given twice", FORM))
    if all(
        isinstance(value, (int, float))
        and not isinstance(value, bool)
        and _is_number(path, part, value, design, metrics)
        for value, part in zip(values, parts, strict=True)
    ):
        return SweepAxis(
            path, np.array([float(value) for value in values if value is not None]), tuple(parts)
        )
    return SweepAxis(path, None, tuple(parts))


Method = Literal["grid", "sobol", "lhs"]
METHODS = get_args(Method)
MOST = 2**30
"""Maximum number of points of a Sobol or Latin hypercube sweep: that of a 30-bit Sobol sequence."""

MOST_GRID = 10**12
"""Maximum number of grid points (our choice: some days of computing if only the best are kept)."""

BITS = 30
"""Number of bits of a Sobol coordinate."""

DIGITS = 12
"""Number of the lowest bits of a point number for which Sobol points are read from a table."""

ROUNDS = 6
"""Number of Feistel rounds in the permutation of a Latin hypercube."""


@dataclass(frozen=True)
class SweepPoints:
    """Points of a sweep: for each point, the index of its combination of texts, and its numbers.

    Texts are choices such as materials. The numbers are an array (axes, n), a column per point.
    """

    variant: Array
    numbers: Array

    def some(self, places: Array | slice) -> SweepPoints:
        """Return the points at some indices."""
        return SweepPoints(self.variant[places], self.numbers[:, places])


@dataclass(frozen=True)
class Plan:
    """Axes of a sweep, with method and number of its points.

    A design is built for each text of a `named` axis; the other axes vary numbers.
    """

    axes: tuple[SweepAxis, ...]
    method: Method
    count: int
    seed: int = 0

    @property
    def named(self) -> tuple[SweepAxis, ...]:
        """Return the axes whose values are texts, such as names of materials."""
        return tuple(axis for axis in self.axes if axis.values is None)

    @property
    def numeric(self) -> tuple[SweepAxis, ...]:
        """Return the axes of numbers."""
        return tuple(axis for axis in self.axes if axis.values is not None)

    @property
    def variants(self) -> int:
        """Return the number of combinations of texts (such as names of materials)."""
        return math.prod(axis.size for axis in self.named)

    def texts(self, variant: int) -> dict[str, str]:
        """Return the texts of one combination, by PATH."""
        texts = {}
        for axis in reversed(self.named):
            variant, at = divmod(variant, axis.size)
            texts[axis.path] = axis.texts[at]
        return dict(reversed(texts.items()))

    def points(self, first: int, count: int) -> SweepPoints:
        """Return points `first` to `first + count`, up to the last point."""
        index = np.arange(first, min(first + count, self.count), dtype=np.int64)
        places = self._grid(index) if self.method == "grid" else self._sampled(index)
        variant = np.zeros(len(index), dtype=np.int64)
        numbers = np.empty((len(self.numeric), len(index)))
        row = 0
        for axis, place in zip(self.axes, places, strict=True):
            if axis.values is None:
                variant = variant * axis.size + place.astype(np.int64)
            else:
                numbers[row] = axis.at(place.astype(np.int64)) if axis.listed else place
                row += 1
        return SweepPoints(variant, numbers)

    def _grid(self, index: Array) -> list[Array]:
        """Return values, or indices of listed values, for every axis; the last changes fastest."""
        sizes = tuple(axis.size for axis in self.axes)
        places = np.unravel_index(index, sizes)
        return [
            place if axis.listed else axis.at(place)
            for axis, place in zip(self.axes, places, strict=True)
        ]

    def _sampled(self, index: Array) -> list[Array]:
        unit = _sobol if self.method == "sobol" else _latin
        shares = unit(index, len(self.axes), self.count, self.seed)
        columns = []
        for axis, share in zip(self.axes, shares, strict=True):
            if axis.listed:
                columns.append(np.minimum((share * axis.size).astype(np.int64), axis.size - 1))
            else:
                assert axis.values is not None
                low, high = axis.values
                columns.append(low + (high - low) * share)
        return columns


@dataclass(frozen=True)
class PairedPlan(Plan):
    """Points whose values are all given: value k of each PATH belongs to point k."""

    given: SweepPoints = field(default_factory=lambda: SweepPoints(np.empty(0), np.empty((0, 0))))

    def points(self, first: int, count: int) -> SweepPoints:
        """Return points `first` to `first + count`, up to the last point."""
        return self.given.some(np.s_[first : first + count])


def paired(columns: Mapping[str, object], design: Design, metrics: Metrics = None) -> PairedPlan:
    """Return a plan for given points, value k of each PATH for point k.

    Parameters
    ----------
    columns : for each PATH, a list or array of numbers (SI) and texts, each with its own unit

    Raises
    ------
    InputError
        a PATH is unknown or given twice, a value does not suit it, a text lacks its unit, an array
        is not one-dimensional or not finite, or the arrays have different lengths
    """
    axes: list[SweepAxis] = []
    numbers: list[Array] = []
    count, first, variant = 0, "", np.zeros(1, dtype=np.int64)
    for name, values in columns.items():
        path = _canonical(name, design)
        given = one_dimensional(path, [values] if isinstance(values, str) else values, design)
        if path in (axis.path for axis in axes):
            raise InputError(Diagnostic("is given twice", "join its values", path=path))
        if first and len(given) != count:
            message = f"has {len(given)} values, but {first} has {count}"
            raise InputError(Diagnostic(message, "give as many for each PATH", path=path))
        count, first = len(given), first or path
        if isinstance(given, np.ndarray):
            numbers.append(_checked(path, given, design, metrics))
            unique = np.unique(given)
            few = len(unique) <= MOST_TESTED or 0.0 in given
            axes.append(
                SweepAxis(path, unique) if few else SweepAxis(path, unique[[0, -1]], range=True)
            )
        else:
            different = list(dict.fromkeys(given))
            axes.append(_listed(path, different, design, metrics, distinct=False))
            place = {text: k for k, text in enumerate(axes[-1].texts)}
            codes = np.array([place[text] for text in given], dtype=np.int64)
            if axes[-1].values is None:
                variant = variant * axes[-1].size + codes
            else:  # numbers with units
                numbers.append(axes[-1].values[codes])
    if not axes:
        raise UsageError(Diagnostic("no values to evaluate", 'give {"cylinder.bore": [...]}'))
    variant = np.broadcast_to(variant, (count,))
    points = SweepPoints(variant, np.array(numbers).reshape(len(numbers), count))
    return PairedPlan(tuple(axes), "grid", count, given=points)


def plan(axes: Sequence[SweepAxis], *, method: Method, count: int | None, seed: int = 0) -> Plan:
    """Plan the points of a sweep.

    Parameters
    ----------
    axes : varied numbers and texts
    method : full factorial, Sobol or Latin hypercube
    count : number of points for the sampled methods
    seed : seed of the sampled methods

    Raises
    ------
    UsageError
        if the method is unknown, there is no axis, a PATH occurs twice, or the number of steps or
        of points is missing
    """
    if method not in METHODS:
        raise UsageError(Diagnostic(f"--method {method}: unknown", f"use {', '.join(METHODS)}"))
    if not axes:
        raise UsageError(Diagnostic("nothing to vary", 'add --vary PATH=A..B:N or PATH="a,b,c"'))
    paths = [axis.path for axis in axes]
    for path in paths:
        if paths.count(path) > 1:
            raise UsageError(
                Diagnostic(f"--vary {path}: given twice", "join its values in one --vary")
            )
    if method == "grid":
        if count is not None:
            raise UsageError(
                Diagnostic(
                    "-n: the steps of a grid already determine its number of points",
                    "write PATH=A..B:N",
                )
            )
        for axis in axes:
            if axis.range and axis.count is None:
                message = f"--vary {axis.path}: the range has no steps"
                raise UsageError(Diagnostic(message, "write A..B:N, or --method sobol -n N"))
        points = math.prod(axis.size for axis in axes)
        if points > MOST_GRID:
            message = f"{points:,} points".replace(",", " ")
            raise UsageError(Diagnostic(message, "use fewer steps, or --method sobol -n N"))
        return Plan(tuple(axes), method, points, seed)
    if count is None or not 1 <= count <= MOST:
        message = f"--method {method}: number of points missing" if count is None else f"-n {count}"
        raise UsageError(Diagnostic(message, f"add -n N, 1 to {MOST}"))
    return Plan(tuple(axes), method, count, seed)


def _sobol(index: Array, dimension: int, count: int, seed: int) -> Array:
    """Return scrambled Sobol points (dimension, n) for their numbers [Sobol1967] [Owen1998].

    Each nonzero binary digit in the Gray code of k, which is k xor floor(k/2), has a direction
    number. Point k is the exclusive or of the first point and these direction numbers. For the
    lower `DIGITS` digits of k, the result is read from a table.
    """
    table, digits = _sobol_parts(dimension, max(count - 1, 1).bit_length(), seed)
    low, high = index & (len(table) - 1), index >> DIGITS
    unique, place = np.unique(high, return_inverse=True)
    heads = np.zeros((len(unique), dimension), dtype=np.int64)
    gray = (unique << DIGITS) ^ (unique << DIGITS >> 1)
    for number, digit in enumerate(digits, start=DIGITS - 1):
        heads ^= np.where((gray >> number & 1)[:, None], digit, 0)
    points: Array = (table[low] ^ heads[place.ravel()]).T * 2.0**-BITS
    return points


@lru_cache(maxsize=4)
def _sobol_parts(dimension: int, bits: int, seed: int) -> tuple[Array, Array]:
    """Return a table of the first points, and direction numbers from digit `DIGITS` - 1 on."""
    from scipy.stats import qmc

    engine = qmc.Sobol(dimension, scramble=True, bits=BITS, rng=np.random.default_rng(seed))
    table = (engine.random(2**DIGITS) * 2.0**BITS).astype(np.int64)
    digits = [table[-1] ^ table[0]]
    for number in range(DIGITS, bits):
        engine.fast_forward(2 ** (number + 1) - 1 - engine.num_generated)
        with warnings.catch_warnings():  # SciPy requires a power of two in every call
            warnings.simplefilter("ignore", UserWarning)
            digits.append((engine.random(1)[0] * 2.0**BITS).astype(np.int64) ^ table[0])
    return table, np.array(digits)


def _latin(index: Array, dimension: int, count: int, seed: int) -> Array:
    """Return points of a Latin hypercube: one in each of n equal parts of every axis [McKay1979].

    On each axis, a permutation of k gives the part in which point k lies. It needs no table: a
    Feistel network, which permutes the numbers below the next power of four, is applied to k until
    the result is in range [Black2002].
    """
    points = np.empty((dimension, len(index)))
    for axis in range(dimension):
        keys = np.random.default_rng([seed, axis]).integers(2**63, size=ROUNDS + 1, dtype=np.uint64)
        jitter = _mixed(index.astype(np.uint64) ^ keys[ROUNDS]) >> np.uint64(11)
        points[axis] = jitter
        points[axis] *= 2.0**-53
        points[axis] += _permuted(index.astype(np.uint32), count, keys[:ROUNDS].astype(np.uint32))
        points[axis] /= count
    return points


def _permuted(index: Array, count: int, keys: Array) -> Array:
    """Return the permuted numbers, all below `count` (at most 2^32)."""
    half = max(math.ceil(math.log2(max(count, 2)) / 2), 1)
    mask, shift = np.uint32(2**half - 1), np.uint32(half)
    place = _rounds(index, keys, mask, shift)
    out = np.flatnonzero(place >= count)
    while len(out):
        permuted = _rounds(place[out], keys, mask, shift)
        place[out] = permuted
        out = out[permuted >= count]
    return place


def _rounds(place: Array, keys: Array, mask: np.uint32, shift: np.uint32) -> Array:
    left, right = place >> shift, place & mask
    for key in keys:
        mixed = _mixed_half(right ^ key)
        mixed &= mask
        left, right = right, left ^ mixed
    permuted: Array = (left << shift) | right
    return permuted


def _mixed_half(x: Array) -> Array:
    """Hash 32-bit numbers (with the finaliser of MurmurHash3 [Appleby2011])."""
    x = x ^ (x >> np.uint32(16))
    x *= np.uint32(0x85EBCA6B)
    x ^= x >> np.uint32(13)
    x *= np.uint32(0xC2B2AE35)
    x ^= x >> np.uint32(16)
    return x


def _mixed(x: Array) -> Array:
    """Hash 64-bit numbers (with the finaliser of SplitMix64 [Steele2014])."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    mixed: Array = x ^ (x >> np.uint64(31))
    return mixed
