"""Samples of the law tests for the rods models; merged into `model_samples`."""

from __future__ import annotations

SAMPLES: dict = {}
