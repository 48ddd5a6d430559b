"""Barrel wall of any model: results, response to unit loads, and the axial force in the wall.

The response of a laminated wall to unit pressure, unit axial force and unit temperature change
comes from the exact layered tube or from the fast thin laminate. Both give stresses for the faces
of the layers.

The axial force follows from mount, load direction, stop and tie rods. The barrel is never assumed
to be just open-ended or closed-ended. Tie rods clamp the barrel with their preload and carry
their share of the separating force. The default preload keeps the joint closed at proof pressure,
however the tightening scatters. The wall has the mean preload.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from functools import reduce
from math import pi

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import Array, array_of, maximum
from ...design.model import Design
from ...joints.joint import Clamp, Clamping
from ...models import barrel, barrel_ends, column, laminate, piston_nut, ply, rod
from ...models.autofrettage import Autofrettage
from ...models.layered_tube import layered_tube, ply_stresses_at_faces, tube_state
from ...models.strength import yield_utilisation
from ...models.strength_modes import Stress
from ..geometry import Geometry, Numbers, clamped, end_at, joints_of
from ..limits import MaterialValues
from ..plies import Climate, Layer, stress_of, warmings
from ..state import LoadState
from ..values import Values

NONE = "no axial load"
OWN = ""
"""Location of values with the axial force of each load case itself."""
STOP = "piston at the end stop"
LARGEST = "largest axial load"
RUPTURE = "axial rupture"
"""Start of the locations where the axial strength of the wall limits its burst pressure."""


@dataclass(frozen=True, slots=True)
class Swelling:
    """Response of the wall to pressure and axial force, far from its ends, (designs,).

    Without axial force, `growth` is the radial growth of the bore per unit pressure [m/Pa], and
    `shortening` the axial strain per unit pressure [1/Pa]. `stretch` is the axial strain per unit
    axial force [1/N]. By reciprocity, the growth per unit axial force is shortening/(2 pi r_i),
    with bore radius r_i.
    """

    growth: Array
    shortening: Array
    stretch: Array
    growth_by_force: Array


@dataclass(frozen=True, slots=True)
class LoadPath:
    """Axial forces in the barrel wall.

    A load path is a way in which pressure loads the wall: without axial force, or with the largest
    axial force. `per_pressure` is the force per unit pressure for each load path, (designs,) [m^2].
    `held` is the force at zero pressure [N]. `cases` are the forces in the load cases, including
    `held`, (cases, designs) [N]. `warmed` are the changes of `held` at the lowest and the highest
    temperature; empty if unknown. `share` is the barrel's share of a force that separates its ends.
    """

    per_pressure: dict[str, Array]
    held: Array
    cases: Array
    clamp: Clamp | None = None
    share: Array = 1.0
    warmed: tuple[Array, ...] = ()

    def held_in(self, count: int) -> Sequence[Array]:
        """Force at zero pressure in each of `count` climates [N].

        With two climates, these are the lowest and the highest temperature.
        """
        if len(self.warmed) != count:
            return [self.held] * count
        return [self.held + change for change in self.warmed]


def largest_area(design: Design, g: Geometry) -> Array:
    """Largest area on which supply pressure separates the ends; depends on end stop and mount."""
    if design.cylinder.end_stop == "internal":
        return maximum(g.area_a, g.area_b) if design.double_rod else g.area_a
    return g.area_b if design.cylinder.mount.startswith("cap") else g.area_a


def load_path(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    swelling: Swelling,
    expansion: Array | None = None,
) -> LoadPath:
    """Axial forces in a design's barrel wall, whose stiffness is given by `swelling`.

    `expansion` is its axial thermal expansion [1/K], None if unknown.
    """
    if design.cylinder.mount.startswith("cap"):
        cases = barrel_ends.axial_force_cap_mounted(
            rod_side_pressure=state.moving_b, rod_side_area=g.area_b, stop_force=0.0
        )
    else:
        cases = barrel_ends.axial_force_head_mounted(
            cap_side_pressure=state.moving_a, cap_side_area=g.area_a
        )
    area = np.atleast_1d(array_of(largest_area(design, g)))
    zero = 0.0 * area
    worst = {STOP if design.cylinder.end_stop == "internal" else LARGEST: area}
    if not clamped(design):
        return LoadPath({NONE: zero, **worst}, 0.0, cases)
    return _clamped(v, design, stock, g, state, swelling, expansion, worst, cases)


def clamping(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> Clamping:
    """The parts, such as tie rods, that clamp the barrel between both ends."""
    (end_joint,) = joints_of(design)
    assert end_joint.joint.clamping is not None
    return end_joint.joint.clamping(end_at(design, end_joint, Numbers(v, end_joint.path), g), stock)


def _clamped(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    swelling: Swelling,
    expansion: Array | None,
    worst: dict[str, Array],
    cases: Array,
) -> LoadPath:
    """Axial forces in a barrel between tie rods, as two preloaded springs in parallel.

    `worst` has one entry: the name of the load path with the largest axial force, and the area on
    which pressure separates the ends.
    """
    rods = clamping(v, design, stock, g)
    springs = {
        "barrel_stiffness": 1 / (swelling.stretch * g.barrel_length),
        "tie_rod_stiffness": rods.stiffness,
    }
    changes = _preload_changes(v, design, stock, g, rods, springs, expansion)
    supply = v["supply.pressure"]
    proof = v["supply.proof_ratio"] * supply
    slack = -swelling.shortening * g.barrel_length

    def forces_of(force: Array, pressure: Array) -> tuple[Array, Array]:
        return barrel_ends.tie_rod_forces(
            axial_force=force, preload=0.0, free_shortening=slack * pressure, **springs
        )

    ((name, area),) = worst.items()
    unit, _ = forces_of(area, 1.0)
    relaxed, _ = forces_of(0.0 * area, 1.0)
    settled = piston_nut.settling_loss(
        threads=2, seats=2, joints=2, compliance=sum(1 / spring for spring in springs.values())
    )
    scatter = piston_nut.preload_range(preload=1.0, tightening_factor=rods.tightening_factor)
    preload = v.get("retention.preload", None)
    if preload is None:
        least = proof * unit
        for change in changes.values():
            least = maximum(least, proof * unit - change)
        preload = (least + settled) / scatter[0]
    least, greatest = (preload * share for share in scatter)
    at = {"at assembly": 0.0, **changes}
    closed = {place: (least - settled + change) / (proof * unit) for place, change in at.items()}
    pressure = maximum(state.moving_a, state.moving_b)
    barrel, _ = forces_of(cases, pressure)
    return LoadPath(
        {NONE: relaxed, name: unit},
        -preload,
        barrel - preload,
        Clamp(preload, greatest, supply * (area - unit), closed, changes),
        springs["barrel_stiffness"] / (springs["barrel_stiffness"] + springs["tie_rod_stiffness"]),
        tuple(-change for change in changes.values()),
    )


def _preload_changes(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    rods: Clamping,
    springs: Mapping[str, Array],
    expansion: Array | None,
) -> dict[str, Array]:
    """Changes of the preload at the lowest and the highest temperature [N]; empty if unknown."""
    plate = stock.get(design.caps.material, "thermal_expansion")
    if expansion is None or plate is None or rods.growth is None:
        return {}
    return {
        word: barrel_ends.preload_change(
            temperature_change=warming,
            barrel_expansion=expansion,
            barrel_length=g.barrel_length,
            plate_expansion=plate,
            plate_thickness=g.plate,
            tie_rod_expansion=rods.growth,
            tie_rod_length=1.0,
            **springs,
        )
        for word, warming in warmings(v, design).items()
    }


SEAL_STEP = 0.5
"""Bore growth at a pressure step, as a share of the growth far inside the pressurised length;
from `barrel.pressure_step_factor(0)`."""


@dataclass(frozen=True, slots=True)
class Cycle:
    """Equivalent stress of a metal during a pressure pulse [Pa]: its range and mean."""

    material: str
    span: Array
    mean: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Plies:
    """Plies of the wall under its largest axial load, as input of a failure criterion.

    `layers` are all layers of the wall, and `rows` the indices of plies with known strengths.
    `load` is their stress per unit pressure, `residual` that at zero pressure, None if there is
    none; both are (faces, plies, climates, load paths, designs) or have axes of length 1.
    """

    criterion: str
    layers: Sequence[Layer]
    rows: Sequence[int]
    climates: Sequence[Climate]
    load: Stress
    residual: Stress | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Metal:
    """A metal layer of the wall under its largest axial load.

    `label` names the layer of index `layer`. `yields` are its yield strengths, by climate. `load`
    is its stress along, around and through the wall and its shear, per unit pressure, and
    `residual` that at zero pressure, None if there is none; axes as for `Plies`.
    """

    label: str
    layer: int
    material: str
    yields: Sequence[Array]
    climates: Sequence[Climate]
    load: Stress
    residual: Stress | None


@dataclass(frozen=True, slots=True)
class MetalTube:
    """A wall of one metal under its largest axial load, and its yield strength.

    `faces` are the stresses along, around and through the wall per unit pressure, at the bore and
    outside.
    """

    material: str
    strength: Array
    faces: tuple[tuple[Array, Array, Array], ...]


@dataclass(slots=True)
class Wall:
    """The wall of a design.

    The pressures at yield, first-ply failure and burst are dicts keyed by location (part, failure
    mode, load path), in Pa, (designs,). `cycles` are the stresses of metals under pulsating
    pressure, by location. `ply_fatigue` is the fatigue strength of fibres divided by their stress
    amplitude.

    `growths` are the bore growths at supply pressure by load path: with the axial force of the load
    cases, (cases, designs), and without axial force, (designs,). The larger governs. Each is a
    smooth limit of the optimiser, as an optimum may lie where both are equal. `case_growth` is the
    larger growth at the pressures of the load cases.
    `missing` names unknown strengths. `axial_line_stiffness` is axial modulus times thickness of
    the wall, N/m. After cool-down from cure, `mismatch` is yield strength divided by stress of the
    liner, and `bond` is bond strength divided by the tension between liner and plies. `plies` is
    None for a wall without plies of known strength. `metals` are layers of known yield strength;
    a wall of one metal has `tube` instead.
    """

    swelling: Swelling
    path: LoadPath
    growths: dict[str, Array]
    case_growth: Array
    bending_stiffness: Array
    shear_stiffness: Array
    thin_ratio: Array
    layered: bool
    axial_line_stiffness: Array
    expansion: tuple[Array, Array] | None = None
    warm_liner: Array | None = None
    """Axial stress per kelvin of warming of an innermost layer of metal [Pa/K]; None if unknown."""
    yield_pressure: dict[str, Array] = field(default_factory=dict)
    first_ply_pressure: dict[str, Array] = field(default_factory=dict)
    burst_pressure: dict[str, Array] = field(default_factory=dict)
    mismatch: dict[str, Array] = field(default_factory=dict)
    bond: dict[str, Array] = field(default_factory=dict)
    cycles: dict[str, Cycle] = field(default_factory=dict)
    ply_fatigue: dict[str, Array] = field(default_factory=dict)
    autofrettage: Autofrettage | None = None
    plies: Plies | None = None
    metals: list[Metal] = field(default_factory=list)
    tube: MetalTube | None = None
    why_no_mismatch: str = "the wall has a single material"
    missing: list[str] = field(default_factory=list)

    @property
    def growth(self) -> Array:
        """Bore growth at supply pressure, the largest of the load paths, (cases, designs) [m]."""
        return reduce(maximum, self.growths.values())


def metal_swelling(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    *,
    as_published: bool,
) -> Wall:
    """Calculate a barrel wall of a single isotropic layer."""
    name = design.barrel.layup[0].material
    modulus = stock.get(name, "youngs_modulus", "youngs_modulus_2")
    ratio = stock.get(name, "poissons_ratio", "poissons_ratio_12")
    size = {"inner_radius": g.inner_radius, "outer_radius": g.outer_radius}
    elastic = {"youngs_modulus": modulus, "poissons_ratio": ratio}
    area = pi * (g.outer_radius * g.outer_radius - g.inner_radius * g.inner_radius)
    shortening = -barrel_ends.pressure_shortening(pressure=1.0, length=1.0, **size, **elastic)
    swelling = Swelling(
        growth=barrel.bore_growth(pressure=1.0, axial_force=0.0, **size, **elastic),
        shortening=shortening,
        stretch=1 / (modulus * area),
        growth_by_force=shortening / (2 * pi * g.inner_radius),
    )
    alpha = stock.get(name, "thermal_expansion", "thermal_expansion_2")
    path = load_path(v, design, stock, g, state, swelling, alpha)
    supply = v["supply.pressure"]
    force_growth = swelling.growth_by_force * path.cases
    driven = state.driven_pressure
    if as_published:
        growth = barrel.bore_growth_as_published(pressure=supply, **size, **elastic)
        growths, case_growth = {OWN: growth}, growth * (driven / supply)
    else:
        free, driven_growth = supply * swelling.growth, driven * swelling.growth
        growths = {OWN: free + force_growth, NONE: free}
        case_growth = maximum(driven_growth + force_growth, driven_growth)
    outer, inner = 2 * g.outer_radius, 2 * g.inner_radius
    shear = modulus / (2 * (1 + ratio)) * area
    wall = Wall(
        swelling=swelling,
        path=path,
        growths=growths,
        case_growth=case_growth,
        bending_stiffness=modulus * rod.second_moment(outer_diameter=outer, inner_diameter=inner),
        shear_stiffness=shear
        * column.cowper_tube(poissons_ratio=ratio, radius_ratio=inner / outer),
        thin_ratio=(g.outer_radius - g.inner_radius) / g.inner_radius,
        layered=False,
        axial_line_stiffness=modulus * (g.outer_radius - g.inner_radius),
    )
    if alpha is not None:
        wall.expansion = (alpha, alpha)
    _strengths(stock, name, g, path, supply, wall)
    return wall


def _strengths(
    stock: MaterialValues, name: str, g: Geometry, path: LoadPath, supply: Array, wall: Wall
) -> None:
    """Compute yield and burst pressures without and with axial force, and the stress of a pulse."""
    size = {"inner_radius": g.inner_radius, "outer_radius": g.outer_radius}
    strength = stock.allowable(name, "yield_strength", "strength_1_tension")
    ultimate = stock.allowable(name, "ultimate_strength", "strength_1_tension")
    if strength is None:
        wall.missing.append(f"{name} has no yield or fibre strength")
        return
    axial = tuple(path.per_pressure.values())[-1]
    hoop, radial, along = barrel.bore_stresses(pressure=1.0, axial_force=axial, **size)
    wall.tube = MetalTube(
        name, strength, ((along, hoop, radial), (along, hoop + radial, 0.0 * radial))
    )
    for place, axial in path.per_pressure.items():
        utilisation = _utilisation(axial, path, size, strength)
        wall.yield_pressure[f"barrel, {place}"] = 1 / utilisation
        span = supply * strength * _utilisation(axial, path, size, strength, clamped=False)
        wall.cycles[f"barrel, {place}"] = Cycle(name, span, span / 2)
        if ultimate is not None:
            wall.burst_pressure[place] = barrel.burst_pressure_thick(
                **size,
                yield_strength=strength,
                ultimate_strength=ultimate,
                axial_force_ratio=axial / (pi * g.inner_radius * g.inner_radius),
            )


def _utilisation(
    axial: Array,
    path: LoadPath,
    size: dict[str, Array],
    strength: Array,
    *,
    clamped: bool = True,
) -> Array:
    """Reciprocal of the pressure at which the bore yields.

    If `clamped`, the stress that the preload of tie rods causes at zero pressure is included, at
    the temperature where it is worst.
    """
    hoop, radial, along = barrel.bore_stresses(pressure=1.0, axial_force=axial, **size)
    zero = 0.0 * hoop
    stress = (hoop, radial, along, zero)
    if not clamped or path.clamp is None:
        return yield_utilisation(stress=stress, yield_strength=strength)
    worst: Array = 0.0
    for change in (0.0, *path.warmed):
        _, _, clamp = barrel.bore_stresses(pressure=0.0, axial_force=path.held + change, **size)
        residual = (zero, zero, clamp, zero)
        worst = maximum(
            worst, yield_utilisation(stress=stress, yield_strength=strength, residual=residual)
        )
    return worst


PRESSURE, FORCE, WARMTH = range(3)
"""Indices of the unit loads in a `WallSolution`: pressure, axial force, temperature change."""


@dataclass(frozen=True, slots=True)
class WallSolution:
    """Response of the wall to unit loads; ply stresses are (faces, layers, loads, designs).

    The faces are the inner and outer face of each layer; a thin laminate has only its mid-radius.
    `walls` are the stiffnesses of the layers in tube axes, as `rod.layered_section` expects them.
    """

    stress: Stress
    growth: Array
    axial: Array
    warm_hoop: Array
    walls: Sequence[Sequence[Array]]


def exact_solution(layers: Sequence[Layer], g: Geometry) -> WallSolution:
    """Solve the exact layered tube under its three unit loads."""
    tube = layered_tube(layers=[layer.as_tube() for layer in layers], inner_radius=g.inner_radius)
    unit = np.eye(3)
    state = tube_state(
        tube=tube,
        inner_pressure=unit[PRESSURE][:, None],
        axial_force=unit[FORCE][:, None],
        temperature_change=unit[WARMTH][:, None],
    )
    stress = ply_stresses_at_faces(tube=tube, state=state)
    if tube.twisting:  # with twist, the two plies of a +/- pair have different stresses
        other = ply_stresses_at_faces(tube=tube, state=state, opposite=True)
        stress = stress_of([np.concatenate(pair) for pair in zip(stress, other, strict=True)])
    return WallSolution(
        stress=stress,
        growth=state.bore_displacement,
        axial=state.axial_strain,
        warm_hoop=state.hoop_strain[0, 0, WARMTH],
        walls=[[part[i] for part in tube.wall] for i in range(len(layers))],
    )


def thin_solution(layers: Sequence[Layer], g: Geometry) -> WallSolution:
    """Solve the thin laminate as a membrane: stresses at mid-radius, growth at the bore."""
    reduced, rotated, loads = [], [], []
    for layer in layers:
        stiffness = layer.plane_stiffness
        first, second = layer.expansions or (0.0, 0.0)
        reduced.append(stiffness)
        rotated.append(ply.rotated(stiffness=stiffness, angle=layer.angle))
        loads.append(
            ply.thermal_ply_load(
                stiffness=stiffness, angle=layer.angle, expansion_1=first, expansion_2=second
            )
        )
    thicknesses = [layer.thickness for layer in layers]
    sheet = laminate.membrane(plies=rotated, thicknesses=thicknesses)
    warm = laminate.thermal_line_forces(
        loads=loads, thicknesses=thicknesses, temperature_change=1.0
    )
    middle, zero = (g.inner_radius + g.outer_radius) / 2, 0.0 * np.atleast_1d(g.inner_radius)

    def strains(radius: Array) -> tuple[Array, Array]:
        return laminate.strains(
            membrane=sheet,
            axial_line_force=np.stack([zero, zero + 1 / (2 * pi * radius), zero + warm[0]]),
            hoop_line_force=np.stack([zero + radius, zero, zero + warm[1]]),
        )

    axial, hoop = strains(middle)
    unit = np.array([0.0, 0.0, 1.0])[:, None]
    rows = []
    for layer, stiffness in zip(layers, reduced, strict=True):
        first, second = layer.expansions or (0.0, 0.0)
        along, across, shear = ply.ply_stresses(
            stiffness=stiffness,
            angle=layer.angle,
            axial_strain=axial,
            hoop_strain=hoop,
            free_strain_1=first * unit,
            free_strain_2=second * unit,
        )
        radial = 0.0 * along
        if layer.isotropic:  # at the liner's bore the radial stress is exactly the pressure
            radial = radial - np.array([1.0, 0.0, 0.0])[:, None]
        rows.append(np.stack(np.broadcast_arrays(along, across, radial, shear)))

    near_axial, near_hoop = strains(g.inner_radius)
    return WallSolution(
        stress=stress_of(np.stack(rows, axis=1)[:, None]),
        growth=g.inner_radius * near_hoop,
        axial=near_axial,
        warm_hoop=hoop[WARMTH],
        walls=[(q[0], q[1], 0.0, q[2], 0.0, 1.0, q[5]) for q in rotated],
    )
