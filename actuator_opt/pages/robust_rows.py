"""A robust optimum as tables of its report: the way there, and the reserves it keeps."""

from __future__ import annotations

from ..evaluation.result import Evaluation
from ..optimisation.result import Optimisation
from ..rendering import text
from ..rendering.blocks import Table, text_table
from .uncertainty import percent

WORTH = 10.0
"""Reserves beyond this many times the limit say only that the limit is far away."""


def robust_tables(subject: Evaluation | Optimisation) -> list[Table]:
    """Optima on the way and reserves; none of a plain optimum."""
    found = subject.robust if isinstance(subject, Optimisation) else None
    if found is None or not isinstance(subject, Optimisation):
        return []
    quantity = text.metric(subject.objective_metric)
    way = [
        [str(number), text.value_text(quantity, one.objective, 5), percent(one.rate)]
        for number, one in enumerate(found.rounds)
    ]
    kept = [
        [name, f"{100 * reserve:.1f} %"]
        for name, reserve in sorted(found.reserves.items(), key=lambda pair: -pair[1])
        if 1e-3 <= reserve <= WORTH
    ]
    asked = percent(found.target)
    rounds = text_table(
        f"Towards a yield of {asked}",
        ("round", quantity.label, "all limits hold"),
        way,
        f"Round 0 has no reserves. An independent sample of {found.samples} draws at the design "
        f"shown: {percent(found.rate)} ({percent(found.lower)} to {percent(found.upper)}).",
    )
    reserves = text_table(
        "Reserves kept beyond limits",
        ("limit", "reserve, of the limit"),
        kept,
        "The distance from the margin of the design to the margin that a draw falls below with "
        "the probability allowed to a single limit.",
    )
    return [rounds, reserves] if kept else [rounds]
