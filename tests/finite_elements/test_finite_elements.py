"""Finite elements: material, contact of a squeezed ring and fluid, against closed forms."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import quad

from actuator_opt.base.errors import ActuatorError
from actuator_opt.finite_elements import equilibrium, mesh, o_ring
from actuator_opt.finite_elements.material import MooneyRivlin, stress, tangent
from actuator_opt.finite_elements.o_ring import squeezed_ring
from actuator_opt.finite_elements.section import Assembly, MeshedBody, stress_field
from actuator_opt.models import seals

SECTION, MODULUS, GROOVE = 3.53e-3, 8e6, 4.82e-3
RUBBER = MooneyRivlin.of_modulus(MODULUS, second_share=0.2)


def ring(squeeze, *pressures, around=64, **more):
    """A ring of the section above; pressures over the modulus."""
    solution = squeezed_ring(
        section=SECTION,
        squeeze=squeeze,
        groove_width=more.pop("groove_width", GROOVE),
        rubber=more.pop("rubber", RUBBER),
        pressures=[p * MODULUS for p in pressures],
        elements_around=around,
        **more,
    )
    assert solution.failure is None
    assert solution.residual < 1e-8
    return solution


def block(width, height, seed=3):
    """A rectangle of irregular triangles with its corner at the origin."""
    x, y = np.meshgrid(np.linspace(0, width, 4), np.linspace(0, height, 4), indexing="ij")
    points = np.stack((x.ravel(), y.ravel()), axis=1)
    inner = (points > 0).all(axis=1) & (points < [width, height]).all(axis=1)
    shift = np.random.default_rng(seed).uniform(-0.06, 0.06, points.shape)
    points[inner] += shift[inner] * [width, height]
    corner = np.arange(16).reshape(4, 4)
    a, b, c, d = (
        part.ravel()
        for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:])
    )
    return mesh.meshed(
        points, np.concatenate((np.stack((a, b, c), axis=1), np.stack((a, c, d), axis=1)))
    )


def held(section, *conditions):
    """Equilibrium without fluid, with displacement components of chosen nodes prescribed."""
    bounds = equilibrium.DisplacementBounds.none(section)
    for nodes, component, value in conditions:
        unknown = 2 * np.flatnonzero(nodes) + component
        bounds.lower[unknown] = bounds.upper[unknown] = value
    problem = equilibrium.ElementProblem(section, bounds, lambda state, places, pressure: state.wet)
    return equilibrium.solve(problem, problem.start(), 0.0)


def test_stress_is_the_energy_derivative_and_the_tangent_its_own():
    """Central differences of the strain energy give the stress, those of the stress the tangent."""
    body = MooneyRivlin(0.3, 0.2)
    gradient = np.array([1.1, 0.15, -0.2, 0.95, 1.05])
    multiplier, c10, c01 = np.array(0.4), np.array(body.c10), np.array(body.c01)

    def energy(f):
        full = np.array([[f[0], f[1], 0], [f[2], f[3], 0], [0, 0, f[4]]])
        right = full.T @ full
        first, volume = np.trace(right), np.linalg.det(full)
        second = (first**2 - np.trace(right @ right)) / 2
        return 0.3 * (first - 3) + 0.2 * (second - 3) - 1.4 * math.log(volume) + 0.4 * (volume - 1)

    nominal = stress(gradient, multiplier, c10, c01)
    slope = tangent(gradient, multiplier, c10, c01)
    for k in range(5):
        step = np.zeros(5)
        step[k] = 1e-6
        change = (energy(gradient + step) - energy(gradient - step)) / 2e-6
        assert nominal[k] == pytest.approx(change, abs=1e-8)
        ahead, behind = (stress(gradient + s, multiplier, c10, c01) for s in (step, -step))
        assert slope[:, k] == pytest.approx((ahead - behind) / 2e-6, abs=1e-7)


@pytest.mark.parametrize("stretch", [0.7, 1.5])
def test_plane_strain_tension_of_mooney_and_rivlin(stretch):
    """A block of irregular elements stretches evenly: 2 (C10 + C01)(l - l^-3), exact by hand."""
    body = MooneyRivlin(0.12, 0.05)
    section = Assembly([MeshedBody(block(1.0, 1.0), body)])
    x, y = section.nodes.T
    state = held(section, (x < 1e-9, 0, 0.0), (y < 1e-9, 1, 0.0), (x > 1 - 1e-9, 0, stretch - 1))
    places = section.places(state.values)
    assert places == pytest.approx(section.nodes * [stretch, 1 / stretch], abs=1e-9)
    force = state.reaction.reshape(-1, 2)[x > 1 - 1e-9, 0].sum()
    assert force == pytest.approx(2 * 0.17 * (stretch - stretch**-3), rel=1e-9)
    along, across, out = (2 * 0.12 * s**2 - 2 * 0.05 / s**2 for s in (stretch, 1 / stretch, 1.0))
    mises = math.sqrt(((along - across) ** 2 + (across - out) ** 2 + (out - along) ** 2) / 2)
    assert stress_field(section, state.values, 1.0, 1.0).von_mises == pytest.approx(mises)


@pytest.mark.parametrize("outward", [1, -1])
def test_thick_tube_of_neo_hookean_rubber(outward):
    """An axisymmetric tube blown up between frictionless ends: pressure integral by quadrature."""
    inner, outer, growth = 2.0, 3.0, 0.3
    sliding = inner if outward == 1 else outer
    section = Assembly(
        [MeshedBody(block(0.4, outer - inner), MooneyRivlin(0.5, 0.0))], sliding, outward
    )
    x, y = section.nodes.T
    at_bore = y < 1e-9 if outward == 1 else y > outer - inner - 1e-9
    state = held(
        section, (x < 1e-9, 0, 0.0), (x > 0.4 - 1e-9, 0, 0.0), (at_bore, 1, outward * growth)
    )
    swept = (inner + growth) ** 2 - inner**2

    def integrand(radius):
        hoop = math.sqrt(radius**2 + swept) / radius
        return (hoop**2 - hoop**-2) * radius / (radius**2 + swept)

    pressure = quad(integrand, inner, outer)[0]  # dr/r of the deformed radius
    force = outward * state.reaction.reshape(-1, 2)[at_bore, 1].sum()
    assert force * sliding == pytest.approx(pressure * (inner + growth) * 0.4, rel=2e-4)


def test_slightly_squeezed_ring_is_a_line_contact():
    """At 2 % squeeze width, peak and approach are Hertz's for a cylinder between plates."""
    contact = ring(0.02, around=192).contacts[0]
    stiffness, radius, load = MODULUS / 0.75, SECTION / 2, contact.line_load
    half = math.sqrt(4 * load * radius / (math.pi * stiffness))
    approach = 2 * load / (math.pi * stiffness) * (2 * math.log(4 * radius / half) - 1)
    assert contact.width == pytest.approx(2 * half, rel=0.05)
    assert contact.peak_pressure == pytest.approx(2 * load / (math.pi * half), rel=0.02)
    assert approach == pytest.approx(0.02 * SECTION, rel=0.03)


@pytest.mark.parametrize(
    "squeeze",
    [0.10, pytest.param(0.20, marks=pytest.mark.long), pytest.param(0.30, marks=pytest.mark.long)],
)
def test_mounted_ring_meets_the_closed_form(squeeze):
    """Line load to 2.5 %, width to 5 %, peak to 6 %, and to 2.5 % with its own load and width."""
    contact = ring(squeeze, around=128).contacts[0]
    law = seals.LAWS["plane_strain"]
    inputs = {"squeeze": squeeze, "section": SECTION, "youngs_modulus": MODULUS, "pressure": 0.0}
    assert contact.line_load == pytest.approx(law.line_load(**inputs), rel=0.025)
    assert contact.width == pytest.approx(law.contact_width(**inputs), rel=0.05)
    assert contact.peak_pressure == pytest.approx(law.peak_pressure(**inputs), rel=0.06)
    own = 4 * contact.line_load / (math.pi * contact.width)
    assert contact.peak_pressure == pytest.approx(own, rel=0.025)


@pytest.mark.long
def test_pressurised_ring():
    """Peak p0 + p to 4 %; load and width lie up to 12 % below the closed form of the model."""
    mounted, *pressed = ring(0.15, 0.25, 0.5, 1.0, around=96).contacts
    law = seals.LAWS["plane_strain"]
    for contact in pressed:
        inputs = {
            "squeeze": 0.15,
            "section": SECTION,
            "youngs_modulus": MODULUS,
            "pressure": contact.pressure,
        }
        raised = mounted.peak_pressure + contact.pressure
        assert contact.peak_pressure == pytest.approx(raised, rel=0.04)
        assert 0.88 < contact.line_load / law.line_load(**inputs) < 1
        assert 0.88 < contact.width / law.contact_width(**inputs) < 1
    widths = [contact.width for contact in (mounted, *pressed)]
    assert widths == sorted(widths)


@pytest.mark.long
def test_forces_of_a_pressurised_ring_balance():
    """Face and groove bottom carry the same; the side wall the fluid on the gland's depth."""
    squeeze = 0.2
    for contact in ring(squeeze, 0.5, 1.5).contacts[1:]:
        depth = SECTION * (1 - squeeze)
        assert contact.opposite_load == pytest.approx(contact.line_load, rel=0.02)
        assert contact.side_load == pytest.approx(contact.pressure * depth, rel=0.01)
        assert np.trapezoid(contact.contact_pressure, contact.positions) == pytest.approx(
            contact.line_load, rel=0.01
        )


def test_profile_is_a_static_pressure_table():
    """It rises from the sealed pressure at 0, ends at the outer pressure at the width, in order."""
    contact = ring(0.15, 0.5).contacts[1]
    positions, pressures = contact.positions, contact.contact_pressure
    assert positions[0] == 0
    assert positions[-1] == pytest.approx(contact.width)
    assert (np.diff(positions) > 0).all()
    assert pressures[[0, -1]] == pytest.approx([0.5 * MODULUS, 0.0])
    assert pressures[1:-1].max() == pytest.approx(contact.peak_pressure)


def test_pressure_on_both_sides_only_adds_itself(monkeypatch):
    """Superposition: a fluid all around an incompressible ring raises the contact pressure by p."""

    def everywhere(self, state, places, pressure):
        wet = np.zeros(len(places))
        free = ~(state.at_lower | state.at_upper).reshape(-1, 2)[:, 1]
        wet[self.boundary] = free[self.boundary]
        return wet

    monkeypatch.setattr(o_ring.RoundRing, "wet_part", everywhere)
    one = o_ring.RoundRing(MooneyRivlin.of_modulus(1.0), 64, None, 1)
    free = one.mount(0.15, 2.0)
    pressed = equilibrium.solve(one.problem, free, 0.7)
    touching = one.boundary[free.at_lower.reshape(-1, 2)[one.boundary, 1]]
    places = one.section.places(free.values)
    share = np.abs(equilibrium.shares(one.section, places))[touching, 0]
    before, after = (s.reaction.reshape(-1, 2)[touching, 1] / share for s in (free, pressed))
    inner = np.argsort(np.abs(places[touching, 0]))[: len(touching) // 2]
    assert after[inner] - before[inner] == pytest.approx(np.full(len(inner), 0.7), rel=5e-3)


@pytest.mark.long
def test_refinement_converges():
    """Load and peak at pressure change by less than 1.5 % from 64 to 128 elements around."""
    coarse, fine = (ring(0.2, 0.5, around=around).contacts[1] for around in (64, 128))
    assert coarse.line_load == pytest.approx(fine.line_load, rel=0.015)
    assert coarse.peak_pressure == pytest.approx(fine.peak_pressure, rel=0.01)
    assert coarse.width == pytest.approx(fine.width, rel=0.03)


@pytest.mark.long
def test_only_the_sum_of_the_constants_counts_in_plane_strain():
    """With one stretch 1 and the volume constant both invariants are equal, up to the mesh."""
    one, other = (
        ring(0.15, 0.5, rubber=MooneyRivlin.of_modulus(MODULUS, second_share=share))
        for share in (0.0, 0.4)
    )
    for a, b in zip(one.contacts, other.contacts, strict=True):
        assert a.line_load == pytest.approx(b.line_load, rel=5e-3)
        assert a.peak_pressure == pytest.approx(b.peak_pressure, rel=3e-3)


@pytest.mark.long
def test_a_wide_ring_is_plane_and_a_narrow_one_is_not():
    """At a radius of 1000 sections the hoop does nothing; at 2 the groove also compresses it."""
    plane = ring(0.15, 0.5, around=32)
    wide = ring(0.15, 0.5, around=32, sliding_radius=1000 * SECTION)
    narrow = ring(0.15, around=32, sliding_radius=2 * SECTION)
    for a, b in zip(plane.contacts, wide.contacts, strict=True):
        assert b.line_load == pytest.approx(a.line_load, rel=5e-3)
        assert b.width == pytest.approx(a.width, rel=0.01)
    assert narrow.contacts[0].opposite_load > 1.05 * narrow.contacts[0].line_load


@pytest.mark.long
@pytest.mark.parametrize(("on_rod", "sign"), [(True, 1), (False, -1)])
def test_the_side_wall_of_a_round_groove_carries_an_annulus(on_rod, sign):
    """Around a rod the fluid acts on p H (1 + H/2r) per circumference of it, in a bore on less."""
    radius, depth = 4 * SECTION, 0.8 * SECTION
    contact = ring(0.2, 0.5, sliding_radius=radius, on_rod=on_rod).contacts[1]
    annulus = depth * (1 + sign * depth / (2 * radius))
    assert contact.side_load == pytest.approx(contact.pressure * annulus, rel=0.01)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"squeeze": 0.6}, "squeeze 0.6 is outside"),
        ({"groove_width": 2.5e-3}, "fills its groove"),
        ({"pressures": [2e6, 1e6]}, "must be positive and increasing"),
        ({"elements_around": 30}, "a multiple of 4"),
        ({"section": 0.0}, "is not positive"),
        ({"rubber": MooneyRivlin(0.0, 0.0)}, "not positive"),
    ],
)
def test_bad_input_is_one_clear_line(change, message):
    """What cannot be solved is refused before it is tried, with a remedy."""
    inputs = {"section": SECTION, "squeeze": 0.15, "groove_width": GROOVE, "rubber": RUBBER}
    with pytest.raises(ActuatorError, match=message) as error:
        squeezed_ring(**{**inputs, **change})
    assert all(d.remedy for d in error.value.diagnostics)


@pytest.mark.long
def test_a_pressure_out_of_reach_is_said_in_words(monkeypatch):
    """Far beyond the modulus no equilibrium is found: what was reached stays, with the reason."""
    monkeypatch.setattr(equilibrium, "SHORTEST_STEP", 0.09)
    solution = squeezed_ring(
        section=SECTION,
        squeeze=0.15,
        groove_width=GROOVE,
        rubber=RUBBER,
        pressures=[0.5 * MODULUS, 500 * MODULUS],
        elements_around=16,
    )
    assert len(solution.contacts) == 2
    assert "times the modulus" in solution.failure


def test_a_missing_library_is_one_clear_line(monkeypatch):
    """Without scikit-fem the error names the extra to install."""
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(ActuatorError, match=r"scikit-fem; pip install 'actuator-opt\[fem\]'"):
        mesh.disc(diameter=1.0, around=16)


def test_the_core_never_loads_the_library():
    """Importing the program loads neither the library nor this package."""
    code = (
        "import sys, actuator_opt, actuator_opt.api\n"
        "assert not [m for m in sys.modules if m == 'skfem' or 'finite_elements' in m]"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)
