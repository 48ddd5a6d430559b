"""Where the energy of a Simulation went: from what gave it to what took it, and over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from ..base.quantities import RESULTS
from ..rendering.axes import Axes, Box, even_ticks, fitted, per_cent
from ..rendering.ink import BLUE, GREY, PALE, Ink, spread_within, text_width
from ..rendering.text import number, value_text
from ..simulation.result import Simulation
from .simulation_axes import COLOURS, DASHES, ZERO, lines, steady_range, time_axis
from .wall_figures import OCHRE

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
"""Doors whose name has no room beside a curve."""
SMALL = 2e-3
"""Share of all energy below which a door is counted with others (a choice: a hair on paper)."""
USEFUL = ("load", "joint")
"""Doors that are told whatever their share: what the actuator is there for."""
MOST_ROWS = 9
"""Rows of the energy figure."""
MOST_CURVES = 5
"""Energies shown over time."""
AGREES = 0.01
"""Share of all energy within which a sampled power must add up to its door (a choice)."""
ROW, TOP = 3.7, 7.0
"""Height of a row, and of the title above the rows [mm]."""
GIVEN, TAKEN, KEPT = BLUE, OCHRE, "#7d868e"


class Share(NamedTuple):
    """What gave (positive) or took (negative) energy over the run [J]."""

    name: str
    energy: float


def shares(found: Simulation) -> list[Share]:
    """What gave energy, the supply first, then what took it, by size; small ones summed."""
    doors = [Share(one.name, one.energy) for one in found.balance.flows]
    doors.append(Share("store", -sum(one.energy for one in found.balance.stored)))
    total = sum(one.energy for one in doors if one.energy > 0)
    if total <= 0:
        return []
    order = sorted(doors, key=lambda one: (one.energy < 0, one.name != "supply", -abs(one.energy)))
    small = [one for one in order if abs(one.energy) < SMALL * total and one.name not in USEFUL]
    large = [one for one in order if one not in small]
    taken = [one for one in large if one.energy < 0 and one.name not in USEFUL]
    while len(large) > MOST_ROWS - 1 and len(taken) > 1:
        last = taken.pop()
        large.remove(last)
        small.append(last)
    rest = sum(one.energy for one in small)
    moved = [one for one in small if one.energy]
    if moved:
        words = moved[0].name if len(moved) == 1 else f"{len(moved)} others"
        large.append(Share(words, rest))
    return [Share(_words(one), one.energy) for one in large]


def _words(one: Share) -> str:
    if one.name == "store":
        return "out of oil, walls, motion" if one.energy > 0 else "into oil, walls, motion"
    if one.energy > 0 and one.name in ("load", "joint", "machine outside", "held ports"):
        return f"from the {one.name}"
    return one.name


def rows_of(found: Simulation) -> int:
    """Rows of the energy figure."""
    return len(shares(found))


def share_panel(ink: Ink, box: Box, found: Simulation) -> None:
    """What came in as bars from the left, what went out as bars back to nothing."""
    left, top, width, _ = box
    shown = shares(found)
    if not shown:
        return
    title = "Where the energy went"
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    efficiency = found.values.get("efficiency")
    if efficiency is not None:
        said = f"efficiency {value_text(RESULTS['efficiency'], efficiency, 3)}"
        ink.text(left + width, top + 2.0, said, anchor="right", color=GREY)
    total = sum(one.energy for one in shown if one.energy > 0)
    values = [value_text(ENERGY, abs(one.energy), 4) for one in shown]
    parts = [per_cent(abs(one.energy) / total) for one in shown]
    wide = max(text_width(words, 6.2) for words in values)
    names = min(max(text_width(one.name, 6.2) for one in shown), 0.42 * width)
    ends = left + width - wide - 12.5
    axes = Axes(ink, (left + names + 1.5, top, ends - left - names - 2.5, 1.0), (0, total), (0, 1))
    level = 0.0
    for k, (one, words, part) in enumerate(zip(shown, values, parts, strict=True)):
        y = top + TOP + ROW * (k + 0.5)
        ink.text(left + names, y, fitted(one.name, names, 6.2), size=6.2, anchor="right")
        begin, level = level, level + one.energy
        ends_at = sorted(min(max(v, 0.0), total) for v in (begin, level))
        colour = KEPT if "oil and walls" in one.name else GIVEN if one.energy > 0 else TAKEN
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


def _product(found: Simulation, *names: str) -> Array | None:
    """Product of signals, None where one is missing."""
    if any(name not in found.signals for name in names):
        return None
    value = np.ones_like(found.time)
    for name in names:
        value = value * found.signals[name]
    return value


def _valve(found: Simulation) -> Array | None:
    """Power that the edges turn to heat: supply less what reaches ports and tank."""
    if "flow_supply" not in found.signals:
        return None
    held = found.scenario.held_ports
    ports = [found.signals.get(name) for name in ("pressure_a", "pressure_b")]
    if held is not None:
        ports = [np.full_like(found.time, p) for p in (held.pressure_a, held.pressure_b)]
    if ports[0] is None or ports[1] is None:
        return None
    own = found.signals
    into = ports[0] * own["flow_a"] + ports[1] * own["flow_b"]
    out = found.plant.return_pressure * own["flow_tank"]
    return np.asarray(own["pressure_supply"] * own["flow_supply"] - into - out)


def _leaked(found: Simulation) -> Array | None:
    across = _product(found, "flow_leakage")
    if across is None:
        return None
    return across * (found.signals["pressure_a"] - found.signals["pressure_b"])


def _motor(found: Simulation) -> Array | None:
    flow, work = _product(found, "flow_motor"), _product(found, "torque", "shaft_speed")
    if flow is None or work is None:
        return None
    return flow * (found.signals["pressure_a"] - found.signals["pressure_b"]) - work


def _load(found: Simulation) -> Array | None:
    work = _product(found, "load_torque", "shaft_speed")
    return _product(found, "load_force", "speed") if work is None else work


def _at_unit(found: Simulation) -> str:
    """Signal of the pressure at pump or accumulator: a pipe parts it from the valve's."""
    return "pressure_unit" if "pressure_unit" in found.signals else "pressure_supply"


def _supply(found: Simulation) -> Array | None:
    flows = ("flow_pump", "flow_unit", "flow_supply")
    given = next((name for name in flows if name in found.signals), "flow_supply")
    return _product(found, _at_unit(found), given)


def _returned(found: Simulation) -> Array | None:
    flow = _product(found, "flow_tank")
    return None if flow is None else found.plant.return_pressure * flow


POWERS: dict[str, Callable[[Simulation], Array | None]] = {
    "supply": _supply,
    "valve edges": _valve,
    "relief valve": lambda found: _product(found, _at_unit(found), "flow_relief"),
    "return line": _returned,
    "load": _load,
    "friction of the seals": lambda found: _product(found, "friction", "speed"),
    "losses of the motor": _motor,
    "leakage across the piston": _leaked,
}
"""Power of a door by the signals [W]; None where they do not tell it."""


def _summed(found: Simulation) -> tuple[dict[str, Array], dict[str, float]]:
    """Energy through every door whose power is known, and how far its end is off the door's own.

    Energies [J] are positive out of the doors, but for the supply's; what is off is a share of all.
    """
    doors: dict[str, float] = {one.name: one.energy for one in found.balance.flows}
    ways = [sum(abs(e) for e in doors.values() if (e > 0) == way) for way in (True, False)]
    curves: dict[str, Array] = {}
    off: dict[str, float] = {}
    for name, power_of in POWERS.items():
        power = power_of(found) if name in doors else None
        if power is None or not np.all(np.isfinite(power)):
            continue
        steps = 0.5 * (power[1:] + power[:-1]) * np.diff(found.time)
        energy = np.concatenate(([0.0], np.cumsum(steps)))
        ends = doors[name] if name == "supply" else -doors[name]
        curves[name] = energy
        off[name] = float(energy[-1] - ends) / (max(ways) or 1.0)
    return curves, off


def over_time(found: Simulation) -> dict[str, Array]:
    """Energy through the largest doors over time [J], out of them positive but for the supply's.

    A door whose sampled power does not add up to its own energy is left out.
    """
    curves, off = _summed(found)
    curves = {name: one for name, one in curves.items() if abs(off[name]) <= AGREES}
    sizes: Mapping[str, float] = {name: float(np.ptp(one)) for name, one in curves.items()}
    most = max(sizes.values(), default=0.0)
    names = sorted(sizes, key=lambda name: -sizes[name])[:MOST_CURVES]
    return {name: curves[name] for name in curves if name in names and sizes[name] > SMALL * most}


_LOADED = ("load", "valve edges")
"""Doors whose power the signals tell only without lines, a joint or a machine outside."""


def doubts(found: Simulation) -> list[str]:
    """Doors whose energy is not what their sampled power adds up to, in one sentence."""
    _, off = _summed(found)
    wrong = {n: e for n, e in off.items() if abs(e) > AGREES and n not in _LOADED}
    if not wrong:
        return []
    said = ", ".join(f"{name} by {number(100 * e, 2, signed=True)} %" for name, e in wrong.items())
    return [
        f"powers at the samples add up to other energies than the integration tells: {said} of all"
        " energy; take shorter samples, and doubt the energies where that does not help"
    ]


def time_panel(ink: Ink, box: Box, found: Simulation, curves: Mapping[str, Array]) -> None:
    """Energies over time, each named at its end."""
    left, top, width, height = box
    scale = ENERGY.to_display(1.0)
    words = {name: BRIEF.get(name, name) for name in curves}
    side = max(text_width(one, 6.2) for one in words.values()) + 4.5
    frame = (left + 11.0, top + 6.5, width - 11.0 - side, height - 6.5 - 7.5)
    ends = [float(scale * v) for one in curves.values() for v in (np.min(one), np.max(one))]
    axes = Axes(ink, frame, (0.0, float(found.time[-1])), steady_range(ends, zero=True))
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
        drawn = lines(axes, found.time, scale * curves[name])
        ink.path(drawn, stroke=colour, pen=0.3, dash=dash)
        ink.line((right, y), (right + 3.5, place), stroke=PALE, pen=0.13)
        ink.text(right + 4.0, place, words[name], size=6.2, color=colour)
    time_axis(axes)


def table_rows(found: Simulation) -> list[list[str]]:
    """Every share in words: name, energy with its sign, share of what came in."""
    shown = shares(found)
    total = sum(one.energy for one in shown if one.energy > 0)
    return [
        [
            one.name,
            f"{number(one.energy, 4, signed=True)} {ENERGY.unit}",
            per_cent(abs(one.energy) / total),
        ]
        for one in shown
    ]
