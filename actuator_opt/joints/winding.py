"""The end of a winding on a metal liner that carries the whole axial force there."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, minimum
from ..models import liner_transfer
from ..models.strength_modes import load_multiplier
from .joint import NOT_BONDED, BarrelLayer, Loaded, MaterialProperties, Strength, Thermal

WINDING_EDGE = "edge of the winding"
"""Location of the shear in rows of strength."""


@dataclass(frozen=True, slots=True)
class WindingEdge:
    """Shear between the innermost layer and the layers around it, at the end of the barrel.

    `line_force` is the largest axial force per circumference [N/m], and `mismatch` the expansion of
    the liner minus that of the winding [1/K], None if unknown. `stiffness` are the arguments of
    `liner_transfer.edge_shear`. `plies` are the materials of the winding.
    """

    materials: MaterialProperties
    plies: tuple[str, ...]
    line_force: Array
    mismatch: Array
    stiffness: dict[str, Array]

    def strength(self, *, cold: bool = False) -> Array:
        """Least interlaminar shear strength of the plies."""
        least: Array = None
        for name in self.plies:
            for key in ("strength_12", "strength_23"):
                value = self.materials.allowable(name, key, cold=cold)
                if value is not None:
                    least = value if least is None else minimum(least, value)
        return least

    def factor(self) -> Array:
        """Shear strength of the plies divided by the shear that the force causes."""
        shear = liner_transfer.edge_shear(
            line_force=self.line_force, strain_difference=0.0, **self.stiffness
        )
        return self.strength() / shear

    def thermal(self) -> Thermal | str:
        """Shear strength divided by the shear of a temperature change, as a function of it."""
        if self.mismatch is None:
            return "thermal expansion of the liner or of the barrel is not known"
        return self._thermal_factor

    def _thermal_factor(self, warming: Array, cold: bool) -> Array:
        shear = liner_transfer.edge_shear(
            line_force=0.0, strain_difference=self.mismatch * warming, **self.stiffness
        )
        return load_multiplier(absolute(shear) / self.strength(cold=cold))


def winding_edge(
    loaded: Loaded, sleeve: BarrelLayer | None = None, *, liners: int = 1
) -> WindingEdge | str | None:
    """The end of the winding; None without a winding, or the reason why it is unknown.

    The winding is on a sleeve or, without one, on the innermost layer. The innermost layers that do
    not belong to it are `liners` in number, at most one. The winding's stiffness is that of the
    whole wall less that of the liner. The mismatch on a liner is that which gives the liner's axial
    stress of the exact wall. That of a sleeve weighs winding and liner by their stiffness.
    """
    end, materials = loaded.end, loaded.materials
    around = end.layers[liners:]
    if not around:
        return None
    liner = end.layers[0] if sleeve is None else sleeve
    modulus, ratio = (
        materials.get(liner.material, k) for k in ("youngs_modulus", "poissons_ratio")
    )
    if modulus is None or ratio is None:
        return f"{liner.material} has no Young's modulus or Poisson's ratio"
    plies, give, thickness = [], 0.0, 0.0
    for layer in around:
        shear = materials.get(layer.material, "shear_modulus_13", "shear_modulus_12")
        if materials.kind(layer.material) != "ply" or shear is None:
            return f"{layer.material} around the liner is not a ply with a shear modulus"
        if materials.allowable(layer.material, "strength_12") is None:
            return f"{layer.material} has no strength_12"
        plies.append(layer.material)
        give, thickness = give + layer.thickness / shear, thickness + layer.thickness
    interface = 2 * pi * (end.inner_radius + liner.thickness)
    area = pi * liner.thickness * (2 * end.inner_radius + liner.thickness)
    inside: Array = 0.0
    for layer in end.layers[:liners]:
        inside = pi * layer.thickness * (2 * end.inner_radius + layer.thickness)
    whole = loaded.line_stiffness * pi * (end.inner_radius + end.outer_radius)
    of_liner = modulus * area / interface
    of_winding = (whole - modulus * inside) / interface
    expansion, mismatch = materials.get(liner.material, "thermal_expansion"), None
    if liners and loaded.warm_liner is not None:
        pull = -loaded.warm_liner * inside / interface  # of the winding, per kelvin
        mismatch = pull * (1 / (modulus * inside / interface) + 1 / of_winding)
    elif expansion is not None and loaded.expansion is not None:
        of_wall = modulus * inside / interface + of_winding
        mismatch = (expansion - loaded.expansion) * of_wall / of_winding
    return WindingEdge(
        materials=materials,
        plies=tuple(plies),
        line_force=loaded.force / interface,
        mismatch=mismatch,
        stiffness={
            "interface_stiffness": liner_transfer.interface_stiffness(
                liner_thickness=liner.thickness,
                liner_shear_modulus=modulus / (2 * (1 + ratio)),
                winding_thickness=thickness,
                winding_shear_modulus=thickness / give,
            ),
            "liner_stiffness": of_liner,
            "winding_stiffness": of_winding,
        },
    )


def with_winding(
    loaded: Loaded, working: Mapping[str, Array], burst: Mapping[str, Array]
) -> Strength | str:
    """Strength of an end from its factors, and those of the end of a winding if there is one.

    The winding is free of stress at the temperature of cure, if that is stated.
    """
    winding = winding_edge(loaded)
    if winding is None:
        return Strength(working, burst, NOT_BONDED)
    if isinstance(winding, str):
        return winding
    edge = {**working, WINDING_EDGE: winding.factor()}
    return Strength(edge, burst, winding.thermal(), cured=True)
