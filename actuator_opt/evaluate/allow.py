"""Material numbers and allowables as the kernel reads them, by material name."""

from __future__ import annotations

from ..design.material import Material, allowable_factor
from ..design.model import Design
from ..numeric import Array
from .values import Values


class Stock:
    """The materials of a design: their numbers (possibly varied) and their allowables."""

    def __init__(self, v: Values, design: Design, materials: dict[str, Material]) -> None:
        self._v = v
        self._materials = materials
        hottest = [v["fluid.temperature"]]
        hottest += [
            v[f"load_cases[{case.name}].temperature"]
            for case in design.load_cases
            if case.temperature is not None
        ]
        if design.environment is not None:
            hottest.append(v["environment.temperature_max"])
        self.temperature = max(float(value.real) for value in hottest)

    def material(self, name: str) -> Material:
        """What the library knows of `name`."""
        return self._materials[name]

    def names(self) -> list[str]:
        """Every material of the design."""
        return list(self._materials)

    def numbers(self, name: str) -> dict[str, Array]:
        """Every stated property of a material, SI."""
        return {key: self._v[f"materials.{name}.{key}"] for key in self._materials[name].numbers}

    def get(self, name: str, *properties: str, default: Array = None) -> Array:
        """The first stated of some properties; `default` where none is."""
        for key in properties:
            if key in self._materials[name].numbers:
                return self._v[f"materials.{name}.{key}"]
        return default

    def allowable(self, name: str, *properties: str) -> Array:
        """A strength after temperature, basis and process knock-downs; None where none is stated.

        Temperature is the highest of oil, load cases and environment.
        """
        for key in properties:
            if key in self._materials[name].numbers:
                material = self._materials[name]
                factor = allowable_factor(
                    material.numbers,
                    key,
                    basis=material.properties[key].basis,
                    temperature=self.temperature,
                )
                return self._v[f"materials.{name}.{key}"] * factor
        return None
