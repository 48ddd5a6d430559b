"""All joints of a design file, in listing order."""

from __future__ import annotations

from ..base.kinds import Kinds, kinds_in
from .joint import Joint, check

JOINTS: Kinds[Joint] = kinds_in(
    "joint",
    __package__,
    "JOINT",
    "bond",
    "thread",
    "tie_rods",
)

check(JOINTS.values())
