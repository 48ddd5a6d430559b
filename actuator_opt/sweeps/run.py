"""Run a sweep: evaluate, store and reduce its chunks, in one process or many."""

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
from itertools import chain, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..base import progress
from ..base.cluster import HERE, Cluster
from ..base.database import Database, StoredNumbers, opened, reading, refused
from ..base.numeric import Array
from ..base.threads import stay_on_one_thread
from ..version import VERSION
from .chunk import Chunk, Study
from .designs import CACHED
from .result import AllRows, Sample, Swept


class MissingRows(NamedTuple):
    """Rows of a chunk that the database lacks: keys, and indices (None if it lacks all rows)."""

    first: int
    keys: list[bytes]
    some: Array | None
    damaged: int
    """Number of rows that are damaged in the database."""


def missing_rows(base: Database, study: Study, first: int, count: int) -> MissingRows:
    """Return the rows of a chunk that are missing or damaged in the database."""
    keys = study.keys(first, count)
    indices, damaged = base.missing(keys)
    some = None if len(indices) == len(keys) else np.array(indices, dtype=np.intp)
    return MissingRows(first, [keys[k] for k in indices], some, damaged)


def stored_rows(base: Database, study: Study, first: int, count: int) -> tuple[StoredNumbers, int]:
    """Return the stored rows of a chunk, NaN where missing, and the number of missing rows."""
    keys = study.keys(first, count)
    points = study.plan.points(first, count)
    numbers = np.full((len(keys), len(study.columns)), np.nan)
    numbers[:, : len(points.numbers)] = points.numbers[study.order].T
    failures, stored = {}, base.known(keys)
    for k, (row, failure) in stored.items():
        if failure is not None:
            failures[k] = failure
        else:
            numbers[k] = row
    return StoredNumbers(numbers, failures), len(keys) - len(stored)


CHUNK = 4096
"""Least number of points in a chunk, which is stored in one transaction and sent between processes
as one message."""

MOST_CHUNK = 16_384
"""Largest number of points in a chunk. Every transaction changes nearly all pages of the index, so
fewer transactions write less."""

CHUNKS = 32
"""Number of chunks from which on a sweep has larger chunks instead of more (our choice)."""

REDUCED = 65_536
"""Number of points in a chunk if only the best designs are kept, or for a GPU, which needs this
many designs at once to be busy."""

SECTIONS = 16
"""Number of places in a sweep at which designs are evaluated to find the limits that they miss, if
no design is feasible."""

SMALL_CHUNK = 8
"""Number of points in a chunk if a design is built for nearly every point, as this may include the
calculation of oil-film tables."""

LOCAL_SECONDS = 0.5
"""Remaining computing time [s] below which starting more processes does not save time."""
MASKS = hasattr(signal, "pthread_sigmask")
"""Whether the operating system can delay an interrupt signal."""


class ChunkTask(NamedTuple):
    """Points of a chunk to compute: all, or only those with the indices `some`."""

    first: int
    size: int
    some: Array | None = None
    limit: float | None = None
    """If only the best designs are kept, the objective below which a design is among them."""
    keep: int = 0
    """Number of best designs to keep."""


def sweep(
    study: Study,
    *,
    store: Path | None = None,
    keep: int = 10,
    workers: int | None = None,
    cluster: Cluster = HERE,
    each: Callable[[Chunk], None] | None = None,
    watch: Sequence[str] = (),
    rows: bool = False,
) -> Swept:
    """Evaluate every point of a sweep.

    Parameters
    ----------
    study : the design and the points
    store : database from which existing rows are read, and to which new rows are written
    keep : number of best feasible designs to keep
    workers : number of processes; default: one per core
    cluster : its workers are used instead of local processes
    each : function that is called with every chunk, in order
    watch : metrics; for every pair, the Pareto line of all designs is kept
    rows : whether to keep every row in memory, for `Swept.table`

    Raises
    ------
    InputError
        if the database cannot be used
    """
    began = time.perf_counter()
    swept = Swept(
        study,
        study.plan.count,
        feasible=0 if study.full else None,
        sample=Sample(tuple(watch)),
        rows=AllRows.empty(study) if rows else None,
    )
    size = _chunk_size(study)
    starts = range(0, study.plan.count, size)
    computed = partial(_computed, study, len(starts), workers, cluster)
    if not study.full:
        chunks = computed(ChunkTask(first, size, None, swept.limit(keep), keep) for first in starts)
    elif store is None:
        chunks = computed(ChunkTask(first, size) for first in starts)
    else:
        chunks = _stored(study, starts, computed, store)
    for number, chunk in enumerate(chunks):
        swept.add(chunk, keep)
        if each is not None:
            each(chunk)
        progress.tell("evaluating designs", (number + 1) / len(starts))
    if not study.full and not swept.best:
        _explain(swept)
    swept.seconds = time.perf_counter() - began
    return swept


def _chunk_size(study: Study) -> int:
    """Return the number of points of a chunk; small if a design is built for nearly every point."""
    if study.designs.apart_count > CACHED:
        return SMALL_CHUNK
    if not study.full or study.engine == "gpu":
        return REDUCED
    return max(CHUNK, min(study.plan.count // CHUNKS, MOST_CHUNK))


def _explain(swept: Swept) -> None:
    """Count the limits that designs miss at some places of a sweep; replace earlier counts."""
    count, size = swept.study.plan.count, CHUNK // SECTIONS
    swept.missed = {}
    starts = range(0, count, size)
    sparse = np.linspace(0, count - size, SECTIONS).astype(int).tolist()
    for first in sparse if len(starts) > SECTIONS else starts:  # no point is examined twice
        swept.count_missed(swept.study.chunk(first, size))


def swept_again(
    study: Study,
    store: Path,
    *,
    keep: int = 10,
    each: Callable[[Chunk], None] | None = None,
    watch: Sequence[str] = (),
) -> Swept:
    """Read a whole sweep from its database, without computing or writing anything.

    The parameters are those of `sweep`.

    Raises
    ------
    InputError
        if the file is missing or was made with other models, or if it lacks rows of the sweep
    """
    began = time.perf_counter()
    swept = Swept(study, study.plan.count, sample=Sample(tuple(watch)))
    with reading(store, VERSION) as reader:
        number = reader.number(study.hash)
        base = Database(reader.connection, number, study.hash, len(study.columns), store)
        size = _chunk_size(study)
        for first in range(0, study.plan.count, size):
            rows, missing_count = stored_rows(base, study, first, size)
            if missing_count:
                message = f"study {number} lacks rows of this sweep, or contains damaged rows"
                remedy = "run the sweep again with --store to compute them"
                raise refused(store, message, remedy)
            chunk = study.judged(first, rows, 0)
            swept.add(chunk, keep)
            if each is not None:
                each(chunk)
            progress.tell("reading designs", min(first + size, swept.requested) / swept.requested)
    swept.seconds = time.perf_counter() - began
    return swept


def _computed(
    study: Study,
    chunks: int,
    workers: int | None,
    cluster: Cluster,
    tasks: Iterable[ChunkTask],
) -> Iterator[Chunk]:
    """Compute the chunks of tasks, on a cluster or on this machine; yield them in order."""
    if cluster:
        yield from cluster.map(partial(_chunk, study), tasks)
        return
    remaining = iter(tasks)
    count = workers or (1 if "jax" in sys.modules else os.cpu_count() or 1)  # no fork with threads
    count = min(count, chunks)  # all workers start at once, even without work
    if workers is None or count == 1:
        yield from _local_chunks(study, chunks, remaining, patient=count == 1)
    elif study.recorded:  # the processes inherit what the first chunk has recorded
        yield from (_chunk(study, task) for task in islice(remaining, 1))
    first_task = next(remaining, None)
    if first_task is None:
        return
    with ProcessPoolExecutor(count, initializer=_begin, initargs=(study,)) as pool:
        waiting: deque[Future[Chunk]] = deque()
        try:
            for task in chain([first_task], remaining):
                with _without_interrupts():  # the processes start here
                    waiting.append(pool.submit(_work, task))
                if len(waiting) > 2 * count:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        except BaseException:  # pending tasks never start
            pool.shutdown(cancel_futures=True)
            raise


def _local_chunks(
    study: Study, chunks: int, tasks: Iterator[ChunkTask], *, patient: bool
) -> Iterator[Chunk]:
    """Compute chunks in this process: all if `patient`, else until more processes save time."""
    for count, task in enumerate(tasks, start=1):
        began = time.perf_counter()
        chunk = _chunk(study, task)
        seconds = time.perf_counter() - began
        yield chunk
        pays = (
            count > 1 and (chunks - count) * seconds > LOCAL_SECONDS
        )  # the first chunk takes longer than others
        if pays and not patient:
            return


_STUDY: list[Study] = []
"""The study for which a process of the pool computes chunks."""


def _begin(study: Study) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # only the main process handles Ctrl-C
    if MASKS:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    threading.Thread(target=_end_with_parent, daemon=True).start()
    stay_on_one_thread()
    _STUDY[:] = [study]


def _end_with_parent() -> None:
    """End this process when its parent process ends, for whatever reason.

    The process waits until the parent's end of a pipe closes, which works without system signals. A
    forked process also inherits the pipes of processes that started before it, so the process that
    started last ends first.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Delay Ctrl-C, so that a process does not receive it while it starts."""
    if not MASKS:
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(task: ChunkTask) -> Chunk:
    return _chunk(_STUDY[0], task)


def _chunk(study: Study, task: ChunkTask) -> Chunk:
    if task.limit is not None:
        return study.reduced(task.first, task.size, task.limit, task.keep)
    return study.chunk(task.first, task.size, task.some)


def _stored(
    study: Study,
    starts: range,
    computed: Callable[[Iterable[ChunkTask]], Iterator[Chunk]],
    path: Path,
) -> Iterator[Chunk]:
    """Yield all chunks, computing and storing those rows that the database lacks."""
    with opened(
        path,
        study=study.hash,
        name=study.design.name,
        design=study.text,
        columns=study.columns,
        version=VERSION,
        texts=[(axis.path, text) for axis in study.plan.named for text in axis.texts],
    ) as base:
        queue: deque[MissingRows] = deque()  # this checks only the keys; the rows are read later

        def tasks() -> Iterator[ChunkTask]:
            for first in starts:
                gap = missing_rows(base, study, first, starts.step)
                queue.append(gap)
                if gap.keys:
                    yield ChunkTask(first, starts.step, gap.some)

        def stored_chunk(gap: MissingRows) -> Chunk:
            rows, _ = stored_rows(base, study, gap.first, starts.step)
            return study.judged(gap.first, rows, len(gap.keys))

        for computed_chunk in computed(tasks()):
            while not queue[0].keys:
                yield stored_chunk(queue.popleft())
            gap = queue.popleft()
            base.put(gap.keys, computed_chunk.rows)
            chunk = computed_chunk if gap.some is None else stored_chunk(gap)
            yield replace(chunk, damaged=gap.damaged)
        for gap in queue:
            yield stored_chunk(gap)
