"""The laminated barrel: exact layered tube by default, or thin laminate.

Stresses under unit pressure, unit axial force and unit temperature change are superposed for every
load path: pressure without axial force, and with the largest axial force. Cure stresses and the
preload of tie rods are residual stresses, independent of the load.

To compute a gradient, each variable is varied in a copy of the design. Most variables do not affect
the wall, so most copies have equal walls: only the distinct walls of a batch are computed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import reduce
from math import pi
from typing import Any

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import Array, array_of, maximum, real, where
from ...design.model import Design
from ...models import burst_ladder, column, liner, mass, rod, strength, tube_burst
from ...models.autofrettage import Autofrettage, autofrettage
from ...models.strength_modes import Stress, load_multiplier
from .. import plies
from ..geometry import Geometry
from ..limits import MaterialValues
from ..plies import Climate, Layer
from ..state import LoadState
from ..values import Values
from .wall import (
    FORCE,
    NONE,
    OWN,
    PRESSURE,
    RUPTURE,
    WARMTH,
    Cycle,
    LoadPath,
    Metal,
    Plies,
    Swelling,
    Wall,
    WallSolution,
    exact_solution,
    load_path,
    thin_solution,
)

FEW = 32
"""Smallest number of designs for which it saves time to compute repeated designs only once."""


def distinct(arguments: Mapping[str, Any]) -> tuple[dict[str, Any], Callable[[Array], Array]]:
    """Drop repeated designs from a model's arguments; return also a function that restores them.

    The function takes a result for the distinct designs and returns it for all designs. The last
    axis of every array is that of the designs; it has length 1 if all designs share the value. The
    longest last axis gives the number of designs.

    Parameters
    ----------
    arguments : arrays, numbers, words, and lists and data classes of them
    """
    count = max(
        (np.shape(value)[-1:] for value in arguments.values() if _is_array(value)), default=()
    )
    if count <= (FEW,):
        return dict(arguments), lambda result: result
    return _distinct(arguments, *count)


def _distinct(
    arguments: Mapping[str, Any], count: int
) -> tuple[dict[str, Any], Callable[[Array], Array]]:
    arrays = _arrays(tuple(arguments.values()))
    rows = [array.reshape(-1, count) for array in arrays if array.shape[-1] == count]
    if any(array.dtype.hasobject for array in rows):
        return dict(arguments), lambda result: result
    designs = np.ascontiguousarray(np.concatenate(rows).T)
    index_of: dict[bytes, int] = {}
    indices = np.array([index_of.setdefault(design.tobytes(), len(index_of)) for design in designs])
    if len(index_of) == count:
        return dict(arguments), lambda result: result
    first = np.unique(indices, return_index=True)[1]

    def of_distinct(array: Array) -> Array:
        return array[..., first] if array.shape[-1] == count else array

    def of_all(result: Array) -> Array:
        return result if np.shape(result)[-1] == 1 else result[..., indices]

    return {name: _changed(value, of_distinct) for name, value in arguments.items()}, of_all


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim > 0


def _arrays(value: Any) -> Iterator[Array]:
    """Return all arrays within a nested value."""
    if _is_array(value):
        yield value
    elif isinstance(value, (list, tuple)):
        for part in value:
            yield from _arrays(part)
    elif is_dataclass(value):
        for part in fields(value):
            yield from _arrays(getattr(value, part.name))


def _changed(value: Any, change: Callable[[Array], Array]) -> Any:
    """Copy a nested value, with `change` applied to every array in it."""
    if _is_array(value):
        return change(value)
    if isinstance(value, (list, tuple)):
        return type(value)(_changed(part, change) for part in value)
    if is_dataclass(value) and not isinstance(value, type):
        changes = {part.name: _changed(getattr(value, part.name), change) for part in fields(value)}
        return replace(value, **changes)
    return value


def compute(
    v: Values, design: Design, stock: MaterialValues, g: Geometry, state: LoadState, *, exact: bool
) -> Wall:
    """Calculate a barrel wall of several layers, or of plies."""
    missing: list[str] = []
    states = plies.climates(v, design)
    layers = plies.layers(v, stock, design.barrel.layup, "barrel.layup", states, missing)
    solution = exact_solution(layers, g) if exact else thin_solution(layers, g)
    shortening = solution.axial[PRESSURE]
    swelling = Swelling(
        growth=solution.growth[PRESSURE],
        shortening=shortening,
        stretch=solution.axial[FORCE],
        growth_by_force=solution.growth[FORCE],
    )
    unknown = [layer.name for layer in layers if layer.expansions is None]
    expansion = None if unknown else solution.axial[WARMTH]
    path = load_path(v, design, stock, g, state, swelling, expansion)
    free = v["supply.pressure"] * swelling.growth
    driven_growth = state.driven_pressure * swelling.growth
    force_growth = swelling.growth_by_force * path.cases
    bending, shear = rod.layered_section(
        walls=solution.walls,
        thicknesses=[layer.thickness for layer in layers],
        inner_diameter=2 * g.inner_radius,
    )
    contraction = -swelling.growth_by_force / (g.inner_radius * swelling.stretch)
    ratio = g.inner_radius / g.outer_radius
    wall = Wall(
        swelling=swelling,
        path=path,
        growths={OWN: free + force_growth, NONE: free},
        case_growth=maximum(driven_growth + force_growth, driven_growth),
        bending_stiffness=bending,
        shear_stiffness=shear * column.cowper_tube(poissons_ratio=contraction, radius_ratio=ratio),
        thin_ratio=(g.outer_radius - g.inner_radius) / g.inner_radius,
        layered=len(layers) > 1,
        axial_line_stiffness=1 / (swelling.stretch * pi * (g.inner_radius + g.outer_radius)),
        missing=missing,
    )
    if unknown:
        wall.why_no_mismatch = f"the thermal expansion of {unknown[0]} is unknown"
        states = tuple(Climate(state.name, 0.0, cold=state.cold) for state in states)
    else:
        wall.expansion = (solution.axial[WARMTH], solution.warm_hoop)
        if layers[0].isotropic:
            wall.warm_liner = solution.stress[0][0, 0, WARMTH]
    if exact:
        wall.autofrettage = _autofrettage(v, design, layers, g)
    residual = _ResidualStress(solution, states, path, wall.autofrettage)
    _cooling(layers, residual.from_cure(), wall, exact=exact)
    _strengths(design, layers, residual, v["supply.pressure"], wall)
    _ladder(layers, states, g, path, wall, exact=exact)
    _axial_rupture(stock, layers, states, g, path, wall)
    return wall


def _held(path: LoadPath, states: Sequence[Climate]) -> Array:
    """Axial force in the wall at zero pressure, (climates, designs) [N]."""
    return np.stack([np.atleast_1d(array_of(force)) for force in path.held_in(len(states))])


@dataclass(frozen=True, slots=True)
class _ResidualStress:
    """Residual stresses without pressure: cure cool-down, tie rods, autofrettage."""

    solution: WallSolution
    states: Sequence[Climate]
    path: LoadPath
    autofrettage: Autofrettage | None

    def cured(self) -> bool:
        """Whether a service temperature differs from the cure temperature (stress-free state)."""
        return any(bool(np.any(real(state.change))) for state in self.states)

    def from_cure(self) -> _ResidualStress:
        """Copy with the stress of cooling after cure only, without autofrettage and tie rods."""
        return replace(self, path=replace(self.path, clamp=None), autofrettage=None)

    def of(self, rows: list[int]) -> Stress | None:
        """Residual stress of some layers, (faces, layers, climates, 1, designs).

        `rows` are the indices of the layers. The faces are the inner and outer face of each layer,
        the climates the coldest and hottest service temperature.
        """
        clamped = self.path.clamp is not None
        if not clamped and self.autofrettage is None and not self.cured():
            return None
        change = np.stack([np.atleast_1d(state.change) for state in self.states])
        parts = []
        for k, part in enumerate(self.solution.stress):
            unit = part[:, rows]  # two steps: a list with an integer moves axes
            stress = unit[:, :, WARMTH, None] * change
            if clamped:
                stress = stress + unit[:, :, FORCE, None] * _held(self.path, self.states)
            if self.autofrettage is not None:
                stress = stress + self.autofrettage.stresses[k][:, rows][:, :, None]
            parts.append(stress[:, :, :, None])
        return plies.stress_of(parts)


def _autofrettage(
    v: Values, design: Design, layers: Sequence[Layer], g: Geometry
) -> Autofrettage | None:
    """Residual stress of autofrettage; None if not stated or not covered by the model.

    The barrel is overpressurised once, without axial force, before it is machined.
    """
    if design.barrel.autofrettage_pressure is None or not layers[0].yields:
        return None
    if not all(layer.balanced for layer in layers):
        return None
    change: Array = 0.0
    if design.environment is not None and design.environment.cure_temperature is not None:
        change = v["environment.assembly_temperature"] - v["environment.cure_temperature"]
    none = 0.0 * np.atleast_1d(array_of(g.inner_radius))
    return autofrettage(
        layers=[layer.as_tube() for layer in layers],
        yield_strength=layers[0].yield_strength,
        inner_radius=g.inner_radius + none,
        pressure=v["barrel.autofrettage_pressure"] + none,
        axial_force_per_pressure=none,
        temperature_change=change,
    )


def _load(solution: WallSolution, rows: list[int], axial: Array) -> Stress:
    """Stress per unit pressure in some layers, (faces, layers, 1, paths, designs).

    `rows` are the indices of the layers. The faces are the inner and outer face of each layer.
    `axial` is the axial force per unit pressure on each load path (without and with axial force),
    (paths, designs).
    """
    parts = []
    for part in solution.stress:
        unit = part[:, rows]
        parts.append((unit[:, :, PRESSURE, None] + unit[:, :, FORCE, None] * axial)[:, :, None])
    return plies.stress_of(parts)


def _by_climate(values: Sequence[Array]) -> Array:
    """Arrange a layer's strengths, one per service temperature, on the axes of its stresses."""
    rows = np.stack(np.broadcast_arrays(*[np.atleast_1d(value) for value in values]))
    return rows[None, None, :, None]


def _strengths(
    design: Design, layers: Sequence[Layer], residual: _ResidualStress, supply: Array, wall: Wall
) -> None:
    """Compute pressures at first-ply failure and yield, by layer, failure mode and load path.

    The load paths are pressure without and with axial force.
    """
    paths, axial = tuple(wall.path.per_pressure), np.stack(list(wall.path.per_pressure.values()))
    brittle = [i for i, layer in enumerate(layers) if layer.strengths]
    if brittle:
        load = _load(residual.solution, brittle, axial)
        held = residual.of(brittle)
        wall.plies = Plies(
            criterion=design.barrel.criterion,
            layers=layers,
            rows=brittle,
            climates=residual.states,
            load=plies.stress_of(part[:, :, :, -1:] for part in load),
            residual=held,
        )
        modes = plies.utilisations(
            design.barrel.criterion, [layers[i] for i in brittle], load, held
        )
        amplitude = plies.worst(load[0], (0, 2)) * supply / 2
        for group, utilisation in plies.grouped(modes).items():
            pressures = load_multiplier(plies.worst(utilisation, (0,)))
            for k, i in enumerate(brittle):
                for place, pressure in _rows(residual.states, paths, pressures[k]):
                    wall.first_ply_pressure[f"{layers[i].label} {group}, {place}"] = pressure
        for k, i in enumerate(brittle):
            if layers[i].fatigue is not None:
                factors = load_multiplier(amplitude[k] / layers[i].fatigue)
                for p, place in enumerate(paths):
                    wall.ply_fatigue[f"{layers[i].label}, {place}"] = factors[p]
    for i, layer in enumerate(layers):
        if layer.yields:
            load = _load(residual.solution, [i], axial)
            metal = Metal(
                label=layer.label,
                layer=i,
                material=layer.name,
                yields=layer.yields,
                climates=residual.states,
                load=load,
                residual=residual.of([i]),
            )
            yields, cycles = metal_rows(metal, paths, supply)
            wall.yield_pressure |= yields
            wall.cycles |= cycles
            largest = plies.stress_of(part[:, :, :, -1:] for part in load)
            wall.metals.append(replace(metal, load=largest))


def first_ply_changed(known: Plies, change: Stress) -> Iterator[tuple[str, Array]]:
    """Pressures at first-ply failure, by layer and climate, of a wall that bends.

    `change` is the change of stress per unit pressure, with the axes of `Plies.load`. It has no
    radial stress, so modes of radial stress alone are left out.
    """
    load = plies.stress_of(a + b for a, b in zip(known.load, change, strict=True))
    modes = plies.utilisations(
        known.criterion, [known.layers[i] for i in known.rows], load, known.residual
    )
    highest = reduce(maximum, [m for name, m in modes.items() if not name.startswith("radial")])
    pressures = load_multiplier(plies.worst(highest, (0,)))
    for k, i in enumerate(known.rows):
        for place, pressure in _rows(known.climates, ("",), pressures[k]):
            yield ", ".join(x for x in (known.layers[i].label, place) if x), pressure


def _rows(
    states: Sequence[Climate], paths: tuple[str, ...], values: Array
) -> Iterator[tuple[str, Array]]:
    """Yield values (climates, paths, designs) for each climate and load path, with their names.

    A climate is the coldest or hottest service temperature, a load path pressure without or with
    axial force. The optimiser treats each pair as a separate smooth limit, because an optimum may
    lie where two of these limits intersect.
    """
    for t in range(values.shape[0]):
        for p, place in enumerate(paths):
            yield ", ".join(x for x in (states[t].name, place) if x), values[t, p]


def metal_rows(
    metal: Metal, paths: tuple[str, ...], supply: Array
) -> tuple[dict[str, Array], dict[str, Cycle]]:
    """Pressure at yield of a metal layer, and its stress under pulsating pressure, by location.

    `paths` name the load paths of `metal.load`. The pulse goes from the residual stress to the
    stress at supply pressure. The mean stress is the larger of the equivalent stresses at both ends
    of the pulse, minus half the range. A negative mean counts as zero, so compression does not
    increase the life.
    """
    load, residual = metal.load, metal.residual
    limit = _by_climate(metal.yields)
    utilisation = strength.yield_utilisation(stress=load, yield_strength=limit, residual=residual)
    pressures = {
        f"{metal.label}, {place}": pressure
        for place, pressure in _rows(metal.climates, paths, 1 / plies.worst(utilisation, (0, 1)))
    }
    pulse = liner.liner_cycle(
        stress=(supply * load[0], supply * load[1], supply * load[2], supply * load[3]),
        yield_strength=1.0,
        youngs_modulus=1.0,
        residual=(0.0, 0.0, 0.0, 0.0) if residual is None else residual,
    )
    peak = maximum(pulse.at_rest, pulse.at_pressure)
    mean = plies.worst(maximum(peak - pulse.strain_range / 2, 0.0 * peak), (0, 1, 2))
    span = plies.worst(pulse.strain_range, (0, 1, 2))
    return pressures, {
        f"{metal.label}, {place}": Cycle(metal.material, span[p], mean[p])
        for p, place in enumerate(paths)
    }


def _cooling(
    layers: Sequence[Layer], residual: _ResidualStress, wall: Wall, *, exact: bool
) -> None:
    """Compute strength divided by stress, after cooling from cure, of the liner and of its bond."""
    liners = [i for i, layer in enumerate(layers) if layer.yields]
    if not liners or len(liners) == len(layers):
        wall.why_no_mismatch = "the wall has no liner under plies"
        return
    stresses = residual.of(liners)
    if stresses is None:
        if wall.expansion is not None:
            wall.why_no_mismatch = "no cure temperature stated: add environment.cure_temperature"
        return
    wall.why_no_mismatch = "the thin-laminate model has no radial stress at the liner"
    for k, i in enumerate(liners):
        stress = tuple(part[:, [k]] for part in stresses)
        used = strength.yield_utilisation(
            stress=(stress[0], stress[1], stress[2], stress[3]),
            yield_strength=_by_climate(layers[i].yields),
        )
        wall.mismatch[layers[i].label] = 1 / plies.worst(used, (0, 1, 2, 3))
        for neighbour, face in ((i - 1, 0), (i + 1, -1)):
            if not exact or not 0 <= neighbour < len(layers) or not layers[neighbour].strengths:
                continue
            pull = stress[2][face, 0, :, 0]
            allowed = np.stack(
                [
                    np.atleast_1d(ply_strength.tension_2)
                    for ply_strength in layers[neighbour].strengths
                ]
            )
            tension = real(pull) > 0
            used = where(tension, pull, 0.0) / allowed
            wall.bond[f"{layers[i].label} to {layers[neighbour].label}"] = load_multiplier(
                plies.worst(used, (0,))
            )


def _ladder(
    layers: Sequence[Layer],
    states: Sequence[Climate],
    g: Geometry,
    path: LoadPath,
    wall: Wall,
    *,
    exact: bool,
) -> None:
    """Compute burst pressures for each extreme service temperature and load path.

    The load paths are pressure without and with axial force. In a wall with a liner, also compute
    the pressure at which the first ply fails, allowing for yielding of the liner.
    """
    if wall.missing:
        return
    if all(layer.isotropic for layer in layers):
        wall.missing.append("burst is not modelled for a wall of several metals")
        return
    if not all(layer.balanced for layer in layers):
        wall.missing.append("burst is not modelled for unbalanced plies: use balanced pairs")
        return
    arguments = {
        "layers": [layer.as_wall() for layer in layers],
        "axial_force_per_pressure": np.stack(list(path.per_pressure.values()))[None],
    }
    if exact:
        change = np.stack([np.atleast_1d(state.change) for state in states])[:, None]
        arguments["inner_radius"] = g.inner_radius
        arguments["temperature_change"] = change if np.any(real(change)) else 0.0
        arguments["held_force"] = _held(path, states)[:, None]
    else:
        arguments["radius"] = (g.inner_radius + g.outer_radius) / 2
    distinct_arguments, of_all = distinct(arguments)
    model = tube_burst.burst_of_tube if exact else burst_ladder.burst_by_ply_discount
    ladder = model(**distinct_arguments)
    paths = tuple(path.per_pressure)
    for place, pressure in _rows(states, paths, of_all(ladder.burst_pressure)):
        wall.burst_pressure[place] = pressure
    if any(layer.isotropic for layer in layers):
        for place, pressure in _rows(states, paths, of_all(ladder.first_ply_pressure)):
            wall.first_ply_pressure[f"first ply with yielding liner, {place}"] = pressure


def _axial_rupture(
    stock: MaterialValues,
    layers: Sequence[Layer],
    states: Sequence[Climate],
    g: Geometry,
    path: LoadPath,
    wall: Wall,
) -> None:
    """Limit the burst pressures of a wall with metal layers by its axial strength."""
    metals = any(layer.isotropic for layer in layers)
    if not wall.burst_pressure or not metals or path.clamp is not None:
        return
    areas, radius = [], g.inner_radius
    for layer in layers:
        areas.append(mass.layer_area(inner_radius=radius, thickness=layer.thickness))
        radius = radius + layer.thickness
    for k, state in enumerate(states):
        strengths = [
            stock.allowable(layer.name, "ultimate_strength", "yield_strength", cold=state.cold)
            if layer.isotropic
            else layer.strengths[k].tension_1
            for layer in layers
        ]
        for place, axial in path.per_pressure.items():
            if place != NONE:
                name = ", ".join(part for part in (state.name, place) if part)
                wall.burst_pressure[f"{RUPTURE}, {name}"] = tube_burst.axial_rupture_pressure(
                    areas=areas,
                    strengths=strengths,
                    angles=[0.0 if layer.isotropic else layer.angle for layer in layers],
                    axial_force_per_pressure=axial,
                )
