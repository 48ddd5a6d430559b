"""The barrel's wall on paper: layers, stresses, criteria, the way to burst, alternatives."""

from __future__ import annotations

import math
import re

from ..evaluation.alternatives import Difference
from ..evaluation.result import Evaluation
from ..evaluation.wall_study import YIELD, Ratio, WallStudy
from ..models.criteria import CRITERIA
from . import text
from .blocks import Block, Cell, clean, column, figure, short, soft, table
from .figures import wall_figure
from .ink import WHITE
from .text import DASH
from .wall_figures import STEEL, Rung, ladder_figure, strength_figure, stress_figure

MOST_STEPS = 10
"""Steps of a ladder drawn; of a longer one the first and the last."""

_PLACE = re.compile(r"layup\[(\d+)\] \S+")
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


def blocks(evaluation: Evaluation) -> list[Block]:
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
    known = {"max_stress": "maximum stress", "max_strain": "maximum strain", "tsai_wu": "Tsai-Wu"}
    return known.get(criterion, criterion.capitalize())


def _drawing(evaluation: Evaluation) -> Block:
    kinds = {o.material: o.kind for o in evaluation.outlines}
    layers = []
    for index, ply in enumerate(evaluation.design.barrel.layup, 1):
        kind = kinds.get(ply.material, "metal")
        angle = text.trimmed(math.degrees(ply.angle))
        sign = "±" if ply.balanced else ""
        turn = f", {sign}{angle}° from the tube axis" if kind == "composite" else ""
        layers.append((clean(f"{index}  {ply.material}{turn}"), ply.thickness, kind))
    return figure("Barrel wall, from the bore outwards", wall_figure(layers))
