"""Discrete sizes of a variable: from its own list, a step, a standard series, or whole plies.

Some sizes depend on another variable: the rod of a catalogue cylinder on its bore, the squeeze of a
standard gland on its ring, the bore of a tubular rod on its outer diameter. Whether a layer may
have an odd number of plies depends on their angle. `groups` joins such variables and lists their
allowed combinations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from math import pi
from typing import Any

from ..base import errors
from ..base.dataclass import dataclass
from ..base.errors import Fault
from ..base.quantities import Quantity
from .kinds import ValueFault, example, read_quantity, shape_in_words
from .paths import resolve
from .standard_sizes import SERIES, SizeSeries
from .structure import FileView, Loc, child, child_at, number_of, value_at

MOST_SIZES = 1000
"""Largest number of sizes of a variable, and of combinations of a group."""

ROOM = 1e-9
"""Relative distance by which a size may exceed a bound, as a tolerance for rounding."""


@dataclass(frozen=True, slots=True)
class VariableGroup:
    """Variables with discrete sizes: PATHs, source of the sizes, allowed combinations (SI)."""

    paths: tuple[str, ...]
    labels: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class _Rule:
    """Rule for the sizes of a variable, which may depend on the value of a `parent` variable."""

    path: str
    label: str
    each: str
    values: Callable[[float | None], Sequence[float]]
    parent: str | None = None
    series: str = ""


def read(loc: Loc, bounds: dict[str, Any], quantity: Quantity) -> Iterator[Fault]:
    """Convert `sizes` and `step` of a variable to SI, in place, and yield their faults."""
    if "sizes" in bounds and "step" in bounds:
        yield Fault(
            (*loc, "step"),
            "both sizes and step are stated for this variable",
            "keep one",
            at_key=True,
        )
    if bounds.get("step") is not None:
        yield from _read_step(loc, bounds, quantity)
    sizes = bounds.get("sizes")
    if sizes is None:
        return
    here, sample = (*loc, "sizes"), f"[{example(quantity)}]"
    if isinstance(sizes, str):
        if sizes not in SERIES:
            suitable = [
                name for name, series in SERIES.items() if series.paths.fullmatch(str(loc[-1]))
            ]
            message = f'"{errors.shown(sizes)}" is not a series of sizes'
            remedy = errors.remedy(sizes, suitable)
            yield Fault(
                here, message, f"{remedy}, or list them: {sample}" if remedy else f"write {sample}"
            )
        elif SERIES[sizes].paths.fullmatch(str(loc[-1])) is None:
            series = SERIES[sizes]
            yield Fault(
                here, f"{sizes} has no sizes for {loc[-1]}", f"this series is for {series.suits}"
            )
    elif not isinstance(sizes, list):
        yield Fault(
            here, f"need sizes, not {shape_in_words(sizes)}", f"write {sample}, or a series"
        )
    elif not sizes:
        yield Fault(here, "the list is empty", f"write e.g. {sample}, or remove the line")
    elif len(sizes) > MOST_SIZES:
        yield Fault(here, f"{len(sizes)} sizes are too many", f"keep at most {MOST_SIZES}")
    else:
        yield from _read_list(here, sizes, bounds, quantity)


def _read_step(loc: Loc, bounds: dict[str, Any], quantity: Quantity) -> Iterator[Fault]:
    lower, upper = bounds.get("lower"), bounds.get("upper")
    here = (*loc, "step")
    try:
        step = bounds["step"] = read_quantity(bounds["step"], _difference(quantity))
    except ValueFault as fault:
        yield Fault(here, fault.message, fault.remedy)
        return
    if not isinstance(lower, float) or not isinstance(upper, float) or lower >= upper:
        return
    if step == 0.0 or (upper - lower) / step > MOST_SIZES:
        message = f"{quantity.text(step)}: more than {MOST_SIZES} sizes between the bounds"
        least = quantity.text((upper - lower) / MOST_SIZES)
        yield Fault(
            here,
            message,
            f"write at least {least}, or remove the line so that the variable is continuous",
        )


def _difference(quantity: Quantity) -> Quantity:
    """Quantity of a step: like that of the variable, but without negative values."""
    if quantity.dimension == "temperature":
        raise ValueFault("a temperature has no step", "list its sizes")
    return replace(quantity, lower=0.0)


def _read_list(
    loc: Loc, sizes: list[Any], bounds: dict[str, Any], quantity: Quantity
) -> Iterator[Fault]:
    read_sizes: list[tuple[int, float]] = []
    lower, upper = bounds.get("lower"), bounds.get("upper")
    for index, raw in enumerate(sizes):
        if raw is None:
            continue  # already a fault
        try:
            value = sizes[index] = read_quantity(raw, quantity)
        except ValueFault as fault:
            yield Fault((*loc, index), fault.message, fault.remedy)
            continue
        near = ROOM * abs(value)
        twin = next((i for i, other in read_sizes if abs(other - value) <= near), None)
        if twin is not None:
            message = f"{errors.shown(raw)}: the same as value {twin + 1} of the list"
            yield Fault((*loc, index), message, "keep one of them")
        read_sizes.append((index, value))
        if not isinstance(lower, float) or not isinstance(upper, float) or lower > upper:
            continue
        if not lower - near <= value <= upper + near:
            bounds_text = f"{quantity.text(lower)} to {quantity.text(upper)}"
            message = f"{quantity.text(value)}: outside the bounds {bounds_text}"
            yield Fault((*loc, index), message, "remove it, or widen the bounds")


STEP_LABEL = "steps of "
"""First words of the label of sizes that are multiples of a step."""
SHOP_STEPS = {"length": 1e-4, "angle": pi / 180, "ratio": 1e-2}
"""Steps of dimensions in a workshop, by dimension: 0.1 mm, 1 deg, and 1 % for the squeeze of a
seal. Our choice."""


def groups(
    tree: Any, *, plies: bool = False, standard: bool = False, shop: bool = False
) -> tuple[tuple[VariableGroup, ...], tuple[Fault, ...]]:
    """Find the variables with discrete sizes; variables that depend on each other share a group.

    Parameters
    ----------
    tree : a design, or its tree in SI
    plies : whether layers that state their ply thickness take only whole plies, and angles only the
        allowed angles
    standard : whether every variable for which a standard series exists takes only sizes of that
        series
    shop : whether every other variable takes only multiples of a workshop's step (`SHOP_STEPS`)

    Returns
    -------
    groups of variables, and faults of variables that no size suits
    """
    view = FileView(tree)
    rules = {}
    for path in _paths(tree):
        rule = _rule(view, path, plies, standard) or (_shop_rule(view, path) if shop else None)
        if rule is not None:
            rules[path] = rule
    size_groups, faults = [], []
    for members in _families(rules):
        try:
            size_groups.append(_group(view, members))
        except _NoSize as error:
            faults.append(error.fault(tree))
    return tuple(size_groups), tuple(faults)


class _NoSize(Exception):
    """No size suits a variable."""

    def __init__(self, path: str, message: str, remedy: str) -> None:
        super().__init__(message)
        self.path, self.message, self.remedy = path, message, remedy

    def fault(self, tree: Any) -> Fault:
        """The fault, located at the key `sizes` or `step`, else at the variable itself."""
        block: Loc = ("variables", self.path)
        for key in ("sizes", "step"):
            if child_at(tree, (*block, key)) is not None:
                return Fault((*block, key), self.message, self.remedy)
        return Fault(block, self.message, self.remedy, at_key=True)


def _paths(tree: Any) -> list[str]:
    """PATHs of the variables that are numbers with valid bounds."""
    block = child(tree, "variables")
    numeric = []
    for path in block if isinstance(block, dict) else ():
        lower, upper = (child_at(tree, ("variables", path, key)) for key in ("lower", "upper"))
        if not isinstance(lower, float) or not isinstance(upper, float) or lower > upper:
            continue
        try:
            target = resolve(path, tree, near=False)
        except ValueFault:
            continue
        if target.quantity is not None:
            numeric.append(path)
    return numeric


def _rule(view: FileView, path: str, plies: bool, standard: bool) -> _Rule | None:
    """Rule for the sizes of a variable, from the file or a command-line option.

    None if the variable is continuous.
    """
    sizes, step = (child_at(view.tree, ("variables", path, key)) for key in ("sizes", "step"))
    lower, upper = _bounds(view, path)
    if isinstance(step, float):
        if (upper - lower) > step * MOST_SIZES:
            return None  # already a fault
        return _step_rule(view, path, step)
    if isinstance(sizes, (list, tuple)):
        values = sorted(value for value in sizes if isinstance(value, float))
        if not values or len(values) < len(sizes):
            return None  # already a fault
        return _Rule(path, "own list", "size of the list", lambda _: values)
    if isinstance(sizes, str):
        series = SERIES.get(sizes)
        return _series_rule(series, view, path) if series and series.paths.fullmatch(path) else None
    for series in SERIES.values():
        selected = (standard and series.option != "file") or (plies and series.option == "plies")
        if selected and series.paths.fullmatch(path) and series.fault(view, path) is None:
            return _series_rule(series, view, path)
    return None


def _step_rule(view: FileView, path: str, step: float) -> _Rule:
    quantity, bounds = resolve(path, view.tree).quantity, _bounds(view, path)
    assert quantity is not None
    return _Rule(path, f"{STEP_LABEL}{quantity.text(step)}", f"multiple of {quantity.text(step)}",
                 lambda _: _multiples(step, bounds))  # fmt: skip


def _shop_rule(view: FileView, path: str) -> _Rule | None:
    """Rule for steps of a workshop, ten times as large while the bounds contain too many of them.

    None for a variable that is no dimension of a part.
    """
    quantity, (lower, upper) = resolve(path, view.tree).quantity, _bounds(view, path)
    step = SHOP_STEPS.get("" if quantity is None else quantity.dimension)
    if step is None:
        return None
    while upper - lower > step * MOST_SIZES:
        step = 10 * step
    return _step_rule(view, path, step)


def _series_rule(series: SizeSeries, view: FileView, path: str) -> _Rule:
    bounds, parent = _bounds(view, path), series.parent(path)
    return _Rule(
        path,
        series.label,
        series.each(view, path),
        lambda value: series.values(view, path, value, bounds),
        parent,
        series.name,
    )


def _bounds(view: FileView, path: str) -> tuple[float, float]:
    lower, upper = (child_at(view.tree, ("variables", path, key)) for key in ("lower", "upper"))
    return float(lower), float(upper)


def _multiples(step: float, bounds: tuple[float, float]) -> list[float]:
    """Multiples of a step, from just below to just above the bounds, without rounding errors."""
    first, last = (int(bound // step) for bound in bounds)
    return [float(count * Decimal(repr(step))) for count in range(first - 1, last + 3)]


def _families(rules: dict[str, _Rule]) -> Iterator[list[_Rule]]:
    """Yield groups of rules whose sizes depend on each other.

    Groups are in the order of the variables; in each, a parent comes before its dependants.
    """
    remaining = dict(rules)

    def below(path: str) -> Iterator[_Rule]:
        if path in remaining:
            yield remaining.pop(path)
            for other in list(remaining):
                if other in remaining and remaining[other].parent == path:
                    yield from below(other)

    for path, rule in rules.items():
        top = rule
        while top.parent in rules:
            top = rules[top.parent]
        if path in remaining:
            yield list(below(top.path))


def _group(view: FileView, members: Sequence[_Rule]) -> VariableGroup:
    """List all allowed combinations of a group; raise `_NoSize` if there are none."""
    rows: list[tuple[float, ...]] = [()]
    column = {rule.path: index for index, rule in enumerate(members)}
    for rule in members:
        lower, upper = _bounds(view, rule.path)
        if rule.series and (fault := SERIES[rule.series].fault(view, rule.path)):
            raise _NoSize(rule.path, *fault)
        fixed = _fixed(view, rule, column)
        extended, offered = [], set()
        for row in rows:
            parent = row[column[rule.parent]] if rule.parent in column else fixed
            for value in rule.values(parent):
                offered.add(value)
                if lower - ROOM * abs(lower) <= value <= upper + ROOM * abs(upper):
                    extended.append((*row, min(max(value, lower), upper)))
        if not extended:
            raise _none_fits(view, rule, sorted(offered))
        if len(rows) > 1 and len(extended) > MOST_SIZES:
            message = f"{len(extended)} combinations with the sizes of {rule.parent} are too many"
            raise _NoSize(
                rule.path, message, f"narrow the bounds; at most {MOST_SIZES} are allowed"
            )
        rows = extended
    paths, labels = tuple(rule.path for rule in members), tuple(rule.label for rule in members)
    return VariableGroup(paths, labels, tuple(sorted(set(rows))))


def _fixed(view: FileView, rule: _Rule, column: dict[str, int]) -> float | None:
    """Fixed value of the parent (on which the sizes depend); None if it varies or is missing."""
    if rule.parent is None or rule.parent in column:
        return None
    if child_at(view.tree, ("variables", rule.parent)) is None:
        return number_of(value_at(view.tree, resolve(rule.parent, view.tree).loc))
    if SERIES[rule.series].needs_parent:
        raise _NoSize(
            rule.path,
            f"its sizes depend on {rule.parent}, which varies continuously",
            f"state sizes for {rule.parent} too, or fix its value",
        )
    return None


def _none_fits(view: FileView, rule: _Rule, values: Sequence[float]) -> _NoSize:
    """The fault that no size lies between the bounds; it states the nearest sizes outside."""
    quantity = resolve(rule.path, view.tree).quantity
    assert quantity is not None
    lower, upper = _bounds(view, rule.path)
    near = [value for value in values if value < lower][-1:]
    near += [value for value in values if value > upper][:1]
    text = " or ".join(quantity.text(value) for value in near if value > 0)
    message = f"no {rule.each} lies between {quantity.text(lower)} and {quantity.text(upper)}"
    remedy = f"widen the bounds to include {text}" if text else "widen the bounds"
    return _NoSize(rule.path, message, f"{remedy}, or choose other sizes")
