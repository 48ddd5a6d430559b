"""Margins to the manufacturing limits of layers, and the length that a winding needs to turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..base.numeric import Array, absolute
from ..design.material import Material
from ..design.model import Design, Ply
from ..models import winding_path
from .geometry import Geometry
from .values import Values


def manufacture_margins(
    v: Values, design: Design, materials: Mapping[str, Material]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Margins to the manufacturing limits of plies, by layer of barrel and rod.

    The first margin is the winding angle minus the smallest feasible angle [rad]. The second is
    layer thickness divided by smallest feasible thickness, minus one. A layer at exactly 0 deg is
    laid along the mandrel, not wound, so it has no smallest angle.
    """
    angle_margins: dict[str, Array] = {}
    thickness_margins: dict[str, Array] = {}
    for path, ply in _layers(design):
        numbers, at = materials[ply.material].numbers, f"materials.{ply.material}."
        laid = ply.angle == 0 and f"{path}.angle" not in (*design.variables, *v.varied)
        if numbers.get("minimum_angle", 0.0) > 0 and not laid:
            angle_margins[path] = absolute(v[f"{path}.angle"]) - v[f"{at}minimum_angle"]
        if numbers.get("minimum_thickness", 0.0) > 0:
            thickness_margins[path] = v[f"{path}.thickness"] / v[f"{at}minimum_thickness"] - 1
    return angle_margins, thickness_margins


def turn_lengths(
    v: Values, design: Design, materials: Mapping[str, Material], g: Geometry
) -> dict[str, Array]:
    """Length that the winding needs to turn at each end, by layer of barrel and rod [m].

    Metals, and layers at exactly 0 deg, which are laid and not wound, are left out.
    """
    lengths = {}
    radius, rod_radius = g.inner_radius, g.rod_inner_diameter / 2
    for path, ply in _layers(design):
        thickness = v[f"{path}.thickness"]
        if path.startswith("barrel"):
            outer = radius = radius + thickness
        else:
            outer = rod_radius = rod_radius + thickness
        laid = ply.angle == 0 and f"{path}.angle" not in (*design.variables, *v.varied)
        if materials[ply.material].kind == "ply" and not laid:
            lengths[path] = winding_path.turn_length(radius=outer, angle=v[f"{path}.angle"])
    return lengths


def _layers(design: Design) -> Iterator[tuple[str, Ply]]:
    """Yield all layers of barrel and rod, with their PATHs."""
    for part, layup in (("barrel", design.barrel.layup), ("rod", design.rod.layup)):
        for i, entry in enumerate(layup):
            yield f"{part}.layup[{i}]", entry
