"""Time-domain simulation: a scenario around a design, its equations, integration and results."""

from .result import Simulation
from .run import simulate

__all__ = ["Simulation", "simulate"]
