"""What a record cannot tell, whatever its scatter: bounds beyond those of the linearised model."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..base.fitting import WEAK, Parameter, quantile
from ..base.numeric import Array
from .points import ALIKE, Point

REACH = 1.5
"""Stribeck speeds that a record must reach for F_C and sigma_2 to part: there the Stribeck part is
e^(-1.5^2) = 0.1 of its height at exponent 2 (a choice)."""
SPREAD, APART = 0.2, 3.0
"""Least range of the pressure that can show an effect: of its highest value, and of the pressure
that friction itself takes, without a load (choices: effects of pressure stand out of scatter)."""
UNEQUAL = 2e-3
"""Share of the area from which an error of it is named (a choice: below it, seals that rub
unequally both ways by a fifth of their rise with pressure look alike)."""
MISSED, BEYOND = 0.3, 5.0
"""Share of friction, and times their errors, by which a curve may miss the points (choices: the
share by which a parameter is known, `WEAK`, and more than errors too small by half do)."""
SIGNED = ("offset", "pressure_slope")
"""Parameters that may be 0."""
PARTED = ("coulomb", "viscous", "stribeck_speed", "exponent")


def opened(parameters: Mapping[str, Parameter], names: Iterable[str]) -> dict[str, Parameter]:
    """Parameters of which those named are not known at all."""
    found = dict(parameters)
    for name in names:
        if name in found:
            found[name] = Parameter(found[name].value, -np.inf, np.inf, np.inf, False)
    return found


def widened(
    parameters: Mapping[str, Parameter], more: Mapping[str, float], quantile: float
) -> dict[str, Parameter]:
    """Parameters with a standard error more, independent of theirs."""
    found = dict(parameters)
    for name, extra in more.items():
        one = found[name]
        error = float(np.hypot(one.standard_error, extra))
        half = quantile * error
        near = one.identifiable and (extra == 0 or half <= WEAK * abs(one.value))
        found[name] = Parameter(one.value, one.value - half, one.value + half, error, bool(near))
    return found


def agreed(parameters: Mapping[str, Parameter], told: Mapping[str, Parameter]) -> list[str]:
    """Parameters that others know too, and within their bounds; about 0 bounds alone must do."""
    return [
        name
        for name, one in parameters.items()
        if name in told
        and (told[name].identifiable or (name in SIGNED and np.isfinite(told[name].upper)))
        and told[name].lower <= one.value <= told[name].upper
    ]


class Unequal(NamedTuple):
    """A force that grows with a chamber's pressure alike both ways, over its area: no friction."""

    chamber: int
    share: float
    error: float
    sure: bool

    def says(self, area: float, plunger: bool) -> str:
        """In one line, with the diameter that would leave none: D' = D sqrt(1 - e)."""
        stated = 1e3 * np.sqrt(4 * area / np.pi)
        what = "plunger" if plunger else "bore"
        return (
            f"pressure leaves friction unequal both ways by {100 * abs(self.share):.2g} % of its "
            f"force: the {what} looks like {stated * np.sqrt(1 - self.share):.4g} mm "
            f"({stated:.4g} stated), or a pressure or force sensor reads as much off; mend it first"
        )


def spread(points: Sequence[Point], pressures: Sequence[float], area: float) -> float:
    """Range of a pressure over the least that shows an effect."""
    own = APART * max(abs(one.friction) for one in points) / area
    return (max(pressures) - min(pressures)) / max(SPREAD * max(pressures), own, 1.0)


def unequal(points: Sequence[Point], area: float) -> Unequal | None:
    """Whether friction holds a share of the hydraulic force: areas or sensors are wrong.

    Least squares F = sgn v [f_k + s (p - p_0)] + F_0 + e A p_i, f_k free at every speed; friction
    is odd in the velocity, an error of an area or a gain is even [derived].

    Parameters
    ----------
    points : steady
    area : of the cap end [m^2]

    Returns
    -------
    the share e; None where no chamber's pressure varies enough both ways
    """
    way = np.array([np.sign(one.velocity) for one in points])
    both = [[one for one in points if one.velocity * w > 0] for w in (1, -1)]
    if not all(both):
        return None
    chambers = [
        [[x.pressure_1 for x in one] for one in both],
        [[x.pressure_2 for x in one] for one in both],
    ]
    widths = [min(spread(points, x, area) for x in one) for one in chambers]
    chamber = 1 + int(np.argmax(widths))
    if widths[chamber - 1] < 1:
        return None
    second = chamber == 2
    groups = _groups(np.array([one.speed for one in points]))
    levels = (groups[:, None] == np.unique(groups)) * way[:, None]
    pressure = np.array([one.pressure for one in points])
    force = area * np.array([one.pressure_2 if second else one.pressure_1 for one in points])
    beside = [way * (pressure - pressure.mean()), np.ones_like(way), force]
    matrix = np.concatenate([levels, np.stack(beside, axis=1)], axis=1)
    friction = np.array([one.friction for one in points])
    error = np.hypot([one.error for one in points], 1e-3 * np.max(np.abs(friction)))
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
    """Number of the group of like speeds of every point."""
    order = np.argsort(speed)
    first, number = 0.0, -1
    found = np.zeros(speed.size, dtype=int)
    for k in order:
        if number < 0 or speed[k] > first * (1 + ALIKE):
            first, number = float(speed[k]), number + 1
        found[k] = number
    return found


def hidden(parameters: Mapping[str, Parameter], fastest: float, falls: bool) -> str | None:
    """Why F_C and sigma_2 cannot be parted, if they cannot.

    Parameters
    ----------
    parameters : of a Stribeck curve, or of LuGre
    fastest : speed of the record [m/s]
    falls : whether friction at the fastest speed is below that at slower ones

    Returns
    -------
    one line; None where they can
    """
    speed = parameters.get("stribeck_speed")
    if speed is None:
        if falls and "viscous" in parameters:
            return (
                f"friction falls up to {1e3 * fastest:.3g} mm/s and its rise towards rest is not "
                "resolved: F_C and σ₂ are not known; give more speeds, and faster ones"
            )
        return None
    if fastest < REACH * speed.value:
        return (
            f"the record ends at {1e3 * fastest:.3g} mm/s, within the Stribeck rise (v_s "
            f"{1e3 * speed.value:.3g} mm/s): F_C, σ₂ and v_s are not parted; move faster"
        )
    return None


def misled(
    parameters: Mapping[str, Parameter], friction: Array, residuals: Array, errors: Array
) -> Iterator[str]:
    """What no friction does, in lines.

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
                f"an offset of {value:.3g} N, friction is {least:.3g} N at its least: it would "
                "drive the rod one way; check the bore and the zeros of the sensors"
            )
    missed = float(np.std(residuals))
    scatter = float(np.sqrt(np.mean((residuals / errors) ** 2)))
    if scatter > BEYOND and missed > MISSED * float(np.median(np.abs(fitted))):
        yield (
            f"the curve misses the points by {missed:.3g} N, their errors are "
            f"{float(np.median(errors)):.2g} N: friction depends on more than speed and pressure"
        )


def ways(parameters: Mapping[str, Parameter], even: Unequal | None) -> Iterator[str]:
    """What is not known for want of both ways, or by their difference, in lines."""
    if "offset" not in parameters:
        yield "one way only: an error of the sensors' zeros counts as friction"
        return
    offset = parameters["offset"]
    if (even is not None and even.sure) or offset.lower <= 0 <= offset.upper:
        return
    if even is None:
        yield (
            "an offset between both ways: zeros of the sensors, areas, or seals that rub "
            "unequally; the record cannot tell which"
        )
    else:
        yield (
            "an offset between both ways that does not grow with pressure: zeros of the sensors, "
            "or seals that rub unequally; not the areas"
        )
