"""Metrics: all results that an evaluation computes, declared in one table."""

from .table import METRICS, MetricRow, of_metric

__all__ = ["METRICS", "MetricRow", "of_metric"]
