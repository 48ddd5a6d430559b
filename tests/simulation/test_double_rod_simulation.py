"""A double-rod cylinder in the time domain: symmetry, and a blind integration of its equations."""

from __future__ import annotations

from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import actuator_opt as ao

DESIGNS = Path(__file__).parents[2] / "designs"
BAR, LITRE = 1e5, 1 / 60000
RIG = (DESIGNS / "servo_test_rig.yaml").read_text("utf-8")

STIFF = {
    "fluid.bulk_modulus_law": "constant",
    "fluid.air_content": "0 %",
    "materials.steel_e355.youngs_modulus": "1200 GPa",
    "materials.steel_42crmo4.youngs_modulus": "1200 GPa",
    "valve.leakage_flow": "0 l/min",
}
"""Oil of one modulus, walls and rods as stiff as a file allows, a valve without leakage."""

SCENARIO = """
name: blind
design: rig.yaml
set:
@set@
duration: 0.6 s
sample_time: 1 ms
initial: {position: 50 mm, pressure_a: @first@, pressure_b: 105 bar}
friction: {coulomb: 0 N, viscous: 2 kN*s/m}
signal:
  - {shape: sine, value: 4 V, frequency: 2 Hz}
load:
  force:
    - {shape: step, value: 3 kN, start: 0.2 s}
"""


def simulated(tmp_path, scenario, design=RIG, **options):
    """Simulate a scenario of a design, both given as text."""
    (tmp_path / "rig.yaml").write_text(design, "utf-8")
    (tmp_path / "case.yaml").write_text(scenario, "utf-8")
    return ao.simulate(tmp_path / "case.yaml", **options)


def test_equal_rods_move_alike_in_both_directions(tmp_path):
    """Half a period later, position and speed are mirrored, and the chambers have changed places.

    The flange at the head makes the barrel's stretch differ a little: 0.1 % of the span, 1 % of
    the supply.
    """
    text = (DESIGNS / "scenarios" / "test_rig_sine.yaml").read_text("utf-8")
    run = simulated(tmp_path, text.replace("../servo_test_rig.yaml", "rig.yaml"))
    time, signals = run.time, run.signals
    half = round(0.25 / (time[1] - time[0]))
    late = slice(round(0.5 / (time[1] - time[0])), len(time) - half)
    shifted = slice(late.start + half, late.stop + half)
    moved = signals["position"] - 0.05
    assert np.ptp(moved) > 0.03
    assert np.abs(moved[late] + moved[shifted]).max() < 1e-3 * np.ptp(moved)
    swapped = np.abs(signals["pressure_a"][late] - signals["pressure_b"][shifted]).max()
    assert swapped < 0.01 * 210 * BAR
    friction = signals["friction"]
    assert np.abs(friction[late] + friction[shifted]).max() < 0.02 * np.abs(friction).max()


def oracle(times, *, bore, rod, second, stroke, dead, first, bulk, mass, damping):
    """Position and both pressures of the servo cylinder, from its equations alone (SI, gauge).

    Four edges that open with the spool as K u/U sqrt(drop), a spool of second order, two volumes
    of oil, a mass with viscous friction, and a load that steps up at 0.2 s.
    """
    area_a, area_b = (pi / 4 * (bore**2 - d**2) for d in (second, rod))
    edge = 38 * LITRE / sqrt(35 * BAR)
    supply, tank, w, zeta = 210 * BAR, 5 * BAR, 2 * pi * 150, 0.8

    def flow(opening, drop):
        return edge * max(opening, 0.0) * np.sign(drop) * sqrt(abs(drop))

    def rates(time, y, load):
        x, v, a, b, spool, speed = y
        u = spool / 10
        q_a = flow(u, supply - a) - flow(-u, a - tank)
        q_b = flow(-u, supply - b) - flow(u, b - tank)
        command = 4 * np.sin(2 * pi * 2 * time)
        return [
            v,
            (a * area_a - b * area_b - damping * v - load) / mass,
            bulk * (q_a - area_a * v) / (dead + area_a * x),
            bulk * (q_b + area_b * v) / (dead + area_b * (stroke - x)),
            speed,
            w * w * (command - spool) - 2 * zeta * w * speed,
        ]

    before, after = times[times < 0.2], times[times >= 0.2]
    state, rows = [stroke / 2, 0.0, first, 105 * BAR, 0.0, 0.0], []
    for span, points, load in (((0.0, 0.2), before, 0.0), ((0.2, times[-1]), after, 3e3)):
        part = solve_ivp(
            rates,
            span,
            state,
            method="Radau",
            args=(load,),
            dense_output=True,
            rtol=1e-8,
            atol=[1e-10, 1e-8, 1.0, 1.0, 1e-8, 1e-5],
        )
        assert part.success
        rows.append(part.sol(points))
        state = part.y[:, -1]
    return np.concatenate(rows, axis=1)[[0, 2, 3]]


@pytest.mark.parametrize(("diameter", "first"), [(36, 105), (24, 75)])
def test_a_blind_integration_of_a_double_rod_cylinder_agrees(tmp_path, diameter, first):
    """Equal and different rods: 0.5 % of the span in position, 1 % of the supply in pressure.

    `first` is the pressure of chamber A that balances 105 bar in B, in bar.
    """
    changes = STIFF | ({} if diameter == 36 else {"second_rod.outer_diameter": f"{diameter} mm"})
    lines = "".join(f"  {path}: {text}\n" for path, text in changes.items())
    run = simulated(tmp_path, SCENARIO.replace("@set@\n", lines).replace("@first@", f"{first} bar"))
    plant = run.plant
    position, pressure_a, pressure_b = oracle(
        run.time,
        bore=56e-3,
        rod=36e-3,
        first=first * BAR,
        second=1e-3 * diameter,
        stroke=0.1,
        dead=5e-6,
        bulk=plant.oil.bulk_modulus,
        mass=plant.mass,
        damping=2e3 + plant.oil_damping,
    )
    span = np.ptp(position)
    assert span > 0.02
    assert np.abs(run.signals["position"] - position).max() < 0.005 * span
    for name, expected in (("pressure_a", pressure_a), ("pressure_b", pressure_b)):
        assert np.abs(run.signals[name] - expected).max() < 0.01 * 210 * BAR
