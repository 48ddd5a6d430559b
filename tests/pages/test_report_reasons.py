"""Blocks of the report on reasons of limits and on the order of assembly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import actuator_opt as ao
from actuator_opt.pages import limits, report

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


def test_places_of_the_limits_worst_first() -> None:
    """The first place of each limit is the governing one; far places are only counted."""
    evaluation = ao.evaluate(ao.read(DESIGNS / "knee.yaml"))
    table = next(iter(limits.places(evaluation)))
    names = [str(row.cells[0]) for row in table.rows]
    starts = [k for k, name in enumerate(names) if name]
    assert names.count("cap retention at burst pressure") == 1
    for start, stop in zip(starts, [*starts[1:], len(names)], strict=True):
        margins = [
            float(row.cells[4].replace("−", "-").rstrip(" %")) for row in table.rows[start:stop]
        ]
        assert margins == sorted(margins)
        assert margins[-1] < 100
    metric = evaluation.metrics["retention_burst_factor"]
    row = table.rows[names.index("cap retention at burst pressure")]
    assert row.cells[1] == metric.place
    assert metric.by_place[metric.place] == metric.value == min(metric.by_place.values())
    counted = int(table.note.split()[0])
    assert counted + len(table.rows) == sum(
        len(evaluation.metrics[name].by_place)
        for name in {
            limit.metric
            for limit in (*evaluation.requirements, *evaluation.checks)
            if limit.metric and limit.limit and len(evaluation.metrics[limit.metric].by_place) > 1
        }
    )


def test_a_torque_at_one_position_is_no_limit_of_the_stops() -> None:
    """The walking knee meets everything, so that no place of a limit has a negative margin."""
    evaluation = ao.evaluate(ao.read(DESIGNS / "knee_walking.yaml"))
    assert evaluation.metrics["joint_torque_min"].by_place["retracted"] < 51.3
    table = next(iter(limits.places(evaluation)))
    assert not [row.cells for row in table.rows if "−" in str(row.cells[4])]
