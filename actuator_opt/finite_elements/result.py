"""Results of a finite-element solution: contact pressures on the sliding face, and stresses."""

from __future__ import annotations

import numpy as np

from ..base.dataclass import dataclass
from . import material
from .material import Floats
from .mesh import Integers
from .section import Assembly


@dataclass(frozen=True, slots=True)
class StressField:
    """Deformed bodies with von Mises stress, for a figure.

    Parameters
    ----------
    nodes : positions of the element corners, n x 2: axial, and outward from the sliding face [m]
    triangles : three corners of every element
    von_mises : mean von Mises stress of every element [Pa]
    body : index of the body that every element belongs to; 0 is the rubber ring
    """

    nodes: Floats
    triangles: Integers
    von_mises: Floats
    body: Integers


@dataclass(frozen=True, slots=True)
class MountedContact:
    """A seal in its groove at one sealed pressure; pressures are relative to the outer side.

    Parameters
    ----------
    pressure : sealed pressure above that of the outer side [Pa]
    positions : distances from the sealed end of the contact, from 0 to `width` [m]
    contact_pressure : contact pressure at these positions [Pa]; the first value is the sealed
        pressure, the last is 0
    width : axial width of the contact [m]
    line_load : force on the sliding face per length of its circumference [N/m]
    peak_pressure : highest contact pressure [Pa]
    opposite_load : contact force on the groove bottom per length of circumference [N/m]
    side_load : contact force on the outer side wall of the groove, likewise [N/m]; for a step ring
        without pressure, which does not rest on this wall yet, the force that holds it axially
    start : position of the sealed end of the contact, measured from the outer groove wall; negative
        [m]
    field : deformed mesh with stress
    """

    pressure: float
    positions: Floats
    contact_pressure: Floats
    width: float
    line_load: float
    peak_pressure: float
    opposite_load: float
    side_load: float
    start: float
    field: StressField


@dataclass(frozen=True, slots=True)
class SealSolution:
    """Results for a seal that is mounted and then pressurised.

    Parameters
    ----------
    contacts : contact of the seal without pressure, then one for every pressure that was reached
    failure : reason why a pressure was not reached; None if all were reached
    steps, iterations : number of load steps, and total number of Newton iterations
    residual : largest unbalanced force, divided by the rubber's modulus and section
    """

    contacts: tuple[MountedContact, ...]
    failure: str | None
    steps: int
    iterations: int
    residual: float


def stress_field(section: Assembly, values: Floats, length: float, modulus: float) -> StressField:
    """Deformed mesh and stress in SI, from a solution scaled by `length` and `modulus`."""
    gradient, multiplier = section.gradient(values)
    stress = material.von_mises(gradient, multiplier, section.c10, section.c01)
    mean = np.sum(stress * section.weights, axis=1) / np.sum(section.weights, axis=1)
    corners, triangles = np.unique(section.triangles[:, :3], return_inverse=True)
    owner = np.searchsorted(section.first_node, section.triangles[:, 0], side="right") - 1
    return StressField(
        section.places(values)[corners] * length,
        triangles.reshape(-1, 3).astype(np.int64),
        mean * modulus,
        owner.astype(np.int64),
    )


def contact_end(held: float, gaps: Floats, places: Floats) -> float:
    """Position where a contact ends, between its last closed and its first open node.

    Next to a smooth contact, the gap grows as distance^(3/2). The gaps at the first two open nodes
    therefore determine where the contact ends.

    Parameters
    ----------
    held : position of the last node in contact [m]
    gaps, places : gaps and positions of the first two open nodes [m]
    """
    ratio = (max(gaps[0], 0.0) / gaps[1]) ** (2 / 3) if gaps[1] > gaps[0] else 0.0
    end = (places[0] - ratio * places[1]) / (1 - ratio)
    low, high = sorted((held, float(places[0])))
    return float(min(max(end, low), high))
