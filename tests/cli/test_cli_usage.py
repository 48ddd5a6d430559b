"""The command line itself: help, usage faults, exit codes, what a start costs."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import jsonschema
import pytest
import yaml
from cli_runner import BENCH, DESIGNS, KNEE, run, spawn, surroundings
from frozen_cases import commands

from actuator_opt.api import starting
from actuator_opt.cli import streams
from actuator_opt.design.writer import init_text

COMMANDS = [(), ("optimize",), *commands()]
VERBS = ["check", "evaluate", "optimise", "optimize", "sensitivity", "report"]


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_help_explains_everything(words):
    """Every command and every option has its sentence; none is cut off."""
    result = run(*words, "--help")
    assert result.code == 0
    assert result.err == ""
    assert result.out == run(*words, "-h").out
    assert "..." not in result.out.replace("]...", "").replace("}...", "")
    for line in result.out.splitlines():
        if re.match(r"  (-\w, )?--[\w-]+( [\w.=-]+)?$", line):
            raise AssertionError(f"no explanation: {line}")


@pytest.mark.parametrize(
    "verb",
    [
        "check",
        "evaluate",
        "optimise",
        pytest.param("sensitivity", marks=pytest.mark.long),
        "report",
    ],
)
def test_design_verbs_share_their_options(verb, tmp_path):
    """All design verbs take --set, --out, --seed, --json, --quiet and --plugin (contract)."""
    plugin = tmp_path / "own.py"
    plugin.write_text(
        "import actuator_opt as ao\n"
        "@ao.metric('slenderness')\n"
        "def own(v):\n    return v['cylinder.stroke'] / v['cylinder.bore']\n"
    )
    changes = ["--set", "load.mass=10 kg", "--set", "fluid.air_content=0.01"]
    options = ["--out", tmp_path, "--seed", 3, "--json", "--quiet", "--plugin", plugin]
    result = run(verb, "-", *changes, *options, stdin=BENCH.encode())
    assert result.code == 0, result.out
    assert result.json
    assert result.err == ""


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["frobnicate"], "frobnicate"),
        (["evaluate"], "DESIGN"),
        (["evaluate", KNEE, KNEE], "argument"),
        (["evaluate", KNEE, "--frob"], "--frob"),
        (["evaluate", KNEE, "--set"], "--set"),
        (["evaluate", KNEE, "--set", "cylinder.bore"], "PATH=VALUE"),
        (["evaluate", KNEE, "--set", "=3"], "PATH=VALUE"),
        (["optimise", KNEE, "--starts", "many"], "--starts"),
        (["optimise", KNEE, "--starts", "0"], "--starts"),
        (["optimise", KNEE, "--seed", "-1"], "--seed"),
        (["report", KNEE, "--date", "2024-13-01"], "YYYY-MM-DD"),
        (["report", KNEE, "--date", "20240101"], "YYYY-MM-DD"),
        (["materials", "list", "--kind", "wood"], "metal"),
        (["materials", "compare", "steel_42crmo4"], "two"),
        (["init", ""], "NAME"),
        (["init", "two\nlines"], "NAME"),
    ],
)
def test_usage_faults(arguments, word):
    """Exit 2, one line on stderr, or one JSON object on stdout."""
    plain = run(*arguments)
    assert plain.code == 2
    assert plain.out == ""
    assert len(plain.err.splitlines()) == 1
    assert word in plain.err
    if arguments[-1] != "--set":
        result = run(*arguments, "--json")
        assert result.code == 2
        assert result.err == ""
        assert word in json.dumps(result.errors)


def test_without_arguments_the_help():
    """A bare command name shows its help, on stderr: nothing was asked for."""
    for words in ((), ("materials",)):
        result = run(*words)
        assert (result.code, result.out) == (2, "")
        assert result.err.startswith("Usage:")


def test_version():
    """--version prints name and version."""
    result = run("--version")
    assert (result.code, result.err) == (0, "")
    assert re.fullmatch(r"actuator-opt \d+\.\d+\.\d+\S*\n", result.out)


@pytest.mark.parametrize("name", ["nope.yaml", "/", "\0", "a" * 5000, "http://x/y.yaml"])
@pytest.mark.parametrize("verb", VERBS)
def test_files_that_cannot_be_read(verb, name):
    """Exit 3 with the name and a reason, as a line or as JSON."""
    plain = run(verb, name)
    assert (plain.code, plain.out) == (3, "")
    assert len(plain.err.splitlines()) == 1
    result = run(verb, name, "--json")
    assert result.code == 3
    assert [fault["file"] for fault in result.errors] == [name]


def test_near_names_are_offered(tmp_path):
    """A mistyped file name gets the nearest one of its folder."""
    (tmp_path / "knee_bonded.yaml").write_text(BENCH)
    assert "knee_bonded.yaml?" in run("evaluate", tmp_path / "kene.yaml").err


def test_check_of_several_files(tmp_path):
    """Good files are named, faulty ones have their faults, the exit status counts them all."""
    good = tmp_path / "good.yaml"
    good.write_text(BENCH)
    result = run("check", good, "nope.yaml", good)
    assert (result.code, result.out) == (3, "")
    assert result.err.count("no faults") == 2
    assert run("check", good, "--quiet") == run("check", good, "-q")
    assert run("check", good, "--quiet").err == ""
    assert run("check", good, "--json").json == {"errors": []}
    assert len(run("check", "nope.yaml", "/", "--json").errors) == 2


@pytest.mark.parametrize(
    ("name", "file", "title"),
    [
        ("arm", "arm.yaml", "arm"),
        pytest.param("arm.yaml", "arm.yaml", "arm", marks=pytest.mark.long),
        ("left knee: α", "left_knee_α.yaml", "left knee: α"),
        ("legs/left", "legs/left.yaml", "left"),
        pytest.param("7.5 kN", "7.5_kN.yaml", "7.5 kN", marks=pytest.mark.long),
        ("?!", "actuator.yaml", "?!"),
    ],
)
def test_init_writes_the_file_that_its_name_promises(name, file, title, tmp_path, monkeypatch):
    """NAME.yaml is written and named in one line; `check` takes it, nothing overwrites it."""
    (tmp_path / "legs").mkdir()
    monkeypatch.chdir(tmp_path)
    result = run("init", name, "--from", KNEE)
    assert (result.code, result.out, result.err) == (0, "", f"wrote {file}\n")
    written = (tmp_path / file).read_bytes()
    assert run("check", file).code == 0
    assert run("evaluate", file, "--json").json["name"] == title
    again = run("init", name, "--from", KNEE)
    assert (again.code, again.out) == (2, "")
    assert file in again.err
    assert (tmp_path / file).read_bytes() == written
    (tmp_path / file).unlink()
    (tmp_path / file).symlink_to(tmp_path / "elsewhere.yaml")
    assert run("init", name).code == 2
    assert not (tmp_path / "elsewhere.yaml").exists()
    assert run("init", name, "--out", "-", "--from", KNEE).out.encode() == written


@pytest.mark.parametrize("name", [".", "..", ".yaml", "/", "legs/"])
def test_init_refuses_a_name_without_a_file(name):
    """A folder alone names no file: exit 2, one line."""
    result = run("init", name)
    assert (result.code, result.out) == (2, "")
    assert len(result.err.splitlines()) == 1


def test_init_makes_a_good_start(tmp_path):
    """The start file passes check, evaluates, is a schema's example; no file is overwritten."""
    file = tmp_path / "start.yaml"
    file.write_text(run("init", "left knee: α", "--out", "-").out, encoding="utf-8")
    assert run("check", file).code == 0
    assert run("evaluate", file, "--json").json["name"] == "left knee: α"
    before = file.read_bytes()
    again = run("init", "--out", file)
    assert (again.code, again.out) == (2, "")
    assert file.read_bytes() == before
    assert run("init").out == init_text()
    assert run("init", "--json").json == {"text": init_text()}
    assert run("init", "--out", tmp_path / "no" / "x.yaml", "--yes").code == 3
    other = run("init", "copy", "--from", file, "--out", "-")
    assert other.out.replace("name: copy", 'name: "left knee: α"') in (
        file.read_text(encoding="utf-8"),
        file.read_text(encoding="utf-8").replace("name: 'left", 'name: "left').replace("α'", 'α"'),
    )


ANSWERS = ("--push", "3 kN", "--pull", "1 kN", "--stroke", "50 mm", "--pressure", "120 bar")


def test_init_without_a_terminal_needs_a_duty(tmp_path, monkeypatch):
    """Exit 2 names the missing flags; nothing is written; a copy takes no duty."""
    monkeypatch.chdir(tmp_path)
    for words in ((), ANSWERS[:2]):
        result = run("init", "leg", *words)
        assert (result.code, result.out) == (2, "")
        (line,) = result.err.splitlines()
        assert '--stroke "100 mm"' in line
        assert ("--push" in line) == (not words)
    for words, word in ((("--push", "9"), '--push: "9"'), (("--wall", "wood"), "--wall")):
        assert word in run("init", "leg", "--yes", *words).err
    assert "only one" in run("init", "leg", "--from", KNEE, "--yes").err
    assert not list(tmp_path.iterdir())


def test_init_asks_on_a_terminal(tmp_path, monkeypatch):
    """Five questions with defaults; a bad answer is asked again; the end of input writes nothing.

    The same answers by flags gives the same file.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(streams, "asking", lambda: True)
    monkeypatch.setattr(starting, "STARTS", 1)
    answers = "3 kN\n3 kN, 1 kN\n50\n50 mm\n120 bar\n\n"
    result = run("init", "leg", stdin=answers.encode())
    assert result.code == 2
    assert "nothing was written" in result.err
    assert not list(tmp_path.iterdir())
    result = run("init", "leg", stdin=f"{answers}oak\n\n".encode())
    assert result.code == 0
    for question in ("[5 kN, 3 kN]", "stroke [100 mm]", "goal (mass,", "steel,", "[160 bar]"):
        assert question in result.err
    for remark in ('"3 kN"; write', "unit missing", '"oak" is not a wall'):
        assert result.err.count(remark) == 1
    text = (tmp_path / "leg.yaml").read_text(encoding="utf-8")
    assert run("init", "leg", "--out", "-", *ANSWERS, "--yes").out == text
    assert run("evaluate", "leg.yaml").code == 0


def test_schema_is_draft_7_and_takes_our_designs():
    """The schema is valid draft-07; shipped designs and the start file validate."""
    result = run("schema")
    schema = result.json
    assert schema == run("schema", "--json").json
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    texts = [path.read_text(encoding="utf-8") for path in sorted(DESIGNS.glob("*.yaml"))]
    for text in [*texts, init_text(), BENCH]:
        assert not list(validator.iter_errors(yaml.load(text, Loader=yaml.BaseLoader)))


def test_materials_in_every_form():
    """List, show and compare print tables or JSON; unknown names are faults with near ones."""
    for kind in ("metal", "ply", "polymer", "fluid", "seal", "adhesive"):
        assert run("materials", "list", "--kind", kind).code == 0
    names = ("steel_42crmo4", "al_7075_t6")
    assert list(run("materials", "show", names[0], "--json").json) == [names[0]]
    assert set(run("materials", "compare", *names, "--json").json) == set(names)
    assert "steel" in run("materials", "compare", *names).out
    unknown = run("materials", "show", "steel_42crm04")
    assert unknown.code == 3
    assert "steel_42crmo4" in unknown.err
    assert run("materials", "show", "steel_42crm04", "--json").errors


HEAVY = ("scipy", "matplotlib", "typst", "cvxpy", "highspy", "nlopt")
WATCH = (
    "import sys; sys.argv[1:] = {arguments!r}\n"
    "from actuator_opt.cli import main\n"
    "try: main()\n"
    "except SystemExit: pass\n"
    "print(sorted({watched!r} & {{name.split('.')[0] for name in sys.modules}}), file=sys.stderr)"
)


@pytest.mark.parametrize(
    ("arguments", "light"),
    [
        (["--help"], {*HEAVY, "numpy", "pydantic", "yaml"}),
        (["evaluate", "--help"], {*HEAVY, "numpy", "yaml"}),
        (["check", str(KNEE)], {"scipy", "matplotlib", "typst", "cvxpy"}),
        (["evaluate", str(KNEE), "--json"], set(HEAVY)),
    ],
)
def test_a_start_loads_only_what_it_needs(arguments, light):
    """Help needs no engine, evaluation no optimiser and no ink."""
    script = WATCH.format(arguments=arguments, watched=light)
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=surroundings()
    )
    assert done.stderr.strip().splitlines()[-1] == "[]"


def test_as_a_process():
    """`python -m actuator_opt` is the same command line."""
    done = spawn("evaluate", "--help")
    assert done.returncode == 0
    assert done.stdout == run("evaluate", "--help").out


@pytest.mark.parametrize(("stated", "threads"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "2"}, "2")])
def test_linear_algebra_runs_on_one_thread_unless_stated(stated, threads):
    """Small dense systems, such as those of oil films, wait longer for threads than they take."""
    script = "import actuator_opt.cli, os; print(os.environ['OPENBLAS_NUM_THREADS'])"
    environment = surroundings()
    environment.pop("OPENBLAS_NUM_THREADS", None)
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=environment | stated
    )
    assert done.stdout.strip() == threads
