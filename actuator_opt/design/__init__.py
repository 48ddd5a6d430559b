"""Read design files into a `Design` in SI, and record where in the file each value is written."""

from __future__ import annotations

from .build import to_tree, with_values
from .changes import pairs
from .kinds import Fraction, position_at
from .model import Design
from .paths import canonical, get, numbers, quantity_of, split_assignment
from .reader import FileSource, LoadedDesign, is_scenario, read_design

__all__ = [
    "Change",
    "Design",
    "FileSource",
    "Fraction",
    "LoadedDesign",
    "SetValues",
    "canonical",
    "get",
    "is_scenario",
    "numbers",
    "pairs",
    "position_at",
    "quantity_of",
    "read_design",
    "split_assignment",
    "to_tree",
    "with_values",
]
