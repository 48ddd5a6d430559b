"""A position sensor in the hollow rod: its mass, and the clearances that it needs.

The sensor is fixed in the cap. Its element passes through the piston into the bore of the rod, over
the stroke and its dead length, measured from the end of the chamber.
"""

from __future__ import annotations

from math import pi
from typing import Any

from ..base.numeric import Array
from ..design.model import Design
from .geometry import Geometry
from .rods import RodSection, fitting_hole
from .values import Values

NO_SENSOR = "no position sensor stated: add sensor"


def bore(v: Values, design: Design, rod: RodSection) -> Array:
    """Bore of the rod where the sensor enters it."""
    return rod.inner_diameter if design.rod.fitting is None else fitting_hole(v, design, rod)


def lands(v: Values, design: Design, g: Geometry, rod: RodSection) -> dict[str, Any]:
    """Clearances of the sensor, which the optimiser keeps."""
    if design.sensor is None:
        return {}
    plug = v["rod.thread.diameter"] if design.rod.thread is not None else 0.0
    depth = g.piston_length + g.rod_length - plug
    return {
        "geometry_sensor": {
            "beside the sensor": (bore(v, design, rod) - v["sensor.diameter"]) / 2,
            "before its tip": depth - g.stroke - v["sensor.dead_length"],
        }
    }


def masses(v: Values, design: Design, g: Geometry, rod: RodSection) -> dict[str, Array]:
    """Mass of the sensor; of the piston's hole and the rod's open end with a negative sign."""
    if design.sensor is None:
        return {}
    hole = bore(v, design, rod)
    area = pi / 4 * hole * hole
    metal = v[f"materials.{rod.end_material}.density"]
    plug = v["rod.thread.diameter"] if design.rod.thread is not None else 0.0
    return {
        "sensor": v["sensor.mass"],
        "piston": -v[f"materials.{design.piston.material}.density"] * area * g.piston_length,
        "fastening": -metal * area * plug,
    }
