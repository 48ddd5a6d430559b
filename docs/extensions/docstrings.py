"""Sections of a docstring in the form of NumPy, and the tests that name a model."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping

_HEAD = re.compile(r"^(\w+)\n-{3,}\n", re.MULTILINE)


def sections(documented: object) -> dict[str, str]:
    """Head (key "") and sections of a docstring, in their order."""
    parts = _HEAD.split(inspect.getdoc(documented) or "")
    return {
        "": parts[0].strip(),
        **dict(zip(parts[1::2], map(str.strip, parts[2::2]), strict=True)),
    }


def entries(text: str) -> dict[str, str]:
    """Description of every name of a section `Parameters`, `Raises` or the like."""
    found: dict[str, str] = {}
    for names, description in re.findall(
        r"^(\*{0,2}\w[\w, *]*) : (.*(?:\n[ ]+.*)*)", text, flags=re.MULTILINE
    ):
        found.update(dict.fromkeys(re.split(r",\s*", names), " ".join(description.split())))
    return found


def example(text: str) -> tuple[str, str]:
    """A text without its examples, and the examples."""
    plain, code, inside = [], [], False
    for line in text.splitlines():
        if line.lstrip().startswith(">>>"):
            inside = True
        elif not line.strip():
            inside = False
        (code if inside else plain).append(line)
    shown = inspect.cleandoc("\n".join(["", *code])) if code else ""
    return "\n".join(plain).strip(), shown


def names_used(text: str) -> set[str]:
    """Model functions a test file names: ``module.function``, or imported from its module."""
    used = set(re.findall(r"(?<![\w.])(\w+\.\w+)", text))
    for module, several, one in re.findall(
        r"from actuator_opt\.models\.(\w+) import (?:\(([^)]*)\)|(.*))", text
    ):
        used |= {f"{module}.{name}" for name in re.findall(r"\w+", several or one)}
    return used


def tests_naming(texts: Mapping[str, str]) -> dict[str, list[str]]:
    """For each model function, the test files (by path) whose text names it."""
    found: dict[str, list[str]] = {}
    for path, text in texts.items():
        for name in names_used(text):
            found.setdefault(name, []).append(path)
    return found
