"""The study of the knee in five materials: variants that compare, and text that follows numbers."""

from __future__ import annotations

import copy
import json
import re
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
import yaml
from script_loader import script

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "designs" / "scripts" / "knee_materials.py"
REPORT = ROOT / "reports" / "samples" / "knee_materials.pdf"


study = script("knee_materials")


def _words(pdf: bytes) -> str:
    """Text of a PDF as one line, soft hyphens of broken words joined."""
    pypdf = pytest.importorskip("pypdf")
    text = " ".join(page.extract_text() for page in pypdf.PdfReader(BytesIO(pdf)).pages)
    text = re.sub(r"(?<=\w)[-\u00ad\u2010] ?\n ?(?=[a-z])", "", text)
    return " ".join(text.replace("\u2060", "").split())


@pytest.fixture(scope="module")
def numbers() -> dict[str, Any]:
    """The numbers that the committed report carries inside."""
    pypdf = pytest.importorskip("pypdf")
    attached = pypdf.PdfReader(REPORT).attachments
    return json.loads(attached["knee_materials.json"][0])


def _said(numbers: dict[str, Any]) -> str:
    pytest.importorskip("typst")
    return _words(study.page(numbers)[0])


@pytest.mark.long
@pytest.mark.parametrize("key", ["steel", "aluminium", "lined", "linerless"])
def test_each_barrel_is_its_own_optimum_at_the_requirements_of_the_knee(key, numbers) -> None:
    """Solved afresh the mass is the committed one, and all requirements are met."""
    row = numbers["variants"][key]
    found, lacks = study.solved(key, joint=row["joint"])
    assert (found.status, lacks) == ("optimal", [])
    assert found.objective_value == pytest.approx(row["mass"], rel=1e-5)
    limits = {one.metric: one.limit for one in found.evaluation.requirements}
    assert limits == pytest.approx(numbers["limits"])
    assert all(one.margin > -1e-9 for one in found.evaluation.requirements)


@pytest.mark.parametrize(
    ("key", "joint"),
    [*((key, "bond") for key in study.WALLS), *((key, "thread") for key in study.METALS)],
)
def test_variants_differ_in_wall_and_joint_only(key, joint) -> None:
    """Everything but barrel, joint and their own free dimensions is that of knee_bonded.yaml."""
    text = (ROOT / "designs" / "knee_bonded.yaml").read_text("utf-8")
    knee = yaml.load(text, Loader=yaml.BaseLoader)
    made = yaml.load(study.variant(key, joint=joint).source.text, Loader=yaml.BaseLoader)
    own = {"name", "notes", "barrel", "variables"} | ({"retention"} if joint == "thread" else set())
    assert made.keys() == knee.keys()
    assert [made[name] for name in knee if name not in own] == [
        knee[name] for name in knee if name not in own
    ]
    changed = ("barrel.", "retention.") if joint == "thread" else ("barrel.",)
    free = [
        {
            path: bounds
            for path, bounds in design["variables"].items()
            if not path.startswith(changed)
        }
        for design in (knee, made)
    ]
    assert free[0] == free[1]


def test_a_requirement_left_out_is_neither_asked_nor_checked() -> None:
    """Both the line of the file and the one of the check list are gone, with the reason said."""
    design = study.variant("cloth", without=("seal_gap",)).design
    assert "seal_gap" not in design.requirements
    assert "seal_gap" in design.waivers


def test_the_saving_of_a_relaxed_limit_is_that_of_the_changed_design() -> None:
    """A tenth less burst pressure asked of the steel barrel weighs what the table says it does."""
    steel = study.variant("steel", joint="thread")
    optimum = study.best(steel, prices=True)
    assert optimum.status == "optimal"
    saved = study.relaxed(optimum)["burst_factor"]["mass"]
    limit = steel.design.requirements["burst_factor"].min
    changed = study.best(steel.changed({"requirements.burst_factor.min": 0.9 * limit}))
    assert saved == pytest.approx(changed.objective_value, rel=1e-6)
    assert saved < optimum.objective_value


def test_compliance_shares_and_parts_add_up() -> None:
    """What the table splits is the whole: compliances at the weakest position, parts by mass."""
    row = study.measured(study.best(study.variant("steel", joint="thread")).evaluation)
    assert sum(row["shares"].values()) == pytest.approx(1, rel=1e-9)
    assert sum(row["parts"].values()) == pytest.approx(row["mass"], rel=1e-9)


def test_the_crossing_is_where_two_straight_curves_meet() -> None:
    """300 - 100 t and a constant 250 g meet at t = 1/2; a heavier barrel is never the lightest."""
    rows = {
        "steel": {"gap_curve": [[30e-6, 0.25]]},
        "aluminium": {"gap_curve": [[30e-6, 0.3], [31e-6, 0.2]]},
        "cloth": {"gap_curve": [[31e-6, 0.26]]},
    }
    assert study.crossing(rows, "aluminium") == pytest.approx(30.5e-6, abs=2e-9)
    assert study.crossing(rows, "cloth") is None


def test_no_number_of_the_text_is_typed() -> None:
    """Below its mark the prose has no digit but that of a reference: all others are computed."""
    _, mark, prose = SCRIPT.with_suffix(".typ").read_text("utf-8").partition("// ---- prose")
    assert mark
    prose = prose.replace("[ElAsswad2018]", "")
    in_words = r"[A-Za-z,(] ?\d[\d.]*|\d[\d.]*[ \u00a0]?(?:%|‰|°|[A-Za-zµ])"
    code = r"layup\[0\]|(?:at|slice)\(\d\)|[<>=*/] [\d.]+"
    assert re.findall(in_words, re.sub(code, "", prose)) == []


def test_the_committed_report_is_made_of_its_own_numbers(numbers) -> None:
    """The script makes the committed text of the attached numbers, twice with the same bytes."""
    pytest.importorskip("typst")
    pdf, sheets = study.page(numbers)
    assert study.page(numbers)[0] == pdf
    assert len(sheets) == 3
    assert _words(pdf) == _words(REPORT.read_bytes())
    for row in numbers["variants"].values():
        assert f"{1000 * row['mass']:.1f}" in _words(pdf)


def test_the_text_turns_with_the_numbers(numbers) -> None:
    """Sentences about who leads, who is bound and who fails are said only where they hold."""
    one, other = copy.deepcopy(numbers), copy.deepcopy(numbers)
    rows, changed = one["variants"], other["variants"]
    rows["aluminium"]["relaxed"]["seal_gap"] = {"mass": 0.2, "price": -5.0}
    rows["cloth"]["conflicts"] = [
        {"metric": "seal_gap", "sense": "max", "limit": 34e-6, "needed": 36e-6}
    ]
    rows["steel"]["mass"] = 0.5 * min(row["mass"] for row in rows.values())
    rows["linerless"]["relaxed"]["friction_running"] = {"mass": 0.2, "price": -0.5}
    for key in ("lined", "linerless"):
        rows[key]["warm_bond"]["required"] = True
    changed["aluminium"]["relaxed"].pop("seal_gap", None)
    changed["cloth"]["conflicts"] = []
    changed["steel"]["mass"] = 2 * max(row["mass"] for row in changed.values())
    changed["linerless"]["relaxed"].pop("friction_running", None)
    for key in ("lined", "linerless"):
        changed[key]["warm_bond"]["required"] = False
    first, second = _said(one), _said(other)
    for here, there in (
        ("A tenth more gap would take", "Aluminium is not bound by it"),
        ("The requirements are out of reach for carbon cloth", "Carbon cloth meets it"),
        ("From light to heavy: steel", "has to be worth its doubts"),
        ("is the lightest and the simplest", "over screwed steel"),
        ("the limit binds already", "still a linerless barrel"),
        ("is required here", "is only advised here"),
    ):
        assert here in first, here
        assert here not in second, here
        assert there in second, there
        assert there not in first, there
