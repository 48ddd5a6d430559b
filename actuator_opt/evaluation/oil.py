"""Oil properties of an evaluation: bulk modulus, viscosity, density and vapour pressure.

Pressures are gauge. The library has the data of each law (`design.material_laws`); without a stated
law the library entry decides. All properties are those of the pure liquid, except `bulk_modulus`,
which includes entrained air.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

from ..base.numeric import Array
from ..design.material import Material, bulk_modulus_law, viscosity_law
from ..design.model import FluidSection
from ..models import fluid, oil_laws as density_models
from ..models.oil_laws import BULK_MODULUS_LAWS, VISCOSITY_LAWS
from .limits import MaterialValues
from .values import Values

Law: TypeAlias = Callable[..., Array]


def alone(material: Material, **choices: object) -> tuple[Values, FluidSection, MaterialValues]:
    """Inputs of the functions below for a library oil without a design.

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
    return v, section, MaterialValues(v, {material.name: material}, {}, {})


def pure_bulk_modulus(
    v: Values, section: FluidSection, stock: MaterialValues, temperature: Array, pressure: Array
) -> Array:
    """Tangent bulk modulus of the oil without air."""
    oil = stock.material(section.material)
    law = BULK_MODULUS_LAWS[bulk_modulus_law(section.bulk_modulus_law, oil.numbers)]
    return law.modulus(_properties(stock, oil.name), temperature, pressure)


def _properties(stock: MaterialValues, name: str) -> Callable[[str], Array]:
    """Properties of an oil by their name."""
    return lambda key: stock.get(name, key)


def bulk_modulus(
    v: Values, section: FluidSection, stock: MaterialValues, temperature: Array, pressure: Array
) -> Array:
    """Tangent bulk modulus of the oil with entrained air."""
    return fluid.effective_bulk_modulus(
        bulk_modulus=pure_bulk_modulus(v, section, stock, temperature, pressure),
        pressure=pressure,
        air_content=v["fluid.air_content"],
        polytropic_index=v["fluid.polytropic_index"],
    )


def density(
    v: Values,
    section: FluidSection,
    stock: MaterialValues,
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
    law = BULK_MODULUS_LAWS[bulk_modulus_law(section.bulk_modulus_law, known)]
    return law.density(_properties(stock, name), rho, temperature, pressure)


def kinematic_viscosity(
    v: Values, section: FluidSection, stock: MaterialValues, temperature: Array
) -> Array:
    """Kinematic viscosity at zero gauge pressure, from the oil's table, scaled by its value."""
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
    v: Values, section: FluidSection, stock: MaterialValues, temperature: Array, pressure: Array
) -> Array:
    """Dynamic viscosity at a temperature and a pressure."""
    viscosity = fluid.dynamic_viscosity(
        kinematic_viscosity=kinematic_viscosity(v, section, stock, temperature),
        density=density(v, section, stock, temperature),
    )
    return under_pressure(section, stock, viscosity, temperature, pressure)


def pressure_law(
    section: FluidSection, stock: MaterialValues, temperature: Array
) -> tuple[str, Array]:
    """Name of the viscosity law over pressure, and its coefficient at a temperature."""
    name = section.material
    oil = stock.material(name)
    law = VISCOSITY_LAWS[viscosity_law(section.viscosity_pressure, oil.numbers)]
    if not law.needs:
        return law.name, 0.0
    key = law.needs[0]
    return law.name, oil.properties[key].at(temperature, value=stock.get(name, key))


def under_pressure(
    section: FluidSection,
    stock: MaterialValues,
    viscosity: Array,
    temperature: Array,
    pressure: Array,
) -> Array:
    """Dynamic viscosity at a pressure, from the value at zero gauge pressure."""
    law, coefficient = pressure_law(section, stock, temperature)
    return VISCOSITY_LAWS[law].viscosity(
        viscosity=viscosity, pressure=pressure, coefficient=coefficient
    )


def vapour_pressure(stock: MaterialValues, name: str, temperature: Array) -> Array | None:
    """Vapour pressure (absolute) at a temperature; None if the library has none."""
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
    """(function, quantity) of all laws of the oil over pressure in an evaluation."""
    modulus = BULK_MODULUS_LAWS[bulk_modulus_law(section.bulk_modulus_law, oil.numbers)]
    if modulus.model is not None:
        yield modulus.model, "bulk modulus"
    yield fluid.effective_bulk_modulus, "air"
    viscosity = VISCOSITY_LAWS[viscosity_law(section.viscosity_pressure, oil.numbers)]
    if viscosity.model is not None:
        yield viscosity.model, "viscosity"
