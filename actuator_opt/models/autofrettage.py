"""Autofrettage of a metal-lined tube: one overpressure, then elastic unloading.

The liner between the radii a and b is isotropic, elastic and perfectly plastic. It yields by Tresca
where the hoop minus the radial stress is Y, without axial plastic strain; the wrap stays elastic.
Everywhere in the liner sigma_z = E e_z + nu (sigma_r + sigma_t) with e_z = eps_z - alpha dT, so
radial equilibrium alone gives the liner's axial force. The volume changes only elastically, so that
in the elastic and in the plastic zone

    eps_t = (1 - nu^2) Y x b^2/(E r^2) + (1 + nu)(1 - 2 nu) sigma_r/E - nu e_z + alpha dT.

Here eps_z and eps_t are the axial and the hoop strain, and alpha dT is the free thermal strain.
x measures how far the liner has yielded: x = (c/b)^2 if the plastic zone ends at the radius c.
Where x is below (a/b)^2, the whole liner is elastic; where x is above 1, all of it is plastic. q is
the pressure on the wrap. The liner bears the remaining pressure p - q, which is

    elastic: Y x (b^2/a^2 - 1)/2,   partly plastic: Y [ln(c/a) + (1 - x)/2],   plastic: Y ln(b/a).

The wrap responds linearly: q = kappa Y x - mu p - tau, where the constants kappa, mu and tau follow
from equal strains of liner and wrap; tau is thermal. For a partly plastic liner, this and the
pressure p - q above combine into one equation for y = ln x,

    y - m (e^y - 1) + s = 0,    m = 1 - 2 kappa < 1,    s = 2 (1 + mu)(p_full - p)/Y,

where p_full is the pressure at which the whole liner has yielded. The left side increases with y,
and its curvature has one sign. Newton's method therefore converges in a few steps from a start that
is exact at the double root (m = 1, s = 0: collapse of a bare liner). The last step carries the
imaginary parts, so complex-step derivatives are exact. Unloading is elastic: the residual state is
the state at p minus the elastic state at p.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any, NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import (
    Array,
    absolute,
    array_of,
    geometry,
    maximum,
    minimum,
    namespace,
    positive,
    real,
    sqrt,
    where,
)
from .layered_tube import TubeLayer, layered_tube, ply_stresses_at_faces, tube_state
from .strength_modes import Stress
from .tube_elements import LayeredTube

_STEPS = 6
"""Newton steps that find the plastic zone to rounding error, for b/a up to 20 and any wrap."""


@dataclass(frozen=True, slots=True)
class Autofrettage:
    """Residual state of a lined tube after an overpressure; add it to the state of a later load.

    Parameters
    ----------
    yield_pressure : pressure at which the liner's bore yields first [Pa]
    full_pressure : pressure at which the whole liner has yielded; a liner without wrap collapses
        [Pa]
    plastic_radius : c, outer radius of the yielded zone; the bore radius where nothing yields [m]
    interface_pressure : residual pressure between liner and wrap [Pa]
    axial_strain : residual strain of the tube [-]
    bore_displacement : permanent radial growth of the bore [m]
    stresses : residual sigma_1, sigma_2, sigma_3, tau_12, each (2 faces, layers, ...) as from
        `layered_tube.ply_stresses_at_faces`; the liner's 1, 2, 3 are z, t, r [Pa]
    reverse_yield : Tresca stress at the unloaded bore, thermal stress included, divided by the
        yield strength [-]
    elastic_limit : pressure at which the liner yields next, if all loads have the same ratios to
        each other as during the overpressure [Pa]
    axial_margin : distance of sigma_z to the nearer end of the range sigma_r to sigma_t in the
        yielded zone, divided by the yield strength [-]
    """

    yield_pressure: Array
    full_pressure: Array
    plastic_radius: Array
    interface_pressure: Array
    axial_strain: Array
    bore_displacement: Array
    stresses: Stress
    reverse_yield: Array
    elastic_limit: Array
    axial_margin: Array


class _Liner(NamedTuple):
    """Elastic constants of the liner, radii squared, thermal strain alpha dT, and N/(2 pi p).

    N is the axial force in the wall at the pressure p.
    """

    modulus: Array
    ratio: Array
    inner: Array
    outer: Array
    free: Array
    pull: Array


class _Contact(NamedTuple):
    """Linear response of liner and wrap to x, p and dT (symbols: see the module's docstring).

    q = kappa Y x - mu p - tau. The axial strain eps_z is the first element of `strain` times q,
    plus the second times p, plus the third, which is thermal. `pull` is the axial force in the wrap
    per unit of q, divided by 2 pi.
    """

    kappa: Array
    mu: Array
    tau: Array
    strain: tuple[Array, Array, Array]
    pull: Array


def _liner(layer: TubeLayer, inner_radius: Array, change: Array, force: Array) -> _Liner:
    """Collect the constants of the liner; an error if it is not isotropic."""
    c11, c12, c13, c22, c23, c33, _ = layer.stiffness
    for one, other in ((c22, c11), (c33, c11), (c13, c12), (c23, c12)):
        if np.any(array_of(real(absolute(one - other)) > 1e-6 * real(c11))):
            message = "the first layer of an autofrettaged tube must be isotropic"
            raise ValueError(message)
    outer = inner_radius + positive(layer.thickness)
    return _Liner(
        modulus=(c11 - c12) * (c11 + 2 * c12) / (c11 + c12),
        ratio=c12 / (c11 + c12),
        inner=inner_radius * inner_radius,
        outer=outer * outer,
        free=layer.expansion_1 * change,
        pull=force / (2 * pi),
    )


def _contact(liner: _Liner, wrap: LayeredTube | None, change: Array) -> _Contact:
    """Solve for equal strains of liner and wrap at the interface, and for axial equilibrium."""
    e, nu, inner, outer, free, pull = liner
    area = e * (outer - inner) / 2
    own = pull - nu * inner
    if wrap is None:
        none = 0 * (own + free) / area
        return _Contact(none, none, none, (none, own / area, free), none)
    by_pressure = tube_state(tube=wrap, inner_pressure=1.0)
    by_force = tube_state(tube=wrap, axial_force=2 * pi)
    by_heat = tube_state(tube=wrap, temperature_change=change)
    hoop_q, hoop_f, hoop_0 = (
        state.hoop_strain[0, 0, ...] for state in (by_pressure, by_force, by_heat)
    )
    along = by_force.axial_strain
    share = 1 / (1 + along * area)
    strain = (
        (by_pressure.axial_strain + along * nu * outer) * share,
        along * own * share,
        (by_heat.axial_strain + along * area * free) * share,
    )
    pulls = (nu * outer - area * strain[0], own - area * strain[1], area * (free - strain[2]))
    soft = hoop_q + hoop_f * pulls[0] + (1 + nu) * (1 - 2 * nu) / e + nu * strain[0]
    return _Contact(
        kappa=(1 - nu * nu) / (e * soft),
        mu=(hoop_f * pulls[1] + nu * strain[1]) / soft,
        tau=(hoop_f * pulls[2] + hoop_0 + nu * strain[2] - (1 + nu) * free) / soft,
        strain=strain,
        pull=pulls[0],
    )


def _spread(xp: Any, kappa: Array, depth: Array) -> Array:
    """Extent x of yielding in a partly plastic liner (see the module's docstring).

    Solves y - m (e^y - 1) + s = 0 with y = ln x <= 0, m = 1 - 2 `kappa` and s = `depth` > 0.
    """
    near, rest = 2 * real(kappa), real(depth)
    bend = 1 - near
    y = -2 * rest / (near + xp.sqrt(near * near + 2 * maximum(bend, 0 * bend) * rest))
    for _ in range(_STEPS):
        rise = xp.expm1(y)
        y = y - (y - bend * rise + rest) / (near - bend * rise)
    rise = xp.expm1(y)
    return xp.exp(y - (y - (1 - 2 * kappa) * rise + depth) / (near - bend * rise))


class _Yielding(NamedTuple):
    """Pressures of first and of full yield, and three values of x at the overpressure.

    x measures how far the liner has yielded, see the module's docstring. `spread` is the actual x.
    `elastic` is the x of a liner that never yields, and `spent` is `elastic` without thermal
    stress.
    """

    first: Array
    full: Array
    spread: Array
    elastic: Array
    spent: Array


def _yielding(
    xp: Any, liner: _Liner, contact: _Contact, yield_strength: Array, pressure: Array
) -> _Yielding:
    """Find the yield pressures, and how far the liner has yielded at the overpressure.

    At the overpressure, the liner may be elastic, partly plastic or fully plastic.
    """
    kappa, square = contact.kappa, liner.outer / liner.inner
    half = xp.log(square) / 2
    start, through = (1 - 1 / square) / 2 + kappa / square, half + kappa
    push = (1 + contact.mu) * pressure / yield_strength
    load = push + contact.tau / yield_strength
    unit = 1 / ((square - 1) / 2 + kappa)
    inside = (real(load) > real(start)) & (real(load) < real(through))
    partly = _spread(xp, kappa, 2 * where(inside, through - load, through - start))
    bare = real(kappa) <= 0
    whole = where(bare, kappa + np.nan, (load - half) / where(bare, kappa + 1, kappa))
    spread = where(real(load) < real(through), partly, whole)
    share = positive(1 + contact.mu)
    return _Yielding(
        first=(start * yield_strength - contact.tau) / share,
        full=(through * yield_strength - contact.tau) / share,
        spread=where(real(load) <= real(start), load * unit, spread),
        elastic=load * unit,
        spent=push * unit,
    )


@geometry
def autofrettage(
    *,
    layers: Sequence[TubeLayer],
    yield_strength: Array,
    inner_radius: Array,
    pressure: Array,
    axial_force_per_pressure: Array,
    temperature_change: Array = 0.0,
) -> Autofrettage:
    """Residual state of a lined tube after one overpressure, and its new elastic limit.

    sigma_r = -p + Y ln(r/a) in the yielded zone a..c, sigma_t = sigma_r + Y;
    p(c) = q + Y [ln(c/a) + (1 - c^2/b^2)/2] with the pressure q on the wrap. The module's
    docstring derives both.

    Parameters
    ----------
    layers : from the bore outwards, the liner first; it may be the only layer
    yield_strength : Y, of the liner [Pa]
    inner_radius : a, bore radius [m]
    pressure : overpressure [Pa]
    axial_force_per_pressure : N/p during the overpressure [m^2]; 0 for open ends, pi a^2 for closed
        ends
    temperature_change : of the wall during the overpressure, from the stress-free state [K]

    Returns
    -------
    pressures [Pa] and residual state; NaN where a liner without wrap collapses

    Raises
    ------
    ValueError
        Where the liner is not isotropic, or a layer of the wrap is not a balanced pair.

    Notes
    -----
    Valid: axial_margin >= 0, reverse_yield <= 1; elastic wrap; no hardening, far from ends.

    Tresca yields up to 15 % earlier than von Mises; pass Y 2/sqrt(3) to follow von Mises where
    sigma_z is midway between the other two. Thermal stress shifts the yield pressure and counts in
    `reverse_yield`; the other residual fields contain only what the overpressure adds.

    References
    ----------
    [Hill1950] partly plastic thick tube; [derived] elastic wrap, generalised plane strain

    Examples
    --------
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    >>> left = autofrettage(layers=[TubeLayer(stiffness=steel, thickness=16e-3)],
    ...                     yield_strength=355e6, inner_radius=16e-3, pressure=200e6,
    ...                     axial_force_per_pressure=0.0)
    >>> print(f"{left.plastic_radius * 1e3:.3f} mm {left.stresses[1][0, 0] / 1e6:.2f} MPa")
    21.254 mm -178.33 MPa
    """
    if not all(layer.balanced for layer in layers[1:]):
        message = "autofrettage needs balanced pairs: a wall that twists would shear the liner"
        raise ValueError(message)
    liner = _liner(layers[0], inner_radius, temperature_change, axial_force_per_pressure)
    xp = namespace(*layers[0].stiffness, liner.outer, liner.pull, pressure, yield_strength)
    wrap = None
    if len(layers) > 1:
        wrap = layered_tube(layers=layers[1:], inner_radius=inner_radius + layers[0].thickness)
    contact = _contact(liner, wrap, temperature_change)
    found = _yielding(xp, liner, contact, yield_strength, pressure)
    left, square, nu = found.spread - found.elastic, liner.outer / liner.inner, liner.ratio
    bore, edge = _share(found.spread * square), _share(found.spread)
    press = contact.kappa * yield_strength * left
    strain = contact.strain[0] * press
    growth = (1 - nu * nu) * yield_strength * left * square / liner.modulus - nu * strain
    differences = (bore - found.elastic * square, edge - found.elastic)
    hoop = [yield_strength * value for value in differences]
    own = _own_stresses(xp, liner, strain, (hoop[0], hoop[1]), press)
    zone = maximum(1 / square + 0 * edge, edge)
    loaded = _loaded(liner, contact, found, yield_strength, pressure)
    return Autofrettage(
        yield_pressure=found.first,
        full_pressure=found.full,
        plastic_radius=sqrt(liner.outer * zone),
        interface_pressure=press,
        axial_strain=strain,
        bore_displacement=inner_radius * growth,
        stresses=_all_stresses(xp, own, wrap, press, contact.pull * press),
        reverse_yield=_reverse(liner, contact, found, yield_strength, bore),
        elastic_limit=maximum(pressure + 0 * found.first, found.first),
        axial_margin=_margin(liner.ratio, loaded, bore, xp.log(square * zone) / 2),
    )


def _share(value: Array) -> Array:
    """Hoop minus radial stress, divided by the yield strength and limited to 1; NaN stays NaN."""
    return minimum(1 + 0 * value, value)


def _own_stresses(
    xp: Any, liner: _Liner, strain: Array, difference: tuple[Array, Array], press: Array
) -> Stress:
    """Residual stresses z, t, r at both faces of the liner, from its hoop minus radial stress."""
    radial = (0 * difference[0], -press)
    hoop = (difference[0], difference[1] - press)
    pulled = liner.modulus * strain
    axial = [pulled + liner.ratio * (r + t) for r, t in zip(radial, hoop, strict=True)]
    first, second, third = (xp.stack(xp.broadcast_arrays(*v)) for v in (axial, hoop, radial))
    return first, second, third, 0 * first


def _all_stresses(
    xp: Any, own: Stress, wrap: LayeredTube | None, press: Array, pull: Array
) -> Stress:
    """Stresses of the liner, and of the wrap under the residual pressure and pull of the liner."""
    one, two, three, slip = (value[:, None, ...] for value in own)
    if wrap is None:
        return one, two, three, slip
    state = tube_state(tube=wrap, inner_pressure=press, axial_force=2 * pi * pull)
    rest = ply_stresses_at_faces(tube=wrap, state=state)
    pairs = zip((one, two, three, slip), rest, strict=True)
    one, two, three, slip = (xp.concat(pair, axis=1) for pair in pairs)
    return one, two, three, slip


def _loaded(
    liner: _Liner, contact: _Contact, found: _Yielding, yield_strength: Array, pressure: Array
) -> tuple[Array, Array]:
    """Radial stress at the bore and E e_z (see the module), at the overpressure, divided by Y."""
    by_press, by_pressure, by_heat = contact.strain
    press = contact.kappa * yield_strength * found.spread - contact.mu * pressure - contact.tau
    stretch = by_press * press + by_pressure * pressure + by_heat - liner.free
    return -pressure / yield_strength, liner.modulus * stretch / yield_strength


def _margin(ratio: Array, loaded: tuple[Array, Array], bore: Array, way: Array) -> Array:
    """Distance of sigma_z to the nearer end of the range sigma_r to sigma_t, divided by Y.

    The result is the smaller of its values at the inner and the outer edge of the yielded zone.
    """
    radial, stretch = loaded
    margins = []
    for inward in (radial, radial + way):
        axial = stretch + ratio * (2 * inward + bore)
        margins.append(minimum(inward + bore - axial, axial - inward))
    return minimum(*margins)


def _reverse(
    liner: _Liner, contact: _Contact, found: _Yielding, yield_strength: Array, bore: Array
) -> Array:
    """Tresca stress at the unloaded bore, divided by the yield strength."""
    by_press, _, by_heat = contact.strain
    around = bore - found.spent * liner.outer / liner.inner
    press = contact.kappa * yield_strength * (found.spread - found.spent) - contact.tau
    stretch = liner.modulus * (by_press * press + by_heat - liner.free) / yield_strength
    along = stretch + liner.ratio * around
    return maximum(maximum(absolute(around), absolute(along)), absolute(around - along))
