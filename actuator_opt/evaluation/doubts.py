"""Doubts about a result: exceeded ranges, unverified data, and the model of each number."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..design.model import PLAIN_CAP
from ..design.paths import quantity_of
from ..metrics import METRICS
from ..metrics.table import OWN, WALL_FED
from ..models import laminate
from . import joint, motion_range, oil, oil_range, proportions, seal_doubts, springs
from .barrel import LAMINATES, kind
from .beam import NEAR
from .kernel import ModelRun, PreparedDesign
from .provenance import describe, model_of
from .result import Metric, ModelUse, Unverified
from .rings import Ring
from .values import Values

LONGEST_LIFE = 1e9
"""Cycles up to which stress-life curves have data [Shigley2011]."""


def kind_of(subject: PreparedDesign) -> str:
    """Wall model of a design."""
    return kind(subject.design, subject.materials)


def warnings(subject: PreparedDesign, v: Values, done: ModelRun) -> Iterable[tuple[str, str]]:
    """(metric, sentence) for everything outside its range or doubtful."""
    g = done.geometry
    thin = float(np.max(done.wall.thin_ratio))
    if kind_of(subject) == "thin_laminate" and thin > laminate.THIN_WALL_LIMIT:
        text = (
            f"thin-laminate barrel at t/r = {thin:.3f} (reliable to {laminate.THIN_WALL_LIMIT}): "
            "bore growth is too low by 10 to 25 %, and so are gap, squeeze loss and "
            "compliance; first ply and burst of plies are conservative"
        )
        for metric in WALL_FED:
            yield metric, text
    yield from (("", text) for text in proportions.warnings(subject, v, g))
    yield from _wall_warnings(subject, done)
    if done.held is not None:
        yield from done.held.joint.warnings(done.held.loaded, METRICS)
    yield from _rod_warnings(subject, done)
    yield from _bond_warnings(done)
    for part, what in (
        ("head", "material and length of the piston"),
        ("caps", f"the piston's material, thickness {PLAIN_CAP:g} bore"),
    ):
        if part not in subject.design.model_fields_set:
            yield "", f"no {part} stated: assumed {what}"
    lives = [np.min(np.real(x)) for x in done.computed.metrics.get("cycle_life", {}).values()]
    if lives and np.isfinite(min(lives)) and min(lives) > LONGEST_LIFE:
        yield (
            "cycle_life",
            f"pressure-cycle life beyond {LONGEST_LIFE / 1e6:.0f} million cycles is extrapolated: "
            "treat it as a lower bound; adhesive and plies are not included",
        )
    section = subject.design.fluid
    yield from oil_range.warnings(section, subject.materials[section.material], v.cases, done.state)
    yield from seal_doubts.warnings(subject, v, done)
    yield from springs.warnings(done.springs)
    yield from joint.warnings(subject.design, done.state.joint)
    yield from motion_range.warnings(v, subject.design, done.motion, done.state, done.computed)
    if done.wall.missing:
        yield "burst_factor", f"barrel: {done.wall.missing[0]}"
    yield from _measured(subject, v)
    for material in subject.materials.values():
        if material.warning:
            yield "", f"{material.name}: {material.warning}"
    if float(np.max(np.abs(v.case("side_load")))) > 0:
        yield (
            "",
            (
                "side load displaces the piston: on one side the extrusion gap is larger by the "
                f"clearance, {1e6 * float(np.max(g.piston_clearance)):.0f} um"
            ),
        )


def _measured(subject: PreparedDesign, v: Values) -> Iterable[tuple[str, str]]:
    """Values outside the bounds of their test record."""
    for path, known in subject.design.measured.items():
        value = float(np.real(np.squeeze(v[path]))) if path in v else None
        if value is not None and not known.lower <= value <= known.upper:
            text = quantity_of(path, subject.design).text
            yield (
                "",
                f"{path}: {text(value)} is outside the bounds from {known.record}, "
                f"{text(known.lower)} to {text(known.upper)}: the record does not support it",
            )


def _wall_warnings(subject: PreparedDesign, done: ModelRun) -> Iterable[tuple[str, str]]:
    """Effects that the wall model leaves out."""
    laminated = kind_of(subject) in LAMINATES
    environment = subject.design.environment
    if laminated and (environment is None or environment.cure_temperature is None):
        yield (
            "",
            "no cure temperature stated: first ply and yield exclude cooling stresses",
        )
    elif laminated and done.wall.expansion is None:
        yield (
            "",
            f"first ply and yield exclude cooling stresses: {done.wall.why_no_mismatch}",
        )
    if laminated and not all(ply.balanced for ply in subject.design.barrel.layup):
        yield "", "bending and buckling treat single plies of the wall as balanced pairs"
    worked = done.wall.autofrettage
    if subject.design.barrel.autofrettage_pressure is not None:
        if worked is None:
            yield (
                "",
                "autofrettage is ignored: it needs the exact tube, a metal liner and "
                "balanced pairs",
            )
        elif float(np.min(np.real(worked.axial_margin))) < 0:
            yield (
                "reverse_yield_factor",
                "autofrettage also yields the liner axially: the axial residual strain is "
                "too low by up to a third; hoop residual stresses are accurate",
            )


def _rod_warnings(subject: PreparedDesign, done: ModelRun) -> Iterable[tuple[str, str]]:
    """Effects that the strength of the rod leaves out."""
    rod = done.rod
    if rod.layers and not rod.cured:
        why = "no cure temperature stated"
        if rod.expansion is None:
            name = next(layer.name for layer in rod.layers if layer.expansions is None)
            why = f"{name} has no thermal expansion"
        yield "rod_factor", f"the rod's layers exclude cooling stresses: {why}"
    if rod.missing:
        yield "rod_factor", f"rod: {rod.missing[0]}"
    factors = done.computed.metrics["buckling_factor"][""]
    if float(np.min(np.real(factors))) < 1 / NEAR:
        for metric in ("yield_factor", "rod_factor", "local_buckling_factor"):
            yield (
                metric,
                f"the push is above {NEAR:.0%} of the buckling load: bending of the rod is "
                "extrapolated beyond it",
            )


def _bond_warnings(done: ModelRun) -> Iterable[tuple[str, str]]:
    """The bond with the highest combined shear of force and temperature, if above its strength."""
    metrics = done.computed.metrics
    sums = {}
    for place, metric in (("caps", "retention_factor"), ("rod fittings", "fitting_factor")):
        heat = [x for at, x in metrics.get("bond_thermal_factor", {}).items() if place in at]
        force = list(metrics.get(metric, {}).values())
        if heat and force:
            sums[place] = sum(
                max(float(np.max(1 / np.real(row))) for row in rows) for rows in (heat, force)
            )
    if sums and max(sums.values()) > 1:
        place = max(sums, key=lambda name: sums[name])
        yield (
            "",
            f"bond of the {place}: the elastic edge shears of force and of temperature add up to "
            f"{sums[place]:.2f} times the strength; each is checked alone, because a ductile "
            "adhesive "
            "yields and relieves both",
        )


def models(
    metrics: dict[str, Metric],
    subject: PreparedDesign,
    rings: tuple[Ring, ...],
    outside: set[str],
    said: Iterable[str],
) -> Iterable[ModelUse]:
    """All models of computed metrics, with their values.

    A model is extrapolated if used outside its own range; a metric that only inherits such a value
    is marked in its own row, not here. `said` are the texts of the warnings.
    """
    said = tuple(said)
    wall, criterion = kind_of(subject), subject.design.barrel.criterion
    seen: dict[str, ModelUse] = {}
    for name, metric in metrics.items():
        model = model_of(name, wall=wall, criterion=criterion, place=metric.place)
        if model is None or metric.value is None:
            continue
        used = metric.quantity.text(metric.value)
        at = f"{name} = {used}" + (f" ({metric.case})" if metric.case else "")
        if model.name in seen:
            old = seen[model.name]
            at = f"{old.used_at}; {at}"
        seen[model.name] = ModelUse(
            model.name,
            model.summary,
            model.reference,
            model.valid,
            at,
            name not in (outside & OWN) and (model.name not in seen or seen[model.name].in_range),
        )
    yield from seen.values()
    yield from seal_doubts.models(rings, subject, said)
    liquid = subject.design.fluid
    for function, what in oil.laws(liquid, subject.materials[liquid.material]):
        model = describe(function)
        yield ModelUse(
            model.name,
            model.summary,
            model.reference,
            model.valid,
            f"{liquid.material}, chambers up to {subject.design.supply.pressure / 1e5:.0f} bar",
            not any(text.startswith(f"{what}:") for text in said),
        )


def unverified(subject: PreparedDesign, v: Values) -> Iterable[Unverified]:
    """Library values of this design that nobody has checked against their source."""
    for name, material in subject.materials.items():
        for key in material.unverified:
            if f"materials.{name}.{key}" in v.read or key == "kinematic_viscosity":
                entry = material.properties[key]
                yield Unverified(name, key, entry.text, entry.source, entry.note)
