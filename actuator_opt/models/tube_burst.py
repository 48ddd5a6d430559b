"""Burst of the exact layered tube by ply discount: leak, liner yield and fibre failure.

The ladder is that of `burst_ladder`; stresses come from `layered_tube` at both faces of every
layer, so that the bore's fibres and the liner's bore govern where they are the most stressed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..numeric import Array, namespace, where
from .burst_ladder import (
    BurstLadder,
    WallLayer,
    batch_zero,
    climb,
    inverse_strengths,
    metals_first,
)
from .layered_tube import LayeredTube, TubeLayer, layered_tube, ply_stresses_at_faces, tube_state
from .solid_ply import solid_stiffness
from .strength_modes import PlyStrength

__all__ = ["PlyStrength", "WallLayer", "burst_of_tube", "wall_as_tube"]

TRANSVERSE_RATIO = 0.4
"""nu23 of a ply where none is stated (PHYSICS_DETAIL section 2: usual for carbon epoxy)."""


def _constants(layer: WallLayer, residual: float) -> dict[str, Array]:
    """Constants with `residual` of E2, G12, nu12, nu23 left; of a metal, of its shear modulus."""
    e1, ratio = layer.youngs_modulus_1, layer.poissons_ratio_12
    if layer.strength is None:
        if residual == 1.0:
            return _isotropic(e1, ratio)
        bulk, shear = e1 / (3 * (1 - 2 * ratio)), residual * e1 / (2 * (1 + ratio))
        whole = 3 * bulk + shear
        return _isotropic(9 * bulk * shear / whole, (3 * bulk - 2 * shear) / (2 * whole))
    e2 = layer.youngs_modulus_2
    across = TRANSVERSE_RATIO if layer.poissons_ratio_23 is None else layer.poissons_ratio_23
    return {
        "youngs_modulus_1": e1,
        "youngs_modulus_2": residual * e2,
        "youngs_modulus_3": e2 if layer.youngs_modulus_3 is None else layer.youngs_modulus_3,
        "poissons_ratio_12": residual * ratio,
        "poissons_ratio_13": ratio if layer.poissons_ratio_13 is None else layer.poissons_ratio_13,
        "poissons_ratio_23": residual * across,
        "shear_modulus_12": residual * layer.shear_modulus_12,
    }


def _isotropic(modulus: Array, ratio: Array) -> dict[str, Array]:
    """An isotropic layer's constants as a ply's."""
    return {
        **{f"youngs_modulus_{i}": modulus for i in (1, 2, 3)},
        **{f"poissons_ratio_{ij}": ratio for ij in (12, 13, 23)},
        "shear_modulus_12": modulus / (2 * (1 + ratio)),
    }


def wall_as_tube(
    *, layers: Sequence[WallLayer], inner_radius: Array, residual: float = 1.0
) -> LayeredTube:
    """The exact tube of a wall, intact or with every layer failed.

    Failed plies keep `residual` of E2, G12, nu12 and nu23; flowing metals keep `residual` of their
    shear modulus and all of their bulk modulus.

    Parameters
    ----------
    layers : the wall from the bore outwards
    inner_radius : bore radius [m]
    residual : stiffness left [-]; 1 is the intact wall

    Returns
    -------
    the tube

    Notes
    -----
    Valid: balanced pairs and isotropic layers.

    References
    ----------
    [Jones1999] ply discount; plastic flow keeps its volume [derived]

    Examples
    --------
    >>> steel = WallLayer(youngs_modulus_1=210e9, youngs_modulus_2=210e9, poissons_ratio_12=0.3,
    ...                   shear_modulus_12=80.8e9, thickness=4e-3)
    >>> print(f"{wall_as_tube(layers=[steel], inner_radius=16e-3).ply[0][0] / 1e9:.1f}")
    282.7
    """
    return layered_tube(
        layers=[
            TubeLayer(
                stiffness=solid_stiffness(**_constants(layer, residual)),
                thickness=layer.thickness,
                angle=0.0 if layer.strength is None else layer.angle,
            )
            for layer in layers
        ],
        inner_radius=inner_radius,
    )


@dataclass(frozen=True, slots=True)
class _Tube:
    """The exact wall: two faces a layer; yielded metals hold the deviator of their mean stress."""

    intact: LayeredTube
    softened: LayeredTube
    axial: Array
    kept: float
    order: tuple[int, ...]
    metals: int
    faces: int = 2

    def _chosen(self, soft: Array | None) -> LayeredTube:
        """The tube with its soft layers; `soft` is in the ladder's order."""
        if soft is None:
            return self.intact
        dims, xp = soft.ndim - 1, namespace(self.axial)
        places = [self.order.index(i) for i in range(len(self.order))]
        mask = xp.stack([soft[i, ...] for i in places])
        a, b = self.softened.lifted(dims), self.intact.lifted(dims)

        def choose(first: Any, second: Any) -> Any:
            return tuple(where(mask, x, y) for x, y in zip(first, second, strict=True))

        return replace(
            b,
            ply=choose(a.ply, b.ply),
            wall=choose(a.wall, b.wall),
            transfer=where(mask, a.transfer, b.transfer),
        )

    def answer(self, soft: Array | None, held: Any) -> tuple[Array, Array | None]:
        """Stresses per pressure, and those that the metals' held stresses leave."""
        tube = self._chosen(soft)
        rate = self._stress(tube, 1.0, self.axial, None)
        return rate, None if held is None else self._stress(tube, 0.0, 0.0 * self.axial, held)

    def _stress(self, tube: LayeredTube, pressure: float, axial: Array, held: Any) -> Array:
        xp = namespace(self.axial)
        state = tube_state(tube=tube, inner_pressure=pressure, axial_force=axial, frozen=held)
        first, second, third, slip = ply_stresses_at_faces(tube=tube, state=state)
        if held is not None:
            first, second, third = first + held[0], second + held[1], third + held[2]
        each = xp.stack(xp.broadcast_arrays(first, second, slip, third))
        if self.order == tuple(range(len(self.order))):
            return each
        return xp.stack([each[:, :, i, ...] for i in self.order], axis=2)

    def frozen(self, held: Any, yielded: Array, stress: Array) -> Any:
        """Deviatoric stresses z, t, r at zero strain of every layer, from the bore."""
        xp = namespace(stress)
        mean = xp.sum(stress, axis=1) / 2
        normal = [mean[0, ...], mean[1, ...], mean[3, ...]]
        middle = (normal[0] + normal[1] + normal[2]) / 3
        own = [where(yielded, (one - middle) * self.kept, 0 * middle) for one in normal]
        nothing = 0 * middle[0, ...]
        rows = []
        for one in own:
            placed = [nothing] * len(self.order)
            for i in range(self.metals):
                placed[self.order[i]] = one[i, ...]
            rows.append(xp.stack(placed))
        if held is None:
            return tuple(rows)
        return tuple(a + b for a, b in zip(held, rows, strict=True))


def burst_of_tube(
    *,
    layers: Sequence[WallLayer],
    inner_radius: Array,
    axial_force_per_pressure: Array,
    residual: float = 1e-3,
    liner_share: float = 1.0,
) -> BurstLadder:
    """First ply failure, liner yield and burst of the exact layered tube.

    Maximum stress at both faces of each layer; a matrix or shear failure leaves `residual` of E2,
    G12, nu12 and nu23 in all plies of that material and |angle| and removes their matrix limits; a
    yielding metal keeps the deviator of its stress and its bulk modulus; burst is the largest load
    recorded until a fibre mode governs.

    Parameters
    ----------
    layers : the wall from the bore outwards
    inner_radius : bore radius [m]
    axial_force_per_pressure : N/p [m^2]; 0 is open, pi r_i^2 closed
    residual : stiffness left in a failed ply, shear stiffness left in a flowing metal [-]
    liner_share : stress a yielded metal keeps [-]: 1 perfectly plastic, 0 as if it were gone

    Returns
    -------
    pressures [Pa] and the ladder; the arrays broadcast over cases and designs

    Notes
    -----
    Valid: walls with fibres; the first fibre to fail, at the most stressed face, is burst.

    A wall of metals only returns its yield (use `barrel.burst_pressure_thick`). The flowing
    metal's held stress is its mean over the layer. Cure stresses are left out: yield and cracks
    have released them before burst.

    References
    ----------
    [Jones1999] ply discount; liner [derived] from elastic, perfectly plastic equilibrium

    Examples
    --------
    >>> ply = dict(youngs_modulus_1=138e9, youngs_modulus_2=9e9, poissons_ratio_12=0.28,
    ...            shear_modulus_12=5e9, poissons_ratio_23=0.42,
    ...            strength=PlyStrength(1900e6, 1300e6, 55e6, 190e6, 85e6))
    >>> wall = [WallLayer(**ply, thickness=0.9e-3, angle=1.5707963267948966),
    ...         WallLayer(**ply, thickness=0.7e-3, angle=0.5235987755982988)]
    >>> ladder = burst_of_tube(layers=wall, inner_radius=16e-3,
    ...                        axial_force_per_pressure=3.141592653589793 * 16e-3**2)
    >>> step = ladder.steps()[0]
    >>> print(step.layer, step.mode, f"{step.pressure / 1e6:.2f}")
    1 matrix tension 52.51
    """
    intact = wall_as_tube(layers=layers, inner_radius=inner_radius)
    softened = wall_as_tube(layers=layers, inner_radius=inner_radius, residual=residual)
    strengths = [v for layer in layers for v in inverse_strengths(layer)]
    shape = 0 * intact.transfer[0, 0, 0, ...] + 0 * axial_force_per_pressure
    shape = shape + batch_zero(strengths)
    xp = namespace(shape)
    order = metals_first(layers)
    mechanics = _Tube(
        intact=intact,
        softened=softened,
        axial=axial_force_per_pressure + 0 * shape,
        kept=(1 - residual) * liner_share,
        order=order,
        metals=sum(layer.strength is None for layer in layers),
    )
    return climb(xp, mechanics, layers, shape)
