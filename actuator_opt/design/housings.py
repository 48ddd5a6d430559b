"""Standard housings (grooves) of seals, guides and wipers, extrusion limits, check of a gland.

ISO 5597 (lip seals), ISO 7425-1 and -2 (sliding rings energised by an O-ring), ISO 10766 (guides),
ISO 6195 (wipers). Lengths are in m, pressures in Pa. Every row states source and confidence.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from .standard_sizes import Gland, citation, metres, section_tolerance, tables

Place: TypeAlias = Literal["rod", "piston"]
Points: TypeAlias = tuple[tuple[float, float], ...]

_NEAR = 1e-6
"""Relative difference up to which two diameters count as equal."""


@dataclass(frozen=True, slots=True)
class Housing:
    """Groove of a standard series, for a range of rod or bore diameters.

    `sizes` are the nominal diameters; empty if every diameter of the range is nominal. `section` is
    the cross-section of the O-ring behind a sliding ring, or the thickness of a guide; otherwise 0.
    `gaps` are the largest allowed radial gaps behind a seal, by pressure; `gap` is the radial gap
    of a guide, otherwise 0.
    """

    standard: str
    element: str
    place: str
    diameter_min: float
    diameter_max: float
    radial_depth: float
    lengths: tuple[float, ...]
    sizes: tuple[float, ...]
    section: float
    gaps: Points
    gap: float
    confidence: str
    source: str

    def fits(self, diameter: float) -> bool:
        """Whether the diameter is in the range."""
        low, high = self.diameter_min * (1 - _NEAR), self.diameter_max * (1 + _NEAR)
        return low <= diameter <= high

    def is_nominal(self, diameter: float) -> bool:
        """Whether the diameter is a nominal size."""
        if not self.sizes:
            return self.fits(diameter)
        return any(abs(size - diameter) <= _NEAR * size for size in self.sizes)


@dataclass(frozen=True, slots=True)
class ExtrusionTable:
    """Largest radial gaps that need no back-up ring, by pressure and hardness (Shore A)."""

    name: str
    rows: tuple[tuple[float, Points], ...]
    confidence: str
    source: str


@dataclass(frozen=True, slots=True)
class Deviation:
    """A groove dimension outside the limits of its standard gland."""

    quantity: str
    value: float
    lower: float
    upper: float
    source: str

    @property
    def excess(self) -> float:
        """Signed distance to the violated limit: positive above it, negative below."""
        return self.value - (self.upper if self.value > self.upper else self.lower)


@functools.cache
def housings(element: str, place: Place) -> tuple[Housing, ...]:
    """Housings of an element on `rod` or `piston`, in the order of the standard."""
    return tuple(
        _housing(group, row)
        for group in tables()["housings"]
        if (group["element"], group["place"]) == (element, place)
        for row in group["rows"]
    )


def _housing(group: Mapping[str, Any], row: Mapping[str, Any]) -> Housing:
    sizes = tuple(map(metres, row.get("sizes", ())))
    pressures = [float(bar) * 1e5 for bar in group.get("pressures", ())]
    gaps = [metres(gap) for gap in row.get("gaps", ())]
    return Housing(
        standard=group["standard"],
        element=group["element"],
        place=group["place"],
        diameter_min=sizes[0] if sizes else metres(row["from"]),
        diameter_max=sizes[-1] if sizes else metres(row["to"]),
        radial_depth=metres(row["depth"]),
        lengths=tuple(map(metres, row["lengths"])),
        sizes=sizes,
        section=metres(row.get("section", "0")),
        gaps=tuple(zip(pressures, gaps, strict=True)),
        gap=metres(row.get("gap", "0")),
        confidence=group["confidence"],
        source=citation(group["source"]),
    )


def housings_for(element: str, place: Place, diameter: float) -> tuple[Housing, ...]:
    """Housings whose range includes a diameter, nominal sizes first.

    Parameters
    ----------
    element : a seal type, ``guide`` or ``wiper`` (rod only)
    place : ``rod`` or ``piston``
    diameter : diameter of the rod or the bore, m

    Raises
    ------
    InputError : if the standard has no housing for this diameter
    """
    listed = housings(element, place)
    fitting = [housing for housing in listed if housing.fits(diameter)]
    if not fitting:
        message = f"no standard {place} groove of a {element} for {diameter * 1e3:.4g} mm"
        advice = "a wiper sits on the rod"
        if listed:
            low = min(housing.diameter_min for housing in listed) * 1e3
            high = max(housing.diameter_max for housing in listed) * 1e3
            advice = f"{listed[0].standard} covers {low:.4g} to {high:.4g} mm"
        raise InputError(Diagnostic(message, advice))
    return tuple(sorted(fitting, key=lambda housing: not housing.is_nominal(diameter)))


@functools.cache
def extrusion_tables() -> Mapping[str, ExtrusionTable]:
    """Tables of extrusion limits by name; only ``sealanddesign`` is verified."""
    return {
        group["table"]: ExtrusionTable(
            group["table"],
            tuple(
                (
                    float(row["hardness"]),
                    tuple((float(bar) * 1e5, metres(gap)) for bar, gap in row["points"]),
                )
                for row in group["rows"]
            ),
            group["confidence"],
            citation(group["source"]),
        )
        for group in tables()["extrusion"]
    }


def gland_deviations(
    gland: Gland,
    *,
    squeeze_min: float,
    squeeze_max: float,
    width: float,
    fill: float,
    stretch: float,
    back_up_rings: int = 0,
) -> tuple[Deviation, ...]:
    """List the dimensions of a groove that are outside the limits of its standard gland.

    The squeeze range follows from the depth limits of the gland and the tolerance of the ring.

    Parameters
    ----------
    gland : standard gland for the cross-section of the ring (`standard_sizes.gland`)
    squeeze_min, squeeze_max : smallest and largest squeeze in this groove with its tolerances
    width : width of the groove, m
    fill : largest share of the groove filled by the ring
    stretch : stretch of the installed ring
    back_up_rings : number of back-up rings

    Raises
    ------
    InputError : if the table has no width for this number of back-up rings
    """
    limits = tables()["gland_limits"]
    tolerance = gland.section_tolerance or section_tolerance(gland.section).value
    lowest = 1 - gland.depth_max / (gland.section - tolerance)
    highest = 1 - gland.depth_min / (gland.section + tolerance)
    narrow, wide = gland.widths(back_up_rings)
    checks = [
        Deviation("smallest squeeze", squeeze_min, lowest, highest, gland.source),
        Deviation("largest squeeze", squeeze_max, lowest, highest, gland.source),
        Deviation("groove width", width, narrow, wide, gland.source),
    ]
    for name, value in (("fill", fill), ("stretch", stretch)):
        upper = float(limits[name]["largest"])
        checks.append(Deviation(name, value, 0.0, upper, citation(limits[name]["source"])))
    return tuple(
        check
        for check in checks
        if not check.lower * (1 - _NEAR) <= check.value <= check.upper * (1 + _NEAR)
    )
