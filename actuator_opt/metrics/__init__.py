"""Metrics: all results that an evaluation computes, declared in one table."""

from .metric_row import MetricRow
from .table import (
    METRICS,
    OF_LIFE,
    Quantities,
    is_safety,
    of_metric,
    split_case,
    term_of,
)

__all__ = [
    "METRICS",
    "OF_LIFE",
    "MetricRow",
    "Quantities",
    "is_safety",
    "of_metric",
    "split_case",
    "term_of",
]
