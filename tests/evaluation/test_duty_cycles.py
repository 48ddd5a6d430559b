"""Duty cycles against numbers that an independent program computed for the source's example."""

import math
from pathlib import Path

import numpy as np
import pytest

from actuator_opt.design.cycle_record import read_cycle
from actuator_opt.evaluation.duty_cycles.numbers import SamplePlan
from actuator_opt.evaluation.duty_cycles.results import CycleModels, Place
from actuator_opt.evaluation.duty_cycles.samples import leakage_at_rest, sample

BAR = 1e5
CYCLES = Path(__file__).parents[2] / "designs" / "cycles"
AREA_A, AREA_B = math.pi / 4 * 0.023**2, math.pi / 4 * (0.023**2 - 0.013**2)
EDGE = 10 / 60000 / math.sqrt(35 * BAR)
"""Cylinder 23/13 mm, 210 bar, return 5 bar, valve of 10 l/min at 35 bar per edge."""


def numbers(**changed: float) -> dict[str, float]:
    """Numbers of the example, with a constant friction."""
    values = {
        "supply": 210 * BAR, "drain": 5 * BAR, "area_a": AREA_A, "area_b": AREA_B,
        "stroke": 0.11, "closed_length": 0.192, "opening_limit": 1.0, "piston_leakage": 0.0,
        "other_friction": 0.0, "line_volume_a": 0.0, "line_volume_b": 0.0,
        "rod_pulse": 210 * BAR * (AREA_A + AREA_B), "base_radius": 0.25, "crank_radius": 0.062,
        "angle_offset": math.radians(120),
    }  # fmt: skip
    for name in ("feed_a", "feed_b", "drain_a", "drain_b"):
        values |= {name: EDGE, f"{name}.leak_root": 0.0, f"{name}.leak_linear": 0.0}
    cycle = {
        "load_scale": 1.0, "time_scale": 1.0, "level": 210 * BAR, "arm": 1.0, "shift": 0.0,
    }  # fmt: skip
    return values | {f"walk|{key}": x for key, x in cycle.items()} | changed


def results(text: str, *, linkage: bool = False, **changed: float) -> dict[Place, float]:
    """Results of a cycle by place."""
    plan = SamplePlan(frozenset(["walk"] if linkage else []), True, (), (), (), {})
    values = numbers(**changed)
    models = CycleModels(plan, {"walk": read_cycle(text)}, tuple(values))
    rows = models(np.array([*values.values()])[:, None])[:, 0]
    return dict(zip(models.places, map(float, rows), strict=True))


def at_sample(data: dict[str, float], *, linkage: bool = False, **changed: float):
    """Results of a single sample of the example."""
    plan = SamplePlan(frozenset(), True, (), (), (), {})
    u = numbers(**changed)
    u |= {key.removeprefix("walk|"): x for key, x in u.items()}
    return sample(plan, u, data, linked=linkage)


def of(results: dict[Place, float], name: str) -> list[float]:
    """All values of a result."""
    return [value for place, value in results.items() if place.name == name]


STEPS = (
    "time [s],position [mm],force [N]\n0,20,500\n0.3,60,800\n0.5,90,-200\n0.8,50,-600\n1,20,500\n"
)
LEAK = {
    f"{name}.leak_root": 0.2 / 60000 / math.sqrt(50 * BAR)
    for name in ("feed_a", "feed_b", "drain_a", "drain_b")
}


def test_the_energies_of_five_samples_are_those_of_the_source():
    """The energies of five samples, by hand-sized numbers of the source."""
    found = results(STEPS, other_friction=100.0)
    expected = {
        "way": 0.14, "volume": 4.88753e-5, "supply_energy": 1026.38, "work_out": 52.5,
        "friction_energy": 14.0, "return_energy": 24.4377, "throttling_energy": 935.444,
    }  # fmt: skip
    for name, value in expected.items():
        assert found[Place("walk", name)] == pytest.approx(value, rel=1e-5), name
    assert found[Place("walk", "work_in")] == 0.0
    efficiency = found[Place("walk", "work_out")] / found[Place("walk", "supply_energy")]
    assert efficiency == pytest.approx(0.0511506, rel=1e-5)


def test_a_sample_of_the_linkage_is_that_of_the_source():
    """Flexed by 20 degrees at 2 rad/s under 27 N m."""
    data = {"motion": math.radians(-20), "load": 27.0, "rate": -2.0}
    found = at_sample(data, linkage=True)
    expected = {"arm": 0.0569956, "position": 0.0758191, "speed": -0.113991, "force": 473.721}
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=5e-6), name
    assert found["position"] + 0.192 == pytest.approx(0.267819, rel=5e-6)


@pytest.mark.parametrize(
    ("force", "speed", "opening", "reserve", "needed"),
    [(1000.0, 0.38, 0.475707, 5464.91, 7.84661e6), (-500.0, -0.4, 0.602988, 2882.28, 10.8060e6)],
)
def test_opening_and_reserve_of_a_sample_are_those_of_the_source(
    force: float, speed: float, opening: float, reserve: float, needed: float
):
    """Both directions, at 90 % of the valve."""
    data = {"motion": 0.05, "load": force, "rate": speed}
    found = at_sample(data, opening_limit=0.9)
    assert found["opening"] == pytest.approx(opening, rel=5e-6)
    assert found["reserve"] == pytest.approx(reserve, rel=5e-6)
    assert found["needed"] == pytest.approx(needed, rel=5e-6)


def test_leakage_of_a_sample_is_that_of_the_source():
    """0.2 l/min at 50 bar an edge: coefficient, leakage against 1000 N, and power at rest."""
    assert LEAK["feed_a.leak_root"] == pytest.approx(1.49071e-9, rel=5e-6)
    found = at_sample({"motion": 0.05, "load": 1000.0, "rate": 0.1}, **LEAK)
    assert found["leakage"] == pytest.approx(9.42802e-6, rel=5e-6)
    plan = SamplePlan(frozenset(), True, (), (), (), {})
    assert 210 * BAR * leakage_at_rest(plan, numbers(**LEAK)) == pytest.approx(200.449, rel=5e-6)


def test_the_gait_of_a_knee_is_that_of_the_source():
    """All results of the walking knee."""
    text = (CYCLES / "gait_knee.csv").read_text()
    found = results(text, linkage=True, other_friction=250.0, **LEAK)
    expected = {
        "way": 0.141225, "supply_energy": 1260.86, "leakage_energy": 225.492,
        "throttling_energy": 984.497, "friction_energy": 35.3063,
        "work_out": 4.75351, "work_in": 13.8445, "ripple_volume": 1.83744e-5,
    }  # fmt: skip
    for name, value in expected.items():
        assert found[Place("walk", name)] == pytest.approx(value, rel=1e-5), name
    # the source counts the leaked oil's part twice: as leakage, and in what returns
    leaked = 5 / 210 * found[Place("walk", "leakage_energy")]
    assert found[Place("walk", "return_energy")] + leaked == pytest.approx(30.0204, rel=1e-5)
    assert min(of(found, "reserve")) == pytest.approx(4144.08, rel=1e-5)
    assert max(of(found, "opening")) == pytest.approx(0.502515, rel=1e-5)
    assert max(of(found, "needed")) == pytest.approx(6.34333e6, rel=1e-5)
    assert min(of(found, "pressure_a_min") + of(found, "pressure_b_min")) == pytest.approx(
        5.07005e6, rel=1e-5
    )
    assert max(of(found, "flow_peak")) == pytest.approx(1.66776e-4, rel=1e-5)
    mean = found[Place("walk", "volume")] / found[Place("walk", "duration")]
    assert mean == pytest.approx(5.45825e-5, rel=1e-5)
    assert min(of(found, "position_min")) == pytest.approx(32.5207e-3, rel=1e-5)
    assert max(of(found, "position_max")) == pytest.approx(94.067e-3, rel=1e-5)
    efficiency = found[Place("walk", "work_out")] / found[Place("walk", "supply_energy")]
    assert efficiency == pytest.approx(0.00377007, rel=1e-5)
    rest = found[Place("", "rest_leakage")]
    assert rest == pytest.approx(9.54521e-6, rel=1e-5)


def test_the_traces_of_the_gait_have_the_extremes_of_the_source():
    """Least reserve at sample 64; forces, and the largest speed."""
    plan = SamplePlan(frozenset(["walk"]), True, (), (), (), {})
    values = numbers(other_friction=250.0)
    record = read_cycle((CYCLES / "gait_knee.csv").read_text())
    models = CycleModels(plan, {"walk": record}, tuple(values))
    track = models.tracks(np.array([*values.values()])[:, None])["walk"]
    assert np.argmin(track.real("reserve")) == 64
    force = track.real("force")
    assert (force.min(), force.max()) == pytest.approx((-532.963, 512.698), rel=5e-6)
    assert np.abs(track.real("speed")).max() == pytest.approx(0.380186, rel=5e-6)


def test_the_energy_of_the_supply_is_that_of_all_parts_of_the_split():
    """The split of the energy adds up, and throttling is what both edges lose."""
    text = (CYCLES / "gait_knee.csv").read_text()
    found = results(text, linkage=True, other_friction=250.0, **LEAK)
    at = {place.name: value for place, value in found.items()}
    parts = ("throttling_energy", "leakage_energy", "return_energy", "friction_energy", "work_out")
    assert sum(at[name] for name in parts) - at["work_in"] == pytest.approx(
        at["supply_energy"], rel=1e-12
    )
    # the throttled energy is also that of both open edges, sample by sample
    plan = SamplePlan(frozenset(["walk"]), True, (), (), (), {})
    values = numbers(other_friction=250.0, **LEAK)
    models = CycleModels(plan, {"walk": read_cycle(text)}, tuple(values))
    track = models.tracks(np.array([*values.values()])[:, None])["walk"]
    x, a, b, speed, force, rubbed = (
        track.real(name)[:, 0]
        for name in ("position", "pressure_a", "pressure_b", "speed", "force", "friction")
    )
    dx = np.diff(x)
    mean_a, mean_b = (a[1:] + a[:-1]) / 2, (b[1:] + b[:-1]) / 2
    out = (210 * BAR - mean_a) * AREA_A + (mean_b - 5 * BAR) * AREA_B
    back = (210 * BAR - mean_b) * AREA_B + (mean_a - 5 * BAR) * AREA_A
    away = speed >= 0
    same = (away[1:] == away[:-1]) & (away[1:] == (dx > 0))  # no reversal within the interval
    edges = np.where(dx > 0, out, back) * np.abs(dx)
    work = (force[1:] + force[:-1]) / 2 * dx
    loss = (rubbed[1:] + rubbed[:-1]) / 2 * np.abs(dx)
    given = np.where(dx > 0, AREA_A, AREA_B) * 210 * BAR * np.abs(dx)
    returned = np.where(dx > 0, AREA_B, AREA_A) * 5 * BAR * np.abs(dx)
    rest = given - returned - work - loss
    assert same.sum() > 90
    assert rest[same] == pytest.approx(edges[same], rel=1e-9)


@pytest.mark.parametrize("name", ["area_a", "drain", "feed_b", "crank_radius", "walk|load_scale"])
def test_slopes_of_all_results_are_those_of_differences(name: str):
    """Exact slopes against central differences."""
    text = (CYCLES / "gait_knee.csv").read_text()
    values = numbers(other_friction=250.0, **LEAK)
    plan = SamplePlan(frozenset(["walk"]), True, (), (), (), {})
    models = CycleModels(plan, {"walk": read_cycle(text)}, tuple(values))
    point, row = np.array([*values.values()]), [*values].index(name)
    step = point.astype(complex)
    step[row] += 1e-30j
    slopes = models(step[:, None])[:, 0].imag / 1e-30
    high, low = point.copy(), point.copy()
    high[row] *= 1 + 1e-6
    low[row] *= 1 - 1e-6
    above, below = models(high[:, None])[:, 0], models(low[:, None])[:, 0]
    differences = (above - below) / (high[row] - low[row])
    scale = np.abs(differences).max() * 1e-4 + 1e-9 * np.abs(above) / np.abs(high[row] * 1e-6)
    assert np.all(np.abs(slopes - differences) <= 1e-4 * np.abs(differences) + scale * 1e-3)


def test_equal_designs_are_computed_once(monkeypatch):
    """Studies that change other numbers ask for the same cycle again and again."""
    plan = SamplePlan(frozenset(), True, (), (), (), {})
    one, other = numbers(), numbers(supply=180 * BAR)
    models = CycleModels(plan, {"walk": read_cycle(STEPS)}, tuple(one))
    points = np.array([[*x.values()] for x in (one, other, one, one)]).T
    each = np.concatenate([models(points[:, k : k + 1]) for k in range(4)], axis=1)
    computed = []
    some = CycleModels._results
    monkeypatch.setattr(
        CycleModels, "_results", lambda self, x, y: computed.append(x.shape[1]) or some(self, x, y)
    )
    assert np.array_equal(models(points), each)
    assert computed == [2]
