"""The model of a metric, with the description from its docstring."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from importlib import import_module
from typing import cast

from .. import models
from ..metrics.metric import CRITERION
from ..metrics.table import ROWS
from ..models.criteria import CRITERIA


@dataclass(frozen=True, slots=True)
class Model:
    """A model function with the contents of its docstring."""

    name: str
    summary: str
    reference: str
    valid: str


_VALID = re.compile(r"^\s*Valid: (.*?)(?:\n\s*\n|\Z)", re.DOTALL | re.MULTILINE)
_REFERENCES = re.compile(r"References\n\s*-+\n(.*?)(?:\n\s*\n|\Z)", re.DOTALL)


@cache
def describe(function: Callable[..., object]) -> Model:
    """Name, first sentence, source and valid range of a model function."""
    doc = function.__doc__ or ""
    valid = _VALID.search(doc)
    reference = _REFERENCES.search(doc)

    def flat(match: re.Match[str] | None) -> str:
        return " ".join(match[1].split()) if match else ""

    module = function.__module__.rpartition(".")[2]
    return Model(
        name=f"{module}.{function.__name__}",
        summary=doc.strip().partition("\n")[0].rstrip("."),
        reference=flat(reference),
        valid=flat(valid),
    )


@cache
def function_of(name: str) -> Callable[..., object]:
    """Model function of a name in the table of metrics, ``"forces.push_force"``."""
    module, _, function = name.partition(".")
    found: Callable[..., object] = getattr(import_module(f"{models.__name__}.{module}"), function)
    return found


def model_of(
    metric: str, *, wall: str, criterion: str = "max_stress", place: str | None = None
) -> Model | None:
    """Model of a metric at its governing place; None for plain geometry and inputs.

    `wall` is the barrel's model, `criterion` that of its plies.
    """
    row = ROWS.get(metric)
    if row is None:  # a user's own
        return None
    name = row.by_wall.get(wall) or row.model  # type: ignore[call-overload]
    for pattern, other in row.at.items():
        if place is not None and fnmatchcase(place, pattern):
            name = other
    if name == CRITERION:
        return describe(cast(Callable[..., object], CRITERIA[criterion].modes))
    return None if name is None else describe(function_of(name))
