"""Optimisation commands: `optimise`, `sensitivity` and `pareto`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..base.bounds import CHECKS
from ..base.errors import Diagnostic, ExitCode
from . import completion
from .job import COMMON, CommonOptions, Job, with_common_options
from .options import (
    REPORTS,
    Algorithm,
    AllPages,
    AttachStudio,
    Certify,
    Date,
    DesignFile,
    Format,
    Json,
    NoRecord,
    Out,
    PluginFile,
    Quiet,
    Scheduler,
    Seconds,
    Seed,
    Set,
    Shop,
    StandardSizes,
    Starts,
    Unset,
    Verbose,
    VerifyDynamics,
    WholePlies,
    Write,
    Yield,
)

if TYPE_CHECKING:
    from ..api import Actuator, Trial
    from ..optimisation.result import Optimisation


RelaxSafety = Annotated[
    bool, typer.Option("--relax-safety", help="If nothing fits, offer lower safety factors, too.")
]
ChoiceScheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Solve combinations of choices on this Dask cluster.",
    ),
]
ReportToo = Annotated[bool, typer.Option("--report", help="Write the report even with --json.")]


def optimise(
    design: DesignFile,
    sets: Set = None,
    unset: Unset = None,
    algorithm: Algorithm = "auto",
    starts: Starts = 6,
    whole_plies: WholePlies = False,
    standard_sizes: StandardSizes = False,
    shop: Shop = False,
    certify: Certify = False,
    target: Yield = None,
    verify: VerifyDynamics = None,
    relax_safety: RelaxSafety = False,
    seconds: Seconds = None,
    scheduler: ChoiceScheduler = None,
    write: Write = None,
    out: Out = REPORTS,
    report: ReportToo = False,
    date: Date = None,
    all_pages: AllPages = False,
    format: Format = "pdf",
    attach_studio: AttachStudio = False,
    seed: Seed = 0,
    plugin: PluginFile = None,
    no_record: NoRecord = False,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> ExitCode:
    """Find the best design and what each limit costs."""
    from .. import api as verbs

    job = Job(
        design, sets=sets, unset=unset, plugins=plugin, write=write,
        report=report or not as_json, out=out, date=date, all_pages=all_pages, format=format,
        attach_studio=attach_studio, seed=seed,
        as_json=as_json, quiet=quiet, verbose=verbose, record=not no_record,
        card={"relax_safety": relax_safety},
    )  # fmt: skip
    trial = None if verify is None else _scenario(verify, job.actuator)
    result = job.run(
        verbs.optimise,
        algorithm=algorithm,
        starts=starts,
        seed=seed,
        max_seconds=seconds,
        whole_plies=whole_plies,
        keep_interrupted=True,
        standard_sizes=standard_sizes,
        shop=shop,
        certify=certify,
        yield_target=target,
        scheduler=scheduler,
    )
    fault = None if write is None else _unsaved(result, write)
    if write is not None and fault is None:
        verbs.save(result, write, source=job.actuator.source)
    verification = None
    if trial is not None and not result.status.startswith("interrupted"):
        verification = job.run(verbs.verify_dynamics, trial, result.best)
    return job.deliver(
        result,
        saved=[] if fault else [write],
        faults=[fault] if fault else [],
        dynamics_verified=verification,
    )


optimize = optimise
"""Alternative spelling."""


def _scenario(file: str, actuator: Actuator) -> Trial:
    """Read the scenario that will verify the best design; it must suit the design."""
    from .. import api as verbs

    trial = verbs.read_scenario(file)
    verbs.fitting(trial, actuator)
    return trial


def _unsaved(result: Optimisation, write: Path) -> Diagnostic | None:
    """Fault if there is no best design that `--write` could save."""
    from .. import api as verbs

    if verbs.exit_code(result) == ExitCode.MET or result.status == "interrupted":
        return None
    outcome = result if result.robust is not None else result.rounding or result
    reason = "; ".join(part for part in (outcome.sentence, outcome.remedy) if part)
    return Diagnostic(f"not written, no design to save: {reason}", file=str(write))


@with_common_options
def sensitivity(
    design: DesignFile,
    common: CommonOptions = COMMON,
) -> ExitCode:
    """Show what each requirement and parameter costs."""
    from .. import api as verbs

    job = common.job(design)
    return job.deliver(verbs.Prices(job.run(verbs.optimise, seed=common.seed)))


@with_common_options
def pareto(
    design: DesignFile,
    objectives: Annotated[
        list[str] | None,
        typer.Option(
            "--objective",
            metavar="METRIC:min|max",
            autocompletion=completion.objectives,
            help='Metric and direction, two to four times, e.g. "mass:min".',
        ),
    ] = None,
    n: Annotated[int, typer.Option("-n", metavar="N", help="Number of designs on the front.")] = 50,
    checks: Annotated[
        int,
        typer.Option(
            "--checks",
            min=CHECKS.least,
            max=CHECKS.most,
            metavar="N",
            help="Number of additional full searches that look for better optima.",
        ),
    ] = 3,
    scheduler: Scheduler = None,
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Save the designs of the front.")
    ] = None,
    no_record: NoRecord = False,
    common: CommonOptions = COMMON,
) -> ExitCode:
    """Pareto front of two to four objectives, and its knee."""
    from .. import api as verbs

    job = common.job(design, csv=csv, record=not no_record)
    return job.deliver(
        job.run(
            verbs.pareto, objectives=objectives or [], n=n, seed=common.seed, checks=checks,
            scheduler=scheduler,
        )
    )  # fmt: skip
