"""Material libraries as plain text: a list, details of a material, or a comparison."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence

from ..base.quantities import MATERIAL_PROPERTIES
from ..base.tables import aligned
from .material import Material, Property
from .materials import Library

_KEY_PROPERTIES = {
    "metal": ("density", "youngs_modulus", "yield_strength"),
    "polymer": ("density", "youngs_modulus", "ultimate_strength"),
    "ply": ("density", "youngs_modulus_1", "strength_1_tension"),
    "fluid": ("density", "kinematic_viscosity", "bulk_modulus"),
    "seal": ("density", "hardness", "friction_coefficient"),
    "adhesive": ("density", "bond_strength", "shear_modulus"),
}
_ORDER = tuple(_KEY_PROPERTIES)
_ASCII = str.maketrans({"─": "-", "·": "*", "×": "x", "°": "deg", "µ": "u", "±": "+-", "…": "..."})


def list_lines(library: Library, *, kind: str | None = None, ascii: bool = False) -> list[str]:
    """One line per material, by kind: name, key properties, unverified share, label."""
    lines: list[str] = []
    for group in _ORDER if kind is None else (kind,):
        materials = [library.get(name) for name in library.names(kind=group)]
        if not materials:
            continue
        keys = _KEY_PROPERTIES[group]
        rows = [[group, *(key.replace("_", " ") for key in keys), "unverified", "description"]]
        for material in materials:
            values = [_text(material, key) for key in keys]
            share = f"{len(material.unverified)} of {len(material.properties)}"
            rows.append([material.name, *values, share, material.label])
        lines += [*_table(rows), ""]
    lines.append("Every value has source, scatter and confidence: actuator-opt materials show NAME")
    return _plain(lines, ascii)


def show_lines(material: Material, *, ascii: bool = False) -> list[str]:
    """All properties of a material, its sources numbered below the table."""
    lines = [f"{material.name}  ({material.kind})  {material.label}"]
    for head, text in (("", material.notes), ("WARNING: ", material.warning)):
        lines += textwrap.wrap(head + text, 98, subsequent_indent="  ") if text else []
    if material.family:
        lines.append(f"fluid family: {material.family}")
    if material.suits:
        lines.append(f"withstands fluids: {', '.join(material.suits)}")
    sources: dict[str, int] = {}
    rows = [["property", "", "value", "scatter", "basis", "confidence", "source", "note"]]
    for name, entry in material.completed().items():
        number = sources.setdefault(entry.source, len(sources) + 1)
        first, *more = _values(entry)
        rows.append(
            [name, entry.quantity.symbol, first, entry.scatter.split(";")[0], entry.basis,
             entry.confidence, f"[{number}]", entry.note]
        )  # fmt: skip
        rows += [["", "", text, "", "", "", "", ""] for text in more]
    lines += ["", *_table(rows), ""]
    for source, number in sources.items():
        lines += textwrap.wrap(f"[{number}] {source}", 98, subsequent_indent="    ")
    return _plain(lines, ascii)


def compare_lines(materials: Sequence[Material], *, ascii: bool = False) -> list[str]:
    """Properties side by side; from the second material on, with the ratio to the first."""
    completed = [material.completed() for material in materials]
    known = {name for properties in completed for name in properties}
    names = [name for name in MATERIAL_PROPERTIES if name in known]
    rows = [["property", *(material.name for material in materials)]]
    for name in names:
        first = completed[0].get(name)
        cells = []
        for index, properties in enumerate(completed):
            entry = properties.get(name)
            cells.append(_cell(entry, first if index else None))
        rows.append([name, *cells])
    for label, keys in (("stiffness per mass", _STIFFNESS), ("strength per mass", _STRENGTH)):
        values = [_specific(properties, keys) for properties in completed]
        base = values[0]
        if base and all(values):
            rows.append([label, *(f"×{(value or 0.0) / base:.3g}" for value in values)])
    lines = _table(rows)
    lines += ["", "×: ratio to the first material · * unverified · ~ derived"]
    for material in materials:
        if material.warning:
            lines.append(f"WARNING {material.name}: {material.warning}")
    return _plain(lines, ascii)


def to_dict(materials: Iterable[Material]) -> dict[str, object]:
    """JSON form of several materials, SI."""
    return {material.name: material.to_dict() for material in materials}


_STIFFNESS = ("youngs_modulus", "youngs_modulus_1")
_STRENGTH = ("strength_1_tension", "yield_strength", "ultimate_strength")


def _specific(properties: Mapping[str, Property], names: Sequence[str]) -> float | None:
    """First available of the named properties, per density."""
    for name in names:
        if name in properties and "density" in properties:
            return properties[name].value / properties["density"].value
    return None


def _text(material: Material, name: str) -> str:
    entry = material.properties.get(name)
    return entry.text if entry else "-"


def _values(entry: Property) -> list[str]:
    """Value, or each table point with its argument."""
    if not entry.points:
        return [entry.text]
    return [f"{entry.quantity.text(y)} at {_argument(entry, x)}" for x, y in entry.points]


def _argument(entry: Property, x: float) -> str:
    return f"{x - 273.15:.4g} degC" if entry.argument == "temperature" else f"{x / 1e5:.4g} bar"


def _cell(entry: Property | None, first: Property | None) -> str:
    if entry is None:
        return "-"
    mark = {"unverified": "*", "derived": "~"}.get(entry.confidence, "")
    temperature = entry.quantity.dimension == "temperature"
    if first is None or first.value <= 0 or entry.value <= 0 or temperature:
        return f"{entry.text}{mark}"
    return f"{entry.text}{mark} (×{entry.value / first.value:.3g})"


def _table(rows: Sequence[Sequence[str]]) -> list[str]:
    """Columns padded to their widest cell, with a rule below the head."""
    lines = aligned(rows).split("\n")
    rule = "─" * min(max(len(line) for line in lines), 120)
    return [lines[0], rule, *lines[1:]]


def _plain(lines: Sequence[str], ascii: bool) -> list[str]:
    if not ascii:
        return list(lines)
    return [line.translate(_ASCII).encode("ascii", "replace").decode() for line in lines]
