"""Upper bound on the critical load of a stepped column, from any trial shape."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.numeric import Array, geometry, namespace, sqrt


@dataclass(frozen=True, slots=True)
class TrialMode:
    """A bent shape between two pins, 1 where the segments meet, each over its own length.

    Integrals over 0 to 1 of the square of the deflection of both segments, and of the square of
    its derivative.
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
    """The shape in which a stepped column between two pins buckles: sines that meet.

    w = sin(k s)/sin(k L) over each segment, k = sqrt(P/EI).

    Parameters
    ----------
    critical_load : by bending alone, `stepped.stepped_column_load` [N]
    bending_stiffness_1, bending_stiffness_2 : EI of both segments [N m^2]
    length_1, length_2 : their lengths [m]

    Returns
    -------
    integrals of the shape [-]

    Notes
    -----
    Valid: first mode, the joint off the middle of a node line.

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
    load that is no less than the critical one [N]

    Notes
    -----
    Valid: between two pins; exact where the shape is the buckled one, else from above.

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
