"""The values of [ElAsswad2018] in the paper's formulas and in ours: oil, wall, bending, record.

The paper prints neither span, section, slope nor rollers of its bending test: the spans are the two
strokes that it prints, the section is the design's, and the other assumptions are named here. It
gives no number of its pressure record either, so the record is our own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..design.materials import load_library
from ..design.seals import Seal
from ..evaluation import Evaluation
from ..models import (
    barrel,
    bending_test,
    column,
    damping,
    forces,
    friction,
    rod,
    seals,
    stiffness,
    stiffness_published as published,
)
from .papers import published_numbers

POISSONS_RATIO = 0.3
"""Poisson's ratio of the barrel in eq. 12: assumed, as the paper prints none."""


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Zero of a falling function by bisection; without a zero inside, an end of the bracket."""
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) > 0 else (low, middle)
    return (low + high) / 2


@dataclass(frozen=True, slots=True)
class ElasswadPaper:
    """Values printed in the paper, SI; ``notes/elasswad.yaml`` states where."""

    bore: float
    piston_diameter: float
    rod_diameter: float
    stroke: float
    damping_stroke: float
    damping: float
    bulk_modulus: float
    oil_stiffness: float
    rod_stiffness: float
    bending_modulus: float
    friction_average: float
    friction_largest: float
    loss_average: float
    loss_largest: float
    friction_coefficient: float

    @property
    def area(self) -> float:
        """Area of the bore of table 1."""
        return float(forces.piston_area(bore=self.bore))

    @property
    def rod_modulus_per_length(self) -> float:
        """Modulus / length [Pa/m] that gives the printed rod stiffness with the full section."""
        return float(self.rod_stiffness / rod.section_area(outer_diameter=self.rod_diameter))

    @property
    def viscosity(self) -> float:
        """Dynamic viscosity that eq. 6 needs for the printed damping over its stroke."""
        return self.damping / float(
            damping.pipe_flow(dynamic_viscosity=1.0, length=self.damping_stroke)
        )

    def oil(self, *, line_volume: float, bore: float) -> float:
        """Eq. 9 at mid-stroke with the same line volume on both sides."""
        area_a = forces.piston_area(bore=bore)
        area_b = forces.annulus_area(bore=bore, rod_diameter=self.rod_diameter)
        return float(
            published.oil_stiffness_as_published(
                bulk_modulus_a=self.bulk_modulus,
                bulk_modulus_b=self.bulk_modulus,
                area_a=area_a,
                area_b=area_b,
                volume_a=area_a * self.stroke / 2 + line_volume,
                volume_b=area_b * self.stroke / 2 + line_volume,
            )
        )

    def line_volume(self, *, bore: float) -> float:
        """Line volume per side at which eq. 9 gives the published oil stiffness."""
        return root(
            lambda volume: self.oil(line_volume=volume, bore=bore) - self.oil_stiffness, 0.0, 1e-3
        )

    def wall(self, thickness: float) -> dict[str, float]:
        """Inputs of eq. 12 for the barrel: published bore and modulus, and an assumed thickness."""
        return {
            "inner_radius": self.bore / 2,
            "outer_radius": self.bore / 2 + thickness,
            "youngs_modulus": self.bending_modulus,
            "poissons_ratio": POISSONS_RATIO,
        }

    def hoop_modulus(self, *, growth: float, pressure: float, thickness: float) -> float:
        """Modulus at which eq. 12, with the inner radius, gives a growth of the bore."""
        correct = barrel.bore_growth(pressure=pressure, **self.wall(thickness))
        return self.bending_modulus * float(correct) / growth

    def bending_slope(self, *, span: float, second_moment: float) -> float:
        """Slope, force / deflection, that gives the published modulus by eq. 13."""
        return float(
            bending_test.bending_slope(
                youngs_modulus=self.bending_modulus, span=span, second_moment=second_moment
            )
        )

    def pressure(self, *, force: float, contact_width: float) -> float:
        """Pressure at which eq. 15 to 20 give a friction force, if it acts fully on both rings."""
        unit = friction.coulomb_as_published(
            pressure=1.0,
            friction_coefficient=self.friction_coefficient,
            piston_contact_width=contact_width,
            rod_contact_width=contact_width,
            bore=self.bore,
            rod_diameter=self.rod_diameter,
        )
        return force / float(unit)

    def total(self, barrel_stiffness: float) -> float:
        """Total stiffness by eq. 7 with the published oil and rod stiffness."""
        return float(
            published.series_of_totals_as_published(
                oil=self.oil_stiffness, barrel=barrel_stiffness, rod=self.rod_stiffness
            )
        )


PAPER = published_numbers(ElasswadPaper, "elasswad")

SPANS = (PAPER.stroke, PAPER.damping_stroke)

ROLLER_RADIUS = 5e-3
"""Radius of the rollers, as usual in bending tests of composites (m)."""

FORCE = 500.0
"""Force at which the slope is taken (N)."""

STIFF_END = 20e-3
"""Length of a much stiffer cap over each support (m)."""


@dataclass(frozen=True, slots=True)
class Tube:
    """The assumed specimen: its section, and the constants of the library's woven carbon."""

    outer_diameter: float
    inner_diameter: float
    warp_modulus: float
    shear_modulus: float
    poissons_ratio: float
    contact_modulus: float

    def second_moment(self, *, solid: bool = False) -> float:
        """Second moment of the tube, or of a solid bar of the same diameter."""
        inner = 0.0 if solid else self.inner_diameter
        return float(rod.second_moment(outer_diameter=self.outer_diameter, inner_diameter=inner))

    @property
    def shear_compliance(self) -> float:
        """Shear compliance per length, 1/(kappa G A).

        kappa is the shear coefficient, G the shear modulus, A the area of the section.
        """
        outer, inner = self.outer_diameter, self.inner_diameter
        kappa = column.cowper_tube(poissons_ratio=self.poissons_ratio, radius_ratio=inner / outer)
        area = rod.section_area(outer_diameter=outer, inner_diameter=inner)
        return float(1 / (kappa * self.shear_modulus * area))

    @property
    def local_compliance(self) -> float:
        """Deflection per force at the three rollers."""
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
        """Modulus of the tube after correcting the published value of eq. 13 for given effects."""
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
        """Modulus of the tube with stiff caps over the supports."""
        even = self.second_moment()
        stepped = bending_test.equivalent_second_moment(
            second_moments=[1e3 * even, even], steps=[STIFF_END], span=span
        )
        slope = PAPER.bending_slope(span=span, second_moment=even)
        return float(
            bending_test.bending_modulus(slope=slope, span=span, second_moment=float(stepped))
        )

    def hidden(self, span: float) -> tuple[float, float]:
        """Compliance missing for woven carbon to give the published slope, and its share of all."""
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


def tube_of(evaluation: Evaluation) -> Tube:
    """The assumed specimen: woven carbon with the design's wall on the published bore."""
    woven = load_library().get("woven_cfrp").numbers
    across = woven["poissons_ratio_13"]
    return Tube(
        outer_diameter=PAPER.bore + 2 * wall_thickness(evaluation),
        inner_diameter=PAPER.bore,
        warp_modulus=woven["youngs_modulus_1"],
        shear_modulus=woven["shear_modulus_12"],
        poissons_ratio=woven["poissons_ratio_12"],
        contact_modulus=woven["youngs_modulus_3"] / (1 - across * across),
    )


SPEED = 0.1
"""Largest piston speed of the record where no load case states one (m/s)."""


@dataclass(frozen=True, slots=True)
class StrokeRecord:
    """Time [s], pressure difference [Pa], and piston position as a share of the stroke."""

    time: Array
    pressure: Array
    place: Array


@dataclass(frozen=True, slots=True)
class Along:
    """Radial expansion [m] and equivalent stiffness [N/m] at every time of a record.

    Fields end in the method: the published formulas, the paper's numbers in the correct formulas,
    or the design.
    """

    growth_published: Array
    growth_inner: Array
    growth_designed: Array
    stiffness_published: Array
    stiffness_chambers: Array
    stiffness_designed: Array


def pressure_record(
    *, average: float, largest: float, stroke: float, speed: float, count: int = 241
) -> StrokeRecord:
    """One stroke out and back: a pulse of pressure each way, zero where the piston turns.

    x = s/2 (1 - cos(wt)), s w/2 the largest speed; p = p_max (a q + (1 - a) q^2), q = sin^2(wt),
    whose mean is p_max (3 + a)/8.

    Parameters
    ----------
    average, largest : pressure difference [Pa]
    stroke : [m]
    speed : largest piston speed [m/s]
    count : of times

    Returns
    -------
    the record
    """
    turn = np.linspace(0.0, 2 * pi, count)
    pulse = np.sin(turn) ** 2
    share = 8 * average / largest - 3
    return StrokeRecord(
        time=turn * stroke / (2 * speed),
        pressure=largest * pulse * (share + (1 - share) * pulse),
        place=(1 - np.cos(turn)) / 2,
    )


def own_record(evaluation: Evaluation) -> StrokeRecord:
    """The record whose pressures give the published friction, 166 N on average and 400 N at most.

    Friction follows from eq. 15 to 20 with the published coefficient and the design's ring.
    """
    width = chord(evaluation.design.seals.piston)
    return pressure_record(
        average=PAPER.pressure(force=PAPER.friction_average, contact_width=width),
        largest=PAPER.pressure(force=PAPER.friction_largest, contact_width=width),
        stroke=evaluation.design.cylinder.stroke,
        speed=max(case.speed for case in evaluation.design.load_cases) or SPEED,
    )


def chambers(place: Array, *, growth_per_pressure: float) -> Array:
    """Stiffness per chamber with the numbers of the paper, at positions of the piston.

    A^2/C of both chambers, C = V/K + dV/dp of the swelling bore, in series with k_rod. V includes
    the line volume behind the published k_oil.
    """
    line = PAPER.line_volume(bore=PAPER.bore)
    areas = (
        PAPER.area,
        float(forces.annulus_area(bore=PAPER.bore, rod_diameter=PAPER.rod_diameter)),
    )
    compliances = [
        stiffness.chamber_compliance(
            volume=area * length + line,
            bulk_modulus=PAPER.bulk_modulus,
            wall_compliance=barrel.chamber_compliance(
                inner_radius=PAPER.bore / 2, growth_per_pressure=growth_per_pressure, length=length
            ),
        )
        for area, length in zip(
            areas, (PAPER.stroke * place, PAPER.stroke * (1 - place)), strict=True
        )
    ]
    hydraulic = stiffness.hydraulic_stiffness(
        area_a=areas[0], compliance_a=compliances[0], area_b=areas[1], compliance_b=compliances[1]
    )
    return stiffness.series(hydraulic, PAPER.rod_stiffness)


def along(evaluation: Evaluation, record: StrokeRecord) -> Along:
    """Expansion and stiffness, by the published and derived formulas, at every time of a record."""
    wall = PAPER.wall(wall_thickness(evaluation))
    printed, grown = published.equivalent_stiffness_as_published(
        pressure=record.pressure,
        bore=PAPER.bore,
        outer_diameter=2 * wall["outer_radius"],
        youngs_modulus=wall["youngs_modulus"],
        poissons_ratio=wall["poissons_ratio"],
        stroke=PAPER.stroke,
        oil=PAPER.oil_stiffness,
        rod=PAPER.rod_stiffness,
    )
    unit = float(barrel.bore_growth(pressure=1.0, **wall))
    curve, design = evaluation.curve, evaluation.design
    ours = value(evaluation, "bore_growth") / design.supply.pressure
    return Along(
        growth_published=grown,
        growth_inner=unit * record.pressure,
        growth_designed=ours * record.pressure,
        stiffness_published=printed,
        stiffness_chambers=chambers(record.place, growth_per_pressure=unit),
        stiffness_designed=np.interp(
            record.place * design.cylinder.stroke, curve.position, curve.stiffness
        ),
    )


def value(evaluation: Evaluation, name: str) -> float:
    """Value of a metric; NaN without a value."""
    number = evaluation.metrics[name].value
    return float("nan") if number is None else number


def properties(evaluation: Evaluation, name: str) -> Mapping[str, float]:
    """Values of a material from library and design; empty for a material from the user's files."""
    library = load_library()
    known = library.get(name).numbers if name in library else {}
    return {**known, **evaluation.design.materials.get(name, {})}


def wall_thickness(evaluation: Evaluation) -> float:
    """Thickness of the design's barrel, used because the paper prints none."""
    return sum(layer.thickness for layer in evaluation.design.barrel.layup)


def chord(ring: Seal) -> float:
    """Contact width of a ring by eq. 19, before the bore grows."""
    height = ring.section * (1 - ring.squeeze)
    return float(seals.width_as_published(section=ring.section, gland_height=height))
