"""A second reader's way to burst: yield of the liner, cracks, fibres, with the cure stress.

Goes on from `test_second_reader_wall`. The ladder is written out here on `tube_oracle` (exact
tube) and on matrices (thin laminate); an incremental plastic solution shows what it is worth.
"""

from dataclasses import replace
from functools import cache
from math import cos, pi, sin

import numpy as np
import pytest
import tube_oracle as oracle
from plastic_oracle import PlasticTube, mises as von_mises_flow
from test_second_reader import (
    COLD,
    CURE,
    HOT,
    PLIES,
    R_I,
    SUPPLY,
    UNIT,
    WALL,
    al_yield,
    near,
)
from test_second_reader_wall import (
    ALPHA,
    FIBRE,
    IN_PLANE,
    LINERLESS,
    LINERLESS_STRENGTHS,
    LINERLESS_WALL,
    MATRIX,
    PATHS,
    PLACES,
    Q_AL,
    Q_PLY,
    R_M,
    STRENGTHS,
    T700_STRENGTH,
    THIN,
    TWISTED,
    TWISTED_WALL,
    YIELD,
    evaluated,
    factors,
    pair,
    reduced,
    stations,
    to_failure,
    to_yield,
    turn,
)

LEFT = 1e-3
CLIMATES = {COLD: "cold", HOT: "hot"}
MODES = {YIELD: "yield", FIBRE: "fibre tension", MATRIX: "matrix tension"}
"""The package's names of what fails on these ladders."""


def cracked(ply):
    """E2, G12, nu12 and nu23 of a failed ply, a thousandth each; it expands as before."""
    (e1, e2, e3), (nu12, nu13, nu23) = ply.youngs, ply.poisson
    return replace(
        ply,
        youngs=(e1, e2 * LEFT, e3),
        poisson=(nu12 * LEFT, nu13, nu23 * LEFT),
        shear=ply.shear * LEFT,
    )


def flowing(ply):
    """A flowing liner: bulk modulus kept, shear modulus a thousandth; it expands as before."""
    bulk = ply.youngs[0] / (3 * (1 - 2 * ply.poisson[0]))
    shear = ply.shear * LEFT
    return oracle.Ply.isotropic(
        9 * bulk * shear / (3 * bulk + shear),
        (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)),
        ply.expansion[0],
    )


def at_rest(layers, change, failed, held):
    """The wall as it now is; warmed by 1 it is in its climate.

    A stress that a liner holds beside its elastic one is a free strain.
    """
    now = []
    for k, layer in enumerate(layers):
        ply = cracked(layer.ply) if k in failed else layer.ply
        if k in held:
            ply = flowing(layer.ply)
        free = np.array(ply.expansion) * change
        if k in held:
            free = free - ply.compliance()[:3, :3] @ held[k]
        now.append(replace(layer, ply=replace(ply, expansion=tuple(free))))
    return now


@cache
def ladder(layers, strengths, axial, degrees, clamp=0.0):
    """Every failure on the way to burst: pressure, layer, mode; maximum stress at both faces.

    Cure stress is there from the start. Plies of one material and |angle| crack together; the
    deviator that a liner has when it yields, the mean of both faces, stays. No radial mode.
    """
    failed, held, steps = set(), {}, []
    while True:
        now = at_rest(layers, degrees - CURE, failed, held)
        rate = oracle.solve(now, R_I, inner_pressure=1.0, axial_force=axial)
        rest = oracle.solve(now, R_I, axial_force=clamp, temperature_change=1.0)
        reached = []
        for k, strength in enumerate(strengths):
            allowed, modes = strength(degrees), (FIBRE,) if k in failed else IN_PLANE
            for r in stations(layers, k, 2):
                if np.ndim(allowed) == 0:
                    if k not in held:
                        load = to_yield(rest.stresses(k, r), rate.stresses(k, r), allowed)
                        reached.append((load, k, YIELD))
                    continue
                for sign in (1, -1) if layers[k].balanced else (1,):
                    before, more = (one.ply_stresses(k, r, sign) for one in (rest, rate))
                    load, mode = to_failure(before, more, allowed, modes)
                    reached.append((load, k, mode))
        p, k, mode = min(reached, key=lambda one: one[0])
        steps.append((p, k, mode))
        if mode == FIBRE:
            return steps
        if mode == YIELD:
            faces = [rate.stresses(k, r) * p + rest.stresses(k, r) for r in stations(layers, k, 2)]
            mean = (faces[0] + faces[1])[:3] / 2
            held[k] = (mean - sum(mean) / 3) * (1 - LEFT)
            continue
        same = (layers[k].ply, abs(layers[k].angle))
        failed |= {i for i, one in enumerate(layers) if (one.ply, abs(one.angle)) == same}
        assert len(steps) < 9


def ladders(layers, strengths, paths=PATHS, clamp=0.0):
    """The ladders of both climates and all load paths, by both."""
    return {
        (degrees, axial): ladder(
            tuple(layers),
            strengths,
            axial,
            degrees,
            clamp(degrees) if callable(clamp) else clamp,
        )
        for degrees in (COLD, HOT)
        for axial in paths
    }


def top(steps):
    """Largest load of a ladder over supply pressure."""
    return max(p for p, _, _ in steps) / SUPPLY


def first_ply(steps):
    """Load at which the first ply of a ladder goes, over supply pressure."""
    until = next(i for i, (_, _, mode) in enumerate(steps) if mode != YIELD)
    return top(steps[: until + 1])


def burst(layers, strengths, paths=PATHS, clamp=0.0):
    """Least over climates and load paths of the largest load, over supply pressure."""
    return min(map(top, ladders(layers, strengths, paths, clamp).values()))


def after_yield(layers, strengths, paths=PATHS, clamp=0.0):
    """First ply on the ladder over supply pressure, least over climates and load paths."""
    return min(map(first_ply, ladders(layers, strengths, paths, clamp).values()))


@pytest.mark.parametrize(
    ("changes", "layers", "strengths"),
    [((), WALL, STRENGTHS), (LINERLESS_WALL, LINERLESS, LINERLESS_STRENGTHS)],
    ids=["lined", "linerless"],
)
def test_burst_of_the_exact_tube(changes, layers, strengths):
    """Burst, its climate and load path, and every step of the way there."""
    found = ladders(layers, strengths)
    degrees, axial = min(found, key=lambda at: top(found[at]))
    value = evaluated(*changes)
    assert value("burst_factor") == near(top(found[degrees, axial]))
    assert value.place("burst_factor") == f"{CLIMATES[degrees]}, {PLACES[axial]}"
    steps = value.evaluation.wall.ladder.steps
    assert [(one.layer, one.mode) for one in steps] == [
        (k, MODES[mode]) for _, k, mode in found[degrees, axial]
    ]
    assert [one.pressure for one in steps] == near([p for p, _, _ in found[degrees, axial]])


@pytest.mark.parametrize("criterion", ["max_stress", "hashin"])
def test_first_ply_of_the_lined_wall(criterion):
    """The yielding liner leaves its share to the plies: they crack before the elastic wall would.

    The ladder goes by maximum stress, whatever the criterion.
    """
    found = ladders(WALL, STRENGTHS)
    degrees, axial = min(found, key=lambda at: first_ply(found[at]))
    expected = first_ply(found[degrees, axial])
    assert found[degrees, axial][0][2] == YIELD
    assert expected < factors(UNIT, STRENGTHS, PATHS)[0]["ply"]
    value = evaluated(("barrel:\n", f"barrel:\n  criterion: {criterion}\n"))
    assert value("first_ply_factor") == near(expected)
    assert value("proof_factor") == near(min(expected, value("liner_yield_factor")) / 1.5)
    place = f"first ply with yielding liner, {CLIMATES[degrees]}, {PLACES[axial]}"
    assert value.place("first_ply_factor") == place


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
    for p in np.linspace(0, 6 * SUPPLY, 31)[1:]:
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


def test_first_ply_after_the_liner_has_yielded():
    """True flow of the liner: the ladder stands 1 to 3 % below it, in every climate and path."""
    true = {at: plastic_first_ply(at[1], at[0]) / SUPPLY for at in ladders(WALL, STRENGTHS)}
    for at, steps in ladders(WALL, STRENGTHS).items():
        assert steps[0][2] == YIELD
        assert 0.95 * true[at] < first_ply(steps) <= true[at]
    assert 0.95 * min(true.values()) < evaluated()("first_ply_factor") <= min(true.values())


def test_burst_of_a_wall_that_twists():
    """Once its single ply has cracked a wall twists away: 4.4 where a pair had 6.2; no number."""
    exact = burst(TWISTED, LINERLESS_STRENGTHS)
    assert exact < 0.8 * burst(LINERLESS, LINERLESS_STRENGTHS)
    assert evaluated(*TWISTED_WALL)("burst_factor") is None


# --- the thin laminate ---------------------------------------------------------------------------


def thin_ladder(axial, degrees, cure):
    """Ply discount by hand: a yielded liner keeps its line force, a cracked pair its fibres."""
    soft, held, steps, change = [False] * 3, np.zeros(3), [], degrees - cure
    weak, allowed = reduced(135e9, 8.5e6, 0.3e-3, 4.3e6), T700_STRENGTH(degrees)
    while True:
        q = [LEFT * Q_AL if soft[0] else Q_AL, *(weak if soft[k] else Q_PLY for k in (1, 2))]
        line, stiff = -held, 0
        for m, (t, a), alpha in zip(q, PLIES, ALPHA, strict=True):
            stiff = stiff + pair(m, a) * t
            line = line + (turn(a).T + turn(-a).T) @ m @ alpha * (change * t / 2)
        rate = np.linalg.solve(stiff, [axial / (2 * pi * R_M), R_M, 0])
        rest = np.linalg.solve(stiff, line)

        def stress(k, strain, warm, q=q):
            one, two, slip = q[k] @ (turn(PLIES[k][1]) @ strain - ALPHA[k] * warm)
            return np.array([one, two, 0.0, slip])

        reached = []
        if not soft[0]:
            load = to_yield(stress(0, rest, change), stress(0, rate, 0.0), al_yield(degrees))
            reached.append((load, 0, YIELD))
        for k in (1, 2):
            modes = (FIBRE,) if soft[k] else IN_PLANE
            load, mode = to_failure(stress(k, rest, change), stress(k, rate, 0.0), allowed, modes)
            reached.append((load, k, mode))
        p, k, mode = min(reached)
        steps.append((p, k, mode))
        if mode == FIBRE:
            return steps
        soft[k] = True
        if mode == YIELD:
            now = (stress(0, rest, change) + stress(0, rate, 0.0) * p)[[0, 1, 3]]
            held = now * PLIES[0][0] * (1 - LEFT)


def test_thin_burst():
    """The fast mode's burst equals the hand ladder, which leaves out the cure stress (0.2 %)."""
    least = min(top(thin_ladder(axial, HOT, HOT)) for axial in PATHS)
    assert evaluated(THIN)("burst_factor") == near(least)
    cured = min(top(thin_ladder(axial, at, CURE)) for axial in PATHS for at in (COLD, HOT))
    assert cured == near(least, 0.005)


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="the thin laminate's ladder has no cure stress"
)
def test_first_ply_of_the_thin_laminate_after_yield():
    """Cold, its liner yields at 2.9 p_s and the ply cracks at 3.79, not at the elastic 4.04."""
    least = min(first_ply(thin_ladder(a, at, CURE)) for a in PATHS for at in (COLD, HOT))
    assert evaluated(THIN)("first_ply_factor") <= least * (1 + 1e-6)


def test_thin_laminate_errs_to_the_safe_side_of_first_ply():
    """All the same it stands below the exact tube's ladder."""
    assert evaluated(THIN)("first_ply_factor") < after_yield(WALL, STRENGTHS)
