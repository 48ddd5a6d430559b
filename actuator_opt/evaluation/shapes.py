"""Half-sections of many designs: few templates with points that move with the dimensions.

Every point of `outline.outlines` is a sum of dimensions, as long as no part appears, vanishes or
changes its form. A template contains these sums, determined by varying each dimension. Each design
is drawn from a template that reproduces its outlines, or is not drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, TypeAlias

import numpy as np

from ..base.numeric import Array
from ..joints.joint import Fit
from . import geometry as geometry_module, outline
from .geometry import Geometry
from .grooves import Groove
from .kernel import PreparedDesign
from .result import Outline

MOST = 24
"""Most templates of a prepared design."""

SAME = 1e-7
"""Largest error of a point of a template (m)."""

STEP = 1e-4
"""Step of a dimension to determine its effect (m)."""

LENGTHS = ("bore", "rod", "stroke", "closed_length")
"""Dimensions that are listed beside a section."""

_GROOVE = ("section", "gland_depth", "width", "ring_width", "count")
_Change: TypeAlias = Callable[[Array], Array]


@dataclass(frozen=True)
class Template:
    """Outlines of a design, and their slopes by the dimensions.

    `numbers` (m) are x and r of every point in order, then `LENGTHS`; `slopes` is
    (numbers, dimensions), `origin` the dimensions of its design.
    """

    outlines: tuple[Outline, ...]
    numbers: Array
    slopes: Array
    origin: Array

    def at(self, dimensions: Array) -> Array:
        """The numbers (numbers, designs) at dimensions (dimensions, designs)."""
        found: Array = self.numbers[:, None] + self.slopes @ (dimensions - self.origin[:, None])
        return found


@dataclass(frozen=True)
class Shapes:
    """Sections of many designs: dimensions (dimensions, designs), and a template each.

    `which` is the index of the template, -1 if no template reproduces the outlines.
    """

    dimensions: Array
    templates: tuple[Template, ...]
    which: Array


def shapes(
    subject: PreparedDesign,
    varied: Mapping[str, Array],
    count: int,
    hidden: tuple[str, ...] = (),
) -> Shapes:
    """Sections of designs that differ in some numbers.

    Parameters
    ----------
    subject : the design
    varied : arrays (designs,) by PATH, SI
    count : number of designs
    hidden : omitted parts
    """
    geometry = geometry_module.derive(subject.values(varied), subject.design)
    dimensions = np.stack([np.broadcast_to(one, (count,)) for one in _leaves(geometry)])
    parts = [_Parts(subject, geometry, dimensions[:, k], hidden) for k in range(count)]
    actual = [part.drawn() for part in parts]
    templates: list[Template] = []
    which = np.full(count, -1)
    moving = np.flatnonzero(np.ptp(dimensions, axis=1) > 0)
    left = [k for k in range(count) if np.isfinite(actual[k][1]).all()]
    while left and len(templates) < MOST:
        first = left[0]
        template = _template(parts[first], actual[first], moving)
        told = template.at(dimensions[:, left])
        like = _form(template.outlines)
        fits = [
            _form(actual[k][0]) == like and bool(np.abs(told[:, j] - actual[k][1]).max() < SAME)
            for j, k in enumerate(left)
        ]
        which[[k for k, fit in zip(left, fits, strict=True) if fit]] = len(templates)
        templates.append(template)
        left = [k for k, fit in zip(left, fits, strict=True) if not fit]
    return Shapes(dimensions, tuple(templates), which)


def same_dimensions(
    one: tuple[PreparedDesign, Mapping[str, Array]],
    other: tuple[PreparedDesign, Mapping[str, Array]],
    count: int,
) -> bool:
    """Whether two prepared designs with their varied inputs have the same dimensions."""
    found = []
    for subject, varied in (one, other):
        geometry = geometry_module.derive(subject.values(varied), subject.design)
        found.append([np.broadcast_to(value, (count,)) for value in _leaves(geometry)])
    return len(found[0]) == len(found[1]) and bool(
        np.allclose(found[0], found[1], rtol=0.0, atol=SAME, equal_nan=True)
    )


@dataclass(frozen=True)
class _Parts:
    """One design of many: the outlines at its dimensions."""

    subject: PreparedDesign
    geometry: Geometry
    dimensions: Array
    hidden: tuple[str, ...]

    def drawn(self, moved: int | None = None) -> tuple[tuple[Outline, ...], Array]:
        """Outlines and their numbers, with one dimension varied slightly."""
        values = self.dimensions.astype(float)
        if moved is not None:
            values[moved] += STEP
        some = iter(values.tolist())
        one = _changed(self.geometry, lambda _: next(some))
        design = self.subject.design
        found = outline.outlines(design, self.subject.materials, one)
        found = tuple(part for part in found if part.part not in self.hidden)
        numbers = [c for part in found for shape in part.polygons for point in shape for c in point]
        lengths = outline.lengths(design, one)
        return found, np.array([*numbers, *(lengths[name] for name in LENGTHS)])


def _template(parts: _Parts, drawn: tuple[tuple[Outline, ...], Array], moving: Array) -> Template:
    outlines, numbers = drawn
    slopes = np.zeros((len(numbers), len(parts.dimensions)))
    for k in moving:
        moved = parts.drawn(int(k))[1]
        if len(moved) == len(numbers):
            slopes[:, k] = np.round((moved - numbers) / STEP, 9)
    return Template(outlines, numbers, slopes, parts.dimensions)


def _form(outlines: tuple[Outline, ...]) -> list[object]:
    """Structure of outlines that differ only in dimensions."""
    return [(o.part, o.material, o.kind, [len(p) for p in o.polygons]) for o in outlines]


def _leaves(geometry: Geometry) -> list[Array]:
    """All numbers of the dimensions, in a fixed order."""
    found: list[Array] = []

    def keep(value: Array) -> Array:
        found.append(value)
        return value

    _changed(geometry, keep)
    return found


def _changed(geometry: Geometry, change: _Change) -> Geometry:
    """The dimensions with every number replaced."""
    values: dict[str, Any] = {}
    for field in fields(Geometry):
        value = getattr(geometry, field.name)
        if isinstance(value, tuple):
            values[field.name] = tuple(_changed_one(one, change) for one in value)
        elif isinstance(value, Fit):
            values[field.name] = _changed_fit(value, change)
        else:
            values[field.name] = value if isinstance(value, bool) else change(value)
    return Geometry(**values)


def _changed_fit(fit: Fit, change: _Change) -> Fit:
    return Fit(
        plate_radius=change(fit.plate_radius),
        radius=change(fit.radius),
        length=change(fit.length),
        wall=change(fit.wall),
        own=tuple(change(one) for one in fit.own),
    )


def _changed_one(value: Groove | Array, change: _Change) -> Groove | Array:
    if not isinstance(value, Groove):
        return change(value)
    return replace(value, **{name: change(getattr(value, name)) for name in _GROOVE})
