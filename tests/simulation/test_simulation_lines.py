"""Lines of a simulation: laminar, turbulent and between, with bends and fittings."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
import simulation_case as case
from scipy.optimize import brentq

from actuator_opt.studies.plant import LineData, LinePiece

ENDS = 100e5
"""Pressure at the far ends of both lines [Pa]."""
DAMPING = 2e4
"""Damper on the load [N s/m], so that the motion settles."""
DENSITY, VISCOSITY = 870.0, 0.012
LENGTH, DIAMETER = 2.0, 6e-3


def drop(flow, fittings):
    """Pressure drop by hand: Hagen-Poiseuille, or Blasius, and the fittings' share [Pa]."""
    speed = flow / (pi / 4 * DIAMETER**2)
    reynolds = DENSITY * speed * DIAMETER / VISCOSITY
    head = DENSITY * speed**2 / 2
    factor = 64 / reynolds if reynolds < 2300 else 0.3164 / reynolds**0.25
    return (factor * LENGTH / DIAMETER + fittings) * head, reynolds


def line(fittings):
    """The line of a chamber."""
    piece = LinePiece(DIAMETER, LENGTH, fittings, DENSITY, VISCOSITY)
    return LineData(
        near_volume=5e-6,
        far_volume=5e-6,
        inertance=4 * DENSITY * LENGTH / (pi * DIAMETER**2),
        pieces=(piece,),
    )


@pytest.mark.parametrize("fittings", [0.0, 6.0])
@pytest.mark.parametrize(("force", "turbulent"), [(0.0, False), (-14e3, True)])
def test_a_steady_speed_is_that_of_the_drops_by_hand(force, turbulent, fittings):
    """A force pulls the piston out against a damper and the drops of both lines."""
    own = case.plant(
        lines={"a": line(fittings), "b": line(fittings)}, stroke=0.8, mass=5.0, oil_damping=0.0
    )
    scene = case.scenario(
        ends="constant_pressure",
        duration=0.4,
        initial={"position": 0.05, "pressure_a": ENDS, "pressure_b": ENDS},
        load={"force": [{"shape": "constant", "value": force}], "damping": DAMPING},
    )
    signals = case.run(scene, own).signals

    def pressures(speed):
        into, out = own.area_a * speed, own.area_b * speed
        return ENDS - drop(into, fittings)[0], ENDS + drop(out, fittings)[0]

    def rest(speed):
        a, b = pressures(speed)
        return a * own.area_a - b * own.area_b - force - DAMPING * speed

    speed = brentq(rest, 1e-3, 3.0)
    assert (drop(own.area_b * speed, 0.0)[1] > 4000) == turbulent
    assert (drop(own.area_a * speed, 0.0)[1] > 2300) == turbulent
    assert np.ptp(signals["speed"][-50:]) < 1e-4 * speed
    assert signals["speed"][-1] == pytest.approx(speed, rel=1e-4)
    assert signals["pressure_a"][-1] == pytest.approx(pressures(speed)[0], rel=1e-4)
    assert signals["pressure_b"][-1] == pytest.approx(pressures(speed)[1], rel=1e-4)
