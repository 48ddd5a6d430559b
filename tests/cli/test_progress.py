"""Long work says how far it is, on a terminal's standard error and nowhere else."""

from __future__ import annotations

import io
import sys

import pytest

from actuator_opt.base import progress
from actuator_opt.cli import streams


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    def isatty(self) -> bool:
        """As a terminal says."""
        return True


def work(clock: list[float], *, fails: bool = False) -> None:
    """Ten steps of a second, with work inside, then a piece of unknown length."""
    for _ in progress.steps("counting", range(10)):
        progress.tell("inside", 0.5)
        clock[0] += 1.0
        if fails:
            raise ArithmeticError
    with progress.whole("searching"):
        clock[0] += 1.0


@pytest.fixture
def clock(monkeypatch):
    """Time that passes when the work says so."""
    now = [0.0]
    monkeypatch.setattr(streams, "monotonic", lambda: now[0])
    return now


def test_a_terminal_sees_share_and_time_left(monkeypatch, clock):
    """After a second: per cent and the seconds left at the pace so far; the line is cleared."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", shown := Terminal())
    with streams.watching():
        work(clock)
    lines = [line.rstrip() for line in shown.getvalue().split("\r")]
    assert lines[1:4] == [
        "counting, 10 %, 9 s left", "counting, 20 %, 8 s left", "counting, 30 %, 7 s left",
    ]  # fmt: skip
    assert lines[-3:] == ["searching", "", ""]
    assert "inside" not in shown.getvalue()


def test_work_that_fails_leaves_no_line(monkeypatch, clock):
    """The line is cleared before the fault is told, and nobody is told afterwards."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", shown := Terminal())

    def fail() -> None:
        with streams.watching():
            clock[0] += 5.0
            progress.tell("beginning", 0.5)
            work(clock, fails=True)

    with pytest.raises(ArithmeticError):
        fail()
    before = shown.getvalue()
    assert before.endswith("\r")
    assert before.split("\r")[-2].strip() == ""
    progress.tell("after", 0.5)
    assert shown.getvalue() == before


@pytest.mark.parametrize(("stream", "term"), [(io.StringIO, "xterm"), (Terminal, "dumb")])
def test_no_terminal_sees_nothing(monkeypatch, clock, stream, term):
    """A pipe, a file and a dumb terminal stay clean."""
    monkeypatch.setenv("TERM", term)
    monkeypatch.setattr(sys, "stderr", shown := stream())
    with streams.watching():
        work(clock)
    assert shown.getvalue() == ""
