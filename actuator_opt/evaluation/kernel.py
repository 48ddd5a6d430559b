"""All metrics of one or many designs from one run of the models, and their governing values.

Only this module defines which of a metric's values, of all load cases and locations, governs a
design. Tables, JSON, sweeps, fronts, the optimiser and reports all use this value. The module also
computes oil damping, leakage, flow and line losses.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping, Set as AbstractSet
from dataclasses import field, replace

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, maximum, minimum, real, where
from ..base.quantities import Quantity, Sense
from ..design.ideal import require_parts
from ..design.material import Material
from ..design.model import Design
from ..friction.law import Friction
from ..joints.joint import ENCLOSED
from ..metrics.table import AT_STOPS, METRICS, split_case
from ..models import damping, elements, forces, lines, transmission_line
from . import (
    barrel as barrel_module,
    circuit,
    cushion,
    film,
    film_tables,
    geometry as geometry_module,
    linkage as joint,
    manufacture,
    motion,
    piston_nut,
    ports,
    rings as rings_module,
    rod_strength as beam_module,
    rods,
    sealing,
    sensor,
    service,
    springs,
    state,
    strength,
    weight,
)
from .barrel import SEAL_STEP, Wall
from .circuit import wall_compliance
from .duty_cycles import metrics as duty_metrics, numbers as numbers_module
from .duty_cycles.numbers import Numbers, SamplePlan, stacked_numbers
from .duty_cycles.results import CycleModels, results_in
from .film_tables import FilmTable, Key, Running
from .geometry import Geometry
from .limits import ALL_CASES, ENDS, MaterialValues, MetricArrays, by_case, margin
from .plugin import Plugin, with_own
from .rings import Ring
from .rod_strength import Beam
from .rods import RodSection
from .state import LoadState
from .values import Values


def compute_damping(
    geometry: Geometry, state: LoadState, friction: Friction, out: MetricArrays
) -> Array:
    """Compute the damping of oil in pipes and gaps; return the sum of oil and seal damping."""
    g = geometry
    viscosity = 0.5 * (state.dynamic_viscosity_a + state.dynamic_viscosity_b)
    pipe = damping.pipe_flow(dynamic_viscosity=viscosity, length=g.stroke)
    piston = damping.annular_couette(
        dynamic_viscosity=viscosity,
        length=g.piston_length,
        inner_radius=g.inner_radius - g.piston_clearance,
        outer_radius=g.inner_radius,
    )
    gaps, total = piston, friction.slope + pipe + piston
    for rod in g.rods:
        inside = state.dynamic_viscosity_b if rod.end == "head" else state.dynamic_viscosity_a
        gland = damping.annular_couette(
            dynamic_viscosity=0.5 * (inside + state.dynamic_viscosity),
            length=g.head_length,
            inner_radius=rod.diameter / 2,
            outer_radius=rod.diameter / 2 + g.head_clearance,
        )
        gaps, total = gaps + gland, total + gland
    out.put("damping_pipe", pipe)
    out.put("damping_annular", gaps)
    return total


def compute_leakage(
    v: Values,
    design: Design,
    geometry: Geometry,
    state: LoadState,
    wall: Wall,
    film: Running | None,
    out: MetricArrays,
) -> Array:
    """Compute the leakage across the moving piston; return its conductance.

    It is the sum of the stated conductance and that of the seal's oil film or, without seals, of
    the gap around the piston, widened by bore growth. The flow in the film is computed at the speed
    of the load case. A film that draws oil back to the driven side counts as free of leakage.
    """
    path = "piston.leakage_conductance"
    conductance = v[path]
    across = absolute(state.moving_a - state.moving_b)
    bare = design.seals.piston.count == 0
    if bare:
        g = geometry
        conductance = conductance + damping.gap_conductance(
            diameter=g.bore,
            gap=g.piston_clearance + SEAL_STEP * wall.growth,
            dynamic_viscosity=0.5 * (state.dynamic_viscosity_a + state.dynamic_viscosity_b),
            length=g.piston_length,
        )
    elif film is not None:
        moving = real(state.speed) > 0
        divisor = where(real(across) > 0, across, 1.0)
        passed = where(moving & (real(across) > 0), maximum(film.flow, 0.0), 0.0)
        conductance = conductance + passed / divisor
    if bare or film is not None or path in v.varied or design.piston.leakage_conductance > 0:
        running = None if film is None else real(state.speed)[:, 0] > 0
        out.put("leakage", conductance * across, cases=running)
    else:
        out.skip(
            "leakage",
            'needs the oil film: write "friction: film" in seals.piston, or state '
            "piston.leakage_conductance",
        )
    return conductance


LINE_METRICS = (
    "line_velocity",
    "line_pressure_drop",
    "line_drop_ratio",
    "line_hammer",
    "line_resonance",
)


def compute_flow(
    v: Values, design: Design, geometry: Geometry, state: LoadState, out: MetricArrays
) -> None:
    """Compute flow, velocities in ports and lines, and pressure drop."""
    flow = {
        "a": forces.chamber_flow(area=geometry.area_a, speed=state.speed),
        "b": forces.chamber_flow(area=geometry.area_b, speed=state.speed),
    }
    out.put("flow", flow["a"])
    out.put("piston_speed", state.speed)
    out.put("oil_viscosity", state.kinematic_viscosity)
    bore = ports.bore(v, design)
    if bore is None:
        out.skip("port_velocity", "no port stated: add cylinder.port_diameter")
    else:
        out.put("port_velocity", lines.port_velocity(flow=flow["a"], port_diameter=bore))
    if design.lines:
        _compute_lines(v, design, state, flow, out)
    else:
        for name in LINE_METRICS:
            out.skip(name, "no lines stated: add lines")


def _compute_lines(
    v: Values, design: Design, state: LoadState, flow: dict[str, Array], out: MetricArrays
) -> None:
    """Compute velocity, pressure drop, water hammer and resonance of the lines."""
    velocity, drop, hammer = {}, {}, {}
    lengths: dict[str, Array] = {}
    times: dict[str, Array] = {}  # travel time of a wave through the lines of a chamber
    modulus = {"a": state.bulk_modulus_a, "b": state.bulk_modulus_b}
    viscosity = {"a": state.dynamic_viscosity_a, "b": state.dynamic_viscosity_b}
    for i, line in enumerate(design.lines):
        at, place = f"lines[{i}].", f"line {line.chamber} [{i}]"
        inner = v[at + "inner_diameter"]
        velocity[place] = lines.line_velocity(flow=flow[line.chamber], inner_diameter=inner)
        size = {"inner_diameter": inner, "length": v[at + "length"]}
        stream = {"flow": flow[line.chamber], "density": state.density}
        drop[place] = lines.line_pressure_drop(
            **size, **stream, dynamic_viscosity=viscosity[line.chamber]
        )
        drop[place] = drop[place] + lines.fitting_pressure_drop(
            **stream, inner_diameter=inner, loss_coefficient=v[at + "loss_coefficient"]
        )
        speed = transmission_line.wave_speed(
            bulk_modulus=modulus[line.chamber],
            density=state.density,
            volume=lines.line_volume(**size),
            wall_compliance=wall_compliance(v, line, at),
        )
        hammer[place] = transmission_line.joukowsky_pressure(
            density=state.density, sound_speed=speed, velocity_change=velocity[place]
        )
        chamber = f"lines of chamber {line.chamber}"
        lengths[chamber] = lengths.get(chamber, 0.0) + v[at + "length"]
        times[chamber] = times.get(chamber, 0.0) + v[at + "length"] / speed
    out.put("line_hammer", hammer)
    out.put(
        "line_resonance",
        {
            chamber: elements.quarter_wave_frequency(
                length=length, sound_speed=length / times[chamber]
            )
            for chamber, length in lengths.items()
        },
    )
    out.put("line_velocity", velocity)
    out.put("line_pressure_drop", drop)
    supply = v["supply.pressure"]
    out.put("line_drop_ratio", {place: value / supply for place, value in drop.items()})


STROKES: tuple[film.Stroke, ...] = ("drive", "return")
"""The stroke in the direction of the load case, and the return stroke."""


@dataclass(frozen=True, slots=True)
class PreparedDesign:
    """A design, its materials, and all their numerical values by PATH, such as `cylinder.bore`."""

    design: Design
    materials: dict[str, Material]
    numbers: Mapping[str, float]
    factors: Mapping[tuple[str, str, bool], float]
    """Knock-down factor of every strength, by (material, property, whether at the lowest
    temperature)."""
    plugins: tuple[Plugin, ...] = ()
    reserves: Mapping[str, float] = field(default_factory=dict)
    """Extra margin that a robust optimisation requires, by name of the limit."""
    aims: Mapping[str, Sense] = field(default_factory=dict)
    """Objectives of a Pareto front, minimised or maximised; empty: the objective of the design."""
    lenient: bool = False
    """Whether a user metric that raises an exception is NaN with a reason, instead of stopping the
    run."""
    constants: dict[str, dict[str, Array]] = field(default_factory=dict, compare=False)
    """Cache of each material's elastic constants, written as those of a ply, by name of the
    material."""
    films: dict[Key, FilmTable] = field(default_factory=dict, compare=False)
    """Tables of the seals' oil films; a cache."""
    windows: bool = False
    """Whether extremes along a duty cycle are results of every window of time, as limits of the
    optimiser."""
    most_samples: int | None = None
    """Largest number of samples of a duty cycle that count; None: all."""
    cycles: dict[tuple[str, ...], CycleModels] = field(default_factory=dict, compare=False)
    """Models of the duty cycles by the names of their numbers and `most_samples`; a cache."""

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """All metrics of this design, with those of the user and those of single cases."""
        known = with_own(self.plugins)
        known.update({name: known[name] for name in self.of_cases})
        return known

    @property
    def of_cases(self) -> tuple[str, ...]:
        """Metrics of single load cases or duty cycles that objectives and requirements name."""
        stated = (*self.design.objective.metrics, *self.design.requirements, *self.aims)
        return tuple(name for name in dict.fromkeys(stated) if split_case(name)[1] is not None)

    @property
    def cases(self) -> tuple[str, ...]:
        """Names of the load cases."""
        return tuple(case.name for case in self.design.load_cases)

    def values(self, varied: Mapping[str, Array] | None = None) -> Values:
        """The numbers to evaluate; arrays in `varied` replace the numbers of the design."""
        return Values(self.numbers, self.cases, varied)

    def touch(self, values: Values) -> None:
        """Run the models once, so that `values.read` contains the PATHs of all numbers they use."""
        compute(self, values)


@dataclass(frozen=True, slots=True)
class ModelRun:
    """Results of all models, with intermediate results for the report."""

    computed: MetricArrays
    geometry: Geometry
    state: LoadState
    wall: Wall
    rings: tuple[Ring, ...]
    rods: tuple[RodSection, ...]
    """Sections of the rods, in the order of `Geometry.rods`."""
    joints: tuple[strength.LoadedJoint, ...]
    beams: tuple[Beam, ...]
    """Critical load and bending moment of the rods, in that order."""
    springs: springs.Springs
    motion: motion.Motion
    weakest: Array
    """Piston position of least stiffness."""
    places: dict[str, Array]
    """Stroke positions at which dynamic results are computed, by name."""
    mass_parts: dict[str, Array]

    @property
    def rod(self) -> RodSection:
        """Section of the rod through the head."""
        return self.rods[0]

    @property
    def beam(self) -> Beam:
        """Critical load and bending moment of the rod through the head."""
        return self.beams[0]


@dataclass(frozen=True, slots=True)
class Base:
    """Results that all later models need: dimensions, load cases, wall, seals."""

    stock: MaterialValues
    geometry: Geometry
    state: LoadState
    wall: Wall
    rings: tuple[Ring, ...]


@dataclass(frozen=True, slots=True)
class Implicit:
    """Models that are not a closed formula of the dimensions.

    To bound the metrics of a whole design space, the caller replaces them by functions that return
    bounds.
    """

    wall: Callable[[Values, Design, MaterialValues, Geometry, LoadState], Wall] = (
        barrel_module.compute
    )
    critical_load: beam_module.CriticalLoad = beam_module.critical_load


IMPLICIT = Implicit()


def base(subject: PreparedDesign, v: Values, implicit: Implicit = IMPLICIT) -> Base:
    """Compute dimensions, state of the load cases, wall and seals of the designs in `v`."""
    design = subject.design
    require_parts(design.ideal)
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    g = geometry_module.derive(v, design)
    case_state = state.derive(v, design, stock, g)
    wall = implicit.wall(v, design, stock, g, case_state)
    rings = rings_module.rings(v, design, stock, g, case_state, wall.case_growth)
    return Base(stock, g, case_state, wall, rings)


@dataclass(frozen=True, slots=True)
class Statics:
    """All results that do not depend on the position of least stiffness."""

    base: Base
    rods: tuple[RodSection, ...]
    joints: tuple[strength.LoadedJoint, ...]
    mass_parts: dict[str, Array]
    breakaway: Array
    branches: dict[circuit.Chamber, circuit.ChamberLines]
    springs: springs.Springs
    moving: Array
    """Mass that moves with the rod, including the load."""
    beams: tuple[Beam, ...]
    damping: Array
    """Damping of oil and seals: increase of their force with speed."""
    leakage: Array


def statics(
    subject: PreparedDesign, v: Values, out: MetricArrays, implicit: Implicit = IMPLICIT
) -> Statics:
    """Compute all metrics that need no search along the stroke, and store them in `out`."""
    design = subject.design
    basis = base(subject, v, implicit)
    stock, g, case_state = basis.stock, basis.geometry, basis.state
    barrel, rings = basis.wall, basis.rings
    state.compute(design.fluid, stock, case_state, out)
    out.put("bore_growth", barrel.growths)
    tables = _films(subject)
    drive_films, return_films = (
        sealing.films_of(tables, rings, stroke, len(v.cases)) for stroke in STROKES
    )
    sections = rods.derive(v, design, stock, g)
    friction = sealing.compute(
        v, design, stock, g, case_state, barrel, rings, drive_films, sections, out
    )
    sealing.compute_film(g, case_state, drive_films, return_films, out)
    net = _forces(g, case_state, friction, out)
    joint.compute(design, case_state.joint, case_state.positions, net, out)
    rod = sections[0]
    parts = weight.parts(v, design, stock, g, sections)
    out.put("mass", sum(parts.values()))
    out.put("mass_oil", weight.oil(v, design, g))
    branches = circuit.branches(v, design, case_state)
    budget = springs.springs(
        v, design, stock, g, case_state, barrel, rod, friction.breakaway, branches
    )
    damping = compute_damping(g, case_state, friction, out)
    film = drive_films.get("piston seal")
    leakage = compute_leakage(v, design, g, case_state, barrel, film, out)
    compute_flow(v, design, g, case_state, out)
    beams = beam_module.derive(
        v, design, g, case_state, barrel, sections, parts, critical_load=implicit.critical_load
    )
    loaded_joints = strength.joints_under_load(v, design, stock, g, barrel)
    strength.compute(v, design, stock, g, case_state, barrel, sections, beams, loaded_joints, out)
    stop = joint.at_stop(case_state.demands, case_state.push)
    stop = replace(stop, mass=weight.moving(parts, stop.mass))
    service.compute(
        v, design, stock, g, case_state, barrel, sections, loaded_joints, stop, net, out
    )
    _lands(v, design, g, rod, out)
    strength.joint_metrics(loaded_joints, out)
    _manufacture(v, subject, g, out)
    out.put("barrel_length", g.wall_length)
    out.put("closed_length", g.closed_length)
    return Statics(
        base=basis,
        rods=sections,
        joints=loaded_joints,
        mass_parts=parts,
        breakaway=friction.breakaway,
        branches=branches,
        springs=budget,
        moving=weight.moving(parts, case_state.demands[joint.WORST].mass),
        beams=beams,
        damping=damping,
        leakage=leakage,
    )


def _lands(v: Values, design: Design, g: Geometry, rod: RodSection, out: MetricArrays) -> None:
    """Compute walls and clearances that must remain."""
    hole = v["rod.thread.diameter"] / 2 if design.rod.thread is not None else g.rod_diameter / 2
    if design.piston.nut is not None:
        hole = piston_nut.recess(g)[1]
    elif design.double_rod:
        hole = maximum(hole, g.rods[1].diameter / 2)
    lands = geometry_module.lands(g, hole, eyes=design.clevis is not None)
    lands |= piston_nut.lands(v, design, g) | ports.lands(v, design, g) | cushion.lands(design, g)
    for name, value in (lands | sensor.lands(v, design, g, rod)).items():
        out.put(name, value)
    if design.piston.nut is None:
        out.skip("geometry_piston_web", piston_nut.NO_NUT)
    if design.cylinder.port_thread is None:
        out.skip("geometry_port", ports.NO_PORTS)
    if design.sensor is None:
        out.skip("geometry_sensor", sensor.NO_SENSOR)
    if design.cushion is None:
        out.skip("geometry_cushion", cushion.NO_CUSHION)
    if not g.rod_thicknesses:
        out.skip("geometry_rod_bore", "the rod has no layers")
    if all(g.static_place(through.end) != "bore" for through in g.rods):
        out.skip("geometry_static_seal", "no static seal on the outside of the head")
    if "skirts" not in g.forms:
        out.skip("geometry_skirts", "cap and head have no skirts over the barrel")
    if all(fit.sleeve is None for fit in g.fits):
        out.skip("geometry_sleeve", "no sleeve under the winding")
    if not set(ENCLOSED) & set(g.forms):
        for name in ("geometry_lip", "geometry_plug"):
            out.skip(name, "no plug in the bore")


def compute(subject: PreparedDesign, v: Values, wanted: AbstractSet[str] | None = None) -> ModelRun:
    """Compute all metrics of the designs in `v`; invalid designs give NaN.

    If `wanted` is stated, costly metrics that it does not contain may be left out.
    """
    design = subject.design
    if wanted is not None:
        wanted = wanted | {split_case(name)[0] for name in subject.of_cases}
    with np.errstate(all="ignore"):
        out = MetricArrays()
        s = statics(subject, v, out)
        case_state = s.base.state
        weakest = springs.compute(s.springs, s.moving, out)
        _at_stops(v, design, s.base, s.rods[0], s.breakaway, s.mass_parts, out)
        linear = motion.derive(
            v, design, case_state, s.springs, s.branches, s.moving, s.damping, s.leakage
        )
        places = motion.compute(v, design, linear, wanted, out)
        _duty(subject, v, s, out)
        for name in subject.of_cases:
            _of_case(name, v.cases, out)
        for plugin in subject.plugins:
            plugin_value = plugin.call(v, out.metrics, lenient=subject.lenient)
            out.metrics[plugin.name] = {"": plugin_value.value}
            if plugin_value.raised:
                out.skip(plugin.name, plugin_value.raised)
    return ModelRun(
        computed=out,
        geometry=s.base.geometry,
        state=case_state,
        wall=s.base.wall,
        rings=s.base.rings,
        rods=s.rods,
        joints=s.joints,
        beams=s.beams,
        springs=s.springs,
        motion=linear,
        weakest=weakest,
        places=places,
        mass_parts=s.mass_parts,
    )


def _of_case(name: str, cases: tuple[str, ...], out: MetricArrays) -> None:
    """Record a metric in a single load case, or along a single duty cycle."""
    metric, case = split_case(name)
    found: dict[str, Array] = {}
    for place, array in out.metrics.get(metric, {}).items():
        own, _, rest = place.partition(", ")
        if case in cases:
            values = dict(by_case(out, metric, array, cases, place))
            value = values.get(str(case), values.get(ALL_CASES))
            if value is not None:
                found[place] = value
        elif own == case:
            found[rest] = array
    if found:
        out.metrics[name] = found
    else:
        out.skip(name, out.why.get(metric, f"{metric} has no value of its own for {case}"))


def duty_numbers(subject: PreparedDesign, v: Values) -> tuple[CycleModels, Array]:
    """Models of the duty cycles, and the numbers (numbers, designs) on which they depend."""
    with np.errstate(all="ignore"):
        plan, numbers = sample_numbers(subject, v, statics(subject, v, MetricArrays()))
    return cycle_models(subject, plan, numbers), stacked_numbers(numbers)


def duty_results(
    subject: PreparedDesign, v: Values, wanted: Container[str] | None = None
) -> MetricArrays:
    """Metrics of the duty cycles only, for all designs in `v`; other models run without search.

    Metrics that need more than the `wanted` results of the cycles (None: all) are meaningless.
    """
    out = MetricArrays()
    with np.errstate(all="ignore"):
        _duty(subject, v, statics(subject, v, out), out, wanted)
    return out


def sample_numbers(subject: PreparedDesign, v: Values, s: Statics) -> tuple[SamplePlan, Numbers]:
    """Plan of the samples of the duty cycles, and the numbers by name."""
    basis = s.base
    return numbers_module.collect(
        v,
        subject.design,
        basis.stock,
        basis.geometry,
        basis.state,
        basis.wall,
        s.rods,
        s.joints,
        s.leakage,
    )


def cycle_models(subject: PreparedDesign, plan: SamplePlan, numbers: Numbers) -> CycleModels:
    """Models of the duty cycles; made once for the same numbers."""
    duty = subject.design.duty
    assert duty is not None
    names, most = tuple(numbers), subject.most_samples
    key = (*names, str(most))
    if key not in subject.cycles:
        records = {cycle.name: duty.record(cycle) for cycle in duty.cycles}
        if most is not None:
            records = {name: record.thinned(most) for name, record in records.items()}
        phases = {
            cycle.name: [other.phase - cycle.phase for other in cycle.also] for cycle in duty.cycles
        }
        subject.cycles[key] = CycleModels(plan, records, names, phases)
    return subject.cycles[key]


MANY_SAMPLES = 500
"""Samples of all duty cycles together, above which searches, prices and cures begin with fewer (our
choice)."""
FEW_SAMPLES = 200
"""Samples of each cycle that they then use (our choice)."""


def with_few_samples(subject: PreparedDesign, many: int | None = None) -> PreparedDesign:
    """The design with `FEW_SAMPLES` of each duty cycle, if all together have many samples.

    If no cycle has more than `FEW_SAMPLES`, it is the same. `many` replaces `MANY_SAMPLES`.
    """
    duty = subject.design.duty
    sizes = [0] if duty is None else [duty.record(cycle).time.size for cycle in duty.cycles]
    if sum(sizes) <= (MANY_SAMPLES if many is None else many) or max(sizes) <= FEW_SAMPLES:
        return subject
    return replace(subject, most_samples=FEW_SAMPLES)


def _duty(
    subject: PreparedDesign,
    v: Values,
    s: Statics,
    out: MetricArrays,
    wanted: Container[str] | None = None,
) -> None:
    """Compute the metrics of duty cycles, by their models or from results among the values.

    Results of the cycles whose names are not `wanted` may be 0; None: all are computed.
    """
    if subject.design.duty is None:
        duty_metrics.skip(out)
        return
    results = results_in(v)
    if not results:
        plan, numbers = sample_numbers(subject, v, s)
        models = cycle_models(subject, plan, numbers)
        some = None
        if wanted is not None:
            some = np.array([place.name in wanted for place in models.places])
        rows = models(stacked_numbers(numbers), wanted=some)
        results = dict(zip(models.places, rows, strict=True))
    duty_metrics.compute(
        v,
        subject.design,
        s.base.stock,
        s.base.geometry,
        results,
        actuator_mass=out.metrics["mass"][""] + out.metrics["mass_oil"][""],
        windows=subject.windows,
        out=out,
    )


def _at_stops(
    v: Values,
    design: Design,
    basis: Base,
    rod: RodSection,
    breakaway: Array,
    parts: dict[str, Array],
    out: MetricArrays,
) -> None:
    """Compute stiffness and frequency for each stop, if the linkage makes the load differ there."""
    s = basis.state
    differing = joint.open_cases(v, design, s.positions)
    if not differing.any():
        return
    for end in ENDS:
        stop_state = state.holding(v, design, basis.stock, basis.geometry, s, end)
        branches = circuit.branches(v, design, stop_state)
        budget = springs.springs(
            v,
            design,
            basis.stock,
            basis.geometry,
            stop_state,
            basis.wall,
            rod,
            breakaway,
            branches,
        )
        stop_metrics = MetricArrays()
        springs.compute(budget, weight.moving(parts, s.demands[end].mass), stop_metrics)
        for name in AT_STOPS:
            out.metrics[name][f"loaded as {end}"] = stop_metrics.metrics[name][""]
            out.applies_at[name, f"loaded as {end}"] = differing
            out.applies_at[name, ""] = ~differing


@np.errstate(all="ignore")
def without_films(subject: PreparedDesign) -> PreparedDesign:
    """Copy a design without solving its oil films; results that need a film are NaN.

    The same metrics exist as with films, and they use the same numbers of the design.
    """
    if not film.films_asked(subject.design):
        return subject
    rings = base(subject, subject.values()).rings
    return replace(subject, films=film_tables.unsolved(subject.design, rings))


def _films(subject: PreparedDesign) -> dict[Key, FilmTable]:
    """Film tables of the design, made on first use."""
    design = subject.design
    if not film.films_asked(design):
        return {}
    if not subject.films:
        tables = film_tables.tables(design, subject.values, lambda v: base(subject, v).rings)
        subject.films.update(tables)
    return subject.films


def _manufacture(v: Values, subject: PreparedDesign, g: Geometry, out: MetricArrays) -> None:
    """Compute the margins to the manufacturing limits of plies, and the turns of windings."""
    turns = manufacture.turn_lengths(v, subject.design, subject.materials, g)
    if subject.design.barrel.turn == "pins":
        turns = {place: x for place, x in turns.items() if not place.startswith("barrel")}
    if turns:
        out.put("turn_length", turns)
    else:
        out.skip("turn_length", "no layer is wound")
    angles, spare = manufacture.manufacture_margins(v, subject.design, subject.materials)
    for name, values, limit in (
        ("winding_margin", angles, "smallest angle"),
        ("ply_thickness_margin", spare, "smallest thickness"),
    ):
        if values:
            out.put(name, values)
        else:
            out.skip(name, f"no layer states a {limit}")


def _forces(g: Geometry, s: LoadState, friction: Friction, out: MetricArrays) -> Array:
    sides = {
        "pressure_a": s.moving_a,
        "pressure_b": s.moving_b,
        "area_a": g.area_a,
        "area_b": g.area_b,
        "friction": friction.running,
    }
    push, pull = forces.push_force(**sides), forces.pull_force(**sides)
    pushes = s.push[:, 0]
    for name, value, cases in (("push_force", push, pushes), ("pull_force", pull, ~pushes)):
        out.put(name, value, cases=cases)
        if not cases.any():
            out.skip(name, f"no load case {name[:4]}s")
    net = where(s.push, push, pull)
    driven = where(s.push, g.area_a, g.area_b)
    out.put("efficiency", forces.efficiency(force=net, pressure=s.driven_pressure, area=driven))
    out.put(
        "power", forces.power(force=minimum(net, s.force), speed=s.demands[joint.WORKING].speed)
    )
    return net


def worst_of(aim: Sense) -> Sense:
    """Worst value of an objective: the largest if it is minimised ("min"), else the smallest.

    >>> worst_of("min")
    'max'
    """
    return "max" if aim == "min" else "min"


def sense_of(metric: str, subject: PreparedDesign) -> Sense | None:
    """Whether the smallest ("min") or the largest ("max") value of a metric governs a design.

    1. For an objective, the worst value governs: the largest if it is minimised.
    2. For a metric with a requirement, the value with the least margin governs. With a lower and
       an upper limit the result is None, because either extreme may have the least margin.
    3. For any other metric, the worst value according to `metrics.METRICS` governs.
    """
    objective = subject.design.objective
    aims = subject.aims or dict.fromkeys(objective.metrics, objective.aim)
    if metric in aims:
        return worst_of(aims[metric])
    required = subject.design.requirements.get(metric)
    if required is None:
        return (METRICS.get(metric) or subject.quantities[metric]).worst
    if required.min is not None and required.max is not None:
        return None
    return "max" if required.min is None else "min"


def extreme(
    computed: MetricArrays, metric: str, cases: tuple[str, ...], sense: Sense
) -> Array | None:
    """The smallest or largest value over load cases and locations (designs,), SI.

    NaN if any value is missing, None if the metric is not computed.
    """
    pick = maximum if sense == "max" else minimum
    governing_value: Array | None = None
    for place, array in computed.metrics.get(metric, {}).items():
        for _, value in by_case(computed, metric, array, cases, place):
            if governing_value is None:
                governing_value = value
            else:
                unknown = np.isnan(governing_value) | np.isnan(value)
                governing_value = where(unknown, np.nan, pick(governing_value, value))
    return governing_value


def governing(metric: str, computed: MetricArrays, v: Values, subject: PreparedDesign) -> Array:
    """Governing value of a metric for every design (designs,), SI.

    It is infinite for a part without load, and NaN if a value is missing or the metric is not
    computed.
    """
    sense = sense_of(metric, subject)
    if sense is not None:
        value = extreme(computed, metric, v.cases, sense)
        return np.full(1, np.nan) if value is None else value
    least = extreme(computed, metric, v.cases, "min")
    most = extreme(computed, metric, v.cases, "max")
    if least is None or most is None:
        return np.full(1, np.nan)
    lowest, highest = (v[f"requirements.{metric}.{side}"] for side in ("min", "max"))
    return where(margin(least, lowest, "min") <= margin(most, highest, "max"), least, most)
