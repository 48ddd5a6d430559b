"""Identification: friction, damping and modulus from the records of a test bench."""

from .identify import identify
from .record import CHANNELS, Record, parse_record
from .result import Identification, Settings

__all__ = ["CHANNELS", "Identification", "Record", "Settings", "identify", "parse_record"]
