"""Turns of helical windings: worked number, the path itself, and the warning."""

from __future__ import annotations

from math import pi, radians, sin, tan
from pathlib import Path

import pytest
from scipy.integrate import solve_ivp

import actuator_opt as ao
from actuator_opt.models import winding_path

DESIGNS = Path(__file__).parents[2] / "designs"


def test_turn_by_the_worked_numbers():
    """95.6341 mm at 25 deg and 134.7 mm at 20 deg on a radius of 14 mm, nothing at 90 deg."""
    turn = winding_path.turn_length
    assert turn(radius=14e-3, angle=radians(25)) == pytest.approx(95.6341e-3, rel=1e-6)
    assert turn(radius=14e-3, angle=radians(-20)) == pytest.approx(134.7e-3, rel=1e-3)
    assert turn(radius=14e-3, angle=pi / 2) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(("angle", "friction"), [(20, 0.2), (35, 0.15), (60, 0.3)])
def test_turn_against_the_path(angle, friction):
    """The angle that friction lets grow, dz/da = R/(lambda sin a tan a), up to 90 deg."""
    radius = 14e-3
    path = solve_ivp(
        lambda a, z: [radius / (friction * sin(a) * tan(a))],
        (radians(angle), pi / 2), [0.0], rtol=1e-10, atol=1e-14,
    )  # fmt: skip
    expected = winding_path.turn_length(radius=radius, angle=radians(angle), slippage=friction)
    assert path.y[0, -1] == pytest.approx(expected, rel=1e-7)


def test_a_long_turn_is_a_metric_and_a_warning():
    """The helical plies of the bonded knee; the hoop winding of the other turns at once."""
    bonded = ao.evaluate(ao.read(DESIGNS / "knee_bonded.yaml"))
    assert bonded.metrics["turn_length"].place == "barrel.layup[2]"
    (sentence,) = (text for text in bonded.warnings if "to turn" in text)
    assert sentence.startswith("barrel.layup[2]")
    assert "96.3" in sentence  # 14.1 mm (1/sin 25 deg - 1)/0.2
    held = ao.evaluate(ao.read(DESIGNS / "knee.yaml"))
    assert held.metrics["turn_length"].value < 1e-4
    assert not any("to turn" in text for text in held.warnings)


@pytest.mark.parametrize("turn", ["cut_off", "pins"])
def test_a_stated_turn_has_no_warning(turn):
    """Pins need no length at all; a winding that is cut off needs it on the mandrel only."""
    plain = ao.evaluate(ao.read(DESIGNS / "knee_bonded.yaml"))
    stated = ao.evaluate(ao.read(DESIGNS / "knee_bonded.yaml", set={"barrel.turn": turn}))
    assert any("to turn" in text for text in plain.warnings)
    assert not any("to turn" in text for text in stated.warnings)
    length = stated.metrics["turn_length"].value
    if turn == "cut_off":
        assert length == plain.metrics["turn_length"].value
    else:
        assert length is None


def test_a_head_without_wiper_or_bushing_is_named():
    """Each warning ends when the design states the part."""
    bare = ao.evaluate(ao.read(DESIGNS / "knee.yaml")).warnings
    guided = ao.evaluate(
        ao.read(DESIGNS / "knee.yaml", set={"head.bearing": "guide_ptfe_bronze"})
    ).warnings
    assert any("no wiper" in text for text in bare)
    assert any("no bushing" in text for text in bare)
    assert not any("no bushing" in text for text in guided)
