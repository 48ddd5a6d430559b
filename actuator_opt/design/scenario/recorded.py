"""The files that a scenario's signals name."""

from __future__ import annotations

from collections.abc import Iterator

from ..kinds import Of
from ..structure import child_at, entries
from .model import Scenario
from .signal_faults import part_lists
from .signals import Part


def recorded_parts(scenario: Scenario) -> Iterator[tuple[str, Part, str]]:
    """PATH, part and dimension of its values, of every part that is a record."""
    for loc, section in part_lists().items():
        kind = entries(section)["value"].kind
        assert isinstance(kind, Of)
        for index, part in enumerate(child_at(scenario, loc) or ()):
            if part.shape == "record":
                yield f"{'.'.join(loc)}[{index}].column", part, kind.quantity.dimension
