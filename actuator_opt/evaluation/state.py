"""State of all load cases: pressures, force, speed, temperature, and properties of the oil.

Oil properties are bulk modulus, viscosity, density and vapour pressure. The module also warns of
boiling, and of pressures and temperatures outside the range of the oil's laws and data. Pressures
are gauge. If the design states no law for viscosity or bulk modulus, that of the oil's library
entry applies. All properties are those of the pure liquid, except `bulk_modulus`, which includes
entrained air.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, minimum, real, where
from ..design.kinds import Fraction
from ..design.material import Material, bulk_modulus_law, viscosity_law
from ..design.model import Design, FluidSection
from ..metrics.table import OIL_FED
from ..models import fluid, oil_laws, stiffness
from ..models.oil_laws import BULK_MODULUS_LAWS, VISCOSITY_LAWS
from . import linkage as joint_module
from .geometry import Geometry
from .limits import MaterialValues, MetricArrays
from .linkage import WORST, Demand, DrivenJoint
from .values import Values, stacked

Law: TypeAlias = Callable[..., Array]


def alone(material: Material, **choices: object) -> tuple[Values, FluidSection, MaterialValues]:
    """Inputs for the oil functions of this module, for a library oil that no design uses.

    Parameters
    ----------
    material : the oil
    choices : values for other keys of the block `fluid`, SI
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
    """Return a function that looks up a property of an oil by its key."""
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


def oil_density(
    v: Values,
    section: FluidSection,
    stock: MaterialValues,
    temperature: Array,
    pressure: Array | None = None,
) -> Array:
    """Density at a temperature and a pressure (None: zero), consistent with the bulk modulus."""
    name = section.material
    rho = stock.get(name, "density")
    expansion = stock.get(name, "volume_expansion")
    numbers = stock.material(name).numbers
    if expansion is not None and "density_temperature" in numbers:
        rho = oil_laws.density_thermal(
            reference_density=rho,
            volume_expansion=expansion,
            temperature=temperature,
            reference_temperature=stock.get(name, "density_temperature"),
        )
    if pressure is None:
        return rho
    law = BULK_MODULUS_LAWS[bulk_modulus_law(section.bulk_modulus_law, numbers)]
    return law.density(_properties(stock, name), rho, temperature, pressure)


def kinematic_viscosity(
    v: Values, section: FluidSection, stock: MaterialValues, temperature: Array
) -> Array:
    """Kinematic viscosity at zero gauge pressure.

    If the oil's `kinematic_viscosity` is varied, its table of viscosity versus temperature is
    scaled in proportion.
    """
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
        density=oil_density(v, section, stock, temperature),
    )
    return under_pressure(section, stock, viscosity, temperature, pressure)


def pressure_law(
    section: FluidSection, stock: MaterialValues, temperature: Array
) -> tuple[str, Array]:
    """Name of the law of viscosity versus pressure, and its coefficient at a temperature."""
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
    """Vapour pressure (absolute) at a temperature; None if the library states none."""
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
    """Yield (function, quantity) for every law that depends on the pressure of the oil."""
    modulus = BULK_MODULUS_LAWS[bulk_modulus_law(section.bulk_modulus_law, oil.numbers)]
    if modulus.model is not None:
        yield modulus.model, "bulk modulus"
    yield fluid.effective_bulk_modulus, "air"
    viscosity = VISCOSITY_LAWS[viscosity_law(section.viscosity_pressure, oil.numbers)]
    if viscosity.model is not None:
        yield viscosity.model, "viscosity"


@dataclass(frozen=True, slots=True)
class LoadState:
    """Quantities of the load cases, (cases, 1) or (cases, designs). Pressures are gauge.

    While the piston moves (`moving_a`, `moving_b`), the driven chamber is at the pressure of the
    load case (default: supply), and the other chamber at return pressure. While the actuator holds
    the load (`holding_a`, `holding_b`), a critical-centre servo valve closes the ports, and the
    pressures balance the force [Merritt1967].
    """

    push: np.ndarray
    joint: DrivenJoint | None
    positions: tuple[Array | None, ...]
    """Piston position of every load case; None: the worst position."""
    reach: Array
    """Piston position for buckling and side load: as stated, else the full stroke (worst)."""
    withdrawn: Array
    """Piston position for a second rod: as stated, else 0, where it is longest outside the cap."""
    demands: dict[str, Demand]
    """Force, speed and mass that the load demands, by position (keys: see `linkage.demands`)."""
    force: Array
    """Force at the stated position, else the largest force: at a linkage's shortest lever arm."""
    speed: Array
    """Speed at the stated position, else the largest speed: at a linkage's largest lever arm."""
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
    """`dynamic_viscosity`, `kinematic_viscosity` and `density` are those at the load case's
    temperature and zero gauge pressure."""
    dynamic_viscosity_a: Array
    dynamic_viscosity_b: Array
    """Viscosities in chambers A and B are at the pressures `moving_a` and `moving_b`."""
    bulk_modulus_a: Array
    bulk_modulus_b: Array


def overhang(g: Geometry, state: LoadState) -> Array:
    """Distance of the rod eye from the middle of the head bearing, in every load case."""
    return (
        state.reach + g.rod_extension + g.rod_stack + g.eye_offset + (g.head_length + g.plate) / 2
    )


def _positions(
    v: Values, design: Design, geometry: Geometry, joint: DrivenJoint | None
) -> tuple[Array | None, ...]:
    """Piston position of every load case, as stated or from its joint angle; None: the worst."""
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


def _at(positions: Sequence[Array | None], worst: Array) -> Array:
    """Position of every load case, `worst` where none is stated.

    If all positions are ``worst``, it is a single number.
    """
    if all(position is None for position in positions):
        return worst
    return stacked([worst if x is None else x for x in positions])


def _stated(v: Values, design: Design, field: str, otherwise: Array) -> Array:
    """Holding pressure of one chamber in every load case: as stated, else `otherwise`."""
    stated = np.array([[getattr(case, field) is not None] for case in design.load_cases])
    return where(stated, v.case(field, 0.0), otherwise) if stated.any() else otherwise


def _holding(
    v: Values, design: Design, geometry: Geometry, push: Array, force: Array
) -> tuple[Array, Array]:
    """Chamber pressures that hold the force, unless the load case states them."""
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
    """Copy the state, with the load held at the stop `end` of a linkage.

    Force, chamber pressures and bulk moduli are changed.
    """
    force = s.demands[end].force
    holding_a, holding_b = _holding(v, design, geometry, s.push, force)
    return replace(
        s,
        force=force,
        holding_a=holding_a,
        holding_b=holding_b,
        bulk_modulus_a=bulk_modulus(v, design.fluid, stock, s.temperature, holding_a),
        bulk_modulus_b=bulk_modulus(v, design.fluid, stock, s.temperature, holding_b),
    )


def derive(v: Values, design: Design, stock: MaterialValues, geometry: Geometry) -> LoadState:
    """State of all load cases of a design."""
    push = np.array([[case.direction == "push"] for case in design.load_cases])
    joint = joint_module.derive(v, design, geometry)
    positions = _positions(v, design, geometry, joint)
    demands = joint_module.demands(v, design, joint, positions)
    force = demands[WORST].force
    supply, drain = v["supply.pressure"], v["supply.return_pressure"]
    driven = v.case("pressure", supply)
    temperature = v.case("temperature", v["fluid.temperature"])
    holding_a, holding_b = _holding(v, design, geometry, push, force)
    kinematic = kinematic_viscosity(v, design.fluid, stock, temperature)
    density = oil_density(v, design.fluid, stock, temperature)
    dynamic = kinematic * density
    moving_a, moving_b = where(push, driven, drain), where(push, drain, driven)
    return LoadState(
        push=push,
        joint=joint,
        positions=positions,
        reach=_at(positions, geometry.stroke),
        withdrawn=_at(positions, 0.0 * geometry.stroke),
        demands=demands,
        force=force,
        speed=demands[WORST].speed,
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
        dynamic_viscosity_a=under_pressure(design.fluid, stock, dynamic, temperature, moving_a),
        dynamic_viscosity_b=under_pressure(design.fluid, stock, dynamic, temperature, moving_b),
        bulk_modulus_a=bulk_modulus(v, design.fluid, stock, temperature, holding_a),
        bulk_modulus_b=bulk_modulus(v, design.fluid, stock, temperature, holding_b),
    )


def compute(
    section: FluidSection, stock: MaterialValues, state: LoadState, out: MetricArrays
) -> None:
    """Compute by how much the lowest chamber pressure exceeds the oil's vapour pressure."""
    limit = vapour_pressure(stock, section.material, state.temperature)
    if limit is None:
        why = f"{section.material} has no vapour_pressure: add it under materials"
        out.skip("cavitation_margin", why)
        return
    lowest = minimum(
        minimum(state.moving_a, state.moving_b), minimum(state.holding_a, state.holding_b)
    )
    out.put("cavitation_margin", lowest + fluid.ATMOSPHERIC_PRESSURE - limit)


def warnings(
    section: FluidSection, oil: Material, cases: Sequence[str], state: LoadState
) -> Iterable[tuple[str, str]]:
    """Yield (metric, sentence) for each use of the oil outside the range of its data or laws."""
    yield from _temperatures(oil, cases, state)
    law = bulk_modulus_law(section.bulk_modulus_law, oil.numbers)
    chambers = [state.moving_a, state.moving_b, state.holding_a, state.holding_b]
    highest = max(float(np.max(np.real(pressure))) for pressure in chambers)
    limit = BULK_MODULUS_LAWS[law].largest_pressure
    if highest > limit:
        text = (
            f"bulk modulus: a chamber has {highest / 1e5:.0f} bar, but the {law} law of the oil is "
            f"valid up to {limit / 1e5:.0f} bar"
        )
        yield from ((metric, text) for metric in OIL_FED)
    law = viscosity_law(section.viscosity_pressure, oil.numbers)
    limit = VISCOSITY_LAWS[law].largest_pressure
    if highest > limit:
        yield (
            "oil_viscosity",
            f"viscosity: a chamber has {highest / 1e5:.0f} bar, but the {law.capitalize()} law is "
            f"valid up to {limit / 1e5:.0f} bar",
        )


def _temperatures(
    oil: Material, cases: Sequence[str], state: LoadState
) -> Iterable[tuple[str, str]]:
    """Warn of temperatures or viscosities outside the oil's data or service range."""
    low = oil.numbers.get("temperature_min", -np.inf)
    high = oil.numbers.get("temperature_max", np.inf)
    for case, temperature, viscosity in zip(
        cases,
        np.broadcast_to(np.ravel(real(state.temperature)), len(cases)),
        np.broadcast_to(np.ravel(real(state.kinematic_viscosity)), len(cases)),
        strict=True,
    ):
        if not low <= temperature <= high:
            yield (
                "oil_viscosity",
                f"{case}: {temperature - 273.15:.0f} degC is outside the service range of "
                f"{oil.name}, {low - 273.15:.0f} to {high - 273.15:.0f} degC",
            )
        if viscosity < fluid.LEAST_VISCOSITY:
            yield (
                "oil_viscosity",
                f"{case}: the viscosity, {1e6 * viscosity:.2g} mm^2/s, is below the "
                f"lower limit of ASTM D341, {1e6 * fluid.LEAST_VISCOSITY:.0f} mm^2/s",
            )
