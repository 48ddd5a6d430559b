"""Upper bounds from assumed shapes: stiffness of two chambers in one wall, load of a column.

Stiffness: an assumed (trial) motion of barrel and piston has at least the energy of the true motion
[Gurtin1972], so its energy gives an upper bound on the stiffness. In the trial motion the piston
moves by 1, the wall of one chamber widens, and the wall of the other chamber narrows by the same
volume. The cylinder end that a chamber's pressure pulls on moves too. Critical load: any trial
shape of a buckled stepped column gives an upper bound.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from ..base.dataclass import dataclass
from ..base.numeric import Array, geometry, namespace, sqrt

Chamber: TypeAlias = Literal["a", "b"]


@dataclass(frozen=True, slots=True)
class TrialMotion:
    """Assumed (trial) motions of the wall and of one cylinder end, per unit motion of the piston.

    `exchange` is a volume divided by the piston area B: the wall of one chamber widens by this
    volume, and the wall of the other chamber narrows by it. `pull` is the motion of the end that a
    chamber's pressure pulls on. The oil takes up the rest of the piston's displacement.
    """

    exchange: Array
    pull: Array


@geometry
def least_energy_motion(
    *,
    area_a: Array,
    area_b: Array,
    oil_a: Array,
    oil_b: Array,
    wall_a: Array,
    wall_b: Array,
    stretch: Array,
    pulling: Chamber,
) -> TrialMotion:
    """Trial motion that gives `trial_motion_stiffness` its least value for one actuator.

    Its `exchange` is v = (A_a/(A_b c_a) + 1/c_b)/(1/c_a + 1/c_b + 1/w_a + 1/w_b), where s is added
    to the c of the pulling chamber (c, w and s are explained below).

    Parameters
    ----------
    area_a, area_b : piston areas [m^2]
    oil_a, oil_b : c, compliance of the oil and the lines of either chamber [m^3/Pa]
    wall_a, wall_b : w, growth of either chamber's volume per unit pressure [m^3/Pa]
    stretch : s, volume that the pulling chamber gains per unit pressure by moving the end [m^3/Pa]
    pulling : chamber whose pressure pulls on the cylinder end that moves

    Returns
    -------
    the motion [-]

    Notes
    -----
    Valid: any positive compliances.

    References
    ----------
    [derived] the energy's derivatives are zero

    Examples
    --------
    >>> m = least_energy_motion(area_a=4e-4, area_b=3e-4, oil_a=2e-14, oil_b=1.5e-14,
    ...                         wall_a=2e-15, wall_b=1.5e-15, stretch=5e-16, pulling="b")
    >>> print(f"{m.exchange:.4f} {m.pull:.4f}")
    0.1024 0.0290
    """
    give_a = oil_a + stretch if pulling == "a" else oil_a
    give_b = oil_b + stretch if pulling == "b" else oil_b
    whole = 1 / give_a + 1 / give_b + 1 / wall_a + 1 / wall_b
    exchange = (area_a / area_b / give_a + 1 / give_b) / whole
    if pulling == "a":
        return TrialMotion(exchange, (1 - exchange * area_b / area_a) * stretch / give_a)
    return TrialMotion(exchange, (1 - exchange) * stretch / give_b)


@geometry
def trial_motion_stiffness(
    *,
    motion: TrialMotion,
    area_a: Array,
    area_b: Array,
    oil_a: Array,
    oil_b: Array,
    wall_a: Array,
    wall_b: Array,
    stretch: Array,
    pulling: Chamber,
) -> Array:
    """Upper bound on the stiffness of two closed chambers whose common wall is elastic.

    k <= ((1 - h_a) A_a - v A_b)^2/c_a + ((1 - h_b - v) A_b)^2/c_b + (v A_b)^2 (1/w_a + 1/w_b)
    + (h A)^2/s, where h and A are those of the pulling chamber; the other chamber's h is 0.

    Parameters
    ----------
    motion : v (`exchange`) and h (`pull`) of any trial motion [-]
    area_a, area_b : piston areas [m^2]
    oil_a, oil_b : c, compliance of the oil and the lines of either chamber [m^3/Pa]
    wall_a, wall_b : w, growth of either chamber's volume per unit pressure while its wall is held
        axially [m^3/Pa]
    stretch : s, volume that the pulling chamber gains per unit pressure by moving the end, without
        radial growth of the wall [m^3/Pa]
    pulling : chamber whose pressure pulls on the cylinder end that moves

    Returns
    -------
    upper bound on the stiffness [N/m]

    Notes
    -----
    Valid: one wall over both chambers.

    One part of the wall widens and the other narrows by the same volume. The energy that couples
    radial growth with axial strain is therefore zero over the whole wall.

    References
    ----------
    [derived] minimum potential energy of oil and wall

    Examples
    --------
    >>> m = TrialMotion(exchange=0.1024, pull=0.0290)
    >>> k = trial_motion_stiffness(motion=m, area_a=4e-4, area_b=3e-4, oil_a=2e-14, oil_b=1.5e-14,
    ...                            wall_a=2e-15, wall_b=1.5e-15, stretch=5e-16, pulling="b")
    >>> print(f"{k / 1e6:.3f} N/um")
    12.598 N/um
    """
    v, h = motion.exchange, motion.pull
    rod = area_a - area_b
    if pulling == "a":
        volume_a, volume_b, pulled = (1 - h - v) * area_a + v * rod, (1 - v) * area_b, area_a
    else:
        volume_a, volume_b, pulled = (1 - v) * area_a + v * rod, (1 - h - v) * area_b, area_b
    oil = volume_a * volume_a / oil_a + volume_b * volume_b / oil_b
    wall = (v * area_b) ** 2 * (1 / wall_a + 1 / wall_b)
    return oil + wall + (h * pulled) ** 2 / stretch


@dataclass(frozen=True, slots=True)
class TrialMode:
    """Integrals over the bent shape of a stepped column between two pins.

    For each of the two segments: the integral of the squared deflection (`square_1`, `square_2`)
    and of the squared slope (`slope_1`, `slope_2`). The shape is scaled to a deflection of 1 at the
    step, and each segment to a length of 1.
    """

    square_1: Array
    square_2: Array
    slope_1: Array
    slope_2: Array


@geometry
def buckled_mode(
    *,
    critical_load: Array,
    bending_stiffness_1: Array,
    length_1: Array,
    bending_stiffness_2: Array,
    length_2: Array,
) -> TrialMode:
    """Buckling shape of a stepped column between two pins: a sine in each segment.

    w = sin(k s)/sin(k L) over each segment, k = sqrt(P/EI).

    Parameters
    ----------
    critical_load : of bending alone, from `stepped.stepped_column_load` [N]
    bending_stiffness_1, bending_stiffness_2 : EI of both segments [N m^2]
    length_1, length_2 : their lengths [m]

    Returns
    -------
    integrals of the shape [-]

    Notes
    -----
    Valid: first mode, with a non-zero deflection at the step.

    References
    ----------
    [TimoshenkoGere1961] bars with varying cross-section

    Examples
    --------
    >>> mode = buckled_mode(critical_load=3.141592653589793**2, bending_stiffness_1=1.0,
    ...                     length_1=0.5, bending_stiffness_2=1.0, length_2=0.5)
    >>> print(f"{mode.square_1:.3f} {mode.slope_1:.4f}")
    0.500 1.2337
    """
    squares, slopes = [], []
    for stiffness, length in (
        (bending_stiffness_1, length_1),
        (bending_stiffness_2, length_2),
    ):
        angle = sqrt(critical_load / stiffness) * length
        xp = namespace(angle)
        tip, wave = xp.sin(angle), xp.sin(2 * angle) / (4 * angle)
        squares.append((0.5 - wave) / (tip * tip))
        slopes.append(angle * angle * (0.5 + wave) / (tip * tip))
    return TrialMode(squares[0], squares[1], slopes[0], slopes[1])


@geometry
def trial_mode_load(
    *,
    mode: TrialMode,
    bending_stiffness_1: Array,
    length_1: Array,
    bending_stiffness_2: Array,
    length_2: Array,
) -> Array:
    """Upper bound on the critical load of a stepped column between two pins.

    P <= (d1/L1 + d2/L2)/(c1 L1/EI1 + c2 L2/EI2): Timoshenko's energy quotient with M = P w.

    Parameters
    ----------
    mode : integrals c (square) and d (slope) of any shape that is 0 at both pins [-]
    bending_stiffness_1, bending_stiffness_2 : EI of both segments [N m^2]
    length_1, length_2 : their lengths [m]

    Returns
    -------
    upper bound on the critical load [N]

    Notes
    -----
    Valid: between two pins; exact for the buckling shape, else too high.

    References
    ----------
    [TimoshenkoGere1961] energy method with M^2/(2 EI); [derived] Schwarz's inequality

    Examples
    --------
    >>> mode = TrialMode(0.5, 0.5, 1.2337, 1.2337)
    >>> load = trial_mode_load(mode=mode, bending_stiffness_1=1.0, length_1=0.5,
    ...                        bending_stiffness_2=1.0, length_2=0.5)
    >>> print(f"{load:.4f}")
    9.8696
    """
    bent = (
        length_1 * mode.square_1 / bending_stiffness_1
        + length_2 * mode.square_2 / bending_stiffness_2
    )
    return (mode.slope_1 / length_1 + mode.slope_2 / length_2) / bent
