"""Rods in the evaluation, of layers and of one metal: section, strength, buckling, ends, weight.

Expected values are closed forms, the independent tube of `tube_oracle`, or arithmetic written out
here; nothing of `evaluation` is called to get them.
"""

from __future__ import annotations

import math
from itertools import product
from math import exp, pi, sqrt, tan, tanh
from pathlib import Path

import numpy as np
import pytest
import tube_oracle as oracle
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from actuator_opt import api as verbs
from actuator_opt.design.materials import load_library
from actuator_opt.evaluation import rod_strength
from actuator_opt.evaluation.kernel import compute
from actuator_opt.models import stepped
from actuator_opt.optimisation.actuator import build
from actuator_opt.pages import section as drawing

KNEE = (Path(__file__).parents[2] / "designs" / "knee_bonded.yaml").read_text(encoding="utf-8")
PLY_P = {
    "youngs_modulus_1": 138e9, "youngs_modulus_2": 9e9, "youngs_modulus_3": 9e9,
    "poissons_ratio_12": 0.28, "poissons_ratio_13": 0.28, "poissons_ratio_23": 0.42,
    "shear_modulus_12": 5e9, "shear_modulus_13": 5e9,
}  # fmt: skip
STRENGTH = {
    "strength_1_tension": 1900e6, "strength_1_compression": 1300e6, "strength_2_tension": 55e6,
    "strength_2_compression": 190e6, "strength_12": 85e6,
}  # fmt: skip
KNOCK_DOWNS = (
    "temperature_knockdown", "moisture_knockdown", "basis_knockdown", "process_knockdown",
    "matrix_temperature_knockdown", "matrix_moisture_knockdown",
)  # fmt: skip
PURE = {f"materials.t700_epoxy.{key}": 1 for key in KNOCK_DOWNS} | {
    f"materials.t700_epoxy.{key}": value for key, value in (PLY_P | STRENGTH).items()
}
"""Ply P without knock-downs under the library's name."""
STEEL = {
    "youngs_modulus": 210e9, "poissons_ratio": 0.3, "shear_modulus": 210e9 / 2.6,
    "thermal_expansion": 12e-6,
}  # fmt: skip
PLAIN = {f"materials.steel_42crmo4.{key}": value for key, value in STEEL.items()} | {
    "materials.steel_42crmo4.yield_strength": 700e6,
    "materials.steel_42crmo4.density": 7850,
}
GRAVITY = 9.80665
SUPPLY, BORE, STROKE = 21e6, 23e-3, 110e-3
PUSH, EYE, EXTENSION, PLATE = SUPPLY * pi / 4 * BORE**2, 16e-3, 12e-3, 5e-3


def layers(*entries):
    """YAML of a rod's lay-up from (material, angle in degrees, thickness in mm)."""
    return "  layup:\n" + "".join(
        f"    - material: {name}\n      angle: {angle} deg\n      thickness: {thickness} mm\n"
        for name, angle, thickness in entries
    )


FITTING = "  fitting:\n    adhesive: epoxy_structural\n    length: 25 mm\n"
ROD = layers(("t700_epoxy", 0, 1.5), ("t700_epoxy", 45, 0.5))
LINED = ROD + "    - material: steel_42crmo4\n      thickness: 0.2 mm\n"
INNER = "  inner_diameter: 6 mm\n"


def knee(rod=INNER, *, replace=(), variables="", **options):
    """The knee with another rod; without the variable of its bore where it has layers."""
    text = KNEE.replace(INNER, rod)
    if "layup" in rod:
        first, last = (text.index(mark) for mark in ("  rod.inner_diameter:", "  piston.length:\n"))
        text = text[:first] + variables + text[last:]
    for old, new in replace:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return verbs.read(text, set=options.pop("set", {}))


def passed(actuator):
    """One pass over the models."""
    subject = actuator.subject()
    return compute(subject, subject.values())


def value(metric, place="", *, of):
    """A computed metric as a float or an array over cases."""
    return np.squeeze(np.asarray(of.computed.metrics[metric][place], dtype=float))


# --- section ---------------------------------------------------------------------------------


def test_the_checked_laminate_through_a_design():
    """[0 1.5/(+-45) 0.5] of ply P on 6 mm: EA 9.32146 MN, EI 215.4146 N m^2 (checked elsewhere).

    The stiffness of the rod is EA over its length, 138 - 14 + 5 + 12 mm.
    """
    done = passed(knee(ROD + FITTING, set=PURE | {"rod.outer_diameter": "16 mm"}))
    assert done.rod.axial_stiffness == pytest.approx(9.32146e6, rel=1e-6)
    assert done.rod.bending_stiffness == pytest.approx(215.4146, rel=5e-7)
    assert done.rod.inner_diameter == pytest.approx(12e-3, rel=1e-12)
    stiffness = value("stiffness_rod", "layered tube", of=done)
    assert stiffness == pytest.approx(9.32146e6 / 141e-3, rel=1e-6)


def test_axial_stiffness_and_expansion_against_the_independent_tube():
    """EA and axial expansion of plies under a steel sleeve, by finite elements in the radius."""
    done = passed(knee(LINED + FITTING, set=PURE | PLAIN | {"rod.outer_diameter": "16.4 mm"}))
    walls, radius = lined_tube(), 6e-3
    pulled = oracle.solve(walls, radius, axial_force=1.0).axial_strain
    warm = oracle.solve(walls, radius, temperature_change=1.0).axial_strain
    assert done.rod.axial_stiffness == pytest.approx(1 / pulled, rel=1e-9)
    assert done.rod.expansion == pytest.approx(warm, rel=1e-8)


def lined_tube():
    """The layers of `LINED` as the oracle takes them."""
    ply = oracle.Ply(
        youngs=(138e9, 9e9, 9e9), poisson=(0.28, 0.28, 0.42), shear=5e9,
        expansion=(-0.5e-6, 30e-6, 30e-6),
    )  # fmt: skip
    steel = oracle.Ply.isotropic(210e9, 0.3, 12e-6)
    return [
        oracle.Layer(ply=ply, thickness=1.5e-3),
        oracle.Layer(ply=ply, thickness=0.5e-3, angle=pi / 4),
        oracle.Layer(ply=steel, thickness=0.2e-3),
    ]


@pytest.mark.parametrize("parts", [(3.5,), (1.0, 2.1, 0.4)])
def test_a_rod_of_steel_layers_is_the_steel_rod(parts):
    """Layers of a single metal, however many, give the closed forms of the hollow metal rod."""
    layered = passed(knee(layers(*(("steel_42crmo4", 0, part) for part in parts)), set=PLAIN))
    plain = passed(knee(set=PLAIN))
    for field in (
        "inner_diameter", "axial_stiffness", "bending_stiffness", "shear_stiffness",
        "mass_per_length", "shell_modulus", "shell_ratio", "expansion",
    ):  # fmt: skip
        mine, theirs = (getattr(one.rod, field) for one in (layered, plain))
        assert mine == pytest.approx(theirs, rel=1e-9), field
    for metric in ("mass", "buckling_factor", "local_buckling_factor", "natural_frequency"):
        assert value(metric, of=layered) == pytest.approx(value(metric, of=plain), rel=1e-9), metric


def test_push_of_a_steel_layer_is_the_yield_of_the_steel_rod():
    """Without outside pressure both say yield over P/A + M d/(2 I), at the stall of the case."""
    layered = passed(knee(layers(("steel_42crmo4", 0, 3.5)), set=PLAIN))
    plain = passed(knee(set=PLAIN))
    mine = value("rod_factor", "layup[0] steel_42crmo4 yield, hot, push", of=layered)
    assert mine[0] == pytest.approx(value("yield_factor", "rod", of=plain)[0], rel=1e-9)


def test_pull_of_a_steel_layer_under_outside_pressure():
    """Von Mises of N/A, Lame's -2 p/(1 - m^2) at the bore and zero there, bending on top.

    The swing has no side load; its weight bends it. p acts inside chamber B, and raises the pull.
    """
    done = passed(knee(layers(("steel_42crmo4", 0, 3.5)), set=PLAIN))
    outer, inner = 13e-3, 6e-3
    area = pi / 4 * (outer**2 - inner**2)
    pull = SUPPLY * pi / 4 * (BORE**2 - outer**2)
    bend = float(np.squeeze(done.beam.moment)[1]) * outer / 2 / (pi / 64 * (outer**4 - inner**4))
    axial, hoop = pull / area + bend, -2 * SUPPLY / (1 - (inner / outer) ** 2)
    equivalent = sqrt(axial**2 + hoop**2 - axial * hoop)
    hot = value("rod_factor", "layup[0] steel_42crmo4 yield, hot, pull", of=done)
    cold = value("rod_factor", "layup[0] steel_42crmo4 yield, cold, pull", of=done)
    assert cold[1] == pytest.approx(700e6 / equivalent, rel=1e-9)
    assert hot[1] <= cold[1]


# --- strength of the layers --------------------------------------------------------------------


def test_an_axial_rod_of_one_ply():
    """All-0-degree rod, closed form: fibre N/A + M r/I; matrix by Lame under outside pressure.

    One ply has no cure stress. Strengths without knock-downs, cold.
    """
    done = passed(
        knee(layers(("t700_epoxy", 0, 2.0)) + FITTING, set=PURE | {"rod.outer_diameter": "16 mm"})
    )
    outer, inner = 16e-3, 12e-3
    area, inertia = pi / 4 * (outer**2 - inner**2), pi / 64 * (outer**4 - inner**4)
    bent = np.squeeze(done.beam.under(PUSH)) * outer / 2 / inertia
    drawn = np.squeeze(done.beam.moment) * outer / 2 / inertia
    pull = SUPPLY * pi / 4 * (BORE**2 - outer**2)
    name = "layup[0] t700_epoxy"
    for place, wanted in (
        (f"{name} fibre, cold, push", 1300e6 / (PUSH / area + bent)),
        (f"{name} matrix, cold, pull", 190e6 / (2 * SUPPLY / (1 - (inner / outer) ** 2))),
        (f"{name} radial, cold, pull", 190e6 / SUPPLY),
    ):
        assert value("rod_factor", place, of=done) == pytest.approx(wanted, rel=1e-6), place
    fibre = value("rod_factor", f"{name} fibre, cold, pull", of=done)
    # outside pressure pulls no fibre: no axial force comes with it
    assert fibre == pytest.approx(1900e6 / (pull / area + drawn), rel=1e-6)
    assert (value("rod_factor", f"{name} matrix, cold, push", of=done) > 1e6).all()


def test_plies_and_sleeve_against_the_independent_tube():
    """Every row of the lined rod: residual + SR load meets the strength of the oracle's stress.

    Cure at 120 degC, seen at 0 and 80 degC, max stress and von Mises, four sides of the pull (bent
    both ways, in and out of chamber B) and two of the push, at both faces of each layer.
    """
    actuator = knee(LINED + FITTING, set=PURE | PLAIN | {"rod.outer_diameter": "16.4 mm"})
    done = passed(actuator)
    rows = done.computed.metrics["rod_factor"]
    checked = set()
    for case, direction, (climate, change) in product(
        (0, 1), ("push", "pull"), (("cold", -120.0), ("hot", -40.0))
    ):
        own = {}
        for load in sides(done, case, direction):
            for label, ratio in ratios(load, change, climate == "hot", actuator):
                own[label] = min(own.get(label, math.inf), ratio)
        for label, ratio in own.items():
            place = f"{label}, {climate}, {direction}"
            found = np.atleast_1d(np.squeeze(rows[place]))[case]
            assert found == pytest.approx(ratio, rel=1e-6), place
            checked.add(place)
    assert checked == set(rows)


def stiffness_ratio(done):
    """EA/EI of the rod."""
    return float(np.squeeze(done.rod.axial_stiffness / done.rod.bending_stiffness))


def sides(done, case, direction):
    """(axial force, outside pressure) of both sides of the bent rod, in and out of the chamber."""
    outer = 16.4e-3
    share = outer / 2 * stiffness_ratio(done)
    moment = done.beam.under(PUSH) if direction == "push" else done.beam.moment
    bent = float(np.squeeze(moment)[case]) * share
    if direction == "push":
        return [(-PUSH - bent, 0.0), (bent - PUSH, 0.0)]
    pull = SUPPLY * pi / 4 * (BORE**2 - outer**2)
    return [(pull + side * bent, p) for side in (1, -1) for p in (0.0, SUPPLY)]


def ratios(load, change, hot, actuator):
    """(label, strength ratio) of every layer and group of modes at both faces."""
    walls, radius = lined_tube(), 6e-3
    loaded = oracle.solve(walls, radius, axial_force=load[0], outer_pressure=load[1])
    cured = oracle.solve(walls, radius, temperature_change=change)
    strong = 700e6 * (hot_share(actuator) if hot else 1.0)
    inner = radius
    for k, wall in enumerate(walls):
        for face in (inner, inner + wall.thickness):
            stress, rest = (one.ply_stresses(k, face) for one in (loaded, cured))
            if k == 2:
                yield "layup[2] steel_42crmo4 yield", von_mises_ratio(stress, rest, strong)
                continue
            for group, limits in (
                ("fibre", (0, 1900e6, 1300e6)),
                ("matrix", (1, 55e6, 190e6)),
                ("radial", (2, 55e6, 190e6)),
                ("shear", (3, 85e6, 85e6)),
            ):
                i, up, down = limits
                limit = up - rest[i] if stress[i] > 0 else -down - rest[i]
                yield f"layup[{k}] t700_epoxy {group}", limit / stress[i] if stress[i] else math.inf
        inner += wall.thickness


def hot_share(actuator):
    """Share of the steel's strength left at 80 degC: linear from 23 degC to its knock-down."""
    numbers = load_library().get("steel_42crmo4").numbers
    if "temperature_knockdown" not in numbers:
        return 1.0
    span = numbers["knockdown_temperature"] - 296.15
    return 1 - (1 - numbers["temperature_knockdown"]) * (353.15 - 296.15) / span


def von_mises_ratio(stress, rest, strength):
    """SR where von Mises of rest + SR stress reaches the strength: root of its quadratic."""

    def form(a, b):
        normal = sum((a[i] - a[j]) * (b[i] - b[j]) for i, j in ((0, 1), (1, 2), (2, 0)))
        return normal / 2 + 3 * a[3] * b[3]

    square, half = form(stress, stress), form(stress, rest)
    return (sqrt(half**2 + square * (strength**2 - form(rest, rest))) - half) / square


def test_cycles_of_the_metals_by_hand():
    """From push to pull: (push + pull)/A of a bar; a layer feels the outside pressure too.

    A steel layer alone has no cure stress: at its bore Lame's -2 p/(1 - m^2) comes with the pull,
    von Mises of the difference of both ends is its range, of the pull less half of it its mean.
    """
    outer, inner = 13e-3, 6e-3
    area = pi / 4 * (outer**2 - inner**2)
    pull = SUPPLY * pi / 4 * (BORE**2 - outer**2)
    bar, layered = (knee(rod, set=PLAIN) for rod in (INNER, layers(("steel_42crmo4", 0, 3.5))))
    found = {}
    for actuator in (bar, layered):
        run = passed(actuator)
        found |= rod_strength.cycles(actuator.design, run.geometry, run.rods, SUPPLY, PUSH, pull)
    assert found["rod"].material == "steel_42crmo4"
    assert found["rod"].span == pytest.approx((PUSH + pull) / area, rel=1e-12)
    assert found["rod"].mean == 0
    hoop, range_, top = -2 * SUPPLY / (1 - (inner / outer) ** 2), (PUSH + pull) / area, pull / area
    span, drawn = (sqrt(axial**2 + hoop**2 - axial * hoop) for axial in (range_, top))
    layer = found["rod, layup[0] steel_42crmo4"]
    assert float(np.squeeze(layer.span)) == pytest.approx(span, rel=1e-9)
    assert float(np.squeeze(layer.mean)) == pytest.approx(max(drawn - span / 2, 0), rel=1e-9)


def test_criterion_of_the_design_judges_the_rod():
    """Another criterion changes the rod's rows; its name stands behind the number."""
    text = ("barrel:\n", "barrel:\n  criterion: tsai_wu\n")
    evaluation = verbs.evaluate(knee(ROD + FITTING, replace=[text]))
    assert evaluation.metrics["rod_factor"].model == "strength.tsai_wu_modes"
    assert evaluation.metrics["rod_factor"].place.startswith("layup[")


def test_both_plies_of_a_pair_count_where_the_rod_twists():
    """A single +30 ply twists the rod: of the pair under it the worse ply governs."""
    single = (
        layers(("t700_epoxy", 45, 1.0))
        + "    - material: t700_epoxy\n      angle: 30 deg\n      balanced: false\n"
        + "      thickness: 1.0 mm\n"
    )
    done = passed(
        knee(single + FITTING, set=PURE | {"rod.outer_diameter": "16 mm"},
             replace=[("  cure_temperature: 120 degC\n", "")])
    )  # fmt: skip
    ply = oracle.Ply(youngs=(138e9, 9e9, 9e9), poisson=(0.28, 0.28, 0.42), shear=5e9)
    walls = [
        oracle.Layer(ply=ply, thickness=1e-3, angle=pi / 4),
        oracle.Layer(ply=ply, thickness=1e-3, angle=pi / 6, balanced=False),
    ]
    share = 8e-3 * stiffness_ratio(done)
    force = -PUSH - float(np.squeeze(done.beam.under(PUSH))[0]) * share
    state = oracle.solve(walls, 6e-3, axial_force=force)
    fibre = {sign: min(state.ply_stresses(0, r, sign)[0] for r in (6e-3, 7e-3)) for sign in (1, -1)}
    assert fibre[1] != pytest.approx(fibre[-1], rel=1e-3)
    found = value("rod_factor", "layup[0] t700_epoxy fibre, push", of=done)[0]
    assert found == pytest.approx(1300e6 / -min(fibre.values()), rel=1e-6)


# --- bending, column, local buckling ------------------------------------------------------------


def weight_moment(done, reach=STROKE):
    """Largest moment along the exposed rod by summing weights left of many sections."""
    parts = done.mass_parts
    line = float(np.squeeze(done.rod.mass_per_length))
    first, second = EYE + 2 * PLATE + 138e-3, reach + EXTENSION + EYE
    total = sum(float(np.squeeze(part)) for name, part in parts.items() if name != "clevises")
    area_b = pi / 4 * (BORE**2 - float(np.squeeze(done.rod.outer_diameter)) ** 2)
    oil = 6e-6 + pi / 4 * BORE**2 * reach + area_b * (110e-3 - reach)
    density = load_library().get("iso_vg_32").numbers["density"]
    heavy = GRAVITY * (total - line * (reach + EXTENSION) + density * oil) / first
    light = GRAVITY * line
    x = np.linspace(0, first + second, 200001)
    left, right = np.minimum(x, first), np.maximum(x - first, 0)
    own = heavy * left * (x - left / 2) + light * right**2 / 2
    return float((own[-1] * x / x[-1] - own)[x >= first].max())


def test_yield_of_the_metal_rod_by_hand():
    """Axial stress, side load at the bearing and own weight, grown by 1/(1 - P/P_cr), each case.

    Stance pushes with 30 N across, 110 + 12 + 16 + (14 + 5)/2 mm from the bearing's middle; swing
    pulls: nothing grows.
    """
    done = passed(knee(set=PLAIN))
    outer, inner = 13e-3, 6e-3
    area, inertia = pi / 4 * (outer**2 - inner**2), pi / 64 * (outer**4 - inner**4)
    critical = float(np.squeeze(done.beam.critical))
    own = weight_moment(done)
    stance = PUSH / area + (30 * 147.5e-3 + own) / (1 - PUSH / critical) * outer / 2 / inertia
    swing = SUPPLY * pi / 4 * (BORE**2 - outer**2) / area + own * outer / 2 / inertia
    strength = 700e6 * hot_share(None)
    found = value("yield_factor", "rod", of=done)
    assert found == pytest.approx([strength / stance, strength / swing], rel=1e-6)


def test_a_moment_grows_on_smoothly_beyond_three_quarters_of_the_critical_load():
    """1/(1 - P/P_cr) up to 0.75, its tangent beyond: value and slope join, nothing is infinite."""
    beam = passed(knee(set=PLAIN)).beam
    critical, moment = float(np.squeeze(beam.critical)), np.squeeze(beam.moment)
    for share, factor in ((0.3, 1 / 0.7), (0.75, 4.0), (1.0, 8.0), (3.0, 40.0)):
        assert np.squeeze(beam.under(share * critical)) == pytest.approx(factor * moment, rel=1e-12)
    below, at, above = (np.squeeze(beam.under((0.75 + d) * critical)) for d in (-1e-6, 0, 1e-6))
    assert above - at == pytest.approx(at - below, rel=1e-4)


def test_a_rod_far_beyond_buckling_has_finite_numbers_and_says_so():
    """Stroke of 1.2 m: the column fails below its push; every factor is finite, with a warning."""
    for rod in (INNER, ROD + FITTING):
        actuator = knee(rod, set={"cylinder.stroke": "1200 mm", "rod.outer_diameter": "10 mm"})
        done = passed(actuator)
        assert value("buckling_factor", of=done) < 1
        for metric in ("yield_factor", "rod_factor", "local_buckling_factor"):
            for place, array in done.computed.metrics.get(metric, {}).items():
                assert not np.isnan(array).any(), (metric, place)
        assert any("of the buckling load" in text for text in verbs.evaluate(actuator).warnings)


@pytest.mark.parametrize("reach", ["0 %", "40 %"])
def test_a_retracted_rod_that_shows_nothing_has_no_pole(reach):
    """No clevis, no extension, piston retracted: column and weight stay finite."""
    clevis = "clevis:\n  material: steel_42crmo4\n  pin_diameter: 8 mm\n"
    force = "    force: 6 kN\n"
    actuator = knee(
        replace=[
            (clevis, ""),
            ("  extension: 12 mm\n", ""),
            (force, f"{force}    position: {reach}\n"),
        ]
    )
    for mount in ("cap_clevis", "head_flange", "head_trunnion", "cap_flange"):
        done = passed(actuator.changed({"cylinder.mount": mount}))
        for metric in ("buckling_factor", "yield_factor", "local_buckling_factor"):
            for array in done.computed.metrics[metric].values():
                assert np.isfinite(array).all(), (mount, metric)


def test_weight_of_an_actuator_held_at_its_head():
    """Flange: w L^2/8 of the rod; trunnion: the barrel's W L/2 behind it where that is more."""
    light = {}
    for mount in ("head_flange", "head_trunnion"):
        done = passed(
            knee(set=PLAIN | {"cylinder.mount": mount, "load_cases[stance].side_load": 0})
        )
        light[mount] = float(np.ravel(done.beam.moment)[0])
    line = 7850 * pi / 4 * (13e-3**2 - 6e-3**2)
    assert light["head_flange"] == pytest.approx(GRAVITY * line * 138e-3**2 / 8, rel=1e-9)
    parts = sum(float(np.squeeze(p)) for n, p in done.mass_parts.items() if n != "clevises")
    oil = 6e-6 + pi / 4 * BORE**2 * 110e-3
    oil *= load_library().get("iso_vg_32").numbers["density"]
    behind = GRAVITY * (parts - line * 122e-3 + oil) * 164e-3 / 2
    assert light["head_trunnion"] == pytest.approx(behind, rel=1e-9)


@pytest.mark.parametrize("mount", ["cap_clevis", "cap_flange"])
def test_the_column_of_barrel_and_laminated_rod_gives_in_shear(mount):
    """Never above the stepped Euler column, whose bending stiffnesses it has; S as of the parts."""
    done = passed(
        knee(LINED + FITTING, set={"rod.outer_diameter": "16.4 mm", "cylinder.mount": mount})
    )
    euler = stepped.stepped_column_load(
        bending_stiffness_1=done.wall.bending_stiffness,
        length_1=EYE + 2 * PLATE + 138e-3,
        bending_stiffness_2=done.rod.bending_stiffness,
        length_2=STROKE + EXTENSION + EYE,
        ends=("pinned" if mount == "cap_clevis" else "fixed", "pinned"),
    )
    load = value("buckling_factor", of=done) * PUSH
    assert load < euler
    assert 1 / load - 1 / float(np.squeeze(euler)) < 1 / min(shears(done))


def shears(done):
    """Kappa G A of barrel and rod."""
    return [float(np.squeeze(part.shear_stiffness)) for part in (done.wall, done.rod)]


def test_the_pinned_column_with_shear_against_its_exact_condition():
    """Timoshenko's column: M = P w, w'' = -P w/(EI (1 - P/S)), w and (1 - P/S) w' join.

    [derived] its first load is the root of sum (1 - P/S_i) k_i cot(k_i L_i) = 0; ours is within
    0.05 % of it; taking the shear of one part for the other would be 0.3 % off, none 3 %.
    """
    done = passed(knee(LINED + FITTING, set={"rod.outer_diameter": "16.4 mm"}))
    stiff = [float(np.squeeze(part.bending_stiffness)) for part in (done.wall, done.rod)]
    long = (EYE + 2 * PLATE + 138e-3, STROKE + EXTENSION + EYE)

    def exact(soft):
        def mismatch(load):
            total = 0.0
            for bend, length, shear in zip(stiff, long, soft, strict=True):
                turn = 1 - load / shear
                wave = sqrt(load / (bend * turn))
                total += turn * wave / tan(wave * length)
            return total

        low = 100.0
        while mismatch(1.01 * low) > 0:
            low *= 1.01
        return brentq(mismatch, low, 1.01 * low)

    load = value("buckling_factor", of=done) * PUSH
    assert load == pytest.approx(exact(shears(done)), rel=5e-4)
    assert load != pytest.approx(exact(shears(done)[::-1]), rel=2e-3)
    assert load != pytest.approx(exact([1e12, 1e12]), rel=2e-2)


def test_the_pinned_rod_of_a_head_trunnion():
    """Uniform pinned column, exact: 1/P = (L/pi)^2/EI + 1/(kappa G A) with Cowper's kappa."""
    load = passed(knee(set=PLAIN | {"cylinder.mount": "head_trunnion"}))
    outer, inner, length, modulus = 13e-3, 6e-3, STROKE + EXTENSION + EYE, 210e9
    inertia, area = pi / 64 * (outer**4 - inner**4), pi / 4 * (outer**2 - inner**2)
    m, nu = (inner / outer) ** 2, 0.3
    kappa = 6 * (1 + nu) * (1 + m) ** 2 / ((7 + 6 * nu) * (1 + m) ** 2 + (20 + 12 * nu) * m)
    soft = (length / pi) ** 2 / (modulus * inertia) + 1 / (kappa * modulus / 2.6 * area)
    assert value("buckling_factor", of=load) == pytest.approx(1 / soft / PUSH, rel=1e-9)


def shell(modulus, ratio, thickness, radius):
    """Force and moment at which a tube's wall buckles, NASA SP-8007 written out; Brazier too."""
    base = modulus * thickness / radius / sqrt(3 * (1 - ratio**2))
    wave = 1 - exp(-sqrt(radius / thickness) / 16)
    flat = 2 * sqrt(2) * pi / 9 * modulus * radius * thickness**2 / sqrt(1 - ratio**2)
    bent = pi * radius**2 * thickness * (1 - 0.731 * wave) * base
    return 2 * pi * radius * thickness * (1 - 0.901 * wave) * base, min(bent, flat)


def test_local_buckling_of_a_thin_steel_rod_by_hand():
    """Push and moment together, P/P_cr + M/M_cr, for a wall of 1 mm on 13 mm."""
    done = passed(knee(set=PLAIN | {"rod.inner_diameter": "11 mm"}))
    force, moment = shell(210e9, 0.3, 1e-3, 6e-3)
    bent = np.squeeze(done.beam.under(PUSH))
    wanted = 1 / (PUSH / force + bent / moment)
    assert value("local_buckling_factor", of=done) == pytest.approx(wanted, rel=1e-9)


def test_local_buckling_of_a_laminated_rod_by_hand():
    """[0 1.5/(+-45) 0.5] of ply P: moduli of the membrane, E of the softer of rings or diamonds.

    Of a pair the exact tube keeps 2e-5 more shear stiffness than plies free to thicken each.
    """
    done = passed(knee(ROD + FITTING, set=PURE | {"rod.outer_diameter": "16 mm"}))
    q11, q22 = (e / (1 - 0.28**2 * 9 / 138) for e in (138e9, 9e9))
    q12, q66 = 0.28 * q22, 5e9
    slanted = (q11 + q22 + 2 * q12 + 4 * q66) / 4, (q11 + q22 + 2 * q12 - 4 * q66) / 4
    shear = 0.75 * q66 + 0.25 * (q11 + q22 - 2 * q12) / 4
    a, d, b = (
        0.75 * x + 0.25 * y for x, y in zip((q11, q22, q12), (slanted[0], *slanted), strict=True)
    )
    ratio = sqrt(b * b / (a * d))
    mean = sqrt((a - b * b / d) * (d - b * b / a))
    modulus = min(mean, sqrt(mean * 2 * shear * (1 + ratio)))
    force, moment = shell(modulus, ratio, 2e-3, 7e-3)
    wanted = 1 / (PUSH / force + np.squeeze(done.beam.under(PUSH)) / moment)
    assert value("local_buckling_factor", of=done) == pytest.approx(wanted, rel=1e-4)


def test_a_solid_rod_has_no_wall_to_buckle():
    """Solid and fixed so: skipped with its reason; a bore that may move is checked at any size."""
    moved = "  rod.inner_diameter:\n    lower: 2 mm\n    upper: 25 mm\n"
    solid = knee(replace=[(INNER, ""), (moved, "")])
    assert verbs.evaluate(solid).metrics["local_buckling_factor"].why == "the rod is solid"
    assert np.isfinite(value("local_buckling_factor", of=passed(knee()))).all()


# --- ends ----------------------------------------------------------------------------------------


def lap(force, tube, plug, strains, length=25e-3, shear=1.2e9, bond=0.15e-3, diameter=11.6e-3):
    """Largest shear at each edge of the tube on its plug, by collocation: (plug ends, tube ends).

    u_i' = N_i/EA_i + e_i, the bond pulls t pi D; the tube carries the force where the plug ends.
    """
    around, lag, scale = pi * diameter, shear / bond, 1e4

    def slopes(x, y):
        pull = around * lag * (y[2] - y[0])
        first = (y[1] * scale / tube + strains[0]) * length
        second = (y[3] * scale / plug + strains[1]) * length
        return np.array([first, -pull * length / scale, second, pull * length / scale])

    def ends(a, b):
        return np.array([a[0], a[1] - force / scale, a[3], b[1]])

    found = solve_bvp(slopes, ends, np.linspace(0, 1, 200), np.zeros((4, 200)), tol=1e-9,
                      max_nodes=20000)  # fmt: skip
    assert found.success
    shears = lag * (found.y[2] - found.y[0])
    return shears[0], shears[-1]


@pytest.mark.parametrize("wall", [None, 2e-3])
def test_bonded_fittings_against_a_numerical_lap(wall):
    """Both edges of a steel plug or sleeve in the tube, under the push, in cold and heat."""
    sleeve = "" if wall is None else f"    wall: {1e3 * wall} mm\n"
    done = passed(knee(LINED + FITTING + sleeve, set=PLAIN | {"rod.outer_diameter": "16 mm"}))
    bore = 11.6e-3
    hole = 0.0 if wall is None else bore - 2 * wall
    plug = 210e9 * pi / 4 * (bore**2 - hole**2)
    tube, along = (float(np.squeeze(x)) for x in (done.rod.axial_stiffness, done.rod.expansion))
    glue = load_library().get("epoxy_structural").numbers
    dry = glue["bond_strength"] * glue["basis_knockdown"] * glue["moisture_knockdown"]
    hot = dry * (1 - (1 - glue["temperature_knockdown"]))
    near, far = lap(PUSH, tube, plug, (0.0, 0.0))
    for place, stress in (("bond at the fitting's edge", near), ("bond at the tube's edge", far)):
        assert value("fitting_factor", place, of=done) == pytest.approx(hot / stress, rel=1e-4)
    for word, strength, change in (("cold", dry, -20.0), ("hot", hot, 60.0)):
        near, far = lap(0.0, tube, plug, (along * change, 12e-6 * change))
        assert near == pytest.approx(-far, rel=1e-6)
        found = value("bond_thermal_factor", f"rod fittings, {word}", of=done)
        assert found == pytest.approx(strength / abs(near), rel=1e-4)


def test_caps_bond_over_the_temperatures_by_hand():
    """Shear (G/t_a) d_alpha dT tanh(b L/2)/b, b^2 = (G/t_a)(1/K_1 + 1/K_2): the caps."""
    done = passed(knee())
    library = load_library()
    cap = library.get("al_7075_t6").numbers
    lag = 1.2e9 / 0.15e-3
    inner, outer = (float(np.squeeze(size)) for size in (done.geometry.inner_radius,
                                                         done.geometry.outer_radius))  # fmt: skip
    skirt = cap["youngs_modulus"] * 1.5e-3 * (outer + 0.75e-3) / outer  # at the bond's radius
    barrel = float(np.squeeze(done.wall.axial_line_stiffness)) * (inner + outer) / (2 * outer)
    decay = sqrt(lag * (1 / skirt + 1 / barrel))
    gap = cap["thermal_expansion"] - float(np.squeeze(done.wall.expansion[0]))
    glue = library.get("epoxy_structural").numbers
    strength = glue["bond_strength"] * glue["basis_knockdown"] * glue["moisture_knockdown"]
    for word, change, left in (("cold", -20.0, 1.0), ("hot", 60.0, glue["temperature_knockdown"])):
        stress = lag * gap * abs(change) * tanh(decay * 20e-3 / 2) / decay
        found = value("bond_thermal_factor", f"caps, {word}", of=done)
        assert found == pytest.approx(strength * left / stress, rel=1e-9)


def test_force_and_temperature_on_a_bond_are_told_together():
    """Where the two elastic shears together exceed the strength, a sentence gives their sum."""
    evaluation = verbs.evaluate(knee(LINED + FITTING, set={"rod.outer_diameter": "16 mm"}))
    told = [text for text in evaluation.warnings if "add up to" in text]
    assert len(told) == 1
    metrics = evaluation.metrics
    total = 1 / metrics["fitting_factor"].value + 1 / metrics["bond_thermal_factor"].value
    assert metrics["bond_thermal_factor"].place.startswith("rod fittings")
    assert told[0].startswith("bond of the rod fittings")
    assert f"{total:.2f} times" in told[0]


def test_thread_and_yield_of_a_fitting_are_of_its_own_metal():
    """Titanium fittings: thread root and sleeve section take titanium's strength, not the rod's."""
    fitting = FITTING + "    wall: 2 mm\n    material: ti_6al4v\n"
    size = {"rod.outer_diameter": "16 mm"}
    steel = passed(knee(LINED + FITTING + "    wall: 2 mm\n", set=size))
    titanium = passed(knee(LINED + fitting, set=size))
    library = load_library()
    left = {}
    for name in ("steel_42crmo4", "ti_6al4v"):
        known = library.get(name).numbers
        span = known.get("knockdown_temperature", 1e9) - 296.15
        hot = 1 - (1 - known.get("temperature_knockdown", 1.0)) * (353.15 - 296.15) / span
        basis = library.get(name).properties["yield_strength"].basis
        share = known.get("basis_knockdown", 1.0) if basis in ("typical", "mean") else 1.0
        left[name] = known["yield_strength"] * hot * share
    ratio = left["ti_6al4v"] / left["steel_42crmo4"]
    for metric, place in (("thread_factor", ""), ("yield_factor", "rod fitting")):
        mine, theirs = (value(metric, place, of=one) for one in (titanium, steel))
        assert mine / theirs == pytest.approx(ratio, rel=1e-9)
    area = pi / 4 * (11.6e-3**2 - 7.6e-3**2)
    stress = PUSH / area
    assert value("yield_factor", "rod fitting", of=steel) == pytest.approx(
        left["steel_42crmo4"] / stress, rel=1e-9
    )


def test_a_sleeve_that_fills_the_bore_is_a_plug():
    """Sleeve walls from the bore's radius on give what a solid fitting gives, in every number."""
    size = {"rod.outer_diameter": "16 mm"}
    plug, sleeve = (
        passed(knee(LINED + FITTING + wall, set=size)) for wall in ("", "    wall: 5.8 mm\n")
    )
    for metric, places in plug.computed.metrics.items():
        for place, array in places.items():
            found = sleeve.computed.metrics[metric][place]
            assert np.asarray(found) == pytest.approx(np.asarray(array), rel=1e-9), (metric, place)


# --- weight, drawing, manufacture ---------------------------------------------------------------


@pytest.mark.parametrize("wall", [None, 2.0])
def test_weight_of_a_laminated_rod_by_hand(wall):
    """Layers 0 and 45 of carbon, steel sleeve, over 141 mm; two fittings, stud and end plugs.

    Radii 5.8 | 7.3 | 7.8 | 8.0 mm; stud M10 x 1.25 of pitch diameter 9.188 mm, 10 mm long. A sleeve
    of 2 mm holds a plug of 10 mm at either end; a solid fitting has none beside itself.
    """
    sleeve = "" if wall is None else f"    wall: {wall} mm\n"
    density = {"materials.t700_epoxy.density": 1570, "materials.steel_42crmo4.density": 7850}
    done = passed(knee(LINED + FITTING + sleeve, set=density | {"rod.outer_diameter": "16 mm"}))
    carbon, steel = 1.57e-3, 7.85e-3  # g/mm3
    rod = 141 * pi * (carbon * (7.8**2 - 5.8**2) + steel * (8.0**2 - 7.8**2))
    assert 1e3 * float(np.squeeze(done.mass_parts["rod"])) == pytest.approx(rod, rel=1e-9)
    pitch = 10 - 3 * sqrt(3) / 8 * 1.25
    stud, plugs = pi / 4 * pitch**2 * 10, 2 * 25 * pi * 5.8**2
    if wall is not None:
        plugs = 2 * 25 * pi * (5.8**2 - 3.8**2) + 2 * 10 * pi * 3.8**2
    ends = steel * (stud + plugs)
    assert 1e3 * float(np.squeeze(done.mass_parts["fastening"])) == pytest.approx(ends, rel=1e-9)


def test_the_drawing_shows_layers_and_fittings():
    """Each layer and the fittings are outlines; turned about the axis they weigh the rod's mass."""
    evaluation = verbs.evaluate(knee(LINED + FITTING, set={"rod.outer_diameter": "16 mm"}))
    shown = {o.part: o for o in evaluation.outlines if o.part.startswith("rod.")}
    assert list(shown) == ["rod.layup[0]", "rod.layup[1]", "rod.layup[2]", "rod.fitting"]
    kinds = [outline.kind for outline in shown.values()]
    assert kinds == ["composite", "composite", "metal", "metal"]
    library = load_library()
    drawn = 0.0
    for outline in shown.values():
        if outline.part != "rod.fitting":
            density = library.get(outline.material).numbers["density"]
            drawn += density * sum(turned(polygon) for polygon in outline.polygons)
    assert drawn == pytest.approx(evaluation.mass_parts["rod"], rel=1e-9)
    plugs = sum(turned(polygon) for polygon in shown["rod.fitting"].polygons)
    assert plugs == pytest.approx(2 * 25e-3 * pi * 5.8e-3**2, rel=1e-9)
    assert drawing.section(evaluation).items


def turned(polygon):
    """Volume of a rectangle (x, r) turned about the axis."""
    xs, rs = [p[0] for p in polygon], [p[1] for p in polygon]
    return pi * (max(rs) ** 2 - min(rs) ** 2) * (max(xs) - min(xs))


def test_the_process_sets_least_angle_and_thickness():
    """T700 tape: 10 deg and 0.2 mm; layers at exactly 0 deg are laid and have no angle limit."""
    rod = layers(("t700_epoxy", 0, 1.5), ("t700_epoxy", 8, 0.5), ("t700_epoxy", 45, 0.15))
    evaluation = verbs.evaluate(knee(rod + FITTING, set={"rod.outer_diameter": "16 mm"}))
    done = passed(knee(rod + FITTING, set={"rod.outer_diameter": "16 mm"}))
    angles, spare = (
        done.computed.metrics[f"{name}_margin"] for name in ("winding", "ply_thickness")
    )
    assert set(angles) == {"barrel.layup[1]", "barrel.layup[2]", "rod.layup[1]", "rod.layup[2]"}
    assert math.degrees(angles["rod.layup[1]"]) == pytest.approx(-2.0)
    assert math.degrees(angles["barrel.layup[2]"]) == pytest.approx(15.0)
    assert spare["rod.layup[2]"] == pytest.approx(0.15 / 0.2 - 1)
    assert "barrel.layup[0]" not in spare
    missed = {c.name for c in evaluation.checks if c.status == "missed"}
    assert {
        "winding angles", "layer thicknesses"
    } <= missed  # fmt: skip
    moved = "  rod.layup[0].angle:\n    lower: 0 deg\n    upper: 30 deg\n"
    free = knee(rod + FITTING, variables=moved, set={"rod.outer_diameter": "16 mm"})
    wound = passed(free).computed.metrics["winding_margin"]
    assert math.degrees(wound["rod.layup[0]"]) == pytest.approx(-10.0)


def test_what_does_not_apply_says_why():
    """A metal rod has no plies and no fittings; a rod without temperatures no thermal shear."""
    metrics = verbs.evaluate(knee()).metrics
    assert "a single metal" in metrics["rod_factor"].why
    assert "no bonded fittings" in metrics["fitting_factor"].why
    first, last = KNEE.index("environment:"), KNEE.index("cylinder:\n")
    bare = verbs.evaluate(verbs.read(KNEE[:first] + KNEE[last:]))
    assert "add environment" in bare.metrics["bond_thermal_factor"].why
    warned = verbs.evaluate(
        knee(ROD + FITTING, replace=[("  cure_temperature: 120 degC\n", "")])
    ).warnings
    assert any("rod's layers exclude cooling stresses" in text for text in warned)


# --- in the optimiser ----------------------------------------------------------------------------

GENTLE = (
    ("  pressure: 210 bar", "  pressure: 100 bar"),
    ("  return_pressure: 5 bar", "  return_pressure: 2 bar"),
    ("    force: 6 kN", "    force: 2.2 kN"),
    ("    force: 4 kN", "    force: 1.3 kN"),
    ("    min: 10 kN/mm", "    min: 6 kN/mm"),
    ("  trapped_rise: 8 K", "  trapped_rise: 4 K"),
    ("waivers:\n", "materials:\n  epoxy_structural:\n    bond_thickness: 0.4 mm\n\nwaivers:\n"),
)
MOVED = """\
  rod.layup[0].thickness:
    lower: 0.3 mm
    upper: 6 mm
  rod.layup[1].thickness:
    lower: 0.1 mm
    upper: 2 mm
  rod.layup[1].angle:
    lower: 5 deg
    upper: 80 deg
  rod.fitting.length:
    lower: 5 mm
    upper: 60 mm
"""


@pytest.fixture(scope="module")
def gentle():
    """The knee at 100 bar with a laminated rod, steel sleeve and titanium fittings."""
    rod = LINED + FITTING + "    material: ti_6al4v\n"
    return knee(rod, replace=GENTLE, variables=MOVED, set={"rod.outer_diameter": "16 mm"})


def test_rows_of_the_rod_have_exact_slopes(gentle):
    """Complex-step slopes of every row equal central differences, inside and beyond buckling."""
    problem = build(gentle.subject()).problem
    for scale in (1.0, 0.62):
        point = problem.start.copy()
        point[problem.names.index("rod.outer_diameter")] *= scale
        batch = np.repeat(point.astype(complex)[:, None], len(point), axis=1)
        batch[np.arange(len(point)), np.arange(len(point))] += 1e-30j * point
        exact = problem.rows(batch).imag / 1e-30
        steps = 1e-6 * np.diag(point)
        both = [problem.rows(point[:, None] + side * steps) for side in (1, -1)]
        numeric = (both[0] - both[1]) / 2e-6
        size = np.abs(numeric).max(axis=1, keepdims=True) + 1e-3
        labels = ["objective", *problem.constraint_names]
        worst = (np.abs(exact - numeric) / size).max(axis=1)
        mine = [i for i, name in enumerate(labels) if "rod" in name or "bond" in name]
        assert len(mine) > 40
        for i in mine:
            assert worst[i] < 2e-4, (labels[i], worst[i])


@pytest.mark.long
def test_a_laminated_rod_is_optimised(gentle):
    """Optimal, feasible, stationary; the rod's own limits are active, and each costs mass.

    Looser by a tenth, the limit of the fittings' bond or of the column gives a lighter actuator.
    """
    best = verbs.optimise(gentle, starts=3, prices=False)
    assert best.status == "optimal"
    assert best.kkt.residual <= 1e-6
    assert not [c.name for c in best.evaluation.checks if c.status == "missed"]
    active = " ".join(best.kkt.active)
    assert "bonded rod fittings" in active
    assert "buckling_factor" in active
    assert "layer thicknesses (rod.layup[1])" in active
    start = verbs.Actuator(best.design)
    for path, limit in (
        ("requirements.fitting_factor.min", 1.35), ("requirements.buckling_factor.min", 3.15)
    ):  # fmt: skip
        again = verbs.optimise(start.changed({path: limit}), starts=1, prices=False)
        assert again.status == "optimal", path
        assert again.objective_value < best.objective_value * (1 - 1e-4), path
