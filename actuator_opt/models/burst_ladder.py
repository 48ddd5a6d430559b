"""Burst pressure by ply discount, for one design or many at once, with any model of the wall.

The load grows from zero. The mode with the largest utilisation by the maximum-stress criterion
fails first. A matrix or shear failure softens every ply of that material and |angle|; a fibre
failure ends the sequence. The sequence is called the ladder, and burst is its largest load. An
isotropic liner yields by von Mises and then keeps its stress at yield, while the fibres take the
further load: yielding is no failure.

All designs of an array take the same fixed number of steps; masks exclude designs that have failed
already. Derivatives by complex step are those of the sequence of failures that the design takes.
`Mechanics` gives the stresses under a load: for the thin laminate in this module, for the exact
tube in `tube_burst`.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import reduce
from math import inf, pi
from typing import Any, Protocol

from ..base.dataclass import dataclass
from ..base.numeric import (
    Array,
    absolute,
    finished,
    geometry,
    maximum,
    namespace,
    real,
    together,
    where,
)
from .ply import ply_stiffness
from .strength import yield_utilisation
from .strength_modes import PlyStrength, Stress, load_multiplier

__all__ = ["MODES", "BurstLadder", "LadderStep", "Mechanics", "WallLayer", "burst_by_ply_discount"]

MODES = (
    "fibre tension",
    "matrix tension",
    "shear",
    "fibre compression",
    "matrix compression",
    "shear",
    "yield",
)
"""Names of the failure modes, in the order of their codes."""

_YIELD = 6
_NONE = 1e-300
_FLOOR = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class WallLayer:
    """One layer of a wall: a balanced pair with `strength`, or a metal with `yield_strength`.

    Parameters
    ----------
    youngs_modulus_1, youngs_modulus_2, poissons_ratio_12, shear_modulus_12 : elastic constants
        [Pa], [-]; E, E, nu, G for an isotropic layer
    thickness : thickness of the layer [m]; of a pair, both plies together
    angle : winding angle from the tube axis [rad]
    strength : ply strengths of a composite; None for a metal
    yield_strength : yield strength of a metal [Pa]; None for a composite
    material : identity of the material: plies with the same material and |angle| soften together
    expansion_1, expansion_2 : thermal expansions along and across the fibre [1/K]
    youngs_modulus_3, poissons_ratio_13, poissons_ratio_23 : radial constants [Pa], [-]; None takes
        E2, nu12 and 0.4 for a ply, E and nu for a metal
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
    expansion_1: Array = 0.0
    expansion_2: Array = 0.0
    youngs_modulus_3: Array | None = None
    poissons_ratio_13: Array | None = None
    poissons_ratio_23: Array | None = None


@dataclass(frozen=True, slots=True)
class LadderStep:
    """One failure on the way to burst: layer (counted from the bore), mode, pressure [Pa]."""

    layer: int
    mode: str
    pressure: float


@dataclass(frozen=True, slots=True)
class BurstLadder:
    """Pressures of first ply failure, liner yield and burst [Pa], with a record of every step.

    Parameters
    ----------
    first_ply_pressure : first failure of a composite ply
    burst_pressure : largest load of the ladder
    liner_yield_pressure : first yield of a metal layer in the intact wall; infinite without one
    record : for each step, three arrays over the designs: the row in `intact` of the mode that
        fails, its pressure, and whether the design takes this step at all
    order : for each layer in the internal order (metals first), its position counted from the bore
    intact : 1/p for the pressure p at which each mode fails in the intact wall: one row for each
        failure mode at each face of each layer, then the rows for the yield of metals
    faces : number of stations through each layer
    """

    first_ply_pressure: Array
    burst_pressure: Array
    liner_yield_pressure: Array
    record: tuple[tuple[Array, Array, Array], ...]
    order: tuple[int, ...]
    intact: Array
    faces: int = 1

    def modes(self) -> list[tuple[int, str]]:
        """Layer (from the bore) and mode of every row of `intact`."""
        layers, stations = len(self.order), self.faces * len(self.order)
        plies = [(self.order[i % layers], MODES[i // stations]) for i in range(_YIELD * stations)]
        metals = (self.intact.shape[0] - _YIELD * stations) // self.faces
        return plies + [(self.order[i % metals], "yield") for i in range(metals * self.faces)]

    def steps(self, index: tuple[int, ...] = ()) -> tuple[LadderStep, ...]:
        """List the failures of the design at `index` of the arrays; pass () for a single design."""
        named = self.modes()
        ladder = []
        for code, pressure, counted in self.record:
            if not bool(counted[index]):
                break
            layer, mode = named[int(code[index])]
            ladder.append(LadderStep(layer, mode, float(real(pressure[index]))))
        return tuple(ladder)


class Mechanics(Protocol):
    """Model of a wall: its stresses under pressure, with failed layers softened.

    In all its arrays, the metal layers come first.
    """

    @property
    def faces(self) -> int:
        """Number of stations through each layer."""

    @property
    def metals(self) -> int:
        """Number of metal layers."""

    @property
    def order(self) -> tuple[int, ...]:
        """For each layer in the internal order (metals first), its position from the bore."""

    @property
    def stressed(self) -> bool:
        """Whether the wall is stressed before any load, as by cooling from the cure."""

    def answer(self, soft: Array | None, held: Any) -> tuple[Array, Array | None]:
        """Stresses 1, 2, 12, 3 at every face and layer, per unit pressure and at zero pressure.

        `soft` marks the layers that have softened so far, None if none have; `held` is the state of
        the metals that have yielded. The stresses at zero pressure come from these metals and from
        other initial stress; the second result is None if there is neither.
        """

    def frozen(self, held: Any, yielded: Array, stress: Array) -> Any:
        """Add the metals marked in `yielded` to `held`, the state of those that yielded before.

        `stress` is the stress of all metals at this moment, (4, faces, metals, ...).
        """


def batch_zero(values: Sequence[Array]) -> Array:
    """Zeros in the common shape and type of the arrays among the values."""
    total: Array = 0.0
    for value in values:
        if not isinstance(value, (float, int, complex)):
            total = total + 0 * value
    return total


def inverse_strengths(layer: WallLayer) -> tuple[Array, ...]:
    """1/X_t, 1/Y_t, 1/S, 1/X_c, 1/Y_c, 1/S, 1/yield of a layer; zero where a mode is missing.

    X and Y are the strengths along and across the fibre in tension (t) and compression (c), S is
    the shear strength.

    References
    ----------
    [derived] the maximum-stress criterion mode by mode, as `strength_modes.max_stress_modes`
    """
    s = layer.strength
    if s is None:
        held = 0.0 if layer.yield_strength is None else 1 / layer.yield_strength
        return (0.0,) * 6 + (held,)
    shear = 1 / s.shear_12
    return (
        1 / s.tension_1, 1 / s.tension_2, shear, 1 / s.compression_1, 1 / s.compression_2, shear,
        0.0,
    )  # fmt: skip


@geometry
def metals_first(layers: Sequence[WallLayer]) -> tuple[int, ...]:
    """Indices of the layers from the bore, metals before plies."""
    return tuple(sorted(range(len(layers)), key=lambda i: layers[i].strength is not None))


def _stacked_rows(xp: Any, columns: Sequence[Sequence[Array]], dims: int) -> Array:
    """Stack the values of all layers: (values, layers, ...), with `dims` axes for the designs."""
    rows = list(zip(*columns, strict=True))
    zero = batch_zero([value for row in rows for value in row])
    ones = (1,) * dims
    if isinstance(zero, float):
        return xp.reshape(xp.asarray(rows), (len(rows), len(columns), *ones))
    zero = xp.reshape(zero, (1,) * (dims - zero.ndim) + zero.shape)
    return together([together([value + zero for value in row]) for row in rows])


def _above(value: Array) -> Array:
    """Strength left for the load; a small positive number if the initial stress leaves none."""
    return where(real(value) > _FLOOR, value, 0 * value + _FLOOR)


def _yields(rate: Array, base: Array | None, inverse: Array) -> Array:
    """1/p for the pressure p at which each metal yields.

    `rate` is the stress per unit pressure, `base` the stress at zero pressure, and `inverse` the
    reciprocal of the yield strength.
    """

    def stress(values: Array) -> Stress:
        return values[0, ...], values[1, ...], values[3, ...], 0 * values[2, ...]

    return yield_utilisation(
        stress=stress(rate * inverse),
        yield_strength=1.0,
        residual=None if base is None else stress(base * inverse),
    )


def _utilisations(
    xp: Any, metals: int, inverse: Array, rate: Array, base: Array | None, *, free: bool
) -> Array:
    """1/p for the pressure p at which each mode fails; rows as in `BurstLadder.intact`.

    `free`: the metals have no stress at zero pressure.
    """
    modes = xp.concat([rate[:3, ...], -rate[:3, ...]]) * inverse[:6, ...]
    if base is not None:
        used = xp.concat([base[:3, ...], -base[:3, ...]]) * inverse[:6, ...]
        modes = modes / _above(1 - used)
    rows = xp.reshape(modes, (-1, *modes.shape[3:]))
    if not metals:
        return rows
    held = None if base is None or free else base[:, :, :metals, ...]
    yields = _yields(rate[:, :, :metals, ...], held, inverse[6, :, :metals, ...])
    return xp.concat([rows, xp.reshape(yields, (-1, *yields.shape[2:]))])


def _critical(xp: Any, values: Array, rows: Array, shape: Array) -> tuple[Array, ...]:
    """Most utilised mode: its row, a mask of this row, its failure load, whether it is loaded."""
    code = xp.argmax(real(values), axis=0)
    hit = rows == code
    inverse = xp.sum(where(hit, values, 0.0), axis=0)
    idle = real(inverse) <= _NONE
    pressure = where(idle, shape + inf, 1 / where(idle, shape + 1, inverse))
    return code, hit, pressure, ~idle


def _softening(xp: Any, hit: Array, faces: int, count: int, metals: int) -> Array:
    """Mask of the layers with the failing mode, if it is matrix or shear failure, or yield."""
    plies = _YIELD * faces * count
    modes = xp.reshape(hit[:plies, ...], (_YIELD, faces, count, *hit.shape[1:]))
    modes = xp.any(modes, axis=1)
    matrix = modes[1, ...] | modes[2, ...] | modes[4, ...] | modes[5, ...]
    if not metals:
        return matrix
    yields = xp.reshape(hit[plies:, ...], (faces, metals, *hit.shape[1:]))
    return xp.concat([xp.any(yields, axis=0), matrix[metals:, ...]])


def _together(xp: Any, walls: Sequence[WallLayer], dims: int) -> Array:
    """Mask (layers, layers, ...): entry (i, j) is true if layers i and j soften together."""
    count, ones = len(walls), (1,) * dims
    same = [
        [i == j or (a.material == b.material and bool(a.strength) and bool(b.strength))
         for j, b in enumerate(walls)]
        for i, a in enumerate(walls)
    ]  # fmt: skip
    alike = xp.reshape(xp.asarray(same), (count, count, *ones))
    angle = _stacked_rows(xp, [(wall.angle,) for wall in walls], dims)[0, ...]
    turned = absolute(real(angle))
    return alike & (turned[:, None, ...] == turned[None, ...])


@geometry
def climb(xp: Any, mechanics: Mechanics, layers: Sequence[WallLayer], shape: Array) -> BurstLadder:
    """Follow the failures of a wall to burst.

    `shape` is an array of zeros that has the shape and number type of the designs' results.

    References
    ----------
    [derived] ply discount: the weakest mode fails and its layers lose their stiffness in it, until
    the wall carries no more load
    """
    walls = [layers[i] for i in mechanics.order]
    count, metals, faces = len(walls), mechanics.metals, mechanics.faces
    dims = shape.ndim
    strengths = _stacked_rows(xp, [inverse_strengths(wall) for wall in walls], dims)
    keeps = xp.reshape(xp.asarray([float(mode in (0, 3)) for mode in range(7)]), (7, 1))
    left = strengths * xp.reshape(keeps, (7, *(1,) * (dims + 1)))
    together = _together(xp, walls, dims)
    rows = xp.reshape(xp.arange(faces * (_YIELD * count + metals)), (-1,) + (1,) * dims)
    highest, first, liner_yield = shape, shape + inf, shape + inf
    climbing = untouched = real(shape) == 0
    held, soft, intact = None, None, None
    free = metals == 1 and not mechanics.stressed
    record = []
    for _ in range(count + 1):
        rate, base = mechanics.answer(soft, held)
        inverse = strengths if soft is None else where(soft[None, ...], left, strengths)
        values = _utilisations(xp, metals, inverse[:, None, ...], rate, base, free=free)
        if intact is None:
            intact = values
            if metals:
                own = [values[i - faces * metals, ...] for i in range(faces * metals)]
                liner_yield = load_multiplier(reduce(maximum, own))
        code, hit, pressure, found = _critical(xp, values, rows, shape)
        counted = climbing & found
        record.append((code, pressure, counted))
        highest = where(counted, maximum(highest, pressure), highest)
        event = _softening(xp, hit, faces, count, metals)
        fresh = xp.any(together & event[None, ...], axis=1) & counted
        plied = counted
        if metals:
            yielded = event[:metals, ...] & counted
            plied = counted & ~xp.any(yielded, axis=0)
            stress = rate[:, :, :metals, ...] * where(counted, pressure, shape)
            if base is not None:
                stress = stress + base[:, :, :metals, ...]
            held = mechanics.frozen(held, yielded, stress)
        first = where(plied & untouched, highest, first)
        untouched = untouched & ~plied
        climbing = counted & xp.any(event, axis=0)
        if finished(climbing):
            break
        soft = fresh if soft is None else soft | fresh
    return BurstLadder(first, highest, liner_yield, tuple(record), mechanics.order, intact, faces)


def _elastic(layer: WallLayer) -> tuple[Array, ...]:
    """Angle, thickness and elastic constants of a layer."""
    return (
        0.0 if layer.strength is None else layer.angle,
        layer.thickness,
        layer.youngs_modulus_1,
        layer.youngs_modulus_2,
        layer.poissons_ratio_12,
        layer.shear_modulus_12,
    )


def _table(xp: Any, angle: Array, thickness: Array, moduli: tuple[Array, ...]) -> Array:
    """Rows of values per layer, for `_Membrane`.

    First stresses 1, 2, 12 per unit axial strain, then per unit hoop strain, then the membrane
    stiffnesses zz, zt, tt.
    """
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
    return xp.stack(rows)


@dataclass(frozen=True, slots=True)
class _Membrane:
    """Thin wall with one face per layer; a yielded metal keeps its axial and hoop line force."""

    intact: Array
    softened: Array
    kept: Array
    axial_line: Array
    hoop_line: Array
    order: tuple[int, ...]
    metals: int
    faces: int = 1
    stressed: bool = False

    def _stress(self, xp: Any, table: Array, axial_line: Array, hoop_line: Array) -> Array:
        stiff = xp.sum(table[6:9, ...], axis=1)
        axial, cross, hoop = stiff[0, ...], stiff[1, ...], stiff[2, ...]
        inverse = 1 / (axial * hoop - cross * cross)
        axial_strain = (hoop * axial_line - cross * hoop_line) * inverse
        hoop_strain = (axial * hoop_line - cross * axial_line) * inverse
        plane = table[0:3, ...] * axial_strain + table[3:6, ...] * hoop_strain
        return xp.concat([plane, 0 * plane[:1, ...]])[:, None, ...]

    def answer(self, soft: Array | None, held: Any) -> tuple[Array, Array | None]:
        """Stresses per unit pressure, and those that yielded metals cause at zero pressure."""
        xp = namespace(self.intact)
        table = self.intact if soft is None else where(soft, self.softened, self.intact)
        rate = self._stress(xp, table, self.axial_line, self.hoop_line)
        if held is None:
            return rate, None
        return rate, -self._stress(xp, table, held[0, ...], held[1, ...])

    def frozen(self, held: Any, yielded: Array, stress: Array) -> Any:
        """Line forces of all metals that have yielded so far."""
        xp = namespace(stress)
        more = xp.sum(where(yielded, stress[:2, 0, ...] * self.kept, 0.0), axis=1)
        return more if held is None else held + more


@geometry
def burst_by_ply_discount(
    *,
    layers: Sequence[WallLayer],
    radius: Array,
    axial_force_per_pressure: Array,
    residual: float = 1e-3,
    liner_share: float = 1.0,
) -> BurstLadder:
    """First ply failure and burst of a thin laminated wall.

    The line forces are N_t = p R and N_z = N/(2 pi R); the maximum-stress criterion gives the
    critical mode. A matrix or shear failure multiplies E2, G12, nu12 of all plies of that material
    and |angle| by `residual` and removes their limits of matrix and shear stress. Burst is the
    largest load recorded until a fibre mode governs. A metal layer that yields keeps `liner_share`
    of its stress at yield, and afterwards `residual` of its stiffness.

    Parameters
    ----------
    layers : the wall from the bore outwards
    radius : R of the wall [m]; the mid-radius is our choice
    axial_force_per_pressure : N/p [m^2]; 0 for open ends, pi R^2 for closed ends
    residual : share of the stiffness that a failed ply keeps [-]
    liner_share : share of its stress that a yielded metal keeps [-]: 1 if perfectly plastic, 0 if
        it carries nothing

    Returns
    -------
    pressures [Pa] and the ladder; the arrays broadcast over cases and designs

    Notes
    -----
    Valid: thin walls with fibres.

    For a wall of metals only, this burst pressure is merely the yield pressure; use
    `barrel.burst_pressure_thick` instead. The stress that a yielded liner keeps is in equilibrium
    and nowhere above yield. All pressures are therefore continuous where yield and ply failure
    coincide.

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
    values = [v for layer in layers for v in (*_elastic(layer), *inverse_strengths(layer))]
    shape = batch_zero(values) + 0 * axial_line
    xp = namespace(shape)
    shape = xp.asarray(shape)
    order = metals_first(layers)
    walls, ones = [layers[i] for i in order], (1,) * shape.ndim
    stack = _stacked_rows(xp, [_elastic(wall) for wall in walls], shape.ndim)
    fibres = [float(wall.strength is not None) for wall in walls]
    factors = [
        [residual + (1 - residual) * fibre for fibre in fibres],
        [residual] * len(walls),
        [1 + (residual - 1) * fibre for fibre in fibres],
        [residual] * len(walls),
    ]
    angle, thickness, moduli = stack[0, ...], stack[1, ...], stack[2:, ...]
    softer = moduli * xp.reshape(xp.asarray(factors), (4, len(walls), *ones))
    metals = fibres.count(0.0)
    mechanics = _Membrane(
        intact=_table(xp, angle, thickness, tuple(moduli[i, ...] for i in range(4))),
        softened=_table(xp, angle, thickness, tuple(softer[i, ...] for i in range(4))),
        kept=thickness[:metals, ...] * ((1 - residual) * liner_share),
        axial_line=axial_line,
        hoop_line=radius,
        order=order,
        metals=metals,
    )
    return climb(xp, mechanics, layers, shape)
