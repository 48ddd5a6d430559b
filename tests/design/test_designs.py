"""The shipped designs: sound files, finite numbers, true optima, requirements that trade off."""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path

import pytest
from report_fixture import published_tables
from shipped import evaluated, shipped

from actuator_opt import api as verbs
from actuator_opt.api.reports import REPLICAS, published as published_blocks
from actuator_opt.optimisation.result import Optimisation

DESIGNS = Path(__file__).parents[2] / "designs"
ALL = sorted(DESIGNS.glob("*.yaml"))
GROUPS = {
    "stiffness_min": "stiffness",
    "friction_running": "friction",
    "seal_gap": "seal",
    "seal_squeeze": "seal",
    "buckling_factor": "strength",
    "burst_factor": "strength",
    "proof_factor": "strength",
}
"""Which group a requirement of the knee belongs to."""


LONG = {"huang_110_80_560": pytest.mark.long}
"""Designs whose oil films take seconds; the tests of the paper evaluate them too."""
STEMS = [path.stem for path in ALL]


@pytest.fixture(scope="module")
def optima() -> dict[str, Optimisation]:
    """Shipped designs with variables and without choices, optimised from two starts.

    Those with duty cycles take longer: `test_walking_designs`.
    """
    return {
        path.stem: shipped(path.stem)
        for path in ALL
        if (design := verbs.read(path).design).variables
        and not design.choices
        and design.duty is None
    }


@pytest.mark.parametrize("path", ALL, ids=lambda p: p.stem)
def test_a_shipped_design_has_no_faults(path) -> None:
    """`check` finds nothing to say."""
    assert verbs.check(path) == []


@pytest.mark.parametrize(
    "path", [pytest.param(p, marks=LONG.get(p.stem, ())) for p in ALL], ids=STEMS
)
def test_a_shipped_design_evaluates_to_finite_numbers(path) -> None:
    """Every metric is finite or says why not; nothing in the JSON object is NaN or infinite."""
    evaluation = evaluated(path.stem)
    for metric in evaluation.metrics.values():
        if metric.value is None:
            assert metric.why, metric.name
        else:
            assert math.isfinite(metric.value), metric.name
    json.dumps(evaluation.to_dict(), allow_nan=False)


def test_the_designs_of_the_main_job_are_there(optima) -> None:
    """The knee, its steel baseline and two papers' cylinders are shipped; two have variables."""
    stems = {"knee_bonded", "steel_baseline", "elasswad_knee", "aalto_40_25_220"}
    assert stems <= {path.stem for path in ALL}
    assert {"knee_bonded", "steel_baseline"} <= set(optima)


def test_a_shipped_optimisation_is_optimal(optima) -> None:
    """Status, feasibility and optimality conditions of every shipped optimisation."""
    for name, optimum in optima.items():
        assert optimum.status == "optimal", name
        assert optimum.kkt.residual <= 1e-6, name
        assert optimum.evaluation.met, name
        assert not any(check.status == "missed" for check in optimum.evaluation.checks), name


def _active(optimum: Optimisation) -> list[str]:
    """Metrics of the requirements block that hold with no margin."""
    rows = optimum.evaluation.requirements
    names = [r.metric for r in rows if r.path.startswith("requirements.") and r.margin < 1e-6]
    return list(dict.fromkeys(names))


def test_the_knee_trades_requirements_of_three_groups(optima) -> None:
    """At least four requirements are active, from at least three groups."""
    knee = optima["knee_bonded"]
    assert len(knee.variables) >= 8
    active = _active(knee)
    assert len(active) >= 4
    assert len({GROUPS[name] for name in active}) >= 3


@pytest.mark.long
def test_relaxing_any_active_requirement_of_the_knee_saves_mass(optima) -> None:
    """Re-optimised with one limit 3 % looser, the knee is lighter, whichever limit it is."""
    knee = optima["knee_bonded"]
    start = verbs.Actuator(knee.design)
    for metric in _active(knee):
        limit = knee.design.requirements[metric]
        sense, value = ("max", limit.max) if limit.min is None else ("min", limit.min)
        factor = 1.03 if sense == "max" else 0.97
        looser = start.changed({f"requirements.{metric}.{sense}": factor * value})
        again = verbs.optimise(looser, starts=1, prices=False)
        assert again.status == "optimal", metric
        assert again.objective_value < knee.objective_value * (1 - 1e-6), metric


def test_the_steel_baseline_has_the_duty_of_the_knee() -> None:
    """Everything that is asked of the knee is asked of the steel cylinder, word for word."""
    names = ("knee_bonded", "steel_baseline", "knee", "knee_choices")
    knee, steel, held, chosen = (verbs.read(DESIGNS / f"{n}.yaml").design for n in names)
    asked = ("fluid", "supply", "environment", "seals", "load", "load_cases", "requirements")
    for block in (*asked, "waivers", "objective", "clevis"):
        blocks = [getattr(one, block) for one in (knee, steel, held, chosen)]
        if block == "seals":  # bonded caps need no static seals
            blocks = [(seals.piston, seals.rod) for seals in blocks]
            assert steel.seals.static == held.seals.static == chosen.seals.static
        assert blocks == [blocks[0]] * 4, block
    for block in ("cylinder", "rod"):
        assert getattr(knee, block) == getattr(steel, block), block
    shared = set(knee.variables) & set(steel.variables)
    for path in shared - {"barrel.layup[0].thickness", "retention.wall", "retention.length"}:
        assert knee.variables[path] == steel.variables[path], path


def test_seals_that_bear_a_wider_gap_save_mass(optima) -> None:
    """The load cases of the knee, and its limits but for the gap; at least a tenth lighter."""
    knee, tolerant = (verbs.read(DESIGNS / f"{n}.yaml") for n in ("knee", "knee_gap_tolerant"))
    for block in ("fluid", "supply", "environment", "load", "load_cases", "objective", "clevis"):
        assert getattr(knee.design, block) == getattr(tolerant.design, block), block
    limits = [dict(one.design.requirements) for one in (knee, tolerant)]
    gaps = [one.pop("seal_gap").max for one in limits]
    assert limits[0] == limits[1]
    assert gaps == [34e-6, 60e-6]
    best = verbs.optimise(tolerant, prices=False)
    assert best.status == "optimal"
    assert best.objective_value < 0.9 * optima["knee"].objective_value
    assert best.evaluation.metrics["extrusion_factor"].value > 2


def test_the_steel_baseline_is_all_metal_and_heavier(optima) -> None:
    """One isotropic wall; at equal requirements the composite saves more than a tenth."""
    knee, steel = optima["knee_bonded"], optima["steel_baseline"]
    assert [o.kind for o in steel.evaluation.outlines if o.part.startswith("layup")] == ["metal"]
    assert "composite" in {o.kind for o in knee.evaluation.outlines}
    assert knee.objective_value < 0.9 * steel.objective_value


@pytest.fixture(scope="module")
def published() -> str:
    """Every cell and note of the paper's tables as one text, spaces plain."""
    tables = published_tables(verbs.evaluate(DESIGNS / "elasswad_knee.yaml"))
    cells = [str(cell) for table in tables for row in table.rows for cell in row]
    return re.sub(r"\s", " ", "\n".join([*cells, *(table.note for table in tables)]))


@pytest.mark.parametrize(
    "number",
    [
        "800 MPa",
        "2480 N/mm",
        "13 430 N/mm",
        "0.1 N·s/m",
        "0.61",
        "166 N",
        "400 N",
        "0.12 MPa",
        "0.31 MPa",
        "3.48 GPa",
        "20 mm",
        "25 mm",
        "110 mm",
        "150 mm",
    ],
)
def test_every_published_number_stands_in_the_tables(published, number) -> None:
    """What [ElAsswad2018] prints is set beside ours, none left out."""
    assert re.search(rf"(?<![\d.]){re.escape(number)}(?!\d)", published)


@pytest.mark.parametrize(
    ("number", "why"),
    [
        ("12 635 N/mm", "eq. 9 without lines: 800 MPa (490.87 + 377.77 mm2)/55 mm"),
        ("99.15 ml", "line volume per side behind 2480 N/mm"),
        ("29.59 ml", "the same for a bore of 20 mm"),
        ("118.75 N/mm³", "13430 N/mm over 113.10 mm2"),
        ("13.06 GPa", "times 110 mm"),
        ("17.81 GPa", "times 150 mm"),
        ("3578 N/mm", "eq. 8 with 3.48 GPa over 110 mm"),
        ("1328 N/mm", "A2/(dV/dp) with 3.48 GPa, wall ratio 1.2"),
        ("1.2 times", "eq. 12 with the outer radius"),
        ("26.53 mPa·s", "0.1/(8 pi 0.15)"),
        ("0.07333 N·s/m", "8 pi eta 0.11"),
        ("1383 mm²", "166 N/0.12 MPa"),
        ("1290 mm²", "400 N/0.31 MPa"),
        ("490.9 mm²", "25 mm bore"),
        ("0.406 at 2 MPa", "166 N/(pi 37 mm f), f 0.319 E W by finite elements at p 0.362 E"),
        ("0.141 at 7 MPa", "the same, f 0.925 E W at 1.268 E"),
        ("115 138 N", "series of 2480 and 13430 N/mm times 55 mm"),
    ],
)
def test_the_contradictions_come_out_of_the_models(published, number, why) -> None:
    """Derived numbers equal independent calculations (the second parameter says which)."""
    assert number in published, why


def test_only_a_design_that_names_a_paper_gets_its_tables() -> None:
    """The knee has no published tables; the paper's cylinder has, each with a note."""
    assert published_tables(verbs.evaluate(DESIGNS / "knee_bonded.yaml")) == []
    tables = published_tables(verbs.evaluate(DESIGNS / "elasswad_knee.yaml"))
    assert len(tables) == 9
    for table in tables:
        assert table.note
        assert all(len(row) == len(table.columns) for row in table.rows)


def test_published_tables_follow_the_design() -> None:
    """Our column is computed: another stroke or oil changes it, the published column stays."""
    path = DESIGNS / "elasswad_knee.yaml"
    changed = {"cylinder.stroke": "150 mm", "supply.pressure": "70 bar"}
    before, after = (
        published_tables(verbs.evaluate(verbs.read(path, set=values))) for values in ({}, changed)
    )
    for old, new in zip(before, after, strict=True):
        assert [row[1] for row in old.rows] == [row[1] for row in new.rows]
    assert before[0].rows[1][3] == "110 mm"
    assert after[0].rows[1][3] == "150 mm"
    assert before[5].rows[0][3] != after[5].rows[0][3]


def test_a_report_without_the_replicas_says_where_they_are(monkeypatch) -> None:
    """A wheel comes without the papers' tables: one line of caution in their place."""
    evaluation = verbs.evaluate(DESIGNS / "elasswad_knee.yaml")
    monkeypatch.setitem(sys.modules, REPLICAS, None)
    (notes,) = published_blocks(evaluation)
    assert "ElAsswad2018 are not part of this installation" in notes.items[0]
    assert published_blocks(verbs.evaluate(DESIGNS / "knee_bonded.yaml")) == []
