"""A sweep: chunks of its points evaluated, kept, reduced, in one process or many."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..base import progress
from ..base.database import Database, opened, refused
from ..base.database_reader import reading
from ..base.numeric import Array
from ..version import VERSION
from .chunk import Chunk, Study
from .cluster import on_cluster
from .designs import KEPT
from .kept import Lacking, kept, lacking
from .sample import Sample
from .swept import Swept

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


MASKS = hasattr(signal, "pthread_sigmask")
"""Whether the system can keep a signal waiting."""


class Task(NamedTuple):
    """Points to compute: those of a chunk, or some of them."""

    first: int
    size: int
    some: Array | None = None
    limit: float | None = None
    """Objective that a design must be below, where the best alone are asked for."""
    keep: int = 0
    """How many of the best, then."""


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
    count, part = found.study.plan.count, CHUNK // LOOKS
    found.missed = {}
    every = range(0, count, part)
    spread = np.linspace(0, count - part, LOOKS).astype(int).tolist()
    for first in spread if len(every) > LOOKS else every:  # none is looked at twice
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
        base = Database(reader.connection, number, study.hash, len(study.columns), store)
        size = _chunk_size(study)
        for first in range(0, study.plan.count, size):
            rows, missing = kept(base, study, first, size)
            if missing:
                message = f"study {number} lacks rows of this sweep, or holds them damaged"
                remedy = "run the sweep again with --store: it computes them"
                raise refused(store, message, remedy)
            chunk = study.judged(first, rows, 0)
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
    count = min(count, chunks)  # each is started at once, whether it has work or not
    if workers is None or count == 1:
        yield from _here(study, chunks, rest, patient=count == 1)
    first = next(rest, None)
    if first is None:
        return
    with ProcessPoolExecutor(count, initializer=_begin, initargs=(study,)) as pool:
        waiting: deque[Future[Chunk]] = deque()
        try:
            for task in chain([first], rest):
                with _without_interrupts():  # processes begin here
                    waiting.append(pool.submit(_work, task))
                if len(waiting) > 2 * count:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        except BaseException:  # of what waits nothing is begun any more
            pool.shutdown(cancel_futures=True)
            raise


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
    if MASKS:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _STUDY[:] = [study]


def _end_with_parent() -> None:
    """End this process once its parent has ended, for whatever reason.

    Waits for the end of a pipe that the parent alone holds open, which needs no signal of the
    system's own. Where processes are forks, a later one holds the pipes of those before it: they
    end one after the other, the last one first.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Keep Ctrl-C waiting: a process that is just beginning would take it for its own."""
    if not MASKS:
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


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
        asked: deque[Lacking] = deque()  # of keys alone: rows that stand are read in turn

        def tasks() -> Iterator[Task]:
            for first in starts:
                one = lacking(base, study, first, starts.step)
                asked.append(one)
                if one.keys:
                    yield Task(first, starts.step, one.some)

        def standing(one: Lacking) -> Chunk:
            rows, _ = kept(base, study, one.first, starts.step)
            return study.judged(one.first, rows, len(one.keys))

        for fresh in computed(tasks()):
            while not asked[0].keys:
                yield standing(asked.popleft())
            one = asked.popleft()
            base.put(one.keys, fresh.rows)
            yield replace(fresh if one.some is None else standing(one), damaged=one.damaged)
        for one in asked:
            yield standing(one)
