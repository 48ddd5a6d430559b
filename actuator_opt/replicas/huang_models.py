"""The seals of [Huang2017] on their oil films over speed and pressure: piston cylinder and plunger.

Test A is the design itself. Test B, the plunger, has the tandem of the design's rod seals on the
plunger's diameter: the standard housings of both diameters are equal. All values are in SI;
pressures are gauge unless called absolute.

The damping of the two cylinders may change oppositely with pressure. The load f per length of a
face rises with the sealed pressure p by its balance k = (df/dp)/b, where b is the contact width.
Oil pressure that falls evenly across the face carries half of p b. At these speeds, asperities
cause the friction. At higher pressure they carry more load if k > 1/2, and less if k < 1/2.

Equation 26: of the back-up ring the paper states only the material, PTFE with copper; the values
used here are assumed; the constants below state them.

Eq. 14 and 15 lack the rigid shift of the seal, though the balance of loads in eq. 12 requires a
shift. The text below eq. 4 calls "a" the seal and gives it the rod's speed. `readings` computes the
effect of both as printed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import isfinite, nan, pi
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import STEP, Array
from ..design.material import fit_double_exponential, fit_power_law
from ..design.model import Design
from ..evaluation.build import prepare
from ..evaluation.film import FilmRow, solve
from ..evaluation.kernel import base
from ..evaluation.rings import Ring, seal_contact
from ..friction import film
from ..lubrication import Elastic, Gap, Lubricant, SmoothFilm, solve_gap
from ..models.damping import flat_gap, secant
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..models.friction import HUANG_TABLE_2
from ..models.rough_surface import asperity_pressure
from ..seals import compact, u_cup
from ..studies.film_walk import FilmMap, Sealing, film_map, ring_friction, sealing
from . import huang_published
from .huang_published import PAPER, CurveFits, plausible_chamber, secant_of

CASE = 0
"""Index of the design's load case from which oil and return pressure are taken."""

SPEEDS = (0.5e-3, 0.8e-3, 1.3e-3, 2.1e-3, 3.3e-3, 5e-3, 7e-3, 10e-3)
"""Speeds of the maps: the tested range, and 2.1 mm/s, at which the printed fall of damping
holds."""

FAST = (10e-3, 20e-3, 40e-3, 80e-3, 0.16, 0.32)
"""Speeds above the tested range, at which the oil film begins to carry the seals."""

TYPICAL = 2.1e-3
"""Speed at which dampings at different pressures are compared."""

PRESSURES = (0.6e6, 2e6, 4e6, 6e6, 8e6, 10e6)
"""Pressures of the plunger's map: pressures of table 2 and of figure 16."""

PISTON_PRESSURES = (1e6, 2e6, 4e6, 6e6, 7.15e6, 8e6, 10e6)
"""Pressures of the driven chamber of the piston cylinder; 7.15 MPa is the paper's."""


@dataclass(frozen=True, slots=True)
class Sealings:
    """The sealings of both tests.

    Parameters
    ----------
    piston : between driven chamber and return
    rod : of test A, at return pressure
    plunger : the rod's rings on the plunger
    return_pressure : [Pa]
    lubricant : the oil
    """

    piston: Sealing
    rod: Sealing
    plunger: Sealing
    return_pressure: float
    lubricant: Lubricant


def sealings(design: Design) -> Sealings:
    """The rings of both tests on oil films, whatever friction model the design states."""
    subject = prepare(_on_films(design))
    v = subject.values()
    state = base(subject, v)
    drain = float(v["supply.return_pressure"])
    rod = sealing(state, "rod", CASE)
    plunger = tuple(ring.at(diameter=PAPER.plunger) for ring in rod.rings)
    first = rod.rings[0]
    return Sealings(
        piston=sealing(state, "piston", CASE),
        rod=rod,
        plunger=replace(rod, rings=plunger),
        return_pressure=drain,
        lubricant=Lubricant(
            dynamic_viscosity=first["viscosity"],
            pressure_law=first.viscosity_law,
            pressure_coefficient=first["viscosity_coefficient"],
        ),
    )


def _on_films(design: Design) -> Design:
    """The design with a film under every sealing element."""
    filmed: dict[str, Any] = {"friction": film.LAW.name}
    seals = {}
    for place in ("piston", "rod"):
        seal = getattr(design.seals, place)
        second = seal.secondary and seal.secondary.model_copy(update=filmed)
        seals[place] = seal.model_copy(update=filmed | {"secondary": second})
    return design.model_copy(update={"seals": design.seals.model_copy(update=seals)})


@dataclass(frozen=True, slots=True)
class CylinderMap:
    """Damping of the piston cylinder, as an array over driven-chamber pressure and speed.

    Parameters
    ----------
    piston : over the pressure difference across it
    rod : at return pressure
    pressures : of the driven chamber (p,) [Pa]
    """

    piston: FilmMap
    rod: FilmMap
    pressures: Array

    @property
    def damping(self) -> Array:
        """Damping of both seals (p, v) [N s/m]."""
        return self.piston.damping + self.rod.damping


def cylinder_map(seals: Sealings, speeds: Sequence[float] = SPEEDS) -> CylinderMap:
    """Figure 3: piston and rod seals on the outstroke."""
    across = [p - seals.return_pressure for p in PISTON_PRESSURES]
    return CylinderMap(
        piston=film_map(seals.piston, across, speeds),
        rod=film_map(seals.rod, [seals.return_pressure], speeds),
        pressures=np.array(PISTON_PRESSURES),
    )


def fast_map(seals: Sealings) -> FilmMap:
    """Map of the plunger at 6 MPa, for speeds above the tested range."""
    return film_map(seals.plunger, [PAPER.compared], FAST)


def plunger_map(seals: Sealings, speeds: Sequence[float] = SPEEDS) -> FilmMap:
    """Figures 6 to 8, 15 and 16: the tandem of the plunger on the outstroke."""
    return film_map(seals.plunger, PRESSURES, speeds)


ENDS = (0.6e6, 6e6)
"""Pressures between which dampings are compared: those of the fall that the paper prints."""

STRESS_PRESSURES = tuple(float(p) for p in np.linspace(0.0, 10e6, 41))

FILM_PRESSURES = (2e6, 6e6, 10e6)

FILM_SPEED = 5e-3
"""Speed of the film profiles; the text of the paper's figure 18 states no speed and no
pressures."""


def balance(ring: Ring, pressure: float) -> float:
    """Pressure balance (df/dp)/b of a ring: load per length f, pressure p, contact width b."""
    contact = seal_contact(ring.at(pressure=complex(pressure, STEP)))
    return float(np.imag(contact.line_load) / STEP / np.real(contact.width))


@dataclass(frozen=True, slots=True)
class SealArrangement:
    """One or several seals, compared at two pressures and the typical speed.

    Parameters
    ----------
    name : name in the tables
    balance : at the mean of the pressures; NaN for several seals
    damping : at both pressures [N s/m]
    """

    name: str
    balance: float
    damping: tuple[float, float]

    @property
    def rise(self) -> float:
        """Ratio of the damping at the higher pressure to that at the lower."""
        return self.damping[1] / self.damping[0]


BOTH, DRAINED = "plunger, both seals", "plunger, no pressure between seals"

_NAMES = {u_cup.TYPE.name: "Yx", compact.TYPE.name: "compact (DAS)"}
"""Names that the paper uses for these types of seal."""


def kind_name(ring: Ring) -> str:
    """Name of a ring in the tables."""
    return _NAMES.get(ring.element.type, ring.element.seal_type.title)


def single(name: str, sealing: Sealing) -> SealArrangement:
    """A single seal with the full pressure difference across it."""
    (ring,) = sealing.rings
    damping = film_map(sealing, ENDS, (TYPICAL,)).damping[:, 0]
    return SealArrangement(
        name, balance(ring, sum(ENDS) / 2), (float(damping[0]), float(damping[1]))
    )


def kinds(seals: Sealings, mapped: FilmMap) -> tuple[SealArrangement, ...]:
    """Every seal type of both cylinders, the tandem, and the tandem drained between its seals."""
    plunger = seals.plunger
    arrangements = [single(f"{kind_name(seals.piston.rings[0])}, piston", seals.piston.alone(0))]
    arrangements += [
        single(f"{kind_name(ring)}, plunger, alone", plunger.alone(k))
        for k, ring in enumerate(plunger.rings)
    ]
    j = mapped.at(ENDS[0], TYPICAL)[1]
    ends = [float(mapped.damping[mapped.at(p, TYPICAL)[0], j]) for p in ENDS]
    if len(plunger.rings) == 2:
        arrangements.append(SealArrangement(BOTH, nan, (ends[0], ends[1])))
        low, high = (drained(seals, p) for p in ENDS)
        arrangements.append(SealArrangement(DRAINED, nan, (low, high)))
    low, high = (float(secant_of(row, TYPICAL)) for row in (HUANG_TABLE_2[0], HUANG_TABLE_2[-1]))
    arrangements.append(SealArrangement("plunger, measured (table 2)", nan, (low, high)))
    return tuple(arrangements)


def drained(seals: Sealings, pressure: float, speed: float = TYPICAL, **changes: float) -> float:
    """Damping of the plunger if the space between its seals is drained to the outer pressure."""
    first = solve(seals.plunger.alone(0).row(pressure, speed, **changes))
    second = solve(seals.plunger.alone(1).row(0.0, speed))
    return sum((*ring_friction(first), *ring_friction(second))) / speed


@dataclass(frozen=True, slots=True)
class ReliefVariant:
    """A step ring with a different relief (recess of its face).

    Parameters
    ----------
    relief, land : [m]; the land is that of the design, or shorter if the relief takes its space
    balance : at the mean pressure
    pressures, damping : of the ring alone at the typical speed (p,) [Pa], [N s/m]; NaN where the
        ring lifts off
    """

    relief: float
    land: float
    balance: float
    pressures: Array
    damping: Array

    @property
    def rise(self) -> float:
        """Ratio of the damping at 6 MPa to that at 0.6 MPa."""
        low, high = (int(np.argmin(np.abs(self.pressures - p))) for p in ENDS)
        return float(self.damping[high] / self.damping[low])


def reshaped(ring: Ring, relief: float) -> dict[str, float]:
    """Sizes of a ring with a given relief: relief, and the land that still fits."""
    return {"relief": relief, "land": min(ring["land"], ring["width"] - relief)}


def with_relief(
    seals: Sealings, relief: float, pressures: Sequence[float] = PRESSURES
) -> ReliefVariant:
    """The plunger's step ring as the only seal, with a given relief."""
    alone = seals.plunger.alone(0)
    ring = alone.rings[0]
    changes = reshaped(ring, relief)
    return ReliefVariant(
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
    relief, land, balance : at this point; NaN if no relief reverses the trend
    share : of the ring's width that the relief takes
    """

    relief: float
    land: float
    balance: float
    share: float


def turn(seals: Sealings) -> Turn:
    """Relief above which the damping of the step ring alone falls from 0.6 to 6 MPa."""
    ring = seals.plunger.rings[0]

    def excess(relief: float) -> float:
        return with_relief(seals, relief, ENDS).rise - 1

    # above a relief of nine tenths of the width, almost no land remains
    relief = _root(excess, 0.05 * ring["width"], 0.9 * ring["width"])
    if not isfinite(relief):
        return Turn(nan, nan, nan, nan)
    there = with_relief(seals, relief, ENDS)
    return Turn(relief, there.land, there.balance, relief / ring["width"])


def _root(excess: Callable[[float], float], low: float, high: float) -> float:
    """Zero of a falling function, to 1 um; NaN without a zero.

    A missing value means that the ring has lifted off; such a point lies beyond the zero.
    """
    if not excess(low) > 0:
        return nan
    while high - low > 1e-6:
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) > 0 else (low, middle)
    return low if abs(excess(low)) < 0.01 else nan


def tandem_rise(seals: Sealings, relief: float) -> float:
    """Ratio of the whole plunger's damping at 6 MPa to that at 0.6 MPa, for a given relief."""
    changes = reshaped(seals.plunger.rings[0], relief)
    ends = film_map(seals.plunger, ENDS, (TYPICAL,), **changes).damping[:, 0]
    return float(ends[1] / ends[0])


def drained_rise(seals: Sealings, relief: float) -> float:
    """Ratio as in `tandem_rise`, with the space between the seals drained to outer pressure."""
    changes = reshaped(seals.plunger.rings[0], relief)
    low, high = (drained(seals, p, **changes) for p in ENDS)
    return high / low


@dataclass(frozen=True, slots=True)
class Stress:
    """Figure 17: the step ring at rest over the sealed pressure.

    Parameters
    ----------
    pressures : [Pa]
    peak : highest contact pressure, relative to the pressure of the outer side [Pa]
    excess : highest contact pressure minus the oil pressure [Pa]
    width : of the contact [m]
    """

    pressures: Array
    peak: Array
    excess: Array
    width: Array


def stress(seals: Sealings) -> Stress:
    """Contact of the step ring by the closed form of `models.step_seal`."""
    pressures = np.array(STRESS_PRESSURES)
    rows = [seal_contact(seals.plunger.rings[0].at(pressure=p)) for p in STRESS_PRESSURES]
    peak, excess, width = (
        np.array([float(getattr(row, name)) for row in rows])
        for name in ("peak", "excess", "width")
    )
    return Stress(pressures, peak, excess, width)


@dataclass(frozen=True, slots=True)
class StepRingFilm:
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


def profiles(seals: Sealings) -> tuple[StepRingFilm, ...]:
    """Figure 18: film profiles at the pressures at which a film exists."""
    films = []
    for pressure in FILM_PRESSURES:
        solved = solve(seals.plunger.row(pressure, FILM_SPEED))
        if not solved.why:
            film = solved.films[0]
            films.append(StepRingFilm(pressure, film.x, film.film, film.mean_film))
    return tuple(films)


CONTACT_PRESSURE = 0.1e6
"""Mean pressure of the back-up ring on the plunger: the "low contact stress" of section 3 (Pa)."""

CONTACT_PRESSURES = (0.02e6, 0.2e6)
"""Least and largest contact pressure tried besides `CONTACT_PRESSURE`."""

WIDTH = 15e-3
"""Width of the ring: the ISO 10766 housing of the standards the paper names, GB/T 15242 (m)."""

EDGE = 5e-6
"""Height by which the ring's worn-in edges are rounded (m): assumed."""

EDGE_POWER = 8
"""The face recedes with this power of the distance from its middle: it is flat except at the
edges."""

NODES = 241

RING_SPEEDS = (0.5e-3, 0.7e-3, 1e-3, 1.5e-3, 2e-3, 3e-3)
"""Speeds of figure 20: its three speeds, and some between them."""


@dataclass(frozen=True, slots=True)
class BackupRingFilm:
    """The oil film of the back-up ring, with smooth surfaces, at a speed.

    Parameters
    ----------
    speed : [m/s]
    film : the solved film, or the reason why it could not be solved
    drag : on the plunger [N]
    """

    speed: float
    film: SmoothFilm
    drag: float

    @property
    def damping(self) -> float:
        """Secant damping [N s/m]."""
        return self.drag / self.speed


def back_up_ring(
    lubricant: Lubricant,
    elastic: Elastic,
    speed: float,
    contact_pressure: float = CONTACT_PRESSURE,
) -> BackupRingFilm:
    """Film of the back-up ring by equations 19 to 22.

    The ring has the same pressure on both sides, which does not deform it. Atmospheric pressure is
    assumed; a higher pressure would only prevent cavitation of the film.
    """
    place = np.linspace(-1.0, 1.0, NODES)
    around = ATMOSPHERIC_PRESSURE
    gap = Gap(
        width=WIDTH,
        profile=EDGE * np.abs(place) ** EDGE_POWER,
        lubricant=lubricant,
        speed=speed,
        sealed_pressure=around,
        outer_pressure=around,
        line_load=(around + contact_pressure) * WIDTH,
        elastic=elastic,
    )
    film = solve_gap(gap)
    return BackupRingFilm(speed, film, pi * PAPER.plunger * film.viscous_drag)


def ring_elastic(seals: Sealings) -> Elastic:
    """Elasticity of the PTFE of the design's first rod seal; the ring has the same material."""
    first = seals.plunger.rings[0]
    return Elastic(first["face_modulus"], first["face_poissons_ratio"])


def ring_films(seals: Sealings) -> tuple[BackupRingFilm, ...]:
    """Figures 19 and 20: films of the back-up ring at several speeds."""
    elastic = ring_elastic(seals)
    return tuple(back_up_ring(seals.lubricant, elastic, v) for v in RING_SPEEDS)


@dataclass(frozen=True, slots=True)
class Total:
    """Equation 26 of the plunger at a pressure and speed.

    Parameters
    ----------
    pressure, speed : [Pa], [m/s]
    parts : secant damping of every part by its name [N s/m]
    ring_range : damping of the back-up ring at the least and largest contact pressure [N s/m]
    """

    pressure: float
    speed: float
    parts: dict[str, float]
    ring_range: tuple[float, float]

    @property
    def damping(self) -> float:
        """Damping B = (seals + back-up rings + chamber)/U [N s/m]: sum of drag forces / speed U."""
        return sum(self.parts.values())

    @property
    def seals(self) -> float:
        """Damping of the seals alone [N s/m]."""
        return sum(value for name, value in self.parts.items() if name not in (BACK_UP, CHAMBER))

    def share(self, name: str) -> float:
        """Share of a part in the total."""
        return self.parts[name] / self.damping

    @property
    def beside_share(self) -> float:
        """Largest damping of back-up ring plus chamber, as a share of that of the seals."""
        return (max(self.ring_range) + self.parts[CHAMBER]) / self.seals


BACK_UP, CHAMBER = "back-up ring", "chamber"


def total(seals: Sealings, mapped: FilmMap, pressure: float, speed: float) -> Total:
    """Equation 26 at a point of the plunger's map."""
    i, j = mapped.at(pressure, speed)
    labels = [ring.label.replace("rod ", "") for ring in seals.plunger.rings]
    elastic = ring_elastic(seals)
    ring = back_up_ring(seals.lubricant, elastic, speed)
    ends = [back_up_ring(seals.lubricant, elastic, speed, q).damping for q in CONTACT_PRESSURES]
    forces = dict(zip(labels, map(float, mapped.parts[i, j]), strict=True))
    forces |= {BACK_UP: ring.drag, CHAMBER: chamber_drag(speed)}
    parts = {name: float(secant(friction=force, speed=speed)) for name, force in forces.items()}
    return Total(pressure, speed, parts, (ends[0], ends[1]))


def dry_ring(seals: Sealings) -> float:
    """Friction of the back-up ring without oil, by the dry friction coefficient of PTFE [N]."""
    coefficient = seals.plunger.rings[0]["asperity_friction"]
    return float(pi * PAPER.plunger * WIDTH * CONTACT_PRESSURE * coefficient)


def chamber_drag(speed: float) -> float:
    """Drag of the oil in the chamber by equations 24 and 25 (`plausible_chamber`)."""
    member = plausible_chamber()
    coefficient = flat_gap(
        dynamic_viscosity=member.viscosity,
        diameter=PAPER.plunger,
        length=member.length,
        gap=member.gap,
    )
    return float(coefficient) * speed


PRESSURE = 6e6
"""Sealed pressure of `readings` (Pa); the speed is that of the film profiles."""


@dataclass(frozen=True, slots=True)
class Readings:
    """Effects of errors in print on the plunger's step ring; NaN without a film.

    Parameters
    ----------
    shift : rigid shift of the solved film [m]
    mean : its mean film [m]
    excess : relative excess of the load capacity over the given load, if leaving out the shift made
        the film thinner
    flow, swapped : oil dragged outwards if the seal is the rough side, or if the rod is [m^3/s]
    """

    shift: float
    mean: float
    excess: float
    flow: float
    swapped: float


def readings(seals: Sealings) -> Readings:
    """Effect of the missing shift and of the swapped surfaces on the plunger's first seal."""
    row = seals.plunger.alone(0).row(PRESSURE, FILM_SPEED)
    solved, other = solve(row), solve(_swapped(row))
    if solved.why or other.why:
        return Readings(nan, nan, nan, nan, nan)
    film = solved.films[0]
    contact, around = film.contact, pi * row.rings[0]["diameter"]
    surface, elastic = contact.surface, contact.elastic
    thinner = (film.film - film.rigid_shift) / surface.roughness
    carried = film.pressure + asperity_pressure(
        film_ratio=np.maximum(thinner, 0.0),
        youngs_modulus=elastic.youngs_modulus,
        poissons_ratio=elastic.poissons_ratio,
        asperity_density=surface.asperity_density,
        asperity_radius=surface.asperity_radius,
        roughness=surface.roughness,
    )
    loads = [
        float(np.trapezoid(pressure, film.x)) for pressure in (carried, contact.static_pressure)
    ]
    return Readings(
        shift=film.rigid_shift,
        mean=film.mean_film,
        excess=loads[0] / loads[1] - 1,
        flow=around * film.flow,
        swapped=around * other.films[0].flow,
    )


def _swapped(row: FilmRow) -> FilmRow:
    """The same film with the rough surface on the rod; the composite roughness is unchanged."""
    rings = [
        ring.at(
            seal_roughness=ring["counterface_roughness"],
            counterface_roughness=ring["seal_roughness"],
        )
        for ring in row.rings
    ]
    return replace(row, rings=tuple(rings))


RELIEFS = (3e-3, 3.7e-3)
"""Reliefs (m) drawn besides the design's relief, the relief of `Turn` and `BEYOND`."""

BEYOND = (1.08, 1.16)
"""Longer reliefs that are drawn, as multiples of the relief at which the trend reverses."""

TOTALS = tuple((p, v) for p in ENDS for v in (0.5e-3, 10e-3))
"""Pressures and speeds at which every part of eq. 26 is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class HuangStudy:
    """Both tests on films, and the curves of the paper.

    Parameters
    ----------
    sealings : rings, oil
    cylinder, plunger, fast : maps of test A, of test B, and of test B beyond its speeds
    published, films : fits of table 2 and of the plunger's map, by pressure; without those that
        lack a film somewhere
    rings, totals : of the back-up ring, of eq. 26
    kinds, stress, profiles : of the seal types and of the step ring
    turn, reliefs : None and empty where the first rod seal is no step ring
    readings : effect of two equations as printed
    whole, drained : rise of the plunger's damping for each relief, for the whole tandem and for one
        drained between its seals
    """

    sealings: Sealings
    cylinder: CylinderMap
    plunger: FilmMap
    fast: FilmMap
    published: tuple[CurveFits, ...]
    films: tuple[tuple[float, CurveFits], ...]
    rings: tuple[BackupRingFilm, ...]
    totals: tuple[Total, ...]
    kinds: tuple[SealArrangement, ...]
    stress: Stress
    profiles: tuple[StepRingFilm, ...]
    readings: Readings
    turn: Turn | None
    reliefs: tuple[ReliefVariant, ...]
    whole: tuple[float, ...]
    drained: tuple[float, ...]


def study_of(design: Design) -> HuangStudy:
    """Both tests with the seals of a design."""
    seals = sealings(design)
    plunger = plunger_map(seals)
    turn, reliefs, whole, drained = _reliefs(seals)
    return HuangStudy(
        sealings=seals,
        cylinder=cylinder_map(seals),
        plunger=plunger,
        fast=fast_map(seals),
        published=tuple(map(huang_published.fitted, HUANG_TABLE_2)),
        films=_fitted(plunger),
        rings=ring_films(seals),
        totals=tuple(total(seals, plunger, p, v) for p, v in TOTALS),
        kinds=kinds(seals, plunger),
        stress=stress(seals),
        profiles=profiles(seals),
        readings=readings(seals),
        turn=turn,
        reliefs=reliefs,
        whole=whole,
        drained=drained,
    )


def _fitted(mapped: FilmMap) -> tuple[tuple[float, CurveFits], ...]:
    """Both damping laws, fitted to a map at each of its pressures."""
    fits = []
    for row in HUANG_TABLE_2:
        i, _ = mapped.at(row.pressure, PAPER.speeds[0])
        curve = mapped.damping[i]
        if np.all(np.isfinite(curve)):
            power = fit_power_law(mapped.speeds, curve)
            both = CurveFits(row, power, fit_double_exponential(mapped.speeds, curve))
            fits.append((row.pressure, both))
    return tuple(fits)


def _reliefs(
    seals: Sealings,
) -> tuple[Turn | None, tuple[ReliefVariant, ...], tuple[float, ...], tuple[float, ...]]:
    """Trend of damping over pressure with other reliefs of the step ring."""
    ring = seals.plunger.rings[0]
    if "relief" not in ring.numbers:
        return None, (), (), ()
    turned = turn(seals)
    wanted = {*RELIEFS, ring["relief"]}
    if np.isfinite(turned.relief):
        wanted |= {turned.relief, *(turned.relief * share for share in BEYOND)}
    lengths = [relief for relief in sorted(wanted) if relief < 0.93 * ring["width"]]
    two = len(seals.plunger.rings) == 2
    return (
        turned,
        tuple(with_relief(seals, relief) for relief in lengths),
        tuple(tandem_rise(seals, relief) for relief in lengths) if two else (),
        tuple(drained_rise(seals, relief) for relief in lengths) if two else (),
    )
