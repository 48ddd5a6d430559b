"""The barrel's wall on paper: layers, stresses, criteria, the way to burst, alternatives."""

from __future__ import annotations

import math
import re

from ..evaluation.result import Evaluation
from ..evaluation.wall_study import YIELD, Difference, Ratio, WallStudy
from ..models.strength import CRITERIA
from ..rendering import text
from ..rendering.blocks import Block, Cell, Column, Drawing, Table, clean, short, soft
from ..rendering.ink import WHITE
from ..rendering.text import DASH
from .wall_figures import STEEL, Rung, ladder_figure, strength_figure, stress_figure, wall_figure

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
    for number, step in steps[: MOST_STEPS - 1] + steps[MOST_STEPS - 1 + left_out :]:
        rungs.append(
            Rung(
                f"ladder, step {number}",
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
    rows = [row(one) for one in study.differences]
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
