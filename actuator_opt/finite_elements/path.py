"""Load path from the free to the mounted and pressurised seal; a failure returns its reason."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ..base.errors import ActuatorError, Diagnostic
from .equilibrium import ElementProblem, ElementState, NotConverged, raise_pressure
from .material import MooneyRivlin
from .result import Contact, SealSolution

SQUEEZE_STEP = 0.04
"""Squeeze per load step."""
MOST_SQUEEZE = 0.4
"""Largest squeeze: beyond it, elements at the contact edge invert."""


def check_inputs(
    section: float,
    squeeze: float,
    rubber: MooneyRivlin,
    pressures: Sequence[float],
    elements_around: int,
    *more: tuple[bool, str, str],
) -> None:
    """Check all inputs; a one-line error for an invalid input.

    Parameters
    ----------
    section, squeeze, rubber, pressures, elements_around : as for the seals
    more : further checks: condition of the fault, message, remedy
    """
    rising = all(b > a for a, b in zip((0.0, *pressures), pressures, strict=False))
    checks = (
        (not section > 0, f"section {section:g} m is not positive", "give the free section"),
        (
            not 0 < squeeze <= MOST_SQUEEZE,
            f"squeeze {squeeze:g} is outside 0 to {MOST_SQUEEZE:g}",
            "change groove depth or section",
        ),
        (
            not (rubber.c10 >= 0 and rubber.c01 >= 0 and rubber.c10 + rubber.c01 > 0),
            "the constants of Mooney and Rivlin are not positive",
            "give a modulus",
        ),
        (not rising, "sealed pressures must be positive and increasing", "sort them"),
        (
            elements_around < 16 or elements_around % 4 != 0,
            f"{elements_around} elements around the section",
            "give a multiple of 4, at least 16",
        ),
        *more,
    )
    found = [Diagnostic(message, remedy) for wrong, message, remedy in checks if wrong]
    if found:
        raise ActuatorError(found)


class Seal(Protocol):
    """A seal that can be mounted, moved to the outer groove wall, and evaluated."""

    problem: ElementProblem

    def mount(self, squeeze: float, groove_width: float) -> ElementState:
        """Equilibrium in the groove without pressure."""

    def release(self, state: ElementState) -> ElementState:
        """The seal against the outer side wall, without other constraints."""

    def contact(
        self, state: ElementState, pressure: float, length: float, modulus: float
    ) -> Contact:
        """Contact on the sliding face, with dimensions."""


def follow(
    seal: Seal,
    squeeze: float,
    groove_width: float,
    pressures: Sequence[float],
    length: float,
    modulus: float,
) -> SealSolution:
    """Mount a seal and raise its pressure.

    Parameters
    ----------
    seal : seal in units of length and modulus
    squeeze : squeeze over the section of the rubber ring [-]
    groove_width : width of the groove in units of length
    pressures : increasing pressures [Pa]
    length, modulus : the units [m], [Pa]
    """
    contacts: list[Contact] = []
    failure, reached = None, 0.0
    try:
        state = seal.mount(squeeze, groove_width)
        contacts.append(seal.contact(state, 0.0, length, modulus))
        state = seal.release(state)
        for pressure in pressures:
            state = raise_pressure(seal.problem, state, reached, pressure / modulus)
            reached = pressure / modulus
            contacts.append(seal.contact(state, reached, length, modulus))
    except NotConverged as reason:
        failure = str(reason)
    problem = seal.problem
    return SealSolution(
        tuple(contacts), failure, problem.steps, problem.iterations, problem.worst_residual
    )
