"""Claims about the figures of sampled responses and about harmonic fits of records."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.base.errors import InputError
from actuator_opt.simulation.harmonic import dynamic_stiffness_of_record, harmonic_fit, windows
from actuator_opt.simulation.linear import step_metrics

TIME = np.linspace(0.0, 2.0, 20001)


def first_order(time, constant):
    """Unit step response of a lag."""
    return 1 - np.exp(-time / constant)


def second_order(time, omega, zeta):
    """Unit step response of an underdamped pair of poles."""
    damped = omega * math.sqrt(1 - zeta**2)
    swing = np.cos(damped * time) + zeta * omega / damped * np.sin(damped * time)
    return 1 - np.exp(-zeta * omega * time) * swing


@given(st.floats(0.02, 0.3), st.floats(-50.0, 50.0), st.floats(0.1, 20.0), st.booleans())
def test_first_order_closed_form(constant, start, size, down):
    """Rise ln 9 tau, settling ln 50 tau, no overshoot: any start, size and direction."""
    step = -size if down else size
    response = start + step * first_order(TIME, constant)
    found = step_metrics(time=TIME, response=response, start=start, target=start + step)
    assert found.rise_time == pytest.approx(math.log(9) * constant, rel=1e-4)
    assert found.settling_time == pytest.approx(math.log(50) * constant, rel=1e-4)
    assert found.overshoot == pytest.approx(0.0, abs=1e-13 * (1 + abs(start) / size))
    tail = TIME >= 1.8
    assert found.steady_state_error == pytest.approx(
        step * np.trapezoid(np.exp(-TIME[tail] / constant), TIME[tail]) / 0.2,
        rel=1e-6,
        abs=1e-12 * (abs(start) + size),
    )


@given(st.floats(20.0, 80.0), st.floats(0.15, 0.9), st.booleans())
def test_second_order_closed_form(omega, zeta, down):
    """Overshoot e^(-pi zeta/sqrt(1 - zeta^2)) at half a period; each swing keeps it squared."""
    sign = -1.0 if down else 1.0
    response = sign * second_order(TIME, omega, zeta)
    found = step_metrics(time=TIME, response=response, start=0.0, target=sign)
    root = math.sqrt(1 - zeta**2)
    overshoot = math.exp(-math.pi * zeta / root)
    assert found.overshoot == pytest.approx(overshoot, rel=1e-5, abs=1e-8)
    assert found.peak == pytest.approx(sign * (1 + overshoot), rel=1e-5)
    assert found.peak_time == pytest.approx(math.pi / (omega * root), abs=1e-4)
    assert found.decay == pytest.approx(overshoot**2, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize("zeta", [0.15, 0.3, 0.5, 0.7])
def test_second_order_settles_where_its_error_last_passes_the_band(zeta):
    """The last root of |error| = 2 %, found by bisection from the extremes of the closed form."""
    omega, root = 40.0, math.sqrt(1 - zeta**2)
    swings = [(k, math.exp(-math.pi * k * zeta / root)) for k in range(60)]
    last = max(k for k, size in swings if size > 0.02)
    low, high = (k * math.pi / (omega * root) for k in (last, last + 1))
    for _ in range(60):
        middle = 0.5 * (low + high)
        outside = abs(second_order(np.array(middle), omega, zeta) - 1) > 0.02
        low, high = (middle, high) if outside else (low, middle)
    found = step_metrics(time=TIME, response=second_order(TIME, omega, zeta), start=0.0, target=1.0)
    assert found.settling_time == pytest.approx(low, rel=1e-5)


def test_straight_lines_are_exact():
    """A ramp to the target on five samples: rise 0.8 s, settled at 0.98 s, between samples."""
    time = [5.0, 5.4, 5.4, 6.0, 9.0]
    response = [2.0, 3.6, 3.6, 6.0, 6.0]
    found = step_metrics(time=time, response=response, start=2.0, target=6.0)
    assert found.rise_time == pytest.approx(0.8, rel=1e-12)
    assert found.settling_time == pytest.approx(0.98, rel=1e-12)
    assert found[2:] == (0.0, 0.0, 6.0, 1.0, None)


def test_what_does_not_happen_is_none():
    """Never at 90 %: no rise; beside the target, or still swinging: an error but no settling."""
    short = step_metrics(time=TIME, response=0.85 * first_order(TIME, 0.1), start=0.0, target=1.0)
    assert (short.rise_time, short.settling_time, short.decay) == (None, None, None)
    assert short.steady_state_error == pytest.approx(0.15, rel=1e-6)
    beside = step_metrics(time=TIME, response=0.97 * first_order(TIME, 0.1), start=0.0, target=1.0)
    assert beside.rise_time is not None
    assert beside.settling_time is None
    inside = step_metrics(time=TIME, response=0.99 * first_order(TIME, 0.1), start=0.0, target=1.0)
    assert inside.settling_time == pytest.approx(0.1 * math.log(0.99 / 0.01), rel=1e-4)
    hunting = first_order(TIME, 0.1) + 0.03 * np.sin(40 * TIME)
    found = step_metrics(time=TIME, response=hunting, start=0.0, target=1.0)
    assert found.settling_time is None
    away = step_metrics(time=TIME, response=-TIME, start=0.0, target=1.0)
    assert (away.rise_time, away.overshoot, away.peak, away.peak_time) == (None, 0.0, 0.0, 0.0)


def test_a_wider_band_settles_sooner():
    """5 % of a lag: ln 20 tau."""
    found = step_metrics(
        time=TIME, response=first_order(TIME, 0.1), start=0.0, target=1.0, band=0.05
    )
    assert found.settling_time == pytest.approx(0.1 * math.log(20), rel=1e-4)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"target": 0.0}, "a step from 0 to 0; give different values for start and target"),
        ({"band": 0.0}, "settling band 0 of the step; give one between 0 and 1"),
        ({"response": [0.0, 1.0]}, r"response has shape \(2,\), but time has shape \(3,\)"),
        ({"response": [0.0, math.nan, 1.0]}, "response of sample 1 is nan; remove the sample"),
        ({"time": [0.0, 2.0, 1.0]}, "time decreases after sample 1; sort the samples"),
        ({"time": [1.0, 1.0, 1.0]}, "time does not advance; give samples over a longer time"),
        ({"time": [1.0], "response": [1.0]}, "1 samples; give 2 or more"),
    ],
)
def test_records_that_are_none_are_one_clear_line(changes, line):
    """What, where and the remedy."""
    good = {"time": [0.0, 1.0, 2.0], "response": [0.0, 1.0, 1.0], "start": 0.0, "target": 1.0}
    with pytest.raises(InputError, match=f"^{line}"):
        step_metrics(**{**good, **changes})


@given(
    st.floats(-1e3, 1e3), st.floats(0.5, 40.0), st.floats(-math.pi, math.pi), st.floats(-5.0, 5.0),
    st.floats(-1.0, 1.0), st.integers(1, 60),
)  # fmt: skip
def test_a_drifting_sine_is_recovered(begin, frequency, phase, mean, slope, share):
    """Mean, slope, amplitude and phase to rounding, over cycles that need not be whole."""
    time = begin + np.linspace(0.0, (1 + share / 7) / frequency, 400)
    middle = 0.5 * (time[0] + time[-1])
    rate = slope * frequency
    values = mean + rate * (time - middle) + 0.3 * np.cos(2 * np.pi * frequency * time + phase)
    fit = harmonic_fit(time=time, values=values, frequency=frequency)
    assert abs(fit.amplitude - 0.3 * np.exp(1j * phase)) < 1e-9
    assert fit.mean == pytest.approx(mean, abs=1e-9)
    assert fit.slope == pytest.approx(rate, abs=1e-8 * frequency)
    assert fit.residual < 1e-10


def test_detrending_first_loses_six_over_pi_n_squared():
    """Over n cycles a line fitted first takes 6/(pi n)^2 of a sine, none of a cosine: 2.4 % of 5.

    The record runs about t = 0, the sine odd there: its line has the slope
    -12 (-1)^n/(w T^2), and that line has the fundamental -24/(w T)^2 of the sine.
    """
    for cycles in (3, 5, 8):
        time = (np.arange(2000 * cycles) + 0.5) / 2000 - 0.5 * cycles
        basis = np.exp(-2j * np.pi * time)
        for phase, expected in ((-np.pi / 2, 6 / (np.pi * cycles) ** 2), (0.0, 0.0)):
            swing = np.cos(2 * np.pi * time + phase)
            record = 7 - 0.4 * time + swing
            straight = record - np.polyval(np.polyfit(time, record, 1), time)
            fourier = 2 * abs(np.mean(straight * basis))
            assert 1 - fourier == pytest.approx(expected, abs=1e-6)
            fit = harmonic_fit(time=time, values=record, frequency=1.0)
            assert abs(fit.amplitude) == pytest.approx(1.0, rel=1e-12)
    assert 6 / (np.pi * 5) ** 2 == pytest.approx(0.025, abs=1e-3)


def test_standard_error_is_the_scatter_of_the_amplitude():
    """Noise of 0.1 on 400 samples: sqrt(2/400) 0.1 each part, as 600 repeated records scatter."""
    draw = np.random.default_rng(7)
    time = np.arange(400) / 100
    clean = np.sin(2 * np.pi * 5 * time)
    fits = [
        harmonic_fit(time=time, values=clean + 0.1 * draw.standard_normal(400), frequency=5.0)
        for _ in range(600)
    ]
    parts = np.array([(fit.amplitude.real, fit.amplitude.imag) for fit in fits])
    told = np.mean([fit.standard_error for fit in fits])
    assert told == pytest.approx(0.1 * math.sqrt(2 / 400), rel=0.01)
    assert np.std(parts, axis=0) == pytest.approx([told, told], rel=0.1)
    assert np.mean([fit.residual for fit in fits]) == pytest.approx(0.1, rel=0.01)


@given(st.floats(1.0, 40.0), st.floats(1e-5, 1e-3), st.floats(-3.0, 3.0), st.floats(-1e-3, 1e-3))
def test_stiffness_of_a_spring_and_damper(frequency, amplitude, phase, drift):
    """F = k x + b v + mean and drift of its own: k + i w b, the force leads."""
    time = np.linspace(0.0, 5.2 / frequency, 900)
    omega = 2 * np.pi * frequency
    angle = omega * time + phase
    force = 2e7 * amplitude * np.cos(angle) - 4e4 * omega * amplitude * np.sin(angle)
    found = dynamic_stiffness_of_record(
        time=time, position=0.08 + drift * time + amplitude * np.cos(angle),
        force=force - 3e3 + 50 * time, frequency=frequency,
    )  # fmt: skip
    expected = 2e7 + 4e4j * omega
    assert abs(found.stiffness - expected) < 1e-8 * abs(expected)
    assert found.stiffness.imag > 0
    assert found.standard_error < 1e-8 * abs(expected)


def test_standard_error_of_the_stiffness_is_its_scatter():
    """Noise on position and force adds in quadrature, as 400 repeated records scatter."""
    draw = np.random.default_rng(11)
    time = np.arange(500) / 500
    swing = np.sin(2 * np.pi * 10 * time)
    found = [
        dynamic_stiffness_of_record(
            time=time, position=1e-4 * swing + 5e-6 * draw.standard_normal(500),
            force=2e3 * swing + 80 * draw.standard_normal(500), frequency=10.0,
        )
        for _ in range(400)
    ]  # fmt: skip
    parts = np.array([(k.stiffness.real, k.stiffness.imag) for k in found])
    told = np.mean([k.standard_error for k in found])
    expected = 2e7 * math.sqrt(2 / 500) * math.hypot(5e-6 / 1e-4, 80 / 2e3)
    assert told == pytest.approx(expected, rel=0.02)
    assert np.std(parts, axis=0) == pytest.approx([told, told], rel=0.1)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (
            {"position": np.full(101, 0.08)},
            "the position does not oscillate at 5 Hz; give",
        ),
        (
            {"frequency": 0.4},
            "a record of 1 s is shorter than one cycle of 0.4 Hz; give a longer record",
        ),
        (
            {"frequency": -5.0},
            "a record of 1 s is shorter than one cycle of -5 Hz; give a longer record",
        ),
        (
            {"frequency": 50.0},
            "samples every 0.01 s do not resolve 50 Hz; give more than two samples",
        ),
        (
            {"force": np.zeros(100)},
            r"force has shape \(100,\), but time has shape \(101,\); give one number",
        ),
    ],
)
def test_records_without_that_swing_are_one_clear_line(changes, line):
    """What, where and the remedy, never a number from nothing."""
    time = np.linspace(0.0, 1.0, 101)
    swing = np.sin(2 * np.pi * 5 * time)
    good = {"time": time, "position": swing, "force": swing, "frequency": 5.0}
    with pytest.raises(InputError, match=f"^{line}"):
        dynamic_stiffness_of_record(**{**good, **changes})


@given(st.integers(1, 4), st.integers(8, 60), st.integers(1, 7), st.floats(0.3, 30.0))
def test_windows_are_whole_cycles_that_join(cycles, per_cycle, count, frequency):
    """Each holds the same number of samples, the next begins where it ends, none is missing."""
    samples = cycles * per_cycle * count + per_cycle // 2
    time = 3.0 + np.arange(samples) / (per_cycle * frequency)
    found = windows(time=time, frequency=frequency, cycles=cycles)
    size = cycles * per_cycle
    assert found == tuple(slice(k * size, (k + 1) * size) for k in range(count))


def test_windows_of_a_stroke_show_its_stiffness():
    """A spring that stiffens along a slow stroke: each window gives its own value."""
    time = np.arange(40000) / 1000
    drift, swing = 0.1 * time / 40, 1e-4 * np.sin(2 * np.pi * 10 * time)
    force = (1e7 + 2e8 * drift) * swing
    pieces = windows(time=time, frequency=10.0, cycles=5)
    assert len(pieces) == 80
    for piece in pieces:
        found = dynamic_stiffness_of_record(
            time=time[piece], position=(drift + swing)[piece], force=force[piece], frequency=10.0
        )
        expected = 1e7 + 2e8 * np.mean(drift[piece])
        assert abs(found.stiffness) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("frequency", "cycles", "line"),
    [
        (1.0, 5, "a record of 2 s is shorter than 5 cycles of 1 Hz; take fewer cycles"),
        (
            1.0,
            0,
            "no windows of 0 cycles at 1 Hz exist; give a positive frequency and 1 cycle or more",
        ),
        (40.0, 1, "a window of 0.025 s contains fewer than 5 samples; take more cycles"),
    ],
)
def test_windows_that_do_not_fit_are_one_clear_line(frequency, cycles, line):
    """What, where and the remedy."""
    with pytest.raises(InputError, match=f"^{line}$"):
        windows(time=np.linspace(0.0, 2.0, 201), frequency=frequency, cycles=cycles)
