"""Numbers of a design on which its duty cycles depend: areas, linkage, edges, seals, strengths.

Each number is a float or an array (designs,), under a name. The model of the samples sees nothing
else of a design, so that a cycle of any length is a function of these few numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from ...base.dataclass import dataclass
from ...base.numeric import Array, array_of, maximum, minimum, namespace, sqrt
from ...design.cycle_record import CycleRecord
from ...design.duty import DutyCycle, DutySection
from ...design.model import Design
from ...joints.joint import Life
from ...models import friction, lines, rod
from ...models.lapped_spool import LappedSpool
from ...models.metering_spool import MeteringSpool, spool_flows
from .. import circuit, piston_nut, rings as rings_module, rod_strength, sealing, spool
from ..barrel import SEAL_STEP, Wall
from ..geometry import Geometry
from ..limits import MaterialValues
from ..rings import BLOCKS, Ring
from ..rods import RodSection
from ..service import THREAD_NOTCH
from ..state import LoadState, dynamic_viscosity, kinematic_viscosity, oil_density
from ..strength import LoadedJoint
from ..values import Values

Numbers = dict[str, Array]
SHARES = (0.0, 0.5, 1.0)
"""Sealed pressures at which the contact of a seal is computed, as shares of the supply pressure;
in between it follows the parabola through these three points, see `_parabola`."""
CYCLE = ("load_scale", "time_scale", "level", "arm", "shift")
"""Numbers of a cycle that its samples need; their names are those of the cycle, a bar, and this."""
LIFE = ("repeats", "starts")
"""Numbers of a cycle that its share of the life needs."""
STRESS = ("span", "offset", "slope", "ultimate", "limit", "limit_cycles")
"""Numbers of a part of metal: range of its stress under the full pulse of its load, offset and
slope of its mean stress, tensile strength, fatigue strength, and the cycles of that strength."""
EDGES = {"feed_a": "supply_a", "feed_b": "supply_b", "drain_a": "a_tank", "drain_b": "b_tank"}
"""Edges from supply to chamber A and B, and from A and B to the return line, with their names in
`MeteringSpool`."""
LAP = ("overlap", "area_gradient", "clearance", "rounding")
"""Numbers of an edge of a lapped spool, see `lapped_spool.SpoolEdge`."""
SPOOL = ("stroke", "density", "dynamic_viscosity", "flow_coefficient")
"""Numbers of a lapped spool, see `lapped_spool.LappedSpool`."""


History = Literal["a", "b", "middle", "rod"]
"""Load of a part along a cycle: pressure of chamber A or B, pressure on the wall in the middle of
the travel, where the piston passes, or the tension of the rod."""


@dataclass(frozen=True, slots=True)
class FatiguePart:
    """A part that a load along the cycle fatigues, in proportion.

    Parameters
    ----------
    place : name of the part
    load : its history
    bolted : whether it follows the line of bolts, through its life under the full pulse; otherwise
        that of a metal with known strengths
    only_tension : whether compression leaves the part without stress
    """

    place: str
    load: History
    bolted: bool = False
    only_tension: bool = False


@dataclass(frozen=True, slots=True)
class SamplePlan:
    """Structure of a design, for the model of the samples."""

    linked: frozenset[str]
    """Cycles whose position and lever arm follow from the linkage."""
    valve: bool
    lines: tuple[tuple[str, int], ...]
    """Chamber and index of each line."""
    rings: tuple[Ring, ...]
    """Sliding seals; only their names and laws are used."""
    parts: tuple[FatiguePart, ...]
    unknown: Mapping[str, str]
    """Parts that are not assessed for fatigue, with the reason."""
    lapped: bool = False
    """Whether the leakage is that of a lapped spool at its position."""


def collect(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    wall: Wall,
    sections: Sequence[RodSection],
    loaded_joints: Sequence[LoadedJoint],
    leakage: Array,
) -> tuple[SamplePlan, Numbers]:
    """The plan of the samples, and all numbers on which they depend."""
    supply, drain = v["supply.pressure"], v["supply.return_pressure"]
    numbers: Numbers = {
        "supply": supply,
        "drain": drain,
        "area_a": g.area_a,
        "area_b": g.area_b,
        "stroke": g.stroke,
        "closed_length": g.closed_length,
        "opening_limit": v["duty.opening_limit"],
        "piston_leakage": largest(leakage),
    }
    assert design.duty is not None
    for cycle in design.duty.cycles:
        numbers |= _cycle(v, design, cycle, design.duty.record(cycle), g)
    for chamber in ("a", "b"):
        numbers[f"line_volume_{chamber}"] = sum(
            lines.line_volume(
                inner_diameter=v[f"lines[{i}].inner_diameter"], length=v[f"lines[{i}].length"]
            )
            for i, line in enumerate(design.lines)
            if line.chamber == chamber
        )
    if design.linkage is not None:
        for key in ("base_radius", "crank_radius", "angle_offset"):
            numbers[key] = v[f"linkage.{key}"]
    resting = _at_rest(v, design, stock, state)
    lapped = False
    if design.valve is not None:
        edges, lapped = _edges(v, design, resting)
        numbers |= edges
    for i, _ in enumerate(design.lines):
        for key in ("inner_diameter", "length", "loss_coefficient"):
            numbers[f"line{i}.{key}"] = v[f"lines[{i}].{key}"]
    if design.lines:
        numbers["density"] = _flat(resting.density)
        numbers["dynamic_viscosity"] = _flat(resting.dynamic_viscosity)
    seals = _seals(v, design, stock, g, resting, wall, sections, supply, numbers)
    parts, unknown = _fatigue(v, design, stock, g, wall, sections, loaded_joints, supply, numbers)
    lined = tuple((line.chamber, i) for i, line in enumerate(design.lines))
    linked = frozenset(
        cycle.name
        for cycle in design.duty.cycles
        if cycle.lever_arm is None and design.duty.record(cycle).joint
    )
    plan = SamplePlan(linked, design.valve is not None, lined, seals, parts, unknown, lapped)
    return plan, numbers


def _cycle(
    v: Values, design: Design, cycle: DutyCycle, record: CycleRecord, g: Geometry
) -> Numbers:
    """Numbers of one cycle."""
    at, name = f"duty.cycles[{cycle.name}].", cycle.name
    joint = record.joint
    arm: Array = 1.0
    shift: Array = 0.0
    if joint and cycle.lever_arm is not None:
        arm = v[f"{at}lever_arm"]
        low, high = record.motion.min(), record.motion.max()
        shift = g.stroke / 2 - arm * (low + high) / 2
    assert design.duty is not None
    numbers = {
        "load_scale": v[at + ("torque_scale" if joint else "force_scale")],
        "time_scale": v[f"{at}time_scale"],
        "level": level_of(v, design.duty, cycle),
        "arm": arm,
        "shift": shift,
    }
    if cycle.repeats is not None:
        numbers |= {key: v[at + key] for key in LIFE}
    return {f"{name}|{key}": value for key, value in numbers.items()}


def level_of(v: Values, duty: DutySection, cycle: DutyCycle) -> Array:
    """Supply pressure of a cycle [Pa]: the supply gives no more than its own pressure."""
    most, path = v["supply.pressure"], duty.pressure_path(cycle)
    return most if path == "supply.pressure" else minimum(v[path], most)


def largest(value: Array) -> Array:
    """Largest value over the load cases, (designs,)."""
    rows = np.atleast_2d(array_of(value))
    largest: Array = rows[0]
    for k in range(1, rows.shape[0]):
        largest = maximum(largest, rows[k])
    return largest


def smallest(value: Array) -> Array:
    """Smallest value over the load cases, (designs,)."""
    return -largest(-value)


def _flat(value: Array) -> Array:
    """A value of the single state at rest: a float or an array (designs,)."""
    array = array_of(value)
    return array[0] if array.ndim > 1 else array


def _at_rest(v: Values, design: Design, stock: MaterialValues, state: LoadState) -> LoadState:
    """State of one load case without pressure and motion, at the temperature of the oil."""
    temperature = np.array([[1.0]]) * v["fluid.temperature"]
    nothing = 0.0 * temperature
    return replace(
        state,
        push=np.array([[True]]),
        positions=(None,),
        speed=nothing,
        side_load=nothing,
        temperature=temperature,
        driven_pressure=nothing,
        moving_a=nothing,
        moving_b=nothing,
        kinematic_viscosity=kinematic_viscosity(v, design.fluid, stock, temperature),
        density=oil_density(v, design.fluid, stock, temperature),
        dynamic_viscosity=dynamic_viscosity(v, design.fluid, stock, temperature, nothing),
    )


def _edges(v: Values, design: Design, resting: LoadState) -> tuple[Numbers, bool]:
    """Coefficients of the open edges, and leakage of the shut edges; whether the spool is lapped.

    With the spool centred, a shut edge leaks q = G dp + K sqrt(dp), through its flows at half and
    at all of the pressure between supply and return. Edges of a lapped spool state their law too:
    they leak less, the farther the spool laps them.
    """
    metering = circuit.metering_spool(v, design, resting)
    if metering is None:
        course = spool.course_edges(circuit.of_valve(v), viscosity=resting.kinematic_viscosity)
        numbers = {name: _flat(course.rated) for name in EDGES}
        numbers |= {
            f"{name}.leak_root": _flat(course.supply if "feed" in name else course.tank)
            for name in EDGES
        }
        return numbers | {f"{name}.leak_linear": 0.0 for name in EDGES}, False
    numbers = _metering_edges(metering, v["valve.signal"], v["supply.pressure"])
    if not isinstance(metering, LappedSpool):
        return numbers, False
    edges = {name: getattr(metering, edge) for name, edge in EDGES.items()}
    if any(edge.clearance is None for edge in edges.values()):
        return numbers, False
    for name, edge in edges.items():
        numbers |= {f"{name}.{key}": _flat(getattr(edge, key)) for key in LAP}
    return numbers | {f"spool.{key}": _flat(getattr(metering, key)) for key in SPOOL}, True


def _metering_edges(metering: MeteringSpool, signal: Array, supply: Array) -> Numbers:
    numbers: Numbers = {}
    half = 0.5 * supply

    def flows(value: Array, drop: Array) -> Numbers:
        """Flows of the four edges, each under the same pressure drop."""
        return dict(
            zip(
                ("feed_a", "feed_b", "drain_a", "drain_b"),
                spool_flows(
                    spool=metering,
                    signal=value,
                    supply_pressure=2 * drop,
                    return_pressure=0.0 * drop,
                    pressure_a=drop,
                    pressure_b=drop,
                )[:4],
                strict=True,
            )
        )

    outward, inward = flows(signal, half), flows(-signal, half)
    for name, way in zip(EDGES, (outward, inward, inward, outward), strict=True):
        numbers[name] = _flat(way[name]) / sqrt(half)
    low, high = flows(0.0 * signal, half), flows(0.0 * signal, supply)
    for name in EDGES:
        # q1 = G h + K sqrt(h), q2 = 2 G h + K sqrt(2 h)
        first, second = _flat(low[name]), _flat(high[name])
        root = (2 * first - second) / ((2 - 2**0.5) * sqrt(half))
        numbers[f"{name}.leak_root"] = root
        numbers[f"{name}.leak_linear"] = (first - root * sqrt(half)) / half
    return numbers


def _seals(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    resting: LoadState,
    wall: Wall,
    sections: Sequence[RodSection],
    supply: Array,
    numbers: Numbers,
) -> tuple[Ring, ...]:
    """Friction and contact pressure of every sliding seal at the pressures `SHARES`."""
    seals = rings_module.rings(v, design, stock, g, resting, 0.0)
    growth = wall.growths.get("", next(iter(wall.growths.values())))
    growth = largest(growth)
    for i, ring in enumerate(seals):
        assert ring.name != "static"
        sealing_ring = ring.groove.path == f"seals.{BLOCKS[ring.name]}."  # others are not pressed
        levels, contacts = [], []
        for share in SHARES:
            pressed = ring.at(pressure=(share if sealing_ring else 0.0) * supply)
            if ring.name == "piston":
                lost = SEAL_STEP * share * growth / ring.groove.section
                pressed = pressed.at(squeeze_left=pressed["squeeze_left"] - lost)
            contact = rings_module.seal_contact(pressed)
            law = ring.element.friction_law
            level = friction.seal_friction(
                line_load=sealing.row_load(pressed, contact),
                diameter=ring["diameter"],
                friction_coefficient=law.coefficient(pressed.sizes, contact),
            )
            levels.append(_flat(level))
            contacts.append(_flat(contact.line_load / contact.width))
        numbers |= _parabola(f"seal{i}.coulomb", levels, supply)
        numbers |= _parabola(f"seal{i}.contact", contacts, supply)
        for key in ("breakaway_ratio", "stribeck_speed", "viscous_friction"):
            numbers[f"seal{i}.{key}"] = _flat(ring[key])
    others = sealing.wipers_and_guides(v, design, g, resting, sections)
    numbers["other_friction"] = _flat(others.running)
    return seals


def _parabola(name: str, values: Sequence[Array], supply: Array) -> Numbers:
    """Coefficients of the parabola in the pressure through the values at `SHARES` of the supply."""
    low, middle, high = values
    return {
        f"{name}[0]": low,
        f"{name}[1]": (4 * middle - 3 * low - high) / supply,
        f"{name}[2]": 2 * (low + high - 2 * middle) / (supply * supply),
    }


class _Stress(NamedTuple):
    """Range and mean of the stress of a metal under the full pulse of its load [Pa]."""

    part: FatiguePart
    material: str
    span: Array
    """Range of the stress under the full pulse of the load."""
    offset: Array
    slope: Array
    """Mean stress = offset + slope times the mean share of the load."""


def _fatigue(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    wall: Wall,
    sections: Sequence[RodSection],
    loaded_joints: Sequence[LoadedJoint],
    supply: Array,
    numbers: Numbers,
) -> tuple[tuple[FatiguePart, ...], dict[str, str]]:
    """Stresses and strengths of the parts that fatigue; reasons for parts that are left out."""
    push, pull = supply * g.area_a, supply * g.area_b
    numbers["rod_pulse"] = push + pull
    parts: list[FatiguePart] = []
    unknown: dict[str, str] = {}
    stresses = [
        *_wall_stresses(wall, loaded_joints),
        *_rod_stresses(v, design, g, sections, supply, push, pull),
    ]
    for part, material, span, offset, slope in stresses:
        ultimate = stock.allowable(material, "ultimate_strength")
        limit = stock.allowable(material, "fatigue_strength")
        if ultimate is None or limit is None:
            unknown[part.place] = f"the fatigue strength of {material} is unknown"
            continue
        at = f"part{len(parts)}."
        numbers |= {f"{at}span": span, f"{at}offset": offset, f"{at}slope": slope}
        numbers |= {f"{at}ultimate": ultimate, f"{at}limit": limit}
        numbers[f"{at}limit_cycles"] = stock.get(material, "fatigue_cycles", default=1e6)
        parts.append(part)
    lives: dict[str, tuple[History, Life]] = {
        name: ("rod", life)
        for name, life in piston_nut.lives(v, design, stock, g, push, pull).items()
    }
    for end in loaded_joints:
        for place, life in end.placed(end.joint.fatigue(end.loaded).lives).items():
            if end.joint.name == "tie_rods":
                lives[place] = ("a", life)
            else:
                unknown[place] = "its fatigue is known for the full pulse of pressure only"
    for place, (load, life) in lives.items():
        numbers[f"part{len(parts)}.life"] = life.cycles
        parts.append(FatiguePart(place, load, bolted=True, only_tension=place == "piston nut"))
    if design.rod.layup:
        unknown["rod"] = "the rod has plies"
    return tuple(parts), unknown


def _wall_stresses(wall: Wall, loaded_joints: Sequence[LoadedJoint]) -> Iterator[_Stress]:
    """Stresses of metals in the wall and at its ends; the full pulse is that of the supply."""
    places: tuple[tuple[str, History], ...] = (
        ("at the cap", "a"), ("at the head", "b"), ("middle of the travel", "middle"),
    )  # fmt: skip
    for place, cycle in wall.cycles.items():
        for word, load in places:
            part = FatiguePart(f"{place}, {word}" if place else word, load)
            yield _Stress(part, cycle.material, cycle.span, cycle.mean - cycle.span / 2, cycle.span)
    for end in loaded_joints:
        ends = tuple(x for x in places if x[1] in _chambers(end))
        for place, cycle in end.placed(end.beside.cycles).items():
            for word, load in ends:
                part = FatiguePart(f"{place}, {word}", load)
                yield _Stress(
                    part, cycle.material, cycle.span, cycle.mean - cycle.span / 2, cycle.span
                )
        for pulsed in end.joint.fatigue(end.loaded).pulsed:
            for word, load in ends:
                part = FatiguePart(f"{end.end_joint.placed(pulsed.place)}, {word}", load)
                yield _Stress(part, pulsed.material, pulsed.span, 0.0, 2 * pulsed.mean)


def _chambers(end: LoadedJoint) -> tuple[History, ...]:
    """Chambers whose pressure loads a joint; both if cap and head are alike."""
    if end.end_joint.name:
        return ("a",) if end.end_joint.name == "cap" else ("b",)
    return ("a", "b")


def _rod_stresses(
    v: Values,
    design: Design,
    g: Geometry,
    sections: Sequence[RodSection],
    supply: Array,
    push: Array,
    pull: Array,
) -> Iterator[_Stress]:
    """Stresses of rods and of the rod's thread; the full pulse is from full push to full pull."""
    if not design.rod.layup:
        cycles = rod_strength.cycles(design, g, sections, supply, push, pull)
        for place, cycle in cycles.items():
            yield _Stress(FatiguePart(place, "rod"), cycle.material, cycle.span, 0.0, cycle.span)
    if design.rod.thread is not None:
        stress = THREAD_NOTCH * rod.thread_stress(
            force=push + pull, diameter=v["rod.thread.diameter"], pitch=v["rod.thread.pitch"]
        )
        part = FatiguePart("rod thread", "rod", only_tension=True)
        yield _Stress(part, sections[0].end_material, stress, 0.0, stress)


def stacked_numbers(numbers: Numbers) -> Array:
    """All numbers as an array (numbers, designs)."""
    xp = namespace(*numbers.values())
    rows = [xp.reshape(xp.asarray(value), (-1,)) for value in numbers.values()]
    width = max(row.shape[0] for row in rows)
    return xp.stack([xp.broadcast_to(row, (width,)) for row in rows])
