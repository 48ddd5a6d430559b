"""Designs with uncertain inputs: yield, sensitivity indices, tornado and robust optima."""

from .inputs import Input
from .result import Uncertainty
from .study import uncertainty

__all__ = ["Input", "Uncertainty", "uncertainty"]
