"""Functions of many inputs that are recorded once and then run by a small virtual machine.

The function is called with symbols in place of numbers; every operation becomes an instruction of
the virtual machine ("machine" for short, see `program`). A branch that depends on values is
recorded as a guard: points that would take the other branch go through the function itself. The
recording is checked against the function before it is used.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..numeric import STEP, Array, complexed, duals_of, group_starts, group_width
from . import program as programs, program_store
from .arrays import Recorder, elements
from .program import EQUAL, NOTHING, Program
from .program_store import MOST_RECORDINGS, Recording

FEW = 20
"""Number of points with unrecorded branches, above which a function may be recorded again."""
OFTEN = 0.25
"""A function is recorded again if also more than this share of all points took such branches."""
AGREEMENT = 1e-9
"""Largest permitted difference between a recording and its function, divided by the value (or by 1
if the value is smaller)."""


class RecordedFunction:
    """A function of k points (inputs, k), real or complex; it returns one row per result (rows, k).

    Parameters
    ----------
    function : accepts NumPy arrays and arrays of symbols
    names : label of every input
    present : present value of every input (inputs,)
    structure : JSON data that determine the operations of the function, so that its recordings can
        be stored for later runs; None: they are not stored
    shared : number of the first inputs that many points share; what needs no others runs once for
        these points

    Attributes
    ----------
    reason : why the function is not run by the machine, if it is not
    run : computes the outputs of a program at points (points, inputs): the machine, or a GPU
    """

    def __init__(
        self,
        function: Callable[[Array], Array],
        names: Sequence[str],
        present: Array,
        structure: Any = None,
        shared: int = 0,
    ) -> None:
        self.function, self.shared = function, shared
        self.names = tuple(names)
        self.present = present
        self.structure = structure
        self.reason = "" if programs.AVAILABLE else programs.NOT_BUILT
        self.run: Callable[[Program, Array], Array] = Program.values
        self.recording: Recording | None = None
        self._fixed: tuple[Recording, Program] | None = None
        self.recordings = 0
        self.points = 0
        self.outside = 0

    def __call__(self, points: Array) -> Array:
        """Results (rows, k) at points (inputs, k), by the machine if it can be recorded.

        Points may have only the first inputs; the others then have their present values.
        """
        if not self.reason and self.recording is None:
            self._record(self.present)
        if self.recording is None or not programs.AVAILABLE:  # sent to a worker without the machine
            return self.function(self._whole(points))
        if not points.shape[1]:  # no variable to differentiate by
            return np.empty((self.recording.rows, 0), points.dtype)
        return self._slopes(points) if np.iscomplexobj(points) else self._values(points)

    def duals(
        self,
        shared: Array,
        own: Array,
        seeds: Array,
        rows: int | None = None,
        group: Array = EQUAL,
    ) -> Array:
        """Results with their slopes (rows, results, 1 + directions), see `Program.duals`."""
        if not self.reason and self.recording is None and len(own):
            self._record(np.concatenate([shared[0], own[0]]))
        recording = self.recording
        count = len(own) if rows is None else rows
        if recording is not None and programs.AVAILABLE:
            whole = len(recording.program.outputs) == recording.rows  # without guards
            results = recording.program.duals(shared, own, seeds, count if whole else None, group)
            if whole:
                return results
            outside = np.flatnonzero(~recording.holds(results[:, :, 0]))
            results = results[:, : recording.rows]
            if len(outside):
                results[outside] = self._by_function(shared, own, seeds, outside, group)
        else:
            results = self._by_function(shared, own, seeds, np.arange(len(own)), group)
        if count == len(own):
            return results
        return np.add.reduceat(results, np.searchsorted(_part(group, count, own), range(count)))

    def _by_function(
        self, shared: Array, own: Array, seeds: Array, points: Array, group: Array
    ) -> Array:
        """The same by the function itself, at some of the points."""
        values = np.concatenate(
            [shared[_part(group, len(shared), own)[points]], own[points]], axis=1
        )
        directions = seeds.shape[2]
        with np.errstate(all="ignore"):
            if not directions:
                return self.function(values.T).T[:, :, None]
            stepped = np.repeat(values.astype(complex)[:, :, None], directions, axis=2)
            changed = seeds[_part(group, len(seeds), own)[points]]
            stepped[:, : seeds.shape[1]] += 1j * STEP * changed
            rows = self.function(stepped.transpose(1, 0, 2).reshape(values.shape[1], -1))
        rows = rows.reshape(len(rows), len(points), directions).transpose(1, 0, 2)
        return np.concatenate([rows.real[:, :, :1], rows.imag / STEP], axis=2)

    def confirmed(
        self, points: Array, expected: Array | None = None, floor: float | Array = 1.0
    ) -> bool:
        """Whether the machine and the function agree at points (inputs, k).

        If they do not, the function is used from then on. `expected` are the results of the
        function, if they are known; `floor` is that of `same`.
        """
        if self.recording is None:
            return True
        if expected is None:
            expected = self.function(points)
        if same(self._values(points), expected, floor):
            return True
        self.recording.checked = False
        self.recording, self.reason = None, "the recording differs from the models"
        return False

    def _values(self, points: Array) -> Array:
        assert self.recording is not None
        program, fewer = self.recording.program, len(points) < len(self.names)
        if fewer:
            if self._fixed is None or self._fixed[0] is not self.recording:
                program = program.with_fixed(self.present[len(points) :])
                self._fixed = self.recording, program
            program = self._fixed[1]
        results = self.run(program, points.T)
        holds = self.recording.holds(results)
        rows = results[:, : self.recording.rows].T
        rows = rows if fewer else np.ascontiguousarray(rows)
        self._complete(points, rows, holds)
        return rows

    def _whole(self, points: Array) -> Array:
        """The points with the present values of all inputs that they lack, (inputs, k)."""
        if len(points) == len(self.names):
            return points
        others = np.broadcast_to(
            self.present[len(points) :, None], (len(self.present) - len(points), points.shape[1])
        )
        return np.concatenate([points, others])

    def _slopes(self, points: Array) -> Array:
        """Results with their complex steps; points with equal real parts are evaluated together."""
        assert self.recording is not None
        width = group_width(points)
        if width is None:
            parts = np.split(points, group_starts(points)[1:], axis=1)
            return np.concatenate([self._slopes(part) for part in parts], axis=1)
        found, holds = self._run(duals_of(points, width))
        rows = complexed(found)
        self._complete(points, rows, np.repeat(holds, width))
        return rows

    def _run(self, inputs: Array) -> tuple[Array, Array]:
        """Results with slopes (rows, k, 1 + directions), and whether each point holds (k,).

        The recording runs; inputs have slopes, too (inputs, k, 1 + directions).
        """
        assert self.recording is not None
        own, seeds = inputs[:, :, 0].T, inputs[:, :, 1:].transpose(1, 0, 2)
        found = self.recording.program.duals(NOTHING, own, seeds)
        holds = self.recording.holds(found[:, :, 0])
        return found[:, : self.recording.rows].transpose(1, 0, 2), holds

    def _complete(self, points: Array, rows: Array, holds: Array) -> None:
        """Call the function itself for points on unrecorded branches; if many, record it again."""
        self.points += len(holds)
        if holds.all():
            return
        missing = ~holds
        rows[:, missing] = self.function(self._whole(points[:, missing]))
        self.outside += int(missing.sum())
        if self.outside > FEW and self.outside > OFTEN * self.points:
            self._record(self._whole(points)[:, np.flatnonzero(missing)[0]].real)

    def _record(self, point: Array) -> None:
        """Record the function at a point (inputs,), and check it there and nearby."""
        self.recording = None
        self.points = self.outside = 0
        if self.recordings >= MOST_RECORDINGS:
            self.reason = "the models take different branches for different designs"
            return
        self.recordings += 1
        key = "" if self.structure is None else program_store.key_of([self.structure, len(point)])
        known = program_store.read(key) if key else []
        for stored in known:
            if stored.checked and stored.covers(point):
                self.recording = stored
                return
        points = np.stack([point, point * (1 + 1e-3)], axis=1)
        with np.errstate(all="ignore"):
            expected = self.function(points)
        for stored in known:
            if _agrees(stored, points, expected):
                self.recording = stored
                return
        collecting = gc.isenabled()
        gc.disable()  # a recording makes many small objects, none of which can be freed
        try:
            recording = self._traced(point)
        except Exception as error:  # any model may meet an operation that is not recorded
            self.reason = f"a model cannot be recorded ({error})"
            return
        finally:
            if collecting:
                gc.enable()
        if not _agrees(recording, points, expected):
            self.reason = "the recording differs from the models"
            return
        self.recording = recording
        if key:
            program_store.write(key, recording)

    def _traced(self, point: Array) -> Recording:
        """The program of the function, with the branches taken at a point (inputs,)."""
        recorder = Recorder()
        with np.errstate(all="ignore"):
            symbols = recorder.variables(self.names, point)
            results = elements(self.function(symbols))
        written = programs.program(elements(symbols), [*results, *recorder.guards], self.shared)
        return Recording(written, np.array(list(recorder.guards.values()), dtype=bool))


def _agrees(recording: Recording, points: Array, expected: Array) -> bool:
    """Whether a recording agrees with the results `expected` (rows, k) at points (inputs, k).

    The first point must take the recorded branches; further points that do not are left out.
    """
    if recording.program.inputs != len(points) or recording.rows != len(expected):
        return False
    try:
        with np.errstate(all="ignore"):
            results = recording.program.values(points.T)
    except ValueError:  # damaged
        return False
    rows = results[:, : recording.rows].T[:, (holds := recording.holds(results))]
    recording.checked = bool(holds[0]) and same(rows, expected[:, holds])
    return recording.checked


def _part(group: Array, parts: int, own: Array) -> Array:
    """Part to which every point belongs: its group, or one of parts of equal size."""
    if len(group) and parts == group[-1] + 1:
        return group
    return np.arange(len(own)) * parts // max(len(own), 1)


def same(first: Array, second: Array, floor: float | Array = 1.0) -> bool:
    """Whether results agree: NaN and infinity in the same places, values to rounding.

    `floor` is the size of values, or of each row (rows, 1), below which the difference counts as a
    share of it.
    """
    finite = np.isfinite(second)
    if not np.array_equal(finite, np.isfinite(first)):
        return False
    if not np.array_equal(first[~finite], second[~finite], equal_nan=True):
        return False
    room = AGREEMENT * np.maximum(np.abs(second), floor)[finite]
    return bool((np.abs(first[finite] - second[finite]) <= room).all())
