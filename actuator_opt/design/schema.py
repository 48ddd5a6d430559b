"""JSON Schema (draft-07) of the design file, for completion, hover and checks in an editor.

Generated from the same declarations the reader uses: sections of `model`, quantities, units and
metrics. Texts carry what yaml-language-server and VS Code show: `description` on hover,
`patternErrorMessage` where a unit is wrong, `examples` and `defaultSnippets` on completion.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from .. import quantities, units
from ..quantities import Quantity
from . import choice_list, layup, wishes
from .kinds import CaseName, Flag, Kind, MaterialName, Of, PositionKind, Text, example
from .material import ROLES
from .model import Design, Ply
from .section import Section
from .structure import Entry, entries
from .view import Materials

Schema = dict[str, Any]

_NUMBER = r"(\d[\d_]*\.?\d*|\.\d+)([eE][+-]?\d+)?"
_REFERENCE = str.maketrans({"/": "_per_", "^": "", "*": "_", "%": "percent"})
_LISTED = {"barrel.layup": 6, "rod.layup": 4, "lines": 2}
"""How many entries of a list have their PATHs offered by name under `variables`."""


def json_schema(
    *,
    materials: Materials | None = None,
    metrics: Mapping[str, Quantity] | None = None,
) -> Schema:
    """The schema of a design file.

    Parameters
    ----------
    materials : library whose names are offered; None takes any name
    metrics : metrics that may be named; default: `quantities.METRICS`
    """
    metrics = quantities.METRICS if metrics is None else metrics
    definitions: Schema = {}
    schema = _section(Design, materials)
    properties = schema["properties"]
    properties["variables"] |= _variables(definitions)
    properties["measured"] |= _measured(definitions)
    properties["choices"] |= _choices()
    properties["requirements"] |= _requirements(metrics, definitions)
    properties["objective"] |= _objective(metrics)
    properties["waivers"] |= _waivers(metrics)
    properties["materials"] |= _materials(materials)
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "actuator-opt design",
        **schema,
        "definitions": definitions,
    }


def _text_of(help: str, quantity: Quantity | None = None) -> str:
    """Hover text: what it is, its symbol, range, units and an example."""
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
    """A unit in every spelling the reader takes: N*m, N·m, N m, Nm; m^3, m³, m3, m**3."""
    pattern = re.escape(name).replace(r"\ ", " ").replace(r"\-", "-").replace(r"\*", "[*·⋅ ]?")
    for power, raised in (("2", "²"), ("3", "³")):
        pattern = pattern.replace(rf"\^{power}", rf"(\^|\*\*)?{power}".join(("(", f"|{raised})")))
    return pattern


def quantity_schema(quantity: Quantity, help: str = "") -> Schema:
    """A value of a quantity: text with one of its units; bare where the reader takes it bare."""
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
        "description": _text_of(help, quantity),
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


def _value(kind: Kind | None, materials: Materials | None) -> Schema:
    if isinstance(kind, Of):
        return quantity_schema(kind.quantity, kind.help)
    if isinstance(kind, PositionKind):
        length = quantity_schema(kind.length)
        share = {"type": "string", "pattern": f"^\\s*\\+?{_NUMBER}\\s*%\\s*$"}
        message = 'write worst, a length ("55 mm") or a share of the stroke ("50 %")'
        keep = ("type", "pattern", "minimum", "maximum")
        return {
            "title": "position",
            "description": kind.help,
            "anyOf": [{"const": "worst"}, {k: length[k] for k in keep if k in length}, share],
            "errorMessage": message,
            "examples": ["worst", "50 %", "55 mm"],
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
            schema |= {"enum": names, "errorMessage": "no such material of a fitting kind"}
        return schema
    # names such as 12 or true are texts for the reader, numbers or booleans for an editor
    schema["type"] = ["string", "number", "boolean"]
    if isinstance(kind, CaseName):
        schema["type"] = "string"
    if isinstance(kind, Text):
        schema["maxLength"] = kind.longest
        schema["examples"] = [kind.example]
    return schema


def _entry(entry: Entry, materials: Materials | None) -> Schema:
    if entry.shape == "choice":
        help = entry.kind.help if entry.kind is not None else ""
        schema: Schema = {"description": help, "type": "string", "enum": list(entry.choices)}
    elif entry.shape == "section" and entry.section is not None:
        schema = _section(entry.section, materials)
    elif entry.shape == "list":
        of = entry.section
        items = _value(entry.kind, materials) if of is None else _section(of, materials)
        schema = {"type": "array", "minItems": entry.least, "items": items}
        schema["description"] = items["description"]
        if entry.most is not None:
            schema["maxItems"] = entry.most
    elif entry.shape == "table":
        schema = {"type": "object"}
    else:
        schema = _value(entry.kind, materials)
    if isinstance(entry.default, str):
        schema["default"] = entry.default
    return schema


def _section(section: type[Section], materials: Materials | None) -> Schema:
    known = entries(section)
    schema: Schema = {
        "description": (section.__doc__ or "").split("\n\n")[0].replace("\n    ", " "),
        "type": "object",
        "additionalProperties": False,
        "properties": {name: _entry(entry, materials) for name, entry in known.items()},
    }
    required = [name for name, entry in known.items() if entry.required]
    if required:
        schema["required"] = required
        body = {name: _snippet(entry) for name, entry in known.items() if entry.required}
        schema["defaultSnippets"] = [{"label": section.__name__.lower(), "body": body}]
    return _with_notation(schema) if section is Ply else schema


def _with_notation(schema: Schema) -> Schema:
    """A layer, or several of them in compact notation."""
    said = [{"required": [key]} for key in ("angle", "thickness", "balanced")]
    schema["properties"]["plies"] = {
        "title": "lay-up in compact notation",
        "description": "Several layers, from the inside outwards: angles in degrees, +-25 a "
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


def _of_parts(section: type[Section] = Design, prefix: str = "") -> dict[str, Entry]:
    """PATH of every value of a part, ``[*]`` standing for the index of a list."""
    found: dict[str, Entry] = {}
    for name, entry in entries(section).items():
        path = f"{prefix}.{name}" if prefix else name
        if entry.section is not None and entry.shape in ("section", "list"):
            found |= _of_parts(entry.section, path if entry.shape == "section" else f"{path}[*]")
        elif entry.shape in ("value", "choice") and prefix and not prefix.startswith("objective"):
            found[path] = entry
    return found


def _by_path(schemas: Mapping[str, Schema]) -> Schema:
    """Properties by PATH; those with an index as patterns, the first ones of a list by name."""
    properties: Schema = {}
    patterns: Schema = {}
    for path, schema in schemas.items():
        if "[*]" not in path:
            properties[path] = schema
            continue
        head, _, tail = path.partition("[*]")
        inside = "[0-9]+" if head != "load_cases" else r"[^\[\]]+"
        patterns[f"^{re.escape(head)}\\[{inside}\\]{re.escape(tail)}$"] = schema
        for index in range(_LISTED.get(head, 0)):
            listed = f"{head}[{index}]{tail}"
            properties[listed] = schema | {"title": listed}
    return {
        "additionalProperties": False,
        "properties": properties,
        "patternProperties": patterns,
    }


def _bounds(kind: Of, path: str, definitions: Schema) -> Schema:
    name = kind.quantity.name
    definitions.setdefault(name, quantity_schema(kind.quantity))
    return {
        "title": path,
        "description": _text_of(kind.help, kind.quantity),
        "type": "object",
        "additionalProperties": False,
        "required": ["lower", "upper"],
        "properties": {
            key: {"$ref": f"#/definitions/{name}"} for key in ("lower", "upper", "start")
        },
    }


def _variables(definitions: Schema) -> Schema:
    movable = {
        path: _bounds(entry.kind, path, definitions)
        for path, entry in _of_parts().items()
        if isinstance(entry.kind, Of) and entry.kind.quantity.dimension != "count"
    }
    help = "What the optimiser may move: PATH with lower and upper bound."
    return {"description": help} | _by_path(movable)


def _measured(definitions: Schema) -> Schema:
    known: Schema = {}
    for path, entry in _of_parts().items():
        if isinstance(entry.kind, Of):
            known[path] = bounds = _bounds(entry.kind, path, definitions)
            bounds["required"] = [*bounds["required"], "record"]
            del bounds["properties"]["start"]
            bounds["properties"]["record"] = {
                "type": "string",
                "description": "the record, as a report names it",
            }
    help = "What a test record says of values above: PATH with 95 % bounds and the record's name."
    return {"description": help} | _by_path(known)


def _choices() -> Schema:
    lists: dict[str, Schema] = {}
    for path, entry in _of_parts().items():
        kind = entry.kind
        if isinstance(kind, Text) and not isinstance(kind, MaterialName):
            continue
        place = path.replace("[*]", ".items").replace(".", "/properties/")
        place = place.replace("/properties/items", "/items")
        lists[path] = {
            "title": path,
            "type": "array",
            "minItems": 1,
            "maxItems": choice_list.MOST_VALUES,
            "uniqueItems": True,
            "items": {"$ref": f"#/properties/{place}"},
        }
    help = "What the optimiser may choose among: PATH with a list of allowed values."
    return {"description": help} | _by_path(lists)


def _requirements(metrics: Mapping[str, Quantity], definitions: Schema) -> Schema:
    properties: Schema = {}
    for name, metric in metrics.items():
        kind = f"limit_{metric.dimension}_{metric.unit}".translate(_REFERENCE)
        quantity = replace(wishes.limit_quantity(metric), label="limit", symbol=metric.unit or "-")
        definitions.setdefault(kind, quantity_schema(quantity))
        properties[name] = {
            "title": metric.label,
            "description": f"{metric.label} ({metric.symbol})"
            + (f", in {metric.unit} in reports" if metric.unit else ""),
            "type": "object",
            "additionalProperties": False,
            "minProperties": 1,
            "properties": {key: {"$ref": f"#/definitions/{kind}"} for key in ("min", "max")},
        }
    return {
        "description": "Limits on metrics, met in the worst load case.",
        "additionalProperties": False,
        "properties": properties,
    }


def _objective(metrics: Mapping[str, Quantity]) -> Schema:
    labels = [metric.label for metric in metrics.values()]
    weights = {
        name: {"type": "number", "exclusiveMinimum": 0, "description": metric.label}
        for name, metric in metrics.items()
    }
    goal = {
        "anyOf": [
            {"type": "string", "enum": list(metrics), "enumDescriptions": labels},
            {
                "type": "object",
                "additionalProperties": False,
                "minProperties": 1,
                "properties": weights,
            },
        ]
    }
    return {
        "properties": {"minimise": goal, "maximise": goal},
        "oneOf": [{"required": ["minimise"]}, {"required": ["maximise"]}],
    }


def _waivers(metrics: Mapping[str, Quantity]) -> Schema:
    return {
        "description": "Checks that do not apply: METRIC with the reason, which is printed.",
        "additionalProperties": False,
        "properties": {
            name: {"type": "string", "title": metric.label, "description": "why it does not apply"}
            for name, metric in metrics.items()
        },
    }


def _materials(materials: Materials | None) -> Schema:
    changed = {
        "type": "object",
        "additionalProperties": False,
        "properties": {
            name: quantity_schema(quantity)
            for name, quantity in quantities.MATERIAL_PROPERTIES.items()
        },
    }
    schema: Schema = {
        "description": "Properties that replace the library's in this design, by material name.",
        "additionalProperties": changed,
    }
    if materials is not None:
        schema["propertyNames"] = {"enum": list(materials.names())}
    return schema
