"""Metrics: everything that an evaluation computes."""

from .metric import MetricRow
from .table import METRICS, of_metric

__all__ = ["METRICS", "MetricRow", "of_metric"]
