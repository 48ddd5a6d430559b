"""Units: conversion between text with a unit and SI (names of fields are in `quantities`)."""

from __future__ import annotations

import math
import re
from decimal import Decimal

from .dataclass import dataclass

_NUMBER = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+(?:[\d_]*\d)?\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<unit>.*?)\s*$"
)

BASE = {
    "ratio": "",
    "count": "",
    "length": "m",
    "area": "m^2",
    "volume": "m^3",
    "mass": "kg",
    "time": "s",
    "speed": "m/s",
    "force": "N",
    "torque": "N*m",
    "energy": "J",
    "power": "W",
    "pressure": "Pa",
    "pressure_speed": "W/m^2",
    "temperature": "K",
    "temperature_difference": "K",
    "angle": "rad",
    "frequency": "Hz",
    "stiffness": "N/m",
    "damping": "N*s/m",
    "density": "kg/m^3",
    "dynamic_viscosity": "Pa*s",
    "kinematic_viscosity": "m^2/s",
    "flow": "m^3/s",
    "compliance": "m^3/Pa",
    "per_pressure": "1/Pa",
    "per_temperature": "1/K",
    "thermal_conductivity": "W/(m*K)",
    "specific_heat": "J/(kg*K)",
    "per_area": "1/m^2",
    "pressure_per_temperature": "Pa/K",
    "line_load": "N/m",
    "hardness": "ShoreA",
    "voltage": "V",
    "signal_gain": "V/m",
    "conductance": "m^3/(s*Pa)",
    "flow_coefficient": "m^3/s/sqrt(Pa)",
    "signal_rate": "V/s",
    "speed_gain": "V*s/m",
    "angle_gain": "V/rad",
    "angular_speed_gain": "V*s/rad",
    "pressure_gain": "V/Pa",
    "angular_speed": "rad/s",
    "angular_damping": "N*m*s/rad",
    "inertia": "kg*m^2",
    "thermal_conductance": "W/K",
    "wear_rate": "m^2/N",
    "specific_energy": "J/kg",
    "mass_per_power": "kg/W",
    "mass_per_conductance": "kg*K/W",
}
"""Every dimension with its SI unit."""

_INCH, _LBF, _GRAVITY = 0.0254, 4.4482216152605, 9.80665

_SCALES: dict[str, dict[str, float]] = {
    "ratio": {"%": 1e-2, "-": 1.0, "1": 1.0},
    "count": {},
    "length": {
        "m": 1.0,
        "km": 1e3,
        "dm": 0.1,
        "cm": 1e-2,
        "mm": 1e-3,
        "um": 1e-6,
        "µm": 1e-6,
        "μm": 1e-6,
        "nm": 1e-9,
        "in": _INCH,
        "inch": _INCH,
        "ft": 12 * _INCH,
    },
    "area": {"m^2": 1.0, "cm^2": 1e-4, "mm^2": 1e-6, "in^2": _INCH**2},
    "volume": {
        "m^3": 1.0,
        "l": 1e-3,
        "L": 1e-3,
        "dl": 1e-4,
        "cl": 1e-5,
        "ml": 1e-6,
        "mL": 1e-6,
        "cm^3": 1e-6,
        "mm^3": 1e-9,
        "in^3": _INCH**3,
    },
    "mass": {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237, "oz": 0.028349523125},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0},
    "speed": {
        "m/s": 1.0,
        "mm/s": 1e-3,
        "cm/s": 1e-2,
        "um/s": 1e-6,
        "m/min": 1 / 60,
        "km/h": 1 / 3.6,
        "in/s": _INCH,
        "ft/s": 12 * _INCH,
    },
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": _LBF, "kgf": _GRAVITY},
    "torque": {
        "N*m": 1.0,
        "kN*m": 1e3,
        "N*mm": 1e-3,
        "lbf*ft": _LBF * 12 * _INCH,
        "lbf*in": _LBF * _INCH,
    },
    "energy": {"J": 1.0, "mJ": 1e-3, "kJ": 1e3},
    "power": {"W": 1.0, "mW": 1e-3, "kW": 1e3},
    "pressure_speed": {"W/m^2": 1.0, "MPa*m/s": 1e6},
    "pressure": {
        "Pa": 1.0,
        "kPa": 1e3,
        "hPa": 1e2,
        "MPa": 1e6,
        "GPa": 1e9,
        "bar": 1e5,
        "mbar": 1e2,
        "psi": _LBF / _INCH**2,
        "ksi": 1e3 * _LBF / _INCH**2,
        "N/mm^2": 1e6,
        "N/m^2": 1.0,
        "atm": 101325.0,
    },
    "temperature": {"K": 1.0, "degC": 1.0, "°C": 1.0, "degF": 5 / 9, "°F": 5 / 9},
    "temperature_difference": {"K": 1.0, "degC": 1.0, "°C": 1.0, "degF": 5 / 9, "°F": 5 / 9},
    "angle": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "°": math.pi / 180},
    "frequency": {"Hz": 1.0, "kHz": 1e3, "mHz": 1e-3, "1/s": 1.0, "1/min": 1 / 60},
    "stiffness": {
        "N/m": 1.0,
        "N/mm": 1e3,
        "kN/mm": 1e6,
        "kN/m": 1e3,
        "MN/m": 1e6,
        "N/um": 1e6,
        "N/µm": 1e6,
        "GN/m": 1e9,
        "lbf/in": _LBF / _INCH,
    },
    "damping": {"N*s/m": 1.0, "N*s/mm": 1e3, "kN*s/m": 1e3, "MN*s/m": 1e6},
    "density": {"kg/m^3": 1.0, "g/cm^3": 1e3, "kg/l": 1e3, "kg/dm^3": 1e3},
    "dynamic_viscosity": {"Pa*s": 1.0, "mPa*s": 1e-3, "cP": 1e-3, "P": 0.1},
    "kinematic_viscosity": {"m^2/s": 1.0, "mm^2/s": 1e-6, "cSt": 1e-6, "St": 1e-4},
    "flow": {
        "m^3/s": 1.0,
        "l/min": 1e-3 / 60,
        "L/min": 1e-3 / 60,
        "l/s": 1e-3,
        "ml/s": 1e-6,
        "ml/min": 1e-6 / 60,
        "cm^3/s": 1e-6,
        "mm^3/s": 1e-9,
    },
    "compliance": {"m^3/Pa": 1.0, "mm^3/MPa": 1e-15, "ml/bar": 1e-11},
    "per_pressure": {"1/Pa": 1.0, "1/MPa": 1e-6, "1/GPa": 1e-9, "1/bar": 1e-5},
    "per_temperature": {"1/K": 1.0, "1/degC": 1.0, "ppm/K": 1e-6, "um/m/K": 1e-6},
    "thermal_conductivity": {"W/(m*K)": 1.0, "W/m/K": 1.0, "mW/(m*K)": 1e-3},
    "specific_heat": {"J/(kg*K)": 1.0, "J/kg/K": 1.0, "kJ/(kg*K)": 1e3, "J/(g*K)": 1e3},
    "per_area": {"1/m^2": 1.0, "1/mm^2": 1e6, "1/um^2": 1e12},
    "pressure_per_temperature": {"Pa/K": 1.0, "bar/K": 1e5, "MPa/K": 1e6},
    "line_load": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3},
    "hardness": {"ShoreA": 1.0, "Shore A": 1.0, "shore_a": 1.0},
    "voltage": {"V": 1.0, "mV": 1e-3},
    "signal_gain": {"V/m": 1.0, "V/mm": 1e3},
    "conductance": {
        "m^3/(s*Pa)": 1.0,
        "ml/min/bar": 1e-11 / 60,
        "l/min/bar": 1e-8 / 60,
        "ml/s/bar": 1e-11,
        "mm^3/s/bar": 1e-14,
    },
    "flow_coefficient": {
        "m^3/s/sqrt(Pa)": 1.0,
        "l/min/sqrt(bar)": 1e-3 / 60 / math.sqrt(1e5),
        "L/min/sqrt(bar)": 1e-3 / 60 / math.sqrt(1e5),
        "ml/min/sqrt(bar)": 1e-6 / 60 / math.sqrt(1e5),
        "ml/s/sqrt(bar)": 1e-6 / math.sqrt(1e5),
        "l/min/sqrt(MPa)": 1e-6 / 60,
    },
    "signal_rate": {"V/s": 1.0, "V/ms": 1e3},
    "speed_gain": {"V*s/m": 1.0, "V*s/mm": 1e3},
    "angle_gain": {"V/rad": 1.0, "V/deg": 180 / math.pi},
    "angular_speed_gain": {"V*s/rad": 1.0, "V/rpm": 30 / math.pi},
    "pressure_gain": {"V/Pa": 1.0, "V/bar": 1e-5, "V/MPa": 1e-6},
    "angular_speed": {
        "rad/s": 1.0,
        "rpm": math.pi / 30,
        "1/min": math.pi / 30,
        "deg/s": math.pi / 180,
    },
    "angular_damping": {"N*m*s/rad": 1.0, "N*m/rpm": 30 / math.pi},
    "inertia": {"kg*m^2": 1.0, "kg*cm^2": 1e-4, "kg*mm^2": 1e-6, "g*cm^2": 1e-7},
    "thermal_conductance": {"W/K": 1.0, "kW/K": 1e3, "mW/K": 1e-3},
    "wear_rate": {"m^2/N": 1.0, "mm^2/N": 1e-6, "mm^3/(N*m)": 1e-9, "m^3/(N*m)": 1.0, "1/Pa": 1.0},
    "specific_energy": {"J/kg": 1.0, "kJ/kg": 1e3, "MJ/kg": 1e6, "W*h/kg": 3600.0, "Wh/kg": 3600.0},
    "mass_per_power": {"kg/W": 1.0, "kg/kW": 1e-3, "g/W": 1e-3},
    "mass_per_conductance": {"kg*K/W": 1.0, "g*K/W": 1e-3, "kg/(W/K)": 1.0},
}
_OFFSETS = {"degC": 273.15, "°C": 273.15, "degF": 459.67 * 5 / 9, "°F": 459.67 * 5 / 9}

_INVERSES = {float(f"1e-{n}"): float(f"1e{n}") for n in range(1, 16)}

_DECIMAL_DIGITS = 12
"""Conversion factors written with at most this many characters (1e-2, 0.0254, 101325) are exact
decimals."""

_SYNONYMS = (("**", "^"), ("²", "^2"), ("³", "^3"), ("·", "*"), ("⋅", "*"), ("⁻¹", "^-1"))


class UnitError(ValueError):
    """A text that is not a value with a suitable unit: `message` is the fault."""

    def __init__(self, message: str, remedy: str) -> None:
        super().__init__(f"{message}; {remedy}")
        self.message = message
        self.remedy = remedy


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of a dimension: SI = value · scale + offset."""

    name: str
    dimension: str
    scale: float
    offset: float = 0.0

    def to_si(self, value: float) -> float:
        """SI value of a value in this unit."""
        inverse = _INVERSES.get(self.scale)  # 18 mm is 18/1000, not 18·0.001: exact to the last bit
        return (value * self.scale if inverse is None else value / inverse) + self.offset

    def text_to_si(self, number: str) -> float:
        """SI value of a number as written: 1.1 cm and 11 mm agree to the last bit."""
        digits = repr(self.scale)
        if len(digits) > _DECIMAL_DIGITS:
            return self.to_si(float(number))
        return float(Decimal(number) * Decimal(digits)) + self.offset

    def from_si(self, value: float) -> float:
        """Value in this unit from an SI value."""
        inverse = _INVERSES.get(self.scale)
        moved = value - self.offset  # never in place, as the caller may use the array
        return moved / self.scale if inverse is None else moved * inverse


def _normalise(text: str) -> str:
    for old, new in _SYNONYMS:
        text = text.replace(old, new)
    text = re.sub(r"\s*([*/^])\s*", r"\1", text.strip())
    text = text.replace("Nm", "N*m").replace("Ns/", "N*s/").replace("Pas", "Pa*s")
    text = re.sub(r"(?<=[a-zA-Z])([23])(?=$|[/*])", r"^\1", text)
    text = re.sub(r"\b(N|Pa|mPa|kN|MN|cm|mm|lbf) (m|s|mm|ft|in)\b", r"\1*\2", text)
    return text


def units_of(dimension: str) -> tuple[str, ...]:
    """Names of the units of a dimension, SI first."""
    return tuple(_SCALES[dimension])


def unit(name: str, dimension: str) -> Unit:
    """The unit `name` of `dimension`; `UnitError` if unknown or a unit of another dimension."""
    table = _SCALES[dimension]
    known = name.strip()
    if known not in table:
        known = _normalise(name)
    if known in table:
        offset = _OFFSETS.get(known, 0.0) if dimension == "temperature" else 0.0
        return Unit(known, dimension, table[known], offset)
    choices = ", ".join(list(table)[:5]) or "a bare number"
    lowered = _normalise(name).lower()
    for known in table:
        if known.lower() == lowered:
            raise UnitError(f'unknown unit "{name}"', f'did you mean "{known}"?')
    for other, names in _SCALES.items():
        if _normalise(name) in names and other != dimension:
            raise UnitError(
                f"{name} is {_article(other)}, need {_article(dimension)}",
                f"use one of {choices}",
            )
    raise UnitError(f'unknown unit "{name}"', f"use one of {choices}")


def _article(dimension: str) -> str:
    words = dimension.replace("_", " ")
    return f"{'an' if words[0] in 'aeio' else 'a'} {words}"


def split(text: str) -> tuple[float, str]:
    """Split ``"12.5 mm"`` into 12.5 and ``"mm"``; raises `UnitError` for other texts."""
    number, name = _split(text)
    return float(number), name


def _split(text: str) -> tuple[str, str]:
    match = _NUMBER.match(text)
    if match is None:
        raise UnitError(f'"{text}" is not a number with a unit', 'write e.g. "12 mm"')
    number = match["number"].replace("_", "")
    if not math.isfinite(float(number)):
        raise UnitError(f'"{text}" is not a finite number', "write a finite value")
    return number, match["unit"]


def parse(text: str, dimension: str) -> float:
    """SI value of a text such as ``"210 bar"`` (pressure) or ``"40 degC"`` (temperature, K).

    Ratios and counts need no unit; neither does 0, except for temperatures.

    >>> parse("210 bar", "pressure")
    21000000.0
    >>> parse("1.1 cm", "length") == parse("11 mm", "length")
    True
    """
    number, name = _split(text)
    if name:
        return unit(name, dimension).text_to_si(number)
    if dimension in ("ratio", "count") or (float(number) == 0 and dimension != "temperature"):
        return float(number)
    example = next(iter(_SCALES[dimension]))
    raise UnitError(f'"{text}": unit missing', f'write e.g. "{text.strip()} {example}"')


def whole(text: str) -> int | None:
    """A whole number of at most 15 digits from text; None for anything else.

    >>> whole(" 12 "), whole("-1"), whole("9" * 5000)
    (12, None, None)
    """
    digits = text.strip()
    return int(digits) if digits.isdecimal() and len(digits) <= 15 else None
