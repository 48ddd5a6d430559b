"""Extreme values of the rod in a duty cycle: forces, speeds, travel, powers, reversals."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..models import linkage as crank
from .duty import DutyCycle
from .model import Linkage


class RodCourse(NamedTuple):
    """Motion and load of the rod at the samples of a cycle, with the scales of the design."""

    time: Array
    """[s], (N+1,)"""
    travel: Array
    """Distance of the rod from where it is shortest in the cycle [m]."""
    speed: Array
    """Outward speed of the rod [m/s]."""
    force: Array
    """Force on the load, positive outwards [N]."""


@dataclass(frozen=True, slots=True)
class CyclePeaks:
    """Extreme values of a cycle at its samples, SI, with the scales of the design.

    Parameters
    ----------
    push, pull : largest forces outwards and inwards [N], at least 0
    speed_out, speed_in : largest speeds of the rod [m/s], at least 0
    travel : distance between the shortest and the longest rod [m]
    position_low, position_high : ends of the travel from fully retracted [m]; None for a joint,
        whose actuator decides them
    power_out, power_in : largest power to the load and from the load [W], at least 0
    period : duration of the cycle [s]
    reversals : changes of direction, without those below 1 % of the range
    torque, joint_speed : largest sizes of joint torque [N m] and speed [rad/s]; None for a rod
    angle_low, angle_high : range of the joint [rad]; None for a rod
    """

    push: float
    pull: float
    speed_out: float
    speed_in: float
    travel: float
    position_low: float | None
    position_high: float | None
    power_out: float
    power_in: float
    period: float
    reversals: int
    torque: float | None = None
    joint_speed: float | None = None
    angle_low: float | None = None
    angle_high: float | None = None

    @property
    def speed(self) -> float:
        """Largest speed of the rod in either direction [m/s]."""
        return max(self.speed_out, self.speed_in)


def rod_course(cycle: DutyCycle, linkage: Linkage | None = None) -> RodCourse:
    """Motion and load of the rod in a cycle: v = h dtheta/dt and F = T/h for a joint.

    h is the constant lever arm of the cycle, or dl/dtheta of the linkage (`models.linkage`).

    Parameters
    ----------
    cycle : cycle whose file is read
    linkage : linkage of the design, for a joint without a constant lever arm

    Raises
    ------
    InputError
        the file states a joint, but there is neither lever arm nor linkage
    """
    record = cycle.record
    time = record.time * cycle.time_scale
    if record.position is not None and record.force is not None:
        force, travel = record.force * cycle.force_scale, record.position - record.position.min()
        return RodCourse(time, travel, record.speed / cycle.time_scale, force)
    assert record.angle is not None
    assert record.torque is not None
    if cycle.lever_arm is not None:
        arm, length = np.full_like(time, cycle.lever_arm), cycle.lever_arm * record.angle
    elif linkage is not None:
        geometry = crank.linkage(
            base_radius=linkage.base_radius,
            crank_radius=linkage.crank_radius,
            joint_angle=record.angle,
            angle_offset=linkage.angle_offset,
        )
        arm, length = geometry.lever_arm, geometry.length
    else:
        message = f"cycle {cycle.name}: the file states a joint, but there is no linkage"
        raise InputError(Diagnostic(message, "state lever_arm, or a block linkage"))
    return RodCourse(
        time,
        length - length.min(),
        arm * record.speed / cycle.time_scale,
        record.torque * cycle.torque_scale / arm,
    )


def peaks(cycle: DutyCycle, linkage: Linkage | None = None) -> CyclePeaks:
    """The extreme values of a cycle; parameters and errors as for `rod_course`."""
    record, course = cycle.record, rod_course(cycle, linkage)
    power = course.force * course.speed
    ends: tuple[float | None, float | None] = (None, None)
    if record.position is not None:
        ends = float(record.position.min()), float(record.position.max())
    joint: dict[str, float] = {}
    if record.angle is not None and record.torque is not None:
        joint = {
            "torque": float(np.abs(record.torque).max()) * cycle.torque_scale,
            "joint_speed": float(np.abs(record.speed).max()) / cycle.time_scale,
            "angle_low": float(record.angle.min()),
            "angle_high": float(record.angle.max()),
        }
    return CyclePeaks(
        push=_most(course.force),
        pull=_most(-course.force),
        speed_out=_most(course.speed),
        speed_in=_most(-course.speed),
        travel=float(course.travel.max()),
        position_low=ends[0],
        position_high=ends[1],
        power_out=_most(power),
        power_in=_most(-power),
        period=float(course.time[-1] - course.time[0]),
        reversals=record.reversals,
        **joint,
    )


def _most(values: Array) -> float:
    return max(float(values.max()), 0.0)
