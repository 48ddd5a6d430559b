"""Public names of a package, each imported from its module when it is first used (PEP 562)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def homes(public: Mapping[str, str]) -> dict[str, str]:
    """The module of each public name.

    Parameters
    ----------
    public : for each module, its public names in one text, separated by spaces

    Examples
    --------
    >>> homes({"bore": "diameter area"})
    {'diameter': 'bore', 'area': 'bore'}
    """
    return {name: module for module, names in public.items() for name in names.split()}


def loader(package: str, modules: Mapping[str, str]) -> Callable[[str], Any]:
    """The `__getattr__` of a package that imports the module of a name.

    Parameters
    ----------
    package : name of the package
    modules : the module of each public name, relative to the package
    """

    def load(name: str) -> Any:
        if name in modules:
            return getattr(import_module(f".{modules[name]}", package), name)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    return load
