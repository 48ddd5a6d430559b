"""Study of the barrel wall through its thickness, for a design review.

The study covers layers with their allowables, stresses at eleven points of every layer, strength
ratios by every criterion, the failure sequence to burst, and alternative walls
(`wall_alternatives`). Stresses are those of the exact tube, even if the design uses another model.
The study is of a single design; all values are plain floats.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite, pi
from typing import Any, Literal

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..models import burst_ladder, strength, tube_burst
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
from .barrel import LAMINATES, Wall, kind
from .barrel.wall import RUPTURE
from .geometry import Geometry
from .kernel import ModelRun, PreparedDesign
from .limits import MaterialValues
from .plies import Climate, Layer, stress_of
from .values import Values, plain
from .wall_alternatives import (
    Difference,
    MetalBarrel,
    Settling,
    Thickness,
    differences,
    governing_force,
    least,
    main_layer,
    metal_tubes,
    settling,
    single,
    thicknesses,
)

YIELD = "yield"
"""Name of the criterion for metal layers: yield by von Mises stress."""


@dataclass(frozen=True, slots=True)
class LayerRow:
    """A layer of the wall with its allowables.

    `strengths` are those at the highest temperature after knock-downs; `factors` are the shares of
    the strengths that remain after knock-downs. `angle` is measured from the tube axis [rad].
    Lengths are in m, moduli and strengths in Pa.
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
    """Stresses [Pa] through the wall under one load, each (layers, points), starting at the bore.

    `used` is the utilisation 1/SR (SR: strength ratio). It follows from the criterion of the
    design, for metals from yield, and includes the cure stress at the worse of the two extreme
    service temperatures. It is NaN if unknown, and None for a load without pressure.
    """

    name: str
    hoop: Array
    axial: Array
    radial: Array
    used: Array | None = None


@dataclass(frozen=True, slots=True)
class Ratio:
    """Least strength ratio of a layer by one criterion, and where it occurs.

    `ratio` is None if the layer has no load.
    """

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
    """Stress divided by strength through the wall, (layers, points).

    They are given for the load path (pressure without or with axial force) and service temperature
    at which the wall has its least strength ratio. The ratios of plies along the fibre, across it
    and in shear have a sign. For metals, the ratio is von Mises stress divided by yield strength.
    Ratios that do not apply to a layer are NaN.
    """

    path: str
    climate: str
    along: Array
    across: Array
    shear: Array
    mises: Array


@dataclass(frozen=True, slots=True)
class Step:
    """A failure on the way to burst: layer (0 is innermost), failure mode, pressure [Pa]."""

    layer: int
    mode: str
    pressure: float


@dataclass(frozen=True, slots=True)
class Ladder:
    """Pressures [Pa] from working pressure to burst pressure; None if unknown.

    Locations have the same names as in the metrics. `path` is the load path with the lowest burst
    pressure: pressure without or with axial force. `steps` are the failures on this path by the
    maximum-stress criterion.
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
    """The complete study of a wall.

    `radius` are the radii of the points, (layers, points) [m]; `criterion` is the failure criterion
    of the design.
    """

    layers: tuple[LayerRow, ...]
    criterion: str
    radius: Array
    profiles: tuple[WallProfile, ...]
    rest: tuple[WallProfile, ...]
    """Stresses at zero pressure from cure, clamping and autofrettage, at the lowest and highest
    service temperature; empty if these are zero."""
    ratios: tuple[Ratio, ...]
    shares: Shares | None
    ladder: Ladder
    differences: tuple[Difference, ...]
    main_layer: int
    thicknesses: tuple[Thickness, ...]
    settling: Settling
    metals: tuple[MetalBarrel, ...]

    def to_dict(self) -> dict[str, Any]:
        """The object `wall` that `evaluate --json` writes (SI); profiles are only in the report."""
        return {
            "layers": plain(self.layers),
            "ratios": plain(self.ratios),
            "ladder": plain(self.ladder),
            "models": plain(self.differences),
            "main_layer": self.main_layer,
            "thicknesses": plain(self.thicknesses),
            "settling": plain(self.settling),
            "metals": plain(self.metals),
        }


PARTS = 10
"""Number of equal sublayers of every layer; their faces are the points of a profile."""

_MODULI = ("youngs_modulus_1", "youngs_modulus_2", "shear_modulus_12", "poissons_ratio_12")
_STRENGTHS = {
    True: ("yield_strength", "ultimate_strength"),
    False: plies.STRENGTHS,
}
"""Strengths in the table of layers, for isotropic layers (True) and plies (False)."""


@dataclass(frozen=True, slots=True)
class _StressField:
    """Stresses (layers, points, loads).

    The loads are supply pressure without and with axial force (the load paths), then zero pressure
    at the coldest and hottest service temperature (the climates).
    """

    paths: tuple[str, ...]
    climates: tuple[Climate, ...]
    radius: Array
    tube: tuple[Array, ...]
    ply: tuple[Array, ...]

    def load(self, rows: Sequence[int]) -> Stress:
        """Stress in layers `rows` by pressure and axial force, (points, layers, 1, paths, 1)."""
        return stress_of(
            part[rows, :, : len(self.paths)].transpose(1, 0, 2)[:, :, None, :, None]
            for part in self.ply
        )

    def rest(self, rows: Sequence[int]) -> Stress | None:
        """Stress in layers `rows` at zero pressure, (points, layers, climates, 1, 1).

        The climates are the extreme service temperatures. None if all stresses are zero.
        """
        stresses = [part[rows, :, len(self.paths) :] for part in self.ply]
        if not any(np.any(part) for part in stresses):
            return None
        return stress_of(part.transpose(1, 0, 2)[..., None, None] for part in stresses)


@dataclass(frozen=True, slots=True)
class _Utilisation:
    """Utilisation 1/SR (SR: strength ratio) of layers by one criterion.

    `values` are (modes, points, layers, climates, paths): by failure mode, point through the
    thickness, layer, extreme service temperature and load path.
    """

    criterion: str
    layers: tuple[int, ...]
    modes: tuple[str, ...]
    values: Array


def study(subject: PreparedDesign, v: Values, run: ModelRun) -> WallStudy | None:
    """Study the wall of an evaluated design; None if its wall model is `as_published`.

    Parameters
    ----------
    subject, v : the design and its fixed numbers
    run : results of its models
    """
    design, model = subject.design, kind(subject.design, subject.materials)
    if model not in (*LAMINATES, "isotropic"):
        return None
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    climates = plies.climates(v, design)
    layers = plies.layers(v, stock, design.barrel.layup, "barrel.layup", climates, [])
    if any(layer.expansions is None for layer in layers):
        climates = tuple(Climate(state.name, 0.0, cold=state.cold) for state in climates)
    pressure, g = float(v["supply.pressure"]), run.geometry
    field = _stress_field(layers, climates, pressure, g, run.wall)
    utilisations = _utilisations(layers, field)
    ratios = tuple(row for utilisation in utilisations for row in _ratios(utilisation, field))
    main_index = main_layer(layers, float(g.inner_radius))
    densities = [float(stock.get(layer.name, "density")) for layer in layers]
    force = governing_force(run.wall)
    criterion, is_laminate = design.barrel.criterion, model in LAMINATES
    return WallStudy(
        layers=_layer_rows(subject, stock, layers, float(g.inner_radius)),
        criterion=criterion,
        radius=field.radius,
        profiles=_profiles(field, [u for u in utilisations if u.criterion in (criterion, YIELD)]),
        rest=_at_rest(field),
        ratios=ratios,
        shares=_shares(layers, field, [r for r in ratios if r.criterion in (criterion, YIELD)]),
        ladder=_ladder(v, layers, climates, run, criterion, exact=model != "thin_laminate"),
        differences=differences(subject, v, stock, run, exact=model == "layered")
        if is_laminate
        else (),
        main_layer=main_index,
        thicknesses=thicknesses(
            layers, densities, g, pressure=pressure, force=force, index=main_index
        ),
        settling=settling(layers, g),
        metals=metal_tubes(subject, v, layers, densities, run),
    )


def _layer_rows(
    subject: PreparedDesign, stock: MaterialValues, layers: Sequence[Layer], inner: float
) -> tuple[LayerRow, ...]:
    rows = []
    kinds: dict[str, Literal["composite", "polymer"]] = {"ply": "composite", "polymer": "polymer"}
    for layer in layers:
        material = stock.material(layer.name)
        keys = [key for key in _STRENGTHS[layer.isotropic] if key in material.numbers]
        outer = inner + float(layer.thickness)
        rows.append(
            LayerRow(
                material=layer.name,
                kind=kinds.get(material.kind, "metal"),
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
    """Split every layer into equal sublayers; the tube as a whole is unchanged."""
    whole = [layer.as_tube() for layer in layers for _ in range(PARTS)]
    return [replace(part, thickness=part.thickness / PARTS) for part in whole]


def _points(values: Array) -> Array:
    """Rearrange values at both faces of sublayers, (2, sublayers, ...) to (layers, points, ...)."""
    shaped = values.reshape(2, -1, PARTS, *values.shape[2:])
    return np.concatenate([shaped[0], shaped[1][:, -1:]], axis=1)


def _stress_field(
    layers: Sequence[Layer], climates: tuple[Climate, ...], pressure: float, g: Geometry, wall: Wall
) -> _StressField:
    """Stresses under all loads at all points; autofrettage stress is equal at both temperatures."""
    tube = layered_tube(layers=_sublayers(layers), inner_radius=float(g.inner_radius))
    pulls = [pressure * single(area) for area in wall.path.per_pressure.values()]
    clamps = [single(force) for force in wall.path.held_in(len(climates))]
    state = tube_state(
        tube=tube,
        inner_pressure=np.array([pressure] * len(pulls) + [0.0] * len(climates)),
        axial_force=np.array(pulls + clamps),
        temperature_change=np.array(
            [0.0] * len(pulls) + [float(state.change) for state in climates]
        ),
    )
    radius = _points(state.radius.reshape(2, -1))
    in_tube = [_points(part) for part in tube_stresses(tube=tube, state=state)[:3]]
    in_plies = [_points(part) for part in ply_stresses_at_faces(tube=tube, state=state)]
    if wall.autofrettage is not None:
        resting = np.array([0.0] * len(pulls) + [1.0] * len(climates))
        residual = _residual_stresses(layers, wall.autofrettage, radius)
        in_tube = [a + b[..., None] * resting for a, b in zip(in_tube, residual[:3], strict=True)]
        in_plies = [a + b[..., None] * resting for a, b in zip(in_plies, residual[3:], strict=True)]
    return _StressField(
        tuple(wall.path.per_pressure), climates, radius, tuple(in_tube), tuple(in_plies)
    )


def _residual_stresses(
    layers: Sequence[Layer], autofrettage: Autofrettage, radius: Array
) -> list[Array]:
    """Residual stresses of autofrettage at all points.

    They are given in tube axes (axial z, hoop t, radial r) and in ply axes.

    The wrap, all layers around the liner, stays elastic under the pressure and axial force from the
    liner. In the liner,
    sigma_t - sigma_r is the yield strength Y up to the plastic radius c and Y c^2/r^2 beyond, minus
    an elastic part proportional to 1/r^2. sigma_r follows from equilibrium, and
    sigma_z - nu (sigma_r + sigma_t) is constant.
    """
    liner, ratio = layers[0], float(layers[0].constants["poissons_ratio_12"])
    strength, edge = float(liner.yield_strength), single(autofrettage.plastic_radius)
    interface = single(autofrettage.interface_pressure)
    axial, hoop = (single(part[0, 0]) for part in autofrettage.stresses[:2])
    r, start, end = radius[0], radius[0, 0], radius[0, -1]
    yielded = np.minimum(r, edge)
    unloaded = (strength - hoop) * start * start if edge > start else 0.0
    spread = strength * (edge / r) ** 2 if edge > start else 0.0 * r
    difference = np.where(r < edge, strength, spread) - unloaded / (r * r)
    inside = strength * np.log(yielded / start) + (strength - spread) / 2 * (r > edge)
    radial = inside - unloaded / 2 * (1 / (start * start) - 1 / (r * r))
    axial_part = axial - ratio * hoop
    liner_stresses = [
        axial_part + ratio * (2 * radial + difference),
        radial + difference,
        radial,
        0 * radial,
    ]
    if len(layers) == 1:
        parts = [part[None] for part in liner_stresses]
        return [*parts[:3], *parts]
    wrap = layered_tube(layers=_sublayers(layers[1:]), inner_radius=end)
    pull = 2 * pi * (ratio * end * end * interface - axial_part * (end * end - start * start) / 2)
    state = tube_state(tube=wrap, inner_pressure=interface, axial_force=pull)
    wrap_stresses = [*tube_stresses(tube=wrap, state=state)[:3]]
    wrap_stresses += ply_stresses_at_faces(tube=wrap, state=state)
    inner = [*liner_stresses[:3], *liner_stresses]
    return [
        np.concatenate([in_liner[None], _points(in_wrap.reshape(2, -1))])
        for in_liner, in_wrap in zip(inner, wrap_stresses, strict=True)
    ]


def _utilisations(layers: Sequence[Layer], field: _StressField) -> list[_Utilisation]:
    """Utilisation 1/SR of all plies by every criterion, and of all metals by yield."""
    brittle = [i for i, layer in enumerate(layers) if layer.strengths]
    utilisations = []
    if brittle:
        load, rest = field.load(brittle), field.rest(brittle)
        for name in CRITERIA:
            modes = plies.utilisations(name, [layers[i] for i in brittle], load, rest)
            values = np.stack(np.broadcast_arrays(*modes.values()))[..., 0]
            utilisations.append(_Utilisation(name, tuple(brittle), tuple(modes), values))
    for i, layer in enumerate(layers):
        if layer.yields:
            in_yield = strength.yield_utilisation(
                stress=field.load([i]),
                yield_strength=np.array(layer.yields, dtype=float)[:, None, None],
                residual=field.rest([i]),
            )
            utilisations.append(_Utilisation(YIELD, (i,), (YIELD,), in_yield[None, ..., 0]))
    return utilisations


def _ratios(utilisation: _Utilisation, field: _StressField) -> list[Ratio]:
    """Least strength ratio of every layer, with its mode, point, temperature and axial force."""
    rows = []
    for k, layer in enumerate(utilisation.layers):
        values = utilisation.values[:, :, k]
        mode, point, climate, path = np.unravel_index(np.argmax(values), values.shape)
        ratio = float(load_multiplier(float(values[mode, point, climate, path])))
        face: dict[int, Literal["inner face", "outer face"]]
        face = {0: "inner face", PARTS: "outer face"}
        rows.append(
            Ratio(
                layer=layer,
                criterion=utilisation.criterion,
                ratio=ratio if isfinite(ratio) else None,
                mode=utilisation.modes[mode],
                radius=float(field.radius[layer, point]),
                face=face.get(int(point), "inside"),
                path=field.paths[path],
                climate=field.climates[climate].name,
            )
        )
    return rows


def _profiles(field: _StressField, utilisations: Sequence[_Utilisation]) -> tuple[WallProfile, ...]:
    """Stresses through the wall at supply pressure for every load path, with the utilisation.

    The load paths are pressure without and with axial force.
    """
    profiles = []
    for p, path in enumerate(field.paths):
        share = np.full(field.radius.shape, np.nan)
        for utilisation in utilisations:
            share[list(utilisation.layers)] = np.max(utilisation.values[..., p], axis=(0, 3)).T
        axial, hoop, radial = (part[..., p] for part in field.tube)
        profiles.append(WallProfile(path, hoop, axial, radial, share))
    return tuple(profiles)


def _at_rest(field: _StressField) -> tuple[WallProfile, ...]:
    """Stresses at zero pressure at the extreme service temperatures; zero stresses are left out."""
    profiles = []
    noise = 1e-6 * max(np.max(np.abs(part[..., : len(field.paths)])) for part in field.tube)
    for s, climate in enumerate(field.climates, len(field.paths)):
        axial, hoop, radial = (part[..., s] for part in field.tube)
        if np.max(np.abs(hoop)) > noise or np.max(np.abs(axial)) > noise:
            profiles.append(WallProfile(climate.name, hoop, axial, radial))
    return tuple(profiles)


def _shares(layers: Sequence[Layer], field: _StressField, ratios: Sequence[Ratio]) -> Shares | None:
    """Stress divided by strength, for the axial force and temperature of least strength ratio."""
    loaded = [row for row in ratios if row.ratio is not None]
    if not loaded:
        return None
    worst = min(loaded, key=lambda row: row.ratio or 0.0)
    climate = [state.name for state in field.climates].index(worst.climate)
    path, rest_index = field.paths.index(worst.path), len(field.paths) + climate
    fibre, cross, through, in_plane = (
        part[..., path] + part[..., rest_index] for part in field.ply
    )
    unknown = np.full(field.radius.shape, np.nan)
    along, across, shear, mises = unknown, unknown.copy(), unknown.copy(), unknown.copy()
    for i, layer in enumerate(layers):
        if layer.strengths:
            s = layer.strengths[climate]
            along[i] = np.where(fibre[i] > 0, fibre[i] / s.tension_1, fibre[i] / s.compression_1)
            across[i] = np.where(cross[i] > 0, cross[i] / s.tension_2, cross[i] / s.compression_2)
            shear[i] = in_plane[i] / s.shear_12
        elif layer.yields:
            mises[i] = strength.yield_utilisation(
                stress=(fibre[i], cross[i], through[i], in_plane[i]),
                yield_strength=layer.yields[climate],
            )
    return Shares(worst.path, worst.climate, along, across, shear, mises)


def _ladder(
    v: Values,
    layers: Sequence[Layer],
    climates: Sequence[Climate],
    run: ModelRun,
    criterion: str,
    *,
    exact: bool,
) -> Ladder:
    """Pressures from working to burst pressure, and the failures that lead to the lowest burst."""
    wall, g = run.wall, run.geometry
    yields, yield_place = least(wall.yield_pressure)
    first, first_place = least(wall.first_ply_pressure)
    burst, path = least(wall.burst_pressure)
    steps: tuple[Step, ...] = ()
    if burst is not None and any(not layer.isotropic for layer in layers):
        areas = wall.path.per_pressure.items()
        load = next(single(area) for name, area in areas if path.endswith(name))
        torn = path.startswith(RUPTURE)
        at = path.removeprefix(f"{RUPTURE}, ")
        climate = next(i for i, state in enumerate(climates) if at.startswith(state.name))
        stack = [layer.as_wall(climate) for layer in layers]
        ladder = (
            tube_burst.burst_of_tube(
                layers=stack,
                inner_radius=float(g.inner_radius),
                axial_force_per_pressure=load,
                temperature_change=float(climates[climate].change),
                held_force=single(wall.path.held_in(len(climates))[climate]),
            )
            if exact
            else burst_ladder.burst_by_ply_discount(
                layers=stack,
                radius=float(g.inner_radius + g.outer_radius) / 2,
                axial_force_per_pressure=load,
            )
        )
        steps = tuple(
            Step(step.layer, step.mode, step.pressure)
            for step in ladder.steps()
            if not torn or step.pressure < burst
        )
        if torn:
            metal = next(i for i, layer in enumerate(layers) if layer.isotropic)
            steps = (*steps, Step(metal, RUPTURE, burst))
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
