"""Published numbers beside ours, for the designs that re-create a paper."""

from __future__ import annotations

from ..evaluate import Evaluation
from ..optimise.result import Optimisation
from .blocks import ExtraTable


def published_tables(subject: Evaluation | Optimisation) -> list[ExtraTable]:
    """Comparison tables of a design that names a paper; empty for others."""
    del subject
    return []
