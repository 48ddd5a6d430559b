"""Servo circuits in the time domain, written a second time straight from the physics.

Nothing here comes from the package. A circuit is valve, two oil volumes, an actuator, a
supply and a controller. Radau integrates it from event to event (end stops, command limit,
integrator hold, steps of the inputs), so no step crosses a jump. SI, gauge pressures.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve
from servo_oracle_parts import (
    ConstantSupply,
    ControlledPump,
    Controller,
    Cylinder,
    FixedPump,
    Motor,
    Oil,
    Piece,
    Signal,
    Valve,
    line,
    steps,
)

Floats = NDArray[np.float64]

STATE_SIZES = {
    "position": (1e-13, 1e-6),
    "velocity": (1e-10, 1e-6),
    "bristle": (1e-14, 1e-9),
    "p_a": (1e-2, 1e3),
    "p_b": (1e-2, 1e3),
    "spool": (1e-9, 1e-4),
    "spool_rate": (1e-6, 1e-2),
    "integral": (1e-12, 1e-6),
    "filtered_error": (1e-13, 1e-6),
    "p_supply": (1e-2, 1e3),
    "pump_flow": (1e-13, 1e-8),
}  # absolute tolerance, step of a difference quotient
INTEGRAL_TOLERANCES = {
    "supply": 1e-8,
    "return": 1e-8,
    "edge_pa": 1e-8,
    "edge_at": 1e-8,
    "edge_pb": 1e-8,
    "edge_bt": 1e-8,
    "leakage": 1e-8,
    "friction": 1e-8,
    "load": 1e-8,
    "stop": 1e-8,
    "oil_a": 1e-8,
    "oil_b": 1e-8,
    "inflow_a": 1e-15,
    "inflow_b": 1e-15,
    "pump": 1e-8,
    "relief": 1e-8,
    "line": 1e-8,
}  # J; m^3 of oil at zero pressure
STATES, INTEGRALS = tuple(STATE_SIZES), tuple(INTEGRAL_TOLERANCES)
FORCE_SLACK = 1e-6  # N: keeps a piston at rest on a stop from switching for ever
LOST = 1e-3  # N, V or V/s: a guard this far below zero was passed unseen
LIMIT_SLACK = 1e-9  # of the command limit: the same for a command resting on it


class Mode(NamedTuple):
    """What stays fixed between two events."""

    cap: bool = False  # in contact
    rod: bool = False
    limit: int = 0  # 0 inside; +-1 beyond, integral held; +-2 sliding on the command limit


class Point(NamedTuple):
    """Everything the circuit does at one instant."""

    rates: list[float]
    error: float
    raw: float  # command before the limit
    raw_rate: float  # its rate without the integral part
    gaps: tuple[float, float]  # > 0: the stop pushes
    signals: dict[str, float]


@dataclass(frozen=True)
class Circuit:
    """One servo; without a controller the reference is the command in volts."""

    oil: Oil
    valve: Valve
    actuator: Cylinder | Motor
    supply: ConstantSupply | FixedPump | ControlledPump
    reference: Signal
    load: Signal = field(default_factory=lambda: steps((0.0, 0.0)))
    controller: Controller | None = None
    return_pressure: float = 0.0

    def evaluate(
        self, time: float, y: Any, inputs: tuple[Piece, Piece], mode: Mode, side: float = 0.0
    ) -> Point:
        """Evaluate every equation once."""
        x, v, z, pa, pb, o, o_rate, integral, filtered, ps, q_pump = map(float, y[: len(STATES)])
        act, valve, pt = self.actuator, self.valve, self.return_pressure
        (target, target_rate), (load, _) = inputs[0](time), inputs[1](time)

        edges = valve.edges(o, ps, pa, pb, pt, side)
        q_a, q_b = edges[0] - edges[1], edges[2] - edges[3]
        q_p, q_t = edges[0] + edges[2], edges[1] + edges[3]
        ps_rate, pump_rate, given, relief = self.supply.rates(ps, q_pump, q_p)

        leak = act.leakage * (pa - pb)
        z_rate, friction = act.resistance(v, z, pa, pb)
        cap, rod, cap_gap, rod_gap = act.stops(x, v)
        stop = (cap if mode.cap else 0.0) - (rod if mode.rod else 0.0)
        drive = pa * act.area_a - pb * act.area_b
        acceleration = (drive - friction + stop - load) / act.mass
        (vol_a, vol_b), swept_a, swept_b = act.volumes(x), act.area_a * v, act.area_b * v
        squeeze_a, squeeze_b = q_a - leak - swept_a, q_b + leak + swept_b  # what compresses
        pa_rate = squeeze_a * self.oil.modulus(pa) / vol_a
        pb_rate = squeeze_b * self.oil.modulus(pb) / vol_b
        in_a = self.oil.density_ratio(pa) * (q_a - leak - act.carried * swept_a)
        in_b = self.oil.density_ratio(pb) * (q_b + leak + act.carried * swept_b)

        error = raw_rate = i_rate = filter_rate = 0.0
        raw, limit, s = target, valve.limit, math.copysign(1, mode.limit)
        command = min(max(raw, -limit), limit)
        if self.controller:
            c, positional = self.controller, self.controller.of == "position"
            error = target - (x if positional else v)
            error_rate = target_rate - (v if positional else acceleration)
            filter_rate = (error - filtered) / c.filter_time if c.kd else 0.0
            raw = c.kp * error + c.ki * integral + c.kd * filter_rate
            raw_rate = c.kp * error_rate
            raw_rate += c.kd * (error_rate - filter_rate) / c.filter_time
            if abs(mode.limit) == 2:
                i_rate = -raw_rate / c.ki  # the command stays on its limit
            elif c.ki and not (mode.limit and s * error > 0):
                i_rate = error
            command = s * limit if mode.limit else raw

        w = valve.spool_frequency
        spool_acceleration = w * w * (command - o) - 2 * valve.spool_damping * w * o_rate
        drops = (ps - pa, pa - pt, ps - pb, pb - pt)
        rates = [v, acceleration, z_rate, pa_rate, pb_rate, o_rate, spool_acceleration]
        rates += [i_rate, filter_rate, ps_rate, pump_rate, ps * q_p, pt * q_t]
        rates += [drop * flow for drop, flow in zip(drops, edges, strict=True)]
        rates += [leak * (pa - pb), friction * v, load * v, -stop * v]
        rates += [pa * squeeze_a, pb * squeeze_b, in_a, in_b]
        rates += [ps * given, ps * relief, ps * (given - relief - q_p)]
        signals = {"reference": target, "command": command, "load": load, "friction": friction}
        signals |= {"q_a": q_a, "q_b": q_b, "q_p": q_p, "q_t": q_t, "stop": stop}
        signals |= {"acceleration": acceleration, "delivered": given, "relief": relief}
        return Point(rates, error, raw, raw_rate, (cap_gap, rod_gap), signals)


def _on_limit(c: Controller, s: int, point: Point) -> int:
    """Tell where a command on its limit (side s) goes: beyond, along it or back inside."""
    held, running = s * point.raw_rate, s * (point.raw_rate + c.ki * point.error)
    if s * point.error <= 0:
        return s if running >= 0 else 0
    if held >= 0:
        return s
    return 2 * s if running > 0 else 0


def _limit_at(circuit: Circuit, point: Point) -> int:
    """Tell the command's mode afresh, after a step of the inputs."""
    limit, s = circuit.valve.limit, int(math.copysign(1, point.raw))
    if circuit.controller is None or abs(point.raw) < limit * (1 - 2 * LIMIT_SLACK):
        return 0
    beyond = abs(point.raw) > limit * (1 + LIMIT_SLACK)
    return s if beyond else _on_limit(circuit.controller, s, point)


def _guards(circuit: Circuit, mode: Mode) -> list[Callable[[Point], float]]:
    """Quantities that are positive inside a mode; the mode ends where one falls to zero."""
    cap, rod = (1 if mode.cap else -1), (1 if mode.rod else -1)
    ends: list[Callable[[Point], float]] = [
        lambda p: cap * p.gaps[0] + FORCE_SLACK,
        lambda p: rod * p.gaps[1] + FORCE_SLACK,
    ]
    limit, s, c = circuit.valve.limit, math.copysign(1, mode.limit), circuit.controller
    if c is None:
        return ends
    if mode.limit == 0:
        return [*ends, lambda p: limit - p.raw, lambda p: limit + p.raw]
    if abs(mode.limit) == 1:
        return [*ends, lambda p: s * p.raw - limit * (1 - LIMIT_SLACK)]
    return [*ends, lambda p: -s * p.raw_rate, lambda p: s * (p.raw_rate + c.ki * p.error)]


def _next_mode(circuit: Circuit, mode: Mode, event: int, point: Point) -> Mode:
    """Give the mode after an event."""
    if event < 2:
        return mode._replace(**{("cap", "rod")[event]: not mode[event]})
    assert circuit.controller
    if abs(mode.limit) == 2:
        return mode._replace(limit=mode.limit // 2 if event == 2 else 0)
    s = mode.limit or (1 if event == 2 else -1)
    return mode._replace(limit=_on_limit(circuit.controller, s, point))


@dataclass(frozen=True)
class Run:
    """A simulation: signals and running integrals at the requested times, and the events."""

    times: Floats
    signals: dict[str, Floats]
    integrals: dict[str, Floats]
    events: list[tuple[float, Mode]]


def start_state(circuit: Circuit, start: dict[str, float]) -> Floats:
    """Put named states into a vector; pump lines start at their own pressure."""
    known = {"p_supply": circuit.supply.pressure} | start
    unknown = known.keys() - set(STATES)
    if unknown:
        raise ValueError(f"no such state: {sorted(unknown)}")
    return np.array([known.get(name, 0.0) for name in STATES] + [0.0] * len(INTEGRALS))


def _until_event(
    circuit: Circuit, span: tuple[float, float], y: Floats, sealed: Any, rtol: float, method: str
) -> Any:
    """Integrate with inputs and mode held until the end of the span or the first event."""

    def event(guard: Callable[[Point], float]) -> Any:
        def fall(time: float, y: Floats) -> float:
            return guard(circuit.evaluate(time, y, *sealed))

        fall.terminal, fall.direction = True, -1  # type: ignore[attr-defined]
        return fall

    def rates(time: float, y: Floats) -> list[float]:
        return circuit.evaluate(time, y, *sealed).rates

    def slopes(time: float, y: Floats) -> Floats:  # nothing depends on the integrals
        base, matrix = np.array(rates(time, y)), np.zeros((len(y), len(y)))
        for i, (_, size) in enumerate(STATE_SIZES.values()):
            step = np.zeros_like(y)
            step[i] = size
            matrix[:, i] = (rates(time, y + step) - base) / size
        return matrix

    solver: Any = solve_ivp
    solution = solver(
        rates,
        span,
        y,
        method=method,
        rtol=rtol,
        atol=[*(size[0] for size in STATE_SIZES.values()), *INTEGRAL_TOLERANCES.values()],
        jac=slopes,
        dense_output=True,
        events=[event(guard) for guard in _guards(circuit, sealed[1])],
    )
    if solution.status < 0:
        raise RuntimeError(f"at {solution.t[-1]} s: {solution.message}")
    return solution


def simulate(
    circuit: Circuit,
    times: Any,
    start: dict[str, float],
    rtol: float = 1e-9,
    method: str = "Radau",
) -> Run:
    """Integrate from time 0 and give everything at the requested times.

    `start` names states (`STATES`); those not named are zero, except the supply pressure. The
    error filter starts at the first error (a choice: no kick at the start).
    """
    times = np.asarray(times, dtype=float)
    end, time, y = float(times[-1]), 0.0, start_state(circuit, start)
    breaks = sorted({*circuit.reference.starts, *circuit.load.starts, end})
    breaks = [b for b in breaks if 0 < b <= end]
    rows, extras, events, done = np.empty((len(times), len(y))), [], [], 0

    def inputs_at(time: float) -> tuple[Piece, Piece]:
        return circuit.reference.piece(time), circuit.load.piece(time)

    inputs, mode = inputs_at(0.0), Mode()
    point = circuit.evaluate(0.0, y, inputs, mode)
    if "filtered_error" not in start:
        y[STATES.index("filtered_error")] = point.error
    mode = Mode(point.gaps[0] > 0, point.gaps[1] > 0)
    point = circuit.evaluate(0.0, y, inputs, mode)
    mode = mode._replace(limit=_limit_at(circuit, point))

    while time < end:
        solution = _until_event(circuit, (time, breaks[0]), y, (inputs, mode), rtol, method)
        reached, y = float(solution.t[-1]), solution.y[:, -1]
        while done < len(times) and times[done] <= reached:
            rows[done] = solution.sol(times[done]) if reached > time else y
            extras.append(circuit.evaluate(times[done], rows[done], inputs, mode).signals)
            done += 1
        time = reached
        point = circuit.evaluate(time, y, inputs, mode)
        if min(guard(point) for guard in _guards(circuit, mode)) < -LOST:
            raise RuntimeError(f"an event was missed before {time} s")
        if solution.status == 1:
            event = next(i for i, found in enumerate(solution.t_events) if found.size)
            mode = _next_mode(circuit, mode, event, point)
            events.append((time, mode))
            if len(events) > 10_000:
                raise RuntimeError(f"too many events by {time} s")
        else:
            breaks.pop(0)
            inputs = inputs_at(time)
            point = circuit.evaluate(time, y, inputs, mode)
            mode = mode._replace(limit=_limit_at(circuit, point))

    signals = dict(zip(STATES, rows.T, strict=False))
    signals |= {name: np.array([extra[name] for extra in extras]) for name in extras[0]}
    integrals = dict(zip(INTEGRALS, rows.T[len(STATES) :], strict=True))
    return Run(times, signals, integrals, events)


def linearise(
    circuit: Circuit, start: dict[str, float], side: float, names: tuple[str, ...]
) -> tuple[Floats, Floats]:
    """State matrix and command column at a point, open loop, by central differences.

    `side` is the sign of the spool whose branch is taken. The load of the first piece acts.
    """
    bare = replace(circuit, controller=None)
    y0, load = start_state(circuit, start), circuit.load.piece(0.0)
    index = [STATES.index(name) for name in names]

    def rates(y: Floats, command: float) -> Floats:
        point = bare.evaluate(0.0, y, (line(command), load), Mode(), side)
        return np.array(point.rates)[index]

    columns = []
    for i, name in zip(index, names, strict=True):
        step = np.zeros_like(y0)
        step[i] = size = STATE_SIZES[name][1]
        columns.append((rates(y0 + step, 0.0) - rates(y0 - step, 0.0)) / (2 * size))
    return np.array(columns).T, (rates(y0, 1e-3) - rates(y0, -1e-3)) / 2e-3


def holding(circuit: Circuit, start: dict[str, float], most: float = 9.0) -> dict[str, float]:
    """The start with the spool at which chamber A gains no oil."""
    bare, load = replace(circuit, controller=None), circuit.load.piece(0.0)

    def gained(spool: float) -> float:
        y, side = start_state(circuit, start | {"spool": spool}), math.copysign(1.0, spool)
        point = bare.evaluate(0.0, y, (line(0.0), load), Mode(), side)
        return float(point.rates[STATES.index("p_a")])

    return start | {"spool": float(brentq(gained, -most, most, xtol=1e-13))}


def about_rest(circuit: Circuit, start: dict[str, float], side: float) -> dict[str, float]:
    """The held state where its spool lies on a side; else the drift that passes the centre."""
    held = holding(circuit, start)
    if held["spool"] * side > 0:
        return held
    bare, load = replace(circuit, controller=None), circuit.load.piece(0.0)
    names = ("p_a", "p_b", "velocity")
    size = np.array([1e6, 1e6, 1e-3])

    def moved(x: Floats) -> Floats:
        y = start_state(circuit, start | dict(zip(names, x * size, strict=True)))
        point = bare.evaluate(0.0, y, (line(0.0), load), Mode(), side)
        return np.array([point.rates[STATES.index(name)] for name in names]) / [1e9, 1e9, 1.0]

    begin = np.array([start.get(name, 0.0) for name in names]) / size
    found, _, good, why = fsolve(moved, begin, xtol=1e-13, full_output=True)
    assert good == 1, why
    return start | dict(zip(names, found * size, strict=True))


def ultimate_gain_by_swinging(
    circuit: Circuit,
    start: dict[str, float],
    side: float,
    of: str = "position",
    gains: tuple[float, float] = (1e-4, 1e6),
) -> tuple[float, float]:
    """Smallest proportional gain at which the loop swings by itself, and the period.

    The eigenvalues of the linearised loop are followed upward in steps of one percent.
    """
    names = ["position", "velocity", "p_a", "p_b", "spool", "spool_rate"]
    names += ["bristle"] if circuit.actuator.friction else []
    names += [] if isinstance(circuit.supply, ConstantSupply) else ["p_supply"]
    names += ["pump_flow"] if isinstance(circuit.supply, ControlledPump) else []
    if of == "velocity":
        names.remove("position")
    matrix, column = linearise(circuit, start, side, tuple(names))

    def last(gain: float) -> complex:
        closed = matrix.copy()
        closed[:, names.index(of)] -= gain * column
        return max(map(complex, np.linalg.eigvals(closed)), key=lambda value: value.real)

    low = gains[0]
    if last(low).real > 0:
        raise ValueError("the loop swings without a gain")
    while low < gains[1]:
        high = 1.01 * low
        if last(high).real > 0:
            gain = float(brentq(lambda k: last(k).real, low, high, rtol=1e-12))
            return gain, 2 * math.pi / abs(last(gain).imag)
        low = high
    raise ValueError(f"no oscillation up to {gains[1]}")
