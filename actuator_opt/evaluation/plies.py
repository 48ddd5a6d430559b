"""Layers of a laminated wall or rod, as inputs of models; strengths are after knock-downs.

Residual stresses matter at both ends of the temperature range. In the cold, cooling from cure is
largest; in the heat, the matrix is weakest. Each `Climate` has the strengths at its temperature.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, real
from ..design.model import Design, Ply
from ..models.burst_ladder import WallLayer
from ..models.layered_tube import TubeLayer
from ..models.ply import Stiffness, ply_stiffness
from ..models.solid_ply import Solid, solid_stiffness
from ..models.strength import CRITERIA
from ..models.strength_modes import PlyRatios, PlyStrength, Stress
from .limits import MaterialValues
from .values import Values

STRENGTHS = (
    "strength_1_tension",
    "strength_1_compression",
    "strength_2_tension",
    "strength_2_compression",
    "strength_12",
)
"""Strengths of a ply, in the order of `PlyStrength`."""


@dataclass(frozen=True, slots=True)
class Climate:
    """The lowest or highest service temperature, for strengths and residual stresses.

    `change` is the temperature change from the stress-free state [K]; `cold` selects the strengths
    at the lowest temperature.
    """

    name: str
    change: Array
    cold: bool


def plane_stiffness(constants: Mapping[str, Array]) -> Stiffness:
    """Reduced stiffness of a ply with these elastic constants, in plane stress."""
    return ply_stiffness(
        youngs_modulus_1=constants["youngs_modulus_1"],
        youngs_modulus_2=constants["youngs_modulus_2"],
        poissons_ratio_12=constants["poissons_ratio_12"],
        shear_modulus_12=constants["shear_modulus_12"],
    )


@dataclass(frozen=True, slots=True)
class Layer:
    """A layer with its properties.

    `strengths` and `yields` have one entry per `Climate` (service temperature) if known.
    """

    label: str
    name: str
    isotropic: bool
    constants: dict[str, Array]
    solid: Solid
    angle: Array
    balanced: bool
    thickness: Array
    strengths: tuple[PlyStrength, ...]
    yields: tuple[Array, ...]
    fatigue: Array = None
    """Fibre stress amplitude at failure after the stated number of cycles; None if unknown."""

    @property
    def strength(self) -> PlyStrength | None:
        """Ply strengths at the highest temperature (weakest matrix); None for a metal."""
        return self.strengths[-1] if self.strengths else None

    @property
    def yield_strength(self) -> Array:
        """Yield strength at the highest temperature; None for a ply."""
        return self.yields[-1] if self.yields else None

    @property
    def expansions(self) -> tuple[Array, Array] | None:
        """Thermal expansions along and across the fibre; None if not stated."""
        first = self.constants.get("thermal_expansion_1")
        second = self.constants.get("thermal_expansion_2")
        return None if first is None or second is None else (first, second)

    @property
    def plane_stiffness(self) -> Stiffness:
        """Reduced stiffness in plane stress, along and across the fibre."""
        return plane_stiffness(self.constants)

    def as_tube(self) -> TubeLayer:
        """The layer as input of the exact model of a layered tube."""
        first, second = self.expansions or (0.0, 0.0)
        return TubeLayer(
            stiffness=self.solid,
            thickness=self.thickness,
            angle=self.angle,
            balanced=self.balanced,
            expansion_1=first,
            expansion_2=second,
            expansion_3=second,
        )

    def as_wall(self, climate: int | None = None) -> WallLayer:
        """The layer as input of the burst models.

        `climate` is the index of a service temperature, at which the strengths are taken. None: the
        strengths at all service temperatures, (climates, 1, designs).
        """
        c, (first, second) = self.constants, self.expansions or (0.0, 0.0)
        return WallLayer(
            expansion_1=first,
            expansion_2=second,
            youngs_modulus_1=c["youngs_modulus_1"],
            youngs_modulus_2=c["youngs_modulus_2"],
            youngs_modulus_3=c["youngs_modulus_3"],
            poissons_ratio_12=c["poissons_ratio_12"],
            poissons_ratio_13=c["poissons_ratio_13"],
            poissons_ratio_23=c["poissons_ratio_23"],
            shear_modulus_12=c["shear_modulus_12"],
            thickness=self.thickness,
            angle=self.angle,
            strength=_of_climate(self.strengths, climate, _of_all),
            yield_strength=_of_climate(self.yields, climate, _axis),
            material=self.name,
        )


def stress_of(parts: Iterable[Array]) -> Stress:
    """Ply stresses in directions 1, 2 and 3 and shear stress 12, as a tuple of four."""
    along, across, through, shear = parts
    return along, across, through, shear


def _of_climate(values: Sequence[Any], climate: int | None, combine: Callable[..., Any]) -> Any:
    """The value at one service temperature, or the combined values of all if `climate` is None."""
    if not values:
        return None
    if climate is not None:
        return values[climate]
    return values[0] if len(values) == 1 else combine(values)


def _axis(values: Sequence[Array]) -> Array:
    """Stack values, one per service temperature, to (climates, 1, designs).

    The second axis is for load paths.
    """
    return np.stack(np.broadcast_arrays(*[np.atleast_1d(value) for value in values]))[:, None, :]


def _of_all(strengths: Sequence[PlyStrength]) -> PlyStrength:
    """Combine the ply strengths at all service temperatures into arrays."""

    def of_climates(name: str) -> Array:
        return _axis([getattr(strength, name) for strength in strengths])

    has_shear_23 = all(strength.shear_23 is not None for strength in strengths)
    return PlyStrength(
        of_climates("tension_1"),
        of_climates("compression_1"),
        of_climates("tension_2"),
        of_climates("compression_2"),
        of_climates("shear_12"),
        of_climates("shear_23") if has_shear_23 else None,
    )


def climates(v: Values, design: Design) -> tuple[Climate, ...]:
    """Lowest and highest service temperature, with their temperature change from cure.

    Without a cure temperature, there is a single climate without cure stress.
    """
    environment = design.environment
    if environment is None or environment.cure_temperature is None:
        return (Climate("", 0.0, cold=False),)
    cure = v["environment.cure_temperature"]
    return (
        Climate("cold", v["environment.temperature_min"] - cure, cold=True),
        Climate("hot", v["environment.temperature_max"] - cure, cold=False),
    )


def warmings(v: Values, design: Design) -> dict[str, Array]:
    """Temperature changes since assembly, cold and hot [K]; empty without a temperature range."""
    if design.environment is None:
        return {}
    start = v["environment.assembly_temperature"]
    return {
        "cold": v["environment.temperature_min"] - start,
        "hot": v["environment.temperature_max"] - start,
    }


def layers(
    v: Values,
    stock: MaterialValues,
    layup: Sequence[Ply],
    at: str,
    states: Sequence[Climate],
    missing: list[str],
) -> list[Layer]:
    """Layers of the wall with the lay-up at PATH `at`; unknown strengths are added to `missing`."""
    wall_layers = []
    for i, ply in enumerate(layup):
        name = ply.material
        constants = stock.ply_constants(name)
        isotropic = stock.material(name).isotropic
        strengths: list[PlyStrength] = []
        yields: list[Array] = []
        for state in states:
            if isotropic:
                value = stock.allowable(
                    name, "yield_strength", "ultimate_strength", cold=state.cold
                )
                if value is not None:
                    yields.append(value)
                continue
            values = [stock.allowable(name, key, cold=state.cold) for key in STRENGTHS]
            if all(value is not None for value in values):
                across = stock.allowable(name, "strength_23", cold=state.cold)
                tension_1, compression_1, tension_2, compression_2, shear = values
                strengths.append(
                    PlyStrength(tension_1, compression_1, tension_2, compression_2, shear, across)
                )
        if not strengths and not yields:
            missing.append(
                f"{name} has no yield strength" if isotropic else f"{name} lacks ply strengths"
            )
        wall_layers.append(
            Layer(
                label=f"layup[{i}] {name}",
                name=name,
                isotropic=isotropic,
                constants=constants,
                solid=_solid(constants),
                angle=v[f"{at}[{i}].angle"],
                balanced=ply.balanced,
                thickness=v[f"{at}[{i}].thickness"],
                strengths=tuple(strengths),
                yields=tuple(yields),
                fatigue=None if isotropic else stock.allowable(name, "fatigue_strength"),
            )
        )
    return wall_layers


def _solid(constants: dict[str, Array]) -> Solid:
    """Three-dimensional stiffness from a material's elastic constants."""
    keys = ("youngs_modulus_1", "youngs_modulus_2", "youngs_modulus_3", "poissons_ratio_12",
            "poissons_ratio_13", "poissons_ratio_23", "shear_modulus_12")  # fmt: skip
    return solid_stiffness(**{key: constants[key] for key in keys})


def worst(values: Array, axes: tuple[int, ...]) -> Array:
    """Largest value along some axes, by real part; its imaginary part (a derivative) is kept."""
    other_axes = [i for i in range(values.ndim) if i not in axes]
    flattened = np.transpose(values, (*axes, *other_axes)).reshape(
        -1, *(values.shape[i] for i in other_axes)
    )
    if len(flattened) == 1:
        return flattened[0]
    pick = np.argmax(real(flattened), axis=0)
    return np.take_along_axis(flattened, pick[None], axis=0)[0]


def grouped(modes: Mapping[str, Array]) -> dict[str, Array]:
    """Merge failure modes that exclude each other, such as fibre tension and fibre compression.

    The merged mode is named by the first word of their names, such as "fibre", and has the larger
    utilisation.
    """
    groups: dict[str, Array] = {}
    for mode, utilisation in modes.items():
        group = mode.partition(" ")[0]
        groups[group] = maximum(groups[group], utilisation) if group in groups else utilisation
    return groups


def utilisations(
    criterion: str,
    plies: Sequence[Layer],
    stress: Stress,
    residual: Stress | None,
) -> dict[str, Array]:
    """Utilisation 1/SR (SR: strength ratio) by failure mode of one criterion.

    Stresses are (faces, plies, climates, ...), where faces are the inner and outer face of a ply,
    and climates the service temperatures. Further axes, such as load paths and designs, come last.
    """
    extra = stress[0].ndim - 3

    def column(key: str) -> Array:
        values = [layer.constants[key] for layer in plies]
        shape = (len(plies), 1, *(1,) * (extra - 1), -1)
        return np.stack(np.broadcast_arrays(*values)).reshape(shape)

    across = all(strength.shear_23 is not None for layer in plies for strength in layer.strengths)
    strength = PlyStrength(
        tension_1=_strengths(plies, "tension_1", extra),
        compression_1=_strengths(plies, "compression_1", extra),
        tension_2=_strengths(plies, "tension_2", extra),
        compression_2=_strengths(plies, "compression_2", extra),
        shear_12=_strengths(plies, "shear_12", extra),
        shear_23=_strengths(plies, "shear_23", extra) if across else None,
    )
    elastic = None
    failure_criterion = CRITERIA[criterion]
    if failure_criterion.by_strain:
        elastic = PlyRatios(
            poissons_ratio_12=column("poissons_ratio_12"),
            poissons_ratio_13=column("poissons_ratio_13"),
            poissons_ratio_23=column("poissons_ratio_23"),
            modulus_ratio=column("youngs_modulus_2") / column("youngs_modulus_1"),
        )
    return failure_criterion.modes(
        stress=stress, strength=strength, residual=residual, elastic=elastic
    )


def _strengths(plies: Sequence[Layer], name: str, extra: int) -> Array:
    """The strength `name` of every ply at every service temperature, (plies, climates, ...)."""
    rows = [
        np.stack(
            np.broadcast_arrays(
                *[np.asarray(getattr(strength, name)) for strength in layer.strengths]
            )
        )
        for layer in plies
    ]
    stacked = np.stack(np.broadcast_arrays(*rows))
    batch = stacked.shape[2:]
    return stacked.reshape(*stacked.shape[:2], *(1,) * (extra - len(batch)), *batch)
