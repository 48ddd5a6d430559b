"""What a calibration says in numbers and sentences, for paper and terminal alike."""

from __future__ import annotations

from typing import NamedTuple

from ..base.quantities import INPUTS, Quantity
from ..evaluation.reserve import count_words
from ..identification.calibration import Calibration
from ..optimisation.redesign import Redesign, Shift, solved
from ..rendering import text
from ..rendering.blocks import State
from ..rendering.text import sentence

LEARNED_HEADS = ("value", "stated", "measured", "lower", "upper", "from")
SHIFT_HEADS = ("requirement", "limit", "as stated", "as measured", "lower", "upper", "verdict")
OPTIMUM_HEADS = ("best design", "as stated", "as measured", "change")


class Line(NamedTuple):
    """A row of cells; `state` is met, missed or empty."""

    cells: tuple[str, ...]
    state: State = ""


def learned(found: Calibration) -> list[Line]:
    """Every number the record gave, with its bounds and what stood there before."""
    lines = []
    for one in found.learned:
        quantity = INPUTS[one.name]
        bounds = one.bounds()
        for path, value in one.values().items():
            numbers = (one.before[path], value, *bounds[path])
            cells = [text.value_text(quantity, number, 3) for number in numbers]
            lines.append(Line((path, *cells, one.source)))
    return lines


def shifts(found: Redesign, *, moved: bool = False) -> list[Line]:
    """Requirements before and after, the one that moved most first; `moved`: none that did not."""
    ordered = sorted(found.shifts, key=lambda one: -abs(one.move))
    return [_shift(one) for one in ordered if one.move != 0 or not moved]


def _shift(one: Shift) -> Line:
    quantity = text.metric(one.after.metric)
    values = (one.before.value, one.after.value, one.lower, one.upper)
    cells = [text.value_text(quantity, value) for value in values]
    if one.move == 0:
        cells[1:] = ["same", "", ""]
    limit = text.limit_text(quantity, one.after.sense, one.after.limit)
    state = one.after.state
    return Line((one.after.name, limit, *cells, one.verdict), state)


def optimum(found: Redesign) -> list[Line]:
    """Objective, choices and variables of the best designs before and after."""
    before, after = found.best_before, found.best_after
    if before is None or after is None:
        return []
    lines = [_line(one.metric, one.quantity, one.before, one.after, 5) for one in found.goals]
    if not (solved(before) and solved(after)):
        return lines
    if after.choices is not None:
        chosen = {} if before.choices is None else before.choices.best
        lines += [
            Line((path, str(chosen.get(path, text.DASH)), str(value), ""))
            for path, value in after.choices.best.items()
        ]
    was = {one.path: one.value for one in before.variables}
    return lines + [
        _line(one.path, INPUTS[one.quantity], was.get(one.path), one.value, 4)
        for one in after.variables
    ]


def _line(name: str, quantity: Quantity, old: float | None, new: float | None, digits: int) -> Line:
    values = [text.value_text(quantity, value, digits) for value in (old, new)]
    return Line((name, *values, _change(old, new)))


def _change(old: float | None, new: float | None) -> str:
    if old is None or new is None or old == 0:
        return text.DASH
    return text.margin_text(new / old - 1)


def what(found: Calibration) -> str:
    """The record and its outcome in one sentence."""
    own = found.identification
    ratio = found.coulomb / found.stated
    return (
        f"Record {own.record.file_name}: Coulomb friction is {100 * ratio:.0f} % of what the "
        f"design states at the record's pressures, {text.number(found.coulomb)} N instead of "
        f"{text.number(found.stated)} N."
    )


def tight(changes: Redesign) -> int:
    """Limits without reserve of the best design with the measured values, where there is one."""
    best = changes.best_after
    return len(best.tight) if best is not None and solved(best) else 0


def remarks(found: Calibration, changes: Redesign) -> list[str]:
    """What changed, what was left, what it all rests on."""
    said = list(changes.sentences)
    if count := tight(changes):
        said.append(f"{count_words(count)} at the best design: it lies on its limits")
    said += [f"{key} stays as the design says: {why}" for key, why in found.left.items()]
    said += found.doubts
    return [sentence(text.pretty(words)) for words in dict.fromkeys(said)]
