"""The numbers that [ElAsswad2018] prints, and what its own formulas make of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..models import (
    barrel,
    bending_test,
    damping,
    forces,
    friction,
    rod,
    stiffness_published as published,
)

POISSONS_RATIO = 0.3
"""Of the barrel in eq. 12; the paper prints none. Assumed, as usual for its isotropic form."""


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a falling function is zero, by bisection; an end of the bracket where it never is."""
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) > 0 else (low, middle)
    return (low + high) / 2


@dataclass(frozen=True, slots=True)
class Paper:
    """What the paper prints, SI; the comment is its place."""

    bore: float = 25e-3  # table 1
    piston_diameter: float = 20e-3  # table 1
    rod_diameter: float = 12e-3  # table 1
    stroke: float = 110e-3  # table 1
    damping_stroke: float = 150e-3  # text on eq. 6
    damping: float = 0.1  # text on eq. 6
    bulk_modulus: float = 800e6  # text on eq. 9
    oil_stiffness: float = 2480e3  # text on eq. 9
    rod_stiffness: float = 13430e3  # text on eq. 8
    bending_modulus: float = 3.48e9  # text on eq. 13
    friction_average: float = 166.0  # text on fig. 11
    friction_largest: float = 400.0  # text on fig. 11
    loss_average: float = 0.12e6  # text on fig. 11
    loss_largest: float = 0.31e6  # text on fig. 11
    friction_coefficient: float = 0.61  # abstract

    @property
    def area(self) -> float:
        """Area of the bore of table 1."""
        return float(forces.piston_area(bore=self.bore))

    @property
    def rod_modulus_per_length(self) -> float:
        """E/L that the rod stiffness means for the full section, Pa/m."""
        return float(self.rod_stiffness / rod.section_area(outer_diameter=self.rod_diameter))

    @property
    def viscosity(self) -> float:
        """Dynamic viscosity that eq. 6 needs for the damping over its own stroke."""
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
        """The barrel as eq. 12 takes it: the published bore and modulus, an assumed thickness."""
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
        """Force over deflection behind the published modulus by eq. 13."""
        return float(
            bending_test.bending_slope(
                youngs_modulus=self.bending_modulus, span=span, second_moment=second_moment
            )
        )

    def pressure(self, *, force: float, contact_width: float) -> float:
        """Pressure at which eq. 15 to 20 give a friction force, both rings under all of it."""
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
        """Eq. 7 with the published oil and rod stiffness."""
        return float(
            published.series_of_totals_as_published(
                oil=self.oil_stiffness, barrel=barrel_stiffness, rod=self.rod_stiffness
            )
        )


PAPER = Paper()
