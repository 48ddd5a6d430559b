"""What the actuator moves: a mass at the rod, or a joint through a crank."""

from __future__ import annotations

from typing import Annotated

from ..base.numeric import Array
from ..models import mass
from .kinds import Of
from .section import Section


class Linkage(Section):
    """Two pivots about a joint axis, the actuator between them; angles grow as it extends."""

    base_radius: Annotated[float, Of("pivot_radius", "joint axis to the fixed pivot")]
    crank_radius: Annotated[float, Of("pivot_radius", "joint axis to the crank pin")]
    angle_offset: Annotated[
        float, Of("joint_angle", "angle between both radii at joint angle 0, signed")
    ] = 0.0


class Load(Section):
    """What the rod moves."""

    mass: Annotated[float, Of("load_mass", "moved mass, reflected to the rod")] = 0.0
    inertia: Annotated[
        float, Of("load_inertia", "what turns about the joint of the linkage; added to mass")
    ] = 0.0


def closed_length(
    *, barrel_length: Array, plate: Array, extension: Array, pin_diameter: Array
) -> Array:
    """Length of a retracted actuator from pin to pin [m]."""
    eye = mass.eye_length(pin_diameter=pin_diameter)
    return barrel_length + 2 * plate + extension + 2 * eye
