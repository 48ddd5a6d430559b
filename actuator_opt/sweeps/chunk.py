"""Evaluate one chunk of a sweep; designs that differ only in numbers are evaluated together."""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import json
from collections.abc import Mapping, Sequence
from dataclasses import field, replace

import numpy as np

from ..base.database import NumberColumn, StoredNumbers
from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.numeric import Array
from ..base.quantities import Quantity
from ..base.symbolic import gpu
from ..base.symbolic.program import Program
from ..design import Design
from ..design.data_file import portable
from ..design.paths import quantity_of
from ..design.writer import to_yaml
from ..evaluation import PreparedDesign
from ..evaluation.build import Many, evaluate_many, limits_of, spec_hash
from ..evaluation.plugin import Plugin
from ..evaluation.recorded_models import RecordedMany
from ..optimisation.actuator import Goal, goal_of
from .designs import CACHED, Designs, first_fault
from .plan import Plan, SweepPoints
from .screen import Engine, Scores, rounded_up, screen

BATCH = 1024
"""Number of designs that are evaluated at once if only the best of a chunk are wanted."""

RECORDED_FROM = 16_384
"""Smallest number of points for which recording the models saves time (our choice: it takes as long
as 5000 to 15 000 points of the models themselves)."""

LEAST_RECORDED = 4096
"""Smallest number of points of a prepared design that is recorded (our choice)."""

SAMPLE = 16
"""Number of points of every prepared design at which its recording is compared with the models."""

LEAST_SCREENED = 2048
"""Smallest number of designs for which a screen (see `sweeps.screen`) saves time; building one
takes some 20 ms."""

NO_ANSWER = "not computable for these dimensions"
MARGIN, MISSED, FEASIBLE = "least_margin", "governing_limit", "feasible"
"""Names of the columns that follow the metrics in each row: least margin of all limits, number of
the limit with this margin, and whether all limits are met."""


@dataclass(frozen=True)
class Chunk:
    """Results of consecutive points of a sweep, one row per point, starting with point `first`.

    `computed` is the number of rows that were computed instead of read from a database. A reduced
    chunk only contains the points with the numbers `places`; all other points of the chunk cannot
    be among the best designs.
    """

    first: int
    rows: StoredNumbers
    computed: int
    objective: Array
    feasible: Array
    places: Array | None = None
    damaged: int = 0
    """Number of rows that were computed again because they are damaged in the database."""

    @property
    def ranked(self) -> Array:
        """Whether each row may be among the best: it is feasible and has an objective."""
        ranked: Array = self.feasible & ~np.isnan(self.objective)
        return ranked

    @property
    def numbers(self) -> Array:
        """Return the point number of each row."""
        return self.first + np.arange(len(self.objective)) if self.places is None else self.places


@dataclass
class Study:
    """A design with the axes of its sweep; computes the row of results for any point."""

    design: Design
    plan: Plan
    plugins: tuple[Plugin, ...] = ()
    full: bool = True
    """Whether to compute every metric, or only those that rank designs."""
    more: tuple[str, ...] = ()
    """Metrics to compute in addition to those that rank designs."""
    only: tuple[str, ...] | None = None
    """In a full sweep, the metrics in the rows; None: all."""
    engine: Engine = "numpy"
    """Array library for the screen, the function that excludes designs that cannot be among the
    best; or "gpu", which runs the recorded models of a full sweep on a GPU."""
    goal: Goal = field(init=False)
    designs: Designs = field(init=False)
    _screens: dict[tuple[object, ...], Scores | None] = field(default_factory=dict, repr=False)
    _recorded: dict[int, RecordedMany] = field(default_factory=dict, repr=False)
    """Recorded models of prepared designs, by `id`."""

    def __post_init__(self) -> None:
        self.designs = Designs(self.design, self.plan, self.plugins)
        subject = self.designs.made({})
        self.goal = goal_of(subject)
        self._quantities = dict(subject.quantities)
        self.binding = limits_of(subject)
        self.limits = tuple(limit.name for limit in self.binding)
        needed = {limit.metric for limit in self.binding} | {*self.goal.weights, "mass", *self.more}
        if self.only is not None:
            needed = {*self.only, *self.goal.weights, "mass"}
        every = (self.full and self.only is None) or self.plugins
        self.wanted = None if every else frozenset(needed)
        self.metrics = tuple(
            name for name in self._quantities if self.wanted is None or name in self.wanted
        )
        paths = [axis.path for axis in self.plan.numeric]
        self.order = sorted(range(len(paths)), key=paths.__getitem__)
        """Indices of the numeric axes in the order of the columns, which are sorted by PATH."""
        self.columns = (
            *(
                NumberColumn(paths[k], quantity_of(paths[k], self.design).si_unit)
                for k in self.order
            ),
            *(NumberColumn(name, subject.quantities[name].si_unit) for name in self.metrics),
            NumberColumn(MARGIN, "1"),
            NumberColumn(MISSED, "1"),
            NumberColumn(FEASIBLE, "1"),
        )

    def __getstate__(self) -> dict[str, object]:
        return self.__dict__ | {"_screens": {}, "_recorded": {}}

    def chunk(self, first: int, count: int, places: Array | None = None) -> Chunk:
        """Return the rows of consecutive points, or only of the points at the indices `places`."""
        points = self.plan.points(first, count)
        return self.evaluated(first, points if places is None else points.some(places))

    def evaluated(self, first: int, points: SweepPoints, keep_best: int | None = None) -> Chunk:
        """Return the rows of results for some points.

        A feasible design also counts as failed if the reader of design files would reject it. With
        `keep_best`, feasible designs are checked from the best on, until that many are valid.
        """
        n = len(points.variant)
        rows = np.full((n, len(self.columns)), np.nan)
        rows[:, : len(points.numbers)] = points.numbers[self.order].T
        failures: dict[int, str] = {}
        mass = self.metrics.index("mass")
        for places, subject, varied in self.designs.groups(points):
            if isinstance(subject, str):
                failures |= dict.fromkeys(map(int, places), subject)
                continue
            many = self._many(subject, varied, len(places))
            self._fill(rows, places, many)
            failed = places[np.isnan(many.values[mass])]
            failures |= dict.fromkeys(map(int, failed), NO_ANSWER)
        rows[list(failures), len(points.numbers) :] = np.nan
        chunk = self.judged(first, StoredNumbers(rows, failures), n)
        if not self.designs.contradicts:
            return chunk
        failures |= self._contradictions(chunk, points, keep_best)
        rows[list(failures), len(points.numbers) :] = np.nan
        return self.judged(first, StoredNumbers(rows, failures), n)

    @property
    def recorded(self) -> bool:
        """Whether the models are recorded: only if there are enough points, and no custom metrics.

        It depends on the plan and the engine alone, so that every run of a sweep gives the same
        rows. A GPU runs recorded models only.
        """
        enough = self.plan.count >= RECORDED_FROM and self._group_size >= LEAST_RECORDED
        return not self.plugins and (enough or self.engine == "gpu")

    @property
    def _group_size(self) -> float:
        """Mean number of points of a prepared design."""
        return self.plan.count / self.plan.variants / self.designs.apart_count

    def _many(self, subject: PreparedDesign, varied: dict[str, Array], count: int) -> Many:
        """Results of designs that differ in numbers, by recorded models if these save time."""
        if not self.recorded or not varied.keys() <= subject.numbers.keys():
            return evaluate_many(subject, varied, count, self.wanted)
        if id(subject) not in self._recorded:
            if len(self._recorded) >= CACHED:
                self._recorded.pop(next(iter(self._recorded)))
            paths = [axis.path for axis in self.plan.numeric]
            places = np.linspace(0, self.plan.count - 1, SAMPLE).astype(int)
            sample = np.concatenate([self.plan.points(k, 1).numbers for k in places], axis=1)
            run = gpu.values if self.engine == "gpu" else Program.values
            points = {path: sample[k] for k, path in enumerate(paths) if path in varied}
            self._recorded[id(subject)] = RecordedMany(subject, points, self.wanted, run)
        return self._recorded[id(subject)](varied)

    def reduced(self, first: int, count: int, limit: float, keep: int) -> Chunk:
        """Return the rows that may be among the `keep` best, with an objective below `limit`.

        Points are evaluated in the order of their estimated objective, until no other point can
        improve on the best `keep`.
        """
        points = self.plan.points(first, count)
        scores = self._scores(points, limit)
        order = np.argsort(scores, kind="stable")
        order = order[scores[order] < np.inf]
        parts: list[Chunk] = []
        best: list[float] = []
        for start in range(0, len(order), BATCH):
            batch = order[start : start + BATCH]
            if len(best) == keep and scores[batch[0]] > rounded_up(best[-1]):
                break
            part = self.evaluated(first, points.some(batch), keep)
            parts.append(replace(part, places=first + batch))
            best = sorted([*best, *part.objective[part.ranked].tolist()])[:keep]
        return self._joined(first, parts, len(scores), keep)

    def _scores(self, points: SweepPoints, limit: float) -> Array:
        """Return the estimated objective of each point: inf if excluded, -inf if unknown."""
        scores = np.full(len(points.variant), -np.inf)
        apart = self.designs.apart
        varied = [k for k, axis in enumerate(self.plan.numeric) if axis.path not in apart]
        for indices, variant, fixed in self.designs.alike(points):
            sieve = self._screen(variant, fixed)
            if sieve is not None:
                scores[indices] = sieve(points.numbers[np.ix_(varied, indices)], limit)
        return scores

    def _joined(self, first: int, parts: Sequence[Chunk], computed: int, keep: int) -> Chunk:
        """Join parts into one reduced chunk; of the feasible designs, keep only the `keep` best."""
        rows, failures, places = [np.empty((0, len(self.columns)))], {}, [np.empty(0, dtype=int)]
        count = 0
        for part in parts:
            feasible = np.flatnonzero(part.feasible)
            surplus = feasible[np.argsort(part.objective[feasible], kind="stable")[keep:]]
            remaining = np.setdiff1d(np.arange(len(part.feasible)), surplus)
            rows.append(part.rows.numbers[remaining])
            places.append(part.numbers[remaining])
            for k in np.flatnonzero(np.isin(remaining, list(part.rows.failures))):
                failures[count + int(k)] = part.rows.failures[int(remaining[k])]
            count += len(remaining)
        joined = self.judged(first, StoredNumbers(np.concatenate(rows), failures), computed)
        return replace(joined, places=np.concatenate(places))

    def _screen(self, variant: int, fixed: Mapping[str, float]) -> Scores | None:
        """Return a screen for designs that differ only in numbers, if there are enough of them.

        None if the user has added metrics, because these are Python functions and not closed-form
        expressions.
        """
        axes = [axis for axis in self.plan.numeric if axis.path not in self.designs.apart]
        if not axes or self.plugins or self._group_size < LEAST_SCREENED:
            return None
        key = (variant, *fixed.values())
        if key not in self._screens:
            if len(self._screens) >= CACHED:
                self._screens.pop(next(iter(self._screens)))
            scores: Scores | None = None
            values: dict[str, float | str] = {**self.plan.texts(variant), **fixed}
            ends = np.array([axis.ends for axis in axes])
            with contextlib.suppress(InputError):
                design = self.designs.changed(values)
                scores = screen(design, [axis.path for axis in axes], ends, self.engine)
            self._screens[key] = scores
        return self._screens[key]

    def _contradictions(
        self, chunk: Chunk, points: SweepPoints, enough: int | None
    ) -> dict[int, str]:
        """Return the faults of feasible rows whose designs the reader of design files would reject.

        Rows are checked from the best on, until `enough` valid rows are found.
        """
        faults: dict[int, str] = {}
        feasible = np.flatnonzero(chunk.feasible)
        order = feasible[np.argsort(chunk.objective[feasible], kind="stable")]
        for checked, k in enumerate(map(int, order)):
            if enough is not None and checked - len(faults) >= enough:
                break
            try:
                self.designs.changed(self._at(points, k))
            except InputError as error:
                faults[k] = first_fault(error)
        return faults

    def judged(self, first: int, rows: StoredNumbers, computed: int) -> Chunk:
        """Return rows as a chunk, with their objective (to be minimised) and feasibility."""
        place = {column.name: k for k, column in enumerate(self.columns)}
        total = np.zeros(len(rows.numbers))
        for name, weight in self.goal.weights.items():
            total += weight / self.goal.scales[name] * rows.numbers[:, place[name]]
        feasible = rows.numbers[:, place[FEASIBLE]] == 1.0
        return Chunk(first, rows, computed, self.goal.sign * total, feasible)

    def _fill(self, rows: Array, places: Array, many: Many) -> None:
        start = len(self.plan.numeric)
        whole = len(places) == len(rows)
        block = rows if whole else np.empty((len(places), rows.shape[1]))
        block[:, start:-3] = many.values.T
        block[:, -3] = np.where(np.isfinite(many.margin), many.margin, np.nan)
        block[:, -2], block[:, -1] = many.missed, many.feasible
        if not whole:
            rows[places, start:] = block[:, start:]

    def quantity(self, metric: str) -> Quantity:
        """Return the quantity of a metric."""
        return self._quantities[metric]

    def place(self, name: str) -> int:
        """Return the number of the column with this name: a PATH, a metric or, e.g., `MARGIN`."""
        return next(k for k, column in enumerate(self.columns) if column.name == name)

    @property
    def text(self) -> str:
        """Return the design as the text of its file, which contains the texts of its data files."""
        return to_yaml(portable(self.design), metrics=self._quantities)

    def values(self, number: int) -> dict[str, float | str]:
        """Return the varied values of a point, by PATH (SI)."""
        return self._at(self.plan.points(number, 1), 0)

    def _at(self, points: SweepPoints, k: int) -> dict[str, float | str]:
        paths = [axis.path for axis in self.plan.numeric]
        numbers = dict(zip(paths, map(float, points.numbers[:, k]), strict=True))
        values: dict[str, float | str] = {**numbers, **self.plan.texts(int(points.variant[k]))}
        return {axis.path: values[axis.path] for axis in self.plan.axes}

    @property
    def hash(self) -> str:
        """Return a hash of the design, materials, models, custom metrics and varied PATHs."""
        sources = [_source(plugin) for plugin in self.plugins]
        paths = sorted(axis.path for axis in self.plan.axes)
        text = json.dumps([spec_hash(self.designs.made({})), sources, paths, self.columns])
        return hashlib.sha256(text.encode()).hexdigest()[:32]

    def keys(self, first: int, count: int) -> list[bytes]:
        """Return the database keys of the points of a chunk, which are hashes of their values."""
        points = self.plan.points(first, count)
        data = np.ascontiguousarray(points.numbers[self.order].T, dtype="<f8").tobytes()
        width = 8 * len(points.numbers)
        heads = {
            variant: key_head(self.plan.texts(variant))
            for variant in map(int, np.unique(points.variant))
        }
        digests = []
        for k, variant in enumerate(points.variant.tolist()):
            digest = heads[variant].copy()
            digest.update(data[k * width : (k + 1) * width])
            digests.append(digest.digest())
        return digests


def key_head(texts: Mapping[str, str]) -> hashlib.blake2b:
    """Return a hash object for the texts of a point; updating it with the numbers gives the key."""
    return hashlib.blake2b(json.dumps(dict(texts), sort_keys=True).encode(), digest_size=16)


def _source(plugin: Plugin) -> str:
    """Return the source code of a custom metric, so that a changed metric makes a new study."""
    try:
        return inspect.getsource(plugin.function)
    except (OSError, TypeError):
        return plugin.name
