"""Cleaning of user texts for files in other formats."""

from __future__ import annotations

import re

_CONTROL = re.compile(
    "[\x00-\x1f\x7f-\x9f\u200b-\u200f\u2028-\u202e\u2060-\u2069\ud800-\udfff\ufeff\ufffe\uffff]"
)
LONGEST = 200


def plain(words: str) -> str:
    r"""One line without control and direction characters, at most 200 characters.

    >>> plain("a\nb"), len(plain(300 * "c"))
    ('a b', 200)
    """
    line = _CONTROL.sub(" ", words)
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 1]}…"
