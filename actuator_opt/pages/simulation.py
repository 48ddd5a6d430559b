"""The page of a time simulation: results, controller, step, energies, and their accuracy."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..base.numeric import Array
from ..base.quantities import INPUTS, RESULTS, SCENARIOS, Quantity
from ..design.scenario.kinds import ENDS, FRICTIONS, SHAPES, SUPPLIES, height
from ..design.scenario.model import SAMPLES, Scenario
from ..evaluation.result import count_words
from ..rendering import text
from ..rendering.blocks import (
    Bar,
    Block,
    Cell,
    Column,
    Notes,
    Page,
    Pair,
    Row,
    State,
    Status,
    Table,
    TerminalFigure,
    Tile,
    Verdict,
    short,
    tile,
)
from ..rendering.series import Series, heading
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
from ..simulation.assemble import ends_of
from ..simulation.components.circuit import LOOPS, loop_of
from ..simulation.result import EXPECTED, RequirementResult, Simulation
from .simulation_basis import blocks as basis_blocks
from .simulation_energy import doubts, table_rows
from .simulation_figures import LEAST, MOST, Measured, Static, simulation_figure, window

SHORT = {
    "steady_state_ratio": "steady-state error",
    "hold_drift": "creep at the end",
    "stop_speed": "speed at the stops",
    "supply_energy": "work of the supply",
}
"""Clearer words for the names of some results."""
ZERO_BELOW = {
    "steady_state_ratio": 1e-6,
    "overshoot": 1e-6,
    "hold_drift": 1e-9,
    "following_error": 1e-9,
}
"""Results below these values (SI) are shown as 0, as they are within the tolerance of the
integration."""
CLOSED = 1e-3
"""Least relative error of the oil or energy balance that raises a warning (our choice: one digit of
the printed value)."""
AGREE = 1e-2
"""Least difference of two integrators that raises a warning, as a share of a signal's range
(our choice)."""
MOST_EVENTS = 4
"""Largest number of events listed."""
MOST_PARTS = 3
"""Largest number of pieces of a signal (steps, ramps, ...) that are listed."""
MOST_TILES = 6
BRIEF = 900
"""Number of characters of notes that fit beside a table (our choice: a quarter of the sheet)."""
POINTS = 240
"""Number of points in the step response on the terminal."""
NEAR = 1e-6
"""Tolerance, as a share of the grid step, within which a sample counts as lying on the CSV grid."""
PRESSURE, LENGTH = INPUTS["pressure"], INPUTS["position"]
_UNITS = r"(?:mm|m|m/s|ms|s|V|bar|k?N|Hz|J|l/min|rpm|rad|N·m|V/m|kN/mm|MPa)(?![\w/])|%|°"
_TIED = re.compile(rf"(?<=\d) (?={_UNITS})")
_KEYS = (
    "dynamic_stiffness", "dynamic_phase", "rise_time", "overshoot", "settling_time",
    "steady_state_ratio", "following_error", "peak_pressure", "cavitation_margin", "efficiency",
    "supply_energy", "stop_speed", "hold_drift", "lowest_pressure",
)  # fmt: skip
"""Candidates for key figures, the most important first."""


def page(
    simulation: Simulation,
    *,
    notes: Sequence[str] = (),
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> Page:
    """The page of a simulation.

    Parameters
    ----------
    simulation : the run
    notes : further sentences for the reader
    measured : time [s] and measured values (SI) by name of the signal that is drawn over them
    static : positions [m] and static stiffness [N/m], drawn beside the dynamic stiffness
    extra : blocks below all others
    """
    return Page(
        name=simulation.scenario.name,
        kind="Simulation in time",
        design=simulation.plant.design.name,
        verdict=verdict(simulation),
        sentence=tied(description(simulation)),
        tiles=tiles(simulation),
        hero=lambda room: simulation_figure(
            simulation, min(room, MOST), measured=measured, static=static
        ),
        least=LEAST,
        blocks=[
            *_blocks(simulation, notes),
            *extra,
            *basis_blocks(simulation.basis, on="paper"),
        ],
    )


def series(simulation: Simulation) -> list[Series]:
    """Every signal over time, at evenly spaced sample times."""
    time, samples = _grid(simulation)
    columns = [Series("t [s]", time.tolist(), 9)]
    for name, values in simulation.signals.items():
        quantity = simulation.told[name].quantity
        shown = values[samples] * quantity.to_display(1.0)
        columns.append(Series(heading(name, quantity.unit), shown.tolist()))
    return columns


def _grid(simulation: Simulation) -> tuple[Array, Array]:
    """Evenly spaced times [s], and indices of the samples there (at a jump, of the later one)."""
    time, duration = simulation.time, simulation.scenario.duration
    step = simulation.scenario.sample_time or duration / SAMPLES
    count = max(round(duration / step), 1)
    even = np.linspace(0.0, duration, count + 1)
    near = NEAR * duration / count
    at = np.searchsorted(time, even + near, side="right") - 1
    on = np.abs(time[at] - even) <= near
    return even[on], at[on]


# ---- what was simulated ----


def tied(words: str) -> str:
    r"""Words in which a number and its unit cannot be separated by a line break.

    >>> tied("step of 20 mm at 0.5 s, 3 steps")
    'step of 20\xa0mm at 0.5\xa0s, 3 steps'
    """
    return _TIED.sub("\N{NO-BREAK SPACE}", words)


def description(simulation: Simulation) -> str:
    """Sentences on machine, duration, reference signal and load."""
    scenario, plant = simulation.scenario, simulation.plant
    control = scenario.control
    asked = ""
    for name, loop in LOOPS.items() if control is not None else ():
        parts = _signal(getattr(control, name), loop.quantity)
        if parts and name == "position":
            start = _amount(loop.quantity, float(simulation.signals["position"][0]))
            asked = f"{loop.words} from {start}: {parts}"
        elif parts:
            asked = f"{loop.words}: {parts}"
    torque = scenario.load.torque if scenario.motor is None else scenario.motor.torque
    drive = scenario.load.drive
    driven = "" if drive is None else _signal(drive.position, LENGTH)
    sentences = (
        asked or _headed("valve signal", _signal(scenario.signal, SCENARIOS["signal_value"])),
        _headed("load", _signal(scenario.load.force, SCENARIOS["force_value"])),
        _headed("torque", _signal(torque, SCENARIOS["torque_value"])),
        _headed("machine outside", driven),
        _load_cylinder(scenario),
    )
    first = f"{plant.design.name}: {_machine(simulation)}, {trimmed(scenario.duration)} s."
    return " ".join([first, *(sentence(words) for words in sentences if words)])


def _headed(head: str, words: str) -> str:
    return f"{head}: {words}" if words else ""


def _amount(quantity: Quantity, value: float) -> str:
    """A value in the unit in which a scenario states it."""
    return with_unit(trimmed(quantity.to_display(value)), unit_text(quantity.unit))


def _signal(parts: Sequence[Any], quantity: Quantity) -> str:
    """The pieces of a signal in words (steps, ramps, ...); empty if the signal is always zero."""
    moving = [part for part in parts if height(part) or "file" in SHAPES[part.shape].needed]
    words = [
        SHAPES[part.shape].words(part, _amount(quantity, height(part)), trimmed)
        for part in moving[:MOST_PARTS]
    ]
    more = len(moving) - len(words)
    return ", ".join(words) + (f" and {more} more" if more else "")


def _load_cylinder(scenario: Scenario) -> str:
    """Bore and rod of the load cylinder, with its signal."""
    cylinder = scenario.load.cylinder
    if cylinder is None:
        return ""
    bore, rod = (_amount(LENGTH, value) for value in (cylinder.bore, cylinder.rod_diameter))
    signal = _headed("valve signal", _signal(cylinder.signal, SCENARIOS["signal_value"]))
    return f"load cylinder of bore {bore} and rod {rod}, {signal or 'no signal at its valve'}"


def _machine(simulation: Simulation) -> str:
    """Sentence on the ports, supply and friction model."""
    scenario, plant = simulation.scenario, simulation.plant
    held = scenario.held_ports
    words = []
    if held is not None:
        ports = " and ".join(_amount(PRESSURE, p) for p in (held.pressure_a, held.pressure_b))
        words.append(f"the valve alone, with its ports at {ports}")
    elif scenario.motor is not None:
        words.append("the valve with a hydraulic motor")
    elif "flow_supply" not in simulation.signals:
        words.append(ENDS[ends_of(scenario, plant)].words or "")
    if "flow_supply" in simulation.signals:
        relief = scenario.supply.relief
        supply = SUPPLIES[scenario.supply.type].words
        if scenario.supply.type == "fixed_pump" and relief is not None:
            supply += f", relief valve {_amount(PRESSURE, relief.pressure)}"
        else:
            supply += f" {_amount(PRESSURE, plant.supply_pressure)}"
        words.append(f"{supply}, return {_amount(PRESSURE, plant.return_pressure)}")
    if "friction" in simulation.signals:
        words.append(FRICTIONS[scenario.friction.model].words)
    return ", ".join(words)


# ---- results ----


class ShownResult(NamedTuple):
    """A result as printed, with the requirement that limits it."""

    name: str
    label: str
    value: float | None
    requirement: RequirementResult | None

    @property
    def quantity(self) -> Quantity:
        """Quantity of the result: unit and meaning."""
        return RESULTS[self.name]

    @property
    def words(self) -> str:
        """Value and unit."""
        return value_text(self.quantity, self.value)

    @property
    def limit(self) -> str:
        """Limit and unit; empty without a limit."""
        if self.requirement is None:
            return ""
        return text.limit_text(self.quantity, self.requirement.sense, self.requirement.limit)

    @property
    def margin(self) -> str:
        """Margin in per cent; empty without a limit."""
        if self.requirement is None:
            return ""
        return text.margin_text(self.requirement.margin, met=self.requirement.met)

    @property
    def state(self) -> State:
        """Whether the limit is met; empty without a limit."""
        return "" if self.requirement is None else self.requirement.state


def label(name: str) -> str:
    """A result's name as printed.

    >>> label("rise_time"), label("steady_state_ratio")
    ('rise time', 'steady-state error')
    """
    return SHORT.get(name, name.replace("_", " "))


def known(name: str, value: float | None) -> float | None:
    """Value of a result; 0 if it is below the tolerance of the integration."""
    small = value is not None and abs(value) < ZERO_BELOW.get(name, 0.0)
    return 0.0 if small else value


def results(simulation: Simulation) -> list[ShownResult]:
    """Results that have a value or a limit; a result with several limits has a row for each."""
    shown = []
    for name in RESULTS:
        value = known(name, simulation.values.get(name))
        limits: Sequence[RequirementResult | None] = [
            requirement for requirement in simulation.requirements if requirement.metric == name
        ]
        if value is not None or limits:
            shown += [ShownResult(name, label(name), value, limit) for limit in limits or [None]]
    return shown


def reasons(simulation: Simulation) -> dict[str, list[str]]:
    """Reasons for missing values, each with the results that it concerns.

    Reasons that the scenario makes obvious are left out, unless the result has a requirement.
    """
    missing: dict[str, list[str]] = {}
    limited = {requirement.metric for requirement in simulation.requirements}
    bench = simulation.scenario.held_ports is not None
    for name, why in simulation.why.items():
        expected = why in EXPECTED or (name == "efficiency" and bench)
        if name in limited or not expected:
            missing.setdefault(why, []).append(label(name))
    return missing


# ---- controller ----


def controller(simulation: Simulation) -> list[tuple[str, str]]:
    """Table rows on the controller: its gains, their origin, and the margins."""
    tuned, control = simulation.tuned, simulation.scenario.control
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
            scaled = "" if factor == 1 else f", part × {trimmed(factor)}"
            rows.append((words, f"{duration(value)}{scaled}"))
    rows.append(("origin", tuned.origin))
    for words, value, name in (
        ("speed feedback", control.speed_feedback, "speed_gain"),
        ("pressure feedback", control.pressure_feedback, "pressure_gain"),
        ("signal rate, at most", control.rate_limit or 0.0, "signal_rate"),
    ):
        if value:
            rows.append((words, value_text(SCENARIOS[name], value)))
    ultimate = tuned.ultimate
    if ultimate is None or tuned.margins is None:
        return rows
    swings = math.isfinite(ultimate.gain)
    rows.append(("ultimate gain", with_unit(number(ultimate.gain), unit) if swings else "none"))
    if swings:
        rows.append(("ultimate period", duration(ultimate.period)))
    rows.append(("gain margin", gain_margin(tuned.margins.gain)))
    if not tuned.margins.stable:
        return [*rows, ("linear loop", "unstable")]
    phase = tuned.margins.phase
    return [
        *rows,
        ("phase margin", DASH if phase is None else f"{number(math.degrees(phase), 3)}°"),
    ]


def duration(value: float) -> str:
    """A time in ms; from one second upwards in s.

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


# ---- trust ----


def sound(simulation: Simulation) -> bool:
    """Whether the run can be trusted.

    For this, the balances of oil mass and energy must close, the sampled powers must agree with the
    energies, and the second integrator (if any) with the first.
    """
    balance, second = simulation.balance, simulation.second
    closed = max(balance.mass, balance.energy) < CLOSED and not doubts(simulation)
    return closed and (second is None or second.max_difference < AGREE)


def share_words(share: float) -> str:
    """A small share as a short number.

    >>> share_words(7.8865e-9), share_words(0.0), share_words(0.02)
    ('8×10⁻⁹', '0', '0.02')
    """
    return number(share, 1)


def trust(simulation: Simulation, more: Sequence[str] = ()) -> list[str]:
    """A paragraph on balances, second integrator, events and size of the run, then all remarks."""
    first = (_balance, second_words, event_words, _run)
    return [" ".join(words(simulation) for words in first), *remarks(simulation, more)]


def _balance(simulation: Simulation) -> str:
    """Sentence on the errors of the oil mass and energy balances."""
    balance = simulation.balance
    mass, energy = share_words(balance.mass), share_words(balance.energy)
    volumes = "" if balance.mass == 0 else f"oil mass {mass} of the oil in any chamber or line, "
    return f"Errors of the balances: {volumes}energy {energy} of the energy converted."


def second_words(simulation: Simulation) -> str:
    """Sentence on the largest difference from the second integrator."""
    second = simulation.second
    if second is None:
        return "Not compared with a second integrator."
    method = second.method.capitalize()
    if not second.signal:
        return f"{method} on the same equations: no signal changes, so there is nothing to compare."
    signal = simulation.told.get(second.signal)
    words = second.signal if signal is None else signal.label
    return (
        f"Compared with {method} on the same equations, signals differ by at most "
        f"{share_words(second.max_difference)} of their range; the difference is largest for "
        f"{words} at {number(second.time)} s."
    )


def event_words(simulation: Simulation) -> str:
    """Sentence on the number of events, with the first of them."""
    events = simulation.events
    if not events:
        return "No discrete event occurred."
    first = [
        f"{event.name} {'on' if event.on else 'off'} at {number(event.time)} s"
        for event in events[:MOST_EVENTS]
    ]
    more = len(events) - len(first)
    tail = f" and {more} more" if more else ""
    count = "1 event" if len(events) == 1 else f"{len(events)} events"
    return f"{count}: {', '.join(first)}{tail}."


def _run(simulation: Simulation) -> str:
    """Sentence on the number of samples and of evaluations, and on the oil."""
    oil = simulation.plant.oil
    count = trimmed(float(np.unique(simulation.time).size), 9)
    calls = simulation.evaluations
    evaluations = f", {trimmed(calls, 9)} evaluations" if calls else ""
    return (
        f"{count} samples{evaluations}; oil at {number(oil.temperature - 273.15, 3)} °C with"
        f" {number(100 * oil.air_content, 2)} % of free air."
    )


def remarks(simulation: Simulation, more: Sequence[str] = ()) -> list[str]:
    """Sentences: doubts, and the notes of the run, of the caller and of the scenario."""
    own = simulation.scenario.notes.strip()
    cycle = () if simulation.cycle is None else simulation.cycle.notes
    notes = [*doubts(simulation), *_open(simulation), *cycle, *simulation.notes, *more]
    notes += [own] if own else []
    return [sentence(pretty(" ".join(note.split()))) for note in notes]


def _open(simulation: Simulation) -> Iterator[str]:
    """Sentences on balances that do not close, and on integrators that disagree."""
    for name in ("mass", "energy"):
        error = getattr(simulation.balance, name)
        if error >= CLOSED:
            yield (
                f"in doubt: the balance of {name} does not close; its relative error is "
                f"{share_words(error)}"
            )
    second = simulation.second
    if second is not None and second.max_difference >= AGREE:
        apart = share_words(second.max_difference)
        yield f"in doubt: the second integrator differs by {apart} of the range of a signal"


# ---- verdict and key figures ----


def verdict(simulation: Simulation) -> Verdict:
    """Whether the requirements are met, and whether the run can be trusted."""
    requirements, balance = simulation.requirements, simulation.balance
    total = len(requirements)
    met = sum(requirement.met for requirement in requirements)
    mass = f"mass {share_words(balance.mass)} · " if balance.mass else ""
    lines = [
        f"{met} of {total} requirements met" if total else "no requirement stated",
        f"errors of the balances: {mass}energy {share_words(balance.energy)}",
    ]
    if met < total:
        return Verdict("missed", "REQUIREMENTS MISSED", lines)
    words = "REQUIREMENTS MET" if total else "SIMULATED"
    tight = sum(requirement.state == "no_reserve" for requirement in requirements)
    if tight:
        words += f", {count_words(tight).upper()}"
    if not sound(simulation):
        words += ", IN DOUBT"
    return Verdict("checks" if tight or not sound(simulation) else "met", words, lines)


def tiles(simulation: Simulation) -> list[Tile]:
    """Up to six key figures, each with its limit or its meaning."""
    shown = {result.name: result for result in reversed(results(simulation))}
    made = _bench(simulation)
    for name in _KEYS:
        if name in shown and len(made) < MOST_TILES:
            result = shown[name]
            note = result.limit or _meaning(simulation, name)
            if result.value is None:
                note = simulation.why.get(name, "")
            made.append(tile(result.label, result.words, short(note, 24), result.state))
    return made


def _meaning(simulation: Simulation, name: str) -> str:
    """The note below a key figure without a limit."""
    servo, shaken = simulation.servo, simulation.shaken
    if name == "steady_state_ratio" and servo is not None:
        error = servo.metrics.steady_state_error
        span = abs(servo.target - servo.start)
        shown = error if abs(error) > ZERO_BELOW[name] * span else 0.0
        return value_text(LOOPS[servo.loop].quantity, shown, 3)
    if name == "overshoot" and servo is not None:
        return f"peak {value_text(LOOPS[servo.loop].quantity, servo.metrics.peak)}"
    if name == "peak_pressure":
        return f"proof {value_text(PRESSURE, simulation.plant.proof_pressure, 3)}"
    if name == "dynamic_stiffness" and shaken is not None:
        return f"least, at {trimmed(shaken.frequency)} Hz"
    meanings = {
        "dynamic_phase": "of the force, there",
        "rise_time": "10 to 90 %",
        "settling_time": "within 2 %",
        "cavitation_margin": "above vapour",
        "efficiency": "load / supply power",
        "supply_energy": f"in {trimmed(simulation.scenario.duration)} s",
    }
    return meanings.get(name, "")


def _bench(simulation: Simulation) -> list[Tile]:
    """Key figures of a valve test: largest flows, and flow at the centre."""
    if simulation.scenario.held_ports is None:
        return []
    flow, signals = SCENARIOS["flow_value"], simulation.signals
    made = []
    for name, words in (("flow_a", "into A"), ("flow_b", "into B")):
        at = int(np.argmax(np.abs(signals[name])))
        note = f"at {value_text(SCENARIOS['signal_value'], float(signals['signal'][at]), 3)}"
        largest = value_text(flow, float(signals[name][at]))
        made.append(tile(f"largest flow {words}", largest, note))
    valve = simulation.plant.valve
    centre = 0.0 if valve is None else valve.offset
    at = int(np.argmin(np.abs(signals["spool"] - centre)))
    least = value_text(flow, float(signals["flow_supply"][at]))
    return [*made, tile("flow, valve centred", least, "from the supply")]


# ---- blocks ----


def _blocks(simulation: Simulation, more: Sequence[str]) -> Iterator[Block]:
    """Results beside the controller; on the terminal step and energies; then the accuracy."""
    sentences = trust(simulation, more)
    notes = Notes("Basis of these results", [tied(words) for words in sentences])
    tables = [block for block in (_results(simulation), _controller(simulation)) if block]
    beside = len(tables) == 1 and sum(map(len, sentences)) < BRIEF
    if beside:
        tables.append(notes)
    if len(tables) == 2:
        yield Pair([[tables[0]], [tables[1]]])
    else:
        yield from tables
    bench = [f"{key.label} {key.value} {key.unit}, {key.note}" for key in _bench(simulation)]
    if bench:
        yield Notes("Flows of the valve", bench, on="terminal")
    yield from _cycle(simulation)
    yield from _step(simulation)
    energies = table_rows(simulation)
    if energies:
        columns = [
            Column("energy of the run", width=1.0),
            Column("in (+), out (−)", "right", strong=True),
            Column("share", "right", style="dim"),
        ]
        yield Table("Energy of the run", columns, energies, headless=True, on="terminal")
    if not beside:
        yield notes
    if simulation.seconds:
        seconds = f"Computing time {number(simulation.seconds, 2)} s."
        yield Notes("", [seconds], headless=True, style="dim", on="terminal")


def _cycle(simulation: Simulation) -> Iterator[Block]:
    """Results of the last period of a duty cycle beside the quasi-static ones."""
    cycle = simulation.cycle
    if cycle is None:
        return
    columns = [
        Column("duty cycle", width=1.0, least=16),
        Column("quasi-static", "right"),
        Column("simulated", "right", strong=True),
        Column("difference", "right", style="dim"),
    ]
    rows: list[list[Cell]] = [
        [
            row.label,
            value_text(row.quantity, row.quasi_static),
            value_text(row.quantity, row.simulated),
            DASH if row.difference is None else pretty(f"{100 * row.difference:+.2g} %"),
        ]
        for row in cycle.rows
    ]
    error = value_text(LENGTH, cycle.position_error, 3)
    title = f"{cycle.cycle}, {number(cycle.start, 4)} to {number(cycle.end, 4)} s, both models"
    yield Table(title, columns, rows, note=f"Position error: {error} root mean square.")


def _results(simulation: Simulation) -> Block | None:
    """Table of every result with its limit and margin; a note gives reasons for missing values."""
    shown = results(simulation)
    missing = [f"{', '.join(names)}: {why}" for why, names in reasons(simulation).items()]
    note = f"No value: {'; '.join(missing)}." if missing else ""
    if not shown:
        return Notes("Results", [note], on="terminal") if note else None
    columns = [Column("result", width=1.0, least=18), Column("value", "right", strong=True)]
    body: list[list[Cell]] = [[result.label, result.words] for result in shown]
    if any(result.requirement for result in shown):
        columns += [
            Column("limit", "right", drop=2),
            Column("margin", "right", style="state", drop=1),
            Column("", drop=3, on="terminal"),
            Column(""),
        ]
        for cells, result in zip(body, shown, strict=True):
            if result.requirement is None:
                cells += [""] * 4
                continue
            bar = Bar(result.requirement.margin, result.requirement.met)
            cells += [result.limit, result.margin, bar, Status(result.state)]
    columns.append(Column("what", width=1.0, least=30, drop=4, style="dim", on="terminal"))
    for cells, result in zip(body, shown, strict=True):
        cells.append(result.quantity.label)
    rows = [Row(cells, result.state) for cells, result in zip(body, shown, strict=True)]
    return Table("Results", columns, rows, note=note)


def _controller(simulation: Simulation) -> Block | None:
    """Gains, origin and margins of the controller."""
    rows = controller(simulation)
    if not rows:
        return None
    columns = [Column("controller"), Column("", width=1.0, breaks=14, wraps=True)]
    tuned, control = simulation.tuned, simulation.scenario.control
    if tuned is None or tuned.margins is None:
        return Table("Controller", columns, rows)
    resting = control is not None and control.tuning_side == "rest"
    note = (
        "The margins are those of the linear loop without sticking friction, at its worst position "
        + ("on the side where the spool rests." if resting else "and spool direction.")
    )
    return Table("Controller and its margins", columns, rows, note=note)


def _step(simulation: Simulation) -> Iterator[Block]:
    """The step response on the terminal, in per cent of the step, with a line at 100 %."""
    servo = simulation.servo
    if servo is None:
        return
    begin, end = servo.time, window(simulation, servo)[1]
    time, at = np.unique(simulation.time[::-1], return_index=True)
    values = simulation.signals[servo.loop][::-1][at]
    over = np.linspace(begin, end, POINTS)
    done = 100 * (np.interp(over, time, values) - servo.start) / (servo.target - servo.start)
    points = [(float(t), max(float(y), 0.0)) for t, y in zip(over, done, strict=True)]
    words = LOOPS[servo.loop].words
    title = f"Response to the step of the {words} at {number(servo.time, 3)} s, in % of the step"
    yield TerminalFigure(title, points, 100.0, ("0", duration(end - begin)), height=11)
