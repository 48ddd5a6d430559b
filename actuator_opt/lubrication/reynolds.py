"""Reynolds equation of a film along a seal: flux between nodes and its derivatives.

Finite volumes on uniform nodes. The flux of a face is

    m = -M dp/dx + (U/2) mean(r T) (1 - theta of the upwind node),

M = r phi_x h^3/(12 eta), T = h_T + sigma phi_s, r the density over that at zero pressure, theta the
cavitated fraction: the rest of a ruptured film moves with the rod, so mass is conserved where
the film ruptures and where it forms again. Everything is scaled: pressure by `pressure_scale` above
the cavitation pressure, film by `film_scale`, length by the width.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.numeric import STEP, Array, real
from ..models.flow_factors import pressure_flow_factor, shear_flow_factor
from ..models.rough_surface import mean_gap_ratio
from .inputs import Lubricant

Vector = Any
"""NumPy array over the nodes, real or with a complex step."""


@dataclass(frozen=True, slots=True)
class Flow:
    """A scaled Reynolds problem on uniform nodes.

    `conductance` = film_scale^3 pressure_scale/(12 eta_0 L) and `drive` = U film_scale/2, both over
    `flow_scale` [m^2/s]; `rod_share` None means smooth surfaces.
    """

    nodes: int
    width: Array
    lubricant: Lubricant
    pressure_scale: float
    film_scale: float
    flow_scale: float
    cavitation_pressure: float
    conductance: Array
    drive: Array
    rod_share: float | None
    roughness_ratio: Array = 1.0

    @property
    def speed(self) -> Array:
        """Speed of the rod [m/s]."""
        return self.drive * (2 * self.flow_scale / self.film_scale)

    def oil(self, pressure: Vector) -> tuple[Vector, Vector]:
        """Density ratio r, and r over the viscosity ratio, at scaled pressures."""
        absolute = self.cavitation_pressure + self.pressure_scale * pressure
        density = self.lubricant.density_ratio(absolute)
        return density, density / self.lubricant.viscosity_ratio(absolute)

    def gap(self, film: Vector) -> tuple[Vector, Vector]:
        """phi_x h^3 and T of scaled films."""
        if self.rod_share is None:
            return film**3, film
        ratio = film / self.roughness_ratio
        roughness = shear_flow_factor(film_ratio=ratio, rod_share=self.rod_share)
        carried = self.roughness_ratio * (mean_gap_ratio(film_ratio=ratio) + roughness)
        return pressure_flow_factor(film_ratio=ratio) * film**3, carried


@dataclass(frozen=True, slots=True)
class Faces:
    """Flux through the faces, and its derivatives by the states of both neighbouring nodes."""

    flux: Vector
    pressure: tuple[Vector, Vector]
    film: tuple[Vector, Vector]
    cavitation: tuple[Vector, Vector]


def flux(flow: Flow, pressure: Vector, cavitation: Vector, film: Vector) -> Vector:
    """Scaled mass flux through every face."""
    density, fluidity = flow.oil(pressure)
    opening, carried = flow.gap(film)
    mobility = opening * fluidity
    moved = density * carried
    full = 1 - (cavitation[:-1] if real(flow.drive) >= 0 else cavitation[1:])
    mean = flow.conductance * (flow.nodes - 1) / 2 * (mobility[:-1] + mobility[1:])
    return flow.drive / 2 * (moved[:-1] + moved[1:]) * full - mean * np.diff(pressure)


def faces(flow: Flow, pressure: Vector, cavitation: Vector, film: Vector) -> Faces:
    """Flux and its derivatives for a real state; local laws use a complex step."""
    density, fluidity = flow.oil(pressure + 1j * STEP)
    opening, carried = flow.gap(film + 1j * STEP)
    density_slope, fluidity_slope = density.imag / STEP, fluidity.imag / STEP
    opening_slope, carried_slope = opening.imag / STEP, carried.imag / STEP
    density, fluidity, opening, carried = density.real, fluidity.real, opening.real, carried.real
    mobility, moved = opening * fluidity, density * carried
    spacing = flow.conductance * (flow.nodes - 1)
    rise = np.diff(pressure)
    mean = spacing / 2 * (mobility[:-1] + mobility[1:])
    forward = flow.drive >= 0
    full = flow.drive / 2 * (1 - (cavitation[:-1] if forward else cavitation[1:]))
    both = moved[:-1] + moved[1:]
    value = full * both - mean * rise

    def slopes(mobility: Vector, moved: Vector) -> tuple[Vector, Vector]:
        pushed = -(spacing / 2) * rise
        return (
            full * moved[:-1] + pushed * mobility[:-1],
            full * moved[1:] + pushed * mobility[1:],
        )

    over_pressure = slopes(opening * fluidity_slope, density_slope * carried)
    none, lost = np.zeros(flow.nodes - 1), -flow.drive / 2 * both
    return Faces(
        flux=value,
        pressure=(over_pressure[0] + mean, over_pressure[1] - mean),
        film=slopes(opening_slope * fluidity, density * carried_slope),
        cavitation=(lost, none) if forward else (none, lost),
    )


def banded(before: Vector, after: Vector) -> tuple[Vector, Vector, Vector]:
    """Lower, middle and upper band of d(flux out - flux in)/d(node), rows of the inner nodes."""
    return -before[:-1], before[1:] - after[:-1], after[1:]
