"""Skirts of the caps over the outside of the barrel: common to bond and thread."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

from ..base.numeric import Array
from ..models import mass
from .joint import Drawn, End, Fit, Loaded, Materials, Span


def fit(end: End, radius: Array) -> Fit:
    """A skirt with this inner radius over the end of the barrel."""
    wall = end.sizes["wall"]
    return Fit(plate_radius=radius + wall, radius=radius, length=end.sizes["length"], wall=wall)


def weight(end: End, materials: Materials, radius: Array) -> Array:
    """Mass of a skirt [kg]."""
    density = materials.get(end.cap, "density")
    section = mass.layer_area(inner_radius=radius, thickness=end.sizes["wall"])
    return density * section * end.sizes["length"]


def outline(end: End, fit: Fit, span: Span) -> Iterator[Drawn]:
    """The skirt at one end."""
    length, inner = float(fit.length), float(fit.radius)
    if length > 0:
        yield Drawn("caps", end.cap, span.over(length, inner, inner + float(fit.wall)))


def yields(loaded: Loaded) -> dict[str, Array]:
    """Yield over stress of the skirt under the force of the end."""
    end = loaded.end
    strength = loaded.materials.allowable(end.cap, "yield_strength")
    if strength is None:
        return {}
    return {"cap skirt": strength * (2 * pi * end.outer_radius * end.sizes["wall"]) / loaded.force}
