"""Read the rows of a stored sweep; add margins of all limits and drawn sections of all designs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..base.database import Reader, StoredNumbers, StoredRows, reading
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..design import Design, read_design
from ..evaluation import PreparedDesign
from ..evaluation.build import limits_of, margins_many
from ..evaluation.limits import MetricLimit
from ..evaluation.outline_templates import Shapes, same_dimensions, shapes
from ..evaluation.plugin import Plugin, with_own
from ..metrics import METRICS
from ..version import VERSION
from .chunk import Study, key_head
from .plan import Plan, SweepAxis, SweepPoints

BEST = 100
"""Number of best feasible designs that are kept even if rows are thinned out."""

VARIANTS = 1_000_000
"""Maximum number of combinations of texts, such as materials (our choice, far above those of real
sweeps)."""


@dataclass(frozen=True)
class RowGroup:
    """Rows that share a prepared design, with the section drawings of their designs."""

    places: Array
    shapes: Shapes


@dataclass(frozen=True)
class Explored:
    """Rows of a study, one row per design, SI.

    `numbers` is (rows, columns), with the varied numbers first. `variants` are the combinations of
    texts (choices such as materials); `variant` is the index of the combination of each row.
    `margins` is (limits, rows).
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
    """Objective of each row, to be minimised."""
    most: int
    """Number of rows above which only every n-th row is read."""
    origin: str = "Study"
    """Name for the source of the rows, as shown to the user."""
    shown: tuple[str, ...] = ()
    """Metrics shown first on the x and y axis; empty for the default."""
    damaged: int = 0
    """Number of damaged rows, which are omitted."""

    @property
    def kind(self) -> str:
        """Return the kind of the data: "designs" or "sweep"."""
        return "designs" if self.shown else "sweep"

    @property
    def failed(self) -> int:
        """Return the number of failed designs, which have no results."""
        return sum(self.kept.failures.values())

    @property
    def thinned(self) -> bool:
        """Whether some rows were omitted because there are too many."""
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
    study : number or hash of the study in the database; default: the newest
    most : maximum number of rows; of larger studies, only every n-th row in the order of keys is
        read, and the best feasible rows in addition
    plugins : the user's metrics and constraints, as in the sweep

    Raises
    ------
    InputError
        if file or study are missing, or other models, materials or custom metrics made the rows
    """
    with reading(path, VERSION) as reader:
        stored = reader.study(reader.number(study) if isinstance(study, str) else study)
        failed = sum(stored.failures.values())
        _, rows = next(reader.rows(stored), (None, None))
        if rows is None:
            raise _no_results(stored, path)
        rebuilt = _study(
            stored, plugins, path, np.stack([rows.min(axis=0), rows.max(axis=0)], axis=1)
        )
        keys, numbers, valid = _thinned(reader, stored, rebuilt, stored.rows - failed, most)
        damaged = stored.rows - failed - valid
        stored = stored._replace(rows=failed + valid)
    variants = _variants(stored, path)
    variant = _text_numbers(keys, numbers, rebuilt, variants, path)
    order = np.lexsort((*(numbers[:, k] for k in reversed(range(len(rebuilt.order)))), variant))
    numbers, variant = numbers[order], variant[order]
    limits, margins, groups = _evaluated(rebuilt, variant, numbers)
    return Explored(
        stored,
        rebuilt,
        variants,
        variant,
        numbers,
        limits,
        margins,
        groups,
        rebuilt.judged(0, StoredNumbers(numbers, {}), 0).objective,
        most,
        origin=f"Study {stored.number}",
        damaged=damaged,
    )


def _no_results(stored: StoredRows, path: Path) -> InputError:
    """Explain why a study has no results."""
    if not stored.failures:
        message = f"study {stored.number}: its rows are damaged"
        return InputError(Diagnostic(message, "run the sweep again with --store", str(path)))
    message = f"study {stored.number}: every design failed: {next(iter(stored.failures))}"
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
    design : the common design, without free variables; each point changes some of its numbers
    points : numbers of each design, by PATH (SI)
    plugins : the user's metrics and constraints
    origin, shown : as in `Explored`
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
    """Return the limits, the margin of each limit in every row, and the drawn sections.

    Rows whose designs are prepared separately, for example due to temperatures, still share section
    drawings if their dimensions are equal.
    """
    paths = [axis.path for axis in study.plan.numeric]
    limits: dict[str, MetricLimit] = {}
    margins: dict[str, Array] = {}
    separate: list[tuple[Array, PreparedDesign]] = []
    shared: dict[int, tuple[list[Array], PreparedDesign]] = {}
    points = SweepPoints(variant, numbers[:, : len(paths)].T)
    for places, subject, varied in study.designs.groups(points):
        if isinstance(subject, str):
            continue
        limits |= {limit.name: limit for limit in limits_of(subject)}
        for name, margin in margins_many(subject, varied, len(places)).items():
            margins.setdefault(name, np.full(len(numbers), np.inf))[places] = margin
        first = shared.setdefault(int(variant[places[0]]), ([], subject))
        varied_numbers = {path: numbers[places, k] for k, path in enumerate(paths)}
        if same_dimensions((first[1], varied_numbers), (subject, varied), len(places)):
            first[0].append(places)
        else:
            separate.append((places, subject))
    separate += [(np.concatenate(places), subject) for places, subject in shared.values() if places]
    groups = []
    for places, subject in separate:
        varied_numbers = {path: numbers[places, k] for k, path in enumerate(paths)}
        sections = shapes(subject, varied_numbers, len(places), _hidden(study))
        groups.append(RowGroup(places, sections))
    return tuple(limits[name] for name in margins), np.stack(list(margins.values())), tuple(groups)


def _hidden(study: Study) -> tuple[str, ...]:
    """Return the parts whose drawn outline does not follow the varied numbers."""
    fitting_varies = any(axis.path.startswith("rod.fitting.") for axis in study.plan.axes)
    return ("rod.fitting",) if fitting_varies else ()


def _variants(stored: StoredRows, path: Path) -> tuple[dict[str, str], ...]:
    if math.prod(len(texts) for texts in stored.texts.values()) > VARIANTS:
        message = f"study {stored.number} has over {VARIANTS} combinations of text values"
        raise InputError(Diagnostic(message, "vary fewer of them", str(path)))
    paths = list(stored.texts)
    return tuple(
        dict(zip(paths, texts, strict=True)) for texts in itertools.product(*stored.texts.values())
    )


def _study(stored: StoredRows, plugins: tuple[Plugin, ...], path: Path, ends: Array) -> Study:
    """Return the study that made the rows, from the design stored in the database.

    The plan of the study has the varied texts, and the varied numbers in column order, each with
    its smallest and largest value in the rows (`ends`). The plan contains no points.
    """
    metrics = with_own(plugins)
    try:
        design = read_design(f"{stored.design}\n", metrics=metrics).design
    except InputError:
        raise _other_models(path) from None
    names = [column.name for column in stored.columns]
    if next(iter(METRICS)) not in names:
        raise _other_models(path)
    first = names.index(next(iter(METRICS)))
    numeric = [
        SweepAxis(column.name, np.array([low, high]), range=True, count=2)
        for column, (low, high) in zip(stored.columns[:first], ends, strict=False)
    ]
    named = [SweepAxis(name, None, texts) for name, texts in stored.texts.items()]
    study = Study(design, Plan((*named, *numeric), "grid", 0), plugins)
    if study.hash != stored.hash or study.columns != stored.columns:
        raise _other_models(path)
    return study


def _other_models(path: Path) -> InputError:
    message = "its rows were computed with other materials or models, or with custom metrics"
    remedy = "add --plugin FILE.py as in that sweep, or run the sweep again"
    return InputError(Diagnostic(message, remedy, str(path)))


def _thinned(
    reader: Reader, stored: StoredRows, study: Study, count: int, most: int
) -> tuple[list[bytes], Array, int]:
    """Return keys and numbers of evenly spread and of the best rows; and the valid rows' count."""
    step = -(-count // most)
    keys: list[bytes] = []
    numbers: list[Array] = []
    best = _Best([], np.empty((0, len(stored.columns))), np.empty(0))
    start = 0
    for batch, data in reader.rows(stored):
        chosen = range(-start % step, len(batch), step)
        keys += [batch[k] for k in chosen]
        numbers.append(data[list(chosen)])
        if step > 1:
            best = best.joined(batch, study.judged(0, StoredNumbers(data, {}), 0).objective, data)
        start += len(batch)
    chosen_keys = set(keys)
    additional = [k for k, key in enumerate(best.keys) if key not in chosen_keys]
    keys += [best.keys[k] for k in additional]
    return keys, np.concatenate([*numbers, best.numbers[additional]]), start


@dataclass(frozen=True)
class _Best:
    """The best feasible rows read so far."""

    keys: list[bytes]
    numbers: Array
    objective: Array

    def joined(self, keys: list[bytes], objective: Array, numbers: Array) -> _Best:
        feasible = np.flatnonzero(numbers[:, -1] == 1.0)
        all_keys = [*self.keys, *(keys[k] for k in feasible)]
        values = np.concatenate([self.objective, objective[feasible]])
        rows = np.concatenate([self.numbers, numbers[feasible]])
        order = np.argsort(values, kind="stable")[:BEST]
        return _Best([all_keys[k] for k in order], rows[order], values[order])


def _text_numbers(
    keys: list[bytes],
    numbers: Array,
    study: Study,
    variants: tuple[dict[str, str], ...],
    path: Path,
) -> Array:
    """Return, for each row, the index of its combination of texts, found by the row's key."""
    data = np.ascontiguousarray(numbers[:, : len(study.order)], dtype="<f8")
    heads = [key_head(texts) for texts in variants]
    text_numbers = np.empty(len(keys), dtype=np.int64)
    last = 0
    for row, key in enumerate(keys):
        tail = data[row].tobytes()
        for number in itertools.chain([last], range(len(heads))):
            digest = heads[number].copy()
            digest.update(tail)
            if digest.digest() == key:
                text_numbers[row] = last = number
                break
        else:
            message = "contains rows with text values that the study does not list"
            raise InputError(Diagnostic(message, "run the sweep again with --store", str(path)))
    return text_numbers
