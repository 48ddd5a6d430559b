"""The driven joint of a linkage: lever arms, angles, torque, inertia.

From one dead point to the other, the lever arm rises to a maximum and then falls. Within the stroke
it is therefore shortest at one of the stops. Each stop has its own result. A single result
would have a kink, bad for the optimiser, where the shorter arm changes from one stop to the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, clip, minimum, real, sqrt, where
from ..design.model import Design
from ..models import linkage
from .geometry import Geometry
from .limits import ENDS, OWN_PLACE, MetricArrays
from .values import Values, stacked

LARGEST, WORST, WORKING = "largest lever arm", "worst", "working"

METRICS = ("joint_torque_min", "joint_range", "geometry_dead_point", "geometry_joint_angle")


@dataclass(frozen=True, slots=True)
class DrivenJoint:
    """The linkage of a design; floats or arrays (designs,)."""

    base_radius: Array
    crank_radius: Array
    angle_offset: Array
    closed: Array
    """Retracted pin-to-pin length."""
    stroke: Array

    def position(self, angle: Array) -> Array:
        """Piston position at a joint angle."""
        return self._at(angle).length - self.closed

    def angle(self, position: Array) -> Array:
        """Joint angle at a piston position; NaN past a dead point."""
        return linkage.linkage_angle(
            length=self.closed + position,
            base_radius=self.base_radius,
            crank_radius=self.crank_radius,
            angle_offset=self.angle_offset,
        )

    def lever_arm(self, position: Array) -> Array:
        """Lever arm about the joint (piston travel per joint angle) at a piston position."""
        return self._at(self.angle(position)).lever_arm

    def _at(self, angle: Array) -> linkage.LinkageGeometry:
        return linkage.linkage(
            base_radius=self.base_radius,
            crank_radius=self.crank_radius,
            joint_angle=angle,
            angle_offset=self.angle_offset,
        )

    @property
    def ends(self) -> dict[str, Array]:
        """Lever arms at both stops."""
        return {ENDS[0]: self.lever_arm(0.0), ENDS[1]: self.lever_arm(self.stroke)}

    @property
    def largest(self) -> Array:
        """Largest lever arm within the stroke.

        The lever arm is largest, and equal to the shorter radius, where this radius is at a right
        angle to the actuator. There the pin-to-pin length is sqrt(|a^2 - r^2|), with base radius a
        and crank radius r. If the actuator cannot reach this length, it is largest at a stop.
        """
        square = absolute(self.base_radius * self.base_radius - self.crank_radius**2)
        return self.lever_arm(clip(sqrt(square) - self.closed, 0.0, self.stroke))


@dataclass(frozen=True, slots=True)
class Demand:
    """Force, speed and mass that the load requires: floats, or arrays (cases, designs)."""

    force: Array
    speed: Array
    mass: Array
    """Effective mass of the load at the rod, including the inertia of a driven joint."""


def derive(v: Values, design: Design, g: Geometry) -> DrivenJoint | None:
    """Derive the driven joint of a design; None without a linkage."""
    if design.linkage is None:
        return None
    return DrivenJoint(
        base_radius=v["linkage.base_radius"],
        crank_radius=v["linkage.crank_radius"],
        angle_offset=v["linkage.angle_offset"],
        closed=g.closed_length,
        stroke=g.stroke,
    )


def arms(joint: DrivenJoint, positions: Sequence[Array | None]) -> dict[str, Array]:
    """Lever arms of every load case (cases, designs): at both stops and where the arm is largest.

    For a load case with a stated position, all are the lever arm at that position.
    """
    placed = [None if x is None else joint.lever_arm(x) for x in positions]
    everywhere = joint.ends | {LARGEST: joint.largest}
    return {
        place: stacked([arm if own is None else own for own in placed])
        for place, arm in everywhere.items()
    }


def demand(v: Values, design: Design, lever_arm: Array = None) -> Demand:
    """Force, speed and mass that every load case demands, for `lever_arm` (cases, designs)."""
    forces, speeds = [], []
    for i, case in enumerate(design.load_cases):
        at = f"load_cases[{case.name}]."
        if case.force is not None:
            forces.append(v[at + "force"])
        elif lever_arm is not None and case.through_linkage:
            torque = v[at + "joint_torque"]
            forces.append(linkage.actuator_force(torque=torque, lever_arm=lever_arm[i]))
        else:
            forces.append(v[at + "joint_torque"] / v[at + "lever_arm"])
        if lever_arm is not None and case.joint_speed is not None:
            speeds.append(v[at + "joint_speed"] * lever_arm[i])
        else:
            speeds.append(v[at + "speed"])
    mass = v["load.mass"]
    if lever_arm is not None:
        reflected = linkage.reflected_inertia(
            inertia=v["load.inertia"], lever_arm=lever_arm, lever_slope=0.0
        )
        mass = mass + reflected.mass
    return Demand(stacked(forces), stacked(speeds), mass)


def demands(
    v: Values, design: Design, joint: DrivenJoint | None, positions: Sequence[Array | None]
) -> dict[str, Demand]:
    """Force, speed and mass that every load case demands, at several positions of the joint.

    `WORST` combines the largest force with the largest speed. `WORKING` has the largest force and
    the speed at the same position. The other entries are those at the two stops.
    """
    if joint is None:
        case_demand = demand(v, design)
        return {WORST: case_demand, WORKING: case_demand}
    lever_arms = arms(joint, positions)
    stops = {end: demand(v, design, lever_arms[end]) for end in ENDS}
    working = demand(v, design, minimum(*(lever_arms[end] for end in ENDS)))
    fastest = demand(v, design, lever_arms[LARGEST]).speed
    return {WORST: replace(working, speed=fastest), WORKING: working, **stops}


def at_stop(demands: dict[str, Demand], push: Array) -> Demand:
    """Force, speed and mass that every load case demands at the stop towards which it moves."""
    if ENDS[0] not in demands:
        return demands[WORST]
    retracted, extended = (demands[end] for end in ENDS)
    return Demand(
        where(push, extended.force, retracted.force),
        where(push, extended.speed, retracted.speed),
        where(push, extended.mass, retracted.mass),
    )


def open_cases(v: Values, design: Design, positions: Sequence[Array | None]) -> np.ndarray:
    """Whether the force or mass of each load case differs between the stops."""
    if design.linkage is None:
        return np.array([False])
    heavy = "load.inertia" in v.varied or design.load.inertia > 0
    return np.array(
        [
            x is None and (case.through_linkage or heavy)
            for case, x in zip(design.load_cases, positions, strict=True)
        ]
    )


def compute(
    design: Design,
    joint: DrivenJoint | None,
    positions: Sequence[Array | None],
    net: Array,
    out: MetricArrays,
) -> None:
    """Compute torque and range of the joint; `net` is the actuator's force in each load case."""
    if joint is None:
        for name in METRICS:
            out.skip(name, "no linkage stated: add linkage")
        return
    arms = dict(joint.ends)
    own = np.array([position is not None for position in positions])
    if own.any():
        placed = [joint.lever_arm(0.0 if x is None else x) for x in positions]
        arms[OWN_PLACE] = stacked(placed)
        out.applies_at["joint_torque_min", OWN_PLACE] = own
    torque = {place: linkage.joint_torque(force=net, lever_arm=arm) for place, arm in arms.items()}
    out.put("joint_torque_min", torque)
    out.put("joint_range", joint.angle(joint.stroke) - joint.angle(0.0))
    out.put("geometry_dead_point", _dead_points(joint))
    out.skip("geometry_joint_angle", "no load case states an angle")
    shares = {
        case.name: position / joint.stroke
        for case, position in zip(design.load_cases, positions, strict=True)
        if case.angle is not None
    }
    if shares:
        ends = {f"{name}, {ENDS[0]}": share for name, share in shares.items()}
        ends |= {f"{name}, {ENDS[1]}": 1 - share for name, share in shares.items()}
        out.put("geometry_joint_angle", ends)
    for direction in ("push", "pull"):
        cases = [case for case in design.load_cases if case.direction == direction]
        if cases and all(case.through_linkage for case in cases):
            out.skip(f"{direction}_force", "the load cases state a joint torque: see torque[NAME]")


def _dead_points(joint: DrivenJoint) -> dict[str, Array]:
    """Distance of each stop from the dead point beyond it."""
    base, crank = joint.base_radius, joint.crank_radius
    return {
        ENDS[0]: joint.closed - absolute(base - crank),
        ENDS[1]: base + crank - joint.closed - joint.stroke,
    }


def warnings(design: Design, joint: DrivenJoint | None) -> Iterable[tuple[str, str]]:
    """Warn if load cases use the joint's inertia reflected to the rod at one stroke position only.

    The warnings are pairs (metric, sentence).
    """
    if joint is None or not design.load.inertia > 0:
        return
    ends = {end: float(np.min(real(arm))) for end, arm in joint.ends.items()}
    end = min(ends, key=lambda name: ends[name])
    yield (
        "",
        "where the lever arm is least "
        f"({end}), the inertia of the joint acts at the rod like a mass of "
        f"{design.load.inertia / ends[end] ** 2:.4g} kg; load cases without a stated position use "
        "this mass",
    )
