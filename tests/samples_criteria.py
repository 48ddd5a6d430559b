"""Samples of the law tests for the criteria models; merged into `model_samples`."""

from __future__ import annotations

SAMPLES: dict = {}
