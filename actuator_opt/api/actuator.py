"""A design as read, its faults, and the stamp that marks a saved optimum.

The stamp is the first line of the file. It contains a hash of the design, its material values and
the program's version. After any change of the design the hash no longer matches, and the file
counts as an ordinary design.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from ..base.arguments import Change, SetValues, guarded
from ..base.cluster import Cluster, connected
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError
from ..base.tables import OneLine
from ..design import Design, FileSource, Fraction, LoadedDesign, pairs, read_design, with_values
from ..design.reader import TEXT
from ..evaluation import Evaluation, PreparedDesign, compute, prepare
from ..evaluation.plugin import Plugin, View, collect, load, with_own

if TYPE_CHECKING:
    from ..optimisation.result import Optimisation

Result: TypeAlias = "Evaluation | Optimisation"
"""A result in place of a design: the design evaluated, or the design to build of an optimum."""

Plugins = Iterable["Plugin | Callable[[View], object] | str | Path"]


@dataclass(frozen=True, slots=True)
class Actuator(OneLine):
    """A design as read, with the line number of every value in its file, and the user's metrics."""

    design: Design
    source: FileSource | None = None
    plugins: tuple[Plugin, ...] = ()

    @property
    def in_short(self) -> tuple[str, str]:
        """The objective, and the numbers of variables and requirements."""
        return self.design.in_short

    def subject(self) -> PreparedDesign:
        """The design with the properties of its materials, in the form that the models take."""
        return prepare(self.design, plugins=self.plugins)

    def changed(self, values: Mapping[str, float | str | None]) -> Actuator:
        """Copy the actuator with new values, keyed by PATH (such as ``cylinder.stroke``).

        A value is a number in SI, or text with a unit; None removes the key.

        Raises
        ------
        UsageError : `values` is not a mapping
        InputError : a PATH is unknown, or a value does not suit it
        """
        require_changes(values, unset=True)
        quantities = with_own(self.plugins)
        changes = {k: float(x) if isinstance(x, Real) else x for k, x in values.items()}
        design = with_values(self.design, changes, metrics=quantities)
        return Actuator(design, self.source, self.plugins)


def require_changes(changes: object, *, unset: bool = False) -> None:
    """Refuse anything but a mapping from PATH to numbers and texts or, with `unset`, to None.

    Raises
    ------
    UsageError : it is not a mapping
    InputError : a PATH is not a text, or a value is neither a number nor a text
    """
    if not isinstance(changes, Mapping):
        message = f"changes: must be a mapping from PATH to number, not {type(changes).__name__}"
        raise UsageError(Diagnostic(message, 'write {"cylinder.stroke": "112 mm"}'))
    for path, value in changes.items():
        if not isinstance(path, str):
            message = f"must be a PATH, not {type(path).__name__}"
            raise InputError(Diagnostic(message, "write a text"))
        removed = unset and value is None
        if isinstance(value, bool) or not (removed or isinstance(value, (Real, str, Fraction))):
            message = f"must be a number, not {type(value).__name__}"
            advice = 'write SI, or a text with a unit such as "112 mm"'
            raise InputError(Diagnostic(message, advice, path=path))


def plugins_of(sources: Plugins) -> tuple[Plugin, ...]:
    """Load the plugins from decorated functions and Python files."""
    plugins: list[Plugin] = []
    for item in sources:
        if isinstance(item, Plugin):
            plugins.append(item)
        elif isinstance(item, (str, Path)):
            plugins += load(item)
        else:
            plugins += collect(item)
    names = [plugin.name for plugin in plugins]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(Diagnostic(f"the metric {twice} is declared twice", "rename one of them"))
    return tuple(plugins)


@guarded
def read(
    source: str | Path,
    *,
    set: SetValues = (),
    plugins: Plugins = (),
) -> Actuator:
    """Read a design file (a path, ``"-"`` for standard input, or the text itself).

    Parameters
    ----------
    source : path or text
    set : new values by PATH, such as ``{"cylinder.stroke": "112 mm"}``; a number without a unit is
        SI, and None removes the key, as ``--unset`` does
    plugins : the user's metrics and constraints: decorated functions or Python files

    Raises
    ------
    InputError
        lists every fault of the file, each with its line and remedy
    """
    if isinstance(source, Actuator | Design | Evaluation) or hasattr(source, "best_evaluation"):
        message = f"read: source is {type(source).__name__}, which needs no reading"
        remedy = "for new values, write design.changed({...})"
        if not isinstance(source, Actuator):
            remedy = "for new values, save it, and read the file with set"
        raise UsageError(Diagnostic(message, remedy))
    return _read(source, set, plugins)


def _read(
    source: str | Path,
    set: SetValues,
    plugins: Plugins,
    files: Mapping[str, str] | None = None,
) -> Actuator:
    loaded_plugins = plugins_of(plugins)
    loaded: LoadedDesign = read_design(
        source, overrides=pairs(set), metrics=with_own(loaded_plugins), files=files
    )
    return Actuator(loaded.design, loaded.source, loaded_plugins)


def read_as(
    text: str,
    name: str,
    *,
    set: Sequence[Change] = (),
    plugins: Plugins = (),
    files: Mapping[str, str] | None = None,
) -> Actuator:
    """The design in a text, as if read from a file with that name; parameters as for `read`.

    `files` are the texts of the cycle files that the design names, by name.
    """
    try:
        actuator = _read(f"{text}\n", set, plugins, files)
    except InputError as error:
        raise InputError(
            [replace(x, file=name if x.file == TEXT else x.file) for x in error.diagnostics]
        ) from None
    source = actuator.source
    assert source is not None
    document = replace(source.document, file=name, text=text)
    return replace(actuator, source=replace(source, document=document))


def as_actuator(design: Actuator | Design | Result | str | Path, plugins: Plugins = ()) -> Actuator:
    """Turn a design (file, text, `Design`, `Actuator` or result) into an `Actuator`.

    A result gives its design: an evaluation the design evaluated, an optimum the design to build.
    """
    if isinstance(design, Actuator):
        return design
    result = getattr(design, "best_evaluation", design)  # of an optimum, the design to build
    if isinstance(result, Evaluation):
        design = result.design
    if isinstance(design, Design):
        return Actuator(design, None, plugins_of(plugins))
    assert isinstance(design, str | Path)
    return read(design, plugins=plugins)


def fault_of(actuator: Actuator) -> Callable[[str, str, str], Diagnostic] | None:
    """Return a function that makes a `Diagnostic` from a variable's PATH, a fault and its remedy.

    The function adds the variable's line number in the file. If the design has no file, None is
    returned instead of a function.
    """
    return None if actuator.source is None else actuator.source.of_variable


@contextmanager
def located(actuator: Actuator) -> Iterator[None]:
    """Within this context, add the line in the design file to faults that only state a PATH."""
    try:
        yield
    except InputError as error:
        source = actuator.source
        if source is None or any(fault.file or not fault.path for fault in error.diagnostics):
            raise
        raise InputError(
            [
                source.diagnostic(fault.path, fault.message, fault.remedy)
                for fault in error.diagnostics
                if fault.path
            ]
        ) from None


def checked_design(
    design: Actuator | Design | Result | str | Path, plugins: Plugins
) -> tuple[Actuator, PreparedDesign]:
    """Read a design; return the `Actuator`, and the `PreparedDesign` that the models take.

    Raises
    ------
    InputError : the design has a requirement on a metric that does not exist for it
    """
    actuator = as_actuator(design, plugins)
    subject = actuator.subject()
    faults = requirement_faults(actuator, subject)
    if faults:
        raise InputError(faults)
    return actuator, subject


@contextmanager
def workers_for(actuator: Actuator, scheduler: str | None) -> Iterator[Cluster]:
    """Connect to the Dask scheduler at an address; None: this process computes everything.

    Raises
    ------
    UsageError : the design has custom metrics, or no cluster answers
    """
    if actuator.plugins and scheduler is not None:
        message = "custom metrics cannot be sent to other machines"
        raise UsageError(Diagnostic(message, "omit --scheduler or --plugin"))
    with connected(scheduler) as cluster:
        yield cluster


def requirement_faults(actuator: Actuator, subject: PreparedDesign) -> list[Diagnostic]:
    """Faults for requirements on metrics that do not exist for this design."""
    if not actuator.design.requirements:
        return []
    computed = compute(subject, subject.values()).computed
    faults = []
    for metric, limit in actuator.design.requirements.items():
        if computed.metrics.get(metric):
            continue
        path = f"requirements.{metric}.{'max' if limit.min is None else 'min'}"
        message = f"cannot be met: {computed.why.get(metric, 'it does not apply to this design')}"
        remedy = "remove the requirement, or add the inputs that it needs"
        source = actuator.source
        if source is None:
            faults.append(Diagnostic(message, remedy, path=path))
        else:
            faults.append(source.diagnostic(path, message, remedy))
    return faults


_STAMP = "# Written by actuator-opt optimise: an optimum as long as its spec hash is "
_LINE = re.compile(re.escape(_STAMP) + r"([0-9a-f]{16})\n")


def stamped(text: str, spec_hash: str) -> str:
    """The text of a design file with the stamp at its top; an older stamp is replaced."""
    return f"{_STAMP}{spec_hash}\n{_LINE.sub('', text, count=1)}"


def is_optimum(text: str, spec_hash: str) -> bool:
    """Whether a design file was saved as an optimum and is unchanged since."""
    stamp = _LINE.match(text)
    return stamp is not None and stamp[1] == spec_hash
