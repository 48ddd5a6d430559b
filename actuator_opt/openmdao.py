"""Components that bring an actuator into an OpenMDAO model (extra `openmdao`).

`EvaluateComponent` evaluates a design; `OptimumComponent` optimises it, so that a system sees only
the optimum. Partial derivatives are exact: derivatives of the models, and prices of the optimum.
All values are SI.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .api.actuator import Actuator, Result, as_actuator, located
from .api.session_results import Price
from .api.sessions import Session
from .base.errors import ActuatorError, Diagnostic, InputError, UsageError, library, remedy
from .base.numeric import STEP, namespace
from .base.quantities import Quantity
from .base.symbolic.recorded import RecordedFunction
from .design import Design, canonical, quantity_of
from .evaluation.kernel import compute, governing
from .metrics import METRICS

if TYPE_CHECKING or find_spec("openmdao") is None:

    class ExplicitComponent:
        """Stands in for OpenMDAO's class where OpenMDAO is not installed."""

        def __init__(self, **_: Any) -> None:
            library("openmdao.api")  # raises

        def __getattr__(self, name: str) -> Any: ...

else:
    ExplicitComponent = library("openmdao.api").ExplicitComponent

ONE_SIDED = 1e-6
"""Relative difference of the prices of a decrease and an increase, above which an optimum has no
derivative by that number."""


def variable_name(path: str) -> str:
    """Name of a PATH in OpenMDAO, which allows no dots and brackets.

    >>> variable_name("load_cases[stance].force")
    'load_cases_stance_force'
    """
    return re.sub(r"\W+", "_", path).strip("_")


def _unit(quantity: Quantity) -> str | None:
    """SI unit of a quantity as OpenMDAO writes it; None for ratios."""
    return quantity.si_unit.replace("^", "**") or None


class _Component(ExplicitComponent):
    """A component with numbers of a design as inputs, and some outputs in SI."""

    def __init__(
        self,
        design: Actuator | Design | Result | str | Path,
        *,
        inputs: Sequence[str],
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.actuator = as_actuator(design)
        if isinstance(inputs, str) or not len(inputs):
            raise UsageError(Diagnostic("inputs: name one or more PATHs", 'e.g. ["cylinder.bore"]'))
        with located(self.actuator):
            self.paths = [canonical(path, self.actuator.design) for path in inputs]
            self.quantities = [quantity_of(path, self.actuator.design) for path in self.paths]
        self.names = [variable_name(path) for path in self.paths]
        if len(set(self.names)) < len(self.names):
            raise UsageError(Diagnostic("inputs: a PATH is named twice", "name it once"))
        numbers = self.actuator.subject().numbers
        for path in self.paths:
            if path not in numbers:
                message = "the design does not state a number for it"
                raise InputError(Diagnostic(message, remedy(path, numbers), path=path))
        self.present = np.array([float(numbers[path]) for path in self.paths])

    def _declare(self, outputs: Mapping[str, Quantity]) -> None:
        for name, value, quantity in zip(self.names, self.present, self.quantities, strict=True):
            self.add_input(name, val=value, units=_unit(quantity), desc=quantity.label)
        for name, quantity in outputs.items():
            self.add_output(name, units=_unit(quantity), desc=quantity.label)
        self.declare_partials("*", "*")

    def _numbers(self, inputs: Any) -> np.ndarray[Any, Any]:
        return np.array([float(inputs[name][0]) for name in self.names])


class EvaluateComponent(_Component):
    """Metrics of a design as functions of some of its numbers, with exact partial derivatives.

    Parameters
    ----------
    design : the design, or its file
    inputs : PATHs of numbers; in OpenMDAO, ``cylinder.bore`` is named ``cylinder_bore``
    outputs : metrics; each has its governing value, the worst of all load cases and places

    Raises
    ------
    InputError
        a PATH or metric is unknown, or the design has no value for it
    ActuatorError
        OpenMDAO is not installed; in `compute`, a metric without a finite value

    Notes
    -----
    Where another load case or place becomes governing, a metric has a kink; the derivative is that
    of the governing one.
    """

    def __init__(
        self,
        design: Actuator | Design | Result | str | Path,
        *,
        inputs: Sequence[str],
        outputs: Sequence[str] = ("mass",),
        **options: Any,
    ) -> None:
        super().__init__(design, inputs=inputs, **options)
        self.metrics = [outputs] if isinstance(outputs, str) else list(outputs)
        self.subject = self.actuator.subject()
        known = compute(self.subject, self.subject.values()).computed
        for metric in self.metrics:
            if metric not in METRICS:
                message = f'outputs: "{metric}" is not a metric'
                raise InputError(Diagnostic(message, remedy(metric, METRICS)))
            if not known.metrics.get(metric):
                why = known.why.get(metric, "this design has no such metric")
                raise InputError(Diagnostic(f"outputs: {metric} has no value: {why}"))
        self.rows = RecordedFunction(self._rows, self.paths, self.present)

    def _rows(self, points: Any) -> Any:
        """Governing value of each metric (metrics, k) at points (inputs, k)."""
        numbers = self.subject.values(dict(zip(self.paths, points, strict=True)))
        computed = compute(self.subject, numbers, set(self.metrics)).computed
        rows = [governing(metric, computed, numbers, self.subject) for metric in self.metrics]
        xp = namespace(*rows)
        shape = (points.shape[1],)
        return xp.stack([xp.broadcast_to(xp.asarray(row), shape) for row in rows])

    def setup(self) -> None:
        """Declare inputs and outputs."""
        self._declare({metric: METRICS[metric] for metric in self.metrics})

    def compute(self, inputs: Any, outputs: Any) -> None:
        """Evaluate the metrics."""
        values = self.rows(self._numbers(inputs)[:, None])[:, 0]
        for metric, value in zip(self.metrics, values, strict=True):
            if not np.isfinite(value):
                message = f"{metric} has no finite value at these inputs"
                raise ActuatorError(Diagnostic(message, "keep the inputs within valid bounds"))
            outputs[metric] = value

    def compute_partials(self, inputs: Any, partials: Any) -> None:
        """Differentiate the metrics."""
        point = self._numbers(inputs)
        steps = STEP * np.eye(len(point))
        slopes = self.rows(point[:, None] + 1j * steps).imag / STEP
        for metric, row in zip(self.metrics, slopes, strict=True):
            for name, slope in zip(self.names, row, strict=True):
                partials[metric, name] = slope


class OptimumComponent(_Component):
    """The objective of the best design as a function of fixed numbers; its partials are the prices.

    The first call solves the design fully, further ones from that optimum.

    Parameters
    ----------
    design : the design with its variables, or its file; its objective is a metric
    inputs : PATHs of fixed numbers, such as requirements, forces or the stroke

    Raises
    ------
    InputError, UsageError
        as for `session`
    Unsolvable
        no design meets all requirements with the values of the inputs
    ActuatorError
        OpenMDAO is not installed; or the price of an input is one-sided here: an increase and a
        decrease have different prices, or only one of them has a design
    """

    def __init__(
        self,
        design: Actuator | Design | Result | str | Path,
        *,
        inputs: Sequence[str],
        **options: Any,
    ) -> None:
        super().__init__(design, inputs=inputs, **options)
        self.session = Session(self.actuator)
        self.metric = self.session.optimum.objective_metric
        if self.metric not in METRICS:
            message = "the objective is a weighted sum, which has no unit"
            raise UsageError(Diagnostic(message, "name one metric", path="objective"))
        self.session.prices(self.paths)  # refuses free dimensions and numbers without derivative
        self._last: tuple[tuple[float, ...], Session] = (tuple(self.present), self.session)

    def _at(self, inputs: Any) -> Session:
        """The session at the optimum for these inputs."""
        point = tuple(self._numbers(inputs).tolist())
        if point != self._last[0]:
            self._last = (point, self.session.at(dict(zip(self.paths, point, strict=True))))
        return self._last[1]

    def setup(self) -> None:
        """Declare inputs and the objective."""
        self._declare({self.metric: METRICS[self.metric]})

    def compute(self, inputs: Any, outputs: Any) -> None:
        """Find the optimum."""
        outputs[self.metric] = self._at(inputs).optimum.objective_value

    def compute_partials(self, inputs: Any, partials: Any) -> None:
        """Price the inputs at the optimum."""
        prices = self._at(inputs).prices(self.paths)
        for name, price in zip(self.names, prices, strict=True):
            partials[self.metric, name] = _two_sided(price)


def _two_sided(price: Price) -> float:
    """The price of a decrease and of an increase, if both are the same."""
    down, up = price.slope_down, price.slope_up
    if down is None or up is None or abs(up - down) > ONE_SIDED * max(abs(up), abs(down)):
        message = "has different prices for a decrease and an increase at this optimum"
        hint = "start from another value, or use EvaluateComponent"
        raise ActuatorError(Diagnostic(message, hint, path=price.path))
    return up
