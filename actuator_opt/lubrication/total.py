"""Viscous damping of an actuator as a sum that keeps its parts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..models.damping import secant


@dataclass(frozen=True, slots=True)
class Damping:
    """Secant damping at one speed, part by part."""

    speed: float  # [m/s]
    parts: dict[str, float]  # [N s/m]

    @property
    def total(self) -> float:
        """Sum of the parts [N s/m]."""
        return sum(self.parts.values())


def damping(*, forces: Mapping[str, float], speed: float) -> Damping:
    """Secant damping B = (seals + back-up rings + chamber)/U ([Huang2017] eq. 26).

    The drag of a seal is pi d times `film.drag`, that of a ring pi d times the drag of its gap or
    `models.damping.flat_gap` times the speed, that of the chamber `flat_gap` times the speed.

    Parameters
    ----------
    forces : on the rod by the name of the part, with the sign of the speed [N]
    speed : of the rod [m/s]

    Returns
    -------
    damping with each part

    Raises
    ------
    ValueError
        Speed 0, where a secant has no value.
    """
    if speed == 0:
        raise ValueError("secant damping at speed 0: give the speed of a moving rod")
    parts = {name: float(secant(friction=force, speed=speed)) for name, force in forces.items()}
    return Damping(speed=speed, parts=parts)
