"""Piston and rod seals in an evaluation: squeeze, contact, extrusion gap, friction, damping."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base.errors import ActuatorError, Diagnostic, Unsolvable, article
from ..base.numeric import Array, absolute, maximum, real, where
from ..design.model import Design
from ..design.seals import ContactProfile, Wiper
from ..friction.law import Friction
from ..models import damping, friction, gland, lip_seal, retention, wear
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..seals.contact import SealContact
from ..seals.kinds import TYPES
from .barrel import OWN, SEAL_STEP, Wall
from .film import Stroke, of_place
from .film_tables import FilmTable, Key, Running, running as films_running
from .geometry import Geometry, Groove
from .guides import side_reactions
from .limits import MaterialValues, MetricArrays
from .rings import (
    BLOCKS,
    INCOMPRESSIBLE,
    Ring,
    face_modulus,
    gland_metrics,
    places,
    seal_contact,
    static_rings,
)
from .rods import RodSection
from .state import LoadState
from .values import Values

if TYPE_CHECKING:
    from ..finite_elements.section import MountedContact


def compute(
    v: Values,
    design: Design,
    stock: MaterialValues,
    geometry: Geometry,
    state: LoadState,
    wall: Wall,
    rings: tuple[Ring, ...],
    films: Films,
    sections: Sequence[RodSection],
    out: MetricArrays,
) -> Friction:
    """Compute gland, contact and friction metrics of all seals; return the total friction."""
    seal_growths = {path: SEAL_STEP * growth for path, growth in wall.growths.items()}
    by_metric: dict[str, dict[str, Array]] = {}
    total = Friction()
    moving = np.atleast_2d(real(state.speed))[:, 0] > 0
    for ring in rings:
        grown = seal_growths if ring.name == "piston" else {OWN: 0.0}
        gland_rows = gland_metrics(v, design, stock, geometry, state, ring, grown)
        rows, ring_friction = _contact_rows(ring, films, geometry.stroke, state.speed)
        total = total + ring_friction
        out.friction_parts[ring.label] = ring_friction.running
        for metric, value in rows.items():
            by_metric.setdefault(metric, {})[ring.label] = value
        for metric, by_place in gland_rows.items():
            by_metric.setdefault(metric, {}).update(by_place)
    for ring in static_rings(v, design, geometry):
        gland_rows = gland_metrics(v, design, stock, geometry, state, ring, wall.growths)
        for metric, by_place in gland_rows.items():
            by_metric.setdefault(metric, {}).update(by_place)
    other_friction = wipers_and_guides(v, design, geometry, state, sections)
    total = total + other_friction
    out.friction_parts["wipers and guides"] = other_friction.running
    for metric, by_place in by_metric.items():
        out.put(metric, by_place, cases=moving if metric == "film_thickness" else None)
    for name in ("seal_squeeze", "seal_squeeze_max", "seal_fill", "seal_stretch", "seal_section"):
        out.skip(name, "no sliding O-ring")
    gaps = {
        path: gland.extrusion_gap(clearance=geometry.piston_clearance, growth=growth)
        for path, growth in seal_growths.items()
    }
    out.put("seal_gap", gaps)
    out.put("growth_at_seal", seal_growths)
    out.put("friction_running", total.running)
    out.put("friction_breakaway", total.breakaway)
    secant = damping.secant(friction=total.running, speed=state.speed)
    out.put("damping_seal", secant, cases=moving)
    if not moving.any():
        out.skip("damping_seal", "no load case has a speed: add load_cases[NAME].speed")
    return total


def _contact_rows(
    ring: Ring, films: Films, stroke: Array, speed: Array
) -> tuple[dict[str, Array], Friction]:
    """Contact metrics and friction of a sliding ring."""
    contact = seal_contact(_at_interseal_pressure(ring, films))
    rows = {
        "contact_width": contact.width,
        "contact_pressure": contact.peak,
        "seal_wear": wear.sliding_severity(
            line_load=contact.line_load, contact_width=contact.width, distance=2 * stroke
        ),
    }
    law, film = ring.element.friction_law, films.get(ring.label)
    if film is not None:
        rows["film_thickness"] = film.thickness
    if law.film is None:
        return rows, law.friction(ring.sizes, contact, row_load(ring, contact), speed)
    return rows, law.film(ring.sizes, contact, film)


Films = Mapping[str, Running]
"""Oil films by label of the ring; rings without an oil film are missing."""


def films_of(
    tables: Mapping[Key, FilmTable], rings: tuple[Ring, ...], stroke: Stroke, cases: int
) -> dict[str, Running]:
    """Oil films of all rings on a stroke."""
    films: dict[str, Running] = {}
    for place in BLOCKS:
        place_rings = of_place(rings, place)
        running = films_running(tables, place_rings, stroke, cases)
        films |= dict(zip((ring.label for ring in place_rings), running, strict=False))
    return films


def compute_film(
    geometry: Geometry, state: LoadState, drive: Films, return_: Films, out: MetricArrays
) -> None:
    """Compute results of the oil films: leakage past the rod seal, and pressure between two seals.

    The leakage per double stroke is the oil dragged out minus the oil drawn back.
    """
    moving = real(state.speed) > 0
    leakages = {}
    for rod in geometry.rods:
        label = f"{rod.name} seal"
        if label in drive and label in return_:
            time = geometry.stroke / where(moving, state.speed, 1.0)
            flow = drive[label].flow + return_[label].flow
            leakages[label if len(geometry.rods) > 1 else ""] = maximum(flow * time, 0.0)
    if leakages:
        out.put("rod_leakage", leakages, cases=moving[:, 0])
    pairs = {
        label.removesuffix(" secondary seal"): film.between - ATMOSPHERIC_PRESSURE
        for label, film in drive.items()
        if label.endswith(" secondary seal")
    }
    if pairs:
        out.put("inter_seal_pressure", pairs, cases=moving[:, 0])
    remedy = 'needs the oil film: write "friction: film" in seals.rod'
    out.skip("film_thickness", 'needs the oil film: write "friction: film" in a seal')
    out.skip("rod_leakage", remedy)
    out.skip("inter_seal_pressure", f"{remedy} and add seals.rod.secondary")


def row_load(ring: Ring, contact: SealContact) -> Array:
    """Sum of the line loads (force per circumference) of `count` rings in series.

    The first ring seals the pressure; the others are only squeezed.
    """
    count = ring["count"]
    if isinstance(count, float) and count == 1.0:
        return contact.line_load
    idle = seal_contact(ring.at(pressure=0.0 * ring["pressure"]))
    return contact.line_load + (count - 1) * idle.line_load


def _at_interseal_pressure(ring: Ring, films: Films) -> Ring:
    """Copy of a ring with the pressure difference that it seals.

    Two rings in series that both have an oil film share the total pressure difference.
    """
    film = films.get(ring.label)
    if film is None:
        return ring
    paired = real(film.between) > 0
    between = where(paired, film.between, ATMOSPHERIC_PRESSURE) - ATMOSPHERIC_PRESSURE
    if ring.label.endswith("secondary seal"):
        pressure = where(paired, between - ring["outer_pressure"], 0.0)
    else:
        pressure = where(
            paired, ring["pressure"] + ring["outer_pressure"] - between, ring["pressure"]
        )
    return ring.at(pressure=absolute(pressure))


def wipers_and_guides(
    v: Values, design: Design, geometry: Geometry, state: LoadState, sections: Sequence[RodSection]
) -> Friction:
    """Coulomb friction of the wipers, and of the guide rings under the side load."""
    total: Array = sum((wiper.friction for wiper in wipers(v, design, geometry, state)), 0.0)
    reactions = side_reactions(geometry, state, sections).by_place
    for name, grooves, _ in places(geometry):
        for groove in grooves:
            if groove.role == "guide":
                total = total + retention.guide_friction(
                    force=reactions[name],
                    friction_coefficient=v[f"{groove.path}friction_coefficient"],
                )
    return Friction(total, total, 0.0)


class WiperFriction(NamedTuple):
    """A wiper: PATH of its block, friction coefficient, and Coulomb friction [N]."""

    path: str
    coefficient: Array
    friction: Array


def wipers(
    v: Values, design: Design, geometry: Geometry, state: LoadState
) -> tuple[WiperFriction, ...]:
    """Friction of all wipers, each modelled as the lip of a U-cup without pressure."""
    all_wipers = []
    for name, grooves, diameter in places(geometry):
        wiper = getattr(design.seals, BLOCKS[name]).wiper
        for groove in grooves:
            if groove.role == "wiper" and wiper is not None:
                all_wipers.append(_wiper(v, wiper, groove, diameter, state.temperature))
    return tuple(all_wipers)


def _wiper(
    v: Values, wiper: Wiper, groove: Groove, diameter: Array, temperature: Array
) -> WiperFriction:
    at, compound = groove.path, f"materials.{wiper.compound}."
    interference = lip_seal.lip_interference(section=groove.section, gland_depth=groove.gland_depth)
    load = lip_seal.line_load(
        interference=interference,
        root_clearance=interference,
        pressure=0.0,
        youngs_modulus=face_modulus(v, wiper.compound, wiper.hardness_model, temperature),
        poissons_ratio=v.get(f"{compound}poissons_ratio", INCOMPRESSIBLE),
        lip_thickness=v[f"{at}thickness"],
        lip_length=v[f"{at}width"],
        lip_radius=(diameter + v[f"{at}thickness"]) / 2,
    )
    stated = f"{at}friction_coefficient"
    coefficient = v[stated] if stated in v else v[f"{compound}friction_coefficient"]
    coulomb = friction.seal_friction(
        line_load=load, diameter=diameter, friction_coefficient=coefficient
    )
    return WiperFriction(at, coefficient, coulomb)


SHARES = (0.25, 0.5, 0.75, 1.0)
"""Sealed pressures, besides zero, at which contact profiles are computed, as shares of the supply
pressure."""
POINTS = 81
"""Number of points of a contact profile; they are evenly selected from the finite-element nodes."""


def room(ring: Ring) -> float:
    """Axial length that the back-up rings leave free in the groove [m]."""
    backs = ring.element.back_ups * (ring.element.back_up_thickness or 0.0)
    return float(ring["groove_width"]) - backs


def closed_form(ring: Ring) -> SealContact:
    """Contact of the ring by the formula of its type, at its pressure and nominal squeeze.

    It is compared with finite elements, and like them ignores bore growth and stated profiles.
    """
    bare = replace(ring, element=ring.element.model_copy(update={"contact": ()}))
    return seal_contact(bare.at(squeeze_left=ring["squeeze"], pressure=abs(ring["pressure"])))


def contacts(ring: Ring, supply: float) -> tuple[MountedContact, ...]:
    """Solve a ring by finite elements: without pressure, and at `SHARES` of the supply pressure.

    Back-up rings are rigid, like the groove.

    Parameters
    ----------
    ring : ring with plain floats, of a type with finite elements
    supply : highest sealed pressure [Pa]

    Raises
    ------
    ActuatorError
        scikit-fem is not installed, the seal type has no finite elements, or there is no solution
    """
    elements = ring.element.seal_type.elements
    if elements is None:
        types = " or ".join(
            article(seal_type.name) for seal_type in TYPES.values() if seal_type.elements
        )
        raise ActuatorError(
            Diagnostic(
                f"{ring.label}: finite elements are not available for a {ring.element.type}",
                f"use finite elements for {types}, or state measured or computed contact profiles",
            )
        )
    solution = elements.solve(ring.sizes, room(ring), [share * supply for share in SHARES])
    if solution.failure:
        raise Unsolvable(
            Diagnostic(
                f"{ring.label}: the finite elements have no solution: {solution.failure}",
                "lower the squeeze or the pressure, or widen the groove",
            )
        )
    return solution.contacts


def profiles(mounted_contacts: Iterable[MountedContact]) -> tuple[ContactProfile, ...]:
    """Contact profiles in the form of the design file."""
    return tuple(
        _profile(
            mounted_contact.pressure, mounted_contact.positions, mounted_contact.contact_pressure
        )
        for mounted_contact in mounted_contacts
    )


def _profile(pressure: float, positions: np.ndarray, stresses: np.ndarray) -> ContactProfile:
    """Contact profile with fewer points, rounded to 10 nm and 10 Pa.

    Its last point has the outer pressure.
    """
    offsets = positions - positions[0]
    indices = np.unique(
        np.linspace(0, len(offsets) - 1, min(POINTS, len(offsets))).round().astype(int)
    )
    pressures = np.maximum(stresses, 0.0)
    return ContactProfile(
        pressure=float(pressure),
        positions=tuple(float(x) for x in offsets[indices].round(8)),
        stresses=tuple(float(x) for x in pressures[indices].round(-1)),
    )
