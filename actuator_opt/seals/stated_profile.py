"""Contact pressures that a design states for a seal of any type."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ..base.numeric import Array, array_of, maximum, minimum, real, where
from ..models import contact_profile
from .contact import SealContact


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


def contact(tables: Sequence[PressureProfile], pressure: Array) -> SealContact:
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
