"""Laws that every simulation keeps: mass, energy, symmetry, scaling, and nothing missed.

Expected values are balances, closed forms, or the same circuit told another way.
"""

from __future__ import annotations

import math
from dataclasses import replace
from math import acos, cos, exp, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp
from simulation_case import (
    AREA_A,
    BALANCED,
    BAR,
    LITRE,
    MIDDLE,
    NO_SEALS,
    OIL,
    VALVE,
    plant,
    run,
    scenario,
)

from actuator_opt.design.model import Linkage
from actuator_opt.evaluation.springs import Give
from actuator_opt.models.loop import ControllerGains
from actuator_opt.studies.plant import LineData, LinePiece, Plane, SealData

SHARP = {"sharp": 1e3, "relative": 1e-9}
VACUUM = -101325.0
AIRY = replace(OIL, air_content=0.005, slope=8.0)
PIPE = LinePiece(8e-3, 1.8, 0.0, OIL.density, OIL.dynamic_viscosity)  # 5e8 Pa s/m^3
LINE = LineData(1e-5, 1e-15, 1.2e-5, 2e-15, 2e7, (PIPE,))
THROTTLE = {
    "opening": 0.3, "needle_area": 0.22e-4, "check_area": 0.64e-4, "cracking_pressure": 0.4e5,
    "density": 870.0, "dynamic_viscosity": 0.03,
}  # fmt: skip
REDUCING = {
    "conductance": 1e-10, "natural_frequency": 20.0, "damping_ratio": 0.4,
    "passive_conductance": 2e-12,
}  # fmt: skip
CUSHION = {"length": 0.02, "open_area": 3e-5, "end_area": 1e-6, "exponent": 0.6}
PUMP = {
    "displacement": 20e-6, "setting": 0.9, "slip": 150e-9, "coulomb": 0.16, "viscous": 1e5,
    "constant_torque": 0.1, "shaft_speed": 150.0,
}  # fmt: skip
RELIEF = {"pressure": 135 * BAR, "rated_flow": 60 * LITRE}
SEALS = SealData(Plane(100.0, 1e-5, 2e-5, 1e-5), Plane(300.0, 2e-5, 2e-5, 1e-5), 0.01, 50.0, 1e-4)
WALLS = Give(2e-14, 3e-13, 1e-14, 2e-13, 1e-15, -2e-14)
CRANK = Linkage(base_radius=0.46, crank_radius=0.12)


def joined(inertia):
    """The design with a joint."""
    design = plant().design
    load = design.load.model_copy(update={"inertia": inertia})
    return design.model_copy(update={"linkage": CRANK, "load": load})


def courses(size, longest):
    """Lists of parts of a signal up to a size."""
    value = st.floats(-size, size).filter(lambda v: v != 0)
    instant = st.floats(0.0, 0.6 * longest)
    later = st.floats(0.7 * longest, longest)
    return st.lists(
        st.one_of(
            st.fixed_dictionaries({"shape": st.just("constant"), "value": value}),
            st.fixed_dictionaries({"shape": st.just("step"), "start": instant, "value": value}),
            st.fixed_dictionaries(
                {"shape": st.sampled_from(["ramp", "pulse"]), "start": instant, "end": later,
                 "value": value}
            ),
            st.fixed_dictionaries(
                {"shape": st.just("sine"), "start": instant, "value": value,
                 "frequency": st.floats(1.0, 200.0), "phase": st.floats(-3.0, 3.0)}
            ),
        ),
        max_size=2,
    )  # fmt: skip


LENGTH = 0.04


@st.composite
def plants(draw):
    """Cylinders with everything that a design may add."""
    oil = replace(
        OIL,
        air_content=draw(st.sampled_from([1e-4, 1e-3, 5e-3, 0.05])),
        slope=draw(st.sampled_from([0.0, 8.0])),
        polytropic_index=draw(st.sampled_from([1.0, 1.2, 1.4])),
    )
    lines = st.sampled_from(
        [LineData(), LINE, replace(LINE, inertance=8e7, far_volume=5e-5, pieces=())]
    )
    return plant(
        oil=oil,
        walls=draw(st.sampled_from([Give(), WALLS])),
        flexibility=draw(st.sampled_from([0.0, 3e-9])),
        lines={"a": draw(lines), "b": draw(lines)},
        throttle=draw(st.sampled_from([None, THROTTLE])),
        reducing_valve=REDUCING,
        leakage=draw(st.sampled_from([0.0, 1e-12, 1e-11])),
        seals=draw(st.sampled_from([NO_SEALS, SEALS])),
        oil_damping=draw(st.sampled_from([0.0, 400.0])),
        return_pressure=draw(st.sampled_from([0.0, 5 * BAR])),
        mass=draw(st.sampled_from([2.0, 30.0, 200.0])),
        dead_a=draw(st.sampled_from([1e-6, 8e-6, 1e-4])),
        design=draw(st.sampled_from([plant().design, joined(0.5)])),
        closed_length=0.36,
    )


@st.composite
def supplies(draw):
    """Everything that may feed a valve."""
    kind = draw(st.sampled_from(["constant", "fixed_pump", "controlled_pump"]))
    stated = {"type": kind}
    if kind == "fixed_pump":
        stated |= {"volume": 5e-4, "relief": RELIEF}
        stated |= draw(st.sampled_from([{"flow": 30 * LITRE}, {"pump": PUMP}]))
    if kind == "controlled_pump":
        stated |= {"volume": 5e-4, "flow": 40 * LITRE, "gain": 2e-9, "time_constant": 0.01}
    if kind != "constant" and draw(st.booleans()):
        charge = draw(st.floats(50 * BAR, 160 * BAR))
        stated["accumulator"] = {"gas_volume": 3e-4, "precharge": charge}
    if draw(st.booleans()):
        stated["line"] = {"length": 1.0, "inner_diameter": 0.01}
    return stated


@st.composite
def scenes(draw, own):
    """Scenarios around a cylinder."""
    ends = draw(
        st.sampled_from(
            [None, None, None, "closed", "blocked", "constant_pressure", "reducing_valve"]
        )
    )
    load = {
        "force": draw(courses(8000.0, LENGTH)),
        "stiffness": draw(st.sampled_from([0.0, 1e5])),
        "damping": draw(st.sampled_from([0.0, 300.0])),
    }
    if own.design.linkage is not None:
        load["torque"] = draw(courses(300.0, LENGTH))
    if draw(st.integers(0, 4)) == 0:
        course = draw(courses(5e-3, LENGTH)) or [{"shape": "constant", "value": 1e-3}]
        load["drive"] = {"position": course, "stiffness": 1e6, "damping": 500.0}
    if draw(st.integers(0, 4)) == 0:
        valve = {"rated_flow": 40 * LITRE, "natural_frequency": 80.0, "damping_ratio": 0.7}
        load["cylinder"] = {
            "bore": 0.04, "rod_diameter": 0.02, "stroke": 0.4, "supply_pressure": 140 * BAR,
            "valve": valve | {"leakage_flow": 0.3 * LITRE}, "force": 1000.0,
            "signal": draw(courses(10.0, LENGTH)),
        }  # fmt: skip
    stated = {
        "duration": LENGTH,
        "ends": ends,
        "initial": {
            "position": draw(st.floats(0.0, 0.16)),
            "pressure_a": draw(st.floats(5 * BAR, 130 * BAR)),
            "pressure_b": draw(st.floats(5 * BAR, 130 * BAR)),
            "speed": draw(st.sampled_from([0.0, -0.7, 0.5])),
        },
        "friction": {"model": draw(st.sampled_from(["lugre", "stribeck", "none"]))},
        "stops": draw(st.sampled_from([{}, {"cushion": CUSHION}])),
        "load": load,
    }
    if stated["friction"]["model"] != "none":
        stated["friction"]["exponent"] = draw(st.sampled_from([0.3, 1.0, 2.0]))
    if ends is None:
        stated["signal"] = draw(courses(12.0, LENGTH))
        stated["supply"] = draw(supplies())
    return stated


@pytest.mark.long
@settings(max_examples=30)
@given(data=st.data())
def test_mass_and_energy_are_kept(data):
    """What is stored is what came in less what went out, and the sharper the tolerances are."""
    own = data.draw(plants())
    scene = scenario(**data.draw(scenes(own)))
    for how, mass, share, least in (({}, 5e-4, 1e-4, 1e-3), (SHARP, 5e-7, 1e-7, 1e-6)):
        found = run(scene, own, **how)
        assert found.lost_mass() < mass
        assert found.lost_energy() < max(share * found.turnover(), least)
        for name, values in found.signals.items():
            if name.startswith("pressure_") and name != "pressure_force":
                assert values.min() > VACUUM, name


@pytest.mark.parametrize(
    "scene",
    [
        {
            "motor": {
                "machine": {key: PUMP[key] for key in PUMP if key != "shaft_speed"},
                "inertia": 13.3e-3, "pipe_volume": 1e-4, "damping": 0.01,
                "torque": [{"shape": "constant", "value": 8.0}],
            },
            "signal": [{"shape": "sine", "value": 8.0, "frequency": 5.0}],
        },
        {
            "held_ports": {"pressure_a": 90 * BAR, "pressure_b": 60 * BAR},
            "signal": [{"shape": "sine", "value": 8.0, "frequency": 5.0}],
        },
    ],
    ids=["motor", "bench"],
)  # fmt: skip
def test_mass_and_energy_are_kept_without_a_cylinder(scene):
    """The same for a motor between two pipes and for a valve on its bench."""
    for how, limit in (({}, 1e-5), (SHARP, 1e-8)):
        found = run(scenario(duration=0.2, **scene), plant(oil=AIRY), **how)
        assert found.lost_mass() < limit
        assert found.lost_energy() < limit * found.turnover()


def test_integrals_are_exact_where_the_motion_is_simple():
    """Between held ports a bare mass takes steps without end; its works are right all the same."""
    own = plant(mass=2.0, oil_damping=0.0)
    force = [{"shape": "ramp", "start": 0.01, "end": 0.04, "value": -6400.0}]
    scene = scenario(
        duration=0.05, ends="constant_pressure", friction={"model": "none"},
        initial={"position": 0.09, "pressure_a": 9 * BAR, "pressure_b": 44 * BAR},
        load={"force": force},
    )  # fmt: skip
    found = run(scene, own)
    assert len(found.found.events) > 4
    assert found.lost_energy() < 1e-4 * found.turnover()


def test_an_emptied_chamber_stays_above_vacuum_and_keeps_its_air():
    """A rod torn out of a closed port: the chamber grows fivefold, oil and gas in it stay."""
    air = 1e-4
    own = plant(oil=replace(OIL, air_content=air), dead_a=1e-6, area_b=1e-6, dead_b=1e-4)
    scene = scenario(
        duration=0.3, ends="closed",
        initial={"position": 0.005, "pressure_a": 0.0, "pressure_b": 0.0},
        load={"force": [{"shape": "constant", "value": -3000.0}], "damping": 3e4},
    )  # fmt: skip
    found = run(scene, own)
    place, pressure = found.signals["position"], found.signals["pressure_a"]
    volume = 1e-6 + AREA_A * place
    assert volume[-1] > 4 * volume[0]
    assert VACUUM < pressure.min() < VACUUM + 0.1
    assert found.lost_mass() < 1e-4
    late = volume > 2 * volume[0]
    # (1 + alpha) V/V_0 = e^(-p/K) + alpha (p_a/P)^(1/n)
    gas = ((1 + air) * volume / volume[0] - np.exp(-pressure / 1.4e9)) / air
    assert pressure[late] - VACUUM == pytest.approx(101325.0 * gas[late] ** -1.4, rel=1e-3)


@pytest.mark.long
def test_pump_that_gives_too_little_does_not_stop_the_run():
    """The rod draws more than the pump gives: the line falls below the tank, the relief is shut."""
    stated = {
        "type": "fixed_pump", "volume": 1e-3, "flow": 5 * LITRE,
        "relief": {"pressure": 140 * BAR, "rated_flow": 40 * LITRE},
    }  # fmt: skip
    scene = scenario(
        duration=0.2, initial=MIDDLE | {"position": 0.02}, supply=stated,
        load={"force": [{"shape": "constant", "value": -6000.0}]},
        signal=[{"shape": "constant", "value": 10.0}],
    )  # fmt: skip
    for method in ("lsoda", "radau"):
        found = run(scene, plant(oil=AIRY, return_pressure=5 * BAR), method=method)
        assert found.signals["pressure_supply"].min() < 5 * BAR
        assert found.signals["flow_relief"].max() == pytest.approx(0.0, abs=1e-12)


def test_steady_flow_of_the_relief_valve():
    """A centred valve takes its leakage, the relief valve the rest of the pump's flow."""
    stated = {
        "type": "fixed_pump", "volume": 1e-3, "flow": 30 * LITRE,
        "relief": {"pressure": 140 * BAR, "override": 8 * BAR, "rated_flow": 40 * LITRE},
    }  # fmt: skip
    scene = scenario(initial=MIDDLE, supply=stated, load={"force": BALANCED})
    signals = run(scene, plant(return_pressure=2 * BAR)).signals
    over, rest = signals["pressure_supply"][-1] - 2 * BAR, signals["flow_relief"][-1]
    opened = (over - 140 * BAR) / (8 * BAR)
    assert rest == pytest.approx(40 * LITRE * opened * sqrt(over / (148 * BAR)), rel=1e-9)
    assert rest + signals["flow_supply"][-1] == pytest.approx(30 * LITRE, rel=1e-6)


@pytest.mark.parametrize("samples", [1e-4, 1e-2, 0.2])
def test_stops_are_met_and_left_to_the_nanosecond(samples):
    """A free mass between both stops: K delta + b delta' and straight lines, in closed form."""
    mass, stiffness, speed = 30.0, 5e7, -0.4
    own = plant(mass=mass, stop_stiffness=stiffness, oil_damping=0.0)
    scene = scenario(
        duration=3.0, ends="constant_pressure", friction={"model": "none"},
        initial={"position": 0.05, "speed": speed, "pressure_a": 0.0, "pressure_b": 0.0},
    )  # fmt: skip
    found = run(scene, own, sample_time=samples, sharp=1e4, relative=1e-12)
    swing = sqrt(stiffness / mass)
    damped, decay, turned = swing * sqrt(1 - 0.25**2), 0.25 * swing, 2 * acos(0.25)
    kept = exp(-2 * acos(0.25) * 0.25 / sin(acos(0.25)))
    expected, time, left = [], 0.0, 0.05
    while True:
        time += left / abs(speed)
        contact = turned / damped
        depth = abs(speed) / damped * exp(-decay * contact) * sin(turned)
        parted = time + contact + depth / abs(kept * speed)
        if parted > 3.0:
            break
        expected += [time, parted]
        time, left, speed = parted, 0.16, kept * speed
    assert len(expected) >= 6
    events = found.found.events
    assert [event.on for event in events][: len(expected)] == [True, False] * (len(expected) // 2)
    assert [event.time for event in events][: len(expected)] == pytest.approx(expected, abs=1e-9)
    assert abs(found.signals["speed"][-1]) == pytest.approx(abs(speed), rel=1e-8)


def test_stop_is_met_where_the_equations_would_end_without_it():
    """At full speed onto the stop: beyond it the chamber has no volume, and nobody goes there."""
    own = plant(oil=AIRY, dead_a=1.2e-6)
    scene = scenario(
        duration=0.2, initial=MIDDLE | {"position": 0.01}, load={"force": BALANCED},
        signal=[{"shape": "constant", "value": -10.0}],
    )  # fmt: skip
    found = run(scene, own, sample_time=2e-3)
    assert found.found.events[0].name == "stop at the cap end"
    assert -1.2e-3 < found.signals["position"].min() < 0
    assert found.lost_mass() < 1e-5
    fine = run(scene, own, sample_time=1e-5)
    assert found.found.events[0].time == pytest.approx(fine.found.events[0].time, abs=1e-7)


@pytest.mark.parametrize("mass", [30.0, 100.0])
def test_hard_blow_on_a_stop_leaves_some_oil(mass):
    """Further into a stop than its dead volume is long: mass and energy stay what they were."""
    own = plant(oil=AIRY, dead_a=0.5e-3 * AREA_A, mass=mass)
    scene = scenario(
        duration=0.3, initial=MIDDLE | {"position": 0.05}, load={"force": BALANCED},
        signal=[{"shape": "constant", "value": -10.0}],
    )  # fmt: skip
    for how, limit in (({}, 1e-5), (SHARP, 1e-8)):
        found = run(scene, own, **how)
        assert found.signals["speed"].min() < -1.2
        assert found.signals["position"].min() < -0.5e-3
        assert found.lost_mass() < limit
        assert found.lost_energy() < limit * found.turnover()


def test_samples_are_told_once_and_events_twice():
    """Of 1001 samples each stands once; the two instants and every event stand twice."""
    scene = scenario(
        duration=1.0, initial=MIDDLE, load={"force": BALANCED},
        signal=[{"shape": "pulse", "start": 0.1, "end": 0.4, "value": 10.0}],
    )  # fmt: skip
    found = run(scene, plant(oil=AIRY))
    times, counts = np.unique(found.time, return_counts=True)
    events = [event.time for event in found.found.events]
    assert events
    assert sorted({0.1, 0.4, *events}) == pytest.approx(times[counts == 2])
    assert counts.max() == 2
    grid = times[[not np.any(np.isclose(time, events, atol=1e-12)) for time in times]]
    assert grid == pytest.approx(np.linspace(0, 1, 1001), abs=1e-9)


POSITIONED = {
    "position": [
        {"shape": "step", "start": 0.05, "value": 0.1},
        {"shape": "step", "start": 0.3, "value": -0.2},
    ],
    "tuning": "stated", "position_gain": 300.0,
}  # fmt: skip


@pytest.mark.parametrize("samples", [1e-4, 1e-2, 0.1])
def test_sample_time_changes_nothing(samples):
    """A loop that runs into both stops is the same at any sample time, stops included."""
    scene = scenario(duration=0.6, initial=MIDDLE, load={"force": BALANCED}, control=POSITIONED)
    gains = ControllerGains(300.0, math.inf, 0.0)
    own = plant(oil=AIRY)
    one = run(scene, own, gains, sample_time=2e-3, **SHARP)
    other = run(scene, own, gains, sample_time=samples, **SHARP)
    assert [event.time for event in one.found.events] == pytest.approx(
        [event.time for event in other.found.events], abs=1e-7
    )
    for name in ("position", "pressure a", "supply work", "work on stops"):
        values = one.state(name)
        assert other.state(name)[-1] == pytest.approx(values[-1], abs=1e-6 * np.ptp(values)), name


def test_mirrored_cylinder_moves_the_other_way():
    """Equal areas: signal and load with the other sign move B as A moved before."""
    own = plant(
        oil=AIRY, area_b=AREA_A, seals=SealData(
            Plane(100.0, 1e-5, 0.0, 1e-5), Plane(200.0, 1e-5, 0.0, 1e-5), 0.01, 50.0, 1e-4
        ), leakage=1e-12, lines={"a": LINE, "b": LINE},
    )  # fmt: skip
    runs = []
    for sign, place in ((1.0, 0.03), (-1.0, 0.13)):
        scene = scenario(
            duration=0.5, initial=MIDDLE | {"position": place},
            load={"force": [{"shape": "step", "start": 0.1, "value": sign * 2000.0}]},
            signal=[{"shape": "pulse", "start": 0.05, "end": 0.4, "value": sign * 9.0}],
        )  # fmt: skip
        runs.append(run(scene, own, **SHARP))
    one, other = runs
    assert len(one.found.events) == len(other.found.events) > 0
    assert one.time == pytest.approx(other.time, abs=1e-7)
    assert other.signals["position"] == pytest.approx(0.16 - one.signals["position"], abs=1e-8)
    for a, b in (("pressure_a", "pressure_b"), ("flow_a", "flow_b")):
        size = np.ptp(one.signals[a])
        assert other.signals[b] == pytest.approx(one.signals[a], abs=1e-4 * size)


def test_two_cylinders_side_by_side_move_as_one():
    """Everything doubled, areas, mass, volumes, edges, friction and load: the same motion."""
    walls = Give(2e-14, 3e-13, 1e-14, 2e-13)
    single = plant(oil=AIRY, seals=SEALS, leakage=1e-12, walls=walls, flexibility=2e-9)
    pair = replace(
        single, area_a=2 * single.area_a, area_b=2 * single.area_b, dead_a=2 * single.dead_a,
        dead_b=2 * single.dead_b, mass=60.0, leakage=2e-12, oil_damping=800.0,
        stop_stiffness=2 * single.stop_stiffness, flexibility=1e-9,
        walls=Give(*(2 * one for one in walls)),
        valve=replace(
            VALVE, rated=2 * VALVE.rated, leakage_supply=2 * VALVE.leakage_supply,
            leakage_tank=2 * VALVE.leakage_tank,
        ),
        seals=SealData(
            *(
                Plane(2 * one.constant, 2 * one.difference, 2 * one.rod_side, 2 * one.higher)
                for one in (SEALS.coulomb, SEALS.static)
            ),
            0.01, 100.0, 1e-4,
        ),
    )  # fmt: skip
    runs = []
    for own, size in ((single, 1.0), (pair, 2.0)):
        scene = scenario(
            duration=0.5, initial=MIDDLE | {"position": 0.03},
            load={"force": [{"shape": "step", "start": 0.1, "value": size * 2000.0}]},
            signal=[{"shape": "pulse", "start": 0.05, "end": 0.4, "value": 9.0}],
        )  # fmt: skip
        runs.append(run(scene, own, **SHARP))
    one, two = runs
    assert len(one.found.events) > 0
    assert two.signals["position"] == pytest.approx(one.signals["position"], abs=1e-9)
    assert two.signals["pressure_a"] == pytest.approx(one.signals["pressure_a"], rel=1e-5)
    assert two.state("supply work") == pytest.approx(2 * one.state("supply work"), rel=1e-7)


def test_later_input_gives_the_same_later():
    """From a balance at rest, a signal that comes 137 ms later moves everything 137 ms later."""
    runs = []
    for start in (0.05, 0.187):
        pulse = {"shape": "pulse", "start": start, "end": start + 0.06, "value": 7.0}
        scene = scenario(
            duration=start + 0.25, initial=MIDDLE, load={"force": BALANCED}, signal=[pulse]
        )
        runs.append(run(scene, plant(oil=AIRY), **SHARP))
    one, later = (
        (found.time[found.time >= start], found.signals["position"][found.time >= start])
        for found, start in zip(runs, (0.05, 0.187), strict=True)
    )
    assert later[0] - 0.137 == pytest.approx(one[0], abs=1e-12)
    assert later[1] == pytest.approx(one[1], abs=1e-9)


def test_record_is_never_stepped_over():
    """A blow of 10 ms after a minute of rest does its work, however long the steps have become."""
    time = np.arange(0.0, 100.0, 1e-3)
    blow = np.where((time > 63) & (time < 63.01), 2e4 * np.sin(pi * (time - 63) / 0.01), 0.0)
    force = [*BALANCED, {"shape": "record", "file": "f", "column": "c"}]
    scene = scenario(duration=100.0, initial=MIDDLE, load={"force": force}, ends="closed")
    found = run(scene, plant(oil=AIRY, seals=SEALS), records={("f", "c"): (time, blow)},
                sample_time=0.05)  # fmt: skip
    assert found.state("work on load")[-1] < -5.0
    assert found.lost_energy() < 1e-3


def test_record_is_the_signal_that_was_recorded():
    """A machine outside that follows a recorded sine is one that follows the sine, damper too."""
    time = np.linspace(0.0, 0.2, 4001)
    sine = {"shape": "sine", "frequency": 10.0, "value": 2e-3}
    record = {"shape": "record", "file": "f", "column": "c", "scale": 2e-3}
    files = {("f", "c"): (time, np.sin(2 * pi * 10 * time))}
    runs = []
    for part in (sine, record):
        drive = {"position": [part], "stiffness": 1e6, "damping": 5e3}
        scene = scenario(
            duration=0.2, initial=MIDDLE, load={"force": BALANCED, "drive": drive}, ends="closed"
        )
        runs.append(run(scene, plant(oil=AIRY), records=files))
    one, other = runs
    span = np.ptp(one.signals["speed"])
    assert other.signals["speed"] == pytest.approx(one.signals["speed"], abs=2e-3 * span)
    assert other.state("work on machine outside")[-1] == pytest.approx(
        one.state("work on machine outside")[-1], rel=1e-3
    )


def test_joint_is_that_of_its_own_equation():
    """Constant pressures turn a joint: J theta'' = r F - T, integrated over the angle instead."""
    own = plant(design=joined(0.5), closed_length=0.36, oil_damping=0.0)
    scene = scenario(
        duration=0.1, ends="constant_pressure", friction={"model": "none"},
        initial={"position": 0.03, "pressure_a": 40 * BAR, "pressure_b": 10 * BAR},
        load={"torque": [{"shape": "constant", "value": 120.0}]},
    )  # fmt: skip
    found = run(scene, own, **SHARP)
    push = 40 * BAR * own.area_a - 10 * BAR * own.area_b
    a, r = CRANK.base_radius, CRANK.crank_radius

    def rates(time, y):
        angle, rate = y
        length = sqrt(a * a + r * r - 2 * a * r * cos(angle))
        arm = a * r * sin(angle) / length
        bend = (a * r * cos(angle) - arm * arm) / length
        # of the mass at the rod: v = arm theta', v' = arm theta'' + bend theta'^2
        torque = arm * (push - own.mass * bend * rate * rate) - 120.0
        return [rate, torque / (0.5 + own.mass * arm * arm)]

    start = acos((a * a + r * r - 0.39**2) / (2 * a * r))
    times = np.linspace(0, 0.1, 101)
    theirs = solve_ivp(rates, (0, 0.1), [start, 0.0], t_eval=times, rtol=1e-11, atol=1e-12)
    assert np.ptp(theirs.y[0]) > 0.2
    angle = np.interp(times, found.time, found.signals["joint_angle"])
    assert angle == pytest.approx(theirs.y[0], abs=1e-8)


def test_held_port_behind_a_throttle_is_held():
    """A throttle at a port of constant pressure: the needle's flow decides, no volume behind it."""
    own = plant(oil=AIRY, throttle=THROTTLE)
    scene = scenario(
        duration=0.1, ends="constant_pressure",
        initial={"position": 0.05, "pressure_a": 40 * BAR, "pressure_b": 40 * BAR},
        load={"force": [{"shape": "constant", "value": 2000.0}]},
    )  # fmt: skip
    signals = run(scene, own).signals
    flow = -own.area_a * signals["speed"][-1]
    area, bore = 0.3 * 0.22e-4, sqrt(4 / pi * 0.3 * 0.22e-4)
    drop = 870 * flow**2 / (2 * (0.611 * area) ** 2) + 0.03 * flow / (2 * 0.2**2 * bore * area)
    assert signals["speed"][-1] < -0.05
    assert signals["pressure_a"][-1] - 40 * BAR == pytest.approx(drop, rel=1e-4)
