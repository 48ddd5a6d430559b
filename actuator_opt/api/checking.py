"""Finds the faults of a design or scenario file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from ..base.arguments import SetValues, guarded
from ..base.errors import ActuatorError, Diagnostic, InputError
from ..design import Design, is_scenario
from ..design.reader import TEXT, opened
from ..evaluation import PreparedDesign, without_films
from .actuator import Actuator, Plugins, Result, as_actuator, fault_of, read, requirement_faults
from .simulations import read_scenario


class Examined(NamedTuple):
    """Result of examining a file: its faults or, if it has none, warnings of implausible values."""

    faults: list[Diagnostic]
    warnings: list[str]


@guarded
def check(
    source: Actuator | Design | Result | str | Path,
    *,
    set: SetValues = (),
    plugins: Plugins = (),
) -> list[Diagnostic]:
    """Find all faults of a design or scenario; empty if there are none. Parameters as for `read`.

    The faults include variables that no model reads, and requirements on metrics that do not exist.
    The models run once to find them, but no oil film is solved.
    """
    return examine(source, set=set, plugins=plugins).faults


def examine(
    source: Actuator | Design | Result | str | Path,
    *,
    set: SetValues = (),
    plugins: Plugins = (),
) -> Examined:
    """Find all faults as `check` does; if there are none, warn of every implausible value."""
    if source == "-":  # standard input can only be read once
        text, name = opened(source)
        examined = examine(f"{text}\n", set=set, plugins=plugins)
        faults = [
            replace(fault, file=name) if fault.file == TEXT else fault for fault in examined.faults
        ]
        return Examined(faults, examined.warnings)
    try:
        if not isinstance(source, str | Path):
            actuator = as_actuator(source, plugins).changed(dict(set))
        elif is_scenario(source):
            scenario = read_scenario(source, set=set)
            return Examined([], _out_of_proportion(scenario.actuator.subject()))
        else:
            actuator = read(source, set=set, plugins=plugins)
        subject = actuator.subject()
    except InputError as error:
        return Examined(error.diagnostics, [])
    remarks: list[str] = []
    faults = _of_models(actuator, without_films(subject), remarks)
    if faults and actuator.plugins:  # a plugin may reject the NaN of a film that is not solved
        faults = _of_models(actuator, subject, remarks)
    duty = actuator.design.duty
    remarks += [] if duty is None else duty.warnings
    return Examined(faults, [] if faults else [*remarks, *_out_of_proportion(subject)])


def _of_models(actuator: Actuator, subject: PreparedDesign, remarks: list[str]) -> list[Diagnostic]:
    """Faults that only the models reveal, such as requirements on metrics that do not exist.

    The others are variables that no model reads, and impossible choices. `remarks` takes warnings
    of single values of the choices that are never possible.
    """
    try:
        faults = requirement_faults(actuator, subject)
        if faults:
            return faults
        if actuator.design.choices:
            from ..optimisation.choices import never_possible, possible

            remarks[:] = never_possible(possible(subject))
        elif actuator.design.variables:
            from ..optimisation.actuator import build

            build(subject, fault_of(actuator))
    except ActuatorError as error:
        return error.diagnostics
    return []


def _out_of_proportion(subject: PreparedDesign) -> list[str]:
    from ..evaluation import proportions

    return list(proportions.warnings(subject, subject.values()))
