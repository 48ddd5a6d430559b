"""Parts of the documentation build, `docs/extensions`, for tests; they need no Sphinx."""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
sys.path.append(str(DOCS))  # at the end: nothing of it may hide another module

from extensions import checks, docstrings, markdown, runs  # noqa: E402
from extensions.reference import reference_book  # noqa: E402

__all__ = ["DOCS", "checks", "docstrings", "markdown", "reference_book", "runs"]
