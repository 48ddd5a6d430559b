"""Temperatures of an actuator: a network of oil, wall layers, rod and caps that loses heat to air.

The nodes are the oil of both chambers, the middle of each layer of the wall, and any number of
lumped parts (rod, caps) between oil and air. Only convection and radiation to air depend on
temperature. Newton's method runs on the surfaces alone: all other nodes are eliminated once.

Resistances of a layer stand half on both sides of its node, which is exact for the temperatures of
its faces. Conduction along the wall and between wall and caps is left out, on the hot side.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import nan, pi
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import (
    Array,
    absolute,
    clip,
    geometry,
    histories,
    maximum,
    namespace,
    over_time,
    positive,
    real,
    where,
)
from .fluid import ATMOSPHERIC_PRESSURE
from .heat_transfer import (
    convection_coefficient,
    film_resistance,
    layer_resistance,
    radiation_coefficient,
)

PASSES = 8
"""Steps of Newton's method on the surface temperatures; up to 500 K, 5 are enough."""
CLOSURE = 1e-10
"""Largest imbalance of heat at a surface, as a share of the largest heat flow."""
PROBE = 1e-3
"""Change of a surface temperature [K] that gives the slope of its heat loss."""
FIRST_COEFFICIENT = 15.0
"""Film coefficient to air [W/(m^2 K)] of the first estimate: still air and radiation."""
FIRST_RISE = 200.0
"""Largest first estimate of a surface's rise, either way [K]."""


@dataclass(frozen=True, slots=True)
class ThermalLayer:
    """A layer of the wall.

    Parameters
    ----------
    thickness : [m]
    conductivity : through the wall [W/(m K)]
    volumetric_heat : density times specific heat [J/(m^3 K)]
    heat : that enters at its middle [W]
    """

    thickness: Array
    conductivity: Array
    volumetric_heat: Array
    heat: Array = 0.0


@dataclass(frozen=True, slots=True)
class ThermalPart:
    """A part of one temperature between oil and air: the rod, or a cap.

    Parameters
    ----------
    oil_conductance : to the oil, 1/(1/(h A) + t/(k A)) [W/K]
    area : of the surface to air [m^2]
    diameter : of that surface, for convection [m]
    heat_capacity : [J/K]
    heat : that enters it [W]
    """

    oil_conductance: Array
    area: Array
    diameter: Array
    heat_capacity: Array
    heat: Array = 0.0


@dataclass(frozen=True, slots=True)
class OilNode:
    """Oil of both chambers.

    Parameters
    ----------
    film_coefficient : to the bore, h_i [W/(m^2 K)]
    heat_capacity : density times specific heat times mean volume [J/K]
    heat : that enters it [W]
    exchange_conductance : density times specific heat times exchanged flow [W/K]
    inlet_temperature : of the fresh oil, heated by the throttle [K]
    """

    film_coefficient: Array
    heat_capacity: Array
    heat: Array = 0.0
    exchange_conductance: Array = 0.0
    inlet_temperature: Array = 293.15


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Air around the actuator.

    Parameters
    ----------
    temperature : of air and walls [K]
    air_speed : across the axis [m/s]
    emissivity : of all surfaces [-]
    absolute_pressure : of the air [Pa]
    film_coefficient : convection and radiation together [W/(m^2 K)]; None: computed
    """

    temperature: Array
    air_speed: Array = 0.0
    emissivity: Array = 0.9
    absolute_pressure: Array = ATMOSPHERIC_PRESSURE
    film_coefficient: Array | None = None


@dataclass(frozen=True, slots=True)
class ThermalNetwork:
    """Nodes and conductances of an actuator; from `thermal_network`.

    Parameters
    ----------
    oil : its node
    layers, parts : wall layers from inside to outside; rod and caps
    conductances : oil to layer 1, between the layers, last layer to the outer surface [W/K]
    film_share : share of the first conductance's resistance that is oil film [-]
    inner_shares : share of each resistance between two layers on the inner layer's side [-]
    layer_capacities : [J/K]
    outer_diameter, outer_area : of the wall [m], [m^2]
    """

    oil: OilNode
    layers: tuple[ThermalLayer, ...]
    parts: tuple[ThermalPart, ...]
    conductances: tuple[Array, ...]
    film_share: Array
    inner_shares: tuple[Array, ...]
    layer_capacities: tuple[Array, ...]
    outer_diameter: Array
    outer_area: Array

    @property
    def heats(self) -> list[Array]:
        """Heat into oil, layers and parts [W]; without that of exchanged oil."""
        return [self.oil.heat, *(e.heat for e in self.layers), *(e.heat for e in self.parts)]

    @property
    def capacities(self) -> list[Array]:
        """Heat capacities of oil, layers and parts [J/K]."""
        parts = (part.heat_capacity for part in self.parts)
        return [self.oil.heat_capacity, *self.layer_capacities, *parts]

    @property
    def surfaces(self) -> list[tuple[Array, Array]]:
        """Area [m^2] and diameter [m] of the wall's outer surface and of every part."""
        return [(self.outer_area, self.outer_diameter), *((p.area, p.diameter) for p in self.parts)]


@dataclass(frozen=True, slots=True)
class SteadyTemperatures:
    """Steady state of a network.

    Parameters
    ----------
    oil : [K]
    layers : at the middle of each layer [K]
    parts : rod and caps [K]
    surface : of the wall, outside [K]
    faces : inner face of each layer [K]
    air_conductances : from the outer surface and from each part to air [W/K]
    """

    oil: Array
    layers: tuple[Array, ...]
    parts: tuple[Array, ...]
    surface: Array
    faces: tuple[Array, ...]
    air_conductances: tuple[Array, ...]

    @property
    def nodes(self) -> list[Array]:
        """Temperatures of oil, layers and parts [K]."""
        return [self.oil, *self.layers, *self.parts]


@geometry
def thermal_network(
    *,
    bore: Array,
    length: Array,
    wetted_length: Array,
    oil: OilNode,
    layers: Sequence[ThermalLayer],
    parts: Sequence[ThermalPart] = (),
) -> ThermalNetwork:
    """Network of an actuator: conductances between oil, layers of the wall and outer surface.

    Oil to layer 1: 1/(1/(h_i pi D L_w) + R_1/2); between layers: 1/(R_k/2 + R_{k+1}/2); last layer
    to the surface: 2/R_n, with R_k of `heat_transfer.layer_resistance`.

    Parameters
    ----------
    bore : D [m]
    length : L of the wall that gives heat to air [m]
    wetted_length : L_w of the bore that oil touches [m]
    oil : properties of the oil's node [-]
    layers : from inside to outside, at least one [-]
    parts : rod, caps; each between oil and air [-]

    Returns
    -------
    conductances [W/K] and heat capacities [J/K]

    Raises
    ------
    ValueError
        No layer.

    Notes
    -----
    Valid: radial conduction; film uniform along the bore.

    References
    ----------
    [derived] half of a layer's resistance on both sides of its node

    Examples
    --------
    >>> wall = [ThermalLayer(0.6e-3, 130.0, 2.688e6, heat=6.0), ThermalLayer(1.2e-3, 0.6, 1.4915e6),
    ...         ThermalLayer(0.8e-3, 0.6, 1.4915e6)]
    >>> network = thermal_network(bore=23e-3, length=0.138, wetted_length=0.11,
    ...                           oil=OilNode(250.0, 66.12, heat=2.0), layers=wall)
    >>> print(" ".join(f"{g:.4f}" for g in network.conductances))
    1.9862 10.9765 6.8020 17.8134
    """
    if not layers:
        raise ValueError("state at least one layer of the wall")
    radius = 0.5 * bore
    film = film_resistance(film_coefficient=oil.film_coefficient, area=pi * bore * wetted_length)
    halves, capacities = [], []
    for layer in layers:
        outer = radius + layer.thickness
        resistance = layer_resistance(
            inner_radius=radius, outer_radius=outer, length=length, conductivity=layer.conductivity
        )
        halves.append(0.5 * resistance)
        section = pi * (outer + radius) * layer.thickness
        capacities.append(section * length * layer.volumetric_heat)
        radius = outer
    sums = [film + halves[0], *(a + b for a, b in pairwise(halves))]
    return ThermalNetwork(
        oil=oil,
        layers=tuple(layers),
        parts=tuple(parts),
        conductances=(*(1 / total for total in sums), 1 / halves[-1]),
        film_share=film / sums[0],
        inner_shares=tuple(half / total for half, total in zip(halves, sums[1:], strict=False)),
        layer_capacities=tuple(capacities),
        outer_diameter=2 * radius,
        outer_area=2 * pi * radius * length,
    )


def steady_temperatures(
    *, network: ThermalNetwork, surroundings: Surroundings
) -> SteadyTemperatures:
    """Steady temperatures: heat in equals heat to air and to exchanged oil at every node.

    G T + sum of A h(T_s) (T_s - T_a) = q by Newton's method on the surface temperatures, with
    `PASSES` steps. The slope of a heat loss is its difference over `PROBE`. The result and its
    derivatives are those of the exact solution to 1e-12 and 1e-8: near it, each step reduces the
    error at least 1000 times.

    Parameters
    ----------
    network : from `thermal_network` [-]
    surroundings : temperature and speed of the air [-]

    Returns
    -------
    temperatures [K], conductances to air [W/K]; NaN where the heat balances do not close

    Notes
    -----
    Valid: surfaces from 200 to 800 K; film coefficients as in `heat_transfer`.

    References
    ----------
    [derived] heat balance of every node; Newton's method on the Schur complement of the surfaces

    Examples
    --------
    >>> wall = [ThermalLayer(0.6e-3, 130.0, 2.688e6, heat=6.0), ThermalLayer(1.2e-3, 0.6, 1.4915e6),
    ...         ThermalLayer(0.8e-3, 0.6, 1.4915e6)]
    >>> network = thermal_network(bore=23e-3, length=0.138, wetted_length=0.11,
    ...                           oil=OilNode(250.0, 66.12, heat=2.0), layers=wall)
    >>> state = steady_temperatures(network=network, surroundings=Surroundings(293.15))
    >>> print(f"{state.oil - 293.15:.3f} {state.surface - 293.15:.3f}")
    51.259 47.898
    """
    ambient = surroundings.temperature
    rises = _Rises(network, surroundings)
    surfaces = network.surfaces
    first = len(rises.matrix) - len(surfaces)  # nodes before it are not in contact with air
    matrix, right = _eliminated(rises.matrix, rises.right, 0, first)
    estimates = _estimate(matrix, right, surfaces, first)
    losses = []
    for _ in range(PASSES):
        losses = [
            _loss(ambient + rise, *surface, surroundings)
            for rise, surface in zip(estimates, surfaces, strict=True)
        ]
        beyond = [
            _loss(ambient + rise + PROBE, *surface, surroundings)
            for rise, surface in zip(estimates, surfaces, strict=True)
        ]
        slopes = [(b - a) / PROBE for a, b in zip(losses, beyond, strict=True)]
        offsets = [a - g * t for a, g, t in zip(losses, slopes, estimates, strict=True)]
        estimates = _surface_rises(matrix, right, slopes, offsets, first)
    losses = [
        _loss(ambient + rise, *surface, surroundings)
        for rise, surface in zip(estimates, surfaces, strict=True)
    ]
    closed = _closed(matrix, right, losses, estimates, first)
    estimates = [where(closed, rise, nan) for rise in estimates]
    inner = _back_substituted(matrix, right, estimates, first)
    return _state(network, ambient, [*inner, *estimates], surroundings)


def inner_faces(
    *, network: ThermalNetwork, oil: Array, layers: Sequence[Array]
) -> tuple[Array, ...]:
    """Temperature of the inner face of each layer, between the nodes on both sides.

    A face stores no heat: the share of a conductance's resistance on the inner side is its share of
    the temperature difference, also while the nodes warm up.

    Parameters
    ----------
    network : from `thermal_network` [-]
    oil : temperature of the oil [K]
    layers : temperature at the middle of each layer [K]

    Returns
    -------
    temperatures [K]

    Notes
    -----
    Valid: any temperatures.

    References
    ----------
    [derived] resistances in series

    Examples
    --------
    >>> wall = [ThermalLayer(0.6e-3, 130.0, 2.688e6), ThermalLayer(1.2e-3, 0.6, 1.4915e6)]
    >>> network = thermal_network(bore=23e-3, length=0.138, wetted_length=0.11,
    ...                           oil=OilNode(250.0, 66.12), layers=wall)
    >>> faces = inner_faces(network=network, oil=330.0, layers=[320.0, 310.0])
    >>> print(" ".join(f"{t:.3f}" for t in faces))
    320.004 319.975
    """
    faces = [oil + network.film_share * (layers[0] - oil)]
    for share, inner, outer in zip(network.inner_shares, layers, layers[1:], strict=False):
        faces.append(inner + share * (outer - inner))
    return tuple(faces)


class _Rises:
    """Matrix [W/K] and heats [W] of the rises over ambient: oil, layers, surface, parts.

    The heat to air is not in the matrix. Entries of nodes without contact are None.
    """

    def __init__(self, network: ThermalNetwork, surroundings: Surroundings) -> None:
        layers, parts = len(network.layers), len(network.parts)
        size = layers + 2 + parts
        self.matrix: list[list[Any]] = [[None] * size for _ in range(size)]
        oil = network.oil
        inlet = oil.inlet_temperature - surroundings.temperature
        heats: list[Array] = [network.heats[0] + oil.exchange_conductance * inlet]
        heats += [*network.heats[1 : layers + 1], 0.0, *network.heats[layers + 1 :]]
        self.right = heats
        self.matrix[0][0] = oil.exchange_conductance
        for node, conductance in enumerate(network.conductances):
            self._join(node, node + 1, conductance)
        for k, part in enumerate(network.parts):
            self._join(0, layers + 2 + k, part.oil_conductance)

    def _join(self, first: int, second: int, conductance: Array) -> None:
        for row, column in ((first, second), (second, first)):
            own = self.matrix[row][row]
            self.matrix[row][row] = conductance if own is None else own + conductance
            self.matrix[row][column] = -conductance


Matrix = list[list[Any]]


def _eliminated(
    matrix: Matrix, right: list[Array], start: int, end: int
) -> tuple[Matrix, list[Array]]:
    """Copies after eliminating the unknowns `start` to `end` from the rows below each.

    The matrix is symmetric with a dominant diagonal, so that no rows need exchanging.
    """
    matrix, right = [list(row) for row in matrix], list(right)
    for pivot in range(start, end):
        line = matrix[pivot]
        for row in range(pivot + 1, len(matrix)):
            entry = matrix[row][pivot]
            if entry is None:
                continue
            factor = entry / line[pivot]
            for column in range(pivot + 1, len(matrix)):
                if line[column] is not None:
                    own, change = matrix[row][column], factor * line[column]
                    matrix[row][column] = -change if own is None else own - change
            right[row] = right[row] - factor * right[pivot]
    return matrix, right


def _back_substituted(
    matrix: Matrix, right: list[Array], known: list[Array], end: int
) -> list[Array]:
    """Unknowns before `end` of an eliminated system whose last unknowns are known."""
    values = [0.0] * end + known
    for row in range(end - 1, -1, -1):
        total = right[row]
        for column in range(row + 1, len(matrix)):
            if matrix[row][column] is not None:
                total = total - matrix[row][column] * values[column]
        values[row] = total / matrix[row][row]
    return values[:end]


def _surface_rises(
    matrix: Matrix, right: list[Array], slopes: list[Array], offsets: list[Array], first: int
) -> list[Array]:
    """Rises of the surfaces whose heat to air is offset + slope times rise."""
    rows = [row[first:] for row in matrix[first:]]
    for k, slope in enumerate(slopes):
        rows[k][k] = rows[k][k] + slope
    heats = [a - b for a, b in zip(right[first:], offsets, strict=True)]
    rows, heats = _eliminated(rows, heats, 0, len(rows))
    return _back_substituted(rows, heats, [], len(rows))


def _estimate(
    matrix: Matrix, right: list[Array], surfaces: list[tuple[Array, Array]], first: int
) -> list[Array]:
    """Rises of the surfaces with the same film coefficient everywhere, within limits."""
    slopes = [FIRST_COEFFICIENT * area for area, _ in surfaces]
    rises = _surface_rises(matrix, right, slopes, [0.0] * len(slopes), first)
    return [clip(rise, -FIRST_RISE, FIRST_RISE) for rise in rises]


def _closed(
    matrix: Matrix, right: list[Array], losses: list[Array], rises: list[Array], first: int
) -> Array:
    """Whether the heat balance of every surface closes."""
    left: Array = 0.0
    scale: Array = 1e-6  # W
    for k, loss in enumerate(losses):
        total = right[first + k] - loss
        scale = maximum(scale, absolute(real(loss)))
        for column, rise in enumerate(rises, first):
            if matrix[first + k][column] is not None:
                flow = matrix[first + k][column] * rise
                total = total - flow
                scale = maximum(scale, absolute(real(flow)))
        left = maximum(left, absolute(real(total)))
    return left <= CLOSURE * scale


def _coefficient(temperature: Array, diameter: Array, air: Surroundings) -> Array:
    """Film coefficient to air, convection and radiation [W/(m^2 K)]."""
    if air.film_coefficient is not None:
        return air.film_coefficient + 0.0 * temperature
    convection = convection_coefficient(
        surface_temperature=temperature, ambient_temperature=air.temperature, diameter=diameter,
        air_speed=air.air_speed, absolute_pressure=air.absolute_pressure,
    )  # fmt: skip
    radiation = radiation_coefficient(
        emissivity=air.emissivity, surface_temperature=temperature,
        ambient_temperature=air.temperature,
    )  # fmt: skip
    return convection + radiation


def _loss(temperature: Array, area: Array, diameter: Array, air: Surroundings) -> Array:
    """Heat from a surface to air [W]."""
    return area * _coefficient(temperature, diameter, air) * (temperature - air.temperature)


def _state(
    network: ThermalNetwork, ambient: Array, rises: list[Array], air: Surroundings
) -> SteadyTemperatures:
    """Temperatures of all nodes and faces from the rises of the nodes."""
    layers = len(network.layers)
    temperatures = [ambient + rise for rise in rises]
    oil, wall = temperatures[0], temperatures[1 : layers + 1]
    conductances = tuple(
        area * _coefficient(temperature, diameter, air)
        for temperature, (area, diameter) in zip(
            temperatures[layers + 1 :], network.surfaces, strict=True
        )
    )
    return SteadyTemperatures(
        oil=oil,
        layers=tuple(wall),
        parts=tuple(temperatures[layers + 2 :]),
        surface=temperatures[layers + 1],
        faces=inner_faces(network=network, oil=oil, layers=wall),
        air_conductances=conductances,
    )


def _rates(network: ThermalNetwork, steady: SteadyTemperatures) -> tuple[Any, Any]:
    """Symmetric matrix of conductances (nodes, nodes) and capacities: oil, layers, parts.

    The outer surface stores no heat; its conductances stand in series.
    """
    layers = len(network.layers)
    size = 1 + layers + len(network.parts)
    matrix = np.zeros((size, size))
    matrix[0, 0] = network.oil.exchange_conductance
    pairs = [(k, k + 1, network.conductances[k]) for k in range(layers)]
    pairs += [(0, 1 + layers + k, part.oil_conductance) for k, part in enumerate(network.parts)]
    for first, second, conductance in pairs:
        matrix[[first, second], [first, second]] += conductance
        matrix[[first, second], [second, first]] -= conductance
    outer, air = network.conductances[layers], steady.air_conductances
    matrix[layers, layers] += outer * air[0] / (outer + air[0])
    for k in range(len(network.parts)):
        matrix[1 + layers + k, 1 + layers + k] += air[1 + k]
    return matrix, np.array([float(positive(c)) for c in network.capacities])


def _modal(network: ThermalNetwork, steady: SteadyTemperatures) -> tuple[Any, Any]:
    """Roots of the capacities, and the symmetric matrix C^(-1/2) G C^(-1/2) [1/s]."""
    matrix, capacities = _rates(network, steady)
    root = np.sqrt(capacities)
    return root, matrix / root / root[:, None]


def temperatures_after(
    *,
    network: ThermalNetwork,
    steady: SteadyTemperatures,
    start: Sequence[float],
    time: float | Array,
) -> tuple[Any, ...]:
    """Temperatures some time after the heat began, T = T_inf + exp(-C^-1 G t) (T_0 - T_inf).

    The coefficients are those of the steady state.

    Parameters
    ----------
    network : from `thermal_network`, of one design [-]
    steady : from `steady_temperatures` of that network [-]
    start : temperature of every node at the beginning, or a single one for all [K]
    time : since the beginning, a number or an array [s]

    Returns
    -------
    temperatures of oil, layers and parts, each of the shape of the time [K]; NaN without heat
    capacities

    Raises
    ------
    ValueError
        The number of temperatures is neither 1 nor that of the nodes.

    Notes
    -----
    Valid: real numbers; frozen coefficients err by less than 10 % of the rise.

    References
    ----------
    [derived] linear system of first order with constant coefficients, by the modes of the
    symmetric matrix C^(-1/2) G C^(-1/2)

    Examples
    --------
    >>> wall = [ThermalLayer(0.6e-3, 130.0, 2800 * 960.0, heat=6.0)]
    >>> network = thermal_network(bore=23e-3, length=0.138, wetted_length=0.11,
    ...                           oil=OilNode(250.0, 66.12, heat=2.0), layers=wall)
    >>> steady = steady_temperatures(network=network, surroundings=Surroundings(293.15))
    >>> after = temperatures_after(network=network, steady=steady, start=[293.15], time=600.0)
    >>> print(f"{after[0] - 293.15:.2f} of {steady.oil - 293.15:.2f}")
    34.98 of 54.40
    """
    final = np.array([float(value) for value in steady.nodes])
    if len(start) not in (1, len(final)):
        raise ValueError(f"state 1 or {len(final)} temperatures for the start")
    root, symmetric = _modal(network, steady)
    after = np.asarray(time, dtype=float)
    if not np.isfinite(symmetric).all():
        return tuple(np.full(after.shape, nan)[()] for _ in final)
    rates, modes = np.linalg.eigh(symmetric)
    change = np.broadcast_to(np.asarray(start, dtype=float), final.shape) - final
    shares = modes.T @ (root * change)
    decays = shares[:, None] * np.exp(-np.outer(rates, after))
    reached = final[:, None] + (modes / root[:, None]) @ decays
    return tuple(row.reshape(after.shape)[()] for row in reached)


def slowest_time_constant(*, network: ThermalNetwork, steady: SteadyTemperatures) -> float:
    """Longest time constant of the network, the largest eigenvalue of G^-1 C.

    Parameters
    ----------
    network : from `thermal_network`, of one design [-]
    steady : from `steady_temperatures` of that network [-]

    Returns
    -------
    time constant [s]

    Notes
    -----
    Valid: real numbers; small changes about the steady state.

    References
    ----------
    [derived] eigenvalues of C^(-1/2) G C^(-1/2), which is symmetric

    Examples
    --------
    >>> wall = [ThermalLayer(0.6e-3, 130.0, 2800 * 960.0, heat=6.0)]
    >>> network = thermal_network(bore=23e-3, length=0.138, wetted_length=0.11,
    ...                           oil=OilNode(250.0, 66.12, heat=2.0), layers=wall)
    >>> steady = steady_temperatures(network=network, surroundings=Surroundings(293.15))
    >>> print(f"{slowest_time_constant(network=network, steady=steady):.0f} s")
    578 s
    """
    _, symmetric = _modal(network, steady)
    if not np.isfinite(symmetric).all():
        return nan
    return 1 / float(np.linalg.eigvalsh(symmetric)[0])


def ripple_bound(
    *, time: Array | Sequence[Array], power: Array | Sequence[Array], heat_capacity: Array
) -> Array:
    """Largest deviation of a node's temperature from its mean over a closed cycle.

    (max - min of E)/C with E = integral of (P - mean P) dt. The node's own losses and its
    neighbours only reduce it.

    Parameters
    ----------
    time : of the samples, rising, on the first axis [s]
    power : heat into the node at the samples, linear between them [W]
    heat_capacity : C of the node [J/K], > 0

    Returns
    -------
    bound of the deviation, either way [K], without the time axis

    Raises
    ------
    ValueError
        Fewer than two samples, or lists of unequal length.

    Notes
    -----
    Valid: steady cycles; twice the bound holds for the range from lowest to highest.

    References
    ----------
    [derived] T - mean T = (E - its running mean over an exponential window)/C

    Examples
    --------
    >>> print(ripple_bound(time=[0.0, 1.0, 2.0], power=[0.0, 8.0, 0.0], heat_capacity=10.0))
    0.2
    """
    if len(time) != len(power) or len(time) < 2:
        raise ValueError("state two or more samples, with one power for each time")
    t, p = histories(time, power)
    xp = namespace(t, p)
    steps = t[1:, ...] - t[:-1, ...]
    excess = p - over_time(p, t) / (t[-1, ...] - t[0, ...])
    first, last = excess[:-1, ...], excess[1:, ...]
    energy = xp.cumulative_sum(0.5 * steps * (first + last), axis=0)
    before = xp.concat([0 * energy[:1, ...], energy[:-1, ...]], axis=0)
    turns = real(first) * real(last) < 0  # the extreme lies between the samples
    rise = where(turns, 0.5 * steps * first * first / where(turns, first - last, 1.0), 0.0)
    met = xp.concat([before[:1, ...], before + rise, energy], axis=0)
    highest, lowest = (
        xp.take_along_axis(met, pick(real(met), axis=0, keepdims=True), axis=0)[0, ...]
        for pick in (xp.argmax, xp.argmin)
    )
    return (highest - lowest) / positive(heat_capacity)
