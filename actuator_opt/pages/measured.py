"""Blocks of a page about a measured record: fitted parameters, residuals, the record as drawn."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from ..base.numeric import Array
from ..base.quantities import Quantity
from ..design.scenario.reader import gaps
from ..rendering.blocks import Block, Column, Drawing, Notes, Table, short
from ..rendering.ink import Ink
from ..rendering.strips import LEVEL, MEASURED, STYLES, ConstantLevel, Strip, StripCurve, stack
from ..rendering.text import (
    DASH,
    decimals,
    fixed,
    number,
    pretty,
    sentence,
    trimmed,
    unit_text,
    with_unit,
)
from ..simulation.measured import Overlay
from ..simulation.measured.fit import Fit, Fitted
from ..simulation.measured.record import beside
from .simulation import tied
from .simulation_figures import scaled, titled

MOST_PLACES = 6
"""Decimals of a bias, at most."""
WIDTH, TALL = 180.0, 50.0
"""Width of a figure, and height of a channel with its residual [mm]."""
ALONE = 3
"""Channels up to which each has a whole row."""
LEFT, APART = 12.0, 6.0
"""Room for the numbers beside a channel, and between two [mm]."""
BAND = 2.0
"""Standard deviations of a sensor's noise that are drawn about zero, 95 % of its samples."""


def blocks(overlay: Overlay, fit: Fit | None) -> list[Block]:
    """Parameters of a fit, residuals, remarks, and every channel over its simulation."""
    made: list[Block] = [] if fit is None else [_parameters(fit)]
    made.append(_residuals(overlay, None if fit is None else fit.before))
    sentences = remarks(overlay, fit)
    if sentences:
        title = "What to know of the record"
        made.append(Notes(title, [tied(words) for words in sentences], style="yellow"))
    for k, ink in enumerate(measured_figures(overlay)):
        made.append(Drawing("The record over the simulation" if k == 0 else "", ink))
    return made


def drawn(overlay: Overlay) -> dict[str, tuple[Array, Array]]:
    """Channels on the time of the simulation, broken where samples are missing."""
    channels = overlay.measured.channels.items()
    return {name: _broken(time - overlay.lag, values) for name, (time, values) in channels}


def channel_words(name: str) -> str:
    """A channel as printed.

    >>> channel_words("pressure_a"), channel_words("load_force"), channel_words("pressure_supply")
    ('pressure A', 'load force', 'supply pressure')
    """
    if name == "pressure_supply":
        return "supply pressure"
    head, _, tail = name.rpartition("_")
    return f"{head} {tail.upper()}" if len(tail) == 1 else name.replace("_", " ")


# ---- tables ----


def _residuals(overlay: Overlay, before: Overlay | None) -> Table:
    """A row for every channel, in its own unit; of a fit with the residual before it."""
    columns = [
        Column("channel", width=1.0, breaks=14, least=10),
        Column("unit", style="dim"),
        Column("rms", "right", style="bold"),
        Column("noise", "right", style="dim", drop=2),
        Column("largest", "right", style="dim", drop=1),
        Column("at", "right", style="dim", drop=5),
        Column("bias", "right", style="dim", drop=4),
        Column("rms/span", "right", style="dim", drop=3),
    ]
    if before is not None:
        columns.append(Column("rms before", "right", style="dim", drop=6))
    rows = []
    for name, residual in overlay.residuals.items():
        quantity = overlay.simulation.told[name].quantity
        places = decimals(quantity.to_display(residual.rms), 2)
        bias = quantity.to_display(residual.bias)
        row = [
            channel_words(name),
            unit_text(quantity.unit),
            number(quantity.to_display(residual.rms), 3),
            number(quantity.to_display(residual.noise), 2),
            number(quantity.to_display(residual.largest), 3),
            f"{number(residual.time, 3)} s",
            fixed(bias, places) if 0 < places <= MOST_PLACES else number(bias, 2),
            DASH if residual.relative is None else f"{number(100 * residual.relative, 2)} %",
        ]
        if before is not None:
            old = before.residuals.get(name)
            row.append(DASH if old is None else number(quantity.to_display(old.rms), 3))
        rows.append(row)
    file = short(Path(overlay.measured.name).name, 60)
    return Table(f"Measured less simulated: {file}", columns, rows)


def _parameters(fit: Fit) -> Table:
    """A row for every fitted parameter; its unit stands with the fitted value."""
    columns = [
        Column("parameter", width=1.0, breaks=14),
        Column("start", "right", style="dim", drop=3),
        Column("fitted", "right", style="bold"),
        Column("95 % from", "right", style="dim", drop=1),
        Column("to", "right", style="dim", drop=2),
        Column("verdict", breaks=14),
    ]
    rows = []
    for name, fitted in fit.parameters.items():
        quantity, parameter = fitted.entry.quantity, fitted.parameter
        ends = (parameter.value, parameter.lower, parameter.upper)
        values = [quantity.to_display(x) for x in ends]
        half = values[2] - values[0]
        value, *bounds = (_significant(x, half) for x in values)
        rows.append(
            [
                name.replace("_", " "),
                trimmed(quantity.to_display(fitted.entry.start), 3),
                with_unit(value, unit_text(quantity.unit)),
                *bounds,
                _verdict(fitted, missed=bool(fit.missed)),
            ]
        )
    return Table("Fitted to the record", columns, rows)


def _significant(value: float, half: float) -> str:
    """A number with two digits of its uncertainty `half`; a dash without bounds."""
    if not math.isfinite(value):
        return DASH
    if value == 0 or half == 0 or not math.isfinite(half):
        return number(value, 4)
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(abs(half))) + 2
    return number(value, min(max(digits, 2), 8))


def _verdict(fitted: Fitted, *, missed: bool) -> str:
    if fitted.at_bound is not None:
        return f"at its {fitted.at_bound} end"
    if not fitted.parameter.identifiable:
        return fitted.parameter.verdict
    return "if the model were right" if missed else "identified"


def remarks(overlay: Overlay, fit: Fit | None) -> list[str]:
    """Notes of the record, doubts of the fit, and the lag, as sentences."""
    words = [*overlay.notes, *(() if fit is None else fit.doubts)]
    if overlay.lag:
        way = "late" if overlay.lag > 0 else "early"
        words.append(f"the record comes {number(1e3 * abs(overlay.lag), 3)} ms {way}")
    return [sentence(pretty(remark)) for remark in words]


# ---- figures ----


def measured_figures(overlay: Overlay) -> Iterator[Ink]:
    """Every channel that was compared: a figure for every row, so that rows may change sheets."""
    names = list(overlay.residuals)
    columns = 1 if len(names) <= ALONE else 2
    wide = (WIDTH - (columns - 1) * APART) / columns
    channels = drawn(overlay)
    end = float(overlay.simulation.time[-1])
    for first in range(0, len(names), columns):
        ink = Ink(WIDTH, TALL)
        for k, name in enumerate(names[first : first + columns]):
            box = ((wide + APART) * k + LEFT, 0.0, wide - LEFT - 4.0, TALL)
            stack(ink, box, _strips(overlay, name, channels), (0.0, end))
        yield ink


def _strips(
    overlay: Overlay, name: str, channels: Mapping[str, tuple[Array, Array]]
) -> tuple[Strip, Strip]:
    """A channel over its simulation, and its residual with the noise of the sensor."""
    quantity, noise = overlay.simulation.told[name].quantity, overlay.residuals[name].noise
    time, signal = overlay.simulation.time, overlay.simulation.signals[name]
    recorded, values = channels[name]
    over = StripCurve("simulated", time, scaled(quantity, signal), STYLES[0])
    under = StripCurve("measured", recorded, scaled(quantity, values), MEASURED)
    words = channel_words(name)
    title = titled(words[:1].upper() + words[1:], quantity)
    residual = StripCurve("", *_residual(overlay, name, quantity), STYLES[0] | {"pen": 0.15})
    half = BAND * quantity.to_display(noise)
    levels = tuple(
        ConstantLevel(f"±{BAND:g}σ of noise", way * half, LEVEL) for way in (1, -1) if half
    )
    below = titled("Measured less simulated", quantity)
    return Strip(title, (under, over)), Strip(below, (residual,), levels, zero=True)


def _residual(overlay: Overlay, name: str, quantity: Quantity) -> tuple[Array, Array]:
    """The residual over time, in the unit shown."""
    recorded, values = overlay.measured.channels[name]
    own = recorded - overlay.lag
    time, signal = overlay.simulation.time, overlay.simulation.signals[name]
    within = (own >= time[0]) & (own <= time[-1])
    own, values = own[within], values[within]
    return _broken(own, scaled(quantity, values - beside(own, values, time, signal)))


def _broken(time: Array, values: Array) -> tuple[Array, Array]:
    """A channel without a value where samples are missing, so that no line bridges them."""
    missing = gaps(time, values)
    at = np.searchsorted(time, [gap.first for gap in missing])
    middle = [(gap.first + gap.last) / 2 for gap in missing]
    return np.insert(time, at, middle), np.insert(values, at, np.nan)
