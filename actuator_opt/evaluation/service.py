"""Life and service limits of an actuator: pressure cycles, end stop, temperature, trapped oil."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..base.numeric import Array, maximum, where
from ..design.model import Design
from ..models import end_stop, endurance, oil_laws, rod
from . import piston_nut, rod_strength
from .barrel import Wall
from .geometry import Geometry
from .limits import MaterialValues, MetricArrays
from .linkage import Demand
from .rods import RodSection, material_of
from .state import LoadState
from .strength import LoadedJoint
from .values import Values

THREAD_NOTCH = 3.0
"""Fatigue notch factor of a rolled thread root, [Shigley2011] table 8-16."""


def compute(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    wall: Wall,
    sections: Sequence[RodSection],
    loaded_joints: Sequence[LoadedJoint],
    stop: Demand,
    net: Array,
    out: MetricArrays,
) -> None:
    """Compute all life and service metrics.

    `net` is the net force of the actuator in every load case. `stop` has force, speed and mass of
    the load when the piston runs into a stop.
    """
    supply = v["supply.pressure"]
    push, pull = supply * g.area_a, supply * g.area_b
    _endurance(v, stock, design, g, wall, sections, loaded_joints, supply, push, pull, out)
    _end_stop(v, design, g, state, supply, stop, net, out)
    _trapped(v, stock, design, g, state, wall, supply, out)
    _layers(stock, wall, out)
    _service(v, stock, design, out)
    _clearance(v, stock, design, g, wall, out)
    factor = v["supply.proof_ratio"] * g.area_b / g.area_a
    if design.double_rod:
        back = v["supply.proof_ratio"] * g.area_a / g.area_b
        out.put("blocked_port_factor", {"port b blocked": factor, "port a blocked": back})
    else:
        out.put("blocked_port_factor", factor)


def _endurance(
    v: Values,
    stock: MaterialValues,
    design: Design,
    g: Geometry,
    wall: Wall,
    sections: Sequence[RodSection],
    loaded_joints: Sequence[LoadedJoint],
    supply: Array,
    push: Array,
    pull: Array,
    out: MetricArrays,
) -> None:
    """Compute the pressure-cycle life of metal layers, the rod (push and pull) and thread roots."""
    cycles = wall.cycles | rod_strength.cycles(design, g, sections, supply, push, pull)
    for end in loaded_joints:
        cycles |= end.placed(end.beside.cycles)
    loads = [(place, c.material, c.span, c.mean) for place, c in cycles.items()]
    if design.rod.thread is not None:
        stress = THREAD_NOTCH * rod.thread_stress(
            force=pull, diameter=v["rod.thread.diameter"], pitch=v["rod.thread.pitch"]
        )
        loads.append(("rod thread", sections[0].end_material, stress, stress / 2))
    lives = piston_nut.lives(v, design, stock, g, push, pull)
    for end in loaded_joints:
        fatigue = end.joint.fatigue(end.loaded)
        loads += [(end.end_joint.placed(place), *load) for place, *load in fatigue.pulsed]
        lives |= end.placed(fatigue.lives)
    life, factor, unknown = _pulsed_lives(stock, loads)
    for place, known in lives.items():
        life[place], factor[place] = known
    missing = ", ".join(dict.fromkeys(unknown.values()))
    for metric, values in (("cycle_life", life), ("fatigue_factor", factor)):
        if values:
            out.put(metric, values)
        else:
            out.skip(metric, f"fatigue strength is unknown for {missing}")
    if life and unknown:
        parts = ", ".join(f"{place} ({name})" for place, name in unknown.items())
        out.left_out.append(f"pressure-cycle life leaves out {parts}: fatigue strength unknown")


def _pulsed_lives(
    stock: MaterialValues, loads: Iterable[tuple[str, str, Array, Array]]
) -> tuple[dict[str, Array], dict[str, Array], dict[str, str]]:
    """Lives and fatigue factors under pulsating stress, and materials without data, by place.

    `loads` are place, material, span and mean of the stress.
    """
    life: dict[str, Array] = {}
    factor: dict[str, Array] = {}
    unknown: dict[str, str] = {}
    for place, name, span, mean in loads:
        ultimate = stock.allowable(name, "ultimate_strength")
        limit = stock.allowable(name, "fatigue_strength")
        if ultimate is None or limit is None:
            unknown[place] = name
            continue
        limit_cycles = stock.get(name, "fatigue_cycles", default=1e6)
        peak = mean + span / 2
        ratio = (mean - span / 2) / peak
        life[place] = endurance.cycles_to_failure(
            peak_stress=peak,
            ultimate_strength=ultimate,
            fatigue_limit=limit,
            limit_cycles=limit_cycles,
            stress_ratio=ratio,
        )
        factor[place] = endurance.fatigue_factor(
            peak_stress=peak,
            ultimate_strength=ultimate,
            amplitude_strength=limit,
            stress_ratio=ratio,
        )
    return life, factor, unknown


def _end_stop(
    v: Values,
    design: Design,
    g: Geometry,
    state: LoadState,
    supply: Array,
    stop: Demand,
    net: Array,
    out: MetricArrays,
) -> None:
    """Compute energy and peak pressure when the piston hits its stop at the speed of the load case.

    During the impact, the load still acts, and the net force of pressure and load drives the piston
    into the stop.
    """
    if design.cylinder.end_stop == "external":
        for name in ("end_stop_energy", "end_stop_pressure", "end_stop_factor"):
            out.skip(name, "the end stop is external, not in the actuator")
        return
    stiffness = end_stop.stop_stiffness(
        area=g.area_a, pressure=supply, travel=v["cylinder.stop_travel"]
    )
    run = {
        "driving_force": maximum(net - stop.force, 0.0),
        "mass": stop.mass,
        "velocity": stop.speed,
    }
    travel = endurance.end_stop_compression(stiffness=stiffness, **run)
    out.put("end_stop_energy", endurance.end_stop_energy(compression=travel, **run))
    peak = endurance.end_stop_peak_pressure(
        pressure=v["supply.return_pressure"],
        peak_force=endurance.end_stop_peak_force(stiffness=stiffness, compression=travel),
        area=where(state.push, g.area_b, g.area_a),
    )
    out.put("end_stop_pressure", peak)
    out.put("end_stop_factor", v["supply.proof_ratio"] * supply / peak)


def _trapped(
    v: Values,
    stock: MaterialValues,
    design: Design,
    g: Geometry,
    state: LoadState,
    wall: Wall,
    supply: Array,
    out: MetricArrays,
) -> None:
    """Compute the pressure of trapped oil that warms up while the ports are blocked."""
    environment = design.environment
    rise = None if environment is None else environment.trapped_rise
    oil = design.fluid.material
    expansion = stock.get(oil, "volume_expansion")
    if rise is None or wall.expansion is None or expansion is None:
        why = "no trapped_rise stated: add environment.trapped_rise"
        if rise is not None:
            why = f"thermal expansion of {oil} or of the barrel is unknown"
        out.skip("trapped_pressure", why)
        out.skip("trapped_factor", why)
    else:
        slope = oil_laws.thermal_pressure_slope(
            volume_expansion=expansion,
            wall_expansion_axial=wall.expansion[0],
            wall_expansion_hoop=wall.expansion[1],
            bulk_modulus=maximum(state.bulk_modulus_a, state.bulk_modulus_b),
            wall_compliance_per_volume=2 * wall.swelling.growth / g.inner_radius,
        )
        rise_pressure = slope * v["environment.trapped_rise"]
        out.put("trapped_pressure", rise_pressure)
        out.put("trapped_factor", v["supply.proof_ratio"] * supply / (supply + rise_pressure))


def _layers(stock: MaterialValues, wall: Wall, out: MetricArrays) -> None:
    """Compute metrics that only a wall of several layers has, for its liner, fibres and bonds."""
    ranges, strains = {}, {}
    for place, cycle in wall.cycles.items():
        strength = stock.allowable(cycle.material, "yield_strength", "ultimate_strength")
        if wall.layered and strength is not None:
            ranges[place] = 2 * strength / cycle.span
            strains[place] = cycle.span / stock.get(cycle.material, "youngs_modulus")
    reverse = {} if wall.autofrettage is None else {"": 1 / wall.autofrettage.reverse_yield}
    no_liner = "the wall has no metal layer under plies"
    for metric, values, why in (
        ("liner_mismatch_factor", wall.mismatch, wall.why_no_mismatch),
        ("liner_bond_factor", wall.bond, wall.why_no_mismatch),
        ("liner_range_factor", ranges, no_liner),
        ("liner_strain_range", strains, no_liner),
        (
            "reverse_yield_factor",
            reverse,
            "no autofrettage stated: add barrel.autofrettage_pressure",
        ),
        (
            "ply_fatigue_factor",
            wall.ply_fatigue,
            "there are no plies with a known fatigue strength",
        ),
    ):
        if values:
            out.put(metric, values)
        else:
            out.skip(metric, why)


def _service(v: Values, stock: MaterialValues, design: Design, out: MetricArrays) -> None:
    """Compute by how much the temperature range stays within the limits of every material."""
    if design.environment is None:
        out.skip("temperature_margin", "no temperature range stated: add environment")
        return
    margins = {}
    for name in stock.names():
        low, high = stock.get(name, "temperature_min"), stock.get(name, "temperature_max")
        if low is not None:
            margins[f"{name}, cold"] = v["environment.temperature_min"] - low
        if high is not None:
            margins[f"{name}, hot"] = high - v["environment.temperature_max"]
    out.put("temperature_margin", margins)


def _clearance(
    v: Values, stock: MaterialValues, design: Design, g: Geometry, wall: Wall, out: MetricArrays
) -> None:
    """Compute the radial clearance of piston and rod at the coldest and hottest temperature.

    The clearance is c + r (alpha_outside - alpha_inside) dT, with the clearance c at assembly, the
    radius r, the expansion coefficients alpha of outer and inner part, and the temperature change
    dT since assembly.
    """
    if design.environment is None:
        out.skip("clearance_min", "no temperature range stated: add environment")
        return
    head = stock.get(design.head.material, "thermal_expansion", "thermal_expansion_2")
    piston = stock.get(design.piston.material, "thermal_expansion", "thermal_expansion_2")
    fits = []
    if wall.expansion is not None and piston is not None:
        fits.append(("piston", g.piston_clearance, g.inner_radius, wall.expansion[1] - piston))
    for through in g.rods:
        name = material_of(design, through)
        rod = stock.get(name, "thermal_expansion", "thermal_expansion_2")
        if rod is not None and head is not None and not design.rod.layup:
            fits.append((through.gland, g.head_clearance, through.diameter / 2, head - rod))
    if not fits:
        out.skip("clearance_min", "thermal expansion of barrel or piston is unknown")
        return
    values = {}
    for name in ("temperature_min", "temperature_max"):
        change = v[f"environment.{name}"] - v["environment.assembly_temperature"]
        climate = "cold" if name.endswith("min") else "hot"
        for part, clearance, radius, mismatch in fits:
            values[f"{part}, {climate}"] = clearance + radius * mismatch * change
    out.put("clearance_min", values)
