"""Hysteresis and threshold of a valve: plays between its signal and its spool.

Hysteresis H is the largest difference of the signals that give the same flow, while the signal is
slowly cycled between its limits. Threshold T is the change of the signal that is needed, after a
stop, to reverse the change of the flow. Both are signals, stated as shares of the full signal.

A play of half width r follows its input at most at the distance r, and stands still while it can.
With magnetic hysteresis and friction of the spool, the response of a valve to a reversal is a sum
of plays of several widths [BrokateSprekels1996].
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, maximum, minimum, positive

FASTER = 100.0
"""Corner frequency of a play over the natural frequency of the spool. Our choice: it adds 0.6
degrees of phase lag at the natural frequency."""


def play_half_widths(*, hysteresis: Array, threshold: Array) -> tuple[Array, Array]:
    """Half widths of the two plays whose mean has a hysteresis H and a threshold T.

    r1 = T/2 and r2 = H - T/2. After a reversal the mean y = (y1 + y2)/2 stands still until the
    signal has changed by 2 r1 = T. Then one play moves, and both from 2 r2 = 2 H - T on. The
    branches of a full cycle are r1 + r2 = H apart.

    Parameters
    ----------
    hysteresis : H [V]
    threshold : T, at most H [V]

    Returns
    -------
    r1 and r2 [V]; equal if T = H, which is a single play

    Notes
    -----
    Valid: 0 <= T <= H; signals that change by more than 2 H - T between reversals.

    References
    ----------
    [Thayer1962] hysteresis and threshold, recalled; [BrokateSprekels1996] sums of plays, recalled;
    [derived] two plays of equal weight (our choice)

    Examples
    --------
    >>> play_half_widths(hysteresis=0.3, threshold=0.1)
    (0.05, 0.25)
    """
    return 0.5 * threshold, hysteresis - 0.5 * threshold


@geometry
def play_rate(
    *, command: Array, output: Array, half_width: Array, natural_frequency: Array
) -> Array:
    """Rate of a play, y' = w [max(u - y - r, 0) + min(u - y + r, 0)].

    For w to infinity this is the play operator y = max(u - r, min(u + r, y)). The corner frequency
    w is `FASTER` times that of the spool, 2 pi f.

    Parameters
    ----------
    command : u, signal to the valve [V]
    output : y, which drives the spool [V]
    half_width : r >= 0 [V]
    natural_frequency : f, of the spool [Hz]

    Returns
    -------
    dy/dt [V/s]

    Notes
    -----
    Valid: signals well below the corner frequency w; at a rate of v, y lags by v/w more.

    References
    ----------
    [BrokateSprekels1996] play operator, recalled; [derived] lag instead of the jump of its rate

    Examples
    --------
    >>> play = {"half_width": 0.1, "natural_frequency": 100.0}
    >>> [round(play_rate(command=u, output=1.0, **play), 6) for u in (1.05, 1.2, 0.8)]
    [0.0, 6283.185307, -6283.185307]
    """
    apart = command - output
    corner = FASTER * 2 * pi * natural_frequency
    return corner * (maximum(apart - half_width, 0.0) + minimum(apart + half_width, 0.0))


def band_of_position(*, signal_band: Array, gain: Array) -> Array:
    """Band of positions within which a valve does not respond, dx = dU/K_p.

    With the hysteresis H, a proportional controller may stop anywhere within a band of H/K_p about
    the position without hysteresis. With the threshold T, a reversal by less than T/K_p has no
    effect.

    Parameters
    ----------
    signal_band : dU, hysteresis or threshold [V]
    gain : K_p of the proportional controller [V/m], > 0

    Returns
    -------
    width of the band [m]; NaN where the gain is not positive

    Notes
    -----
    Valid: a proportional position loop that comes to rest.

    References
    ----------
    [Merritt1967] error of a servo with a dead band in its valve, recalled; [derived] no response
    of the valve within the band

    Examples
    --------
    >>> print(f"{band_of_position(signal_band=0.3, gain=500.0) * 1e3:.2f} mm")
    0.60 mm
    """
    return signal_band / positive(gain)
