"""Published problems: optimum, multipliers, multistart and scaling of the optimiser layer."""

import numpy as np
import problems
import pytest

from actuator_opt.optimisation.kkt import Curvature
from actuator_opt.optimisation.solution import Outcome
from actuator_opt.optimisation.solver import solve


@pytest.mark.parametrize("seed", range(3))
def test_rosen_suzuki(seed):
    """HS43 reaches f* = -44 at (0, 1, 2, -1) with the published multipliers (1, 0, 2)."""
    found = solve(problems.rosen_suzuki(), seed=seed)
    assert found.outcome is Outcome.OPTIMUM
    assert found.objective == pytest.approx(-44, rel=1e-12)
    np.testing.assert_allclose(found.x, [0, 1, 2, -1], atol=1e-8)
    np.testing.assert_allclose(found.kkt.multipliers, [1, 0, 2], atol=1e-8)
    assert found.kkt.residual <= 1e-9
    assert found.kkt.active == ("g1", "g3")
    assert found.kkt.rank == found.kkt.count == 2
    assert found.kkt.curvature is Curvature.POSITIVE


@pytest.mark.parametrize("seed", range(3))
def test_hs71(seed):
    """HS71 (equality and bounds): optimum and multipliers of [HockSchittkowski1981].

    Published: f* = 17.0140173, x* = (1, 4.7429994, 3.8211503, 1.3794082); multipliers of the
    product 0.552294, of the equality -0.161469 (sign of ours) and of the bound x1 >= 1
    1.087871.
    """
    found = solve(problems.hs71(), seed=seed)
    assert found.outcome is Outcome.OPTIMUM
    assert found.objective == pytest.approx(17.0140173, abs=5e-8)
    np.testing.assert_allclose(found.x, [1, 4.7429994, 3.8211503, 1.3794082], atol=2e-6)
    assert found.kkt.multipliers[0] == pytest.approx(0.552294, abs=5e-7)
    assert found.kkt.equality_multipliers[0] == pytest.approx(-0.161469, abs=5e-7)
    assert found.kkt.lower_multipliers[0] == pytest.approx(1.087871, abs=5e-7)  # dx/dz = x = 1
    assert "x1 lower" in found.kkt.active
    assert found.at_bound(0) == "lower"
    assert found.at_bound(1) is None


def test_stepped_cantilever():
    """The cantilever matches its closed form.

    Minimise C sum(x) with sum(c/x^3) = L: stationarity gives x proportional to c^(1/4), so with
    S = sum(c^(1/4)): x = c^(1/4) (S/L)^(1/3), f* = C S^(4/3) L^(-1/3), and the multiplier of the
    relative margin is f*/3.
    """
    found = solve(problems.stepped_cantilever().problem)
    root = problems.CANTILEVER_COEFFICIENTS**0.25
    np.testing.assert_allclose(found.x, root * root.sum() ** (1 / 3), rtol=1e-9)
    assert found.objective == pytest.approx(0.0624 * root.sum() ** (4 / 3), rel=1e-12)
    assert found.objective == pytest.approx(1.33995636, abs=5e-9)  # [Svanberg1987]
    assert found.kkt.multipliers[0] == pytest.approx(found.objective / 3, rel=1e-9)


def test_pressure_vessel():
    """Continuous pressure vessel with L <= 200: optimum at a vertex, multipliers by hand.

    At the vertex T = a R, H = b R, L = 200 and the volume holds; the mass along these is
    f(R) = (0.6224 a L R^2 + 1.7781 b R^3 + 3.1661 a^2 L R^2 + 19.84 a^2 R^3), so the multiplier
    of the volume margin is f'(R)/V'(R) * V.
    """
    found = solve(problems.pressure_vessel().problem)
    assert found.outcome is Outcome.OPTIMUM
    assert found.objective == pytest.approx(5885.332774, abs=5e-7)
    np.testing.assert_allclose(found.x, [0.77816864, 0.38464916, 40.31961872, 200], rtol=1e-8)
    assert found.kkt.curvature is Curvature.VERTEX
    assert set(found.kkt.active) == {"shell stress", "head stress", "volume", "length upper"}
    a, b, length, radius = 0.0193, 0.00954, 200.0, found.x[2]
    slope = 2 * radius * (0.6224 * a * length + 3.1661 * a**2 * length)
    slope += 3 * radius**2 * (1.7781 * b + 19.84 * a**2)
    per_volume = slope / (2 * np.pi * radius * length + 4 * np.pi * radius**2)
    assert found.kkt.multipliers[2] == pytest.approx(per_volume * 1296000, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_piston_lever(seed):
    """The default multistart leaves the bad local optima (167.47) of the piston lever behind."""
    found = solve(problems.piston_lever(), seed=seed)
    assert found.outcome is Outcome.OPTIMUM
    assert found.objective == pytest.approx(8.412698323, abs=5e-10)
    np.testing.assert_allclose(found.x, [0.05, 2.04151359, 4.08302718, 120], rtol=3e-9)
    assert found.optima[0].objective == found.objective
    assert len(found.optima) >= 2


@pytest.mark.parametrize("seed", range(3))
def test_thrust_bearing(seed):
    """The badly scaled thrust bearing (viscosity near 5e-6) is solved to the published optimum."""
    found = solve(problems.thrust_bearing(), seed=seed)
    assert found.outcome is Outcome.OPTIMUM
    assert found.objective == pytest.approx(1625.442759, abs=5e-6)
    published = [5.95578050, 5.38901305, 5.35869727e-6, 2.26965596]
    np.testing.assert_allclose(found.x, published, rtol=1e-7)
    assert found.kkt.residual <= 1e-9


def test_random_geometric_programmes():
    """Random posynomial programmes end on their one global optimum from all starts.

    They are convex in logarithms, where the optimality conditions (met to 1e-9) prove it.
    """
    for seed in range(4):
        found = solve(problems.geometric_programme(seed).problem, seed=seed)
        assert found.outcome is Outcome.OPTIMUM
        assert found.kkt.residual <= 1e-9
        assert found.violation <= 1e-9
        assert len([o for o in found.optima if o.residual <= 1e-6]) == 1


def test_same_seed_same_bytes():
    """The same seed repeats every figure to the last bit; another seed still agrees to 1e-9."""
    first, again, other = (solve(problems.piston_lever(), seed=s) for s in (7, 7, 8))
    assert first.x.tobytes() == again.x.tobytes()
    assert first.trace == again.trace
    assert first.evaluations == again.evaluations
    assert first.kkt.multipliers.tobytes() == again.kkt.multipliers.tobytes()
    assert other.objective == pytest.approx(first.objective, rel=1e-9)
