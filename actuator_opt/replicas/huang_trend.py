"""Why the two cylinders of [Huang2017] may go opposite ways over pressure: seal by seal.

The load of a face rises with the sealed pressure by its balance k = (df/dp)/b. Oil that falls
evenly across it carries half of p b, so the asperities, which hold the friction at these speeds,
carry more at a higher pressure above k = 1/2 and less below. SI; pressures are gauge.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite, nan

import numpy as np

from ..base.numeric import STEP, Array
from ..evaluation.film import solve
from ..evaluation.rings import Ring
from ..evaluation.seal_contact import seal_contact
from ..models.friction import HUANG_TABLE_2
from ..seals import compact, u_cup
from ..studies.film_walk import FilmMap, Sealing, film_map, ring_friction
from .huang import PRESSURES, TYPICAL, Sealings
from .huang_published import secant_of

ENDS = (0.6e6, 6e6)
"""Pressures whose dampings are compared: those of the printed fall."""
STRESS_PRESSURES = tuple(float(p) for p in np.linspace(0.0, 10e6, 41))
FILM_PRESSURES = (2e6, 6e6, 10e6)
FILM_SPEED = 5e-3
"""Pressures and speed of the film profiles; the paper's figure 18 names none in its text."""


def balance(ring: Ring, pressure: float) -> float:
    """Rise of a ring's load with pressure over its width, (df/dp)/b."""
    found = seal_contact(ring.at(pressure=complex(pressure, STEP)))
    return float(np.imag(found.line_load) / STEP / np.real(found.width))


@dataclass(frozen=True, slots=True)
class Kind:
    """One seal, or several, between the two pressures at the typical speed.

    Parameters
    ----------
    name : what it is
    balance : at the mean of the pressures; NaN for several seals
    damping : at both pressures [N s/m]
    """

    name: str
    balance: float
    damping: tuple[float, float]

    @property
    def rise(self) -> float:
        """Damping at the higher over that at the lower pressure."""
        return self.damping[1] / self.damping[0]


BOTH, DRAINED = "plunger, both seals", "plunger, no pressure between"
_NAMES = {u_cup.TYPE.name: "Yx", compact.TYPE.name: "compact (DAS)"}
"""Names the paper has for seals of these types."""


def kind_name(ring: Ring) -> str:
    """What a ring is called here."""
    return _NAMES.get(ring.element.type, ring.element.seal_type.title)


def single(name: str, sealing: Sealing) -> Kind:
    """A seal alone, the whole pressure across it."""
    (ring,) = sealing.rings
    found = film_map(sealing, ENDS, (TYPICAL,)).damping[:, 0]
    return Kind(name, balance(ring, sum(ENDS) / 2), (float(found[0]), float(found[1])))


def kinds(found: Sealings, mapped: FilmMap) -> tuple[Kind, ...]:
    """Every seal type of both cylinders, the tandem, and the tandem with its room drained."""
    plunger = found.plunger
    every = [single(f"{kind_name(found.piston.rings[0])}, piston", found.piston.alone(0))]
    every += [
        single(f"{kind_name(ring)}, plunger, alone", plunger.alone(k))
        for k, ring in enumerate(plunger.rings)
    ]
    j = mapped.at(ENDS[0], TYPICAL)[1]
    ends = [float(mapped.damping[mapped.at(p, TYPICAL)[0], j]) for p in ENDS]
    if len(plunger.rings) == 2:
        every.append(Kind(BOTH, nan, (ends[0], ends[1])))
        low, high = (drained(found, p) for p in ENDS)
        every.append(Kind(DRAINED, nan, (low, high)))
    low, high = (float(secant_of(row, TYPICAL)) for row in (HUANG_TABLE_2[0], HUANG_TABLE_2[-1]))
    every.append(Kind("plunger, measured (table 2)", nan, (low, high)))
    return tuple(every)


def drained(found: Sealings, pressure: float, speed: float = TYPICAL, **changes: float) -> float:
    """Damping of the plunger with the room between its seals at the outer pressure."""
    first = solve(found.plunger.alone(0).row(pressure, speed, **changes))
    second = solve(found.plunger.alone(1).row(0.0, speed))
    return sum((*ring_friction(first), *ring_friction(second))) / speed


@dataclass(frozen=True, slots=True)
class Relief:
    """A step ring with another relief.

    Parameters
    ----------
    relief, land : [m]; the land is the design's while there is room for it
    balance : at the mean pressure
    pressures, damping : alone at the typical speed (p,) [Pa], [N s/m]; NaN where it lifts off
    """

    relief: float
    land: float
    balance: float
    pressures: Array
    damping: Array

    @property
    def rise(self) -> float:
        """Damping at 6 MPa over that at 0.6 MPa."""
        low, high = (int(np.argmin(np.abs(self.pressures - p))) for p in ENDS)
        return float(self.damping[high] / self.damping[low])


def reshaped(ring: Ring, relief: float) -> dict[str, float]:
    """Relief, and the land that it leaves room for."""
    return {"relief": relief, "land": min(ring["land"], ring["width"] - relief)}


def with_relief(found: Sealings, relief: float, pressures: Sequence[float] = PRESSURES) -> Relief:
    """The plunger's step ring alone with a relief."""
    alone = found.plunger.alone(0)
    ring = alone.rings[0]
    changes = reshaped(ring, relief)
    return Relief(
        relief=relief,
        land=changes["land"],
        balance=balance(ring.at(**changes), sum(ENDS) / 2),
        pressures=np.array(pressures),
        damping=film_map(alone, pressures, (TYPICAL,), **changes).damping[:, 0],
    )


@dataclass(frozen=True, slots=True)
class Turn:
    """The relief at which the damping of a step ring is the same at both pressures.

    Parameters
    ----------
    relief, land, balance : there; NaN where no relief turns it
    share : of the ring's width that the relief takes
    """

    relief: float
    land: float
    balance: float
    share: float


def turn(found: Sealings) -> Turn:
    """From rising to falling between 0.6 and 6 MPa, the step ring alone."""
    ring = found.plunger.rings[0]

    def excess(relief: float) -> float:
        return with_relief(found, relief, ENDS).rise - 1

    # above a relief of nine tenths no land is left to speak of
    relief = _root(excess, 0.05 * ring["width"], 0.9 * ring["width"])
    if not isfinite(relief):
        return Turn(nan, nan, nan, nan)
    there = with_relief(found, relief, ENDS)
    return Turn(relief, there.land, there.balance, relief / ring["width"])


def _root(excess: Callable[[float], float], low: float, high: float) -> float:
    """Where a falling function passes 0, to 1 um; NaN where it does not.

    Where it has no value the ring has lifted off: beyond the root.
    """
    if not excess(low) > 0:
        return nan
    while high - low > 1e-6:
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) > 0 else (low, middle)
    return low if abs(excess(low)) < 0.01 else nan


def tandem_rise(found: Sealings, relief: float) -> float:
    """Damping of the whole plunger at 6 over that at 0.6 MPa with a relief of its step ring."""
    changes = reshaped(found.plunger.rings[0], relief)
    ends = film_map(found.plunger, ENDS, (TYPICAL,), **changes).damping[:, 0]
    return float(ends[1] / ends[0])


def drained_rise(found: Sealings, relief: float) -> float:
    """The same with the room between the seals at the outer pressure."""
    changes = reshaped(found.plunger.rings[0], relief)
    low, high = (drained(found, p, **changes) for p in ENDS)
    return high / low


@dataclass(frozen=True, slots=True)
class Stress:
    """Figure 17: the step ring at rest over the sealed pressure.

    Parameters
    ----------
    pressures : [Pa]
    peak : highest contact pressure over the outer side [Pa]
    excess : of the contact over the oil pressure [Pa]
    width : of the contact [m]
    """

    pressures: Array
    peak: Array
    excess: Array
    width: Array


def stress(found: Sealings) -> Stress:
    """By the closed form of `models.step_seal`."""
    pressures = np.array(STRESS_PRESSURES)
    rows = [seal_contact(found.plunger.rings[0].at(pressure=p)) for p in STRESS_PRESSURES]
    peak, excess, width = (
        np.array([float(getattr(row, name)) for row in rows])
        for name in ("peak", "excess", "width")
    )
    return Stress(pressures, peak, excess, width)


@dataclass(frozen=True, slots=True)
class Profile:
    """Film of the step ring at a pressure, in the tandem, outstroke.

    Parameters
    ----------
    pressure : [Pa]
    x, film : from the sealed side [m]
    mean : [m]
    """

    pressure: float
    x: Array
    film: Array
    mean: float


def profiles(found: Sealings) -> tuple[Profile, ...]:
    """Figure 18; without those that have no film."""
    every = []
    for pressure in FILM_PRESSURES:
        solved = solve(found.plunger.row(pressure, FILM_SPEED))
        if not solved.why:
            film = solved.films[0]
            every.append(Profile(pressure, film.x, film.film, film.mean_film))
    return tuple(every)
