"""Results of an identification: friction, coefficient, damping and friction models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.fitting import Parameter
from ..base.numeric import Array
from ..base.tables import Displayed
from ..design.material import LawFit
from ..studies.bench import Bench
from ..version import VERSION
from .balance import Coefficient, Sliding
from .conditioning import CUTOFF, ORDER, ConditionedRecord
from .lugre import LuGreFit
from .points import FrictionPoint
from .record import Record
from .straight import Spectrum
from .stribeck_fit import StribeckFit


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of an identification, SI.

    Parameters
    ----------
    cutoff, order, compensated : settings of the zero-phase filter, as for `conditioning.condition`
    mass : moving mass on the actuator's side of the force sensor [kg]. By default, it is that of
        rod, piston and fastening and, if no channel measures the force, of the load
    load_force : constant force of the load on the rod, if no channel measures it [N]
    pressure_lag : lag of the pressures [s]; None to fit it to the record
    bootstrap : number of resamples for the confidence intervals; 0 for intervals of the linearised
        model
    seed : seed of the random draws of the resampling
    """

    cutoff: float = CUTOFF
    order: int = ORDER
    compensated: bool = True
    mass: float | None = None
    load_force: float | None = None
    pressure_lag: float | None = None
    bootstrap: int = 0
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Mean:
    """A mean with its 95 % confidence interval, SI."""

    value: float
    lower: float
    upper: float


@dataclass(frozen=True, slots=True, eq=False)
class Identification(Displayed):
    """Friction and damping identified from a test record, SI.

    Parameters
    ----------
    record, bench, settings : inputs of the identification
    motion, slidings : the conditioned record, and the friction along each of its sections
    mass : moving mass that was used, on the actuator's side of the force sensor [kg]
    pressure_lag : lag by which the pressures were corrected [s]
    lag_seen : lag of the pressures as fitted before any correction [s]; None if no lag was fitted.
        The confidence limits of the lag are infinite if the record does not show it
    spectrum : frequencies at which motion ends and noise begins, to judge the filter's cut-off
    mean, largest : absolute friction force [N]: its mean in sliding (not pre-sliding), and its
        largest value in the record
    slides : whether the rod slides; if not, `mean` is the mean while it moves
    area : piston area of the cap end [m^2]
    points : points of steady sliding
    coefficient, stribeck, lugre : results, each replaced by a text with the reason if it is missing
    fits : by name of the law, the fit of the secant damping versus speed, or the reason why it is
        missing
    notes : notes on samples that were left out, repaired or assumed
    """

    record: Record
    bench: Bench
    settings: Settings
    motion: ConditionedRecord
    slidings: tuple[Sliding, ...]
    mass: float
    pressure_lag: float
    lag_seen: Parameter | None
    spectrum: Spectrum
    mean: Mean
    largest: float
    slides: bool
    area: float
    points: tuple[FrictionPoint, ...]
    coefficient: Coefficient | str
    stribeck: StribeckFit | str
    lugre: LuGreFit | str
    fits: Mapping[str, LawFit | str]
    notes: tuple[str, ...]

    @property
    def in_short(self) -> tuple[str, str]:
        """The mean and the largest friction force."""
        return (
            self.record.name,
            f"friction mean {self.mean.value:.4g} N, largest {self.largest:.4g} N",
        )

    def stiffness_along(self, sliding: Sliding) -> Array:
        """Stiffness with closed ports, at the pressures along a section; NaN outside the stroke."""
        piece, bench = sliding.piece, self.bench
        inside = (piece["x"] >= 0) & (piece["x"] <= bench.stroke)
        return np.where(inside, bench.stiffness(piece["x"], *piece.pressures), np.nan)

    def growth_along(self, sliding: Sliding) -> Array:
        """Growth of the bore radius at the piston seal along a section."""
        return self.bench.growth * sliding.pressure

    def series(self) -> dict[str, Array]:
        """Arrays of quantities over time by name, for the CSV of the result, SI.

        `stiffness` is the stiffness with closed ports at the pressures of the record; it is NaN if
        the position lies outside the stroke. `growth` is the growth of the bore radius at the
        piston seal.
        """
        pieces = [sliding.piece for sliding in self.slidings]

        def joined(parts: list[Array]) -> Array:
            return np.concatenate(parts)

        first = joined([piece["p1"] for piece in pieces])
        columns = {
            "time": joined([piece.time for piece in pieces]),
            "position": joined([piece["x"] for piece in pieces]),
            "velocity": joined([piece.velocity for piece in pieces]),
            "acceleration": joined([piece.acceleration for piece in pieces]),
            "pressure_1": first,
        }
        if "p2" in pieces[0]:
            columns["pressure_2"] = joined([piece["p2"] for piece in pieces])
        columns["friction"] = joined([sliding.friction for sliding in self.slidings])
        columns["stiffness"] = joined([self.stiffness_along(sliding) for sliding in self.slidings])
        columns["growth"] = joined([self.growth_along(sliding) for sliding in self.slidings])
        return columns

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI; a missing value is null, and another entry has the reason."""
        series = self.series()
        return {
            "record": self.record.name,
            "design": self.bench.design.name,
            "version": VERSION,
            "friction": {
                "mean": self.mean.value,
                "slides": self.slides,
                "lower": self.mean.lower,
                "upper": self.mean.upper,
                "max": self.largest,
                "pressure_loss": self.mean.value / self.area,
                "pressure_loss_max": self.largest / self.area,
            },
            **_coefficient(self.coefficient),
            **_model("stribeck", self.stribeck),
            **_model("lugre", self.lugre),
            "damping": [_point(point) for point in self.points],
            "stiffness": _range(series["stiffness"]),
            "growth_at_seal": _range(series["growth"]),
            "fits": {name: _fit(fit) for name, fit in self.fits.items()},
            "mass": self.mass,
            "load_force": self.settings.load_force,
            "pressure_lag": self.pressure_lag,
            "lag_seen": None if self.lag_seen is None else self.lag_seen.to_dict(),
            "bounds": {
                "method": "bootstrap" if self.settings.bootstrap else "linearised",
                "resamples": self.settings.bootstrap,
                "seed": self.settings.seed,
            },
            "filter": {
                "cutoff": self.motion.cutoff,
                "order": self.motion.order,
                "compensated": self.motion.compensated,
                **self.spectrum._asdict(),
            },
            "channels": {name: quality._asdict() for name, quality in self.motion.quality.items()},
            "notes": list(self.notes),
        }


def _coefficient(coefficient: Coefficient | str) -> dict[str, Any]:
    """Plain data of the friction coefficient; null and the reason if it is missing."""
    if isinstance(coefficient, str):
        return {"mu": None, "mu_why": coefficient}
    return {
        "mu": {
            "value": coefficient.value,
            "lower": coefficient.lower,
            "upper": coefficient.upper,
            "contact_pressure": coefficient.contact_pressure,
            "contact_force": coefficient.contact_force,
            "contact_law": coefficient.law,
            "windows": coefficient.windows,
        }
    }


def _model(name: str, fit: StribeckFit | LuGreFit | str) -> dict[str, Any]:
    """Plain data of a friction model's parameters; null and the reason if it is missing."""
    if isinstance(fit, str):
        return {name: None, f"{name}_why": fit}
    return {
        name: {key: parameter.to_dict() for key, parameter in fit.parameters.items()},
        f"{name}_held": dict(fit.held),
        f"{name}_doubts": list(fit.doubts),
    }


def _point(friction_point: FrictionPoint) -> dict[str, Any]:
    return {
        "velocity": friction_point.velocity,
        "pressure": friction_point.pressure,
        "value": friction_point.damping,
        "standard_error": friction_point.error / friction_point.speed,
        "friction": friction_point.friction,
        "pressure_1": friction_point.pressure_1,
        "pressure_2": friction_point.pressure_2,
        "method": friction_point.kind,
    }


def _fit(fit: LawFit | str) -> dict[str, Any]:
    if isinstance(fit, str):
        return {"why": fit}
    return {
        "parameters": {name: parameter.to_dict() for name, parameter in fit.parameters.items()},
        "r_squared": fit.r_squared,
        "doubts": list(fit.doubts),
    }


def _range(values: Array) -> dict[str, float] | None:
    """Smallest and largest value of a quantity over time; None if it has no values."""
    known = values[np.isfinite(values)]
    return {"min": float(known.min()), "max": float(known.max())} if known.size else None
