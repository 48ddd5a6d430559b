"""Every joint that a design file may name, in the order in which lists show them."""

from __future__ import annotations

from ..kinds import kinds
from . import bond, thread, tie_rods
from .joint import check

JOINTS = kinds(
    "joint",
    bond.JOINT,
    thread.JOINT,
    tie_rods.JOINT,
)

check(JOINTS.values())
