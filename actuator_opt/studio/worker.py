"""One thread that solves: a newer wish stops an older one, and saving is never stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar, cast

Kind = Literal["solve", "prices", "curve", "cycle", "kept"]
"""Kinds of jobs. A "kept" job, such as saving, is neither stopped nor dropped."""
Stop = Callable[[], bool]
_T = TypeVar("_T")


class Dropped(Exception):
    """A newer wish replaced this one."""


@dataclass(eq=False)
class _Job:
    work: Callable[[Stop], Any]
    tab: str
    kind: Kind
    done: threading.Event = field(default_factory=threading.Event)
    stopped: bool = False
    result: Any = None
    error: BaseException | None = None

    def replaced_by(self, newer: _Job) -> bool:
        """Whether a newer job of the same page makes this one useless."""
        same = self.tab == newer.tab and newer.kind in ("solve", self.kind)
        return self.kind != "kept" and same

    def run(self) -> None:
        try:
            self.result = self.work(lambda: self.stopped)
        except BaseException as error:  # raised again in the thread that waits
            self.error = error
        self.done.set()


class Worker:
    """Runs jobs one by one, wishes to solve first.

    A new wish drops what the same page asked for before, and stops prices and curves of any page,
    because these can wait.
    """

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._waiting: list[_Job] = []
        self._running: _Job | None = None
        self._closed = False
        self._thread = threading.Thread(target=self._loop, name="studio solver", daemon=True)
        self._thread.start()

    def do(self, work: Callable[[Stop], _T], *, tab: str = "", kind: Kind = "kept") -> _T:
        """Run a job and wait for its result.

        Parameters
        ----------
        work : function of `stop`, which is true once the result is no longer wanted
        tab : the page that asks
        kind : what the job does

        Raises
        ------
        Dropped : a newer wish replaced this one, or the worker is closed
        """
        job = _Job(work, tab, kind)
        with self._condition:
            if self._closed:
                raise Dropped
            for other in [x for x in self._waiting if x.replaced_by(job)]:
                self._waiting.remove(other)
                _drop(other)
            running = self._running
            if running is not None and (
                running.replaced_by(job)
                or (kind == "solve" and running.kind in ("prices", "curve", "cycle"))
            ):
                running.stopped = True
            self._waiting.append(job)
            self._condition.notify()
        job.done.wait()
        if job.error is not None:
            raise job.error
        return cast("_T", job.result)

    def close(self, seconds: float = 2.0) -> None:
        """Stop the running job, drop the others, and wait at most this long for the thread."""
        with self._condition:
            self._closed = True
            for job in self._waiting:
                _drop(job)
            self._waiting.clear()
            if self._running is not None:
                self._running.stopped = True
            self._condition.notify()
        self._thread.join(seconds)

    def _loop(self) -> None:
        while True:
            with self._condition:
                self._running = None
                while not self._waiting and not self._closed:
                    self._condition.wait()
                if not self._waiting:
                    return
                wishes = [x for x in self._waiting if x.kind == "solve"]
                self._running = job = (wishes or self._waiting)[0]
                self._waiting.remove(job)
            job.run()


def _drop(job: _Job) -> None:
    job.error = Dropped()
    job.done.set()
