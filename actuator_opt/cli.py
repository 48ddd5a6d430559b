"""The terminal: read arguments, call the library, print. No physics.

stdout carries data, stderr messages; ``--json`` prints one SI object, faults included. Heavy
modules are imported inside the commands that need them.
"""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

import typer

from .errors import ActuatorError, Diagnostic, ExitCode, UsageError
from .version import VERSION

if TYPE_CHECKING:
    from .evaluate import Evaluation
    from .optimise.result import Optimisation
    from .verbs import Actuator

app = typer.Typer(
    name="actuator-opt",
    help="Design optimisation of lightweight hydraulic actuators.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
library = typer.Typer(
    help="Materials, fluids, seal compounds and adhesives, with their sources.",
    no_args_is_help=True,
)
app.add_typer(library, name="materials")

DesignFile = Annotated[str, typer.Argument(metavar="DESIGN", help="Design file, or - for stdin.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Replace a value; a bare number is SI."),
]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for reports.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of the search.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object (SI) to stdout.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
PluginFile = Annotated[
    list[Path] | None,
    typer.Option("--plugin", metavar="FILE.py", help="Python file with own metrics."),
]
Date = Annotated[
    str | None,
    typer.Option("--date", metavar="YYYY-MM-DD", help="Date to print on the report."),
]
Algorithm = Annotated[
    str, typer.Option("--algorithm", metavar="NAME", help='"auto" or an NLopt algorithm.')
]
Starts = Annotated[int, typer.Option("--starts", min=1, max=1000, help="Starts of the search.")]
Report = Annotated[
    bool, typer.Option("--report", help="Write the report although --json is given.")
]
REPORTS = Path("reports")


class _Style(TypedDict):
    colour: bool
    unicode: bool
    width: int


def _style() -> _Style:
    """How the terminal wants its text."""
    terminal = sys.stdout.isatty()
    encoding = (sys.stdout.encoding or "ascii").lower().replace("-", "")
    colour = terminal and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
    width = 100
    if terminal:
        width = max(os.get_terminal_size(sys.stdout.fileno()).columns, 40)
    return {"colour": colour, "unicode": encoding.startswith("utf"), "width": width}


def _print_json(data: Any) -> None:
    import json

    typer.echo(json.dumps(data, ensure_ascii=True, allow_nan=False, indent=1))


def _read(design: str, sets: list[str] | None, plugins: list[Path] | None) -> Actuator:
    from .design import split_assignment
    from .verbs import read

    pairs = [split_assignment(text) for text in sets or []]
    return read(design, set=pairs, plugins=plugins or [])


def _status(evaluation: Evaluation) -> None:
    if not evaluation.met:
        raise typer.Exit(ExitCode.MISSED)


def _command() -> str:
    """The command line without what does not change the result: same input, same bytes."""
    import shlex

    words, kept, skip = sys.argv[1:], [], False
    for word in words:
        if skip:
            skip = False
        elif word in ("--out", "--write"):
            skip = True
        elif word not in ("--json", "--report", "--quiet", "-q") and not word.startswith(
            ("--out=", "--write=")
        ):
            kept.append(word)
    return shlex.join(["actuator-opt", *kept])


def _write_report(
    subject: Evaluation | Optimisation,
    actuator: Actuator,
    out: Path,
    date: str | None,
) -> list[dict[str, Any]]:
    from .verbs import report

    _check_date(date)
    files = report(subject, folder=out, actuator=actuator, command=_command(), date=date)
    return [file.to_dict() for file in files]


def _check_date(date: str | None) -> None:
    if date is None:
        return
    from datetime import date as day

    try:
        day.fromisoformat(date)
    except ValueError:
        raise UsageError(Diagnostic(f'--date "{date}" is no date', "write YYYY-MM-DD")) from None


@app.callback(invoke_without_command=True)
def _main(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    if version:
        typer.echo(f"actuator-opt {VERSION}")
        raise typer.Exit


@app.command()
def init(
    name: Annotated[str, typer.Argument(help="Name of the actuator.")] = "my actuator",
    source: Annotated[
        str | None, typer.Option("--from", metavar="DESIGN", help="Start from this design.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="File to write; default stdout.")
    ] = None,
) -> None:
    """Print (or write) a commented start file."""
    from .design import read_design
    from .design.template import init_text
    from .store import write_text

    text = init_text(name, None if source is None else read_design(source))
    if out is None:
        typer.echo(text, nl=False)
        return
    if out.exists():
        raise UsageError(Diagnostic("the file exists already", "choose another name", str(out)))
    write_text(out, text)
    typer.echo(f"wrote {out}", err=True)


@app.command()
def check(
    designs: Annotated[list[str], typer.Argument(metavar="DESIGN...", help="Design files.")],
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Name every fault of design files, with line, column and remedy."""
    from . import verbs

    faults: list[Diagnostic] = []
    for design in designs:
        found = verbs.check(design, plugins=plugin or [])
        faults += found
        if not found and not quiet and not as_json:
            typer.echo(f"{design}: no faults", err=True)
    if as_json:
        _print_json({"errors": [fault.to_dict() for fault in faults]})
    else:
        for fault in faults:
            typer.echo(str(fault), err=True)
    if faults:
        raise typer.Exit(ExitCode.BAD_INPUT)


@app.command()
def evaluate(
    design: DesignFile,
    sets: Set = None,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Every metric, requirement and check of a design as it stands."""
    from . import verbs

    evaluation = verbs.evaluate(_read(design, sets, plugin))
    if as_json:
        _print_json(evaluation.to_dict())
    elif not quiet:
        from .report.terminal import evaluation_text

        typer.echo(evaluation_text(evaluation, **_style()), nl=False)
    _status(evaluation)


@app.command()
def optimise(
    design: DesignFile,
    sets: Set = None,
    algorithm: Algorithm = "auto",
    starts: Starts = 6,
    write: Annotated[
        Path | None, typer.Option("--write", metavar="FILE", help="Save the best design here.")
    ] = None,
    out: Out = REPORTS,
    report: Report = False,
    date: Date = None,
    seed: Seed = 0,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find the best design, price its requirements, write the report."""
    from . import verbs

    _check_date(date)
    actuator = _read(design, sets, plugin)
    result = verbs.optimise(actuator, algorithm=algorithm, starts=starts, seed=seed)
    if write is not None:
        verbs.save(result.design, write, source=actuator.source)
    files = _write_report(result, actuator, out, date) if report or not as_json else []
    if as_json:
        _print_json(result.to_dict() | ({"files": files} if files else {}))
    elif not quiet:
        from .report.terminal import optimisation_text

        typer.echo(optimisation_text(result, **_style()), nl=False)
        for file in files:
            typer.echo(f"wrote {file['path']}", err=True)
    if result.status == "infeasible" or result.status.startswith("limit_inf"):
        raise typer.Exit(ExitCode.MISSED)
    if result.status == "undefined":
        raise typer.Exit(ExitCode.SOLVER_FAILED)
    _status(result.evaluation)


app.command("optimize", hidden=True)(optimise)


@app.command()
def sensitivity(
    design: DesignFile,
    sets: Set = None,
    seed: Seed = 0,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """What each requirement and parameter costs at the design's optimum."""
    from . import verbs

    result = verbs.optimise(_read(design, sets, plugin), seed=seed)
    if as_json:
        data = result.to_dict()
        keys = ("name", "version", "status", "outcome", "objective", "sensitivities", "kkt")
        _print_json({key: data[key] for key in keys})
    elif not quiet:
        from .report.terminal import infeasibility_card, sensitivity_table

        style = _style()
        shown = sensitivity_table(result, **style) or infeasibility_card(result, **style)
        typer.echo(shown or result.sentence)
    if result.status == "undefined":
        raise typer.Exit(ExitCode.SOLVER_FAILED)
    _status(result.evaluation)


@app.command()
def report(
    design: DesignFile,
    sets: Set = None,
    out: Out = REPORTS,
    date: Date = None,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write the report (PDF and PNG) of a design as it stands."""
    from . import verbs

    _check_date(date)
    actuator = _read(design, sets, plugin)
    evaluation = verbs.evaluate(actuator)
    files = _write_report(evaluation, actuator, out, date)
    if as_json:
        _print_json({"files": files})
    elif not quiet:
        for file in files:
            typer.echo(f"wrote {file['path']}", err=True)
    _status(evaluation)


@app.command()
def schema() -> None:
    """Print the JSON Schema of design files (completion and hover in an editor)."""
    from .design.materials import load_library
    from .design.schema import json_schema
    from .quantities import METRICS

    _print_json(json_schema(materials=load_library(), metrics=METRICS))


@library.command("list")
def list_materials(
    kind: Annotated[
        str | None,
        typer.Option("--kind", help="metal, ply, polymer, fluid, seal or adhesive."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Every entry with its main numbers."""
    from .design.material import KINDS
    from .design.material_tables import list_lines, to_dict
    from .design.materials import load_library

    if kind is not None and kind not in KINDS:
        raise UsageError(Diagnostic(f'--kind "{kind}"', f"use one of {', '.join(KINDS)}"))
    found = load_library()
    if as_json:
        _print_json(to_dict(m for m in found if kind is None or m.kind == kind))
    else:
        typer.echo("\n".join(list_lines(found, kind=kind, ascii=not _style()["unicode"])))


@library.command("show")
def show_material(
    name: Annotated[str, typer.Argument(help="Name of the entry.")], as_json: Json = False
) -> None:
    """Every property of one entry with value, scatter, confidence and source."""
    from .design.material_tables import show_lines, to_dict
    from .design.materials import load_library

    material = load_library().get(name)
    if as_json:
        _print_json(to_dict([material]))
    else:
        typer.echo("\n".join(show_lines(material, ascii=not _style()["unicode"])))


@library.command("compare")
def compare_materials(
    names: Annotated[list[str], typer.Argument(metavar="NAME...", help="Two or more entries.")],
    as_json: Json = False,
) -> None:
    """Properties side by side, with ratios to the first."""
    from .design.material_tables import compare_lines, to_dict
    from .design.materials import load_library

    found = load_library()
    materials = [found.get(name) for name in names]
    if as_json:
        _print_json(to_dict(materials))
    else:
        typer.echo("\n".join(compare_lines(materials, ascii=not _style()["unicode"])))


def main() -> None:
    """Run the command line; every fault leaves as a line and an exit code, never a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        app()
    except ActuatorError as error:
        if "--json" in sys.argv[1:]:
            _print_json({"errors": [fault.to_dict() for fault in error.diagnostics]})
        else:
            for fault in error.diagnostics:
                print(fault, file=sys.stderr)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(ExitCode.INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(ExitCode.MET)


if __name__ == "__main__":
    main()
