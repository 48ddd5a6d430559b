"""Bounds by resampling: they hold the truth, agree with theory where it holds, repeat by seed."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest
from identification_case import sine
from scipy.optimize import least_squares

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.base.fitting import FitSearch, relaxed
from actuator_opt.identification import synthetic
from actuator_opt.identification.bootstrap import (
    LuGreResiduals,
    resampled,
    resampled_stribeck,
    searched,
)
from actuator_opt.identification.identify import identify
from actuator_opt.identification.points import FrictionPoint
from actuator_opt.identification.stribeck_fit import fit_stribeck
from actuator_opt.identification.windows import windows
from actuator_opt.studies.bench import bench

KNEE = Path(__file__).parents[2] / "designs" / "knee_bonded.yaml"
AREA = 1e-3
TRUTH = {
    "coulomb": 150.0, "static": 300.0, "stribeck_speed": 4e-3, "exponent": 2.0,
    "viscous": 200.0, "offset": 5.0,
}  # fmt: skip


def friction(velocity, truth):
    """The curve, written again."""
    speed = abs(velocity)
    rise = (truth["static"] - truth["coulomb"]) * np.exp(
        -((speed / truth["stribeck_speed"]) ** truth["exponent"])
    )
    way = np.sign(velocity)
    return way * (truth["coulomb"] + rise + truth["viscous"] * speed) + truth["offset"]


def points_of(rng, speeds, *, error, truth=TRUTH, uneven=0.0):
    """Points both ways; errors up to `uneven` times larger, as stated of each."""
    found = []
    for velocity in [*speeds, *(-one for one in speeds)]:
        own = error * (1 + uneven * rng.random())
        force = friction(velocity, truth) + own * rng.standard_normal()
        found.append(FrictionPoint(velocity, 1e6, 1e6, 0.0, force, own, 1.0, "plateau"))
    return found


def bootstrapped(points, *, count=200, seed=0):
    """The linearised fit, and the same with resampled bounds."""
    fit = fit_stribeck(points, AREA)
    return fit, resampled_stribeck(points, fit, count=count, rng=np.random.default_rng(seed))


@pytest.mark.long
def test_bounds_hold_the_truth():
    """95 % bounds hold the true parameters in 90 to 99 % of 100 sets of 16 uneven points.

    Eight speeds: with fewer than seven the exponent is held and bounds allow for another one.
    """
    speeds, held = np.geomspace(5e-4, 0.1, 8), {}
    for seed in range(100):
        rng = np.random.default_rng(seed)
        points = points_of(rng, speeds, error=2.0, uneven=2.0)
        _, found = bootstrapped(points, count=80, seed=seed)
        for name, one in found.parameters.items():
            held.setdefault(name, []).append(one.lower <= TRUTH[name] <= one.upper)
    assert {"coulomb", "static", "stribeck_speed", "viscous", "offset"} <= set(held)
    for name, each in held.items():
        assert 0.90 <= np.mean(each) <= 0.99, name


@pytest.mark.long
def test_a_well_posed_case_agrees_with_the_linearised_model():
    """Forty points of small equal errors: bounds within a quarter of the linearised ones."""
    points = points_of(np.random.default_rng(4), np.geomspace(5e-4, 0.2, 20), error=0.5)
    fit, found = bootstrapped(points, count=1500)
    assert set(found.parameters) == set(TRUTH)
    for name, one in found.parameters.items():
        was = fit.parameters[name]
        assert one.value == was.value
        assert one.upper - one.lower == pytest.approx(was.upper - was.lower, rel=0.25), name
        assert one.standard_error == pytest.approx(was.standard_error, rel=0.25), name
        assert one.verdict == was.verdict, name


def test_a_linear_model_gives_students_t():
    """Without a Stribeck part the model is linear: few spare points give Student's bounds."""
    truth = TRUTH | {"static": TRUTH["coulomb"]}
    ratios = []
    for seed in range(40):
        points = points_of(np.random.default_rng(seed), [0.02, 0.1, 0.2], error=1.0, truth=truth)
        fit, found = bootstrapped(points, count=400, seed=seed)
        assert set(fit.parameters) == {"coulomb", "viscous", "offset"}
        was, one = fit.parameters["viscous"], found.parameters["viscous"]
        ratios.append((one.upper - one.lower) / (was.upper - was.lower))
    assert np.median(ratios) == pytest.approx(1.0, abs=0.15)


def test_seed_decides():
    """The same seed gives the same bounds, another one others close by."""
    points = points_of(np.random.default_rng(1), np.geomspace(5e-4, 0.2, 11), error=2.0)
    _, first = bootstrapped(points, seed=5)
    _, again = bootstrapped(points, seed=5)
    _, other = bootstrapped(points, seed=6)
    assert first.parameters == again.parameters
    assert first.parameters != other.parameters
    for name, one in first.parameters.items():
        half = (one.upper - one.lower) / 2
        assert other.parameters[name].upper == pytest.approx(one.upper, abs=0.5 * half), name


@pytest.mark.long
def test_what_is_not_identifiable_stays_so():
    """Points above the Stribeck speed alone: F_S, v_s stay unknown, F_C and sigma_2 known."""
    seen = 0
    for seed in range(4):
        rng = np.random.default_rng(seed)
        fit, found = bootstrapped(points_of(rng, np.geomspace(6e-3, 0.2, 10), error=0.2), seed=seed)
        assert found.parameters["coulomb"].identifiable
        assert found.parameters["viscous"].identifiable
        for name, one in found.parameters.items():
            was = fit.parameters[name]
            if was.verdict == "not identifiable":
                seen += name == "static"
                assert not one.identifiable, name
                assert one.lower <= was.lower or name == "offset", name
    assert seen


def test_open_parameters_stay_open():
    """A parameter without any bound keeps none, whatever the draws."""
    points = points_of(np.random.default_rng(1), np.geomspace(5e-4, 0.2, 11), error=2.0)
    fit = fit_stribeck(points, AREA)
    loose = fit.parameters["exponent"]._replace(
        lower=-inf, upper=inf, standard_error=inf, identifiable=False
    )
    fit = replace(fit, parameters={**fit.parameters, "exponent": loose})
    found = resampled_stribeck(points, fit, count=100, rng=np.random.default_rng(0))
    assert found.parameters["exponent"] == loose
    assert found.parameters["coulomb"].upper < inf


def test_draws_at_an_end_of_the_search_are_no_bound():
    """An exponent whose draws run to 2.5, where the search ends, has no upper bound."""
    truth = TRUTH | {"exponent": 2.45}
    points = points_of(
        np.random.default_rng(2), np.geomspace(5e-4, 0.1, 10), error=6.0, truth=truth
    )
    fit = fit_stribeck(points, AREA)
    if "exponent" not in fit.parameters:
        pytest.fail("the case must ask for the exponent")
    found = resampled_stribeck(points, fit, count=200, rng=np.random.default_rng(0))
    assert found.parameters["exponent"].upper == inf
    assert not found.parameters["exponent"].identifiable


def test_many_fits_are_those_of_one():
    """Exponential decays, fitted at once within ends, meet scipy's bounded optimum one by one."""
    rng, t = np.random.default_rng(0), np.linspace(0.0, 1.0, 15)
    low, high = np.array([0.0, 0.5]), np.array([np.inf, 3.0])
    rates = rng.uniform(0.2, 4.0, 20)
    data = 2.0 * np.exp(-rates[:, None] * t) + 0.05 * rng.standard_normal((20, 15))

    def model(x):
        return x[:, :1] * np.exp(-x[:, 1:] * t)

    def slopes(x):
        decay = np.exp(-x[:, 1:] * t)
        return np.stack([decay, -x[:, :1] * t * decay], axis=-1)

    found, cost = relaxed(
        lambda x, at: model(x) - data[at],
        slopes,
        np.tile([1.0, 1.0], (20, 1)),
        FitSearch(("a", "b"), low, high),
        60,
    )
    for one, value, mine in zip(data, cost, found, strict=True):
        best = least_squares(
            lambda x, one=one: model(x[None])[0] - one, [1.0, 1.0], bounds=(low, high), xtol=1e-12
        )
        assert value == pytest.approx(2 * best.cost, rel=1e-5)
        assert mine == pytest.approx(best.x, rel=3e-3)


@pytest.fixture(scope="module")
def measured():
    """Twenty seconds of a sine with known friction, identified."""
    test = bench(ao.read(KNEE).subject())
    truth = synthetic.Truth(150.0, 300.0, 4e-3, 2.0, 200.0, 5e6, 1e3)
    course = sine(amplitude=0.04, frequency=0.2, periods=4, middle=0.055)
    force = synthetic.friction_along(truth, course, 0 * course.time)
    record = synthetic.record(test, course, force, mass=test.mass, sensors=synthetic.Sensors())
    return identify(record, test)


def run(found, **changed):
    """Both models resampled."""
    return resampled(
        found.slidings, found.motion, found.points, found.stribeck, found.lugre,
        **({"count": 100, "seed": 0} | changed),
    )  # fmt: skip


def test_lugre_bounds_surround_its_values(measured):
    """Values stay; bounds lie about them, as wide as the linearised ones within a factor of 3."""
    _, lugre = run(measured)
    assert "bristle_stiffness" in lugre.parameters
    for name, one in lugre.parameters.items():
        was = measured.lugre.parameters[name]
        assert one.value == was.value
        assert one.lower <= one.value <= one.upper
        if was.identifiable:
            ratio = (one.upper - one.lower) / (was.upper - was.lower)
            assert 1 / 3 < ratio < 3, name
    stiffness = lugre.parameters["bristle_stiffness"]
    assert stiffness.lower < 5e6 * 1.03
    assert stiffness.upper > 5e6 * 0.97


def test_what_is_resampled_is_what_was_fitted(measured):
    """The fit's values are the optimum of what is drawn, as near as the fit goes: 0.2 errors."""
    fit, stribeck = measured.lugre, measured.stribeck
    slowest = min(one.speed for one in measured.points)
    found = windows(measured.slidings, measured.motion, stribeck.reference_pressure, slowest)
    problem = LuGreResiduals(found, measured.points, stribeck, fit)
    best = searched(tuple(fit.parameters), fit.values)
    rest, slopes = problem.misfit(best[None])[0], problem.slopes(best)
    step, *_ = np.linalg.lstsq(slopes, rest, rcond=None)
    error = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
    assert np.max(np.abs(step) / error) < 0.2


def test_both_models_repeat_by_seed(measured):
    """Bounds of both come from one seed; neither changes with the other's presence."""
    stribeck, lugre = run(measured)
    again = run(measured)
    assert again[0].parameters == stribeck.parameters
    assert again[1].parameters == lugre.parameters
    assert run(measured, seed=1)[1].parameters != lugre.parameters
    alone = run(replace(measured, lugre="no reversals"))
    assert alone[1] == "no reversals"
    assert alone[0].parameters == stribeck.parameters


def test_few_windows_keep_the_linearised_bounds(measured):
    """One piece cut to a single reversal has no blocks to draw: said, not guessed."""
    piece = measured.slidings[0].piece
    short = replace(
        piece,
        time=piece.time[:1500],
        channels={name: one[:1500] for name, one in piece.channels.items()},
        velocity=piece.velocity[:1500],
        acceleration=piece.acceleration[:1500],
        sound=piece.sound[:1500],
    )
    sliding = measured.slidings[0]
    cut = replace(
        sliding,
        piece=short,
        **{name: getattr(sliding, name)[:1500] for name in ("hydraulic", "resisting", "pressure")},
    )
    _, lugre = run(replace(measured, slidings=(cut,)))
    assert lugre.parameters == measured.lugre.parameters
    assert any("too few to resample" in one for one in lugre.doubts)


def test_too_few_resamples_are_refused(measured):
    """Fewer resamples than have a tail of 2.5 % are one line."""
    with pytest.raises(InputError, match=r"are too few to find the outer 2\.5 %"):
        run(measured, count=20)
