"""One page about a Simulation as a document of its own: PDF and PNG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..rendering import paper as writer
from ..rendering.blocks import Block, Cell, clean, column, notes, short, soft, status, table
from ..rendering.ink import text_width
from ..rendering.origin import Origin
from ..rendering.paper_plain import joined, wrap
from ..simulation.result import Simulation
from . import simulation_rows as rows
from .simulation_figures import LEAST, MOST, simulation_figure
from .simulation_series import Measured
from .simulation_stiffness import Static
from .simulation_words import tied, what

SHEET, TILES, FOOT, HEAD = 265.0, 23.0, 24.5, 8.2
"""Heights inside the margins of the sheet, of the key figures, of the title block, and of the title
of a block [mm]."""
HALF, FULL = 86.0, 172.0
"""Width of words in half a sheet and in a whole one [mm]."""
BRIEF = 900
"""Letters of the notes that stand beside a table (a choice: a quarter of the sheet)."""
KIND = "Simulation in time"


def write_simulation_sheet(
    simulation: Simulation,
    origin: Origin,
    *,
    folder: Path,
    stem: str,
    notes: Sequence[str] = (),
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> list[writer.ReportFile]:
    """Write the page of a simulation as ``STEM.pdf`` and ``STEM.png``; parameters as `document`.

    Parameters
    ----------
    folder, stem : where to
    """
    data = document(simulation, origin, notes=notes, measured=measured, static=static, extra=extra)
    return writer.write_page(
        data, origin, title=simulation.scenario.name, folder=folder, stem=stem,
        scenario_hash=simulation.spec_hash,
    )  # fmt: skip


def document(
    simulation: Simulation,
    origin: Origin,
    *,
    notes: Sequence[str] = (),
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> dict[str, Any]:
    """The page as plain data for the renderers.

    Parameters
    ----------
    simulation : what happened
    origin : of the page
    notes : what else a reader should know
    measured : time [s] and values (SI) by the name of a signal, drawn under it
    static : positions [m] and static stiffness [N/m], drawn beside the dynamic one
    extra : blocks below all others
    """
    below = blocks(simulation, notes)
    words = tied(what(simulation))
    left = room(simulation.scenario.name, words, [*below, *extra])
    if left < LEAST:  # what the caller adds goes on to the next sheet
        left = room(simulation.scenario.name, words, below)
    drawing = simulation_figure(
        simulation, min(max(left, LEAST), MOST), measured=measured, static=static
    )
    return headed(simulation.scenario.name, simulation.plant.design.name, origin, KIND) | {
        "verdict": rows.verdict(simulation),
        "sentence": soft(words),
        "tiles": rows.tiles(simulation),
        "section": drawing.data(),
        "scale": "",
        "items": [],
        "blocks": [*below, *extra],
    }


def headed(name: str, design: str, origin: Origin, kind: str) -> dict[str, Any]:
    """What a page begins with; its title block names the design."""
    return origin.heading(name=name, kind=kind) | {"short": short(design, 32)}


# ---- blocks ----


def blocks(found: Simulation, more: Sequence[str] = ()) -> list[Block]:
    """Results and controller side by side, then how far to trust them."""
    said = [
        f"{rows.balance_words(found)} {rows.second_words(found)} {rows.event_words(found)}"
        f" {rows.run_words(found)}",
        *rows.remarks(found, more),
    ]
    trust = notes("What this rests on", [tied(one) for one in said])
    made = [one for one in (_results(found), _controller(found)) if one is not None]
    if len(made) == 2:
        return [_pair(*made), trust]
    if made and sum(map(len, said)) < BRIEF:
        return [_pair(made[0], trust)]
    return [*made, trust]


def _pair(left: Block, right: Block) -> Block:
    return {"kind": "pair", "title": "", "sides": [[left], [right]], "note": ""}


def _results(found: Simulation) -> Block | None:
    shown = rows.results(found)
    if not shown:
        return None
    limited = any(one.row is not None for one in shown)
    columns = [column("result", "left", 1.0), column("value", "right", strong=True)]
    body: list[list[Cell]] = [[one.label, one.words] for one in shown]
    if limited:
        columns += [column("limit", "right"), column("margin", "right"), column("")]
        for cells, one in zip(body, shown, strict=True):
            state: Cell = "" if one.row is None else status(one.state)
            cells += [one.limit, one.margin, state]
    said = [f"{', '.join(names)}: {why}" for why, names in rows.reasons(found).items()]
    note = f"No value: {'; '.join(said)}." if said else ""
    return table("Results", columns, body, note=clean(note))


def _controller(found: Simulation) -> Block | None:
    shown = rows.controller(found)
    if not shown:
        return None
    body: list[list[Cell]] = [[words, soft(value)] for words, value in shown]
    note = "Margins of the linear loop without sticking friction, at its worst place and direction."
    columns = [column("controller", "left"), column("", "left", 1.0)]
    return table("Controller and its margins", columns, body, note=note)


# ---- room ----


def room(name: str, what: str, below: Sequence[Block]) -> float:
    """Height left for the figure on one sheet, by the widths of the words [mm]."""
    head = 6.0 + (8.0 if len(name) <= 28 else 6.0 * math.ceil(len(name) / 45))
    head += 3.1 * len(wrap(what, 112.0, 7.5))
    return SHEET - max(head, 17.0) - TILES - FOOT - sum(height(block) for block in below)


def height(block: Block, width: float = FULL) -> float:
    """Height of a block on paper, a little more than less [mm]."""
    if block["kind"] == "pair":
        return max(sum(height(one, HALF) for one in side) for side in block["sides"])
    note = 2.75 * len(wrap(block["note"], width, 6.2)) + 1.2 if block["note"] else 0.0
    if block["kind"] == "table":
        return HEAD + note + 3.6 * sum(_lines(block, width))
    if block["kind"] == "figure":
        return HEAD + note + float(block["ink"]["height"]) + 3.0
    words = [joined(item) for item in block.get("items") or block.get("lines") or ()]
    return HEAD + 1.5 + note + sum(3.2 * len(wrap(one, width, 7.0)) + 0.5 for one in words)


def _lines(block: Block, width: float) -> list[float]:
    """Lines of every row and of the heads: the widest columns share what the others leave."""
    columns, body = block["columns"], block["rows"]
    wides = []
    for k, one in enumerate(columns):
        bold = bool(one.get("strong"))
        words = [*one["head"].split("\n"), *(joined(row[k]) for row in body)]
        wides.append(max(text_width(word, 6.8, bold=bold) for word in words) + 2.2)
    spare = width - sum(wides)
    flexible = [k for k, one in enumerate(columns) if not isinstance(one["width"], str)] or [0]
    for k in flexible:
        wides[k] = max(wides[k] + min(spare, 0.0) / len(flexible), 10.0)
    heads = float(max(one["head"].count("\n") + 1 for one in columns))
    found = [heads]
    for row in body:
        counts = [
            len(wrap(joined(cell), wide - 2.0, 6.8)) for cell, wide in zip(row, wides, strict=True)
        ]
        found.append(1.0 + 0.72 * (max(counts) - 1))
    return found
