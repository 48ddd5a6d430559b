"""Wrong arguments of public functions, explained in one line.

Annotations are only compared with the arguments after a function has failed, so that a call with
valid arguments costs next to nothing. If all arguments fit, the failure is a fault of the program
and stays as it is.
"""

from __future__ import annotations

import inspect
import types
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import wraps
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, ParamSpec, TypeAlias, TypeVar, Union, get_args, get_origin

from .errors import ActuatorError, Diagnostic, UsageError, shown
from .threads import one_thread

SEEDS = 2**32
"""Number of seeds that every random generator takes."""

Change: TypeAlias = tuple[str, str | None]
"""A PATH and the text of its new value; None removes the key."""

SetValues: TypeAlias = Mapping[str, str | float | None] | Sequence[Change]
"""Type of every argument `set`: new values by PATH, numbers in SI; None removes the key."""

P = ParamSpec("P")
R = TypeVar("R")

_WORDS = {
    str: "a text", Path: "a path", int: "a whole number", float: "a number", bool: "True or False",
    type(None): "None",
}  # fmt: skip


class WrongArgument(UsageError):
    """An argument of another type; the outermost public function that received it is named."""


def guarded(function: Callable[P, R]) -> Callable[P, R]:
    """A public function that raises `UsageError` for an argument of another type.

    While it runs, linear algebra has one thread (see `threads`).

    Examples
    --------
    >>> @guarded
    ... def area(diameter: float) -> float:
    ...     return 0.785 * diameter**2
    >>> area("25 mm")
    Traceback (most recent call last):
    ...
    actuator_opt.base.arguments.WrongArgument: area: diameter is "25 mm"; give a number
    """

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        for name, value in kwargs.items():
            if isinstance(value, int):
                _require_usual(f"{function.__name__}: {name}", name, value)
        try:
            with one_thread():
                return function(*args, **kwargs)
        except Exception as error:
            if isinstance(error, ActuatorError) and not isinstance(error, WrongArgument):
                raise
            if "set" in kwargs and isinstance(error, TypeError):
                _require_set(function)
            fault = next(_faults(function, args, kwargs), None)
            if fault is None:
                raise
            raise WrongArgument(fault) from None

    return call


def _require_set(function: Callable[..., Any]) -> None:
    """Refuse new values for a function that takes none; raises `UsageError`."""
    parameters = inspect.signature(function).parameters
    if "set" not in parameters and "design" in parameters:
        message = f"{function.__name__}: takes no set"
        remedy = "read the design with set, or give design.changed({...})"
        raise UsageError(Diagnostic(message, remedy)) from None


def _require_usual(place: str, name: str, value: int) -> None:
    """Refuse a whole number that no generator or processor takes; raises `UsageError`."""
    if name == "seed" and not 0 <= value < SEEDS:
        raise UsageError(Diagnostic(f"{place} is {_text(value)}", f"give 0 to {SEEDS - 1}"))
    if value.bit_length() > 63:
        raise UsageError(Diagnostic(f"{place} is {_text(value)}", "give a smaller number"))


def _faults(
    function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]
) -> Iterator[Diagnostic]:
    """A fault for each argument that does not fit its annotation."""
    signature = inspect.signature(function)
    try:
        bound = signature.bind(*args, **kwargs)
    except TypeError:  # Python's own message names the argument
        return
    names = _Names(function)
    for name, value in bound.arguments.items():
        parameter = signature.parameters[name]
        if parameter.kind in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
            continue
        hint = names.hint(parameter.annotation)
        place = _misfit(value, hint)
        if place is not None:
            where, item, wanted = place
            words = " or ".join(dict.fromkeys(_words(wanted)))
            message = f"{function.__name__}: {name}{where} is {shown(_text(item))}"
            yield Diagnostic(message, f"give {words}" if words else "")


class _Names(dict[str, Any]):
    """Names in annotations, also of classes that are only imported for type checkers."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function.__globals__)
        self._package = import_module(__package__.partition(".")[0])

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        return self.hint(value) if isinstance(value, str) else value  # an alias in quotes

    def __missing__(self, name: str) -> Any:
        public = getattr(self._package, name, None)
        if public is None:
            raise KeyError(name)
        return public

    def hint(self, annotation: Any) -> Any:
        """The type that an annotation states; `Any` if a name in it is unknown."""
        if not isinstance(annotation, str):
            return annotation
        try:
            return self.hint(eval(annotation, {}, self))
        except (NameError, TypeError):
            return Any


def _misfit(value: Any, hint: Any, where: str = "") -> tuple[str, Any, Any] | None:
    """Where a value does not fit a type: place, item, and the type it needs; None if it fits."""
    origin, inside = get_origin(hint), get_args(hint)
    if hint is Any or isinstance(hint, str | TypeVar):
        return None
    if origin in (Union, types.UnionType):
        misfits = [_misfit(value, option, where) for option in inside]
        if None in misfits:
            return None
        deeper = [misfit for misfit in misfits if misfit and misfit[0] != where]
        return deeper[0] if deeper else (where, value, hint)
    if origin is Literal:
        return None if value in inside else (where, value, hint)
    kind = origin or hint
    if not isinstance(kind, type):
        return None
    if kind is float:
        kind = (int, float)
    if not isinstance(value, kind) or (isinstance(value, str) and _holds_items(origin)):
        return where, value, hint
    if isinstance(value, Mapping) and len(inside) == 2:
        pairs = [(f"{where}[{key!r}]", item, inside[1]) for key, item in value.items()]
        pairs += [(f"{where}: key", key, inside[0]) for key in value]
    elif isinstance(value, Collection) and _holds_items(origin) and len(inside) == 1:
        pairs = [(f"{where}[{k}]", item, inside[0]) for k, item in enumerate(value)]
    else:
        return None
    return next(filter(None, (_misfit(item, wanted, at) for at, item, wanted in pairs)), None)


def _holds_items(origin: Any) -> bool:
    return isinstance(origin, type) and issubclass(origin, Collection)


def _words(hint: Any) -> list[str]:
    """A type in words, one for each alternative."""
    origin, inside = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return [word for option in inside for word in _words(option)]
    if origin is Literal:
        return [repr(option) for option in inside]
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return ["a mapping"]
    if _holds_items(origin):
        return [f"a list of {' or '.join(_words(inside[0]))}".replace("of a ", "of ")]
    if hint in _WORDS:
        return [_WORDS[hint]]
    return [getattr(hint, "__name__", "")]


def _text(value: Any) -> str:
    if isinstance(value, int) and value.bit_length() > 63:
        return f"a whole number of {value.bit_length()} bits"  # Python prints no endless digits
    if isinstance(value, str):
        return f'"{shown(value, 58)}"'
    if value is None or isinstance(value, bool | int | float):
        return str(value)
    return f"of type {type(value).__name__}"
