"""Identification: how often the 95 % bounds of 200 noisy records hold the truth, by method.

Never gating, some minutes; the tables are printed with ``-s``. Records are those of the tests'
oracle: 1 kHz, 0.1 % of 25 MPa on pressures, 10 um position steps, 4 ms pressure lag, 5 % outliers,
each of another seed and another truth.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

import bench_oracle as oracle

import actuator_opt as ao
from actuator_opt.evaluation.study.bench import bench as bench_of
from actuator_opt.identification import Settings, identify

COUNT = 200
LAG = 4e-3
DESIGN = Path(__file__).parent.parent / "designs" / "knee.yaml"
METHODS = {
    "plateaus": lambda rng: oracle.plateaus(np.geomspace(7e-4, 0.2, 12) * rng.uniform(0.9, 1.1)),
    "sine": lambda rng: oracle.sine(
        amplitude=0.04 * rng.uniform(0.7, 1), frequency=0.25, periods=6
    ),
    "ramps": lambda rng: oracle.ramps(fastest=0.08, duration=2.4, repeats=4),
    "slow sine": lambda rng: oracle.sine(amplitude=5e-3, frequency=0.2, periods=5),
    "pre-sliding": lambda rng: oracle.sine(amplitude=1e-4, frequency=0.5, periods=8),
}


def random_truth(rng):
    """Seals from smooth to sticky: F_C 80..300 N, F_S/F_C 1.3..2.2, v_s 2..10 mm/s, exponent."""
    coulomb = rng.uniform(80, 300)
    return oracle.Friction(
        coulomb=coulomb,
        static=coulomb * rng.uniform(1.3, 2.2),
        stribeck_speed=rng.uniform(2e-3, 1e-2),
        exponent=rng.uniform(0.8, 2.2),
        viscous=rng.uniform(100, 1500),
        bristle_stiffness=coulomb / rng.uniform(1.5e-5, 6e-5),
        bristle_damping=1e3,
    )


def one_record(bench, method, seed, settings):
    """Truth and fitted parameters by model and name; the level without a curve is left out."""
    rng = np.random.default_rng(seed)
    truth = random_truth(rng)
    motion = METHODS[method](rng)
    record = oracle.measured(oracle.cylinder_of(bench), truth, motion, mass=bench.mass, seed=seed)
    found = identify(record, bench, settings)
    rows = {}
    for name in ("stribeck", "lugre"):
        model = getattr(found, name)
        if isinstance(model, str):
            continue
        level = name == "lugre" and isinstance(found.stribeck, str)
        for key, one in model.parameters.items():
            if hasattr(truth, key) and not (level and key == "coulomb"):
                rows[name, key] = getattr(truth, key), one
    return rows


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("lag_known", [False, True], ids=["lag looked for", "lag stated"])
def test_coverage(benchmark, method, lag_known):
    """Every parameter called identifiable in 20 records or more: 90 to 99 % hold the truth.

    Binomial scatter of a count n is allowed for, 3 sqrt(0.95 0.05/n).
    """
    bench = bench_of(ao.read(DESIGN).subject())
    settings = Settings(pressure_lag=LAG if lag_known else None)
    records = benchmark.pedantic(
        lambda: [one_record(bench, method, seed, settings) for seed in range(COUNT)], rounds=1
    )
    low = []
    for key in sorted({key for rows in records for key in rows}):
        known = [rows[key] for rows in records if key in rows and rows[key][1].identifiable]
        asked = sum(key in rows for rows in records)
        if not known:
            print(f"{method}: {' '.join(key)}: asked {asked}, never identifiable")
            continue
        off = np.array([one.value / truth - 1 for truth, one in known])
        share = np.mean([one.lower <= truth <= one.upper for truth, one in known])
        print(
            f"{method}: {' '.join(key)}: asked {asked}, identifiable {len(known)}, bounds hold "
            f"{100 * share:.1f} %, bias {100 * np.mean(off):.2f} %, "
            f"spread {100 * np.std(off):.2f} %"
        )
        if len(known) >= 20 and share < 0.95 - max(0.05, 3 * np.sqrt(0.95 * 0.05 / len(known))):
            low.append(key)
    assert not low
