"""One page about scatter as a document of its own: PDF and PNG."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..evaluation.reserve import count_words, without_reserve
from ..rendering import paper as writer, text
from ..rendering.blocks import Block, Cell, column, figure, notes, short, soft, table
from ..rendering.origin import Origin, tile
from ..uncertainties.result import Uncertainty
from . import uncertainty_rows as rows
from .uncertainty_figures import margins_figure, tornado

KIND = "Yield from scatter and tolerances"


def write_uncertainty_sheet(
    found: Uncertainty, origin: Origin, *, folder: Path, stem: str
) -> list[writer.ReportFile]:
    """Write the page of a yield as ``STEM.pdf`` and ``STEM.png``.

    Parameters
    ----------
    found : what scatter does
    origin : of the page
    folder, stem : where to
    """
    return writer.write_page(
        document(found, origin), origin, title=found.name, folder=folder, stem=stem
    )


def document(found: Uncertainty, origin: Origin) -> dict[str, Any]:
    """The page as plain data for the renderers."""
    return origin.heading(name=found.name, kind=KIND) | {
        "verdict": verdict(found),
        "sentence": soft(text.pretty(rows.what(found))),
        "tiles": _tiles(found),
        "section": margins_figure(found).data(),
        "scale": "",
        "items": [],
        "blocks": list(_blocks(found)),
    }


def verdict(found: Uncertainty) -> dict[str, Any]:
    """Whether the design as it stands meets its requirements, and how many do."""
    met = sum(one.margin is not None and one.margin >= -1e-6 for one in found.required)
    state, words = ("met", "MET AS IT STANDS") if found.met else ("missed", "MISSED AS IT STANDS")
    tight = sum(
        one.margin is not None and without_reserve(one.margin, one.limit) for one in found.required
    )
    if found.met and tight:
        state, words = "checks", f"{words}, {count_words(tight).upper()}"
    lines = [
        f"as it stands: {met} of {len(found.required)} requirements met",
        f"yield {rows.percent(found.rate.value)}",
    ]
    return {"state": state, "text": words, "lines": lines}


def _tiles(found: Uncertainty) -> list[dict[str, Any]]:
    """Yield, yield with the check list, draws, what fails most, what is behind it."""
    tiles = [
        tile("yield", rows.percent(found.rate.value), f"95 %: {rows.between(found.rate)}"),
        tile(
            "with the check list",
            rows.percent(found.rate_checks.value),
            f"95 %: {rows.between(found.rate_checks)}",
        ),
        tile("inputs that scatter", str(len(found.inputs)), "listed below"),
    ]
    if found.required:
        worst = found.required[0]
        note = f"holds in {rows.percent(worst.rate.value)}"
        metric = text.metric(worst.metric)
        margin = text.margin_of(metric, worst.limit, worst.margin)
        tiles.append(tile(short(worst.name.replace("_", " "), 28), margin, note))
        ranked = found.of_output(worst.name)[0]
        if ranked and ranked[0].total is not None:
            share = f"{100 * ranked[0].total:.0f} % of its variance"
            name = short(ranked[0].path.rpartition(".")[2].replace("_", " "), 28)
            tiles.append(tile("what scatters it most", share, name))
    return tiles


def _blocks(found: Uncertainty) -> Iterator[Block]:
    for checks, name in ((False, "Requirements over the draws"), (True, "Checks that fail")):
        lines = rows.limits(found, checks=checks)
        if lines:
            yield _limits(name, lines)
    for output in rows.followed(found):
        ink = tornado(found, output)
        if ink is not None:
            note = (
                "Bars: this input alone at its 95 % and 5 % point. Alone: share of the variance by "
                "this input; with others: with what it does together with others."
            )
            yield figure(rows.heading(found, output), ink, note)
    yield _inputs(found)
    yield notes("What the yield means", rows.remarks(found))


def _limits(name: str, lines: list[rows.Line]) -> Block:
    heads = rows.LIMIT_HEADS
    columns = [
        column(heads[0], "left", 1.0, mono=True),
        *(column(head, "right", strong=head == "holds") for head in heads[1:]),
    ]
    body: list[list[Cell]] = [[soft(x.cells[0], 60), *x.cells[1:]] for x in lines]
    return table(name, columns, body)


def _inputs(found: Uncertainty) -> Block:
    heads = rows.INPUT_HEADS
    columns = [
        column(heads[0], "left", 1.3, mono=True),
        *(column(head, "right") for head in heads[1:4]),
        column(heads[4]),
        column(heads[5], "left", 1.2),
    ]
    body: list[list[Cell]] = [
        [soft(x.cells[0], 30), *x.cells[1:5], soft(x.cells[5], 30)] for x in rows.inputs(found)
    ]
    return table("What scatters", columns, body)
