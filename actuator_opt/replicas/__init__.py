"""Published numbers beside ours, for the designs that re-create a paper.

Published values are data with their place in the paper; everything else in these tables is
computed when the report is made: the paper's own formula (`*_as_published`) with the paper's
numbers, and this project's models on the design as it stands.
"""

from __future__ import annotations

from collections.abc import Callable

from ..evaluation import Evaluation
from ..optimisation.result import Optimisation
from ..pages.report import parts_of
from ..rendering.blocks import ExtraTable
from . import aalto_tables, elasswad_tables, huang_tables


def _each(
    tables: tuple[Callable[[Evaluation], ExtraTable], ...],
) -> Callable[[Evaluation], list[ExtraTable]]:
    return lambda evaluation: [table(evaluation) for table in tables]


TABLES: dict[str, Callable[[Evaluation], list[ExtraTable]]] = {
    "ElAsswad2018": _each(elasswad_tables.TABLES),
    "AaltoThesis": _each(aalto_tables.TABLES),
    "Huang2017": huang_tables.tables,
}
"""What each paper's tables are made by; the keys are those of `Design.reproduces`."""


def published_tables(subject: Evaluation | Optimisation) -> list[ExtraTable]:
    """Comparison tables of a design that names a paper; empty for others."""
    evaluation, _ = parts_of(subject)
    paper = evaluation.design.reproduces
    return [] if paper is None else TABLES[paper](evaluation)
