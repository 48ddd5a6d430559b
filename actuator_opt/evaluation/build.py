"""Build an Evaluation from a model run: rows, checks, warnings, provenance."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from typing import Literal

import numpy as np

from ..base import quantities
from ..design import paths
from ..design.material import Material
from ..design.materials import Library, load_library
from ..design.model import Design
from ..metrics import METRICS, MetricRow
from ..metrics.table import CHECKS
from ..version import VERSION
from . import dynamics_study as dynamics, outline, standard_parts, validity as doubts
from .governing import governing
from .kernel import ModelRun, PreparedDesign, compute
from .limits import (ALL_CASES, Limit, LimitRow, MetricArrays, all_limits, allowances, by_case, check_limits, default_limits, extremes, rows_of)
from .plugin import Plugin
from .result import Check, Evaluation, Metric, Requirement, StrokeCurve
from .rings import Ring
from .validity import model_of
from .values import Values, of_case
from .wall_study import study as wall_study

NO_ANSWER = "not computable for these dimensions"
NOT_COMPUTED = "not computed for this design"

TOLERANCE = 1e-6
"""A margin of at least −TOLERANCE counts as met."""


def names_of_materials(design: Design) -> list[str]:
    """All materials of a design, without duplicates, in order of appearance."""
    names = [design.fluid.material]
    names += [ply.material for ply in design.barrel.layup]
    names += [ply.material for ply in design.rod.layup]
    names += [design.rod.material, design.piston.material, design.head.material]
    if design.rod.fitting is not None:
        names += [design.rod.fitting.material or design.rod.material, design.rod.fitting.adhesive]
    names += [part.bearing for part in (design.piston, design.head) if part.bearing is not None]
    names.append(design.caps.material)
    if design.retention is not None and design.retention.material is not None:
        names.append(design.retention.material)
    if design.clevis is not None:
        names.append(design.clevis.material)
    for seal in (design.seals.piston, design.seals.rod):
        names += seal.materials()
    names += [line.material for line in design.lines]
    return list(dict.fromkeys(names))


def prepare(
    design: Design,
    materials: Library | Mapping[str, Material] | None = None,
    plugins: tuple[Plugin, ...] = (),
) -> PreparedDesign:
    """A design with its materials and all its numbers, ready to evaluate.

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


def spec_hash(subject: PreparedDesign) -> str:
    """Hash of everything that determines the result: design, material data, version."""
    design = subject.design.model_dump(mode="json")
    if not design["uncertainty"]:  # unset fields are left out: hashes of older designs stay valid
        del design["uncertainty"]
    content = {
        "design": design,
        "materials": {k: v for k, v in subject.numbers.items() if k.startswith("materials.")},
        "version": VERSION,
    }
    text = json.dumps(content, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@np.errstate(all="ignore")  # values that are not finite are reported as such
def evaluate(subject: PreparedDesign) -> Evaluation:
    """Compute all metrics, requirements and checks of a design."""
    v = subject.values()
    done = compute(subject, v)
    computed = done.computed
    design = subject.design
    own = [x for x in all_limits(design, subject.plugins) if x.origin in ("requirement", "case")]
    requirements = tuple(_requirement(limit, computed, v) for limit in own)
    warnings = list(doubts.warnings(subject, v, done))
    outside = {metric for metric, _ in warnings}
    metrics = {name: _metric(name, computed, v, subject, outside) for name in subject.quantities}
    checks = tuple(_checks(design, computed, v, requirements, done.rings))
    warnings += [
        ("", f"check missed: {c.name}: {_against(c)}") for c in checks if c.status == "missed"
    ]
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
        models=tuple(
            doubts.models(metrics, subject, done.rings, outside, [t for _, t in warnings])
        ),
        mass_parts={name: float(np.squeeze(m)) for name, m in done.mass_parts.items()},
        curve=_curve(done, v, metrics["stiffness_min"].case),
        outlines=outline.outlines(design, subject.materials, done.geometry),
        lengths=outline.lengths(design, done.geometry),
        wall=wall_study(subject, v, done),
        dynamics=dynamics.study(subject, v, done, metrics["stiffness_min"].case),
        friction_parts=_friction_parts(computed, v, metrics["friction_running"].case),
    )


def _friction_parts(computed: MetricArrays, v: Values, case: str | None) -> dict[str, float]:
    """Running friction of each seal in a case; parts without friction are left out."""
    found = {}
    for label, array in computed.friction_parts.items():
        values = dict(by_case(computed, "friction_running", array, v.cases))
        value = float(values.get(case or ALL_CASES, values.get(ALL_CASES, np.zeros(1)))[0])
        if value:
            found[label] = value
    return found


def _finite(value: float) -> bool:
    return math.isfinite(value)


def _metric(
    name: str, computed: MetricArrays, v: Values, subject: PreparedDesign, outside: set[str]
) -> Metric:
    rows: list[tuple[float, str, str]] = []
    for place, array in computed.metrics.get(name, {}).items():
        for case, value in by_case(computed, name, array, v.cases, place):
            rows.append((float(value[0]), case, place))
    value = float(governing(name, computed, v, subject)[0])
    if not _finite(value):
        computed_at_all = name in computed.metrics
        why = computed.why.get(name, NO_ANSWER if computed_at_all else NOT_COMPUTED)
        if value == math.inf:
            why = computed.why.get(name, "no load: the factor is unlimited")
        definition = None if name in METRICS else subject.quantities[name]
        return Metric(name=name, value=None, why=why, definition=definition)
    _, case, place = next(row for row in rows if row[0] == value)
    extremes = min(row[0] for row in rows), max(row[0] for row in rows)
    sense: quantities.Sense = "min" if value == extremes[0] else "max"
    pick = min if sense == "min" else max
    model = model_of(
        name,
        wall=doubts.kind_of(subject),
        criterion=subject.design.barrel.criterion,
        place=place,
    )
    per_case: dict[str, float] = {}
    for one, where, _ in rows:
        if _finite(one):
            per_case[where] = pick(one, per_case.get(where, one))
    return Metric(
        name=name,
        value=value,
        case=None if case == ALL_CASES else case,
        place=place or None,
        by_case=per_case,
        sense=None if extremes[0] == extremes[1] else sense,
        model="" if model is None else model.name,
        reference="" if model is None else model.reference,
        in_range=name not in outside,
        definition=None if name in METRICS else subject.quantities[name],
    )


def _worst(rows: Iterable[LimitRow]) -> LimitRow | None:
    """The row with the least margin; NaN counts as the least."""
    return min(
        rows,
        key=lambda row: -math.inf if math.isnan(row.margin[0]) else float(row.margin[0]),
        default=None,
    )


def _requirement(limit: Limit, computed: MetricArrays, v: Values) -> Requirement:
    row = _worst(rows_of(limit, computed, v))
    bound = float(np.squeeze(limit.value(v)))
    if row is None or not _finite(float(row.value[0])):
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
        case=None if row.case == ALL_CASES else row.case,
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
    yield standard_parts.sizes(design)
    yield standard_parts.glands(rings)


def _check(
    name: str,
    metric: MetricRow,
    limit: Limit | None,
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
        known: Literal["missed", "not_checked"] = (
            "not_checked" if metric.name in computed.why else "missed"
        )
        reason = computed.why.get(metric.name, NO_ANSWER)
        return Check(name, known, reason, metric.name, sense, result.limit)
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
    return f"{quantity.text(check.value)}, should be {word} {quantity.text(check.limit)}"


def _curve(done: ModelRun, v: Values, case: str | None) -> StrokeCurve:
    """Stiffness over the stroke in the governing case."""
    stroke = float(np.squeeze(done.geometry.stroke))
    index = v.cases.index(case) if case in v.cases else 0
    weakest = of_case(done.weakest, index)
    position = np.unique(np.append(np.linspace(0.0, stroke, 101), weakest))
    parts = {
        name: np.broadcast_to(np.atleast_2d(value), (len(v.cases), position.size))[index]
        for name, value in done.springs.compliances(position).items()
    }
    return StrokeCurve(
        case=v.cases[index],
        position=position,
        stiffness=1 / sum(parts.values()),
        contributions=parts,
    )
