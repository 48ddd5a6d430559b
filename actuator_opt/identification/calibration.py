"""Seal friction parameters of a design from its test record, with confidence intervals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import exp, hypot, log, sqrt
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
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
"""Ratio of the design's speed or pressure to that of the record above which extrapolation is
reported (our choice)."""
MISFIT = 0.1
"""If measured friction deviates from the contact law at a pressure of the record by more than this
share of F_C, a note says so (our choice: a third of the confidence interval above which a parameter
is only weakly identifiable)."""


def of_curve(
    points: Sequence[FrictionPoint], stribeck: StribeckFit, level: Array, stated: Array
) -> Iterator[str]:
    """Notes on measured effects that the design's friction law cannot show, such as an offset.

    `level` and `stated` are the Coulomb friction at each point, as measured and by the design.
    """
    offset = stribeck.parameters.get("offset")
    if offset is not None and (offset.lower > 0 or offset.upper < 0):
        yield (
            f"the measured friction has an offset of {offset.value:.3g} N, so it differs between "
            "extension and retraction; the design gets the mean of both directions"
        )
    yield from _shape(points, stribeck)
    deviation = level - float(np.mean(level) / np.mean(stated)) * stated
    worst = int(np.argmax(np.abs(deviation)))
    share = float(deviation[worst] / np.mean(level))
    if abs(share) > MISFIT:
        yield (
            f"at {points[worst].pressure / 1e5:.3g} bar, the measured friction deviates from the "
            f"contact law by {100 * share:+.0f} % of F_C; the fitted factor of the coefficients is "
            "the mean over the record's pressures, and its confidence interval covers the factors "
            "at all of them"
        )


def _shape(points: Sequence[FrictionPoint], stribeck: StribeckFit) -> Iterator[str]:
    """Note on a Stribeck exponent that differs from the design's, and on its effect on friction."""
    exponent = stribeck.parameters.get("exponent")
    if exponent is None or exponent.lower <= STRIBECK_EXPONENT <= exponent.upper:
        return
    values = {name: stribeck.values[name] for name in ("coulomb", "static", "stribeck_speed")}
    speed = np.array([point.speed for point in points])
    fitted = friction.stribeck_level(speed=speed, exponent=exponent.value, **values)
    assumed = friction.stribeck_level(speed=speed, exponent=STRIBECK_EXPONENT, **values)
    worst = float(np.max(np.abs(assumed / fitted - 1)))
    yield (
        f"the exponent of the Stribeck curve is {exponent.value:.2f} ({exponent.lower:.2f} to "
        f"{exponent.upper:.2f}) in the record, but {STRIBECK_EXPONENT:g} in the design; this "
        f"changes the friction by up to {100 * worst:.0f} % at the record's speeds"
    )


def extrapolated(bench: Bench, points: Sequence[FrictionPoint]) -> Iterator[str]:
    """Note on extrapolated friction, if the design exceeds speed or pressure of the record."""
    fastest = max(case.speed for case in bench.design.load_cases)
    speed, pressure = max(point.speed for point in points), max(point.pressure for point in points)
    if fastest > FARTHER * speed or bench.supply_pressure > FARTHER * pressure:
        yield (
            f"the record reaches {1e3 * speed:.3g} mm/s and {pressure / 1e5:.3g} bar, the "
            f"design {1e3 * fastest:.3g} mm/s and {bench.supply_pressure / 1e5:.3g} bar; "
            "beyond the record, friction is extrapolated by the contact law and the Stribeck "
            "curve"
        )


def weakly_known(parameters: Mapping[str, Parameter]) -> Iterator[str]:
    """One-line note with the names of weakly known parameters."""
    names = [name for name, parameter in parameters.items() if not parameter.identifiable]
    if names:
        yield f"only weakly known (confidence interval wider than 30 %): {', '.join(names)}"


KEYS = ("friction_coefficient", "breakaway_ratio", "stribeck_speed", "viscous_friction")
"""Keys of a seal whose values a record can determine."""
_FIT_NAMES = ("coulomb", "static", "stribeck_speed", "viscous")
"""Names of the same parameters in the fits."""
RISEN = 0.05
"""At the speed of the record, the friction of the design may exceed its Coulomb part. A note is
written if the excess is larger than this share of the Coulomb part (our choice: the error of
friction from a good record)."""


@dataclass(frozen=True, slots=True)
class SealParameter:
    """A parameter of the whole cylinder from a record, and its values for the seals.

    Parameters
    ----------
    name : key in the design: friction_coefficient, breakaway_ratio, stribeck_speed or
        viscous_friction
    known : value and confidence interval for the cylinder, SI; for friction_coefficient, the factor
        by which the design's values are multiplied
    shares : by PATH of each seal's parameter, its value divided by that of the cylinder
    before : by PATH, the value in the design, stated or from the compound
    source : name of the fit that gives the value
    """

    name: str
    known: Parameter
    shares: Mapping[str, float]
    before: Mapping[str, float]
    source: str

    def values(self) -> dict[str, float]:
        """Values of the seals by PATH, SI."""
        return {path: self.known.value * share for path, share in self.shares.items()}

    def bounds(self) -> dict[str, tuple[float, float]]:
        """Confidence intervals of the seals by PATH, within the valid range of a design."""
        least, most = INPUTS[self.name].lower, INPUTS[self.name].upper

        def limited(value: float) -> float:
            return min(max(value, least), most)

        return {
            path: (limited(self.known.lower * share), limited(self.known.upper * share))
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
    identification : result of the identification from the record
    learned : parameters that the record determines
    left : for every key whose value stays as in the design, the reason
    coulomb, stated : Coulomb friction as measured, and as computed for the design before the
        calibration; means over the points of steady sliding [N]
    doubts : reasons to doubt the numbers
    """

    identification: Identification
    learned: tuple[SealParameter, ...]
    left: Mapping[str, str]
    coulomb: float
    stated: float
    doubts: tuple[str, ...]

    def values(self) -> dict[str, float]:
        """New values of the seals by PATH, SI."""
        return {
            path: value for parameter in self.learned for path, value in parameter.values().items()
        }

    def measured(self) -> dict[str, TestBounds]:
        """Confidence intervals of the new values by PATH."""
        name = self.identification.record.file_name
        return {
            path: TestBounds(lower=low, upper=high, record=name)
            for parameter in self.learned
            for path, (low, high) in parameter.bounds().items()
        }


def calibration(identification: Identification) -> Calibration:
    """Determine the seal friction parameters of a design from a record of it.

    The coefficients of all rings and wipers are multiplied by the same factor, because a record of
    a whole cylinder cannot separate the piston's friction from the rod's. With this factor, the
    mean Coulomb friction of the design at the pressures of the steady points equals the measured
    one. Every ring gets the same ratio F_S/F_C of static to Coulomb friction and the same Stribeck
    speed v_s; the viscous friction sigma_2 is shared out in proportion to circumference. Each
    parameter is taken from the Stribeck fit or the LuGre fit, whichever gives it the narrower
    confidence interval. If neither determines it, the design's value stays. A record of a single
    speed gives only the factor.

    Parameters
    ----------
    identification : an identification with points of steady sliding

    Returns
    -------
    the calibration

    Raises
    ------
    InputError
        no steady sliding, or a design whose friction comes from an oil film
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
        candidates, reasons, level = _from_fits(identification, identification.stribeck, coulomb)
        doubts = [*identification.stribeck.doubts]
        doubts += of_curve(points, identification.stribeck, level, coulomb)
    else:
        candidates, level, doubts = _from_level(bench, points)
        reasons = dict.fromkeys(KEYS[1:], identification.stribeck)
    parameters = []
    for parameter in candidates:
        reason = _beyond_range(parameter)
        if reason is None:
            parameters.append(parameter)
        else:
            reasons[parameter.name] = reason
    if not parameters:
        causes = "; ".join(dict.fromkeys(reasons.values()))
        raise identification.record.fault(
            f"the record determines no parameter of the seals: {causes}",
            "record plateaus of several constant speeds, in both directions",
        )
    doubts += weakly_known({parameter.name: parameter.known for parameter in parameters})
    doubts += extrapolated(bench, points)
    if len(bench.rings) + len(bench.wipers) > 1:
        doubts.append(
            "the friction coefficients of all rings and wipers get the same factor: a cylinder "
            "record cannot separate piston and rod friction"
        )
    return Calibration(
        identification,
        tuple(parameters),
        reasons,
        float(np.mean(level)),
        float(np.mean(coulomb)),
        tuple(dict.fromkeys(doubts)),
    )


def _beyond_range(parameter: SealParameter) -> str | None:
    """Reason why a design cannot state a parameter, such as a value out of range; else None."""
    quantity = INPUTS[parameter.name]
    outside = [
        value
        for value in parameter.values().values()
        if not quantity.lower <= value <= quantity.upper
    ]
    if not outside:
        return None
    return (
        f"the measured value is {quantity.text(outside[0])}, but a design accepts "
        f"{quantity.range_text()}"
    )


def refuse_films(design: Design) -> None:
    """Reject a design whose seals take their friction from an oil film.

    Raises
    ------
    InputError
        names the PATH of the seal
    """
    for place in ("piston", "rod"):
        for tail, element in getattr(design.seals, place).elements().items():
            if element.friction_law.film:
                message = (
                    "the friction of this seal is computed from an oil film, but a record gives "
                    "friction coefficients"
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
) -> tuple[list[SealParameter], dict[str, str], Array]:
    """Parameters from Stribeck and LuGre fit, reasons for missing parameters, F_C at every point.

    The design's friction coefficients are multiplied by a factor: the mean measured Coulomb
    friction F_C divided by that of the design. Its confidence interval also covers this ratio at
    every single point, so a contact law with a wrong pressure dependence widens the interval.
    """
    bench = identification.bench
    fits = {name: _best(identification, name) for name in _FIT_NAMES}
    pressure = np.array([point.pressure for point in identification.points])
    coulomb = fits["coulomb"]
    middle = (stribeck.parameters["coulomb"] if coulomb is None else coulomb[0]).value
    slope = stribeck.values["pressure_slope"]
    level = middle + slope * (pressure - stribeck.reference_pressure)
    parameters: list[SealParameter] = []
    reasons: dict[str, str] = {}
    if coulomb is None:
        reasons["friction_coefficient"] = "the record cannot separate Coulomb from viscous friction"
    else:
        factor = float(np.mean(level) / np.mean(stated))
        _, lower, upper, error, _ = _scaled(coulomb[0], factor / middle)
        low, high = float(np.min(level / stated)), float(np.max(level / stated))
        factor_bounds = rated(factor, min(lower, low), max(upper, high), error)
        parameters.append(_coefficient(factor_bounds, bench, coulomb[1]))
    static, speed, viscous = (fits[name] for name in _FIT_NAMES[1:])
    if static is None or speed is None or coulomb is None:
        reason = "the record does not show how friction rises towards zero speed"
        reasons |= {"breakaway_ratio": reason, "stribeck_speed": reason}
    else:
        ratio = _ratio(static[0], coulomb[0])
        parameters.append(_same_for_rings("breakaway_ratio", ratio, bench, static[1]))
        parameters.append(_same_for_rings("stribeck_speed", speed[0], bench, speed[1]))
    if viscous is None:
        reasons["viscous_friction"] = "the record does not show how friction rises with speed"
    else:
        parameters.append(_viscous(viscous[0], bench, viscous[1]))
    return parameters, reasons, level


def _from_level(
    bench: Bench, points: Sequence[FrictionPoint]
) -> tuple[list[SealParameter], Array, list[str]]:
    """The factor for the friction coefficients, from a record of friction at a single speed.

    At other speeds the Stribeck curve of the design is kept. If that curve is above Coulomb
    friction at the measured speed, the upper confidence limit of the factor is computed as if the
    measured friction were Coulomb friction alone.
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
    parameter = rated(value, value - half, rise * value + half, error)
    at = f"{1e3 * float(np.mean(speed)):.3g} mm/s"
    doubts = [
        f"friction was measured at {at} only, so the viscous part at other speeds is that of the "
        "design"
    ]
    if rise > 1 + RISEN:
        doubts.append(
            f"at {at}, friction is {rise:.2f} times its Coulomb part because of the design's "
            "breakaway ratio and Stribeck speed; the fitted factor depends on these two"
        )
    return [_coefficient(parameter, bench, f"friction at {at}")], value * coulomb, doubts


def _best(identification: Identification, name: str) -> tuple[Parameter, str] | None:
    """A parameter from the fit that gives it the narrower interval, and the name of that fit.

    None if unknown.
    """
    fits = (("Stribeck fit", identification.stribeck), ("LuGre fit", identification.lugre))
    candidates = [
        (fit.parameters[name], source)
        for source, fit in fits
        if isinstance(fit, (StribeckFit, LuGreFit))
        and name in fit.parameters
        and fit.parameters[name].verdict != "not identifiable"
    ]
    return min(candidates, key=lambda pair: pair[0].standard_error / pair[0].value, default=None)


def _scaled(parameter: Parameter, factor: float) -> Parameter:
    """A parameter converted to another unit by `factor` > 0."""
    value, lower, upper, error, identifiable = parameter
    return Parameter(factor * value, factor * lower, factor * upper, factor * error, identifiable)


def _ratio(over: Parameter, under: Parameter) -> Parameter:
    """Ratio F_S/F_C of static to Coulomb friction, with its interval for independent errors.

    It is computed by logarithms, so that the interval stays positive.
    """
    ratio = over.value / under.value
    up = hypot(log(over.upper / over.value), log(under.value / under.lower))
    down = hypot(log(over.value / over.lower), log(under.upper / under.value))
    error = ratio * hypot(over.standard_error / over.value, under.standard_error / under.value)
    return rated(ratio, ratio * exp(-down), ratio * exp(up), error)


def _coefficient(factor: Parameter, bench: Bench, source: str) -> SealParameter:
    """The same factor for the friction coefficients of all rings and wipers."""
    stated = {ring.groove.path: float(ring["friction_coefficient"]) for ring in bench.rings}
    stated |= {wiper.path: float(wiper.coefficient) for wiper in bench.wipers}
    shares = {f"{path}friction_coefficient": value for path, value in stated.items()}
    return SealParameter("friction_coefficient", factor, shares, shares, source)


def _same_for_rings(name: str, parameter: Parameter, bench: Bench, source: str) -> SealParameter:
    """A parameter with the same value for every ring."""
    stated = {f"{ring.groove.path}{name}": float(ring[name]) for ring in bench.rings}
    return SealParameter(name, parameter, dict.fromkeys(stated, 1.0), stated, source)


def _viscous(parameter: Parameter, bench: Bench, source: str) -> SealParameter:
    """Viscous friction sigma_2, distributed over the seals in proportion to circumference."""
    total = sum(float(ring["diameter"]) for ring in bench.rings)
    rings = {f"{ring.groove.path}viscous_friction": ring for ring in bench.rings}
    return SealParameter(
        "viscous_friction",
        parameter,
        {path: float(ring["diameter"]) / total for path, ring in rings.items()},
        {path: float(ring["viscous_friction"]) for path, ring in rings.items()},
        source,
    )
