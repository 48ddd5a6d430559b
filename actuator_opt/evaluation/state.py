"""The state of every load case: pressures, force, speed, temperature and the oil at them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..design.kinds import Fraction
from ..design.material import Material
from ..design.model import Design
from ..models import density as oil_density
from ..models import fluid, stiffness
from ..numeric import Array, where
from .allow import Stock
from .geometry import Geometry
from .values import Values, stacked


@dataclass(frozen=True, slots=True)
class State:
    """Load-case quantities, (cases, 1) or (cases, designs); pressures are gauge.

    Moving: the driven chamber at the case pressure (default: supply), the other at return.
    Holding: ports closed by a critical-centre servo valve against the case's force [Merritt1967].
    """

    push: np.ndarray
    reach: Array
    """Piston position for column and side load: the case's own, or the full stroke (worst)."""
    force: Array
    speed: Array
    side_load: Array
    temperature: Array
    driven_pressure: Array
    moving_a: Array
    moving_b: Array
    holding_a: Array
    holding_b: Array
    kinematic_viscosity: Array
    density: Array
    dynamic_viscosity: Array
    bulk_modulus_a: Array
    bulk_modulus_b: Array


def case_force(v: Values, design: Design) -> Array:
    """Force of every case (cases, designs): stated, or joint torque over its lever arm."""
    rows = []
    for case in design.load_cases:
        at = f"load_cases[{case.name}]"
        if case.force is not None:
            rows.append(v[f"{at}.force"])
        else:
            rows.append(v[f"{at}.joint_torque"] / v[f"{at}.lever_arm"])
    return stacked(rows)


def oil_bulk_modulus(
    v: Values, stock: Stock, name: str, temperature: Array, pressure: Array
) -> Array:
    """Tangent bulk modulus of the oil with its air at a temperature and a pressure."""
    modulus = stock.get(name, "bulk_modulus")
    decay = stock.get(name, "bulk_modulus_decay")
    if decay is not None:
        modulus = fluid.bulk_modulus_warm(
            bulk_modulus=modulus,
            decay=decay,
            temperature=temperature,
            reference_temperature=stock.get(name, "bulk_modulus_temperature"),
        )
    pure = fluid.bulk_modulus_linear(
        bulk_modulus=modulus,
        slope=stock.get(name, "bulk_modulus_slope", default=0.0),
        pressure=pressure - stock.get(name, "bulk_modulus_pressure", default=0.0),
    )
    return fluid.effective_bulk_modulus(
        bulk_modulus=pure, pressure=pressure, air_content=v["fluid.air_content"]
    )


def _viscosity(v: Values, oil: Material, temperature: Array) -> Array:
    """Kinematic viscosity from the oil's table, scaled with its stated value."""
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


def _reach(v: Values, design: Design, geometry: Geometry) -> Array:
    """Position of every case; one number where all are ``worst``, which is full extension."""
    if all(case.position == "worst" for case in design.load_cases):
        return geometry.stroke
    rows = []
    for case in design.load_cases:
        path = f"load_cases[{case.name}].position"
        if case.position == "worst":
            rows.append(geometry.stroke)
        elif isinstance(case.position, Fraction):
            rows.append(v.get(path, case.position.value) * geometry.stroke)
        else:
            rows.append(v[path])
    return stacked(rows)


def derive(v: Values, design: Design, stock: Stock, geometry: Geometry) -> State:
    """State of every load case of a design."""
    push = np.array([[case.direction == "push"] for case in design.load_cases])
    force = case_force(v, design)
    supply, drain = v["supply.pressure"], v["supply.return_pressure"]
    driven = v.case("pressure", supply)
    temperature = v.case("temperature", v["fluid.temperature"])
    holding_a, holding_b = stiffness.holding_pressures(
        force=where(push, force, -force),
        supply_pressure=supply,
        return_pressure=drain,
        area_a=geometry.area_a,
        area_b=geometry.area_b,
    )
    name = design.fluid.material
    oil = stock.material(name)
    kinematic = _viscosity(v, oil, temperature)
    density = stock.get(name, "density")
    expansion = stock.get(name, "volume_expansion")
    if expansion is not None and "density_temperature" in oil.numbers:
        density = oil_density.density_thermal(
            reference_density=density,
            volume_expansion=expansion,
            temperature=temperature,
            reference_temperature=stock.get(name, "density_temperature"),
        )
    return State(
        push=push,
        reach=_reach(v, design, geometry),
        force=force,
        speed=v.case("speed"),
        side_load=v.case("side_load"),
        temperature=temperature,
        driven_pressure=driven,
        moving_a=where(push, driven, drain),
        moving_b=where(push, drain, driven),
        holding_a=holding_a,
        holding_b=holding_b,
        kinematic_viscosity=kinematic,
        density=density,
        dynamic_viscosity=kinematic * density,
        bulk_modulus_a=oil_bulk_modulus(v, stock, name, temperature, holding_a),
        bulk_modulus_b=oil_bulk_modulus(v, stock, name, temperature, holding_b),
    )
