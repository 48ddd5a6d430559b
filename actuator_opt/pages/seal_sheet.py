"""The blocks of a seal sheet: gland, squeeze, contact, film, friction, leakage and damping."""

from __future__ import annotations

from collections.abc import Sequence

from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Drawing, Notes, Table, soft
from ..studies.seal import SealStudy
from . import seal_rows as rows
from .seal_elements_figure import (
    contact_figure as elements_contact_figure,
    contact_note,
    sentence,
    stress_figure,
    stress_note,
)
from .seal_figures import contact_figure, drawable, speed_figure, squeeze_figure, stroke_names
from .seal_gland_figure import gland_drawing
from .seal_map_figure import map_figure


def sheets(studies: Sequence[SealStudy]) -> list[Block]:
    """Every block of the sheets of some places, for a report."""
    return [block for study in studies for block in blocks(study)]


def blocks(study: SealStudy, *, drawing: bool = True) -> list[Block]:
    """The blocks of one place; `drawing`: the gland too."""
    found: list[Block] = []
    if drawing:
        ink = gland_drawing(study).ink
        found.append(Drawing(f"{_named(study)}: gland", ink, _gland_note(study)))
    found += [_gland_table(study), _squeeze(study), _operating(study), _contact_table(study)]
    if study.elements:
        found += _elements(study)
    if study.converged:
        found += [_contact(study, index) for index in range(len(study.drive.rings))]
    if drawable(study.curves):
        found.append(_speeds(study))
    if drawable(study.map):
        found.append(_map(study))
    found.append(Notes(f"{_named(study)}: how far to trust this", rows.notes(study)))
    return found


def _named(study: SealStudy) -> str:
    return f"{study.place.capitalize()} seals"


def _gland_note(study: SealStudy) -> str:
    said = "Dashed: free sections. Lands between grooves are cut where they are long."
    if study.place == "piston":
        said += " The bore is drawn at its size without pressure."
    return said


def _gland_table(study: SealStudy) -> Block:
    columns = [
        Column(head, "left" if k < 3 else "right", 1.2 if k < 3 else "auto")
        for k, head in enumerate(rows.GLAND_HEADS)
    ]
    body: list[list[Cell]] = [[soft(cell) for cell in row] for row in rows.gland(study)]
    growth = ""
    if study.growth > 0:
        growth = f", and {text.number(1e3 * study.growth, 3)} more by the bore's growth at pressure"
    note = (
        "mm; gland depth from the counterface to the groove's floor, with the tolerance of both;"
        f" ring: axial × radial. Radial gap {text.trimmed(1e3 * study.clearance)}{growth}."
    )
    return Table(f"{_named(study)}: sizes", columns, body, note=note)


def _squeeze(study: SealStudy) -> Block:
    note = (
        "Bars from loosest to tightest over the tolerances of ring and gland, rod and bore"
        " concentric; line: nominal. Loosest and nominal with the section as thin as its"
        " stretch makes it, tightest with the bare section. Ring and housing swell with heat at"
        " their own rates, where the compound states its; pressure widens the bore around the"
        " piston."
    )
    if any(row.loosest <= 0 for row in study.squeezes):
        note += " Red: the ring loses contact."
    return Drawing(f"{_named(study)}: squeeze", squeeze_figure(study), note)


def _operating(study: SealStudy) -> Block:
    columns = [Column("quantity", "left", 1.6)]
    columns += [Column(name, "right", 1.0) for name in stroke_names(study)]
    body: list[list[Cell]] = [[one.name, one.drive, one.other] for one in rows.operating(study)]
    said = (rows.strokes(study), rows.why(study), rows.leakage(study))
    note = " ".join(words for words in said if words)
    note += (
        " Flow and oil are negative where they return to the sealed side; residuals are relative."
    )
    return Table(f"{_named(study)}: at {rows.at(study)}", columns, body, note=note.strip())


def _contact_table(study: SealStudy) -> Block:
    columns = [
        Column(head, "right" if 2 <= k < 7 else "left", {0: 1.0, 7: 1.4}.get(k, "auto"))
        for k, head in enumerate(rows.CONTACT_HEADS)
    ]
    body: list[list[Cell]] = [[soft(cell) for cell in row] for row in rows.contacts(study)]
    note = (
        "Static contact. Line load per length of circumference, peak above the outer side;"
        " modulus of what is squeezed: lowest, assumed and highest over its scatter."
    )
    return Table(f"{_named(study)}: contact", columns, body, note=note)


def _elements(study: SealStudy) -> list[Block]:
    label = study.drive.rings[0].ring.label.capitalize()
    return [
        Drawing(f"{label}: stress by finite elements", stress_figure(study), stress_note(study)),
        Drawing(
            f"{label}: contact by finite elements",
            elements_contact_figure(study),
            f"{sentence(study)} {contact_note(study)}",
        ),
    ]


def _contact(study: SealStudy, index: int) -> Block:
    label = study.drive.rings[index].ring.label
    note = (
        f"At {rows.at(study)}. Static: the contact without oil; oil and asperities share it. The"
        " film is the distance of the mean planes of both rough surfaces."
    )
    title = f"{label.capitalize()}: contact pressure and oil film"
    return Drawing(title, contact_figure(study, index), note)


def _speeds(study: SealStudy) -> Block:
    point = study.drive
    said = ""
    if point.converged:
        said = (
            f"At {rows.at(study)} friction is {rows.force(point.friction)} (moduli's scatter:"
            f" {rows.band(point)}) and secant damping"
            f" {rows.damping(point.damping)}: at this speed only. "
        )
    said += (
        f"By the coefficient of friction it is {rows.force(point.coefficient_friction)};"
        f" breakaway {rows.force(point.breakaway)}."
    )
    assert study.curves is not None
    title = f"{_named(study)}: friction and damping over speed"
    return Drawing(title, speed_figure(study), said + rows.missing(study.curves))


def _map(study: SealStudy) -> Block:
    assert study.map is not None
    driven = stroke_names(study)[0].capitalize()
    note = f"{driven}; circle: the operating point, where it lies in the map."
    note += rows.missing(study.map)
    if study.map.why:
        note += " Crosses: points without a film; hatched: not known between them."
    title = f"{_named(study)}: friction and damping over speed and pressure"
    return Drawing(title, map_figure(study), note)
