"""User metrics and constraints, from a script or a ``--plugin`` file.

A metric is a function of a `View`: it reads numeric inputs of the design by PATH (such as
``cylinder.bore``) and built-in metrics by name, and returns an array. If all operators and NumPy
functions in it accept complex numbers, the optimiser calculates its exact gradient; otherwise it
uses finite differences.
"""

from __future__ import annotations

import contextlib
import importlib.util
import re
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, remedy, shown
from ..base.numeric import Array, maximum, minimum
from ..base.quantities import Quantity
from ..base.units import BASE, UnitError, unit
from ..metrics import METRICS, Quantities
from .values import Values

_MARK = "_actuator_opt_plugin"
_LONGEST = 300
"""Largest number of characters that a message quotes of an exception's text."""


class View:
    """Values that a user metric can read, in SI: inputs of the design, and built-in metrics."""

    def __init__(
        self,
        values: Values,
        metrics: Mapping[str, Mapping[str, Array]],
        design: tuple[int, int] | None = None,
    ) -> None:
        self._values = values
        self._metrics = metrics
        self._design = design
        """Index of the single design that the function gets, and number of designs; None if it gets
        all designs at once."""

    def __getitem__(self, path: str) -> Array:
        """The number at a PATH (``cylinder.bore``), a float or an array of designs."""
        if path not in self._values:
            raise KeyError(f"no number at {path}; {remedy(path, self._values.paths)}")
        return self._for_design(self._values[path])

    def metric(self, name: str) -> Array:
        """A built-in metric; if it has several locations, its worst value."""
        if name not in self._metrics:
            known = {other: METRICS.get(other) for other in self._metrics}
            raise KeyError(f"no metric {name}; {remedy(name, known)}")
        places = list(self._metrics[name].values())
        quantity = METRICS.get(name)
        pick = minimum if quantity is not None and quantity.worst == "min" else maximum
        worst = places[0]
        for place in places[1:]:
            worst = pick(worst, place)
        return self._for_design(worst)

    def _for_design(self, value: Array) -> Array:
        """Select the value of a single design: a number, or a column with a number per load case.

        If all designs are shown at once, the value is unchanged.
        """
        shape = np.shape(value)
        if self._design is None or not shape:
            return value
        index, count = self._design
        number = value[..., index if shape[-1] == count else 0]
        return number if number.ndim == 0 else number[:, None]


@dataclass(frozen=True, slots=True)
class Plugin:
    """A user metric; if it has a `sense`, it is also a constraint with the limit zero."""

    name: str
    quantity: Quantity
    function: Callable[[View], Array]
    sense: Literal["min"] | None = None
    file: str = ""

    def call(
        self,
        values: Values,
        metrics: Mapping[str, Mapping[str, Array]],
        *,
        lenient: bool = False,
    ) -> PluginValue:
        """The metric of every design; NaN with a reason if the function raised.

        If the function raises an exception for many designs at once, it is called again for each
        design separately. A failing design then does not affect the others, and functions that do
        not support arrays work too. Text that the function prints goes to standard error, because
        standard output is for data.

        Raises
        ------
        PluginError
            The function raised for every design and `lenient` is False, or it returned no number.
        """
        count = _designs(values)
        with contextlib.redirect_stdout(sys.stderr):
            try:
                returned = self._result(values, metrics)
            except PluginError as error:
                value = self._one_by_one(values, metrics, count, error)
                if not lenient and np.isnan(value.value).all():
                    raise
                return value
            return PluginValue(_checked(self, returned, values, count))

    def _result(
        self,
        values: Values,
        metrics: Mapping[str, Mapping[str, Array]],
        design: tuple[int, int] | None = None,
    ) -> object:
        try:
            return self.function(View(values, metrics, design))
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # user code may raise anything
            raise _fault(self, error) from error

    def _one_by_one(
        self,
        values: Values,
        metrics: Mapping[str, Mapping[str, Array]],
        count: int,
        first: PluginError,
    ) -> PluginValue:
        missing = np.full(1, np.nan * (1 + 1j) if _complex(values) else np.nan)
        columns: list[Array] = []
        raised: list[PluginError] = []
        for k in range(count) if values.varied else ():
            try:
                returned = self._result(values, metrics, (k, count))
                columns.append(np.atleast_1d(_checked(self, returned, values, 1)))
            except PluginError as error:
                columns.append(missing)
                raised.append(error)
        if len(raised) == len(columns):
            raised = [first]
        value = np.concatenate(np.broadcast_arrays(*(columns or [missing])), axis=-1)
        return PluginValue(value, str(raised[0].diagnostics[0]) if raised else "")


def with_own(plugins: Iterable[Plugin]) -> dict[str, Quantity]:
    """Quantities of all metrics by name: built-in metrics and user metrics."""
    return Quantities({**METRICS, **{plugin.name: plugin.quantity for plugin in plugins}})


@dataclass(frozen=True, slots=True)
class PluginValue:
    """Result of a user function, and the text of its first exception."""

    value: Array
    raised: str = ""


class PluginError(InputError):
    """A user function raised an exception."""


def _line(error: BaseException, file: str) -> tuple[str, int | None]:
    """Location of an exception: the last line of the user's file in its traceback."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename != __file__]
    user_frames = [f for f in frames if file and Path(f.filename).resolve() == Path(file).resolve()]
    last = (user_frames or frames)[-1] if frames else None
    return file or (last.filename if last else ""), last.lineno if last else None


def _one_line(error: BaseException) -> str:
    """Text of an exception in one line."""
    detail = error.args[0] if isinstance(error, KeyError) and error.args else error
    try:
        words = str(detail)
    except Exception:  # the text itself raises an exception
        words = ""
    return shown(" ".join(f"{type(error).__name__}: {words}".split()).removesuffix(":"), _LONGEST)


def _fault(plugin: Plugin, error: BaseException) -> PluginError:
    file, line = _line(error, plugin.file)
    remedy = "correct the function, or guard its input"
    if isinstance(error, TypeError):
        remedy = "use operators and NumPy functions; float(), int() and math do not accept arrays"
    return PluginError(Diagnostic(f"{plugin.name} raised {_one_line(error)}", remedy, file, line))


def _designs(values: Values) -> int:
    """Number of designs that are evaluated at once."""
    return int(np.broadcast_shapes((1,), *[np.shape(v) for v in values.varied.values()])[-1])


def _complex(values: Values) -> bool:
    """Whether some values are complex, to calculate derivatives by complex steps."""
    return any(np.iscomplexobj(value) for value in values.varied.values())


def _checked(plugin: Plugin, returned: object, values: Values, designs: int) -> Array:
    """Return the array of a user function, after a check: one number per design (and load case)."""
    try:
        array = np.asarray(returned)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # rows of unequal length, or an unusual object
        raise _fault(plugin, error) from error
    shape = np.broadcast_shapes((1,), array.shape) if array.ndim < 2 else array.shape
    plain = not _complex(values)
    message = ""
    if array.dtype.kind not in "biufc":
        message = f"returned {type(returned).__name__}, not a number"
    elif plain and array.dtype.kind == "c":
        message = "returned a complex number"
    elif (
        len(shape) > 2
        or shape[-1] not in (1, designs)
        or shape[0] not in ((1, len(values.cases)) if len(shape) == 2 else (1, designs))
    ):
        message = f"returned an array of shape {array.shape} for {designs} design(s)"
    if message:
        remedy = "return a number, or an array with one number for each design"
        raise PluginError(Diagnostic(f"{plugin.name} {message}", remedy, plugin.file or None))
    return array if array.ndim else array[()]


def metric(
    name: str, *, dimension: str = "ratio", unit_name: str = "", label: str = ""
) -> Callable[[Callable[[View], Array]], Callable[[View], Array]]:
    """Declare a function as a metric, for use in requirements and objectives by name.

    Parameters
    ----------
    name : name in design files; must not be a built-in metric
    dimension : a dimension of `units.BASE` (``"length"``, ``"ratio"``, …)
    unit_name : display unit; default the SI unit
    label : name in tables and reports

    The largest value of all load cases governs, unless a requirement or the objective makes the
    smallest govern.
    """
    if not isinstance(name, str):
        raise InputError('a metric needs a name: write @metric("my_metric") above the function')
    if not name.strip() or re.search(r"[.\[\]=]", name) or not name.isprintable():
        raise InputError(f'"{name}" cannot name a metric; use letters, digits and _')
    if name in METRICS:
        raise InputError(f"{name} is a built-in metric; choose another name")
    if dimension not in BASE:
        raise InputError(f"{dimension} is not a dimension; use one of {', '.join(BASE)}")
    display_unit = unit_name or BASE[dimension]
    if display_unit:
        try:
            unit(display_unit, dimension)
        except UnitError as error:
            raise InputError(f"metric {name}: {error}") from None
    display_label = label or name.replace("_", " ")
    quantity = Quantity(name, name, dimension, display_unit, display_label, worst="max")

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
        plugin: Plugin = getattr(function, _MARK)
        quantity = replace(plugin.quantity, worst="min")
        setattr(function, _MARK, Plugin(name, quantity, function, "min"))
        return function

    return mark


def collect(*functions: Callable[[View], Array]) -> tuple[Plugin, ...]:
    """Return the plugins of functions that a script declared with `metric` or `constraint`."""
    plugins = []
    for function in functions:
        plugin = getattr(function, _MARK, None)
        if plugin is None:
            name = getattr(function, "__name__", "?")
            raise InputError(f"{name} is not declared; decorate it with @metric or @constraint")
        plugins.append(plugin)
    return tuple(plugins)


def _marked(values: Iterable[object]) -> list[Plugin]:
    """Plugins among the values of a module; values whose access raises an exception are skipped."""
    plugins = []
    for value in values:
        with contextlib.suppress(Exception):
            plugin = getattr(value, _MARK, None) if callable(value) else None
            if type(plugin) is Plugin:
                plugins.append(plugin)
    return plugins


def load(path: str | Path) -> tuple[Plugin, ...]:
    """Load the plugins that a Python file declares."""
    path = Path(path)
    try:
        is_file = path.is_file()
    except OSError as error:
        reason = f"cannot be read: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, "give the path of a Python file", str(path))) from None
    if not is_file:
        raise InputError(Diagnostic("no such file", "give the path of a Python file", str(path)))
    spec = importlib.util.spec_from_file_location(f"_plugin_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise InputError(Diagnostic("not a Python file", "name it *.py", str(path)))
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses and pickle look up their module there
    try:
        with contextlib.redirect_stdout(sys.stderr):
            spec.loader.exec_module(module)
            plugins = _marked(vars(module).values())
    except KeyboardInterrupt:
        raise
    except SyntaxError as error:
        place = (str(path), error.lineno, error.offset)
        raise InputError(Diagnostic(f"syntax error: {error.msg}", "", *place)) from None
    except InputError as error:
        line = _line(error, str(path))[1]
        raise InputError(
            [replace(fault, file=str(path), line=line) for fault in error.diagnostics]
        ) from None
    except BaseException as error:  # user code may raise anything
        line = _line(error, str(path))[1]
        raise InputError(
            Diagnostic(_one_line(error), "correct the file", str(path), line)
        ) from None
    if not plugins:
        raise InputError(
            Diagnostic(
                "declares no metrics or constraints",
                "decorate a function with @actuator_opt.metric or @actuator_opt.constraint",
                str(path),
            )
        )
    unique: dict[str, Plugin] = {}
    for plugin in plugins:
        if unique.setdefault(plugin.name, plugin).function is not plugin.function:
            message = f"{plugin.name} is declared twice"
            raise InputError(Diagnostic(message, "give each metric its own name", str(path)))
    return tuple(replace(plugin, file=str(path)) for plugin in unique.values())
