"""Estimates against closed forms: intervals that cover, known indices, exact yields."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scatter_case as case
from hypothesis import given, strategies as st
from scipy.stats import binom, norm

import actuator_opt as ao
from actuator_opt.design.uncertain import REACH
from actuator_opt.models.elastomer import modulus_gent, modulus_ruess
from actuator_opt.uncertainties import estimate
from actuator_opt.uncertainties.estimate import about
from actuator_opt.uncertainties.inputs import UncertainModel, inputs, without_drawn_basis
from actuator_opt.uncertainties.study import draw

WIDE = (-math.inf, math.inf)


# ---- probabilities ----


@pytest.mark.parametrize("rate", [0.003, 0.05, 0.5, 0.9, 0.99])
def test_exact_bounds_cover_at_least_as_often_as_they_say(rate):
    """Summed over every possible count of 60 draws, the bounds hold the truth 95 % or more."""
    covered = 0.0
    for hits in range(61):
        bounds = estimate.exact(hits, 60)
        if bounds.lower <= rate <= bounds.upper:
            covered += binom.pmf(hits, 60, rate)
    assert 0.95 <= covered <= 1.0


def test_exact_bounds_at_the_ends():
    """No miss in n draws: lower bound (0.025)^(1/n), upper bound 1; and the mirror of it."""
    bounds = estimate.exact(50, 50)
    assert (bounds.value, bounds.upper) == (1.0, 1.0)
    assert bounds.lower == pytest.approx(0.025 ** (1 / 50), rel=1e-12)
    assert estimate.exact(0, 50).upper == pytest.approx(1 - bounds.lower, rel=1e-12)


def test_bounds_of_quasi_random_points_cover():
    """P(x + y + z < 1) = 1/6: bounds from 16 randomisations hold it for 9 of 10 seeds or more."""
    covered, widths = 0, []
    for seed in range(80):
        hits = [(estimate.quasi(3, 6, (seed, block)).sum(axis=0) < 1).sum() for block in range(16)]
        bounds = estimate.replicated(np.array(hits), 64)
        covered += bounds.lower <= 1 / 6 <= bounds.upper
        widths.append(bounds.upper - bounds.lower)
    independent = estimate.exact(round(1024 / 6), 1024)
    assert covered >= 70  # 95 % of 80 is 76, less three standard deviations
    assert np.mean(widths) < 0.6 * (independent.upper - independent.lower)


def test_few_misses_do_not_make_replicates_look_certain():
    """Sixteen replicates that all hold are no proof: the bounds are those of single draws."""
    assert estimate.replicated(np.full(16, 64.0), 64) == estimate.exact(1024, 1024)


# ---- indices ----


def ishigami(points):
    """Ishigami: sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 on (-pi, pi)^3 [Ishigami1990]."""
    x = math.pi * (2 * points - 1)
    return (np.sin(x[0]) + 7 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0]))[None]


def test_indices_of_ishigami():
    """Its variances in closed form: V1 = (1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = 8 b^2 pi^8/225."""
    a, b, pi = 7.0, 0.1, math.pi
    first = np.array([(1 + b * pi**4 / 5) ** 2 / 2, a * a / 8, 0.0])
    joint = 8 * b * b * pi**8 / 225
    variance = first.sum() + joint
    total = first + np.array([joint, 0.0, joint])
    found = estimate.indices(ishigami, 3, rows=16384, seed=0)
    assert found.variance[0] == pytest.approx(variance, rel=0.01)
    for value, half, exact in (
        (found.first, found.first_half, first / variance),
        (found.total, found.total_half, total / variance),
    ):
        assert value[:, 0] == pytest.approx(exact, abs=0.01)
        assert (half[:, 0] < 0.02).all()


def test_indices_of_the_g_function():
    """Sobol's product: V_i = 1/(3 (1 + a_i)^2), total V_i prod_{j != i} (1 + V_j)."""
    a = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0])[:, None]

    def product(points):
        return (((np.abs(4 * points - 2) + a) / (1 + a)).prod(axis=0))[None]

    part = 1 / (3 * (1 + a[:, 0]) ** 2)
    variance = (1 + part).prod() - 1
    total = part * (1 + part).prod() / (1 + part) / variance
    found = estimate.indices(product, 6, rows=8192, seed=1)
    assert found.first[:, 0] == pytest.approx(part / variance, abs=0.02)
    assert found.total[:, 0] == pytest.approx(total, abs=0.02)


def test_bounds_of_indices_cover():
    """For 3 x + 4 y + x y, by hand: the bounds hold the shares for most of 40 seeds."""
    covered = np.zeros(2)
    for seed in range(40):
        found = estimate.indices(
            lambda points: (3 * points[0] + 4 * points[1] + points[0] * points[1])[None],
            2, rows=128, seed=seed,
        )  # fmt: skip
        ex, ey = 3 + 0.5, 4 + 0.5  # slopes of the conditional means, E = 1/2
        parts = np.array([ex * ex, ey * ey]) / 12
        variance = parts.sum() + 1 / 144
        covered += np.abs(found.first[:, 0] - parts / variance) <= found.first_half[:, 0]
    assert (covered >= 33).all()  # 38 expected, less three standard deviations


def test_an_output_that_does_not_vary_has_no_indices():
    """A constant has no variance to share; neither has rounding noise about one."""
    found = estimate.indices(lambda p: np.stack([0 * p[0] + 3, 1e9 + 0 * p[0]]), 2, rows=64, seed=0)
    assert np.isnan(found.first).all()
    assert np.isnan(found.total).all()


# ---- distributions ----


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_quantiles_grow_and_stay_within(one, other):
    """Every distribution is monotone in the share, within its bounds."""
    for shape, stated in (
        ("normal", {"cv": 0.1}), ("lognormal", {"factor": 2.0}), ("uniform", {"half_width": 1.0}),
        ("loguniform", {"factor": 3.0}), ("triangular", {"lower": 1.0, "upper": 9.0}),
    ):  # fmt: skip
        drawn = about(shape, stated, 4.0, WIDE)
        low, high = drawn.at(np.array(sorted([one, other])))
        assert drawn.low <= low <= high <= drawn.high


def test_quantiles_against_closed_forms():
    """Normal: mean + z s; lognormal: 95 % within the factor; triangular: moments of the shape."""
    tail = norm.cdf(-REACH)
    share = np.array([0.05, 0.5, 0.95])
    exact = 10 + 2 * norm.ppf(tail + share * (1 - 2 * tail))
    assert about("normal", {"deviation": 2.0}, 10.0, WIDE).at(share) == pytest.approx(exact)
    ends = about("lognormal", {"factor": 1.5}, 6.0, WIDE).at(np.array([0.025, 0.975]))
    assert ends == pytest.approx([4.0, 9.0], rel=1e-4)
    shares = (np.arange(200_000) + 0.5) / 200_000
    drawn = about("triangular", {"lower": 0.0, "upper": 6.0}, 1.0, WIDE).at(shares)
    assert drawn.mean() == pytest.approx((0 + 1 + 6) / 3, rel=1e-6)
    assert drawn.var() == pytest.approx((0 + 1 + 36 - 0 - 0 - 6) / 18, rel=1e-4)


# ---- a design ----


def sum_of_diameters(margin):
    """A constraint that is linear in bore and rod diameter (mm)."""

    @ao.constraint("room", label="room beside bore and rod")
    def room(design):
        return margin - 1e3 * (design["cylinder.bore"] + design["rod.outer_diameter"])

    return room


DIAMETERS = {
    "cylinder.bore": {"distribution": "normal", "deviation": "0.3 mm"},
    "rod.outer_diameter": {"distribution": "normal", "deviation": "0.4 mm"},
}


@pytest.mark.parametrize(
    ("quasi", "room"),
    [(False, 36.0), (True, 36.5), pytest.param(False, 37.0, marks=pytest.mark.long)],
)
def test_yield_of_a_linear_margin(room, quasi):
    """Sum of two normals: mean 36 mm, deviation 0.5 mm, so the yield is Phi((room - 36)/0.5)."""
    actuator = ao.read(case.only(DIAMETERS), plugins=[sum_of_diameters(room)])
    found = ao.uncertainty(actuator, count=2000, rows=256, quasi_random=quasi, seed=3)
    exact = norm.cdf((room - 36) / 0.5)
    assert found.rate.lower <= exact <= found.rate.upper
    assert found.required[0].name == "room"
    assert [one.path for one in found.inputs] == sorted(DIAMETERS)
    ranked, swings = found.of_output("room")
    shares = {one.path: one.first for one in ranked}
    assert shares["cylinder.bore"] == pytest.approx(9 / 25, abs=0.05)
    assert shares["rod.outer_diameter"] == pytest.approx(16 / 25, abs=0.05)
    assert swings[0].path == "rod.outer_diameter"
    assert swings[0].at_5 - swings[0].at_95 == pytest.approx(2 * 1.644854 * 0.4, rel=1e-3)
    assert found.nominal["room"] == pytest.approx(room - 36, abs=1e-9)


@pytest.mark.long
def test_yield_covers_for_repeated_seeds():
    """The exact bounds hold the exact yield for nearly all of 40 seeds."""
    actuator = ao.read(case.only(DIAMETERS), plugins=[sum_of_diameters(36.4)])
    subject = actuator.subject()
    model = UncertainModel(subject, inputs(subject))
    exact = norm.cdf(0.8)
    held = 0
    for seed in range(40):
        rate = draw(model, 100, seed).rates()[-2]
        held += rate.lower <= exact <= rate.upper
    assert held >= 34


def test_without_scatter_the_yield_is_the_verdict():
    """Nothing scatters: every draw is the design itself, no indices, no tornado."""
    for room, rate in ((36.1, 1.0), (35.9, 0.0)):
        actuator = ao.read(case.only({}), plugins=[sum_of_diameters(room)])
        found = ao.uncertainty(actuator, count=50)
        assert (found.rate.value, found.met) == (rate, rate == 1.0)
        assert (found.inputs, found.indices, found.swings) == ((), (), ())
        assert any("no input is uncertain" in words for words in found.notes)


@pytest.mark.long
def test_same_seed_same_result():
    """The seed fixes everything; another seed draws anew."""

    def result(seed, **more):
        data = ao.uncertainty(case.KNEE, count=500, rows=64, seed=seed, **more).to_dict()
        del data["seconds"]
        return data

    assert result(5) == result(5)
    assert result(5) != result(6)
    assert result(5, quasi_random=True) == result(5, quasi_random=True)


def test_more_draws_than_are_kept_are_counted():
    """Counts run over all draws; what is kept for quantiles is bounded."""
    actuator = ao.read(case.only(DIAMETERS), plugins=[sum_of_diameters(36.5)])
    subject = actuator.subject()
    model = UncertainModel(subject, inputs(subject))
    tally = draw(model, 5000, 0, keep=1000)
    assert tally.per_block == 5000
    assert tally.kept.margins.shape[1] == tally.kept.values.shape[1] == 1000
    own = list(model.own).index(True)
    assert tally.hits[own].sum() <= 5000


# ---- what scatters ----


def found_inputs(text=case.KNEE):
    """Inputs of a design by PATH."""
    return {one.path: one for one in inputs(ao.read(text).subject())}


def test_libraries_say_what_scatters():
    """A CV is normal, a tolerance uniform, a factor uniform in the logarithm."""
    found = found_inputs()
    fibre = found["materials.t700_epoxy.youngs_modulus_1"].distribution
    assert (fibre.shape, fibre.deviation) == ("normal", pytest.approx(0.03 * 135e9))
    hardness = found["materials.nbr_90.hardness"].distribution
    assert (hardness.shape, hardness.low, hardness.high) == ("uniform", 85.0, 95.0)
    friction = found["seals.rod.friction_coefficient"].distribution
    assert (friction.shape, friction.low, friction.high) == ("loguniform", 0.05, 0.2)


def test_hardness_to_modulus_scatters_between_its_laws():
    """From Gent's modulus, which the ring uses, to that of Ruess: 1.8 times as much at 70."""
    text = case.KNEE.replace("compound: nbr_90", "compound: nbr_70")
    drawn = found_inputs(text)["materials.nbr_70.hardness_modulus_factor"].distribution
    ratio = float(modulus_ruess(hardness=70.0) / modulus_gent(hardness=70.0))
    assert (drawn.shape, drawn.low, drawn.high) == ("loguniform", 1.0, pytest.approx(ratio))
    assert ratio == pytest.approx(1.83, abs=0.01)


def test_a_modulus_factor_scales_the_contact():
    """Friction of an O-ring alone, no pressure on it: preload is in proportion to the modulus."""
    base, twice = (
        ao.evaluate(ao.read(case.KNEE, set={"materials.nbr_90.hardness_modulus_factor": x}))
        for x in ("1", "2")
    )
    plain = ao.evaluate(ao.read(case.KNEE))
    name = "friction_running"
    assert base.metrics[name].value == plain.metrics[name].value
    assert twice.metrics[name].value > base.metrics[name].value


def test_measured_bounds_replace_the_library():
    """95 % bounds of a record are a normal distribution of that width."""
    path = "seals.rod.friction_coefficient"
    said = f"\nmeasured:\n  {path}:\n    lower: 0.09\n    upper: 0.11\n    record: bench.csv\n"
    one = found_inputs(case.KNEE + said)[path]
    assert one.origin == "measured"
    assert one.distribution.deviation == pytest.approx(0.01 / 1.959964)


def test_strengths_stand_at_their_allowables_unless_stated():
    """Drawn by default: none. Stated: drawn without the knock-down of the basis, once."""
    path = "materials.t700_epoxy.strength_1_tension"
    assert not any("strength" in one for one in found_inputs())
    stated = {path: {"distribution": "normal", "cv": "5 %"}}
    subject = ao.read(case.block(stated)).subject()
    found = inputs(subject)
    assert path in {one.path for one in found}
    changed = without_drawn_basis(subject, found)
    knocked = subject.numbers["materials.t700_epoxy.basis_knockdown"]
    for (name, key, cold), factor in subject.factors.items():
        own = f"materials.{name}.{key}" == path
        exact = factor / knocked if own else factor
        assert changed.factors[name, key, cold] == pytest.approx(exact, rel=1e-14)
    notes = ao.uncertainty(ao.read(case.block(stated)), count=20, rows=0).notes
    assert any("the knock-down for their statistical basis" in words for words in notes)


def test_what_is_taken_at_its_worst_is_not_drawn_twice():
    """Sections and gland depths are not drawn; who states one is told of its tolerance."""
    assert not any(one.endswith((".section", ".squeeze", "tolerance")) for one in found_inputs())
    text = case.block({"seals.rod.squeeze": {"distribution": "normal", "deviation": "0.5 %"}})
    notes = ao.uncertainty(ao.read(text), count=20, rows=0).notes
    assert any(
        "seals.rod.tolerance, at its worst value, already covers the same scatter" in words
        for words in notes
    )
