"""Evaluation: applies the models to one or many designs and computes all their metrics."""

from __future__ import annotations

from .build import evaluate, prepare
from .kernel import PreparedDesign, compute, without_films
from .result import Check, Evaluation, Metric, Requirement

__all__ = [
    "Check",
    "Evaluation",
    "Metric",
    "PreparedDesign",
    "Requirement",
    "compute",
    "evaluate",
    "prepare",
    "without_films",
]
