"""A bending test as text for the terminal."""

from __future__ import annotations

from ..identification.bending import BendingResult
from ..least_squares import Parameter
from ..quantities import MATERIAL_PROPERTIES, METRICS
from . import text
from .console import Column, Console
from .optimum import sentence

_MODULUS, _SLOPE = MATERIAL_PROPERTIES["youngs_modulus"], METRICS["stiffness_rod"]


def bending_text(
    found: BendingResult, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `identify --span` shows: slope, modulus with and without shear, what to doubt."""
    console = Console(colour, unicode, width)
    name = console.paint(console.say(found.record.file_name), "bold")
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
    heads = ("three-point bending", "value", "lower", "upper", "verdict")
    columns = [Column(h, "left" if k in (0, 4) else "right", flexible=k == 0)
               for k, h in enumerate(heads)]  # fmt: skip
    said = [_what(found), *found.doubts]
    return "\n".join(
        [
            name,
            "",
            *console.table(columns, body),
            "",
            *(console.wrap(sentence(text.pretty(words))) for words in said),
            "",
        ]
    )


def _what(found: BendingResult) -> str:
    """Where the slope was taken."""
    first, last = (text.number(1e3 * v, 3) for v in found.deflections)
    words = f"{found.samples} samples between deflections of {first} and {last} mm"
    if found.strains is not None:
        low, high = (text.number(100 * v, 3) for v in found.strains)
        words += f" (strains of the outer fibre {low} to {high} %)"
    if found.hysteresis is not None:
        words += f"; {found.cycles} cycles lose {text.share_text(found.hysteresis)} of their work"
    if found.shear_share is not None:
        words += f"; shear deflects {text.share_text(found.shear_share)} of what bending does"
    return words
