"""The page of a bending test: slope and moduli, each with confidence interval, and doubts."""

from __future__ import annotations

from collections.abc import Iterator

from ..base.fitting import Parameter
from ..base.quantities import MATERIAL_PROPERTIES
from ..identification.bending import BendingResult
from ..metrics import METRICS
from ..rendering import text
from ..rendering.blocks import Block, Chart, Column, Notes, Page, State, Table, Tile, Verdict, tile
from ..rendering.chart import Axis, Curve, Panel
from ..rendering.chart_ink import drawn
from ..rendering.ink import Ink
from ..rendering.text import sentence

_MODULUS, _SLOPE = MATERIAL_PROPERTIES["youngs_modulus"], METRICS["stiffness_rod"]
_STATES: dict[str, State] = {
    "identifiable": "met",
    "weakly identifiable": "checks",
    "not identifiable": "missed",
}


def page(bending: BendingResult) -> Page:
    """The page of a bending test."""
    modulus = bending.modulus if bending.taken_off else bending.as_published
    first, last = (text.number(1e3 * v, 3) for v in bending.deflections)
    return Page(
        name=bending.record.file_name,
        kind="Modulus by a three-point bending test",
        verdict=Verdict(_STATES[modulus.verdict], f"MODULUS {modulus.verdict.upper()}"),
        sentence=(
            f"The slope is fitted to {bending.samples} samples, with deflections from "
            f"{first} to {last} mm{_strains(bending)}."
        ),
        tiles=[_tile(words, parameter, bending) for words, parameter in _parameters(bending)],
        hero=lambda room: _loop(bending, room),
        blocks=list(_blocks(bending)),
    )


def _strains(bending: BendingResult) -> str:
    if bending.strains is None:
        return ""
    low, high = (text.number(100 * v, 3) for v in bending.strains)
    return f" and strains of the outer fibre from {low} to {high} %"


def _parameters(bending: BendingResult) -> list[tuple[str, Parameter]]:
    """Slope, and the modulus before and after the known compliances are subtracted."""
    rows = [
        ("slope of force versus deflection", bending.slope),
        ("modulus, no compliance subtracted", bending.as_published),
    ]
    if bending.taken_off:
        rows.append(
            (f"modulus, with {' and '.join(bending.taken_off)} subtracted", bending.modulus)
        )
    return rows


def _numbers(parameter: Parameter, bending: BendingResult) -> list[str]:
    """Value and confidence interval with their unit."""
    quantity = _SLOPE if parameter is bending.slope else _MODULUS
    values = (parameter.value, parameter.lower, parameter.upper)
    return [text.value_text(quantity, value) for value in values]


def _tile(words: str, parameter: Parameter, bending: BendingResult) -> Tile:
    value, low, high = _numbers(parameter, bending)
    return tile(words, value, f"95 %: {low} to {high}")


def _blocks(bending: BendingResult) -> Iterator[Block]:
    rows = [
        (words, *_numbers(parameter, bending), parameter.verdict)
        for words, parameter in _parameters(bending)
    ]
    columns = [
        Column("three-point bending", "left", 1.0),
        Column("value", "right", strong=True),
        *(Column(head, "right") for head in ("lower", "upper")),
        Column("verdict"),
    ]
    yield Table("Slope and modulus, 95 % bounds", columns, rows, on="paper")
    lines = [
        sentence(f"{words}: {value} ({low} to {high}), {verdict}")
        for words, value, low, high, verdict in rows
    ]
    yield Notes("Slope and modulus, 95 % bounds", lines, on="terminal")
    lines = [*_basis(bending), *bending.record.notes]
    yield Notes(
        "Basis of these results", [sentence(text.pretty(words)) for words in lines], headless=True
    )
    if bending.doubts:
        yield Notes("Doubts", [sentence(text.pretty(words)) for words in bending.doubts])


def _basis(bending: BendingResult) -> list[str]:
    """Sources of the confidence intervals, energy lost in the load cycle, and share of shear."""
    section = (
        "a relative error of the second moment of area causes the same error"
        if bending.specimen.outer_diameter is None
        else "a relative error of the outer diameter causes at least four times this error"
    )
    words = [
        "the 95 % bounds include only the noise of the record; a relative error of the span "
        f"causes three times this error in the modulus; {section}"
    ]
    if bending.hysteresis is not None:
        cycles = "the cycle loses" if bending.cycles == 1 else f"{bending.cycles} cycles lose"
        words.append(f"{cycles} {text.share_text(bending.hysteresis)} of the work done on loading")
    if bending.shear_share is not None:
        share = text.share_text(bending.shear_share)
        words.append(f"shear deflection is {share} of the bending deflection")
    return words


def _loop(bending: BendingResult, room: float) -> Ink:
    """Plot of the recorded force versus deflection."""
    record = bending.record
    curve = Curve("", 1e3 * record["w"], record["F_L"], weight="thin")
    panel = Panel("Force, N", Axis("deflection, mm"), curves=[curve])
    return drawn(Chart("Force over deflection", [panel]), height=min(room, 100.0))
