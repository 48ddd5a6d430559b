"""Prices of a metal tube whose wall is sized by its stress, against elasticities found by hand.

With s = sigma/(S p), strength over factor and pressure, and only the wall free (bore D, length L,
density rho), the mass m is rho pi L t (D + t). At the optimum the stress is at its limit:

- thin, p D/(2 t) = sigma/S: t = D/(2 s); d ln m/d ln s = -(1 + 2 t/D)/(1 + t/D), -1 as t/D -> 0
- Lame's hoop stress, p (k^2 + 1)/(k^2 - 1) = sigma/S with k = 1 + 2 t/D: k^2 - 1 = 2/(s - 1);
  d ln m/d ln s = -s/(s - 1)
- von Mises at the bore, closed ends, sqrt(3) p k^2/(k^2 - 1) = sigma/S: k^2 = s/(s - sqrt(3));
  d ln m/d ln s = -s/(s - sqrt(3))
- von Mises without axial force, p sqrt(h^2 + h + 1) = sigma/S with h = (k^2 + 1)/(k^2 - 1):
  h = (sqrt(4 s^2 - 3) - 1)/2, k^2 - 1 = 2/(h - 1); d ln m/d ln s = -2 s^2/(sqrt(4 s^2 - 3) (h - 1))

As s holds all three, the elasticity by sigma is minus that by p and by S; t goes with D at a fixed
s, so that the elasticity by D is 2, and those by L and rho are 1.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from cli_runner import BENCH
from hypothesis import given, settings, strategies as st

import actuator_opt as ao
from actuator_opt.models import barrel
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.prices import prices
from actuator_opt.optimisation.problem import BoxProblem, ParametricProblem, PointValues
from actuator_opt.optimisation.solver import solve

NAMES = ("strength", "pressure", "factor", "bore", "length", "density")


def thin(pressure, bore, wall):
    """Hoop stress of a thin tube."""
    return pressure * bore / (2 * wall)


def lame(pressure, bore, wall):
    """Hoop stress at the bore of a thick tube."""
    size = {"inner_radius": bore / 2, "outer_radius": bore / 2 + wall}
    return barrel.bore_stresses(pressure=pressure, **size)[0]


def closed(pressure, bore, wall):
    """Von Mises stress at the bore of a tube with closed ends."""
    size = {"inner_radius": bore / 2, "outer_radius": bore / 2 + wall}
    force = pressure * pi * bore**2 / 4
    hoop, radial, axial = barrel.bore_stresses(pressure=pressure, axial_force=force, **size)
    return barrel.von_mises(hoop=hoop, radial=radial, axial=axial)


def free(pressure, bore, wall):
    """Von Mises stress at the bore of a tube without axial force."""
    size = {"inner_radius": bore / 2, "outer_radius": bore / 2 + wall}
    hoop, radial, axial = barrel.bore_stresses(pressure=pressure, **size)
    return barrel.von_mises(hoop=hoop, radial=radial, axial=axial)


def free_of(s):
    """(k^2, elasticity by s) of `free`."""
    root = sqrt(4 * s * s - 3)
    hoop = (root - 1) / 2
    return (hoop + 1) / (hoop - 1), -2 * s * s / (root * (hoop - 1))


BY_HAND = {
    thin: lambda s: ((1 + 1 / s) ** 2, -(1 + 1 / s) / (1 + 1 / (2 * s))),
    lame: lambda s: ((s + 1) / (s - 1), -s / (s - 1)),
    closed: lambda s: (s / (s - sqrt(3)), -s / (s - sqrt(3))),
    free: free_of,
}
"""(outer over inner radius squared, elasticity by the strength) of each law."""


def tube(stress, values):
    """The lightest tube of a law: its wall is free, everything else a parameter."""

    def evaluate(x, p):
        strength, pressure, factor, bore, length, density = p
        mass = density * pi * length * x[0] * (bore + x[0])
        room = strength / (factor * stress(pressure, bore, x[0])) - 1
        return PointValues(mass, room[None])

    p = np.array(values)
    problem = BoxProblem(("wall",), [1e-6], [1.0], lambda x: evaluate(x, p[:, None]), ("stress",))
    return ParametricProblem(problem, NAMES, p, evaluate)


@settings(max_examples=25)
@given(
    stress=st.sampled_from(list(BY_HAND)),
    s=st.floats(2.2, 200.0),
    pressure=st.floats(1e6, 70e6),
    factor=st.floats(1.0, 4.0),
    bore=st.floats(5e-3, 0.3),
)
def test_elasticities_of_a_tube_sized_by_its_stress(stress, s, pressure, factor, bore):
    """Wall, price of every parameter and movement of the wall are those found by hand."""
    values = (s * pressure * factor, pressure, factor, bore, 0.2, 7850.0)
    asked = tube(stress, values)
    best = solve(asked.problem, starts=1, samples=64)
    square, by_strength = BY_HAND[stress](s)
    assert 1 + 2 * best.x[0] / bore == pytest.approx(sqrt(square), rel=1e-9)
    wanted = dict(zip(NAMES, (by_strength, -by_strength, -by_strength, 2, 1, 1), strict=True))
    rows = {row.parameter: row for row in prices(asked, best, bounds=False, resolve=False)}
    for name, elasticity in wanted.items():
        assert rows[name].percent_per_percent == pytest.approx(elasticity, rel=1e-6), name
    assert rows["bore"].movement[0] == pytest.approx(best.x[0] / bore, rel=1e-5)
    for name in ("length", "density"):
        assert rows[name].movement[0] == pytest.approx(0, abs=1e-9 * best.x[0])


@pytest.mark.parametrize("stress", BY_HAND)
def test_a_thin_tube_is_as_heavy_as_its_pressure_over_its_strength(stress):
    """With s = 2000 every law comes to -1 by strength, but for the factor of von Mises in s.

    The next term is of 1/s: at most 2/s away. Re-solved at +-1 %, the mass goes as 1/strength.
    """
    asked = tube(stress, (2000 * 10e6, 10e6, 1.0, 0.05, 0.2, 7850.0))
    best = solve(asked.problem, starts=1, samples=64)
    rows = {row.parameter: row for row in prices(asked, best, bounds=False, change=0.01)}
    assert rows["strength"].percent_per_percent == pytest.approx(-1, abs=2 / 2000)
    assert rows["pressure"].percent_per_percent == pytest.approx(1, abs=2 / 2000)
    assert rows["strength"].resolved_up == pytest.approx(best.objective / 1.01, rel=2e-5)
    assert rows["pressure"].resolved_up == pytest.approx(best.objective * 1.01, rel=2e-5)


def block(start, end):
    """The part of the bench design from one line up to another."""
    return BENCH[BENCH.index(start) : BENCH.index(end)]


TUBE = """barrel:
  layup:
    - material: steel_e355
      thickness: 2 mm

"""
THREAD = """retention:
  type: thread
  length: 30 mm
  wall: 6 mm
  thread:
    pitch: 1 mm

"""
ROOT = 17 * sqrt(3) / 48 * 1e-3
"""Depth of the root of an ISO thread of 1 mm pitch, 17 H/24 with H = sqrt(3)/2 P."""
LIMITS = """variables:
  barrel.layup[0].thickness:
    lower: 0.2 mm
    upper: 12 mm

requirements:
  proof_factor:
    min: 2

"""
WAIVED = """waivers:
  buckling_factor: no matter of the wall
  end_stop_factor: no matter of the wall
  trapped_factor: set by the oil, not by what the wall is sized for
"""
STEEL = (
    BENCH.replace(block("barrel:", "rod:\n  material"), TUBE)
    .replace(block("retention:", "clevis:"), THREAD)
    .replace(block("variables:", "waivers:"), LIMITS)
    .replace("waivers:\n", WAIVED)
)
"""The bench design with a steel barrel whose wall is all that is free, sized by yield."""
HOT = 1 - (1 - 0.95) * (80 - 23) / (150 - 23)
"""What 80 degC leaves of the strength: in a line from 1 at 23 degC to 0.95 at 150 degC (file)."""
WALL = "barrel.layup[0].thickness"
STRENGTH = "materials.steel_e355.yield_strength"


@pytest.mark.parametrize(
    ("bore", "pressure", "factor"),
    [("22 mm", "210 bar", 2.3), ("25 mm", "280 bar", 2.5), ("28 mm", "70 bar", 4.0)],
)
def test_an_actuator_whose_barrel_is_sized_by_yield(bore, pressure, factor):
    """Wall under the thread and its movement by hand (von Mises, no axial force).

    The wall is larger by the depth of the thread; the price is dm/dt times the movement.
    dm/dt is the difference quotient of two evaluations: caps and skirt grow with the barrel too.
    """
    changes = {
        "cylinder.bore": bore,
        "supply.pressure": pressure,
        "requirements.proof_factor.min": str(factor),
    }
    loads = {f"load_cases[{name}].force": "1 kN" for name in ("stance", "swing")}
    design = ao.read(STEEL, set=changes | loads)
    best = ao.optimise(design, starts=2)
    assert [name.split()[0] for name in best.kkt.active] == ["proof_factor"]
    (variable,) = best.variables
    rows = {row.parameter: row for row in best.sensitivities}
    supply, diameter = rows["supply.pressure"].limit, rows["cylinder.bore"].limit
    s = HOT * rows[STRENGTH].limit / (factor * rows["supply.proof_ratio"].limit * supply)
    square, by_strength = free_of(s)
    net = diameter / 2 * (sqrt(square) - 1)
    wall = net + ROOT
    assert variable.value == pytest.approx(wall, rel=1e-9)

    def mass(thickness):
        changed = design.changed({WALL: f"{1e3 * thickness!r} mm"})
        return ao.evaluate(changed).metrics["mass"].value

    slope = (mass(wall * (1 + 1e-4)) - mass(wall * (1 - 1e-4))) / (2e-4 * wall)
    # d ln A = by_strength d ln s of the net area A = pi t (D + t), so dA = pi (D + 2 t) dt
    moves = by_strength * net * (diameter + net) / (diameter + 2 * net)
    share = slope * moves / best.objective_value
    for path, sign in (
        (STRENGTH, 1),
        ("supply.pressure", -1),
        ("supply.proof_ratio", -1),
        ("requirements.proof_factor.min", -1),
    ):
        assert rows[path].percent_per_percent == pytest.approx(sign * share, rel=1e-6), path
    row = rows["requirements.proof_factor.min"]
    assert row.movement[WALL] * row.limit == pytest.approx(-moves, rel=1e-5)
    actuator = build(design.subject())
    paths = ("requirements.proof_factor.min", STRENGTH)
    asked, found = actuator.parametric(paths), solve(actuator.problem, starts=1)
    solved = prices(asked, found, bounds=False, change=0.01)
    for row, changed in zip(solved, (s / 1.01, 1.01 * s), strict=True):
        there = diameter / 2 * (sqrt(free_of(changed)[0]) - 1) + ROOT
        assert row.resolved_up == pytest.approx(mass(there), rel=1e-8)
