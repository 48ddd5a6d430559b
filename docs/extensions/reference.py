"""The whole generated reference."""

from __future__ import annotations

from functools import cache

from . import commands, entries, glossary, models, python_api
from .book import Book

PARTS = (commands, entries, models, python_api, glossary)


@cache
def reference_book() -> Book:
    """All generated pages; raises `Incomplete` if an entry lacks definition, unit or source."""
    book = Book()
    for part in PARTS:
        part.register(book)
    for part in PARTS:
        part.write(book)
    return book.checked()
