"""Energies of a simulation: shares of what supplied and what took them, and their course."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from ..base.quantities import RESULTS
from ..rendering.axes import (
    COLOURS,
    DASHES,
    ZERO,
    Axes,
    Box,
    even_ticks,
    fitted,
    lines,
    per_cent,
    steady_range,
    time_axis,
)
from ..rendering.ink import BLUE, GREY, OCHRE, PALE, Ink, spread_within, text_width
from ..rendering.text import number, value_text
from ..simulation.result import Simulation

ENERGY = RESULTS["supply_energy"]
BRIEF = {
    "leakage across the piston": "leakage",
    "friction of the seals": "friction",
    "losses of the motor": "motor losses",
    "carried by the oil": "carried",
    "valve edges": "valve",
    "machine outside": "machine",
    "accumulator neck": "neck",
}
"""Short names of doors beside a curve."""
SMALL = 2e-3
"""Share of all energy below which a door is summed with others (a choice: a hair on paper)."""
USEFUL = ("load", "joint")
"""Doors that are shown whatever their share: the purpose of the actuator."""
MOST_ROWS = 9
"""Rows of the energy figure."""
MOST_CURVES = 5
"""Energies shown over time."""
AGREES = 0.01
"""Share of all energy within which a sampled power must add up to its door (a choice)."""
ROW, TOP = 3.7, 7.0
"""Height of a row, and of the title above the rows [mm]."""
GIVEN, TAKEN, KEPT = BLUE, OCHRE, "#7d868e"


class EnergyShare(NamedTuple):
    """A source (positive) or a sink (negative) of energy over the run [J]."""

    name: str
    energy: float


def shares(simulation: Simulation) -> list[EnergyShare]:
    """Sources of energy, the supply first, then sinks by size; small shares are summed."""
    doors = [EnergyShare(flow.name, flow.energy) for flow in simulation.balance.flows]
    doors.append(EnergyShare("store", -sum(store.energy for store in simulation.balance.stored)))
    total = sum(share.energy for share in doors if share.energy > 0)
    if total <= 0:
        return []
    order = sorted(
        doors, key=lambda share: (share.energy < 0, share.name != "supply", -abs(share.energy))
    )
    small = [
        share for share in order if abs(share.energy) < SMALL * total and share.name not in USEFUL
    ]
    large = [share for share in order if share not in small]
    taken = [share for share in large if share.energy < 0 and share.name not in USEFUL]
    while len(large) > MOST_ROWS - 1 and len(taken) > 1:
        last = taken.pop()
        large.remove(last)
        small.append(last)
    rest = sum(share.energy for share in small)
    moved = [share for share in small if share.energy]
    if moved:
        words = moved[0].name if len(moved) == 1 else f"{len(moved)} others"
        large.append(EnergyShare(words, rest))
    return [EnergyShare(_words(share), share.energy) for share in large]


def _words(share: EnergyShare) -> str:
    if share.name == "store":
        return "out of oil, walls, motion" if share.energy > 0 else "into oil, walls, motion"
    if share.energy > 0 and share.name in ("load", "joint", "machine outside", "held ports"):
        return f"from the {share.name}"
    return share.name


def share_panel(ink: Ink, box: Box, simulation: Simulation) -> None:
    """Sources as bars from the left, sinks as bars back to zero."""
    left, top, width, _ = box
    shown = shares(simulation)
    if not shown:
        return
    title = "Where the energy went"
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    efficiency = simulation.values.get("efficiency")
    if efficiency is not None:
        said = f"efficiency {value_text(RESULTS['efficiency'], efficiency, 3)}"
        ink.text(left + width, top + 2.0, said, anchor="right", color=GREY)
    total = sum(share.energy for share in shown if share.energy > 0)
    values = [value_text(ENERGY, abs(share.energy), 4) for share in shown]
    parts = [per_cent(abs(share.energy) / total) for share in shown]
    wide = max(text_width(words, 6.2) for words in values)
    names = min(max(text_width(share.name, 6.2) for share in shown), 0.42 * width)
    ends = left + width - wide - 12.5
    axes = Axes(ink, (left + names + 1.5, top, ends - left - names - 2.5, 1.0), (0, total), (0, 1))
    level = 0.0
    for k, (share, words, part) in enumerate(zip(shown, values, parts, strict=True)):
        y = top + TOP + ROW * (k + 0.5)
        ink.text(left + names, y, fitted(share.name, names, 6.2), size=6.2, anchor="right")
        begin, level = level, level + share.energy
        ends_at = sorted(min(max(v, 0.0), total) for v in (begin, level))
        colour = KEPT if "oil, walls" in share.name else GIVEN if share.energy > 0 else TAKEN
        wide_bar = max(axes.x(ends_at[1]) - axes.x(ends_at[0]), 0.25)
        x = min(axes.x(ends_at[0]), axes.left + axes.width - wide_bar)
        ink.box(x, y - 1.15, wide_bar, 2.3, fill=colour, stroke=None)
        if k + 1 < len(shown):
            at = axes.x(min(max(level, 0.0), total))
            ink.line((at, y + 1.15), (at, y + ROW - 1.15), pen=0.1, stroke=GREY)
        ink.text(left + width - 11.5, y, words, size=6.2, anchor="right")
        ink.text(left + width, y, part, size=6.2, anchor="right", color=GREY)
    bottom = top + TOP + ROW * len(shown)
    ink.line((axes.left, top + TOP), (axes.left, bottom), pen=0.13)


# ---- over time ----


def _product(simulation: Simulation, *names: str) -> Array | None:
    """Product of signals; None where a signal is missing."""
    if any(name not in simulation.signals for name in names):
        return None
    value = np.ones_like(simulation.time)
    for name in names:
        value = value * simulation.signals[name]
    return value


def _valve(simulation: Simulation) -> Array | None:
    """Power that the valve edges turn to heat: supply less ports and tank."""
    if "flow_supply" not in simulation.signals:
        return None
    held = simulation.scenario.held_ports
    ports = [simulation.signals.get(name) for name in ("pressure_a", "pressure_b")]
    if held is not None:
        ports = [np.full_like(simulation.time, p) for p in (held.pressure_a, held.pressure_b)]
    if ports[0] is None or ports[1] is None:
        return None
    own = simulation.signals
    into = ports[0] * own["flow_a"] + ports[1] * own["flow_b"]
    out = simulation.plant.return_pressure * own["flow_tank"]
    return np.asarray(own["pressure_supply"] * own["flow_supply"] - into - out)


def _leaked(simulation: Simulation) -> Array | None:
    across = _product(simulation, "flow_leakage")
    if across is None:
        return None
    return across * (simulation.signals["pressure_a"] - simulation.signals["pressure_b"])


def _motor(simulation: Simulation) -> Array | None:
    flow, work = _product(simulation, "flow_motor"), _product(simulation, "torque", "shaft_speed")
    if flow is None or work is None:
        return None
    return flow * (simulation.signals["pressure_a"] - simulation.signals["pressure_b"]) - work


def _load(simulation: Simulation) -> Array | None:
    work = _product(simulation, "load_torque", "shaft_speed")
    return _product(simulation, "load_force", "speed") if work is None else work


def _at_unit(simulation: Simulation) -> str:
    """Signal of the pressure at pump or accumulator, which a pipe separates from the valve."""
    return "pressure_unit" if "pressure_unit" in simulation.signals else "pressure_supply"


def _supply(simulation: Simulation) -> Array | None:
    flows = ("flow_pump", "flow_unit", "flow_supply")
    given = next((name for name in flows if name in simulation.signals), "flow_supply")
    return _product(simulation, _at_unit(simulation), given)


def _returned(simulation: Simulation) -> Array | None:
    flow = _product(simulation, "flow_tank")
    return None if flow is None else simulation.plant.return_pressure * flow


POWERS: dict[str, Callable[[Simulation], Array | None]] = {
    "supply": _supply,
    "valve edges": _valve,
    "relief valve": lambda simulation: _product(simulation, _at_unit(simulation), "flow_relief"),
    "return line": _returned,
    "load": _load,
    "friction of the seals": lambda simulation: _product(simulation, "friction", "speed"),
    "losses of the motor": _motor,
    "leakage across the piston": _leaked,
}
"""Power through a door from the signals [W]; None where signals are missing."""


def _summed(simulation: Simulation) -> tuple[dict[str, Array], dict[str, float]]:
    """Energy over time [J] through every door of known power, and the error of its end.

    Energies are positive out of the doors, except the supply's; the error is a share of all energy.
    """
    doors: dict[str, float] = {flow.name: flow.energy for flow in simulation.balance.flows}
    ways = [sum(abs(e) for e in doors.values() if (e > 0) == way) for way in (True, False)]
    curves: dict[str, Array] = {}
    off: dict[str, float] = {}
    for name, power_of in POWERS.items():
        power = power_of(simulation) if name in doors else None
        if power is None or not np.all(np.isfinite(power)):
            continue
        steps = 0.5 * (power[1:] + power[:-1]) * np.diff(simulation.time)
        energy = np.concatenate(([0.0], np.cumsum(steps)))
        ends = doors[name] if name == "supply" else -doors[name]
        curves[name] = energy
        off[name] = float(energy[-1] - ends) / (max(ways) or 1.0)
    return curves, off


def over_time(simulation: Simulation) -> dict[str, Array]:
    """Energy through the largest doors over time [J], positive out of them except the supply's.

    A door whose sampled power does not add up to its own energy is left out.
    """
    curves, off = _summed(simulation)
    curves = {name: energies for name, energies in curves.items() if abs(off[name]) <= AGREES}
    sizes: Mapping[str, float] = {
        name: float(np.ptp(energies)) for name, energies in curves.items()
    }
    most = max(sizes.values(), default=0.0)
    names = sorted(sizes, key=lambda name: -sizes[name])[:MOST_CURVES]
    return {name: curves[name] for name in curves if name in names and sizes[name] > SMALL * most}


_LOADED = ("load", "valve edges")
"""Doors whose power follows from the signals only without lines, joint or machine outside."""


def doubts(simulation: Simulation) -> list[str]:
    """A sentence about doors whose energy differs from the sum of their sampled power."""
    _, off = _summed(simulation)
    wrong = {n: e for n, e in off.items() if abs(e) > AGREES and n not in _LOADED}
    if not wrong:
        return []
    said = ", ".join(f"{name} by {number(100 * e, 2, signed=True)} %" for name, e in wrong.items())
    return [
        f"powers at the samples add up to other energies than the integration: {said} of all"
        " energy; take shorter samples, and doubt the energies where that does not help"
    ]


def time_panel(ink: Ink, box: Box, simulation: Simulation, curves: Mapping[str, Array]) -> None:
    """Energies over time, each named at its end."""
    left, top, width, height = box
    scale = ENERGY.to_display(1.0)
    words = {name: BRIEF.get(name, name) for name in curves}
    side = max(text_width(name, 6.2) for name in words.values()) + 4.5
    frame = (left + 11.0, top + 6.5, width - 11.0 - side, height - 6.5 - 7.5)
    ends = [
        float(scale * v)
        for energies in curves.values()
        for v in (np.min(energies), np.max(energies))
    ]
    axes = Axes(ink, frame, (0.0, float(simulation.time[-1])), steady_range(ends, zero=True))
    axes.frame_at("", "", [], even_ticks(*axes.y_range, 4))
    ink.text(left, top + 2.0, f"Energy over time, {ENERGY.unit}", size=7.0, bold=True)
    ink.line((frame[0], axes.y(0.0)), (frame[0] + frame[2], axes.y(0.0)), **ZERO)
    order = sorted(curves, key=lambda name: -float(curves[name][-1]))
    wanted = [axes.y(float(scale * curves[name][-1])) for name in order]
    low, high = frame[1] - 1.0, frame[1] + frame[3] + 1.0
    places = spread_within(wanted, [2.9] * len(order), low, high)
    right = frame[0] + frame[2]
    for k, (name, y, place) in enumerate(zip(order, wanted, places, strict=True)):
        colour, dash = COLOURS[k % len(COLOURS)], DASHES[k % len(DASHES)]
        drawn = lines(axes, simulation.time, scale * curves[name])
        ink.path(drawn, stroke=colour, pen=0.3, dash=dash)
        ink.line((right, y), (right + 3.5, place), stroke=PALE, pen=0.13)
        ink.text(right + 4.0, place, words[name], size=6.2, color=colour)
    time_axis(axes)


def table_rows(simulation: Simulation) -> list[list[str]]:
    """Every share in words: name, energy with its sign, part of all sources."""
    shown = shares(simulation)
    total = sum(share.energy for share in shown if share.energy > 0)
    return [
        [
            share.name,
            f"{number(share.energy, 4, signed=True)} {ENERGY.unit}",
            per_cent(abs(share.energy) / total),
        ]
        for share in shown
    ]
