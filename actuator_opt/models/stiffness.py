"""Axial stiffness of the closed cylinder, its pressures at rest, and a load step with trapped air.

Each chamber has one compliance, C = V/K + dV/dp: that of its oil plus those of barrel, pipes and
hoses. The two chambers act on the piston as springs in parallel, which are in series with rod and
mounting. Chamber A is at the cap end, and its length is the piston position x; chamber B is at the
rod end, and its length is stroke - x. `stiffness_published` has the formulas as the sources print
them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..base.numeric import Array, clip, geometry, maximum, real, sqrt, where
from .fluid import ATMOSPHERIC_PRESSURE


@geometry
def chamber_compliance(*, volume: Array, bulk_modulus: Array, wall_compliance: Array) -> Array:
    """Volume that a closed chamber takes up per unit pressure, C = V/K + (dV/dp)_walls.

    Parameters
    ----------
    volume : oil volume with lines and dead volume [m^3]
    bulk_modulus : effective tangent value at the chamber's pressure [Pa]
    wall_compliance : sum over barrel, pipes and hoses [m^3/Pa]

    Returns
    -------
    compliance [m^3/Pa]

    Notes
    -----
    Valid: small pressure changes.

    References
    ----------
    [derived] oil and walls are under the same pressure

    Examples
    --------
    >>> print(f"{chamber_compliance(volume=7e-5, bulk_modulus=1.4e9, wall_compliance=2e-14):.2e}")
    7.00e-14
    """
    return volume / bulk_modulus + wall_compliance


@geometry
def chamber_stiffness(
    *, area: Array, volume: Array, bulk_modulus: Array, wall_compliance: Array
) -> Array:
    """Stiffness of one closed chamber on its piston face, k = A^2/C.

    Parameters
    ----------
    area : [m^2]
    volume : oil volume with lines and dead volume [m^3]
    bulk_modulus : effective tangent value at the chamber's pressure [Pa]
    wall_compliance : sum over barrel, pipes and hoses [m^3/Pa]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: small pressure changes.

    References
    ----------
    [AaltoThesis] eq. 6, one term; [derived] the walls' compliance adds to the oil's


    Examples
    --------
    >>> k = chamber_stiffness(area=5e-4, volume=5e-5, bulk_modulus=1.4e9, wall_compliance=0.0)
    >>> round(k)
    7000000
    """
    return area * area / (volume / bulk_modulus + wall_compliance)


@geometry
def hydraulic_stiffness(
    *,
    area_a: Array,
    compliance_a: Array,
    area_b: Array,
    compliance_b: Array,
    compliance_ab: Array = 0.0,
) -> Array:
    """Stiffness of both closed chambers, k_h = a^T C^-1 a with a = (A_A, -A_B).

    k_h = (A_A^2 C_B + A_B^2 C_A + 2 A_A A_B C_AB)/(C_A C_B - C_AB^2). Where neither chamber's
    pressure changes the other's volume, k_h = A_A^2/C_A + A_B^2/C_B.

    Parameters
    ----------
    area_a, area_b : [m^2]
    compliance_a, compliance_b : of the chambers at the piston position [m^3/Pa]
    compliance_ab : change of one chamber's volume per unit pressure in the other, caused by axial
        stretch of the barrel [m^3/Pa]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: ports closed, C_A C_B > C_AB^2.

    References
    ----------
    [AaltoThesis] eq. 6; [derived] the walls' compliance adds to the oil's in each chamber, and
    axial stretch couples the chambers

    Examples
    --------
    >>> round(hydraulic_stiffness(area_a=5e-4, compliance_a=5e-14,
    ...                           area_b=4e-4, compliance_b=4e-14))
    9000000
    """
    if isinstance(compliance_ab, float) and compliance_ab == 0.0:
        return area_a * area_a / compliance_a + area_b * area_b / compliance_b
    cross = compliance_a * compliance_b - compliance_ab * compliance_ab
    pull = area_a * area_a * compliance_b + area_b * area_b * compliance_a
    return (pull + 2 * area_a * area_b * compliance_ab) / cross


@geometry
def weakest_position(
    *,
    area_a: Array,
    area_b: Array,
    compliance_a0: Array,
    compliance_a_per_length: Array,
    compliance_b0: Array,
    compliance_b_per_length: Array,
    stroke: Array,
    compliance_ab0: Array = 0.0,
    compliance_ab_per_length: Array = 0.0,
) -> Array:
    """Piston position where the closed cylinder is softest, clipped to the stroke.

    With C_A = a0 + a' x, C_B = b0 + b' (s - x), C_AB = c0 + c' x the stiffness is N/D with
    N = n0 + n' x and D = d0 + d' x + d'' x^2, so dk_h/dx = 0 is
    n' d'' x^2 + 2 n0 d'' x + n0 d' - n' d0 = 0.

    Parameters
    ----------
    area_a, area_b : [m^2]
    compliance_a0, compliance_b0 : chamber compliance at zero chamber length [m^3/Pa]
    compliance_a_per_length, compliance_b_per_length : compliance per unit chamber length [m^2/Pa]
    stroke : [m]
    compliance_ab0, compliance_ab_per_length : C_AB at x = 0 [m^3/Pa], its change per unit x
        [m^2/Pa]

    Returns
    -------
    position from the cap end [m]

    Notes
    -----
    Valid: positive areas and compliances; k_h is convex in x, so its stationary point is a minimum.

    References
    ----------
    [derived] stationary point of `hydraulic_stiffness`

    Examples
    --------
    >>> x = weakest_position(area_a=4e-4, area_b=4e-4, compliance_a0=1e-14, stroke=0.1,
    ...     compliance_a_per_length=3e-13, compliance_b0=1e-14, compliance_b_per_length=3e-13)
    >>> print(f"{x:.3f}")
    0.050
    """
    a0, a1, c0, c1 = (
        compliance_a0,
        compliance_a_per_length,
        compliance_ab0,
        compliance_ab_per_length,
    )
    whole, b1 = compliance_b0 + compliance_b_per_length * stroke, compliance_b_per_length
    square_a, square_b, both = area_a * area_a, area_b * area_b, 2 * area_a * area_b
    top_0 = square_a * whole + square_b * a0 + both * c0
    top_1 = square_b * a1 - square_a * b1 + both * c1
    low_0 = a0 * whole - c0 * c0
    low_1 = a1 * whole - a0 * b1 - 2 * c0 * c1
    low_2 = a1 * b1 + c1 * c1
    half, rest = top_0 * low_2, top_0 * low_1 - top_1 * low_0
    position = rest / (half + sqrt(half * half + top_1 * low_2 * rest))
    return clip(position, 0.0, stroke)


def series(*stiffnesses: Array) -> Array:
    """Stiffness of springs in series, 1/k = sum 1/k_i.

    Parameters
    ----------
    stiffnesses : [N/m], positive (infinity is a rigid part)

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: everywhere; the result is never stiffer than the softest part.

    References
    ----------
    [derived] equal force, added deflections

    Examples
    --------
    >>> series(2.0, 2.0)
    1.0
    """
    flexibility: Array = 0.0
    for stiffness in stiffnesses:
        flexibility = flexibility + 1 / stiffness
    return 1 / flexibility


class HoldingPressures(NamedTuple):
    """Gauge pressures of both chambers while the closed valve holds the load [Pa]."""

    pressure_a: Array
    pressure_b: Array


@geometry
def holding_pressures(
    *, force: Array, supply_pressure: Array, return_pressure: Array, area_a: Array, area_b: Array
) -> HoldingPressures:
    """Chamber pressures after a critical-centre servo valve has closed on a held load.

    p_A = [F + (p_s + p_r) A_B]/(A_A + A_B), p_B = p_s + p_r - p_A, both limited to [p_r, p_s].

    Parameters
    ----------
    force : force the rod exerts on its load, > 0 push, < 0 pull [N]
    supply_pressure, return_pressure : gauge [Pa]
    area_a, area_b : [m^2]

    Returns
    -------
    gauge pressures of both chambers [Pa]

    Notes
    -----
    Valid: matched symmetrical valve edges; beyond the stall force, pressures stay at their limits.

    References
    ----------
    [Merritt1967] p_s = p_1 + p_2 of a matched valve; [derived] force balance of the piston

    Examples
    --------
    >>> holding_pressures(force=0.0, supply_pressure=1e7, return_pressure=0.0,
    ...                   area_a=4e-4, area_b=4e-4)
    HoldingPressures(pressure_a=5000000.0, pressure_b=5000000.0)
    """
    total = supply_pressure + return_pressure
    pressure = (force + total * area_b) / (area_a + area_b)
    pressure_a = clip(pressure, return_pressure, supply_pressure)
    return HoldingPressures(pressure_a, total - pressure_a)


class LoadStep(NamedTuple):
    """Response of a closed cylinder to a load step."""

    displacement: Array
    pressure_a: Array
    pressure_b: Array
    stiffness: Array


@geometry
def trapped_air_load_step(
    *,
    force: Array,
    area_a: Array,
    area_b: Array,
    volume_a: Array,
    volume_b: Array,
    air_volume_a: Array,
    air_volume_b: Array,
    initial_pressure_a: Array,
    initial_pressure_b: Array,
    bulk_modulus: Array,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> LoadStep:
    """Secant response of a closed cylinder with a constant mass of air in each chamber.

    Solves dV_A(p_A) = A_A dx, dV_B(p_B) = -A_B dx and (p_A - p_A0) A_A - (p_B - p_B0) A_B = F,
    where dV is the volume change of liquid of constant bulk modulus K plus that of a polytropic gas
    of constant mass. Substitution leaves one equation in p_A, decreasing and convex. Newton's
    method starts at the lowest p_A, where the gauge pressure in one chamber is -0.9 times the
    atmospheric pressure p_a. It rises to the root without overshoot, in a fixed number of 40 steps.

    Parameters
    ----------
    force : step of the force the rod exerts, > 0 push (the rod gives way inwards) [N]
    area_a, area_b : [m^2]
    volume_a, volume_b : chamber volumes with lines [m^3]
    air_volume_a, air_volume_b : air in the chambers, as volumes at atmospheric pressure [m^3]
    initial_pressure_a, initial_pressure_b : gauge [Pa]
    bulk_modulus : secant value of the oil [Pa]
    polytropic_index, atmospheric_pressure : n [-] and absolute pressure [Pa]

    Returns
    -------
    displacement, > 0 extends [m], both pressures [Pa], secant stiffness -F/dx [N/m]; all are NaN
    where no pressures above -0.9 p_a carry the load; the stiffness is NaN at zero force too

    Notes
    -----
    Valid: air neither dissolves nor is released; rigid walls.

    References
    ----------
    [derived] from the volume and force balances; idea of constant air [AaltoThesis] section 5.1

    Examples
    --------
    >>> step = trapped_air_load_step(force=1000.0, area_a=8e-4, area_b=8e-4, volume_a=8e-5,
    ...     volume_b=8e-5, air_volume_a=0.0, air_volume_b=0.0, initial_pressure_a=50e5,
    ...     initial_pressure_b=50e5, bulk_modulus=1.5e9)
    >>> print(f"{step.displacement * 1e3:.4f} mm, {step.stiffness / 1e6:.0f} kN/mm")
    -0.0417 mm, 24 kN/mm
    """
    index = 1 / polytropic_index
    start_a = initial_pressure_a + atmospheric_pressure
    start_b = initial_pressure_b + atmospheric_pressure
    gas_a = air_volume_a * (atmospheric_pressure / start_a) ** index
    gas_b = air_volume_b * (atmospheric_pressure / start_b) ** index
    liquid_a = (volume_a - air_volume_a) / bulk_modulus
    liquid_b = (volume_b - air_volume_b) / bulk_modulus
    lever = area_a / area_b

    def residual(absolute_a: Array) -> tuple[Array, Array, Array, Array]:
        """Mismatch of the volumes, its derivative by p_A, the change dV_A and p_B (absolute)."""
        absolute_b = start_b + ((absolute_a - start_a) * area_a - force) / area_b
        bubble_a = gas_a * (start_a / absolute_a) ** index
        bubble_b = gas_b * (start_b / absolute_b) ** index
        change_a = bubble_a - gas_a - liquid_a * (absolute_a - start_a)
        change_b = bubble_b - gas_b - liquid_b * (absolute_b - start_b)
        slope_a = -liquid_a - index * bubble_a / absolute_a
        slope_b = -(liquid_b + index * bubble_b / absolute_b) * lever
        mismatch = change_b + change_a / lever
        return mismatch, slope_b + slope_a / lever, change_a, absolute_b

    floor = 0.1 * atmospheric_pressure
    pressure = maximum(floor, start_a + (force - (start_b - floor) * area_b) / area_a)
    pressure = pressure * (1 + 1e-12)
    mismatch, slope, _, _ = residual(pressure)
    valid = real(mismatch) >= 0
    for _ in range(40):
        pressure = pressure - where(valid, mismatch, 0 * mismatch) / slope
        mismatch, slope, change_a, absolute_b = residual(pressure)
    displacement = where(valid, change_a / area_a, math.nan)
    moved = valid & (real(change_a) != 0)
    return LoadStep(
        displacement,
        where(valid, pressure - atmospheric_pressure, math.nan),
        where(valid, absolute_b - atmospheric_pressure, math.nan),
        where(moved, -force * area_a / where(moved, change_a, 1.0), math.nan),
    )
