"""Metrics: all results that an evaluation computes, declared in one table."""

from .table import METRICS, MetricRow, is_safety, of_metric, term_of

__all__ = ["METRICS", "MetricRow", "is_safety", "of_metric", "term_of"]
