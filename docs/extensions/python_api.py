"""Reference pages of the Python functions and classes that `actuator_opt` exports."""

from __future__ import annotations

import inspect
from typing import Any

import actuator_opt as ao

from .book import Book
from .docstrings import entries, example, sections
from .markdown import escaped, fence, page, paragraphs, phrase, table
from .models import references

PAGES = {
    "functions": "Functions",
    "results": "Results and other classes",
    "errors": "Errors",
}
PLAIN = (str, int, float, bool, tuple, type(None))
"""Types of defaults that are shown; others are shown as dots."""


def _group(value: Any) -> str:
    if not isinstance(value, type):
        return "functions"
    return "errors" if issubclass(value, Exception) or value is ao.Diagnostic else "results"


def _public() -> dict[str, Any]:
    return {name: getattr(ao, name) for name in ao.__all__ if not name.startswith("__")}


def register(book: Book) -> None:
    """Register every public name."""
    for name, value in _public().items():
        book.register("python", name, f"reference/python/{_group(value)}", f"ao.{name}")


def write(book: Book) -> None:
    """Write the pages of functions, classes and errors."""
    for group, title in PAGES.items():
        names = {name: value for name, value in _public().items() if _group(value) == group}
        rows = [
            (f"[`{n}`](#{book.labels['python'][n]})", phrase(_head(v))) for n, v in names.items()
        ]
        book.pages[f"reference/python/{group}"] = page(
            f"# {title}",
            table(("name", "purpose"), rows),
            *(_section(name, value, book) for name, value in names.items()),
        )
    head = (inspect.getdoc(ao) or "").partition("\n\n")[2]
    book.pages["reference/python/index"] = page(
        "# Python",
        paragraphs(example(head)[0], references()),
        "Numbers are SI. A wrong argument raises an `ActuatorError` with place and remedy.",
        fence("{toctree}", "\n".join(PAGES)),
    )


def _head(value: Any) -> str:
    return sections(value)[""].partition("\n\n")[0]


def _signature(name: str, value: Any) -> str:
    try:
        signature = inspect.signature(value)
    except (TypeError, ValueError):
        return name
    texts = []
    starred = False
    for parameter in signature.parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not starred:
            texts.append("*")
            starred = True
        starred = starred or parameter.kind is parameter.VAR_POSITIONAL
        default = parameter.default
        if default is not parameter.empty and not isinstance(default, PLAIN):
            default = ...
        texts.append(str(parameter.replace(annotation=parameter.empty, default=default)).replace(
            "Ellipsis", "..."))  # fmt: skip
    inner = ", ".join(texts)
    if len(name) + len(inner) <= 86:
        return f"{name}({inner})"
    return f"{name}(\n    " + ",\n    ".join(texts) + ",\n)"


def _documented(value: Any) -> list[str]:
    """Text, parameters, result, errors and examples of a docstring."""
    keys = references()
    parts = sections(value)
    head, code = example(parts.pop(""))
    texts = [paragraphs(head, keys)]
    if "Parameters" in parts:
        rows = [(f"`{n}`", phrase(t, keys)) for n, t in entries(parts["Parameters"]).items()]
        texts.append(table(("argument", "meaning"), rows))
    facts, codes = [], [code]
    for title, name in (("Returns", "result"), ("Raises", "errors"), ("Yields", "yields")):
        text, more = example(parts.get(title, ""))
        codes.append(more)
        facts += [f"- **{name}**: {phrase(text, keys)}"] if text else []
    texts.append("\n".join(facts))
    for title in ("Notes", "References", "Examples"):
        text, more = example(parts.get(title, ""))
        codes.append(more)
        texts += [paragraphs(text, keys)] if text else []
    code = "\n".join(c for c in codes if c)
    return [*texts, fence("pycon", code) if code else ""]


def _section(name: str, value: Any, book: Book) -> str:
    book.require("python", name, definition=_head(value))
    parts = [f"{book.at('python', name)}\n## {escaped(name)}"]
    if not (isinstance(value, type) and issubclass(value, Exception)):
        parts.append(fence("python", _signature(name, value)))
    parts += _documented(value)
    if isinstance(value, type):
        rows = []
        for member in sorted(dir(value)):
            found = inspect.getattr_static(value, member)
            if member.startswith("_") or not _described(found):
                continue
            call = "" if isinstance(found, property) else "()"
            target = getattr(found, "__func__", found)
            rows.append((f"`{member}{call}`", phrase(_head(target))))
        parts.append(table(("attribute or method", "meaning"), rows))
    return page(*parts).rstrip()


def _described(found: object) -> bool:
    if isinstance(found, property):
        return bool(found.__doc__)
    return callable(getattr(found, "__func__", found)) and bool(getattr(found, "__doc__", ""))
