"""What scatter does to a design: yield, sensitivity indices, tornado, robust optima."""

from .inputs import Input
from .result import Uncertainty
from .study import uncertainty

__all__ = ["Input", "Uncertainty", "uncertainty"]
