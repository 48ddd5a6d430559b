"""One page about an Identification as a document of its own: PDF and PNG."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..identification.result import Identification
from ..rendering import paper as writer
from ..rendering.blocks import (
    Block,
    Cell,
    Column,
    Notes,
    Page,
    Pair,
    Status,
    Table,
    Tile,
    soft,
    tile,
)
from ..rendering.heights import HALF, height
from ..rendering.origin import Origin
from ..rendering.text import DASH, number
from . import identification_rows as rows
from .identification_figures import LEAST, MOST, identification_figure


def write_identification_sheet(
    identification: Identification, origin: Origin, *, folder: Path, stem: str
) -> list[writer.ReportFile]:
    """Write the page of an identification as ``STEM.pdf`` and ``STEM.png``.

    The record is not attached: its name, size and the hash of its samples are printed.

    Parameters
    ----------
    identification : what a record told
    origin : of the page
    folder, stem : where to
    """
    record = identification.record
    return writer.write(
        identification_page(identification),
        origin,
        folder=folder,
        stem=stem,
        record=record.file_name,
        record_sha256=rows.samples_hash(record),
    )


def identification_page(found: Identification) -> Page:
    """The page of an identification."""
    return Page(
        name=found.bench.design.name,
        kind="Friction and damping by a test record",
        verdict=rows.verdict(found),
        sentence=rows.what(found),
        tiles=_tiles(found),
        hero=lambda room: identification_figure(found, min(room, MOST)),
        least=LEAST,
        blocks=blocks(found),
    )


def _tiles(found: Identification) -> list[Tile]:
    """Friction, its pressure, Coulomb friction and the friction coefficient."""
    mean, mu = found.mean, found.coefficient
    largest = f"{rows.pressure(found.largest / found.area)} of the maximum"
    tiles = [
        (
            rows.mean_label(found).replace("mean", "mean friction", 1),
            rows.force(mean.value),
            f"95 %: {rows.bounds(mean.lower, mean.upper, rows.FORCE)}",
        ),
        ("maximum friction", rows.force(found.largest), "of the filtered record"),
        ("equivalent pressure loss", rows.pressure(mean.value / found.area), largest),
    ]
    model = next((m for m in (found.stribeck, found.lugre) if not isinstance(m, str)), None)
    one = None if model is None else model.parameters.get("coulomb")
    if one is None:
        tiles.append(("Coulomb friction", DASH, "no model"))
    else:
        said = f"95 %: {rows.bounds(one.lower, one.upper, rows.FORCE)}"
        tiles.append(("Coulomb friction", rows.force(one.value), said))
    if isinstance(mu, str):
        tiles.append(("friction coefficient", DASH, "none, see below"))
    else:
        said = f"contact pressure {number(mu.contact_pressure / 1e6, 3)} MPa"
        tiles.append(("friction coefficient", number(mu.value, 3), said))
    return [tile(label, words, note) for label, words, note in tiles]


# ---- blocks ----


def blocks(found: Identification) -> list[Block]:
    """Parameters with their verdicts, channels, and how far to trust all this."""
    sides = [[*_stribeck(found), *_fits(found)], _lugre(found)]
    shorter = min(sides, key=lambda side: sum(height(one, HALF) for one in side))
    shorter.append(_channels(found))
    said = [rows.coefficient_words(found.coefficient), rows.conditioning(found)]
    said += [" ".join(lines) for lines in (rows.doubts(found), rows.remarks(found)) if lines]
    said.append(rows.record_words(found))
    pair: Block = Pair(sides)
    return [pair, Notes("What this rests on", said)]


def _stribeck(found: Identification) -> list[Block]:
    fit = found.stribeck
    if isinstance(fit, str):
        return []
    said = rows.held(fit.held)
    if "pressure_slope" in fit.parameters:
        said += f" F_C and F_S at {rows.pressure(fit.reference_pressure)}."
    return [_parameters("Stribeck curve", rows.parameter_rows(fit.parameters), said.strip())]


def _lugre(found: Identification) -> list[Block]:
    fit = found.lugre
    if isinstance(fit, str):
        return []
    said = f"Scatter of the windows about the model {rows.force(fit.misfit)}. {rows.held(fit.held)}"
    return [_parameters("LuGre model", rows.parameter_rows(fit.parameters), said.strip())]


def _fits(found: Identification) -> list[Block]:
    shown = rows.fit_rows(found.fits)
    if not shown:
        return []
    return [_parameters("Secant damping", shown, rows.fit_note(found.fits))]


def _parameters(title: str, shown: Sequence[rows.Row], note: str) -> Block:
    columns = [
        Column("parameter", "left", 1.0),
        Column(""),
        Column("value", "right", strong=True),
        Column("lower", "right"),
        Column("upper", "right"),
        Column("identifiable"),
    ]
    body: list[list[Cell]] = [
        [
            one.label,
            one.symbol,
            one.value,
            one.lower,
            one.upper,
            Status(rows.STATES[one.verdict], one.verdict),
        ]
        for one in shown
    ]
    return Table(f"{title}, 95 % bounds", columns, body, note=note)


def _channels(found: Identification) -> Block:
    columns = [
        Column(head, "left" if k == 0 else "right", 1.0 if k == 0 else "auto")
        for k, head in enumerate(rows.CHANNEL_HEADS)
    ]
    body: list[list[Cell]] = [[soft(cell) for cell in row] for row in rows.channel_rows(found)]
    return Table("Channels of the record", columns, body)
