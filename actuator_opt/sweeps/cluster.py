"""Sweeps on many machines: the same chunks as Dask tasks, in the same order."""

from __future__ import annotations

import pickle
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar

from ..base.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    from .chunk import Chunk, Study

Task = TypeVar("Task")

PATIENCE = "10s"
"""Time limit for a scheduler to answer."""

AGAIN = 5
"""Maximum restarts of a task after its worker is lost."""

WAITING = 3
"""Tasks queued for each thread of the cluster."""


def on_cluster(
    address: str, study: Study, work: Callable[[Study, Task], Chunk], tasks: Iterable[Task]
) -> Iterator[Chunk]:
    """Yield the results of tasks run on a cluster, in order.

    Every task carries the study, so workers may leave and join at any time.

    Parameters
    ----------
    address : of the Dask scheduler, such as tcp://10.0.0.1:8786
    study : the sweep
    work : computes the chunk of one task
    tasks : in order

    Raises
    ------
    UsageError
        Dask is not installed, or no scheduler answers at the address
    """
    try:
        from distributed import Client
    except ImportError:
        message, remedy = "--scheduler needs Dask", "pip install 'actuator-opt[cluster]'"
        raise UsageError(Diagnostic(message, remedy)) from None
    try:
        client: Any = Client(  # type: ignore[no-untyped-call]
            address, timeout=PATIENCE, set_as_default=False
        )
    except (OSError, ValueError, TimeoutError) as error:
        message = f"--scheduler {address}: no scheduler answers ({type(error).__name__})"
        raise UsageError(Diagnostic(message, "start one with `dask scheduler`")) from None
    with client:
        if not client.scheduler_info()["workers"]:
            message = f"--scheduler {address}: no worker has joined"
            raise UsageError(Diagnostic(message, f"start one with `dask worker {address}`"))
        blob = pickle.dumps((study, work))
        waiting: deque[Any] = deque()
        for task in tasks:
            waiting.append(client.submit(_done, blob, task, pure=False, retries=AGAIN))
            if len(waiting) > WAITING * max(sum(client.nthreads().values()), 1):
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


@lru_cache(maxsize=2)
def _unpacked(blob: bytes) -> tuple[Any, Any]:
    study, work = pickle.loads(blob)
    return study, work


def _done(blob: bytes, task: Any) -> Any:
    """Run a task on a worker."""
    study, work = _unpacked(blob)
    return work(study, task)
