"""Changed inputs of every kind: no traceback, no hang, exit codes of README alone (see `fuzz`)."""

from __future__ import annotations

import os
import time

import fuzz
import pytest
from cli_runner import BENCH, ROOT, run

from actuator_opt import api as verbs
from actuator_opt.base.errors import EXIT_CODES, ExitCode
from actuator_opt.cli import streams

COUNT, SEED, PARTS = int(os.environ.get("FUZZ_COUNT", "240")), 20, 8


@pytest.mark.parametrize(
    "part", [*range(3), *(pytest.param(x, marks=pytest.mark.long) for x in range(3, PARTS))]
)
def test_inputs(part, tmp_path):
    """Every input of the seed is answered, or refused in words."""
    failed = {}
    for number in range(part, COUNT, PARTS):
        folder = tmp_path / str(number)
        folder.mkdir()
        given = fuzz.made(SEED, number)
        reason = fuzz.fault(given, folder)
        if reason:
            failed[f"--seed {SEED} --only {number}"] = (given.kind, given.words, reason)
    assert not failed


@pytest.mark.parametrize("name", fuzz.REGRESSIONS)
def test_inputs_that_failed_once(name, tmp_path):
    """They hold for good."""
    assert fuzz.fault(fuzz.REGRESSIONS[name], tmp_path) == ""


def test_an_input_is_of_its_number_alone():
    """The same number of the same seed is the same input; all kinds come up."""
    assert fuzz.made(1, 7) == fuzz.made(1, 7) != fuzz.made(2, 7)
    assert {fuzz.made(SEED, number).kind for number in range(COUNT)} >= {*fuzz.KINDS} - {"record"}


EVALUATED = fuzz.Input("set", ("evaluate", "-", "--json"), BENCH.encode())


@pytest.mark.parametrize(
    ("broken", "reason"),
    [
        (lambda *_, **__: 1 / 0, "exit code 70"),
        (lambda *_, **__: time.sleep(0) or [None for _ in iter(int, 1)], "of processor time"),
        (lambda *_, **__: (_ for _ in ()).throw(SystemExit(5)), "exit code 5"),
    ],
)
def test_the_fuzz_finds(broken, reason, tmp_path, monkeypatch):
    """The fuzz test reports a fault, a hang and an undocumented exit code."""
    monkeypatch.setattr(fuzz, "BOUND", 0.3)
    monkeypatch.setattr(verbs, "evaluate", broken)
    assert reason in fuzz.fault(EVALUATED, tmp_path)


def test_the_fuzz_finds_nan(tmp_path, monkeypatch):
    """So is JSON that is none."""
    monkeypatch.setattr(streams, "out_json", lambda _: streams.out('{"value": NaN}'))
    assert "NaN is no JSON" in fuzz.fault(EVALUATED, tmp_path)


def test_exit_codes_are_told_once():
    """README and the help give the codes as the program declares them."""
    told = ", ".join(f"{int(code)} {words}" for code, words in EXIT_CODES.items())
    assert set(EXIT_CODES) == set(ExitCode)
    assert f"Exit codes: {told}." in " ".join((ROOT / "README.md").read_text("utf-8").split())
    assert told in " ".join(run("--help").out.split())
    assert {int(code) for code in EXIT_CODES} == {*fuzz.CODES, 70, 130}
