"""Modulus from a bending test, by the slope of the straight part of force versus deflection.

The straight part lies between the strains 0.0005 and 0.0025 of the outer fibre, as for the chord of
[ISO178] and [ISO14125]. Strain is measured from the point where the straight line meets zero force
(toe compensation of [ASTM-D790], annex A1). [ASTM-D7264] uses 0.001 to 0.003. ASTM D790 does not
fix the chord and prefers the steepest tangent, which noise makes too steep.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite
from typing import Any, Literal

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.fitting import WEAK, Parameter, quantile, rated
from ..base.tables import Displayed
from ..evaluation import PreparedDesign, compute
from ..models import bending_test, column, rod
from .record import Record
from .straight import BENT, SHARES, Loop, Straight, Term, by_way, mean, scatter, slopes, straight

Part = Literal["rod", "barrel"]
POISSON = 0.3
"""Default Poisson's ratio for the shear coefficient (our choice: between 0 and 0.5 the coefficient
of a round section changes by only 9 %)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Specimen:
    """The specimen, SI: a round bar or tube, or any section given by its second moment of area.

    Parameters
    ----------
    span : distance L between the supports [m]
    outer_diameter, inner_diameter : diameters of a round section [m]
    second_moment : I about the neutral axis [m^4], to be given in place of the diameters; for
        example from `equivalent_second_moment`
    depth : height of the section given by `second_moment`, in the plane of bending [m]; strains are
        unknown without it
    shear_modulus : G of a round section [Pa]
    poissons_ratio : Poisson's ratio for the shear coefficient of a round section [-]
    shear_compliance : 1/(kappa G A) with the shear coefficient kappa and the area A, in place of
        `shear_modulus` [1/N]
    local_compliance : C, deflection per force due to indentation, supports and test frame [m/N]
    expected_modulus : modulus of the material, with which the result is compared [Pa]
    """

    span: float
    outer_diameter: float | None = None
    inner_diameter: float = 0.0
    second_moment: float | None = None
    depth: float | None = None
    shear_modulus: float | None = None
    poissons_ratio: float = POISSON
    shear_compliance: float | None = None
    local_compliance: float | None = None
    expected_modulus: float | None = None

    def __post_init__(self) -> None:
        """Reject invalid dimensions."""
        above = ("span", "outer_diameter", "second_moment", "depth", "shear_modulus")
        for name in (*above, "expected_modulus"):
            value = getattr(self, name)
            if value is not None and not (isfinite(value) and value > 0):
                _refuse(f"{name} is {value:g}, it must be above 0", f"state the {name} measured")
        for name in ("inner_diameter", "shear_compliance", "local_compliance"):
            value = getattr(self, name)
            if value is not None and not (isfinite(value) and value >= 0):
                message = f"{name} is {value:g}, it must not be below 0"
                _refuse(message, f"state the {name} measured")
        outer = self.outer_diameter
        if (outer is None) == (self.second_moment is None):
            _refuse(
                "the cross-section is not known"
                if outer is None
                else "the cross-section is stated twice",
                "state either outer_diameter and inner_diameter or second_moment",
            )
        if outer is not None and self.inner_diameter >= outer:
            _refuse(
                f"the inner diameter of {1e3 * self.inner_diameter:g} mm leaves no material "
                f"within the outer diameter of {1e3 * outer:g} mm",
                "swap or correct the diameters",
            )
        if self.shear_modulus is not None and (outer is None or self.shear_compliance is not None):
            _refuse(
                "shear_modulus needs the diameters, and must not be stated beside shear_compliance",
                "state shear_compliance alone, 1/(kappa G A)",
            )

    @property
    def inertia(self) -> float:
        """Second moment of the section [m^4]."""
        if self.outer_diameter is None:
            return self.second_moment or 0.0
        outer, inner = self.outer_diameter, self.inner_diameter
        return float(rod.second_moment(outer_diameter=outer, inner_diameter=inner))

    @property
    def height(self) -> float | None:
        """Depth of the section in the plane of bending [m]; None if unknown."""
        return self.outer_diameter or self.depth

    @property
    def shear(self) -> float | None:
        """Shear compliance 1/(kappa G A) [1/N]; None if unknown."""
        outer, inner = self.outer_diameter, self.inner_diameter
        if self.shear_modulus is None or outer is None:
            return self.shear_compliance
        kappa = column.cowper_tube(poissons_ratio=self.poissons_ratio, radius_ratio=inner / outer)
        area = rod.section_area(outer_diameter=outer, inner_diameter=inner)
        return float(1 / (kappa * self.shear_modulus * area))

    def deflection(self, strain: float) -> float | None:
        """Mid-span deflection [m] at a strain e: e L^2/(6 D) with span L and depth D [ISO178]."""
        return None if self.height is None else strain * self.span**2 / (6 * self.height)


def specimen_of(subject: PreparedDesign, part: Part, span: float) -> Specimen:
    """A part of a design as a specimen.

    The moduli are known only if the part is of a single metal; then G = E/(2 (1 + nu)).

    Parameters
    ----------
    subject : the design
    part : name of the part, "rod" or "barrel"
    span : distance between the supports [m]

    Raises
    ------
    InputError
        the design has no such part
    """
    if part not in ("rod", "barrel"):
        raise InputError(Diagnostic(f'part "{part}"', "write rod or barrel"))
    g = compute(subject, subject.values()).geometry
    outer, inner = (
        (g.rod_diameter, g.rod_inner_diameter)
        if part == "rod"
        else (2 * g.outer_radius, 2 * g.inner_radius)
    )
    layers = subject.design.barrel.layup if part == "barrel" else subject.design.rod.layup
    names = {ply.material for ply in layers} if layers else {subject.design.rod.material}
    known = subject.materials[names.pop()].numbers if len(names) == 1 else {}
    modulus, poisson = known.get("youngs_modulus"), known.get("poissons_ratio")
    shear = None if modulus is None or poisson is None else modulus / (2 * (1 + poisson))
    return Specimen(
        span=span,
        outer_diameter=float(np.squeeze(outer)),
        inner_diameter=float(np.squeeze(inner)),
        shear_modulus=shear,
        expected_modulus=None if shear is None else modulus,
    )


def _refuse(message: str, remedy: str) -> None:
    raise InputError(Diagnostic(f"bending specimen: {message}", remedy))


STRAINS = (0.0005, 0.0025)
"""Strains of the outer fibre between which the slope is determined [ISO178], [ISO14125]."""
SHORT = 0.5
"""Share of the range between these strains that a test must cover. If it covers less, the slope is
determined between two shares of the largest deflection instead, `straight.SHARES` (our choice)."""
SLENDER = 16.0
"""Smallest ratio of span to depth [ISO178], [ASTM-D790]."""
SHEARED = 0.1
"""Ratio of shear deflection to bending deflection above which a note says that the modulus depends
strongly on the shear correction (our choice)."""
APART = 0.05
"""Relative difference between the slopes of loading and unloading that indicates friction or creep
(our choice)."""
NOISY = 0.02
"""Scatter 1 - r^2 above which noise of the deflection lowers the slope noticeably (our choice)."""
STATED = 0.2
"""Relative difference from the material's modulus above which a note asks the user to check part,
span and units (our choice: an error of the span enters threefold, an error of the diameter
fourfold)."""


@dataclass(frozen=True, slots=True, eq=False)
class BendingResult(Displayed):
    """Results of a bending test, SI.

    The confidence intervals only cover the scatter of the record. They do not cover wrong
    dimensions: an error of the span by 1 % changes the modulus by 3 %, an error of a solid bar's
    diameter by 1 % changes it by 4 %.

    Parameters
    ----------
    slope : k_0, mean of the slopes of loading and unloading [N/m]
    loading, unloading : slopes of loading and unloading [N/m]; None if not in the record
    as_published : E = k_0 L^3/(48 I) without corrections, for the span L and second moment I [Pa]
    modulus : E, corrected for shear and indentation as far as their compliances are stated [Pa]
    taken_off : names of the corrections made: "shear", "dents" (indentation)
    shear_share : 12 E I/(kappa G A L^2), the ratio of shear deflection to bending deflection; None
        if unknown
    strains : strains of the outer fibre between which the slope is determined; None if the depth is
        unknown
    deflections : deflections between which the slope is determined, counted from zero force [m]
    bent : change of the slope along the straight part, divided by the slope
    hysteresis : work lost in a cycle divided by the work done on loading, mean of the cycles; None
        if not available
    cycles : number of loadings or of unloadings, whichever is larger
    samples : number of samples in the straight part
    doubts : reasons to doubt the modulus
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

    @property
    def in_short(self) -> tuple[str, str]:
        """The modulus."""
        return self.record.name, f"modulus {self.modulus.value / 1e9:.4g} GPa"

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI; a missing value is null."""
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
    """The bending modulus from a three-point bending test.

    The slope of force versus deflection is fitted in the straight part, with a separate offset for
    each loading and unloading. Loading and unloading have equal weight, because support friction
    that is proportional to the load makes one slope too steep by as much as it makes the other too
    flat. The 95 % confidence intervals allow for correlated noise (`straight.term`) and for the
    change of slope along the straight part.

    Parameters
    ----------
    record : record with the channels F_L (force) and w (deflection), which need not start at zero.
        The specimen is unloaded at the start; both channels increase or both decrease under load
    specimen : span and section, and shear and indentation if known

    Returns
    -------
    slope, modulus without corrections as in [ElAsswad2018], and modulus corrected for shear and
    indentation

    Raises
    ------
    InputError
        a channel is missing or constant, there are too few samples, a sign is wrong, or a stated
        compliance exceeds the measured compliance

    References
    ----------
    [ElAsswad2018] eq. 13
    """
    loop = Loop(record)
    zeros, low, high, by_strain = _range(loop, specimen)
    straight_part = straight(loop, zeros, low, high)
    result = _result(loop, specimen, straight_part)
    noise = scatter(straight_part.parts)
    doubts = _doubts_of_record(result, by_strain=by_strain, cut=straight_part.cut, noise=noise)
    if loop.both:
        way = (
            "the specimen is bent in both directions, so the slope is taken in the direction of "
            "the larger deflection, starting at"
        )
        doubts.append(f"{way} zero force")
    return replace(result, doubts=(*_doubts_of_specimen(result), *doubts))


def _result(loop: Loop, specimen: Specimen, straight_part: Straight) -> BendingResult:
    """Properties of the specimen from the straight part; the doubts are added later."""
    record, parts, ends = loop.record, straight_part.parts, straight_part.ends
    slope = _parameter(slopes(parts, 1, record), straight_part.unsure)
    terms = by_way(parts, 1)
    branch_slopes = {loading: mean(group).value for loading, group in terms.items()}
    published = _modulus(slope, specimen, published=True)
    modulus = _modulus(slope, specimen)
    if not isfinite(modulus.value):
        raise record.fault(
            "shear and indentation alone exceed the measured compliance of "
            f"{1e6 / slope.value:.4g} um/N",
            "check the shear modulus, the local compliance and the span",
        )
    shear, slender = specimen.shear, 12 * specimen.inertia / specimen.span**2
    share = None if shear is None else slender * modulus.value * shear
    compliances = {"shear": shear, "dents": specimen.local_compliance}
    unit = specimen.deflection(1.0)
    return BendingResult(
        record=record,
        specimen=specimen,
        slope=slope,
        loading=branch_slopes.get(True),
        unloading=branch_slopes.get(False),
        as_published=published,
        modulus=modulus,
        taken_off=tuple(name for name, compliance in compliances.items() if compliance is not None),
        shear_share=share,
        strains=None if unit is None else (ends[0] / unit, ends[1] / unit),
        deflections=ends,
        bent=straight_part.bent,
        hysteresis=loop.hysteresis(),
        cycles=max(len(group) for group in terms.values()),
        samples=sum(part.deflection.size for part in parts),
        doubts=(),
    )


def _range(loop: Loop, specimen: Specimen) -> tuple[list[float], float, float, bool]:
    """Range of deflection in which the straight part is searched for.

    Returns, for each loading and unloading, its deflection at zero force; then the lower and upper
    limit of the range, counted from there; and whether these limits follow from strains.
    """
    zeros = loop.begins()
    first, last = (specimen.deflection(strain) for strain in STRAINS)
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


def _parameter(term: Term, unsure: float) -> Parameter:
    """A slope with its confidence interval, widened by the share `unsure` of the slope.

    `unsure` is the relative change of slope along the straight part that noise does not explain.
    """
    error = float(np.sqrt(term.variance))
    half = quantile(term.freedom) * error + unsure * abs(term.value)
    identifiable = half <= WEAK * abs(term.value)
    return Parameter(term.value, term.value - half, term.value + half, error, bool(identifiable))


def _modulus(slope: Parameter, specimen: Specimen, *, published: bool = False) -> Parameter:
    """The modulus that follows from a slope, with its confidence interval.

    If `published`, shear and indentation are not corrected.
    """

    def modulus(stiffness: float) -> float:
        return float(
            bending_test.bending_modulus(
                slope=stiffness,
                span=specimen.span,
                second_moment=specimen.inertia,
                shear_compliance=0.0 if published else specimen.shear or 0.0,
                local_compliance=0.0 if published else specimen.local_compliance or 0.0,
            )
        )

    value, low = modulus(slope.value), -inf if slope.lower <= 0 else modulus(slope.lower)
    high = modulus(slope.upper)
    high = high if isfinite(high) else inf
    rate = (value / slope.value) ** 2 * 48 * specimen.inertia / specimen.span**3
    return rated(value, low, high, rate * slope.standard_error)


def _doubts_of_record(
    result: BendingResult, *, by_strain: bool, cut: bool, noise: float
) -> list[str]:
    """Reasons to doubt the slope."""
    doubts = []
    for name, parameter in (("slope", result.slope), ("modulus", result.modulus)):
        if not parameter.identifiable:
            doubts.append(f"the {name} is {parameter.verdict}")
            break
    strains = result.strains
    if strains is None:
        doubts.append(
            "the depth of the section is not known, so the slope is taken between "
            f"{_percent(SHARES[0])} and {_percent(SHARES[1])} of the largest deflection, not "
            "between strains"
        )
    elif not by_strain:
        doubts.append(
            f"the test does not cover the usual strains of {100 * STRAINS[0]:g} to "
            f"{100 * STRAINS[1]:g} %: the slope is taken between {100 * strains[0]:.2g} and "
            f"{100 * strains[1]:.2g} %"
        )
    if cut:
        low, high = (1e3 * deflection for deflection in result.deflections)
        words = (
            "the curve of force versus deflection is not straight, so the slope is taken from its "
            "straight part"
        )
        doubts.append(f"{words}, from {low:.3g} to {high:.3g} mm")
    if abs(result.bent) > BENT:
        doubts.append(
            f"the slope changes by {_percent(result.bent)} along the part used, which indicates "
            "yielding, slip or settling supports"
        )
    if result.unloading is None or result.loading is None:
        way = "loading" if result.unloading is None else "unloading"
        doubts.append(
            f"the record covers {way} only, so support friction and creep change the slope"
        )
    elif abs(result.loading - result.unloading) > APART * result.slope.value:
        ways = ["loading", "unloading"]
        share = (result.loading - result.unloading) / result.slope.value
        first, second = ways if share > 0 else reversed(ways)
        doubts.append(
            f"the slope of {first} is {_percent(abs(share))} steeper than that of {second}, "
            "because of support friction, creep or damage; the mean is used"
        )
    if result.hysteresis is None and result.unloading is not None and result.loading is not None:
        words = (
            "the hysteresis cannot be determined, as unloading returned more work than loading took"
        )
        doubts.append(f"{words}: F_L lags w, or one of them drifts")
    if noise > NOISY:
        words = (
            "force and deflection scatter; the noise of the deflection alone would make the slope"
        )
        doubts.append(f"{words} {_percent(noise)} too low")
    return doubts


def _doubts_of_specimen(result: BendingResult) -> list[str]:
    """Reasons to doubt the modulus that come from shear and indentation."""
    doubts = []
    specimen, share = result.specimen, result.shear_share
    height, stated = specimen.height, specimen.expected_modulus
    ratio = 1.0 if stated is None else result.modulus.value / stated
    if stated is not None and abs(ratio - 1) > STATED:
        part = _percent(ratio) if ratio <= 10 else "more than 1000 %"
        part = "less than 1 %" if ratio < 0.01 else part
        words = f"the modulus is {part} of the material's value, {1e-9 * stated:.4g} GPa"
        doubts.append(f"{words}: check part, span and units")
    if share is None:
        doubts.append(
            "not corrected for shear, as no shear modulus is stated: the modulus is too low"
        )
    elif share > SHEARED:
        words = f"shear deflection is {_percent(share)} of the bending deflection"
        doubts.append(f"{words}, so the modulus depends strongly on the shear correction")
    if height is not None and specimen.span < SLENDER * height:
        doubts.append(
            f"the span is {specimen.span / height:.1f} times the depth, less than {SLENDER:g} "
            "times: shear and indentation are significant"
        )
    if specimen.local_compliance is None:
        doubts.append(
            "not corrected for indentation at rollers and supports: the modulus is too low"
        )
    return doubts
