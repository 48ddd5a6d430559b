"""Seal friction parameters of a design from its test record, each with bounds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import exp, hypot, log, sqrt
from typing import Any

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.fitting import Parameter, quantile, rated
from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..design.model import Design, TestBounds
from ..friction.coefficient import STRIBECK_EXPONENT
from ..models import friction
from ..studies.bench import Bench
from .lugre import LuGreFit
from .points import FrictionPoint
from .result import Identification
from .stribeck_fit import StribeckFit

FARTHER = 1.05
"""Duty relative to the record's speed or pressure that is reported (a choice: less is no
extrapolation)."""
MISFIT = 0.1
"""Deviation of the contact law at other pressures, as a share of F_C, that is reported (a choice: a
third of what makes a parameter weakly identifiable)."""


def of_curve(
    points: Sequence[FrictionPoint], stribeck: StribeckFit, level: Array, stated: Array
) -> Iterator[str]:
    """Effects that the design's friction omits: an offset, another pressure dependence."""
    offset = stribeck.parameters.get("offset")
    if offset is not None and (offset.lower > 0 or offset.upper < 0):
        yield (
            f"the offset of {offset.value:.3g} N between both directions is not in the design's "
            "friction, which is the mean"
        )
    yield from _shape(points, stribeck)
    apart = level - float(np.mean(level) / np.mean(stated)) * stated
    worst = int(np.argmax(np.abs(apart)))
    share = float(apart[worst] / np.mean(level))
    if abs(share) > MISFIT:
        yield (
            f"the measured friction deviates from the contact law by {100 * share:+.0f} % of F_C "
            f"at {points[worst].pressure / 100000.0:.3g} bar: the factor is a mean over the "
            "record's pressures, and its bounds cover all of them"
        )


def _shape(points: Sequence[FrictionPoint], stribeck: StribeckFit) -> Iterator[str]:
    """Deviation of the Stribeck exponent from the design's, and the resulting error of friction."""
    found = stribeck.parameters.get("exponent")
    if found is None or found.lower <= STRIBECK_EXPONENT <= found.upper:
        return
    values = {name: stribeck.values[name] for name in ("coulomb", "static", "stribeck_speed")}
    speed = np.array([point.speed for point in points])
    own, other = (
        friction.stribeck_level(speed=speed, exponent=one, **values)
        for one in (found.value, STRIBECK_EXPONENT)
    )
    worst = float(np.max(np.abs(other / own - 1)))
    yield (
        f"the exponent of the Stribeck curve is {found.value:.2f} ({found.lower:.2f} to "
        f"{found.upper:.2f}), but {STRIBECK_EXPONENT:g} in the design: error up to "
        f"{100 * worst:.0f} % at the record's speeds"
    )


def extrapolated(bench: Bench, points: Sequence[FrictionPoint]) -> Iterator[str]:
    """Duties of the design beyond the record."""
    fastest = max(case.speed for case in bench.design.load_cases)
    speed, pressure = max(point.speed for point in points), max(point.pressure for point in points)
    if fastest > FARTHER * speed or bench.supply_pressure > FARTHER * pressure:
        yield (
            f"the record reaches {1000.0 * speed:.3g} mm/s and {pressure / 100000.0:.3g} bar, "
            f"the design {1000.0 * fastest:.3g} mm/s and {bench.supply_pressure / 100000.0:.3g} "
            "bar: beyond the record friction is extrapolated by contact law and Stribeck curve"
        )


def weak(known: Mapping[str, Parameter]) -> Iterator[str]:
    """Weakly determined numbers."""
    names = [name for name, one in known.items() if not one.identifiable]
    if names:
        yield f"only weakly known (bounds beyond 30 %): {', '.join(names)}"


KEYS = ("friction_coefficient", "breakaway_ratio", "stribeck_speed", "viscous_friction")
"""Seal keys that a record can determine."""
_ASKED = ("coulomb", "static", "stribeck_speed", "viscous")
"""Fit parameters behind these keys."""
RISEN = 0.05
"""Share of the friction at one speed due to the rise towards rest that is reported (a choice: the
error of a good record)."""


@dataclass(frozen=True, slots=True)
class Learned:
    """One cylinder parameter from a record, and its distribution over the seals.

    Parameters
    ----------
    name : of the design's key: friction_coefficient, breakaway_ratio, stribeck_speed or
        viscous_friction
    known : of the cylinder, SI; for friction_coefficient, the factor on the stated values
    shares : of each seal by PATH: its value over that of the cylinder
    before : value stated in the design or taken from the compound, by PATH
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
        """Bounds by PATH, within the valid range of the design."""
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
    """Seal parameters of a design after a calibration.

    Parameters
    ----------
    identification : of the record
    learned : parameters from the record
    left : by key, the reason why the design's value stays
    coulomb, stated : Coulomb friction measured, and as stated in the design, at the record's mean
        pressures [N]
    doubts : caveats of the numbers
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

    def measured(self) -> dict[str, TestBounds]:
        """Their bounds by PATH."""
        name = self.identification.record.file_name
        return {
            path: TestBounds(lower=low, upper=high, record=name)
            for one in self.learned
            for path, (low, high) in one.bounds().items()
        }


def calibration(identification: Identification) -> Calibration:
    """Return the seal friction parameters from a record of their design.

    The coefficients of all rings and wipers change by one factor, so that the design's Coulomb
    friction at the steady points' pressures equals the measured one; a cylinder record cannot
    separate piston from rod. F_S/F_C and v_s apply to every ring, sigma_2 is distributed by
    circumference. Each parameter comes from the fit with the tightest bounds, else it stays. A
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
            "no steady sliding, so the seals cannot be calibrated",
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
            f"the record determines no seal parameter: {'; '.join(dict.fromkeys(left.values()))}",
            "record plateaus of several constant speeds, in both directions",
        )
    doubts += weak({one.name: one.known for one in kept})
    doubts += extrapolated(bench, points)
    if len(bench.rings) + len(bench.wipers) > 1:
        doubts.append(
            "one factor for all rings and wipers, as a cylinder record cannot separate piston "
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


def _beyond_range(learned: Learned) -> str | None:
    """Why a design cannot state a number, or None."""
    quantity = INPUTS[learned.name]
    out = [v for v in learned.values().values() if not quantity.lower <= v <= quantity.upper]
    if not out:
        return None
    return f"measured {quantity.text(out[0])}, but a design accepts {quantity.range_text()}"


def refuse_films(design: Design) -> None:
    """Reject a design whose seals take their friction from an oil film.

    Raises
    ------
    InputError
        names the seal's PATH
    """
    for place in ("piston", "rod"):
        for tail, element in getattr(design.seals, place).elements().items():
            if element.friction_law.film:
                message = (
                    "the friction of this seal comes from an oil film, but records give "
                    "coefficients"
                )
                remedy = 'write "friction: coefficient" to calibrate it'
                raise InputError(Diagnostic(message, remedy, path=f"seals.{place}.{tail}friction"))


def _pressures(points: Sequence[FrictionPoint]) -> tuple[Array, Array]:
    """Chamber pressures of the points [Pa]."""
    return (
        np.array([point.pressure_1 for point in points]),
        np.array([point.pressure_2 for point in points]),
    )


def _from_fits(
    identification: Identification, stribeck: StribeckFit, stated: Array
) -> tuple[list[Learned], dict[str, str], Array]:
    """Parameters from the Stribeck curve and the bristles, and the Coulomb level by point.

    The factor is the mean measured level over the mean of the design. Its bounds also cover the
    ratio at every point, so a contact law with another pressure dependence widens them.
    """
    bench = identification.bench
    known = {name: _best(identification, name) for name in _ASKED}
    pressure = np.array([point.pressure for point in identification.points])
    coulomb = known["coulomb"]
    middle = (stribeck.parameters["coulomb"] if coulomb is None else coulomb[0]).value
    slope = stribeck.values["pressure_slope"]
    level = middle + slope * (pressure - stribeck.reference_pressure)
    learned: list[Learned] = []
    left: dict[str, str] = {}
    if coulomb is None:
        left["friction_coefficient"] = "the record cannot separate Coulomb from viscous friction"
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


def _from_level(
    bench: Bench, points: Sequence[FrictionPoint]
) -> tuple[list[Learned], Array, list[str]]:
    """The factor alone, from friction at one speed; other speeds follow the design.

    If the speed is within the design's Stribeck rise, the upper bound assumes no rise.
    """
    speed = np.array([point.speed for point in points])
    measured = np.array([point.friction * np.sign(point.velocity) for point in points])
    level, viscous = bench.sliding(speed, *_pressures(points))
    coulomb = np.asarray(bench.coulomb(*_pressures(points)))
    factors = (measured - viscous) / level
    value = float(np.mean(factors))
    errors = np.array([point.error for point in points]) / level
    scatter = float(np.std(factors, ddof=1)) if factors.size > 1 else 0.0
    error = max(scatter, float(np.mean(errors))) / sqrt(factors.size)
    half = quantile(max(factors.size - 1, 1)) * error
    rise = float(np.mean(level / coulomb))
    known = rated(value, value - half, rise * value + half, error)
    at = f"{1e3 * float(np.mean(speed)):.3g} mm/s"
    doubts = [
        f"friction measured at {at} only: its viscous part at other speeds comes from the design"
    ]
    if rise > 1 + RISEN:
        doubts.append(
            f"the design's breakaway ratio and Stribeck speed make friction at {at} {rise:.2f} "
            "times its Coulomb part: the factor depends on them"
        )
    return [_coefficient(known, bench, f"friction at {at}")], value * coulomb, doubts


def _best(identification: Identification, name: str) -> tuple[Parameter, str] | None:
    """A parameter from the fit with the tightest bounds, with the fit's name, or None."""
    fits = (("Stribeck fit", identification.stribeck), ("LuGre fit", identification.lugre))
    found = [
        (fit.parameters[name], source)
        for source, fit in fits
        if isinstance(fit, (StribeckFit, LuGreFit)) and name in fit.parameters
    ]
    found = [one for one in found if one[0].verdict != "not identifiable"]
    return min(found, key=lambda one: one[0].standard_error / one[0].value, default=None)


def _times(parameter: Parameter, factor: float) -> Parameter:
    """A parameter in another unit, `factor` > 0."""
    value, lower, upper, error, known = parameter
    return Parameter(factor * value, factor * lower, factor * upper, factor * error, known)


def _ratio(over: Parameter, under: Parameter) -> Parameter:
    """F_S/F_C, with both bounds taken as independent; in logarithms, so positive."""
    ratio = over.value / under.value
    up = hypot(log(over.upper / over.value), log(under.value / under.lower))
    down = hypot(log(over.value / over.lower), log(under.upper / under.value))
    error = ratio * hypot(over.standard_error / over.value, under.standard_error / under.value)
    return rated(ratio, ratio * exp(-down), ratio * exp(up), error)


def _coefficient(factor: Parameter, bench: Bench, source: str) -> Learned:
    """One factor for all coefficients of rings and wipers."""
    stated = {ring.groove.path: float(ring["friction_coefficient"]) for ring in bench.rings}
    stated |= {wiper.path: float(wiper.coefficient) for wiper in bench.wipers}
    shares = {f"{path}friction_coefficient": value for path, value in stated.items()}
    return Learned("friction_coefficient", factor, shares, shares, source)


def _alike(name: str, known: Parameter, bench: Bench, source: str) -> Learned:
    """The same value for every ring."""
    before = {f"{ring.groove.path}{name}": float(ring[name]) for ring in bench.rings}
    return Learned(name, known, dict.fromkeys(before, 1.0), before, source)


def _viscous(known: Parameter, bench: Bench, source: str) -> Learned:
    """Distribution of sigma_2 by circumference."""
    whole = sum(float(ring["diameter"]) for ring in bench.rings)
    paths = [f"{ring.groove.path}viscous_friction" for ring in bench.rings]
    return Learned(
        "viscous_friction",
        known,
        {path: float(r["diameter"]) / whole for path, r in zip(paths, bench.rings, strict=True)},
        {path: float(r["viscous_friction"]) for path, r in zip(paths, bench.rings, strict=True)},
        source,
    )
