"""Safe calls of NLopt: algorithms by name, guarded callbacks, verified results.

NLopt reports success at infeasible points (MMA, CCSAQ, COBYLA), crashes on NaN (AGS), replaces
exceptions of callbacks, and discards good results with RoundoffLimited [NLopt]. So the wrapper only
records the return code. Its callbacks never raise and never return NaN. It stores the best feasible
iterate, and the caller verifies the result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import nlopt
import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError
from ..base.words import nearest
from .evaluator import Evaluator, LimitReached, Point
from .problem import BoxProblem, Vector

FEASIBLE = 1e-8
"""Violation up to which an iterate counts as feasible when the best iterate is selected."""


@dataclass(frozen=True, slots=True)
class Algorithm:
    """An NLopt algorithm and the problems that it can solve.

    Parameters
    ----------
    name : NLopt's name
    scope : "local", "global", or "wrapper" for an algorithm that needs an inner algorithm
    inequalities, equalities : whether the algorithm supports them
    most_variables : maximum number of free variables
    most_evaluations : maximum number of evaluations in one run; it is small for the original
        DIRECT, whose time grows with the cube of this number
    about : description for the user
    """

    name: str
    scope: str
    inequalities: bool
    equalities: bool
    most_variables: int
    most_evaluations: int
    about: str

    @property
    def uses_gradients(self) -> bool:
        """Whether the algorithm itself uses gradients."""
        return self.name.startswith(("LD_", "GD_"))


def _table(text: str) -> dict[str, Algorithm]:
    table = {}
    for line in text.strip().splitlines():
        name, scope, rows, variables, evaluations, about = (
            cell.strip() for cell in line.split("|")
        )
        table[name] = Algorithm(
            name, scope, "i" in rows, "e" in rows, int(variables), int(evaluations), about
        )
    return table


ALGORITHMS = _table("""
 LD_SLSQP                   |local  |ie|1000| 2000| sequential quadratic programming, Kraft
 LD_MMA                     |local  |i |1000| 2000| method of moving asymptotes, Svanberg
 LD_CCSAQ                   |local  |i |1000| 2000| conservative quadratic approximation
 LN_COBYLA                  |local  |ie|1000| 2000| linear approximations without gradients, Powell
 LD_LBFGS                   |local  |- |1000| 2000| limited-memory BFGS
 LD_TNEWTON                 |local  |- |1000| 2000| truncated Newton
 LD_TNEWTON_RESTART         |local  |- |1000| 2000| truncated Newton with restarts
 LD_TNEWTON_PRECOND         |local  |- |1000| 2000| preconditioned truncated Newton
 LD_TNEWTON_PRECOND_RESTART |local  |- |1000| 2000| preconditioned truncated Newton with restarts
 LD_VAR1                    |local  |- |1000| 2000| shifted limited-memory variable metric, rank 1
 LD_VAR2                    |local  |- |1000| 2000| shifted limited-memory variable metric, rank 2
 LN_BOBYQA                  |local  |- | 200| 2000| quadratic models without gradients, Powell
 LN_NEWUOA_BOUND            |local  |- | 200| 2000| forerunner of BOBYQA, without gradients
 LN_NELDERMEAD              |local  |- | 100| 2000| simplex, Nelder and Mead
 LN_SBPLX                   |local  |- | 200| 2000| simplex in subspaces, Rowan
 LN_PRAXIS                  |local  |- | 100| 2000| principal axes, Brent
 GN_ISRES                   |global |ie| 200| 8000| evolution strategy with stochastic ranking
 GN_ORIG_DIRECT             |global |i |  30| 1000| dividing rectangles, original code
 GN_ORIG_DIRECT_L           |global |i |  30| 1000| dividing rectangles, locally biased, original
 GN_AGS                     |global |i |  10| 5000| Peano curves with Lipschitz bounds
 GN_DIRECT                  |global |- |  30| 5000| dividing rectangles
 GN_DIRECT_L                |global |- |  30| 5000| dividing rectangles, locally biased
 GN_DIRECT_L_RAND           |global |- |  30| 5000| dividing rectangles, locally biased, randomised
 GN_CRS2_LM                 |global |- | 200|10000| controlled random search
 GN_ESCH                    |global |- | 200|10000| evolutionary algorithm
 GD_STOGO                   |global |- |  10| 1500| branch and bound with gradients
 AUGLAG                     |wrapper|ie|1000| 4000| augmented Lagrangian around an inner algorithm
 AUGLAG_EQ                  |wrapper|ie|1000| 4000| augmented Lagrangian for the equalities only
 G_MLSL_LDS                 |wrapper|- | 200| 1500| multi-level single linkage, inner algorithm
""")

OLDER = {
    "LD_AUGLAG": "AUGLAG+LD_LBFGS",
    "LN_AUGLAG": "AUGLAG+LN_BOBYQA",
    "LD_AUGLAG_EQ": "AUGLAG_EQ+LD_MMA",
    "LN_AUGLAG_EQ": "AUGLAG_EQ+LN_COBYLA",
    "GD_MLSL": "G_MLSL_LDS+LD_LBFGS",
    "GD_MLSL_LDS": "G_MLSL_LDS+LD_LBFGS",
    "GN_MLSL": "G_MLSL_LDS+LN_BOBYQA",
    "GN_MLSL_LDS": "G_MLSL_LDS+LN_BOBYQA",
    "G_MLSL": "G_MLSL_LDS+LD_LBFGS",
}
"""NLopt's own names for combinations of two algorithms, and our notation of each with "+"."""

INSIDE = {"AUGLAG": "LD_LBFGS", "AUGLAG_EQ": "LD_MMA", "G_MLSL_LDS": "LD_LBFGS"}
"""Inner algorithm of a wrapper if the user names none."""


def find(text: str) -> tuple[Algorithm, Algorithm | None]:
    """The algorithm with a given name, and its inner algorithm, as in "AUGLAG+LD_LBFGS".

    Case is ignored. A prefix may be omitted if the name remains unique ("slsqp").

    Raises
    ------
    UsageError
        the algorithm does not exist; the message suggests the nearest names
    """
    name = OLDER.get(text.strip().upper(), text.strip().upper())
    outer, _, inner = name.partition("+")
    outer_algorithm = _one(outer)
    if outer_algorithm.scope != "wrapper":
        if inner:
            raise _refusal(
                f"{outer_algorithm.name} takes no inner algorithm", f"write {outer_algorithm.name}"
            )
        return outer_algorithm, None
    inner_algorithm = _one(inner or INSIDE[outer_algorithm.name])
    if inner_algorithm.scope == "wrapper":
        raise _refusal(
            f"{inner_algorithm.name} cannot be the inner algorithm of {outer_algorithm.name}",
            "name a local algorithm",
        )
    return outer_algorithm, inner_algorithm


def _one(name: str) -> Algorithm:
    name = name.strip()
    if name in ALGORITHMS:
        return ALGORITHMS[name]
    short = [a for a in ALGORITHMS.values() if a.name.split("_", 1)[-1] == name]
    if len(short) == 1:
        return short[0]
    suggestions = nearest(name, [*ALGORITHMS, *OLDER])
    choice = ", ".join(suggestions or ["LD_SLSQP", "AUGLAG+LD_LBFGS", "GN_ISRES"])
    raise _refusal(f'there is no algorithm "{name}"', f"did you mean {choice}?")


def _refusal(message: str, remedy: str) -> UsageError:
    return UsageError(Diagnostic(message, remedy, path="algorithm"))


def suit(text: str, problem: BoxProblem) -> str:
    """The full name of an algorithm, after checking that it can solve the problem.

    Raises
    ------
    UsageError
        it cannot solve this kind of problem; the message suggests another algorithm
    """
    outer, inner = find(text)
    inequalities, equalities = bool(problem.constraint_names), bool(problem.equality_names)
    count = int(np.count_nonzero(problem.upper > problem.lower))
    if (inequalities and not outer.inequalities) or (equalities and not outer.equalities):
        kind = "constraints" if not outer.inequalities else "equality constraints"
        remedy = "write LD_SLSQP or LN_COBYLA"
        if outer.scope == "local" or inner is not None:
            remedy = f"write AUGLAG+{(inner or outer).name}"
        elif inequalities and not equalities:
            remedy = "write GN_ORIG_DIRECT_L or GN_ISRES"
        raise _refusal(f"{outer.name} does not support {kind}, which this problem has", remedy)
    if outer.name == "AUGLAG_EQ" and inequalities and inner and not inner.inequalities:
        message = f"AUGLAG_EQ leaves the inequalities to {inner.name}, which does not support them"
        raise _refusal(message, f"write AUGLAG+{inner.name} or AUGLAG_EQ+LD_MMA")
    if outer.name == "G_MLSL_LDS" and inner is not None and inner.scope != "local":
        raise _refusal(
            f"G_MLSL_LDS needs a local inner algorithm, not {inner.name}",
            "write G_MLSL_LDS+LD_LBFGS",
        )
    for part in (outer, inner):
        if part is not None and count > part.most_variables:
            message = f"{part.name} supports at most {part.most_variables} variables, not {count}"
            raise _refusal(message, "fix some variables, or choose LD_SLSQP or GN_ISRES")
    return outer.name if inner is None else f"{outer.name}+{inner.name}"


ARRIVAL = (0.1, 1e-3, 1e-3)
"""A run stops at a known optimum within these limits: distance in solver coordinates, relative
difference of the objective, violation. Only slow convergence to that optimum would follow."""


@dataclass(frozen=True)
class NloptRun:
    """Result of one NLopt call: the point to continue from, and NLopt's return code."""

    point: Point
    code: int
    algorithm: str
    arrived: int | None = None
    """Index of the known optimum whose vicinity the run reached and where it stopped; else None."""


class _Arrived(Exception):
    """Raised if a run reaches a known optimum."""


class _Guard:
    """Callbacks for NLopt that never raise and never return NaN."""

    def __init__(self, evaluator: Evaluator, start: Point, *, linear: bool, handle: Any) -> None:
        self.evaluator, self.handle, self.linear = evaluator, handle, linear
        space, problem = evaluator.space, evaluator.problem
        self.low = problem.lower[space.free]
        self.width = problem.upper[space.free] - self.low
        self.scale = abs(start.objective) if start.valid and start.objective != 0 else 1.0
        self.worst = 1.0
        self.optima: Sequence[Point] = ()
        self.rank: Callable[[Point], Any] = _rank
        self.arrived: int | None = None
        self.error: BaseException | None = None
        self.best: Point | None = None
        self.last: Point | None = None

    def point(self, u: Vector) -> Point:
        return self.evaluator.point(self.to_z(u))

    def to_z(self, u: Vector) -> Vector:
        space = self.evaluator.space
        if not self.linear:
            return np.clip(u, space.lower, space.upper)
        x = self.evaluator.problem.lower.copy()
        x[space.free] = self.low + np.clip(u, 0.0, 1.0) * self.width
        return space.to_z(x)

    def from_point(self, point: Point) -> Vector:
        if not self.linear:
            return point.z.copy()
        inner = point.x[self.evaluator.space.free]
        return np.asarray(np.clip((inner - self.low) / self.width, 0.0, 1.0))

    def _slopes(self, point: Point) -> Vector:
        jacobian = self.evaluator.jacobian(point)
        if not self.linear:
            return jacobian
        slope = self.evaluator.space.slope(point.x[:, None])[:, 0]
        return np.asarray(jacobian * (self.width / slope))

    def _visit(self, u: Vector) -> Point | None:
        """The evaluated point at u, or None if the run must stop."""
        if self.error is not None:
            return None
        with self._deferred():
            self.last = point = self.point(np.array(u, dtype=float))
            if point.valid:
                self.worst = max(self.worst, abs(point.objective) / self.scale)
                if point.violation <= FEASIBLE and (
                    self.best is None or point.objective < self.best.objective
                ):
                    self.best = point
                self._look_around(point)
            return point
        return None

    def _look_around(self, point: Point) -> None:
        """Stop the run if the point is near a known optimum."""
        distance, share, violation = ARRIVAL
        if point.violation > violation:
            return
        for index, optimum in enumerate(self.optima):
            similar = abs(point.objective - optimum.objective) <= share * abs(optimum.objective)
            if similar and np.abs(point.z - optimum.z).max(initial=0.0) <= distance:
                self.arrived = index
                raise _Arrived

    @contextmanager
    def _deferred(self) -> Iterator[None]:
        """Hold back exceptions of the model, and Ctrl-C, until NLopt has returned."""
        try:
            yield
        except BaseException as error:  # all exceptions, because NLopt turns them into SystemError
            self.error = error
            self.handle.force_stop()

    def objective(self, u: Vector, slope: Vector) -> float:
        point = self._visit(u)
        if slope.size:
            slope[:] = 0.0
        if point is None or not point.valid:
            return 10.0 * self.worst
        if slope.size:
            with self._deferred():
                slope[:] = self._slopes(point)[0] / self.scale
        return point.objective / self.scale

    def _rows(self, result: Vector, u: Vector, slopes: Vector, rows: slice, fault: float) -> None:
        point = self._visit(u)
        if slopes.size:
            slopes[:] = 0.0
        if point is None or not point.valid:
            result[:] = fault
            return
        result[:] = -point.rows[rows]
        if slopes.size:
            with self._deferred():
                slopes[:] = -self._slopes(point)[rows]

    def inequalities(self, result: Vector, u: Vector, slopes: Vector) -> None:
        self._rows(result, u, slopes, slice(1, 1 + self.evaluator.constraint_count), 1.0)

    def worst_margin(self, u: Vector, slope: Vector) -> float:
        """Margin of the most violated constraint, which is the only constraint that AGS gets."""
        result = np.zeros(self.evaluator.constraint_count)
        self.inequalities(result, u, slope)
        return float(result.max())

    def equalities(self, result: Vector, u: Vector, slopes: Vector) -> None:
        self._rows(result, u, slopes, slice(1 + self.evaluator.constraint_count, None), 1.0)


def run(
    evaluator: Evaluator,
    start: Point,
    algorithm: str,
    *,
    linear: bool = False,
    tolerance: float = 1e-9,
    max_evaluations: int | None = None,
    seed: int = 0,
    optima: Sequence[Point] = (),
    rank: Callable[[Point], Any] | None = None,
) -> NloptRun:
    """Run one algorithm from one point, for at most `max_evaluations`.

    The default of `max_evaluations` is the algorithm's own limit. A run that reaches one of the
    known `optima` (see `ARRIVAL`) stops there. Candidates for the result are NLopt's point, the
    best feasible iterate, the last iterate and the start. `rank` sorts them; by default, feasible
    points come first, by objective, then the others by violation. Exceptions of the model and
    Ctrl-C are raised unchanged after NLopt has returned. A limit of evaluations or time ends the
    run without an exception.
    """
    if evaluator.space.size == 0:
        return NloptRun(start, 1, algorithm)
    outer, inner = find(algorithm)
    size, max_evaluations = evaluator.space.size, max_evaluations or outer.most_evaluations
    evaluator.eager = (inner or outer).uses_gradients
    handle = _handle(outer, size, tolerance, max_evaluations)
    guard = _Guard(evaluator, start, linear=linear, handle=handle)
    guard.optima, guard.rank = optima, rank or _rank
    box = evaluator.space
    bounds = (np.zeros(size), np.ones(size)) if linear else (box.lower, box.upper)
    handle.set_lower_bounds(bounds[0])
    handle.set_upper_bounds(bounds[1])
    handle.set_min_objective(guard.objective)
    m, e = evaluator.constraint_count, len(evaluator.problem.equality_names)
    if m and outer.name == "GN_AGS":  # AGS takes only a few scalar constraints
        handle.add_inequality_constraint(guard.worst_margin, tolerance)
    elif m:
        handle.add_inequality_mconstraint(guard.inequalities, np.full(m, tolerance))
    if e:
        handle.add_equality_mconstraint(guard.equalities, np.full(e, tolerance))
    if inner is not None:
        local = _handle(inner, size, tolerance, max(20, max_evaluations // 4))
        handle.set_local_optimizer(local)
    nlopt.srand(seed + 1)
    try:
        end = handle.optimize(guard.from_point(start))
    except (RuntimeError, ValueError, SystemError, MemoryError) as error:  # raised by NLopt
        end = None
        guard.error = guard.error or error.__cause__  # Ctrl-C outside a callback
    code = int(handle.last_optimize_result())
    if guard.error is not None and not isinstance(guard.error, (LimitReached, _Arrived)):
        raise guard.error
    return NloptRun(_pick(evaluator, guard, end, start), code, algorithm, guard.arrived)


def _handle(algorithm: Algorithm, size: int, tolerance: float, max_evaluations: int) -> Any:
    handle = nlopt.opt(getattr(nlopt, algorithm.name), size)
    handle.set_exceptions_enabled(False)
    handle.set_ftol_rel(tolerance)
    handle.set_xtol_rel(tolerance)
    handle.set_maxeval(max_evaluations)
    return handle


def _pick(evaluator: Evaluator, guard: _Guard, end: Vector | None, start: Point) -> Point:
    """The best among NLopt's point, the best feasible iterate, the last iterate and the start."""
    candidates = [guard.best, guard.last, start]
    if end is not None and guard.error is None and np.isfinite(end).all():
        limited, evaluator.limited = evaluator.limited, False
        candidates.insert(0, guard.point(np.asarray(end)))
        evaluator.limited = limited
    usable = [p for p in candidates if p is not None]
    return min(usable, key=guard.rank)


def _rank(point: Point) -> tuple[float, float]:
    """Sort key: feasible points by objective, then others by violation, points with NaN last."""
    if not point.valid:
        return (np.inf, np.inf)
    missed = point.violation if point.violation > 1e-6 else 0.0
    return (missed, point.objective)
