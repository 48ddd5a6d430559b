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
from .points import Point
from .stribeck_fit import EXPONENT, EXPONENTS, SPEEDS, StribeckFit, curve

TRAVELS = (1e-6, 3e-3)
"""Travel F_S/sigma_0 of the bristles searched [m]."""
DAMPING_TIMES = (1e-6, 0.3)
"""sigma_1/sigma_0 searched [s]."""
BLUR = 40e-3
"""Time by which a turn may be hidden for a lag to be looked for [s]: ten times a usual lag."""
STEP = 1e-4
"""Step of the central differences over the size of a parameter."""
SYMBOLS = {"bristle_stiffness": "σ₀", "bristle_damping": "σ₁", "lag": "τ"}
"""Parameters beside those of the Stribeck curve: N/m, N s/m, s."""
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


def fit_lugre(
    slidings: Sequence[Sliding],
    motion: Motion,
    points: Sequence[Point],
    stribeck: StribeckFit | str,
    *,
    lag_known: bool,
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

    Returns
    -------
    the fit, or one line that says what is missing
    """
    curve_known = stribeck if isinstance(stribeck, StribeckFit) else None
    reference = 0.0 if curve_known is None else curve_known.reference_pressure
    found = windows(slidings, motion, reference)
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
        points = points if stribeck is not None else ()
        self.velocity = np.array([one.velocity for one in points])
        self.friction = np.array([one.friction for one in points])
        self.largest = float(np.max(np.abs(found.measured(np.zeros(1))[..., found.kept])))
        self.spread = 1.0
        if stribeck is None:
            self.change = self.errors = np.zeros(0)
            self.begin = {"coulomb": self.largest, "offset": 0.0}
            self.held = {"viscous": 0.0, "exponent": EXPONENT, "pressure_slope": 0.0}
            self.held["stribeck_speed"] = SPEEDS[0]
        else:
            pressure = np.array([one.pressure for one in points])
            self.change, self.errors = pressure - stribeck.reference_pressure, stribeck.errors
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
            for name in ("static", "stribeck_speed"):
                self.held.pop(name, None)
            self.begin |= {
                "static": max(self.largest, 1.01 * self.begin["coulomb"]),
                "stribeck_speed": float(np.sqrt(SPEEDS[0] * SPEEDS[1])),
            }

    def _sizes(self) -> Array:
        """Size of each searched parameter: 1 of a logarithm."""
        speed = np.max(np.abs(self.velocity), initial=1e-3)
        change = np.max(np.abs(self.change), initial=1e5)
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
        lanes = self.windows.misfit(values) / self.spread
        steady = {n: v[:, None] for n, v in values.items() if n not in SYMBOLS}
        points = (curve(self.velocity, self.change, **steady) - self.friction) / self.errors
        return np.concatenate([points, lanes.reshape(len(rows), -1)], axis=1)

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
        cost = np.sum(self.residuals(table) ** 2, axis=1)
        return table[int(np.argmin(cost))]

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
        return max(float(np.std(self.windows.misfit(self.values(x[None])))), 1e-9)

    def solve(self) -> LuGreFit:
        """Search, weigh the windows by their own scatter, search again, and bound."""
        x = self.start()
        self.spread = self.scatter(x)
        x = self.descend(x)
        self.spread = self.scatter(x)
        x = self.descend(x)
        found = {name: float(one[0]) for name, one in self.values(x[None]).items()}
        own = {name: found[name] for name in self.names}
        chain = np.array([own[name] if name in LOGARITHMIC else 1.0 for name in self.names])
        least = 1e-3 * self.sizes * chain
        told = known(
            own,
            self.slopes(x) / chain,
            self.one(x),
            np.maximum(np.abs(list(own.values())), least),
        )
        doubts = [
            f"{SYMBOLS[name]} is {one.verdict}"
            for name, one in told.parameters.items()
            if name in LOGARITHMIC[:2] and not one.identifiable
        ]
        lanes = self.windows.velocity.shape[0]
        return LuGreFit(told.parameters, self.held, lanes, self.spread, tuple(doubts))
