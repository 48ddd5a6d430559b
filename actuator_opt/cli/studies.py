"""Commands that study a single design: `uncertainty`, `seal` and `simulate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..base.errors import Diagnostic, ExitCode, UsageError
from ..base.files import require_apart
from ..base.quantities import INPUTS
from .job import COMMON, CommonOptions, Job, with_common_options
from .options import (
    REPORTS,
    AllPages,
    Date,
    DesignFile,
    Format,
    Json,
    Out,
    Quiet,
    Report,
    Scheduler,
    Set,
    Units,
    Unset,
    UnusedSeed,
    file_of_units,
    named_columns,
    quantity_of,
)

Draws = Annotated[
    int,
    typer.Option("-n", "--samples", metavar="N", help="Number of random draws, 20 to 10 million."),
]
Quasi = Annotated[
    bool,
    typer.Option(
        "--quasi",
        help=(
            "Use 16 scrambled Sobol sequences, which give a narrower confidence interval of "
            "the yield."
        ),
    ),
]
Rows = Annotated[
    int,
    typer.Option(
        "--index-rows",
        min=0,
        max=1_000_000,
        metavar="N",
        help=(
            "Size of the base sample for the sensitivity indices; each of its rows takes "
            "(number of inputs + 2) evaluations. 0: no indices."
        ),
    ),
]
Metrics = Annotated[
    list[str] | None,
    typer.Option(
        "--metric",
        metavar="METRIC",
        help="Metric to analyse besides the margins of all limits; default: the objective. "
        "Repeatable.",
    ),
]


@with_common_options
def uncertainty(
    design: DesignFile,
    count: Draws = 10_000,
    quasi: Quasi = False,
    rows: Rows = 1024,
    metric: Metrics = None,
    scheduler: Scheduler = None,
    csv: Annotated[
        Path | None,
        typer.Option(
            "--csv", metavar="FILE", help="Save inputs, margins and verdict of every draw."
        ),
    ] = None,
    common: CommonOptions = COMMON,
) -> ExitCode:
    """Production yield under scatter, Sobol indices, tornado."""
    from .. import api as verbs

    job = common.job(design, csv=csv)
    study = job.run(
        verbs.uncertainty,
        count=count,
        seed=common.seed,
        quasi_random=quasi,
        rows=rows,
        metrics=metric or [],
        scheduler=scheduler,
    )
    return job.deliver(study)


SealPlace = Annotated[
    str, typer.Option("--seal", metavar="piston|rod", help="The seal to analyse.")
]
Speed = Annotated[
    str | None,
    typer.Option(
        "--speed",
        metavar="V",
        help='Sliding speed, e.g. "0.1 m/s"; default: that of the moving load case with the '
        "highest pressure.",
    ),
]
Pressure = Annotated[
    str | None,
    typer.Option(
        "--pressure",
        metavar="P",
        help='Sealed pressure, e.g. "60 bar"; default: the highest of the moving load cases.',
    ),
]
Mapped = Annotated[
    bool,
    typer.Option(
        "--map",
        help="Also compute the results over a grid of speeds and pressures; write a map and CSV.",
    ),
]
FiniteElements = Annotated[
    bool,
    typer.Option(
        "--finite-elements",
        help="Compute the contact of an O-ring or step ring by finite elements (extra fem; takes "
        "seconds).",
    ),
]
ContactDesign = Annotated[
    Path | None,
    typer.Option(
        "--write", metavar="FILE", help="Save the design with the computed contact profiles."
    ),
]


@with_common_options
def seal(
    design: DesignFile,
    place: SealPlace,
    speed: Speed = None,
    pressure: Pressure = None,
    mapped: Mapped = False,
    finite_elements: FiniteElements = False,
    write: ContactDesign = None,
    common: CommonOptions = COMMON,
) -> ExitCode:
    """Analyse contact, oil film, friction and leakage of a seal."""
    from .. import api as verbs

    if place not in ("piston", "rod"):
        raise UsageError(Diagnostic(f'--seal "{place}"', "write piston or rod"))
    job = common.job(
        design, write=write, report=common.report or mapped, paper={"sheet": common.report}
    )
    study = job.run(
        verbs.seal,
        place=place,
        speed=quantity_of("--speed", speed, INPUTS["speed"]),
        pressure=quantity_of("--pressure", pressure, INPUTS["pressure"]),
        mapped=mapped,
        curves=common.report,
        finite_elements=finite_elements,
    )
    if write is not None:
        verbs.save(verbs.with_contact(job.actuator, study), write)
    return job.deliver(study, saved=[write])


ScenarioFile = Annotated[
    str,
    typer.Argument(
        metavar="SCENARIO", help="Scenario file, or - for stdin; with --cycle, a design file."
    ),
]
CycleName = Annotated[
    str | None,
    typer.Option(
        "--cycle",
        metavar="NAME",
        help="Simulate this duty cycle of a design, and compare with its quasi-static results.",
    ),
]
Periods = Annotated[
    int | None,
    typer.Option(
        "--periods", min=1, max=100, metavar="N", help="Periods of the duty cycle (default 3)."
    ),
]
Verify = Annotated[
    bool,
    typer.Option(
        "--verify",
        help="Integrate again by the Radau method; show the largest difference of the results.",
    ),
]
SignalsFile = Annotated[
    Path | None, typer.Option("--csv", metavar="FILE", help="Save every signal over time.")
]
MeasuredFile = Annotated[
    str | None,
    typer.Option(
        "--measured", metavar="F.csv", help="Compare with a test record and show the residuals."
    ),
]
Fitted = Annotated[
    list[str] | None,
    typer.Option(
        "--fit",
        metavar="NAME",
        help="Fit a parameter to the record, with its confidence interval (e.g. "
        "air_content, valve_capacity, piston_leakage, coulomb). Repeatable.",
    ),
]
RecordColumns = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="CHANNEL=NAME",
        help="Header of the column with a channel (t, p1, p2, x, v, F_L, U, spool, pS, qA, qB, "
        'n_shaft, phi), e.g. "p1=Channel 3 [bar]". Repeatable.',
    ),
]
Margins = Annotated[
    bool,
    typer.Option(
        "--margins",
        help="Compute gain and phase margin even if the gain is stated (a report contains them).",
    ),
]
Explain = Annotated[
    bool,
    typer.Option(
        "--explain",
        help="Print the values of the equations too, each with its origin (report and JSON "
        "contain them).",
    ),
]
Sensitivity = Annotated[
    bool,
    typer.Option("--sensitivity", help="Rank the parameters by their effect on the results."),
]


def simulate(
    scenario: ScenarioFile,
    sets: Set = None,
    unset: Unset = None,
    cycle: CycleName = None,
    periods: Periods = None,
    csv: SignalsFile = None,
    verify: Verify = False,
    margins: Margins = False,
    measured: MeasuredFile = None,
    fit: Fitted = None,
    columns: RecordColumns = None,
    units: Units = None,
    sensitivity: Sensitivity = False,
    explain: Explain = False,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    all_pages: AllPages = False,
    format: Format = "pdf",
    as_json: Json = False,
    quiet: Quiet = False,
    seed: UnusedSeed = 0,
) -> ExitCode:
    """Simulate a scenario, or a duty cycle of a design."""
    from .. import api as verbs

    for name, values in (("--fit", fit), ("--column", columns)):
        if values and measured is None:
            raise UsageError(Diagnostic(f"{name}: only with --measured", "name the record"))
    if periods is not None and cycle is None:
        raise UsageError(Diagnostic("--periods: only with --cycle", "name the duty cycle"))
    job = Job(
        scenario, [*filter(None, [measured]), *file_of_units(units)], sets=sets, unset=unset,
        csv=csv, report=report, out=out, date=date, all_pages=all_pages, format=format,
        as_json=as_json, quiet=quiet,
    )  # fmt: skip
    if cycle is None:
        trial = verbs.read_scenario(scenario, set=job.set, units=units)
    else:
        trial = verbs.cycle_scenario(scenario, cycle, periods=periods or 3, set=job.set)
    if units is not None and measured is None and not trial.records:
        raise UsageError(Diagnostic("--units: only with a record", "remove it"))
    if csv is not None:
        require_apart(csv, *map(str, trial.files))
    job.paper["scenario"] = trial
    options: dict[str, Any] = {"verify": verify, "margins": margins}
    if measured is None:
        compared, simulation = None, job.run(verbs.simulate, trial, **options)
    else:
        options |= {"fit": fit or (), "columns": named_columns(columns), "units": units}
        compared = job.run(verbs.compare_measured, trial, measured, **options)
        simulation = compared.simulation
    sensitivities = job.run(verbs.servo_sensitivities, trial) if sensitivity else None
    details = [simulation.basis] if explain else []
    return job.deliver(simulation, details=details, measured=compared, sensitivities=sensitivities)
