"""The section of a design for the page: polygons in mm, and how a changed number moves them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..evaluation import Evaluation, PreparedDesign, prepare
from ..evaluation.geometry import derive
from ..evaluation.outline import outlines
from ..evaluation.result import Outline

MM = 1000.0
STEP = 1e-4
"""Relative change of a number for the difference quotient of the section."""
LENGTHS = {"bore": "bore ⌀", "rod": "rod ⌀", "closed_length": "closed length"}


def _points(parts: Sequence[Outline]) -> Array:
    """Coordinates of all points in order, x then r, in mm."""
    shapes = [np.array(polygon).ravel() for part in parts for polygon in part.polygons]
    return MM * np.concatenate(shapes)


def parts(outlines: Sequence[Outline]) -> list[dict[str, Any]]:
    """Name, kind, sides of the axis, and numbers of points of every part."""
    return [
        {
            "part": outline.part.replace("_", " "),
            "kind": outline.kind,
            "sides": list(outline.sides),
            "points": [len(polygon) for polygon in outline.polygons],
        }
        for outline in outlines
    ]


def drawing(evaluation: Evaluation) -> dict[str, Any]:
    """The section of an evaluated design: parts, numbers of points, coordinates [mm], lengths."""
    return {
        "parts": parts(evaluation.outlines),
        "numbers": np.round(_points(evaluation.outlines), 4).tolist(),
        "lengths": " · ".join(
            f"{words} {MM * evaluation.lengths[name]:.4g}" for name, words in LENGTHS.items()
        )
        + " mm",
    }


def slopes(
    evaluation: Evaluation, changes: Sequence[tuple[str, float, Mapping[str, float]]]
) -> list[list[float] | None]:
    """Derivatives of the coordinates of `drawing` by some numbers, in mm per SI unit.

    Parameters
    ----------
    evaluation : the design at its optimum
    changes : PATH of a number, its value, and the change of each free dimension per unit of it

    Returns
    -------
    for each number the derivatives, or None if the parts themselves would change
    """
    subject = prepare(evaluation.design)
    base = _drawn(subject, {})
    result: list[list[float] | None] = []
    for path, value, movement in changes:
        step = STEP * (abs(value) or 1.0)
        present = subject.numbers
        moved = {name: present[name] + step * slope for name, slope in movement.items()}
        if not path.startswith(("requirements.", "load_cases[")):
            moved[path] = value + step
        drawn = _drawn(subject, moved)
        if len(drawn) == len(base) and np.isfinite(drawn).all():
            result.append([float(f"{slope:.5g}") for slope in (drawn - base) / step])
        else:
            result.append(None)
    return result


def _drawn(subject: PreparedDesign, values: Mapping[str, float]) -> Array:
    geometry = derive(subject.values(values), subject.design)
    return _points(outlines(subject.design, subject.materials, geometry))
