"""Failure criteria by name with a common interface; Tsai-Wu in 3-D; yield of pre-stressed metal.

A criterion takes two stresses in material axes: that of the load, and the residual stress (from
cure, cool-down or yielding), which does not grow with the load. It gives the utilisation 1/SR of
every failure mode by name. The strength ratio SR is the factor on the load at which the stress
residual + SR stress first meets the failure surface of that mode; it is exact, in closed form. A
utilisation is

- never negative, at most 1 where the ply carries the present load, and 0 where the ply never fails
  in this mode;
- proportional to the load if there is no residual stress, and finite at zero stress;
- infinite (SR = 0) where the residual stress alone fails the ply.

The largest utilisation of the modes is that of the ply; `strength_modes.load_multiplier` gives SR.
Branches are chosen by the real parts of numbers, so that complex-step
derivatives are those of the branch that applies.

The criteria use the same few strengths, yet their results for one tube differ by 20-25 %: a
first-ply pressure means little without the name of its criterion. No uniaxial test gives Tsai-Wu's
F_12* = F_12/sqrt(F_11 F_22); its default of -0.5 gives Tsai-Wu the form of von Mises where the
strengths are equal. Hashin and Puck assume plane stress and ignore sigma_3. Maximum strain includes
sigma_3 through Poisson's ratios but sets no limit on the radial strain; only maximum stress and
Tsai-Wu limit sigma_3. A constant of one criterion (F_12*, Hashin's shear share, Puck's
inclinations) is a keyword of its function: bind it with `functools.partial` for another value.

Metal yields by von Mises; its strength ratio along the load path is exact.
"""

from __future__ import annotations

from math import inf
from typing import Protocol

from ..base.dataclass import dataclass
from ..base.kinds import kinds
from ..base.numeric import Array, namespace, real, where
from .strength_modes import (
    PlyRatios,
    PlyStrength,
    Stress,
    hashin_modes,
    max_strain_modes,
    max_stress_modes,
    puck_modes,
)


def _largest_root(square: Array, half: Array, left: Array | None) -> Array:
    """1/SR, where SR is the least positive root of square SR^2 + 2 half SR = left.

    The result is 0 if there is no positive root. A `left` of None means 1.
    """
    inside = half * half + (square if left is None else square * left)
    never = real(inside) < 0
    total = half + namespace(inside).sqrt(where(never, 0.0, inside))
    safe = where(never | (real(total) < 0), 0.0, total)
    if left is None:
        return safe
    broken = real(left) <= 0
    return where(broken, inf, safe / where(broken, 1.0, left))


def _inner(first: Stress, second: Stress) -> Array:
    """Sum of the products of corresponding components of two stresses."""
    (a_1, a_2, a_3, a_12), (b_1, b_2, b_3, b_12) = first, second
    return a_1 * b_1 + a_2 * b_2 + a_3 * b_3 + a_12 * b_12


def tsai_wu_modes(
    *,
    stress: Stress,
    strength: PlyStrength,
    residual: Stress | None = None,
    elastic: PlyRatios | None = None,
    interaction: Array = -0.5,
) -> dict[str, Array]:
    """Utilisation by the Tsai-Wu criterion in 3-D, whose only mode is named "interaction".

    F_i sigma_i + F_ij sigma_i sigma_j = 1 for sigma = residual + SR stress, a quadratic in SR, with
    F_1 = 1/X_t - 1/X_c, F_2 = F_3 = 1/Y_t - 1/Y_c, F_11 = 1/(X_t X_c), F_22 = F_33 = 1/(Y_t Y_c),
    F_66 = 1/S^2, F_12 = F_13 = F_12* sqrt(F_11 F_22), and F_23 = -F_22/2, or F_22 - 1/(2 S_23^2)
    where S_23 is known. Without residual stress the quadratic is a SR^2 + b SR = 1, and
    1/SR = (b + sqrt(b^2 + 4 a))/2.

    Parameters
    ----------
    stress : sigma_1, sigma_2, sigma_3, tau_12 of the load [Pa]
    strength : ply strengths
    residual : stress that does not grow with the load [Pa], or None
    elastic : not used [-]
    interaction : F_12* [-]

    Returns
    -------
    utilisation [-]; 0 where the ply never fails, infinite where the residual stress alone fails it

    Notes
    -----
    Valid: |F_12*| < 1, with a radial stress |F_12*| <= 1/2.

    With F_12* = -1/2 and the default F_23, the failure surface is open in the direction of stresses
    in the ratio X : Y : Y (mean strengths), as that of von Mises is open along hydrostatic stress.

    References
    ----------
    [TsaiWu1971]; F_23 [derived] from isotropy in the 2-3 plane

    Examples
    --------
    >>> p = PlyStrength(1900.0, 1300.0, 55.0, 190.0, 85.0)
    >>> modes = tsai_wu_modes(stress=(400.0, 30.0, 0.0, 40.0), strength=p)
    >>> print(f"{1 / modes['interaction']:.6f}")
    1.408903
    """
    s = strength
    root = namespace(s.tension_1, s.tension_2).sqrt
    area_2 = s.tension_2 * s.compression_2
    mean_1, mean_2 = root(s.tension_1 * s.compression_1), root(area_2)
    skew_1 = (s.compression_1 - s.tension_1) / (2 * mean_1)
    skew_2 = (s.compression_2 - s.tension_2) / (2 * mean_2)
    plane = -0.5 if s.shear_23 is None else 1 - area_2 / (2 * s.shear_23 * s.shear_23)

    def scaled(values: Stress) -> Stress:
        """Stresses divided by mean (geometric) strengths, so F_11 = F_22 = F_33 = F_66 = 1."""
        return values[0] / mean_1, values[1] / mean_2, values[2] / mean_2, values[3] / s.shear_12

    along, across, radial, slip = load = scaled(stress)
    both, joined = across + radial, interaction * along
    slope = (
        along + interaction * both,
        across + joined + plane * radial,
        radial + joined + plane * across,
        slip,
    )
    half = skew_1 * along + skew_2 * both
    left = None
    if residual is not None:
        held = scaled(residual)
        held_both = held[1] + held[2]
        half = half + _inner(held, slope)
        joint = 2 * interaction * held[0] * held_both + 2 * plane * held[1] * held[2]
        linear = 2 * (skew_1 * held[0] + skew_2 * held_both)
        left = 1 - _inner(held, held) - joint - linear
    return {"interaction": _largest_root(_inner(load, slope), half, left)}


_LEAST = 1e-9
"""Lower limit of the term 1 - <r, r> in `yield_utilisation`. It keeps the result finite if the
residual stress r alone yields the metal."""


def mises_product(*, first: Stress, second: Stress) -> Array:
    """Bilinear form whose value for first = second is von Mises' equivalent stress squared.

    ((a1 - a2)(b1 - b2) + (a2 - a3)(b2 - b3) + (a3 - a1)(b3 - b1))/2 + 3 a12 b12.

    Parameters
    ----------
    first, second : stresses 1, 2, 3 and 12 [Pa]

    Returns
    -------
    product [Pa^2]

    Notes
    -----
    Valid: isotropic metals.

    References
    ----------
    [Shigley2011] distortion energy; [derived] polarised quadratic form

    Examples
    --------
    >>> pull = (300.0, 0.0, 0.0, 0.0)
    >>> mises_product(first=pull, second=pull) ** 0.5
    300.0
    """
    a1, a2, a3, a12 = first
    b1, b2, b3, b12 = second
    normal = (a1 - a2) * (b1 - b2) + (a2 - a3) * (b2 - b3) + (a3 - a1) * (b3 - b1)
    return normal / 2 + 3 * a12 * b12


def yield_utilisation(
    *, stress: Stress, yield_strength: Array, residual: Stress | None = None
) -> Array:
    """Utilisation 1/SR of a metal: residual stress plus SR times the load's stress just yield it.

    u = (<s, r> + sqrt(<s, r>^2 + (1 - <r, r>) <s, s>))/(1 - <r, r>), where s is the load's stress,
    r the residual stress and <a, b> = `mises_product`(a, b) / yield^2.

    Parameters
    ----------
    stress : stresses 1, 2, 3 and 12 of the load [Pa]
    yield_strength : yield strength [Pa]
    residual : stresses that do not grow with the load [Pa]

    Returns
    -------
    utilisation [-]; very large where the residual stress alone reaches yield

    Notes
    -----
    Valid: isotropic metals, elastic until yield.

    References
    ----------
    [Shigley2011] distortion energy; [derived] root of the quadratic in SR

    Examples
    --------
    >>> pull, press = (200.0, 0.0, 0.0, 0.0), (-100.0, 0.0, 0.0, 0.0)
    >>> print(f"{yield_utilisation(stress=pull, yield_strength=400.0, residual=press):.3f}")
    0.400
    """
    scale = 1 / (yield_strength * yield_strength)
    square = mises_product(first=stress, second=stress) * scale
    xp = namespace(square)
    if residual is None:
        return xp.sqrt(square)
    linear = mises_product(first=stress, second=residual) * scale
    left = 1 - mises_product(first=residual, second=residual) * scale
    left = where(real(left) > _LEAST, left, 0 * left + _LEAST)
    return (linear + xp.sqrt(linear * linear + left * square)) / left


class Modes(Protocol):
    """Signature of a failure criterion: from stresses to the utilisation of every failure mode."""

    def __call__(
        self,
        *,
        stress: Stress,
        strength: PlyStrength,
        residual: Stress | None = None,
        elastic: PlyRatios | None = None,
    ) -> dict[str, Array]:
        """Utilisation 1/SR of every mode; `Criterion.by_strain` states if `elastic` is required."""
        ...


@dataclass(frozen=True, slots=True)
class Criterion:
    """A failure criterion of plies.

    Attributes
    ----------
    name, help : its key word in a design file, and the explanation of that word
    words : its name in a report
    modes : function for the utilisation of every failure mode [-]
    by_strain : whether `modes` needs the ratios of the ply's elastic constants
    """

    name: str
    help: str
    words: str
    modes: Modes
    by_strain: bool


CRITERIA = kinds(
    "criterion",
    Criterion(
        "max_stress",
        "a single stress reaches its strength",
        "maximum stress",
        max_stress_modes,
        by_strain=False,
    ),
    Criterion(
        "max_strain",
        "a single strain reaches its limit",
        "maximum strain",
        max_strain_modes,
        by_strain=True,
    ),
    Criterion(
        "tsai_wu",
        "all stresses together, in one formula",
        "Tsai-Wu",
        tsai_wu_modes,
        by_strain=False,
    ),
    Criterion(
        "hashin",
        "fibre or matrix, each by its own formula",
        "Hashin",
        hashin_modes,
        by_strain=False,
    ),
    Criterion(
        "puck",
        "fibre, or matrix pulled open (mode A), sheared (B) or crushed at a slant (C)",
        "Puck",
        puck_modes,
        by_strain=False,
    ),
)
"""The failure criteria that a design may choose, by name."""
