"""Comparison of measured records with simulations: residuals, and fitted model parameters."""

from .fit import Fit, fit
from .parameters import PARAMETERS
from .record import AlignedRecord, Overlay, overlay, parse_measured

__all__ = ["PARAMETERS", "AlignedRecord", "Fit", "Overlay", "fit", "overlay", "parse_measured"]
