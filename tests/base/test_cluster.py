"""Commands on a cluster: the numbers of one process, though a worker dies under them."""

from __future__ import annotations

import json
import os
import signal
import sys
import time

import pytest
from cli_runner import BENCH, KNEE, run

import actuator_opt as ao
from actuator_opt.base.cluster import HERE, connected
from actuator_opt.base.errors import UsageError

distributed = pytest.importorskip("distributed")
FIXED = BENCH[: BENCH.index("variables:")] + BENCH[BENCH.index("requirements:") :]
CHOICES = "choices:\n  seals.rod.compound: [nbr_90, nbr_70]\n  seals.rod.count: [1, 2]\n"


def yields(**cluster):
    """Draws in four chunks, and indices, of the knee."""
    return ao.uncertainty(KNEE, count=8000, rows=64, **cluster)


def quasi_random(**cluster):
    """Sixteen blocks of draws."""
    return ao.uncertainty(KNEE, count=2000, rows=0, quasi_random=True, **cluster)


def front(**cluster):
    """A front whose designs go to the workers in two groups, and its checks."""
    return ao.pareto(KNEE, ["mass:min", "stiffness_min:max"], n=10, **cluster)


def choices(**cluster):
    """Combinations solved from many starts."""
    return ao.optimise(ao.read(BENCH + CHOICES), prices=False, starts=2, **cluster)


def evaluated(**cluster):
    """Combinations without variables."""
    return ao.optimise(ao.read(FIXED + CHOICES), **cluster)


def numbers(result):
    """A result in JSON, without its time."""
    return json.dumps({k: v for k, v in result.to_dict().items() if k != "seconds"})


@pytest.fixture(scope="module")
def cluster():
    """Two workers, each a process of its own; a nanny starts a lost one again."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
    ) as local:
        yield local


def killer(cluster, monkeypatch, at):
    """Kill a worker that has work, at the submission with this number; returns its process."""
    submit, killed, count = distributed.Client.submit, [], 0

    def submitted(client, *args, **options):
        nonlocal count
        future = submit(client, *args, **options)
        count += 1
        if count == at:
            until = time.monotonic() + 30
            busy = set()
            while not busy and time.monotonic() < until:
                busy = {address for address, keys in client.processing().items() if keys}
            victim = next(x for x in cluster.workers.values() if x.worker_address in busy)
            killed.append(victim.pid)
            os.kill(victim.pid, signal.SIGKILL)
        return future

    monkeypatch.setattr(distributed.Client, "submit", submitted)
    return killed


@pytest.mark.long
@pytest.mark.parametrize(
    "study",
    [yields, quasi_random, pytest.param(front, marks=pytest.mark.long), choices, evaluated],
)
def test_a_cluster_with_a_killed_worker_gives_the_same_numbers(study, cluster, monkeypatch):
    """All of the JSON, digit by digit; a worker is killed while it has tasks."""
    here = numbers(study())
    killed = killer(cluster, monkeypatch, at=2)
    assert numbers(study(scheduler=cluster.scheduler_address)) == here
    assert len(killed) == 1


def test_results_come_in_the_order_of_the_tasks(cluster):
    """Later tasks end first; nested functions are sent; tasks are read only as needed."""
    read = []

    def tasks():
        for k in range(20):
            read.append(k)
            yield 0.2 if k == 0 else 0.001 * k

    with connected(cluster.scheduler_address) as workers:
        results = workers.map(lambda pause: (time.sleep(pause), pause)[1], tasks())
        first = next(results)
        assert first == 0.2
        assert len(read) < 20
        assert list(results) == [0.001 * k for k in range(1, 20)]
        assert [len(part) for part in workers.parts(range(5), 2)] == [2, 2, 1]
        assert list(workers.map(bool, [workers])) == [False]  # tasks start no further tasks
    assert [len(part) for part in HERE.parts(range(5), 2)] == [5]


@pytest.mark.long
def test_without_a_scheduler_a_command_ends_with_one_line(monkeypatch):
    """Nothing answers at the address: a command of each kind, before it computes anything."""
    monkeypatch.setattr("actuator_opt.base.cluster.PATIENCE", "1s")
    for study in (yields, front, choices):
        with pytest.raises(UsageError, match="no scheduler answers"):
            study(scheduler="tcp://127.0.0.1:9")
    words = ["uncertainty", KNEE, "--scheduler", "tcp://127.0.0.1:9"]
    result = run(*words)
    assert result.code == 2
    assert len(result.err.splitlines()) == 1
    assert "start one with `dask scheduler`" in result.err


def test_a_scheduler_without_workers_or_dask_is_told(monkeypatch):
    """Both are one line with what to do."""
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=":0", silence_logs=50) as empty,
        pytest.raises(UsageError, match="no worker has joined"),
    ):
        yields(scheduler=empty.scheduler_address)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match="needs Dask"):
        yields(scheduler="tcp://127.0.0.1:9")


def test_what_cannot_run_there_is_refused():
    """Custom metrics stay here; a design without choices has nothing to send."""

    @ao.metric("own", dimension="mass")
    def own(v):
        return v.metric("mass")

    there = {"plugins": [own], "scheduler": "tcp://127.0.0.1:9"}
    with pytest.raises(UsageError, match="custom metrics cannot be sent"):
        ao.uncertainty(KNEE, **there)
    with pytest.raises(UsageError, match="custom metrics cannot be sent"):
        ao.pareto(KNEE, ["mass:min", "stiffness_min:max"], **there)
    with pytest.raises(UsageError, match="custom metrics cannot be sent"):
        ao.optimise(ao.read(BENCH + CHOICES, plugins=[own]), scheduler=there["scheduler"])
    with pytest.raises(UsageError, match="this design has none"):
        ao.optimise(KNEE, scheduler=there["scheduler"])
