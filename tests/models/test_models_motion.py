"""Claims about chambers that keep their mass, end stops, cushions and two-pivot linkages."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import solve_ivp

from actuator_opt.models import chamber, end_stop, endurance, linkage
from actuator_opt.models.fluid import effective_bulk_modulus
from actuator_opt.models.oil_laws import density_compressed

STEP = 1e-30
K = 1.4e9
AIR = st.floats(1e-6, 0.2)
SLOPE = st.sampled_from([0.0, 6.0, 10.8])
INDEX = st.floats(1.0, 1.4)
PRESSURE = st.floats(-0.999e5, 5e7)


def oil(air=0.0, slope=0.0, index=1.4):
    """Arguments of the chamber's law."""
    return {
        "bulk_modulus": K,
        "slope": slope,
        "air_content": air,
        "polytropic_index": index,
    }


@given(st.floats(-1e7, 5e7), SLOPE)
def test_pure_oil_is_the_compressed_liquid(pressure, slope):
    """V_ref = V e^(p/K), or the liquid of K + m p, and K_eff is the oil's own."""
    found = 1e-4 * chamber.density_ratio(pressure=pressure, **oil(slope=slope))
    wanted = density_compressed(
        reference_density=1e-4, pressure=pressure, bulk_modulus=K, slope=slope
    )
    assert found == pytest.approx(wanted, rel=1e-14)
    if slope == 0:
        assert found == pytest.approx(1e-4 * math.exp(pressure / K), rel=1e-14)
    stiff = chamber.mixture_bulk_modulus(pressure=pressure, **oil(slope=slope))
    assert stiff == pytest.approx(K + slope * pressure, rel=1e-12)


@given(PRESSURE, AIR, SLOPE, INDEX)
def test_reference_volume_and_bulk_modulus_are_consistent(pressure, air, slope, index):
    """dV_ref/dp = V_ref/K_eff, by complex step."""
    law = oil(air, slope, index)
    stepped = chamber.density_ratio(pressure=pressure + 1j * STEP, **law)
    stiff = chamber.mixture_bulk_modulus(pressure=pressure, **law)
    assert stepped.imag / STEP == pytest.approx(stepped.real / stiff, rel=1e-9)


@given(st.floats(-0.89e5, 5e7), AIR, SLOPE, INDEX)
def test_bulk_modulus_is_the_published_one_of_the_air_at_that_pressure(pressure, air, slope, index):
    """[AaltoThesis] eq. 5 with air over the compressed oil; over the loose oil e^(p/K) - 1 off."""
    found = chamber.mixture_bulk_modulus(pressure=pressure, **oil(air, slope, index))
    shrunk = density_compressed(
        reference_density=1.0, pressure=pressure, bulk_modulus=K, slope=slope
    )
    published = {
        "bulk_modulus": K + slope * pressure,
        "pressure": pressure,
        "polytropic_index": index,
    }
    exact = effective_bulk_modulus(air_content=air * shrunk, **published)
    assert found == pytest.approx(exact, rel=1e-12)
    loose = effective_bulk_modulus(air_content=air, **published)
    assert abs(found / loose - 1) <= 1.01 * abs(shrunk - 1) + 1e-12


@pytest.mark.parametrize(
    ("bar", "one", "three"),
    [(10, 577.35, 245.56), (60, 1618.36, 1346.96), (210, 1776.51, 1731.35)],
)
def test_bulk_modulus_check_values(bar, one, three):
    """K 1800 MPa, n 1.4, p_a 1.013 bar, 1 and 3 % air over the oil as compressed there."""
    for air, wanted in ((0.01, one), (0.03, three)):
        found = chamber.mixture_bulk_modulus(
            pressure=bar * 1e5,
            bulk_modulus=1800e6,
            air_content=air * math.exp(-bar * 1e5 / 1800e6),
            atmospheric_pressure=1.013e5,
        )
        assert found / 1e6 == pytest.approx(wanted, abs=6e-3)


def test_no_density_below_vacuum():
    """With air the pressure cannot pass -p_a: NaN."""
    assert np.isnan(chamber.density_ratio(pressure=-1.1e5, **oil(0.01)))


@pytest.mark.parametrize("air", [0.0, 0.002, 0.05])
def test_mass_is_kept_over_a_path_of_pressure(air):
    """dp/dt of a closed chamber, driven through a cycle, keeps the reference volume."""
    law = oil(air, slope=8.0)
    start, size, swing = 40e5, 1e-4, 2e-6 + 4e-5 * air

    def rate(t, y):
        return [
            chamber.pressure_rate(
                flow=0.0,
                volume=size + swing * math.sin(t),
                volume_rate=swing * math.cos(t),
                bulk_modulus=chamber.mixture_bulk_modulus(pressure=y[0], **law),
            )
        ]

    run = solve_ivp(rate, (0, 7), [start], method="LSODA", rtol=1e-11, atol=1e-6, max_step=0.05)
    volume = size + swing * np.sin(run.t)
    content = volume * chamber.density_ratio(pressure=run.y[0], **law)
    np.testing.assert_allclose(content, content[0], rtol=2e-8)
    assert np.ptp(run.y[0]) > 20e5


def test_inflow_at_its_own_density_fills_the_reference_volume():
    """Pressure state with q at the chamber's density, and content state with its density ratio."""
    law = oil(0.01)

    def rate(t, y):
        stiff = chamber.mixture_bulk_modulus(pressure=y[0], **law)
        flow = 3e-6 * math.cos(t)
        return [
            chamber.pressure_rate(flow=flow, volume=1e-4, volume_rate=0.0, bulk_modulus=stiff),
            flow * chamber.density_ratio(pressure=y[0], **law),
        ]

    filled = 1e-4 * chamber.density_ratio(pressure=30e5, **law)
    run = solve_ivp(rate, (0, 6), [30e5, filled], method="LSODA", rtol=1e-10, atol=[1e-3, 1e-18])
    content = 1e-4 * chamber.density_ratio(pressure=run.y[0], **law)
    np.testing.assert_allclose(content, run.y[1], rtol=1e-7)


def test_walls_soften_the_pressure_rate():
    """1/(V/K + C): 1e-4 m3 at 1 GPa gives 1e-13 m3/Pa; as much in the walls halves the rate."""
    fill = {"flow": 1e-4, "volume": 1e-4, "volume_rate": 0.0, "bulk_modulus": 1e9}
    assert chamber.pressure_rate(**fill) == pytest.approx(1e9, rel=1e-12)
    assert chamber.pressure_rate(**fill, compliance=1e-13) == pytest.approx(5e8, rel=1e-12)


STROKE = 0.16


def test_end_stop_takes_supply_force_in_its_travel():
    """[MECE5005]: K_end 0.2 mm = A_A p_P, b = 0.5 sqrt(K_end m); NaN for a negative mass."""
    stiff = end_stop.stop_stiffness(area=8e-4, pressure=140e5)
    assert stiff * 0.2e-3 == pytest.approx(8e-4 * 140e5, rel=1e-12)
    assert stiff == pytest.approx(5.6e7, rel=1e-12)
    assert end_stop.stop_damping(stiffness=4e6, mass=25.0) == pytest.approx(5000.0, rel=1e-12)
    assert math.isnan(end_stop.stop_damping(stiffness=4e6, mass=-25.0))


def struck(mass, speed, stiffness, damping, driving=0.0):
    """Motion of a mass that meets the extended stop: times of rest and of release are events."""

    def rate(t, y):
        push = end_stop.contact_force(
            compression=y[0], closing_speed=y[1], stiffness=stiffness, damping=damping
        )
        return [y[1], (driving - push) / mass]

    def at_rest(t, y):
        return y[1]

    def released(t, y):
        return y[0] * stiffness + damping * y[1] if t > 0 else 1.0

    released.terminal, released.direction = True, -1
    tolerance = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-14}
    return solve_ivp(rate, (0, 0.02), [1e-15, speed], events=[at_rest, released], **tolerance)


def test_driven_stop_reaches_the_closed_form_compression():
    """40 kg, 0.3 m/s, 6 kN, 3e7 N/m: 0.6 mm and 18 kN, from the integrated `contact_force`."""
    case = {"driving_force": 6000.0, "mass": 40.0, "velocity": 0.3}
    run = struck(40.0, 0.3, 3e7, 0.0, driving=6000.0)
    deepest = run.y_events[0][0, 0]
    assert deepest == pytest.approx(0.6e-3, rel=1e-8)
    assert deepest == pytest.approx(endurance.end_stop_compression(stiffness=3e7, **case), rel=1e-8)
    force = end_stop.contact_force(
        compression=deepest, closing_speed=0.0, stiffness=3e7, damping=0.0
    )
    assert force == pytest.approx(18e3, rel=1e-8)


SPEAR = {"length": 0.02, "open_area": 3e-5, "end_area": 1e-6}


@given(st.floats(-0.01, 0.04), st.floats(-0.01, 0.04), st.floats(0.3, 2))
def test_spear_only_closes(one, other, exponent):
    """Fully open before the cushion, least at the stop, monotone between."""
    low, high = sorted((one, other))
    near, far = (
        end_stop.cushion_flow_area(remaining=y, exponent=exponent, **SPEAR) for y in (low, high)
    )
    assert 1e-6 <= near <= far <= 3e-5 * (1 + 1e-15)
    assert end_stop.cushion_flow_area(remaining=0.03, **SPEAR) == pytest.approx(3e-5, rel=1e-15)
    assert end_stop.cushion_flow_area(remaining=0.0, **SPEAR) == 1e-6


def test_evenly_braking_cushion_keeps_its_pressure():
    """Area as the root of the travel left: with v^2 falling linearly the pressure is the mean."""
    stop = {"driving_force": 6000.0, "mass": 40.0, "velocity": 0.3, "length": 0.02, "area": 6e-4}
    mean = end_stop.cushion_mean_pressure(**stop)
    assert mean == pytest.approx((1.8 + 6000 * 0.02) / (6e-4 * 0.02), rel=1e-12)
    opened = end_stop.cushion_open_area(velocity=0.3, area=6e-4, pressure=mean, density=870.0)
    left = np.array([0.02, 0.013, 0.004, 1e-4])
    spear = end_stop.cushion_flow_area(
        remaining=left, length=0.02, open_area=opened, end_area=0.0, exponent=0.5
    )
    found = end_stop.cushion_pressure(
        speed=0.3 * np.sqrt(left / 0.02),
        area=6e-4,
        flow_area=spear,
        density=870.0,
        dynamic_viscosity=0.0,
    )
    np.testing.assert_allclose(found, mean, rtol=1e-12)
    assert math.isnan(
        end_stop.cushion_open_area(velocity=0.3, area=6e-4, pressure=0.0, density=870.0)
    )


def test_straight_cushion_peaks_above_the_mean_and_balances_its_energy():
    """Work of the pressure = kinetic energy lost + work of the driving force."""
    mass, driving, area = 40.0, 1000.0, 6e-4

    def pressure(y, v):
        hole = end_stop.cushion_flow_area(remaining=y, length=0.02, open_area=1e-5, end_area=1e-6)
        return end_stop.cushion_pressure(
            speed=v, area=area, flow_area=hole, density=870.0, dynamic_viscosity=0.04
        )

    def rate(t, y):
        load = pressure(y[0], y[1]) * area
        return [-y[1], (driving - load) / mass, load * y[1]]

    run = solve_ivp(rate, (0, 0.05), [0.02, 0.5, 0.0], method="LSODA", rtol=1e-9, atol=1e-12)
    left, speed, work = run.y[:, -1]
    lost = 0.5 * mass * (0.25 - speed**2) + driving * (0.02 - left)
    assert work == pytest.approx(lost, rel=1e-6)
    assert pressure(run.y[0], run.y[1]).max() > work / (area * (0.02 - left))
    assert 0 < speed < 0.5


def test_cushion_fills_freely():
    """Away from the stop there is no pressure drop: the port's pressure alone."""
    found = end_stop.cushion_pressure(
        speed=-0.3,
        area=6e-4,
        flow_area=4e-6,
        density=870.0,
        dynamic_viscosity=0.04,
        back_pressure=5e5,
    )
    assert found == 5e5


RADIUS = st.floats(0.02, 0.5)
ANGLE = st.floats(0.05, math.pi - 0.05)


@given(RADIUS, RADIUS, ANGLE, st.floats(-1, 1))
def test_linkage_is_that_of_the_drawn_triangle(base, pin, turned, offset):
    """Length and lever arm from coordinates: distance, and the joint's distance from the line."""
    found = linkage.linkage(
        base_radius=base, crank_radius=pin, joint_angle=turned - offset, angle_offset=offset
    )
    fixed, moving = np.array([base, 0.0]), pin * np.array([math.cos(turned), math.sin(turned)])
    line = moving - fixed
    assert found.length == pytest.approx(np.hypot(*line), rel=1e-9)
    lever = (fixed[0] * line[1] - fixed[1] * line[0]) / np.hypot(*line)
    assert found.lever_arm == pytest.approx(lever, rel=1e-7)


@given(RADIUS, RADIUS, ANGLE, st.floats(-1e4, 1e4))
def test_linkage_slopes_and_virtual_work(base, pin, turned, force):
    """Lever arm = dl/dtheta and its slope by complex step; F dl = T dtheta."""
    radii = {"base_radius": base, "crank_radius": pin}
    found = linkage.linkage(joint_angle=turned, **radii)
    stepped = linkage.linkage(joint_angle=turned + 1j * STEP, **radii)
    assert stepped.length.imag / STEP == pytest.approx(found.lever_arm, rel=1e-11)
    slope = stepped.lever_arm.imag / STEP
    assert found.lever_slope == pytest.approx(slope, rel=1e-7, abs=1e-9)
    torque = linkage.joint_torque(force=force, lever_arm=found.lever_arm)
    assert torque * STEP == pytest.approx(force * stepped.length.imag, rel=1e-11)
    back = linkage.actuator_force(torque=torque, lever_arm=found.lever_arm)
    assert back == pytest.approx(force, rel=1e-12, abs=1e-290)


@given(RADIUS, RADIUS, ANGLE, st.floats(-1, 1))
def test_joint_angle_of_a_length_inverts_the_linkage(base, pin, turned, offset):
    """Angle to length and back, and NaN outside the reach."""
    radii = {"base_radius": base, "crank_radius": pin, "angle_offset": offset}
    length = linkage.linkage(joint_angle=turned - offset, **radii).length
    found = linkage.linkage_angle(length=length, **radii)
    assert found == pytest.approx(turned - offset, abs=1e-9)
    outside = np.array([1.001 * (base + pin), 0.999 * abs(base - pin) - 1e-12])
    assert np.isnan(linkage.linkage_angle(length=outside, **radii)).all()


@given(RADIUS, RADIUS, ANGLE, st.floats(-5, 5), st.floats(-50, 50))
def test_reflected_inertia_does_the_work_of_the_joint(base, pin, turned, speed, acceleration):
    """F dl/dt = J theta' theta'' for any motion, and the factor is half dm/dl."""
    radii = {"base_radius": base, "crank_radius": pin}
    arm = linkage.linkage(joint_angle=turned, **radii)
    felt = linkage.reflected_inertia(
        inertia=0.8, lever_arm=arm.lever_arm, lever_slope=arm.lever_slope
    )
    v = arm.lever_arm * speed
    dv = arm.lever_arm * acceleration + arm.lever_slope * speed**2
    force = felt.mass * dv + felt.velocity_factor * v**2
    size = abs(felt.mass * dv * v) + abs(felt.velocity_factor * v**3)
    assert force * v == pytest.approx(0.8 * speed * acceleration, rel=1e-9, abs=1e-12 * size)
    stepped = linkage.linkage(joint_angle=turned + 1j * STEP, **radii)
    mass = 0.8 / stepped.lever_arm**2
    half = 0.5 * mass.imag / stepped.length.imag
    assert felt.velocity_factor == pytest.approx(half, rel=1e-7, abs=1e-7 * felt.mass)


def test_dead_points_are_infinite_not_nan():
    """Lever arm 0: infinite force and mass with the right sign, no force without torque."""
    dead = linkage.linkage(base_radius=0.3, crank_radius=0.04, joint_angle=0.0)
    assert dead.length == pytest.approx(0.26, rel=1e-12)
    assert dead.lever_arm == 0
    assert dead.lever_slope == pytest.approx(0.3 * 0.04 / 0.26, rel=1e-12)
    felt = linkage.reflected_inertia(
        inertia=0.8, lever_arm=np.zeros(3), lever_slope=np.array([0.01, -0.01, 0.0])
    )
    np.testing.assert_array_equal(felt.mass, np.inf)
    np.testing.assert_array_equal(felt.velocity_factor, [-np.inf, np.inf, 0])
    pushed = linkage.actuator_force(torque=np.array([5.0, -5.0, 0.0]), lever_arm=np.zeros(3))
    np.testing.assert_array_equal(pushed, [np.inf, -np.inf, 0])
    assert linkage.joint_torque(force=3e3, lever_arm=dead.lever_arm) == 0
