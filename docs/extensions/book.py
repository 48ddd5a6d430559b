"""The generated pages and every name that they explain, so that roles and `docs` find the place."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from .markdown import label


class Incomplete(Exception):
    """An entry without definition, unit or source."""


@dataclass
class Book:
    """Generated pages by name, and the place of each name by its kind."""

    pages: dict[str, str] = field(default_factory=dict)
    labels: dict[str, dict[str, str]] = field(default_factory=dict)
    places: dict[str, str] = field(default_factory=dict)
    """Page of each label."""
    aliases: dict[str, str] = field(default_factory=dict)
    """Further words, each with its label."""
    faults: list[str] = field(default_factory=list)

    def register(self, kind: str, name: str, page: str, *aliases: str) -> None:
        """Note that a page explains a name."""
        slug = f"{kind}-{re.sub(r'[^a-z0-9]+', '-', name.lower()).strip('-')}"
        while slug in self.places:
            slug += "-2"
        self.labels.setdefault(kind, {})[name] = slug
        self.places[slug] = page
        for alias in aliases:
            self.aliases.setdefault(alias, slug)

    def at(self, kind: str, name: str) -> str:
        """The line that makes the next heading the place of a name."""
        return label(self.labels[kind][name])

    def require(self, kind: str, name: str, **parts: object) -> None:
        """Note a fault for each part that an entry lacks."""
        self.faults += [f"{kind} {name}: no {part}" for part, text in parts.items() if not text]

    def checked(self) -> Book:
        """The book itself; raises `Incomplete` if an entry lacks a part."""
        if self.faults:
            raise Incomplete("incomplete entries:\n" + "\n".join(self.faults))
        return self
