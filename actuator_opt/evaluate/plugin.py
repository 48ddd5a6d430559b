"""A user's own metrics and constraints, from a script or a ``--plugin`` file.

A metric is a function of a `View`: it reads numbers of the design by PATH and the project's
metrics by name, and returns an array. Written with the operators and NumPy functions that take
complex numbers it gets exact gradients; otherwise the optimiser falls back to differences.
"""

from __future__ import annotations

import importlib.util
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ..errors import Diagnostic, InputError
from ..numeric import Array, maximum
from ..quantities import METRICS, Quantity
from ..units import BASE, UnitError, unit
from .values import Values

_MARK = "_actuator_opt_plugin"


class View:
    """What a user's metric may read: numbers by PATH, metrics by name; SI."""

    def __init__(self, values: Values, metrics: Mapping[str, Mapping[str, Array]]) -> None:
        self._values = values
        self._metrics = metrics

    def __getitem__(self, path: str) -> Array:
        """The number at a PATH (``cylinder.bore``), a float or an array of designs."""
        if path not in self._values:
            raise KeyError(f"no number at {path}")
        return self._values[path]

    def metric(self, name: str) -> Array:
        """A computed metric; of several places the largest."""
        if name not in self._metrics:
            raise KeyError(f"no metric {name}")
        places = list(self._metrics[name].values())
        worst = places[0]
        for place in places[1:]:
            worst = maximum(worst, place)
        return worst


@dataclass(frozen=True, slots=True)
class Plugin:
    """A user's metric; with a `sense` it is also a constraint against zero."""

    name: str
    quantity: Quantity
    function: Callable[[View], Array]
    sense: Literal["min"] | None = None
    file: str = ""

    def call(self, values: Values, metrics: Mapping[str, Mapping[str, Array]]) -> Array:
        """The metric's value; an exception of the user's function becomes one clear line."""
        try:
            return self.function(View(values, metrics))
        except (ArithmeticError, LookupError, TypeError, ValueError, AttributeError) as error:
            raise _fault(self, error) from error


class PluginError(InputError):
    """A user's function raised."""


def _fault(plugin: Plugin, error: BaseException) -> PluginError:
    frames = traceback.extract_tb(error.__traceback__)
    last = next((f for f in reversed(frames) if f.filename == plugin.file), frames[-1])
    detail = error.args[0] if isinstance(error, KeyError) and error.args else error
    return PluginError(
        Diagnostic(
            f"{plugin.name} raised {type(error).__name__}: {detail}",
            "mend the function, or guard its input",
            file=plugin.file or last.filename,
            line=last.lineno,
        )
    )


def metric(
    name: str, *, dimension: str = "ratio", unit_name: str = "", label: str = ""
) -> Callable[[Callable[[View], Array]], Callable[[View], Array]]:
    """Declare a function as a metric: usable in requirements and objectives by its name.

    Parameters
    ----------
    name : name in design files; must not be one of the project's metrics
    dimension : a dimension of `units.BASE` (``"length"``, ``"ratio"``, …)
    unit_name : display unit; default the SI unit
    label : what tables and reports call it
    """
    if name in METRICS:
        raise InputError(f"{name} is a metric of the project; choose another name")
    if dimension not in BASE:
        raise InputError(f"{dimension} is no dimension; use one of {', '.join(BASE)}")
    shown = unit_name or BASE[dimension]
    if shown:
        try:
            unit(shown, dimension)
        except UnitError as error:
            raise InputError(f"metric {name}: {error}") from None
    quantity = Quantity(name, name, dimension, shown, label or name.replace("_", " "))

    def mark(function: Callable[[View], Array]) -> Callable[[View], Array]:
        setattr(function, _MARK, Plugin(name, quantity, function))
        return function

    return mark


def constraint(
    name: str, *, label: str = ""
) -> Callable[[Callable[[View], Array]], Callable[[View], Array]]:
    """Declare a function as a constraint: its value, a relative margin, must be at least 0."""

    def mark(function: Callable[[View], Array]) -> Callable[[View], Array]:
        metric(name, label=label)(function)
        found: Plugin = getattr(function, _MARK)
        setattr(function, _MARK, Plugin(name, found.quantity, function, "min"))
        return function

    return mark


def collect(*functions: Callable[[View], Array]) -> tuple[Plugin, ...]:
    """The plugins that `metric` or `constraint` declared on functions of a script."""
    found = []
    for function in functions:
        plugin = getattr(function, _MARK, None)
        if plugin is None:
            name = getattr(function, "__name__", "?")
            raise InputError(f"{name} is not declared; decorate it with @metric or @constraint")
        found.append(plugin)
    return tuple(found)


def load(path: str | Path) -> tuple[Plugin, ...]:
    """The plugins of a Python file."""
    path = Path(path)
    if not path.is_file():
        raise InputError(Diagnostic("no such file", "give the path of a Python file", str(path)))
    spec = importlib.util.spec_from_file_location(f"_plugin_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise InputError(Diagnostic("not a Python file", "name it *.py", str(path)))
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except SyntaxError as error:
        raise InputError(
            Diagnostic(f"syntax error: {error.msg}", "", str(path), error.lineno, error.offset)
        ) from None
    except InputError:
        raise
    except (
        ImportError,
        ArithmeticError,
        LookupError,
        TypeError,
        ValueError,
        AttributeError,
        NameError,
        OSError,
    ) as error:
        line = traceback.extract_tb(error.__traceback__)[-1].lineno
        raise InputError(
            Diagnostic(f"{type(error).__name__}: {error}", "", str(path), line)
        ) from None
    marked = [getattr(value, _MARK, None) for value in vars(module).values() if callable(value)]
    plugins = [plugin for plugin in marked if isinstance(plugin, Plugin)]
    if not plugins:
        raise InputError(
            Diagnostic(
                "declares no metric and no constraint",
                "decorate a function with @actuator_opt.metric or @actuator_opt.constraint",
                str(path),
            )
        )
    unique = {plugin.name: plugin for plugin in plugins}
    return tuple(
        Plugin(p.name, p.quantity, p.function, p.sense, str(path)) for p in unique.values()
    )
