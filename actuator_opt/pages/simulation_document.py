"""One page about a Simulation as a document of its own: PDF and PNG."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..rendering import paper as writer
from ..rendering.blocks import Block, Cell, Column, Notes, Page, Pair, Status, Table, clean, soft
from ..rendering.origin import Origin
from ..simulation.result import Simulation
from . import simulation_rows as rows
from .simulation_figures import LEAST, MOST, simulation_figure
from .simulation_series import Measured
from .simulation_stiffness import Static
from .simulation_words import tied, what

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
    """Write the page of a simulation as PDF and PNG; parameters as `simulation_page`.

    Parameters
    ----------
    folder, stem : where to
    """
    page = simulation_page(simulation, notes=notes, measured=measured, static=static, extra=extra)
    return writer.write(page, origin, folder=folder, stem=stem, scenario_hash=simulation.spec_hash)


def simulation_page(
    simulation: Simulation,
    *,
    notes: Sequence[str] = (),
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> Page:
    """The page of a simulation.

    Parameters
    ----------
    simulation : what happened
    notes : what else a reader should know
    measured : time [s] and values (SI) by the name of a signal, drawn under it
    static : positions [m] and static stiffness [N/m], drawn beside the dynamic one
    extra : blocks below all others
    """
    return Page(
        name=simulation.scenario.name,
        kind=KIND,
        design=simulation.plant.design.name,
        verdict=rows.verdict(simulation),
        sentence=tied(what(simulation)),
        tiles=rows.tiles(simulation),
        hero=lambda room: simulation_figure(
            simulation, min(room, MOST), measured=measured, static=static
        ),
        least=LEAST,
        blocks=[*blocks(simulation, notes), *extra],
    )


# ---- blocks ----


def blocks(found: Simulation, more: Sequence[str] = ()) -> list[Block]:
    """Results and controller side by side, then how far to trust them."""
    said = [
        f"{rows.balance_words(found)} {rows.second_words(found)} {rows.event_words(found)}"
        f" {rows.run_words(found)}",
        *rows.remarks(found, more),
    ]
    trust = Notes("What this rests on", [tied(one) for one in said])
    made = [one for one in (_results(found), _controller(found)) if one is not None]
    if len(made) == 2:
        return [_pair(*made), trust]
    if made and sum(map(len, said)) < BRIEF:
        return [_pair(made[0], trust)]
    return [*made, trust]


def _pair(left: Block, right: Block) -> Block:
    return Pair([[left], [right]])


def _results(found: Simulation) -> Block | None:
    shown = rows.results(found)
    if not shown:
        return None
    limited = any(one.row is not None for one in shown)
    columns = [Column("result", "left", 1.0), Column("value", "right", strong=True)]
    body: list[list[Cell]] = [[one.label, one.words] for one in shown]
    if limited:
        columns += [Column("limit", "right"), Column("margin", "right"), Column("")]
        for cells, one in zip(body, shown, strict=True):
            state: Cell = "" if one.row is None else Status(one.state)
            cells += [one.limit, one.margin, state]
    said = [f"{', '.join(names)}: {why}" for why, names in rows.reasons(found).items()]
    note = f"No value: {'; '.join(said)}." if said else ""
    return Table("Results", columns, body, note=clean(note))


def _controller(found: Simulation) -> Block | None:
    shown = rows.controller(found)
    if not shown:
        return None
    body: list[list[Cell]] = [[words, soft(value)] for words, value in shown]
    note = "Margins of the linear loop without sticking friction, at its worst place and direction."
    columns = [Column("controller", "left"), Column("", "left", 1.0)]
    return Table("Controller and its margins", columns, body, note=note)
