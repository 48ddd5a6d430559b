"""Model of a sample of a duty cycle; `sampling` computes it at all samples, with slopes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import Array, absolute, maximum, minimum, real, sqrt, where
from ...models import lapped_edge, lines, linkage, quasi_static, wear
from .numbers import LAP, SPOOL, SamplePlan

PASSES = 2
"""Passes for friction, which depends on the pressures, and pressures, which depend on friction."""


COLUMNS = ("motion", "load", "rate")
"""Columns of data of a sample: joint angle or position, torque or force, and the slope of the
motion by time. A cycle may also have "supply", the supply pressure."""
NEIGHBOURS = (
    "motion_before", "load_before", "motion_after", "load_after", "time_weight", "time_share",
    "ripple_weight", "peak_weight",
)  # fmt: skip
"""Further columns of data for the sums over a cycle.

They are the samples before and after (at the ends the sample itself), the time of the sample and
its share of the period, and weights of the flow: in the ripple volume, and in the largest flow of
all actuators."""
SUMS = (
    "duration", "way", "volume", "supply_energy", "leakage_energy", "work_out", "work_in",
    "friction_energy", "return_energy", "throttling_energy", "oil_volume", "position_mean",
    "inlet_heat", "inlet_volume", "ripple_volume", "flow_total",
)  # fmt: skip
"""Sums over a cycle."""
SEAL_SUMS = ("severity", "seal_friction_energy")
"""Sums over a cycle for each seal."""


def sample(
    plan: SamplePlan,
    u: Mapping[str, Array],
    s: Mapping[str, Array],
    *,
    linked: bool,
    extending: bool | None = None,
) -> dict[str, Array]:
    """Forces, pressures and flows at a sample; all arguments broadcast.

    Parameters
    ----------
    plan : structure of the design
    u : numbers of the design and of the cycle, see `numbers.collect`
    s : the columns of data of the sample, see `COLUMNS`
    linked : whether the linkage gives position and lever arm
    extending : direction of the rod; None: by the speed, of which zero counts as extending

    Returns
    -------
    results by name, SI
    """
    position, arm = _kinematics(u, s["motion"], linked=linked)
    force, speed = u["load_scale"] * s["load"] / arm, arm * s["rate"] / u["time_scale"]
    move = _Move(plan, u, force, speed, extending)
    supply = s["supply"] if "supply" in s else u["level"]
    balance = _balanced(plan, u, move, supply)
    friction = sum(balance.frictions, u["other_friction"])
    needed = quasi_static.needed_supply(
        load=move.against + friction,
        speed=move.fast if plan.valve else 0.0 * move.fast,
        return_pressure=u["drain"],
        ratio=move.ratio,
        feed_coefficient=move.feed,
        opening=u["opening_limit"],
        **move.chambers,
    )
    a, b = balance.a, balance.b
    driven, other = where(move.extending, a, b), where(move.extending, b, a)
    opening = _opening(move, balance.edge_drop) if plan.valve else 0.0
    leak = _leakage(plan, u, move, supply, driven, other, opening)
    results = {
        "position": position,
        "arm": arm,
        "force": move.force,
        "speed": move.speed,
        "supply": supply,
        "pressure_a": a,
        "pressure_b": b,
        "friction": friction,
        "needed": needed,
        "share": needed / supply,
        "reserve": (supply - needed) * move.chambers["driven_area"],
        "leakage": leak,
        "flow": move.chambers["driven_area"] * move.fast + leak,
        "power": move.force * move.speed,
        "inlet_drop": supply - driven,
    }
    if plan.parts:
        results["pulse_a"], results["pulse_b"] = a / u["supply"], b / u["supply"]
        results["pulse_rod"] = -move.force / u["rod_pulse"]
    if plan.valve:
        results["opening"] = opening
    for i, part in enumerate(balance.frictions):
        contact = _parabola(u, f"seal{i}.contact", _sealed(plan, i, a, b))
        results[f"friction{i}"] = part
        results[f"contact{i}"] = contact
        results[f"pv{i}"] = wear.pressure_velocity(contact_pressure=contact, speed=move.fast)
    return results


def summands(
    plan: SamplePlan,
    u: Mapping[str, Array],
    s: Mapping[str, Array],
    *,
    linked: bool,
    extending: bool | None = None,
) -> list[Array]:
    """Summands of a sample in every one of `SUMS`, and in `SEAL_SUMS` of each seal, SI.

    Sums over the motion are those of the trapezoid rule between positions, sums over time those of
    the trapezoid rule in time: a sample has half of the interval before and half of that after it.
    Arguments are those of `sample`; `s` also has the columns `NEIGHBOURS`.
    """
    here = sample(plan, u, s, linked=linked, extending=extending)
    x, supply = here["position"], here["supply"]
    ends = []
    for word in ("before", "after"):
        position, arm = _kinematics(u, s[f"motion_{word}"], linked=linked)
        force = 0.5 * (u["load_scale"] * s[f"load_{word}"] / arm + here["force"])
        ends.append(_interval(u, x - position if word == "before" else position - x, force))
    way, volume, returned, out, absorbed = (
        0.5 * (one + two) for one, two in zip(*ends, strict=True)
    )
    time = s["time_weight"] * u["time_scale"]
    leaked = here["leakage"] * time
    supplied, drained = supply * volume, u["drain"] * returned
    rubbed = here["friction"] * way
    sums = {
        "duration": time,
        "way": way,
        "volume": volume + leaked,
        "supply_energy": supplied + supply * leaked,
        "leakage_energy": supply * leaked,
        "work_out": out,
        "work_in": absorbed,
        "friction_energy": rubbed,
        "return_energy": drained,
        "throttling_energy": supplied - drained - (out - absorbed) - rubbed,
        "oil_volume": (u["area_a"] * x + u["area_b"] * (u["stroke"] - x)) * s["time_share"],
        "position_mean": x * s["time_share"],
        "inlet_heat": here["inlet_drop"] * volume,
        "inlet_volume": volume,
        "ripple_volume": here["flow"] * s["ripple_weight"] * u["time_scale"],
        "flow_total": here["flow"] * s["peak_weight"],
    }
    seals = range(len(plan.rings))
    return [
        *(sums[name] for name in SUMS),
        *(here[f"contact{i}"] * way for i in seals),
        *(here[f"friction{i}"] * way for i in seals),
    ]


class _Interval(NamedTuple):
    """Motion between two samples."""

    way: Array
    volume: Array
    """Oil from the supply [m^3]."""
    returned: Array
    """Oil to the return line [m^3]."""
    out: Array
    """Work on the load [J]."""
    absorbed: Array
    """Work of the load [J]."""


def _interval(u: Mapping[str, Array], step: Array, force: Array) -> _Interval:
    """Motion by a step, under the mean force."""
    outward = real(step) > 0
    way = where(outward, step, -step)
    work = force * step
    out = where(real(work) > 0, work, 0.0)
    return _Interval(
        way,
        where(outward, u["area_a"], u["area_b"]) * way,
        where(outward, u["area_b"], u["area_a"]) * way,
        out,
        out - work,
    )


class _Move:
    """A motion with its load: direction, chambers, edges, and force against the motion."""

    def __init__(
        self,
        plan: SamplePlan,
        u: Mapping[str, Array],
        force: Array,
        speed: Array,
        extending: bool | None,
    ) -> None:
        self.force, self.speed = force, speed
        self.extending: Array = real(speed) >= 0 if extending is None else extending
        self.fast = where(self.extending, speed, -speed)
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
        self.drops = _line_drops(plan, u, self.fast)
        self.against = where(self.extending, force, -force)
        """Force of load and lines against the motion, without friction [N]."""
        for chamber, drop in self.drops.items():
            self.against = self.against + u[f"area_{chamber}"] * drop

    def pressures(self, driven: Array, other: Array) -> tuple[Array, Array]:
        """Pressures of chambers A and B from those at the valve."""
        a, b = where(self.extending, driven, other), where(self.extending, other, driven)
        into = where(self.extending, 1.0, -1.0)
        if "a" in self.drops:
            a = a - into * self.drops["a"]
        return a, b + into * self.drops["b"] if "b" in self.drops else b


class _Balance(NamedTuple):
    """Chamber pressures, drop of the feeding edge, and friction of each seal."""

    a: Array
    b: Array
    edge_drop: Array
    frictions: list[Array]


def _balanced(plan: SamplePlan, u: Mapping[str, Array], move: _Move, supply: Array) -> _Balance:
    """Pressures and friction, which depend on each other."""
    load = move.against
    for _ in range(1 + PASSES):
        state = quasi_static.driven_pressures(
            load=load,
            supply_pressure=supply,
            return_pressure=u["drain"],
            ratio=move.ratio,
            **move.chambers,
        )
        a, b = move.pressures(state.driven, state.other)
        frictions = [_friction(plan, u, i, a, b, move.fast) for i in range(len(plan.rings))]
        load = move.against + sum(frictions, u["other_friction"])
    return _Balance(a, b, state.edge_drop, frictions)


def _opening(move: _Move, edge_drop: Array) -> Array:
    """Opening of the valve as a share of its stroke; infinite past stall."""
    moves = real(edge_drop) > 0
    limit = quasi_static.speed_limit(
        edge_drop=where(moves, edge_drop, 1.0),
        driven_area=move.chambers["driven_area"],
        feed_coefficient=move.feed,
    )
    return where(moves, move.fast / limit, np.inf)


def _kinematics(u: Mapping[str, Array], motion: Array, *, linked: bool) -> tuple[Array, Array]:
    """Piston position and lever arm; the arm is 1 for a cycle of position and force."""
    if linked:
        at = linkage.linkage(
            base_radius=u["base_radius"],
            crank_radius=u["crank_radius"],
            joint_angle=motion,
            angle_offset=u["angle_offset"],
        )
        return at.length - u["closed_length"], at.lever_arm
    return u["arm"] * motion + u["shift"], u["arm"]


def _line_drops(plan: SamplePlan, u: Mapping[str, Array], speed: Array) -> dict[str, Array]:
    """Pressure drops of the lines of chambers A and B, if any, at a speed without sign."""
    drops: dict[str, Array] = {}
    for chamber, i in plan.lines:
        flow = u[f"area_{chamber}"] * speed
        oil = {"flow": flow, "density": u["density"]}
        inner = u[f"line{i}.inner_diameter"]
        drops[chamber] = (
            drops.get(chamber, 0.0)
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
    return drops


def _sealed(plan: SamplePlan, i: int, a: Array, b: Array) -> Array:
    """Pressure difference across a seal."""
    name = plan.rings[i].name
    if name == "piston":
        return absolute(a - b)
    return maximum(b if name == "rod" else a, 0.0)


def _parabola(u: Mapping[str, Array], name: str, pressure: Array) -> Array:
    """A contact result at a sealed pressure."""
    constant, slope, curve = (u[f"{name}[{power}]"] for power in range(3))
    return constant + pressure * (slope + pressure * curve)


def _friction(
    plan: SamplePlan, u: Mapping[str, Array], i: int, a: Array, b: Array, fast: Array
) -> Array:
    """Friction of a seal against the motion; at rest it must break away."""
    coulomb = _parabola(u, f"seal{i}.coulomb", _sealed(plan, i, a, b))
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
    move: _Move,
    supply: Array,
    driven: Array,
    other: Array,
    opening: Array,
) -> Array:
    """Leakage that the supply feeds: past the two shut edges, and across the piston."""
    across = u["piston_leakage"] * absolute(driven - other)
    if not plan.valve:
        return across
    out, drops = move.extending, (supply - other, driven - u["drain"])
    if plan.lapped:
        return _lapped_leakage(u, out, opening, *drops) + across

    def edge(extending: str, retracting: str, drop: Array) -> Array:
        driving = maximum(drop, 0.0)
        safe = where(real(driving) > 0, driving, 1.0)
        root = where(real(driving) > 0, sqrt(safe), 0.0)
        linear, turbulent = (
            where(out, u[f"{extending}.{key}"], u[f"{retracting}.{key}"])
            for key in ("leak_linear", "leak_root")
        )
        return linear * driving + turbulent * root

    return edge("feed_b", "feed_a", drops[0]) + edge("drain_a", "drain_b", drops[1]) + across


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
