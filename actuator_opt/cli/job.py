"""Run a command from its arguments to its exit code: read, compute, write, print, record."""

from __future__ import annotations

import inspect
import os
import shlex
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

from ..base import files as store
from ..base.dataclass import dataclass
from ..base.errors import ActuatorError, Diagnostic, ExitCode, UsageError
from . import streams
from .options import (
    REPORTS,
    AllPages,
    Date,
    Format,
    Json,
    Out,
    PluginFile,
    Quiet,
    Report,
    Seed,
    Set,
    Unset,
)

if TYPE_CHECKING:
    from ..api import Actuator
    from ..rendering.blocks import AttachedFile

_T = TypeVar("_T")
Files = Sequence[Mapping[str, Any]]
"""Files as listed in the JSON answer, each with its `path`."""


@dataclass
class Job:
    """A command: its input files, its output files and its printed answer.

    The command refuses outputs that cannot be written before it computes anything.

    Parameters
    ----------
    design : file of the design
    others : further input files
    sets, unset, plugins : changed values (``--set``), removed keys (``--unset``) and plug-ins of
        the design
    csv, write : files to write; neither may be an input file, except that `write` may be the design
    report : whether to write the report to the folder `out`, with `date` and in `format`;
        `all_pages` adds images of all pages, and `attach_studio` attaches the offline page of the
        studio, which searches with `seed`
    as_json, quiet, verbose : form of the answer; `verbose`: the whole text, not only the card
    record : whether to record the run
    paper, card : keyword arguments that only the report and the card of this command have
    """

    design: str = ""
    others: Sequence[str] = ()
    sets: Sequence[str] | None = None
    unset: Sequence[str] | None = None
    plugins: Sequence[Path] | None = None
    csv: Path | None = None
    write: Path | None = None
    report: bool = False
    out: Path = REPORTS
    date: str | None = None
    all_pages: bool = False
    format: str = "pdf"
    attach_studio: bool = False
    seed: int = 0
    as_json: bool = False
    quiet: bool = False
    verbose: bool = True
    record: bool = False
    paper: dict[str, Any] = field(default_factory=dict)
    card: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for path in filter(None, (self.csv, self.write)):
            store.require_writable(path)
        if self.report:
            from ..api.reports import date_from_environment, require_date, require_format

            store.require_folder(self.out)
            require_format(self.format, "--format")
            if self.attach_studio and self.format == "html":
                message = "--attach-studio attaches to a PDF, and --format html writes none"
                raise UsageError(Diagnostic(message, "give --format both"))
            if self.date is not None:
                require_date(self.date, "--date")
            date_from_environment()
        if self.csv is not None:
            store.require_apart(self.csv, self.design, *self.others)
        if self.write is not None:
            store.require_apart(self.write, *self.others)

    @property
    def set(self) -> list[tuple[str, str | None]]:
        """The ``--unset`` and ``--set`` options, as pairs of PATH and value, None for unset."""
        from ..design import split_assignment

        removed = [(path, None) for path in self.unset or ()]
        return [*removed, *(split_assignment(text) for text in self.sets or ())]

    @property
    def changing(self) -> str:
        """The first of ``--set`` and ``--unset`` that is given; empty if none is."""
        return "--set" if self.sets else "--unset" if self.unset else ""

    @cached_property
    def actuator(self) -> Actuator:
        """Read the design, with ``--set``, ``--unset`` and ``--plugin``."""
        from ..api import read

        return read(self.design, set=self.set, plugins=self.plugins or ())

    def run(self, verb: Callable[..., _T], *inputs: object, **options: Any) -> _T:
        """Call a library function, by default with the design; show its progress on a terminal."""
        with nullcontext() if self.quiet else streams.watching():
            return verb(*(inputs or (self.actuator,)), **options)

    def deliver(
        self,
        result: object,
        *,
        files: Files = (),
        saved: Iterable[Path | None] = (),
        faults: Sequence[Diagnostic] = (),
        details: Sequence[object] = (),
        **also: Any,
    ) -> ExitCode:
        """Write, print and record a result; return the exit code.

        Parameters
        ----------
        result : result of the command
        files : files already written, listed in the answer
        saved : further files already written, but not listed in JSON
        faults : failed outputs
        details : parts of the result that the terminal shows only here, below all others
        also : further results by their key in JSON, printed below the first; None if a result is
            missing
        """
        from ..api import results

        also = {name: further for name, further in also.items() if further is not None}
        written = [*files, *self.written(result, **also)]
        shown = (result, *also.values(), *details)

        def data() -> dict[str, Any]:
            entries = results.data(result)
            entries |= {name: results.data(further) for name, further in also.items()}
            entries |= {"files": written} if written else {}
            entries |= {"errors": [fault.to_dict() for fault in faults]} if faults else {}
            return entries

        def text() -> str:
            style = streams.style()
            if self.verbose:
                return "\n".join(results.text(x, **style) for x in shown)
            card = {"again": self._again(), "written": self.write is not None, **self.card}
            return "\n".join(results.card(x, card, **style) for x in shown)

        listed = [*({"path": path} for path in saved if path is not None), *written]
        self.answer(data, text, remarks=results.remarks(result), files=listed, faults=faults)
        if self.record:
            self.keep(result, **also)
        return next(filter(None, map(results.exit_code, shown)), ExitCode.MET)

    def written(self, result: object, **also: Any) -> list[dict[str, Any]]:
        """Write the CSV file and the report, if requested."""
        from .. import api as verbs
        from ..api import results

        if not results.writes(result):
            return []
        files = [] if self.csv is None else [results.write_csv(result, self.csv)]
        if self.report:
            paper = self.paper | {
                "folder": self.out,
                "all_pages": self.all_pages,
                "format": self.format,
            }
            if page := self._offline_page():
                paper["attached"] = [page]
            files += verbs.report(result, **self._origin(), **paper, **also)
        return [file.to_dict() for file in files]

    def _offline_page(self) -> AttachedFile | None:
        """The offline page of the studio for the PDF; None with a warning if there can be none."""
        from ..rendering.blocks import AttachedFile
        from ..studio.offline import ABOUT, page_of

        if not self.attach_studio:
            return None
        try:
            page = page_of(self.design, set=self.set, plugins=self.plugins or (), seed=self.seed)
        except ActuatorError as error:
            streams.err(f"--attach-studio: not attached: {error.diagnostics[0].message}")
            return None
        return AttachedFile(f"{Path(self.design).stem}_studio.html", "text/html", page, ABOUT)

    def keep(self, result: object, **more: Any) -> None:
        """Record the run that gave a result; a failure only prints a message."""
        from ..api import results

        try:
            results.keep(result, **self._origin(), **more)
        except ActuatorError as error:
            remedy = "set ACTUATOR_OPT_RUNS to another folder, or give --no-record"
            fault = replace(error.diagnostics[0], remedy=remedy)
            streams.err(f"the run was not recorded: {fault}")

    def _again(self) -> str:
        """The words of the command line that name the design, its changes and plug-ins."""
        words = ["DESIGN.yaml" if self.design == "-" else self.design]
        words += [word for change in self.sets or () for word in ("--set", change)]
        words += [word for path in self.unset or () for word in ("--unset", path)]
        words += [word for file in self.plugins or () for word in ("--plugin", str(file))]
        return shlex.join(words)

    def _origin(self) -> dict[str, Any]:
        """Origin of the result: command line, design and date."""
        actuator = self.__dict__.get("actuator")  # None if the command read no design
        return {"actuator": actuator, "command": command_line(), "date": self.date}

    def answer(
        self,
        data: Callable[[], Mapping[str, Any]],
        text: Callable[[], str] | None = None,
        *,
        remarks: Iterable[str] = (),
        files: Files = (),
        faults: Iterable[Diagnostic] = (),
    ) -> None:
        """Print the data as JSON, or the text; then remarks, files and faults."""
        if self.as_json:
            streams.out_json(dict(data()))
            return
        if not self.quiet:
            if text is not None:
                streams.out(text(), end="")
            for remark in remarks:
                streams.err(remark)
            for line in _wrote([str(file["path"]) for file in files], each=self.verbose):
                streams.err(line)
        for fault in faults:
            streams.err(str(fault))


def _wrote(paths: Sequence[str], *, each: bool) -> list[str]:
    """Lines that name the files written; unless `each`, images of one folder are counted."""
    images = [path for path in paths if path.endswith(".png")]
    if each or len(images) < 2:
        return [f"wrote {path}" for path in paths]
    others = [path for path in paths if path not in images]
    folders = ", ".join(dict.fromkeys(os.path.dirname(path) or "." for path in images))
    return [*(f"wrote {path}" for path in others), f"wrote {len(images)} PNG to {folders}"]


_TARGETS = ("--out", "--write", "--csv", "--parquet", "--format", "--scheduler")
"""Options with a value that do not affect the result: where it is written or computed."""

_SILENT = (
    "--json", "--report", "--all-pages", "--quiet", "-q", "--verbose", "-v", "--relax-safety",
    "--no-record", "--debug", "--attach-studio",
)  # fmt: skip
"""Flags that do not affect the result."""


def command_line() -> str:
    """The command line, without options that do not affect the result."""
    words, skip = ["actuator-opt"], False
    for word in sys.argv[1:]:
        if skip:
            skip = False
        elif word in _TARGETS:
            skip = True
        elif word not in _SILENT and word.partition("=")[0] not in _TARGETS:
            words.append(word)
    return shlex.join(words)


@dataclass
class CommonOptions:
    """Options of every command that computes a result of a design and may write its report."""

    sets: Set = None
    unset: Unset = None
    plugin: PluginFile = None
    report: Report = False
    out: Out = REPORTS
    date: Date = None
    all_pages: AllPages = False
    format: Format = "pdf"
    seed: Seed = 0
    as_json: Json = False
    quiet: Quiet = False

    def job(self, design: str, others: Sequence[str] = (), **more: Any) -> Job:
        """The job of a command with these options; `more` as for `Job`."""
        names = (option.name for option in fields(self))
        options: dict[str, Any] = {name: getattr(self, name) for name in names}
        options["plugins"] = options.pop("plugin")
        del options["seed"]
        return Job(design, others, **options | more)


COMMON = CommonOptions()


def with_common_options(command: Callable[..., ExitCode]) -> Callable[..., ExitCode]:
    """The command with the single options in place of its parameter `common`."""
    signature = inspect.signature(command, eval_str=True)
    kinds = get_type_hints(CommonOptions, include_extras=True)
    options = [
        signature.parameters["common"].replace(
            name=option.name, default=option.default, annotation=kinds[option.name]
        )
        for option in fields(CommonOptions)
    ]
    parameters = list(signature.parameters.values())
    at = [parameter.name for parameter in parameters].index("common")
    parameters[at : at + 1] = options

    def expanded(**given: Any) -> ExitCode:
        common = CommonOptions(**{option.name: given.pop(option.name) for option in options})
        return command(**given, common=common)

    expanded.__name__, expanded.__doc__ = command.__name__, command.__doc__
    expanded.__module__, expanded.__qualname__ = command.__module__, command.__qualname__
    expanded.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    expanded.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return expanded
