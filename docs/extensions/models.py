"""Reference pages of the models (formulas), the sources, and the tests that pages name."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable, Iterable
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import yaml

import actuator_opt.models as package

from .book import Book
from .docstrings import entries, example, sections, tests_naming
from .markdown import escaped, fence, page, paragraphs, phrase, table

ROOT = Path(__file__).resolve().parents[2]
WALKS = {"model_samples.py", "test_models_laws.py", "test_references.py"}
"""Tests that walk over all models: they test laws, not values."""


@cache
def functions() -> dict[str, Callable[..., Any]]:
    """Public functions of all models by ``module.function``."""
    found = {}
    for info in iter_modules(package.__path__):
        module = import_module(f"{package.__name__}.{info.name}")
        for name, value in vars(module).items():
            own = getattr(value, "__module__", "") == module.__name__
            public = not name.startswith("_") and name in getattr(module, "__all__", [name])
            if inspect.isfunction(value) and own and public:
                found[f"{info.name}.{name}"] = value
    return found


def function(name: str) -> Callable[..., Any]:
    """A model by ``module.function``, or any function of the package by its full dotted path."""
    if name in functions():
        return functions()[name]
    module, _, last = name.rpartition(".")
    if not module.startswith("actuator_opt."):
        raise LookupError(f"no model {name!r}")
    try:
        found: Callable[..., Any] = getattr(import_module(module), last)
    except (ImportError, AttributeError):
        raise LookupError(f"no function {name!r}") from None
    return found


@cache
def references() -> dict[str, dict[str, Any]]:
    """All sources by key."""
    text = (ROOT / "actuator_opt" / "references.yaml").read_text("utf-8")
    found: dict[str, dict[str, Any]] = yaml.safe_load(text)
    return found


@cache
def test_texts() -> dict[str, str]:
    """Text of every test file by its path."""
    paths = sorted((ROOT / "tests").rglob("test_*.py"))
    return {
        path.relative_to(ROOT).as_posix(): path.read_text("utf-8")
        for path in paths
        if path.name not in WALKS
    }


@cache
def _tests() -> dict[str, list[str]]:
    return tests_naming(test_texts())


def register(book: Book) -> None:
    """Register all models and sources."""
    for name in functions():
        book.register("model", name, f"reference/models/{name.partition('.')[0]}")
    for key in references():
        book.register("source", key, "reference/sources")


def write(book: Book) -> None:
    """Write a page for each module of models, their list, and the sources."""
    modules: dict[str, list[str]] = {}
    for name in functions():
        modules.setdefault(name.partition(".")[0], []).append(name)
    rows = []
    for module, names in modules.items():
        head = inspect.getdoc(import_module(f"{package.__name__}.{module}")) or ""
        listed = [
            (f"{{model}}`{n}`", phrase(_summary(functions()[n]), references())) for n in names
        ]
        book.pages[f"reference/models/{module}"] = page(
            f"# {module}",
            paragraphs(head, references()),
            table(("function", "formula"), listed),
            *(
                f"{book.at('model', n)}\n## {escaped(n.partition('.')[2])}\n\n{described(n, book)}"
                for n in names
            ),
        )
        rows.append((f"[{module}](/reference/models/{module}.md)", phrase(head.split("\n\n")[0])))
    book.pages["reference/models/index"] = page(
        "# Models",
        "Each formula is a function of Python: arguments and results in SI, with its valid range, "
        "its source, an example, and the tests of its values.",
        table(("module", "subject"), rows),
        fence("{toctree}", ":hidden:\n\n" + "\n".join(modules)),
    )
    _write_sources(book)


@cache
def theory() -> dict[str, list[str]]:
    """Links to the pages of theory that name each model."""
    found: dict[str, list[str]] = {}
    for path in sorted((ROOT / "docs" / "theory").glob("*.md")):
        text = path.read_text("utf-8")
        title = re.search(r"^# (.+)$", text, flags=re.MULTILINE)
        link = f"[{title[1] if title else path.stem}](/theory/{path.name})"
        for name in dict.fromkeys(re.findall(r"\{model\}`([\w.]+)`", text)):
            found.setdefault(name, []).append(link)
    return found


def theory_of(names: Iterable[str]) -> str:
    """Links to all pages of theory that name one of these models."""
    return ", ".join(dict.fromkeys(link for name in names for link in theory().get(name, [])))


def _summary(model: Callable[..., Any]) -> str:
    return sections(model)[""].partition("\n\n")[0]


def described(name: str, book: Book | None = None) -> str:
    """Formula, arguments, result, valid range, source, example and tests of a function."""
    model, keys = function(name), references()
    parts = sections(model)
    head, doctest = example(parts.pop(""))
    notes, more = example(parts.get("Notes", ""))
    examples = [doctest, more, example(parts.get("Examples", ""))[1]]
    valid = re.match(r"Valid: (.*?)(?:\n\n|\Z)", notes, flags=re.DOTALL)
    rest = notes[valid.end() :] if valid else notes
    rows = [
        (f"`{n}`", phrase(text, keys)) for n, text in entries(parts.get("Parameters", "")).items()
    ]
    tests = _tests().get(name, []) if name in functions() else []
    if book is not None:
        book.require("model", name, definition=head, source=parts.get("References"),
                     range=valid, example=any(examples), test=tests)  # fmt: skip
    facts = {
        "result": phrase(parts.get("Returns", ""), keys),
        "valid": phrase(valid[1], keys) if valid else "",
        "source": phrase(parts.get("References", ""), keys),
        "errors": phrase(parts.get("Raises", ""), keys),
        "theory": theory_of([name]) if book is not None else "",
        "tests": ", ".join(f"`{test}`" for test in tests),
    }
    return page(
        paragraphs(head, keys),
        table(("argument", "meaning"), rows),
        "\n".join(f"- **{head}**: {text}" for head, text in facts.items() if text),
        paragraphs(rest, keys) if rest.strip() else "",
        fence("pycon", "\n".join(text for text in examples if text)) if any(examples) else "",
    ).rstrip()


def _write_sources(book: Book) -> None:
    """The bibliography, with the models that cite each source."""
    citing: dict[str, list[str]] = {}
    for name, model in functions().items():
        for key in set(re.findall(r"\[([A-Z][\w-]*)\]", inspect.getdoc(model) or "")):
            citing.setdefault(key, []).append(name)
    parts = []
    for key, entry in sorted(references().items(), key=lambda pair: pair[0].lower()):
        book.require("source", key, author=entry.get("author"), title=entry.get("title"))
        year = entry["year"] or "no year"
        text = f"{escaped(entry['author'])}: *{escaped(entry['title'])}*. "
        text += f"{escaped(entry['where'])}, {year}."
        if doi := entry.get("doi"):
            text += f" [doi:{escaped(doi)}](https://doi.org/{doi})"
        seen = "read in the source" if entry["seen"] == "source" else (
            "cited from memory; its page was not read again"
        )  # fmt: skip
        used = ", ".join(f"{{model}}`{name}`" for name in citing.get(key, []))
        lines = [f"- seen: {seen}"]
        lines += [f"- note: {phrase(entry['note'])}"] if entry.get("note") else []
        lines += [f"- used in {used}"] if used else []
        parts.append(
            f"{book.at('source', key)}\n## {escaped(key)}\n\n{text}\n\n" + "\n".join(lines)
        )
    book.pages["reference/sources"] = page(
        "# Sources",
        "The keys in brackets in docstrings, reports and JSON, such as \\[Hill1950\\].",
        *parts,
    )


def test_exists(name: str) -> bool:
    """Whether ``path::function`` names a file and a function (or class, or its method) in it."""
    path, _, last = name.partition("::")
    file = ROOT / path
    if not file.is_file() or not path.startswith("tests/"):
        return False
    wanted = re.sub(r"\[.*\]$", "", last).split("::")
    body: list[ast.stmt] = ast.parse(file.read_text("utf-8")).body
    for word in filter(None, wanted):
        found = [
            n for n in body if isinstance(n, ast.FunctionDef | ast.ClassDef) and n.name == word
        ]
        if not found:
            return False
        body = found[0].body
    return True


test_exists.__test__ = False  # type: ignore[attr-defined]
test_texts.__test__ = False  # type: ignore[attr-defined]
