"""Fit of a Stribeck curve to points: global search, least squares, confidence intervals, notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base import fitting as least_squares
from ..base.dataclass import dataclass
from ..base.fitting import Parameter, known
from ..base.numeric import STEP, Array
from ..models import friction
from .doubtful import INSEPARABLE, hidden, misled, spread, unbounded, unequal, ways, widened
from .points import FrictionPoint

STATIC_MOST = 3.0
"""Largest static friction F_S in the search, as a multiple of the largest measured friction (our
choice: a higher F_S is a guess)."""
SPEEDS, EXPONENTS = (2e-4, 5e-2), (0.5, 2.5)
"""Ranges in which the Stribeck speed [m/s] and its exponent are searched (our choices: a decade on
either side of the few mm/s of seals; half a unit beyond the exponents 1 and 2 of the usual
laws)."""
EXPONENT = 2.0
"""Exponent that is used if the points cannot determine it ([MECE5005], [Huang2017] Table 2)."""
SHARED = 0.85
"""Smallest scatter about the curve that is assumed for the points of a sweep, as a share of their
standard errors (our choice, from records of known friction). The filter correlates neighbouring
points, so they scatter less than their standard errors suggest."""
OTHER = 0.5
"""If the exponent is fixed, the confidence intervals allow for this second exponent as well. Bo and
Pavelescu use 0.5 to 1, Tustin uses 1, others use 2 [ArmstrongHelouvry1994]."""
DIFFERENT = 0.05
"""Relative difference above which two speeds count as different (our choice: more than
`points.STEADY`)."""
MODEL = 1e-3
"""Error that every point gets in addition to its standard error, as a share of the largest friction
(our choice: no curve fits real friction better than that)."""
_LEVELS = (("coulomb", "viscous"), ("static", "stribeck_speed"), ("exponent",))
"""Groups of parameters. The first fit has the parameters of the first group; each further fit adds
those of the next group."""


@dataclass(frozen=True, slots=True, eq=False)
class StribeckFit:
    """A Stribeck curve, SI: F = sgn v [g(v) (1 + (p - p_0) s/F_C) + sigma_2 |v|] + F_0.

    F is the friction, v the velocity, g the Stribeck function from F_S to F_C, p the pressure, p_0
    a reference pressure, s the pressure slope, sigma_2 the viscous friction, F_0 the offset.

    Parameters
    ----------
    parameters : fitted parameters by name
    held : values of the parameters that are fixed and not fitted, such as exponent 2 or offset 0
    covariance : covariance of the fitted parameters, in their order
    quantile : quantile of Student's t for the confidence intervals
    reference_pressure : p_0 [Pa]
    residuals : measured minus fitted friction of each point [N]
    errors : standard error of each point, which gives its weight [N]
    doubts : reasons why a parameter was not fitted or is unknown
    doubted : whether the friction itself is doubtful, because areas or sensors seem wrong
    """

    parameters: Mapping[str, Parameter]
    held: Mapping[str, float]
    covariance: Array
    quantile: float
    reference_pressure: float
    residuals: Array
    errors: Array
    doubts: tuple[str, ...]
    doubted: bool = False

    @property
    def values(self) -> dict[str, float]:
        """All parameters, fitted or fixed."""
        return {
            **self.held,
            **{name: parameter.value for name, parameter in self.parameters.items()},
        }

    @property
    def scatter(self) -> float:
        """Standard deviation of the residuals, each divided by the error of its point."""
        spare = self.residuals.size - len(self.parameters)
        return float(np.sqrt(np.sum((self.residuals / self.errors) ** 2) / spare))

    def predict(self, velocity: Array, pressure: Array) -> Array:
        """Friction at given velocities [m/s] and pressures [Pa]."""
        return curve(velocity, pressure - self.reference_pressure, **self.values)

    def bounds(self, velocity: Array, pressure: Array) -> tuple[Array, Array]:
        """Confidence limits of the curve at given velocities and pressures."""
        names = tuple(self.parameters)
        slopes = _slopes(velocity, pressure - self.reference_pressure, self.values, names)
        with np.errstate(invalid="ignore"):
            variance = np.einsum("...i,ij,...j->...", slopes, self.covariance, slopes)
        half = self.quantile * np.sqrt(np.maximum(variance, 0.0))
        half = np.where(np.isfinite(half), half, np.inf)
        middle = self.predict(velocity, pressure)
        return middle - half, middle + half


def curve(
    velocity: Array,
    pressure_change: Array,
    *,
    coulomb: Array,
    static: Array,
    stribeck_speed: Array,
    exponent: Array,
    viscous: Array,
    pressure_slope: Array = 0.0,
    offset: Array = 0.0,
) -> Array:
    """Friction of the curve at velocities other than zero, with the sign of the velocity [N]."""
    speed, way = np.abs(velocity), np.sign(velocity)
    level = friction.stribeck_level(
        speed=speed,
        coulomb=coulomb,
        static=static,
        stribeck_speed=stribeck_speed,
        exponent=exponent,
    )
    return (
        way * (level * (1 + pressure_slope * pressure_change / coulomb) + viscous * speed) + offset
    )


def fit_stribeck(points: Sequence[FrictionPoint], area: float) -> StribeckFit | str:
    """Fit a Stribeck curve to points of steady sliding; return the reason if it is not possible.

    Coulomb friction F_C and viscous friction sigma_2 are always fitted. With five different speeds
    or more, static friction F_S and Stribeck speed v_s are fitted if they improve the fit
    (corrected Akaike information). With seven speeds or more the exponent is then always fitted,
    because fitting it only if it improves the fit would bias it and F_S. An offset is fitted if the
    rod moves in both directions. A pressure effect is fitted if there are five points or more and
    the pressure varies enough (`doubtful.spread`).

    Parameters
    ----------
    points : points of steady sliding
    area : piston area of the cap end [m^2]

    Returns
    -------
    the fit, or the reason why it is missing
    """
    speeds = different([point.speed for point in points])
    if len(speeds) < 2:
        at = f"one speed, {1e3 * speeds[0]:.3g} mm/s" if speeds else "no steady sliding"
        return (
            f"{at}, but a Stribeck curve needs plateaus or sweeps at 2 speeds, and at 5 speeds "
            "to give F_S and v_s"
        )
    further = _further(points, area)
    doubts: list[str] = []
    fits = []
    for depth, least in ((1, 2), (2, 5), (3, 7)):
        names = [name for level in _LEVELS[:depth] for name in level] + further
        if len(speeds) < least or len(points) <= len(names) + 1:
            break
        fits.append(_fit(points, tuple(names), EXPONENT))
    if not fits:
        return (
            f"{len(points)} points for {2 + len(further)} parameters are too few; give more "
            "plateaus or sweeps at other speeds"
        )
    best = min(fits, key=_information)
    if "static" in best.parameters:
        best = fits[-1]
        exponent = best.parameters.get("exponent")
        if exponent is None or not exponent.identifiable:
            best = _allowing_exponents(best, points)
    if len(fits) < 2:
        doubts.append(
            f"{len(speeds)} speeds are too few to determine F_S and v_s; give five or more"
        )
    elif "static" not in best.parameters:
        doubts.append(
            "friction does not rise towards zero speed, so F_S and v_s cannot be determined"
        )
    elif "exponent" not in best.parameters:
        doubts.append(
            f"the Stribeck exponent is fixed at {EXPONENT:g}, but the confidence intervals allow "
            f"for {OTHER:g} as well; seven speeds would determine the exponent"
        )
    slowest, *_, fastest = sorted(points, key=lambda point: point.speed)
    falls = abs(fastest.friction) < abs(slowest.friction)
    reason = hidden(best.parameters, fastest.speed, falls)
    if reason is not None:
        doubts.append(reason)
        best = replace(best, parameters=unbounded(best.parameters, INSEPARABLE))
    return _with_doubts(replace(best, doubts=tuple(doubts)), points, area)


def _with_doubts(fit: StribeckFit, points: Sequence[FrictionPoint], area: float) -> StribeckFit:
    """Add reasons to doubt the measured friction: wrong areas, wrong sensors, other influences."""
    error = unequal(points, area)
    plunger = all(point.pressure_2 == 0 for point in points)
    faults = [] if error is None or not error.sure else [error.says(area, plunger)]
    measured = np.array([point.friction for point in points])
    contradictions = list(misled(fit.parameters, measured, fit.residuals, fit.errors))
    parameters = unbounded(fit.parameters, fit.parameters if contradictions else ())
    doubts = (*fit.doubts, *faults, *contradictions, *ways(parameters, error))
    doubted = bool(faults or contradictions)
    return replace(fit, parameters=parameters, doubts=doubts, doubted=doubted)


def _allowing_exponents(fit: StribeckFit, points: Sequence[FrictionPoint]) -> StribeckFit:
    """The fit, with confidence intervals that allow for exponents other than the fixed value."""
    names = tuple(name for name in fit.parameters if name != "exponent")
    errors = held_error(fit.parameters, _fit(points, names, OTHER).values)
    return replace(fit, parameters=widened(fit.parameters, errors, fit.quantile))


def held_error(parameters: Mapping[str, Parameter], other: Mapping[str, float]) -> dict[str, float]:
    """Standard error of each parameter because the exponent is fixed rather than fitted.

    It is d/sqrt 3 if the parameter differs by d between fits with two fixed exponents. `other` has
    the values of the second fit.
    """
    return {
        name: abs(other[name] - parameter.value) / float(np.sqrt(3))
        for name, parameter in parameters.items()
        if name != "exponent"
    }


def different(speeds: Sequence[float]) -> list[float]:
    """The speeds in rising order, of which those within `DIFFERENT` of another count only once."""
    distinct: list[float] = []
    for speed in sorted(speeds):
        if not distinct or speed > distinct[-1] * (1 + DIFFERENT):
            distinct.append(speed)
    return distinct


def _further(points: Sequence[FrictionPoint], area: float) -> list[str]:
    """Which of the parameters "offset" and "pressure_slope" the points can determine."""
    ways = {point.velocity > 0 for point in points}
    names = ["offset"] if len(ways) == 2 else []
    for way in ways:
        pressures = [point.pressure for point in points if (point.velocity > 0) == way]
        if len(points) > 4 and spread(points, pressures, area) > 1:
            return [*names, "pressure_slope"]
    return names


class Steady:
    """Points of steady sliding as arrays, and the friction that a Stribeck curve gives for them.

    A point of a sweep is a mean over a range of speeds, so the curve is averaged over that range.
    """

    def __init__(self, points: Sequence[FrictionPoint], error: Array | None = None) -> None:
        self.velocity = np.array([point.velocity for point in points])
        self.spread = np.array([point.spread for point in points])
        pressure = np.array([point.pressure for point in points])
        errors = np.array([point.error for point in points])
        self.friction = np.array([point.friction for point in points])
        self.largest = float(np.max(np.abs(self.friction)))
        self.error = np.hypot(errors, MODEL * self.largest) if error is None else error
        self.reference = float(np.mean(pressure))
        self.change = pressure - self.reference

    def predict(self, values: Mapping[str, Array]) -> Array:
        """Friction that the curve gives for the points.

        It is the mean of the curve at v - s and v + s, with a point's mean velocity v and the
        standard deviation s of its velocities.
        """
        velocities = (self.velocity - self.spread, self.velocity + self.spread)
        return sum(curve(velocity, self.change, **values) for velocity in velocities) / 2

    def residual(self, values: Mapping[str, Array]) -> Array:
        """Fitted minus measured friction, divided by the error of each point."""
        return (self.predict(values) - self.friction) / self.error

    def slopes(self, values: Mapping[str, float], names: Sequence[str]) -> Array:
        """Derivatives of the friction with respect to the parameters, (points, parameters)."""
        velocities = (self.velocity - self.spread, self.velocity + self.spread)
        return sum(_slopes(velocity, self.change, values, names) for velocity in velocities) / 2


def _held(names: Sequence[str], coulomb: float, exponent: float) -> dict[str, float]:
    """Fixed values of the parameters that are not among the fitted `names`."""
    held = {"exponent": exponent, "pressure_slope": 0.0, "offset": 0.0}
    if "static" not in names:
        held |= {"static": coulomb, "stribeck_speed": SPEEDS[0]}
    return {name: value for name, value in held.items() if name not in names}


def _fit(points: Sequence[FrictionPoint], names: tuple[str, ...], exponent: float) -> StribeckFit:
    """Fit the parameters `names` by least squares, starting from the result of `_search`.

    The exponent is fixed at `exponent` if it is not among them.
    """
    data = Steady(points)
    start = _search(data, names, exponent)
    scale = _scales(data)

    def values(x: Array) -> dict[str, float]:
        parameters = dict(zip(names, x * [scale[name] for name in names], strict=True))
        if "static" in names:  # the excess of F_S over F_C is searched, which ensures F_S >= F_C
            parameters["static"] = parameters["coulomb"] + parameters["static"]
        return _held(names, parameters["coulomb"], exponent) | parameters

    def residuals(x: Array) -> Array:
        return data.residual(values(x))

    def slopes(x: Array) -> Array:
        columns = data.slopes(values(x), names)
        if "static" in names:
            rise = columns[:, names.index("static")]
            columns[:, names.index("coulomb")] += rise
        return columns * [scale[name] for name in names] / data.error[:, None]

    low, high = (np.array(side) for side in _limits(names, scale))
    x0 = np.array([start[name] / scale[name] for name in names])
    minimum = least_squares.solve(
        residuals, x0, (low, high), slopes=slopes, sizes="jac", room=1e-9, most=400
    )
    best = values(minimum.x)
    optimum = {name: best[name] for name in names}
    jacobian = data.slopes(best, names) / data.error[:, None]
    sizes = np.array([max(abs(optimum[name]), 1e-3 * scale[name]) for name in names])
    residual = data.residual(best)
    factor = 1.0
    if any(point.kind == "sweep" for point in points):
        scatter = float(np.sqrt(np.sum(residual**2) / max(residual.size - len(names), 1)))
        factor = max(SHARED / max(scatter, 1e-9), 1.0)
    fitted = known(optimum, jacobian, residual * factor, sizes)
    return StribeckFit(
        fitted.parameters,
        _held(names, best["coulomb"], exponent),
        fitted.covariance,
        fitted.quantile,
        data.reference,
        -residual * data.error,
        data.error,
        (),
    )


def _limits(names: Sequence[str], scale: Mapping[str, float]) -> tuple[list[float], list[float]]:
    """Limits of the search, relative to the typical sizes of the parameters."""
    low = {"coulomb": 1e-6, "static": 0.0, "viscous": 0.0}
    low |= {"stribeck_speed": SPEEDS[0] / scale["stribeck_speed"], "exponent": EXPONENTS[0]}
    high = {"static": STATIC_MOST, "exponent": EXPONENTS[1]}
    high |= {"stribeck_speed": SPEEDS[1] / scale["stribeck_speed"]}
    return (
        [low.get(name, -np.inf) for name in names],
        [high.get(name, np.inf) for name in names],
    )


def _scales(data: Steady) -> dict[str, float]:
    """Typical size of each parameter for the record."""
    speed = float(np.max(np.abs(data.velocity)))
    pressure = max(float(np.max(np.abs(data.change))), 1.0)
    return {
        "coulomb": data.largest,
        "static": data.largest,
        "stribeck_speed": 1e-3,
        "exponent": 1.0,
        "viscous": data.largest / speed,
        "offset": data.largest,
        "pressure_slope": data.largest / pressure,
    }


def _search(data: Steady, names: Sequence[str], held: float) -> dict[str, float]:
    """Initial values: the best of a grid of Stribeck speeds and exponents.

    At each grid point, the other parameters follow from linear least squares.
    """
    way, speed = np.sign(data.velocity), np.abs(data.velocity)
    columns = {"coulomb": way, "viscous": data.velocity}
    if "offset" in names:
        columns["offset"] = np.ones_like(speed)
    if "pressure_slope" in names:
        columns["pressure_slope"] = way * data.change
    grid: list[tuple[float, float]] = [(SPEEDS[0], held)]
    if "static" in names:
        exponents = np.linspace(*EXPONENTS, 6) if "exponent" in names else [held]
        grid = [(v, d) for v in np.geomspace(*SPEEDS, 30) for d in exponents]
    best, least = {}, np.inf
    from scipy.optimize import lsq_linear  # slow import, rarely used

    for stribeck_speed, exponent in grid:
        columns_with_rise = dict(columns)
        if "static" in names:
            columns_with_rise["static"] = way * np.exp(-((speed / stribeck_speed) ** exponent))
        matrix = np.stack(list(columns_with_rise.values()), axis=1) / data.error[:, None]
        target = data.friction / data.error
        amplitudes, *_ = np.linalg.lstsq(matrix, target, rcond=None)
        at = dict(zip(columns_with_rise, amplitudes, strict=True))
        if any(at.get(name, 1.0) < 0 for name in ("coulomb", "viscous", "static")):
            low = [
                0.0 if name in ("coulomb", "viscous", "static") else -np.inf
                for name in columns_with_rise
            ]
            amplitudes = lsq_linear(matrix, target, (low, np.inf), method="bvls").x
            at = dict(zip(columns_with_rise, amplitudes, strict=True))
        cost = float(np.sum((matrix @ amplitudes - target) ** 2))
        if cost < least:
            best, least = at | {"stribeck_speed": stribeck_speed, "exponent": exponent}, cost
    return best


def _slopes(
    velocity: Array, change: Array, values: Mapping[str, float], names: Sequence[str]
) -> Array:
    """Derivatives of the curve with respect to the parameters, which are the last axis."""
    columns = []
    for name in names:
        moved = {**values, name: values[name] + 1j * STEP}
        if name == "coulomb" and "static" not in names:
            moved["static"] = moved["coulomb"]
        columns.append(np.imag(curve(velocity, change, **moved)) / STEP)
    return np.stack(columns, axis=-1)


def _information(fit: StribeckFit) -> float:
    """Corrected Akaike information criterion of the weighted residuals; smaller is better."""
    count, parameters = fit.residuals.size, len(fit.parameters) + 1
    spare = count - parameters - 1
    if spare <= 0:
        return np.inf
    cost = max(float(np.sum((fit.residuals / fit.errors) ** 2)), 1e-30)
    return float(count * np.log(cost / count) + 2 * parameters * count / spare)
