"""All joints of a design file, in listing order."""

from __future__ import annotations

from ..base.kinds import Kinds, kinds_in
from .joint import Joint, check

JOINTS: Kinds[Joint] = kinds_in(
    "joint",
    __package__,
    "JOINT",
    "bond",
    "double_lap",
    "tapered_lap",
    "thread",
    "plug_thread",
    "retaining_ring",
    "cone",
    "tie_rods",
    "pins",
    "shrink",
)

OWN_KEYS = tuple(field.key for joint in JOINTS.values() for field in joint.fields if field.quantity)
"""Keys of `retention` that only one joint has, all of them optional."""

check(JOINTS.values())
