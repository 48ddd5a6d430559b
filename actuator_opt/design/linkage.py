"""The driven load: a mass on the rod, or a joint driven through a crank."""

from __future__ import annotations

from typing import Annotated

from ..base.numeric import Array
from ..models import mass
from .kinds import Of
from .section import Section


class Linkage(Section):
    """Two pivots about a joint axis with the actuator between them; angles grow as it extends."""

    base_radius: Annotated[float, Of("pivot_radius", "distance from joint axis to fixed pivot")]
    crank_radius: Annotated[float, Of("pivot_radius", "distance from joint axis to crank pin")]
    angle_offset: Annotated[
        float, Of("joint_angle", "angle between both radii at joint angle 0, signed")
    ] = 0.0


class Load(Section):
    """The load on the rod."""

    mass: Annotated[float, Of("load_mass", "moving mass, reflected to the rod")] = 0.0
    inertia: Annotated[
        float, Of("load_inertia", "inertia about the joint of the linkage; added to mass")
    ] = 0.0


def closed_length(
    *, barrel_length: Array, plate: Array, extension: Array, pin_diameter: Array
) -> Array:
    """Pin-to-pin length of the retracted actuator [m]."""
    eye = mass.eye_length(pin_diameter=pin_diameter)
    return barrel_length + 2 * plate + extension + 2 * eye
