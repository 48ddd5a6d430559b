"""View of a file's tree for checks: values by place, and faults at places."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

from ..base import quantities
from ..base.errors import Fault
from .kinds import Section
from .model import Design
from .walls import Loc, child_at, number_of, value_at


class Materials(Protocol):
    """Interface of the material library for input checks (`materials.Library` implements it)."""

    def __contains__(self, name: object) -> bool: ...

    def names(self) -> Sequence[str]:
        """All names."""
        ...

    def kind(self, name: str) -> str | None:
        """Kind of an entry: metal, ply, polymer, fluid, seal, adhesive."""
        ...


@runtime_checkable
class Properties(Protocol):
    """A material library that also gives the properties of its entries."""

    def numbers(self, name: str) -> Mapping[str, float]:
        """All stated properties, SI."""
        ...


class View:
    """A tree in SI, read by dotted keys, with the defaults of the model; None if unusable."""

    def __init__(self, tree: Any, root: type[Section] = Design) -> None:
        self.tree = tree
        self.root = root

    def value(self, *loc: str | int) -> Any:
        """Value at a place, else its default."""
        return value_at(self.tree, loc, self.root)

    def number(self, *loc: str | int) -> float | None:
        """The SI number at a place."""
        return number_of(self.value(*loc))

    def text(self, *loc: str | int) -> str | None:
        """The text at a place."""
        value = self.value(*loc)
        return value if isinstance(value, str) else None

    def flag(self, *loc: str | int) -> bool | None:
        """The boolean at a place."""
        value = self.value(*loc)
        return value if isinstance(value, bool) else None

    def items(self, *loc: str | int) -> Sequence[Any]:
        """The entries of a list."""
        value = self.value(*loc)
        return value if isinstance(value, (list, tuple)) else ()

    def has(self, *loc: str | int) -> bool:
        """Whether the file states a value here."""
        return child_at(self.tree, loc) is not None


def without_effect(
    view: View, loc: Loc, keys: Iterable[str], where: str, remedy: str = "remove the line"
) -> Iterator[Fault]:
    """A fault for each of these keys below a place that the file states."""
    for key in keys:
        if view.has(*loc, key):
            yield Fault((*loc, key), f"without effect {where}", remedy, at_key=True)


def length_text(value: float) -> str:
    """A length for display."""
    return quantities.INPUTS["length"].text(value)
