"""One page about a Pareto front: PDF and PNG, and its figure as files of its own."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..base.files import write_all
from ..evaluation.reserve import count_words
from ..optimisation.pareto_result import ParetoFront
from ..rendering import paper as writer, text
from ..rendering.blocks import Block, Cell, Column, Notes, Page, Table, Tile, Verdict, short, tile
from ..rendering.image import images
from ..rendering.origin import Origin
from . import pareto_rows as rows
from .pareto_figure import front_figure
from .report import doubts

FEWER = 17
"""Designs on the page of three or more objectives, whose heads and roles take more lines."""


def write_front_sheet(
    found: ParetoFront, origin: Origin, *, folder: Path, stem: str
) -> list[writer.ReportFile]:
    """Write ``STEM.pdf``, ``STEM.png``, ``STEM_figure.png`` and ``STEM_figure.svg``.

    Parameters
    ----------
    found : the front
    origin : of the page
    folder, stem : where to
    """
    files = writer.write(
        front_page(found), origin, folder=folder, stem=stem, result=rows.front_outcome(found)
    )
    pictures = images(front_figure(found), f"{stem}_figure")
    write_all(folder, pictures)
    return files + [
        writer.ReportFile(folder / name, hashlib.sha256(content).hexdigest(), 1)
        for name, content in pictures.items()
    ]


def front_page(found: ParetoFront) -> Page:
    """The page of a Pareto front."""
    return Page(
        name=found.subject.name,
        kind="Pareto front",
        verdict=_verdict(found),
        sentence=text.pretty(found.sentence),
        tiles=_tiles(found),
        hero=lambda room: front_figure(found),
        blocks=_blocks(found),
    )


def _verdict(found: ParetoFront) -> Verdict:
    lines = [f"{len(found.points)} designs", "none dominated, every requirement met"]
    tight = len(found.evaluation.tight)
    plain, cautions = doubts(found.evaluation)
    if tight:
        cautions.insert(0, f"{rows.evaluated(found)}: {count_words(tight)}")
    lines += plain
    return Verdict("checks" if tight else "met", "PARETO FRONT", lines, cautions)


def _tiles(found: ParetoFront) -> list[Tile]:
    """The range of every objective, and its value at the knee."""
    tiles = []
    for one in found.objectives:
        values = [point.metrics[one.metric] for point in found.points]
        best, worst = (min, max) if one.sense == "min" else (max, min)
        note = f"to {text.value_text(one.quantity, worst(values))}"
        if found.knee is not None:
            at = found.points[found.knee.index].metrics[one.metric]
            note += f", knee {text.value_text(one.quantity, at)}"
        label = short(f"best {one.metric.replace('_', ' ')}", 28)
        tiles.append(tile(label, text.value_text(one.quantity, best(values)), note))
    return tiles


def _blocks(found: ParetoFront) -> list[Block]:
    kept = rows.shown(found, rows.SHOWN if len(found.objectives) == 2 else FEWER)
    by_name = {one.name: one for one in rows.series(found)}
    wanted = [*(one.metric for one in found.objectives), *rows.moving(found, 5)]
    heads = [f"{name}, {by_name[name].unit}".rstrip(", ") for name in wanted]
    heads = [head.replace(".", ". ").replace("_", " ") for head in heads]
    cells = {name: by_name[name].cells() for name in wanted}
    body: list[list[Cell]] = [
        [str(k + 1), *(cells[name][k] for name in wanted), rows.role(found, k)] for k in kept
    ]
    columns = [
        Column("design", "right"),
        *(Column(head, "right", 1.0) for head in heads),
        Column("", "left", 1.2),
    ]
    more = len(found.points) - len(kept)
    note = f"{more} more designs between these." if more else ""
    return [
        Table("Designs of the front", columns, body, note=note),
        Notes("How far to trust it", [text.pretty(line) for line in rows.remarks(found)]),
    ]
