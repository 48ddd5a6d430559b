"""From the free seal to the mounted one and up in pressure; a failure is an outcome in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ..base.errors import ActuatorError, Diagnostic
from .equilibrium import ElementProblem, ElementState, NotConverged, raise_pressure
from .material import MooneyRivlin
from .result import Contact, SealSolution

SQUEEZE_STEP = 0.04
"""Squeeze of one load step."""
MOST_SQUEEZE = 0.4
"""Elements at the edge of the contact are turned inside out beyond."""


def check_inputs(
    section: float,
    squeeze: float,
    rubber: MooneyRivlin,
    pressures: Sequence[float],
    elements_around: int,
    *more: tuple[bool, str, str],
) -> None:
    """One clear line for every input that cannot be used.

    Parameters
    ----------
    section, squeeze, rubber, pressures, elements_around : as of the seals
    more : further checks: whether it is wrong, what is, what to do
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
        (not rising, "sealed pressures must be positive and rise", "sort them"),
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
    """A seal that can be mounted, released against the groove's outer wall, and looked at."""

    problem: ElementProblem

    def mount(self, squeeze: float, groove_width: float) -> ElementState:
        """Equilibrium in the groove without pressure."""

    def release(self, state: ElementState) -> ElementState:
        """The seal against the outer side wall, held by nothing else."""

    def contact(
        self, state: ElementState, pressure: float, length: float, modulus: float
    ) -> Contact:
        """The contact on the sliding face with its dimensions."""


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
    seal : in units of length and modulus
    squeeze : of the rubber's section [-]
    groove_width : in units of length
    pressures : rising [Pa]
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
