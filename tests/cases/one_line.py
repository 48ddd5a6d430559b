"""What the repr of every result keeps to."""

from __future__ import annotations

from actuator_opt.base.dataclass import LONGEST_REPR
from actuator_opt.base.tables import OneLine


def one_line(result):
    """The repr is one short line that states class and name, and so is that of each field."""
    name = type(result).__name__
    below = [getattr(result, field) for field in getattr(result, "__dataclass_fields__", ())]
    below = [x for x in below if hasattr(x, "__dataclass_fields__") or isinstance(x, OneLine)]
    for shown in map(repr, (result, *below)):
        assert len(shown) <= LONGEST_REPR == 120, shown
        assert len(shown.splitlines()) == 1, shown
    assert repr(result).startswith((f"<{name}", f"{name}("))
