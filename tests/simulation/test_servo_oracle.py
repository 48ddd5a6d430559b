"""The servo oracle against published check values and closed forms of its own."""

from dataclasses import replace
from math import exp, pi, sqrt

import numpy as np
import pytest
import servo_oracle as oracle
import servo_oracle_parts as parts
from scipy.linalg import expm
from servo_oracle import Circuit, simulate
from servo_oracle_parts import line, sine, steps

BAR = 1e5
LITRE = 1 / 60000  # l/min in m^3/s
FULL, LEAK = 40 * LITRE / sqrt(35 * BAR), 0.45 * LITRE / sqrt(50 * BAR)
AREA_A, AREA_B = pi * 0.032**2 / 4, pi * (0.032**2 - 0.018**2) / 4

VALVE = parts.Valve(full=FULL, leakage=(LEAK,) * 4, spool_frequency=2 * pi * 250)
SHUT = replace(VALVE, leakage=(0.0,) * 4)
CYLINDER = parts.Cylinder(AREA_A, AREA_B, 0.16, 8e-6, 8e-6, mass=30.0, viscous=400.0)
STUCK = replace(CYLINDER, mass=1e15)
BALANCE = steps((0.0, 70 * BAR * (AREA_A - AREA_B)))
MIDDLE = {"position": 0.08, "p_a": 70 * BAR, "p_b": 70 * BAR}
CLOSED = steps((0.0, 0.0))
SERVO = Circuit(parts.Oil(1.4e9), VALVE, CYLINDER, parts.ConstantSupply(140 * BAR), CLOSED, BALANCE)
FORTRAN = {"method": "LSODA", "rtol": 1e-10}  # quick where Radau is not the point

V_R = 13.3e-6 / (2 * pi)
MOTOR = parts.Motor(V_R, 3.3e-3 + 10e-3, 1e-4, 150e-9, 0.16, 100e3, 0.1, viscosity=32e-6 * 870)


def point(circuit, start):
    """Everything at one instant from named states."""
    inputs = circuit.reference.piece(0.0), circuit.load.piece(0.0)
    return circuit.evaluate(0.0, oracle.start_state(circuit, start), inputs, oracle.Mode())


def unaccounted(run, circuit):
    """Largest energy that the balance of a run does not explain, over the energy supplied."""
    i = run.integrals
    used = sum(i[n] for n in oracle.INTEGRALS[2:12]) + i["return"]
    kinetic = 0.5 * circuit.actuator.mass * run.signals["velocity"] ** 2
    missing = i["supply"] - used - (kinetic - kinetic[0])
    pump = i["pump"] - i["supply"] - i["relief"] - i["line"]
    return max(abs(missing).max(), abs(pump).max()) / i["supply"][-1]


@pytest.mark.parametrize(
    ("volts", "ps", "pa", "pb", "flows", "digits"),
    [
        (6, 140, 90, 60, (28.2617, -31.0513, 29.4347, 32.2243), 5e-5),
        (-3, 140, 90, 60, (-19.2154, 18.0478, 18.9907, 20.1584), 5e-5),
        (10, 70, 35, 35, (39.62, -39.62, 40.38, 40.38), 6e-3),
        (-10, 70, 35, 35, (-39.62, 39.62, 40.38, 40.38), 6e-3),
    ],
)
def test_valve_flows_are_the_check_values(volts, ps, pa, pb, flows, digits):
    """The four edges give q_A, q_B, q_P, q_T of the check list, in l/min."""
    circuit = replace(SERVO, supply=parts.ConstantSupply(ps * BAR))
    found = point(circuit, {"spool": volts, "p_a": pa * BAR, "p_b": pb * BAR}).signals
    for name, value in zip(("q_a", "q_b", "q_p", "q_t"), flows, strict=True):
        assert found[name] / LITRE == pytest.approx(value, abs=digits)


@pytest.mark.parametrize(("drop_in", "drop_out", "rest"), [(50, 50, 50), (60, 40, 40)])
def test_blocked_ports_come_to_rest_between_the_leakages(drop_in, drop_out, rest):
    """At 0 V and 100 bar the leakages divide the pressure and pass 0.9 l/min in all."""
    into, out = (0.45 * LITRE / sqrt(drop * BAR) for drop in (drop_in, drop_out))
    valve = replace(VALVE, leakage=(into, out, into, out))
    blocked = replace(
        SERVO, valve=valve, actuator=STUCK, supply=parts.ConstantSupply(100 * BAR), load=CLOSED
    )
    run = simulate(blocked, [0.0, 3.0], {"position": 0.08}, **FORTRAN)
    assert run.signals["p_a"][-1] == pytest.approx(rest * BAR, rel=3e-6)
    assert run.signals["p_b"][-1] == pytest.approx(rest * BAR, rel=3e-6)
    assert run.signals["q_p"][-1] == pytest.approx(0.9 * LITRE, rel=3e-6)


@pytest.mark.parametrize(("p", "expected"), [(10, 577.35), (60, 1618.36), (210, 1776.51)])
def test_aerated_modulus(p, expected):
    """It is the slope of the density, and the check value but for the oil's own shrinkage."""
    oil, p = parts.Oil(1.8e9, air=0.01), p * BAR
    slope = (oil.density_ratio(p + 10) - oil.density_ratio(p - 10)) / 20
    assert oil.modulus(p) == pytest.approx(oil.density_ratio(p) / slope, rel=1e-7)
    assert oil.modulus(p) / 1e6 == pytest.approx(expected, rel=5e-4)


def test_sealed_chambers_hold_their_oil_and_air():
    """A sealed piston thrown at 20 mm/s: each volume stays that of its own oil and air."""
    circuit = replace(SERVO, oil=parts.Oil(1.4e9, air=0.01), valve=SHUT, load=CLOSED)
    start = {"position": 0.08, "velocity": 0.02, "p_a": 5 * BAR, "p_b": 5 * BAR * AREA_A / AREA_B}
    run = simulate(circuit, np.linspace(0, 0.03, 61), start)

    def volume_of_unit_mass(p):
        return np.exp(-p / 1.4e9) + 0.01 * (1.013e5 / (p + 1.013e5)) ** (1 / 1.4)

    x, p_a, p_b = (run.signals[name] for name in ("position", "p_a", "p_b"))
    for volume, p in ((8e-6 + AREA_A * x, p_a), (8e-6 + AREA_B * (0.16 - x), p_b)):
        assert volume / volume[0] == pytest.approx(
            volume_of_unit_mass(p) / volume_of_unit_mass(p[0]), rel=1e-9
        )
    assert np.ptp(p_a) > 2 * BAR


def test_air_keeps_an_emptied_chamber_above_vacuum():
    """A piston torn out of a sealed chamber leaves an absolute pressure above zero."""
    circuit = replace(SERVO, oil=parts.Oil(1.4e9, air=0.005), valve=SHUT, load=steps((0.0, -2e4)))
    run = simulate(circuit, np.linspace(0, 0.05, 51), MIDDLE | {"p_a": 1e5, "p_b": 1e5})
    assert -1.013e5 < run.signals["p_a"].min() < -0.9e5


def test_bristles_at_constant_speed_are_the_check_values():
    """LuGre at 20 mm/s from rest: z in um and F in N after 0.1, 1 and 10 ms."""
    friction = parts.LuGre(1000.0, 500.0, 0.02, sigma0=1e7, sigma1=3e4)
    heavy = replace(STUCK, viscous=1000.0, friction=friction)
    circuit = replace(SERVO, actuator=heavy, load=CLOSED)
    run = simulate(circuit, [0, 1e-4, 1e-3, 1e-2], {"position": 0.08, "velocity": 0.02})
    assert run.signals["bristle"][1:] * 1e6 == pytest.approx([1.97104, 17.3411, 64.7208], rel=3e-6)
    assert run.signals["friction"][1:] == pytest.approx([622.419, 641.283, 699.432], rel=1e-6)


@pytest.mark.parametrize("end", ["cap", "rod"])
def test_elastic_stop_is_the_check_value(end):
    """40 kg at 0.3 m/s driven by 6 kN into 30 MN/m: 0.6 mm, 18 kN, 1.8 J back at the rebound."""
    away = -1 if end == "cap" else 1
    # almost no area: the oil has no say
    body = parts.Cylinder(1e-15, 1e-15, 0.16, 1e-4, 1e-4, 40.0, stop_stiffness=3e7)
    circuit = replace(SERVO, valve=SHUT, actuator=body, load=steps((0.0, -away * 6000.0)))
    start = {"position": 0.0 if away < 0 else 0.16, "velocity": away * 0.3}
    run = simulate(circuit, np.linspace(0, 0.006, 2001), start)
    depth = (away * (run.signals["position"] - start["position"])).max()
    assert depth == pytest.approx(0.6e-3, rel=1e-5)
    assert abs(run.signals["stop"]).max() == pytest.approx(18e3, rel=1e-5)
    assert abs(run.integrals["stop"][-1]) < 1e-6


def test_damped_stop_never_pulls():
    """A damped stop lets go before the piston is back at the end, and its force has one sign."""
    body = replace(
        CYLINDER, area_a=1e-15, area_b=1e-15, viscous=0.0, stop_stiffness=3e7, stop_damping=2e4
    )
    circuit = replace(SERVO, valve=SHUT, actuator=body, load=CLOSED)
    run = simulate(circuit, np.linspace(0, 0.01, 1001), {"position": 1e-4, "velocity": -0.3})
    assert [mode.cap for _, mode in run.events] == [True, False]
    assert run.signals["stop"].min() == 0
    (touch, _), (leave, _) = run.events
    assert touch == pytest.approx(1e-4 / 0.3, rel=1e-6)
    # 30 x'' = -3e7 x - 2e4 x' from x = 0, until 3e7 x + 2e4 x' = 0
    rate, swing, gone = 2e4 / 60, sqrt(3e7 / 30 - (2e4 / 60) ** 2), leave - touch
    decay, turned, share = exp(-rate * gone), swing * gone, rate / swing
    position = -0.3 / swing * decay * np.sin(turned)
    velocity = -0.3 * decay * (np.cos(turned) - share * np.sin(turned))
    assert 3e7 * position + 2e4 * velocity == pytest.approx(0, abs=1e-2)
    assert run.signals["velocity"][-1] == pytest.approx(velocity, rel=1e-6)


@pytest.mark.parametrize(
    ("volts", "v", "p_a", "p_b"),
    [(3.0, 0.393606, 51.942, 43.109), (-3.0, -0.381055, 82.856, 99.424)],
)
def test_steady_speed_is_the_check_value(volts, v, p_a, p_b):
    """A long stroke at constant command settles on the three-equation solution."""
    friction = parts.LuGre(200.0, 150.0, 0.01, sigma0=1e6, sigma1=5e3)
    long = replace(CYLINDER, stroke=1.0, friction=friction)
    circuit = replace(
        SERVO, actuator=long, reference=steps((0.0, volts)), load=steps((0.0, 1500.0))
    )
    run = simulate(circuit, [0, 0.8], {"position": 0.1 if v > 0 else 0.9}, **FORTRAN)
    assert run.signals["velocity"][-1] == pytest.approx(v, rel=2e-6)
    assert run.signals["p_a"][-1] / BAR == pytest.approx(p_a, abs=6e-4)
    assert run.signals["p_b"][-1] / BAR == pytest.approx(p_b, abs=6e-4)


def test_sealed_cylinder_has_the_check_stiffness():
    """Dynamic stiffness with closed lines: 20.5399 and 18.7636 MN/m at 10 and 40 Hz."""
    circuit = replace(SERVO, valve=SHUT)
    names = ("position", "velocity", "p_a", "p_b")
    matrix, _ = oracle.linearise(circuit, MIDDLE, 1.0, names)
    for frequency, size, phase in ((10, 20.5399, 0.070), (40, 18.7636, 0.307)):
        push = np.array([0, 1 / 30, 0, 0])
        answer = np.linalg.solve(2j * pi * frequency * np.eye(4) - matrix, push)
        assert 1e-6 / abs(answer[0]) == pytest.approx(size, rel=3e-5)
        assert -np.degrees(np.angle(answer[0])) == pytest.approx(phase, abs=6e-4)


def test_natural_frequency_and_damping_are_the_check_values():
    """32/18-160 at 80 mm with the centred valve: 132.071 Hz, damping 0.008034 + 0.017064."""
    matrix, _ = oracle.linearise(SERVO, MIDDLE, 1.0, ("velocity", "p_a", "p_b"))
    root = max(np.linalg.eigvals(matrix), key=lambda value: value.imag)
    assert abs(root) / (2 * pi) == pytest.approx(132.071, rel=1e-3)
    assert -root.real / abs(root) == pytest.approx(0.008034 + 0.017064, rel=2e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("spool", "gain", "period"), [(250, 416.743, 7.7584), (400, 333.220, 7.6671)]
)
def test_ultimate_gain_is_the_check_value(side, spool, gain, period):
    """K_u in V/m and T_u in ms; here both directions agree, all drops being equal."""
    circuit = replace(SERVO, valve=replace(VALVE, spool_frequency=2 * pi * spool))
    found = oracle.ultimate_gain_by_swinging(circuit, MIDDLE, side)
    assert found == (pytest.approx(gain, rel=2e-6), pytest.approx(period * 1e-3, rel=1e-5))


@pytest.mark.long
def test_the_loop_swings_at_its_ultimate_gain():
    """A kick of a micrometre decays below K_u, grows above it and swings with T_u on it."""
    size = {}
    for share in (0.97, 1.0, 1.03):
        circuit = replace(
            SERVO, reference=steps((0.0, 0.08)), controller=parts.Controller(416.743 * share)
        )
        times = np.linspace(0, 0.5, 10001)
        run = simulate(circuit, times, MIDDLE | {"position": 0.08 + 1e-6}, **FORTRAN)
        swing = run.signals["position"]
        early, late = (swing[(times > a) & (times < a + 0.05)] for a in (0.25, 0.45))
        size[share] = np.ptp(late) / np.ptp(early)
        if share == 1.0:
            part = swing[times > 0.25] - swing[times > 0.25].mean()
            rising = np.flatnonzero((part[:-1] < 0) & (part[1:] >= 0)) + 1
            exact = [i - part[i] / (part[i] - part[i - 1]) for i in rising]
            assert np.mean(np.diff(exact)) * 5e-5 == pytest.approx(7.7584e-3, rel=1e-5)
    assert size[1.0] == pytest.approx(1, abs=0.002)
    assert size[0.97] < 0.9 < 1.1 < size[1.03]


@pytest.mark.parametrize(
    ("viscosity", "rpm", "bar", "flow", "torque", "digits"),
    [
        (46e-6 * 860, 600, 140, 14.72196, 24.26696, 1e-6),
        (32e-6 * 870, 1000, 100, 20.14, 17.06, 3e-4),
    ],
)
def test_wilson_motor_is_the_check_value(viscosity, rpm, bar, flow, torque, digits):
    """Flow through and torque of the motor at a speed and a pressure drop."""
    motor, w = replace(MOTOR, viscosity=viscosity), rpm * 2 * pi / 60
    through = motor.area_a * w + motor.leakage * bar * BAR
    assert through / LITRE == pytest.approx(flow, rel=digits)
    circuit = replace(SERVO, actuator=motor, load=CLOSED)
    now = point(circuit, {"velocity": w, "p_a": (bar + 5) * BAR, "p_b": 5 * BAR})
    assert now.signals["acceleration"] * motor.mass == pytest.approx(torque, rel=digits)
    rate = dict(zip(oracle.STATES, now.rates, strict=False))["p_a"]
    assert now.signals["q_a"] - rate * 1e-4 / 1.4e9 == pytest.approx(through, rel=1e-9)


def test_motor_between_sealed_pipes_swings_at_its_frequency():
    """Without losses f = sqrt(2 K V_r^2 / (V_p I)) / 2 pi."""
    circuit = replace(SERVO, valve=SHUT, actuator=parts.Motor(V_R, 13.3e-3, 1e-4))
    matrix, _ = oracle.linearise(circuit, MIDDLE, 1.0, ("velocity", "p_a", "p_b"))
    fastest = abs(np.linalg.eigvals(matrix)).max()
    assert fastest == pytest.approx(sqrt(2 * 1.4e9 * V_R**2 / (1e-4 * 13.3e-3)), rel=1e-6)


def test_speed_loop_holds_the_speed_against_a_torque():
    """PI on speed: the reference is reached, Wilson's torque carries the load, energy balances."""
    circuit = replace(
        SERVO,
        actuator=MOTOR,
        reference=steps((0.0, 30.0), (0.3, 60.0)),
        load=steps((0.0, 8.0)),
        controller=parts.Controller(0.02, ki=1.0, of="velocity"),
    )
    start = {"p_a": 75 * BAR, "p_b": 65 * BAR}
    run = simulate(circuit, np.linspace(0, 4, 41), start, **FORTRAN)
    speed, drop = run.signals["velocity"][-1], run.signals["p_a"][-1] - run.signals["p_b"][-1]
    assert speed == pytest.approx(60.0, rel=1e-6)
    torque = V_R * drop - (0.16 * V_R * drop + 0.1) - 1e5 * 32e-6 * 870 * V_R * speed
    assert torque == pytest.approx(8.0, rel=1e-6)
    assert unaccounted(run, circuit) < 1e-8


def test_controlled_pump_follows_its_linear_form_until_its_flow_is_full():
    """Into a blocked line: matrix exponential within the range, a straight rise at full flow."""
    pump = parts.ControlledPump(0.02, 1e-11, 100 * BAR, 1e-3, 1e-3, 1.4e9, pressure=95 * BAR)
    blocked = replace(SERVO, supply=pump, valve=SHUT, actuator=STUCK, load=CLOSED)
    start = {"position": 0.08, "pump_flow": 4e-5}
    times = np.linspace(0, 0.01, 5)
    run = simulate(blocked, times, start)
    matrix = np.array([[0, 1.4e9 / 1e-3], [-1e-11 / 0.02, -1 / 0.02]])
    for time, p, q in zip(times, run.signals["p_supply"], run.signals["pump_flow"], strict=True):
        gap, flow = expm(matrix * time) @ [-5 * BAR, 4e-5]
        assert (p, q) == (pytest.approx(100 * BAR + gap, rel=1e-8), pytest.approx(flow, rel=1e-7))
    small = replace(blocked, supply=replace(pump, largest_flow=1e-5))
    run = simulate(small, times, start)
    assert run.signals["pump_flow"].min() > 1e-5
    assert run.signals["p_supply"] == pytest.approx(
        95 * BAR + 1.4e9 / 1e-3 * 1e-5 * times, rel=1e-9
    )


def test_fixed_pump_rests_on_its_relief_valve():
    """Into a blocked line: straight to the relief pressure, then an exponential above it."""
    pump = parts.FixedPump(2e-4, 100 * BAR, 4e-10, 1e-3, 1.4e9, pressure=86 * BAR)
    blocked = replace(SERVO, supply=pump, valve=SHUT, actuator=STUCK, load=CLOSED)
    times = np.linspace(0, 0.02, 9)
    run = simulate(blocked, times, {"position": 0.08})
    late = np.maximum(times - 14 * BAR / (2e-4 * 1.4e12), 0)
    climb = 86 * BAR + 2e-4 * 1.4e12 * np.minimum(times, 0.005)
    above = 2e-4 / 4e-10 * (1 - np.exp(-late * 4e-10 * 1.4e12))
    assert run.signals["p_supply"] == pytest.approx(climb + above, rel=1e-7)


def stuck_loop(controller, reference, times, **start):
    """Run a controller on a piston that cannot move, at 80 mm."""
    circuit = replace(
        SERVO, actuator=STUCK, reference=reference, load=CLOSED, controller=controller
    )
    return simulate(circuit, times, {"position": 0.08} | start)


def test_integral_waits_while_the_command_is_on_its_limit():
    """On a constant error the integral stops at the limit, and unwinds at once afterwards."""
    reference = steps((0.0, 0.09), (0.6, 0.075))
    run = stuck_loop(parts.Controller(500.0, ki=2000.0), reference, [0.1, 0.25, 0.5, 0.6, 0.7])
    # 500 e + 2000 e t reaches 10 V at 0.25 s with e = 10 mm
    assert run.signals["integral"] == pytest.approx([1e-3, 2.5e-3, 2.5e-3, 2.5e-3, 2e-3], rel=1e-6)
    assert run.signals["command"][[0, 1, 2]] == pytest.approx([7, 10, 10], rel=1e-6)
    assert run.signals["command"][4] == pytest.approx(500 * -0.005 + 2000 * 2e-3, rel=1e-6)


@pytest.mark.parametrize("sign", [1, -1])
def test_command_slides_on_its_limit_between_hold_and_run(sign):
    """A falling error keeps the command on 10 V: the integral makes up for what P loses."""
    # e = 10 mm - 10 mm/s t; sliding begins where 500 e + 2000 int e = 10 V, ends at 20 e = 100 mm/s
    error = parts.Signal((0.0,), (line(0.08 + sign * 0.01, -sign * 0.01),))
    times = [0.2, 0.5, 0.7, 0.74, 0.9]
    run = stuck_loop(parts.Controller(500.0, ki=2000.0), error, times)
    e = 0.01 - 0.01 * np.array(times)
    begin = (15 - sqrt(15**2 - 4 * 10 * 5)) / 20  # 5 - 5t + 20t - 10t^2 = 10
    end = 0.75  # 2000 e = 500 * 0.01
    assert [time for time, _ in run.events] == pytest.approx([begin, end], abs=1e-6)
    slid = (10 - 500 * e) / 2000
    after = (10 - 500 * 0.0025) / 2000 + (0.01 * 0.15 - 0.005 * (0.9**2 - 0.75**2))
    early = 0.01 * 0.2 - 0.005 * 0.2**2
    assert sign * run.signals["integral"] == pytest.approx([early, *slid[1:4], after], rel=1e-6)
    assert sign * run.signals["command"][1:4] == pytest.approx(10, rel=1e-8)


def test_derivative_acts_on_the_filtered_error():
    """A step of the reference gives kd e/T_f exp(-t/T_f); a ramp gives kd times its rate."""
    times = 0.01 + np.array([0.0005, 0.001, 0.003])
    run = stuck_loop(
        parts.Controller(100.0, kd=0.2, filter_time=1e-3), steps((0, 0.08), (0.01, 0.09)), times
    )
    kick = 0.2 * 0.01 / 1e-3 * np.exp(-(times - 0.01) / 1e-3)
    assert run.signals["command"] == pytest.approx(1 + kick, rel=1e-7)
    ramp = parts.Signal((0.0,), (line(0.08, 0.05),))
    run = stuck_loop(parts.Controller(100.0, kd=0.2), ramp, [0.05])
    assert run.signals["command"][0] == pytest.approx(100 * 0.0025 + 0.2 * 0.05, rel=1e-9)


ROUGH = replace(
    SERVO,
    oil=parts.Oil(1.4e9, air=0.005),
    valve=replace(VALVE, leakage=(LEAK, 1.3 * LEAK, 0.8 * LEAK, LEAK)),
    actuator=replace(
        CYLINDER,
        leakage=1e-13,
        friction=parts.LuGre(200.0, 150.0, 0.01, sigma0=1e6, sigma1=5e3),
        stop_stiffness=5e7,
        stop_damping=2e4,
    ),
    reference=steps((0.0, 0.08), (0.02, 0.15), (0.25, 0.17), (0.4, 0.1)),
    load=parts.Signal((0.0, 0.1), (line(1500.0), sine(1500.0, 800.0, 12.0))),
    controller=parts.Controller(150.0, ki=800.0, kd=0.3),
    return_pressure=3 * BAR,
)


@pytest.mark.parametrize(
    "supply",
    [
        parts.ConstantSupply(140 * BAR),
        parts.FixedPump(40 * LITRE, 135 * BAR, 2e-10, 1e-3, 1.4e9, pressure=140 * BAR),
        parts.ControlledPump(0.02, 1e-9, 140 * BAR, 40 * LITRE, 1e-3, 1.4e9, pressure=140 * BAR),
    ],
    ids=["constant", "fixed", "controlled"],
)
@pytest.mark.long
def test_rough_run_balances_and_two_integrators_agree(supply):
    """Air, leakage, bristles, a stop, a full command: mass and energy close, Radau is LSODA."""
    circuit = replace(ROUGH, supply=supply)
    times = np.linspace(0, 0.6, 301)
    start = {"position": 0.08, "p_a": 50 * BAR, "p_b": 50 * BAR}
    run, other = simulate(circuit, times, start), simulate(circuit, times, start, **FORTRAN)
    assert any(mode.rod for _, mode in run.events)
    assert unaccounted(run, circuit) < 1e-8
    x, i, cylinder = run.signals["position"], run.integrals, circuit.actuator
    for name, volume in zip("ab", zip(*map(cylinder.volumes, x), strict=True), strict=True):
        mass = np.array(volume) * [circuit.oil.density_ratio(p) for p in run.signals[f"p_{name}"]]
        assert i[f"inflow_{name}"] == pytest.approx(mass - mass[0], abs=1e-9 * mass[0])
    for mine, theirs in ((run.signals, other.signals), (i, other.integrals)):
        for name, values in mine.items():
            scale = max(abs(values).max(), 1e-9)
            assert values == pytest.approx(theirs[name], abs=1e-6 * scale), name


def test_unknown_start_is_refused():
    """A start that names no state is an error, not a silent zero."""
    with pytest.raises(ValueError, match="no such state"):
        simulate(SERVO, [0, 1], {"positoin": 0.1})
