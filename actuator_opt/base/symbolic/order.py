"""Which nodes some outputs need, and which of them are truth values."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from .expression import Symbol

_BOOLEAN = {"lt", "le", "and", "or", "not", "flag"}


def is_boolean(symbol: Symbol) -> bool:
    """Whether a symbol stands for a truth value."""
    return symbol.op in _BOOLEAN


def needed(outputs: Sequence[Any], known: Iterable[Symbol] = ()) -> list[Symbol]:
    """The nodes that some outputs need, operands before results; of `known` ones nothing more."""
    seen: set[int] = {one.index for one in known}
    found: list[Symbol] = []
    stack = [out for out in outputs if isinstance(out, Symbol)]
    while stack:
        node = stack.pop()
        if node.index not in seen:
            seen.add(node.index)
            found.append(node)
            stack.extend(node.operands)
    return sorted(found, key=lambda node: node.index)
