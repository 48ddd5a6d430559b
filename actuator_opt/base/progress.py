"""Reports the progress of long computations to a function, if one is registered."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Watch = Callable[[str, float | None], None]
"""Function that receives the current task and its completed share (0 to 1, None if unknown)."""
_watch: ContextVar[Watch | None] = ContextVar("watch", default=None)
_One = TypeVar("_One")


@contextmanager
def watched(watch: Watch | None) -> Iterator[None]:
    """Send progress reports to this function within the context; None switches them off."""
    token = _watch.set(watch)
    try:
        yield
    finally:
        _watch.reset(token)


def tell(what: str, share: float | None = None) -> None:
    """Report the progress of a task."""
    watch = _watch.get()
    if watch is not None:
        watch(what, share)


@contextmanager
def whole(what: str, share: float | None = None) -> Iterator[None]:
    """Report a task as a whole; progress reports from inside it are suppressed."""
    tell(what, share)
    with watched(None):
        yield


def steps(what: str, items: Sequence[_One]) -> Iterator[_One]:
    """Iterate over items and report the completed share.

    >>> with watched(lambda what, share: print(f"{what} {share:.0%}")):
    ...     for letter in steps("counting", "ab"):
    ...         tell("inside", 0.5)
    counting 0%
    counting 50%
    """
    for number, item in enumerate(items):
        with whole(what, number / len(items)):
            yield item
