"""Model of a sample of a duty cycle, and its evaluation at all samples of a cycle with slopes.

The model is recorded once per design structure and run by the virtual machine for all samples
together; where the machine is missing, NumPy runs it with a complex step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.dataclass import dataclass
from ...base.numeric import STEP, Array, absolute, maximum, minimum, real, sqrt, where
from ...base.symbolic.recorded import RecordedFunction
from ...models import lapped_edge, lines, linkage, quasi_static
from .numbers import LAP, SHARES, SPOOL, SamplePlan

PASSES = 2
"""Passes for friction, which depends on the pressures, and pressures, which depend on friction."""


def sample(
    plan: SamplePlan, u: Mapping[str, Array], s: Mapping[str, Array], *, linked: bool
) -> dict[str, Array]:
    """Forces, pressures and flows at a sample; all arguments broadcast.

    Parameters
    ----------
    plan : structure of the design
    u : numbers of the design and of the cycle, see `numbers.collect`
    s : "motion" (joint angle or position), "load" (torque or force), "rate" (slope of the motion by
        time), and "supply" if the cycle states the supply pressure of every sample
    linked : whether the linkage gives position and lever arm

    Returns
    -------
    results by name, SI
    """
    position, arm = _kinematics(u, s, linked=linked)
    move = _Move(plan, u, u["load_scale"] * s["load"] / arm, arm * s["rate"] / u["time_scale"])
    supply = s["supply"] if "supply" in s else u["level"]
    balance = _balanced(plan, u, move, supply)
    driven = move.chambers["driven_area"]
    needed = quasi_static.needed_supply(
        load=move.against + sum(balance.frictions, u["other_friction"]),
        speed=move.speed if plan.valve else 0.0 * move.speed,
        return_pressure=u["drain"],
        ratio=move.ratio,
        feed_coefficient=move.feed,
        opening=u["opening_limit"],
        **move.chambers,
    )
    a, b = balance.a, balance.b
    opening = _opening(move, balance.edge_drop) if plan.valve else 0.0
    leak = _leakage(plan, u, move.extending, supply, a, b, opening)
    results = {
        "position": position,
        "arm": arm,
        "force": move.force,
        "speed": move.speed,
        "supply": supply,
        "pressure_a": a,
        "pressure_b": b,
        "friction": sum(balance.frictions, u["other_friction"]),
        "needed": needed,
        "share": needed / supply,
        "reserve": (supply - needed) * driven,
        "leakage": leak,
        "flow": driven * absolute(move.speed) + leak,
        "power": move.force * move.speed,
        "inlet_drop": supply - where(move.extending, a, b),
    }
    if plan.valve:
        results["opening"] = opening
    for i, part in enumerate(balance.frictions):
        results[f"friction{i}"] = part
        results[f"contact{i}"] = _between(u, f"seal{i}.contact", _sealed(plan, i, a, b))
    return results


class _Move:
    """A motion with its load: direction, chambers, edges, and force against the motion."""

    def __init__(
        self, plan: SamplePlan, u: Mapping[str, Array], force: Array, speed: Array
    ) -> None:
        self.force, self.speed = force, speed
        self.extending = real(speed) >= 0
        areas = u["area_a"], u["area_b"]
        self.chambers = {
            "driven_area": where(self.extending, *areas),
            "other_area": where(self.extending, *areas[::-1]),
        }
        self.feed: Array = 1.0
        drain: Array = 1.0
        if plan.valve:
            self.feed = where(self.extending, u["feed_a"], u["feed_b"])
            drain = where(self.extending, u["drain_b"], u["drain_a"])
        self.ratio = quasi_static.edge_ratio(
            **self.chambers, feed_coefficient=self.feed, drain_coefficient=drain
        )
        self.line_a, self.line_b = _line_drops(plan, u, speed)
        self.against = (
            where(self.extending, force, -force)
            + u["area_a"] * self.line_a
            + u["area_b"] * self.line_b
        )
        """Force of load and lines against the motion, without friction [N]."""


class _Balance(NamedTuple):
    """Chamber pressures, drop of the feeding edge, and friction of each seal."""

    a: Array
    b: Array
    edge_drop: Array
    frictions: list[Array]


def _balanced(plan: SamplePlan, u: Mapping[str, Array], move: _Move, supply: Array) -> _Balance:
    """Pressures and friction, which depend on each other."""
    lines = where(move.extending, move.line_a, move.line_b)
    others = where(move.extending, move.line_b, move.line_a)
    friction: Array = 0.0 * move.force
    for _ in range(1 + PASSES):
        state = quasi_static.driven_pressures(
            load=move.against + friction,
            supply_pressure=supply,
            return_pressure=u["drain"],
            ratio=move.ratio,
            **move.chambers,
        )
        into, out = state.driven - lines, state.other + others
        a, b = where(move.extending, into, out), where(move.extending, out, into)
        frictions = [_friction(plan, u, i, a, b, move.speed) for i in range(len(plan.rings))]
        friction = sum(frictions, u["other_friction"])
    return _Balance(a, b, state.edge_drop, frictions)


def _opening(move: _Move, edge_drop: Array) -> Array:
    """Opening of the valve as a share of its stroke; infinite past stall."""
    moves = real(edge_drop) > 0
    limit = quasi_static.speed_limit(
        edge_drop=where(moves, edge_drop, 1.0),
        driven_area=move.chambers["driven_area"],
        feed_coefficient=move.feed,
    )
    return where(moves, absolute(move.speed) / limit, np.inf)


def _kinematics(
    u: Mapping[str, Array], s: Mapping[str, Array], *, linked: bool
) -> tuple[Array, Array]:
    """Piston position and lever arm; the arm is 1 for a cycle of position and force."""
    if linked:
        at = linkage.linkage(
            base_radius=u["base_radius"],
            crank_radius=u["crank_radius"],
            joint_angle=s["motion"],
            angle_offset=u["angle_offset"],
        )
        return at.length - u["closed_length"], at.lever_arm
    return u["arm"] * s["motion"] + u["shift"], u["arm"]


def _line_drops(plan: SamplePlan, u: Mapping[str, Array], speed: Array) -> tuple[Array, Array]:
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


def _sealed(plan: SamplePlan, i: int, a: Array, b: Array) -> Array:
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
    plan: SamplePlan, u: Mapping[str, Array], i: int, a: Array, b: Array, speed: Array
) -> Array:
    """Friction of a seal against the motion; at rest it must break away."""
    coulomb = _between(u, f"seal{i}.coulomb", _sealed(plan, i, a, b))
    fast = absolute(speed)
    law = plan.rings[i].element.friction_law
    seal: Any = _Seal(u, i)
    return law.level(seal, coulomb, fast) + u[f"seal{i}.viscous_friction"] * fast


@dataclass(frozen=True, slots=True)
class _Seal:
    """The numbers of a seal by key, as a friction law reads them."""

    numbers: Mapping[str, Array]
    index: int

    def __getitem__(self, key: str) -> Array:
        return self.numbers[f"seal{self.index}.{key}"]


def _leakage(
    plan: SamplePlan,
    u: Mapping[str, Array],
    extending: Array,
    supply: Array,
    a: Array,
    b: Array,
    opening: Array,
) -> Array:
    """Leakage that the supply feeds: past the two shut edges, and across the piston."""
    across = u["piston_leakage"] * absolute(a - b)
    if not plan.valve:
        return across
    drops = supply - where(extending, b, a), where(extending, a, b) - u["drain"]
    if plan.lapped:
        return _lapped_leakage(u, extending, opening, *drops) + across

    def edge(name: str, drop: Array) -> Array:
        driving = maximum(drop, 0.0)
        safe = where(real(driving) > 0, driving, 1.0)
        root = where(real(driving) > 0, sqrt(safe), 0.0)
        return u[f"{name}.leak_linear"] * driving + u[f"{name}.leak_root"] * root

    out = edge("feed_b", drops[0]) + edge("drain_a", drops[1])
    back = edge("feed_a", drops[0]) + edge("drain_b", drops[1])
    return where(extending, out, back) + across


def _lapped_leakage(
    u: Mapping[str, Array], extending: Array, opening: Array, feed_drop: Array, drain_drop: Array
) -> Array:
    """Flow past both shut edges of a lapped spool, which laps them farther as it opens the others.

    The spool moves from where the feeding edge uncovers its port, in proportion to the opening.
    """
    start = where(extending, u["feed_a.overlap"], u["feed_b.overlap"])
    place = start + minimum(opening, 1.0) * (u["spool.stroke"] - start)
    oil = {key: u[f"spool.{key}"] for key in SPOOL if key != "stroke"}
    flow: Array = 0.0
    for out, back, drop in (
        ("feed_b", "feed_a", feed_drop),
        ("drain_a", "drain_b", drain_drop),
    ):
        shut = {key: where(extending, u[f"{out}.{key}"], u[f"{back}.{key}"]) for key in LAP}
        flow = flow + lapped_edge.lapped_edge_flow(
            uncovered=-place - shut.pop("overlap"), pressure_drop=maximum(drop, 0.0), **shut, **oil
        )
    return flow


def leakage_at_rest(plan: SamplePlan, u: Mapping[str, Array]) -> Array:
    """Leakage of the valve with blocked ports: each side passes two shut edges in series.

    The pressures between the edges are half of supply plus return, as with equal edges.
    """
    if not plan.valve:
        return 0.0 * u["supply"]
    half = (u["supply"] - u["drain"]) / 2
    root = sqrt(half)
    return sum(u[f"{name}.leak_linear"] * half + u[f"{name}.leak_root"] * root for name in FEEDS)


FEEDS = ("feed_a", "feed_b")


@dataclass(frozen=True)
class SampleResults:
    """Results of all samples of a cycle, with slopes in every direction.

    Arrays are (samples, columns): a column for each design, or for each direction of each design;
    their imaginary parts are then the slopes times the complex step.
    """

    values: npt.NDArray[np.float64]
    """(samples, outputs, designs, 1 + directions)"""
    outputs: tuple[str, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Number of designs, and of columns of each."""
        designs, width = self.values.shape[2:]
        return designs, max(width - 1, 1)

    def array(self, name: str) -> Array:
        """A result at all samples (samples, columns)."""
        part = complexed(self.values[:, self.outputs.index(name)])
        return part.reshape(len(part), -1)

    def real(self, name: str) -> npt.NDArray[np.float64]:
        """A result at all samples, without slopes (samples, designs)."""
        return self.values[:, self.outputs.index(name), :, 0]


def complexed(part: Array) -> Array:
    """Values and slopes (..., 1 + directions) as complex numbers (..., directions)."""
    if part.shape[-1] == 1:
        return part
    result = np.empty((*part.shape[:-1], part.shape[-1] - 1), dtype=complex)
    result.real = part[..., :1]
    result.imag = STEP * part[..., 1:]
    return result


class SampleModel:
    """The model of the samples of a design, as a function of numbers and columns of data.

    Parameters
    ----------
    plan : structure of the design
    names : names of the numbers, in the order of their arrays
    columns : names of the columns of a record
    linked : whether the linkage gives position and lever arm
    """

    def __init__(
        self, plan: SamplePlan, names: Sequence[str], columns: Sequence[str], linked: bool
    ) -> None:
        self.plan, self.names, self.columns = plan, tuple(names), tuple(columns)
        self.linked = linked
        self.outputs: tuple[str, ...] = ()
        self._recorded: RecordedFunction | None = None

    def _function(self, points: Array) -> Array:
        values = dict(zip((*self.names, *self.columns), points, strict=True))
        results = sample(
            self.plan,
            {name: values[name] for name in self.names},
            {name[1:]: values[name] for name in self.columns},
            linked=self.linked,
        )
        self.outputs = tuple(results)
        first = points[0]
        xp: Any = np if type(first) is np.ndarray else first.__array_namespace__()
        rows = [xp.broadcast_to(xp.asarray(row), first.shape) for row in results.values()]
        return xp.stack(rows)

    def run(self, numbers: Array, seeds: Array, data: Array) -> SampleResults:
        """Results of all samples.

        Parameters
        ----------
        numbers : values of the numbers (numbers, designs)
        seeds : their changes in every direction (numbers, designs, directions)
        data : columns of the record (samples, columns)
        """
        active = seeds.any(axis=(0, 1))
        if 0 < active.sum() < len(active):  # the other directions change nothing
            track = self.run(numbers, seeds[:, :, active], data)
            results = np.zeros((*track.values.shape[:3], 1 + len(active)))
            results[..., np.append(True, active)] = track.values
            return SampleResults(results, self.outputs)
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
        results = results.reshape(designs, count, -1, 1 + directions).transpose(1, 2, 0, 3)
        return SampleResults(results, self.outputs)

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
