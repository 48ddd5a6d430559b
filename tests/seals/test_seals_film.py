"""Running films of an evaluation against the film solver called by hand, and their gradients.

The contact is built here from the numbers stated in `seal_designs` with the second calculation's
profiles; only the film solver itself is the package's (it has its own tests).
"""

from __future__ import annotations

from math import exp, log10, pi, sqrt

import numpy as np
import pytest
import seal_oracle as oracle
from seal_designs import KINDS, O_RING, STEP, U_CUP, evaluated, metrics, subject, text
from test_seals import BLOCK, BORE, DRAIN, MODULUS, PULL, ROD, STEP_NUMBERS, SUPPLY, W, growth, lip

import actuator_opt as ao
from actuator_opt.evaluation import compute, film as films
from actuator_opt.lubrication import (
    Contact,
    Elastic,
    Lubricant,
    Surface,
    TandemSeal,
    solve_film,
    solve_tandem,
)
from actuator_opt.optimisation.actuator import build

NODES = 121
AIR = oracle.ATMOSPHERE
SPEEDS = {"push": 0.1, "pull": 0.3}
STROKE = 0.12


def near(expected, rel=1e-6):
    """Two calculations of one formula."""
    return pytest.approx(expected, rel=rel)


def viscosity(degrees):
    """ISO VG 46, 46 and 6.76 mm2/s at 40 and 100 degC by ASTM D341; 875 kg/m3 at 15 degC."""
    level = [log10(log10(nu + 0.7)) for nu in (46.0, 6.76)]
    at = [log10(273.15 + t) for t in (40, 100)]
    slope = (level[1] - level[0]) / (at[1] - at[0])
    nu = 10 ** (10 ** (level[0] + slope * (log10(273.15 + degrees) - at[0]))) - 0.7
    return nu * 1e-6 * 875 / (1 + 7.7e-4 * (degrees - 15))


OIL = Lubricant(viscosity(45))
ROUGH = {"piston": 0.3e-6, "rod": 0.25e-6}
FACES = {  # roughness, summit radius and density, friction of the asperities, E, Poisson's ratio
    "o_ring": (0.8e-6, 1e-6, 1e14, 0.25, MODULUS, 0.495),
    "u_cup": (0.7e-6, 1.2e-6, 9e13, 0.22, lip(ROD, 1)["modulus"], 0.48),
    "step_ring": (0.8e-6, 1e-6, 1e14, 0.10, STEP_NUMBERS["modulus"], 0.46),
    "compact": (0.8e-6, 1e-6, 1e14, 0.25, BLOCK, 0.495),
}


def profile(kind, place, grown, pressure):
    """Width and gauge profile of a type under a pressure."""
    if kind == "o_ring":
        load, width, _ = oracle.o_ring(0.15 - grown / W, W, MODULUS, pressure)
        return width, oracle.o_ring_pressure(load, width, pressure, NODES)
    if kind == "u_cup":
        one = lip(BORE, -1) if place == "piston" else lip(ROD, 1)
        bite = (6e-3 * 0.09 - grown) / 2
        load = oracle.lip_load(one, bite, pressure)
        width = oracle.lip_width(load, oracle.lip_peak(one, bite, pressure), pressure, 5e-3)
        return width, oracle.lip_pressure(load, width, pressure, NODES)
    if kind == "step_ring":
        load, width = oracle.step_ring(STEP_NUMBERS, 0.15 - grown / W, pressure)
    else:
        load, width = oracle.block(0.1 - grown / 5e-3, 5e-3, 6e-3, BLOCK, 0.495, pressure, 10e-3)
    return width, oracle.land_pressure(load, width, pressure, NODES)


def static(kind, place="rod", grown=0.0):
    """Width and absolute profile over the pressures of both sides, either the higher."""

    def between(sealed, outer):
        width, over = profile(kind, place, grown, abs(sealed - outer))
        return width, min(sealed, outer) + (over if sealed >= outer else over[::-1])

    return between


def surface(kind, place):
    """Both surfaces together, and the rod's share."""
    own, radius, density, *_ = FACES[kind]
    both = sqrt(own**2 + ROUGH[place] ** 2)
    return Surface(both, density, radius, (ROUGH[place] / both) ** 2)


def elastic(kind):
    """The sliding face."""
    return Elastic(FACES[kind][4], FACES[kind][5])


def film(kind, place, speed, sealed, outer, grown=0.0, oil=OIL):
    """One film at absolute pressures; the speed is positive towards the outer side."""
    width, pressures = static(kind, place, grown)(sealed, outer)
    found = solve_film(
        Contact(
            width=width, static_pressure=pressures, elastic=elastic(kind),
            surface=surface(kind, place), lubricant=oil, speed=speed, sealed_pressure=sealed,
            outer_pressure=outer,
        )
    )  # fmt: skip
    assert found.converged
    return found


def drag(found, kind, diameter):
    """Friction on the counterface, against its motion."""
    viscous = found.viscous_drag * np.sign(found.contact.speed)
    return pi * diameter * (viscous + FACES[kind][3] * found.contact_load)


def dry_load(kind, place, grown, pressure):
    """Line load without oil between the faces."""
    if kind == "o_ring":
        return oracle.o_ring(0.15 - grown / W, W, MODULUS, pressure)[0]
    if kind == "u_cup":
        one = lip(BORE, -1) if place == "piston" else lip(ROD, 1)
        return oracle.lip_load(one, (6e-3 * 0.09 - grown) / 2, pressure)
    if kind == "step_ring":
        return oracle.step_ring(STEP_NUMBERS, 0.15 - grown / W, pressure)[0]
    return oracle.block(0.1 - grown / 5e-3, 5e-3, 6e-3, BLOCK, 0.495, pressure, 10e-3)[0]


CASES = {  # driven, p_B driving, p_B on the way back, direction of the rod
    "push": (SUPPLY, DRAIN, SUPPLY, 1),
    "pull": (PULL, PULL, DRAIN, -1),
}


@pytest.mark.parametrize(
    "kind",
    [pytest.param(x, marks=[pytest.mark.long] if x == "compact" else []) for x in KINDS],
)
def test_rod_film_is_the_solved_one(kind):
    """Friction, thickness, double-stroke leakage and breakaway of a rod seal of each type."""
    lubed = metrics(f"{O_RING}, count: 1", f"{KINDS[kind]}, friction: film")
    dry = metrics(f"{O_RING}, count: 1", f"{KINDS[kind]}, friction_coefficient: 0.2")
    for i, (case, (_, drive, back, way)) in enumerate(CASES.items()):
        v = SPEEDS[case]
        there = film(kind, "rod", way * v, drive + AIR, AIR)
        home = film(kind, "rod", -way * v, back + AIR, AIR)
        load = dry_load(kind, "rod", 0.0, drive)
        other = dry["friction_running"][""][i, 0] - pi * ROD * 0.2 * load
        own = lubed["friction_running"][""][i, 0] - other
        assert own == near(drag(there, kind, ROD), 2e-5), case
        assert lubed["film_thickness"]["rod seal"][i, 0] == near(there.mean_film, 2e-5)
        lost = max(there.flow + home.flow, 0.0) * pi * ROD * STROKE / v
        assert lubed["rod_leakage"][""][i, 0] == near(lost, 1e-4), case
        rough = FACES[kind][3] * load * pi * ROD
        piston = 3 * 0.1 * pi * BORE
        piston *= dry_load("o_ring", "piston", growth(CASES[case][0]), CASES[case][0] - DRAIN)
        assert lubed["friction_breakaway"][""][i, 0] == near(rough + piston, 1e-5)
        total = lubed["friction_running"][""][i, 0]
        assert lubed["damping_seal"][""][i, 0] == near(total / v)


@pytest.mark.long
@pytest.mark.parametrize("kind", list(KINDS))
def test_piston_film_sees_the_bore_move_inwards(kind):
    """The bore runs from the return side to the driven one either way; leakage is the film's."""
    lubed = metrics(f"{KINDS[kind]}, friction: film", O_RING)
    for i, (case, (driven, drive, _, _)) in enumerate(CASES.items()):
        v, grown = SPEEDS[case], growth(driven)
        there = film(kind, "piston", -v, driven + AIR, DRAIN + AIR, grown)
        rod = 0.1 * pi * ROD * dry_load("o_ring", "rod", 0.0, drive)
        own = lubed["friction_running"][""][i, 0] - rod
        assert own == near(drag(there, kind, BORE), 5e-5), case
        assert lubed["film_thickness"]["piston seal"][i, 0] == near(there.mean_film, 5e-5)
        passed = max(there.flow, 0.0) * pi * BORE
        assert lubed["leakage"][""][i, 0] == pytest.approx(passed, rel=2e-4, abs=1e-16)


def test_oil_that_thickens_under_pressure():
    """Roelands at the coefficient of the temperature: 28.7 to 21.2 1/GPa from 30 to 60 degC."""
    sets = (("fluid.viscosity_pressure", "roelands"),)
    lubed = metrics(O_RING, f"{STEP}, friction: film", sets)
    oil = Lubricant(viscosity(45), "roelands", 24.95e-9)
    there = film("step_ring", "rod", -0.3, PULL + AIR, AIR, oil=oil)
    driven = CASES["pull"][0]
    piston = 0.1 * pi * BORE * dry_load("o_ring", "piston", growth(driven), driven - DRAIN)
    own = lubed["friction_running"][""][1, 0] - piston
    assert own == near(drag(there, "step_ring", ROD), 2e-5)


PAIR = f"{STEP}, friction: film, secondary: {{{U_CUP}, friction: film}}"


def tandem(speed, sealed, **options):
    """Step ring and U-cup in a row on the rod."""
    return solve_tandem(
        inner=TandemSeal(static("step_ring"), elastic("step_ring"), surface("step_ring", "rod")),
        outer=TandemSeal(static("u_cup"), elastic("u_cup"), surface("u_cup", "rod")),
        lubricant=OIL, speed=speed, sealed_pressure=sealed + AIR, outer_pressure=AIR, **options
    )  # fmt: skip


SLOW = (("supply.return_pressure", "20 bar"), ("load_cases[pull].speed", "0.05 m/s"))


@pytest.mark.long
def test_tandem_is_the_solved_pair():
    """Both films at the pressure where they pass the same flow; that pressure is a metric."""
    lubed = metrics(O_RING, PAIR, SLOW)
    low = 2e6
    for i, (driven, drive, back, way, v) in enumerate(
        ((SUPPLY, low, SUPPLY, 1, 0.1), (PULL, PULL, low, -1, 0.05))
    ):
        there, home = tandem(way * v, drive), tandem(-way * v, back)
        assert there.converged
        assert home.converged
        found = lubed["inter_seal_pressure"]["rod"][i, 0]
        assert found == pytest.approx(there.pressure - AIR, rel=1e-4, abs=20.0)
        piston = 0.1 * pi * BORE * dry_load("o_ring", "piston", growth(driven), driven - low)
        own = lubed["friction_running"][""][i, 0] - piston
        both = drag(there.inner, "step_ring", ROD) + drag(there.outer, "u_cup", ROD)
        assert own == near(both, 1e-4)
        lost = (there.inner.flow + home.inner.flow) * pi * ROD * STROKE / v
        assert lubed["rod_leakage"][""][i, 0] == pytest.approx(max(lost, 0), rel=1e-3, abs=1e-13)


@pytest.mark.long
def test_a_pair_does_not_break_away_below_its_running_friction():
    """What stands between the rings while they run (78 bar) still presses the outer one at rest."""
    lubed = metrics(O_RING, PAIR, SLOW)
    piston = 0.1 * pi * BORE * dry_load("o_ring", "piston", growth(PULL), PULL - 2e6)
    running = lubed["friction_running"][""][1, 0] - piston
    assert lubed["friction_breakaway"][""][1, 0] - 3 * piston >= running


@pytest.mark.long
def test_a_pair_at_return_pressure_has_a_film():
    """Dragged out at 0.1 m/s and 6 bar the room between fills: the solved pair's pressure."""
    found = evaluated(O_RING, PAIR, (("load_cases[pull].speed", "0.1 m/s"),))
    pair = tandem(SPEEDS["push"], DRAIN, highest=3.0)
    assert pair.converged
    between = pair.pressure - AIR
    assert between > DRAIN  # filled above either side
    assert found.metrics["inter_seal_pressure"].by_case["push"] == near(between, 1e-3)


# --- speed 0, defaults, damping ------------------------------------------------------------------

REST = "  - {name: hold, direction: push, force: 2 kN}"
FILMS = (f"{KINDS['compact']}, friction: film", f"{STEP}, friction: film")


def test_at_rest_the_face_is_dry():
    """A case without speed: dry friction, no leakage over a stroke, no secant damping."""
    found = metrics(*FILMS, more=REST)
    rub = pi * BORE * 0.25 * dry_load("compact", "piston", growth(SUPPLY), SUPPLY - DRAIN)
    rub += pi * ROD * 0.1 * dry_load("step_ring", "rod", 0.0, DRAIN)
    assert found["friction_running"][""][2, 0] == near(rub, 1e-5)
    assert found["friction_breakaway"][""][2, 0] == near(rub, 1e-5)
    evaluation = evaluated(*FILMS, more=REST)
    for name in ("damping_seal", "rod_leakage"):
        assert set(evaluation.metrics[name].by_case) == {"push", "pull"}


def test_a_resting_case_has_no_film_thickness():
    """Where nothing runs there is no mean film to compare with a limit."""
    found = evaluated(*FILMS, more=REST + "\nrequirements: {film_thickness: {min: 0.3 um}}")
    assert "hold" not in found.metrics["film_thickness"].by_case
    assert found.requirements[0].met


def test_only_resting_cases_need_no_film():
    """No speed anywhere: the dry friction, and a reason for every missing number."""
    text = (("load_cases[push].speed", "0 m/s"), ("load_cases[pull].speed", "0 m/s"))
    found = evaluated(*FILMS, sets=text)
    for name in ("film_thickness", "rod_leakage", "damping_seal", "leakage"):
        assert found.metrics[name].value is None, name
        assert found.metrics[name].why
    assert found.metrics["friction_running"].value == found.metrics["friction_breakaway"].value


def test_a_case_that_drives_at_return_pressure_has_its_numbers():
    """No pressure across the piston seal: no leakage, and a damping ratio all the same."""
    found = evaluated(*FILMS, sets=(("load_cases[push].pressure", "6 bar"),))
    assert found.metrics["leakage"].value is not None
    assert found.metrics["damping_ratio"].value is not None


def test_damping_ratio_takes_the_slope_of_the_solved_friction():
    """The same ratio as a ring by coefficient whose viscous part is the films' dF/dv.

    The slope is a central difference of films solved at two speeds, the leakage conductance is
    theirs too.
    """
    lubed = evaluated(*FILMS)
    slopes, sets = [], []
    for case, (driven, drive, _, way) in CASES.items():
        v = SPEEDS[case]
        ends = []
        for u in (0.99 * v, 1.01 * v):
            piston = film("compact", "piston", -u, driven + AIR, DRAIN + AIR, growth(driven))
            rod = film("step_ring", "rod", way * u, drive + AIR, AIR)
            ends.append(drag(piston, "compact", BORE) + drag(rod, "step_ring", ROD))
        slopes.append((ends[1] - ends[0]) / (0.02 * v))
        middle = film("compact", "piston", -v, driven + AIR, DRAIN + AIR, growth(driven))
        across = driven - DRAIN
        sets.append(max(middle.flow, 0.0) * pi * BORE / across)
    assert sets == [0.0, 0.0]  # dragged back faster than it leaks
    area = pi * ROD
    for case, slope in zip(CASES, slopes, strict=True):
        # the same slope on a falling Stribeck curve at its own speed, y = 1
        assert slope < 0
        coulomb = 0.1 * area * dry_load("step_ring", "rod", 0.0, CASES[case][1])
        ratio = 1 - slope * SPEEDS[case] * exp(1) / (2 * coulomb)
        dry = evaluated(
            f"{KINDS['compact']}, friction_coefficient: 0.25, breakaway_ratio: 1",
            f"{STEP}, friction_coefficient: 0.1, breakaway_ratio: {ratio}, "
            f"stribeck_speed: {SPEEDS[case]} m/s",
        )
        expected = dry.metrics["damping_ratio"].by_case[case]
        assert lubed.metrics["damping_ratio"].by_case[case] == near(expected, 2e-3), case


# --- gradients -----------------------------------------------------------------------------------

RING = O_RING.replace("15 %", "16 %")  # the pressure's share of the load has a kink at 15 %
LUBED = (f"{KINDS['compact']}, friction: film", f"{RING}, friction: film")
ASKED = ("friction_running", "rod_leakage", "film_thickness")


def at(ready, path, value):
    """Metrics of one design with one number replaced, in every case."""
    found = compute(ready, ready.values({path: np.array([value])})).computed.metrics
    return np.concatenate(
        [np.broadcast_to(row, (2, 1)).ravel() for name in ASKED for row in found[name].values()]
    )


def rebuilt(path, share, seals=LUBED, sets=()):
    """The same with films solved anew where the number is scaled."""
    ready = subject(*seals, sets)
    value = ready.numbers[path] * share
    return at(subject(*seals, (*sets, (path, repr(value)))), path, value)


MOVED = (
    "seals.piston.squeeze",
    "seals.rod.squeeze",
    "seals.rod.section",
    "cylinder.bore",
    "supply.pressure",
    "fluid.temperature",
    "materials.nbr_90.hardness",
    "piston.clearance",
)


@pytest.mark.parametrize("path", MOVED)
def test_complex_step_against_central_differences_of_the_same_evaluation(path):
    """Derivative of friction, leakage and film by a number, along the same path of evaluation."""
    ready = subject(*LUBED)
    value = ready.numbers[path]
    step = np.imag(at(ready, path, value + 1e-30j * value)) / 1e-30
    ends = [at(ready, path, value * (1 + h)) for h in (-1e-5, 1e-5)]
    scale = np.abs(at(ready, path, value))
    assert step / scale == pytest.approx((ends[1] - ends[0]) / 2e-5 / scale, rel=1e-6, abs=1e-8)
    if path == "piston.clearance":
        assert np.all(step == 0)  # the film does not see the gap behind the ring


@pytest.mark.long
@pytest.mark.parametrize("path", [p for p in MOVED[:-1] if "section" not in p])
def test_complex_step_against_films_solved_anew(path):
    """The same derivative by films solved on both sides of the design (of a constant viscosity)."""
    ready = subject(*LUBED)
    value = ready.numbers[path]
    step = np.imag(at(ready, path, value + 1e-30j * value)) / 1e-30
    ends = [rebuilt(path, share) for share in (1 - 3e-4, 1 + 3e-4)]
    scale = np.abs(at(ready, path, value))
    assert step / scale == pytest.approx((ends[1] - ends[0]) / 6e-4 / scale, rel=1e-4, abs=1e-5)


@pytest.mark.long
def test_warmer_oil_also_thickens_less_under_pressure():
    """Roelands' coefficient falls with the temperature, and with it the film's friction."""
    sets = (("fluid.viscosity_pressure", "roelands"),)
    ready = subject(*LUBED, sets)
    value = ready.numbers["fluid.temperature"]
    step = np.imag(at(ready, "fluid.temperature", value + 1e-30j * value)) / 1e-30
    ends = [rebuilt("fluid.temperature", share, sets=sets) for share in (0.999, 1.001)]
    scale = np.abs(at(ready, "fluid.temperature", value))
    assert step / scale == pytest.approx((ends[1] - ends[0]) / 2e-3 / scale, rel=1e-2, abs=1e-4)


def test_films_follow_the_asperities_of_the_compound():
    """More summits per area carry more: the price of that number is not nothing."""
    path = "materials.nbr_90.asperity_density"
    ready = subject(*LUBED)
    value = ready.numbers[path]
    step = np.imag(at(ready, path, value + 1e-30j * value)) / 1e-30
    ends = [rebuilt(path, share) for share in (0.999, 1.001)]
    scale = np.abs(at(ready, path, value))
    assert step / scale == pytest.approx((ends[1] - ends[0]) / 2e-3 / scale, rel=1e-2, abs=1e-4)


@pytest.mark.parametrize("path", ["seals.piston.squeeze", "supply.pressure"])
def test_damping_ratio_follows_what_moves_the_films(path):
    """The slope of the friction over speed moves with squeeze and pressure, and so the ratio."""
    ready = subject(*LUBED)
    value = ready.numbers[path]

    def ratio(one, number):
        found = compute(one, one.values({path: np.array([number])})).computed.metrics
        return found["damping_ratio"]["weakest position"][0, 0]

    step = np.imag(ratio(ready, value + 1e-30j * value)) / 1e-30
    ends = [ratio(subject(*LUBED, ((path, repr(value * s)),)), value * s) for s in (0.999, 1.001)]
    assert step == pytest.approx((ends[1] - ends[0]) / 2e-3, rel=0.05)  # to the first order


@pytest.mark.long
@pytest.mark.parametrize("stroke", [pytest.param("drive", marks=pytest.mark.long), "return"])
def test_slopes_of_a_pair_against_pairs_solved_anew(stroke):
    """Exact derivatives of drag, load, film, flow and the pressure between, by what moves them."""
    kinds = PAIR.replace("15 %", "16 %")
    ready = subject(O_RING, kinds, SLOW)
    compute(ready, ready.values())
    row = ready.films["rod", 0, stroke].row
    solved = films.solve(row)
    point = {name: float(x) for name, x in row.inputs().items()}
    names = ("speed", "viscosity", "sealed", "0.squeeze_left", "0.land", "1.squeeze_left",
             "1.thickness", "1.face_modulus", "0.diameter")  # fmt: skip
    by = films.slopes(solved, names)
    for name in names:
        ends = [
            films.solve(row.at(point | {name: point[name] * (1 + h)}), solved)
            for h in (-2e-4, 2e-4)
        ]
        assert not any(end.why for end in ends)
        change = (ends[1].values - ends[0].values) / 4e-4
        scale = np.abs(solved.values)
        assert by[name] / scale == pytest.approx(change / scale, rel=2e-3, abs=2e-4), name


# --- the surrogate -------------------------------------------------------------------------------

FREE = """
variables:
  seals.rod.squeeze: {lower: 10 %, upper: 25 %}
  seals.rod.section: {lower: 2 mm, upper: 3.5 mm}
"""


@pytest.mark.long
def test_stated_error_is_that_of_films_within_the_box():
    """At thirty points of the box the surrogate is not further off than the table says.

    The films are solved here from the design's numbers; three times the stated error is allowed,
    which is found at a few points only.
    """
    still = (("load_cases[pull].speed", "0 m/s"),)
    ready = subject(O_RING, f"{O_RING}, friction: film", still, FREE)
    compute(ready, ready.values())
    stated = max(table.errors["friction"] for table in ready.films.values())
    assert 0 < stated < 0.03
    mixed = np.random.default_rng(5)
    squeezes, sections = mixed.uniform(0.10, 0.25, 30), mixed.uniform(2e-3, 3.5e-3, 30)
    varied = {"seals.rod.squeeze": squeezes, "seals.rod.section": sections}
    running = compute(ready, ready.values(varied)).computed.metrics["friction_running"][""][0]
    piston = 0.1 * pi * BORE * dry_load("o_ring", "piston", growth(SUPPLY), SUPPLY - DRAIN)
    for k, (c, w) in enumerate(zip(squeezes, sections, strict=True)):
        load, width, _ = oracle.o_ring(c, w, MODULUS, DRAIN)
        found = solve_film(
            Contact(
                width=width,
                static_pressure=AIR + oracle.o_ring_pressure(load, width, DRAIN, NODES),
                elastic=elastic("o_ring"), surface=surface("o_ring", "rod"), lubricant=OIL,
                speed=0.1, sealed_pressure=DRAIN + AIR, outer_pressure=AIR,
            )
        )  # fmt: skip
        assert running[k] - piston == near(drag(found, "o_ring", ROD), 3 * stated)


WIDE = """
variables:
  seals.piston.squeeze: {lower: 10 %, upper: 25 %}
  barrel.layup[0].thickness: {lower: 0.6 mm, upper: 4 mm}
  cylinder.bore: {lower: 25 mm, upper: 45 mm}
"""


@pytest.mark.long
@pytest.mark.xfail(strict=True, reason="squeeze held at the end of the samples, no slope there")
def test_a_corner_of_the_bounds_has_its_slope():
    """Least squeeze, widest bore and thinnest wall are allowed together: squeeze still matters."""
    ready = subject(f"{O_RING}, friction: film", O_RING, (), WIDE)
    path = "seals.piston.squeeze"
    corner = {"barrel.layup[0].thickness": 0.6e-3, "cylinder.bore": 45e-3}
    point = {name: np.array([x]) for name, x in corner.items()}
    told = compute(ready, ready.values(point | {path: np.array([0.1 + 1e-30j])}))
    slope = np.imag(told.computed.metrics["friction_running"][""]) / 1e-30
    ends = []
    for squeeze in (0.1, 0.102):
        sets = ((path, repr(squeeze)), *((name, repr(x)) for name, x in corner.items()))
        ends.append(metrics(f"{O_RING}, friction: film", O_RING, sets)["friction_running"][""])
    assert slope == near((ends[1] - ends[0]) / 0.002, 0.2)


LIMITED = """
variables:
  seals.rod.squeeze: {lower: 10 %, upper: 25 %}
  cylinder.bore: {lower: 28 mm, upper: 40 mm}
requirements:
  rod_leakage: {max: 5.5 mm^3}
waivers: {damping_ratio: not asked, seal_section: small}
objective: {minimise: friction_running}
"""


@pytest.fixture(scope="module")
def limited():
    """A cylinder whose least friction is asked under a limit of leakage."""
    return ao.read(text(RING, f"{RING}, friction: film", LIMITED))


@pytest.mark.long
def test_alone_and_in_the_optimiser_a_design_is_the_same(limited):
    """Objective and margins at a point are those of the Evaluation of the design there."""
    ready = limited.subject()
    problem = build(ready)
    point = {"seals.rod.squeeze": 0.19, "cylinder.bore": 33e-3}
    found = problem.evaluate(np.array([[point[path]] for path in problem.paths]))
    alone = compute(ready, ready.values({p: np.array([x]) for p, x in point.items()}))
    running = alone.computed.metrics["friction_running"][""]
    assert float(found.objective[0]) == near(float(np.max(running)), 1e-12)
    again = ao.evaluate(limited.changed(point))  # tables made at that point
    assert again.metrics["friction_running"].value == near(float(np.max(running)), 1e-3)
    names = list(problem.problem.constraint_names)
    margin = 1 - again.metrics["rod_leakage"].by_case["push"] / 5.5e-9
    held = margin / (1 + max(margin, 0))
    assert float(found.constraints[names.index("rod_leakage (push)"), 0]) == near(held, 2e-3)


@pytest.fixture(scope="module")
def best(limited):
    """Its optimum."""
    return ao.optimise(limited, starts=1)


@pytest.mark.long
def test_least_friction_under_a_leakage_limit(limited, best):
    """A point where the optimality conditions hold, on the limit, with finite prices."""
    assert best.status == "optimal"
    assert best.kkt.residual < 1e-6
    assert "rod_leakage (push)" in best.kkt.active
    assert best.evaluation.metrics["rod_leakage"].value == near(5.5e-9)
    assert price_of_leakage(best) < 0  # a looser limit costs less friction
    for one in best.sensitivities:
        assert np.isfinite(one.price)
        assert one.resolved_10 is None or np.isfinite(one.resolved_10)


def price_of_leakage(best):
    """Price of its limit of leakage."""
    rows = {row.parameter: row for row in best.sensitivities}
    return rows["requirements.rod_leakage.max"].price


@pytest.mark.long
def test_the_price_is_the_slope_of_the_least_friction(limited, best):
    """Solved again on both sides of the limit of leakage."""
    ends = [
        ao.optimise(limited.changed({"requirements.rod_leakage.max": x}), starts=1, prices=False)
        for x in (5.45e-9, 5.55e-9)
    ]
    slope = (ends[1].objective_value - ends[0].objective_value) / 0.1e-9
    assert price_of_leakage(best) == near(slope, 0.02)


@pytest.mark.long
@pytest.mark.xfail(strict=True, reason="re-solved rows keep the films' first order, unsaid")
def test_re_solved_rows_solve_the_films_again(best):
    """A harder ring by 10 %: the row says what optimising the harder design says."""
    row = next(r for r in best.sensitivities if r.parameter == "materials.nbr_90.hardness")
    harder = ao.optimise(
        ao.read(
            text(RING, f"{RING}, friction: film", LIMITED),
            set=(("materials.nbr_90.hardness", "90.2"),),
        ),
        starts=1,
        prices=False,
    )
    assert row.resolved_10 == near(harder.objective_value, 0.01)
