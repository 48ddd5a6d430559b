"""`compare`: every difference is named, parts add up to what they explain, nothing else is said."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from string import ascii_uppercase

import pytest
from cli_runner import BENCH, DESIGNS, run
from hypothesis import given, settings, strategies as st
from shipped import evaluated

import actuator_opt as ao
from actuator_opt.api.reports import origin as origin_of
from actuator_opt.pages.comparison import comparison_figure, comparison_ucurves, page, sentences
from actuator_opt.rendering import heights, paper, terminal
from actuator_opt.rendering.blocks import Table

SMALL = BENCH.replace("  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n", "")
SHIPPED = sorted(DESIGNS.glob("*.yaml"))[:12]


@pytest.fixture(scope="module")
def base():
    """The bench design as it stands."""
    return ao.read(SMALL)


@pytest.fixture(scope="module")
def shipped():
    """The shipped designs."""
    return {path.stem: evaluated(path.stem) for path in SHIPPED}


@pytest.mark.parametrize("name", [path.stem for path in SHIPPED])
def test_parts_add_up(shipped, name):
    """Mass parts to the mass, compliances to 1/stiffness, frictions to the friction."""
    other = next(e for key, e in shipped.items() if key != name)
    found = ao.compare(shipped[name], other)
    for question in found.questions:
        value = question.values[0]
        total = sum(values[0] for values in question.parts.values())
        if value is None or not question.parts:
            continue
        expected = 1 / value if question.name == "stiffer" else value
        assert total == pytest.approx(expected, rel=2e-3 if question.name == "stiffer" else 1e-9)


def test_what_is_set_is_what_differs(base):
    """Exactly the PATHs changed, in SI with their unit, the friction by hand."""
    other = ao.read(SMALL, set={
        "cylinder.bore": "24 mm", "seals.rod.friction_coefficient": 0.05, "load_cases[swing].force":
        "1 kN", "name": "other",
        "requirements.burst_factor.min": 4.0,
    })  # fmt: skip
    found = ao.compare(base, other)
    changes = {c.path: c.values for c in found.changes}
    assert changes == {
        "cylinder.bore": (0.022, 0.024),
        "seals.rod.friction_coefficient": (0.10, 0.05),
        "load_cases[swing].force": (2000.0, 1000.0),
        "requirements.burst_factor.min": (3.0, 4.0),
    }
    data = ao.comparison_json(found)
    units = {row["path"]: row["unit"] for row in data["differences"]}
    assert units["cylinder.bore"] == "m"
    assert units["load_cases[swing].force"] == "N"
    # at one pressure and speed the friction of a seal is its coefficient times its contact load
    half = ao.compare(base, ao.read(SMALL, set={"seals.rod.friction_coefficient": 0.05}))
    rod = half.questions[2].parts["rod seal"]
    assert rod[1] == pytest.approx(rod[0] / 2, rel=1e-9)
    piston = half.questions[2].parts["piston seal"]
    assert piston[1] == pytest.approx(piston[0], rel=1e-12)
    assert half.questions[2].steps == (("rod seal", rod[1] - rod[0]),)
    assert (half.questions[0].best, half.questions[1].best, half.questions[2].best) == (
        None,
    ) * 2 + (1,)
    assert any("swing" in path for path in found.differing_conditions)


def test_one_part_alone_is_the_reason(base):
    """A cap of half the thickness: all of the saved mass is in the caps, none elsewhere."""
    thin = base.changed({"caps.thickness": 0.004})
    found = ao.compare(base, thin)
    lighter = found.questions[0]
    assert (lighter.best, lighter.other) == (1, 0)
    parts = dict(lighter.steps)
    saved = lighter.values[1] - lighter.values[0]
    assert sum(parts.values()) == pytest.approx(saved, rel=1e-9)
    assert parts["caps"] < 0
    assert sentences(found)[0].startswith("lighter: B, ")


def test_ties_have_no_winner_and_groups_do(base):
    """Equal designs in a respect are equal in words; two that lead are both named."""
    slow = base.changed({"load_cases[swing].speed": 0.15})
    found = ao.compare(base, slow)
    assert sentences(found)[0] == "lighter: none, as all are equally light"
    heavy = base.changed({"caps.thickness": 0.012})
    three = ao.compare(base, slow, heavy)
    assert three.questions[0].leaders == (0, 1)
    assert sentences(three)[0].startswith("lighter: A and B, ")
    assert "their operating conditions differ (load_cases[swing].speed)" in sentences(three)[-1]


@pytest.mark.long
def test_any_pair_of_shipped_designs(shipped):
    """Whatever their build: tables fit the terminal, labels the paper, JSON is JSON."""
    for a, b in itertools.combinations(shipped.values(), 2):
        found = ao.compare(a, b)
        for width in (80, 100):
            text = terminal.text(page(found), width=width)
            assert max(map(len, text.splitlines())) <= width, (a.name, b.name)
        assert terminal.text(page(found), unicode=False).isascii()
        _require_clear(comparison_figure(found))
        _require_clear(comparison_ucurves(found))


def _require_clear(ink):
    """No words beyond the paper, none on others."""
    boxes = ink.text_boxes()
    for words, left, top, right, bottom in boxes:
        assert left >= 0, words
        assert right <= ink.width, words
        assert top >= 0, words
        assert bottom <= ink.height, words
    for one, two in itertools.combinations(boxes, 2):
        apart = one[3] <= two[1] or two[3] <= one[1] or one[4] <= two[2] or two[4] <= one[2]
        assert apart, (one, two)


def test_long_names_are_whole_in_the_figure(shipped):
    """Six designs with names and files of two lines; a chamber is told apart from a design."""
    long = " ".join(["a knee of the second generation with a thicker barrel"] * 3)
    found = ao.compare(*list(shipped.values())[:6])
    named = tuple(replace(one, name=long) for one in found.evaluations)
    origins = tuple(f"{'folder/' * 30}{k}.yaml" for k in range(6))
    ink = comparison_figure(replace(found, evaluations=named, origins=origins))
    _require_clear(ink)
    said = " ".join(mark["text"] for mark in ink.marks if "text" in mark)
    assert said.count(long) == 6
    assert "oil in chamber A" in said


def test_stiffness_over_the_stroke_of_designs(shipped):
    """The least stiffness and what is required of whom stand with the curves; six at most."""
    path = DESIGNS / "knee_bonded.yaml"
    stiffer = ao.evaluate(ao.read(path, set={"requirements.stiffness_min.min": "11 kN/mm"}))
    others = [one for name, one in shipped.items() if name != "knee"]
    found = ao.compare(shipped["knee"], stiffer, *others[:5])
    ink = comparison_ucurves(found)
    _require_clear(ink)
    said = [mark["text"] for mark in ink.marks if "text" in mark]
    least = stiffer.metrics["stiffness_min"].value / 1e6
    assert f"B: least {least:.4g}" in said
    assert "≥ 11 of B" in said
    assert sum(": least " in one for one in said) == 6


def test_many_designs_at_once(shipped):
    """All shipped ones: the first in every piece of a table, each design in some piece."""
    found = ao.compare(*shipped.values())
    text = terminal.text(page(found), width=80)
    assert max(map(len, text.splitlines())) <= 80
    heads = [line.split() for line in text.splitlines() if line.split()[:1] == ["A"]][1:]
    assert all(head[0] == "A" and len(head) > 1 for head in heads)
    assert {label for head in heads for label in head} >= set(found.labels)
    data = ao.comparison_json(found)
    assert [one["label"] for one in data["designs"]] == list(ascii_uppercase[: len(SHIPPED)])
    for row in data["differences"]:
        assert len(row["values"]) == len(SHIPPED)
        assert len({str(value) for value in row["values"]}) > 1, row
    assert set(data["answers"]) == {"lighter", "stiffer", "smoother"}


def test_the_page_of_many_designs_fits_its_sheets(shipped):
    """Bars fill the room of the first sheet; the first design stands in every part of a table."""
    found = ao.compare(*shipped.values())
    sheet = page(found)
    hero = sheet.hero(heights.room(sheet))
    _require_clear(hero)
    assert hero.height <= heights.room(sheet) + 1e-6
    tables = [block for block in sheet.blocks if isinstance(block, Table)]
    parts = [part for table in tables for part in heights.fitting(table, heights.FULL)]
    assert len(parts) > len(tables)
    assert all([column.head for column in part.columns[:2]] == ["", "A"] for part in parts)
    shown = {table.title: set() for table in tables}
    for part in parts:
        shown[part.title] |= {column.head for column in part.columns}
    assert all(heads == {"", *found.labels} for heads in shown.values())


def test_the_page_is_written_on_paper(base, tmp_path):
    """Bars, answers and tables of two designs as PDF."""
    found = ao.compare(base, ao.read(SMALL, set={"cylinder.bore": "24 mm", "name": "other"}))
    origin = origin_of(base.design, base.source)
    files = paper.write(page(found), origin, folder=tmp_path, stem="both")
    assert [file.path.name for file in files][:2] == ["both.pdf", "both.png"]


@settings(max_examples=6)
@given(st.floats(0.0205, 0.029), st.floats(0.0005, 0.004))
def test_turned_round_it_says_the_same(bore, thickness):
    """The better design and what each part changes do not depend on the order."""
    a = ao.evaluate(ao.read(SMALL))
    b = ao.evaluate(
        ao.read(SMALL, set={"cylinder.bore": bore, "barrel.layup[1].thickness": thickness})
    )
    one, two = ao.compare(a, b), ao.compare(b, a)
    assert [c.path for c in one.changes] == [c.path for c in two.changes]
    for x, y in zip(one.questions, two.questions, strict=True):
        assert (x.best is None) == (y.best is None)
        if x.best is not None:
            assert x.best == 1 - y.best
            assert dict(x.steps) == dict(y.steps)


@pytest.mark.long
def test_runs_are_compared_as_they_were(tmp_path, monkeypatch):
    """The optimum of a run beside the file it came from; --set does not reach a run."""
    monkeypatch.setenv("ACTUATOR_OPT_RUNS", str(tmp_path / "runs"))
    design = tmp_path / "small.yaml"
    design.write_text(SMALL)
    optimum = run("optimise", design, "--json").json
    result = run("compare", design, "last", "--json", "--out", tmp_path / "out")
    data = result.json
    assert data["metrics"]["mass"]["values"][1] == optimum["metrics"]["mass"]["value"]
    assert {row["path"] for row in data["differences"]} >= {"cylinder.bore"}
    assert data["designs"][1]["origin"].startswith("run ")
    assert sorted(one.name for one in (tmp_path / "out").iterdir()) == [
        "comparison-stiffness.png", "comparison-stiffness.svg",
        "comparison.png", "comparison.svg",
    ]  # fmt: skip
    assert run("compare", design, "last", "--set", "load.mass=3 kg").code == 2
    assert run("compare", "last", "last", "--json").code == 3


def test_what_cannot_be_compared(tmp_path):
    """One, none, the same twice, unreadable ones: all faults at once, nothing written."""
    good = tmp_path / "good.yaml"
    good.write_text(SMALL)
    renamed = tmp_path / "renamed.yaml"
    renamed.write_text(SMALL.replace("name: test bench", "name: other"))
    bad = tmp_path / "bad.yaml"
    bad.write_text(SMALL.replace("22 mm", "-22 mm"))
    assert run("compare").code == 2
    one = run("compare", good, "--json")
    assert (one.code, one.errors[0]["message"]) == (2, "one design cannot be compared")
    one = run("compare", "-", "-", "--json", stdin=b"")
    assert (one.code, one.errors[0]["message"]) == (2, "standard input can only give one design")
    for twice in ((good, good), (good, renamed)):
        same = run("compare", *twice, "--json", "--out", tmp_path / "out")
        assert same.code == 3
        assert "are the same design" in same.errors[0]["message"]
    faults = run("compare", good, bad, tmp_path / "none.yaml", "--json").errors
    assert {fault["file"] for fault in faults} == {str(bad), str(tmp_path / "none.yaml")}
    assert run("compare", *[good] * 13).code == 2
    assert run("compare", good, "2024", "--json").code == 3
    assert not (tmp_path / "out").exists()
    piped = run("compare", "-", DESIGNS / "knee_bonded.yaml", "--json", stdin=SMALL.encode())
    assert piped.json["designs"][0]["origin"] == "<stdin>"


def test_an_unknown_value_is_said(base):
    """A metric without an answer has no winner; the reason stands in the sentence."""
    evaluation = ao.evaluate(base)
    from dataclasses import replace

    lost = dict(evaluation.metrics)
    lost["stiffness_min"] = replace(lost["stiffness_min"], value=None, why="no stroke")
    other = ao.evaluate(base.changed({"caps.thickness": 0.005}))
    found = ao.compare(other, replace(evaluation, metrics=lost))
    assert "not known; stiffness of B is not known: no stroke" in sentences(found)[1]


@pytest.fixture(scope="module")
def optima(base):
    """Two optima: as given, and with another cap."""
    other = base.changed({"caps.thickness": 0.012})
    return [ao.optimise(one, prices=False, starts=1) for one in (base, other)]


NOT_KNOWN = "known to be"


def test_optima_and_evaluated_designs_are_told_apart(base, optima):
    """In words, in JSON and on the figures: which design is an optimum, and how to make it one."""
    assert [one.status for one in optima] == ["optimal", "optimal"]
    found = ao.compare(base, optima[0])
    data = ao.comparison_json(found)
    assert [one["state"] for one in data["designs"]] == ["evaluated", "optimum"]
    assert [one["status"] for one in data["designs"]] == [None, "optimal"]
    (line,) = [note for note in data["notes"] if NOT_KNOWN in note]
    assert line.startswith("A is not known to be an optimum: ")
    assert line.endswith("; --optimise optimises each design first")
    words = " ".join(terminal.text(page(found), width=100).split())
    assert "A test bench (small.yaml), evaluated, not optimised, requirements" in words.replace(
        found.origins[0], "small.yaml"
    )
    assert "B test bench, optimum, requirements met" in words
    for ink in (comparison_figure(found), comparison_ucurves(found)):
        drawn = " ".join(mark["text"] for mark in ink.marks if "text" in mark)
        assert "A is not known to be an optimum" in drawn
        assert "evaluated, not optimised" in drawn
        _require_clear(ink)
    both = ao.compare(*optima)
    assert not any(NOT_KNOWN in note for note in ao.comparison_json(both)["notes"])
    assert "known" not in str([mark.get("text") for mark in comparison_figure(both).marks])


def test_a_search_without_an_optimum_is_none(optima):
    """An optimisation that met nothing, or was stopped, is no optimum, whatever it is called."""
    missed = replace(optima[1], status="limit_infeasible")
    found = ao.compare(optima[0], missed)
    assert [one.word for one in found.states] == ["optimum", "evaluated"]
    assert "no optimum (search: limit infeasible)" in terminal.text(page(found), width=100)
    (line,) = [note for note in ao.comparison_json(found)["notes"] if NOT_KNOWN in note]
    assert "--optimise" not in line  # it was


def test_a_saved_optimum_is_one_until_it_changes(base, optima, tmp_path):
    """The file says so by the hash of its design: with another bore or limit it is none."""
    file = ao.save(optima[0], tmp_path / "best.yaml", source=base.source)
    text = file.read_text(encoding="utf-8")
    assert text.startswith(
        "# Written by actuator-opt optimise: an optimum as long as its spec hash is "
    )
    assert ao.read(file).design == optima[0].best

    def state(path, **how):
        return ao.compare(path, optima[1], **how).states[0].word

    assert state(file) == "optimum"
    assert state(file, set={"requirements.burst_factor.min": 3.1}) == "evaluated"
    edited = tmp_path / "edited.yaml"
    edited.write_text(re.sub(r"  bore: \S+ mm", "  bore: 22.5 mm", text), encoding="utf-8")
    assert state(edited) == "evaluated"
    again = ao.save(optima[0], tmp_path / "again.yaml", source=ao.read(file).source)
    assert again.read_text(encoding="utf-8") == text  # one stamp, not two
    plain = ao.save(optima[0].best, tmp_path / "plain.yaml", source=base.source)
    assert state(plain) == "evaluated"
    first = optima[0].evaluation
    own = replace(first, metrics={**first.metrics, "own": first.metrics["mass"]})
    file = ao.save(replace(optima[0], evaluation=own), tmp_path / "own.yaml", source=base.source)
    assert "spec hash" not in file.read_text(encoding="utf-8")


def test_compare_optimises_first(tmp_path, monkeypatch):
    """`--optimise`: each file's optimum, as `optimise` finds it; without variables it stays."""
    monkeypatch.setenv("ACTUATOR_OPT_RUNS", str(tmp_path / "runs"))
    one, other, fixed = (tmp_path / f"{name}.yaml" for name in ("one", "other", "fixed"))
    one.write_text(SMALL, encoding="utf-8")
    other.write_text(SMALL.replace("name: test bench", "name: other"), encoding="utf-8")
    before, rest = SMALL.split("\nvariables:\n")
    after = rest[rest.index("\n\n") :]
    fixed.write_text(f"{before}\n{after}", encoding="utf-8")
    limits = ["--set", "requirements.burst_factor.min=3.5"]
    alone = ao.optimise(ao.read(one, set={"requirements.burst_factor.min": 3.5}), prices=False)
    found = run("compare", str(one), str(fixed), "--optimise", *limits, "--json")
    assert found.code == 0
    designs = found.json["designs"]
    assert [(d["state"], d["status"]) for d in designs] == [
        ("optimum", "optimal"),
        ("evaluated", None),
    ]
    assert found.json["metrics"]["mass"]["values"][0] == pytest.approx(
        alone.objective_value, rel=1e-12
    )
    (line,) = [note for note in found.json["notes"] if NOT_KNOWN in note]
    assert line.startswith("B is not known to be an optimum")
    assert "--optimise" not in line  # it has no variables


def test_values_of_other_senses_are_not_compared(base):
    """Where one design limits what another maximises, the two values are not alike."""
    most = base.changed({"requirements.end_stop_pressure.max": 4e7, "caps.thickness": 0.009})
    least = base.changed({"requirements.end_stop_pressure.min": 1e5})
    found = ao.compare(most, least)
    first, second = (e.metrics["end_stop_pressure"] for e in found.evaluations)
    assert (first.sense, second.sense) == ("max", "min")
    assert (
        "end_stop_pressure: cannot be compared, because the worst value is the smallest for B, "
        "but the largest for A" in " ".join(ao.comparison_json(found)["notes"])
    )
    limit = "friction_running:\n    max: 500 N"
    assert limit in SMALL
    rubbing = ao.compare(base, ao.read(SMALL.replace(limit, "friction_running:\n    min: 1 N")))
    assert rubbing.questions[2].best is None
    assert "smoother: not known" in sentences(rubbing)
