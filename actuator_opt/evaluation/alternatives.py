"""What the barrel's wall could be instead: thicker or thinner, thin by theory, or of a metal.

Also how its growth settles beside the pressure step under the piston seal. Floats only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, isfinite, pi, sqrt

import numpy as np

from ..design.materials import load_library
from ..models import barrel, barrel_ends, laminate, liner, ply, yielding
from ..models.layered_tube import TubeLayer, layered_tube, tube_state
from ..numeric import Array
from . import wall_laminate
from .allow import Stock, allowances, extremes
from .geometry import Geometry
from .kernel import Pass, Subject
from .plies import Layer
from .values import Values
from .wall import Wall

METALS = ("steel_e355", "al_7075_t6")
"""The metal barrels set beside every wall: the usual honed steel tube, the usual light one."""

FACTORS = (0.8, 1.0, 1.25)
"""Bore growths for which a thickness is sought, over the present one."""

LARGEST = 2.0
"""Largest thickness sought, in bore radii."""


@dataclass(frozen=True, slots=True)
class Thickness:
    """Thickness [m] of one layer that brings the bore growth [m] to `factor` times the present.

    `mass_per_length` [kg/m] is the whole wall's then; both None where no thickness does it.
    """

    factor: float
    growth: float
    thickness: float | None
    mass_per_length: float | None


@dataclass(frozen=True, slots=True)
class Difference:
    """A wall quantity (SI) by the exact tube and by the thin laminate; None where unlimited."""

    name: str
    exact: float | None
    thin: float | None


@dataclass(frozen=True, slots=True)
class Settling:
    """How growth settles beside the pressure step under the piston seal.

    `decay_length` is 1/beta [m], `radius_ratio` mid-radius over thickness (thin shells above about
    5), `at_seal` the share of the far growth at the step, `shares` at distances into the pressure
    [m].
    """

    decay_length: float
    radius_ratio: float
    at_seal: float
    shares: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class MetalTube:
    """A barrel of the same bore for the same pressure; the first row is the design's own.

    Walls [m] that hold the growth and the burst pressure, None where none does; `thickness` is the
    larger one; `yield_factor` yield over supply pressure under the worse axial force.
    """

    material: str
    for_growth: float | None
    for_burst: float | None
    thickness: float | None
    mass_per_length: float | None
    yield_factor: float | None


def least(values: dict[str, Array]) -> float | None:
    """The smallest of some pressures; None where there is none."""
    found = [float(np.min(np.real(value))) for value in values.values()]
    usable = [value for value in found if isfinite(value)]
    return min(usable, default=None)


def governing_force(wall: Wall) -> float:
    """Axial force [N] at the largest bore growth: that of a load case, or none."""
    pushed = np.atleast_1d(np.squeeze(np.real(wall.swelling.growth_by_force * wall.path.cases)))
    worst = int(np.argmax(pushed))
    force = np.atleast_1d(np.squeeze(np.real(wall.path.cases)))
    return float(force[worst]) if pushed[worst] > 0 else 0.0


def mass_per_length(layers: Sequence[Layer], densities: Sequence[float], inner: float) -> float:
    """Mass of the wall per length [kg/m]."""
    total = 0.0
    for layer, density in zip(layers, densities, strict=True):
        outer = inner + float(layer.thickness)
        total += density * pi * (outer * outer - inner * inner)
        inner = outer
    return total


def main_layer(layers: Sequence[Layer], inner_radius: float) -> int:
    """The layer that carries the most hoop force; a ply before a liner."""
    tube = layered_tube(layers=[layer.as_tube() for layer in layers], inner_radius=inner_radius)
    carried = tube.wall[3] * (tube.outer - tube.inner)
    plies = [i for i, layer in enumerate(layers) if not layer.isotropic] or range(len(layers))
    return max(plies, key=lambda i: float(carried[i]))


def thicknesses(
    layers: Sequence[Layer],
    densities: Sequence[float],
    g: Geometry,
    *,
    pressure: float,
    force: float,
    index: int,
) -> tuple[Thickness, ...]:
    """Thickness of layer `index` for bore growths around the present one, by the exact tube."""
    inner = float(g.inner_radius)
    wall: list[TubeLayer] = [layer.as_tube() for layer in layers]
    present = tube_state(
        tube=layered_tube(layers=wall, inner_radius=inner),
        inner_pressure=pressure,
        axial_force=force,
    )
    growth = float(present.bore_displacement)
    rows = []
    for factor in FACTORS:
        row = Thickness(factor, factor * growth, None, None)
        try:
            found = float(
                liner.layer_thickness_for_strain(
                    layers=wall,
                    index=index,
                    inner_radius=inner,
                    strain=factor * growth / inner,
                    pressure=pressure,
                    axial_force_per_pressure=force / pressure,
                    largest_thickness=LARGEST * inner,
                )
            )
        except ValueError:  # no thickness reaches it: the row says so
            found = float("nan")
        if isfinite(found):
            changed = list(layers)
            changed[index] = replace(layers[index], thickness=found)
            mass = mass_per_length(changed, densities, inner)
            row = replace(row, thickness=found, mass_per_length=mass)
        rows.append(row)
    return tuple(rows)


def differences(
    subject: Subject, v: Values, stock: Stock, done: Pass, *, exact: bool
) -> tuple[Difference, ...]:
    """The wall by both laminate theories; `exact` says which one the design uses."""
    other = wall_laminate.compute(
        v, subject.design, stock, done.geometry, done.state, exact=not exact
    )
    pair = (done.wall, other) if exact else (other, done.wall)
    rows = [
        [float(np.max(np.real(wall.growth))) for wall in pair],
        [least(wall.yield_pressure) for wall in pair],
        [least(wall.first_ply_pressure) for wall in pair],
        [least(wall.burst_pressure) for wall in pair],
    ]
    names = ("bore_growth", "yield_pressure", "first_ply_pressure", "burst_pressure")
    return tuple(
        Difference(name, first, second)
        for name, (first, second) in zip(names, rows, strict=True)
        if first is not None or second is not None
    )


def settling(layers: Sequence[Layer], g: Geometry) -> Settling:
    """Decay length of the wall as a thin shell, and the growth it leaves beside the step."""
    turned = []
    for layer in layers:
        c = layer.constants
        stiffness = ply.ply_stiffness(
            youngs_modulus_1=c["youngs_modulus_1"],
            youngs_modulus_2=c["youngs_modulus_2"],
            poissons_ratio_12=c["poissons_ratio_12"],
            shear_modulus_12=c["shear_modulus_12"],
        )
        turned.append(ply.rotated(stiffness=stiffness, angle=layer.angle))
    sizes = [layer.thickness for layer in layers]
    axial, cross, hoop = laminate.membrane(plies=turned, thicknesses=sizes)
    middle = (g.inner_radius + g.outer_radius) / 2
    length = float(
        barrel_ends.shell_decay_length(
            radius=middle,
            hoop_stiffness=hoop - cross * cross / axial,
            bending_stiffness=laminate.bending_stiffness(plies=turned, thicknesses=sizes),
        )
    )

    def share(distance: float) -> float:
        return float(barrel_ends.pressure_step_factor(distance=distance, decay_length=length))

    return Settling(
        decay_length=length,
        radius_ratio=float(middle / sum(sizes)),
        at_seal=share(0.0),
        shares=tuple((k * length, share(k * length)) for k in (1.0, 2.0)),
    )


def metal_tubes(
    subject: Subject,
    layers: Sequence[Layer],
    densities: Sequence[float],
    done: Pass,
    *,
    pressure: float,
) -> tuple[MetalTube, ...]:
    """The design's wall, and a barrel of each of `METALS` for its growth and its burst pressure.

    Growth is compared without axial force; burst under every load path of the design.
    """
    inner = float(done.geometry.inner_radius)
    strain = pressure * float(np.squeeze(np.real(done.wall.swelling.growth))) / inner
    burst, flowing = least(done.wall.burst_pressure), least(done.wall.yield_pressure)
    whole = sum(float(layer.thickness) for layer in layers)
    mass = mass_per_length(layers, densities, inner)
    factor = None if flowing is None else flowing / pressure
    rows = [MetalTube(subject.design.name, None, None, whole, mass, factor)]
    for name in METALS:
        rows.append(_metal_tube(subject, name, done.wall, inner, pressure, strain, burst))
    return tuple(rows)


def _stock_of(subject: Subject, name: str) -> Stock:
    """One library metal with the knock-downs of this design's temperatures."""
    material = subject.materials.get(name) or load_library().get(name)
    numbers = {f"materials.{name}.{key}": value for key, value in material.numbers.items()}
    numbers |= {key: subject.numbers[key] for key in numbers if key in subject.numbers}
    environment = subject.design.environment
    factors = allowances(
        {name: material},
        numbers,
        temperatures=extremes(subject.design, subject.numbers),
        wet=environment is None or environment.wet,
    )
    return Stock(Values(numbers, ()), {name: material}, factors, {})


def _metal_tube(
    subject: Subject,
    name: str,
    wall: Wall,
    inner: float,
    pressure: float,
    strain: float,
    burst: float | None,
) -> MetalTube:
    """The thinnest tube of one metal for a bore strain and a burst pressure."""
    stock = _stock_of(subject, name)
    strength = stock.allowable(name, "yield_strength")
    ultimate = stock.allowable(name, "ultimate_strength")
    forces = [float(np.squeeze(np.real(area))) for area in wall.path.per_pressure.values()]
    try:
        growth = inner * (
            barrel.wall_ratio_for_strain(
                strain=strain,
                pressure=pressure,
                youngs_modulus=stock.get(name, "youngs_modulus"),
                poissons_ratio=stock.get(name, "poissons_ratio"),
                closed=False,
            )
            - 1
        )
    except ValueError:  # no wall of this metal is stiff enough
        return MetalTube(name, None, None, None, None, None)
    held = None
    if burst is not None:
        flow = strength * (2 - strength / ultimate)
        halves = [force / (2 * pi * inner * inner) for force in forces]
        worst = max(sqrt(1 - half + half * half) for half in halves)
        held = inner * (exp(burst * worst / flow) - 1)
    outer = inner + max(growth, held or 0.0)
    used = []
    for force in forces:
        hoop, radial, axial = barrel.bore_stresses(
            pressure=pressure, inner_radius=inner, outer_radius=outer, axial_force=pressure * force
        )
        stress = (hoop, radial, axial, 0.0)
        used.append(yielding.yield_utilisation(stress=stress, yield_strength=strength))
    mass = stock.get(name, "density") * pi * (outer * outer - inner * inner)
    return MetalTube(name, float(growth), held, outer - inner, mass, 1 / float(max(used)))
