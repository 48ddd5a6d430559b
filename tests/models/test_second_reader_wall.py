"""A second reader's strength of the wall: lined, linerless, thin laminate, other materials.

Goes on from `test_second_reader`: the same actuator with other walls. Stresses come from
`tube_oracle` or from matrices written out here, criteria are written out here. The way to burst
is in `test_second_reader_ladder`, mounts are in `test_second_reader_mounts`.
"""

from dataclasses import replace
from functools import cache
from math import cos, inf, pi, radians, sin, sqrt

import numpy as np
import pytest
import tube_oracle as oracle
from test_second_reader import (
    A_A,
    A_B,
    COLD,
    CURE,
    E_AL,
    GROWTH,
    HOT,
    METAL,
    NU_AL,
    PLIES,
    R_I,
    R_O,
    SUPPLY,
    T700,
    TEXT,
    UNIT,
    WALL,
    Unit,
    al_yield,
    mises,
    near,
    share,
)

from actuator_opt import api as verbs

ROWS = """
    - {material: al_7075_t6, thickness: 0.7 mm}
    - {material: t700_epoxy, angle: 87 deg, thickness: 1.1 mm}
    - {material: t700_epoxy, angle: 28 deg, thickness: 0.9 mm}"""
assert ROWS in TEXT
PATHS = (0.0, A_B, A_A)
"""Axial force in the wall per pressure: none, pulling at the head, piston at the end stop."""
PLACES = {0.0: "no axial load", A_B: "pulled at the head", A_A: "piston at the end stop"}


def ply_strengths(stated):
    """Allowables X_t, X_c, Y_t, Y_c, S at a temperature: basis 0.88, process 0.75 on X_t."""

    def at(degrees):
        fibre, matrix = 0.88 * share(0.95, 80, degrees), 0.88 * share(0.75, 80, degrees)
        x_t, x_c, y_t, y_c, s = stated
        return (x_t * fibre * 0.75, x_c * fibre, y_t * matrix, y_c * matrix, s * matrix)

    return at


T700_STRENGTH = ply_strengths((2550e6, 1470e6, 69e6, 170e6, 80e6))
IM7_STRENGTH = ply_strengths((2326.2e6, 1200.1e6, 62.3e6, 199.8e6, 92.3e6))
STRENGTHS = (al_yield, T700_STRENGTH, T700_STRENGTH)

IM7 = oracle.Ply(
    youngs=(171.42e9, 9.08e9, 9.08e9),
    poisson=(0.32, 0.32, 0.487),
    shear=5.29e9,
    expansion=(-0.5e-6, 25.8e-6, 25.8e-6),
)
LINERLESS = [
    oracle.Layer(ply=IM7, thickness=0.8e-3, angle=radians(85)),
    oracle.Layer(ply=T700, thickness=1.2e-3, angle=radians(32)),
    oracle.Layer(ply=IM7, thickness=0.6e-3, angle=radians(60)),
]
LINERLESS_STRENGTHS = (IM7_STRENGTH, T700_STRENGTH, IM7_STRENGTH)
LINERLESS_ROWS = """
    - {material: im7_8552, angle: 85 deg, thickness: 0.8 mm}
    - {material: t700_epoxy, angle: 32 deg, thickness: 1.2 mm}
    - {material: im7_8552, angle: 60 deg, thickness: 0.6 mm}"""
IM7_TEXT = """  im7_8552: {density: 1580 kg/m^3, youngs_modulus_1: 171.42 GPa,
    youngs_modulus_2: 9.08 GPa, youngs_modulus_3: 9.08 GPa, shear_modulus_12: 5.29 GPa,
    poissons_ratio_12: 0.32, poissons_ratio_13: 0.32, poissons_ratio_23: 0.487,
    strength_1_tension: 2326.2 MPa, strength_1_compression: 1200.1 MPa,
    strength_2_tension: 62.3 MPa, strength_2_compression: 199.8 MPa, strength_12: 92.3 MPa,
    thermal_expansion_1: -0.5 ppm/K, thermal_expansion_2: 25.8 ppm/K}
"""
BOND = "retention: {type: bond, material: epoxy_structural, length: 18 mm, wall: 2 mm}\n"
LINERLESS_WALL = (
    (ROWS, LINERLESS_ROWS),
    (BOND, ""),  # the wall alone: beside a skirt, it bends
    ("  steel_42crmo4: {dens", IM7_TEXT + "  steel_42crmo4: {dens"),
)
THIN = ("barrel:\n", "barrel:\n  model: thin_laminate\n")


class Found:
    """What the package says of an actuator."""

    def __init__(self, text):
        """Evaluate it."""
        self.evaluation = verbs.evaluate(text)

    def __call__(self, name, case=None):
        """Value of a metric, or its value in one load case."""
        metric = self.evaluation.metrics[name]
        return metric.value if case is None else metric.by_case[case]

    def place(self, name):
        """Where a metric is at its worst."""
        return self.evaluation.metrics[name].place

    def why(self, name):
        """Why a metric has no value."""
        return self.evaluation.metrics[name].why


@cache
def evaluated(*changes):
    """The actuator with some of its text replaced."""
    text = TEXT
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    return Found(text)


@pytest.fixture(scope="module")
def lined():
    """The actuator as it stands: exact tube, liner under hoop and helical plies."""
    return evaluated()


@pytest.fixture(scope="module")
def thin():
    """The same by the thin laminate."""
    return evaluated(THIN)


@pytest.fixture(scope="module")
def linerless():
    """Three plies of two materials, no liner."""
    return evaluated(*LINERLESS_WALL)


# --- first ply, yield, cooling -------------------------------------------------------------------


def stations(layers, k, count=11):
    """Radii through layer k, both faces included."""
    start = R_I + sum(layer.thickness for layer in layers[:k])
    return np.linspace(start, start + layers[k].thickness, count)


def to_yield(residual, stress, strength):
    """Load at which von Mises of residual + load x stress reaches a strength."""

    def product(a, b):
        mean_a, mean_b = sum(a[:3]) / 3, sum(b[:3]) / 3
        return 1.5 * sum((a[:3] - mean_a) * (b[:3] - mean_b)) + 3 * a[3] * b[3]

    square, mixed = product(stress, stress), product(residual, stress)
    left = strength**2 - product(residual, residual)
    assert left > 0
    return (sqrt(mixed**2 + square * left) - mixed) / square


FIBRE, MATRIX, RADIAL, SHEAR = range(4)
GROUPS = ("fibre", "matrix", "radial", "shear")
YIELD = "yield"
ALL, IN_PLANE = (FIBRE, MATRIX, RADIAL, SHEAR), (FIBRE, MATRIX, SHEAR)


def to_failure(residual, stress, strengths, modes=ALL):
    """Load and mode at which a ply's stress (1, 2, 3, 12) first reaches a strength."""
    x_t, x_c, y_t, y_c, s = strengths
    limits = ((x_t, x_c), (y_t, y_c), (y_t, y_c), (s, s))
    loads = []
    for i in modes:
        tension, compression = limits[i]
        if stress[i] > 0:
            loads.append(((tension - residual[i]) / stress[i], i))
        elif stress[i] < 0:
            loads.append(((compression + residual[i]) / -stress[i], i))
    return min(loads)


def factors(unit, strengths, paths, cure=CURE, held=0.0):
    """Least factors on supply pressure over temperatures, layers, radii, signs and load paths.

    And where they are: layer, mode, temperature, load path.
    """
    least_of = dict.fromkeys(("ply", "yield", "mismatch", "range", "bond"), inf)
    places = {}

    def note(name, factor, *place):
        if factor < least_of[name]:
            least_of[name], places[name] = factor, place

    for degrees in (COLD, HOT):
        change = degrees - cure
        clamp = held(degrees) if callable(held) else held
        for k, strength in enumerate(strengths):
            allowed = strength(degrees)
            for r in stations(unit.layers, k):
                if np.ndim(allowed) == 0:
                    cooled = unit.warmth.stresses(k, r) * change
                    rest = cooled + clamp * unit.force.stresses(k, r)
                    note("mismatch", allowed / mises(cooled), k)
                    for axial in paths:
                        load = unit.pressure.stresses(k, r) + axial * unit.force.stresses(k, r)
                        at = (k, YIELD, degrees, axial)
                        note("yield", to_yield(rest, load, allowed) / SUPPLY, *at)
                        note("range", 2 * allowed / mises(load * SUPPLY), k)
                    continue
                for sign in (1, -1) if unit.layers[k].balanced else (1,):
                    rest = unit.warmth.ply_stresses(k, r, sign) * change
                    rest = rest + clamp * unit.force.ply_stresses(k, r, sign)
                    for axial in paths:
                        load = unit.pressure.ply_stresses(k, r, sign)
                        load = load + axial * unit.force.ply_stresses(k, r, sign)
                        pressure, mode = to_failure(rest, load, allowed)
                        note("ply", pressure / SUPPLY, k, mode, degrees, axial)
            if k > 0 and np.ndim(strengths[k - 1](degrees)) == 0:
                pull = unit.warmth.stresses(k, stations(unit.layers, k)[0])[2] * change
                if pull > 0:
                    note("bond", allowed[2] / pull, k)
    return least_of, places


def test_two_solutions_of_the_wall_agree():
    """Shooting through the wall by Runge and Kutta gives the growth the finite elements give."""
    assert shot_growth(40) == near(GROWTH)


def test_lined_wall(lined):
    """Liner yield, mismatch, range and bond of the exact tube; no ply holds more than elastic."""
    hand, places = factors(UNIT, STRENGTHS, PATHS)
    assert lined("first_ply_factor") <= hand["ply"]  # the ladder knows the liner's yield
    assert lined("liner_yield_factor") == near(hand["yield"])
    assert lined("liner_mismatch_factor") == near(hand["mismatch"])
    assert lined("liner_range_factor") == near(hand["range"])
    assert lined("liner_bond_factor") == near(hand["bond"])
    assert places["yield"] == (0, YIELD, COLD, A_A)
    place = "layup[0] al_7075_t6, cold, piston at the end stop"
    assert lined.place("liner_yield_factor") == place


def test_linerless_wall(linerless):
    """First ply of three plies of two materials, each with its own strength, and its place."""
    unit = Unit(LINERLESS)
    hand, places = factors(unit, LINERLESS_STRENGTHS, PATHS)
    assert linerless("bore_growth") == near(unit.u_p * SUPPLY)
    assert linerless("first_ply_factor") == near(hand["ply"])
    assert linerless("proof_factor") == near(hand["ply"] / 1.5)
    k, mode, degrees, axial = places["ply"]
    material = ("im7_8552", "t700_epoxy", "im7_8552")[k]
    climate = {COLD: "cold", HOT: "hot"}[degrees]
    place = f"layup[{k}] {material} {GROUPS[mode]}, {climate}, {PLACES[axial]}"
    assert linerless.place("first_ply_factor") == place


TWISTED = [LINERLESS[0], replace(LINERLESS[1], balanced=False), LINERLESS[2]]
SINGLE = ("angle: 32 deg,", "angle: 32 deg, balanced: false,")
TWISTED_WALL = ((ROWS, LINERLESS_ROWS.replace(*SINGLE)), *LINERLESS_WALL[2:])


def test_single_ply_twists():
    """One unbalanced ply: the wall twists, its one sign counts, both signs of the pairs."""
    unit = Unit(TWISTED)
    assert unit.pressure.twist != 0
    value = evaluated(*TWISTED_WALL)
    assert value("bore_growth") == near(unit.u_p * SUPPLY)
    assert value("first_ply_factor") == near(factors(unit, LINERLESS_STRENGTHS, PATHS)[0]["ply"])


def test_stated_properties_count():
    """Expansions and fatigue strength that the design states and the library lacks are used."""
    row = ROWS.replace("t700_epoxy, angle: 28", "t700_2510, angle: 28")
    stated = """  t700_2510: {youngs_modulus_1: 125 GPa, youngs_modulus_2: 8.4 GPa,
    youngs_modulus_3: 8.4 GPa, shear_modulus_12: 4.2 GPa, poissons_ratio_12: 0.31,
    poissons_ratio_13: 0.31, poissons_ratio_23: 0.45,
    thermal_expansion_1: 0 ppm/K, thermal_expansion_2: 30 ppm/K, fatigue_strength: 200 MPa}
"""
    value = evaluated((ROWS, row), ("  steel_42crmo4: {dens", stated + "  steel_42crmo4: {dens"))
    ply = oracle.Ply(
        youngs=(125e9, 8.4e9, 8.4e9),
        poisson=(0.31, 0.31, 0.45),
        shear=4.2e9,
        expansion=(0.0, 30e-6, 30e-6),
    )
    unit = Unit([*WALL[:2], replace(WALL[2], ply=ply)])
    hand, _ = factors(unit, STRENGTHS, PATHS)  # strengths of the helical ply play no part here
    assert value("liner_yield_factor") == near(hand["yield"])
    assert value("liner_mismatch_factor") == near(hand["mismatch"])
    assert value("liner_bond_factor") == near(hand["bond"])
    amplitude = max(
        (unit.pressure.ply_stresses(2, r) + A_A * unit.force.ply_stresses(2, r))[0] * SUPPLY / 2
        for r in stations(unit.layers, 2, 2)
    )
    nothing_known_of_its_basis = share(0.95, 80, HOT)
    allowed = 200e6 * nothing_known_of_its_basis
    assert value("ply_fatigue_factor") == near(allowed / amplitude)
    assert value.place("ply_fatigue_factor") == "layup[2] t700_2510, piston at the end stop"


def test_reasons(linerless, thin):
    """What a wall cannot have is said of that wall: liner, radial stress, cure, expansions."""
    assert "no metal" in linerless.why("liner_yield_factor")
    for name in ("liner_mismatch_factor", "liner_bond_factor"):
        assert "no liner" in linerless.why(name)
    assert "no metal layer" in linerless.why("liner_range_factor")
    assert "thin-laminate model" in thin.why("liner_bond_factor")
    uncured = evaluated(("  cure_temperature: 120 degC\n", ""))
    unknown = evaluated((ROWS, ROWS.replace("t700_epoxy, angle: 28", "t700_2510, angle: 28")))
    for name in ("liner_mismatch_factor", "liner_bond_factor"):
        assert "cure_temperature" in uncured.why(name)
        assert unknown.why(name) == "the thermal expansion of t700_2510 is unknown"


# --- criteria ------------------------------------------------------------------------------------


def tsai_wu(s, strengths, _):
    """Tsai-Wu in three dimensions, F12* = -1/2, F23 = -F22/2 (no S23 known)."""
    x_t, x_c, y_t, y_c, shear = strengths
    f1, f2, f11, f22 = 1 / x_t - 1 / x_c, 1 / y_t - 1 / y_c, 1 / (x_t * x_c), 1 / (y_t * y_c)
    one, two, three, slip = s
    across = two**2 + three**2 - two * three
    return (
        f1 * one
        + f2 * (two + three)
        + f11 * one**2
        + f22 * across
        - sqrt(f11 * f22) * one * (two + three)
        + (slip / shear) ** 2
    )


def hashin(s, strengths, _):
    """Hashin 1980 in the plane, S23 = S12."""
    x_t, x_c, y_t, y_c, shear = strengths
    one, two, _, slip = s
    slip = (slip / shear) ** 2
    fibre = (one / x_t) ** 2 + slip if one > 0 else -one / x_c
    if two > 0:
        return max(fibre, (two / y_t) ** 2 + slip)
    crushed = ((y_c / (2 * shear)) ** 2 - 1) * two / y_c
    return max(fibre, (two / (2 * shear)) ** 2 + slip + crushed)


def max_strain(s, strengths, ply):
    """Failure strains are strength over modulus; the radial strain is not tested."""
    x_t, x_c, y_t, y_c, shear = strengths
    one, two, three, slip = s
    nu12, nu13, nu23 = ply.poisson
    along = one - nu12 * two - nu13 * three
    across = two - nu12 * ply.youngs[1] / ply.youngs[0] * one - nu23 * three
    return max(along / x_t, -along / x_c, across / y_t, -across / y_c, abs(slip) / shear)


def puck(s, strengths, _):
    """Puck's plane modes A, B, C with inclinations 0.35 and 0.30, and fibre failure."""
    x_t, x_c, y_t, y_c, shear = strengths
    one, two, _, slip = s
    fibre = max(one / x_t, -one / x_c)
    plus, minus = 0.35, 0.30
    action = shear / (2 * minus) * (sqrt(1 + 2 * minus * y_c / shear) - 1)
    cross = minus * action / shear
    corner = shear * sqrt(1 + 2 * cross)
    if two >= 0:
        opened = (1 - plus * y_t / shear) * two / y_t
        return max(fibre, sqrt((slip / shear) ** 2 + opened**2) + plus * two / shear)
    if abs(two) * corner <= action * abs(slip):
        return max(fibre, (sqrt(slip**2 + (minus * two) ** 2) + minus * two) / shear)
    closed = (slip / (2 * (1 + cross) * shear)) ** 2 + (two / y_c) ** 2
    return max(fibre, closed * y_c / -two)


@pytest.mark.parametrize("criterion", [tsai_wu, hashin, max_strain, puck])
def test_other_criteria(criterion):
    """Residual + SR x load first meets the surface of each criterion where the package says."""
    unit, points = Unit(LINERLESS), []
    for degrees in (COLD, HOT):
        for k, strength in enumerate(LINERLESS_STRENGTHS):
            for r in stations(LINERLESS, k, 5):
                rest = unit.warmth.ply_stresses(k, r) * (degrees - CURE)
                for axial in PATHS:
                    load = unit.pressure.ply_stresses(k, r) + axial * unit.force.ply_stresses(k, r)
                    points.append((rest, load * SUPPLY, strength(degrees), LINERLESS[k].ply))
    low, high = 0.0, 20.0
    for _ in range(40):
        middle = (low + high) / 2
        worst = max(criterion(rest + middle * load, *known) for rest, load, *known in points)
        low, high = (middle, high) if worst < 1 else (low, middle)
    named = ("barrel:\n", f"barrel:\n  criterion: {criterion.__name__}\n")
    assert evaluated(*LINERLESS_WALL, named)("first_ply_factor") == near(low)


# --- the thin laminate by matrices ---------------------------------------------------------------


def reduced(e1, e2, nu12, g12):
    """Plane-stress stiffness Q of a ply [Jones1999]."""
    k = 1 - nu12**2 * e2 / e1
    return np.array([[e1 / k, nu12 * e2 / k, 0], [nu12 * e2 / k, e2 / k, 0], [0, 0, g12]])


def turn(a):
    """Engineering strain (z, theta, z-theta) to (1, 2, 12); angle from the tube axis."""
    c, s = cos(a), sin(a)
    return np.array(
        [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]]
    )


def pair(q, a):
    """Stiffness of a balanced +-pair in tube axes."""
    return (turn(a).T @ q @ turn(a) + turn(-a).T @ q @ turn(-a)) / 2


R_M = (R_I + R_O) / 2
Q_AL = reduced(E_AL, E_AL, NU_AL, E_AL / 2 / (1 + NU_AL))
Q_PLY = reduced(135e9, 8.5e9, 0.3, 4.3e9)
QS = (Q_AL, Q_PLY, Q_PLY)
ALPHA = [np.array([23.6e-6, 23.6e-6, 0])] + 2 * [np.array([-0.5e-6, 30e-6, 0])]
FLEX = np.linalg.inv(sum(pair(q, a) * t for q, (t, a) in zip(QS, PLIES, strict=True)))


def expansion():
    """Free thermal strain of the wall per kelvin, axial and hoop."""
    force = 0
    for q, (t, a), alpha in zip(QS, PLIES, ALPHA, strict=True):
        force = force + (turn(a).T + turn(-a).T) @ q @ alpha * t / 2
    return FLEX @ force


def membrane(k, axial, change):
    """Ply stress 1, 2, 3, 12 per pressure, and of warming, at mid-radius.

    No radial stress, but for the pressure on the liner's bore.
    """
    t = turn(PLIES[k][1])
    load = QS[k] @ t @ FLEX @ np.array([axial / (2 * pi * R_M), R_M, 0])
    rest = QS[k] @ (t @ expansion() - ALPHA[k]) * change
    radial = -1.0 if k == 0 else 0.0
    return np.array([*load[:2], radial, load[2]]), np.array([*rest[:2], 0.0, rest[2]])


def test_thin_laminate(thin):
    """The fast mode: growth, first ply, liner yield and mismatch of the membrane, with cure."""
    assert thin("bore_growth") == near(FLEX[1, 1] * SUPPLY * R_I**2)
    plies, yields, cold = [], [], []
    for degrees in (COLD, HOT):
        for axial in PATHS:
            for k in range(3):
                load, rest = membrane(k, axial, degrees - CURE)
                if k:
                    plies.append(to_failure(rest, load, T700_STRENGTH(degrees))[0] / SUPPLY)
                else:
                    yields.append(to_yield(rest, load, al_yield(degrees)) / SUPPLY)
                    cold.append(al_yield(degrees) / mises(rest))
    assert thin("first_ply_factor") <= min(plies) * (1 + 1e-6)  # yield before it may lower it
    assert thin("liner_yield_factor") == near(min(yields))
    assert thin("liner_mismatch_factor") == near(min(cold))


def test_thin_laminate_is_on_the_unsafe_side_at_the_bore(thin):
    """At t/r of 0.2 the membrane shows 80 to 90 % of the exact bore growth."""
    assert 0.80 < thin("bore_growth") / GROWTH < 0.90


# --- another solution of the same wall -----------------------------------------------------------


def solid(ply, a):
    """3-D stiffness over (z, theta, r) of a pair; the shear couplings cancel in the pair."""
    (e1, e2, _), (nu12, _, nu23), g12 = ply.youngs, ply.poisson, ply.shear
    s = np.array(
        [
            [1 / e1, -nu12 / e1, -nu12 / e1],
            [-nu12 / e1, 1 / e2, -nu23 / e2],
            [-nu12 / e1, -nu23 / e2, 1 / e2],
        ]
    )
    c = np.linalg.inv(s)
    m, n = cos(a) ** 2, sin(a) ** 2
    mix = m * n
    zz = m * m * c[0, 0] + n * n * c[1, 1] + 2 * mix * (c[0, 1] + 2 * g12)
    tt = n * n * c[0, 0] + m * m * c[1, 1] + 2 * mix * (c[0, 1] + 2 * g12)
    zt = mix * (c[0, 0] + c[1, 1] - 4 * g12) + (m * m + n * n) * c[0, 1]
    zr, tr = m * c[0, 2] + n * c[1, 2], n * c[0, 2] + m * c[1, 2]
    return np.array([[zz, zt, zr], [zt, tt, tr], [zr, tr, c[2, 2]]])


def shot_growth(n):
    """Bore growth of the layered tube at zero axial force, by shooting u and sigma_r outwards.

    u' = (s_r - C_zr e_z - C_tr u/r)/C_rr and s_r' = (s_t - s_r)/r through every layer (Runge
    and Kutta), for (u_0, e_z) one and none; s_r(r_o) = 0 and the axial force zero give both.
    """

    def end(u, strain, pressure):
        state, r = np.array([u, -pressure, 0.0]), R_I
        for ply, (t, a) in zip((METAL, T700, T700), PLIES, strict=True):
            c, h = solid(ply, a), t / n

            def rate(r, y, c=c):
                slope = (y[1] - c[0, 2] * strain - c[1, 2] * y[0] / r) / c[2, 2]
                z, hoop, _ = c @ np.array([strain, y[0] / r, slope])
                return np.array([slope, (hoop - y[1]) / r, 2 * pi * r * z])

            for _ in range(n):
                k1 = rate(r, state)
                k2 = rate(r + h / 2, state + h / 2 * k1)
                k3 = rate(r + h / 2, state + h / 2 * k2)
                k4 = rate(r + h, state + h * k3)
                state, r = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), r + h
        return state[1:]

    columns = np.column_stack([end(1e-5, 0.0, 0.0), end(0.0, 1e-4, 0.0)])
    unknowns = np.linalg.solve(columns, -end(0.0, 0.0, SUPPLY))
    return 1e-5 * unknowns[0]
