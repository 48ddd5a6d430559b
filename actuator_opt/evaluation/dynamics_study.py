"""Dynamics along the stroke and over frequency: modes, Bode data, and distributed lines.

SI units. Only the governing load case and stroke position are studied.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, sorted_unique
from ..base.polynomial import Polynomial, add, at_frequency, roots, scale
from ..design.model import Design, Line
from ..models import dynamics, line_ends, linear, lines, loop, transmission_line
from ..models.line_ends import LineEnd
from .circuit import CHAMBERS, Chamber, wall_compliance
from .kernel import ModelRun, PreparedDesign
from .motion import Motion
from .state import LoadState
from .values import Values, of_case, plain


def _end(end: LineEnd, frequencies: Array, index: int) -> Array:
    """Admittance (flow per unit pressure) at the end of a line; infinite at constant pressure."""
    case_end = LineEnd(
        tuple(of_case(c, index) for c in end.numerator),
        tuple(of_case(c, index) for c in end.denominator),
    )
    return line_ends.end_admittance(end=case_end, frequency=frequencies)


def port_admittance(
    v: Values,
    design: Design,
    state: LoadState,
    motion: Motion,
    chamber: Chamber,
    index: int,
    frequencies: Array,
) -> Array:
    """Complex admittance of a chamber's lines at the port: flow per unit pressure, by frequency."""
    modulus = of_case(state.bulk_modulus_a if chamber == "a" else state.bulk_modulus_b, index)
    viscosity = state.dynamic_viscosity_a if chamber == "a" else state.dynamic_viscosity_b
    density = of_case(state.density, index)
    admittance = _end(motion.held[chamber], frequencies, index)
    chamber_lines = [(i, line) for i, line in enumerate(design.lines) if line.chamber == chamber]
    ways = motion.throttles.get(chamber)
    throttle = None if ways is None else ways.toward(motion.push)
    beyond = (
        [entry for entry in chamber_lines if entry[1].beyond_throttle]
        if throttle is not None
        else []
    )
    near = [entry for entry in chamber_lines if entry not in beyond]

    def through(admittance: Array, chain: Sequence[tuple[int, Line]]) -> Array:
        for i, _ in reversed(chain):
            at = f"lines[{i}]."
            size = {
                "inner_diameter": float(np.squeeze(v[at + "inner_diameter"])),
                "length": float(np.squeeze(v[at + "length"])),
            }
            wall = float(np.squeeze(wall_compliance(v, design.lines[i], at)))
            matrix = transmission_line.line_matrix(
                frequency=frequencies,
                **size,
                density=density,
                sound_speed=transmission_line.wave_speed(
                    bulk_modulus=modulus,
                    density=density,
                    volume=lines.line_volume(**size),
                    wall_compliance=wall,
                ),
                dynamic_viscosity=of_case(viscosity, index),
                friction="distributed",
            )
            admittance = transmission_line.input_admittance(
                matrix=matrix, end_admittance=admittance
            )
        return admittance

    admittance = through(admittance, beyond)
    if throttle is not None:
        g = of_case(throttle, index)
        series = g * admittance / (g + admittance) if g else 0 * admittance
        admittance = np.where(np.isinf(admittance), g, series)
    return through(admittance, near)


def dynamic_stiffness(
    v: Values,
    design: Design,
    state: LoadState,
    motion: Motion,
    index: int,
    position: float,
    frequencies: Array,
) -> Array:
    """Complex dynamic stiffness at a position, with the lines as transmission lines.

    At the piston it is k_p = k_s + B s + s a^T M^-1 a, with seal stiffness k_s, damping B, piston
    areas a, and the matrix M of chamber compliances and port admittances. The compliance of the rod
    is in series with k_p, and the mass is at the outer end of the rod.
    """
    s = 2j * pi * frequencies
    budget = motion.springs
    whole = budget.total().at(position, budget.geometry.stroke)
    oil = {"a": state.bulk_modulus_a, "b": state.bulk_modulus_b}
    diagonal = {}
    for chamber, total in zip(CHAMBERS, (whole.a, whole.b), strict=True):
        branch = motion.branches[chamber]
        line_compliance = branch.volume / oil[chamber] + branch.pipes + branch.hoses
        port = port_admittance(v, design, state, motion, chamber, index, frequencies)
        own = of_case(total, index) - of_case(line_compliance, index)
        diagonal[chamber] = s * own + of_case(motion.leakage, index) + port
    cross = s * of_case(whole.ab, index) - of_case(motion.leakage, index)
    a, b = of_case(budget.geometry.area_a, index), of_case(budget.geometry.area_b, index)
    with np.errstate(all="ignore"):
        det = diagonal["a"] * diagonal["b"] - cross * cross
        hydraulic = (a * a * diagonal["b"] + b * b * diagonal["a"] + 2 * a * b * cross) / det
        rigid = np.isinf(diagonal["a"]), np.isinf(diagonal["b"])  # constant pressure at the port
        hydraulic = np.where(
            rigid[0], b * b / diagonal["b"], np.where(rigid[1], a * a / diagonal["a"], hydraulic)
        )
    seals = 0.0 if budget.seals is None else of_case(budget.seals, index)
    piston = seals + s * of_case(motion.damping, index) + s * hydraulic
    flexibility = of_case(budget.series_compliance(), index)
    return piston / (1 + flexibility * piston) + s * s * of_case(motion.mass, index)


FREQUENCIES = np.geomspace(0.1, 1000.0, 121)
"""Frequencies of the responses [Hz]; more are added around every resonance."""
AROUND = np.array([-8.0, -3.0, -1.0, 0.0, 1.0, 3.0, 8.0])
"""Distances of extra frequencies from a resonance, as multiples of its half-width.

With these frequencies, no peak is missed.
"""


@dataclass(frozen=True, slots=True)
class Pole:
    """A pole of the actuator that holds a load: frequency [Hz] and damping ratio (1: real pole)."""

    frequency: float
    damping_ratio: float


@dataclass(frozen=True, slots=True)
class ShakenCase:
    """A load case with an oscillating load, at its stroke position of least dynamic stiffness."""

    name: str
    frequency: float
    """Excitation frequency [Hz]."""
    place: str
    stiffness: float
    """Dynamic stiffness [N/m]."""
    phase: float
    """Phase by which the force leads the displacement [rad]."""


@dataclass(frozen=True, slots=True)
class Response:
    """Dynamic stiffness at one position, as a function of frequency.

    `magnitude` is in N/m; `phase` is the angle by which the force leads the displacement [rad].
    """

    place: str
    position: float
    magnitude: Array
    phase: Array
    static: float
    """Static stiffness with closed ports at this position [N/m]."""


@dataclass(frozen=True, slots=True)
class LoopStudy:
    """The position loop in a load case at a position; arrays have one entry per frequency."""

    case: str
    place: str
    gain: float
    tuned: bool
    """Whether `gain` is the default, half the ultimate gain, because the design states none."""
    ultimate_gain: float
    ultimate_frequency: float
    gain_margin: float
    phase_margin: float
    crossover: float | None
    bandwidth: float | None
    governs: tuple[str, ...]
    """Which of the metrics gain_margin, phase_margin and bandwidth have their least value in this
    loop."""
    open_magnitude: Array
    open_phase: Array
    """Phase of the open loop [rad], from near -pi/2 at low frequency, without jumps by 2 pi."""
    closed_magnitude: Array


@dataclass(frozen=True, slots=True)
class DynamicsStudy:
    """Linear dynamics of a design in the load case with the least stiffness."""

    case: str
    mass: float
    end: str
    """Connection at the end of the lines: closed, valve, constant_pressure, reducing_valve."""
    position: Array
    """Positions along the stroke [m], from the cap end. `closed_frequency`, `frequency` and
    `damping_ratio` have one entry for each of them."""
    closed_frequency: Array
    """Natural frequency [Hz] with closed ports."""
    frequency: Array
    """Natural frequency [Hz] with the lines connected to `end`."""
    damping_ratio: Array
    friction_share: float
    """Contribution of friction and oil shear to the damping ratio, at the position of least
    stiffness."""
    conductance_share: float
    """Contribution of leakage and line ends to the damping ratio, at the position of least
    stiffness."""
    poles: tuple[Pole, ...]
    """All poles at the position of least stiffness, lowest frequency first."""
    frequencies: Array
    response_case: str
    """Load case of `responses`: the case with the least dynamic stiffness, or `case` if there is no
    excitation."""
    responses: tuple[Response, ...]
    """Responses at the cap end, the position of least stiffness and the rod end."""
    distributed: Array | None
    """Dynamic stiffness at the position of least stiffness, with the lines as transmission lines;
    None without lines."""
    shaken: tuple[ShakenCase, ...]
    """Load cases with an oscillating load, each at its position of least dynamic stiffness."""
    position_loop: LoopStudy | None
    """Position loop with the least gain margin; None without a valve."""
    other_loops: tuple[LoopStudy, ...] = ()
    """Position loops with the least phase margin and the least bandwidth, if they differ from
    `position_loop`."""

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {name: plain(getattr(self, name)) for name in self.__dataclass_fields__}


def study(
    subject: PreparedDesign, v: Values, run: ModelRun, case: str | None
) -> DynamicsStudy | None:
    """Study the dynamics of a design in the load case with the least stiffness."""
    motion = run.motion
    index = v.cases.index(case) if case in v.cases else 0
    stroke = float(np.squeeze(run.geometry.stroke))
    weakest = of_case(run.places["weakest position"], index)
    position = sorted_unique(np.append(np.linspace(0.0, stroke, 61), weakest))
    model = motion.model(position)
    along = loop.load_mode(model=model)
    closed = dynamics.natural_frequency(
        stiffness=motion.springs.stiffness(position), mass=motion.mass
    )
    there = np.array([[weakest]])
    whole = _damping_ratio(motion, there, index)
    ends = _damping_ratio(replace(motion, damping=0.0 * motion.damping), there, index)
    design = subject.design
    shaken = _worst(run, "dynamic_stiffness", design)
    response_index = index if shaken is None else shaken[0]
    places = {
        "cap end": 0.0,
        "weakest position": of_case(run.places["weakest position"], response_index),
        "rod end": stroke,
    }
    models = {name: motion.model(np.array([[[x]]])) for name, x in places.items()}
    loops = _loops(run, design)
    polynomials = [
        (p, response_index) for m in models.values() for p in (m.characteristic, m.mobile)
    ]
    polynomials += [
        (p, position_loop.index) for position_loop in loops for p in position_loop.polynomials()
    ]
    frequencies = _frequencies(polynomials)
    loop_studies = [_loop(subject, v, run, position_loop, frequencies) for position_loop in loops]
    return DynamicsStudy(
        case=v.cases[index],
        mass=of_case(motion.mass, index),
        end=design.ports.end,
        position=position,
        closed_frequency=_row(closed, index, position),
        frequency=_row(along.natural_frequency, index, position),
        damping_ratio=_row(along.damping_ratio, index, position),
        friction_share=whole - ends,
        conductance_share=ends,
        poles=_poles(motion.model(there), index),
        frequencies=frequencies,
        response_case=v.cases[response_index],
        responses=tuple(
            _response(motion, name, x, response_index, models[name], frequencies)
            for name, x in places.items()
        ),
        distributed=_distributed(
            v, design, run, response_index, places["weakest position"], frequencies
        ),
        shaken=_shaken(design, run),
        position_loop=loop_studies[0] if loop_studies else None,
        other_loops=tuple(loop_studies[1:]),
    )


def _damping_ratio(motion: Motion, there: Array, index: int) -> float:
    """Damping ratio of one load case at a stroke position."""
    return of_case(loop.load_mode(model=motion.model(there)).damping_ratio, index)


def _loops(run: ModelRun, design: Design) -> list[_Loop]:
    """Position loops that have the least gain margin, phase margin or bandwidth."""
    rows: dict[tuple[int, str], tuple[str, ...]] = {}
    for metric in ("gain_margin", "phase_margin", "bandwidth"):
        row = _worst(run, metric, design)
        if row is not None:
            rows[row] = (*rows.get(row, ()), metric)
    return [_Loop.of(run, *row, governs=metrics) for row, metrics in rows.items()]


def _shaken(design: Design, run: ModelRun) -> tuple[ShakenCase, ...]:
    """All load cases with an oscillating load, each at its position of least dynamic stiffness."""
    shaken = []
    for i, case in enumerate(design.load_cases):
        if case.frequency is None:
            continue
        rows = run.computed.metrics["dynamic_stiffness"]
        place = min(rows, key=lambda name: of_case(rows[name], i))
        phase = of_case(run.computed.metrics["dynamic_phase"][place], i)
        shaken.append(ShakenCase(case.name, case.frequency, place, of_case(rows[place], i), phase))
    return tuple(shaken)


def _distributed(
    v: Values, design: Design, run: ModelRun, index: int, position: float, frequencies: Array
) -> Array | None:
    if not design.lines:
        return None
    return np.abs(dynamic_stiffness(v, design, run.state, run.motion, index, position, frequencies))


def _row(value: Array, index: int, along: Array) -> Array:
    """The values of one load case, at the points of `along`, from an array (cases, points)."""
    array = np.broadcast_to(np.atleast_2d(value), (np.shape(np.atleast_2d(value))[0], along.size))
    return array[min(index, array.shape[0] - 1)]


def _poles(model: linear.LinearActuator, index: int) -> tuple[Pole, ...]:
    poles = loop.poles(model=model)
    poles = poles[min(index, poles.shape[0] - 1), 0] if poles.ndim == 3 else poles.reshape(-1)
    rows = [
        Pole(float(abs(pole)) / (2 * pi), float(-pole.real / abs(pole)))
        for pole in poles
        if pole.imag >= 0 and abs(pole) > 0
    ]
    return tuple(sorted(rows, key=lambda pole: pole.frequency))


def _worst(run: ModelRun, metric: str, design: Design) -> tuple[int, str] | None:
    """Load case and location of a metric's least value; None if it was not computed."""
    shaken = [case.frequency is not None for case in design.load_cases]
    rows = [
        (float(value[i, 0]), i, place)
        for place, value in run.computed.metrics.get(metric, {}).items()
        for i in range(len(value))
        if metric != "dynamic_stiffness" or shaken[i]
    ]
    finite = [row for row in rows if np.isfinite(row[0])] or rows
    return min(finite)[1:] if finite else None


def _frequencies(polynomials: list[tuple[Polynomial, int]]) -> Array:
    """`FREQUENCIES` and points around every resonance and anti-resonance of these polynomials.

    `polynomials` pairs each polynomial with the index of its load case.
    """
    groups = [FREQUENCIES]
    for polynomial, index in polynomials:
        polynomial = polynomial[_integrators(polynomial) :]
        if len(polynomial) < 2:
            continue
        zeros = roots(polynomial)
        zeros = zeros.reshape(-1, zeros.shape[-1])
        oscillating = zeros[min(index, len(zeros) - 1)]
        oscillating = oscillating[oscillating.imag > 0]
        size = np.abs(oscillating) / (2 * pi)
        near = (size > FREQUENCIES[0]) & (size < FREQUENCIES[-1])
        width = np.clip(-oscillating.real / np.abs(oscillating), 1e-9, 0.05)
        groups.append((size * (1 + width * AROUND[:, None]))[:, near].reshape(-1))
    grid = sorted_unique(np.concatenate(groups))
    return grid[(grid >= FREQUENCIES[0]) & (grid <= FREQUENCIES[-1])]


def _integrators(polynomial: Polynomial) -> int:
    """Number of roots at zero of a polynomial, whose coefficients ascend in power of s."""
    nonzero = (
        k for k, coefficient in enumerate(polynomial) if np.any(np.asarray(coefficient) != 0)
    )
    return next(nonzero, len(polynomial))


def _response(
    motion: Motion,
    name: str,
    position: float,
    index: int,
    model: linear.LinearActuator,
    frequencies: Array,
) -> Response:
    parts = linear.dynamic_stiffness(model=model, frequency=frequencies.reshape(-1, 1, 1))
    value = np.asarray(parts.complex)
    value = value[:, min(index, value.shape[1] - 1), 0]
    return Response(
        place=name,
        position=position,
        magnitude=np.abs(value),
        phase=np.angle(value),
        static=of_case(motion.springs.stiffness(np.array([[position]])), index),
    )


@dataclass(frozen=True, slots=True)
class _Loop:
    """The open position loop in one load case at one position."""

    index: int
    place: str
    gain: float
    open_loop: loop.PositionOpenLoop
    governs: tuple[str, ...]

    @classmethod
    def of(cls, run: ModelRun, index: int, place: str, governs: tuple[str, ...]) -> _Loop:
        """Build the loop for a location in results, such as "extending, 50 % of the stroke"."""
        direction, _, where = place.partition(", ")
        position = np.asarray(run.places[where])
        position_open_loop = run.motion.position_loop(
            position, extending=np.array(direction == "extending")
        )
        gain = of_case(run.computed.metrics["position_gain"][""], index)
        return cls(index, place, gain, position_open_loop, governs)

    def polynomials(self) -> list[Polynomial]:
        """Numerator and denominator of the open loop, and denominator of the closed loop."""
        open_loop = self.open_loop
        return [
            open_loop.numerator,
            open_loop.denominator,
            add(open_loop.denominator, scale(open_loop.numerator, self.gain)),
        ]


def _loop(
    subject: PreparedDesign, v: Values, run: ModelRun, at: _Loop, frequencies: Array
) -> LoopStudy:
    """Frequency response of a position loop; margins and bandwidth are taken from the metrics."""

    def value_of(metric: str) -> float:
        return of_case(run.computed.metrics[metric][at.place], at.index)

    open_loop, gain = at.open_loop, at.gain
    limit = loop.ultimate_gain(loop=open_loop)
    figures = loop.margins(loop=open_loop, gain=gain)
    s = 2 * pi * frequencies.reshape(-1, 1, 1)
    top, low = at_frequency(open_loop.numerator, s), at_frequency(open_loop.denominator, s)
    response = gain * top.complex / low.complex
    response = response[:, min(at.index, response.shape[1] - 1), 0]
    crossover, width = of_case(figures.crossover, at.index), value_of("bandwidth")
    return LoopStudy(
        case=v.cases[at.index],
        place=at.place,
        gain=gain,
        tuned=subject.design.control is None or subject.design.control.gain is None,
        ultimate_gain=value_of("ultimate_gain"),
        ultimate_frequency=of_case(limit.frequency, at.index),
        gain_margin=value_of("gain_margin"),
        phase_margin=value_of("phase_margin"),
        crossover=crossover if np.isfinite(crossover) else None,
        bandwidth=width if np.isfinite(width) and width > 0 else None,
        governs=at.governs,
        open_magnitude=np.abs(response),
        open_phase=_unwrapped(response),
        closed_magnitude=np.abs(response / (1 + response)),
    )


def _unwrapped(response: Array) -> Array:
    """Phase of a response without jumps by 2 pi; the integrator makes it start near -pi/2."""
    phase = np.unwrap(np.angle(response))
    return phase - 2 * pi * np.round((phase[0] + pi / 2) / (2 * pi))
