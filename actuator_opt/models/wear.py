"""Wear of seals, as far as it can be estimated without a wear test."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..base.numeric import (
    Array,
    absolute,
    geometry,
    histories,
    over_travel,
    positive,
    real,
    where,
)

SHORT_STROKE = 2.0
"""Stroke below which oil does not reach the whole contact, in contact widths (*choice*)."""


@geometry
def sliding_severity(*, line_load: Array, contact_width: Array, distance: Array) -> Array:
    """Mean contact pressure times sliding distance, (f/b) L: proportional to the depth worn.

    The worn depth is k (f/b) L with the wear rate k of the material pair. Only a test gives k, so
    the severity only compares designs with the same pair of materials.

    Parameters
    ----------
    line_load : normal force per length of circumference f [N/m]
    contact_width : b [m]
    distance : sliding distance L [m]

    Returns
    -------
    severity [Pa m]; 0 without contact

    Notes
    -----
    Valid: dry or boundary contact; with an oil film there is less wear.

    References
    ----------
    [Archard1953] volume worn proportional to load and distance

    Examples
    --------
    >>> s = sliding_severity(line_load=8e3, contact_width=1e-3, distance=0.22)
    >>> print(f"{s / 1e3:.0f} N/mm")
    1760 N/mm
    """
    touching = real(contact_width) > 0
    return where(touching, distance * line_load / where(touching, contact_width, 1.0), 0.0)


def sliding_distance(*, position: Array | Sequence[Array]) -> Array:
    """Distance that a seal slides in a cycle, S = sum |x_(i+1) - x_i|.

    Parameters
    ----------
    position : x at the samples, time on the first axis [m]

    Returns
    -------
    distance [m], without the time axis

    Notes
    -----
    Valid: samples contain the turning points.

    References
    ----------
    [derived] sum of the strokes

    Examples
    --------
    >>> print(f"{sliding_distance(position=[0.02, 0.06, 0.09, 0.05, 0.02]):.2f} m")
    0.14 m
    """
    (x,) = histories(position)
    return over_travel(1 + 0 * x, x)


def cycle_severity(
    *, contact_pressure: Array | Sequence[Array], position: Array | Sequence[Array]
) -> Array:
    """Contact pressure summed over the sliding distance of a cycle, s = sum p_c |x_(i+1) - x_i|.

    p_c is the mean of the two samples of an interval. At constant pressure the result equals
    `sliding_severity`.

    Parameters
    ----------
    contact_pressure : p_c at the samples, line load/contact width, time on the first axis [Pa]
    position : x at the samples, time on the first axis [m]

    Returns
    -------
    severity [Pa m], without the time axis

    Notes
    -----
    Valid: dry or boundary contact; samples contain the turning points.

    References
    ----------
    [Archard1953] volume worn proportional to load and distance; [derived] sum over the cycle

    Examples
    --------
    >>> s = cycle_severity(contact_pressure=[12e6, 18e6, 14e6, 9e6, 12e6],
    ...                    position=[0.02, 0.06, 0.09, 0.05, 0.02])
    >>> print(f"{s:.3e} Pa m")
    1.855e+06 Pa m
    """
    pressure, x = histories(contact_pressure, position)
    return over_travel(pressure, x)


def worn_depth(*, severity: Array, wear_rate: Array, repeats: Array) -> Array:
    """Depth worn off a seal in a life, delta = k s times the repeats of the cycle.

    Parameters
    ----------
    severity : s of a cycle, from `cycle_severity` [Pa m]
    wear_rate : k of the pair of materials, measured [m^2/N]
    repeats : cycles in a life [-]

    Returns
    -------
    depth [m]

    Notes
    -----
    Valid: steady wear after running-in; pressure, speed and heat as in the test of k.

    Orders of k (recalled, not verified): 1e-18 to 1e-16 m^2/N for filled PTFE on a hard smooth rod
    wetted by oil, 1e-17 to 1e-15 for a lubricated elastomer, a hundred times more if dry or gritty.

    References
    ----------
    [Archard1953] volume worn proportional to load and distance

    Examples
    --------
    >>> print(f"{worn_depth(severity=1.855e6, wear_rate=2e-17, repeats=1e6) * 1e6:.1f} um")
    37.1 um
    """
    return wear_rate * severity * repeats


@geometry
def wear_share(*, depth: Array, allowed_depth: Array) -> Array:
    """Share of a seal's wear allowance that a life uses up, delta/delta_allowed.

    Parameters
    ----------
    depth : delta, from `worn_depth` [m]
    allowed_depth : depth at which the seal leaks [m], > 0

    Returns
    -------
    share [-]; NaN where nothing is allowed

    Notes
    -----
    Valid: any depths.

    References
    ----------
    [derived] definition

    Examples
    --------
    >>> print(f"{wear_share(depth=37.1e-6, allowed_depth=50e-6):.3f}")
    0.742
    """
    return depth / positive(allowed_depth)


def pressure_velocity(*, contact_pressure: Array, speed: Array) -> Array:
    """Contact pressure times sliding speed, p_c |v|: the pV value of each sample.

    The pV value of a cycle is the largest of its samples.

    Parameters
    ----------
    contact_pressure : p_c, line load/contact width [Pa]
    speed : v, either sign [m/s]

    Returns
    -------
    pV [W/m^2], of the shape of both

    Notes
    -----
    Valid: compares seals with the limit of their maker; without flash temperature.

    References
    ----------
    [derived] definition of the pV value

    Examples
    --------
    >>> print(f"{pressure_velocity(contact_pressure=18e6, speed=-0.211616):.5e} W/m2")
    3.80909e+06 W/m2
    """
    return contact_pressure * absolute(speed)


class Strokes(NamedTuple):
    """Strokes of a position history between its reversals.

    Attributes
    ----------
    lengths : length of each stroke, in the order of the history (strokes,) [m]
    reversals : number of changes of direction [-]
    short : number of strokes shorter than `SHORT_STROKE` contact widths [-]
    """

    lengths: Array
    reversals: int
    short: int


def strokes(*, position: Array | Sequence[Array], contact_width: float, closed: bool) -> Strokes:
    """Strokes of a cycle, its reversals, and the strokes that starve the seal of oil.

    A stroke leads from one reversal to the next; a rest does not end it. Strokes shorter than two
    contact widths do not carry oil across the contact, so that the film becomes thinner; the wear
    law does not show this.

    Parameters
    ----------
    position : x at the samples of one history (samples,) [m]
    contact_width : of the seal [m]
    closed : whether the cycle repeats; then its first and last strokes are parts of one stroke,
        unless a reversal parts them [bool]

    Returns
    -------
    strokes, reversals and short strokes [m, -, -]; a closed cycle has as many strokes as reversals

    Raises
    ------
    ValueError
        A history that is not one-dimensional, or a position that is not a number.

    Notes
    -----
    Valid: samples contain the turning points.

    References
    ----------
    [ARP4895] seal duty by stroke class and reversals; [derived] two widths (our choice)

    Examples
    --------
    >>> x = [0.02, 0.06, 0.09, 0.05, 0.0501, 0.02]
    >>> found = strokes(position=x, contact_width=1e-3, closed=True)
    >>> print(found.reversals, found.short, (found.lengths * 1e3).round(1))
    4 1 [70.  40.   0.1 30.1]
    """
    x = np.real(np.asarray(position))
    if x.ndim != 1 or np.isnan(x).any():
        raise ValueError("position: needs the samples of one history, all of them numbers")
    turning = x[np.append(True, x[1:] != x[:-1])]
    step = np.sign(np.diff(turning))
    turning = turning[np.concatenate(([True], step[1:] != step[:-1], [True]))[: len(turning)]]
    lengths = np.abs(np.diff(turning))
    reversals = max(len(lengths) - 1, 0)
    if closed and len(lengths) > 1:
        if len(lengths) % 2:  # the cycle ends in the direction in which it begins
            lengths = np.append(lengths[0] + lengths[-1], lengths[1:-1])
        reversals = len(lengths)
    short = lengths < SHORT_STROKE * contact_width
    return Strokes(lengths, reversals, int(np.count_nonzero(short)))
