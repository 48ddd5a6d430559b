"""The servos of the course MEC-E5005 tuned by Ziegler and Nichols, and what else its report asks.

P, PI and PID of three loops from the ultimate point of the linear loop; then each part of the PID
halved and doubled; beside them the tool's own tuning, and the rule on the ultimate point that is
found by raising the gain until the loop swings, as on a rig. The loop of the motor's angle is an
extra: the course asks the variations of the other two.

    python designs/scripts/course_servo.py                  # prints the tables
    python designs/scripts/course_servo.py --out reports    # and writes the report there
    python designs/scripts/course_servo.py --quick          # fewer cases
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np

import actuator_opt as ao
from actuator_opt.api import read_scenario, simulate
from actuator_opt.base.tables import aligned
from actuator_opt.models.loop import ziegler_nichols
from actuator_opt.pages.simulation_comparison import LEAST, comparison_figure
from actuator_opt.rendering.blocks import Block, Drawing, Notes, Table
from actuator_opt.rendering.script_pages import (
    Sheets,
    grid_table,
    rounded,
    run_script,
    study_report,
)
from actuator_opt.rendering.text import fixed, number
from actuator_opt.simulation import Simulation
from actuator_opt.simulation.sensitivity import sensitivities

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
LAWS = ("p", "pi", "pid")
PARTS = {"P": "gain_factor", "I": "integral_factor", "D": "derivative_factor"}
STEP = 1.25
"""Factor between two gains that are tried before the swing is closed in on."""
SURE, QUICK = 1.01, 1.05
"""Factor between a gain that swings and one that does not."""
SWING, KEPT = 1e-4, 0.9
"""A loop swings where it still does so by this share of the step, and by this share of a quarter of
the time before (choices)."""
SHOWN = ("P", "PI", "PID", "own PI")
"""What the figures draw."""
MOST = 7
"""Parameters that a table of sensitivities shows."""

Data = dict[str, Any]


@dataclass(frozen=True)
class Loop:
    """A loop of the course."""

    title: str
    file: str
    signal: str
    unit: str
    factor: float
    """From V per SI unit to `unit`."""
    digits: int = 3


LOOPS = {
    "position": Loop("Position servo 1: cylinder", "position_servo", "position", "V/m", 1.0),
    "speed": Loop(
        "Velocity servo: motor", "motor_velocity", "shaft_speed", "mV/rpm", 1e3 * pi / 30
    ),
    "angle": Loop(
        "Position servo 2: motor, an extra", "motor_position", "shaft_angle", "V/rad", 1.0
    ),
}
RAISED: dict[str, tuple[str, dict[str, str]]] = {
    "cylinder, 50 mm": ("position", {}),
    "cylinder, 1 mm": ("position", {"control.position[0].value": "1 mm"}),
    "cylinder, static friction curve": ("position", {"friction.model": "stribeck"}),
    "cylinder, 1 N of dry friction": (
        "position",
        {"friction.coulomb": "1 N", "friction.static": "1 N"},
    ),
    "motor, 100 rpm": ("speed", {"control.shaft_speed[0].value": "100 rpm"}),
    "motor, 500 rpm": ("speed", {"control.shaft_speed[0].value": "500 rpm"}),
    "motor, 1000 rpm": ("speed", {}),
    "motor, one turn": ("angle", {}),
}
"""Loops whose gain is raised until they swing."""
NEEDED = ("cylinder, 50 mm", "motor, 1000 rpm", "motor, one turn")
"""The three as they are."""
HINTS: dict[str, dict[str, str]] = {
    "as it is": {},
    "32 l/min": {"valve.rated_flow": "32 l/min"},
    "leakage split 60/40 bar": {
        "valve.leakage_drop": "60 bar",
        "valve.tank_leakage_drop": "40 bar",
    },
    "zero adjustment": {"valve.offset": "19.9 mV"},
    "static friction curve": {"friction.model": "stribeck"},
    "pipes of 84.8 ml": {
        "cylinder.dead_volume_a": "84.8 ml",
        "cylinder.dead_volume_b": "84.8 ml",
    },
}
"""The course's hints on its test case."""
CYLINDER = (
    "materials.iso_vg_32.bulk_modulus", "fluid.air_content", "supply.pressure", "cylinder.bore",
    "rod.outer_diameter", "cylinder.dead_volume_a", "cylinder.dead_volume_b", "valve.rated_flow",
    "valve.leakage_flow", "valve.natural_frequency", "valve.damping_ratio", "load.mass",
    "friction.coulomb", "friction.static", "friction.stribeck_speed", "friction.viscous",
    "stiffness.seal_deflection",
)  # fmt: skip
MOTOR = (
    "materials.iso_vg_32.bulk_modulus", "supply.pressure", "valve.rated_flow",
    "valve.leakage_flow", "valve.natural_frequency", "motor.machine.displacement",
    "motor.machine.slip", "motor.machine.coulomb", "motor.machine.viscous", "motor.inertia",
    "motor.pipe_volume", "motor.torque[0].value",
)  # fmt: skip
SENSITIVE = {
    "open_loop": ("the test case", CYLINDER, ("hold_drift", "peak_pressure")),
    "position_servo": (
        "position servo 1, P",
        CYLINDER,
        ("rise_time", "settling_time", "steady_state_ratio"),
    ),
    "motor_velocity": (
        "velocity servo, own PI",
        MOTOR,
        ("rise_time", "settling_time", "overshoot"),
    ),
}
"""Scenarios with the parameters that are moved and the results that are read."""


def scenario(name: str) -> Path:
    """File of a scenario of the course."""
    return SCENARIOS / f"course_{name}.yaml"


def played(loop: Loop, law: str, **values: str) -> Simulation:
    """A loop under a law, with values of its control."""
    stated = {f"control.{name}": value for name, value in values.items()}
    return simulate(scenario(loop.file), set={"control.law": law} | stated, margins=True)


def stated(loop: Loop, law: str, gain: float, period: float) -> Simulation:
    """A loop by the rule from an ultimate point."""
    gains = ziegler_nichols(law=law, ultimate_gain=gain, ultimate_period=period)  # type: ignore[arg-type]
    values = {"tuning": "stated", f"{loop.signal}_gain": repr(float(gains.proportional_gain))}
    if law != "p":
        values["integral_time"] = repr(float(gains.integral_time))
    if law == "pid":
        values["derivative_time"] = repr(float(gains.derivative_time))
    return played(loop, law, **values)


def tuned(loop: Loop) -> dict[str, Simulation]:
    """Every run of a loop's table."""
    rule = {"tuning": "ziegler_nichols"}
    runs = {law.upper(): played(loop, law, **rule) for law in LAWS}
    for part, name in PARTS.items():
        for factor, word in (("0.5", "½"), ("2", "2")):
            runs[f"PID, {part} × {word}"] = played(loop, "pid", **rule | {name: factor})
    return runs | {"own PI": played(loop, "pi")}


# ---- the ultimate point of the loop as it is ----


def swinging(run: Simulation, signal: str) -> bool:
    """Whether the loop swings on."""
    assert run.servo is not None
    begin, end = run.servo.time, float(run.time[-1])
    value = run.signals[signal]
    third = (run.time > begin + 0.5 * (end - begin)) & (run.time < begin + 0.75 * (end - begin))
    before, after = (
        float(np.ptp(value[part])) for part in (third, run.time >= begin + 0.75 * (end - begin))
    )
    return after > SWING * abs(run.servo.target - run.servo.start) and after > KEPT * before


def period(run: Simulation, signal: str) -> float:
    """Of the swing at the end, between crossings of its mean on the way up [s]."""
    late = run.time > 0.8 * run.time[-1]
    t, y = run.time[late], run.signals[signal][late]
    y = y - y.mean()
    up = np.flatnonzero((y[:-1] < 0) & (y[1:] >= 0))
    crossings = t[up] - y[up] * (t[up + 1] - t[up]) / (y[up + 1] - y[up])
    return float((crossings[-1] - crossings[0]) / (len(crossings) - 1))


def raised(name: str, sure: float) -> Data:
    """Ultimate point of a loop as it is, by raising its P gain, beside that of the linear loop."""
    key, values = RAISED[name]
    loop = LOOPS[key]
    at_rest = simulate(scenario(loop.file), set={"control.law": "p"} | values, margins=True)
    assert at_rest.tuned is not None
    linear = at_rest.tuned.ultimate

    def at(ratio: float) -> Simulation:
        gain = {
            "control.law": "p",
            "control.tuning": "stated",
            f"control.{loop.signal}_gain": repr(ratio * linear.gain),
        }
        return simulate(scenario(loop.file), set=values | gain)

    low, high = 0.8, 0.8 * STEP
    while not swinging(at(high), loop.signal):
        low, high = high, high * STEP
    while high / low > sure:
        middle = sqrt(low * high)
        low, high = (low, middle) if swinging(at(middle), loop.signal) else (middle, high)
    return {
        "loop": key,
        "linear": [linear.gain, linear.period],
        "raised": [high * linear.gain, period(at(high), loop.signal)],
        "ratio": high,
    }


# ---- the test case without a loop ----


def pulse(values: dict[str, str]) -> Data:
    """What a change does to the test case: the slides' hints."""
    run = simulate(scenario("open_loop"), set=values)

    def at(name: str, time: float) -> float:
        return float(np.interp(time, run.time, run.signals[name]))

    return {
        "speed": at("speed", 4.1),
        "pressure_a": at("pressure_a", 4.1),
        "pressure_b": at("pressure_b", 4.1),
        "travel": at("position", 4.117) - at("position", 2.923),
        "creep": at("speed", 2.9),
        "rest_a": at("pressure_a", 2.9),
        "rest_b": at("pressure_b", 2.9),
        "lowest": run.values["lowest_pressure"],
    }


def sensitive(name: str) -> list[Data]:
    """The parameters that matter most to a scenario, with what 1 % of each does."""
    trial, (_, names, results) = read_scenario(scenario(name)), SENSITIVE[name]
    found = sensitivities(trial.scenario, trial.actuator.subject(), names, results=results)
    return [
        {
            "path": one.path,
            "per": one.unit,
            "effects": {
                result: effect.percent
                for result, effect in one.effects.items()
                if effect.percent is not None and effect.reliable
            },
        }
        for one in found.parameters[:MOST]
        if one.largest
    ]


# ---- the study ----


@dataclass(frozen=True)
class Study:
    """Runs of every loop, and the rest as plain numbers."""

    runs: dict[str, dict[str, Simulation]]
    swung: dict[str, dict[str, Simulation]]
    """By the rule from the ultimate point that is found by raising the gain."""
    raised: Data
    pulse: Data
    sensitive: Data


def compute(*, quick: bool = False) -> Study:
    """Every run of the study."""
    names = NEEDED if quick else tuple(RAISED)
    found = {name: raised(name, QUICK if quick else SURE) for name in names}
    swung = {}
    for name in NEEDED:
        key, point = found[name]["loop"], found[name]["raised"]
        swung[key] = {law.upper(): stated(LOOPS[key], law, *point) for law in LAWS}
    return Study(
        runs={key: tuned(loop) for key, loop in LOOPS.items()},
        swung=swung,
        raised=found,
        pulse={name: pulse(values) for name, values in HINTS.items()},
        sensitive={} if quick else {name: sensitive(name) for name in SENSITIVE},
    )


def figures(run: Simulation) -> Data:
    """A run as numbers: the parts of its controller, the figures of its step."""
    assert run.tuned is not None
    assert run.servo is not None
    assert run.scenario.control is not None
    gains, control, own = run.tuned.gains, run.scenario.control, run.servo.metrics
    gain = control.gain_factor * float(gains.proportional_gain)
    integral = control.integral_factor * float(gains.proportional_gain / gains.integral_time)
    rate = control.derivative_factor * float(gains.proportional_gain * gains.derivative_time)
    return {
        "gain": gain,
        "integral_time": gain / integral if integral else None,
        "derivative_time": rate / gain,
        "rise_time": own.rise_time,
        "overshoot": own.overshoot,
        "settling_time": own.settling_time,
        "steady_state_error": own.steady_state_error,
        "energy": run.values["supply_energy"],
        "gain_margin": run.tuned.margins.gain if isfinite(run.tuned.margins.gain) else None,
    }


def numbers(study: Study) -> Data:
    """The whole study as plain numbers, SI."""
    data = {
        "version": ao.__version__,
        "loops": {
            key: {
                "linear": [one.gain, one.period],
                "tuned": {name: figures(run) for name, run in runs.items()},
                "swung": {name: figures(run) for name, run in study.swung[key].items()},
            }
            for key, runs in study.runs.items()
            if (one := runs["P"].tuned.ultimate)  # type: ignore[union-attr]
        },
        "raised": study.raised,
        "pulse": study.pulse,
        "sensitive": study.sensitive,
    }
    return rounded(data)


# ---- tables ----


def all_rows(found: Data) -> dict[str, Data]:
    """Rows of a loop: by the rule and its variations, then by the rule on the raised gain."""
    rows: dict[str, Data] = found["tuned"]
    return rows | {f"{name} by raising": row for name, row in found["swung"].items()}


def loop_rows(loop: Loop, rows: dict[str, Data], limit: list[float]) -> list[list[str]]:
    """Heads and rows of a loop's table."""
    error = {
        "position": ("mm", 1e3),
        "shaft_speed": ("rpm", 30 / pi),
        "shaft_angle": ("°", 180 / pi),
    }
    unit, size = error[loop.signal]
    heads = [
        f"rule on {number(loop.factor * limit[0], 4)} {loop.unit}, {number(1e3 * limit[1], 3)} ms",
        f"K, {loop.unit}", "Tᵢ, ms", "T_d, ms", "rise, ms", "overshoot, %", "settles, ms",
        f"error, {unit}", "supply, J", "gain margin",
    ]  # fmt: skip
    made = [heads]
    for name, row in rows.items():
        made.append(
            [
                name,
                number(loop.factor * row["gain"], loop.digits),
                _maybe(row["integral_time"], 1e3),
                _maybe(row["derivative_time"] or None, 1e3),
                _maybe(row["rise_time"], 1e3),
                fixed(100 * row["overshoot"], 1),
                _maybe(row["settling_time"], 1e3),
                _small(size * row["steady_state_error"]),
                fixed(row["energy"], 0),
                _maybe(row["gain_margin"], 1.0),
            ]
        )
    return made


def _maybe(value: float | None, size: float) -> str:
    return "–" if value is None else number(size * value, 3)


def _small(value: float) -> str:
    """An error; what rounding leaves is nothing."""
    return "0" if abs(value) < 1e-3 else number(value, 2)


def raised_rows(data: Data) -> list[list[str]]:
    """Heads and rows: ultimate gain of the linear loop, and by raising it."""
    made = [
        ["loop and step", "linear", "raised", "unit", "ratio", "period linear, ms", "raised, ms"]
    ]
    for name, row in data["raised"].items():
        loop = LOOPS[row["loop"]]
        (gain, time), (most, swing) = row["linear"], row["raised"]
        gains = [number(loop.factor * one, 3) for one in (gain, most)]
        times = [number(1e3 * one, 3) for one in (time, swing)]
        made.append([name, *gains, loop.unit, number(row["ratio"], 3), *times])
    return made


def pulse_rows(data: Data) -> list[list[str]]:
    """Heads and rows: the test case with the slides' hints."""
    heads = ["test case", "speed, m/s", "p_A, bar", "p_B, bar", "travel, mm", "creep at 0 V, mm/s"]
    made = [[*heads, "p_A at 0 V, bar", "p_B at 0 V, bar", "lowest, bar"]]
    for name, row in data["pulse"].items():
        bars = [
            fixed(1e-5 * row[key], 1)
            for key in ("pressure_a", "pressure_b", "rest_a", "rest_b", "lowest")
        ]
        made.append(
            [
                name,
                fixed(row["speed"], 4),
                *bars[:2],
                fixed(1e3 * row["travel"], 1),
                fixed(1e3 * row["creep"], 2),
                *bars[2:],
            ]
        )
    return made


def sensitive_rows(name: str, rows: list[Data]) -> list[list[str]]:
    """Heads and rows: parameters and what 1 % of each changes."""
    results = SENSITIVE[name][2]
    made = [["1 % more of", *(f"{one.replace('_', ' ')}, %" for one in results)]]
    for row in rows:
        effects = (row["effects"].get(one) for one in results)
        made.append([row["path"], *("–" if one is None else _signed(one) for one in effects)])
    return made


def _signed(value: float) -> str:
    """A change with two places."""
    return "0" if abs(value) < 5e-3 else f"{value:+.2f}".replace("-", "\N{MINUS SIGN}")


# ---- what it says ----


def sentences(data: Data) -> list[str]:
    """The findings, each from the numbers."""
    loops, ratio = data["loops"], {name: row["ratio"] for name, row in data["raised"].items()}

    def over(key: str, kind: str, *names: str) -> str:
        values = (100 * loops[key][kind][name]["overshoot"] for name in names)
        return " and ".join(number(value, 2) for value in values)

    cylinder, motor = data["raised"]["cylinder, 50 mm"], data["raised"]["motor, 1000 rpm"]
    said = [
        "Position servo 1: by Ziegler and Nichols from the linear loop PI and PID overshoot by"
        f" {over('position', 'tuned', 'PI', 'PID')} %; P does not, the tool's own PI by"
        f" {over('position', 'tuned', 'own PI')} %. Their integral time is that of the oil's swing,"
        " far too short for a loop that already integrates; more P and less I help, half the P"
        " makes it swing on.",
        "With friction the loop swings only at"
        f" {number(cylinder['raised'][0], 3)} V/m, {number(ratio['cylinder, 50 mm'], 2)} times the"
        f" gain of the linear loop. The rule from there gives overshoots of"
        f" {over('position', 'swung', 'PI', 'PID')} % under PI and PID, and gain margins below 1"
        " in the linear loop: what holds such a loop is its friction alone.",
    ]
    if "cylinder, 1 N of dry friction" in ratio:
        said[-1] += (
            f" With 1 N of dry friction {number(ratio['cylinder, 1 N of dry friction'], 2)} times"
            " remain, the valve's own damping as it opens; bristles or a static curve make no"
            " difference."
        )
    slow = motor["linear"][0] * LOOPS["speed"].factor
    fast = motor["raised"][0] * LOOPS["speed"].factor
    said += [
        f"Velocity servo: the ultimate gain is {number(slow, 3)} mV/rpm at rest and"
        f" {number(fast, 3)} at 1000 rpm, where the open valve damps: not friction, the working"
        " point. Taken at rest the rule is calm at speed; P alone droops by"
        f" {number(30 / pi * loops['speed']['tuned']['P']['steady_state_error'], 3)} rpm.",
        "Position servo 2: pressure, not the valve's signal, limits it: at full torque the shaft is"
        " a double integrator, on which PI and PID by the rule swing for ever between both supply"
        " pressures. The tool's own PI takes a longer integral time and comes to rest.",
    ]
    return said


_RAISED = "Ultimate gain: of the linear loop, and by raising it until the loop swings"
_HINTS = "The test case without a loop, with the slides' hints"
_NOTE = (
    "K, Tᵢ and T_d as they act: a factor acts on its part alone, so that more P also stretches Tᵢ."
    " Gain margin of the linear loop, without sticking friction; below 1 it is unstable. Energy of"
    " the supply over the whole scenario, leakage included. By raising: the rule on the gain at"
    " which the loop with friction swings. Own: of the tool, by gain margins; its P is the rule's."
    " A dash: it never gets to 90 %, or does not stay within 2 %."
)
HARD = (
    "Not in the slides, so assumed: bore, rod, stroke, pipe volumes, bulk modulus and air, the"
    " spool's dynamics, the test's supply pressure, the load torque.",
    "Stated with little ground: friction near rest (F_S, v_s and the bristles decide whether the"
    " piston creeps, and no plot of motion tells them apart), leakage of each edge (it sets the"
    " pressures at rest and the zero adjustment, and differs between valves of one type), flow of"
    " the valve at the oil's viscosity (20 % of it is 20 % of the speed), the motor's constants,"
    ' "very preliminary".',
)


def page(study: Study) -> Sheets:
    """The report as PDF and as images of its sheets: the same numbers give the same bytes."""
    data = numbers(study)
    blocks: list[Block] = []
    for key, loop in LOOPS.items():
        runs = [(name, study.runs[key][name]) for name in SHOWN]
        blocks.append(Drawing(loop.title, comparison_figure(runs, LEAST)))
        grid = loop_rows(loop, all_rows(data["loops"][key]), data["loops"][key]["linear"])
        blocks.append(_table("", grid, _NOTE if key == "position" else ""))
        if key == "position":  # what of the other tables has room on its sheet
            blocks.append(_table(_RAISED, raised_rows(data)))
            blocks.append(_table(_HINTS, pulse_rows(data)))
    blocks += [
        _table(f"What matters most to {SENSITIVE[name][0]}", sensitive_rows(name, rows))
        for name, rows in data["sensitive"].items()
    ]
    return study_report(
        __file__,
        data,
        title="Course servos",
        heading="The servos of the course MEC-E5005, tuned by Ziegler and Nichols",
        lead=sentences(data),
        blocks=[*blocks, Notes("Hard to specify", HARD)],
    )


def _table(title: str, grid: list[list[str]], note: str = "") -> Table:
    return grid_table(title, grid, note, words=[0], widths={0: 1.0})


def printed(study: Study) -> str:
    """The tables, and what they say."""
    data, lines = numbers(study), []
    for key, loop in LOOPS.items():
        found = data["loops"][key]
        grid = loop_rows(loop, all_rows(found), found["linear"])
        lines += [loop.title, aligned(grid, right=range(1, 10)), ""]
    lines += [aligned(raised_rows(data), right=(1, 2, 4, 5, 6)), ""]
    lines += [aligned(pulse_rows(data), right=range(1, 9)), ""]
    for name, rows in data["sensitive"].items():
        lines += [SENSITIVE[name][0], aligned(sensitive_rows(name, rows), right=(1, 2)), ""]
    return "\n".join([*lines, "\n\n".join(sentences(data))])


def main() -> None:
    """Print the tables; write the report where a folder is named."""
    description = "the course's servos, tuned"
    quick = "fewer cases, no sensitivities"
    print(run_script(__file__, description, compute, printed, page, quick=quick))


if __name__ == "__main__":
    main()
