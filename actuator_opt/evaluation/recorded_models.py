"""The models of a design as a recorded function of all numbers that they read.

Designs with equal structure share a recording: the same keys, laws and limits, with other numbers,
or with other materials that state the same properties. Inputs are therefore ordered by names in
which a number replaces each material's name, counted in the order of first use in the design.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np

from ..base.numeric import Array, complexed, duals_of, group_width, namespace
from ..base.symbolic import program as programs
from ..base.symbolic.program import Program
from ..base.symbolic.program_store import Recording
from ..base.symbolic.recorded import RecordedFunction
from ..design.structure import leaves, number_of
from . import kernel
from .build import Many, many, names_of_metrics, rows_of_many
from .duty_cycles.results import CycleModels
from .kernel import PreparedDesign
from .limits import LimitRow


def recorded_models(
    evaluate: Callable[[PreparedDesign, Array, Mapping[str, Array]], tuple[Sequence[Array], Array]],
    *,
    subject: PreparedDesign,
    paths: Sequence[str],
    read: Collection[str],
    limits: Sequence[LimitRow],
    goals: Sequence[Any],
) -> RecordedFunction:
    """Objectives and margins (rows) as a recorded function.

    Its inputs are the variables, the other numbers that the models read, the knock-down factors of
    strengths, and the tables of material properties. Numbers of zero are no inputs, except limits.

    Parameters
    ----------
    evaluate : objectives and margins of a design, at points (variables, n) with changed numbers
    subject : the prepared design
    paths : PATHs of the variables
    read : PATHs of all numbers that the models read
    limits : the limits of the margins
    goals : JSON data that describe the objectives
    """
    neutral = _Neutral(subject)
    bounds = {row.limit_of.path for row in limits}
    numbers, factors = _inputs(subject, paths, read, bounds, neutral)
    tables = _tables(subject, read)
    count, first = len(paths), len(numbers)
    second = first + len(factors)

    def changed(inputs: Array) -> tuple[PreparedDesign, dict[str, Array]]:
        """The design with the inputs after the variables, and the numbers among them."""
        design, varied = subject, dict(zip(numbers, inputs[:first], strict=True))
        if namespace(inputs) is not np or (inputs[first:] != present[count + first :, None]).any():
            factored = dict(zip(factors, inputs[first:second], strict=True))
            design = replace(subject, factors=dict(subject.factors) | factored)
            design = _with_tables(design, tables, list(inputs[second:]))
        return design, varied

    def rows(inputs: Array, results: Mapping[str, Array] = {}) -> Array:
        design, varied = changed(inputs[count:])
        objectives, margins = evaluate(design, inputs[:count], varied | dict(results))
        xp = namespace(margins)
        shown = [xp.broadcast_to(value, (1, inputs.shape[1])) for value in objectives]
        return xp.concatenate([*shown, margins])

    def duty_numbers(inputs: Array) -> Array:
        design, varied = changed(inputs[count:])
        values = varied | dict(zip(paths, inputs[:count], strict=True))
        numbers = kernel.duty_numbers(design, design.values(values))[1]
        return namespace(numbers).broadcast_to(numbers, (len(numbers), inputs.shape[1]))

    names = [*paths, *numbers, *map(str, factors)]
    names += [f"{place} {k}" for place, values in tables.items() for k in range(len(values))]
    known = [subject.numbers[path] for path in (*paths, *numbers)]
    known += [subject.factors[key] for key in factors]
    present = np.array([*known, *chain.from_iterable(tables.values())])
    structure = [
        *_structure(subject, read, neutral),
        list(map(neutral.path, paths)),
        [neutral.limit(row) for row in limits],
        goals,
    ]
    if subject.design.duty is None:
        return RecordedFunction(rows, names, present, structure)
    models = kernel.duty_numbers(subject, subject.values())[0]
    inner = RecordedFunction(duty_numbers, names, present, [*structure, "duty numbers"])
    return RecordedWithDuty(rows, names, present, structure, count, models, inner)


class RecordedWithDuty(RecordedFunction):
    """A recorded function with results of duty cycles between two recordings.

    The first recording computes the numbers of the design on which its cycles depend. The cycles
    then have their own models (`duty_cycles`). The second recording takes their results as inputs
    after the variables, so that its size does not depend on the number of samples.
    """

    def __init__(
        self,
        rows: Callable[..., Array],
        names: Sequence[str],
        present: Array,
        structure: Any,
        count: int,
        models: CycleModels,
        numbers: RecordedFunction,
    ) -> None:
        with np.errstate(all="ignore"):
            results = models(numbers.function(present[:, None]))[:, 0]
        paths = [place.path for place in models.places]
        self._count, self._width = count, len(paths)
        self._models, self._numbers = models, numbers
        self._wanted: tuple[Recording, Array] | None = None
        last = count + len(paths)

        def function(inputs: Array) -> Array:
            others = namespace(inputs).concatenate([inputs[:count], inputs[last:]])
            return rows(others, dict(zip(paths, inputs[count:last], strict=True)))

        super().__init__(
            function,
            [*names[:count], *paths, *names[count:]],
            np.concatenate([present[:count], results, present[count:]]),
            [structure, paths],
        )

    def __call__(self, points: Array) -> Array:
        """Results (rows, k) at points (inputs, k); results of the duty cycles are computed here."""
        if not self.reason and self.recording is None:
            self._record(self.present)  # which results are read is then known
        before = self.recording
        if before is not None and programs.AVAILABLE and np.iscomplexobj(points):
            chained = self._chained(points)
            if chained is not None:
                return chained
        rows = super().__call__(self._with_results(points))
        if before is not None and self.recording is not before:  # it may want other results
            return super().__call__(self._with_results(points))
        return rows

    def _chained(self, points: Array) -> Array | None:
        """Results at complex points by the two recordings and the cycles between them.

        None if a point takes another branch, or if groups of directions differ in size.
        """
        width = group_width(points)
        if not width:
            return None
        count, last = self._count, self._count + self._width
        whole = duals_of(points, width)
        inputs = np.concatenate([whole[:count], whole[last:]])
        own, seeds = inputs[:, :, 0].T, inputs[:, :, 1:].transpose(1, 0, 2)
        numbers = self._numbers.duals(np.empty((1, 0)), own, seeds)
        whole[count:last] = self._models.duals(numbers.transpose(1, 0, 2), self._used)
        found, holds = self._run(whole)
        if not holds.all():
            return None
        self.points += len(holds)
        return complexed(found)

    def _complete(self, points: Array, rows: Array, holds: Array) -> None:
        missing = ~holds
        if missing.any():  # another branch may want other results
            points = points.copy()
            points[:, missing] = self._with_results(points[:, missing], every=True)
        super()._complete(points, rows, holds)

    def confirmed(
        self, points: Array, expected: Array | None = None, floor: float | Array = 1.0
    ) -> bool:
        """Whether the machine and the function agree, see `RecordedFunction.confirmed`."""
        return super().confirmed(self._with_results(points, every=True), expected, floor)

    @property
    def _used(self) -> Array | None:
        """Whether the recording reads each result of the cycles; None without a recording."""
        if self.recording is None:
            return None
        if self._wanted is None or self._wanted[0] is not self.recording:
            used = self.recording.program.used_inputs()
            self._wanted = self.recording, used[self._count : self._count + self._width]
        return self._wanted[1]

    def _with_results(self, points: Array, *, every: bool = False) -> Array:
        """Points with the results of the duty cycles; those that are not read may be 0."""
        count, last = self._count, self._count + self._width
        variables, others = points[:count], points[last:]
        known = variables if len(points) <= last else np.concatenate([variables, others])
        width = group_width(known) if np.iscomplexobj(known) else None
        results = self._models(self._numbers(known), width, None if every else self._used)
        return np.concatenate([variables, results, others])


def _inputs(
    subject: PreparedDesign,
    paths: Sequence[str],
    read: Collection[str],
    bounds: Collection[str | None],
    neutral: _Neutral,
) -> tuple[list[str], list[tuple[str, str, bool]]]:
    """Numbers and knock-down factors that are inputs besides the variables, in order."""
    numbers = (
        path
        for path in read
        if path not in paths
        and (subject.numbers.get(path) or (path in bounds and path in subject.numbers))
    )
    factors = (key for key, value in subject.factors.items() if value)
    return (
        sorted(numbers, key=neutral.path),
        sorted(factors, key=lambda key: (neutral.number[key[0]], *key[1:])),
    )


def _tables(subject: PreparedDesign, read: Collection[str]) -> dict[tuple[str, str], list[float]]:
    """Numbers of all tables of properties that the models read, by material and property."""
    return {
        (name, key): [entry.value, *chain.from_iterable(entry.points)]
        for name, material in subject.materials.items()
        for key, entry in material.properties.items()
        if entry.points and f"materials.{name}.{key}" in read
    }


def _with_tables(
    subject: PreparedDesign, tables: dict[tuple[str, str], list[float]], inputs: list[Array]
) -> PreparedDesign:
    """The design with the numbers of its material tables replaced by inputs, in order."""
    materials, at = dict(subject.materials), 0
    for (name, key), values in tables.items():
        value, *points = inputs[at : at + len(values)]
        at += len(values)
        material = materials[name]
        entry = replace(
            material.properties[key],
            value=value,
            points=tuple(zip(points[::2], points[1::2], strict=True)),
        )
        materials[name] = replace(material, properties={**material.properties, key: entry})
    return replace(subject, materials=materials)


class RecordedMany:
    """Results of many designs that differ in the same numbers, as `evaluate_many` gives them.

    Parameters
    ----------
    subject : the prepared design, without custom metrics
    varied : arrays (designs,) by PATH of some designs, with which the recording is checked
    wanted : metrics to compute; default: all
    run : computes the outputs of a program, see `RecordedFunction`
    """

    def __init__(
        self,
        subject: PreparedDesign,
        varied: Mapping[str, Array],
        wanted: Container[str] | None = None,
        run: Callable[[Program, Array], Array] = Program.values,
    ) -> None:
        self.subject, self.paths = subject, tuple(varied)
        self.names = names_of_metrics(subject, wanted)
        self.read: set[str] = set()
        points = np.array([*varied.values()])
        with np.errstate(all="ignore"):
            expected = self._rows(subject, points, {})
            self._recorded = recorded_models(
                lambda *arguments: ((), self._rows(*arguments)),
                subject=subject,
                paths=self.paths,
                read=self.read,
                limits=(),
                goals=["many", self.names],
            )
            self._recorded.run = run
            computable = np.isfinite(expected).sum(axis=0)
            self._recorded.present[: len(points)] = points[:, np.argmax(computable)]
            self._recorded(points)
            finite = np.where(np.isfinite(expected), np.abs(expected), 0.0)
            size = finite.max(axis=1, keepdims=True)
            size[-2:] = 1.0  # margins are relative
            self._recorded.confirmed(points, expected, size)

    def __call__(self, varied: Mapping[str, Array]) -> Many:
        """Results for arrays (designs,) by PATH, SI."""
        points = np.array([varied[path] for path in self.paths])
        with np.errstate(all="ignore"):
            return many(self.subject, self.names, self._recorded(points), self.read)

    def _rows(self, subject: PreparedDesign, points: Array, numbers: Mapping[str, Array]) -> Array:
        v = subject.values(dict(zip(self.paths, points, strict=True)) | dict(numbers))
        rows = rows_of_many(subject, v, self.names, points.shape[1])
        self.read |= v.read
        return rows


class _Neutral:
    """Texts and PATHs in which a material's number in the design replaces its name or label."""

    def __init__(self, subject: PreparedDesign) -> None:
        self.number = {name: number for number, name in enumerate(subject.materials)}
        names = [(x.label, number) for number, x in enumerate(subject.materials.values())]
        names += self.number.items()
        self._names = sorted(names, key=lambda pair: len(pair[0]), reverse=True)

    def path(self, path: str) -> str:
        """A PATH; those of different numbers stay different."""
        block, _, rest = path.partition(".")
        name, _, key = rest.rpartition(".")
        return f"materials.{self.number[name]}.{key}" if block == "materials" else path

    def limit(self, row: LimitRow) -> tuple[str, str, str, str, int | None]:
        """Name, metric, sense, location and load case of a limit."""
        limit = row.limit_of
        return limit.name, limit.metric, limit.sense, self.text(row.place), row.case_index

    def text(self, text: str) -> str:
        """A text that may contain names or labels."""
        for name, number in self._names:
            if name and name in text:
                text = text.replace(name, f"material {number}")
        return text


def _structure(subject: PreparedDesign, read: Collection[str], neutral: _Neutral) -> list[Any]:
    """Data that determine the operations of the models, which read the numbers at PATHs `read`."""
    words = [
        (loc, neutral.text(str(value)) if number_of(value) is None else type(value).__name__)
        for loc, _, value in leaves(subject.design)
        if loc[0] not in ("name", "notes", "reproduces")
    ]
    materials = [
        (number, material.kind, material.family, key, entry.argument, len(entry.points))
        for number, material in enumerate(subject.materials.values())
        for key, entry in sorted(material.properties.items())
        if f"materials.{material.name}.{key}" in read
    ]
    zero = sorted(neutral.path(path) for path in read if subject.numbers.get(path) == 0)
    none = [(neutral.number[key[0]], *key[1:]) for key, x in subject.factors.items() if not x]
    structure = [words, materials, zero, sorted(none), dict(subject.reserves)]
    if subject.films:  # a table of oil films contains numbers, and is solved between the bounds
        bounds = {path: (x.lower, x.upper) for path, x in subject.design.variables.items()}
        structure += [dict(subject.numbers), list(subject.materials), bounds]
    return structure
