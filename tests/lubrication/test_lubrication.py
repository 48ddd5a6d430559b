"""Films under seals: published check tables, closed solutions, laws, residuals, faults."""

from __future__ import annotations

from dataclasses import replace

import film_cases
import numpy as np
import pytest
from film_cases import AIR, ROUGH, drag, lip, o_ring

from actuator_opt.lubrication import Contact, Elastic, Lubricant, Surface, solve_film
from actuator_opt.models.rough_surface import asperity_pressure, pressure_flow_factor

LIP_TABLE = [
    (0.002, 1123.8, 3.7191e-8), (0.05, 1180.4, 8.4565e-8), (0.3, 1217.5, 3.3244e-7),
    (-0.002, -1128.4, 3.3225e-8), (-0.05, -1059.3, -1.4726e-8), (-0.3, -494.3, -2.8982e-7),
]  # fmt: skip
SHAPE = {"poissons_ratio": 0.48, "asperity_density": 8e13, "asperity_radius": 1.5e-6}


def solved(contact, start=None):
    """A film that has to converge, with both residuals below 1e-6."""
    film = solve_film(contact, start)
    assert film.converged, film.reason
    assert max(film.load_residual, film.mass_residual) < 1e-6
    return film


def uniform(speed, *, ends=1e5, carried=7.48565e6, share=0.0, nodes=41):
    """A contact whose exact film is the constant H = 2.5 of the check tables."""
    return Contact(
        width=3e-3,
        static_pressure=np.full(nodes, ends + carried),
        elastic=Elastic(30e6, 0.48),
        surface=Surface(1e-6, 8e13, 1.5e-6, share),
        lubricant=Lubricant(0.04),
        speed=speed,
        sealed_pressure=ends,
        outer_pressure=ends,
    )


@pytest.mark.parametrize(("speed", "force", "flow"), LIP_TABLE)
def test_lip_check_table(speed, force, flow):
    """The lip of the check table: drag within 3 % and flow within 5 %; here within 1e-4."""
    film = solved(lip(speed))
    assert drag(film, 0.2) == pytest.approx(force, rel=1e-4)
    assert film.flow == pytest.approx(flow, rel=1e-4)


@pytest.mark.parametrize(
    ("speed", "force", "flow"), [(0.05, 430.71, 8.0797e-8), (-0.05, -430.27, 6.147e-9)]
)
def test_o_ring_check_table(speed, force, flow):
    """The O-ring of the check table: width of Hertz and Lindley, then drag and flow."""
    width, excess = film_cases.hertz(0.13, 3.53e-3, 8e6)
    assert width == pytest.approx(1.18326e-3, rel=1e-5)
    film = solved(o_ring(speed, width=width, excess=excess))
    assert drag(film, 0.25) == pytest.approx(force, rel=1e-4)
    assert film.flow == pytest.approx(flow, rel=2e-4)


@pytest.mark.parametrize("speed", [0.2, -0.2])
@pytest.mark.parametrize("share", [0.0, 1.0])
def test_constant_film_is_exact(speed, share):
    """Equal ends under an even contact: H = 2.5 everywhere, every output from the check tables.

    A smooth rod carries less oil (h_T - sigma Phi_s) and shears more (phi_f + Phi_fs); a rough
    rod the other way round.
    """
    film = solved(uniform(speed, share=share))
    sign = 2 * share - 1
    np.testing.assert_allclose(film.film, 2.5e-6, rtol=1e-6)
    carried = speed / 2 * 1e-6 * (2.502004 + sign * 0.638772)
    sheared = 0.04 * speed / 2.5e-6 * (1.379666 - sign * 0.477628) * 3e-3
    assert film.flow == pytest.approx(carried, rel=2e-6)
    assert film.viscous_drag == pytest.approx(sheared, rel=2e-6)
    assert film.contact_load == pytest.approx(7.48565e6 * 3e-3, rel=1e-6)
    np.testing.assert_allclose(film.pressure, 1e5, rtol=1e-6)
    np.testing.assert_allclose(film.contact_pressure, 7.48565e6, rtol=1e-6)
    whole = film.viscous_drag + np.sign(speed) * 0.1 * film.contact_load
    assert drag(film, 0.1) == pytest.approx(whole, rel=1e-15)


def test_film_equation_holds():
    """Film h - h_s - C + (1 - nu^2)/(pi E) int d ln(x - s)^2 ds = 0, by quadrature.

    The integral is taken here with the analytic integral of a piecewise linear d, which the
    solver (constant per cell) does not use: agreement to the order of the mesh.
    """
    film = solved(lip(0.05, nodes=321))
    contact = film.contact
    d = film.pressure + film.contact_pressure - contact.static_pressure
    x = film.x / contact.width
    t, weight = np.polynomial.legendre.leggauss(400)
    places, shares = (t + 1) / 2, weight / 2
    values = np.interp(places, x, d)
    chosen = np.arange(10, 311, 50)
    bent = np.array(
        [
            np.sum(shares * (values - d[i]) * np.log((x[i] - places) ** 2))
            + d[i] * 2 * (x[i] * np.log(x[i]) + (1 - x[i]) * np.log(1 - x[i]) - 1)
            for i in chosen
        ]
    )
    h = np.linspace(-2, 12, 20001)
    pressure = asperity_pressure(
        film_ratio=h, youngs_modulus=50e6, poissons_ratio=0.48, asperity_density=1e14,
        asperity_radius=1e-6, roughness=0.8e-6,
    )  # fmt: skip
    rest = 0.8e-6 * np.interp(-contact.static_pressure[chosen], -pressure, h)
    compliance = (1 - 0.48**2) / (np.pi * 50e6) * contact.width
    off = film.film[chosen] - rest - film.rigid_shift + compliance * bent
    assert np.max(np.abs(off)) < 0.01e-6
    load = np.sum(shares * values) * contact.width
    assert abs(load) < 1e-3 * np.trapezoid(contact.static_pressure, film.x)


def test_oil_and_asperities_carry_a_soft_seal():
    """Without stiffness of its own the seal leaves p + p_c = p_sc: within 2 % off the ends at rest.

    At speed 0 nothing is sheared by motion and the film leaks by its pressure alone.
    """
    film = solved(lip(0.0, elastic=Elastic(5e6, 0.48), surface=Surface(0.8e-6, 1e15, 1e-6)))
    inner = slice(4, -4)
    carried = (film.pressure + film.contact_pressure)[inner]
    np.testing.assert_allclose(carried, film.contact.static_pressure[inner], rtol=0.02)
    assert film.flow > 0
    assert drag(film, 0.2) - film.viscous_drag == pytest.approx(0.2 * film.contact_load)


def test_rest_is_the_limit_of_slow_motion():
    """Load and flow at speed 0 are those at a creep, out and in."""
    rest = solved(lip(0.0))
    for speed in (1e-8, -1e-8):
        creep = solved(lip(speed))
        assert creep.contact_load == pytest.approx(rest.contact_load, rel=1e-6)
        assert creep.flow == pytest.approx(rest.flow, rel=1e-5)


def test_leak_at_rest_is_poiseuille():
    """Q int 12 eta/(phi_x h^3) dx = p_s - p_a over the film at rest, iso-viscous."""
    film = solved(lip(0.0, nodes=481, lubricant=Lubricant(0.035)))
    resistance = 12 * 0.035 / (pressure_flow_factor(film_ratio=film.film / 0.8e-6) * film.film**3)
    drop = film.flow * np.trapezoid(resistance, film.x)
    assert drop == pytest.approx(5e6 - AIR, rel=2e-3)


@pytest.mark.long
@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_thick_film_follows_blok(speed):
    """A soft seal on a film far above its roughness: q = U h*/2, h* = sqrt(8 eta U/(9 w)).

    The static pressure is a squared sine of 4 MPa over 4 mm, whose steepest rise w is pi P/L at
    the quarter; the inverse theory is exact where the oil carries all of the static pressure.
    """
    place = np.linspace(0, 1, 481)
    contact = replace(
        lip(speed, nodes=481, sealed=AIR, lubricant=Lubricant(0.05)),
        static_pressure=AIR + 4e6 * np.sin(np.pi * place) ** 2,
        elastic=Elastic(1e6, 0.48),
        surface=Surface(0.05e-6, 4e15, 1e-6),
    )
    film = solved(contact)
    assert np.min(film.film) > 15 * 0.05e-6
    thickness = np.sqrt(8 * 0.05 * abs(speed) / (9 * np.pi * 4e6 / 4e-3))
    assert film.flow == pytest.approx(speed * thickness / 2, rel=0.02)


@pytest.mark.parametrize(("peak", "speed"), [(0.3, -0.05), (0.3, 0.05), (0.4, -0.3)])
def test_a_lopsided_lip_follows_the_rise_along_the_motion(peak, speed):
    """A lip with its peak off the middle: w of Blok's film is the rise in the direction of motion.

    The steepest slope of the other flank misses the flow by 18 % and more.
    """
    place = np.linspace(0, 1, 241)
    phase = np.where(place < peak, place / peak, 1 + (place - peak) / (1 - peak)) / 2
    contact = replace(
        lip(speed, nodes=241, sealed=AIR, lubricant=Lubricant(0.05)),
        static_pressure=AIR + 4e6 * np.sin(np.pi * phase) ** 2,
        elastic=Elastic(1e6, 0.48),
        surface=Surface(0.05e-6, 4e15, 1e-6),
    )
    film = solved(contact)

    def flow(flank):
        """Flow by the steepest slope of a flank of this share of the width."""
        steepest = np.pi * 4e6 / (2 * flank * 4e-3)
        return speed / 2 * np.sqrt(8 * 0.05 * abs(speed) / (9 * steepest))

    along, against = (peak, 1 - peak) if speed > 0 else (1 - peak, peak)
    assert film.flow == pytest.approx(flow(along), rel=2e-3)
    assert abs(flow(against) / film.flow - 1) > 0.17


def test_mirror():
    """Turned end for end with the speed turned too: the same film, flow and drag turned."""
    contact = lip(0.3)
    turned = replace(
        contact,
        static_pressure=contact.static_pressure[::-1].copy(),
        speed=-0.3,
        sealed_pressure=contact.outer_pressure,
        outer_pressure=contact.sealed_pressure,
    )
    film, other = solved(contact), solved(turned)
    np.testing.assert_allclose(other.film[::-1], film.film, rtol=1e-7)
    assert other.flow == pytest.approx(-film.flow, rel=1e-7)
    assert other.viscous_drag == pytest.approx(-film.viscous_drag, rel=1e-7)


def test_speed_and_viscosity_act_as_a_product():
    """Twice the viscosity at half the speed: the same film and drag, half the flow (no Barus)."""
    film = solved(lip(-0.3, lubricant=Lubricant(0.035)))
    other = solved(lip(-0.15, lubricant=Lubricant(0.07)))
    np.testing.assert_allclose(other.film, film.film, rtol=1e-8)
    assert drag(other, 0.2) == pytest.approx(drag(film, 0.2), rel=1e-8)
    assert other.flow == pytest.approx(film.flow / 2, rel=1e-8)


def test_width_and_stiffness_act_as_a_ratio():
    """Twice the width and modulus at half the speed, half the asperities: the same film.

    The compliance L/E, the asperity stiffness E eta_a and the wedge eta U L stay: the contact
    load doubles, the viscous drag (eta U L/h) stays and the flow halves.
    """
    film = solved(lip(0.2, lubricant=Lubricant(0.035)))
    other = solved(
        lip(
            0.1,
            width=8e-3,
            elastic=Elastic(100e6, 0.48),
            surface=Surface(0.8e-6, 0.5e14, 1e-6),
            lubricant=Lubricant(0.035),
        )
    )
    np.testing.assert_allclose(other.film, film.film, rtol=1e-7)
    assert other.contact_load == pytest.approx(2 * film.contact_load, rel=1e-7)
    assert other.viscous_drag == pytest.approx(film.viscous_drag, rel=1e-7)
    assert other.flow == pytest.approx(film.flow / 2, rel=1e-7)


@pytest.mark.parametrize("speed", [0.05, 0.3, -0.05, -0.3])
def test_mesh(speed):
    """121 nodes against 241: drag and flow within 0.1 %, less than 61 against 241."""
    coarse, middle, fine = (solved(lip(speed, nodes=n)) for n in (61, 121, 241))
    for value in (lambda film: drag(film, 0.2), lambda film: film.flow):
        assert value(middle) == pytest.approx(value(fine), rel=1e-3)
        assert abs(value(middle) - value(fine)) < abs(value(coarse) - value(fine))


def test_warm_start_finds_the_same_film():
    """A film begun from a near point equals the cold one, in fewer steps."""
    cold, other = solved(lip(0.06)), solved(lip(0.05))
    warm = solved(lip(0.06), other)
    np.testing.assert_allclose(warm.film, cold.film, rtol=1e-7)
    assert warm.iterations < cold.iterations


def test_flow_carries_the_density_of_the_oil():
    """Huang eq. 3: what moves is weighed with the density at its pressure; even film, even p."""
    oil = Lubricant(0.04, density_c_a=0.6e-9, density_c_b=1.7e-9)
    film = solved(replace(uniform(0.2, ends=30e6), lubricant=oil))
    plain = solved(uniform(0.2, ends=30e6))
    rise = 1 + 0.6e-9 * 30e6 / (1 + 1.7e-9 * 30e6)
    assert film.flow == pytest.approx(rise * plain.flow, rel=1e-6)


@pytest.mark.long
def test_random_points_converge():
    """150 random points over 1e-4..1 m/s, 0.1..40 MPa, -20..100 degC, three seals: 99 % or more.

    Every film that says it converged has both residuals below 1e-6; one that did not says why.
    """
    films = [solve_film(contact) for _, contact in film_cases.random_cases(150)]
    good = [film for film in films if film.converged]
    assert len(good) >= 0.99 * len(films)
    assert all(max(film.load_residual, film.mass_residual) < 1e-6 for film in good)
    assert all(film.reason for film in films if not film.converged)
    assert all(np.all(film.film > 0) and np.all(film.cavitated_fraction < 1) for film in good)
    assert all(np.all(film.pressure > -1e-6 * film.contact.sealed_pressure) for film in good)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width": 0.0}, "width 0: must be above zero"),
        ({"width": np.nan}, "width is not a finite number"),
        ({"lubricant": Lubricant(-1.0)}, "viscosity -1: must be above zero"),
        ({"lubricant": Lubricant(0.04, "cubic")}, "pressure law 'cubic'.*use one of none, barus"),
        ({"elastic": Elastic(1e6, 0.7)}, "Poisson's ratio 0.7"),
        ({"surface": Surface(0.8e-6, 1e11, 1e-6)}, "presses the asperities flat"),
        ({"surface": Surface(0.8e-6, 1e14, 1e-6, 1.5)}, "rod share 1.5"),
        ({"cavitation_pressure": 2e5}, "outer pressure 101000 Pa absolute is below"),
        ({"static_pressure": np.ones(3)}, "static pressure has the shape"),
        ({"static_pressure": np.linspace(-1e6, 1e6, 9)}, "static pressure -1e\\+06 Pa"),
        ({"outer_cavitation": 1.2}, "outer cavitation 1.2"),
    ],
)
def test_faults_are_one_line(changes, message):
    """Bad input gives a film that did not converge, with one line that names what is wrong."""
    film = solve_film(replace(lip(0.1), **changes))
    assert not film.converged
    assert np.isnan(film.viscous_drag)
    assert np.isnan(film.flow)
    assert "\n" not in film.reason
    with pytest.raises(AssertionError, match=message):
        solved(replace(lip(0.1), **changes))


def test_a_lost_film_says_why(monkeypatch):
    """Without iterations enough no film is claimed: the reason tells residuals and speed."""
    monkeypatch.setattr("actuator_opt.lubrication.newton.MOST_ITERATIONS", 1)
    film = solve_film(lip(0.3))
    assert not film.converged
    assert "no equilibrium within 1 iterations" in film.reason
    assert np.isnan(film.flow)


def test_rough_surface_of_the_table_is_the_published_order():
    """The shared surface is that of the published rod seals: 0.8 um, 1e14 per m^2, 1 um."""
    assert Surface(0.8e-6, 1e14, 1e-6) == ROUGH
