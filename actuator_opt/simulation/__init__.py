"""Time domain: a scenario around a design, its equations, their integration and what it tells."""

from .result import Simulation
from .run import simulate

__all__ = ["Simulation", "simulate"]
