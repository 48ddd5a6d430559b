"""Smooth gaps against closed solutions: slider, rupture and reformation, Poiseuille, ring, sum."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from actuator_opt.lubrication import Elastic, Gap, Lubricant, solve_gap
from actuator_opt.models.damping import flat_gap

NODES, WEIGHTS = (part / 2 for part in np.polynomial.legendre.leggauss(80))
NODES = NODES + 0.5
OIL = Lubricant(0.03)
PTFE = Elastic(500e6, 0.46)
RING = {"width": 5e-3, "lubricant": Lubricant(0.04), "sealed_pressure": 1e5, "outer_pressure": 1e5}


def solved(gap, nodes=0):
    """A smooth film that has to converge, with both residuals below 1e-6."""
    film = solve_gap(gap, nodes)
    assert film.converged, film.reason
    assert max(film.load_residual, film.mass_residual) < 1e-6
    return film


def test_slider():
    """The plane slider of the check list: load, drag and flow in closed form."""
    gap = Gap(6e-3, np.linspace(2.5 * 2e-6, 2e-6, 121), OIL, 0.5, 0.0, 0.0)
    film = solved(gap, nodes=481)
    a, length, speed, least, viscosity = 2.5, 6e-3, 0.5, 2e-6, 0.03
    bearing = 6 * viscosity * speed * (length / (least * (a - 1))) ** 2
    bearing *= math.log(a) - 2 * (a - 1) / (a + 1)
    shear = viscosity * speed * length / (least * (a - 1))
    shear *= 4 * math.log(a) - 6 * (a - 1) / (a + 1)
    assert bearing == pytest.approx(21293.2, rel=1e-5)
    assert shear == pytest.approx(32.8120, rel=1e-5)
    assert film.line_load == pytest.approx(bearing, rel=5e-5)
    assert film.viscous_drag == pytest.approx(shear, rel=1e-5)
    assert film.flow == pytest.approx(7.14286e-7, rel=1e-5)


def test_slider_under_a_load():
    """The same slider, free to settle under its load, finds its film of 2 um."""
    profile = np.linspace(3e-6, 0, 481)
    film = solved(Gap(6e-3, profile, OIL, 0.5, 0.0, 0.0, line_load=21293.2))
    assert film.film[-1] == pytest.approx(2e-6, rel=1e-4)
    assert film.line_load == pytest.approx(21293.2, rel=1e-6)


@pytest.mark.parametrize("speed", [0.4, -0.4])
@pytest.mark.parametrize("pressure", [0.0, 0.2e6])
def test_rupture_and_reformation(speed, pressure):
    """Film over a parabola: ruptures with p = dp/dx = 0 (Swift, Stieber), forms again with mass.

    Independent solution by quadrature: the height of rupture h_r closes the pressure from the
    inlet, q = U h_r/2; downstream theta = 1 - h_r/h (Jakobsson, Floberg, Olsson) until the oil of
    the outlet stands against it where the integral of 6 eta U (h - h_r)/h^3 reaches its pressure.
    """
    length, least = 8e-3, 3e-6

    def height(place):
        return least * (1 + 3 * (2 * place - 1) ** 2)

    def rise(left, right, ruptured):
        drive = 6 * 0.03 * abs(speed) * length
        s = left + (right - left) * NODES
        return drive * (right - left) * (WEIGHTS @ ((height(s) - ruptured) / height(s) ** 3))

    rupture = brentq(lambda r: rise(0, r, height(r)), 0.5 + 1e-6, 0.95)
    ruptured = height(rupture)
    reform = 1.0
    if pressure:
        reform = brentq(lambda r: rise(r, 1, ruptured) - pressure, rupture, 1)
    places = np.linspace(0, 1, 801)
    ends = (0.0, pressure) if speed > 0 else (pressure, 0.0)
    film = solved(Gap(length, height(places), OIL, speed, *ends))
    pressures, fraction = film.pressure, film.cavitated_fraction
    if speed < 0:
        pressures, fraction = pressures[::-1], fraction[::-1]
    empty = (places > rupture + 0.003) & (places < reform - 0.003)
    full = (places < rupture - 0.003) | (places > reform + 0.003)
    assert np.all(pressures[empty] < 1.0)
    assert np.all(fraction[full] < 1e-9)
    np.testing.assert_allclose(fraction[empty], 1 - ruptured / height(places[empty]), atol=2e-3)
    assert film.flow == pytest.approx(speed * ruptured / 2, rel=1e-4)
    middle = np.interp(0.4, places, pressures)
    assert middle == pytest.approx(rise(0, 0.4, ruptured), rel=1e-3)


@pytest.mark.parametrize("law", ["none", "barus"])
def test_parallel_gap(law):
    """Flow h^3 (g_1 - g_2)/(12 eta L) + U h/2, g = (1 - e^(-alpha p))/alpha by Barus."""
    oil = Lubricant(0.03, law, 20e-9)
    film = solved(Gap(5e-3, np.full(201, 4e-6), oil, 0.1, 30e6, 2e6))
    low, high = (2e6, 30e6)
    if law == "barus":
        low, high = (-math.expm1(-20e-9 * p) / 20e-9 for p in (low, high))
    pushed = (4e-6) ** 3 * (high - low) / (12 * 0.03 * 5e-3)
    assert film.flow == pytest.approx(pushed + 0.1 * 4e-6 / 2, rel=2e-6)


def test_parallel_gap_drags_as_couette():
    """Even pressure: the drag per circumference is the flat gap of the models over pi d."""
    film = solved(Gap(5e-3, np.full(21, 4e-6), OIL, 0.1, 1e5, 1e5))
    coefficient = flat_gap(dynamic_viscosity=0.03, diameter=0.02, length=5e-3, gap=4e-6)
    assert film.viscous_drag == pytest.approx(coefficient * 0.1 / (math.pi * 0.02), rel=1e-9)


@pytest.mark.parametrize("speed", [0.05, -0.05])
def test_back_up_ring(speed):
    """PTFE ring with rounded edges: carries its line load on an elastic film, both ways alike."""
    profile = 5e-6 * np.abs(np.linspace(-1, 1, 241)) ** 8
    film = solved(Gap(profile=profile, speed=speed, line_load=3e3, elastic=PTFE, **RING))
    assert film.line_load == pytest.approx(3e3, rel=1e-6)
    other = solved(Gap(profile=profile, speed=-speed, line_load=3e3, elastic=PTFE, **RING))
    assert other.viscous_drag == pytest.approx(-film.viscous_drag, rel=1e-6)
    assert 0 < np.min(film.film) < 3e-6


def test_stiff_ring_is_a_rigid_one():
    """With a modulus of 1e15 Pa the elastic ring is the rigid slider."""
    profile = 5e-6 * np.linspace(-1, 1, 121) ** 2
    given = {"profile": profile, "speed": 0.5, "line_load": 3e3, **RING}
    stiff = solved(Gap(elastic=Elastic(1e15, 0.3), **given))
    rigid = solved(Gap(**given))
    np.testing.assert_allclose(stiff.film, rigid.film, rtol=1e-4)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width": 0.0}, "width 0: must be above zero"),
        ({"line_load": 400.0}, "so the ring lifts off"),
        ({"speed": 0.0}, "a film at rest carries no load"),
        ({"profile": np.zeros(21), "elastic": PTFE}, "has no wedge"),
        ({"line_load": None, "profile": np.zeros(21)}, "least film of a fixed gap 0"),
        ({"cavitation_pressure": 2e5}, "below the cavitation pressure"),
    ],
)
def test_faults_of_a_gap_are_one_line(changes, message):
    """A gap that cannot be solved says why, and gives no numbers."""
    given = {"profile": np.linspace(3e-6, 0, 21), "speed": 0.1, "line_load": 3e3, **RING}
    film = solve_gap(Gap(**(given | changes)))
    assert not film.converged
    assert message in film.reason
    assert np.isnan(film.viscous_drag)
