"""Exact elastic solution for each layer of a tube: isotropic to monoclinic, any thickness.

Generalised plane strain: eps_z is constant, eps_t = u/r, eps_r = u', gamma_zt = gamma_0 r. In a
layer of inner radius a, with x = r/a, tau = ln x, l^2 = C_tt/C_rr, radial equilibrium has the
solution

    u/a = e_a cosh(l tau) + q_a sinh(l tau)/l + G phi_1 + H phi_2.

The solution starts from the hoop strain e_a and the radial strain q_a at the layer's inner face. G
is linear in the axial strain and in thermal stresses and the stresses that yielded metals keep; H
is linear in the twist. phi_1 = [cosh + sinh/l - x]/(l^2 - 1) and
phi_2 = [cosh + 2 sinh/l - x^2]/(l^2 - 4), with cosh and sinh of l tau. Both are written with
(e^y - 1)/y, so that l = 1 (isotropic and axial layers) and l = 2 need no branch. All integrals have
closed forms. `layered_tube` applies the loads. Rounding errors grow as exp(2 l tau): 1e-15 in a
barrel's wall, 1e-7 in a single layer with a radius ratio of 3 and E_t/E_r = 100.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, cast

from ..base.dataclass import dataclass
from ..base.numeric import Array, expm1_quotient, geometry, lifted, namespace, stacked, together
from .solid_ply import Solid, TubeStiffness, solid_expansion_load, solid_rotated


@dataclass(frozen=True, slots=True, kw_only=True)
class TubeLayer:
    """One layer of the tube.

    Parameters
    ----------
    stiffness : C11, C12, C13, C22, C23, C33, C66 of the ply [Pa], from `solid_ply.solid_stiffness`
    thickness : of the layer; of both plies for a balanced pair [m]
    angle : winding angle from the tube axis [rad]
    balanced : True for a smeared +-angle pair without shear coupling; False for a single ply, which
        may twist the wall
    expansion_1, expansion_2, expansion_3 : thermal expansions of the ply [1/K]
    """

    stiffness: Solid
    thickness: Array
    angle: Array = 0.0
    balanced: bool = True
    expansion_1: Array = 0.0
    expansion_2: Array = 0.0
    expansion_3: Array = 0.0


@dataclass(frozen=True, slots=True)
class LayeredTube:
    """A tube ready to be loaded; arrays have the shape (layers, ...), the batch of designs last.

    Parameters
    ----------
    ply : stiffness of each layer in its own axes [Pa]
    angle : winding angles [rad]
    free : expansions 1, 2, 3 of each layer [1/K]
    balanced : 1 for a pair, 0 for a single ply
    wall : stiffness of each layer in tube axes; couplings of balanced pairs are zero [Pa]
    hold : K_z, K_t, K_r, K_s, stresses per kelvin that would hold back each layer's thermal
        expansion [Pa/K]; None if nothing expands
    inner, outer : radii of each layer [m]
    transfer : table (inputs, outputs, layers, ...) from the inner to the outer face of each layer.
        Inputs: inner hoop strain, inner radial stress, axial strain, held-back stress (radial less
        hoop) (and twist). Outputs: outer hoop strain, outer radial stress, integral of sigma_z r
        (and of tau_zt r^2)
    twisting : whether any layer couples shear with tension; `transfer` then includes the entries in
        brackets
    """

    ply: Solid
    angle: Array
    free: tuple[Array, Array, Array]
    balanced: Array
    wall: TubeStiffness
    hold: tuple[Array, Array, Array, Array] | None
    inner: Array
    outer: Array
    transfer: Array
    twisting: bool

    def lifted(self, dims: int) -> LayeredTube:
        """The tube with axes of length 1 before its designs, to match loads with `dims` axes."""
        missing, shape = dims - self.inner.ndim + 1, self.transfer.shape
        if missing <= 0:
            return self

        def lift(values: Any) -> tuple[Array, ...]:
            return tuple(lifted(value, dims) for value in values)

        table = (*shape[:3], *(1,) * missing, *shape[3:])
        hold = None
        if self.hold is not None:
            hold = cast(tuple[Array, Array, Array, Array], lift(self.hold))
        angle, balanced, inner, outer = lift((self.angle, self.balanced, self.inner, self.outer))
        return LayeredTube(
            ply=cast(Solid, lift(self.ply)),
            angle=angle,
            free=cast(tuple[Array, Array, Array], lift(self.free)),
            balanced=balanced,
            wall=cast(TubeStiffness, lift(self.wall)),
            hold=hold,
            inner=inner,
            outer=outer,
            transfer=namespace(self.inner).reshape(self.transfer, table),
            twisting=self.twisting,
        )


class _Basis(NamedTuple):
    """Functions of l and tau in the module's solution, at the outer face, and their integrals."""

    order: Array
    power: Array
    ratio: Array
    rise: Array
    slope: Array
    drive: Array
    push: Array
    area_rise: Array
    area_slope: Array
    area_drive: Array


def _basis(xp: Any, wall: TubeStiffness, inner: Array, outer: Array) -> _Basis:
    """cosh, sinh/l, phi_1 and dphi_1/dtau (see the module); integrals of the first three."""
    ratio = outer / inner
    way = xp.log(ratio)
    order = xp.sqrt(wall[3] / wall[5])
    power = xp.exp(order * way)
    rise = (power + 1 / power) / 2
    slope = (power - rise) / order
    near = way * expm1_quotient((order - 1) * way)
    along, double = 1 / (order + 1), ratio * ratio
    drive = (ratio * near - slope) * along
    push = (ratio + order * ratio * near - rise) * along
    up = (power * ratio - 1) * along
    down = near * ratio / power
    area_rise, area_slope = (up + down) / 2, (up - down) / (2 * order)
    area_drive = ((double * near - (double - 1) / 2) * along - area_slope) * along
    return _Basis(order, power, ratio, rise, slope, drive, push, area_rise, area_slope, area_drive)


def _transfer(k: _Basis, wall: TubeStiffness, inner: Array, outer: Array) -> list[list[Array]]:
    """Table (inputs by outputs) of one layer, see `LayeredTube.transfer`.

    The displacement u follows from the basis `k`, and q_a = (s - R - C_tr e)/C_rr, where e and s
    are the hoop strain and radial stress at the inner face and R is the radial stress caused by the
    other inputs.
    """
    zz, zt, zr, _, tr, rr, _, _, _, _ = wall
    soft, narrow, spread = 1 / rr, 1 / k.ratio, zt - zr
    grip, square_a, square_b = tr * soft, inner * inner, outer * outer
    turn = narrow * soft
    hoop, radial, held = narrow * (k.rise - grip * k.slope), turn * k.slope, turn * k.drive
    axial = spread * held - zr * radial
    steep = narrow * (k.order * k.order * k.slope - grip * k.rise)
    steep_radial, steep_held = turn * k.rise, turn * k.push
    steep_axial = spread * steep_held - zr * steep_radial
    wide = spread * square_a * soft
    reach, pull = zr * square_b, wide * k.area_slope
    force_held, force_radial = reach * held + wide * k.area_drive, reach * radial + pull
    force_hoop = reach * hoop - zr * square_a + wide * (rr * k.area_rise) - tr * pull
    force_axial = zz * ((square_b - square_a) / 2) + spread * force_held - zr * force_radial
    return [
        [hoop, tr * hoop + rr * steep, force_hoop],
        [radial, tr * radial + rr * steep_radial, force_radial],
        [axial, tr * axial + rr * steep_axial + zr, force_axial],
        [held, tr * held + rr * steep_held, force_held],
    ]


def _twist(
    k: _Basis, t: list[list[Array]], wall: TubeStiffness, inner: Array, outer: Array
) -> list[list[Array]]:
    """The table `t` of a layer, extended by twist, which causes shear and the term H phi_2."""
    _, zt, zr, _, tr, rr, zs, ts, rs, ss = wall
    way = namespace(inner).log(k.ratio)
    near = way * expm1_quotient((k.order - 2) * way)
    first = way * expm1_quotient((k.order - 1) * way)
    along, beside = 1 / (k.order + 2), 1 / (k.order + 1)
    double = k.ratio * k.ratio
    cube, fourth = double * k.ratio, double * double
    drive = (double * near - k.slope) * along
    push = (double * (1 + k.order * near) - k.rise) * along
    area = (cube * near - (cube - 1) / 3) * along * beside - k.area_slope * along
    up, down = (k.power * double - 1) * along, near * double / k.power
    rise, slope = (up + down) / 2, (up - down) / (2 * k.order)
    moment_1 = (cube * first - (cube - 1) / 3) * along * beside - slope * beside
    moment_2 = ((fourth * near - (fourth - 1) / 4) * along - slope) * along
    couple = ts - 2 * rs
    swirl, shear = couple * inner / rr, rs * inner / rr
    hoop = (swirl * drive - shear * k.slope) / k.ratio
    steep = (swirl * push - shear * k.rise) / k.ratio
    square_a, square_b = inner * inner, outer * outer
    third = (square_b * outer - square_a * inner) / 3
    turn, reach = couple * square_a * inner, rs * square_b * outer
    held, radial = reach * t[3][0] + turn * moment_1 / rr, reach * t[1][0] + turn * slope / rr
    force = zs * third + zr * square_b * hoop
    force = force + (zt - zr) * square_a * (swirl * area - shear * k.area_slope)
    torque = ss * (square_b * square_b - square_a * square_a) / 4 + reach * hoop
    torque = torque + turn * (swirl * moment_2 - shear * slope)
    by_hoop = reach * t[0][0] - rs * square_a * inner + turn * (rise - tr * slope / rr)
    return [
        [*t[0], by_hoop],
        [*t[1], radial],
        [*t[2], zs * third + (zt - zr) * held - zr * radial],
        [*t[3], held],
        [hoop, tr * hoop + rr * steep + rs * outer, force, torque],
    ]


def _expands(layer: TubeLayer) -> bool:
    """Whether a layer has any thermal expansion."""
    own = (layer.expansion_1, layer.expansion_2, layer.expansion_3)
    return any(not isinstance(value, (float, int)) or value != 0.0 for value in own)


@geometry
def layered_tube(*, layers: Sequence[TubeLayer], inner_radius: Array) -> LayeredTube:
    """Prepare a tube of bonded layers for `layered_tube.tube_state`.

    Rotates every stiffness into tube axes, where balanced pairs have no shear coupling. Then builds
    the table that leads from the inner to the outer face of each layer (see the module's
    docstring).

    Parameters
    ----------
    layers : from the bore outwards
    inner_radius : bore radius [m]

    Returns
    -------
    the tube (see `LayeredTube` for units, [m], [Pa])

    Notes
    -----
    Valid: linear elastic, perfect bond, far from the ends; any wall ratio.

    References
    ----------
    [Lekhnitskii1963] cylindrical anisotropy; [derived] formulas without a singularity at l = 1 and
    l = 2

    Examples
    --------
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    >>> tube = layered_tube(layers=[TubeLayer(stiffness=steel, thickness=4e-3)],
    ...                     inner_radius=16e-3)
    >>> print(f"{tube.outer[0] * 1e3:.1f} mm")
    20.0 mm
    """
    numbers = [
        inner_radius,
        *(v for layer in layers for v in (*layer.stiffness, layer.angle, layer.thickness)),
    ]
    xp = namespace(*numbers)
    radii = [inner_radius]
    for layer in layers:
        radii.append(radii[-1] + layer.thickness)
    columns = [
        (*layer.stiffness, layer.angle, layer.expansion_1, layer.expansion_2, layer.expansion_3)
        for layer in layers
    ]
    rows = [*zip(*columns, strict=True), radii[:-1], radii[1:]]
    values = stacked(rows)
    c11, c12, c13, c22, c23, c33, c66, angle, first, second, third, inner, outer = values
    ply = (c11, c12, c13, c22, c23, c33, c66)
    wall = solid_rotated(stiffness=ply, angle=angle)
    hold = None
    if any(_expands(layer) for layer in layers):
        hold = solid_expansion_load(
            stiffness=ply, angle=angle, expansion_1=first, expansion_2=second, expansion_3=third
        )
    single = [0.0 if layer.balanced else 1.0 for layer in layers]
    twisting = any(single)
    mask = lifted(xp.asarray(single), c11.ndim - 1)
    if not all(single):
        wall = (*wall[:6], wall[6] * mask, wall[7] * mask, wall[8] * mask, wall[9])
        hold = None if hold is None else (*hold[:3], hold[3] * mask)
    basis = _basis(xp, wall, inner, outer)
    table = _transfer(basis, wall, inner, outer)
    if twisting:
        table = _twist(basis, table, wall, inner, outer)
    transfer = xp.stack([together(row) for row in table])
    free, balanced = (first, second, third), 1 - mask
    return LayeredTube(ply, angle, free, balanced, wall, hold, inner, outer, transfer, twisting)
