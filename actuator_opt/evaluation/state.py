"""State of all load cases: pressures, force, speed, temperature and oil properties."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.numeric import Array, where
from ..design.kinds import Fraction
from ..design.model import Design
from ..models import retention, stiffness
from . import joints as joint_module, oil
from .geometry import Geometry
from .joints import WORST, Demand, Joint
from .limits import MaterialValues
from .values import Values, stacked


@dataclass(frozen=True, slots=True)
class LoadState:
    """Quantities of the load cases, (cases, 1) or (cases, designs); pressures are gauge.

    Moving: driven chamber at the case pressure (default: supply), the other at return pressure.
    Holding: a critical-centre servo valve closes the ports against the force [Merritt1967].
    """

    push: np.ndarray
    joint: Joint | None
    positions: tuple[Array | None, ...]
    """Piston position of every case; None for the worst."""
    reach: Array
    """Piston position for column and side load: stated, or the full stroke (worst)."""
    asked: dict[str, Demand]
    """Demands of the load: worst, where its force is largest, and at both stops of a joint."""
    force: Array
    """Worst demand: for a linkage without stated position at the least lever arm."""
    speed: Array
    """Worst force: for a joint without stated position at the largest lever arm."""
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
    """Viscosities at the pressures of the moving chambers."""
    bulk_modulus_a: Array
    bulk_modulus_b: Array


def overhang(g: Geometry, state: LoadState) -> Array:
    """Distance of the rod eye from the middle of the head bearing, at the position of the case."""
    return state.reach + g.rod_extension + g.eye_offset + (g.head_length + g.plate) / 2


def side_reactions(g: Geometry, state: LoadState) -> dict[str, Array]:
    """Side forces on rod and piston guides."""
    head, piston = retention.guide_forces(
        side_force=state.side_load, overhang=overhang(g, state), span=g.bearing_span
    )
    return {"rod": head, "piston": piston}


def _positions(
    v: Values, design: Design, geometry: Geometry, joint: Joint | None
) -> tuple[Array | None, ...]:
    """Piston position of every case, from its joint angle or stated; None for the worst."""
    rows: list[Array | None] = []
    for case in design.load_cases:
        at = f"load_cases[{case.name}]"
        if joint is not None and case.angle is not None:
            rows.append(joint.position(v[f"{at}.angle"]))
        elif case.position == "worst":
            rows.append(None)
        elif isinstance(case.position, Fraction):
            rows.append(v.get(f"{at}.position", case.position.value) * geometry.stroke)
        else:
            rows.append(v[f"{at}.position"])
    return tuple(rows)


def _reach(geometry: Geometry, positions: Sequence[Array | None]) -> Array:
    """Position of every case; a single number if all are ``worst``, which is full extension."""
    if all(position is None for position in positions):
        return geometry.stroke
    return stacked([geometry.stroke if x is None else x for x in positions])


def _stated(v: Values, design: Design, field: str, otherwise: Array) -> Array:
    """A held pressure of every case: stated, or `otherwise`."""
    own = np.array([[getattr(case, field) is not None] for case in design.load_cases])
    return where(own, v.case(field, 0.0), otherwise) if own.any() else otherwise


def _holding(
    v: Values, design: Design, geometry: Geometry, push: Array, force: Array
) -> tuple[Array, Array]:
    """Pressures that hold the force, unless the case states them."""
    holding_a, holding_b = stiffness.holding_pressures(
        force=where(push, force, -force),
        supply_pressure=v["supply.pressure"],
        return_pressure=v["supply.return_pressure"],
        area_a=geometry.area_a,
        area_b=geometry.area_b,
    )
    return (
        _stated(v, design, "pressure_a", holding_a),
        _stated(v, design, "pressure_b", holding_b),
    )


def holding(
    v: Values, design: Design, stock: MaterialValues, geometry: Geometry, s: LoadState, end: str
) -> LoadState:
    """The state with the demand of the load at one stop of a joint, holding."""
    force = s.asked[end].force
    holding_a, holding_b = _holding(v, design, geometry, s.push, force)
    return replace(
        s,
        force=force,
        holding_a=holding_a,
        holding_b=holding_b,
        bulk_modulus_a=oil.bulk_modulus(v, design.fluid, stock, s.temperature, holding_a),
        bulk_modulus_b=oil.bulk_modulus(v, design.fluid, stock, s.temperature, holding_b),
    )


def derive(v: Values, design: Design, stock: MaterialValues, geometry: Geometry) -> LoadState:
    """State of all load cases of a design."""
    push = np.array([[case.direction == "push"] for case in design.load_cases])
    joint = joint_module.derive(v, design, geometry)
    positions = _positions(v, design, geometry, joint)
    asked = joint_module.demands(v, design, joint, positions)
    force = asked[WORST].force
    supply, drain = v["supply.pressure"], v["supply.return_pressure"]
    driven = v.case("pressure", supply)
    temperature = v.case("temperature", v["fluid.temperature"])
    holding_a, holding_b = _holding(v, design, geometry, push, force)
    kinematic = oil.kinematic_viscosity(v, design.fluid, stock, temperature)
    density = oil.density(v, design.fluid, stock, temperature)
    dynamic = kinematic * density
    moving_a, moving_b = where(push, driven, drain), where(push, drain, driven)
    return LoadState(
        push=push,
        joint=joint,
        positions=positions,
        reach=_reach(geometry, positions),
        asked=asked,
        force=force,
        speed=asked[WORST].speed,
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
