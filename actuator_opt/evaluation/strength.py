"""Static strength of wall, rod, column, thread, retention, caps, pins and guides.

Loads are the largest forces that the supply pressure p can cause. The push is p A_A (stall,
buckling), the pull is p A_B (rod tension), with piston areas A_A and A_B of the chambers. At an end
stop, a force also acts through barrel and retention, the joint of caps and head.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import TypeVar

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, namespace, real, where
from ..design.model import Design, Ply
from ..joints.joint import Joint, Loaded, Thermal
from ..joints.kinds import JOINTS
from ..joints.overlap import Overlap
from ..models import end_plate, ply, retention, rod
from ..models.end_bending import ShellLayer
from ..models.layered_tube import LayeredTube, layered_tube
from . import beside, piston_nut, plies, rod_strength, rods
from .barrel import Wall
from .barrel.wall import largest_area
from .beside import RowsBeside
from .geometry import (
    EndJoint,
    Geometry,
    Groove,
    Numbers,
    bearing_of,
    clamped,
    end_at,
    groove_totals,
    joints_of,
)
from .guides import side_reactions
from .limits import MaterialValues, MetricArrays
from .rod_strength import Beam
from .rods import RodSection
from .state import LoadState
from .values import Values

HOLE = 2.0
"""Factor by which a small central hole increases the stress in a plate [Timoshenko1959]."""
Item = TypeVar("Item")
NO_RETENTION = "no retention stated: add retention"


@dataclass(frozen=True, slots=True)
class LoadedJoint:
    """The joint of one end of the barrel, or of both ends, under load."""

    end_joint: EndJoint
    loaded: Loaded
    beside: RowsBeside

    @property
    def joint(self) -> Joint:
        """The type of joint."""
        return self.end_joint.joint

    def placed(self, values: Mapping[str, Item]) -> dict[str, Item]:
        """Values by location, with the name of the end if the two ends differ."""
        return {self.end_joint.placed(place): value for place, value in values.items()}


def _shell_layer(
    v: Values, stock: MaterialValues, at: str, entry: Ply, thickness: Array
) -> ShellLayer:
    """Stiffness of a layer of the barrel against bending; `at` is its PATH."""
    c = stock.ply_constants(entry.material)
    stiffness = plies.plane_stiffness(c)
    if stock.material(entry.material).isotropic:
        along, both, _, modulus = stiffness
        return ShellLayer(thickness, along, along, both, modulus)
    angle = v[f"{at}.angle"]
    axial, coupling, hoop, *_ = ply.rotated(stiffness=stiffness, angle=angle)
    cosine = namespace(angle).cos(angle)
    share = cosine * cosine
    shear = share * c["shear_modulus_13"] + (1 - share) * c["shear_modulus_23"]
    return ShellLayer(thickness, axial, hoop, coupling, shear, angle)


def joints_under_load(
    v: Values, design: Design, stock: MaterialValues, g: Geometry, wall: Wall
) -> tuple[LoadedJoint, ...]:
    """The joints of a design under their largest separating force; none without `retention`."""
    layers = list(zip(design.barrel.layup, g.thicknesses, strict=True))
    known = all(stock.ply_constants(entry.material) for entry, _ in layers)
    shells = tuple(
        _shell_layer(v, stock, f"barrel.layup[{i}]", *layer)
        for i, layer in enumerate(layers)
        if known
    )

    def tube() -> LayeredTube | None:
        if not known:
            return None
        walls = plies.layers(v, stock, design.barrel.layup, "barrel.layup", (), [])
        return layered_tube(layers=[one.as_tube() for one in walls], inner_radius=g.inner_radius)

    climates = plies.climates(v, design)
    since_cure = tuple(climate.change for climate in climates) if len(climates) > 1 else ()
    supply, joints = v["supply.pressure"], []
    # without `retention`, there is no joint, but one entry in `g.fits`
    for end_joint, fit in zip(joints_of(design), g.fits, strict=False):
        loaded = Loaded(
            end=end_at(design, end_joint, Numbers(v, end_joint.path), g),
            materials=stock,
            force=supply * largest_area(design, g),
            paths=wall.path.per_pressure,
            line_stiffness=wall.axial_line_stiffness,
            expansion=None if wall.expansion is None else wall.expansion[0],
            warm_liner=wall.warm_liner,
            clamp=wall.path.clamp,
            shells=shells,
            pressure=supply,
            tube=tube,
            warmings=plies.warmings(v, design),
            since_cure=since_cure,
        )
        rows = beside.rows(end_joint, loaded, fit, wall, supply)
        joints.append(LoadedJoint(end_joint, loaded, rows))
    return tuple(joints)


def compute(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    wall: Wall,
    sections: Sequence[RodSection],
    beams: Sequence[Beam],
    loaded_joints: Sequence[LoadedJoint],
    out: MetricArrays,
) -> None:
    """Compute all metrics of static strength."""
    section, supply = sections[0], v["supply.pressure"]
    push, pull = supply * g.area_a, supply * g.area_b
    yields, bursts = wall.yield_pressure, wall.burst_pressure
    first_ply = dict(wall.first_ply_pressure)
    for end in loaded_joints:
        joint_walls = end.joint.wall(end.loaded)
        yields = {**yields, **end.placed(joint_walls.yields), **end.placed(end.beside.yields)}
        first_ply |= end.placed(end.beside.first_ply)
        bursts = {**bursts, **end.placed(joint_walls.bursts)}
    _pressure_factors(v, wall, supply, yields, first_ply, bursts, out)
    parts = {place: p / supply for place, p in yields.items()}
    parts |= rod_strength.yields(stock, design, g, state, sections, beams)
    for end in loaded_joints:
        parts |= end.placed(end.joint.yields(end.loaded))
    parts |= _fitting_yield(v, stock, design, section, push)
    parts |= piston_nut.yields(v, design, stock, g, push, pull)
    out.put("yield_factor", parts)
    out.put("buckling_factor", rod_strength.buckling(g, beams, push, pull))
    rod_strength.compute(design, g, sections, beams, supply, push, pull, out)
    _threads(v, stock, design, g, section, pull, out)
    thermal = _retention(v, design, loaded_joints, out)
    fittings = rods.fittings(v, stock, design, section)
    _fittings(stock, fittings, push, out)
    thermal["rod fittings"] = fittings if isinstance(fittings, str) else fittings.thermal(stock)
    rods.thermal(v, design, thermal, out)
    _caps(stock, design, g, supply, out)
    _pins(stock, design, g, maximum(push, pull) if design.double_rod else push, out)
    _guides(stock, design, g, side_reactions(g, state, sections).by_place, out)


def _pressure_factors(
    v: Values,
    wall: Wall,
    supply: Array,
    yields: Mapping[str, Array],
    first_ply: Mapping[str, Array],
    bursts: Mapping[str, Array],
    out: MetricArrays,
) -> None:
    """Compute the barrel's safety factors against yield, first-ply failure and burst.

    A factor is the failure pressure divided by supply pressure or, in the proof check, by proof
    pressure. `yields`, `first_ply` and `bursts` are the pressures at yield, first-ply failure and
    burst by location, in barrel and joint.
    """
    proof = v["supply.proof_ratio"] * supply
    liner = {place: p / supply for place, p in wall.yield_pressure.items()}
    why = wall.missing[0] if wall.missing else "the wall has no metal layer"
    for name, factors in (
        ("liner_yield_factor", liner),
        ("burst_factor", {place: p / supply for place, p in bursts.items()}),
        ("first_ply_factor", {place: p / supply for place, p in first_ply.items()}),
    ):
        if factors:
            out.put(name, factors)
        else:
            out.skip(name, "the wall has no plies" if name == "first_ply_factor" else why)
    both = {**yields, **first_ply}
    if both:
        out.put("proof_factor", {place: p / proof for place, p in both.items()})
    else:
        out.skip("proof_factor", why)


def _fitting_yield(
    v: Values, stock: MaterialValues, design: Design, section: RodSection, push: Array
) -> dict[str, Array]:
    """Yield strength of the rod fittings divided by their stress under the push."""
    strength = stock.allowable(section.end_material, "yield_strength")
    if strength is None or design.rod.fitting is None:
        return {}
    return {"rod fitting": strength * rods.fitting_area(v, design, section) / push}


def _threads(
    v: Values,
    stock: MaterialValues,
    design: Design,
    g: Geometry,
    section: RodSection,
    pull: Array,
    out: MetricArrays,
) -> None:
    """Compute the strength of the rod's threads under the pull: at its end and at the piston."""
    factors = piston_nut.thread_factor(v, design, stock, g, pull)
    closed = piston_nut.closed(v, design, stock, g, pull)
    if closed is None:
        out.skip("piston_nut_factor", piston_nut.NO_NUT)
    else:
        out.put("piston_nut_factor", closed)
    strength = stock.allowable(section.end_material, "yield_strength")
    if design.rod.thread is None or strength is None:
        why = (
            "no thread stated: add rod.thread"
            if design.rod.thread is None
            else f"{section.end_material} has no yield strength"
        )
        if factors:
            out.put("thread_factor", factors)
        else:
            out.skip("thread_factor", why)
        return
    stress = rod.thread_stress(
        force=pull, diameter=v["rod.thread.diameter"], pitch=v["rod.thread.pitch"]
    )
    factor = strength / stress
    out.put("thread_factor", {"rod end": factor, **factors} if factors else factor)


def _since_cure(v: Values, design: Design, thermal: Thermal | str) -> Thermal | str:
    """The function `thermal` of the change since cure, as one of the change since assembly.

    Without a cure temperature, winding and metal are free of stress at assembly.
    """
    environment = design.environment
    if isinstance(thermal, str) or environment is None or environment.cure_temperature is None:
        return thermal
    since = v["environment.assembly_temperature"] - v["environment.cure_temperature"]
    return lambda warming, cold: thermal(warming + since, cold)


def _retention(
    v: Values, design: Design, loaded_joints: Sequence[LoadedJoint], out: MetricArrays
) -> dict[str, Thermal | str]:
    """Compute elastic limit and breaking load of the joints, divided by the largest axial force.

    Returns, for each end, the function for its strength under temperature alone, or the reason why
    that strength is unknown.
    """
    if not loaded_joints:
        out.skip("retention_factor", NO_RETENTION)
        out.skip("retention_burst_factor", NO_RETENTION)
        return {"caps": NO_RETENTION}
    working: dict[str, Array] = {}
    burst: dict[str, Array] = {}
    thermal: dict[str, Thermal | str] = {}
    unknown = ""
    for end in loaded_joints:
        place, strength = end.end_joint.name or "caps", end.joint.strength(end.loaded)
        if isinstance(strength, str):
            unknown = thermal[place] = end.end_joint.placed(strength)
        else:
            working |= end.placed(strength.working)
            burst |= end.placed(strength.burst)
            if strength.combined is not None:
                for word, warming in plies.warmings(v, design).items():
                    factor = strength.combined(warming, word == "cold")
                    burst |= end.placed({f"with temperature, {word}": factor})
            thermal[place] = (
                _since_cure(v, design, strength.thermal) if strength.cured else strength.thermal
            )
    for metric, factors in (("retention_factor", working), ("retention_burst_factor", burst)):
        if unknown:
            out.skip(metric, unknown)
        else:
            out.put(metric, factors)
    return thermal


def joint_metrics(loaded_joints: Sequence[LoadedJoint], out: MetricArrays) -> None:
    """Compute the metrics of the joints; those of other joint types are missing, with a reason."""
    metrics: dict[str, dict[str, Array]] = {}
    for end in loaded_joints:
        for name, value in end.joint.own(end.loaded).items():
            rows = value if isinstance(value, Mapping) else {"": value}
            metrics.setdefault(name, {}).update(end.placed(rows))
    for joint in JOINTS.values():
        for name, absent in joint.metrics.items():
            if name in metrics:
                out.put(name, metrics[name])
            else:
                out.skip(name, absent)


def _fittings(stock: MaterialValues, bond: Overlap | str, push: Array, out: MetricArrays) -> None:
    """Compute the strength of the rod fittings' bonds under the push, which exceeds the pull."""
    if isinstance(bond, str):
        out.skip("fitting_factor", bond)
    else:
        out.put("fitting_factor", bond.edge_factors(stock, push))


def _caps(
    stock: MaterialValues, design: Design, g: Geometry, supply: Array, out: MetricArrays
) -> None:
    """Compute the bending of the end plates; plate and plug of the head are one turned part.

    A skirt in the bore stands clear of the plug, which then does not thicken the plate. With a
    second rod, the cap is like the head.

    While the piston is at the head end, the joint supports the cap plate against the pressure. On a
    clevis, the neck of the eye carries the push, and the pressure bends the plate around the neck.
    The neck also carries the pull, which enters the plate at the skirt.
    """
    name = design.caps.material
    strength = stock.allowable(name, "yield_strength")
    ratio = stock.get(name, "poissons_ratio")
    if strength is None or ratio is None:
        out.skip("cap_factor", f"{name} has no yield strength or Poisson's ratio")
        return
    support = (g.cap_fit.plate_radius + g.cap_fit.radius) / 2
    stresses: dict[str, Array] = {}
    if design.double_rod:  # both end plates have the plug of a gland
        pass
    elif design.cylinder.end_stop == "internal" or clamped(design) or design.clevis is None:
        stresses["cap, supported at its edge"] = end_plate.hung_plate_stress(
            pressure=supply,
            loaded_radius=g.inner_radius,
            support_radius=support,
            thickness=g.plate,
            poissons_ratio=ratio,
        )
    if design.clevis is not None and design.cylinder.mount == "cap_clevis":
        hub = {"hub_radius": g.pin_diameter / 2, "thickness": g.plate, "poissons_ratio": ratio}
        stresses["cap, push on its neck"] = end_plate.hub_plate_stress(
            pressure=supply, edge_force=0.0, edge_radius=g.inner_radius, **hub
        )
        stresses["cap, pull on its neck"] = end_plate.hub_plate_stress(
            pressure=0.0, edge_force=supply * g.area_b, edge_radius=support, **hub
        )
    ends = joints_of(design)
    joints = {"head": ends[-1:], "cap": ends[:1]}
    for through in g.rods:
        slotted = any(end.joint.inner_skirt for end in joints[through.end])
        stress = end_plate.end_plate_stress(
            pressure=supply,
            radius=g.inner_radius,
            thickness=g.plate if slotted else g.plate + g.head_length,
            poissons_ratio=ratio,
        )
        stresses[through.gland] = HOLE * stress
    out.put("cap_factor", {place: strength / stress for place, stress in stresses.items()})


def _pins(
    stock: MaterialValues, design: Design, g: Geometry, push: Array, out: MetricArrays
) -> None:
    bearing = bearing_of(design)
    if bearing is None:
        out.skip("eye_bearing_factor", "no spherical bearing stated: add clevis.bearing")
    else:
        out.put("eye_bearing_factor", bearing.static_rating / push)
    if design.clevis is None:
        out.skip("pin_factor", "no clevis stated: add clevis")
        return
    strength = stock.allowable(design.clevis.material, "yield_strength")
    if strength is None:
        out.skip("pin_factor", f"{design.clevis.material} has no yield strength")
        return
    stress = retention.pin_shear_stress(force=push, diameter=g.pin_diameter)
    out.put("pin_factor", strength / sqrt(3) / stress)


def _guided(grooves: Sequence[Groove], length: Array) -> Array:
    """Length of piston or head that carries side load.

    It is the total width of the guide rings or, without guide rings, the part's length minus its
    grooves.
    """
    for groove in grooves:
        if groove.role == "guide":
            return groove.count * groove.width
    return length - groove_totals(grooves)[0]


def _guides(
    stock: MaterialValues, design: Design, g: Geometry, carried: Mapping[str, Array],
    out: MetricArrays,
) -> None:  # fmt: skip
    """Guide pressures of the glands and of the piston under the forces `carried`, by place."""
    out.put("bearing_overlap", g.bearing_span / g.rod_diameter)
    pressures = {
        through.gland: retention.bearing_pressure(
            force=carried[through.path],
            diameter=through.diameter,
            length=_guided(through.grooves, g.head_length + g.plate),
        )
        for through in g.rods
    } | {
        "piston": retention.bearing_pressure(
            force=carried["piston"],
            diameter=g.bore,
            length=_guided(g.piston_grooves, g.piston_length),
        ),
    }
    out.put("bearing_pressure", pressures)
    factors = {}
    for place in pressures:
        ends = (design.head, design.seals.rod)
        part, seal = (design.piston, design.seals.piston) if place == "piston" else ends
        bearing = part.bearing or part.material
        material = bearing if seal.guide is None else seal.guide.material
        allowed = stock.allowable(material, "bearing_strength")
        if allowed is None:
            out.skip("bearing_factor", f"{material} has no bearing strength")
            return
        loaded = real(pressures[place]) > 0
        pressure = where(loaded, pressures[place], 1.0 + 0 * pressures[place])
        factors[place] = where(loaded, allowed / pressure, float("inf"))
    out.put("bearing_factor", factors)
