"""Start designs for a duty cycle: forces, speed and stroke from the motion in a CSV file."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from math import ceil, floor, log10
from pathlib import Path

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError
from ..base.quantities import INPUTS
from ..base.sheets import read_text
from ..design.cycle_peaks import CyclePeaks, peaks
from ..design.cycle_record import MOST_BYTES
from ..design.data_file import DataFile, moved, texts_of
from ..design.duty import DutyCycle, DutySection, cycle_of
from ..design.model import Linkage
from ..design.reader import LoadedDesign
from ..design.writer import exact_text, init_text, scalar
from ..evaluation import evaluate, prepare
from .actuator import read_as
from .starting import SPEED, Start

_DIGITS = 3
"""Significant digits to which forces and speeds are rounded up (our choice)."""

_BLOCK = """
# Motion and load over time. Further keys, such as repeats: actuator-opt explain duty.cycles
duty:
  cycles:
    - name: @NAME@
      file: @FILE@
@ARM@"""


@dataclass(frozen=True, slots=True)
class CycleStart:
    """A cycle for which a start design is made, with its extreme values."""

    cycle: DutyCycle
    peaks: CyclePeaks

    @property
    def answers(self) -> dict[str, str]:
        """Push, pull, stroke and speed that the cycle needs, rounded up, as texts with units."""
        most = self.peaks
        travel = most.travel if most.position_high is None else most.position_high
        return {
            "push": f"{_up(most.push)!r} N",
            "pull": f"{_up(most.pull)!r} N",
            "stroke": f"{max(ceil(1e3 * travel - 1e-6), 1)} mm",
            "speed": f"{_up(most.speed) or SPEED!r} m/s",
        }

    @property
    def warnings(self) -> list[str]:
        """Sentences on doubtful data of the file."""
        file = self.cycle.record.name
        return [f"{file}: {text}" for text in self.cycle.record.warnings]

    def joined_to(self, loaded: LoadedDesign, folder: Path, **title: str) -> Start:
        """A copy of a design with this cycle besides those that it has.

        Raises
        ------
        UsageError : the design has a load case or a cycle of this name
        InputError : the copy is not a valid design
        """
        design = moved(loaded.design, folder)
        cases = [case.name for case in design.load_cases]
        cycles = () if design.duty is None else design.duty.cycles
        if self.cycle.name in (*cases, *(cycle.name for cycle in cycles)):
            message = f"{design.name} has a cycle or load case {self.cycle.name!r} already"
            raise UsageError(Diagnostic(message, "rename the CSV file"))
        duty = DutySection(cycles=(*cycles, self.cycle))
        if design.duty is not None:
            duty = design.duty.model_copy(update={"cycles": duty.cycles})
        design = design.model_copy(update={"duty": duty})
        text = init_text(from_design=replace(loaded, design=design), **title)
        actuator = read_as(text, loaded.source.file, files=texts_of(design))
        evaluated = evaluate(prepare(actuator.design)).duty
        lacks = () if evaluated is None else evaluated.shortfalls
        return Start(actuator, not lacks, "; ".join(shortfall.sentence for shortfall in lacks))

    def added_to(self, start: Start) -> Start:
        """The start design with the block `duty`, and the cycle's file."""
        source = start.actuator.source
        assert source is not None
        assert isinstance(self.cycle.file, DataFile)
        arm = self.cycle.lever_arm
        line = "" if arm is None else f"      lever_arm: {exact_text(arm, INPUTS['lever_arm'])}\n"
        block = _BLOCK.replace("@NAME@", scalar(self.cycle.name)).replace("@ARM@", line)
        text = source.text.rstrip("\n") + "\n" + block.replace("@FILE@", scalar(self.cycle.file))
        files = {str(self.cycle.file): self.cycle.file.text}
        return replace(start, actuator=read_as(text, source.file, files=files))


def cycle_start(
    file: str | Path,
    *,
    lever_arm: float | None = None,
    linkage: Linkage | None = None,
    folder: str | Path = "",
) -> CycleStart:
    """Read the cycle for which a start design is made.

    Parameters
    ----------
    file : CSV file as for `design.cycle_record.read_cycle`; it must close
    lever_arm : constant lever arm of the joint [m]
    linkage : linkage of the joint, if there is no constant lever arm
    folder : folder in which the design will be written, to which it names the file relatively

    Raises
    ------
    InputError : the file is not usable
    UsageError : the file states a joint, but there is neither lever arm nor linkage; or positions
        below 0
    """
    path = Path(file)
    relative = Path(os.path.relpath(path, folder or ".")).as_posix()
    if path.is_absolute():
        relative = str(path)
    own = DataFile(relative, read_text(path, most=MOST_BYTES), str(folder))
    record = own.parsed(cycle_of, closed=True)
    if record.joint and lever_arm is None and linkage is None:
        message = f"{file}: states the motion of a joint"
        remedy = 'add e.g. --lever-arm "40 mm", or --from a design with a linkage'
        raise UsageError(Diagnostic(message, remedy))
    cycle = DutyCycle(name=_name(path), file=own, lever_arm=lever_arm if record.joint else None)
    most = peaks(cycle, linkage)
    if most.position_low is not None and most.position_low < 0:
        text = INPUTS["length"].text(most.position_low)
        message = f"{file}: positions begin at {text}, but count from fully retracted"
        raise UsageError(Diagnostic(message, "shift them, so that none is below 0"))
    return CycleStart(cycle, most)


def _name(path: Path) -> str:
    """The file's name as the name of a cycle, which differs from those of the load cases."""
    words = re.sub(r"[^\w .+-]+", "_", path.stem).strip()
    if not words or not words[0].isalpha():
        words = f"cycle {words}".strip()
    return f"{words} cycle" if words in ("push", "pull") else words[:100]


def _up(value: float) -> float:
    """The value rounded up to three significant digits."""
    if value <= 0:
        return 0.0
    step = _DIGITS - 1 - floor(log10(value))
    return ceil(round(value * 10.0**step, 6)) / 10.0**step
