"""Claims about Wilson's motor and pump, the relief valve and the pressure-controlled pump."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from actuator_opt.models import supply, wilson

# [MECE5005], motor, pipes and load: "very preliminary parameter values"
VOLUME = 13.3e-6
SLIP = {"slip_coefficient": 150e-9}
FRICTION = {"coulomb_coefficient": 0.16, "viscous_coefficient": 100e3, "constant_torque": 0.1}
FREE = {"coulomb_coefficient": 0.0, "viscous_coefficient": 0.0, "constant_torque": 0.0}
OIL = 32e-6 * 870


def both_signs(least, largest):
    """0, or a size from `least` to `largest` of either sign."""
    size = st.floats(least, largest)
    return st.just(0.0) | size | size.map(lambda value: -value)


SPEEDS = both_signs(1e-6, 300)
PRESSURES = both_signs(1.0, 4e7)
VISCOSITIES = st.floats(0.005, 0.5)
SETTINGS = both_signs(1e-3, 1)


def machine(kind, speed, pressure_difference, viscosity=OIL, setting=1.0, loss=FRICTION, slip=SLIP):
    """Flow and torque of the slides' motor or pump."""
    shaft = {
        "speed": speed, "pressure_difference": pressure_difference, "displacement": VOLUME,
        "setting": setting,
    }  # fmt: skip
    flow, torque = {
        "motor": (wilson.motor_flow, wilson.motor_torque),
        "pump": (wilson.pump_flow, wilson.pump_torque),
    }[kind]
    q = flow(**shaft, dynamic_viscosity=viscosity, **slip)
    t = torque(**shaft, dynamic_viscosity=viscosity, **loss)
    return q, t


def efficiencies(kind, speed, pressure_difference, **condition):
    """Volumetric and hydromechanical: V w/(2 pi q) and 2 pi T/(V dp); of a pump their inverse."""
    flow, torque = machine(kind, speed, pressure_difference, **condition)
    radian = VOLUME / (2 * math.pi)
    found = radian * speed / flow, torque / (radian * pressure_difference)
    return found if kind == "motor" else tuple(1 / x for x in found)


def rpm(value):
    """Shaft speed in rad/s."""
    return value * 2 * math.pi / 60


def test_motor_at_1000_rpm_and_100_bar():
    """Slide constants, nu 32e-6, rho 870: 20.14 l/min, 17.06 N m, eta_v 0.660, eta_hm 0.806."""
    flow, torque = machine("motor", rpm(1000), 100e5)
    assert flow * 60000 == pytest.approx(20.14, abs=5e-3)
    assert torque == pytest.approx(17.06, abs=5e-3)
    found = efficiencies("motor", rpm(1000), 100e5)
    assert found == pytest.approx((0.660, 0.806), abs=5e-4)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("motor", (14.72196, 24.26696, 0.542047, 0.818871)),
        ("pump", (1.238042, 35.00234, 0.155143, 0.846648)),
    ],
)
def test_machines_at_600_rpm_and_140_bar(kind, expected):
    """Flow (l/min), torque (N m), eta_v and eta_hm at nu 46e-6, rho 860: independent values."""
    point = {"speed": rpm(600), "pressure_difference": 140e5, "viscosity": 46e-6 * 860}
    flow, torque = machine(kind, **point)
    found = (flow * 60000, torque, *efficiencies(kind, **point))
    assert found == pytest.approx(expected, rel=1e-6)


@given(st.sampled_from(["motor", "pump"]), SPEEDS, PRESSURES, SETTINGS)
def test_without_losses_a_machine_is_ideal(kind, speed, pressure, setting):
    """Flow eps V n, torque eps V dp/2 pi, all of the power passes."""
    flow, torque = machine(
        kind, speed, pressure, setting=setting, loss=FREE, slip={"slip_coefficient": 0.0}
    )
    assert flow == pytest.approx(setting * VOLUME * speed / (2 * math.pi), rel=1e-12)
    assert torque == pytest.approx(setting * VOLUME * pressure / (2 * math.pi), rel=1e-12)
    assert flow * pressure == pytest.approx(torque * speed, rel=1e-12)


@given(SPEEDS, PRESSURES, VISCOSITIES, SETTINGS)
def test_power_lost_is_slip_and_friction(speed, pressure, viscosity, setting):
    """In minus out is C_s V_r dp2/mu + |w| tanh|w/w0| (C_f V_r |dp| + T_c) + C_v mu V_r w2."""
    radian = VOLUME / (2 * math.pi)
    coulomb = 0.16 * radian * abs(pressure) + 0.1
    lost = (
        150e-9 * radian * pressure**2 / viscosity
        + abs(speed) * math.tanh(abs(speed) / 0.5) * coulomb
        + 100e3 * viscosity * radian * speed**2
    )
    passed = abs(setting * radian * pressure * speed)
    for kind, sign in (("motor", 1), ("pump", -1)):
        flow, torque = machine(kind, speed, pressure, viscosity, setting)
        surplus = sign * (flow * pressure - torque * speed)
        assert surplus == pytest.approx(lost, rel=1e-9, abs=1e-12 * passed + 1e-300)


@given(st.sampled_from(["motor", "pump"]), SPEEDS, PRESSURES, VISCOSITIES, SETTINGS)
def test_power_out_is_never_more_than_power_in(kind, speed, pressure, viscosity, setting):
    """In all four quadrants and at any setting, but for the rounding of the two powers."""
    flow, torque = machine(kind, speed, pressure, viscosity, setting)
    hydraulic, shaft = flow * pressure, torque * speed
    taken = hydraulic - shaft if kind == "motor" else shaft - hydraulic
    assert taken >= -1e-14 * (abs(hydraulic) + abs(shaft))


@given(SPEEDS, PRESSURES, VISCOSITIES, SETTINGS)
def test_pump_and_motor_are_one_machine(speed, pressure, viscosity, setting):
    """A pump against dp is the motor at -dp with the torque reversed; both are odd as a whole."""
    q, t = machine("pump", speed, pressure, viscosity, setting)
    assert (q, -t) == machine("motor", speed, -pressure, viscosity, setting)
    back = machine("pump", -speed, -pressure, viscosity, setting)
    assert (-q, -t) == pytest.approx(back, rel=1e-12)


@given(
    st.sampled_from(["motor", "pump"]), st.floats(60, 300), st.floats(1e6, 4e7),
    st.floats(0.2, 5), st.floats(0.2, 5),
)  # fmt: skip
def test_efficiency_depends_on_wilsons_number_alone(kind, speed, pressure, faster, thinner):
    """Without T_c, at full setting and well above w_0, only mu w/dp counts."""
    loss = {**FRICTION, "constant_torque": 0.0}
    number = OIL * speed / pressure
    spill, drag = 150e-9 / number, 0.16 + 100e3 * number
    curves = {"motor": (1 / (1 + spill), 1 - drag), "pump": (1 - spill, 1 / (1 + drag))}
    assume(min(curves[kind]) > 0.01)
    loaded = pressure * faster / thinner
    for s, p, oil in ((speed, pressure, OIL), (speed * faster, loaded, OIL / thinner)):
        found = efficiencies(kind, s, p, viscosity=oil, loss=loss)
        assert found == pytest.approx(curves[kind], rel=1e-9)


def test_stalled_motor():
    """At rest the whole flow is slip, and the torque is the ideal."""
    flow, torque = machine("motor", 0.0, 1e7)
    radian = VOLUME / (2 * math.pi)
    assert flow == pytest.approx(150e-9 * radian * 1e7 / OIL)
    assert torque == pytest.approx(radian * 1e7)


@pytest.mark.parametrize(("kind", "sign"), [("motor", -1), ("pump", 1)])
def test_friction_is_smooth_through_rest(kind, sign):
    """Complex step: dT/dw = -+((C_f V_r |dp| + T_c)/w0 + C_v mu V_r) at rest, viscous far away."""
    radian = VOLUME / (2 * math.pi)
    viscous = 100e3 * OIL * radian
    for speed, steep in ((0.0, (0.16 * radian * 2e7 + 0.1) / 0.5), (200.0, 0.0), (-200.0, 0.0)):
        torque = machine(kind, speed + 1e-30j, -2e7)[1]
        assert torque.imag / 1e-30 == pytest.approx(sign * (viscous + steep), rel=1e-12)


RELIEF = {"cracking_pressure": 140e5, "override": 10e5, "rated_flow": 40 / 60000}


def test_relief_valve_at_its_points():
    """Nothing to 140 bar, 40 l/min at 150; half open at 145: 20 sqrt(145/150); full: 40 sqrt 2."""
    pressure = np.array([-10e5, 0.0, 139e5, 140e5, 145e5, 150e5, 300e5])
    flow = supply.relief_flow(pressure_difference=pressure, **RELIEF) * 60000
    half, full = 20 * math.sqrt(145 / 150), 40 * math.sqrt(2)
    np.testing.assert_allclose(flow, [0, 0, 0, 0, half, 40, full], rtol=1e-12)
    assert math.isnan(supply.relief_flow(pressure_difference=145e5, **{**RELIEF, "override": 0.0}))


@given(st.floats(-1e7, 4e7), st.floats(0, 1e7))
def test_relief_valve_never_passes_less_for_more_pressure(pressure, rise):
    """The flow rises with the pressure, never runs back, and only takes power from the oil."""
    low = supply.relief_flow(pressure_difference=pressure, **RELIEF)
    high = supply.relief_flow(pressure_difference=pressure + rise, **RELIEF)
    assert 0 <= low <= high * (1 + 1e-14)
    assert low * pressure >= 0


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_relief_valve_sets_the_pressure_of_a_fixed_pump(share):
    """The pressure that passes a surplus q is s2, s3 - p_c s = dp_o q/q_r sqrt(p_c + dp_o)."""
    roots = np.roots([1.0, 0.0, -140e5, -10e5 * share * math.sqrt(150e5)])
    pressure = max(root.real for root in roots) ** 2
    flow = supply.relief_flow(pressure_difference=pressure, **RELIEF)
    assert flow == pytest.approx(share * 40 / 60000, rel=1e-9)


PUMP = {"set_pressure": 140e5, "gain": 40 / 60000 / 5e5, "time_constant": 0.02}
LARGEST = 40 / 60000


@given(st.floats(0, LARGEST))
def test_controlled_pump_rests_on_its_droop(flow):
    """A steady flow q stands at p_set - q/K_p: here full flow 5 bar below the setting."""
    pressure = 140e5 - flow / LARGEST * 5e5
    rate = supply.controlled_pump_rate(flow=flow, pressure=pressure, **PUMP)
    assert abs(rate) <= 1e-9 * LARGEST / 0.02
    assert supply.controlled_pump_delivery(flow=flow, largest_flow=LARGEST) == flow


def test_controlled_pump_stays_between_its_ends():
    """No delivery below 0 or above the largest flow; a time constant of 0 has no rate."""
    flows = np.array([-1e-3, 0.0, 3e-4, LARGEST, 2e-3])
    delivered = supply.controlled_pump_delivery(flow=flows, largest_flow=LARGEST)
    assert delivered.tolist() == [0.0, 0.0, 3e-4, LARGEST, LARGEST]
    still = {**PUMP, "time_constant": 0.0}
    assert math.isnan(supply.controlled_pump_rate(flow=0.0, pressure=0.0, **still))


def test_controlled_pump_on_a_supply_line_swings_as_the_second_order_system_it_is():
    """After a step of demand 10 -> 20 l/min: c tau p'' + c p' + K_p p = K_p p_set - q, c = V/K."""
    compliance, start, demand = 2e-3 / 1.4e9, 10 / 60000, 20 / 60000
    gain, lag = PUMP["gain"], PUMP["time_constant"]

    def slope(state):
        flow, pressure = state
        delivered = supply.controlled_pump_delivery(flow=flow, largest_flow=LARGEST)
        rate = supply.controlled_pump_rate(flow=flow, pressure=pressure, **PUMP)
        return np.array([rate, (delivered - demand) / compliance])

    state, step = np.array([start, 140e5 - start / gain]), 2e-5
    first = state[1]
    for _ in range(1000):
        one = slope(state)
        two = slope(state + 0.5 * step * one)
        three = slope(state + 0.5 * step * two)
        state = state + step / 6 * (one + 2 * two + 2 * three + slope(state + step * three))
    end, decay = 140e5 - demand / gain, 0.5 / lag
    swing = math.sqrt(gain / (compliance * lag) - decay**2)
    offset, speed = first - end, (start - demand) / compliance
    time = 1000 * step
    wave = offset * math.cos(swing * time) + (speed + decay * offset) / swing * math.sin(
        swing * time
    )
    assert state[1] == pytest.approx(end + math.exp(-decay * time) * wave, rel=1e-9)
