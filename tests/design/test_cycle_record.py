"""Records of duty cycles: speeds of the spline, ends, doubts, and what is refused."""

from __future__ import annotations

import pickle
import time as clock
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.interpolate import CubicSpline

from actuator_opt.base.errors import InputError
from actuator_opt.design.cycle_record import COLUMNS, MOST, parse_cycle, read_cycle, spline
from actuator_opt.design.data_file import DataFile
from actuator_opt.design.duty import cycle_of

CYCLES = Path("designs/cycles")
HEADER = "time [s],position [mm],force [N]"
ROWS = ("0,20,500", "0.3,60,800", "0.5,90,-200", "0.8,50,-600", "1,20,500")
SPEEDS = (-0.0338384, 0.211616, 0.0338384, -0.211616, -0.0338384)
"""Slopes of the periodic spline through `ROWS` [m/s], computed by an independent program."""


def text(*rows, header=HEADER):
    """A file of these lines."""
    return "\n".join((header, *(rows or ROWS))) + "\n"


def fault(*rows, header=HEADER, **options):
    """The first fault of a file of these lines."""
    with pytest.raises(InputError) as error:
        parse_cycle(text(*rows, header=header), "walk.csv", **options)
    return error.value.diagnostics[0]


def sine(samples, waves=1, noise=0.0, **columns):
    """A closed record of a sine of 30 mm about 50 mm, and the force of a cosine."""
    turn = 2 * np.pi * np.linspace(0, 1, samples)
    x = 50 + 30 * np.sin(waves * turn)
    x[1:-1] += noise * (-1) ** np.arange(samples - 2)
    rows = np.column_stack([turn / (2 * np.pi), x, 100 * np.cos(turn), *columns.values()])
    names = [f"{name} [{COLUMNS[name].unit}]" for name in columns]
    lines = [",".join(f"{value:.9g}" for value in row) for row in rows]
    return "\n".join([",".join([HEADER, *names]), *lines])


def test_speeds_are_slopes_of_the_periodic_spline():
    """The five samples give the slopes of an independent program, to six digits."""
    record = parse_cycle(text(), "x.csv")
    assert record.speed == pytest.approx(SPEEDS, rel=3e-6)
    assert record.position == pytest.approx([0.02, 0.06, 0.09, 0.05, 0.02])
    assert record.force == pytest.approx([500, 800, -200, -600, 500])
    assert (record.joint, record.closed, record.duration, record.reversals) == (False, True, 1.0, 2)


def test_the_spline_of_an_open_cycle_is_exact_for_a_cubic():
    """A not-a-knot spline repeats a cubic, so its slope is that of the cubic, also at the ends."""
    times = np.array([0.0, 0.1, 0.25, 0.7, 0.8, 1.3])
    rows = [f"{t:.17g},{1e3 * (t**3 - t):.17g},1" for t in times]
    record = parse_cycle(text(*rows), "x.csv", closed=False)
    assert record.speed == pytest.approx(3 * times**2 - 1, abs=1e-12)


def test_a_slope_is_that_of_the_sine_it_samples():
    """With 200 samples a turn, the slope differs by less than 1e-6 of its largest value."""
    record = parse_cycle(sine(201), "x.csv")
    exact = 0.03 * 2 * np.pi * np.cos(2 * np.pi * record.time)
    assert np.abs(record.speed - exact).max() < 1e-6 * np.abs(exact).max()
    assert record.warnings == ()


@pytest.mark.parametrize(("name", "period"), [("gait_knee", 1.1), ("run_knee", 0.6963)])
def test_the_shipped_joint_cycles_are_closed(name, period):
    """Stride time and samples are those in the head of each file."""
    record = read_cycle(CYCLES / f"{name}.csv")
    assert (record.joint, record.closed, record.time.size) == (True, True, 101)
    assert record.duration == pytest.approx(period, rel=1e-4)
    assert record.angle[0] == record.angle[-1]
    assert (record.notes, record.stated_speed) == ((), False)


def test_the_gait_has_the_range_that_its_head_tells():
    """61 degrees of motion, from full extension at about 0."""
    angle = np.degrees(read_cycle(CYCLES / "gait_knee.csv").angle)
    assert np.ptp(angle) == pytest.approx(61, abs=0.5)
    assert angle.max() == pytest.approx(0, abs=0.05)


def test_the_run_has_the_doubtful_sample_that_its_head_tells():
    """Its torque around foot strike (0.36 to 0.44 s, lines 59 to 71) is doubtful."""
    warning, _ = read_cycle(CYCLES / "run_knee.csv").warnings
    assert "joint_torque" in warning
    assert 59 <= int(warning.rsplit(" ", 1)[1]) <= 71


def test_power_that_peaks_between_samples_is_reported_until_the_splines_count():
    """The noise of the run: its speed peaks where no sample is."""
    record = read_cycle(CYCLES / "run_knee.csv")
    angle, torque = (
        CubicSpline(record.time, values, bc_type="periodic")
        for values in (record.angle, record.torque)
    )
    fine = np.linspace(record.time[0], record.time[-1], 20_001)
    peak = np.max(angle(fine, 1) * torque(fine))
    sample = np.max(angle(record.time, 1) * torque(record.time))
    largest = np.max(np.abs(angle(record.time, 1) * torque(record.time)))
    excess = 100 * (peak - sample) / largest
    _, warning = record.warnings
    assert "between samples, the peak power is higher" in warning
    assert float(warning.split(", by ")[1].split(" %")[0]) == pytest.approx(excess, abs=1.0)
    assert not any("between samples" in text for text in record.resampled(801).warnings)
    walk = read_cycle(CYCLES / "gait_knee.csv")
    assert not any("power" in text for text in walk.warnings)


def test_power_at_the_end_of_an_open_cycle_is_that_of_a_sample():
    """And a power of rounding errors is no peak."""
    time = np.linspace(0.0, 1.0, 6)
    stroke = "\n".join(f"{t},{0.2 * t**2},{300 * t}" for t in time)
    record = parse_cycle(f"time [s],position [m],force [N]\n{stroke}\n", "x.csv", closed=False)
    assert not any("power" in text for text in record.warnings)


def test_arrays_are_read_only_and_a_pickle_is_the_same_cycle():
    """Nothing can change a record that a design shares."""
    record = parse_cycle(text(), "x.csv")
    with pytest.raises(ValueError, match="read-only"):
        record.force[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        record.resampled(40).speed[0] = 1.0
    file = DataFile("x.csv", text(), "place")
    again = pickle.loads(pickle.dumps(file))
    assert (again, again.text, again.folder) == (file, file.text, "place")
    assert again.parsed(cycle_of, closed=True).digest == record.digest


def test_the_digest_is_that_of_the_numbers():
    """Comments, order of columns and units do not count; every number does."""
    same = "# a comment\nforce [kN],time [ms],position [cm]\n" + "\n".join(
        f"{float(f) / 1e3},{1e3 * float(t):g},{float(x) / 10:g}"
        for t, x, f in (row.split(",") for row in ROWS)
    )
    first = parse_cycle(text(), "a.csv")
    assert parse_cycle(same, "b.csv").digest == first.digest
    changed = text(*ROWS[:2], "0.5,90,-200.0001", *ROWS[3:])
    assert parse_cycle(changed, "a.csv").digest != first.digest


def test_units_of_the_headings_are_converted_and_columns_are_free():
    """Inch-pounds, degrees per second and Fahrenheit; semicolons with decimal commas."""
    header = (
        "joint_torque [lbf*in];temperature [degF];time [s];joint_angle [deg];joint_speed [deg/s]"
    )
    rows = ("10;68;0;0;9", "10;68;0,1;1;10", "10;68;0,2;2;10", "10;68;0,3;3;11")
    record = parse_cycle("\n".join((header, *rows)), "x.csv", closed=False)
    assert record.torque == pytest.approx(np.full(4, 1.1298483), rel=1e-7)  # 0.0254 m x 4.4482216 N
    assert record.temperature == pytest.approx(np.full(4, 293.15))
    assert record.speed == pytest.approx(np.radians([9, 10, 10, 11]))
    assert record.notes == ("the speed is that of the column joint_speed",)
    assert record.stated_speed


def test_a_speed_that_is_no_slope_is_told():
    """A speed column in rpm instead of degrees per second, as in a published data set."""
    turn = 2 * np.pi * np.linspace(0, 1, 101)
    speed = 2 * np.pi * 30 * np.cos(turn)
    assert parse_cycle(sine(101, speed=speed), "x.csv").warnings == ()
    (warning,) = parse_cycle(sine(101, speed=6 * speed), "x.csv").warnings
    assert 'column "speed" differs from the slope of position' in warning


def test_ends_within_a_hundredth_are_joined_and_told():
    """The last sample becomes the first; a torque that does not close is only a warning."""
    record = parse_cycle(text(*ROWS[:-1], "1,20.5,500"), "x.csv")
    assert record.position[-1] == record.position[0] == 0.02
    (note,) = record.notes
    assert note == (
        'column "position": last sample set to the first (20.5 mm at the end, 20 mm at the start)'
    )
    record = parse_cycle(text(*ROWS[:-1], "1,20,100"), "x.csv")
    assert record.force[-1] == 500
    assert any('"force": last sample set to the first' in line for line in record.warnings)
    found = fault(*ROWS[:-1], "1,21,500")
    assert found.message == (
        'column "position" does not close: 21 mm at the end, 20 mm at the start'
    )
    assert (found.file, found.line) == ("walk.csv", 6)
    assert "closed: false" in found.remedy
    assert parse_cycle(text(*ROWS[:-1], "1,21,500"), "x.csv", closed=False).notes == ()


def test_a_lacking_last_sample_is_told():
    """A period without its last sample ends one step before its first."""
    lines = sine(401).splitlines()
    found = parse_cycle("\n".join(lines[:-1]), "x.csv")
    assert any("one step before the first" in line for line in found.warnings)
    assert not any("one step" in line for line in parse_cycle(sine(401), "x.csv").warnings)


@pytest.mark.parametrize(("samples", "waves", "told"), [(201, 4, False), (81, 4, True)])
def test_coarse_sampling_is_told_from_fifteen_degrees(samples, waves, told):
    """Four waves in 200 steps: 7.2 degrees a step; in 80 steps: 18 degrees."""
    warnings = parse_cycle(sine(samples, waves), "x.csv").warnings
    assert any("coarse sampling" in line for line in warnings) is told


def test_a_gap_a_spike_and_an_overshoot_are_told():
    """Each by its line or its value."""
    lines = sine(101).splitlines()
    spiked = [*lines]
    t, x, force = spiked[40].split(",")
    spiked[40] = f"{t},{float(x) + 20:.9g},{force}"
    warnings = parse_cycle("\n".join(spiked), "x.csv").warnings
    assert any(line.endswith("position has single samples far off their neighbours, at line 41")
               for line in warnings)  # fmt: skip
    gap = [*lines[:20], *lines[55:]]
    assert any(
        "at line 21 is more than 20" in line
        for line in parse_cycle("\n".join(gap), "x.csv").warnings
    )
    (line,) = [x for x in parse_cycle(text(), "x.csv").warnings if "-767" in x]
    assert "force reaches -767.426 N, beyond the samples (-600 N)" in line


def test_alternating_noise_is_no_spike():
    """Noise of 0.1 mm in every sample has a large robust deviation."""
    warnings = parse_cycle(sine(201, noise=0.1), "x.csv").warnings
    assert not any("single samples" in line for line in warnings)


def test_thinning_keeps_extremes_and_ends():
    """Fewer samples of the same file, with the largest and smallest of all columns."""
    record = parse_cycle((CYCLES / "gait_knee.csv").read_text(), "gait_knee.csv")
    few = record.thinned(30)
    assert record.thinned(record.time.size) is record
    assert 8 <= few.time.size <= 32
    rows = np.searchsorted(record.time, few.time)
    assert (rows[0], rows[-1]) == (0, record.time.size - 1)
    for name in ("time", "motion", "load", "speed"):
        whole, some = getattr(record, name), getattr(few, name)
        assert np.array_equal(some, whole[rows])
        assert (some.min(), some.max()) == (whole.min(), whole.max())
    assert few.lines == tuple(record.lines[row] for row in rows)


def test_resampling_keeps_the_samples_and_follows_the_spline():
    """21 samples at least: 4 intervals in five parts each; all from the same spline."""
    record = parse_cycle(text(), "x.csv")
    finer = record.resampled(21)
    assert finer.time.size == 21
    assert np.array_equal(finer.position[::5], record.position)
    assert np.array_equal(finer.force[::5], record.force)
    curve = spline(record.time, record.position, closed=True)
    assert finer.position == pytest.approx(curve(finer.time), abs=1e-15)
    assert finer.speed == pytest.approx(curve(finer.time, 1), abs=1e-15)
    assert finer.notes[-1] == "resampled from 5 to 21 samples"
    assert record.resampled(5) is record
    stated = parse_cycle(sine(21, speed=np.zeros(21)), "x.csv")
    assert not stated.resampled(41).speed.any()


REFUSED = {
    "empty": (("",), "", "empty"),
    "no header": (("1,2,3", "2,3,4"), "0,1,2", "no header"),
    "no unit": ((), "time [s],position,force [N]", 'column "position" states no unit'),
    "torque without a unit": (
        (), "time [s],joint_angle [deg],joint_torque", 'column "joint_torque" states no unit'
    ),
    "wrong dimension": ((), "time [s],position [N],force [N]", "N is a force, need a length"),
    "unknown unit": (
        (), "time [s],joint_angle [deg],joint_torque [lb-in]", 'unknown unit "lb-in"'
    ),
    "unknown column": ((), "time [s],position [mm],force [N],emg [-]", 'unknown column "emg"'),
    "twice": ((), "time [s],position [mm],position [mm],force [N]", '"position" is there twice'),
    "both pairs": (
        (), "time [s],position [mm],force [N],joint_angle [deg]", "both joint_angle and position"
    ),
    "neither pair": ((), "time [s],speed [m/s]", "neither joint_angle with joint_torque"),
    "half a pair": ((), "time [s],position [mm]", "no column force: required with position"),
    "no time": ((), "position [mm],force [N]", "no column time"),
    "other speed": (
        (), "time [s],position [mm],force [N],joint_speed [rad/s]", "joint_speed does not suit"
    ),
    "text": ((*ROWS[:2], "0.4,fast,1", *ROWS[2:]), HEADER, '"fast" in column "position" is not', 4),
    "empty cell": ((*ROWS[:2], "0.4,,1", *ROWS[2:]), HEADER, 'no number in column "position"', 4),
    "nan": ((*ROWS[:2], "0.4,1,nan", *ROWS[2:]), HEADER, 'no number in column "force"', 4),
    "infinite": ((*ROWS[:2], "0.4,1,1e400", *ROWS[2:]), HEADER, 'no number in column "force"', 4),
    "fewer cells": ((*ROWS[:2], "0.4,1", *ROWS[2:]), HEADER, "2 cells, but the header has 3", 4),
    "more cells": ((*ROWS[:2], "0.4,1,2,3", *ROWS[2:]), HEADER, "4 cells, but the header has 3", 4),
    "three samples": (ROWS[:3], HEADER, "3 samples: a cycle needs at least 4"),
    "time stands": ((*ROWS[:2], ROWS[1], *ROWS[2:]), HEADER, "is not after the sample before", 4),
    "time falls": ((*ROWS[:3], "0.4,1,2"), HEADER, 'column "time": 0.4 s is not after', 5),
    "cold": (
        tuple(f"{row},-300" for row in ROWS), f"{HEADER},temperature [degC]", "valid range", 2
    ),
    "suction": (
        tuple(f"{row},-1" for row in ROWS), f"{HEADER},supply_pressure [bar]", "valid range", 2
    ),
    "long line": (("0," + "1" * 5000,), HEADER, "more than 4000 characters", 2),
    "no slope": (
        ("0,1,1", "1e-310,2,1", "2e-310,1,1", "1,1,1"), HEADER, "slope is not a finite number"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_faulty_file_is_refused_in_one_line(name):
    """With file, line, and a remedy."""
    rows, header, message, *line = REFUSED[name]
    found = fault(*rows, header=header)
    assert message in found.message
    assert found.file == "walk.csv"
    assert found.remedy
    assert "\n" not in str(found)
    assert not line or found.line == line[0]


def test_an_unknown_column_names_the_known_ones_unless_it_is_ignored():
    """The remedy lists all columns."""
    header, rows = f"{HEADER},EMG raw [-]", [f"{row},rest" for row in ROWS]
    found = fault(*rows, header=header)
    assert all(name in found.remedy for name in COLUMNS)
    record = parse_cycle(text(*rows, header=header), "x.csv", ignore=["emg raw"])
    assert record.speed == pytest.approx(SPEEDS, rel=3e-6)
    near = fault(header="time [s],positon [mm],force [N]")
    assert 'did you mean "position"?' in near.remedy


def test_a_long_file_is_refused_without_reading_it_all(tmp_path):
    """A million samples: only the first bytes are read. 20 000 samples are accepted."""
    path = tmp_path / "long.csv"
    rows = "".join(f"{k / 1000:.3f},{k % 7},{k % 5}\n" for k in range(100_000))
    path.write_text(f"{HEADER}\n" + "".join(rows for _ in range(10)))
    begun = clock.process_time()
    with pytest.raises(InputError, match="the file is larger than 8 MB"):
        read_cycle(path)
    assert clock.process_time() - begun < 2.0
    assert parse_cycle(sine(MOST), "x.csv").time.size == MOST
    with pytest.raises(InputError, match="more than 20000 samples"):
        parse_cycle(sine(MOST + 1), "x.csv")


def test_files_that_are_no_files(tmp_path):
    """A folder, a missing file and an archive."""
    for path, message in ((tmp_path, "is a folder"), (tmp_path / "x.csv", "no such file")):
        with pytest.raises(InputError, match=message):
            read_cycle(path)
    (tmp_path / "x.csv").write_bytes(b"PK\x03\x04")
    with pytest.raises(InputError, match="archive"):
        read_cycle(tmp_path / "x.csv")


CELLS = st.one_of(
    st.floats(-1e6, 1e6).map(lambda x: f"{x:.6g}"),
    st.sampled_from(
        ["", "nan", "1e400", "-1e308", "1_0", "0x1", "#", '"', "'", "1,5", "a", "\x00", "٣"]
    ),
)


def lines():
    """Lines of a file that may be a cycle: mostly numbers, sometimes not."""
    heads = st.sampled_from([f"{name} [{column.unit}]" for name, column in COLUMNS.items()])
    header = st.lists(heads | CELLS, min_size=1, max_size=5).map(",".join) | st.just(HEADER)
    rows = st.lists(st.lists(CELLS, min_size=1, max_size=5).map(",".join), max_size=8)
    return st.tuples(header, rows).map(lambda pair: "\n".join([pair[0], *pair[1], ""]))


@given(content=lines() | st.text(max_size=200), closed=st.booleans())
def test_any_text_is_a_cycle_or_is_refused(content, closed):
    """Never another error, and never a number that is not finite."""
    try:
        record = parse_cycle(content, "x.csv", closed=closed)
    except InputError as error:
        faulty = [found for found in error.diagnostics if not found.remedy or "\n" in str(found)]
        if faulty:
            raise AssertionError(faulty) from None
    else:
        for array in (record.time, record.speed, record.motion, record.load):
            assert np.isfinite(array).all()


@given(data=st.binary(max_size=200))
def test_any_bytes_are_refused_in_words(tmp_path_factory, data):
    """Also those that are no text."""
    path = tmp_path_factory.getbasetemp() / "bytes.csv"
    path.write_bytes(data)
    with pytest.raises(InputError):
        read_cycle(path)


@given(
    steps=st.lists(st.floats(0.01, 1), min_size=4, max_size=30),
    seed=st.integers(0, 999),
    scale=st.floats(0.1, 10),
)
def test_time_scales_the_speeds(steps, seed, scale):
    """A closed record k times as long has speeds k times as low; its spline keeps the samples."""
    times = np.concatenate(([0.0], np.cumsum(steps)))
    x = np.random.default_rng(seed).uniform(0, 100, times.size)
    x[-1] = x[0]

    def record(factor):
        rows = [f"{t * factor:.17g},{p:.17g},1" for t, p in zip(times, x, strict=True)]
        return parse_cycle(text(*rows), "x.csv")

    one, other = record(1.0), record(scale)
    size = np.abs(one.speed).max()
    assert other.speed * scale == pytest.approx(one.speed, abs=1e-9 * size)
    assert one.speed[0] == pytest.approx(one.speed[-1], abs=1e-9 * size)
