"""Comparison of measured records with simulations: residuals, and fitted parameters with bounds."""

from .file import Measured, parse_measured
from .fit import Fit, fit
from .parameters import PARAMETERS
from .record import Overlay, overlay

__all__ = ["PARAMETERS", "Fit", "Measured", "Overlay", "fit", "overlay", "parse_measured"]
