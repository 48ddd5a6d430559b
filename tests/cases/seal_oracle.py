"""Seals worked out a second time: contact, gland and film inputs from first principles.

Nothing here calls the package's models. Each number follows from its source formula or from a
short derivation, numerically where the package has a closed form.
"""

from __future__ import annotations

from math import exp, pi, sqrt

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

ATMOSPHERE = 101325.0


def gent(hardness):
    """Gent's modulus of a Shore A hardness [Pa]."""
    return 0.0981e6 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))


def heat(temperature, softening, stiffening):
    """Modulus over that at 23 degC: falls with heat, ten times the plateau where it stiffens.

    Time-temperature shift of Williams, Landel and Ferry from 5 K below, square root of time.
    """

    def shift(kelvin):
        above = kelvin - (stiffening - 5)
        return -17.44 * above / (51.6 + above)

    def climb(kelvin):
        return 1 + 9 * 10 ** (0.5 * (shift(kelvin) - shift(stiffening)))

    return exp(softening * (296.15 - temperature)) * climb(temperature) / climb(296.15)


def lame(pressure, inner, outer, modulus, poisson):
    """Growth of a free thick tube's bore under pressure [m]."""
    k = (outer / inner) ** 2
    return pressure * inner / modulus * ((k + 1) / (k - 1) + poisson)


# --- round rings ---------------------------------------------------------------------------------


def o_ring(squeeze, section, modulus, pressure):
    """Line load, width and peak of the default law; the load as the integral of its profile.

    Hertz's width belongs to a rigid plane on a cylinder of diameter W and modulus E/0.75.
    """
    if squeeze <= 0:
        return 0.0, 0.0, 0.0
    rest = modulus * section * (0.307 * squeeze + 2.294 * squeeze**2)
    hertz = 2 * sqrt(4 * rest * (section / 2) / (pi * modulus / 0.75))
    bare = hertz * (1 - 0.652 * squeeze**2)
    gained = (0.307 + 0.549 * squeeze) / (1 + 0.618 * modulus / pressure) if pressure else 0.0
    wide = sqrt(bare**2 + gained * section**2)
    excess = 4 * rest / (pi * bare)
    place = (1 - np.cos(np.linspace(0, pi, 4001))) / 2
    profile = pressure * (1 - place**10) + 2 * excess * np.sqrt(place * (1 - place))
    return wide * np.trapezoid(profile, place), wide, excess + pressure


# --- sliding rings -------------------------------------------------------------------------------


def wedge_width(load, land, taper, modulus, poisson):
    """Contact width of a land between tapers: Johnson's load integral solved for the width."""
    star = modulus / (1 - poisson**2)

    def carried(half):
        # f = E*/2 int_-c^c h'(x) x/sqrt(c^2 - x^2) dx, h' = taper beyond the land; x = c sin(a)
        start = np.arcsin(land / 2 / half)
        angle = np.linspace(start, pi / 2, 4001)
        return star * np.trapezoid(taper * half * np.sin(angle), angle)

    top = land
    while carried(top) < load:
        top *= 2
    return 2 * brentq(lambda c: carried(c) - load, land / 2 * (1 + 1e-12), top, xtol=1e-12)


def step_ring(ring, squeeze, pressure):
    """Line load and contact width of a step ring by the radial balance of its sliding ring."""
    foot_load, _, _ = o_ring(squeeze, ring["section"], ring["energiser"], pressure)
    if squeeze <= 0:
        return 0.0, 0.0
    foot = o_ring(squeeze, ring["section"], ring["energiser"], 0.0)[1]
    back = ring["width"] - foot - ring["section"] * (1 - squeeze) / 2
    load = max(foot_load + pressure * (max(back, 0.0) - ring["relief"]), 0.0)
    if load == 0:
        return 0.0, 0.0
    wide = wedge_width(load, ring["land"], ring["taper"], ring["modulus"], ring["poisson"])
    return load, min(wide, ring["width"])


def land_pressure(load, width, pressure, nodes):
    """Falling oil pressure and an even rest with soft edges, scaled to the load; at nodes."""
    t = np.linspace(0, 1, nodes)
    even = 1 - (2 * t - 1) ** 8
    mean = 8 / 9  # of the even rest
    return pressure * (1 - t) + (load / width - pressure / 2) / mean * even


# --- lips ----------------------------------------------------------------------------------------


def tube_stiffness(modulus, poisson, thickness, length, radius):
    """Edge load over edge deflection of a short tube clamped at its root, by its four modes."""
    bending = modulus * thickness**3 / 12 / (1 - poisson**2)
    roots = np.roots([bending, 0, 0, 0, modulus * thickness / radius**2])
    at_end = np.exp(roots * length)
    rows = [
        np.ones(4),  # clamped
        roots,
        roots**2 * at_end,  # no moment at the rim
        -bending * roots**3 * at_end,  # unit shear there
    ]
    modes = np.linalg.solve(np.array(rows), np.array([0, 0, 0, 1.0], dtype=complex))
    return 1 / np.real(modes @ at_end)


def lip_load(lip, interference, pressure):
    """Line load of a lip: hoop stiffness beside a beam that the pressure lays on the surface."""
    if interference <= 0:
        return 0.0
    t, length = lip["thickness"], lip["width"]
    bending = lip["modulus"] * t**3 / 12 / (1 - lip["poisson"] ** 2)
    stiff = tube_stiffness(lip["modulus"], lip["poisson"], t, length, lip["radius"])
    gap, slope = lip["root"], (lip["root"] + interference) / length

    def beam(span):
        """Root moment and shear that touch down flat at the span; what is missing in height."""
        # w'' = a + b x + p x^2/(2D); w''(s) = 0, w'(s) = -slope, w(s) = gap - slope s
        load = pressure / bending
        b = 2 * (slope - load * span**3 / 3) / span**2
        a = -b * span - load * span**2 / 2
        height = a * span**2 / 2 + b * span**3 / 6 + load * span**4 / 24
        return bending * b, height - (gap - slope * span)

    if pressure == 0 or beam(length)[1] <= 0:  # the rim alone touches: a propped cantilever
        return stiff * interference + 3 / 8 * pressure * length
    span = brentq(lambda s: beam(s)[1], 1e-6 * length, length, xtol=1e-15)
    cantilever = 3 * bending / length**3
    return (stiff - cantilever) * interference + pressure * length + beam(span)[0]


def lip_peak(lip, interference, pressure):
    """Hertz peak of the rim's preload, the sealed pressure on top."""
    if interference <= 0:
        return 0.0
    stiff = tube_stiffness(
        lip["modulus"], lip["poisson"], lip["thickness"], lip["width"], lip["radius"]
    )
    star = lip["modulus"] / (1 - lip["poisson"] ** 2)
    return sqrt(stiff * interference * star / (pi * lip["land"] / 2)) + pressure


def lip_curve(pressure, excess):
    """Pressure of a lip over t: monotone cubics through its four points."""
    top = pressure + excess
    return PchipInterpolator([0, 0.2, 0.6, 1], [pressure, top, 0.42 * top, 0.0])


def lip_width(load, peak, pressure, length):
    """Width whose profile with that peak carries the load, at most the lip."""
    return min(load / float(lip_curve(pressure, peak - pressure).integrate(0, 1)), length)


def lip_pressure(load, width, pressure, nodes):
    """The lip's profile that carries a load over a width, at nodes."""
    excess = brentq(
        lambda e: width * float(lip_curve(pressure, e).integrate(0, 1)) - load, -pressure, 1e9
    )
    return lip_curve(pressure, excess)(np.linspace(0, 1, nodes))


# --- blocks --------------------------------------------------------------------------------------


def block(squeeze, section, width, modulus, poisson, pressure, groove):
    """Load and width of a slipping rubber block in pure shear; its face passes on the pressure."""
    if squeeze <= 0:
        return 0.0, 0.0
    spread = 1 / (1 - squeeze)  # keeps its area
    stress = modulus / 3 * (spread**2 - (1 - squeeze) ** 2)
    share = poisson / (1 - poisson)
    return width * spread * (stress + share * pressure), min(width * spread, groove)


def o_ring_pressure(load, width, pressure, nodes):
    """The sealed pressure up to the outer edge and an ellipse that carries the rest, at nodes."""
    t = np.linspace(0, 1, nodes)
    fine = np.linspace(0, 1, 20001)
    passed = np.trapezoid(1 - fine**10, fine)  # the stated shape of the energised part
    excess = (load / width - pressure * passed) / (pi / 4)
    return pressure * (1 - t**10) + excess * np.sqrt(np.clip(1 - (2 * t - 1) ** 2, 0, None))


def stack(squeeze, section, stretch, growth, spread, depth_spread):
    """Loosest squeeze (stretched, grown) and tightest (bare) of the limits of size."""
    depth = section * (1 - squeeze)
    thin = section / sqrt(1 + stretch) - spread
    return 1 - (depth + growth + depth_spread) / thin, 1 - (depth - depth_spread) / (
        section + spread
    )


def expand(squeeze, ratio):
    """Squeeze of a ring whose section's area grew by a ratio beside its groove."""
    return 1 - (1 - squeeze) / sqrt(ratio)
