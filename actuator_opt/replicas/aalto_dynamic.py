"""The dynamic tests of [AaltoThesis] in the linear model: throttles, line ends, the 20 Hz peak.

Friction is left out: the thesis gives no number of it, and sliding seals only add damping. The
reducing valve's numbers are ours; the thesis names the valve as its suspect and no number of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import Literal

import numpy as np

from ..base.numeric import Array
from ..design.circuit import Ports, ReducingValve, Throttle
from ..design.model import Design
from ..evaluation.circuit import CHAMBERS, Chamber, Ways
from ..evaluation.kernel import ModelRun
from ..models import elements, linear, lines, loop, one_way_valve, orifice, resonators
from ..models.line_ends import CONSTANT_PRESSURE, LineEnd, antiresonance_frequency
from .aalto import MARGIN, PAPER, evaluated, first, temperature_of

End = Literal["constant_pressure", "reducing_valve"]
OPENINGS = (1.0, 0.5, 0.25)
"""Throttle 0, 50 and 75 %, read as the share of the needle's area that is left."""
TESTED = (10.0, 15.0, 20.0, 25.0, 30.0)
"""Loading frequencies of the thesis (Hz)."""
FREQUENCIES = np.linspace(5.0, 50.0, 361)
VALVE = ReducingValve(
    conductance=8e-12, passive_conductance=1e-11, natural_frequency=19.0, damping_ratio=0.2
)
"""Ours: peaks at 20 Hz at mid-stroke, soft below, near the closed cylinder above."""
NEAR = 0.5
"""How far the natural frequencies of the neighbouring valves lie (Hz)."""
MORE_DAMPING = (1.0, 1.25)
"""Their damping ratios over the valve's."""
THROTTLE = Throttle(
    area=one_way_valve.NEEDLE_AREA,
    check_area=one_way_valve.CHECK_AREA,
    cracking_pressure=one_way_valve.CRACKING_PRESSURE,
)
EQUAL_ENERGY = 4 / (3 * pi)
"""Share of a sine's amplitude at which the tangent of a quadratic loss dissipates as the sine."""


@dataclass(frozen=True, slots=True)
class Needle:
    """The throttle's needle at the thesis' largest speed amplitude, SI."""

    viscosity: float
    """Kinematic viscosity behind the thesis' Reynolds number."""
    temperature: float
    """At which the design's oil has it [K]; NaN where it never does."""
    reynolds: float
    """With the design's oil."""
    flow_coefficient: float
    flow_coefficient_slow: float
    """At the base velocity alone."""
    drop: float
    """Of the head side, fully open."""
    area: float
    """Needle that drops the cracking pressure there, as was measured."""


@dataclass(frozen=True, slots=True)
class Response:
    """Dynamic stiffness at mid-stroke over `FREQUENCIES` and at `TESTED` [N/m], complex."""

    opening: float
    over: Array
    tested: Array


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A reducing valve beside ours: what it makes of the open needle as the thesis states it."""

    valve: ReducingValve
    ratio: Array
    """Dynamic stiffness at `TESTED` over the static one, mid-stroke."""
    slowest_decay: float
    """As of `Peak`."""


@dataclass(frozen=True, slots=True)
class Peak:
    """The reducing valve's resonance with the cylinder."""

    antiresonance_frequency: tuple[float, float]
    """Where chamber A, and B, with its line and the valve takes no reactive flow [Hz]."""
    position: Array
    ratio: Array
    """Dynamic stiffness at 20 Hz over the static one along `position`, throttle 0 %."""
    slowest_decay: float
    """Largest real part of all poles [1/s], over the stroke and all throttles; < 0 is stable."""


@dataclass(frozen=True, slots=True)
class DynamicTest:
    """Everything the page on the dynamic tests shows."""

    static: float
    """Closed ports with hoses, mid-stroke [N/m]."""
    closed: Response
    """Throttle 100 %: cylinder and pipes alone."""
    area: float
    """The needle as stated [m^2]."""
    needle: Needle
    valve: ReducingValve
    stated: dict[End, tuple[Response, ...]]
    """By line end, for every opening, needle as the thesis states it."""
    read_back: dict[End, tuple[Response, ...]]
    """The same with the needle behind the measured pressure drop."""
    peak: Peak
    neighbours: tuple[Neighbour, ...]
    without_opening: float
    """Slowest decay of the valve without its passive conductance [1/s]."""
    quarter_wave: float
    """Lowest frequency of a pipe resonance of the longer hose [Hz]."""
    t_pipe: float
    """Length of a T-pipe that resonates at 20 Hz [m]."""


class Bench:
    """The cylinder between throttles and line ends, without friction."""

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
        """Constant pressure, or the reducing valve."""
        if end == "constant_pressure":
            return dict.fromkeys(CHAMBERS, CONSTANT_PRESSURE)
        return self.motion.held

    def model(self, end: End, position: Array, *, area: float) -> linear.LinearActuator:
        """Linear model; a needle of zero area is closed.

        Both chambers press through their needle, as in the half cycle that empties them; the
        tangent is taken where it dissipates as much as the sine of the thesis' speed amplitude.
        """
        throttles = {}
        for chamber in CHAMBERS:
            flow = EQUAL_ENERGY * PAPER.speed * self.areas[chamber]
            conductance: Array = 0.0
            if area > 0:
                conductance = 1 / orifice.orifice_resistance(area=area, flow=flow, **self.oil)
            throttles[chamber] = Ways(conductance, conductance)
        return replace(self.motion, throttles=throttles, held=self.ends(end)).model(position)

    def stiffness(
        self, end: End, position: Array, frequency: Sequence[float] | Array, *, area: float
    ) -> Array:
        """Complex dynamic stiffness (frequencies, positions)."""
        found = linear.dynamic_stiffness(
            model=self.model(end, position, area=area),
            frequency=np.asarray(frequency).reshape(-1, 1, 1),
        )
        value = np.asarray(found.real + 1j * found.imaginary)
        return value[:, 0, :]

    def response(self, end: End, opening: float, area: float) -> Response:
        """A needle, opened to a share of its area, at mid-stroke."""
        middle = np.array([self.stroke / 2])
        over, tested = (
            self.stiffness(end, middle, frequency, area=opening * area)[:, 0]
            for frequency in (FREQUENCIES, TESTED)
        )
        return Response(opening, over, tested)

    def responses(self, end: End, area: float) -> tuple[Response, ...]:
        """Every opening at mid-stroke."""
        return tuple(self.response(end, opening, area) for opening in OPENINGS)

    @property
    def static(self) -> float:
        """Closed ports with hoses, mid-stroke [N/m]."""
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
        """Where the valve peaks, how much along the stroke, and whether all is stable."""
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
        """Largest real part of all poles, over the stroke, all throttles and some needles."""
        position = np.linspace(MARGIN, self.stroke - MARGIN, 22)
        fastest = [
            loop.poles(model=self.model("reducing_valve", position, area=opening * area)).real.max()
            for area in areas
            for opening in OPENINGS
        ]
        return float(max(fastest))


def _neighbours(bench: Bench, areas: Sequence[float]) -> tuple[Neighbour, ...]:
    """Valves a little slower, faster and more damped."""
    ours, found = bench.valve, []
    slow = max(ours.natural_frequency - NEAR, ours.natural_frequency / 2)
    for frequency in (slow, ours.natural_frequency + NEAR):
        for damping in MORE_DAMPING:
            valve = ours.model_copy(
                update={
                    "natural_frequency": frequency,
                    "damping_ratio": damping * ours.damping_ratio,
                }
            )
            other = Bench(bench.design, valve)
            shaken = other.response("reducing_valve", 1.0, bench.throttle.area).tested
            found.append(
                Neighbour(valve, np.abs(shaken) / bench.static, other.slowest_decay(areas))
            )
    return tuple(found)


def dynamic_test(design: Design) -> DynamicTest:
    """The linear model's answer to the dynamic tests of the thesis."""
    bench = Bench(design)
    slow = max((case.speed for case in design.load_cases), default=0.0) or PAPER.speed
    needle, stated = bench.needle(slow), bench.throttle.area
    ends: tuple[End, End] = ("constant_pressure", "reducing_valve")
    longest = max((line.length for line in design.lines), default=1.0)
    areas = stated, needle.area
    without = Bench(design, bench.valve.model_copy(update={"passive_conductance": 0.0}))
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
            resonators.quarter_wave_length(frequency=PAPER.peak, sound_speed=PAPER.wave_speed)
        ),
    )
