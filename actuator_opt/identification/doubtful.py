"""Limits of a record's information, with wider bounds than those of the linearised model."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..base.fitting import WEAK, Parameter, quantile
from ..base.numeric import Array
from .points import ALIKE, FrictionPoint

REACH = 1.5
"""Stribeck speeds that a record must reach to separate F_C from sigma_2: there the Stribeck part is
e^(-1.5^2) = 0.1 of its height at exponent 2 (a choice)."""
SPREAD, APART = 0.2, 3.0
"""Least pressure range that can show an effect: relative to its highest value, and to the pressure
that overcomes friction alone (choices: effects of pressure then exceed scatter)."""
UNEQUAL = 2e-3
"""Area error, as a share, that is reported (a choice: below it, seals with a direction-dependent
pressure effect of a fifth look alike)."""
MISSED, BEYOND = 0.3, 5.0
"""Misfit of a curve, as a share of friction and a multiple of errors, that is reported. Choices:
the share by which a parameter is known, `WEAK`, and more than errors too small by half explain."""
SIGNED = ("offset", "pressure_slope")
"""Parameters that may be 0."""
PARTED = ("coulomb", "viscous", "stribeck_speed", "exponent")


def opened(parameters: Mapping[str, Parameter], names: Iterable[str]) -> dict[str, Parameter]:
    """Parameters with those named marked as unknown."""
    found = dict(parameters)
    for name in names:
        if name in found:
            found[name] = Parameter(found[name].value, -np.inf, np.inf, np.inf, False)
    return found


def widened(
    parameters: Mapping[str, Parameter], more: Mapping[str, float], quantile: float
) -> dict[str, Parameter]:
    """Parameters with an additional, independent standard error."""
    found = dict(parameters)
    for name, extra in more.items():
        one = found[name]
        error = float(np.hypot(one.standard_error, extra))
        half = quantile * error
        near = one.identifiable and (extra == 0 or half <= WEAK * abs(one.value))
        found[name] = Parameter(one.value, one.value - half, one.value + half, error, bool(near))
    return found


def agreed(parameters: Mapping[str, Parameter], told: Mapping[str, Parameter]) -> list[str]:
    """Parameters that agree with other sources within bounds; about 0 bounds alone count."""
    return [
        name
        for name, one in parameters.items()
        if name in told
        and (told[name].identifiable or (name in SIGNED and np.isfinite(told[name].upper)))
        and told[name].lower <= one.value <= told[name].upper
    ]


class Unequal(NamedTuple):
    """A force that grows with a chamber's pressure in both directions, so it is not friction."""

    chamber: int
    share: float
    error: float
    sure: bool

    def says(self, area: float, plunger: bool) -> str:
        """Describe it in one line, with the corrected diameter D' = D sqrt(1 - e)."""
        stated = 1e3 * np.sqrt(4 * area / np.pi)
        what = "plunger" if plunger else "bore"
        return (
            f"pressure makes friction differ between directions by {100 * abs(self.share):.2g} % "
            f"of its force: the {what} seems to be {stated * np.sqrt(1 - self.share):.4g} mm "
            f"({stated:.4g} stated), or a pressure or force sensor has such an error; correct "
            "this first"
        )


def spread(points: Sequence[FrictionPoint], pressures: Sequence[float], area: float) -> float:
    """Pressure range relative to the least one that shows an effect."""
    own = APART * max(abs(point.friction) for point in points) / area
    return (max(pressures) - min(pressures)) / max(SPREAD * max(pressures), own, 1.0)


def unequal(points: Sequence[FrictionPoint], area: float) -> Unequal | None:
    """Detect a share of the hydraulic force in the friction: areas or sensors are wrong.

    Least squares F = sgn v [f_k + s (p - p_0)] + F_0 + e A p_i, f_k free at every speed; friction
    is odd in the velocity, an error of an area or a gain is even [derived].

    Parameters
    ----------
    points : steady
    area : of the cap end [m^2]

    Returns
    -------
    the share e; None if no chamber's pressure varies enough in both directions
    """
    way = np.array([np.sign(point.velocity) for point in points])
    both = [[point for point in points if point.velocity * w > 0] for w in (1, -1)]
    if not all(both):
        return None
    chambers = [
        [[x.pressure_1 for x in one] for one in both],
        [[x.pressure_2 for x in one] for one in both],
    ]
    widths = [min(spread(points, x, area) for x in chamber) for chamber in chambers]
    chamber = 1 + int(np.argmax(widths))
    if widths[chamber - 1] < 1:
        return None
    second = chamber == 2
    groups = _groups(np.array([point.speed for point in points]))
    levels = (groups[:, None] == np.unique(groups)) * way[:, None]
    pressure = np.array([point.pressure for point in points])
    force = area * np.array([point.pressure_2 if second else point.pressure_1 for point in points])
    beside = [way * (pressure - pressure.mean()), np.ones_like(way), force]
    matrix = np.concatenate([levels, np.stack(beside, axis=1)], axis=1)
    friction = np.array([point.friction for point in points])
    error = np.hypot([point.error for point in points], 1e-3 * np.max(np.abs(friction)))
    scaled, target = matrix / error[:, None], friction / error
    size = np.abs(scaled).max(axis=0)
    spare = target.size - int(np.linalg.matrix_rank(scaled / size))
    if spare < 1:
        return None
    inverse = np.linalg.pinv(scaled / size) / size[:, None]
    found = inverse @ target
    chance = max(float(np.sqrt(np.sum((scaled @ found - target) ** 2) / spare)), 1.0)
    own = chance * float(np.linalg.norm(inverse[-1]))
    share = float(found[-1])
    sure = abs(share) > max(quantile(spare) * own, UNEQUAL)
    return Unequal(chamber, share, own, sure)


def _groups(speed: Array) -> Array:
    """Index of the group of similar speeds for every point."""
    order = np.argsort(speed)
    first, number = 0.0, -1
    found = np.zeros(speed.size, dtype=int)
    for k in order:
        if number < 0 or speed[k] > first * (1 + ALIKE):
            first, number = float(speed[k]), number + 1
        found[k] = number
    return found


def hidden(parameters: Mapping[str, Parameter], fastest: float, falls: bool) -> str | None:
    """Why F_C and sigma_2 cannot be separated, or None.

    Parameters
    ----------
    parameters : of a Stribeck curve, or of LuGre
    fastest : speed of the record [m/s]
    falls : whether friction at the fastest speed is below that at slower ones

    Returns
    -------
    one line; None if they can
    """
    speed = parameters.get("stribeck_speed")
    if speed is None:
        if falls and "viscous" in parameters:
            return (
                f"friction falls up to {1000.0 * fastest:.3g} mm/s and its rise towards rest is "
                "not resolved: F_C and σ₂ are unknown; give more and faster speeds"
            )
        return None
    if fastest < REACH * speed.value:
        return (
            f"the record ends at {1000.0 * fastest:.3g} mm/s, within the Stribeck rise (v_s "
            f"{1000.0 * speed.value:.3g} mm/s): F_C, σ₂ and v_s cannot be separated; move faster"
        )
    return None


def misled(
    parameters: Mapping[str, Parameter], friction: Array, residuals: Array, errors: Array
) -> Iterator[str]:
    """Yield findings that contradict friction.

    Parameters
    ----------
    parameters : of a Stribeck curve
    friction, residuals, errors : at its points [N]
    """
    fitted = friction - residuals
    if "offset" in parameters:
        value, lower, upper, *_ = parameters["offset"]
        least = float(np.min(np.abs(fitted - value)))
        if (lower > 0 or upper < 0) and abs(value) >= least:
            yield (
                f"the offset is {value:.3g} N, but the least friction is {least:.3g} N: it would "
                "drive the rod in one direction; check the bore and the zeros of the sensors"
            )
    missed = float(np.std(residuals))
    scatter = float(np.sqrt(np.mean((residuals / errors) ** 2)))
    if scatter > BEYOND and missed > MISSED * float(np.median(np.abs(fitted))):
        yield (
            f"the curve misses the points by {missed:.3g} N, but their errors are "
            f"{float(np.median(errors)):.2g} N: friction depends on more than speed and pressure"
        )


def ways(parameters: Mapping[str, Parameter], even: Unequal | None) -> Iterator[str]:
    """Yield limits due to a missing direction, or a difference between directions."""
    if "offset" not in parameters:
        yield "one direction only: a zero error of a sensor counts as friction"
        return
    offset = parameters["offset"]
    if (even is not None and even.sure) or offset.lower <= 0 <= offset.upper:
        return
    if even is None:
        yield (
            "an offset between both directions: sensor zeros, areas, or direction-dependent "
            "seals; the record cannot show which"
        )
    else:
        yield (
            "an offset between both directions that does not grow with pressure: sensor zeros, "
            "or direction-dependent seals, but not the areas"
        )
