"""Finite elements of a step ring: derivatives, balances, trends over pressure of [Huang2017]."""

from __future__ import annotations

import math

import numpy as np
import pytest
from step_ring_case import PLASTIC, RUBBER, SECTION, SHAPE, SQUEEZE, seal

from actuator_opt.base.errors import ActuatorError
from actuator_opt.finite_elements import equilibrium, mesh
from actuator_opt.finite_elements.equilibrium import ContactPair
from actuator_opt.finite_elements.material import MooneyRivlin
from actuator_opt.finite_elements.mesh import SlideRing
from actuator_opt.finite_elements.o_ring import squeezed_ring
from actuator_opt.finite_elements.section import Assembly, MeshedBody
from actuator_opt.finite_elements.step_ring import squeezed_step_ring

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def pressed():
    """The seal at rest and at four pressures."""
    solution = seal(2e6, 5e6, 8e6, 10e6)
    assert solution.failure is None
    assert solution.residual < 1e-8
    return solution.contacts


def test_face_of_the_slide_ring():
    """Flat on the land, chamfer height at the sealed end, arcs tangent to both, heights by hand."""
    first, last = SHAPE.land
    assert (first, last) == pytest.approx((-3.5e-3, -2.7e-3))
    reach = SHAPE.edge_radius * math.tan(SHAPE.relief_angle / 2)
    flat = np.linspace(first + 1e-4, last - reach, 5)
    assert SHAPE.face(flat) == pytest.approx(np.zeros(5), abs=1e-15)
    assert SHAPE.face(np.array([-4e-3, 0.0])) == pytest.approx([0.3e-3, 2.7e-3 * math.tan(0.12)])
    x = np.linspace(-4e-3, 0, 40001)
    slope = np.gradient(SHAPE.face(x), x)
    assert np.abs(np.diff(slope)).max() < 2e-3  # no corner anywhere: the arcs turn 1e-7/radius


def test_derivatives_of_section_fluid_and_pair():
    """Central differences of the forces on all unknowns of two bodies in contact, hoop included."""
    shape = SHAPE.over(SECTION)
    round_mesh = mesh.disc(diameter=1.0, around=16)
    flat_mesh = mesh.slide_ring(shape, fine=0.1, coarse=0.4)
    section = Assembly(
        [
            MeshedBody(round_mesh, MooneyRivlin(0.1, 0.05), (-0.7, shape.thickness + 0.49)),
            MeshedBody(flat_mesh, MooneyRivlin(4.0, 0.0, 50.0)),
        ],
        sliding_radius=3.0,
    )
    back = section.nodes[section.edges[1], 1].min(axis=1) > shape.thickness - 1e-9
    pair = ContactPair(section.edges[0][:, :2].ravel(), section.edges[1][back])
    generator = np.random.default_rng(5)
    state = 2e-3 * generator.standard_normal(section.unknowns)
    direction = generator.standard_normal(section.unknowns)
    touching = pair.gap(section.places(state)) < 0.05
    assert touching.sum() > 2
    force = np.where(touching, 0.3, 0.0)
    pressure = np.full(len(section.nodes), 0.4)

    def total(values):
        places = section.places(values)
        rows = pair.rows(places, touching, force, section.unknowns)
        external, _ = equilibrium.load(section, places, pressure)
        return section.internal(values) - external - rows.directions.T @ force[touching]

    def gaps(values):
        return pair.gap(section.places(values))[touching]

    places = section.places(state)
    rows = pair.rows(places, touching, force, section.unknowns)
    _, blocks = equilibrium.load(section, places, pressure)
    slope = (section.stiffness(state, blocks) + rows.stiffness) @ direction
    step = 1e-7
    ahead, behind = state + step * direction, state - step * direction
    change = (total(ahead) - total(behind)) / (2 * step)
    assert slope == pytest.approx(change, abs=1e-5 * np.abs(change).max())
    moved = (gaps(ahead) - gaps(behind)) / (2 * step)
    assert rows.gaps @ direction == pytest.approx(moved, abs=1e-6)


def test_a_wide_flat_land_hands_on_the_rubber_ring_s_load():
    """Mounted, rod and groove carry what the rubber ring alone would carry at the same squeeze."""
    shape = SlideRing(4e-3, 1.5e-3, 3e-3, 0.5e-3, 0.3e-3, 0.12, 0.15e-3)
    contact = seal(shape=shape).contacts[0]
    alone = squeezed_ring(
        section=SECTION,
        squeeze=SQUEEZE,
        groove_width=shape.width,
        rubber=RUBBER,
        elements_around=32,
    ).contacts[0]
    assert contact.line_load == pytest.approx(contact.opposite_load, rel=1e-7)
    assert contact.line_load == pytest.approx(alone.line_load, rel=0.02)
    assert contact.width > 0.9 * shape.land_width


@pytest.mark.long
def test_forces_on_the_step_ring_balance(pressed):
    """The side wall carries the fluid on the whole gland depth; the profile adds up to the load."""
    depth = SHAPE.thickness + (1 - SQUEEZE) * SECTION
    assert pressed[0].line_load == pytest.approx(pressed[0].opposite_load, rel=1e-7)
    for contact in pressed[1:]:
        assert contact.side_load == pytest.approx(contact.pressure * depth, rel=0.015)
        assert np.trapezoid(contact.contact_pressure, contact.positions) == pytest.approx(
            contact.line_load, rel=0.03
        )
        assert contact.contact_pressure[0] == contact.pressure
        assert contact.contact_pressure[-1] == 0


@pytest.mark.long
def test_trends_over_pressure_against_the_published_figure(pressed):
    """Length and stress grow as published up to 5 MPa; our elastic peak grows on beyond.

    Huang2017 figure 17 has the peak fall above 5 MPa for a ring whose section it does not state.
    """
    widths = [contact.width for contact in pressed]
    peaks = [contact.peak_pressure for contact in pressed]
    assert widths == sorted(widths)
    assert peaks[2] > peaks[1] > pressed[1].pressure
    assert peaks[4] > peaks[3] > peaks[2]
    mean = [contact.line_load / contact.width / contact.pressure for contact in pressed[1:]]
    assert all(1 < value < 2.5 for value in mean)


def test_the_stiff_ring_carries_the_stress(pressed):
    """Figure 12's quantity: von Mises stress is highest in the plastic and grows with pressure."""
    highest = []
    for contact in pressed[1:]:
        field = contact.field
        plastic, rubber = (field.von_mises[field.body == body].max() for body in (1, 0))
        assert plastic > rubber
        highest.append(plastic)
        assert field.triangles.max() < len(field.nodes)
    assert highest == sorted(highest)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ({"width": 5e-3, "edge_radius": 0.0}, "sharp ends"),
        ({"land_width": 3.8e-3}, "leave no width"),
        ({"land_width": 0.0}, "is not positive"),
        ({"relief_angle": -0.1}, "outside 0 to 1"),
        ({"chamfer_height": 1.4e-3}, "uses up the thickness of the slide ring"),
    ],
)
def test_an_impossible_slide_ring_is_one_clear_line(shape, message):
    """Shapes that cannot be meshed are refused with a remedy."""
    wrong = SlideRing(**{name: getattr(SHAPE, name) for name in SHAPE.__slots__} | shape)
    with pytest.raises(ActuatorError, match=message) as error:
        seal(shape=wrong)
    assert all(d.remedy for d in error.value.diagnostics)


def test_a_slide_ring_wider_than_its_groove_is_refused():
    """One clear line again."""
    with pytest.raises(ActuatorError, match=r"0\.004 m wide, but its groove 0\.003 m"):
        squeezed_step_ring(
            section=SECTION,
            squeeze=SQUEEZE,
            groove_width=3e-3,
            rubber=RUBBER,
            plastic=PLASTIC,
            shape=SHAPE,
        )
