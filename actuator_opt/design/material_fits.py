"""Least-squares fits of a secant damping over speed, with bounds for each parameter.

Both fits minimise sum w (B - B_fit)^2 over the measured points; equal weights unless weights are
given (1/B^2 fits relative errors). Linear parameters are eliminated, so only exponents are
searched [GolubPereyra1973], from every start of a grid. Bounds are those of the linearised model
with Student's t [SeberWild1989]. They assume independent points: for points of a smooth curve they
show the misfit of the law, not scatter.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..base import fitting as least_squares
from ..base.errors import Diagnostic, InputError
from ..base.fitting import WEAK, Parameter, known
from ..base.numeric import STEP, Array
from ..models import damping as laws

FASTEST = 10.0
"""Largest decay of an exponential between neighbouring points: beyond it only one point counts."""
LARGEST_POWER = 300.0
"""Largest exponent of an amplitude extrapolated to rest, far from overflow."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A fitted law B(v), SI.

    `r_squared` is 1 - sum w (B - B_fit)^2/sum w (B - mean)^2; None if all points are equal.
    """

    name: str
    law: Callable[..., Array]
    parameters: Mapping[str, Parameter]
    covariance: Array
    """Covariance of the parameters in their order; infinite if not determined together."""
    speed: Array
    damping: Array
    residuals: Array
    """Measured minus fitted damping [N s/m]."""
    r_squared: float | None
    quantile: float
    """Student's t of the bounds; infinite without degrees of freedom."""
    doubts: tuple[str, ...]
    """Reasons for undetermined parameters; empty if all are determined."""

    @property
    def values(self) -> dict[str, float]:
        """Parameter values by name."""
        return {name: one.value for name, one in self.parameters.items()}

    @property
    def determined(self) -> bool:
        """Whether the points determine every parameter."""
        return not self.doubts

    @property
    def largest_error(self) -> float:
        """Largest |B_fit/B - 1| of all points."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.max(np.abs(self.residuals / self.damping)))

    def predict(self, speed: Array) -> Array:
        """The fitted damping at speeds [m/s]."""
        return self.law(speed=speed, **self.values)

    def bounds(self, speed: Array) -> tuple[Array, Array]:
        """Confidence bounds of the fitted curve (mean value, not a single point) at speeds.

        Infinite where the points leave a parameter unbounded.
        """
        slopes = _slopes(self.law, self.values, speed)
        with np.errstate(invalid="ignore"):
            variance = np.einsum("...i,ij,...j->...", slopes, self.covariance, slopes)
        half = self.quantile * np.sqrt(np.maximum(variance, 0.0))
        half = np.where(np.isfinite(half), half, np.inf)
        middle = self.predict(speed)
        return middle - half, middle + half


def fit_power_law(speed: Array, damping: Array, weights: Array | None = None) -> Fit:
    """Fit B = a v^b [Huang2017].

    Parameters
    ----------
    speed : > 0 [m/s], (points)
    damping : secant VDC [N s/m], (points)
    weights : of the squared errors, > 0 (points); None for equal ones

    Returns
    -------
    the fit, parameters `coefficient` (a, at 1 m/s) and `exponent` (b)

    Examples
    --------
    >>> fit = fit_power_law([1e-3, 2e-3, 4e-3], [8e5, 4e5, 2e5])
    >>> print(f"{fit.parameters['exponent'].value:.6f}")
    -1.000000
    """
    v, b, w = _points(speed, damping, weights, parameters=2)
    logarithm = np.log(v / v[-1])
    steepest = LARGEST_POWER / max(-logarithm[0], *np.abs(np.log(v[[0, -1]])))
    grid = _both_signs(0.05, min(20.0, steepest), 30)
    (exponent,), (amplitude,) = _projected(
        b, w, [(one,) for one in grid], lambda rate: _shifted(rate, logarithm), steepest
    )
    reference = v[0] if exponent < 0 else v[-1]
    values = {"coefficient": float(amplitude * reference**-exponent), "exponent": float(exponent)}
    return assess("power law", laws.power_law, values, v, b, w, least={"exponent": 1.0})


def fit_double_exponential(speed: Array, damping: Array, weights: Array | None = None) -> Fit:
    """Fit B = a1 e^(b1 v) + a2 e^(b2 v) [Huang2017]; the steeper exponential first.

    Parameters
    ----------
    speed : > 0 [m/s], (points)
    damping : secant VDC [N s/m], (points)
    weights : of the squared errors, > 0 (points); None for equal ones

    Returns
    -------
    the fit, parameters `coefficient_1`, `rate_1`, `coefficient_2`, `rate_2`

    Examples
    --------
    >>> v = np.array([1e-3, 2e-3, 4e-3, 6e-3, 9e-3])
    >>> fit = fit_double_exponential(v, 3e5 * np.exp(-900 * v) + 1e5 * np.exp(-50 * v))
    >>> print(f"{fit.parameters['rate_1'].value:.3f}")
    -900.000
    """
    v, b, w = _points(speed, damping, weights, parameters=4)
    gap = float(np.min(np.diff(np.unique(v))))
    steepest = min(FASTEST / gap, LARGEST_POWER / float(v[-1]))
    grid = _both_signs(0.03 / float(v[-1]), steepest, 26)
    pairs = [(one, other) for k, one in enumerate(grid) for other in grid[k + 1 :]]
    rates, amplitudes = _projected(b, w, pairs, lambda rate: _shifted(rate, v), steepest)
    order = np.argsort(rates)
    found = [(amplitudes[k] * np.exp(-rates[k] * _reference(rates[k], v)), rates[k]) for k in order]
    values = {
        "coefficient_1": float(found[0][0]),
        "rate_1": float(found[0][1]),
        "coefficient_2": float(found[1][0]),
        "rate_2": float(found[1][1]),
    }
    at_limit = [one for one in rates if abs(one) > 0.999 * steepest]
    doubts = ("an exponential so steep that only one point affects it",) if at_limit else ()
    least = dict.fromkeys(("rate_1", "rate_2"), 1 / float(v[-1]))
    law = laws.double_exponential
    return assess("double exponential", law, values, v, b, w, least=least, doubts=doubts)


def assess(
    name: str,
    law: Callable[..., Array],
    values: Mapping[str, float],
    speed: Array,
    damping: Array,
    weights: Array,
    *,
    least: Mapping[str, float] | None = None,
    doubts: tuple[str, ...] = (),
) -> Fit:
    """Fitted law from least-squares values: bounds, R-squared, undetermined parameters.

    Parameters
    ----------
    name : name of the law
    law : function B(speed, values), safe under a complex step
    values : least-squares parameters by name, SI
    speed, damping, weights : the points
    least : sizes of parameters that may be near 0, as steps that matter to the curve; the size of
        other parameters is their value
    doubts : parameters that the search already left undetermined

    Returns
    -------
    the fit
    """
    fitted = law(speed=speed, **values)
    residuals = damping - fitted
    sizes = np.array([max(abs(x), (least or {}).get(key, 0.0)) or 1.0 for key, x in values.items()])
    slopes = np.sqrt(weights)[:, None] * _slopes(law, values, speed)
    found = known(values, slopes, np.sqrt(weights) * residuals, sizes)
    spare = speed.size - len(values)
    reasons = list(doubts)
    if spare == 0:
        reasons.append(
            f"{speed.size} points leave no degree of freedom for {len(values)} parameters"
        )
    elif found.rank < len(values):
        reasons.append(f"the points determine {found.rank} of {len(values)} parameters")
    else:
        weak = [key for key, one in found.parameters.items() if not one.identifiable]
        if weak:
            reasons.append(f"bounds of {', '.join(weak)} wider than {WEAK:.0%} of the value")
    return Fit(
        name=name,
        law=law,
        parameters=found.parameters,
        covariance=found.covariance,
        speed=speed,
        damping=damping,
        residuals=residuals,
        r_squared=_r_squared(damping, fitted, weights),
        quantile=found.quantile,
        doubts=tuple(reasons),
    )


def _slopes(law: Callable[..., Array], values: Mapping[str, float], speed: Array) -> Array:
    """Derivatives of the law by its parameters, (..., parameters), by complex steps."""
    speed = np.asarray(speed, dtype=float)
    columns = []
    for name, value in values.items():
        stepped = law(speed=speed, **{**values, name: value + 1j * STEP})
        columns.append(np.broadcast_to(np.imag(stepped) / STEP, speed.shape))
    return np.stack(columns, axis=-1)


def _r_squared(damping: Array, fitted: Array, weights: Array) -> float | None:
    mean = np.sum(weights * damping) / np.sum(weights)
    spread = float(np.sum(weights * (damping - mean) ** 2))
    if spread <= (1e-14 * float(np.max(np.abs(damping)))) ** 2 * float(np.sum(weights)):
        return None
    return 1 - float(np.sum(weights * (damping - fitted) ** 2)) / spread


def _reference(rate: float, abscissa: Array) -> float:
    """Argument at which an exponential is largest over the points."""
    return float(abscissa[0] if rate < 0 else abscissa[-1])


def _shifted(rate: float, abscissa: Array) -> Array:
    """e^(rate x) over its largest value at the points: never overflows."""
    return np.exp(rate * (abscissa - _reference(rate, abscissa)))


def _both_signs(least: float, most: float, count: int) -> list[float]:
    """A geometric grid of rates of both signs."""
    half = np.geomspace(least, most, count)
    return [float(one) for one in (*-half[::-1], *half)]


def _projected(
    damping: Array,
    weights: Array,
    starts: Sequence[tuple[float, ...]],
    basis: Callable[[float], Array],
    steepest: float,
) -> tuple[Array, Array]:
    """Least-squares rates and amplitudes: amplitudes by linear least squares for every rate.

    The best distinct starts are refined within +-steepest.
    """
    root = np.sqrt(weights / np.sum(weights))
    scale = float(np.max(np.abs(damping))) or 1.0
    target = root * damping / scale

    def linear(rates: Array) -> tuple[Array, Array]:
        columns = np.stack([root * basis(float(one)) for one in rates], axis=-1)
        amplitudes = np.linalg.lstsq(columns, target, rcond=None)[0]
        return amplitudes, columns @ amplitudes - target

    def misfit(rates: Array) -> Array:
        return linear(rates)[1]

    costs = [float(np.sum(misfit(np.array(one)) ** 2)) for one in starts]
    best, least = np.array(starts[int(np.argmin(costs))]), np.inf
    for start in _apart(starts, costs):
        limit = np.full(start.shape, steepest)
        found = least_squares.solve(
            misfit,
            np.clip(start, -0.99 * limit, 0.99 * limit),
            (-limit, limit),
            slopes="3-point",
            sizes=np.abs(start),
            cost_tolerance=1e-15,
            step_tolerance=1e-15,
            slope_tolerance=1e-15,
        )
        if found.cost < least:
            best, least = found.x, found.cost
    return best, linear(best)[0] * scale


def _apart(starts: Sequence[tuple[float, ...]], costs: list[float], count: int = 6) -> Array:
    """Starts of least cost that differ from each other by more than a third in a rate."""
    chosen: list[tuple[float, ...]] = []
    for k in np.argsort(costs):
        start = np.array(starts[k])
        if all(np.max(np.abs(start / np.array(one) - 1)) > 1 / 3 for one in chosen):
            chosen.append(starts[k])
        if len(chosen) == count:
            break
    return np.array(chosen)


def _points(
    speed: Array, damping: Array, weights: Array | None, *, parameters: int
) -> tuple[Array, Array, Array]:
    """Points in order of speed, as arrays; raises a one-line error if unusable."""
    v, b = (np.atleast_1d(np.asarray(one, dtype=float)) for one in (speed, damping))
    w = np.ones(v.shape) if weights is None else np.atleast_1d(np.asarray(weights, dtype=float))
    if v.ndim != 1 or v.shape != b.shape or v.shape != w.shape:
        sizes = ", ".join(str(one.shape) for one in (v, b, w))
        raise _fault(
            f"speed, damping and weights have shapes {sizes}", "give one value of each per point"
        )
    for name, one in (("speed", v), ("damping", b), ("weight", w)):
        broken = np.flatnonzero(~np.isfinite(one))
        if broken.size:
            raise _fault(f"{name} of point {broken[0]} is {one[broken[0]]}", "leave the point out")
    for name, one in (("speed", v), ("weight", w)):
        low = np.flatnonzero(one <= 0)
        if low.size:
            reason = "secant damping is undefined at rest and " if name == "speed" else ""
            fault = f"{name} of point {low[0]} is {one[low[0]]:g}; {reason}must be above 0"
            raise _fault(fault, "leave the point out")
    different = np.unique(v).size
    if different < parameters:
        fault = f"{different} different speeds for a law with {parameters} parameters"
        raise _fault(fault, f"give at least {parameters}; bounds need one more")
    order = np.argsort(v, kind="stable")
    return v[order], b[order], w[order]


def _fault(message: str, remedy: str) -> InputError:
    return InputError(Diagnostic(f"fit of the damping: {message}", remedy))
