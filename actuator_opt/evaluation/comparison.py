"""Comparison of designs: inputs that differ, and contributions that explain different results.

The comparison answers which design is lighter, stiffer and smoother. It splits each answer into
contributions that add up: masses of parts, compliances of parts at the stroke position of least
stiffness, friction of seals.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.quantities import Quantity, Sense
from ..base.tables import Displayed
from ..design import Design
from ..design.build import to_tree
from ..design.data_file import DataFile
from ..design.kinds import Fraction
from ..design.paths import NAMED_LISTS, quantity_of
from ..design.structure import child_at
from ..metrics import METRICS
from .result import Evaluation

Value: TypeAlias = float | bool | str | Fraction | None
Name: TypeAlias = Literal["lighter", "stiffer", "smoother"]
SAME = 1e-9
"""Relative difference up to which two numbers count as equal. Our choice, above rounding errors."""
_IDLE = ("name", "notes")
"""Keys of a design that do not affect its results."""
_CONDITIONS = ("supply", "load", "load_cases", "duty", "fluid", "environment", "linkage")
"""Blocks of a design that state what it must do."""
_MADE = ("environment.cure_temperature",)
"""PATHs in these blocks that state how the actuator is made."""


@dataclass(frozen=True, slots=True)
class Change:
    """An input that differs, with its value in each design: a number (SI), a word, or None.

    A block that only some designs have is a single change; its value is "given" in these designs.
    """

    path: str
    quantity: Quantity | None
    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Question:
    """Which design is better by a metric, and the contributions of parts that explain it.

    `values` are the values of the metric (SI), one per design. `parts` are the contributions of
    parts, whose sum is compared: mass in kg, compliance in m/N, friction in N. `best` and `other`
    are the indices of the two designs whose parts are compared; None if no design is better.
    """

    name: Name
    metric: str
    values: tuple[float | None, ...]
    parts: Mapping[str, tuple[float, ...]]
    best: int | None
    other: int | None

    @property
    def steps(self) -> tuple[tuple[str, float], ...]:
        """Change of each part's contribution (SI) from design `other` to `best`, largest first."""
        if self.best is None or self.other is None:
            return ()
        rows = [(part, x[self.best] - x[self.other]) for part, x in self.parts.items()]
        return tuple(sorted((row for row in rows if row[1]), key=lambda row: -abs(row[1])))

    @property
    def leaders(self) -> tuple[int, ...]:
        """Indices of the best design and of designs with an equal value; empty if none is best."""
        best = None if self.best is None else self.values[self.best]
        if best is None:
            return ()
        near = [None if v is None else abs(v - best) <= SAME * abs(best) for v in self.values]
        return tuple(k for k, same in enumerate(near) if same)


@dataclass(frozen=True, slots=True)
class DesignState:
    """Whether a compared design is known to be an optimum.

    `status` is the status of the optimisation; None if the design was only evaluated.
    """

    status: str | None = None
    optimum: bool = False

    @property
    def word(self) -> Literal["optimum", "evaluated"]:
        """Word for the state in JSON."""
        return "optimum" if self.optimum else "evaluated"


@dataclass(frozen=True, slots=True)
class Comparison(Displayed):
    """Designs side by side; the first design is the reference."""

    labels: tuple[str, ...]
    """Letter of each design: A, B, C, ..."""
    origins: tuple[str, ...]
    """File or run of each design."""
    evaluations: tuple[Evaluation, ...]
    changes: tuple[Change, ...]
    questions: tuple[Question, ...]
    states: tuple[DesignState, ...] = ()
    """Whether each design is an optimum; empty if unknown."""

    @property
    def in_short(self) -> tuple[str, str]:
        """The names of the designs, and the number of inputs that differ."""
        names = " and ".join(repr(evaluation.name) for evaluation in self.evaluations)
        return "", f"{names}, {len(self.changes)} inputs differ"

    @property
    def not_optimised(self) -> tuple[int, ...]:
        """Indices of the designs that are not known to be optima."""
        return tuple(k for k, state in enumerate(self.states) if not state.optimum)

    @property
    def unlike(self) -> Mapping[str, tuple[Sense | None, ...]]:
        """Metrics of which the smallest value governs in one design, and the largest in another.

        A metric has several values in a design, one per load case and location. The designs differ
        as above if they limit or optimise the metric in opposite senses. The result has the sense
        in each design: "min" if the smallest value governs, "max" if the largest does.
        """
        names = dict.fromkeys(name for e in self.evaluations for name in e.metrics)
        by_metric = {name: _senses(name, self.evaluations) for name in names}
        return {name: senses for name, senses in by_metric.items() if {"min", "max"} <= {*senses}}

    @property
    def differing_conditions(self) -> tuple[str, ...]:
        """PATHs of differing inputs that state load cases, duty cycles and operating conditions."""
        roots = ((c.path, c.path.partition(".")[0].partition("[")[0]) for c in self.changes)
        return tuple(path for path, root in roots if root in _CONDITIONS and path not in _MADE)

    def limits(self) -> Iterator[tuple[str, str, tuple[Any, ...]]]:
        """Yield name, sense and results of every requirement.

        There is one result for each design; None if the design lacks the requirement.
        """
        known = [{(r.name, r.sense): r for r in e.requirements} for e in self.evaluations]
        for key in dict.fromkeys(key for rows in known for key in rows):
            yield *key, tuple(rows.get(key) for rows in known)

    def metrics(self) -> Iterator[tuple[str, Quantity, tuple[float | None, ...]]]:
        """Yield name, quantity and values of all metrics with a value in at least one design."""
        names = dict.fromkeys(name for e in self.evaluations for name in e.metrics)
        for name in names:
            rows = [e.metrics.get(name) for e in self.evaluations]
            values = tuple(None if row is None else row.value for row in rows)
            if any(value is not None for value in values):
                yield name, next(row.quantity for row in rows if row is not None), values

    def to_dict(self) -> dict[str, Any]:
        """The object that `compare --json` writes (SI), without the texts `answers` and `notes`."""
        return {
            "designs": [
                {
                    "label": label,
                    "origin": origin,
                    "name": e.name,
                    "state": state.word,
                    "status": state.status,
                    "spec_hash": e.spec_hash,
                    "met": e.met,
                    "missed": [row.name for row in e.requirements if not row.met],
                    "without_reserve": list(e.tight),
                    "mass_parts": dict(e.mass_parts),
                    "compliance": weakest(e),
                    "friction_parts": dict(e.friction_parts),
                }
                for label, origin, e, state in zip(
                    self.labels, self.origins, self.evaluations, self.states, strict=True
                )
            ],
            "differences": [
                {
                    "path": c.path,
                    "unit": None if c.quantity is None else c.quantity.si_unit,
                    "values": [_plain(x) for x in c.values],
                }
                for c in self.changes
            ],
            "requirements": [
                {
                    "name": name,
                    "sense": sense,
                    "limits": [None if r is None else r.limit for r in rows],
                    "values": [None if r is None else r.value for r in rows],
                    "margins": [None if r is None else r.margin for r in rows],
                    "met": [None if r is None else r.met for r in rows],
                }
                for name, sense, rows in self.limits()
            ],
            "metrics": {
                name: {"unit": quantity.si_unit, "values": list(values)}
                for name, quantity, values in self.metrics()
            },
        }


def compare(
    evaluations: Sequence[Evaluation], origins: Sequence[str], states: Sequence[DesignState] = ()
) -> Comparison:
    """Compare evaluated designs.

    Parameters
    ----------
    evaluations : two or more; the first is the reference
    origins : file or run of each design, in words
    states : whether each design is an optimum; default: unknown

    Raises
    ------
    InputError : two of the designs are equal
    """
    labels = tuple(chr(ord("A") + k) for k in range(len(evaluations)))
    trees = [_tree(e.design) for e in evaluations]
    for k, tree in enumerate(trees):
        if tree in trees[:k]:
            first = trees.index(tree)
            raise InputError(f"{origins[first]} and {origins[k]} are the same design")
    changes = tuple(
        Change(path, _quantity(path, values, evaluations), tuple(map(_value, values)))
        for path, values in _differences(trees, "")
    )
    masses = _union([e.mass_parts for e in evaluations])
    compliances = _union([weakest(e) for e in evaluations])
    frictions = _union([e.friction_parts for e in evaluations])
    questions = (
        _question("lighter", "mass", evaluations, masses),
        _question("stiffer", "stiffness_min", evaluations, compliances),
        _question("smoother", "friction_running", evaluations, frictions),
    )
    return Comparison(
        labels,
        tuple(origins),
        tuple(evaluations),
        changes,
        questions,
        tuple(states) or (DesignState(),) * len(labels),
    )


def weakest(evaluation: Evaluation) -> dict[str, float]:
    """Compliance [m/N] of every part, at the stroke position of least stiffness."""
    curve = evaluation.curve
    stiffness = np.asarray(curve.stiffness, dtype=float)
    if not np.isfinite(stiffness).any():
        return {}
    place = int(np.nanargmin(stiffness))
    compliances = {name: float(values[place]) for name, values in curve.contributions.items()}
    return {name: value for name, value in compliances.items() if value}


def _union(parts: Sequence[Mapping[str, float]]) -> dict[str, tuple[float, ...]]:
    names = dict.fromkeys(name for part in parts for name in part)
    return {name: tuple(part.get(name, 0.0) for part in parts) for name in names}


def _senses(metric: str, evaluations: Sequence[Evaluation]) -> tuple[Sense | None, ...]:
    """Whether the smallest or largest value of a metric governs each design; None if neither."""
    rows = [e.metrics.get(metric) for e in evaluations]
    return tuple(None if row is None or row.value is None else row.sense for row in rows)


def _question(
    name: Name, metric: str, evaluations: Sequence[Evaluation], parts: dict[str, tuple[float, ...]]
) -> Question:
    """Compare the best design with the first design or, if that is best, with the second best."""
    values = tuple(e.metrics[metric].value for e in evaluations)
    sign = -1.0 if name == "stiffer" else 1.0
    known = [(sign * v, k) for k, v in enumerate(values) if v is not None and math.isfinite(v)]
    if len(known) < 2 or {"min", "max"} <= {*_senses(metric, evaluations)}:
        return Question(name, metric, values, parts, None, None)
    ranked = sorted(known)
    lead, best = ranked[0]
    behind = [k for v, k in ranked if abs(v - lead) > SAME * max(abs(v), abs(lead))]
    if not behind:
        return Question(name, metric, values, parts, None, None)
    return Question(name, metric, values, parts, best, 0 if 0 in behind else behind[0])


class _Missing:
    """Type of the object that marks a missing value."""


_MISSING = _Missing()


def _tree(design: Design) -> dict[str, Any]:
    """Inputs of a design that affect its result, with load cases and cycles by name.

    Starting values of variables are left out.
    """
    tree = {key: value for key, value in to_tree(design).items() if key not in _IDLE}
    tree["variables"] = {
        path: {key: value for key, value in variable.items() if key != "start"}
        for path, variable in tree.get("variables", {}).items()
    }
    for loc in NAMED_LISTS:
        block, entries = child_at(tree, loc[:-1]), child_at(tree, loc) or []
        names = [entry.get("name") for entry in entries]
        if entries and len(set(names)) == len(names):
            block[loc[-1]] = _Named({f"[{entry['name']}]": entry for entry in entries})
    return tree


class _Named(dict[str, Any]):
    """A list of named entries, whose PATHs have the names in brackets, as in `load_cases[out]`."""


def _differences(nodes: Sequence[Any], path: str) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Yield PATH and values of all differences.

    A block that some designs lack is one difference.
    """
    if all(_same(node, nodes[0]) for node in nodes):
        return
    if all(isinstance(node, dict) for node in nodes):
        for key in dict.fromkeys(key for node in nodes for key in node):
            bracket = isinstance(nodes[0], _Named)
            below = f"{path}{key}" if bracket or not path else f"{path}.{key}"
            yield from _differences([node.get(key, _MISSING) for node in nodes], below)
    elif all(isinstance(node, list) for node in nodes):
        for k in range(max(map(len, nodes))):
            entries = [node[k] if k < len(node) else _MISSING for node in nodes]
            yield from _differences(entries, f"{path}[{k}]")
    else:
        yield path, tuple(nodes)


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) <= SAME * max(abs(a), abs(b))
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_same, a, b))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    return bool(a == b)


def _value(node: Any) -> Value:
    """Return a plain value unchanged, and the word "given" for a block."""
    if node is _MISSING or node == {} or node == []:
        return None
    if isinstance(node, DataFile):
        return node.label
    if isinstance(node, dict):
        stated = node.get("material")
        return stated if isinstance(stated, str) else "given"
    if isinstance(node, list):
        flat = all(isinstance(entry, (str, int, float)) for entry in node)
        return ", ".join(map(str, node)) if flat else f"{len(node)} given"
    return float(node) if isinstance(node, int) and not isinstance(node, bool) else node


def _quantity(
    path: str, values: Sequence[Any], evaluations: Sequence[Evaluation]
) -> Quantity | None:
    """Quantity (dimension and unit) at a PATH, from the first design with a number there."""
    for value, evaluation in zip(values, evaluations, strict=True):
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            try:
                return quantity_of(path, evaluation.design)
            except InputError:
                return METRICS.get(path.split(".")[-2]) if path.count(".") else None
    return None


def _plain(value: Value) -> Any:
    return f"{100 * value.value:.12g} %" if isinstance(value, Fraction) else value
