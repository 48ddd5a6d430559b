"""The isotropic barrel: Lamé's thick cylinder, or the bore growth of the paper."""

from __future__ import annotations

from math import pi

from ...base.numeric import Array, maximum
from ...design.model import Design
from ...models import barrel, barrel_ends, column, rod, yielding
from ..allow import MaterialValues
from ..geometry import Geometry
from ..state import LoadState
from ..values import Values
from . import load_path
from .load_path import LoadPath, Swelling
from .wall import Cycle, Wall


def compute(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    *,
    as_published: bool,
) -> Wall:
    """Wall of a single isotropic layer."""
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
    path = load_path.derive(v, design, stock, g, state, swelling)
    supply = v["supply.pressure"]
    free = supply * swelling.growth
    if as_published:
        growth = barrel.bore_growth_as_published(pressure=supply, **size, **elastic)
    else:
        growth = maximum(free + swelling.growth_by_force * path.cases, free)
    driven = state.driven_pressure
    own = swelling.growth * driven
    outer, inner = 2 * g.outer_radius, 2 * g.inner_radius
    shear = modulus / (2 * (1 + ratio)) * area
    wall = Wall(
        swelling=swelling,
        path=path,
        growth=growth,
        case_growth=growth * (driven / supply)
        if as_published
        else maximum(own + swelling.growth_by_force * path.cases, own),
        bending_stiffness=modulus * rod.second_moment(outer_diameter=outer, inner_diameter=inner),
        shear_stiffness=shear
        * column.cowper_tube(poissons_ratio=ratio, radius_ratio=inner / outer),
        thin_ratio=(g.outer_radius - g.inner_radius) / g.inner_radius,
        layered=False,
        axial_line_stiffness=modulus * (g.outer_radius - g.inner_radius),
    )
    alpha = stock.get(name, "thermal_expansion", "thermal_expansion_2")
    if alpha is not None:
        wall.expansion = (alpha, alpha)
    _strengths(stock, name, g, path, supply, wall)
    return wall


def _strengths(
    stock: MaterialValues, name: str, g: Geometry, path: LoadPath, supply: Array, wall: Wall
) -> None:
    """Yield and burst pressures of every load path, and the stress of a pressure pulse."""
    size = {"inner_radius": g.inner_radius, "outer_radius": g.outer_radius}
    strength = stock.allowable(name, "yield_strength", "strength_1_tension")
    ultimate = stock.allowable(name, "ultimate_strength", "strength_1_tension")
    if strength is None:
        wall.missing.append(f"{name} has no yield or fibre strength")
        return
    for place, axial in path.per_pressure.items():
        used = _used(axial, path, size, strength)
        wall.yield_pressure[f"barrel, {place}"] = 1 / used
        span = supply * strength * _used(axial, path, size, strength, clamped=False)
        wall.cycles[f"barrel, {place}"] = Cycle(name, span, span / 2)
        if ultimate is not None:
            wall.burst_pressure[place] = barrel.burst_pressure_thick(
                **size,
                yield_strength=strength,
                ultimate_strength=ultimate,
                axial_force_ratio=axial / (pi * g.inner_radius * g.inner_radius),
            )


def _used(
    axial: Array,
    path: LoadPath,
    size: dict[str, Array],
    strength: Array,
    *,
    clamped: bool = True,
) -> Array:
    """1/yield pressure at the bore; with preload the stress at zero pressure is not zero."""
    hoop, radial, along = barrel.bore_stresses(pressure=1.0, axial_force=axial, **size)
    none = 0.0 * hoop
    residual = None
    if clamped and path.clamp is not None:
        _, _, clamp = barrel.bore_stresses(pressure=0.0, axial_force=path.held, **size)
        residual = (none, none, clamp, none)
    stress = (hoop, radial, along, none)
    return yielding.yield_utilisation(stress=stress, yield_strength=strength, residual=residual)
