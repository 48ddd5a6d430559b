"""Lumped lines against transmission lines, and those against closed forms."""

from __future__ import annotations

from math import pi, tan
from pathlib import Path

import numpy as np
import pytest

from actuator_opt.design import read_design
from actuator_opt.evaluation import compute, dynamics_study, prepare
from actuator_opt.models import linear

LENGTH, INNER, OUTER = 1.5, 8e-3, 12e-3
LINE = """
lines:
  - chamber: a
    length: 1.5 m
    inner_diameter: 8 mm
    outer_diameter: 12 mm
    material: steel_42crmo4
"""
KNEE = Path(__file__).parents[2] / "designs" / "knee_bonded.yaml"


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    """The knee with one long pipe at its cap side, ports closed at the pipe's far end."""
    path = tmp_path_factory.mktemp("line") / "knee_bonded.yaml"
    path.write_text(KNEE.read_text("utf-8") + LINE, "utf-8")
    subject = prepare(read_design(path).design)
    return subject, compute(subject, subject.values())


def both(held, frequencies, position=0.05):
    """Lumped and distributed dynamic stiffness of the first case."""
    subject, done = held
    v = subject.values()
    parts = linear.dynamic_stiffness(
        model=done.motion.model(np.array([[[position]]])),
        frequency=frequencies.reshape(-1, 1, 1),
    )
    lumped = (parts.real + 1j * parts.imaginary)[:, 0, 0]
    exact = dynamics_study.dynamic_stiffness(
        v, subject.design, done.state, done.motion, 0, position, frequencies
    )
    return lumped, exact


def test_lumped_lines_are_the_slow_limit(held):
    """Far below the pipe's quarter wave (208 Hz) both give one stiffness; at a tenth within 1 %."""
    lumped, exact = both(held, np.array([0.5, 5.0, 20.0]))
    np.testing.assert_allclose(lumped[0], exact[0], rtol=1e-5)
    assert abs(lumped[1] / exact[1] - 1) < 1e-3
    assert abs(lumped[2] / exact[2] - 1) < 1e-2


def test_a_plugged_pipe_is_a_tangent(held):
    """Without friction the pipe takes i tan(omega l/a)/Z_c; the oil's moves that by 3 % at most.

    At frequencies away from the resonances. Written out here: a^2 = (K/rho)/(1 + K (dV/dp)/V),
    Z_c = rho a/A; chamber B and the barrel's coupling of both are the evaluation's.
    """
    subject, done = held
    motion, state, budget = done.motion, done.state, done.springs
    g, v, x = budget.geometry, subject.values(), 0.05
    modulus = float(np.ravel(state.bulk_modulus_a)[0])
    density = float(np.ravel(state.density)[0])
    e, nu = (v[f"materials.steel_42crmo4.{k}"] for k in ("youngs_modulus", "poissons_ratio"))
    area = pi / 4 * INNER**2
    ratio = (OUTER**2 + INNER**2) / (OUTER**2 - INNER**2)
    wall = 2 * (ratio + nu) / e  # dV/dp over V
    speed = (modulus / density / (1 + modulus * wall)) ** 0.5
    impedance = density * speed / area
    whole = budget.total().at(x, g.stroke)
    own = float(np.ravel(whole.a)[0]) - area * LENGTH * (1 / modulus + wall)
    for frequency in (60.0, 120.0, 150.0, 260.0, 400.0):
        s = 2j * pi * frequency
        port = 1j * tan(2 * pi * frequency * LENGTH / speed) / impedance
        m_a, m_b = s * own + port, s * float(np.ravel(whole.b)[0])
        cross = s * float(np.ravel(whole.ab)[0])
        k = s * (g.area_a**2 * m_b + g.area_b**2 * m_a + 2 * g.area_a * g.area_b * cross)
        k = k / (m_a * m_b - cross**2) + s * float(np.ravel(motion.damping)[0])
        series = float(np.ravel(budget.series_compliance())[0])
        k = k / (1 + series * k) + s * s * float(motion.mass)
        exact = both(held, np.array([frequency]))[1][0]
        assert abs(exact / k - 1) < 0.03


def test_a_line_in_pieces_is_one_line(held, tmp_path):
    """Three pieces of 0.5 m give the rows of one pipe of 1.5 m: nothing is gained by splitting."""
    _, whole = held
    piece = LINE.partition("  - ")[2]
    text = "\nlines:\n" + 3 * f"  - {piece.replace('1.5 m', '0.5 m')}"
    path = tmp_path / "pieces.yaml"
    path.write_text(KNEE.read_text("utf-8") + text, "utf-8")
    other = prepare(read_design(path).design)
    parts = compute(other, other.values())
    for name in ("line_resonance", "stiffness_min", "damping_ratio"):
        for place, value in whole.computed.metrics[name].items():
            np.testing.assert_allclose(parts.computed.metrics[name][place], value, rtol=1e-9)
    frequencies = np.geomspace(1, 400, 30)
    one, three = both(held, frequencies), both((other, parts), frequencies)
    np.testing.assert_allclose(three[0], one[0], rtol=1e-9)
    np.testing.assert_allclose(three[1], one[1], rtol=1e-6)


def test_line_metrics_by_hand(held):
    """Quarter wave a/(4 l) and sudden stop rho a v, with the wave speed of the elastic pipe."""
    subject, done = held
    v, state = subject.values(), done.state
    place, chamber = "line a [0]", "lines of chamber a"
    for case in range(2):
        modulus = float(np.ravel(state.bulk_modulus_a)[case])
        density = float(np.ravel(state.density)[min(case, np.size(state.density) - 1)])
        e, nu = (v[f"materials.steel_42crmo4.{k}"] for k in ("youngs_modulus", "poissons_ratio"))
        ratio = (OUTER**2 + INNER**2) / (OUTER**2 - INNER**2)
        speed = (modulus / density / (1 + 2 * modulus * (ratio + nu) / e)) ** 0.5
        flow = pi / 4 * v["cylinder.bore"] ** 2 * (0.1, 0.4)[case]
        stopped = density * speed * flow / (pi / 4 * INNER**2)
        metrics = done.computed.metrics
        assert metrics["line_resonance"][chamber][case, 0] == pytest.approx(speed / 6, rel=1e-9)
        assert metrics["line_hammer"][place][case, 0] == pytest.approx(stopped, rel=1e-9)
