"""Burst of a thin laminated wall by ply discount, for one design or for many at once.

The load grows from zero. The most stressed mode (maximum stress) fails first: a matrix or shear
failure softens every ply of that material and |angle|, a fibre failure ends the ladder; burst is
the largest load on it. An isotropic liner yields (von Mises) and then keeps the stress it has
reached while the rest of the load goes to the fibres: yielding is no failure. All designs of an
array climb the same fixed number of steps under masks, and a complex step follows each design's
own branch.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import reduce
from math import inf, pi
from typing import Any

from ..numeric import Array, absolute, maximum, namespace, real, where
from .ply import ply_stiffness
from .strength_modes import PlyStrength, load_multiplier

MODES = (
    "fibre tension",
    "matrix tension",
    "shear",
    "fibre compression",
    "matrix compression",
    "shear",
    "yield",
)
"""Names of the modes by their code in a ladder."""

_YIELD = 6
_NONE = 1e-300
_FLOOR = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class WallLayer:
    """One layer of a wall: a balanced pair with `strength`, or a metal with `yield_strength`.

    Parameters
    ----------
    youngs_modulus_1, youngs_modulus_2, poissons_ratio_12, shear_modulus_12 : elastic constants
        [Pa], [-]; of an isotropic layer E, E, nu, G
    thickness : thickness of the layer, of the whole pair [m]
    angle : winding angle from the tube axis [rad]
    strength : ply strengths of a composite; None for a metal
    yield_strength : yield strength of a metal [Pa]; None for a composite
    material : identity of the material: plies of one material and one |angle| soften together
    """

    youngs_modulus_1: Array
    youngs_modulus_2: Array
    poissons_ratio_12: Array
    shear_modulus_12: Array
    thickness: Array
    angle: Array = 0.0
    strength: PlyStrength | None = None
    yield_strength: Array | None = None
    material: Hashable = None


@dataclass(frozen=True, slots=True)
class LadderStep:
    """One failure on the way to burst: the layer (from the bore), the mode, the pressure [Pa]."""

    layer: int
    mode: str
    pressure: float


@dataclass(frozen=True, slots=True)
class BurstLadder:
    """Pressures of first ply failure, liner yield and burst [Pa], with every step's record.

    Parameters
    ----------
    first_ply_pressure : first failure of a composite ply
    burst_pressure : largest load of the ladder
    liner_yield_pressure : first yield of a metal layer in the intact wall; infinite without one
    record : per step the code mode * layers + layer, its load, whether the design still climbed
    order : index from the bore of each internal layer
    intact : 1/p of every mode in the intact wall, rows mode * layers + layer, then metals' yield
    """

    first_ply_pressure: Array
    burst_pressure: Array
    liner_yield_pressure: Array
    record: tuple[tuple[Array, Array, Array], ...]
    order: tuple[int, ...]
    intact: Array

    def modes(self) -> list[tuple[int, str]]:
        """Layer (from the bore) and mode of every row of `intact`."""
        layers, metals = len(self.order), self.intact.shape[0] - 6 * len(self.order)
        plies = [(self.order[i % layers], MODES[i // layers]) for i in range(6 * layers)]
        return plies + [(self.order[i], MODES[_YIELD]) for i in range(metals)]

    def steps(self, index: tuple[int, ...] = ()) -> tuple[LadderStep, ...]:
        """List the ladder of one design of the arrays; of a single design without an index."""
        layers = len(self.order)
        metals = layers * _YIELD
        ladder = []
        for code, pressure, counted in self.record:
            if not bool(counted[index]):
                break
            number = int(code[index])
            yields = number >= metals
            layer = number - metals if yields else number % layers
            mode = MODES[_YIELD if yields else number // layers]
            ladder.append(LadderStep(self.order[layer], mode, float(real(pressure[index]))))
        return tuple(ladder)


def _zero(values: Sequence[Array]) -> Array:
    """Return a zero that carries the joint shape and type of the arrays among the values."""
    total: Array = 0.0
    for value in values:
        if not isinstance(value, (float, int, complex)):
            total = total + 0 * value
    return total


def _layer_values(layer: WallLayer) -> tuple[Array, ...]:
    """Angle, thickness, elastic constants, then 1/X_t, 1/Y_t, 1/S, 1/X_c, 1/Y_c, 1/S, 1/yield.

    An inverse strength is zero where the mode does not exist.
    """
    s = layer.strength
    elastic = (
        layer.thickness,
        layer.youngs_modulus_1,
        layer.youngs_modulus_2,
        layer.poissons_ratio_12,
        layer.shear_modulus_12,
    )
    if s is None:
        held = 0.0 if layer.yield_strength is None else 1 / layer.yield_strength
        return (0.0, *elastic, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, held)
    shear = 1 / s.shear_12
    tension = (1 / s.tension_1, 1 / s.tension_2, shear)
    compression = (1 / s.compression_1, 1 / s.compression_2, shear)
    return (layer.angle, *elastic, *tension, *compression, 0.0)


@dataclass(frozen=True, slots=True)
class _Wall:
    """The layers as arrays, metals first; tables hold the intact and the softened state.

    Rows of a table (first axis): stresses 1, 2, 12 per axial strain, the same per hoop strain,
    line stiffness zz, zt, tt, inverse strengths 1, 2, 12 in tension, in compression, 1/yield.
    """

    intact: Array
    softened: Array
    thickness: Array
    together: Array
    metals: int
    order: tuple[int, ...]


def _table(
    xp: Any, angle: Array, thickness: Array, moduli: tuple[Array, ...], strengths: Array
) -> Array:
    """Rows of the layers' table, for the states of the moduli along the second axis."""
    double = 2 * angle
    along = (1 + xp.cos(double)) / 2
    across, shift = 1 - along, xp.sin(double)
    q11, q12, q22, q66 = ply_stiffness(
        youngs_modulus_1=moduli[0],
        youngs_modulus_2=moduli[1],
        poissons_ratio_12=moduli[2],
        shear_modulus_12=moduli[3],
    )
    slip = q66 * shift
    axial_1, axial_2 = q11 * along + q12 * across, q12 * along + q22 * across
    hoop_1, hoop_2 = q11 * across + q12 * along, q12 * across + q22 * along
    twist = shift * slip
    line_axial = (along * axial_1 + across * axial_2 + twist) * thickness
    line_cross = (along * hoop_1 + across * hoop_2 - twist) * thickness
    line_hoop = (across * hoop_1 + along * hoop_2 + twist) * thickness
    rows = (axial_1, axial_2, -slip, hoop_1, hoop_2, slip, line_axial, line_cross, line_hoop)
    stiffness = xp.stack(rows)
    return xp.concat([stiffness, strengths + 0 * stiffness[:1, ...]])


def _build(xp: Any, layers: Sequence[WallLayer], dims: int, residual: float) -> _Wall:
    """Stack the layers and both states of their stiffness and strength."""
    order = tuple(sorted(range(len(layers)), key=lambda i: layers[i].strength is not None))
    walls = [layers[i] for i in order]
    count, ones = len(walls), (1,) * dims
    columns = [_layer_values(wall) for wall in walls]
    zero = _zero([value for column in columns for value in column])
    fibres = [float(wall.strength is not None) for wall in walls]
    values = list(zip(*columns, strict=True))
    if isinstance(zero, float):
        stacked = xp.reshape(xp.asarray(values), (len(values), count, *ones))
        angle, thickness, constants = stacked[0, ...], stacked[1, ...], stacked[2:, ...]
    else:
        zero = xp.reshape(zero, (1,) * (dims - zero.ndim) + zero.shape)
        angle, thickness = (xp.stack([value + zero for value in row]) for row in values[:2])
        if isinstance(_zero([value for row in values[2:] for value in row]), float):
            constants = xp.reshape(xp.asarray(values[2:]), (len(values) - 2, count, *ones))
        else:
            rows = [xp.stack([value + zero for value in row]) for row in values[2:]]
            constants = xp.stack(rows)
    states = [
        [[1.0] * count, [residual + (1 - residual) * fibre for fibre in fibres]],
        [[1.0] * count, [residual] * count],
        [[1.0] * count, [1 + (residual - 1) * fibre for fibre in fibres]],
        [[1.0] * count, [residual] * count],
        *([[1.0] * count, [float(mode in (0, 3))] * count] for mode in range(7)),
    ]
    factors = xp.reshape(xp.asarray(states), (11, 2, count, *ones))
    scaled = constants[:, None, ...] * factors
    moduli = tuple(scaled[i, ...] for i in range(4))
    table = _table(xp, angle, thickness, moduli, scaled[4:, ...])
    same = [
        [
            i == j or (a.material == b.material and fibres[i] * fibres[j] > 0)
            for j, b in enumerate(walls)
        ]
        for i, a in enumerate(walls)
    ]
    turned = absolute(real(angle))
    alike = xp.reshape(xp.asarray(same), (count, count, *ones))
    together = alike & (turned[:, None, ...] == turned[None, ...])
    return _Wall(table[:, 0, ...], table[:, 1, ...], thickness, together, fibres.count(0.0), order)


def _stress(xp: Any, table: Array, axial_line: Array, hoop_line: Array) -> Array:
    """Ply stresses 1, 2, 12 of every layer under line forces."""
    stiff = xp.sum(table[6:9, ...], axis=1)
    axial, cross, hoop = stiff[0, ...], stiff[1, ...], stiff[2, ...]
    inverse = 1 / (axial * hoop - cross * cross)
    axial_strain = (hoop * axial_line - cross * hoop_line) * inverse
    hoop_strain = (axial * hoop_line - cross * axial_line) * inverse
    return table[0:3, ...] * axial_strain + table[3:6, ...] * hoop_strain


def _above(value: Array) -> Array:
    """`value`, not below a small positive number: a strength already used up."""
    return where(real(value) > _FLOOR, value, 0 * value + _FLOOR)


def _yield_rows(xp: Any, rate: Array, base: Array | None, inverse: Array) -> Array:
    """1/p at which the stress base + p rate of a metal reaches yield by von Mises.

    A single metal layer is free of frozen stress until it yields itself: no base.
    """
    first, second = rate[0, ...] * inverse, rate[1, ...] * inverse
    square = first * first - first * second + second * second
    if base is None:
        return xp.sqrt(square)
    held_1, held_2 = base[0, ...] * inverse, base[1, ...] * inverse
    left = _above(1 - held_1 * held_1 + held_1 * held_2 - held_2 * held_2)
    linear = first * held_1 + second * held_2 - (first * held_2 + second * held_1) / 2
    return (linear + xp.sqrt(linear * linear + left * square)) / left


def _utilisations(xp: Any, metals: int, table: Array, rate: Array, base: Array | None) -> Array:
    """1/p of every mode: first axis mode by layer, then the metals' yield."""
    modes = xp.concat([rate, -rate]) * table[9:15, ...]
    if base is not None:
        modes = modes / _above(1 - xp.concat([base, -base]) * table[9:15, ...])
    rows = xp.reshape(modes, (6 * modes.shape[1], *modes.shape[2:]))
    if not metals:
        return rows
    frozen = None if base is None or metals == 1 else base[:, :metals, ...]
    yields = _yield_rows(xp, rate[:, :metals, ...], frozen, table[15, :metals, ...])
    return xp.concat([rows, yields])


def _critical(xp: Any, values: Array, rows: Array, shape: Array) -> tuple[Array, ...]:
    """Code, one-hot mask and load of the largest utilisation; whether any mode is loaded."""
    code = xp.argmax(real(values), axis=0)
    hit = rows == code
    inverse = xp.sum(where(hit, values, 0.0), axis=0)
    idle = real(inverse) <= _NONE
    pressure = where(idle, shape + inf, 1 / where(idle, shape + 1, inverse))
    return code, hit, pressure, ~idle


def _softening(xp: Any, hit: Array, count: int, metals: int) -> Array:
    """Which layer loses stiffness at this step: by matrix or shear failure, or by yield."""
    modes = xp.reshape(hit[: 6 * count, ...], (6, count, *hit.shape[1:]))
    matrix = modes[1, ...] | modes[2, ...] | modes[4, ...] | modes[5, ...]
    if not metals:
        return matrix
    return xp.concat([hit[6 * count :, ...], matrix[metals:, ...]])


def burst_by_ply_discount(
    *,
    layers: Sequence[WallLayer],
    radius: Array,
    axial_force_per_pressure: Array,
    residual: float = 1e-3,
    liner_share: float = 1.0,
) -> BurstLadder:
    """First ply failure and burst of a thin laminated wall.

    Line forces N_t = p R, N_z = N/(2 pi R); critical mode by maximum stress; matrix or shear
    failure multiplies E2, G12, nu12 of all plies of that material and |angle| by `residual` and
    removes their matrix limits; burst is the largest load recorded until a fibre mode governs.
    A metal layer that yields keeps `liner_share` of its stress at yield, and `residual` of its
    stiffness for what follows.

    Parameters
    ----------
    layers : the wall from the bore outwards
    radius : R, mid-radius of the wall [m] (a choice)
    axial_force_per_pressure : N/p [m^2]; 0 is open, pi R^2 closed
    residual : stiffness left in a failed ply [-]
    liner_share : stress a yielded metal keeps [-]: 1 perfectly plastic, 0 as if it were gone

    Returns
    -------
    pressures [Pa] and the ladder; the arrays broadcast over cases and designs

    Notes
    -----
    Valid: thin walls with fibres.

    A wall of metals only returns its yield (use `barrel.burst_pressure_thick`). The frozen liner
    stress is in equilibrium, is nowhere above
    yield and makes all pressures continuous where yield and ply failure coincide.

    References
    ----------
    [Jones1999] ply discount; liner [derived] from elastic, perfectly plastic equilibrium

    Examples
    --------
    >>> ply = dict(youngs_modulus_1=138e9, youngs_modulus_2=9e9, poissons_ratio_12=0.28,
    ...            shear_modulus_12=5e9, strength=PlyStrength(1900e6, 1300e6, 55e6, 190e6, 85e6))
    >>> wall = [WallLayer(**ply, thickness=0.9e-3, angle=pi / 2),
    ...         WallLayer(**ply, thickness=0.7e-3, angle=pi / 6)]
    >>> ladder = burst_by_ply_discount(layers=wall, radius=16.8e-3,
    ...                                axial_force_per_pressure=pi * 16.8e-3**2)
    >>> print(*(f"{s.layer} {s.mode} {s.pressure / 1e6:.2f}" for s in ladder.steps()), sep=", ")
    1 matrix tension 46.12, 0 matrix tension 47.06, 1 fibre tension 118.77
    """
    axial_line = axial_force_per_pressure / (2 * pi * radius)
    shape = _zero([v for layer in layers for v in _layer_values(layer)]) + 0 * axial_line
    xp = namespace(shape)
    shape = xp.asarray(shape)
    wall = _build(xp, layers, shape.ndim, residual)
    count, metals = len(layers), wall.metals
    rows = xp.reshape(xp.arange(6 * count + metals), (-1,) + (1,) * shape.ndim)
    infinite = shape + inf
    highest, first, liner_yield = shape, infinite, infinite
    climbing = untouched = real(shape) == 0
    table, base, held, soft, intact = wall.intact, None, None, None, None
    kept = wall.thickness[:metals, ...] * ((1 - residual) * liner_share)
    record = []
    for _ in range(count + 1):
        rate = _stress(xp, table, axial_line, radius)
        if held is not None:
            base = -_stress(xp, table, held[0, ...], held[1, ...])
        values = _utilisations(xp, metals, table, rate, base)
        if intact is None:
            intact = values
        if metals and soft is None:
            liner_yield = load_multiplier(
                reduce(maximum, [values[i - metals, ...] for i in range(metals)])
            )
        code, hit, pressure, found = _critical(xp, values, rows, shape)
        counted = climbing & found
        record.append((code, pressure, counted))
        highest = where(counted, maximum(highest, pressure), highest)
        event = _softening(xp, hit, count, metals)
        fresh = xp.any(wall.together & event[None, ...], axis=1) & counted
        plied = counted
        if metals:
            yielded = event[:metals, ...] & counted
            plied = counted & ~xp.any(yielded, axis=0)
            stress = rate[:2, :metals, ...] * where(counted, pressure, shape)
            if base is not None:
                stress = stress + base[:2, :metals, ...]
            stress = xp.sum(where(yielded, stress * kept, 0.0), axis=1)
            held = stress if held is None else held + stress
        first = where(plied & untouched, highest, first)
        untouched = untouched & ~plied
        climbing = counted & xp.any(event, axis=0)
        if not bool(xp.any(climbing)):
            break
        soft = fresh if soft is None else soft | fresh
        table = where(soft, wall.softened, wall.intact)
    return BurstLadder(first, highest, liner_yield, tuple(record), wall.order, intact)
