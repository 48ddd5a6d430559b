"""What stands on the report: an Evaluation or an Optimisation as plain data for the renderers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..base.quantities import Quantity
from ..evaluation.reserve import count_words
from ..evaluation.result import Evaluation, Requirement
from ..metrics.table import ROWS
from ..optimisation.result import Optimisation
from ..rendering import text
from ..rendering.blocks import (
    Block,
    Notes,
    Page,
    State,
    Tile,
    Verdict,
)
from ..rendering.origin import Origin
from ..rendering.paper import ReportFile, write
from ..studies.seal import SealStudy
from . import (
    choices_table,
    dynamics_page,
    infeasibility_card,
    optimum,
    prices,
    seal,
    stiffness_page,
    tables,
    trust,
    wall,
    whole_plies,
)
from .drawing import section

KEY_FIGURES = (
    "mass",
    "stiffness_min",
    "push_force",
    "friction_running",
    "natural_frequency",
    "burst_factor",
    "buckling_factor",
    "pull_force",
    "closed_length",
)
"""Five of these, in this order, after the objective; one without a value is passed over."""

_SHORT_OF = ("missed", "infeasible")
"""States in which an optimum has not the yield asked for."""
_MET = ("met", "checks")
"""States in which every requirement is met: green, and amber."""


def parts_of(subject: Evaluation | Optimisation) -> tuple[Evaluation, Optimisation | None]:
    """The evaluation to show and, if there is one, the optimisation it came from.

    Of an optimisation with sizes that is the design of these sizes: it is the one to build.
    """
    if isinstance(subject, Optimisation):
        return subject.best_evaluation, subject
    return subject, None


def sentences(optimisation: Optimisation) -> list[str]:
    """Which design is shown where sizes are asked for, what came out, what to do about it."""
    said, rounding = [optimisation.shown], optimisation.rounding
    if rounding is None or rounding.design is not None:
        said.append(optimisation.sentence)
    if optimisation.robust is not None:
        said.append(optimisation.robust.sentence)
    said.append(optimisation.remedy or ("" if rounding is None else rounding.remedy))
    return [text.pretty(optimum.sentence(part)) for part in said if part]


def reserve_sentences(subject: Evaluation | Optimisation) -> list[str]:
    """Limits without reserve and the yield, where requirements are met and nothing said it."""
    evaluation, optimisation = parts_of(subject)
    told = optimisation is not None and optimisation.robust is not None
    if told or verdict(subject).state not in _MET:
        return []
    return [text.pretty(part) for part in evaluation.reserve_sentences]


def warnings(subject: Evaluation | Optimisation) -> list[str]:
    """What the evaluation warns of, then the optimiser."""
    evaluation, optimisation = parts_of(subject)
    return [*evaluation.warnings, *(() if optimisation is None else optimisation.warnings)]


def verdict(subject: Evaluation | Optimisation) -> Verdict:
    """The badge: state, words, how many rows and checks stand behind it, and what to doubt.

    `cautions` are lines in amber: limits without reserve, values nobody has verified, values
    outside a model's range.
    """
    evaluation, optimisation = parts_of(subject)
    missed = sum(not row.met for row in evaluation.requirements)
    failed = sum(check.status == "missed" for check in evaluation.checks)
    rounding = None if optimisation is None else optimisation.rounding
    robust = None if optimisation is None else optimisation.robust
    tight = len((optimisation or evaluation).tight)
    state: State
    none_made = rounding.name if rounding is not None and rounding.design is None else ""
    of = "continuous: " if none_made else f"{rounding.name}: " if rounding else ""
    if optimisation is not None and optimisation.infeasibility is not None:
        state, words = "infeasible", "INFEASIBLE"
    elif optimisation is not None and optimisation.status == "undefined":
        state, words = "missed", "NO USABLE ANSWER"
    elif none_made:
        state, words = "missed", f"NO DESIGN OF {none_made.upper()}"
    elif missed:
        state, words = "missed", "REQUIREMENTS MISSED"
    elif robust is not None and not robust.reached:
        state, words = "missed", "YIELD MISSED"
    elif failed:
        state, words = "checks", "REQUIREMENTS MET, CHECKS MISSED"
    elif tight:
        state, words = "checks", f"REQUIREMENTS MET, {count_words(tight).upper()}"
    else:
        state, words = "met", "REQUIREMENTS MET"
    counts = {
        name: sum(check.status == name for check in evaluation.checks)
        for name in ("met", "missed", "not_checked")
    }
    lines, cautions = doubts(evaluation)
    return Verdict(
        state,
        words,
        [
            f"{of}{evaluation.tally}{_misfit(optimisation)}"
            + (", without reserves for the yield" if robust and state in _SHORT_OF else ""),
            f"checks: {counts['met']} met · {counts['missed']} missed"
            f" · {counts['not_checked']} not checked",
            *lines,
        ],
        [
            *([count_words(tight)] if tight and failed and state == "checks" else []),
            *cautions,
        ],
    )


def doubts(evaluation: Evaluation) -> tuple[list[str], list[str]]:
    """Plain lines and cautions: values nobody has verified, results that are extrapolated."""
    counts = evaluation.counts
    results, models = counts["extrapolated"], counts["extrapolated_models"]
    words = f"{results} result{'' if results == 1 else 's'}"
    if models:
        words += f", {models} model{'' if models == 1 else 's'}"
    known = (
        (counts["unverified"], f"values not verified: {counts['unverified']}"),
        (results + models, f"EXTRAPOLATED: {words}"),
    )
    return [said for number, said in known if not number], [said for n, said in known if n]


def _misfit(optimisation: Optimisation | None) -> str:
    """The geometry that does not fit, where no limit need be missed for that."""
    why = None if optimisation is None else optimisation.infeasibility
    return f"; the geometry does not fit: {', '.join(why.laws)}" if why and why.laws else ""


def _tile_label(name: str, quantity: Quantity) -> str:
    """The words of a metric on a tile."""
    row = ROWS.get(name)
    return (row.short if row else "") or quantity.label


def key_figures(subject: Evaluation | Optimisation) -> list[Tile]:
    """Five numbers to remember, the objective first, each with its limit or where it came from."""
    evaluation, optimisation = parts_of(subject)
    first = () if optimisation is None else (optimisation.objective_metric,)
    names = [n for n in dict.fromkeys((*first, *KEY_FIGURES)) if n in evaluation.metrics]
    names = [n for n in names if evaluation.metrics[n].value is not None][:5]
    tiles = []
    for name in names:
        metric, quantity = evaluation.metrics[name], text.metric(name)
        row = _limited(evaluation, name)
        value, note = metric.value, f"case {metric.case}" if metric.case else ""
        state: State = ""
        before = _before(optimisation, name)
        if name in first and before is not None and metric.value is not None:
            change = text.number(100 * (metric.value / before[1] - 1), before[2], signed=True)
            note = f"{before[0]} {text.value_text(quantity, before[1])}, {change} %"
        elif row is not None and row.value is not None:
            value, state = row.value, "met" if row.met else "missed"
            limit = text.limit_text(quantity, row.sense, row.limit)
            note = f"{limit}, margin {text.margin_of(quantity, row.limit, row.margin, met=row.met)}"
        elif name == "mass" and metric.value is not None:
            oil = evaluation.metrics.get("mass_oil")
            if oil is not None and oil.value is not None:
                note = f"with oil {text.value_text(quantity, metric.value + oil.value)}"
        tiles.append(
            Tile(
                _tile_label(name, quantity),
                text.number(text.display(quantity, value)),
                text.unit_text(quantity.unit),
                note,
                state,
                quantity.symbol,
            )
        )
    return tiles


def _limited(evaluation: Evaluation, name: str) -> Requirement | None:
    """The limit on a metric with the smallest margin; one without a value comes last."""
    rows = [row for row in evaluation.requirements if row.metric == name]
    return min(rows, key=lambda r: math.inf if r.margin is None else r.margin, default=None)


def _before(optimisation: Optimisation | None, name: str) -> tuple[str, float, int] | None:
    """What a figure is compared with, and digits: the optimum before rounding, else the start."""
    if optimisation is None:
        return None
    words, origin, digits = "start", optimisation.start, 3
    if optimisation.made is not None:
        words, origin, digits = "continuous", optimisation.evaluation, 2
    found = origin.metrics.get(name)
    return None if found is None or not found.value else (words, found.value, digits)


def page(
    subject: Evaluation | Optimisation,
    *,
    extra_tables: Sequence[Block] = (),
    seals: Sequence[SealStudy] = (),
) -> Page:
    """The report of a design.

    Parameters
    ----------
    subject : what to report
    extra_tables : further tables and drawings, before the input listing
    seals : the seals of piston or rod to show on a sheet
    """
    evaluation, optimisation = parts_of(subject)
    drawing = section(evaluation)
    kind = "Optimisation report" if optimisation is not None else "Evaluation report"
    blocks: list[Block] = []
    if optimisation is not None and optimisation.infeasibility is not None:
        blocks += infeasibility_card.blocks(optimisation.infeasibility)
    blocks.append(tables.requirements(evaluation))
    if optimisation is not None and (chosen := choices_table.block(optimisation)) is not None:
        blocks.append(chosen)
    if optimisation is not None and optimisation.variables:
        blocks.append(optimum.variables(optimisation))
        rounding = whole_plies.block(optimisation)
        if rounding is not None:
            blocks.append(rounding)
    else:
        blocks.append(tables.masses(evaluation))
    blocks += stiffness_page.blocks(evaluation) + dynamics_page.blocks(evaluation)
    if optimisation is not None:
        blocks += trust.blocks(optimisation) + prices.blocks(optimisation)
    if optimisation is not None and optimisation.variables:
        blocks.append(tables.masses(evaluation))
    blocks += [block for study in seals for block in seal.blocks(study)]
    blocks += wall.blocks(evaluation)
    blocks += [tables.checks(evaluation), tables.models(evaluation)]
    blocks += _remarks(evaluation, optimisation)
    blocks += extra_tables
    said = [] if optimisation is None else sentences(optimisation)
    said += reserve_sentences(subject)
    return Page(
        name=evaluation.name,
        kind=kind,
        verdict=verdict(subject),
        sentence=" ".join(said),
        tiles=key_figures(subject),
        hero=lambda room: drawing.ink,
        scale=drawing.scale,
        items=[(item.number, item.part, item.material) for item in drawing.items],
        blocks=blocks,
        lists_input=True,
    )


def _remarks(evaluation: Evaluation, optimisation: Optimisation | None) -> list[Block]:
    blocks: list[Block] = []
    if lines := warnings(optimisation or evaluation):
        blocks.append(Notes("Warnings", [text.pretty(line) for line in lines]))
    blocks.append(tables.assumptions(evaluation))
    if evaluation.design.notes:
        lines = [line for line in evaluation.design.notes.splitlines() if line.strip()]
        blocks.append(Notes("Notes of the author", lines))
    return blocks


def write_report(
    subject: Evaluation | Optimisation,
    *,
    folder: Path,
    stem: str,
    source_text: str,
    source_name: str,
    command: str,
    date: str | None = None,
    extra_tables: Sequence[Block] = (),
    seals: Sequence[SealStudy] = (),
) -> list[ReportFile]:
    """Write ``STEM.pdf``, ``STEM.png`` (first sheet) and ``STEM-page-N.png`` into `folder`.

    Parameters
    ----------
    subject : what to report
    folder, stem : where to; the folder is made if missing
    source_text, source_name : the design file as read: listed, and attached to the PDF
    command : the command line that made this report, printed and attached
    date : ISO date to print, or None for none
    extra_tables : further tables and drawings, before the input listing
    seals : the seals of piston or rod to show on a sheet

    Returns
    -------
    the files, PDF first

    Raises
    ------
    InputError : when the folder cannot be written; no partial file is left
    """
    evaluation, _ = parts_of(subject)
    origin = Origin(source_text, source_name, command, evaluation.spec_hash, date)
    return write(
        page(subject, extra_tables=extra_tables, seals=seals),
        origin,
        folder=folder,
        stem=stem,
        actuator_opt=evaluation.version,
        result=outcome(subject),
    )


def outcome(subject: Evaluation | Optimisation) -> dict[str, Any]:
    """The numbers that say whether a result repeats: SI, by metric and by PATH."""
    evaluation, optimisation = parts_of(subject)
    found: dict[str, Any] = {
        "metrics": {one.name: one.value for one in evaluation.metrics.values()},
        "spec_hash": evaluation.spec_hash,
    }
    if optimisation is None:
        return found
    return found | {
        "status": optimisation.status,
        "variables": {one.path: one.value for one in optimisation.best_variables},
    }
