"""Kinds of values in a design file: quantity, material name, text, position and others.

Each field in `model` is annotated with its kind. Pydantic validates the field's value with it;
reader, PATHs, writer and JSON Schema use the same declaration.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, Final, Literal, TypeAlias, get_args

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from ..base import kinds, quantities, units
from ..base.dataclass import brief, dataclass
from ..base.errors import article, shown
from ..base.numeric import Array
from ..base.quantities import Quantity

_LONGEST_NUMBER = 100
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d+,\d")
_NAME = re.compile(r"(?!\d+$)[^\W_][\w .+-]*", re.UNICODE)

EXAMPLES = {
    "bore": "25 mm", "stroke": "110 mm", "wall_thickness": "1.2 mm", "thickness_ratio": "0.2",
    "winding_angle": "55 deg",
    "allowed_angle": "45 deg", "ply_thickness": "0.2 mm", "autofrettage_pressure": "400 bar",
    "rod_diameter": "12 mm", "rod_inner_diameter": "6 mm", "length": "50 mm",
    "part_length": "20 mm", "stop_travel": "0.5 mm", "radial_clearance": "0.03 mm",
    "tolerance": "0.05 mm",
    "cross_section": "3.53 mm", "squeeze": "12 %", "stretch": "2 %", "groove_width": "4.8 mm",
    "seal_count": "1", "bolt_count": "4", "thread_diameter": "10 mm", "thread_pitch": "1.5 mm",
    "diameter": "6 mm", "line_diameter": "6 mm", "volume": "2 ml", "pressure": "2 bar",
    "working_pressure": "100 bar", "temperature": "40 degC",
    "temperature_rise": "10 K", "air_content": "0.5 %", "force": "3 kN", "torque": "120 N*m",
    "lever_arm": "40 mm", "pivot_radius": "60 mm", "joint_angle": "30 deg",
    "joint_speed": "3 rad/s", "load_inertia": "0.5 kg*m^2",
    "speed": "0.1 m/s", "load_mass": "20 kg", "position": "55 mm",
    "fraction": "50 %", "friction_coefficient": "0.3", "breakaway_ratio": "1.5",
    "stribeck_speed": "5 mm/s", "breakaway_travel": "0.1 mm", "viscous_friction": "100 N*s/m",
    "safety_factor": "1.5", "cycles": "20000", "stiffness": "50 kN/mm", "coefficient": "1",
    "surface_roughness": "0.2 um", "rms_roughness": "0.2 um", "taper": "6 deg",
    "frequency": "20 Hz", "rated_flow": "10 l/min",
    "leakage_flow": "0.1 l/min", "edge_coefficient": "1.7 l/min/sqrt(bar)",
    "hysteresis": "3 %", "threshold": "0.5 %", "pressure_drop": "35 bar", "signal": "10 V",
    "signal_offset": "0.1 V", "gain": "500 V/m", "oil_viscosity": "32 mm^2/s",
    "damping_ratio": "0.7", "orifice_area": "0.2 cm^2", "opening": "50 %",
    "conductance": "20 ml/min/bar", "gas_volume": "50 ml", "precharge": "30 bar",
    "polytropic_index": "1.4", "tightening_factor": "1.6",
    "duration": "2 s", "sample_time": "1 ms", "time_constant": "20 ms", "signal_rate": "500 V/s",
    "displacement": "13.3 ml", "displacement_setting": "1", "slip_coefficient": "1.5e-7",
    "coulomb_coefficient": "0.16", "viscous_coefficient": "1e5", "drive_speed": "1500 rpm",
    "pump_gain": "2 l/min/bar", "coulomb_force": "80 N", "static_force": "120 N",
    "part_factor": "0.5", "oil_volume": "80 ml", "inertia": "0.013 kg*m^2",
    "stribeck_exponent": "2", "margin": "2", "cycles_per_window": "5",
    "repeats": "5e6", "scale_factor": "1.2", "cycle_phase": "50 %", "sample_count": "400",
    "opening_limit": "90 %", "service_time": "2000 h", "thermal_conductance": "30 W/K",
    "emissivity": "0.9", "wear_rate": "2e-17 m^2/N", "wear_depth": "0.1 mm",
    "machine_efficiency": "85 %", "precharge_ratio": "0.9", "specific_energy": "0.6 MJ/kg",
    "mass_per_power": "1 kg/kW", "mass_per_conductance": "0.03 kg*K/W",
    "shell_density": "1.5 kg/l", "system_part_mass": "0.5 kg",
}  # fmt: skip
"""A valid example of every input quantity, for messages, the schema and the start file."""
MATERIAL_EXAMPLES = {
    "structural": "al_7075_t6",
    "isotropic": "steel_42crmo4",
    "fluid": "iso_vg_32",
    "seal": "nbr_70",
    "fastening": "epoxy_structural",
    "adhesive": "epoxy_structural",
}
"""An example material for each role."""


class ValueFault(ValueError):
    """An unusable value: `message` states the fault, `remedy` how to correct it."""

    def __init__(self, message: str, remedy: str) -> None:
        super().__init__(f"{message}; {remedy}")
        self.message = message
        self.remedy = remedy


def example(quantity: Quantity) -> str:
    """Text of an example value of a quantity."""
    if quantity.name in EXAMPLES:
        return EXAMPLES[quantity.name]
    value = max(quantity.lower, 0.0) if quantity.lower > -quantities.INFINITY else 0.0
    if value == 0.0:
        value = units.unit(quantity.unit, quantity.dimension).to_si(1.0) if quantity.unit else 1.0
    return quantity.text(min(value, quantity.upper))


def _range_fault(shown_value: str, number: float, quantity: Quantity) -> ValueFault:
    signed = quantity.dimension in ("temperature", "temperature_difference", "angle")
    if number <= 0 <= quantity.lower and not signed:
        message = f"{shown_value}: must be {'> 0' if quantity.lower > 0 else '>= 0'}"
    elif number != number:
        message = f"{shown_value}: is not a number"
    elif quantity.name == "line_diameter" and number < quantity.lower:
        times, least = (quantity.lower / number) ** 4, quantity.text(quantity.lower)
        message = (
            f"{shown_value}: too thin for a line: its laminar pressure drop, which grows with "
            f"1/d^4, is {times:.3g} times that of {least}"
        )
        return ValueFault(message, f"write {least} or more; a restriction is a ports.throttle")
    else:
        message = f"{shown_value}: outside the valid range ({quantity.label})"
    return ValueFault(message, f"write {quantity.range_text()}")


def check_range(number: float, quantity: Quantity, shown_value: str | None = None) -> float:
    """Return `number` (SI) if it is in the range of its quantity, apart from rounding errors."""
    slack = 1e-12
    lower = quantity.lower - slack * abs(quantity.lower)
    upper = quantity.upper + slack * abs(quantity.upper)
    if not lower <= number <= upper:
        text = shown_value or f"{number:.6g} {quantity.si_unit}".rstrip()
        raise _range_fault(text, number, quantity)
    if quantity.dimension == "count" and number != int(number):
        text = str(shown_value or number).strip()
        raise ValueFault(f"{text}: must be a whole number", f"write {example(quantity)}")
    return number


def _unit_fault(text: str, quantity: Quantity, error: units.UnitError) -> ValueFault:
    """Add the quantity's units and an example to a fault about a unit."""
    name, message, remedy = shown(text.strip()), shown(error.message, 160), error.remedy
    if _DECIMAL_COMMA.match(text):
        return ValueFault(f'"{name}": decimal comma', f'write "{name.replace(",", ".", 1)}"')
    if "unit missing" in message:
        remedy = _with_unit(name, quantity)
    elif "not a number" in message or "not a finite" in message:
        remedy = f'write e.g. "{example(quantity)}"'
    elif remedy.startswith("use one of") and quantity.unit:
        names = dict.fromkeys((quantity.unit, *units.units_of(quantity.dimension)))
        remedy = f"use one of {', '.join(list(names)[:5])}"
    elif quantity.dimension == "count":
        remedy = f'write a bare number, e.g. "{example(quantity)}"'
    return ValueFault(message if name in message else f'"{name}": {message}', remedy)


def _with_unit(bare: str, quantity: Quantity) -> str:
    """Remedy for a bare number: the number with its unit.

    As in scripts and ``--set``, the number is taken as SI. If that is outside the quantity's range,
    the display unit is suggested instead, and if this is too, the example.
    """
    number = float(bare)
    si = f"{bare} {quantity.si_unit}"
    if quantity.lower <= number <= quantity.upper:
        same = "" if quantity.unit == quantity.si_unit else f" (= {quantity.text(number, 6)})"
        return f'write "{si}"{same}, or the unit meant'
    shown_unit = f"{bare} {quantity.unit}"
    fits = quantity.lower <= units.parse(shown_unit, quantity.dimension) <= quantity.upper
    sample = shown_unit if fits else example(quantity)
    return f'write e.g. "{sample}"; {si} is outside {quantity.range_text()}'


def read_quantity(value: object, quantity: Quantity) -> float:
    """Read a quantity in SI from a text with a unit (in a file) or an SI number (in a script).

    Raises
    ------
    ValueFault
        if it is no number, has no unit or a unit of another dimension, or is outside its range
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return check_range(float(value), quantity)
    if not isinstance(value, str):
        raise ValueFault(
            f"need {article(quantity.label)}, not {shape_in_words(value)}",
            f'write one value, e.g. "{example(quantity)}"',
        )
    try:
        if len(value) > _LONGEST_NUMBER:
            raise units.UnitError(f'"{shown(value)}" is not a number with a unit', "")
        number = units.parse(value, quantity.dimension)
    except units.UnitError as error:
        raise _unit_fault(value, quantity, error) from None
    return check_range(number, quantity, shown(value))


def shape_in_words(value: object) -> str:
    """Describe in words whether a value is a text, a list or a block."""
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a block of keys"
    if isinstance(value, (list, tuple)):
        return "a list"
    return "a text" if isinstance(value, str) else type(value).__name__


class ValueKind:
    """A kind of value; `help` is the meaning of its field."""

    help: str = ""
    example: str = "…"

    def validate(self, value: Any) -> Any:
        """Convert a stated value to the design's value; raise `ValueFault` if it is invalid."""
        raise NotImplementedError

    def _call(self, value: Any) -> Any:
        try:
            return self.validate(value)
        except ValueFault as fault:
            context = {"message": fault.message, "remedy": fault.remedy}
            raise PydanticCustomError("value", "{message}; {remedy}", context) from None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        schema = core_schema.no_info_plain_validator_function(self._call)
        return core_schema.nullable_schema(schema) if type(None) in get_args(source) else schema


class Of(ValueKind):
    """A number with a quantity: a text needs a unit, a Python number is in SI."""

    def __init__(self, quantity: str, help: str = "") -> None:
        self.quantity = (quantities.INPUTS | quantities.SCENARIOS)[quantity]
        self.help = help
        self.example = example(self.quantity)

    def validate(self, value: Any) -> float:
        """Convert to SI."""
        return read_quantity(value, self.quantity)


@dataclass(frozen=True, slots=True)
class Fraction:
    """A piston position as a fraction of the stroke, so that it moves when the stroke changes."""

    value: float


class PositionKind(ValueKind):
    """Position: ``worst``, a length from the cap end, or a fraction of the stroke (``50 %``)."""

    help = "piston position from the cap end: worst, a length, or a share of the stroke (50 %)"
    example = "50 %"
    length = quantities.INPUTS["position"]
    fraction = quantities.INPUTS["fraction"]

    def quantity_of(self, value: object) -> Quantity:
        """Quantity of a position: length or ratio, depending on how it is written."""
        is_share = isinstance(value, Fraction) or (isinstance(value, str) and "%" in value)
        return self.fraction if is_share else self.length

    def validate(self, value: Any) -> Position:
        """Convert to ``"worst"``, a length in m, or a `Fraction`."""
        if isinstance(value, Fraction):
            return Fraction(check_range(value.value, self.fraction))
        if isinstance(value, str):
            if value.strip() == "worst":
                return "worst"
            if "%" in value:
                return Fraction(read_quantity(value, self.fraction))
        try:
            return read_quantity(value, self.length)
        except ValueFault as fault:
            if "valid range" in fault.message or "must be" in fault.message:
                raise
            raise ValueFault(fault.message, 'write worst, "50 %" or "55 mm"') from None


Position: TypeAlias = Literal["worst"] | float | Fraction
"""Piston position in a load case."""


def position_at(position: Position, stroke: Array) -> Array | None:
    """Distance of the piston from the cap end (m); None for the worst position."""
    if isinstance(position, Fraction):
        return position.value * stroke
    return None if isinstance(position, str) else position


class Text(ValueKind):
    """Free text of at most `longest` characters; with `multiline`, it may have several lines."""

    example = "robot knee"

    def __init__(self, help: str = "", longest: int = 200, multiline: bool = False) -> None:
        self.help = help
        self.longest = longest
        self.multiline = multiline

    def validate(self, value: Any) -> str:
        """Return the text if it is valid."""
        if not isinstance(value, str):
            raise ValueFault(f"need a text, not {shape_in_words(value)}", "write one value")
        unprintable = [
            c for c in value if not (c.isprintable() or (self.multiline and c in "\n\t"))
        ]
        if unprintable:
            raise ValueFault(f'"{shown(value)}": contains unprintable characters', "remove them")
        if len(value) > self.longest:
            raise ValueFault(
                f'"{shown(value)}": {len(value)} characters are too many',
                f"write at most {self.longest}",
            )
        if not value.strip() and not self.multiline:
            raise ValueFault("the text is empty", "write a name")
        return value


class Label(Text):
    """A free text, with the example that messages show."""

    def __init__(self, help: str, example: str, longest: int = 200) -> None:
        super().__init__(help, longest)
        self.example = example


class FileName(Label):
    """Name of a file, relative to the folder of the file that names it."""

    def __init__(self, help: str, example: str) -> None:
        super().__init__(help, example, 300)

    def validate(self, value: Any) -> str:
        """The name of the file."""
        text = super().validate(value)
        if text.strip() == "-":
            raise ValueFault(f'"{shown(text)}" is not a file', f"write e.g. {self.example}")
        return text


class Boolean(ValueKind):
    """A boolean."""

    example = "false"
    words: Final = {
        **dict.fromkeys(("true", "yes", "on", "1"), True),
        **dict.fromkeys(("false", "no", "off", "0"), False),
    }

    def __init__(self, help: str) -> None:
        self.help = help

    def validate(self, value: Any) -> bool:
        """Convert to True or False."""
        if value in (0, 1):  # accept booleans, and numbers that a script sets
            return bool(value)
        if isinstance(value, str) and value.strip().lower() in self.words:
            return self.words[value.strip().lower()]
        word = f'"{shown(value)}"' if isinstance(value, str) else shape_in_words(value)
        raise ValueFault(f"need true or false, not {word}", "write true or false")


class Choice(ValueKind):
    """A word from a short list; `help` states the meaning of each word.

    Parameters
    ----------
    help : text for the JSON Schema
    words : allowed words; if empty, the words of the field's `Literal`
    """

    def __init__(self, help: str, words: tuple[str, ...] = ()) -> None:
        self.help = help
        self.words = words

    def validate(self, value: Any) -> Any:
        """Return the value if it is among `words`; if none are given, the `Literal` checks it."""
        return value

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        if not self.words:
            return handler(source)
        schema = core_schema.literal_schema(list(self.words))
        return core_schema.nullable_schema(schema) if type(None) in get_args(source) else schema


def choice_of(help: str, registry: kinds.Kinds[Any]) -> Choice:
    """A choice among the names of a registry, with the meaning of each name."""
    return Choice(f"{help}; {registry.help}", registry.names)


class TableRow(Choice):
    """A row of a table of standard sizes, by its name; the table is read when first used."""

    def __init__(self, help: str, table: str) -> None:
        self.meaning = help
        self.table = table

    @property
    def words(self) -> tuple[str, ...]:  # type: ignore[override]
        """Names of the rows."""
        from .standard_sizes import tables

        return tables().names(self.table)

    @property
    def help(self) -> str:  # type: ignore[override]
        """Meaning of the key, and of every name."""
        from .standard_sizes import meaning

        rows = (f"{word}: {meaning(self.table, word)}" for word in self.words)
        return "; ".join([self.meaning, *rows])


class CaseName(Text):
    """Name of a load case; it must be usable inside a PATH such as ``load_cases[NAME].force``."""

    example = "stance"

    def validate(self, value: Any) -> str:
        """Return the name if it is valid."""
        text = super().validate(value)
        if _NAME.fullmatch(text) is None:
            raise ValueFault(
                f'"{shown(text)}": not a valid name',
                "start with a letter; use letters, digits, space, _ . + -",
            )
        return text


class EntryName(CaseName):
    """Name of an entry in another list of the file; unlike free text, a choice may change it."""

    example = "low"


class MaterialName(Text):
    """Name of a library material.

    Parameters
    ----------
    role : role that states which kinds of material the field accepts (`material.ROLES`)
    usual : kinds that faults suggest; default: all that the role accepts
    """

    def __init__(
        self,
        role: Literal["structural", "isotropic", "fluid", "seal", "fastening", "adhesive"],
        usual: tuple[str, ...] = (),
    ) -> None:
        article = "an" if role[0] in "aeiou" else "a"
        super().__init__(f"name of {article} {role} material from the library")
        self.role = role
        self.usual = usual
        self.example = MATERIAL_EXAMPLES[role]


class SizesKind(ValueKind):
    """Allowed sizes of a variable: the name of a series, or a list."""

    help = "allowed sizes: a series such as iso_3320, or a list of values"
    example = "iso_3320"

    def validate(self, value: Any) -> str | tuple[float, ...]:
        """Return the name or list; its entries are checked later."""
        if isinstance(value, str):
            return value
        if not isinstance(value, (list, tuple)):  # `sizes` checks the entries
            raise ValueFault(
                f"need sizes, not {shape_in_words(value)}", "write a series, or a list"
            )
        return tuple(value)


class ObjectiveKind(ValueKind):
    """An objective: a metric, or a block of metrics with positive weights."""

    help = "a metric, or several with weights (each is divided by its value in the design)"
    example = "mass"

    def validate(self, value: Any) -> str | dict[str, float]:
        """Return the metric's name, or weights by the name of the metric."""
        if isinstance(value, str):
            return value
        if not isinstance(value, Mapping) or not value:
            raise ValueFault(f"need a metric, not {shape_in_words(value)}", "write e.g. mass")
        for name, weight in value.items():
            if not isinstance(weight, (int, float)) or not 0 < weight < math.inf:
                raise ValueFault(f"{name}: the weight must be > 0", "write e.g. mass: 1")
        return {str(name): float(weight) for name, weight in value.items()}


class Section(BaseModel):
    """A block of the design file; unknown keys are faults."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    def __repr__(self) -> str:
        """Name of the block with its values, in one line."""
        return brief(type(self).__name__, self)

    __str__ = __repr__
