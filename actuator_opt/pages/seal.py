"""The page of a seal study: gland, squeeze, operating point, contact, oil film, and losses."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from ..design.seals import SealElement
from ..evaluation.sealing import closed_form
from ..metrics import METRICS
from ..rendering.blocks import (
    Block,
    Chart,
    Column,
    Drawing,
    Notes,
    Page,
    Row,
    Table,
    Tile,
    Verdict,
    tile,
)
from ..rendering.series import Series
from ..rendering.text import DASH, bars, degrees, number, speed_words, trimmed, value_text
from ..studies.seal import HARDNESS_SCATTER, STATED_FACTOR, FilmMap, RingPoint, SealPoint, SealStudy
from . import seal_figures as figures
from .seal_sections import (
    filled_grooves,
    gland_drawing,
    stress_figure,
    stroke_names,
    tolerance_text,
)

SPEEDS = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)
"""Speeds at which the terminal shows friction and damping [m/s]."""


def page(study: SealStudy) -> Page:
    """A separate page for the seals of the piston or of the rod."""
    gland = gland_drawing(study)
    return Page(
        name=study.design.name,
        kind=f"Seal sheet: {study.place}",
        verdict=_verdict(study),
        sentence=why(study) or leakage(study),
        tiles=_tiles(study),
        hero=lambda room: gland.ink,
        scale=gland.scale,
        blocks=_blocks(study, strokes(study)),
    )


def blocks(study: SealStudy) -> list[Block]:
    """Blocks on the seals of piston or rod, with their gland, for the report of a design."""
    note = (
        "Dashed: sections of the rings before assembly. Long lands between grooves are drawn "
        "shortened."
    )
    if study.place == "piston":
        note += " The bore is drawn at its size without pressure."
    ink = gland_drawing(study).ink
    sentences = [strokes(study), why(study), leakage(study)]
    return [
        Drawing(f"{_seals(study)}: gland", ink, note),
        *_blocks(study, " ".join(words for words in sentences if words)),
    ]


def series(film_map: FilmMap) -> list[Series]:
    """A friction map as columns, a row per pressure and speed; cells without oil film are empty."""
    speeds, pressures = film_map.speeds.tolist(), film_map.pressures.tolist()
    return [
        Series("sealed pressure [bar]", [p / 1e5 for p in pressures for _ in speeds], 6),
        Series("speed [m/s]", speeds * len(pressures), 6),
        Series("friction [N]", film_map.friction.ravel().tolist(), 6),
        Series("secant damping [N s/m]", film_map.damping.ravel().tolist(), 6),
    ]


def _seals(study: SealStudy) -> str:
    return f"{study.place.capitalize()} seals"


def _verdict(study: SealStudy) -> Verdict:
    count = len(study.drive.rings)
    rings = "one ring" if count == 1 else f"{count} rings"
    lines = [f"{rings}, {' and '.join(stroke_names(study))}", f"at {operating_point(study)}"]
    if study.converged:
        return Verdict("met", "FILM FOUND", lines)
    return Verdict("missed", "NO FILM", lines)


def _tiles(study: SealStudy) -> list[Tile]:
    """Friction, damping, breakaway and leakage at the operating point."""
    point, (driven, _), at = study.drive, stroke_names(study), f"at {operating_point(study)}"
    tiles = [
        tile(f"friction, {driven}", _force(point.friction), at),
        tile(f"secant damping, {driven}", _damping(point.damping), at),
        tile("breakaway, dry", _force(point.breakaway), f"at {bars(point.pressure)}"),
    ]
    if not study.converged:
        return tiles
    oil = study.double_stroke
    if oil is None:
        flow = _flow(point.flow)
        tiles.append(tile(f"flow across, {driven}", flow, "towards the outer side"))
    else:
        tiles.append(tile("leakage per double stroke", _volume(oil.net), at))
    thinnest = min(float(ring.film.min()) for ring in point.rings)
    film = f"{number(1e6 * thinnest, 3)} µm"
    return [*tiles, tile(f"thinnest film, {driven}", film, "between the mean planes")]


def _blocks(study: SealStudy, sentences: str) -> list[Block]:
    """Tables and figures of a seal study; `sentences` are printed below the operating point."""
    shown: list[Block] = [
        _gland(study), _squeeze(study), _operating(study, sentences), _contact(study)
    ]  # fmt: skip
    if study.elements:
        shown += _elements(study)
    if study.converged:
        shown += [_film(study, index) for index in range(len(study.drive.rings))]
    if study.curves is not None and figures.drawable(study.curves):
        shown.append(_speeds(study, study.curves))
    if study.map is not None and figures.drawable(study.map):
        shown.append(_map(study, study.map))
    return [*shown, Notes(f"{_seals(study)}: how far to trust this", notes(study))]


# ---- gland and squeeze ----


def _gland(study: SealStudy) -> Table:
    columns = [
        Column("place", "left", 1.2, breaks=14, wraps=True, least=10),
        Column("type", "left", 1.2, breaks=14, wraps=True, least=8, drop=3),
        Column("material", "left", 1.2, breaks=14, wraps=True, drop=2),
        Column("section", "right", breaks=14),
        Column("squeeze", "right", breaks=14),
        Column("gland depth", "right", breaks=14, drop=4),
        Column("groove width", "right", breaks=14, drop=5),
        Column("ring", "right", breaks=14, drop=1),
    ]
    growth = ""
    if study.growth > 0:
        growth = f", plus {number(1e3 * study.growth, 3)} by which pressure widens the bore"
    note = (
        "In mm. Gland depth: from the counterface to the floor of the groove, with both tolerances;"
        f" ring: axial × radial size. Radial gap {trimmed(1e3 * study.clearance)}{growth}."
    )
    return Table(f"{_seals(study)}: sizes", columns, gland_rows(study), note=note)


def gland_rows(study: SealStudy) -> list[tuple[str, ...]]:
    """Sizes of every groove and ring with their tolerances, mm."""
    rows: list[tuple[str, ...]] = []
    for filled in filled_grooves(study.design, study.place):
        groove, element, width = filled.groove, filled.element, trimmed(1e3 * filled.width)
        if element is None:
            material = (groove.place, groove.role, groove.material, DASH, DASH)
            ring = trimmed(1e3 * float(groove.ring_width))
            rows.append((*material, trimmed(1e3 * filled.depth), width, ring))
            continue
        rows.append(
            (
                groove.place,
                element.type.replace("_", " "),
                element.compound,
                tolerance_text(element.section, element.section_tolerance),
                f"{trimmed(100 * element.squeeze)} %",
                tolerance_text(filled.depth, element.tolerance),
                width,
                _ring_size(element),
            )
        )
    return rows


def _ring_size(element: SealElement) -> str:
    """Axial and radial size of a ring that is not round, and its back-up rings."""
    sizes = element.stated_sizes()
    words = trimmed(1e3 * sizes["width"]) if "width" in sizes else "round"
    if "thickness" in sizes:
        words += f" × {trimmed(1e3 * sizes['thickness'])}"
    if element.back_ups and element.back_up_thickness is not None:
        words += f" + {element.back_ups} × {trimmed(1e3 * element.back_up_thickness)} back-up"
    return words


def _squeeze(study: SealStudy) -> Drawing:
    note = (
        "Bars: from the loosest to the tightest squeeze that the tolerances of ring and gland "
        "allow, with rod and bore concentric; line: nominal squeeze. Stretching thins the section; "
        "this is included in the loosest and the nominal squeeze, but not in the tightest. Ring "
        "and housing expand with heat, each by its own coefficient if the compound states one. "
        "Pressure widens the bore around the piston."
    )
    if any(row.loosest <= 0 for row in study.squeezes):
        note += " Red: the ring loses contact."
    title = f"{_seals(study)}: squeeze"
    columns = [
        Column("ring", width=1.0, wraps=True, least=8),
        Column("at", "right", style="dim"),
        Column("pressure", "right", style="dim"),
        Column("loosest", "right", style="state"),
        Column("nominal", "right", drop=1),
        Column("tightest", "right"),
    ]
    rows = []
    for row in study.squeezes:
        shares = [f"{number(100 * x, 3)} %" for x in (row.loosest, row.nominal, row.tightest)]
        cells = (row.label, degrees(row.temperature), bars(row.pressure), *shares)
        rows.append(Row(cells, "missed" if row.loosest <= 0 else ""))
    limits = [f"{sense} {trimmed(100 * level)} %" for sense, level in figures.squeeze_limits(study)]
    required = (
        f"Loosest and tightest: within the tolerances. Required: {', '.join(limits)}"
        if limits
        else ""
    )
    table = Table(
        title, columns, rows, note=required or "Loosest and tightest: within the tolerances."
    )
    return Drawing(title, figures.squeeze_figure(study), note, instead=table)


# ---- operating point ----


def operating_point(study: SealStudy) -> str:
    """The operating point in words: pressure, speed and temperature."""
    point = study.drive
    return f"{bars(point.pressure)}, {speed_words(point.speed)}, {degrees(point.temperature)}"


def _operating(study: SealStudy, sentences: str) -> Table:
    columns = [Column("quantity", "left", 1.6, wraps=True, least=10)]
    columns += [Column(name, "right", 1.0, wraps=True, least=9) for name in stroke_names(study)]
    note = (
        f"{sentences} Negative flows and volumes: oil returns to the sealed side. Residuals are "
        "relative errors of the solution."
    )
    title = f"{_seals(study)}: at {operating_point(study)}"
    return Table(title, columns, operating_rows(study), note=note)


def operating_rows(study: SealStudy) -> list[tuple[str, str, str]]:
    """Quantities with their values on the driven stroke and on the return stroke."""

    def row(name: str, words: Callable[[SealPoint], str]) -> tuple[str, str, str]:
        return name, words(study.drive), words(study.other)

    rows = [
        row("friction, film", lambda point: _force(point.friction)),
        row("part by oil shear", lambda point: _force(point.viscous)),
        row("part by asperities", lambda point: _force(point.asperity)),
        row("friction, range due to scatter of moduli", _scatter),
        row("friction by friction coefficient", lambda p: _force(p.coefficient_friction)),
        row("breakaway, dry", lambda point: _force(point.breakaway)),
        row("secant damping at this speed", lambda point: _damping(point.damping)),
        row("flow towards the outer side", lambda point: _flow(point.flow)),
    ]
    if len(study.drive.rings) > 1:
        rows.append(row("pressure between the rings, gauge", _between))
    if oil := study.double_stroke:
        rows.append(
            ("oil carried out per stroke", _volume(oil.carried_out), _volume(-oil.drawn_back))
        )
    return [
        *rows,
        row("load residual", lambda point: _residual([x.load_residual for x in point.rings])),
        row("mass residual", lambda point: _residual([x.mass_residual for x in point.rings])),
    ]


def _force(value: float) -> str:
    """A force in N; a dash without an oil film.

    >>> _force(119.93), _force(float("nan"))
    ('119.9 N', '–')
    """
    return value_text(METRICS["friction_running"], None if math.isnan(value) else value)


def _damping(value: float) -> str:
    """A secant damping in kN s/m."""
    return value_text(METRICS["damping_seal"], None if math.isnan(value) else value)


def _volume(value: float) -> str:
    """A volume in mm³; a dash without an oil film."""
    return DASH if math.isnan(value) else f"{number(1e9 * value)} mm³"


def _flow(value: float) -> str:
    """A flow in mm³/s; a dash without an oil film."""
    return DASH if math.isnan(value) else f"{number(1e9 * value)} mm³/s"


def _residual(values: Sequence[float]) -> str:
    known = [abs(value) for value in values if not math.isnan(value)]
    return number(max(known), 1) if known else DASH


def _scatter(point: SealPoint) -> str:
    """Least and greatest friction within the scatter of the moduli; a dash without an oil film."""
    known = sorted(value for value in (point.lower, point.upper) if not math.isnan(value))
    return f"{number(known[0])} to {_force(known[-1])}" if known else DASH


def _between(point: SealPoint) -> str:
    known = None if math.isnan(point.between) else point.between
    return value_text(METRICS["inter_seal_pressure"], known)


# ---- contact and film ----


def _contact(study: SealStudy) -> Table:
    columns = [
        Column("ring", "left", 1.0, breaks=14, wraps=True, least=8),
        Column("stroke", "left", breaks=14, drop=1),
        Column("pressure across", "right", breaks=14),
        Column("line load", "right", breaks=14),
        Column("width", "right", breaks=14, drop=2),
        Column("peak", "right", breaks=14, drop=3),
        Column("modulus, MPa", "right", breaks=14, drop=4),
        Column("contact model", "left", 1.4, breaks=14, wraps=True, drop=5),
    ]
    note = (
        "Static contact. Line load: force per length of circumference. Peak: highest contact "
        "pressure, relative to the pressure on the outer side. Modulus: lowest, assumed and "
        "highest value for the squeezed part."
    )
    return Table(f"{_seals(study)}: contact", columns, contact_rows(study), note=note)


def contact_rows(study: SealStudy) -> list[tuple[str, ...]]:
    """Contact of every ring; both strokes are listed if the pressure differs between them."""
    rows: list[tuple[str, ...]] = []
    names = ("out", "in") if study.place == "rod" else stroke_names(study)
    for index, points in enumerate(zip(study.drive.rings, study.other.rings, strict=True)):
        driven, other = points
        apart = driven.ring["pressure"] != other.ring["pressure"]
        by_stroke = zip(names, points, strict=True) if apart else (("both", driven),)
        for stroke, point in by_stroke:
            rows.append(
                (
                    point.ring.label,
                    stroke,
                    bars(float(f"{point.ring['pressure']:.4g}")),
                    f"{number(1e-3 * float(point.contact.line_load))} N/mm",
                    f"{number(1e3 * float(point.contact.width))} mm",
                    f"{number(1e-6 * float(point.contact.peak))} MPa",
                    _modulus(point),
                    _contact_model(point) if index or not study.elements else "finite elements",
                )
            )
    return rows


def _contact_model(point: RingPoint) -> str:
    """The model that the contact of a ring is computed with."""
    element = point.ring.element
    if element.contact:
        return "stated profiles"
    return element.seal_type.contact_model.format(law=element.law.replace("_", " "))


def _modulus(point: RingPoint) -> str:
    """Lowest, assumed and highest modulus in MPa."""
    low, value, high = (number(1e-6 * x, 3) for x in point.modulus)
    return f"{low} {DASH} {value} {DASH} {high}"


def _film(study: SealStudy, index: int) -> Chart:
    label = study.drive.rings[index].ring.label
    note = (
        f"At {operating_point(study)}. Static: contact pressure without oil. In motion, oil and "
        "asperities together carry this load. Film: distance between the mean planes of the two "
        "rough surfaces."
    )
    title = f"{label.capitalize()}: contact pressure and oil film"
    return Chart(title, figures.contact_panels(study, index), note, height=54.0)


# ---- finite elements ----


def _elements(study: SealStudy) -> list[Block]:
    label = study.drive.rings[0].ring.label.capitalize()
    title = f"{label}: contact by finite elements"
    columns = [
        Column("pressure", "right"),
        Column("width", "right"),
        Column("closed form", "right"),
        Column("peak", "right"),
        Column("closed form", "right"),
        Column("von Mises", "right", drop=1),
    ]
    table = Table(title, columns, _element_rows(study), note=elements_sentence(study))
    stress = stress_figure(study)
    note = f"{elements_sentence(study)} {contact_note(study)}"
    return [
        Drawing(f"{label}: stress by finite elements", stress, stress_note(study)),
        Chart(title, figures.elements_panels(study), note, instead=table, height=115.0),
    ]


def _element_rows(study: SealStudy) -> list[tuple[str, ...]]:
    """Contact of the first ring at every pressure by finite elements and by the closed form."""
    ring, rows = study.out.rings[0].ring, []
    for contact in study.elements:
        law = closed_form(ring.at(pressure=contact.pressure))
        lengths = (f"{number(1e3 * float(x), 3)} mm" for x in (contact.width, law.width))
        stresses = (contact.peak_pressure, law.peak, contact.field.von_mises.max())
        peaks = (f"{number(1e-6 * float(x), 3)} MPa" for x in stresses)
        rows.append((bars(contact.pressure), *lengths, *peaks))
    return rows


def elements_sentence(study: SealStudy) -> str:
    """Sentence that compares contact width and peak pressure by finite elements and closed form.

    The sentence is for the operating point; it is empty without finite elements.
    """
    if not study.elements:
        return ""
    point = study.out.rings[0]
    law = closed_form(point.ring)
    pressure = float(f"{abs(point.ring['pressure']):.4g}")

    def beside(value: Any, other: Any, unit: str, scale: float) -> str:
        own, closed = (number(scale * float(x), 3) for x in (value, other))
        return f"{own} {unit} (closed form {closed})"

    return (
        f"Contact of the {point.ring.label} by finite elements at {bars(pressure)}: width"
        f" {beside(point.contact.width, law.width, 'mm', 1e3)}, peak"
        f" {beside(point.contact.peak, law.peak, 'MPa', 1e-6)}."
    )


def stress_note(study: SealStudy) -> str:
    """Note on what the stress sections show, and on their limitations."""
    words = "Deformed shape to scale, sealed side on the left; red: contact. "
    if study.out.rings[0].ring.element.back_ups:
        words += "The back-up rings are not drawn; the groove shown is the space beside them. "
    return (
        f"{words}Stresses drawn are averages at the corners of the elements; the highest stress "
        "stated is the mean of one element. Assumptions: rigid walls with closed corners, no "
        "friction, no creep, no yielding."
    )


def contact_note(study: SealStudy) -> str:
    """Note on the limitations of the contact curves."""
    words = (
        "Pressures are relative to the outer side. Neither finite elements nor closed form include "
        "the growth of the bore. Values by finite elements are interpolated linearly between "
        "the computed points and pressures."
    )
    elements = study.out.rings[0].ring.element.seal_type.elements
    return words if elements is None else f"{words} {elements.note}"


# ---- friction and damping over speed ----


def _speeds(study: SealStudy, curves: FilmMap) -> Chart:
    point, note = study.drive, ""
    if point.converged:
        note = (
            f"At {operating_point(study)}, friction is {_force(point.friction)} (with the "
            f"scatter of the moduli: {_scatter(point)}). Secant damping is "
            f"{_damping(point.damping)}, which applies to this speed only. "
        )
    note += (
        f"Computed by a friction coefficient, friction is {_force(point.coefficient_friction)};"
        f" breakaway takes {_force(point.breakaway)}.{missing(curves)}"
    )
    title = f"{_seals(study)}: friction and damping over speed"
    table = _speed_table(study, curves)
    return Chart(title, figures.speed_panels(study, curves), note, instead=table, height=64.0)


def _speed_table(study: SealStudy, curves: FilmMap) -> Table:
    """Friction and damping at a few speeds."""
    pressures = [bars(float(pressure)) for pressure in curves.pressures]
    columns = [Column("speed", "right")]
    columns += [Column(f"F, {pressure}", "right") for pressure in pressures]
    columns += [Column(f"B, {pressure}", "right", drop=1) for pressure in pressures]
    rows = []
    for k in sorted({int(abs(curves.speeds - speed).argmin()) for speed in SPEEDS}):
        forces = [_force(float(row[k])) for row in curves.friction]
        dampings = [_damping(float(row[k])) for row in curves.damping]
        rows.append((speed_words(float(curves.speeds[k])), *forces, *dampings))
    driven = stroke_names(study)[0]
    title = f"{_seals(study)}: friction F and damping B over speed, {driven}"
    return Table(title, columns, rows, note=missing(curves).strip())


def _map(study: SealStudy, film_map: FilmMap) -> Chart:
    driven = stroke_names(study)[0].capitalize()
    note = f"{driven}.{missing(film_map)}"
    if film_map.why:
        note += " Hatched: unknown, as neighbouring points have no film."
    title = f"{_seals(study)}: friction and damping over speed and pressure"
    return Chart(title, figures.map_panels(study, film_map), note, height=62.0)


def missing(film_map: FilmMap) -> str:
    """Sentence on points of a map without an oil film, with reasons; empty if there are none."""
    if not film_map.why:
        return ""
    reasons: dict[str, int] = {}
    for _, _, reason in film_map.why:
        plain = reason.partition(":")[0].rstrip(".")
        plain = " ".join("…" if _is_number(word) else word for word in plain.split())
        reasons[plain] = reasons.get(plain, 0) + 1
    counted = "; ".join(f"{count} × {reason}" for reason, count in reasons.items())
    points = f"{len(film_map.why)} of {film_map.friction.size} points"
    return f" Not drawn, because no film was computed: {points} ({counted})."


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


# ---- sentences ----


def why(study: SealStudy) -> str:
    """Reason for a missing oil film at the operating point; empty if both strokes have a film."""
    names = stroke_names(study)
    if study.place == "rod":
        names = (f"on the {names[0]}", f"on the {names[1]}")
    parts = [
        f"No oil film {name}: {point.why.rstrip('.')}."
        for name, point in zip(names, (study.drive, study.other), strict=True)
        if point.why
    ]
    return " ".join(parts)


def strokes(study: SealStudy) -> str:
    """Sentences on the two strokes of a piston, and on the pressure that is sealed."""
    pressure = f"The seal seals {bars(study.drive.pressure)}"
    if study.place == "rod":
        return f"{pressure} above atmospheric pressure."
    return (
        "Driven: the oil pressure moves the piston. Overrun: a load moves the piston against "
        f"the sealed pressure. {pressure} above the {bars(study.outer_pressure)} of the other "
        "chamber."
    )


def leakage(study: SealStudy) -> str:
    """Sentence on leakage: per double stroke of a rod, or across a piston.

    Empty without an oil film.
    """
    if not study.converged:
        return ""
    point, oil = study.drive, study.double_stroke
    pressure, speed = bars(point.pressure), speed_words(point.speed)
    if oil is None:
        return (
            f"Leakage across the piston seal at {pressure} and {speed}. Driven: "
            f"{_across(point.flow, 'the chamber of higher pressure')}. Overrun: "
            f"{_across(study.other.flow, 'that chamber')}."
        )
    back = oil.drawn_back
    inwards = f"draws {_volume(back)} back" if back >= 0 else f"leaks {_volume(-back)} more"
    return (
        f"Over {trimmed(1e3 * study.stroke)} mm of stroke, the outstroke carries "
        f"{_volume(oil.carried_out)} of oil past the seal and the instroke {inwards}, both at "
        f"{pressure} and {speed}. A double stroke leaves {_volume(oil.net)} outside."
    )


def _across(value: float, chamber: str) -> str:
    return f"{_flow(abs(value))} {'out of' if value >= 0 else 'back into'} {chamber}"


def notes(study: SealStudy) -> list[str]:
    """Notes on the models and inputs used, and on their limitations."""
    scatter = f"hardness ±{trimmed(HARDNESS_SCATTER)} Shore A"
    if any("hardness" not in point.ring.numbers for point in study.drive.rings):
        scatter += f", a stated modulus × or ÷ {trimmed(STATED_FACTOR)}"
    frictions = sorted({point.ring["asperity_friction"] for point in study.drive.rings})
    words = [
        "Model: static contact, oil film with cavitation between two rough planes, asperity "
        "contact, leakage. Input: sizes, modulus or hardness, oil, and roughness and asperities "
        "of the surfaces.",
        "Density, radius and friction coefficient of the asperities "
        f"({' and '.join(trimmed(friction) for friction in frictions)}) are orders of magnitude "
        "from the literature for the compound, not measurements of this seal. The asperity part "
        "of the friction is proportional to this coefficient, and so is the total friction if "
        "asperities cause nearly all of it.",
        "The film model lets some oil pass even at rest, where a real elastomer seal does not "
        "leak: its averaged flow factors do not include the contact pressure at which the last "
        "leakage path closes. Near standstill, the model overstates the leakage.",
        f"Scatter of the moduli: {scatter}, the same for all rings; oil and surfaces as stated.",
        (
            "Breakaway assumes that all oil is squeezed out: friction coefficient of the "
            "asperities times the whole contact force."
        ),
        "Secant damping is friction divided by speed. It is valid only at the stated speed and "
        "amplitude, and falls as 1/v where friction hardly depends on speed. It is not the "
        "damping by the oil.",
    ]
    lugre = study.lugre
    if lugre is not None:
        words.append(
            "LuGre parameters for a simulation of this seal: bristle stiffness "
            f"{number(lugre.stiffness / 1e6, 3)} N/µm (breakaway over "
            f"{trimmed(1e3 * study.design.stiffness.seal_deflection)} mm), damping "
            f"{number(lugre.damping / 1e3, 3)} kN·s/m (square root of stiffness times load "
            "mass). With them, the LuGre model cannot create energy up to "
            f"{number(1e3 * lugre.passive_speed, 3)} mm/s; above this speed, reduce the damping "
            "gradually with speed."
        )
    return words
