"""Did you mean …? Close names for a word that is not one of the names expected."""

from __future__ import annotations

from collections.abc import Iterable


def closest(word: str, names: Iterable[str]) -> str | None:
    """The name nearest to `word`: equal but for case first, then the fewest changes.

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
    import difflib  # only a faulty input pays for it

    found = difflib.get_close_matches(word, candidates, n=1, cutoff=0.6)
    return found[0] if found else None


def remedy(word: str, names: Iterable[str], limit: int = 12) -> str:
    """``did you mean "x"?``, else the names there are.

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


def shown(text: object, limit: int = 60) -> str:
    r"""Text fit for one line of a message: control characters escaped, long text cut.

    >>> shown("two\nlines")
    'two\\nlines'
    """
    line = "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in str(text)
    )
    return line if len(line) <= limit else line[: limit - 1] + "…"


def article(words: str) -> str:
    """Words with their indefinite article, by their first letter.

    >>> article("oil volume"), article("bore")
    ('an oil volume', 'a bore')
    """
    return f"an {words}" if words[:1].lower() in "aeiou" else f"a {words}"
