"""At which supply pressure a walking robot is lightest, for missions of different length.

The knee of knee_walking.yaml is optimised for the mass of the whole system (both knees, pump,
accumulator, cooler, battery) for several missions, with supply pressure, linkage, valve and
cylinder free. Specific masses are the assumptions of the design file.

    python designs/scripts/duty_pressure_levels.py                  # prints the table
    python designs/scripts/duty_pressure_levels.py --out reports    # and writes the report there
    python designs/scripts/duty_pressure_levels.py --quick          # one mission
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import actuator_opt as ao
from actuator_opt.base.tables import aligned
from actuator_opt.rendering.script_pages import (
    Sheets,
    grid_table,
    rounded,
    run_script,
    study_report,
)
from actuator_opt.rendering.text import fixed

Data = dict[str, Any]

DESIGN = Path(__file__).resolve().parents[1] / "knee_walking.yaml"
BAR, MINUTE = 1e5, 60.0
MISSIONS = (240, 60, 5)
"""Missions [min]; each search starts from the optimum before."""
QUICK = (60,)
WALK = "walk"


def asked(minutes: float, start: Data | None = None) -> ao.Actuator:
    """The knee for the least system mass of a mission."""
    changes = {
        "objective.minimise": "system_mass",
        "duty.supply.mission_time": f"{minutes} min",
    }
    knee = ao.read(DESIGN, set=changes)
    return knee.changed(start) if start else knee


def row(minutes: float, start: Data | None = None) -> Data:
    """Numbers of the optimum for a mission, SI."""
    found = ao.optimise(asked(minutes, start), starts=1, prices=False)
    evaluation = found.evaluation
    assert evaluation.duty is not None
    study = next(cycle for cycle in evaluation.duty.cycles if cycle.name == WALK)
    metrics = {name: evaluation.metrics[name].value for name in ("system_mass", "mass")}
    return metrics | {
        "mission": minutes * MINUTE,
        "status": found.status,
        "values": {variable.path: variable.value for variable in found.variables},
        "energy": study.energies["supply_energy"],
        "leakage": study.energies["leakage_energy"],
    }


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    rows: list[Data] = []
    for minutes in QUICK if quick else MISSIONS:
        rows.append(row(minutes, rows[-1]["values"] if rows else None))
    return rounded({"version": ao.__version__, "rows": rows})


def table_rows(study: Data) -> list[list[str]]:
    """Heads and rows of all optima, the shortest mission first."""
    heads = ["mission, min", "system, kg", "knee, g", "pressure, bar", "bore, mm", "crank, mm"]
    rows = [[*heads, "valve, l/min", "stride, J", "of it leakage, J", "status"]]
    for entry in sorted(study["rows"], key=lambda entry: float(entry["mission"])):
        values = entry["values"]
        rows.append(
            [
                fixed(entry["mission"] / MINUTE, 0),
                fixed(entry["system_mass"], 3),
                fixed(1e3 * entry["mass"], 1),
                fixed(values["supply.pressure"] / BAR, 1),
                fixed(1e3 * values["cylinder.bore"], 2),
                fixed(1e3 * values["linkage.crank_radius"], 1),
                fixed(6e4 * values["valve.rated_flow"], 2),
                fixed(entry["energy"], 1),
                fixed(entry["leakage"], 1),
                entry["status"],
            ]
        )
    return rows


def lead(study: Data) -> list[str]:
    """Sentences on what a longer mission changes, and why."""
    rows = sorted(study["rows"], key=lambda entry: float(entry["mission"]))
    first, last = rows[0], rows[-1]
    said = [
        "The mass of the source is mean power times mission time over its specific energy. A"
        " longer mission gives the energy of a stride more weight, the mass of the knee less.",
        "Without leakage, a stride takes pressure times swept volume, whatever the load. The"
        " largest force fixes pressure times area. So energy hardly depends on pressure itself.",
    ]
    if first is not last:
        low, high = (entry["values"]["supply.pressure"] / BAR for entry in (first, last))
        times = [fixed(entry["mission"] / MINUTE, 0) for entry in (first, last)]
        masses = [fixed(1e3 * entry["mass"], 0) for entry in (first, last)]
        said.append(
            f"From {times[0]} to {times[1]} min"
            f" the pressure goes from {fixed(low, 1)} to {fixed(high, 1)} bar, the knee from"
            f" {masses[0]} to {masses[1]} g, and a stride from"
            f" {fixed(first['energy'], 0)} to {fixed(last['energy'], 0)} J."
        )
    return said


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets."""
    note = "Each row is an optimum of its own. Specific masses: assumptions of knee_walking.yaml."
    return study_report(
        __file__,
        study,
        title="Pressure level and mission",
        heading="Supply pressure of a walking robot, and the length of its mission",
        lead=lead(study),
        blocks=[grid_table("Optima", table_rows(study), note, words=[-1])],
    )


def printed(study: Data) -> str:
    """The table, and the sentences on the result."""
    rows = table_rows(study)
    return "\n".join([aligned(rows, right=range(len(rows[0]) - 1)), "", *lead(study)])


def main() -> None:
    """Print the table; write the report if a folder is named."""
    description = "supply pressure of least system mass, for missions of different length"
    print(run_script(__file__, description, compute, printed, page, quick="one mission"))


if __name__ == "__main__":
    main()
