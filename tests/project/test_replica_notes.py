"""The notes of the re-created papers: numbers with their place, read strictly."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from actuator_opt.replicas import CASES, MODULES, papers


@dataclass(frozen=True)
class Numbers:
    """Two published numbers."""

    bore: float
    loads: tuple[float, float]


BORE = {"value": "40 mm", "quantity": "length", "place": "table 1"}
LOADS = {"value": ["1 kN", "2 kN"], "quantity": "force", "place": "figure 2"}


def given(monkeypatch, **published):
    """Notes of one paper, made up."""
    monkeypatch.setattr(papers, "_data", lambda paper: {"published": published})
    return papers.published_numbers(Numbers, "made-up")


def test_numbers_are_read_in_si(monkeypatch):
    """One number or several, each with its unit."""
    assert given(monkeypatch, bore=BORE, loads=LOADS) == Numbers(0.04, (1000.0, 2000.0))


@pytest.mark.parametrize(
    "published",
    [
        {"bore": BORE},
        {"bore": BORE, "loads": LOADS, "rod": BORE},
        {"bore": BORE | {"value": "40"}, "loads": LOADS},
        {"bore": BORE | {"value": "40 bar"}, "loads": LOADS},
        {"bore": {"value": "40 mm", "quantity": "length"}, "loads": LOADS},
    ],
    ids=["missing", "unknown", "no unit", "wrong unit", "no place"],
)
def test_a_fault_in_the_notes_is_refused(monkeypatch, published):
    """Every number is known, has its unit and its place."""
    with pytest.raises(ValueError, match=r"bore|loads|rod|unit|bar"):
        given(monkeypatch, **published)


@pytest.mark.parametrize("entry", ["2", "1 to 0"])
def test_equations_stand_in_order(monkeypatch, entry):
    """No equation is left out."""
    rows = [{"equations": entry, "subject": "x"}]
    monkeypatch.setattr(papers, "_data", lambda paper: {"equations": rows})
    with pytest.raises(ValueError, match="equation 1 expected"):
        papers.equations("made-up")


@pytest.mark.parametrize("paper", sorted({*MODULES.values(), *CASES.values()}))
def test_every_number_has_its_place(paper):
    """The shipped notes: a place for each number, and no empty one."""
    for entry in papers._data(paper)["published"].values():
        assert entry["place"].strip()
