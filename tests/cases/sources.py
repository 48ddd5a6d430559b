"""Sources of the package, parsed once for all tests that look at them."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path


@cache
def parsed(path: Path) -> tuple[str, ast.Module]:
    """Source and syntax tree of a module."""
    source = path.read_text(encoding="utf-8")
    return source, ast.parse(source)
