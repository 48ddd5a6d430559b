"""The plant of a simulation: the numbers of a design in its equations of motion, SI.

The plant is the mechanical and hydraulic system that the controller acts on. Oil properties are
taken at the temperature of the first load case.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, maximum
from ..design.ideal import Ideal
from ..design.model import Design
from ..design.valve import Valve
from ..evaluation import circuit, state
from ..evaluation.build import spec_hash
from ..evaluation.circuit import CHAMBERS, Chamber
from ..evaluation.kernel import ModelRun, PreparedDesign, compute
from ..evaluation.limits import MaterialValues
from ..evaluation.rings import Ring
from ..evaluation.spool import Read, course_edges, metering_spool, spool_motion, spool_plays
from ..evaluation.springs import OIL, Give
from ..evaluation.values import Values
from ..models import end_stop, lines, linkage
from ..models.metering_spool import MeteringSpool
from .bench import Bench, bench, first_case

LEAST_AIR = 1e-4
"""Free air content above which the expanding air keeps the pressure above absolute vacuum. Our
choice: 0.01 %."""

CAVITY = 1e-6
"""Content of the vapour cavity that keeps the pressure above absolute vacuum in oil with less air
than `LEAST_AIR`, as a share of the volume. The cavity exists only below atmospheric pressure. Our
choice: at 0.05 bar absolute it takes 0.006 % of the volume."""
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Chamber pressures at which the friction is fitted, as shares of the supply pressure."""


@dataclass(frozen=True, slots=True)
class Oil:
    """The oil at the temperature of the first load case."""

    temperature: float
    bulk_modulus: float
    """Tangent bulk modulus of the pure oil at zero gauge pressure."""
    slope: float
    """Increase of the bulk modulus per unit pressure; for a Tait law, the mean value up to supply
    pressure."""
    air_content: float
    polytropic_index: float
    density: float
    dynamic_viscosity: float
    kinematic_viscosity: float
    vapour_pressure: float

    @property
    def cavity(self) -> float:
        """Return the content of the vapour cavity; zero if the oil contains enough air."""
        return CAVITY if self.air_content < LEAST_AIR else 0.0

    @property
    def law(self) -> dict[str, float]:
        """Return the arguments for the functions of `models.chamber`."""
        return {
            "bulk_modulus": self.bulk_modulus,
            "slope": self.slope,
            "air_content": self.air_content,
            "polytropic_index": self.polytropic_index,
        }


@dataclass(frozen=True, slots=True)
class ValveData:
    """Edges and spool of the valve."""

    rated: float
    leakage_supply: float
    leakage_tank: float
    """`rated` is the flow coefficient of a fully open metering edge. `leakage_supply` and
    `leakage_tank` are those of the edges of a centred spool [m^3/s/sqrt(Pa)]."""
    signal: float
    natural_frequency: float
    damping_ratio: float
    offset: float = 0.0
    """Signal that centres the spool [V]."""
    slew_rate: float | None = None
    """Largest speed of the spool [V/s]; None: no limit."""
    metering: MeteringSpool | None = None
    """Spool whose edges have laps or curves; None: the course's law, with the three flow
    coefficients."""
    plays: tuple[float, ...] = ()
    """Half widths of the plays of hysteresis and threshold [V]; empty: no hysteresis."""

    @property
    def bands(self) -> tuple[float, ...]:
        """Threshold and hysteresis [V]; empty without hysteresis."""
        if not self.plays:
            return ()
        return 2 * self.plays[0], self.plays[0] + self.plays[-1]

    def start(self, side: float) -> float:
        """Signal, from that of the centred spool, at which the edges of a direction open [V].

        `side` is 1 for the edges P-A and B-T, and -1 for A-T and P-B. It is zero for the course's
        law and for edges without overlap; an underlap counts as zero too.
        """
        if self.metering is None:
            return 0.0
        spool = self.metering
        edges = (spool.supply_a, spool.b_tank) if side > 0 else (spool.a_tank, spool.supply_b)
        stroke = max(float(spool.start(edge)) for edge in edges)
        return self.signal * spool.signal_share(max(stroke, 0.0))


@dataclass(frozen=True, slots=True)
class LinePiece:
    """Size, fittings and oil of a pipe or hose, for its pressure drop."""

    inner_diameter: float
    length: float
    loss_coefficient: float
    density: float
    dynamic_viscosity: float

    def drop(self, flow: Array) -> Array:
        """Return the pressure drop of the line and its fittings [Pa]."""
        stream = {"flow": flow, "inner_diameter": self.inner_diameter, "density": self.density}
        line = lines.line_pressure_drop(
            **stream, length=self.length, dynamic_viscosity=self.dynamic_viscosity
        )
        if not self.loss_coefficient:
            return line
        return line + lines.fitting_pressure_drop(**stream, loss_coefficient=self.loss_coefficient)


@dataclass(frozen=True, slots=True)
class LineData:
    """The lines of one chamber, in two parts: near the chamber and far from it.

    The parts meet at the throttle; without a throttle, each part is half of every line.
    """

    near_volume: float = 0.0
    near_wall: float = 0.0
    far_volume: float = 0.0
    far_wall: float = 0.0
    inertance: float = 0.0
    pieces: tuple[LinePiece, ...] = ()

    def drop(self, flow: Array) -> Array:
        """Return the pressure drop of all lines at a flow [Pa]."""
        return sum((piece.drop(flow) for piece in self.pieces), 0.0 * flow)


@dataclass(frozen=True, slots=True)
class Plane:
    """A force as a function of the chamber pressures [N].

    It is c0 + c1 |p_A - p_B| + c2 p_B + c3 max(p_A, p_B), with the four numbers in this order.
    """

    constant: float
    difference: float = 0.0
    rod_side: float = 0.0
    higher: float = 0.0
    error: float = 0.0
    """Largest deviation from the friction law of the seals, relative to the largest friction."""

    def at(self, pressure_a: Array, pressure_b: Array) -> Array:
        """Return the force at chamber pressures [Pa]."""
        higher = maximum(pressure_a, pressure_b) if self.higher else 0.0
        across = absolute(pressure_a - pressure_b) if self.difference else 0.0
        rest = self.rod_side * pressure_b + self.higher * higher
        return self.constant + self.difference * across + rest


@dataclass(frozen=True, slots=True)
class SealData:
    """Friction of all seals and wipers."""

    coulomb: Plane
    static: Plane
    stribeck_speed: float
    viscous: float
    bristle_travel: float


@dataclass(frozen=True, slots=True)
class Plant:
    """Properties of a design in its equations of motion, SI.

    At position x from the cap end, with stroke s, the chamber volumes are A_A x + dead volume and
    A_B (s - x) + dead volume, without lines. `walls` is the volume by which pressure expands the
    elastic walls of the chambers, per unit pressure; oil and lines are not included.
    """

    design: Design
    area_a: float
    area_b: float
    stroke: float
    dead_a: float
    dead_b: float
    walls: Give
    flexibility: float
    """Compliance of rod and mount in series [m/N]."""
    mass: float
    """Mass of load, rod, piston and fastening, without the inertia of a joint [kg]."""
    leakage: float
    oil: Oil
    supply_pressure: float
    return_pressure: float
    proof_pressure: float
    valve: ValveData | None
    lines: dict[Chamber, LineData]
    throttle: dict[str, float] | None
    """Arguments for the functions of `models.one_way_valve`, without the pressures."""
    reducing_valve: dict[str, float] | None
    seals: SealData
    films: dict[str, bool]
    """Whether the piston and rod seals run on an oil film in the design."""
    oil_damping: float
    """Force on the piston by oil shear in pipes and annular gaps, per piston speed [N s/m]."""
    stop_stiffness: float
    closed_length: float

    def joint(
        self, position: Array
    ) -> tuple[linkage.LinkageGeometry, linkage.ReflectedInertia] | None:
        """Return linkage geometry and reflected inertia of the joint at a position."""
        pivots = self.design.linkage
        if pivots is None:
            return None
        arm = linkage.linkage(
            joint_angle=self.joint_angle(position),
            base_radius=pivots.base_radius,
            crank_radius=pivots.crank_radius,
            angle_offset=pivots.angle_offset,
        )
        reflected = linkage.reflected_inertia(
            inertia=self.design.load.inertia, lever_arm=arm.lever_arm, lever_slope=arm.lever_slope
        )
        return arm, reflected

    def joint_angle(self, position: Array) -> Array:
        """Return the joint angle at a position [rad], for a design with a linkage."""
        pivots = self.design.linkage
        assert pivots is not None
        return linkage.linkage_angle(
            length=self.closed_length + position,
            base_radius=pivots.base_radius,
            crank_radius=pivots.crank_radius,
            angle_offset=pivots.angle_offset,
        )

    def moving_mass(self, position: float) -> float:
        """Return the total moving mass, including a joint's reflected inertia [kg]."""
        joint = self.joint(position)
        return self.mass + (0.0 if joint is None else float(joint[1].mass))


MOST_KEPT = 8
"""Number of plants that are kept (our choice: the models take longer than a simulation, and a study
of a servo changes its scenario more often than its design)."""
_KEPT: dict[str, Plant] = {}
"""The plants used last, by the hash of their design."""


def plant(subject: PreparedDesign) -> Plant:
    """Return the plant of a design, at the temperature of its first load case.

    Seals that run on an oil film in the design are simulated dry, with their friction coefficient.
    A block `ideal` states numbers of the cylinder instead. The plants used last are kept.
    """
    key = spec_hash(subject)
    known = _KEPT.pop(key, None)
    _KEPT[key] = known = _plant(subject) if known is None else known
    while len(_KEPT) > MOST_KEPT:
        del _KEPT[next(iter(_KEPT))]
    return known


def _plant(subject: PreparedDesign) -> Plant:
    stated = subject.design.ideal
    if stated is not None:  # the parts that complete the file are never shown
        design = subject.design.model_copy(update={"ideal": None, "linkage": None})
        return _idealised(plant(replace(subject, design=design)), subject.design, stated)
    v = subject.values()
    done = compute(subject, v)
    design, g = subject.design, done.geometry
    own = bench(subject, done)
    give = done.springs.total([c for c in done.springs.chambers if c not in _NOT_WALLS])
    across = done.springs.series_compliance()
    supply = float(v["supply.pressure"])
    return Plant(
        design=design,
        area_a=first_case(g.area_a),
        area_b=first_case(g.area_b),
        stroke=first_case(g.stroke),
        dead_a=first_case(v["cylinder.dead_volume_a"]),
        dead_b=first_case(v["cylinder.dead_volume_b"]) + first_case(g.area_b) * _extra(done),
        walls=Give(*(first_case(part) for part in give)),
        flexibility=first_case(across),
        mass=float(v["load.mass"]) + own.mass,
        leakage=first_case(done.motion.leakage),
        oil=_oil(subject, v, own, supply),
        supply_pressure=supply,
        return_pressure=float(v["supply.return_pressure"]),
        proof_pressure=supply * float(v["supply.proof_ratio"]),
        valve=_valve(v, design, done),
        lines={chamber: _lines(v, design, done, chamber) for chamber in CHAMBERS},
        throttle=_throttle(v, design, done),
        reducing_valve=_numbers(v, design.ports.reducing_valve, "ports.reducing_valve."),
        seals=_seals(v, own, supply),
        films={
            place: getattr(design.seals, place).friction_law.film is not None
            for place in ("piston", "rod")
        },
        oil_damping=first_case(
            done.computed.metrics["damping_pipe"][""] + done.computed.metrics["damping_annular"][""]
        ),
        stop_stiffness=float(
            end_stop.stop_stiffness(
                area=first_case(g.area_a), pressure=supply, travel=v["cylinder.stop_travel"]
            )
        ),
        closed_length=first_case(done.computed.metrics["closed_length"][""]),
    )


NO_SEALS = SealData(Plane(0.0), Plane(0.0), 1e-3, 0.0, 1e-4)
"""Seals without friction; speed and travel are of no effect."""


def _idealised(whole: Plant, design: Design, stated: Ideal) -> Plant:
    """Return a plant with the cylinder of the block `ideal`: rigid walls, no friction of seals."""
    return replace(
        whole,
        design=design,
        area_a=stated.area_a,
        area_b=stated.area_b,
        stroke=stated.stroke,
        dead_a=stated.dead_volume_a,
        dead_b=stated.dead_volume_b,
        walls=Give(),
        flexibility=0.0 if stated.stiffness is None else 1 / stated.stiffness,
        mass=stated.mass + design.load.mass,
        leakage=stated.leakage,
        seals=NO_SEALS,
        films=dict.fromkeys(whole.films, False),
        oil_damping=0.0,
        stop_stiffness=float(
            end_stop.stop_stiffness(
                area=stated.area_a,
                pressure=whole.supply_pressure,
                travel=design.cylinder.stop_travel,
            )
        ),
        closed_length=stated.closed_length or 0.0,
    )


_NOT_WALLS = (*OIL, "pipes", "hoses")


def _extra(done: ModelRun) -> float:
    """Return the barrel length minus stroke, minus piston length, minus head length [m]."""
    g = done.geometry
    return first_case(g.barrel_length - g.piston_length - g.head_length - g.stroke)


def _oil(subject: PreparedDesign, v: Values, own: Bench, supply: float) -> Oil:
    section, temperature = subject.design.fluid, own.temperature
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)

    def modulus(pressure: float) -> float:
        return first_case(state.pure_bulk_modulus(v, section, stock, temperature, pressure))

    at_rest = modulus(0.0)
    density = first_case(state.oil_density(v, section, stock, temperature))
    kinematic = first_case(state.kinematic_viscosity(v, section, stock, temperature))
    vapour = state.vapour_pressure(stock, section.material, temperature)
    return Oil(
        temperature=temperature,
        bulk_modulus=at_rest,
        slope=(modulus(supply) - at_rest) / supply,
        air_content=float(v["fluid.air_content"]),
        polytropic_index=float(v["fluid.polytropic_index"]),
        density=density,
        dynamic_viscosity=kinematic * density,
        kinematic_viscosity=kinematic,
        vapour_pressure=0.0 if vapour is None else first_case(vapour),
    )


def _valve(v: Values, design: Design, done: ModelRun) -> ValveData | None:
    if design.valve is None:
        return None
    oil = {
        "density": first_case(done.state.density),
        "kinematic_viscosity": first_case(done.state.kinematic_viscosity),
    }
    return valve_data(circuit.of_valve(v), design.valve, **oil)


def valve_data(
    read: Read, stated: Valve, *, density: float, kinematic_viscosity: float
) -> ValveData:
    """Edges and spool of a valve as its block states it, in an oil."""
    metering = metering_spool(
        read, stated, density=density, kinematic_viscosity=kinematic_viscosity
    )
    rated = supply = tank = 0.0
    if metering is None:
        edges = course_edges(read, viscosity=kinematic_viscosity)
        rated, supply, tank = (float(coefficient) for coefficient in edges)
    motion = spool_motion(read)
    return ValveData(
        rated=rated,
        leakage_supply=supply,
        leakage_tank=tank,
        signal=float(read("signal")),
        natural_frequency=float(motion.natural_frequency),
        damping_ratio=float(motion.damping_ratio),
        offset=float(read("offset")),
        slew_rate=read("slew_rate"),
        metering=metering,
        plays=tuple(float(width) for width in spool_plays(read)),
    )


def _lines(v: Values, design: Design, done: ModelRun, chamber: Chamber) -> LineData:
    branch = circuit.branches(v, design, done.state)[chamber]
    throttled = design.ports.throttle is not None
    volumes, walls, pieces = [0.0, 0.0], [0.0, 0.0], []
    viscosity = getattr(done.state, f"dynamic_viscosity_{chamber}")
    for i, line in enumerate(design.lines):
        if line.chamber != chamber:
            continue
        at = f"lines[{i}]."
        size = {"inner_diameter": v[at + "inner_diameter"], "length": v[at + "length"]}
        volume, wall = lines.line_volume(**size), circuit.wall_compliance(v, line, at)
        pieces.append(
            LinePiece(
                float(v[at + "inner_diameter"]),
                float(v[at + "length"]),
                float(v[at + "loss_coefficient"]),
                first_case(done.state.density),
                first_case(viscosity),
            )
        )
        far = float(line.beyond_throttle) if throttled else 0.5
        for k, share in ((0, 1 - far), (1, far)):
            volumes[k] += share * first_case(volume)
            walls[k] += share * first_case(wall)
    return LineData(
        near_volume=volumes[0],
        near_wall=walls[0],
        far_volume=volumes[1],
        far_wall=walls[1],
        inertance=first_case(branch.inertance),
        pieces=tuple(pieces),
    )


def _throttle(v: Values, design: Design, done: ModelRun) -> dict[str, float] | None:
    numbers = _numbers(v, design.ports.throttle, "ports.throttle.")
    if numbers is None:
        return None
    return {
        "opening": numbers["opening"],
        "needle_area": numbers["area"],
        "check_area": numbers["check_area"],
        "cracking_pressure": numbers["cracking_pressure"],
        "density": first_case(done.state.density),
        "dynamic_viscosity": first_case(done.state.dynamic_viscosity),
    }


def _numbers(v: Values, section: Any, at: str) -> dict[str, float] | None:
    if section is None:
        return None
    return {name: float(v[at + name]) for name in type(section).model_fields if at + name in v}


def _seals(v: Values, own: Bench, supply: float) -> SealData:
    """Return the seal friction, fitted as a function of both chamber pressures."""
    p_a, p_b = (pressure.ravel() for pressure in np.meshgrid(*2 * (supply * np.array(SHARES),)))
    loads = [(ring, force) for ring, force in own.normal_forces(p_a, p_b)]
    coulomb = own.coulomb(p_a, p_b)
    static, _ = own.sliding(0.0 * p_a, p_a, p_b)
    weights = [float(np.mean(_falling(ring) * force)) for ring, force in loads]
    speeds = [float(ring["stribeck_speed"]) for ring, _ in loads]
    falling = sum(weights) > 0
    return SealData(
        coulomb=_plane(p_a, p_b, coulomb),
        static=_plane(p_a, p_b, static),
        stribeck_speed=float(np.average(speeds, weights=weights)) if falling else 1e-3,
        viscous=sum(float(ring["viscous_friction"]) for ring, _ in loads),
        bristle_travel=float(v["stiffness.seal_deflection"]),
    )


def _falling(ring: Ring) -> Array:
    """Return breakaway friction minus Coulomb friction, as a share of Coulomb friction [-]."""
    return ring.element.friction_law.breakaway(ring.sizes, 1.0) - 1.0


def _plane(p_a: Array, p_b: Array, force: Array) -> Plane:
    basis = np.stack([np.ones_like(p_a), abs(p_a - p_b), p_b, np.maximum(p_a, p_b)], axis=1)
    scale = np.array([1.0, *3 * (max(float(p_a.max()), 1.0),)])
    coefficients = np.linalg.lstsq(basis / scale, force, rcond=None)[0] / scale
    most = float(np.max(np.abs(force)))
    error = float(np.max(np.abs(basis @ coefficients - force))) / most if most > 0 else 0.0
    constant, difference, rod_side, higher = (float(coefficient) for coefficient in coefficients)
    return Plane(constant, difference, rod_side, higher, error)
