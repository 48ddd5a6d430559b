"""Linear model of the held actuator: load, piston, coupled chambers, lines and their ends.

Every response is a ratio of polynomials in s whose coefficients are differentiable functions of the
design's numbers; `loop` finds modes, margins and bandwidth from their roots.
"""

from __future__ import annotations

from math import pi
from typing import NamedTuple

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..base.polynomial import Parts, Polynomial, add, at_frequency, multiply, scale
from .line_ends import CLOSED, LineEnd


@dataclass(frozen=True, slots=True)
class Side:
    """One chamber with its line: compliance at the piston, the line, and the line's far end."""

    area: Array
    """Piston area [m^2]."""
    compliance: Array
    """Compliance of the chamber and the near half of the line [m^3/Pa]."""
    throttle: Array | None = None
    """Conductance of a throttle in the line, 0 when closed [m^3/s/Pa]; None: no throttle."""
    resistance: Array = 0.0
    """Resistance of the line [Pa s/m^3]."""
    inertance: Array = 0.0
    """Inertance of the line [kg/m^4]."""
    far_compliance: Array = 0.0
    """Compliance of the line's far half [m^3/Pa]."""
    end: LineEnd = CLOSED
    flow_gain: Array = 0.0
    """Flow of the valve into the line's far end per unit of spool signal [m^3/s/V]; negative for
    chamber B."""


@dataclass(frozen=True, slots=True)
class LinearActuator:
    """Polynomials N, M and T of the equation of motion N(s) x = M(s) F + T(s) o.

    x is the position of the load, F the force on the load and o the spool signal. N, M and T are
    `characteristic`, `mobile` and `drive`. x/F = M/N is the compliance under the force on the load,
    and x/o = T/N is the plant of the position loop.
    """

    characteristic: Polynomial
    mobile: Polynomial
    drive: Polynomial
    mass: Array
    """Mass of the load [kg]."""


class _Eliminated(NamedTuple):
    """Polynomials e, m, d of a chamber after its line's far end is eliminated.

    m p + e (A v + q) = d G o with the chamber's pressure p, the piston's speed v, the flow q that
    the other chamber's pressure causes, the flow gain G and the spool signal o.
    """

    e: Polynomial
    m: Polynomial
    d: Polynomial


def _eliminated(side: Side, leakage: Array) -> _Eliminated:
    """Eliminate the far end's pressure p_f and the line's flow q into the chamber.

    Far end: (C s + Y) p_f = G o - q, with the compliance C of the line's far half and the
    admittance Y beyond the line. Line: (R + 1/g + L s) q = p_f - p, with its resistance R and
    inertance L and the conductance g of the throttle.

    Everything is multiplied by the line end's denominator and by the throttle's conductance, so
    that a closed throttle (g = 0) causes no division by zero. With a closed end and no oil at the
    far end, nothing flows.
    """
    far = add(multiply((0.0, side.far_compliance), side.end.denominator), side.end.numerator)
    if not far:
        return _Eliminated((1.0,), (leakage, side.compliance), (1.0,))
    line, g = (side.resistance, side.inertance), side.throttle
    d = side.end.denominator
    if g is not None:
        line, d = add(scale(line, g), (1.0,)), scale(d, g)
    e = add(multiply(line, far), d)
    through = far if g is None else scale(far, g)
    return _Eliminated(e, add(multiply(e, (leakage, side.compliance)), through), d)


def linear_actuator(
    *,
    side_a: Side,
    side_b: Side,
    mass: Array,
    damping: Array,
    coupling: Array = 0.0,
    leakage: Array = 0.0,
    seal_stiffness: Array = 0.0,
    flexibility: Array = 0.0,
) -> LinearActuator:
    """Polynomials of the held actuator; rod and mount are a spring between piston and load.

    Chamber i, with the other chamber j: m_i p_i + e_i (c s - g) p_j = d_i G_i o - e_i a_i s x_p
    with a = (A_A, -A_B). The polynomials e_i and d_i describe the line of chamber i, and m_i is
    e_i (C_i s + g) plus a term for the flow into the line. Piston: F = a^T p - (B s + k_s) x_p.
    Load: m s^2 x = F + F_L with the external force F_L on the load in the direction of x, and
    x_p = x + f F. Elimination of p by Cramer's rule gives
    N x = M F_L + T o with N = m s^2 M + P, M = det + f P, P = (B s + k_s) det + s a^T adj(.) e a,
    with the determinant det and the adjugate adj(.) of the chambers' 2 x 2 matrix.

    Parameters
    ----------
    side_a, side_b : chambers with lines (`Side`)
    mass : m at the rod's end, rod and piston included [kg]
    damping : B, incremental friction damping at the piston [N s/m]
    coupling : c, volume change of one chamber per pressure in the other [m^3/Pa]
    leakage : g, across the piston per pressure difference [m^3/s/Pa]
    seal_stiffness : k_s of sticking seals [N/m]; 0 for sliding seals
    flexibility : f of rod, mount and load cell in series [m/N]

    Returns
    -------
    polynomials in s [rad/s], lowest power first

    Notes
    -----
    Valid: small motion about rest; lines shorter than a tenth of the wavelength.

    References
    ----------
    [derived] continuity of both chambers and lines, force balance; [AaltoThesis] eq. 11-16

    Examples
    --------
    >>> side = Side(area=5e-4, compliance=5e-14)
    >>> model = linear_actuator(side_a=side, side_b=side, mass=10.0, damping=100.0)
    >>> len(model.characteristic) - 1
    4
    """
    e_a, m_a, d_a = _eliminated(side_a, leakage)
    e_b, m_b, d_b = _eliminated(side_b, leakage)
    cross = add((0.0, coupling), scale((leakage,), -1.0))
    both = multiply(e_a, e_b)
    det = add(multiply(m_a, m_b), scale(multiply(both, cross, cross), -1.0))
    a, b = side_a.area, side_b.area
    pull = add(
        scale(multiply(e_a, m_b), a * a),
        scale(multiply(e_b, m_a), b * b),
        scale(multiply(both, cross), 2 * a * b),
    )
    drive = add(
        multiply(d_a, (side_a.flow_gain,), add(scale(m_b, a), scale(multiply(e_b, cross), b))),
        scale(
            multiply(d_b, (side_b.flow_gain,), add(scale(m_a, b), scale(multiply(e_a, cross), a))),
            -1.0,
        ),
    )
    piston = add(multiply((seal_stiffness, damping), det), multiply((0.0, 1.0), pull))
    mobile = add(det, scale(piston, flexibility))
    characteristic = add(multiply((0.0, 0.0, mass), mobile), piston)
    return LinearActuator(characteristic, mobile, drive, mass)


def dynamic_stiffness(*, model: LinearActuator, frequency: Array) -> Parts:
    """Dynamic stiffness F/x = N(i omega)/M(i omega) as real and imaginary part.

    N and M are `characteristic` and `mobile` of the model.

    Parameters
    ----------
    model : from `linear_actuator`
    frequency : [Hz], > 0

    Returns
    -------
    real (storage) and imaginary (loss) part [N/m]; a positive phase means the force leads

    Notes
    -----
    Valid: as the model; frequency > 0.

    References
    ----------
    [AaltoThesis] eq. 2; [derived] ratio of the model's polynomials

    Examples
    --------
    >>> side = Side(area=5e-4, compliance=5e-14)
    >>> model = linear_actuator(side_a=side, side_b=side, mass=0.0, damping=100.0)
    >>> k = dynamic_stiffness(model=model, frequency=10.0)
    >>> print(f"{k.real:.0f} {k.imaginary:.0f}")
    10000000 6283
    """
    omega = 2 * pi * frequency
    top = at_frequency(model.characteristic, omega)
    low = at_frequency(model.mobile, omega)
    size = low.real * low.real + low.imaginary * low.imaginary
    return Parts(
        (top.real * low.real + top.imaginary * low.imaginary) / size,
        (top.imaginary * low.real - top.real * low.imaginary) / size,
    )
