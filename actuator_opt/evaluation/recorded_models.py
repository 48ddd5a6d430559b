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

from ..base.numeric import Array, namespace
from ..base.symbolic.program import Program
from ..base.symbolic.recorded import RecordedFunction
from ..design.structure import leaves, number_of
from .build import Many, many, names_of_metrics, rows_of_many
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
    numbers = sorted(
        (
            path
            for path in read
            if path not in paths
            and (subject.numbers.get(path) or (path in bounds and path in subject.numbers))
        ),
        key=neutral.path,
    )
    factors = sorted(
        (key for key, value in subject.factors.items() if value),
        key=lambda key: (neutral.number[key[0]], *key[1:]),
    )
    tables = {
        (name, key): [entry.value, *chain.from_iterable(entry.points)]
        for name, material in subject.materials.items()
        for key, entry in material.properties.items()
        if entry.points and f"materials.{name}.{key}" in read
    }
    first, second = len(paths), len(paths) + len(numbers)
    third = second + len(factors)

    def rows(inputs: Array) -> Array:
        design, varied = subject, dict(zip(numbers, inputs[first:second], strict=True))
        further = inputs[second:]
        if namespace(inputs) is not np or (further != present[second:, None]).any():
            changed = dict(zip(factors, inputs[second:third], strict=True))
            design = replace(subject, factors=dict(subject.factors) | changed)
            design = _with_tables(design, tables, list(inputs[third:]))
        objectives, margins = evaluate(design, inputs[:first], varied)
        xp = namespace(margins)
        shown = [xp.broadcast_to(value, (1, inputs.shape[1])) for value in objectives]
        return xp.concatenate([*shown, margins])

    names = [*paths, *numbers, *map(str, factors)]
    known = [subject.numbers[path] for path in (*paths, *numbers)]
    known += [subject.factors[key] for key in factors]
    for place, values in tables.items():
        names += [f"{place} {k}" for k in range(len(values))]
        known += values
    present = np.array(known)
    places = [
        (x.limit_of.name, x.limit_of.metric, x.limit_of.sense, neutral.text(x.place), x.case_index)
        for x in limits
    ]
    structure = [*_structure(subject, read, neutral), list(map(neutral.path, paths)), places, goals]
    return RecordedFunction(rows, names, present, structure)


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
