"""`rerun`: repeats the command of a report, with the input attached to its PDF."""

from __future__ import annotations

import argparse
import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Unpack

from ..base.arguments import guarded
from ..base.bounds import CHECKS, FRONT, SEED, STARTS, IntegerRange
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, shown
from ..base.tables import Displayed
from ..evaluation import Evaluation
from ..version import VERSION
from . import results
from .actuator import Actuator, Plugins, plugins_of, read_as
from .optimum import evaluate, optimise, pareto
from .recorded_runs import Run, differing, run_fault
from .reports import ReportArguments, is_date, verification_tables

if TYPE_CHECKING:
    from ..optimisation.pareto import ParetoFront
    from ..optimisation.result import Optimisation
    from ..pages import ReportFile, Table
    from ..rendering.console import Style

OPTIMISED, EVALUATED = ("optimise", "optimize", "sensitivity"), ("evaluate", "report")
FRONTS = ("pareto",)
"""Commands whose reports can be repeated: optimisations, evaluations and Pareto fronts."""
_VALUES = ("--algorithm", "--verify-dynamics", "--date")
_FLAGS = ("--whole-plies", "--standard-sizes", "--shop", "--certify")
_LONGEST = 100_000
"""Maximum length of a command line, below the system's limit for one argument."""


@dataclass(frozen=True, slots=True)
class Rerun(Displayed):
    """The repeated result of a report's command, and its differences from the original result.

    `repeats` says whether the result is the same; it is None if the report has no result to
    compare. `differences` maps the name of each value that differs to its old and new value.
    """

    file: Path
    command: str
    version: str
    date: str | None
    subject: Evaluation | Optimisation | ParetoFront
    actuator: Actuator
    tables: tuple[Table, ...]
    repeats: bool | None
    differences: Mapping[str, tuple[Any, Any]]
    sentence: str

    @property
    def in_short(self) -> tuple[str, str]:
        """Whether the report was repeated."""
        return self.file.name, self.sentence

    def to_dict(self) -> dict[str, Any]:
        """The object of `rerun --json`: that of the repeated command, plus the key `rerun`."""
        return self.subject.to_dict() | {
            "rerun": {
                "report": str(self.file),
                "command": self.command,
                "version": self.version,
                "repeats": self.repeats,
                "outcome": self.sentence,
                "differences": {
                    name: {"then": then, "now": now}
                    for name, (then, now) in self.differences.items()
                },
            }
        }

    def text(self, **style: Unpack[Style]) -> str:
        """The terminal output of the command."""
        return results.text(self.subject, **style)

    def report(self, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
        """Write the report again, with the command and date of the original."""
        return results.report(self.subject, **{**paper, **self._origin()})

    def record(self, **paper: Any) -> Run | None:
        """Record the run, if the repeated command is one that records its runs."""
        return results.keep(self.subject, **paper | self._origin())

    def _origin(self) -> dict[str, Any]:
        """Design, command and date of the original report, with its additional tables."""
        data = {"actuator": self.actuator, "command": self.command, "date": self.date}
        return data | ({"extra_tables": self.tables} if self.tables else {})


@guarded
def rerun(report: str | Path, *, plugins: Plugins = ()) -> Rerun:
    """Repeat the command of a report, with the input attached to its PDF.

    Parameters
    ----------
    report : the PDF
    plugins : the Python files with which the report was made; they only run if given here

    Raises
    ------
    InputError
        the PDF is no report of this program, is encrypted or damaged, or comes from a newer
        version; or its command needs more input than the design
    """
    from ..pages import read_attachment

    path = Path(report)
    attachment = read_attachment(path)
    run = attachment.run
    try:
        version, command, name = (_text(run, x) for x in ("actuator_opt", "command", "source_name"))
        date = _require_form(run)
        if _order(version) > _order(VERSION):
            message = (
                f"was made by actuator-opt {shown(version)}, but this installation is {VERSION}"
            )
            raise InputError(Diagnostic(message, "install that version, or a later one"))
        verb, options = parsed(command)
        if options.plugin and not plugins:
            message = (
                f"was made with --plugin {options.plugin[0]}; a plug-in is a program and only runs "
                "if you name it"
            )
            raise InputError(Diagnostic(message, "name it with --plugin to run it"))
        pairs = [*((path, None) for path in options.unset), *map(_pair, options.set)]
    except InputError as error:
        raise InputError(
            [replace(x, file=x.file or str(path)) for x in error.diagnostics]
        ) from None
    loaded_plugins = plugins_of(plugins)
    files = run.get("files")
    actuator = read_as(attachment.source, name, set=pairs, plugins=loaded_plugins, files=files)
    subject, tables = _again(verb, options, actuator)
    recorded = run.get("result")
    differences: dict[str, tuple[Any, Any]] | None
    if isinstance(recorded, dict):
        differences = _differences(recorded, subject)
    else:  # in an older report, compare the hash of its content
        same = run.get("spec_hash", "") == _hash(subject)
        differences = {} if same else None
    return Rerun(
        file=path,
        command=command,
        version=version,
        date=date,
        subject=subject,
        actuator=actuator,
        tables=tuple(tables),
        repeats=None if differences is None else not differences,
        differences=differences or {},
        sentence=_sentence(differences, version),
    )


def _text(run: Mapping[str, Any], key: str) -> str:
    value = run.get(key)
    if not isinstance(value, str):
        raise InputError(Diagnostic(f"does not state its {key}", "use the original file"))
    return value


def _require_form(run: Mapping[str, Any]) -> str | None:
    """Check the form of the data attached to a report, and return its date."""
    fault, date = run_fault(run), run.get("date")
    if not fault and date is not None and not is_date(date):
        fault = "date is invalid"
    if fault:
        message = f"its attachment is damaged ({shown(fault)})"
        raise InputError(Diagnostic(message, "use the original file"))
    return date


def _order(version: str) -> tuple[int, ...]:
    """A version as a tuple of numbers, so that versions can be compared."""
    return tuple(int(part) for part in re.findall(r"\d{1,9}", version)[:3])


class _Parser(argparse.ArgumentParser):
    """Parser for the options of a report's command; an unknown option raises `InputError`."""

    def error(self, message: str) -> NoReturn:
        fault = f"its command cannot be repeated: {shown(message, 200)}"
        raise InputError(Diagnostic(fault, "run it by hand"))


def parser() -> argparse.ArgumentParser:
    """A parser with all options that affect the result of a command that can be repeated."""
    options = _Parser(prog="actuator-opt", add_help=False, allow_abbrev=False)
    options.add_argument("design")
    options.add_argument("--set", action="append", default=[])
    options.add_argument("--unset", action="append", default=[])
    options.add_argument("--plugin", action="append", default=[])
    options.add_argument("--starts", type=_within(STARTS), default=6)
    options.add_argument("--seed", type=_within(SEED), default=0)
    options.add_argument("--objective", action="append", default=[])
    options.add_argument("-n", type=_within(FRONT), default=50)
    options.add_argument("--checks", type=_within(CHECKS), default=3)
    options.add_argument("--yield", type=float, dest="yield_target")
    options.add_argument("--max-seconds", type=float)
    for name in _VALUES:
        options.add_argument(name)
    for name in _FLAGS:
        options.add_argument(name, action="store_true")
    return options


def parsed(command: str) -> tuple[str, argparse.Namespace]:
    """Command and options, parsed from the command line in a report."""
    if len(command) > _LONGEST:
        message = f"its command has more than {_LONGEST} characters"
        raise InputError(Diagnostic(message, "run it by hand"))
    try:
        words = shlex.split(command)
    except ValueError:
        words = ["actuator-opt", "?"]
    if len(words) < 2:
        message = "was made by a script and states no command"
        raise InputError(Diagnostic(message, "run the script"))
    verb = words[1]
    if words[0] != "actuator-opt" or verb not in OPTIMISED + EVALUATED + FRONTS:
        start = shown(" ".join(words[:2]))
        message = f"was made by {start}, which requires more input than a design"
        raise InputError(Diagnostic(message, f"run it by hand: {shown(command, 400)}"))
    options = parser().parse_args(words[2:])
    scenario = options.verify_dynamics
    if scenario == "-" or (scenario and Path(scenario).exists() and not Path(scenario).is_file()):
        message = f"its command needs the scenario {shown(scenario)}, which is not a regular file"
        raise InputError(Diagnostic(message, "run it by hand"))
    return verb, options


def _within(bounds: IntegerRange) -> Callable[[str], int]:
    """A function that parses a whole number; it refuses numbers outside the bounds."""

    def whole(text: str) -> int:
        if not re.fullmatch(r"[+-]?\d{1,19}", text):
            raise argparse.ArgumentTypeError(f"{shown(text)} is not a whole number")
        if not bounds.least <= int(text) <= bounds.most:
            raise argparse.ArgumentTypeError(f"give {bounds.least} to {bounds.most}")
        return int(text)

    return whole


def _pair(text: str) -> tuple[str, str]:
    from ..design import split_assignment

    return split_assignment(text)


def _again(
    verb: str, options: argparse.Namespace, actuator: Actuator
) -> tuple[Evaluation | Optimisation | ParetoFront, Sequence[Table]]:
    """The result of the repeated command, and the additional tables of its report."""
    if verb in EVALUATED:
        return evaluate(actuator, seed=options.seed), []
    if verb in FRONTS:
        effort = {"n": options.n, "seed": options.seed, "checks": options.checks}
        return pareto(actuator, options.objective, **effort), []
    if verb == "sensitivity":
        return optimise(actuator, seed=options.seed), []
    optimisation = optimise(
        actuator,
        algorithm=options.algorithm or "auto",
        starts=options.starts,
        seed=options.seed,
        max_seconds=options.max_seconds,
        whole_plies=options.whole_plies,
        standard_sizes=options.standard_sizes,
        shop=options.shop,
        certify=options.certify,
        yield_target=options.yield_target,
    )
    if options.verify_dynamics is None:
        return optimisation, []
    from .simulations import verify_dynamics

    verification = verify_dynamics(options.verify_dynamics, optimisation.best)
    return optimisation, verification_tables(verification)


def _differences(
    then: Mapping[str, Any], subject: Evaluation | Optimisation | ParetoFront
) -> dict[str, tuple[Any, Any]]:
    """Differences from the report: status, variables by PATH, metrics by name."""
    from ..optimisation.pareto import ParetoFront
    from ..pages.pareto import front_outcome
    from ..pages.report import outcome

    now = front_outcome(subject) if isinstance(subject, ParetoFront) else outcome(subject)
    differences: dict[str, tuple[Any, Any]] = {}
    if then.get("status") != now.get("status"):
        differences["status"] = (then.get("status"), now.get("status"))
    for key in ("variables", "metrics"):
        before, after = then.get(key) or {}, now.get(key) or {}
        for name in differing(before, after):
            differences[name] = (before.get(name), after.get(name))
    return differences


def _hash(subject: Evaluation | Optimisation | ParetoFront) -> str | None:
    """Hash of an evaluated design, to compare with the report's; None for a Pareto front."""
    from ..optimisation.pareto import ParetoFront
    from ..pages.report import parts_of

    return None if isinstance(subject, ParetoFront) else parts_of(subject)[0].spec_hash


def _sentence(differences: Mapping[str, tuple[Any, Any]] | None, version: str) -> str:
    """Sentence on whether the result is reproduced."""
    origin = f"the report was made by actuator-opt {version}"
    if version == VERSION:
        origin += ", the version of this installation"
    if differences is None:
        return f"the report has no result to compare with; {origin}"
    if not differences:
        return f"the result is reproduced; {origin}"
    if version != VERSION:
        origin += f", but this installation is {VERSION}"
    changes = sorted((_change(name, *x) for name, x in differences.items()), reverse=True)
    names = ", ".join(words for _, words in changes[:3])
    more = f" and {len(changes) - 3} more" if len(changes) > 3 else ""
    return f"the result is not reproduced: {names}{more}; {origin}"


def _change(name: str, then: Any, now: Any) -> tuple[float, str]:
    """Relative change of a value, and the change in words."""
    if isinstance(then, (int, float)) and isinstance(now, (int, float)) and then:
        change = abs(now / then - 1)
        return change, f"{shown(name)} {100 * (now / then - 1):+.3g} %"
    return float("inf"), f"{shown(name)} was {shown(then)} and is now {now}"
