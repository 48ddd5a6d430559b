"""The simulation against an oracle written apart from it, and against published check values.

Both get the same numbers; states, flows and energies agree within two millionths of their span.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import servo_oracle as oracle
import servo_oracle_parts as parts
from servo_oracle_parts import line, sine, steps
from simulation_case import (
    AREA_A,
    AREA_B,
    BALANCED,
    BAR,
    LITRE,
    MIDDLE,
    OIL,
    VALVE,
    plant,
    run,
    scenario,
)

from actuator_opt.models.loop import ControllerGains
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.linear import Linear, tune, ultimate
from actuator_opt.studies.plant import Plane, SealData

SHARP = {"sharp": 1e3, "relative": 1e-9}
HOLD = 70 * BAR * (AREA_A - AREA_B)
AIRY = replace(OIL, air_content=0.01)
STUCK = SealData(Plane(150.0), Plane(200.0), 0.01, 0.0, 2e-4)


@dataclass(frozen=True)
class Tapered(parts.LuGre):
    """Bristles whose damping fades with the speed, as it must to stay passive."""

    taper: float = math.inf

    def rate_and_force(self, v, z):
        """Bristle rate and friction force."""
        rate, _ = super().rate_and_force(v, z)
        return rate, self.sigma0 * z + self.sigma1 * math.exp(-((v / self.taper) ** 2)) * rate


@dataclass(frozen=True)
class Seat(parts.FixedPump):
    """A fixed pump whose relief valve is an orifice that opens in proportion."""

    override: float = 10 * BAR
    rated: float = 0.0
    tank: float = 0.0

    def rates(self, p, q, used):
        """Rates of pressure and pump flow; flow delivered and flow through the relief valve."""
        drop = p - self.tank
        share = min(max((drop - self.relief_pressure) / self.override, 0.0), 1.0)
        full = self.rated * math.sqrt(max(drop, 0.0) / (self.relief_pressure + self.override))
        flow = share * full
        return (self.flow - used - flow) * self.bulk_modulus / self.volume, 0.0, self.flow, flow


@dataclass(frozen=True)
class Full(parts.Valve):
    """A valve whose spool swings beyond its limit without opening further."""

    def edges(self, spool, ps, pa, pb, pt, side=0.0):
        """Flows PA, AT, PB, BT."""
        return super().edges(min(max(spool, -self.limit), self.limit), ps, pa, pb, pt, side)


def twin(own, *, reference, load, controller=None, supply=None, damping=0.0, fading=True):
    """The oracle's circuit of a plant; `damping` of its bristles, `fading` with the speed."""
    valve, seals = own.valve, own.seals
    friction = None
    if seals.coulomb.constant > 0:
        stiffness = seals.static.constant / seals.bristle_travel
        taper = 2 * seals.coulomb.constant / damping if damping and fading else math.inf
        friction = Tapered(
            seals.static.constant, seals.coulomb.constant, seals.stribeck_speed, stiffness,
            damping, taper=taper,
        )  # fmt: skip
    cylinder = parts.Cylinder(
        own.area_a, own.area_b, own.stroke, own.dead_a, own.dead_b, own.mass,
        leakage=own.leakage, viscous=own.oil_damping, friction=friction,
        stop_stiffness=own.stop_stiffness,
        stop_damping=0.5 * math.sqrt(own.stop_stiffness * own.mass),
    )  # fmt: skip
    return oracle.Circuit(
        parts.Oil(own.oil.bulk_modulus, own.oil.air_content, ambient=101325.0),
        Full(
            valve.rated, 2 * (valve.leakage_supply, valve.leakage_tank),
            2 * math.pi * valve.natural_frequency, valve.damping_ratio, valve.signal,
        ),
        cylinder,
        parts.ConstantSupply(own.supply_pressure) if supply is None else supply,
        reference,
        load,
        controller,
        own.return_pressure,
    )  # fmt: skip


def gains_of(controller):
    """The controller in our form."""
    integral = controller.kp / controller.ki if controller.ki else math.inf
    return ControllerGains(controller.kp, integral, controller.kd / controller.kp)


def apart(ours, theirs, names):
    """Largest difference of states and integrals over their span, by our name."""
    _, first = np.unique(ours.time, return_index=True)
    both = theirs.signals | theirs.integrals
    found = {}
    for mine, other in names.items():
        values = ours.signals[mine] if mine in ours.signals else ours.state(mine)
        other = both[other] if isinstance(other, str) else other(both)
        found[mine] = float(np.abs(values[first] - other).max() / np.ptp(other))
    return found


def integral(*names):
    """Sum of integrals of the oracle."""
    return lambda both: sum(both[name] for name in names)


MOVED = {
    "position": "position", "speed": "velocity", "pressure_a": "p_a", "pressure_b": "p_b",
    "spool": "spool", "flow_a": "q_a", "flow_supply": "q_p", "work on load": "load",
    "valve loss": integral("edge_pa", "edge_at", "edge_pb", "edge_bt"),
}  # fmt: skip
AT_REST = {"position": 0.08, "p_a": 70 * BAR, "p_b": 70 * BAR}
PUSH = [{"shape": "constant", "value": 1500.0}]
SEALED = plant(seals=STUCK, oil=replace(OIL, air_content=0.005))
CONSTANT = {"bristle_damping": 5e3}
FADING = CONSTANT | {"bristle_taper": True}
TURN = {
    "machine": {
        "displacement": 13.3e-6, "slip": 150e-9, "coulomb": 0.16, "viscous": 1e5,
        "constant_torque": 0.1,
    },
    "inertia": 13.3e-3, "pipe_volume": 1e-4, "torque": [{"shape": "constant", "value": 8.0}],
}  # fmt: skip


def stairs(*points):
    """Steps of the reference: (start, value) of ours, and the whole of the oracle."""
    ours, theirs, at = [], [(0.0, 0.08)], 0.08
    for start, value in points:
        ours.append({"shape": "step", "start": start, "value": value})
        at += value
        theirs.append((start, at))
    return {"position": ours}, steps(*theirs)


@dataclass(frozen=True)
class Case:
    """A scenario and what the oracle is asked for it."""

    own: object
    scene: dict
    circuit: object
    gains: object = None
    names: dict = None
    start: dict = None
    events: tuple = ()

    def compared(self, **how):
        """Largest differences over the span, and our run."""
        ours = run(scenario(**self.scene), self.own, self.gains, **(SHARP | how))
        theirs = oracle.simulate(
            self.circuit, np.unique(ours.time), AT_REST if self.start is None else self.start,
            method="LSODA", rtol=1e-10,
        )  # fmt: skip
        return apart(ours, theirs, self.names or MOVED), ours


def looped(
    own, points, controller, names=None, force=PUSH, load=None, damping=0.0, fading=True, **scene
):
    """A position loop over a stair of references."""
    control, reference = stairs(*points)
    supply = scene.pop("twin_supply", None)
    events = scene.pop("events", ())
    scene = {"duration": 0.6, "initial": MIDDLE, "load": {"force": force}} | scene
    held = steps((0.0, sum(part["value"] for part in force if part["shape"] == "constant")))
    circuit = twin(
        own, reference=reference, load=held if load is None else load, controller=controller,
        supply=supply, damping=damping, fading=fading,
    )  # fmt: skip
    scene["control"] = control
    return Case(own, scene, circuit, gains_of(controller), MOVED | (names or {}), events=events)


def pulse():
    """Open loop: air, leakage, a tank pressure, unequal edges."""
    valve = replace(VALVE, leakage_tank=1.3 * VALVE.leakage_tank)
    own = plant(oil=AIRY, leakage=1e-13, return_pressure=3 * BAR, valve=valve)
    signal = [{"shape": "pulse", "start": 0.02, "end": 0.1, "value": 6.0}]
    scene = {
        "duration": 0.2, "initial": MIDDLE, "load": {"force": BALANCED}, "signal": signal,
    }  # fmt: skip
    circuit = twin(own, reference=steps((0, 0.0), (0.02, 6.0), (0.1, 0.0)), load=steps((0.0, HOLD)))
    names = {
        "leakage loss": "leakage", "supply work": "supply", "return work": "return",
        "work on shear of the oil": "friction",
    }  # fmt: skip
    return Case(own, scene, circuit, names=MOVED | names)


def saturated():
    """P with bristles; steps that ask for more than the valve has."""
    sheared = {"bristles": "bristle"}
    return looped(
        SEALED, [(0.02, 0.06), (0.35, -0.11)], parts.Controller(300.0), sheared, damping=5e3,
        friction=FADING,
    )  # fmt: skip


def integral_part():
    """PI with bristles, within the valve's limits."""
    return looped(
        SEALED, [(0.02, 0.006), (0.35, -0.01)], parts.Controller(150.0, ki=800.0),
        {"bristles": "bristle", "integral part": lambda both: 800 * both["integral"]},
        damping=5e3, friction=FADING,
    )  # fmt: skip


def as_stated():
    """A stated damping of the bristles, which no speed changes."""
    return looped(
        SEALED, [(0.02, 0.006), (0.35, -0.01)], parts.Controller(150.0), {"bristles": "bristle"},
        damping=5e3, fading=False, friction=CONSTANT,
    )  # fmt: skip


def shaken():
    """PID with bristles while a sine shakes the rod from 0.1 s on."""
    shake = {
        "shape": "sine", "start": 0.1, "frequency": 12.0, "value": 800.0,
        "phase": 2 * math.pi * 0.2,
    }  # fmt: skip
    load = parts.Signal((0.0, 0.1), (line(1500.0), sine(1500.0, 800.0, 12.0)))
    return looped(
        SEALED, [(0.02, 0.006), (0.35, -0.01)], parts.Controller(150.0, ki=800.0, kd=0.3),
        {"bristles": "bristle", "filtered error": "filtered_error"}, force=[*PUSH, shake],
        load=load, damping=5e3, friction=FADING,
    )  # fmt: skip


def struck():
    """A loop that runs into both stops and rests on them."""
    return looped(
        plant(oil=replace(OIL, air_content=0.005)), [(0.02, 0.10), (0.35, -0.20)],
        parts.Controller(300.0), {"work on stops": "stop"},
        events=("stop at the rod end", "stop at the rod end", "stop at the cap end"),
    )  # fmt: skip


def fixed_pump():
    """A pump of constant flow with a relief valve."""
    stated = {
        "type": "fixed_pump", "volume": 1e-3, "flow": 40 * LITRE,
        "relief": {"pressure": 130 * BAR, "rated_flow": 45 * LITRE},
    }  # fmt: skip
    line = Seat(
        40 * LITRE, 130 * BAR, 0.0, 1e-3, 1.4e9, pressure=140 * BAR, rated=45 * LITRE,
        tank=3 * BAR,
    )  # fmt: skip
    names = {"pressure_supply": "p_supply", "supply work": "pump", "relief loss": "relief"}
    return looped(
        plant(return_pressure=3 * BAR), [(0.02, 0.04)], parts.Controller(200.0), names,
        force=BALANCED, supply=stated, twin_supply=line,
    )  # fmt: skip


def controlled_pump():
    """A pump that follows the pressure, between the ends of its swash plate."""
    stated = {
        "type": "controlled_pump", "volume": 1e-3, "flow": 80 * LITRE, "gain": 1e-9,
        "time_constant": 0.02,
    }  # fmt: skip
    line = parts.ControlledPump(0.02, 1e-9, 140 * BAR, 80 * LITRE, 1e-3, 1.4e9, pressure=140 * BAR)
    names = {"pressure_supply": "p_supply", "pump": "pump_flow", "supply work": "pump"}
    return looped(
        plant(), [(0.02, 0.04)], parts.Controller(200.0), names, force=BALANCED, supply=stated,
        twin_supply=line,
    )  # fmt: skip


def motor():
    """PI on the speed of a Wilson motor against a torque."""
    own = plant()
    machine = parts.Motor(
        13.3e-6 / (2 * math.pi), 13.3e-3, 1e-4, 150e-9, 0.16, 100e3, 0.1,
        viscosity=own.oil.dynamic_viscosity,
    )  # fmt: skip
    controller = parts.Controller(0.02, ki=1.0, of="velocity")
    circuit = twin(
        own, reference=steps((0.0, 30.0), (0.3, 60.0)), load=steps((0.0, 8.0)),
        controller=controller,
    )  # fmt: skip
    speed = [{"shape": "constant", "value": 30.0}, {"shape": "step", "start": 0.3, "value": 30.0}]
    scene = {
        "initial": {"pressure_a": 75 * BAR, "pressure_b": 65 * BAR}, "motor": TURN,
        "control": {"shaft_speed": speed, "law": "pi"},
    }  # fmt: skip
    names = {
        "shaft_speed": "velocity", "shaft_angle": "position", "pressure_a": "p_a",
        "pressure_b": "p_b", "spool": "spool", "flow_supply": "q_p", "supply work": "supply",
        "work on the load": "load",
    }  # fmt: skip
    return Case(
        own, scene, replace(circuit, actuator=machine), gains_of(controller), names,
        {"p_a": 75 * BAR, "p_b": 65 * BAR},
    )  # fmt: skip


CASES = (
    pulse, saturated, integral_part, as_stated, shaken, struck, fixed_pump, controlled_pump, motor,
)  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_run_is_that_of_the_oracle(case):
    """States, flows and energies within 2e-6 of their span, 2e-5 behind stops; the same stops."""
    asked = case()
    found, ours = asked.compared()
    assert max(found.values()) < (2e-5 if asked.events else 2e-6), found
    assert tuple(event.name for event in ours.found.events) == asked.events


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_default_tolerances_are_close(case):
    """At the tolerances that a run has by default, everything is within 1e-4 of its span."""
    found, _ = case().compared(sharp=1.0, relative=None)
    assert max(found.values()) < 1e-4, found


@pytest.mark.parametrize(
    "case", [pytest.param(saturated, marks=pytest.mark.long), fixed_pump, motor]
)
def test_radau_gives_the_same(case):
    """The second integrator, at its own tolerances, agrees as well."""
    found, _ = case().compared(sharp=1.0, relative=None, method="radau")
    assert max(found.values()) < 1e-5, found


def test_integral_part_is_held_at_the_limit():
    """PI that saturates: the soft hold of the integral part is within 0.1 % of a hard one."""
    asked = looped(
        SEALED, [(0.02, 0.06), (0.35, -0.11)], parts.Controller(300.0, ki=800.0),
        {"integral part": lambda both: 800 * both["integral"]}, damping=5e3, friction=FADING,
    )  # fmt: skip
    found, ours = asked.compared()
    assert max(found.values()) < 1e-3, found
    assert max(found["position"], found["speed"], found["pressure_a"]) < 1e-4
    assert np.abs(ours.signals["signal"]).max() == 10.0


@pytest.mark.parametrize(
    ("volts", "v", "p_a", "p_b"),
    [(3.0, 0.393606, 51.942, 43.109), (-3.0, -0.381055, 82.856, 99.424)],
)
def test_steady_speed_is_the_check_value(volts, v, p_a, p_b):
    """A long stroke at constant signal settles on the three equations of the check list."""
    long = plant(seals=STUCK, stroke=1.0)
    scene = scenario(
        duration=0.8, initial=MIDDLE | {"position": 0.1 if v > 0 else 0.9},
        load={"force": PUSH}, signal=[{"shape": "constant", "value": volts}],
    )  # fmt: skip
    found = run(scene, long).signals
    assert found["speed"][-1] == pytest.approx(v, rel=3e-6)
    assert found["pressure_a"][-1] / BAR == pytest.approx(p_a, abs=6e-4)
    assert found["pressure_b"][-1] / BAR == pytest.approx(p_b, abs=6e-4)


@pytest.mark.parametrize(
    ("spool", "gain", "period"), [(250, 416.743, 7.7584), (400, 333.220, 7.6671)]
)
def test_ultimate_gain_is_the_check_value(spool, gain, period):
    """K_u in V/m and T_u in ms of the linear loop, by both ways to it, and of the oracle."""
    own = plant(valve=replace(VALVE, natural_frequency=float(spool)))
    control = {"position": [{"shape": "step", "start": 0.5, "value": 0.02}]}
    scene = scenario(initial=MIDDLE, load={"force": BALANCED}, control=control)
    loops = Linear.of(assemble(scene, own, {}, None, linear=True)).about(position=0.08).loops
    for loop in loops:
        found = ultimate(loop)
        assert found.gain == pytest.approx(gain, rel=2e-6)
        assert found.period == pytest.approx(period * 1e-3, rel=1e-5)
    circuit = twin(own, reference=steps((0.0, 0.08)), load=steps((0.0, HOLD)))
    for side, loop in zip((1.0, -1.0), loops, strict=True):
        theirs = oracle.ultimate_gain_by_swinging(circuit, AT_REST, side)
        assert theirs == pytest.approx((ultimate(loop).gain, ultimate(loop).period), rel=1e-6)
    tuned = tune(scene, own, {}, with_margins=True)
    assert tuned.ultimate.gain <= gain * (1 + 2e-6)  # the end of the step may swing first


def test_a_valve_that_leaks_nothing_has_the_oracles_ultimate_gain():
    """Position and common pressure then share a pole at zero: K_u is near that of hardly any.

    Near, since without leakage the least motion decides which pressures it has.
    """
    gains = []
    for share in (0.0, 1e-5):
        tight = replace(VALVE, leakage_supply=share * VALVE.leakage_supply,
                        leakage_tank=share * VALVE.leakage_tank)  # fmt: skip
        own = plant(valve=tight)
        control = {"position": [{"shape": "step", "start": 0.5, "value": 0.02}]}
        scene = scenario(initial=MIDDLE, load={"force": BALANCED}, control=control)
        loops = Linear.of(assemble(scene, own, {}, None, linear=True)).about(position=0.08).loops
        assert not any(loop.unstable for loop in loops)
        gains.append([ultimate(loop).gain for loop in loops])
    circuit = twin(own, reference=steps((0.0, 0.08)), load=steps((0.0, HOLD)))
    for k, side in enumerate((1.0, -1.0)):
        theirs, _ = oracle.ultimate_gain_by_swinging(circuit, AT_REST, side, gains=(100.0, 1e4))
        assert gains[1][k] == pytest.approx(theirs, rel=1e-4)
        assert gains[0][k] == pytest.approx(theirs, rel=0.06)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.8])
def test_no_load_that_is_let_down_swings_before_the_one_that_is_held(share):
    """The oracle's K_u while the load sinks steadily is not below the least at rest, by 4 %."""
    own = plant()
    force = share * (140 * BAR) * AREA_A
    held = [{"shape": "constant", "value": force}]
    control = {"position": [{"shape": "step", "start": 0.5, "value": 0.0001}]}
    scene = scenario(initial={"position": 0.08}, load={"force": held}, control=control)
    linear = Linear.of(assemble(scene, own, {}, None, linear=True))
    least = min(ultimate(loop).gain for loop in linear.about(position=0.08).loops)
    circuit = twin(own, reference=steps((0.0, 0.08)), load=steps((0.0, force)))
    names = {"position": "position", "speed": "velocity", "pressure a": "p_a",
             "pressure b": "p_b", "spool": "spool"}  # fmt: skip
    for speed in (-1e-4, -1e-3, -5e-3, -2e-2, -5e-2):
        state, signal = linear.steady(-1.0, speed=speed)
        there = dict(zip(linear.names, state, strict=True))
        start = {theirs: there[ours] for ours, theirs in names.items()}
        sinking, _ = oracle.ultimate_gain_by_swinging(circuit, start, math.copysign(1.0, signal))
        assert sinking > 0.96 * least


def test_ultimate_gain_of_a_motor_is_the_oracles():
    """Shaft speed over the signal, where the valve holds 8 N m: K_u and T_u as by eigenvalues."""
    asked = motor()
    linear = Linear.of(assemble(scenario(**asked.scene), asked.own, {}, None, linear=True))
    bare = replace(asked.circuit.actuator, dry=0.0, constant_torque=0.0)
    circuit = replace(asked.circuit, actuator=bare)
    across = 8.0 * 2 * math.pi / 13.3e-6
    middle = 0.5 * asked.own.supply_pressure
    still = asked.start | {"p_a": middle + 0.5 * across, "p_b": middle - 0.5 * across}
    for side, loop in zip((1.0, -1.0), linear.about().loops, strict=True):
        found = ultimate(loop)
        there = oracle.about_rest(circuit, still, side)
        theirs = oracle.ultimate_gain_by_swinging(circuit, there, side, of="velocity")
        assert theirs == pytest.approx((found.gain, found.period), rel=1e-5)
