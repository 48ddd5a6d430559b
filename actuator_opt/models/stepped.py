"""Buckling of a column of two segments, elementwise, for every end fixity.

With phi and psi the solutions of w'' = -(P/EI) w that start with unit value and unit slope, the
buckling loads are the zeros of (all derived from w = free + M_0 (1 - phi)/P + Q (x - psi)/P):

    pinned-pinned  psi            fixed-free    phi           pinned-guided  psi'
    fixed-pinned   psi - L phi    fixed-guided  phi'          fixed-fixed    2 - phi - psi' + L phi'

In x = sqrt(P) each is a sum of two sine or cosine waves of x, plus x times two more. As functions
of P they are entire, of order 1/2, with real positive zeros only; for those Ostrowski's
square-root iteration from below rises monotonically and cubically to the first zero: no bracket,
no scan, no branch. One complex Newton step at the end makes every derivative exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any, Literal, TypeAlias

from ..numeric import Array, maximum, minimum, namespace, positive, real, sqrt, where

End: TypeAlias = Literal["pinned", "fixed", "free", "guided"]
"""pinned: w = M = 0; fixed: w = slope = 0; free: M = Q = 0; guided: slope = Q = 0."""

Ends: TypeAlias = tuple[End, End]
"""Fixity of the first and of the last end."""

Pair: TypeAlias = tuple[Array, Array]

_MIRRORED = {
    ("pinned", "fixed"),
    ("free", "fixed"),
    ("guided", "fixed"),
    ("guided", "pinned"),
}
_UNIFORM = {
    ("pinned", "pinned"): (1.0, 3),
    ("fixed", "free"): (0.25, 3),
    ("pinned", "guided"): (0.25, 3),
    ("fixed", "guided"): (1.0, 3),
    ("fixed", "pinned"): (2.045748, 5),
    ("fixed", "fixed"): (4.0, 5),
}
"""P L^2/(pi^2 EI) of the uniform column, and the steps that a stiffness ratio of 1000 needs."""


@dataclass(frozen=True, slots=True)
class _Form:
    """f(x) = constant + G(x) + x H(x), x = sqrt(P), growing from zero like x^order.

    G = g_1 T(s x) + g_2 T(d x) with T = sin (`sine`) or cos; H the same with the other function.
    """

    sine: bool
    order: int
    constant: float
    frequencies: Pair
    outer: Pair
    inner: Pair | None


def _form(ends: tuple[str, str], flex: Pair, length: Pair) -> _Form:
    """Weights and frequencies for flex = 1/sqrt(EI) of both segments."""
    b1, b2 = flex
    a1, a2 = b1 * length[0], b2 * length[1]
    frequencies = (a1 + a2, a1 - a2)
    if ends == ("pinned", "guided"):
        down = b2 / b1
        return _Form(False, 0, 0.0, frequencies, ((1 + down) / 2, (1 - down) / 2), None)
    if ends == ("fixed", "guided"):
        return _Form(True, 1, 0.0, frequencies, ((b1 + b2) / 2, (b1 - b2) / 2), None)
    if ends == ("fixed", "fixed"):
        total = length[0] + length[1]
        swing = (b1 / b2 + b2 / b1) / 2
        outer = (-1 - swing, swing - 1)
        return _Form(
            False, 4, 2.0, frequencies, outer, (-total * (b1 + b2) / 2, -total * (b1 - b2) / 2)
        )
    up = b1 / b2
    turn = ((1 + up) / 2, (1 - up) / 2)
    if ends == ("fixed", "free"):
        return _Form(False, 0, 0.0, frequencies, turn, None)
    c1, c2 = 1 / b1, 1 / b2
    sway = ((c1 + c2) / 2, (c1 - c2) / 2)
    if ends == ("pinned", "pinned"):
        return _Form(True, 1, 0.0, frequencies, sway, None)
    total = -(length[0] + length[1])
    return _Form(True, 3, 0.0, frequencies, sway, (total * turn[0], total * turn[1]))


def _pair(weights: Pair, waves: Pair) -> Array:
    """g_1 T(s x) + g_2 T(d x)."""
    return weights[0] * waves[0] + weights[1] * waves[1]


def _times(first: Pair, second: Pair) -> Pair:
    """Both products."""
    return first[0] * second[0], first[1] * second[1]


@dataclass(frozen=True, slots=True)
class _Waves:
    """The form with the weights of its derivatives: G, G', G'', H, H', H''."""

    form: _Form
    outer: tuple[Pair, Pair, Pair]
    inner: tuple[Pair, Pair, Pair] | None

    @classmethod
    def of(cls, form: _Form) -> _Waves:
        """Derive the weights: d sin = cos, d cos = -sin."""
        sign = 1 if form.sine else -1
        squares = _times(form.frequencies, form.frequencies)
        fall = (-squares[0], -squares[1])
        steep = (sign * form.frequencies[0], sign * form.frequencies[1])
        outer = (form.outer, _times(form.outer, steep), _times(form.outer, fall))
        if form.inner is None:
            return cls(form, outer, None)
        shallow = (-steep[0], -steep[1])
        inner = (form.inner, _times(form.inner, shallow), _times(form.inner, fall))
        return cls(form, outer, inner)

    def at(self, xp: Any, x: Array, *, curved: bool) -> tuple[Array, ...]:
        """Evaluate f and f', and f'' where asked."""
        s, d = self.form.frequencies
        u, v = s * x, d * x
        wave, other = (xp.sin(u), xp.sin(v)), (xp.cos(u), xp.cos(v))
        if not self.form.sine:
            wave, other = other, wave
        value = _pair(self.outer[0], wave) + self.form.constant
        slope = _pair(self.outer[1], other)
        curve = _pair(self.outer[2], wave) if curved else 0.0
        if self.inner is not None:
            arm, tilt = _pair(self.inner[0], other), _pair(self.inner[1], wave)
            value, slope = value + x * arm, slope + arm + x * tilt
            if curved:
                curve = curve + 2 * tilt + x * _pair(self.inner[2], other)
        return (value, slope, curve) if curved else (value, slope)


def _lower_bound(ends: tuple[str, str], stiffness: Pair, length: Pair) -> Array:
    """Load no column of these segments buckles below.

    The larger of the uniform column of the weaker segment and Dunkerley's sum of the loads of the
    columns with one flexible segment each, those bounded by Wirtinger's inequality.
    """
    total = length[0] + length[1]
    weaker = minimum(*stiffness)
    uniform = _UNIFORM[ends][0] * pi * pi * weaker / (total * total)
    if ends == ("fixed", "guided"):
        return uniform
    reach = {("fixed", "free"): (total, length[1]), ("pinned", "guided"): (length[0], total)}
    far = reach.get(ends, length)
    softness = far[0] * far[0] / stiffness[0] + far[1] * far[1] / stiffness[1]
    return maximum(uniform, pi * pi / 4 / softness)


def _first_zero(xp: Any, waves: _Waves, load: Array, steps: int) -> Array:
    """Rise from a lower bound to the first zero: P + f/sqrt(f'^2 - f f'') in P, from f in x."""
    order = waves.form.order
    for _ in range(steps):
        x = xp.sqrt(load)
        value, slope, curve = waves.at(xp, x, curved=True)
        start = value / x
        newton = order * start - slope
        newton = newton * newton
        square = slope * slope - value * curve + start * slope - 2 * order * start * start
        square = where(square > 0.05 * newton, square, newton)
        load = load + 2 * x * value / xp.sqrt(square)
    return load


def stepped_column_load(
    *,
    bending_stiffness_1: Array,
    length_1: Array,
    bending_stiffness_2: Array,
    length_2: Array,
    ends: Ends = ("pinned", "pinned"),
) -> Array:
    """Critical load of a column of two segments: barrel and rod of an extended cylinder.

    Pinned-pinned: tan(k1 L1)/k1 + tan(k2 L2)/k2 = 0, k = sqrt(P/EI), in its pole-free form.

    Parameters
    ----------
    bending_stiffness_1, bending_stiffness_2 : EI of both segments [N m^2]
    length_1, length_2 : their lengths [m]
    ends : fixity of the outer end of segment 1 and of segment 2

    Returns
    -------
    first critical load [N]; NaN where a stiffness or the whole length is not positive

    Raises
    ------
    ValueError
        Where the ends leave a mechanism.

    Notes
    -----
    Valid: elastic, straight, centrally loaded; stiffness ratios up to about 1000 to rounding.

    References
    ----------
    [TimoshenkoGere1961] bars with varying cross-section; [Ostrowski1973] square-root iteration;
    [derived] pole-free conditions, in the module's text

    Examples
    --------
    >>> p = stepped_column_load(bending_stiffness_1=5000.0, length_1=0.20,
    ...                         bending_stiffness_2=1200.0, length_2=0.18)
    >>> print(f"{p / 1e3:.3f} kN")
    128.933 kN
    """
    stiffness = (positive(bending_stiffness_1), positive(bending_stiffness_2))
    length = (length_1, length_2)
    key = (str(ends[0]), str(ends[1]))
    if key in _MIRRORED:
        key, stiffness, length = key[::-1], stiffness[::-1], length[::-1]
    if key not in _UNIFORM:
        message = f"ends {ends[0]}-{ends[1]} leave a mechanism or are unknown"
        raise ValueError(message)
    flex = (1 / sqrt(stiffness[0]), 1 / sqrt(stiffness[1]))
    exact = _form(key, flex, length)
    flat = (real(length[0]), real(length[1]))
    plain = _form(key, (real(flex[0]), real(flex[1])), flat)
    xp = namespace(exact.frequencies[0])
    start = positive(_lower_bound(key, (real(stiffness[0]), real(stiffness[1])), flat))
    load = _first_zero(xp, _Waves.of(plain), start, _UNIFORM[key][1])
    x = xp.sqrt(load)
    value, slope = _Waves.of(exact).at(xp, x, curved=False)
    x = x - value / slope
    return x * x
