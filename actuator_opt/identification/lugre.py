"""Fit of a LuGre friction model to a record, from its reversals.

In the LuGre model, elastic bristles represent the contact before it slides. Their stiffness, their
damping and the lag of the pressures are fitted to short sections of the record ('windows') around
the reversals. The Stribeck parameters are fitted at the same time, to the windows and to the points
of steady sliding.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base import fitting as least_squares
from ..base.dataclass import dataclass
from ..base.fitting import NORMAL, Parameter, known, quantile
from ..base.numeric import Array
from .balance import Sliding
from .conditioning import ConditionedRecord
from .doubtful import INSEPARABLE, agreed, hidden, unbounded, widened
from .points import SETTLED, SETTLING, FrictionPoint
from .stribeck_fit import (
    EXPONENT,
    EXPONENTS,
    OTHER,
    SHARED,
    SPEEDS,
    Steady,
    StribeckFit,
    held_error,
)
from .windows import LAG, Windows, no_windows, windows

TRAVELS = (1e-6, 3e-3)
"""Range in which the breakaway travel F_S/sigma_0, static friction divided by bristle stiffness, is
searched [m] (our choice: nearly two decades on either side of 50 um)."""
DAMPING_TIMES = (1e-6, 0.3)
"""Range in which sigma_1/sigma_0, bristle damping divided by bristle stiffness, is searched [s]
(our choice: from no damping to the length of a window)."""
USUAL = 5e-3
"""Usual standard deviation of the pressure lag [s]. If a record does not show the lag, the
confidence intervals allow for it (our choice: sensors and lines of a test bench lag by up to 10
ms)."""
STEP = 1e-4
"""Relative step of the central differences (our choice: gives an error of 1e-8)."""
SYMBOLS = {"bristle_stiffness": "σ₀", "bristle_damping": "σ₁", "lag": "τ"}
"""Symbols of the parameters that a LuGre model has in addition to those of the Stribeck curve.
Units are N/m, N s/m and s."""
MODEL = 1e-3
"""Smallest scatter that is assumed for the windows, as a share of the largest friction (our choice,
as for the points: the filtered motion is not accurate enough for a smaller scatter)."""
BENDS = 3.0
"""Number of breakaway travels F_S/sigma_0 after which 95 % of the friction is reached: 1 - e^-3.
The record must have enough samples within this travel."""
LATE = 1.5
"""Factor by which the standard error of a lag is increased (our choice, from records of known
friction: with 25 kPa of noise and position steps of 10 um, the true error is 1.3 to 1.9 standard
errors)."""
NOISY, MISSED = 2.0, 0.02
"""Largest acceptable misfit in the windows: a multiple of the noise plus a share of the largest
friction (our choice, from records of known friction: position steps add up to 3 times the
noise)."""
DETERMINED = 3
"""Number of parameters that the windows determine: stiffness, lag or damping, and friction
level."""
RCOND = 1e-6
"""Singular values of the derivatives below this share of the largest one are ignored (our choice:
far above rounding errors)."""
ROUNDS = 2
"""Number of searches. Each search weights the windows by their scatter about the model found so far
(our choice: the second search changes the weights by only a few per cent)."""
LOGARITHMIC = ("bristle_stiffness", "bristle_damping", "stribeck_speed")
"""Parameters whose logarithms are searched."""


@dataclass(frozen=True, slots=True, eq=False)
class LuGreFit:
    """A LuGre model, SI.

    Parameters
    ----------
    parameters : fitted parameters by name: those of the Stribeck curve, `bristle_stiffness`,
        `bristle_damping`, and the `lag` of the pressures
    held : parameters with fixed values
    count : number of windows around reversals
    misfit : standard deviation between measured and modelled friction in the windows [N]
    doubts : notes on unknown parameters, and other reasons to doubt the model
    """

    parameters: Mapping[str, Parameter]
    held: Mapping[str, float]
    count: int
    misfit: float
    doubts: tuple[str, ...]

    @property
    def values(self) -> dict[str, float]:
        """All parameters, fitted or fixed."""
        return {
            **self.held,
            **{name: parameter.value for name, parameter in self.parameters.items()},
        }


def sizes(names: Sequence[str], largest: float, steady: Steady | None) -> Array:
    """Typical size of each searched parameter; 1 if its logarithm is searched."""
    speed, change = 1e-3, 1e5
    if steady is not None:
        speed = max(speed, float(np.max(np.abs(steady.velocity))))
        change = max(change, float(np.max(np.abs(steady.change))))
    size = dict.fromkeys(("coulomb", "static", "offset"), largest)
    size |= {"viscous": largest / speed, "pressure_slope": largest / change, "lag": 1e-2}
    return np.array([size.get(name, 1.0) for name in names])


def _rise(static: float) -> dict[str, float]:
    """Initial Stribeck parameters for friction that falls from F_S to F_C as speed increases."""
    speed = float(np.sqrt(SPEEDS[0] * SPEEDS[1]))
    return {"exponent": EXPONENT, "static": static, "stribeck_speed": speed}


class LugreProblem:
    """The least-squares problem of a LuGre fit, with the parameters that the search varies.

    Its residuals are those of the points of steady sliding and of the windows around reversals.
    """

    def __init__(
        self,
        reversals: Windows,
        points: Sequence[FrictionPoint],
        stribeck: StribeckFit | None,
        fixed: Mapping[str, float],
        *,
        falling: bool = False,
    ) -> None:
        """Set up the search; `fixed` are values of parameters that are not searched.

        Without a Stribeck curve, sliding friction is constant or, if `falling`, drops from F_S to
        F_C as speed increases.
        """
        self.windows = reversals
        self.steady = None
        self.largest = reversals.largest
        self.spread = 1.0
        if stribeck is None:
            self.begin = {"coulomb": self.largest, "offset": 0.0}
            self.held = {"viscous": 0.0, "exponent": EXPONENT, "pressure_slope": 0.0}
            self.held["stribeck_speed"] = SPEEDS[0]
            if falling:
                del self.held["stribeck_speed"], self.held["exponent"]
                self.begin |= _rise(self.largest) | {"coulomb": self.largest / 2}
        else:
            spacing = reversals.step * float(reversals.kept[1] - reversals.kept[0])
            noise = [point.error * np.sqrt(max(point.weight / spacing, 1.0)) for point in points]
            self.noise = float(np.median(noise))
            least = SHARED if any(point.kind == "sweep" for point in points) else 1e-3
            self.steady = Steady(points, stribeck.errors * max(stribeck.scatter, least))
            self.begin = {name: parameter.value for name, parameter in stribeck.parameters.items()}
            self.held = dict(stribeck.held)
            self.references = stribeck.parameters
            self._release_static(stribeck)
        for name, value in fixed.items():
            self.begin.pop(name, None)
            self.held[name] = value
        self.names = (*self.begin, *(name for name in SYMBOLS if name not in self.held))
        self.sizes = sizes(self.names, self.largest, self.steady)

    def _release_static(self, stribeck: StribeckFit) -> None:
        """Fit static friction F_S and Stribeck speed v_s to the windows around reversals.

        This is done only if the points of steady sliding do not determine them.
        """
        static = stribeck.parameters.get("static")
        if self.held.pop("exponent", None) is not None:
            self.begin["exponent"] = EXPONENT
        if static is None or not static.identifiable:
            for name in ("static", "stribeck_speed"):
                self.held.pop(name, None)
            self.begin |= _rise(max(self.largest, 1.01 * self.begin["coulomb"]))

    def values(self, rows: Array) -> dict[str, Array]:
        """Convert searched values, one set per row, to parameters, each of shape (rows,)."""
        searched = {}
        for name, column in zip(self.names, rows.T, strict=True):
            searched[name] = np.exp(column) if name in LOGARITHMIC else column
        held = {name: np.full(rows.shape[0], value) for name, value in self.held.items()}
        if "static" not in searched:
            held["static"] = searched["coulomb"]
        return held | searched

    def values_at(self, x: Array) -> dict[str, float]:
        """Convert one set of searched values to parameters."""
        return {name: float(column[0]) for name, column in self.values(x[None]).items()}

    def residuals(self, rows: Array) -> Array:
        """Weighted residuals, (rows, residuals), for searched values, one set per row."""
        values = self.values(rows)
        misfits = (self.windows.misfit(values) / self.spread).reshape(len(rows), -1)
        if self.steady is None:
            return misfits
        steady = {n: v[:, None] for n, v in values.items() if n not in SYMBOLS}
        return np.concatenate([self.steady.residual(steady), misfits], axis=1)

    def residuals_at(self, x: Array) -> Array:
        """Weighted residuals, (residuals,), for one set of searched values."""
        return self.residuals(x[None])[0]

    def slopes(self, x: Array) -> Array:
        """Derivatives of the residuals by central differences; all steps are evaluated at once."""
        steps = STEP * np.diag(self.sizes)
        residuals = self.residuals(np.concatenate([x + steps, x - steps]))
        return ((residuals[: x.size] - residuals[x.size :]) / (2 * STEP * self.sizes[:, None])).T

    def limits(self) -> tuple[Array, Array]:
        """Lower and upper limits of the searched values."""
        stiffest, softest = (self.largest / travel for travel in TRAVELS)
        ends = {
            "coulomb": (1e-3 * self.largest, np.inf),
            "static": (1e-3 * self.largest, 3 * self.largest),
            "viscous": (0.0, np.inf),
            "exponent": EXPONENTS,
            "stribeck_speed": tuple(np.log(SPEEDS)),
            "bristle_stiffness": (np.log(softest), np.log(stiffest)),
            "bristle_damping": tuple(
                np.log([softest * DAMPING_TIMES[0], stiffest * DAMPING_TIMES[1]])
            ),
            "lag": (-LAG, LAG),
        }
        pairs = [ends.get(name, (-np.inf, np.inf)) for name in self.names]
        return np.array([pair[0] for pair in pairs]), np.array([pair[1] for pair in pairs])

    def start(self) -> Array:
        """Initial values: the best of a grid of bristle stiffnesses, lags and Stribeck speeds."""
        speeds = [self.begin.get("stribeck_speed", SPEEDS[0])]
        if "static" in self.begin and "stribeck_speed" not in self.held:
            speeds = [0.3 * speeds[0], speeds[0], 3 * speeds[0]]
        rows = []
        for speed in speeds:
            for travel in np.geomspace(3 * TRAVELS[0], TRAVELS[1] / 3, 9):
                for lag in (-4e-3, 0.0, 4e-3, 8e-3) if "lag" in self.names else (0.0,):
                    stiffness = self.largest / travel
                    values = self.begin | {
                        "stribeck_speed": np.log(np.clip(speed, *SPEEDS)),
                        "bristle_stiffness": np.log(stiffness),
                        "bristle_damping": np.log(1e-3 * stiffness),
                        "lag": lag,
                    }
                    rows.append([values[name] for name in self.names])
        table = np.array(rows)
        best, least_cost = table[0], np.inf
        for velocity in self.windows.options[[0, -1]]:
            self.windows = replace(self.windows, velocity=velocity)
            cost = np.sum(self.residuals(table) ** 2, axis=1)
            k = int(np.argmin(cost))
            if cost[k] < least_cost:
                best, least_cost = table[k], cost[k]
        return best

    def descend(self, x: Array) -> Array:
        """Least-squares solution within `limits`, searched from the values `x`."""
        low, high = self.limits()
        span = np.where(np.isfinite(high - low), high - low, self.sizes)
        return least_squares.solve(
            self.residuals_at,
            x,
            (low, high),
            slopes=self.slopes,
            sizes=self.sizes,
            room=1e-6 * span,
            cost_tolerance=1e-7,
            step_tolerance=1e-6,
            most=40,
        ).x

    def scatter(self, x: Array) -> float:
        """Standard deviation of the windows' residuals [N]."""
        judged = self.windows.judged.sum()
        square = np.sum(self.windows.misfit(self.values(x[None])) ** 2) / max(judged, 1.0)
        return max(float(np.sqrt(square)), MODEL * self.largest)

    def whitened(self, residuals: Array, slopes: Array) -> Array:
        """Derivatives J' with J'^T J' = cov^-1, where cov is the covariance of the parameters.

        An equivalent problem with independent residuals of unit variance has these derivatives. The
        covariance is cov = H^-1 J^T R J H^-1 with H = J^T J, the derivatives J (`slopes`) and the
        covariance R of the residuals r. Points are independent. Residuals k samples apart in the
        same window have the covariance c_k = sum r_t r_(t+k)/n, where the sum covers all n samples
        of all windows [SeberWild1989]. With J = U S V^T, the result is J' = L^-1 S V^T, where L L^T
        = U^T R U [derived].
        """
        from scipy.linalg import solve_triangular, toeplitz  # slow import, rarely used

        lanes, count = self.windows.judged.shape
        split = residuals.size - lanes * count
        left, singular, right = np.linalg.svd(slopes * self.sizes, full_matrices=False)
        window_residuals = residuals[split:].reshape(lanes, count)
        judged = max(float(self.windows.judged.sum()) - slopes.shape[1], 1.0)
        lags = [
            float(np.sum(window_residuals[:, : count - k] * window_residuals[:, k:])) / judged
            for k in range(count)
        ]
        lags[0] = max(lags[0], (MODEL * self.largest / self.spread) ** 2)
        steep = left[split:].reshape(lanes, count, -1)
        inner = left[:split].T @ left[:split]
        inner = inner + np.einsum("lip,ij,ljq->pq", steep, toeplitz(lags), steep, optimize=True)
        root = np.linalg.cholesky(inner)
        return solve_triangular(root, singular[:, None] * right, lower=True) / self.sizes

    def lane_errors(self, residuals: Array, slopes: Array) -> Array:
        """Standard errors of the parameters from differences between windows, called lanes.

        They are zero if there are too few windows. The windows are assumed to be
        independent; within a window, any correlation is allowed. The covariance is H^-1 sum (J_l^T
        r_l)(J_l^T r_l)^T H^-1 n/(n - 3) for n windows l [SeberWild1989], with H, J and r as in
        `whitened`. It includes the effect of the position sensor's steps, which shift a whole
        reversal.
        """
        lanes, count = self.windows.judged.shape
        split = residuals.size - lanes * count
        scaled = slopes * self.sizes
        inverse = np.linalg.pinv(scaled, rcond=RCOND)
        parts = np.einsum(
            "plc,lc->lp",
            inverse[:, split:].reshape(-1, lanes, count),
            residuals[split:].reshape(lanes, count),
        )
        used = self.used
        if used <= DETERMINED:
            return np.zeros(self.sizes.size)
        variance = np.sum(parts**2, axis=0) * used / (used - DETERMINED)
        variance += np.sum(inverse[:, :split] ** 2, axis=1)
        return np.sqrt(variance) * self.sizes

    @property
    def missed(self) -> str | None:
        """Reason why the windows are unusable; None if they are usable.

        They are unusable if the model deviates from them by clearly more than the noise.
        """
        if self.steady is None or self.spread <= NOISY * self.noise + MISSED * self.largest:
            return None
        return (
            f"at reversals, the model deviates from the measured friction by {self.spread:.3g} N, "
            f"but noise is only {self.noise:.2g} N: the rod moves too fast there for the filter "
            "to show F_S, v_s and σ₀"
        )

    def travel(self, x: Array) -> float:
        """Travel after which 95 % of the bristles' force is reached [m]."""
        values = self.values_at(x)
        level = min(max(values["static"], values["coulomb"]), self.largest)
        return BENDS * level / values["bristle_stiffness"]

    def changes(self, x: Array, chain: Array, misfit: Array) -> dict[str, float]:
        """By how much each parameter changes if the residuals of the windows become `misfit` [N].

        `x` are the searched values. `chain` has, for each of them, the derivative of the parameter
        by it: 1, or the parameter itself if its logarithm is searched. Changes are absolute values.
        """
        before = self.residuals_at(x)
        weighted = (misfit / self.spread).reshape(-1)
        change = np.zeros_like(before)
        change[-weighted.size :] = weighted - before[-weighted.size :]
        changes = np.linalg.lstsq(self.slopes(x) * self.sizes, -change, rcond=RCOND)[0]
        return dict(zip(self.names, np.abs(changes * self.sizes * chain), strict=True))

    def bounded(self, x: Array) -> dict[str, Parameter]:
        """Parameters with confidence intervals at the searched values `x`.

        The intervals cover the scatter of the residuals, differences between windows, and the
        resolution of the position sensor.
        """
        values = self.values_at(x)
        searched = {name: values[name] for name in self.names}
        chain = np.array([searched[name] if name in LOGARITHMIC else 1.0 for name in self.names])
        residuals = self.residuals_at(x)
        slopes = self.slopes(x)
        spare = residuals.size - int(np.sum(self.windows.judged == 0)) - len(searched)
        fitted = known(
            searched,
            self.whitened(residuals, slopes) / chain,
            np.ones(1) * np.sqrt(max(spare, 0)),
            np.maximum(np.abs(list(searched.values())), 1e-3 * self.sizes * chain),
            spare=spare,
        )
        error_by_lanes = self.lane_errors(residuals, slopes) * chain
        error = np.array([parameter.standard_error for parameter in fitted.parameters.values()])
        with np.errstate(invalid="ignore"):
            extra = np.sqrt(np.maximum(error_by_lanes**2 - error**2, 0.0))
        extra = np.where(np.isfinite(error), extra, 0.0)
        place = self.names.index("bristle_stiffness")
        shift = self.windows.grain * BENDS / self.travel(x) * searched["bristle_stiffness"]
        extra[place] = np.hypot(extra[place], shift)
        if "lag" in searched:
            place = self.names.index("lag")
            finite = error[place] if np.isfinite(error[place]) else 0.0
            student = quantile(self.used - 1) / fitted.quantile
            scatter = student * float(np.hypot(error[place], extra[place]))
            lag_error = self._lag_error(x, chain, scatter)
            extra[place] = np.sqrt(max(lag_error**2 - finite**2, 0.0))
        extras = dict(zip(searched, extra.tolist(), strict=True))
        parameters = widened(fitted.parameters, extras, fitted.quantile)
        if "lag" not in self.names and "bristle_damping" not in self.names:
            late = self.windows.misfit(self.values(x[None]) | {"lag": np.full(1, USUAL)})
            parameters = widened(parameters, self.changes(x, chain, late), fitted.quantile)
        return parameters

    @property
    def used(self) -> int:
        """Number of windows in use."""
        return int(np.sum(np.any(self.windows.judged > 0, axis=-1)))

    def _lag_error(self, x: Array, chain: Array, scatter: float) -> float:
        """Standard error of the lag [s], from scatter, position, velocity and sampling.

        The resolution of the position sensor shifts all reversals alike, its white noise shifts
        each reversal separately. A velocity that is filtered at a lower cut-off than the pressures
        starts too early, which looks like a lag; a fit with the velocity at the record's cut-off
        shows how much. Sampling adds dt/sqrt 12 with the time step dt, because a reversal can lie
        anywhere between two samples.
        """
        values, windows = self.values(x[None]), self.windows
        distance = float(np.hypot(windows.grain, windows.noise / np.sqrt(max(self.used, 1))))
        shift = self.changes(x, chain, windows.short(distance).misfit(values))["lag"]
        position_error = LATE * float(np.hypot(scatter, shift))
        return float(
            np.hypot(np.hypot(position_error, self._early(x)), windows.sample_time / np.sqrt(12))
        )

    def _early(self, x: Array) -> float:
        """Absolute change of the fitted lag [s] if all velocities have the record's cut-off."""
        windows = self.windows
        if np.array_equal(windows.velocity, windows.options[0]):
            return 0.0
        self.windows = replace(windows, velocity=windows.options[0])
        place = self.names.index("lag")
        change = abs(float(self.descend(x)[place] - x[place]))
        self.windows = windows
        return change

    def solve(self) -> LuGreFit:
        """Fit the model: search, weight the windows by their scatter, and search again.

        The fit includes confidence intervals and reasons to doubt the result.
        """
        x = self.start()
        for _ in range(ROUNDS):
            self.windows = self.windows.chosen(self.values(x[None]))
            self.windows = self.windows.resolved(self.travel(x))
            self.spread = self.scatter(x)
            x = self.descend(x)
        parameters = self.bounded(x)
        fastest = self.windows.fastest
        if self.steady is not None:
            fastest = max(fastest, float(np.max(np.abs(self.steady.velocity))))
        missed = self.missed
        if missed is not None:
            confirmed = agreed(parameters, self.references)
            parameters = unbounded(parameters, set(parameters) - set(confirmed))
        if self.windows.quick:
            parameters = unbounded(parameters, ("bristle_stiffness", "bristle_damping", "lag"))
        inseparable = hidden(parameters, fastest, falls=False)
        if inseparable is not None:
            parameters = unbounded(parameters, INSEPARABLE)
        doubts = [
            f"{SYMBOLS[name]} is {parameter.verdict}"
            for name, parameter in parameters.items()
            if name in LOGARITHMIC[:2] and not parameter.identifiable
        ]
        if self.windows.quick:
            doubts.append(
                "the rod starts too fast for the filter to show pre-sliding: reverse it slowly"
            )
        doubts += [doubt for doubt in (inseparable, missed) if doubt is not None]
        lanes = self.windows.velocity.shape[0]
        return LuGreFit(parameters, self.held, lanes, self.spread, tuple(doubts))


BLUR = 40e-3
"""A lag is fitted only if the resolution of the position hides reversals for no longer than this
time [s] (our choice: ten usual lags)."""
SURER = 10.0
"""A friction level that falls with speed is preferred to a constant one if it lowers the Akaike
information criterion by more than this (our choice: very strong evidence)."""
SLID = 0.95
"""The friction level of sliding is identifiable only if the measured friction reaches this share of
it (our choice)."""
FAR = 3.0
"""Multiple of the Stribeck speed that the rod must reach for F_C to be identifiable (our choice: at
this speed, friction exceeds F_C by at most 5 % of F_S - F_C, for exponent 1)."""


def settling_distance(lugre: LuGreFit | str) -> float:
    """Distance after a reversal beyond which sliding is steady [m].

    It follows from the bristles' breakaway travel, if that is known.
    """
    if isinstance(lugre, str) or not lugre.parameters["bristle_stiffness"].identifiable:
        return SETTLED
    level = max(lugre.values.get("static", 0.0), lugre.values["coulomb"])
    return max(SETTLED, SETTLING * level / lugre.values["bristle_stiffness"])


def fit_lugre(
    slidings: Sequence[Sliding],
    motion: ConditionedRecord,
    points: Sequence[FrictionPoint],
    stribeck: StribeckFit | str,
    *,
    lag_known: bool,
    settling: float = SETTLED,
) -> LuGreFit | str:
    """Fit a LuGre model to a record; return the reason if it is not possible.

    Least squares over points of steady sliding and windows around reversals, each weighted by its
    scatter [AaltoThesis] eq. 27-31. Without a Stribeck curve, as in pre-sliding, Coulomb friction
    F_C and the bristles are fitted to the windows alone. While the contact sticks, the bristle
    force is sigma_0 z + sigma_1 dz/dt, with deflection z, stiffness sigma_0 and damping sigma_1. It
    is nearly equal to the value of sigma_0 z at a time sigma_1/sigma_0 later, as if the pressures
    were early. Therefore either the lag or sigma_1 is fitted, not both.

    Parameters
    ----------
    slidings, motion : friction along the record, and the conditioned record with its filter
    points : points of steady sliding
    stribeck : the curve through the points, where the search starts; or the reason why it is
        missing
    lag_known : whether to fit sigma_1; if not, the lag of the pressures is fitted and sigma_1 is 0
    settling : distance after a reversal beyond which sliding is steady [m]

    Returns
    -------
    the fit, or the reason why it is missing
    """
    curve = stribeck if isinstance(stribeck, StribeckFit) else None
    reference = 0.0 if curve is None else curve.reference_pressure
    slowest = np.inf if curve is None else min(point.speed for point in points)
    reversals = windows(slidings, motion, reference, slowest, settling)
    if reversals is None:
        return no_windows(motion)
    hidden_lag = not lag_known and reversals.blur >= BLUR
    fixed = {"lag": 0.0} if lag_known else {"bristle_damping": 0.0}
    if hidden_lag:
        fixed["lag"] = 0.0
    if curve is None:
        fit = _from_windows(reversals, fixed)
    else:
        fit = LugreProblem(reversals, points, curve, fixed).solve()
        if "stribeck_speed" in fit.parameters and not np.isfinite(fit.parameters["coulomb"].upper):
            fit = _unseparated(fit, points, curve, reversals, fixed)
        fit = _consistent_with_points(fit, curve, points)
    if not hidden_lag:
        return fit
    doubt = (
        f"the position resolution hides reversals for {1e3 * reversals.blur:.0f} ms, so no lag "
        "of the pressures is fitted; the confidence intervals allow for a lag of "
        f"{1e3 * USUAL:.0f} ms; move faster or state --pressure-lag"
    )
    return replace(fit, doubts=(*fit.doubts, doubt))


def _from_windows(reversals: Windows, fixed: Mapping[str, float]) -> LuGreFit:
    """Fit the windows alone, with sliding friction that is constant or falls from F_S to F_C."""
    fit = LugreProblem(reversals, (), None, fixed).solve()
    slides = fit.misfit + reversals.largest > SLID * fit.values["coulomb"]
    if slides:
        falling = _falling(reversals, {"exponent": EXPONENT, **fixed})
        count = 2 * float(reversals.judged.sum())
        gain = count * np.log(fit.misfit / falling.misfit)
        extra = 2 * (len(falling.parameters) - len(fit.parameters))
        if gain > extra + SURER:
            fit = _falling(reversals, fixed)
            if not fit.parameters["exponent"].identifiable:
                fit = _any_exponent(falling, reversals, fixed)
    fastest = 1e3 * reversals.fastest
    if "static" in fit.parameters:
        if reversals.fastest < FAR * fit.values["stribeck_speed"]:
            fit = replace(fit, parameters=unbounded(fit.parameters, INSEPARABLE))
        doubt = (
            f"F_C is the total friction level at {fastest:.3g} mm/s and includes viscous friction, "
            "which a single speed cannot separate; record plateaus or sweeps at other speeds"
        )
    elif slides:
        doubt = (
            f"F_C is the friction level up to {fastest:.3g} mm/s, which lies between the true F_C "
            "and F_S; record plateaus or sweeps at other speeds"
        )
    else:
        doubt = (
            "the rod hardly slides, so the record shows the deflection of the bristles, but no "
            "sliding friction"
        )
        fit = replace(fit, parameters=unbounded(fit.parameters, ("coulomb",)))
    return replace(fit, doubts=(*fit.doubts, doubt))


def _falling(reversals: Windows, fixed: Mapping[str, float]) -> LuGreFit:
    """Fit the windows alone, with a friction level that falls from F_S to F_C."""
    return LugreProblem(reversals, (), None, fixed, falling=True).solve()


def _any_exponent(fit: LuGreFit, reversals: Windows, fixed: Mapping[str, float]) -> LuGreFit:
    """The fit with exponent `EXPONENT`, with intervals that also allow for exponent `OTHER`.

    A second fit has the exponent `OTHER`. Each parameter keeps its value, but gets the larger
    uncertainty of the two fits, increased by an uncertainty for the difference of their values.
    """
    other = _falling(reversals, {"exponent": OTHER, **fixed})
    errors = held_error(fit.parameters, other.values)
    for name, extra in errors.items():
        variances = [candidate.parameters[name].standard_error ** 2 for candidate in (fit, other)]
        if np.isfinite(variances).all():
            errors[name] = float(np.sqrt(extra**2 + max(variances[1] - variances[0], 0.0)))
    doubt = (
        f"the Stribeck exponent is fixed at {EXPONENT:g}; the confidence intervals allow for "
        f"{OTHER:g} as well"
    )
    parameters = widened(fit.parameters, errors, NORMAL)
    return replace(fit, parameters=parameters, doubts=(*fit.doubts, doubt))


def _consistent_with_points(
    fit: LuGreFit, stribeck: StribeckFit, points: Sequence[FrictionPoint]
) -> LuGreFit:
    """Remove the limits of a fitted parameter that contradicts the points of steady sliding."""
    level, speed = stribeck.parameters["coulomb"], fit.parameters.get("stribeck_speed")
    doubts = list(fit.doubts)
    parameters = dict(fit.parameters)
    if stribeck.doubted:
        confirmed = agreed(parameters, stribeck.parameters)
        parameters = unbounded(parameters, set(parameters) - set(confirmed))
        doubts.append("the points of steady sliding show that areas or sensors are wrong")
    elif not np.isfinite(level.upper) and not (speed is not None and speed.identifiable):
        if np.isfinite(parameters["coulomb"].upper):
            fastest = 1e3 * max(point.speed for point in points)
            doubts.append(
                f"F_C is the friction level up to {fastest:.3g} mm/s; steady sliding at these "
                "speeds does not separate it from F_S and σ₂; give more and faster speeds"
            )
        parameters = unbounded(parameters, INSEPARABLE)
    return replace(fit, parameters=parameters, doubts=tuple(doubts))


def _unseparated(
    fit: LuGreFit,
    points: Sequence[FrictionPoint],
    stribeck: StribeckFit,
    reversals: Windows,
    fixed: Mapping[str, float],
) -> LuGreFit:
    """Widen the intervals of F_S and sigma_0 of a model whose F_C and sigma_2 are inseparable.

    The intervals of static friction F_S and bristle stiffness sigma_0 then also cover the values of
    a fit without viscous friction (sigma_2 = 0).
    """
    held = {"viscous": 0.0, "exponent": EXPONENT, **fixed}
    other = LugreProblem(reversals, points, stribeck, held).solve()
    errors = {
        name: abs(other.values[name] - fit.values[name])
        for name in ("static", "bristle_stiffness")
        if name in fit.parameters
    }
    return replace(fit, parameters=widened(fit.parameters, errors, NORMAL))
