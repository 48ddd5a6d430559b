"""Lists of everything that a design file or a result can name, for `list` and `explain`.

Each kind of name yields `Entry` records from its own declarations: keys of the design file, table
of metrics with its check list, registries of joints, seal types and friction laws, material
library, glossary. Modules load only when their kind of name is needed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base.arguments import SetValues, guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError, remedy, shown
from ..base.quantities import MATERIAL_PROPERTIES, Quantity, short
from ..base.tables import Displayed
from ..base.words import fold, ranked, usual

if TYPE_CHECKING:
    from ..design.model import Design
    from ..design.structure import KeyEntry
    from ..rendering.console import Style
    from .actuator import Actuator, Plugins, Result

NEAREST = 5
"""Number of names offered for an unknown word."""
LEAST, ALMOST = 0.5, 0.75
"""Least score of an offered name, and the least share of the best name's score. Our choice."""
MATCH = 0.75
"""Least score of an entry that a word of `list` keeps."""
LONGEST = 200
"""Largest number of characters of a name."""
NO_UNIT = "none"


@dataclass(frozen=True, slots=True)
class Entry:
    """A name with its kind, its meaning in a phrase, and its value in a design, if one is given.

    Parameters
    ----------
    name, kind : the name, and what it names
    phrase : what it means
    quantity : its physical quantity; None for texts, blocks and other names without a unit
    value : its value in the design: a number in SI, or words
    aliases : further spellings of the name
    """

    name: str
    kind: str
    phrase: str
    quantity: Quantity | None = None
    value: float | str | None = None
    aliases: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """Display unit, or ``none``."""
        return (self.quantity.unit if self.quantity else "") or NO_UNIT

    def number(self, digits: int = 4) -> str:
        """The value in the display unit, without the unit; "" if there is none."""
        if not isinstance(self.value, float):
            return self.value or ""
        return short(self.quantity.to_display(self.value) if self.quantity else self.value, digits)

    @property
    def text(self) -> str:
        """The value with its display unit; "" if there is none."""
        unit = "" if self.unit == NO_UNIT or not isinstance(self.value, float) else self.unit
        return f"{self.number()} {unit}".rstrip()

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI."""
        return {
            "name": self.name,
            "kind": self.kind,
            "phrase": self.phrase,
            "unit": None if self.quantity is None else self.quantity.si_unit,
            "value": self.value,
        }


@dataclass(frozen=True, slots=True)
class Catalogue(Displayed):
    """Entries of one kind, such as all metrics; `valued` states whether a design gives values."""

    kind: str
    entries: tuple[Entry, ...]
    valued: bool = False

    @property
    def in_short(self) -> tuple[str, str]:
        """The kind, and the number of entries."""
        return self.kind, f"{len(self)} entries"

    def __len__(self) -> int:
        """Number of entries."""
        return len(self.entries)

    def __iter__(self) -> Iterator[Entry]:
        """The entries in order."""
        return iter(self.entries)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI."""
        return {"kind": self.kind, "entries": [entry.to_dict() for entry in self.entries]}

    def tsv(self) -> str:
        """Name, value in the display unit, unit and phrase, parted by tabs, a line for each."""
        rows = [("name", "now", "unit", "phrase")]
        rows += [(e.name, e.number(12), e.unit, e.phrase) for e in self.entries]
        return "".join("\t".join(" ".join(cell.split()) for cell in row) + "\n" for row in rows)

    def text(self, **style: Unpack[Style]) -> str:
        """Terminal text: a table with aligned columns."""
        from ..pages.reference import listing
        from ..rendering.terminal import blocks_text

        rows = [(entry.name, entry.number(), entry.unit, entry.phrase) for entry in self.entries]
        return blocks_text([listing(rows, valued=self.valued)], **style)


# --- entries of every kind -----------------------------------------------------------------------


def _metrics() -> Iterator[Entry]:
    from ..metrics.table import ROWS, term_of

    for name, row in ROWS.items():
        yield Entry(name, "metric", row.label, row.quantity, aliases=(term_of(name), row.label))


def _checks() -> Iterator[Entry]:
    from ..metrics.table import CHECKS

    for row, line in CHECKS:
        yield Entry(line.number, "check", line.name, row.quantity, aliases=(line.name,))


def _joints() -> Iterator[Entry]:
    from ..joints.kinds import JOINTS

    return (Entry(joint.name, "joint", joint.help) for joint in JOINTS.values())


def _seals() -> Iterator[Entry]:
    from ..seals.kinds import TYPES

    return (Entry(kind.name, "seal type", kind.help) for kind in TYPES.values())


def _laws() -> Iterator[Entry]:
    from ..friction.kinds import LAWS

    return (Entry(law.name, "friction law", law.help) for law in LAWS.values())


def _properties() -> Iterator[Entry]:
    for name, quantity in MATERIAL_PROPERTIES.items():
        yield Entry(name, "material property", quantity.label, quantity)


def _materials() -> Iterator[Entry]:
    from ..design.materials import load_library

    for name, meaning in load_library().meanings().items():
        yield Entry(name, "material", meaning)


def _terms() -> Iterator[Entry]:
    from .glossary import terms

    for term in terms().values():
        yield Entry(term.name, "term", term.definition, aliases=term.aliases)


def key_entry(path: str, key: KeyEntry) -> Entry:
    """Entry of a value of the design file."""
    from ..design.kinds import MaterialName

    phrase = (key.kind.help if key.kind is not None else "") or path.replace("_", " ")
    if isinstance(key.kind, MaterialName):
        block = path.replace("[*]", "").rpartition(".")[0].replace(".", " ")
        phrase = f"{key.name.replace('_', ' ')} of {block}: {phrase}"
    return Entry(path, "PATH", phrase.partition("; ")[0], key.quantity())


def _paths() -> Iterator[Entry]:
    from ..design.structure import templates

    return (key_entry(path, key) for path, key in templates().items())


def _blocks() -> Iterator[Entry]:
    """Blocks, lists of blocks, and tables with free names."""
    from ..design.build import TABLE_KEYS
    from ..design.structure import blocks

    for path, key in blocks().items():
        yield Entry(path, "block", TABLE_KEYS.get(path) or key.meaning)


LISTS: Mapping[str, Callable[[], Iterator[Entry]]] = {
    "paths": _paths,
    "metrics": _metrics,
    "checks": _checks,
    "materials": _materials,
    "joints": _joints,
    "seals": _seals,
    "laws": _laws,
    "properties": _properties,
    "terms": _terms,
}
"""Kinds of names that `list` lists, each with the function that yields its entries."""

SEARCHED = (
    _metrics, _joints, _seals, _laws, _checks, _properties, _terms, _materials, _paths, _blocks,
)  # fmt: skip
"""Entries in the order in which `explain` searches them: those that load fastest first."""


def all_entries() -> Iterator[Entry]:
    """Every entry that `explain` knows."""
    for entries in SEARCHED:
        yield from entries()


# --- search --------------------------------------------------------------------------------------


def checked_word(word: str) -> str:
    """The word without spaces at its ends; raises `UsageError` if it cannot be a name."""
    text = word.strip()
    advice = "write a PATH, metric, check, material, joint, seal type, friction law or term"
    if not text:
        raise UsageError(Diagnostic("the word is empty", advice))
    if len(text) > LONGEST:
        message = f'"{shown(text, 40)}": {len(text)} characters are too many for a name'
        raise UsageError(Diagnostic(message, advice))
    if not text.isprintable():
        raise UsageError(Diagnostic(f'"{shown(text)}": contains control characters', advice))
    return text


def find(word: str, metrics: Mapping[str, Quantity] | None = None) -> Entry | None:
    """The entry of a name; None if it is unknown.

    Lower and upper case, spaces and hyphens do not matter. A PATH may have any index or name in its
    brackets; its last key alone is enough if only one PATH of so few keys ends with it. A synonym
    of a name is enough too.
    """
    folded = fold(word)
    if re.search(r"[a-z_]\.|\[", folded) is None:
        if metrics is not None and word in metrics:
            return Entry(word, "metric", metrics[word].label, metrics[word])
        for entries in SEARCHED:
            for entry in entries():
                if folded in map(fold, (entry.name, *entry.aliases)):
                    return entry
    known, other = _path(word, metrics), usual(word)
    return known if known is not None or other is None else find(other, metrics)


def _path(word: str, metrics: Mapping[str, Quantity] | None) -> Entry | None:
    """Entry of a PATH with any index, of the only PATH with this last key, or of a table's PATH."""
    from ..design.kinds import ValueFault
    from ..design.paths import resolve
    from ..design.structure import blocks, templates

    generic = re.sub(r"\[[^\[\]]*\]", "[*]", fold(word))
    known = templates()
    if generic not in known and (dotted := ".".join(word.casefold().split())) in known:
        word = generic = dotted
    if generic in known:
        return replace(key_entry(generic, known[generic]), name=word.strip())
    if generic in blocks():
        return next(entry for entry in _blocks() if entry.name == generic)
    ending = [path for path in known if path.endswith(f".{generic}")]
    designed = [path for path in ending if not path.startswith("ideal.")] or ending
    least = min((path.count(".") for path in designed), default=0)
    nearest = [path for path in designed if path.count(".") == least]
    if len(nearest) == 1:
        return key_entry(nearest[0], known[nearest[0]])
    head, _, rest = word.strip().partition(".")
    if head not in ("requirements", "materials") or not rest:
        return None
    try:
        target = resolve(word, {}, metrics)
    except ValueFault:
        return None
    label = "" if target.quantity is None else target.quantity.label
    name, _, last = rest.rpartition(".")
    if head == "materials":
        return Entry(target.path, "PATH", f"{label} of {name}, in place of the library's",
                     target.quantity)  # fmt: skip
    extreme = "smallest" if last == "min" else "largest"
    return Entry(target.path, "PATH", f"{extreme} permitted {label}", target.quantity)


def unknown(word: str) -> UsageError:
    """The error for an unknown word, with the nearest names by letters and meaning."""
    known = {entry.name: f"{entry.phrase} {' '.join(entry.aliases)}" for entry in all_entries()}
    near = nearest_names(ranked(word, known, LEAST))
    advice = f"nearest: {', '.join(near)}" if near else "see: actuator-opt list metrics"
    return UsageError(Diagnostic(f'"{shown(word)}" is no name known here', advice))


# --- lists ---------------------------------------------------------------------------------------


@guarded
def catalogue(
    kind: str,
    design: Actuator | Design | Result | str | Path | None = None,
    word: str = "",
    *,
    set: SetValues = (),
    plugins: Plugins = (),
) -> Catalogue:
    """List what a design file or a result can name, with values of a design.

    Parameters
    ----------
    kind : "paths", "metrics", "checks", "materials", "joints", "seals", "laws" (of friction),
        "properties" (of materials) or "terms"
    design : design whose values are listed; None for the names alone
    word : keeps only entries whose name or meaning is near to it
    set, plugins : changed values and user metrics of the design, as for `read`

    Raises
    ------
    UsageError : unknown kind, or no entry is near to the word
    InputError : the design has faults
    """
    if kind not in LISTS:
        if find(kind) is not None:
            message = f'"{shown(kind)}" is a name, not a kind of name'
            advice = f"write: list metrics {kind}, or list paths {kind}"
            raise UsageError(Diagnostic(message, advice))
        message = f'"{shown(kind)}" cannot be listed'
        raise UsageError(Diagnostic(message, remedy(kind, LISTS)))
    entries = list(LISTS[kind]())
    if design is not None:
        actuator = actuator_of(design, set, plugins)
        entries = _with_values(kind, entries, actuator)
    if word:
        entries = _near(checked_word(word), entries, kind)
    return Catalogue(kind, tuple(entries), design is not None)


def nearest_names(found: Sequence[tuple[float, str, bool]]) -> list[str]:
    """Names of at most `NEAREST` entries that are hardly less near than the first."""
    return [name for score, name, _ in found if score >= ALMOST * found[0][0]][:NEAREST]


def _near(word: str, entries: Sequence[Entry], kind: str) -> list[Entry]:
    """Entries that contain a word or are near to it, in their order."""
    folded = fold(word)
    known = {entry.name: f"{entry.phrase} {' '.join(entry.aliases)}" for entry in entries}
    found = ranked(word, known, LEAST)
    scores = {name: score for score, name, _ in found}
    kept = [
        entry
        for entry in entries
        if folded in fold(entry.name)
        or folded in fold(known[entry.name])
        or scores.get(entry.name, 0.0) >= MATCH
    ]
    if not kept:
        near = ", ".join(nearest_names(found))
        advice = f"nearest: {near}" if near else f"see: actuator-opt list {kind}"
        raise UsageError(Diagnostic(f'no {kind} match "{shown(word)}"', advice))
    return kept


def actuator_of(
    design: Actuator | Design | Result | str | Path,
    changes: SetValues,
    plugins: Plugins,
) -> Actuator:
    """A design in any form, with changed values and user metrics."""
    from .actuator import as_actuator, read

    if isinstance(design, str | Path):
        return read(design, set=changes, plugins=plugins)
    return as_actuator(design, plugins).changed(dict(changes))


def _with_values(kind: str, entries: list[Entry], actuator: Actuator) -> list[Entry]:
    """The entries with their values in a design; a list entry of the file has its own PATH."""
    design = actuator.design
    if kind == "paths":
        return _stated(design, entries)
    if kind == "properties":
        return entries
    if kind not in ("metrics", "checks"):
        return [
            replace(entry, value=", ".join(used_at(entry, design)) or None) for entry in entries
        ]
    from .optimum import evaluate

    evaluation = evaluate(actuator)
    if kind == "metrics":
        own = [
            Entry(name, "metric", metric.quantity.label, metric.quantity)
            for name, metric in evaluation.metrics.items()
            if metric.definition is not None
        ]
        return [
            replace(e, value=evaluation.metrics[e.name].value) for e in (*entries, *own)
            if e.name in evaluation.metrics
        ]  # fmt: skip
    checks = {check.name: check for check in evaluation.checks}
    return [
        replace(e, value=check.value, phrase=f"{e.phrase}: {check.status.replace('_', ' ')}")
        if (check := checks.get(e.phrase)) is not None
        else e
        for e in entries
    ]


def _stated(design: Design, entries: Sequence[Entry]) -> list[Entry]:
    """Every value that the design states, then the PATHs of values that it leaves out."""
    from ..design.paths import spell
    from ..design.structure import leaves, number_of

    stated, templates = [], set()
    for loc, key, value in leaves(design):
        if len(loc) == 1:
            continue
        number = number_of(value)
        entry = replace(key_entry(spell(loc, design), key), quantity=key.quantity(value))
        stated.append(replace(entry, value=word_of(value) if number is None else number))
        templates.add(re.sub(r"\[\d+\]", "[*]", spell(loc)))
    return [*stated, *(entry for entry in entries if entry.name not in templates)]


def word_of(value: object) -> str:
    """A text or truth value as written in a design file."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def used_at(entry: Entry, design: Design) -> list[str]:
    """PATHs of a design whose value is this name."""
    from ..design.kinds import MaterialName
    from ..design.paths import spell
    from ..design.structure import leaves

    keys = {"joint": ("retention", "type"), "seal type": ("seals", "type"),
            "friction law": ("seals", "friction")}  # fmt: skip
    places = []
    for loc, key, value in leaves(design):
        if value != entry.name:
            continue
        if entry.kind == "material":
            fits = isinstance(key.kind, MaterialName)
        else:
            fits = (loc[0], loc[-1]) == keys.get(entry.kind)
        if fits:
            places.append(spell(loc, design))
    return places
