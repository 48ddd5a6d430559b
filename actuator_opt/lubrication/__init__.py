"""Elastohydrodynamic lubrication of reciprocating seals: films, tandem seals, back-up rings.

NumPy only. Pressures are absolute; forces are per circumference unless a name says otherwise.
"""

from .film import Film, drag, solve_film
from .inputs import Contact, Elastic, Lubricant, Surface
from .slopes import sensitivities, sensitivity
from .smooth import Gap, SmoothFilm, solve_gap
from .tandem import SealElement, Tandem, solve_tandem
from .total import Damping, damping

__all__ = [
    "Contact",
    "Damping",
    "Elastic",
    "Film",
    "Gap",
    "Lubricant",
    "SealElement",
    "SmoothFilm",
    "Surface",
    "Tandem",
    "damping",
    "drag",
    "sensitivities",
    "sensitivity",
    "solve_film",
    "solve_gap",
    "solve_tandem",
]
