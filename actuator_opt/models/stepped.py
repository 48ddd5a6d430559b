"""Buckling of a column of two segments, for every end fixity; inputs may be arrays.

With phi and psi the solutions of w'' = -(P/EI) w that start with unit value and unit slope, the
buckling loads are the zeros of the expressions below. They follow from
w = free + M_0 (1 - phi)/P + Q (x - psi)/P, where `free` is due to motion of the first end.

    pinned-pinned  psi            fixed-free    phi           pinned-guided  psi'
    fixed-pinned   psi - L phi    fixed-guided  phi'          fixed-fixed    2 - phi - psi' + L phi'

From here on, x is sqrt(P). In this x, each expression is a sum of two sine or cosine waves, plus x
times two more waves. As functions of P they are entire, of order 1/2, with real positive zeros
only. For such functions Ostrowski's square-root iteration from below converges monotonically and
cubically to the first zero, without bracket, scan or branch. A complex Newton step at the end makes
every derivative exact.
"""

from __future__ import annotations

from math import pi
from typing import Any, Literal, TypeAlias

from ..base.dataclass import dataclass
from ..base.numeric import Array, geometry, maximum, minimum, namespace, positive, real, sqrt, where

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
"""For each pair of ends: P L^2/(pi^2 EI) of the uniform column, and the number of iteration steps
that suffices up to a stiffness ratio of 1000 between the segments."""


@dataclass(frozen=True, slots=True)
class _Form:
    """Buckling condition f(x) = constant + G(x) + x H(x) = 0 with x = sqrt(P).

    G = g_1 T(s x) + g_2 T(d x), where T is sin if `sine`, else cos. H has the other function. The
    pairs are `frequencies` (s, d) and the weights of G (`outer`) and of H (`inner`). For small x, f
    grows like x^order.
    """

    sine: bool
    order: int
    constant: float
    frequencies: Pair
    outer: Pair
    inner: Pair | None


def _form(ends: tuple[str, str], flex: Pair, length: Pair) -> _Form:
    """Buckling condition for these ends; `flex` is 1/sqrt(EI) of each segment."""
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
    """Weighted sum of two waves (sines or cosines)."""
    return weights[0] * waves[0] + weights[1] * waves[1]


def _times(first: Pair, second: Pair) -> Pair:
    """Element-wise product of two pairs."""
    return first[0] * second[0], first[1] * second[1]


@dataclass(frozen=True, slots=True)
class _Waves:
    """A buckling condition and its derivatives.

    `outer` are the weights of G, G' and G'', `inner` those of H, H' and H''; `_Form` defines G and
    H.
    """

    form: _Form
    outer: tuple[Pair, Pair, Pair]
    inner: tuple[Pair, Pair, Pair] | None

    @classmethod
    def of(cls, form: _Form) -> _Waves:
        """Weights of a `_Form` and of its derivatives, by the rules (sin)' = cos, (cos)' = -sin."""
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
        """Evaluate f and f', and f'' if `curved`."""
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


def _ordered(ends: Ends, *pairs: Pair) -> tuple[tuple[str, str], list[Pair]]:
    """Swap ends and segment properties if only the swapped ends are in `_UNIFORM`."""
    key = (str(ends[0]), str(ends[1]))
    if key in _MIRRORED:
        return key[::-1], [(second, first) for first, second in pairs]
    if key not in _UNIFORM:
        message = f"a column with the ends {ends[0]}-{ends[1]} is a mechanism, or a name is unknown"
        raise ValueError(message)
    return key, list(pairs)


def _lower_bound(ends: tuple[str, str], stiffness: Pair, length: Pair) -> Array:
    """Lower bound on the critical load of a column of these segments.

    The bound is the larger of two loads. The first is that of a uniform column with the weaker
    stiffness. The second is Dunkerley's combination of the loads of two columns that each have only
    one flexible segment; Wirtinger's inequality bounds these loads.
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
    """First zero of a buckling condition, by steps P + f/sqrt(f'^2 - f f'') up from a lower bound.

    `load` is the lower bound. The derivatives by P are computed from those by x = sqrt(P).
    """
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


@geometry
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
    Valid: elastic, straight, centrally loaded; exact for stiffness ratios up to about 1000.

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
    bending = (positive(bending_stiffness_1), positive(bending_stiffness_2))
    key, (stiffness, length) = _ordered(ends, bending, (length_1, length_2))
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


Wave: TypeAlias = tuple[Array, Array, Array]
"""cos(k L), sin(k L)/k and k sin(k L) of a segment."""


def _start(key: tuple[str, str], total: Array, near: Wave, far: Wave) -> Pair:
    """Moment and its slope at the first end of the buckled column, up to a common factor.

    A pin or a free end has M = 0; a fixed or guided end has w' = 0, so M' = Q: (M_L - M_0)/L if
    both ends are held sideways, 0 if an end can sway.
    """
    if key[0] == "pinned":
        return 0.0, 1.0
    if key == ("fixed", "pinned"):
        return total, -1.0
    if key == ("fixed", "fixed"):  # M_L = keep M_0 + rise M'_0 = M_0 + L M'_0
        keep = near[0] * far[0] - near[2] * far[1]
        rise = near[1] * far[0] + near[0] * far[1]
        return total - rise, keep - 1
    return 1.0, 0.0


@geometry
def mode_shear_stiffness(
    *,
    critical_load: Array,
    bending_stiffness_1: Array,
    length_1: Array,
    shear_stiffness_1: Array,
    bending_stiffness_2: Array,
    length_2: Array,
    shear_stiffness_2: Array,
    ends: Ends = ("pinned", "pinned"),
) -> Array:
    """Shear stiffness of a stepped column in its buckling mode, for `column.engesser_load`.

    1/S = (a_1/S_1 + a_2/S_2)/e: a_i = int (M'/P)^2 over segment i, e = int w'^2 over both, with the
    moment M and the deflection w of the buckling mode in bending. M'' = -k_i^2 M, so the a_i have
    closed forms. For a statically determinate column S_1 = S_2 gives S = S_1.

    Parameters
    ----------
    critical_load : of the same column by bending alone, `stepped_column_load` [N]
    bending_stiffness_1, bending_stiffness_2 : EI of both segments [N m^2]
    length_1, length_2 : their lengths [m]
    shear_stiffness_1, shear_stiffness_2 : kappa G A of both segments, may be infinite [N]
    ends : fixity of the outer end of segment 1 and of segment 2

    Returns
    -------
    kappa G A of the whole column [N]

    Raises
    ------
    ValueError
        Where the ends leave a mechanism.

    Notes
    -----
    Valid: EI ratio to 100; the load is within 0.5 % up to P/S_i = 0.1, within 4 % up to 0.3.

    For fixed-pinned columns these errors are 2 % and 11 %, for fixed-fixed columns 2 % and 16 %.
    For all other ends the load is an upper bound on the exact one, and Engesser's load with the
    smaller S_i is a lower bound.

    References
    ----------
    [TimoshenkoGere1961] effect of shearing force; [derived] stationary energy quotient
    1/P = int (M^2/EI + M'^2/S)/(P^2 int w'^2), taken at the mode without shear

    Examples
    --------
    >>> s = mode_shear_stiffness(critical_load=128.933e3, bending_stiffness_1=5000.0,
    ...     length_1=0.20, shear_stiffness_1=4e6, bending_stiffness_2=1200.0, length_2=0.18,
    ...     shear_stiffness_2=1e6)
    >>> print(f"{s / 1e6:.4f} MN")
    1.3756 MN
    """
    key, (stiffness, length, shear) = _ordered(
        ends,
        (bending_stiffness_1, bending_stiffness_2),
        (length_1, length_2),
        (shear_stiffness_1, shear_stiffness_2),
    )
    square = (critical_load / stiffness[0], critical_load / stiffness[1])
    waves = []
    for part, long in zip(square, length, strict=True):
        k = sqrt(part)
        angle = k * long
        xp = namespace(angle)
        sine = xp.sin(angle)
        waves.append((xp.cos(angle), sine / k, sine * k))
    near, far = waves
    total = length[0] + length[1]
    moment, slope = _start(key, total, near, far)
    middle, turn = moment * near[0] + slope * near[1], slope * near[0] - moment * near[2]
    first = (slope * slope + square[0] * moment * moment) * length[0] + middle * turn
    second = (turn * turn + square[1] * middle * middle) * length[1] - middle * turn
    spare: Array = 0.0
    if key[0] == "fixed" and key[1] in ("pinned", "fixed"):  # held sideways: M' = P w' + Q
        last, tip = middle * far[0] + turn * far[1], turn * far[0] - middle * far[2]
        first, second = first - moment * slope, second + last * tip
        spare = 2 * slope * (slope * total - 2 * (last - moment))
    return (first + second + spare) / (first / shear[0] + second / shear[1])
