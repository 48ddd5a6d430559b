"""LuGre bristles from reversals: integrated along the record, filtered as the record is.

Stiffness and damping of the bristles, and the time by which the pressures come late, are fitted to
windows about the reversals, together with what the steady points say of the Stribeck curve.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..least_squares import Parameter, known
from ..numeric import Array
from .balance import Sliding
from .conditioning import Motion
from .lugre_windows import LAG, Windows, windows
from .points import SETTLED, SETTLING, Point
from .stribeck_fit import EXPONENT, EXPONENTS, SPEEDS, Steady, StribeckFit

TRAVELS = (1e-6, 3e-3)
"""Travel F_S/sigma_0 of the bristles searched [m]."""
DAMPING_TIMES = (1e-6, 0.3)
"""sigma_1/sigma_0 searched [s]."""
USUAL = 5e-3
"""Lag that pressures commonly have [s], standard deviation of what is expected of it before the
record is looked at (a choice: sensors and lines of a bench, 0 to 10 ms)."""
BLUR = 40e-3
"""Time by which a turn may be hidden for a lag to be looked for [s]: ten times a usual lag."""
STEP = 1e-4
"""Step of the central differences over the size of a parameter."""
SYMBOLS = {"bristle_stiffness": "σ₀", "bristle_damping": "σ₁", "lag": "τ"}
"""Parameters beside those of the Stribeck curve: N/m, N s/m, s."""
MODEL = 1e-3
"""Least scatter of the windows over the largest friction (a choice, as of the points): below it the
filtered motion limits the model, not noise."""
ROUNDS = 3
"""Searches, each with the windows weighed by their scatter about the last (a choice: the second
changes the weights by a few percent)."""
LOGARITHMIC = ("bristle_stiffness", "bristle_damping", "stribeck_speed")
"""Parameters searched by their logarithm."""


@dataclass(frozen=True, slots=True, eq=False)
class LuGreFit:
    """A LuGre model, SI.

    Parameters
    ----------
    parameters : fitted, by name: those of the Stribeck curve, `bristle_stiffness`,
        `bristle_damping` and the pressures' `lag`
    held : values not asked for
    count : windows looked at
    misfit : standard deviation of the friction about the model in the windows [N]
    doubts : what is not known
    """

    parameters: Mapping[str, Parameter]
    held: Mapping[str, float]
    count: int
    misfit: float
    doubts: tuple[str, ...]

    @property
    def values(self) -> dict[str, float]:
        """All parameters, fitted or held."""
        return {**self.held, **{name: one.value for name, one in self.parameters.items()}}


def settling_distance(lugre: LuGreFit | str) -> float:
    """Distance after a reversal from which sliding is steady [m], by bristles that are known."""
    if isinstance(lugre, str) or not lugre.parameters["bristle_stiffness"].identifiable:
        return SETTLED
    level = max(lugre.values.get("static", 0.0), lugre.values["coulomb"])
    return max(SETTLED, SETTLING * level / lugre.values["bristle_stiffness"])


def fit_lugre(
    slidings: Sequence[Sliding],
    motion: Motion,
    points: Sequence[Point],
    stribeck: StribeckFit | str,
    *,
    lag_known: bool,
    settling: float = SETTLED,
) -> LuGreFit | str:
    """The LuGre model of a record, or why there is none.

    Least squares over points of steady sliding and windows about reversals, each weighted by its
    own scatter [AaltoThesis] eq. 27-31. Without a Stribeck curve, as in pre-sliding, the windows
    alone give F_C and the bristles. In stuck contact sigma_0 z + sigma_1 dz/dt is sigma_0 z a time
    sigma_1/sigma_0 earlier, as if the pressures came that much sooner: one of the two is asked for.

    Parameters
    ----------
    slidings, motion : friction along the record, and how it was filtered
    points : of steady sliding
    stribeck : the curve through them, where the search begins
    lag_known : whether to ask for sigma_1; else for the lag of the pressures, sigma_1 held at 0
    settling : distance after a reversal from which sliding is steady [m]

    Returns
    -------
    the fit, or one line that says what is missing
    """
    curve_known = stribeck if isinstance(stribeck, StribeckFit) else None
    reference = 0.0 if curve_known is None else curve_known.reference_pressure
    slowest = np.inf if curve_known is None else min(one.speed for one in points)
    found = windows(slidings, motion, reference, slowest, settling)
    if found is None:
        return "no half second of an unbroken record about a reversal: bristles show only there"
    if lag_known or found.blur < BLUR:
        return _Problem(found, points, curve_known, lag_known).solve()
    fit = _Problem(found, points, curve_known, lag_known=True).solve()
    doubt = (
        f"steps of the position sensor hide the turns for {1e3 * found.blur:.0f} ms: no lag of the "
        "pressures is looked for; move faster or state --pressure-lag"
    )
    return replace(fit, doubts=(*fit.doubts, doubt))


class _Problem:
    """Residuals of points and windows over the searched parameters."""

    def __init__(
        self,
        found: Windows,
        points: Sequence[Point],
        stribeck: StribeckFit | None,
        lag_known: bool,
    ) -> None:
        self.windows = found
        self.steady = None
        self.largest = float(np.max(np.abs(found.measured(np.zeros(1))[..., found.kept])))
        self.spread = 1.0
        if stribeck is None:
            self.begin = {"coulomb": self.largest, "offset": 0.0}
            self.held = {"viscous": 0.0, "exponent": EXPONENT, "pressure_slope": 0.0}
            self.held["stribeck_speed"] = SPEEDS[0]
        else:
            self.steady = Steady(points, stribeck.errors * stribeck.scatter)
            self.begin = {name: one.value for name, one in stribeck.parameters.items()}
            self.held = dict(stribeck.held)
            self._ask_for_static(stribeck)
        self.held["lag" if lag_known else "bristle_damping"] = 0.0
        self.names = (*self.begin, *(name for name in SYMBOLS if name not in self.held))
        self.sizes = self._sizes()

    def _ask_for_static(self, stribeck: StribeckFit) -> None:
        """F_S and v_s begin at what the windows show, where the points do not know them."""
        seen = stribeck.parameters.get("static")
        if seen is None or not seen.identifiable:
            for name in ("static", "stribeck_speed", "exponent"):
                self.held.pop(name, None)
            self.begin |= {
                "exponent": EXPONENT,
                "static": max(self.largest, 1.01 * self.begin["coulomb"]),
                "stribeck_speed": float(np.sqrt(SPEEDS[0] * SPEEDS[1])),
            }

    def _sizes(self) -> Array:
        """Size of each searched parameter: 1 of a logarithm."""
        speed, change = 1e-3, 1e5
        if self.steady is not None:
            speed = max(speed, float(np.max(np.abs(self.steady.velocity))))
            change = max(change, float(np.max(np.abs(self.steady.change))))
        size = {
            "coulomb": self.largest,
            "static": self.largest,
            "viscous": self.largest / speed,
            "offset": self.largest,
            "pressure_slope": self.largest / change,
            "lag": 1e-2,
        }
        return np.array([size.get(name, 1.0) for name in self.names])

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
        if "lag" in self.names:
            lanes = np.concatenate([values["lag"][:, None] / USUAL, lanes], axis=1)
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
        """Ends of the search."""
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
        from scipy.optimize import least_squares  # slow to import, rarely needed

        low, high = self.limits()
        span = np.where(np.isfinite(high - low), high - low, self.sizes)
        found = least_squares(
            self.one,
            np.clip(x, low + 1e-6 * span, high - 1e-6 * span),
            jac=self.slopes,
            bounds=(low, high),
            x_scale=self.sizes,
            ftol=1e-7,
            xtol=1e-6,
            max_nfev=40,
        )
        return found.x

    def scatter(self, x: Array) -> float:
        """Standard deviation of the windows' residuals [N]."""
        judged = self.windows.judged.sum()
        square = np.sum(self.windows.misfit(self.values(x[None])) ** 2) / max(judged, 1.0)
        return max(float(np.sqrt(square)), MODEL * self.largest)

    def whitened(self, residuals: Array, slopes: Array) -> Array:
        """Slopes J' of as many independent unit residuals that know as much: J'^T J' = cov^-1.

        cov = H^-1 J^T R J H^-1, H = J^T J, R the residuals' covariance: points are independent,
        lanes share one autocovariance c_k = sum r_t r_(t+k)/n [SeberWild1989]. With J = U S V^T,
        J' = L^-1 S V^T, L L^T = U^T R U [derived].
        """
        from scipy.linalg import solve_triangular, toeplitz  # slow to import, rarely needed

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

    def solve(self) -> LuGreFit:
        """Search, weigh the windows by their own scatter, search again, and bound."""
        x = self.start()
        for _ in range(ROUNDS):
            self.windows = self.windows.chosen(self.values(x[None]))
            self.spread = self.scatter(x)
            x = self.descend(x)
        found = {name: float(one[0]) for name, one in self.values(x[None]).items()}
        own = {name: found[name] for name in self.names}
        chain = np.array([own[name] if name in LOGARITHMIC else 1.0 for name in self.names])
        least = 1e-3 * self.sizes * chain
        residuals = self.one(x)
        slopes = self.whitened(residuals, self.slopes(x)) / chain
        spare = residuals.size - int(np.sum(self.windows.judged == 0)) - len(own)
        told = known(
            own,
            slopes,
            np.ones(1) * np.sqrt(max(spare, 0)),
            np.maximum(np.abs(list(own.values())), least),
            spare=spare,
        )
        doubts = [
            f"{SYMBOLS[name]} is {one.verdict}"
            for name, one in told.parameters.items()
            if name in LOGARITHMIC[:2] and not one.identifiable
        ]
        lanes = self.windows.velocity.shape[0]
        return LuGreFit(told.parameters, self.held, lanes, self.spread, tuple(doubts))
