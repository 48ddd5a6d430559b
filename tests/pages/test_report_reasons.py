"""Blocks of the report on reasons of limits and on the order of assembly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import actuator_opt as ao
from actuator_opt.pages import report

DESIGNS = Path(__file__).parents[2] / "designs"


def blocks(name: str) -> dict[str, Any]:
    """Blocks of the report of a design, by title."""
    evaluation = ao.evaluate(ao.read(DESIGNS / f"{name}.yaml"))
    return {block.title: block for block in report.page(evaluation).blocks}


def test_every_limit_of_the_knee_has_a_reason() -> None:
    """One row for each requirement, with its limit, in the words of the file."""
    design = ao.read(DESIGNS / "knee.yaml").design
    table = blocks("knee")["Why these limits"]
    assert [row[0] for row in table.rows] == list(design.requirements)
    first = table.rows[0]
    assert first[1] == "≥ 10 kN/mm"
    assert first[2] == design.requirements["stiffness_min"].reason
    assert "Why these limits" not in blocks("aerospace")


def test_the_order_of_assembly_is_in_the_report() -> None:
    """The sentences of the joints, in their order."""
    lines = blocks("steel_baseline")["Order of assembly"].items
    assert [line.split()[0] for line in lines] == ["Set", "Screw", "Insert", "Screw", "Screw"]
