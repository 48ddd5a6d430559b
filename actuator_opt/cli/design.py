"""Commands for designs: `init`, `check`, `evaluate`, `report`, `compare`, `export`, `schema`."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import replace
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..base import files as store, runs as run_store
from ..base.errors import Diagnostic, ExitCode, UsageError, shown
from ..base.tables import encoded
from . import streams
from .job import COMMON, CommonOptions, Job, with_common_options
from .options import (
    REPORTS,
    AllPages,
    AttachStudio,
    Date,
    DesignFile,
    Format,
    Json,
    Out,
    PluginFile,
    Quiet,
    Seed,
    Set,
    Unset,
    UnusedOut,
    UnusedSeed,
    Verbose,
)

if TYPE_CHECKING:
    from ..api import Restored
    from ..api.starting import Start, StartAnswers
    from ..api.starting_cycle import CycleStart


def _named_file(name: str) -> tuple[str, Path]:
    """Title and file for `init NAME`: ``"left knee"`` is written to left_knee.yaml."""
    from ..design.kinds import Text, ValueFault

    folder, base = os.path.split(name)
    title = base.removesuffix(".yaml").removesuffix(".yml")
    if base and not title.strip(". "):
        raise UsageError(
            Diagnostic(f"NAME: {shown(name)} is not a file name", "write e.g. left_knee")
        )
    try:
        Text().validate(title)
    except ValueFault as fault:
        raise UsageError(Diagnostic(f"NAME: {fault.message}", fault.remedy)) from None
    stem = re.sub(r"[^\w.+-]+", "_", title).strip("_.")
    return title, Path(folder, f"{stem or 'actuator'}.yaml")


NewName = Annotated[
    str | None,
    typer.Argument(
        metavar="NAME",
        help="Name of the actuator or scenario; NAME.yaml is written. "
        "Without a name the text is printed; without forces it is a template of all keys.",
    ),
]
Source = Annotated[
    str | None,
    typer.Option("--from", metavar="DESIGN", help="Copy this design; --cycle adds a cycle to it."),
]
OfDesign = Annotated[
    str | None,
    typer.Option("--scenario", metavar="DESIGN", help="Write a scenario for this design instead."),
]
Push = Annotated[
    str | None, typer.Option("--push", metavar="FORCE", help='Push force, e.g. "9 kN".')
]
Pull = Annotated[str | None, typer.Option("--pull", metavar="FORCE", help="Pull force; 0 N: none.")]
Stroke = Annotated[
    str | None, typer.Option("--stroke", metavar="LENGTH", help='Stroke, e.g. "180 mm".')
]
Pressure = Annotated[
    str | None,
    typer.Option("--pressure", metavar="PRESSURE", help='Supply pressure, e.g. "160 bar".'),
]
GoalWord = Annotated[
    str | None,
    typer.Option("--goal", metavar="GOAL", help="What is best: mass, stiffness or friction."),
]
WallWord = Annotated[
    str | None,
    typer.Option(
        "--wall",
        metavar="WALL",
        help="Barrel: steel, aluminium, lined_carbon or linerless. Piston, head and caps "
        "are steel in a steel barrel, else aluminium.",
    ),
]
LeverArm = Annotated[
    str | None,
    typer.Option(
        "--lever-arm",
        metavar="LENGTH",
        help='Lever arm of a joint; push and pull may then be torques, e.g. "540 N*m".',
    ),
]
Speed = Annotated[
    str | None,
    typer.Option("--speed", metavar="SPEED", help='Piston speed; without it "0.1 m/s".'),
]
Stiffness = Annotated[
    str | None,
    typer.Option("--stiffness", metavar="STIFFNESS", help='Least stiffness, e.g. "10 kN/mm".'),
]
TypeWord = Annotated[
    str | None,
    typer.Option(
        "--type", metavar="TYPE", help="Cylinder: differential, or double_rod (two rods)."
    ),
]
CycleOf = Annotated[
    str | None,
    typer.Option(
        "--cycle",
        metavar="FILE.csv",
        help="Duty cycle that gives forces, speed and stroke: time with position and force, or "
        "with joint_angle and joint_torque (add --lever-arm, or --from a design with a linkage).",
    ),
]
Yes = Annotated[bool, typer.Option("--yes", help="Use the defaults instead of asking questions.")]
NewFile = Annotated[
    Path | None,
    typer.Option("--out", metavar="FILE", help="Output file; - prints the text."),
]


def init(
    name: NewName = None,
    source: Source = None,
    scenario: OfDesign = None,
    push: Push = None,
    pull: Pull = None,
    stroke: Stroke = None,
    pressure: Pressure = None,
    goal: GoalWord = None,
    wall: WallWord = None,
    lever_arm: LeverArm = None,
    speed: Speed = None,
    stiffness: Stiffness = None,
    type_: TypeWord = None,
    cycle: CycleOf = None,
    yes: Yes = False,
    out: NewFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> ExitCode:
    """Write a commented start file for a design or a scenario.

    On a terminal, init asks for forces, stroke, pressure, goal and wall. Options answer in advance.
    """
    options = {
        "lever_arm": lever_arm, "push": push, "pull": pull, "stroke": stroke,
        "pressure": pressure, "goal": goal, "wall": wall, "speed": speed, "stiffness": stiffness,
        "type": type_,
    }  # fmt: skip
    answers = {key: text for key, text in options.items() if text is not None}
    sources = {"--scenario": scenario, "--from": source, "--cycle": cycle, "--yes": yes or None}
    sources |= {f"--{key.replace('_', '-')}": text for key, text in answers.items()}
    joined = source is not None and cycle is not None and scenario is None
    _only_one({x: y for x, y in sources.items() if not joined or x not in _BESIDE_COPY})
    copied = source is not None or scenario is not None
    title, out = _target(name, out)
    job = Job(as_json=as_json, quiet=quiet)
    verdict: dict[str, Any] = {}
    faults, remarks = list[Diagnostic](), list[str]()
    if joined:
        assert source is not None
        assert cycle is not None
        joint, start = _joined(source, cycle, answers.get("lever_arm"), out, title)
        text, verdict = start.text, {"met": start.met}
        if not start.met:
            faults = [Diagnostic("the cycle does not fit yet", start.sentence, str(out or ""))]
            verdict["remedy"] = start.sentence
        remarks = [f"warning: {text}" for text in joint.warnings]
    elif answers or cycle or yes or (out is not None and not copied):
        found = _cycle(cycle, answers, out)
        complete = _complete(answers, ask=not as_json, defaults=yes)
        start = _solved(job, complete, found, title)
        text, verdict = start.text, {"met": start.met}
        if start.met:
            remarks = [f"{complete.words}, solved: {start.solved}; edit it, or optimise it"]
        else:
            faults = [Diagnostic("nothing fits yet", start.sentence, str(out or ""))]
            verdict["remedy"] = start.sentence
        remarks += [f"warning: {text}" for text in ([] if found is None else found.warnings)]
    else:
        text = _start_text(source, scenario, out, title)
    if out is None:
        job.answer(lambda: {"text": text} | verdict, lambda: text, faults=faults)
    else:
        store.write_text(out, text)
        files = [{"path": str(out)}]
        job.answer(lambda: {"files": files} | verdict, remarks=remarks, files=files, faults=faults)
    return ExitCode.MISSED if faults else ExitCode.MET


_BESIDE_COPY = ("--cycle", "--lever-arm")
"""Options that may stand beside --from, if --cycle is among them."""


def _joined(
    source: str, file: str, lever_arm: str | None, out: Path | None, title: dict[str, str]
) -> tuple[CycleStart, Start]:
    """A copy of a design, named by `title`, with the cycle in a file."""
    from ..api.starting import start_answers
    from ..api.starting_cycle import cycle_start
    from ..design import read_design
    from ..design.kinds import ValueFault

    arm = start_answers({} if lever_arm is None else {"lever_arm": lever_arm}, "--").get(
        "lever_arm"
    )
    assert not isinstance(arm, str)
    folder = Path() if out is None else out.parent
    loaded = read_design(source)
    found = cycle_start(file, lever_arm=arm, linkage=loaded.design.linkage, folder=folder)
    try:
        return found, found.joined_to(loaded, folder, **title)
    except ValueFault as fault:
        raise UsageError(Diagnostic(f"NAME: {fault.message}", fault.remedy)) from None


def _only_one(sources: Mapping[str, object]) -> None:
    """Refuse two sources of the file; a design, a scenario and answers exclude each other."""
    stated = [option for option, value in sources.items() if value is not None]
    copies = [option for option in stated if option in ("--scenario", "--from")]
    if copies and len(stated) > 1:
        other = next(option for option in reversed(stated) if option != copies[0])
        raise UsageError(Diagnostic(f"{other} and {copies[0]}", "use only one of them"))


def _target(name: str | None, out: Path | None) -> tuple[dict[str, str], Path | None]:
    """Title of the design, if it has a name, and the new file; None: the text is printed."""
    title = {}
    if name is not None:
        title["name"], file = _named_file(name)
        out = file if out is None else out
    if out is None or str(out) == "-":
        return title, None
    if os.path.lexists(out):
        raise UsageError(Diagnostic("exists already", "choose another name", str(out)))
    store.require_writable(out)
    return title, out


def _solved(
    job: Job, answers: StartAnswers, cycle: CycleStart | None, title: dict[str, str]
) -> Start:
    """The solved start design named by `title`, with its cycle."""
    from ..api.starting import solved_start

    start: Start = job.run(solved_start, answers, prefix="--", **title)
    return start if cycle is None else cycle.added_to(start)


def _cycle(file: str | None, answers: dict[str, str], out: Path | None) -> CycleStart | None:
    """The cycle in a file, if one is named; its forces, speed and stroke become answers."""
    if file is None:
        return None
    from ..api.starting import start_answers
    from ..api.starting_cycle import cycle_start

    stated = {"lever_arm": answers["lever_arm"]} if "lever_arm" in answers else {}
    arm = start_answers(stated, "--").get("lever_arm")
    assert not isinstance(arm, str)
    found = cycle_start(file, lever_arm=arm, folder=Path() if out is None else out.parent)
    answers.update(found.answers | answers)
    return found


_QUESTIONS = (
    ("push and pull force", ("push", "pull")),
    ("stroke", ("stroke",)),
    ("supply pressure", ("pressure",)),
    ("goal", ("goal",)),
    ("wall", ("wall",)),
)
"""Questions of `init`, each with the keys that it answers."""


def _complete(answers: dict[str, str], *, ask: bool, defaults: bool) -> StartAnswers:
    """All answers: as stated, from questions on a terminal, or from defaults.

    Raises
    ------
    UsageError : a stated answer is unsuitable, or answers are missing without a terminal
    """
    from ..api import starting

    usual = {key: text for key, (_, text) in starting.ASKED.items()}
    usual |= {"goal": next(iter(starting.GOALS)), "wall": next(iter(starting.WALLS))}
    values = starting.start_answers(answers, "--")
    arm = values.get("lever_arm")
    assert not isinstance(arm, str)
    missing = [key for key in usual if key not in values]
    if missing and not defaults and not (ask and streams.asking()):
        flags = " ".join(f'--{key} "{usual[key]}"' for key in missing)
        message = "no terminal to ask for the load"
        raise UsageError(Diagnostic(message, f"add {flags}, or --yes for these defaults"))
    for words, keys in _QUESTIONS:
        open_keys = [key for key in keys if key in missing]
        if not open_keys:
            continue
        offered = ", ".join(usual[key] for key in open_keys)
        if defaults:
            values |= starting.start_answers({key: usual[key] for key in open_keys})
            continue
        choices = {"goal": starting.GOALS, "wall": starting.WALLS}.get(open_keys[0])
        label = words if choices is None else f"{words} ({', '.join(choices)})"
        label = label if len(open_keys) == len(keys) else open_keys[0]
        while True:
            text = streams.ask(f"{label} [{offered}]: ").strip() or offered
            parts = re.split(r"\s*[;,](?!\d)\s*", text) if len(open_keys) > 1 else [text]
            try:
                if len(parts) != len(open_keys):
                    raise UsageError(Diagnostic(f'"{shown(text)}"', f'write e.g. "{offered}"'))
                values |= starting.start_answers(dict(zip(open_keys, parts, strict=True)), arm=arm)
                break
            except UsageError as error:
                streams.err(str(error.diagnostics[0]))
    return starting.StartAnswers(**values)  # type: ignore[arg-type]


def _start_text(
    source: str | None, scenario: str | None, out: Path | None, title: dict[str, str]
) -> str:
    """Text of a start file named by `title`: a design, or a scenario that `out` will contain."""
    from ..design import read_design
    from ..design.data_file import moved
    from ..design.kinds import ValueFault
    from ..design.scenario.reader import scenario_text
    from ..design.writer import init_text

    try:
        if scenario is None:
            folder = Path() if out is None else out.parent
            loaded = None if source is None else read_design(source)
            if loaded is not None:
                loaded = replace(loaded, design=moved(loaded.design, folder))
            return init_text(from_design=loaded, **title)
        file = relpath(scenario, Path() if out is None else out.parent)
        return scenario_text(read_design(scenario).design, file, **title)
    except ValueFault as fault:
        raise UsageError(Diagnostic(f"NAME: {fault.message}", fault.remedy)) from None


def check(
    designs: Annotated[
        list[str],
        typer.Argument(metavar="FILE", help="Design or scenario files; - for stdin."),
    ],
    sets: Set = None,
    unset: Unset = None,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
    out: UnusedOut = REPORTS,
    seed: UnusedSeed = 0,
) -> ExitCode:
    """List all faults of design and scenario files."""
    from .. import api as verbs

    job = Job(sets=sets, unset=unset, as_json=as_json, quiet=quiet)
    pairs, faults, remarks = job.set, list[Diagnostic](), list[str]()
    warnings: list[dict[str, str]] = []
    for design in designs:
        examined = verbs.examine(design, set=pairs, plugins=plugin or [])
        faults += examined.faults
        warnings += [{"file": design, "message": text} for text in examined.warnings]
        remarks += [f"{design}: warning: {text}" for text in examined.warnings]
        remarks += [] if examined.faults else [f"{design}: no faults"]
    errors = {"errors": [fault.to_dict() for fault in faults]}
    data = errors | ({"warnings": warnings} if warnings else {})
    job.answer(lambda: data, remarks=remarks, faults=faults)
    return ExitCode.BAD_INPUT if faults else ExitCode.MET


TracesFile = Annotated[
    Path | None,
    typer.Option("--csv", metavar="FILE", help="Save the traces of all duty cycles."),
]


@with_common_options
def evaluate(
    design: DesignFile,
    csv: TracesFile = None,
    verbose: Verbose = False,
    common: CommonOptions = COMMON,
) -> ExitCode:
    """Compute all metrics, requirements and checks of a design."""
    from .. import api as verbs

    job = common.job(design, csv=csv, verbose=verbose)
    return job.deliver(job.run(verbs.evaluate, seed=common.seed if common.report else None))


def report(
    design: Annotated[
        str,
        typer.Argument(metavar="DESIGN", help="Design file, - for stdin, or a run (id or last)."),
    ],
    sets: Set = None,
    unset: Unset = None,
    out: Out = REPORTS,
    date: Date = None,
    all_pages: AllPages = False,
    format: Format = "pdf",
    attach_studio: AttachStudio = False,
    seed: Seed = 0,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> ExitCode:
    """Write the report of an unchanged design, or of a run."""
    from .. import api as verbs

    job = Job(
        design, sets=sets, unset=unset, plugins=plugin, report=True, out=out, date=date,
        all_pages=all_pages, format=format, attach_studio=attach_studio, seed=seed,
        as_json=as_json, quiet=quiet,
    )  # fmt: skip
    recorded = run_store.is_name(design)
    result: Any = _restored(job) if recorded else job.run(verbs.evaluate, seed=seed)
    files = job.run(job.written, result)
    if not files:  # the front has no designs
        streams.err(result.result.sentence)
    job.answer(lambda: {"files": files}, files=files)
    return verbs.exit_code(result)


def _restored(job: Job) -> Restored:
    """Restore a recorded run; print where the present models give other results."""
    from .. import api as verbs

    if job.changing:
        fault = f"{job.changing}: not allowed with a run"
        raise UsageError(Diagnostic(fault, "name a design instead"))
    restored = verbs.restore(job.design, plugins=job.plugins or [])
    for doubt in restored.doubts:
        streams.err(doubt)
    return restored


def compare(
    designs: Annotated[
        list[str],
        typer.Argument(metavar="DESIGN", help="Two or more design files or runs (id or last)."),
    ],
    sets: Set = None,
    unset: Unset = None,
    plugin: PluginFile = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Write figures of mass, compliance and friction to this folder.",
        ),
    ] = None,
    optimise: Annotated[
        bool,
        typer.Option("--optimise", help="First optimise every design that is not an optimum."),
    ] = False,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> ExitCode:
    """Compare designs: what differs, and which parts matter."""
    from .. import api as verbs

    if out is not None:
        store.require_folder(out)
    job = Job(sets=sets, unset=unset, as_json=as_json, quiet=quiet)
    options = {"set": job.set, "plugins": plugin or [], "optimise": optimise, "seed": seed}
    comparison = job.run(verbs.compare, *designs, **options)
    paths = [] if out is None else verbs.draw_comparison(comparison, out)
    return job.deliver(comparison, files=[{"path": str(path)} for path in paths])


ExportedFile = Annotated[
    str,
    typer.Argument(
        metavar="DESIGN",
        help="Design file, or scenario that names its design (c or fmu), or - for stdin.",
    ),
]
Formats = Annotated[
    list[str] | None,
    typer.Option("--format", metavar="step|dxf|xlsx|c|fmu", help="File format. Repeatable."),
]
ExportedScenario = Annotated[
    str | None,
    typer.Option(
        "--scenario",
        metavar="SCENARIO",
        help="Write the equations of this scenario with the design instead (c or fmu).",
    ),
]
ExportFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Output folder.")]
ExportDate = Annotated[
    str | None,
    typer.Option(
        "--date",
        metavar="YYYY-MM-DD",
        help="Date in the files; default: none, or SOURCE_DATE_EPOCH.",
    ),
]


def export(
    design: ExportedFile,
    formats: Formats = None,
    scenario: ExportedScenario = None,
    sets: Set = None,
    unset: Unset = None,
    out: ExportFolder = REPORTS,
    date: ExportDate = None,
    seed: Seed = 0,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> ExitCode:
    """Export a design to CAD, Excel, C; a scenario to C, FMI."""
    from .. import api as verbs
    from ..api.exports import is_exported_scenario
    from ..exports import require_formats

    alone = scenario is None and is_exported_scenario(design, formats or ())
    known = require_formats(formats or [], scenario=scenario is not None or alone)
    if alone and plugin:
        remedy = "give the design, and the scenario by --scenario"
        raise UsageError(Diagnostic("--plugin: not with a scenario alone", remedy))
    job = Job(
        design, sets=sets, unset=unset, plugins=plugin, report=True, out=out, date=date,
        as_json=as_json, quiet=quiet,
    )  # fmt: skip
    options: dict[str, Any] = {"formats": known, "folder": out, "date": date}
    if alone:
        evaluation = None
        exports = job.run(verbs.export, verbs.read_scenario(design, set=job.set), **options)
    elif scenario is None:
        evaluation = job.run(verbs.evaluate)
        exports = verbs.export(evaluation, actuator=job.actuator, **options)
    else:
        evaluation = None
        exports = job.run(verbs.export, scenario=scenario, **options)
    files = [file.to_dict() for file in exports]
    remarks = [f"{file.path}: {file.note}" for file in exports if file.note]
    job.answer(lambda: {"files": files}, files=files, remarks=remarks)
    return ExitCode.MET if evaluation is None else verbs.exit_code(evaluation)


def schema(
    scenario: Annotated[
        bool, typer.Option("--scenario", help="Schema of scenario files, not of designs.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print it on a terminal, too.")] = False,
) -> None:
    """Print the JSON Schema of design or scenario files.

    On a terminal, only its size is printed, as it is for editors: use list or explain instead.
    """
    from ..base.quantities import RESULTS
    from ..design.materials import load_library
    from ..design.schema import json_schema
    from ..metrics import METRICS

    if scenario:
        from ..design.scenario import Scenario

        data = json_schema(Scenario, materials=load_library(), metrics=RESULTS)
    else:
        data = json_schema(materials=load_library(), metrics=METRICS)
    if not streams.terminal() or as_json:
        streams.out_json(data)
        return
    size = len(encoded(data, indent=1))
    streams.err(f"{size / 1e6:.1f} MB of JSON: use list or explain; > FILE for an editor")
