"""The section of a design for the page: polygons in mm, and how a changed number moves them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..base.numeric import Array
from ..evaluation import Evaluation, PreparedDesign, prepare
from ..evaluation.geometry import derive
from ..evaluation.outline import lines, outlines
from ..evaluation.result import Outline
from ..explorer import part_of_section
from ..joints.joint import Polygon

MM = 1000.0
STEP = 1e-4
"""Relative change of a number for the difference quotient of the section."""
LENGTHS = {"bore": "bore ⌀", "rod": "rod ⌀", "closed_length": "closed length"}


def _points(parts: Sequence[Outline], lines: Sequence[Polygon]) -> Array:
    """Coordinates of all points in order, x then r, in mm."""
    polygons = [polygon for part in parts for polygon in part.polygons]
    return MM * np.concatenate([np.array(shape).ravel() for shape in (*polygons, *lines)])


def drawing(
    parts: Sequence[Outline], lines: Sequence[Polygon], lengths: Mapping[str, float]
) -> dict[str, Any]:
    """The section of a design: parts, numbers of points, coordinates [mm], lengths.

    The last part has the lines that bound no part, such as threads.
    """
    threads = {"part": "thread", "kind": "line", "polygons": [len(line) for line in lines]}
    return {
        "parts": [*map(part_of_section, parts), *([threads] if lines else [])],
        "numbers": np.round(_points(parts, lines), 4).tolist(),
        "lengths": " · ".join(
            f"{words} {MM * lengths[name]:.4g}" for name, words in LENGTHS.items()
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
    design, geometry = subject.design, derive(subject.values(values), subject.design)
    return _points(outlines(design, subject.materials, geometry), lines(design, geometry))
