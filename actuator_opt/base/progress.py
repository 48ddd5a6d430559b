"""How far a long piece of work is, for whoever watches: the terminal, or nobody."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Watch = Callable[[str, float | None], None]
"""Takes what is done and its share, 0 to 1; None where that is not known."""
_watch: ContextVar[Watch | None] = ContextVar("watch", default=None)
_One = TypeVar("_One")


@contextmanager
def watched(watch: Watch | None) -> Iterator[None]:
    """Tell this one from here on; None tells nobody."""
    token = _watch.set(watch)
    try:
        yield
    finally:
        _watch.reset(token)


def tell(what: str, share: float | None = None) -> None:
    """Say how far a piece of work is."""
    watch = _watch.get()
    if watch is not None:
        watch(what, share)


@contextmanager
def whole(what: str, share: float | None = None) -> Iterator[None]:
    """A piece of work that is told as one: what works inside is not."""
    tell(what, share)
    with watched(None):
        yield


def steps(what: str, items: Sequence[_One]) -> Iterator[_One]:
    """Each of some items, told as shares of the work.

    >>> with watched(lambda what, share: print(f"{what} {share:.0%}")):
    ...     for one in steps("counting", "ab"):
    ...         tell("inside", 0.5)
    counting 0%
    counting 50%
    """
    for number, item in enumerate(items):
        with whole(what, number / len(items)):
            yield item
