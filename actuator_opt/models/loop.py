"""Modes of the held actuator, its position loop, and controller tuning.

Roots are found from the real parts of the coefficients. The implicit-function theorem carries the
imaginary parts (complex steps) to each result, so every result has its exact derivative. Tuning
rules start from the ultimate point, where the loop is at its limit of stability; the controller is
u = K (e + (1/T_i) integral of e + T_d de/dt).
"""

from __future__ import annotations

import math
from math import pi
from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import (
    Array,
    absolute,
    angle,
    array_of,
    clip,
    positive,
    real,
    sqrt,
    where,
)
from ..base.polynomial import (
    Parts,
    Polynomial,
    add,
    at_frequency,
    at_point,
    even_and_odd,
    moved_root,
    multiply,
    positive_root,
    root_parts,
    roots,
    scale,
    square_of_magnitude,
)
from .linear import LinearActuator


class Mode(NamedTuple):
    """A pair of poles as frequency and damping ratio."""

    natural_frequency: Array
    """[Hz]"""
    damping_ratio: Array


def _without_integrators(polynomial: Polynomial) -> Polynomial:
    """Divide out roots at zero: the lowest coefficients, if they are the plain number 0."""
    start = 0
    for coefficient in polynomial:
        if not (isinstance(coefficient, (int, float)) and coefficient == 0):
            break
        start += 1
    return polynomial[start:]


def poles(*, model: LinearActuator) -> np.ndarray:
    """Every pole of the held actuator except those at zero, (..., n) complex [rad/s].

    Parameters
    ----------
    model : from `linear.linear_actuator`

    Returns
    -------
    roots of the characteristic polynomial [rad/s]

    Notes
    -----
    Valid: mass > 0; real parts of the coefficients count (no complex step).

    References
    ----------
    [derived] eigenvalues of the companion matrix

    Examples
    --------
    >>> from actuator_opt.models.linear import Side, linear_actuator
    >>> side = Side(area=5e-4, compliance=5e-14)
    >>> model = linear_actuator(side_a=side, side_b=side, mass=10.0, damping=100.0)
    >>> print(np.round(poles(model=model).imag))
    [ 1000. -1000.]
    """
    return roots(_without_integrators(model.characteristic))


SHARES_THAT_COUNT = (0.05, 0.25)
"""Shares of the load's motion from which an oscillating pair of poles counts, and counts in full
(our choice: oil that oscillates in a line moves the load less, and two pairs that share the load
evenly both count)."""


def load_mode(*, model: LinearActuator) -> Mode:
    """Mode of the load on the oil: its least damped pair of poles.

    omega^2 = lambda_1 lambda_2, zeta = -(lambda_1 + lambda_2)/(2 omega) of each pair. After a blow
    on the load, its speed is the sum of p_i e^(lambda_i t), with p_i = m lambda_i M/N' at lambda_i;
    all p_i together are 1. A pair that oscillates has the share p = p_1 + p_2. It counts with
    zeta + (1 - h) (1 - zeta); the weight h rises from 0 to 1 between p = 0.05 and p = 0.25
    (`SHARES_THAT_COUNT`). The less the load takes part, the less a pair lowers the result. The
    least value counts.

    If no such pair oscillates, the two real poles with the smallest ratio count, so zeta >= 1; it
    is set to 1 while a pair without the load oscillates. Of two poles with unlike signs, the
    growing one counts: zeta = -lambda/omega with omega^2 = -lambda_1 lambda_2. Where the load runs
    away without oscillation (a real pole with lambda > 0 and 2 p at least 0.25), this pole counts
    before all pairs. Elsewhere, the ratio has no jump: not where an oscillation begins or ends,
    and not where another pair becomes the least damped.

    Parameters
    ----------
    model : from `linear.linear_actuator`

    Returns
    -------
    natural frequency [Hz] and damping ratio, negative where the motion grows (stick-slip); 0 Hz and
    an infinite ratio where no oil holds the load

    Notes
    -----
    Valid: simple poles; mass > 0. NaN only for a coefficient that is not finite.

    References
    ----------
    [derived] eigenvalues with their derivative -dN(lambda)/N'(lambda), residues of s M/N

    Examples
    --------
    >>> from actuator_opt.models.linear import Side, linear_actuator
    >>> side = Side(area=5e-4, compliance=5e-14)
    >>> model = linear_actuator(side_a=side, side_b=side, mass=10.0, damping=100.0)
    >>> mode = load_mode(model=model)
    >>> print(f"{mode.natural_frequency:.2f} Hz, {mode.damping_ratio:.4f}")
    159.15 Hz, 0.0050
    """
    polynomial = _without_integrators(model.characteristic)
    found = root_parts(polynomial)
    count = found.real.shape[-1]
    if count < 2:
        still = np.zeros(found.real.shape[:-1])
        return Mode(still, still + math.inf)
    with np.errstate(all="ignore"):
        size = np.hypot(found.real, found.imaginary)
        swings = np.abs(found.imaginary) > 1e-9 * size
        ratio = -found.real / size
        whole, part = model.characteristic, scale(model.mobile, model.mass)
        weight = _weight(_lifted(whole), _lifted(part), found)
        score = np.where(
            swings & (found.imaginary > 0) & (weight > 0),
            ratio + (1 - weight) * (1 - ratio),
            math.inf,
        )
        first, second = np.triu_indices(count, 1)
        ceiling = np.where(np.any(swings, axis=-1), 1.0, math.inf)
        size = np.where(swings, math.nan, size)
        runaway = (found.real > 0) & (weight >= 1)
        score = np.concatenate(
            [score, _real_pairs(size * np.sign(found.real), runaway, first, second)], axis=-1
        )
        best = _least_at(score)
        known = np.isfinite(np.take_along_axis(score, best, axis=-1)[..., 0])
        known = known | np.any(np.isnan(found.real), axis=-1)  # NaN in, NaN out
        every = np.arange(count)

        def parts(index: np.ndarray) -> Parts:
            ordered = (values[..., index] for values in found)
            return Parts(*(np.take_along_axis(x, best, axis=-1)[..., 0] for x in ordered))

        one, two = parts(np.append(every, first)), parts(np.append(every, second))
        pair = best[..., 0] < count
        two = Parts(two.real, where(pair, -one.imaginary, two.imaginary))
        one, two = moved_root(polynomial, one), moved_root(polynomial, two)
        product = one.real * two.real - one.imaginary * two.imaginary
        apart = real(product) < 0  # one real pole grows, the other fades: the growing pole counts
        grows = where(real(one.real) > 0, one.real, two.real)
        omega = sqrt(where(apart, -product, product))
        ratio = -where(apart, grows, 0.5 * (one.real + two.real)) / omega
        still = where(real(ratio) > ceiling, ceiling, ratio)
        ratio = where(pair, ratio + (1 - _weight(whole, part, one)) * (1 - ratio), still)
        return Mode(where(known, omega / (2 * pi), 0.0), where(known, ratio, ceiling))


def _weight(whole: Polynomial, part: Polynomial, root: Parts) -> Array:
    """Weight of an oscillating pair, 0 to 1, from the load's share s `part`/`whole`' at a root."""
    top = at_point((0.0, *part), root)
    low = at_point(tuple(k * c for k, c in enumerate(whole))[1:], root)
    square = low.real * low.real + low.imaginary * low.imaginary
    share = 2 * (top.real * low.real + top.imaginary * low.imaginary) / square
    least, full = SHARES_THAT_COUNT
    return clip((share - least) / (full - least), 0.0, 1.0)


def _real_pairs(poles: Array, runaway: Array, first: np.ndarray, second: np.ndarray) -> Array:
    """Score of pairs of real poles; the lowest is chosen. Infinite for pairs that are none.

    A growing and a fading pole are a pair only if the load runs away with one of them. Such pairs
    come before every oscillation, whose score is between -1 and 1, all others after it. Of
    these, the closest poles come first.
    """
    one, two = poles[..., first], poles[..., second]
    close = 2 * np.sqrt(np.abs(one * two)) / (np.abs(one) + np.abs(two))
    grow = runaway[..., first] | runaway[..., second]
    alike = (one * two > 0) | grow
    return np.where((close > 0) & alike, np.where(grow, -2.0, 2.0) - close, math.inf)


def _least_at(values: Array) -> Array:
    """Index of the least value along the last axis, which stays as an axis of length 1."""
    index: Array = np.argmin(values, axis=-1)
    return index[..., None]


@dataclass(frozen=True, slots=True)
class PositionOpenLoop:
    """Open position loop, position / error at unit gain: L(s) = numerator/denominator [m/V]."""

    numerator: Polynomial
    denominator: Polynomial


def open_loop(
    *, model: LinearActuator, natural_frequency: Array, damping_ratio: Array
) -> PositionOpenLoop:
    """Open position loop at unit gain: a second-order spool in front of the actuator.

    L = omega_v^2/(s^2 + 2 zeta omega_v s + omega_v^2) T(s)/N(s), with natural frequency omega_v and
    damping ratio zeta of the spool, and T and N of the `linear.LinearActuator`.

    Parameters
    ----------
    model : from `linear.linear_actuator`, with the valve's flow gains
    natural_frequency : of the spool [Hz]
    damping_ratio : of the spool [-]

    Returns
    -------
    numerator and denominator polynomials of L [m/V]

    Notes
    -----
    Valid: linear spool, no rate limit.

    References
    ----------
    [MECE5005] position control of a cylinder; [derived] linearised

    Examples
    --------
    >>> from actuator_opt.models.linear import Side, linear_actuator
    >>> model = linear_actuator(side_a=Side(5e-4, 5e-14, flow_gain=1e-5),
    ...     side_b=Side(5e-4, 5e-14, flow_gain=-1e-5), mass=10.0, damping=100.0)
    >>> len(open_loop(model=model, natural_frequency=100.0, damping_ratio=0.7).denominator)
    7
    """
    omega = 2 * pi * natural_frequency
    spool = (1.0, 2 * damping_ratio / omega, 1 / (omega * omega))
    return PositionOpenLoop(model.drive, multiply(model.characteristic, spool))


def _crossings(polynomial: Polynomial) -> np.ndarray:
    """Positive real roots w = omega^2 of a polynomial in w, (..., n); NaN for all other roots."""
    along, across = root_parts(polynomial)
    near_axis = np.abs(across) <= 1e-6 * np.hypot(along, across)
    return np.where(near_axis & (along > 0), along, np.nan)


def _value(polynomial: Polynomial, point: Array) -> Array:
    """Value of a polynomial at a real point."""
    value: Array = 0.0
    for coefficient in reversed(polynomial):
        value = value * point + coefficient
    return value


def _lifted(polynomial: Polynomial) -> Polynomial:
    """Real parts of the coefficients with a new last axis, for evaluation at many points."""
    return tuple(array_of(real(coefficient))[..., None] for coefficient in polynomial)


def _chosen(crossings: np.ndarray, score: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The crossing with the lowest score, and whether there is a valid crossing at all.

    Only valid crossings have a finite score. If there is none, the number 1 replaces the crossing.
    """
    if not score.shape[-1]:
        return np.ones(score.shape[:-1]), np.zeros(score.shape[:-1], dtype=bool)
    best = _least_at(score)
    square = np.take_along_axis(crossings, best, axis=-1)[..., 0]
    found = np.isfinite(np.take_along_axis(score, best, axis=-1)[..., 0])
    return np.where(found, square, 1.0), found


class UltimateGain(NamedTuple):
    """Gain and frequency at which the loop begins to oscillate by itself."""

    gain: Array
    """[V/m]; infinite if no gain makes the loop unstable, 0 if every gain does or the actuator is
    unstable by itself."""
    frequency: Array
    """[Hz]; NaN without oscillation."""


def ultimate_gain(*, loop: PositionOpenLoop) -> UltimateGain:
    """Smallest gain with a closed-loop pole on the imaginary axis.

    With the open loop N/D at unit gain, Im[N(i omega) conj D(i omega)] = 0 gives every frequency
    omega at which a pole may cross the axis. There K = -|D|^2/Re(N conj D); the smallest positive K
    is the limit.

    Parameters
    ----------
    loop : from `open_loop`

    Returns
    -------
    gain [V/m] and frequency [Hz]

    Notes
    -----
    Valid: the actuator is stable without the loop and follows a slow signal; else the gain is 0.

    References
    ----------
    [derived] Nyquist criterion on the real axis; [ZieglerNichols1942] ultimate gain

    Examples
    --------
    >>> loop = PositionOpenLoop((1.0,), (0.0, 1.0, 1.4e-3, 1e-6))  # omega 1000 1/s, zeta 0.7
    >>> limit = ultimate_gain(loop=loop)
    >>> print(f"{limit.gain:.1f}, {limit.frequency:.2f} Hz")
    1400.0, 159.15 Hz
    """
    top, low = even_and_odd(loop.numerator), even_and_odd(loop.denominator)
    axis = add(multiply(top[1], low[0]), scale(multiply(top[0], low[1]), -1.0))
    along = add(multiply(top[0], low[0]), multiply((0.0, 1.0), top[1], low[1]))
    size = square_of_magnitude(loop.denominator)
    axis = _without_integrators(axis)
    crossings = _crossings(axis)
    with np.errstate(all="ignore"):
        gains = -_value(_lifted(size), crossings) / _value(_lifted(along), crossings)
        score = np.where(np.isfinite(gains) & (gains > 0), gains, np.inf)
        start, found = _chosen(crossings, score)
        square = positive_root(axis, start)
        gain = where(found, -_value(size, square) / _value(along, square), math.inf)
        gain = where(real(gain) > 0, gain, np.min(score, axis=-1, initial=math.inf))
    stable = _holds(loop)
    unknown = _unknown(loop)
    gain = where(unknown, math.nan, where(stable, gain, 0.0))
    swings = found & stable & ~unknown
    return UltimateGain(gain, where(swings, sqrt(square) / (2 * pi), math.nan))


def _unknown(loop: PositionOpenLoop) -> Array:
    """Whether a coefficient is not a number."""
    known: Array = np.True_
    for coefficient in (*loop.numerator, *loop.denominator):
        known = known & np.isfinite(real(coefficient))
    return ~known


def _holds(loop: PositionOpenLoop) -> Array:
    """Whether the loop is stable at a small gain: no pole grows, and position follows the signal.

    A pressure that cannot leak away leaves a pole at zero, which does no harm.
    """
    low = _without_integrators(loop.denominator)
    along, across = root_parts(low)
    finite = np.isfinite(along) & np.isfinite(across)
    sizes = np.where(finite, np.hypot(along, across), 0.0)
    slow = sizes <= 1e-12 * np.max(sizes, axis=-1, keepdims=True, initial=0.0)
    stable = np.all((along < 0) | (slow & finite), axis=-1)
    integrators = len(loop.denominator) - len(low)
    if not integrators:
        return stable
    top, low = (*loop.numerator[integrators - 1 :], 0.0, 0.0), (*low, 0.0)
    with np.errstate(all="ignore"):
        slowly, faster = (real(top[i]) / array_of(real(low[i])) for i in (0, 1))
        leads = where(real(low[0]) == 0, faster, slowly)
        return stable & ~(leads < -1e-9 * np.nan_to_num(np.abs(faster), posinf=0.0))


class PositionLoopMargins(NamedTuple):
    """Phase margin, crossover and bandwidth of a closed position loop."""

    phase_margin: Array
    """[rad]"""
    crossover: Array
    """Frequency at which the open loop has magnitude 1 [Hz]."""
    bandwidth: Array
    """Frequency at which the closed loop falls to -3 dB [Hz]."""


def margins(*, loop: PositionOpenLoop, gain: Array) -> PositionLoopMargins:
    """Phase margin, the crossover where it occurs, and -3 dB bandwidth of the position loop.

    The open loop is K N/D. |K N|^2 = |D|^2 gives the crossovers, and the first root of
    |D + K N|^2 = 2 |K N|^2 gives the bandwidth. The phase margin is the smallest angle between
    K N/D and -1 over all crossovers.

    Parameters
    ----------
    loop : from `open_loop`
    gain : K_p [V/m], > 0

    Returns
    -------
    phase margin [rad], infinite without a crossover; crossover [Hz], NaN without any; bandwidth
    [Hz], 0 where the position does not follow

    Notes
    -----
    Valid: below the ultimate gain; the angle does not show on which side -1 is passed.

    References
    ----------
    [derived] from the loop's polynomials

    Examples
    --------
    >>> loop = PositionOpenLoop((1.0,), (0.0, 1.0))  # an integrator
    >>> m = margins(loop=loop, gain=100.0)
    >>> print(f"{m.phase_margin:.4f} rad, {m.crossover:.3f} Hz, {m.bandwidth:.3f} Hz")
    1.5708 rad, 15.915 Hz, 15.915 Hz
    """
    forward = scale(loop.numerator, gain)
    top = square_of_magnitude(forward)
    unity = add(square_of_magnitude(loop.denominator), scale(top, -1.0))
    half = add(square_of_magnitude(add(loop.denominator, forward)), scale(top, -2.0))
    crossings, falling = _crossings(unity), _crossings(half)
    with np.errstate(all="ignore"):
        angles = _phase(_lifted(forward), _lifted(loop.denominator), np.sqrt(crossings))
        score = np.where(np.isfinite(crossings), np.abs(angles), np.inf)
        start, found = _chosen(crossings, score)
        omega = sqrt(positive_root(unity, start))
        phase = where(found, absolute(_phase(forward, loop.denominator, omega)), math.inf)
        start, falls = _chosen(falling, np.where(np.isfinite(falling), falling, np.inf))
        width = where(falls, sqrt(positive_root(half, start)) / (2 * pi), 0.0)
    unknown = _unknown(loop) | np.isnan(real(gain))
    return PositionLoopMargins(
        where(unknown, math.nan, phase),
        where(found, omega / (2 * pi), math.nan),
        where(unknown, math.nan, width),
    )


def _phase(upper: Polynomial, lower: Polynomial, omega: Array) -> Array:
    """Angle of the ratio -`upper`/`lower` at s = i omega."""
    top, low = at_frequency(upper, omega), at_frequency(lower, omega)
    along = top.real * low.real + top.imaginary * low.imaginary
    across = top.imaginary * low.real - top.real * low.imaginary
    return angle(-across, -along)


GAIN_MARGIN = 3.0
"""Ratio of ultimate gain to gain (our choice: a reserve for effects of friction, oil and stroke
that the linear loop leaves out)."""


_ZIEGLER_NICHOLS = {"p": (0.5, None, 0.0), "pi": (0.45, 1 / 1.2, 0.0), "pid": (0.6, 1 / 2, 1 / 8)}
"""K/K_u, T_i/T_u and T_d/T_u of each controller."""


class ControllerGains(NamedTuple):
    """Gain, integral time and derivative time of a controller."""

    proportional_gain: Array
    """K, in the unit of the ultimate gain."""
    integral_time: Array
    """T_i [s]; infinite without an integral part."""
    derivative_time: Array
    """T_d [s]; 0 without a derivative part."""


def ziegler_nichols(*, law: str, ultimate_gain: Array, ultimate_period: Array) -> ControllerGains:
    """Ziegler-Nichols rule from the ultimate point: quick, for a plant that is well damped.

    P 0.5 K_u; PI 0.45 K_u, T_u/1.2; PID 0.6 K_u, T_u/2, T_u/8. With a lightly damped oil spring the
    PID has hardly any gain margin and the PI oscillates; `margin_rules` gives a calmer loop there.

    Parameters
    ----------
    law : "p", "pi" or "pid" [-]
    ultimate_gain : K_u, the gain at which the loop keeps oscillating [V/m or another unit]
    ultimate_period : T_u, period of that oscillation [s]

    Returns
    -------
    gain [that of K_u], integral time [s] and derivative time [s]

    Notes
    -----
    Valid: K_u without dry friction, which inflates it.

    With these PI and PID gains, a step response typically overshoots by about half the step.

    References
    ----------
    [ZieglerNichols1942] ultimate sensitivity; [MECE5005] closed loop control system tuning

    Examples
    --------
    >>> gains = ziegler_nichols(law="pid", ultimate_gain=400.0, ultimate_period=0.008)
    >>> print(f"{gains.proportional_gain:.0f} V/m, {gains.integral_time:.3f} s, "
    ...       f"{gains.derivative_time:.3f} s")
    240 V/m, 0.004 s, 0.001 s
    """
    if law not in _ZIEGLER_NICHOLS:
        raise ValueError(f"law: {law}; choose one of {', '.join(_ZIEGLER_NICHOLS)}")
    proportional, integral, derivative = _ZIEGLER_NICHOLS[law]
    return ControllerGains(
        proportional * ultimate_gain,
        math.inf if integral is None else integral * ultimate_period,
        derivative * ultimate_period,
    )


def margin_rules(
    *,
    law: str,
    ultimate_gain: Array,
    velocity_gain: Array,
    gain_margin: Array = GAIN_MARGIN,
) -> ControllerGains:
    """Controller gains of a calm position loop: K = K_u/margin, and for PI T_i = 4/(K K_v).

    That integral time damps the slow pair of poles, s^2 + K K_v s + K K_v/T_i, critically; after
    a step, the position still overshoots by e^-2 because of the controller's zero. There is no PID:
    behind a lightly damped oil spring a derivative part reduces the gain margin without any
    benefit.

    Parameters
    ----------
    law : "p" or "pi" [-]
    ultimate_gain : K_u of the position loop [V/m]
    velocity_gain : K_v, steady speed per signal [m/s/V], > 0
    gain_margin : K_u/K [-], > 1

    Returns
    -------
    gain [V/m], integral time [s], derivative time 0 [s]; NaN where a divisor is not positive

    Notes
    -----
    Valid: loops that integrate once, K K_v well below the oil's frequency.

    References
    ----------
    [Skogestad2003] integral time of an integrating plant; [derived] damping ratio 1 of the pair

    Examples
    --------
    >>> gains = margin_rules(law="pi", ultimate_gain=420.0, velocity_gain=0.13)
    >>> print(f"{gains.proportional_gain:.0f} V/m, {gains.integral_time:.3f} s")
    140 V/m, 0.220 s
    """
    if law not in ("p", "pi"):
        raise ValueError(
            f"law: {law}; the margin rules support p or pi only; for pid use ziegler_nichols"
        )
    gain = ultimate_gain / positive(gain_margin)
    integral = math.inf if law == "p" else 4 / (gain * positive(velocity_gain))
    return ControllerGains(gain, integral, 0.0)
