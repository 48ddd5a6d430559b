"""The barrel of a design: its wall, by the tube model that suits it, and its axial force."""

from .choice import LAMINATES, compute, kind
from .wall import SEAL_STEP, Cycle, Swelling, Wall

__all__ = ["LAMINATES", "SEAL_STEP", "Cycle", "Swelling", "Wall", "compute", "kind"]
