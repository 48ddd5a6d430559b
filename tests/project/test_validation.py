"""The page of validation: every published number is reproduced, or contradicted with a reason."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def cases():
    """The cases of the page."""
    sys.path.insert(0, str(ROOT / "docs"))
    from extensions import validation_cases

    return validation_cases


def test_verdicts_have_reasons_and_names_exist(cases):
    """Deviation and reason fit, numbers are finite, sources and tests exist."""
    assert cases.faults() == []
    rows = [case for group in cases.GROUPS.values() for case in group()]
    assert len({case.subject for case in rows}) == len(rows)
    assert all(abs(case.value()) < float("inf") for case in rows)
    named = {row.tests for row in [*rows, *cases.CLAIMS, *cases.AGREEMENTS]}
    for name in named:
        path, _, function = name.partition("::")
        assert f"def {function}(" in (ROOT / path).read_text("utf-8"), name


def test_a_wrong_value_is_found(cases, monkeypatch):
    """A value off by more than its tolerance, and a reason without need, are faults."""
    case = cases.Case("size", "table", 2.0, 2.1, "", within=0.01)
    excused = cases.Case("other size", "table", (2.0, 3.0), 2.5, "", why="misprint")
    assert case.deviation() == pytest.approx(0.05)
    assert excused.deviation() == 0
    monkeypatch.setattr(cases, "GROUPS", {"group": lambda: iter([case, excused])})
    found = cases.faults()
    assert [line.split(": ")[1] for line in found] == ["size", "other size"]
