"""The ply failure criteria by name, with a common interface.

A criterion takes the stress of the load, in material axes, and the residual stress that does not
grow with it (cure, cool-down, what yielding has frozen), and gives the utilisation 1/SR of every
mode by name. The strength ratio SR is the factor of the load at which the total stress
residual + SR stress first meets that mode's surface: exact, in closed form. A utilisation is

- never negative, at most 1 where the ply holds the present load, 0 where the mode never fails it;
- proportional to the load when there is no residual stress, and finite at zero stress;
- infinite (SR = 0) where the residual stress alone fails the ply.

The largest utilisation of the modes is the ply's; `load_multiplier` turns one into SR. Branches
go by real parts, so a complex step follows the branch of its point.

The criteria are models of the same few strengths and differ by 20-25 % on one and the same tube:
a first-ply figure means little without the criterion's name. Tsai-Wu takes F_12* = -0.5 unless
told otherwise; Hashin and Puck are in plane stress and pass over sigma_3, maximum strain takes it
through Poisson's ratios and does not test the radial strain; only maximum stress and Tsai-Wu
limit it. A constant of one criterion (F_12*, Hashin's shear share, Puck's inclinations) is a
keyword of its function: bind it with `functools.partial` for another value.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ..base.kinds import kinds
from ..base.numeric import Array
from .strength import tsai_wu_modes
from .strength_interfibre import hashin_modes, puck_modes
from .strength_modes import PlyRatios, PlyStrength, Stress, max_strain_modes, max_stress_modes


class Modes(Protocol):
    """What every failure criterion is: a function from stresses to utilisations by mode."""

    def __call__(
        self,
        *,
        stress: Stress,
        strength: PlyStrength,
        residual: Stress | None = None,
        elastic: PlyRatios | None = None,
    ) -> dict[str, Array]:
        """Utilisation 1/SR of every mode; `elastic` where `Criterion.by_strain`."""
        ...


@dataclass(frozen=True, slots=True)
class Criterion:
    """A failure criterion of plies.

    Attributes
    ----------
    name, help : its word in a design, and what it means
    words : its name in a report
    modes : utilisation of every mode [-]
    by_strain : whether it needs the ratios of the ply's elastic constants
    """

    name: str
    help: str
    words: str
    modes: Modes
    by_strain: bool


CRITERIA = kinds(
    "criterion",
    Criterion(
        "max_stress",
        "one stress reaches its strength",
        "maximum stress",
        max_stress_modes,
        by_strain=False,
    ),
    Criterion(
        "max_strain",
        "one strain reaches its limit",
        "maximum strain",
        max_strain_modes,
        by_strain=True,
    ),
    Criterion(
        "tsai_wu",
        "all stresses together, in one formula",
        "Tsai-Wu",
        tsai_wu_modes,
        by_strain=False,
    ),
    Criterion(
        "hashin",
        "fibre or matrix, each by its own formula",
        "Hashin",
        hashin_modes,
        by_strain=False,
    ),
    Criterion(
        "puck",
        "fibre, or matrix pulled open (mode A), sheared (B) or crushed at a slant (C)",
        "Puck",
        puck_modes,
        by_strain=False,
    ),
)
"""The criteria a design may name."""
