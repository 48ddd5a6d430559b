"""Reads scenarios with their designs and records, simulates them, and writes reports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base.arguments import SetValues, guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError
from ..base.numeric import Array
from ..base.tables import Displayed, OneLine
from ..design import Design, pairs
from ..studies.plant import plant
from .actuator import Actuator, Result, as_actuator
from .records import Units
from .reports import ReportArguments, ReportPlace, page_of, published

if TYPE_CHECKING:
    from ..design.scenario import LoadedScenario, Scenario
    from ..pages import ReportFile
    from ..rendering.blocks import Block, Origin
    from ..simulation import Simulation
    from ..simulation.integrate import Method
    from ..simulation.measured import Overlay
    from ..simulation.measured.fit import Fit
    from ..simulation.sensitivity import Sensitivities
    from ..simulation.verification import Verification

MOST_BYTES = 200_000_000
"""Largest permitted file of a recorded input [bytes]: our choice."""


@dataclass(frozen=True, slots=True)
class Trial(OneLine):
    """A scenario as read, with its records, and its design with the values that it changes."""

    scenario: Scenario
    actuator: Actuator
    records: Mapping[tuple[str, str], tuple[Array, Array]]
    loaded: LoadedScenario

    @property
    def in_short(self) -> tuple[str, str]:
        """The scenario's duration and its design."""
        return self.scenario.name, f"{self.scenario.duration:g} s with {self.actuator.design.name}"

    def inputs(
        self, actuator: Actuator | None = None
    ) -> tuple[Scenario, Mapping[tuple[str, str], tuple[Array, Array]]]:
        """The scenario and its records; with the signals of a duty cycle for a design.

        Raises
        ------
        InputError
            the linkage of the design cannot follow the duty cycle
        """
        from ..simulation.duty_cycle import with_cycle

        if self.scenario.cycle is None:
            return self.scenario, self.records
        scenario, records = with_cycle(self.scenario, (actuator or self.actuator).subject())
        return scenario, {**self.records, **records}

    @property
    def files(self) -> list[Path]:
        """The files of the design and of all records."""
        records = [self.loaded.folder / file for file, _ in self.records]
        return [self.loaded.design_file, *records]


@guarded
def read_scenario(
    source: str | Path,
    *,
    set: SetValues = (),
    units: Units = None,
) -> Trial:
    """Read a scenario file (a path, ``"-"`` for standard input, or the text itself).

    Parameters
    ----------
    source : path or text
    set : values to replace, by PATH in the scenario, or else in its design; a number without a unit
        is SI, and None removes the key
    units : units of the recorded inputs' columns whose header states no unit, as for `read_record`

    Raises
    ------
    InputError
        lists every fault of scenario, design and records, each with its line and remedy
    """
    from ..design.scenario import read_design_of, read_scenario as read

    loaded = read(source, overrides=pairs(set))
    design = read_design_of(loaded)
    actuator = Actuator(design.design, design.source)
    return Trial(loaded.scenario, actuator, _records(loaded, units), loaded)


LONGEST = 1e4
"""Simulated time with which a scenario is read before its period is known [s]."""
FINEST = 1e-3
"""Longest sample time of a simulated duty cycle [s] (our choice: peaks are taken from samples)."""


@guarded
def cycle_scenario(
    design: str | Path, cycle: str, *, periods: int = 3, set: SetValues = ()
) -> Trial:
    """Make a scenario of a duty cycle: position and force over time of several periods.

    Parameters
    ----------
    design : file of the design
    cycle : name of the duty cycle
    periods : number of periods; the last is compared with the quasi-static results
    set : values to replace, by PATH in the scenario, or else in the design

    Raises
    ------
    InputError
        as for `read_scenario`; or the design has no such duty cycle
    """
    from ..design.scenario import read_design_of, read_scenario as read
    from ..design.writer import scalar
    from ..simulation.duty_cycle import cycle_of

    if str(design) == "-" or not 1 <= periods <= MOST_PERIODS:
        message = f"{periods} periods: write 1 to {MOST_PERIODS}"
        if str(design) == "-":
            message = "a duty cycle needs the file of its design"
        raise UsageError(Diagnostic(message, "name the design file, and 1 to 100 periods"))

    def loaded(duration: float, sample_time: float) -> LoadedScenario:
        text = (
            f"name: {scalar(cycle)}\ndesign: {scalar(Path(design).name)}\n"
            f"cycle: {scalar(cycle)}\n"
            f"duration: {duration:.12g} s\nsample_time: {sample_time:.12g} s\n"
        )
        return replace(read(text, overrides=pairs(set)), folder=Path(design).parent)

    first = loaded(LONGEST, 1.0)
    duty = cycle_of(first.scenario, read_design_of(first).design)
    assert duty is not None  # else `read_design_of` raises
    period = duty.record.duration * duty.time_scale
    duration = (periods if duty.closed else 1) * period
    scenario = loaded(duration, min(FINEST, period / 1000))
    actuator = read_design_of(scenario)
    return Trial(scenario.scenario, Actuator(actuator.design, actuator.source), {}, scenario)


MOST_PERIODS = 100
"""Largest number of periods of a simulated duty cycle (our choice)."""


def _records(loaded: LoadedScenario, units: Units) -> dict[tuple[str, str], tuple[Array, Array]]:
    """Columns of the records that the scenario's signals use, by file and column."""
    from ..base.sheets import read_text
    from ..design.scenario import recorded_parts
    from ..identification import column_units, parse_column

    known_units = column_units(units)
    records: dict[tuple[str, str], tuple[Array, Array]] = {}
    texts: dict[str, str] = {}
    for path, part, dimension in recorded_parts(loaded.scenario):
        file, column = str(part.file), str(part.column)
        name = str(loaded.folder / file)
        try:
            if file not in texts:
                texts[file] = read_text(name, most=MOST_BYTES)
            records[file, column] = parse_column(
                texts[file], column, dimension, name=name, units=known_units
            )
        except InputError as error:
            at = path if file in texts else f"{path.removesuffix('column')}file"
            raise InputError([_where(fault, at, loaded) for fault in error.diagnostics]) from None
    return records


def _where(fault: Diagnostic, path: str, loaded: LoadedScenario) -> Diagnostic:
    """If a record's fault has no line, add the line where the scenario names the file."""
    if fault.line is not None:
        return fault
    return loaded.diagnostic(path, f"{fault.file}: {fault.message}", fault.remedy)


@guarded
def simulate(
    scenario: Trial | str | Path,
    *,
    set: SetValues = (),
    verify: bool = False,
    margins: bool = False,
    method: Method = "lsoda",
) -> Simulation:
    """Simulate a scenario with its design.

    Parameters
    ----------
    scenario : the scenario as read, or the path of its file
    set : values to replace, by PATH in the scenario, or else in its design; a number without a unit
        is SI, and None removes the key
    verify : whether to integrate again by another method and compare the results
    margins : whether to compute the margins of the control loop even if its gain is stated; they
        are always computed for a gain that is tuned by them
    method : integration method: "lsoda" (the faster) or "radau"

    Returns
    -------
    the results, SI: `signals` by name over `time`, `told` (label and quantity of each signal),
    `values` by the names in `quantities.RESULTS` (a value may be None; `why` has the reason),
        `requirements`,
    `servo`, `balance`, `events`, `notes`; when printed, they appear as a table

    Raises
    ------
    InputError
        as for `read_scenario`; or a gain must be tuned, but its control law has no tuning rule
    Unsolvable
        the integration fails; the message states the time
    """
    from ..simulation import simulate as run

    trial = as_trial(scenario, set)
    with placed(trial):
        inputs, records = trial.inputs()
        return run(
            inputs,
            trial.actuator.subject(),
            records=records,
            verify=verify,
            margins=margins,
            method=method,
        )


@contextmanager
def placed(trial: Trial) -> Iterator[None]:
    """Add the line in the scenario file to faults of the scenario's values."""
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
    set: SetValues = (),
) -> Trial:
    """Turn a scenario in any form into a scenario as read."""
    if not isinstance(scenario, Trial):
        return read_scenario(scenario, set=set)
    if set:
        message = "cannot set values, because the scenario is already read"
        raise InputError(Diagnostic(message, "set them in read_scenario"))
    return scenario


@guarded
def write_signals(simulation: Simulation, path: str | Path) -> ReportFile:
    """Write every signal of a simulation as CSV."""
    from ..pages.simulation import series
    from ..rendering.series import write_csv

    return write_csv(series(simulation), Path(path))


@dataclass(frozen=True, slots=True)
class Compared(Displayed):
    """A simulation compared with a measured record, and the parameters fitted to that record."""

    overlay: Overlay
    """Simulation and record together; if parameters were fitted, the simulation uses the fitted
    values."""
    fit: Fit | None = None

    @property
    def in_short(self) -> tuple[str, str]:
        """The parameters that were fitted to the record."""
        fit = self.fit
        fitted = (
            "no parameter fitted" if fit is None else f"{len(fit.parameters)} parameters fitted"
        )
        return self.simulation.scenario.name, f"with {self.overlay.measured.name}, {fitted}"

    @property
    def simulation(self) -> Simulation:
        """The simulation that is compared with the record."""
        return self.overlay.simulation

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return self.overlay.to_dict() if self.fit is None else self.fit.to_dict()

    def blocks(self) -> list[Block]:
        """Blocks of text that follow those of the simulation."""
        from ..pages.measured import blocks

        return blocks(self.overlay, self.fit)

    def report(self, **paper: Any) -> list[ReportFile]:
        """Write the page of simulation and record; parameters as for `write_simulation`."""
        return write_simulation(self.simulation, measured=self, **paper)


@guarded
def compare_measured(
    scenario: Trial | str | Path,
    record: str | Path,
    *,
    fit: Sequence[str] = (),
    columns: Mapping[str, str] | None = None,
    units: Units = None,
    verify: bool = False,
    margins: bool = False,
    method: Method = "lsoda",
    simulation: Simulation | None = None,
) -> Compared:
    """Compare a scenario with a measured record: residuals, and parameters fitted to the record.

    Parameters
    ----------
    scenario : the scenario as read, or the path of its file
    record : CSV file with t and any of p1, p2, x, v, F_L, ...
    fit : names of the parameters to fit, such as ``air_content``; see
        `simulation.measured.parameters`
    columns : header of every channel whose header is not a known name
    units : units of columns without a unit in their header, as for `read_record`
    verify, margins, method : as for `simulate`; if parameters are fitted, for the run with the
        fitted values
    simulation : result of the scenario, if it has been run already

    Raises
    ------
    InputError
        as for `read_scenario`; or record and simulation do not overlap, or a parameter is unknown
    """
    from ..base.sheets import read_text
    from ..identification import column_units
    from ..simulation.linear import tune
    from ..simulation.measured import overlay, parse_measured
    from ..simulation.measured.fit import fit as fitted
    from ..simulation.run import spec_of

    trial = as_trial(scenario)
    measured = parse_measured(
        read_text(record, most=MOST_BYTES),
        name=str(record), columns=columns, units=column_units(units),
    )  # fmt: skip
    with placed(trial):
        if not fit:
            simulation = simulation or simulate(
                trial, verify=verify, margins=margins, method=method
            )
            return Compared(overlay(simulation, measured))
        subject = trial.actuator.subject()
        actuator = plant(subject)
        inputs, records = trial.inputs()
        result = fitted(
            inputs, actuator, records, measured, fit,
            tuned=tune(inputs, actuator, records, with_margins=margins),
            verify=verify, method=method, spec=spec_of(subject, inputs),
        )  # fmt: skip
    return Compared(result.after, result)


@guarded
def servo_sensitivities(
    scenario: Trial | str | Path, names: Sequence[str] | None = None
) -> Sensitivities:
    """Rank parameters of a scenario and its design by their effect on the results.

    Parameters
    ----------
    scenario : the scenario as read, or the path of its file
    names : PATHs of the parameters; default: the usual parameters of a servo
    """
    from ..simulation.sensitivity import sensitivities

    trial = as_trial(scenario)
    with placed(trial):
        inputs, records = trial.inputs()
        return sensitivities(inputs, trial.actuator.subject(), names, records=records)


@guarded
def verify_dynamics(
    scenario: Trial | str | Path, design: Actuator | Design | Result | str | Path | None = None
) -> Verification:
    """Verify by simulation every dynamic requirement of a design and of a scenario.

    Parameters
    ----------
    scenario : the scenario as read, or the path of its file
    design : a design in place of the scenario's own; it gets the values that the scenario sets

    Raises
    ------
    InputError
        the scenario simulates a duty cycle, in which the load has no mass
    """
    from ..simulation.verification import verify

    trial = as_trial(scenario)
    _require_load(trial)
    actuator = trial.actuator if design is None else fitting(trial, design)
    with placed(trial):
        inputs, records = trial.inputs(actuator)
        return verify(inputs, actuator.subject(), records=records)


def _require_load(trial: Trial) -> None:
    """Refuse the scenario of a duty cycle, in which the load has no mass."""
    if trial.scenario.cycle is not None:
        message = (
            "dynamic requirements depend on the mass of the load, which a duty cycle leaves out"
        )
        remedy = "use a scenario with control or signal in place of cycle"
        raise InputError(replace(trial.loaded.diagnostic("cycle", message), remedy=remedy))


def fitting(trial: Trial, design: Actuator | Design | Result | str | Path) -> Actuator:
    """Do as `with_design`, but refuse a scenario in which another component replaces the cylinder.

    Raises
    ------
    InputError
        the scenario does not fit this design, has a motor or held ports in place of a cylinder,
        or simulates a duty cycle
    """
    _require_load(trial)
    scenario = trial.scenario
    for key in ("motor", "held_ports"):
        if getattr(scenario, key) is not None:
            fault = trial.loaded.diagnostic(key, "replaces the cylinder")
            raise InputError(replace(fault, remedy="use a scenario without this block"))
    return with_design(trial, design)


def with_design(trial: Trial, design: Actuator | Design | Result | str | Path) -> Actuator:
    """Put another design into a scenario, with the values that the scenario sets.

    Raises
    ------
    InputError
        the scenario does not fit this design
    """
    from ..design.scenario import design_faults

    scenario, source = trial.scenario, trial.loaded.source
    changes = {change.path: change.value for change in trial.loaded.changes}
    actuator = as_actuator(design)
    actuator = actuator.changed(changes) if changes else actuator
    faults = sorted(design_faults(scenario, actuator.design), key=source.place)
    if faults:
        raise InputError([source.at(fault) for fault in faults])
    return actuator


@guarded
def write_simulation(
    simulation: Simulation,
    scenario: Trial | None = None,
    *,
    measured: Compared | None = None,
    sensitivities: Sensitivities | None = None,
    **paper: Unpack[ReportArguments],
) -> list[ReportFile]:
    """Write the page of a simulation (PDF and PNG) and attach the scenario.

    The page shows the margins of the control loop; they are computed if the simulation has none.

    Parameters
    ----------
    simulation : result of `simulate`
    scenario : the scenario as read
    measured, sensitivities : further results to show
    paper : as for `report`; the page is named after the scenario's file

    Raises
    ------
    UsageError : `scenario` is missing; it is needed because a simulation does not contain the file
    """
    from ..pages.measured import drawn
    from ..pages.simulation import page
    from ..pages.verification import sensitivity_blocks
    from ..rendering import paper as printed
    from ..simulation.run import with_margins

    if scenario is None:
        message = "the page of a simulation needs its scenario"
        raise UsageError(Diagnostic(message, "give scenario=read_scenario(...)"))
    simulation = with_margins(simulation, scenario.inputs()[1])
    origin, place = _page(scenario, simulation, "", paper)
    blocks = published(simulation)
    blocks += [] if measured is None else measured.blocks()
    blocks += [] if sensitivities is None else sensitivity_blocks(sensitivities)
    record = None if measured is None else drawn(measured.overlay)
    report = page(simulation, measured=record, extra=blocks)
    return printed.write(report, origin, **place, scenario_hash=simulation.spec_hash)


@guarded
def write_comparison(
    runs: Sequence[tuple[str, Simulation]],
    scenario: Trial,
    *,
    title: str,
    notes: Sequence[str] = (),
    **paper: Unpack[ReportArguments],
) -> list[ReportFile]:
    """Write a page that compares several simulations (PDF and PNG).

    Parameters
    ----------
    runs : simulations by name; those with the same words before the last comma of the name
        ("50 %, extending" and "50 %, retracting") get the same colour
    scenario : scenario of the simulations, which is attached
    title, notes : title and notes of the page
    paper : as for `report`; the page is named after the scenario's file, with "-compared" added

    Raises
    ------
    InputError
        there is no run, or a name is repeated
    """
    from ..pages.simulation_comparison import comparison, page
    from ..rendering import paper as printed
    from ..simulation.run import with_margins

    records = scenario.inputs()[1]
    runs = [(name, with_margins(run, records)) for name, run in runs]
    report = page(comparison(runs, title, notes))
    origin, place = _page(scenario, runs[0][1], "-compared", paper)
    return printed.write(report, origin, **place)


def _page(
    scenario: Trial, simulation: Simulation, tail: str, paper: ReportArguments
) -> tuple[Origin, ReportPlace]:
    """The result of `page_of` for a scenario; its file is attached and gives the page its name."""
    source = scenario.loaded.source
    name = "scenario.yaml" if source.file.startswith("<") else Path(source.file).name
    if source.file.startswith("<") and scenario.scenario.cycle is not None:
        name = f"{scenario.loaded.design_file.stem}-{scenario.scenario.cycle}.yaml"
    paper["actuator"] = scenario.actuator
    page, place = page_of(scenario.actuator.design, tail, beside=name, **paper)
    spec_hash = simulation.spec_hash or page.spec_hash
    return replace(page, source_text=source.text, source_name=name, spec_hash=spec_hash), place
