"""What an evaluation computes: the table of metrics."""

from .metric import MetricRow
from .table import LEAST_METAL, METRICS, of_metric

__all__ = ["LEAST_METAL", "METRICS", "MetricRow", "of_metric"]
