"""A sweep: chunks of its points evaluated, kept, reduced, in one process or many."""

from __future__ import annotations

import heapq
import os
import signal
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .. import progress
from ..database import Database, Rows, opened, refused
from ..database_reader import reading
from ..numeric import Array
from ..version import VERSION
from .chunk import Chunk, Study
from .cluster import on_cluster
from .designs import KEPT
from .sample import Sample

CHUNK = 4096
"""Points of a chunk: one transaction, one message between processes."""

REDUCED = 65_536
"""Points of a chunk of which the best alone are kept."""

LOOKS = 16
"""Places of a sweep without a feasible design that are looked at to say why."""

ANEW = 8
"""Points of a chunk of designs that are made anew one by one, some with tables of oil films."""

ALONE = 0.5
"""Seconds of work up to which other processes are not worth their start."""


class Task(NamedTuple):
    """Points to compute: those of a chunk, or some of them."""

    first: int
    size: int
    some: Array | None = None
    limit: float | None = None
    """Objective that a design must be below, where the best alone are asked for."""
    keep: int = 0
    """How many of the best, then."""


@dataclass(frozen=True, order=True)
class Best:
    """One of the best designs: its objective (to be minimised), its point, its row."""

    objective: float
    number: int
    row: tuple[float, ...] = field(compare=False)

    @property
    def margin(self) -> float:
        """The least margin of all limits."""
        return self.row[-3]


@dataclass
class Swept:
    """What a sweep came to."""

    study: Study
    requested: int
    computed: int = 0
    reused: int = 0
    failed: int = 0
    feasible: int | None = 0
    """None where the best alone are asked for: then most are never evaluated."""
    screened: int = 0
    """Variants that closed expressions or better ones of their chunk rule out, where so."""
    best: list[Best] = field(default_factory=list)
    failures: dict[str, int] = field(default_factory=dict)
    """How often each reason made a design fail."""
    missed: dict[str, int] = field(default_factory=dict)
    """How often each limit was the one missed most."""
    seconds: float = 0.0
    sample: Sample = field(default_factory=Sample)
    """Rows to draw."""

    def metrics(self, best: Best) -> dict[str, float | None]:
        """The metrics of one of the best designs (SI); None where there is none."""
        values = dict(zip([c.name for c in self.study.columns], best.row, strict=True))
        return {
            name: None if np.isnan(values[name]) else values[name] for name in self.study.metrics
        }

    def values(self, best: Best) -> dict[str, float | str]:
        """The varied values of one of the best designs, by PATH (SI), which its row begins with."""
        study = self.study
        if study.plan.named:
            return study.values(best.number)
        paths = [axis.path for axis in study.plan.numeric]
        found = {paths[k]: float(x) for k, x in zip(study.order, best.row, strict=False)}
        return {path: found[path] for path in paths}

    def limit(self, keep: int) -> float:
        """Objective that one more of the best must be below."""
        return self.best[-1].objective if len(self.best) >= keep else np.inf

    def to_dict(self) -> dict[str, Any]:
        """The JSON form (CONTRACT): counts, and the best designs in SI."""
        return {
            "name": self.study.design.name,
            "version": VERSION,
            "requested": self.requested,
            "computed": self.computed,
            "reused": self.reused,
            "failed": self.failed,
            "feasible": self.feasible,
            "screened": self.screened,
            "engine": self.study.engine,
            "best": [
                {"variables": self.values(best), "metrics": self.metrics(best)}
                for best in self.best
            ],
            "failures": self.failures,
            "missed": self.missed,
            "seconds": self.seconds,
        }

    def count_missed(self, chunk: Chunk) -> None:
        """Count the limits that the designs of a chunk miss most."""
        worst = chunk.rows.numbers[~chunk.feasible, -2]
        for number, times in zip(
            *np.unique(worst[np.isfinite(worst)], return_counts=True), strict=True
        ):
            name = self.study.limits[int(number)]
            self.missed[name] = self.missed.get(name, 0) + int(times)

    def add(self, chunk: Chunk, keep: int) -> None:
        """Count a chunk."""
        self.computed += chunk.computed
        self.reused += max(len(chunk.rows.numbers) - chunk.computed, 0)
        self.screened += 0 if chunk.places is None else chunk.computed - len(chunk.places)
        if chunk.places is None:
            self.sample.add(self.study, chunk)
        self.failed += len(chunk.rows.failures)
        for reason in chunk.rows.failures.values():
            self.failures[reason] = self.failures.get(reason, 0) + 1
        good = np.flatnonzero(chunk.feasible)
        self.count_missed(chunk)
        if self.feasible is not None:
            self.feasible += len(good)
        if keep and len(good):
            numbers = chunk.numbers
            order = good[np.argsort(chunk.objective[good], kind="stable")[:keep]]
            found = [
                Best(float(chunk.objective[k]), int(numbers[k]), tuple(chunk.rows.numbers[k]))
                for k in order
            ]
            self.best = heapq.nsmallest(keep, [*self.best, *found])


def sweep(
    study: Study,
    *,
    store: Path | None = None,
    keep: int = 10,
    workers: int | None = None,
    scheduler: str | None = None,
    each: Callable[[Chunk], None] | None = None,
    watch: Sequence[str] = (),
) -> Swept:
    """Evaluate every point of a sweep.

    Parameters
    ----------
    study : the design and the points
    store : database to take rows from and put them into
    keep : best feasible designs to keep
    workers : processes; default: one per core
    scheduler : address of a Dask scheduler to work on instead
    each : called with every chunk, in order
    watch : metrics whose Pareto lines are kept, of every design

    Raises
    ------
    InputError
        the database cannot be used
    """
    began = time.perf_counter()
    found = Swept(
        study,
        study.plan.count,
        feasible=0 if study.full else None,
        sample=Sample(tuple(watch)),
    )
    size = _chunk_size(study)
    starts = range(0, study.plan.count, size)
    computed = partial(_computed, study, len(starts), workers, scheduler)
    if not study.full:
        chunks = computed(Task(first, size, None, found.limit(keep), keep) for first in starts)
    elif store is None:
        chunks = computed(Task(first, size) for first in starts)
    else:
        chunks = _stored(study, starts, computed, store)
    for number, chunk in enumerate(chunks):
        found.add(chunk, keep)
        if each is not None:
            each(chunk)
        progress.tell("evaluating designs", (number + 1) / len(starts))
    if not study.full and not found.best:
        _explain(found)
    found.seconds = time.perf_counter() - began
    return found


def _chunk_size(study: Study) -> int:
    """Points of a chunk: fewer where most of them are designs to be made anew, which takes long."""
    if study.designs.apart_count > KEPT:
        return ANEW
    return CHUNK if study.full else REDUCED


def _explain(found: Swept) -> None:
    """Count what some designs miss, where none is feasible and few were evaluated."""
    count, part = found.study.plan.count, max(CHUNK // LOOKS, 1)
    found.missed = {}
    for first in dict.fromkeys(np.linspace(0, count - 1, LOOKS).astype(int).tolist()):
        found.count_missed(found.study.chunk(first, part))


def swept_again(
    study: Study,
    store: Path,
    *,
    keep: int = 10,
    each: Callable[[Chunk], None] | None = None,
    watch: Sequence[str] = (),
) -> Swept:
    """A sweep out of its database, in which every row must stand: nothing is computed or written.

    Parameters as `sweep`.

    Raises
    ------
    InputError
        no such file, one of other models, or one that lacks the sweep or a row of it
    """
    began = time.perf_counter()
    found = Swept(study, study.plan.count, sample=Sample(tuple(watch)))
    with reading(store, VERSION) as reader:
        number = reader.number(study.hash)
        base = Database(reader.connection, number, len(study.columns))
        size = _chunk_size(study)
        for first in range(0, study.plan.count, size):
            half = _half(base, study, first, size)
            if len(half.missing):
                message = f"study {number} lacks rows of this sweep"
                raise refused(store, message, "run the sweep again with --store")
            chunk = _whole(study, half, None)
            found.add(chunk, keep)
            if each is not None:
                each(chunk)
            progress.tell("reading designs", min(first + size, found.requested) / found.requested)
    found.seconds = time.perf_counter() - began
    return found


def _computed(
    study: Study, chunks: int, workers: int | None, scheduler: str | None, tasks: Iterable[Task]
) -> Iterator[Chunk]:
    """What tasks come to, in their order."""
    if scheduler is not None:
        yield from on_cluster(scheduler, study, _chunk, tasks)
        return
    rest = iter(tasks)
    count = workers or (1 if "jax" in sys.modules else os.cpu_count() or 1)  # its threads bar forks
    if workers is None or count == 1:
        yield from _here(study, chunks, rest, patient=count == 1)
    first = next(rest, None)
    if first is None:
        return
    with ProcessPoolExecutor(count, initializer=_begin, initargs=(study,)) as pool:
        waiting: deque[Future[Chunk]] = deque()
        for task in chain([first], rest):
            waiting.append(pool.submit(_work, task))
            if len(waiting) > 2 * count:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


def _here(study: Study, chunks: int, tasks: Iterator[Task], *, patient: bool) -> Iterator[Chunk]:
    """Chunks of this process: all of them, or until the rest is worth the start of others."""
    for done, task in enumerate(tasks, start=1):
        began = time.perf_counter()
        chunk = _chunk(study, task)
        took = time.perf_counter() - began
        yield chunk
        if not patient and done > 1 and (chunks - done) * took > ALONE:  # the first takes longer
            return


_STUDY: list[Study] = []
"""What a process of the pool works on."""


def _begin(study: Study) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that waits
    _STUDY[:] = [study]


def _work(task: Task) -> Chunk:
    return _chunk(_STUDY[0], task)


def _chunk(study: Study, task: Task) -> Chunk:
    if task.limit is not None:
        return study.reduced(task.first, task.size, task.limit, task.keep)
    return study.chunk(task.first, task.size, task.some)


def _stored(
    study: Study,
    starts: range,
    computed: Callable[[Iterable[Task]], Iterator[Chunk]],
    path: Path,
) -> Iterator[Chunk]:
    """Chunks of rows that the database has, and of new ones that are put into it."""
    with opened(
        path,
        study=study.hash,
        name=study.design.name,
        design=study.text,
        columns=study.columns,
        version=VERSION,
        texts=[(axis.path, text) for axis in study.plan.named for text in axis.texts],
    ) as base:
        halves: deque[_Half] = deque()

        def tasks() -> Iterator[Task]:
            for first in starts:
                half = _half(base, study, first, starts.step)
                halves.append(half)
                if len(half.missing):
                    every = len(half.missing) == len(half.keys)
                    yield Task(first, starts.step, None if every else half.missing)

        for fresh in computed(tasks()):
            while not len(halves[0].missing):
                yield _whole(study, halves.popleft(), None)
            half = halves.popleft()
            base.put([half.keys[k] for k in half.missing], fresh.rows)
            yield _whole(study, half, fresh)
        for half in halves:
            yield _whole(study, half, None)


class _Half(NamedTuple):
    """Rows of a chunk that stand, and the numbers of those that are missing."""

    first: int
    keys: list[bytes]
    rows: Rows
    missing: Array


def _half(base: Database, study: Study, first: int, count: int) -> _Half:
    keys = study.keys(first, count)
    points = study.plan.points(first, count)
    numbers = np.full((len(keys), len(study.columns)), np.nan)
    numbers[:, : len(points.numbers)] = points.numbers[study.order].T
    failures, known = {}, base.known(keys)
    for k, (blob, failure) in known.items():
        if failure is not None:
            failures[k] = failure
        elif blob is not None:
            numbers[k] = base.numbers(blob)
    missing = np.array([k for k in range(len(keys)) if k not in known], dtype=np.intp)
    return _Half(first, keys, Rows(numbers, failures), missing)


def _whole(study: Study, half: _Half, fresh: Chunk | None) -> Chunk:
    """A chunk of kept and of new rows."""
    rows = half.rows
    if fresh is not None:
        rows.numbers[half.missing] = fresh.rows.numbers
        added = {int(half.missing[k]): why for k, why in fresh.rows.failures.items()}
        rows = Rows(rows.numbers, rows.failures | added)
    return study.judged(half.first, rows, len(half.missing))
