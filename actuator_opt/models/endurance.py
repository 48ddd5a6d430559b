"""Fatigue life under pressure cycles, and impact at the end of the stroke.

The cycles of a stress history are counted in `rainflow`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..base.numeric import Array, geometry, histories, maximum, namespace, real, sqrt, where

_LOW_CYCLES = 1e3
_LOW_SHARE = 0.9
_ENDLESS = 690.0
"""Natural logarithm of a number of cycles that counts as infinite, near the largest number."""


def cycles_to_failure(
    *,
    peak_stress: Array,
    ultimate_strength: Array,
    fatigue_limit: Array,
    limit_cycles: Array = 1e6,
    stress_ratio: Array = 0.0,
) -> Array:
    """Cycles of a pulsating stress until failure.

    Amplitude and mean are s_a, s_m = s (1 -+ R)/2. Goodman's line gives the equivalent fully
    reversed amplitude s_r = s_a/(1 - s_m/R_m). The Basquin line from 0.9 R_m at 1e3 cycles through
    the fatigue limit then gives the cycles N at s_r.

    Parameters
    ----------
    peak_stress : largest stress of the cycle, notch included [Pa]
    ultimate_strength : R_m [Pa]
    fatigue_limit : fully reversed amplitude endured for `limit_cycles`, with all reductions [Pa]
    limit_cycles : number of cycles for which the fatigue limit is stated [-]
    stress_ratio : R, smallest / largest stress [-]; 0 for a pressure that falls to zero

    Returns
    -------
    cycles [-]; 0 where the mean stress alone reaches R_m, infinite without tension

    Notes
    -----
    Valid: 1e3 to about 1e9 cycles; uniaxial tension or its von Mises equivalent.

    References
    ----------
    [Shigley2011] stress-life method, modified Goodman line

    Examples
    --------
    >>> n = cycles_to_failure(peak_stress=420e6, ultimate_strength=700e6, fatigue_limit=300e6)
    >>> print(f"{n:.3g}")
    1e+06
    """
    xp = namespace(peak_stress, ultimate_strength, fatigue_limit, limit_cycles)
    amplitude = peak_stress * (1 - stress_ratio) / 2
    left = 1 - peak_stress * (1 + stress_ratio) / (2 * ultimate_strength)
    idle, lost = real(amplitude) <= 0, real(left) <= 0
    low = _LOW_SHARE * ultimate_strength
    reversed_stress = where(idle | lost, low + 0 * amplitude, amplitude) / where(
        lost, 0 * left + 1, left
    )
    exponent = _basquin_exponent(xp, reversed_stress, low, fatigue_limit, limit_cycles)
    life = _LOW_CYCLES * xp.exp(exponent)
    life = where(idle, 0 * life + float("inf"), life)
    return where(lost, 0 * amplitude, life)


def _basquin_exponent(
    xp: Any, stress: Array, low: Array, fatigue_limit: Array, limit_cycles: Array
) -> Array:
    """ln(N/1e3) on the line from the stress `low` at 1e3 cycles through the fatigue limit."""
    slope = xp.log(limit_cycles / _LOW_CYCLES) / xp.log(fatigue_limit / low)
    return slope * xp.log(stress / low)


def reversed_amplitude(*, amplitude: Array, mean: Array, ultimate_strength: Array) -> Array:
    """Fully reversed amplitude of the same life, s_r = s_a/(1 - max(s_m, 0)/R_m).

    This is Goodman's line without credit for a compressive mean. `cycles_to_failure` gives that
    credit.

    Parameters
    ----------
    amplitude, mean : s_a >= 0 and s_m of a cycle, notch included [Pa]
    ultimate_strength : R_m [Pa]

    Returns
    -------
    amplitude s_r [Pa]; infinite where the mean stress alone reaches R_m

    Notes
    -----
    Valid: metals; uniaxial tension or its von Mises equivalent.

    References
    ----------
    [Shigley2011] modified Goodman line; [derived] no credit for compression (our choice)

    Examples
    --------
    >>> s = reversed_amplitude(amplitude=99.75e6, mean=99.75e6, ultimate_strength=570e6)
    >>> print(f"{s / 1e6:.4f} MPa")
    120.9091 MPa
    """
    left = 1 - maximum(0.0, mean) / ultimate_strength
    lost = real(left) <= 0
    stress = amplitude / where(lost, 0 * left + 1, left)
    return where(lost, 0 * left + float("inf"), stress)


def basquin_cycles(
    *, amplitude: Array, ultimate_strength: Array, fatigue_limit: Array, limit_cycles: Array
) -> Array:
    """Cycles of a fully reversed amplitude until failure, N = 1e3 (s_r/(0.9 R_m))^b.

    b = ln(N_w/1e3)/ln(S_w/(0.9 R_m)): a straight line in logarithms from 0.9 R_m at 1e3 cycles
    through the fatigue limit S_w at N_w cycles. It continues beyond N_w: no amplitude is harmless.

    Parameters
    ----------
    amplitude : s_r, fully reversed, from `reversed_amplitude` [Pa]
    ultimate_strength : R_m [Pa]
    fatigue_limit : S_w, fully reversed amplitude endured for N_w cycles, with all reductions [Pa]
    limit_cycles : N_w [-]

    Returns
    -------
    cycles [-]; infinite at no amplitude, 0 at an infinite one

    Notes
    -----
    Valid: from 1e3 cycles; beyond N_w on the safe side for steel.

    References
    ----------
    [Shigley2011] stress-life method; [derived] line continued beyond N_w (our choice)

    Examples
    --------
    >>> n = basquin_cycles(amplitude=120.9091e6, ultimate_strength=570e6, fatigue_limit=159e6,
    ...                    limit_cycles=5e8)
    >>> print(f"{n:.4e}")
    1.0749e+10
    """
    xp = namespace(amplitude, ultimate_strength, fatigue_limit, limit_cycles)
    idle, lost = real(amplitude) <= 0, real(amplitude) >= float("inf")
    low = _LOW_SHARE * ultimate_strength
    stress = where(idle | lost, low, amplitude)
    exponent = _basquin_exponent(xp, stress, low, fatigue_limit, limit_cycles)
    endless = idle | (real(exponent) > _ENDLESS)
    life = _LOW_CYCLES * xp.exp(where(endless, 0.0, exponent))
    life = where(endless, float("inf"), life)
    return where(lost, 0.0, life)


def miner_damage(
    *, cycles: Array | Sequence[Array], counts: Array | Sequence[Array], repeats: Array
) -> Array:
    """Damage by Miner's sum, D = repeats times the sum of n/N.

    Parameters
    ----------
    cycles : N endured by each cycle of the history, cycles on the first axis [-]
    counts : n, how often each occurs per repeat, of the same form [-]
    repeats : of the history in a life [-]

    Returns
    -------
    damage D [-], without the first axis; infinite where a cycle endures nothing

    Notes
    -----
    Valid: any order of cycles; tests scatter from D = 0.3 to 3 at failure.

    The life is reached at D = 1. Designs for a safe life limit D to 0.1 to 0.3.

    References
    ----------
    [Miner1945] cumulative damage

    Examples
    --------
    >>> print(miner_damage(cycles=[1e6, 4e5], counts=[1.0, 2.0], repeats=1e5))
    0.6
    """
    endured, number = histories(cycles, counts)
    failed = real(endured) <= 0
    share = number / where(failed, 1.0, endured)
    share = where(failed & (real(number) > 0), float("inf"), share)
    return repeats * namespace(share).sum(share, axis=0)


def fatigue_factor(
    *,
    peak_stress: Array,
    ultimate_strength: Array,
    amplitude_strength: Array,
    stress_ratio: Array = 0.0,
) -> Array:
    """Factor by which a pulsating stress may grow before the part misses its required life.

    1/(s_a/S_f + s_m/R_m), with the amplitude s_a and the mean s_m of the stress. S_f is the fully
    reversed amplitude endured for the required cycles.

    Parameters
    ----------
    peak_stress : largest stress of the cycle, notch included [Pa]
    ultimate_strength : R_m [Pa]
    amplitude_strength : S_f [Pa]
    stress_ratio : R, smallest / largest stress [-]

    Returns
    -------
    factor [-]; infinite without tension

    Notes
    -----
    Valid: tensile mean stress.

    References
    ----------
    [Shigley2011] modified Goodman line

    Examples
    --------
    >>> f = fatigue_factor(peak_stress=420e6, ultimate_strength=700e6, amplitude_strength=300e6)
    >>> print(f"{f:.4f}")
    1.0000
    """
    share = (1 - stress_ratio) / (2 * amplitude_strength)
    used = peak_stress * (share + (1 + stress_ratio) / (2 * ultimate_strength))
    idle = real(used) <= 0
    return where(idle, 0 * used + float("inf"), 1 / where(idle, 0 * used + 1, used))


@geometry
def bolt_endurance_amplitude(*, diameter: Array) -> Array:
    """Stress amplitude that a bolt's thread endures for two million cycles and more.

    sigma_A = 0.85 (150 mm/d + 45) MPa on the stress area, for threads rolled before heat treatment,
    at any mean stress.

    Parameters
    ----------
    diameter : nominal diameter [m]

    Returns
    -------
    amplitude [Pa]

    Notes
    -----
    Valid: property classes 8.8 to 12.9, d from 5 to 40 mm.

    References
    ----------
    [VDI2230] endurance limit of bolts

    Examples
    --------
    >>> print(f"{bolt_endurance_amplitude(diameter=10e-3) / 1e6:.1f} MPa")
    51.0 MPa
    """
    return 0.85e6 * (0.150 / diameter + 45)


@geometry
def bolt_cycles(*, amplitude: Array, diameter: Array) -> Array:
    """Cycles of a stress amplitude that a bolt's thread endures.

    N = 2e6 (sigma_A/sigma_a)^3, sigma_A of `bolt_endurance_amplitude`.

    Parameters
    ----------
    amplitude : sigma_a on the stress area [Pa]
    diameter : nominal diameter [m]

    Returns
    -------
    cycles [-]; infinite at no amplitude

    Notes
    -----
    Valid: 1e4 to 2e6 cycles; beyond, on the safe side (the line is not levelled off).

    References
    ----------
    [VDI2230] finite life of bolts

    Examples
    --------
    >>> print(f"{bolt_cycles(amplitude=102e6, diameter=10e-3):.0f}")
    250000
    """
    idle = real(amplitude) <= 0
    endured = bolt_endurance_amplitude(diameter=diameter)
    share = endured / where(idle, 0 * amplitude + 1, amplitude)
    return where(idle, 0 * share + float("inf"), 2e6 * share * share * share)


def end_stop_compression(
    *, driving_force: Array, stiffness: Array, mass: Array, velocity: Array
) -> Array:
    """Travel into a linear end stop, or into the oil trapped in front of it.

    delta = [F_d + sqrt(F_d^2 + k m v^2)]/k; trapped oil has k = K A^2/V.

    Parameters
    ----------
    driving_force : F_d, net force that keeps pushing [N]
    stiffness : k of the stop [N/m]
    mass : moving mass [kg]
    velocity : v at the stop [m/s]

    Returns
    -------
    travel [m]

    Notes
    -----
    Valid: no damping (conservative).

    References
    ----------
    [derived] m v^2/2 + F_d delta = k delta^2/2

    Examples
    --------
    >>> d = end_stop_compression(driving_force=6000.0, stiffness=3e7, mass=40.0, velocity=0.3)
    >>> print(f"{d * 1e3:.3f} mm")
    0.600 mm
    """
    inside = driving_force * driving_force + stiffness * mass * velocity * velocity
    return (driving_force + sqrt(inside)) / stiffness


def end_stop_energy(
    *, driving_force: Array, compression: Array, mass: Array, velocity: Array
) -> Array:
    """Energy that an end stop absorbs.

    E = m v^2/2 + F_d delta.

    Parameters
    ----------
    driving_force : F_d, net force that keeps pushing [N]
    compression : delta, travel into the stop [m]
    mass : moving mass [kg]
    velocity : v at the stop [m/s]

    Returns
    -------
    energy [J]

    Notes
    -----
    Valid: no damping (conservative).

    References
    ----------
    [derived] kinetic energy and the work of the driving force

    Examples
    --------
    >>> e = end_stop_energy(driving_force=6000.0, compression=0.6e-3, mass=40.0, velocity=0.3)
    >>> print(f"{e:.2f} J")
    5.40 J
    """
    return mass * velocity * velocity / 2 + driving_force * compression


def end_stop_peak_force(*, stiffness: Array, compression: Array) -> Array:
    """Peak force of a linear end stop.

    F = k delta, delta from `end_stop_compression`.

    Parameters
    ----------
    stiffness : k of the stop [N/m]
    compression : delta, travel into the stop [m]

    Returns
    -------
    peak force [N]

    Notes
    -----
    Valid: linear stop.

    References
    ----------
    [derived] definition of the stiffness

    Examples
    --------
    >>> print(f"{end_stop_peak_force(stiffness=3e7, compression=0.6e-3):.0f} N")
    18000 N
    """
    return stiffness * compression


@geometry
def end_stop_peak_pressure(*, pressure: Array, peak_force: Array, area: Array) -> Array:
    """Peak pressure of oil trapped at the end of the stroke.

    p = p_0 + F_peak/A.

    Parameters
    ----------
    pressure : p_0, gauge pressure before the stop [Pa]
    peak_force : force of the trapped oil on the piston, from `end_stop_peak_force` [N]
    area : piston area of the trapped side [m^2]

    Returns
    -------
    peak gauge pressure [Pa]

    Notes
    -----
    Valid: sealed end volume, no cushion flow (conservative).

    References
    ----------
    [derived] force balance of the piston

    Examples
    --------
    >>> p = end_stop_peak_pressure(pressure=1e6, peak_force=18e3, area=9e-4)
    >>> print(f"{p / 1e6:.1f} MPa")
    21.0 MPa
    """
    return pressure + peak_force / area
