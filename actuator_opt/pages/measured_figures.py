"""A measured record over its simulation as ink: every channel, and below it what is left over."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..base.numeric import Array
from ..base.quantities import Quantity
from ..design.scenario.recorded import gaps
from ..rendering.ink import Ink
from ..simulation.measured import Overlay
from ..simulation.measured.record import beside
from .simulation_axes import LEVEL, MEASURED, STYLES, Curve, Level, Strip, stack
from .simulation_series import scaled, titled

WIDTH, TALL = 180.0, 50.0
"""Width of a figure, and height of a channel with what is left over [mm]."""
ALONE = 3
"""Channels up to which each has a whole row."""
LEFT, APART = 12.0, 6.0
"""Room for the numbers beside a channel, and between two [mm]."""
BAND = 2.0
"""Standard deviations of a sensor's noise that are drawn about zero, 95 % of its samples."""


def channel_words(name: str) -> str:
    """A channel as a page and the terminal name it.

    >>> channel_words("pressure_a"), channel_words("load_force"), channel_words("pressure_supply")
    ('pressure A', 'load force', 'supply pressure')
    """
    if name == "pressure_supply":
        return "supply pressure"
    head, _, tail = name.rpartition("_")
    return f"{head} {tail.upper()}" if len(tail) == 1 else name.replace("_", " ")


def drawn(found: Overlay) -> dict[str, tuple[Array, Array]]:
    """Channels on the time of the simulation, broken where samples are missing."""
    return {name: _broken(t - found.lag, y) for name, (t, y) in found.measured.channels.items()}


def measured_figures(found: Overlay) -> list[Ink]:
    """Every channel that was compared: figures of a row, which go on to the next sheet."""
    names = list(found.residuals)
    columns = 1 if len(names) <= ALONE else 2
    return [_row(found, names[k : k + columns], columns) for k in range(0, len(names), columns)]


def _row(found: Overlay, names: list[str], columns: int) -> Ink:
    ink = Ink(WIDTH, TALL)
    wide = (WIDTH - (columns - 1) * APART) / columns
    measured = drawn(found)
    end = float(found.simulation.time[-1])
    for k, name in enumerate(names):
        box = ((wide + APART) * k + LEFT, 0.0, wide - LEFT - 4.0, TALL)
        stack(ink, box, _strips(found, name, measured), (0.0, end))
    return ink


def _strips(
    found: Overlay, name: str, measured: Mapping[str, tuple[Array, Array]]
) -> tuple[Strip, Strip]:
    """A channel over its simulation, and what is left over with the noise of its sensor."""
    told, noise = found.simulation.told[name], found.residuals[name].noise
    time, signal = found.simulation.time, found.simulation.signals[name]
    t, y = measured[name]
    over = Curve("simulated", time, scaled(told.quantity, signal), STYLES[0])
    under = Curve("measured", t, scaled(told.quantity, y), MEASURED)
    words = channel_words(name)
    title = titled(words[:1].upper() + words[1:], told.quantity)
    left = Curve("", *_left(found, name, told.quantity), STYLES[0] | {"pen": 0.15})
    half = BAND * told.quantity.to_display(noise)
    levels = tuple(Level(f"±{BAND:g}σ of noise", way * half, LEVEL) for way in (1, -1) if half)
    below = titled("Measured less simulated", told.quantity)
    return Strip(title, (under, over)), Strip(below, (left,), levels, zero=True)


def _left(found: Overlay, name: str, quantity: Quantity) -> tuple[Array, Array]:
    """What is left over in time, in the unit shown."""
    t, y = found.measured.channels[name]
    own = t - found.lag
    time, signal = found.simulation.time, found.simulation.signals[name]
    within = (own >= time[0]) & (own <= time[-1])
    own, y = own[within], y[within]
    return _broken(own, scaled(quantity, y - beside(own, y, time, signal)))


def _broken(time: Array, values: Array) -> tuple[Array, Array]:
    """A channel with no value where samples are missing, so that no line bridges them."""
    found = gaps(time, values)
    at = np.searchsorted(time, [one.first for one in found])
    middle = [(one.first + one.last) / 2 for one in found]
    return np.insert(time, at, middle), np.insert(values, at, np.nan)
