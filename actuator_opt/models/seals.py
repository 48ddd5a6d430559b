"""O-ring seals: contact laws (registry `LAWS`); the modulus comes from `elastomer`.

C is the squeeze as a share of the free section W. At C <= 0, when the growth of the barrel has used
up the squeeze, there is no contact: every law gives zero width, line load and peak pressure. Loads
are per length of circumference; the pressure is the one-sided difference across the ring, >= 0. The
laws differ by a third at zero pressure and by two thirds near p = E, so every result must name its
law.

The default, `energised`, is a formula fitted to the finite elements of `finite_elements.o_ring`
(`benchmarks/o_ring_law.py` computes the grid and fits): plane strain, incompressible neo-Hookean
rubber, no friction, rigid walls, a groove 1.4 W wide with closed corners, squeeze 0.08 to 0.25, p/E
0 to 1.5, 192 elements around the section (256 elements change force and width by up to 1.3 %). The
width of the groove does not matter as long as the ring does not fill it. The curvature of a small
ring does matter: on a rod of radius 3 W the force without pressure is 16 % greater, in a bore of
radius 7 W it is 9 % less; for p >= E, both differences are within 4 %. At p = 3 E, the law's force
is still within 5 % and its width within 8 %.

A new law needs three functions of (squeeze, section, youngs_modulus, pressure) and an entry in
`LAWS`. The design format, help and schema read that entry, and the tests of all laws include it.
"""

from __future__ import annotations

import math
from typing import Protocol

from ..base.dataclass import dataclass
from ..base.kinds import kinds
from ..base.numeric import Array, clip, geometry, namespace, real, sqrt, where
from .contact_profile import o_ring_mean


@geometry
def width_as_published(*, section: Array, gland_height: Array) -> Array:
    """Contact width as the chord of the *unsqueezed* circle, b = sqrt(4 R^2 - h^2).

    This is 38 % wider than plane-strain finite elements at C = 0.10, and 15 % wider at C = 0.20.

    Parameters
    ----------
    section : free section 2 R [m]
    gland_height : h = bore radius + growth - radius of the groove bottom [m]

    Returns
    -------
    contact width [m]; 0 where h >= 2 R: the ring no longer touches and the formula has no root

    Notes
    -----
    Valid: to reproduce the source only; 0 < h < 2 R.

    References
    ----------
    [ElAsswad2018] eq. 19

    Examples
    --------
    >>> print(f"{width_as_published(section=2e-3, gland_height=1.7e-3) * 1e3:.4f} mm")
    1.0536 mm
    """
    square = section * section - gland_height * gland_height
    touching = real(square) > 0
    return where(touching, sqrt(where(touching, square, 1.0)), 0.0)


class ContactFunction(Protocol):
    """Function for one quantity of a contact law; it accepts four arguments, but may use fewer."""

    def __call__(
        self, *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
    ) -> Array:
        """Evaluate at squeeze (-), section (m), youngs_modulus (Pa), pressure (Pa, >= 0)."""


@dataclass(frozen=True, slots=True)
class SealLaw:
    """An O-ring contact law: three functions, their ranges and their source.

    Parameters
    ----------
    name : registry key, named in every result
    help : meaning of the name in a design file
    line_load : normal force per length of circumference, N/m
    contact_width : width of the contact, m (limit it by `gland.limited_width`)
    peak_pressure : highest contact pressure, Pa gauge
    squeeze_limits : squeezes that a design may have with this law, -; outside, the contact is wider
        than the free section, or the load is meaningless (judged by finite elements at squeezes of
        0.08 to 0.30)
    squeeze_range : squeezes at which the law was compared with data, -
    pressure_range : pressure / Young's modulus at which the law was compared with data, -
    reference : source
    """

    name: str
    help: str
    line_load: ContactFunction
    contact_width: ContactFunction
    peak_pressure: ContactFunction
    squeeze_limits: tuple[float, float]
    squeeze_range: tuple[float, float]
    pressure_range: tuple[float, float]
    reference: str

    def in_range(self, *, squeeze: Array, youngs_modulus: Array, pressure: Array) -> Array:
        """Whether the law was compared with data at this squeeze and pressure (booleans)."""
        c, p = real(squeeze), real(pressure) / real(youngs_modulus)
        low, high = self.squeeze_range
        return (
            (c >= low) & (c <= high) & (p >= self.pressure_range[0]) & (p <= self.pressure_range[1])
        )


def _positive(squeeze: Array) -> Array:
    return where(real(squeeze) > 0, squeeze, 0.0)


def _lindley(c: Array) -> Array:
    """Lindley's load function g = 1.25 C^1.5 + 50 C^6 of a free ring, c >= 0."""
    cube = c * c * c
    return 1.25 * c * namespace(c).sqrt(c) + 50 * cube * cube


@dataclass(frozen=True, slots=True)
class EnergisedRing:
    """Hertz contact of a mounted ring that the oil widens and loads, with fitted coefficients.

    Without pressure: f_0 = E W (a C + b C^2), b_0 = W sqrt(6 f_0/(pi E W)) (1 - c C^2)
    and p_0 = 4 f_0/(pi b_0). Under pressure: b^2 = b_0^2 + W^2 (d + e C) p/(p + h E),
    f = b [(10/11) p + pi p_0/4], the mean of `contact_profile.o_ring_profile`, and p_max = p_0 + p.

    Parameters
    ----------
    dry_force : a and b of the force without oil pressure [-]
    narrowing : c, which reduces Hertz's width where the squeeze is not small [-]
    growth : d and e; (b/W)^2 grows by d + e C at infinite pressure [-]
    half_pressure : h, the p/E at which half of that growth is reached [-]
    """

    dry_force: tuple[float, float]
    narrowing: float
    growth: tuple[float, float]
    half_pressure: float

    def _mounted(self, squeeze: Array) -> tuple[Array, Array]:
        """Contact width b_0/W and peak pressure p_0/E without oil pressure, at positive squeeze."""
        force = squeeze * (self.dry_force[0] + self.dry_force[1] * squeeze)
        narrow = 1 - self.narrowing * squeeze * squeeze
        return sqrt((6 / math.pi) * force) * narrow, 4 * sqrt(force / (6 * math.pi)) / narrow

    @geometry
    def contact_width(
        self, *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
    ) -> Array:
        """Contact width b [m]."""
        touching = real(squeeze) > 0
        c = where(touching, squeeze, 1.0)
        mounted, _ = self._mounted(c)
        grown = pressure / (pressure + self.half_pressure * youngs_modulus)
        square = mounted * mounted + (self.growth[0] + self.growth[1] * c) * grown
        return where(touching, section * sqrt(square), 0.0)

    @geometry
    def line_load(
        self, *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
    ) -> Array:
        """Normal force per length of circumference, f [N/m]."""
        width = self.contact_width(
            squeeze=squeeze, section=section, youngs_modulus=youngs_modulus, pressure=pressure
        )
        _, excess = self._mounted(where(real(squeeze) > 0, squeeze, 1.0))
        return width * o_ring_mean(
            sealed_pressure=pressure, outer_pressure=0.0, excess=excess * youngs_modulus
        )

    def peak_pressure(
        self, *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
    ) -> Array:
        """Highest contact pressure p_max [Pa gauge]."""
        touching = real(squeeze) > 0
        _, excess = self._mounted(where(touching, squeeze, 1.0))
        return where(touching, excess * youngs_modulus + pressure, 0.0)


ENERGISED_RING = EnergisedRing((0.307, 2.294), 0.652, (0.307, 0.549), 0.618)
"""Coefficients fitted to the finite elements of this project. At all points of the
grid, force and width are within 2.1 % and the peak pressure within 6 % (a test compares them)."""


@geometry
def _plane_strain_load(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    c = _positive(squeeze)
    share = 0.72 + 1.6 * (clip(c, 0.15, 0.20) - 0.15)
    load = section * ((4 / 3) * youngs_modulus * _lindley(c) + share * pressure)
    return where(real(c) > 0, load, 0.0)


@geometry
def _plane_strain_width(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    decay = pressure / youngs_modulus
    spread = 0.32 * (1 - namespace(decay).exp(-2.1 * decay))
    return where(real(squeeze) > 0, section * (2 * squeeze + 0.13 + spread), 0.0)


@geometry
def _plane_strain_peak(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    c = _positive(squeeze)
    peak = (16 / (3 * math.pi)) * youngs_modulus * _lindley(c) / (2 * c + 0.13) + pressure
    return where(real(c) > 0, peak, 0.0)


@geometry
def _hertz_load(*, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array) -> Array:
    g = _lindley(_positive(squeeze))
    width = namespace(g).sqrt((6 / math.pi) * g)
    return section * (youngs_modulus * g + pressure * width)


@geometry
def _hertz_width(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    g = _lindley(_positive(squeeze))
    return section * namespace(g).sqrt((6 / math.pi) * g)


@geometry
def _hertz_peak(*, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array) -> Array:
    g = _lindley(_positive(squeeze))
    peak = 4 * youngs_modulus * namespace(g).sqrt(g / (6 * math.pi)) + pressure
    return where(real(squeeze) > 0, peak, 0.0)


@geometry
def _chord_width(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    c = _positive(squeeze)
    return section * sqrt(c * (2 - c))


@geometry
def _chord_load(*, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array) -> Array:
    c = _positive(squeeze)
    return pressure * section * sqrt(c * (2 - c))


@geometry
def _stadium_width(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    c = _positive(squeeze)
    valid = real(c) < 1
    height = where(valid, 1 - c, 1.0)
    return where(valid, (0.25 * math.pi) * section * (1 / height - height), math.nan)


@geometry
def _stadium_load(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    return pressure * _stadium_width(
        squeeze=squeeze, section=section, youngs_modulus=youngs_modulus, pressure=pressure
    )


@geometry
def _uniform_peak(
    *, squeeze: Array, section: Array, youngs_modulus: Array, pressure: Array
) -> Array:
    return where(real(squeeze) > 0, pressure, 0.0)


LAWS = kinds(
    "contact law",
    SealLaw(
        "energised",
        "line contact that oil pressure widens and loads, within 3 % of finite elements",
        ENERGISED_RING.line_load,
        ENERGISED_RING.contact_width,
        ENERGISED_RING.peak_pressure,
        (0.02, 0.40),
        (0.08, 0.25),
        (0.0, 1.5),
        "[derived] fit to own plane-strain finite elements, Hertz line contact",
    ),
    # f = (4/3) E W g + k_p p W, b = W [2C + 0.13 + 0.32 (1 - e^(-2.1 p/E))],
    # p_max = 4 f0/(pi b0) + p; k_p 0.72 to C 0.15, 0.80 from 0.20.
    SealLaw(
        "plane_strain",
        'an older fit; under pressure, it gives up to 38 % more force than "energised"',
        _plane_strain_load,
        _plane_strain_width,
        _plane_strain_peak,
        (0.02, 0.40),
        (0.10, 0.30),
        (0.0, 1.5),
        "[derived] plane-strain finite elements with the load function of [Lindley1967]",
    ),
    # f = E W g + p b, b = W sqrt(6 g/pi), p_max = 4 E sqrt(g/(6 pi)) + p.
    SealLaw(
        "hertz_lindley",
        "Hertz line contact under Lindley's force, of the same width at any pressure",
        _hertz_load,
        _hertz_width,
        _hertz_peak,
        (0.02, 0.40),
        (0.05, 0.30),
        (0.0, 1.0),
        "[Lindley1967], Hertz line contact",
    ),
    # b = W sqrt(1 - (1 - C)^2), f = p b: no preload, zero at zero pressure.
    SealLaw(
        "chord",
        "formula printed in [ElAsswad2018], which gives no force at zero pressure",
        _chord_load,
        _chord_width,
        _uniform_peak,
        (0.0, 0.45),
        (0.10, 0.30),
        (0.0, 1.5),
        "[ElAsswad2018] eq. 16, 17, 19, 20",
    ),
    # b = (pi W/4)[1/(1 - C) - (1 - C)] by area conservation, f = p b (choice).
    SealLaw(
        "stadium",
        "a flattened ring of unchanged cross-section area; it gives no force at zero pressure",
        _stadium_load,
        _stadium_width,
        _uniform_peak,
        (0.0, 0.45),
        (0.10, 0.30),
        (0.0, 1.5),
        "[derived] stadium section of constant area; load as [ElAsswad2018] eq. 16",
    ),
)
"""O-ring contact laws by name; ``energised`` is the default."""
