"""Reynolds equation of a film along a seal: flux between nodes, and its derivatives.

The method is finite volumes on uniform nodes. The mass flux through a face between two nodes is

    m = -M dp/dx + (U/2) mean(r T) (1 - theta of the upwind node),

with M = r phi_x h^3/(12 eta) and T = h_T + sigma phi_s. Here U is the speed, h the film thickness,
h_T the mean gap height, sigma the roughness, eta the viscosity, r the density divided by that at
zero pressure, phi_x and phi_s the flow factors, and theta the cavitated fraction. The oil in a
ruptured film moves with the rod, so mass is conserved where the film ruptures and where it forms
again. Everything is scaled: pressure above the cavitation pressure by `pressure_scale`, film by
`film_scale`, length by the width.

The inputs of a lubricated contact are oil, two rough surfaces, an elastic seal and operating
conditions. Every number of them is a Python float; only `film.sensitivities` adds complex steps.
"""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import STEP, Array, real
from ..models.oil_laws import VISCOSITY_LAWS
from ..models.rough_surface import (
    asperity_stiffness,
    mean_gap_ratio,
    pressure_flow_factor,
    shear_flow_factor,
)

FLAT = 0.43
"""Asperity integral F_3/2 at film ratio 0, where the mean planes of both surfaces coincide."""


@dataclass(frozen=True, slots=True)
class Lubricant:
    """Viscosity and density of the oil as functions of pressure.

    Parameters
    ----------
    dynamic_viscosity : dynamic viscosity at zero pressure [Pa s]
    pressure_law : viscosity law, a name of `oil_laws.VISCOSITY_LAWS`
    pressure_coefficient : pressure coefficient of the law at zero pressure [1/Pa]
    density_c_a, density_c_b : c_a and c_b in rho = rho_0 [1 + c_a p/(1 + c_b p)] ([Huang2017] eq.
        3) [1/Pa]; both 0 for an incompressible oil
    """

    dynamic_viscosity: Array
    pressure_law: str = "none"
    pressure_coefficient: float = 0.0
    density_c_a: float = 0.0
    density_c_b: float = 0.0

    def viscosity_ratio(self, pressure: Array) -> Array:
        """Ratio of the viscosity to its value at zero pressure."""
        law = VISCOSITY_LAWS[self.pressure_law].model
        if law is None:
            return 1.0 + 0.0 * pressure
        viscosity = self.dynamic_viscosity
        value = law(viscosity=viscosity, pressure=pressure, coefficient=self.pressure_coefficient)
        return value / viscosity

    def density_ratio(self, pressure: Array) -> Array:
        """Ratio of the density to its value at zero pressure."""
        return 1 + self.density_c_a * pressure / (1 + self.density_c_b * pressure)


@dataclass(frozen=True, slots=True)
class Surface:
    """Roughness of both surfaces in the contact.

    Parameters
    ----------
    roughness : composite root-mean-square roughness sigma of seal and rod [m]
    asperity_density : summits per area [1/m^2]
    asperity_radius : radius of the summits [m]
    rod_share : (sigma_rod/sigma)^2, with the roughness sigma_rod of the rod alone [-]; 0 for a
        rough seal on a smooth rod
    """

    roughness: Array
    asperity_density: float
    asperity_radius: float
    rod_share: float = 0.0


@dataclass(frozen=True, slots=True)
class Elastic:
    """The elastic seal; the rod is assumed rigid.

    Parameters
    ----------
    youngs_modulus : Young's modulus [Pa]
    poissons_ratio : Poisson's ratio [-]
    """

    youngs_modulus: Array
    poissons_ratio: float

    @property
    def compliance(self) -> Array:
        """Compliance (1 - nu^2)/(pi E) of the seal's surface under a line load [1/Pa]."""
        return (1 - self.poissons_ratio**2) / (math.pi * self.youngs_modulus)


@dataclass(frozen=True, slots=True)
class Contact:
    """A seal at an operating point. Pressures are absolute.

    Parameters
    ----------
    width : contact width [m]; the coordinate x is 0 at the sealed side
    static_pressure : static contact pressure at uniform nodes from x = 0 to the width [Pa]
    elastic, surface, lubricant : seal, roughness and oil
    speed : rod speed [m/s], positive in the outstroke, from the sealed to the outer side
    sealed_pressure, outer_pressure : pressures at the ends [Pa]
    cavitation_pressure : pressure below which the oil film ruptures [Pa]
    sealed_cavitation, outer_cavitation : share of the gap at each end that contains no oil [-]; 0
        for a flooded end. The pressure at a starved end must be the cavitation pressure
    """

    width: Array
    static_pressure: Array
    elastic: Elastic
    surface: Surface
    lubricant: Lubricant
    speed: Array
    sealed_pressure: Array
    outer_pressure: Array
    cavitation_pressure: float = 0.0
    sealed_cavitation: float = 0.0
    outer_cavitation: float = 0.0

    @property
    def asperity_stiffness(self) -> Array:
        """Contact pressure of the asperities divided by the integral F_3/2 [Pa]."""
        return asperity_stiffness(
            youngs_modulus=self.elastic.youngs_modulus,
            poissons_ratio=self.elastic.poissons_ratio,
            asperity_density=self.surface.asperity_density,
            asperity_radius=self.surface.asperity_radius,
            roughness=self.surface.roughness,
        )


def fault(contact: Contact) -> str:
    """Reason why a contact is invalid, in one line; empty if it is valid."""
    if contact.lubricant.pressure_law not in VISCOSITY_LAWS:
        return (
            f"pressure law {contact.lubricant.pressure_law!r} of the lubricant: "
            f"use one of {', '.join(VISCOSITY_LAWS)}"
        )
    nodes = np.shape(contact.static_pressure)
    if len(nodes) != 1 or nodes[0] < 5:
        return f"static pressure has the shape {nodes}: give five or more values along the width"
    groups = (contact, contact.elastic, contact.surface, contact.lubricant)
    for group in groups:
        for field in fields(group):
            value = getattr(group, field.name)
            if isinstance(value, (str, Elastic, Surface, Lubricant)):
                continue
            if not np.all(np.isfinite(value)):
                return f"{field.name.replace('_', ' ')} is not a finite number"
    return _range_fault(contact)


def _range_fault(contact: Contact) -> str:
    above_zero = {
        "width": contact.width,
        "Young's modulus": contact.elastic.youngs_modulus,
        "viscosity": contact.lubricant.dynamic_viscosity,
        "roughness": contact.surface.roughness,
        "asperity density": contact.surface.asperity_density,
        "asperity radius": contact.surface.asperity_radius,
    }
    for name, value in above_zero.items():
        if not value > 0:
            return f"{name} {value:g}: must be above zero"
    if np.min(contact.static_pressure) < -1e-9 * np.max(contact.static_pressure):
        return (
            f"static pressure {np.min(contact.static_pressure):g} Pa: it must be absolute, so it "
            "cannot be negative"
        )
    flat = np.max(contact.static_pressure) / contact.asperity_stiffness
    if flat > FLAT:
        return (
            f"static pressure {np.max(contact.static_pressure):g} Pa presses the asperities flat: "
            f"they carry only {FLAT * contact.asperity_stiffness:g} Pa when the mean planes of "
            "both surfaces meet; use more, sharper or stiffer asperities"
        )
    for name in ("sealed_cavitation", "outer_cavitation"):
        if not 0 <= getattr(contact, name) < 1:
            return f"{name.replace('_', ' ')} {getattr(contact, name):g}: use 0 to below 1"
    if not 0 <= contact.surface.rod_share <= 1:
        return f"rod share {contact.surface.rod_share:g} (of squared roughness): use 0 to 1"
    if not -1 < contact.elastic.poissons_ratio <= 0.5:
        return f"Poisson's ratio {contact.elastic.poissons_ratio:g}: use -1 to 0.5"
    for side, pressure in (
        ("sealed", contact.sealed_pressure),
        ("outer", contact.outer_pressure),
    ):
        if pressure < contact.cavitation_pressure:
            return (
                f"{side} pressure {pressure:g} Pa absolute is below the cavitation pressure "
                f"{contact.cavitation_pressure:g} Pa"
            )
    return ""


Vector = Any
"""NumPy array over the nodes, real or with a complex step."""


@dataclass(frozen=True, slots=True)
class ReynoldsProblem:
    """A scaled Reynolds problem on uniform nodes.

    `conductance` is film_scale^3 pressure_scale/(12 eta_0 L) and `drive` is U film_scale/2, both
    divided by `flow_scale` [m^2/s]. Here eta_0 is the viscosity at zero pressure, L the width and U
    the speed. `rod_share` is None for smooth surfaces.
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
        """Density ratio r at scaled pressures, and r divided by the viscosity ratio."""
        absolute = self.cavitation_pressure + self.pressure_scale * pressure
        density = self.lubricant.density_ratio(absolute)
        return density, density / self.lubricant.viscosity_ratio(absolute)

    def gap(self, film: Vector) -> tuple[Vector, Vector]:
        """Terms phi_x h^3 and T of the flux (see the module), for scaled film thicknesses."""
        if self.rod_share is None:
            return film**3, film
        ratio = film / self.roughness_ratio
        roughness = shear_flow_factor(film_ratio=ratio, rod_share=self.rod_share)
        carried = self.roughness_ratio * (mean_gap_ratio(film_ratio=ratio) + roughness)
        return pressure_flow_factor(film_ratio=ratio) * film**3, carried


@dataclass(frozen=True, slots=True)
class FaceFlux:
    """Flux through each face between two nodes, and its derivatives.

    `pressure`, `film` and `cavitation` are pairs: the derivative of the flux with respect to that
    quantity at the node before the face, and at the node after it.
    """

    flux: Vector
    pressure: tuple[Vector, Vector]
    film: tuple[Vector, Vector]
    cavitation: tuple[Vector, Vector]


def flux(flow: ReynoldsProblem, pressure: Vector, cavitation: Vector, film: Vector) -> Vector:
    """Scaled mass flux through every face."""
    density, fluidity = flow.oil(pressure)
    opening, carried = flow.gap(film)
    mobility = opening * fluidity
    moved = density * carried
    full = 1 - (cavitation[:-1] if real(flow.drive) >= 0 else cavitation[1:])
    mean = flow.conductance * (flow.nodes - 1) / 2 * (mobility[:-1] + mobility[1:])
    return flow.drive / 2 * (moved[:-1] + moved[1:]) * full - mean * np.diff(pressure)


def faces(flow: ReynoldsProblem, pressure: Vector, cavitation: Vector, film: Vector) -> FaceFlux:
    """Flux through every face and its derivatives, for a state of real numbers.

    The laws of oil and gap are differentiated by complex steps, everything else by formulas.
    """
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
    zero, loss = np.zeros(flow.nodes - 1), -flow.drive / 2 * both
    return FaceFlux(
        flux=value,
        pressure=(over_pressure[0] + mean, over_pressure[1] - mean),
        film=slopes(opening_slope * fluidity, density * carried_slope),
        cavitation=(loss, zero) if forward else (zero, loss),
    )


def banded(before: Vector, after: Vector) -> tuple[Vector, Vector, Vector]:
    """Bands of a tridiagonal matrix: derivatives of flux out minus flux in at the inner nodes.

    The bands (lower, middle, upper) are the derivatives with respect to the state of the node
    before, of the node itself and of the node after it.
    """
    return -before[:-1], before[1:] - after[:-1], after[1:]
