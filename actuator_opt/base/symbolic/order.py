"""Nodes that outputs need, and which of them are truth values."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from .expression import Symbol

_BOOLEAN = {"lt", "le", "and", "or", "not", "flag"}


def is_boolean(symbol: Symbol) -> bool:
    """Whether a symbol is a truth value."""
    return symbol.op in _BOOLEAN


def needed(outputs: Sequence[Any], known: Iterable[Symbol] = ()) -> list[Symbol]:
    """Nodes that the outputs need, operands first; operands of `known` nodes are left out."""
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
