"""The frozen outputs cover every command and every shipped file, and a change is seen."""

from __future__ import annotations

import subprocess
import sys

import pytest
from frozen import FROZEN, ROOT, TOOLS, compared
from frozen_cases import SHIPPED, cases, commands

CASES = cases()
RUN = [step.words for case in CASES if case.name != "help" for step in case.steps]


@pytest.mark.parametrize("command", commands(), ids=" ".join)
def test_every_command_has_a_frozen_case(command) -> None:
    """Its help and its work: add a case to tests/frozen_cases.py."""
    assert any(words[: len(command)] == command for words in RUN)


@pytest.mark.parametrize(
    "path",
    [path for kind in ("yaml", "csv") for path in sorted(SHIPPED.rglob(f"*.{kind}"))],
    ids=lambda path: path.stem,
)
def test_every_shipped_file_has_a_frozen_case(path) -> None:
    """Some command other than `check` reads it."""
    name = path.relative_to(ROOT).as_posix()
    assert any(name in words for words in RUN if words[0] != "check")


def test_every_case_is_frozen_and_nothing_else_is() -> None:
    """After a new case: `just frozen --update NAME`."""
    frozen = {path.relative_to(FROZEN).as_posix() for path in FROZEN.rglob("*.txt")}
    assert frozen == {f"{case.name}.txt" for case in CASES}
    assert len(frozen) == len(CASES)
    assert TOOLS.is_file()


@pytest.mark.parametrize(
    "words",
    [
        [
            "help",
            "schema/",
            "faults/",
            "init/plain",
            "init/stated",
            "init/knee_bonded",
            "check/all",
        ],
        pytest.param(["init/", "check/"], marks=pytest.mark.long),
    ],
    ids=["some", "every design"],
)
def test_texts_without_numbers_of_models_are_frozen(words) -> None:
    """Help, schema, faults, start files and checks, which no other processor rounds otherwise."""
    script = ROOT / "tests" / "frozen.py"
    done = subprocess.run(
        [sys.executable, script, "--processes", "1", *words],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


OLD = 'a 1.5\n"mass": 0.25,\n--- file out/a.pdf: ' + 64 * "a" + "\n"


@pytest.mark.parametrize(
    ("old", "new", "kinds"),
    [
        ("1.5", "1.5000000000001", ["digits"]),
        ("1.5", "1.50001", ["changed"]),
        ("a 1", "b 1", ["changed"]),
        ("0.25", "-0.25", ["changed"]),
        (64 * "a", 64 * "b", ["bytes"]),
        ("a 1.5\n", "", ["changed"]),
        ("a 1.5\n", "a 1.5\nnew\n", ["changed"]),
        (64 * "a", 64 * "b" + "\nnew", ["bytes", "changed"]),
    ],
)
def test_a_change_is_seen(old, new, kinds) -> None:
    """Numbers in the last digits, other numbers, words, signs, bytes, lines."""
    assert [one.kind for one in compared(OLD, OLD.replace(old, new), 1e-9, set())] == kinds


def test_bytes_do_not_count_where_other_tools_write_them() -> None:
    """Nor where numbers have moved in the last digits, and nothing else has."""
    new = OLD.replace(64 * "a", 64 * "b")
    assert [one.kind for one in compared(OLD, new, 1e-9, {".pdf"})] == ["skipped"]
    new = new.replace("1.5", "1.5000000000001")
    assert {one.kind for one in compared(OLD, new, 1e-9, set())} == {"digits"}
