"""One page from a record to the redesigned actuator: PDF and PNG."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..evaluation import prepare
from ..evaluation.study.bench import bench
from ..identification.calibration import Calibration
from ..optimisation.redesign import Redesign, solved
from ..version import VERSION
from . import calibration_rows as rows
from . import text, writer
from .blocks import Block, Cell, clean, column, notes, short, soft, table
from .calibration_figure import calibration_figure
from .identification_rows import samples_hash


def write_calibration_sheet(
    found: Calibration,
    changes: Redesign,
    *,
    folder: Path,
    stem: str,
    source_text: str,
    source_name: str,
    command: str,
    spec_hash: str,
    date: str | None = None,
) -> list[writer.ReportFile]:
    """Write the page of a calibration as ``STEM.pdf`` and ``STEM.png``.

    Parameters
    ----------
    found : what the record told
    changes : what that changes
    folder, stem : where to
    source_text, source_name : the design with the measured values: attached to the PDF
    command : the command line that made the page, printed and attached
    spec_hash : of that design
    date : ISO date to print, or None for none
    """
    data = calibration_page(
        found, changes, source_name=source_name, command=command, spec_hash=spec_hash, date=date
    )
    record = found.identification.record
    data |= {"title": changes.stands.name, "source": source_text}
    run = {
        "actuator_opt": VERSION,
        "command": command,
        "record": record.file_name,
        "record_sha256": samples_hash(record),
        "source_name": source_name,
        "spec_hash": spec_hash,
    }
    return writer.write_page(data, run, folder=folder, stem=stem, date=date)


def calibration_page(
    found: Calibration,
    changes: Redesign,
    *,
    source_name: str,
    command: str,
    spec_hash: str,
    date: str | None,
) -> dict[str, Any]:
    """The page as plain data for the renderers."""
    name = changes.stands.name
    measured = bench(prepare(changes.stands.design))
    points = found.identification.points
    return {
        "name": soft(name),
        "title": clean(name),
        "short": short(name, 32),
        "kind": "From test record to redesign",
        "version": VERSION,
        "hash": clean(spec_hash[:16]),
        "date": "" if date is None else clean(date),
        "source_name": soft(source_name),
        "command": soft(short(command, 260), 30),
        "verdict": verdict(changes),
        "sentence": soft(rows.what(found)),
        "tiles": _tiles(found, changes),
        "section": calibration_figure(points, found.identification.bench, measured, changes).data(),
        "scale": "",
        "items": [],
        "blocks": blocks(found, changes),
    }


def verdict(changes: Redesign) -> dict[str, Any]:
    """Whether a design with the measured values meets its requirements."""
    total = len(changes.stands.requirements)
    met = sum(row.met for row in changes.stands.requirements)
    lines = [f"as tested: {met} of {total} requirements met"]
    best = changes.best_after
    if best is None:
        state, words = ("met", "REQUIREMENTS MET") if changes.stands.met else ("missed", "MISSED")
    elif solved(best):
        state, words = "met", "REDESIGN MEETS ALL"
        lines.append("the best design meets every one")
    else:
        state, words = "infeasible", "INFEASIBLE AS MEASURED"
        lines.append("no design meets every one")
    return {"state": state, "text": words, "lines": lines}


def _tiles(found: Calibration, changes: Redesign) -> list[dict[str, Any]]:
    """Coulomb friction, what moved most, and the objective."""
    ratio = found.coulomb / found.stated
    own = found.identification
    tiles = [
        _tile("Coulomb friction measured", found.coulomb, "N", f"stated {found.stated:.4g} N"),
        _tile("measured over stated", ratio, "", "one factor for all seals"),
        _tile("largest friction recorded", own.largest, "N", "of the filtered record"),
    ]
    moved = changes.moved
    if moved is not None and moved.after.value is not None:
        quantity = text.metric(moved.after.metric)
        value = text.display(quantity, moved.after.value)
        limit = text.limit_text(quantity, moved.after.sense, moved.after.limit)
        words = moved.after.name.replace("_", " ")
        unit = text.unit_text(quantity.unit)
        note = f"was {text.value_text(quantity, moved.before.value)}, {limit}"
        tiles.append(
            _tile(short(words, 28), value, unit, note, "met" if moved.after.met else "missed")
        )
    before, after = changes.best_before, changes.best_after
    if before is not None and after is not None and solved(after):
        quantity = text.metric(after.objective_metric)
        value = text.display(quantity, after.objective_value)
        was = text.value_text(quantity, before.objective_value if solved(before) else None)
        unit = text.unit_text(quantity.unit)
        label = f"best {after.objective_metric.replace('_', ' ')}"
        tiles.append(_tile(short(label, 28), value, unit, f"was {was}"))
    return tiles


def _tile(
    label: str, value: float | None, unit: str, note: str, state: str = "none"
) -> dict[str, Any]:
    return {"label": label, "symbol": "", "value": text.number(value), "unit": unit, "note": note,
            "state": state}  # fmt: skip


def blocks(found: Calibration, changes: Redesign) -> list[Block]:
    """Numbers learned, requirements moved, the best design, and what it rests on."""
    parts = [_learned(found), _shifts(changes)]
    if lines := rows.optimum(changes):
        parts.append(_optimum(lines))
    return [*parts, notes("What changed, and what this rests on", rows.remarks(found, changes))]


def _learned(found: Calibration) -> Block:
    body: list[list[Cell]] = [
        [soft(line.cells[0], 60), *line.cells[1:]] for line in rows.learned(found)
    ]
    columns = [
        column(rows.LEARNED_HEADS[0], "left", 1.0, mono=True),
        *(column(head, "right", strong=head == "measured") for head in rows.LEARNED_HEADS[1:5]),
        column(rows.LEARNED_HEADS[5]),
    ]
    return table("Numbers the record gave, 95 % bounds", columns, body)


def _shifts(changes: Redesign) -> Block:
    body: list[list[Cell]] = []
    for line in rows.shifts(changes, moved=True):
        state: Cell = {"status": line.state, "text": line.cells[-1]}
        body.append([soft(line.cells[0], 60), *line.cells[1:-1], state])
    columns = [
        column(rows.SHIFT_HEADS[0], "left", 1.0, mono=True),
        *(column(head, "right", strong=head == "as measured") for head in rows.SHIFT_HEADS[1:6]),
        column(rows.SHIFT_HEADS[6]),
    ]
    still = sum(one.move == 0 for one in changes.shifts)
    note = f"{still} more do not depend on what was measured." if still else ""
    return table("Requirements of the actuator as tested that move", columns, body, note=note)


def _optimum(lines: list[rows.Line]) -> Block:
    """Objective and variables in two halves side by side."""
    columns = [
        column(rows.OPTIMUM_HEADS[0], "left", 1.0, mono=True),
        *(column(head, "right", strong=head == "as measured") for head in rows.OPTIMUM_HEADS[1:]),
    ]
    cells: list[list[Cell]] = [[soft(line.cells[0], 60), *line.cells[1:]] for line in lines]
    if len(cells) < 6:
        return table("The best design", columns, cells)
    half = (len(cells) + 1) // 2
    sides = [
        [table(title, columns, part)]
        for title, part in (
            ("The best design", cells[:half]),
            ("The best design, continued", cells[half:]),
        )
    ]
    return {"kind": "pair", "title": "", "sides": sides, "note": ""}
