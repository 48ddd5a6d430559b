"""The card of a design: what the terminal shows of an evaluation or an optimisation.

At most 30 lines of an evaluation and 35 of an optimisation, 80 columns wide: the verdict, missed
limits, what holds the design, its dimensions or masses, duty cycles, doubts, and the next command.
The whole page (`report.page`) follows with ``--verbose``.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ..design.paths import words_of
from ..evaluation.result import Check, Evaluation, Requirement, count_words, percent
from ..metrics import term_of
from ..optimisation.price_table import PER_CENT, Sensitivity
from ..optimisation.problem import Robust
from ..optimisation.result import Infeasibility, Optimisation, VariableResult
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Notes, Pair, Row, Status, Table
from ..rendering.terminal import PAINTS
from ..rendering.text import DASH, sentence
from . import duty, limits, optimum, report

MOST_LIMITS = 11
"""Largest number of limits in a table: misses first, then the smallest margins."""
BESIDE_DUTY = 7
"""Largest number of limits in a table beside a duty cycle, which needs lines, too."""
MOST_MISSES, MOST_HELD = 6, 7
"""Largest number of missed limits and of active limits on the card of an optimisation."""
MOST_REMEDIES = 6
"""Largest number of remedies of each kind if nothing fits."""
MOST_DIMENSIONS = 18
"""Largest number of dimensions, in two columns."""
LONGEST_NAME = 20
"""Number of letters from which the name of a dimension loses its first words."""
MOST_PARTS = 8
"""Largest number of parts with their masses, in two columns."""
LINE = 80
"""Letters of a line on a usual terminal; lists of names are cut to it."""
MOST_NAMED = 3
"""Largest number of offers that a line names."""
LEAST_GAIN = 1e-3
"""A change that improves the objective by a smaller share is not offered."""
MORE = "(-v)"
"""Refers to the option that shows the whole page."""


def blocks(
    subject: Evaluation | Optimisation,
    *,
    again: str = "DESIGN.yaml",
    written: bool = False,
    relax_safety: bool = False,
) -> list[Block]:
    """The card of an evaluation or an optimisation.

    Parameters
    ----------
    subject : the evaluation or optimisation
    again : design file and options that repeat the command, for the line "next"
    written : whether the design was saved, so that the line "next" need not say how
    relax_safety : whether to offer lower safety factors, too, if nothing fits
    """
    evaluation, optimisation = report.parts_of(subject)
    lacks: list[Block] = [replace(x, title="") for x in duty.shortfall_blocks(evaluation)]
    if optimisation is not None and optimisation.infeasibility is not None:
        remedies = _remedies(optimisation, optimisation.infeasibility, relax_safety=relax_safety)
        body = [lacks, *remedies]
    elif optimisation is None:
        body = [_limits(evaluation), lacks, [*_masses(evaluation), *_others(evaluation)]]
    else:
        body = [
            _misses(evaluation),
            lacks,
            [*_held(optimisation), *_spare(optimisation)],
            [*_dimensions(optimisation), *_bounds(optimisation)],
        ]
    foot = [*_outcomes(subject), *_doubts(subject), *_next(subject, again, written=written)]
    groups = [[*_head(subject)], *body, duty.card_blocks(evaluation), foot]
    return [Pair([group], tight=True) for group in groups if group]


def _line(words: str, style: str = "") -> Notes:
    return Notes("", [words], headless=True, style=style, on="terminal")


def _listed(head: str, names: Sequence[str], tail: str = "", most: int = 99) -> str:
    """The first names between `head` and `tail`, as many as one line holds, and how many more."""
    words = head + names[0] + tail
    for count in range(1, min(most, len(names)) + 1):
        more = [f"{len(names) - count} more"] if len(names) > count else []
        longer = f"{head}{', '.join([*names[:count], *more])}{tail}"
        if count > 1 and len(longer) > LINE:
            break
        words = longer
    return words


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _name(row: Requirement | Check, evaluation: Evaluation) -> str:
    """A limit in plain words, marked if a model is used outside its valid range."""
    if isinstance(row, Check) and row.metric is None:
        return row.name
    if isinstance(row, Requirement) and row.path.startswith("load_cases"):
        by_arm = row.metric != "joint_torque_min"
        words = words_of(row.path.replace(".joint_torque", ".force") if by_arm else row.path)
    else:
        words = term_of(row.metric or "")
    if isinstance(row, Requirement) and row.name.endswith((" (min)", " (max)")):
        words += row.name[-6:]
    return words + limits.flag(evaluation, row.metric)


# ---- verdict ----


def _head(subject: Evaluation | Optimisation) -> Iterator[Block]:
    """Name, objective, limits met, and quality of the optimum; a remedy if there is no optimum."""
    evaluation, optimisation = report.parts_of(subject)
    missed = _missed_checks(evaluation)
    advised = sum(check.advice for check in missed)
    parts = [f"{_objective(evaluation, optimisation)}{_sizes(optimisation)}", _tally(evaluation)]
    if binding := len(missed) - advised:
        parts.append(f"{_count(binding, 'check')} missed")
    if advised:
        parts.append(f"{_count(advised, 'piece')} of advice not followed")
    if optimisation is not None:
        parts.append(_quality(optimisation))
    name, words = evaluation.name, ", ".join(filter(None, parts))
    if optimisation is not None and optimisation.infeasibility is not None:
        words = _nearest(evaluation, optimisation.infeasibility)
        if optimisation.robust is not None:
            target = percent(optimisation.robust.target)
            words = words.replace("nothing fits", f"nothing fits with a yield of {target} %", 1)
    style = PAINTS[report.verdict(subject).state]
    if optimisation is not None and optimisation.rounding is not None and not optimisation.made:
        name, words = (
            f"{name}: no design with {optimisation.rounding.name}",
            f"without them: {words}",
        )
        yield _line(name, style)
        yield _line(words)
    else:
        yield _line(f"{name}: {words}", style)
    if optimisation is not None and (remedy := _remedy(optimisation)):
        yield _line(remedy)


def _tally(evaluation: Evaluation) -> str:
    total, missed = len(evaluation.requirements), sum(not x.met for x in evaluation.requirements)
    if not total:
        return "no requirement stated"
    if missed:
        return f"{missed} of {total} requirements missed"
    all_of = {1: "its requirement", 2: "both requirements"}
    return f"{all_of.get(total, f'all {total} requirements')} met"


def _objective(evaluation: Evaluation, optimisation: Optimisation | None) -> str:
    """Value of the objective; of a design without a single objective, its mass."""
    if optimisation is not None:
        name, value = optimisation.objective_metric, optimisation.best_objective
        if not math.isfinite(value):
            return ""
    else:
        objective = evaluation.design.objective
        names = () if objective is None else objective.metrics
        name = names[0] if len(names) == 1 else "mass"
        metric = evaluation.metrics.get(name)
        if metric is None or metric.value is None:
            return ""
        value = metric.value
    shown = text.value_text(text.metric(name), value)
    return shown if name == "mass" else f"{term_of(name)} {shown}"


def _sizes(optimisation: Optimisation | None) -> str:
    made = None if optimisation is None else optimisation.made
    return "" if made is None else f" with {made.name}"


_QUALITY = {
    "infeasible": "nothing fits",
    "feasible": "not at an optimum",
    "limit": "stopped before the end",
    "limit_infeasible": "stopped before the end",
    "interrupted": "interrupted",
    "interrupted_infeasible": "interrupted",
    "flat": "no variable affects the objective",
    "nothing_free": "nothing free to change",
    "undefined": "no usable answer",
}
"""Outcome of a search other than an optimum, in few words."""


def _quality(optimisation: Optimisation) -> str:
    """Whether the design is an optimum, and whether that is proven."""
    if optimisation.status != "optimal":
        return _QUALITY.get(optimisation.status, optimisation.status)
    certificate = optimisation.certificate
    found = "optimal" if optimisation.made is None else "rounded from an optimum"
    if certificate is None:
        return f"{found} (not proven: --certify)" if optimisation.variables else "the best choice"
    if certificate.gap is None:
        return f"{found} (no proof {MORE})"
    share = math.ceil(1e4 * certificate.gap) / 100  # rounded up
    return f"{found}, proven to within {text.trimmed(share)} % of the best possible"


def _remedy(optimisation: Optimisation) -> str:
    """Sentences on why there is no optimum, or no rounded design, and what to do."""
    rounding = optimisation.rounding
    if rounding is not None and rounding.design is None:
        return text.pretty(" ".join(map(sentence, (rounding.sentence, rounding.remedy))))
    if optimisation.status == "optimal" or optimisation.infeasibility is not None:
        return ""
    return text.pretty(" ".join(map(sentence, (optimisation.sentence, optimisation.remedy))))


# ---- limits ----


def _limits(evaluation: Evaluation) -> list[Block]:
    """Limits with result and margin: missed ones first, then the smallest margins."""
    rows: list[Requirement | Check] = [*_by_margin(evaluation.requirements)]
    first = sum(not row.met for row in evaluation.requirements)
    rows[first:first] = _missed_checks(evaluation)
    most = MOST_LIMITS
    if evaluation.duty is not None:
        most = BESIDE_DUTY + 1 - min(len(evaluation.duty.cycles), duty.MOST_ON_CARD)
    return _limit_table("quantity", rows, most, evaluation)


def _misses(evaluation: Evaluation) -> list[Block]:
    """Missed requirements and checks, of an optimisation."""
    rows: list[Requirement | Check] = [
        *_by_margin(row for row in evaluation.requirements if not row.met),
        *_missed_checks(evaluation),
    ]
    return _limit_table("missed", rows, MOST_MISSES, evaluation)


def _missed_checks(evaluation: Evaluation) -> list[Check]:
    """Missed checks, without those that repeat a requirement."""
    required = {(row.metric, row.sense, row.limit) for row in evaluation.requirements}
    return [
        check
        for check in evaluation.checks
        if check.status == "missed" and (check.metric, check.sense, check.limit) not in required
    ]


def _by_margin(rows: Iterable[Requirement]) -> list[Requirement]:
    """Missed rows first, then by margin; a limit without a value comes first."""
    return sorted(rows, key=lambda r: (r.met, -math.inf if r.margin is None else r.margin))


def _limit_table(
    head: str, rows: Sequence[Requirement | Check], most: int, evaluation: Evaluation
) -> list[Block]:
    if not rows:
        return []
    columns = [
        Column(""),
        Column(head, width=2.0, least=16),
        Column("limit", "right", drop=1),
        Column("result", "right", style="bold"),
        Column("margin", "right", style="state"),
        Column("where", width=1.0, drop=2, style="dim"),
    ]
    cells = [Row(_limit_cells(row, evaluation), row.state) for row in rows[:most]]
    blocks: list[Block] = [Table("", columns, cells)]
    for row in rows[:most]:
        metric = evaluation.metrics.get(row.metric or "")
        if row.value is None and metric is not None and metric.why:
            blocks.append(_line(f"{_name(row, evaluation)} not computed: {metric.why}"))
    if advised := [row for row in rows[:most] if isinstance(row, Check) and row.advice]:
        name, sense, limit = advised[0].metric, advised[0].sense, advised[0].limit
        assert name is not None
        assert limit is not None
        shown = text.metric(name).text(limit)
        blocks.append(
            _line(
                f'advice is not a limit; to enforce it: requirements.{name}.{sense}="{shown}"; '
                f"to accept the miss: waivers.{name} with a reason"
            )
        )
    hidden = rows[most:]
    missed = sum(row.state == "missed" for row in hidden)
    if hidden:
        words = f"{missed} more missed" if missed else f"{len(hidden)} more met"
        blocks.append(_line(f"{words} {MORE}"))
    return blocks


def _limit_cells(row: Requirement | Check, evaluation: Evaluation) -> list[Cell]:
    quantity, met = text.metric(row.metric or ""), row.state != "missed"
    where = text.brief(row.case, row.place)
    if isinstance(row, Check):
        kind = "advice" if row.advice else "check"
        where = f"{kind}; {where}" if where else kind
    return [
        Status(row.state, " "),
        _name(row, evaluation),
        text.limit_text(quantity, row.sense, row.limit),
        DASH if row.value is None else text.value_text(quantity, row.value),
        text.margin_of(quantity, row.limit, row.margin, met=met),
        where,
    ]


def _held(optimisation: Optimisation) -> list[Block]:
    """Requirements that hold the optimum, with the change of the objective if they change.

    The dearest is first.
    """
    evaluation = optimisation.best_evaluation
    required = {row.path: row for row in evaluation.requirements}
    priced = {
        row.parameter: row
        for row in optimisation.sensitivities
        if row.active and row.parameter in required
    }
    held = [required[path] for path in priced if required[path].met]
    held += [r for r in evaluation.requirements if r.state == "no_reserve" and r not in held]
    rows: list[list[Cell]] = []
    for row in held[:MOST_HELD]:
        name, limit, result, margin = _limit_cells(row, evaluation)[1:5]
        changes = _changes(optimisation, row, priced.get(row.path)) if priced else [margin]
        rows.append([f"  {name}", limit, result, *changes])
    columns = [
        Column("what holds it" if priced else "without reserve", width=1.0, least=18),
        Column("limit", "right", drop=1),
        Column("result", "right", drop=2, style="bold"),
        *(Column(f"{PER_CENT} % {word}", "right") for word in ("looser", "tighter") if priced),
        *([] if priced else [Column("margin", "right")]),
    ]
    blocks: list[Block] = [Table("", columns, rows)] if rows else []
    names = [_name(row, evaluation) for row in held[MOST_HELD:]]
    checks = _checks_at_limit(optimisation)
    if names:
        blocks.append(_line(_listed("also at their limit: ", names, f" {MORE}")))
    if checks:
        head = f"also at their limit: {_count(len(checks), 'check')} ("
        blocks.append(_line(_listed(head, checks, f") {MORE}")))
    return blocks


def _changes(optimisation: Optimisation, row: Requirement, price: Sensitivity | None) -> list[Cell]:
    """Change of the objective if a limit is 10 % looser, then 10 % tighter."""
    if price is None or not price.ends:
        return [DASH, DASH]
    solved = {sign: value for sign, _, value in price.ends}
    looser = -1 if row.sense == "min" else 1
    return [optimum.change_text(optimisation, solved[sign]) for sign in (looser, -looser)]


def _checks_at_limit(optimisation: Optimisation) -> list[str]:
    """Checks without reserve that are no requirements, the dearest first."""
    evaluation = optimisation.best_evaluation
    required = {row.metric for row in evaluation.requirements}
    rank = {row.parameter: k for k, row in enumerate(optimisation.sensitivities)}
    rows = [
        check
        for check in evaluation.checks
        if check.state == "no_reserve" and check.metric not in required
    ]
    path = "requirements.{0.metric}.{0.sense}".format
    rows.sort(key=lambda check: rank.get(path(check), len(rank)))
    return [_name(check, evaluation) for check in rows]


def _spare(optimisation: Optimisation) -> list[Block]:
    """Requirements that are met with a reserve, the smallest first."""
    evaluation = optimisation.best_evaluation
    active = {row.parameter for row in optimisation.sensitivities if row.active}
    rows = [
        row
        for row in _by_margin(evaluation.requirements)
        if row.state == "met" and row.path not in active
    ]
    words = []
    for row in rows:
        margin = text.margin_of(text.metric(row.metric), row.limit, row.margin)
        words.append(f"{_name(row, evaluation)} {margin}")
    return [_line(_listed("to spare: ", words))] if words else []


# ---- nothing fits ----


def _nearest(evaluation: Evaluation, card: Infeasibility) -> str:
    """The limit that the nearest design misses most, or the geometry that no design can meet."""
    if card.laws:
        return f"nothing fits, whatever is asked for: {_listed('', [*map(term_of, card.laws)])}"
    rows = [row for row in evaluation.requirements if not row.met]
    rows.sort(key=lambda row: -math.inf if row.margin is None else row.margin)
    if not rows:
        return "nothing fits"
    row, quantity = rows[0], text.metric(rows[0].metric)
    words = f"nothing fits. Nearest: {_name(row, evaluation)}"
    if row.value is None or row.margin is None:
        return f"{words} not computed"
    limit = text.limit_text(quantity, row.sense, row.limit)
    words += f" {text.value_text(quantity, row.value)}, {limit}"
    if row.limit:
        side = "under" if row.sense == "min" else "over"
        words += f" ({text.number(-100 * row.margin, 2)} % {side})"
    return words if len(rows) == 1 else f"{words}, {len(rows) - 1} more missed"


_KEPT = ("dimension", "choice", "bound", "number")
"""Kinds of remedy that keep every requirement."""


def _remedies(
    optimisation: Optimisation, card: Infeasibility, *, relax_safety: bool
) -> list[list[Block]]:
    """Changes that make a design possible: with all requirements kept, then with less asked for.

    Safety factors are only offered with `relax_safety`.
    """
    kept = [cure for cure in card.cures if cure["kind"] in _KEPT]
    less = [c for c in card.cures if c["kind"] == "requirement"]
    safety = [c for c in card.cures if c["kind"] == "safety factor"]
    together = [] if less else [*card.joint]
    unsafe = bool(safety) or any(entry["safety_factor"] for entry in together)
    if relax_safety:
        less += safety
    elif any(entry["safety_factor"] for entry in together):
        together = []
    groups: list[list[Block]] = []
    number = 0
    for title, entries in (
        ("keep every requirement and change", kept[:MOST_REMEDIES]),
        ("or ask for less" if kept else "ask for less", less[:MOST_REMEDIES]),
        ("or ask for less of all these together", together[:MOST_REMEDIES]),
    ):
        if not entries:
            continue
        rows = [
            [str(number + k), _what(entry), _then(optimisation, entry)]
            for k, entry in enumerate(entries, 1)
        ]
        number += len(entries)
        then = "then" if any(row[-1] for row in rows) else ""
        columns = [
            Column("", "right"),
            Column(title, width=1.0, least=30, wraps=True),
            Column(then, "right", strong=True),
        ]
        groups.append([Table("", columns, rows)])
    if not groups:
        groups.append(
            [_line("No single change of a number, choice or limit was found to be enough.")]
        )
    notes: list[Block] = []
    if card.failed:
        notes.append(_line(_listed("no help alone: ", card.failed)))
    if card.untried:
        notes.append(_line(_listed("not tried: ", card.untried)))
    if unsafe and not relax_safety:
        notes.append(_line("lower safety factors would also do: not advised, see --relax-safety"))
    notes.append(_line("No design found is not a proof that there is none; -v shows the search."))
    return [*groups, notes]


def _what(entry: Mapping[str, Any]) -> str:
    """The change in words: PATH, present and needed value, change in per cent."""
    if "together" in entry:
        return " and ".join(map(_what, entry["together"]))
    name = str(entry["parameter"] or entry["requirement"])
    change = entry["change"]
    if beside := entry.get("beside"):
        further = " and ".join(f"{path} → {word}" for path, word in beside.items())
        return f"{name}  {entry['now']} → {entry['needed']} and {further}"
    share = "" if change is None else f" ({text.number(100 * change, 2, signed=True)} %)"
    return text.pretty(f"{name}  {entry['limit_text']} -> {entry['needed_text']}{share}").replace(
        "->", "→"
    )


def _settings(card: Infeasibility) -> str:
    """Options ``--set`` that make the first remedy that keeps every requirement; "" without one."""
    cure = next((cure for cure in card.cures if cure["kind"] in _KEPT), None)
    if cure is None:
        return ""
    pairs: list[tuple[str, str]] = []
    for entry in cure.get("together", [cure]):
        needed = entry["needed"] if isinstance(entry["needed"], str) else entry["needed_text"]
        pairs += [(entry["parameter"], needed), *entry.get("beside", {}).items()]
    return "".join(f" --set {shlex.quote(f'{path}={value}')}" for path, value in pairs)


def _then(optimisation: Optimisation, entry: Mapping[str, Any]) -> str:
    """The objective with a change."""
    value = entry.get("objective")
    return (
        "" if value is None else text.value_text(text.metric(optimisation.objective_metric), value)
    )


# ---- dimensions and masses ----


def _columns_of(rows: Sequence[Sequence[Cell]], columns: Sequence[Column]) -> Pair:
    """A table in two columns, the first no shorter than the second."""
    middle = (len(rows) + 1) // 2
    sides = [rows[:middle], rows[middle:]]
    return Pair([[Table("", columns, side)] for side in sides if side], tight=True)


def _dimensions(optimisation: Optimisation) -> list[Block]:
    """Start and best value of the dimensions, in two columns."""
    variables = optimisation.best_variables
    if not variables:
        return []
    names = _short_names([row.path for row in variables])
    rows: list[list[Cell]] = []
    for row in variables[:MOST_DIMENSIONS]:
        quantity = text.input_quantity(row.quantity)
        start = None if row.start is None else quantity.to_display(row.start)
        rows.append([names[row.path], text.number(start), text.value_text(quantity, row.value)])
    columns = [
        Column("dimension", width=1.0, least=12),
        Column("start", "right", style="dim"),
        Column("optimum" if optimisation.made is None else "rounded", "right", strong=True),
    ]
    more = len(variables) - MOST_DIMENSIONS
    note = [_line(f"{_count(more, 'more dimension')} {MORE}")] if more > 0 else []
    return [_columns_of(rows, columns), *note]


def _short_names(paths: Sequence[str]) -> dict[str, str]:
    """Words for every PATH; if they are long, without the first words where they stay unique."""
    names = {path: words_of(path) for path in paths}
    for path, words in names.items():
        while len(words) > LONGEST_NAME and " " in words:
            words = words.partition(" ")[2]
            if any(other.endswith(words) for at, other in names.items() if at != path):
                break
            names[path] = words
    return names


def _bounds(optimisation: Optimisation) -> Iterator[Block]:
    """Dimensions at a bound, which could be wider."""
    at = [row for row in optimisation.best_variables if row.at_bound is not None]
    if at:
        yield _line(_listed("at its bound: ", [*map(_bound, at)]), "yellow")


def _bound(row: VariableResult) -> str:
    value = row.lower if row.at_bound == "lower" else row.upper
    quantity = text.input_quantity(row.quantity)
    shown = text.with_unit(text.trimmed(quantity.to_display(value)), text.unit_text(quantity.unit))
    return f"{words_of(row.path)} ({row.at_bound}, {shown})"


def _masses(evaluation: Evaluation) -> list[Block]:
    """Masses of the heaviest parts in two columns, mass with oil, and what is left out."""
    quantity = text.metric("mass")
    parts = sorted(evaluation.mass_parts.items(), key=lambda part: -part[1])
    total = sum(evaluation.mass_parts.values())
    if not total:
        return []
    if len(parts) > MOST_PARTS:
        rest = parts[MOST_PARTS - 1 :]
        parts = [*parts[: MOST_PARTS - 1], (f"{len(rest)} others", sum(x for _, x in rest))]
    rows: list[list[Cell]] = [
        [name.replace("_", " "), text.value_text(quantity, x), text.share_text(x / total)]
        for name, x in parts
    ]
    columns = [
        Column("part", width=1.0, least=12),
        Column("mass", "right", style="bold"),
        Column("share", "right"),
    ]
    oil = evaluation.metrics.get("mass_oil")
    words = f"dry {text.value_text(quantity, total)}"
    if oil is not None and oil.value is not None:
        words += f", with oil {text.value_text(quantity, total + oil.value)}"
    if evaluation.mass_leaves_out:
        words = _listed(f"{words}; without ", evaluation.mass_leaves_out)
    return [_columns_of(rows, columns), _line(words)]


def _others(evaluation: Evaluation) -> Iterator[Block]:
    """Key figures without a limit."""
    limited = {row.metric for row in evaluation.requirements} | {"mass"}
    words = [
        f"{term_of(name)}{limits.flag(evaluation, name)} {text.value_text(metric.quantity, x)}"
        for name in report.KEY_FIGURES
        if name not in limited
        and (metric := evaluation.metrics.get(name)) is not None
        and (x := metric.value) is not None
    ]
    if words:
        yield _line(_listed("also: ", words))


# ---- outcomes of what else was asked, doubts, next command ----


def _outcomes(subject: Evaluation | Optimisation) -> Iterator[Block]:
    """A line or two for what would pay, choices, sizes, the certificate and the yield."""
    evaluation, optimisation = report.parts_of(subject)
    if optimisation is not None:
        yield from _offers(optimisation)
        if optimisation.choices is not None:
            choices = optimisation.choices
            count = len(choices.combinations)
            words = f"choices: {optimum.chosen(optimisation, choices)}; best of {count}"
            second = next((x for x in choices.combinations[1:] if x.percent is not None), None)
            if second is not None:
                words += f", the next costs {text.number(second.percent, 2, signed=True)} %"
            yield _line(f"{words} {MORE}")
        if (rounding := optimisation.made) is not None:
            title = optimum.rounding_title(optimisation, rounding)
            title += "; changes above: before rounding" if optimisation.sensitivities else ""
            if rounding.unmade:
                title = _listed(f"{title}; not yet whole: ", [*map(words_of, rounding.unmade)])
            yield _line(text.pretty(title))
        certificate = optimisation.certificate
        if certificate is not None and certificate.gap is None:
            yield _line(text.pretty(f"no proof: {certificate.sentence}"), "yellow")
        if optimisation.robust is not None:
            yield from _robust(optimisation, optimisation.robust)
            return
    yield from _yield(evaluation)


def _robust(optimisation: Optimisation, robust: Robust) -> Iterator[Block]:
    """Yield of a search with margins for scatter, beside the yield asked for, and the margins."""
    evaluation = optimisation.best_evaluation
    rate, low, high = (percent(share) for share in (robust.rate, robust.lower, robust.upper))
    words = f"yield: {rate} % ({low} to {high} %), asked for {percent(robust.target)} %"
    nominal = robust.nominal_objective
    if math.isfinite(nominal):
        quantity = text.metric(optimisation.objective_metric)
        share = percent(robust.nominal_rate)
        words += f"; best without margins: {text.value_text(quantity, nominal)}, {share} %"
    yield _line(words, "" if robust.reached else "yellow")
    rows = {row.name: _name(row, evaluation) for row in evaluation.requirements}
    kept = [(x, rows.get(name, name)) for name, x in robust.reserves.items() if x >= LEAST_GAIN]
    names = [f"{name} {100 * x:.2g} %" for x, name in sorted(kept, reverse=True)]
    if names:
        yield _line(_listed("margins for scatter: ", names))


def _yield(evaluation: Evaluation) -> Iterator[Block]:
    """Share of the actuators built that would meet every requirement, if estimated."""
    known = evaluation.yield_estimate
    if known.value is None or known.lower is None or known.upper is None or not evaluation.met:
        return
    shares = [percent(share) for share in (known.value, known.lower, known.upper)]
    words = "yield: {} % of the actuators built would meet all requirements ({} to {} %)"
    words = words.format(*shares)
    if known.with_checks is not None and known.with_checks < known.value:
        words += f", {percent(known.with_checks)} % also all checks"
    if known.worst is not None and known.worst_fails:
        row = next((r for r in evaluation.requirements if r.name == known.worst), None)
        name = known.worst if row is None else _name(row, evaluation)
        words += f"; {percent(known.worst_fails)} % miss {name}"
    yield _line(words, "" if known.value >= 0.99 else "yellow")


def _offers(optimisation: Optimisation) -> Iterator[Block]:
    """Fixed values and materials whose change by 10 % would improve the objective most."""
    required = {row.path for row in optimisation.evaluation.requirements}
    direction = 1.0 if optimisation.design.objective.aim == "max" else -1.0
    objective = optimisation.objective_value
    offers: list[tuple[float, str]] = []
    for row in optimisation.sensitivities:
        binding = row.active and row.parameter in required
        if binding or row.parameter.startswith("requirements.") or not _buyable(row):
            continue
        for sign, _, solved in row.ends:
            gain = -math.inf if solved is None else direction * (solved - objective)
            if gain > LEAST_GAIN * abs(objective):
                more = "more" if sign > 0 else "less"
                words = f"{PER_CENT} % {more} {words_of(row.parameter)}"
                offers.append((gain, f"{words} {optimum.change_text(optimisation, solved)}"))
    if offers:
        offers.sort(key=lambda offer: -offer[0])
        names = [words for _, words in offers[:MOST_NAMED]]
        yield _line(f"would pay: {', '.join(names)}")


def _buyable(row: Sensitivity) -> bool:
    """Whether a designer can change this number; of a material, only a strength has grades."""
    return row.kind != "material" or row.parameter.endswith("strength")


def _doubts(subject: Evaluation | Optimisation) -> Iterator[Block]:
    """Doubts beside a good verdict: no reserve, not checked, unverified, extrapolated."""
    evaluation, optimisation = report.parts_of(subject)
    counts, parts = evaluation.counts, []
    if tight := (optimisation or evaluation).tight:
        parts.append(count_words(len(tight)))
    for name, value in evaluation.below_one.items():
        parts.append(f"{term_of(name)} factor {text.number(value, 3)} without a limit")
    if life := report.limited_life(evaluation):
        parts.append(life)
    if results := counts["extrapolated"] + counts["extrapolated_models"]:
        parts.append(f"{_count(results, 'result')} extrapolated (!)")
    skipped = sum(check.status == "not_checked" for check in evaluation.checks)
    if skipped:
        parts.append(f"{skipped} of {len(evaluation.checks)} checks not checked")
    if counts["unverified"]:
        parts.append(f"{counts['unverified']} library values unverified")
    if warnings := report.warnings(subject):
        parts.append(_count(len(warnings), "warning"))
    if optimisation is not None and evaluation.mass_leaves_out:
        parts.append(f"{_count(len(evaluation.mass_leaves_out), 'component')} not in the mass")
    if left_out := _not_in_stiffness(evaluation):
        parts.append(f"stiffness without {' or '.join(left_out)}")
    if parts:
        yield _line(f"care: {', '.join(parts)} {MORE}", "yellow")


def _not_in_stiffness(evaluation: Evaluation) -> list[str]:
    """Springs that the file does not state, if a stiffness is required."""
    cylinder = evaluation.design.cylinder
    if not any("stiffness" in row.metric for row in evaluation.requirements):
        return []
    oil = cylinder.dead_volume_a or cylinder.dead_volume_b or evaluation.design.lines
    springs = (("mounts", cylinder.mount_stiffness), ("oil in ports and hoses", oil))
    return [name for name, stated in springs if not stated]


def _next(subject: Evaluation | Optimisation, again: str, *, written: bool) -> Iterator[Block]:
    """The command that helps most from here."""
    evaluation, optimisation = report.parts_of(subject)
    movable = bool(evaluation.design.variables or evaluation.design.choices)
    known = evaluation.yield_estimate
    if optimisation is None:
        if movable:
            words = f"actuator-opt optimise {again}"
        elif evaluation.met:
            words = f"actuator-opt report {again}"
        else:
            words = f'state "variables" in the file, then actuator-opt optimise {again}'
    elif optimisation.infeasibility is not None:
        if not (settings := _settings(optimisation.infeasibility)):
            return
        words = f"actuator-opt optimise {again}{settings}"
        if optimisation.robust is not None:
            words += f" --yield {optimisation.robust.target:g}"
    elif not evaluation.met:
        return
    elif known.value is not None and known.value < 0.99 and optimisation.robust is None:
        words = f"actuator-opt optimise {again} --yield 0.99"
        words += "" if written else ", or --write FILE"
    elif written:
        return
    else:
        words = f"actuator-opt optimise {again} --write FILE"
    yield _line(f"next: {words}")
