"""Faults of seals: each one line at its place with a remedy; random seals never break."""

from __future__ import annotations

import json
from math import isfinite

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from seal_designs import KINDS, O_RING, STEP, U_CUP, evaluated, text

import actuator_opt as ao
from actuator_opt import api as verbs
from actuator_opt.base.errors import ActuatorError, InputError
from actuator_opt.models.seals import LAWS

PROFILES = (
    "contact: [{pressure: 0 bar, positions: [0 mm, 0.4 mm, 1 mm], stresses: [0 bar, 40 bar, 0 bar]}"
    ", {pressure: 120 bar, positions: [0 mm, 0.2 mm, 2 mm], stresses: [120 bar, 260 bar, 0 bar]}]"
)
TABLE = f"{O_RING}, {PROFILES}"
WIPER = (
    "wiper: {compound: pu_94_u_cup, section: 3 mm, squeeze: 8 %, thickness: 1 mm, width: 3 mm, "
    "groove_width: 4 mm}"
)


def fault(piston=O_RING, rod=O_RING, sets=()):
    """The diagnostics of a design that must not be read."""
    with pytest.raises(InputError) as raised:
        ao.read(text(piston, rod), set=sets)
    return raised.value.diagnostics


CASES = [
    (f"{O_RING}, groove_width: 2 mm", "section", "larger than the groove"),
    (O_RING.replace("15 %", "45 %"), "squeeze", "outside the range"),
    (O_RING.replace("15 %", "1 %"), "squeeze", "outside the range"),
    (STEP.replace("15 %", "42 %"), "squeeze", "outside the range"),
    (STEP.replace("width: 3.9 mm, ", ""), "width", "missing"),
    (STEP.replace("thickness: 1.5 mm, ", ""), "thickness", "missing"),
    (U_CUP.replace("thickness: 1.6 mm, ", ""), "thickness", "missing"),
    (KINDS["compact"].replace("width: 8 mm, ", ""), "width", "missing"),
    (f"{O_RING}, taper: 5 deg", "taper", "not a size of"),
    (f"{U_CUP}, relief: 1 mm", "relief", "not a size of"),
    (f"{STEP}, root_clearance: 1 mm", "root_clearance", "not a size of"),
    (STEP.replace("land: 1 mm", "land: 4.5 mm"), "land", "wider than the ring"),
    (STEP.replace("groove_width: 4.2 mm", "groove_width: 3 mm"), "width", "larger than the groove"),
    (f"{O_RING}, back_up: one, back_up_thickness: 1 mm", "back_up_material", "missing"),
    (f"{O_RING}, back_up: one, back_up_material: back_up_ptfe", "back_up_thickness", "missing"),
    (f"{O_RING}, back_up_thickness: 1 mm", "back_up_thickness", "no back-up ring"),
    (f"{O_RING}, {WIPER}", "wiper", "a piston needs no wiper"),
    (f"{O_RING}, friction: film, count: 2", "count", "one ring or a pair"),
    (f"{O_RING}, count: 1.5", "count", "whole number"),
    (f"{O_RING}, friction: film, secondary: {{{O_RING}}}", "secondary.friction", "while"),
    (f"{O_RING}, secondary: {{{O_RING}, friction: film}}", "secondary.friction", "while"),
    (f"{O_RING}, secondary: {{{O_RING}, {WIPER}}}", "secondary.wiper", "unknown key"),
    (TABLE.replace("pressure: 0 bar", "pressure: 5 bar"), "contact[0].pressure", "zero"),
    (TABLE.replace("pressure: 120 bar", "pressure: 90 bar"), "contact[1].pressure", "below"),
    (TABLE.replace("pressure: 120 bar", "pressure: 0 bar"), "contact[1].pressure", "not above"),
    (TABLE.replace("40 bar, 0 bar", "40 bar"), "contact[0].stresses", "2 stresses at 3"),
    (TABLE.replace("[0 mm, 0.4", "[0.1 mm, 0.4"), "contact[0].positions", "from 0"),
    (TABLE.replace("0.4 mm", "1.4 mm"), "contact[0].positions", "from 0"),
    (TABLE.replace("40 bar", "-40 bar"), "contact[0].stresses[1]", ">= 0"),
    (O_RING.replace("nbr_90", "ptfe_bronze_nbr_70"), "compound", "does not suit an o_ring"),
    (STEP.replace("ptfe_bronze_nbr_70", "nbr_90"), "compound", "does not suit a step_ring"),
    (O_RING.replace("nbr_90", "iso_vg_46"), "compound", "need a seal"),
    (f"{O_RING}, guide: {{material: guide_acetal, thickness: 8 mm, width: 5 mm}}",
     "guide.thickness", "too deep"),
    (f"{O_RING}, guide: {{material: guide_acetal, thickness: 1 mm, width: 38 mm}}",
     "", "do not fit into the piston"),
]  # fmt: skip


@pytest.mark.parametrize(("piston", "field", "words"), CASES)
def test_a_fault_is_one_line_at_its_place(piston, field, words):
    """Where it stands, what is wrong, and what to do."""
    (one,) = fault(piston)
    assert one.path.startswith("seals.piston")
    assert one.path.endswith(field)
    assert words in one.message
    assert "\n" not in one.message
    assert one.remedy
    assert one.line is not None


@pytest.mark.parametrize(
    ("piston", "words"),
    [
        pytest.param(
            STEP.replace("2.62 mm", "5.33 mm"),
            "wider than the step ring",
            id="energiser of 5.33 mm in a groove of 4.2 mm",
        ),
        pytest.param(
            STEP.replace("relief: 1.2 mm", "relief: 3.5 mm"),
            "relief",
            id="relief 3.5 mm and land 1 mm on a ring of 3.9 mm",
        ),
        pytest.param(
            U_CUP.replace("thickness: 1.6 mm", "thickness: 5.9 mm"),
            "thickness",
            id="two lips of 5.9 mm in a section of 6 mm",
        ),
    ],
)
def test_rings_that_cannot_be_built(piston, words):
    """Sizes of one ring contradict each other."""
    assert any(words in str(one) for one in fault(piston))


# --- the seal verb -------------------------------------------------------------------------------


def seal(piston=O_RING, **asked):
    """The study of the piston seal."""
    return verbs.seal(ao.read(text(piston, O_RING)), **({"place": "piston"} | asked))


@pytest.mark.parametrize(
    ("piston", "asked", "words"),
    [
        (TABLE, {"pressure": 20e6}, "profiles stated for the piston seal end at 120 bar"),
        (O_RING, {"speed": 0.0}, "need a moving seal"),
        (O_RING, {"speed": -0.1}, "need a moving seal"),
        (f"{O_RING}, count: 2", {}, "one ring or a pair"),
    ],
)
def test_what_a_study_cannot_answer_is_one_line(piston, asked, words):
    """Pressure beyond stated profiles, no speed, a row of rings: a line, no traceback."""
    with pytest.raises(InputError) as raised:
        seal(piston, **asked)
    (one,) = raised.value.diagnostics
    assert words in one.message
    assert one.remedy


def test_a_profile_below_its_pressure_is_refused():
    """Stresses nowhere above the sealed pressure hold nothing: a fault of the file."""
    low = TABLE.replace("[120 bar, 260 bar, 0 bar]", "[20 bar, 26 bar, 0 bar]")
    (one,) = fault(low)
    assert one.path == "seals.piston.contact[1].stresses"
    assert "does not seal" in one.message


def test_a_hard_compound_gives_json_without_nan():
    """Gent has no modulus at 100 Shore A: the bound of a batch of 95 is unknown, which is null."""
    study = seal(O_RING.replace("nbr_90", "pu_95"))
    json.dumps(study.to_dict(), allow_nan=False)


def test_study_and_evaluation_are_one_film():
    """At a case's speed and pressure the study's rod friction is that of the evaluation."""
    found = evaluated(O_RING, f"{STEP}, friction: film")
    study = verbs.seal(
        ao.read(text(O_RING, f"{STEP}, friction: film")), place="rod", speed=0.3, pressure=9e6
    )
    dry = evaluated(O_RING, f"{STEP}, friction_coefficient: 0.1")
    rod = (
        0.1
        * study.back.rings[0].coefficient_friction
        / study.back.rings[0].ring["friction_coefficient"]
    )
    piston = dry.metrics["friction_running"].by_case["pull"] - rod
    running = found.metrics["friction_running"].by_case["pull"]
    assert running - piston == pytest.approx(study.back.friction, rel=1e-5)


def test_a_map_follows_the_growth_of_its_pressures():
    """At a pressure and speed of the map its friction is that of the point itself."""
    thin = ao.read(
        text(O_RING.replace("15 %", "16 %"), O_RING),
        set=(("barrel.layup[0].thickness", "0.5 mm"),),
    )
    table = verbs.seal(thin, place="piston", speed=0.1, pressure=12e6, mapped=True).map
    speed, pressure = float(table.speeds[6]), float(table.pressures[3])
    point = verbs.seal(thin, place="piston", speed=speed, pressure=pressure).drive
    assert table.friction[3, 6] == pytest.approx(point.friction, rel=2e-3)


@pytest.mark.long
@pytest.mark.xfail(strict=True, reason="point, map and evaluation of a pair each have their own")
def test_breakaway_of_a_pair_is_one_number():
    """Study, its map and the evaluation agree on the friction after a standstill."""
    pair = f"{STEP}, friction: film, secondary: {{{U_CUP}, friction: film}}"
    alone = f"{STEP}, friction: film"
    sets = (("supply.return_pressure", "20 bar"), ("load_cases[pull].speed", "0.05 m/s"))
    held = "friction_breakaway"
    both = evaluated(O_RING, pair, sets).metrics[held].by_case["pull"]
    first = evaluated(O_RING, alone, sets).metrics[held].by_case["pull"]
    study, single = (
        verbs.seal(ao.read(text(O_RING, rod), set=sets), place="rod", speed=0.05, pressure=9e6,
                   mapped=rod is pair)
        for rod in (pair, alone)
    )  # fmt: skip
    second = both - first
    assert study.back.breakaway == pytest.approx(single.back.breakaway + second, rel=1e-3)
    assert study.map is not None
    at = list(study.map.pressures).index(9e6)
    assert study.map.breakaway[at] == pytest.approx(study.back.breakaway, rel=1e-3)


def test_a_lip_close_to_its_root_is_near_one_that_touches_there():
    """A micrometre of clearance at the lip's root is as good as none."""
    none, little = (
        evaluated(O_RING, f"{U_CUP}, root_clearance: {gap}").metrics["friction_running"].value
        for gap in ("0 mm", "0.001 mm")
    )
    assert little == pytest.approx(none, rel=0.1)


# --- anything at all -----------------------------------------------------------------------------


def size(low, high):
    """A length in mm as text."""
    return st.floats(low, high).map(lambda x: f"{x:.3f} mm")


def maybe(strategy):
    """The field, or its absence."""
    return st.one_of(st.none(), strategy)


COMPOUNDS = ("nbr_90", "nbr_70", "pu_95", "pu_94_u_cup", "ptfe_bronze_nbr_70", "nbr_80",
             "uhmwpe_nbr_70", "fkm_90", "epdm_80")  # fmt: skip
SUITED = {
    "o_ring": ("nbr_90", "nbr_70", "pu_95", "fkm_90"),
    "u_cup": ("pu_94_u_cup", "pu_95"),
    "step_ring": ("ptfe_bronze_nbr_70", "uhmwpe_nbr_70"),
    "compact": ("nbr_80", "nbr_90"),
}


@st.composite
def element(draw, tandem=True, film=None):
    """A seal element: mostly what its type needs, sometimes not."""
    kind = draw(st.sampled_from(sorted(SUITED)))
    odd = draw(st.integers(0, 9)) == 0
    lubed = draw(st.integers(0, 7)) == 0 if film is None else film
    fields = {
        "type": kind,
        "compound": draw(st.sampled_from(COMPOUNDS if odd else SUITED[kind])),
        "section": draw(size(0.5, 12 if odd else 6)),
        "squeeze": f"{draw(st.floats(0, 45 if odd else 30)):.2f} %",
        "tolerance": draw(maybe(size(0, 0.2))),
        "section_tolerance": draw(maybe(size(0, 0.3))),
        "groove_width": draw(maybe(size(2, 14))) if odd else None,
        "stretch": draw(maybe(st.floats(0, 0.1).map(lambda x: f"{x:.3f}"))),
        "count": None if lubed and not odd else draw(maybe(st.sampled_from(["0", "1", "2", "3"]))),
        "friction": "film" if lubed else None,
        "hardness_model": draw(maybe(st.sampled_from(["gent", "ruess"]))),
    }
    if kind != "o_ring" or odd:
        fields["width"] = draw(size(0.5, 9))
        fields["land"] = draw(maybe(size(0.1, 9 if odd else 0.5)))
    if kind in ("step_ring", "u_cup") or odd:
        fields["thickness"] = draw(size(0.3, 3))
    if kind == "step_ring":
        fields["relief"] = draw(maybe(size(0.1, 3)))
        fields["taper"] = draw(maybe(st.floats(1, 30).map(lambda x: f"{x:.3g} deg")))
    if kind in ("o_ring", "step_ring"):
        fields["law"] = draw(maybe(st.sampled_from(sorted(LAWS))))
    if kind == "u_cup":
        fields["root_clearance"] = draw(maybe(size(0, 2)))
    if draw(st.booleans()):
        fields["back_up"] = draw(st.sampled_from(["one", "both"]))
        fields["back_up_material"] = "back_up_ptfe"
        fields["back_up_thickness"] = draw(size(0.3, 3))
    if tandem and draw(st.integers(0, 3)) == 0:
        fields["secondary"] = "{" + draw(element(tandem=False, film=lubed)) + "}"
    return ", ".join(f"{name}: {value}" for name, value in fields.items() if value is not None)


@settings(suppress_health_check=list(HealthCheck))
@given(piston=element(), rod=element(), wall=size(0.1, 4), bore=size(20, 60), load=st.booleans())
def test_random_seals_give_numbers_or_reasons(piston, rod, wall, bore, load):
    """Read or refused in plain lines; every metric is a finite number or says why not."""
    sets = [("barrel.layup[0].thickness", wall), ("cylinder.bore", bore)]
    if load:
        sets.append(("load_cases[push].side_load", "80 N"))
    try:
        found = ao.evaluate(ao.read(text(piston, rod), set=sets))
    except ActuatorError as refused:
        for one in refused.diagnostics:
            assert one.message
            assert one.remedy
        return
    for name, metric in found.metrics.items():
        assert metric.value is not None or metric.why, name
        assert metric.value is None or isfinite(metric.value) or metric.value == float("inf"), name
        for value in metric.by_case.values():
            assert isfinite(value) or value == float("inf"), name
    for text_of in found.warnings:
        assert "nan" not in text_of.split(), text_of
