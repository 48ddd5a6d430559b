"""The NLopt guard: every algorithm by name, refusals, and the traps it must not fall into."""

import numpy as np
import pytest

from actuator_opt.base.errors import UsageError
from actuator_opt.optimisation import nlopt_wrapper
from actuator_opt.optimisation.evaluator import Evaluator
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.solution import Outcome
from actuator_opt.optimisation.solver import solve

LOCAL = [
    "LD_SLSQP", "LD_MMA", "LD_CCSAQ", "LN_COBYLA", "AUGLAG", "AUGLAG+LD_LBFGS",
    "AUGLAG+LD_TNEWTON", "AUGLAG+LD_TNEWTON_RESTART", "AUGLAG+LD_TNEWTON_PRECOND",
    "AUGLAG+LD_TNEWTON_PRECOND_RESTART", "AUGLAG+LD_VAR1", "AUGLAG+LD_VAR2", "AUGLAG+LN_BOBYQA",
    "AUGLAG+LN_NEWUOA_BOUND", "AUGLAG+LN_NELDERMEAD", "AUGLAG+LN_SBPLX", "AUGLAG+LN_PRAXIS",
    "AUGLAG_EQ+LD_MMA", "AUGLAG_EQ+LD_CCSAQ", "AUGLAG_EQ+LN_COBYLA", "slsqp", "ld_mma",
    "LD_AUGLAG", "LN_AUGLAG_EQ",
]  # fmt: skip


def slow(*names):
    """Algorithms that spend all their evaluations, among the long tests."""
    return [pytest.param(name, marks=pytest.mark.long) for name in names]


GLOBAL = ["GN_ORIG_DIRECT", "GN_ORIG_DIRECT_L", *slow("GN_ISRES", "GN_AGS")]


UNCONSTRAINED = [
    "LD_LBFGS", "LD_TNEWTON", "LD_VAR2", "LN_BOBYQA", "LN_SBPLX", "LN_NELDERMEAD", "LN_PRAXIS",
    "GN_DIRECT_L", *slow("GN_DIRECT", "GN_DIRECT_L_RAND"), "GN_CRS2_LM", "GN_ESCH", "GD_STOGO",
    "G_MLSL_LDS", "G_MLSL_LDS+LN_BOBYQA",
]  # fmt: skip


def easy(n=2, constrained=True):
    """Minimise the sum with the product of powers at least 1: x = (1, ..., 1)."""

    def evaluate(x):
        product = x.prod(axis=0)
        if constrained:
            return PointValues(x.sum(axis=0), (product - 1)[None])
        return PointValues((x + 1 / x).sum(axis=0))

    names = tuple(f"x{i + 1}" for i in range(n))
    rows = ("product",) if constrained else ()
    return BoxProblem(names, np.full(n, 0.1), np.full(n, 10.0), evaluate, rows)


def impossible():
    """With x y >= 12 with x <= 2 and y <= 4: infeasible, 1/3 of the product is missing."""

    def evaluate(x):
        a, b = x
        return PointValues(a + b, np.stack([a * b / 12 - 1, 1 - a / 2, 1 - b / 4]))

    names = ("product", "a max", "b max")
    return BoxProblem(("a", "b"), [0.1, 0.1], [10, 10], evaluate, names)


@pytest.mark.parametrize("algorithm", LOCAL + GLOBAL)
def test_every_constrained_algorithm(algorithm):
    """Every algorithm for constrained problems reaches the optimum through the guard."""
    found = solve(easy(), algorithm=algorithm, samples=256, starts=2)
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1, 1], rtol=1e-6)


@pytest.mark.parametrize("algorithm", UNCONSTRAINED)
def test_every_unconstrained_algorithm(algorithm):
    """Every algorithm without constraints solves a problem without constraints."""
    found = solve(easy(constrained=False), algorithm=algorithm, samples=256, starts=2)
    assert found.outcome is Outcome.OPTIMUM
    np.testing.assert_allclose(found.x, [1, 1], rtol=1e-5)


@pytest.mark.parametrize(
    "algorithm", [*LOCAL[:6], *slow("GN_ISRES", "GN_ORIG_DIRECT_L", "GN_AGS"), "auto"]
)
def test_infeasible_is_never_success(algorithm):
    """MMA, CCSAQ and COBYLA report success on infeasible problems; the guard does not."""
    found = solve(impossible(), algorithm=algorithm, samples=256, starts=2)
    assert found.outcome is Outcome.INFEASIBLE
    assert not found.feasible
    assert found.violation > 0.1


@pytest.mark.parametrize(
    "algorithm", ["LD_SLSQP", "LD_MMA", "LN_COBYLA", *slow("GN_AGS", "GN_ISRES")]
)
def test_nan_in_the_box_is_screened(algorithm):
    """A NaN objective (which crashes AGS) counts as a bad point and is not returned."""

    def evaluate(x):
        return PointValues(
            np.where(x[1].real > 3 * x[0].real, np.nan, x[0] + x[1]), (x[0] * x[1] - 1)[None]
        )

    problem = BoxProblem(("a", "b"), [0.1, 0.1], [10, 10], evaluate, ("product",))
    found = solve(problem, algorithm=algorithm, samples=256, starts=2)
    assert found.feasible
    np.testing.assert_allclose(found.x, [1, 1], rtol=1e-4)


@pytest.mark.parametrize(
    ("algorithm", "message"),
    [
        ("LD_LBFGS", r"LD_LBFGS does not support constraints.*write AUGLAG\+LD_LBFGS"),
        ("GN_DIRECT_L", r"does not support constraints.*write GN_ORIG_DIRECT_L or GN_ISRES"),
        ("G_MLSL_LDS", r"does not support constraints.*write AUGLAG\+LD_LBFGS"),
        ("AUGLAG_EQ+LD_LBFGS", r"leaves the inequalities to LD_LBFGS.*write AUGLAG\+LD_LBFGS"),
        ("LD_SLSPQ", r'no algorithm "LD_SLSPQ".*did you mean LD_SLSQP'),
        ("LD_SLSQP+LD_MMA", "takes no inner algorithm"),
        ("AUGLAG+AUGLAG", "cannot be the inner algorithm of"),
        ("", "no algorithm"),
    ],
)
def test_unsuitable_algorithms_are_refused(algorithm, message):
    """Unknown and unsuitable algorithms are refused in a sentence that names one to use."""
    with pytest.raises(UsageError, match=message):
        solve(easy(), algorithm=algorithm)


def test_too_many_variables_are_refused():
    """AGS is for at most 10 variables."""
    with pytest.raises(UsageError, match="GN_AGS supports at most 10 variables, not 11"):
        solve(easy(11), algorithm="GN_AGS")


def test_equalities_are_refused_where_not_taken():
    """MMA takes no equality constraints."""

    def evaluate(x):
        return PointValues(x[0], None, (x[0] * x[1] - 1)[None])

    problem = BoxProblem(("a", "b"), [0.1, 0.1], [10, 10], evaluate, (), ("product",))
    with pytest.raises(UsageError, match=r"does not support equality constraints.*AUGLAG\+LD_MMA"):
        solve(problem, algorithm="LD_MMA")
    assert solve(problem, algorithm="AUGLAG+LD_MMA").objective == pytest.approx(0.1)


def test_every_table_entry_exists_in_nlopt():
    """Each algorithm of the table is one of the installed NLopt."""
    import nlopt

    for name in nlopt_wrapper.ALGORITHMS:
        assert hasattr(nlopt, name)
    for name in (*nlopt_wrapper.OLDER.values(), *nlopt_wrapper.INSIDE.values()):
        nlopt_wrapper.find(name)


def test_best_feasible_iterate_is_kept():
    """A run cut short returns its best feasible iterate, not its last point."""
    evaluator = Evaluator(impossible_from(0.3))
    start = evaluator.point(np.log(np.array([3.0, 3.0])))
    for most in range(2, 12):
        found = nlopt_wrapper.run(evaluator, start, "LD_SLSQP", max_evaluations=most)
        assert found.point.violation <= 1e-6
        assert found.point.objective <= start.objective


@pytest.mark.parametrize("fault", [KeyboardInterrupt, SystemExit, StopIteration, OSError])
@pytest.mark.parametrize("place", ["model", "slopes", "callback"])
def test_nothing_that_is_raised_is_lost_in_nlopt(fault, place, monkeypatch):
    """Whatever a model raises, and Ctrl-C wherever it lands, comes out as it was raised."""
    evaluator = Evaluator(easy())
    start = evaluator.point(np.array([1.0, 0.5]))

    def raising(*_):
        raise fault

    owner, name = {
        "model": (evaluator, "point"),
        "slopes": (evaluator, "jacobian"),
        "callback": (nlopt_wrapper._Guard, "objective"),
    }[place]
    monkeypatch.setattr(owner, name, raising)
    with pytest.raises(fault):
        nlopt_wrapper.run(evaluator, start, "LD_SLSQP")


def impossible_from(product):
    """Minimise a + b with a b >= product: feasible, and the first steps overshoot."""

    def evaluate(x):
        return PointValues(x[0] + x[1], (x[0] * x[1] / product - 1)[None])

    return BoxProblem(("a", "b"), [0.1, 0.1], [10, 10], evaluate, ("product",))


def test_linear_and_logarithmic_variables_agree():
    """The same run in linear variables ends on the same point."""
    evaluator = Evaluator(easy())
    start = evaluator.point(np.array([1.0, 0.5]))
    first = nlopt_wrapper.run(evaluator, start, "LD_SLSQP").point
    second = nlopt_wrapper.run(evaluator, start, "LD_SLSQP", linear=True).point
    np.testing.assert_allclose(first.x, second.x, rtol=1e-5)
