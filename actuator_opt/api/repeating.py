"""`rerun`: repeat the command of a report from the input attached to its PDF."""

from __future__ import annotations

import argparse
import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Unpack

from ..base.bounds import CHECKS, FRONT, SEED, STARTS, IntegerRange
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
"""Commands that can be repeated."""
_VALUES = ("--algorithm", "--verify-dynamics", "--date")
_FLAGS = ("--whole-plies", "--standard-sizes", "--certify")
_LONGEST = 100_000
"""Maximum length of a command, below the system's limit for one argument."""


@dataclass(frozen=True, slots=True)
class Rerun(Displayed):
    """The repeated result of a report's command, compared with the original.

    `repeats` is None if the report has no result to compare; `differences` maps what has changed to
    its value then and now.
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

    def to_dict(self) -> dict[str, Any]:
        """The `rerun --json` object: that of the command, with `rerun`."""
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
        """Write the report again, with the original command and date."""
        paper |= {"actuator": self.actuator, "command": self.command, "date": self.date}
        tables: dict[str, Any] = {"extra_tables": self.tables} if self.tables else {}
        return results.report(self.subject, **paper, **tables)

    def record(self, **paper: Any) -> Run | None:
        """Record the run, if its command does so."""
        paper |= {"actuator": self.actuator, "command": self.command, "date": self.date}
        tables: dict[str, Any] = {"extra_tables": self.tables} if self.tables else {}
        return results.keep(self.subject, **paper, **tables)


def rerun(report: str | Path, *, plugins: Plugins = ()) -> Rerun:
    """Repeat the command of a report, from the input attached to its PDF.

    Parameters
    ----------
    report : the PDF
    plugins : the Python files it was made with; as programs, they are never run unless named

    Raises
    ------
    InputError
        not a PDF of this program; encrypted, damaged or of a newer version; or of a command that
        needs more than the design
    """
    from ..pages import read_attachment

    path = Path(report)
    inside = read_attachment(path)
    try:
        run = {key: _text(inside.run, key) for key in ("actuator_opt", "command", "source_name")}
        date = _require_facts(inside.run)
        if _order(run["actuator_opt"]) > _order(VERSION):
            message = f"was made by actuator-opt {shown(run['actuator_opt'])}, this is {VERSION}"
            raise InputError(Diagnostic(message, "install that version, or a later one"))
        verb, asked = parsed(run["command"])
        if asked.plugin and not plugins:
            message = f"was made with --plugin {asked.plugin[0]}, which is a program"
            raise InputError(Diagnostic(message, "name it with --plugin to run it"))
        pairs = [_pair(text) for text in asked.set]
    except InputError as error:
        raise InputError(
            [replace(x, file=x.file or str(path)) for x in error.diagnostics]
        ) from None
    own = plugins_of(plugins)
    actuator = read_as(inside.source, run["source_name"], set=pairs, plugins=own)
    subject, tables = _again(verb, asked, actuator)
    then = inside.run.get("result")
    found: dict[str, tuple[Any, Any]] | None
    if isinstance(then, dict):
        found = _differences(then, subject)
    else:  # an older report: an equal hash of its content is just as good
        same = inside.run.get("spec_hash", "") == _hash(subject)
        found = {} if same else None
    return Rerun(
        file=path,
        command=run["command"],
        version=run["actuator_opt"],
        date=date,
        subject=subject,
        actuator=actuator,
        tables=tuple(tables),
        repeats=None if found is None else not found,
        differences=found or {},
        sentence=_sentence(found, run["actuator_opt"]),
    )


def _text(run: Mapping[str, Any], key: str) -> str:
    value = run.get(key)
    if not isinstance(value, str):
        raise InputError(Diagnostic(f"does not state its {key}", "use the original file"))
    return value


def _require_facts(run: Mapping[str, Any]) -> str | None:
    """The date in the facts of a report; rejects facts in another form."""
    fault, date = run_fault(run), run.get("date")
    if not fault and date is not None and not is_date(date):
        fault = "date is invalid"
    if fault:
        message = f"its attachment is damaged ({shown(fault)})"
        raise InputError(Diagnostic(message, "use the original file"))
    return date


def _order(version: str) -> tuple[int, ...]:
    """A version as numbers, for comparison."""
    return tuple(int(part) for part in re.findall(r"\d{1,9}", version)[:3])


class _Parser(argparse.ArgumentParser):
    """Options of a report's command; other options are reported as a fault."""

    def error(self, message: str) -> NoReturn:
        told = f"its command cannot be repeated: {shown(message, 200)}"
        raise InputError(Diagnostic(told, "run it by hand"))


def parser() -> argparse.ArgumentParser:
    """The options that affect a result, for the commands that can be repeated."""
    made = _Parser(prog="actuator-opt", add_help=False, allow_abbrev=False)
    made.add_argument("design")
    made.add_argument("--set", action="append", default=[])
    made.add_argument("--plugin", action="append", default=[])
    made.add_argument("--starts", type=_within(STARTS), default=6)
    made.add_argument("--seed", type=_within(SEED), default=0)
    made.add_argument("--objective", action="append", default=[])
    made.add_argument("-n", type=_within(FRONT), default=50)
    made.add_argument("--checks", type=_within(CHECKS), default=3)
    made.add_argument("--yield", type=float, dest="yield_target")
    for name in _VALUES:
        made.add_argument(name)
    for name in _FLAGS:
        made.add_argument(name, action="store_true")
    return made


def parsed(command: str) -> tuple[str, argparse.Namespace]:
    """Command and options of the command line in a report."""
    if len(command) > _LONGEST:
        message = f"its command has more than {_LONGEST} letters"
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
        made = shown(" ".join(words[:2]))
        message = f"was made by {made}, which needs more input than a design"
        raise InputError(Diagnostic(message, f"run it by hand: {shown(command, 400)}"))
    asked = parser().parse_args(words[2:])
    scenario = asked.verify_dynamics
    if scenario == "-" or (scenario and Path(scenario).exists() and not Path(scenario).is_file()):
        message = f"its command needs the scenario {shown(scenario)}, which is not a regular file"
        raise InputError(Diagnostic(message, "run it by hand"))
    return verb, asked


def _within(bounds: IntegerRange) -> Callable[[str], int]:
    """A function that reads a whole number within bounds, as the terminal does."""

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
    verb: str, asked: argparse.Namespace, actuator: Actuator
) -> tuple[Evaluation | Optimisation | ParetoFront, Sequence[Table]]:
    """The result of the command, and the further tables of its report."""
    if verb in EVALUATED:
        return evaluate(actuator, seed=asked.seed), []
    if verb in FRONTS:
        how = {"n": asked.n, "seed": asked.seed, "checks": asked.checks}
        return pareto(actuator, asked.objective, **how), []
    if verb == "sensitivity":
        return optimise(actuator, seed=asked.seed), []
    found = optimise(
        actuator,
        algorithm=asked.algorithm or "auto",
        starts=asked.starts,
        seed=asked.seed,
        whole_plies=asked.whole_plies,
        standard_sizes=asked.standard_sizes,
        certify=asked.certify,
        yield_target=asked.yield_target,
    )
    if asked.verify_dynamics is None:
        return found, []
    from .simulations import verify_dynamics

    return found, verification_tables(verify_dynamics(asked.verify_dynamics, found.best))


def _differences(
    then: Mapping[str, Any], subject: Evaluation | Optimisation | ParetoFront
) -> dict[str, tuple[Any, Any]]:
    """Changes: status, variables by PATH, metrics by name."""
    from ..optimisation.pareto import ParetoFront
    from ..pages.pareto import front_outcome
    from ..pages.report import outcome

    now = front_outcome(subject) if isinstance(subject, ParetoFront) else outcome(subject)
    found: dict[str, tuple[Any, Any]] = {}
    if then.get("status") != now.get("status"):
        found["status"] = (then.get("status"), now.get("status"))
    for key in ("variables", "metrics"):
        before, after = then.get(key) or {}, now.get(key) or {}
        for name in differing(before, after):
            found[name] = (before.get(name), after.get(name))
    return found


def _hash(subject: Evaluation | Optimisation | ParetoFront) -> str | None:
    """The hash in its report; None if that only covers the input."""
    from ..optimisation.pareto import ParetoFront
    from ..pages.report import parts_of

    return None if isinstance(subject, ParetoFront) else parts_of(subject)[0].spec_hash


def _sentence(found: Mapping[str, tuple[Any, Any]] | None, version: str) -> str:
    """Whether the result is reproduced, in words."""
    made = f"the report was made by actuator-opt {version}"
    also = made if version != VERSION else f"{made}, the same as this one"
    if found is None:
        return f"the report has no result to compare with; {also}"
    if not found:
        return f"the result is reproduced; {also}"
    parts = [_change(name, *values) for name, values in found.items()]
    parts.sort(reverse=True)
    names = ", ".join(words for _, words in parts[:3])
    more = f" and {len(parts) - 3} more" if len(parts) > 3 else ""
    here = also if version == VERSION else f"{made}, but this is {VERSION}"
    return f"the result is not reproduced: {names}{more}; {here}"


def _change(name: str, then: Any, now: Any) -> tuple[float, str]:
    """Relative change of a value, with the change in words."""
    if isinstance(then, (int, float)) and isinstance(now, (int, float)) and then:
        moved = abs(now / then - 1)
        return moved, f"{shown(name)} {100 * (now / then - 1):+.3g} %"
    return float("inf"), f"{shown(name)} {shown(then)} before, {now} now"
