"""Doubts about the seals: laws outside their data, films, limits of the compounds."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from ..design.material import compatible
from ..models import contact_profile, extrusion, rough_surface, seals
from .film_tables import Table
from .gland_check import extrusion_end
from .kernel import ModelRun, PreparedDesign
from .provenance import describe
from .result import ModelUse
from .rings import Ring
from .seal_contact import seal_contact
from .values import Values

FILM_ERROR = 0.02
"""Relative error of a film surrogate from which a warning is given."""

_SURROGATES = {
    "friction": "friction_running",
    "flow": "rod_leakage",
    "thickness": "film_thickness",
}


def warnings(subject: PreparedDesign, v: Values, done: ModelRun) -> Iterable[tuple[str, str]]:
    """(metric, text) of all doubts about the seals."""
    for ring in done.rings:
        yield from _contact(subject, ring)
        yield from _limits(subject, done, ring, float(v["supply.pressure"]))
    if "rod_leakage" in done.computed.metrics:
        yield from _leak_at_rest(subject)
    for (place, case, stroke), table in subject.films.items():
        yield from _film(f"film of the {place} seals ({v.cases[case]}, {stroke})", table)


def _contact(subject: PreparedDesign, ring: Ring) -> Iterable[tuple[str, str]]:
    """Laws out of range, a compound that the fluid attacks, or a lost contact."""
    liquid, compound = subject.design.fluid.material, ring.element.compound
    if not ring.element.contact:
        for text in ring.element.seal_type.warnings(ring.sizes):
            yield "friction_running", f"{ring.label}: {text}"
    else:
        yield (
            "friction_running",
            f"{ring.label}: stated contact profiles are used unchanged, even if bore "
            "growth reduces the squeeze",
        )
    if compatible(subject.materials[liquid], subject.materials[compound]) is False:
        yield "", f"{ring.label}: {compound} does not withstand {liquid}"
    if np.any(np.real(ring["squeeze_left"]) <= 0):
        yield (
            "friction_running",
            f"{ring.label}: bore growth uses up the whole squeeze, there is no contact",
        )
    elif not np.all(np.real(seal_contact(ring).excess) > 0):
        yield (
            "friction_running",
            f"{ring.label}: the sealed pressure would open the contact; its contact load is "
            "too small",
        )


def _leak_at_rest(subject: PreparedDesign) -> Iterable[tuple[str, str]]:
    """The averaged film of a rod seal also leaks on the instroke."""
    if any(
        place == "rod" and not table.row.outward and table.flow > 0
        for (place, _, _), table in subject.films.items()
    ):
        yield (
            "rod_leakage",
            "the film of the rod seals also leaks on the instroke: an averaged film passes "
            "oil at any "
            "gap, even at rest, where a real elastomer seal is tight; rod_leakage is too high",
        )


def _film(name: str, table: Table) -> Iterable[tuple[str, str]]:
    """A surrogate with a large error, beyond its box, or with points without solution."""
    for what, metric in _SURROGATES.items():
        if table.errors[what] > FILM_ERROR:
            yield (
                metric,
                f"{name}: the surrogate's {what} is up to {100 * table.errors[what]:.1f} % from "
                "the solved films within the bounds",
            )
    if not table.surrogate.covers(table.row.inputs()):
        yield "friction_running", f"{name}: the design is outside the surrogate's box"
    if table.surrogate.failed:
        count = len(table.surrogate.failed)
        yield (
            "friction_running",
            f"{name}: {count} of its points have no solution ({table.surrogate.failed[0]})",
        )


def _limits(
    subject: PreparedDesign, done: ModelRun, ring: Ring, supply: float
) -> Iterable[tuple[str, str]]:
    """Pressure and speed beyond the limits of the compound, extrusion beyond its data."""
    compound = subject.materials[ring.element.compound]
    known = compound.numbers
    fastest = float(np.max(np.real(done.state.speed)))
    if not ring.element.back_ups and supply > known.get("pressure_max", np.inf):
        yield (
            "",
            f"{ring.label}: {supply / 1e5:.0f} bar, but {compound.name} allows "
            f"{known['pressure_max'] / 1e5:.0f} bar without a back-up ring",
        )
    if fastest > known.get("speed_max", np.inf):
        yield (
            "",
            f"{ring.label}: {fastest:.2g} m/s, but {compound.name} allows "
            f"{known['speed_max']:.2g} m/s",
        )
    end = extrusion_end(ring, subject.materials)
    if supply > end * (1 + 1e-9):
        yield (
            "extrusion_factor",
            f"{ring.label}: limits of the extrusion gap are known up to {end / 1e5:.0f} bar "
            "and assumed constant beyond; use a back-up ring",
        )


def models(
    rings: Iterable[Ring], subject: PreparedDesign, said: Iterable[str]
) -> Iterable[ModelUse]:
    """Models of all sealing rings; `said` are the texts of the warnings."""
    said = tuple(said)
    for ring in rings:
        doubted = any(text.startswith(ring.label) for text in said)
        yield _contact_model(ring, doubted=doubted)
    if subject.films:
        worst = max(table.errors["friction"] for table in subject.films.values())
        yield _use(
            rough_surface.asperity_pressure,
            "mean-film Reynolds equation with cavitation, rough and elastic contact; "
            f"surrogate within {100 * worst:.2g} %",
            doubted=worst > FILM_ERROR,
        )
    if any("extrusion_gap_max" not in subject.materials[r.element.compound].numbers for r in rings):
        yield _use(extrusion.extrusion_gap_limit, "gap over hardness and pressure", doubted=False)


def _contact_model(ring: Ring, *, doubted: bool) -> ModelUse:
    """Contact model of a ring, with its O-ring law if it has one."""
    element = ring.element
    at = f"squeeze {100 * element.squeeze:.4g} %"
    if element.contact:
        reach = element.contact[-1].pressure / 1e5
        return _use(
            contact_profile.table_profile,
            f"{ring.label}, stated profiles up to {reach:.0f} bar",
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
