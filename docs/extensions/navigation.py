"""The list of pages at the side: only the branch of the page is open.

Furo puts all pages into the list of each page: half of the time of the build and of the size of the
pages is due to that.
"""

from __future__ import annotations

from typing import Any

BEFORE_FURO = 400


def _branch(app: Any, name: str, template: str, context: dict[str, Any], tree: Any) -> None:
    whole = context.get("toctree")
    if whole is not None:
        context["toctree"] = lambda **options: whole(**options | {"collapse": True})


def setup(app: Any) -> dict[str, bool]:
    """Register the list."""
    app.connect("html-page-context", _branch, priority=BEFORE_FURO)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
