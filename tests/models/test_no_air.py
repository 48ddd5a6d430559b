"""Oil without air in the simulation: exact above atmospheric pressure, bounded below it."""

from __future__ import annotations

from dataclasses import replace
from math import log

import numpy as np
import pytest
import simulation_case as case
from scipy.integrate import quad
from simulation_case import AREA_A, AREA_B, BALANCED, BAR, OIL, plant, run, scenario

import actuator_opt as ao
from actuator_opt.models.chamber import cavity
from actuator_opt.simulation.components.chambers import oil_at
from actuator_opt.studies import plant as plants

CAVITY = {"content": 1e-4, "polytropic_index": 1.4}


def stated(air):
    """The oil of a simulation whose design states this air."""
    return plants.plant(ao.read(case.DESIGN, set={"fluid.air_content": air}).subject()).oil


def test_shut_chambers_without_air_are_as_stiff_as_their_oil():
    """Pressures are p_0 + K ln(V_0/V) in both shut chambers, at 20 bar of pure oil."""
    oil = replace(OIL, air_content=stated("0 %").air_content)
    start = {"position": 0.08, "pressure_a": 20 * BAR, "pressure_b": 20 * BAR}
    force = [
        {"shape": "constant", "value": 20 * BAR * (AREA_A - AREA_B)},
        {"shape": "sine", "value": 300.0, "frequency": 10.0},
    ]
    scene = scenario(duration=0.2, ends="blocked", initial=start, load={"force": force})
    found = run(scene, plant(oil=oil), sharp=100.0, relative=1e-9)
    x = found.signals["position"]
    dead = 8e-6
    for name, before, now in (
        ("pressure_a", AREA_A * 0.08 + dead, AREA_A * x + dead),
        ("pressure_b", AREA_B * 0.08 + dead, AREA_B * (0.16 - x) + dead),
    ):
        wanted = 20 * BAR + 1.4e9 * np.log(before / now)
        swing = float(np.ptp(wanted))
        assert swing > 3 * BAR
        assert np.abs(found.signals[name] - wanted).max() < 1e-5 * swing


@pytest.mark.parametrize("pressure", [0.0, 1e5, 20e5, 200e5])
def test_no_air_is_no_air_from_atmospheric_pressure_up(pressure):
    """Modulus and density are those of the pure oil to rounding; with 0.01 % they differ."""
    own = replace(OIL, air_content=stated("0 %").air_content)
    law = oil_at(own, pressure)
    assert law.modulus == pytest.approx(1.4e9, rel=1e-12)
    assert log(law.ratio) == pytest.approx(pressure / 1.4e9, abs=1e-15)
    airy = oil_at(replace(OIL, air_content=1e-4), pressure)
    assert airy.modulus < law.modulus


def test_the_content_of_a_design_is_taken_as_stated():
    """None, less than what bounds a vacuum, and more: a cavity stands in where it is less."""
    for air, share in (("0 %", 0.0), ("0.005 %", 5e-5), ("0.01 %", 1e-4), ("2 %", 0.02)):
        assert stated(air).air_content == pytest.approx(share)
    assert [stated(air).cavity for air in ("0 %", "0.01 %", "1 %")] == [1e-6, 0.0, 0.0]


def test_the_cavity_bounds_a_vacuum_and_gives_back_its_work():
    """Its slope is that of its volume, its work -int p dG; it grows beyond bounds at -p_a."""
    for pressure in (-0.02e5, -0.5e5, -0.95e5):
        volume, falling, work = cavity(pressure=pressure, **CAVITY)
        step = 1e-4 * (101325.0 + pressure)
        ends = [cavity(pressure=pressure + side * step, **CAVITY)[0] for side in (1, -1)]
        assert falling == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-5)
        total, _ = quad(lambda p: p * cavity(pressure=p, **CAVITY)[1], 0.0, pressure)
        assert work == pytest.approx(total, rel=1e-8)
        assert volume > 0
    assert cavity(pressure=-101324.0, **CAVITY)[0] > 100
    assert cavity(pressure=0.0, **CAVITY) == (0.0, 0.0, 0.0)


def test_a_torn_chamber_keeps_mass_and_energy():
    """A pull beyond the vacuum opens the chamber of pure oil; both balances still close."""
    pull = [*BALANCED, {"shape": "step", "start": 0.05, "value": -6000.0}]
    scene = scenario(duration=0.3, ends="blocked", initial=case.MIDDLE, load={"force": pull})
    found = run(scene, plant(oil=OIL))
    lowest = min(found.signals["pressure_a"].min(), found.signals["pressure_b"].min())
    assert -101325.0 < lowest < -0.9 * BAR
    assert found.lost_mass() < 1e-5
    assert found.lost_energy() < 1e-4 * max(found.turnover(), 1.0)
