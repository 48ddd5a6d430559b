"""Independent tasks on a Dask cluster, or one after another in this process.

Every task contains all data that it needs, so workers may leave and join at any time: the scheduler
repeats the task of a lost worker. Workers need the same version of the program and its libraries.
"""

from __future__ import annotations

import pickle
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, TypeVar

from .errors import Diagnostic, UsageError

Task = TypeVar("Task")
Result = TypeVar("Result")

PATIENCE = "10s"
"""Time within which a Dask scheduler must answer."""

RETRIES = 5
"""Maximum number of restarts of a task after its worker is lost."""

WAITING = 3
"""Number of tasks in the queue for each thread of the cluster."""


class Cluster:
    """The workers of a Dask scheduler, or this process if there is no client.

    A copy sent to a worker has no client, so that tasks do not start further tasks.
    """

    def __init__(self, client: Any = None) -> None:
        self._client = client

    def __reduce__(self) -> tuple[type[Cluster], tuple[()]]:
        return Cluster, ()

    def map(self, work: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Call a function with each task; yield the results in the order of the tasks.

        Parameters
        ----------
        work : the function, with all data that the tasks share; it is sent with every task
        tasks : read as far as the workers need them
        """
        if self._client is None:
            yield from map(work, tasks)
            return
        import cloudpickle  # part of every installation of Dask; it also sends nested functions

        blob = cloudpickle.dumps(work)
        waiting: deque[Any] = deque()
        for task in tasks:
            waiting.append(self._client.submit(_run, blob, task, pure=False, retries=RETRIES))
            if len(waiting) > WAITING * max(sum(self._client.nthreads().values()), 1):
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()

    def parts(self, tasks: Sequence[Task], size: int) -> list[Sequence[Task]]:
        """Tasks that are cheapest together: in parts of some `size`, or all in this process."""
        size = size if self._client is not None else max(len(tasks), 1)
        return [tasks[first : first + size] for first in range(0, len(tasks), size)]

    def __bool__(self) -> bool:
        """Whether there are workers besides this process."""
        return self._client is not None


HERE = Cluster()
"""Every task in this process."""


@contextmanager
def connected(scheduler: str | None) -> Iterator[Cluster]:
    """Connect to a cluster.

    Parameters
    ----------
    scheduler : address of the Dask scheduler, such as tcp://10.0.0.1:8786; None: this process alone

    Raises
    ------
    UsageError
        if Dask is not installed, no scheduler answers at the address, or no worker has joined
    """
    if scheduler is None:
        yield HERE
        return
    try:
        from distributed import Client
    except ImportError:
        message, remedy = "--scheduler needs Dask", "pip install 'actuator-opt[cluster]'"
        raise UsageError(Diagnostic(message, remedy)) from None
    try:
        client: Any = Client(  # type: ignore[no-untyped-call]
            scheduler, timeout=PATIENCE, set_as_default=False
        )
    except (OSError, ValueError, TimeoutError) as error:
        message = f"--scheduler {scheduler}: no scheduler answers ({type(error).__name__})"
        raise UsageError(Diagnostic(message, "start one with `dask scheduler`")) from None
    with client:
        if not client.scheduler_info()["workers"]:
            message = f"--scheduler {scheduler}: no worker has joined"
            raise UsageError(Diagnostic(message, f"start one with `dask worker {scheduler}`"))
        yield Cluster(client)


@lru_cache(maxsize=2)
def _unpacked(blob: bytes) -> Callable[[Any], Any]:
    work: Callable[[Any], Any] = pickle.loads(blob)
    return work


def _run(blob: bytes, task: Any) -> Any:
    """Run a task on a worker of the cluster."""
    return _unpacked(blob)(task)
