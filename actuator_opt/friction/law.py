"""Interface of a friction law: names, properties, dry friction as a function of speed, oil film."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ..base.dataclass import dataclass
from ..base.numeric import Array, real, where
from ..models import friction
from ..seals.contact import SealContact
from ..seals.seal_type import SealSizes


@dataclass(frozen=True, slots=True)
class Friction:
    """Running and breakaway friction in every load case [N].

    `slope` is the derivative of the running friction by speed, at the load case's speed [N·s/m].
    """

    running: Array = 0.0
    breakaway: Array = 0.0
    slope: Array = 0.0

    def __add__(self, other: Friction) -> Friction:
        return Friction(
            self.running + other.running,
            self.breakaway + other.breakaway,
            self.slope + other.slope,
        )


class MovingFilm(Protocol):
    """Oil film of a ring in motion, over the whole circumference."""

    @property
    def viscous(self) -> Array:
        """Viscous drag, positive against the motion [N]."""

    @property
    def load(self) -> Array:
        """Normal force between the asperities [N]."""

    @property
    def viscous_slope(self) -> Array:
        """Derivative of the drag by speed [N s/m]."""

    @property
    def load_slope(self) -> Array:
        """Derivative of the normal force by speed [N s/m]."""


@dataclass(frozen=True, kw_only=True)
class FrictionLaw:
    """A friction law; every field must be stated.

    The functions of a law can read these sizes of a seal: `friction_coefficient`, `breakaway_ratio`
    and `stribeck_speed`, which are stated in the design or else taken from the compound, and
    `count`, the number of seals in series. `viscous_friction` times the speed is added to the
    friction of every law except a film law.

    Parameters
    ----------
    name : name in a design file
    help : one-line description of the law for help texts
    compound : further properties of the seal's compound that the law uses
    coefficient : function for the Coulomb friction coefficient of a contact [-]
    breakaway : function for the breakaway friction [N], given the Coulomb friction [N]
    level : function for the friction without its viscous part [N], given Coulomb friction [N] and
        speed [m/s], which broadcast
    slope : function for the derivative of `level` with respect to speed [N s/m], of the same shape
    film : function for the friction on an oil film; its argument `film` is None if the film was not
        solved. None for a law without film. A law with film must also state dry friction, which
        test records and simulations use
    model : main model behind the law, whose docstring states source and valid range
    """

    name: str
    help: str
    compound: tuple[str, ...]
    coefficient: Callable[[SealSizes, SealContact], Array]
    breakaway: Callable[[SealSizes, Array], Array]
    level: Callable[[SealSizes, Array, Array], Array]
    slope: Callable[[SealSizes, Array, Array], Array]
    film: Callable[[SealSizes, SealContact, MovingFilm | None], Friction] | None
    model: Callable[..., object]

    def friction(
        self, seal: SealSizes, contact: SealContact, load: Array, speed: Array
    ) -> Friction:
        """Dry friction of seals in series; at rest, the running friction is the Coulomb friction.

        Parameters
        ----------
        seal, contact : the pressure-loaded seal and its contact
        load : line load of all seals of the series together [N/m]
        speed : sliding speed of each load case [m/s]
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
