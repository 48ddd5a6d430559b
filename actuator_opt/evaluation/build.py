"""Evaluation of a design with its requirements, checks and warnings; margins of many designs.

If bore, rod, glands or housings deviate from standard sizes, the result has a remark but no limit
is missed. Designs that are evaluated together get only the governing value of every metric and
limit.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import numpy as np

from ..base import quantities
from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.numeric import Array, namespace, sorted_unique, where
from ..design import paths, standard_sizes as standards
from ..design.data_file_reader import replace_by_digests
from ..design.housings import gland_deviations, housings, housings_for
from ..design.material import Material
from ..design.materials import Library, load_library
from ..design.model import Design
from ..joints.kinds import OWN_KEYS
from ..metrics import METRICS, MetricRow, split_case
from ..metrics.table import CHECKS
from ..version import VERSION
from . import (
    duty_study,
    dynamics_study as dynamics,
    outline,
    validity as doubts,
    valve_study,
    weight,
)
from .duty_cycles import remedies
from .duty_cycles.study import DutyStudy, Shortfall
from .film import floats
from .kernel import ModelRun, PreparedDesign, compute, governing
from .limits import (
    ALL_CASES,
    LimitRow,
    MetricArrays,
    MetricLimit,
    all_limits,
    allowances,
    by_case,
    check_limits,
    default_limits,
    extremes,
    rows_of,
)
from .plugin import Plugin
from .result import Check, Evaluation, Metric, Requirement, StrokeCurve
from .rings import BLOCKS, Ring, squeezes
from .validity import model_of
from .values import Values, of_case
from .wall_study import study as wall_study

PLACES: tuple[Literal["piston", "rod"], ...] = ("piston", "rod")

NEAR = 0.02
"""Relative difference from a standard housing's depth or length above which a remark is made."""

NO_ANSWER = "not computable for these dimensions"
NOT_COMPUTED = "not computed for this design"
UNLOADED = "no load case loads it"
UNLIMITED = "there is no load, so the safety factor is unlimited"
STALLED = "the supply does not move the load"

TOLERANCE = 1e-6
"""A margin of at least −TOLERANCE counts as met."""

_SIZES, _GLANDS, _SECTIONS = "standard sizes", "standard glands", "ISO 3601-2 sections (AS568)"


def sizes(design: Design) -> Check:
    """Check whether bore and rod are ISO 3320 sizes; if not, name the nearest sizes."""
    nonstandard = []
    dimensions: list[tuple[Literal["bore", "rod"], float]] = [
        ("bore", design.cylinder.bore),
        ("rod", design.rod.outer_diameter),
    ]
    second = design.second_rod
    if design.double_rod and second is not None and second.outer_diameter is not None:
        dimensions.append(("rod", second.outer_diameter))
    for part, value in dimensions:
        near = standards.nearest_standard(part, value, "nearest")
        if abs(near - value) > 1e-9:
            nonstandard.append(f"{part} {1e3 * value:.4g} mm (nearest {1e3 * near:g} mm)")
    if nonstandard:
        reason = "sizes that are not standard: " + ", ".join(nonstandard)
        return Check(_SIZES, "not_checked", reason, source="ISO 3320")
    return Check(_SIZES, "met", "bore and rod are standard sizes", source="ISO 3320")


def glands(rings: Iterable[Ring]) -> Check:
    """Check whether every groove conforms to a standard; if not, list the differences."""
    nonstandard = [text for ring in rings for text in _remarks(floats(ring, 0))]
    if nonstandard:
        return Check(
            _GLANDS,
            "not_checked",
            "glands that are not standard: " + "; ".join(nonstandard),
            source=_SECTIONS,
        )
    return Check(_GLANDS, "met", "all glands are standard", source=_SECTIONS)


def _remarks(ring: Ring) -> Iterator[str]:
    """Yield the deviations of a ring's groove from its standard."""
    if ring.element.seal_type.o_ring_gland:
        yield from _o_ring(ring)
    elif any(housings(ring.element.type, place) for place in PLACES):
        yield from _housing(ring)
    else:
        yield f"{ring.label}: no standard housing for type {ring.element.type}"


def _o_ring(ring: Ring) -> Iterator[str]:
    loosest, tightest = squeezes(ring.at(stretch=0.0), growth=0.0, aside=0.0, ratio=1.0)
    area = float(np.squeeze(ring.groove.pieces[0].area))
    try:
        deviations = gland_deviations(
            standards.gland(ring["section"]),
            squeeze_min=float(loosest),
            squeeze_max=float(tightest),
            width=ring["groove_width"],
            fill=area / (ring["groove_width"] * ring["gland_depth"]),
            stretch=ring["stretch"],
            back_up_rings=ring.element.back_ups,
        )
    except InputError as error:
        yield f"{ring.label}: {error.diagnostics[0].message}"
        return
    for deviation in deviations:
        scale, unit = (1e3, "mm") if deviation.quantity == "groove width" else (100, "%")
        low, high = (f"{scale * end:.3g}" for end in (deviation.lower, deviation.upper))
        yield (
            f"{ring.label}: {deviation.quantity} {scale * deviation.value:.3g} {unit}, standard "
            f"{low if low == high else f'{low} to {high}'} {unit}"
        )


def _housing(ring: Ring) -> Iterator[str]:
    if ring.name == "static":
        return
    try:
        standard_housings = housings_for(ring.element.type, BLOCKS[ring.name], ring["diameter"])
    except InputError as error:
        yield f"{ring.label}: {error.diagnostics[0].message}"
        return
    depth, length = ring["gland_depth"], ring["groove_width"]
    if any(
        abs(housing.radial_depth - depth) <= NEAR * depth
        and any(abs(x - length) <= NEAR * length for x in housing.lengths)
        for housing in standard_housings
    ):
        return
    listed = ", ".join(
        f"{1e3 * housing.radial_depth:g} x {' or '.join(f'{1e3 * x:g}' for x in housing.lengths)}"
        for housing in standard_housings[:2]
    )
    yield (
        f"{ring.label}: groove (depth x length) {1e3 * depth:.3g} x {1e3 * length:.3g} mm, in "
        f"{standard_housings[0].standard} {listed} mm"
    )


def names_of_materials(design: Design) -> list[str]:
    """Names of all materials of a design, without duplicates, in order of appearance."""
    names = [design.fluid.material]
    names += [ply.material for ply in design.barrel.layup]
    names += [ply.material for ply in design.rod.layup]
    names += [design.rod.material, design.piston.material, design.head.material]
    if design.double_rod and design.second_rod is not None:
        names += [name for name in [design.second_rod.material] if name is not None]
    if design.rod.fitting is not None:
        names += [design.rod.fitting.material or design.rod.material, design.rod.fitting.adhesive]
    names += [part.bearing for part in (design.piston, design.head) if part.bearing is not None]
    names.append(design.caps.material)
    if design.retention is not None:
        joints = design.retention.ends.values()
        names += [joint.material for joint in joints if joint.material is not None]
        names += [joint.sleeve.material for joint in joints if joint.sleeve is not None]
    if design.clevis is not None:
        names.append(design.clevis.material)
    for seal in (design.seals.piston, design.seals.rod):
        names += seal.materials()
    if design.seals.static is not None:
        names.append(design.seals.static.compound)
    names += [line.material for line in design.lines]
    return list(dict.fromkeys(names))


def prepare(
    design: Design,
    materials: Library | Mapping[str, Material] | None = None,
    plugins: tuple[Plugin, ...] = (),
) -> PreparedDesign:
    """Combine a design with its materials and all its numerical values, ready to evaluate.

    Parameters
    ----------
    design : the design
    materials : a library, or the materials by name; default: the project's library
    plugins : user metrics and constraints
    """
    if materials is None:
        materials = load_library()
    get = materials.get if isinstance(materials, Library) else materials.__getitem__
    materials = {
        name: get(name).stating(design.materials.get(name, {}))
        for name in names_of_materials(design)
    }
    numbers = default_limits()
    for name, material in materials.items():
        numbers |= {f"materials.{name}.{key}": value for key, value in material.numbers.items()}
    numbers |= paths.numbers(design)
    factors = allowances(
        materials,
        numbers,
        temperatures=extremes(design, numbers),
        wet=design.environment is None or design.environment.wet,
    )
    return PreparedDesign(design, materials, numbers, factors, plugins)


def _blocks(retention: dict[str, Any] | None) -> Iterator[dict[str, Any]]:
    """The block `retention` and those of its ends."""
    if retention is not None:
        yield from (retention[end] for end in ("cap", "head") if retention[end] is not None)
        yield retention


def leave_out_unset(valve: dict[str, Any] | None) -> None:
    """Drop unset keys from the dump of a valve, so that hashes of older designs stay valid."""
    for key in (
        "frequency_90deg",
        "frequency_3db",
        "slew_rate",
        "spool",
        "edge_coefficients",
        "flow_curve",
        "hysteresis",
        "threshold",
    ):
        if valve and valve[key] is None:
            del valve[key]


def spec_hash(subject: PreparedDesign) -> str:
    """Hash of all inputs that determine the result: design, material data and program version."""
    design = subject.design.model_dump(mode="json")
    replace_by_digests(design, subject.design)
    for key in ("uncertainty", "extra_masses", "sensor", "cushion", "duty"):
        if not design[key]:  # unset fields are left out: hashes of older designs stay valid
            del design[key]
    for component in design.get("extra_masses", ()):
        for key, unset in (("count", 1.0), ("length", 0.0)):
            if component[key] == unset:
                del component[key]
    if not design["second_rod"]:
        del design["second_rod"]
    if design["cylinder"]["type"] == "differential":
        del design["cylinder"]["type"]
    for block, key in ((design["cylinder"], "port_thread"), (design["clevis"], "bearing")):
        if block and block[key] is None:
            del block[key]
    leave_out_unset(design["valve"])
    for block in _blocks(design["retention"]):
        for key in ("cap", "head", "sleeve", *OWN_KEYS):
            if key in block and block[key] is None:
                del block[key]
    content = {
        "design": design,
        "materials": {k: v for k, v in subject.numbers.items() if k.startswith("materials.")},
        "version": VERSION,
    }
    text = json.dumps(content, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@np.errstate(all="ignore")  # values that are not finite are reported without numerical warnings
def evaluate(subject: PreparedDesign) -> Evaluation:
    """Compute all metrics, requirements and checks of a design."""
    v = subject.values()
    run = compute(subject, v)
    computed = run.computed
    design = subject.design
    limits = all_limits(design, subject.plugins)
    requirements = tuple(
        _requirement(limit, computed, v)
        for limit in limits
        if limit.origin in ("requirement", "case")
    )
    duty = duty_study.study(subject, v, run)
    warnings = list(doubts.warnings(subject, v, run, duty))
    outside = {metric for metric, _ in warnings}
    outside |= {name for name in subject.of_cases if split_case(name)[0] in outside}
    metrics = {name: _metric(name, computed, v, subject, outside) for name in subject.quantities}
    checks = tuple(_checks(design, computed, v, requirements, run.rings))
    warnings += [
        ("", f"check missed: {c.name}: {_against(c)}") for c in checks if c.status == "missed"
    ]
    if duty is not None:
        duty = replace(duty, find_shortfalls=partial(_shortfalls, subject, duty, checks))
    return Evaluation(
        name=design.name,
        version=VERSION,
        spec_hash=spec_hash(subject),
        design=design,
        metrics=metrics,
        requirements=requirements,
        checks=checks,
        warnings=tuple(dict.fromkeys(text for _, text in warnings)),
        unverified=tuple(doubts.unverified(subject, v)),
        models=tuple(doubts.models(metrics, subject, run.rings, outside, [t for _, t in warnings])),
        mass_parts={name: float(np.squeeze(m)) for name, m in run.mass_parts.items()},
        mass_leaves_out=weight.left_out(design),
        curve=_curve(run, v, metrics["stiffness_min"].case),
        outlines=outline.outlines(design, subject.materials, run.geometry),
        lines=outline.lines(design, run.geometry),
        lengths=outline.lengths(design, run.geometry),
        wall=wall_study(subject, v, run),
        dynamics=dynamics.study(subject, v, run, metrics["stiffness_min"].case),
        valve=valve_study.study(design, v, run.state, metrics["position_gain"].value),
        duty=duty,
        friction_parts=_friction_parts(computed, v, metrics["friction_running"].case),
    )


def _shortfalls(
    subject: PreparedDesign, duty: DutyStudy, checks: Sequence[Check]
) -> Iterator[Shortfall]:
    """Yield every missed check of the duty cycles with its cures."""
    own = [c for c in checks if c.metric in remedies.CHECKED and c.status != "not_checked"]
    missed = [c.metric for c in own if c.status == "missed" and c.metric is not None]
    if not missed:
        return
    limits = {
        c.metric: (c.sense, c.limit)
        for c in own
        if c.metric is not None and c.sense is not None and c.limit is not None
    }
    yield from remedies.shortfalls(subject, duty, limits, missed)


def _friction_parts(computed: MetricArrays, v: Values, case: str | None) -> dict[str, float]:
    """Running friction of each seal in a load case; seals without friction are left out."""
    friction = {}
    for label, array in computed.friction_parts.items():
        values = dict(by_case(computed, "friction_running", array, v.cases))
        value = float(values.get(case or ALL_CASES, values.get(ALL_CASES, np.zeros(1)))[0])
        if value:
            friction[label] = value
    return friction


def _metric(
    name: str, computed: MetricArrays, v: Values, subject: PreparedDesign, outside: set[str]
) -> Metric:
    rows: list[tuple[float, str, str]] = []
    for place, array in computed.metrics.get(name, {}).items():
        for case, value in by_case(computed, name, array, v.cases, place):
            rows.append((float(value[0]), case, place))
    value = float(governing(name, computed, v, subject)[0])
    if not math.isfinite(value):
        computed_at_all = name in computed.metrics
        why = computed.why.get(name, NO_ANSWER if computed_at_all else NOT_COMPUTED)
        if value == math.inf:
            why = computed.why.get(name, STALLED if name == "duty_opening" else UNLIMITED)
        definition = None if name in METRICS else subject.quantities[name]
        return Metric(name=name, value=None, why=why, definition=definition)
    _, case, place = next(row for row in rows if row[0] == value)
    extremes = min(row[0] for row in rows), max(row[0] for row in rows)
    sense: quantities.Sense = "min" if value == extremes[0] else "max"
    pick = min if sense == "min" else max
    metric, own_case = split_case(name)
    model = model_of(
        metric,
        wall=doubts.kind_of(subject),
        criterion=subject.design.barrel.criterion,
        place=place,
    )
    per_case, per_place = dict[str, float](), dict[str, float]()
    for number, case_name, place_name in rows:
        if math.isfinite(number):
            per_case[case_name] = pick(number, per_case.get(case_name, number))
            per_place[place_name] = pick(number, per_place.get(place_name, number))
    return Metric(
        name=name,
        value=value,
        case=own_case if case == ALL_CASES else case,
        place=place or None,
        by_case=per_case,
        by_place=per_place,
        sense=None if extremes[0] == extremes[1] else sense,
        model="" if model is None else model.name,
        reference="" if model is None else model.reference,
        in_range=name not in outside,
        definition=None if name in METRICS else subject.quantities[name],
    )


def _worst(rows: Iterable[LimitRow]) -> LimitRow | None:
    """Return the limit row with the smallest margin; NaN counts as the smallest."""
    return min(
        rows,
        key=lambda row: -math.inf if math.isnan(row.margin[0]) else float(row.margin[0]),
        default=None,
    )


def _requirement(limit: MetricLimit, computed: MetricArrays, v: Values) -> Requirement:
    row = _worst(rows_of(limit, computed, v))
    bound = float(np.squeeze(limit.value(v)))
    if row is None or not math.isfinite(float(row.value[0])):
        unlimited = row is not None and float(row.value[0]) == math.inf and limit.sense == "min"
        return Requirement(
            limit.name,
            limit.metric,
            limit.sense,
            bound,
            None,
            None,
            unlimited,
            limit.case,
            path=limit.path or "",
        )
    margin = float(row.margin[0])
    return Requirement(
        name=limit.name,
        metric=limit.metric,
        sense=limit.sense,
        limit=bound,
        value=float(row.value[0]),
        margin=margin,
        met=margin >= -TOLERANCE,
        case=split_case(limit.metric)[1] if row.case == ALL_CASES else row.case,
        place=row.place or None,
        path=limit.path or "",
    )


def _checks(
    design: Design,
    computed: MetricArrays,
    v: Values,
    requirements: tuple[Requirement, ...],
    rings: tuple[Ring, ...],
) -> Iterable[Check]:
    limits = {limit.metric: limit for limit in check_limits(design)}
    for metric, check in CHECKS:
        name = metric.name
        if name in design.waivers:
            reason = f"waived: {design.waivers[name]}"
            yield Check(check.name, "not_checked", reason, name)
        else:
            yield _check(check.name, metric, limits.get(name), computed, v, requirements)
    yield sizes(design)
    yield glands(rings)


def _check(
    name: str,
    metric: MetricRow,
    limit: MetricLimit | None,
    computed: MetricArrays,
    v: Values,
    requirements: tuple[Requirement, ...],
) -> Check:
    sense = metric.worst
    own = [r for r in requirements if r.metric == metric.name and r.sense == sense]
    if limit is not None:
        result, source = _requirement(limit, computed, v), limit.source
    elif own:
        result = min(own, key=lambda r: -math.inf if r.margin is None else r.margin)
        source = "requirement of the design"
    else:
        reason = computed.why.get(
            metric.name, f"no limit stated: add requirements.{metric.name}.{sense}"
        )
        return Check(name, "not_checked", reason, metric.name, sense)
    if result.value is None and not result.met:
        status: Literal["missed", "not_checked"] = (
            "not_checked" if metric.name in computed.why else "missed"
        )
        reason = computed.why.get(metric.name, NO_ANSWER)
        return Check(name, status, reason, metric.name, sense, result.limit)
    if result.value is None:  # met, because it is unlimited
        return Check(name, "not_checked", UNLOADED, metric.name, sense, result.limit)
    return Check(
        name=name,
        status="met" if result.met else "missed",
        metric=metric.name,
        sense=sense,
        limit=result.limit,
        value=result.value,
        margin=result.margin,
        case=result.case,
        place=result.place,
        source=source,
    )


def _against(check: Check) -> str:
    if check.value is None or check.limit is None or check.metric is None:
        return check.reason
    quantity = METRICS[check.metric]
    word = "at least" if check.sense == "min" else "at most"
    return f"{quantity.text(check.value)}, but should be {word} {quantity.text(check.limit)}"


def _curve(run: ModelRun, v: Values, case: str | None) -> StrokeCurve:
    """Calculate the stiffness along the stroke in `case`, or else in the first load case."""
    stroke = float(np.squeeze(run.geometry.stroke))
    index = v.cases.index(case) if case in v.cases else 0
    weakest = of_case(run.weakest, index)
    position = sorted_unique(np.append(np.linspace(0.0, stroke, 101), weakest))
    parts = {
        name: np.broadcast_to(np.atleast_2d(value), (len(v.cases), position.size))[index]
        for name, value in run.springs.compliances(position).items()
    }
    return StrokeCurve(
        case=v.cases[index],
        position=position,
        stiffness=1 / sum(parts.values()),
        contributions=parts,
    )


@dataclass(frozen=True, slots=True)
class Many:
    """Results of many designs.

    `names` are the metrics and `values` (metrics, designs) their governing values, NaN if missing.
    `margin` (designs,) is the smallest margin of all limits, including those of the check list.
    `missed` (designs,) is the index in `limits` of the limit with this margin. `read` are the PATHs
    (such as `cylinder.bore`) of the inputs that models and limits have used.
    """

    names: tuple[str, ...]
    values: Array
    margin: Array
    missed: Array
    limits: tuple[MetricLimit, ...]
    read: frozenset[str]

    @property
    def metrics(self) -> dict[str, Array]:
        """Governing values (designs,) by metric."""
        return dict(zip(self.names, self.values, strict=True))

    @property
    def feasible(self) -> Array:
        """Whether requirements and checks are met, (designs,)."""
        feasible: Array = self.margin >= -TOLERANCE
        return feasible


@np.errstate(all="ignore")  # values that are not finite are NaN
def evaluate_many(
    subject: PreparedDesign,
    varied: Mapping[str, Array],
    count: int,
    wanted: Container[str] | None = None,
) -> Many:
    """Calculate metrics and margins of designs that differ only in the numbers in `varied`.

    Parameters
    ----------
    subject : the design
    varied : arrays (designs,) by PATH, such as `cylinder.bore`, SI
    count : number of designs
    wanted : metrics to compute; default: all
    """
    v, names = subject.values(varied), names_of_metrics(subject, wanted)
    return many(subject, names, rows_of_many(subject, v, names, count), v.read)


def many(subject: PreparedDesign, names: tuple[str, ...], rows: Array, read: Iterable[str]) -> Many:
    """Results of many designs from the rows of `rows_of_many` (metrics + 2, designs)."""
    missed = rows[-1].astype(np.int32)
    return Many(names, rows[:-2], rows[-2], missed, limits_of(subject), frozenset(read))


def names_of_metrics(
    subject: PreparedDesign, wanted: Container[str] | None = None
) -> tuple[str, ...]:
    """Metrics of a design; with `wanted`, only those that it contains."""
    return tuple(name for name in subject.quantities if wanted is None or name in wanted)


def rows_of_many(subject: PreparedDesign, v: Values, names: Iterable[str], count: int) -> Array:
    """Governing values of metrics, least margin and the number of its limit (metrics + 2, designs).

    A value that is not finite becomes NaN, an unknown margin minus infinity. The numbers in `v` may
    be symbols.
    """
    computed = compute(subject, v).computed
    values = [governing(name, computed, v, subject) for name in names]
    rows = [where(np.isfinite(value), value, np.nan) for value in values]
    margin, missed = np.full(count, np.inf), np.zeros(count)
    for number, value in _margins(limits_of(subject), computed, v, count):
        worse = np.logical_not(value >= margin)  # NaN counts as the smallest margin
        margin = where(worse, where(np.isnan(value), -np.inf, value), margin)
        missed = where(worse, float(number), missed)
    rows += [margin, missed]
    xp = namespace(*rows)
    return xp.stack([xp.broadcast_to(row, (count,)) for row in rows])


@np.errstate(all="ignore")
def margins_of(subject: PreparedDesign, varied: Mapping[str, Array], count: int) -> Array:
    """Margins of all limits for designs that differ in `varied`, (limits, designs).

    The limits are in the order of `limits_of`. A margin is infinite if the limit does not apply,
    and NaN if the limited value is not finite.
    """
    v = subject.values(varied)
    limits = limits_of(subject)
    margins = np.full((len(limits), count), np.inf)
    for number, value in _margins(limits, compute(subject, v).computed, v, count):
        margins[number] = np.minimum(margins[number], value)
    return margins


def margins_many(
    subject: PreparedDesign, varied: Mapping[str, Array], count: int
) -> dict[str, Array]:
    """Margins (designs,) by name of limit, for designs that differ only in the numbers in `varied`.

    A margin is infinite if the limit does not apply, and minus infinity if the limited value is
    unknown.
    """
    margins = margins_of(subject, varied, count)
    return {
        limit.name: np.where(np.isnan(row), -np.inf, row)
        for limit, row in zip(limits_of(subject), margins, strict=True)
    }


def _margins(
    limits: Sequence[MetricLimit], computed: MetricArrays, v: Values, count: int
) -> Iterator[tuple[int, Array]]:
    """Yield (index of limit, its margins (designs,)) for each limit, load case and location."""
    for number, limit in enumerate(limits):
        for row in rows_of(limit, computed, v):
            yield number, np.broadcast_to(row.margin, (count,))


def limits_of(subject: PreparedDesign) -> tuple[MetricLimit, ...]:
    """All limits that a feasible design must meet: requirements, checks and geometry."""
    limits = all_limits(subject.design, subject.plugins)
    return tuple(limit for limit in limits if limit.origin != "advice")
