"""A held actuator from its differential equations: state space for python-control.

Nothing here comes from the package. Every element writes its own equation, sums of derivatives
equal sums of states and inputs; equations without a derivative are eliminated by linear algebra.
A circuit is a dictionary of numbers; see `random_circuit` for its keys.

Load: m v' = (x_p - x)/f + F. Piston, without mass: B x_p' = A_A p_A - A_B p_B - k_s x_p -
(x_p - x)/f; f = 0 makes both one body. Chambers: C_A p_A' + C_AB p_B' + A_A x_p' = q_A -
g (p_A - p_B), C_B p_B' + C_AB p_A' - A_B x_p' = q_B + g (p_A - p_B). Line: L q' = p_f - p -
(R + 1/throttle) q. Far node: C_f p_f' = G o - q - (flows into what ends the line).
"""

from __future__ import annotations

import control
import numpy as np


class Equations:
    """Rows of E z' = A z + B u over named unknowns."""

    def __init__(self):
        """No equation yet."""
        self.names, self.rows = [], []

    def index(self, name):
        """Position of an unknown, new ones at the end."""
        if name not in self.names:
            self.names.append(name)
        return self.names.index(name)

    def state(self, derivatives, states, inputs=None):
        """Add sum(derivatives) = sum(states) + sum(inputs), each a dictionary by name."""
        for name in (*derivatives, *states):
            self.index(name)
        self.rows.append((derivatives, states, inputs or {}))

    def matrices(self, inputs):
        """E, A and B of all rows."""
        n = len(self.names)
        e, a, b = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, len(inputs)))
        assert len(self.rows) == n
        for i, (derivatives, states, driven) in enumerate(self.rows):
            for name, value in derivatives.items():
                e[i, self.index(name)] += value
            for name, value in states.items():
                a[i, self.index(name)] += value
            for name, value in driven.items():
                b[i, inputs.index(name)] += value
        return e, a, b


def _end(eq, side, node, end):
    """Flow into one line end as a sum of unknowns, {name: factor}."""
    kind, *numbers = end
    tag = f"{kind} {side} {len(eq.rows)}"
    if kind == "conductance":
        return {node: numbers[0]}
    if kind == "accumulator":
        capacitance, inertance, resistance = numbers
        flow, gas = f"flow {tag}", f"gas {tag}"
        eq.state({flow: inertance}, {node: 1.0, gas: -1.0, flow: -resistance})
        eq.state({gas: capacitance}, {flow: 1.0})
        return {flow: 1.0}
    assert kind == "reducing"
    conductance, natural, ratio, passive = numbers
    place, speed = f"spool {tag}", f"speed {tag}"
    eq.state({place: 1.0}, {speed: 1.0})
    eq.state({speed: 1.0}, {node: natural**2, place: -(natural**2), speed: -2 * ratio * natural})
    return {node: passive, place: conductance}


def _side(eq, name, side, swept, coupling, leakage):
    """Equations of a chamber and its line; `swept` is its change of volume by derivatives."""
    own, other = f"p_{name}", "p_b" if name == "a" else "p_a"
    balance = {own: -leakage, other: leakage}
    rates = {own: side["compliance"], other: coupling}
    for state, factor in swept.items():
        rates[state] = rates.get(state, 0.0) + factor
    held = ("constant_pressure",) in side["ends"]
    series = side["resistance"] + (1 / side["throttle"] if side["throttle"] else 0.0)
    if side["throttle"] == 0.0:
        eq.state(rates, balance)
        flow = None
    elif series == 0.0 and side["inertance"] == 0.0:
        if held:
            eq.state({own: 1.0}, {})  # the pressure stands still
            return
        rates[own] += side["far_compliance"]
        for end in side["ends"]:
            for state, factor in _end(eq, name, own, end).items():
                balance[state] = balance.get(state, 0.0) - factor
        eq.state(rates, balance, {"o": side["flow_gain"]})
        return
    else:
        flow = f"q_{name}"
        eq.state(rates, {**balance, flow: 1.0})
    far = f"far_{name}"
    if held:
        eq.state({}, {far: 1.0})
    else:
        sum_out = {} if flow is None else {flow: -1.0}
        for end in side["ends"]:
            for state, factor in _end(eq, name, far, end).items():
                sum_out[state] = sum_out.get(state, 0.0) - factor
        eq.state({far: side["far_compliance"]}, sum_out, {"o": side["flow_gain"]})
    if flow is not None:
        eq.state({flow: side["inertance"]}, {far: 1.0, own: -1.0, flow: -series})


def _equations(circuit):
    """Every equation of a circuit, inputs load force F and spool signal o."""
    c, eq = circuit, Equations()
    area_a, area_b = c["a"]["area"], c["b"]["area"]
    flexibility, seals, damping = c["flexibility"], c["seal_stiffness"], c["damping"]
    oil = {"p_a": area_a, "p_b": -area_b}
    eq.state({"x": 1.0}, {"v": 1.0})
    if flexibility == 0.0:
        eq.state({"v": c["mass"]}, {**oil, "v": -damping, "x": -seals}, {"F": 1.0})
        swept = {"x": 1.0}
    elif damping == 0.0:  # x_p follows from the forces on the massless piston
        yielding = 1 / (seals + 1 / flexibility)
        share = yielding / flexibility
        load = {name: factor * share for name, factor in oil.items()}
        eq.state({"v": c["mass"]}, {**load, "x": (share - 1) / flexibility}, {"F": 1.0})
        swept = {"p_a": area_a * yielding, "p_b": -area_b * yielding, "x": share}
    else:
        stiff = 1 / flexibility
        eq.state({"v": c["mass"]}, {"x_p": stiff, "x": -stiff}, {"F": 1.0})
        eq.state({"x_p": damping}, {**oil, "x_p": -seals - stiff, "x": stiff})
        swept = {"x_p": 1.0}
    for name, sign in (("a", area_a), ("b", -area_b)):
        volume = {state: sign * factor for state, factor in swept.items()}
        _side(eq, name, c[name], volume, c["coupling"], c["leakage"])
    return eq


def descriptor(circuit):
    """E, A and B of E z' = A z + B [F, o], and the index of the load position in z."""
    eq = _equations(circuit)
    return *eq.matrices(["F", "o"]), eq.index("x")


def state_space(circuit):
    """python-control's StateSpace from load force F and spool signal o to load position x."""
    e, a, b, position = descriptor(circuit)
    moving = np.any(e != 0, axis=1)
    dynamic = np.any(e != 0, axis=0)
    assert moving.sum() == dynamic.sum()
    slave = np.linalg.solve(
        a[np.ix_(~moving, ~dynamic)], -np.c_[a[~moving][:, dynamic], b[~moving]]
    )
    count = dynamic.sum()
    whole_a = a[np.ix_(moving, dynamic)] + a[np.ix_(moving, ~dynamic)] @ slave[:, :count]
    whole_b = b[moving] + a[np.ix_(moving, ~dynamic)] @ slave[:, count:]
    mass = e[np.ix_(moving, dynamic)]
    out = np.zeros((1, count))
    out[0, dynamic[:position].sum()] = 1.0
    matrix, drive = np.linalg.solve(mass, whole_a), np.linalg.solve(mass, whole_b)
    return control.ss(matrix, drive, out, np.zeros((1, 2)))


def load_damping(circuit):
    """Damping ratio of the load from the eigenvectors of its differential equations.

    A blow on the load gives it the speed sum of p e^(lambda t); `shares` are these p.
    """
    system = state_space(circuit)
    poles, vectors = np.linalg.eig(system.A)
    seen = system.C @ vectors
    caused = np.linalg.solve(vectors, system.B[:, :1])
    shares = circuit["mass"] * poles * seen[0] * caused[:, 0]
    moving = np.abs(poles) > 1e-9 * np.median(np.abs(poles))
    pairs = (poles.imag > 1e-9 * np.abs(poles)) & moving
    ceiling = 1.0 if pairs.any() else np.inf
    pairs &= 2 * shares.real > 0.05
    if pairs.any():
        ratios = -poles[pairs].real / np.abs(poles[pairs])
        weights = np.clip((2 * shares[pairs].real - 0.05) / 0.2, 0, 1)
        return float(np.min(1 - weights * (1 - ratios)))
    sizes = np.sort(-poles[moving].real)
    ratios = (sizes[1:] + sizes[:-1]) / (2 * np.sqrt(sizes[1:] * sizes[:-1]))
    return float(np.min(ratios, initial=ceiling))


def spool(natural_frequency, damping_ratio):
    """Second-order spool, o'' = omega^2 (u - o) - 2 zeta omega o', as state space."""
    omega = 2 * np.pi * natural_frequency
    matrix = [[0.0, 1.0], [-(omega**2), -2 * damping_ratio * omega]]
    return control.ss(matrix, [[0.0], [omega**2]], [[1.0, 0.0]], [[0.0]])


def plant(circuit, natural_frequency, damping_ratio):
    """Valve signal to load position."""
    return control.series(spool(natural_frequency, damping_ratio), state_space(circuit)[0, 1])


def in_milliseconds(system):
    """The same system in rad/ms: python-control's polynomials of many poles then stay in range."""
    return control.ss(system.A / 1e3, system.B / 1e3, system.C, system.D)


def closed(open_plant, gain):
    """Closed position loop u = gain (r - x)."""
    return control.feedback(gain * open_plant, 1)


def _log(random, low, high):
    """A number between two, evenly in its logarithm."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _random_side(random, sign, driven):
    """Chamber, line, throttle and line end drawn from common sizes."""
    line = random.random() < 0.6
    throttle = [None, None, 0.0, _log(random, 1e-11, 1e-8)][random.integers(4)]
    if driven and throttle == 0.0:
        throttle = None
    ends = [("conductance", _log(random, 1e-13, 2e-11))] if driven or random.random() < 0.4 else []
    if random.random() < 0.3:
        ends.append(
            (
                "accumulator",
                _log(random, 1e-13, 1e-11),
                _log(random, 1e6, 1e8),
                _log(random, 1e7, 1e10),
            )
        )
    if random.random() < 0.3 and not driven:
        ends.append(
            (
                "reducing",
                _log(random, 1e-12, 1e-9),
                _log(random, 50.0, 2000.0),
                random.uniform(0.2, 1.2),
                _log(random, 1e-13, 1e-11),
            )
        )
    if random.random() < 0.15 and not driven:
        ends = [("constant_pressure",)]
    return {
        "area": _log(random, 2e-4, 2e-3),
        "compliance": _log(random, 1e-14, 3e-13),
        "throttle": throttle,
        "resistance": _log(random, 1e7, 5e9) if line else 0.0,
        "inertance": _log(random, 2e6, 5e7) if line else 0.0,
        "far_compliance": _log(random, 5e-15, 2e-13),
        "ends": ends,
        "flow_gain": sign * _log(random, 1e-6, 5e-5) if driven else 0.0,
    }


def random_circuit(seed, driven=False):
    """A circuit of common sizes, each element there or not; `driven` by a leaking valve."""
    random = np.random.default_rng(seed)
    a, b = _random_side(random, 1.0, driven), _random_side(random, -1.0, driven)
    least = min(a["compliance"], b["compliance"])
    return {
        "a": a,
        "b": b,
        "mass": _log(random, 2.0, 300.0),
        "damping": _log(random, 20.0, 3000.0),
        "coupling": random.choice([0.0, -0.2, 0.3]) * least,
        "leakage": random.choice([0.0, 1e-14, 3e-13]),
        "seal_stiffness": 0.0 if driven else random.choice([0.0, 2e6]),
        "flexibility": random.choice([0.0, 1 / 3e7, 1 / 3e8]),
    }
