"""Material properties and allowables of a design, by material name."""

from __future__ import annotations

from collections.abc import Mapping

from ..base.numeric import Array
from ..design.material import Material, allowable_factor, ply_constants
from ..design.model import Design
from .values import Values


def extremes(design: Design, numbers: Mapping[str, float]) -> tuple[float, float]:
    """Lowest and highest temperature of oil, load cases and environment, K."""
    temperatures = [numbers["fluid.temperature"]]
    temperatures += [c.temperature for c in design.load_cases if c.temperature is not None]
    if design.environment is not None:
        temperatures += [design.environment.temperature_min, design.environment.temperature_max]
    return min(temperatures), max(temperatures)


def allowances(
    materials: Mapping[str, Material],
    numbers: Mapping[str, float],
    *,
    temperatures: tuple[float, float],
    wet: bool,
) -> dict[tuple[str, str, bool], float]:
    """Remaining share of every strength after temperature, moisture, basis and process.

    Keys are (material, property, cold) for the lowest and the highest of `temperatures`; `numbers`
    (by PATH) may override the knock-downs of the library.
    """
    factors = {}
    for name, material in materials.items():
        own = {key: numbers[f"materials.{name}.{key}"] for key in material.numbers}
        for key, entry in material.properties.items():
            if "strength" not in key:
                continue
            for cold, temperature in zip((True, False), temperatures, strict=True):
                factors[name, key, cold] = float(
                    allowable_factor(own, key, basis=entry.basis, temperature=temperature, wet=wet)
                )
    return factors


class MaterialValues:
    """Materials of a design: their properties (possibly varied) and their allowables."""

    def __init__(
        self,
        v: Values,
        materials: Mapping[str, Material],
        factors: Mapping[tuple[str, str, bool], float],
        constants: dict[str, dict[str, Array]],
    ) -> None:
        self._v = v
        self.materials = materials
        self._factors = factors
        self._constants = constants

    def material(self, name: str) -> Material:
        """Library entry of `name`."""
        return self.materials[name]

    def kind(self, name: str) -> str:
        """Kind of a material: metal, ply, polymer, adhesive, fluid or seal."""
        return self.materials[name].kind

    def names(self) -> list[str]:
        """All materials of the design."""
        return list(self.materials)

    def numbers(self, name: str) -> dict[str, Array]:
        """All stated properties of a material, SI."""
        return {key: self._v[f"materials.{name}.{key}"] for key in self.materials[name].numbers}

    def ply_constants(self, name: str) -> dict[str, Array]:
        """Elastic constants and expansions of a material as a ply; cached if fixed."""
        prefix = f"materials.{name}."
        if any(path.startswith(prefix) for path in self._v.varied):
            return ply_constants(self.numbers(name))
        if name not in self._constants:
            self._constants[name] = ply_constants(self.numbers(name))
        self._v.read.update(prefix + key for key in self.materials[name].numbers)
        return self._constants[name]

    def get(self, name: str, *properties: str, default: Array = None) -> Array:
        """The first stated property of several; `default` if none is stated."""
        for key in properties:
            if key in self.materials[name].numbers:
                return self._v[f"materials.{name}.{key}"]
        return default

    def allowable(self, name: str, *properties: str, cold: bool = False) -> Array:
        """A strength after all applicable knock-downs; None if not stated.

        The temperature is the highest of oil, load cases and environment, or the lowest.
        """
        for key in properties:
            if key in self.materials[name].numbers:
                return self._v[f"materials.{name}.{key}"] * self._factors[name, key, cold]
        return None
