"""The oil of an evaluation: bulk modulus, viscosity, density and vapour limit, by the laws chosen.

Pressures are gauge. What a law needs is in the library (`design.material_laws`); without a stated
law the library entry decides. Everything belongs to the pure liquid, but for `bulk_modulus`, which
counts the entrained air.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TypeAlias

from ..design.material import Material
from ..design.material_laws import bulk_modulus_law, viscosity_law
from ..design.model import FluidSection
from ..models import density as density_models
from ..models import fluid, tait
from ..numeric import Array
from .allow import Stock
from .values import Values

Law: TypeAlias = Callable[..., Array]
_BULK_MODULUS: Mapping[str, Law] = {
    "linear": fluid.bulk_modulus_linear,
    "tait": tait.bulk_modulus_tait,
}
_VISCOSITY: Mapping[str, Law] = {"barus": fluid.barus, "roelands": fluid.roelands}


def alone(material: Material, **choices: object) -> tuple[Values, FluidSection, Stock]:
    """What the functions below take, for an oil of the library outside a design.

    Parameters
    ----------
    material : the oil
    choices : other keys of the section `fluid`, SI
    """
    section = FluidSection.model_validate({"material": material.name, **choices})
    numbers = {f"materials.{material.name}.{key}": x for key, x in material.numbers.items()}
    numbers |= {
        "fluid.air_content": section.air_content,
        "fluid.polytropic_index": section.polytropic_index,
    }
    v = Values(numbers, ())
    return v, section, Stock(v, {material.name: material}, {}, {})


def pure_bulk_modulus(
    v: Values, section: FluidSection, stock: Stock, temperature: Array, pressure: Array
) -> Array:
    """Tangent bulk modulus of the oil without air."""
    name = section.material
    law = bulk_modulus_law(section.bulk_modulus_law, stock.material(name).numbers)
    if law == "tait":
        return tait.bulk_modulus_tait(
            temperature=temperature, pressure=pressure, **_tait(stock, name)
        )
    modulus = stock.get(name, "bulk_modulus")
    decay = stock.get(name, "bulk_modulus_decay")
    if decay is not None:
        modulus = fluid.bulk_modulus_warm(
            bulk_modulus=modulus,
            decay=decay,
            temperature=temperature,
            reference_temperature=stock.get(name, "bulk_modulus_temperature"),
        )
    if law == "constant":
        return modulus
    return fluid.bulk_modulus_linear(
        bulk_modulus=modulus,
        slope=stock.get(name, "bulk_modulus_slope"),
        pressure=pressure - stock.get(name, "bulk_modulus_pressure", default=0.0),
    )


def _tait(stock: Stock, name: str) -> dict[str, Array]:
    """Constants of the Tait law of an oil."""
    return {
        "zero_modulus": stock.get(name, "tait_modulus"),
        "temperature_coefficient": stock.get(name, "tait_decay"),
        "pressure_coefficient": stock.get(name, "tait_coefficient"),
    }


def bulk_modulus(
    v: Values, section: FluidSection, stock: Stock, temperature: Array, pressure: Array
) -> Array:
    """Tangent bulk modulus of the oil with its entrained air."""
    return fluid.effective_bulk_modulus(
        bulk_modulus=pure_bulk_modulus(v, section, stock, temperature, pressure),
        pressure=pressure,
        air_content=v["fluid.air_content"],
        polytropic_index=v["fluid.polytropic_index"],
    )


def density(
    v: Values,
    section: FluidSection,
    stock: Stock,
    temperature: Array,
    pressure: Array | None = None,
) -> Array:
    """Density at a temperature and a pressure (None: zero), by the law of the bulk modulus."""
    name = section.material
    rho = stock.get(name, "density")
    expansion = stock.get(name, "volume_expansion")
    known = stock.material(name).numbers
    if expansion is not None and "density_temperature" in known:
        rho = density_models.density_thermal(
            reference_density=rho,
            volume_expansion=expansion,
            temperature=temperature,
            reference_temperature=stock.get(name, "density_temperature"),
        )
    if pressure is None:
        return rho
    law = bulk_modulus_law(section.bulk_modulus_law, known)
    if law == "tait":
        return tait.density_tait(
            temperature=temperature,
            pressure=pressure,
            reference_density=rho,
            volume_expansion=0.0,
            **_tait(stock, name),
        )
    return density_models.density_compressed(
        reference_density=rho,
        pressure=pressure,
        bulk_modulus=pure_bulk_modulus(v, section, stock, temperature, 0.0 * pressure),
        slope=stock.get(name, "bulk_modulus_slope") if law == "linear" else 0.0,
    )


def kinematic_viscosity(
    v: Values, section: FluidSection, stock: Stock, temperature: Array
) -> Array:
    """Kinematic viscosity at zero gauge pressure, from the oil's table scaled with its value."""
    oil = stock.material(section.material)
    points = oil.viscosity_points
    stated = oil.numbers["kinematic_viscosity"]
    scale = v[f"materials.{oil.name}.kinematic_viscosity"] / stated
    if len(points) < 2:
        return scale * stated + 0 * temperature
    return scale * fluid.viscosity_astm_d341(
        temperature=temperature,
        points_temperature=tuple(t for t, _ in points),
        points_viscosity=tuple(value for _, value in points),
    )


def dynamic_viscosity(
    v: Values, section: FluidSection, stock: Stock, temperature: Array, pressure: Array
) -> Array:
    """Dynamic viscosity at a temperature and a pressure."""
    viscosity = fluid.dynamic_viscosity(
        kinematic_viscosity=kinematic_viscosity(v, section, stock, temperature),
        density=density(v, section, stock, temperature),
    )
    return under_pressure(section, stock, viscosity, temperature, pressure)


def pressure_law(section: FluidSection, stock: Stock, temperature: Array) -> tuple[str, Array]:
    """Name of the law of viscosity over pressure, and its coefficient at a temperature."""
    name = section.material
    oil = stock.material(name)
    law = viscosity_law(section.viscosity_pressure, oil.numbers)
    if law == "none":
        return law, 0.0
    coefficient = oil.properties["pressure_viscosity"].at(
        temperature, value=stock.get(name, "pressure_viscosity")
    )
    return law, coefficient


def under_pressure(
    section: FluidSection, stock: Stock, viscosity: Array, temperature: Array, pressure: Array
) -> Array:
    """Dynamic viscosity at a pressure, from the one at zero gauge pressure."""
    law, coefficient = pressure_law(section, stock, temperature)
    if law == "none":
        return viscosity + 0 * pressure
    return _VISCOSITY[law](viscosity=viscosity, pressure=pressure, coefficient=coefficient)


def vapour_pressure(stock: Stock, name: str, temperature: Array) -> Array | None:
    """Vapour pressure (absolute) at a temperature; None where the library states none."""
    stated = stock.get(name, "vapour_pressure")
    if stated is None:
        return None
    entry = stock.material(name).properties["vapour_pressure"]
    if not entry.points:
        return stated + 0 * temperature
    return (stated / entry.value) * fluid.vapour_pressure(
        temperature=temperature,
        points_temperature=entry.arguments,
        points_pressure=entry.values,
    )


def laws(section: FluidSection, oil: Material) -> Iterable[tuple[Law, str]]:
    """(function, quantity) of every law of the oil over pressure that an evaluation uses."""
    law = bulk_modulus_law(section.bulk_modulus_law, oil.numbers)
    if law in _BULK_MODULUS:
        yield _BULK_MODULUS[law], "bulk modulus"
    yield fluid.effective_bulk_modulus, "air"
    law = viscosity_law(section.viscosity_pressure, oil.numbers)
    if law in _VISCOSITY:
        yield _VISCOSITY[law], "viscosity"
