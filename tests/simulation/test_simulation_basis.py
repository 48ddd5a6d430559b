"""The values on which a simulation is based: those of its equations, the same in three places."""

from __future__ import annotations

import json
from math import pi

import numpy as np
import pytest
from cli_runner import DESIGNS, run

import actuator_opt as ao
from actuator_opt.base.quantities import BASIS
from actuator_opt.pages.simulation import page
from actuator_opt.rendering.blocks import Table

DESIGN = DESIGNS / "servo_knee.yaml"
STEP = f"""\
name: short
design: {DESIGN}
duration: 40 ms
initial:
  position: 40 mm
friction:
  coulomb: 80 N
  static: 120 N
  stribeck_speed: 5 mm/s
  bristle_travel: 20 um
control:
  position:
    - shape: step
      value: 1 mm
      start: 10 ms
"""
PUSHED = f"""\
name: pushed
design: {DESIGN}
duration: 20 us
sample_time: 0.2 us
ends: closed
initial:
  position: 40 mm
  speed: 50 mm/s
  pressure_a: 90 bar
  pressure_b: 60 bar
friction:
  model: none
"""


@pytest.fixture(scope="module")
def step():
    """A short step with stated friction."""
    return ao.simulate(STEP)


def value(simulation, name):
    """A value of the basis [SI]."""
    return next(x.value for x in simulation.basis.values if x.name == name)


def test_hand_values(step):
    """Areas, volumes, air and bristles of the stated sizes."""
    design = step.plant.design
    bore, rod = design.cylinder.bore, design.rod.outer_diameter
    assert value(step, "area_a") == pytest.approx(pi / 4 * bore**2, rel=1e-9)
    assert value(step, "area_b") == pytest.approx(pi / 4 * (bore**2 - rod**2), rel=1e-9)
    swept = value(step, "volume_a") - value(step, "dead_volume_a")
    assert swept == pytest.approx(pi / 4 * bore**2 * 0.04, rel=1e-9)
    assert value(step, "moving_mass") == pytest.approx(
        design.load.mass + value(step, "part_mass"), rel=1e-12
    )
    # 120 N over 20 um; sqrt(sigma_0 m)
    assert value(step, "bristle_stiffness") == pytest.approx(6e6, rel=1e-9)
    damping = (6e6 * value(step, "moving_mass")) ** 0.5
    assert value(step, "bristle_damping") == pytest.approx(damping, rel=1e-9)
    # air: alpha (p_0/p)^(1/n), beside the oil that pressure leaves
    pressure, content = value(step, "start_pressure_a"), design.fluid.air_content
    index = design.fluid.polytropic_index
    gas = content * (101325 / (101325 + pressure)) ** (1 / index)
    share = value(step, "air_share_a")
    assert gas / (1 + gas) < share < 1.02 * gas / (1 + gas)  # the oil shrinks by up to 2 %


def test_they_are_those_of_the_equations():
    """Pressures rise, and the piston slows down, as volumes, walls, oil and mass state."""
    run = ao.simulate(PUSHED)
    names = ("area_a", "area_b", "volume_a", "volume_b", "modulus_a", "modulus_b")
    a_a, a_b, v_a, v_b, k_a, k_b = (value(run, name) for name in names)
    give = 1 / value(run, "rod_stiffness")
    w_a = value(run, "wall_compliance_a") + give * a_a**2
    w_b = value(run, "wall_compliance_b") + give * a_b**2
    w_ab = value(run, "wall_coupling") - give * a_a * a_b
    p_a, p_b = 90e5, 60e5
    v_a, v_b = v_a + w_a * p_a + w_ab * p_b, v_b + w_b * p_b + w_ab * p_a
    leak = value(run, "piston_leakage") * (p_a - p_b)
    flows = np.array([-a_a * 0.05 - leak, a_b * 0.05 + leak])
    capacity = np.array([[v_a / k_a + w_a, w_ab], [w_ab, v_b / k_b + w_b]])
    slopes = np.linalg.solve(capacity, flows)
    for name, slope in zip("ab", slopes, strict=True):
        rate = np.gradient(run.signals[f"pressure_{name}"], run.time)[1]
        assert rate == pytest.approx(slope, rel=2e-3)
    force = (
        a_a * p_a - a_b * p_b - (value(run, "oil_damping") + value(run, "viscous_friction")) * 0.05
    )
    acceleration = np.gradient(run.signals["speed"], run.time)[1]
    assert acceleration == pytest.approx(force / value(run, "moving_mass"), rel=2e-3)


def test_one_list_in_three_places(step, tmp_path):
    """JSON, the page of the report and `--explain` show the same names, values and origins."""
    data = step.to_dict()["basis"]
    assert list(data) == [x.name for x in step.basis.values]
    assert data["moving_mass"]["unit"] == "kg"
    assert data["static_friction"]["origin"] == "friction.static"
    assert "[MECE5005]" in data["bristle_damping"]["origin"]
    (table,) = (
        x
        for x in page(step).blocks
        if isinstance(x, Table) and x.title == "Values of the equations"
    )
    assert [row[0] for row in table.rows] == [entry["label"] for entry in data.values()]
    file = tmp_path / "step.yaml"
    file.write_text(STEP, encoding="utf-8")
    told = run("simulate", str(file), "--explain").out
    plain = run("simulate", str(file)).out
    assert "Values of the equations" in told
    assert "Values of the equations" not in plain
    assert "lugre.lugre_bristle_damping" in told  # a narrow terminal breaks the line after it
    assert json.loads(run("simulate", str(file), "--json").out)["basis"] == data


@pytest.mark.parametrize(
    "name",
    ["course_motor_velocity", "course_valve_ramp", "aalto_one_way_rig", "aalto_seal_slip"],
)
def test_every_circuit_has_them(name):
    """Motor, valve bench, throttles and held ports; all have origins and finite numbers."""
    file = DESIGNS / "scenarios" / f"{name}.yaml"
    told = ao.simulate(file).basis.values
    names = [x.name for x in told]
    assert len(set(names)) == len(names)
    assert set(names) <= set(BASIS)
    assert all(x.origin and np.isfinite(x.value) for x in told)
    assert ("displacement" in names) == ("motor" in name)
    assert ("area_a" in names) == ("aalto" in name)


def test_a_stated_cylinder_names_its_block(tmp_path):
    """With `ideal`, the numbers come from this block; walls and seals have none."""
    text = DESIGN.read_text(encoding="utf-8")
    valve = text[text.index("\nvalve:") : text.index("\nload:")]
    ideal = (
        "name: stated\nfluid:\n  material: iso_vg_32\n  temperature: 40 degC\nsupply:\n"
        "  pressure: 140 bar\nideal:\n  area_a: 12 cm^2\n  area_b: 8 cm^2\n  stroke: 0.3 m\n"
        f"  mass: 5 kg\n  dead_volume_a: 10 ml\n  dead_volume_b: 20 ml\n{valve}"
    )
    (tmp_path / "stated.yaml").write_text(ideal, encoding="utf-8")
    scene = tmp_path / "scene.yaml"
    scene.write_text(
        "name: stated\ndesign: stated.yaml\nduration: 10 ms\nfriction: {model: none}\n"
        "signal:\n  - {shape: constant, value: 1 V}\n",
        encoding="utf-8",
    )
    data = ao.simulate(scene).basis.to_dict()
    for name, number in (("area_a", 12e-4), ("area_b", 8e-4), ("dead_volume_b", 20e-6)):
        assert data[name]["value"] == pytest.approx(number, rel=1e-12)
        assert data[name]["origin"].startswith(f"ideal.{name}")
    assert data["part_mass"]["origin"] == "ideal.mass"
    assert data["wall_compliance_a"]["value"] == pytest.approx(0.0, abs=1e-30)
    assert "coulomb_friction" not in data
