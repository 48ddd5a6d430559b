"""Model of a sample of a duty cycle, and its evaluation at all samples of a cycle with slopes.

The model is recorded once per design structure and run by the virtual machine for all samples
together; where the machine is missing, NumPy runs it with a complex step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import STEP, Array, absolute, maximum, real, sqrt, where
from ...base.symbolic.recorded import RecordedFunction
from ...models import lines, linkage, quasi_static
from .numbers import SHARES, Plan

PASSES = 2
"""Passes for friction, which depends on the pressures, and pressures, which depend on friction."""


def sample(plan: Plan, u: Mapping[str, Array], s: Mapping[str, Array]) -> dict[str, Array]:
    """Forces, pressures and flows at a sample; all arguments broadcast.

    Parameters
    ----------
    plan : structure of the design
    u : numbers of the design and of the cycle, see `numbers.collect`
    s : "motion" (joint angle or position), "load" (torque or force), "rate" (slope of the motion by
        time), and "supply" if the cycle states the supply pressure of every sample

    Returns
    -------
    results by name, SI
    """
    position, arm = _kinematics(plan, u, s)
    force = u["load_scale"] * s["load"] / arm
    speed = arm * s["rate"] / u["time_scale"]
    supply = s["supply"] if "supply" in s else u["level"]
    extending = real(speed) >= 0
    areas = u["area_a"], u["area_b"]
    driven, other = where(extending, *areas), where(extending, *areas[::-1])
    pressures = {"supply_pressure": supply, "return_pressure": u["drain"]}
    chambers = {"driven_area": driven, "other_area": other}
    feed: Array = 1.0
    drain: Array = 1.0
    if plan.valve:
        feed = where(extending, u["feed_a"], u["feed_b"])
        drain = where(extending, u["drain_b"], u["drain_a"])
    ratio = quasi_static.edge_ratio(**chambers, feed_coefficient=feed, drain_coefficient=drain)
    line_a, line_b = _line_drops(plan, u, speed)
    outward = where(extending, force, -force) + u["area_a"] * line_a + u["area_b"] * line_b
    driven_line, other_line = where(extending, line_a, line_b), where(extending, line_b, line_a)
    frictions: list[Array] = []
    friction: Array = 0.0 * force
    for _ in range(1 + PASSES):
        state = quasi_static.driven_pressures(
            load=outward + friction, ratio=ratio, **pressures, **chambers
        )
        into, out = state.driven - driven_line, state.other + other_line
        a, b = where(extending, into, out), where(extending, out, into)
        frictions = [_friction(plan, u, i, a, b, speed) for i in range(len(plan.rings))]
        friction = sum(frictions, u["other_friction"])
    needed = quasi_static.needed_supply(
        load=outward + friction,
        speed=speed if plan.valve else 0.0 * speed,
        return_pressure=u["drain"],
        ratio=ratio,
        feed_coefficient=feed,
        opening=u["opening_limit"],
        **chambers,
    )
    leak = _leakage(plan, u, extending, supply, a, b)
    results = {
        "position": position,
        "arm": arm,
        "force": force,
        "speed": speed,
        "supply": supply,
        "pressure_a": a,
        "pressure_b": b,
        "friction": friction,
        "needed": needed,
        "share": needed / supply,
        "reserve": (supply - needed) * driven,
        "leakage": leak,
        "flow": driven * absolute(speed) + leak,
        "power": force * speed,
        "inlet_drop": supply - into,
    }
    if plan.valve:
        moves = real(state.edge_drop) > 0
        drop = where(moves, state.edge_drop, 1.0)
        limit = quasi_static.speed_limit(edge_drop=drop, driven_area=driven, feed_coefficient=feed)
        results["opening"] = where(moves, absolute(speed) / limit, np.inf)
    for i, part in enumerate(frictions):
        results[f"friction{i}"] = part
        results[f"contact{i}"] = _between(u, f"seal{i}.contact", _sealed(plan, i, a, b))
    return results


def _kinematics(plan: Plan, u: Mapping[str, Array], s: Mapping[str, Array]) -> tuple[Array, Array]:
    """Piston position and lever arm; the arm is 1 for a cycle of position and force."""
    if plan.linkage:
        at = linkage.linkage(
            base_radius=u["base_radius"],
            crank_radius=u["crank_radius"],
            joint_angle=s["motion"],
            angle_offset=u["angle_offset"],
        )
        return at.length - u["closed_length"], at.lever_arm
    return u["arm"] * s["motion"] + u["shift"], u["arm"]


def _line_drops(plan: Plan, u: Mapping[str, Array], speed: Array) -> tuple[Array, Array]:
    """Pressure drops of the lines of chambers A and B."""
    drops: dict[str, Array] = {"a": 0.0 * speed, "b": 0.0 * speed}
    for chamber, i in plan.lines:
        flow = u[f"area_{chamber}"] * absolute(speed)
        oil = {"flow": flow, "density": u["density"]}
        inner = u[f"line{i}.inner_diameter"]
        drops[chamber] = (
            drops[chamber]
            + lines.line_pressure_drop(
                inner_diameter=inner,
                length=u[f"line{i}.length"],
                dynamic_viscosity=u["dynamic_viscosity"],
                **oil,
            )
            + lines.fitting_pressure_drop(
                inner_diameter=inner, loss_coefficient=u[f"line{i}.loss_coefficient"], **oil
            )
        )
    return drops["a"], drops["b"]


def _sealed(plan: Plan, i: int, a: Array, b: Array) -> Array:
    """Pressure difference across a seal."""
    name = plan.rings[i].name
    if name == "piston":
        return absolute(a - b)
    return maximum(b if name == "rod" else a, 0.0)


def _between(u: Mapping[str, Array], name: str, pressure: Array) -> Array:
    """A contact result at a sealed pressure, on the parabola through the three known values."""
    low, middle, high = (u[f"{name}[{share}]"] for share in SHARES)
    z = pressure / u["supply"]
    return low + z * ((4 * middle - 3 * low - high) + z * 2 * (low + high - 2 * middle))


def _friction(
    plan: Plan, u: Mapping[str, Array], i: int, a: Array, b: Array, speed: Array
) -> Array:
    """Friction of a seal against the motion; at rest its Coulomb friction."""
    coulomb = _between(u, f"seal{i}.coulomb", _sealed(plan, i, a, b))
    fast = absolute(speed)
    law = plan.rings[i].element.friction_law
    seal: Any = _Seal(u, i)
    running = law.level(seal, coulomb, fast) + u[f"seal{i}.viscous_friction"] * fast
    return where(real(fast) > 0, running, coulomb)


@dataclass(frozen=True, slots=True)
class _Seal:
    """The numbers of a seal by key, as a friction law reads them."""

    numbers: Mapping[str, Array]
    index: int

    def __getitem__(self, key: str) -> Array:
        return self.numbers[f"seal{self.index}.{key}"]


def _leakage(
    plan: Plan, u: Mapping[str, Array], extending: Array, supply: Array, a: Array, b: Array
) -> Array:
    """Leakage that the supply feeds: past the two shut edges, and across the piston."""
    across = u["piston_leakage"] * absolute(a - b)
    if not plan.valve:
        return across

    def edge(name: str, drop: Array) -> Array:
        driving = maximum(drop, 0.0)
        safe = where(real(driving) > 0, driving, 1.0)
        root = where(real(driving) > 0, sqrt(safe), 0.0)
        return u[f"{name}.leak_linear"] * driving + u[f"{name}.leak_root"] * root

    out = edge("feed_b", supply - b) + edge("drain_a", a - u["drain"])
    back = edge("feed_a", supply - a) + edge("drain_b", b - u["drain"])
    return where(extending, out, back) + across


def leakage_at_rest(plan: Plan, u: Mapping[str, Array]) -> Array:
    """Leakage of the valve with blocked ports: each side passes two shut edges in series.

    The pressures between the edges are half of supply plus return, as with equal edges.
    """
    if not plan.valve:
        return 0.0 * u["supply"]
    half = (u["supply"] - u["drain"]) / 2
    root = sqrt(half)
    return sum(u[f"{name}.leak_linear"] * half + u[f"{name}.leak_root"] * root for name in FEEDS)


FEEDS = ("feed_a", "feed_b")


class SampleModel:
    """The model of the samples of a design, as a function of numbers and columns of data.

    Parameters
    ----------
    plan : structure of the design
    names : names of the numbers, in the order of their arrays
    columns : names of the columns of a record
    """

    def __init__(self, plan: Plan, names: Sequence[str], columns: Sequence[str]) -> None:
        self.plan, self.names, self.columns = plan, tuple(names), tuple(columns)
        self.outputs: tuple[str, ...] = ()
        self._recorded: RecordedFunction | None = None

    def _function(self, points: Array) -> Array:
        values = dict(zip((*self.names, *self.columns), points, strict=True))
        results = sample(
            self.plan,
            {name: values[name] for name in self.names},
            {name[1:]: values[name] for name in self.columns},
        )
        self.outputs = tuple(results)
        first = points[0]
        xp: Any = np if type(first) is np.ndarray else first.__array_namespace__()
        rows = [xp.broadcast_to(xp.asarray(row), first.shape) for row in results.values()]
        return xp.stack(rows)

    def run(self, numbers: Array, seeds: Array, data: Array) -> Array:
        """Results (samples, outputs, designs, 1 + directions): values, then slopes.

        Parameters
        ----------
        numbers : values of the numbers (numbers, designs)
        seeds : their changes in every direction (numbers, designs, directions)
        data : columns of the record (samples, columns)
        """
        (count, columns), (width, designs, directions) = data.shape, seeds.shape
        points = np.empty((designs, count, width + columns))
        points[:, :, :width] = numbers.T[:, None]
        points[:, :, width:] = data
        points = points.reshape(designs * count, -1)
        if self._recorded is None:
            names = (*self.names, *self.columns)
            self._recorded = RecordedFunction(self._function, names, points[0].copy())
            self._recorded(points[:1].T)
        recording = self._recorded.recording
        changes = np.zeros((designs, width + columns, directions))
        changes[:, :width] = seeds.transpose(1, 0, 2)
        if recording is None:
            results = self._by_numpy(points, changes)
        elif directions:
            values, slopes = recording.program.slopes(points, changes)
            results = np.concatenate([values[:, :, None], slopes], axis=2)
        else:
            results = recording.program.values(points)[:, :, None]
        if recording is not None:
            outside = ~recording.holds(results[:, :, 0])
            results = results[:, : recording.rows]
            for k in np.flatnonzero(outside):
                results[k] = self._by_numpy(points[k : k + 1], changes[k // count, None])[0]
        return results.reshape(designs, count, -1, 1 + directions).transpose(1, 2, 0, 3)

    def _by_numpy(self, points: Array, changes: Array) -> Array:
        """Results (points, outputs, 1 + directions); changes (designs, inputs, directions)."""
        directions = changes.shape[2]
        with np.errstate(all="ignore"):
            if not directions:
                return self._function(points.T).T[:, :, None]
            steps = np.repeat(changes, len(points) // len(changes), axis=0)
            stepped = (points[:, :, None] + 1j * STEP * steps).transpose(1, 0, 2)
            rows = self._function(stepped.reshape(len(stepped), -1))
        rows = rows.reshape(len(rows), len(points), directions).transpose(1, 0, 2)
        return np.concatenate([rows.real[:, :, :1], rows.imag / STEP], axis=2)
