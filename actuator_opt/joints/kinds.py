"""All joints of a design file, in listing order."""

from __future__ import annotations

from ..base.kinds import Kinds, kinds_in
from .joint import Joint, check
from .sleeve import KEY, in_sleeve

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

SLEEVED = tuple(
    in_sleeve(joint) for joint in JOINTS.values() if KEY in {field.key for field in joint.fields}
)
"""The joints that can be cut into a sleeve, as they are there."""

OWN_KEYS = tuple(field.key for joint in JOINTS.values() for field in joint.fields if field.quantity)
"""Keys of `retention` that only one joint has, all of them optional."""

check(JOINTS.values())
