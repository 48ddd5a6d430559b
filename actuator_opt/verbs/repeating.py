"""`rerun`: the command of a report once more, from the input that the PDF carries."""

from __future__ import annotations

import argparse
import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from ..errors import Diagnostic, InputError
from ..evaluation import Evaluation
from ..version import VERSION
from .actuator import Actuator, Plugins, plugins_of, read_as
from .fronts import pareto
from .optimum import evaluate, optimise
from .recorded_runs import differing

if TYPE_CHECKING:
    from ..optimisation.pareto_result import ParetoFront
    from ..optimisation.result import Optimisation
    from ..reporting import ExtraTable

OPTIMISED, EVALUATED = ("optimise", "optimize", "sensitivity"), ("evaluate", "report")
FRONTS = ("pareto",)
"""Commands that can be run again."""
_VALUES = ("--algorithm", "--verify-dynamics", "--date")
_FLAGS = ("--whole-plies", "--standard-sizes", "--certify")


@dataclass(frozen=True, slots=True)
class Rerun:
    """What a report's command gives now, beside what it gave then.

    `repeats` is None where the report carries no result to compare; `differences` maps what is
    not the same to its value then and now.
    """

    file: Path
    command: str
    version: str
    date: str | None
    subject: Evaluation | Optimisation | ParetoFront
    actuator: Actuator
    tables: tuple[ExtraTable, ...]
    repeats: bool | None
    differences: Mapping[str, tuple[Any, Any]]
    sentence: str

    def to_dict(self) -> dict[str, Any]:
        """The `rerun --json` object: that of the command, and `rerun`."""
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


def rerun(report: str | Path, *, plugins: Plugins = ()) -> Rerun:
    """Run the command of a report again, from the input attached to its PDF.

    Parameters
    ----------
    report : the PDF
    plugins : the Python files it was made with; they are programs, so never taken by themselves

    Raises
    ------
    InputError
        no PDF of this program, encrypted, damaged, of a newer version, or of a command that
        needs more than the design
    """
    from ..reporting import read_attachment

    path = Path(report)
    inside = read_attachment(path)
    try:
        run = {key: _text(inside.run, key) for key in ("actuator_opt", "command", "source_name")}
        if _order(run["actuator_opt"]) > _order(VERSION):
            message = f"was made by actuator-opt {run['actuator_opt']}, this is {VERSION}"
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
    else:  # an older report: the hash of what it shows says as much where it is the same
        same = inside.run.get("spec_hash", "") == _hash(subject)
        found = {} if same else None
    return Rerun(
        file=path,
        command=run["command"],
        version=run["actuator_opt"],
        date=inside.run.get("date"),
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
        raise InputError(Diagnostic(f"does not say its {key}", "take the original file"))
    return value


def _order(version: str) -> tuple[int, ...]:
    """A version as numbers, to compare."""
    return tuple(int(part) for part in re.findall(r"\d+", version)[:3])


class _Parser(argparse.ArgumentParser):
    """Options of a report's command; what is not among them is told as a fault."""

    def error(self, message: str) -> NoReturn:
        told = f"its command cannot be run again: {message}"
        raise InputError(Diagnostic(told, "run it by hand"))


def parser() -> argparse.ArgumentParser:
    """The options that change a result, of the commands that can be run again."""
    made = _Parser(prog="actuator-opt", add_help=False, allow_abbrev=False)
    made.add_argument("design")
    made.add_argument("--set", action="append", default=[])
    made.add_argument("--plugin", action="append", default=[])
    made.add_argument("--starts", type=int, default=6)
    made.add_argument("--seed", type=int, default=0)
    made.add_argument("--objective", action="append", default=[])
    made.add_argument("-n", type=int, default=50)
    made.add_argument("--checks", type=int, default=3)
    made.add_argument("--yield", type=float, dest="yield_target")
    for name in _VALUES:
        made.add_argument(name)
    for name in _FLAGS:
        made.add_argument(name, action="store_true")
    return made


def parsed(command: str) -> tuple[str, argparse.Namespace]:
    """Verb and options of a command line as a report carries it."""
    try:
        words = shlex.split(command)
    except ValueError:
        words = ["actuator-opt", "?"]
    if len(words) < 2:
        message = "was made by a script and says no command"
        raise InputError(Diagnostic(message, "run the script"))
    verb = words[1]
    if words[0] != "actuator-opt" or verb not in OPTIMISED + EVALUATED + FRONTS:
        message = f"was made by {' '.join(words[:2])}, whose input is more than a design"
        raise InputError(Diagnostic(message, f"run it by hand: {command}"))
    return verb, parser().parse_args(words[2:])


def _pair(text: str) -> tuple[str, str]:
    from ..design import split_assignment

    return split_assignment(text)


def _again(
    verb: str, asked: argparse.Namespace, actuator: Actuator
) -> tuple[Evaluation | Optimisation | ParetoFront, Sequence[ExtraTable]]:
    """The result of the command, and the further tables of its report."""
    if verb in EVALUATED:
        return evaluate(actuator), []
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
    from ..reporting.verification_rows import verification_rows
    from .simulations import verify_dynamics

    return found, verification_rows(verify_dynamics(asked.verify_dynamics, found.best))


def _differences(
    then: Mapping[str, Any], subject: Evaluation | Optimisation | ParetoFront
) -> dict[str, tuple[Any, Any]]:
    """What is not the same now: status, variables by PATH, metrics by name."""
    from ..optimisation.pareto_result import ParetoFront
    from ..reporting.pareto_rows import front_outcome
    from ..reporting.writer import outcome

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
    """The hash that a report of it carries; None where that is of the input alone."""
    from ..optimisation.pareto_result import ParetoFront
    from ..reporting.page import parts_of

    return None if isinstance(subject, ParetoFront) else parts_of(subject)[0].spec_hash


def _sentence(found: Mapping[str, tuple[Any, Any]] | None, version: str) -> str:
    """Whether it repeats, in words."""
    made = f"the report was made by actuator-opt {version}"
    also = made if version != VERSION else f"{made}, as is this"
    if found is None:
        return f"the report carries no result to compare with; {also}"
    if not found:
        return f"the result repeats; {also}"
    parts = [_change(name, *values) for name, values in found.items()]
    parts.sort(reverse=True)
    names = ", ".join(words for _, words in parts[:3])
    more = f" and {len(parts) - 3} more" if len(parts) > 3 else ""
    here = also if version == VERSION else f"{made}, this is {VERSION}"
    return f"the result does not repeat: {names}{more}; {here}"


def _change(name: str, then: Any, now: Any) -> tuple[float, str]:
    """How far one value moved, as a fraction, and in words."""
    if isinstance(then, (int, float)) and isinstance(now, (int, float)) and then:
        moved = abs(now / then - 1)
        return moved, f"{name} {100 * (now / then - 1):+.3g} %"
    return float("inf"), f"{name} {then} before, {now} now"
