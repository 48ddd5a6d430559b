"""Samples of all cycles in the same runs of the machine: as cycle by cycle, and as in NumPy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from actuator_opt.base.symbolic import program as programs
from actuator_opt.design.cycle_record import read_cycle
from actuator_opt.evaluation.duty_cycles.numbers import STRESS, FatiguePart, SamplePlan
from actuator_opt.evaluation.duty_cycles.results import RANKS, CycleModels, Place, windows_of

BAR = 1e5
AREA_A, AREA_B = math.pi / 4 * 0.023**2, math.pi / 4 * (0.023**2 - 0.013**2)
EDGE = 10 / 60000 / math.sqrt(35 * BAR)


def joint(samples: int, turns: float) -> str:
    """A cycle of a joint as a file."""
    time = np.linspace(0.0, 1.0, samples)
    angle, torque = 30 * np.sin(2 * np.pi * turns * time), 40 * np.cos(4 * np.pi * time) + 5
    angle[-1], torque[-1] = angle[0], torque[0]
    rows = [f"{t:.9f},{a:.9f},{q:.9f}" for t, a, q in zip(time, angle, torque, strict=True)]
    return "\n".join(["time [s],joint_angle [deg],joint_torque [N*m]", *rows]) + "\n"


def axial(samples: int, *, supply: bool) -> str:
    """A cycle of position and force as a file, maybe with the supply pressure of every sample."""
    time = np.linspace(0.0, 2.0, samples)
    x, force = 50 - 20 * np.cos(np.pi * time), 300 * np.sin(3 * np.pi * time)
    rows = [f"{t:.9f},{p:.9f},{f:.9f}" for t, p, f in zip(time, x, force, strict=True)]
    head = "time [s],position [mm],force [N]"
    if supply:
        rows = [f"{row},{180 + 10 * k / samples:.6f}" for k, row in enumerate(rows)]
        head += ",supply_pressure [bar]"
    return "\n".join([head, *rows]) + "\n"


CYCLES = {
    "long": joint(301, 3),
    "short": joint(33, 1),
    "axial": axial(65, supply=False),
    "supplied": axial(41, supply=True),
}


def numbers(offset: float, cycles) -> dict[str, float]:
    """Numbers of a design with the cycles; `offset` [deg] of the linkage."""
    values = {
        "supply": 210 * BAR, "drain": 5 * BAR, "area_a": AREA_A, "area_b": AREA_B,
        "stroke": 0.11, "closed_length": 0.192, "opening_limit": 0.9, "piston_leakage": 1e-14,
        "other_friction": 40.0, "line_volume_a": 2e-6, "line_volume_b": 1e-6,
        "rod_pulse": 210 * BAR * (AREA_A + AREA_B), "base_radius": 0.25, "crank_radius": 0.062,
        "angle_offset": math.radians(offset),
    }  # fmt: skip
    for name in ("feed_a", "feed_b", "drain_a", "drain_b"):
        values |= {name: EDGE, f"{name}.leak_root": 0.01 * EDGE, f"{name}.leak_linear": 1e-14}
    for k, name in enumerate(cycles):
        one = (1.0 + 0.1 * k, 1.0 - 0.05 * k, (200 - 5 * k) * BAR, 1.0, 0.001 * k)
        keys = ("load_scale", "time_scale", "level", "arm", "shift")
        values |= {f"{name}|{key}": x for key, x in zip(keys, one, strict=True)}
    return values


def models(cycles, values) -> CycleModels:
    """The models of some of the cycles."""
    linked = frozenset(name for name in cycles if name in ("long", "short"))
    plan = SamplePlan(linked, True, (), (), (), {})
    records = {name: read_cycle(CYCLES[name]) for name in cycles}
    return CycleModels(plan, records, tuple(values), {"short": (0.25,)})


def computed(cycles, offsets) -> dict:
    """Results with slopes (designs, 1 + directions) of designs by place."""
    values = numbers(offsets[0], CYCLES)
    points = np.array([[numbers(offset, CYCLES)[name] for offset in offsets] for name in values])
    some = [k for k, name in enumerate(values) if "|" not in name or name.split("|")[0] in cycles]
    ways = np.random.default_rng(3).normal(size=(len(points), len(offsets), 5))
    full = np.concatenate([points[:, :, None], ways * np.abs(points)[:, :, None]], axis=2)[some]
    found = models(cycles, [[*values][k] for k in some])
    return dict(zip(found.places, found.duals(full), strict=True))


OFFSETS = ([120.0], [120.0, 118.0, 240.0], [240.0, 235.0], [170.0, 120.0])
"""One design; designs whose lever arms differ in sign; negative ones; a dead point in the cycle."""


@pytest.mark.parametrize("offsets", OFFSETS)
def test_all_cycles_together_have_the_results_of_each_alone(offsets):
    """Of other lengths and kinds, with a second actuator, in every direction of the numbers."""
    together = computed([*CYCLES], offsets)
    compared = 0
    for cycle in CYCLES:
        for place, values in computed([cycle], offsets).items():
            if place.cycle == cycle and not place.place:  # windows are fewer with more cycles
                np.testing.assert_allclose(together[place], values, rtol=1e-11, atol=1e-25)
                compared += 1
    assert compared > 60


@pytest.mark.parametrize("offsets", OFFSETS)
def test_the_machine_and_numpy_agree_on_all_cycles(offsets, monkeypatch):
    """Values and slopes, whatever the sign of the lever arm."""
    if not programs.AVAILABLE:
        pytest.skip("the machine was not built")
    machine = computed([*CYCLES], offsets)
    monkeypatch.setattr(programs, "AVAILABLE", False)
    numpy = computed([*CYCLES], offsets)
    for place, values in machine.items():
        np.testing.assert_allclose(values, numpy[place], rtol=1e-9, atol=1e-20, err_msg=str(place))


def test_designs_together_have_the_results_of_each_alone():
    """Also where lever arms differ in sign, so that one program serves both directions."""
    mixed = computed([*CYCLES], OFFSETS[1])
    for k, offset in enumerate(OFFSETS[1]):
        alone = computed([*CYCLES], [offset])
        for place, values in alone.items():
            if place.name not in ("exchange_a", "exchange_b"):
                np.testing.assert_allclose(mixed[place][k, 0], values[0, 0], rtol=1e-11, atol=1e-25)


def test_the_worst_samples_of_every_cycle_are_in_its_windows():
    """The extremes over the windows of a cycle are those over its samples."""
    values = numbers(120.0, CYCLES)
    found = models([*CYCLES], values)
    point = np.array([*values.values()])[:, None]
    rows = dict(zip(found.places, found(point)[:, 0], strict=True))
    for cycle, track in found.tracks(point).items():
        for name, output, best in (("share", "share", max), ("pressure_b_min", "pressure_b", min)):
            windows = [x for place, x in rows.items() if (place.cycle, place.name) == (cycle, name)]
            ends = track.real(output)[:, 0]
            assert len(windows) >= 4
            assert best(windows) == best(ends)


@pytest.mark.parametrize("designs", [1, 3])
def test_the_next_worst_sample_is_another(designs):
    """Of several outputs and designs, in windows of different length; NaN is the worst."""
    records = [read_cycle(CYCLES[name]) for name in ("long", "short")]
    windows = windows_of(records, 4)
    random = np.random.default_rng(5)
    values = random.normal(size=(sum(len(x.time) for x in records), 5, designs))
    values[7, 2, 0] = np.nan
    found = windows.least(values).reshape(5, len(windows.cycles), RANKS, designs)
    for group in windows.groups:
        for window, rows, repeated in zip(*group, strict=True):
            own = rows[~repeated]
            for output in range(5):
                for design in range(designs):
                    keys = np.nan_to_num(values[own, output, design], nan=-np.inf)
                    expected = own[np.argsort(keys)[:RANKS]]
                    assert np.array_equal(found[output, window, :, design], expected)


def strong(cycles) -> dict:
    """Damage of a life of some cycles of 20 kN, of a steady load, and of noise of 2 kN."""
    time = np.linspace(0.0, 1.0, 201)
    x = 50 + 20 * np.sin(2 * np.pi * time)
    noise = np.random.default_rng(2).normal(size=time.size)
    loads = {
        "strong": -2e4 * np.cos(4 * np.pi * time),
        "noise": 2e3 * noise,
        "hold": 500 + 0 * time,
    }
    records = {}
    for name in cycles:
        force = np.append(loads[name][:-1], loads[name][0])
        rows = [f"{t:.6f},{p:.6f},{f:.6f}" for t, p, f in zip(time, x, force, strict=True)]
        rows[-1] = f"{time[-1]:.6f},{x[0]:.6f},{force[0]:.6f}"
        head = "time [s],position [mm],force [N]"
        records[name] = read_cycle("\n".join([head, *rows]) + "\n")
    values = {k: v for k, v in numbers(120.0, []).items() if "|" not in k}
    for name in cycles:
        keys = ("load_scale", "time_scale", "level", "arm", "shift", "repeats", "starts")
        values |= {
            f"{name}|{key}": x for key, x in zip(keys, (1, 1, 210e5, 1, 0, 1e3, 10), strict=True)
        }
    part = (400e6, 0.0, 400e6, 500e6, 160e6, 1e7)
    values |= {f"part0.{key}": x for key, x in zip(STRESS, part, strict=True)}
    plan = SamplePlan(frozenset(), True, (), (), (FatiguePart("rod", "rod"),), {})
    found = CycleModels(plan, records, tuple(values))
    full = np.array([*values.values()])[:, None, None] * np.array([1.0, 0.01])
    return dict(zip(found.places, found.duals(full)[:, 0], strict=True))


def test_the_damage_of_a_cycle_does_not_depend_on_the_cycles_beside_it():
    """Columns that only fill up to the busiest cycle have none, though their stress has no life."""
    together = strong(["strong", "noise", "hold"])
    total = 0.0
    for name in ("strong", "noise", "hold"):
        place = Place(name, "damage", "rod")
        alone = strong([name])[place]
        np.testing.assert_allclose(together[place], alone, rtol=1e-12)
        assert np.isfinite(alone).all()
        total += alone[0]
    assert together[Place("", "damage", "rod")][0] >= total > 0
