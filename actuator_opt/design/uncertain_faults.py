"""Faults of the block ``uncertainty``: PATHs, keys and widths of distributions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args

from ..base import errors
from ..base.errors import Fault
from .kinds import ValueFault, example, read_quantity, shape_in_words
from .model import Shape
from .paths import Target, resolve
from .structure import number_of, value_at
from .uncertain import KEYS, NUMBERS, misfit, quantity_of_entry


def faults(tree: dict[str, Any]) -> Iterator[Fault]:
    """Convert the texts of `uncertainty` to SI in place, and yield all faults of its entries."""
    block = tree.get("uncertainty")
    for path, entry in block.items() if isinstance(block, dict) else ():
        loc = ("uncertainty", path)
        try:
            target = _number(path, tree)
        except ValueFault as fault:
            yield Fault(loc, fault.message, fault.remedy, at_key=True)
            continue
        if not isinstance(entry, dict):
            if entry is not None:
                remedy = 'write "distribution: …" and its parameters'
                yield Fault(loc, f"need a distribution, not {shape_in_words(entry)}", remedy)
            continue
        entry_faults = list(_read(loc, entry, target))
        yield from entry_faults or _fit(loc, entry, target, tree)


def _number(path: str, tree: dict[str, Any]) -> Target:
    """Find the number at a PATH; raise `ValueFault` if there is none."""
    try:
        target = resolve(path, tree)
    except ValueFault as fault:
        raise ValueFault(fault.message.removeprefix(f"{path}: "), fault.remedy) from None
    material = target.loc[0] == "materials"
    if target.quantity is None or (target.entry is None and not material):
        raise ValueFault("is not a numeric input of the actuator", "remove the entry")
    if target.quantity.dimension == "count":
        raise ValueFault("is a count, which has no scatter", "remove the entry")
    if target.path != path:
        raise ValueFault("is not the canonical PATH", f"write {target.path}")
    if not material and value_at(tree, target.loc) is None:
        remedy = f'write e.g. "{target.loc[-1]}: {example(target.quantity)}" in its block'
        raise ValueFault(f"{path} is not set, so it cannot scatter", remedy)
    return target


def _read(loc: tuple[str, str], entry: dict[str, Any], target: Target) -> Iterator[Fault]:
    """Convert the numbers of an entry to SI, in place."""
    assert target.quantity is not None
    for key in NUMBERS:
        quantity = quantity_of_entry(key, target.quantity)
        if entry.get(key) is None or quantity is None:
            continue
        try:
            entry[key] = read_quantity(entry[key], quantity)
        except ValueFault as fault:
            yield Fault((*loc, key), fault.message, fault.remedy)


def _fit(
    loc: tuple[str, str], entry: dict[str, Any], target: Target, tree: dict[str, Any]
) -> Iterator[Fault]:
    """Check that the keys suit the distribution, and its range suits the value in the design."""
    shape = entry.get("distribution", "uniform" if "tolerance" in entry else None)
    if shape is None:
        yield Fault((*loc, "distribution"), "missing", 'add e.g. "distribution: normal"')
        return
    entry["distribution"] = shape
    if shape not in get_args(Shape):
        word = shape if isinstance(shape, str) else ""
        message = (
            f'"{errors.shown(word)}" is not a distribution' if word else "a single word is required"
        )
        remedy = errors.remedy(word, get_args(Shape))
        yield Fault((*loc, "distribution"), message, remedy)
        return
    stated = tuple(key for key in (*NUMBERS, "tolerance") if entry.get(key) is not None)
    if set(stated) not in [set(group) for group in KEYS[shape]]:
        options = ", or ".join(" and ".join(group) for group in KEYS[shape]) or "nothing more"
        has = f"has {' and '.join(stated)}" if stated else "has no parameters"
        yield Fault(loc, f"{shape} {has}", f"write {options}", at_key=True)
        return
    value = number_of(value_at(tree, target.loc))
    if "lower" in stated and target.path in (tree.get("variables") or {}):
        message = "the bounds are fixed, while the optimiser varies the value"
        yield Fault(
            (*loc, "lower"), message, "write half_width, factor or cv, which move with the value"
        )
    elif value is not None:
        assert target.quantity is not None
        message, remedy = misfit(shape, entry, value, target.quantity)
        if message:
            key = stated[0] if stated else "distribution"
            yield Fault((*loc, key), message, remedy)
