"""Limits of a design: its requirements, the forces of its load cases, and the check list.

The check list contains the usual professional checks of an actuator. Each line has a limit with its
source, unless only the user can set it. A requirement on the same metric and sense replaces the
limit; `waivers` remove a line, and the report prints their reason.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from ..base.numeric import Array, absolute, real, where
from ..base.quantities import Sense
from ..design.model import Design, LoadCase
from ..metrics.table import CHECKS, ROWS
from .plugin import Plugin
from .values import Values


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit of a metric: a number of the design (`path`) or a constant.

    For a load case with a joint torque, `path` is the torque and `lever` the PATH of its lever arm.
    """

    name: str
    metric: str
    sense: Sense
    path: str | None = None
    constant: float | None = None
    origin: Literal["requirement", "case", "check", "advice", "geometry"] = "requirement"
    case: str | None = None
    source: str = ""
    lever: str | None = None
    places: tuple[str, ...] | None = None
    """Places of the metric that it applies to; None for all."""

    def value(self, v: Values) -> Array:
        """The limit in SI (an array if a parameter study varies it)."""
        if self.path is None:
            return self.constant
        return v[self.path] if self.lever is None else v[self.path] / v[self.lever]


ENDS = ("retracted", "extended")
OWN_PLACE = "position of the case"
"""Places of a joint torque: both stops, and the stated position of a load case."""


def requirement_limits(design: Design) -> list[Limit]:
    """Limits in the file: `requirements`, and the force or torque of every load case."""
    limits = []
    for metric, limit in design.requirements.items():
        for sense in ("min", "max"):
            if getattr(limit, sense) is not None:
                both = limit.min is not None and limit.max is not None
                name = f"{metric} ({sense})" if both else metric
                path = f"requirements.{metric}.{sense}"
                limits.append(Limit(name, metric, sense, path))
    return limits + [_case_limit(case) for case in design.load_cases]


def _case_limit(case: LoadCase) -> Limit:
    """The force of a load case, or its torque if it acts through the linkage."""
    at = f"load_cases[{case.name}]"
    if case.through_linkage:
        placed = case.angle is not None or case.position != "worst"
        return Limit(
            name=f"torque[{case.name}]",
            metric="joint_torque_min",
            sense="min",
            path=f"{at}.joint_torque",
            origin="case",
            case=case.name,
            source="load case",
            places=(OWN_PLACE,) if placed else ENDS,
        )
    path, lever = f"{at}.force", None
    if case.force is None:
        path, lever = f"{at}.joint_torque", f"{at}.lever_arm"
    return Limit(
        name=f"force[{case.name}]",
        metric=f"{case.direction}_force",
        sense="min",
        path=path,
        origin="case",
        case=case.name,
        source="load case",
        lever=lever,
    )


def check_limits(design: Design) -> list[Limit]:
    """Limits of the check list that the design neither replaces nor waives."""
    limits = []
    for metric, check in CHECKS:
        if check.limit is None or metric.name in design.waivers:
            continue
        requirement = design.requirements.get(metric.name)
        if requirement is not None and getattr(requirement, metric.worst) is not None:
            continue
        limits.append(
            Limit(
                name=check.name,
                metric=metric.name,
                sense=metric.worst,
                path=f"requirements.{metric.name}.{metric.worst}",
                origin="advice" if check.advice else "check",
                source=check.source,
            )
        )
    return limits


def default_limits() -> dict[str, float]:
    """Limits of the check list by PATH, so that they can be varied like other numbers."""
    return {
        f"requirements.{metric.name}.{metric.worst}": check.limit
        for metric, check in CHECKS
        if check.limit is not None
    }


def geometry_limits() -> list[Limit]:
    """Walls and clearances that must stay positive for a valid geometry."""
    return [
        Limit(
            name,
            name,
            "min",
            constant=row.least.value,
            origin="geometry",
            source=row.least.source,
        )
        for name, row in ROWS.items()
        if row.least is not None
    ]


def all_limits(design: Design, plugins: Iterable[Plugin] = ()) -> list[Limit]:
    """All limits of a design: requirements, check list, geometry and user constraints."""
    own = [
        Limit(plugin.name, plugin.name, plugin.sense, constant=0.0, source="user constraint")
        for plugin in plugins
        if plugin.sense is not None
    ]
    return requirement_limits(design) + own + check_limits(design) + geometry_limits()


def margin(value: Array, limit: Array, sense: Sense) -> Array:
    """Relative margin, ≥ 0 if the limit is met: (value − limit)/|limit|, negated for `max`.

    For a limit of zero it is ± the value itself.
    """
    scale = where(real(limit) == 0, 1.0 + 0 * limit, absolute(limit))
    difference = (value - limit) / scale
    return difference if sense == "min" else -difference
