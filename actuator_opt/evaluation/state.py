"""The state of every load case: pressures, force, speed, temperature and the oil at them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..design.kinds import Fraction
from ..design.model import Design
from ..models import retention, stiffness
from ..numeric import Array, where
from . import oil
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
    """Viscosities and density at the case temperature and zero gauge pressure."""
    dynamic_viscosity_a: Array
    dynamic_viscosity_b: Array
    """At the pressures of the moving chambers."""
    bulk_modulus_a: Array
    bulk_modulus_b: Array


def overhang(g: Geometry, state: State) -> Array:
    """Distance of the rod eye from the middle of the head bearing, at the case's position."""
    return state.reach + g.rod_extension + g.eye_offset + (g.head_length + g.plate) / 2


def side_reactions(g: Geometry, state: State) -> dict[str, Array]:
    """Side force that rod and piston guide carry."""
    head, piston = retention.guide_forces(
        side_force=state.side_load, overhang=overhang(g, state), span=g.bearing_span
    )
    return {"rod": head, "piston": piston}


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


def _stated(v: Values, design: Design, field: str, otherwise: Array) -> Array:
    """A held pressure of every case: the case's own, or `otherwise`."""
    own = np.array([[getattr(case, field) is not None] for case in design.load_cases])
    return where(own, v.case(field, 0.0), otherwise) if own.any() else otherwise


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
    holding_a = _stated(v, design, "pressure_a", holding_a)
    holding_b = _stated(v, design, "pressure_b", holding_b)
    kinematic = oil.kinematic_viscosity(v, design.fluid, stock, temperature)
    density = oil.density(v, design.fluid, stock, temperature)
    dynamic = kinematic * density
    moving_a, moving_b = where(push, driven, drain), where(push, drain, driven)
    return State(
        push=push,
        reach=_reach(v, design, geometry),
        force=force,
        speed=v.case("speed"),
        side_load=v.case("side_load"),
        temperature=temperature,
        driven_pressure=driven,
        moving_a=moving_a,
        moving_b=moving_b,
        holding_a=holding_a,
        holding_b=holding_b,
        kinematic_viscosity=kinematic,
        density=density,
        dynamic_viscosity=dynamic,
        dynamic_viscosity_a=oil.under_pressure(design.fluid, stock, dynamic, temperature, moving_a),
        dynamic_viscosity_b=oil.under_pressure(design.fluid, stock, dynamic, temperature, moving_b),
        bulk_modulus_a=oil.bulk_modulus(v, design.fluid, stock, temperature, holding_a),
        bulk_modulus_b=oil.bulk_modulus(v, design.fluid, stock, temperature, holding_b),
    )
