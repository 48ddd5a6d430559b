"""Bending test to modulus: the slope of force over deflection in its straight part, with bounds.

The straight part lies between the strains 0.0005 and 0.0025 of the outer fibre, as the chord of
[ISO178] and [ISO14125], counted from where the straight line meets zero force (toe compensation of
[ASTM-D790], annex A1). [ASTM-D7264] takes 0.001 to 0.003; ASTM D790 leaves the chord open and
prefers the steepest tangent, which noise makes too steep.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

import numpy as np

from ..base.fitting import WEAK, Parameter, quantile
from ..models import bending_test
from .record import Record
from .specimen import Specimen
from .straight import BENT, SHARES, Loop, Straight, Term, by_way, mean, scatter, slopes, straight

STRAINS = (0.0005, 0.0025)
"""Strains between which the slope is taken [ISO178], [ISO14125]."""
SHORT = 0.5
"""Least share of the strains' range that a test must cover to be read by strain (a choice)."""
SLENDER = 16.0
"""Least span over depth [ISO178], [ASTM-D790]."""
SHEARED = 0.1
"""Share of shear in the deflection by bending from which the modulus rests on it (a choice)."""
APART = 0.05
"""Difference of loading and unloading slope from which friction or creep is named (a choice)."""
NOISY = 0.02
"""Scatter 1 - r^2 that lets noise of the deflection lower the slope by as much (a choice)."""
STATED = 0.2
"""Difference from the material's modulus from which part, span and units are doubted (a choice: an
error of the span counts three times, one of the diameter four)."""


@dataclass(frozen=True, slots=True, eq=False)
class BendingResult:
    """What a bending test told, SI; bounds are those of the record.

    Beside them an error of the span counts three times, of a solid bar's diameter four times.

    Parameters
    ----------
    slope : k_0, mean of loading and unloading [N/m]
    loading, unloading : slopes of each [N/m]; None where the record has none
    as_published : E = k_0 L^3/(48 I), nothing taken off [Pa]
    modulus : the same with what is known of shear and dents taken off [Pa]
    taken_off : what was: "shear", "dents"
    shear_share : 12 E I/(kappa G A L^2), deflection by shear over that by bending; None: not known
    strains : of the outer fibre between which the slope was taken; None: depth not known
    deflections : the same as deflections from zero force [m]
    bent : change of slope along the straight part over the slope
    hysteresis : work lost over work done on loading, mean of the cycles; None where not told
    cycles : of loading, of unloading or of both
    samples : in the straight part
    doubts : what the modulus rests on
    """

    record: Record
    specimen: Specimen
    slope: Parameter
    loading: float | None
    unloading: float | None
    as_published: Parameter
    modulus: Parameter
    taken_off: tuple[str, ...]
    shear_share: float | None
    strains: tuple[float, float] | None
    deflections: tuple[float, float]
    bent: float
    hysteresis: float | None
    cycles: int
    samples: int
    doubts: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI; what has no value is null."""
        height = self.specimen.height
        return {
            "record": self.record.name,
            "slope": {**self.slope.to_dict(), "loading": self.loading, "unloading": self.unloading},
            "modulus": self.modulus.to_dict(),
            "modulus_as_published": self.as_published.to_dict(),
            "taken_off": list(self.taken_off),
            "shear_share": self.shear_share,
            "span": self.specimen.span,
            "second_moment": self.specimen.inertia,
            "slenderness": None if height is None else self.specimen.span / height,
            "strains": None if self.strains is None else list(self.strains),
            "deflections": list(self.deflections),
            "bent": self.bent,
            "hysteresis": self.hysteresis,
            "cycles": self.cycles,
            "samples": self.samples,
            "doubts": list(self.doubts),
            "notes": list(self.record.notes),
        }


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def bending(record: Record, specimen: Specimen) -> BendingResult:
    """The bending modulus of a three-point bending test.

    Slope of force over deflection in the straight part, each branch with offsets of its own, mean
    of loading and unloading: friction at the supports that grows with the load makes one as much
    too steep as the other too flat. 95 % bounds for noise that remembers, `straight.term`, wider by
    what the slope changes along the part it is taken from.

    Parameters
    ----------
    record : with channels F_L, w, of a specimen that is not loaded at first; both grow as it is
        bent, or both fall; any offsets
    specimen : span, section, and what is known of shear and dents

    Returns
    -------
    slope, modulus as published and with shear and dents taken off

    Raises
    ------
    InputError
        a channel missing or still, too few samples, a sign turned round, give beyond what is seen

    References
    ----------
    [ElAsswad2018] eq. 13
    """
    loop = Loop(record)
    zeros, low, high, by_strain = _range(loop, specimen)
    found = straight(loop, zeros, low, high)
    result = _result(loop, specimen, found)
    noise = scatter(found.parts)
    doubts = _doubts_of_record(result, by_strain=by_strain, cut=found.cut, noise=noise)
    if loop.both:
        way = "bent both ways: the slope is that of the side bent further, from where"
        doubts.append(f"{way} the force is zero")
    return replace(result, doubts=(*_doubts_of_specimen(result), *doubts))


def _result(loop: Loop, specimen: Specimen, found: Straight) -> BendingResult:
    """What the straight part says of the specimen, without doubts."""
    record, parts, ends = loop.record, found.parts, found.ends
    slope = _parameter(slopes(parts, 1, record), found.unsure)
    ways = {way: mean(one).value for way, one in by_way(parts, 1).items()}
    published = _modulus(slope, specimen, published=True)
    modulus = _modulus(slope, specimen)
    if not isfinite(modulus.value):
        raise record.fault(
            f"shear and dents alone give more than the {1e6 / slope.value:.4g} um/N measured",
            "check the shear modulus, the local compliance and the span",
        )
    shear, slender = specimen.shear, 12 * specimen.inertia / specimen.span**2
    share = None if shear is None else slender * modulus.value * shear
    known, one = {"shear": shear, "dents": specimen.local_compliance}, specimen.deflection(1.0)
    return BendingResult(
        record=record,
        specimen=specimen,
        slope=slope,
        loading=ways.get(True),
        unloading=ways.get(False),
        as_published=published,
        modulus=modulus,
        taken_off=tuple(name for name, x in known.items() if x is not None),
        shear_share=share,
        strains=None if one is None else (ends[0] / one, ends[1] / one),
        deflections=ends,
        bent=found.bent,
        hysteresis=loop.hysteresis(),
        cycles=max(len(one) for one in by_way(parts, 1).values()),
        samples=sum(x.deflection.size for x in parts),
        doubts=(),
    )


def _range(loop: Loop, specimen: Specimen) -> tuple[list[float], float, float, bool]:
    """Zero of every branch and the range from there, found together; whether by strain."""
    zeros = loop.begins()
    first, last = (specimen.deflection(one) for one in STRAINS)
    low = high = 0.0
    by_strain = False
    for _ in range(8):
        top = loop.top(zeros)
        low, high, by_strain = SHARES[0] * top, SHARES[1] * top, False
        if first is not None and last is not None and high - first >= SHORT * (last - first):
            low, high, by_strain = first, min(last, high), True
        before, zeros = zeros, loop.zeros(loop.cut(low, high, zeros))
        if np.allclose(before, zeros, rtol=0, atol=1e-4 * (high - low)):
            break
    return zeros, low, high, by_strain


def _parameter(found: Term, unsure: float) -> Parameter:
    """A slope with its bounds, a share by which it changes along its part counted in."""
    error = float(np.sqrt(found.variance))
    half = quantile(found.freedom) * error + unsure * abs(found.value)
    near = half <= WEAK * abs(found.value)
    return Parameter(found.value, found.value - half, found.value + half, error, bool(near))


def _modulus(slope: Parameter, specimen: Specimen, *, published: bool = False) -> Parameter:
    """The modulus of a slope and of its bounds."""

    def of(one: float) -> float:
        return float(
            bending_test.bending_modulus(
                slope=one,
                span=specimen.span,
                second_moment=specimen.inertia,
                shear_compliance=0.0 if published else specimen.shear or 0.0,
                local_compliance=0.0 if published else specimen.local_compliance or 0.0,
            )
        )

    value, low = of(slope.value), -inf if slope.lower <= 0 else of(slope.lower)
    high = of(slope.upper)
    high = high if isfinite(high) else inf
    steep = (value / slope.value) ** 2 * 48 * specimen.inertia / specimen.span**3
    near = max(high - value, value - low) <= WEAK * value
    return Parameter(value, low, high, steep * slope.standard_error, near)


def _doubts_of_record(
    result: BendingResult, *, by_strain: bool, cut: bool, noise: float
) -> list[str]:
    """What the slope rests on."""
    found = []
    for name, one in (("slope", result.slope), ("modulus", result.modulus)):
        if not one.identifiable:
            found.append(f"the {name} is {one.verdict}")
            break
    strains = result.strains
    if strains is None:
        found.append(
            "the depth of the section is not known: the slope is taken between "
            f"{_percent(SHARES[0])} and {_percent(SHARES[1])} of the highest force, not by strain"
        )
    elif not by_strain:
        found.append(
            f"the test is too short for the strains {100 * STRAINS[0]:g} to {100 * STRAINS[1]:g} %:"
            f" the slope is taken between {100 * strains[0]:.2g} and {100 * strains[1]:.2g} %"
        )
    if cut:
        low, high = (1e3 * one for one in result.deflections)
        words = "force over deflection is bent: the slope is taken where it is straight"
        found.append(f"{words}, from {low:.3g} to {high:.3g} mm")
    if abs(result.bent) > BENT:
        found.append(
            f"the slope changes by {_percent(result.bent)} along the part it is taken from: "
            "yielding, slip, or supports that settle"
        )
    if result.unloading is None or result.loading is None:
        way = "loading" if result.unloading is None else "unloading"
        found.append(f"{way} only: friction at the supports and creep change the slope")
    elif abs(result.loading - result.unloading) > APART * result.slope.value:
        ways = ["loading", "unloading"]
        share = (result.loading - result.unloading) / result.slope.value
        first, second = ways if share > 0 else reversed(ways)
        found.append(
            f"{first} is {_percent(abs(share))} steeper than {second}: friction at the supports, "
            "creep or damage; their mean is taken"
        )
    if result.hysteresis is None and result.unloading is not None and result.loading is not None:
        words = "the work lost cannot be told, unloading gives back more than loading took"
        found.append(f"{words}: F_L lags w, or one drifts")
    if noise > NOISY:
        words = "force and deflection scatter: noise of the deflection alone would make the slope"
        found.append(f"{words} {_percent(noise)} too low")
    return found


def _doubts_of_specimen(result: BendingResult) -> list[str]:
    """What shear and dents leave open."""
    found = []
    specimen, share = result.specimen, result.shear_share
    height, stated = specimen.height, specimen.expected_modulus
    ratio = 1.0 if stated is None else result.modulus.value / stated
    if stated is not None and abs(ratio - 1) > STATED:
        part = _percent(ratio) if ratio <= 10 else "more than 1000 %"
        part = "less than 1 %" if ratio < 0.01 else part
        words = f"the modulus is {part} of what the material states, {1e-9 * stated:.4g} GPa"
        found.append(f"{words}: part, span or units?")
    if share is None:
        found.append("shear is not taken off, no shear modulus is stated: the modulus is low")
    elif share > SHEARED:
        words = f"shear deflects {_percent(share)} of what bending does"
        found.append(f"{words}: the modulus rests on it")
    if height is not None and specimen.span < SLENDER * height:
        found.append(
            f"the span is {specimen.span / height:.1f} depths, less than {SLENDER:g}: shear and "
            "dents are not small"
        )
    if specimen.local_compliance is None:
        found.append("dents at rollers and supports are not taken off: the modulus is low")
    return found
