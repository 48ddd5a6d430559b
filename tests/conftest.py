"""Settings every test shares."""

from __future__ import annotations

import functools
import gc
import json
import os
import sys
import tempfile

import pytest
from browser import Visits, started
from hypothesis import settings

# Each core runs a worker; linear algebra on all of them at once would only make them wait.
for library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

# Collected tests last: searching them for unused cycles again and again takes a tenth of the time.
gc.set_threshold(100_000)

# This process and those that tests start keep what they compiled: each would compile it anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# A loaded machine is no failure; continuous integration tries the same examples every time.
SAME_EVERY_TIME = "CI" in os.environ
settings.register_profile(
    "house",
    deadline=None,
    derandomize=SAME_EVERY_TIME,
    max_examples=25 if SAME_EVERY_TIME else 50,
)
settings.load_profile("house")

# No test writes into a person's own folders, nor does a process that a test starts.
_RUNS = tempfile.TemporaryDirectory(prefix="actuator-opt-runs-")
os.environ["ACTUATOR_OPT_RUNS"] = _RUNS.name
if "PYTEST_XDIST_WORKER" not in os.environ:  # workers share the recorded models of their master
    _PROGRAMS = tempfile.TemporaryDirectory(prefix="actuator-opt-programs-")
    os.environ["ACTUATOR_OPT_PROGRAMS"] = _PROGRAMS.name
os.environ.pop("ACTUATOR_OPT_NO_RECORD", None)


def pytest_collection_finish():
    """No search for unused cycles goes through what was collected."""
    gc.freeze()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item, nextitem):
    """What the functions of a test module have cached goes with its last test."""
    if nextitem is not None and nextitem.path == item.path:
        return
    module = getattr(item, "module", None)
    for one in vars(module).values() if module else ():
        if hasattr(one, "cache_clear") and one.__module__ == module.__name__:
            one.cache_clear()


@pytest.fixture(scope="session", autouse=True)
def coarse_images():
    """Images of sheets at a fifth of their resolution: drawing them is half the time of a report.

    What a process of its own writes keeps the resolution of the package.
    """
    from actuator_opt.rendering import paper

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(paper, "PIXELS_PER_INCH", paper.PIXELS_PER_INCH / 5)
        yield


@pytest.fixture(scope="session", autouse=True)
def sheets_compiled_once():
    """A page that is written again with equal data is not compiled again.

    `test_report_writer` compiles one twice and compares the bytes.
    """
    from actuator_opt.rendering import paper

    compiled, made = paper.sheets, {}

    @functools.wraps(compiled)
    def sheets(source, data, timestamp):
        key = (source, json.dumps(data, sort_keys=True), timestamp, paper.PIXELS_PER_INCH)
        if key not in made:
            while len(made) >= 16:
                made.pop(next(iter(made)))
            made[key] = compiled(source, data, timestamp)
        pdf, images = made[key]
        return pdf, list(images)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(paper, "sheets", sheets)
        yield


@pytest.fixture(scope="module")
def searched_once():
    """Equal optimisations are solved once; for modules whose subject is not the search."""
    from actuator_opt.optimisation import run

    solved, found = run.optimise, {}

    @functools.wraps(solved)
    def optimise(subject, *, fault=None, **options):
        key = repr((subject.design, subject.plugins, sorted(options.items())))
        if key not in found:
            found[key] = solved(subject, fault=fault, **options)
        return found[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "optimise", optimise)
        yield


@pytest.fixture(scope="session")
def browser():
    """The installed browser; skips where there is none, or no Playwright."""
    with started() as launched:
        yield launched


@pytest.fixture
def visit(browser):
    """Open pages; none may write to the console, fail, or ask for another file."""
    visits = Visits(browser)
    yield visits
    assert visits.close() == []
