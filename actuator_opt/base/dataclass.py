"""`dataclass` as in the standard library, but classes are created in a tenth of the time.

The standard decorator writes and compiles six functions for every class: 1 ms for a frozen class
with slots, so that 250 classes cost a quarter of a second before any work. Here ``__init__`` is
compiled when a class has made a few objects, and all other methods are shared functions that read
the fields. `dataclasses.field`, `fields`, `replace`, `asdict` and `is_dataclass` work as usual.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Iterable
from dataclasses import MISSING, Field, FrozenInstanceError, field
from reprlib import Repr, recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(cls: Any = None, /, **options: bool) -> Any:
        """Make a class a data class.

        Parameters
        ----------
        frozen, slots, kw_only, eq, repr : as in `dataclasses.dataclass`; there are no other options

        Examples
        --------
        >>> @dataclass(frozen=True, slots=True)
        ... class Rod:
        ...     diameter: float
        ...     length: float = 0.3
        >>> Rod(0.02)
        Rod(diameter=0.02, length=0.3)
        """
        return _made(cls, **options) if cls is not None else lambda cls: _made(cls, **options)


__all__ = ["dataclass"]

_FIELD: Any = dataclasses._FIELD  # type: ignore[attr-defined]
_METHODS = ("__setattr__", "__delattr__", "__getstate__", "__setstate__")


FEW = 10
"""Number of objects of a class after which its ``__init__`` is compiled; compiling takes as long as
making 30 objects."""


class _Options:
    """Options of a data class, under the names that `dataclasses` reads."""

    init = match_args = True
    order = unsafe_hash = weakref_slot = False

    def __init__(self, frozen: bool, slots: bool, kw_only: bool, eq: bool, repr: bool) -> None:
        self.made = 0  # objects, until `__init__` is compiled
        self.frozen, self.slots, self.kw_only, self.eq, self.repr = frozen, slots, kw_only, eq, repr


def _made(
    cls: Any,
    *,
    frozen: bool = False,
    slots: bool = False,
    kw_only: bool = False,
    eq: bool = True,
    repr: bool = True,
) -> Any:
    """Add the methods of a data class to a class; with `slots`, to a new class of that name."""
    fields: dict[str, Field[Any]] = {}
    for base in cls.__mro__[-1:0:-1]:
        fields.update(getattr(base, "__dataclass_fields__", {}))
    own = cls.__dict__
    for name, annotation in own.get("__annotations__", {}).items():
        if not str(annotation).startswith(("ClassVar", "typing.ClassVar")):
            fields[name] = _field(cls, name, annotation, kw_only)
    methods: dict[str, Any] = {
        "__dataclass_fields__": fields,
        "__dataclass_params__": _Options(frozen, slots, kw_only, eq, repr),
        "__match_args__": tuple(
            name for name, each in fields.items() if each.init and not each.kw_only
        ),
    }
    if "__init__" not in own:
        methods |= {"__init__": _first_init, "__signature__": _Signature()}
    if repr and "__repr__" not in own:
        methods["__repr__"] = _repr
    if eq and "__eq__" not in own:
        methods["__eq__"] = _eq
    if eq and ("__hash__" not in own or (own["__hash__"] is None and "__eq__" in own)):
        methods["__hash__"] = _hash if frozen else None
    if frozen:
        methods |= {"__setattr__": _refuse, "__delattr__": _refuse}
        if slots:
            methods |= {"__getstate__": _getstate, "__setstate__": _setstate}
    for name in _METHODS:
        if name in own:
            methods.pop(name, None)
    if not slots:
        for name, method in methods.items():
            setattr(cls, name, method)
        return cls
    inherited = {name for base in cls.__mro__[1:] for name in getattr(base, "__slots__", ())}
    content = {name: value for name, value in own.items() if name not in fields}
    content.pop("__dict__", None)
    content.pop("__weakref__", None)
    content |= methods | {"__slots__": tuple(name for name in fields if name not in inherited)}
    made = type(cls)(cls.__name__, cls.__bases__, content)
    made.__qualname__ = cls.__qualname__
    return made


def _field(cls: Any, name: str, annotation: Any, kw_only: bool) -> Field[Any]:
    """The field of an annotated name; its default stays on the class."""
    default = cls.__dict__.get(name, MISSING)
    if isinstance(default, Field):
        made = default
        if made.default is MISSING:
            delattr(cls, name)
        else:
            setattr(cls, name, made.default)
    else:
        made = field() if inspect.ismemberdescriptor(default) else field(default=default)
    if made.default is not MISSING and made.default.__class__.__hash__ is None:
        raise ValueError(f"{cls.__name__}.{name}: a mutable default needs a default_factory")
    made.name, made.type = name, annotation
    made._field_type = _FIELD  # type: ignore[attr-defined]
    if made.kw_only is MISSING:
        made.kw_only = kw_only
    return made


def _first_init(self: Any, *args: Any, **arguments: Any) -> None:
    """Initialise the first `FEW` objects; for more, or a wrong argument, compile ``__init__``."""
    cls: Any = next(
        each for each in type(self).__mro__ if each.__dict__.get("__init__") is _first_init
    )
    options = cls.__dataclass_params__
    options.made += 1
    values = _values(cls, args, arguments) if options.made <= FEW else None
    if values is None:
        cls.__init__ = _compiled_init(cls)
        cls.__init__(self, *args, **arguments)
        return
    put = object.__setattr__ if options.frozen else setattr
    for name, value in values.items():
        put(self, name, value)
    if hasattr(cls, "__post_init__"):
        self.__post_init__()


def _values(cls: Any, args: tuple[Any, ...], arguments: dict[str, Any]) -> dict[str, Any] | None:
    """Values of the fields by the arguments of ``__init__``; None if an argument is wrong."""
    given = dict(zip(cls.__match_args__, args, strict=False))
    if len(given) < len(args) or given.keys() & arguments.keys():
        return None
    given |= arguments
    values = {}
    for name, each in cls.__dataclass_fields__.items():
        if each.init and name in given:
            values[name] = given.pop(name)
        elif each.default_factory is not MISSING:
            values[name] = each.default_factory()
        elif each.default is not MISSING:
            values[name] = each.default
        elif each.init:
            return None
    return None if given else values


def _compiled_init(cls: Any) -> Any:
    """The ``__init__`` of a class, compiled from its fields."""
    names: dict[str, Any] = {"_set": object.__setattr__, "_MISSING": MISSING}
    positional, lines = ["self"], []
    keywords: list[str] = []
    for name, each in cls.__dataclass_fields__.items():
        value, argument = name, name
        if each.default_factory is not MISSING:
            names[f"_new_{name}"] = each.default_factory
            value = f"_new_{name}()"
            if each.init:
                value, argument = f"{value} if {name} is _MISSING else {name}", f"{name}=_MISSING"
        elif each.default is not MISSING:
            names[f"_default_{name}"] = each.default
            argument = f"{name}=_default_{name}"
            value = name if each.init else f"_default_{name}"
        elif not each.init:
            continue  # set by ``__post_init__``
        if each.init:
            (keywords if each.kw_only else positional).append(argument)
        frozen = cls.__dataclass_params__.frozen
        lines.append(f"_set(self, {name!r}, {value})" if frozen else f"self.{name} = {value}")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    arguments = ", ".join([*positional, *(["*", *keywords] if keywords else [])])
    exec(f"def __init__({arguments}):\n " + "\n ".join(lines or ["pass"]), names)
    init = names["__init__"]
    init.__qualname__, init.__module__ = f"{cls.__qualname__}.__init__", cls.__module__
    return init


class _Signature:
    """Signature of a data class for `inspect` and `help`, before ``__init__`` is compiled."""

    def __get__(self, instance: Any, owner: Any) -> inspect.Signature:
        kinds = inspect.Parameter
        parameters = []
        for name, each in owner.__dataclass_fields__.items():
            if each.init:
                kind = kinds.KEYWORD_ONLY if each.kw_only else kinds.POSITIONAL_OR_KEYWORD
                default = kinds.empty if each.default is MISSING else each.default
                if each.default_factory is not MISSING:
                    default = each.default_factory
                parameters.append(
                    inspect.Parameter(name, kind, default=default, annotation=each.type)
                )
        return inspect.Signature(sorted(parameters, key=lambda parameter: parameter.kind))


def _compared(self: Any) -> tuple[Any, ...]:
    fields = self.__dataclass_fields__
    return tuple(getattr(self, name) for name, each in fields.items() if each.compare)


def _eq(self: Any, other: Any) -> Any:
    """Whether all compared fields of two objects of one class are equal."""
    same = other.__class__ is self.__class__
    return _compared(self) == _compared(other) if same else NotImplemented


def _hash(self: Any) -> int:
    """Hash of the fields that are hashed, by default those that are compared."""
    fields = self.__dataclass_fields__.items()
    hashed = [name for name, each in fields if (each.compare if each.hash is None else each.hash)]
    return hash(tuple(getattr(self, name) for name in hashed))


LONGEST_REPR = 120
"""Largest number of characters of a repr."""


class _ShortRepr(Repr):
    """Values as text; long ones are cut, and an array only states its shape."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = 40

    def repr_ndarray(self, value: Any, level: int) -> str:
        """Shape of a NumPy array, by which this method is named."""
        return f"array{value.shape}"


_VALUES = _ShortRepr()


def brief(name: str, fields: Iterable[tuple[str, object]]) -> str:
    """Name of a class with the values of its fields, in one line of at most `LONGEST_REPR`.

    >>> brief("Rod", [("diameter", 0.02), ("walls", tuple(range(100)))])
    'Rod(diameter=0.02, walls=(0, 1, 2, 3, 4, 5, ...))'
    """
    text = ""
    for field_name, value in fields:
        text += f"{', ' if text else ''}{field_name}={' '.join(_VALUES.repr(value).split())}"
        if len(name) + len(text) + 2 > LONGEST_REPR:
            return f"{name}({text[: LONGEST_REPR - len(name) - 3]}…)"
    return f"{name}({text})"


@recursive_repr()
def _repr(self: Any) -> str:
    """Text with the name of the class and the values of its fields, shortened (see `brief`)."""
    fields = self.__dataclass_fields__.items()
    shown = ((name, getattr(self, name)) for name, each in fields if each.repr)
    return brief(type(self).__qualname__, shown)


def _refuse(self: Any, name: str, *value: Any) -> None:
    """Raise an error, because a frozen object cannot be changed."""
    raise FrozenInstanceError(f"cannot {'assign to' if value else 'delete'} field {name!r}")


def _getstate(self: Any) -> list[Any]:
    """Values of all fields, for `pickle` and `copy`."""
    return [getattr(self, name) for name in self.__dataclass_fields__]


def _setstate(self: Any, state: list[Any]) -> None:
    """Restore the values of all fields."""
    for name, value in zip(self.__dataclass_fields__, state, strict=True):
        object.__setattr__(self, name, value)
