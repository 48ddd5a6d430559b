"""Films under seals: convergence over the whole range of operating points, time per point.

Never gating. Run with `just bench`; the shares and times are printed with ``-s``.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "cases"))

import film_cases
from test_lubrication_slopes import lip_seal, step_ring, tandem

from actuator_opt.lubrication import solve_film

COUNT = 2000
BUDGET_WARM, BUDGET_TANDEM = 10e-3, 100e-3


def test_convergence(benchmark):
    """2000 log-random points over 1e-4..1 m/s, 0.1..40 MPa, -20..100 degC: 99 % or more."""
    cases = film_cases.random_cases(COUNT, seed=2017)
    tried, good, times = Counter(), Counter(), []

    def study():
        for kind, contact in cases:
            start = time.perf_counter()
            film = solve_film(contact)
            times.append(time.perf_counter() - start)
            tried[kind] += 1
            good[kind] += film.converged and max(film.load_residual, film.mass_residual) < 1e-6
            if not film.converged:
                print(f"{kind}: {contact.speed:.3g} m/s, {film.reason}")

    benchmark.pedantic(study, rounds=1)
    for kind in film_cases.KINDS:
        print(f"{kind}: {good[kind]} of {tried[kind]} converged")
    cold = 1e3 * np.quantile(times, [0.5, 0.9, 1.0])
    print(
        f"cold point: median {cold[0]:.1f} ms, 90 % below {cold[1]:.1f} ms, worst {cold[2]:.0f} ms"
    )
    assert sum(good.values()) >= 0.99 * COUNT


def test_warm_sweep(benchmark):
    """A sweep of 40 speeds at 121 nodes, each film begun from the last: 10 ms per point."""
    first = solve_film(film_cases.lip(1e-3, nodes=121))

    def sweep():
        film = first
        for speed in np.geomspace(1e-3, 0.5, 40):
            film = solve_film(replace(first.contact, speed=float(speed)), film)
            assert film.converged

    benchmark(sweep)
    print(f"warm point: {1e3 * benchmark.stats.stats.median / 40:.2f} ms")
    assert benchmark.stats.stats.median / 40 < BUDGET_WARM


def test_tandem(benchmark):
    """A step ring and a lip in a row, from nothing: 100 ms."""
    found = benchmark(lambda: tandem(step_ring(), lip_seal(), 0.05))
    assert found.converged
    print(f"tandem: {1e3 * benchmark.stats.stats.median:.1f} ms")
    assert benchmark.stats.stats.median < BUDGET_TANDEM
