"""Forces of the side load on piston and glands, in every load case."""

from __future__ import annotations

from collections.abc import Sequence

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, maximum
from ..models import retention
from .geometry import Geometry
from .rods import RodSection
from .state import LoadState, overhang


@dataclass(frozen=True, slots=True)
class GuideForces:
    """Side forces [N] on the guides, and the moment [N m] on a second rod at the piston."""

    by_place: dict[str, Array]
    """Forces by place: rod (through the head), piston, and second_rod."""
    second_moment: Array


def side_reactions(g: Geometry, state: LoadState, sections: Sequence[RodSection]) -> GuideForces:
    """Side forces on the guides of rod and piston.

    One rod is a lever on head and piston, at the span of the extended actuator. Two rods are a beam
    on both glands and the piston, with the play of piston and head; a case at the worst position
    takes the larger force of both ends of the stroke.
    """
    if len(g.rods) == 1:
        head, piston = retention.guide_forces(
            side_force=state.side_load, overhang=overhang(g, state), span=g.bearing_span
        )
        return GuideForces({"rod": head, "piston": piston}, 0.0 * head)
    whole = g.barrel_length + g.plate
    forces: list[Array] = []
    for position in (state.reach, state.withdrawn):
        span = g.bearing_span + g.stroke - position
        second_span = whole - span
        found = retention.through_rod_guide_forces(
            side_force=state.side_load,
            overhang=overhang(g, state) - (state.reach - position),
            span=span,
            second_span=second_span,
            bending_stiffness=sections[0].bending_stiffness,
            second_bending_stiffness=sections[1].bending_stiffness,
            clearance=g.head_clearance,
            piston_clearance=g.piston_clearance,
            second_clearance=g.head_clearance,
        )
        sizes = [*map(absolute, found), absolute(found[2]) * second_span]
        forces = [*map(maximum, forces, sizes)] if forces else sizes
    head, piston, second, moment = forces
    return GuideForces({"rod": head, "piston": piston, "second_rod": second}, moment)
