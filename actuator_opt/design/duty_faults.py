"""Check the block `duty`: names, columns against linkage and lever arm, pressures, dead points."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..base.errors import Fault, InputError, remedy, shown
from ..base.quantities import INPUTS
from ..models import linkage as crank
from .cycle_record import CycleRecord
from .data_file import DataFile
from .duty import DutyCycle, cycle_of
from .structure import FileView, Loc, child, entries, without_effect

CYCLES: Loc = ("duty", "cycles")
"""Location of the list of cycles in a design."""
LEVELS: Loc = ("duty", "levels")
"""Location of the list of levels of the supply pressure."""
DEAD = 1e-3
"""Lever arm at a dead point, divided by the crank radius (our choice: force and speed are then off
by a factor of a thousand)."""


def record_at(view: FileView, index: int) -> CycleRecord | None:
    """The record of a cycle; None if its file is not read or has faults of its own."""
    loc = (*CYCLES, index)
    file, closed = view.value(*loc, "file"), view.value(*loc, "closed")
    if not isinstance(file, DataFile) or not isinstance(closed, bool):
        return None
    try:
        ignored = tuple(map(str, view.items(*loc, "ignore")))
        return file.parsed(cycle_of, closed=closed, ignore=ignored)
    except InputError:
        return None


def names(view: FileView) -> Iterator[Fault]:
    """Check that every cycle has its own name, which is no load case's."""
    seen = {
        name: "also the name of a load case"
        for name in (child(case, "name") for case in view.items("load_cases"))
        if isinstance(name, str)
    }
    for index, cycle in enumerate(view.items(*CYCLES)):
        name = child(cycle, "name")
        if not isinstance(name, str):
            continue
        if name in seen:
            message = f'"{shown(name)}": {seen[name]}'
            yield Fault((*CYCLES, index, "name"), message, "give each cycle its own name")
        seen.setdefault(name, f"also the name of entry {index}")


def _without_effect(
    view: FileView, loc: Loc, keys: tuple[str, ...], where: str, remedy: str = "remove the line"
) -> Iterator[Fault]:
    """Faults of keys that have no effect; a key that equals its default is none."""
    defaults = {key: entries(DutyCycle)[key].default for key in keys}
    changed = [key for key in keys if view.value(*loc, key) not in (defaults[key], [])]
    yield from without_effect(view, loc, changed, where, remedy)


def columns(view: FileView) -> Iterator[Fault]:
    """Check that keys of each cycle suit its columns, and that a joint has a lever arm."""
    for index in range(len(view.items(*CYCLES))):
        record, loc = record_at(view, index), (*CYCLES, index)
        if record is None:
            continue
        if not record.joint:
            where = "with the columns position and force"
            yield from _without_effect(view, loc, ("lever_arm", "torque_scale"), where)
            continue
        where = "with the columns joint_angle and joint_torque"
        remedy = "write torque_scale instead"
        yield from _without_effect(view, loc, ("force_scale",), where, remedy)
        if not view.has(*loc, "lever_arm") and not view.has("linkage"):
            message = "the file states a joint's angle and torque, but there is no linkage"
            remedy = 'add a block "linkage:", or e.g. "lever_arm: 40 mm" to the cycle'
            yield Fault((*loc, "file"), message, remedy)


def phases(view: FileView) -> Iterator[Fault]:
    """Check that only closed cycles have phases."""
    for index in range(len(view.items(*CYCLES))):
        loc = (*CYCLES, index)
        if view.flag(*loc, "closed") is False:
            where = "with closed: false, as the cycle has no period"
            yield from _without_effect(view, loc, ("phase", "also"), where)


def levels(view: FileView) -> Iterator[Fault]:
    """Check that levels have their own names, and that cycles and choices name one of them."""
    seen: dict[str, str] = {}
    for index, level in enumerate(view.items(*LEVELS)):
        name = child(level, "name")
        if isinstance(name, str) and name in seen:
            message = f'"{shown(name)}": also the name of entry {seen[name]}'
            yield Fault((*LEVELS, index, "name"), message, "give each level its own name")
        elif isinstance(name, str):
            seen[name] = str(index)
    for index, cycle in enumerate(view.items(*CYCLES)):
        loc, record = (*CYCLES, index), record_at(view, index)
        key: Loc = ("choices", f"duty.cycles[{child(cycle, 'name')}].level")
        own = [((*loc, "level"), view.value(*loc, "level"))]
        named = [((*key, k), name) for k, name in enumerate(view.items(*key))]
        for at, name in (*own, *named):
            if isinstance(name, str) and name not in seen:
                known = remedy(name, seen) or "add it to duty.levels"
                yield Fault(at, f'"{shown(name)}" is not a level of duty.levels', known)
        if not isinstance(own[0][1], str):
            continue
        if view.number(*loc, "supply_pressure") is not None:
            yield Fault(
                (*loc, "level"), "the cycle states supply_pressure too", "keep one of them",
                at_key=True,
            )  # fmt: skip
        elif record is not None and record.supply_pressure is not None:
            message = "the file has a column supply_pressure too"
            fix = "remove the line, or list the column under ignore"
            yield Fault((*loc, "level"), message, fix, at_key=True)


def pressures(view: FileView) -> Iterator[Fault]:
    """Check that the pressures of cycles lie between return and supply pressure."""
    back, most = view.number("supply", "return_pressure"), view.number("supply", "pressure")
    if back is None or most is None or back >= most:
        return
    for index in range(len(view.items(*LEVELS))):
        loc: Loc = (*LEVELS, index, "pressure")
        if (level := view.number(*loc)) is not None:
            yield from _pressure(loc, "", level, level, (back, most))
    for index in range(len(view.items(*CYCLES))):
        loc = (*CYCLES, index)
        stated, record = view.number(*loc, "supply_pressure"), record_at(view, index)
        column = None if record is None else record.supply_pressure
        if stated is not None:
            yield from _pressure((*loc, "supply_pressure"), "", stated, stated, (back, most))
        if column is not None and stated is not None:
            message = "the file has a column supply_pressure too"
            remedy = "remove the line, or list the column under ignore"
            yield Fault((*loc, "supply_pressure"), message, remedy, at_key=True)
        elif column is not None:
            low, high = float(column.min()), float(column.max())
            yield from _pressure(
                (*loc, "file"), "column supply_pressure, ", low, high, (back, most)
            )


def _pressure(
    loc: Loc, what: str, low: float, high: float, limits: tuple[float, float]
) -> Iterator[Fault]:
    text, (back, most) = INPUTS["pressure"].text, limits
    if low <= back:
        message = f"{what}{text(low)}: not above supply.return_pressure ({text(back)})"
        yield Fault(loc, message, f"write more than {text(back)}")
    elif high > most * (1 + 1e-9):
        message = f"{what}{text(high)}: above supply.pressure ({text(most)})"
        yield Fault(loc, message, f"write at most {text(most)}, or raise supply.pressure")


def dead_points(view: FileView) -> Iterator[Fault]:
    """Check that no cycle reaches a dead point of the linkage, where its lever arm is zero."""
    base, radius, offset = (
        view.number("linkage", name) for name in ("base_radius", "crank_radius", "angle_offset")
    )
    if base is None or radius is None or offset is None:
        return
    for index in range(len(view.items(*CYCLES))):
        record, loc = record_at(view, index), (*CYCLES, index)
        if record is None or record.angle is None or view.has(*loc, "lever_arm"):
            continue
        geometry = crank.linkage(
            base_radius=base, crank_radius=radius, joint_angle=record.angle, angle_offset=offset
        )
        dead = np.flatnonzero(~(geometry.lever_arm > DEAD * radius))
        if dead.size:
            at = int(dead[0])
            angle = INPUTS["joint_angle"].text(float(record.angle[at]))
            yield Fault(
                (*loc, "file"),
                f"{shown(record.name, 200)}, line {record.lines[at]}: at {angle}, the joint is at "
                "or past a dead point of the linkage, where the lever arm is 0",
                "change linkage.angle_offset, or correct sign and zero of the angles",
            )


def oil(view: FileView) -> Iterator[Fault]:
    """Check that the temperature of the oil is stated or computed from a tank, not both."""
    if view.has("duty", "oil_supply") and view.has("duty", "tank"):
        message = "both oil_supply and tank: the temperature of the oil follows from the tank"
        yield Fault(("duty", "oil_supply"), message, "keep one of them", at_key=True)


def supply(view: FileView) -> Iterator[Fault]:
    """Check that the accumulator's pressure drop leaves more than the return pressure."""
    loc = ("duty", "supply", "pressure_drop")
    drop, back = view.number(*loc), view.number("supply", "return_pressure")
    most = view.number("supply", "pressure")
    if drop is None or back is None or most is None or back >= most:
        return
    text = INPUTS["pressure_drop"].text
    if drop >= most - back:
        message = f"{text(drop)}: not less than supply minus return pressure ({text(most - back)})"
        yield Fault(loc, message, f"write less than {text(most - back)}")


CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    names,
    columns,
    phases,
    levels,
    pressures,
    dead_points,
    oil,
    supply,
)
