"""`actuator-opt sweep` in the terminal."""

from __future__ import annotations

import json
import sys

import pytest
from cli_runner import run
from sweep_case import KNEE, NEAR, STEEL

SETS = [word for path, value in NEAR.items() for word in ("--set", f"{path}={value}")]
BORES = ["--vary", "cylinder.bore=20.9..21.1 mm:3"]


def test_sweep_tells_the_best(tmp_path):
    """Counts, the best variants with units, exit 0; the CSV is in place."""
    file = tmp_path / "rows.csv"
    done = run("sweep", KNEE, *SETS, *BORES, "--csv", str(file))
    assert done.code == 0, done.err
    assert "3 variants" in done.out
    assert "bore, mm" in done.out
    assert "mass, g" in done.out
    assert file.read_text(encoding="utf-8").count("\n") == 4
    assert f"wrote {file}" in done.err


def test_a_quiet_sweep_prints_nothing():
    """As the help says."""
    done = run("sweep", KNEE, *SETS, *BORES, "--quiet")
    assert (done.code, done.out, done.err) == (0, "", "")


def test_sweep_json_is_the_contract():
    """The keys of the contract; SI."""
    done = run("sweep", KNEE, *SETS, *BORES, "--json")
    told = json.loads(done.out)
    assert {"requested", "computed", "reused", "failed", "feasible", "best", "seconds"} <= set(told)
    assert told["best"][0]["variables"]["cylinder.bore"] == pytest.approx(0.021, abs=2e-4)
    assert told["best"][0]["metrics"]["mass"] == pytest.approx(0.27, abs=0.02)


def test_no_feasible_variant_is_exit_1():
    """The limit missed most is named."""
    done = run("sweep", STEEL, "--vary", "cylinder.bore=18..20 mm:3")
    assert done.code == 1
    assert "the limit missed by the largest margin is" in done.out


@pytest.mark.parametrize(
    ("words", "text", "code"),
    [
        ([], "nothing to vary", 2),
        (["--vary", "cylinder.bore"], "no values", 2),
        (["--vary", "cylinder.bohr=1..2:3"], "unknown PATH", 3),
        ([*BORES, "--method", "dice"], "use grid, sobol, lhs", 2),
        ([*BORES, "--reduce", "worst:3"], "write best:K", 2),
        (
            [*BORES, "--reduce", "best:3", "--csv", "x.csv"],
            "omit --store, --csv and --parquet",
            2,
        ),
        ([*BORES, "--reduce", "best:3", "--engine", "abacus"], "use numpy, jax or gpu", 2),
        ([*BORES, "--engine", "jax"], "add --reduce best:K", 2),
        ([*BORES, "--reduce", "best:3", "--engine", "gpu"], "omit --reduce or --engine", 2),
        ([*BORES, "--workers", "0"], "give 1 to 1024", 2),
        ([*BORES, "--workers", "100000"], "give 1 to 1024", 2),
        ([*BORES, "--csv", "/nowhere/x.csv"], "cannot write", 3),
        ([*BORES, "--csv", "-"], "standard output is used for the results", 2),
        ([*BORES, "--parquet", "-"], "standard output is used for the results", 2),
        ([*BORES, "--csv", "x.db", "--store", "x.db"], "two of --store", 2),
        (["--vary", "fluid.flavour=1..2:3"], "unknown PATH", 3),
    ],
)
def test_bad_input_is_one_line(words, text, code):
    """Where, what, what to do; no traceback."""
    done = run("sweep", KNEE, *words)
    assert done.code == code, done.err
    assert text in done.err
    assert len(done.err.strip().splitlines()) == 1


def test_a_missing_engine_is_told_and_numpy_works(monkeypatch):
    """Without JAX the answer is the same, with one line that says what was missing."""
    monkeypatch.setitem(sys.modules, "jax", None)
    words = ["sweep", KNEE, *SETS, *BORES, "--reduce", "best:1", "--json"]
    plain, asked = run(*words), run(*words, "--engine", "jax")
    assert asked.err.strip().splitlines() == [
        "JAX not installed (pip install 'actuator-opt[jax]'); used NumPy"
    ]
    plain, asked = json.loads(plain.out), json.loads(asked.out)
    assert asked["engine"] == "numpy"
    assert asked["best"] == plain["best"]


def test_the_best_alone_say_how_many_were_looked_at():
    """Counts that a screen cannot know are null; without a feasible design some are looked at."""
    done = run("sweep", STEEL, "--vary", "cylinder.bore=18..20 mm:3000", "--reduce", "best:2")
    assert done.code == 1
    assert "ruled out early, 0 evaluated in full" in done.out
    assert "designs examined" in " ".join(done.out.split())
    told = json.loads(run("sweep", KNEE, *SETS, *BORES, "--reduce", "best:2", "--json").out)
    assert told["feasible"] is None
    assert told["computed"] == 3
    assert len(told["best"]) == 2
