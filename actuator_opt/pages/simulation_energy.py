"""Energies of a simulation: the share of each source and sink, and the energies over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from ..base.quantities import RESULTS
from ..rendering.axes import per_cent, time_words
from ..rendering.chart import Axis, Curve, Panel
from ..rendering.ink import Ink
from ..rendering.text import number, value_text
from ..rendering.waterfall import WaterfallBar, waterfall
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
"""Short names of energy flows, written beside their curves."""
SMALL = 2e-3
"""Energy flows below this share of all energy are summed as "others" (our choice, as their bars
would be hairlines)."""
USEFUL = ("load", "joint")
"""Energy flows that are always shown, however small, as they are the actuator's purpose."""
MOST_ROWS = 9
"""Largest number of rows in the energy figure."""
MOST_CURVES = 5
"""Largest number of energies shown over time."""
AGREES = 0.01
"""Greatest allowed difference between an energy and the integral of its sampled power, as a share
of all energy (our choice)."""


class EnergyShare(NamedTuple):
    """Total energy from a source (positive) or into a sink (negative) during the run [J]."""

    name: str
    energy: float


def shares(simulation: Simulation) -> list[EnergyShare]:
    """Sources of energy (the supply first), then sinks by size; small shares are summed."""
    flows = [EnergyShare(flow.name, flow.energy) for flow in simulation.balance.flows]
    flows.append(EnergyShare("store", -sum(store.energy for store in simulation.balance.stored)))
    total = sum(share.energy for share in flows if share.energy > 0)
    if total <= 0:
        return []
    order = sorted(
        flows, key=lambda share: (share.energy < 0, share.name != "supply", -abs(share.energy))
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
    moved = [share for share in small if share.energy]
    if moved:
        words = moved[0].name if len(moved) == 1 else f"{len(moved)} others"
        large.append(EnergyShare(words, sum(share.energy for share in small)))
    return [EnergyShare(_words(share), share.energy) for share in large]


def _words(share: EnergyShare) -> str:
    if share.name == "store":
        return (
            "released by oil, walls, motion" if share.energy > 0 else "stored in oil, walls, motion"
        )
    if share.energy > 0 and share.name in ("load", "joint", "machine outside", "held ports"):
        return f"from the {share.name}"
    return share.name


def share_picture(simulation: Simulation, width: float) -> Ink | None:
    """Picture of the sources and sinks of energy; None if there are no sources."""
    shown = shares(simulation)
    if not shown:
        return None
    efficiency = simulation.values.get("efficiency")
    beside = ""
    if efficiency is not None:
        beside = f"efficiency {value_text(RESULTS['efficiency'], efficiency, 3)}"
    steps = [
        WaterfallBar(
            share.name,
            share.energy,
            value_text(ENERGY, abs(share.energy), 4),
            kept="oil, walls" in share.name,
        )
        for share in shown
    ]
    return waterfall("Where the energy went", steps, width, beside=beside)


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
    """Power dissipated at the valve edges: supply power minus the power to ports and tank."""
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
    """Name of the signal for the pressure at the pump or accumulator.

    Between the pump or accumulator and the valve there may be a pipe.
    """
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
"""Power of each energy flow, computed from the signals [W]; None if signals are missing."""


def _summed(simulation: Simulation) -> tuple[dict[str, Array], dict[str, float]]:
    """For every energy flow of known power: energy over time [J], and its error at the end.

    Energy that leaves the machine is positive; only for the supply, energy that enters is positive.
    The error is the difference from the energy that the simulation integrated, as a share of all
    energy.
    """
    flows: dict[str, float] = {flow.name: flow.energy for flow in simulation.balance.flows}
    ways = [sum(abs(e) for e in flows.values() if (e > 0) == way) for way in (True, False)]
    curves: dict[str, Array] = {}
    off: dict[str, float] = {}
    for name, power_of in POWERS.items():
        power = power_of(simulation) if name in flows else None
        if power is None or not np.all(np.isfinite(power)):
            continue
        steps = 0.5 * (power[1:] + power[:-1]) * np.diff(simulation.time)
        energy = np.concatenate(([0.0], np.cumsum(steps)))
        ends = flows[name] if name == "supply" else -flows[name]
        curves[name] = energy
        off[name] = float(energy[-1] - ends) / (max(ways) or 1.0)
    return curves, off


def over_time(simulation: Simulation) -> dict[str, Array]:
    """The largest energies over time [J].

    Energy that leaves the machine is positive; only for the supply, energy that enters is positive.
    An energy flow is left out if the integral of its sampled power differs by more than `AGREES`
    from the energy that the simulation integrated.
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
"""Energy flows whose power can be computed from the signals only if the system has no hydraulic
lines, no joint, and no external machine that moves the rod."""


def doubts(simulation: Simulation) -> list[str]:
    """A sentence on energy flows whose energy differs from the integral of their sampled power."""
    _, off = _summed(simulation)
    wrong = {
        name: error for name, error in off.items() if abs(error) > AGREES and name not in _LOADED
    }
    if not wrong:
        return []
    errors = ", ".join(
        f"{name} by {number(100 * error, 2, signed=True)} %" for name, error in wrong.items()
    )
    return [
        f"energies summed from the sampled powers differ from the integrated energies: {errors} of "
        "all energy; sample more often; if that does not help, do not trust the energies"
    ]


def time_panel(simulation: Simulation, energies: Mapping[str, Array]) -> Panel:
    """Energies over time, each named at its end."""
    label, factor = time_words(float(simulation.time[-1]))
    scale = ENERGY.to_display(1.0)
    return Panel(
        f"Energy over time, {ENERGY.unit}",
        Axis(label),
        Axis(zero=True),
        curves=[
            Curve("", factor * simulation.time, scale * values, end=BRIEF.get(name, name))
            for name, values in energies.items()
        ],
    )


def table_rows(simulation: Simulation) -> list[list[str]]:
    """Table rows: name of a source or sink, signed energy, and share of all sources."""
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
