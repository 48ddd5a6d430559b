"""Short simulations of every kind that a page shows."""

from __future__ import annotations

import itertools
from functools import cache
from pathlib import Path

import actuator_opt as ao
from actuator_opt.design.scenario.model import Scenario
from actuator_opt.simulation.result import Simulation
from actuator_opt.simulation.run import simulate

DESIGNS = Path(__file__).parents[2] / "designs"
SOURCE = (DESIGNS / "servo_knee.yaml").read_text(encoding="utf-8")
STEP = {
    "duration": 1.0,
    "control": {
        "position": [
            {"shape": "step", "start": 0.1, "value": 0.02},
            {"shape": "step", "start": 0.6, "value": -0.03},
        ]
    },
    "load": {"force": [{"shape": "constant", "value": 2000.0}]},
    "requirements": {
        "overshoot": {"max": 0.05},
        "settling_time": {"max": 0.02},
        "cavitation_margin": {"min": 1e5},
    },
}
MACHINE = {
    "displacement": 13.3e-6,
    "slip": 150e-9,
    "coulomb": 0.16,
    "viscous": 1e5,
    "constant_torque": 0.1,
}
LINE = {"length": 3.0, "inner_diameter": 0.008}
SHAKE = [{"shape": "sine", "value": 500.0, "frequency": 20.0}]
SCENARIOS = {
    "step": STEP,
    "down": STEP
    | {"control": {"position": [{"shape": "step", "start": 0.1, "value": -0.02}], "law": "pi",
                   "tuning": "ziegler_nichols"}},
    "sine": {
        "duration": 1.0,
        "control": {"position": [{"shape": "sine", "value": 0.01, "frequency": 4.0}]},
    },
    "speed": {
        "duration": 0.5,
        "control": {"speed": [{"shape": "step", "start": 0.1, "value": 0.1}], "law": "pi"},
    },
    "open": {
        "duration": 0.8,
        "signal": [
            {"shape": "pulse", "start": 0.1, "end": 0.5, "value": 6.0},
            {"shape": "step", "start": 0.6, "value": -3.0},
        ],
    },
    "pump": {
        "duration": 0.5,
        "supply": {
            "type": "fixed_pump",
            "flow": 8 / 60000,
            "volume": 5e-4,
            "relief": {"pressure": 200e5, "rated_flow": 10 / 60000},
            "accumulator": {"gas_volume": 2e-4, "precharge": 120e5},
        },
        "signal": [{"shape": "sine", "start": 0.1, "frequency": 4.0, "value": 6.0}],
    },
    "line": {
        "duration": 0.5,
        "supply": {"line": LINE},
        "signal": [{"shape": "sine", "start": 0.1, "frequency": 4.0, "value": 6.0}],
    },
    "pump line": {
        "duration": 0.5,
        "supply": {
            "type": "fixed_pump",
            "flow": 8 / 60000,
            "volume": 5e-4,
            "relief": {"pressure": 200e5, "rated_flow": 10 / 60000},
            "line": LINE,
        },
        "signal": [{"shape": "sine", "start": 0.1, "frequency": 4.0, "value": 6.0}],
    },
    "closed": {
        "duration": 1.0,
        "ends": "closed",
        "sample_time": 5e-4,
        "initial": {"pressure_a": 20.5e5, "pressure_b": 42e5},
        "load": {"force": SHAKE},
    },
    "stroke": {
        "duration": 4.0,
        "sample_time": 2e-3,
        "initial": {"position": 0.05, "pressure_a": 20.5e5, "pressure_b": 42e5},
        "load": {
            "force": SHAKE,
            "drive": {
                "position": [{"shape": "ramp", "start": 0.0, "end": 4.0, "value": 0.1}],
                "stiffness": 1e5,
                "damping": 1e3,
            },
        },
        "analysis": {"window_cycles": 10},
    },
    "motor": {
        "duration": 1.0,
        "motor": {
            "machine": MACHINE,
            "inertia": 13.3e-3,
            "pipe_volume": 1e-4,
            "torque": [{"shape": "step", "start": 0.7, "value": 3.0}],
        },
        "control": {
            "shaft_speed": [{"shape": "step", "start": 0.1, "value": 60.0}],
            "shaft_speed_gain": 1.0,
            "tuning": "stated",
        },
    },
    "bench": {
        "duration": 2.0,
        "held_ports": {"pressure_a": 35e5, "pressure_b": 35e5},
        "signal": [
            {"shape": "constant", "value": -10.0},
            {"shape": "ramp", "start": 0.0, "end": 2.0, "value": 20.0},
        ],
    },
}  # fmt: skip
KINDS = tuple(SCENARIOS)
RIG = ("closed", "stroke")


@cache
def simulated(kind: str, **changes: str) -> Simulation:
    """A run of a kind; `changes` are values of its design."""
    name = "aalto_40_25_220.yaml" if kind in RIG else "servo_knee.yaml"
    subject = ao.read(str(DESIGNS / name), set=dict(changes)).subject()
    stated = {"name": f"{kind} run", "design": name} | SCENARIOS[kind]
    return simulate(Scenario.model_validate(stated), subject, verify=kind == "step")


@cache
def tuned() -> tuple[tuple[str, Simulation], ...]:
    """The same step under several controllers."""
    laws = (
        ("P", {"law": "p"}),
        ("PI", {"law": "pi"}),
        ("PID", {"law": "pid"}),
        ("PID, half K", {"law": "pid", "gain_factor": 0.5}),
        ("PID, double T_d", {"law": "pid", "derivative_factor": 2.0}),
    )
    subject = ao.read(SOURCE).subject()
    found = []
    for name, law in laws:
        control = {
            "position": [{"shape": "step", "start": 0.05, "value": 0.02}],
            "tuning": "ziegler_nichols",
        } | law
        stated = {"name": name, "design": "x.yaml", "duration": 0.5, "control": control}
        stated["requirements"] = {"overshoot": {"max": 0.05}}
        found.append((name, simulate(Scenario.model_validate(stated), subject)))
    return tuple(found)


def boxes_collide(ink):
    """Pairs of texts that overlap, texts and lines that leave the paper."""
    bad = []
    boxes = ink.text_boxes()
    for words, left, top, right, bottom in boxes:
        if min(left, ink.width - right, top, ink.height - bottom) < -0.5:
            bad.append(words)
    for box, other in itertools.combinations(boxes, 2):
        apart = box[3] <= other[1] or other[3] <= box[1]
        if not (apart or box[4] <= other[2] or other[4] <= box[2]):
            bad.append((box[0], other[0]))
    points = [p for mark in ink.marks if "path" in mark for line in mark["path"] for p in line]
    outside = [(x, y) for x, y in points if not (-0.01 <= x <= ink.width + 0.01)]
    return bad + outside + [(x, y) for x, y in points if not (-0.01 <= y <= ink.height + 0.01)]
