"""The cylinder of [AaltoThesis] in this project's models: stiffness, static and dynamic tests.

Every curve is an evaluation of the design with the oil, lines and load cell of the figure, so the
re-creation needs no further formula. All values are in SI.

Static test: `trapped_air_load_step` treats walls as oil of the same compliance. Its volumes are
the bulk modulus K times the compliance C of oil and barrel. The compliance of rod and load cell is
added to the displacement, because the position is measured behind them.

Dynamic tests: the linear model leaves friction out. The thesis gives no number of friction, and
sliding seals only add damping. The values of the reducing valve are ours; the thesis only suspects
that such a valve acted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import pi, sqrt
from typing import Literal, NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..design.model import Design, Line, Ports, ReducingValve, Throttle
from ..evaluation import state
from ..evaluation.build import prepare
from ..evaluation.circuit import CHAMBERS, Chamber, Ways
from ..evaluation.kernel import ModelRun, compute
from ..evaluation.limits import MaterialValues
from ..evaluation.springs import Springs
from ..models import elements, fluid, linear, lines, loop, one_way_valve, orifice, transmission_line
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..models.line_ends import CONSTANT_PRESSURE, LineEnd, antiresonance_frequency
from ..models.stiffness import LoadStep, trapped_air_load_step
from .papers import published_numbers

Topology = Literal["per_chamber", "aalto_as_published"]


@dataclass(frozen=True, slots=True)
class AaltoThesis:
    """Values printed in the thesis, SI; ``notes/aalto.yaml`` states where."""

    bore: float
    rod: float
    stroke: float
    throttle: float
    temperatures: tuple[float, float]
    bulk_modulus: float
    bulk_modulus_with_air: float
    load_cell: float
    pressure_a: float
    pressure_b: float
    load_up: tuple[float, float]
    load_down: tuple[float, float]
    moved_up: tuple[float, float]
    moved_down: tuple[float, float]
    most_up: tuple[float, float]
    most_down: tuple[float, float]
    place: float
    loaded_up: tuple[float, float]
    loaded_down: tuple[float, float]
    bubble_a: float
    bubble_b: float
    wave_speed: float
    peak: float
    speed: float
    reynolds: float
    flow_coefficient: float
    cracking_pressure: float


PAPER = published_numbers(AaltoThesis, "aalto")

MARGIN = 0.005
"""Distance that the thesis' test runs keep from the ends of the stroke (m)."""


def places(design: Design) -> Array:
    """Positions of the tables: both ends of the test runs and mid-stroke."""
    stroke = design.cylinder.stroke
    return np.array([MARGIN, stroke / 2, stroke - MARGIN])


def pipes(design: Design) -> tuple[Line, ...]:
    """The lines that stay on the cylinder while its ports are closed."""
    return tuple(line for line in design.lines if line.type == "pipe")


def variant(
    design: Design,
    *,
    lines: Sequence[Line],
    bulk_modulus: float,
    topology: Topology = "per_chamber",
    load_cell: bool = True,
) -> Springs:
    """Springs of the design with one bulk modulus, no air, chosen lines and topology."""
    options = {"topology": topology, "seals": "sliding"}
    if not load_cell:
        options["load_cell"] = None  # type: ignore[assignment]
    oil = design.fluid.material
    changed = design.model_copy(
        update={
            "fluid": design.fluid.model_copy(
                update={"air_content": 0.0, "bulk_modulus_law": "constant"}
            ),
            "lines": tuple(lines),
            "stiffness": design.stiffness.model_copy(update=options),
            "materials": design.materials
            | {oil: design.materials.get(oil, {}) | {"bulk_modulus": bulk_modulus}},
        }
    )
    return evaluated(changed).springs


def evaluated(design: Design) -> ModelRun:
    """The model run of a single evaluation of the design."""
    subject = prepare(design)
    return compute(subject, subject.values())


def temperature_of(design: Design, viscosity: float) -> float:
    """Temperature [K] between -20 and 120 degC at which the oil has a kinematic viscosity.

    NaN if no such temperature exists.
    """
    subject = prepare(design)
    v = subject.values()
    materials = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    warm = np.linspace(253.15, 393.15, 1401)
    viscosities = np.log(np.ravel(state.kinematic_viscosity(v, design.fluid, materials, warm)))
    return float(np.interp(-np.log(viscosity), -viscosities, warm, left=np.nan, right=np.nan))


def first(values: Array) -> Array:
    """The first load case of an array (cases, points)."""
    return np.atleast_2d(np.asarray(values))[0]


def unstretched(springs: Springs) -> Springs:
    """The springs without the barrel's axial stretch, which the thesis leaves out."""
    others = {name: give for name, give in springs.chambers.items() if name != "stretch"}
    return replace(springs, chambers=others)


@dataclass(frozen=True, slots=True)
class Theory:
    """A stiffness curve of the thesis [N/m] along `position` [m]: printed formula and ours.

    `per_chamber` includes the compliances of the thesis, `stretched` also the barrel's axial
    stretch. The fields that end in `_at` are values at `places`.
    """

    position: Array
    published: Array
    per_chamber: Array
    published_at: Array
    per_chamber_at: Array
    stretched_at: Array

    @property
    def weakest(self) -> tuple[float, float]:
        """Position and value of the least stiffness, by the printed formula."""
        k = int(np.argmin(self.published))
        return float(self.position[k]), float(self.published[k])


def _along(design: Design) -> Array:
    stroke = design.cylinder.stroke
    return np.linspace(0.002 * stroke, 0.998 * stroke, 4981)


def oil_alone(design: Design, lines: Sequence[Line]) -> Theory:
    """Figure 5: eq. 6 with rigid walls and given line volumes; printed and own formula agree."""
    springs = variant(design, lines=lines, bulk_modulus=PAPER.bulk_modulus)
    position = _along(design)
    curve, at = (first(springs.hydraulic(x, springs.oil)) for x in (position, places(design)))
    return Theory(position, curve, curve, at, at, at)


def total(
    design: Design, lines: Sequence[Line], bulk_modulus: float, *, load_cell: bool = True
) -> Theory:
    """Figures 29 and 32: eq. 37 (pipes) or 38 (hoses too), as printed and per chamber."""
    printed = variant(
        design,
        lines=lines,
        bulk_modulus=bulk_modulus,
        topology="aalto_as_published",
        load_cell=load_cell,
    )
    ours = variant(design, lines=lines, bulk_modulus=bulk_modulus, load_cell=load_cell)
    plain, position, chosen = unstretched(ours), _along(design), places(design)
    with np.errstate(divide="ignore"):  # each oil gives way in one chamber only
        return Theory(
            position=position,
            published=first(printed.stiffness(position)),
            per_chamber=first(plain.stiffness(position)),
            published_at=first(printed.stiffness(chosen)),
            per_chamber_at=first(plain.stiffness(chosen)),
            stretched_at=first(ours.stiffness(chosen)),
        )


def air_behind(pressure: float) -> float:
    """Air content at which eq. 5 reduces the bulk modulus from 1600 to 1300 MPa at a pressure."""
    content = np.linspace(0.0, 0.05, 5001)
    modulus = fluid.effective_bulk_modulus(
        bulk_modulus=PAPER.bulk_modulus, pressure=pressure, air_content=content
    )
    return float(np.interp(-PAPER.bulk_modulus_with_air, -modulus, content))


INDEX = 1.4
"""Polytropic index of the thesis, eq. 5."""

UP, DOWN = sum(PAPER.load_up) / 2, sum(PAPER.load_down) / 2
"""Mean force steps of both piston directions [N]."""

ENTRAINED = 0.005
"""Air content of a usual mineral oil."""

CONTENTS = (0.001, 0.15)
"""Range of air contents searched for a displacement."""


class Bypass(NamedTuple):
    """Force on the chambers from figure 41's pressures [N], and share of the load not on them."""

    force: float
    share: float


@dataclass(frozen=True, slots=True)
class Air:
    """Air in both chambers, stated at atmospheric pressure [m^3]."""

    a: Array
    b: Array


@dataclass(frozen=True, slots=True)
class Answer:
    """Response to a load step for an assumption; arrays along `position`, SI.

    Displacements are magnitudes, NaN where no state of the chambers carries the load (cavitation).
    """

    displacement: Array
    pressure_a: float
    pressure_b: float
    """Pressures at 185 mm, as in figure 41."""

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest finite displacement over the positions; NaN without any."""
        known = self.displacement[np.isfinite(self.displacement)]
        if not known.size:
            return float("nan"), float("nan")
        return float(known.min()), float(known.max())

    @property
    def cavitating(self) -> int:
        """Number of positions without a state."""
        return int(np.count_nonzero(np.isnan(self.displacement)))


@dataclass(frozen=True, slots=True)
class Assumption:
    """An interpretation of the static test, with its responses to load upwards and downwards."""

    name: str
    up: Answer
    down: Answer


class ClosedCylinder:
    """The closed cylinder with pipes and 1600 MPa bulk modulus, at the thesis' 22 positions."""

    def __init__(self, design: Design) -> None:
        springs = variant(design, lines=pipes(design), bulk_modulus=PAPER.bulk_modulus)
        self.geometry, self.flexibility = springs.geometry, springs.series_compliance()
        stroke = springs.geometry.stroke
        self.position = np.linspace(MARGIN, stroke - MARGIN, 22)
        self.place = float(np.squeeze(np.minimum(PAPER.place, 0.99 * stroke)))
        places = np.append(self.position, self.place)
        oil = springs.total(springs.oil).at(places, stroke)
        walls = springs.total((*springs.oil, "barrel")).at(places, stroke)
        scale = PAPER.bulk_modulus
        self.oil = Air(scale * first(oil.a), scale * first(oil.b))
        self.volume = Air(scale * first(walls.a), scale * first(walls.b))

    def bypass(self, loaded: tuple[float, float], load: float) -> Bypass:
        """Force on the chambers from the measured pressures, and share of a load not on them."""
        a = (loaded[0] - PAPER.pressure_a) * self.geometry.area_a
        b = (loaded[1] - PAPER.pressure_b) * self.geometry.area_b
        force = abs(float(a - b))
        return Bypass(force, 1 - force / load)

    def entrained(self, content: float) -> Air:
        """Air spread evenly through the oil, by volume at atmospheric pressure."""
        content = min(content, CONTENTS[1])
        return Air(content * self.oil.a, content * self.oil.b)

    def bubbles(self, *, compressed: bool) -> Air:
        """The thesis' bubbles, 0.4 and 0.08 ml, read at atmospheric or at working pressure."""
        volumes = []
        for bubble, pressure in (
            (PAPER.bubble_a, PAPER.pressure_a),
            (PAPER.bubble_b, PAPER.pressure_b),
        ):
            ratio = (pressure + ATMOSPHERIC_PRESSURE) / ATMOSPHERIC_PRESSURE
            volumes.append(bubble * (ratio ** (1 / INDEX) if compressed else 1.0))
        return Air(volumes[0], volumes[1])

    def step(self, force: float, air: Air) -> LoadStep:
        """The chambers after a step of the force on the rod (> 0: the load pushes the rod in)."""
        return trapped_air_load_step(
            force=force,
            area_a=self.geometry.area_a,
            area_b=self.geometry.area_b,
            volume_a=self.volume.a,
            volume_b=self.volume.b,
            air_volume_a=air.a,
            air_volume_b=air.b,
            initial_pressure_a=PAPER.pressure_a,
            initial_pressure_b=PAPER.pressure_b,
            bulk_modulus=PAPER.bulk_modulus,
            polytropic_index=INDEX,
        )

    def answer(self, load: float, air: Air, *, share: float = 0.0) -> Answer:
        """Displacement including the load cell; the chambers do not carry `share` of the load."""
        step = self.step((1 - share) * load, air)
        moved = np.abs(step.displacement) + abs(load) * self.flexibility
        return Answer(
            displacement=np.broadcast_to(moved, self.oil.a.shape)[:-1],
            pressure_a=float(step.pressure_a[-1]),
            pressure_b=float(step.pressure_b[-1]),
        )

    def air_needed(self, load: float, most: float, *, share: float) -> float:
        """Entrained air at which the largest displacement equals the measured value.

        0 if the least of `CONTENTS` already gives more, infinite if the most gives less.
        """
        content = np.linspace(*CONTENTS, 300)
        air = Air(content[:, None] * self.oil.a, content[:, None] * self.oil.b)
        moved = np.abs(self.step((1 - share) * load, air).displacement)
        known = np.where(np.isfinite(moved), moved, -np.inf)[:, :-1]
        largest = known.max(axis=1) + abs(load) * self.flexibility
        held = np.isfinite(largest)
        if not held.any():
            return float("inf")
        return float(np.interp(most, largest[held], content[held], left=0.0, right=np.inf))


@dataclass(frozen=True, slots=True)
class StaticTest:
    """The static test for every assumption."""

    position: Array
    place: float
    """Position of the pressures of every response [m]."""
    up: Bypass
    down: Bypass
    assumptions: tuple[Assumption, ...]
    air_up: tuple[float, float]
    """Entrained air that explains the largest displacement: if the chambers carry the whole load,
    and if they carry its measured share. 0 or infinite outside `CONTENTS`."""
    air_down: tuple[float, float]


def static_test(design: Design) -> StaticTest:
    """Displacement by a force step over position, in both directions."""
    bench = ClosedCylinder(design)
    up, down = bench.bypass(PAPER.loaded_up, UP), bench.bypass(PAPER.loaded_down, DOWN)
    air_up = _needed(bench, -UP, sum(PAPER.most_up) / 2, up)
    air_down = _needed(bench, DOWN, sum(PAPER.most_down) / 2, down)
    usual = bench.entrained(ENTRAINED)
    small, large = (bench.bubbles(compressed=held) for held in (False, True))
    airs = (
        ("no air", bench.entrained(0.0), bench.entrained(0.0), False),
        ("0.5 % entrained", usual, usual, False),
        ("0.5 %, by-pass", usual, usual, True),
        (
            "fitted air, by-pass",
            bench.entrained(air_up[1]),
            bench.entrained(air_down[1]),
            True,
        ),
        ("bubbles at 1 bar, by-pass", small, small, True),
        ("bubbles 20/42 bar, by-pass", large, large, True),
    )
    return StaticTest(
        position=bench.position,
        place=bench.place,
        up=up,
        down=down,
        assumptions=tuple(
            Assumption(
                name,
                bench.answer(-UP, risen, share=up.share if passed else 0.0),
                bench.answer(DOWN, sunk, share=down.share if passed else 0.0),
            )
            for name, risen, sunk, passed in airs
        ),
        air_up=air_up,
        air_down=air_down,
    )


def _needed(bench: ClosedCylinder, load: float, most: float, bypass: Bypass) -> tuple[float, float]:
    without, with_bypass = (
        bench.air_needed(load, most, share=share) for share in (0.0, bypass.share)
    )
    return without, with_bypass


End = Literal["constant_pressure", "reducing_valve"]

OPENINGS = (1.0, 0.5, 0.25)
"""Open share of the needle's area, for throttle settings of 0, 50 and 75 %."""

TESTED = (10.0, 15.0, 20.0, 25.0, 30.0)
"""Loading frequencies of the thesis (Hz)."""

FREQUENCIES = np.linspace(5.0, 50.0, 361)

VALVE = ReducingValve(
    conductance=8e-12, passive_conductance=1e-11, natural_frequency=19.0, damping_ratio=0.2
)
"""Our valve. At mid-stroke the stiffness peaks at 20 Hz. It is low at lower frequencies, and close
to that of closed ports at higher frequencies."""

NEAR = 0.5
"""Difference of the natural frequencies of neighbouring valves (Hz)."""

MORE_DAMPING = (1.0, 1.25)
"""Damping ratios of neighbouring valves, as multiples of that of our valve."""

THROTTLE = Throttle(
    area=one_way_valve.NEEDLE_AREA,
    check_area=one_way_valve.CHECK_AREA,
    cracking_pressure=one_way_valve.CRACKING_PRESSURE,
)

EQUAL_ENERGY = 4 / (3 * pi)
"""Share of a sine's amplitude at which a quadratic pressure loss is linearised, so that the
tangent dissipates as much energy as the sine."""


@dataclass(frozen=True, slots=True)
class Needle:
    """The throttle's needle at the thesis' largest speed amplitude, SI."""

    viscosity: float
    """Kinematic viscosity that follows from the thesis' Reynolds number."""
    temperature: float
    """Temperature at which the design's oil has this viscosity [K]; NaN without any."""
    reynolds: float
    """Reynolds number with the design's oil."""
    flow_coefficient: float
    flow_coefficient_slow: float
    """Flow coefficient at the highest speed of the design's load cases."""
    drop: float
    """Pressure drop of the head side, fully open."""
    area: float
    """Area of the needle at which this drop is the measured cracking pressure."""


@dataclass(frozen=True, slots=True)
class StiffnessResponse:
    """Dynamic stiffness at mid-stroke over `FREQUENCIES` and at `TESTED` [N/m], complex."""

    opening: float
    over: Array
    tested: Array


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A reducing valve near ours: stiffness with the open needle that the thesis states."""

    valve: ReducingValve
    ratio: Array
    """Ratio of dynamic to static stiffness at `TESTED`, at mid-stroke."""
    slowest_decay: float
    """Largest real part of the poles, as in `Peak`."""


@dataclass(frozen=True, slots=True)
class Peak:
    """The reducing valve's resonance with the cylinder."""

    antiresonance_frequency: tuple[float, float]
    """Frequencies at which chamber A, or B, with its line and the valve takes no reactive flow
    [Hz]."""
    position: Array
    ratio: Array
    """Ratio of dynamic stiffness at 20 Hz to static stiffness along `position`, throttle 0 %."""
    slowest_decay: float
    """Largest real part of all poles [1/s], over the stroke and all throttles; < 0 is stable."""


@dataclass(frozen=True, slots=True)
class DynamicTest:
    """All results on the page of the dynamic tests."""

    static: float
    """Stiffness at mid-stroke with closed ports and hoses [N/m]."""
    closed: StiffnessResponse
    """Response with a throttle of 100 %: only cylinder and pipes."""
    area: float
    """Area of the needle as stated [m^2]."""
    needle: Needle
    valve: ReducingValve
    stated: dict[End, tuple[StiffnessResponse, ...]]
    """Responses by line end for every opening, with the needle that the thesis states."""
    read_back: dict[End, tuple[StiffnessResponse, ...]]
    """Responses with the needle that explains the measured pressure drop."""
    peak: Peak
    neighbours: tuple[Neighbour, ...]
    without_opening: float
    """Slowest decay of the valve without its passive conductance [1/s]."""
    quarter_wave: float
    """Lowest frequency of a pipe resonance of the longer hose [Hz]."""
    t_pipe: float
    """Length of a T-pipe that resonates at 20 Hz [m]."""


class HeldCylinder:
    """The cylinder between its throttles and line ends (boundary conditions), without friction."""

    def __init__(self, design: Design, valve: ReducingValve | None = None) -> None:
        self.design = design
        self.throttle = design.ports.throttle or THROTTLE
        self.valve = valve or design.ports.reducing_valve or VALVE
        ports = Ports(end="reducing_valve", throttle=self.throttle, reducing_valve=self.valve)
        self.done: ModelRun = evaluated(design.model_copy(update={"ports": ports}))
        geometry, state = self.done.geometry, self.done.state
        self.stroke = float(np.squeeze(geometry.stroke))
        self.areas = {"a": float(geometry.area_a), "b": float(geometry.area_b)}
        self.oil = {
            "density": float(first(state.density)[0]),
            "dynamic_viscosity": float(first(state.dynamic_viscosity)[0]),
        }
        self.motion = replace(self.done.motion, damping=0.0)

    def ends(self, end: End) -> dict[Chamber, LineEnd]:
        """Boundary conditions of both lines: constant pressure, or a reducing valve."""
        if end == "constant_pressure":
            return dict.fromkeys(CHAMBERS, CONSTANT_PRESSURE)
        return self.motion.held

    def model(
        self,
        end: End,
        position: Array,
        *,
        area: float,
        flows: Mapping[Chamber, float] | None = None,
    ) -> linear.LinearActuator:
        """Linear model with a needle of given area; zero area is closed.

        Oil leaves both chambers through their needle, as in the half cycle that empties them. The
        needle is linearised so that it dissipates as much energy as a sinusoidal flow of the
        amplitudes `flows` [m^3/s]; default: those of the thesis' speed amplitude. The turbulent
        part of its resistance is proportional to that amplitude, and to 1/area^2.
        """
        throttles = {}
        for chamber in CHAMBERS:
            amplitude = flows[chamber] if flows else PAPER.speed * self.areas[chamber]
            flow = EQUAL_ENERGY * amplitude
            conductance: Array = 0.0
            if area > 0:
                conductance = 1 / orifice.orifice_resistance(area=area, flow=flow, **self.oil)
            throttles[chamber] = Ways(conductance, conductance)
        return replace(self.motion, throttles=throttles, held=self.ends(end)).model(position)

    def stiffness(
        self,
        end: End,
        position: Array,
        frequency: Sequence[float] | Array,
        *,
        area: float,
        flows: Mapping[Chamber, float] | None = None,
    ) -> Array:
        """Complex dynamic stiffness (frequencies, positions); `flows` as for `model`."""
        response = linear.dynamic_stiffness(
            model=self.model(end, position, area=area, flows=flows),
            frequency=np.asarray(frequency).reshape(-1, 1, 1),
        )
        value = np.asarray(response.real + 1j * response.imaginary)
        return value[:, 0, :]

    def response(self, end: End, opening: float, area: float) -> StiffnessResponse:
        """Response at mid-stroke with a needle opened to a share of its area."""
        middle = np.array([self.stroke / 2])
        over, tested = (
            self.stiffness(end, middle, frequency, area=opening * area)[:, 0]
            for frequency in (FREQUENCIES, TESTED)
        )
        return StiffnessResponse(opening, over, tested)

    def responses(self, end: End, area: float) -> tuple[StiffnessResponse, ...]:
        """Responses of every opening at mid-stroke."""
        return tuple(self.response(end, opening, area) for opening in OPENINGS)

    @property
    def static(self) -> float:
        """Stiffness at mid-stroke with closed ports and hoses [N/m]."""
        return float(first(self.motion.springs.stiffness(np.array([self.stroke / 2])))[0])

    def needle(self, slow: float) -> Needle:
        """Reynolds number, flow coefficient and pressure drop of the open needle."""
        area, flow = self.throttle.area, PAPER.speed * self.areas["a"]
        size = float(orifice.round_diameter(area=area))
        kinematic = self.oil["dynamic_viscosity"] / self.oil["density"]

        def number(speed: float, viscosity: float) -> float:
            return float(
                lines.reynolds(
                    velocity=speed * self.areas["a"] / area,
                    diameter=size,
                    kinematic_viscosity=viscosity,
                )
            )

        def coefficient(speed: float) -> float:
            return float(orifice.discharge_coefficient(reynolds=number(speed, kinematic)))

        loss = 2 * PAPER.cracking_pressure / self.oil["density"]
        without_friction = flow / (PAPER.flow_coefficient * sqrt(loss))
        areas = np.geomspace(0.5 * without_friction, 100 * without_friction, 6001)
        drops = orifice.orifice_pressure_drop(area=areas, flow=flow, **self.oil)
        behind = np.interp(-PAPER.cracking_pressure, -drops, areas)
        viscosity = number(PAPER.speed, 1.0) / PAPER.reynolds
        return Needle(
            viscosity=viscosity,
            temperature=temperature_of(self.design, viscosity),
            reynolds=number(PAPER.speed, kinematic),
            flow_coefficient=coefficient(PAPER.speed),
            flow_coefficient_slow=coefficient(slow),
            drop=float(orifice.orifice_pressure_drop(area=area, flow=flow, **self.oil)),
            area=float(behind),
        )

    def peak(self, areas: Sequence[float]) -> Peak:
        """Frequency and height of the valve's peak along the stroke, and its stability."""
        position = np.linspace(MARGIN, self.stroke - MARGIN, 22)
        give = self.motion.springs.total().at(np.array([self.stroke / 2]), self.stroke)
        frequencies = [
            float(
                antiresonance_frequency(
                    conductance=self.valve.conductance,
                    natural_frequency=self.valve.natural_frequency,
                    damping_ratio=self.valve.damping_ratio,
                    compliance=float(first(compliance)[0]),
                )
            )
            for compliance in (give.a, give.b)
        ]
        shaken = self.stiffness("reducing_valve", position, [PAPER.peak], area=self.throttle.area)
        return Peak(
            antiresonance_frequency=(frequencies[0], frequencies[1]),
            position=position,
            ratio=np.abs(shaken[0]) / first(self.motion.springs.stiffness(position)),
            slowest_decay=self.slowest_decay(areas),
        )

    def slowest_decay(self, areas: Sequence[float]) -> float:
        """Largest real part of all poles, over the stroke, all throttle settings and `areas`."""
        position = np.linspace(MARGIN, self.stroke - MARGIN, 22)
        fastest = [
            loop.poles(model=self.model("reducing_valve", position, area=opening * area)).real.max()
            for area in areas
            for opening in OPENINGS
        ]
        return float(max(fastest))


def _neighbours(bench: HeldCylinder, areas: Sequence[float]) -> tuple[Neighbour, ...]:
    """Valves that are a little slower, faster and more damped."""
    ours, neighbours = bench.valve, []
    slow = max(ours.natural_frequency - NEAR, ours.natural_frequency / 2)
    for frequency in (slow, ours.natural_frequency + NEAR):
        for damping in MORE_DAMPING:
            valve = ours.model_copy(
                update={
                    "natural_frequency": frequency,
                    "damping_ratio": damping * ours.damping_ratio,
                }
            )
            other = HeldCylinder(bench.design, valve)
            shaken = other.response("reducing_valve", 1.0, bench.throttle.area).tested
            neighbours.append(
                Neighbour(valve, np.abs(shaken) / bench.static, other.slowest_decay(areas))
            )
    return tuple(neighbours)


def dynamic_test(design: Design) -> DynamicTest:
    """Response of the linear model to the dynamic tests of the thesis."""
    bench = HeldCylinder(design)
    slow = max((case.speed for case in design.load_cases), default=0.0) or PAPER.speed
    needle, stated = bench.needle(slow), bench.throttle.area
    ends: tuple[End, End] = ("constant_pressure", "reducing_valve")
    longest = max((line.length for line in design.lines), default=1.0)
    areas = stated, needle.area
    without = HeldCylinder(design, bench.valve.model_copy(update={"passive_conductance": 0.0}))
    return DynamicTest(
        static=bench.static,
        closed=bench.response("constant_pressure", 0.0, stated),
        area=stated,
        needle=needle,
        valve=bench.valve,
        stated={end: bench.responses(end, stated) for end in ends},
        read_back={end: bench.responses(end, needle.area) for end in ends},
        peak=bench.peak(areas),
        neighbours=_neighbours(bench, areas),
        without_opening=without.slowest_decay(areas),
        quarter_wave=float(
            elements.quarter_wave_frequency(length=longest, sound_speed=PAPER.wave_speed)
        ),
        t_pipe=float(
            transmission_line.quarter_wave_length(
                frequency=PAPER.peak, sound_speed=PAPER.wave_speed
            )
        ),
    )
