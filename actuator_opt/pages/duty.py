"""Duty cycles in a report: overview, fatigue, where margins are least, and the traces as CSV."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.quantities import INPUTS, Quantity, Sense
from ..evaluation.duty_cycles.study import CycleStudy, DutyStudy
from ..evaluation.duty_cycles.thermal import MEAN
from ..evaluation.result import Evaluation
from ..metrics import METRICS
from ..models.wear import SHORT_STROKE
from ..rendering.axes import per_cent
from ..rendering.blocks import (
    Block,
    Cell,
    Column,
    Notes,
    Row,
    Share,
    State,
    Table,
    clean,
    soft,
)
from ..rendering.series import Series, heading
from ..rendering.text import DASH, limit_text, number, pretty, trimmed, value_text
from .duty_figures import (
    ANGLE,
    ARM,
    DAMAGE,
    ENERGY,
    FLOW,
    FORCE,
    LENGTH,
    OPENING,
    POWER,
    PRESSURE,
    SPEED,
    TEMPERATURE,
    TORQUE,
    balance_of,
    duration_words,
    efficiency_of,
    figure,
    nearest,
    time_of,
    trace_of,
    value_of,
    warming_chart,
)

MOST_SHEETS = 6
"""Largest number of cycles with a figure of their own: those that need most of their supply."""
FEWEST_PARTS, MOST_PARTS = 3, 10
"""Least and largest number of parts in the table of fatigue; between them, only parts whose bar is
not empty are listed."""
MOST_ON_CARD = 3
"""Largest number of cycles on the card."""
RISE = INPUTS["temperature_rise"]
COLD = "from cold"
"""Words after the name of a cycle in the CSV file, at the rows of its temperatures."""
LEAST_DAMAGE = 1e-9
"""Damage at which the logarithmic bar is empty (our choice)."""
_COLUMNS: tuple[tuple[str, str, Quantity], ...] = (
    ("joint_angle", "angle", ANGLE),
    ("joint_torque", "torque", TORQUE),
    ("lever_arm", "arm", ARM),
    ("position", "position", LENGTH),
    ("force", "force", FORCE),
    ("speed", "speed", SPEED),
    ("power", "power", POWER),
    ("supply_pressure", "supply", PRESSURE),
    ("pressure_a", "pressure_a", PRESSURE),
    ("pressure_b", "pressure_b", PRESSURE),
    ("friction", "friction", FORCE),
    ("supply_pressure_needed", "needed", PRESSURE),
    ("force_reserve", "reserve", FORCE),
    ("valve_opening", "opening", OPENING),
    ("leakage", "leakage", FLOW),
    ("supply_flow", "flow", FLOW),
)
"""Columns of the CSV file: name, trace and quantity."""


def duty_blocks(evaluation: Evaluation) -> list[Block]:
    """All blocks on the duty cycles; empty if the design states none."""
    study = evaluation.duty
    if study is None:
        return []
    blocks: list[Block] = [_overview(study), *_fatigue(evaluation, study), *_warming(study)]
    blocks.append(_basis(study))
    for cycle in _shown(study):
        blocks += [figure(evaluation.lengths, study, cycle), _margins(evaluation, study, cycle)]
        blocks.append(_energies(cycle))
    return blocks


def shortfall_blocks(evaluation: Evaluation) -> list[Table]:
    """Shortages of the duty cycles, with sufficient changes; empty if they miss no check."""
    study = evaluation.duty
    if study is None or not study.shortfalls:
        return []
    rows: list[Sequence[Cell]] = [
        [pretty(clean(words)) for words in (shortfall.reason, shortfall.cures)]
        for shortfall in study.shortfalls
    ]
    columns = [
        Column("what lacks", "left", 1.0, least=34, wraps=True),
        Column("enough, each alone", "left", 1.0, least=34, wraps=True),
    ]
    note = "Enough for the duty cycles: other limits, such as strength, are not considered."
    return [Table("What the duty cycles lack", columns, rows, note=note)]


def series(evaluation: Evaluation) -> list[Series]:
    """Traces of all cycles, one below the other, then the temperatures from cold; may be empty.

    A column that no cycle has is left out. Rows of temperatures have no traces, and the other way
    round.
    """
    study = evaluation.duty
    if study is None:
        return []
    cycles, warming = study.cycles, study.warming
    names = [cycle.name for cycle in cycles for _ in cycle.time]
    names += [f"{x.name}, {COLD}" for x in warming for _ in x.time]
    time = np.concatenate([*(x.time for x in cycles), *(x.time for x in warming)])
    columns = [Series("cycle", names), Series("time [s]", time.tolist(), 9)]
    cold = [np.full(x.time.size, np.nan) for x in warming]
    named = [(name, trace, quantity) for name, trace, quantity in _COLUMNS]
    for i, seal in enumerate(cycles[0].severity):
        named.append((f"contact_pressure of the {seal}", f"contact{i}", PRESSURE))
    for name, trace, quantity in named:
        parts = [trace_of(cycle, trace) for cycle in cycles]
        if all(part is None for part in parts):
            continue
        moving = [
            np.full(cycle.time.size, np.nan) if part is None else part
            for cycle, part in zip(cycles, parts, strict=True)
        ]
        shown = quantity.to_display(1.0) * np.concatenate([*moving, *cold])
        columns.append(Series(heading(name, quantity.unit), shown.tolist()))
    moved = np.full(sum(cycle.time.size for cycle in cycles), np.nan)
    for k, place in enumerate(warming[0].places if warming else ()):
        kelvin = np.concatenate([moved, *(x.places[k].temperature for x in warming)])
        values = [TEMPERATURE.to_display(float(value)) for value in kelvin]
        columns.append(Series(heading(f"temperature of {place.name}", TEMPERATURE.unit), values))
    return columns


def card_blocks(evaluation: Evaluation) -> list[Block]:
    """A few lines on the duty cycles for the card; empty without cycles."""
    study = evaluation.duty
    if study is None:
        return []
    shown = _shown(study, MOST_ON_CARD)
    lines: list[Block] = [replace(_overview(study, shown), title="", note="")]
    dear = max(shown, key=lambda cycle: cycle.energies["supply_energy"])
    words = [f"energy of {clean(dear.name)}: {_split_words(dear)}"]
    if hidden := len(study.cycles) - len(shown):
        words.append(f"{hidden} more cycle{'' if hidden == 1 else 's'} (-v)")
    worst = _worst_part(evaluation)
    if worst is not None:
        words.append(f"fatigue of the life: {number(worst[1], 3)}, {clean(worst[0])}")
    return [*lines, *(Notes("", [line], headless=True, on="terminal") for line in words)]


# ---- numbers ----


def _shown(study: DutyStudy, most: int = MOST_SHEETS) -> list[CycleStudy]:
    """The cycles that need most of their supply pressure, in the order of the design."""
    ranked = sorted(study.cycles, key=lambda cycle: -cycle.worst["share"].value)[:most]
    return [cycle for cycle in study.cycles if any(cycle is kept for kept in ranked)]


def _opening(cycle: CycleStudy) -> str:
    """Largest opening; past stall there is none."""
    worst = cycle.worst.get("opening")
    if worst is None:
        return DASH
    return "stalls" if math.isinf(worst.value) else value_of(OPENING, worst.value)


def _worst_part(evaluation: Evaluation) -> tuple[str, float] | None:
    """Part with the largest damage of the life; None if no life is stated."""
    metric = evaluation.metrics.get("duty_fatigue")
    if metric is None or metric.value is None or not metric.by_place:
        return None
    return max(metric.by_place.items(), key=lambda entry: entry[1])


def _missed(cycle: CycleStudy) -> bool:
    """Whether the supply does not move the load somewhere along the cycle."""
    return not cycle.worst["reserve"].value >= 0


# ---- tables ----


def _overview(study: DutyStudy, cycles: Sequence[CycleStudy] | None = None) -> Table:
    """A row for every cycle, or for some."""
    rowed = study.cycles if cycles is None else cycles
    rows = [_overview_row(cycle) for cycle in rowed]
    columns = [
        Column("duty cycle", "left", 1.3, least=12),
        Column("duration", "right", drop=8),
        Column("repeats", "right", drop=9),
        Column("strokes (short)", "right", drop=10),
        Column("reserve", "right", style="state"),
        Column("at", "right", drop=2),
        Column("opening", "right", drop=3),
        Column("peak, mean flow", "right", drop=4),
        Column("supply", "right", drop=5),
        Column("efficiency", "right", drop=6),
    ]
    note = "Reserve: least force left to the supply. Supply: energy per cycle."
    if any(x.strokes for cycle in rowed for x in cycle.short_strokes.values()):
        note += f" Short: below {SHORT_STROKE:g} contact widths of a seal, which starves it of oil."
    if study.opening_limit is not None:
        share = limit_text(OPENING, "max", study.opening_limit)[2:]
        note = note.replace("supply.", f"supply with the valve at most {share} open.", 1)
    if (figures := len(_shown(study))) < len(study.cycles):
        note += (
            f" Figures follow for the {figures} cycles that need the largest share of their supply "
            "pressure."
        )
    return Table("Duty cycles", columns, rows, note=note)


def _overview_row(cycle: CycleStudy) -> Row:
    reserve = cycle.worst["reserve"]
    peak = FLOW.to_display(cycle.worst["flow"].value)
    cells: list[Cell] = [
        soft(cycle.name),
        f"{number(float(np.ptp(cycle.time)), 3)} s",
        DASH if cycle.repeats is None else trimmed(cycle.repeats, 3),
        _strokes(cycle),
        value_of(FORCE, reserve.value),
        time_of(cycle, reserve.sample),
        _opening(cycle),
        f"{number(peak, 3)}, {value_of(FLOW, cycle.flow_mean)}",
        value_of(ENERGY, cycle.energies["supply_energy"]),
        efficiency_of(cycle),
    ]
    return Row(cells, "missed" if _missed(cycle) else "met")


def _strokes(cycle: CycleStudy) -> str:
    """Strokes between reversals, and how many of them starve a seal."""
    short = max((x.strokes for x in cycle.short_strokes.values()), default=0)
    return f"{cycle.reversals} ({short})" if short else str(cycle.reversals)


Limit: TypeAlias = tuple[Sense, float]


@dataclass(frozen=True, slots=True)
class _Extreme:
    """A result that is worst at a sample."""

    name: str
    metric: str
    value: float
    index: int
    limit: Limit | None = None
    """Sense and value of a limit that holds although the design states none."""


def _extremes(study: DutyStudy, cycle: CycleStudy) -> Iterator[_Extreme]:
    """The worst samples of a cycle."""
    worst, traces = cycle.worst, cycle.traces
    reserve, needed = worst["reserve"], worst["share"]
    least: Limit = "min", 0.0
    name = "least force reserve"
    yield _Extreme(name, "duty_force_margin", reserve.value, reserve.sample, least)
    supply = float(traces["supply"][needed.sample])
    yield _Extreme(
        "largest supply needed",
        "duty_supply_needed",
        float(traces["needed"][needed.sample]),
        needed.sample,
        ("max", supply),
    )
    if study.opening_limit is not None:
        opening = worst["opening"]
        most: Limit = "max", study.opening_limit
        yield _Extreme("largest opening", "duty_opening", opening.value, opening.sample, most)
    chambers = {"A": traces["pressure_a"], "B": traces["pressure_b"]}
    low = min(chambers, key=lambda name: float(np.min(chambers[name])))
    high = max(chambers, key=lambda name: float(np.max(chambers[name])))
    at = int(np.argmin(chambers[low]))
    name, value = f"lowest pressure, chamber {low}", float(chambers[low][at])
    yield _Extreme(name, "duty_pressure_min", value, at, least)
    at = int(np.argmax(chambers[high]))
    name, value = f"highest pressure, chamber {high}", float(chambers[high][at])
    yield _Extreme(name, "duty_pressure_max", value, at)
    position = traces["position"]
    left = np.minimum(position, study.stroke - position)
    at = int(np.argmin(left))
    stop = "retracted" if position[at] < study.stroke / 2 else "extended"
    name = f"least travel left, {stop}"
    yield _Extreme(name, "duty_stroke_margin", float(left[at]), at, least)
    flow, power, absorbed = (worst[key] for key in ("flow", "power", "absorbed"))
    yield _Extreme("peak flow", "duty_flow_peak", flow.value, flow.sample)
    if power.value > 0:
        yield _Extreme("peak power on the load", "duty_power_peak", power.value, power.sample)
    if absorbed.value < 0:
        yield _Extreme(
            "peak absorbed power", "duty_power_absorbed", -absorbed.value, absorbed.sample
        )


def _margins(evaluation: Evaluation, study: DutyStudy, cycle: CycleStudy) -> Table:
    """Where along a cycle its results are worst, and the state there."""
    joint = cycle.record.joint
    rows = []
    for extreme in _extremes(study, cycle):
        quantity = METRICS[extreme.metric]
        required = [row for row in evaluation.requirements if row.metric == extreme.metric]
        limits: list[Limit | None] = [(row.sense, row.limit) for row in required]
        limits = limits or [extreme.limit]
        state: State = ""
        for limit in filter(None, limits):
            beyond = extreme.value - limit[1] if limit[0] == "max" else limit[1] - extreme.value
            within = beyond <= 1e-9 * abs(limit[1])
            state = "missed" if not within or state == "missed" else "met"
        value = "stalls" if math.isinf(extreme.value) else value_of(quantity, extreme.value)
        at = cycle.state(extreme.index)
        cells: list[Cell] = [
            extreme.name,
            value,
            ", ".join(DASH if x is None else limit_text(quantity, *x) for x in limits),
            time_of(cycle, extreme.index),
            value_of(ANGLE, at["joint_angle"]) if joint else "",
            value_of(LENGTH, at["position"]),
            value_of(FORCE, at["force"]),
            value_of(SPEED, at["speed"]),
            f"{value_of(PRESSURE, at['pressure_a'])[:-4]}, {value_of(PRESSURE, at['pressure_b'])}",
        ]
        rows.append(Row(cells if joint else [*cells[:4], *cells[5:]], state))
    columns = [
        Column("worst along the cycle", "left", 1.6, least=27),
        Column("result", "right", style="state"),
        Column("limit", "right", drop=2),
        Column("at", "right", drop=1),
        Column("joint", "right", drop=5),
        Column("piston", "right", drop=6),
        Column("force", "right", drop=3),
        Column("speed", "right", drop=4),
        Column("pressures A, B", "right", drop=7),
    ]
    title = f"Cycle {clean(cycle.name)}: where margins are least"
    return Table(title, columns if joint else [*columns[:4], *columns[5:]], rows)


def _split_words(cycle: CycleStudy) -> str:
    """Shares of the energy that goes in."""
    parts = balance_of(cycle)
    total = sum(value for _, value in parts if value > 0)
    if total <= 0:
        return "none"
    names = {"work on the load": "work", "return line": "return"}
    sinks = sorted((part for part in parts if part[1] <= 0), key=lambda part: part[1])
    words = [f"{names.get(name, name)} {per_cent(-value / total)}" for name, value in sinks]
    return ", ".join(words)


def _energies(cycle: CycleStudy) -> Table:
    """Sources and sinks of energy, for the terminal."""
    parts = balance_of(cycle)
    total = sum(value for _, value in parts if value > 0)
    rows: list[Sequence[Cell]] = [
        [
            f"from the {name}" if value > 0 and name == "supply" else name,
            value_text(ENERGY, value, 3),
            per_cent(abs(value) / total) if total > 0 else DASH,
            Share(abs(value) / total if total > 0 else 0.0),
        ]
        for name, value in parts
    ]
    columns = [
        Column("energy per cycle", "left", 1.0),
        Column("energy", "right", style="bold"),
        Column("share", "right", drop=1),
        Column("", drop=2),
    ]
    title = f"Cycle {clean(cycle.name)}: energy"
    note = f"efficiency: {efficiency_of(cycle)}"
    return Table(title, columns, rows, note=note, on="terminal")


def _fatigue(evaluation: Evaluation, study: DutyStudy) -> Iterator[Table]:
    """Damage of a life by part, the largest first."""
    metric = evaluation.metrics.get("duty_fatigue")
    if metric is None or metric.value is None:
        return
    ranked = sorted(metric.by_place.items(), key=lambda entry: -entry[1])
    lives = [cycle for cycle in study.cycles if cycle.damage]
    apart = 1 < len(lives) <= 3
    rows: list[Sequence[Cell]] = []
    listed = sum(damage >= LEAST_DAMAGE for _, damage in ranked)
    listed = min(max(listed, FEWEST_PARTS), MOST_PARTS)
    for part, damage in ranked[:listed]:
        cells: list[Cell] = [soft(part), number(damage, 3)]
        if apart:
            cells += [number(cycle.damage.get(part), 3) for cycle in lives]
        span = math.log(max(damage, LEAST_DAMAGE) / LEAST_DAMAGE) / -math.log(LEAST_DAMAGE)
        rows.append([*cells, Share(min(span, 1.0))])
    columns = [
        Column("part", "left", 2.2, least=20, wraps=True),
        Column("damage", "right", style="bold"),
        *(Column(clean(cycle.name), "right", drop=2) for cycle in lives if apart),
        Column("", "left", "40mm", drop=1),
    ]
    low = number(LEAST_DAMAGE, 1)
    notes = [f"Miner's sum: 1 is the end of the life. Bar: logarithmic, from {low} to 1."]
    required = [row for row in evaluation.requirements if row.metric == "duty_fatigue"]
    notes += [f"Required: {limit_text(DAMAGE, row.sense, row.limit)}." for row in required]
    if len(ranked) > listed:
        largest = number(ranked[listed][1], 3)
        notes.append(f"{len(ranked) - listed} more parts have at most {largest}.")
    notes += [f"Not assessed: {clean(part)}, {why}." for part, why in study.unknown.items()]
    if unstated := [cycle for cycle in study.cycles if cycle.repeats is None]:
        named = ", ".join(clean(cycle.name) for cycle in unstated)
        notes.append(f"Without repeats, so not counted: {named}.")
    yield Table("Duty cycles: fatigue damage of a life", columns, rows, note=" ".join(notes))


def _warming(study: DutyStudy) -> Iterator[Block]:
    """Temperatures from cold as a figure, and the places nearest to their limits."""
    if not study.warming:
        return
    rows = []
    for warming in study.warming:
        worst = nearest(warming)
        crossed = [place for place in warming.places if place.crossed is not None]
        for place in sorted(crossed, key=lambda x: x.crossed or 0.0) or [worst]:
            limit = DASH if place.limit is None else limit_text(TEMPERATURE, "max", place.limit)
            cells: list[Cell] = [
                soft(warming.name),
                duration_words(warming.time_constant),
                value_of(RISE, warming.ripple),
                soft(place.name),
                limit,
                value_of(TEMPERATURE, place.steady),
                DASH if place.crossed is None else f"after {duration_words(place.crossed)}",
                value_of(TEMPERATURE, place.after_mission),
            ]
            rows.append(Row(cells, "missed" if place.crossed is not None else "met"))
    columns = [
        Column("under", "left", 1.0, least=10),
        Column("time constant", "right", drop=3),
        Column("ripple", "right", drop=5),
        Column("nearest its limit", "left", 1.3, least=16),
        Column("limit", "right", drop=2),
        Column("steady", "right", style="state"),
        Column("exceeded", "right", drop=1),
        Column("end of mission", "right", drop=4),
    ]
    first = study.warming[0]
    if first.mission is None:
        columns, rows = columns[:-1], [Row(row.cells[:-1], row.state) for row in rows]
    under = "each cycle" if first.name != MEAN else "all cycles of the life, weighted by their time"
    if first.name != MEAN and len(study.warming) > 1:
        under += ", repeated alone without end"
    start = value_of(TEMPERATURE, first.start)
    note = (
        f"All parts begin at {start}, as warm as the air. Heat enters as the mean of {under}. "
        "Time constant: the slowest; after five of them 99 % of the rise is reached. Ripple: no "
        "temperature deviates further from its curve within a period. Coefficients are those of "
        "the steady state, so that a curve errs by less than 10 % of its rise."
    )
    yield warming_chart(study, "")
    title = "Duty cycles: limits of temperature"
    yield Table(title, columns, rows, note=note)


def _basis(study: DutyStudy) -> Notes:
    """Assumptions of the results, and changes of the records."""
    lines = [f"{line[0].upper()}{line[1:]}." for line in study.notes]
    for cycle in study.cycles:
        lines += [f"Cycle {clean(cycle.name)}: {clean(line)}." for line in cycle.record.notes]
    return Notes("Duty cycles: assumptions", lines, on="paper")
