"""The joint of caps and head in a design, and the end of the barrel as its input.

Both ends have the same joint, so a single `End` represents both.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..base.numeric import Array
from ..design.model import Design, Retention
from ..joints.joint import BarrelLayer, End, Joint, JointSizes
from ..joints.kinds import JOINTS
from .values import Values


class Numbers:
    """Numbers of `retention` by key, from the numbers of an evaluation."""

    def __init__(self, v: Values) -> None:
        self._v = v

    def __contains__(self, key: object) -> bool:
        return f"retention.{key}" in self._v

    def __getitem__(self, key: str) -> Array:
        return self._v[f"retention.{key}"]

    def get(self, key: str, default: Array) -> Array:
        """The number of a key, or `default` if the design does not state it."""
        return self._v.get(f"retention.{key}", default)


class Stated:
    """Numbers of `retention` by key, as stated in a design."""

    def __init__(self, section: Retention) -> None:
        self._section = section

    def get(self, key: str, default: Array) -> Array:
        """The number of a key, or `default` if the design does not state it."""
        found: object = self._section
        for name in key.split("."):
            found = getattr(found, name, None)
        return default if found is None else found

    def __contains__(self, key: object) -> bool:
        return self.get(str(key), None) is not None

    def __getitem__(self, key: str) -> Array:
        return self.get(key, None)


def joint_of(design: Design) -> Joint | None:
    """The joint of a design; None without retention."""
    return None if design.retention is None else JOINTS[design.retention.type]


def clamped(design: Design) -> bool:
    """Whether the joint clamps the barrel between both ends."""
    joint = joint_of(design)
    return joint is not None and joint.stiffness is not None


def end_of(
    design: Design,
    sizes: JointSizes,
    *,
    inner_radius: Array,
    outer_radius: Array,
    thicknesses: Sequence[Array],
    barrel_length: Array,
    plate: Array,
) -> End:
    """The end of a design's barrel; `thicknesses` are those of its layers."""
    layers = zip(design.barrel.layup, thicknesses, strict=True)
    return End(
        sizes=sizes,
        material=None if design.retention is None else design.retention.material,
        cap=design.caps.material,
        layers=tuple(BarrelLayer(ply.material, thickness) for ply, thickness in layers),
        inner_radius=inner_radius,
        outer_radius=outer_radius,
        barrel_length=barrel_length,
        plate=plate,
    )
