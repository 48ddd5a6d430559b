"""How good is this: words of the certificate, its scale, the course of the search."""

from dataclasses import replace
from pathlib import Path

import pytest
import report_fixture as fixture
from cli_runner import BENCH, KNEE, run
from hypothesis import given, strategies as st
from report_fixture import overlaps

from actuator_opt.design import read_design
from actuator_opt.optimisation import run as runs
from actuator_opt.optimisation.certificate.envelopes import refuse
from actuator_opt.optimisation.certificate.relaxation import Unknown
from actuator_opt.optimisation.result import Certificate
from actuator_opt.pages import trust
from actuator_opt.rendering.blocks import Notes

PROVEN = Certificate(
    sentence="no design that meets the covered limits has a mass below 195 g: within 4.9 %",
    evidence="6 of 6 starts led to this optimum",
    lower_bound=0.195,
    gap=0.049,
    covers=("stiffness_min", "seal_gap"),
    dropped={"first-ply (leak) pressure": "its model is not a closed formula of the variables"},
    boxes=12,
)


def test_the_page_tells_what_is_proven_and_what_is_not():
    """Bound, covered limits, those done without and why, the evidence: each in its sentence."""
    best = fixture.build_optimisation()
    said = trust.proof(replace(best, certificate=PROVEN))
    assert said[0].endswith("within 4.9 %.")
    assert "stiffness_min, seal_gap" in said[1]
    assert (
        "first-ply (leak) pressure (its model is not a closed formula of the variables)"
    ) in said[2]
    assert "6 of 6" in said[3]
    short = trust.proof(replace(best, certificate=PROVEN), shortened=True)
    assert "It covers 2 limits" in short[1]


def test_without_a_certificate_the_way_to_one_is_told():
    """A feasible optimum without proof names the option; an infeasible one has nothing to prove."""
    assert "--certify" in trust.proof(fixture.build_optimisation())[0]
    assert trust.proof(fixture.build_infeasible()) == []
    assert [type(block) for block in trust.trust_blocks(fixture.build_infeasible())] == [Notes]


@given(st.floats(0.5, 0.9999), st.lists(st.floats(1.0, 1.5), max_size=6))
def test_names_on_the_scale_never_touch(share, others):
    """Wherever bound and other optima lie, their names stay apart."""
    best = fixture.build_optimisation()
    value = best.objective_value
    bound = replace(PROVEN, lower_bound=share * value)
    found = replace(best, certificate=bound, starts=(value, *(value * one for one in others)))
    assert overlaps(trust.scale(found).text_boxes()) == []


@given(st.floats(0.0, 0.99))
def test_a_gap_is_never_told_smaller_than_it_is(share):
    """Rounded to be read, upwards."""
    assert float(runs._percent(share).removesuffix(" %")) >= 100 * share - 1e-9


@pytest.mark.parametrize(
    ("setting", "reason"),
    [
        ("maximise: efficiency", "maximised"),
        ("minimise: {mass: 1, friction_running: 1}", "weighted sum"),
    ],
)
def test_an_objective_without_a_bound_says_so(setting, reason):
    """The optimum stands, with the reason why nothing is proven."""
    design = BENCH.decode() if isinstance(BENCH, bytes) else BENCH
    done = run(
        "optimise",
        "-",
        "--certify",
        "--json",
        stdin=design.replace("minimise: mass", setting).encode(),
    )
    found = done.json["certificate"]
    assert found["lower_bound"] is None
    assert found["gap"] is None
    assert reason in found["sentence"]
    assert "evidence, not proof" in found["evidence"]


@pytest.mark.parametrize(
    ("block", "said"),
    [
        ({"layup": True}, "a rod of layers"),
        ({"linkage": True}, "a linkage"),
        ({"film": True}, "a seal with an oil film"),
        ({}, ""),
    ],
)
def test_a_model_without_an_envelope_is_named(block, said):
    """What has no envelope is refused in words before anything is traced."""
    design = read_design(KNEE).design
    if "layup" in block:
        rod = design.rod.model_copy(update={"layup": design.barrel.layup})
        design = design.model_copy(update={"rod": rod})
    if "linkage" in block:
        design = design.model_copy(update={"linkage": object()})
    if "film" in block:
        piston = design.seals.piston.model_copy(update={"friction": "film"})
        seals = design.seals.model_copy(update={"piston": piston})
        design = design.model_copy(update={"seals": seals})
    if not said:
        refuse(design)
        return
    with pytest.raises(Unknown, match=said):
        refuse(design)


@pytest.mark.long
def test_an_objective_of_several_load_cases_is_bounded():
    """The friction of the worse case, minimised: its bound is close, and not above the optimum."""
    steel = Path(__file__).parents[2] / "designs" / "steel_baseline.yaml"
    done = run("optimise", steel, "--set", "objective.minimise=friction_running", "--certify",
               "--json", "--starts", "2").json  # fmt: skip
    found = done["certificate"]
    assert found["lower_bound"] <= done["objective"]["value"]
    assert found["gap"] < 0.01
