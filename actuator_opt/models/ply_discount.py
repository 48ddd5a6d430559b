"""Burst of a thin laminated wall by ply discount: the fast form of `tube_burst`.

The ladder itself is in `burst_ladder`; here are the wall's membrane stresses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

from ..base.numeric import Array, geometry, namespace, where
from .burst_ladder import (
    BurstLadder,
    WallLayer,
    batch_zero,
    climb,
    inverse_strengths,
    metals_first,
    stacked_rows,
)
from .ply import ply_stiffness
from .strength_modes import PlyStrength

__all__ = ["BurstLadder", "PlyStrength", "WallLayer", "burst_by_ply_discount"]


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
    """Rows of the layers: stresses 1, 2, 12 per axial and per hoop strain, line stiffnesses."""
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
    """Thin wall: one face a layer; what yielded metals hold is their axial and hoop line force."""

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
        """Stresses per pressure, and those that the held line forces leave."""
        xp = namespace(self.intact)
        table = self.intact if soft is None else where(soft, self.softened, self.intact)
        rate = self._stress(xp, table, self.axial_line, self.hoop_line)
        if held is None:
            return rate, None
        return rate, -self._stress(xp, table, held[0, ...], held[1, ...])

    def frozen(self, held: Any, yielded: Array, stress: Array) -> Any:
        """Line forces of the metals that have yielded so far."""
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
    values = [v for layer in layers for v in (*_elastic(layer), *inverse_strengths(layer))]
    shape = batch_zero(values) + 0 * axial_line
    xp = namespace(shape)
    shape = xp.asarray(shape)
    order = metals_first(layers)
    walls, ones = [layers[i] for i in order], (1,) * shape.ndim
    stack = stacked_rows(xp, [_elastic(wall) for wall in walls], shape.ndim)
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
