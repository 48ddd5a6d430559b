"""Elastomers: modulus from hardness (`MODULUS_LAWS`), its bounds, its change with temperature.

Hardness is a poor measure of the modulus: the two laws differ by a factor of 1.8 at 70 Shore A, and
a batch scatters by 5 Shore A. An uncertainty study should include both.
"""

from __future__ import annotations

import math
from typing import Protocol

from ..base.dataclass import dataclass
from ..base.kinds import kinds
from ..base.numeric import Array, maximum, minimum, namespace, real, where

WLF_SLOPE, WLF_SPAN = 17.44, 51.6
"""Universal constants of the time-temperature shift above the glass transition [Ferry1980]: the
first in decades, the second in kelvin."""
GLASS_OFFSET = 5.0
"""Stiffening temperature minus glass transition temperature [K] (*choice*: a few kelvin)."""
ROUSE_EXPONENT = 0.5
"""Exponent of the modulus in the transition zone, G ~ t^-1/2 with shifted time t (Rouse)
[Ferry1980]."""


def modulus_gent(*, hardness: Array) -> Array:
    """Young's modulus of rubber from its hardness S by Gent's formula.

    E = 0.0981 (56 + 7.62336 S)/[0.137505 (254 - 2.54 S)] MPa.

    Parameters
    ----------
    hardness : [Shore A]

    Returns
    -------
    Young's modulus [Pa]; NaN at hardness >= 100

    Notes
    -----
    Valid: 20 to 90 Shore A.

    Ruess's formula gives 1.8 times as much at 70 Shore A: treat the difference as an uncertainty.

    References
    ----------
    [Gent1958] Shore A indentation

    Examples
    --------
    >>> print(f"{modulus_gent(hardness=75.0) / 1e6:.4f} MPa")
    7.0529 MPa
    """
    valid = real(hardness) < 100
    safe = where(valid, hardness, 0.0)
    modulus = 1e6 * 0.0981 * (56 + 7.62336 * safe) / (0.137505 * (254 - 2.54 * safe))
    return where(valid, modulus, math.nan)


def modulus_ruess(*, hardness: Array) -> Array:
    """Young's modulus of rubber from its hardness S by Ruess, log10 E = 0.0235 S - 0.6403 (MPa).

    Parameters
    ----------
    hardness : [Shore A]

    Returns
    -------
    Young's modulus [Pa]

    Notes
    -----
    Valid: 20 to 80 Shore A.

    References
    ----------
    [Larson2016] Ruess's relation

    Examples
    --------
    >>> print(f"{modulus_ruess(hardness=75.0) / 1e6:.4f} MPa")
    13.2495 MPa
    """
    exponent = math.log(10) * (0.0235 * hardness - 0.6403)
    return 1e6 * namespace(hardness).exp(exponent)


class ModulusFunction(Protocol):
    """Function that gives Young's modulus (Pa) from Shore A hardness."""

    def __call__(self, *, hardness: Array) -> Array:
        """Young's modulus (Pa) at a hardness (Shore A)."""


@dataclass(frozen=True, slots=True)
class ModulusLaw:
    """A hardness-to-modulus law with help text, range of hardness (Shore A) and source."""

    name: str
    help: str
    modulus: ModulusFunction
    hardness_range: tuple[float, float]
    reference: str


MODULUS_LAWS = kinds(
    "hardness law",
    ModulusLaw("gent", "Gent's formula", modulus_gent, (20.0, 90.0), "[Gent1958]"),
    ModulusLaw(
        "ruess",
        "Ruess's formula, 1.8 times as stiff as Gent's at 70 Shore A",
        modulus_ruess,
        (20.0, 80.0),
        "[Larson2016]",
    ),
)
"""Hardness-to-modulus laws by name; ``gent`` is the default."""


def modulus_bounds(*, hardness: Array, hardness_scatter: Array) -> tuple[Array, Array]:
    """Lowest and highest modulus of the hardness laws over the scatter of the hardness.

    The result is the minimum and maximum of E(S - s) and E(S + s) by Gent and by Ruess.

    Parameters
    ----------
    hardness : S [Shore A]
    hardness_scatter : s, half the width of the scatter (within a batch: 5) [Shore A]

    Returns
    -------
    lower, upper Young's modulus [Pa]; upper is NaN where S + s >= 100 (Gent has no modulus there)

    Notes
    -----
    Valid: S - s and S + s from 20 to 80 Shore A; to 90 by Gent alone.

    References
    ----------
    [Gent1958], [Larson2016]; [derived] both laws grow with hardness

    Examples
    --------
    >>> low, high = modulus_bounds(hardness=70.0, hardness_scatter=5.0)
    >>> print(f"{low / 1e6:.2f} to {high / 1e6:.2f} MPa")
    4.43 to 13.25 MPa
    """
    soft, hard = hardness - hardness_scatter, hardness + hardness_scatter
    return (
        minimum(modulus_ruess(hardness=soft), modulus_gent(hardness=soft)),
        maximum(modulus_ruess(hardness=hard), modulus_gent(hardness=hard)),
    )


def _stiffening(temperature: Array, stiffening_temperature: Array) -> Array:
    """Modulus divided by its rubbery plateau.

    The ratio is 10 at the stiffening temperature and tends to 1 far above it.
    """
    glass = stiffening_temperature - GLASS_OFFSET
    above = maximum(temperature - glass, 0.0)
    decades = WLF_SLOPE * (GLASS_OFFSET / (WLF_SPAN + GLASS_OFFSET) - above / (WLF_SPAN + above))
    exponent = math.log(10) * ROUSE_EXPONENT * decades
    return 1 + 9 * namespace(exponent).exp(exponent)


def temperature_factor(
    *,
    temperature: Array,
    reference_temperature: Array,
    softening: Array,
    stiffening_temperature: Array,
) -> Array:
    """Modulus divided by its value at the reference temperature, E(T)/E(T_ref).

    The factor is e^(-b (T - T_ref)) s(T)/s(T_ref). The exponential is the measured softening with
    heat, and s is the stiffening towards the glass transition: s = 1 + 9 (a_T/a_T10)^(1/2), with
    the shift factor a_T, log10 a_T = -17.44 (T - T_g)/(51.6 + T - T_g), T_g = T_10 - 5 K. a_T10 is
    the value of a_T at T_10. Below T_g, a_T keeps its value at T_g.

    Parameters
    ----------
    temperature : [K]
    reference_temperature : at which hardness or modulus was measured [K]
    softening : b, relative fall per kelvin [1/K]; an unfilled ideal rubber stiffens, b = -1/T_ref
    stiffening_temperature : T_10, where the modulus is ten times its plateau (torsion test); TR10
        of a data sheet lies within a few kelvin [K]

    Returns
    -------
    factor [-]

    Notes
    -----
    Valid: from T_10 to the compound's upper limit, without ageing or swelling.

    The formula reproduces the rise of a polyurethane's modulus from 70 to -30 degC within 20 %
    [Texin250].

    For filled PTFE, use b = 0.0106 1/K from 20 to 100 degC [FilledPTFE], and a stiffening
    temperature far below the range, so that only e^(-b (T - T_ref)) remains.

    References
    ----------
    [Ferry1980] universal shift, square root of time in the transition zone; [derived] both scaled
    to the modulus ratio 10 that names T_10

    Examples
    --------
    >>> arguments = {"reference_temperature": 296.15, "softening": 0.002,
    ...              "stiffening_temperature": 248.15}
    >>> print(", ".join(f"{temperature_factor(temperature=t, **arguments):.3f}"
    ...                 for t in (248.15, 273.15, 296.15, 373.15)))
    10.985, 1.079, 1.000, 0.856
    """
    change = softening * (reference_temperature - temperature)
    cold = _stiffening(temperature, stiffening_temperature)
    return (
        namespace(change).exp(change)
        * cold
        / _stiffening(reference_temperature, stiffening_temperature)
    )
