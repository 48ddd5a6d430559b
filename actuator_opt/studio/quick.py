"""Section, masses and limits of an optimum, before its design is evaluated."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..api import BareOptimum
from ..design import quantity_of
from ..design.paths import words_of
from ..evaluation import PreparedDesign, outline, rods, weight
from ..evaluation.geometry import derive
from ..evaluation.limits import ALL_CASES, MaterialValues
from ..metrics import term_of
from ..rendering import text
from . import section


def shown(bare: BareOptimum) -> dict[str, Any]:
    """Data of an optimum for the page, as far as they need no evaluation."""
    subject, v = bare.subject, bare.subject.values()
    design, g = subject.design, derive(v, subject.design)
    masses = _masses(subject)
    return {
        "objective": bare.objective,
        "section": section.drawing(
            outline.outlines(design, subject.materials, g),
            outline.lines(design, g),
            outline.lengths(design, g),
        ),
        "masses": [{"part": part.replace("_", " "), "mass": mass} for part, mass in masses.items()],
        "mass": sum(masses.values()),
        "holds": [*_limits(bare), *_bounds(bare)],
        "dimensions": dict(bare.variables),
    }


def label_of(path: str) -> str:
    """The value that a PATH names, in the words of the page's menus.

    >>> label_of("barrel.layup[0].angle"), label_of("rod.wall[1].thickness")
    ('barrel, layer 1, angle', 'rod, layer 2, thickness')
    """
    layer = re.fullmatch(r"(.+)\.(?:layup|wall)\[(\d+)\]\.(\w+)", path)
    if layer is None:
        return words_of(path)
    part, number, key = layer.groups()
    return f"{part}, layer {int(number) + 1}, {key}".replace("_", " ").replace(".", " ")


def _masses(subject: PreparedDesign) -> Mapping[str, float]:
    """Mass of every part [kg]."""
    v, design = subject.values(), subject.design
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    g = derive(v, design)
    parts = weight.parts(v, design, stock, g, rods.derive(v, design, stock, g))
    return {part: float(np.squeeze(mass)) for part, mass in parts.items()}


def _limits(bare: BareOptimum) -> list[dict[str, Any]]:
    """The active limits of metrics, each once."""
    v, rows = bare.subject.values(), dict[tuple[str, str], dict[str, Any]]()
    for row in bare.limits:
        limit = row.limit_of
        if limit.origin == "geometry":
            continue
        value = float(np.squeeze(limit.value(v)))
        case = None if row.case == ALL_CASES else row.case
        rows.setdefault(
            (limit.metric, limit.sense),
            {
                "name": term_of(limit.metric),
                "limit": text.limit_text(text.metric(limit.metric), limit.sense, value),
                "value": "",
                "where": text.brief(case, row.place),
                "missed": False,
            },
        )
    return list(rows.values())


def _bounds(bare: BareOptimum) -> list[dict[str, Any]]:
    """The dimensions that stand at a bound."""
    found = []
    for path, value in bare.variables.items():
        side = next((x for x in ("lower", "upper") if f"{path} {x}" in bare.active), None)
        if side is not None:
            quantity = quantity_of(path, bare.subject.design)
            found.append(
                {"name": label_of(path), "limit": f"{side} bound", "value": quantity.text(value),
                 "where": "", "missed": False}
            )  # fmt: skip
    return found
