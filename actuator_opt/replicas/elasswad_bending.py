"""The bending modulus of [ElAsswad2018]: what its test leaves open, and why it is no hoop modulus.

The paper prints neither span, section, slope nor rollers. The two spans are the two strokes it
prints, the section is the design's; what else is assumed stands here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from ..design.materials import load_library
from ..evaluation import Evaluation
from ..models import barrel, bending_test, column, rod
from ..rendering import text
from ..rendering.blocks import ExtraTable
from .elasswad_paper import PAPER
from .elasswad_text import (
    COLUMNS,
    in_gpa,
    in_mm,
    in_mpa,
    in_n,
    in_n_per_mm,
    in_um,
    percent,
    value,
    wall_thickness,
)

SPANS = (PAPER.stroke, PAPER.damping_stroke)
ROLLER_RADIUS = 5e-3
"""Rollers as usual in bending tests of composites (m)."""
FORCE = 500.0
"""Where the slope is taken (N)."""
STIFF_END = 20e-3
"""Length of a much stiffer cap over each support (m)."""


@dataclass(frozen=True, slots=True)
class _Tube:
    """The specimen assumed: section, and the library's woven carbon for what bending leaves out."""

    outer_diameter: float
    inner_diameter: float
    warp_modulus: float
    shear_modulus: float
    poissons_ratio: float
    contact_modulus: float

    def second_moment(self, *, solid: bool = False) -> float:
        """Of the tube, or of the solid bar it might be taken for."""
        inner = 0.0 if solid else self.inner_diameter
        return float(rod.second_moment(outer_diameter=self.outer_diameter, inner_diameter=inner))

    @property
    def shear_compliance(self) -> float:
        """1/(kappa G A)."""
        outer, inner = self.outer_diameter, self.inner_diameter
        kappa = column.cowper_tube(poissons_ratio=self.poissons_ratio, radius_ratio=inner / outer)
        area = rod.section_area(outer_diameter=outer, inner_diameter=inner)
        return float(1 / (kappa * self.shear_modulus * area))

    @property
    def local_compliance(self) -> float:
        """Of the three rollers."""
        return float(
            bending_test.indentation_compliance(
                force=FORCE,
                roller_radius=ROLLER_RADIUS,
                specimen_radius=self.outer_diameter / 2,
                contact_modulus=self.contact_modulus,
            )
        )

    def modulus(
        self, span: float, *, solid: bool = False, shear: bool = False, local: bool = False
    ) -> float:
        """Modulus of the tube behind the published one, if eq. 13 left these out."""
        measured = PAPER.bending_slope(span=span, second_moment=self.second_moment(solid=solid))
        return float(
            bending_test.bending_modulus(
                slope=measured,
                span=span,
                second_moment=self.second_moment(),
                shear_compliance=self.shear_compliance if shear else 0.0,
                local_compliance=self.local_compliance if local else 0.0,
            )
        )

    def modulus_between_caps(self, span: float) -> float:
        """The same with stiff caps over the supports."""
        even = self.second_moment()
        stepped = bending_test.equivalent_second_moment(
            second_moments=[1e3 * even, even], steps=[STIFF_END], span=span
        )
        slope = PAPER.bending_slope(span=span, second_moment=even)
        return float(
            bending_test.bending_modulus(slope=slope, span=span, second_moment=float(stepped))
        )

    def hidden(self, span: float) -> tuple[float, float]:
        """What must give beside the tube for woven carbon to look like that; its share of all."""
        even = self.second_moment()
        slope = bending_test.bending_slope(
            youngs_modulus=self.warp_modulus,
            span=span,
            second_moment=even,
            shear_compliance=self.shear_compliance,
        )
        whole = 1 / PAPER.bending_slope(span=span, second_moment=even)
        rest = whole - 1 / float(slope)
        return rest, rest / whole


def _tube(evaluation: Evaluation) -> _Tube:
    woven = load_library().get("woven_cfrp").numbers
    across = woven["poissons_ratio_13"]
    return _Tube(
        outer_diameter=PAPER.bore + 2 * wall_thickness(evaluation),
        inner_diameter=PAPER.bore,
        warp_modulus=woven["youngs_modulus_1"],
        shear_modulus=woven["shear_modulus_12"],
        poissons_ratio=woven["poissons_ratio_12"],
        contact_modulus=woven["youngs_modulus_3"] / (1 - across * across),
    )


def _over_spans(written: Callable[[float], str]) -> str:
    return "; ".join(f"{written(span)} over {in_mm(span)}" for span in SPANS)


def _per_kn(compliance: float) -> str:
    return f"{in_um(1e3 * compliance)}/kN"


def _hidden(tube: _Tube, span: float) -> str:
    rest, share = tube.hidden(span)
    return f"{_per_kn(rest)} ({percent(share)})"


def table(evaluation: Evaluation) -> ExtraTable:
    """What shear, dents and section would make of the bending modulus, and eq. 12 of it."""
    tube = _tube(evaluation)
    supply, growth = evaluation.design.supply.pressure, value(evaluation, "bore_growth")
    thickness = wall_thickness(evaluation)
    wall = PAPER.wall(thickness)
    printed = float(barrel.bore_growth_as_published(pressure=supply, **wall))
    hoop = PAPER.hoop_modulus(growth=growth, pressure=supply, thickness=thickness)
    even = tube.second_moment()
    measured = in_gpa(PAPER.bending_modulus)
    rows = (
        (
            "bending modulus",
            measured,
            _over_spans(lambda x: in_n_per_mm(PAPER.bending_slope(span=x, second_moment=even)))
            + " (k₀ of eq. 13)",
            f"{in_gpa(tube.warp_modulus)} (woven carbon, warp)",
        ),
        *(
            (name, text.DASH, text.DASH, _over_spans(written))
            for name, written in (
                ("shear taken off", lambda x: in_gpa(tube.modulus(x, shear=True))),
                ("dents at the rollers taken off", lambda x: in_gpa(tube.modulus(x, local=True))),
                (
                    f"stiff caps of {in_mm(STIFF_END)} counted",
                    lambda x: in_gpa(tube.modulus_between_caps(x)),
                ),
            )
        ),
        (
            "I of a solid bar in eq. 13, put right",
            text.DASH,
            text.DASH,
            in_gpa(tube.modulus(SPANS[0], solid=True)),
        ),
        (
            "solid bar put right, shear and dents taken off",
            text.DASH,
            text.DASH,
            _over_spans(lambda x: in_gpa(tube.modulus(x, solid=True, shear=True, local=True))),
        ),
        (
            "give that would hide woven carbon",
            text.DASH,
            text.DASH,
            _over_spans(lambda x: _hidden(tube, x)),
        ),
        (
            f"bore growth at {in_mpa(supply)}",
            text.DASH,
            f"{in_um(printed)} (eq. 12 with {measured})",
            f"{in_um(growth)} (hoop modulus {in_gpa(hoop)})",
        ),
    )
    return ExtraTable(
        "El Asswad 2018: bending modulus", COLUMNS, rows, _note(tube, printed / growth)
    )


def _note(tube: _Tube, times: float) -> str:
    """`times` is the growth by eq. 12 over that of the design."""
    wound = load_library().get("t700_epoxy").numbers
    wide = wound["youngs_modulus_1"] / wound["youngs_modulus_2"]
    least = min(tube.modulus_between_caps(span) for span in SPANS)
    most = max(tube.modulus(span, solid=True, shear=True, local=True) for span in SPANS)
    upper = f"to {in_gpa(most)}" if math.isfinite(most) else "without an upper limit"
    return (
        "The paper prints neither span, section, k₀ nor rollers, and says itself that the change "
        "of section is left out. Assumed: the spans (its two strokes), a tube "
        f"{in_mm(tube.outer_diameter)}/{in_mm(tube.inner_diameter)} of woven carbon with "
        f"G = {in_gpa(tube.shear_modulus)}, rollers of {in_mm(ROLLER_RADIUS)} radius at "
        f"{in_n(FORCE)} (Hertz; a thin tube flattens as well). That leaves the modulus open from "
        f"{in_gpa(least)} {upper}, and does not tell a soft wall from a soft test. Whatever it "
        "is, it is stiffness along the axis; eq. 12 needs that around the bore. The two are equal "
        "only where warp and weft are: in a hoop-wound wall they differ "
        f"{text.trimmed(wide, 2)} times. Eq. 12 with {in_gpa(PAPER.bending_modulus)} swells the "
        f"bore {text.trimmed(times, 3)} times as much as the design's wall."
    )
