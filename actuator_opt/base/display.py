"""Results in a notebook: each is shown as its page."""

from __future__ import annotations

from collections.abc import Callable

_RENDERERS: list[Callable[[object], str]] = []


def show_by(renderer: Callable[[object], str]) -> None:
    """Show results by a function that turns a result into a piece of HTML."""
    _RENDERERS[:] = [renderer]


class Displayed:
    """A result that a notebook shows as its page."""

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        """The page as HTML; None where nothing has been loaded that can render it."""
        return _RENDERERS[0](self) if _RENDERERS else None
