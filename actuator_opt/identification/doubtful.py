"""Effects that a record cannot separate: notes on them, and wider confidence intervals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..base.fitting import WEAK, Parameter, quantile
from ..base.numeric import Array
from .points import ALIKE, FrictionPoint

REACH = 1.5
"""Multiple of the Stribeck speed that a record must reach to separate Coulomb friction F_C from
viscous friction sigma_2 (our choice: at this speed, the Stribeck part has dropped to e^(-1.5^2) =
0.1 of its height, for exponent 2)."""
SPREAD, APART = 0.2, 3.0
"""Smallest pressure range that can show an effect of pressure: the share `SPREAD` of the highest
pressure, or `APART` times the pressure that overcomes friction alone, whichever is larger (our
choices: the effect then exceeds the scatter)."""
UNEQUAL = 2e-3
"""Smallest relative error of an area that is reported (our choice). A smaller error cannot be
distinguished from seals whose pressure effect differs by a fifth between the directions."""
MISSED, BEYOND = 0.3, 5.0
"""A misfit between curve and points is reported if it exceeds both the share `MISSED` of the
friction and `BEYOND` times the standard errors (our choices). The share equals `WEAK`, the relative
interval up to which a parameter is identifiable. Standard errors that are only half the true ones
cannot explain a misfit of `BEYOND` times their size."""
SIGNED = ("offset", "pressure_slope")
"""Parameters that may be 0; they can be known although their interval contains 0."""
INSEPARABLE = ("coulomb", "viscous", "stribeck_speed", "exponent")
"""Parameters that are unknown if a record cannot separate Coulomb from viscous friction."""


def unbounded(parameters: Mapping[str, Parameter], names: Iterable[str]) -> dict[str, Parameter]:
    """The same parameters; those in `names` get infinite confidence limits, as they are unknown."""
    unknown = set(names)
    return {
        name: Parameter(parameter.value, -np.inf, np.inf, np.inf, False)
        if name in unknown
        else parameter
        for name, parameter in parameters.items()
    }


def widened(
    parameters: Mapping[str, Parameter], errors: Mapping[str, float], quantile: float
) -> dict[str, Parameter]:
    """The same parameters, with confidence intervals widened by further independent errors.

    `errors` has a standard error for each parameter to widen; `quantile` is that of Student's t.
    """
    result = dict(parameters)
    for name, extra in errors.items():
        parameter = result[name]
        error = float(np.hypot(parameter.standard_error, extra))
        half = quantile * error
        value = parameter.value
        known = parameter.identifiable and (extra == 0 or half <= WEAK * abs(value))
        result[name] = Parameter(value, value - half, value + half, error, bool(known))
    return result


def agreed(parameters: Mapping[str, Parameter], references: Mapping[str, Parameter]) -> list[str]:
    """Names of parameters whose values lie within the confidence intervals of another fit.

    `references` are the parameters of that fit. Only those that are identifiable, or that may be 0,
    are compared.
    """
    known = {
        name: reference
        for name, reference in references.items()
        if reference.identifiable or (name in SIGNED and np.isfinite(reference.upper))
    }
    return [
        name
        for name, parameter in parameters.items()
        if name in known and known[name].lower <= parameter.value <= known[name].upper
    ]


class Unequal(NamedTuple):
    """A force that grows with a chamber pressure but, unlike friction, does not reverse."""

    chamber: int
    share: float
    error: float
    sure: bool

    def says(self, area: float, plunger: bool) -> str:
        """One-line note on the error, with the corrected diameter D sqrt(1 - e).

        D is the stated diameter, e the relative error of the area.
        """
        stated = 1e3 * np.sqrt(4 * area / np.pi)
        diameter = "plunger" if plunger else "bore"
        return (
            "friction differs between the two directions by a force that grows with the pressure: "
            f"{100 * abs(self.share):.2g} % of the pressure force. The {diameter} seems to be "
            f"{stated * np.sqrt(1 - self.share):.4g} mm ({stated:.4g} mm stated), or a pressure "
            "or force sensor has an error of this size; correct this first"
        )


def spread(points: Sequence[FrictionPoint], pressures: Sequence[float], area: float) -> float:
    """Pressure range of the points, divided by the smallest that can show a pressure effect."""
    by_friction = APART * max(abs(point.friction) for point in points) / area
    return (max(pressures) - min(pressures)) / max(SPREAD * max(pressures), by_friction, 1.0)


def unequal(points: Sequence[FrictionPoint], area: float) -> Unequal | None:
    """Detect hydraulic force that looks like friction because an area or a sensor is wrong.

    The error e and the other parameters are fitted by least squares to F = sgn v [f_k + s (p -
    p_0)] + F_0 + e A p_i. F is the friction, v the velocity, f_k a friction level fitted for every
    speed k, s the slope of friction over the pressure p, p_0 a reference pressure, F_0 an offset, e
    the relative error, A the area, and p_i the pressure of chamber i. Friction changes sign with
    the velocity; the effect of a wrong area or sensor gain does not [derived].

    Parameters
    ----------
    points : points of steady sliding
    area : piston area of the cap end [m^2]

    Returns
    -------
    the chamber, the relative error e of its pressure force, the standard error of e, and whether e
    is certain; None if there are too few points, or if neither chamber's pressure varies enough in
    both directions
    """
    signs = np.array([np.sign(point.velocity) for point in points])
    directions = [[point for point in points if point.velocity * w > 0] for w in (1, -1)]
    if not all(directions):
        return None
    chambers = [
        [[point.pressure_1 for point in direction] for direction in directions],
        [[point.pressure_2 for point in direction] for direction in directions],
    ]
    widths = [min(spread(points, pressures, area) for pressures in chamber) for chamber in chambers]
    chamber = 1 + int(np.argmax(widths))
    if widths[chamber - 1] < 1:
        return None
    second = chamber == 2
    groups = _groups(np.array([point.speed for point in points]))
    levels = (groups[:, None] == np.unique(groups)) * signs[:, None]
    pressure = np.array([point.pressure for point in points])
    force = area * np.array([point.pressure_2 if second else point.pressure_1 for point in points])
    columns = [signs * (pressure - pressure.mean()), np.ones_like(signs), force]
    matrix = np.concatenate([levels, np.stack(columns, axis=1)], axis=1)
    friction = np.array([point.friction for point in points])
    error = np.hypot([point.error for point in points], 1e-3 * np.max(np.abs(friction)))
    scaled, target = matrix / error[:, None], friction / error
    size = np.abs(scaled).max(axis=0)
    spare = target.size - int(np.linalg.matrix_rank(scaled / size))
    if spare < 1:
        return None
    inverse = np.linalg.pinv(scaled / size) / size[:, None]
    solution = inverse @ target
    scatter = max(float(np.sqrt(np.sum((scaled @ solution - target) ** 2) / spare)), 1.0)
    standard_error = scatter * float(np.linalg.norm(inverse[-1]))
    share = float(solution[-1])
    sure = abs(share) > max(quantile(spare) * standard_error, UNEQUAL)
    return Unequal(chamber, share, standard_error, sure)


def _groups(speed: Array) -> Array:
    """Sort points into groups of similar speed; return the index of the group of each point."""
    order = np.argsort(speed)
    first, number = 0.0, -1
    groups = np.zeros(speed.size, dtype=int)
    for k in order:
        if number < 0 or speed[k] > first * (1 + ALIKE):
            first, number = float(speed[k]), number + 1
        groups[k] = number
    return groups


def hidden(parameters: Mapping[str, Parameter], fastest: float, falls: bool) -> str | None:
    """Reason why Coulomb friction F_C and viscous friction sigma_2 are inseparable, or None.

    Parameters
    ----------
    parameters : parameters of a Stribeck curve or of a LuGre model
    fastest : highest speed of the record [m/s]
    falls : whether friction at the fastest speed is below that at the slowest
    """
    speed = parameters.get("stribeck_speed")
    if speed is None:
        if falls and "viscous" in parameters:
            return (
                f"friction decreases with speed up to {1e3 * fastest:.3g} mm/s, the fastest point, "
                "and the points do not show the shape of this decrease, so F_C and σ₂ are "
                "unknown; record more and faster speeds"
            )
        return None
    if fastest < REACH * speed.value:
        return (
            f"the fastest point, {1e3 * fastest:.3g} mm/s, is still on the falling part of the "
            f"Stribeck curve (v_s {1e3 * speed.value:.3g} mm/s), so F_C, σ₂ and v_s cannot be "
            "separated; record faster motion"
        )
    return None


def misled(
    parameters: Mapping[str, Parameter], friction: Array, residuals: Array, errors: Array
) -> Iterator[str]:
    """Yield notes on results that friction alone cannot explain.

    Parameters
    ----------
    parameters : parameters of a Stribeck curve
    friction, residuals, errors : measured friction, residual and standard error of each point [N]
    """
    fitted = friction - residuals
    if "offset" in parameters:
        value, lower, upper, *_ = parameters["offset"]
        least = float(np.min(np.abs(fitted - value)))
        if (lower > 0 or upper < 0) and abs(value) >= least:
            yield (
                f"the offset of {value:.3g} N is not below the least friction, {least:.3g} N: in "
                "one direction, friction would drive the rod; check the bore and the zeros of the "
                "sensors"
            )
    missed = float(np.std(residuals))
    scatter = float(np.sqrt(np.mean((residuals / errors) ** 2)))
    if scatter > BEYOND and missed > MISSED * float(np.median(np.abs(fitted))):
        yield (
            f"the curve misses the points by {missed:.3g} N, more than their standard errors of "
            f"{float(np.median(errors)):.2g} N, so friction depends on more than speed and "
            "pressure"
        )


def ways(parameters: Mapping[str, Parameter], error: Unequal | None) -> Iterator[str]:
    """Yield notes on a missing direction of motion, or on a difference between the directions."""
    if "offset" not in parameters:
        yield ("the rod slides in one direction only, so a sensor's zero error looks like friction")
        return
    offset = parameters["offset"]
    if (error is not None and error.sure) or offset.lower <= 0 <= offset.upper:
        return
    if error is None:
        yield (
            "friction differs between the two directions by an offset; the record cannot show "
            "whether sensor zeros, areas or direction-dependent seals cause it"
        )
    else:
        yield (
            "friction differs between the two directions by an offset that does not depend on "
            "pressure; sensor zeros or direction-dependent seals cause it, not the areas"
        )
