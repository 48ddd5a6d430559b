"""The glossary page, from the terms that `explain` knows."""

from __future__ import annotations

from actuator_opt.api.glossary import terms

from .book import Book
from .entries import linked
from .markdown import fence, page, phrase
from .models import references


def register(book: Book) -> None:
    """Register every term with its other words."""
    for term in terms().values():
        slug = f"term-{'-'.join(term.name.split())}"
        book.labels.setdefault("term", {})[term.name] = slug
        book.places[slug] = "glossary"
        for alias in term.aliases:
            book.aliases.setdefault(alias, slug)


def write(book: Book) -> None:
    """Write the page; words of one meaning share a definition."""
    parts = []
    for term in terms().values():
        book.require("term", term.name, definition=term.definition, source=term.source)
        words = "\n".join([term.name, *term.aliases])
        source = phrase(term.source, references())
        related = ", ".join(linked(name, book) for name in term.related)
        parts.append(f"{words}\n  {phrase(term.definition)} Source: {source}. See also: {related}.")
    book.pages["glossary"] = page(
        "# Glossary",
        "Terms of results and reports. In the terminal: `actuator-opt explain TERM`.",
        fence("{glossary}", ":sorted:\n\n" + "\n\n".join(parts)),
    )
