"""Rows of a stored sweep, with the margin of every limit and the section of every design."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..base.database import Reader, StoredNumbers, StoredRows, reading
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..design import Design, read_design
from ..evaluation import PreparedDesign
from ..evaluation.build import limits_of, margins_many
from ..evaluation.limits import MetricLimit
from ..evaluation.outline import Shapes, same_dimensions, shapes
from ..evaluation.plugin import Plugin, with_own
from ..metrics import METRICS
from ..version import VERSION
from .chunk import Study, key_head
from .plan import Plan, SweepAxis, SweepPoints

BEST = 100
"""Number of best feasible designs that thinning always keeps."""

VARIANTS = 1_000_000
"""Maximum number of text combinations (a choice, far above what sweeps use)."""


@dataclass(frozen=True)
class RowGroup:
    """Rows that share one prepared design, and their sections."""

    places: Array
    shapes: Shapes


@dataclass(frozen=True)
class Explored:
    """Rows (rows, columns) of a study in SI, in the order of the axes.

    `variant` numbers the texts of each row; `margins` is (limits, rows).
    """

    kept: StoredRows
    study: Study
    variants: tuple[dict[str, str], ...]
    variant: Array
    numbers: Array
    limits: tuple[MetricLimit, ...]
    margins: Array
    groups: tuple[RowGroup, ...]
    best: Array
    """Objective, to be minimised."""
    most: int
    """Number of rows above which a study is thinned."""
    origin: str = "Study"
    """Where the rows come from."""
    shown: tuple[str, ...] = ()
    """Initial metrics of the x and y axis, where not the default."""
    damaged: int = 0
    """Damaged rows, which are left out."""

    @property
    def kind(self) -> str:
        """Return the name of this kind of data."""
        return "designs" if self.shown else "sweep"

    @property
    def failed(self) -> int:
        """Return the number of failed designs, which have no results."""
        return sum(self.kept.failures.values())

    @property
    def thinned(self) -> bool:
        """Whether some rows were left out."""
        return len(self.numbers) < self.kept.rows - self.failed


def explored(
    path: Path,
    *,
    study: int | str | None = None,
    most: int = 5000,
    plugins: tuple[Plugin, ...] = (),
) -> Explored:
    """Read a stored sweep, thinned to a maximum number of rows.

    Parameters
    ----------
    path : database of sweeps
    study : its number, or its hash; default: the newest
    most : rows; larger studies keep every n-th row by key, and the best feasible ones
    plugins : the user's metrics and constraints, as in the sweep

    Raises
    ------
    InputError
        no such file or study, or rows of other models, materials or custom metrics
    """
    with reading(path, VERSION) as reader:
        kept = reader.study(reader.number(study) if isinstance(study, str) else study)
        failed = sum(kept.failures.values())
        _, some = next(reader.rows(kept), (None, None))
        if some is None:
            raise _none_whole(kept, path)
        bare = _study(kept, plugins, path, np.stack([some.min(axis=0), some.max(axis=0)], axis=1))
        keys, numbers, good = _thinned(reader, kept, bare, kept.rows - failed, most)
        damaged = kept.rows - failed - good
        kept = kept._replace(rows=failed + good)
    variants = _variants(kept, path)
    variant = _texts_of(keys, numbers, bare, variants, path)
    order = np.lexsort((*(numbers[:, k] for k in reversed(range(len(bare.order)))), variant))
    numbers, variant = numbers[order], variant[order]
    limits, margins, groups = _evaluated(bare, variant, numbers)
    return Explored(
        kept,
        bare,
        variants,
        variant,
        numbers,
        limits,
        margins,
        groups,
        bare.judged(0, StoredNumbers(numbers, {}), 0).objective,
        most,
        origin=f"Study {kept.number}",
        damaged=damaged,
    )


def _none_whole(kept: StoredRows, path: Path) -> InputError:
    """Explain why a study has no results."""
    if not kept.failures:
        message = f"study {kept.number}: its rows are damaged"
        return InputError(Diagnostic(message, "run the sweep again with --store", str(path)))
    message = f"study {kept.number}: every design failed: {next(iter(kept.failures))}"
    return InputError(Diagnostic(message, "vary other values", str(path)))


def explored_designs(
    design: Design,
    points: Sequence[Mapping[str, float]],
    *,
    plugins: tuple[Plugin, ...] = (),
    origin: str,
    shown: tuple[str, ...] = (),
) -> Explored:
    """Return designs that differ in numbers, as if read from a stored sweep.

    Parameters
    ----------
    design : common design, without free variables
    points : numbers of each design, by PATH (SI)
    plugins : the user's metrics and constraints
    origin, shown : as `Explored`
    """
    paths = sorted(points[0])
    values = np.array([[point[path] for point in points] for path in paths])
    axes = tuple(
        SweepAxis(path, np.array([row.min(), row.max()]), range=True, count=2)
        for path, row in zip(paths, values, strict=True)
    )
    study = Study(design, Plan(axes, "grid", 0), plugins)
    variant = np.zeros(len(points), dtype=np.int64)
    numbers = study.evaluated(0, SweepPoints(variant, values)).rows.numbers
    limits, margins, groups = _evaluated(study, variant, numbers)
    return Explored(
        StoredRows(0, study.hash, design.name, study.text, study.columns, len(points), {}, {}),
        study,
        ({},),
        variant,
        numbers,
        limits,
        margins,
        groups,
        study.judged(0, StoredNumbers(numbers, {}), 0).objective,
        len(points),
        origin,
        shown,
    )


def _evaluated(
    study: Study, variant: Array, numbers: Array
) -> tuple[tuple[MetricLimit, ...], Array, tuple[RowGroup, ...]]:
    """Return the limits, the margin of each in every row, and the sections.

    Rows that need separate prepared designs, for temperatures say, share the sections of one of
    them if it has their dimensions.
    """
    paths = [axis.path for axis in study.plan.numeric]
    limits: dict[str, MetricLimit] = {}
    margins: dict[str, Array] = {}
    alone: list[tuple[Array, PreparedDesign]] = []
    shared: dict[int, tuple[list[Array], PreparedDesign]] = {}
    points = SweepPoints(variant, numbers[:, : len(paths)].T)
    for places, subject, varied in study.designs.groups(points):
        if isinstance(subject, str):
            continue
        limits |= {limit.name: limit for limit in limits_of(subject)}
        for name, margin in margins_many(subject, varied, len(places)).items():
            margins.setdefault(name, np.full(len(numbers), np.inf))[places] = margin
        first = shared.setdefault(int(variant[places[0]]), ([], subject))
        every = {path: numbers[places, k] for k, path in enumerate(paths)}
        if same_dimensions((first[1], every), (subject, varied), len(places)):
            first[0].append(places)
        else:
            alone.append((places, subject))
    alone += [(np.concatenate(places), subject) for places, subject in shared.values() if places]
    groups = []
    for places, subject in alone:
        every = {path: numbers[places, k] for k, path in enumerate(paths)}
        drawn = shapes(subject, every, len(places), _hidden(study))
        groups.append(RowGroup(places, drawn))
    return tuple(limits[name] for name in margins), np.stack(list(margins.values())), tuple(groups)


def _hidden(study: Study) -> tuple[str, ...]:
    """Return the parts whose outline does not follow their varied numbers."""
    moved = any(axis.path.startswith("rod.fitting.") for axis in study.plan.axes)
    return ("rod.fitting",) if moved else ()


def _variants(kept: StoredRows, path: Path) -> tuple[dict[str, str], ...]:
    if math.prod(len(texts) for texts in kept.texts.values()) > VARIANTS:
        message = f"study {kept.number} has over {VARIANTS} combinations of texts"
        raise InputError(Diagnostic(message, "vary fewer of them", str(path)))
    paths = list(kept.texts)
    return tuple(
        dict(zip(paths, texts, strict=True)) for texts in itertools.product(*kept.texts.values())
    )


def _study(kept: StoredRows, plugins: tuple[Plugin, ...], path: Path, ends: Array) -> Study:
    """Return the study that made the rows, from the design stored in the database.

    Its plan has the texts, and the numbers in column order, each between its `ends` in the rows. It
    visits no points.
    """
    own = with_own(plugins)
    try:
        design = read_design(f"{kept.design}\n", metrics=own).design
    except InputError:
        raise _another(path) from None
    names = [column.name for column in kept.columns]
    if next(iter(METRICS)) not in names:
        raise _another(path)
    first = names.index(next(iter(METRICS)))
    numeric = [
        SweepAxis(column.name, np.array([low, high]), range=True, count=2)
        for column, (low, high) in zip(kept.columns[:first], ends, strict=False)
    ]
    named = [SweepAxis(name, None, texts) for name, texts in kept.texts.items()]
    study = Study(design, Plan((*named, *numeric), "grid", 0), plugins)
    if study.hash != kept.hash or study.columns != kept.columns:
        raise _another(path)
    return study


def _another(path: Path) -> InputError:
    message = "its rows come from other materials, or from custom metrics"
    remedy = "add --plugin FILE.py as in the sweep, or run the sweep again"
    return InputError(Diagnostic(message, remedy, str(path)))


def _thinned(
    reader: Reader, kept: StoredRows, study: Study, good: int, most: int
) -> tuple[list[bytes], Array, int]:
    """Return rows spread evenly over the study, its best rows, and the number of valid rows."""
    step = -(-good // most)
    keys: list[bytes] = []
    numbers: list[Array] = []
    best = _Best([], np.empty((0, len(kept.columns))), np.empty(0))
    start = 0
    for some, data in reader.rows(kept):
        chosen = range(-start % step, len(some), step)
        keys += [some[k] for k in chosen]
        numbers.append(data[list(chosen)])
        if step > 1:
            best = best.joined(some, study.judged(0, StoredNumbers(data, {}), 0).objective, data)
        start += len(some)
    known = set(keys)
    extra = [k for k, key in enumerate(best.keys) if key not in known]
    keys += [best.keys[k] for k in extra]
    return keys, np.concatenate([*numbers, best.numbers[extra]]), start


@dataclass(frozen=True)
class _Best:
    """The best feasible rows so far."""

    keys: list[bytes]
    numbers: Array
    objective: Array

    def joined(self, keys: list[bytes], objective: Array, numbers: Array) -> _Best:
        good = np.flatnonzero(numbers[:, -1] == 1.0)
        every = [*self.keys, *(keys[k] for k in good)]
        values = np.concatenate([self.objective, objective[good]])
        rows = np.concatenate([self.numbers, numbers[good]])
        order = np.argsort(values, kind="stable")[:BEST]
        return _Best([every[k] for k in order], rows[order], values[order])


def _texts_of(
    keys: list[bytes],
    numbers: Array,
    study: Study,
    variants: tuple[dict[str, str], ...],
    path: Path,
) -> Array:
    """Return the number of each row's texts, found through its key."""
    data = np.ascontiguousarray(numbers[:, : len(study.order)], dtype="<f8")
    heads = [key_head(texts) for texts in variants]
    found = np.empty(len(keys), dtype=np.int64)
    last = 0
    for row, key in enumerate(keys):
        tail = data[row].tobytes()
        for number in itertools.chain([last], range(len(heads))):
            digest = heads[number].copy()
            digest.update(tail)
            if digest.digest() == key:
                found[row] = last = number
                break
        else:
            message = "holds rows whose texts are not in its list"
            raise InputError(Diagnostic(message, "run the sweep again with --store", str(path)))
    return found
