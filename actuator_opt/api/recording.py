"""Contents of the run record of an optimisation, a front and a sweep."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .actuator import Actuator
from .recorded_runs import Run, record_run
from .reports import verification_tables

if TYPE_CHECKING:
    from ..optimisation.pareto_result import ParetoFront
    from ..optimisation.result import Optimisation
    from ..pages import Table
    from ..simulation.verification import Verification
    from ..sweeps import Swept

BEST = 10
"""Maximum number of best designs in a sweep's record; the store has all rows."""

REASONS = 20
"""Number of failure reasons recorded, most frequent first."""


def record(
    result: Optimisation,
    *,
    actuator: Actuator,
    command: str = "",
    date: str | None = None,
    extra_tables: Sequence[Table] = (),
    dynamics_verified: Verification | None = None,
    folder: str | Path | None = None,
) -> Run | None:
    """Record an optimisation with its input, for showing and reporting it later.

    Parameters
    ----------
    result : of `optimise`
    actuator : the design optimised
    command, date, extra_tables, dynamics_verified : of its report
    folder : target; default: ACTUATOR_OPT_RUNS, else the user's data folder

    Returns
    -------
    the record; None if recording is switched off (ACTUATOR_OPT_NO_RECORD)

    Raises
    ------
    InputError : it cannot be written
    """
    from ..optimisation.recorded import to_plain

    head = {
        "status": result.status,
        "outcome": result.sentence,
        "met": result.best_evaluation.met and (result.rounding is None or result.rounding.met),
        "without_reserve": len(result.tight),
        "objective": result.to_dict()["objective"],
        "seconds": result.seconds,
    }
    more = {
        "variables": {v.path: v.value for v in result.best_variables},
        "trace": [list(row) for row in result.trace],
        "result": result.to_dict(),
        "state": to_plain(result),
        "tables": [
            _plain_table(table)
            for table in (*extra_tables, *verification_tables(dynamics_verified))
        ],
    }
    return record_run(
        "optimise", head, more, actuator=actuator, command=command, date=date,
        seed=result.seed, folder=folder,
    )  # fmt: skip


def _plain_table(table: Table) -> dict[str, object]:
    """A table of a report as a record holds it: texts under their heads."""
    from ..rendering.heights import cells_of, joined

    flexible = all(column.flexible for column in table.columns)
    return {
        "title": table.title,
        "columns": [column.head for column in table.columns],
        "rows": [[joined(cell) for cell in cells_of(row)] for row in table.rows],
        "note": table.note,
        "widths": [column.width for column in table.columns] if flexible else [],
    }


def record_front(
    found: ParetoFront,
    *,
    actuator: Actuator,
    command: str = "",
    date: str | None = None,
    folder: str | Path | None = None,
) -> Run | None:
    """Record a Pareto front, for showing and reporting it later; as `record`."""
    from ..optimisation.recorded import to_plain

    knee = None if found.knee is None else found.knee.index
    head = {
        "status": found.status,
        "outcome": found.sentence,
        "met": bool(found.points),
        "objectives": [{"metric": one.metric, "sense": one.sense} for one in found.objectives],
        "points": len(found.points),
        "knee": None
        if knee is None
        else {one.metric: found.points[knee].metrics[one.metric] for one in found.objectives},
        "seconds": found.seconds,
    }
    more = {"result": found.to_dict(), "state": to_plain(found)}
    return record_run(
        "pareto", head, more, actuator=actuator, command=command, date=date,
        seed=found.seed, folder=folder,
    )  # fmt: skip


def record_sweep(
    found: Swept,
    *,
    actuator: Actuator,
    store: str | Path | None = None,
    csv: str | Path | None = None,
    parquet: str | Path | None = None,
    keep: int = 10,
    figures: Sequence[str] = (),
    show: Sequence[str] = (),
    command: str = "",
    date: str | None = None,
    folder: str | Path | None = None,
) -> Run | None:
    """Record a sweep: plan, counts, best designs and the location of its rows, but no rows.

    Parameters
    ----------
    found : of `sweep`
    actuator, command, date, folder : as `record`
    store, csv, parquet, keep, figures, show : as given to `sweep`
    """
    from ..pages.sweep import counts

    study = found.study
    goal, met = study.goal, bool(found.best or found.feasible)
    best = None
    if found.best:
        first = found.best[0].objective
        best = found.metrics(found.best[0])[goal.single] if goal.single else goal.shown(first)
    head = {
        "status": "feasible" if met else "infeasible",
        "outcome": f"{found.requested} variants: {counts(found)}",
        "met": met,
        "objective": {"metric": goal.single or "weighted", "value": best},
        "requested": found.requested,
        "feasible": found.feasible,
        "failed": found.failed,
        "seconds": found.seconds,
    }
    commonest = sorted(found.failures.items(), key=lambda one: (-one[1], one[0]))[:REASONS]
    kept = replace(found, best=found.best[:BEST], failures=dict(commonest))
    more: dict[str, Any] = {
        "plan": _plan(found),
        "asked": {
            "store": None
            if store is None
            else {"path": os.path.abspath(store), "study": study.hash},
            "csv": None if csv is None else os.path.abspath(csv),
            "parquet": None if parquet is None else os.path.abspath(parquet),
            "reduce": not study.full,
            "engine": study.engine,
            "keep": keep,
            "figures": list(figures),
            "show": list(show),
        },
        "result": kept.to_dict(),
    }
    return record_run(
        "sweep", head, more, actuator=actuator, command=command, date=date,
        seed=study.plan.seed, folder=folder,
    )  # fmt: skip


def _plan(found: Swept) -> dict[str, Any]:
    """The points of a sweep as plain data, values in SI; `quantity` is null for texts."""
    from ..design import quantity_of

    plan, design = found.study.plan, found.study.design
    return {
        "method": plan.method,
        "count": plan.count,
        "axes": [
            {
                "path": axis.path,
                "quantity": None if axis.values is None else quantity_of(axis.path, design).name,
                "values": None if axis.values is None else axis.values.tolist(),
                "texts": list(axis.texts),
                "range": axis.range,
                "steps": axis.count,
            }
            for axis in plan.axes
        ],
    }
