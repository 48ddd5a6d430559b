"""`explain` and `list`: each name has its screen, value and source; hostile words get one line."""

from __future__ import annotations

import csv
import io
import re
import subprocess
import sys

import pytest
import yaml
from cli_runner import BENCH, ROOT, bench, run, spawn

import actuator_opt as ao
from actuator_opt.api.explaining import explained
from actuator_opt.api.glossary import terms
from actuator_opt.api.reference import LISTS, all_entries
from actuator_opt.base.units import BASE
from actuator_opt.metrics.table import CHECKS, ROWS

PLAIN = {"colour": False, "unicode": True, "width": 80}
SCREEN = 24


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """The bench design as a file."""
    path = tmp_path_factory.mktemp("reference") / "bench.yaml"
    path.write_text(BENCH, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def evaluation():
    """The bench design evaluated."""
    return ao.evaluate(f"{BENCH}\n")


def test_each_of_several_models_says_for_which_wall_it_applies():
    """Burst: a metal tube, an exact layered tube or a thin laminate, by barrel.model."""
    explanation = ao.explain("burst_factor")
    assert explanation.model == (
        "barrel.burst_pressure_thick (barrel.model isotropic), tube_burst.burst_of_tube (layered), "
        "burst_ladder.burst_by_ply_discount (thin_laminate)"
    )
    words = " ".join(explanation.text(**PLAIN).split())
    assert "burst_by_ply_discount (thin_laminate)" in words, "not cut off"
    several = [row for row in ROWS.values() if row.by_wall]
    assert len(several) > 3
    for row in several:
        for model in ao.explain(row.name).model.split(", "):
            assert model.endswith(")"), (row.name, model)
    assert "(" not in ao.explain("mass").model


def test_every_entry_has_definition_unit_and_source():
    """Every name explains itself on one screen of 80 columns, and says where its number comes from.

    Sources: of metrics and checks a model or a statement that there is none; of joints, seals and
    laws a model with a reference; of materials and terms a citation; of numbers a valid range.
    """
    references = set(yaml.safe_load((ROOT / "actuator_opt/references.yaml").read_text("utf-8")))
    kinds = set()
    for entry in all_entries():
        explanation = explained(entry)
        kinds.add(entry.kind)
        assert entry.phrase.strip(), entry.name
        assert explanation.definition.strip(), entry.name
        assert entry.unit, entry.name
        assert entry.quantity is None or entry.quantity.dimension in BASE, entry.name
        if entry.kind in ("metric", "check", "joint", "seal type", "friction law"):
            assert explanation.model, entry.name
        if entry.kind not in ("PATH", "block"):
            assert explanation.source, entry.name
        if entry.kind == "PATH" and entry.quantity is not None:
            assert explanation.validity, entry.name
        for key in re.findall(r"\[([A-Z][\w-]*\d{4}[\w-]*)\]", explanation.source):
            assert key in references, (entry.name, key)
        if entry.kind != "term":
            assert explanation.ask, entry.name
        lines = explanation.text(**PLAIN).splitlines()
        assert len(lines) <= SCREEN, (entry.name, len(lines))
        assert all(len(line) <= 80 for line in lines), entry.name
        assert explanation.to_dict()["name"] == entry.name
    assert len(kinds) == 10


def test_names_to_look_up_next_exist():
    """Every name under "see" of a term, check or seal can itself be explained."""
    for term in terms().values():
        for name in term.related:
            if name not in ("choices", "uncertainty"):  # blocks with free keys
                assert ao.explain(name).entry.name, (term.name, name)


def _lines_to_copy(explanation):
    """Lines for a file, and values for --set, of an explanation."""
    lines = [line for line in explanation.ask if re.match(r"\w+: \{", line)]
    sets = [re.fullmatch(r'--set "(.+?)=(.+)"', line) for line in explanation.ask]
    return lines, [(match[1], match[2]) for match in sets if match]


def test_lines_to_copy_are_accepted(file):
    """With the bench design, every requirement, objective, variable and --set line is read.

    They are not only well-formed: each is put into the design, which then has no faults but those
    that depend on other values.
    """
    design = ao.read(file)
    names = ["mass", "seal_gap", "cylinder.mount", "fluid.temperature", "barrel.layup[1].angle"]
    for name in names:
        lines, sets = _lines_to_copy(ao.explain(name, design))
        assert lines
        for pair in sets:
            ao.read(file, set=[pair])
        for line in lines:
            ((key, value),) = yaml.safe_load(line).items()
            tree = yaml.safe_load(BENCH)
            tree[key] = value if key == "objective" else tree.get(key, {}) | value
            ao.read(yaml.safe_dump(tree))


def test_metric_with_a_design(file, evaluation):
    """Value, margin and influences are those of the evaluation and of changed designs."""
    explanation = ao.explain("stiffness_min", file)
    metric = evaluation.metrics["stiffness_min"]
    assert explanation.entry.value == metric.value
    row = next(x for x in evaluation.requirements if x.metric == "stiffness_min")
    assert f"required >= 6 kN/mm: met, margin {100 * row.margin:.3g} %" in explanation.value
    assert 3 <= len(explanation.influences) <= 5
    sizes = [abs(x) for x in explanation.influences.values()]
    assert sizes == sorted(sizes, reverse=True)
    path = "cylinder.stroke"
    step = 1e-4
    values = [
        ao.evaluate(ao.read(file, set={path: 0.11 * (1 + sign * step)}))
        .metrics["stiffness_min"].value
        for sign in (-1, 1)
    ]  # fmt: skip
    slope = (values[1] - values[0]) / (2 * step * metric.value)
    assert explanation.influences[path] == pytest.approx(slope, rel=1e-4)
    moved = ao.explain(path, file)
    assert moved.influences["stiffness_min"] == pytest.approx(slope, rel=1e-4)
    assert moved.entry.value == 0.11


def test_area_moves_force_by_two():
    """F = p A: with no friction to speak of, 1 % more bore gives 2 % more push force."""
    text = bench(("friction_coefficient: 0.10", "friction_coefficient: 0.001"))
    text = text.replace("friction_coefficient: 0.10", "friction_coefficient: 0.001")
    text = text.replace("return_pressure: 5 bar", "return_pressure: 0 bar")
    influences = ao.explain("push_force", f"{text}\n").influences
    assert influences["cylinder.bore"] == pytest.approx(2.0, abs=0.02)
    assert influences["supply.pressure"] == pytest.approx(1.0, abs=0.02)


def test_lists_have_every_name(file, evaluation):
    """Lists are complete; TSV in a pipe has display units, JSON has SI."""
    assert [e.name for e in ao.catalogue("metrics")] == list(ROWS)
    assert [e.name for e in ao.catalogue("checks")] == [line.number for _, line in CHECKS]
    rows = list(csv.reader(io.StringIO(run("list", "metrics", file).out), delimiter="\t"))
    assert rows[0] == ["name", "now", "unit", "phrase"]
    now = {name: (value, unit) for name, value, unit, _ in rows[1:]}
    mass = evaluation.metrics["mass"].value
    assert now["mass"][1] == "g"
    assert float(now["mass"][0]) == pytest.approx(1e3 * mass, rel=1e-11)
    data = run("list", "metrics", file, "--json").json
    entry = next(x for x in data["entries"] if x["name"] == "mass")
    assert (entry["value"], entry["unit"]) == (mass, "kg")
    stated = {e.name: e.value for e in ao.catalogue("paths", file)}
    assert stated["load_cases[stance].force"] == 4000.0
    assert stated["cylinder.mount"] == "cap_clevis"
    assert "sensor.mass" in stated
    assert stated["sensor.mass"] is None
    used = {e.name: e.value for e in ao.catalogue("materials", file)}
    assert used["ti_6al4v"] == "caps.material"
    assert next(e.value for e in ao.catalogue("joints", file) if e.name == "bond")
    changed = ao.catalogue("paths", file, set={"cylinder.bore": "23 mm"})
    assert next(e.value for e in changed if e.name == "cylinder.bore") == 0.023


def test_words_filter_lists(file):
    """A word keeps names by letters and by meaning; none left is a fault with near names."""
    names = [e.name for e in ao.catalogue("metrics", word="rigidity")]
    assert "stiffness_min" in names
    assert "mass" not in names
    assert "t700_epoxy" in [e.name for e in ao.catalogue("materials", word="carbon")]
    assert len(ao.catalogue("paths", file, "layup[1]")) >= 3
    assert run("list", "metrics", "zzzz").code == 2
    assert "metrics" in run("list", "metric").err


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (("stiffness-min",), "stiffness_min"),
        (("Column buckling at full extension",), "3.1"),
        (("load", "case"), "load case"),
        (("kkt",), "KKT"),
        (("stroke",), "cylinder.stroke"),
        (("barrel.layup[1].thickness",), "barrel.layup[1].thickness"),
        (("requirements.mass.max",), "requirements.mass.max"),
        (("materials.t700_epoxy.density",), "materials.t700_epoxy.density"),
        (("ti_6al4v",), "ti_6al4v"),
        (("film",), "film"),
        (("u_cup",), "u_cup"),
        (("barrel.layup",), "barrel.layup"),
    ],
)
def test_names_in_many_spellings(words, name):
    """Case, spaces, hyphens, titles of checks, any index, a last key that only one PATH has."""
    result = run("explain", *words, "--json")
    assert (result.code, result.json["name"]) == (0, name)


@pytest.mark.parametrize(
    "word",
    ["", "  ", "x" * 10_000, "\x1b[2J", "ma\nss", "\0", "‮mass", "[", "a[b", "..", "=", "膝",
     "requirements.", "requirements.x.min", "variables.cylinder.bore.lower.x", "-1"],
)  # fmt: skip
def test_hostile_words_get_one_line(word):
    """Exit 2 with one short line, as text and as JSON, in both commands."""
    for words in (
        ("explain", "--", word),
        ("list", "metrics", "--", word or "q"),
    ):
        result = run(*words)
        if words[0] == "list" and result.code == 0:
            continue  # the filter has matches
        assert result.code == 2, (words, result)
        assert result.out == ""
        assert len(result.err.splitlines()) == 1
        assert len(result.err) < 400
        assert result.err.isprintable() or result.err[:-1].isprintable()
    assert len(run("explain", "--json", "--", word).errors) == 1


def test_an_unknown_word_names_the_five_nearest():
    """By letters and meaning."""
    result = run("explain", "stifness")
    assert result.code == 2
    near = result.err.partition("nearest: ")[2].strip().split(", ")
    assert len(near) == 5
    assert "stiffness_min" in near


def test_faults_of_the_design_and_the_command(tmp_path, file):
    """A missing or faulty design is exit 3, two designs or --set without one are exit 2."""
    assert run("explain", "mass", tmp_path / "no.yaml").code == 3
    bad = tmp_path / "bad.yaml"
    bad.write_text("name: x\n")
    assert run("list", "metrics", bad).code == 3
    assert run("explain", "mass", file, file).code == 2
    assert run("explain", "mass", "--set", "cylinder.bore=1").code == 2
    assert run("list", "metrics", "-", stdin=BENCH.encode()).code == 0


def test_user_metrics_are_explained(tmp_path, file):
    """A plug-in's metric has a value and influences like any other."""
    plugin = tmp_path / "own.py"
    plugin.write_text(
        "import actuator_opt as ao\n"
        "@ao.metric('slenderness')\n"
        "def own(v):\n    return v['cylinder.stroke'] / v['cylinder.bore']\n"
    )
    data = run("explain", "slenderness", file, "--plugin", plugin, "--json").json
    assert data["value"] == pytest.approx(110 / 22)
    moves = {x["name"]: x["percent_per_percent"] for x in data["influences"]}
    assert moves == pytest.approx({"cylinder.stroke": 1.0, "cylinder.bore": -1.0})
    listed = run("list", "metrics", file, "slenderness", "--plugin", plugin).out
    assert "slenderness\t5\t" in listed


def test_terminal_tables_and_schema(monkeypatch, file):
    """On a terminal `list` aligns its columns, and `schema` names its size instead of printing."""
    monkeypatch.setattr("actuator_opt.cli.streams.terminal", lambda: True)
    monkeypatch.setenv("COLUMNS", "80")
    table = run("list", "metrics", file, "stiffness").out
    assert "\t" not in table
    lines = table.splitlines()
    assert len({line.index("kN/mm") for line in lines[1:]}) == 1
    assert all(len(line) <= 80 for line in lines)
    flood = run("schema")
    assert (flood.code, flood.out) == (0, "")
    assert re.fullmatch(
        r"\d\.\d MB of JSON: use list or explain; > FILE for an editor\n", flood.err
    )
    monkeypatch.undo()
    assert len(run("schema").out) > 1_000_000


def test_a_word_without_a_design_loads_little():
    """Explaining a metric neither reads a design file nor imports Pydantic."""
    code = (
        "import sys, actuator_opt as ao; ao.explain('stiffness_min');"
        "print(sorted({'pydantic', 'yaml', 'scipy', 'actuator_opt.design'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT,
                          check=True)  # fmt: skip
    assert done.stdout.strip() == "[]"
    assert spawn("explain", "mass").stdout.startswith("mass  metric, unit g, symbol m\n")


def test_readme_names_both_commands():
    """README; the reference of the commands is generated from the commands."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "`explain`" in text
    assert "`list`" in text
    assert set(LISTS) >= {"paths", "metrics", "checks", "materials", "joints", "seals"}
