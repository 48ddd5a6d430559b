"""The page of a calibration: measured values, changed requirements, and the best design."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..base.quantities import INPUTS, Quantity
from ..evaluation.result import count_words
from ..identification.calibration import Calibration
from ..identification.points import FrictionPoint, by_pressure
from ..optimisation.redesign import Redesign, Shift, solved
from ..rendering import text
from ..rendering.blocks import (
    Block,
    Chart,
    Column,
    Notes,
    Page,
    Pair,
    Row,
    State,
    Status,
    Table,
    Tile,
    Verdict,
    short,
    tile,
)
from ..rendering.chart import Axis, Curve, Panel, Points
from ..rendering.chart_ink import drawn
from ..rendering.ink import Ink
from ..rendering.text import sentence
from ..studies.bench import Bench
from .identification import force
from .identification_figures import FORCE, SPEED, joined, measured, speed
from .report import doubts

MOST_LEVELS, MOST_ROWS = 3, 9
"""Largest numbers of pressures and of requirements drawn (our choice, as the eye can hardly
distinguish more)."""
STATED, MEASURED = "as stated", "as measured"


def page(calibration: Calibration, redesign: Redesign, bench: Bench) -> Page:
    """The page of a calibration.

    Parameters
    ----------
    calibration : the values identified from the record
    redesign : their effect on the design
    bench : the actuator with the measured values
    """
    return Page(
        name=redesign.evaluation.name,
        kind="From test record to redesign",
        verdict=verdict(redesign),
        sentence=_sentence(calibration),
        tiles=_tiles(calibration, redesign),
        hero=lambda room: figure(calibration, redesign, bench),
        blocks=list(_blocks(calibration, redesign)),
    )


def verdict(redesign: Redesign) -> Verdict:
    """Badge at the top: whether the design meets its requirements with the measured values."""
    total = len(redesign.evaluation.requirements)
    met = sum(row.met for row in redesign.evaluation.requirements)
    lines = [f"as tested: {met} of {total} requirements met"]
    best, count = redesign.best_after, 0
    state: State
    if best is None:
        met = redesign.evaluation.met
        state, words = "missed", "REQUIREMENTS MISSED"
        if met:
            state, words = "met", "REQUIREMENTS MET"
        count = len(redesign.evaluation.tight) if met else 0
    elif solved(best):
        state, words = "met", "REDESIGN MEETS ALL"
        count = _tight(redesign)
        lines.append("the re-optimised design meets every requirement")
    else:
        state, words = "infeasible", "INFEASIBLE AS MEASURED"
        lines.append("no design meets every requirement")
    if count:
        state, words = "checks", f"{words}, {count_words(count).upper()}"
    plain, cautions = doubts(redesign.evaluation)
    return Verdict(state, words, lines + plain, cautions)


def _sentence(calibration: Calibration) -> str:
    """Sentence on the record and the Coulomb friction measured with it."""
    ratio = calibration.coulomb / calibration.stated
    return (
        f"Record {calibration.identification.record.file_name}: Coulomb friction is "
        f"{100 * ratio:.0f} % of the value that the design states at the pressures of the "
        f"record: {text.number(calibration.coulomb)} N instead of "
        f"{text.number(calibration.stated)} N."
    )


def _tiles(calibration: Calibration, redesign: Redesign) -> list[Tile]:
    """Coulomb friction, the requirement that changed most, and the objective."""
    ratio = calibration.coulomb / calibration.stated
    stated = f"stated {force(calibration.stated)}"
    largest = force(calibration.identification.largest)
    tiles = [
        tile("Coulomb friction measured", force(calibration.coulomb), stated),
        tile("measured / stated value", text.number(ratio), "one factor for all seals"),
        tile("largest friction recorded", largest, "of the filtered record"),
    ]
    moved = redesign.moved
    if moved is not None and moved.after.value is not None:
        quantity = text.metric(moved.after.metric)
        value = text.value_text(quantity, moved.after.value)
        limit = text.limit_text(quantity, moved.after.sense, moved.after.limit)
        label = short(moved.after.name.replace("_", " "), 28)
        note = f"was {text.value_text(quantity, moved.before.value)}, {limit}"
        tiles.append(tile(label, value, note, "met" if moved.after.met else "missed"))
    for goal in redesign.goals[:1]:
        if goal.after is not None:
            value, was = (text.value_text(goal.quantity, v) for v in (goal.after, goal.before))
            label = short(f"best {goal.metric.replace('_', ' ')}", 28)
            tiles.append(tile(label, value, f"was {was}"))
    return tiles


# ---- tables ----


def _blocks(calibration: Calibration, redesign: Redesign) -> Iterator[Block]:
    yield _values(calibration)
    if _moved(redesign):
        yield _shifts(redesign)
    if rows := _best(redesign):
        yield from _best_tables(rows)
    yield Notes("Changes and basis of these results", remarks(calibration, redesign))


def _values(calibration: Calibration) -> Table:
    """Every measured value with its confidence interval and the value that the design stated."""
    rows = []
    for group in calibration.learned:
        quantity, bounds = INPUTS[group.name], group.bounds()
        for path, value in group.values().items():
            numbers = (group.before[path], value, *bounds[path])
            cells = [text.value_text(quantity, number, 3) for number in numbers]
            rows.append((path, *cells, group.source))
    columns = [
        Column("value", "left", 1.0, breaks=60, mono=True, least=20),
        Column("stated", "right", drop=1),
        Column("measured", "right", strong=True),
        Column("lower", "right", drop=3),
        Column("upper", "right", drop=2),
        Column("from", drop=4),
    ]
    return Table("Values measured, 95 % bounds", columns, rows)


def _shifts(redesign: Redesign) -> Table:
    """Results for each requirement before and after the calibration, largest change first."""
    columns = [
        Column("requirement", "left", 1.0, breaks=60, mono=True, least=20),
        Column("limit", "right", drop=2),
        Column(STATED, "right", drop=1),
        Column(MEASURED, "right", strong=True),
        Column("lower", "right", drop=5),
        Column("upper", "right", drop=4),
        Column("verdict", drop=3),
    ]
    rows = [_shift(shift) for shift in _moved(redesign)]
    still = [shift.after for shift in redesign.shifts if shift.move == 0]
    note = f"{len(still)} more requirements do not depend on the measured values" if still else ""
    if missed := ", ".join(row.name for row in still if not row.met):
        note += f"; of these, missed: {missed}"
    title = "Requirements that change"
    return Table(title, columns, rows, note=f"{note}." if note else "")


def _moved(redesign: Redesign) -> list[Shift]:
    """Requirements that depend on the measured values, the largest change first."""
    moved = [shift for shift in redesign.shifts if shift.move != 0]
    return sorted(moved, key=lambda shift: -abs(shift.move))


def _shift(shift: Shift) -> Row:
    quantity = text.metric(shift.after.metric)
    values = (shift.before.value, shift.after.value, shift.lower, shift.upper)
    cells = [text.value_text(quantity, value) for value in values]
    limit = text.limit_text(quantity, shift.after.sense, shift.after.limit)
    state = shift.after.state
    return Row((shift.after.name, limit, *cells, Status(state, shift.verdict)), state)


def _best_tables(rows: Sequence[Sequence[str]]) -> Iterator[Block]:
    """The best design; on paper, a long table is split into two halves side by side."""
    columns = [
        Column("quantity", "left", 1.0, breaks=60, mono=True, least=20),
        Column(STATED, "right", drop=1),
        Column(MEASURED, "right", strong=True),
        Column("change", "right", drop=2),
    ]
    title = "The best design"
    if len(rows) < 6:
        yield Table(title, columns, rows)
        return
    yield Table(title, columns, rows, on="terminal")
    half = (len(rows) + 1) // 2
    parts = ((title, rows[:half]), (f"{title}, continued", rows[half:]))
    yield Pair([[Table(words, columns, part, on="paper")] for words, part in parts])


def _best(redesign: Redesign) -> list[tuple[str, ...]]:
    """Objective, choices and variables of the best design before and after the calibration."""
    before, after = redesign.best_before, redesign.best_after
    if before is None or after is None:
        return []
    rows = [
        _change(goal.metric, goal.quantity, goal.before, goal.after, 5) for goal in redesign.goals
    ]
    if not (solved(before) and solved(after)):
        return rows
    if after.choices is not None:
        chosen = {} if before.choices is None else before.choices.best
        rows += [
            (path, str(chosen.get(path, text.DASH)), str(value), "")
            for path, value in after.choices.best.items()
        ]
    was = {variable.path: variable.value for variable in before.variables}
    return rows + [
        _change(variable.path, INPUTS[variable.quantity], was.get(variable.path), variable.value, 4)
        for variable in after.variables
    ]


def _change(
    name: str, quantity: Quantity, old: float | None, new: float | None, digits: int
) -> tuple[str, ...]:
    known = old is not None and new is not None and old != 0
    change = text.margin_text(new / old - 1) if known else text.DASH  # type: ignore[operator]
    return name, *(text.value_text(quantity, value, digits) for value in (old, new)), change


def _tight(redesign: Redesign) -> int:
    """Number of limits that the best calibrated design meets with almost no margin."""
    best = redesign.best_after
    return len(best.tight) if best is not None and solved(best) else 0


def remarks(calibration: Calibration, redesign: Redesign) -> list[str]:
    """Sentences on changed values, on values that were not measured, and on doubts."""
    said = list(redesign.sentences)
    if count := _tight(redesign):
        words = "at the best design, which meets these limits with almost no margin"
        said.append(f"{count_words(count)} {words}")
    said += [
        f"{key} keeps the value that the design states: {why}"
        for key, why in calibration.left.items()
    ]
    said += calibration.doubts
    return [sentence(text.pretty(words)) for words in dict.fromkeys(said)]


# ---- figure ----


def figure(calibration: Calibration, redesign: Redesign, bench: Bench) -> Ink:
    """Friction over speed, and the margins before and after the calibration."""
    identification = calibration.identification
    panels = [_friction(identification.points, identification.bench, bench), _margins(redesign)]
    return drawn(Chart("Friction and margins", panels, height=64.0))


def shown_levels(points: Sequence[FrictionPoint]) -> list[list[FrictionPoint]]:
    """Points grouped by pressure, lowest first.

    Of many groups, only the lowest, the middle and the highest are returned.
    """
    groups = by_pressure(points)
    if len(groups) <= MOST_LEVELS:
        return groups
    return [groups[0], groups[len(groups) // 2], groups[-1]]


def _friction(points: Sequence[FrictionPoint], stated: Bench, measured_: Bench) -> Panel:
    """Friction over speed: measured points, and the design's curves as stated and as calibrated."""
    groups = shown_levels(points)
    curves = []
    for style, (words, bench) in enumerate(((MEASURED, measured_), (f"design {STATED}", stated))):
        for group in groups:
            speeds = [point.speed for point in group]
            along = np.geomspace(min(speeds) / 1.2, 1.2 * max(speeds), 60)
            first, second = (
                np.full(60, np.mean(pressures))
                for pressures in zip(*((p.pressure_1, p.pressure_2) for p in group), strict=True)
            )
            coulomb, viscous = bench.sliding(along, first, second)
            level = float(np.mean([point.pressure for point in group])) / 1e5
            end = f"{level:.0f} bar" if len(groups) > 1 and bench is measured_ else ""
            shown = SPEED.to_display(1.0) * along
            curves.append(Curve(words, shown, coulomb + viscous, style=style, end=end))
    return Panel(
        f"Friction over speed, {text.unit_text(FORCE.unit)}",
        Axis(f"speed, {text.unit_text(SPEED.unit)}", log=True),
        Axis(zero=True),
        curves=curves,
        points=measured([point for group in groups for point in group], speed, _against),
    )


def _against(point: FrictionPoint) -> tuple[float, float]:
    """Friction, positive if it opposes the motion, and its standard error [N]."""
    return math.copysign(1.0, point.velocity) * point.friction, point.error


def _margins(redesign: Redesign) -> Panel:
    """Margins of the changed requirements, before and after the calibration."""
    moved = _moved(redesign)[:MOST_ROWS]
    title = "Margin of requirements, as tested, %"
    if not moved:
        return Panel(title, note="No requirement changes.")
    rows = range(len(moved))
    before, after, low, high = zip(*(_span(shift) for shift in moved), strict=True)
    links = joined([((a, b), (k, k)) for a, b, k in zip(before, after, rows, strict=True)])
    return Panel(
        title,
        Axis("margin, %", zero=True),
        Axis(names=[shift.after.name for shift in moved]),
        curves=[Curve("", *links, weight="guide")],
        points=[
            Points(STATED, before, rows, style=2),
            Points(f"{MEASURED}, bar: 95 %", after, rows, low, high, style=3, across=True),
        ],
    )


def _span(shift: Shift) -> tuple[float, float, float, float]:
    """Margin before, margin after, and confidence bounds of the margin after [%]."""
    before, after = (100 * (row.margin or 0.0) for row in (shift.before, shift.after))
    if shift.lower is None or shift.upper is None or shift.after.limit == 0:
        return before, after, after, after
    sign = 1.0 if shift.after.sense == "min" else -1.0
    limit = shift.after.limit
    low, high = sorted(100 * sign * (v - limit) / abs(limit) for v in (shift.lower, shift.upper))
    return before, after, low, high
