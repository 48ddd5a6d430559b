"""Linear dynamics in an evaluation: modes, dynamic stiffness and the position loop.

One model (`models.linear`) serves them all. Every figure is asked at several places of the stroke
and, for the loop, in both directions of the spool; each is a row, so the optimiser sees the worst
without a smooth maximum.
"""

from __future__ import annotations

from collections.abc import Container, Iterable
from dataclasses import dataclass

import numpy as np

from ..design.model import Design
from ..models import dynamics, line_ends, linear, loop, valve
from ..models.line_ends import LineEnd
from ..models.linear import LinearActuator, Side
from ..numeric import Array, angle, magnitude, maximum, real, where
from . import circuit
from .circuit import CHAMBERS, Branch, Chamber
from .rows import Computed
from .springs import Springs
from .state import State
from .values import Values

SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Where on the stroke dynamics are asked, beside the weakest position."""


@dataclass(frozen=True, slots=True)
class Motion:
    """What the linear model needs beside the position; arrays (cases, designs)."""

    springs: Springs
    mass: Array
    damping: Array
    """Incremental friction and oil damping at the piston [N s/m]."""
    leakage: Array
    branches: dict[Chamber, Branch]
    throttles: dict[Chamber, Array]
    """Conductance of the throttle at its operating point [m^3/s/Pa]; empty without one."""
    accumulators: dict[Chamber, tuple[LineEnd, ...]]
    """Accumulators on the lines."""
    ends: dict[Chamber, LineEnd]
    """What ends the lines while the load shakes the actuator, accumulators included."""
    centred: dict[Chamber, LineEnd]
    """The valve at its centre as a line end; empty without one."""
    slopes: dict[bool, valve.ValveSlopes]
    """Valve linearised at the centre, extending and retracting; empty without a valve."""
    spool: tuple[Array, Array] | None

    def model(self, position: Array, *, extending: Array | None = None) -> LinearActuator:
        """Linear model at a position: load shaking, or driven by the valve in one direction.

        `extending` is True, False, or an array of them.
        """
        s = self.springs
        near = s.total().at(position, s.geometry.stroke)
        driven = extending is not None
        sides = {}
        for chamber, area, whole in zip(
            CHAMBERS, (s.geometry.area_a, s.geometry.area_b), (near.a, near.b), strict=True
        ):
            branch = self.branches[chamber]
            end, gain = self.ends[chamber], 0.0
            if extending is not None:
                out, back = self.slopes[True], self.slopes[False]
                if chamber == "a":
                    gain = where(extending, out.gain_a, back.gain_a)
                else:
                    gain = -where(extending, out.gain_b, back.gain_b)
                end = line_ends.parallel_ends(self.centred[chamber], *self.accumulators[chamber])
            sides[chamber] = Side(
                area=area,
                compliance=whole - branch.far,
                throttle=self.throttles.get(chamber),
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
            flexibility=s.flexibility(),
        )

    def position_loop(self, position: Array, *, extending: Array) -> loop.OpenLoop:
        """Open position loop at unit gain."""
        assert self.spool is not None
        frequency, damping = self.spool
        return loop.open_loop(
            model=self.model(position, extending=extending),
            natural_frequency=frequency,
            damping_ratio=damping,
        )

    def mode(self, model: LinearActuator, position: Array) -> loop.Mode:
        """Mode of the load on the actuator as it is held."""
        closed = dynamics.natural_frequency(
            stiffness=self.springs.balance(position), mass=self.mass
        )
        return loop.load_mode(model=model, near=closed)


def derive(
    v: Values,
    design: Design,
    state: State,
    springs: Springs,
    branches: dict[Chamber, Branch],
    mass: Array,
    damping: Array,
    leakage: Array,
) -> Motion:
    """The linear model's numbers in every load case."""
    slopes = circuit.valve_slopes(v, design, state)
    centred = circuit.centred_valve(v, design, slopes)
    accumulators = {
        chamber: circuit.accumulator_ends(v, design, state, chamber) for chamber in CHAMBERS
    }
    return Motion(
        springs=springs,
        mass=mass,
        damping=damping,
        leakage=leakage,
        branches=branches,
        throttles=circuit.throttle_conductances(v, design, state, springs.geometry),
        accumulators=accumulators,
        ends={
            chamber: circuit.line_end(v, design, centred, accumulators[chamber], chamber)
            for chamber in CHAMBERS
        },
        centred=centred,
        slopes=slopes,
        spool=(v["valve.natural_frequency"], v["valve.damping_ratio"]) if design.valve else None,
    )


def _places(stroke: Array, weakest: Array) -> tuple[list[str], Array]:
    """Names and positions (places, cases, designs) where dynamics are asked."""
    names = [f"{100 * share:.0f} % of the stroke" for share in SHARES] + ["weakest position"]
    positions = [share * stroke for share in SHARES] + [weakest]
    shape = np.broadcast_shapes(*(np.shape(p) for p in positions), (1, 1))
    return names, np.stack([np.broadcast_to(p, shape) for p in positions])


def compute(
    v: Values,
    design: Design,
    motion: Motion,
    weakest: Array,
    wanted: Container[str] | None,
    out: Computed,
) -> dict[str, Array]:
    """Damping ratio, dynamic stiffness and the position loop; returns the places asked.

    Poles and margins cost more than all else: only those in `wanted` are found (None: all).
    """
    names, positions = _places(motion.springs.geometry.stroke, weakest)
    model = motion.model(positions)
    if wanted is None or "damping_ratio" in wanted:
        mode = motion.mode(model, positions)
        out.put("damping_ratio", _by_place(names, mode.damping_ratio, positions))
    _dynamic_stiffness(v, design, model, names, positions, out)
    if motion.spool is None:
        for name in LOOP_METRICS:
            out.skip(name, "no valve stated: add valve")
    elif wanted is None or any(name in wanted for name in LOOP_METRICS):
        _position_loop(v, design, motion, names, positions, wanted, out)
    return dict(zip(names, positions, strict=True))


def _by_place(names: list[str], value: Array, positions: Array) -> dict[str, Array]:
    """A value at every place; where nothing depends on the place, the same at all."""
    shape = np.broadcast_shapes(np.shape(value), positions.shape)
    return dict(zip(names, np.broadcast_to(value, shape), strict=True))


LOOP_METRICS = ("ultimate_gain", "position_gain", "gain_margin", "phase_margin", "bandwidth")


def _dynamic_stiffness(
    v: Values,
    design: Design,
    model: LinearActuator,
    names: list[str],
    positions: Array,
    out: Computed,
) -> None:
    shaken = np.array([case.frequency is not None for case in design.load_cases])
    if not shaken.any():
        for name in ("dynamic_stiffness", "dynamic_phase"):
            out.skip(name, "no load case shakes: add load_cases[NAME].frequency")
        return
    parts = linear.dynamic_stiffness(model=model, frequency=v.case("frequency", 1.0))
    values = magnitude(parts.real, parts.imaginary)
    out.put("dynamic_stiffness", _by_place(names, values, positions), cases=shaken)
    phase = angle(parts.imaginary, parts.real)
    out.put("dynamic_phase", _by_place(names, phase, positions), cases=shaken)


def _position_loop(
    v: Values,
    design: Design,
    motion: Motion,
    names: list[str],
    positions: Array,
    wanted: Container[str] | None,
    out: Computed,
) -> None:
    """Margins and bandwidth at every place, in both directions of the spool."""
    directions = np.array([True, False]).reshape(-1, 1, 1, 1)
    one = motion.position_loop(positions, extending=directions)
    limit = loop.ultimate_gain(loop=one)
    out.why["ultimate_gain"] = out.why["gain_margin"] = "no gain makes the loop swing"
    out.why["phase_margin"] = "no crossover: the open loop stays below one"
    stated = design.control is not None and design.control.gain is not None
    gain = v["control.gain"] if stated else maximum(0.5 * _least(limit.gain), LEAST_GAIN)
    margin = limit.gain / gain
    found = loop.margins(loop=one, gain=gain)

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
    put("phase_margin", where(real(margin) > 1, found.phase_margin, -found.phase_margin))
    put("bandwidth", where(real(margin) > 1, found.bandwidth, 0.0))  # none where the loop swings
    out.put("position_gain", gain)


def _weakest_gain(motion: Motion) -> Array:
    """Smallest flow gain of the valve over chambers and directions, in every case."""
    gains = [gain for one in motion.slopes.values() for gain in (one.gain_a, one.gain_b)]
    return np.min(np.stack(np.broadcast_arrays(*[np.real(gain) for gain in gains])), axis=0)


LEAST_GAIN = 1e-3
"""Gain where every gain would swing (V/m): nothing follows, and the figures stay finite."""


def _least(values: Array) -> Array:
    """Smallest over directions, places and cases, by real part: (designs,)."""
    flat = values.reshape(-1, values.shape[-1])
    best = np.argmin(real(flat), axis=0)[None]
    return np.take_along_axis(flat, best, axis=0)[0]


LONGEST = 0.1
"""Longest line over the wavelength for one lumped element (choice: 2 % in its impedance)."""


def warnings(
    v: Values, design: Design, motion: Motion, state: State, out: Computed
) -> Iterable[tuple[str, str]]:
    """(metric, sentence) where the linear model is used outside its range."""
    slowest = float(np.min(np.real(motion.damping)))
    if slowest < 0:
        yield (
            "damping_ratio",
            f"friction falls with speed ({slowest:.3g} N*s/m): the load may stick and slip",
        )
    if "ultimate_gain" in out.metrics:
        least = min(float(np.min(np.real(x))) for x in out.metrics["ultimate_gain"].values())
        margin = min(float(np.min(np.real(x))) for x in out.metrics["gain_margin"].values())
        if least > 0 and margin <= 1:
            yield "bandwidth", "the position loop swings at this gain: its bandwidth counts as 0"
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
                f"{case}: the held force takes the whole supply pressure, the valve moves nothing",
            )
        if least == 0:
            yield (
                "ultimate_gain",
                "no gain is stable: the load grows by itself, or leakage across the piston "
                "outweighs the centred valve's; give the valve leakage or the load damping",
            )
    for i, one in enumerate(design.ports.accumulators):
        held = state.holding_a if one.chamber == "a" else state.holding_b
        precharge = float(np.max(np.real(v[f"ports.accumulators[{i}].precharge"])))
        if float(np.min(np.real(held))) <= precharge:
            yield (
                "",
                f"ports.accumulators[{i}]: its precharge is not below the pressure it holds in "
                "every case: it takes no oil there",
            )
    asked = {f"load case {case.name}": case.frequency or 0.0 for case in design.load_cases}
    if motion.spool is not None:
        asked["the valve's spool"] = float(np.max(np.real(motion.spool[0])))
    what, fastest = max(asked.items(), key=lambda one: one[1])
    for place, resonance in out.metrics.get("line_resonance", {}).items():
        limit = 4 * LONGEST * float(np.min(np.real(resonance)))
        if fastest > limit:
            metric = "dynamic_stiffness" if "dynamic_stiffness" in out.metrics else "bandwidth"
            yield (
                metric,
                f"{place}: one lumped element is good to {limit:.0f} Hz, {what} asks for "
                f"{fastest:.4g} Hz: split the line or read the figure as rough",
            )
