"""The barrel in an evaluation: growth, strength pressures, bending stiffness, thermal strain.

This is the one place that chooses between the isotropic and the laminated tube; everything after
it works with a `Wall`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np

from ..design.material import Material
from ..design.model import Design
from ..models import barrel, barrel_ends, laminate, ply, ply_discount, rod, strength_modes
from ..models.strength_modes import PlyStrength
from ..numeric import Array, maximum, minimum
from .allow import Stock
from .geometry import Geometry
from .state import State
from .values import Values

SEAL_STEP = 0.5
"""Share of the far-field growth that acts at a pressure step, `barrel.pressure_step_factor(0)`."""

_STRENGTHS = (
    "strength_1_tension",
    "strength_1_compression",
    "strength_2_tension",
    "strength_2_compression",
    "strength_12",
)


@dataclass(slots=True)
class Wall:
    """What the barrel's wall does. Pressures by place (part, mode, load path), Pa, (designs,).

    `yields` names the material behind each yield pressure, `missing` the strengths nobody states;
    `axial_line_stiffness` is E t of the wall along the axis, N/m.
    """

    growth: Array
    bending_stiffness: Array
    thin_ratio: Array
    expansion: tuple[Array, Array] | None = None
    yield_pressure: dict[str, Array] = field(default_factory=dict)
    first_ply_pressure: dict[str, Array] = field(default_factory=dict)
    burst_pressure: dict[str, Array] = field(default_factory=dict)
    axial_line_stiffness: Array = 0.0
    yields: dict[str, str] = field(default_factory=dict)
    mismatch: Array | None = None
    why_no_mismatch: str = "the wall is of one material"
    missing: list[str] = field(default_factory=list)


def kind(design: Design, materials: Mapping[str, Material]) -> str:
    """Which wall model a design uses: isotropic, as_published or thin_laminate."""
    if design.barrel.model != "auto":
        return design.barrel.model
    single = len(design.barrel.layup) == 1
    return (
        "isotropic"
        if single and materials[design.barrel.layup[0].material].isotropic
        else "thin_laminate"
    )


def axial_forces(design: Design, state: State, geometry: Geometry) -> Array:
    """Axial force in the barrel wall in every case, from the mount (cases, designs).

    Tie rods are taken to carry all of it (preload and share are not modelled yet).
    """
    if design.retention is not None and design.retention.type == "tie_rods":
        return 0.0 * state.moving_a
    if design.cylinder.mount.startswith("cap"):
        return barrel_ends.axial_force_cap_mounted(
            rod_side_pressure=state.moving_b, rod_side_area=geometry.area_b, stop_force=0.0
        )
    return barrel_ends.axial_force_head_mounted(
        cap_side_pressure=state.moving_a, cap_side_area=geometry.area_a
    )


def _load_paths(v: Values, design: Design, state: State, geometry: Geometry) -> dict[str, Array]:
    """Axial force per pressure the wall must survive, by name: none, and the largest it can see.

    With an internal end stop the piston at the head under supply pressure pulls p A_A through the
    wall; otherwise the largest of the cases. Arrays are (designs,).
    """
    none = 0.0 * np.atleast_1d(np.asarray(geometry.area_a))
    paths: dict[str, Array] = {"no axial load": none}
    if design.retention is not None and design.retention.type == "tie_rods":
        return paths
    if design.cylinder.end_stop == "internal":
        paths["piston at the end stop"] = none + geometry.area_a
        return paths
    worst: Array = none
    for row in axial_forces(design, state, geometry) + none:
        worst = maximum(worst, row)
    paths["largest axial load"] = worst / v["supply.pressure"]
    return paths


def compute(v: Values, design: Design, stock: Stock, geometry: Geometry, state: State) -> Wall:
    """The wall of a design under its supply pressure."""
    model = kind(design, stock.materials)
    if model == "thin_laminate":
        return _laminate(v, design, stock, geometry, state)
    return _isotropic(v, design, stock, geometry, state, as_published=model == "as_published")


def _isotropic(
    v: Values, design: Design, stock: Stock, g: Geometry, state: State, *, as_published: bool
) -> Wall:
    name = design.barrel.layup[0].material
    modulus = stock.get(name, "youngs_modulus", "youngs_modulus_2")
    ratio = stock.get(name, "poissons_ratio", "poissons_ratio_12")
    size = {"inner_radius": g.inner_radius, "outer_radius": g.outer_radius}
    elastic = {"youngs_modulus": modulus, "poissons_ratio": ratio}
    supply = v["supply.pressure"]
    if as_published:
        growth = barrel.bore_growth_as_published(pressure=supply, **size, **elastic)
    else:
        growth = maximum(
            barrel.bore_growth(
                pressure=supply, axial_force=axial_forces(design, state, g), **size, **elastic
            ),
            barrel.bore_growth(pressure=supply, axial_force=0.0, **size, **elastic),
        )
    wall = Wall(
        growth=growth,
        bending_stiffness=modulus
        * rod.second_moment(outer_diameter=2 * g.outer_radius, inner_diameter=g.bore),
        thin_ratio=(g.outer_radius - g.inner_radius) / g.inner_radius,
        axial_line_stiffness=modulus * (g.outer_radius - g.inner_radius),
    )
    alpha = stock.get(name, "thermal_expansion", "thermal_expansion_2")
    if alpha is not None:
        wall.expansion = (alpha, alpha)
    strength = stock.allowable(name, "yield_strength", "strength_1_tension")
    ultimate = stock.allowable(name, "ultimate_strength", "strength_1_tension")
    for path, axial in _load_paths(v, design, state, g).items():
        if strength is not None:
            hoop, radial, along = barrel.bore_stresses(pressure=1.0, axial_force=axial, **size)
            mises = barrel.von_mises(hoop=hoop, radial=radial, axial=along)
            wall.yield_pressure[f"barrel, {path}"] = strength / mises
            wall.yields[f"barrel, {path}"] = name
        if strength is not None and ultimate is not None:
            wall.burst_pressure[path] = barrel.burst_pressure_thick(
                **size,
                yield_strength=strength,
                ultimate_strength=ultimate,
                axial_force_ratio=axial / (pi * g.inner_radius * g.inner_radius),
            )
    if strength is None:
        wall.missing.append(f"{name} states no yield or fibre strength")
    return wall


@dataclass(frozen=True, slots=True)
class _Layer:
    label: str
    name: str
    isotropic: bool
    constants: dict[str, Array]
    stiffness: tuple[Array, ...]
    rotated: tuple[Array, ...]
    angle: Array
    thickness: Array
    strength: PlyStrength | None
    yield_strength: Array | None

    def as_wall(self) -> ply_discount.WallLayer:
        """The layer as the burst model takes it."""
        return ply_discount.WallLayer(
            youngs_modulus_1=self.constants["youngs_modulus_1"],
            youngs_modulus_2=self.constants["youngs_modulus_2"],
            poissons_ratio_12=self.constants["poissons_ratio_12"],
            shear_modulus_12=self.constants["shear_modulus_12"],
            thickness=self.thickness,
            angle=self.angle,
            strength=self.strength,
            yield_strength=self.yield_strength,
            material=self.name,
        )


def _layers(v: Values, design: Design, stock: Stock, g: Geometry, wall: list[str]) -> list[_Layer]:
    layers = []
    for i, entry in enumerate(design.barrel.layup):
        name = entry.material
        constants = stock.ply_constants(name)
        stiffness = ply.ply_stiffness(
            youngs_modulus_1=constants["youngs_modulus_1"],
            youngs_modulus_2=constants["youngs_modulus_2"],
            poissons_ratio_12=constants["poissons_ratio_12"],
            shear_modulus_12=constants["shear_modulus_12"],
        )
        angle = v[f"barrel.layup[{i}].angle"]
        isotropic = stock.material(name).isotropic
        strength = None
        yields = None
        if isotropic:
            yields = stock.allowable(name, "yield_strength", "ultimate_strength")
            if yields is None:
                wall.append(f"{name} states no yield strength")
        else:
            values = [stock.allowable(name, key) for key in _STRENGTHS]
            if all(value is not None for value in values):
                strength = PlyStrength(*values)
            else:
                wall.append(f"{name} lacks ply strengths")
        layers.append(
            _Layer(
                label=f"layup[{i}] {name}",
                name=name,
                isotropic=isotropic,
                constants=constants,
                stiffness=stiffness,
                rotated=ply.rotated(stiffness=stiffness, angle=angle),
                angle=angle,
                thickness=g.thicknesses[i],
                strength=strength,
                yield_strength=yields,
            )
        )
    return layers


def _laminate(v: Values, design: Design, stock: Stock, g: Geometry, state: State) -> Wall:
    missing: list[str] = []
    layers = _layers(v, design, stock, g, missing)
    thicknesses = list(g.thicknesses)
    stack = laminate.membrane(plies=[layer.rotated for layer in layers], thicknesses=thicknesses)
    supply = v["supply.pressure"]
    size = {"inner_radius": g.inner_radius, "membrane": stack}
    growth = maximum(
        laminate.bore_growth_thin(
            pressure=supply, axial_force=axial_forces(design, state, g), **size
        ),
        laminate.bore_growth_thin(pressure=supply, axial_force=0.0, **size),
    )
    bending: Array = 0.0
    radius = g.inner_radius
    for layer in layers:
        modulus = layer.rotated[0] - layer.rotated[1] * layer.rotated[1] / layer.rotated[2]
        bending = bending + modulus * rod.second_moment(
            outer_diameter=2 * (radius + layer.thickness), inner_diameter=2 * radius
        )
        radius = radius + layer.thickness
    wall = Wall(
        growth=growth,
        bending_stiffness=bending,
        thin_ratio=(g.outer_radius - g.inner_radius) / g.inner_radius,
        axial_line_stiffness=stack[0] - stack[1] * stack[1] / stack[2],
        missing=missing,
    )
    _thermal(v, design, layers, stack, thicknesses, wall)
    middle = (g.inner_radius + g.outer_radius) / 2
    paths = _load_paths(v, design, state, g)
    _strengths(layers, stack, middle, tuple(paths), np.stack(list(paths.values())), wall)
    return wall


def _strengths(
    layers: list[_Layer],
    stack: laminate.Membrane,
    middle: Array,
    paths: tuple[str, ...],
    axial: Array,
    wall: Wall,
) -> None:
    """Yield, first-ply and burst pressures of every load path, thin laminate at mid-radius.

    `axial` is the axial force per pressure, (paths, designs).
    """

    def put(table: dict[str, Array], label: str, pressures: Array) -> None:
        for path, pressure in zip(paths, pressures, strict=True):
            table[f"{label}{path}"] = pressure

    strain = laminate.strains(
        membrane=stack, axial_line_force=axial / (2 * pi * middle), hoop_line_force=middle
    )
    ladder = ply_discount.burst_by_ply_discount(
        layers=[layer.as_wall() for layer in layers],
        radius=middle,
        axial_force_per_pressure=axial,
    )
    pressures = strength_modes.load_multiplier(ladder.intact)
    for (index, mode), pressure in zip(ladder.modes(), pressures, strict=True):
        layer = layers[index]
        if mode == "yield" and layer.yield_strength is not None:
            put(wall.yield_pressure, f"{layer.label}, ", _yield_at_bore(layer, strain))
            wall.yields |= {f"{layer.label}, {path}": layer.name for path in paths}
        elif layer.strength is not None:
            label = f"{layer.label} {mode}, "
            known = wall.first_ply_pressure.get(label + paths[0])
            if known is not None:  # shear of either sign
                earlier = [wall.first_ply_pressure[label + path] for path in paths]
                pressure = [minimum(a, b) for a, b in zip(earlier, pressure, strict=True)]
            put(wall.first_ply_pressure, label, pressure)
    if wall.missing:
        return
    if all(layer.isotropic for layer in layers):
        wall.missing.append("burst of a wall of several metals needs the exact tube")
        return
    put(wall.burst_pressure, "", ladder.burst_pressure)
    if any(layer.isotropic for layer in layers):
        label = "first ply with the liner yielding, "
        put(wall.first_ply_pressure, label, ladder.first_ply_pressure)


def _yield_at_bore(layer: _Layer, strain: tuple[Array, Array]) -> Array:
    """Yield pressure of a metal layer under the wall's strain per pressure.

    The pressure itself is taken as the layer's radial stress, which is exact at the bore.
    """
    stress_1, stress_2, _ = ply.ply_stresses(
        stiffness=layer.stiffness,
        angle=layer.angle,
        axial_strain=strain[0],
        hoop_strain=strain[1],
    )
    return layer.yield_strength / barrel.von_mises(hoop=stress_1, radial=-1.0, axial=stress_2)


def _thermal(
    v: Values,
    design: Design,
    layers: list[_Layer],
    stack: laminate.Membrane,
    thicknesses: list[Array],
    wall: Wall,
) -> None:
    """Free thermal strain of the wall per kelvin, and liner yield over its mismatch stress."""
    expansions = []
    for layer in layers:
        first = layer.constants.get("thermal_expansion_1")
        second = layer.constants.get("thermal_expansion_2")
        if first is None or second is None:
            wall.why_no_mismatch = f"{layer.name} states no thermal expansion"
            return
        expansions.append((first, second))
    loads = [
        ply.thermal_ply_load(
            stiffness=layer.stiffness, angle=layer.angle, expansion_1=first, expansion_2=second
        )
        for layer, (first, second) in zip(layers, expansions, strict=True)
    ]
    axial, hoop = laminate.thermal_line_forces(
        loads=loads, thicknesses=thicknesses, temperature_change=1.0
    )
    strain = laminate.strains(membrane=stack, axial_line_force=axial, hoop_line_force=hoop)
    wall.expansion = strain
    environment = design.environment
    liners = [i for i, layer in enumerate(layers) if layer.yield_strength is not None]
    if not liners or len(liners) == len(layers):
        wall.why_no_mismatch = "the wall has no liner under plies"
        return
    if environment is None or environment.cure_temperature is None:
        wall.why_no_mismatch = "no cure temperature stated: add environment.cure_temperature"
        return
    i = liners[0]
    stress_1, stress_2, _ = ply.ply_stresses(
        stiffness=layers[i].stiffness,
        angle=layers[i].angle,
        axial_strain=strain[0],
        hoop_strain=strain[1],
        free_strain_1=expansions[i][0],
        free_strain_2=expansions[i][1],
    )
    change = v["environment.cure_temperature"] - v["environment.temperature_min"]
    mises = barrel.von_mises(hoop=stress_1, radial=0.0, axial=stress_2) * change
    wall.mismatch = layers[i].yield_strength / mises
