"""Pieces of MyST Markdown for generated pages: plain text is escaped, code is not."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

_MARKS = re.compile(r"([\\*_\[\]<>$|#~`{}^])")
_CODE = re.compile(r"(``?[^`\n]+``?)")
_SOURCE = re.compile(r"\[([A-Z][\w-]*)\]")


def escaped(text: str) -> str:
    """Plain text in which no character is markup."""
    return _MARKS.sub(r"\\\1", " ".join(text.split()))


def phrase(text: str, sources: Iterable[str] = ()) -> str:
    r"""A line of a docstring or help text; words in backquotes are code, known sources are links.

    >>> phrase("p_s of `supply` [Hill1950]", ["Hill1950"])
    'p\\_s of `supply` {source}`Hill1950`'
    """
    known = set(sources)
    parts = _CODE.split(" ".join(text.split()))
    for k, part in enumerate(parts):
        if k % 2:
            parts[k] = f"`{part.strip('`')}`"
            continue
        plain = _SOURCE.split(part)
        for i, piece in enumerate(plain):
            if i % 2 == 0:
                plain[i] = escaped(piece) if piece.strip() else piece
                lead, trail = piece[:1].isspace(), piece[-1:].isspace()
                if piece.strip():
                    plain[i] = " " * lead + plain[i] + " " * trail
            else:
                plain[i] = f"{{source}}`{piece}`" if piece in known else f"\\[{piece}\\]"
        parts[k] = "".join(plain)
    return "".join(parts)


def paragraphs(text: str, sources: Iterable[str] = ()) -> str:
    """Paragraphs of a docstring; indented lines and lists keep their lines as code."""
    known = set(sources)
    blocks = []
    for block in re.split(r"\n\s*\n", text.strip("\n")):
        lines = block.splitlines()
        if all(line.startswith("    ") for line in lines if line.strip()):
            blocks.append(fence("text", "\n".join(line[4:] for line in lines)))
        elif lines and re.match(r"\s*[-*] ", lines[0]):
            items = re.split(r"^\s*[-*] ", block, flags=re.MULTILINE)[1:]
            blocks.append("\n".join(f"- {phrase(item, known)}" for item in items))
        else:
            blocks.append(phrase(block, known))
    return "\n\n".join(blocks)


def fence(info: str, text: str) -> str:
    """A fenced block; the fence is longer than any in the text."""
    longest = max((len(marks) for marks in re.findall(r"`{3,}", text)), default=2)
    marks = "`" * max(3, longest + 1)
    return f"{marks}{info}\n{text.rstrip()}\n{marks}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of cells that are Markdown already; empty if there is no row."""
    lines = ["| " + " | ".join(cell or " " for cell in row) + " |" for row in rows]
    if not lines:
        return ""
    rule = "|" + "---|" * len(head)
    return "\n".join(["| " + " | ".join(head) + " |", rule, *lines])


def label(name: str) -> str:
    """The line that makes the next heading a target."""
    return f"({name})="


def page(*parts: str) -> str:
    """Parts that are not empty, with a blank line between them."""
    return "\n\n".join(part for part in parts if part) + "\n"
