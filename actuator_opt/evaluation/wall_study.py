"""The barrel wall through its thickness, for a design review.

Layers with their allowables, stresses at eleven points of every layer, strength ratios by every
criterion, the failure sequence to burst, and alternative walls (`alternatives`). Stresses are
those of the exact tube, even if the design uses another model. For a single design; floats only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isnan, pi
from typing import Literal

import numpy as np

from ..base.numeric import Array
from ..models import ply_discount, tube_burst, yielding
from ..models.autofrettage import Autofrettage
from ..models.criteria import CRITERIA
from ..models.layered_tube import (
    TubeLayer,
    layered_tube,
    ply_stresses_at_faces,
    tube_state,
    tube_stresses,
)
from ..models.strength_modes import Stress, load_multiplier
from . import plies, wall_alternatives as alternatives
from .allow import MaterialValues
from .barrel import LAMINATES, Wall, kind
from .geometry import Geometry
from .kernel import ModelRun, PreparedDesign
from .plies import Climate, Layer
from .values import Values
from .wall_result import YIELD, Ladder, LayerRow, Profile, Ratio, Shares, Step, WallStudy

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
    main = alternatives.main_layer(layers, float(g.inner_radius))
    densities = [float(stock.get(layer.name, "density")) for layer in layers]
    force = alternatives.governing_force(done.wall)
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
        differences=alternatives.differences(subject, v, stock, done, exact=model == "layered")
        if laminated
        else (),
        main_layer=main,
        thicknesses=alternatives.thicknesses(
            layers, densities, g, pressure=pressure, force=force, index=main
        ),
        settling=alternatives.settling(layers, g),
        metals=alternatives.metal_tubes(subject, v, layers, densities, done),
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
    pulls = [pressure * alternatives.single(area) for area in wall.path.per_pressure.values()]
    clamp = alternatives.single(wall.path.held)
    state = tube_state(
        tube=tube,
        inner_pressure=np.array([pressure] * len(pulls) + [0.0] * len(states)),
        axial_force=np.array(pulls + [clamp] * len(states)),
        temperature_change=np.array([0.0] * len(pulls) + [float(one.change) for one in states]),
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
    strength, edge = float(liner.yield_strength), alternatives.single(left.plastic_radius)
    press = alternatives.single(left.interface_pressure)
    axial, hoop = (alternatives.single(part[0, 0]) for part in left.stresses[:2])
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
            one = yielding.yield_utilisation(
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


def _profiles(sight: _Sight, used: Sequence[_Used]) -> tuple[Profile, ...]:
    """Stresses of every load path, with their utilisation of the strength."""
    found = []
    for p, path in enumerate(sight.paths):
        share = np.full(sight.radius.shape, np.nan)
        for one in used:
            share[list(one.layers)] = np.max(one.values[..., p], axis=(0, 3)).T
        axial, hoop, radial = (part[..., p] for part in sight.tube)
        found.append(Profile(path, hoop, axial, radial, share))
    return tuple(found)


def _at_rest(sight: _Sight) -> tuple[Profile, ...]:
    """Stresses of every climate without pressure."""
    found = []
    noise = 1e-6 * max(np.max(np.abs(part[..., : len(sight.paths)])) for part in sight.tube)
    for s, state in enumerate(sight.states, len(sight.paths)):
        axial, hoop, radial = (part[..., s] for part in sight.tube)
        if np.max(np.abs(hoop)) > noise or np.max(np.abs(axial)) > noise:
            found.append(Profile(state.name, hoop, axial, radial))
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
            mises[i] = yielding.yield_utilisation(
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
    yields, yield_place = alternatives.least(wall.yield_pressure)
    first, first_place = alternatives.least(wall.first_ply_pressure)
    burst, path = alternatives.least(wall.burst_pressure)
    steps: tuple[Step, ...] = ()
    if burst is not None and any(not layer.isotropic for layer in layers):
        areas = wall.path.per_pressure.items()
        load = next(alternatives.single(area) for name, area in areas if path.endswith(name))
        climate = next(i for i, state in enumerate(states) if path.startswith(state.name))
        stack = [layer.as_wall(climate) for layer in layers]
        ladder = (
            tube_burst.burst_of_tube(
                layers=stack,
                inner_radius=float(g.inner_radius),
                axial_force_per_pressure=load,
                temperature_change=float(states[climate].change),
                held_force=alternatives.single(wall.path.held),
            )
            if exact
            else ply_discount.burst_by_ply_discount(
                layers=stack,
                radius=float(g.inner_radius + g.outer_radius) / 2,
                axial_force_per_pressure=load,
            )
        )
        steps = tuple(Step(one.layer, one.mode, one.pressure) for one in ladder.steps())
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
