"""The barrel wall through its thickness, for a design review.

Layers with their allowables, stresses at eleven points of every layer, strength ratios by every
criterion, the failure sequence to burst, and alternative walls (`alternatives`). Stresses are
those of the exact tube, even if the design uses another model. For a single design; floats only.

Alternatives to the barrel wall: other thickness, thin-wall theory, or metal.

Also the decay of bore growth beside the pressure step under the piston seal. Floats only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import e, isfinite, isnan, pi
from typing import Any, Literal

import numpy as np

from ..base.numeric import Array
from ..design.materials import load_library
from ..models import barrel, barrel_ends, burst_ladder, laminate, liner, ply, strength, tube_burst
from ..models.autofrettage import Autofrettage
from ..models.layered_tube import (
    TubeLayer,
    layered_tube,
    ply_stresses_at_faces,
    tube_state,
    tube_stresses,
)
from ..models.strength import CRITERIA
from ..models.strength_modes import Stress, load_multiplier
from . import plies
from .barrel import LAMINATES, Wall, kind, laminate as laminated
from .geometry import Geometry
from .kernel import ModelRun, PreparedDesign
from .limits import MaterialValues, allowances, extremes
from .plies import Climate, Layer
from .values import Values

METALS = ("steel_e355", "al_7075_t6")
"""Metal barrels to compare with every wall: the usual honed steel tube, the usual light alloy."""
FACTORS = (0.8, 1.25)
"""Bore growths, over the actual growth, for which a thickness is computed."""
LARGEST = 2.0
"""Largest thickness tried, in bore radii."""


@dataclass(frozen=True, slots=True)
class Thickness:
    """Thickness [m] of a layer that changes the bore growth [m] by `factor`.

    `mass_per_length` [kg/m] is that of the whole wall; both None if no thickness suffices.
    """

    factor: float
    growth: float
    thickness: float | None
    mass_per_length: float | None


@dataclass(frozen=True, slots=True)
class Difference:
    """A wall quantity (SI) by the exact tube and by the thin laminate; None if unlimited."""

    name: str
    exact: float | None
    thin: float | None


@dataclass(frozen=True, slots=True)
class Settling:
    """Decay of bore growth beside the pressure step under the piston seal.

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
    """A barrel with the same bore and pressure; without a material, that of the design.

    `for_growth` and `for_burst` are the walls [m] required by either, None if impossible or not
    required; `thickness` is the larger. Growth [m] is at supply pressure without axial force,
    burst and yield pressures [Pa] are those of the worse axial force, mass is per length [kg/m].
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
    """The only number of a single design's array."""
    return float(np.squeeze(np.real(value)))


def least(pressures: Mapping[str, Array]) -> tuple[float | None, str]:
    """The smallest finite pressure, and its place; None if there is none."""
    found = {place: single(value) for place, value in pressures.items()}
    usable = {place: value for place, value in found.items() if isfinite(value)}
    if not usable:
        return None, ""
    place = min(usable, key=lambda name: usable[name])
    return usable[place], place


def governing_force(wall: Wall) -> float:
    """Axial force [N] at the largest bore growth: that of a load case, or zero."""
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
    """The layer with the largest hoop force; a ply before a liner."""
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
    """Thickness of layer `index` for bore growths around the actual growth, by the exact tube."""
    inner = float(g.inner_radius)
    wall = [layer.as_tube() for layer in layers]
    tube = layered_tube(layers=wall, inner_radius=inner)
    state = tube_state(tube=tube, inner_pressure=pressure, axial_force=force)
    growth = float(state.bore_displacement)

    def solved(factors: Sequence[float]) -> list[float | None]:
        try:
            found = liner.layer_thickness_for_strain(
                layers=wall,
                index=index,
                inner_radius=inner,
                strain=np.array(factors) * growth / inner,
                pressure=pressure,
                axial_force_per_pressure=force / pressure,
                largest_thickness=LARGEST * inner,
            )
        except ValueError:  # some growth is out of reach: find which
            return (
                [x for factor in factors for x in solved([factor])] if len(factors) > 1 else [None]
            )
        return [float(value) for value in found]

    rows = []
    known = (float(layers[index].thickness), *solved(FACTORS))
    for factor, found in zip((1.0, *FACTORS), known, strict=True):
        mass = None
        if found is not None:
            changed = list(layers)
            changed[index] = replace(layers[index], thickness=found)
            mass = mass_per_length(changed, densities, inner)
        rows.append(Thickness(factor, factor * growth, found, mass))
    return tuple(sorted(rows, key=lambda row: row.factor))


def differences(
    subject: PreparedDesign, v: Values, stock: MaterialValues, done: ModelRun, *, exact: bool
) -> tuple[Difference, ...]:
    """The wall by both laminate theories; `exact` states which theory the design uses."""
    other = laminated.compute(v, subject.design, stock, done.geometry, done.state, exact=not exact)
    pair = (done.wall, other) if exact else (other, done.wall)
    growths = [float(np.max(np.real(wall.growth))) for wall in pair]
    rows = [Difference("bore_growth", *growths)]
    for name in ("yield_pressure", "first_ply_pressure", "burst_pressure"):
        pressures = [least(getattr(wall, name))[0] for wall in pair]
        if pressures != [None, None]:
            rows.append(Difference(name, *pressures))
    return tuple(rows)


def settling(layers: Sequence[Layer], g: Geometry) -> Settling:
    """Decay length of the wall as a thin shell, and its growth beside the step."""
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
    subject: PreparedDesign,
    v: Values,
    layers: Sequence[Layer],
    densities: Sequence[float],
    done: ModelRun,
) -> tuple[MetalTube, ...]:
    """The wall of the design, and the thinnest barrel of each of `METALS` for the same duty.

    The duty is its bore growth without axial force, and the required burst pressure for every load
    path (its own burst pressure if lower, or if the burst check is waived).
    """
    wall, inner, pressure = done.wall, float(done.geometry.inner_radius), v["supply.pressure"]
    burst = least(wall.burst_pressure)[0]
    own = MetalTube(
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
    """A library metal with the knock-downs of this design's temperatures."""
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
) -> MetalTube:
    """The thinnest tube of a metal for a bore strain (no axial force) and a burst pressure."""
    inner, density = inner_radius, stock.get(name, "density")
    elastic = {
        "youngs_modulus": stock.get(name, "youngs_modulus"),
        "poissons_ratio": stock.get(name, "poissons_ratio"),
    }
    strength = stock.allowable(name, "yield_strength")
    ultimate = stock.allowable(name, "ultimate_strength")
    if strength is None or ultimate is None:  # a user entry of that name
        return MetalTube(name, None, None)
    strengths = {"yield_strength": strength, "ultimate_strength": ultimate}
    ratios = [force / (pi * inner * inner) for force in axial_forces_per_pressure]
    held = None
    if burst_pressure is not None:  # Faupel's pressure is proportional to the logarithm of k
        unit = {"inner_radius": 1.0, "outer_radius": e} | strengths
        least_flow = min(
            float(barrel.burst_pressure_thick(**unit, axial_force_ratio=ratio)) for ratio in ratios
        )
        held = float(inner * np.expm1(burst_pressure / least_flow))
    try:
        stiff = barrel.wall_ratio_for_strain(
            strain=strain, pressure=pressure, closed=False, **elastic
        )
    except ValueError:  # no wall of this metal is stiff enough
        return MetalTube(name, None, held)
    growth = float(inner * (stiff - 1))
    thickness = max(growth, held or 0.0)
    size = {"inner_radius": inner, "outer_radius": inner + thickness}
    yields, bursts = [], []
    for force, ratio in zip(axial_forces_per_pressure, ratios, strict=True):
        hoop, radial, axial = barrel.bore_stresses(pressure=1.0, axial_force=force, **size)
        used = barrel.von_mises(hoop=hoop, radial=radial, axial=axial)
        yields.append(float(strength / used))
        bursts.append(barrel.burst_pressure_thick(**size, **strengths, axial_force_ratio=ratio))
    area = pi * (size["outer_radius"] * size["outer_radius"] - inner * inner)
    return MetalTube(
        material=name,
        for_growth=growth,
        for_burst=held,
        thickness=thickness,
        growth=float(barrel.bore_growth(pressure=pressure, **size, **elastic)),
        burst_pressure=float(min(bursts)),
        yield_pressure=min(yields),
        mass_per_length=float(density * area),
    )


YIELD = "yield"
"""Criterion of metal layers: von Mises."""


@dataclass(frozen=True, slots=True)
class LayerRow:
    """A layer; `strengths` are after knock-downs at the hottest, `factors` the remaining share.

    `angle` in rad from the tube axis; lengths in m, moduli and strengths in Pa.
    """

    material: str
    kind: Literal["metal", "composite", "polymer"]
    angle: float
    balanced: bool
    thickness: float
    inner_radius: float
    outer_radius: float
    moduli: Mapping[str, float]
    strengths: Mapping[str, float]
    factors: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class WallProfile:
    """Stresses [Pa] through the wall under one load, each (layers, points) from the bore.

    `used` is 1/SR by the criterion of the design (metals: yield), including the cure stress of the
    worst climate; NaN if unknown, None at rest.
    """

    name: str
    hoop: Array
    axial: Array
    radial: Array
    used: Array | None = None


@dataclass(frozen=True, slots=True)
class Ratio:
    """Least strength ratio of a layer by one criterion; None if unloaded."""

    layer: int
    criterion: str
    ratio: float | None
    mode: str
    radius: float
    face: Literal["inner face", "inside", "outer face"]
    path: str
    climate: str


@dataclass(frozen=True, slots=True)
class Shares:
    """Stress over strength through the wall, (layers, points), under its most severe load.

    Signed along the fibre, across it and in shear; for metals von Mises over yield. NaN elsewhere.
    """

    path: str
    climate: str
    along: Array
    across: Array
    shear: Array
    mises: Array


@dataclass(frozen=True, slots=True)
class Step:
    """A failure before burst: layer (0 at the bore), mode, pressure [Pa]."""

    layer: int
    mode: str
    pressure: float


@dataclass(frozen=True, slots=True)
class Ladder:
    """Pressures [Pa] from working to burst, None if unknown; places as in the metrics.

    `steps` belong to the load path with the lowest burst, by maximum stress.
    """

    working: float
    proof: float
    metal_yield: float | None
    metal_yield_place: str
    first_ply: float | None
    first_ply_place: str
    criterion: str
    burst: float | None
    path: str
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class WallStudy:
    """The complete study; `radius` is (layers, points) [m], `criterion` that of the design."""

    layers: tuple[LayerRow, ...]
    criterion: str
    radius: Array
    profiles: tuple[WallProfile, ...]
    rest: tuple[WallProfile, ...]
    """Cure stress and clamp without pressure, by climate; empty without such stresses."""
    ratios: tuple[Ratio, ...]
    shares: Shares | None
    ladder: Ladder
    differences: tuple[Difference, ...]
    main_layer: int
    thicknesses: tuple[Thickness, ...]
    settling: Settling
    metals: tuple[MetalTube, ...]

    def to_dict(self) -> dict[str, Any]:
        """The `wall` object of `evaluate --json` (SI); profiles are in the report only."""
        found: dict[str, Any] = _finite(
            {
                "layers": [asdict(row) for row in self.layers],
                "ratios": [asdict(row) for row in self.ratios],
                "ladder": asdict(self.ladder),
                "models": [asdict(row) for row in self.differences],
                "main_layer": self.main_layer,
                "thicknesses": [asdict(row) for row in self.thicknesses],
                "settling": asdict(self.settling),
                "metals": [asdict(row) for row in self.metals],
            }
        )
        return found


def _finite(value: Any) -> Any:
    """The same records with None for values that are not finite."""
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not isfinite(value) else value


PARTS = 10
"""Equal sublayers of every layer; their faces are the points of a profile."""

_MODULI = ("youngs_modulus_1", "youngs_modulus_2", "shear_modulus_12", "poissons_ratio_12")
_STRENGTHS = {
    True: ("yield_strength", "ultimate_strength"),
    False: (
        "strength_1_tension",
        "strength_1_compression",
        "strength_2_tension",
        "strength_2_compression",
        "strength_12",
    ),
}
"""Properties in the table of layers, for isotropic layers and for plies."""


@dataclass(frozen=True, slots=True)
class _Sight:
    """Stresses (layers, points, loads): for every load path, then every climate at rest."""

    paths: tuple[str, ...]
    states: tuple[Climate, ...]
    radius: Array
    tube: tuple[Array, ...]
    ply: tuple[Array, ...]

    def load(self, rows: Sequence[int]) -> Stress:
        """Stress of these layers by pressure and axial force, (points, layers, 1, paths, 1)."""
        one, two, three, slip = (
            part[rows, :, : len(self.paths)].transpose(1, 0, 2)[:, :, None, :, None]
            for part in self.ply
        )
        return one, two, three, slip

    def rest(self, rows: Sequence[int]) -> Stress | None:
        """Stress of these layers without pressure, (points, layers, climates, 1, 1); None: none."""
        held = [part[rows, :, len(self.paths) :] for part in self.ply]
        if not any(np.any(part) for part in held):
            return None
        one, two, three, slip = (part.transpose(1, 0, 2)[..., None, None] for part in held)
        return one, two, three, slip


@dataclass(frozen=True, slots=True)
class _Used:
    """1/SR of these layers by one criterion, (modes, points, layers, climates, paths)."""

    criterion: str
    layers: tuple[int, ...]
    modes: tuple[str, ...]
    values: Array


def study(subject: PreparedDesign, v: Values, done: ModelRun) -> WallStudy | None:
    """The wall of an evaluated design; None with the barrel model of the paper.

    Parameters
    ----------
    subject, v : the design and its fixed numbers
    done : the pass over its models
    """
    design, model = subject.design, kind(subject.design, subject.materials)
    if model not in (*LAMINATES, "isotropic"):
        return None
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    states = plies.climates(v, design)
    layers = plies.layers(v, stock, design.barrel.layup, "barrel.layup", states, [])
    if any(layer.expansions is None for layer in layers):
        states = tuple(Climate(state.name, 0.0, cold=state.cold) for state in states)
    pressure, g = float(v["supply.pressure"]), done.geometry
    sight = _look(layers, states, pressure, g, done.wall)
    used = _used(layers, sight)
    ratios = tuple(row for one in used for row in _ratios(one, sight))
    main = main_layer(layers, float(g.inner_radius))
    densities = [float(stock.get(layer.name, "density")) for layer in layers]
    force = governing_force(done.wall)
    criterion, laminated = design.barrel.criterion, model in LAMINATES
    return WallStudy(
        layers=_layer_rows(subject, stock, layers, float(g.inner_radius)),
        criterion=criterion,
        radius=sight.radius,
        profiles=_profiles(sight, [one for one in used if one.criterion in (criterion, YIELD)]),
        rest=_at_rest(sight),
        ratios=ratios,
        shares=_shares(layers, sight, [r for r in ratios if r.criterion in (criterion, YIELD)]),
        ladder=_ladder(v, layers, states, done, criterion, exact=model != "thin_laminate"),
        differences=differences(subject, v, stock, done, exact=model == "layered")
        if laminated
        else (),
        main_layer=main,
        thicknesses=thicknesses(layers, densities, g, pressure=pressure, force=force, index=main),
        settling=settling(layers, g),
        metals=metal_tubes(subject, v, layers, densities, done),
    )


def _layer_rows(
    subject: PreparedDesign, stock: MaterialValues, layers: Sequence[Layer], inner: float
) -> tuple[LayerRow, ...]:
    rows = []
    kinds: dict[str, Literal["composite", "polymer"]] = {"ply": "composite", "polymer": "polymer"}
    for layer in layers:
        known = stock.material(layer.name)
        keys = [key for key in _STRENGTHS[layer.isotropic] if key in known.numbers]
        outer = inner + float(layer.thickness)
        rows.append(
            LayerRow(
                material=layer.name,
                kind=kinds.get(known.kind, "metal"),
                angle=0.0 if layer.isotropic else float(layer.angle),
                balanced=layer.balanced,
                thickness=float(layer.thickness),
                inner_radius=inner,
                outer_radius=outer,
                moduli={key: float(layer.constants[key]) for key in _MODULI},
                strengths={key: float(stock.allowable(layer.name, key)) for key in keys},
                factors={key: subject.factors[layer.name, key, False] for key in keys},
            )
        )
        inner = outer
    return tuple(rows)


def _sublayers(layers: Sequence[Layer]) -> list[TubeLayer]:
    """Equal parts of every layer, which do not change the tube."""
    whole = [layer.as_tube() for layer in layers for _ in range(PARTS)]
    return [replace(part, thickness=part.thickness / PARTS) for part in whole]


def _points(values: Array) -> Array:
    """Values at both faces of all sublayers, (2, sublayers, ...), as (layers, points, ...)."""
    shaped = values.reshape(2, -1, PARTS, *values.shape[2:])
    return np.concatenate([shaped[0], shaped[1][:, -1:]], axis=1)


def _look(
    layers: Sequence[Layer], states: tuple[Climate, ...], pressure: float, g: Geometry, wall: Wall
) -> _Sight:
    """Stresses of all loads at all points; residual stresses of autofrettage in every climate."""
    tube = layered_tube(layers=_sublayers(layers), inner_radius=float(g.inner_radius))
    pulls = [pressure * single(area) for area in wall.path.per_pressure.values()]
    clamp = single(wall.path.held)
    state = tube_state(
        tube=tube,
        inner_pressure=np.array([pressure] * len(pulls) + [0.0] * len(states)),
        axial_force=np.array(pulls + [clamp] * len(states)),
        temperature_change=np.array([0.0] * len(pulls) + [float(state.change) for state in states]),
    )
    radius = _points(state.radius.reshape(2, -1))
    around = [_points(part) for part in tube_stresses(tube=tube, state=state)[:3]]
    own = [_points(part) for part in ply_stresses_at_faces(tube=tube, state=state)]
    if wall.autofrettage is not None:
        resting = np.array([0.0] * len(pulls) + [1.0] * len(states))
        left = _overpressed(layers, wall.autofrettage, radius)
        around = [a + b[..., None] * resting for a, b in zip(around, left[:3], strict=True)]
        own = [a + b[..., None] * resting for a, b in zip(own, left[3:], strict=True)]
    return _Sight(tuple(wall.path.per_pressure), states, radius, tuple(around), tuple(own))


def _overpressed(layers: Sequence[Layer], left: Autofrettage, radius: Array) -> list[Array]:
    """Residual stresses z, t, r and 1, 2, 3, 12 of autofrettage at all points.

    The wrap is elastic under the pressure and the axial force from the liner. In the
    liner sigma_t - sigma_r is Y out to c and Y c^2/r^2 beyond, less the elastic part ~ 1/r^2;
    sigma_r follows from equilibrium, sigma_z - nu (sigma_r + sigma_t) is constant.
    """
    liner, ratio = layers[0], float(layers[0].constants["poissons_ratio_12"])
    strength, edge = float(liner.yield_strength), single(left.plastic_radius)
    press = single(left.interface_pressure)
    axial, hoop = (single(part[0, 0]) for part in left.stresses[:2])
    r, start, end = radius[0], radius[0, 0], radius[0, -1]
    flowed = np.minimum(r, edge)
    unloaded = (strength - hoop) * start * start if edge > start else 0.0
    spread = strength * (edge / r) ** 2 if edge > start else 0.0 * r
    difference = np.where(r < edge, strength, spread) - unloaded / (r * r)
    inside = strength * np.log(flowed / start) + (strength - spread) / 2 * (r > edge)
    radial = inside - unloaded / 2 * (1 / (start * start) - 1 / (r * r))
    stretch = axial - ratio * hoop
    own = [stretch + ratio * (2 * radial + difference), radial + difference, radial, 0 * radial]
    if len(layers) == 1:
        parts = [part[None] for part in own]
        return [*parts[:3], *parts]
    wrap = layered_tube(layers=_sublayers(layers[1:]), inner_radius=end)
    pull = 2 * pi * (ratio * end * end * press - stretch * (end * end - start * start) / 2)
    state = tube_state(tube=wrap, inner_pressure=press, axial_force=pull)
    outside = [*tube_stresses(tube=wrap, state=state)[:3]]
    outside += ply_stresses_at_faces(tube=wrap, state=state)
    inner = [*own[:3], *own]
    return [
        np.concatenate([one[None], _points(two.reshape(2, -1))])
        for one, two in zip(inner, outside, strict=True)
    ]


def _used(layers: Sequence[Layer], sight: _Sight) -> list[_Used]:
    """1/SR of all plies by every criterion, of each metal by yield."""
    brittle = [i for i, layer in enumerate(layers) if layer.strengths]
    found = []
    if brittle:
        load, rest = sight.load(brittle), sight.rest(brittle)
        for name in CRITERIA:
            modes = plies.utilisations(name, [layers[i] for i in brittle], load, rest)
            values = np.stack(np.broadcast_arrays(*modes.values()))[..., 0]
            found.append(_Used(name, tuple(brittle), tuple(modes), values))
    for i, layer in enumerate(layers):
        if layer.yields:
            one = strength.yield_utilisation(
                stress=sight.load([i]),
                yield_strength=np.array(layer.yields, dtype=float)[:, None, None],
                residual=sight.rest([i]),
            )
            found.append(_Used(YIELD, (i,), (YIELD,), one[None, ..., 0]))
    return found


def _ratios(used: _Used, sight: _Sight) -> list[Ratio]:
    """The worst mode, point, climate and load path of every layer."""
    rows = []
    for k, layer in enumerate(used.layers):
        values = used.values[:, :, k]
        mode, point, climate, path = np.unravel_index(np.argmax(values), values.shape)
        ratio = float(load_multiplier(float(values[mode, point, climate, path])))
        face: dict[int, Literal["inner face", "outer face"]]
        face = {0: "inner face", PARTS: "outer face"}
        rows.append(
            Ratio(
                layer=layer,
                criterion=used.criterion,
                ratio=None if np.isinf(ratio) or isnan(ratio) else ratio,
                mode=used.modes[mode],
                radius=float(sight.radius[layer, point]),
                face=face.get(int(point), "inside"),
                path=sight.paths[path],
                climate=sight.states[climate].name,
            )
        )
    return rows


def _profiles(sight: _Sight, used: Sequence[_Used]) -> tuple[WallProfile, ...]:
    """Stresses of every load path, with their utilisation of the strength."""
    found = []
    for p, path in enumerate(sight.paths):
        share = np.full(sight.radius.shape, np.nan)
        for one in used:
            share[list(one.layers)] = np.max(one.values[..., p], axis=(0, 3)).T
        axial, hoop, radial = (part[..., p] for part in sight.tube)
        found.append(WallProfile(path, hoop, axial, radial, share))
    return tuple(found)


def _at_rest(sight: _Sight) -> tuple[WallProfile, ...]:
    """Stresses of every climate without pressure."""
    found = []
    noise = 1e-6 * max(np.max(np.abs(part[..., : len(sight.paths)])) for part in sight.tube)
    for s, state in enumerate(sight.states, len(sight.paths)):
        axial, hoop, radial = (part[..., s] for part in sight.tube)
        if np.max(np.abs(hoop)) > noise or np.max(np.abs(axial)) > noise:
            found.append(WallProfile(state.name, hoop, axial, radial))
    return tuple(found)


def _shares(layers: Sequence[Layer], sight: _Sight, ratios: Sequence[Ratio]) -> Shares | None:
    """Stress over strength for the load path and climate of the least strength ratio."""
    loaded = [row for row in ratios if row.ratio is not None]
    if not loaded:
        return None
    worst = min(loaded, key=lambda row: row.ratio or 0.0)
    climate = [state.name for state in sight.states].index(worst.climate)
    at, rest = sight.paths.index(worst.path), len(sight.paths) + climate
    one, two, three, slip = (part[..., at] + part[..., rest] for part in sight.ply)
    none = np.full(sight.radius.shape, np.nan)
    along, across, shear, mises = none, none.copy(), none.copy(), none.copy()
    for i, layer in enumerate(layers):
        if layer.strengths:
            s = layer.strengths[climate]
            along[i] = np.where(one[i] > 0, one[i] / s.tension_1, one[i] / s.compression_1)
            across[i] = np.where(two[i] > 0, two[i] / s.tension_2, two[i] / s.compression_2)
            shear[i] = slip[i] / s.shear_12
        elif layer.yields:
            mises[i] = strength.yield_utilisation(
                stress=(one[i], two[i], three[i], slip[i]), yield_strength=layer.yields[climate]
            )
    return Shares(worst.path, worst.climate, along, across, shear, mises)


def _ladder(
    v: Values,
    layers: Sequence[Layer],
    states: Sequence[Climate],
    done: ModelRun,
    criterion: str,
    *,
    exact: bool,
) -> Ladder:
    """The pressure levels of the metrics, and the failure sequence of the weakest load path."""
    wall, g = done.wall, done.geometry
    yields, yield_place = least(wall.yield_pressure)
    first, first_place = least(wall.first_ply_pressure)
    burst, path = least(wall.burst_pressure)
    steps: tuple[Step, ...] = ()
    if burst is not None and any(not layer.isotropic for layer in layers):
        areas = wall.path.per_pressure.items()
        load = next(single(area) for name, area in areas if path.endswith(name))
        climate = next(i for i, state in enumerate(states) if path.startswith(state.name))
        stack = [layer.as_wall(climate) for layer in layers]
        ladder = (
            tube_burst.burst_of_tube(
                layers=stack,
                inner_radius=float(g.inner_radius),
                axial_force_per_pressure=load,
                temperature_change=float(states[climate].change),
                held_force=single(wall.path.held),
            )
            if exact
            else burst_ladder.burst_by_ply_discount(
                layers=stack,
                radius=float(g.inner_radius + g.outer_radius) / 2,
                axial_force_per_pressure=load,
            )
        )
        steps = tuple(Step(step.layer, step.mode, step.pressure) for step in ladder.steps())
    supply = float(v["supply.pressure"])
    return Ladder(
        working=supply,
        proof=float(v["supply.proof_ratio"]) * supply,
        metal_yield=yields,
        metal_yield_place=yield_place,
        first_ply=first,
        first_ply_place=first_place,
        criterion=criterion,
        burst=burst,
        path=path,
        steps=steps,
    )
