"""Metrics: all results that an evaluation computes, declared in one table."""

from .metric import MetricRow
from .table import METRICS, of_metric

__all__ = ["METRICS", "MetricRow", "of_metric"]
