"""Commands for test-bench records: `identify` and `calibrate`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..base.errors import Diagnostic, ExitCode, UsageError
from ..base.quantities import RECORDS
from .job import COMMON, CommonOptions, with_common_options
from .options import (
    Units,
    file_of_units,
    named_columns,
    quantity_of,
)

RecordFile = Annotated[
    str, typer.Argument(metavar="RECORD", help="CSV file of the test record, or - for stdin.")
]
Tested = Annotated[
    str, typer.Option("--design", metavar="DESIGN", help="Design file of the tested actuator.")
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="CHANNEL=NAME",
        help="Header of the column with a channel (t, p1, p2, x, v, F_L, T, w), "
        'e.g. "p1=Channel 3 [bar]". Repeatable.',
    ),
]
Cutoff = Annotated[
    str | None,
    typer.Option(
        "--cutoff",
        metavar="F",
        help='Cut-off frequency of the zero-phase filter; default: "30 Hz".',
    ),
]
Order = Annotated[
    int | None,
    typer.Option(
        "--order", min=1, max=10, metavar="N", help="Order of each filter pass; default: 4."
    ),
]
Uncompensated = Annotated[
    bool,
    typer.Option(
        "--uncompensated",
        help="Let each of the two filter passes have -3 dB at the cut-off (together -6 dB).",
    ),
]
Mass = Annotated[
    str | None,
    typer.Option(
        "--mass", metavar="M", help='Moving mass, e.g. "1.2 kg"; default: that of the design.'
    ),
]
LoadForce = Annotated[
    str | None,
    typer.Option(
        "--load-force",
        metavar="F",
        help='Load force if the record has no channel F_L, e.g. "0 N" for a free rod.',
    ),
]
PressureLag = Annotated[
    str | None,
    typer.Option(
        "--pressure-lag",
        metavar="T",
        help='Delay of the pressure signals, e.g. "4 ms"; default: from the reversals of motion.',
    ),
]
Bootstrap = Annotated[
    int,
    typer.Option(
        "--bootstrap",
        min=0,
        max=10000,
        metavar="N",
        help=(
            "Compute confidence intervals from N resampled records (80 or more) instead of "
            "the linearised model."
        ),
    ),
]

Series = Annotated[
    Path | None,
    typer.Option(
        "--csv", metavar="FILE", help="Save friction, stiffness and bore growth versus time."
    ),
]
Span = Annotated[
    str | None,
    typer.Option(
        "--span",
        metavar="L",
        help=(
            'Span of a three-point bending test, e.g. "300 mm"; the record (channels F_L, '
            "w) then gives the modulus of a part."
        ),
    ),
]
BentPart = Annotated[
    str | None,
    typer.Option("--part", metavar="rod|barrel", help="Part in the bending test; default: rod."),
]
NewDesign = Annotated[
    Path | None,
    typer.Option("--write", metavar="FILE", help="Save the design with the measured values."),
]
Search = Annotated[
    bool,
    typer.Option(
        "--optimise/--no-optimise",
        help="Also optimise the design twice: with its stated and with the measured values.",
    ),
]


@with_common_options
def identify(
    record: RecordFile,
    design: Tested,
    columns: Columns = None,
    units: Units = None,
    cutoff: Cutoff = None,
    order: Order = None,
    uncompensated: Uncompensated = False,
    mass: Mass = None,
    load_force: LoadForce = None,
    pressure_lag: PressureLag = None,
    bootstrap: Bootstrap = 0,
    csv: Series = None,
    span: Span = None,
    part: BentPart = None,
    common: CommonOptions = COMMON,
) -> ExitCode:
    """Identify friction and damping from a test record."""
    from .. import api as verbs

    job = common.job(design, [record, *file_of_units(units)], csv=csv)
    _check_bootstrap(bootstrap)
    reading: dict[str, Any] = {"columns": named_columns(columns), "units": units}
    length = quantity_of("--span", span, RECORDS["span"])
    settings = _settings(cutoff, order, uncompensated, mass, load_force, pressure_lag)
    if length is None:
        if part is not None:
            raise UsageError(Diagnostic("--part: only with --span", "add --span, or remove --part"))
        settings |= {"bootstrap": bootstrap, "seed": common.seed, **reading}
        return job.deliver(job.run(verbs.identify, record, design=job.actuator, **settings))
    options = {"--report": common.report or None, "--csv": csv, "--bootstrap": bootstrap or None}
    _only_bending(options | {_OPTIONS[name]: value for name, value in settings.items()})
    if part not in (None, "rod", "barrel"):
        raise UsageError(Diagnostic(f'--part "{part}"', "write rod or barrel"))
    reading |= {"span": length, "part": part or "rod"}
    return job.deliver(job.run(verbs.bending, record, design=job.actuator, **reading))


@with_common_options
def calibrate(
    record: RecordFile,
    design: Tested,
    write: NewDesign = None,
    columns: Columns = None,
    units: Units = None,
    cutoff: Cutoff = None,
    order: Order = None,
    uncompensated: Uncompensated = False,
    mass: Mass = None,
    load_force: LoadForce = None,
    pressure_lag: PressureLag = None,
    bootstrap: Bootstrap = 0,
    search: Search = True,
    common: CommonOptions = COMMON,
) -> ExitCode:
    """Update a design with the friction measured in a test."""
    from .. import api as verbs

    job = common.job(design, [record, *file_of_units(units)], write=write)
    _check_bootstrap(bootstrap)
    settings = _settings(cutoff, order, uncompensated, mass, load_force, pressure_lag)
    calibrated = job.run(
        verbs.calibrate,
        record,
        design=job.actuator,
        columns=named_columns(columns),
        units=units,
        search=search,
        bootstrap=bootstrap,
        seed=common.seed,
        **settings,
    )
    saved = [] if write is None else [{"path": str(verbs.save(calibrated.actuator, write))}]
    return job.deliver(calibrated, files=saved)


def _only_bending(options: Mapping[str, object]) -> None:
    """Refuse options that a bending test does not use."""
    unused = [name for name, value in options.items() if value is not None]
    if unused:
        message = (
            f"{', '.join(unused)}: not with --span, because a bending test only gives a modulus"
        )
        raise UsageError(Diagnostic(message, "remove --span, or these options"))


def _check_bootstrap(count: int) -> None:
    from ..identification.bootstrap import FEWEST

    if 0 < count < FEWEST:
        message = f"--bootstrap {count}: too few for the limits of a 95 % interval"
        raise UsageError(Diagnostic(message, f"use {FEWEST} or more, usually 200"))


_OPTIONS = {
    "cutoff": "--cutoff",
    "order": "--order",
    "compensated": "--uncompensated",
    "mass": "--mass",
    "load_force": "--load-force",
    "pressure_lag": "--pressure-lag",
}
"""Command-line option of each setting."""


def _settings(
    cutoff: str | None,
    order: int | None,
    uncompensated: bool,
    mass: str | None,
    load_force: str | None,
    pressure_lag: str | None,
) -> dict[str, Any]:
    """Settings of the identification that the options state, SI."""
    settings = {
        "cutoff": quantity_of("--cutoff", cutoff, RECORDS["cutoff"]),
        "order": order,
        "compensated": False if uncompensated else None,
        "mass": quantity_of("--mass", mass, RECORDS["moving_mass"]),
        "load_force": quantity_of("--load-force", load_force, RECORDS["load_force"]),
        "pressure_lag": quantity_of("--pressure-lag", pressure_lag, RECORDS["pressure_lag"]),
    }
    return {name: value for name, value in settings.items() if value is not None}
