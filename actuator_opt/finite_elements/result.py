"""What a finite-element solution hands on: contact pressures over the sliding face, and stress."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import material
from .material import Floats
from .mesh import Integers
from .section import Section


@dataclass(frozen=True, slots=True)
class StressField:
    """Deformed bodies with their von Mises stress, for a figure.

    Parameters
    ----------
    nodes : places of the corners, n x 2: along the cylinder, away from the sliding face [m]
    triangles : three corners of every element
    von_mises : mean of every element [Pa]
    body : number of the body of every element, 0 the rubber ring
    """

    nodes: Floats
    triangles: Integers
    von_mises: Floats
    body: Integers


@dataclass(frozen=True, slots=True)
class Contact:
    """A seal in its groove at one sealed pressure; all pressures count from the outer side's.

    Parameters
    ----------
    pressure : sealed pressure above that of the outer side [Pa]
    positions : from the end of the contact on the sealed side, rising, first 0, last `width` [m]
    contact_pressure : there [Pa]; first the sealed pressure, last 0
    width : length of the contact along the cylinder [m]
    line_load : force on the sliding face per length of its circumference [N/m]
    peak_pressure : highest contact pressure [Pa]
    opposite_load : force on the groove's bottom per length of circumference, in contact alone [N/m]
    side_load : force on the outer side wall of the groove likewise [N/m]; of a mounted step ring
        what holds it along the cylinder
    start : place of the sealed end of the contact, from the groove's outer wall, negative [m]
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
    """A seal mounted and then pressurised.

    Parameters
    ----------
    contacts : one per pressure that was reached, the mounted seal first
    failure : why a wanted pressure was not reached, in words; None when all were
    steps, iterations : load steps, and Newton iterations of all of them
    residual : largest force left unbalanced, of modulus times section
    """

    contacts: tuple[Contact, ...]
    failure: str | None
    steps: int
    iterations: int
    residual: float


def stress_field(section: Section, values: Floats, length: float, modulus: float) -> StressField:
    """Deformed mesh and stress of a solution in units of a length and a modulus."""
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
    """End of a contact between its last held node and the first open one.

    Beside a smooth contact the gap grows as distance^(3/2); its first two nodes give the end.

    Parameters
    ----------
    held : place of the last node in contact [m]
    gaps, places : of the first two open nodes [m]
    """
    ratio = (max(gaps[0], 0.0) / gaps[1]) ** (2 / 3) if gaps[1] > gaps[0] else 0.0
    end = (places[0] - ratio * places[1]) / (1 - ratio)
    low, high = sorted((held, float(places[0])))
    return float(min(max(end, low), high))
