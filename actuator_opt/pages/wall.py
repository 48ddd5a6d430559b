"""The barrel wall in a report: layers, stresses, failure criteria, way to burst, alternatives.

Layers are shaded, with their number above the frame; the bore is on the left.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..evaluation.result import Evaluation
from ..evaluation.wall_alternatives import Difference
from ..evaluation.wall_study import YIELD, Ratio, WallStudy
from ..models.strength import CRITERIA
from ..rendering import text
from ..rendering.axes import fitted
from ..rendering.blocks import Block, Cell, Chart, Column, Drawing, Table, clean, short, soft
from ..rendering.chart import Axis, Curve, Level, Panel, Stretch
from ..rendering.ink import (
    GREY,
    RED,
    WHITE,
    Ink,
    hatch,
    spread_within,
)
from ..rendering.text import DASH, number, trimmed

STEEL = "#4f86a8"
SHADES = {"composite": 0, "metal": 1, "polymer": 2}
"""Shade of a layer by its kind."""
AT_REST = 5
"""Line style of the stress without pressure: dotted."""
_AT_REST = {"cold": "no pressure, coldest", "hot": "no pressure, hottest", "": "no pressure"}
_NEAR = 0.6
"""A limit is drawn only if a curve reaches at least this share of it."""


@dataclass(frozen=True, slots=True)
class Rung:
    """A bar for a step on the way to burst: its pressures [Pa], fill and words."""

    name: str
    pressure: float
    color: str
    remark: str = ""
    required: float | None = None


def stress_panels(study: WallStudy) -> list[Panel]:
    """Hoop, axial and radial stress through the wall at supply pressure.

    There is a curve for every load path, that is, for every axial force per unit pressure that the
    wall may carry.
    """
    profiles = [(profile, profile.name, k) for k, profile in enumerate(study.profiles)]
    if study.rest:
        at_rest = max(study.rest, key=lambda profile: float(abs(profile.hoop).max()))
        profiles.append((at_rest, _AT_REST.get(at_rest.name, at_rest.name), AT_REST))
    return [
        _panel(
            f"{part.capitalize()} stress, MPa",
            study,
            [
                _curve(name, study, getattr(profile, part) / 1e6, style)
                for profile, name, style in profiles
            ],
        )
        for part in ("hoop", "axial", "radial")
    ]


def strength_panels(study: WallStudy) -> list[Panel]:
    """Panels at supply pressure: the design's failure criterion, and stress / strength."""
    used = [(profile.name, profile.used, k) for k, profile in enumerate(study.profiles)]
    known = [(name, values, k) for name, values, k in used if values is not None]
    ratios = []
    for index in range(len(study.layers)):
        shares = [float(v) for _, values, _ in known for v in values[index] if not math.isnan(v)]
        highest = max(shares, default=0.0)
        ratios.append(f"SR {number(1 / highest, 3)}" if highest > 0 else "")
    curves = [_curve(name, study, values, k) for name, values, k in known]
    panels = [_panel("Strength used, 1/SR", study, curves, (1.0,), ratios)]
    if study.shares is None:
        return panels
    named = [
        ("fibre σ₁/X", study.shares.along, 0),
        ("across σ₂/Y", study.shares.across, 1),
        ("shear τ₁₂/S", study.shares.shear, 2),
        ("von Mises", study.shares.mises, 4),
    ]
    curves = [
        _curve(name, study, values, style)
        for name, values, style in named
        if np.isfinite(values).any()
    ]
    return [*panels, _panel("Stress / strength", study, curves, (1.0, -1.0))]


def _panel(
    title: str,
    study: WallStudy,
    curves: Sequence[Curve],
    limits: Sequence[float] = (),
    remarks: Sequence[str] = (),
) -> Panel:
    """Curves through the wall with shaded, numbered layers, and the limits near the curves."""
    layers = [
        Stretch(
            1e3 * float(radii[0]),
            1e3 * float(radii[-1]),
            f"{k + 1}\n{remarks[k]}" if remarks else str(k + 1),
            SHADES[layer.kind],
        )
        for k, (radii, layer) in enumerate(zip(study.radius, study.layers, strict=True))
    ]
    shown = [float(value) for curve in curves for value in curve.ys if math.isfinite(value)]
    levels = [
        Level(limit, "limit", "max" if limit > 0 else "min")
        for limit in limits
        if any(value / limit > _NEAR for value in shown)
    ]
    return Panel(
        title, Axis("radius, mm"), Axis(zero=True), curves, levels=levels, stretches=layers
    )


def _curve(words: str, study: WallStudy, values: Array, style: int) -> Curve:
    """A curve through the values of every layer, interrupted between layers."""
    radii = 1e3 * np.asarray(study.radius)
    breaks = np.full((len(radii), 1), np.nan)
    xs, ys = (np.hstack([part, breaks]).ravel() for part in (radii, values))
    return Curve(words, xs, ys, style=style)


def ladder_figure(rungs: Sequence[Rung], working: float, *, width: float = 180.0) -> Ink:
    """Bars of the pressures at which parts of the wall fail, up to burst.

    A red tick marks a required pressure. Drawn directly, without `Chart`, because each bar has
    its numbers and a remark beside it.
    """
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
        ink.text(left - 1.5, y, rung.name, size=6.5, anchor="right")
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

    Drawn as a section. Each of the `layers` is (text, thickness in m, kind).
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
"""Largest number of steps to burst that are drawn; of more steps, the first nine and the last are
drawn."""

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
    """All blocks on the wall; only the drawing if the evaluation has no study of the wall."""
    study = evaluation.wall
    blocks = [_drawing(evaluation)]
    if study is None:
        return blocks
    blocks += [_layers(study), _stresses(study)]
    if any(row.criterion != YIELD for row in study.ratios):
        blocks += [_strength(study), _criteria(study)]
    blocks.append(_ladder(evaluation, study))
    if study.differences:
        blocks.append(_differences(evaluation, study))
    blocks += [_thicknesses(study), _metals(study)]
    return blocks


def named(criterion: str) -> str:
    """A criterion as printed.

    >>> named("max_stress"), named("tsai_wu")
    ('maximum stress', 'Tsai-Wu')
    """
    return CRITERIA[criterion].words


def turned(angle: float, *, balanced: bool) -> str:
    """A ply angle (rad) as printed; a balanced pair has ± unless the sign has no effect.

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
        Column("allowables at highest temperature, MPa (share of library value)", "left", 2.6),
    ]
    note = (
        "From the bore outwards; angles are from the tube axis; ± is a balanced pair. X: "
        "strength along the fibre, Y: across it, S: in shear; t: tension, c: compression. "
        "Share of library value: the part that remains after knock-downs for "
        "temperature, moisture, statistical basis and process."
    )
    return Table("Barrel wall: layers", columns, rows, note=note, on="paper")


def _stresses(study: WallStudy) -> Block:
    at_rest = ""
    if study.rest:
        at_rest = " Dotted: stress without pressure, to be added (cure, clamp, autofrettage)."
    note = (
        f"Stresses at supply pressure ({text.trimmed(study.ladder.working / 1e5)} bar), far from "
        "the ends of the tube, by the exact theory of layered tubes; the numbers mark the "
        f"layers.{at_rest}"
    )
    title = "Barrel wall: stress through the wall"
    return Chart(title, stress_panels(study), note, height=60.0)


def _strength(study: WallStudy) -> Block:
    criterion = named(study.criterion)
    right = ""
    if study.shares is not None:
        climate = {"cold": ", coldest", "hot": ", hottest"}.get(study.shares.climate, "")
        right = (
            f" Right: stress / strength for the most severe load "
            f"({study.shares.path}{climate}), including stress without pressure; negative: "
            "compression, or negative shear."
        )
    note = (
        f"Left: plies by {criterion}, metals by von Mises, in the worst climate. SR (strength "
        f"ratio) is the factor on the supply pressure at which the material first fails.{right}"
    )
    title = "Barrel wall: strength used through the wall"
    return Chart(title, strength_panels(study), note, height=60.0)


def _criteria(study: WallStudy) -> Block:
    letters = {profile.name: chr(ord("a") + k) for k, profile in enumerate(study.profiles)}

    def cell(row: Ratio | None) -> Cell:
        if row is None or row.ratio is None:
            return DASH
        place = row.face if row.face != "inside" else f"r {1e3 * row.radius:.2f} mm"
        when = ", ".join(word for word in (letters.get(row.path, ""), row.climate) if word)
        return soft(f"{text.number(row.ratio, 3)}  {row.mode}, {place} ({when})")

    by_criterion = {(row.layer, row.criterion): row for row in study.ratios}
    rows: list[list[Cell]] = []
    for layer in dict.fromkeys(row.layer for row in study.ratios if row.criterion != YIELD):
        ratios = [by_criterion.get((layer, name)) for name in CRITERIA]
        known = [row.ratio for row in ratios if row is not None and row.ratio is not None]
        spread = text.number(max(known) / min(known), 3) if known and min(known) > 0 else DASH
        rows.append([str(layer + 1), *(cell(row) for row in ratios), spread])
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
    key = "; ".join(f"{letter}: {name}" for name, letter in letters.items())
    note = (
        "Strength ratio: factor on the supply pressure at which the ply first fails, including "
        f"cure stress, with failure mode and face. Load paths: {key}. Cold, hot: climates. ●: "
        "criterion of the design. Spread: ratio of the largest to the smallest value in the row."
    )
    if any(row.ratio == 0.0 for row in study.ratios):
        note += " 0: the ply fails without pressure, by its residual stress."
    if any(_woven(study, layer) for layer in range(len(study.layers))):
        note += " The criteria of Hashin and Puck apply to unidirectional plies, not to fabrics."
    if metals:
        note += f" Metals by von Mises: {'; '.join(metals)}."
    return Table(
        "Barrel wall: strength ratios by every criterion", columns, rows, note=note, on="paper"
    )


def _woven(study: WallStudy, index: int) -> bool:
    """Whether a ply is a fabric: nearly as stiff across as along its fibres."""
    layer = study.layers[index]
    first, second = layer.moduli["youngs_modulus_1"], layer.moduli["youngs_modulus_2"]
    return layer.kind == "composite" and min(first, second) > 0.5 * max(first, second)


def _place(label: str) -> str:
    """A location in the wall, with the layer numbers used on the page."""
    label = label.removeprefix("first ply ")
    return _PLACE.sub(lambda m: f"layer {int(m[1]) + 1}", label)


def _ladder(evaluation: Evaluation, study: WallStudy) -> Block:
    ladder = study.ladder
    limits = {
        check.metric: check.limit * ladder.working
        for check in evaluation.checks
        if check.limit is not None and check.sense == "min"
    }
    rungs = [
        Rung("working pressure", ladder.working, "#9ec3da", "supply"),
        Rung(
            "proof pressure", ladder.proof, "#9ec3da", "no yield and no crack up to this pressure"
        ),
    ]
    if ladder.metal_yield is not None:
        place = _place(ladder.metal_yield_place)
        rungs.append(Rung("first yield", ladder.metal_yield, "#d9bd7e", place))
    if ladder.first_ply is not None:
        place, name = _place(ladder.first_ply_place), f"first ply, {named(ladder.criterion)}"
        required = limits.get("first_ply_factor")
        rungs.append(Rung(name, ladder.first_ply, "#d9bd7e", place, required))
    rungs.sort(key=lambda rung: rung.pressure)
    steps = list(enumerate(ladder.steps, 1))
    left_out = max(0, len(steps) - MOST_STEPS)
    for count, step in steps[: MOST_STEPS - 1] + steps[MOST_STEPS - 1 + left_out :]:
        rungs.append(
            Rung(
                f"failure step {count}",
                step.pressure,
                WHITE,
                f"layer {step.layer + 1} {step.mode}",
            )
        )
    if ladder.burst is not None:
        place = f"the highest pressure that the wall carries; {_place(ladder.path)}"
        rungs.append(Rung("burst", ladder.burst, STEEL, place, limits.get("burst_factor")))
    note = ""
    if any(rung.required is not None for rung in rungs):
        note = "Red: pressure required by a check or requirement. "
    if steps:
        note += (
            "Failure steps are computed by maximum stress, starting from the cure stress. Failed "
            "plies lose their matrix stiffness; yielded metal keeps its stress."
        )
    if left_out:
        note += f" {left_out} steps are left out."
    ink = ladder_figure(rungs, ladder.working)
    return Drawing("Barrel wall: from working pressure to burst", ink, note)


def _differences(evaluation: Evaluation, study: WallStudy) -> Block:
    thin = evaluation.design.barrel.model == "thin_laminate"

    def row(difference: Difference) -> list[Cell]:
        name, scale, unit = _DIFFERENCES[difference.name]
        exact, thin_laminate = difference.exact, difference.thin
        change = DASH
        if exact and thin_laminate:
            change = text.margin_text(thin_laminate / exact - 1)
        values = [None if v is None else scale * v for v in (exact, thin_laminate)]
        return [f"{name}, {unit}", *(text.number(value) for value in values), change]

    columns = [
        Column("", "left", 1.0),
        Column("exact layered tube", "right", 0.7, strong=not thin),
        Column("thin laminate", "right", 0.7, strong=thin),
        Column("thin relative to exact", "right", 0.7),
    ]
    used = "thin laminate" if thin else "exact tube"
    note = f"The design uses the {used}; the thin laminate is a fast approximation for thin walls."
    if evaluation.design.barrel.autofrettage_pressure is not None:
        note += " It does not include autofrettage."
    rows = [row(difference) for difference in study.differences]
    return Table(
        "Barrel wall: exact tube compared with thin laminate", columns, rows, note=note, on="paper"
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
    settling = study.settling
    shares = " and ".join(
        f"{text.trimmed(100 * share, 3)} % at {text.trimmed(1e3 * at, 2)} mm"
        for at, share in settling.shares
    )
    shell = f"thin shell, radius / thickness {text.number(settling.radius_ratio, 2)}"
    if settling.radius_ratio < 5:
        shell += ": below 5, so this is a rough value"
    note = (
        f"Only the thickness of layer {study.main_layer + 1}, which carries most of the hoop "
        "force, is changed. The piston seal separates high from low pressure, and the bore "
        "growth decays across it over the length 1/β = "
        f"{text.number(1e3 * settling.decay_length, 3)} mm ({shell}). The bore grows by "
        f"{text.trimmed(100 * settling.at_seal, 3)} % of the full growth at the seal; on the "
        f"pressurised side, it grows by {shares} from the seal."
    )
    title = "Barrel wall: thickness for another bore growth"
    return Table(title, columns, rows, note=note, on="paper")


def _metals(study: WallStudy) -> Block:
    own = study.metals[0]
    working = study.ladder.working

    def millimetres(value: float | None) -> str:
        return text.number(None if value is None else 1e3 * value, 3)

    def factor(value: float | None) -> str:
        return text.number(None if value is None else value / working, 3)

    rows: list[list[Cell]] = []
    for metal in study.metals:
        mass, against = metal.mass_per_length, DASH
        if mass is not None and own.mass_per_length:
            against = f"× {text.number(mass / own.mass_per_length, 3)}"
        rows.append(
            [
                soft(metal.material) if metal.material else "this design",
                millimetres(metal.for_growth),
                millimetres(metal.for_burst),
                "out of reach" if metal.thickness is None else millimetres(metal.thickness),
                text.number(None if metal.growth is None else 1e6 * metal.growth),
                factor(metal.burst_pressure),
                factor(metal.yield_pressure),
                text.number(None if mass is None else 1e3 * mass),
                against if metal.material else "",
            ]
        )
    columns = [
        Column("barrel", "left", 1.0),
        Column("for the\ngrowth, mm", "right"),
        Column("for\nburst, mm", "right"),
        Column("wall, mm", "right", strong=True),
        Column("bore growth,\nµm", "right"),
        Column("burst /\nworking", "right"),
        Column("yield /\nworking", "right"),
        Column("mass,\ng/m", "right", strong=True),
        Column("against this\ndesign", "right"),
    ]
    note = (
        "For each metal: the thinnest tube of the same bore that has at most the "
        "bore growth of this design (without axial load), and at least the required burst "
        "pressure (or this design's own, if that is lower). Computed by Lamé and Faupel, under "
        "the same axial forces, without a minimum wall for turning."
    )
    return Table(
        "Barrel wall: metal barrels for the same limits", columns, rows, note=note, on="paper"
    )
