"""Half-sections of many designs, drawn from a few templates.

As long as no part appears, vanishes or changes its form, every coordinate in `outline.outlines` is
a linear function of the dimensions. A template contains these functions, which are found by varying
each dimension. A design is drawn from a template that reproduces its outlines; without such a
template, it is not drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..joints.joint import (
    EndDimensions,
    SleeveFit,
)
from . import geometry as geometry_module
from .geometry import (
    Geometry,
    Groove,
    RodThrough,
)
from .kernel import PreparedDesign
from .outline import lengths, outlines
from .result import Outline

MOST = 24
"""Largest number of templates for the variants of a design."""


SAME = 1e-7
"""Largest permissible error of a coordinate that is drawn from a template [m]."""


STEP = 1e-4
"""Change of a dimension from which its effect on the coordinates is computed [m]."""


LENGTHS = ("bore", "rod", "stroke", "closed_length")
"""Dimensions that are listed beside a section."""


_GROOVE = ("section", "gland_depth", "width", "ring_width", "count")
_ROD = ("diameter", "inner_diameter", "outside", "length")


_Change: TypeAlias = Callable[[Array], Array]


@dataclass(frozen=True)
class Template:
    """Outlines of a design, and the derivatives of their coordinates by each dimension.

    `numbers` [m] are the coordinates x and r of every point in order, then `LENGTHS`. `slopes` are
    their derivatives (numbers, dimensions), and `origin` the dimensions of the template's design.
    """

    outlines: tuple[Outline, ...]
    numbers: Array
    slopes: Array
    origin: Array

    def at(self, dimensions: Array) -> Array:
        """Coordinates and lengths (numbers, designs) of designs with these dimensions."""
        numbers: Array = self.numbers[:, None] + self.slopes @ (dimensions - self.origin[:, None])
        return numbers


@dataclass(frozen=True)
class Shapes:
    """Drawn sections of many designs: their dimensions (dimensions, designs), and templates.

    `which` is the index of the template for each design, -1 if no template reproduces its outlines.
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
    """Draw the sections of designs that differ only in the numbers in `varied`.

    Parameters
    ----------
    subject : the design
    varied : arrays (designs,) by PATH, such as `cylinder.bore`, SI
    count : number of designs
    hidden : names of parts that are not drawn
    """
    geometry = geometry_module.derive(subject.values(varied), subject.design)
    dimensions = np.stack([np.broadcast_to(leaf, (count,)) for leaf in sizes_of(geometry)])
    parts = [_Parts(subject, geometry, dimensions[:, k], hidden) for k in range(count)]
    actual = [part.drawn() for part in parts]
    templates: list[Template] = []
    which = np.full(count, -1)
    moving = np.flatnonzero(np.ptp(dimensions, axis=1) > 0)
    unmatched = [k for k in range(count) if np.isfinite(actual[k][1]).all()]
    while unmatched and len(templates) < MOST:
        first = unmatched[0]
        template = _template(parts[first], actual[first], moving)
        predicted = template.at(dimensions[:, unmatched])
        form = _form(template.outlines)
        fits = [
            _form(actual[k][0]) == form
            and bool(np.abs(predicted[:, j] - actual[k][1]).max() < SAME)
            for j, k in enumerate(unmatched)
        ]
        which[[k for k, fit in zip(unmatched, fits, strict=True) if fit]] = len(templates)
        templates.append(template)
        unmatched = [k for k, fit in zip(unmatched, fits, strict=True) if not fit]
    return Shapes(dimensions, tuple(templates), which)


def same_dimensions(
    first: tuple[PreparedDesign, Mapping[str, Array]],
    second: tuple[PreparedDesign, Mapping[str, Array]],
    count: int,
) -> bool:
    """Whether two prepared designs, each with its varied inputs, have the same dimensions."""
    dimensions = []
    for subject, varied in (first, second):
        geometry = geometry_module.derive(subject.values(varied), subject.design)
        dimensions.append([np.broadcast_to(value, (count,)) for value in sizes_of(geometry)])
    return len(dimensions[0]) == len(dimensions[1]) and bool(
        np.allclose(dimensions[0], dimensions[1], rtol=0.0, atol=SAME, equal_nan=True)
    )


def template_of(subject: PreparedDesign) -> Template:
    """Template of one design, with the derivatives by all its dimensions.

    Dimensions that are equal by construction, such as a shoulder and the ring on it, differ as soon
    as only one is changed. A point that then appears between two others is left out.
    """
    geometry = geometry_module.derive(subject.values({}), subject.design)
    dimensions = np.array([float(np.squeeze(size)) for size in sizes_of(geometry)])
    parts = _Parts(subject, geometry, dimensions, ())
    outlines, numbers = parts.drawn()
    slopes = np.zeros((len(numbers), len(dimensions)))
    for k in range(len(dimensions)):
        moved = _like(outlines, *parts.drawn(k))
        if len(moved) == len(numbers):
            slopes[:, k] = np.round((moved - numbers) / STEP, 9)
    return Template(outlines, numbers, slopes, dimensions)


def _like(outlines: tuple[Outline, ...], moved: tuple[Outline, ...], numbers: Array) -> Array:
    """The coordinates of moved outlines, without points that the outlines do not have."""
    points, at = [], 0
    known, present = ([p for o in parts for p in o.polygons] for parts in (outlines, moved))
    for before, after in zip(known, present, strict=False):  # else no derivative
        shape = numbers[at : at + 2 * len(after)].reshape(-1, 2)
        at += 2 * len(after)
        while len(shape) > len(before):
            gaps = np.abs(shape - np.roll(shape, 1, axis=0)).sum(axis=1)
            shape = np.delete(shape, np.argmin(gaps), axis=0)
        points.append(shape.ravel())
    return np.concatenate([*points, numbers[at:]])


@dataclass(frozen=True)
class _Parts:
    """The parts of one design, to draw them with its dimensions or with one dimension changed."""

    subject: PreparedDesign
    geometry: Geometry
    dimensions: Array
    hidden: tuple[str, ...]

    def drawn(self, moved: int | None = None) -> tuple[tuple[Outline, ...], Array]:
        """Outlines and their coordinates; the dimension with index `moved` is changed by `STEP`."""
        values = self.dimensions.astype(float)
        if moved is not None:
            values[moved] += STEP
        dimension_values = iter(values.tolist())
        geometry = _changed(self.geometry, lambda _: next(dimension_values))
        design = self.subject.design
        drawn = outlines(design, self.subject.materials, geometry)
        drawn = tuple(part for part in drawn if part.part not in self.hidden)
        numbers = [c for part in drawn for shape in part.polygons for point in shape for c in point]
        values_of = lengths(design, geometry)
        return drawn, np.array([*numbers, *(values_of[name] for name in LENGTHS)])


def _template(parts: _Parts, drawn: tuple[tuple[Outline, ...], Array], moving: Array) -> Template:
    outlines, numbers = drawn
    slopes = np.zeros((len(numbers), len(parts.dimensions)))
    for k in moving:
        moved = parts.drawn(int(k))[1]
        if len(moved) == len(numbers):
            slopes[:, k] = np.round((moved - numbers) / STEP, 9)
    return Template(outlines, numbers, slopes, parts.dimensions)


def _form(outlines: tuple[Outline, ...]) -> list[object]:
    """Parts, materials and numbers of points; equal for outlines that differ only in dimensions."""
    return [(o.part, o.material, o.kind, [len(p) for p in o.polygons]) for o in outlines]


def sizes_of(geometry: Geometry) -> list[Array]:
    """All dimensions as a list of numbers, in a fixed order."""
    leaves: list[Array] = []

    def keep(value: Array) -> Array:
        leaves.append(value)
        return value

    _changed(geometry, keep)
    return leaves


def _changed(geometry: Geometry, change: _Change) -> Geometry:
    """Copy the dimensions, with `change` applied to every number."""
    values: dict[str, Any] = {}
    for field in fields(Geometry):
        value = getattr(geometry, field.name)
        if isinstance(value, tuple):
            values[field.name] = tuple(
                entry if isinstance(entry, str) else _changed_entry(entry, change)
                for entry in value
            )
        else:
            values[field.name] = change(value)
    return Geometry(**values)


def _changed_sleeve(sleeve: SleeveFit, change: _Change) -> SleeveFit:
    bare, inner, ramp, lift = (change(size) for size in sleeve[:4])
    return SleeveFit(bare, inner, ramp, lift, sleeve.liner)


def _changed_fit(fit: EndDimensions, change: _Change) -> EndDimensions:
    return EndDimensions(
        plate_radius=change(fit.plate_radius),
        radius=change(fit.radius),
        length=change(fit.length),
        wall=change(fit.wall),
        beyond=change(fit.beyond),
        lip=change(fit.lip),
        inner_length=change(fit.inner_length),
        inset=change(fit.inset),
        groove=tuple(change(size) for size in fit.groove),
        short=change(fit.short),
        own=tuple(change(size) for size in fit.own),
        sleeve=None if fit.sleeve is None else _changed_sleeve(fit.sleeve, change),
    )


def _changed_groove(groove: Groove, change: _Change) -> Groove:
    return replace(groove, **{name: change(getattr(groove, name)) for name in _GROOVE})


def _changed_entry(
    value: Groove | EndDimensions | RodThrough | Array, change: _Change
) -> Groove | EndDimensions | RodThrough | Array:
    if isinstance(value, EndDimensions):
        return _changed_fit(value, change)
    if isinstance(value, RodThrough):
        sizes = {name: change(getattr(value, name)) for name in _ROD}
        grooves = tuple(_changed_groove(groove, change) for groove in value.grooves)
        return replace(value, **sizes, grooves=grooves)
    return _changed_groove(value, change) if isinstance(value, Groove) else change(value)
