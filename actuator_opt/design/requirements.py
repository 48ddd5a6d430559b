"""Check tables whose keys are free names: variables, requirements, measured values and others.

The unit of an entry depends on its key (a PATH, a metric, a property). Each function converts the
texts of its block to SI numbers in place and yields the faults that it finds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, get_args

from ..base import errors, quantities
from ..base.errors import Fault
from ..base.quantities import Quantity
from ..metrics import OF_LIFE, split_case
from . import sizes
from .kinds import Section, ValueFault, example, read_quantity, shape_in_words
from .model import Design, Shape
from .paths import Target, resolve
from .structure import Loc, child, child_at, entries, number_of, value_at
from .uncertain import KEYS, NUMBERS, misfit, quantity_of_entry

_LARGEST = {
    "ratio": 1e12, "length": 1e3, "mass": 1e7, "force": 1e9, "stiffness": 1e13, "pressure": 1e12,
    "speed": 1e4, "temperature_difference": 1e4, "kinematic_viscosity": 10.0, "frequency": 1e7,
    "flow": 1e3, "damping": 1e13, "energy": 1e12, "power": 1e12, "torque": 1e10,
    "time": 1e6,
}  # fmt: skip
"""Largest plausible limit (SI) by dimension; a larger one is refused as a typing error."""


def limit_quantity(metric: Quantity) -> Quantity:
    """Quantity for the limits of a metric: its range is narrowed to plausible values."""
    largest = _LARGEST.get(metric.dimension, 1e15)
    return replace(metric, lower=max(metric.lower, 0.0), upper=min(metric.upper, largest))


def _number(block: dict[str, Any], loc: Loc, quantity: Quantity) -> Fault | None:
    """Convert the value of the last key of `loc` to SI, if the block has it; return its fault."""
    key = str(loc[-1])
    if block.get(key) is None:
        return None
    try:
        block[key] = read_quantity(block[key], quantity)
    except ValueFault as fault:
        return Fault(loc, fault.message, fault.remedy)
    return None


def _unknown(
    name: object, tree: Mapping[str, Any], metrics: Mapping[str, Quantity]
) -> tuple[str, str] | None:
    """Message and remedy for a name that is no metric; None for METRIC or METRIC[CASE]."""
    metric, case = split_case(str(name))
    if metric not in metrics:
        return f'"{errors.shown(name)}" is not a metric', errors.remedy(metric, metrics)
    if case is None:
        return None
    if metric in OF_LIFE:
        return f"{metric} is a value of all duty cycles together", f"write {metric}"
    duty = metric.startswith("duty_")
    found = child_at(tree, ("duty", "cycles") if duty else ("load_cases",))
    known = [str(child(x, "name")) for x in found] if isinstance(found, (list, tuple)) else []
    if case in known:
        return None
    noun = "duty cycle" if duty else "load case"
    return f'"{errors.shown(case)}" is not a {noun}', errors.remedy(case, known)


def requirements(tree: dict[str, Any], metrics: Mapping[str, Quantity]) -> Iterator[Fault]:
    """Check requirements: known metric, at least one limit, right unit, minimum below maximum."""
    block = tree.get("requirements")
    for metric, limit in block.items() if isinstance(block, dict) else ():
        loc = ("requirements", metric)
        if unknown := _unknown(metric, tree, metrics):
            yield Fault(loc, *unknown, at_key=True)
            continue
        quantity = limit_quantity(metrics[metric])
        if not isinstance(limit, dict):
            if limit is not None:
                sample = errors.shown(limit) if isinstance(limit, str) else example(quantity)
                yield Fault(
                    loc,
                    f"need limits, not {shape_in_words(limit)}",
                    f'write "min: {sample}" or "max: {sample}"',
                )
            continue
        faults = [_number(limit, (*loc, sense), quantity) for sense in ("min", "max")]
        yield from (fault for fault in faults if fault)
        low, high = limit.get("min"), limit.get("max")
        if "min" not in limit and "max" not in limit:
            remedy = f'add e.g. "min: {example(quantity)}" or "max: …"'
            yield Fault((*loc, "min"), "missing: no limit stated", remedy)
        elif isinstance(low, float) and isinstance(high, float) and low > high:
            yield Fault(
                (*loc, "max"),
                f"limits reversed: max {quantity.text(high)} is below min {quantity.text(low)}",
                "swap them",
            )


NAMED = 100
"""Number of unknown variables for which similar PATHs are searched; more are not shown."""


def variables(tree: dict[str, Any]) -> Iterator[Fault]:
    """Check variables: each is the PATH of a number, with valid bounds and a start between them."""
    block = tree.get("variables")
    if not isinstance(block, dict):
        return
    unknown = 0
    for path, bounds in block.items():
        loc = ("variables", path)
        if in_faulty_block(path, tree):
            block[path] = {
                "lower": 0.0,
                "upper": 1.0,
                "start": 0.0,
            }  # the block as a whole already has a fault
            continue
        try:
            target = _movable(path, tree, near=unknown < NAMED)
        except ValueFault as fault:
            unknown += 1
            yield Fault(loc, fault.message, fault.remedy, at_key=True)
            continue
        quantity = target.quantity
        if not isinstance(bounds, dict) or quantity is None:
            if bounds is not None:
                yield Fault(
                    loc,
                    f"need bounds, not {shape_in_words(bounds)}",
                    'write "lower: …" and "upper: …"',
                )
            continue
        faults = [_number(bounds, (*loc, key), quantity) for key in ("lower", "upper", "start")]
        yield from (fault for fault in faults if fault)
        yield from _start(loc, bounds, target, tree)
        yield from sizes.read(loc, bounds, quantity)
    yield from sizes.groups(tree)[1]


def measured(tree: dict[str, Any]) -> Iterator[Fault]:
    """Check measured values: each is the PATH of a number that is set, with valid bounds."""
    block = tree.get("measured")
    if not isinstance(block, dict):
        return
    for path, bounds in block.items():
        loc = ("measured", path)
        if in_faulty_block(path, tree):
            block[path] = {"lower": 0.0, "upper": 1.0, "record": "-"}  # as for variables
            continue
        try:
            target = resolve(path, tree)
        except ValueFault as fault:
            message = fault.message.removeprefix(f"{path}: ")
            yield Fault(loc, message, fault.remedy, at_key=True)
            continue
        if target.quantity is None or target.entry is None:
            yield Fault(
                loc, "is not a numeric input of the actuator", "remove the entry", at_key=True
            )
            continue
        if target.path != path:
            yield Fault(loc, "is not the canonical PATH", f"write {target.path}", at_key=True)
        if value_at(tree, target.loc) is None:
            message = f"{path} is not set, so it has no bounds"
            yield Fault(loc, message, "set it, or remove the entry", at_key=True)
        if not isinstance(bounds, dict):
            if bounds is not None:
                remedy = 'write "lower: …", "upper: …" and "record: …"'
                yield Fault(loc, f"need bounds, not {shape_in_words(bounds)}", remedy)
            continue
        faults = [_number(bounds, (*loc, key), target.quantity) for key in ("lower", "upper")]
        yield from (fault for fault in faults if fault)
        low, high = bounds.get("lower"), bounds.get("upper")
        if isinstance(low, float) and isinstance(high, float) and low > high:
            text = target.quantity.text
            message = f"bounds reversed: upper {text(high)} is below lower {text(low)}"
            yield Fault((*loc, "upper"), message, "swap them")


def in_faulty_block(path: str, tree: dict[str, Any]) -> bool:
    """Whether the block of a PATH is missing or malformed, which is reported elsewhere."""
    name = path.partition(".")[0]
    entry = entries(Design).get(name)
    if entry is None or entry.section is None or entry.shape == "table":
        return False
    if name not in tree:
        return entry.required
    return not isinstance(tree[name], (list, tuple) if entry.shape == "list" else dict)


def _movable(path: str, tree: dict[str, Any], *, near: bool) -> Target:
    """Find the number that a variable varies; raise `ValueFault` if there is none."""
    try:
        target = resolve(path, tree, near=near)
    except ValueFault as fault:
        raise ValueFault(fault.message.removeprefix(f"{path}: "), fault.remedy) from None
    if target.quantity is None:
        raise ValueFault("is text, not a number", "name a number of the design")
    if target.quantity.dimension == "count":
        raise ValueFault(
            "is a count and cannot vary continuously",
            "remove the entry; evaluate one design for each count and compare them",
        )
    if target.entry is None or target.entry.shape == "list":
        raise ValueFault("is not a dimension of the actuator", "name a number of the design")
    if target.path != path:
        raise ValueFault("is not the canonical PATH", f"write {target.path}")
    return target


def _start(
    loc: tuple[str, str], bounds: dict[str, Any], target: Target, tree: dict[str, Any]
) -> Iterator[Fault]:
    """Check that the bounds are in order and the start is between them.

    The start is the key `start`, else the value in the design.
    """
    quantity = target.quantity
    assert quantity is not None
    lower, upper, start = (bounds.get(key) for key in ("lower", "upper", "start"))
    raw = value_at(tree, target.loc)
    place: Loc = (*loc, "start") if "start" in bounds else target.loc
    if raw is None and target.entry is not None and not target.entry.required:
        yield Fault(
            (*loc, "start"),
            f"{target.path} is not set, so it cannot be varied",
            f'write e.g. "{target.loc[-1]}: {example(quantity)}" in its block',
        )
    if "start" not in bounds:
        start = number_of(raw)
        bounds["start"] = 0.0 if start is None else start
    if not isinstance(lower, float) or not isinstance(upper, float):
        return
    if lower == upper:
        message = f"bounds equal: lower and upper are {quantity.text(lower)}, so nothing can vary"
        remedy = f"widen them, or remove the entry and set {target.path} itself"
        yield Fault((*loc, "upper"), message, remedy)
    elif lower > upper:
        yield Fault(
            (*loc, "upper"),
            f"bounds reversed: upper {quantity.text(upper)} is not above lower "
            f"{quantity.text(lower)}",
            "swap them",
        )
    elif isinstance(start, float) and not _between(lower, start, upper):
        yield Fault(
            place,
            f"{quantity.text(start)}: start value outside the bounds",
            f"write {quantity.text(lower)} to {quantity.text(upper)}, or widen "
            f"variables.{target.path}",
        )


def _between(lower: float, start: float, upper: float) -> bool:
    """Whether a start is within its bounds, with a tolerance for rounding by unit conversion."""
    slack = 1e-12 * max(abs(lower), abs(upper))  # as for declared ranges, see `kinds.check_range`
    return lower - slack <= start <= upper + slack


def objective(tree: dict[str, Any], metrics: Mapping[str, Quantity]) -> Iterator[Fault]:
    """Check the objective: either `minimise` or `maximise`, known metrics, positive weights."""
    block = tree.get("objective")
    if not isinstance(block, dict):
        return
    stated = [key for key in ("minimise", "maximise") if key in block]
    if len(stated) != 1:
        if stated:
            message = "both minimise and maximise are stated"
            yield Fault(("objective", stated[1]), message, "keep one of them", at_key=True)
        else:
            yield Fault(("objective", "minimise"), "missing", 'add e.g. "minimise: mass"')
    for key in stated:
        terms = block[key]
        loc = ("objective", key)
        if isinstance(terms, str):
            if unknown := _unknown(terms, tree, metrics):
                yield Fault(loc, *unknown)
        elif isinstance(terms, dict):
            yield from _weights(loc, terms, tree, metrics)


def _weights(
    loc: tuple[str, str],
    terms: dict[str, Any],
    tree: Mapping[str, Any],
    metrics: Mapping[str, Quantity],
) -> Iterator[Fault]:
    weight = replace(quantities.INPUTS["coefficient"], label="weight", upper=1e6)
    for metric in terms:
        fault = _number(terms, (*loc, metric), weight)
        if unknown := _unknown(metric, tree, metrics):
            fault = Fault((*loc, metric), *unknown, at_key=True)
        elif terms[metric] == 0:
            fault = Fault((*loc, metric), "0: must be > 0", "write a weight, or remove the line")
        if fault is not None:
            yield fault
            terms[metric] = 1.0  # already reported, so the model need not refuse it again


def waivers(tree: dict[str, Any], metrics: Mapping[str, Quantity]) -> Iterator[Fault]:
    """Check that every waiver names a metric of the check list."""
    block = tree.get("waivers")
    for metric in block if isinstance(block, dict) else ():
        if metric not in metrics:
            message = f'"{errors.shown(metric)}" is not a metric'
            yield Fault(("waivers", metric), message, errors.remedy(metric, metrics), at_key=True)


def materials(tree: dict[str, Any]) -> Iterator[Fault]:
    """Check the material properties that a design changes; `faults` checks the material names."""
    block = tree.get("materials")
    property_quantities = quantities.MATERIAL_PROPERTIES
    for material, properties in block.items() if isinstance(block, dict) else ():
        loc = ("materials", material)
        if not isinstance(properties, dict):
            if properties is not None:
                yield Fault(
                    loc,
                    f"need properties, not {shape_in_words(properties)}",
                    "write PROPERTY: value",
                )
            continue
        for name in properties:
            if name not in property_quantities:
                message = f'"{errors.shown(name)}" is not a material property'
                yield Fault(
                    (*loc, name), message, errors.remedy(name, property_quantities), at_key=True
                )
                continue
            fault = _number(properties, (*loc, name), property_quantities[name])
            if fault is not None:
                yield fault


def uncertainty(tree: dict[str, Any]) -> Iterator[Fault]:
    """Convert the texts of `uncertainty` to SI in place, and yield all faults of its entries."""
    block = tree.get("uncertainty")
    for path, entry in block.items() if isinstance(block, dict) else ():
        loc = ("uncertainty", path)
        try:
            target = _uncertain_number(path, tree)
        except ValueFault as fault:
            yield Fault(loc, fault.message, fault.remedy, at_key=True)
            continue
        if not isinstance(entry, dict):
            if entry is not None:
                remedy = 'write "distribution: …" and its parameters'
                yield Fault(loc, f"need a distribution, not {shape_in_words(entry)}", remedy)
            continue
        entry_faults = list(_distribution_in_si(loc, entry, target))
        yield from entry_faults or _distribution_faults(loc, entry, target, tree)


def _uncertain_number(path: str, tree: dict[str, Any]) -> Target:
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


def _distribution_in_si(
    loc: tuple[str, str], entry: dict[str, Any], target: Target
) -> Iterator[Fault]:
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


def _distribution_faults(
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


def recheck(
    tree: dict[str, Any], metrics: Mapping[str, Quantity], root: type[Section] = Design
) -> Iterator[Fault]:
    """Run all checks of this module that apply to an object of class `root`."""
    checks = {
        "variables": variables(tree),
        "measured": measured(tree),
        "requirements": requirements(tree, metrics),
        "objective": objective(tree, metrics),
        "waivers": waivers(tree, metrics),
        "materials": materials(tree),
        "uncertainty": uncertainty(tree),
    }
    for name, faults in checks.items():
        if name in entries(root):
            yield from faults
