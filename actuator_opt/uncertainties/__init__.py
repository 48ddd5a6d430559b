"""Yield, sensitivity indices, tornado and robust optima of a design with uncertain inputs."""

from .inputs import Input
from .result import Uncertainty
from .study import uncertainty

__all__ = ["Input", "Uncertainty", "uncertainty"]
