"""Claims about modes, ultimate gain, margins and bandwidth of the position loop.

python-control's state space of `circuit_oracle` is the judge: eigenvalues of the closed loop,
its own margins and bandwidth.
"""

from __future__ import annotations

import math

import control
import numpy as np
import pytest
from circuit_oracle import closed, in_milliseconds, load_damping, plant, random_circuit
from hypothesis import assume, given, strategies as st
from samples_dynamics import DRIVEN, bare, loop_of, model_of
from test_models_hydraulics_dynamics import CHAMBERS
from test_models_valve import LEAKAGE, RATED

from actuator_opt.models import holding_valve, linear, loop
from actuator_opt.models.line_ends import LineEnd, reducing_valve_end
from actuator_opt.models.linear import Side

SEEDS = st.integers(0, 2**32 - 1)
SPOOLS = st.tuples(st.floats(20.0, 500.0), st.floats(0.3, 1.1))
STEP = 1e-30


def opened(circuit, spool):
    """Our open loop of a circuit with a spool."""
    return loop.open_loop(
        model=model_of(circuit), natural_frequency=spool[0], damping_ratio=spool[1]
    )


def growth(open_plant, gain):
    """Closed-loop eigenvalues at a gain."""
    return np.linalg.eigvals(open_plant.A - gain * open_plant.B @ open_plant.C)


# --- ultimate gain -------------------------------------------------------------------------------


@given(SEEDS, SPOOLS)
def test_ultimate_gain_is_where_the_closed_loop_begins_to_grow(seed, spool):
    """A pole lies on the axis at K_u, none is unstable at 0.999 K_u or below, one at 1.001 K_u."""
    circuit = random_circuit(seed, driven=True)
    limit, judge = loop.ultimate_gain(loop=opened(circuit, spool)), plant(circuit, *spool)
    if limit.gain == 0:  # every gain grows, if slowly
        assert np.max(growth(judge, 1.0).real) > 0
        return
    assume(np.isfinite(limit.gain))
    omega = 2 * np.pi * limit.frequency
    at_limit = growth(judge, limit.gain)
    assert np.min(np.abs(at_limit - 1j * omega)) < 1e-6 * omega
    assert np.max(growth(judge, 1.001 * limit.gain).real) > 0
    for gain in limit.gain * np.append(np.geomspace(1e-6, 0.99, 25), 0.999):
        poles = growth(judge, gain)
        assert np.max(poles.real) < 1e-11 * np.max(np.abs(poles))


def check_loop(frequency):
    """32/18-160 of PHYSICS at mid-stroke: 140 bar, both chambers at 70 bar, U > 0."""
    slopes = holding_valve.valve_slopes(
        rated_coefficient=RATED, leakage_coefficient=LEAKAGE, signal=10.0, supply_pressure=14e6,
        return_pressure=0.0, pressure_a=7e6, pressure_b=7e6, extending=True,
    )  # fmt: skip
    ends = {
        "a": {"end": LineEnd((slopes.conductance_a,)), "flow_gain": slopes.gain_a},
        "b": {"end": LineEnd((slopes.conductance_b,)), "flow_gain": -slopes.gain_b},
    }
    sides = {
        f"side_{c}": Side(CHAMBERS[f"area_{c}"], CHAMBERS[f"compliance_{c}"], **ends[c])
        for c in "ab"
    }
    model = linear.linear_actuator(**sides, mass=30.0, damping=400.0)
    return loop.open_loop(model=model, natural_frequency=frequency, damping_ratio=0.7)


@pytest.mark.parametrize(
    ("frequency", "gain", "period"), [(250.0, 416.743, 7.7584e-3), (400.0, 333.220, 7.6671e-3)]
)
def test_ultimate_gain_check_values(frequency, gain, period):
    """A slower spool gives the higher ultimate gain: 416.743 at 250 Hz, 333.220 V/m at 400 Hz."""
    limit = loop.ultimate_gain(loop=check_loop(frequency))
    assert limit.gain == pytest.approx(gain, abs=6e-4)
    assert 1 / limit.frequency == pytest.approx(period, abs=6e-8)


@pytest.mark.parametrize(("omega", "zeta", "velocity"), [(800.0, 0.02, 3.0), (50.0, 0.9, 0.1)])
def test_ultimate_gain_of_the_textbook_servo(omega, zeta, velocity):
    """Integrator and one oil pair, [Merritt1967]: K_u = 2 zeta omega/K_v, swinging at omega."""
    textbook = loop.PositionOpenLoop((velocity,), (0.0, 1.0, 2 * zeta / omega, 1 / omega**2))
    limit = loop.ultimate_gain(loop=textbook)
    assert limit.gain == pytest.approx(2 * zeta * omega / velocity, rel=1e-9)
    assert limit.frequency == pytest.approx(omega / (2 * math.pi), rel=1e-9)


def test_an_unstable_actuator_has_no_gain():
    """Falling friction beyond what the leakage damps: K_u = 0 and no frequency."""
    limit = loop.ultimate_gain(loop=loop_of(**{**DRIVEN, "damping": -4000.0}))
    assert limit.gain == 0
    assert np.isnan(limit.frequency)
    assert loop.load_mode(model=bare(**{**DRIVEN, "damping": -4000.0}))[1] < 0


@pytest.mark.parametrize("number", [float, lambda value: np.array([value])], ids=["one", "array"])
def test_a_valve_without_leakage_still_has_a_limit(number):
    """Oil shut in leaves a pole at zero that does no harm: the limit of ever less leakage."""
    tight = {**DRIVEN, "leakage": 0.0, "valve_a": 0.0, "valve_b": 0.0}
    almost = {**tight, "valve_a": 1e-19, "valve_b": 1e-19}
    limit, near = (
        loop.ultimate_gain(loop=loop_of(**{key: number(value) for key, value in case.items()}))
        for case in (tight, almost)
    )
    assert limit.gain > 100
    np.testing.assert_allclose(limit, near, rtol=1e-6)
    one = loop.margins(loop=loop_of(**{k: number(x) for k, x in tight.items()}), gain=100.0)
    two = loop.margins(loop=loop_of(**{k: number(x) for k, x in almost.items()}), gain=100.0)
    np.testing.assert_allclose(one, two, rtol=1e-6)


@pytest.mark.parametrize("number", [float, lambda value: np.array([value])], ids=["one", "array"])
def test_a_position_that_runs_backwards_has_no_gain(number):
    """More out of B than into A across a leaking piston: the load creeps the wrong way; K_u = 0.

    The valve's reversed sign is such a case too.
    """
    leaking = {**DRIVEN, "valve_a": 0.0, "valve_b": 0.0, "gain_a": 0.5e-5}
    reversed_sign = {**DRIVEN, "gain_a": -1e-5, "gain_b": -1e-5}
    for case in (leaking, reversed_sign):
        limit = loop.ultimate_gain(loop=loop_of(**{k: number(x) for k, x in case.items()}))
        assert limit.gain == 0


def test_loops_without_a_crossing():
    """An integrator alone never swings, nor does a valve without flow; a NaN is never infinite."""
    limit = loop.ultimate_gain(loop=loop.PositionOpenLoop((1.0,), (0.0, 1.0)))
    assert limit.gain == math.inf
    assert np.isnan(limit.frequency)
    for number in (float, lambda value: np.array([value])):
        still = loop_of(**{k: number(x) for k, x in DRIVEN.items()} | {
            "gain_a": number(0.0), "gain_b": number(0.0),
        })  # fmt: skip
        assert loop.ultimate_gain(loop=still).gain == math.inf
        margins = loop.margins(loop=still, gain=10.0)
        assert (margins.phase_margin, margins.bandwidth) == (math.inf, 0.0)
        assert np.isnan(margins.crossover)
        for key in ("gain_a", "damping", "compliance_b"):
            broken = loop_of(**{k: number(x) for k, x in DRIVEN.items()} | {key: number(math.nan)})
            assert np.isnan(loop.ultimate_gain(loop=broken)).all()
            assert np.isnan(loop.margins(loop=broken, gain=10.0)).all()


def test_one_edge_without_flow_keeps_its_limit():
    """A line on A alone and an array whose second design has no flow through the edge at B.

    The leading coefficient of the crossings then vanishes in that design only.
    """
    gain_b = np.array([-1e-5, 0.0])

    def of(gain_a, gain_b):
        line = {"resistance": 4e8, "inertance": 1.5e7, "far_compliance": 3e-14}
        model = linear.linear_actuator(
            side_a=Side(8e-4, 5e-14, **line, end=LineEnd((1e-12,)), flow_gain=gain_a),
            side_b=Side(5e-4, 4e-14, end=LineEnd((1e-12,)), flow_gain=gain_b),
            mass=30.0, damping=400.0,
        )  # fmt: skip
        return loop.open_loop(model=model, natural_frequency=250.0, damping_ratio=0.7)

    for gain_a in (1e-5, np.array([1e-5, 0.0])):
        together = loop.ultimate_gain(loop=of(gain_a, gain_b))
        alone = loop.ultimate_gain(loop=of(1e-5, 0.0 if np.ndim(gain_a) == 0 else -0.0))
        if np.ndim(gain_a) == 0:
            assert together.gain[1] == pytest.approx(alone.gain, rel=1e-9)
        else:
            assert together.gain[1] == math.inf
    swapped = loop.ultimate_gain(loop=of(np.array([1e-5, 0.0]), -1e-5))
    assert swapped.gain[1] == pytest.approx(loop.ultimate_gain(loop=of(0.0, -1e-5)).gain, rel=1e-9)


# --- margins and bandwidth -----------------------------------------------------------------------


@given(SEEDS, SPOOLS)
def test_margins_and_bandwidth_are_those_of_python_control(seed, spool):
    """At half the ultimate gain: gain margin 2, phase margin, crossover and -3 dB of control."""
    circuit = random_circuit(seed, driven=True)
    one, judge = opened(circuit, spool), in_milliseconds(plant(circuit, *spool))
    gain = 0.5 * loop.ultimate_gain(loop=one).gain
    assume(0 < gain < math.inf)
    ours = loop.margins(loop=one, gain=gain)
    gains, phases, _, _, crossings, _ = control.stability_margins(gain * judge, returnall=True)
    assert np.min(gains[gains > 1]) == pytest.approx(2, rel=1e-5)
    least = np.argmin(np.abs(phases))
    assert ours.phase_margin == pytest.approx(np.radians(abs(phases[least])), rel=1e-5)
    if np.sum(np.abs(phases) < 1.0001 * abs(phases[least])) == 1:
        assert ours.crossover == pytest.approx(crossings[least] * 1e3 / (2 * np.pi), rel=1e-5)
    whole = closed(judge, gain)
    half_power = -10 * math.log10(2)
    width = control.bandwidth(whole, dbdrop=half_power) * 1e3 / (2 * np.pi)
    if ours.bandwidth != pytest.approx(width, rel=1e-5):  # a dip narrower than control's grid
        before, at = np.abs(whole(2e-3j * np.pi * ours.bandwidth * np.array([1 - 1e-6, 1.0])))
        assert ours.bandwidth < width
        assert at == pytest.approx(abs(whole(0)) * math.sqrt(0.5), rel=1e-5)
        assert before > at


def test_phase_margin_vanishes_at_the_ultimate_gain():
    """At K_u the crossover is where the loop swings and the margin is nothing."""
    one = check_loop(250.0)
    limit = loop.ultimate_gain(loop=one)
    found = loop.margins(loop=one, gain=limit.gain)
    assert found.phase_margin == pytest.approx(0, abs=1e-6)
    assert found.crossover == pytest.approx(limit.frequency, rel=1e-6)


def test_slow_loops_follow_the_closed_forms():
    """A gain far below the oil: crossover and bandwidth tend to K K_v/(2 pi), margin to 90 deg."""
    velocity = 0.02
    one = loop.PositionOpenLoop((velocity,), (0.0, 1.0, 1e-4, 1e-6))
    found = loop.margins(loop=one, gain=50.0)
    assert found.crossover == pytest.approx(1 / (2 * math.pi), rel=1e-4)
    assert found.bandwidth == pytest.approx(1 / (2 * math.pi), rel=1e-3)
    assert found.phase_margin == pytest.approx(math.pi / 2, rel=1e-3)


# --- modes ---------------------------------------------------------------------------------------


@given(SEEDS)
def test_the_load_mode_is_that_of_the_state_space(seed):
    """The least ratio of all pairs, each with its share of the load's motion, by eigenvectors."""
    circuit = random_circuit(seed)
    ratio = loop.load_mode(model=model_of(circuit)).damping_ratio
    assume(np.isfinite(ratio))
    assert ratio == pytest.approx(load_damping(circuit), rel=1e-4, abs=1e-6)


@given(SEEDS)
def test_the_damping_ratio_has_no_jump(seed):
    """Between two circuits of the same elements: no step of the ratio outlasts a halving."""
    random = np.random.default_rng(seed)
    ends = [_other(random_circuit(seed, driven=True), random) for _ in range(2)]

    def at(share):
        return loop.load_mode(model=model_of(_between(*ends, share))).damping_ratio

    shares = np.linspace(0, 1, 201)
    ratios = at(shares)
    assert not np.isnan(ratios).any()
    ratios = np.minimum(ratios, 2.0)
    step = int(np.argmax(np.abs(np.diff(ratios))))
    low, high = shares[step : step + 2]
    for _ in range(27):
        middle = 0.5 * (low + high)
        left, half, right = np.minimum(at(np.array([low, middle, high])), 2.0)
        low, high = (middle, high) if abs(half - left) < abs(right - half) else (low, middle)
    left, right = np.minimum(at(np.array([low, high])), 2.0)
    assert abs(right - left) < 1e-3


def _other(value, random):
    """The circuit with each number changed at random by up to a factor of 1.6."""
    if isinstance(value, dict):
        return {key: _other(part, random) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(_other(part, random) for part in value)
    return value * np.exp(random.uniform(-0.5, 0.5)) if isinstance(value, float) else value


def _between(one, two, share):
    """A circuit on the straight line between two."""
    if isinstance(one, dict):
        return {key: _between(one[key], two[key], share) for key in one}
    if isinstance(one, list | tuple):
        return type(one)(_between(*pair, share) for pair in zip(one, two, strict=True))
    if isinstance(one, float) and (one or two):
        return one * (1 - share) + two * share
    return one


def side_of(conductance, compliance=5e-14, **more):
    """A chamber of 5 cm2 with a conductance at its port."""
    return Side(5e-4, compliance, end=LineEnd((conductance,)), **more)


def test_a_chamber_that_leaks_fast_leaves_the_load_on_the_other():
    """Port A so open that its oil gives no spring: the load swings on chamber B alone, damped by A.

    m s^2 + (A^2/G_A) s + k_B with k_B = A^2/C_B. Between open and closed no design lacks a ratio.
    """
    k, open_port = (5e-4) ** 2 / 5e-14, 5e-10
    model = linear.linear_actuator(
        side_a=side_of(open_port), side_b=Side(5e-4, 5e-14), mass=10.0, damping=0.0
    )
    mode = loop.load_mode(model=model)
    assert mode.natural_frequency == pytest.approx(math.sqrt(k / 10) / (2 * math.pi), rel=5e-3)
    ratio = (5e-4) ** 2 / open_port / (2 * math.sqrt(k * 10))
    assert mode.damping_ratio == pytest.approx(ratio, rel=2e-2)
    ports = np.geomspace(1e-13, 1e-8, 4001)
    both = linear.linear_actuator(
        side_a=side_of(ports), side_b=side_of(1e-12), mass=10.0, damping=20.0,
        flexibility=0.0 * ports,
    )  # fmt: skip
    ratios = loop.load_mode(model=both).damping_ratio
    assert np.all(ratios > 0)
    assert np.max(np.abs(np.diff(ratios))) < 0.01


@pytest.mark.parametrize(("frequency", "conductance"), [(3e5, 2e-12), (1e-3, 0.0)])
def test_a_regulating_valve_far_from_the_load_is_a_conductance_or_closed(frequency, conductance):
    """A valve much faster than the load damps it as its conductance; a much slower one not at all.

    Its own pair of poles, in which the load takes no part, does not count.
    """
    regulating = reducing_valve_end(
        conductance=2e-12, natural_frequency=frequency, damping_ratio=0.01
    )
    valve, plain = (
        linear.linear_actuator(
            side_a=Side(5e-4, 5e-14, end=end), side_b=Side(5e-4, 5e-14), mass=10.0, damping=400.0
        )
        for end in (regulating, LineEnd((conductance,)))
    )
    judge = loop.load_mode(model=plain)
    np.testing.assert_allclose(loop.load_mode(model=valve), judge, rtol=1e-3)


def test_an_overdamped_load_beside_a_line_that_oscillates():
    """The load creeps and the oil in a line oscillates: the ratio is 1, not that of the line."""
    line = {"resistance": 1e8, "inertance": 1e7, "far_compliance": 1e-14}
    model = linear.linear_actuator(
        side_a=Side(5e-4, 5e-14, **line), side_b=Side(5e-4, 5e-14), mass=10.0, damping=3e5
    )
    poles = loop.poles(model=model)
    pair = poles[poles.imag > 0]
    assert len(pair) == 1
    assert -pair.real / abs(pair) < 0.01
    assert loop.load_mode(model=model).damping_ratio == pytest.approx(1, abs=0.01)


def test_slopes_of_the_damping_ratio():
    """Complex steps are the slopes for two real poles and for a pair that counts in part, too."""
    line = {"resistance": 2e9, "inertance": 1.5e7, "far_compliance": 2e-14}

    def ratio(port, damping=50.0, **line):
        model = linear.linear_actuator(
            side_a=side_of(port, 2e-14, **line), side_b=side_of(2e-12), mass=10.0, damping=damping,
            flexibility=3e-9,
        )  # fmt: skip
        return loop.load_mode(model=model).damping_ratio

    for port, more in ((1e-12, {}), (4e-11, {"damping": 4e4}), (1e-12, {"damping": 4e4, **line})):
        slope = ratio(port * (1 + 1j * STEP), **more).imag / STEP
        difference = (ratio(port * (1 + 1e-5), **more) - ratio(port * (1 - 1e-5), **more)) / 2e-5
        assert slope == pytest.approx(difference, rel=1e-5)


def test_modes_of_one_spring_and_one_damper():
    """Of m s^2 + B s + k: under-damped, critical, over-damped and growing, by the closed form."""
    side = Side(5e-4, 5e-14)
    for ratio in (0.0, 0.05, 1.0, 1.7, -0.2):
        damping = 2 * ratio * math.sqrt(1e7 * 10.0)
        model = linear.linear_actuator(side_a=side, side_b=side, mass=10.0, damping=damping)
        mode = loop.load_mode(model=model)
        assert mode.natural_frequency == pytest.approx(1000 / (2 * math.pi), rel=1e-9)
        assert mode.damping_ratio == pytest.approx(ratio, rel=1e-6, abs=1e-12)


def test_a_load_that_nothing_holds():
    """At a constant pressure without a line no oil holds the load: 0 Hz, infinitely damped."""
    free = Side(5e-4, 5e-14, end=LineEnd((1.0,), ()))
    model = linear.linear_actuator(side_a=free, side_b=free, mass=10.0, damping=100.0)
    assert loop.load_mode(model=model) == (0.0, math.inf)
    np.testing.assert_allclose(loop.poles(model=model), [-10.0])


def test_an_unknown_frequency_has_no_mode():
    """NaN in, NaN out."""
    broken = bare(**{**DRIVEN, "damping": math.nan})
    assert np.isnan(loop.load_mode(model=broken)).all()


def test_poles_of_arrays_are_those_of_each_design():
    """Columns, copies and complex steps give the roots of the real designs."""
    masses = np.array([[5.0], [30.0]]) * np.ones(3)
    found = loop.poles(model=bare(**{**DRIVEN, "mass": masses + 1j * STEP}))
    for row, mass in enumerate((5.0, 30.0)):
        one = loop.poles(model=bare(**{**DRIVEN, "mass": mass}))
        for column in range(3):
            np.testing.assert_allclose(
                np.sort_complex(found[row, column]), np.sort_complex(one), rtol=1e-9
            )


# --- gradients -----------------------------------------------------------------------------------


def figures(circuit, spool, gain):
    """Every figure of a driven circuit as one list."""
    one = opened(circuit, spool)
    limit = loop.ultimate_gain(loop=one)
    mode = loop.load_mode(model=model_of(circuit))
    margins = loop.margins(loop=one, gain=gain)
    return [*limit, *mode, *margins]


@given(SEEDS, SPOOLS)
@pytest.mark.long
def test_gradients_of_random_circuits(seed, spool):
    """The complex step of every figure is its slope, over mass, damping, oil, valve and rod."""
    circuit = random_circuit(seed, driven=True)
    limit = loop.ultimate_gain(loop=opened(circuit, spool)).gain
    assume(0 < limit < math.inf)
    asked = {"gain": 0.4 * limit}
    values = np.array(figures(circuit, spool, **asked))
    for path in ("mass", "damping", "a.compliance", "b.area", "b.flow_gain", "a.far_compliance"):

        def at(factor, path=path):
            changed = {**circuit, "a": dict(circuit["a"]), "b": dict(circuit["b"])}
            home = changed[path[0]] if "." in path else changed
            home[path.split(".")[-1]] = home[path.split(".")[-1]] * factor
            return np.array(figures(changed, spool, **asked))

        slope = at(1 + 1j * STEP).imag / STEP
        step = 1e-5
        differences = [(at(1 + h) - at(1 - h)) / (2 * h) for h in (step, 2 * step)]
        smooth = np.abs(differences[0] - differences[1]) < 1e-5 * np.abs(values)
        error = np.abs(slope - differences[0])
        assert np.all(error[smooth] <= 1e-4 * np.abs(values[smooth]) + 1e-9)
        assert smooth.sum() >= 5
