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

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "cases"))

import bench_oracle as oracle

import actuator_opt as ao
from actuator_opt.identification import Record, Settings, identify
from actuator_opt.studies.bench import bench as bench_of

COUNT = 200
LAG = 4e-3
DESIGN = Path(__file__).parent.parent / "designs" / "knee_bonded.yaml"
PLUNGER_MOTIONS = (
    lambda rng: oracle.plateaus(np.geomspace(1e-3, 0.1, 7) * rng.uniform(0.9, 1.1), longest=0.8),
    lambda rng: oracle.plateaus(np.array([1, 2, 4, 8]) * 1e-3 * rng.uniform(0.9, 1.1), longest=1.0),
    lambda rng: oracle.sine(amplitude=0.03, frequency=0.25, periods=4),
    lambda rng: oracle.ramps(fastest=0.05, duration=3.0, repeats=2),
    lambda rng: oracle.sine(amplitude=0.01, frequency=0.15, periods=3),
)
POSITIONS = ((0, 1e-5), (1e-6, 0), (5e-6, 1e-6), (1e-5, 0), (2e-6, 1e-5), (0, 1e-6))
"""White noise and steps of the position sensor [m]."""
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


def plunger_record(bench, seed, lag):
    """A plunger at 1 to 3 kPa of noise, its position with white noise or steps, no sigma_1."""
    rng = np.random.default_rng(seed)
    coulomb = rng.uniform(40, 200)
    truth = oracle.Friction(
        coulomb=coulomb,
        static=coulomb * rng.uniform(1.3, 2.2),
        stribeck_speed=rng.uniform(2e-3, 1e-2),
        exponent=rng.uniform(0.8, 2.2),
        viscous=rng.uniform(100, 1000),
        bristle_stiffness=coulomb / rng.uniform(1.5e-5, 6e-5),
        bristle_damping=0.0,
    )
    motion = PLUNGER_MOTIONS[seed % 5](rng)
    noise, step = POSITIONS[seed // 5 % 6]
    pressure_noise, load = rng.uniform(1e3, 3e3), rng.choice([0.0, 2000.0])
    sensors = oracle.Sensors(
        pressure_noise=pressure_noise, position_step=0.0, force_noise=0.5, lag=lag, outliers=0.0
    )
    record = oracle.measured(
        oracle.cylinder_of(bench), truth, motion, load=load, mass=bench.mass, sensors=sensors,
        seed=seed,
    )  # fmt: skip
    place = record["x"] + noise * np.random.default_rng(seed + 10000).standard_normal(
        record.time.size
    )
    if step:
        place = step * np.rint(place / step)
    return Record(record.time, {**record.channels, "x": place}, "plunger")


@pytest.mark.parametrize("lag", [0.0, LAG])
def test_lag_of_plungers(benchmark, lag):
    """Of 200 plungers at most 5 % (and 3 sigma of the count) miss the lag or find one at 0."""
    bench = bench_of(ao.read(DESIGN, set={"seals.piston.count": 0}).subject())
    found = benchmark.pedantic(
        lambda: [identify(plunger_record(bench, seed, lag), bench) for seed in range(COUNT)],
        rounds=1,
    )
    seen = [one.lag_seen for one in found if one.lag_seen and np.isfinite(one.lag_seen.upper)]
    held = sum(one.lower <= lag <= one.upper for one in seen)
    taken = [one.pressure_lag for one in found if one.pressure_lag]
    print(f"lag {1e3 * lag:g} ms: {len(seen)} of {COUNT} bounded, {held} hold it", end=", ")
    print(f"{len(taken)} taken off, {1e3 * min(taken, default=0):.2f} to "
          f"{1e3 * max(taken, default=0):.2f} ms")  # fmt: skip
    allowed = 0.05 + 3 * np.sqrt(0.95 * 0.05 / len(seen))
    assert len(seen) - held <= allowed * len(seen)
    assert lag > 0 or not taken or len(taken) <= allowed * len(seen)
