"""The page of an evaluation or an optimisation: verdict, requirements, and their basis."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from ..design import Design, assembly
from ..design.paths import get, quantity_of
from ..evaluation import result
from ..evaluation.parts_list import parts_list
from ..evaluation.result import Evaluation, Requirement
from ..metrics import METRICS
from ..optimisation.price_table import PER_CENT
from ..optimisation.result import Optimisation
from ..rendering import heights, text
from ..rendering.blocks import (
    AttachedFile,
    Block,
    Cell,
    Column,
    Flag,
    Notes,
    Page,
    Share,
    State,
    Table,
    Tile,
    Verdict,
    soft,
)
from ..rendering.ink import Ink
from ..rendering.text import DASH
from ..studies.seal import SealStudy
from . import duty, dynamics, limits, optimum, prices, seal, section, stiffness, trust, valve, wall

MASSES = "Parts and mass"
"""Title of the table of masses, which summaries show."""
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
"""Candidates for key figures, the most important first. The page shows five key figures: the
objective, then the first of these that have a value."""

_SHORT_OF = ("missed", "infeasible")
"""States in which the badge of a robust search says that margins for scatter are not included."""
_MET = ("met", "checks")
"""States in which every requirement is met: without cautions (green), and with cautions
(amber)."""


def page(
    subject: Evaluation | Optimisation,
    *,
    extra_tables: Sequence[Block] = (),
    seals: Sequence[SealStudy] = (),
    attached: Sequence[AttachedFile] = (),
) -> Page:
    """The page of a design.

    Parameters
    ----------
    subject : the evaluation or optimisation to report
    extra_tables : further tables and drawings, before the appendix
    seals : studies of the piston or rod seals, each on its own sheet
    attached : further files attached to the PDF, which the page names after the prices
    """
    evaluation, optimisation = parts_of(subject)
    drawing = section.section(evaluation)

    def hero(room: float) -> Ink:
        return drawing.ink

    first = Page(
        name=evaluation.name,
        kind="Evaluation report" if optimisation is None else "Optimisation report",
        verdict=verdict(subject),
        sentence=_sentence(subject),
        tiles=key_figures(subject),
        hero=hero,
        scale=drawing.scale,
        items=[(item.number, item.part, item.material) for item in drawing.items],
        lists_input=True,
        summary=(limits.REQUIREMENTS, MASSES),
    )

    later: list[Block] = []
    if optimisation is not None and optimisation.variables:
        blocks, later = _with_variables(first, drawing.ink.height, optimisation)
    else:
        blocks = list(_opening(evaluation, optimisation))
        if optimisation is not None:
            blocks += optimum.sizes_and_choices(optimisation)
        blocks.append(masses(evaluation))
    blocks += stiffness.stiffness_blocks(evaluation, curve_shown=optimisation is None)
    blocks += [*dynamics.dynamics_blocks(evaluation), *valve.valve_blocks(evaluation)]
    blocks += [*duty.duty_blocks(evaluation), *later]
    if optimisation is not None:
        blocks += trust.trust_blocks(optimisation) + prices.price_blocks(optimisation)
    blocks += prices.attached_blocks(attached)
    if optimisation is not None:
        blocks += optimum.robust_tables(optimisation)
        blocks += [masses(evaluation)] if optimisation.variables else []
    blocks += [block for study in seals for block in seal.blocks(study)]
    blocks += [*wall.wall_blocks(evaluation), *limits.places(evaluation)]
    blocks += [*limits.reasons(evaluation), *limits.checks(evaluation)]
    blocks += order_of_assembly(evaluation)
    blocks += _remarks(evaluation, optimisation)
    blocks += extra_tables
    return replace(first, blocks=[*blocks, *_appendix(evaluation)])


def prices_page(optimisation: Optimisation) -> Page:
    """The page of the command `sensitivity`: only the prices of an optimum."""
    blocks = prices.price_blocks(optimisation, moving=True)
    if not blocks and optimisation.infeasibility is not None:
        blocks = optimum.infeasibility_blocks(optimisation.infeasibility)
        blocks += duty.shortfall_blocks(optimisation.best_evaluation)
    return Page(
        name=optimisation.best_evaluation.name,
        kind="Prices",
        verdict=verdict(optimisation),
        sentence=_sentence(optimisation),
        tiles=[],
        hero=lambda room: Ink(1.0, 1.0),
        blocks=blocks,
    )


def parts_of(subject: Evaluation | Optimisation) -> tuple[Evaluation, Optimisation | None]:
    """The evaluation to show and, if it results from an optimisation, that optimisation.

    If rounding to available sizes was requested and possible, the rounded design is evaluated.
    """
    if isinstance(subject, Optimisation):
        return subject.best_evaluation, subject
    return subject, None


def outcome(subject: Evaluation | Optimisation) -> dict[str, Any]:
    """The values that a repeated run must reproduce (SI): metrics by name, variables by PATH."""
    evaluation, optimisation = parts_of(subject)
    numbers: dict[str, Any] = {
        "metrics": {metric.name: metric.value for metric in evaluation.metrics.values()},
        "spec_hash": evaluation.spec_hash,
    }
    if optimisation is None:
        return numbers
    return numbers | {
        "status": optimisation.status,
        "variables": {row.path: row.value for row in optimisation.best_variables},
    }


def _opening(
    evaluation: Evaluation, optimisation: Optimisation | None, *, labelled: bool = True
) -> Iterator[Block]:
    """The first blocks: missed limits, reasons of infeasibility, and requirements."""
    missed = [row.name for row in evaluation.requirements if not row.met]
    if missed:
        words = [f"missed: {', '.join(missed)}"]
        yield Notes("Missed", words, headless=True, style="red", on="terminal")
    if optimisation is not None and optimisation.infeasibility is not None:
        yield from optimum.infeasibility_blocks(optimisation.infeasibility)
    yield from duty.shortfall_blocks(evaluation)
    yield limits.requirements(evaluation, shown=optimisation is not None, labelled=labelled)
    if optimisation is None:
        yield from limits.quantities(evaluation)


def _with_variables(
    page: Page, hero: float, optimisation: Optimisation
) -> tuple[list[Block], list[Block]]:
    """Blocks of the first sheet (requirements, variables), and tables for the following sheets.

    If the table of variables does not fit, the labels of the requirements are dropped first. If
    it still does not fit, a short list of values replaces it.
    """
    table, sizes = optimum.variables(optimisation), optimum.sizes_and_choices(optimisation)
    for labelled in (True, False):
        opening = list(_opening(optimisation.best_evaluation, optimisation, labelled=labelled))
        room = heights.rest(replace(page, blocks=opening), hero)
        if heights.height(table) <= room:
            return [*opening, table, *sizes], []
    return [*opening, *optimum.best_values(optimisation, room)], [table, *sizes]


# ---- verdict ----


def sentences(optimisation: Optimisation) -> list[str]:
    """Sentences on the design shown, the outcome of the search, and a remedy if it failed."""
    parts, rounding = [optimisation.shown], optimisation.rounding
    if rounding is None or rounding.design is not None:
        parts.append(optimisation.sentence)
    if optimisation.robust is not None:
        parts.append(optimisation.robust.sentence)
    parts.append(optimisation.remedy or ("" if rounding is None else rounding.remedy))
    return [text.pretty(text.sentence(part)) for part in parts if part]


def reserve_sentences(subject: Evaluation | Optimisation) -> list[str]:
    """Sentences on limits that are met with almost no margin, and on the yield.

    The yield is the share of actuators that meet all limits in spite of scatter. The result is
    empty if a requirement is missed, or if the search already included scatter (robust search).
    """
    evaluation, optimisation = parts_of(subject)
    robust = optimisation is not None and optimisation.robust is not None
    if robust or verdict(subject).state not in _MET:
        return []
    return [text.pretty(part) for part in evaluation.reserve_sentences]


def _sentence(subject: Evaluation | Optimisation) -> str:
    optimisation = parts_of(subject)[1]
    parts = [] if optimisation is None else [*sentences(optimisation), *_dearest(optimisation)]
    return " ".join([*parts, *reserve_sentences(subject)])


def _dearest(optimisation: Optimisation) -> Iterator[str]:
    """Sentence on the requirement that costs most, and what it costs."""
    required = {row.path: row for row in optimisation.best_evaluation.requirements}
    for price in optimisation.sensitivities:
        row = required.get(price.parameter)
        if price.active and price.ends and row is not None:
            looser = -1 if row.sense == "min" else 1
            solved = next(value for sign, _, value in price.ends if sign == looser)
            change = optimum.change_text(optimisation, solved)
            yield f"The dearest limit is {row.name}: {PER_CENT} % looser, {change}."
            return


def verdict(subject: Evaluation | Optimisation) -> Verdict:
    """Badge at the top of the page: state, words, counts of met limits, and doubts.

    `cautions` are lines in amber: limits without reserve, unverified values, values outside a
    model's range.
    """
    evaluation, optimisation = parts_of(subject)
    missed = sum(not row.met for row in evaluation.requirements)
    failed = [check for check in evaluation.checks if check.status == "missed"]
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
        state, words = "missed", f"NO DESIGN WITH {none_made.upper()}"
    elif missed:
        state, words = "missed", "REQUIREMENTS MISSED"
    elif robust is not None and not robust.reached:
        state, words = "missed", "YIELD MISSED"
    elif failed:
        advice = all(check.advice for check in failed)
        state = "checks"
        words = f"REQUIREMENTS MET, {'ADVICE NOT FOLLOWED' if advice else 'CHECKS MISSED'}"
    elif tight:
        state, words = "checks", f"REQUIREMENTS MET, {result.count_words(tight).upper()}"
    else:
        state, words = "met", "REQUIREMENTS MET"
    counts = limits.counts_of(evaluation)
    lines, cautions = doubts(evaluation)
    without = ", without margins for scatter" if robust and state in _SHORT_OF else ""
    return Verdict(
        state,
        words,
        [
            f"{of}{evaluation.tally}{_misfit(optimisation)}{without}",
            f"checks: {counts['met']} met · {counts['missed']} missed"
            f" · {counts['not_checked']} not checked",
            *lines,
        ],
        [
            *([result.count_words(tight)] if tight and failed and state == "checks" else []),
            *cautions,
        ],
    )


def doubts(evaluation: Evaluation) -> tuple[list[str], list[str]]:
    """Plain lines and cautions for the verdict, on unverified values and extrapolated results."""
    counts = evaluation.counts
    results, models = counts["extrapolated"], counts["extrapolated_models"]
    words = f"{results} result{'' if results == 1 else 's'}"
    if models:
        words += f", {models} model{'' if models == 1 else 's'}"
    known = (
        (counts["unverified"], f"values not verified: {counts['unverified']}"),
        (results + models, f"EXTRAPOLATED: {words}"),
    )
    life = limited_life(evaluation)
    return [line for count, line in known if not count], [
        *([life] if life else []),
        *(line for count, line in known if count),
    ]


def limited_life(evaluation: Evaluation) -> str:
    """Words on a life that no requirement checks; empty if it is endless or checked."""
    life = evaluation.limited_life
    return "" if life is None else f"limited life: {text.number(life, 3)} pressure cycles"


def _misfit(optimisation: Optimisation | None) -> str:
    """Clause that names geometrical conditions that no design can meet all at once."""
    card = None if optimisation is None else optimisation.infeasibility
    return (
        f"; conflicting conditions of the geometry: {', '.join(card.laws)}"
        if card and card.laws
        else ""
    )


# ---- key figures ----


def key_figures(subject: Evaluation | Optimisation) -> list[Tile]:
    """Five key figures, the objective first, each with a note on its limit or origin."""
    evaluation, optimisation = parts_of(subject)
    first = () if optimisation is None else (optimisation.objective_metric,)
    names = [n for n in dict.fromkeys((*first, *KEY_FIGURES)) if n in evaluation.metrics]
    names = [n for n in names if evaluation.metrics[n].value is not None][:5]
    tiles = []
    for name in names:
        metric, quantity = evaluation.metrics[name], text.metric(name)
        row = _limited(evaluation, name)
        value, note = metric.value, f'load case "{metric.case}"' if metric.case else ""
        if name == "natural_frequency" and not _loaded(evaluation.design):
            note = "no load: state load.mass"
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
                limits.short_label(name, quantity),
                text.number(text.display(quantity, value)),
                text.unit_text(quantity.unit),
                note,
                state,
                quantity.symbol,
            )
        )
    return tiles


def _loaded(design: Design) -> bool:
    """Whether the design states a mass or moment of inertia of the load."""
    return bool(design.load.mass or design.load.inertia)


def _limited(evaluation: Evaluation, name: str) -> Requirement | None:
    """The limit on a metric with the smallest margin; a limit without a value comes last."""
    rows = [row for row in evaluation.requirements if row.metric == name]
    return min(rows, key=lambda r: math.inf if r.margin is None else r.margin, default=None)


def _before(optimisation: Optimisation | None, name: str) -> tuple[str, float, int] | None:
    """Reference value with which a key figure is compared: its name, value and number of digits.

    The reference is the optimum before rounding, or else the start.
    """
    if optimisation is None:
        return None
    words, origin, digits = "start", optimisation.start, 3
    if optimisation.made is not None:
        words, origin, digits = "continuous", optimisation.evaluation, 2
    metric = origin.metrics.get(name)
    return None if metric is None or metric.value is None else (words, metric.value, digits)


# ---- masses ----


def masses(evaluation: Evaluation) -> Block:
    """Pieces, materials and mass of every part; the total, and the mass of the oil."""
    quantity = METRICS["mass"]
    parts = evaluation.mass_parts
    total = sum(parts.values())
    largest = max(parts.values(), default=0.0)
    unit = text.unit_text(quantity.unit)
    decimals = text.decimals(quantity.to_display(total), 5)

    def grams(mass: float) -> str:
        return text.fixed(quantity.to_display(mass), decimals)

    rows: list[list[Cell]] = [
        [
            soft(part.replace("_", " ")),
            "" if pieces is None else str(pieces),
            soft(material),
            grams(mass),
            text.share_text(mass / total if total else 0.0),
            Share(mass / largest if largest else 0.0),
        ]
        for part, pieces, material, mass in parts_list(evaluation)
    ]
    rows.append(["dry mass", "", "", grams(total), text.share_text(1.0), ""])
    oil = evaluation.metrics.get("mass_oil")
    below = 1
    if oil is not None and oil.value is not None:
        material = soft(evaluation.design.fluid.material)
        rows.append(["oil inside", "", material, grams(oil.value), "", ""])
        rows.append(["filled", "", "", grams(total + oil.value), "", ""])
        below = 3
    columns = [
        Column("part", "left", "28mm"),
        Column("pieces", "right"),
        Column("material", "left", 1.0),
        Column(f"mass, {unit}", "right"),
        Column("share", "right"),
        Column("", "left", "40mm"),
    ]
    note = mass_leaves_out(evaluation)
    return Table(MASSES, columns, rows, total=below, note=note, on="paper")


def mass_leaves_out(evaluation: Evaluation) -> str:
    """Sentence that names the components that the dry mass leaves out; "" if there are none."""
    if not evaluation.mass_leaves_out:
        return ""
    named = ", ".join(evaluation.mass_leaves_out)
    return f"The dry mass leaves out: {named}. State them under extra_masses to count them."


# ---- assembly ----


def order_of_assembly(evaluation: Evaluation) -> Iterator[Block]:
    """Order of assembly, derived from the joints."""
    if lines := assembly.order(evaluation.design):
        yield Notes("Order of assembly", lines, on="paper")


# ---- remarks and appendix ----


def warnings(subject: Evaluation | Optimisation) -> list[str]:
    """Warnings of the evaluation, then of the optimiser."""
    evaluation, optimisation = parts_of(subject)
    return [*evaluation.warnings, *(() if optimisation is None else optimisation.warnings)]


def _remarks(evaluation: Evaluation, optimisation: Optimisation | None) -> Iterator[Block]:
    """Warnings; on the terminal also a summary of the appendix.

    The full appendix is printed only on paper.
    """
    if lines := warnings(optimisation or evaluation):
        yield Notes("Warnings", [text.pretty(line) for line in lines], style="yellow")
    data = []
    if note := mass_leaves_out(evaluation):
        yield Notes("Mass", [note], headless=True, on="terminal")
    if evaluation.extrapolated:
        data.append(f"extrapolated: {', '.join(evaluation.extrapolated)}")
    if evaluation.unverified:
        counts: dict[str, int] = {}
        for value in evaluation.unverified:
            counts[value.material] = counts.get(value.material, 0) + 1
        listed = ", ".join(f"{material} {count}" for material, count in counts.items())
        data.append(
            f"library values used but not verified: {len(evaluation.unverified)} ({listed})"
        )
    if data:
        yield Notes("Data", data, headless=True, style="yellow", on="terminal")
    if optimisation is not None:
        yield from trust.brief(optimisation)


def _appendix(evaluation: Evaluation) -> Iterator[Block]:
    """The origin of the numbers: unverified values, models, notes of the author."""
    contents = ["Unverified values, models with their valid ranges, and the design file."]
    yield Notes("Appendix", contents, on="paper")
    yield assumptions(evaluation)
    yield models(evaluation)
    if evaluation.design.notes:
        lines = [line for line in evaluation.design.notes.splitlines() if line.strip()]
        yield Notes("Notes of the author", lines, on="paper")


def models(evaluation: Evaluation) -> Block:
    """Table of the models used, with source and valid range; extrapolation is flagged."""
    rows: list[list[Cell]] = [
        [
            row.name,
            soft(text.pretty(row.equation)),
            row.reference or "not stated",
            soft(text.pretty(row.valid_range) or "not stated"),
            soft(text.pretty(row.used_at)),
            Flag("inside" if row.in_range else "EXTRAPOLATED", not row.in_range),
        ]
        for row in evaluation.models
    ]
    if not rows:
        return Notes("Models", ["No models recorded."], on="paper")
    columns = [
        Column("model", "left", 1.1, breaks=22, mono=True),
        Column("equation", "left", 1.3),
        Column("source", "left", 1.1, breaks=24),
        Column("valid range", "left", 1.15),
        Column("used at", "left", 1.0),
        Column("range"),
    ]
    outside = sum(not row.in_range for row in evaluation.models)
    note = f"{outside} of {len(rows)} models are used outside their valid range." if outside else ""
    return Table("Models", columns, rows, note=note, on="paper")


def assumptions(evaluation: Evaluation) -> Block:
    """Assumptions: unverified library values, values from test records, and waived checks."""
    title = "Assumptions and unverified data"
    groups: dict[tuple[str, str, str], list[str]] = {}
    for row in evaluation.unverified:
        words = f"{row.property} {text.pretty(row.value)}"
        groups.setdefault((row.material, row.source, row.note), []).append(words)
    rows: list[list[Cell]] = [
        [soft(material), soft("; ".join(values)), soft(source), soft(text.pretty(note) or DASH)]
        for (material, source, note), values in groups.items()
    ]
    for path, known in evaluation.design.measured.items():
        quantity = quantity_of(path, evaluation.design)
        ends = [text.value_text(quantity, end, 3) for end in (known.lower, known.upper)]
        value = get(evaluation.design, path)
        shown = text.value_text(quantity, value if isinstance(value, float) else None, 3)
        words = f"{shown} ({' to '.join(ends)})"
        rows.append([soft(path), soft(words), soft(known.record), "test record, 95 % bounds"])
    rows += [
        ["waived check", soft(metric), "the author", soft(reason)]
        for metric, reason in evaluation.design.waivers.items()
    ]
    if not rows:
        note = "Every library value used is marked as checked; no check is waived."
        return Notes(title, [note], on="paper")
    columns = [
        Column("material", "left", 1.05),
        Column("values", "left", 2.0),
        Column("source", "left", 1.4),
        Column("note", "left", 1.3),
    ]
    note = (
        f"{len(evaluation.unverified)} of the library values used were never compared with their"
        " primary source; see the materials files."
    )
    return Table(title, columns, rows, note=note, on="paper")
