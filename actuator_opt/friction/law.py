"""What a friction law states: words, numbers, the dry friction over speed, an oil film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from ..base.numeric import Array, real, where
from ..models import friction
from ..seals.contact import SealContact
from ..seals.seal_type import SealSizes


@dataclass(frozen=True, slots=True)
class Friction:
    """Friction per case, N; `slope` is dF/dv at the case's speed, N·s/m."""

    running: Array = 0.0
    breakaway: Array = 0.0
    slope: Array = 0.0

    def __add__(self, other: Friction) -> Friction:
        return Friction(
            self.running + other.running,
            self.breakaway + other.breakaway,
            self.slope + other.slope,
        )


class Film(Protocol):
    """A running oil film of a ring, over the whole circumference."""

    @property
    def viscous(self) -> Array:
        """Drag of the oil, positive against the motion [N]."""

    @property
    def load(self) -> Array:
        """Normal force between the asperities [N]."""

    @property
    def viscous_slope(self) -> Array:
        """Derivative of the drag by the speed [N s/m]."""

    @property
    def load_slope(self) -> Array:
        """Derivative of the force by the speed [N s/m]."""


@dataclass(frozen=True, kw_only=True)
class FrictionLaw:
    """A friction law; every piece must be given.

    Every seal has the numbers `friction_coefficient`, `breakaway_ratio` and `stribeck_speed` (its
    own, else its compound's) and `viscous_friction`, a part proportional to speed that every law
    but a film adds. `count` seals stand in a row.

    Parameters
    ----------
    name : word in a design file
    help : what the word means
    compound : further numbers of the compound that it reads
    coefficient : Coulomb coefficient of friction at a contact [-]
    breakaway : friction at the begin of a motion, of the Coulomb friction [N]
    level : friction over speed without its viscous part, of Coulomb friction [N] and speed [m/s];
        of the shape that both broadcast to
    slope : its derivative by speed [N s/m], of that shape
    film : friction on a solved oil film, which is None where it was not solved; None: the law needs
        no film. A law with a film states its dry friction too, for records and simulations
    """

    name: str
    help: str
    compound: tuple[str, ...]
    coefficient: Callable[[SealSizes, SealContact], Array]
    breakaway: Callable[[SealSizes, Array], Array]
    level: Callable[[SealSizes, Array, Array], Array]
    slope: Callable[[SealSizes, Array, Array], Array]
    film: Callable[[SealSizes, SealContact, Film | None], Friction] | None

    def friction(
        self, seal: SealSizes, contact: SealContact, load: Array, speed: Array
    ) -> Friction:
        """Dry friction of a row of seals: sliding where the case moves, Coulomb where it does not.

        Parameters
        ----------
        seal, contact : of the seal that holds the pressure
        load : line load of the whole row [N/m]
        speed : [m/s]
        """
        coulomb = friction.seal_friction(
            line_load=load,
            diameter=seal["diameter"],
            friction_coefficient=self.coefficient(seal, contact),
        )
        viscous = seal["viscous_friction"]
        sliding = self.level(seal, coulomb, speed) + viscous * speed
        return Friction(
            running=where(real(speed) > 0, sliding, coulomb),
            breakaway=self.breakaway(seal, coulomb),
            slope=self.slope(seal, coulomb, speed) + viscous,
        )
