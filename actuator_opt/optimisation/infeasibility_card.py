"""The infeasibility card of an actuator: limits by the PATH one can set, in the units of people."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..design import quantity_of
from ..evaluation.rows import Row
from ..quantities import METRICS, Quantity
from .actuator import ActuatorProblem
from .infeasibility import Infeasibility as Explanation
from .infeasibility import explain
from .outcome import Solution
from .repairs import WIDEST, Opening, Relaxation
from .result import Infeasibility

DIGITS = 4
"""Digits of a needed limit, rounded so that the limit as printed is enough."""

MORE_DIGITS = 6
"""Digits where the change is less than a per cent."""

_ORIGINS = {"requirement": "requirement", "case": "load case", "check": "check list"}


def explained(
    actuator: ActuatorProblem, solution: Solution
) -> tuple[Infeasibility | None, Solution]:
    """Why nothing fits, and the design that needs only the smallest joint relaxation."""
    if solution.feasible or solution.kkt is None:
        return None, solution
    points = [found.x for found in solution.optima] or [solution.x]
    found = explain(actuator.problem, points)
    objective = float(np.ravel(actuator.evaluate(found.x[:, None]).objective)[0])
    closest = replace(solution, x=found.x, objective=objective, kkt=None)
    return _card(actuator, found, solution), closest


def _card(actuator: ActuatorProblem, found: Explanation, solution: Solution) -> Infeasibility:
    named = {r.index for r in found.joint}
    sole = sorted(found.sole, key=lambda r: math.inf if r.amount is None else r.amount)
    joint = tuple(_entry(actuator, r) for r in found.joint)
    alone = tuple(
        _entry(actuator, r)
        for r in sole
        if r.amount is not None
        or r.index in named
        or actuator.rows[r.index].limit_of.origin != "check"
    )
    return Infeasibility(
        joint=joint,
        sole=alone,
        bounds=tuple(_bound(actuator, bound) for bound in found.bounds),
        laws=found.laws,
        total=found.total,
        sentence=_sentence(joint, alone, found.laws),
        evidence=_evidence(found, solution),
    )


def _entry(actuator: ActuatorProblem, relaxed: Relaxation) -> dict[str, Any]:
    """A requirement: its limit as the design states it, and the one that would do."""
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
    shown = quantity or Quantity(row.limit_of.metric, "", "ratio", "", row.limit_of.metric)
    entry = {
        "requirement": row.limit_of.name,
        "parameter": path,
        "origin": _ORIGINS.get(row.limit_of.origin, row.limit_of.origin),
        "metric": row.limit_of.metric,
        "sense": sense,
        "limit": limit,
        "needed": needed,
        "relaxation": amount,
        "change": change,
    }
    return entry | _texts(shown, limit, needed, upwards=sense == "max")


def _relaxed(row: Row, limit: float, amount: float) -> float:
    """The limit that would do after giving up a margin `amount`."""
    step = amount * (abs(limit) or 1.0)
    return limit - step if row.limit_of.sense == "min" else limit + step


def _bound(actuator: ActuatorProblem, bound: Opening) -> dict[str, Any]:
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
    """Both values in the display unit; the needed one rounded so that it is enough as printed."""
    texts = {"limit_text": quantity.text(limit, MORE_DIGITS), "needed_text": ""}
    if needed is not None:
        fine = abs(needed - limit) < 0.01 * abs(limit)
        value = outward(quantity.to_display(needed), MORE_DIGITS if fine else DIGITS, upwards)
        short = f"{value:.{MORE_DIGITS}g}"
        if "e" in short and 1 <= abs(value) < 1e7:
            short = f"{value:.0f}"
        texts["needed_text"] = f"{short} {quantity.unit}".rstrip()
    return texts


def outward(value: float, digits: int, upwards: bool) -> float:
    """A number rounded to some digits, upwards or downwards (but for rounding itself).

    >>> outward(283.0994, 4, True), outward(9.98645, 4, False), outward(400.00000001, 4, True)
    (283.1, 9.986, 400.0)
    """
    if not value or not math.isfinite(value):
        return value
    places = digits - 1 - math.floor(math.log10(abs(value)))
    scaled = value * 10.0**places
    slack = 1e-7 * abs(scaled)
    whole = math.ceil(scaled - slack) if upwards else math.floor(scaled + slack)
    return round(whole / 10.0**places, max(places, 0))


def change_text(entry: Any) -> str:
    """``PATH 250 N -> 283.1 N (+13.2 %)``."""
    name = entry.get("parameter") or entry["requirement"]
    change = entry.get("change")
    share = "" if change is None else f" ({percent(change)})"
    return f"{name} {entry['limit_text']} -> {entry['needed_text']}{share}"


def percent(share: float) -> str:
    """A signed share in per cent with three digits, none lost.

    >>> percent(0.132398), percent(-0.00035), percent(1e-8)
    ('+13.2 %', '-0.035 %', '+0.000001 %')
    """
    if share and abs(share) < 1e-6:
        return f"{100 * share:+.6f} %"
    return f"{100 * share:+.3g} %"


def _sentence(
    joint: Sequence[dict[str, Any]], alone: Sequence[dict[str, Any]], laws: Sequence[str]
) -> str:
    if laws:
        return (
            "nothing fits whatever the requirements: the bounds leave no room for the geometry"
            f" ({', '.join(laws)})"
        )
    if not joint:
        return "nothing fits, and no relaxation that would do was found"
    changes = "; ".join(change_text(entry) for entry in joint)
    if len(joint) == 1:
        return f"nothing fits: the smallest change is {changes}"
    said = f"nothing fits: the smallest change, of {len(joint)} limits together, is {changes}"
    if alone and alone[0]["needed"] is not None:
        said += f". One alone is enough too: {change_text(alone[0])}"
    return said


def _evidence(found: Explanation, solution: Solution) -> str:
    """What was proven by an example, and what was only not found."""
    count = len(solution.starts)
    starts = f"{count} start{'' if count == 1 else 's'}"
    tried = f"no design was found from {starts}, chosen among {solution.samples} points"
    if found.laws:
        return f"{tried}: this is evidence, not proof"
    return (
        f"{tried}: this is evidence, not proof. For every limit said to be enough a design that"
        " meets it was calculated; that less would not do, or that one alone cannot, is again"
        f" only what was found. Bounds were opened to {WIDEST:g} times or 1/{WIDEST:g} of their"
        " value"
    )
