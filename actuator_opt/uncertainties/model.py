"""Margins and metrics of a design as a function of its uncertain inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..evaluation import PreparedDesign, compute
from ..evaluation.governing import governing
from ..evaluation.limits import Limit, all_limits
from ..evaluation.rows import UNLIMITED, MetricArrays, rows_of
from ..evaluation.values import Values
from ..optimisation.problem import Vector
from .inputs import Input

CHUNK = 2048
"""Draws evaluated at a time; this bounds the memory."""
TOLERANCE = 1e-6
"""A limit is met at a margin of -TOLERANCE or more, as in an evaluation."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """Input values (d, n), limit margins (m, n) and metrics (k, n) of a set of draws."""

    values: Vector
    margins: Vector
    metrics: Vector

    @property
    def met(self) -> Vector:
        """Return which limits are met (m, n); a limit without a value is not."""
        return np.asarray(self.margins >= -TOLERANCE)


class Model:
    """A prepared design with uncertain inputs.

    Parameters
    ----------
    subject : the design
    inputs : uncertain inputs
    metrics : metrics to evaluate beside the margins
    """

    def __init__(
        self, subject: PreparedDesign, inputs: Sequence[Input], metrics: Sequence[str] = ()
    ) -> None:
        self.subject = replace(without_basis(subject, inputs), lenient=True)
        self.inputs = tuple(inputs)
        self.metrics = tuple(metrics)
        nominal = compute(self.subject, self.subject.values())
        kept = ("requirement", "case", "check")
        self.limits = tuple(
            limit
            for limit in all_limits(subject.design, subject.plugins)
            if limit.origin in kept
            and (limit.origin != "check" or nominal.computed.metrics.get(limit.metric))
        )
        self.own = np.array([limit.origin != "check" for limit in self.limits], dtype=bool)
        """Which limits are requirements of the design, including forces of its load cases."""
        _require_metrics(self.metrics, nominal.computed)
        self._wanted = {limit.metric for limit in self.limits} | set(self.metrics)

    @property
    def nominal(self) -> Drawn:
        """Return the nominal design."""
        return self.where(np.array([[one.value] for one in self.inputs]).reshape(-1, 1))

    def at(self, shares: Vector) -> Drawn:
        """Return the design at the given quantiles (d, n) of its inputs."""
        drawn = [one.distribution.at(row) for one, row in zip(self.inputs, shares, strict=True)]
        return self.where(np.array(drawn).reshape(len(self.inputs), shares.shape[1]))

    def outputs(self, shares: Vector) -> Vector:
        """Return margins, the least margin of the requirements, and metrics: (m + 1 + k, n)."""
        parts = [
            self.flat(self.at(shares[:, first : first + CHUNK]))
            for first in range(0, shares.shape[1], CHUNK)
        ]
        return np.concatenate(parts, axis=1)

    def flat(self, found: Drawn) -> Vector:
        """Stack margins, their least and metrics; a margin without a value is infinite."""
        margins = np.where(np.abs(found.margins) < 1e9, found.margins, np.nan)
        with np.errstate(all="ignore"):
            least = np.min(found.margins[self.own], axis=0, initial=np.inf)
        return np.concatenate([margins, least[None], found.metrics])

    @np.errstate(all="ignore")
    def where(self, values: Vector) -> Drawn:
        """Return the design at the given input values (d, n), SI."""
        count = values.shape[1]
        varied = {one.path: row for one, row in zip(self.inputs, values, strict=True)}
        numbers = self.subject.values(varied)
        wanted = None if self.subject.plugins else self._wanted
        computed = compute(self.subject, numbers, wanted).computed
        margins = [_margin(limit, computed, numbers, count) for limit in self.limits]
        metrics = [governing(name, computed, numbers, self.subject) for name in self.metrics]
        return Drawn(values, _rows(margins, count), _rows(metrics, count))


def _rows(arrays: Sequence[Vector], count: int) -> Vector:
    """Stack arrays (n,) or (1,) as (len, n)."""
    found = np.empty((len(arrays), count))
    for row, array in zip(found, arrays, strict=True):
        row[:] = array
    return found


def _margin(limit: Limit, computed: MetricArrays, numbers: Values, count: int) -> Vector:
    """Return the least margin of a limit over cases and places (n,); NaN where one has no value."""
    least = np.full(count, np.inf)
    seen = False
    for row in rows_of(limit, computed, numbers):
        least, seen = np.minimum(least, row.margin), True
    return np.where(least > UNLIMITED / 1e6, np.inf, least) if seen else np.full(count, np.nan)


def _require_metrics(metrics: Sequence[str], computed: MetricArrays) -> None:
    for name in metrics:
        if not computed.metrics.get(name):
            why = computed.why.get(name, "this design has no such metric")
            remedy = "choose a metric that `actuator-opt evaluate` lists with a value"
            raise InputError(Diagnostic(f"{name} cannot be evaluated: {why}", remedy))


def without_basis(subject: PreparedDesign, inputs: Sequence[Input]) -> PreparedDesign:
    """Return the design without the basis knock-down of strengths that are drawn.

    The knock-down from mean to allowable accounts for scatter; drawing the strength covers it
    already. Knock-downs for temperature, moisture and process stay.
    """
    drawn = {one.path for one in inputs}
    factors = dict(subject.factors)
    for (name, key, cold), factor in subject.factors.items():
        path = f"materials.{name}.{key}"
        knocked = subject.numbers.get(f"materials.{name}.basis_knockdown")
        entry = subject.materials[name].properties[key]
        if path in drawn and knocked and entry.basis in ("typical", "mean"):
            factors[name, key, cold] = factor / knocked
    return replace(subject, factors=factors) if factors != subject.factors else subject
