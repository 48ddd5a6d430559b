"""Values as the tables of [ElAsswad2018] print them, and where they are looked up."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from ..base import units
from ..design.materials import load_library
from ..evaluation import Evaluation
from ..rendering import text
from . import paper_text

COLUMNS = ("quantity", "published", "its own formula", "ours")


def _text(value: float, unit: str, dimension: str) -> str:
    return text.with_unit(
        text.trimmed(float(units.unit(unit, dimension).from_si(value))), text.unit_text(unit)
    )


in_mm = partial(_text, unit="mm", dimension="length")
in_um = partial(_text, unit="um", dimension="length")
in_mm2 = partial(_text, unit="mm^2", dimension="area")
in_ml = partial(_text, unit="ml", dimension="volume")
in_n = partial(_text, unit="N", dimension="force")
in_n_per_mm = partial(_text, unit="N/mm", dimension="stiffness")
in_mpa = partial(_text, unit="MPa", dimension="pressure")
in_gpa = partial(_text, unit="GPa", dimension="pressure")
in_ns_per_m = partial(_text, unit="N*s/m", dimension="damping")
in_mpas = partial(_text, unit="mPa*s", dimension="dynamic_viscosity")
percent = partial(paper_text.percent, digits=3)


def value(evaluation: Evaluation, name: str) -> float:
    """Value of a metric; NaN where it has none."""
    found = evaluation.metrics[name].value
    return float("nan") if found is None else found


def properties(evaluation: Evaluation, name: str) -> Mapping[str, float]:
    """What the library and the design state of a material; nothing of one of the user's files."""
    library = load_library()
    known = library.get(name).numbers if name in library else {}
    return {**known, **evaluation.design.materials.get(name, {})}


def wall_thickness(evaluation: Evaluation) -> float:
    """Thickness of the barrel; the paper prints none, so the design's stands for it."""
    return sum(layer.thickness for layer in evaluation.design.barrel.layup)
