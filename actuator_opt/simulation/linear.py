"""Linear model of a circuit about an operating point; the loop is opened at the valve signal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from math import copysign, inf, isfinite, pi, radians
from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..base.quantities import INPUTS
from ..base.symbolic import Equations
from ..base.symbolic.equations import PointFunctions
from ..design.scenario.kinds import Records
from ..design.scenario.model import Controller, Scenario, SignalSegment
from ..models.loop import ControllerGains, margin_rules, ziegler_nichols
from ..studies.plant import Plant
from .assemble import assemble
from .components.circuit import LOOPS, Circuit, Loop, loop_of, steady_value
from .integrate import LAST, last_mean, sampled

TOUCH = 1e-9
"""Small spool offset from its centre [V]; its sign selects which pair of edges is open."""
SIZE = 1e5
"""Typical size of a state, in units of its tolerance; it scales the unknowns of the equation solver
(our choice)."""
RESTING = 1.0
"""Rate of a state that counts as zero, in tolerances per second (our choice)."""
PLACES = ("position", "shaft angle")
"""Names of the states that change even in steady motion."""
CREEP = 1e-3
"""Growth rate of a real pole that counts as slow creep, relative to the slowest oscillation (our
choice). Near an equilibrium the load may drift a little."""
STILL = 1e-3
"""Magnitude up to which a pole counts as zero [rad/s] (our choice: a time constant of a quarter of
an hour)."""
SLOWER = 1e-3
"""Frequency at which the steady rate is evaluated, relative to the slowest non-zero pole. The
relative error is the square of this value."""
ROUNDING = 1e-6
"""Real part of an oscillating pole, relative to its magnitude, up to which it counts as rounding
error."""
POINTS = 2000
"""Number of frequencies in a response, which covers two decades below the slowest pole to one
decade above the fastest."""


@dataclass(frozen=True, slots=True)
class OpenLoop:
    """Transfer function L(s) = c (s - T)^-1 b from signal to measured value; T is upper triangular.

    Poles may coincide. With a leak-free valve, both the position and the common pressure of the
    chambers have a pole at zero.
    """

    triangle: Array
    input_gains: Array
    """Vector b of the transfer function."""
    output_gains: Array
    """Vector c of the transfer function."""
    kept: dict[str, Array] = field(default_factory=dict, compare=False, repr=False)
    """Frequencies and the response there, once computed: a search for gains reads them often."""

    @classmethod
    def of(cls, a: Array, b: Array, c: Array) -> OpenLoop:
        """Build the loop from the state equations x' = a x + b u, y = c x."""
        from scipy.linalg import schur

        triangle, q = schur(a, output="complex")
        return cls(triangle, q.conj().T @ b, c @ q)

    @property
    def poles(self) -> Array:
        """Poles of the open loop: the eigenvalues of T [rad/s]."""
        return np.diag(self.triangle)

    def at(self, omega: Array) -> Array:
        """Frequency response L(i omega)."""
        s = 1j * np.asarray(omega, dtype=float)
        t, size = self.triangle, len(self.input_gains)
        x = np.zeros((size, *s.shape), dtype=complex)
        for k in reversed(range(size)):
            x[k] = (self.input_gains[k] + np.tensordot(t[k, k + 1 :], x[k + 1 :], 1)) / (
                s - t[k, k]
            )
        return np.tensordot(self.output_gains, x, 1)

    @property
    def frequencies(self) -> Array:
        """Angular frequencies, dense enough to show every resonance [rad/s]."""
        if "frequencies" not in self.kept:
            self.kept["frequencies"] = self._frequencies()
        return self.kept["frequencies"]

    @property
    def response(self) -> Array:
        """Frequency response at the `frequencies`."""
        if "response" not in self.kept:
            self.kept["response"] = self.at(self.frequencies)
        return self.kept["response"]

    def _frequencies(self) -> Array:
        size = np.abs(self.poles)
        size = size[size > STILL]
        grid = np.geomspace(size.min() / 100, size.max() * 10, POINTS)
        near = size[:, None] * (1 + np.array([-0.02, -0.005, -1e-3, 0.0, 1e-3, 0.005, 0.02]))
        return np.unique(np.concatenate((grid, near.ravel())))

    @property
    def unstable(self) -> bool:
        """Whether the loop has a growing pole, apart from slow creep."""
        return _grow(self.poles)

    @property
    def steady_rate(self) -> float:
        """Steady rate of the measured value per volt of signal: the limit of s L(s) at s = 0."""
        size = np.abs(self.poles)
        omega = float(np.min(size[size > STILL])) * SLOWER
        return float((1j * omega * self.at(np.array(omega))).real)


class LoopsAtPoint(NamedTuple):
    """Open control loops, linearised at an operating point, for both spool directions."""

    loops: list[OpenLoop]
    held: bool
    """Whether the valve can hold the load at this point."""
    rest: list[OpenLoop]
    """Those of the loops on whose side of the centre the spool rests; both without load."""


@dataclass(frozen=True, slots=True)
class Linear:
    """Linear model of a circuit, which can be taken about any state."""

    circuit: Circuit
    names: tuple[str, ...]
    initial: Array
    scale: Array
    functions: PointFunctions
    """Rates of the states and the measured value, as functions of the states and the signal."""

    @classmethod
    def of(cls, circuit: Circuit) -> Linear:
        """Build from a circuit assembled with ``linear=True``.

        States on which no other equation depends are left out.
        """
        system = circuit.system
        states = [state for state in system.states if not state.integral]
        symbols = [state.symbol for state in states]
        u = system.graph.variable("u")
        flags = [system.graph.flag(name) for name in system.flags]
        outputs = [*(state.rate for state in states), circuit.measured]
        equations = Equations(system.time, [*symbols, u], flags, outputs)
        return cls(
            circuit=circuit,
            names=tuple(state.name for state in states),
            initial=np.array([state.initial for state in states]),
            scale=np.array([state.tolerance for state in states]),
            functions=equations.at_point((False,) * len(flags)),
        )

    def loop(self, state: Array, signal: float) -> OpenLoop:
        """The open loop about a given state and signal."""
        size, d = len(state), self.scale
        table = self._table(state, signal)
        a = table[:size, :size] * d / d[:, None]
        return OpenLoop.of(a, table[:size, size] / d, table[size, :size] * d)

    def _table(self, state: Array, signal: float) -> Array:
        """Derivatives of the rates and of the measured value with respect to states and signal."""
        return self.functions.slopes(0.0, np.append(state, signal)).copy()

    def about(self, **states: float) -> LoopsAtPoint:
        """Open loops for both spool directions; the valve holds the load at the given states.

        To hold a load, the spool rests on one side of its centre. The loop of that direction is
        taken at this equilibrium. In the other direction, and in both directions if there is no
        load, the loop is taken with the spool just off its centre or, with overlap, where its edges
        begin to open. If the valve cannot hold the load, the loops are taken at the given states.
        """
        at_rest = {name: 0.0 for name in ("speed", "shaft_speed") if self._known(name)}
        centre = self.circuit.centre
        guesses = (self.steady(centre + volts, **(at_rest | states)) for volts in self._guesses())
        equilibrium = next((guess for guess in guesses if guess is not None), None)
        fallback = self._with(at_rest | states) if equilibrium is None else equilibrium[0]
        loops: list[OpenLoop] = []
        rest: list[OpenLoop] = []
        for side in (1.0, -1.0):
            point: tuple[Array, float] | None = equilibrium
            touch = TOUCH + self.circuit.start_of_edges(side)
            if equilibrium is None or (equilibrium[1] - centre) * side < touch:
                off_centre = centre + side * touch
                point = self.steady(off_centre, **(states | {"spool": off_centre}))
                if point is None:
                    point = (
                        np.where([name == "spool" for name in self.names], off_centre, fallback),
                        off_centre,
                    )
            assert point is not None
            loops.append(self.loop(*point))
            if equilibrium is not None and (equilibrium[1] - centre) * side > -TOUCH:
                rest.append(loops[-1])
        return LoopsAtPoint(loops, equilibrium is not None, rest)

    def steady(self, guess: float, **states: float) -> tuple[Array, float] | None:
        """Find all states and the valve signal in steady motion, for some given states.

        Parameters
        ----------
        guess : signal near the solution [V]
        states : given states by name, SI; unless given, the position is that of the start

        Returns
        -------
        states and signal [V]; None if no steady motion exists
        """
        from scipy.optimize import root

        begin = self._with({"spool": guess} | states)
        given = {state.replace("_", " ") for state in states} | set(PLACES)
        free = np.array([k for k, name in enumerate(self.names) if name not in given])
        balanced = np.array([k for k, name in enumerate(self.names) if name not in PLACES])
        size = np.append(SIZE * self.scale[free], 1.0)
        unit = self.scale[balanced]
        columns = np.append(free, len(self.names))

        def point(x: Array) -> tuple[Array, float]:
            y = begin.copy()
            y[free] = x[:-1] * size[:-1]
            return y, float(x[-1])

        def residual(x: Array) -> Array:
            y, u = point(x)
            return np.array(self.functions.values(0.0, np.append(y, u)))[balanced] / unit

        def slopes(x: Array) -> Array:
            return self._table(*point(x))[np.ix_(balanced, columns)] * size / unit[:, None]

        start = np.append(begin[free], guess) / size
        try:
            with np.errstate(all="ignore"):
                solution = root(residual, start, jac=slopes, method="hybr", tol=1e-12)
            remainder = residual(solution.x)
        except (ArithmeticError, ValueError):  # no values at some trial point
            return None
        # also rejects NaN
        return point(solution.x) if np.max(np.abs(remainder)) < RESTING else None

    def _guesses(self) -> Iterator[float]:
        """Distances from the centring signal at which the search for an equilibrium starts [V]."""
        valve = self.circuit.plant.valve
        assert valve is not None
        return (share * valve.signal for share in (0.0, 0.3, -0.3))

    def _known(self, name: str) -> bool:
        return name.replace("_", " ") in self.names

    def _with(self, states: Mapping[str, float]) -> Array:
        """The initial state with some values changed."""
        y = self.initial.copy()
        for name, value in states.items():
            y[self.names.index(name.replace("_", " "))] = value
        return y


@dataclass(frozen=True, slots=True)
class Ultimate:
    """Gain at which a proportional loop begins to oscillate, and the period of the oscillation."""

    gain: float
    period: float
    """Period of the oscillation [s]."""


def ultimate(loop: OpenLoop) -> Ultimate:
    """Smallest gain K with K L(i omega) = -1; infinite if no gain makes the loop oscillate."""
    crossings = _crossings(loop.frequencies, loop.response, loop.at)
    oscillations = [(-1 / value.real, omega) for omega, value in crossings]
    gain, omega = min(oscillations, default=(inf, 0.0))
    return Ultimate(gain, 2 * pi / omega if omega > 0 else inf)


def _crossings(
    omega: Array, value: Array, response: Callable[[Array], Array]
) -> list[tuple[float, complex]]:
    """Frequencies at which a response is real and negative, with the response there.

    `value` is the response at the frequencies `omega`.
    """
    from scipy.optimize import brentq

    crossings = []
    for k in np.flatnonzero(np.diff(np.sign(value.imag)) != 0):
        if min(value[k].real, value[k + 1].real) >= 0:
            continue
        at = float(
            brentq(lambda w: float(response(np.array(w)).imag), omega[k], omega[k + 1], rtol=1e-12)
        )
        crossing = complex(response(np.array(at)))
        if crossing.real < 0:
            crossings.append((at, crossing))
    return crossings


@dataclass(frozen=True, slots=True)
class ControllerLaw:
    """Controller C(s) = K [1 + 1/(s T_i) + s T_d/(1 + s T_f)].

    K is the gain, T_i the integral time, T_d the derivative time, T_f the filter time.
    """

    gain: float
    integral_time: float
    derivative_time: float
    filter_time: float

    def at(self, omega: Array) -> Array:
        """Frequency response C(i omega)."""
        s = 1j * np.asarray(omega, dtype=float)
        part = 1.0 + self.derivative_time * s / (1 + self.filter_time * s)
        if self.integral_time < inf:
            part = part + 1 / (s * self.integral_time)
        return self.gain * part

    def closed(self, loop: OpenLoop) -> Array:
        """Poles of the loop closed with this controller."""
        size = len(loop.input_gains)
        b, c = loop.input_gains, loop.output_gains
        direct = self.gain * (1 + self.derivative_time / self.filter_time)
        a = np.zeros((size + 2, size + 2), dtype=complex)
        # u = -K [(1 + T_d/T_f) y + I/T_i - T_d/T_f f]; I is the integral (I' = y), f the filtered y
        # (f' = (y - f)/T_f)
        a[:size, :size] = loop.triangle - direct * np.outer(b, c)
        if self.integral_time < inf:
            a[:size, size] = -self.gain / self.integral_time * b
            a[size, :size] = c
        else:
            a[size, size] = -1 / self.filter_time
        a[:size, size + 1] = self.gain * self.derivative_time / self.filter_time * b
        a[size + 1, :size] = c / self.filter_time
        a[size + 1, size + 1] = -1 / self.filter_time
        return np.asarray(np.linalg.eigvals(a))


@dataclass(frozen=True, slots=True)
class LoopMargins:
    """Margins of a loop with its controller."""

    gain: float
    """Gain margin: the factor on the gain at which the loop begins to oscillate. A factor above 1
    means that the loop is stable."""
    phase: float | None
    """Phase margin [rad]; None if the loop gain never exceeds one."""
    stable: bool


def _grow(poles: Array) -> bool:
    """Whether any oscillating pole grows, or any real pole grows faster than creep."""
    size = np.abs(poles)
    swings = (np.abs(poles.imag) > 1e-3 * size) & (size > STILL)
    slowest = np.min(size[swings]) if swings.any() else np.max(size)
    limit = np.where(swings, ROUNDING * size, CREEP * slowest)
    return bool(np.any(poles.real > limit))


def margins(loop: OpenLoop, law: ControllerLaw) -> LoopMargins:
    """Gain and phase margin of L(i omega) C(i omega).

    The closed-loop poles decide whether the loop is stable.
    """

    def response(omega: Array) -> Array:
        return loop.at(omega) * law.at(omega)

    stable = not _grow(law.closed(loop))
    omega = loop.frequencies
    value = loop.response * law.at(omega)
    factors = [-1 / crossing.real for _, crossing in _crossings(omega, value, response)]
    if stable:
        gain = min((factor for factor in factors if factor > 1), default=inf)
    else:
        gain = max((factor for factor in factors if factor <= 1), default=0.0)
    return LoopMargins(gain, phase_margin(loop, law), stable)


def phase_margin(loop: OpenLoop, law: ControllerLaw) -> float | None:
    """Phase margin of L(i omega) C(i omega) [rad]; None if the loop gain never exceeds one."""
    omega = loop.frequencies
    size = np.abs(loop.response * law.at(omega))
    phase = None
    for k in np.flatnonzero((size[:-1] >= 1) & (size[1:] < 1)):
        share = np.log(size[k]) / np.log(size[k] / size[k + 1])
        crossover = omega[k : k + 1] * (omega[k + 1] / omega[k]) ** share
        here = float(np.angle(-(loop.at(crossover) * law.at(crossover))[0]))
        phase = here if phase is None or abs(here) < abs(phase) else phase
    return phase


def least(loops: Sequence[OpenLoop]) -> tuple[Ultimate, OpenLoop]:
    """The smallest ultimate gain of all loops, and the loop that has it.

    For a loop that is unstable even without control, the ultimate gain counts as zero.
    """
    pairs = [(Ultimate(0.0, inf) if loop.unstable else ultimate(loop), loop) for loop in loops]
    return min(pairs, key=lambda pair: pair[0].gain)


MARGIN = {"p": 2.0, "pi": 3.0}
"""Gain margin for tuning by margins, by control law (our choice). A P controller gets half the
ultimate gain, the default for a design. An integral part reduces the phase, so a PI controller gets
a larger margin."""
PHASE = radians(60.0)
"""Phase margin that suffices for a controller with an integral part, even if the loop has a larger
margin without this part (our choice)."""
MARGIN_SHARE = 0.9
"""Share of the proportional loop's margins that must remain when an integral part is added (our
choice)."""
NO_GAIN = 1e-9
"""Factor on the proportional gain that replaces a factor of zero, so that an integral or derivative
part can be expressed relative to it."""
UNHELD = "the valve cannot hold the load"
CAUSES = "lower the load or the piston's leakage, or raise supply.pressure or the valve's flow"


@dataclass(frozen=True, slots=True)
class Tuned:
    """Gains of the controller, the way in which they were obtained, and the margins."""

    gains: ControllerGains
    origin: str
    unit: str
    ultimate: Ultimate | None = None
    margins: LoopMargins | None = None
    """Margins of the linear loop with these gains times the scenario's factors; they and `ultimate`
    are None if the gains do not need them and nobody asked for them."""
    notes: tuple[str, ...] = ()
    unheld: str = ""
    """Text that names the point at which the valve cannot hold the load, if any; the margins are
    then meaningless."""


def tune(
    scenario: Scenario,
    plant: Plant,
    records: Records,
    *,
    previous: Tuned | None = None,
    with_margins: bool = False,
) -> Tuned | None:
    """Gains of a scenario's controller, with the margins of the control loop.

    The loop is linear and has no sticking friction. The valve holds the initial load, even if the
    scenario starts at other pressures. The loop is evaluated for both spool directions, at the
    start and, for a position loop, wherever the reference comes to rest. A speed loop is also
    evaluated at steady speed. The smallest ultimate gain is used for tuning: of both directions or,
    with ``tuning_side: rest``, only of that in which the spool rests.

    Parameters
    ----------
    scenario, plant, records : as for `assemble`
    previous : gains that are kept
    with_margins : whether margins are computed although no gain is tuned by them

    Raises
    ------
    InputError
        a control law without a tuning rule; a loop that no gain makes oscillate; a loop that
        oscillates even without control; a load that the valve cannot hold
    """
    control, loop = scenario.control, loop_of(scenario.control)
    if control is None or loop is None:
        return None
    tuned = previous or _given(control, loop, plant)
    if tuned is not None and not with_margins:
        return replace(tuned, ultimate=None, margins=None, unheld="")
    circuit = assemble(_with_held_load(scenario), plant, records, None, linear=True)
    loops = _loops(Linear.of(circuit), scenario, plant, control, loop)
    used = loops.rest if control.tuning_side == "rest" and loops.rest else loops.all
    limit, worst = least(used)
    if tuned is None:
        if loops.unheld:
            message = f"{UNHELD}{loops.unheld}, so the gain cannot be tuned"
            remedy = f"{CAUSES}; or state the gain"
            raise InputError(Diagnostic(message, remedy, path=f"control.{loop}"))
        gains, origin, notes = _gains_by_rule(control, loop, limit, worst)
        tuned = Tuned(gains, origin, LOOPS[loop].unit, notes=notes)
    law = _shaped(control, tuned.gains)
    notes = (*tuned.notes, *_other_side(loops, used, law)) if previous is None else tuned.notes
    return replace(
        tuned, ultimate=limit, margins=margins(worst, law), notes=notes, unheld=loops.unheld
    )


def _given(control: Controller, loop: Loop, plant: Plant) -> Tuned | None:
    """Gains that the scenario or the design states; None if they must be tuned."""
    stated, design, unit = getattr(control, f"{loop}_gain"), plant.design.control, LOOPS[loop].unit
    if stated is not None:
        times = control.integral_time or inf, control.derivative_time or 0.0
        return Tuned(ControllerGains(stated, *times), "stated", unit)
    usual = control.tuning == "margins" and control.margin is None and control.law == "p"
    usual = usual and control.tuning_side == "worst" and loop == "position"
    if usual and design is not None and design.gain is not None:
        return Tuned(ControllerGains(design.gain, inf, 0.0), "control.gain of the design", unit)
    return None


def _shaped(control: Controller, gains: ControllerGains) -> ControllerLaw:
    """The controller with the scenario's factors, each of which acts on one part only."""
    factor, integral = control.gain_factor or NO_GAIN, control.integral_factor
    return ControllerLaw(  # as in `components.valve`
        factor * gains.proportional_gain,
        factor / integral * gains.integral_time if integral else inf,
        control.derivative_factor / factor * gains.derivative_time,
        control.filter_time,
    )


class _Loops(NamedTuple):
    """Open loops at all points, those on the rest side, and where the load cannot be held."""

    all: list[OpenLoop]
    rest: list[OpenLoop]
    unheld: str


def _other_side(loops: _Loops, used: list[OpenLoop], law: ControllerLaw) -> Iterator[str]:
    """A note if a loop that the tuning leaves out is nearer to its limit."""
    if len(used) == len(loops.all) or loops.unheld:
        return
    limit, worst = least(loops.all)
    if limit.gain < least(used)[0].gain:
        gain = margins(worst, law).gain
        yield (
            "gain and margins are those of the side on which the spool rests: on the other side of "
            f"its centre, which a drifting load passes, the gain margin is {gain:.3g}"
        )


def _with_held_load(scenario: Scenario) -> Scenario:
    """A copy of the scenario that starts at the pressures at which the valve holds the load."""
    initial = scenario.initial.model_copy(update={"pressure_a": None, "pressure_b": None})
    return scenario.model_copy(update={"initial": initial})


def _loops(
    linear: Linear, scenario: Scenario, plant: Plant, control: Controller, loop: Loop
) -> _Loops:
    """Open loops at all relevant points."""
    if loop != "position":
        loops, held, rest = linear.about()
        moving: list[OpenLoop] = []
        if loop != "shaft_angle":
            moving = _loop_in_motion(linear, loop, steady_value(getattr(control, loop)))
        return _Loops([*loops, *moving], [*rest, *moving], "" if held else " at the start")
    loops, at_rest, words = [], list[OpenLoop](), ""
    for place in _places(control.position, linear.circuit.start.position, plant.stroke):
        more, held, rest = linear.about(position=place)
        loops += more
        at_rest += rest
        if not held:
            words = words or f" with the piston at {INPUTS['position'].text(place)}"
    return _Loops(loops, at_rest, words)


def _places(parts: Sequence[SignalSegment], start: float, stroke: float) -> list[float]:
    """Positions at which a position reference rests: initially, and after each of its steps."""
    places, position = {start}, start
    for segment in sorted(parts, key=lambda segment: segment.start or 0.0):
        position += steady_value([segment])
        places.add(min(max(position, 0.0), stroke))
    return sorted(places)


def _loop_in_motion(linear: Linear, name: str, value: float) -> list[OpenLoop]:
    """The open loop at a steady speed; empty if the actuator cannot reach that speed."""
    guess = linear.circuit.centre + copysign(1.0, value)
    operating_point = None if value == 0 else linear.steady(guess, **{name: value})
    return [] if operating_point is None else [linear.loop(*operating_point)]


def _gains_by_rule(
    control: Controller, loop: Loop, limit: Ultimate, worst: OpenLoop
) -> tuple[ControllerGains, str, tuple[str, ...]]:
    """Gains that a tuning rule gives for the ultimate gain and period, name of the rule, notes."""
    if worst.unstable:
        message = "the circuit oscillates even without the outer control loop"
        remedy = "lower speed_feedback and pressure_feedback, or add leakage across the piston"
        raise InputError(Diagnostic(message, remedy, path="control"))
    if not isfinite(limit.gain) or limit.gain <= 0:
        message = "no gain makes the linear loop oscillate, so the gain cannot be tuned"
        raise InputError(Diagnostic(message, "state the gain", path=f"control.{loop}_gain"))
    if control.tuning == "ziegler_nichols":
        gains = ziegler_nichols(
            law=control.law, ultimate_gain=limit.gain, ultimate_period=limit.period
        )
        note = (
            "Ziegler-Nichols ignores friction and leaves little margin on a lightly damped oil "
            "spring: check the overshoot before you use the gain"
        )
        return gains, "Ziegler and Nichols", (note,)
    if control.law == "pid":
        message = (
            "tuning by margins supports only the laws p and pi, as a derivative part would reduce "
            "the margins"
        )
        remedy = "write law: pi, or tuning: ziegler_nichols"
        raise InputError(Diagnostic(message, remedy, path="control.tuning"))
    margin = MARGIN[control.law] if control.margin is None else control.margin
    origin = f"gain margin {margin:g}"
    if loop in ("position", "shaft_angle") or control.law == "p":
        gains = margin_rules(
            law=control.law,
            ultimate_gain=limit.gain,
            velocity_gain=abs(worst.steady_rate) or 1.0,
            gain_margin=margin,
        )
        if control.law == "p":
            return gains, origin, ()
        gain, shortest = gains.proportional_gain, gains.integral_time
    else:
        gain, shortest = limit.gain / margin, 0.02 * limit.period
    time = _integral_time(
        worst, ControllerLaw(gain, inf, 0.0, control.filter_time), shortest, limit.period
    )
    return ControllerGains(gain, time, 0.0), origin, ()


def _integral_time(loop: OpenLoop, law: ControllerLaw, shortest: float, period: float) -> float:
    """Smallest integral time, at least `shortest`, that keeps `MARGIN_SHARE` of the margins."""
    proportional = margins(loop, law)
    phase = PHASE if proportional.phase is None else min(MARGIN_SHARE * proportional.phase, PHASE)
    longest = 1e4 * period
    for time in np.geomspace(shortest, max(longest, shortest), 140):
        candidate = replace(law, integral_time=float(time))
        kept = phase_margin(loop, candidate)
        if kept is not None and kept < phase:
            continue  # the phase takes a small part of the time that the other margins take
        with_integral = margins(loop, candidate)
        if with_integral.stable and with_integral.gain >= MARGIN_SHARE * proportional.gain:
            return float(time)
    return longest


BAND = 0.02
"""Half the width of the settling band, as a share of the step: the usual 2 %."""


class StepMetrics(NamedTuple):
    """Key values of a step response; times are measured from its first sample."""

    rise_time: float | None
    """Time from 10 to 90 % of the step [s]; None if the response does not reach 90 %."""
    settling_time: float | None
    """Time after which the response stays in the band about the target [s]; None if it does not
    stay there."""
    overshoot: float
    """Excess over the target, as a share of the step; 0 if the target is never reached."""
    steady_state_error: float
    """Target minus the mean response over the last tenth of the time, in the response's unit."""
    peak: float
    """Most extreme response in the direction of the step."""
    peak_time: float
    """Time of the peak [s]."""
    decay: float | None
    """Next overshoot after the largest, divided by the largest; None if there is no next
    overshoot."""


def step_metrics(
    *, time: Array, response: Array, start: float, target: float, band: float = BAND
) -> StepMetrics:
    """Rise, settling, overshoot and steady-state error of a sampled step response.

    Samples are joined by straight lines. The settling band lies about the target, not about the
    final value. A response that comes to rest elsewhere thus has a steady-state error but no
    settling time. It also has none if it enters the band for good only within the last tenth of the
    record. Band and overshoot are shares of the step.

    Parameters
    ----------
    time : (n,) [s]; the first sample is the instant of the step
    response : (n,)
    start, target : command before and after the step, in the response's unit
    band : half width of the settling band, as a share of the step [-]

    Returns
    -------
    the key values: times in seconds, shares of the step, and values in the response's unit

    Raises
    ------
    InputError : invalid samples, no step, or a band that is not positive

    Notes
    -----
    Valid: command constant after the step.

    References
    ----------
    [derived] usual definitions: 10 to 90 %, 2 % of the step

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 2001)
    >>> found = step_metrics(time=t, response=1 - np.exp(-t / 0.1), start=0.0, target=1.0)
    >>> print(f"{found.rise_time:.4f} s, {found.settling_time:.4f} s, {found.overshoot}")
    0.2197 s, 0.3912 s, 0.0
    """
    t, x = sampled(time=time, response=response)
    if not np.isfinite(target - start) or target == start:
        message = f"a step from {start:g} to {target:g}"
        raise InputError(Diagnostic(message, "give different values for start and target"))
    if not 0 < band < 1:
        raise InputError(
            Diagnostic(f"settling band {band:g} of the step", "give one between 0 and 1")
        )
    t = t - t[0]
    normalised = (x - start) / (target - start)
    early, late = _time_at(t, normalised, 0.1), _time_at(t, normalised, 0.9)
    top = int(np.argmax(normalised))
    return StepMetrics(
        None if early is None or late is None else late - early,
        _settling_time(t, normalised - 1, band),
        max(float(normalised[top]) - 1, 0.0),
        target - last_mean(t, x),
        float(x[top]),
        float(t[top]),
        _decay(normalised[top:] - 1),
    )


def _time_at(t: np.ndarray, normalised: np.ndarray, level: float) -> float | None:
    """First time at which the response reaches a level; None if it does not."""
    above = np.flatnonzero(normalised >= level)
    if not above.size:
        return None
    at = int(above[0])
    return float(t[0]) if at == 0 else _crossing(t, normalised, at - 1, level)


def _crossing(t: np.ndarray, values: np.ndarray, at: int, level: float) -> float:
    """Time at which the straight line between two samples crosses a level."""
    share = (level - values[at]) / (values[at + 1] - values[at])
    return float(t[at] + share * (t[at + 1] - t[at]))


def _settling_time(t: np.ndarray, error: np.ndarray, band: float) -> float | None:
    """Time after which the error stays in the band; None if that time is in the last tenth."""
    beyond = np.flatnonzero(np.abs(error) > band)
    if not beyond.size:
        return 0.0
    at = int(beyond[-1])
    if at == len(t) - 1:
        return None
    time = _crossing(t, error, at, float(np.copysign(band, error[at])))
    return time if time <= (1 - LAST) * t[-1] else None


def _decay(beyond: np.ndarray) -> float | None:
    """Next overshoot divided by the largest; None if one of them is missing.

    `beyond` is the response minus its target, divided by the step, from the largest overshoot on.
    """
    back = np.flatnonzero(beyond < 0)
    if beyond[0] <= 0 or not back.size:
        return None
    following = float(np.max(beyond[back[0] :]))
    return following / float(beyond[0]) if following > 0 else None
