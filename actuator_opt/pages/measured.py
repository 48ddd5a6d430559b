"""Blocks of a page about a measured record: fitted parameters, residuals, and charts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..base.numeric import Array
from ..base.quantities import Quantity
from ..design.scenario.reader import gaps
from ..rendering.blocks import Block, Chart, Column, Notes, Table, short
from ..rendering.chart import Axis, Curve, Level, Panel
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
from .simulation_figures import CONSTANT, curve, scaled, timed, titled

MOST_PLACES = 6
"""Largest number of decimals with which a bias (mean residual) is printed."""
TALL = 50.0
"""Height of the chart of a channel with its residual [mm]."""
ALONE = 3
"""Up to this number of channels, each channel has a row of its own; more channels share rows."""
BAND = 2.0
"""Half width of the drawn noise band in standard deviations; the band contains 95 % of samples."""


def blocks(overlay: Overlay, fit: Fit | None) -> list[Block]:
    """Parameters of a fit, residuals, remarks, and every channel drawn with its simulation."""
    made: list[Block] = [] if fit is None else [_parameters(fit)]
    made.append(_residuals(overlay, None if fit is None else fit.before))
    sentences = remarks(overlay, fit)
    if sentences:
        title = "Notes on the record"
        made.append(Notes(title, [tied(words) for words in sentences], style="yellow"))
    return [*made, *measured_charts(overlay)]


def drawn(overlay: Overlay) -> dict[str, tuple[Array, Array]]:
    """Measured channels over the time of the simulation, with gaps where samples are missing."""
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
    """Table of residuals, a row per channel; after a fit, also the residual before the fit."""
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
    return Table(f"Measured minus simulated: {file}", columns, rows)


def _parameters(fit: Fit) -> Table:
    """Table with a row for every fitted parameter; its unit is printed with the fitted value."""
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
    """A number rounded to the second digit of its uncertainty `half`; a dash if not finite."""
    if not math.isfinite(value):
        return DASH
    if value == 0 or half == 0 or not math.isfinite(half):
        return number(value, 4)
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(abs(half))) + 2
    return number(value, min(max(digits, 2), 8))


def _verdict(fitted: Fitted, *, missed: bool) -> str:
    if fitted.at_bound is not None:
        return f"at its {fitted.at_bound} bound"
    if not fitted.parameter.identifiable:
        return fitted.parameter.verdict
    return "identified if the model is exact" if missed else "identified"


def remarks(overlay: Overlay, fit: Fit | None) -> list[str]:
    """Sentences on the record, on doubts about the fit, and on the lag of the record."""
    words = [*overlay.notes, *(() if fit is None else fit.doubts)]
    if overlay.lag:
        way = "late" if overlay.lag > 0 else "early"
        words.append(
            f"the record is {number(1e3 * abs(overlay.lag), 3)} ms {way} against the simulation; "
            "this is corrected"
        )
    return [sentence(pretty(remark)) for remark in words]


# ---- figures ----


def measured_charts(overlay: Overlay) -> list[Chart]:
    """Charts of every compared channel.

    Each row is a chart, so that a page break may fall between rows.
    """
    names = list(overlay.residuals)
    columns = 1 if len(names) <= ALONE else 2
    channels = drawn(overlay)
    panels = [_panels(overlay, name, channels) for name in names]
    return [
        Chart(
            "Measured and simulated signals" if first == 0 else "",
            panels[first : first + columns],
            height=TALL,
        )
        for first in range(0, len(names), columns)
    ]


def _panels(
    overlay: Overlay, name: str, channels: Mapping[str, tuple[Array, Array]]
) -> list[Panel]:
    """A channel with its simulation, and the residual with the noise band of the sensor."""
    simulation = overlay.simulation
    quantity, noise = simulation.told[name].quantity, overlay.residuals[name].noise
    time, values = channels[name]
    words = channel_words(name)
    record = Curve("measured", time, scaled(quantity, values), weight="broad")
    half = BAND * quantity.to_display(noise)
    levels = [Level(way * half, f"±{BAND:g}σ of noise", style=CONSTANT) for way in (1, -1) if half]
    span = (0.0, float(simulation.time[-1]))
    above = Panel(
        titled(words[:1].upper() + words[1:], quantity),
        curves=[record, curve(simulation, name, "simulated")],
    )
    below = Panel(
        titled("Measured minus simulated", quantity),
        y=Axis(zero=True),
        curves=[Curve("", *_residual(overlay, name, quantity), weight="thin")],
        levels=levels,
    )
    return [replace(timed(above, span), x=Axis()), timed(below, span)]


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
