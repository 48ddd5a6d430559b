"""Sizes of a seal in the design file, its contact with the counterface, and its outline.

The contact comprises line load, width, peak pressure and profile. Outlines are polygons [m] of the
seal without pressure: x runs from the sealed side of the groove, r from the counterface into the
groove. A round ring keeps its section area: squeezed, it is a rectangle between two half circles.
A design may instead state the contact pressures of a seal of any type.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Literal, NamedTuple, Protocol, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, array_of, maximum, minimum, real, where
from ..models import contact_profile


class Size(NamedTuple):
    """A dimension of a seal that a design file may state.

    Parameters
    ----------
    key : key in the design file
    quantity : name of the physical quantity in `quantities.INPUTS`
    help : its meaning, for the JSON Schema
    example : valid value, for messages
    """

    key: str
    quantity: str
    help: str
    example: str


class SizeField(NamedTuple):
    """A size of a seal type, with its default.

    Parameters
    ----------
    size : the size
    default : function that computes the default from the preceding values (SI), such as
        `section` and `gland_depth`; None if the design must state the size
    """

    size: Size
    default: Callable[[Mapping[str, Array]], Array] | None

    @property
    def key(self) -> str:
        """Key in the design file."""
        return self.size.key


THICKNESS = Size(
    "thickness", "part_length", "radial thickness of a step ring, or of a lip at its root", "1.5 mm"
)
WIDTH = Size(
    "width",
    "part_length",
    "axial width of a step ring or compact seal, or length of a lip",
    "4 mm",
)
GROOVE_WIDTH = Size(
    "groove_width",
    "groove_width",
    "axial width of the groove; default: the standard gland",
    "6.3 mm",
)
LAND = Size(
    "land",
    "part_length",
    "axial width of the contact without pressure; default: half the width of a step ring, the "
    "whole width of a compact seal; for a U-cup, state twice the edge radius of its lip "
    "(default: a tenth of the lip length)",
    "2 mm",
)
RELIEF = Size(
    "relief",
    "length",
    "axial width of the part of a step ring's face between its sealed side and its land, on which "
    "the oil pressure acts; default: half the difference between ring width and land",
    "1 mm",
)
TAPER = Size(
    "taper",
    "taper",
    "angle between the counterface and the tapers on both sides of a step ring's land; default: "
    "6 deg",
    "6 deg",
)
ROOT_CLEARANCE = Size(
    "root_clearance",
    "length",
    "gap between U-cup lip and counterface where the lip joins the body; default: the "
    "interference of the lip",
    "0.3 mm",
)
SHARED = (THICKNESS, WIDTH, GROOVE_WIDTH, LAND, RELIEF, TAPER, ROOT_CLEARANCE)
"""Sizes in the order of a design file; a type may have further sizes."""


WITHIN, TOUCHING = 1e-6, 1.0
"""Least excess of the contact pressure over the oil pressure: as a share of the sealed pressure,
and in Pa. With a smaller excess, the sealed pressure would open the contact."""


@dataclass(frozen=True, slots=True)
class SealContact:
    """Contact of a seal with its counterface.

    Parameters
    ----------
    line_load : normal force per length of circumference [N/m]
    width : contact width [m]
    peak : highest contact pressure [Pa], relative to the outer pressure, which is the pressure on
        the side away from the sealed pressure
    profile : function that returns the static contact pressure above the outer pressure [Pa] at t =
        x/b; x is the distance from the sealed side, b the width
    excess : excess of the contact pressure over the oil pressure [Pa]; if it is not positive, the
        sealed pressure opens the contact, and the profile is that of a contact that just touches
    profile_width : width of the profile [m]. It equals the contact width; for an O-ring it is
        smaller if a profile as wide as the contact, with this peak, would carry more than the line
        load
    """

    line_load: Array
    width: Array
    peak: Array
    profile: Callable[[Array], Array]
    excess: Array
    profile_width: Array


def shaped(
    load: Array,
    width: Array,
    peak: Array,
    pressure: Array,
    *,
    excess_law: Callable[..., Array],
    profile_law: Callable[..., Array],
) -> SealContact:
    """A contact whose pressure profile has a given shape and is scaled to carry the load."""
    ends = {"sealed_pressure": pressure, "outer_pressure": 0.0}
    excess = excess_law(line_load=load, width=width, **ends)

    def profile(position: Array) -> Array:
        limited = maximum(excess, WITHIN * pressure + TOUCHING)
        return profile_law(position=position, excess=limited, **ends)

    return SealContact(load, width, peak, profile, excess, width)


def landed(load: Array, width: Array, pressure: Array) -> SealContact:
    """Contact of a worn-in flat land under a line load."""
    peak = contact_profile.land_peak(
        line_load=load, width=width, sealed_pressure=pressure, outer_pressure=0.0
    )
    return shaped(
        load,
        width,
        peak,
        pressure,
        excess_law=contact_profile.land_excess,
        profile_law=contact_profile.land_profile,
    )


Polygon: TypeAlias = tuple[tuple[float, float], ...]
_CORNERS = 24


class Shape(NamedTuple):
    """A named closed polygon; `free` marks the outline before mounting."""

    kind: Literal["elastomer", "polymer", "back-up", "free"]
    points: Polygon


def box(left: float, right: float, low: float, high: float) -> Polygon:
    """A rectangle."""
    return ((left, low), (right, low), (right, high), (left, high))


def stadium(middle: float, low: float, high: float, section: float) -> Polygon:
    """Outline of a round section squeezed to the height high - low; a circle if it has more space.

    >>> points = stadium(0.0, 0.0, 0.8, 1.0)
    >>> f"{max(x for x, _ in points) - min(x for x, _ in points):.4f}"
    '1.1534'
    """
    height = min(high - low, section)
    flat = math.pi / 4 * (section**2 - height**2) / height
    centre, radius = high - height / 2, height / 2
    points = []
    for k in range(2 * _CORNERS + 2):
        end = 1.0 if k <= _CORNERS else -1.0
        angle = math.pi * ((k if k <= _CORNERS else k - 1) / _CORNERS - 0.5)
        x = middle + end * flat / 2 + radius * math.cos(angle)
        points.append((x, centre + radius * math.sin(angle)))
    return tuple(points)


def round_ring(middle: float, low: float, high: float, section: float) -> tuple[Shape, ...]:
    """Outlines of a round ring: squeezed between two heights, and before mounting."""
    free = stadium(middle, high - section, high, section)
    return Shape("elastomer", stadium(middle, low, high, section)), Shape("free", free)


class PressureProfile(Protocol):
    """Contact pressures above the outer pressure [Pa] at positions [m], for one sealed pressure."""

    @property
    def pressure(self) -> float:
        """Sealed pressure [Pa]."""

    @property
    def positions(self) -> tuple[float, ...]:
        """Distances from the sealed side, increasing from 0 [m]."""

    @property
    def stresses(self) -> tuple[float, ...]:
        """Contact pressures at the positions [Pa]."""


def stated_contact(tables: Sequence[PressureProfile], pressure: Array) -> SealContact:
    """Interpolate between the profiles stated for the two neighbouring sealed pressures.

    Parameters
    ----------
    tables : profiles in order of sealed pressure
    pressure : sealed pressure [Pa]
    """
    pressures = [table.pressure for table in tables]
    shares = [_share(pressure, pressures, i) for i in range(len(tables))]
    widths = [table.positions[-1] for table in tables]
    width = sum(share * table_width for share, table_width in zip(shares, widths, strict=True))
    places = [tuple(x / table.positions[-1] for x in table.positions) for table in tables]

    def profile(position: Array) -> Array:
        parts = [
            share
            * contact_profile.table_profile(
                position=position, positions=place, pressures=table.stresses
            )
            for share, place, table in zip(shares, places, tables, strict=True)
        ]
        return sum(parts)

    means = [
        contact_profile.table_mean(positions=place, pressures=table.stresses)
        for place, table in zip(places, tables, strict=True)
    ]
    load = width * sum(share * mean for share, mean in zip(shares, means, strict=True))
    knots = np.array(sorted({place for row in places for place in row}))
    at_knots = [
        np.interp(knots, place, table.stresses) for place, table in zip(places, tables, strict=True)
    ]
    mixed = sum(
        array_of(share)[..., None] * row for share, row in zip(shares, at_knots, strict=True)
    )
    highest = np.argmax(real(mixed), axis=-1)[..., None]  # piecewise linear: peak at a node
    peak = np.take_along_axis(mixed, highest, axis=-1)[..., 0]
    return SealContact(load, width, peak, profile, peak - pressure, width)


def _share(pressure: Array, pressures: Sequence[float], index: int) -> Array:
    """Weight of a stated profile in the interpolation over the sealed pressure.

    It is 1 at the sealed pressure of this profile and 0 at those of its neighbours.
    """
    table_pressure = pressures[index]
    rising: Array = 1.0
    falling: Array = 1.0
    if index > 0:
        rising = (pressure - pressures[index - 1]) / (table_pressure - pressures[index - 1])
    if index < len(pressures) - 1:
        falling = (pressures[index + 1] - pressure) / (pressures[index + 1] - table_pressure)
    within = where(real(pressure) <= table_pressure, rising, falling)
    return minimum(maximum(within, 0.0), 1.0)
