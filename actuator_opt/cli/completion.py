"""Words that a shell can complete: values of the design on the line, metrics and materials.

A fault in the design gives no words and no message.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ActuatorError

if TYPE_CHECKING:
    from ..design.kinds import Section

_REQUEST = "_ACTUATOR_OPT_COMPLETE"
"""Environment variable by which a shell asks for words instead of a command."""

_LINES = ("COMP_WORDS", "_TYPER_COMPLETE_ARGS")
"""Environment variables with the line typed so far, in bash and in other shells."""

_LONGEST = 40
"""Number of characters of the longest value that is worth completing; longer texts are notes."""


@cache
def typed() -> tuple[str, ...]:
    """The whole words after the program on the line for which a shell asks; empty otherwise."""
    if _REQUEST not in os.environ:
        return ()
    line = next((os.environ[name] for name in _LINES if name in os.environ), "")
    *whole, _ = (line + "|").split()  # the last word may be incomplete
    return tuple(whole[1:])


def stated(incomplete: str) -> list[str]:
    """``PATH=VALUE`` for every value that the design of the line states."""
    words = (f"{path}={value}" for path, value in _values() if len(value) <= _LONGEST)
    return [word for word in words if word.startswith(incomplete)]


def unset(incomplete: str) -> list[str]:
    """Every PATH, of a value or of a block, that the file of the line states."""
    words: dict[str, None] = {}
    for path, _ in _values():
        ends = [k for k, mark in enumerate(path) if mark == "."]
        words |= dict.fromkeys(path[:end] for end in ends if path[end - 1] != "]")
        words[path] = None
    return [word for word in words if word.startswith(incomplete)]


def objectives(incomplete: str) -> list[str]:
    """``METRIC:min`` and ``METRIC:max`` for every metric."""
    from ..metrics import METRICS

    words = (f"{name}:{goal}" for name in METRICS for goal in ("min", "max"))
    return [word for word in words if word.startswith(incomplete)]


def materials(incomplete: str) -> list[str]:
    """Every material of the library."""
    from ..design.materials import load_library

    return [name for name in load_library().names() if name.startswith(incomplete)]


def _values() -> Iterator[tuple[str, str]]:
    """PATH and value, without spaces, of every value in the design of the line."""
    files = (word.strip("'\"") for word in typed())
    file = next((word for word in files if Path(word).suffix in (".yaml", ".yml")), None)
    if file is None:
        return
    from ..design.paths import spell
    from ..design.reader import opened
    from ..design.structure import leaves
    from ..design.yaml_source import parse

    try:
        tree = parse(*opened(file)).data
    except ActuatorError:
        return
    root = _root(tree)
    for loc, _, value in leaves(tree, root):
        yield spell(loc, tree), _joined(value)
    limits = tree.get("requirements")
    for metric, entry in limits.items() if isinstance(limits, dict) else ():
        for end in ("min", "max"):
            if isinstance(entry, dict) and entry.get(end) is not None:
                yield f"requirements.{metric}.{end}", _joined(entry[end])


def _root(tree: Mapping[str, object]) -> type[Section]:
    """Class of the file of the line: a scenario names a design, and describes no cylinder."""
    if "design" in tree and "cylinder" not in tree:
        from ..design.scenario.model import Scenario

        return Scenario
    from ..design.model import Design

    return Design


def _joined(value: object) -> str:
    """A value without spaces, at which a shell would end the word."""
    return str(value).replace(" ", "")
