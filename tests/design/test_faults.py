"""Unforeseen exceptions leave as one line and exit code 70; their known causes as plain faults."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from math import inf, nan

import numpy as np
import pytest
from cases.digests import digest
from cli_runner import BENCH, DESIGNS, KNEE, command, run, spawn, surroundings

import actuator_opt as ao
from actuator_opt import api as verbs, cli
from actuator_opt.base.errors import InputError
from actuator_opt.base.tables import encoded
from actuator_opt.evaluation import compute, film_tables as films, without_films

LONG, DIGITS = "a" * 300, "9" * 5000
"""More letters than a file system takes in a name, more digits than Python reads as an integer."""


@pytest.fixture
def broken(monkeypatch):
    """An evaluation with a fault of the program in it."""

    def evaluate(*_, **__):
        raise TypeError("unsupported\noperand")

    monkeypatch.setattr(verbs, "evaluate", evaluate)


def test_a_fault_of_the_program(broken):
    """One line says what it is and who takes reports; exit code 70, which no verdict has."""
    result = run("evaluate", KNEE)
    assert (result.code, result.out) == (70, "")
    assert len(result.err.splitlines()) == 1
    for word in ("internal error", "TypeError: unsupported operand", "report", "--debug"):
        assert word in result.err
    assert "actuator-opt authors" in result.err


def test_a_fault_of_the_program_as_json(broken):
    """Under --json it is the one object that every failure is."""
    result = run("evaluate", KNEE, "--json")
    assert (result.code, result.err) == (70, "")
    assert "TypeError" in result.errors[0]["message"]


@pytest.mark.parametrize("words", [("--debug", "evaluate"), ("evaluate", "--debug")])
def test_its_traceback(broken, words, monkeypatch, capsys):
    """--debug keeps it, before the command or after it; so does the environment variable."""
    for asked, variable in ((words, "0"), (("evaluate",), "1")):
        monkeypatch.setenv("ACTUATOR_OPT_DEBUG", variable)
        monkeypatch.setattr(sys, "argv", ["actuator-opt", *asked, str(KNEE)])
        with pytest.raises(SystemExit, match="70"):
            cli.main()
        lines = capsys.readouterr().err.splitlines()
        assert lines[0].startswith("Traceback")
        assert any("in evaluate" in line for line in lines)
        assert lines[-1].startswith("internal error of")


@pytest.mark.long
def test_debug_changes_no_report(tmp_path):
    """What --debug prints more is no part of a result."""
    for words in ((), ("--debug",)):
        assert run("report", "-", "--out", tmp_path, *words, stdin=BENCH.encode()).code == 0
        data = digest(tmp_path / "test_bench.pdf")
        (tmp_path / "test_bench.pdf").rename(tmp_path / f"{len(words)}.pdf")
    assert digest(tmp_path / "0.pdf") == data


def test_a_fault_in_a_worker(tmp_path):
    """A fault in another process reaches the top of this one."""
    script = (
        "import sys\n"
        "from actuator_opt.sweeps.chunk import Study\n"
        "def chunk(*_): raise TypeError('odd')\n"
        "Study.chunk = chunk\n"
        "from actuator_opt.cli import main\n"
        f"sys.argv[1:] = ['sweep', {str(KNEE)!r}, '--vary', 'cylinder.bore=20..21 mm:9000',\n"
        "    '--workers', '2', '--no-record']\n"
        "main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=surroundings()
    )
    assert (done.returncode, done.stdout) == (70, "")
    assert "TypeError: odd" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("raised", "code", "word"),
    [
        (OSError(28, "No space left on device"), 3, "No space left"),
        (PermissionError(13, "Permission denied", "F.x"), 3, "F.x: cannot be used"),
        (MemoryError(), 4, "out of memory"),
    ],
)
def test_what_the_system_refuses(raised, code, word, monkeypatch):
    """A full disk or memory is no fault of the program."""

    def evaluate(*_, **__):
        raise raised

    monkeypatch.setattr(verbs, "evaluate", evaluate)
    result = run("evaluate", KNEE)
    assert result.code == code
    assert word in result.err


def test_numbers_that_json_lacks():
    """NaN and infinity become null, and the object says which and why."""
    data = {"a": [1.0, nan, {"b": -inf}], "c": (inf,), "d": "NaN"}
    read = json.loads(encoded(data), parse_constant=pytest.fail)
    assert read == {
        "a": [1.0, None, {"b": None}],
        "c": [None],
        "d": "NaN",
        "not_finite": {"a[1]": "not computable", "a[2].b": "unbounded", "c[0]": "unbounded"},
    }
    deep: dict = {}
    for _ in range(100_000):
        deep = {"a": deep}
    with pytest.raises(InputError, match="nested too deeply"):
        encoded(deep)


@pytest.mark.parametrize(
    "words",
    [
        ("report", KNEE, "--out", LONG),
        ("optimise", KNEE, "--write", LONG),
        ("uncertainty", KNEE, "--csv", LONG),
        ("sweep", KNEE, "--vary", "cylinder.bore=20 mm,21 mm", "--csv", LONG),
        ("sweep", KNEE, "--vary", "cylinder.bore=20 mm,21 mm", "--parquet", LONG),
        ("sweep", KNEE, "--vary", "cylinder.bore=20 mm,21 mm", "--store", LONG),
        ("simulate", DESIGNS / "scenarios" / "knee_step.yaml", "--csv", LONG),
        ("init", "--out", LONG),
        ("explore", "x.db", "--out", LONG),
        ("compare", KNEE, KNEE, "--out", LONG),
        ("materials", "show", "iso_vg_32", "--out", LONG),
        ("evaluate", KNEE, "--plugin", LONG),
        ("evaluate", LONG),
        ("sweep", KNEE, "--vary", f"cylinder.bore={DIGITS}"),
        ("evaluate", KNEE, "--set", f"load_cases[{DIGITS}].force=1"),
        ("evaluate", KNEE, "--set", f"barrel.layup={DIGITS}"),
    ],
    ids=lambda words: " ".join(map(str, words[:1])),
)
def test_names_and_numbers_too_long(words):
    """One line, and the exit code of a bad input, before any work."""
    result = run(*words)
    assert (result.code, result.out) == (3, "")
    assert len(result.err.splitlines()) == 1


@pytest.mark.parametrize(
    "words",
    [
        ("sweep", KNEE, "--vary", f"cylinder.bore=20 mm..21 mm:{DIGITS}"),
        ("sweep", KNEE, "--vary", "cylinder.bore=20 mm..21 mm:3", "--reduce", f"best:{DIGITS}"),
        ("evaluate", KNEE, "--seed", DIGITS),
    ],
)
def test_counts_too_long(words):
    """One line, and the exit code of a command line that cannot be understood."""
    result = run(*words)
    assert (result.code, result.out) == (2, "")
    assert len(result.err) < 400


def test_columns_too_long():
    """A width that is none is not kept to."""
    usual = run("evaluate", "-", stdin=BENCH.encode(), environment={"COLUMNS": ""})
    assert usual == run("evaluate", "-", stdin=BENCH.encode(), environment={"COLUMNS": DIGITS})


def test_a_doctor_of_a_long_folder():
    """`doctor` reports a folder that cannot exist."""
    result = run("doctor", "--out", LONG)
    assert result.code == 1
    assert "File name too long" in result.out


@pytest.mark.parametrize("place", ["~nosuchuser/x", "~nosuchuser"])
def test_a_home_that_nobody_has(place):
    """The message names the variable; the result is printed all the same."""
    where = {"ACTUATOR_OPT_RUNS": place}
    result = run("runs", "list", environment=where)
    assert (result.code, result.out) == (3, "")
    assert "ACTUATOR_OPT_RUNS" in result.err
    swept = run("sweep", KNEE, "--vary", "cylinder.bore=30 mm,31 mm", environment=where)
    assert swept.code in (0, 1)
    assert "the run was not recorded" in swept.err


@pytest.mark.long
@pytest.mark.skipif(os.name == "nt", reason="needs a POSIX shell")
def test_no_standard_input():
    """`-` where the shell has closed it."""
    for words in (("evaluate", "-"), ("simulate", "-"), ("identify", "-", "--design", KNEE)):
        done = subprocess.run(
            ["sh", "-c", 'exec "$@" <&-', "sh", *command(*words)],
            capture_output=True,
            text=True,
            env=surroundings(),
        )
        assert (done.returncode, done.stdout) == (3, ""), words
        assert "standard input is closed" in done.stderr


@pytest.mark.long
@pytest.mark.skipif(os.name == "nt", reason="an open folder is not deleted there")
def test_a_working_directory_that_is_gone(tmp_path):
    """What needs none works; the rest says so."""
    place, out = tmp_path / "gone", tmp_path / "out"
    for words, code in (
        (("report", "-", "--out", out), 0),
        (("report", "-"), 3),
        (("sweep", KNEE, "--vary", "cylinder.bore=30 mm,31 mm", "--csv", "x.csv"), 3),
    ):
        place.mkdir()
        done = subprocess.run(
            ["sh", "-c", 'rmdir "$PWD"; exec "$@"', "sh", *command(*words)],
            cwd=place,
            input=BENCH,
            capture_output=True,
            text=True,
            env=surroundings(),
        )
        assert done.returncode == code, done.stderr
        assert code == 0 or len(done.stderr.splitlines()) == 1
    assert len(list(out.iterdir())) >= 2


HOSTILE = {
    "raised": (
        "class Own(BaseException):\n    pass\n@ao.metric('m')\ndef m(v):\n    raise Own('no')\n"
    ),
    "left": "@ao.metric('m')\ndef m(v):\n    raise SystemExit(0)\n",
    "loaded": "class Own(BaseException):\n    pass\nraise Own('no')\n",
    "text": (
        "class Own(Exception):\n    def __str__(self):\n        raise ValueError\n"
        "@ao.metric('m')\ndef m(v):\n    raise Own\n"
    ),
    "array": (
        "class Own:\n    def __array__(self, *_, **__):\n        raise Exception('no')\n"
        "@ao.metric('m')\ndef m(v):\n    return Own()\n"
    ),
    "ragged": "@ao.metric('m')\ndef m(v):\n    return [[1.0], [1.0, 2.0]]\n",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_plugins_that_raise_anything(name, tmp_path):
    """Whatever a stranger's code raises, the line names its file."""
    file = tmp_path / "own.py"
    file.write_text(f"import actuator_opt as ao\n{HOSTILE[name]}")
    result = run("evaluate", "-", "--plugin", file, stdin=BENCH.encode())
    assert (result.code, result.out) == (3, "")
    assert len(result.err.splitlines()) == 1
    assert "own.py" in result.err


def test_plugins_with_odd_objects_beside(tmp_path):
    """An object that cannot be asked for its names is no metric, and no fault."""
    file = tmp_path / "own.py"
    file.write_text(
        "import actuator_opt as ao\n"
        "class Odd:\n"
        "    def __getattr__(self, name):\n        raise RuntimeError(name)\n"
        "    def __call__(self):\n        pass\n"
        "odd = Odd()\n"
        "@ao.metric('m')\ndef m(v):\n    return v['cylinder.bore']\n"
    )
    result = run("evaluate", "-", "--json", "--plugin", file, stdin=BENCH.encode())
    assert result.code == 0
    assert result.json["metrics"]["m"]["value"] == pytest.approx(22e-3)


FILM = BENCH.replace("    friction_coefficient: 0.10\n  rod:", "    friction: film\n  rod:")
UNREAD = """variables:
  stiffness.seal_deflection:
    lower: 0.1 mm
    upper: 0.3 mm
    start: 0.2 mm
"""
HUANG = DESIGNS / "huang_110_80_560.yaml"


@pytest.fixture
def no_film(monkeypatch):
    """Whoever solves an oil film fails."""

    def table(*_):
        raise AssertionError("an oil film is solved")

    monkeypatch.setattr(films, "table", table)


def test_check_solves_no_film(no_film):
    """A design of oil films is checked without them; what no model answers is refused as before."""
    assert ao.check(HUANG) == []
    assert ao.check(FILM) == []
    for old, new, word in (
        ("  seal_gap:", "  rod_leakage:\n    max: 1 ml\n  seal_gap:", "rod_leakage"),
        ("variables:\n", UNREAD, "seal_deflection"),
        ("  minimise: mass", "  minimise: inter_seal_pressure", "inter_seal_pressure"),
    ):
        assert old in FILM
        faults = ao.check(FILM.replace(old, new, 1))
        assert len(faults) == 1
        assert word in str(faults[0])


def test_an_unsolved_film_leaves_metrics_and_reads():
    """The same metrics, places and numbers read as with films; what no film decides is equal."""
    subject = ao.read(FILM).subject()
    known, bare = {}, {}
    for ready, found in ((subject, known), (without_films(subject), bare)):
        values = ready.values()
        found["metrics"] = compute(ready, values).computed
        found["read"] = set(values.read)
    solved, unsolved = known["metrics"].metrics, bare["metrics"].metrics
    assert known["read"] == bare["read"]
    assert {m: list(x) for m, x in solved.items()} == {m: list(x) for m, x in unsolved.items()}
    same = [
        name
        for name, places in solved.items()
        if all(np.array_equal(unsolved[name][place], value) for place, value in places.items())
    ]
    assert {"mass", "burst_factor", "seal_squeeze"} <= set(same)
    assert "friction_running" not in same


def test_the_library_takes_a_design_where_the_terminal_does(tmp_path):
    """`report`, `save` and `check` take a design in any form, as `evaluate` does."""
    file = tmp_path / "bench.yaml"
    file.write_text(BENCH)
    actuator = ao.read(file)
    written = ao.report(actuator, folder=tmp_path, all_pages=True)
    images = [x.path for x in written if x.path.suffix == ".png"]
    ours = [image.read_bytes() for image in images]
    assert run("report", file, "--out", tmp_path, "--all-pages").code == 0
    differing = [k for k, image in enumerate(images) if image.read_bytes() != ours[k]]
    assert len(ours) > 5
    assert len(differing) <= 1  # the page of the command
    for k, form in enumerate((actuator, file, ao.evaluate(actuator), actuator.design)):
        saved = ao.save(form, tmp_path / f"{k}.yaml")
        assert ao.read(saved).design == actuator.design
    assert ao.check(actuator) == ao.check(actuator.design) == []
    faults = ao.check(actuator, set={"requirements.rod_leakage.max": "1 ml"})
    assert "rod_leakage" in str(faults[0])


def test_as_a_process():
    """The exit code reaches the shell."""
    assert spawn("evaluate", KNEE, "--set", f"load_cases[{DIGITS}].force=1").returncode == 3
