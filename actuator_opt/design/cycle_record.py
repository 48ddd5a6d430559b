"""Records of duty cycles: motion and load over time from a CSV file, in SI.

A cycle is sampled at times t_0 < ... < t_N. A closed cycle repeats its first sample as its last.
Speeds are the slopes of the C2 cubic spline through the samples of angle or position, so they do
not depend on the design.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base import units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, remedy as remedy_for, shown
from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..base.sheets import Sheet, converted, header_cells, numbers, read_sheet, read_text

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

FEWEST = 4
"""Smallest number of samples of a cycle: a cubic spline needs four."""
MOST = 20_000
"""Largest number of samples of a cycle (our choice: more do not change any result)."""
MOST_BYTES = 8_000_000
"""Largest file [bytes] (our choice: 400 bytes per sample)."""
LONGEST_LINE = 4000
"""Largest number of characters of a line (our choice)."""
OTHER_LINES = 2000
"""Largest number of lines that are no samples (our choice)."""
CLOSURE = 0.01
"""Largest difference of the ends of a closed cycle, as a share of the column's range (our
choice)."""
POWER_BETWEEN = 0.1
"""Excess of the power between samples that is reported, as a share of the largest power at the
samples (our choice)."""
BETWEEN = 8
"""Points of each time step at which the power is compared."""
OVERSHOOT = 0.01
"""Overshoot of the spline beyond the samples that is reported, as a share of the range (our
choice)."""
GAP = 20.0
"""A time step of more than this many median steps is reported as a gap (our choice)."""
COARSE = np.pi / 12
"""Phase of the fastest half-wave per sample that is reported [rad] (our choice: 15 degrees)."""
SPIKE = 6.0
"""Deviation of a sample from its neighbours that is reported, in robust standard deviations (our
choice)."""
SPIKE_RANGE = 0.05
"""Smallest deviation that is reported as a spike, as a share of the range (our choice: a motion
with long rests has a robust deviation of almost zero)."""
UNLIKE = 0.2
"""Difference of a stated speed from the slope of the motion that is reported, both as root mean
square (our choice)."""
_SHOWN = 3
"""Largest number of lines that a warning names."""


class CycleColumn(NamedTuple):
    """A column that a cycle can have: dimension, example of its unit, and meaning."""

    dimension: str
    unit: str
    label: str


COLUMNS: Mapping[str, CycleColumn] = {
    "time": CycleColumn("time", "s", "time"),
    "joint_angle": CycleColumn("angle", "deg", "angle of the joint"),
    "joint_torque": CycleColumn("torque", "N*m", "torque of the joint in the sense of the angle"),
    "position": CycleColumn("length", "mm", "position of the piston, from fully retracted"),
    "force": CycleColumn("force", "N", "force on the load, positive if it pushes the load out"),
    "joint_speed": CycleColumn("angular_speed", "deg/s", "speed of the joint"),
    "speed": CycleColumn("speed", "mm/s", "speed of the piston, outwards"),
    "supply_pressure": CycleColumn("pressure", "bar", "supply pressure, gauge"),
    "temperature": CycleColumn("temperature", "degC", "temperature of the oil"),
}
"""Columns of a cycle by name, as in the heading ``force [kN]``."""
_JOINT, _AXIAL = ("joint_angle", "joint_torque"), ("position", "force")
_SPEEDS = {"joint_speed": "joint_angle", "speed": "position"}
_STATES = {"supply_pressure": "pressure", "temperature": "temperature"}
"""Columns of a state, with the quantity that gives their valid range."""


@dataclass(frozen=True, slots=True, eq=False)
class CycleRecord:
    """One duty cycle as its file states it: SI, without the scales of the design.

    Either `angle` and `torque` are set, or `position` and `force`. All arrays have the shape (N+1,)
    and are read-only.

    Parameters
    ----------
    name : name of the file, for messages
    time : times of the samples [s], strictly rising
    closed : whether the last sample repeats the first, one period later
    speed : slope of angle [rad/s] or position [m/s] at the samples
    angle, torque : joint angle [rad] and torque [N m]
    position, force : position of the piston [m] and force [N]; positive pushes the load out
    supply_pressure : gauge pressure [Pa]; None if the file has no such column
    temperature : temperature of the oil [K]; None if the file has no such column
    notes : sentences on what was changed in the data
    warnings : sentences on doubtful data
    digest : SHA-256 of the numbers of the file, as hexadecimal digits
    lines : line number of every sample in the file; of a resampled record, of the sample before
    """

    name: str
    time: Array
    closed: bool
    speed: Array
    angle: Array | None = None
    torque: Array | None = None
    position: Array | None = None
    force: Array | None = None
    supply_pressure: Array | None = None
    temperature: Array | None = None
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    digest: str = ""
    lines: tuple[int, ...] = ()
    stated_speed: bool = False
    """Whether `speed` is a column of the file, and not the slope of the motion."""

    def __repr__(self) -> str:
        """Name, number of samples and duration."""
        return f"CycleRecord({self.name!r}, {self.time.size} samples, {self.duration:.4g} s)"

    @property
    def joint(self) -> bool:
        """Whether the file states angle and torque of a joint."""
        return self.angle is not None

    @property
    def motion(self) -> Array:
        """Joint angle [rad], or position [m]."""
        motion = self.position if self.angle is None else self.angle
        assert motion is not None
        return motion

    @property
    def load(self) -> Array:
        """Joint torque [N m], or force [N]."""
        load = self.force if self.torque is None else self.torque
        assert load is not None
        return load

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]: the period of a closed cycle."""
        return float(self.time[-1] - self.time[0])

    @property
    def reversals(self) -> int:
        """Number of changes of direction, without those of less than 1 % of the range."""
        return max(len(_turns(self.motion)) - 2, 0) + self._turns_at_the_seam

    @property
    def _turns_at_the_seam(self) -> int:
        """1 if a closed cycle changes its direction where its last sample meets its first."""
        turns = _turns(self.motion)
        if not self.closed or len(turns) < 3:
            return 0
        first, last = (self.motion[turns[k + 1]] - self.motion[turns[k]] for k in (0, -2))
        return int(np.sign(first) != np.sign(last))

    def thinned(self, samples: int) -> CycleRecord:
        """About `samples` samples at most; the same record is returned if it has no more.

        Of every part of the time, those stay where motion, speed and load are largest and smallest.
        """
        if self.time.size <= samples:
            return self
        kept = {0, self.time.size - 1}
        for part in np.array_split(np.arange(self.time.size), max(samples // 6, 1)):
            for values in (self.motion, self.speed, self.load):
                kept |= {int(part[np.argmax(values[part])]), int(part[np.argmin(values[part])])}
        rows = np.array(sorted(kept))

        columns = {
            name: fixed(values[rows])
            for name in ("time", "speed", *_SPLINED, *_STATES)
            if (values := getattr(self, name)) is not None
        }
        lines = tuple(self.lines[row] for row in rows) if self.lines else ()
        return replace(self, lines=lines, **columns)

    def resampled(self, samples: int) -> CycleRecord:
        """At least `samples` samples: every interval is divided evenly, by the splines.

        The samples of the file stay, so that turning points stay. States are interpolated linearly.
        Warnings of extremes between samples no longer apply. The same record is returned if it has
        enough samples.
        """
        parts = -(-(samples - 1) // (self.time.size - 1))
        if parts <= 1:
            return self
        steps = np.diff(self.time)[:, None] * (np.arange(parts) / parts)
        time = np.append((self.time[:-1, None] + steps).ravel(), self.time[-1])

        def smooth(values: Array) -> Array:
            new = spline(self.time, values, closed=self.closed)(time)
            new[::parts] = values  # the samples of the file stay to the last bit
            return fixed(new)

        columns = {
            name: smooth(values) if name in _SPLINED else fixed(np.interp(time, self.time, values))
            for name in (*_SPLINED, *_STATES)
            if (values := getattr(self, name)) is not None
        }
        speed = smooth(self.speed)
        if not self.stated_speed:
            speed = fixed(spline(self.time, self.motion, closed=self.closed)(time, 1))
        lines = np.append(np.repeat(np.asarray(self.lines[:-1]), parts), self.lines[-1:])
        return replace(
            self,
            time=fixed(time),
            speed=speed,
            notes=(*self.notes, f"resampled from {self.time.size} to {time.size} samples"),
            warnings=tuple(x for x in self.warnings if not x.startswith(_BETWEEN)),
            lines=tuple(map(int, lines)),
            **columns,
        )


_BETWEEN = "between samples, "
"""Beginning of a warning of extremes that no sample has."""
_SPLINED = ("angle", "torque", "position", "force")
"""Columns of which a record has one pair, which splines join."""


def fixed(values: Array) -> Array:
    """The array as read-only floats."""
    array = np.array(values, dtype=float)
    array.flags.writeable = False
    return array


def spline(time: Array, values: Array, *, closed: bool) -> CubicSpline:
    """The C2 cubic spline through samples: periodic if closed, else with not-a-knot ends.

    Parameters
    ----------
    time : (N+1,), strictly rising [s]
    values : (N+1,); if closed, the last equals the first
    """
    from scipy.interpolate import CubicSpline  # takes a third of a second to import

    return CubicSpline(time, values, bc_type="periodic" if closed else "not-a-knot")


def read_cycle(
    source: str | Path,
    *,
    closed: bool = True,
    ignore: Sequence[str] = (),
    samples: int | None = None,
) -> CycleRecord:
    """Read the record of a cycle from a CSV file, or from its text of several lines.

    Lines that begin with ``#`` are comments. One heading names every column with its unit, such as
    ``force [kN]``; see `COLUMNS`. The order of the columns is free.

    Parameters
    ----------
    source : path of the file, or its text
    closed : whether the cycle repeats, so that its last sample is its first, one period later
    ignore : names of columns that are not read
    samples : smallest number of samples; None keeps those of the file

    Raises
    ------
    InputError
        with file, line, column and remedy: an unreadable file; a missing, unknown, repeated or
        unitless column; a cell that is no number; fewer than 4 or more than 20 000 samples; times
        that do not rise; a closed cycle whose ends differ by more than 1 % of the range
    """
    if isinstance(source, str) and "\n" in source:
        return parse_cycle(source, "text", closed=closed, ignore=ignore, samples=samples)
    text = read_text(source, most=MOST_BYTES)
    return parse_cycle(text, str(source), closed=closed, ignore=ignore, samples=samples)


def parse_cycle(
    text: str,
    name: str,
    *,
    closed: bool = True,
    ignore: Sequence[str] = (),
    samples: int | None = None,
) -> CycleRecord:
    """The record in the text of a CSV file called `name`; see `read_cycle`."""
    sheet = read_sheet(_bounded(text, name), name)
    columns, lines = _columns(sheet, ignore)
    _check(sheet, columns, lines)
    record = _record(sheet, columns, lines, closed=closed)
    return record if samples is None else record.resampled(samples)


def _bounded(text: str, name: str) -> str:
    """The first lines of a text, as many as a cycle can have; refuse lines without end."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n", MOST + OTHER_LINES)
    for number, line in enumerate(lines[: MOST + OTHER_LINES], 1):
        if len(line) > LONGEST_LINE:
            message = f"the line has more than {LONGEST_LINE} characters"
            remedy = "write one line per sample, columns separated by commas"
            raise InputError(Diagnostic(message, remedy, file=name, line=number))
    return "\n".join(lines[: MOST + OTHER_LINES])


def _columns(sheet: Sheet, ignore: Sequence[str]) -> tuple[dict[str, Array], Array]:
    """Values (SI) of every column by name, and the line number of every sample."""
    faults: list[Diagnostic] = []
    places: dict[str, tuple[int, str]] = {}
    skipped = {_plain(name) for name in ignore}

    def fault(message: str, remedy: str) -> None:
        faults.append(Diagnostic(message, remedy, file=sheet.name, line=sheet.header_line))

    for place, (name, unit) in enumerate(header_cells(sheet)):
        key = _plain(name)
        if key in skipped:
            continue
        if key not in COLUMNS:
            known = ", ".join(COLUMNS)
            near = remedy_for(key, COLUMNS) if key else f"use one of {known}"
            remedy = f"{near}; columns are {known}" if near.startswith("did") else near
            remedy = remedy or f"use one of {known}"
            fault(f'unknown column "{shown(name)}"', f"{remedy}; or list it under ignore")
        elif key in places:
            fault(f'column "{key}" is there twice', "remove one, or rename it")
        else:
            places[key] = place, unit
    faults += _pair_faults(sheet, places)
    table = {}
    for key, (place, unit) in places.items():
        column = COLUMNS[key]
        if not unit:
            fault(f'column "{key}" states no unit', f'write e.g. "{key} [{column.unit}]"')
            continue
        try:
            table[key] = converted(unit, column.dimension, place)
        except units.UnitError as error:
            fault(f'column "{key}": {shown(error.message, 120)}', shown(error.remedy, 120))
    if faults:
        raise InputError(faults)
    values, lines = numbers(sheet, [column.place for column in table.values()])
    numbered = enumerate(table.items())
    return {key: column.values(values[:, k]) for k, (key, column) in numbered}, lines


def _plain(name: str) -> str:
    """A column's name as `COLUMNS` has it: small letters, and lines instead of spaces."""
    return name.strip().lower().replace(" ", "_")


def _pair_faults(sheet: Sheet, places: Mapping[str, object]) -> Iterator[Diagnostic]:
    """Faults of a heading without time, without motion and load, or with both kinds of them."""

    def fault(message: str, remedy: str) -> Diagnostic:
        return Diagnostic(message, remedy, file=sheet.name, line=sheet.header_line)

    if "time" not in places:
        yield fault("no column time", 'add e.g. "time [s]"')
    joint, axial = ([name for name in pair if name in places] for pair in (_JOINT, _AXIAL))
    if joint and axial:
        message = f"both {joint[0]} and {axial[0]}: a cycle has columns of a joint, or of the rod"
        yield fault(message, f"remove {' and '.join(axial)}, or list them under ignore")
        return
    if not joint and not axial:
        yield fault(
            "neither joint_angle with joint_torque, nor position with force",
            'name the columns e.g. "position [mm]" and "force [kN]"',
        )
        return
    pair = _JOINT if joint else _AXIAL
    for name in pair:
        if name not in places:
            other = pair[1 - pair.index(name)]
            example = f"{name} [{COLUMNS[name].unit}]"
            yield fault(f"no column {name}: required with {other}", f'add e.g. "{example}"')
    for speed, motion in _SPEEDS.items():
        if speed in places and motion not in pair:
            right = next(name for name, of in _SPEEDS.items() if of in pair)
            yield fault(f"column {speed} does not suit {pair[0]}", f"name it {right}, or remove it")


def _check(sheet: Sheet, columns: Mapping[str, Array], lines: Array) -> None:
    """Refuse too few or too many samples, missing cells, values out of range, falling times."""

    def refuse(message: str, remedy: str, sample: int | None = None) -> InputError:
        line = None if sample is None else int(lines[sample])
        return InputError(Diagnostic(message, remedy, file=sheet.name, line=line))

    if lines.size > MOST:
        raise refuse(f"more than {MOST} samples", "resample the cycle to fewer samples")
    if len(sheet.lines) >= MOST + OTHER_LINES:
        raise refuse(f"more than {MOST + OTHER_LINES - 1} lines", "remove comments and empty lines")
    if lines.size < FEWEST:
        message = f"{lines.size} samples: a cycle needs at least {FEWEST}"
        raise refuse(message, "give one line per sample")
    missing = np.isnan(np.column_stack(list(columns.values())))
    if missing.any():
        sample, column = map(int, np.argwhere(missing)[0])
        name = list(columns)[column]
        raise refuse(f'no number in column "{name}"', "write a number in every line", sample)
    for name, quantity in _STATES.items():
        if name in columns:
            low, high = INPUTS[quantity].lower, INPUTS[quantity].upper
            outside = np.flatnonzero((columns[name] < low) | (columns[name] > high))
            if outside.size:
                value = INPUTS[quantity].text(float(columns[name][outside[0]]))
                message = f'column "{name}": {value} is outside the valid range'
                remedy = f"write {INPUTS[quantity].range_text()}"
                raise refuse(message, remedy, int(outside[0]))
    falling = np.flatnonzero(np.diff(columns["time"]) <= 0)
    if falling.size:
        at = int(falling[0]) + 1
        message = f'column "time": {columns["time"][at]:.9g} s is not after the sample before it'
        raise refuse(message, "sort the lines by time, and remove repeated times", at)


def _record(
    sheet: Sheet, columns: Mapping[str, Array], lines: Array, *, closed: bool
) -> CycleRecord:
    """The record of checked columns: ends closed, speeds from the spline, doubts listed."""
    time = columns["time"]
    motion = _JOINT[0] if _JOINT[0] in columns else _AXIAL[0]
    notes: list[str] = []
    warnings: list[str] = []
    values = dict(columns)
    if closed:
        for name in values.keys() - {"time"}:
            values[name] = _closed(sheet, name, values[name], lines, notes, warnings)
        notes.sort()
        warnings += _lacks_last(columns[motion], motion)
    slope = _slope(time, values[motion], closed=closed)
    stated = next((name for name in _SPEEDS if name in values), None)
    speed = slope if stated is None else values[stated]
    if not np.all(np.isfinite(speed)):
        at = int(np.argmax(~np.isfinite(speed)))
        message = f'column "{motion}": its slope is not a finite number'
        remedy = "check times and values there"
        raise InputError(Diagnostic(message, remedy, file=sheet.name, line=int(lines[at])))
    if stated is not None:
        notes.append(f"the speed is that of the column {stated}")
        warnings += _unlike(stated, motion, speed, slope)
    warnings += _doubts(time, values, motion, lines, closed=closed)
    kept = {name: fixed(array) for name, array in values.items()}
    return CycleRecord(
        name=sheet.name,
        time=kept["time"],
        closed=closed,
        speed=fixed(speed),
        angle=kept.get("joint_angle"),
        torque=kept.get("joint_torque"),
        position=kept.get("position"),
        force=kept.get("force"),
        supply_pressure=kept.get("supply_pressure"),
        temperature=kept.get("temperature"),
        notes=tuple(notes),
        warnings=tuple(warnings),
        digest=_digest(columns),
        lines=tuple(map(int, lines)),
        stated_speed=stated is not None,
    )


def _slope(time: Array, values: Array, *, closed: bool) -> Array:
    """Slope of the spline at the samples; NaN where numbers are too large or too small for it."""
    with np.errstate(all="ignore"):
        try:
            return np.asarray(spline(time, values, closed=closed)(time, 1))
        except (ValueError, np.linalg.LinAlgError):
            return np.full_like(values, np.nan)


def _digest(columns: Mapping[str, Array]) -> str:
    """SHA-256 of names and numbers of all columns, whatever their order and units in the file."""
    content = hashlib.sha256()
    for name in sorted(columns):
        content.update(f"{name} {columns[name].size}\n".encode())
        content.update(np.ascontiguousarray(columns[name] + 0.0, dtype="<f8").tobytes())
    return content.hexdigest()


def _text(name: str, value: float) -> str:
    """A value of a column in the unit that its heading usually has."""
    column = COLUMNS[name]
    number = units.unit(column.unit, column.dimension).from_si(value)
    return f"{number:.6g} {column.unit}"


def _closed(
    sheet: Sheet,
    name: str,
    values: Array,
    lines: Array,
    notes: list[str],
    warnings: list[str],
) -> Array:
    """The column with its last sample set to its first; notes or, if far, warnings state it."""
    first, last = float(values[0]), float(values[-1])
    if first == last:
        return values
    far = abs(last - first) > CLOSURE * float(np.ptp(values))
    ends = f"{_text(name, last)} at the end, {_text(name, first)} at the start"
    if far and name in (_JOINT[0], _AXIAL[0]):
        message = f'column "{name}" does not close: {ends}'
        remedy = "repeat the first sample at the end, one period later, or write closed: false"
        raise InputError(Diagnostic(message, remedy, file=sheet.name, line=int(lines[-1])))
    sentence = f'column "{name}": last sample set to the first ({ends})'
    (warnings if far else notes).append(sentence)
    return np.append(values[:-1], first)


def _lacks_last(motion: Array, name: str) -> Iterator[str]:
    """A sentence if the last sample seems to lie one step before the first, of the next period."""
    gap, before, after = motion[0] - motion[-1], motion[-1] - motion[-2], motion[1] - motion[0]
    if gap != 0 and all(0.5 < step / gap < 2 for step in (before, after)):
        yield (
            f'column "{name}": the last sample seems to lie one step before the first; a closed '
            "cycle repeats its first sample at the end"
        )


def _unlike(stated: str, motion: str, speed: Array, slope: Array) -> Iterator[str]:
    """A sentence if a stated speed differs from the slope of the motion."""
    size, difference = (float(np.sqrt(np.mean(x**2))) for x in (slope, speed - slope))
    if difference > UNLIKE * size:
        yield (
            f'column "{stated}" differs from the slope of {motion}: root mean square '
            f"{_text(stated, difference)}, that of the slope is {_text(stated, size)}; check unit "
            "and sign"
        )


def _doubts(
    time: Array, values: Mapping[str, Array], motion: str, lines: Array, *, closed: bool
) -> Iterator[str]:
    """Sentences on gaps, coarse sampling, overshoot of the splines and spikes."""
    load = _JOINT[1] if motion == _JOINT[0] else _AXIAL[1]
    steps = np.diff(time)
    gaps = np.flatnonzero(steps > GAP * np.median(steps))
    if gaps.size:
        yield (
            f"a time step of {steps[gaps[0]]:.4g} s at line {lines[gaps[0] + 1]} is more than "
            f"{GAP:.0f} usual steps: samples seem to be missing"
        )
    turns = _turns(values[motion])
    if len(turns) > 2:
        waves = np.diff(turns)
        fewest = int(waves[1:-1].min()) if waves.size > 2 else int(waves.min())
        if np.pi / fewest > COARSE:
            yield (
                f"coarse sampling: the fastest half-wave of {motion} has {fewest} steps; at least "
                f"{round(np.pi / COARSE)} are needed for its speed"
            )
    for name in (motion, load):
        yield from _overshoot(name, time, values[name], closed=closed)
        yield from _spikes(name, time, values[name], lines)
    if not any(name in values for name in _SPEEDS):
        yield from _power_between(time, values[motion], values[load], closed=closed)


def _turns(motion: Array) -> list[int]:
    """Samples at which the motion ends or turns, without swings below 1 % of its range."""
    least = CLOSURE * float(np.ptp(motion))
    values = motion.tolist()
    turns, low, high, direction = [0], 0, 0, 0
    for k, value in enumerate(values):
        if value > values[high]:
            high = k
        if value < values[low]:
            low = k
        if direction >= 0 and values[high] - value > least:
            if direction > 0 or high > 0:
                turns.append(high)
            direction, low, high = -1, k, k
        elif direction <= 0 and value - values[low] > least:
            if direction < 0 or low > 0:
                turns.append(low)
            direction, low, high = 1, k, k
    if turns[-1] != len(values) - 1:
        turns.append(len(values) - 1)
    return turns


def _overshoot(name: str, time: Array, values: Array, *, closed: bool) -> Iterator[str]:
    """A sentence if the spline exceeds the largest or smallest sample by 1 % of the range."""
    span = float(np.ptp(values))
    if span == 0:
        return
    with np.errstate(all="ignore"):
        try:
            curve = spline(time, values, closed=closed)
        except (ValueError, np.linalg.LinAlgError):  # the load's numbers are too large
            return
        places = curve.derivative().roots(extrapolate=False)
        extremes = curve(places[np.isfinite(places)])
    extremes = extremes[np.isfinite(extremes)]
    if not extremes.size:
        return
    for end, sample in ((extremes.max(), values.max()), (extremes.min(), values.min())):
        if abs(end - sample) > OVERSHOOT * span and (end - sample) * (end - values.mean()) > 0:
            yield (
                f"{_BETWEEN}{name} reaches {_text(name, float(end))}, beyond the samples "
                f"({_text(name, float(sample))}): sample more finely"
            )


def _power_between(time: Array, motion: Array, load: Array, *, closed: bool) -> Iterator[str]:
    """A sentence if a power by the splines exceeds those of all samples."""
    with np.errstate(all="ignore"):
        try:
            moved, loaded = (spline(time, values, closed=closed) for values in (motion, load))
        except (ValueError, np.linalg.LinAlgError):
            return
        steps = np.diff(time)[:, None] * np.linspace(0, 1, BETWEEN, endpoint=False)
        grid = np.append((time[:-1, None] + steps).ravel(), time[-1])
        power = moved(grid, 1) * loaded(grid)
    if not np.isfinite(power).all():
        return
    stated, largest = power[::BETWEEN], float(np.abs(power[::BETWEEN]).max())
    for word, sign in (("peak", 1.0), ("absorbed", -1.0)):
        excess = float(np.max(sign * power) - np.max(sign * stated))
        if excess > POWER_BETWEEN * largest:
            share = 100 * excess / (largest or excess)
            yield (
                f"{_BETWEEN}the {word} power is higher than at all samples, by {share:.0f} % of "
                "the largest: smooth the file if this is noise; else state duty.samples, so that "
                "points of the splines count"
            )


def _spikes(name: str, time: Array, values: Array, lines: Array) -> Iterator[str]:
    """A sentence if single samples lie far off the cubic through two neighbours on each side."""
    span = float(np.ptp(values))
    if values.size < 9 or span == 0:
        return
    offsets = (-2, -1, 1, 2)
    at = np.arange(2, values.size - 2)
    expected = np.zeros(at.size)
    for k in offsets:
        weight = np.ones(at.size)
        for m in offsets:
            if m != k:
                weight *= (time[at] - time[at + m]) / (time[at + k] - time[at + m])
        expected += weight * values[at + k]
    off = np.abs(values[at] - expected)
    deviation = 1.4826 * float(np.median(off))
    around = np.maximum(np.append(off[1:], 0.0), np.append(0.0, off[:-1]))
    spikes = at[(off > SPIKE * deviation) & (off > SPIKE_RANGE * span) & (off > around)]
    if spikes.size:
        named = ", ".join(str(lines[k]) for k in spikes[:_SHOWN])
        more = f" and {spikes.size - _SHOWN} more" if spikes.size > _SHOWN else ""
        yield f"{name} has single samples far off their neighbours, at line {named}{more}"
