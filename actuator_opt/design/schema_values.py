"""JSON Schema of single values and of their sections."""

from __future__ import annotations

import re
from typing import Any

from ..base import units
from ..base.quantities import Quantity
from . import layup
from .kinds import CaseName, Flag, Kind, MaterialName, Of, PositionKind, Text, ValueFault, example
from .material import ROLES
from .model import Ply
from .section import Section
from .structure import Entry, entries
from .view import Materials

Schema = dict[str, Any]

_NUMBER = r"(\d[\d_]*\.?\d*|\.\d+)([eE][+-]?\d+)?"


def text_of(help: str, quantity: Quantity | None = None) -> str:
    """Hover text: meaning, symbol, range, units and an example."""
    if quantity is None:
        return help
    names = ", ".join(units.units_of(quantity.dimension)) or "none (a bare number)"
    lines = [
        f"{help or quantity.label} ({quantity.symbol})",
        f"Quantity: {quantity.label}",
        f"Range: {quantity.range_text()}",
        f"Units: {names}",
        f"Example: {example(quantity)}",
    ]
    return "\n\n".join(lines)


def _unit_pattern(name: str) -> str:
    """Pattern of a unit in every accepted spelling: N*m, N·m, N m, Nm; m^3, m³, m3, m**3."""
    pattern = re.escape(name).replace(r"\ ", " ").replace(r"\-", "-").replace(r"\*", "[*·⋅ ]?")
    for power, raised in (("2", "²"), ("3", "³")):
        pattern = pattern.replace(rf"\^{power}", rf"(\^|\*\*)?{power}".join(("(", f"|{raised})")))
    return pattern


def quantity_schema(quantity: Quantity, help: str = "") -> Schema:
    """Schema of a quantity: text with a unit; a bare number where the reader accepts it."""
    names = sorted(units.units_of(quantity.dimension), key=len, reverse=True)
    bare = quantity.dimension in ("ratio", "count")
    sign = "[+-]?" if quantity.lower < 0 or quantity.dimension == "temperature" else r"\+?"
    unit = rf"\s*({'|'.join(map(_unit_pattern, names))})" if names else ""
    if bare and unit:
        unit = f"({unit})?"
    zero = rf"|{sign}0+(\.0*)?" if quantity.lower <= 0 <= quantity.upper and not bare else ""
    fault = f'write a number with its unit, e.g. "{example(quantity)}" ({quantity.range_text()})'
    if bare:
        fault = f'write a number, e.g. "{example(quantity)}" ({quantity.range_text()})'
    schema: Schema = {
        "title": quantity.label,
        "description": text_of(help, quantity),
        "type": "string",
        "pattern": f"^\\s*({sign}{_NUMBER}{unit}{zero})\\s*$",
        "patternErrorMessage": fault,
        "errorMessage": fault,
        "examples": [example(quantity)],
    }
    if bare:
        schema |= {
            "type": ["string", "number"],
            "minimum": quantity.lower,
            "maximum": quantity.upper,
        }
    elif zero:
        schema |= {"type": ["string", "number"], "minimum": 0, "maximum": 0}
    if quantity.dimension == "count":
        schema["multipleOf"] = 1
    return schema


def _takes(kind: Kind, text: str) -> bool:
    try:
        kind.validate(text)
    except ValueFault:
        return False
    return True


def value_schema(kind: Kind | None, materials: Materials | None) -> Schema:
    """Schema of a single value."""
    if isinstance(kind, Of):
        return quantity_schema(kind.quantity, kind.help)
    if isinstance(kind, PositionKind):
        length = quantity_schema(kind.length)
        share = {"type": "string", "pattern": f"^\\s*\\+?{_NUMBER}\\s*%\\s*$"}
        named = [word for word in ("worst",) if _takes(kind, word)]
        message = 'a length ("55 mm") or a share of the stroke ("50 %")'
        keep = ("type", "pattern", "minimum", "maximum")
        options = [{k: length[k] for k in keep if k in length}, share]
        return {
            "title": "position",
            "description": kind.help,
            "anyOf": [*({"const": word} for word in named), *options],
            "errorMessage": f"write {', '.join([*named, message])}",
            "examples": [*named, "50 %", "55 mm"],
        }
    help = kind.help if kind is not None else ""
    if isinstance(kind, Flag):
        words = [*kind.words, True, False]
        return {"description": help, "enum": words, "examples": [True, False]}
    schema: Schema = {"description": help, "type": "string"}
    if isinstance(kind, MaterialName):
        schema |= {"title": "material", "examples": [kind.example]}
        if materials is not None:
            names = [n for n in materials.names() if materials.kind(n) in ROLES[kind.role]]
            schema |= {"enum": names, "errorMessage": "unknown material, or unsuitable kind"}
        return schema
    # names such as 12 or true are text to the reader, but numbers or booleans to an editor
    schema["type"] = ["string", "number", "boolean"]
    if isinstance(kind, CaseName):
        schema["type"] = "string"
    if isinstance(kind, Text):
        schema["maxLength"] = kind.longest
        schema["examples"] = [kind.example]
    return schema


def entry_schema(entry: Entry, materials: Materials | None) -> Schema:
    """Schema of the value of a section's key."""
    if entry.shape == "choice":
        help = entry.kind.help if entry.kind is not None else ""
        schema: Schema = {"description": help, "type": "string", "enum": list(entry.choices)}
    elif entry.shape == "section" and entry.section is not None:
        schema = section_schema(entry.section, materials)
    elif entry.shape == "list":
        of = entry.section
        items = value_schema(entry.kind, materials) if of is None else section_schema(of, materials)
        schema = {"type": "array", "minItems": entry.least, "items": items}
        schema["description"] = items["description"]
        if entry.most is not None:
            schema["maxItems"] = entry.most
    elif entry.shape == "table":
        schema = {"type": "object"}
    else:
        schema = value_schema(entry.kind, materials)
    if isinstance(entry.default, str):
        schema["default"] = entry.default
    return schema


def section_schema(section: type[Section], materials: Materials | None) -> Schema:
    """A block of keys; the required keys are offered as a snippet."""
    known = entries(section)
    schema: Schema = {
        "description": (section.__doc__ or "").split("\n\n")[0].replace("\n    ", " "),
        "type": "object",
        "additionalProperties": False,
        "properties": {name: entry_schema(entry, materials) for name, entry in known.items()},
    }
    required = [name for name, entry in known.items() if entry.required]
    if required:
        schema["required"] = required
        body = {name: _snippet(entry) for name, entry in known.items() if entry.required}
        schema["defaultSnippets"] = [{"label": section.__name__.lower(), "body": body}]
    return _with_notation(schema) if section is Ply else schema


def _with_notation(schema: Schema) -> Schema:
    """A layer, or several layers in compact notation."""
    said = [{"required": [key]} for key in ("angle", "thickness", "balanced")]
    schema["properties"]["plies"] = {
        "title": "lay-up in compact notation",
        "description": "Several layers, from the inside outwards: angles in degrees, +-25 is a "
        "balanced pair of plies, 25 one ply at that angle, _n repeats, s mirrors a group",
        "type": ["string", "number"],
        "pattern": r"^[-+±0-9./_\[\]sS\s]+$",
        "examples": [layup.EXAMPLE],
        "errorMessage": f'write e.g. "{layup.EXAMPLE}", with ply_thickness',
    }
    schema["required"] = ["material"]
    schema["oneOf"] = [
        {"required": ["thickness"], "not": {"required": ["plies"]}},
        {"required": ["plies", "ply_thickness"], "not": {"anyOf": said}},
    ]
    body = {"material": "t700_epoxy", "plies": layup.EXAMPLE, "ply_thickness": "0.2 mm"}
    schema["defaultSnippets"].append({"label": "plies", "body": body})
    return schema


def _snippet(entry: Entry) -> Any:
    if entry.section is not None:
        below = {n: _snippet(e) for n, e in entries(entry.section).items() if e.required}
        return [below] if entry.shape == "list" else below
    if entry.choices:
        return entry.choices[0]
    return entry.kind.example if entry.kind is not None else ""
