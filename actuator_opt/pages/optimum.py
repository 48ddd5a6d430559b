"""The tables of an optimisation: variables, prices with their quality, how it went, why not."""

from __future__ import annotations

from ..optimisation.result import Optimisation
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Slot, Table, clean, soft


def variables(optimisation: Optimisation) -> Block:
    """Bounds, start and best value of every free dimension."""
    rows: list[list[Cell]] = []
    for row in optimisation.best_variables:
        quantity = text.input_quantity(row.quantity)
        lower, upper, value = (quantity.to_display(v) for v in (row.lower, row.upper, row.value))
        start = None if row.start is None else quantity.to_display(row.start)
        place = (value - lower) / (upper - lower) if upper > lower else 0.0
        bound = "" if row.at_bound is None else f"at {row.at_bound} bound"
        rows.append(
            [
                soft(row.path),
                clean(quantity.label),
                text.trimmed(lower),
                text.number(start),
                text.number(value),
                text.trimmed(upper),
                text.unit_text(quantity.unit),
                Slot(place, row.at_bound or ""),
                bound,
            ]
        )
    columns = [
        Column("variable", "left", 1.3, mono=True),
        Column("dimension", "left", 1.1),
        Column("lower", "right"),
        Column("start", "right"),
        Column(heading(optimisation).replace(" ", "\n"), "right", strong=True),
        Column("upper", "right"),
        Column("unit"),
        Column("between bounds", "left", "26mm"),
        Column(""),
    ]
    held = [row.path for row in optimisation.best_variables if row.at_bound]
    note = f"{len(held)} of {len(rows)} variables are at a bound." if held else ""
    return Table("Design variables", columns, rows, note=note)


def heading(optimisation: Optimisation) -> str:
    """What the values shown are: the optimum, or the sizes asked for."""
    if optimisation.rounding is None:
        return "optimum"
    return "continuous" if optimisation.made is None else optimisation.made.name


def sentence(words: str) -> str:
    """Words with a capital letter and a full stop; a name as pressure_a stays as it is.

    >>> sentence("optimum found"), sentence("pressure_a: left out")
    ('Optimum found.', 'pressure_a: left out.')
    """
    words = words.strip()
    if not words:
        return ""
    first = words[0] if "_" in words.split()[0] else words[0].upper()
    return first + words[1:] + ("" if words[-1] in ".!?" else ".")


def convergence(optimisation: Optimisation) -> list[str]:
    """Algorithm, effort, starts and trace, in sentences. Wall time is left out: same bytes."""
    objective = text.metric(optimisation.objective_metric)
    lines = [
        f"{optimisation.algorithm}, seed {optimisation.seed},"
        f" {optimisation.evaluations} evaluations."
    ]
    if optimisation.infeasibility is not None:
        count = len(optimisation.starts)
        lines.append(f"None of {count} starts led to a design that meets every requirement.")
    elif optimisation.starts:
        best = optimisation.objective_value
        same = sum(v is not None and abs(v - best) <= 1e-3 * abs(best) for v in optimisation.starts)
        found = ", ".join(
            "none" if v is None else text.value_text(objective, v) for v in optimisation.starts[:8]
        )
        more = ", …" if len(optimisation.starts) > 8 else ""
        lines.append(
            f"{same} of {len(optimisation.starts)} starts reached the same optimum within 0.1 %:"
            f" {found}{more}."
        )
    if optimisation.trace:
        steps = optimisation.trace
        picked = [
            steps[k] for k in sorted({0, len(steps) // 3, 2 * len(steps) // 3, -1 % len(steps)})
        ]
        path = " → ".join(
            f"{text.value_text(objective, value)} ({_missed(violation)} at {count})"
            for count, value, violation in picked
        )
        lines.append(f"Improvements (limits at evaluation): {path}.")
    if optimisation.kkt is not None and optimisation.kkt.active:
        lines.append(f"Active at the optimum: {', '.join(optimisation.kkt.active)}.")
    return lines


def _missed(violation: float) -> str:
    """How far a design misses its limits, in words."""
    return "all met" if violation <= 1e-6 else f"missed by {text.number(100 * violation, 2)} %"
