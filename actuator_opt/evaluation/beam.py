"""The actuator as a slender beam: critical load, and bending moment in the rod.

The push amplifies the moment of side load and own weight towards the critical load:
`Beam.under`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from ..base.numeric import Array, maximum, minimum
from ..design.model import Design
from ..models import column, stepped
from . import weight
from .barrel import Wall
from .geometry import Geometry
from .rods import Rod
from .state import LoadState, overhang
from .values import Values

FIXED_PINNED = 0.6992
"""Effective length factor of a column fixed at one end, pinned at the other: pi/4.4934."""

GRAVITY = 9.80665
"""Standard gravity, m/s^2 (3rd CGPM, 1901)."""

NEAR = 0.75
"""Share of the critical load beyond which a moment grows along its tangent: a choice, so
that designs far beyond buckling, which the buckling check rejects, have finite results."""

LEAST = 1e-6
"""Least length outside the head (m), to avoid a pole for a rod of zero length."""


@dataclass(frozen=True, slots=True)
class Beam:
    """Critical load [N] and largest moment in the rod without push [N m], by case."""

    critical: Array
    moment: Array

    def under(self, push: Array) -> Array:
        """The moment under a push [N]; beyond `NEAR` of the critical load along its tangent."""
        share = push / self.critical
        near = minimum(share, NEAR)
        bent = column.amplified_moment(
            bending_moment=self.moment, axial_force=near, critical_load=1.0
        )
        return bent + self.moment * (share - near) / (1 - NEAR) ** 2


def lengths(g: Geometry, state: LoadState) -> tuple[Array, Array]:
    """Lengths of the cylinder, and of the rod outside it, from eye to eye."""
    cylinder = g.eye_offset + 2 * g.plate + g.barrel_length
    return cylinder, maximum(state.reach + g.rod_extension + g.eye_offset, LEAST)


CriticalLoad: TypeAlias = Callable[[Design, Wall, Rod, tuple[Array, Array]], Array]
"""Critical load of a design from wall, rod and the lengths of cylinder and exposed rod."""


def derive(
    v: Values,
    design: Design,
    g: Geometry,
    state: LoadState,
    wall: Wall,
    rod: Rod,
    parts: Mapping[str, Array],
    *,
    critical_load: CriticalLoad,
) -> Beam:
    """Column and beam at the position of every case, with the actuator horizontal (a choice)."""
    segments = lengths(g, state)
    own = _weight(v, design, g, state, rod, parts, segments)
    return Beam(
        critical=critical_load(design, wall, rod, segments),
        moment=own + state.side_load * overhang(g, state),
    )


def critical_load(design: Design, wall: Wall, rod: Rod, lengths: tuple[Array, Array]) -> Array:
    """Critical load of barrel and rod, or of the rod alone if mounted at the head; with shear."""
    mount = design.cylinder.mount
    if mount.startswith("head"):
        factor = FIXED_PINNED if mount == "head_flange" else 1.0
        return column.engesser_load(
            critical_load=column.euler_load(
                bending_stiffness=rod.bending_stiffness, effective_length=factor * lengths[1]
            ),
            shear_stiffness=rod.shear_stiffness,
        )
    segments = {
        "bending_stiffness_1": wall.bending_stiffness,
        "length_1": lengths[0],
        "bending_stiffness_2": rod.bending_stiffness,
        "length_2": lengths[1],
    }
    ends: stepped.Ends = ("fixed" if mount == "cap_flange" else "pinned", "pinned")
    load = stepped.stepped_column_load(**segments, ends=ends)
    shear = stepped.mode_shear_stiffness(
        critical_load=load,
        shear_stiffness_1=wall.shear_stiffness,
        shear_stiffness_2=rod.shear_stiffness,
        **segments,
        ends=ends,
    )
    return column.engesser_load(critical_load=load, shear_stiffness=shear)


def _weight(
    v: Values,
    design: Design,
    g: Geometry,
    state: LoadState,
    rod: Rod,
    parts: Mapping[str, Array],
    lengths: tuple[Array, Array],
) -> Array:
    """Largest moment of the own weight in the rod.

    Pinned at both eyes for every cap mount (a fixed cap is stronger). Mounted at the head, the rod
    spans to its eye: w L^2/8, pinned or fixed there; on trunnions the barrel overhangs behind.
    """
    outside = rod.mass_per_length * (state.reach + g.rod_extension)
    inside = sum(parts.values()) - parts["clevises"] - outside
    inside = inside + weight.oil(v, design, g, position=state.reach)
    heavy = GRAVITY * inside / lengths[0]
    light = GRAVITY * rod.mass_per_length
    mount = design.cylinder.mount
    if not mount.startswith("head"):
        *_, largest = column.self_weight_moments(
            weight_1=heavy, length_1=lengths[0], weight_2=light, length_2=lengths[1]
        )
        return largest
    half = lengths[1] / 2
    span, *_ = column.self_weight_moments(
        weight_1=light, length_1=half, weight_2=light, length_2=half
    )
    if mount == "head_flange":
        return span
    return maximum(span, heavy * lengths[0] * lengths[0] / 2)
