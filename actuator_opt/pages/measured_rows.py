"""What a measured record says of a simulation: residuals, and fitted parameters, in rows."""

from __future__ import annotations

import math
from pathlib import Path

from ..base.quantities import Quantity
from ..rendering.blocks import Block, Cell, Column, Drawing, Notes, Table, short, soft
from ..rendering.console import Console
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
from .measured_figures import channel_words, measured_figures
from .simulation_words import tied

RESIDUALS = ("channel", "unit", "rms", "noise", "largest", "at", "bias", "rms/span", "rms before")
"""Heads of the residuals; the last one of a fit."""
DROPS = (0, 0, 0, 2, 1, 5, 4, 3, 6)
"""Which of them a narrow terminal leaves out first."""
PARAMETERS = ("parameter", "unit", "start", "fitted", "95 % from", "to", "verdict")
MOST_PLACES = 6
"""Decimals of a bias, at most."""


def residual_rows(found: Overlay, before: Overlay | None = None) -> list[list[str]]:
    """A row for every channel, in its own unit."""
    rows = []
    for name, one in found.residuals.items():
        quantity = found.simulation.told[name].quantity

        def say(value: float, digits: int = 3, quantity: Quantity = quantity) -> str:
            return number(quantity.to_display(value), digits)

        places = decimals(quantity.to_display(one.rms), 2)
        bias = quantity.to_display(one.bias)
        row = [
            channel_words(name),
            unit_text(quantity.unit),
            say(one.rms),
            say(one.noise, 2),
            say(one.largest),
            f"{number(one.time, 3)} s",
            fixed(bias, places) if 0 < places <= MOST_PLACES else number(bias, 2),
            DASH if one.relative is None else f"{number(100 * one.relative, 2)} %",
        ]
        if before is not None:
            old = before.residuals.get(name)
            row.append(DASH if old is None else say(old.rms))
        rows.append(row)
    return rows


def parameter_rows(found: Fit) -> list[list[str]]:
    """A row for every fitted parameter, in its own unit."""
    rows = []
    for name, one in found.parameters.items():
        quantity, own = one.entry.quantity, one.parameter
        values = [quantity.to_display(x) for x in (own.value, own.lower, own.upper)]
        half = values[2] - values[0]
        rows.append(
            [
                name.replace("_", " "),
                unit_text(quantity.unit),
                trimmed(quantity.to_display(one.entry.start), 3),
                *(_known(value, half) for value in values),
                _verdict(one, missed=bool(found.missed)),
            ]
        )
    return rows


def _known(value: float, half: float) -> str:
    """A number with two digits of what it is uncertain by; a dash where nothing bounds it."""
    if not math.isfinite(value):
        return DASH
    if value == 0 or half == 0 or not math.isfinite(half):
        return number(value, 4)
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(abs(half))) + 2
    return number(value, min(max(digits, 2), 8))


def _verdict(one: Fitted, *, missed: bool) -> str:
    if one.at_bound is not None:
        return f"at its {one.at_bound} end"
    if not one.parameter.identifiable:
        return one.parameter.verdict
    return "if the model were right" if missed else "identified"


def remarks(overlay: Overlay, fit: Fit | None) -> list[str]:
    """What the numbers alone do not say, in full sentences."""
    said = [*overlay.notes, *(() if fit is None else fit.doubts)]
    if overlay.lag:
        way = "late" if overlay.lag > 0 else "early"
        said.append(f"the record comes {number(1e3 * abs(overlay.lag), 3)} ms {way}")
    return [sentence(pretty(one)) for one in said]


def measured_blocks(overlay: Overlay, fit: Fit | None) -> list[Block]:
    """Blocks of a page: the parameters, what is left over, the channels, and what to know."""
    blocks = []
    if fit is not None:
        blocks.append(_block("Fitted to the record", PARAMETERS, parameter_rows(fit)))
    rows = residual_rows(overlay, None if fit is None else fit.before)
    title = f"Measured less simulated: {short(Path(overlay.measured.name).name, 60)}"
    blocks.append(_block(title, RESIDUALS[: len(rows[0])], rows))
    said = remarks(overlay, fit)
    if said:
        blocks.append(Notes("What to know of the record", [tied(one) for one in said]))
    for k, ink in enumerate(measured_figures(overlay)):
        blocks.append(Drawing("The record over the simulation" if k == 0 else "", ink))
    return blocks


def _block(title: str, heads: tuple[str, ...], rows: list[list[str]]) -> Block:
    columns = [Column(heads[0], "left", 1.0), Column(heads[1], "left")]
    columns += [Column(head, "left" if head == "verdict" else "right") for head in heads[2:]]
    body: list[list[Cell]] = [[soft(cell) for cell in row] for row in rows]
    return Table(title, columns, body)


def measured_text(
    overlay: Overlay,
    fit: Fit | None,
    *,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """What `--measured` and `--fit` show."""
    console = Console(colour, unicode, width)
    parts = []
    if fit is not None:
        parts += [console.heading("fitted parameters"), *_parameters(console, fit), ""]
    rows = residual_rows(overlay, None if fit is None else fit.before)
    columns = [
        Column(
            head, "left" if k < 2 else "right", width=1.0 if k == 0 else "auto", drop=drop, least=10
        )
        for k, (head, drop) in enumerate(zip(RESIDUALS, DROPS, strict=True))
    ][: len(rows[0])]
    styles = [["", "dim", "bold", *["dim"] * (len(columns) - 3)]] * len(rows)
    parts += [
        console.heading("measured less simulated"),
        *console.table(columns, rows, styles),
        *(console.wrap(one, "yellow") for one in remarks(overlay, fit)),
    ]
    return "\n".join(parts) + "\n"


def _parameters(console: Console, fit: Fit) -> list[str]:
    """Fitted parameters as a table, or as sentences where there is no room."""
    rows = parameter_rows(fit)
    drops = (0, 0, 2, 0, 0, 0, 1)
    columns = [
        Column(
            head,
            "left" if k in (0, 1, 6) else "right",
            width=1.0 if k == 0 else "auto",
            drop=drop,
            least=14,
        )
        for k, (head, drop) in enumerate(zip(PARAMETERS, drops, strict=True))
    ]
    styles = [["", "dim", "dim", "bold", "dim", "dim", ""]] * len(rows)
    lines = console.table(columns, rows, styles)
    if PARAMETERS[-1] in lines[0]:
        return lines
    return [
        console.wrap(
            f"{name} {with_unit(value, unit)}, 95 % from {low} to {high}; start {start}; {verdict}"
        )
        for name, unit, start, value, low, high, verdict in rows
    ]
