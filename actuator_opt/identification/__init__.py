"""Identification: friction, damping and modulus from the records of a test bench."""

from .bending import BendingResult, bending
from .calibration import Calibration, calibration
from .column import parse_column
from .column_units import ColumnUnits, column_units
from .csv_table import decode_record
from .identify import identify
from .record import CHANNELS, Record, parse_record
from .result import Identification, Settings
from .specimen import Specimen

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
    "decode_record",
    "identify",
    "parse_column",
    "parse_record",
]
