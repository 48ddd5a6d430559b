"""A second reader's actuator with other mounts: head flange, tie rods, a longer barrel.

Goes on from `test_second_reader` (volumes, seals) and `test_second_reader_ladder` (first ply,
burst). Forces that tie rods share, and clamps, are written out here.
"""

from math import pi

import pytest
from test_second_reader import (
    A_A,
    A_B,
    ASSEMBLY,
    BARREL,
    CASES,
    COLD,
    DRAIN,
    E_STEEL,
    EXTENSION,
    GROWTH,
    HEAD,
    HOT,
    PLATE,
    ROD_STIFFNESS,
    SUPPLY,
    TEXT,
    UNIT,
    WALL,
    YIELD_STEEL,
    S,
    W,
    friction_of_seals,
    least,
    near,
    ring_modulus,
)
from test_second_reader_ladder import after_yield, burst
from test_second_reader_wall import PATHS, STRENGTHS, evaluated, factors

BONDED = "{type: bond, material: epoxy_structural, length: 18 mm, wall: 2 mm}"
TIED = """{type: tie_rods, material: steel_42crmo4, count: 4, length: 8 mm, preload: 16 kN,
  thread: {diameter: 5 mm, pitch: 0.8 mm}}"""
assert BONDED in TEXT
FLANGE = ("mount: cap_clevis", "mount: head_flange")


def rods(barrel):
    """Stiffness of the tie rods: shanks of nominal diameter between the plates' outer faces."""
    return 4 * E_STEEL * pi / 4 * 5e-3**2 / (barrel + 2 * PLATE)


TIE_RODS = rods(BARREL)
K_BARREL = 1 / (UNIT.e_n * BARREL)
OPENING = K_BARREL / (K_BARREL + TIE_RODS)
"""Share of a force that tears the ends apart which unloads the barrel."""
RELIEF = -UNIT.e_p * BARREL * OPENING * TIE_RODS
"""Unloading of the barrel per pressure by its own shortening, over its whole length."""
CLAMP = -16e3
GROWN = UNIT.warmth.axial_strain * BARREL + 2 * 23.6e-6 * PLATE
GAIN = (GROWN - 11.5e-6 * (BARREL + 2 * PLATE)) / (1 / K_BARREL + 1 / TIE_RODS)
"""Preload that each kelvin of warming adds to the rods [N/K]."""


def clamped(degrees):
    """Axial force in the wall without pressure, at a temperature."""
    return CLAMP - GAIN * (degrees - ASSEMBLY)


@pytest.fixture(scope="module")
def tied():
    """The actuator between tie rods with a stated preload of 16 kN."""
    return evaluated((BONDED, TIED))


def wall_force(direction, pressure):
    """Axial force of the clamped wall while the chamber that drives is at a pressure."""
    p_b = DRAIN if direction > 0 else pressure
    return CLAMP + OPENING * p_b * A_B + RELIEF * pressure


def test_head_mounted():
    """Held at the head, p_A A_A pulls the wall and stretch opens chamber A."""
    value = evaluated(FLANGE)
    for case in CASES:
        assert value("stiffness_min", case) == near(least(case, UNIT, head=True)[0])
    hand, _ = factors(UNIT, STRENGTHS, PATHS)
    assert value("liner_yield_factor") == near(hand["yield"])
    assert value("bore_growth") == near(GROWTH)


@pytest.mark.parametrize("between_rods", [False, True], ids=["bonded", "tied"])
@pytest.mark.parametrize("head", [False, True], ids=["cap", "head"])
def test_a_longer_barrel_gives_over_all_its_length(head, between_rods):
    """Room beyond the stroke is a part of chamber B: its oil and its wall both give.

    Tie rods hold back the barrel's own shortening (4e-5), which the package leaves out.
    """
    extra = 50e-3
    changes = [("barrel:\n", f"barrel:\n  length: {(BARREL + extra) * 1e3} mm\n")]
    changes += [FLANGE] * head + [(BONDED, TIED)] * between_rods
    value = evaluated(*changes)
    length = S + HEAD + PLATE + EXTENSION
    how = {
        "rod": ROD_STIFFNESS * length / (length + extra),
        "beyond": extra,
        "barrel": BARREL + extra,
        "head": head,
        "tie_rods": rods(BARREL + extra) if between_rods else 0.0,
    }
    for case in CASES:
        exact = least(case, UNIT, **how)[0]
        assert value("stiffness_min", case) == near(exact, 1e-4 if between_rods else 1e-6)


# --- tie rods ------------------------------------------------------------------------------------


def test_tie_rods_share_the_load(tied):
    """Preload, what pressure takes of it, the rods' load at supply, and the wall's own load."""
    loss = SUPPLY * (OPENING * A_A + RELIEF)
    gains = 0.0, *(-clamped(at) - 16e3 for at in (COLD, HOT))
    settled = (2 * 3 + 2 * 2.5 + 2 * 1.5) * 1e-6 * K_BARREL * TIE_RODS / (K_BARREL + TIE_RODS)
    weakest = 16e3 * 2 / (1 + 1.6) - settled + min(gains)  # of a torque wrench, after settling
    assert tied("joint_factor") == near(weakest / (1.5 * loss))  # at proof pressure
    area = 4 * pi / 4 * (5e-3 - 0.9382 * 0.8e-3) ** 2
    tight = 16e3 * 2 * 1.6 / (1 + 1.6) + max(gains)
    for metric, stress in (
        ("retention_factor", YIELD_STEEL),
        ("retention_burst_factor", 1e9 / 750e6 * YIELD_STEEL),
    ):  # closed, the rods feel a share beside the greatest preload; open, the whole force
        closed, opened = (
            (stress * area - tight) / (SUPPLY * A_A - loss),
            stress * area / SUPPLY / A_A,
        )
        assert tied(metric) == near(min(closed, opened))
    for case, (direction, *_) in CASES.items():
        growth = UNIT.u_p * SUPPLY + UNIT.u_n * wall_force(direction, SUPPLY)
        assert tied("bore_growth", case) == near(growth)
        assert tied("seal_gap", case) == near(35e-6 + growth / 2)
    hand, _ = factors(UNIT, STRENGTHS, [OPENING * a + RELIEF for a in PATHS], held=clamped)
    assert tied("liner_yield_factor") == near(hand["yield"])
    assert tied("liner_range_factor") == near(hand["range"])


def test_default_preload_keeps_the_joint_closed_at_proof():
    """Without a stated preload it is what 1.5 times supply pressure takes of it."""
    value = evaluated((BONDED, TIED.replace("preload: 16 kN,", "")))
    assert value("joint_factor") == near(1.0)


def test_clamp_does_not_help_a_cooling_liner(tied):
    """The liner cools from its cure before any tie rod is tightened."""
    for name in ("liner_mismatch_factor", "liner_bond_factor"):
        assert tied(name) == near(evaluated()(name))


def test_stiffness_between_tie_rods(tied):
    """Preload is no part of a stiffness; rods hold back the barrel's shortening (4e-5 here)."""
    for case in CASES:
        exact = least(case, UNIT, tie_rods=TIE_RODS)[0]
        assert tied("stiffness_min", case) == near(exact, 1e-4)


@pytest.mark.parametrize("direction", [1, -1], ids=["push", "pull"])
def test_preload_presses_on_the_seals_at_any_pressure(direction):
    """At half the supply pressure the growth by preload is whole, that by pressure half.

    The package scales the rods' share of the load with pressure twice (2e-4 of the friction).
    """
    word, driven, speed = {1: "push", -1: "pull"}[direction], SUPPLY / 2, 0.05
    row = f"  - {{name: soft, direction: {word}, force: 1 kN, speed: 0.05 m/s, pressure: 100 bar}}"
    value = evaluated((BONDED, TIED), ("materials:\n", f"{row}\nmaterials:\n"))
    at_seal = (UNIT.u_p * driven + UNIT.u_n * wall_force(direction, driven)) / 2
    p_b = DRAIN if direction > 0 else driven
    running, breakaway, _ = friction_of_seals(speed, driven, p_b, at_seal)
    assert value("friction_running", "soft") == near(running, 3e-4)
    assert value("friction_breakaway", "soft") == near(breakaway, 3e-4)
    c = 0.155 - at_seal / W
    at_rest = 4 / 3 * ring_modulus(313.15) * W * (1.25 * c**1.5 + 50 * c**6)
    peak = 4 * at_rest / (pi * W * (2 * c + 0.13)) + driven - DRAIN
    assert value("contact_pressure", "soft") == near(peak, 3e-4)  # the piston ring's


def test_first_ply_between_tie_rods(tied):
    """The ladder without the clamp cracks first: its liner and plies are pulled from the start."""
    paths = [OPENING * a + RELIEF for a in PATHS]
    first = after_yield(WALL, STRENGTHS, paths, clamped)
    assert 0.9 * first < tied("first_ply_factor") <= first * (1 + 1e-12)


def test_burst_between_tie_rods(tied):
    """Plates can press on a barrel, never pull it: burst is not above that at no axial force.

    Axial pull relieves the hoop fibres here. With the clamp the ladder ends at 7.70, at no axial
    force at 7.74, by the rods' share of the load alone at 7.88.
    """
    paths = [OPENING * a + RELIEF for a in PATHS]
    unpulled = burst(WALL, STRENGTHS, [0.0])
    assert burst(WALL, STRENGTHS, paths, clamped) < unpulled
    assert tied("burst_factor") <= unpulled * (1 + 1e-6)
