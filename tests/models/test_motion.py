"""Linear dynamics and stiffness budget in a whole evaluation.

The judge takes sizes, oil, wall and friction from the evaluation and builds the circuit's
differential equations itself (`circuit_oracle`); lines are computed here from their sizes.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from circuit_oracle import descriptor, load_damping, plant
from cli_runner import bench
from hypothesis import given, settings, strategies as st
from scipy.optimize import brentq

import actuator_opt as ao
from actuator_opt.evaluation import compute
from actuator_opt.evaluation.springs import weakest
from actuator_opt.models import linear, loop, stiffness

SERVO = """
valve:
  rated_flow: 10 l/min
  leakage_flow: 0.2 l/min
  natural_frequency: 120 Hz

lines:
  - chamber: a
    type: hose
    length: 0.3 m
    inner_diameter: 6 mm
    outer_diameter: 10 mm
    material: steel_42crmo4
  - chamber: b
    length: 0.25 m
    inner_diameter: 5 mm
    outer_diameter: 8 mm
    material: steel_42crmo4

control:
  gain: 100 V/m
"""
SHAKEN = ("    side_load: 30 N\n", "    side_load: 30 N\n    frequency: 20 Hz\n")
CLEARANCE = "  clearance: 30 um\n"
LEAKY = (CLEARANCE, f"{CLEARANCE}  leakage_conductance: 1 ml/min/bar\n")
PISTON_LEAKAGE = 1e-11 / 60
"""1 ml/min/bar [m^3/s/Pa]."""
THROTTLE = """  throttle:
    area: 8 mm2
    check_area: 20 mm2
"""
ENDS = {
    "closed": "",
    "valve": "ports:\n  end: valve\n",
    "constant": "ports:\n  end: constant_pressure\n",
    "reducing": """ports:
  end: reducing_valve
  reducing_valve:
    conductance: 2e-10 m3/(s*Pa)
    natural_frequency: 20 Hz
    damping_ratio: 0.4
""",
    "accumulator": """ports:
  end: valve
  accumulators:
    - chamber: b
      gas_volume: 20 ml
      precharge: 20 bar
      neck_length: 40 mm
      neck_diameter: 5 mm
""",
    "throttle": "ports:\n  end: valve\n" + THROTTLE,
}
STATED = "control:\n  gain: 100 V/m\n"
LATER = "\n# the gain is left to the tool\n"
SEALS = "\nstiffness:\n  seals: sticking\n"


@pytest.fixture(scope="module")
def subject_of(tmp_path_factory):
    """Subjects of the bench design on a servo valve, by what ends its lines."""
    folder, found = tmp_path_factory.mktemp("motion"), {}

    def get(end="valve", more="", **sets):
        key = (end, more, *sets.items())
        if key not in found:
            path = folder / f"{len(found)}.yaml"
            text = bench(SHAKEN, LEAKY) + SERVO + ENDS[end] + more
            path.write_text(text.replace(STATED, "") if more == LATER else text)
            found[key] = ao.read(path, set=sets).subject()
        return found[key]

    return get


def _accumulator(pressure, density, s, number):
    """20 ml at 20 bar behind a neck of 5 x 40 mm: filled slowly, shaken at the polytrope 1.4."""
    volume = 20e-6 * (20e5 + 101325) / (pressure + 101325)
    capacitance = volume / (1.4 * (pressure + 101325))
    inertance = density * 0.04 / (math.pi * 0.005**2 / 4)
    resistance = 128 * number(s.dynamic_viscosity) * 0.04 / (math.pi * 0.005**4)
    return "accumulator", capacitance, inertance, resistance


def _throttle(subject, done, case, name, direction, number):
    """dq/d(dp) of needle and check valve at the flow of the case's speed, by hand.

    Each path dp = rho q^2/(2 C^2 A^2) + eta q/(2 delta^2 D A), C 0.611, delta 0.2, D = sqrt(4A/pi);
    the check valve opens by 3 w^2 - 2 w^3 over 0.1 bar beyond 0.4 bar, inwards only.
    """
    if subject.design.ports.throttle is None:
        return None
    s, g = done.state, done.geometry
    rho, eta = number(s.density), number(s.dynamic_viscosity)

    def path(area, drop):
        a = rho / (2 * 0.611**2 * area**2)
        b = eta / (2 * 0.2**2 * math.sqrt(4 * area / math.pi) * area)
        return math.copysign((math.sqrt(b * b + 4 * a * abs(drop)) - b) / (2 * a), drop)

    def flow(drop):
        share = min(max((-drop - 0.4e5) / 0.1e5, 0.0), 1.0)
        return path(8e-6, drop) + (3 * share**2 - 2 * share**3) * path(20e-6, min(drop, 0.0))

    extends = (direction or ("extending" if s.push[case, 0] else "retracting")) == "extending"
    area, speed = float(getattr(g, f"area_{name}")), number(s.speed)
    wanted = area * speed * (-1 if extends == (name == "a") else 1)  # out of the chamber
    drop = brentq(lambda p: flow(p) - wanted, -1e7, 1e7, xtol=1e-6, rtol=1e-15)
    step = 1e-4 * abs(drop)
    return (flow(drop + step) - flow(drop - step)) / (2 * step)


def circuit_of(subject, done, case, position, direction=None):
    """The oracle's circuit of one case at a position; with a direction, driven by the valve."""
    v, g, s = subject.values(), done.geometry, done.state
    budget = done.springs

    def number(value):
        return float(np.broadcast_to(value, (2, 1))[case, 0])

    whole = budget.total().at(position, g.stroke)
    pressures = {"a": number(s.holding_a), "b": number(s.holding_b)}
    moduli = {"a": number(s.bulk_modulus_a), "b": number(s.bulk_modulus_b)}
    supply, drain = v["supply.pressure"], v["supply.return_pressure"]
    leak = (0.2e-3 / 60) / math.sqrt(50e5)
    opening = ((10e-3 / 60) / math.sqrt(35e5) - leak) / 10
    circuit = {}
    for i, name in enumerate("ab"):
        d, length = v[f"lines[{i}].inner_diameter"], v[f"lines[{i}].length"]
        outer = v[f"lines[{i}].outer_diameter"]
        ratio = (outer**2 + d**2) / (outer**2 - d**2)
        e, nu = (v[f"materials.steel_42crmo4.{k}"] for k in ("youngs_modulus", "poissons_ratio"))
        bore = math.pi * d**2 / 4
        wall = math.pi * d**2 * length * (ratio + nu) / (2 * e)
        beyond = 0.0 if done.motion.throttles else 0.5  # the throttle sits at the port by default
        far = beyond * (bore * length / moduli[name] + wall)
        up, down = supply - pressures[name], pressures[name] - drain
        past = PISTON_LEAKAGE * (1 if name == "a" else -1) * (pressures["a"] - pressures["b"])
        fed = max(leak * math.sqrt(up), leak * math.sqrt(down) + past)  # one edge leaks, one feeds
        into, out = fed, fed - past
        if direction is not None:  # an edge that this way does not open only leaks
            fills = (name == "a") == (direction == "extending")
            into, out = (into, leak * math.sqrt(down)) if fills else (leak * math.sqrt(up), out)
        ends = [("conductance", into / (2 * up) + out / (2 * down))]
        if direction is None:
            kind = subject.design.ports.end
            ends = {
                "closed": [],
                "valve": ends,
                "constant_pressure": [("constant_pressure",)],
                "reducing_valve": [("reducing", 2e-10, 2 * math.pi * 20, 0.4, 0.0)],
            }[kind]
        if subject.design.ports.accumulators and name == "b":
            ends = [*ends, _accumulator(pressures["b"], number(s.density), s, number)]
        viscosity = getattr(s, f"dynamic_viscosity_{name}")
        fills = (name == "a") == (direction != "retracting")
        circuit[name] = {
            "area": float(getattr(g, f"area_{name}")),
            "compliance": number(getattr(whole, name)) - far,
            "throttle": _throttle(subject, done, case, name, direction, number),
            "resistance": 128 * number(viscosity) * length / (math.pi * d**4),
            "inertance": number(s.density) * length / bore,
            "far_compliance": far,
            "ends": ends,
            "flow_gain": 0.0
            if direction is None
            else (1 if name == "a" else -1) * opening * math.sqrt(up if fills else down),
        }
    sticks = direction is None and budget.seals is not None
    return circuit | {
        "mass": number(done.motion.mass),
        "damping": number(done.motion.damping),
        "coupling": number(whole.ab),
        "leakage": PISTON_LEAKAGE,
        "seal_stiffness": number(budget.seals) if sticks else 0.0,
        "flexibility": sum(1 / number(part) for part in budget.chain.values()),
    }


@pytest.mark.parametrize("end", list(ENDS))
@pytest.mark.parametrize("more", ["", SEALS], ids=["sliding", "sticking"])
def test_held_actuator_is_that_of_the_differential_equations(subject_of, end, more):
    """Dynamic stiffness, phase and damping ratio at all six places, for every kind of line end."""
    subject = subject_of(end, more)
    done = compute(subject, subject.values())
    metrics = done.computed.metrics
    for place, position in done.places.items():
        where = np.broadcast_to(position, (2, 1))[0]
        circuit = circuit_of(subject, done, 0, where)
        e, a, b, out = descriptor(circuit)
        k = 1 / np.linalg.solve(2j * math.pi * 20 * e - a, b[:, 0])[out]
        assert metrics["dynamic_stiffness"][place][0, 0] == pytest.approx(abs(k), rel=1e-6)
        assert metrics["dynamic_phase"][place][0, 0] == pytest.approx(np.angle(k), abs=1e-6)
        ratio = metrics["damping_ratio"][place][0, 0]
        assert ratio == pytest.approx(load_damping(circuit), rel=1e-4)


@pytest.mark.parametrize("more", ["valve", "accumulator", "throttle"])
def test_position_loop_is_that_of_the_differential_equations(subject_of, more):
    """Ultimate gain in both cases, both directions and all places by closed-loop eigenvalues.

    An accumulator on the line stays there while the valve drives.
    """
    subject = subject_of(more)
    done = compute(subject, subject.values())
    limits = done.computed.metrics["ultimate_gain"]
    for direction in ("extending", "retracting"):
        for place, position in done.places.items():
            for case in range(2):
                where = np.broadcast_to(position, (2, 1))[case]
                judge = plant(circuit_of(subject, done, case, where, direction), 120.0, 0.7)
                limit = limits[f"{direction}, {place}"][case, 0]
                growths = [
                    np.max(np.linalg.eigvals(judge.A - k * limit * judge.B @ judge.C).real)
                    for k in (0.1, 0.5, 0.9, 0.9999, 1.0001)
                ]
                assert [growth > 0 for growth in growths] == [False] * 4 + [True]


def test_margins_belong_to_the_stated_gain(subject_of):
    """Gain margin = K_u/K; above K_u the phase margin is negative; without a gain K = K_u/2."""
    subject = subject_of()
    stated = compute(subject, subject.values()).computed.metrics
    for place, margin in stated["gain_margin"].items():
        np.testing.assert_allclose(margin, stated["ultimate_gain"][place] / 100, rtol=1e-12)
    least = min(np.min(limit) for limit in stated["ultimate_gain"].values())
    beyond = compute(subject, subject.values({"control.gain": 1.01 * least})).computed.metrics
    worst = min(beyond["phase_margin"], key=lambda place: np.min(beyond["gain_margin"][place]))
    assert np.min(beyond["phase_margin"][worst]) < 0
    assert np.all(np.array(list(stated["phase_margin"].values())) > 0)
    free = subject_of("valve", LATER)
    done = compute(free, free.values()).computed.metrics
    assert done["position_gain"][""] == pytest.approx(least / 2, rel=1e-12)


def test_a_valve_without_leakage_has_an_ultimate_gain(subject_of):
    """Leakage is 0 unless stated: the loop's limit is that of a valve that hardly leaks."""
    subject = subject_of()
    tight, almost = (
        compute(subject, subject.values({"valve.leakage_flow": np.array([flow])})).computed.metrics
        for flow in (0.0, 1e-15)
    )
    for place, limit in tight["ultimate_gain"].items():
        assert np.all(limit > 0)
        np.testing.assert_allclose(limit, almost["ultimate_gain"][place], rtol=1e-5)


def test_no_leakage_is_the_limit_of_little(subject_of):
    """The edges feed the piston's bleed where the valve itself leaks nothing."""
    none, little = (
        compute(subject, subject.values()).computed.metrics
        for subject in (subject_of(**{"valve.leakage_flow": flow}) for flow in (0.0, 1e-14))
    )
    for name in ("damping_ratio", "dynamic_stiffness", "ultimate_gain"):
        for place, value in none[name].items():
            np.testing.assert_allclose(value, little[name][place], rtol=1e-4, err_msg=name)


def test_an_accumulator_below_its_precharge_is_not_there(subject_of):
    """Precharged above the held pressure it takes no oil: every figure is that without it."""
    empty = subject_of("accumulator", **{"ports.accumulators[0].precharge": 2.5e7})
    without = subject_of("valve")
    found, expected = (
        compute(subject, subject.values()).computed.metrics for subject in (empty, without)
    )
    for name in ("damping_ratio", "dynamic_stiffness", "dynamic_phase", "bandwidth"):
        for place, value in expected[name].items():
            np.testing.assert_allclose(found[name][place], value, rtol=1e-8)


# --- gradients -----------------------------------------------------------------------------------

FIGURES = (
    "damping_ratio", "dynamic_stiffness", "ultimate_gain", "gain_margin", "phase_margin",
    "bandwidth", "stiffness_min", "natural_frequency",
)  # fmt: skip
PATHS = ("cylinder.bore", "rod.outer_diameter", "load.mass", "lines[0].length", "supply.pressure")


@pytest.mark.parametrize(
    "end",
    [
        pytest.param(x, marks=[pytest.mark.long] if x in ("closed", "constant") else [])
        for x in ENDS
    ],
)
def test_gradients_of_every_figure(subject_of, end):
    """Complex step through a whole evaluation equals central differences, at every place."""
    subject = subject_of(end)
    step, tiny = 1e-5, 1e-30
    for path in PATHS:
        base = subject.numbers[path]
        exact = compute(subject, subject.values({path: np.array([base * (1 + 1j * tiny)])}))
        points = base * (1 + step * np.array([1.0, -1.0, 2.0, -2.0]))
        moved = compute(subject, subject.values({path: points}))
        for name in FIGURES:
            for place, value in exact.computed.metrics[name].items():
                value = np.atleast_2d(value)
                other = np.atleast_2d(moved.computed.metrics[name][place])
                other = np.broadcast_to(other, (len(other), 4))
                with np.errstate(invalid="ignore"):
                    near = (other[:, 0] - other[:, 1]) / (2 * step)
                    wide = (other[:, 2] - other[:, 3]) / (4 * step)
                size = np.abs(value[:, 0].real)
                smooth = np.abs(near - wide) <= 1e-4 * size
                assert np.all(smooth | ~np.isfinite(size)), (name, place)
                error = np.abs(value[:, 0].imag / tiny - near)
                assert np.all((error <= 1e-4 * size + 1e-12) | ~np.isfinite(size)), (name, place)


# --- the stiffness budget ------------------------------------------------------------------------


@settings(max_examples=25)
@given(st.floats(0.018, 0.04), st.floats(0.0, 1.0), st.booleans())
def test_shares_of_the_budget(subject_of, bore, share, sticking):
    """Every share is positive; together they are 1/k, k in series with rod and beside the seals.

    A barrel that shortens as it swells takes from its own share: both parts of it count as one.
    """
    subject = subject_of("closed", SEALS if sticking else "")
    done = compute(subject, subject.values({"cylinder.bore": np.array([bore])}))
    budget, g = done.springs, done.geometry
    position = share * g.stroke
    parts = budget.compliances(position)
    assert {"oil A", "oil B", "barrel", "stretch", "pipes", "hoses", "rod"} <= set(parts)
    positive = {**parts, "barrel": parts["barrel"] + parts["stretch"]}
    del positive["stretch"]
    for part in positive.values():
        assert np.all(np.asarray(part) > 0)
    give = budget.total().at(position, g.stroke)
    oil = stiffness.hydraulic_stiffness(
        area_a=g.area_a, area_b=g.area_b, compliance_a=give.a, compliance_b=give.b,
        compliance_ab=give.ab,
    )  # fmt: skip
    seals = budget.seals if sticking else 0.0
    expected = 1 / (oil + seals) + budget.series_compliance()
    np.testing.assert_allclose(sum(parts.values()), expected, rtol=1e-12)
    np.testing.assert_allclose(budget.stiffness(position), 1 / expected, rtol=1e-12)


def test_softer_parts_lower_the_closed_frequency(subject_of):
    """Longer lines, more air, more dead volume, a thinner rod: never a higher frequency."""
    subject = subject_of("closed")
    for path, factors in {
        "lines[0].length": (1, 2, 4), "fluid.air_content": (1, 2, 4),
        "cylinder.dead_volume_a": (1, 3, 9), "cylinder.dead_volume_b": (1, 3, 9),
        "rod.inner_diameter": (1, 1.1, 1.3), "load.mass": (1, 2, 4),
    }.items():  # fmt: skip
        points = subject.numbers[path] * np.array(factors, dtype=float)
        done = compute(subject, subject.values({path: points}))
        found = done.computed.metrics["natural_frequency"][""]
        assert np.all(np.diff(found, axis=-1) < 0), path


@pytest.mark.parametrize("end", ["closed", "valve", "reducing", "throttle"])
def test_six_places_find_the_worst_of_the_stroke(subject_of, end):
    """On a dense grid of the stroke no figure falls 2 % below the least of the six places."""
    subject = subject_of(end)
    done = compute(subject, subject.values())
    metrics, stroke = done.computed.metrics, done.geometry.stroke
    grid = np.linspace(0, 1, 81).reshape(-1, 1, 1) * stroke
    motion = done.motion
    model = motion.model(grid)
    parts = linear.dynamic_stiffness(model=model, frequency=20.0)
    dense = {
        "dynamic_stiffness": np.hypot(parts.real, parts.imaginary)[:, :1],
        "damping_ratio": loop.load_mode(model=model).damping_ratio,
    }
    one = motion.position_loop(grid, extending=np.array([True, False]).reshape(-1, 1, 1, 1))
    dense["ultimate_gain"] = loop.ultimate_gain(loop=one).gain
    found = loop.margins(loop=one, gain=100.0)
    dense |= {"phase_margin": found.phase_margin, "bandwidth": found.bandwidth}
    for name, values in dense.items():
        rows = metrics[name].values()
        cases = slice(0, 1) if name == "dynamic_stiffness" else slice(None)
        least = min(np.min(row[cases]) for row in rows)
        assert np.min(values) >= least - 0.02 * abs(least), name


def test_the_weakest_position_is_the_least_of_a_dense_grid(subject_of):
    """Per chamber and in both published topologies, the position found is the softest."""
    for topology in ("per_chamber", "aalto_as_published", "elasswad_as_published"):
        subject = subject_of("closed", **{"stiffness.topology": topology})
        done = compute(subject, subject.values())
        budget, stroke = done.springs, done.geometry.stroke
        grid = np.linspace(1e-6, 1 - 1e-6, 4001).reshape(-1, 1, 1) * stroke
        with np.errstate(divide="ignore"):  # a chamber without this cause
            least = np.min(budget.stiffness(grid), axis=0)
            found = budget.stiffness(weakest(budget))
        np.testing.assert_allclose(found, least, rtol=1e-6)
        assert done.computed.metrics["stiffness_min"][""] == pytest.approx(found)


def test_a_bare_piston_leaks_through_its_gap(subject_of):
    """Without piston seals pi D h^3/(12 eta L) joins the stated leakage, h grown with the bore.

    The leakage told is that of the moving piston, and the same conductance damps the load.
    """
    bare = subject_of(**{"seals.piston.count": 0})
    done = compute(bare, bare.values())
    g, s = done.geometry, done.state
    growths = done.computed.metrics["growth_at_seal"].values()
    grown = 30e-6 + np.maximum(*(np.broadcast_to(growth, (2, 1)) for growth in growths))
    eta = 0.5 * (s.dynamic_viscosity_a + s.dynamic_viscosity_b)
    gap = math.pi * g.bore * grown**3 / (12 * eta * g.piston_length)
    expected = (gap + 1e-11 / 60) * np.abs(s.moving_a - s.moving_b)
    np.testing.assert_allclose(done.computed.metrics["leakage"][""], expected, rtol=1e-9)
    np.testing.assert_allclose(done.motion.leakage, gap + 1e-11 / 60, rtol=1e-9)
