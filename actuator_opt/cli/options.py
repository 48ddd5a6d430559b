"""Options that several commands share, with their help."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..base.bounds import SEED, STARTS
from ..base.errors import Diagnostic, UsageError, shown
from . import completion

if TYPE_CHECKING:
    from ..base.quantities import Quantity

DesignFile = Annotated[str, typer.Argument(metavar="DESIGN", help="Design file, or - for stdin.")]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        autocompletion=completion.stated,
        help='Replace a value, e.g. "cylinder.bore=30 mm"; a bare number is SI. Repeatable.',
    ),
]
Unset = Annotated[
    list[str] | None,
    typer.Option(
        "--unset",
        metavar="PATH",
        autocompletion=completion.unset,
        help="Remove a key or block of the file, before --set. Repeatable.",
    ),
]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for reports.")]
Seed = Annotated[
    int,
    typer.Option(
        "--seed",
        min=SEED.least,
        max=SEED.most,
        metavar="N",
        help="Random seed; the same seed gives the same result.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object (SI) to stdout.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")]
Verbose = Annotated[
    bool, typer.Option("--verbose", "-v", help="Print everything, not only the summary.")
]
PluginFile = Annotated[
    list[Path] | None,
    typer.Option(
        "--plugin", metavar="FILE.py", help="Python file with your own metrics. Repeatable."
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Run on this Dask cluster instead."),
]
Date = Annotated[
    str | None,
    typer.Option(
        "--date",
        metavar="YYYY-MM-DD",
        help="Date on the report; default: none, or SOURCE_DATE_EPOCH.",
    ),
]
Units = Annotated[
    str | None,
    typer.Option(
        "--units",
        metavar="SI|FILE",
        help="Units of columns without a unit in their header: SI (m, s, Pa, N, m/s, K), or a file "
        'with a line "p1: bar" (YAML) or "p1,bar" (CSV) for each column.',
    ),
]
Algorithm = Annotated[
    str,
    typer.Option(
        "--algorithm", metavar="NAME", help="auto, or an NLopt algorithm such as LD_SLSQP."
    ),
]
Starts = Annotated[
    int,
    typer.Option(
        "--starts",
        min=STARTS.least,
        max=STARTS.most,
        metavar="N",
        help="Number of local searches from different points.",
    ),
]
Write = Annotated[
    Path | None,
    typer.Option("--write", metavar="FILE", help="Save the best design to this file."),
]
WholePlies = Annotated[
    bool,
    typer.Option(
        "--whole-plies",
        help="Also find the best design with whole plies and allowed angles; --write saves it.",
    ),
]
StandardSizes = Annotated[
    bool,
    typer.Option(
        "--standard-sizes",
        help="Also find the best design with bore and rod sizes of ISO 3320, whole plies and "
        "allowed angles.",
    ),
]
Shop = Annotated[
    bool,
    typer.Option(
        "--shop",
        help="Also find the best design in steps of 0.1 mm, 1 deg and 1 % squeeze; --write saves "
        "it for drawings.",
    ),
]
Certify = Annotated[
    bool,
    typer.Option(
        "--certify",
        help="Prove how close the result is to the best possible design (takes seconds).",
    ),
]


def share(text: str) -> float:
    """A share as a number or in per cent.

    >>> share("0.99"), share("99 %")
    (0.99, 0.99)
    """
    number, per_cent, rest = text.strip().partition("%")
    try:
        if rest:
            raise ValueError
        return float(number) / (100 if per_cent else 1)
    except ValueError:
        message = f'"{shown(text)}" is not a share; write e.g. 0.99 or "99 %"'
        raise typer.BadParameter(message) from None


Yield = Annotated[
    float | None,
    typer.Option(
        "--yield",
        parser=share,
        metavar="P",
        help="Required probability of meeting all limits under scatter, e.g. 0.99.",
    ),
]
VerifyDynamics = Annotated[
    str | None,
    typer.Option(
        "--verify-dynamics",
        metavar="SCENARIO",
        help="Verify the best design by simulation of this scenario.",
    ),
]
Seconds = Annotated[
    float | None,
    typer.Option(
        "--max-seconds",
        min=0.0,
        metavar="N",
        help="Stop the search after this time and keep the best design so far.",
    ),
]
NoRecord = Annotated[
    bool, typer.Option("--no-record", help="Do not record the run (see: runs list).")
]
Report = Annotated[bool, typer.Option("--report", help="Write the report (PDF and PNG) too.")]
AllPages = Annotated[
    bool,
    typer.Option("--all-pages", help="Write an image (PNG) of every sheet, not only the first."),
]
Format = Annotated[
    str,
    typer.Option(
        "--format",
        metavar="FORMAT",
        help="Format of the report: pdf (with PNG), html (needs no network), or both.",
    ),
]
AttachStudio = Annotated[
    bool,
    typer.Option(
        "--attach-studio",
        help="Attach to the PDF a page on which limits of this design are dragged; it needs no "
        "network.",
    ),
]
REPORTS = Path("reports")
UnusedOut = Annotated[Path, typer.Option("--out", hidden=True)]
UnusedSeed = Annotated[int, typer.Option("--seed", hidden=True)]
"""Options that every command for designs takes, for commands on which they have no effect."""


def quantity_of(option: str, text: str | None, quantity: Quantity) -> float | None:
    """Convert an option's text, with a unit of its quantity, to SI."""
    from ..design.kinds import ValueFault, read_quantity

    if text is None:
        return None
    try:
        return read_quantity(text, quantity)
    except ValueFault as fault:
        raise UsageError(Diagnostic(f"{option}: {fault.message}", fault.remedy)) from None


def named_columns(texts: list[str] | None) -> dict[str, str]:
    """Map every channel that a ``--column`` option names to the header of its column."""
    columns: dict[str, str] = {}
    for text in texts or []:
        channel, equals, name = text.partition("=")
        if not equals or not channel.strip() or not name.strip():
            message = f'--column "{text}" is not CHANNEL=NAME'
            raise UsageError(Diagnostic(message, 'write e.g. "p1=Channel 3 [bar]"'))
        columns[channel.strip()] = name.strip()
    return columns


def file_of_units(units: str | None) -> list[str]:
    """The file of ``--units``, if it names a file."""
    if units is None:
        return []
    from ..identification.column_units import SI

    return [] if units == SI else [units]
