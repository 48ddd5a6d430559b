"""One regular point, or several, of every public model function: the registry of the law tests.

Numbers inside tuples, lists and dataclasses are arguments like any other; booleans, strings and
None stay as they are. A new model function needs an entry here, or the tests fail.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
from dataclasses import replace
from math import inf, pi

import actuator_opt.models
from actuator_opt.models import seals
from actuator_opt.models.ply_discount import WallLayer
from actuator_opt.models.strength_modes import PlyStrength

SCALAR_ONLY = {
    "stepped_segments.stepped_column_load_segments": "reference solution by scanning, floats only",
    "barrel.wall_ratio_for_strain": "inverse that raises where no wall will do",
}
"""Public functions outside the array laws, with the reason."""


def public_functions():
    """Every public function by its ``module.name``, in the module that defines it."""
    found = {}
    for info in pkgutil.iter_modules(actuator_opt.models.__path__):
        module = importlib.import_module(f"actuator_opt.models.{info.name}")
        for name, value in vars(module).items():
            own = inspect.isfunction(value) and value.__module__ == module.__name__
            if own and not name.startswith("_"):
                found[f"{info.name}.{name}"] = value
    return found


def leaves(value):
    """Numbers of a sample, depth first."""
    if isinstance(value, bool | str) or value is None:
        return []
    if isinstance(value, dict):
        return [leaf for entry in value.values() for leaf in leaves(entry)]
    if isinstance(value, tuple | list):
        return [leaf for entry in value for leaf in leaves(entry)]
    if dataclasses.is_dataclass(value):
        return leaves([getattr(value, field.name) for field in dataclasses.fields(value)])
    return [value]


def rebuilt(value, numbers):
    """Return the sample with its numbers taken from an iterator, in the order of `leaves`."""
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, dict):
        return {key: rebuilt(entry, numbers) for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return type(value)(rebuilt(entry, numbers) for entry in value)
    if dataclasses.is_dataclass(value):
        fields = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
        return replace(value, **rebuilt(fields, numbers))
    return next(numbers)


RING = {"squeeze": 0.16, "section": 2e-3, "growth": 3e-5, "tolerance": 2e-5}
CHAMBERS = {"area_a": 8e-4, "area_b": 5.5e-4, "compliance_a": 5e-14, "compliance_b": 4e-14}
STRIBECK = {
    "speed": 0.015, "coulomb": 500.0, "static": 900.0, "stribeck_speed": 0.02, "exponent": 1.4,
}  # fmt: skip
TAIT = {"temperature": 320.0, "pressure": 9e6}
STATE = {
    "pressure_a": 9e6, "pressure_b": 4e5, "area_a": 8e-4, "area_b": 5e-4, "friction": 90.0,
}  # fmt: skip
PIPE = {
    "inner_diameter": 9.5e-3, "outer_diameter": 12e-3, "length": 0.6, "youngs_modulus": 17.8e9,
    "poissons_ratio": 0.3,
}  # fmt: skip
TUBE = {"inner_radius": 16e-3, "outer_radius": 20e-3}
METAL = {"youngs_modulus": 71.7e9, "poissons_ratio": 0.33}
ROD = {"outer_diameter": 12e-3, "inner_diameter": 6e-3}
THREAD = {"diameter": 10e-3, "pitch": 1.5e-3}
STOP = {"driving_force": 6000.0, "mass": 40.0, "velocity": 0.3}
FATIGUE = {"ultimate_strength": 700e6, "fatigue_limit": 300e6, "limit_cycles": 2e6}
COLUMN = {
    "bending_stiffness_1": 5000.0, "length_1": 0.2, "bending_stiffness_2": 1200.0,
    "length_2": 0.18,
}  # fmt: skip
METAL_COLUMN = {
    "area": 2e-4, "second_moment": 3.2e-9, "youngs_modulus": 2.1e11, "yield_strength": 6e8,
}  # fmt: skip
BOND = {"length": 20e-3, "shear_modulus": 1e9, "bond_thickness": 0.2e-3}
WALLS = {"membrane_stiffness_1": 100e6, "membrane_stiffness_2": 50e6}
LAMINA = {
    "youngs_modulus_1": 138e9, "youngs_modulus_2": 9e9, "poissons_ratio_12": 0.28,
    "shear_modulus_12": 5e9,
}  # fmt: skip
REDUCED = (139e9, 2.5e9, 9.1e9, 5e9)
SHEET = {"membrane": (1.1e8, 2e7, 1.5e8)}
STRENGTH = PlyStrength(1900e6, 1300e6, 55e6, 190e6, 85e6)
PULLED = {"stress_1": 400e6, "stress_2": 30e6, "shear_12": 40e6, "strength": STRENGTH}
PRESSED = {"stress_1": -300e6, "stress_2": -90e6, "shear_12": 60e6, "strength": STRENGTH}
RESIDUAL = (-10e6, 20e6, 3e6)
LINER = WallLayer(
    71.7e9, 71.7e9, 0.33, 27e9, thickness=0.6e-3, angle=1e-9, yield_strength=240e6
) if False else WallLayer(
    youngs_modulus_1=71.7e9, youngs_modulus_2=71.7e9, poissons_ratio_12=0.33,
    shear_modulus_12=71.7e9 / 2.66, thickness=0.6e-3, yield_strength=240e6,
)  # fmt: skip
HOOP = WallLayer(**LAMINA, strength=STRENGTH, thickness=1.2e-3, angle=pi / 2)
HELICAL = WallLayer(**LAMINA, strength=STRENGTH, thickness=0.8e-3, angle=pi / 6)
