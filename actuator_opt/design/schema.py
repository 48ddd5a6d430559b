"""JSON Schema (draft-07) of input files, for completion, hover and checks in an editor.

Generated from the declarations that the reader uses: sections of `model`, quantities, units and
metrics. yaml-language-server and VS Code show `description` on hover, `patternErrorMessage` for a
wrong unit, `examples` and `defaultSnippets` on completion.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace

from ..base import quantities
from ..base.quantities import Quantity
from ..metrics import METRICS
from . import choice_list, wishes
from .distributions import NUMBERS, quantity_of_entry
from .kinds import MaterialName, Of, Sizes, Text
from .model import Design
from .schema_values import Schema, entry_schema, quantity_schema, section_schema, text_of
from .section import Section
from .size_series import SERIES
from .sizes import MOST_SIZES
from .structure import Entry, entries
from .variable import Uncertain
from .view import Materials

_REFERENCE = str.maketrans({"/": "_per_", "^": "", "*": "_", "%": "percent"})
_LISTED = {"barrel.layup": 6, "rod.layup": 4, "lines": 2}
"""Number of entries of a list whose PATHs are listed by name under `variables`."""
_OF_TABLES = (
    r"^(name|notes|(objective|requirements|variables|measured|uncertainty|materials|waivers)\..+)$"
)
"""PATHs that `set` accepts besides those of the parts."""


def json_schema(
    root: type[Section] = Design,
    *,
    materials: Materials | None = None,
    metrics: Mapping[str, Quantity] | None = None,
) -> Schema:
    """JSON Schema of a design file, or of a file with another root section.

    Parameters
    ----------
    root : section type of the file
    materials : library whose names are offered; None accepts any name
    metrics : allowed metrics; default: `metrics.METRICS`
    """
    metrics = METRICS if metrics is None else metrics
    definitions: Schema = {}
    schema = section_schema(root, materials)
    tables: dict[str, Callable[[], Schema]] = {
        "set": lambda: _set(materials, definitions),
        "variables": lambda: _variables(definitions),
        "measured": lambda: _measured(definitions),
        "uncertainty": lambda: _uncertainty(definitions),
        "choices": _choices,
        "requirements": lambda: _requirements(metrics, definitions),
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


def _of_parts(section: type[Section] = Design, prefix: str = "") -> dict[str, Entry]:
    """PATHs of all values of a part; ``[*]`` is the index of a list."""
    found: dict[str, Entry] = {}
    for name, entry in entries(section).items():
        path = f"{prefix}.{name}" if prefix else name
        if entry.section is not None and entry.shape in ("section", "list"):
            found |= _of_parts(entry.section, path if entry.shape == "section" else f"{path}[*]")
        elif entry.shape in ("value", "choice") and prefix and not prefix.startswith("objective"):
            found[path] = entry
    return found


def _by_path(schemas: Mapping[str, Schema]) -> Schema:
    """Properties by PATH; indexed PATHs as patterns, the first entries of a list by name."""
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
        "description": text_of(kind.help, kind.quantity),
        "type": "object",
        "additionalProperties": False,
        "required": ["lower", "upper"],
        "properties": {key: {"$ref": f"#/definitions/{name}"} for key in ("lower", "upper")},
    }


def _variables(definitions: Schema) -> Schema:
    movable: Schema = {}
    for path, entry in _of_parts().items():
        if isinstance(entry.kind, Of) and entry.kind.quantity.dimension != "count":
            movable[path] = bounds = _bounds(entry.kind, path, definitions)
            bounds["not"] = {"required": ["sizes", "step"]}
            bounds["properties"] |= _start_and_sizes(entry.kind.quantity, path)
    help = "Variables of the optimisation: PATH with lower and upper bound."
    return {"description": help} | _by_path(movable)


def _start_and_sizes(quantity: Quantity, path: str) -> Schema:
    """Keys of a variable besides its bounds."""
    value = {"$ref": f"#/definitions/{quantity.name}"}
    suited = [s for s in SERIES.values() if s.paths.fullmatch(path.replace("[*]", "[0]"))]
    some = {"type": "array", "minItems": 1, "maxItems": MOST_SIZES, "uniqueItems": True}
    series: Schema = {"enum": [s.name for s in suited]}
    series["enumDescriptions"] = [s.label for s in suited]
    options = [series] if suited else []
    return {
        "start": value,
        "step": {
            "description": "step of the variable, which takes its multiples",
            "allOf": [value],
        },
        "sizes": {"description": Sizes.help, "anyOf": [*options, some | {"items": value}]},
    }


def _measured(definitions: Schema) -> Schema:
    known: Schema = {}
    for path, entry in _of_parts().items():
        if isinstance(entry.kind, Of):
            known[path] = bounds = _bounds(entry.kind, path, definitions)
            bounds["required"] = [*bounds["required"], "record"]
            bounds["properties"]["record"] = {
                "type": "string",
                "description": "name of the record in a report",
            }
    help = "Values from a test record: PATH with 95 % bounds and the name of the record."
    return {"description": help} | _by_path(known)


def _uncertainty(definitions: Schema) -> Schema:
    known: Schema = {}
    for path, entry in _of_parts().items():
        if isinstance(entry.kind, Of) and entry.kind.quantity.dimension != "count":
            known[path] = _distribution(path, entry.kind.quantity, definitions)
    for name, quantity in quantities.MATERIAL_PROPERTIES.items():
        known[f"materials.[*].{name}"] = _distribution(name, quantity, definitions)
    schema = _by_path({p: s for p, s in known.items() if not p.startswith("materials.")})
    for name in quantities.MATERIAL_PROPERTIES:
        pattern = rf"^materials\.[^.]+\.{name}$"
        schema["patternProperties"][pattern] = known[f"materials.[*].{name}"]
    help = "Scatter of values beyond that of libraries and practice: PATH with a distribution."
    return {"description": help} | schema


def _distribution(title: str, quantity: Quantity, definitions: Schema) -> Schema:
    """An entry of `uncertainty`; entries of the same quantity share a definition."""
    name = f"uncertainty_{quantity.name}"
    if name not in definitions:
        definitions[name] = _shared(quantity, definitions)
    return {"title": title, "allOf": [{"$ref": f"#/definitions/{name}"}]}


def _shared(quantity: Quantity, definitions: Schema) -> Schema:
    """An entry of `uncertainty` for any value of a quantity."""
    schema = section_schema(Uncertain, None)
    for key in [name for name in schema["properties"] if name not in NUMBERS]:
        definitions.setdefault(f"key_{key}", schema["properties"][key])
        schema["properties"][key] = {"$ref": f"#/definitions/key_{key}"}
    for key in NUMBERS:
        own = quantity_of_entry(key, quantity)
        assert own is not None
        if key in ("deviation", "half_width"):  # equal for all quantities of a unit
            words = key.replace("_", " ")
            kind = f"{key}_{own.dimension}_{own.unit}".translate(_REFERENCE)
            own = replace(own, name=kind, label=words, symbol=own.unit or "-", upper=1e20)
        definitions.setdefault(own.name, quantity_schema(own))
        schema["properties"][key] = {"$ref": f"#/definitions/{own.name}"}
    schema["required"] = []
    schema["anyOf"] = [{"required": [key]} for key in ("distribution", "tolerance")]
    return schema


def _set(materials: Materials | None, definitions: Schema) -> Schema:
    known: Schema = {}
    for path, entry in _of_parts().items():
        known[path] = entry_schema(entry, materials)
        if isinstance(entry.kind, Of):
            name = entry.kind.quantity.name
            definitions.setdefault(name, quantity_schema(entry.kind.quantity))
            text = text_of(entry.kind.help, entry.kind.quantity)
            known[path] = {"description": text, "allOf": [{"$ref": f"#/definitions/{name}"}]}
        known[path]["title"] = path
    schema = _by_path(known)
    schema["patternProperties"][_OF_TABLES] = {"type": ["string", "number"]}
    return {"description": "Changed values of the design, by PATH."} | schema


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
    help = "Choices of the optimiser: PATH with a list of allowed values."
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
        "description": "Checks that do not apply: METRIC with the reason, which reports print.",
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
        "description": "Properties that replace those of the library, by material name.",
        "additionalProperties": changed,
    }
    if materials is not None:
        schema["propertyNames"] = {"enum": list(materials.names())}
    return schema
