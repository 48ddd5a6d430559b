"""Material libraries: shipped entries, which the user's files can override; look-up by name.

A YAML file maps names to entries; every fault states file and line. The file is split at its
top-level keys and only requested entries are parsed, so a large library does not slow the start.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any, TypeAlias

from ..base import files as store, units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, remedy, shown
from ..base.quantities import INPUTS, MATERIAL_PROPERTIES, Quantity
from ..base.tables import OneLine
from ..base.words import nearest
from . import material, yaml_source
from .kinds import ValueFault, read_quantity, shape_in_words
from .material import ROLES, Material, Property, Spread, allowable_factor, compatible, ply_constants

_TOP = re.compile(r"(?m)^(?P<quote>['\"]?)(?P<name>[^\W\d][\w.+-]*)(?P=quote)[ \t]*:")
_STRAY = re.compile(r"(?m)^(?!#|---|['\"]?[^\W\d][\w.+-]*['\"]?[ \t]*:)\S.*$")
_KIND = re.compile(r"(?m)^[ ]+kind:[ ]*(\w+)[ ]*$")
_LABEL = re.compile(r"(?m)^[ ]+label:[ ]*(\S.*?)[ ]*$")
_SCATTER = re.compile(
    r"(?:not stated|(?P<cv>\d*\.?\d+)(?: to (?P<cv2>\d*\.?\d+))? % CV"
    r"|\+-(?P<half>\d*\.?\d+ \S.*?)|factor (?P<factor>\d*\.?\d+))(?:; .*)?"
)
_META = ("source", "confidence", "scatter", "basis")
_ENTRY_KEYS = (
    "kind", "label", "inherit", "notes", "warning", "family", "suits", *_META, "properties",
)  # fmt: skip
_PROPERTY_KEYS = ("value", "points", "note", *_META)
_ARGUMENTS = {"temperature": 313.15, "pressure": float("inf")}
"""Arguments of tables with their reference values. The point of a table nearest to the reference
(40 degC, or the highest pressure) gives the property's single value."""
Parent: TypeAlias = Callable[[str], Material | None]
"""Function that returns the material named by ``inherit:``; None if unknown."""


@dataclass(slots=True, eq=False)
class MaterialFile:
    """A library file, split into entries."""

    path: str
    text: str
    places: dict[str, tuple[int, int, int]] = field(default_factory=dict)
    """Start, end (character indices) and line number of each entry's text, by name."""
    faults: list[Diagnostic] = field(default_factory=list)
    """Faults of the file as a whole."""
    _sources: dict[str, str] | None = None

    def names(self) -> list[str]:
        """Names of the entries, including templates (leading underscore)."""
        return [name for name in self.places if name != "sources"]

    def kind(self, name: str) -> str | None:
        """Kind of an entry, read without parsing it."""
        start, end, _ = self.places[name]
        match = _KIND.search(self.text, start, end)
        return match[1] if match else None

    def label(self, name: str) -> str | None:
        """Label of an entry, read without parsing it."""
        start, end, _ = self.places[name]
        match = _LABEL.search(self.text, start, end)
        return match[1].strip("'\"") if match else None

    def document(self, name: str) -> yaml_source.Document:
        """Parse the text of an entry; its line numbers are those of the file."""
        start, end, line = self.places[name]
        return yaml_source.parse("\n" * (line - 1) + self.text[start:end], self.path)

    def sources(self) -> Mapping[str, str]:
        """Citations by key."""
        if self._sources is None:
            citations: dict[str, str] = {}
            if "sources" in self.places:
                table = self.document("sources").data["sources"]
                if not isinstance(table, dict):
                    raise InputError(self.fault("sources", "need a block of citations by key"))
                citations = {key: " ".join(str(text).split()) for key, text in table.items()}
            self._sources = citations
        return self._sources

    def fault(self, name: str, message: str, advice: str = "") -> Diagnostic:
        """Fault of an entry as a whole, shown at its first line."""
        _, _, line = self.places[name]
        return Diagnostic(message, advice, self.path, line, 1, name, f"{name}:")


def read_file(path: Path) -> MaterialFile:
    """Read a library file and split it into entries; cached until the file changes."""
    try:
        state = path.stat()
    except OSError:
        raise InputError(
            Diagnostic("the material library does not exist", "check the path", str(path))
        ) from None
    return _read_file(str(path), state.st_mtime_ns, state.st_size)


@functools.lru_cache(maxsize=64)
def _read_file(path: str, changed: int, size: int) -> MaterialFile:
    text = yaml_source.decode(Path(path).read_bytes(), path)
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    material_file = MaterialFile(path, text)
    heads = list(_TOP.finditer(text))
    ends = [head.start() for head in heads[1:]] + [len(text)]
    line, at = 1, 0
    for head, end in zip(heads, ends, strict=True):
        line, at = line + text.count("\n", at, head.start()), head.start()
        name = head["name"]
        if name in material_file.places:
            message = f'duplicate material "{name}", first at line {material_file.places[name][2]}'
            material_file.faults.append(
                Diagnostic(message, "keep one of them", path, line, 1, name, f"{name}:")
            )
            continue
        material_file.places[name] = (head.start(), end, line)
    for stray in _STRAY.finditer(text):
        line = text.count("\n", 0, stray.start()) + 1
        message = f'"{shown(stray[0], 30)}" belongs to no material'
        advice = "write NAME: and indent its keys below it"
        material_file.faults.append(
            Diagnostic(message, advice, path, line, 1, None, shown(stray[0], 120))
        )
    material_file.text = _STRAY.sub(lambda stray: " " * len(stray[0]), text)
    return material_file


def read_entry(file: MaterialFile, name: str, parent: Parent) -> Material:
    """An entry as a `Material`; raises `InputError` with all of its faults.

    Parameters
    ----------
    file, name : file and name of the entry
    parent : function that returns the material named by ``inherit:``
    """
    reader = _Reader(file, name)
    entry = reader.entry(parent)
    if reader.faults or entry is None:
        raise InputError(reader.faults)
    return entry


class _Reader:
    """Reads an entry and collects its faults."""

    def __init__(self, file: MaterialFile, name: str) -> None:
        self.file = file
        self.name = name
        self.document = file.document(name)
        self.faults = list(self.document.faults)

    def fault(self, loc: tuple[str | int, ...], message: str, advice: str = "") -> None:
        """Add a fault at a key or value of the entry."""
        spans = self.document.values
        span = spans.get((self.name, *loc)) or self.document.keys.get((self.name, *loc))
        path = ".".join([self.name, *(str(k) for k in loc if k not in ("properties", "value"))])
        self.faults.append(self.document.diagnostic(span, message, advice, path))

    def entry(self, parent: Parent) -> Material | None:
        """Read the entry as a material; None if it is not a block."""
        data = self.document.data.get(self.name)
        if not isinstance(data, dict):
            self.fault(
                (),
                f"need a block of keys, not {shape_in_words(data)}",
                "see: actuator-opt materials show",
            )
            return None
        self._unknown((), data, _ENTRY_KEYS)
        base = None
        if isinstance(data.get("inherit"), str):
            base = parent(data["inherit"])
            if base is None:
                self.fault(("inherit",), f'unknown material "{shown(data["inherit"])}"')
        kind = data.get("kind") or (base.kind if base else None)
        if kind not in material.KINDS:
            message = f'"{shown(kind)}" is not a kind' if kind else "the kind is missing"
            self.fault(("kind",) if kind else (), message, remedy(str(kind), material.KINDS))
        properties = dict(base.properties) if base else {}
        properties |= self._properties(data)
        properties = {name: properties[name] for name in MATERIAL_PROPERTIES if name in properties}
        entry = Material(
            self.name, str(kind), self._text(data, "label") or self.name, properties,
            self._text(data, "notes"), self._text(data, "warning"),
            self._family(data, base), self._suits(data, base),
            self.file.path, self.file.places[self.name][2],
        )  # fmt: skip
        if not self.faults and not self.name.startswith("_"):
            self._complete(entry)
        return entry

    def _properties(self, data: dict[str, Any]) -> dict[str, Property]:
        defaults = self._meta((), data, {})
        table = data.get("properties")
        if table is None:
            return {}
        if not isinstance(table, dict):
            self.fault(("properties",), f"need a block of properties, not {shape_in_words(table)}")
            return {}
        properties = {}
        for name, spec in table.items():
            quantity = MATERIAL_PROPERTIES.get(name)
            loc = ("properties", name)
            if quantity is None:
                advice = remedy(name, MATERIAL_PROPERTIES)
                self.fault(loc, f'unknown property "{shown(name)}"', advice)
                continue
            entry = self._property(loc, quantity, spec, defaults)
            if entry is not None:
                properties[name] = entry
        return properties

    def _property(
        self, loc: tuple[str, ...], quantity: Quantity, spec: Any, defaults: Mapping[str, str]
    ) -> Property | None:
        if not isinstance(spec, dict):
            spec, at = {"value": spec}, loc
        else:
            self._unknown(loc, spec, _PROPERTY_KEYS)
            at = (*loc, "value")
        meta = self._meta(loc, spec, defaults)
        for key in _META:
            if key not in meta and key not in ("scatter",):
                self.fault(
                    loc,
                    f"the {key} is missing",
                    f'write "{key}:" for this property or for the whole entry',
                )
        argument: str | None = None
        points: tuple[tuple[float, float], ...] = ()
        if "points" in spec:
            argument, points = self._points((*loc, "points"), quantity, spec["points"])
            if not points or argument is None:
                return None
            target = _ARGUMENTS[argument]
            value = min(points, key=lambda p: abs(p[0] - min(target, points[-1][0])))[1]
        elif "value" in spec:
            number = self._number(at, quantity, spec["value"])
            if number is None:
                return None
            value = number
        else:
            self.fault(loc, "the value is missing", "write value: or points:")
            return None
        scatter = meta.get("scatter", "not stated")
        return Property(
            quantity, value, meta.get("source", ""), scatter, meta.get("confidence", ""),
            meta.get("basis", ""), self._text(spec, "note", loc),
            self._spread(loc, scatter, quantity, value), argument, points,
        )  # fmt: skip

    def _points(
        self, loc: tuple[str, ...], quantity: Quantity, rows: Any
    ) -> tuple[str | None, tuple[tuple[float, float], ...]]:
        if not isinstance(rows, list) or len(rows) < 2:
            self.fault(loc, "need a list of two or more points", "- {temperature: ..., value: ...}")
            return None, ()
        argument: str | None = None
        points: list[tuple[float, float]] = []
        for index, row in enumerate(rows):
            keys = set(row) - {"value"} if isinstance(row, dict) else set()
            if len(keys) != 1 or "value" not in row or not keys <= set(_ARGUMENTS):
                advice = "write {temperature: ..., value: ...} or {pressure: ..., value: ...}"
                self.fault((*loc, index), "not a table point", advice)
                return None, ()
            (key,) = keys
            argument = argument or key
            if key != argument:
                self.fault((*loc, index), f"this table depends on {argument}, not {key}")
                return None, ()
            x = self._number((*loc, index, key), INPUTS[key], row[key])
            y = self._number((*loc, index, "value"), quantity, row["value"])
            if x is None or y is None:
                return None, ()
            if points and x <= points[-1][0]:
                self.fault((*loc, index), f"the {key} must rise from point to point", "sort them")
                return None, ()
            points.append((x, y))
        return argument, tuple(points)

    def _meta(
        self, loc: tuple[str, ...], spec: dict[str, Any], defaults: Mapping[str, str]
    ) -> dict[str, str]:
        meta = dict(defaults)
        for key in _META:
            if key in spec:
                meta[key] = self._text(spec, key, loc)
        if "source" in spec:
            meta["source"] = self.file.sources().get(meta["source"], meta["source"])
        for key, allowed in (("confidence", material.CONFIDENCES), ("basis", material.BASES)):
            if key in spec and meta[key] not in allowed:
                advice = f"use one of {', '.join(allowed)}"
                self.fault((*loc, key), f'unknown {key} "{shown(meta[key])}"', advice)
        return meta

    def _spread(
        self, loc: tuple[str, ...], text: str, quantity: Quantity, value: float
    ) -> Spread | None:
        match = _SCATTER.fullmatch(text)
        if match is None:
            advice = 'write "not stated", "3 % CV", "+-5 %" or "factor 2", then remarks after ";"'
            self.fault(loc, f'unknown scatter "{shown(text)}"', advice)
            return None
        if match["cv"]:
            return Spread("cv", float(match["cv2"] or match["cv"]) / 100)
        if match["factor"]:
            return Spread("factor", float(match["factor"]))
        if not match["half"]:
            return None
        number, unit = units.split(match["half"])
        if unit == "%":
            return Spread("tolerance", number / 100)
        try:
            half = number * units.unit(unit, quantity.dimension).scale
        except units.UnitError as error:
            self.fault(loc, f"scatter: {error.message}", error.remedy)
            return None
        return Spread("tolerance", half / abs(value)) if value else None

    def _number(self, loc: tuple[str | int, ...], quantity: Quantity, text: Any) -> float | None:
        try:
            return read_quantity(text, quantity)
        except ValueFault as error:
            self.fault(loc, error.message, error.remedy)
            return None

    def _text(self, spec: Mapping[str, Any], key: str, loc: tuple[str, ...] = ()) -> str:
        value = spec.get(key)
        if value is None:
            return ""
        if not isinstance(value, str):
            self.fault((*loc, key), f"need a text, not {shape_in_words(value)}")
            return ""
        return " ".join(value.split())

    def _family(self, data: Mapping[str, Any], base: Material | None) -> str:
        family = self._text(data, "family") or (base.family if base else "")
        if family and family not in material.FAMILIES:
            advice = remedy(family, material.FAMILIES)
            self.fault(("family",), f'unknown fluid family "{shown(family)}"', advice)
        return family

    def _suits(self, data: Mapping[str, Any], base: Material | None) -> tuple[str, ...]:
        rows = data.get("suits")
        if rows is None:
            return base.suits if base else ()
        if not isinstance(rows, list) or not set(rows) <= set(material.FAMILIES):
            self.fault(("suits",), f"need a list of {', '.join(material.FAMILIES)}")
            return ()
        return tuple(rows)

    def _unknown(
        self, loc: tuple[str, ...], spec: Mapping[str, Any], allowed: tuple[str, ...]
    ) -> None:
        for key in spec:
            if key not in allowed:
                self.fault((*loc, key), f'unknown key "{shown(key)}"', remedy(key, allowed))

    def _complete(self, entry: Material) -> None:
        """Faults of the entry as a whole: missing or impossible properties."""
        required = material.REQUIRED[entry.kind]
        if entry.kind == "ply" and not entry.isotropic:
            required += material.PLY_REQUIRED
        missing = [name for name in required if name not in entry.properties]
        if missing:
            self.fault((), f"a {entry.kind} needs {', '.join(missing)}", "add it to properties:")
            return
        if entry.kind == "fluid" and not entry.viscosity_points:
            loc = ("properties", "kinematic_viscosity")
            advice = "write points: [{temperature: 40 degC, value: ...}, ...]"
            self.fault(loc, "a fluid needs its viscosity at two or more temperatures", advice)
            return
        vapour = entry.properties.get("vapour_pressure")
        if vapour is not None and vapour.points and min(vapour.values) <= 0:
            loc = ("properties", "vapour_pressure")
            self.fault(
                loc,
                "a table of vapour pressures needs values above zero",
                "remove the point with value 0",
            )
            return
        constants = material.ply_constants(entry.numbers)
        if constants and material.compliance_determinant(constants) <= 0:
            message = (
                "the elastic constants are impossible: the compliance is not positive definite"
            )
            self.fault(("properties",), message, "check the Poisson's ratios against the moduli")


__all__ = [
    "ROLES",
    "Library",
    "Material",
    "Property",
    "Spread",
    "allowable_factor",
    "compatible",
    "load_library",
    "ply_constants",
]


class Library(OneLine):
    """Materials by name; later files override earlier files. Entries are read on demand."""

    def __init__(self, files: Iterable[MaterialFile]) -> None:
        self._files = tuple(files)
        self._home = {
            name: index for index, file in enumerate(self._files) for name in file.names()
        }
        self._cache: dict[tuple[int, str], Material] = {}
        self._open: list[tuple[int, str]] = []
        self._check_clashes()

    @property
    def in_short(self) -> tuple[str, str]:
        """The number of materials."""
        return "", f"{len(self.names())} materials"

    def _check_clashes(self) -> None:
        """Refuse a duplicate name in files of the same folder; other folders may override."""
        first: dict[tuple[Path, str], MaterialFile] = {}
        for file in self._files:
            for name in file.names():
                key = (Path(file.path).parent, name)
                if key in first and first[key] is not file:
                    message = f'duplicate material "{name}", also in {first[key].path}'
                    raise InputError(file.fault(name, message, "keep one of them"))
                first[key] = file

    def names(self, *, kind: str | None = None, role: str | None = None) -> list[str]:
        """Names in alphabetical order, of one kind or of all kinds that suit a role."""
        kinds = ROLES[role] if role else (kind,) if kind else None
        return sorted(
            name
            for name in self._home
            if not name.startswith("_") and (kinds is None or self.kind(name) in kinds)
        )

    def kind(self, name: str) -> str | None:
        """Kind of an entry; None if the name is unknown."""
        if name not in self:
            return None
        return self._files[self._home[name]].kind(name) or self.get(name).kind

    def meanings(self, kinds: Collection[str] = ()) -> Mapping[str, str]:
        """Label and kind in words of every entry of these kinds, or of all, by name.

        They are read without parsing the entries.
        """
        found = {}
        for name in self.names():
            kind = self.kind(name)
            if kind is not None and (not kinds or kind in kinds):
                label = self._files[self._home[name]].label(name) or name
                found[name] = f"{label}, {kind}"
        return found

    def __contains__(self, name: object) -> bool:
        return name in self._home and not str(name).startswith("_")

    def __iter__(self) -> Iterator[Material]:
        return (self.get(name) for name in self.names())

    def __len__(self) -> int:
        return len(self.names())

    def get(self, name: str, *, role: str | None = None) -> Material:
        """Material with this name.

        Parameters
        ----------
        name : name of the entry
        role : ``structural``, ``fluid``, ``seal`` or ``fastening``: intended use

        Raises
        ------
        InputError : unknown name (with similar names), unsuitable kind, or a faulty entry (with
            file and line of every fault)
        """
        if name not in self:
            raise InputError(self._unknown(name, role))
        entry = self._read(name, self._home[name])
        if role is not None and entry.kind not in ROLES[role]:
            choices = ", ".join(self.names(role=role)[:8])
            message = f'"{name}" is a {entry.kind}, not a {role} material'
            raise InputError(Diagnostic(message, f"use e.g. {choices}"))
        return entry

    def numbers(self, name: str) -> dict[str, float]:
        """Stated properties of a material, SI; a table is represented by its reference value."""
        return dict(self.get(name).numbers)

    def check(self) -> list[Diagnostic]:
        """All faults of all files."""
        faults: list[Diagnostic] = []
        for index, file in enumerate(self._files):
            faults += file.faults
            for name in file.names():
                try:
                    self._read(name, index)
                except InputError as error:
                    faults += error.diagnostics
        return list(dict.fromkeys(faults))

    def _read(self, name: str, index: int) -> Material:
        key = (index, name)
        if key in self._cache:
            return self._cache[key]
        file = self._files[index]
        if key in self._open:
            raise InputError(
                file.fault(name, "inherits from itself", "remove one of these inherit: keys")
            )
        self._open.append(key)
        try:
            entry = read_entry(file, name, functools.partial(self._parent, index))
        finally:
            self._open.remove(key)
        self._cache[key] = entry
        return entry

    def _parent(self, index: int, name: str) -> Material | None:
        """Find the material that `inherit: name` refers to in file `index`.

        The same file is searched first (except for the entry being read), then the files that this
        file overrides, and last the other files of its folder.
        """
        folder = Path(self._files[index].path).parent
        order = [index, *range(index - 1, -1, -1)]
        order += [i for i in range(index + 1, len(self._files))
                  if Path(self._files[i].path).parent == folder]  # fmt: skip
        homes = [i for i in order if name in self._files[i].places]
        others = [i for i in homes if (i, name) not in self._open]
        return self._read(name, (others or homes)[0]) if homes else None

    def _unknown(self, name: str, role: str | None) -> Diagnostic:
        near = nearest(name, self.meanings(() if role is None else ROLES[role]))
        listed = ", ".join(f'"{other}"' for other in near)
        remedy = f"best matches are {listed}" if near else "see: actuator-opt materials list"
        return Diagnostic(f'unknown material "{shown(name)}"', remedy)


def load_library(extra: Iterable[str | Path] = ()) -> Library:
    """Load the shipped library, overridden by the user's files.

    Parameters
    ----------
    extra : library files; their entries replace shipped entries of the same name and may inherit
        from them. All their faults are raised together.

    Raises
    ------
    InputError : a file is missing or faulty
    """
    folder = store.data_folder("materials")
    shipped = sorted(p for p in folder.glob("*.yaml") if not p.name.startswith("standards"))
    user_files = tuple(read_file(Path(path)) for path in extra)
    library = _library((*(read_file(path) for path in shipped), *user_files))
    if user_files:
        user_paths = {file.path for file in user_files}
        faults = [fault for fault in library.check() if fault.file in user_paths]
        if faults:
            raise InputError(faults)
    return library


@functools.lru_cache(maxsize=16)
def _library(files: tuple[MaterialFile, ...]) -> Library:
    return Library(files)
