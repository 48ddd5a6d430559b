"""What each hertz of the knee's position loop costs in grams, and each kN/mm under shaking.

The knee of servo_knee.yaml is re-optimised for least mass over the bandwidth required of its
position loop, and over the dynamic stiffness required at the impact's frequency, from where each
is free to the most that any design within the bounds reaches. Closed forms stand beside it, and
what other single changes give in bandwidth at the same mass.

    python designs/scripts/knee_dynamics.py                  # prints the table
    python designs/scripts/knee_dynamics.py --out reports    # and writes the report there
    python designs/scripts/knee_dynamics.py --quick          # few points
"""

from __future__ import annotations

import argparse
import json
from math import ceil, floor, pi, sqrt
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.quantities import METRICS
from actuator_opt.reporting.blocks import column, figure, table
from actuator_opt.reporting.figures import Axes
from actuator_opt.reporting.ink import BLACK, BLUE, GREY, RED, Ink
from actuator_opt.reporting.text import fixed, number
from actuator_opt.reporting.writer import TEMPLATE, sheets
from actuator_opt.tables import aligned

DESIGN = Path(__file__).resolve().parents[1] / "servo_knee.yaml"
ASKED = ("bandwidth", "dynamic_stiffness")
BY = {"bandwidth": "g/Hz", "dynamic_stiffness": "g per kN/mm"}
SHARES = (0.0, 0.12, 0.25, 0.4, 0.55, 0.7, 0.82, 0.92, 0.99)
"""Where points lie between what is free and the most that is within reach."""
STEEP = 0.7
"""The share that is priced beside the design as required."""
FREE = 1e-6
"""Mass (relative) that still counts as none."""
CHANGES: dict[str, dict[str, str]] = {
    "as it is": {},
    "spool of 60 Hz": {"valve.natural_frequency": "60 Hz"},
    "spool of 90 Hz": {"valve.natural_frequency": "90 Hz"},
    "spool of 240 Hz": {"valve.natural_frequency": "240 Hz"},
    "spool of 1 kHz": {"valve.natural_frequency": "1000 Hz"},
    "half the dead volume": {
        "cylinder.dead_volume_a": "1.5 ml",
        "cylinder.dead_volume_b": "1.5 ml",
    },
    "a fifth of the air": {"fluid.air_content": "0.1 %"},
    "half as much leakage again in the valve": {"valve.leakage_flow": "0.3 l/min"},
    "half as much bleed again allowed": {"requirements.leakage.max": "450 ml/min"},
    "350 N of friction allowed": {"requirements.friction_running.max": "350 N"},
    "load of 16 kg": {"load.mass": "16 kg"},
    "load of 24 kg": {"load.mass": "24 kg"},
}
"""Single changes, each re-optimised for bandwidth at the mass of the design as required."""
SAID = {
    "bonds over the temperature range": "bond over temperature",
    "end plate bending": "end plates",
    "barrel.layup[0].thickness upper": "liner as thick as allowed",
    "barrel.layup[1].thickness upper": "hoop plies as thick as allowed",
    "barrel.layup[2].angle lower": "least winding angle",
    "rod.inner_diameter lower": "rod bore as small as allowed",
    "head.length lower": "shortest head",
    "piston.leakage_conductance lower": "least bleed",
    "stiffness_min": "static stiffness",
    "friction_running": "friction",
}

Data = dict[str, Any]


def ultimate_speed_gain(
    *, frequency: float, damping: float, spool: float = 0.0, spool_damping: float = 0.7
) -> float:
    """Velocity gain over 2 pi [Hz] at which an integrator, a resonance and a spool swing.

    The phase of the three is -180 degrees where (1 - x)(1 - y) = 4 zeta zeta_v sqrt(x y) with
    x = (f/f_0)^2 and y = (f/f_v)^2. Without the spool's lag (`spool` 0) that is at f_0 and the
    gain 2 zeta f_0 [Merritt1967].
    """
    if not spool:
        return 2 * damping * frequency
    product, crossed = frequency * spool, 4 * damping * spool_damping
    half = (frequency**2 + spool**2 + crossed * product) / 2
    low = half - sqrt(half**2 - product**2)
    x, y = low / frequency**2, low / spool**2
    return sqrt(low) * (2 * damping * sqrt(x) * (1 - y) + 2 * spool_damping * sqrt(y) * (1 - x))


def shaken_stiffness(
    *, stiffness: float, mass: float, frequency: float, corner: float
) -> float:
    """Dynamic stiffness of a mass on a spring that leaks (Maxwell), |k i f/(i f + f_c) - m w^2|."""
    spring = stiffness * 1j * frequency / (1j * frequency + corner)
    return abs(spring - mass * (2 * pi * frequency) ** 2)


def wishes(
    *, without: str = "", goal: str = "", mass: float | None = None
) -> ao.Actuator:
    """The knee; one requirement left out, another goal, and a mass to stay within."""
    data = yaml.load(DESIGN.read_text("utf-8"), Loader=yaml.BaseLoader)
    data["requirements"].pop(without, None)
    if mass is not None:
        data["requirements"]["mass"] = {"max": f"{mass!r} kg"}
    if goal:
        data["objective"] = {"maximise": goal}
    return ao.read(yaml.safe_dump(data, sort_keys=False))


def point(metric: str, asked: float, start: Data, *, priced: bool = False) -> Data:
    """The lightest design for one requirement, searched from a neighbour's dimensions."""
    knee = ao.read(DESIGN).changed(start | {f"requirements.{metric}.min": asked})
    return measured(ao.optimise(knee, starts=1, prices=priced), metric, asked)


def measured(found: Any, metric: str, asked: float | None = None) -> Data:
    """The numbers of an optimum, SI, with the closed forms beside them."""
    evaluation, design, dynamics = found.evaluation, found.design, found.evaluation.dynamics
    loops = (dynamics.position_loop, *dynamics.other_loops)
    fast, slow = loops[0], min(loops, key=lambda one: one.bandwidth)
    speeds = [float(one.open_magnitude[0] * dynamics.frequencies[0]) for one in (fast, slow)]
    weakest = int(dynamics.closed_frequency.argmin())
    frequency, damping = (float(a[weakest]) for a in (dynamics.frequency, dynamics.damping_ratio))
    valve, supply = design.valve, design.supply
    drop = supply.pressure - supply.return_pressure
    share = speeds[1] / speeds[0] / fast.gain_margin
    lag = {"spool": valve.natural_frequency, "spool_damping": valve.damping_ratio}
    mode = {"frequency": frequency, "damping": damping}
    area, force = pi / 4 * design.cylinder.bore**2, design.load_cases[0].force
    layers = [layer.thickness for layer in design.barrel.layup]
    return {
        "asked": asked,
        "status": found.status,
        "mass": evaluation.metrics["mass"].value,
        "values": {v.path: v.value for v in found.variables},
        "binds": [] if found.kkt is None else list(found.kkt.active),
        "prices": {
            row.parameter.split(".")[1]: row.price
            for row in found.sensitivities
            if row.active and row.parameter.startswith("requirements.")
        },
        "metrics": {
            name: evaluation.metrics[name].value
            for name in (*ASKED, "stiffness_min", "leakage", "gain_margin", "phase_margin")
        },
        "wall": sum(layers),
        "frequency": frequency,
        "damping": damping,
        "speed_gains": speeds,
        "fast_bandwidth": fast.bandwidth,
        "merritt": share * ultimate_speed_gain(**mode),
        "with_spool": share * ultimate_speed_gain(**mode, **lag),
        "maxwell": shaken_stiffness(
            stiffness=evaluation.metrics["stiffness_min"].value,
            mass=dynamics.mass,
            frequency=dynamics.shaken[0][1],
            corner=2 * dynamics.conductance_share * frequency,
        ),
        "valve_power": 2 * valve.leakage_flow * sqrt(drop / 2 / valve.leakage_drop) * drop,
        "bleed_power": design.piston.leakage_conductance * drop**2,
        "sag": design.piston.leakage_conductance * force / area**2 / (2 * pi * speeds[1]),
    }


def series(metric: str, required: Data, shares: tuple[float, ...], priced: bool) -> Data:
    """Optima from where the requirement is free to the most within reach."""
    without = ao.optimise(wishes(without=metric), starts=1, prices=False)
    light = (1 + FREE) * without.objective_value
    free = ao.optimise(wishes(without=metric, goal=metric, mass=light), starts=1, prices=False)
    most = ao.optimise(wishes(without=metric, goal=metric), starts=3, prices=False)
    low, high = free.objective_value, most.objective_value
    points, start = [], {v.path: v.value for v in free.variables}
    for share in shares:
        asked = low + share * (high - low)
        points.append(point(metric, asked, start, priced=priced and share == STEEP))
        start = points[-1]["values"]
    points = sorted([*points, required | {"asked": required["metrics"][metric]}], key=_asked)
    return {"free": low, "most": measured(most, metric, high), "points": points}


def _asked(row: Data) -> float:
    return float(row["asked"])


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    knee = ao.read(DESIGN)
    required = measured(ao.optimise(knee, starts=2, prices=not quick), "bandwidth")
    shares = (0.0, 0.5, 0.9) if quick else SHARES
    changes = list(CHANGES)[:: 4 if quick else 1]
    at_mass = wishes(without="bandwidth", goal="bandwidth", mass=(1 + FREE) * required["mass"])
    return {
        "version": ao.__version__,
        "required": required,
        "spool": knee.design.valve.natural_frequency,
        "series": {name: series(name, required, shares, not quick) for name in ASKED},
        "changes": {
            name: measured(
                ao.optimise(at_mass.changed(CHANGES[name]), starts=1, prices=False), "bandwidth"
            )
            for name in changes
        },
    }
