"""Scenarios: read with their design and records, simulated, written down."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import Diagnostic, InputError
from ..numeric import Array
from .actuator import Actuator

if TYPE_CHECKING:
    from ..design.scenario import LoadedScenario, Scenario
    from ..reporting import ReportFile
    from ..simulation import Simulation
    from ..simulation.integrate import Method

MOST_BYTES = 200_000_000
"""Largest file of a recorded input (a choice)."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A scenario as read, with its design as it is there and the records it names."""

    scenario: Scenario
    actuator: Actuator
    records: Mapping[tuple[str, str], tuple[Array, Array]]
    loaded: LoadedScenario


def read_scenario(
    source: str | Path, *, set: Mapping[str, str | float] | Sequence[tuple[str, str]] = ()
) -> Trial:
    """Read a scenario file (a path, ``"-"`` for standard input, or the text itself).

    Parameters
    ----------
    source : path or text
    set : values to replace, by PATH of the scenario, else of its design; a bare number is SI

    Raises
    ------
    InputError
        with every fault of scenario, design and records, each with its place and remedy
    """
    from ..design.scenario import read_design_of
    from ..design.scenario import read_scenario as read

    pairs = set.items() if isinstance(set, Mapping) else set
    loaded = read(source, overrides=[(path, str(value)) for path, value in pairs])
    design = read_design_of(loaded)
    actuator = Actuator(design.design, design.source)
    return Trial(loaded.scenario, actuator, _records(loaded), loaded)


def _records(loaded: LoadedScenario) -> dict[tuple[str, str], tuple[Array, Array]]:
    """Every column that a signal of the scenario names."""
    from ..design.scenario import recorded_parts
    from ..identification import decode_record, parse_column
    from ..store import read_bytes

    found: dict[tuple[str, str], tuple[Array, Array]] = {}
    texts: dict[str, str] = {}
    for path, part, dimension in recorded_parts(loaded.scenario):
        file, column = str(part.file), str(part.column)
        name = str(loaded.folder / file)
        try:
            if file not in texts:
                kinds = (".csv", ".txt", ".tsv")
                data = read_bytes(
                    loaded.folder / file, most=MOST_BYTES + 1, kinds=kinds, what="CSV file"
                )
                texts[file] = decode_record(data, name, most=MOST_BYTES)
            found[file, column] = parse_column(texts[file], column, dimension, name=name)
        except InputError as error:
            raise InputError([_where(fault, path, loaded) for fault in error.diagnostics]) from None
    return found


def _where(fault: Diagnostic, path: str, loaded: LoadedScenario) -> Diagnostic:
    """A fault of a record without a line stands where the scenario names the file."""
    if fault.line is not None:
        return fault
    return loaded.diagnostic(path, f"{fault.file}: {fault.message}", fault.remedy)


def simulate(
    scenario: Trial | str | Path,
    *,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
    verify: bool = False,
    method: Method = "lsoda",
) -> Simulation:
    """A scenario around its design over time.

    Parameters
    ----------
    scenario : as read, or its path
    set : as `read_scenario`
    verify : integrate again by another method and tell the difference
    method : "lsoda"; "cvodes" is faster (extra ``fast``); "radau"

    Raises
    ------
    InputError
        as `read_scenario`; a gain that no rule gives
    Unsolvable
        where the integration cannot go on, with the time
    """
    from ..simulation import simulate as run

    trial = as_trial(scenario, set)
    with placed(trial):
        return run(
            trial.scenario,
            trial.actuator.subject(),
            records=trial.records,
            verify=verify,
            method=method,
        )


@contextmanager
def placed(trial: Trial) -> Iterator[None]:
    """Give faults of a scenario's values their place in its file."""
    try:
        yield
    except InputError as error:
        raise InputError(
            [
                trial.loaded.diagnostic(fault.path, fault.message, fault.remedy)
                if fault.path is not None and fault.file is None
                else fault
                for fault in error.diagnostics
            ]
        ) from None


def as_trial(
    scenario: Trial | str | Path,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
) -> Trial:
    """Any form of a scenario as read."""
    if not isinstance(scenario, Trial):
        return read_scenario(scenario, set=set)
    if set:
        message = "values are set, and the scenario is read already"
        raise InputError(Diagnostic(message, "set them in read_scenario"))
    return scenario


def write_signals(simulation: Simulation, path: str | Path) -> ReportFile:
    """Write every signal of a simulation as CSV."""
    from ..reporting.simulation_csv import write_signals as write

    return write(simulation, Path(path))
