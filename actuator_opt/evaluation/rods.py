"""Section of the rod (a bar of one metal, or a layered tube), and bonds of its end fittings.

Only this module distinguishes bar and tube; all later code works with a `RodSection`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from math import pi

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, real, sqrt as root
from ..design.model import Design
from ..joints.joint import Thermal
from ..joints.overlap import Overlap, mismatch
from ..models import column, laminate, mass, rod
from ..models.layered_tube import (
    LayeredTube,
    TubeState,
    layered_tube,
    ply_stresses_at_faces,
    tube_state,
)
from ..models.rod import section_area
from ..models.shell_buckling import shell_modulus
from ..models.strength_modes import Stress
from . import plies
from .geometry import Geometry, RodThrough
from .limits import MaterialValues, MetricArrays
from .plies import Climate, Layer
from .values import Values

OUTSIDE, FORCE, WARMTH = range(3)
"""Indices of the unit loads in `RodSection.unit`: outside pressure, axial force, temperature
change."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RodSection:
    """Section of the rod, (designs,).

    The section has axial stiffness EA [N], bending stiffness EI [N m^2], shear stiffness kappa G A
    [N] and mass per length [kg/m]. `shell_modulus` and `shell_ratio` are Young's modulus and
    Poisson's ratio of an isotropic wall with the same local buckling load. `expansion` is the
    axial thermal expansion [1/K], None if not stated. A layered rod also has `unit`, the ply
    stresses at the inner and outer face of each layer under each unit load, (faces, layers, loads,
    designs).
    """

    outer_diameter: Array
    inner_diameter: Array
    hollow: bool
    axial_stiffness: Array
    bending_stiffness: Array
    shear_stiffness: Array
    mass_per_length: Array
    shell_modulus: Array
    shell_ratio: Array
    expansion: Array
    end_material: str
    layers: Sequence[Layer] = ()
    climates: Sequence[Climate] = ()
    unit: Stress | None = None
    missing: Sequence[str] = field(default_factory=list)

    @property
    def wall(self) -> Array:
        """Wall thickness of a hollow rod."""
        return (self.outer_diameter - self.inner_diameter) / 2

    @property
    def middle(self) -> Array:
        """Mid-radius of a hollow rod's wall."""
        return (self.outer_diameter + self.inner_diameter) / 4

    @property
    def cured(self) -> bool:
        """Whether the layers have residual stresses from cure."""
        return any(np.any(real(state.change)) for state in self.climates)

    @property
    def place(self) -> str:
        """Name of the section's model, used as a location in results; empty for a plain bar."""
        return "layered tube" if self.layers else ""


def end_material(design: Design) -> str:
    """The metal that the rod's threads are cut into."""
    fitting = design.rod.fitting
    return (fitting.material if fitting is not None else None) or design.rod.material


def derive(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> tuple[RodSection, ...]:
    """Derive the sections of a design's rods, in the order of `Geometry.rods`."""
    if design.rod.layup:  # refused with a second rod
        return (_tube(v, design, stock, g),)
    return tuple(_bar(v, design, stock, through) for through in g.rods)


def material_of(design: Design, through: RodThrough) -> str:
    """The material of a rod of one metal; that of the second rod is by default the rod's."""
    second = design.second_rod
    own = None if second is None or through.end == "head" else second.material
    return own or design.rod.material


def _hollow(v: Values, design: Design, through: RodThrough) -> bool:
    """Whether a rod of one metal has a bore, or may have one after an optimisation."""
    path, bore = f"{through.path}.inner_diameter", design.rod.inner_diameter
    if through.end == "cap" and path not in v:
        path = "rod.inner_diameter"
    elif through.end == "cap" and design.second_rod is not None:
        bore = design.second_rod.inner_diameter or 0.0
    return bore > 0 or path in design.variables or path in v.varied


def _bar(v: Values, design: Design, stock: MaterialValues, through: RodThrough) -> RodSection:
    """Section of a bar or tube of a single material."""
    name = material_of(design, through)
    modulus = stock.get(name, "youngs_modulus", "youngs_modulus_1")
    ratio = stock.get(name, "poissons_ratio", "poissons_ratio_12")
    size = {"outer_diameter": through.diameter, "inner_diameter": through.inner_diameter}
    area = rod.section_area(**size)
    shear = stock.get(name, "shear_modulus", default=modulus / (2 * (1 + ratio))) * area
    return RodSection(
        **size,
        hollow=_hollow(v, design, through),
        axial_stiffness=modulus * area,
        bending_stiffness=modulus * rod.second_moment(**size),
        shear_stiffness=shear
        * column.cowper_tube(
            poissons_ratio=ratio, radius_ratio=through.inner_diameter / through.diameter
        ),
        mass_per_length=mass.tube_mass(density=v[f"materials.{name}.density"], length=1.0, **size),
        shell_modulus=modulus,
        shell_ratio=ratio,
        expansion=stock.get(name, "thermal_expansion"),
        end_material=end_material(design) if through.end == "head" else name,
    )


def _tube(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> RodSection:
    """Section of a laminated rod, by the exact layered tube."""
    missing: list[str] = []
    states = plies.climates(v, design)
    layers = plies.layers(v, stock, design.rod.layup, "rod.layup", states, missing)
    expands = all(layer.expansions is not None for layer in layers)
    if not expands:
        states = tuple(replace(state, change=0.0) for state in states)
    tube = layered_tube(
        layers=[layer.as_tube() for layer in layers], inner_radius=g.rod_inner_diameter / 2
    )
    loads = np.eye(3)
    state = tube_state(
        tube=tube,
        outer_pressure=loads[OUTSIDE][:, None],
        axial_force=loads[FORCE][:, None],
        temperature_change=loads[WARMTH][:, None],
    )
    walls = [[part[i] for part in tube.wall] for i in range(len(layers))]
    bending, shear = rod.layered_section(
        walls=walls,
        thicknesses=[layer.thickness for layer in layers],
        inner_diameter=g.rod_inner_diameter,
    )
    stretch = state.axial_strain[FORCE]
    contraction = -state.hoop_strain[0, 0, FORCE] / stretch
    modulus, ratio = _shell(tube, layers)
    return RodSection(
        outer_diameter=g.rod_diameter,
        inner_diameter=g.rod_inner_diameter,
        hollow=True,
        axial_stiffness=1 / stretch,
        bending_stiffness=bending,
        shear_stiffness=shear
        * column.cowper_tube(
            poissons_ratio=contraction, radius_ratio=g.rod_inner_diameter / g.rod_diameter
        ),
        mass_per_length=_mass(v, design, g),
        shell_modulus=modulus,
        shell_ratio=ratio,
        expansion=state.axial_strain[WARMTH] if expands else None,
        end_material=end_material(design),
        layers=layers,
        climates=states,
        unit=_unit(tube, state),
        missing=missing,
    )


def _unit(tube: LayeredTube, state: TubeState) -> Stress:
    """Ply stresses at the inner and outer face of every layer.

    If the tube twists, they are given for both plies of a +/- pair.
    """
    plus = ply_stresses_at_faces(tube=tube, state=state)
    if not tube.twisting:
        return plus
    minus = ply_stresses_at_faces(tube=tube, state=state, opposite=True)
    return plies.stress_of([np.concatenate(both) for both in zip(plus, minus, strict=True)])


def _shell(tube: LayeredTube, layers: Sequence[Layer]) -> tuple[Array, Array]:
    """Young's modulus and Poisson's ratio of an isotropic wall with the same buckling load."""
    zz, zt, zr, tt, tr, rr, *_, ss = tube.wall
    sheet = [zz - zr * zr / rr, zt - zr * tr / rr, tt - tr * tr / rr]
    thicknesses = [layer.thickness for layer in layers]
    total = sum(thicknesses)
    axial, hoop, product = laminate.effective_moduli(
        membrane=laminate.membrane(
            plies=[[part[i] for part in sheet] for i in range(len(layers))],
            thicknesses=thicknesses,
        ),
        thickness=total,
    )
    ratio = root(product)
    modulus = shell_modulus(
        axial_modulus=axial,
        hoop_modulus=hoop,
        shear_modulus=sum(ss[i] * thickness for i, thickness in enumerate(thicknesses)) / total,
        poissons_ratio=ratio,
    )
    return modulus, ratio


def _mass(v: Values, design: Design, g: Geometry) -> Array:
    """Mass per length of the layers [kg/m]."""
    total: Array = 0.0
    bore = g.rod_inner_diameter
    for ply, thickness in zip(design.rod.layup, g.rod_thicknesses, strict=True):
        total = total + mass.tube_mass(
            density=v[f"materials.{ply.material}.density"],
            inner_diameter=bore,
            outer_diameter=bore + 2 * thickness,
            length=1.0,
        )
        bore = bore + 2 * thickness
    return total


def fittings(v: Values, stock: MaterialValues, design: Design, rod: RodSection) -> Overlap | str:
    """Bonds of the end fittings in a laminated rod, or the reason why there are no bonds."""
    fitting = design.rod.fitting
    if fitting is None:
        return "the rod has no bonded fittings"
    area = fitting_area(v, design, rod)
    around = pi * rod.inner_diameter
    return Overlap(
        adhesive=fitting.adhesive,
        diameter=rod.inner_diameter,
        length=v["rod.fitting.length"],
        tube=rod.axial_stiffness / around,
        metal=stock.get(rod.end_material, "youngs_modulus") * area / around,
        mismatch=mismatch(stock, rod.end_material, rod.expansion),
        names=("tube", "fitting"),
    )


def fitting_hole(v: Values, design: Design, rod: RodSection) -> Array:
    """Inner diameter of a fitting; zero for a solid plug, or if its wall fills the rod's bore."""
    if design.rod.fitting is None or design.rod.fitting.wall is None:
        return 0.0 * rod.inner_diameter
    return maximum(rod.inner_diameter - 2 * v["rod.fitting.wall"], 0.0)


def fitting_area(v: Values, design: Design, rod: RodSection) -> Array:
    """Cross-section area of a fitting in the bonded overlap."""
    return section_area(
        outer_diameter=rod.inner_diameter, inner_diameter=fitting_hole(v, design, rod)
    )


def thermal(
    v: Values, design: Design, bonds: Mapping[str, Thermal | str], out: MetricArrays
) -> None:
    """Compute bond strength divided by the shear at the bond's edge that temperature alone causes.

    It is computed at the lowest and the highest temperature; the temperature change is that since
    joining. `bonds` are the bonded overlaps by location; a string is the reason for a missing bond.
    """
    metric = "bond_thermal_factor"
    if design.environment is None:
        out.skip(metric, "no temperature range stated: add environment")
        return
    factors = {}
    for place, factor in bonds.items():
        if isinstance(factor, str):
            continue
        for word, warming in plies.warmings(v, design).items():
            factors[f"{place}, {word}"] = factor(warming, word == "cold")
    if factors:
        out.put(metric, factors)
    else:
        out.skip(metric, next(why for why in bonds.values() if isinstance(why, str)))
