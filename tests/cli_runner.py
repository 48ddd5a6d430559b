"""Run the command line inside the test process: exit code, stdout, stderr, as a shell sees them."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from actuator_opt import cli

ROOT = Path(__file__).resolve().parent.parent
DESIGNS = ROOT / "designs"
KNEE = DESIGNS / "knee.yaml"
KNEE_TEXT = KNEE.read_text(encoding="utf-8")


@dataclass(frozen=True)
class Result:
    """What a command left behind."""

    code: int
    out: str
    err: str

    @property
    def json(self):
        """The one JSON object on stdout; numbers that are no JSON are refused."""
        return one_object(self.out)

    @property
    def errors(self):
        """The diagnostics of a failure under --json."""
        data = self.json
        assert list(data) == ["errors"], list(data)
        for fault in data["errors"]:
            assert set(fault) == {"file", "line", "column", "path", "message", "remedy"}
        return data["errors"]


def one_object(text):
    """Parse exactly one JSON object, without NaN or Infinity."""

    def refuse(word):
        raise AssertionError(f"{word} is no JSON")

    data = json.loads(text, parse_constant=refuse)
    assert isinstance(data, dict)
    return data


def run(*arguments, stdin=b"", encoding="utf-8", environment=None):
    """Run one command in this process."""
    streams = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]
    given = io.TextIOWrapper(io.BytesIO(stdin), encoding="utf-8")
    patches = [
        mock.patch.object(sys, "argv", ["actuator-opt", *map(str, arguments)]),
        mock.patch.object(sys, "stdin", given),
        mock.patch.object(sys, "stdout", streams[0]),
        mock.patch.object(sys, "stderr", streams[1]),
        mock.patch.dict(os.environ, environment or {}),
    ]
    code = 0
    for patch in patches:
        patch.start()
    try:
        cli.main()
    except SystemExit as leaving:
        code = leaving.code or 0
    finally:
        for patch in reversed(patches):
            patch.stop()
    texts = []
    for stream in streams:
        stream.flush()
        texts.append(stream.buffer.getvalue().decode(encoding))
    result = Result(code, *texts)
    assert "Traceback" not in result.err + result.out
    return result


def command(*arguments):
    """The command line for a process of its own."""
    return [sys.executable, "-m", "actuator_opt", *map(str, arguments)]


def surroundings(**changes):
    """Environment of a process of its own, without what would colour or date its output."""
    clean = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "SOURCE_DATE_EPOCH")}
    return clean | {"PYTHONPATH": str(ROOT)} | changes


def spawn(*arguments, **options):
    """Run one command in a process of its own."""
    environment = options.pop("environment", {})
    return subprocess.run(
        command(*arguments),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env=surroundings(**environment),
        **options,
    )


def knee(*changes):
    """The knee design's text with (old, new) pairs replaced, each of them found."""
    text = KNEE_TEXT
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text
