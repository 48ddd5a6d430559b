"""The dynamic tests of [AaltoThesis] in the linear model: throttles, line ends, the 20 Hz peak.

Friction is left out: the thesis gives no number of it, and sliding seals only add damping. The
reducing valve's numbers are ours; the thesis names the valve as its suspect and no number of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Literal

import numpy as np

from ...design.circuit import Ports, ReducingValve, Throttle
from ...design.model import Design
from ...models import elements, linear, lines, loop, one_way_valve, orifice, resonators
from ...models.line_ends import LineEnd, reducing_valve_end, stiff_frequency
from ...numeric import Array
from ..circuit import CHAMBERS
from ..kernel import Pass
from .aalto import MARGIN, PAPER, evaluated, first

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
class Peak:
    """The reducing valve's resonance with the cylinder."""

    stiff_frequency: tuple[float, float]
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
    closed: Array
    """Throttle 100 % at `TESTED`: cylinder and pipes alone, mid-stroke."""
    needle: Needle
    valve: ReducingValve
    stated: dict[End, tuple[Response, ...]]
    """By line end, for every opening, needle as the thesis states it."""
    read_back: dict[End, tuple[Response, ...]]
    """The same with the needle behind the measured pressure drop."""
    peak: Peak
    quarter_wave: float
    """Lowest frequency of a pipe resonance of the longer hose [Hz]."""
    t_pipe: float
    """Length of a T-pipe that resonates at 20 Hz [m]."""


class Bench:
    """The cylinder between throttles and line ends, without friction."""

    def __init__(self, design: Design) -> None:
        self.throttle = design.ports.throttle or THROTTLE
        self.valve = design.ports.reducing_valve or VALVE
        ports = Ports(end="closed", throttle=self.throttle, reducing_valve=self.valve)
        self.done: Pass = evaluated(design.model_copy(update={"ports": ports}))
        geometry, state = self.done.geometry, self.done.state
        self.stroke = float(np.squeeze(geometry.stroke))
        self.areas = {"a": float(geometry.area_a), "b": float(geometry.area_b)}
        self.oil = {
            "density": float(first(state.density)[0]),
            "dynamic_viscosity": float(first(state.dynamic_viscosity)[0]),
        }
        self.motion = replace(self.done.motion, damping=0.0)

    def line_end(self, end: End) -> LineEnd:
        """Constant pressure, or the reducing valve."""
        if end == "constant_pressure":
            return LineEnd((1.0,), ())
        return reducing_valve_end(
            conductance=self.valve.conductance,
            passive_conductance=self.valve.passive_conductance,
            natural_frequency=self.valve.natural_frequency,
            damping_ratio=self.valve.damping_ratio,
        )

    def model(self, end: End, position: Array, *, area: float) -> linear.LinearActuator:
        """Linear model; a needle of zero area is closed.

        Both chambers press through their needle, as in the half cycle that empties them; the
        tangent is taken where it dissipates as much as the sine of the thesis' speed amplitude.
        """
        conductance = {
            chamber: 0.0
            if area == 0
            else 1
            / orifice.orifice_resistance(
                area=area, flow=EQUAL_ENERGY * PAPER.speed * self.areas[chamber], **self.oil
            )
            for chamber in CHAMBERS
        }
        ends = dict.fromkeys(CHAMBERS, self.line_end(end))
        return replace(self.motion, throttles=conductance, ends=ends).model(position)

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

    def responses(self, end: End, area: float) -> tuple[Response, ...]:
        """Every opening at mid-stroke."""
        middle = np.array([self.stroke / 2])
        return tuple(
            Response(
                opening,
                self.stiffness(end, middle, FREQUENCIES, area=opening * area)[:, 0],
                self.stiffness(end, middle, TESTED, area=opening * area)[:, 0],
            )
            for opening in OPENINGS
        )

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

        areas = np.geomspace(0.02 * area, 2 * area, 2001)
        drops = orifice.orifice_pressure_drop(area=areas, flow=flow, **self.oil)
        behind = np.interp(-PAPER.cracking_pressure, -drops, areas)
        return Needle(
            viscosity=number(PAPER.speed, 1.0) / PAPER.reynolds,
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
                stiff_frequency(
                    conductance=self.valve.conductance,
                    natural_frequency=self.valve.natural_frequency,
                    damping_ratio=self.valve.damping_ratio,
                    compliance=float(first(compliance)[0]),
                )
            )
            for compliance in (give.a, give.b)
        ]
        shaken = self.stiffness("reducing_valve", position, [PAPER.peak], area=self.throttle.area)
        fastest = [
            loop.poles(model=self.model("reducing_valve", position, area=opening * area)).real.max()
            for area in areas
            for opening in OPENINGS
        ]
        return Peak(
            stiff_frequency=(frequencies[0], frequencies[1]),
            position=position,
            ratio=np.abs(shaken[0]) / first(self.motion.springs.stiffness(position)),
            slowest_decay=float(max(fastest)),
        )


def dynamic_test(design: Design) -> DynamicTest:
    """The linear model's answer to the dynamic tests of the thesis."""
    bench = Bench(design)
    slow = max((case.speed for case in design.load_cases), default=0.0) or PAPER.speed
    needle, stated = bench.needle(slow), bench.throttle.area
    middle = np.array([bench.stroke / 2])
    ends: tuple[End, End] = ("constant_pressure", "reducing_valve")
    longest = max((line.length for line in design.lines), default=1.0)
    return DynamicTest(
        static=float(first(bench.motion.springs.stiffness(middle))[0]),
        closed=bench.stiffness("constant_pressure", middle, TESTED, area=0.0)[:, 0],
        needle=needle,
        valve=bench.valve,
        stated={end: bench.responses(end, stated) for end in ends},
        read_back={end: bench.responses(end, needle.area) for end in ends},
        peak=bench.peak((stated, needle.area)),
        quarter_wave=float(
            elements.quarter_wave_frequency(length=longest, sound_speed=PAPER.wave_speed)
        ),
        t_pipe=float(
            resonators.quarter_wave_length(frequency=PAPER.peak, sound_speed=PAPER.wave_speed)
        ),
    )
