"""The infeasibility card: smallest joint relaxation, sole repairs, binding bounds."""

from dataclasses import replace

import numpy as np
import problems
import pytest

from actuator_opt.optimisation.infeasibility import explain
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.solution import Outcome
from actuator_opt.optimisation.solver import solve


def box(margins, names, *, relaxable=None, low=0.1, high=10.0):
    """Return a problem in two variables that minimises their sum."""

    def evaluate(x):
        return PointValues(x[0] + x[1], np.stack(margins(*x)))

    return BoxProblem(
        ("a", "b"), np.full(2, low), np.full(2, high), evaluate, names, relaxable=relaxable
    )


def explained(problem):
    """Return the explanation from the points that a failed solve ended on."""
    found = solve(problem, samples=1024)
    assert found.outcome is Outcome.INFEASIBLE
    return explain(problem, [o.x for o in found.optima])


def test_product_against_two_limits():
    """With a b >= 12, a <= 2, b <= 4: giving up 1/3 of the product is the smallest repair.

    With a = 2 (1 + s), b = 4 (1 + t): 8 (1 + s)(1 + t) = 12 (1 - u). Alone: u = 1/3, s = 1/2,
    t = 1/2. The joint sum is smallest at u = 1/3: du/ds = -2/3 there, less than 1 per 1.
    """
    card = explained(
        box(lambda a, b: [a * b / 12 - 1, 1 - a / 2, 1 - b / 4], ("product", "a max", "b max"))
    )
    assert [r.constraint for r in card.joint] == ["product"]
    assert card.joint[0].amount == pytest.approx(1 / 3, abs=1e-7)
    assert card.total == pytest.approx(1 / 3, abs=1e-7)
    alone = {r.constraint: r.amount for r in card.sole}
    assert alone == pytest.approx({"product": 1 / 3, "a max": 0.5, "b max": 0.5}, abs=1e-6)
    assert card.residual <= 1e-6
    assert card.laws == ()
    np.testing.assert_allclose(card.x, [2, 4], rtol=1e-6)


def test_a_requirement_that_cannot_repair_alone():
    """Two separate conflicts: no requirement alone is enough, and each is said so."""
    card = explained(
        box(
            lambda a, b: [a / 5 - 1, 1 - a / 4, b / 5 - 1, 1 - b / 2],
            ("a min", "a max", "b min", "b max"),
        )
    )
    # a: giving up s of a >= 5 (1 - s) costs 0.2, of a <= 4 (1 + s) costs 0.25; b: 0.6 or 1.5
    assert {r.constraint: r.amount for r in card.joint} == pytest.approx(
        {"a min": 0.2, "b min": 0.6}, abs=1e-6
    )
    assert [r.constraint for r in card.joint] == ["b min", "a min"]
    assert all(r.amount is None for r in card.sole)


def test_laws_are_never_relaxed():
    """A geometric law stays; only the wish gives way."""
    names = ("wish", "law")
    margins = lambda a, b: [a / b - 3, 1 - a / b]  # noqa: E731
    card = explained(box(margins, names, relaxable=(True, False)))
    assert [(r.constraint, pytest.approx(r.amount)) for r in card.joint] == [("wish", 2.0)]
    assert [r.constraint for r in card.sole] == ["wish"]


def test_conflicting_laws_are_named():
    """Where the laws themselves exclude each other, they are named and nothing is relaxed."""
    card = explained(
        box(
            lambda a, b: [a / 5 - 1, 1 - a / 4, b - 1],
            ("one", "other", "wish"),
            relaxable=(False, False, True),
        )
    )
    assert set(card.laws) <= {"one", "other"}
    assert card.laws
    assert card.joint == ()


def test_binding_bound_is_named_with_its_gain():
    """With a b >= 200 in the box up to 10: both upper bounds bind.

    The product reaches 100, so half is missing; widening one bound by 1 % gains 0.5 % of the
    limit.
    """
    card = explained(box(lambda a, b: [a * b / 200 - 1], ("product",)))
    assert card.joint[0].amount == pytest.approx(0.5, abs=1e-7)
    assert {(b.variable, b.side, b.value) for b in card.bounds} == {
        ("a", "upper", 10.0),
        ("b", "upper", 10.0),
    }
    assert card.bounds[0].gain == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize("lack", [1e-1, 1e-2, 1e-3, 1e-4, 2e-5])
def test_sole_repairs_do_not_depend_on_how_little_is_missed(lack):
    """With a b >= 8 (1 + lack), a <= 2, b <= 4 each limit alone repairs it, and by how much.

    By the product: 1 - 1/(1 + lack); by a or by b: lack, since the other stays at its limit.
    """
    card = explained(
        box(
            lambda a, b: [a * b / (8 * (1 + lack)) - 1, 1 - a / 2, 1 - b / 4, a / 0.5 - 1],
            ("product", "a max", "b max", "idle"),
        )
    )
    alone = {r.constraint: r.amount for r in card.sole}
    expected = {"product": lack / (1 + lack), "a max": lack, "b max": lack}
    assert alone == pytest.approx(expected, rel=1e-3, abs=1e-8)


def test_one_bound_alone():
    """With a b >= 120 in the box up to 10, either bound opened to 12 is enough; none for 300."""
    card = explained(box(lambda a, b: [a * b / 120 - 1], ("product",)))
    assert {(b.variable, b.side): b.needed for b in card.bounds} == pytest.approx(
        {("a", "upper"): 12.0, ("b", "upper"): 12.0}, rel=1e-6
    )
    card = explained(box(lambda a, b: [a * b / 300 - 1], ("product",)))
    assert [b.needed for b in card.bounds] == [None, None]


def test_one_lower_bound_alone():
    """With a b <= 0.008 in the box from 0.1: the lower bound of either to 0.08."""
    card = explained(box(lambda a, b: [1 - a * b / 0.008], ("product",)))
    assert card.joint[0].amount == pytest.approx(0.25, abs=1e-6)
    assert {(b.variable, b.side): b.needed for b in card.bounds} == pytest.approx(
        {("a", "lower"): 0.08, ("b", "lower"): 0.08}, rel=1e-6
    )


def test_the_gain_of_a_bound_is_what_opening_it_saves():
    """Solved again with the bound 0.1 % further out, the relaxation falls by 0.001 x gain."""
    problem = box(lambda a, b: [a * b**2 / 2000 - 1, 1 - a / 9], ("product", "a max"))
    before = explained(problem)
    (bound,) = before.bounds
    assert (bound.variable, bound.side) == ("b", "upper")
    wider = problem.upper.copy()
    wider[bound.index] *= 1.001
    after = explained(replace(problem, upper=wider))
    assert before.total - after.total == pytest.approx(0.001 * bound.gain, rel=5e-3)


def test_rows_of_one_limit_give_way_together():
    """A limit that holds in two cases is relaxed once, by its worse case."""
    problem = box(
        lambda a, b: [a * b / 12 - 1, a * b / 16 - 1, 1 - a / 2, 1 - b / 4],
        ("case 1", "case 2", "a max", "b max"),
    )
    card = explained(replace(problem, groups=(0, 0, 1, 2)))
    # a = 2 (1 + s): 8 (1 + s) = 16 (1 - u): u = 1/2 alone is the cheapest, a or b alone double
    assert {r.constraint: r.amount for r in card.joint} == pytest.approx({"case 1": 0.5}, abs=1e-6)
    assert {r.constraint: r.amount for r in card.sole} == pytest.approx(
        {"case 1": 0.5, "a max": 1.0, "b max": 1.0}, abs=1e-6
    )


def test_relaxing_as_told_makes_it_feasible():
    """Lowering the limits of a larger problem by the joint relaxation makes it feasible."""
    parametric = problems.geometric_programme(3)
    limits = np.full(15, 0.35)
    names = [n.replace("limit ", "g") for n in parametric.parameter_names]
    problem = parametric.at(limits)
    wishes = tuple(name in names for name in problem.constraint_names)
    problem = replace(problem, relaxable=wishes)
    found = solve(problem, samples=2048)
    assert found.outcome is Outcome.INFEASIBLE
    card = explain(problem, [o.x for o in found.optima])
    assert card.joint
    # margin = 1 - used/limit, so giving up s means used <= limit (1 + s)
    for row in card.joint:
        limits[names.index(row.constraint)] *= 1 + row.amount + 1e-6
    assert solve(parametric.at(limits), samples=2048, more_starts=[card.x]).feasible
    limits *= 1 - 0.01
    assert not solve(parametric.at(limits), samples=2048, more_starts=[card.x]).feasible
