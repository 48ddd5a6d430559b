"""The lightest steel cylinder for a push of 5 kN at 210 bar, stroke 200 mm, by several solvers.

    python benchmarks/cylinder.py SOLVER

A process imports only what its solver needs. It prints bore, wall and rod diameter in mm.
`peers.py` measures it.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

LOWER, UPPER, START = (10.0, 0.5, 6.0), (60.0, 10.0, 50.0), (30.0, 3.0, 20.0)
"""Bounds and start of bore, wall and rod diameter of the example cylinder, mm."""
MARGINS = 4


def mass_and_margins(bore: Any, wall: Any, rod: Any) -> tuple[Any, list[Any]]:
    """Mass in kg and margins (at least 0 where met) from dimensions in mm, for any numbers.

    Margins: pushing force; yield of the barrel, thick tube with closed ends, safety factor 2;
    Euler buckling of the extended rod, length twice the stroke, factor 3.5; piston around the rod.
    """
    force, pressure, stroke, steel, oil = 5e3, 21.0, 200.0, 7.85e-6, 0.87e-6
    quarter, outer = math.pi / 4, bore + 2 * wall
    stress = math.sqrt(3) * pressure * outer**2 / (outer**2 - bore**2)
    critical = math.pi**3 * 206e3 / 64 * rod**4 / (2 * stroke) ** 2
    barrel = quarter * (outer**2 - bore**2) * (stroke + 60) * steel
    piston = quarter * bore**2 * 0.6 * bore * steel
    shaft = quarter * rod**2 * (stroke + 60) * steel
    mass = barrel + piston + shaft + quarter * bore**2 * stroke * oil
    return mass, [
        quarter * bore**2 * pressure / force - 1,
        1 - 2 * stress / 355,
        critical / (3.5 * force) - 1,
        (bore - 4) / rod - 1,
    ]


Solver = Callable[[], Sequence[float]]
"""A function that states and solves the problem, and returns bore, wall and rod diameter, mm."""


def ours(**options: int) -> Solver:
    """By the solver of actuator-opt."""
    import numpy as np

    from actuator_opt.optimisation.problem import BoxProblem, PointValues
    from actuator_opt.optimisation.solver import solve

    def evaluate(points: Any) -> PointValues:
        mass, margins = mass_and_margins(*points)
        return PointValues(mass, np.stack(margins))

    def run() -> Sequence[float]:
        names = [f"margin {k}" for k in range(MARGINS)]
        bounds = np.array(LOWER), np.array(UPPER)
        start = np.array(START)
        problem = BoxProblem(("bore", "wall", "rod"), *bounds, evaluate, names, start=start)
        return list(map(float, solve(problem, **options).x))

    return run


def openmdao() -> Solver:
    """By OpenMDAO: partial derivatives by the complex step, SLSQP of SciPy."""
    import numpy as np
    import openmdao.api as om

    names = ("bore", "wall", "rod")

    class Cylinder(om.ExplicitComponent):  # type: ignore[misc]
        def setup(self) -> None:
            for name, value in zip(names, START, strict=True):
                self.add_input(name, value)
            self.add_output("mass")
            self.add_output("margins", np.zeros(MARGINS))
            self.declare_partials("*", "*", method="cs")

        def compute(self, inputs: Any, outputs: Any) -> None:
            outputs["mass"], margins = mass_and_margins(*(inputs[name] for name in names))
            outputs["margins"] = np.concatenate(margins)

    def run() -> Sequence[float]:
        problem = om.Problem(reports=False)
        problem.model.add_subsystem("cylinder", Cylinder(), promotes=["*"])
        problem.driver = om.ScipyOptimizeDriver(optimizer="SLSQP", tol=1e-12, disp=False)
        for name, low, high in zip(names, LOWER, UPPER, strict=True):
            problem.model.add_design_var(name, lower=low, upper=high, ref=high)
        problem.model.add_objective("mass")
        problem.model.add_constraint("margins", lower=0.0)
        problem.setup()
        problem.run_driver()
        return [float(problem.get_val(name)[0]) for name in names]

    return run


def aerosandbox() -> Solver:
    """By AeroSandbox: derivatives of CasADi, IPOPT."""
    import aerosandbox as asb

    def run() -> Sequence[float]:
        opti = asb.Opti()
        bounds = zip(START, LOWER, UPPER, strict=True)
        x = [opti.variable(a, lower_bound=low, upper_bound=high) for a, low, high in bounds]
        mass, margins = mass_and_margins(*x)
        opti.subject_to([margin >= 0 for margin in margins])
        opti.minimize(mass)
        solution = opti.solve(verbose=False, options={"ipopt.tol": 1e-10})
        return [float(solution(value)) for value in x]

    return run


SOLVERS: dict[str, Callable[[], Solver]] = {
    "actuator-opt, from the start": partial(ours, starts=1, samples=0),
    "actuator-opt, global search": ours,
    "openmdao": openmdao,
    "aerosandbox": aerosandbox,
}
"""The peers search from the start alone."""


if __name__ == "__main__":
    print(*SOLVERS[sys.argv[1]]()())
