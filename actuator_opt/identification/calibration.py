"""From a record to the friction numbers of the design it was made with, each with its bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, hypot, log, sqrt
from typing import Any

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.fitting import Parameter, quantile, rated
from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..design.model import Design
from ..design.variable import Measured
from ..studies.bench import Bench
from .calibration_doubts import extrapolated, of_curve, weak
from .lugre_fit import LuGreFit
from .points import Point
from .result import Identification
from .stribeck_fit import StribeckFit

KEYS = ("friction_coefficient", "breakaway_ratio", "stribeck_speed", "viscous_friction")
"""Keys of a seal that a record can give."""
_ASKED = ("coulomb", "static", "stribeck_speed", "viscous")
"""Parameters of the fits behind them."""
RISEN = 0.05
"""Share of the friction at one speed that may be its rise towards rest before that is said (a
choice: as much as a good record errs)."""


@dataclass(frozen=True, slots=True)
class Learned:
    """One number of the cylinder that the record told, and how it is shared among the seals.

    Parameters
    ----------
    name : of the design's key: friction_coefficient, breakaway_ratio, stribeck_speed or
        viscous_friction
    known : of the cylinder, SI; of friction_coefficient, the factor on what the design stated
    shares : of each seal by PATH: its value over that of the cylinder
    before : what the design stated or took from the compound, by PATH
    source : the fit it comes from
    """

    name: str
    known: Parameter
    shares: Mapping[str, float]
    before: Mapping[str, float]
    source: str

    def values(self) -> dict[str, float]:
        """By PATH, SI."""
        return {path: self.known.value * share for path, share in self.shares.items()}

    def bounds(self) -> dict[str, tuple[float, float]]:
        """Bounds by PATH, within what the design can state."""
        least, most = INPUTS[self.name].lower, INPUTS[self.name].upper

        def within(value: float) -> float:
            return min(max(value, least), most)

        return {
            path: (within(self.known.lower * share), within(self.known.upper * share))
            for path, share in self.shares.items()
        }

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        bounds = self.bounds()
        return {
            "source": self.source,
            "verdict": self.known.verdict,
            "values": {
                path: {
                    "value": value,
                    "lower": bounds[path][0],
                    "upper": bounds[path][1],
                    "before": self.before[path],
                }
                for path, value in self.values().items()
            },
        }


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """What a record changes in the seals of its design.

    Parameters
    ----------
    identification : of the record
    learned : what the record told
    left : by key, why the design's value stays
    coulomb, stated : Coulomb friction measured, and as the design stated it, at the record's
        mean pressures [N]
    doubts : what the numbers rest on
    """

    identification: Identification
    learned: tuple[Learned, ...]
    left: Mapping[str, str]
    coulomb: float
    stated: float
    doubts: tuple[str, ...]

    def values(self) -> dict[str, float]:
        """New numbers by PATH, SI."""
        return {path: value for one in self.learned for path, value in one.values().items()}

    def measured(self) -> dict[str, Measured]:
        """Their bounds by PATH."""
        name = self.identification.record.file_name
        return {
            path: Measured(lower=low, upper=high, record=name)
            for one in self.learned
            for path, (low, high) in one.bounds().items()
        }


def calibration(identification: Identification) -> Calibration:
    """The friction numbers that a record gives the seals of its design.

    The coefficients of all rings and wipers change by one factor, so that the Coulomb friction of
    the design at the pressures of the steady points is that measured; the record of a cylinder
    cannot tell piston from rod. F_S/F_C and v_s become those of every ring, sigma_2 is shared by
    circumference. Each comes from the fit that knows it best; what none knows stays as it is. A
    record of one speed gives the factor alone.

    Parameters
    ----------
    identification : with points of steady sliding

    Returns
    -------
    the calibration

    Raises
    ------
    InputError
        no steady sliding, or friction that the design takes from an oil film
    """
    bench, points = identification.bench, identification.points
    refuse_films(bench.design)
    if not points:
        raise identification.record.fault(
            "no steady sliding: nothing to calibrate the seals with",
            "record plateaus of constant speed, or slow sweeps, in both directions",
        )
    coulomb = np.asarray(bench.coulomb(*_pressures(points)))
    if isinstance(identification.stribeck, StribeckFit):
        learned, left, level = _from_fits(identification, identification.stribeck, coulomb)
        doubts = [*identification.stribeck.doubts]
        doubts += of_curve(points, identification.stribeck, level, coulomb)
    else:
        learned, level, doubts = _from_level(bench, points)
        left = dict.fromkeys(KEYS[1:], identification.stribeck)
    kept = []
    for one in learned:
        why = _beyond_range(one)
        if why is None:
            kept.append(one)
        else:
            left[one.name] = why
    if not kept:
        raise identification.record.fault(
            f"it tells nothing of the seals: {'; '.join(dict.fromkeys(left.values()))}",
            "record plateaus of several constant speeds, in both directions",
        )
    doubts += weak({one.name: one.known for one in kept})
    doubts += extrapolated(bench, points)
    if len(bench.rings) + len(bench.wipers) > 1:
        doubts.append(
            "one factor for all rings and wipers: a record of the cylinder cannot tell piston "
            "from rod"
        )
    return Calibration(
        identification,
        tuple(kept),
        left,
        float(np.mean(level)),
        float(np.mean(coulomb)),
        tuple(dict.fromkeys(doubts)),
    )


def _beyond_range(one: Learned) -> str | None:
    """Why a number cannot stand in a design; None where it can."""
    quantity = INPUTS[one.name]
    out = [v for v in one.values().values() if not quantity.lower <= v <= quantity.upper]
    if not out:
        return None
    return f"measured {quantity.text(out[0])}, a design takes {quantity.range_text()}"


def refuse_films(design: Design) -> None:
    """Refuse a design whose seals take their friction from an oil film.

    Raises
    ------
    InputError
        at the seal's PATH
    """
    for place in ("piston", "rod"):
        for tail, element in getattr(design.seals, place).elements().items():
            if element.friction_law.film:
                message = (
                    "the friction of this seal comes from an oil film: records give coefficients"
                )
                remedy = 'write "friction: coefficient" to calibrate it'
                raise InputError(Diagnostic(message, remedy, path=f"seals.{place}.{tail}friction"))


def _pressures(points: Sequence[Point]) -> tuple[Array, Array]:
    """Chamber pressures of the points [Pa]."""
    return (
        np.array([one.pressure_1 for one in points]),
        np.array([one.pressure_2 for one in points]),
    )


def _from_fits(
    identification: Identification, stribeck: StribeckFit, stated: Array
) -> tuple[list[Learned], dict[str, str], Array]:
    """What the Stribeck curve and the bristles told, and the Coulomb level by point.

    The factor is the mean level over the mean that the design states; its bounds hold the ratio at
    every point too, so that a contact law that rises otherwise with pressure widens them.
    """
    bench = identification.bench
    known = {name: _best(identification, name) for name in _ASKED}
    pressure = np.array([one.pressure for one in identification.points])
    coulomb = known["coulomb"]
    middle = (stribeck.parameters["coulomb"] if coulomb is None else coulomb[0]).value
    slope = stribeck.values["pressure_slope"]
    level = middle + slope * (pressure - stribeck.reference_pressure)
    learned: list[Learned] = []
    left: dict[str, str] = {}
    if coulomb is None:
        left["friction_coefficient"] = "the record does not part Coulomb from viscous friction"
    else:
        factor = float(np.mean(level) / np.mean(stated))
        found = _times(coulomb[0], factor / middle)
        low, high = float(np.min(level / stated)), float(np.max(level / stated))
        found = rated(factor, min(found.lower, low), max(found.upper, high), found.standard_error)
        learned.append(_coefficient(found, bench, coulomb[1]))
    static, speed, viscous = (known[name] for name in _ASKED[1:])
    if static is None or speed is None or coulomb is None:
        why = "the record does not show how friction rises towards rest"
        left |= {"breakaway_ratio": why, "stribeck_speed": why}
    else:
        ratio = _ratio(static[0], coulomb[0])
        learned.append(_alike("breakaway_ratio", ratio, bench, static[1]))
        learned.append(_alike("stribeck_speed", speed[0], bench, speed[1]))
    if viscous is None:
        left["viscous_friction"] = "the record does not show how friction rises with speed"
    else:
        learned.append(_viscous(viscous[0], bench, viscous[1]))
    return learned, left, level


def _from_level(bench: Bench, points: Sequence[Point]) -> tuple[list[Learned], Array, list[str]]:
    """The factor alone, from friction at one speed; its rise at other speeds as the design says.

    Where the design says that the speed is within that rise, the upper bound allows for none.
    """
    speed = np.array([one.speed for one in points])
    measured = np.array([one.friction * np.sign(one.velocity) for one in points])
    level, viscous = bench.sliding(speed, *_pressures(points))
    coulomb = np.asarray(bench.coulomb(*_pressures(points)))
    factors = (measured - viscous) / level
    value = float(np.mean(factors))
    errors = np.array([one.error for one in points]) / level
    scatter = float(np.std(factors, ddof=1)) if factors.size > 1 else 0.0
    error = max(scatter, float(np.mean(errors))) / sqrt(factors.size)
    half = quantile(max(factors.size - 1, 1)) * error
    rise = float(np.mean(level / coulomb))
    known = rated(value, value - half, rise * value + half, error)
    at = f"{1e3 * float(np.mean(speed)):.3g} mm/s"
    doubts = [f"friction at {at} alone: its viscous part at other speeds is the design's"]
    if rise > 1 + RISEN:
        doubts.append(
            f"by the design's breakaway ratio and Stribeck speed friction at {at} is {rise:.2f} "
            "times its Coulomb part: the factor rests on them"
        )
    return [_coefficient(known, bench, f"friction at {at}")], value * coulomb, doubts


def _best(identification: Identification, name: str) -> tuple[Parameter, str] | None:
    """A parameter from the fit that bounds it best, with the fit's name; None where none does."""
    fits = (("Stribeck fit", identification.stribeck), ("LuGre fit", identification.lugre))
    found = [
        (fit.parameters[name], source)
        for source, fit in fits
        if isinstance(fit, (StribeckFit, LuGreFit)) and name in fit.parameters
    ]
    found = [one for one in found if one[0].verdict != "not identifiable"]
    return min(found, key=lambda one: one[0].standard_error / one[0].value, default=None)


def _times(one: Parameter, factor: float) -> Parameter:
    """A parameter in another unit, `factor` > 0."""
    value, lower, upper, error, known = one
    return Parameter(factor * value, factor * lower, factor * upper, factor * error, known)


def _ratio(over: Parameter, under: Parameter) -> Parameter:
    """F_S/F_C with the bounds of both as if independent; by their logarithms, so above zero."""
    ratio = over.value / under.value
    up = hypot(log(over.upper / over.value), log(under.value / under.lower))
    down = hypot(log(over.value / over.lower), log(under.upper / under.value))
    error = ratio * hypot(over.standard_error / over.value, under.standard_error / under.value)
    return rated(ratio, ratio * exp(-down), ratio * exp(up), error)


def _coefficient(factor: Parameter, bench: Bench, source: str) -> Learned:
    """One factor on every coefficient of rings and wipers."""
    stated = {ring.groove.path: float(ring["friction_coefficient"]) for ring in bench.rings}
    stated |= {one.path: float(one.coefficient) for one in bench.wipers}
    shares = {f"{path}friction_coefficient": value for path, value in stated.items()}
    return Learned("friction_coefficient", factor, shares, shares, source)


def _alike(name: str, known: Parameter, bench: Bench, source: str) -> Learned:
    """The same number for every ring."""
    before = {f"{ring.groove.path}{name}": float(ring[name]) for ring in bench.rings}
    return Learned(name, known, dict.fromkeys(before, 1.0), before, source)


def _viscous(known: Parameter, bench: Bench, source: str) -> Learned:
    """sigma_2 shared by circumference."""
    whole = sum(float(ring["diameter"]) for ring in bench.rings)
    paths = [f"{ring.groove.path}viscous_friction" for ring in bench.rings]
    return Learned(
        "viscous_friction",
        known,
        {path: float(r["diameter"]) / whole for path, r in zip(paths, bench.rings, strict=True)},
        {path: float(r["viscous_friction"]) for path, r in zip(paths, bench.rings, strict=True)},
        source,
    )
