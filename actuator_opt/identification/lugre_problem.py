"""Least squares for LuGre parameters: residuals of points and windows, search, bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base import fitting as least_squares
from ..base.fitting import Parameter, known, quantile
from ..base.numeric import Array
from .doubtful import PARTED, agreed, hidden, opened, widened
from .lugre_windows import LAG, Windows
from .points import Point
from .stribeck_fit import EXPONENT, EXPONENTS, SHARED, SPEEDS, Steady, StribeckFit

TRAVELS = (1e-6, 3e-3)
"""Bristle travels F_S/sigma_0 searched [m] (a choice: nearly two decades about 50 um)."""
DAMPING_TIMES = (1e-6, 0.3)
"""sigma_1/sigma_0 searched [s] (a choice: from none to the length of a window)."""
USUAL = 5e-3
"""Usual standard deviation of the pressure lag [s] (a choice: sensors and lines of a test bench, up
to 10 ms): included in bounds if a record does not show the lag."""
STEP = 1e-4
"""Relative step of central differences (a choice: error 1e-8)."""
SYMBOLS = {"bristle_stiffness": "σ₀", "bristle_damping": "σ₁", "lag": "τ"}
"""Parameters in addition to those of the Stribeck curve: N/m, N s/m, s."""
MODEL = 1e-3
"""Least scatter of the windows relative to the largest friction (a choice, as of the points): below
it the filtered motion limits the model, not noise."""
BENDS = 3.0
"""Breakaway travels that give 95 % of the force, 1 - e^-3: the record must resolve them in time."""
LATE = 1.5
"""Multiple of its standard error by which a lag is uncertain (a choice, from records of known
friction: with 25 kPa of noise and steps of 10 um z of the fitted lag scatters by 1.3 to 1.9); the
sampling adds dt/sqrt 12, as a reversal falls anywhere within a sample."""
NOISY, MISSED = 2.0, 0.02
"""Allowed misfit in the windows, as a multiple of noise and a share of the largest friction (a
choice, from records of known friction: position steps cost up to 3 times the noise)."""
TOLD = 3
"""Parameters determined by the windows: stiffness, lag or damping, level."""
RCOND = 1e-6
"""Least ratio of singular values by which a lag affects parameters (a choice: far above
rounding)."""
ROUNDS = 2
"""Searches, each with windows weighted by their scatter in the last (a choice: the second changes
the weights by a few per cent)."""
LOGARITHMIC = ("bristle_stiffness", "bristle_damping", "stribeck_speed")
"""Parameters searched by logarithm."""


@dataclass(frozen=True, slots=True, eq=False)
class LuGreFit:
    """A LuGre model, SI.

    Parameters
    ----------
    parameters : fitted, by name: those of the Stribeck curve, `bristle_stiffness`,
        `bristle_damping` and the pressures' `lag`
    held : fixed values
    count : number of windows
    misfit : standard deviation of the friction about the model in the windows [N]
    doubts : unknown parameters and other caveats
    """

    parameters: Mapping[str, Parameter]
    held: Mapping[str, float]
    count: int
    misfit: float
    doubts: tuple[str, ...]

    @property
    def values(self) -> dict[str, float]:
        """All parameters, fitted or fixed."""
        return {**self.held, **{name: one.value for name, one in self.parameters.items()}}


def sizes(names: Sequence[str], largest: float, steady: Steady | None) -> Array:
    """Size of each searched parameter: 1 of a logarithm."""
    speed, change = 1e-3, 1e5
    if steady is not None:
        speed = max(speed, float(np.max(np.abs(steady.velocity))))
        change = max(change, float(np.max(np.abs(steady.change))))
    size = dict.fromkeys(("coulomb", "static", "offset"), largest)
    size |= {"viscous": largest / speed, "pressure_slope": largest / change, "lag": 1e-2}
    return np.array([size.get(name, 1.0) for name in names])


class LugreProblem:
    """Residuals of points and windows over the searched parameters."""

    def __init__(
        self,
        found: Windows,
        points: Sequence[Point],
        stribeck: StribeckFit | None,
        lag_known: bool,
        lag_seen: bool,
        falling: bool = False,
        held: Mapping[str, float] | None = None,
    ) -> None:
        self.windows, self.lag_known = found, lag_known
        self.steady = None
        self.largest = found.largest
        self.spread = 1.0
        if stribeck is None:
            self.begin = {"coulomb": self.largest, "offset": 0.0}
            self.held = {"viscous": 0.0, "exponent": EXPONENT, "pressure_slope": 0.0}
            self.held["stribeck_speed"] = SPEEDS[0]
            if falling:
                del self.held["stribeck_speed"], self.held["exponent"]
                self.begin |= {
                    "exponent": EXPONENT,
                    "coulomb": self.largest / 2,
                    "static": self.largest,
                    "stribeck_speed": float(np.sqrt(SPEEDS[0] * SPEEDS[1])),
                }
        else:
            apart = found.step * float(found.kept[1] - found.kept[0])
            noise = [one.error * np.sqrt(max(one.weight / apart, 1.0)) for one in points]
            self.noise = float(np.median(noise))
            least = SHARED if any(one.kind == "sweep" for one in points) else 1e-3
            self.steady = Steady(points, stribeck.errors * max(stribeck.scatter, least))
            self.begin = {name: one.value for name, one in stribeck.parameters.items()}
            self.held = dict(stribeck.held)
            self.told = stribeck.parameters
            self._ask_for_static(stribeck)
        for name, value in (held or {}).items():
            self.begin.pop(name, None)
            self.held[name] = value
        if lag_known:
            self.held["lag"] = 0.0
        else:
            self.held["bristle_damping"] = 0.0
            if not lag_seen:
                self.held["lag"] = 0.0
        self.names = (*self.begin, *(name for name in SYMBOLS if name not in self.held))
        self.sizes = sizes(self.names, self.largest, self.steady)

    def _ask_for_static(self, stribeck: StribeckFit) -> None:
        """Start F_S and v_s from the windows if the points do not give them."""
        seen = stribeck.parameters.get("static")
        if self.held.pop("exponent", None) is not None:
            self.begin["exponent"] = EXPONENT
        self.static_known = seen is not None and seen.identifiable
        if not self.static_known:
            for name in ("static", "stribeck_speed"):
                self.held.pop(name, None)
            self.begin |= {
                "exponent": EXPONENT,
                "static": max(self.largest, 1.01 * self.begin["coulomb"]),
                "stribeck_speed": float(np.sqrt(SPEEDS[0] * SPEEDS[1])),
            }

    def values(self, rows: Array) -> dict[str, Array]:
        """Parameters (rows,) of rows of searched ones (rows, searched)."""
        own = {}
        for name, column in zip(self.names, rows.T, strict=True):
            own[name] = np.exp(column) if name in LOGARITHMIC else column
        held = {name: np.full(rows.shape[0], value) for name, value in self.held.items()}
        if "static" not in own:
            held["static"] = own["coulomb"]
        return held | own

    def residuals(self, rows: Array) -> Array:
        """Weighted residuals of rows of searched parameters (rows, residuals)."""
        values = self.values(rows)
        lanes = (self.windows.misfit(values) / self.spread).reshape(len(rows), -1)
        if self.steady is None:
            return lanes
        steady = {n: v[:, None] for n, v in values.items() if n not in SYMBOLS}
        return np.concatenate([self.steady.residual(steady), lanes], axis=1)

    def one(self, x: Array) -> Array:
        """Weighted residuals of one row."""
        return self.residuals(x[None])[0]

    def slopes(self, x: Array) -> Array:
        """Derivatives of the residuals by central differences, all at once."""
        steps = STEP * np.diag(self.sizes)
        found = self.residuals(np.concatenate([x + steps, x - steps]))
        return ((found[: x.size] - found[x.size :]) / (2 * STEP * self.sizes[:, None])).T

    def limits(self) -> tuple[Array, Array]:
        """Limits of the search."""
        stiffest, softest = (self.largest / one for one in TRAVELS)
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
        return np.array([one[0] for one in pairs]), np.array([one[1] for one in pairs])

    def start(self) -> Array:
        """The best of a grid of bristle stiffnesses and lags (and Stribeck speeds)."""
        speeds = [self.begin.get("stribeck_speed", SPEEDS[0])]
        if "static" in self.begin and "stribeck_speed" not in self.held:
            speeds = [0.3 * speeds[0], speeds[0], 3 * speeds[0]]
        rows = []
        for speed in speeds:
            for travel in np.geomspace(3 * TRAVELS[0], TRAVELS[1] / 3, 9):
                for lag in (-4e-3, 0.0, 4e-3, 8e-3) if "lag" in self.names else (0.0,):
                    stiffness = self.largest / travel
                    own = self.begin | {
                        "stribeck_speed": np.log(np.clip(speed, *SPEEDS)),
                        "bristle_stiffness": np.log(stiffness),
                        "bristle_damping": np.log(1e-3 * stiffness),
                        "lag": lag,
                    }
                    rows.append([own[name] for name in self.names])
        table = np.array(rows)
        best, least = table[0], np.inf
        for one in self.windows.options[[0, -1]]:
            self.windows = replace(self.windows, velocity=one)
            cost = np.sum(self.residuals(table) ** 2, axis=1)
            k = int(np.argmin(cost))
            if cost[k] < least:
                best, least = table[k], cost[k]
        return best

    def descend(self, x: Array) -> Array:
        """Least squares within the limits."""
        low, high = self.limits()
        span = np.where(np.isfinite(high - low), high - low, self.sizes)
        return least_squares.solve(
            self.one,
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
        """Slopes J' of equally informative independent unit residuals: J'^T J' = cov^-1.

        cov = H^-1 J^T R J H^-1, H = J^T J, R the residuals' covariance: points are independent,
        lanes share one autocovariance c_k = sum r_t r_(t+k)/n [SeberWild1989]. With J = U S V^T,
        J' = L^-1 S V^T, L L^T = U^T R U [derived].
        """
        from scipy.linalg import solve_triangular, toeplitz  # slow import, rarely used

        lanes, count = self.windows.judged.shape
        split = residuals.size - lanes * count
        left, singular, right = np.linalg.svd(slopes * self.sizes, full_matrices=False)
        own = residuals[split:].reshape(lanes, count)
        judged = max(float(self.windows.judged.sum()) - slopes.shape[1], 1.0)
        lags = [float(np.sum(own[:, : count - k] * own[:, k:])) / judged for k in range(count)]
        lags[0] = max(lags[0], (MODEL * self.largest / self.spread) ** 2)
        steep = left[split:].reshape(lanes, count, -1)
        inner = left[:split].T @ left[:split]
        inner = inner + np.einsum("lip,ij,ljq->pq", steep, toeplitz(lags), steep, optimize=True)
        root = np.linalg.cholesky(inner)
        return solve_triangular(root, singular[:, None] * right, lower=True) / self.sizes

    def lanes(self, residuals: Array, slopes: Array) -> Array:
        """Standard errors from independent lanes, whatever the correlation within them.

        cov = H^-1 sum (J_l^T r_l)(J_l^T r_l)^T H^-1 n/(n - 3) of n lanes [SeberWild1989]: steps of
        the position sensor shift a whole reversal. Zeros for too few lanes.
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
        if used <= TOLD:
            return np.zeros(self.sizes.size)
        variance = np.sum(parts**2, axis=0) * used / (used - TOLD)
        variance += np.sum(inverse[:, :split] ** 2, axis=1)
        return np.sqrt(variance) * self.sizes

    @property
    def missed(self) -> str | None:
        """Why the windows are unusable, if the model misses them by more than their noise."""
        if self.steady is None or self.spread <= NOISY * self.noise + MISSED * self.largest:
            return None
        return (
            f"the model misses friction at reversals by {self.spread:.3g} N, but noise is "
            f"{self.noise:.2g} N: the rod moves too fast there for the filter to show F_S, v_s "
            "and σ₀"
        )

    def travel(self, x: Array) -> float:
        """Deflection distance of the bristles [m]."""
        found = {name: float(one[0]) for name, one in self.values(x[None]).items()}
        level = min(max(found["static"], found["coulomb"]), self.largest)
        return BENDS * level / found["bristle_stiffness"]

    def moved(self, x: Array, chain: Array, misfit: Array) -> dict[str, float]:
        """Change of parameters for a misfit of the windows [N]."""
        before = self.one(x)
        lanes = (misfit / self.spread).reshape(-1)
        change = np.zeros_like(before)
        change[-lanes.size :] = lanes - before[-lanes.size :]
        moved = np.linalg.lstsq(self.slopes(x) * self.sizes, -change, rcond=RCOND)[0]
        return dict(zip(self.names, np.abs(moved * self.sizes * chain), strict=True))

    def bounded(self, x: Array) -> dict[str, Parameter]:
        """Parameters with bounds from residuals, lanes and position resolution."""
        found = {name: float(one[0]) for name, one in self.values(x[None]).items()}
        own = {name: found[name] for name in self.names}
        chain = np.array([own[name] if name in LOGARITHMIC else 1.0 for name in self.names])
        least = 1e-3 * self.sizes * chain
        residuals = self.one(x)
        steep = self.slopes(x)
        slopes = self.whitened(residuals, steep) / chain
        spare = residuals.size - int(np.sum(self.windows.judged == 0)) - len(own)
        told = known(
            own,
            slopes,
            np.ones(1) * np.sqrt(max(spare, 0)),
            np.maximum(np.abs(list(own.values())), least),
            spare=spare,
        )
        by_lanes = self.lanes(residuals, steep) * chain
        own_error = np.array([one.standard_error for one in told.parameters.values()])
        with np.errstate(invalid="ignore"):
            more = np.sqrt(np.maximum(by_lanes**2 - own_error**2, 0.0))
        more = np.where(np.isfinite(own_error), more, 0.0)
        place = list(own).index("bristle_stiffness")
        shift = self.windows.grain * BENDS / self.travel(x) * own["bristle_stiffness"]
        more[place] = np.hypot(more[place], shift)
        if "lag" in own:
            place = list(own).index("lag")
            known_error = own_error[place] if np.isfinite(own_error[place]) else 0.0
            few = quantile(self.used - 1) / told.quantile
            scatter = few * float(np.hypot(own_error[place], more[place]))
            whole = self._lag_error(x, chain, scatter)
            more[place] = np.sqrt(max(whole**2 - known_error**2, 0.0))
        parameters = widened(
            told.parameters, dict(zip(own, more.tolist(), strict=True)), told.quantile
        )
        if "lag" not in self.names and not self.lag_known:
            late = self.windows.misfit(self.values(x[None]) | {"lag": np.full(1, USUAL)})
            parameters = widened(parameters, self.moved(x, chain, late), told.quantile)
        return parameters

    @property
    def used(self) -> int:
        """Number of windows in use."""
        return int(np.sum(np.any(self.windows.judged > 0, axis=-1)))

    def _lag_error(self, x: Array, chain: Array, scatter: float) -> float:
        """Standard error of the lag from scatter, position, velocity and sampling [s].

        Resolution of the position sensor shifts all reversals alike, its white noise each reversal
        separately. A velocity with a lower cut-off than the pressures' starts early, which looks
        like a lag; the velocity at the record's own cut-off shows the difference.
        """
        values, windows = self.values(x[None]), self.windows
        distance = float(np.hypot(windows.grain, windows.noise / np.sqrt(max(self.used, 1))))
        short = self.moved(x, chain, windows.short(distance).misfit(values))["lag"]
        whole = LATE * float(np.hypot(scatter, short))
        return float(np.hypot(np.hypot(whole, self._early(x)), windows.sample_time / np.sqrt(12)))

    def _early(self, x: Array) -> float:
        """Change of the lag with the velocity at the record's own cut-off [s]."""
        windows = self.windows
        if np.array_equal(windows.velocity, windows.options[0]):
            return 0.0
        self.windows = replace(windows, velocity=windows.options[0])
        place = self.names.index("lag")
        apart = abs(float(self.descend(x)[place] - x[place]))
        self.windows = windows
        return apart

    def solve(self) -> LuGreFit:
        """Search, weight the windows by their scatter, search again, and compute bounds."""
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
            told = agreed(parameters, self.told)
            parameters = opened(parameters, (name for name in parameters if name not in told))
        if self.windows.quick:
            parameters = opened(parameters, ("bristle_stiffness", "bristle_damping", "lag"))
        why = hidden(parameters, fastest, falls=False)
        if why is not None:
            parameters = opened(parameters, PARTED)
        doubts = [
            f"{SYMBOLS[name]} is {one.verdict}"
            for name, one in parameters.items()
            if name in LOGARITHMIC[:2] and not one.identifiable
        ]
        if self.windows.quick:
            doubts.append(
                "the rod starts too fast for the filter to show bristles: reverse it slowly"
            )
        doubts += [one for one in (why, missed) if one is not None]
        lanes = self.windows.velocity.shape[0]
        return LuGreFit(parameters, self.held, lanes, self.spread, tuple(doubts))
