"""Elastohydrodynamic lubrication of reciprocating seals: oil films, tandem seals, back-up rings.

This package needs NumPy only. Pressures are absolute. Forces are per unit length of circumference
unless stated otherwise.
"""

from .film import Film, sensitivities, solve_film
from .reynolds import Contact, Elastic, Lubricant, Surface
from .smooth import Gap, SmoothFilm, solve_gap
from .tandem import Tandem, TandemSeal, solve_tandem

__all__ = [
    "Contact",
    "Elastic",
    "Film",
    "Gap",
    "Lubricant",
    "SmoothFilm",
    "Surface",
    "Tandem",
    "TandemSeal",
    "sensitivities",
    "solve_film",
    "solve_gap",
    "solve_tandem",
]
