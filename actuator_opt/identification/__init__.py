"""Identification: friction, damping and modulus from the records of a test bench."""

from .bending import BendingResult, Specimen, bending
from .calibration import Calibration, calibration
from .column_units import ColumnUnits, column_units
from .identify import identify
from .record import CHANNELS, Record, parse_column, parse_record
from .result import Identification, Settings

__all__ = [
    "CHANNELS",
    "BendingResult",
    "Calibration",
    "ColumnUnits",
    "Identification",
    "Record",
    "Settings",
    "Specimen",
    "bending",
    "calibration",
    "column_units",
    "identify",
    "parse_column",
    "parse_record",
]
