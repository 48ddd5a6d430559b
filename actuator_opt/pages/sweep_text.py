"""What a sweep came to, in the terminal."""

from __future__ import annotations

from ..base.quantities import Quantity
from ..design.paths import quantity_of
from ..evaluation.reserve import NO_RESERVE
from ..rendering import text
from ..rendering.blocks import Column
from ..rendering.console import Console
from ..sweeps import Best, Swept

FAILURES = 3
"""Most reasons of failed designs that are told."""


def sweep_text(
    swept: Swept, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Counts, the best feasible designs, why designs failed."""
    console = Console(colour, unicode, width)
    study = swept.study
    rate = swept.computed / swept.seconds if swept.seconds > 0 else 0.0
    lines = [
        console.heading(f"{study.design.name}: {swept.requested} variants"),
        f"{counts(swept)} ({swept.seconds:.1f} s, {rate:.0f}/s)",
    ]
    if swept.best:
        lines += ["", *_table(console, swept)]
    else:
        lines += ["", console.wrap(_nothing(swept))]
    if swept.damaged:
        rows = "1 row" if swept.damaged == 1 else f"{swept.damaged} rows"
        lines.append(console.wrap(f"{rows} in the store were damaged and computed again."))
    reasons = sorted(swept.failures.items(), key=lambda one: (-one[1], one[0]))
    for reason, times in reasons[:FAILURES]:
        lines.append(console.wrap(f"failed: {times} times {reason}"))
    if len(reasons) > FAILURES:
        lines.append(f"and {len(reasons) - FAILURES} more reasons")
    return "\n".join(lines) + "\n"


def counts(swept: Swept) -> str:
    """How many were computed, failed, are feasible; of the best alone, how many looked at."""
    if swept.feasible is None:
        looked = swept.computed - swept.screened
        return f"{swept.screened} ruled out early, {looked} evaluated in full"
    reused = f", {swept.reused} reused" if swept.reused else ""
    return f"{swept.computed} computed{reused}, {swept.failed} failed, {swept.feasible} feasible"


def _nothing(swept: Swept) -> str:
    if swept.feasible:
        return f"None of the {swept.feasible} feasible ones has a value of the objective."
    missed = sorted(swept.missed.items(), key=lambda one: (-one[1], one[0]))
    if not missed:
        return "None of them has a finite answer."
    name, times = missed[0]
    whom = "them" if swept.feasible is not None else f"{sum(swept.missed.values())} looked at"
    words = (
        f"None meets every requirement and check; {name} is missed furthest in {times} of {whom}"
    )
    return f"{words}. Widen what varies, or see why with `optimise`."


def _table(console: Console, swept: Swept) -> list[str]:
    """The best designs: what varies, the objective, the least margin."""
    study = swept.study
    goal = list(study.goal.weights)
    axes = [axis.path for axis in study.plan.axes]
    told: dict[str, Quantity | None] = {
        axis.path: None if axis.values is None else quantity_of(axis.path, study.design)
        for axis in study.plan.axes
    }
    columns = [
        Column("", "right"),
        *(Column(_head(_short(path, axes), told[path]), "right", width=1.0) for path in axes),
        *(Column(_head(name, study.quantity(name)), "right") for name in goal),
        Column("least margin", "right"),
    ]
    rows = []
    for place, best in enumerate(swept.best, start=1):
        values = swept.values(best)
        rows.append(
            [
                str(place),
                *(_cell(values[path], told[path]) for path in axes),
                *(_metric(swept, best, name) for name in goal),
                text.margin_text(best.margin),
            ]
        )
    tight = [best.margin < NO_RESERVE for best in swept.best]
    styles = [[""] * (len(columns) - 1) + ["yellow" if one else ""] for one in tight]
    lines = console.table(columns, rows, styles)
    if any(tight):
        words = f"{sum(tight)} of these without reserve: least margin below {100 * NO_RESERVE:g} %"
        lines.append(console.wrap(words, "yellow"))
    return lines


def _head(name: str, quantity: Quantity | None) -> str:
    return f"{name}, {quantity.unit}" if quantity is not None and quantity.unit else name


def _short(path: str, paths: list[str]) -> str:
    """The last words of a PATH that no other of them has."""
    parts = path.split(".")
    for count in range(1, len(parts)):
        tail = ".".join(parts[-count:])
        if not any(one != path and one.endswith(f".{tail}") for one in paths):
            return tail
    return path


def _cell(value: float | str, quantity: Quantity | None) -> str:
    if quantity is None or isinstance(value, str):
        return str(value)
    return text.number(quantity.to_display(value))


def _metric(swept: Swept, best: Best, name: str) -> str:
    value = swept.metrics(best)[name]
    return text.number(text.display(swept.study.quantity(name), value))
