"""Metrics: all results that an evaluation computes, declared in one table."""

from .metric_row import MetricRow
from .table import METRICS, is_safety, of_metric, term_of

__all__ = ["METRICS", "MetricRow", "is_safety", "of_metric", "term_of"]
