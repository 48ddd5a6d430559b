"""Exact slopes of a film and tandem seals: against differences, by independent films."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from film_cases import AIR, ROUGH, lip, o_ring_profile

from actuator_opt.base.numeric import STEP
from actuator_opt.lubrication import (
    Elastic,
    Lubricant,
    Surface,
    TandemSeal,
    sensitivities,
    solve_film,
    solve_tandem,
)
from actuator_opt.models.contact_profile import lip_profile

PLACES = np.linspace(0, 1, 121)
TILT = np.linspace(0, 1, 121)
STEPS = {
    "speed": lambda c, h: replace(c, speed=c.speed * (1 + h)),
    "width": lambda c, h: replace(c, width=c.width * (1 + h)),
    "modulus": lambda c, h: replace(c, elastic=Elastic(50e6 * (1 + h), 0.48)),
    "viscosity": lambda c, h: replace(c, lubricant=Lubricant(0.035 * (1 + h), "barus", 16e-9)),
    "roughness": lambda c, h: replace(c, surface=Surface(0.8e-6 * (1 + h), 1e14, 1e-6)),
    "asperities": lambda c, h: replace(c, surface=Surface(0.8e-6, 1e14 * (1 + h), 1e-6, 0.1 + h)),
    "sealed": lambda c, h: replace(c, sealed_pressure=c.sealed_pressure * (1 + h)),
    "outer": lambda c, h: replace(c, outer_pressure=c.outer_pressure * (1 + h)),
    "static": lambda c, h: replace(c, static_pressure=c.static_pressure * (1 + h * TILT)),
}


def outputs(film):
    """The four outputs that have slopes."""
    return np.array([film.viscous_drag, film.contact_load, film.flow, film.mean_film])


@pytest.mark.parametrize("speed", [0.05, -0.3])
@pytest.mark.parametrize("name", STEPS)
def test_slopes_are_central_differences(name, speed):
    """Implicit-function slopes of drag, load, flow and film against films on both sides."""
    step = STEPS[name]
    contact = step(lip(speed, nodes=121), 0.0)
    film = solve_film(contact)
    (exact,) = sensitivities(film, [step(contact, 1j * STEP)])
    h = 1e-4
    high, low = (outputs(solve_film(step(contact, d), film)) for d in (h, -h))
    scale = np.abs(outputs(film))
    np.testing.assert_allclose(exact / scale, (high - low) / (2 * h) / scale, rtol=1e-4, atol=2e-6)


def test_slopes_of_a_cavitated_film():
    """A film that ruptures keeps exact slopes: its rupture is part of the equations."""
    contact = lip(0.5, nodes=121, sealed=0.3e6, excess=2e6)
    film = solve_film(contact)
    assert film.converged
    assert np.max(film.cavitated_fraction) > 0.05
    (exact,) = sensitivities(film, [STEPS["speed"](contact, 1j * STEP)])
    high, low = (outputs(solve_film(STEPS["speed"](contact, d), film)) for d in (1e-6, -1e-6))
    np.testing.assert_allclose(exact, (high - low) / 2e-6, rtol=2e-3)


def test_several_slopes_at_once():
    """Slopes of several steps are those of each; none of a film that did not converge."""
    contact = lip(0.05, nodes=121)
    film = solve_film(contact)
    stepped = [STEPS[name](contact, 1j * STEP) for name in ("speed", "width")]
    together = sensitivities(film, stepped)
    for row, one in zip(together, stepped, strict=True):
        np.testing.assert_allclose(row, sensitivities(film, [one])[0], rtol=1e-10)
    lost = solve_film(replace(contact, width=-1.0))
    with pytest.raises(ValueError, match="width -1: must be above zero"):
        sensitivities(lost, stepped)


def step_ring(width=2e-3, excess=5e6):
    """PTFE step ring as a seal of a row."""

    def static(sealed, outer):
        return width, o_ring_profile(
            position=PLACES, sealed_pressure=sealed, outer_pressure=outer, excess=excess
        )

    return TandemSeal(static, Elastic(300e6, 0.46), ROUGH)


def lip_seal(width=4e-3, excess=1.5e6):
    """Polyurethane lip as a seal of a row."""

    def static(sealed, outer):
        return width, lip_profile(
            position=PLACES, sealed_pressure=sealed, outer_pressure=outer, excess=excess
        )

    return TandemSeal(static, Elastic(43e6, 0.48), ROUGH)


def tandem(inner, outer, speed, sealed=10e6, **more):
    """A step ring and a lip, or others, in oil of 0.043 Pa s."""
    return solve_tandem(
        inner=inner, outer=outer, lubricant=Lubricant(0.043, "barus", 16e-9), speed=speed,
        sealed_pressure=sealed, outer_pressure=AIR, **more,
    )  # fmt: skip


@pytest.mark.parametrize("speed", [0.05, -0.05, 1e-3])
def test_tandem_passes_one_flow(speed):
    """Both seals pass the same flow at the pressure between them, by films solved afresh."""
    found = tandem(step_ring(), lip_seal(), speed)
    assert found.converged, found.reason
    assert AIR < found.pressure < 10e6
    assert found.match_residual < 1e-6
    fresh = [solve_film(film.contact) for film in (found.inner, found.outer)]
    scale = max(abs(fresh[0].flow), abs(speed) / 2 * fresh[0].mean_film)
    assert abs(fresh[0].flow - fresh[1].flow) < 1e-6 * scale
    assert found.inner.contact.outer_pressure == found.outer.contact.sealed_pressure


def test_pressure_between_seals_may_exceed_the_sealed_one():
    """A ring that lets much oil out before a lip that lets less out: oil is caught between them."""
    found = tandem(step_ring(), lip_seal(), 0.3, sealed=3e6)
    assert found.converged, found.reason
    assert 3e6 < found.pressure < 4.5e6


def test_tandem_begun_from_another_is_the_same():
    """A warm start changes the trials, not the pressure."""
    near = tandem(step_ring(), lip_seal(), 0.06)
    cold = tandem(step_ring(), lip_seal(), 0.05)
    warm = tandem(step_ring(), lip_seal(), 0.05, start=near)
    assert warm.pressure == pytest.approx(cold.pressure, rel=1e-6)


@pytest.mark.parametrize("speed", [0.3, -0.3])
def test_starved_room_between_seals(speed):
    """Where one seal draws more than the other gives, the room stays in part empty."""
    inner, outer = lip_seal(), step_ring()
    found = tandem(inner, outer, speed, sealed=3e6)
    assert found.converged, found.reason
    assert found.pressure == 0.0
    assert 0 < found.cavitation < 1
    assert found.inner.flow == pytest.approx(found.outer.flow, rel=1e-6)
    assert found.inner.flow * speed > 0


def test_tandem_without_match_says_why():
    """Seals that would build pressure without limit, or that cannot be solved: one line."""
    found = tandem(step_ring(), lip_seal(), 0.3, sealed=1e6)
    assert not found.converged
    assert "with 1.5e+06 Pa between the seals, the inner seal still passes more" in found.reason
    assert np.isnan(found.pressure)
    higher = tandem(step_ring(), lip_seal(), 0.3, sealed=1e6, highest=4.0)
    assert higher.converged
    assert higher.pressure > 1.5e6
    wrong = tandem(lip_seal(width=-1.0), lip_seal(), 0.3)
    assert not wrong.converged
    assert "inner seal" in wrong.reason
    assert "width -1" in wrong.reason
