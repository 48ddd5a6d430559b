"""Bonded overlaps of caps on the barrel and of metal fittings in a laminated rod; skirts of caps.

Shear at both edges of the overlap is calculated under force alone, and under temperature alone at
the lowest and the highest temperature. The two are not added: their elastic sum is too high for an
adhesive that yields before it breaks. Bonded and screwed joints share the code for skirts.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import pi

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute
from ..models import lap_joint, mass
from ..models.strength_modes import load_multiplier
from .joint import DrawnPart, End, EndDimensions, EndSpan, Loaded, MaterialProperties, Thermal


@dataclass(frozen=True, slots=True)
class Overlap:
    """A bonded overlap of a metal part with a tube.

    `tube` and `metal` are the axial E t of both walls at the bond's diameter [N/m]. `mismatch` is
    the thermal expansion of the metal minus that of the tube [1/K], None if unknown. `names` are
    the words for tube and metal part in texts.
    """

    adhesive: str
    diameter: Array
    length: Array
    tube: Array
    metal: Array
    mismatch: Array
    names: tuple[str, str]

    def _adhesive(self, materials: MaterialProperties) -> dict[str, Array]:
        """Keyword arguments that all lap-joint models share: bond length, thickness and modulus."""
        return {
            "length": self.length,
            "shear_modulus": materials.get(self.adhesive, "shear_modulus"),
            "bond_thickness": materials.get(self.adhesive, "bond_thickness", default=0.15e-3),
        }

    def edge_factors(self, materials: MaterialProperties, force: Array) -> dict[str, Array]:
        """Bond strength divided by the elastic peak shear stress under a force, at both edges."""
        strength = materials.allowable(self.adhesive, "bond_strength")
        tube, metal = self.names
        factors = {}
        for edge, loaded, free in (
            (metal, self.tube, self.metal),
            (tube, self.metal, self.tube),
        ):
            stress = lap_joint.bond_edge_shear(
                force=force,
                diameter=self.diameter,
                membrane_stiffness_loaded=loaded,
                membrane_stiffness_free=free,
                **self._adhesive(materials),
            )
            factors[f"bond at the {edge}'s edge"] = strength / stress
        return factors

    def least_peak_ratio(self, materials: MaterialProperties, stiffness: Array) -> Array:
        """Lower bound of peak shear / mean shear in the bond, from the stiffness of one wall."""
        return lap_joint.least_bond_peak_ratio(
            membrane_stiffness=stiffness, **self._adhesive(materials)
        )

    def mean_factor(self, materials: MaterialProperties, force: Array) -> Array:
        """Bond strength divided by mean shear stress under a force."""
        strength = materials.allowable(self.adhesive, "bond_strength")
        return strength * (pi * self.diameter * self.length) / force

    def thermal_factor(self, materials: MaterialProperties, warming: Array, cold: bool) -> Array:
        """Bond strength divided by the shear at the edges that a temperature change causes.

        `warming` is the temperature minus that at joining [K].
        """
        stress = lap_joint.bond_thermal_shear(
            strain_difference=self.mismatch * warming,
            membrane_stiffness_1=self.tube,
            membrane_stiffness_2=self.metal,
            **self._adhesive(materials),
        )
        strength = materials.allowable(self.adhesive, "bond_strength", cold=cold)
        return load_multiplier(absolute(stress) / strength)

    def thermal(self, materials: MaterialProperties) -> Thermal | str:
        """`thermal_factor` with the materials filled in, or the reason why it is unknown."""
        if self.mismatch is None:
            return f"thermal expansion of the {' or of the '.join(self.names)} is not known"
        return partial(self.thermal_factor, materials)


def mismatch(materials: MaterialProperties, metal: str, tube: Array) -> Array:
    """Axial thermal expansion of the metal minus that of the tube [1/K]; None if unknown."""
    metal_expansion = materials.get(metal, "thermal_expansion")
    return None if metal_expansion is None or tube is None else metal_expansion - tube


def fit(end: End, radius: Array) -> EndDimensions:
    """Dimensions of a skirt with this inner radius over the end of the barrel."""
    wall = end.sizes["wall"]
    return EndDimensions(
        plate_radius=radius + wall, radius=radius, length=end.sizes["length"], wall=wall
    )


def weight(end: End, materials: MaterialProperties, radius: Array) -> Array:
    """Mass of a skirt [kg]."""
    density = materials.get(end.cap, "density")
    section = mass.layer_area(inner_radius=radius, thickness=end.sizes["wall"])
    return density * section * end.sizes["length"]


def outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    """Outline of the skirt at one end."""
    length, inner = float(fit.length), float(fit.radius)
    if length > 0:
        yield DrawnPart("caps", end.cap, span.over(length, inner, inner + float(fit.wall)))


def yields(loaded: Loaded) -> dict[str, Array]:
    """Yield strength of the skirt divided by its stress under the separating force."""
    end = loaded.end
    strength = loaded.materials.allowable(end.cap, "yield_strength")
    if strength is None:
        return {}
    return {"cap skirt": strength * (2 * pi * end.outer_radius * end.sizes["wall"]) / loaded.force}
