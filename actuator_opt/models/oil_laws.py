"""Pressure dependence of an oil: laws of bulk modulus and viscosity that a design may name.

A new law is an entry here: its name, the properties it needs, its formula, its range.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Any

from ..base.kinds import kinds
from ..base.numeric import Array
from . import density, fluid, tait

Properties = Callable[[str], Any]
"""A property of the oil by its name in the library [SI]; None where it states none."""


@dataclass(frozen=True, slots=True)
class BulkModulusLaw:
    """Tangent bulk modulus of a liquid without air, and its density, over pressure.

    Attributes
    ----------
    name, help : its word in a design, and what it means
    needs : properties of the oil beyond bulk modulus and density
    modulus : tangent bulk modulus [Pa] by (properties, temperature [K], gauge pressure [Pa])
    density : density [kg/m^3] by (properties, that at zero pressure, temperature, pressure)
    largest_pressure : gauge pressure up to which it is known [Pa]
    model : the model function behind it; None where it has no formula of its own
    """

    name: str
    help: str
    needs: tuple[str, ...]
    modulus: Callable[[Properties, Array, Array], Array]
    density: Callable[[Properties, Array, Array, Array], Array]
    largest_pressure: float
    model: Callable[..., Array] | None


@dataclass(frozen=True, slots=True)
class ViscosityLaw:
    """Viscosity over pressure.

    Attributes
    ----------
    name, help : its word in a design, and what it means
    needs : properties of the oil, the first of them its coefficient [1/Pa]
    model : dynamic viscosity by (viscosity, pressure, coefficient); None: independent of pressure
    largest_pressure : gauge pressure up to which it holds [Pa]
    words : for a report
    """

    name: str
    help: str
    needs: tuple[str, ...]
    model: Callable[..., Array] | None
    largest_pressure: float
    words: str

    def viscosity(self, *, viscosity: Array, pressure: Array, coefficient: Array) -> Array:
        """Dynamic viscosity at a gauge pressure [Pa s], from that at zero gauge pressure."""
        if self.model is None:
            return viscosity + 0 * pressure
        return self.model(viscosity=viscosity, pressure=pressure, coefficient=coefficient)


def _warm(oil: Properties, temperature: Array, pressure: Array) -> Array:
    """Bulk modulus at its own pressure and a temperature."""
    modulus, decay = oil("bulk_modulus"), oil("bulk_modulus_decay")
    if decay is None:
        return modulus
    return fluid.bulk_modulus_warm(
        bulk_modulus=modulus,
        decay=decay,
        temperature=temperature,
        reference_temperature=oil("bulk_modulus_temperature"),
    )


def _linear(oil: Properties, temperature: Array, pressure: Array) -> Array:
    reference = oil("bulk_modulus_pressure")
    return fluid.bulk_modulus_linear(
        bulk_modulus=_warm(oil, temperature, pressure),
        slope=oil("bulk_modulus_slope"),
        pressure=pressure - (0.0 if reference is None else reference),
    )


def _tait_constants(oil: Properties) -> dict[str, Array]:
    return {
        "zero_modulus": oil("tait_modulus"),
        "temperature_coefficient": oil("tait_decay"),
        "pressure_coefficient": oil("tait_coefficient"),
    }


def _tait(oil: Properties, temperature: Array, pressure: Array) -> Array:
    return tait.bulk_modulus_tait(
        temperature=temperature, pressure=pressure, **_tait_constants(oil)
    )


def _compressed(
    modulus: Callable[[Properties, Array, Array], Array], *, sloped: bool
) -> Callable[[Properties, Array, Array, Array], Array]:
    """Density of a law whose bulk modulus rises by a slope, or not at all."""

    def density_at(oil: Properties, rho: Array, temperature: Array, pressure: Array) -> Array:
        return density.density_compressed(
            reference_density=rho,
            pressure=pressure,
            bulk_modulus=modulus(oil, temperature, 0.0 * pressure),
            slope=oil("bulk_modulus_slope") if sloped else 0.0,
        )

    return density_at


def _tait_density(oil: Properties, rho: Array, temperature: Array, pressure: Array) -> Array:
    return tait.density_tait(
        temperature=temperature,
        pressure=pressure,
        reference_density=rho,
        volume_expansion=0.0,
        **_tait_constants(oil),
    )


BULK_MODULUS_LAWS = kinds(
    "law of the bulk modulus",
    BulkModulusLaw(
        "constant",
        "not at all",
        needs=(),
        modulus=_warm,
        density=_compressed(_warm, sloped=False),
        largest_pressure=inf,
        model=None,
    ),
    BulkModulusLaw(
        "linear",
        "by the oil's slope",
        needs=("bulk_modulus_slope",),
        modulus=_linear,
        density=_compressed(_linear, sloped=True),
        largest_pressure=fluid.LINEAR_PRESSURE,
        model=fluid.bulk_modulus_linear,
    ),
    BulkModulusLaw(
        "tait",
        "by the Tait equation with its three constants",
        needs=("tait_modulus", "tait_decay", "tait_coefficient"),
        modulus=_tait,
        density=_tait_density,
        largest_pressure=tait.TAIT_PRESSURE,
        model=tait.bulk_modulus_tait,
    ),
)
"""Laws of the bulk modulus by their word."""

VISCOSITY_LAWS = kinds(
    "law of the viscosity",
    ViscosityLaw(
        "none",
        "not at all",
        needs=(),
        model=None,
        largest_pressure=inf,
        words="independent of pressure",
    ),
    ViscosityLaw(
        "barus",
        "exponentially",
        needs=("pressure_viscosity",),
        model=fluid.barus,
        largest_pressure=fluid.BARUS_PRESSURE,
        words="under pressure by Barus",
    ),
    ViscosityLaw(
        "roelands",
        "less than exponentially at high pressure",
        needs=("pressure_viscosity",),
        model=fluid.roelands,
        largest_pressure=fluid.ROELANDS_PRESSURE,
        words="under pressure by Roelands",
    ),
)
"""Laws of the viscosity by their word."""
