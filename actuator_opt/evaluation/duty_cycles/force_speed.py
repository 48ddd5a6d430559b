"""Limits of a cylinder in the plane of force and speed, in its four quadrants.

They are limits of the sample model (`samples`), so friction and lines count as they do along a
cycle: where the force reserve is zero, and where the driven chamber falls to the pressure of the
air (0 gauge).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ...base.dataclass import dataclass
from ...base.numeric import Array
from ...models import quasi_static
from .numbers import Numbers, SamplePlan
from .samples import sample

POINTS = 41
"""Speeds of every curve; they are closest near rest, where friction changes."""
ROUNDS, SETTLED = 30, 1e-7
"""Most steps of the fixed point, and the step that ends it, as a share of the stall force; friction
changes by a few per cent of the force, so each step is that much smaller."""
SUCTION = 1e-3
"""Pressure below that of the air that still counts as the air's, as a share of the supply pressure;
the friction of a sample is known that well."""
SLOWEST = 1e-6
"""First speed of every curve, as a share of the last."""


@dataclass(frozen=True, slots=True)
class ForceLimit:
    """Limits of one direction of motion at one opening of the valve.

    A load is moved at a speed while its force lies between both limits.
    """

    direction: Literal["extending", "retracting"]
    opening: float | None
    """Opening of the valve, 1 is fully open; None without a valve."""
    speed: npt.NDArray[np.float64]
    """Speeds [m/s], from rest; negative if retracting."""
    force: npt.NDArray[np.float64]
    """Force of the load at which the supply is just enough [N]; NaN where the chamber that drives
    would fall below the pressure of the air."""
    suction: npt.NDArray[np.float64] | None
    """Force of the load at which the driven chamber falls to the pressure of the air [N]; None
    without a valve."""

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "direction": self.direction,
            "opening": self.opening,
            "speed": self.speed.tolist(),
            "force": self.force.tolist(),
            "suction": None if self.suction is None else self.suction.tolist(),
        }


def force_limits(
    plan: SamplePlan, u: Mapping[str, Array], speeds: npt.NDArray[np.float64]
) -> tuple[ForceLimit, ...]:
    """Limits of both directions: at the opening limit of the valve, then fully open.

    Parameters
    ----------
    plan : structure of the design
    u : numbers of the design and of a cycle, see `numbers.collect`; "level" is the supply pressure
    speeds : speeds of the cycle [m/s]; without a valve the curves end at the largest of them

    Returns
    -------
    limits; without a valve one for each direction in which the cycle moves

    References
    ----------
    [derived] `quasi_static.needed_supply` solved for the load; the fixed point holds friction
    """
    u = {**u, "arm": 1.0, "shift": 0.0, "load_scale": 1.0, "time_scale": 1.0}
    limits = []
    openings = dict.fromkeys((float(u["opening_limit"]), 1.0)) if plan.valve else (None,)
    for opening in openings:
        at = u if opening is None else u | {"opening_limit": opening}
        for sign in (1.0, -1.0):
            end = _last_speed(plan, at, sign, speeds)
            if end > 0:
                course = sign * end * np.linspace(SLOWEST**0.5, 1.0, POINTS) ** 2
                limits.append(_limit(plan, at, sign, opening, course))
    return tuple(limits)


def _last_speed(
    plan: SamplePlan, u: Numbers, sign: float, speeds: npt.NDArray[np.float64]
) -> float:
    """Speed at which the whole supply pressure is lost in the edge that feeds the chamber."""
    if not plan.valve:
        return float(np.max(sign * speeds, initial=0.0))
    area, feed = ("area_a", "feed_a") if sign > 0 else ("area_b", "feed_b")
    limit = quasi_static.speed_limit(
        edge_drop=u["level"], driven_area=u[area], feed_coefficient=u[feed]
    )
    return float(u["opening_limit"] * limit)


def _limit(
    plan: SamplePlan,
    u: Numbers,
    sign: float,
    opening: float | None,
    speed: npt.NDArray[np.float64],
) -> ForceLimit:
    """Limits of one direction at the speeds."""
    driven, other = ("area_a", "area_b") if sign > 0 else ("area_b", "area_a")
    pressed = "pressure_a" if sign > 0 else "pressure_b"
    stall = sign * (u["level"] * u[driven] - u["drain"] * u[other])

    def solved(change: Callable[[dict[str, Array]], Array]) -> dict[str, Array]:
        """Results at the force that the fixed point reaches."""
        force = np.full(speed.shape, float(stall))
        for _ in range(ROUNDS):
            data = {"motion": 0.0 * speed, "load": force, "rate": speed}
            found = sample(plan, u, data, linked=False)
            step = change(found)
            if np.max(np.abs(step)) < SETTLED * abs(stall):
                break
            force = force + sign * step
        return found

    with np.errstate(all="ignore"):
        enough = solved(lambda found: found["reserve"])
        low = enough[pressed] < -SUCTION * u["level"]
        suction = None
        if plan.valve:
            edges = (u["feed_a"], u["drain_b"]) if sign > 0 else (u["feed_b"], u["drain_a"])
            ratio = quasi_static.edge_ratio(
                driven_area=u[driven],
                other_area=u[other],
                feed_coefficient=edges[0],
                drain_coefficient=edges[1],
            )
            span = u[driven] + ratio * u[other]
            suction = solved(lambda found: -found[pressed] * span)["force"]
    return ForceLimit(
        "extending" if sign > 0 else "retracting",
        opening,
        speed,
        np.where(low, np.nan, enough["force"]),
        suction,
    )
