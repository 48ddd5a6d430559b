"""Tables and figures that set [Huang2017] beside this project's films.

The text of the paper prints few numbers: table 2, a claimed fall of B and the chamber's shear. Its
claims are judged by our films with the design's seals, none of them fitted to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..design.material_fits import Fit
from ..design.model import Design
from ..evaluation import Evaluation
from ..models.friction import HUANG_TABLE_2
from ..rendering import text
from ..rendering.blocks import Drawing, ExtraTable
from . import (
    huang_claims,
    huang_equations,
    huang_figures,
    huang_notes,
    huang_published,
    huang_trend,
)
from .huang import TYPICAL
from .huang_figures import SHOWN
from .huang_parts import BACK_UP, CHAMBER, dry_ring
from .huang_published import PAPER, CurveFits
from .huang_study import HuangStudy, study
from .huang_text import mega, megas, pressure_text, rounded, speed_text
from .paper_text import percent


def plunger_table(design: Design, found: HuangStudy) -> ExtraTable:
    """Figure 6: table 2 and our films over speed and pressure."""
    mapped = found.plunger
    columns = [mapped.at(0.0, v)[1] for v in SHOWN]
    rows = []
    for row in HUANG_TABLE_2:
        theirs = np.array([float(huang_published.secant_of(row, v)) for v in SHOWN])
        ours = mapped.damping[mapped.at(row.pressure, 0.0)[0], columns]
        ratio = " / ".join(text.number(float(x), 2) for x in ours / theirs)
        rows.append((pressure_text(row.pressure), megas(theirs), megas(ours), ratio))
    for pressure in PAPER.simulated:
        ours = mapped.damping[mapped.at(pressure, 0.0)[0], columns]
        rows.append((pressure_text(pressure), text.DASH, megas(ours), text.DASH))
    at = ", ".join(text.trimmed(1e3 * v) for v in SHOWN)
    drawn = Drawing(
        "Huang 2017: plunger over speed and pressure, as its figure 6",
        huang_figures.plunger_figure(found),
        "Above: eq. 31 with the paper's table 2. Below: step ring and Yx seal on their films, "
        "flows matched, outstroke.",
    )
    names = ("pressure", f"table 2, MN·s/m at {at} mm/s", "our films", "ours over table 2")
    note = huang_notes.plunger_note(design, found)
    return ExtraTable("Huang 2017: plunger, test B", names, rows, note, drawn)


def _power(fit: Fit) -> str:
    a, b = fit.parameters["coefficient"], fit.parameters["exponent"]
    return (
        f"{text.number(a.value, 3)} v^{text.number(b.value, 4)} "
        f"({text.number(b.lower, 4)} to {text.number(b.upper, 4)})"
    )


def _double(fit: Fit) -> str:
    parts = []
    for k in ("1", "2"):
        a, b = fit.parameters[f"coefficient_{k}"], fit.parameters[f"rate_{k}"]
        half = b.upper - b.value
        parts.append(f"{mega(a.value)} e^({text.number(b.value, 3)} ± {text.number(half, 2)})v")
    return "; ".join(parts)


def _quality(fit: Fit) -> str:
    square = text.DASH if fit.r_squared is None else f"{fit.r_squared:.4f}"
    return f"{square}, {percent(fit.largest_error)}"


def fits_table(_: Design, found: HuangStudy) -> ExtraTable:
    """Figures 7 and 8: both laws through table 2 and through our films."""
    curves: list[tuple[str, CurveFits]] = [
        (f"table 2, {pressure_text(one.row.pressure)}", one) for one in found.published
    ]
    curves += [(f"our films, {pressure_text(p)}", one) for p, one in found.films]
    rows = [
        (name, _power(one.power), _quality(one.power), _double(one.double), _quality(one.double))
        for name, one in curves
    ]
    drawn = Drawing(
        "Huang 2017: damping over speed and over pressure, as its figures 7 and 8",
        huang_figures.speed_figure(found),
        "Left the paper's table 2, right our films.",
    )
    names = (
        "curve",
        "a v^b, SI; bounds of b",
        "R², largest error",
        "a1 e^(b1 v) + a2 e^(b2 v), MN·s/m, s/m",
        "R², largest error",
    )
    return ExtraTable(
        "Huang 2017: fits over speed", names, rows, huang_notes.fits_note(found), drawn
    )


def parts_table(_: Design, found: HuangStudy) -> ExtraTable:
    """Equation 26 with every part, figures 19 and 20."""
    rows = []
    for one in found.totals:
        parts = one.parts
        seals = [name for name in parts if name not in (BACK_UP, CHAMBER)]
        rows.append(
            (
                f"{pressure_text(one.pressure)}, {speed_text(one.speed)}",
                " / ".join(rounded(parts[name]) for name in seals),
                f"{rounded(parts[BACK_UP])} ({rounded(one.ring_range[0])} to "
                f"{rounded(one.ring_range[1])})",
                f"{parts[CHAMBER]:.2f}",
                rounded(one.damping),
                percent(one.beside_share),
            )
        )
    drawn = Drawing(
        "Huang 2017: back-up ring, as its figures 19 and 20",
        huang_figures.back_up_figure(found),
        "PTFE of the step ring, 15 mm wide, edges rounded by 5 µm, 0.1 MPa of mean contact "
        "pressure: all assumed; the paper prints none.",
    )
    labels = " / ".join(map(huang_trend.kind_name, found.sealings.plunger.rings))
    names = (
        "N·s/m at",
        labels,
        "back-up ring (0.02 to 0.2 MPa)",
        "chamber",
        "total, eq. 26",
        "ring and chamber over seals",
    )
    note = huang_notes.parts_note(found, dry_ring(found.sealings))
    return ExtraTable("Huang 2017: plunger part by part", names, rows, note, drawn)


def kinds_table(_: Design, found: HuangStudy) -> ExtraTable:
    """Why the pressure trends of both cylinders can be opposite, by seal type."""
    rows = [
        (
            one.name,
            text.trimmed(one.balance, 3),
            mega(one.damping[0]),
            mega(one.damping[1]),
            text.number(one.rise, 3),
        )
        for one in found.kinds
    ]
    names = (
        f"seal, {speed_text(TYPICAL)}",
        "balance k",
        "B at 0.6 MPa, MN·s/m",
        "B at 6 MPa",
        "6 over 0.6 MPa",
    )
    note = huang_notes.kinds_note(found)
    return ExtraTable("Huang 2017: why pressure acts both ways", names, rows, note)


def relief_table(_: Design, found: HuangStudy) -> ExtraTable:
    """What the relief of the step ring does to the trend over pressure."""
    both = list(zip(found.whole, found.drained, strict=True)) or [(math.nan, math.nan)] * len(
        found.reliefs
    )
    rows = [
        (
            f"{1e3 * one.relief:.2f} mm",
            f"{1e3 * one.land:.2f} mm",
            text.number(one.balance, 3),
            *(text.number(x, 3) for x in (one.rise, drained, whole)),
        )
        for one, (whole, drained) in zip(found.reliefs, both, strict=True)
    ]
    ink, drawn = huang_figures.relief_figure(found), None
    if ink is not None:
        drawn = Drawing(
            "Huang 2017: relief of the step ring and the trend over pressure",
            ink,
            "The land is the design's while the ring has room for it, then what the relief "
            "leaves. k: pressure balance at 3.3 MPa.",
        )
    names = (
        "relief",
        "land",
        "balance k",
        "B at 6 over 0.6 MPa: alone",
        "both, no pressure between",
        "both, flows matched",
    )
    note = huang_notes.relief_note(found)
    none = [("no step ring", *(text.DASH,) * 5)]
    title = "Huang 2017: relief of the step ring"
    return ExtraTable(title, names, rows or none, note, drawn)


def equations_table(_: Design, found: HuangStudy) -> ExtraTable:
    """Every equation of the paper with its function."""
    return huang_equations.table(found.readings)


TABLES: tuple[Callable[[Design, HuangStudy], ExtraTable], ...] = (
    huang_claims.cylinder_table,
    plunger_table,
    fits_table,
    huang_claims.simulated_table,
    huang_claims.ring_table,
    parts_table,
    kinds_table,
    relief_table,
    equations_table,
)
"""Every table: test A, test B by its figures, the trends, the equations last."""


def tables(evaluation: Evaluation) -> list[ExtraTable]:
    """Every table, of one study."""
    found = study(evaluation.design)
    return [table(evaluation.design, found) for table in TABLES]
