"""One page from a record to the redesigned actuator: PDF and PNG."""

from __future__ import annotations

from pathlib import Path

from ..evaluation.reserve import count_words
from ..identification.calibration import Calibration
from ..optimisation.redesign import Redesign, solved
from ..rendering import paper as writer, text
from ..rendering.blocks import (
    Block,
    Cell,
    Column,
    Notes,
    Page,
    Pair,
    State,
    Status,
    Table,
    Tile,
    Verdict,
    short,
    soft,
    tile,
)
from ..rendering.origin import Origin
from ..studies.bench import Bench
from . import calibration_rows as rows
from .calibration_figure import calibration_figure
from .identification_rows import force, samples_hash
from .report import doubts


def write_calibration_sheet(
    found: Calibration,
    changes: Redesign,
    measured: Bench,
    origin: Origin,
    *,
    folder: Path,
    stem: str,
) -> list[writer.ReportFile]:
    """Write the page of a calibration as ``STEM.pdf`` and ``STEM.png``.

    Parameters
    ----------
    found : what the record told
    changes : what that changes
    measured : the design with the measured values
    origin : of the page; its source is the design with the measured values
    folder, stem : where to
    """
    record = found.identification.record
    return writer.write(
        calibration_page(found, changes, measured),
        origin,
        folder=folder,
        stem=stem,
        record=record.file_name,
        record_sha256=samples_hash(record),
    )


def calibration_page(found: Calibration, changes: Redesign, measured: Bench) -> Page:
    """The page of a calibration."""
    own = found.identification
    return Page(
        name=changes.evaluation.name,
        kind="From test record to redesign",
        verdict=verdict(changes),
        sentence=rows.what(found),
        tiles=_tiles(found, changes),
        hero=lambda room: calibration_figure(own.points, own.bench, measured, changes),
        blocks=blocks(found, changes),
    )


def verdict(changes: Redesign) -> Verdict:
    """Whether a design with the measured values meets its requirements."""
    total = len(changes.evaluation.requirements)
    met = sum(row.met for row in changes.evaluation.requirements)
    lines = [f"as tested: {met} of {total} requirements met"]
    best, count = changes.best_after, 0
    state: State
    if best is None:
        met = changes.evaluation.met
        state, words = "missed", "REQUIREMENTS MISSED"
        if met:
            state, words = "met", "REQUIREMENTS MET"
        count = len(changes.evaluation.tight) if met else 0
    elif solved(best):
        state, words = "met", "REDESIGN MEETS ALL"
        count = rows.tight(changes)
        lines.append("the best design meets every one")
    else:
        state, words = "infeasible", "INFEASIBLE AS MEASURED"
        lines.append("no design meets every one")
    if count:
        state, words = "checks", f"{words}, {count_words(count).upper()}"
    plain, cautions = doubts(changes.evaluation)
    return Verdict(state, words, lines + plain, cautions)


def _tiles(found: Calibration, changes: Redesign) -> list[Tile]:
    """Coulomb friction, what moved most, and the objective."""
    ratio = found.coulomb / found.stated
    own = found.identification
    tiles = [
        tile("Coulomb friction measured", force(found.coulomb), f"stated {force(found.stated)}"),
        tile("measured over stated", text.number(ratio), "one factor for all seals"),
        tile("largest friction recorded", force(own.largest), "of the filtered record"),
    ]
    moved = changes.moved
    if moved is not None and moved.after.value is not None:
        quantity = text.metric(moved.after.metric)
        value = text.value_text(quantity, moved.after.value)
        limit = text.limit_text(quantity, moved.after.sense, moved.after.limit)
        words = moved.after.name.replace("_", " ")
        note = f"was {text.value_text(quantity, moved.before.value)}, {limit}"
        state: State = "met" if moved.after.met else "missed"
        tiles.append(tile(short(words, 28), value, note, state))
    for one in changes.goals[:1]:
        if one.after is not None:
            value, was = (text.value_text(one.quantity, v) for v in (one.after, one.before))
            label = f"best {one.metric.replace('_', ' ')}"
            tiles.append(tile(short(label, 28), value, f"was {was}"))
    return tiles


def blocks(found: Calibration, changes: Redesign) -> list[Block]:
    """Numbers learned, requirements moved, the best design, and what it rests on."""
    parts = [_learned(found), _shifts(changes)]
    if lines := rows.optimum(changes):
        parts.append(_optimum(lines))
    return [*parts, Notes("What changed, and what this rests on", rows.remarks(found, changes))]


def _learned(found: Calibration) -> Block:
    body: list[list[Cell]] = [
        [soft(line.cells[0], 60), *line.cells[1:]] for line in rows.learned(found)
    ]
    columns = [
        Column(rows.LEARNED_HEADS[0], "left", 1.0, mono=True),
        *(Column(head, "right", strong=head == "measured") for head in rows.LEARNED_HEADS[1:5]),
        Column(rows.LEARNED_HEADS[5]),
    ]
    return Table("Numbers the record gave, 95 % bounds", columns, body)


def _shifts(changes: Redesign) -> Block:
    body: list[list[Cell]] = []
    for line in rows.shifts(changes, moved=True):
        state: Cell = Status(line.state, line.cells[-1])
        body.append([soft(line.cells[0], 60), *line.cells[1:-1], state])
    columns = [
        Column(rows.SHIFT_HEADS[0], "left", 1.0, mono=True),
        *(Column(head, "right", strong=head == "as measured") for head in rows.SHIFT_HEADS[1:6]),
        Column(rows.SHIFT_HEADS[6]),
    ]
    still = sum(one.move == 0 for one in changes.shifts)
    note = f"{still} more do not depend on what was measured." if still else ""
    return Table("Requirements of the actuator as tested that move", columns, body, note=note)


def _optimum(lines: list[rows.Line]) -> Block:
    """Objective and variables in two halves side by side."""
    columns = [
        Column(rows.OPTIMUM_HEADS[0], "left", 1.0, mono=True),
        *(Column(head, "right", strong=head == "as measured") for head in rows.OPTIMUM_HEADS[1:]),
    ]
    cells: list[list[Cell]] = [[soft(line.cells[0], 60), *line.cells[1:]] for line in lines]
    if len(cells) < 6:
        return Table("The best design", columns, cells)
    half = (len(cells) + 1) // 2
    sides = [
        [Table(title, columns, part)]
        for title, part in (
            ("The best design", cells[:half]),
            ("The best design, continued", cells[half:]),
        )
    ]
    return Pair(sides)
