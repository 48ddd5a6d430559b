"""The one meeting place of design and models: every quantity of one or many designs."""

from __future__ import annotations

from .build import evaluate, prepare
from .evaluation import Check, Evaluation, Metric, Requirement
from .kernel import Subject, compute

__all__ = [
    "Check",
    "Evaluation",
    "Metric",
    "Requirement",
    "Subject",
    "compute",
    "evaluate",
    "prepare",
]
