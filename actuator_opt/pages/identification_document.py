"""One page about an Identification as a document of its own: PDF and PNG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..identification.result import Identification
from ..rendering import paper as writer
from ..rendering.blocks import Block, Cell, column, notes, soft, table
from ..rendering.ink import text_width
from ..rendering.origin import Origin, tile
from ..rendering.paper_plain import joined, wrap
from ..rendering.text import DASH, number
from . import identification_rows as rows
from .identification_figures import LEAST, MOST, identification_figure

_SHEET, _TILES, _FOOT, _HEAD = 265.0, 23.0, 24.5, 8.2
"""Heights inside the margins of the sheet, of the key figures, of the title block, and of the title
of a block [mm]."""
_HALF, _FULL = 86.0, 172.0
"""Width of words in half a sheet and in a whole one [mm]."""


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
    return writer.write_page(
        identification_page(identification, origin),
        origin,
        title=identification.bench.design.name,
        folder=folder,
        stem=stem,
        record=record.file_name,
        record_sha256=rows.samples_hash(record),
    )


def identification_page(found: Identification, origin: Origin) -> dict[str, Any]:
    """The page as plain data for the renderers."""
    below = blocks(found)
    name = found.bench.design.name
    heading = origin.heading(name=name, kind="Friction and damping by a test record")
    return heading | {
        "verdict": rows.verdict(found),
        "sentence": soft(rows.what(found)),
        "tiles": _tiles(found),
        "section": identification_figure(found, _room(found, below)).data(),
        "scale": "",
        "items": [],
        "blocks": below,
    }


def _tiles(found: Identification) -> list[dict[str, Any]]:
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
    shorter = min(sides, key=lambda side: sum(_height(one, _HALF) for one in side))
    shorter.append(_channels(found))
    said = [rows.coefficient_words(found.coefficient), rows.conditioning(found)]
    said += [" ".join(lines) for lines in (rows.doubts(found), rows.remarks(found)) if lines]
    said.append(rows.record_words(found))
    pair: Block = {"kind": "pair", "title": "", "sides": sides, "note": ""}
    return [pair, notes("What this rests on", said)]


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
        column("parameter", "left", 1.0),
        column(""),
        column("value", "right", strong=True),
        column("lower", "right"),
        column("upper", "right"),
        column("identifiable"),
    ]
    body: list[list[Cell]] = [
        [
            one.label,
            one.symbol,
            one.value,
            one.lower,
            one.upper,
            {"status": rows.STATES[one.verdict], "text": one.verdict},
        ]
        for one in shown
    ]
    return table(f"{title}, 95 % bounds", columns, body, note=note)


def _channels(found: Identification) -> Block:
    columns = [
        column(head, "left" if k == 0 else "right", 1.0 if k == 0 else "auto")
        for k, head in enumerate(rows.CHANNEL_HEADS)
    ]
    body: list[list[Cell]] = [[soft(cell) for cell in row] for row in rows.channel_rows(found)]
    return table("Channels of the record", columns, body)


# ---- room ----


def _room(found: Identification, below: Sequence[Block]) -> float:
    """Height left for the figure on one sheet, by the widths of the words [mm]."""
    name = len(found.bench.design.name)
    head = 6.0 + (8.0 if name <= 28 else 6.0 * math.ceil(name / 45))
    head += 3.1 * len(wrap(rows.what(found), 112.0, 7.5))
    used = max(head, 17.0) + _TILES + _FOOT + sum(_height(block) for block in below)
    return min(max(_SHEET - used, LEAST), MOST)


def _height(block: Block, width: float = _FULL) -> float:
    """Height of a block on paper, a little more than less [mm]."""
    if block["kind"] == "pair":
        return max(sum(_height(one, _HALF) for one in side) for side in block["sides"])
    note = 2.75 * len(wrap(block["note"], width, 6.2)) + 1.2 if block["note"] else 0.0
    if block["kind"] == "table":
        lines = _lines(block, width)
        return _HEAD + 3.55 * (len(lines) + 1) + 2.2 * sum(n - 1 for n in lines) + note
    words = [joined(item) for item in block["items"]]
    return _HEAD + 1.5 + sum(3.2 * len(wrap(one, width, 7.0)) + 0.5 for one in words)


def _lines(block: Block, width: float) -> list[int]:
    """Lines of the first cell of every row, in the room that the other columns leave."""
    room = width - 2.0
    for k, one in enumerate(block["columns"][1:], 1):
        words = [one["head"], *(joined(row[k]) for row in block["rows"])]
        bold = bool(one.get("strong"))
        room -= max(text_width(word, 6.8, bold=bold) for word in words) + 2.0
    return [len(wrap(joined(row[0]), max(room, 10.0), 6.8)) for row in block["rows"]]
