"""Linear dynamics of the actuator: modes, dynamic stiffness and the position loop.

All three use one model (`models.linear`). Results are computed at several stroke positions; those
of the position loop also for both spool directions. Each combination of position and direction is a
separate limit for the optimiser, which therefore needs no smooth approximation of a maximum.
"""

from __future__ import annotations

from collections.abc import Container, Iterable

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, angle, magnitude, maximum, real, where
from ..design.model import Design
from ..design.valve import Spool, Valve
from ..models import dynamics, line_ends, linear, loop
from ..models.line_ends import LineEnd
from ..models.linear import LinearActuator, Side
from ..models.metering_curve import MeteringCurve
from ..models.play import band_of_position
from .circuit import (
    CHAMBERS,
    Chamber,
    ChamberLines,
    LinearValve,
    Ways,
    accumulator_ends,
    line_end,
    linear_valve,
    of_valve,
    throttle_conductances,
)
from .limits import MetricArrays
from .spool import EDGES, spool_bands, spool_motion
from .springs import Springs, weakest_per_chamber
from .state import LoadState
from .values import Values

SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Positions of the dynamic results, as shares of the stroke. Results are also computed at the
position of least stiffness."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Inputs of the linear model that do not depend on the position; arrays (cases, designs)."""

    springs: Springs
    mass: Array
    damping: Array
    """Damping of oil and friction at the piston: increase of force with speed [N s/m]."""
    leakage: Array
    branches: dict[Chamber, ChamberLines]
    throttles: dict[Chamber, Ways]
    """Conductance of the throttles at their operating point [m^3/s/Pa]; empty without throttles."""
    push: Array
    """Whether the piston extends in each load case. For an oscillating load, this direction selects
    the conductance of the throttles."""
    held: dict[Chamber, LineEnd]
    """Conditions at the ends of the lines, with accumulators, while an oscillating load excites the
    actuator."""
    accumulators: dict[Chamber, tuple[LineEnd, ...]]
    """Accumulators at the ports."""
    valve: LinearValve | None
    spool: tuple[Array, Array] | None

    def model(self, position: Array, *, extending: Array | None = None) -> LinearActuator:
        """Linear model at a position, excited by the load or driven by the valve.

        If the valve drives it, `extending` is its direction: True, False, or an array of booleans.
        None: the load excites the actuator.
        """
        s = self.springs
        near = s.total().at(position, s.geometry.stroke)
        driven = extending is not None
        way = extending if driven else self.push
        sides = {}
        for chamber, area, whole in zip(
            CHAMBERS, (s.geometry.area_a, s.geometry.area_b), (near.a, near.b), strict=True
        ):
            branch, throttle = self.branches[chamber], self.throttles.get(chamber)
            end, gain = self.held[chamber], 0.0
            if extending is not None and self.valve is not None:
                end = self.valve.driving(chamber, extending)
                end = line_ends.parallel_ends(end, *self.accumulators[chamber])
                gain = self.valve.gains[chamber].toward(extending)
            sides[chamber] = Side(
                area=area,
                compliance=whole - branch.far,
                throttle=None if throttle is None else throttle.toward(way),
                resistance=branch.resistance,
                inertance=branch.inertance,
                far_compliance=branch.far,
                end=end,
                flow_gain=gain,
            )
        return linear.linear_actuator(
            side_a=sides["a"],
            side_b=sides["b"],
            mass=self.mass,
            damping=self.damping,
            coupling=near.ab,
            leakage=self.leakage,
            seal_stiffness=0.0 if s.seals is None or driven else s.seals,
            flexibility=s.series_compliance(),
        )

    def position_loop(self, position: Array, *, extending: Array) -> loop.PositionOpenLoop:
        """Open position loop with a controller gain of 1."""
        assert self.spool is not None
        frequency, damping = self.spool
        return loop.open_loop(
            model=self.model(position, extending=extending),
            natural_frequency=frequency,
            damping_ratio=damping,
        )

    def closed_frequency(self, position: Array) -> Array:
        """Natural frequency with closed ports [Hz].

        Each chamber is a separate spring, even if the design states another formula for the
        stiffness (`stiffness.topology`).
        """
        return dynamics.natural_frequency(
            stiffness=self.springs.per_chamber_stiffness(position), mass=self.mass
        )


def derive(
    v: Values,
    design: Design,
    state: LoadState,
    springs: Springs,
    branches: dict[Chamber, ChamberLines],
    mass: Array,
    damping: Array,
    leakage: Array,
) -> Motion:
    """Inputs of the linear model in every load case."""
    holding = linear_valve(v, design, state, leakage)
    accumulators = {chamber: accumulator_ends(v, design, state, chamber) for chamber in CHAMBERS}
    return Motion(
        springs=springs,
        mass=mass,
        damping=damping,
        leakage=leakage,
        branches=branches,
        throttles=throttle_conductances(v, design, state, springs.geometry),
        push=state.push,
        held={
            chamber: line_end(v, design, holding, accumulators[chamber], chamber)
            for chamber in CHAMBERS
        },
        accumulators=accumulators,
        valve=holding,
        spool=spool_motion(of_valve(v)) if design.valve else None,
    )


def _places(stroke: Array, weakest: Array) -> tuple[list[str], Array]:
    """Names of the positions of dynamic results, and the positions (names, cases, designs)."""
    names = [f"{100 * share:.0f} % of the stroke" for share in SHARES] + ["weakest position"]
    positions = [share * stroke for share in SHARES] + [weakest]
    shape = np.broadcast_shapes(*(np.shape(p) for p in positions), (1, 1))
    return names, np.stack([np.broadcast_to(p, shape) for p in positions])


def compute(
    v: Values,
    design: Design,
    motion: Motion,
    wanted: Container[str] | None,
    out: MetricArrays,
) -> dict[str, Array]:
    """Compute damping ratio, dynamic stiffness and position loop; return the stroke positions used.

    Poles, ultimate gains and stability margins are costly: only those in `wanted` are computed
    (None: all).
    """
    weakest = weakest_per_chamber(motion.springs)
    names, positions = _places(motion.springs.geometry.stroke, weakest)
    model = motion.model(positions)
    if wanted is None or "damping_ratio" in wanted:
        mode = loop.load_mode(model=model)
        out.put("damping_ratio", _by_place(names, mode.damping_ratio, positions))
    _dynamic_stiffness(v, design, model, names, positions, out)
    if motion.spool is None:
        for name in LOOP_METRICS:
            out.skip(name, "no valve stated: add valve")
    elif wanted is None or any(name in wanted for name in LOOP_METRICS):
        _position_loop(v, design, motion, names, positions, wanted, out)
    return dict(zip(names, positions, strict=True))


def _by_place(names: list[str], value: Array, positions: Array) -> dict[str, Array]:
    """Split a value into one entry per stroke position."""
    shape = np.broadcast_shapes(np.shape(value), positions.shape)
    return dict(zip(names, np.broadcast_to(value, shape), strict=True))


LOOP_METRICS = ("ultimate_gain", "position_gain", "gain_margin", "phase_margin", "bandwidth")


def _dynamic_stiffness(
    v: Values,
    design: Design,
    model: LinearActuator,
    names: list[str],
    positions: Array,
    out: MetricArrays,
) -> None:
    excited = np.array([case.frequency is not None for case in design.load_cases])
    if not excited.any():
        for name in ("dynamic_stiffness", "dynamic_phase"):
            out.skip(name, "no load case has an oscillating load: add load_cases[NAME].frequency")
        return
    parts = linear.dynamic_stiffness(model=model, frequency=v.case("frequency", 1.0))
    values = magnitude(parts.real, parts.imaginary)
    out.put("dynamic_stiffness", _by_place(names, values, positions), cases=excited)
    phase = angle(parts.imaginary, parts.real)
    out.put("dynamic_phase", _by_place(names, phase, positions), cases=excited)


def _position_loop(
    v: Values,
    design: Design,
    motion: Motion,
    names: list[str],
    positions: Array,
    wanted: Container[str] | None,
    out: MetricArrays,
) -> None:
    """Compute stability margins and bandwidth at every position, in both spool directions."""
    directions = np.array([True, False]).reshape(-1, 1, 1, 1)
    position_open_loop = motion.position_loop(positions, extending=directions)
    limit = loop.ultimate_gain(loop=position_open_loop)
    out.why["ultimate_gain"] = out.why["gain_margin"] = "the loop is stable at any gain"
    out.why["phase_margin"] = "no crossover frequency: the open-loop gain stays below 1"
    stated = design.control is not None and design.control.gain is not None
    gain = v["control.gain"] if stated else maximum(0.5 * _least(limit.gain), LEAST_GAIN)
    margin = limit.gain / gain

    def put(name: str, value: Array) -> None:
        value = np.broadcast_to(value, np.broadcast_shapes(np.shape(value), (2, *positions.shape)))
        rows = {
            f"{word}, {place}": value[i, k]
            for i, word in enumerate(("extending", "retracting"))
            for k, place in enumerate(names)
        }
        out.put(name, rows)

    put("ultimate_gain", limit.gain)
    put("gain_margin", margin)
    out.put("position_gain", gain)
    if wanted is None or "phase_margin" in wanted or "bandwidth" in wanted:
        margins = loop.margins(loop=position_open_loop, gain=gain)
        put("phase_margin", where(real(margin) > 1, margins.phase_margin, -margins.phase_margin))
        # an unstable loop has no bandwidth
        put("bandwidth", where(real(margin) > 1, margins.bandwidth, 0.0))


LEAST_GAIN = 1e-3
"""Gain [V/m] that replaces a default gain of zero, for a loop that is unstable at any gain. It is
too low for tracking, but results are finite."""


def _least(values: Array) -> Array:
    """Least value over all directions, positions and load cases (by real part), (designs,)."""
    flat = values.reshape(-1, values.shape[-1])
    best = np.argmin(real(flat), axis=0)[None]
    return np.take_along_axis(flat, best, axis=0)[0]


LEAST_DAMPING = 0.005
"""Damping ratio below which a loop counts as poorly damped (our choice)."""
NEAR_RESONANCE = 0.8
"""Ratio of bandwidth to natural frequency above which the loop is near resonance (our choice)."""
LONGEST = 0.1
"""Largest length of a chamber's lines, in wavelengths, for which a lumped element is valid. Our
choice: at this length, the error in admittance is 3 % for a closed line and 7 % for a line with
constant pressure at its end."""


def warnings(
    v: Values, design: Design, motion: Motion, state: LoadState, out: MetricArrays
) -> Iterable[tuple[str, str]]:
    """Yield (metric, sentence) for each use of the linear model outside its valid range."""
    slowest = float(np.min(np.real(motion.damping)))
    if slowest < 0:
        yield (
            "damping_ratio",
            f"friction falls with speed (slope {slowest:.3g} N*s/m): stick-slip is possible",
        )
    if "ultimate_gain" in out.metrics:
        yield from _loop(v, motion, out)
        valve = design.valve
        if valve is not None and valve.tank_leakage_drop not in (None, valve.leakage_drop):
            yield (
                "ultimate_gain",
                "the valve's tank edges and supply edges leak differently, but the holding "
                "pressures are computed for equal edges; only a simulation takes the difference "
                "into account",
            )
        if valve is not None and valve.spool is not None and valve.spool.type == "lapped":
            yield from _laps(v, valve.spool)
        if valve is not None:
            yield from _curves(valve)
            yield from _hysteresis(v, out)
    yield from _ports(v, design, motion, state)
    yield from _lines(design, motion, out)


def _laps(v: Values, spool: Spool) -> Iterable[tuple[str, str]]:
    """Warn of edges that differ, and of overlaps, within which the position is not controlled."""
    edges = [getattr(spool, key) for key in EDGES.values()]
    if any(edge != edges[0] for edge in edges):
        yield "ultimate_gain", UNEQUAL
    overlaps = [
        float(np.max(np.real(v.get(f"valve.spool.{key}.overlap", v["valve.spool.overlap"]))))
        for key in EDGES.values()
    ]
    lost = max((point.signal for point in spool.curve if point.flow == 0), default=0.0)
    if max(overlaps) > 0:
        lost = max(overlaps) / float(np.min(np.real(v["valve.spool.stroke"])))
    if lost > 0:
        yield "bandwidth", _dead_band_text(lost)


DEAD_BAND = 0.02
"""Share of the full signal within which the edges of a flow curve stay closed, from which a dead
band is reported (our choice)."""
UNEQUAL = (
    "the valve's four edges differ, but the holding pressures are computed for equal edges; only a "
    "simulation takes the difference into account"
)
"""Warning about a valve with unequal edges."""


def _dead_band_text(lost: float) -> str:
    """Warning about a dead band, a share of the full signal."""
    return (
        f"the valve's dead band is {lost:.2g} of its full signal; within it the valve hardly "
        "moves the load. Gains and margins apply beyond it, where the edges begin to open"
    )


def _curves(valve: Valve) -> Iterable[tuple[str, str]]:
    """Warn of edges that differ, and of a dead band, of a valve with curves or coefficients."""
    coefficients, table = valve.edge_coefficients, valve.flow_table
    different = coefficients is not None and len(set(dict(coefficients).values())) > 1
    if table is not None:
        edges = [table.points(key, valve.signal) for key in EDGES.values()]
        different = any(points != edges[0] for points in edges)
        lost = min(MeteringCurve.through(*points).start for points in edges)
        if lost > DEAD_BAND:
            yield "bandwidth", _dead_band_text(lost)
    if different:
        yield "ultimate_gain", UNEQUAL


def _hysteresis(v: Values, out: MetricArrays) -> Iterable[tuple[str, str]]:
    """Say that the margins leave out hysteresis and threshold, and give their position error."""
    bands = spool_bands(of_valve(v))
    if bands is None or np.all(np.real(bands[1]) == 0):
        return
    gain = float(np.min(np.real(out.metrics["position_gain"][""])))
    threshold, hysteresis = (
        1e3 * float(np.max(np.real(band_of_position(signal_band=band, gain=gain))))
        for band in bands
    )
    yield (
        "position_gain",
        "gain margin, phase margin and bandwidth leave out the valve's hysteresis and threshold; a "
        f"proportional position loop with a gain of {gain:.4g} V/m stops up to "
        f"{hysteresis / 2:.3g} mm from its reference, and does not respond to reversals by less "
        f"than {threshold:.3g} mm. A simulation includes both, and shows whether the loop "
        "oscillates",
    )


def _weakest_gain(motion: Motion) -> Array:
    """Smallest flow gain of the valve for any chamber and direction, in every load case."""
    assert motion.valve is not None
    gains = [np.abs(np.real(gain)) for ways in motion.valve.gains.values() for gain in ways]
    return np.min(np.stack(np.broadcast_arrays(*gains)), axis=0)


def _loop(v: Values, motion: Motion, out: MetricArrays) -> Iterable[tuple[str, str]]:
    """Warn if the position loop is unstable, poorly damped or near resonance, or cannot move."""
    damped = min(float(np.min(np.real(x))) for x in out.metrics["damping_ratio"].values())
    if 0 <= damped < LEAST_DAMPING:
        yield (
            "damping_ratio",
            f"the load has almost no damping (ratio {damped:.1g}), so only a slow position loop "
            "is stable; to add damping, state valve.leakage_flow with ports.end: valve, or "
            "piston.leakage_conductance",
        )
    weakest = weakest_per_chamber(motion.springs)
    resonance = float(np.min(np.real(motion.closed_frequency(weakest))))
    widths = [float(np.max(np.real(x))) for x in out.metrics["bandwidth"].values()]
    near = sum(width > NEAR_RESONANCE * resonance for width in widths)
    if near:
        yield (
            "bandwidth",
            f"for {near} of {len(widths)} combinations of position and direction, the closed "
            "loop's gain falls to -3 dB only near or above the load's resonance; at that "
            "frequency the load oscillates and does not follow the signal",
        )
    least = min(float(np.min(np.real(x))) for x in out.metrics["ultimate_gain"].values())
    margin = min(float(np.min(np.real(x))) for x in out.metrics["gain_margin"].values())
    if least > 0 and margin <= 1:
        yield "bandwidth", "the position loop is unstable at this gain: its bandwidth counts as 0"
    stalled = [
        case
        for case, gain in zip(
            v.cases, np.broadcast_to(_weakest_gain(motion), (len(v.cases), 1)), strict=True
        )
        if gain[0] == 0
    ]
    for case in stalled:
        yield (
            "bandwidth",
            f'in load case "{case}", holding the force takes the whole supply pressure, which '
            "leaves the valve no pressure to move the rod",
        )
    if least == 0:
        yield (
            "ultimate_gain",
            "the loop is unstable at any gain: either the load itself is unstable, or the piston "
            "leaks more than the valve; add valve leakage or load damping",
        )


def _ports(
    v: Values, design: Design, motion: Motion, state: LoadState
) -> Iterable[tuple[str, str]]:
    """Warn of valves, throttles and accumulators whose effect may not be as expected."""
    if design.valve is not None and design.ports.end == "closed":
        for metric in ("damping_ratio", "dynamic_stiffness"):
            yield (
                metric,
                "ports.end is closed, so damping ratio and dynamic stiffness exclude the leakage "
                'of the holding valve; write "ports.end: valve" to include it',
            )
    slow = np.ravel(np.real(state.speed)) == 0
    excited = [case.frequency is not None for case in design.load_cases]
    if motion.throttles and np.any(slow & np.array(excited)):
        yield (
            "dynamic_stiffness",
            "a load case has a frequency but no speed, so its throttle is calculated for very "
            "slow (creeping) flow",
        )
    for i, accumulator in enumerate(design.ports.accumulators):
        held = state.holding_a if accumulator.chamber == "a" else state.holding_b
        precharge = float(np.max(np.real(v[f"ports.accumulators[{i}].precharge"])))
        if float(np.min(np.real(held))) <= precharge:
            yield (
                "",
                f"ports.accumulators[{i}]: in at least one load case the holding pressure does not "
                "exceed the gas precharge, so the accumulator takes in no oil",
            )


def _lines(design: Design, motion: Motion, out: MetricArrays) -> Iterable[tuple[str, str]]:
    """Warn of lines that are too long for a lumped element at the frequencies of interest."""
    frequencies = {f"load case {case.name}": case.frequency or 0.0 for case in design.load_cases}
    if motion.spool is not None:
        frequencies["the valve's spool"] = float(np.max(np.real(motion.spool[0])))
    source, fastest = max(frequencies.items(), key=lambda item: item[1])
    for place, resonance in out.metrics.get("line_resonance", {}).items():
        limit = 4 * LONGEST * float(np.min(np.real(resonance)))
        if fastest > limit:
            metric = "dynamic_stiffness" if "dynamic_stiffness" in out.metrics else "bandwidth"
            yield (
                metric,
                f"{place} is modelled as a single lumped element, valid up to {limit:.0f} Hz, but "
                f"{source} has {fastest:.4g} Hz; the result is rough, and the report compares it "
                "with transmission lines",
            )
