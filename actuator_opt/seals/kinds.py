"""Every seal type, by the word of a design file."""

from __future__ import annotations

from ..kinds import kinds
from . import compact, o_ring, step_ring, u_cup
from .sizes import SHARED

TYPES = kinds("seal type", o_ring.TYPE, step_ring.TYPE, u_cup.TYPE, compact.TYPE)

SIZES = tuple(dict.fromkeys((*SHARED, *(x.size for one in TYPES.values() for x in one.fields))))
"""Sizes a design file knows: the shared ones, then those of single types."""
