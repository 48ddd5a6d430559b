"""A second reader's strength of the wall: lined, linerless, thin laminate, and other mounts.

Goes on from `test_second_reader`: the same actuator with other walls, mounts and tie rods. Stresses
come from `tube_oracle` or from matrices written out here; criteria, ladders and load paths are
written out here.
"""

from dataclasses import replace
from math import cos, inf, pi, radians, sin, sqrt

import numpy as np
import pytest
import tube_oracle as oracle
from plastic_oracle import PlasticTube
from plastic_oracle import mises as von_mises_flow
from test_second_reader import (
    A_A,
    A_B,
    BARREL,
    CASES,
    COLD,
    CURE,
    DRAIN,
    E_AL,
    E_STEEL,
    EXTENSION,
    GROWTH,
    HEAD,
    HOT,
    METAL,
    NU_AL,
    PLATE,
    PLIES,
    R_I,
    R_O,
    ROD_STIFFNESS,
    SUPPLY,
    T700,
    TEXT,
    UNIT,
    WALL,
    YIELD_STEEL,
    S,
    Unit,
    al_yield,
    least,
    mises,
    near,
    share,
)

from actuator_opt import verbs

ROWS = """
    - {material: al_7075_t6, thickness: 0.7 mm}
    - {material: t700_epoxy, angle: 87 deg, thickness: 1.1 mm}
    - {material: t700_epoxy, angle: 28 deg, thickness: 0.9 mm}"""
BONDED = "{type: bond, material: epoxy_structural, length: 18 mm, wall: 2 mm}"
TIED = """{type: tie_rods, material: steel_42crmo4, count: 4, length: 8 mm, preload: 16 kN,
  thread: {diameter: 5 mm, pitch: 0.8 mm}}"""
assert ROWS in TEXT
assert BONDED in TEXT
PATHS = (0.0, A_B, A_A)
"""Axial force in the wall per pressure: none, pulling at the head, piston at the end stop."""


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


def evaluated(*changes):
    """Metrics of the actuator with some of its text replaced."""
    text = TEXT
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    metrics = verbs.evaluate(text).metrics
    return lambda name, case=None: (
        metrics[name].value if case is None else metrics[name].by_case[case]
    )


@pytest.fixture(scope="module")
def lined():
    """The actuator as it stands: exact tube, liner under hoop and helical plies."""
    return evaluated()


@pytest.fixture(scope="module")
def thin():
    """The same by the thin laminate."""
    return evaluated(("barrel:\n", "barrel:\n  model: thin_laminate\n"))


@pytest.fixture(scope="module")
def linerless():
    """Three plies of two materials, no liner."""
    return evaluated(
        (ROWS, LINERLESS_ROWS), ("  steel_42crmo4: {dens", IM7_TEXT + "  steel_42crmo4: {dens")
    )


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
    """Least factors on supply pressure over temperatures, layers, radii, signs and load paths."""
    least_of = dict.fromkeys(("ply", "yield", "mismatch", "range", "bond"), inf)

    def note(name, factor):
        least_of[name] = min(least_of[name], factor)

    for degrees in (COLD, HOT):
        change = degrees - cure
        for k, strength in enumerate(strengths):
            allowed = strength(degrees)
            for r in stations(unit.layers, k):
                if np.ndim(allowed) == 0:
                    cooled = unit.warmth.stresses(k, r) * change
                    rest = cooled + held * unit.force.stresses(k, r)
                    note("mismatch", allowed / mises(cooled))
                    for axial in paths:
                        load = unit.pressure.stresses(k, r) + axial * unit.force.stresses(k, r)
                        note("yield", to_yield(rest, load, allowed) / SUPPLY)
                        note("range", 2 * allowed / mises(load * SUPPLY))
                    continue
                for sign in (1, -1):
                    rest = unit.warmth.ply_stresses(k, r, sign) * change
                    rest = rest + held * unit.force.ply_stresses(k, r, sign)
                    for axial in paths:
                        load = unit.pressure.ply_stresses(k, r, sign)
                        load = load + axial * unit.force.ply_stresses(k, r, sign)
                        note("ply", to_failure(rest, load, allowed)[0] / SUPPLY)
            if k > 0 and np.ndim(strengths[k - 1](degrees)) == 0:
                pull = unit.warmth.stresses(k, stations(unit.layers, k)[0])[2] * change
                if pull > 0:
                    note("bond", allowed[2] / pull)
    return least_of


def test_two_solutions_of_the_wall_agree():
    """Shooting through the wall by Runge and Kutta gives the growth the finite elements give."""
    assert shot_growth(40) == near(GROWTH)


def test_lined_wall(lined):
    """First ply, liner yield, mismatch, range and bond of the exact tube with cure stresses."""
    hand = factors(UNIT, STRENGTHS, PATHS)
    assert lined("first_ply_factor") == near(min(hand["ply"], after_yield(WALL, STRENGTHS)))
    assert lined("liner_yield_factor") == near(hand["yield"])
    assert lined("liner_mismatch_factor") == near(hand["mismatch"])
    assert lined("liner_range_factor") == near(hand["range"])
    assert lined("liner_bond_factor") == near(hand["bond"])


def test_linerless_wall(linerless):
    """First ply of three plies of two materials: each ply with its own strength, cold or hot."""
    unit = Unit(LINERLESS)
    hand = factors(unit, LINERLESS_STRENGTHS, PATHS)
    assert linerless("bore_growth") == near(unit.u_p * SUPPLY)
    assert linerless("first_ply_factor") == near(hand["ply"])
    assert linerless("proof_factor") == near(hand["ply"] / 1.5)


def test_single_ply_twists():
    """One unbalanced ply: the wall twists, its one sign counts, the rest stands."""
    layers = [LINERLESS[0], replace(LINERLESS[1], balanced=False), LINERLESS[2]]
    unit = Unit(layers)
    assert unit.pressure.twist != 0
    value = evaluated(
        (ROWS, LINERLESS_ROWS.replace("angle: 32 deg,", "angle: 32 deg, balanced: false,")),
        ("  steel_42crmo4: {dens", IM7_TEXT + "  steel_42crmo4: {dens"),
    )
    least_of = inf
    for degrees in (COLD, HOT):
        for k, strength in enumerate(LINERLESS_STRENGTHS):
            for sign in (1, -1) if layers[k].balanced else (1,):
                for r in stations(layers, k):
                    rest = unit.warmth.ply_stresses(k, r, sign) * (degrees - CURE)
                    for axial in PATHS:
                        load = unit.pressure.ply_stresses(k, r, sign)
                        load = load + axial * unit.force.ply_stresses(k, r, sign)
                        found = to_failure(rest, load, strength(degrees))[0]
                        least_of = min(least_of, found / SUPPLY)
    assert value("bore_growth") == near(unit.u_p * SUPPLY)
    assert value("first_ply_factor") == near(least_of)


def tsai_wu(s, strengths):
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


def hashin(s, strengths):
    """Hashin 1980 in the plane, S23 = S12."""
    x_t, x_c, y_t, y_c, shear = strengths
    one, two, _, slip = s
    slip = (slip / shear) ** 2
    fibre = (one / x_t) ** 2 + slip if one > 0 else -one / x_c
    if two > 0:
        return max(fibre, (two / y_t) ** 2 + slip)
    crushed = ((y_c / (2 * shear)) ** 2 - 1) * two / y_c
    return max(fibre, (two / (2 * shear)) ** 2 + slip + crushed)


def max_strain(s, strengths):
    """Failure strains are strength over modulus; the radial strain is not tested."""
    x_t, x_c, y_t, y_c, shear = strengths
    one, two, three, slip = s
    along = one - 0.3 * two - 0.3 * three
    across = two - 0.3 * 8.5 / 135 * one - 0.45 * three
    return max(along / x_t, -along / x_c, across / y_t, -across / y_c, abs(slip) / shear)


def puck(s, strengths):
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
    points = []
    for degrees in (COLD, HOT):
        for k in (1, 2):
            for r in stations(WALL, k, 5):
                rest = UNIT.warmth.ply_stresses(k, r) * (degrees - CURE)
                for axial in PATHS:
                    load = UNIT.pressure.ply_stresses(k, r) + axial * UNIT.force.ply_stresses(k, r)
                    points.append((rest, load * SUPPLY, T700_STRENGTH(degrees)))
    low, high = 0.0, 20.0
    for _ in range(40):
        middle = (low + high) / 2
        worst = max(criterion(rest + middle * load, allowed) for rest, load, allowed in points)
        low, high = (middle, high) if worst < 1 else (low, middle)
    value = evaluated(("barrel:\n", f"barrel:\n  criterion: {criterion.__name__}\n"))
    assert value("first_ply_factor") == near(min(low, after_yield(WALL, STRENGTHS)))


# --- the ladder to burst -------------------------------------------------------------------------

LEFT = 1e-3
YIELD = "yield"


def cracked(ply):
    """E2, G12, nu12 and nu23 of a failed ply, a thousandth each."""
    (e1, e2, e3), (nu12, nu13, nu23) = ply.youngs, ply.poisson
    return oracle.Ply(
        youngs=(e1, e2 * LEFT, e3),
        poisson=(nu12 * LEFT, nu13, nu23 * LEFT),
        shear=ply.shear * LEFT,
    )


def flowing(ply, held):
    """A flowing liner: bulk modulus kept, shear modulus a thousandth, a held deviator.

    The held stress enters as free strain under unit warming.
    """
    bulk = ply.youngs[0] / (3 * (1 - 2 * ply.poisson[0]))
    shear = ply.shear * LEFT
    soft = oracle.Ply.isotropic(
        9 * bulk * shear / (3 * bulk + shear),
        (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)),
    )
    return replace(soft, expansion=tuple(-soft.compliance()[:3, :3] @ held))


def ladder(layers, strengths, axial, degrees=HOT):
    """Pressures of every failure on the way to burst, maximum stress at both faces, with modes.

    Plies of one material and |angle| crack together; no cure stress, no radial mode.
    """
    failed, held, steps = set(), {}, []
    while True:
        now = []
        for k, layer in enumerate(layers):
            ply = replace(layer.ply, expansion=(0.0, 0.0, 0.0))
            if k in held:
                ply = flowing(ply, held[k])
            elif k in failed:
                ply = cracked(ply)
            now.append(replace(layer, ply=ply))
        rate = oracle.solve(now, R_I, inner_pressure=1.0, axial_force=axial)
        rest = oracle.solve(now, R_I, temperature_change=1.0)
        reached = []
        for k, strength in enumerate(strengths):
            for r in stations(layers, k, 2):
                if np.ndim(strength(degrees)) == 0:
                    if k not in held:
                        load = to_yield(rest.stresses(k, r), rate.stresses(k, r), strength(degrees))
                        reached.append((load, k, YIELD))
                    continue
                found, mode = to_failure(
                    rest.ply_stresses(k, r),
                    rate.ply_stresses(k, r),
                    strength(degrees),
                    (FIBRE,) if k in failed else IN_PLANE,
                )
                reached.append((found, k, mode))
        p, k, mode = min(reached, key=lambda one: one[0])
        steps.append((p, k, mode))
        if mode == FIBRE:
            return steps
        if mode == YIELD:  # the held stress is the mean of both faces (a choice)
            faces = [rate.stresses(k, r) * p + rest.stresses(k, r) for r in stations(layers, k, 2)]
            mean = (faces[0] + faces[1])[:3] / 2
            held[k] = (mean - sum(mean) / 3) * (1 - LEFT)
            continue
        same = (layers[k].ply, abs(layers[k].angle))
        failed |= {i for i, one in enumerate(layers) if (one.ply, abs(one.angle)) == same}
        assert len(steps) < 9


def burst(layers, strengths, paths=PATHS):
    """Least over the load paths of the largest load of the ladder, over supply pressure."""
    return min(max(p for p, _, _ in ladder(layers, strengths, a)) for a in paths) / SUPPLY


def after_yield(layers, strengths, paths=PATHS):
    """First ply on the ladder, where the liner has yielded before it, over supply pressure."""
    found = inf
    for axial in paths:
        steps = ladder(layers, strengths, axial)
        if steps[0][2] == YIELD:
            found = min(found, steps[1][0] / SUPPLY)
    return found


def test_burst_of_the_exact_tube(lined, linerless):
    """A plain ladder on the exact tube, written independently: lined and linerless."""
    assert lined("burst_factor") == near(burst(WALL, STRENGTHS))
    assert linerless("burst_factor") == near(burst(LINERLESS, LINERLESS_STRENGTHS))


def plastic_first_ply(axial, degrees):
    """First ply of the lined wall whose liner flows (von Mises), cure stress included.

    Incremental finite elements; the ply's stress at their Gauss points.
    """
    change, nothing = degrees - CURE, np.zeros(4)
    wall = PlasticTube(WALL, R_I, al_yield(degrees), von_mises_flow, elements=12)
    for part in (0.25, 0.5, 0.75, 1.0):
        wall.load(0.0, 0.0, change * part)
    turned = [oracle.turned(layer.ply, layer.angle) for layer in WALL]
    before = (0.0, 0.0)
    for p in np.linspace(0, 5 * SUPPLY, 26)[1:]:
        wall.load(p, axial * p, change)
        strain = np.einsum("egij,ej->egi", wall.turn, wall.unknowns[wall.place])
        used = 0.0
        for k in (1, 2):
            (c, heat), (_, a) = turned[k], PLIES[k]
            m, n = cos(a), sin(a)
            for here in strain[12 * k : 12 * k + 12].reshape(-1, 3):
                full = c[:, list(oracle.STRAINS)] @ np.array([*here, 0.0]) - heat * change
                z, t, zt = full[0], full[1], full[5]
                own = (
                    m * m * z + n * n * t + 2 * m * n * zt,
                    n * n * z + m * m * t - 2 * m * n * zt,
                    full[2],
                    m * n * (t - z) + (m * m - n * n) * zt,
                )
                used = max(used, 1 / to_failure(nothing, own, T700_STRENGTH(degrees))[0])
        if used > 1:
            return before[0] + (p - before[0]) * (1 - before[1]) / (used - before[1])
        before = (p, used)
    raise AssertionError("no first ply")


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="elastic first ply, or a ladder without cure stress"
)
def test_first_ply_after_the_liner_has_yielded(lined):
    """A liner that yields at 2.2 p_s leaves its share to the plies: they crack at 4.2, not 5.1."""
    true = plastic_first_ply(A_A, COLD) / SUPPLY
    assert lined("liner_yield_factor") < true
    assert lined("first_ply_factor") <= 1.02 * true


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


def thin_burst(axial):
    """Ply discount by hand: yielded liner keeps its line force, a cracked pair its fibres."""
    soft = [False, False, False]
    held, highest = np.zeros(3), 0.0
    x_t, x_c, y_t, y_c, s_12 = T700_STRENGTH(HOT)
    for _ in range(4):
        weak = reduced(135e9, 8.5e6, 0.3e-3, 4.3e6)
        q = [
            LEFT * Q_AL if soft[0] else Q_AL,
            *(weak if soft[k] else Q_PLY for k in (1, 2)),
        ]
        a = sum(pair(m, ang) * t for m, (t, ang) in zip(q, PLIES, strict=True))
        rate = np.linalg.solve(a, [axial / (2 * pi * R_M), R_M, 0])
        base = np.linalg.solve(a, -held)
        reached = []
        if not soft[0]:
            z, h, _ = Q_AL @ rate
            reached.append((al_yield(HOT) / sqrt(z * z - z * h + h * h), 0, "yield"))
        for k in (1, 2):
            now, at = q[k] @ turn(PLIES[k][1]) @ rate, q[k] @ turn(PLIES[k][1]) @ base
            limits = [("fibre", 0, x_t, x_c)]
            if not soft[k]:
                limits += [("matrix", 1, y_t, y_c), ("matrix", 2, s_12, s_12)]
            for mode, i, tension, compression in limits:
                sign = 1 if now[i] > 0 else -1
                strength = tension if sign > 0 else compression
                reached.append(((strength - sign * at[i]) / abs(now[i]), k, mode))
        p, k, mode = min(reached)
        highest = max(highest, p)
        if mode == "fibre":
            return highest
        soft[k] = True
        if mode == "yield":
            held = Q_AL @ rate * p * PLIES[0][0] * (1 - LEFT)
    raise AssertionError("the ladder has no end")


def test_thin_burst(thin):
    """The fast mode's burst equals the hand ladder."""
    assert thin("burst_factor") == near(min(thin_burst(a) for a in PATHS) / SUPPLY)


def test_thin_laminate_is_on_the_unsafe_side_at_the_bore(thin):
    """At t/r of 0.2 the membrane shows 80 to 90 % of the exact bore growth."""
    assert 0.80 < thin("bore_growth") / GROWTH < 0.90


# --- other mounts --------------------------------------------------------------------------------


def test_head_mounted():
    """Held at the head, p_A A_A pulls the wall and stretch opens chamber A."""
    value = evaluated(("mount: cap_clevis", "mount: head_flange"))
    for case in CASES:
        assert value("stiffness_min", case) == near(least(case, UNIT, head=True)[0])
    hand = factors(UNIT, STRENGTHS, PATHS)
    assert value("liner_yield_factor") == near(hand["yield"])
    assert value("bore_growth") == near(GROWTH)


TIE_RODS = 4 * E_STEEL * pi / 4 * 5e-3**2 / (BARREL + 2 * PLATE)
"""Stiffness of the rods: shanks of nominal diameter between the plates' outer faces."""
K_BARREL = 1 / (UNIT.e_n * BARREL)
OPENING = K_BARREL / (K_BARREL + TIE_RODS)
"""Share of a force that tears the ends apart which unloads the barrel."""
RELIEF = -UNIT.e_p * BARREL * OPENING * TIE_RODS
"""Unloading of the barrel per pressure by its own shortening, over its whole length."""


@pytest.fixture(scope="module")
def tied():
    """The actuator between tie rods with a stated preload of 16 kN."""
    return evaluated((BONDED, TIED))


def test_tie_rods_share_the_load(tied):
    """Preload, what pressure takes of it, the rods' load at supply, and the wall's own load."""
    loss = SUPPLY * (OPENING * A_A + RELIEF)
    assert tied("joint_factor") == near(16e3 / loss)
    area = 4 * pi / 4 * (5e-3 - 0.9382 * 0.8e-3) ** 2
    rods = SUPPLY * A_A + 16e3 - loss
    assert tied("retention_factor") == near(YIELD_STEEL * area / rods)
    assert tied("retention_burst_factor") == near(1e9 / 750e6 * YIELD_STEEL * area / rods)
    for case, (direction, *_) in CASES.items():
        p_b = DRAIN if direction > 0 else SUPPLY
        force = -16e3 + OPENING * p_b * A_B + RELIEF * SUPPLY
        assert tied("bore_growth", case) == near(UNIT.u_p * SUPPLY + UNIT.u_n * force)
    paths = [OPENING * a + RELIEF for a in PATHS]
    hand = factors(UNIT, STRENGTHS, paths, held=-16e3)
    assert tied("liner_yield_factor") == near(hand["yield"])
    assert tied("liner_range_factor") == near(hand["range"])
    assert tied("burst_factor") == near(burst(WALL, STRENGTHS, paths))
    after = after_yield(WALL, STRENGTHS, paths)
    assert after < hand["ply"]
    assert tied("first_ply_factor") == near(after)


def test_default_preload_keeps_the_joint_closed_at_proof():
    """Without a stated preload it is what 1.5 times supply pressure takes of it."""
    value = evaluated((BONDED, TIED.replace("preload: 16 kN,", "")))
    assert value("joint_factor") == near(1.5)


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="the clamp is counted before it is there"
)
def test_clamp_does_not_help_a_cooling_liner(tied, lined):
    """The liner cools from its cure before any tie rod is tightened."""
    assert tied("liner_mismatch_factor") == near(lined("liner_mismatch_factor"))
    assert tied("liner_bond_factor") == near(lined("liner_bond_factor"))


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="the growth by preload is taken for swelling"
)
def test_stiffness_between_tie_rods(tied):
    """Preload is no part of a stiffness; rods hold back the barrel's shortening (4e-5 here)."""
    for case in CASES:
        exact = least(case, UNIT, tie_rods=TIE_RODS)[0]
        assert tied("stiffness_min", case) == near(exact, 1e-4)


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="wall beyond the stroke is taken as rigid"
)
def test_a_longer_barrel_swells_over_all_its_length():
    """Room beyond the stroke is a part of chamber B: its oil and its wall both give."""
    extra = 50e-3
    value = evaluated(("barrel:\n", f"barrel:\n  length: {(BARREL + extra) * 1e3} mm\n"))
    length = S + HEAD + PLATE + EXTENSION
    rod = ROD_STIFFNESS * length / (length + extra)
    for case in CASES:
        exact = least(case, UNIT, rod=rod, beyond=extra, barrel=BARREL + extra)[0]
        assert value("stiffness_min", case) == near(exact)


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="properties the library lacks are dropped in silence"
)
def test_a_stated_expansion_counts():
    """A property the design states and the library lacks is used, not dropped."""
    row = ROWS.replace("t700_epoxy, angle: 28", "t700_2510, angle: 28")
    stated = "  t700_2510: {thermal_expansion_1: 0 ppm/K, thermal_expansion_2: 30 ppm/K}\n"
    value = evaluated((ROWS, row), ("  steel_42crmo4: {dens", stated + "  steel_42crmo4: {dens"))
    assert value("liner_mismatch_factor") is not None


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
