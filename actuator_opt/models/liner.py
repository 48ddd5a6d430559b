"""Stress cycle of a liner, and the layer thickness that limits a tube's bore strain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import STEP, Array, absolute, array_of, geometry, namespace, real, where
from .layered_tube import TubeLayer, layered_tube, tube_state
from .strength import mises_product
from .strength_modes import Stress

_STEPS = 60
"""Largest number of search steps; halving alone would reach 1e-18 of the largest thickness."""

_SETTLED = 1e-9
"""Relative step that ends the search; one more Newton step then doubles the correct digits."""


@dataclass(frozen=True, slots=True)
class LinerCycle:
    """Stress cycle of a liner between rest and pressure.

    Parameters
    ----------
    strain_range : equivalent elastic strain from rest to pressure [-]
    shakedown : strain range divided by twice the yield strain [-]; above 1 every cycle yields in
        both directions
    at_rest, at_pressure : equivalent stress / yield strength [-]; above 1 the next cycle yields
    """

    strain_range: Array
    shakedown: Array
    at_rest: Array
    at_pressure: Array


def liner_cycle(
    *,
    stress: Stress,
    yield_strength: Array,
    youngs_modulus: Array,
    residual: Stress = (0.0, 0.0, 0.0, 0.0),
) -> LinerCycle:
    """Elastic strain range of an isotropic liner and its utilisation of the yield strength.

    With the elastic stress sigma and the von Mises stress s(.): range = s(sigma)/E,
    shakedown = s(sigma)/(2 Y). The utilisation is s(residual)/Y at rest and s(residual + sigma)/Y
    at pressure.

    Parameters
    ----------
    stress : elastic stresses 1, 2, 3 and 12 from rest to pressure [Pa]
    yield_strength : Y [Pa]
    youngs_modulus : E [Pa]
    residual : stresses at rest, from cooling and autofrettage [Pa]

    Returns
    -------
    strain range and utilisations [-]

    Notes
    -----
    Valid: isotropic liner, elastic wrap, all loads grow in proportion; no creep.

    Residual stress does not change the range: it decides whether the first cycles yield. For the
    liner to stop yielding, `shakedown` below 1 is necessary at each place; for a thin liner on an
    elastic wrap, it also suffices.

    References
    ----------
    [Johnson1985] Melan's theorem; [derived] von Mises of a stress range

    Examples
    --------
    >>> cycle = liner_cycle(stress=(60e6, 330e6, -20e6, 0.0), yield_strength=240e6,
    ...                     youngs_modulus=71.7e9, residual=(-20e6, -140e6, 0.0, 0.0))
    >>> print(f"{cycle.strain_range * 100:.3f} % {cycle.shakedown:.3f} {cycle.at_pressure:.3f}")
    0.443 % 0.662 0.781
    """
    one, two, three, slip = (a + b for a, b in zip(stress, residual, strict=True))
    squares = [
        mises_product(first=s, second=s) for s in (stress, residual, (one, two, three, slip))
    ]
    span, rest, peak = (namespace(square).sqrt(square) for square in squares)
    return LinerCycle(
        strain_range=span / youngs_modulus,
        shakedown=span / (2 * yield_strength),
        at_rest=rest / yield_strength,
        at_pressure=peak / yield_strength,
    )


@geometry
def layer_thickness_for_strain(
    *,
    layers: Sequence[TubeLayer],
    index: int,
    inner_radius: Array,
    strain: Array,
    pressure: Array,
    axial_force_per_pressure: Array,
    largest_thickness: Array,
) -> Array:
    """Thickness of a layer that limits the bore's hoop strain to a value.

    Solves u(t)/r_i = strain by Newton's method on 1/strain, which is nearly linear in t, and by
    halving the bracket where a step would leave it. A last Newton step carries the imaginary parts,
    so complex-step derivatives are exact.

    Parameters
    ----------
    layers : from the bore outwards; the thickness of layer `index` is not read
    index : index of the layer whose thickness is sought, 0 is the innermost [-]
    inner_radius : bore radius [m]
    strain : allowed hoop strain of the bore, u/r_i [-]
    pressure : internal gauge pressure [Pa]
    axial_force_per_pressure : N/p in the wall [m^2]; 0 for open ends, pi r_i^2 for closed ends
    largest_thickness : largest thickness tried [m]

    Returns
    -------
    thickness [m]; 0 where the other layers alone keep the strain below the limit

    Raises
    ------
    ValueError
        Where even the largest thickness leaves the strain above the limit.

    Notes
    -----
    Valid: as `tube_state`; one of several solutions if the strain does not fall steadily with t.

    References
    ----------
    [derived] inverse of `tube_state`

    Examples
    --------
    >>> aluminium = (106.2e9, 52.3e9, 52.3e9, 106.2e9, 52.3e9, 106.2e9, 26.95e9)
    >>> t = layer_thickness_for_strain(
    ...     layers=[TubeLayer(stiffness=aluminium, thickness=0.0)], index=0, inner_radius=16e-3,
    ...     strain=0.0015, pressure=25e6, axial_force_per_pressure=0.0, largest_thickness=30e-3)
    >>> print(f"{t * 1e3:.3f} mm")
    4.696 mm
    """
    loads = (inner_radius, pressure, axial_force_per_pressure * pressure)
    wall, plain, aim = [_plain(layer) for layer in layers], [real(v) for v in loads], real(strain)
    numbers = [v for layer in layers for v in (*layer.stiffness, layer.angle, layer.thickness)]
    xp = namespace(*numbers, inner_radius, strain, pressure, axial_force_per_pressure)

    def trial(thickness: Array) -> tuple[Array, Array]:
        """Bore strain at a thickness, and its slope."""
        step = xp.asarray(thickness, dtype=xp.complex128) + 1j * STEP
        value = _bore_strain(_with(wall, index, step), *plain)
        return xp.real(value), xp.imag(value) / STEP

    others = [*wall]
    del others[index]
    highest = real(largest_thickness)
    value, slope = trial(highest)
    start = highest + 0 * value
    spare = _bore_strain(others, *plain) <= aim if others else start < 0
    if np.any(array_of(((value > aim) & ~spare) | (aim <= 0))):
        message = "the bore strain exceeds its limit even with the largest thickness of this layer"
        raise ValueError(message)
    thickness, slope = _search(xp, trial, aim, (start, value, slope), spare)
    rest = _bore_strain(_with(layers, index, thickness), *loads) - strain
    return where(spare, 0 * thickness, thickness - rest / slope)


def _plain(layer: TubeLayer) -> TubeLayer:
    """The layer with only the real parts of its numbers."""
    c11, c12, c13, c22, c23, c33, c66 = (real(value) for value in layer.stiffness)
    return TubeLayer(
        stiffness=(c11, c12, c13, c22, c23, c33, c66),
        thickness=real(layer.thickness),
        angle=real(layer.angle),
        balanced=layer.balanced,
    )


def _with(layers: Sequence[TubeLayer], index: int, thickness: Array) -> list[TubeLayer]:
    """Copy the layers with another thickness of layer `index`."""
    changed = list(layers)
    changed[index] = replace(changed[index], thickness=thickness)
    return changed


def _bore_strain(
    layers: Sequence[TubeLayer], inner_radius: Array, pressure: Array, axial_force: Array
) -> Array:
    """Hoop strain of the bore."""
    tube = layered_tube(layers=layers, inner_radius=inner_radius)
    state = tube_state(tube=tube, inner_pressure=pressure, axial_force=axial_force)
    return state.hoop_strain[0, 0, ...]


def _search(
    xp: Any,
    trial: Callable[[Array], tuple[Array, Array]],
    aim: Array,
    start: tuple[Array, Array, Array],
    spare: Array,
) -> tuple[Array, Array]:
    """Thickness near the solution, and there the derivative of the bore strain by the thickness."""
    thickness, value, slope = start
    low, high = 0 * thickness, thickness
    for _ in range(_STEPS):
        thin = value > aim
        low, high = where(thin, thickness, low), where(thin, high, thickness)
        newton = thickness - value / aim * (value - aim) / slope
        inside = (newton > low) & (newton < high)
        following = where(inside, newton, (low + high) / 2)
        settled = absolute(following - thickness) <= _SETTLED * thickness
        thickness = following
        value, slope = trial(thickness)
        if bool(xp.all(settled | spare)):
            break
    return thickness, slope
