"""Block `choices`: the discrete values that the optimiser may try for each PATH.

Allowed values are written like the value they replace: numbers with their unit, counts, names of
materials, words. For a key that an optional block requires, `none` removes this block. `recheck`
replaces allowed values in the tree by values in SI and yields their faults. The optimiser skips
combinations whose values contradict each other.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

from ..base import errors
from ..base.errors import Fault
from ..base.quantities import Quantity
from ..base.words import by_nearness
from ..joints.kinds import JOINTS
from .kinds import EntryName, Fraction, MaterialName, Text, ValueFault, shape_in_words
from .material import ROLES
from .model import Design, EndRetention
from .paths import Target, resolve
from .requirements import in_faulty_block
from .structure import NONE, MaterialLookup, is_removed_by_none, number_of, value_at

Value: TypeAlias = float | bool | str | Fraction
"""An allowed value: SI number, boolean, name or word, or fraction of the stroke."""

MOST_VALUES = 50
"""Largest number of allowed values for one PATH."""

MOST_COMBINATIONS = 1000
"""Largest number of combinations of all choices; the optimiser tries every combination."""


def of_one_combination(design: Design) -> Design:
    """A design without the keys and variables that its combination of choices does not use.

    A file that lists several types of joint under `choices` states the keys of all of them. A
    combination of choices has one type at each end, so it needs only the keys of this type. A level
    of the supply pressure that no duty cycle uses is not a variable.
    """
    if design.duty is not None:
        used = {cycle.level for cycle in design.duty.cycles}
        idle = {
            f"duty.levels[{level.name}].pressure"
            for level in design.duty.levels
            if level.name not in used
        }
        variables = {path: x for path, x in design.variables.items() if path not in idle}
        design = design.model_copy(update={"variables": variables})
    if design.retention is None:
        return design
    removed: set[str] = set()
    blocks: dict[str, EndRetention] = {}
    for name, end in design.retention.ends.items():
        own = {field.key.partition(".")[0] for field in JOINTS[end.type].fields}
        unused = [
            key
            for key, field in EndRetention.model_fields.items()
            if key not in own and not field.is_required() and getattr(end, key) != field.default
        ]
        at = f"retention.{name}" if name else "retention"
        removed |= {f"{at}.{key}" for key in EndRetention.model_fields if key not in own}
        defaults = {key: EndRetention.model_fields[key].default for key in unused}
        blocks[name] = end.model_copy(update=defaults)
    retention = blocks.get("") or design.retention.model_copy(update=blocks)
    variables = {
        path: variable
        for path, variable in design.variables.items()
        if not any(path == key or path.startswith(f"{key}.") for key in removed)
    }
    return design.model_copy(update={"retention": retention, "variables": variables})


def recheck(tree: dict[str, Any]) -> Iterator[Fault]:
    """Check that each PATH exists and is no variable, and that its values are valid and distinct.

    Valid values are then replaced in the tree by values in SI. Too many values are also a fault.
    """
    block = tree.get("choices")
    if not isinstance(block, dict):
        return
    count = 1
    for path, values in block.items():
        loc = ("choices", path)
        if in_faulty_block(path, tree):
            block[path] = [0.0]  # the block as a whole already has a fault
            continue
        try:
            target = choosable(path, tree)
        except ValueFault as fault:
            yield Fault(loc, fault.message, fault.remedy, at_key=True)
            continue
        if not isinstance(values, list):
            if values is not None:
                written = (
                    f'"{errors.shown(values)}"'
                    if isinstance(values, str)
                    else shape_in_words(values)
                )
                sample = errors.shown(values) if isinstance(values, str) else _example(target)
                yield Fault(
                    loc, f"need a list of allowed values, not {written}", f"write [{sample}]"
                )
            continue
        if not values:
            yield Fault(loc, "the list is empty", f"write e.g. [{_example(target)}]")
        elif len(values) > MOST_VALUES:
            message = f"{len(values)} values are too many"
            yield Fault(loc, message, f"keep at most {MOST_VALUES}")
        else:
            yield from _values(loc, values, target)
        count *= len(values)
    if count > MOST_COMBINATIONS:
        yield Fault(
            ("choices",),
            f"{count} combinations are too many, because every combination is computed",
            f"remove values until at most {MOST_COMBINATIONS} combinations remain",
            at_key=True,
        )


def choosable(path: str, tree: Any) -> Target:
    """Find the value that a choice may set; raise `ValueFault` if it cannot be a choice."""
    try:
        target = resolve(path, tree)
    except ValueFault as fault:
        raise ValueFault(fault.message.removeprefix(f"{path}: "), fault.remedy) from None
    remedy = "write the PATH of a part's number, material or type"
    if target.entry is None or target.entry.shape == "list" or len(target.loc) == 1:
        raise ValueFault("is not a value of an actuator part", remedy)
    kind = target.entry.kind
    if isinstance(kind, Text) and not isinstance(kind, (MaterialName, EntryName)):
        raise ValueFault("is free text, so choosing it has no effect", remedy)
    if target.path != path:
        raise ValueFault("is not the canonical PATH", f"write {target.path}")
    variables = tree.get("variables") if isinstance(tree, dict) else None
    if isinstance(variables, dict) and path in variables:
        raise ValueFault("is also a variable", "keep it in variables or in choices, not in both")
    return target


def _example(target: Target) -> str:
    entry = target.entry
    if entry is None:
        return "…"
    return entry.choices[0] if entry.choices else entry.kind.example if entry.kind else "…"


def _values(loc: tuple[str, str], values: list[Any], target: Target) -> Iterator[Fault]:
    """Convert every value to a value of a design; yield faults of invalid or duplicate values."""
    assert target.entry is not None
    valid: list[tuple[int, Value]] = []
    for index, raw in enumerate(values):
        if raw is None:
            continue  # already reported as a fault
        try:
            value = values[index] = _read(raw, target)
        except ValueFault as fault:
            yield Fault((*loc, index), fault.message, fault.remedy)
            continue
        twin = next((i for i, other in valid if same(other, value)), None)
        if twin is not None:
            message = f"{errors.shown(raw)}: the same as value {twin + 1} of the list"
            yield Fault((*loc, index), message, "keep one of them")
        valid.append((index, value))


def _read(raw: Any, target: Target) -> Value:
    """Read an allowed value like a value of its target field; raise `ValueFault` if invalid."""
    entry = target.entry
    assert entry is not None
    if raw == NONE and entry.required:
        if not is_removed_by_none(target.loc):
            block = target.path.rpartition(".")[0]
            message = f"{NONE}: the block {block} is needed and cannot be left out"
            raise ValueFault(message, f"remove {NONE} from the list")
        return NONE
    if entry.choices:
        if raw in entry.choices:
            return str(raw)
        word = raw if isinstance(raw, str) else ""
        message = f'"{errors.shown(word)}" is not a choice' if word else "a single word is required"
        raise ValueFault(message, errors.remedy(word, entry.choices))
    assert entry.kind is not None
    value: Value = entry.kind.validate(raw)
    return value


def same(value: Value, other: Value) -> bool:
    """Whether two allowed values are equal; numbers in different units may differ by rounding.

    >>> same(2.62e-3, 0.262 * 0.01), same("nbr_70", "nbr_90")
    (True, False)
    """
    first, second = number_of(value), number_of(other)
    if first is None or second is None or type(value) is not type(other):
        return value == other
    return math.isclose(first, second, rel_tol=1e-9, abs_tol=1e-15)


def material_faults(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Yield faults for unknown materials, and for materials of a kind not accepted at the PATH."""
    block = tree.get("choices")
    for path, values in block.items() if isinstance(block, dict) else ():
        try:
            entry = resolve(path, tree).entry
        except ValueFault:
            continue
        if entry is None or not isinstance(entry.kind, MaterialName) or not _is_list(values):
            continue
        suitable = ROLES[entry.kind.role]
        for index, name in enumerate(values):
            if not isinstance(name, str) or (name == NONE and entry.required):
                continue
            if name in materials and materials.kind(name) in suitable:
                continue
            loc, candidates = (
                ("choices", path, index),
                materials.meanings(entry.kind.usual or suitable),
            )
            if name not in materials:
                message = f'"{errors.shown(name)}": unknown material'
                yield Fault(loc, message, errors.remedy(name, candidates, about=path))
            else:
                message = f"{name}: a material of kind {materials.kind(name)} cannot be used here"
                offered = by_nearness(path, candidates)[:6]
                yield Fault(loc, message, f"use e.g. {', '.join(offered)}")


def _is_list(values: object) -> bool:
    return isinstance(values, (list, tuple))


def combinations(design: Design) -> Iterator[dict[str, Value]]:
    """List every combination of the choices; the last PATH in the file changes fastest."""
    block: Mapping[str, Sequence[Value]] = design.choices
    for chosen in itertools.product(*block.values()):
        yield dict(zip(block, chosen, strict=True))


def quantity_of_choice(path: str, value: object, tree: Any) -> Quantity | None:
    """Quantity of an allowed number; None for names and words."""
    entry = resolve(path, tree).entry
    return None if entry is None or number_of(value) is None else entry.quantity(value)


def plain(value: Value) -> float | bool | str:
    """Convert an allowed value for JSON: numbers in SI, a fraction of the stroke as written.

    >>> plain(0.00178), plain(Fraction(0.5))
    (0.00178, '50 %')
    """
    return f"{100 * value.value:.12g} %" if isinstance(value, Fraction) else value


def shown(path: str, value: Value, tree: Any) -> str:
    """Text of an allowed value, in the display unit of its quantity."""
    quantity, number = quantity_of_choice(path, value, tree), number_of(value)
    if quantity is None or number is None:
        return str(value).lower() if isinstance(value, bool) else str(value)
    return quantity.text(number)


def left_out(design: Design) -> tuple[str, ...]:
    """Remarks on PATHs whose value in the design is not among their allowed values."""
    remarks = []
    block: Mapping[str, Sequence[Value]] = design.choices
    for path, values in block.items():
        stated = value_at(design, resolve(path, design).loc)
        file_value = NONE if stated is None else stated
        if not any(same(file_value, value) for value in values):
            suffix = f" ({shown(path, file_value, design)})"
            remarks.append(f"{path}: the value in the file{suffix} is not among the choices")
    return tuple(remarks)
