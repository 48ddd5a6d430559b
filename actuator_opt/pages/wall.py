"""The barrel's wall on paper: layers, stresses, criteria, the way to burst, alternatives.

Layers are bands with their number, the bore at the left. Curves differ in dash as well as in colour
and are named in the legend above the frames, so no text crosses a curve.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..evaluation.result import Evaluation
from ..evaluation.wall_alternatives import Difference
from ..evaluation.wall_study import YIELD, Ratio, WallProfile, WallStudy
from ..models.strength import CRITERIA
from ..rendering import text
from ..rendering.axes import Axes, fitted, legend
from ..rendering.blocks import Block, Cell, Column, Drawing, Table, clean, short, soft
from ..rendering.ink import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    OCHRE,
    RED,
    WHITE,
    Ink,
    Point,
    hatch,
    spread_within,
    text_width,
)
from ..rendering.text import DASH, number, trimmed

STEEL = "#4f86a8"


BANDS = {"metal": "#f1f3f5", "composite": "#e2e7eb", "polymer": "#f6efdc"}


_STYLES: tuple[dict[str, Any], ...] = (
    {"stroke": BLUE, "pen": 0.4},
    {"stroke": OCHRE, "pen": 0.4, "dash": (1.6, 0.8)},
    {"stroke": GREEN, "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)},
)


_REST: dict[str, Any] = {"stroke": GREY, "pen": 0.35, "dash": (0.4, 0.6)}


_MISES: dict[str, Any] = {"stroke": BLACK, "pen": 0.4}


_AT_REST = {"cold": "no pressure, coldest", "hot": "no pressure, hottest", "": "no pressure"}


_NEAR = 0.6
"""Share of a limit from which on it is drawn."""


_NUMBERS, _SHARES = 4.2, 8.0
"""Room (mm) inside a frame, above the curves, for layer numbers, and for strength ratios too."""


@dataclass(frozen=True, slots=True)
class LayerCurve:
    """Values of every layer, (layers, points), with the ink they are drawn in."""

    values: Any
    style: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Rung:
    """A line of the ladder: what, its pressure (Pa), the colour of its bar, a remark, its limit."""

    what: str
    pressure: float
    color: str
    remark: str = ""
    required: float | None = None


def _panel(
    ink: Ink,
    box: tuple[float, float, float, float],
    title: str,
    study: WallStudy,
    curves: Sequence[LayerCurve],
    room: float,
    limits: Sequence[float] = (),
) -> Axes:
    """A frame over the wall with its layers as bands, the curves in it, and limits they near."""
    found = [float(v) for c in curves for row in c.values for v in row if math.isfinite(v)]
    shown = [level for level in limits if any(v / level > _NEAR for v in found)]
    low, high = min([0.0, *found, *shown]), max([0.0, *found, *shown])
    span = high - low or 1.0
    low -= 0.04 * span if low < 0 else 0.0
    high += (0.03 * span + span * room / (box[3] - room)) if high > 0 or low == 0 else 0.0
    if high <= 0:
        high = (high - low) * room / (box[3] - room)
    radii = [[1000.0 * float(r) for r in row] for row in study.radius]
    axes = Axes(ink, box, (radii[0][0], radii[-1][-1]), (low, high))
    bottom = box[1] + box[3]
    for row, layer in zip(radii, study.layers, strict=True):
        left, right = axes.x(row[0]), axes.x(row[-1])
        ink.box(left, box[1], right - left, box[3], fill=BANDS[layer.kind], stroke=None)
    for row in radii[1:]:
        ink.line((axes.x(row[0]), box[1]), (axes.x(row[0]), bottom), stroke=WHITE, pen=0.35)
    axes.frame(title, "radius, mm")
    if low < 0 < high:
        ink.line((box[0], axes.y(0.0)), (box[0] + box[2], axes.y(0.0)), pen=0.13)
    for level in shown:
        y = axes.y(level)
        ink.line((box[0], y), (box[0] + box[2], y), stroke=RED, pen=0.25, dash=(1.8, 1.0))
    free = box[0]
    for index, row in enumerate(radii):
        half = text_width(str(index + 1), 6.0, bold=True) / 2
        middle = (axes.x(row[0]) + axes.x(row[-1])) / 2
        if middle - half >= free:
            ink.text(
                middle,
                box[1] + 2.0,
                str(index + 1),
                size=6.0,
                anchor="center",
                color=GREY,
                bold=True,
            )
            free = middle + half + 0.8
    for curve in curves:
        lines: list[list[Point]] = [
            [(axes.x(r), axes.y(float(v))) for r, v in zip(row, values, strict=True)]
            for row, values in zip(radii, curve.values, strict=True)
            if all(math.isfinite(float(v)) for v in values)
        ]
        ink.path(lines, **curve.style)
    return axes


def stress_figure(study: WallStudy, *, width: float = 180.0, height: float = 52.0) -> Ink:
    """Hoop, axial and radial stress through the wall at supply pressure, for every load path."""
    ink = Ink(width, height)
    rest = max(study.rest, key=lambda one: abs(one.hoop).max(), default=None)
    loads: list[tuple[WallProfile, dict[str, Any]]] = list(
        zip(study.profiles, _STYLES, strict=False)
    )
    entries = [(profile.name, style) for profile, style in loads]
    if rest is not None:
        loads.append((rest, _REST))
        entries.append((_AT_REST.get(rest.name, rest.name), _REST))
    legend(ink, width, 1.8, entries, ends=True)
    panel = (width - 3 * 12.5) / 3
    for k, part in enumerate(("hoop", "axial", "radial")):
        box = (11.0 + k * (panel + 12.0), 12.0, panel, height - 22.0)
        curves = [LayerCurve(getattr(profile, part) / 1e6, style) for profile, style in loads]
        _panel(ink, box, f"{part.capitalize()} stress, MPa", study, curves, _NUMBERS)
    return ink


def strength_figure(study: WallStudy, *, width: float = 180.0, height: float = 58.0) -> Ink:
    """Strength used at supply pressure by the design's criterion, and stress over strength."""
    ink = Ink(width, height)
    panel = (width - 2 * 13.0) / 2
    box = (11.0, 12.0, panel, height - 22.0)
    paths = list(zip(study.profiles, _STYLES, strict=False))
    curves = [LayerCurve(one.used, style) for one, style in paths if one.used is not None]
    axes = _panel(ink, box, "Strength used, 1/SR", study, curves, _SHARES, (1.0,))
    legend(ink, box[0] - 9.6, 1.8, [(one.name, style) for one, style in paths], ends=False)
    for index, row in enumerate(study.radius):
        found = [float(v) for one, _ in paths if one.used is not None for v in one.used[index]]
        worst = max((v for v in found if not math.isnan(v)), default=0.0)
        words = f"SR {number(1 / worst, 3)}" if worst > 0 else ""
        left, right = axes.x(1000.0 * float(row[0])), axes.x(1000.0 * float(row[-1]))
        if words and text_width(words, 6.0) + 0.6 < right - left:
            ink.text((left + right) / 2, box[1] + 5.4, words, size=6.0, anchor="center")
    shares = study.shares
    if shares is None:
        return ink
    box = (box[0] + panel + 12.5, box[1], panel, box[3])
    named = [
        ("fibre σ₁/X", shares.along, _STYLES[0]),
        ("across σ₂/Y", shares.across, _STYLES[1]),
        ("shear τ₁₂/S", shares.shear, _STYLES[2]),
        ("von Mises", shares.mises, _MISES),
    ]
    named = [one for one in named if any(math.isfinite(float(v)) for row in one[1] for v in row)]
    curves = [LayerCurve(values, style) for _, values, style in named]
    _panel(ink, box, "Stress over strength", study, curves, _NUMBERS, (1.0, -1.0))
    legend(ink, width, 1.8, [(words, style) for words, _, style in named], ends=True)
    return ink


def ladder_figure(rungs: Sequence[Rung], working: float, *, width: float = 180.0) -> Ink:
    """Pressures on the way to burst as bars; a red tick is what a check or requirement asks for."""
    step, top = 4.8, 5.0
    ink = Ink(width, top + step * len(rungs) + 1.5)
    left, room = 40.0, 48.0
    largest = max([rung.pressure for rung in rungs] + [rung.required or 0.0 for rung in rungs])
    scale = room / largest
    values = left + room
    ink.text(values + 14.0, 1.6, "bar", size=6.0, anchor="right", color=GREY)
    ink.text(values + 28.0, 1.6, "× working", size=6.0, anchor="right", color=GREY)
    for k, rung in enumerate(rungs):
        y = top + step * (k + 0.5)
        ink.text(left - 1.5, y, rung.what, size=6.5, anchor="right")
        ink.box(left, y - 1.5, rung.pressure * scale, 3.0, fill=rung.color, pen=0.13)
        if rung.required is not None:
            x = left + rung.required * scale
            ink.line((x, y - 2.2), (x, y + 2.2), stroke=RED, pen=0.45)
        ink.text(values + 14.0, y, number(rung.pressure / 1e5), size=6.5, anchor="right", bold=True)
        ink.text(values + 28.0, y, number(rung.pressure / working, 3), size=6.5, anchor="right")
        ink.text(
            values + 31.0, y, fitted(rung.remark, width - values - 31.0, 6.2), size=6.2, color=GREY
        )
    ink.line((left, top), (left, top + step * len(rungs)), pen=0.2)
    return ink


def wall_figure(layers: Sequence[tuple[str, float, str]], *, width: float = 180.0) -> Ink:
    """The barrel wall enlarged to an ISO scale, layer by layer from the bore (below) outwards.

    `layers` holds (text, thickness in m, kind).
    """
    total = 1000.0 * sum(thickness for _, thickness, _ in layers)
    paper, real = next(
        ((p, 1) for p in (100, 50, 20, 10, 5, 2, 1) if total * p <= 26.0),
        next(((1, r) for r in (2, 5, 10, 20, 50) if total / r <= 26.0), (1, 100)),
    )
    factor = 1000.0 * paper / real
    count = len(layers)
    wall = total * paper / real
    height = max(wall, 3.4 * count) + 9.0
    ink = Ink(width, height)
    bottom = height - 4.0 - max(0.0, (3.4 * count - wall) / 2)
    middles = []
    base = bottom
    for _, thickness, kind in layers:
        deep = thickness * factor
        box = ((3.0, base - deep), (63.0, base - deep), (63.0, base), (3.0, base))
        composite = kind == "composite"
        ink.path([box], fill="#d5dbe0" if composite else "#eef1f3", stroke=None, closed=True)
        lines = hatch([box], angle=-60.0 if composite else -45.0, spacing=0.9 if composite else 1.5)
        if composite:
            lines += hatch([box], angle=60.0, spacing=0.9)
        ink.path(lines, pen=0.09, stroke=GREY)
        ink.path([box], closed=True, pen=0.18)
        middles.append(base - deep / 2)
        base -= deep
    places = spread_within(middles[::-1], [3.4] * (count - 1), 2.0, height - 2.0)[::-1]
    for (words, thickness, _), middle, y in zip(layers, middles, places, strict=True):
        ink.line((63.0, middle), (69.0, y), (71.0, y), pen=0.13)
        ink.text(72.0, y, f"{words}, {trimmed(1000 * thickness)} mm", size=7.0)
    ink.text(33.0, bottom + 2.4, "bore side", size=6.0, color=GREY, anchor="center")
    ink.text(width, 2.0, f"SCALE {paper}:{real}", size=7.0, bold=True, anchor="right")
    return ink


MOST_STEPS = 10
"""Steps of a ladder drawn; of a longer one the first and the last."""

_PLACE = re.compile(r"layup\[(\d+)\] [^\s,]+")
_SHORT = {
    "strength_1_tension": "Xt",
    "strength_1_compression": "Xc",
    "strength_2_tension": "Yt",
    "strength_2_compression": "Yc",
    "strength_12": "S",
    "yield_strength": "yield",
    "ultimate_strength": "ultimate",
}
_DIFFERENCES = {
    "bore_growth": ("bore growth", 1e6, "µm"),
    "yield_pressure": ("first yield of a metal layer", 1e-5, "bar"),
    "first_ply_pressure": ("first ply", 1e-5, "bar"),
    "burst_pressure": ("burst", 1e-5, "bar"),
}


def wall_blocks(evaluation: Evaluation) -> list[Block]:
    """Every block of the wall; the drawing alone where there is no study."""
    study = evaluation.wall
    found = [_drawing(evaluation)]
    if study is None:
        return found
    found += [_layers(study), _stresses(study)]
    if any(row.criterion != YIELD for row in study.ratios):
        found += [_strength(study), _criteria(study)]
    found.append(_ladder(evaluation, study))
    if study.differences:
        found.append(_differences(evaluation, study))
    found += [_thicknesses(study), _metals(study)]
    return found


def named(criterion: str) -> str:
    """A criterion as printed.

    >>> named("max_stress"), named("tsai_wu")
    ('maximum stress', 'Tsai-Wu')
    """
    return CRITERIA[criterion].words


def turned(angle: float, *, balanced: bool) -> str:
    """An angle (rad) as printed; a pair has a sign where it matters.

    >>> turned(0.4363323129985824, balanced=True), turned(1.5707963267948966, balanced=True)
    ('±25°', '90°')
    """
    degrees = text.trimmed(math.degrees(angle))
    return f"±{degrees}°" if balanced and degrees not in ("0", "90") else f"{degrees}°"


def _drawing(evaluation: Evaluation) -> Block:
    kinds = {o.material: o.kind for o in evaluation.outlines}
    layers = []
    for index, ply in enumerate(evaluation.design.barrel.layup, 1):
        kind = kinds.get(ply.material, "metal")
        angle = turned(ply.angle, balanced=ply.balanced)
        turn = f", {angle} from the tube axis" if kind == "composite" else ""
        layers.append((clean(f"{index}  {ply.material}{turn}"), ply.thickness, kind))
    return Drawing("Barrel wall, from the bore outwards", wall_figure(layers))


def _layers(study: WallStudy) -> Block:
    rows: list[list[Cell]] = []
    for index, layer in enumerate(study.layers, 1):
        ply = layer.kind == "composite"
        gpa = [text.number(layer.moduli[key] / 1e9, 3) for key in list(layer.moduli)[:3]]
        strengths = [
            f"{_SHORT[key]}\N{NO-BREAK SPACE}{text.number(value / 1e6, 3)}"
            f"\N{NO-BREAK SPACE}({text.number(layer.factors[key], 2)})"
            for key, value in layer.strengths.items()
        ]
        rows.append(
            [
                str(index),
                soft(layer.material),
                turned(layer.angle, balanced=layer.balanced) if ply else DASH,
                text.trimmed(1e3 * layer.thickness),
                f"{1e3 * layer.inner_radius:.3f}{DASH}{1e3 * layer.outer_radius:.3f}",
                gpa[0],
                gpa[1] if ply else DASH,
                gpa[2],
                text.number(layer.moduli["poissons_ratio_12"], 3),
                ", ".join(strengths) or "not stated",
            ]
        )
    columns = [
        Column(""),
        Column("material", "left", 1.0),
        Column("angle", "right"),
        Column("thick,\nmm", "right"),
        Column("radii, mm", "right"),
        Column("E₁, GPa", "right"),
        Column("E₂, GPa", "right"),
        Column("G₁₂, GPa", "right"),
        Column("ν₁₂", "right"),
        Column("allowables at the hottest, MPa (share left)", "left", 2.6),
    ]
    note = (
        "From the bore outwards; angles from the tube axis, ± a balanced pair. X along the fibre,"
        " Y across it, t tension, c compression, S shear; the share is what temperature, moisture,"
        " basis and process leave of the library value."
    )
    return Table("Barrel wall: layers", columns, rows, note=note, on="paper")


def _stresses(study: WallStudy) -> Block:
    rest = ""
    if study.rest:
        rest = " Dotted: what stands without pressure, to be added (cure, clamp, autofrettage)."
    note = (
        f"At supply pressure, {text.trimmed(study.ladder.working / 1e5)} bar, by the exact tube,"
        f" far from the ends; numbers are the layers.{rest}"
    )
    return Drawing("Barrel wall: stress through the wall", stress_figure(study), note)


def _strength(study: WallStudy) -> Block:
    criterion = named(study.criterion)
    right = ""
    if study.shares is not None:
        climate = {"cold": ", coldest", "hot": ", hottest"}.get(study.shares.climate, "")
        right = (
            f" Right: the most severe load ({study.shares.path}{climate}), stress without pressure"
            " included; negative is compression, or the sign of shear."
        )
    note = (
        f"Left: plies by {criterion}, metals by von Mises, the worst climate; SR is the factor on"
        f" the supply pressure to first failure.{right}"
    )
    return Drawing("Barrel wall: strength used through the wall", strength_figure(study), note)


def _criteria(study: WallStudy) -> Block:
    letters = {profile.name: chr(ord("a") + k) for k, profile in enumerate(study.profiles)}

    def cell(row: Ratio | None) -> Cell:
        if row is None or row.ratio is None:
            return DASH
        place = row.face if row.face != "inside" else f"r {1e3 * row.radius:.2f} mm"
        when = ", ".join(one for one in (letters.get(row.path, ""), row.climate) if one)
        return soft(f"{text.number(row.ratio, 3)}  {row.mode}, {place} ({when})")

    found = {(row.layer, row.criterion): row for row in study.ratios}
    rows: list[list[Cell]] = []
    for layer in dict.fromkeys(row.layer for row in study.ratios if row.criterion != YIELD):
        own = [found.get((layer, name)) for name in CRITERIA]
        known = [one.ratio for one in own if one is not None and one.ratio is not None]
        spread = text.number(max(known) / min(known), 3) if known and min(known) > 0 else DASH
        rows.append([str(layer + 1), *(cell(one) for one in own), spread])
    heads = [f"{named(name)}{' ●' if name == study.criterion else ''}" for name in CRITERIA]
    columns = [
        Column(""),
        *(Column(head, "left", 1.0) for head in heads),
        Column("spread", "right"),
    ]
    metals = [
        f"layer {row.layer + 1} yields at {text.number(row.ratio, 3)} ({row.face},"
        f" {letters[row.path]}{', ' if row.climate else ''}{row.climate})"
        for row in study.ratios
        if row.criterion == YIELD and row.ratio is not None
    ]
    said = "; ".join(f"{letter} {name}" for name, letter in letters.items())
    note = (
        "Strength ratio: factor on the supply pressure to the first failure of the ply, with mode"
        f" and face, cure stress included; {said}; cold and hot are the climates. ● the design's"
        " criterion; spread is the largest over the smallest of the row."
    )
    if any(row.ratio == 0.0 for row in study.ratios):
        note += " 0: the stress without pressure is enough to fail it."
    if any(_woven(study, layer) for layer in range(len(study.layers))):
        note += " Hashin and Puck are made for unidirectional plies, not for a fabric."
    if metals:
        note += f" Metals by von Mises: {'; '.join(metals)}."
    return Table(
        "Barrel wall: strength ratios by every criterion", columns, rows, note=note, on="paper"
    )


def _woven(study: WallStudy, index: int) -> bool:
    """Whether a ply is nearly as stiff across as along: a fabric."""
    layer = study.layers[index]
    first, second = layer.moduli["youngs_modulus_1"], layer.moduli["youngs_modulus_2"]
    return layer.kind == "composite" and min(first, second) > 0.5 * max(first, second)


def _place(label: str) -> str:
    """A place of the metrics in the layer numbers of the page."""
    label = label.replace("first ply with the liner yielding", "with the liner yielding")
    return _PLACE.sub(lambda m: f"layer {int(m[1]) + 1}", label)


def _ladder(evaluation: Evaluation, study: WallStudy) -> Block:
    ladder = study.ladder
    asked = {
        check.metric: check.limit * ladder.working
        for check in evaluation.checks
        if check.limit is not None and check.sense == "min"
    }
    rungs = [
        Rung("working pressure", ladder.working, "#9ec3da", "supply"),
        Rung("proof pressure", ladder.proof, "#9ec3da", "no yield, no crack up to here"),
    ]
    if ladder.metal_yield is not None:
        place = _place(ladder.metal_yield_place)
        rungs.append(Rung("first yield", ladder.metal_yield, "#d9bd7e", place))
    if ladder.first_ply is not None:
        place, what = _place(ladder.first_ply_place), f"first ply, {named(ladder.criterion)}"
        required = asked.get("first_ply_factor")
        rungs.append(Rung(what, ladder.first_ply, "#d9bd7e", place, required))
    rungs.sort(key=lambda rung: rung.pressure)
    steps = list(enumerate(ladder.steps, 1))
    left_out = max(0, len(steps) - MOST_STEPS)
    for count, step in steps[: MOST_STEPS - 1] + steps[MOST_STEPS - 1 + left_out :]:
        rungs.append(
            Rung(
                f"ladder, step {count}",
                step.pressure,
                WHITE,
                f"layer {step.layer + 1} {step.mode}",
            )
        )
    if ladder.burst is not None:
        place = f"the highest load carried; {_place(ladder.path)}"
        rungs.append(Rung("burst", ladder.burst, STEEL, place, asked.get("burst_factor")))
    note = ""
    if any(rung.required is not None for rung in rungs):
        note = "Red: what the check or the requirement asks for. "
    if steps:
        note += (
            "Steps: maximum stress, starting from the cure stress; failed plies lose their matrix,"
            " yielded metal keeps its stress."
        )
    if left_out:
        note += f" {left_out} steps are left out."
    ink = ladder_figure(rungs, ladder.working)
    return Drawing("Barrel wall: from working pressure to burst", ink, note)


def _differences(evaluation: Evaluation, study: WallStudy) -> Block:
    thin = evaluation.design.barrel.model == "thin_laminate"

    def row(one: Difference) -> list[Cell]:
        name, scale, unit = _DIFFERENCES[one.name]
        change = DASH
        if one.exact and one.thin:
            change = text.margin_text(one.thin / one.exact - 1)
        values = [None if v is None else scale * v for v in (one.exact, one.thin)]
        return [f"{name}, {unit}", *(text.number(value) for value in values), change]

    columns = [
        Column("", "left", 1.0),
        Column("exact layered tube", "right", 0.7, strong=not thin),
        Column("thin laminate", "right", 0.7, strong=thin),
        Column("thin against exact", "right", 0.7),
    ]
    used = "thin laminate" if thin else "exact tube"
    note = f"The design uses the {used}; the thin laminate is a fast mode, for thin walls."
    if evaluation.design.barrel.autofrettage_pressure is not None:
        note += " It knows no autofrettage."
    rows = [row(difference) for difference in study.differences]
    return Table(
        "Barrel wall: exact tube against thin laminate", columns, rows, note=note, on="paper"
    )


def _thicknesses(study: WallStudy) -> Block:
    inner = study.layers[0].inner_radius
    present = next(row.mass_per_length for row in study.thicknesses if row.factor == 1.0)
    layer = study.layers[study.main_layer]
    rows: list[list[Cell]] = []
    for row in study.thicknesses:
        change = DASH
        if row.mass_per_length is not None and present:
            change = f"{text.number(1e3 * (row.mass_per_length - present), 3, signed=True)}"
        reach = "out of reach" if row.thickness is None else text.number(1e3 * row.thickness)
        mass = row.mass_per_length
        rows.append(
            [
                "present" if row.factor == 1.0 else f"× {text.trimmed(row.factor)}",
                text.number(1e6 * row.growth),
                text.number(100 * row.growth / inner, 3),
                reach,
                text.number(None if mass is None else 1e3 * mass),
                change,
            ]
        )
    columns = [
        Column("bore growth", "left", 1.0),
        Column("growth, µm", "right", 0.8),
        Column("bore strain, %", "right", 0.8),
        Column(f"layer {study.main_layer + 1}, {short(layer.material, 24)}, mm", "right", 1.2),
        Column("wall, g/m", "right", 0.8),
        Column("change, g/m", "right", 0.8),
    ]
    s = study.settling
    shares = " and ".join(
        f"{text.trimmed(100 * share, 3)} % at {text.trimmed(1e3 * at, 2)} mm"
        for at, share in s.shares
    )
    shell = f"thin shell of radius over thickness {text.number(s.radius_ratio, 2)}"
    if s.radius_ratio < 5:
        shell += ", below 5: a rough figure"
    note = (
        f"Only layer {study.main_layer + 1} is changed, the one that carries most of the hoop"
        f" force. Beside the pressure step under the piston seal the growth settles over"
        f" 1/β = {text.number(1e3 * s.decay_length, 3)} mm ({shell}):"
        f" {text.trimmed(100 * s.at_seal, 3)} % of it acts at the seal, {shares} into the pressure."
    )
    title = "Barrel wall: thickness for another bore growth"
    return Table(title, columns, rows, note=note, on="paper")


def _metals(study: WallStudy) -> Block:
    own, *others = study.metals
    working = study.ladder.working

    def millimetres(value: float | None) -> str:
        return text.number(None if value is None else 1e3 * value, 3)

    def factor(value: float | None) -> str:
        return text.number(None if value is None else value / working, 3)

    rows: list[list[Cell]] = []
    for one in (own, *others):
        mass, against = one.mass_per_length, DASH
        if mass is not None and own.mass_per_length:
            against = f"× {text.number(mass / own.mass_per_length, 3)}"
        rows.append(
            [
                soft(one.material) if one.material else "this design",
                millimetres(one.for_growth),
                millimetres(one.for_burst),
                "out of reach" if one.thickness is None else millimetres(one.thickness),
                text.number(None if one.growth is None else 1e6 * one.growth),
                factor(one.burst_pressure),
                factor(one.yield_pressure),
                text.number(None if mass is None else 1e3 * mass),
                against if one.material else "",
            ]
        )
    columns = [
        Column("barrel", "left", 1.0),
        Column("for the\ngrowth, mm", "right"),
        Column("for\nburst, mm", "right"),
        Column("wall, mm", "right", strong=True),
        Column("bore growth,\nµm", "right"),
        Column("burst over\nworking", "right"),
        Column("yield over\nworking", "right"),
        Column("mass,\ng/m", "right", strong=True),
        Column("against this\ndesign", "right"),
    ]
    note = (
        "The thinnest tube of each metal of the library for the same bore, with this design's bore"
        " growth (no axial load) and the burst pressure it is asked for (its own where that is"
        " lower), by Lamé and Faupel, under the same axial forces; no least wall for turning."
    )
    return Table(
        "Barrel wall: metal barrels for the same duty", columns, rows, note=note, on="paper"
    )
