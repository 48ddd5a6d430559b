"""Suggestions for misspelt names, and text made safe for a terminal."""

from __future__ import annotations

import re
from collections.abc import Iterable


def closest(word: str, names: Iterable[str]) -> str | None:
    """The most similar name: equal but for case, else with the fewest edits.

    >>> closest("Bore", ["stroke", "bore"])
    'bore'
    """
    candidates = list(names)
    if not word or len(word) > 80:
        return None
    folded = word.casefold().replace("-", "_").replace(" ", "_")
    for name in candidates:
        if name.casefold() == folded:
            return name
    import difflib  # slow to import, needed for faults only

    found = difflib.get_close_matches(word, candidates, n=1, cutoff=0.6)
    return found[0] if found else None


def remedy(word: str, names: Iterable[str], limit: int = 12) -> str:
    """``did you mean "x"?``, else a list of the valid names.

    >>> remedy("strok", ["stroke", "bore"])
    'did you mean "stroke"?'
    """
    candidates = list(names)
    match = closest(word, candidates)
    if match is not None:
        return f'did you mean "{match}"?'
    if not candidates:
        return ""
    more = ", …" if len(candidates) > limit else ""
    return f"use one of {', '.join(candidates[:limit])}{more}"


CONTROLS = r"\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff"
"""Characters, as in a regular expression, that move the cursor or reverse the text direction."""
_CONTROL = rf"\r(?!\n)|(?!\r)[{CONTROLS}]"


def escaped(text: str, own: str = "") -> str:
    r"""Text with control characters escaped, except tabs and new lines.

    Parameters
    ----------
    text : text to print
    own : sequences to keep, as a regular expression without groups

    >>> print(escaped("\x1b[2J\u202e" "a\tb"))
    \x1b[2J\u202ea	b
    """
    pattern = f"({own})|{_CONTROL}" if own else f"(?!)()|{_CONTROL}"
    return re.sub(pattern, lambda m: m[1] or m[0].encode("unicode_escape").decode("ascii"), text)


def shown(text: object, limit: int = 60) -> str:
    r"""Text for one line of a message: control characters escaped, long text shortened.

    >>> shown("two\nlines")
    'two\\nlines'
    """
    line = "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in str(text)
    )
    return line if len(line) <= limit else line[: limit - 1] + "…"


def article(words: str) -> str:
    """A noun with its indefinite article, by its first letter.

    >>> article("oil volume"), article("bore")
    ('an oil volume', 'a bore')
    """
    return f"an {words}" if words[:1].lower() in "aeiou" else f"a {words}"
