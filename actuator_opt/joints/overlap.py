"""Bonded overlaps of caps on the barrel and of metal fittings in a laminated rod; skirts of caps.

Shear at both edges of the overlap is calculated under force alone, and under temperature alone at
the lowest and the highest temperature. The two are not added: their elastic sum is too high for an
adhesive that yields before it breaks. If the plastic shear strain of the adhesive is known, the
breaking force at each temperature is calculated too, which combines both. Bonded and screwed joints
share the code for skirts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from math import pi

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, minimum
from ..models import end_bending, lap_joint, mass
from ..models.strength_modes import load_multiplier
from .joint import (
    DrawnPart,
    EdgeBeside,
    End,
    EndDimensions,
    EndSpan,
    Loaded,
    MaterialProperties,
    Thermal,
)

BOND_THICKNESS = 0.15e-3
"""Thickness of a bond whose adhesive states none [m]. Our choice: glass beads of this size."""

TO_YOUNG = 2.6
"""Young's modulus divided by shear modulus, 2 (1 + nu), of an adhesive that states no Young's
modulus: Poisson's ratio 0.3, our choice."""


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
        return lag(materials, self.adhesive, self.length)

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

    def ultimate_factor(
        self, materials: MaterialProperties, force: Array, warming: Array, cold: bool
    ) -> Array:
        """Breaking force of the bond divided by a force, after a temperature change [K].

        It needs the adhesive's plastic shear strain and both thermal expansions.
        """
        common = self._adhesive(materials) | {
            "strength": materials.allowable(self.adhesive, "bond_strength", cold=cold),
            "plastic_shear_strain": materials.get(self.adhesive, "plastic_shear_strain"),
        }
        mismatch = self.mismatch * warming
        at_metal, at_tube = (
            lap_joint.ultimate_line_force(
                strain_difference=difference,
                membrane_stiffness_loaded=loaded,
                membrane_stiffness_free=free,
                **common,
            )
            for difference, loaded, free in (
                (-mismatch, self.tube, self.metal),
                (mismatch, self.metal, self.tube),
            )
        )
        return minimum(at_metal, at_tube) * (pi * self.diameter) / force

    def ductile(self, materials: MaterialProperties) -> bool:
        """Whether the data for `ultimate_factor` are known."""
        strain = materials.get(self.adhesive, "plastic_shear_strain")
        return strain is not None and self.mismatch is not None

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


def lag(materials: MaterialProperties, adhesive: str, length: Array) -> dict[str, Array]:
    """Keyword arguments that all lap-joint models share: bond length, thickness and modulus."""
    return {
        "length": length,
        "shear_modulus": materials.get(adhesive, "shear_modulus"),
        "bond_thickness": materials.get(adhesive, "bond_thickness", default=BOND_THICKNESS),
    }


def of_skirt(loaded: Loaded) -> Overlap | str:
    """The bonded overlap of skirt and barrel, or the reason why it cannot be assessed."""
    end, materials = loaded.end, loaded.materials
    if end.material is None:
        return "a bond needs an adhesive: add retention.material"
    modulus = materials.get(end.cap, "youngs_modulus")
    adhesive = (materials.get(end.material, key) for key in ("bond_strength", "shear_modulus"))
    if any(value is None for value in (modulus, *adhesive)):
        return "the adhesive has no bond strength or shear modulus, or the caps have no modulus"
    around = 2 * pi * end.outer_radius
    skirt = mass.layer_area(inner_radius=end.outer_radius, thickness=end.sizes["wall"])
    return Overlap(
        adhesive=end.material,
        diameter=2 * end.outer_radius,
        length=end.sizes["length"],
        tube=loaded.line_stiffness * pi * (end.inner_radius + end.outer_radius) / around,
        metal=modulus * skirt / around,
        mismatch=mismatch(materials, end.cap, loaded.expansion),
        names=("barrel", "skirt"),
    )


def peel(
    loaded: Loaded, place: str, edge: Array, *, layer: int = -1, thickness: Array = None
) -> dict[str, Array]:
    """Strength across the plies of a layer divided by the peel stress at a skirt's edge, by place.

    `edge` is the bond strength divided by the shear stress there, and `thickness` that of the
    skirt's edge, by default that of the outer skirt. A metal layer has no such row, as the peel
    strength of adhesives is not part of their data.
    """
    end, materials = loaded.end, loaded.materials
    assert end.material is not None
    bonded = end.layers[layer].material
    strength = materials.allowable(bonded, "strength_2_tension")
    ratio = materials.get(end.cap, "poissons_ratio")
    if materials.kind(bonded) != "ply" or strength is None or ratio is None:
        return {}
    shear_modulus = materials.get(end.material, "shear_modulus")
    stress = lap_joint.edge_peel(
        shear=materials.allowable(end.material, "bond_strength") / edge,
        adhesive_modulus=materials.get(
            end.material, "youngs_modulus", default=TO_YOUNG * shear_modulus
        ),
        bond_thickness=materials.get(end.material, "bond_thickness", default=BOND_THICKNESS),
        skirt_modulus=materials.get(end.cap, "youngs_modulus"),
        skirt_poissons_ratio=ratio,
        skirt_thickness=end.sizes["wall"] if thickness is None else thickness,
    )
    return {place: strength / stress}


def mean_envelope(loaded: Loaded, burst: Mapping[str, Array]) -> dict[str, Array]:
    """Upper bound of a bond's safety factor: the largest shear is at least the mean shear.

    The first row of `burst` is that of the mean shear.
    """
    return {"mean shear of the bond": next(iter(burst.values()))} if burst else {}


def apart(loaded: Loaded) -> Iterator[tuple[str, str]]:
    """Warn that force and heat are checked apart if the adhesive's data allow no more."""
    bond = of_skirt(loaded)
    if not isinstance(bond, str) and not bond.ductile(loaded.materials):
        yield (
            "retention_burst_factor",
            "force and temperature act on the bond together, but are checked apart: state "
            f"plastic_shear_strain of {loaded.end.material} to check both",
        )


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


BESIDE = "beside the skirt"
"""End of the names of rows where the barrel leaves a skirt and bends."""


def metal_shell(
    materials: MaterialProperties, name: str, thickness: Array
) -> end_bending.ShellLayer | None:
    """Stiffness of a metal layer against bending; None if an elastic constant is unknown."""
    modulus, ratio = (materials.get(name, key) for key in ("youngs_modulus", "poissons_ratio"))
    if modulus is None or ratio is None:
        return None
    stiffness = modulus / (1 - ratio * ratio)
    return end_bending.ShellLayer(
        thickness, stiffness, stiffness, ratio * stiffness, modulus / (2 * (1 + ratio))
    )


def edge_beside(loaded: Loaded) -> EdgeBeside | None:
    """The edge of the barrel beside a skirt; None if an elastic constant is unknown.

    Skirt and barrel are one wall up to the skirt's edge, where the force passes from one to the
    other. This changes growth and middle of the wall, so that the barrel bends. A skirt in the
    bore is part of this wall too, and a tapered one counts with its full wall, which is an upper
    bound.
    """
    if "edge beside" not in loaded.end.cache:
        loaded.end.cache["edge beside"] = _edge_beside(loaded)
    edge: EdgeBeside | None = loaded.end.cache["edge beside"]
    return edge


def _edge_beside(loaded: Loaded) -> EdgeBeside | None:
    end, inner = loaded.end, loaded.end.sizes.get("inner_wall", None)
    outside = metal_shell(loaded.materials, end.cap, end.sizes["wall"])
    if not loaded.shells or outside is None:
        return None
    within = None if inner is None else metal_shell(loaded.materials, end.cap, inner)
    inside, bore = (0.0, end.inner_radius) if within is None else (inner, end.inner_radius - inner)
    barrel = end_bending.shell(layers=loaded.shells, inner_radius=end.inner_radius)
    layers = [*loaded.shells, outside] if within is None else [within, *loaded.shells, outside]
    whole = end_bending.shell(layers=layers, inner_radius=bore)
    free, under = (
        end_bending.free_growth(
            wall=wall,
            pressure=loaded.pressure,
            bore_radius=radius,
            line_force=loaded.force / (2 * pi * wall.radius),
        )
        for wall, radius in ((barrel, end.inner_radius), (whole, bore))
    )
    line_force = loaded.force / (2 * pi * barrel.radius)
    edge = end_bending.stepped(
        left=whole,
        right=barrel,
        left_growth=under,
        right_growth=free,
        offset_moment=line_force * (barrel.centre + inside - whole.centre),
    )
    return EdgeBeside(BESIDE, barrel, edge, free)


def yields(loaded: Loaded) -> dict[str, Array]:
    """Yield strength of the skirt divided by its stress under the separating force."""
    end = loaded.end
    strength = loaded.materials.allowable(end.cap, "yield_strength")
    if strength is None:
        return {}
    return {"cap skirt": strength * (2 * pi * end.outer_radius * end.sizes["wall"]) / loaded.force}
