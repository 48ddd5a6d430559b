"""A typical script of a user, which strict mypy checks against the installed wheel."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import actuator_opt as ao


def lightest(design: Path, out: Path) -> float:
    """Optimise, look at values and tables, re-solve, sweep, and save: the mass in kg."""
    best: ao.Optimisation = ao.optimise(design, starts=1, prices=False)
    evaluation: ao.Evaluation = ao.evaluate(best.best)
    mass: float = float(evaluation["mass"])
    words: str = best["requirements.stiffness_min.min"].text
    missed: list[str] = [row.name for row in evaluation.requirements if not row.met]
    try:
        evaluation["mas"]
    except ao.UnknownName as error:
        words += str(error)
    masses: ao.DataTable = evaluation.table("masses").sort("mass", descending=True)
    parts = [row["part"] for row in masses]
    vary = {"cylinder.bore": np.linspace(0.020, 0.024, 3), "rod.material": ["ti_6al4v"]}
    swept: ao.Swept = ao.sweep(design, vary, metrics=["stiffness_min"], workers=1)
    feasible = swept.table().where(met=True)
    feasible.to_csv(out / "feasible.csv", units="si")
    many = ao.evaluate_many(design, {"cylinder.bore": [0.021, 0.022]}, metrics=("mass",))
    session = ao.session(design)
    price: ao.Price = session.price("cylinder.stroke")
    curve: ao.OptimumCurve = session.curve("cylinder.stroke", ["105 mm", 0.11])
    print(best, words, missed, parts, price.slope_up, curve.found, len(many), many["mass"].min())
    path: Path = ao.save(best, out / "best.yaml")
    return mass if path.exists() else 0.0
