"""Explains why a problem is infeasible: relaxed limits, sufficient changes, binding bounds.

All amounts are margins, as fractions of the limits. The least total relaxation makes the problem
feasible with the least sum of margins given up (an elastic programme [Chinneck2008]). The sum
favours a large relaxation of few requirements over a small relaxation of many. Physical laws
(geometry) are never relaxed. All searches are local and start from the given points. Their remedies
are valid, but others may exist.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ..base.progress import tell
from ..base.quantities import Quantity
from ..design import quantity_of
from ..evaluation.limits import LimitRow
from ..metrics import METRICS, is_safety
from . import kkt, repairs
from .actuator import ActuatorProblem
from .cures import DIGITS, Cure, Cures, cures, is_property, outward
from .evaluator import Evaluator, Point
from .joint_cures import MOST_TOGETHER, joint_cures
from .problem import BoxProblem, Vector
from .repairs import NOTHING, WIDEST, Conflict, Opening, RelaxedConstraint
from .result import Infeasibility
from .solution import Outcome, Solution

STARTS = 2
"""Maximum number of starts in the search for the least total relaxation of all limits."""

ROOM = 1.001
"""A limit is relaxed by this multiple of the least sufficient relaxation."""


def explain(problem: BoxProblem, points: Sequence[Vector]) -> Conflict:
    """Explain why a problem has no feasible point.

    Parameters
    ----------
    problem : the problem; `relaxable` separates requirements from laws (None: all relaxable)
    points : starting points (n,), such as the least infeasible points of a search
    """
    tell("infeasible: searching for the smallest relaxation")
    m = len(problem.constraint_names)
    mask = np.ones(m, dtype=bool) if problem.relaxable is None else np.array(problem.relaxable)
    all_groups = _groups(problem)
    groups = [group for group in all_groups if mask[group].all()]
    point, evaluator = _smallest(problem, groups, points)
    laws: tuple[str, ...] = ()
    if point.violation > NOTHING and not mask.all():
        groups = all_groups
        point, evaluator = _smallest(problem, groups, points)
        amounts = point.x[len(problem.names) :]
        laws = tuple(
            problem.constraint_names[group[0]]
            for group, amount in zip(groups, amounts, strict=True)
            if not mask[group].all() and amount > NOTHING
        )
    quality = kkt.check(evaluator, point, objective_scale=1.0)
    joint = _joint(problem, groups, mask, point)
    sole: tuple[RelaxedConstraint, ...] = ()
    x = point.x[: len(problem.names)]
    if joint and not laws:
        part = _conflicting(evaluator, point, quality)
        named = {row.index for row in joint}
        candidates = [group for group in groups if part[group].any() or group[0] in named]
        sole = repairs.by_limits(problem, candidates, named, [x, *points[:STARTS]])
        smaller = _smaller_relaxation(problem, evaluator, groups, candidates, sole, point)
        if smaller is not None:
            point, quality = smaller, kkt.check(evaluator, smaller, objective_scale=1.0)
            joint, x = _joint(problem, groups, mask, point), point.x[: len(problem.names)]
    openings = _binding_bounds(problem, evaluator, quality)
    if joint and not laws:
        openings = repairs.by_bounds(problem, openings, x)
    return Conflict(
        joint, sole, openings, laws, x, float(point.objective), quality.residual,
        quality.multipliers,
    )  # fmt: skip


def _joint(
    problem: BoxProblem,
    groups: list[repairs.Indices],
    mask: npt.NDArray[np.bool_],
    point: Point,
) -> tuple[RelaxedConstraint, ...]:
    """The relaxations (slacks) at a point of the relaxed problem, largest first."""
    amounts = point.x[len(problem.names) :]
    joint = [
        RelaxedConstraint(problem.constraint_names[group[0]], int(group[0]), float(amount))
        for group, amount in zip(groups, amounts, strict=True)
        if amount > NOTHING and mask[group].all() and point.violation <= NOTHING
    ]
    return tuple(sorted(joint, key=lambda r: -(r.amount or 0.0)))


def _smaller_relaxation(
    problem: BoxProblem,
    evaluator: Evaluator,
    groups: list[repairs.Indices],
    candidates: list[repairs.Indices],
    sole: Sequence[RelaxedConstraint],
    point: Point,
) -> Point | None:
    """A relaxation of one limit alone, less than the total found for all limits; or None.

    Such a relaxation exists only if the descent to the least total relaxation stalled.
    """
    single = [(r.amount, group) for r, group in zip(sole, candidates, strict=True) if r.amount]
    amount, group = min(single, key=lambda entry: entry[0], default=(np.inf, groups[0]))
    if amount >= point.objective - NOTHING:
        return None
    x = point.x[: len(problem.names)]
    start = repairs.without_each(problem, [group], x, [ROOM * amount])[0]
    if start is None:
        return None
    lacks = repairs.missed(Evaluator(problem), start, groups)
    end = repairs.descend(evaluator.problem, start, lacks)
    improved = end.violation <= NOTHING and end.objective < point.objective
    return end if improved else None


def _conflicting(
    evaluator: Evaluator, point: Point, quality: kkt.KktResidual
) -> npt.NDArray[np.bool_]:
    """Mask of the constraints that conflict with each other even if all others are dropped.

    The multipliers of the relaxation prove this locally, and globally for a convex problem. If the
    relaxation is not optimal, every active constraint counts as a possible cause.
    """
    if quality.residual <= NOTHING:
        return np.asarray(quality.multipliers > 1e-7)
    return point.rows[1 : 1 + evaluator.constraint_count] <= kkt.ACTIVE


def _groups(problem: BoxProblem) -> list[repairs.Indices]:
    """Indices of the constraints, grouped by the limit to which they belong."""
    m = len(problem.constraint_names)
    numbers = np.arange(m) if problem.groups is None else np.asarray(problem.groups)
    return [np.flatnonzero(numbers == number) for number in dict.fromkeys(numbers.tolist())]


def _smallest(
    problem: BoxProblem, groups: list[repairs.Indices], points: Sequence[Vector]
) -> tuple[Point, Evaluator]:
    """The point with the smallest sum of relaxations, from several starts, and its evaluator."""
    judge = Evaluator(problem)
    room, starts = 1.0, []
    for x in list(points)[:STARTS] or [(problem.lower + problem.upper) / 2]:
        lacks = repairs.missed(judge, x, groups)
        room = max(room, 2.0 * max(lacks, default=0.0))
        starts.append((x, lacks))
    stretched = repairs.separate(problem, groups, [room] * len(groups))
    ends: list[Point] = []
    for x, lacks in starts:
        elastic_end = repairs.descend(stretched, x, lacks, ends)
        if elastic_end.valid and not any(elastic_end is end for end in ends):
            ends.append(elastic_end)
    smallest = min(ends, key=lambda end: (max(end.violation - NOTHING, 0.0), end.objective))
    return smallest, Evaluator(stretched)


def _binding_bounds(
    problem: BoxProblem, evaluator: Evaluator, quality: kkt.KktResidual
) -> tuple[Opening, ...]:
    """Bounds which, if wider, would decrease the total relaxation; the most helpful first."""
    openings = []
    space = evaluator.space
    for k, j in enumerate(space.free):
        if j >= len(problem.names):
            continue
        for side, multiplier, limit in (
            ("lower", quality.lower_multipliers[j], problem.lower[j]),
            ("upper", quality.upper_multipliers[j], problem.upper[j]),
        ):
            if multiplier > 1e-7:
                widening = 1.0 if space.logarithmic[k] else abs(limit) / space.scale[k]
                openings.append(
                    Opening(
                        problem.names[j], int(j), side, float(limit), float(multiplier * widening)
                    )
                )
    return tuple(sorted(openings, key=lambda b: -b.gain))


MORE_DIGITS = 6
"""Number of digits for changes below one per cent."""


KINDS = ("dimension", "choice", "bound", "number", "requirement", "safety factor")
"""Kinds of change, the most advisable first. A "number" is a property, such as the friction
coefficient of a seal, that another finish or coating would have to reach."""


_ORIGINS = {"requirement": "requirement", "case": "load case", "check": "check list"}


def explained(
    actuator: ActuatorProblem, solution: Solution
) -> tuple[Infeasibility | None, Solution]:
    """Explain an infeasible result; also return the solution with the least total relaxation.

    A feasible result, or a search stopped by the evaluation or time limit, has no explanation.
    """
    limited = solution.outcome is Outcome.LIMIT_INFEASIBLE
    if solution.feasible or solution.kkt is None or limited:
        return None, solution
    points = [optimum.x for optimum in solution.optima] or [solution.x]
    conflict = explain(actuator.problem, points)
    objective = float(np.ravel(actuator.evaluate(conflict.x[:, None]).objective)[0])
    closest = replace(solution, x=conflict.x, objective=objective, kkt=None)
    return _card(actuator, conflict, _remedies(actuator, conflict), solution), closest


def _remedies(actuator: ActuatorProblem, conflict: Conflict) -> Cures:
    """Single changes; if none keeps every requirement, bounds and dimensions together."""
    found = cures(actuator, conflict)
    kept = found.dimensions or found.together or found.choices
    if kept or not conflict.joint or any(bound.needed is not None for bound in conflict.bounds):
        return found
    together = joint_cures(actuator, conflict.x)
    return replace(found, together=together, tried_together=True)


def _card(
    actuator: ActuatorProblem, explanation: Conflict, remedies: Cures, solution: Solution
) -> Infeasibility:
    named = {r.index for r in explanation.joint}
    sole = sorted(explanation.sole, key=lambda r: math.inf if r.amount is None else r.amount)
    joint = tuple(entry_of(actuator, r) for r in explanation.joint)
    single = tuple(
        entry_of(actuator, r)
        for r in sole
        if r.amount is not None
        or r.index in named
        or actuator.rows[r.index].limit_of.origin != "check"
    )
    bounds = tuple(_bound_entry(actuator, bound) for bound in explanation.bounds)
    sufficient = [
        *(
            _cure_entry(actuator, "number" if is_property(actuator, cure) else "dimension", cure)
            for cure in remedies.dimensions
        ),
        *([_joint_entry(actuator, remedies.together)] if remedies.together else []),
        *(_cure_entry(actuator, "choice", cure) for cure in remedies.choices),
        *(_limit_entry(bound, "bound") for bound in bounds if bound["needed"] is not None),
        *(_limit_entry(entry, _kind(entry)) for entry in single if entry["needed"] is not None),
    ]
    sufficient.sort(key=lambda cure: KINDS.index(cure["kind"]))
    return Infeasibility(
        joint=joint,
        sole=single,
        bounds=bounds,
        laws=explanation.laws,
        total=explanation.total,
        sentence=_sentence(joint, sufficient, explanation.laws),
        evidence=_evidence(explanation, solution, together=remedies.tried_together),
        cures=tuple(sufficient),
        untried=remedies.untried,
        failed=remedies.failed,
    )


def _kind(entry: Mapping[str, Any]) -> str:
    """The kind of limit: "requirement" or "safety factor"."""
    return "safety factor" if entry["safety_factor"] else "requirement"


def _limit_entry(entry: Mapping[str, Any], kind: str) -> dict[str, Any]:
    """Record of a cure: a limit or bound whose change alone is enough."""
    return {
        "kind": kind,
        "parameter": entry["parameter"] or entry["requirement"],
        "advised": kind != "safety factor",
        "now": entry["value"] if kind == "bound" else entry["limit"],
        "objective": None,
    } | {name: entry[name] for name in ("needed", "change", "limit_text", "needed_text")}


def _joint_entry(actuator: ActuatorProblem, dimensions: Sequence[Cure]) -> dict[str, Any]:
    """Record of a cure: dimensions that are only enough if all of them change."""
    parts = [_cure_entry(actuator, "dimension", cure) for cure in dimensions]
    texts = ("parameter", "limit_text", "needed_text")
    entry: dict[str, Any] = {
        "kind": "dimension",
        "advised": True,
        "now": None,
        "needed": None,
        "change": None,
        "objective": parts[0]["objective"],
    }
    return entry | {name: " + ".join(part[name] for part in parts) for name in texts} | {
        "together": parts
    }  # fmt: skip


def _cure_entry(actuator: ActuatorProblem, kind: str, cure: Cure) -> dict[str, Any]:
    """Record of a cure: a dimension or choice whose change alone is enough."""
    entry: dict[str, Any] = {"kind": kind, "parameter": cure.path, "advised": True, "now": cure.now}
    best = cure.objective
    entry["objective"] = None if best is None else actuator.goal.shown(best)
    if isinstance(cure.now, str) or isinstance(cure.needed, str):
        further = ", ".join(
            f"{path.rpartition('.')[2]} {text}" for path, text in cure.beside.items()
        )
        needed = f"{cure.needed}, with {further}" if further else str(cure.needed)
        texts = {"limit_text": str(cure.now), "needed_text": needed, "beside": dict(cure.beside)}
        return entry | {"needed": cure.needed, "change": None} | texts
    quantity = quantity_of(cure.path, actuator.subject.design)
    return entry | {
        "needed": cure.needed,
        "change": cure.needed / cure.now - 1,
        "limit_text": quantity.text(cure.now, MORE_DIGITS),
        "needed_text": quantity.text(cure.needed, MORE_DIGITS),
    }


def entry_of(actuator: ActuatorProblem, relaxed: RelaxedConstraint) -> dict[str, Any]:
    """Record of a requirement: its stated limit, and the limit that would be enough."""
    row, amount = actuator.rows[relaxed.index], relaxed.amount
    limit = float(np.ravel(row.limit)[0])
    path, sense = row.limit_of.path, row.limit_of.sense
    quantity = METRICS.get(row.limit_of.metric) or actuator.subject.quantities.get(
        row.limit_of.metric
    )
    if row.limit_of.lever is not None and path is not None:
        limit = actuator.subject.numbers[path]
        quantity = quantity_of(path, actuator.subject.design)
    needed = None if amount is None else _relaxed(row, limit, amount)
    change = None if needed is None or not limit else needed / limit - 1
    display = quantity or Quantity(row.limit_of.metric, "", "ratio", "", row.limit_of.metric)
    entry: dict[str, Any] = {
        "requirement": row.limit_of.name,
        "parameter": path,
        "origin": _ORIGINS.get(row.limit_of.origin, row.limit_of.origin),
        "safety_factor": _protects_safety(row),
        "metric": row.limit_of.metric,
        "sense": sense,
        "limit": limit,
        "needed": needed,
        "relaxation": amount,
        "change": change,
    }
    return entry | _texts(display, limit, needed, upwards=sense == "max")


def _protects_safety(row: LimitRow) -> bool:
    """Whether a limit protects safety: it belongs to the check list or to a safety factor."""
    return row.limit_of.origin == "check" or is_safety(row.limit_of.metric)


def _relaxed(row: LimitRow, limit: float, amount: float) -> float:
    """The limit after a margin `amount` is given up."""
    step = amount * (abs(limit) or 1.0)
    return limit - step if row.limit_of.sense == "min" else limit + step


def _bound_entry(actuator: ActuatorProblem, bound: Opening) -> dict[str, Any]:
    quantity = quantity_of(bound.variable, actuator.subject.design)
    upper = bound.side == "upper"
    return {
        "variable": bound.variable,
        "parameter": f"variables.{bound.variable}.{bound.side}",
        "quantity": quantity.name,
        "bound": bound.side,
        "value": bound.value,
        "gain": bound.gain,
        "needed": bound.needed,
        "change": None if bound.needed is None else bound.needed / bound.value - 1,
    } | _texts(quantity, bound.value, bound.needed, upwards=upper)


def _texts(
    quantity: Quantity, limit: float, needed: float | None, *, upwards: bool
) -> dict[str, str]:
    """Stated and needed limit as text; `needed` is rounded so that the printed value is enough."""
    texts = {"limit_text": quantity.text(limit, MORE_DIGITS), "needed_text": ""}
    if needed is not None:
        fine = abs(needed - limit) < 0.01 * abs(limit)
        value = outward(quantity.to_display(needed), MORE_DIGITS if fine else DIGITS, upwards)
        short = f"{value:.{MORE_DIGITS}g}"
        if "e" in short and 1 <= abs(value) < 1e7:
            short = f"{value:.0f}"
        texts["needed_text"] = f"{short} {quantity.unit}".rstrip()
    return texts


def change_text(entry: Any) -> str:
    """``PATH 250 N -> 283.1 N (+13.2 %)``; changes needed together are joined by "and"."""
    if "together" in entry:
        return " and ".join(change_text(part) for part in entry["together"])
    name = entry.get("parameter") or entry["requirement"]
    change = entry.get("change")
    share = "" if change is None else f" ({percent(change)})"
    return f"{name} {entry['limit_text']} -> {entry['needed_text']}{share}"


def percent(share: float) -> str:
    """A signed share in per cent with three significant digits.

    >>> percent(0.132398), percent(-0.00035), percent(1e-8)
    ('+13.2 %', '-0.035 %', '+0.000001 %')
    """
    if share and abs(share) < 1e-6:
        return f"{100 * share:+.6f} %"
    return f"{100 * share:+.3g} %"


_ACTS = {"dimension": "change {}", "choice": "change {}", "bound": "widen {}"}
"""Advice for each kind of cure, except for limits; {} is replaced by the change."""


def _sentence(
    joint: Sequence[Mapping[str, Any]], sufficient: Sequence[Mapping[str, Any]], laws: Sequence[str]
) -> str:
    """The advice in one line: the first cure, or the smallest change of limits."""
    if laws:
        return (
            "infeasible whatever the requirements, because no design within the bounds meets "
            f"all geometric conditions (in conflict: {', '.join(laws)})"
        )
    if not joint:
        return "infeasible, and the search found no relaxation of the requirements that is enough"
    cure = sufficient[0] if sufficient else None
    if cure is not None and cure["kind"] in _ACTS:
        enough_text = " together" if "together" in cure else ""
        advice = _ACTS[cure["kind"]].format(change_text(cure))
        return f"infeasible: it is enough to {advice}{enough_text}"
    changes = "; ".join(change_text(entry) for entry in joint)
    unsafe = any(entry["safety_factor"] for entry in joint)
    if len(joint) == 1:
        sentence = f"infeasible: the smallest change is {changes}"
    else:
        sentence = f"infeasible: the smallest total change relaxes {len(joint)} limits: {changes}"
    if unsafe:
        sentence += " (this weakens a safety factor: not advised)"
    if cure is not None and (unsafe or len(joint) > 1) and cure["advised"]:
        sentence += f". This change alone is also enough: {change_text(cure)}"
    return sentence


def _evidence(explanation: Conflict, solution: Solution, *, together: bool) -> str:
    """Sentence on how far the advice is proven."""
    count = len(solution.starts)
    starts = f"{count} start{'' if count == 1 else 's'}"
    statement = (
        f"no feasible design was found from {starts} selected from {solution.samples} points"
    )
    if explanation.laws:
        return f"{statement}: this is evidence, not proof"
    return (
        f"{statement}: this is evidence, not proof. A feasible design confirms each change "
        "listed as enough. The search found no feasible design with smaller changes, nor "
        "with single changes that are not listed. Bounds and fixed dimensions were varied "
        f"up to {WIDEST:g} times or down to 1/{WIDEST:g} of their value, one at a time"
        + (f"; then together, at most {MOST_TOGETHER} of them" if together else "")
    )
