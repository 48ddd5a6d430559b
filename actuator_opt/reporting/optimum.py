"""The tables of an optimisation: variables, prices with their quality, how it went, why not."""

from __future__ import annotations

from ..optimisation.result import Optimisation, Sensitivity
from . import text
from .blocks import Block, Cell, clean, column, soft, table
from .text import DASH


def variables(optimisation: Optimisation) -> Block:
    """Bounds, start and optimum of every free dimension."""
    rows: list[list[Cell]] = []
    for row in optimisation.variables:
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
                {"slot": round(min(max(place, 0.0), 1.0), 4), "at": row.at_bound or ""},
                bound,
            ]
        )
    columns = [
        column("variable", "left", 1.3, mono=True),
        column("dimension", "left", 1.1),
        column("lower", "right"),
        column("start", "right"),
        column("optimum", "right", strong=True),
        column("upper", "right"),
        column("unit"),
        column("between bounds", "left", "26mm"),
        column(""),
    ]
    held = [row.path for row in optimisation.variables if row.at_bound]
    note = f"{len(held)} of {len(rows)} variables are at a bound." if held else ""
    return table("Design variables", columns, rows, note=note)


def _parameter(row: Sensitivity, value: float | None) -> float | None:
    """A parameter in its display unit; temperatures have an offset."""
    if value is None:
        return None
    offset = 273.15 if row.unit in ("degC", "°C") else 0.0
    return value / row.scale - offset


def sensitivities(optimisation: Optimisation) -> Block:
    """Price of every limit and parameter, checked by solving again at ±10 %."""
    objective = text.metric(optimisation.objective_metric)
    rows_by_path = {row.path: row for row in optimisation.evaluation.requirements}
    per_display = objective.to_display(1.0) - objective.to_display(0.0)
    rows: list[list[Cell]] = []
    for row in optimisation.sensitivities:
        found = rows_by_path.get(row.parameter)
        unit = text.unit_text(row.unit)
        value = None if found is None else found.value
        pairs = (
            (row.predicted_10, row.resolved_10),
            (row.predicted_minus10, row.resolved_minus10),
        )
        until = text.with_unit(text.trimmed(_parameter(row, row.holds_until)), unit)
        rows.append(
            [
                soft(row.parameter.removeprefix("requirements.")),
                text.with_unit(text.trimmed(_parameter(row, row.limit)), unit),
                DASH if found is None else text.number(_parameter(row, value)),
                DASH if found is None else text.margin_text(found.margin, met=found.met),
                "●" if row.active else "",
                text.number(row.price * row.scale * per_display, 3, signed=True),
                text.number(row.percent_per_percent, 3, signed=True),
                *(text.number(text.display(objective, v)) for pair in pairs for v in pair),
                soft(until if row.next_active is None else f"{until}: {row.next_active}"),
            ]
        )
    unit = text.unit_text(objective.unit) or objective.name
    columns = [
        column("requirement or parameter", "left", 1.25, mono=True),
        column("limit", "right"),
        column("value", "right"),
        column("margin", "right"),
        column("active", "center"),
        column(f"price,\n{unit}/unit", "right"),
        column("% per\n+1 %", "right"),
        column("+10 %\npredicted", "right"),
        column("+10 %\nsolved", "right", strong=True),
        column("−10 %\npredicted", "right"),
        column("−10 %\nsolved", "right", strong=True),
        column("holds until: next active", "left", 1.05),
    ]
    return table(
        f"What each requirement costs ({objective.label}, {unit})",
        columns,
        rows,
        note=quality(optimisation),
    )


def quality(optimisation: Optimisation) -> str:
    """The quality line under the prices."""
    kkt = optimisation.kkt
    if kkt is None:
        return "Quality: no multipliers (the design is not an optimum); prices are not exact."
    return (
        f"Quality: KKT residual {text.number(kkt.residual, 2)}, {len(kkt.active)} active rows of"
        f" rank {kkt.rank}, {kkt.curvature}. Prices are per unit shown in the limit column;"
        f" {DASH} under solved: no feasible design found nearby."
    )


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
        best = min(optimisation.starts, key=lambda v: abs(v - optimisation.objective_value))
        same = sum(abs(v - best) <= 1e-3 * abs(best) for v in optimisation.starts)
        found = ", ".join(text.value_text(objective, v) for v in optimisation.starts[:8])
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
            f"{text.value_text(objective, value)} ({text.margin_text(worst)} at {count})"
            for count, value, worst in picked
        )
        lines.append(f"Improvements (worst margin at evaluation): {path}.")
    if optimisation.kkt is not None and optimisation.kkt.active:
        lines.append(f"Active at the optimum: {', '.join(optimisation.kkt.active)}.")
    return lines
