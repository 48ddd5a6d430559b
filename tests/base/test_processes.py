"""The processes of a sweep: they end with the one that began them, and leave Ctrl-C to it."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from cli_runner import KNEE, command, surroundings

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")
GRID = ["cylinder.bore=18..40 mm:400", "rod.outer_diameter=10..12 mm:400"]
"""Some seconds of work for each of two processes."""


def group(number):
    """Processes of a group that have not ended."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:  # ended meanwhile
                continue
            if int(fields[2]) == number and fields[0] != "Z":
                found.append(int(entry.name))
    return found


def until(true, seconds):
    """Whether something became true in time."""
    end = time.monotonic() + seconds
    while not (found := true()) and time.monotonic() < end:
        time.sleep(0.005)
    return found


@contextmanager
def sweeping(workers):
    """A sweep in a group of its own, of which some worker processes have begun."""
    words = ["sweep", KNEE, "--vary", GRID[0], "--vary", GRID[1], "--workers", 2, "--no-record"]
    process = subprocess.Popen(
        command(*words),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=surroundings(),
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        assert until(lambda: len(group(process.pid)) > workers, 30)
        yield process
    finally:
        for left in group(process.pid):
            os.kill(left, signal.SIGKILL)
        process.communicate()


def test_workers_end_with_a_killed_parent():
    """SIGKILL of the process that waits leaves none of its workers, asleep or at work."""
    with sweeping(workers=2) as process:
        time.sleep(0.3)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        assert until(lambda: not group(process.pid), 10)


@pytest.mark.parametrize("delay", [pytest.param(0.004, marks=pytest.mark.long), 0.02])
def test_an_interrupt_while_workers_begin(delay):
    """Ctrl-C reaches the whole group: workers that are just beginning leave it to their parent."""
    with sweeping(workers=1) as process:
        time.sleep(delay)
        os.killpg(process.pid, signal.SIGINT)
        shown, said = process.communicate(timeout=30)
        assert (process.returncode, shown, said) == (130, "", "interrupted\n")
        assert not group(process.pid)
