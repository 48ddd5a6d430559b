"""Read scenario files and the design that each names; write a start file.

The start file of `init --scenario` is an example with comments: a step under load for a design.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from ...base.arguments import Change
from ...base.dataclass import dataclass
from ...base.errors import Diagnostic, Fault, InputError
from ...base.numeric import Array
from ...base.quantities import RESULTS, Quantity
from ...metrics import METRICS
from ..build import check, copy_tree
from ..changes import Override
from ..data_file_reader import attach
from ..kinds import Of, Section, Text, ValueFault
from ..model import Design
from ..paths import resolve, stated
from ..reader import STDIN, TEXT, FileSource, LoadedDesign, load, opened, read_design
from ..structure import Loc, MaterialLookup, blocks, child_at, entries
from ..writer import scalar
from ..yaml_source import parse
from .faults import cross_field, design_faults, part_lists
from .kinds import SHAPES, Records, sampled
from .model import Scenario, SignalSegment


@dataclass(frozen=True, slots=True)
class LoadedScenario:
    """A scenario, the file it comes from, and its changes to the design."""

    scenario: Scenario
    source: FileSource
    folder: Path
    """Folder of the scenario file, to which names of other files are relative."""
    changes: tuple[Override, ...] = ()
    """Changes of the design by the scenario, then by the command line."""

    @property
    def design_file(self) -> Path:
        """The design file that the scenario names."""
        return self.folder / self.scenario.design

    def diagnostic(self, path: str, message: str, remedy: str = "") -> Diagnostic:
        """Diagnostic for the value at a PATH of the scenario."""
        return self.source.diagnostic(path, message, remedy)


def read_scenario(source: str | Path, *, overrides: Iterable[Change] = ()) -> LoadedScenario:
    """Read a scenario file, or its text; the design is not read.

    Parameters
    ----------
    source : path, ``"-"`` for standard input, or a text of several lines
    overrides : (PATH, value) pairs that replace values before all checks; a bare number is SI,
        None removes the key. PATHs that exist only in a design change the design, like those under
        ``set`` and ``unset``

    Raises
    ------
    InputError
        with all faults, in line order
    """
    text, file = opened(source, "scenario")
    document = parse(text, file, "scenario")
    folder = Path() if file in (TEXT, STDIN) else Path(source).parent
    beside: list[Diagnostic] = []
    scenario_overrides: list[Change] = []
    design_overrides: list[Change] = []
    for path, value in overrides:
        of_design = (_unset_in_design if value is None else _of_design)(path, document.data)
        (design_overrides if of_design else scenario_overrides).append((path, value))

    def build_scenario(tree: dict[str, Any]) -> tuple[Scenario | None, Sequence[Fault]]:
        whole = copy_tree(tree)
        file_faults = list(attach(whole, folder, root=Scenario))
        beside[:] = [fault for fault in file_faults if isinstance(fault, Diagnostic)]
        checked = check(whole, Scenario, RESULTS, cross_field)
        faults = [*checked.faults, *(x for x in file_faults if isinstance(x, Fault))]
        return (None if faults else checked.section), faults

    scenario, place = load(document, Scenario, build_scenario, scenario_overrides, RESULTS, beside)
    stated_changes: list[tuple[str, str | None, Loc]] = [
        *((path, None, ("unset", index)) for index, path in enumerate(scenario.unset)),
        *((path, value, ("set", path)) for path, value in scenario.set.items()),
    ]
    changes = []
    for path, value, loc in stated_changes:
        origin = None if loc in place.overrides else document
        changes.append(Override(path, value, origin, () if origin is None else loc))
    changes += [Override(path, value) for path, value in design_overrides]
    return LoadedScenario(scenario, place, folder, tuple(changes))


def _of_design(path: str, tree: Any) -> bool:
    """Whether a PATH names a value of the design and not of the scenario."""
    head = _head(path)
    if head not in entries(Scenario):
        return head in entries(Design)
    return not _names(path, tree, RESULTS, Scenario) and _names(path, {}, METRICS, Design)


def _unset_in_design(path: str, tree: Any) -> bool:
    """Whether a PATH that the scenario does not state may be stated in the design."""
    try:
        stated(path, tree, RESULTS, Scenario)
    except ValueFault:
        head = _head(path)
        if head not in entries(Scenario):
            return head in entries(Design)
        return path.strip() in blocks(Design) or _names(path, {}, METRICS, Design)
    return False


def _head(path: str) -> str:
    return re.split(r"[.\[]", path.strip(), maxsplit=1)[0]


def _names(path: str, tree: Any, metrics: Mapping[str, Quantity], root: type[Section]) -> bool:
    try:
        resolve(path, tree, metrics, root)
    except ValueFault:
        return False
    return True


def read_design_of(
    loaded: LoadedScenario,
    *,
    materials: MaterialLookup | None = None,
    metrics: Mapping[str, Quantity] | None = None,
) -> LoadedDesign:
    """Read the design that a scenario names, with the scenario's changes.

    Parameters
    ----------
    loaded : the scenario
    materials : names and kinds of materials; default: the library
    metrics : allowed names of metrics in the design; default: `metrics.METRICS`

    Raises
    ------
    InputError
        with all faults of the design; faults of changed values are at their location in the
        scenario. If the design is valid, with all contradictions between design and scenario
    """
    path = loaded.design_file
    try:
        design = read_design(path, overrides=loaded.changes, materials=materials, metrics=metrics)
    except InputError as error:
        raise InputError([_at_its_name(fault, loaded) for fault in error.diagnostics]) from None
    faults = sorted(design_faults(loaded.scenario, design.design), key=loaded.source.place)
    if faults:
        raise InputError([loaded.source.at(fault) for fault in faults])
    return design


def _at_its_name(fault: Diagnostic, loaded: LoadedScenario) -> Diagnostic:
    """Report a fault of a whole design file at the line of the scenario that names the file."""
    path = str(loaded.design_file)
    if fault.file != path or fault.line is not None:
        return fault
    return loaded.diagnostic("design", f"{path}: {fault.message}", fault.remedy)


WIDE: Final = 1.5
"""In an evenly sampled record, a time step longer than this many normal steps is a gap (our
choice)."""
REGULAR: Final = 0.9
"""A record is evenly sampled if at least this share of its time steps is equal (our choice)."""
ROUNDED: Final = 1e-9
"""Relative tolerance for comparisons of times."""


class SampleGap(NamedTuple):
    """An interval without samples."""

    first: float
    """Time of its first missing sample [s]."""
    last: float
    size: int
    """Number of missing samples."""


def recorded_parts(scenario: Scenario) -> Iterator[tuple[str, SignalSegment, str]]:
    """Yield PATH, part and physical dimension of every signal part that is a record."""
    for loc, section in part_lists().items():
        kind = entries(section)["value"].kind
        assert isinstance(kind, Of)
        for index, part in enumerate(child_at(scenario, loc) or ()):
            if "file" in SHAPES[part.shape].needed:
                yield f"{'.'.join(loc)}[{index}].column", part, kind.quantity.dimension


def recorded_notes(scenario: Scenario, records: Records) -> Iterator[str]:
    """Yield sentences on times without data in a record: before, after or between its samples."""
    least = ROUNDED * scenario.duration
    for path, part, _ in recorded_parts(scenario):
        samples = sampled(part, records)
        if samples is None:
            continue
        name = f'column "{part.column}" of {part.file} ({path.removesuffix(".column")})'
        first, last = float(samples[0][0]), float(samples[0][-1])
        if first > least:
            yield f"{name} begins at {first:.4g} s: before that, the signal has its first value"
        if last < scenario.duration - least:
            yield (
                f"{name} ends at {last:.4g} s, the scenario at {scenario.duration:.4g} s: in "
                "between the signal keeps its last value"
            )
        time, values = records[part.file or "", part.column or ""]
        missing = [
            gap
            for gap in gaps(time + part.start, values)
            if first < gap.first < min(last, scenario.duration) and gap.last > 0
        ]
        if missing:
            yield f"{name}: {gap_words(missing)}; the signal is interpolated there"


def gaps(time: Array, values: Array) -> list[SampleGap]:
    """Intervals without samples: NaN values, and time steps that an evenly sampled record lacks."""
    absent = np.concatenate(([False], ~np.isfinite(values), [False])).astype(np.int8)
    turns = np.flatnonzero(np.diff(absent))
    sample_gaps = [
        SampleGap(float(time[a]), float(time[b - 1]), int(b - a))
        for a, b in zip(turns[::2], turns[1::2], strict=True)
    ]
    steps = np.diff(time)
    if steps.size > 1:
        usual = float(np.median(steps))
        if float(np.mean(np.abs(steps - usual) < 0.5 * usual)) >= REGULAR:
            sample_gaps += [
                SampleGap(
                    float(time[k]) + usual, float(time[k + 1]) - usual, round(steps[k] / usual) - 1
                )
                for k in np.flatnonzero(steps > WIDE * usual)
            ]
    return sorted(sample_gaps)


def gap_words(sample_gaps: list[SampleGap]) -> str:
    """Text that states how many samples are missing, and where (first and last gap).

    >>> gap_words([SampleGap(0.2, 0.2, 1)])
    '1 sample is missing at 0.2 s'
    >>> gap_words([SampleGap(0.2, 0.3, 11), SampleGap(0.5, 0.5, 1), SampleGap(1.0, 2.0, 9)])
    '21 samples are missing in 3 places, first from 0.2 to 0.3 s, last from 1 to 2 s'
    """
    intervals = [
        f"from {gap.first:.4g} to {gap.last:.4g} s" if gap.size > 1 else f"at {gap.first:.4g} s"
        for gap in (sample_gaps[0], sample_gaps[-1])
    ]
    count = sum(sample_gap.size for sample_gap in sample_gaps)
    head = "1 sample is missing" if count == 1 else f"{count} samples are missing"
    if len(sample_gaps) == 1:
        return f"{head} {intervals[0]}"
    return f"{head} in {len(sample_gaps)} places, first {intervals[0]}, last {intervals[1]}"


STEP = 0.1
"""Height of the step in a start file, as a share of the stroke. Our choice: it is clearly visible,
yet keeps the piston away from the stops."""


LOAD = 0.3
"""Load in a start file, as a share of the smallest force of the load cases (our choice)."""


_HEAD = """\
# Events on a design over time. Every physical value has a unit.
#
#   actuator-opt check FILE                    all faults of this file and its design
#   actuator-opt simulate FILE --report        figures, results, balance of energy
#   actuator-opt simulate FILE --csv out.csv   every signal over time
name: @NAME@
design: @DESIGN@
# set:                         # changed values of the design, by PATH
#   load.mass: 30 kg

duration: 1 s
sample_time: 1 ms

initial:                       # at rest; default pressures hold the load
  position: 50 %               # of the stroke

load:
  force:                       # against extension; sum of parts: constant, step, ramp, pulse,
    - shape: constant          # sine, record (a column of a CSV file)
      value: @FORCE@
"""


_DRIVEN = """\

control:                       # or "signal:", which drives the valve with a voltage
  law: p                       # p, pi, pid; gain from the design, stated or tuned
  position:                    # relative to the initial position; or speed
    - shape: step
      value: @STEP@
      start: 0.1 s

requirements:                  # also settling_time, hold_drift, cavitation_margin, ...
  rise_time:
    max: 0.3 s
  overshoot:
    max: 10 %
  steady_state_ratio:
    max: 2 %
"""


_SHAKEN = """\
    - shape: sine              # excitation
      value: @SWING@
      frequency: 20 Hz

# The design has no valve: its ports are closed, or at constant_pressure.
# If the design has a block "valve", a signal or a controller drives it here.
ends: closed

requirements:
  cavitation_margin:
    min: 1 bar
"""


def scenario_text(design: Design, path: str, name: str = "step under load") -> str:
    """A start file for a design.

    Parameters
    ----------
    design : design that gives stroke and load cases
    path : design file, as the scenario names it
    name : title of the scenario

    Raises
    ------
    ValueFault
        if the name is invalid
    """
    title = Text().validate(name)
    forces = [abs(case.force) for case in design.load_cases if case.force]
    force = LOAD * min(forces, default=0.0)
    text = _HEAD + (_SHAKEN if design.valve is None else _DRIVEN)
    for mark, value in (
        ("@NAME@", scalar(title)),
        ("@DESIGN@", scalar(path)),
        ("@FORCE@", f"{_round(force)} N"),
        ("@SWING@", f"{_round(0.5 * force)} N"),
        ("@STEP@", f"{_round(STEP * design.cylinder.stroke * 1e3)} mm"),
    ):
        text = text.replace(mark, value)
    return text


def _round(value: float) -> str:
    """Text with two significant digits, without an exponent."""
    return f"{float(f'{value:.2g}'):.12g}"
