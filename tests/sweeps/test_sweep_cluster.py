"""A sweep on a cluster is that of one machine, though a worker dies under it."""

from __future__ import annotations

import os
import signal
import threading
import time

import pytest
from cases.digests import digest
from sweep_case import STEEL

import actuator_opt as ao
from actuator_opt.base.errors import UsageError
from actuator_opt.sweeps import run

distributed = pytest.importorskip("distributed")
VARY = ["cylinder.bore=18..26 mm", "rod.outer_diameter=9..13 mm"]


@pytest.fixture
def cluster():
    """Two workers, each a process of its own; a nanny starts a lost one again."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
    ) as found:
        yield found


@pytest.mark.long
def test_a_cluster_with_a_killed_worker_gives_the_same_rows(cluster, monkeypatch, tmp_path):
    """Bytes of the CSV as on one machine; one worker is killed in the middle."""
    monkeypatch.setattr(run, "CHUNK", 50)
    here, there = tmp_path / "here.csv", tmp_path / "there.csv"
    ao.sweep(STEEL, VARY, method="lhs", n=3000, csv=here, workers=1)
    victim = next(iter(cluster.workers.values())).pid
    killer = threading.Timer(0.6, os.kill, (victim, signal.SIGKILL))
    killer.start()
    began = time.perf_counter()
    swept = ao.sweep(
        STEEL, VARY, method="lhs", n=3000, csv=there, scheduler=cluster.scheduler_address
    )
    killer.join()
    assert time.perf_counter() - began > 0.6  # it was at work when the worker died
    assert swept.computed == 3000
    assert digest(here) == digest(there)


def test_no_scheduler_is_said_in_one_line(monkeypatch):
    """Nothing answers at the address."""
    monkeypatch.setattr("actuator_opt.base.cluster.PATIENCE", "1s")
    with pytest.raises(UsageError, match="no scheduler answers"):
        ao.sweep(STEEL, ["cylinder.bore=18..26 mm:3"], scheduler="tcp://127.0.0.1:9")
