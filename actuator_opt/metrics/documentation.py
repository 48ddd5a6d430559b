"""First sentence, source and valid range of a model, read from its docstring."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from importlib import import_module

from .. import models as formulas
from ..base.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class ModelDocumentation:
    """A model function, with the source and valid range that its docstring states."""

    name: str
    summary: str
    reference: str
    valid: str


_VALID = re.compile(r"^\s*Valid: (.*?)(?:\n\s*\n|\Z)", re.DOTALL | re.MULTILINE)
_REFERENCES = re.compile(r"References\n\s*-+\n(.*?)(?:\n\s*\n|\Z)", re.DOTALL)


@cache
def describe(function: Callable[..., object]) -> ModelDocumentation:
    """Read the name, first sentence, source and valid range of a model function."""
    doc = function.__doc__ or ""
    valid = _VALID.search(doc)
    reference = _REFERENCES.search(doc)

    def flat(match: re.Match[str] | None) -> str:
        return " ".join(match[1].split()) if match else ""

    module = function.__module__.rpartition(".")[2]
    return ModelDocumentation(
        name=f"{module}.{function.__name__}",
        summary=doc.strip().partition("\n")[0].rstrip("."),
        reference=flat(reference),
        valid=flat(valid),
    )


@cache
def function_of(name: str) -> Callable[..., object]:
    """Model function by the name in the table of metrics, such as ``"forces.push_force"``."""
    module, _, function = name.partition(".")
    model: Callable[..., object] = getattr(import_module(f"{formulas.__name__}.{module}"), function)
    return model
