"""The seal sheet as a document of its own: PDF and PNG of one place."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..base.files import write_text
from ..rendering import paper as writer, text
from ..rendering.blocks import Page, Tile, Verdict, tile
from ..rendering.origin import Origin
from ..studies.seal import FilmMap, SealStudy
from . import seal_rows as rows
from .seal_figures import bars, stroke_names
from .seal_gland_figure import gland_drawing
from .seal_sheet import blocks


def write_sheet(
    study: SealStudy,
    origin: Origin,
    *,
    folder: Path,
    stem: str,
) -> list[writer.ReportFile]:
    """Write the sheet of one place as ``STEM.pdf`` and ``STEM.png`` (first sheet, then more).

    Parameters
    ----------
    study : of piston or rod
    origin : of the page
    folder, stem : where to
    """
    return writer.write(sheet_page(study), origin, folder=folder, stem=stem)


def sheet_page(study: SealStudy) -> Page:
    """The sheet of one place."""
    gland = gland_drawing(study)
    return Page(
        name=study.design.name,
        kind=f"Seal sheet: {study.place}",
        verdict=_verdict(study),
        sentence=_sentence(study),
        tiles=_tiles(study),
        hero=lambda room: gland.ink,
        scale=gland.scale,
        blocks=blocks(study, drawing=False),
    )


def _verdict(study: SealStudy) -> Verdict:
    found = study.converged
    count = len(study.drive.rings)
    rings = "one ring" if count == 1 else f"{count} rings"
    lines = [f"{rings}, {' and '.join(stroke_names(study))}", f"at {rows.at(study)}"]
    return Verdict("met", "FILM FOUND", lines) if found else Verdict("missed", "NO FILM", lines)


def _sentence(study: SealStudy) -> str:
    return rows.why(study) or rows.leakage(study)


def _tiles(study: SealStudy) -> list[Tile]:
    """Friction, damping, breakaway and leakage at the operating point."""
    point, (driven, _), at = study.drive, stroke_names(study), f"at {rows.at(study)}"
    found = [
        (f"friction, {driven}", rows.force(point.friction), at),
        (f"secant damping, {driven}", rows.damping(point.damping), at),
        ("breakaway, dry", rows.force(point.breakaway), f"at {bars(point.pressure)}"),
    ]
    if study.converged:
        oil = study.double_stroke
        found.append(
            (f"flow across, {driven}", rows.flow(point.flow), "towards the outer side")
            if oil is None
            else ("left by a double stroke", rows.volume(oil.net), at)
        )
        thinnest = min(float(ring.film.min()) for ring in point.rings)
        found.append((f"thinnest film, {driven}", _microns(thinnest), "between the mean planes"))
    return [tile(label, words, note) for label, words, note in found]


def _microns(value: float) -> str:
    return f"{text.number(1e6 * value, 3)} µm"


def write_map(found: FilmMap, path: Path) -> writer.ReportFile:
    """Write a map as CSV: one line per point, empty where there is no film."""
    lines = ["sealed pressure [bar],speed [m/s],friction [N],secant damping [N s/m]"]
    for pressure, friction, damping in zip(
        found.pressures, found.friction, found.damping, strict=True
    ):
        for speed, force, secant in zip(found.speeds, friction, damping, strict=True):
            numbers = (pressure / 1e5, speed, force, secant)
            lines.append(",".join("" if x != x else f"{x:.6g}" for x in numbers))
    text = "\n".join(lines) + "\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text)
    return writer.ReportFile(path, hashlib.sha256(text.encode()).hexdigest(), 1)
