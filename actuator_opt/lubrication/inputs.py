"""Inputs of a lubricated contact: oil, two rough surfaces, an elastic seal, operating conditions.

Every number is a Python float or, inside `sensitivities`, has a complex step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from ..base.numeric import Array
from ..models.oil_laws import VISCOSITY_LAWS
from ..models.rough_surface import asperity_stiffness

FLAT = 0.43
"""F_3/2 at film ratio 0, where the mean planes of both surfaces coincide."""


@dataclass(frozen=True, slots=True)
class Lubricant:
    """Oil: viscosity and density over pressure.

    Parameters
    ----------
    dynamic_viscosity : dynamic viscosity at zero pressure [Pa s]
    pressure_law : viscosity law, a name of `oil_laws.VISCOSITY_LAWS`
    pressure_coefficient : coefficient of the law at zero pressure [1/Pa]
    density_c_a, density_c_b : rho = rho_0 [1 + c_a p/(1 + c_b p)] ([Huang2017] eq. 3) [1/Pa];
        both 0 for an incompressible oil
    """

    dynamic_viscosity: Array
    pressure_law: str = "none"
    pressure_coefficient: float = 0.0
    density_c_a: float = 0.0
    density_c_b: float = 0.0

    def viscosity_ratio(self, pressure: Array) -> Array:
        """Viscosity over its value at zero pressure."""
        law = VISCOSITY_LAWS[self.pressure_law].model
        if law is None:
            return 1.0 + 0.0 * pressure
        viscosity = self.dynamic_viscosity
        value = law(viscosity=viscosity, pressure=pressure, coefficient=self.pressure_coefficient)
        return value / viscosity

    def density_ratio(self, pressure: Array) -> Array:
        """Density over its value at zero pressure."""
        return 1 + self.density_c_a * pressure / (1 + self.density_c_b * pressure)


@dataclass(frozen=True, slots=True)
class Surface:
    """Roughness of the contact.

    Parameters
    ----------
    roughness : composite root-mean-square roughness of seal and rod [m]
    asperity_density : summits per area [1/m^2]
    asperity_radius : radius of the summits [m]
    rod_share : (sigma_rod/sigma)^2 [-]; 0 for a rough seal on a smooth rod
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
    youngs_modulus : [Pa]
    poissons_ratio : [-]
    """

    youngs_modulus: Array
    poissons_ratio: float

    @property
    def compliance(self) -> Array:
        """(1 - nu^2)/(pi E) of the line load [1/Pa]."""
        return (1 - self.poissons_ratio**2) / (math.pi * self.youngs_modulus)


@dataclass(frozen=True, slots=True)
class Contact:
    """A seal at an operating point. Pressures are absolute.

    Parameters
    ----------
    width : contact width [m]; x = 0 at the sealed side
    static_pressure : static contact pressure at uniform nodes from x = 0 to the width [Pa]
    elastic, surface, lubricant : seal, roughness and oil
    speed : rod speed [m/s]; positive outstroke, from the sealed to the outer side
    sealed_pressure, outer_pressure : pressures at the ends [Pa]
    cavitation_pressure : pressure below which the oil film ruptures [Pa]
    sealed_cavitation, outer_cavitation : share of the gap without oil at a starved end, whose
        pressure is the cavitation pressure [-]; floats
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
        """Contact pressure of the asperities over F_3/2 [Pa]."""
        return asperity_stiffness(
            youngs_modulus=self.elastic.youngs_modulus,
            poissons_ratio=self.elastic.poissons_ratio,
            asperity_density=self.surface.asperity_density,
            asperity_radius=self.surface.asperity_radius,
            roughness=self.surface.roughness,
        )


def fault(contact: Contact) -> str:
    """Why a contact is invalid, in one line; empty if it is valid."""
    if contact.lubricant.pressure_law not in VISCOSITY_LAWS:
        return (
            f"pressure law {contact.lubricant.pressure_law!r} of the lubricant: "
            f"use one of {', '.join(VISCOSITY_LAWS)}"
        )
    nodes = np.shape(contact.static_pressure)
    if len(nodes) != 1 or nodes[0] < 5:
        return f"static pressure of shape {nodes}: give five or more values along the width"
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
            f"static pressure {np.min(contact.static_pressure):g} Pa: must be absolute, not "
            "negative"
        )
    flat = np.max(contact.static_pressure) / contact.asperity_stiffness
    if flat > FLAT:
        return (
            f"static pressure {np.max(contact.static_pressure):g} Pa presses the asperities flat: "
            f"they carry {FLAT * contact.asperity_stiffness:g} Pa when the mean planes meet; "
            "use more, sharper or stiffer asperities"
        )
    for name in ("sealed_cavitation", "outer_cavitation"):
        if not 0 <= getattr(contact, name) < 1:
            return f"{name.replace('_', ' ')} {getattr(contact, name):g}: use 0 to below 1"
    if not 0 <= contact.surface.rod_share <= 1:
        return f"rod share {contact.surface.rod_share:g} of the roughness: use 0 to 1"
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
