"""Alternatives to the barrel wall: other thicknesses, thin-wall theory, metal.

The module also computes bore growth near the pressure step under the piston seal. All values are
plain floats.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import e, isfinite, pi

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..design.materials import load_library
from ..models import barrel, barrel_ends, laminate, liner, ply
from ..models.layered_tube import layered_tube, tube_state
from .barrel import Wall, laminate as laminated
from .geometry import Geometry
from .kernel import ModelRun, PreparedDesign
from .limits import MaterialValues, allowances, extremes
from .plies import Layer
from .values import Values

METALS = ("steel_e355", "al_7075_t6")
"""Metals with which every wall is compared: a common honed steel tube and a common light alloy."""
FACTORS = (0.8, 1.25)
"""Bore growths for which a layer thickness is computed, as multiples of the actual growth."""
LARGEST = 2.0
"""Largest thickness of a layer in the search, as a multiple of the bore radius."""


@dataclass(frozen=True, slots=True)
class Thickness:
    """Thickness [m] of a layer with which the bore growth [m] is `factor` times the actual growth.

    `mass_per_length` [kg/m] is the mass of the whole wall. Thickness and mass are None if no
    thickness gives this growth.
    """

    factor: float
    growth: float
    thickness: float | None
    mass_per_length: float | None


@dataclass(frozen=True, slots=True)
class Difference:
    """A quantity of the wall (SI) by the exact tube and by the thin laminate; None if infinite."""

    name: str
    exact: float | None
    thin: float | None


@dataclass(frozen=True, slots=True)
class Settling:
    """Bore growth near the pressure step under the piston seal.

    `decay_length` is the length 1/beta of shell theory [m]. `radius_ratio` is mid-radius divided by
    thickness; thin-shell theory applies above about 5. `at_seal` is the growth at the step, as a
    share of the growth far from it. Each pair in `shares` has a distance from the step
    into the pressurised length [m], and the growth at this distance, also as a share.
    """

    decay_length: float
    radius_ratio: float
    at_seal: float
    shares: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class MetalBarrel:
    """A metal barrel for the design's bore and pressure; or, without `material`, the design's wall.

    `for_growth` and `for_burst` are the wall thicknesses [m] that bore growth and burst pressure
    require; None if no thickness suffices or if there is no requirement. `thickness` is the larger
    of the two. `growth` [m] is that at supply pressure without axial force. Burst and yield
    pressures [Pa] are the lower of the values without and with axial force.
    """

    material: str
    for_growth: float | None
    for_burst: float | None
    thickness: float | None = None
    growth: float | None = None
    burst_pressure: float | None = None
    yield_pressure: float | None = None
    mass_per_length: float | None = None


def single(value: Array) -> float:
    """Return the only number in the array of a single design."""
    return float(np.squeeze(np.real(value)))


def least(pressures: Mapping[str, Array]) -> tuple[float | None, str]:
    """The smallest finite pressure and its location; None if no pressure is finite."""
    values = {place: single(value) for place, value in pressures.items()}
    usable = {place: value for place, value in values.items() if isfinite(value)}
    if not usable:
        return None, ""
    place = min(usable, key=lambda name: usable[name])
    return usable[place], place


def governing_force(wall: Wall) -> float:
    """Axial force [N] for which bore growth is largest: that of a load case, or zero."""
    pushed = np.atleast_1d(np.squeeze(np.real(wall.swelling.growth_by_force * wall.path.cases)))
    worst = int(np.argmax(pushed))
    force = np.atleast_1d(np.squeeze(np.real(wall.path.cases)))
    return float(force[worst]) if pushed[worst] > 0 else 0.0


def mass_per_length(layers: Sequence[Layer], densities: Sequence[float], inner: float) -> float:
    """Mass per length of the wall [kg/m]."""
    total = 0.0
    for layer, density in zip(layers, densities, strict=True):
        outer = inner + float(layer.thickness)
        total += density * pi * (outer * outer - inner * inner)
        inner = outer
    return total


def main_layer(layers: Sequence[Layer], inner_radius: float) -> int:
    """Index of the layer with the largest hoop force; if there are plies, metals do not count."""
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
    """Thickness of layer `index` for each bore growth in `FACTORS`, by the exact tube."""
    inner = float(g.inner_radius)
    wall = [layer.as_tube() for layer in layers]
    tube = layered_tube(layers=wall, inner_radius=inner)
    state = tube_state(tube=tube, inner_pressure=pressure, axial_force=force)
    growth = float(state.bore_displacement)

    def solve(factors: Sequence[float]) -> list[float | None]:
        try:
            solution = liner.layer_thickness_for_strain(
                layers=wall,
                index=index,
                inner_radius=inner,
                strain=np.array(factors) * growth / inner,
                pressure=pressure,
                axial_force_per_pressure=force / pressure,
                largest_thickness=LARGEST * inner,
            )
        except ValueError:  # at least one growth is out of reach: find which
            return (
                [x for factor in factors for x in solve([factor])] if len(factors) > 1 else [None]
            )
        return [float(value) for value in solution]

    rows = []
    known_thicknesses = (float(layers[index].thickness), *solve(FACTORS))
    for factor, thickness in zip((1.0, *FACTORS), known_thicknesses, strict=True):
        mass = None
        if thickness is not None:
            changed = list(layers)
            changed[index] = replace(layers[index], thickness=thickness)
            mass = mass_per_length(changed, densities, inner)
        rows.append(Thickness(factor, factor * growth, thickness, mass))
    return tuple(sorted(rows, key=lambda row: row.factor))


def differences(
    subject: PreparedDesign, v: Values, stock: MaterialValues, run: ModelRun, *, exact: bool
) -> tuple[Difference, ...]:
    """Compare the results of both laminate theories for the wall.

    `exact` states whether the design uses the exact tube.
    """
    other = laminated.compute(v, subject.design, stock, run.geometry, run.state, exact=not exact)
    pair = (run.wall, other) if exact else (other, run.wall)
    growths = [float(np.max(np.real(wall.growth))) for wall in pair]
    rows = [Difference("bore_growth", *growths)]
    for name in ("yield_pressure", "first_ply_pressure", "burst_pressure"):
        pressures = [least(getattr(wall, name))[0] for wall in pair]
        if pressures != [None, None]:
            rows.append(Difference(name, *pressures))
    return tuple(rows)


def settling(layers: Sequence[Layer], g: Geometry) -> Settling:
    """Decay length of the wall as a thin shell, and bore growth near the pressure step."""
    stiffnesses = []
    for layer in layers:
        stiffnesses.append(ply.rotated(stiffness=layer.plane_stiffness, angle=layer.angle))
    layer_thicknesses = [layer.thickness for layer in layers]
    axial, cross, hoop = laminate.membrane(plies=stiffnesses, thicknesses=layer_thicknesses)
    middle = (g.inner_radius + g.outer_radius) / 2
    decay_length = float(
        barrel_ends.shell_decay_length(
            radius=middle,
            hoop_stiffness=hoop - cross * cross / axial,
            bending_stiffness=laminate.bending_stiffness(
                plies=stiffnesses, thicknesses=layer_thicknesses
            ),
        )
    )

    def share(distance: float) -> float:
        return float(barrel_ends.pressure_step_factor(distance=distance, decay_length=decay_length))

    return Settling(
        decay_length=decay_length,
        radius_ratio=float(middle / sum(layer_thicknesses)),
        at_seal=share(0.0),
        shares=tuple((k * decay_length, share(k * decay_length)) for k in (1.0, 2.0)),
    )


def metal_tubes(
    subject: PreparedDesign,
    v: Values,
    layers: Sequence[Layer],
    densities: Sequence[float],
    run: ModelRun,
) -> tuple[MetalBarrel, ...]:
    """The wall of the design, and the thinnest barrel for the same limits from each of `METALS`.

    The limits are the bore growth of the design's wall without axial force, and the required burst
    pressure, which a wall must reach without and with axial force. If the design's wall has a lower
    burst pressure, or if the burst check is waived, its burst pressure is the requirement.
    """
    wall, inner, pressure = run.wall, float(run.geometry.inner_radius), v["supply.pressure"]
    burst = least(wall.burst_pressure)[0]
    own = MetalBarrel(
        material="",
        for_growth=None,
        for_burst=None,
        thickness=sum(float(layer.thickness) for layer in layers),
        growth=pressure * single(wall.swelling.growth),
        burst_pressure=burst,
        yield_pressure=least(wall.yield_pressure)[0],
        mass_per_length=mass_per_length(layers, densities, inner),
    )
    if burst is not None and "burst_factor" not in subject.design.waivers:
        burst = min(burst, pressure * v["requirements.burst_factor.min"])
    strain = pressure * single(wall.swelling.growth) / inner
    forces = [single(area) for area in wall.path.per_pressure.values()]
    return (
        own,
        *(
            metal_tube(
                _stock_of(subject, name),
                name,
                inner_radius=inner,
                pressure=pressure,
                strain=strain,
                burst_pressure=burst,
                axial_forces_per_pressure=forces,
            )
            for name in METALS
        ),
    )


def _stock_of(subject: PreparedDesign, name: str) -> MaterialValues:
    """A library metal with its strengths after knock-downs for this design's temperatures."""
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
    return MaterialValues(Values(numbers, ()), {name: material}, factors, {})


def metal_tube(
    stock: MaterialValues,
    name: str,
    *,
    inner_radius: float,
    pressure: float,
    strain: float,
    burst_pressure: float | None,
    axial_forces_per_pressure: Sequence[float],
) -> MetalBarrel:
    """The thinnest tube of a metal that meets limits of bore strain and burst pressure.

    `strain` is the largest bore strain without axial force, `burst_pressure` the required burst
    pressure.
    """
    inner, density = inner_radius, stock.get(name, "density")
    elastic = {
        "youngs_modulus": stock.get(name, "youngs_modulus"),
        "poissons_ratio": stock.get(name, "poissons_ratio"),
    }
    strength = stock.allowable(name, "yield_strength")
    ultimate = stock.allowable(name, "ultimate_strength")
    if strength is None or ultimate is None:  # a user material with this name
        return MetalBarrel(name, None, None)
    strengths = {"yield_strength": strength, "ultimate_strength": ultimate}
    ratios = [force / (pi * inner * inner) for force in axial_forces_per_pressure]
    for_burst = None
    if burst_pressure is not None:  # Faupel's pressure is proportional to the logarithm of k
        unit = {"inner_radius": 1.0, "outer_radius": e} | strengths
        least_flow = min(
            float(barrel.burst_pressure_thick(**unit, axial_force_ratio=ratio)) for ratio in ratios
        )
        for_burst = float(inner * np.expm1(burst_pressure / least_flow))
    try:
        wall_ratio = barrel.wall_ratio_for_strain(
            strain=strain, pressure=pressure, closed=False, **elastic
        )
    except ValueError:  # no wall of this metal is stiff enough, however thick
        return MetalBarrel(name, None, for_burst)
    for_growth = float(inner * (wall_ratio - 1))
    thickness = max(for_growth, for_burst or 0.0)
    size = {"inner_radius": inner, "outer_radius": inner + thickness}
    yields, bursts = [], []
    for force, ratio in zip(axial_forces_per_pressure, ratios, strict=True):
        hoop, radial, axial = barrel.bore_stresses(pressure=1.0, axial_force=force, **size)
        mises = barrel.von_mises(hoop=hoop, radial=radial, axial=axial)
        yields.append(float(strength / mises))
        bursts.append(barrel.burst_pressure_thick(**size, **strengths, axial_force_ratio=ratio))
    area = pi * (size["outer_radius"] * size["outer_radius"] - inner * inner)
    return MetalBarrel(
        material=name,
        for_growth=for_growth,
        for_burst=for_burst,
        thickness=thickness,
        growth=float(barrel.bore_growth(pressure=pressure, **size, **elastic)),
        burst_pressure=float(min(bursts)),
        yield_pressure=min(yields),
        mass_per_length=float(density * area),
    )
