"""What a measured record says of a simulation: residuals, and fitted parameters, in rows."""

from __future__ import annotations

from collections.abc import Sequence

from ..simulation.measured import Overlay
from ..simulation.measured.fit import Fit
from .blocks import ExtraTable
from .console import Column, Console
from .text import DASH, pretty

RESIDUALS = ("channel", "rms", "largest", "at", "bias", "rms over span", "noise")
PARAMETERS = ("parameter", "before", "fitted", "95 % from", "to", "verdict")


def residual_rows(found: Overlay) -> list[tuple[str, ...]]:
    """A row for every channel, in its own unit."""
    rows: list[tuple[str, ...]] = []
    for name, one in found.residuals.items():
        told = found.simulation.told[name]
        say = told.quantity.text
        relative = DASH if one.relative is None else f"{100 * one.relative:.2g} %"
        rows.append(
            (
                told.label,
                say(one.rms, 3),
                say(one.largest, 3),
                f"{one.time:.4g} s",
                say(one.bias, 2),
                relative,
                say(one.noise, 2),
            )
        )
    return rows


def parameter_rows(found: Fit) -> list[tuple[str, ...]]:
    """A row for every fitted parameter, in its own unit."""
    fit_misses = bool(found.missed)
    rows: list[tuple[str, ...]] = []
    for name, one in found.parameters.items():
        own, quantity = one.parameter, one.entry.quantity
        bounds = [quantity.text(x, 3) if abs(x) < 1e300 else DASH for x in (own.lower, own.upper)]
        verdict = "identified" if own.identifiable else "not identifiable here"
        if fit_misses and own.identifiable:
            verdict = "if the model were right"
        if one.at_bound is not None:
            verdict = f"at its {one.at_bound} end"
        start = quantity.text(one.entry.start, 3)
        value = quantity.text(own.value, 4)
        rows.append((name.replace("_", " "), start, value, *bounds, verdict))
    return rows


def remarks(overlay: Overlay, fit: Fit | None) -> list[str]:
    """What the numbers alone do not say."""
    said = [*overlay.notes, *(() if fit is None else fit.doubts)]
    if overlay.lag:
        said.append(f"the record comes {1e3 * overlay.lag:.3g} ms late")
    return [pretty(one) for one in said]


def measured_tables(overlay: Overlay, fit: Fit | None) -> tuple[ExtraTable, ...]:
    """Tables of a report: what is left over, and the parameters."""
    note = " ".join(one[:1].upper() + one[1:] + "." for one in remarks(overlay, fit))
    title = f"Measured less simulated: {overlay.measured.name}"
    tables = []
    if fit is not None:
        tables.append(ExtraTable("Fitted to the record", PARAMETERS, parameter_rows(fit)))
        before = {name: one.rms for name, one in fit.before.residuals.items()}
        less = [
            f"{overlay.simulation.told[name].label} from {_of(overlay, name, before[name])}"
            for name in overlay.residuals
            if name in before
        ]
        note = f"After the fit; rms before: {', '.join(less)}. {note}".strip()
    return (*tables, ExtraTable(title, RESIDUALS, residual_rows(overlay), note))


def _of(overlay: Overlay, name: str, value: float) -> str:
    return overlay.simulation.told[name].quantity.text(value, 3)


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
        parts += [
            console.heading("fitted parameters"),
            _table(console, PARAMETERS, parameter_rows(fit)),
        ]
    parts += [
        console.heading("measured less simulated"),
        _table(console, RESIDUALS, residual_rows(overlay)),
    ]
    parts += [console.wrap(one, "dim") for one in remarks(overlay, fit)]
    return "\n".join(parts) + "\n"


def _table(console: Console, heads: Sequence[str], body: Sequence[Sequence[str]]) -> str:
    columns = [Column(heads[0], flexible=True, least=16)]
    columns += [Column(head, "right") for head in heads[1:]]
    rows = [[console.say(cell) for cell in row] for row in body]
    styles = [["", *["bold" if k == 0 else "dim" for k in range(len(heads) - 1)]]] * len(rows)
    return "\n".join(console.table(columns, rows, styles))
