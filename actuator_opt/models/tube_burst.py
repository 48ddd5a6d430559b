"""Burst of the exact layered tube by ply discount: leak, liner yield and fibre failure.

The sequence of failures is that of `burst_ladder`. Stresses come from `layered_tube` at both faces
of every layer, because the stresses at the two faces differ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

from ..base.dataclass import dataclass
from ..base.numeric import Array, geometry, namespace, together, where
from .burst_ladder import BurstLadder, WallLayer, batch_zero, climb, inverse_strengths, metals_first
from .layered_tube import closed, forcing
from .solid_ply import Solid, solid_stiffness
from .strength_modes import PlyStrength
from .tube_elements import LayeredTube, TubeLayer, layered_tube

__all__ = ["PlyStrength", "WallLayer", "axial_rupture_pressure", "burst_of_tube"]

TRANSVERSE_RATIO = 0.4
"""Poisson's ratio nu23 of a ply if not stated: usual for carbon epoxy, default of the library."""


def _constants(layer: WallLayer, residual: float) -> dict[str, Array]:
    """Elastic constants of a failed ply (E2, G12, nu12, nu23 times `residual`) or yielded metal.

    A metal keeps its bulk modulus and the share `residual` of its shear modulus.
    """
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
    """Constants of an isotropic layer in the form of a ply's constants."""
    return {
        **{f"youngs_modulus_{i}": modulus for i in (1, 2, 3)},
        **{f"poissons_ratio_{ij}": ratio for ij in (12, 13, 23)},
        "shear_modulus_12": modulus / (2 * (1 + ratio)),
    }


def _recovery(xp: Any, tube: LayeredTube) -> Array:
    """Factors by which hoop strain, radial stress and axial strain give ply stresses 1, 2, 12."""
    c11, c12, c13, c22, c23, _, c66 = tube.ply
    _, _, zr, _, tr, rr, *_ = tube.wall
    along, slip = (1 + xp.cos(2 * tube.angle)) / 2, xp.sin(2 * tube.angle) * c66
    across = 1 - along
    rows = []
    for first, second, third in ((c11, c12, c13), (c12, c22, c23)):
        depth = third / rr
        rows.append(
            (
                first * across + second * along - depth * tr,
                depth,
                first * along + second * across - depth * zr,
            )
        )
    rows.append((slip, 0 * slip, -slip))
    by_input = [[row[k] for row in rows] for k in range(3)]
    return together([together(row) for row in by_input])


@dataclass(frozen=True, slots=True)
class _Tube:
    """Exact tube wall, stressed at both faces of each layer, for the burst calculation.

    A metal layer that yields keeps its deviatoric stress, averaged over its two faces. `hold` has
    the stresses that would hold back the thermal expansion, in tube axes z, t, r and in ply axes
    1, 2, 3. `transfer`, `recovery` and
    `hold` have an axis for the states intact and failed before the axes of the designs: (..,
    layers, 2, ...).
    """

    transfer: Array
    recovery: Array
    hold: Array | None
    inner: Array
    outer: Array
    axial: Array
    clamp: Array | None
    kept: float
    order: tuple[int, ...]
    metals: int
    faces: int = 2

    @property
    def stressed(self) -> bool:
        """Whether the wall is clamped, or away from its stress-free temperature."""
        return self.hold is not None or self.clamp is not None

    @property
    def sorted(self) -> bool:
        """Whether the burst calculation lists the layers in the order of the wall, bore first."""
        return self.order == tuple(range(len(self.order)))

    def _chosen(self, table: Array, mask: Array | None) -> Array:
        """Values of each layer from `table`: of its failed state if `mask` is true, else intact."""
        intact = table[:, :, :, 0, ...]
        return intact if mask is None else where(mask, table[:, :, :, 1, ...], intact)

    def answer(self, soft: Array | None, held: Any) -> tuple[Array, Array | None]:
        """Stresses per unit pressure, and stresses at zero pressure.

        Those at zero pressure come from tie rods that clamp the wall, from cooling and from yielded
        metals; they are None if there are none of these. One pass through the layers gives
        both results: an additional axis, before the axes of the designs, holds the two loads: unit
        pressure, and the loads at zero pressure.
        """
        xp = namespace(self.axial)
        mask = soft
        if soft is not None and not self.sorted:
            mask = xp.stack([soft[self.order.index(i), ...] for i in range(len(self.order))])
        transfer, recovery = self._chosen(self.transfer, mask), self._chosen(self.recovery, mask)
        back = self._held_back(mask, held)
        if back is None:
            return self._stress(xp, transfer, recovery, 1.0, self.axial, None), None
        tube, ply = back
        driven = forcing(
            xp, transfer, self.inner, self.outer, tuple(tube[k, ...] for k in range(3))
        )
        none = 0 * self.axial
        loads = together([none + 1, none])
        both = self._stress(
            xp,
            transfer[:, :, :, None, ...],
            recovery[:, :, :, None, ...],
            loads,
            together([none + self.axial, none if self.clamp is None else none + self.clamp]),
            xp.stack([0 * driven, driven], axis=2),
            xp.stack([0 * ply, ply], axis=2),
        )
        return both[:, :, :, 0, ...], both[:, :, :, 1, ...]

    def _held_back(self, mask: Array | None, frozen: Any) -> tuple[Array, Array] | None:
        """Stresses that would hold the wall at zero strain, in tube and in ply axes, or None.

        They are the thermal stresses minus the stresses that yielded metals keep (in tube axes).
        """
        if self.hold is None:
            return None if frozen is None else (-frozen, -frozen)
        hold = self._chosen(self.hold[None, ...], mask)[0, ...]
        tube, ply = hold[:3, ...], hold[3:, ...]
        return (tube, ply) if frozen is None else (tube - frozen, ply - frozen)

    def _stress(
        self,
        xp: Any,
        transfer: Array,
        recovery: Array,
        pressure: Any,
        axial: Array,
        driven: Array | None,
        back: Array | None = None,
    ) -> Array:
        state = closed(
            xp,
            transfer,
            driven,
            inner_pressure=pressure,
            outer_pressure=0.0,
            axial_force=axial,
            torque=0.0,
        )
        radial = state.radial_stress
        lead = radial if back is None else radial + back[2, ...]
        plane = recovery[0, :, None, ...] * state.hoop_strain[None, ...]
        plane = plane + recovery[1, :, None, ...] * lead[None, ...]
        plane = plane + recovery[2, :, None, ...] * state.axial_strain
        if back is not None:
            plane = plane - xp.concat([back[:2, ...], 0 * back[:1, ...]])[:, None, ...]
        each = xp.concat([plane, radial[None, ...] + 0 * plane[:1, ...]])
        if self.sorted:
            return each
        return xp.stack([each[:, :, i, ...] for i in self.order], axis=2)

    def frozen(self, held: Any, yielded: Array, stress: Array) -> Any:
        """Deviatoric stresses z, t, r that yielded layers keep, for all layers from the bore."""
        xp = namespace(stress)
        mean = (stress[:, 0, ...] + stress[:, 1, ...]) / 2
        normal = together([mean[0, ...], mean[1, ...], mean[3, ...]])
        own = where(yielded, (normal - xp.sum(normal, axis=0) / 3) * self.kept, 0.0)
        placed = [0 * own[:, 0, ...]] * len(self.order)
        for i in range(self.metals):
            placed[self.order[i]] = own[:, i, ...]
        more = xp.stack(placed, axis=1)
        return more if held is None else more + held


def _both_states(
    xp: Any, layers: Sequence[WallLayer], inner_radius: Array, residual: float, dims: int
) -> LayeredTube:
    """The tube in two states, all layers intact and all failed, on an axis before the designs."""

    def spread(value: Array) -> Array:
        """The value reshaped to the axes of the designs, after the axis of the states."""
        value = xp.asarray(value)
        return xp.reshape(value, (1,) * (dims + 1 - value.ndim) + value.shape)

    plies = []
    for layer in layers:
        states = [solid_stiffness(**_constants(layer, share)) for share in (1.0, residual)]
        stiffness = [
            xp.concat([spread(intact), spread(failed)])
            for intact, failed in zip(*states, strict=True)
        ]
        plies.append(
            TubeLayer(
                stiffness=cast(Solid, tuple(stiffness)),
                thickness=spread(layer.thickness),
                angle=spread(0.0 if layer.strength is None else layer.angle),
                expansion_1=_spread_or_zero(spread, layer.expansion_1),
                expansion_2=_spread_or_zero(spread, layer.expansion_2),
                expansion_3=_spread_or_zero(spread, layer.expansion_2),
            )
        )
    return layered_tube(layers=plies, inner_radius=spread(inner_radius))


def _spread_or_zero(spread: Callable[[Array], Array], value: Array) -> Array:
    """A thermal expansion, reshaped by `spread`; a plain zero stays a plain zero."""
    return 0.0 if isinstance(value, (float, int)) and value == 0.0 else spread(value)


def _thermal(xp: Any, tube: LayeredTube, change: Array) -> Array | None:
    """Stresses that would hold back the thermal strain, in tube axes z, t, r and ply axes 1, 2, 3.

    None without thermal strain.
    """
    if tube.hold is None or (isinstance(change, (float, int)) and change == 0.0):
        return None
    c11, c12, c13, c22, c23, c33, _ = tube.ply
    first, second, third = tube.free
    own = (
        c11 * first + c12 * second + c13 * third,
        c12 * first + c22 * second + c23 * third,
        c13 * first + c23 * second + c33 * third,
    )
    return together([value * change for value in (*tube.hold[:3], *own)])


@geometry
def burst_of_tube(
    *,
    layers: Sequence[WallLayer],
    inner_radius: Array,
    axial_force_per_pressure: Array,
    temperature_change: Array = 0.0,
    held_force: Array = 0.0,
    residual: float = 1e-3,
    liner_share: float = 1.0,
) -> BurstLadder:
    """First ply failure, liner yield and burst of the exact layered tube.

    The maximum-stress criterion applies at both faces of each layer. A matrix or shear failure
    multiplies E2, G12, nu12 and nu23 by `residual` for all plies of that material and |angle|, and
    removes their limits of matrix and shear stress. A yielding metal keeps the deviator of its
    stress and its bulk modulus. Burst is the largest pressure reached until a fibre fails.

    Parameters
    ----------
    layers : the wall from the bore outwards
    inner_radius : bore radius [m]
    axial_force_per_pressure : N/p [m^2]; 0 for open ends, pi r_i^2 for closed ends
    temperature_change : from the stress-free state; needs the layers' expansions [K]
    held_force : axial force without pressure; negative for the clamping force of tie rods [N]
    residual : share of stiffness left in a failed ply, and of shear stiffness in a yielded metal
        [-]
    liner_share : share of its stress that a yielded metal keeps [-]: 1 if perfectly plastic, 0 if
        it carries nothing

    Returns
    -------
    pressures [Pa] and the sequence of failures; arrays broadcast over load cases and designs

    Notes
    -----
    Valid: walls with fibres; burst means that a fibre fails at the most stressed face.

    For a wall of metals only, this function returns the yield pressure as burst pressure; use
    `barrel.burst_pressure_thick` instead. The stress that a yielded metal keeps is its mean over
    the layer. Cure stresses act in the intact wall and vanish where it fails: a cracked matrix no
    longer pulls on its neighbours, and a yielded liner no longer restrains them.

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
    numbers = [inner_radius, axial_force_per_pressure, temperature_change, held_force]
    for layer in layers:
        numbers += [*_constants(layer, 1.0).values(), *inverse_strengths(layer)]
        numbers += [layer.thickness, layer.angle, layer.expansion_1, layer.expansion_2]
    zero = batch_zero(numbers)
    xp = namespace(zero)
    shape = xp.asarray(zero)
    order = metals_first(layers)
    tube = _both_states(xp, layers, inner_radius, residual, shape.ndim)
    mechanics = _Tube(
        transfer=tube.transfer,
        recovery=_recovery(xp, tube),
        hold=_thermal(xp, tube, temperature_change),
        inner=tube.inner[:, 0, ...],
        outer=tube.outer[:, 0, ...],
        axial=axial_force_per_pressure + 0 * shape,
        clamp=None if isinstance(held_force, float) and held_force == 0.0 else held_force + shape,
        kept=(1 - residual) * liner_share,
        order=order,
        metals=sum(layer.strength is None for layer in layers),
    )
    return climb(xp, mechanics, layers, shape)


@geometry
def axial_rupture_pressure(
    *,
    areas: Sequence[Array],
    strengths: Sequence[Array],
    angles: Sequence[Array],
    axial_force_per_pressure: Array,
) -> Array:
    """Pressure at which the axial force exceeds what metals and fibres can carry together.

    p = sum(A S cos^2 a)/(N/p). A metal has a = 0; of a ply only the fibres count (netting).

    Parameters
    ----------
    areas : cross-section area of each layer, A [m^2]
    strengths : ultimate strength of a metal, or fibre strength of a ply, S [Pa]
    angles : winding angles from the tube axis, a [rad]
    axial_force_per_pressure : N/p [m^2]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: ductile metals; every layer at its strength at once, so that it is an upper bound.

    `burst_of_tube` ends when a fibre fails. A wall whose fibres run around it only, on a yielded
    liner, would stretch without limit before; there, this pressure governs.

    References
    ----------
    [derived] axial equilibrium at rupture

    Examples
    --------
    >>> p = axial_rupture_pressure(areas=[116e-6, 229e-6], strengths=[480e6, 2000e6],
    ...                            angles=[0.0, 1.5358897417550099],
    ...                            axial_force_per_pressure=363e-6)
    >>> print(f"{p / 1e6:.2f}")
    154.93
    """
    force = 0.0
    for area, strength, angle in zip(areas, strengths, angles, strict=True):
        cosine = namespace(angle).cos(angle)
        force = force + area * strength * (cosine * cosine)
    return force / axial_force_per_pressure
