"""Bending tests to moduli: against closed forms, known noise, and the published specimen."""

from __future__ import annotations

import json
from math import inf, pi

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.signal import lfilter

from actuator_opt.base.errors import InputError
from actuator_opt.identification.bending import Specimen, bending
from actuator_opt.identification.record import Record, parse_record
from actuator_opt.identification.straight import branches, despiked, term

SPAN, OUTER, INNER = 0.3, 0.02, 0.016
SECOND_MOMENT = pi * (OUTER**4 - INNER**4) / 64
STRAIN = SPAN**2 / (6 * OUTER)
"""Deflection per strain of the outer fibre, from e = M D/(2 E I) and w = F L^3/(48 E I) [m]."""
TUBE = {"span": SPAN, "outer_diameter": OUTER, "inner_diameter": INNER}


def slope_of(modulus, *, shear=0.0, dents=0.0):
    """Springs in series: bending, shear force F/2 on both halves, dents."""
    return 1 / (SPAN**3 / (48 * modulus * SECOND_MOMENT) + SPAN * shear / 4 + dents)


def remembering(rng, count, memory):
    """Unit noise whose neighbours correlate by `memory`."""
    white = rng.standard_normal(count + 500)
    return lfilter([np.sqrt(1 - memory**2)], [1, -memory], white)[500:]


def a_record(
    slope, *, samples=300, cycles=2, top=0.003, toe=2e-5, friction=0.0, noise=0.0, memory=0.0,
    seed=0, force_zero=12.0, deflection_zero=3e-4, way=1.0,
):  # fmt: skip
    """A test that begins a tenth before contact: toe, friction at the supports, offsets, noise."""
    once = np.linspace(-0.1, 1.0, samples) * top * STRAIN
    w = np.concatenate([once, once[::-1]] * cycles)
    loading = np.repeat(np.tile([1.0, -1.0], cycles), samples)
    force = slope * toe * np.logaddexp(0, w / toe) * (1 + friction * loading)
    if noise:
        force = force + noise * remembering(np.random.default_rng(seed), w.size, memory)
    channels = {"w": way * (w + deflection_zero), "F_L": way * (force + force_zero)}
    return Record(0.01 * np.arange(w.size), channels, "bend.csv")


@given(
    st.floats(1e9, 3e11), st.floats(0.0, 0.05), st.floats(-50.0, 50.0), st.floats(-1e-3, 1e-3),
    st.sampled_from([-1.0, 1.0]), st.integers(1, 3),
)  # fmt: skip
@settings(max_examples=25, deadline=None)
def test_a_clean_record_returns_its_modulus(modulus, friction, force, place, way, cycles):
    """Whatever the offsets, signs and cycles; friction that grows with the load cancels."""
    found = bending(
        a_record(
            slope_of(modulus), cycles=cycles, friction=friction, force_zero=force,
            deflection_zero=place, way=way, toe=1e-6,
        ),
        Specimen(**TUBE),
    )  # fmt: skip
    assert found.modulus.value == pytest.approx(modulus, rel=5e-4)
    assert found.loading / found.unloading == pytest.approx((1 + friction) / (1 - friction), 1e-3)
    assert found.cycles == cycles


def test_the_range_is_that_of_the_standard():
    """Strains 0.0005 to 0.0025 from where the straight line meets zero force."""
    found = bending(a_record(slope_of(6e10), top=0.006, toe=1e-5), Specimen(**TUBE))
    assert found.strains == pytest.approx((0.0005, 0.0025), rel=2e-3)
    assert found.deflections == pytest.approx((0.0005 * STRAIN, 0.0025 * STRAIN), rel=2e-3)


def test_a_short_test_is_read_by_force():
    """A test to strain 0.0008 gives its modulus too, and says where it was taken."""
    found = bending(a_record(slope_of(6e10), top=0.0008, toe=1e-6), Specimen(**TUBE))
    assert found.modulus.value == pytest.approx(6e10, rel=1e-3)
    assert found.strains == pytest.approx((0.00016, 0.00064), rel=0.02)
    assert any("does not cover the usual strains" in one for one in found.doubts)


@pytest.mark.long
@pytest.mark.parametrize(
    ("memory", "cycles"), [(0.0, 1), (0.9, 1), pytest.param(0.97, 3, marks=pytest.mark.long)]
)
def test_bounds_hold_the_slope(memory, cycles):
    """95 % bounds hold the true slope in 90 to 99 % of 200 records, however noise remembers."""
    slope, held = slope_of(6e10), 0
    for seed in range(200):
        record = a_record(slope, cycles=cycles, noise=3.0, memory=memory, seed=seed, friction=0.02)
        found = bending(record, Specimen(**TUBE)).slope
        held += found.lower <= slope <= found.upper
    assert 0.90 <= held / 200 <= 0.99


@pytest.mark.parametrize("degree", [1, 2])
def test_bounds_of_a_term_hold_it_for_few_samples(degree):
    """Twelve samples of white noise about a polynomial: 90 to 100 % of 400 bounds hold."""
    from scipy.stats import t

    rng, x, held = np.random.default_rng(3), np.linspace(0.1, 0.9, 12), 0
    for _ in range(400):
        one = term(x, 2.0 * x**degree + 0.1 * rng.standard_normal(12), degree)
        held += abs(one.value - 2.0) <= t.ppf(0.975, one.freedom) * np.sqrt(one.variance)
    assert held / 400 >= 0.90


def test_a_term_is_the_least_squares_one():
    """Value as of a polynomial fit; white noise gives the variance of that fit on average."""
    rng, x = np.random.default_rng(0), np.linspace(-1.0, 3.0, 200)
    y = 1 + 2 * x + 0.5 * x**2 + 0.01 * rng.standard_normal(200)
    assert term(x, y, 2).value == pytest.approx(np.polyfit(x, y, 2)[0], rel=1e-10)
    variances = [term(x, 0.3 * rng.standard_normal(200), 1).variance for _ in range(300)]
    assert np.mean(variances) == pytest.approx(0.09 / np.sum((x - x.mean()) ** 2), rel=0.25)


@given(st.floats(1e9, 1e11), st.floats(0.0, 3e-6), st.floats(0.0, 5e-7))
@settings(max_examples=20, deadline=None)
def test_shear_and_dents_are_taken_off(modulus, shear, dents):
    """The modulus is that of bending alone; eq. 13 of the whole slope is lower."""
    slope = slope_of(modulus, shear=shear, dents=dents)
    found = bending(
        a_record(slope, toe=1e-6),
        Specimen(**TUBE, shear_compliance=shear, local_compliance=dents),
    )
    whole = slope * SPAN**3 / (48 * SECOND_MOMENT)
    bent = 1 - slope * (SPAN * shear / 4 + dents)
    assert found.as_published.value == pytest.approx(whole, rel=1e-3)
    assert found.modulus.value == pytest.approx(modulus, rel=1e-3 / bent)
    share = 12 * modulus * SECOND_MOMENT * shear / SPAN**2
    assert found.shear_share == pytest.approx(share, rel=1e-3 / bent, abs=1e-12)


def test_shear_of_a_tube_takes_cowpers_coefficient():
    """1/(kappa G A), kappa = 0.5 of a thin tube with nu = 0 (6/12)."""
    thin = Specimen(
        span=0.3, outer_diameter=0.02, inner_diameter=0.02 - 2e-7, shear_modulus=4e9,
        poissons_ratio=0.0,
    )  # fmt: skip
    assert thin.shear == pytest.approx(1 / (0.5 * 4e9 * pi * 0.02 * 1e-7), rel=1e-4)


@pytest.mark.parametrize("span", [0.15, 0.3])
def test_the_published_specimen(span):
    """[ElAsswad2018]: 3.48 GPa by eq. 13; the tube over its strokes. The same back."""
    outer, inner = 0.0286, 0.025
    inertia = pi * (outer**4 - inner**4) / 64
    slope = 48 * 3.48e9 * inertia / span**3
    w = np.concatenate([np.linspace(0, 0.003, 200), np.linspace(0.003, 0, 200)])
    w *= span**2 / (6 * outer)
    record = Record(0.01 * np.arange(400), {"w": w, "F_L": slope * w}, "published.csv")
    found = bending(record, Specimen(span=span, outer_diameter=outer, inner_diameter=inner))
    assert found.slope.value == pytest.approx(slope, rel=1e-9)
    assert found.as_published.value == pytest.approx(3.48e9, rel=1e-9)
    assert found.modulus == found.as_published
    short = any("less than 16" in one for one in found.doubts)
    assert short == (span / outer < 16)
    assert any("no shear modulus" in one for one in found.doubts)


def test_yielding_and_failure_are_left_out():
    """A knee at strain 0.003, then a break: the slope is that before."""
    w = np.linspace(-0.1, 1.0, 2000) * 0.02 * STRAIN
    knee = 0.003 * STRAIN
    force = 4e5 * np.where(w < knee, np.maximum(w, 0), knee + 0.2 * (w - knee))
    force[1500:] = 30.0
    found = bending(Record(w, {"w": w, "F_L": force}, "break.csv"), Specimen(**TUBE))
    assert found.slope.value == pytest.approx(4e5, rel=1e-6)


def test_a_toe_inside_the_range_is_cut_and_said():
    """Supports that settle up to strain 0.001: the slope is taken above."""
    found = bending(a_record(slope_of(6e10), toe=2e-4, top=0.004), Specimen(**TUBE))
    assert found.slope.value == pytest.approx(slope_of(6e10), rel=5e-3)
    assert found.strains[0] > 0.0007
    assert any("not straight" in one for one in found.doubts)


def test_hysteresis_is_work_lost():
    """Friction f F both ways loses 2 f/(1 + f) of the work."""
    found = bending(a_record(slope_of(6e10), friction=0.1, toe=1e-6), Specimen(**TUBE))
    assert found.hysteresis == pytest.approx(2 * 0.1 / 1.1, rel=0.01)
    assert any("steeper than that of unloading" in one for one in found.doubts)


def test_loading_alone_is_said():
    """Without unloading friction cannot be told from stiffness."""
    record = a_record(slope_of(6e10), cycles=1)
    half = {name: one[:300] for name, one in record.channels.items()}
    found = bending(Record(record.time[:300], half, "up.csv"), Specimen(**TUBE))
    assert found.unloading is None
    assert found.hysteresis is None
    assert any("covers loading only" in one for one in found.doubts)


def test_unloading_alone_is_said():
    """From 2 mm to none: unloading, strains from zero force, w = e L^2/(6 D); signs do not matter.

    Half of it, to 1 mm, still counts from zero force: the least strain is that of 1 mm.
    """
    w = np.linspace(2e-3, 0.0, 300)
    for way, size in ((1.0, 300), (-1.0, 300), (1.0, 150)):
        channels = {"w": way * w[:size], "F_L": way * 4e5 * w[:size]}
        found = bending(Record(0.01 * np.arange(size), channels, "down.csv"), Specimen(**TUBE))
        assert found.loading is None
        assert found.unloading == pytest.approx(4e5, rel=1e-9)
        assert found.hysteresis is None
        assert any("covers unloading only" in one for one in found.doubts)
        # the percentile of the force that is taken for zero lies 1 % of the range above it
        top = 2e-3 / STRAIN
        assert found.strains == pytest.approx((0.0005, 0.8 * top), rel=0.02)


def waves(*, phase=0.0, cycles=3, count=200):
    """Deflection of 1 mm both ways."""
    return 1e-3 * np.sin(2 * np.pi * np.linspace(0, cycles, cycles * count + 1) + phase)


@given(
    st.floats(0.0, 2 * pi), st.integers(1, 4), st.integers(100, 400), st.floats(1e4, 1e7),
    st.floats(0.0, 0.2),
)  # fmt: skip
@settings(max_examples=25, deadline=None)
def test_bending_both_ways_loses_what_friction_takes(phase, cycles, count, slope, friction):
    """An elastic bar loses nothing from wherever it begins; friction f F loses 2 f/(1 + f)."""
    w = waves(phase=phase, cycles=cycles, count=count)
    outward = np.sign(np.gradient(w) * w)
    record = Record(
        np.arange(w.size) / 200, {"w": w, "F_L": slope * w * (1 + friction * outward)}, "sine.csv"
    )
    found = bending(record, Specimen(**TUBE))
    assert 0 <= found.hysteresis == pytest.approx(2 * friction / (1 + friction), abs=0.02)
    assert found.slope.value == pytest.approx(slope, rel=0.02)
    assert found.deflections[1] <= 1e-3
    assert any("is bent in both directions" in one for one in found.doubts)


def test_a_loop_that_wins_work_has_no_hysteresis():
    """A force that lags by 0.05 rad wins pi sin(0.05) of 4 (1/2): no share, and the reason."""
    w, force = waves(), 4e5 * waves(phase=-0.05)
    found = bending(Record(np.arange(w.size) / 200, {"w": w, "F_L": force}), Specimen(**TUBE))
    assert found.hysteresis is None
    assert found.to_dict()["hysteresis"] is None
    assert any("hysteresis cannot be determined" in one for one in found.doubts)


def test_a_part_of_a_cycle_counts_over_what_both_pass():
    """Down to 0.3, up again and down to zero: an elastic bar still loses nothing."""
    turns = [(0.0, 1.0), (1.0, 0.3), (0.3, 1.0), (1.0, 0.0)]
    w = 2e-3 * np.concatenate([np.linspace(*one, 90) for one in turns])
    found = bending(Record(np.arange(360.0), {"w": w, "F_L": 4e5 * w}), Specimen(**TUBE))
    assert found.hysteresis == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("share", "words"),
    [(0.07, "7 %"), (0.79, "79 %"), (1.21, "121 %"), (1e-9, "less than 1 %"), (1e3, "1000 %")],
)
def test_a_modulus_far_from_what_the_material_states_is_said(share, words):
    """More than 20 % off 205 GPa: both are named, and part, span and units doubted."""
    specimen = Specimen(**TUBE, expected_modulus=205e9)
    found = bending(a_record(slope_of(share * 205e9), toe=1e-6, force_zero=0.0), specimen)
    (said,) = [one for one in found.doubts if "check part, span and units" in one]
    assert f"{words} of the material's value, 205 GPa" in said


@pytest.mark.parametrize("share", [0.81, 1.0, 1.19, None])
def test_a_modulus_near_what_the_material_states_is_no_doubt(share):
    """Within 20 %, or nothing stated: no word of it."""
    stated = None if share is None else 6e10 / share
    found = bending(a_record(slope_of(6e10)), Specimen(**TUBE, expected_modulus=stated))
    assert not any("material's value" in one for one in found.doubts)


@pytest.mark.parametrize("channel", ["F_L", "w"])
@pytest.mark.parametrize("size", [1e200, 1e150, 1e302, 1e-200, 1e-300])
def test_sizes_of_no_test_are_refused(channel, size):
    """Forces and deflections beyond any machine or sensor: one line, no warning."""
    channels = {
        name: size * CLEAN[name] if name == channel else CLEAN[name] for name in ("w", "F_L")
    }
    with pytest.raises(InputError, match=rf"{channel} spans .*check its unit"):
        bending(Record(CLEAN.time, channels, "huge.csv"), Specimen(**TUBE))


def test_cycles_that_scatter_widen_the_bounds():
    """Three cycles of slopes 4 % apart: Student's t of the cycles, not of their noise."""
    parts = [a_record(slope_of(one), cycles=1, noise=0.5) for one in (5.8e10, 6e10, 6.2e10)]
    joined = {name: np.concatenate([one[name] for one in parts]) for name in ("w", "F_L")}
    record = Record(0.01 * np.arange(joined["w"].size), joined, "three.csv")
    found = bending(record, Specimen(**TUBE)).slope
    one = np.std([slope_of(x) for x in (5.8e10, 6e10, 6.2e10)], ddof=1)
    assert found.standard_error == pytest.approx(one / np.sqrt(3), rel=0.03)


def test_noise_beyond_use_is_no_modulus():
    """Noise of a fifth of the force: bounds without use are not called identifiable."""
    found = bending(
        a_record(slope_of(6e9), samples=60, noise=18.0, memory=0.9, cycles=1), Specimen(**TUBE)
    )
    assert not found.modulus.identifiable
    assert any("identifiable" in one for one in found.doubts)


def test_bounds_without_end():
    """Where the steepest slope leaves nothing for bending, the modulus has no upper bound."""
    slope = slope_of(6e10, dents=2e-5)
    specimen = Specimen(**TUBE, local_compliance=2e-5)
    found = bending(a_record(slope, noise=9.0, cycles=1), specimen)
    assert found.modulus.upper == inf
    plain = found.to_dict()
    assert plain["modulus"]["upper"] is None
    json.dumps(plain, allow_nan=False)


def test_spikes_and_missing_samples():
    """Single wild samples in either channel, and lost ones, move nothing."""
    record = a_record(slope_of(6e10))
    w, force = record["w"].copy(), record["F_L"].copy()
    w[::50] += 0.01
    force[7::60] -= 500.0
    force[3::40] = np.nan
    found = bending(Record(record.time, {"w": w, "F_L": force}, "spikes.csv"), Specimen(**TUBE))
    assert found.slope.value == pytest.approx(slope_of(6e10), rel=2e-3)


def test_a_file_is_read():
    """A CSV with units, as a machine writes it."""
    lines = ["time [s],deflection [mm],force [N]"]
    lines += [f"{0.1 * k:.2f},{0.1 * k:.4f},{40.0 * k:.3f}" for k in range(31)]
    found = bending(parse_record("\n".join(lines), name="t.csv"), Specimen(**TUBE))
    assert found.slope.value == pytest.approx(400e3, rel=1e-9)


CLEAN = a_record(4e5)


@pytest.mark.parametrize(
    ("channels", "words"),
    [
        ({"w": CLEAN["w"]}, "no column F_L"),
        ({"F_L": CLEAN["F_L"]}, "no column w"),
        ({"w": 0 * CLEAN["w"], "F_L": CLEAN["F_L"]}, "w is constant"),
        ({"w": CLEAN["w"], "F_L": 0 * CLEAN["w"]}, "F_L is constant"),
        ({"w": CLEAN["w"], "F_L": -CLEAN["F_L"]}, "F_L decreases as w increases"),
        ({"w": CLEAN["w"], "F_L": np.sin(np.arange(1200.0))}, "does not follow"),
        ({"w": np.eye(1, 1200, 5)[0], "F_L": CLEAN["F_L"]}, "w is constant"),
        ({"w": CLEAN["w"][:6], "F_L": CLEAN["F_L"][:6]}, "6 samples"),
        ({"w": CLEAN["w"][::60], "F_L": CLEAN["F_L"][::60]}, "straight part"),
        ({"w": np.full(50, np.nan), "F_L": np.ones(50)}, "0 samples"),
    ],
)
def test_faults_are_one_line(channels, words):
    """A record that cannot be used says why, in one line with its file and a remedy."""
    size = next(iter(channels.values())).size
    with pytest.raises(InputError) as caught:
        bending(Record(0.01 * np.arange(size), channels, "bad.csv"), Specimen(**TUBE))
    (one,) = caught.value.diagnostics
    assert one.file == "bad.csv"
    assert words in one.message
    assert one.remedy
    assert "\n" not in str(one)


def test_give_beyond_what_is_measured_is_refused():
    """A local compliance above the whole deflection leaves no bending."""
    with pytest.raises(InputError, match="shear and indentation alone"):
        bending(CLEAN, Specimen(**TUBE, local_compliance=3e-6))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"span": 0.0}, "span is 0"),
        ({"span": float("nan")}, "span is nan"),
        ({"expected_modulus": -2e11}, "expected_modulus is -2e"),
        ({"inner_diameter": OUTER}, "leaves no material"),
        ({"outer_diameter": None}, "section is not known"),
        ({"second_moment": 1e-9}, "stated twice"),
        ({"shear_modulus": 4e9, "shear_compliance": 1e-6}, "shear_modulus needs"),
        ({"local_compliance": -1e-7}, "must not be below 0"),
    ],
)
def test_no_specimen(changed, words):
    """What is no specimen is refused in one line."""
    with pytest.raises(InputError, match=words):
        Specimen(**(TUBE | changed))


def test_branches_turn_at_the_ends():
    """A triangle has as many branches as sides; small ways back are none."""
    w = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0.2, 40), np.linspace(0.2, 1, 30)])
    found = branches(w + 0.05 * np.sin(np.arange(120.0)), 0.25)
    assert [one.loading for one in found] == [True, False, True]


def test_ends_of_a_coarse_record_are_no_spikes():
    """A straight line of few samples is kept whole, its ends too."""
    assert np.isfinite(despiked(np.linspace(0.0, 1.0, 8))).all()
