"""Specimen of a bending test: a bar on two supports, or a part of a design."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Literal

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..evaluation import PreparedDesign, compute
from ..models import column, rod

Part = Literal["rod", "barrel"]
POISSON = 0.3
"""Default Poisson's ratio for the shear coefficient (a choice: from 0 to 0.5 the coefficient of a
round section changes by 9 %)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Specimen:
    """The specimen, SI: a round bar or tube, or any section by its second moment.

    Parameters
    ----------
    span : L between the supports [m]
    outer_diameter, inner_diameter : of the round section [m]
    second_moment : I about the neutral axis, or of `equivalent_second_moment`, in place of the
        diameters [m^4]
    depth : of such a section in the plane of bending [m]; without it strains are unknown
    shear_modulus : G of the round section [Pa]
    poissons_ratio : of its shear coefficient [-]
    shear_compliance : 1/(kappa G A), in place of `shear_modulus` [1/N]
    local_compliance : C of indentation, supports and frame, deflection per force [m/N]
    expected_modulus : the material's value, for comparison [Pa]
    """

    span: float
    outer_diameter: float | None = None
    inner_diameter: float = 0.0
    second_moment: float | None = None
    depth: float | None = None
    shear_modulus: float | None = None
    poissons_ratio: float = POISSON
    shear_compliance: float | None = None
    local_compliance: float | None = None
    expected_modulus: float | None = None

    def __post_init__(self) -> None:
        """Reject invalid dimensions."""
        above = ("span", "outer_diameter", "second_moment", "depth", "shear_modulus")
        for name in (*above, "expected_modulus"):
            one = getattr(self, name)
            if one is not None and not (isfinite(one) and one > 0):
                _refuse(f"{name} is {one:g}, it must be above 0", f"state the {name} measured")
        for name in ("inner_diameter", "shear_compliance", "local_compliance"):
            one = getattr(self, name)
            if one is not None and not (isfinite(one) and one >= 0):
                _refuse(f"{name} is {one:g}, it must not be below 0", f"state the {name} measured")
        outer = self.outer_diameter
        if (outer is None) == (self.second_moment is None):
            _refuse(
                "the section is not known" if outer is None else "the section is stated twice",
                "state either outer_diameter and inner_diameter or second_moment",
            )
        if outer is not None and self.inner_diameter >= outer:
            _refuse(
                f"the inner diameter of {1000.0 * self.inner_diameter:g} mm leaves no material "
                f"within the outer one of {1000.0 * outer:g} mm",
                "swap or correct the diameters",
            )
        if self.shear_modulus is not None and (outer is None or self.shear_compliance is not None):
            _refuse(
                "shear_modulus needs the diameters, and excludes shear_compliance",
                "state shear_compliance alone, 1/(kappa G A)",
            )

    @property
    def inertia(self) -> float:
        """Second moment of the section [m^4]."""
        if self.outer_diameter is None:
            return self.second_moment or 0.0
        outer, inner = self.outer_diameter, self.inner_diameter
        return float(rod.second_moment(outer_diameter=outer, inner_diameter=inner))

    @property
    def height(self) -> float | None:
        """Depth in the plane of bending [m]."""
        return self.outer_diameter or self.depth

    @property
    def shear(self) -> float | None:
        """1/(kappa G A) [1/N], if known."""
        outer, inner = self.outer_diameter, self.inner_diameter
        if self.shear_modulus is None or outer is None:
            return self.shear_compliance
        kappa = column.cowper_tube(poissons_ratio=self.poissons_ratio, radius_ratio=inner / outer)
        area = rod.section_area(outer_diameter=outer, inner_diameter=inner)
        return float(1 / (kappa * self.shear_modulus * area))

    def deflection(self, strain: float) -> float | None:
        """Mid-span deflection at a strain of the outer fibre, e L^2/(6 D) [ISO178], [m]."""
        return None if self.height is None else strain * self.span**2 / (6 * self.height)


def specimen_of(subject: PreparedDesign, part: Part, span: float) -> Specimen:
    """A part of a design as a bar; of a single metal its moduli too, G = E/(2 (1 + nu)).

    Parameters
    ----------
    subject : the design
    part : "rod" or "barrel"
    span : between the supports [m]

    Raises
    ------
    InputError
        no such part
    """
    if part not in ("rod", "barrel"):
        raise InputError(Diagnostic(f'part "{part}"', "write rod or barrel"))
    g = compute(subject, subject.values()).geometry
    outer, inner = (
        (g.rod_diameter, g.rod_inner_diameter)
        if part == "rod"
        else (2 * g.outer_radius, 2 * g.inner_radius)
    )
    layers = subject.design.barrel.layup if part == "barrel" else subject.design.rod.layup
    names = {ply.material for ply in layers} if layers else {subject.design.rod.material}
    known = subject.materials[names.pop()].numbers if len(names) == 1 else {}
    modulus, poisson = known.get("youngs_modulus"), known.get("poissons_ratio")
    shear = None if modulus is None or poisson is None else modulus / (2 * (1 + poisson))
    return Specimen(
        span=span,
        outer_diameter=float(np.squeeze(outer)),
        inner_diameter=float(np.squeeze(inner)),
        shear_modulus=shear,
        expected_modulus=None if shear is None else modulus,
    )


def _refuse(message: str, remedy: str) -> None:
    raise InputError(Diagnostic(f"bending specimen: {message}", remedy))
