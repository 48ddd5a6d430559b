"""A person's own metrics through `--plugin`: used where good, one clear line where not."""

from __future__ import annotations

import pytest
from cli_runner import BENCH, bench, evaluated, run

HEAD = "import numpy as np\nimport actuator_opt as ao\n\n\n"
OWN = HEAD + "@ao.metric('own')\ndef own(v):\n    {body}\n"


@pytest.fixture
def plugin(tmp_path):
    """Write a plugin file; its path."""

    def write(text):
        path = tmp_path / "own.py"
        path.write_text(text)
        return path

    return write


def fault(path, text=BENCH, command="evaluate"):
    """The one fault a plugin leads to, as JSON and as a line."""
    result = run(command, "-", "--json", "--plugin", path, stdin=text.encode())
    assert result.code == 3, result.out
    (found,) = result.errors
    plain = run(command, "-", "--plugin", path, stdin=text.encode())
    assert (plain.code, plain.out) == (3, "")
    assert found["message"] in plain.err
    assert "plugin.py" not in plain.err
    return found


def test_own_metric_is_a_metric(plugin):
    """110 mm / 22 mm = 5, as metric, requirement, objective and constraint."""
    path = plugin(
        HEAD
        + "@ao.metric('slenderness')\ndef own(v):\n"
        + "    return v['cylinder.stroke'] / v['cylinder.bore']\n\n\n"
        + "@ao.constraint('short')\ndef short(v):\n    return 1 - v['cylinder.stroke'] / 0.22\n"
    )
    data = evaluated(BENCH, "--plugin", path)
    assert data["metrics"]["slenderness"]["value"] == pytest.approx(5.0)
    row = next(row for row in data["requirements"] if row["name"] == "short")
    assert (row["value"], row["limit"]) == (pytest.approx(0.5), 0.0)
    text = bench(("requirements:\n", "requirements:\n  slenderness:\n    max: 5.2\n"))
    assert run("check", "-", "--plugin", path, stdin=text.encode()).code == 0
    assert run("check", "-", stdin=text.encode()).code == 3
    search = ["--json", "--starts", "1", "--plugin", path]
    limited = run("optimise", "-", *search, stdin=text.encode()).json
    assert limited["variables"]["cylinder.bore"]["value"] >= 0.11 / 5.2 * (1 - 1e-6)
    aimed = bench(("minimise: mass", "minimise: slenderness"))
    result = run("optimise", "-", *search, stdin=aimed.encode())
    assert result.code in (0, 1)
    assert result.json["objective"]["metric"] == "slenderness"


@pytest.mark.parametrize(
    ("body", "word", "line"),
    [
        ("raise RuntimeError('boom')", "boom", 7),
        ("raise ValueError('two\\nlines')", "two lines", 7),
        ("raise OSError('x')", "OSError", 7),
        ("raise MemoryError", "MemoryError", 7),
        ("raise type('Own', (Exception,), {})('mine')", "mine", 7),
        ("assert v is None, 'no'", "AssertionError", 7),
        ("import sys; sys.exit(5)", "SystemExit", 7),
        ("return own(v)", "RecursionError", 7),
        ("return 1 / 0", "ZeroDivisionError", 7),
        ("return v['nope']", "nope", 7),
        ("return v['fluid.material']", "fluid.material", 7),
        ("return v.metric('nope')", "nope", 7),
        ("return v.metric('line_velocity')", "line_velocity", 7),
        ("return None", "NoneType", None),
        ("return 'text'", "str", None),
        ("return {}", "dict", None),
        ("return [1, 2]", "shape", None),
        ("return np.ones(7)", "shape", None),
        ("return np.ones((3, 2))", "shape", None),
        ("return v.metric('mass') + 1j", "complex", None),
    ],
)
def test_faulty_functions(plugin, body, word, line):
    """Whatever a function raises or returns is one fault of its file, at its line."""
    path = plugin(OWN.format(body=body))
    found = fault(path)
    assert found["file"] == str(path)
    assert word in found["message"]
    assert found["line"] == line
    assert "\n" not in found["message"]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("def (", "syntax"),
        ("import nothere", "nothere"),
        ("x = 1", "declares no metric"),
        ("raise RuntimeError('top')", "top"),
        ("import sys; sys.exit(3)", "SystemExit"),
        ("class E(Exception): pass\nraise E('own')", "own"),
        (HEAD + "@ao.metric('mass')\ndef m(v):\n    return 1", "mass"),
        (HEAD + "@ao.metric\ndef m(v):\n    return 1", "name"),
        (HEAD + "@ao.metric('a.b')\ndef m(v):\n    return 1", "a.b"),
        (HEAD + "@ao.metric('m', dimension='frob')\ndef m(v):\n    return 1", "frob"),
        (HEAD + "@ao.metric('m', unit_name='frob')\ndef m(v):\n    return 1", "frob"),
        (
            HEAD + "@ao.metric('m')\ndef m(v):\n    return 1\n"
            "@ao.metric('m')\ndef n(v):\n    return 2\n",
            "twice",
        ),
    ],
)
def test_faulty_files(plugin, text, word):
    """A file that cannot be read, or declares nothing usable, is one fault with its name."""
    path = plugin(text)
    for command in ("evaluate", "check"):
        found = fault(path, command=command)
        assert found["file"] == str(path)
        assert word in found["message"]


@pytest.mark.parametrize("name", ["nope.py", ".", "/dev/null", "own.txt"])
def test_files_that_are_no_plugins(name, tmp_path, monkeypatch):
    """A missing file, a folder, a device and another suffix are named."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.txt").write_text("x = 1\n")
    assert fault(name)["file"] == name


def test_one_metric_in_two_files(plugin, tmp_path):
    """The same name from two files is refused rather than one of them dropped."""
    path = plugin(OWN.format(body="return v['cylinder.bore']"))
    other = tmp_path / "other.py"
    other.write_text(path.read_text())
    result = run("evaluate", "-", "--plugin", path, "--plugin", other, stdin=BENCH.encode())
    assert result.code == 3
    assert "twice" in result.err


def test_nan_and_infinity_are_no_json(plugin):
    """NaN and infinity become null with a reason; as objective the solver says it failed."""
    for body in ("return float('nan')", "return float('inf')"):
        path = plugin(OWN.format(body=body))
        metric = evaluated(BENCH, "--plugin", path)["metrics"]["own"]
        assert metric["value"] is None
        assert metric["why"]
        aimed = bench(("minimise: mass", "minimise: own"))
        result = run("optimise", "-", "--json", "--plugin", path, stdin=aimed.encode())
        assert result.code == 4
        assert result.json["status"] == "undefined"
        assert result.json["objective"]["value"] is None


def test_prints_go_to_standard_error(plugin):
    """What a plugin prints does not spoil the JSON."""
    path = plugin(OWN.format(body="print('hello'); return v['cylinder.bore']") + "print('top')\n")
    result = run("evaluate", "-", "--json", "--plugin", path, stdin=BENCH.encode())
    assert result.json["metrics"]["own"]["value"] == pytest.approx(0.022)
    assert {"hello", "top"} <= set(result.err.split())


def test_an_interrupt_inside_a_plugin(plugin):
    """Ctrl-C leaves with 130, also as JSON."""
    path = plugin(OWN.format(body="raise KeyboardInterrupt"))
    plain = run("evaluate", "-", "--plugin", path, stdin=BENCH.encode())
    assert (plain.code, plain.out, plain.err) == (130, "", "interrupted\n")
    result = run("evaluate", "-", "--json", "--plugin", path, stdin=BENCH.encode())
    assert result.code == 130
    assert result.errors[0]["message"] == "interrupted"


HARD = HEAD + "CALLS = []\n\n\n@ao.metric('own')\ndef own(v):\n    CALLS.append(1)\n    {body}\n"
WANTED = bench(("requirements:\n", "requirements:\n  own:\n    min: 0\n"))


@pytest.mark.parametrize(
    ("body", "code", "status", "told"),
    [
        ("b = v['cylinder.bore']\n    if np.any(b > 0.025): raise ValueError('big')\n    return b",
         0, "optimal", "% of the points tried; these points count as infeasible: "),
        ("return v['cylinder.bore'] * np.nan", 4, "undefined", "own had no value at 100 %"),
    ],
)  # fmt: skip
def test_faults_during_the_search(plugin, tmp_path, body, code, status, told):
    """A metric without an answer somewhere: outcome and reason in text and JSON, one report."""
    path = plugin(HARD.format(body=body))
    arguments = ("optimise", "-", "--starts", "1", "--plugin", path)
    result = run(*arguments, "--json", stdin=WANTED.encode())
    assert (result.code, result.json["status"]) == (code, status)
    assert any(told in line for line in result.json["warnings"])
    if status == "undefined":
        shown = run(*arguments, "--out", tmp_path / "r", stdin=WANTED.encode())
        assert shown.code == code
        assert "no usable answer" in " ".join(shown.out.split())
        assert "Narrow the bounds to the valid range of the model" in " ".join(shown.out.split())
        assert all(path.stat().st_size > 0 for path in (tmp_path / "r").iterdir())


@pytest.mark.parametrize("words", [("--json",), ()])
def test_an_interrupt_during_the_search(plugin, tmp_path, words):
    """Ctrl-C in the search: exit 130, the best design so far printed and saved, no report."""
    body = "if len(CALLS) == 14: raise KeyboardInterrupt\n    return 1 + v['cylinder.bore']"
    path, file = plugin(HARD.format(body=body)), tmp_path / "best.yaml"
    targets = ("--out", tmp_path / "r", "--write", file)
    result = run("optimise", "-", *words, *targets, "--plugin", path, stdin=WANTED.encode())
    assert result.code == 130
    assert not (tmp_path / "r").exists()
    if words:
        assert result.json["status"] == "interrupted"
        assert result.json["sensitivities"] == []
    else:
        said = " ".join(result.out.split())
        assert "Interrupted; the best feasible design so far is kept." in said
    assert run("evaluate", file, "-q", "--plugin", path).code == 0
