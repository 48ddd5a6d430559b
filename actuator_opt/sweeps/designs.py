"""Prepare the designs of a sweep; most numbers vary as arrays, the others in separate designs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..design import Design, with_values
from ..design.paths import quantity_of
from ..evaluation import PreparedDesign, prepare
from ..evaluation.build import Many, evaluate_many
from ..evaluation.limits import extremes
from ..evaluation.plugin import Plugin, with_own
from .plan import MOST_TESTED, Plan, SweepAxis, SweepPoints

CACHED = 64
"""Number of prepared designs that a process keeps in memory."""

VARIANTS = 8
"""Maximum number of text combinations in which the program checks whether a number can vary as an
array. Texts are choices such as materials."""

AT_ONCE = 4096
"""Maximum number of designs in one model call; more would take memory without saving time."""

SHARES = (0.0, 1.0, 0.5, 0.25, 0.75)
"""Test points in a range, as shares of its width; they are tried until two of them give a valid
design."""

AGREE = 1e-9
"""Relative tolerance in comparing the results of an array with those of single designs."""


class _Variation(NamedTuple):
    """Whether a number can vary as an array, and whether any model reads it."""

    varies: bool
    read: bool


@dataclass
class Designs:
    """The designs of a sweep plan, each prepared when it is needed.

    `apart` are the PATHs of numbers that cannot vary as an array, so that a design is built for
    each value; an example are temperatures that change strengths. `InputError` is raised for a
    number that no model reads in any combination of texts (choices such as materials).
    """

    design: Design
    plan: Plan
    plugins: tuple[Plugin, ...] = ()
    apart: tuple[str, ...] = field(init=False)
    contradicts: bool = field(init=False, default=False)
    """Whether the reader of design files rejected any tested value as a contradiction."""
    _subjects: dict[tuple[object, ...], PreparedDesign | str] = field(
        default_factory=dict, repr=False
    )

    def __post_init__(self) -> None:
        same = self._same_extremes()
        self.apart = tuple(
            axis.path
            for axis in self.plan.numeric
            if (self._is_temperature(axis) and not same) or not self._varies(axis)
        )

    def __getstate__(self) -> dict[str, object]:
        return self.__dict__ | {"_subjects": {}}

    def changed(self, values: Mapping[str, float | str]) -> Design:
        """Return the design with other values; raise `InputError` if it is invalid."""
        if not values:
            return self.design
        metrics = with_own(self.plugins)
        return with_values(self.design, dict(values), metrics=metrics)

    def made(self, values: Mapping[str, float | str]) -> PreparedDesign:
        """Return the prepared design with other values."""
        return prepare(self.changed(values), plugins=self.plugins)

    def _is_temperature(self, axis: SweepAxis) -> bool:
        return quantity_of(axis.path, self.design).dimension == "temperature"

    def _same_extremes(self) -> bool:
        """Whether the lowest and highest temperature stay the same over the sweep.

        Strengths are prepared at these two temperatures. A rise of any temperature in the design
        lowers neither of the two. Both are therefore constant if they are the same with all
        temperatures at their lower ends and with all at their upper ends.
        """
        temperatures = {a.path: a.ends for a in self.plan.numeric if self._is_temperature(a)}
        all_extremes = []
        for end in (0, 1) if temperatures else ():
            ends = {path: both[end] for path, both in temperatures.items()}
            try:
                subject = self.made({**self.plan.texts(0), **ends})
            except InputError:
                return False
            all_extremes.append(extremes(subject.design, subject.numbers))
        return all(pair == all_extremes[0] for pair in all_extremes)

    @property
    def apart_count(self) -> float:
        """Return how many designs must be built for the `apart` numbers; infinite for a range."""
        count = 1.0
        for axis in self.plan.numeric:
            if axis.path in self.apart:
                count *= axis.size or math.inf
        return count

    def _varies(self, axis: SweepAxis) -> bool:
        """Whether a number can vary as an array, checked in some combinations of texts.

        Raises
        ------
        InputError
            if no model reads it, and it changes no design
        """
        count = self.plan.variants
        variants = np.unique(np.linspace(0, count - 1, min(count, VARIANTS)).astype(int))
        checks = [self._varies_in(axis, int(variant)) for variant in variants]
        varies = all(check.varies for check in checks)
        if varies and len(variants) == count and not any(check.read for check in checks):
            remedy = "vary another number, or check that the design uses the part that it describes"
            raise InputError(
                Diagnostic("no model of this design uses this number", remedy, path=axis.path)
            )
        return varies

    def _varies_in(self, axis: SweepAxis, variant: int) -> _Variation:
        """Whether an array of all test values gives the same results as separate designs."""
        texts = self.plan.texts(variant)
        separate: dict[float, Many] = {}
        for value, mandatory in _test_values(axis):
            if len(separate) >= 2 and not mandatory:
                continue
            try:
                separate[value] = evaluate_many(self.made({**texts, axis.path: value}), {}, 1)
            except InputError:
                self.contradicts = True
        if not separate:
            return _Variation(False, True)
        base = self._prepared(variant, {})  # like the rows, where "worst" ignores the position
        if isinstance(base, str):
            base = self.made({**texts, axis.path: next(iter(separate))})
        combined = evaluate_many(base, {axis.path: np.array(list(separate))}, len(separate))
        singles = [single.metrics for single in separate.values()]
        expected = [[single[name][0] for single in singles] for name in combined.names]
        close = np.isclose(combined.values, expected, rtol=AGREE, atol=0.0, equal_nan=True)
        return _Variation(bool(close.all()), axis.path in combined.read)

    def alike(self, points: SweepPoints) -> Iterator[tuple[Array, int, dict[str, float]]]:
        """Group the points that share a prepared design.

        Yield for each group the indices of its points, the number of its combination of texts, and
        the values of its `apart` numbers by PATH.
        """
        paths = [axis.path for axis in self.plan.numeric]
        separate_axes = [k for k, path in enumerate(paths) if path in self.apart]
        if not separate_axes and self.plan.variants == 1:
            yield np.arange(len(points.variant)), 0, {}
            return
        keys = np.vstack([points.variant.astype(float), points.numbers[separate_axes]])
        unique, which = np.unique(keys, axis=1, return_inverse=True)
        order = np.argsort(which.ravel(), kind="stable")
        starts = np.searchsorted(which.ravel()[order], np.arange(unique.shape[1]))
        for number, indices in enumerate(np.split(order, starts[1:])):
            variant, *set_apart = unique[:, number]
            fixed = {paths[k]: float(x) for k, x in zip(separate_axes, set_apart, strict=True)}
            yield indices, int(variant), fixed

    def groups(
        self, points: SweepPoints
    ) -> Iterator[tuple[Array, PreparedDesign | str, dict[str, Array]]]:
        """Yield the points of each prepared design, with the arrays of its varied numbers.

        For an invalid design, yield the reason instead of the design.
        """
        paths = [axis.path for axis in self.plan.numeric]
        for indices, variant, fixed in self.alike(points):
            subject = self._prepared(variant, fixed)
            for first in range(0, len(indices), AT_ONCE):
                places = indices[first : first + AT_ONCE]
                varied = {
                    path: points.numbers[k][places]
                    for k, path in enumerate(paths)
                    if path not in self.apart
                }
                yield places, subject, varied

    def _prepared(self, variant: int, fixed: dict[str, float]) -> PreparedDesign | str:
        """Return a prepared design, or why it is invalid; the last `CACHED` designs are kept."""
        key = (variant, *fixed.values())
        if key not in self._subjects:
            if len(self._subjects) >= CACHED:
                self._subjects.pop(next(iter(self._subjects)))
            try:
                self._subjects[key] = self.made({**self.plan.texts(variant), **fixed})
            except InputError as error:
                self._subjects[key] = first_fault(error)
        return self._subjects[key]


def _test_values(axis: SweepAxis) -> Iterator[tuple[float, bool]]:
    """Yield test values of an axis, and whether each of them must be tested.

    All values of a short list must be tested; of the values in a range, two that give valid designs
    suffice. Zero must be tested too, because it may make another kind of design (no speed, no
    angle).
    """
    assert axis.values is not None
    low, high = axis.values[[0, -1]]
    if axis.listed:
        step = -(-len(axis.values) // MOST_TESTED)
        chosen = [*axis.values[::step].tolist(), float(high)]
        yield from ((value, True) for value in dict.fromkeys(chosen))
        if 0.0 in axis.values and 0.0 not in chosen:
            yield 0.0, True
    elif low * high < 0 and axis.count:
        near = round(low / (low - high) * (axis.count - 1))
        if float(axis.at(np.array(near))) == 0.0:
            yield 0.0, True
    for share in SHARES:
        yield float(low + share * (high - low)), False


def first_fault(error: InputError) -> str:
    """Return the first fault as text."""
    fault = error.diagnostics[0]
    return fault.message if fault.path is None else f"{fault.path}: {fault.message}"
