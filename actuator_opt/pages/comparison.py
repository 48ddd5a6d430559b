"""The page of a comparison: which design is better and why, bars, stiffness curves, tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..base.quantities import Quantity
from ..design.kinds import Fraction
from ..evaluation.comparison import Change, Comparison, Question, Value
from ..evaluation.result import count_words
from ..metrics import METRICS, of_metric, term_of
from ..rendering import text
from ..rendering.axes import AREAS
from ..rendering.blocks import (
    Block,
    Chart,
    Column,
    Notes,
    Page,
    Table,
    Tile,
    Verdict,
    short,
    tile,
)
from ..rendering.chart_ink import titled
from ..rendering.heights import wrap
from ..rendering.ink import BLACK, GREY, Ink, text_width
from ..rendering.text import DASH, number, pretty, trimmed
from .stiffness import fills
from .sweep_figures.ucurves import MOST, Required, has_points, stiffness_panels

_WORST = {"lighter": "light", "stiffer": "stiff", "smoother": "smooth"}
_NAMED = {"lighter": "mass", "stiffer": "stiffness", "smoother": "running friction"}
PART_UNITS = {"lighter": (1e3, "g"), "stiffer": (1e9, "µm/kN"), "smoother": (1.0, "N")}
"""For each question (which design is lighter, stiffer, smoother): factor from SI to the unit of the
bars, and this unit."""
PART_TITLES = {
    "lighter": "Mass",
    "stiffer": "Compliance at the weakest position",
    "smoother": "Running friction",
}
_MOST_PARTS = 4
"""Largest number of parts named in a sentence."""
_LONGEST = 18
"""Largest number of characters printed of a value of an input; longer values would leave no space
for the PATHs."""

_WIDTH, _RIGHT = 180.0, 20.0
_STEP, _LEAST_STEP, _SHARE, _LINE = 7.6, 3.8, 5.6 / 7.6, 4.2
"""Usual and least spacing of bars [mm], bar height as a share of the spacing, and line height [mm].
"""
_GAP, _TOP, _SMALL = 5.0, 8.4, 3.3
_NOTE = "The parts of each bar are in the order of the key. Bold: best value."


def page(comparison: Comparison) -> Page:
    """The page that compares designs side by side."""
    return Page(
        name="Designs side by side",
        kind="Comparison",
        verdict=_verdict(comparison),
        sentence="",
        tiles=list(_tiles(comparison)),
        hero=lambda room: _hero(comparison, room),
        blocks=list(_blocks(comparison)),
        least=_least(comparison),
    )


def _verdict(comparison: Comparison) -> Verdict:
    """Badge at the top: how many designs meet their requirements."""
    every = len(comparison.labels)
    met = sum(evaluation.met for evaluation in comparison.evaluations)
    words = f"{met} OF {every} MEET THEIR REQUIREMENTS"
    return Verdict("met" if met == every else "missed", words)


def _tiles(comparison: Comparison) -> Iterator[Tile]:
    """For every question, the best design and its value."""
    for question in comparison.questions:
        if question.best is None:
            continue
        leaders = " and ".join(comparison.labels[k] for k in question.leaders)
        value = text.value_text(of_metric(question.metric), question.values[question.best])
        yield tile(question.name, value, leaders)


def _blocks(comparison: Comparison) -> Iterator[Block]:
    designs = [f"{label}  {named(comparison, k)}" for k, label in enumerate(comparison.labels)]
    yield Notes("Designs", designs, headless=True, style="bold")
    yield Notes("Which is better", [pretty(line) for line in sentences(comparison)], headless=True)
    if _with_curves(comparison):
        yield _curves(comparison)
    changes = [
        [change.path, *(short(shown(change, value), _LONGEST) for value in change.values)]
        for change in comparison.changes
        if not change.path.startswith("requirements.")  # requirements have their own table
    ]
    yield _table(comparison, "What differs in the inputs", changes)
    yield _table(comparison, "Requirements", list(_requirements(comparison)))
    yield _table(comparison, "Metrics that differ", list(_metrics(comparison)))
    for question in comparison.questions:
        scale, unit = PART_UNITS[question.name]
        rows = [
            [part_name(part), *(number(scale * x, 4) if x else DASH for x in values)]
            for part, values in question.parts.items()
        ]
        sums = [sum(column) for column in zip(*question.parts.values(), strict=True)]
        if rows:
            rows.append(["sum", *(number(scale * x, 4) for x in sums)])
            yield _table(comparison, f"{PART_TITLES[question.name]}, {unit}", rows, total=1)


def _table(
    comparison: Comparison, title: str, rows: Sequence[Sequence[str]], total: int = 0
) -> Block:
    """Table with a column per design.

    A table that is too wide is split; each part repeats the column of design A.
    """
    if not rows:
        return Notes(title, ["none"])
    columns = [Column("", width=2.0, breaks=30, least=10)]
    columns += [Column(label, "right", width=1.0, least=8) for label in comparison.labels]
    return Table(title, columns, rows, total=total, repeat=2)


# ---- words ----


def sentences(comparison: Comparison) -> list[str]:
    """The answer to each question, damping, life, missed requirements and reservations."""
    lines = [answer(comparison, question) for question in comparison.questions]
    for name in ("damping_ratio", "cycle_life"):
        known = [e.metrics[name].value for e in comparison.evaluations]
        texts = [DASH if value is None else number(value, 3) for value in known]
        if len(set(texts)) > 1:
            pairs = zip(comparison.labels, texts, strict=True)
            lines.append(f"{term_of(name)}: {', '.join(map(' '.join, pairs))}")
    for label, evaluation in zip(comparison.labels, comparison.evaluations, strict=True):
        missed = [row.name for row in evaluation.requirements if not row.met]
        if missed:
            lines.append(f"{label} misses {len(missed)} of its requirements: {', '.join(missed)}")
    lines += below_one(comparison)
    lines += [*optimality(comparison, remedy=True), *unlike(comparison), *conditions(comparison)]
    return lines


def below_one(comparison: Comparison) -> list[str]:
    """Sentence on factors below 1, of strength by load, for which the design has no limit."""
    below: dict[str, list[str]] = {}
    for label, evaluation in zip(comparison.labels, comparison.evaluations, strict=True):
        for name, value in evaluation.below_one.items():
            below.setdefault(name, []).append(f"{label} {number(value, 3)}")
    words = "; ".join(f"{name} {', '.join(values)}" for name, values in below.items())
    return [f"below 1, but without a limit: {words}"] if words else []


def unlike(comparison: Comparison) -> list[str]:
    """Sentences on metrics that cannot be compared between the designs.

    The worst value of such a metric is the smallest for some designs and the largest for others.
    """
    lines = []
    for metric, senses in comparison.unlike.items():
        least, most = (
            ", ".join(x for x, own in zip(comparison.labels, senses, strict=True) if own == sense)
            for sense in ("min", "max")
        )
        lines.append(
            f"{metric}: cannot be compared, because the worst value is the smallest for "
            f"{least}, but the largest for {most}"
        )
    return lines


def optimality(comparison: Comparison, *, remedy: bool = False) -> list[str]:
    """Sentence on designs not known to be optima; `remedy` adds the option that optimises them."""
    labels = [comparison.labels[k] for k in comparison.not_optimised]
    if not labels:
        return []
    many = len(labels) > 1
    names = f"{', '.join(labels[:-1])} and {labels[-1]}" if many else labels[0]
    words = (
        f"{names} {'are' if many else 'is'} not known to be "
        f"{'optima' if many else 'an optimum'}: after optimisation, the comparison may differ"
    )
    can = any(
        comparison.states[k].status is None and comparison.evaluations[k].design.variables
        for k in comparison.not_optimised
    )
    return [f"{words}; --optimise optimises each design first" if remedy and can else words]


def conditions(comparison: Comparison) -> list[str]:
    """A remark if the designs have different operating conditions; empty if all are equal."""
    paths = comparison.differing_conditions
    if not paths:
        return []
    more = f" and {len(paths) - 3} more" if len(paths) > 3 else ""
    return [
        (
            f"their operating conditions differ ({', '.join(paths[:3])}{more}): each design is "
            "judged at its own"
        )
    ]


def part_name(part: str) -> str:
    """A part in words; the word "chamber" separates oil chamber A from design A.

    >>> part_name("piston_seal"), part_name("oil A")
    ('piston seal', 'oil in chamber A')
    """
    words = part.replace("_", " ")
    return words.replace("oil ", "oil in chamber ") if words in ("oil A", "oil B") else words


def answer(comparison: Comparison, question: Question) -> str:
    """The answer to a question in a sentence, with the parts that decide it."""
    name, quantity = question.name, of_metric(question.metric)
    unknown = [k for k, value in enumerate(question.values) if value is None]
    note = ""
    if unknown:
        labels = ", ".join(comparison.labels[k] for k in unknown)
        why = comparison.evaluations[unknown[0]].metrics[question.metric].why or "not computed"
        note = f"; {_NAMED[name]} of {labels} is not known: {why}"
    if question.metric in comparison.unlike:
        return f"{name}: not known{note}"
    if question.best is None or question.other is None:
        if len(unknown) + 1 >= len(question.values):
            return f"{name}: not known{note}"
        return f"{name}: none, as all are equally {_WORST[name]}{note}"
    best, other = (question.values[k] or 0.0 for k in (question.best, question.other))
    equal = [comparison.labels[k] for k in question.leaders]
    change = 100 * (best / other - 1) if other else 0.0
    values = f"{text.value_text(quantity, best)} against {text.value_text(quantity, other)}"
    head = f"{name}: {' and '.join(equal)}, {values} for {comparison.labels[question.other]}"
    return f"{head} ({number(change, 3, signed=True)} %){_parts(question)}{note}"


def _parts(question: Question) -> str:
    """Clause on the parts that contribute most to the difference from the better design."""
    scale, unit = PART_UNITS[question.name]
    steps = question.steps
    if not steps:
        return ""
    floor = 0.02 * abs(steps[0][1])
    words = [
        f"{part_name(part)} {number(scale * step, 3, signed=True)} {unit}"
        for part, step in [row for row in steps if abs(row[1]) >= floor][:_MOST_PARTS]
    ]
    where = " of compliance" if question.name == "stiffer" else ""
    return f": {', '.join(words)}{where}"


def named(comparison: Comparison, k: int) -> str:
    """A design's name and file, whether it is an optimum, and whether it meets its requirements."""
    evaluation, state = comparison.evaluations[k], comparison.states[k]
    origin = comparison.origins[k]
    beside = "" if origin == evaluation.name else f" ({origin})"
    optimum = "optimum" if state.optimum else "evaluated, not optimised"
    if state.status is not None and not state.optimum:
        optimum = f"no optimum (search: {state.status.replace('_', ' ')})"
    verdict = f"requirements {'met' if evaluation.met else 'missed'}"
    if evaluation.met and evaluation.tight:
        verdict += f", {count_words(len(evaluation.tight))}"
    return f"{evaluation.name}{beside}, {optimum}, {verdict}"


def shown(change: Change, value: Value) -> str:
    """A value of an input as printed."""
    if value is None:
        return DASH
    if isinstance(value, Fraction):
        return f"{100 * value.value:.4g} %"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    return number(value) if change.quantity is None else text.value_text(change.quantity, value)


def _requirements(comparison: Comparison) -> Iterator[list[str]]:
    """Limit and value of every requirement; missed requirements are marked."""
    for name, sense, rows in comparison.limits():
        known = [row for row in rows if row is not None]
        quantity = comparison.evaluations[rows.index(known[0])].metrics[known[0].metric].quantity
        limits = {row.limit for row in known}
        common = len(limits) == 1 and len(known) == len(rows)
        head = f"{name} {text.limit_text(quantity, sense, known[0].limit)}" if common else name
        cells = []
        for row in rows:
            if row is None:
                cells.append(DASH)
                continue
            own = "" if common else f" ({text.limit_text(quantity, sense, row.limit)})"
            mark = "" if row.met else " !"
            cells.append(f"{text.value_text(quantity, row.value)}{own}{mark}")
        yield [head, *cells]


def _metrics(comparison: Comparison) -> Iterator[list[str]]:
    """Every metric whose printed values differ between the designs."""
    for name, quantity, values in comparison.metrics():
        cells = [_metric(quantity, value) for value in values]
        if len(set(cells)) > 1:
            yield [name, *cells]


def _metric(quantity: Quantity, value: float | None) -> str:
    return DASH if value is None else text.value_text(quantity, value)


# ---- figures ----


def comparison_figure(comparison: Comparison) -> Ink:
    """For every question, a bar to scale for each design; a part has one fill in every bar.

    The figure is drawn directly, because a `Chart` has no stacked bars with sums and a key of the
    parts.
    """
    questions = _with_bars(comparison)
    heads = [wrap(named(comparison, k), _WIDTH - 12.0, 7.0) for k in range(len(comparison.labels))]
    remarks = (_NOTE, *conditions(comparison), *optimality(comparison))
    notes = [line for words in remarks for line in _wrapped(words)]
    answers = [_wrapped(answer(comparison, question)) for question in questions]
    above = _TOP + 1.0 + _LINE * sum(map(len, heads)) + _SMALL * len(notes) + 4.0
    ink = Ink(_WIDTH, 400.0)
    ink.text(4.0, 4.0, "Designs side by side", size=9.0, bold=True)
    top = _TOP
    for line in notes:
        ink.text(4.0, top, line, color=GREY)
        top += _SMALL
    top += 1.0
    for label, lines in zip(comparison.labels, heads, strict=True):
        ink.text(4.0, top, label, size=7.5, bold=True)
        for line in lines:
            ink.text(9.0, top, line, size=7.0)
            top += _LINE
    top, heights = above, list[float]()
    for question, lines in zip(questions, answers, strict=True):
        heights.append(_bars(ink, comparison, question, top, lines))
        top += heights[-1]
    ink.height = above + sum(heights) + 2.0
    return ink


def _hero(comparison: Comparison, room: float) -> Ink:
    """The bars alone; their spacing shrinks to fit many designs into the available height [mm]."""
    questions = _with_bars(comparison)
    rows = len(questions) * len(comparison.labels)
    ink = Ink(_WIDTH, 400.0)
    step = (room - _fixed(questions)) / rows if rows else _STEP
    top = 0.0
    for question in questions:
        top += _bars(ink, comparison, question, top, (), min(max(step, _LEAST_STEP), _STEP))
    ink.height = max(top, 1.0)
    return ink


def _least(comparison: Comparison) -> float:
    """Height that the bars need [mm]."""
    questions = _with_bars(comparison)
    return _fixed(questions) + _LEAST_STEP * len(questions) * len(comparison.labels)


def _fixed(questions: Sequence[Question]) -> float:
    """Height of everything except the bars [mm]."""
    return sum(7.0 + _LINE * len(_legend(list(question.parts))) + _GAP for question in questions)


def _with_bars(comparison: Comparison) -> list[Question]:
    """Questions for which the contribution of each part of the design is known."""
    return [question for question in comparison.questions if any(map(sum, question.parts.values()))]


def comparison_ucurves(comparison: Comparison) -> Ink | None:
    """Stiffness over the stroke of the first `MOST` designs; None if no design has this curve."""
    if not _with_curves(comparison):
        return None
    names = [f"{label}: {named(comparison, k)}" for k, label in enumerate(comparison.labels[:MOST])]
    notes = [pretty(words[:1].upper() + words[1:]) for words in optimality(comparison)]
    return titled(_curves(comparison), [*notes, *names])


def _with_curves(comparison: Comparison) -> bool:
    """Whether any of the drawn designs has a curve of stiffness over the stroke."""
    return any(has_points(evaluation.curve) for evaluation in comparison.evaluations[:MOST])


def _curves(comparison: Comparison) -> Chart:
    """Stiffness over the stroke of the first `MOST` designs."""
    labels = []
    evaluations = comparison.evaluations[:MOST]
    for label, evaluation in zip(comparison.labels, evaluations, strict=False):
        least = evaluation.metrics["stiffness_min"].value
        labels.append(label if least is None else f"{label}: least {number(least / 1e6, 4)}")
    curves = [evaluation.curve for evaluation in evaluations]
    panels = stiffness_panels(curves, labels, _required(comparison), "A")
    return Chart("Stiffness over the stroke", [panels], height=140.0)


def _required(comparison: Comparison) -> list[Required]:
    """The required stiffness, with the designs' letters if it does not apply to all of them."""
    required: dict[float, list[str]] = {}
    for _, sense, rows in comparison.limits():
        for label, row in zip(comparison.labels, rows, strict=True):
            if row is not None and row.metric == "stiffness_min" and sense == "min":
                required.setdefault(row.limit, []).append(label)
    every = len(comparison.labels)
    return [
        Required(
            value,
            f"≥ {trimmed(METRICS['stiffness_min'].to_display(value))}"
            + (f" of {', '.join(labels)}" if len(labels) < every else ""),
        )
        for value, labels in required.items()
    ]


def _wrapped(said: str) -> list[str]:
    return wrap(pretty(said[:1].upper() + said[1:]), _WIDTH - 8.0, 6.5)


def _legend(parts: list[str]) -> list[list[str]]:
    """Names of parts for the key, broken into lines that fit the width."""
    lines: list[list[str]] = [[]]
    used = 0.0
    for part in parts:
        wide = text_width(part_name(part), 6.5) + 8.0
        if lines[-1] and used + wide > _WIDTH - 8.0:
            lines.append([])
            used = 0.0
        lines[-1].append(part)
        used += wide
    return lines


def _bars(
    ink: Ink,
    comparison: Comparison,
    question: Question,
    top: float,
    said: Sequence[str],
    step: float = _STEP,
) -> float:
    """Draw the title, a stacked bar with its sum for each design, and the key.

    Returns the height used.
    """
    scale, unit = PART_UNITS[question.name]
    parts, tall = list(question.parts), _SHARE * step
    shades = fills(parts) if question.name == "stiffer" else range(len(parts))
    paints = {part: AREAS[k % len(AREAS)] for part, k in zip(parts, shades, strict=True)}
    sums = [sum(column) for column in zip(*question.parts.values(), strict=True)]
    room = _WIDTH - 9.0 - _RIGHT
    ink.text(4.0, top + 2.0, f"{PART_TITLES[question.name]}, {unit}", size=7.5, bold=True)
    y = top + 6.0
    for line in said:
        ink.text(4.0, y, line, color=GREY)
        y += _SMALL
    for k, label in enumerate(comparison.labels):
        best = k in question.leaders
        ink.text(4.0, y + tall / 2, label, size=7.0, bold=best)
        x = 9.0
        for part, values in question.parts.items():
            wide = max(values[k], 0.0) / max(sums) * room
            if wide <= 0:
                continue
            ink.box(x, y, wide, tall, fill=paints[part], stroke="#ffffff", pen=0.12)
            x += wide
        ink.line((9.0, y - 0.6), (9.0, y + tall + 0.6), stroke=BLACK, pen=0.18)
        ink.text(x + 1.5, y + tall / 2, number(scale * sums[k], 4), size=7.0, bold=best)
        y += step
    for names in _legend(parts):
        x = 9.0
        for part in names:
            ink.box(x, y + 0.2, 2.4, 2.4, fill=paints[part], stroke=GREY, pen=0.1)
            ink.text(x + 3.6, y + 1.4, part_name(part), size=6.5)
            x += text_width(part_name(part), 6.5) + 8.0
        y += _LINE
    lines = len(said), len(_legend(parts))
    return 7.0 + _SMALL * lines[0] + step * len(comparison.labels) + _LINE * lines[1] + _GAP
