"""Validity of a result: exceeded ranges, unverified data, and models from which metrics come."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fnmatch import fnmatchcase
from math import pi
from typing import cast

import numpy as np

from ..design import assembly, standard_sizes
from ..design.material import compatible
from ..design.model import PLAIN_CAP, Design
from ..design.paths import quantity_of
from ..joints.cone import LAYER_EDGE
from ..joints.winding import WINDING_EDGE
from ..metrics import METRICS
from ..metrics.documentation import ModelDocumentation, describe, function_of
from ..metrics.metric_row import CRITERION
from ..metrics.table import OWN, ROWS, WALL_FED
from ..models import contact_profile, gland, laminate, rough_surface, seals
from ..models.strength import CRITERIA
from ..models.winding_path import SLIPPAGE
from . import (
    circuit,
    geometry as geometry_module,
    linkage as joint,
    motion,
    proportions,
    springs,
    state,
)
from .barrel import LAMINATES, kind
from .duty_cycles import validity as duty_validity
from .duty_cycles.study import DutyStudy
from .film_tables import FilmTable
from .geometry import Geometry
from .kernel import ModelRun, PreparedDesign
from .ports import places
from .result import Metric, ModelUse, Unverified
from .rings import Ring, extrusion_end, seal_contact, static_rings
from .rod_strength import NEAR
from .spool import spool_motion
from .values import Values


def model_of(
    metric: str, *, wall: str, criterion: str = "max_stress", place: str | None = None
) -> ModelDocumentation | None:
    """Model of a metric at its governing location; None for inputs and plain geometry.

    `wall` is the name of the barrel's wall model, `criterion` the failure criterion of its plies.
    """
    row = ROWS.get(metric)
    if row is None:  # a user metric
        return None
    name = row.by_wall.get(wall) or row.model  # type: ignore[call-overload]
    local = "" if place is None else place.removeprefix("cap: ").removeprefix("head: ")
    for pattern, other in row.at.items():
        if place is not None and fnmatchcase(local, pattern):
            name = other
    if name == CRITERION:
        return describe(cast(Callable[..., object], CRITERIA[criterion].modes))
    return None if name is None else describe(function_of(name))


FILM_ERROR = 0.02
"""Relative interpolation error of an oil film above which a warning is given."""
_SURROGATES = {
    "friction": "friction_running",
    "flow": "rod_leakage",
    "thickness": "film_thickness",
}


def seal_warnings(subject: PreparedDesign, v: Values, run: ModelRun) -> Iterable[tuple[str, str]]:
    """Yield (metric, sentence) for every warning about the seals."""
    for ring in run.rings:
        yield from _contact(subject, ring)
        yield from _limits(subject, run, ring, float(v["supply.pressure"]))
    for ring in static_rings(v, subject.design, run.geometry):
        yield from _limits(subject, run, ring, float(v["supply.pressure"]))
    if "rod_leakage" in run.computed.metrics:
        yield from _leak_at_rest(subject)
    for (place, case, stroke), table in subject.films.items():
        yield from _film(f"film of the {place} seals ({v.cases[case]}, {stroke})", table)


def _contact(subject: PreparedDesign, ring: Ring) -> Iterable[tuple[str, str]]:
    """Warn of contact laws outside their range, compounds that the fluid attacks, lost contact."""
    liquid, compound = subject.design.fluid.material, ring.element.compound
    if not ring.element.contact:
        for text in ring.element.seal_type.warnings(ring.sizes):
            yield "friction_running", f"{ring.label}: {text}"
    else:
        yield (
            "friction_running",
            f"{ring.label}: the stated contact profiles are used as given; loss of squeeze by "
            "bore growth does not change them",
        )
    if compatible(subject.materials[liquid], subject.materials[compound]) is False:
        yield "", f"{ring.label}: {compound} does not withstand {liquid}"
    if np.any(np.real(ring["squeeze_left"]) <= 0):
        yield (
            "friction_running",
            f"{ring.label}: bore growth uses up the whole squeeze, so the ring no longer touches",
        )
    elif not np.all(np.real(seal_contact(ring).excess) > 0):
        yield (
            "friction_running",
            f"{ring.label}: the sealed pressure would lift the ring off its counterface, because "
            "its contact load is too small",
        )


def _leak_at_rest(subject: PreparedDesign) -> Iterable[tuple[str, str]]:
    """Warn of a rod seal whose film would leak even at rest."""
    if any(
        place != "piston" and not table.row.outward and table.flow > 0
        for (place, _, _), table in subject.films.items()
    ):
        yield (
            "rod_leakage",
            "rod_leakage is too high: the model's averaged oil film passes oil at any gap, even "
            "at rest and on the instroke, where a real elastomer seal is tight",
        )


def _film(name: str, table: FilmTable) -> Iterable[tuple[str, str]]:
    """Warn of film tables with large errors or unsolved points, or that do not cover the design."""
    for quantity, metric in _SURROGATES.items():
        if table.errors[quantity] > FILM_ERROR:
            error = 100 * table.errors[quantity]
            yield (
                metric,
                f"{name}: within the variable bounds, the interpolated {quantity} of the oil film "
                f"deviates by up to {error:.1f} % from the solved film",
            )
    if not table.surrogate.covers(table.row.inputs()):
        yield (
            "friction_running",
            (f"{name}: the design is outside the range for which oil films were solved"),
        )
    if table.surrogate.failed:
        count = len(table.surrogate.failed)
        yield (
            "friction_running",
            f"{name}: for {count} of the computed points, the oil film has no solution "
            f"({table.surrogate.failed[0]})",
        )


def _limits(
    subject: PreparedDesign, run: ModelRun, ring: Ring, supply: float
) -> Iterable[tuple[str, str]]:
    """Warn of pressure, speed and extrusion beyond the limits or data of the compound."""
    compound = subject.materials[ring.element.compound]
    limits = compound.numbers
    fastest = float(np.max(np.real(run.state.speed)))
    if not ring.element.back_ups and supply > limits.get("pressure_max", np.inf):
        yield (
            "",
            f"{ring.label}: the pressure is {supply / 1e5:.0f} bar, but {compound.name} allows "
            f"only {limits['pressure_max'] / 1e5:.0f} bar without a back-up ring",
        )
    if ring.name != "static" and fastest > limits.get("speed_max", np.inf):
        yield (
            "",
            f"{ring.label}: the speed is {fastest:.2g} m/s, but {compound.name} allows only "
            f"{limits['speed_max']:.2g} m/s",
        )
    end = extrusion_end(ring, subject.materials)
    if supply > end * (1 + 1e-9):
        yield (
            "extrusion_factor",
            f"{ring.label}: limits of the extrusion gap are known only up to {end / 1e5:.0f} bar "
            "and are assumed to be constant above it; use a back-up ring",
        )


def seal_models(
    rings: Iterable[Ring], subject: PreparedDesign, texts: Iterable[str]
) -> Iterable[ModelUse]:
    """Yield the models of all sealing rings; `texts` are the sentences of the warnings."""
    texts = tuple(texts)
    for ring in rings:
        doubted = any(text.startswith(ring.label) for text in texts)
        yield _contact_model(ring, doubted=doubted)
    if subject.films:
        worst = max(table.errors["friction"] for table in subject.films.values())
        yield _use(
            rough_surface.asperity_pressure,
            "mean-film Reynolds equation with cavitation and rough, elastic contact; "
            f"interpolation error up to {100 * worst:.2g} %",
            doubted=worst > FILM_ERROR,
        )
    if any("extrusion_gap_max" not in subject.materials[r.element.compound].numbers for r in rings):
        yield _use(
            gland.extrusion_gap_limit,
            "limit of the extrusion gap by hardness and pressure",
            doubted=False,
        )


def _contact_model(ring: Ring, *, doubted: bool) -> ModelUse:
    """Contact model of a ring; `doubted` states whether it is used outside its range."""
    element = ring.element
    at = f"squeeze {100 * element.squeeze:.4g} %"
    if element.contact:
        reach = element.contact[-1].pressure / 1e5
        return _use(
            contact_profile.table_profile,
            f"{ring.label}, stated contact profiles up to {reach:.0f} bar",
            doubted=doubted,
        )
    if element.seal_type.model is None:
        law = seals.LAWS[element.law]
        low, high = law.squeeze_range
        return ModelUse(
            f"seals.{law.name}",
            f"O-ring contact law of the {ring.label}, modulus by {element.hardness_model}",
            law.reference,
            f"squeeze {100 * low:.0f} to {100 * high:.0f} %, p/E up to {law.pressure_range[1]:g}",
            at,
            not doubted,
        )
    return _use(element.seal_type.model, f"{ring.label}, {at}", doubted=doubted)


def _use(function: Callable[..., object], used_at: str, *, doubted: bool) -> ModelUse:
    model = describe(function)
    return ModelUse(model.name, model.summary, model.reference, model.valid, used_at, not doubted)


LONGEST_LIFE = 1e9
"""Number of cycles up to which there are data for stress-life curves [Shigley2011]."""


def _life_warnings(run: ModelRun) -> Iterable[tuple[str, str]]:
    """Warn of parts without fatigue data, and of lives beyond those of tests."""
    yield from (("", text) for text in run.computed.left_out)
    lives = [np.min(np.real(x)) for x in run.computed.metrics.get("cycle_life", {}).values()]
    if lives and np.isfinite(min(lives)) and min(lives) > LONGEST_LIFE:
        yield (
            "cycle_life",
            f"pressure-cycle life beyond {LONGEST_LIFE / 1e6:.0f} million cycles is extrapolated: "
            "read it as more than that, for metals only, not for adhesive or plies",
        )


def kind_of(subject: PreparedDesign) -> str:
    """Name of the wall model of a design."""
    return kind(subject.design, subject.materials)


def warnings(
    subject: PreparedDesign, v: Values, run: ModelRun, duty: DutyStudy | None = None
) -> Iterable[tuple[str, str]]:
    """Yield (metric, sentence) for each model or value that is used outside its valid range."""
    g = run.geometry
    thin = float(np.max(run.wall.thin_ratio))
    if kind_of(subject) == "thin_laminate" and thin > laminate.THIN_WALL_LIMIT:
        text = (
            f"thin-laminate barrel at t/r = {thin:.3f} (reliable to {laminate.THIN_WALL_LIMIT}): "
            "computed bore growth, extrusion gap, squeeze loss and compliance are 10 to 25 % too "
            "low; computed first-ply and burst pressures are conservative"
        )
        for metric in WALL_FED:
            yield metric, text
    yield from (("", text) for text in proportions.warnings(subject, v, g))
    yield from _wall_warnings(subject, run)
    for end in run.joints:
        for metric, sentence in end.joint.warnings(end.loaded, METRICS):
            yield metric, end.end_joint.placed(sentence)
    yield from _rod_warnings(subject, run)
    yield from _winding_warnings(subject.design, run)
    yield from _head_warnings(subject.design)
    yield from (("", text) for text in assembly.warnings(subject.design))
    yield from _skirt_oil_warnings(subject.design, run)
    yield from _port_warnings(subject, g)
    yield from _bond_warnings(run)
    for part, assumption in (
        ("head", "material and length of the piston"),
        ("caps", f"the piston's material, and a thickness of {PLAIN_CAP:g} times the bore"),
    ):
        if part not in subject.design.model_fields_set:
            yield "", f"no {part} stated; assumed: {assumption}"
    yield from _life_warnings(run)
    section = subject.design.fluid
    yield from state.warnings(section, subject.materials[section.material], v.cases, run.state)
    yield from seal_warnings(subject, v, run)
    yield from springs.warnings(run.springs)
    yield from joint.warnings(subject.design, run.state.joint)
    yield from motion.warnings(v, subject.design, run.motion, run.state, run.computed)
    if duty is not None:
        valve = subject.design.valve is not None
        yield from duty_validity.warnings(duty, _frequencies(subject, v, run), valve=valve)
        yield from duty_validity.short_strokes(duty)
    if run.wall.missing:
        yield "burst_factor", f"barrel: {run.wall.missing[0]}"
    yield from _measured(subject, v)
    for material in subject.materials.values():
        if material.warning:
            yield "", f"{material.name}: {material.warning}"
    if float(np.max(np.abs(v.case("side_load")))) > 0:
        yield (
            "",
            (
                "the side load pushes the piston against the bore; on one side the extrusion gap "
                f"grows by the clearance of {1e6 * float(np.max(g.piston_clearance)):.0f} um"
            ),
        )


def _frequencies(subject: PreparedDesign, v: Values, run: ModelRun) -> dict[str, float]:
    """Lowest frequencies of the actuator by their words [Hz]; unknown ones are left out."""
    frequencies = {}
    for name, words in (
        ("natural_frequency", "natural frequency"),
        ("bandwidth", "bandwidth of the position loop"),
    ):
        values = [np.real(x) for x in run.computed.metrics.get(name, {}).values()]
        known = [x[np.isfinite(x)] for x in map(np.asarray, values)]
        if any(x.size for x in known):
            frequencies[words] = float(min(np.min(x) for x in known if x.size))
    if subject.design.valve is not None:
        motion = spool_motion(circuit.of_valve(v))
        frequencies["natural frequency of the spool"] = float(motion.natural_frequency)
    return frequencies


def _measured(subject: PreparedDesign, v: Values) -> Iterable[tuple[str, str]]:
    """Warn of values outside the bounds that their test record gives."""
    for path, bounds in subject.design.measured.items():
        value = float(np.real(np.squeeze(v[path]))) if path in v else None
        if value is not None and not bounds.lower <= value <= bounds.upper:
            text = quantity_of(path, subject.design).text
            yield (
                "",
                f"{path}: {text(value)} is outside the bounds from {bounds.record}, "
                f"{text(bounds.lower)} to {text(bounds.upper)}: the test record does not support "
                "this value",
            )


def _wall_warnings(subject: PreparedDesign, run: ModelRun) -> Iterable[tuple[str, str]]:
    """Warn of effects that the wall model leaves out."""
    laminated = kind_of(subject) in LAMINATES
    environment = subject.design.environment
    if laminated and (environment is None or environment.cure_temperature is None):
        yield (
            "",
            "no cure temperature stated, so first-ply and yield pressures exclude cooling stresses",
        )
    elif laminated and run.wall.expansion is None:
        yield (
            "",
            f"first-ply and yield pressures exclude cooling stresses: {run.wall.why_no_mismatch}",
        )
    if laminated and not all(ply.balanced for ply in subject.design.barrel.layup):
        yield (
            "",
            (
                "bending and buckling are computed as if unbalanced plies of the wall were "
                "balanced pairs"
            ),
        )
    autofrettage = run.wall.autofrettage
    if subject.design.barrel.autofrettage_pressure is not None:
        if autofrettage is None:
            yield (
                "",
                "autofrettage is ignored: its model needs the layered (exact) wall, a metal liner "
                "and balanced pairs",
            )
        elif float(np.min(np.real(autofrettage.axial_margin))) < 0:
            yield (
                "reverse_yield_factor",
                "autofrettage makes the liner yield axially too: the computed axial residual "
                "strain is up to a third too low; computed hoop residual stresses are accurate",
            )


LONG_TURN = 0.2
"""A warning names a winding whose turn takes more than this share of its part. Our choice."""


def _head_warnings(design: Design) -> Iterable[tuple[str, str]]:
    """Warn of a head without wiper, or without bushing for the rod."""
    if design.seals.rod.wiper is None:
        yield (
            "",
            "the rod has no wiper, so that dirt reaches its seal: add seals.rod.wiper, or a "
            "bellows under extra_masses",
        )
    if design.seals.rod.guide is None and design.head.bearing is None:
        yield (
            "",
            f"the rod has no bushing and runs on {design.head.material}: add seals.rod.guide or "
            "head.bearing",
        )


def _skirt_oil_warnings(design: Design, run: ModelRun) -> Iterable[tuple[str, str]]:
    """Warn of a dead volume that is smaller than the oil in the bore of the cap's inner skirt."""
    for cap in run.joints[:1]:
        if cap.joint.inner_skirt:
            end = cap.loaded.end
            radius = end.inner_radius - end.sizes["inner_wall"]
            volume = float(np.max(np.real(pi * radius * radius * end.sizes["length"])))
            if design.cylinder.dead_volume_a < volume:
                yield (
                    "stiffness_min",
                    f"the bore of the cap's inner skirt encloses {1e6 * volume:.2g} ml of oil, "
                    f"more than the stated {1e6 * design.cylinder.dead_volume_a:.2g} ml: add it to "
                    "cylinder.dead_volume_a",
                )


def _port_warnings(subject: PreparedDesign, g: Geometry) -> Iterable[tuple[str, str]]:
    """Warn of ports in bosses, whose fixing no model covers, and of their holes in plies."""
    found = places(subject.design, g)
    if found is None or not any(found.on_barrel):
        return
    layers = subject.design.barrel.layup
    plies = any(subject.materials[layer.material].kind == "ply" for layer in layers)
    hole = " nor the stress in the plies beside its hole" if plies else ""
    yield ("", f"no model covers how the boss of a port is fixed to the barrel{hole}")


def _winding_warnings(design: Design, run: ModelRun) -> Iterable[tuple[str, str]]:
    """Warn of a helical winding whose turn needs much length, unless the design states the turn."""
    g, text = run.geometry, METRICS["turn_length"].text
    for place, values in run.computed.metrics.get("turn_length", {}).items():
        length = float(np.max(np.real(values)))
        part = float(np.max(np.real(g.wall_length if place.startswith("barrel") else g.rod_length)))
        stated = design.barrel.turn is not None and place.startswith("barrel")
        if length > LONG_TURN * part and not stated:
            yield (
                "",
                f"{place}: on a plain mandrel, the winding needs {text(length)} beyond each end to "
                f"turn (friction {SLIPPAGE:g}), and the part is {text(part)} long: state "
                "barrel.turn, cut_off or pins",
            )


def _rod_warnings(subject: PreparedDesign, run: ModelRun) -> Iterable[tuple[str, str]]:
    """Warn of effects that the strength calculation of the rod leaves out."""
    rod = run.rod
    if rod.layers and not rod.cured:
        why = "no cure temperature stated"
        if rod.expansion is None:
            name = next(layer.name for layer in rod.layers if layer.expansions is None)
            why = f"the thermal expansion of {name} is unknown"
        yield "rod_factor", f"stresses in the rod's layers exclude cooling stresses: {why}"
    if rod.missing:
        yield "rod_factor", f"rod: {rod.missing[0]}"
    factors = run.computed.metrics["buckling_factor"].values()
    if min(float(np.min(np.real(factor))) for factor in factors) < 1 / NEAR:
        for metric in ("yield_factor", "rod_factor", "local_buckling_factor"):
            yield (
                metric,
                f"the push exceeds {100 * NEAR:.0f} % of the buckling load; above this share, the "
                "bending moment of the rod is extrapolated",
            )


def _bond_warnings(run: ModelRun) -> Iterable[tuple[str, str]]:
    """Warn of a bond whose strength is exceeded by shear from force and temperature together.

    The end of a winding on a liner is such a bond too.
    """
    metrics = run.computed.metrics
    sums = {}
    bonds = {"rod fittings": ("fitting_factor", "bond", "bond of the rod fittings")}
    for end in run.joints:
        name = end.end_joint.name or "caps"
        for edge, words in (
            ("bond", "bond of the"),
            (WINDING_EDGE, "end of the winding at the"),
            (LAYER_EDGE, "end of the inner layers at the"),
        ):
            start = end.end_joint.placed(edge)
            if any(at.startswith(start) for at in metrics.get("retention_factor", {})):
                bonds[name] = ("retention_factor", start, f"{words} {name}")
    for place, (metric, start, words) in bonds.items():
        heat = [x for at, x in metrics.get("bond_thermal_factor", {}).items() if place in at]
        force = [x for at, x in metrics.get(metric, {}).items() if at.startswith(start)]
        if heat and force:
            sums[words] = sum(
                max(float(np.max(1 / np.real(row))) for row in rows) for rows in (heat, force)
            )
    if sums and max(sums.values()) > 1:
        place = max(sums, key=lambda name: sums[name])
        yield (
            "",
            f"{place}: at the edge, the elastic shear stresses due to force and temperature add up "
            f"to {sums[place]:.2f} times the strength; each stress is checked alone, because a "
            "ductile adhesive or resin yields, which relieves both",
        )


def models(
    metrics: dict[str, Metric],
    subject: PreparedDesign,
    rings: tuple[Ring, ...],
    outside: set[str],
    texts: Iterable[str],
) -> Iterable[ModelUse]:
    """Yield all models from which the computed metrics come, with the names of these metrics.

    A model is extrapolated if it is used outside its own valid range. If only an input of a metric
    is extrapolated, the metric is marked, but not its model. `texts` are the sentences of the
    warnings.
    """
    texts = tuple(texts)
    wall, criterion = kind_of(subject), subject.design.barrel.criterion
    uses: dict[str, ModelUse] = {}
    for name, metric in metrics.items():
        model = model_of(name, wall=wall, criterion=criterion, place=metric.place)
        if model is None or metric.value is None:
            continue
        value = metric.quantity.text(metric.value)
        at = f"{name} = {value}" + (f" ({metric.case})" if metric.case else "")
        if model.name in uses:
            old = uses[model.name]
            at = f"{old.used_at}; {at}"
        uses[model.name] = ModelUse(
            model.name,
            model.summary,
            model.reference,
            model.valid,
            at,
            name not in (outside & OWN) and (model.name not in uses or uses[model.name].in_range),
        )
    yield from uses.values()
    yield from seal_models(rings, subject, texts)
    liquid = subject.design.fluid
    for function, quantity in state.laws(liquid, subject.materials[liquid.material]):
        model = describe(function)
        yield ModelUse(
            model.name,
            model.summary,
            model.reference,
            model.valid,
            f"{liquid.material}, chambers up to {subject.design.supply.pressure / 1e5:.0f} bar",
            not any(text.startswith(f"{quantity}:") for text in texts),
        )


def unverified(subject: PreparedDesign, v: Values) -> Iterable[Unverified]:
    """Yield the library values in this design that nobody has checked against their source."""
    for name, material in subject.materials.items():
        for key in material.unverified:
            if f"materials.{name}.{key}" in v.read or key == "kinematic_viscosity":
                entry = material.properties[key]
                yield Unverified(name, key, entry.text, entry.source, entry.note)
    thread = subject.design.cylinder.port_thread
    if thread is not None and (port := standard_sizes.port(thread)).confidence == "unverified":
        yield Unverified("port", "sizes", thread, port.source)
    bearing = geometry_module.bearing_of(subject.design)
    if bearing is not None and bearing.confidence == "unverified":
        yield Unverified("bearing", "sizes and rating", bearing.name, bearing.source)
