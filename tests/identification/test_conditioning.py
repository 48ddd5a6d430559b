"""Records of any quality become evenly sampled, filtered motion, or are refused in one line.

Expected values are closed forms of the Butterworth filter and of prescribed motions.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from scipy.signal import sosfilt

from actuator_opt.base.errors import InputError
from actuator_opt.identification.conditioning import condition, low_pass, pass_cutoff, zero_phase
from actuator_opt.identification.record import Record
from actuator_opt.identification.straight import spectrum

STEP = 1e-3


def butterworth(frequency, *, cutoff, order, step):
    """Gain of two Butterworth passes after the bilinear transform, 1/(1 + (w/w_c)^2n)."""
    ratio = math.tan(math.pi * frequency * step) / math.tan(math.pi * cutoff * step)
    return 1 / (1 + ratio ** (2 * order))


def cosine_parts(values, time, frequency):
    """In-phase and lagging amplitude of a sine of known frequency, by least squares."""
    turn = 2 * np.pi * frequency * time
    basis = np.stack([np.sin(turn), -np.cos(turn)], axis=1)
    return np.linalg.lstsq(basis, values, rcond=None)[0]


def filtered_sine(frequency, *, cutoff=30.0, order=4, step=STEP, compensated):
    """Gain and lag [s] that the zero-phase filter gives to a sine."""
    time = step * np.arange(round(6 / step))
    sections = low_pass(cutoff=cutoff, order=order, sample_time=step, compensated=compensated)
    values = zero_phase(sections, np.sin(2 * np.pi * frequency * time), reach=round(0.1 / step))
    inside = slice(round(1 / step), -round(1 / step))
    along, late = cosine_parts(values[inside], time[inside], frequency)
    return float(np.hypot(along, late)), math.atan2(late, along) / (2 * np.pi * frequency)


def made(
    seconds=10.0, step=STEP, *, seed=0, noise=(2.5e4, 2.5e4, 0.0), quantum=10e-6, hertz=0.4937
):
    """A record of a sine of position with pressures that step at its turns, and its truth."""
    rng = np.random.default_rng(seed)
    time = step * np.arange(round(seconds / step))
    turn = 2 * np.pi * hertz * time
    truth = {
        "p1": 5e6 + 2e6 * np.tanh(20 * np.cos(turn)),
        "p2": 5e5 + 0 * time,
        "x": 0.05 + 0.04 * np.sin(turn),
    }
    channels = {
        name: truth[name] + sigma * rng.standard_normal(time.size)
        for name, sigma in zip(truth, noise, strict=True)
    }
    if quantum:
        channels["x"] = quantum * np.round(channels["x"] / quantum)
    return Record(time, channels, "r.csv", first_line=2), truth


def but(record, **channels):
    """A record with other channels, or another time."""
    time = channels.pop("time", record.time)
    return dataclasses.replace(record, time=time, channels={**record.channels, **channels})


def kept(record, samples):
    """A record of some of its samples."""
    channels = {name: one[samples] for name, one in record.channels.items()}
    return dataclasses.replace(record, time=record.time[samples], channels=channels)


def error_of(motion, name, record, truth):
    """Largest deviation of a filtered channel from its filtered truth, away from the ends."""
    sections = low_pass(
        cutoff=motion.cutoff,
        order=motion.order,
        sample_time=motion.sample_time,
        compensated=motion.compensated,
    )
    clear = zero_phase(sections, truth[name], reach=100)
    worst = 0.0
    for piece in motion.pieces:
        apart = piece[name] - np.interp(piece.time, record.time, clear)
        worst = max(worst, float(np.max(np.abs(apart[piece.sound]))))
    return worst


def refusal(record, **choices):
    """The one line with which a record is refused."""
    with pytest.raises(InputError) as caught:
        condition(record, **choices)
    (one,) = caught.value.diagnostics
    assert one.file == "r.csv"
    assert one.remedy
    return str(one)


# The filter


@pytest.mark.parametrize(("frequency", "gain"), [(10, 0.999851), (20, 0.962921), (30, 0.5)])
def test_gain_of_two_passes(frequency, gain):
    """Two passes of order 4 at 30 Hz, 1 kHz: 0.999851 at 10 Hz, 0.962921 at 20 Hz, -6 dB at 30."""
    found, _ = filtered_sine(frequency, compensated=False)
    assert found == pytest.approx(gain, abs=1e-6)
    assert found == pytest.approx(butterworth(frequency, cutoff=30, order=4, step=STEP), abs=1e-7)


@pytest.mark.parametrize("order", [1, 2, 4, 6])
@pytest.mark.parametrize("step", [1e-5, 1e-3, 1e-2])
def test_compensated_gain_at_the_cutoff(order, step):
    """Both passes together are -3 dB at the cut-off, also close to the Nyquist frequency."""
    gain, _ = filtered_sine(30, order=order, step=step, compensated=True)
    assert gain == pytest.approx(math.sqrt(0.5), abs=1e-5)


@pytest.mark.parametrize(("order", "design"), [(4, 33.494), (2, 37.395)])
def test_design_frequency_of_each_pass(order, design):
    """Each pass is designed at f_c/(sqrt 2 - 1)^(1/2n): 33.494 Hz for n 4, 37.395 Hz for n 2."""
    assert pass_cutoff(cutoff=30, order=order) == pytest.approx(design, abs=5e-4)


def test_no_lag():
    """A sine of 1 Hz comes out with no lag; a single forward pass would delay it by 14 ms."""
    for compensated in (False, True):
        _, lag = filtered_sine(1, compensated=compensated)
        assert abs(lag) < 1e-6
    time = STEP * np.arange(6000)
    sections = low_pass(cutoff=30, order=4, sample_time=STEP, compensated=False)
    once = sosfilt(sections, np.sin(2 * np.pi * time))
    along, late = cosine_parts(once[2000:], time[2000:], 1)
    assert math.atan2(late, along) / (2 * np.pi) == pytest.approx(13.9e-3, abs=0.2e-3)


SIGNALS = arrays(float, 200, elements=st.floats(-1e3, 1e3))


@given(one=SIGNALS, other=SIGNALS, factor=st.floats(-10, 10))
def test_filter_is_linear_and_knows_no_direction(one, other, factor):
    """The filter of a sum is the sum of the filtered; a level passes, time may run either way."""
    sections = low_pass(cutoff=30, order=4, sample_time=STEP, compensated=True)

    def filtered(values):
        return zero_phase(sections, values, reach=100)

    together = filtered(one + factor * other)
    np.testing.assert_allclose(together, filtered(one) + factor * filtered(other), atol=1e-7)
    np.testing.assert_allclose(filtered(one + 7.0), filtered(one) + 7.0, atol=1e-7)
    middle = slice(80, 120)
    np.testing.assert_allclose(filtered(one[::-1])[::-1][middle], filtered(one)[middle], atol=150)


def test_forward_and_backward_are_the_same_away_from_the_ends():
    """A record read backwards is filtered to the same values."""
    values = np.random.default_rng(0).standard_normal(3000)
    sections = low_pass(cutoff=30, order=4, sample_time=STEP, compensated=True)
    back = zero_phase(sections, values[::-1], reach=100)[::-1]
    np.testing.assert_allclose(back[500:-500], zero_phase(sections, values, reach=100)[500:-500])


@pytest.mark.parametrize("step", [2e-2, 1e-3, 1e-4])
def test_derivatives_of_a_parabola(step):
    """Velocity and acceleration of even acceleration are exact but for the ends.

    Where a piece is sound the mirrored end leaves 3e-4 of a/f_c, five periods inside nothing.
    """
    time = step * np.arange(round(3 / step))
    record = Record(time, {"x": 0.01 + 0.02 * time - 0.3 * time**2}, "r.csv")
    motion = condition(record, cutoff=min(30.0, 0.1 / step))
    (piece,) = motion.pieces
    velocity = 0.02 - 0.6 * piece.time
    edge = round(5 / (motion.cutoff * step))
    assert piece.sound.sum() > 0.7 * time.size
    for here, part in ((piece.sound, 3e-4), (slice(edge, -edge), 1e-6)):
        error = np.abs(piece.velocity - velocity)[here]
        assert error.max() < part * 0.6 / motion.cutoff
        assert np.abs(piece.acceleration + 0.6)[here].max() < 50 * part * 0.6


# Spikes


def test_outliers_in_every_channel_leave_the_motion():
    """5 % outliers of any height in every channel change the filtered values by no more than noise.

    White noise s passes the filter as s sqrt(2 f_c dt); five of these, and the outliers that hide
    below the threshold of six deviations.
    """
    record, truth = made(60)
    rng = np.random.default_rng(1)
    stray = {}
    for name, values in record.channels.items():
        hit = rng.random(values.size) < 0.05
        height = np.ptp(truth[name]) + 1e6 * (name == "p2")
        stray[name] = np.where(hit, values + height * rng.uniform(-1, 1, values.size), values)
    record = but(record, **stray)
    motion = condition(record)
    passed = math.sqrt(2 * 30 * STEP)
    for name, noise in (("p1", 2.5e4), ("p2", 2.5e4), ("x", 10e-6)):
        assert motion.quality[name].spikes > 0.8 * 0.05 * record.time.size
        assert error_of(motion, name, record, truth) < 10 * noise * passed
    assert motion.quality["x"].resolution == pytest.approx(10e-6, rel=1e-9)
    assert motion.quality["p1"].noise == pytest.approx(2.5e4, rel=0.1)
    assert len(motion.pieces) == 1


@pytest.mark.parametrize("heights", [(1,), (1, -1), (1, 1), (0.5, 1, 0.5), (0.4, -1, 0.7, 0.3)])
def test_bursts_of_spikes_are_taken_out(heights):
    """Up to four stray samples side by side are spikes, of either sign, at rest and in motion."""
    record, truth = made()
    at = np.arange(150, 9800, 333)
    values = record["x"].copy()
    for k, height in enumerate(heights):
        values[at + k] += 0.03 * height
    motion = condition(but(record, x=values))
    assert motion.quality["x"].spikes >= len(heights) * at.size
    assert error_of(motion, "x", record, truth) < 5e-5


@pytest.mark.parametrize("lasts", [15, 25, 100])
def test_a_burst_of_garbage_is_cut_out(lasts):
    """Where a channel is noise as high as its range, for 15 to 100 ms, the record is cut."""
    record, truth = made(30)
    rng = np.random.default_rng(4)
    garbage = np.arange(record.time.size) % 3000 < lasts
    values = np.where(garbage, 0.05 + 0.05 * rng.uniform(-1, 1, garbage.size), record["x"])
    motion = condition(but(record, x=values))
    assert error_of(motion, "x", record, truth) < 3e-4
    assert sum(float(np.ptp(one.time)) for one in motion.pieces) > 28


def test_a_turn_of_pressure_is_no_spike():
    """A step, a fast ramp and a saw tooth of pressure lose nothing to the search for spikes."""
    rng = np.random.default_rng(0)
    time = STEP * np.arange(10_000)
    for wave in (
        np.sign(np.sin(20 * time)),
        (time % 0.2) / 0.2,
        np.clip(np.sin(9 * time), 0, 0.01),
    ):
        values = 5e6 + 2e6 * wave + 2e4 * rng.standard_normal(time.size)
        record = Record(time, {"p1": values, "x": 0.01 * time}, "r.csv")
        motion = condition(record)
        assert motion.quality["p1"].spikes < 1e-3 * time.size
        assert motion.quality["p1"].clipped == 0
        assert error_of(motion, "p1", record, {"p1": values}) < 2e4


@pytest.mark.parametrize("half", [4, 5, 6, 8, 10, 20, 40])
@pytest.mark.parametrize("shape", ["triangle", "cosine"])
def test_true_peaks_keep_their_height(half, shape):
    """A peak that rises within 4 samples or more is the pressure's own, as high as it was."""
    rng = np.random.default_rng(half)
    time = STEP * np.arange(20_000)
    part = np.abs((np.arange(time.size) % 500) - 250) / half
    peak = np.where(part < 1, 1 - part if shape == "triangle" else np.cos(part * np.pi / 2), 0.0)
    values = 5e6 + 2e6 * peak + 1e4 * rng.standard_normal(time.size)
    record = Record(time, {"p1": values, "x": 0.001 * time}, "r.csv")
    motion = condition(record)
    assert error_of(motion, "p1", record, {"p1": values}) < 0.06 * 2e6


def test_outliers_of_a_rod_that_rests_most_of_the_time():
    """5 % outliers are found where a coarse position or a constant force hardly changes."""
    rng = np.random.default_rng(2)
    time, x = smooth_strokes(0.05, rest=10.0, turns=2)
    x = 10e-6 * np.round(x / 10e-6)
    slight = 10e-6 * np.round(1e-4 * np.sin(3 * time) / 10e-6)
    force = 0 * time
    for values, height in ((x, 0.08), (slight, 2e-4), (force, 1e3)):
        hit = rng.random(time.size) < 0.05
        stray = np.where(hit, values + height * rng.uniform(-1, 1, time.size), values)
        record = Record(time, {"x": x, "F_L": stray}, "r.csv")
        motion = condition(record)
        assert motion.quality["F_L"].spikes > 0.7 * hit.sum()
        (piece,) = motion.pieces
        error = np.interp(time, piece.time, piece["F_L"]) - values
        # of 1000 N one stray in a thousand may stand for 5 ms, of 10 um steps the steps are left
        assert np.std(error[piece.sound]) < max(1e-5, 1e-4 * height)


@pytest.mark.parametrize("quantum", [10e-6, 1e-4, 5e-3])
@pytest.mark.parametrize("strays", [0.0, 0.05])
def test_the_step_of_a_sensor(quantum, strays):
    """The step is found at any speed, at rest and among strays."""
    rng = np.random.default_rng(3)
    slow = 0.02 * np.sin(0.3 * STEP * np.arange(20_000))
    for x in (slow, smooth_strokes(0.05, turns=2)[1], smooth_strokes(0.5, rest=2.0, turns=3)[1]):
        values = quantum * np.round(x / quantum)
        hit = rng.random(x.size) < strays
        values = np.where(hit, values + 0.05 * rng.uniform(-1, 1, x.size), values)
        motion = condition(Record(STEP * np.arange(x.size), {"x": values}, "r.csv"))
        assert motion.quality["x"].resolution == pytest.approx(quantum, rel=1e-6)


# Clipping


def test_a_saturated_pressure_is_clipped():
    """Samples at the full scale of a pressure sensor are found and break the record there."""
    for quantum, noise in ((0.0, 2e4), (6e3, 2e4), (2.5e4, 2.5e4)):
        record, _ = made(noise=(noise, noise, 0.0))
        full = 6.5e6
        values = np.minimum(record["p1"], full)
        if quantum:
            values = quantum * np.round(values / quantum)
        motion = condition(but(record, p1=values))
        clipped = int(np.sum(record["p1"] >= full))
        assert motion.quality["p1"].clipped == pytest.approx(clipped, rel=0.02)
        assert any("p1" in note and "clipped" in note for note in motion.notes)
        assert all(np.all(piece["p1"] < full + 3e5) for piece in motion.pieces)
        assert len(motion.pieces) == pytest.approx(5, abs=1)


def test_a_saturated_position_is_clipped():
    """A position that meets the end of its sensor at speed is clipped, with and without noise."""
    for quantum, noise in ((10e-6, 0.0), (10e-6, 15e-6), (0.0, 0.0)):
        record, _ = made(noise=(0.0, 0.0, noise), quantum=0.0)
        values = np.clip(record["x"], 0.03, 0.07)
        if quantum:
            values = quantum * np.round(values / quantum)
        motion = condition(but(record, x=values))
        outside = int(np.sum((record["x"] >= 0.07) | (record["x"] <= 0.03)))
        assert motion.quality["x"].clipped == pytest.approx(outside, rel=0.02)


def smooth_strokes(speed, *, rest=0.5, ramp=0.05, travel=0.08, turns=8):
    """Strokes out and back with rests at both ends and speed along half cosines."""
    rise = (1 - np.cos(np.pi * np.arange(0, ramp, STEP) / ramp)) / 2
    stroke = speed * np.concatenate([rise, np.ones(round(travel / speed / STEP)), rise[::-1]])
    still = np.zeros(round(rest / STEP))
    velocity = np.concatenate([still, stroke, still, -stroke] * turns)
    return STEP * np.arange(velocity.size), 0.01 + np.cumsum(velocity) * STEP


@pytest.mark.parametrize("speed", [2e-3, 0.05, 0.5])
@pytest.mark.parametrize("quantum", [0.0, 1e-6, 10e-6, 100e-6, 5e-3])
def test_a_position_at_rest_is_no_clipping(speed, quantum):
    """A rod that rests at the ends of its stroke is not clipped, however coarse its sensor."""
    time, x = smooth_strokes(speed, turns=2)
    x = quantum * np.round(x / quantum) if quantum else x
    motion = condition(Record(time, {"x": x}, "r.csv"))
    assert motion.quality["x"].clipped == 0
    assert len(motion.pieces) == 1


def test_a_plateau_of_a_coarse_pressure_is_no_clipping():
    """Pressures that stand on a step of their sensor, or at the tank's, are read as they are."""
    time = STEP * np.arange(20_000)
    rng = np.random.default_rng(0)
    out = np.sin(2 * np.pi * 0.3 * time) > 0
    two = np.where(out, 6e6, 5e5)
    ramp = 5e5 + 5e6 * np.clip(4 * np.sin(2 * np.pi * 0.3 * time), -1, 1)
    tank = np.maximum(np.where(out, 3e6, 0) + 2e4 * rng.standard_normal(time.size), 0.0)
    sweep = 1e5 * np.round((5e6 + 2e6 * np.sin(2 * np.pi * 0.3 * time)) / 1e5)
    still = 5e5 + 0 * time
    for values in (two, 1e5 * np.round(ramp / 1e5), tank, sweep, still):
        record = Record(time, {"p1": values, "x": 0.004 * time}, "r.csv")
        motion = condition(record)
        assert motion.quality["p1"].clipped == 0
        assert len(motion.pieces) == 1


# Gaps, sampling and time


@pytest.mark.parametrize(("lost", "pieces"), [(1, 1), (5, 1), (8, 1), (10, 2), (1000, 2)])
def test_dropped_samples(lost, pieces):
    """Samples dropped for up to a quarter of a period are bridged, longer gaps break the record.

    Lines left out and cells left empty are the same.
    """
    record, truth = made(noise=(0.0, 0.0, 0.0), quantum=0.0)
    gone = np.arange(4000, 4000 + lost)
    empty = record["x"].copy()
    empty[gone] = np.nan
    left = np.delete(np.arange(record.time.size), gone)
    for broken in (kept(record, left), but(record, x=empty)):
        motion = condition(broken)
        assert len(motion.pieces) == pieces
        assert error_of(motion, "x", record, truth) < 1e-4
        assert sum(piece.time.size for piece in motion.pieces) >= left.size
        if pieces == 2:
            assert "1 gaps split the record; 2 sections are used" in motion.notes
        elif broken.time.size < record.time.size:
            assert (
                f"{lost} samples are missing from the sequence and were interpolated"
                in motion.notes
            )


def test_missing_samples_of_what_is_not_needed_break_nothing():
    """A temperature or a velocity that fails leaves the motion whole."""
    record, _ = made()
    half = np.where(record.time > 5, np.nan, 300.0)
    motion = condition(but(record, T=half, v=half))
    assert len(motion.pieces) == 1
    motion = condition(but(record, T=np.nan * half))
    assert "T has no samples and is left out" in motion.notes
    assert "T" not in motion.quality


def test_uneven_sampling():
    """Sample times that jitter by a third of a step read to the same motion, and are noted."""
    rng = np.random.default_rng(0)
    record, truth = made(noise=(0.0, 0.0, 0.0), quantum=0.0)
    time = record.time + STEP * rng.uniform(-0.3, 0.3, record.time.size)
    own = {name: np.interp(time, record.time, one) for name, one in truth.items()}
    motion = condition(but(record, time=time, **own))
    assert any("uneven" in note for note in motion.notes)
    assert error_of(motion, "x", record, truth) < 1e-6
    assert not any("uneven" in note for note in condition(record).notes)


@pytest.mark.parametrize(("step", "cutoff"), [(1e-5, 30.0), (1e-4, 30.0), (2e-2, 10.0)])
def test_any_sampling(step, cutoff):
    """Records of 50 Hz to 100 kHz give the same velocity within the noise of the steps."""
    record, _ = made(4, step, noise=(0.0, 0.0, 0.0), quantum=0.0)
    motion = condition(record, cutoff=cutoff)
    (piece,) = motion.pieces
    turn = 2 * np.pi * 0.4937
    expected = 0.04 * turn * np.cos(turn * piece.time)
    apart = np.abs(piece.velocity - expected)[piece.sound]
    assert apart.max() < 0.04 * turn * ((turn * step) ** 2 / 6 + 3e-4 * turn / cutoff)


def test_the_lag_of_pressures_is_taken_off():
    """Pressures that come 4 ms late are drawn back, position stays."""
    record, truth = made(noise=(0.0, 0.0, 0.0), quantum=0.0)
    late = np.interp(record.time - 4e-3, record.time, truth["p1"])
    motion = condition(but(record, p1=late), pressure_lag=4e-3)
    assert error_of(motion, "p1", record, truth) < 2e3
    assert error_of(motion, "x", record, truth) < 1e-9


def test_a_drift_stays():
    """What a sensor drifts is in the filtered channel: the filter takes noise, not offsets."""
    record, truth = made(noise=(0.0, 0.0, 0.0), quantum=0.0)
    drift = 1e5 * record.time / record.time[-1]
    motion = condition(but(record, p2=record["p2"] + drift))
    (piece,) = motion.pieces
    here = piece.sound
    np.testing.assert_allclose(piece["p2"][here], (truth["p2"] + drift)[here], rtol=1e-9)


def test_constant_channels_and_coarse_sensors():
    """Constants stay; steps as large as the motion are neither spikes nor clipping."""
    record, _ = made()
    coarse = 0.08 * np.round(record["x"] / 0.08)
    flat = 0 * record.time + 3.0
    stray = flat.copy()
    stray[777] = 9e9
    motion = condition(but(record, x=coarse, p2=flat, F_L=stray))
    (piece,) = motion.pieces
    np.testing.assert_allclose(piece["p2"], 3.0, rtol=1e-12)
    np.testing.assert_allclose(piece["F_L"], 3.0, rtol=1e-12)
    assert motion.quality["x"].spikes == motion.quality["x"].clipped == 0
    assert motion.quality["x"].resolution == pytest.approx(0.08)
    assert motion.quality["F_L"].spikes == 1


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda t: t[:1], "r.csv: one sample; give a record of a second or more"),
        (
            lambda t: t[:150],
            "the record lasts 0.149 s, too short for a filter at 30 Hz; give 0.2 s",
        ),
        (
            lambda t: np.where(t == t[7], np.nan, t),
            "r.csv:9: missing time; give a time",
        ),
        (lambda t: np.where(t == t[7], t[6], t), "r.csv:9: time stands still at 0.006 s; write"),
        (lambda t: np.floor(t * 500) / 500, "stands still at 0 s, 5000 times in total; write time"),
        (lambda t: np.where(t > 5, t - 3, t), "r.csv:5003: time runs backwards at 2.001 s; sort"),
        (lambda t: t[::-1], "runs backwards at 9.998 s, 9999 times in total; sort the lines by"),
        (lambda t: 1e3 * t, "1 samples per second are too few for a cut-off of 30 Hz; sample fast"),
        (lambda t: 1e3 * t, '--cutoff "0.333 Hz" at most; or is t in ms?'),
        (
            lambda t: 20 * t,
            "50 samples per second are too few for a cut-off of 30 Hz; sample faster",
        ),
        (
            lambda t: 1e-3 * t,
            "the record lasts 0.01 s, too short for a filter at 30 Hz; give 0.2 s",
        ),
        (lambda t: 1e-3 * t, "or more; or is t in s?"),
    ],
)
def test_faults_of_time(change, says):
    """A time that cannot be one, or is written in another unit, is said with its line."""
    record, _ = made()
    time = change(record.time)
    broken = kept(but(record), slice(0, time.size))
    assert says in refusal(dataclasses.replace(broken, time=time))


def test_the_cutoff_advised_is_one_that_works():
    """Filtering at the cut-off that a refusal names is accepted."""
    for step in (0.0123, 0.02, 1 / 7):
        record, _ = made(600 * step, step, hertz=0.01 / step)
        line = refusal(record, cutoff=100.0)
        advised = float(line.partition('--cutoff "')[2].partition(" Hz")[0])
        assert advised == pytest.approx(1 / (3 * step), rel=0.01)
        assert condition(record, cutoff=advised).pieces


@pytest.mark.parametrize(
    ("choices", "says"),
    [
        ({"cutoff": 0.0}, 'the cut-off is 0 Hz; give a frequency above zero: --cutoff "30 Hz"'),
        ({"cutoff": -1.0}, "the cut-off is -1 Hz"),
        ({"cutoff": math.nan}, "the cut-off is nan Hz"),
        ({"cutoff": math.inf}, "the cut-off is inf Hz"),
        ({"cutoff": 600.0}, "1000 samples per second are too few for a cut-off of 600 Hz"),
        ({"cutoff": 0.01}, "the record lasts 10 s, too short for a filter at 0.01 Hz; give 6e+02"),
        ({"order": 0}, "the order of the filter is 0; give a whole number from 1 to 10"),
        ({"order": -2}, "the order of the filter is -2"),
        ({"order": 11}, "the order of the filter is 11"),
        ({"order": 2.5}, "the order of the filter is 2.5"),
        ({"order": math.nan}, "the order of the filter is nan"),
        ({"order": math.inf}, "the order of the filter is inf"),
        (
            {"pressure_lag": math.nan},
            "the lag of the pressures is nan s; give a lag from -0.1 to 0.1 s",
        ),
        ({"pressure_lag": 3.0}, "the lag of the pressures is 3 s"),
    ],
)
def test_faults_of_the_filter(choices, says):
    """A cut-off, an order or a lag that is none is refused."""
    record, _ = made()
    assert says in refusal(record, **choices)


def test_broken_channels_are_named():
    """A needed channel without samples, or torn to shreds, is named as the cause."""
    record, _ = made()
    none = np.full(record.time.size, np.nan)
    assert "p2 has no samples; repair the sensor, or leave the column out" in refusal(
        but(record, p2=none)
    )
    torn = np.where(np.arange(record.time.size) % 100 < 20, np.nan, record["p1"])
    line = refusal(but(record, p1=torn))
    assert "no section of 0.2 s is uninterrupted: p1 has 2000 missing, 0 stray" in line
    gaps = np.flatnonzero(np.arange(record.time.size) % 100 >= 20)
    assert "no section of 0.2 s is uninterrupted: gaps in time" in refusal(kept(record, gaps))


def test_times_that_come_in_bunches_are_refused():
    """Samples doubled within a nanosecond would make even steps without number."""
    record, _ = made(1.0)
    bunched = np.sort(np.concatenate([record.time, record.time + 1e-9, record.time + 2e-9]))
    tripled = {name: np.repeat(one, 3) for name, one in record.channels.items()}
    line = refusal(Record(bunched, tripled, "r.csv", first_line=2))
    assert "r.csv:2: sample times are too uneven: most are 1e-09 s apart, but the mean is" in line


def test_a_record_without_position_is_refused():
    """Nothing moves without a position."""
    record, _ = made(1.0)
    line = refusal(Record(record.time, {"p1": record["p1"]}, "r.csv"))
    assert line == 'r.csv: no column x, the position; name it with --column "x=..."'


@given(data=st.data())
def test_any_record_is_read_or_refused(data):
    """Whatever befalls a record, its motion is finite, or one line says why there is none."""
    record, _ = made(1.0)
    size = record.time.size
    channels = {name: one.copy() for name, one in record.channels.items()}
    for _ in range(data.draw(st.integers(1, 5))):
        values = channels[data.draw(st.sampled_from(sorted(channels)))]
        first = data.draw(st.integers(0, size - 1))
        last = min(size, first + data.draw(st.sampled_from([1, 3, 50, size])))
        ends = [values[first], 0.0, 1e30, -1e30, np.nan, np.nan]
        values[first:last] = data.draw(st.sampled_from(ends))
    some = np.sort(data.draw(st.lists(st.integers(0, size - 1), unique=True, min_size=0)))
    left = np.delete(np.arange(size), some.astype(int))
    try:
        motion = condition(kept(but(record, **channels), left))
    except InputError as error:
        said, pieces = len(error.diagnostics), ()
    else:
        said, pieces = 1, motion.pieces
    assert said == 1
    for piece in pieces:
        for values in (*piece.channels.values(), piece.velocity, piece.acceleration):
            assert np.all(np.isfinite(values))


# Spectrum


@pytest.mark.parametrize("quantum", [0.0, 10e-6])
def test_spectrum_of_a_sine_in_noise(quantum):
    """A sine of 5 Hz with noise: its motion ends at 5 Hz, noise begins above, the cut-off fits."""
    record, _ = made(20, noise=(0, 0, 5e-6), quantum=quantum, hertz=5.0)
    motion = condition(record)
    found = spectrum(record, motion)
    assert 5.0 <= found.motion < 6.0
    assert found.motion < found.floor < 15.0
    assert found.kept == pytest.approx(1.0, abs=1e-3)
    assert "a cut-off between them reduces noise and loses no motion" in found.says(motion.cutoff)
    assert "within the cut-off" in found.says(found.motion + 0.1)


@pytest.mark.parametrize("width", [0.0, 4.0])
def test_spectrum_warns_of_motion_beyond_the_cutoff(width):
    """A motion at 40 Hz, as a line or swept over 4 Hz, is beyond a cut-off of 30 Hz and said so."""
    record, _ = made(20, noise=(0, 0, 5e-6), hertz=1.0)
    phase = 2 * np.pi * 40 * record.time + width / 2 * np.sin(2 * np.pi * record.time)
    record = but(record, x=10e-6 * np.round((record["x"] + 1e-3 * np.sin(phase)) / 10e-6))
    motion = condition(record)
    found = spectrum(record, motion)
    assert 37 < found.motion < 46
    # v^2 of 1 mm at 40 Hz over that of both sines
    lost = 0.04**2 / (0.04**2 + 0.04**2)
    assert found.kept == pytest.approx(1 - lost, abs=0.02)
    assert "above the cut-off, so fast motion is lost: raise --cutoff" in found.says(motion.cutoff)
    assert "within the cut-off" in found.says(60.0) or "between them" in found.says(60.0)


@pytest.mark.parametrize("speed", [1e-3, 3.3e-3, 0.02])
def test_steps_of_a_sensor_are_no_motion(speed):
    """At even speed a sensor's steps q draw lines at v/q; they are not taken for motion."""
    time, x = smooth_strokes(speed, turns=2, travel=min(0.08, 4 * speed))
    x = 10e-6 * np.round(x / 10e-6)
    rng = np.random.default_rng(0)
    stray = np.where(rng.random(x.size) < 0.05, x + 0.08 * rng.uniform(-1, 1, x.size), x)
    for values in (x, stray):
        record = Record(time, {"x": values}, "r.csv")
        motion = condition(record)
        assert spectrum(record, motion).motion < 30


def test_spectrum_of_a_rod_at_rest():
    """A rod that never moves has no motion in its spectrum."""
    for noise in (0.0, 5e-6):
        rng = np.random.default_rng(0)
        time = STEP * np.arange(20_000)
        record = Record(time, {"x": 0.05 + noise * rng.standard_normal(time.size)}, "r.csv")
        motion = condition(record)
        found = spectrum(record, motion)
        assert found == (0.0, 0.0, 1.0)
        assert found.says(30.0) == "the position shows no motion above its noise"
