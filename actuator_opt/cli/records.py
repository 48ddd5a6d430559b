"""The commands `identify` and `calibrate`: what a test bench measured, and what it changes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import Diagnostic, ExitCode, UsageError
from ..quantities import RECORDS
from ..store import require_apart
from . import streams
from .options import REPORTS, Date, Json, Out, PluginFile, Quiet, Report, Seed, Set, Units
from .shared import (
    check_targets,
    command_line,
    file_of_units,
    given,
    named_columns,
    read_actuator,
    say_files,
)

if TYPE_CHECKING:
    from ..identification.specimen import Part
    from ..verbs import Actuator

RecordFile = Annotated[
    str, typer.Argument(metavar="RECORD", help="CSV file of the test record, or - for stdin.")
]
Tested = Annotated[
    str, typer.Option("--design", metavar="DESIGN", help="Design file of the actuator tested.")
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="CHANNEL=NAME",
        help='Column of a channel (t, p1, p2, x, v, F_L, T, w), e.g. "p1=Channel 3 [bar]". '
        "Repeatable.",
    ),
]
Cutoff = Annotated[
    str | None,
    typer.Option(
        "--cutoff", metavar="F", help='Cut-off of the zero-phase filter; default: "30 Hz".'
    ),
]
Order = Annotated[
    int | None,
    typer.Option(
        "--order", min=1, max=10, metavar="N", help="Order of each of its two passes; default: 4."
    ),
]
Uncompensated = Annotated[
    bool,
    typer.Option("--uncompensated", help="Let both passes be -6 dB at the cut-off, not -3 dB."),
]
Mass = Annotated[
    str | None,
    typer.Option(
        "--mass", metavar="M", help='Moving mass, e.g. "1.2 kg"; default: rod, piston (and load).'
    ),
]
LoadForce = Annotated[
    str | None,
    typer.Option(
        "--load-force",
        metavar="F",
        help='Load where no channel F_L measures it, e.g. "0 N" for a free rod.',
    ),
]
PressureLag = Annotated[
    str | None,
    typer.Option(
        "--pressure-lag",
        metavar="T",
        help='Lag of the pressures, e.g. "4 ms"; default: found by the reversals.',
    ),
]
Bootstrap = Annotated[
    int,
    typer.Option(
        "--bootstrap",
        min=0,
        max=10000,
        metavar="N",
        help="Bounds from N resampled records (80 or more) instead of the linearised model.",
    ),
]


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
    csv: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="Save friction, stiffness, growth over time."),
    ] = None,
    span: Annotated[
        str | None,
        typer.Option(
            "--span",
            metavar="L",
            help='Span of a bending test (channels F_L, w), e.g. "300 mm": gives a modulus.',
        ),
    ] = None,
    part: Annotated[
        str | None,
        typer.Option("--part", metavar="rod|barrel", help="What was bent; default: rod."),
    ] = None,
    sets: Set = None,
    plugin: PluginFile = None,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Friction and damping from a test record, with bounds."""
    from .. import verbs

    check_targets(out if report else None, date, csv)
    if csv is not None:
        require_apart(csv, record, design, *file_of_units(units))
    _check_bootstrap(bootstrap)
    named = named_columns(columns)
    length = given("--span", span, RECORDS["span"])
    settings = _settings(cutoff, order, uncompensated, mass, load_force, pressure_lag)
    actuator = read_actuator(design, sets, plugin)
    if length is None and part is not None:
        raise UsageError(Diagnostic("--part: only with --span", "add --span, or leave it out"))
    if length is not None:
        others = {"--report": report or None, "--csv": csv, "--bootstrap": bootstrap or None}
        _only_bending(others | {_OPTIONS[name]: one for name, one in settings.items()})
        _bend(record, actuator, length, part or "rod", named, units, as_json=as_json, quiet=quiet)
        return
    found = verbs.identify(
        record,
        design=actuator,
        columns=named,
        units=units,
        bootstrap=bootstrap,
        seed=seed,
        **settings,
    )
    files = []
    if csv is not None:
        files.append(verbs.write_series(found, csv).to_dict())
    if report:
        files += [
            file.to_dict()
            for file in verbs.write_identification(
                found, folder=out, actuator=actuator, command=command_line(), date=date
            )
        ]
    if as_json:
        streams.out_json(found.to_dict() | ({"files": files} if files else {}))
    elif not quiet:
        from ..reporting.identification_text import identification_text

        streams.out(identification_text(found, **streams.style()), end="")
        say_files(files)


def calibrate(
    record: RecordFile,
    design: Tested,
    write: Annotated[
        Path | None,
        typer.Option("--write", metavar="FILE", help="Save the design with the measured values."),
    ] = None,
    columns: Columns = None,
    units: Units = None,
    cutoff: Cutoff = None,
    order: Order = None,
    uncompensated: Uncompensated = False,
    mass: Mass = None,
    load_force: LoadForce = None,
    pressure_lag: PressureLag = None,
    bootstrap: Bootstrap = 0,
    search: Annotated[
        bool,
        typer.Option(
            "--optimise/--no-optimise", help="Also find the best design before and after."
        ),
    ] = True,
    sets: Set = None,
    plugin: PluginFile = None,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Put a record's friction into its design; say what changes."""
    from .. import verbs

    check_targets(out if report else None, date, write)
    if write is not None:
        require_apart(write, record, *file_of_units(units))
    _check_bootstrap(bootstrap)
    settings = _settings(cutoff, order, uncompensated, mass, load_force, pressure_lag)
    actuator = read_actuator(design, sets, plugin)
    found = verbs.calibrate(
        record,
        design=actuator,
        columns=named_columns(columns),
        units=units,
        search=search,
        bootstrap=bootstrap,
        seed=seed,
        **settings,
    )
    files: list[dict[str, Any]] = []
    if write is not None:
        files.append({"path": str(verbs.save(found.actuator, write))})
    if report:
        files += [
            file.to_dict()
            for file in verbs.write_calibration(
                found, folder=out, command=command_line(), date=date
            )
        ]
    if as_json:
        streams.out_json(found.to_dict() | ({"files": files} if files else {}))
    elif not quiet:
        from ..reporting.calibration_text import calibration_text

        streams.out(calibration_text(found.calibration, found.redesign, **streams.style()), end="")
        say_files(files)
    if not found.redesign.evaluation.met:
        raise typer.Exit(ExitCode.MISSED)


def _bend(
    record: str,
    actuator: Actuator,
    span: float,
    part: str,
    columns: dict[str, str],
    units: str | None,
    *,
    as_json: bool,
    quiet: bool,
) -> None:
    """A bending test to a modulus."""
    from .. import verbs

    if part not in ("rod", "barrel"):
        raise UsageError(Diagnostic(f'--part "{part}"', "write rod or barrel"))
    own: Part = part  # type: ignore[assignment]
    found = verbs.bending(
        record, design=actuator, span=span, part=own, columns=columns, units=units
    )
    if as_json:
        streams.out_json(found.to_dict())
    elif not quiet:
        from ..reporting.bending_text import bending_text

        streams.out(bending_text(found, **streams.style()), end="")


def _only_bending(asked: Mapping[str, object]) -> None:
    """Refuse options that a bending test has no use for."""
    options = [name for name, one in asked.items() if one is not None]
    if options:
        message = f"{', '.join(options)}: not with --span, a bending test gives a modulus alone"
        raise UsageError(Diagnostic(message, "leave out --span, or these"))


def _check_bootstrap(count: int) -> None:
    from ..identification.bootstrap import FEWEST

    if 0 < count < FEWEST:
        message = f"--bootstrap {count}: too few to have a tail of 2.5 %"
        raise UsageError(Diagnostic(message, f"take {FEWEST} or more, 200 as a rule"))


_OPTIONS = {
    "cutoff": "--cutoff",
    "order": "--order",
    "compensated": "--uncompensated",
    "mass": "--mass",
    "load_force": "--load-force",
    "pressure_lag": "--pressure-lag",
}
"""Options of the settings by their name."""


def _settings(
    cutoff: str | None,
    order: int | None,
    uncompensated: bool,
    mass: str | None,
    load_force: str | None,
    pressure_lag: str | None,
) -> dict[str, Any]:
    """How a record is read, SI: what was stated."""
    found = {
        "cutoff": given("--cutoff", cutoff, RECORDS["cutoff"]),
        "order": order,
        "compensated": False if uncompensated else None,
        "mass": given("--mass", mass, RECORDS["moving_mass"]),
        "load_force": given("--load-force", load_force, RECORDS["load_force"]),
        "pressure_lag": given("--pressure-lag", pressure_lag, RECORDS["pressure_lag"]),
    }
    return {name: one for name, one in found.items() if one is not None}
