"""A bending test as text for the terminal."""

from __future__ import annotations

from ..base.fitting import Parameter
from ..base.quantities import MATERIAL_PROPERTIES
from ..identification.bending import BendingResult
from ..metrics import METRICS
from ..rendering import text
from ..rendering.blocks import Column
from ..rendering.console import Console, visible
from ..rendering.text import sentence

_MODULUS, _SLOPE = MATERIAL_PROPERTIES["youngs_modulus"], METRICS["stiffness_rod"]
_HEADS = ("three-point bending", "value", "lower", "upper", "verdict")


def bending_text(
    found: BendingResult, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `identify --span` shows: slope, modulus with and without shear, what to doubt."""
    console = Console(colour, unicode, width)
    known = (*_told(found), *found.record.notes)
    lines = [console.heading(found.record.file_name), "", *_values(found, console), ""]
    lines += [console.wrap(sentence(text.pretty(words))) for words in known]
    if found.doubts:
        lines += ["", console.heading("What to doubt")]
        lines += [console.wrap(sentence(text.pretty(words))) for words in found.doubts]
    return "\n".join((*lines, ""))


def _values(found: BendingResult, console: Console) -> list[str]:
    """Slope and moduli with bounds: a table, or a paragraph each on a narrow terminal."""
    rows: list[tuple[str, Parameter]] = [
        ("slope of force over deflection", found.slope),
        ("modulus, nothing taken off", found.as_published),
    ]
    if found.taken_off:
        rows.append((f"modulus, {' and '.join(found.taken_off)} taken off", found.modulus))
    body = []
    for words, one in rows:
        quantity = _SLOPE if one is found.slope else _MODULUS
        numbers = (one.value, one.lower, one.upper)
        body.append([words, *(text.value_text(quantity, v) for v in numbers), one.verdict])
    columns = [Column(h, "left" if k in (0, 4) else "right") for k, h in enumerate(_HEADS)]
    bare = Console(False, console.unicode, console.width).table(columns, body)
    if max(map(visible, bare)) <= console.width:
        return console.table(columns, body)
    told = [f"{words}: {value} ({low} to {high}), {verdict}"
            for words, value, low, high, verdict in body]  # fmt: skip
    return [console.heading(_HEADS[0]), *(console.wrap(sentence(one)) for one in told)]


def _told(found: BendingResult) -> list[str]:
    """Where the slope was taken, what its bounds hold, what was lost and what shear does."""
    first, last = (text.number(1e3 * v, 3) for v in found.deflections)
    where = f"the slope is that of {found.samples} samples, deflections from {first} to {last} mm"
    if found.strains is not None:
        low, high = (text.number(100 * v, 3) for v in found.strains)
        where += f", strains of the outer fibre from {low} to {high} %"
    section = (
        "the second moment once"
        if found.specimen.outer_diameter is None
        else "the outer diameter four times or more"
    )
    words = [
        where,
        "the bounds are of 95 %, for the noise of the record; beside it an error of the span "
        f"counts three times, one of {section}",
    ]
    if found.hysteresis is not None:
        cycles = "the cycle loses" if found.cycles == 1 else f"{found.cycles} cycles lose"
        words.append(f"{cycles} {text.share_text(found.hysteresis)} of the work done on loading")
    if found.shear_share is not None:
        words.append(f"shear deflects {text.share_text(found.shear_share)} of what bending does")
    return words
