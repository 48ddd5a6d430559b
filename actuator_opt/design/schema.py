"""JSON Schema (draft-07) of input files, for completion, hover and checks in an editor.

Generated from the declarations that the reader uses: classes of `model`, quantities, units and
metrics. yaml-language-server and VS Code show `description` on hover, `patternErrorMessage` for a
wrong unit, `examples` and `defaultSnippets` on completion.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ..base import quantities, units
from ..base.quantities import Quantity
from ..metrics import METRICS
from . import choice_list, layup, requirements
from .kinds import (
    Boolean,
    CaseName,
    MaterialName,
    Of,
    PositionKind,
    Section,
    SizesKind,
    Text,
    ValueFault,
    ValueKind,
    example,
)
from .material import ROLES
from .model import Design, Ply, Uncertain
from .paths import NAMED_LISTS
from .sizes import MOST_SIZES
from .standard_sizes import SERIES
from .structure import (
    NONE,
    KeyEntry,
    MaterialLookup,
    blocks,
    entries,
    is_removed_by_none,
    purpose,
    templates,
)
from .uncertain import NUMBERS, quantity_of_entry

Schema = dict[str, Any]
_NUMBER = r"(\d[\d_]*\.?\d*|\.\d+)([eE][+-]?\d+)?"


def text_of(help: str, quantity: Quantity | None = None) -> str:
    """Hover text of a key: meaning, symbol, range, units and an example."""
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
    """Regular expression for all accepted spellings of a unit: N*m, N·m, N m, Nm; m^3, m³, m3."""
    pattern = re.escape(name).replace(r"\ ", " ").replace(r"\-", "-").replace(r"\*", "[*·⋅ ]?")
    for power, raised in (("2", "²"), ("3", "³")):
        pattern = pattern.replace(rf"\^{power}", rf"(\^|\*\*)?{power}".join(("(", f"|{raised})")))
    return pattern


def quantity_schema(quantity: Quantity, help: str = "") -> Schema:
    """Schema of a quantity: a text with a unit, or a bare number if the reader accepts that."""
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


def _takes(kind: ValueKind, text: str) -> bool:
    try:
        kind.validate(text)
    except ValueFault:
        return False
    return True


def value_schema(kind: ValueKind | None, materials: MaterialLookup | None) -> Schema:
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
    if isinstance(kind, Boolean):
        words = [*kind.words, True, False]
        return {"description": help, "enum": words, "examples": [True, False]}
    schema: Schema = {"description": help, "type": "string"}
    if isinstance(kind, MaterialName):
        schema |= {"title": "material", "examples": [kind.example]}
        if materials is not None:
            names = [n for n in materials.names() if materials.kind(n) in ROLES[kind.role]]
            schema |= {
                "enum": names,
                "errorMessage": "unknown material, or a material of an unsuitable kind",
            }
        return schema
    # names such as 12 or true are text to the reader, but numbers or booleans to an editor
    schema["type"] = ["string", "number", "boolean"]
    if isinstance(kind, CaseName):
        schema["type"] = "string"
    if isinstance(kind, Text):
        schema["maxLength"] = kind.longest
        schema["examples"] = [kind.example]
    return schema


def entry_schema(entry: KeyEntry, materials: MaterialLookup | None) -> Schema:
    """Schema for the value of a key."""
    if entry.shape == "choice":
        help = entry.kind.help if entry.kind is not None else ""
        schema: Schema = {"description": help, "type": "string", "enum": list(entry.choices)}
    elif entry.shape == "section" and entry.section is not None:
        schema = section_schema(entry.section, materials)
    elif entry.shape == "list":
        section = entry.section
        items = (
            value_schema(entry.kind, materials)
            if section is None
            else section_schema(section, materials)
        )
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


def section_schema(section: type[Section], materials: MaterialLookup | None) -> Schema:
    """Schema of a block of keys; the editor offers its required keys as a snippet."""
    keys = entries(section)
    schema: Schema = {
        "description": purpose(section),
        "type": "object",
        "additionalProperties": False,
        "properties": {name: entry_schema(entry, materials) for name, entry in keys.items()},
    }
    required = [name for name, entry in keys.items() if entry.required]
    if required:
        schema["required"] = required
        body = {name: _snippet(entry) for name, entry in keys.items() if entry.required}
        label = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", section.__name__).lower()
        schema["defaultSnippets"] = [{"label": label, "body": body}]
    return _with_notation(schema) if section is Ply else schema


def _with_notation(schema: Schema) -> Schema:
    """Schema of an entry of a lay-up: one layer, or several layers in compact notation."""
    excluded = [{"required": [key]} for key in ("angle", "thickness", "balanced")]
    schema["properties"]["plies"] = {
        "title": "lay-up in compact notation",
        "description": "Several layers, from the inside outwards, given by angles in degrees. +-25 "
        "is a balanced pair of plies, 25 is one ply at that angle, _n repeats a group n times, "
        "s mirrors it",
        "type": ["string", "number"],
        "pattern": r"^[-+±0-9./_\[\]sS\s]+$",
        "examples": [layup.EXAMPLE],
        "errorMessage": f'write e.g. "{layup.EXAMPLE}", with ply_thickness',
    }
    schema["required"] = ["material"]
    schema["oneOf"] = [
        {"required": ["thickness"], "not": {"required": ["plies"]}},
        {"required": ["plies", "ply_thickness"], "not": {"anyOf": excluded}},
    ]
    body = {"material": "t700_epoxy", "plies": layup.EXAMPLE, "ply_thickness": "0.2 mm"}
    schema["defaultSnippets"].append({"label": "plies", "body": body})
    return schema


def _snippet(entry: KeyEntry) -> Any:
    if entry.section is not None:
        below = {n: _snippet(e) for n, e in entries(entry.section).items() if e.required}
        return [below] if entry.shape == "list" else below
    if entry.choices:
        return entry.choices[0]
    return entry.kind.example if entry.kind is not None else ""


_OF_CASE = r"^\w+\[[^\[\]]+\]$"
"""Pattern of a metric in one load case or duty cycle."""
_REFERENCE = str.maketrans({"/": "_per_", "^": "", "*": "_", "%": "percent"})
_LISTED = {"barrel.layup": 6, "rod.layup": 4, "lines": 2}
"""Number of entries in each list for which the editor offers PATHs under `variables`."""
_OF_TABLES = (
    r"^(name|notes|(objective|requirements|variables|measured|uncertainty|materials|waivers)\..+)$"
)
"""Pattern of the PATHs that the block `set` of a scenario accepts besides values of the design's
parts."""


def json_schema(
    root: type[Section] = Design,
    *,
    materials: MaterialLookup | None = None,
    metrics: Mapping[str, Quantity] | None = None,
) -> Schema:
    """JSON Schema of a design file, or of another type of file.

    Parameters
    ----------
    root : class of the whole file, such as `Design`
    materials : library whose material names are offered; None: any name is accepted
    metrics : allowed metrics; default: `metrics.METRICS`
    """
    metrics = METRICS if metrics is None else metrics
    definitions: Schema = {}
    schema = section_schema(root, materials)
    tables: dict[str, Callable[[], Schema]] = {
        "set": lambda: _set(materials, definitions),
        "unset": _unset,
        "variables": lambda: _variables(definitions),
        "measured": lambda: _measured(definitions),
        "uncertainty": lambda: _uncertainty(definitions),
        "choices": _choices,
        "requirements": lambda: _requirements(
            entries(root)["requirements"].section, metrics, definitions
        ),
        "objective": lambda: _objective(metrics),
        "waivers": lambda: _waivers(metrics),
        "materials": lambda: _materials(materials),
    }
    for name, table in tables.items():
        if name in entries(root):
            schema["properties"][name] |= table()
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": f"actuator-opt {root.__name__.lower()}",
        **schema,
        "definitions": definitions,
    }


def _by_path(schemas: Mapping[str, Schema]) -> Schema:
    """Schema of a table with PATHs as keys.

    PATHs with an index are patterns; for the first entries of a list they are also listed by name.
    """
    properties: Schema = {}
    patterns: Schema = {}
    for path, schema in schemas.items():
        if "[*]" not in path:
            properties[path] = schema
            continue
        head, _, tail = path.partition("[*]")
        named = tuple(head.split(".")) in NAMED_LISTS
        inside = r"[^\[\]]+" if named else "[0-9]+"
        below = r"\[[0-9]+\]".join(map(re.escape, tail.split("[*]")))
        patterns[f"^{re.escape(head)}\\[{inside}\\]{below}$"] = schema
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
        "description": text_of(kind.help, kind.quantity),
        "type": "object",
        "additionalProperties": False,
        "required": ["lower", "upper"],
        "properties": {key: {"$ref": f"#/definitions/{name}"} for key in ("lower", "upper")},
    }


def _variables(definitions: Schema) -> Schema:
    movable: Schema = {}
    for path, entry in templates().items():
        if isinstance(entry.kind, Of) and entry.kind.quantity.dimension != "count":
            movable[path] = bounds = _bounds(entry.kind, path, definitions)
            bounds["not"] = {"required": ["sizes", "step"]}
            bounds["properties"] |= _start_and_sizes(entry.kind.quantity, path)
    help = "Variables of the optimisation: PATH with lower and upper bound."
    return {"description": help} | _by_path(movable)


def _start_and_sizes(quantity: Quantity, path: str) -> Schema:
    """Schemas of the keys `start`, `step` and `sizes` of a variable."""
    value = {"$ref": f"#/definitions/{quantity.name}"}
    suitable = [s for s in SERIES.values() if s.paths.fullmatch(path.replace("[*]", "[0]"))]
    sizes = {"type": "array", "minItems": 1, "maxItems": MOST_SIZES, "uniqueItems": True}
    series: Schema = {"enum": [s.name for s in suitable]}
    series["enumDescriptions"] = [s.label for s in suitable]
    options = [series] if suitable else []
    return {
        "start": value,
        "step": {
            "description": "The variable takes only multiples of this step",
            "allOf": [value],
        },
        "sizes": {"description": SizesKind.help, "anyOf": [*options, sizes | {"items": value}]},
    }


def _measured(definitions: Schema) -> Schema:
    schemas: Schema = {}
    for path, entry in templates().items():
        if isinstance(entry.kind, Of):
            schemas[path] = bounds = _bounds(entry.kind, path, definitions)
            bounds["required"] = [*bounds["required"], "record"]
            bounds["properties"]["record"] = {
                "type": "string",
                "description": "name of the test record, for reports",
            }
    help = (
        "Values from a test record: PATH with the bounds of its 95 % confidence interval "
        "and the name of the record."
    )
    return {"description": help} | _by_path(schemas)


def _uncertainty(definitions: Schema) -> Schema:
    schemas: Schema = {}
    for path, entry in templates().items():
        if isinstance(entry.kind, Of) and entry.kind.quantity.dimension != "count":
            schemas[path] = _distribution(path, entry.kind.quantity, definitions)
    for name, quantity in quantities.MATERIAL_PROPERTIES.items():
        schemas[f"materials.[*].{name}"] = _distribution(name, quantity, definitions)
    schema = _by_path({p: s for p, s in schemas.items() if not p.startswith("materials.")})
    for name in quantities.MATERIAL_PROPERTIES:
        pattern = rf"^materials\.[^.]+\.{name}$"
        schema["patternProperties"][pattern] = schemas[f"materials.[*].{name}"]
    help = (
        "Scatter of values: PATH with a distribution. The scatter of library values and usual "
        "tolerances need no entry."
    )
    return {"description": help} | schema


def _distribution(title: str, quantity: Quantity, definitions: Schema) -> Schema:
    """Schema of an entry of `uncertainty`, by reference to the definition for its quantity."""
    name = f"uncertainty_{quantity.name}"
    if name not in definitions:
        definitions[name] = _shared(quantity, definitions)
    return {"title": title, "allOf": [{"$ref": f"#/definitions/{name}"}]}


def _shared(quantity: Quantity, definitions: Schema) -> Schema:
    """Definition that all entries of `uncertainty` with the same quantity share."""
    schema = section_schema(Uncertain, None)
    for key in [name for name in schema["properties"] if name not in NUMBERS]:
        definitions.setdefault(f"key_{key}", schema["properties"][key])
        schema["properties"][key] = {"$ref": f"#/definitions/key_{key}"}
    for key in NUMBERS:
        key_quantity = quantity_of_entry(key, quantity)
        assert key_quantity is not None
        if key in ("deviation", "half_width"):  # equal for all quantities of a unit
            words = key.replace("_", " ")
            kind = f"{key}_{key_quantity.dimension}_{key_quantity.unit}".translate(_REFERENCE)
            key_quantity = replace(
                key_quantity, name=kind, label=words, symbol=key_quantity.unit or "-", upper=1e20
            )
        definitions.setdefault(key_quantity.name, quantity_schema(key_quantity))
        schema["properties"][key] = {"$ref": f"#/definitions/{key_quantity.name}"}
    schema["required"] = []
    schema["anyOf"] = [{"required": [key]} for key in ("distribution", "tolerance")]
    return schema


def _set(materials: MaterialLookup | None, definitions: Schema) -> Schema:
    schemas: Schema = {}
    for path, entry in templates().items():
        schemas[path] = entry_schema(entry, materials)
        if isinstance(entry.kind, Of):
            name = entry.kind.quantity.name
            definitions.setdefault(name, quantity_schema(entry.kind.quantity))
            text = text_of(entry.kind.help, entry.kind.quantity)
            schemas[path] = {"description": text, "allOf": [{"$ref": f"#/definitions/{name}"}]}
        schemas[path]["title"] = path
    schema = _by_path(schemas)
    schema["patternProperties"][_OF_TABLES] = {"type": ["string", "number"]}
    return {"description": "Values of the design that the scenario changes, by PATH."} | schema


def _unset() -> Schema:
    paths = (*templates(), *blocks())
    patterns = (r"\[[^\[\]]+\]".join(map(re.escape, path.split("[*]"))) for path in paths)
    return {
        "description": "Keys and blocks of the design that the scenario removes, before set.",
        "items": {
            "title": "PATH of the design",
            "type": "string",
            "pattern": f"^({'|'.join(patterns)})$|{_OF_TABLES}",
            "examples": [path for path in paths if "[*]" not in path],
        },
    }


def _choices() -> Schema:
    lists: dict[str, Schema] = {}
    none: Schema = {"description": "the design without this block", "const": NONE}
    for path, entry in templates().items():
        kind = entry.kind
        if isinstance(kind, Text) and not isinstance(kind, MaterialName):
            continue
        place = path.replace("[*]", ".items").replace(".", "/properties/")
        place = place.replace("/properties/items", "/items")
        removable = is_removed_by_none(tuple(path.split(".")))
        value: Schema = {"$ref": f"#/properties/{place}"}
        lists[path] = {
            "title": path,
            "type": "array",
            "minItems": 1,
            "maxItems": choice_list.MOST_VALUES,
            "uniqueItems": True,
            "items": {"anyOf": [none, value]} if removable else value,
        }
    help = "Choices of the optimiser: PATH with a list of allowed values."
    return {"description": help} | _by_path(lists)


def _requirements(
    section: type[Section] | None, metrics: Mapping[str, Quantity], definitions: Schema
) -> Schema:
    properties: Schema = {}
    texts: Schema = {}
    if section is not None:
        for key, entry in entries(section).items():
            if isinstance(entry.kind, Text):
                definitions[key] = entry_schema(entry, None)
                texts[key] = {"$ref": f"#/definitions/{key}"}
    for name, metric in metrics.items():
        kind = f"limit_{metric.dimension}_{metric.unit}".translate(_REFERENCE)
        quantity = replace(
            requirements.limit_quantity(metric), label="limit", symbol=metric.unit or "-"
        )
        definitions.setdefault(kind, quantity_schema(quantity))
        properties[name] = {
            "title": metric.label,
            "description": f"{metric.label} ({metric.symbol})"
            + (f", in {metric.unit} in reports" if metric.unit else ""),
            "type": "object",
            "additionalProperties": False,
            "minProperties": 1,
            "properties": texts
            | {key: {"$ref": f"#/definitions/{kind}"} for key in ("min", "max")},
        }
    limits = {"type": "object", "additionalProperties": False, "minProperties": 1}
    limits["properties"] = texts | {key: {"type": ["string", "number"]} for key in ("min", "max")}
    return {
        "description": "Limits that metrics must meet in the worst load case; METRIC[NAME]: in one "
        "load case or duty cycle.",
        "additionalProperties": False,
        "properties": properties,
        "patternProperties": {_OF_CASE: limits},
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
            {"type": "string", "pattern": _OF_CASE},
            {
                "type": "object",
                "additionalProperties": False,
                "minProperties": 1,
                "properties": weights,
                "patternProperties": {_OF_CASE: {"type": "number", "exclusiveMinimum": 0}},
            },
        ]
    }
    return {
        "properties": {"minimise": goal, "maximise": goal},
        "oneOf": [{"required": ["minimise"]}, {"required": ["maximise"]}],
    }


def _waivers(metrics: Mapping[str, Quantity]) -> Schema:
    return {
        "description": "Checks that do not apply: METRIC with the reason, which reports print.",
        "additionalProperties": False,
        "properties": {
            name: {
                "type": "string",
                "title": metric.label,
                "description": "reason why the check does not apply",
            }
            for name, metric in metrics.items()
        },
    }


def _materials(materials: MaterialLookup | None) -> Schema:
    changed = {
        "type": "object",
        "additionalProperties": False,
        "properties": {
            name: quantity_schema(quantity)
            for name, quantity in quantities.MATERIAL_PROPERTIES.items()
        },
    }
    schema: Schema = {
        "description": "Properties that replace those of the library, by material name.",
        "additionalProperties": changed,
    }
    if materials is not None:
        schema["propertyNames"] = {"enum": list(materials.names())}
    return schema
