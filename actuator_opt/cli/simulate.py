"""The command `simulate`: a scenario around a design over time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import Diagnostic, ExitCode, UsageError
from ..store import require_apart
from . import streams
from .options import REPORTS, Date, Json, Out, Quiet, Report, Set, Units
from .shared import (
    assignments,
    check_targets,
    command_line,
    file_of_units,
    named_columns,
    say_files,
)

if TYPE_CHECKING:
    from ..simulation import Simulation
    from ..simulation.methods import Method
    from ..simulation.sensitivity import Sensitivities
    from ..verbs import Compared

ScenarioFile = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="Scenario file, or - for stdin.")
]
Verify = Annotated[
    bool,
    typer.Option("--verify", help="Integrate again by Radau and tell the largest difference."),
]
Fast = Annotated[
    bool, typer.Option("--fast", help='Integrate by CVODES (pip install "actuator-opt[fast]").')
]
Csv = Annotated[
    Path | None, typer.Option("--csv", metavar="FILE", help="Save every signal over time.")
]
MeasuredFile = Annotated[
    str | None,
    typer.Option("--measured", metavar="F.csv", help="Overlay a record, with its residuals."),
]
Fitted = Annotated[
    list[str] | None,
    typer.Option(
        "--fit",
        metavar="NAME",
        help="Fit a parameter to the record, with bounds (e.g. air_content, valve_capacity, "
        "piston_leakage, coulomb). Repeatable.",
    ),
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="CHANNEL=NAME",
        help='Column of a channel of the record (t, p1, x, U, ...), e.g. "p1=Channel 3 [bar]". '
        "Repeatable.",
    ),
]
Sensitivity = Annotated[
    bool,
    typer.Option("--sensitivity", help="Rank the parameters by what they change in the results."),
]


def simulate(
    scenario: ScenarioFile,
    sets: Set = None,
    csv: Csv = None,
    verify: Verify = False,
    fast: Fast = False,
    measured: MeasuredFile = None,
    fit: Fitted = None,
    columns: Columns = None,
    units: Units = None,
    sensitivity: Sensitivity = False,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    as_json: Json = False,
    quiet: Quiet = False,
    seed: Annotated[int, typer.Option("--seed", hidden=True)] = 0,
) -> None:
    """A scenario over time: servo, pressures, energy."""
    from .. import verbs

    check_targets(out if report else None, date, csv)
    for name, given in (("--fit", fit), ("--column", columns)):
        if given and measured is None:
            raise UsageError(Diagnostic(f"{name}: only with --measured", "name the record"))
    if csv is not None:
        beside = [measured] if measured else []
        require_apart(csv, scenario, *beside, *file_of_units(units))
    trial = verbs.read_scenario(scenario, set=assignments(sets), units=units)
    if units is not None and measured is None and not trial.records:
        raise UsageError(Diagnostic("--units: no record is read", "leave it out"))
    if csv is not None:
        require_apart(csv, *map(str, trial.files))
    method: Method = "cvodes" if fast else "lsoda"
    overlay = None
    with streams.watching():
        if measured is None:
            found = verbs.simulate(trial, verify=verify, method=method)
        else:
            overlay = verbs.compare_measured(
                trial, measured, fit=fit or (), columns=named_columns(columns),
                units=units, verify=verify, method=method,
            )  # fmt: skip
            found = overlay.simulation
        ranked = verbs.servo_sensitivities(trial) if sensitivity else None
    files = [] if csv is None else [verbs.write_signals(found, csv)]
    if report:
        files += verbs.write_simulation(
            found, trial, measured=overlay, sensitivities=ranked,
            folder=out, command=command_line(), date=date,
        )  # fmt: skip
    written = [file.to_dict() for file in files]
    if as_json:
        streams.out_json(_as_json(found, overlay, ranked, written))
    elif not quiet:
        _say(found, overlay, ranked)
        say_files(written)
    if not found.met:
        raise typer.Exit(ExitCode.MISSED)


def _as_json(
    found: Simulation,
    overlay: Compared | None,
    ranked: Sensitivities | None,
    files: list[dict[str, Any]],
) -> dict[str, Any]:
    """Signals and figures, what a record says of them, and the files written."""
    more = {
        "measured": None if overlay is None else overlay.to_dict(),
        "sensitivities": None if ranked is None else ranked.to_dict(),
        "files": files or None,
    }
    return found.to_dict() | {name: one for name, one in more.items() if one is not None}


def _say(found: Simulation, overlay: Compared | None, ranked: Sensitivities | None) -> None:
    """Everything on the terminal."""
    from ..reporting.simulation_text import simulation_text

    style = streams.style()
    parts = [simulation_text(found, **style)]
    if overlay is not None:
        from ..reporting.measured_rows import measured_text

        parts.append(measured_text(overlay.overlay, overlay.fit, **style))
    if ranked is not None:
        from ..reporting.verification_text import sensitivity_text

        parts.append(sensitivity_text(ranked, **style))
    streams.out("\n".join(parts), end="")
