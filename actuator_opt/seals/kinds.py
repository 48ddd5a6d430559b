"""All seal types of a design file."""

from __future__ import annotations

from ..base.kinds import Kinds, kinds_in
from .contact import SHARED
from .seal_type import SealType

TYPES: Kinds[SealType] = kinds_in(
    "seal type",
    __package__,
    "TYPE",
    "o_ring",
    "step_ring",
    "u_cup",
    "compact",
)

SIZES = tuple(dict.fromkeys((*SHARED, *(x.size for kind in TYPES.values() for x in kind.fields))))
"""All seal sizes of a design file: first those that several types share, then those of one type
only."""
