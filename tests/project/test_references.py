"""Every model says what it takes, gives, when it holds, where it comes from, and is tested.

``pytest -s tests/project/test_references.py -k table`` prints equation -> function -> test.
"""

from __future__ import annotations

import inspect
import re
from importlib.resources import files
from pathlib import Path

import pytest
import yaml
from docs_pages import docstrings
from model_samples import public_functions

from actuator_opt.metrics.documentation import describe, function_of
from actuator_opt.metrics.metric_row import CRITERION
from actuator_opt.metrics.table import ROWS
from actuator_opt.models import elastomer, seals

ROOT = Path(__file__).parents[2]
REFERENCES = yaml.safe_load((files("actuator_opt") / "references.yaml").read_text("utf-8"))
FUNCTIONS = public_functions()
sections, entries = docstrings.sections, docstrings.entries
SECTIONS = ["Parameters", "Returns", "Notes", "References", "Examples"]
UNITLESS = {
    "bool", "Ends", "PlyStrength", "Sequence[WallLayer]", "tuple[str, str]", "Sequence[TubeLayer]",
    "LayeredTube", "TubeState", "LineEnd", "Side", "LinearActuator", "PositionOpenLoop",
    "Chamber", "ShellLayer", "Shell", "Edge", "Sequence[ShellLayer]", "Sequence[FibreLayer]",
}  # fmt: skip
"""Annotations of arguments that carry no unit of their own."""
WALKS = {"model_samples.py", "test_models_laws.py", "test_references.py"}
"""Tests that walk all models: they show laws, not values."""
LONGEST_RANGE = 90
"""Characters of a valid range: it is printed in a table of the report."""


def keys(text):
    """Reference keys of a text: bracketed words that have an entry, or look as if they should."""
    words = set(re.findall(r"\[([A-Z][\w-]*)\]", text))
    return {word for word in words if word in REFERENCES or re.search(r"[A-Za-z-]\d{3,}", word)}


def cited_text():
    """Every source, test and material file, as one text."""
    paths = [p for d in ("actuator_opt", "tests", "materials") for p in (ROOT / d).rglob("*")]
    wanted = [p for p in paths if p.suffix in {".py", ".yaml"} and p.name != "references.yaml"]
    return "\n".join(p.read_text("utf-8") for p in sorted(wanted))


def test_references_are_complete():
    """Author, title, place and year (a note says why one is missing), and how it was seen."""
    for key, entry in REFERENCES.items():
        assert set(entry) <= {"author", "title", "where", "year", "doi", "seen", "note"}, key
        assert all(entry[part].strip() for part in ("author", "title", "where")), key
        assert entry["seen"] in {"source", "recalled"}, key
        assert isinstance(entry["year"], int) or (entry["year"] is None and entry["note"]), key


def test_cited_keys_and_references_match():
    """No key is cited without an entry, and no entry is idle."""
    assert keys(cited_text()) == set(REFERENCES)


def test_every_model_is_documented():
    """Summary, unit of every argument and result, valid range, source, example: in this order."""
    for name in FUNCTIONS:
        parts = sections(FUNCTIONS[name])
        assert [part for part in parts if part not in ("", "Raises")] == SECTIONS, name
        summary = parts[""].partition("\n")[0]
        assert summary.endswith("."), name
        documented = entries(parts["Parameters"])
        arguments = inspect.signature(FUNCTIONS[name]).parameters
        assert set(documented) == set(arguments), name
        for argument, parameter in arguments.items():
            if parameter.annotation not in UNITLESS:
                assert re.search(r"\[[^\]]+\]", documented[argument]), (name, argument)
        assert re.search(r"\[[^\]]+\]", parts["Returns"]), f"{name}: no unit of the result"
        valid = re.match(r"Valid: (.*?)(?:\n\n|\Z)", parts["Notes"], flags=re.DOTALL)
        assert len(" ".join(valid[1].split())) <= LONGEST_RANGE, name
        assert ">>> " in parts["Examples"], name


def test_every_model_has_a_source():
    """A known key, or [derived] followed by the derivation."""
    for name in FUNCTIONS:
        reference = " ".join(sections(FUNCTIONS[name])["References"].split())
        derived = re.findall(r"\[derived\]([^;\[]*)", reference)
        assert derived or keys(reference), name
        assert set(re.findall(r"\[([^\]]+)\]", reference)) <= {"derived", *REFERENCES}, name
        assert all(re.search(r"\w{2,}", reason) for reason in derived), f"{name}: no reason"


@pytest.mark.parametrize("law", [*seals.LAWS.values(), *elastomer.MODULUS_LAWS.values()])
def test_every_law_of_a_registry_has_a_source(law):
    """Registry entries cite a known key or a derivation, as functions do."""
    assert keys(law.reference) or re.search(r"\[derived\] \w+", law.reference)
    assert keys(law.reference) <= set(REFERENCES)


def test_metrics_find_their_source():
    """What the evaluation reads from a docstring is there: source and valid range."""
    for metric, row in ROWS.items():
        for name in {row.model, *row.by_wall.values(), *row.at.values()} - {None, CRITERION}:
            model = describe(function_of(name))
            assert model.name == name, metric
            assert model.name in FUNCTIONS, metric
            assert model.reference, metric
            assert 0 < len(model.valid) <= LONGEST_RANGE, metric


def equation_table():
    """Rows of source, function, test files: the value tests that name the function."""
    tests = {
        path.name: docstrings.names_used(path.read_text("utf-8"))
        for path in sorted((ROOT / "tests").rglob("test_*.py"))
        if path.name not in WALKS
    }
    return [
        (
            " ".join(sections(function)["References"].split()),
            name,
            [file for file, used in tests.items() if name in used],
        )
        for name, function in FUNCTIONS.items()
    ]


def test_table_of_equations_has_a_test_for_each():
    """Every public model function is named by a test of its values."""
    rows = equation_table()
    for reference, name, tests in rows:
        print(f"{reference} -> {name} -> {', '.join(tests)}")
    assert [name for _, name, tests in rows if not tests] == []
