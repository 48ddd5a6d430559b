"""Designs side by side as text: sentences, and tables that fit the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..base.quantities import Quantity
from ..design.kinds import Fraction
from ..evaluation.comparison import Change, Comparison, Question, Value
from ..evaluation.reserve import count_words
from ..metrics import of_metric
from ..rendering import text
from ..rendering.blocks import Column
from ..rendering.console import Console, visible
from ..rendering.text import DASH, number

_WORST = {"lighter": "light", "stiffer": "stiff", "smoother": "smooth"}
_NAMED = {"lighter": "mass", "stiffer": "stiffness", "smoother": "running friction"}
PART_UNITS = {"lighter": (1e3, "g"), "stiffer": (1e9, "µm/kN"), "smoother": (1.0, "N")}
"""Factor and unit in which the parts of each question are told."""
PART_TITLES = {
    "lighter": "Mass",
    "stiffer": "Compliance at the weakest position",
    "smoother": "Running friction",
}
_MOST_PARTS = 4
_LONGEST = 18
"""Letters of an input's value: a longer word would hide the PATHs."""
_GAP = 2
"""Columns between two of a table."""


def sentences(found: Comparison) -> list[str]:
    """The answer to each question, then what to know before believing it."""
    said = [answer(found, question) for question in found.questions]
    damping = [e.metrics["damping_ratio"].value for e in found.evaluations]
    if len(set(damping)) > 1:
        values = ", ".join(
            f"{x} {number(v, 3)}" for x, v in zip(found.labels, damping, strict=True)
        )
        said.append(f"damping ratio: {values}")
    for label, one in zip(found.labels, found.evaluations, strict=True):
        missed = [row.name for row in one.requirements if not row.met]
        if missed:
            said.append(f"{label} misses {len(missed)} of its requirements: {', '.join(missed)}")
    return [*said, *optimality(found, remedy=True), *unlike(found), *duties(found)]


def unlike(found: Comparison) -> list[str]:
    """Metrics whose values are not of the same kind, and why."""
    said = []
    for metric, senses in found.unlike.items():
        least, most = (
            ", ".join(x for x, own in zip(found.labels, senses, strict=True) if own == sense)
            for sense in ("min", "max")
        )
        said.append(
            f"{metric}: the smallest value of {least} and the largest of {most} govern, so that "
            f"they cannot be compared"
        )
    return said


def optimality(found: Comparison, *, remedy: bool = False) -> list[str]:
    """Which designs are not known to be optima, and with `remedy` how to optimise them."""
    labels = [found.labels[k] for k in found.not_optimised]
    if not labels:
        return []
    many = len(labels) > 1
    who = f"{', '.join(labels[:-1])} and {labels[-1]}" if many else labels[0]
    said = (
        f"{who} {'are' if many else 'is'} not known to be {'optima' if many else 'an optimum'}: "
        "the differences may not be those of the best designs"
    )
    can = any(
        found.states[k].status is None and found.evaluations[k].design.variables
        for k in found.not_optimised
    )
    return [f"{said}; --optimise optimises each design first" if remedy and can else said]


def duties(found: Comparison) -> list[str]:
    """That designs do not do the same work, where they do not."""
    paths = found.duties_differ
    if not paths:
        return []
    more = f" and {len(paths) - 3} more" if len(paths) > 3 else ""
    return [f"their duties differ ({', '.join(paths[:3])}{more}): each is judged at its own"]


def part_name(part: str) -> str:
    """A part in words; a chamber is told apart from a design of the same letter.

    >>> part_name("piston_seal"), part_name("oil A")
    ('piston seal', 'oil in chamber A')
    """
    words = part.replace("_", " ")
    return words.replace("oil ", "oil in chamber ") if words in ("oil A", "oil B") else words


def answer(found: Comparison, question: Question) -> str:
    """One question in a sentence, with the parts that decide it."""
    name, quantity = question.name, of_metric(question.metric)
    unknown = [k for k, value in enumerate(question.values) if value is None]
    note = ""
    if unknown:
        labels = ", ".join(found.labels[k] for k in unknown)
        why = found.evaluations[unknown[0]].metrics[question.metric].why or "not computed"
        note = f"; {_NAMED[name]} of {labels} is not known: {why}"
    if question.metric in found.unlike:
        return f"{name}: cannot be said{note}"
    if question.best is None or question.other is None:
        if len(unknown) + 1 >= len(question.values):
            return f"{name}: cannot be said{note}"
        return f"{name}: none, all are equally {_WORST[name]}{note}"
    best, other = (question.values[k] or 0.0 for k in (question.best, question.other))
    equal = [found.labels[k] for k in question.leaders]
    change = 100 * (best / other - 1) if other else 0.0
    values = f"{text.value_text(quantity, best)} against {text.value_text(quantity, other)}"
    head = f"{name}: {' and '.join(equal)}, {values} of {found.labels[question.other]}"
    return f"{head} ({number(change, 3, signed=True)} %){_parts(question)}{note}"


def _parts(question: Question) -> str:
    """The parts that change most on the way to the better design."""
    scale, unit = PART_UNITS[question.name]
    steps = question.steps
    if not steps:
        return ""
    floor = 0.02 * abs(steps[0][1])
    told = [(part, step) for part, step in steps if abs(step) >= floor]
    words = [
        f"{part_name(part)} {number(scale * step, 3, signed=True)} {unit}"
        for part, step in told[:_MOST_PARTS]
    ]
    where = " of compliance" if question.name == "stiffer" else ""
    return f": {', '.join(words)}{where}"


def comparison_text(
    found: Comparison, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """Everything, for the terminal."""
    console = Console(colour, unicode, width)
    lines = []
    for k, label in enumerate(found.labels):
        lines.append(console.wrap(f"{label}  {named(found, k)}", "bold"))
    lines += ["", *(console.wrap(text.pretty(said)) for said in sentences(found))]
    changes = [
        [c.path, *(console.cut(shown(c, v), _LONGEST) for v in c.values)]
        for c in found.changes
        if not c.path.startswith("requirements.")  # their own table follows
    ]
    lines += _tables(console, found, "What differs in the inputs", changes)
    lines += _tables(console, found, "Requirements", list(_requirements(found)))
    lines += _tables(console, found, "Metrics that differ", list(_metrics(found)))
    for question in found.questions:
        scale, unit = PART_UNITS[question.name]
        rows = [
            [part_name(part), *(number(scale * x, 4) if x else DASH for x in values)]
            for part, values in question.parts.items()
        ]
        sums = [sum(column) for column in zip(*question.parts.values(), strict=True)]
        if rows:
            rows.append(["sum", *(number(scale * x, 4) for x in sums)])
            lines += _tables(console, found, f"{PART_TITLES[question.name]}, {unit}", rows)
    return "\n".join(lines) + "\n"


def named(found: Comparison, k: int) -> str:
    """A design's name, its origin, whether it is an optimum and meets its requirements."""
    one, origin, own = found.evaluations[k], found.origins[k], found.states[k]
    beside = "" if origin == one.name else f" ({origin})"
    state = "optimum" if own.optimum else "evaluated, not optimised"
    if own.status is not None and not own.optimum:
        state = f"no optimum (search: {own.status.replace('_', ' ')})"
    verdict = f"requirements {'met' if one.met else 'missed'}"
    if one.met and one.tight:
        verdict += f", {count_words(len(one.tight))}"
    return f"{one.name}{beside}, {state}, {verdict}"


def shown(change: Change, value: Value) -> str:
    """A value of an input as people read it."""
    if value is None:
        return DASH
    if isinstance(value, Fraction):
        return f"{100 * value.value:.4g} %"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    return number(value) if change.quantity is None else text.value_text(change.quantity, value)


def _requirements(found: Comparison) -> Iterator[list[str]]:
    """Limit and value of each; a missed one is marked."""
    for name, sense, rows in found.limits():
        known = [row for row in rows if row is not None]
        quantity = found.evaluations[rows.index(known[0])].metrics[known[0].metric].quantity
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


def _metrics(found: Comparison) -> Iterator[list[str]]:
    """Every metric that is not the same to the digits shown."""
    for name, quantity, values in found.metrics():
        cells = [_metric(quantity, value) for value in values]
        if len(set(cells)) > 1:
            yield [name, *cells]


def _metric(quantity: Quantity, value: float | None) -> str:
    return DASH if value is None else text.value_text(quantity, value)


def _tables(
    console: Console, found: Comparison, title: str, rows: Sequence[Sequence[str]]
) -> list[str]:
    """A table, in pieces where the terminal is too narrow for all designs; A stands in each."""
    if not rows:
        return ["", console.heading(title), "none"]
    sizes = [max(visible(console.say(row[k])) for row in rows) for k in range(len(rows[0]))]
    others = list(range(1, len(found.labels)))
    lines: list[str] = []
    while others:
        piece, left = [0], console.width - sizes[0] - sizes[1] - _GAP
        while others and (len(piece) < 2 or left >= sizes[others[0] + 1] + _GAP):
            left -= sizes[others[0] + 1] + _GAP
            piece.append(others.pop(0))
        columns = [Column("", width=1.0, least=10)]
        columns += [Column(found.labels[k], "right", width=1.0, least=8) for k in piece]
        cells = [[row[0], *(row[k + 1] for k in piece)] for row in rows]
        lines += ["", console.heading(title), *console.table(columns, cells)]
    return lines
