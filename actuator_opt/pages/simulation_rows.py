"""What a page says of a Simulation in numbers and sentences, for paper and terminal alike."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..base.quantities import RESULTS, SCENARIOS, Quantity
from ..evaluation.reserve import count_words
from ..rendering import text
from ..rendering.blocks import State, Tile, Verdict, tile
from ..rendering.text import (
    DASH,
    number,
    pretty,
    sentence,
    trimmed,
    unit_text,
    value_text,
    with_unit,
)
from ..simulation.loops import LOOPS, loop_of
from ..simulation.result import RequirementResult, Simulation
from .simulation_energy import doubts
from .simulation_words import PRESSURE

SHORT = {
    "steady_state_ratio": "steady-state error",
    "hold_drift": "creep at the end",
    "stop_speed": "speed at the stops",
    "supply_energy": "work of the supply",
}
"""Results whose name says less than these words."""
LEAST = {
    "steady_state_ratio": 1e-6,
    "overshoot": 1e-6,
    "hold_drift": 1e-9,
    "following_error": 1e-9,
}
"""Results that read 0 below this, SI: the tolerances of the integration."""
SURE = 1e-3
"""Error of a balance from which on a page warns (a choice: a digit of what it shows)."""
AGREE = 1e-2
"""Difference of two integrators over a signal's span from which on a page warns (a choice)."""
MOST_EVENTS = 4
"""Events that are told."""
NOTHING = (
    "does not apply to this scenario",
    "the reference has no step",
    "the reference does not move on",
    "no sine shakes the rod",
    "the piston meets no stop",
)
"""Reasons that surprise nobody: a page tells them only where there is a limit."""


class Shown(NamedTuple):
    """A result as printed, and what it is held against."""

    name: str
    label: str
    value: float | None
    row: RequirementResult | None

    @property
    def quantity(self) -> Quantity:
        """What it is."""
        return RESULTS[self.name]

    @property
    def words(self) -> str:
        """Value and unit."""
        return value_text(self.quantity, self.value)

    @property
    def limit(self) -> str:
        """Limit and unit; empty without one."""
        if self.row is None:
            return ""
        return text.limit_text(self.quantity, self.row.sense, self.row.limit)

    @property
    def margin(self) -> str:
        """Margin in per cent; empty without a limit."""
        return "" if self.row is None else text.margin_text(self.row.margin, met=self.row.met)

    @property
    def state(self) -> State:
        """Whether its limit is met; empty without one."""
        return "" if self.row is None else self.row.state


def label(name: str) -> str:
    """A result's name as printed.

    >>> label("rise_time"), label("steady_state_ratio")
    ('rise time', 'steady-state error')
    """
    return SHORT.get(name, name.replace("_", " "))


def known(name: str, value: float | None) -> float | None:
    """A result, 0 below the tolerance of the integration."""
    return 0.0 if value is not None and abs(value) < LEAST.get(name, 0.0) else value


def results(found: Simulation) -> list[Shown]:
    """Results that have a value or a limit, each limit on a row of its own."""
    shown = []
    for name in RESULTS:
        value = known(name, found.values.get(name))
        rows: Sequence[RequirementResult | None] = [
            one for one in found.requirements if one.metric == name
        ]
        if value is None and not rows:
            continue
        shown += [Shown(name, label(name), value, row) for row in rows or [None]]
    return shown


def reasons(found: Simulation) -> dict[str, list[str]]:
    """Why results have no value: names by reason, those left out that nobody expects."""
    said: dict[str, list[str]] = {}
    limited = {row.metric for row in found.requirements}
    for name, why in found.why.items():
        idle = why in NOTHING or (name == "efficiency" and found.scenario.held_ports is not None)
        if name in limited or not idle:
            said.setdefault(why, []).append(label(name))
    return said


def controller(found: Simulation) -> list[tuple[str, str]]:
    """The controller, its origin and its margins: what, and value with unit."""
    tuned, control = found.tuned, found.scenario.control
    if tuned is None or control is None:
        return []
    unit, gains = unit_text(tuned.unit), tuned.gains
    loop = loop_of(control)
    words = "" if loop is None else LOOPS[loop].words
    rows = [("law", f"{control.law.upper()} on the {words}")]
    gain = with_unit(number(float(gains.proportional_gain)), unit)
    factor = control.gain_factor
    rows.append(("gain K", gain if factor == 1 else f"{gain} × {trimmed(factor)}"))
    parts = (
        ("integral time", float(gains.integral_time), control.integral_factor),
        ("derivative time", float(gains.derivative_time), control.derivative_factor),
    )
    for words, value, factor in parts:
        if 0 < value < math.inf:
            rows.append((words, f"{duration(value)}{_factor(factor)}"))
    rows.append(("origin", tuned.origin))
    for words, value, name in (
        ("speed feedback", control.speed_feedback, "speed_gain"),
        ("pressure feedback", control.pressure_feedback, "pressure_gain"),
        ("signal rate, at most", control.rate_limit or 0.0, "signal_rate"),
    ):
        if value:
            rows.append((words, value_text(SCENARIOS[name], value)))
    limit = tuned.ultimate
    swings = math.isfinite(limit.gain)
    rows.append(("ultimate gain", with_unit(number(limit.gain), unit) if swings else "none"))
    if swings:
        rows.append(("ultimate period", duration(limit.period)))
    rows.append(("gain margin", gain_margin(tuned.margins.gain)))
    if not tuned.margins.stable:
        rows.append(("linear loop", "unstable"))
        return rows
    phase = tuned.margins.phase
    rows.append(("phase margin", DASH if phase is None else f"{number(math.degrees(phase), 3)}°"))
    return rows


def _factor(factor: float) -> str:
    """A factor of the scenario on a part of the controller."""
    return "" if factor == 1 else f", part × {trimmed(factor)}"


def duration(value: float) -> str:
    """A time in ms, or in s from one second on.

    >>> duration(0.0094678), duration(2.5)
    ('9.468 ms', '2.500 s')
    """
    return f"{number(value)} s" if value >= 1 else f"{number(1e3 * value)} ms"


def gain_margin(ratio: float) -> str:
    """A gain margin as ratio and in decibel.

    >>> gain_margin(2.0), gain_margin(math.inf)
    ('2.00, 6.0 dB', 'no limit')
    """
    if not math.isfinite(ratio):
        return "no limit"
    if ratio <= 0:
        return number(ratio, 3)
    return f"{number(ratio, 3)}, {text.fixed(20 * math.log10(ratio), 1)} dB"


# ---- how far to trust it ----


def sound(found: Simulation) -> bool:
    """Whether balances close, powers add up, and the integrators agree where there are two."""
    balances = max(found.balance.mass, found.balance.energy) < SURE and not doubts(found)
    return balances and (found.second is None or found.second.max_difference < AGREE)


def balance_words(found: Simulation) -> str:
    """Both balances in one line."""
    mass, energy = (share_words(v) for v in (found.balance.mass, found.balance.energy))
    volumes = "" if found.balance.mass == 0 else f"mass within {mass} of a volume's content, "
    return f"Balances: {volumes}energy within {energy} of what went through."


def share_words(share: float) -> str:
    """A small share, short.

    >>> share_words(7.8865e-9), share_words(0.0), share_words(0.02)
    ('8×10⁻⁹', '0', '0.02')
    """
    return number(share, 1)


def second_words(found: Simulation) -> str:
    """What the second integrator says."""
    second = found.second
    if second is None:
        return "Not compared with a second integrator."
    method = second.method.capitalize()
    if not second.signal:
        return f"{method} on the same equations: no signal that moves was compared."
    told = found.told.get(second.signal)
    words = second.signal if told is None else told.label
    return (
        f"{method} on the same equations: signals differ by {share_words(second.max_difference)}"
        f" of their span at most, {words} at {number(second.time)} s."
    )


def event_words(found: Simulation) -> str:
    """The first switches that turned, and how many there were."""
    if not found.events:
        return "No switch turned."
    first = [
        f"{one.name} {'on' if one.on else 'off'} at {number(one.time)} s"
        for one in found.events[:MOST_EVENTS]
    ]
    more = len(found.events) - len(first)
    tail = f" and {more} more" if more else ""
    count = "1 event" if len(found.events) == 1 else f"{len(found.events)} events"
    return f"{count}: {', '.join(first)}{tail}."


def run_words(found: Simulation) -> str:
    """Samples, evaluations and the oil."""
    oil = found.plant.oil
    count = trimmed(float(np.unique(found.time).size), 9)
    evaluations = f", {trimmed(found.evaluations, 9)} evaluations" if found.evaluations else ""
    return (
        f"{count} samples{evaluations}; oil at {number(oil.temperature - 273.15, 3)} °C with"
        f" {number(100 * oil.air_content, 2)} % of free air."
    )


def remarks(found: Simulation, more: Sequence[str] = ()) -> list[str]:
    """Doubts, notes of the run, of the caller and of the scenario, in full sentences."""
    said = [*doubts(found), *_open(found), *found.notes, *more]
    own = found.scenario.notes.strip()
    return [sentence(pretty(" ".join(one.split()))) for one in [*said, *([own] if own else [])]]


def _open(found: Simulation) -> Iterator[str]:
    """Why a run is in doubt: a balance that does not close, integrators that do not agree."""
    for name in ("mass", "energy"):
        error = getattr(found.balance, name)
        if error >= SURE:
            yield f"in doubt: the balance of {name} is open by {share_words(error)}"
    if found.second is not None and found.second.max_difference >= AGREE:
        apart = share_words(found.second.max_difference)
        yield f"in doubt: the second integrator differs by {apart} of a signal's span"


# ---- verdict and key figures ----


def verdict(found: Simulation) -> Verdict:
    """Whether the requirements are met, and whether the run can be trusted."""
    total = len(found.requirements)
    met = sum(row.met for row in found.requirements)
    mass, energy = (share_words(v) for v in (found.balance.mass, found.balance.energy))
    lines = [f"{met} of {total} requirements met" if total else "no requirement stated"]
    lines.append(f"balances: {f'mass {mass} · ' if found.balance.mass else ''}energy {energy}")
    if met < total:
        return Verdict("missed", "REQUIREMENTS MISSED", lines)
    words = "REQUIREMENTS MET" if total else "SIMULATED"
    tight = sum(row.state == "no_reserve" for row in found.requirements)
    if tight:
        words += f", {count_words(tight).upper()}"
    if not sound(found):
        words += ", IN DOUBT"
    if tight or not sound(found):
        return Verdict("checks", words, lines)
    return Verdict("met", words, lines)


_KEYS = (
    "dynamic_stiffness", "dynamic_phase", "rise_time", "overshoot", "settling_time",
    "steady_state_ratio", "following_error", "peak_pressure", "cavitation_margin", "efficiency",
    "supply_energy", "stop_speed", "hold_drift", "lowest_pressure",
)  # fmt: skip
"""Key figures, the first first."""
MOST_TILES = 6


def tiles(found: Simulation) -> list[Tile]:
    """Up to six key figures, each with its limit or what to know of it."""
    shown = {one.name: one for one in reversed(results(found))}
    made = [*bench(found)]
    for name in _KEYS:
        if name in shown and len(made) < MOST_TILES:
            one = shown[name]
            note = one.limit or _note(found, name)
            if one.value is None:
                note = found.why.get(name, "")
            made.append(tile(one.label, one.words, _cut(note), one.state))
    return made


def _cut(words: str) -> str:
    return words if len(words) <= 24 else words[:23].rstrip() + "…"


def _note(found: Simulation, name: str) -> str:
    """What to know of a result without a limit."""
    servo, shaken = found.servo, found.shaken
    if name == "steady_state_ratio" and servo is not None:
        quantity = LOOPS[servo.loop].quantity
        error = servo.metrics.steady_state_error
        span = abs(servo.target - servo.start)
        return value_text(quantity, error if abs(error) > 1e-6 * span else 0.0, 3)
    if name == "overshoot" and servo is not None:
        return f"peak {value_text(LOOPS[servo.loop].quantity, servo.metrics.peak)}"
    if name == "peak_pressure":
        return f"proof {value_text(PRESSURE, found.plant.proof_pressure, 3)}"
    if name == "dynamic_stiffness" and shaken is not None:
        return f"least, at {trimmed(shaken.frequency)} Hz"
    if name == "dynamic_phase":
        return "of the force, there"
    notes = {
        "rise_time": "10 to 90 %",
        "settling_time": "within 2 %",
        "cavitation_margin": "above vapour",
        "efficiency": "load over supply",
        "supply_energy": f"in {trimmed(found.scenario.duration)} s",
    }
    return notes.get(name, "")


def bench(found: Simulation) -> list[Tile]:
    """Flows of a valve whose ports are held."""
    if found.scenario.held_ports is None:
        return []
    flow = SCENARIOS["flow_value"]
    made = []
    for name, words in (("flow_a", "into A"), ("flow_b", "into B")):
        values, signal = found.signals[name], found.signals["signal"]
        at = int(np.argmax(np.abs(values)))
        note = f"at {value_text(SCENARIOS['signal_value'], float(signal[at]), 3)}"
        made.append(tile(f"largest flow {words}", value_text(flow, float(values[at])), note))
    valve = found.plant.valve
    centre = 0.0 if valve is None else valve.offset
    at = int(np.argmin(np.abs(found.signals["spool"] - centre)))
    least = value_text(flow, float(found.signals["flow_supply"][at]))
    made.append(tile("flow, valve centred", least, "from the supply"))
    return made
