"""Registries of kinds (such as seal types and friction laws) that a design file names.

Each kind is one module with one frozen dataclass; the registry lists them. Design choices, help,
JSON Schema, fault messages and tests read the registry, so no other code names a kind.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import fields
from importlib import import_module
from types import MappingProxyType
from typing import Any, Protocol, TypeVar

from .errors import remedy

_WORD = re.compile(r"[a-z][a-z0-9_]*")


class Kind(Protocol):
    """Fields that every kind has; a kind is a frozen dataclass."""

    @property
    def name(self) -> str:
        """Name in a design file."""

    @property
    def help(self) -> str:
        """Meaning of the name, as a short phrase."""


K = TypeVar("K", bound=Kind)
V = TypeVar("V")


class UnknownKind(KeyError):
    """A name that is not in the registry."""

    def __str__(self) -> str:
        return str(self.args[0])


class Kinds(dict[str, K]):
    """Kinds by name, in the order given; an unknown name raises `UnknownKind`."""

    def __init__(self, what: str, entries: Iterable[K]) -> None:
        super().__init__()
        self.what = what
        for entry in entries:
            _complete(what, entry)
            if entry.name in self:
                raise ValueError(f'{what} "{entry.name}": duplicate name')
            self[entry.name] = entry

    def __missing__(self, name: str) -> K:
        raise UnknownKind(f'no {self.what} "{name}"; {remedy(str(name), self)}')

    @property
    def names(self) -> tuple[str, ...]:
        """Every name, in order."""
        return tuple(self)

    @property
    def help(self) -> str:
        """Every name with its meaning, as listed in the help of a field."""
        return "; ".join(f"{entry.name}: {entry.help}" for entry in self.values())


def kinds(what: str, *entries: K) -> Kinds[K]:
    """A registry of kinds, checked for completeness.

    Parameters
    ----------
    what : common noun of the kinds, singular
    entries : frozen dataclasses with `name` and `help`

    Raises
    ------
    ValueError
        if a name is a duplicate or not a lower-case word; if a field is None or empty; or if a
        field annotated as a function is not a function

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Joint:
    ...     name: str
    ...     help: str
    >>> joints = kinds("joint", Joint("bond", "skirts glued over it"), Joint("thread", "screwed"))
    >>> joints.names, joints.help
    (('bond', 'thread'), 'bond: skirts glued over it; thread: screwed')
    >>> joints["bnd"]
    Traceback (most recent call last):
    actuator_opt.base.kinds.UnknownKind: no joint "bnd"; did you mean "bond"?
    """
    return Kinds(what, entries)


def kinds_in(what: str, package: str, name: str, *modules: str) -> Kinds[Any]:
    """Registry of the kinds that the modules of a package declare.

    Parameters
    ----------
    what : common noun of the kinds, singular
    package : package of the modules
    name : name of the attribute that contains a module's kind
    modules : modules in listing order; each module is named like its kind

    Raises
    ------
    ValueError : as for `kinds`; or if a module has no kind, or its kind has another name
    """
    entries = []
    for module in modules:
        declared = getattr(import_module(f".{module}", package), name, None)
        if declared is None:
            raise ValueError(f"{package}.{module}: declares no {name}")
        if declared.name != module:
            raise ValueError(f'{package}.{module}: its {name} is named "{declared.name}"')
        entries.append(declared)
    return kinds(what, *entries)


def per_kind(registry: Mapping[str, Any], functions: Mapping[str, V]) -> Mapping[str, V]:
    """Check data that another package adds to a registry: exactly one entry for each kind.

    Raises
    ------
    ValueError : if a kind has no entry, or an entry has no kind

    Examples
    --------
    >>> per_kind({"p": 1, "pi": 2}, {"p": abs})
    Traceback (most recent call last):
    ValueError: pi: no entry
    """
    lacking = [name for name in registry if name not in functions]
    unknown = [name for name in functions if name not in registry]
    if lacking or unknown:
        words = [f"{name}: no entry" for name in lacking] + [
            f"{name}: not a kind" for name in unknown
        ]
        raise ValueError("; ".join(words))
    return MappingProxyType(dict(functions))


def _complete(what: str, entry: Any) -> None:
    """Refuse an incomplete entry."""
    label = f'{what} "{getattr(entry, "name", "")}"'
    if not _WORD.fullmatch(entry.name):
        raise ValueError(f"{label}: the name must consist of lower-case letters, digits and _")
    for field in fields(entry):
        value, kind = getattr(entry, field.name), str(field.type)
        optional = "None" in kind
        if value is None and not optional:
            raise ValueError(f"{label}: {field.name} is missing")
        if isinstance(value, str) and not value.strip():
            raise ValueError(f"{label}: {field.name} is empty")
        if kind.startswith("Callable") and not (callable(value) or (optional and value is None)):
            raise ValueError(f"{label}: {field.name} is not a function")
