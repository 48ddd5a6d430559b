"""Reference of everything that a design file or a result can name, for `explain` and `list`.

Each kind of name yields `Entry` records from its own declarations: keys of the design file, table
of metrics with its check list, registries of joints, seal types and friction laws, material
library, glossary. Modules load only when their kind of name is needed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError, shown
from ..base.quantities import INFINITY, MATERIAL_PROPERTIES, Quantity, short
from ..base.tables import Displayed
from ..base.words import fold, ranked

if TYPE_CHECKING:
    from ..design.model import Design
    from ..design.structure import KeyEntry
    from ..evaluation import Evaluation
    from ..metrics.documentation import ModelDocumentation
    from ..rendering.console import Style
    from .actuator import Actuator, Plugins

NEAREST = 5
"""Number of names offered for an unknown word."""
MOST_MOVERS = 5
"""Largest number of influences listed."""
MATCH = 0.75
"""Least score of an entry that a word of `list` keeps."""
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
class Explanation(Displayed):
    """What a name means, how to ask for it, and where its number comes from.

    Parameters
    ----------
    entry : the name
    definition : what it is, in sentences
    ask : lines to copy into a design file or a command
    model, source, validity : model function behind it, source, and valid range
    related : names to look up next
    value : its value in the design in words; "" without a design
    influences : numbers that move a metric, or metrics that a number moves, in % per %
    """

    entry: Entry
    definition: str
    ask: tuple[str, ...] = ()
    model: str = ""
    source: str = ""
    validity: str = ""
    related: tuple[str, ...] = ()
    value: str = ""
    influences: Mapping[str, float] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI."""
        moves = [{"name": name, "percent_per_percent": x} for name, x in self.influences.items()]
        return self.entry.to_dict() | {
            "symbol": self.entry.quantity.symbol if self.entry.quantity else None,
            "definition": self.definition,
            "in_design": self.value or None,
            "ask": list(self.ask),
            "influences": moves,
            "model": self.model or None,
            "source": self.source or None,
            "validity": self.validity or None,
            "related": list(self.related),
        }

    def text(self, **style: Unpack[Style]) -> str:
        """Terminal text of at most one screen."""
        from ..pages.reference import explanation
        from ..rendering.terminal import blocks_text

        return blocks_text(explanation(self), **style)


@dataclass(frozen=True, slots=True)
class Catalogue(Displayed):
    """Entries of one kind, such as all metrics; `valued` states whether a design gives values."""

    kind: str
    entries: tuple[Entry, ...]
    valued: bool = False

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
        from ..pages.reference import catalogue
        from ..rendering.terminal import blocks_text

        return blocks_text([catalogue(self)], **style)


# --- entries of every kind -----------------------------------------------------------------------


def _metrics() -> Iterator[Entry]:
    from ..metrics.table import ROWS

    return (Entry(name, "metric", row.label, row.quantity) for name, row in ROWS.items())


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
        yield Entry(term.name, "term", term.definition)


def _key(path: str, key: KeyEntry) -> Entry:
    """Entry of a value of the design file."""
    phrase = (key.kind.help if key.kind is not None else "") or path.replace("_", " ")
    return Entry(path, "PATH", phrase.partition("; ")[0], key.quantity())


def _paths() -> Iterator[Entry]:
    from ..design.structure import templates

    return (_key(path, key) for path, key in templates().items())


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
"""What `list` can list, each with the function that yields its entries."""

_EXPLAINED = (
    _metrics, _joints, _seals, _laws, _checks, _properties, _terms, _materials, _paths, _blocks,
)  # fmt: skip
"""Entries in the order in which `explain` searches them: those that load fastest first."""


def all_entries() -> Iterator[Entry]:
    """Every entry that `explain` knows."""
    for entries in _EXPLAINED:
        yield from entries()


# --- search --------------------------------------------------------------------------------------


def _checked_word(word: str) -> str:
    """The word without spaces at its ends; raises `UsageError` if it cannot be a name."""
    text = " ".join(word.split(" ")).strip()
    remedy = "write a PATH, metric, check, material, joint, seal type, friction law or term"
    if not text:
        raise UsageError(Diagnostic("the word is empty", remedy))
    if len(text) > 200:
        message = f'"{shown(text, 40)}": {len(text)} characters are too many for a name'
        raise UsageError(Diagnostic(message, remedy))
    if not text.isprintable():
        raise UsageError(Diagnostic(f'"{shown(text)}": contains control characters', remedy))
    return text


def find(word: str, metrics: Mapping[str, Quantity] | None = None) -> Entry | None:
    """The entry of a name; None if it is unknown.

    Lower and upper case, spaces and hyphens do not matter. A PATH may have any index or name in its
    brackets; its last key alone is enough if only one PATH ends with it.
    """
    folded = fold(word)
    if re.search(r"[a-z_]\.|\[", folded) is None:
        if metrics is not None and word in metrics:
            return Entry(word, "metric", metrics[word].label, metrics[word])
        for entries in _EXPLAINED:
            for entry in entries():
                if folded in map(fold, (entry.name, *entry.aliases)):
                    return entry
    return _path(word, metrics)


def _path(word: str, metrics: Mapping[str, Quantity] | None) -> Entry | None:
    """Entry of a PATH with any index, of the only PATH with this last key, or of a table's PATH."""
    from ..design.kinds import ValueFault
    from ..design.paths import resolve
    from ..design.structure import blocks, templates

    generic = re.sub(r"\[[^\[\]]*\]", "[*]", fold(word))
    known = templates()
    if generic in known:
        return replace(_key(generic, known[generic]), name=word.strip())
    if generic in blocks():
        return next(entry for entry in _blocks() if entry.name == generic)
    ending = [path for path in known if path.endswith(f".{generic}")]
    if len(ending) == 1:
        return _key(ending[0], known[ending[0]])
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


def _unknown(word: str) -> UsageError:
    """The error for an unknown word, with the nearest names by letters and meaning."""
    known = {entry.name: f"{entry.phrase} {' '.join(entry.aliases)}" for entry in all_entries()}
    near = [name for _, name, _ in ranked(word, known, 0.3)[:NEAREST]]
    remedy = f"nearest: {', '.join(near)}" if near else "see: actuator-opt list metrics"
    return UsageError(Diagnostic(f'"{shown(word)}" is no name known here', remedy))


# --- lists ---------------------------------------------------------------------------------------


def catalogue(
    kind: str,
    design: Actuator | Design | str | Path | None = None,
    word: str = "",
    *,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
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
    from ..base.errors import remedy

    if kind not in LISTS:
        message = f'"{shown(kind)}" cannot be listed'
        raise UsageError(Diagnostic(message, remedy(kind, LISTS)))
    entries = list(LISTS[kind]())
    if design is not None:
        actuator = _actuator(design, set, plugins)
        entries = _with_values(kind, entries, actuator)
    if word:
        entries = _near(_checked_word(word), entries, kind)
    return Catalogue(kind, tuple(entries), design is not None)


def _near(word: str, entries: Sequence[Entry], kind: str) -> list[Entry]:
    """Entries that contain a word or are near to it, in their order."""
    folded = fold(word)
    known = {entry.name: f"{entry.phrase} {' '.join(entry.aliases)}" for entry in entries}
    scores = {name: score for score, name, _ in ranked(word, known, 0.3)}
    kept = [
        entry
        for entry in entries
        if folded in fold(entry.name)
        or folded in fold(known[entry.name])
        or scores.get(entry.name, 0.0) >= MATCH
    ]
    if not kept:
        near = ", ".join(sorted(scores, key=lambda name: -scores[name])[:NEAREST])
        remedy = f"nearest: {near}" if near else f"see: actuator-opt list {kind}"
        raise UsageError(Diagnostic(f'no {kind} match "{shown(word)}"', remedy))
    return kept


def _actuator(
    design: Actuator | Design | str | Path,
    changes: Mapping[str, str | float] | Sequence[tuple[str, str]],
    plugins: Plugins,
) -> Actuator:
    from ..design.model import Design
    from .actuator import Actuator, as_actuator, read

    if isinstance(design, Actuator | Design):
        return as_actuator(design, plugins).changed(dict(changes))
    return read(design, set=changes, plugins=plugins)


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
        entry = replace(_key(spell(loc, design), key), quantity=key.quantity(value))
        stated.append(replace(entry, value=_word(value) if number is None else number))
        templates.add(re.sub(r"\[\d+\]", "[*]", spell(loc)))
    return [*stated, *(entry for entry in entries if entry.name not in templates)]


def _word(value: object) -> str:
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


# --- explanations --------------------------------------------------------------------------------


def explain(
    word: str,
    design: Actuator | Design | str | Path | None = None,
    *,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
    plugins: Plugins = (),
) -> Explanation:
    """Explain a name: what it is, how to ask for it, what moves it, and where it comes from.

    Parameters
    ----------
    word : PATH, block, metric, check (its number or title), material, material property, joint,
        seal type, friction law, or term such as "margin"
    design : design whose value and influences are stated; None for the name alone
    set, plugins : changed values and user metrics of the design, as for `read`

    Raises
    ------
    UsageError : unknown word (with the nearest names), or a word that cannot be a name
    InputError : the design has faults

    >>> explain("stiffness_min").entry.unit
    'kN/mm'
    """
    text = _checked_word(word)
    if design is None:
        entry = find(text)
        if entry is None:
            raise _unknown(text)
        return _EXPLAIN[entry.kind](entry, None)
    from ..evaluation.plugin import with_own

    actuator = _actuator(design, set, plugins)
    entry = find(text, with_own(actuator.plugins))
    if entry is None:
        raise _unknown(text)
    return _EXPLAIN[entry.kind](entry, actuator)


def _documented(name: str) -> ModelDocumentation:
    from ..metrics.documentation import describe, function_of

    return describe(function_of(name))


def _top(values: Mapping[str, float]) -> dict[str, float]:
    return dict(list(values.items())[:MOST_MOVERS])


def _limit_lines(name: str, quantity: Quantity, limits: Mapping[str, float]) -> tuple[str, ...]:
    """Lines that ask for limits (SI) of a metric, in a file and on the command line."""
    texts = {side: quantity.text(value, 6) for side, value in limits.items()}
    inside = ", ".join(f"{side}: {text}" for side, text in texts.items())
    return (
        f"requirements: {{{name}: {{{inside}}}}}",
        *(f'--set "requirements.{name}.{side}={text}"' for side, text in texts.items()),
    )


def _asked(entry: Entry, value: float | None, actuator: Actuator | None) -> tuple[str, ...]:
    """How to ask for a metric: as a requirement or as the objective."""
    from ..metrics.table import ROWS

    quantity, row = entry.quantity, ROWS.get(entry.name)
    assert quantity is not None
    side = quantity.worst or "max"
    stated = None if actuator is None else actuator.design.requirements.get(entry.name)
    limits = {s: x for s in ("min", "max") if (x := getattr(stated, s, None)) is not None}
    if not limits:
        usual = None if row is None or row.check is None else row.check.limit
        one = (quantity.to_display(0.0), 1.0) if not quantity.unit else None
        unit_value = 1.0 if one is not None else _unit(quantity)
        limits = {side: next(x for x in (value, usual, unit_value) if x is not None)}
        limits = {s: x if abs(x) < INFINITY else unit_value for s, x in limits.items()}
    verb = "maximise" if side == "min" else "minimise"
    return (*_limit_lines(entry.name, quantity, limits), f"objective: {{{verb}: {entry.name}}}")


def _unit(quantity: Quantity) -> float:
    """One display unit of a quantity, SI."""
    from ..base.units import unit

    return unit(quantity.unit, quantity.dimension).to_si(1.0)


def _governed(entry: Entry, evaluation: Evaluation) -> str:
    """Value of a metric in words: where it governs, and the limits on it."""
    metric = evaluation.metrics[entry.name]
    if metric.value is None:
        return f"none: {metric.why}"
    where = ", ".join(x for x in (metric.case, metric.place) if x)
    text = replace(entry, value=metric.value).text + (f" ({where})" if where else "")
    quantity = metric.quantity
    for row in evaluation.requirements:
        if row.metric == entry.name:
            sign = ">=" if row.sense == "min" else "<="
            word = "met" if row.met else "missed"
            margin = "" if row.margin is None else f", margin {100 * row.margin:.3g} %"
            text += f"; required {sign} {quantity.text(row.limit)}: {word}{margin}"
    return text


def _moved_by(name: str, actuator: Actuator) -> dict[str, float]:
    """Numbers of the design with the largest influence on a metric."""
    from ..evaluation.influences import influences, influential_numbers

    subject = actuator.subject()
    return _top(influences(subject, [name], influential_numbers(subject))[name])


def _of_metric(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..metrics.table import CRITERION, ROWS

    row = ROWS.get(entry.name)
    value, now, movers, extreme = None, "", {}, ""
    if entry.quantity is not None and entry.quantity.worst:
        extreme = "smallest" if entry.quantity.worst == "min" else "largest"
    definition = f"{entry.phrase}; the {extreme} value of all load cases and places governs"
    model, source, validity = "your own function", "plug-in", ""
    related: list[str] = []
    if row is not None:
        model, source = "none: from the dimensions alone", "[derived] geometry"
        names = dict.fromkeys(filter(None, (row.model, *row.by_wall.values())))
        if row.least is not None:
            source = f"limit: {row.least.source}"
        if documented := [_documented(name) for name in names if name != CRITERION]:
            model = ", ".join(d.name for d in documented)
            definition = f"{entry.phrase}: {documented[0].summary}"
            source = "; ".join(dict.fromkeys(d.reference for d in documented))
            validity = documented[0].valid
        if CRITERION in names:
            model += ", failure criterion of barrel.criterion"
        if row.check is not None:
            related.append(f"check {row.check.number}")
        related += _akin(entry.name)
    if actuator is not None:
        from .optimum import evaluate

        evaluation = evaluate(actuator)
        metric = evaluation.metrics[entry.name]
        value, now = metric.value, _governed(entry, evaluation)
        model, source = metric.model or model, metric.reference or source
        validity += "" if metric.in_range else "; outside it here"
        movers = _moved_by(entry.name, actuator) if value is not None else {}
    return Explanation(
        replace(entry, value=value), definition, _asked(entry, value, actuator), model, source,
        validity, tuple(related), now, movers,
    )  # fmt: skip


def _akin(name: str) -> list[str]:
    """Metrics that begin with the same word or come from the same model."""
    from ..metrics.table import ROWS

    first, model = name.split("_")[0], ROWS[name].model
    akin = [
        other
        for other, row in ROWS.items()
        if other != name
        and (other.split("_")[0] == first or (model is not None and row.model == model))
    ]
    return akin[:4]


def _of_check(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..metrics.table import CHECKS

    row, line = next(pair for pair in CHECKS if pair[1].number == entry.name)
    metric = _of_metric(Entry(row.name, "metric", row.label, row.quantity), None)
    sign = ">=" if row.worst == "min" else "<="
    limit = (
        f"{sign} {row.quantity.text(line.limit)} ({line.source})"
        if line.limit is not None
        else "only a limit that the design file requires"
    )
    advice = "; advice: it warns, but does not hold the optimiser" if line.advice else ""
    definition = f"{line.name}: {row.name}, {limit}{advice}"
    ask = metric.ask[:1]
    if line.limit is not None:
        ask = _limit_lines(row.name, row.quantity, {row.worst: line.limit})[:1]
    now, value, movers = "", None, {}
    if actuator is not None:
        from .optimum import evaluate

        check = next(c for c in evaluate(actuator).checks if c.name == line.name)
        value, now = check.value, check.status.replace("_", " ")
        if check.value is not None and check.limit is not None:
            side = ">=" if check.sense == "min" else "<="
            where = ", ".join(x for x in (check.case, check.place) if x)
            now = f"{row.quantity.text(check.value)} {side} {row.quantity.text(check.limit)}: {now}"
            now += f" ({where})" if where else ""
        elif check.reason:
            now += f": {check.reason}"
        movers = _moved_by(row.name, actuator) if value is not None else {}
    return Explanation(
        replace(entry, value=value), definition,
        (*ask, f"waivers: {{{row.name}: reason why it does not apply}}"), metric.model,
        f"limit: {line.source}; {metric.source}" if line.source else metric.source,
        metric.validity, (row.name, "check", "waiver"), now, movers,
    )  # fmt: skip


def _of_path(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.kinds import MaterialName, Of
    from ..design.structure import templates

    generic = re.sub(r"\[[^\[\]]*\]", "[*]", entry.name)
    key = templates().get(generic)
    definition, related = entry.phrase, []
    sample, choices = "", ()
    if key is not None:
        definition = (key.kind.help if key.kind is not None else "") or entry.phrase
        choices = key.choices
        if not key.required and key.default is not None and not isinstance(key.default, tuple):
            definition += f"; default: {_shown(key.quantity(), key.default)}"
        sample = choices[0] if choices else (key.kind.example if key.kind is not None else "")
        block = generic.rpartition(".")[0]
        siblings = [path for path in templates() if path.rpartition(".")[0] == block]
        related = [block, *[path for path in siblings if path != generic][:3]]
        if isinstance(key.kind, MaterialName):
            definition += f", such as {sample}"
            related.append("actuator-opt list materials")
    else:
        sample = "" if entry.quantity is None else entry.quantity.text(_unit_or_one(entry.quantity))
        related = [entry.name.rpartition(".")[0].partition(".")[2]]
    validity = "" if entry.quantity is None else _range(entry.quantity)
    path = entry.name.replace("[*]", "[0]")
    now, value, moves = "", None, {}
    if actuator is not None:
        now, value, moves = _in_design(entry, actuator)
        path = entry.name if "[*]" not in entry.name else path
        if isinstance(value, float) and entry.quantity is not None:
            sample = entry.quantity.text(value, 6)
        elif isinstance(value, str) and not choices:
            sample = value
    ask = [f'--set "{path}={sample}"']
    if choices:
        ask.append(f"choices: {{{path}: [{', '.join(choices[:4])}]}}")
    elif key is not None and isinstance(key.kind, Of) and entry.quantity is not None:
        ask += _variable_lines(path, entry.quantity, value, sample, actuator)
    return Explanation(
        replace(entry, value=value), definition, tuple(ask), "", "", validity, tuple(related), now,
        moves,
    )  # fmt: skip


def _unit_or_one(quantity: Quantity) -> float:
    return _unit(quantity) if quantity.unit else 1.0


def _range(quantity: Quantity) -> str:
    """Valid range of a quantity in words; "" if it has none."""
    if quantity.lower == -INFINITY and quantity.upper == INFINITY:
        return ""
    if quantity.upper == INFINITY:
        return f"at least {quantity.text(quantity.lower, 7)}"
    return quantity.range_text()


def _shown(quantity: Quantity | None, value: object) -> str:
    """A default value in words."""
    from ..design.structure import number_of

    number = number_of(value)
    return _word(value) if quantity is None or number is None else quantity.text(number, 6)


def _variable_lines(
    path: str, quantity: Quantity, value: object, sample: str, actuator: Actuator | None
) -> list[str]:
    """Lines that free a number for `optimise`, and vary it in a `sweep`."""
    from ..base import units

    if quantity.dimension == "count":
        return [f'sweep --vary "{path}={sample}"']
    bounds = None if actuator is None else actuator.design.variables.get(path)
    if bounds is not None:
        low, high = bounds.lower, bounds.upper
    else:
        middle = value if isinstance(value, float) else units.parse(sample, quantity.dimension)
        spread = 0.2 * abs(middle) if quantity.dimension != "temperature" else 10.0
        low = max(middle - spread, quantity.lower)
        high = min(middle + spread, quantity.upper)
    ends = quantity.text(low, 4), quantity.text(high, 4)
    number = short(quantity.to_display(low), 4)
    return [
        f"variables: {{{path}: {{lower: {ends[0]}, upper: {ends[1]}}}}}",
        f'sweep --vary "{path}={number}..{ends[1]}:5"',
    ]


def _in_design(
    entry: Entry, actuator: Actuator
) -> tuple[str, float | str | None, dict[str, float]]:
    """Value at a PATH in words and as data, and the metrics that it moves most."""
    from ..design.paths import get, numbers, resolve, spell
    from ..design.structure import leaves, value_at

    design = actuator.design
    if "[*]" in entry.name:
        pattern = entry.name
        stated = [
            f"{spell(loc, design)} {_shown(key.quantity(value), value)}"
            for loc, key, value in leaves(design)
            if re.sub(r"\[\d+\]", "[*]", spell(loc)) == pattern
        ]
        return ", ".join(stated) or "not stated", None, {}
    path = resolve(entry.name, design).path
    value = get(design, path)
    if value is None:
        default = value_at(design, resolve(path, design).loc)
        text = "not stated" if default is None else f"not stated; {_word(default)}"
        return text, None, {}
    known = numbers(design)
    if not isinstance(value, float) and path not in known:
        return _word(value), _word(value), {}
    number = known.get(path, value)
    text = _shown(entry.quantity, number)
    bounds = design.variables.get(path)
    if bounds is not None and entry.quantity is not None:
        low, high = (entry.quantity.text(x, 6) for x in (bounds.lower, bounds.upper))
        text += f"; a variable from {low} to {high}"
    return text, float(number), _moves(path, actuator)


def _moves(path: str, actuator: Actuator) -> dict[str, float]:
    """Metrics of the objective and the requirements that a number moves, the most moved first."""
    from ..evaluation.influences import influences, influential_numbers

    subject, design = actuator.subject(), actuator.design
    if path not in influential_numbers(subject):
        return {}
    metrics = dict.fromkeys((*design.objective.metrics, *design.requirements))
    moved = influences(subject, metrics, [path])
    values = {metric: value[path] for metric, value in moved.items() if path in value}
    return _top(dict(sorted(values.items(), key=lambda pair: -abs(pair[1]))))


def _of_block(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.structure import blocks, child_at, entries

    key = blocks()[entry.name]
    names: list[str] = []
    if key.section is not None:
        required = [name for name, below in entries(key.section).items() if below.required]
        names = [*required, *(n for n in entries(key.section) if n not in required)]
    definition = entry.phrase
    if key.section is not None and key.shape != "table":
        definition += f" Keys: {', '.join(names)}."
    now = ""
    if actuator is not None:
        stated = child_at(actuator.design, tuple(entry.name.replace("[*]", ".0").split(".")))
        count = len(stated) if isinstance(stated, (tuple, Mapping)) else None
        now = "not stated" if stated is None or count == 0 else "stated"
        now = f"{count} entries" if count else now
    inner = f"{entry.name}.{names[0]}" if names and key.shape == "section" else ""
    return Explanation(
        entry, definition, (f"actuator-opt list paths {entry.name.replace('[*]', '')}",),
        related=(inner,) if inner else ("PATH",), value=now,
    )  # fmt: skip


def _of_material(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.materials import load_library

    material = load_library().get(entry.name)
    listed = [
        f"{name} {entry_.text}" + ("" if entry_.confidence == "verified" else "*")
        for name, entry_ in material.properties.items()
        if entry_.basis not in ("nominal", "limit")
    ][:8]
    definition = f"{material.label} ({material.kind}): {', '.join(listed)}"
    if any("*" in text for text in listed):
        definition += " (* not verified)"
    sources = dict.fromkeys(p.source for p in material.properties.values())
    numbers = material.numbers
    ends = [numbers.get(f"temperature_{end}") for end in ("min", "max")]
    temperature = MATERIAL_PROPERTIES["temperature_min"]
    validity = (
        f"{temperature.text(ends[0])} to {temperature.text(ends[1])}"
        if ends[0] is not None and ends[1] is not None
        else ""
    )
    places = _places_for(material.kind)
    used = [] if actuator is None else used_at(entry, actuator.design)
    now = "" if actuator is None else (f"used at {', '.join(used)}" if used else "not used")
    example = next(iter(material.properties))
    ask = (
        *(f'--set "{path}={entry.name}"' for path in (used or places)[:1]),
        f'--set "materials.{entry.name}.{example}={material.properties[example].text}"',
        f"actuator-opt materials show {entry.name}",
    )
    related = (*places[1:4], material.notes and "actuator-opt materials compare")
    return Explanation(
        entry, definition, ask, "library value", "; ".join(sources), validity,
        tuple(filter(None, related)), now,
    )  # fmt: skip


def _places_for(kind: str) -> list[str]:
    """PATHs that take a material of a kind, the most usual first."""
    from ..design.kinds import MaterialName
    from ..design.material import ROLES
    from ..design.structure import templates

    ranks = []
    for path, key in templates().items():
        if isinstance(key.kind, MaterialName):
            offered = key.kind.usual or ROLES[key.kind.role]
            if kind in offered:
                ranks.append((offered.index(kind), path.count("."), path.replace("[*]", "[0]")))
    return [path for _, _, path in sorted(ranks, key=lambda rank: rank[:2])]


def _of_property(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.materials import load_library

    assert entry.quantity is not None
    library = load_library()
    now, names = "", [m.name for m in library if entry.name in m.properties]
    if actuator is not None:
        used = actuator.subject().materials
        texts = [
            f"{name} {m.properties[entry.name].text}"
            for name, m in used.items()
            if entry.name in m.properties
        ]
        now = ", ".join(texts) or "no material of this design states it"
        names = [name for name in used if entry.name in used[name].properties] or names
    ask: tuple[str, ...] = ()
    if names:
        text = library.get(names[0]).properties[entry.name].text if names[0] in library else ""
        text = text or entry.quantity.text(_unit_or_one(entry.quantity))
        ask = (f'--set "materials.{names[0]}.{entry.name}={text}"',)
    return Explanation(
        entry, f"{entry.phrase}; a property of materials such as {', '.join(names[:3])}", ask,
        "library value", "stated with each material: actuator-opt materials show NAME",
        _range(entry.quantity), ("confidence", "scatter", "knock-down"), now,
    )  # fmt: skip


def _where(entry: Entry, actuator: Actuator | None) -> str:
    """Where a design uses a joint, seal type or law, in words; "" without a design."""
    if actuator is None:
        return ""
    used = used_at(entry, actuator.design)
    return f"used at {', '.join(used)}" if used else "not used"


def _of_joint(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.model import EndRetention
    from ..design.structure import entries
    from ..joints.kinds import JOINTS

    joint = JOINTS[entry.name]
    keys = entries(EndRetention)
    needed = ["length", *(field.key for field in joint.fields if field.missing)]
    stated = [f"type: {joint.name}"]
    for name in dict.fromkeys(key.partition(".")[0] for key in needed):
        key = keys[name]
        text = key.kind.example if key.kind is not None else ""
        if key.section is not None:
            below = entries(key.section).items()
            inner = [f"{n}: {e.kind.example}" for n, e in below if e.required and e.kind]
            text = f"{{{', '.join(inner)}}}"
        if name == "material" and "metal" in joint.kinds and "adhesive" not in joint.kinds:
            text = "steel_42crmo4"
        stated.append(f"{name}: {text}")
    documented = [_documented(name) for name in dict.fromkeys(joint.models.values())]
    others = [f.key for f in joint.fields if f.key not in needed]
    definition = f"{entry.phrase}; judged on {joint.judged[0]}, at burst on {joint.judged[1]}"
    if others:
        definition += f"; further keys: {', '.join(others)}"
    metrics = dict.fromkeys(metric for metric, _ in joint.models)
    return Explanation(
        entry, definition,
        (f"retention: {{{', '.join(stated)}}}", f'--set "retention.type={joint.name}"'),
        ", ".join(d.name for d in documented),
        "; ".join(dict.fromkeys(d.reference for d in documented)), documented[0].valid,
        (*metrics, *joint.metrics), _where(entry, actuator),
    )  # fmt: skip


def _of_seal(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..metrics.documentation import describe
    from ..models.seals import LAWS
    from ..seals.kinds import TYPES

    kind = TYPES[entry.name]
    documented = describe(LAWS["energised"].line_load if kind.model is None else kind.model)
    compound = "ptfe_bronze_nbr_70" if kind.modulus_by == "hardness" else "nbr_90"
    sizes = {f.key: f.size.example for f in kind.fields if f.default is None}
    stated = {"type": kind.name, "compound": compound, "section": "3.53 mm", "squeeze": "12 %"}
    inside = ", ".join(f"{key}: {text}" for key, text in (stated | sizes).items())
    optional = [f.key for f in kind.fields if f.default is not None]
    definition = f"{kind.title}: {entry.phrase}"
    definition += f"; optional sizes: {', '.join(optional)}" if optional else ""
    law = "contact law of `law`: " if kind.model is None else ""
    return Explanation(
        entry, definition,
        (f"seals: {{piston: {{{inside}}}}}", f'--set "seals.piston.type={kind.name}"'),
        f"{law}{documented.name}", documented.reference, documented.valid,
        ("friction_running", "seal_squeeze", "seal_gap", "seals.piston.friction"),
        _where(entry, actuator),
    )  # fmt: skip


def _of_law(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..friction.kinds import LAWS
    from ..metrics.documentation import describe

    law = LAWS[entry.name]
    documented = describe(law.model)
    definition = entry.phrase
    if law.compound:
        definition += f"; the compound must state {', '.join(law.compound)}"
    ask = tuple(f'--set "seals.{place}.friction={law.name}"' for place in ("piston", "rod"))
    return Explanation(
        entry, definition, ask, documented.name, documented.reference, documented.valid,
        ("friction_running", "friction_breakaway", "Stribeck curve"), _where(entry, actuator),
    )  # fmt: skip


def _of_term(entry: Entry, actuator: Actuator | None) -> Explanation:
    from .glossary import terms

    term = terms()[entry.name]
    return Explanation(entry, term.definition, source=term.source, related=term.related)


_EXPLAIN: Mapping[str, Callable[[Entry, Any], Explanation]] = {
    "metric": _of_metric,
    "check": _of_check,
    "PATH": _of_path,
    "block": _of_block,
    "material": _of_material,
    "material property": _of_property,
    "joint": _of_joint,
    "seal type": _of_seal,
    "friction law": _of_law,
    "term": _of_term,
}
"""For each kind of name, the function that explains it."""


def explained(entry: Entry) -> Explanation:
    """Explanation of an entry, without a design."""
    return _EXPLAIN[entry.kind](entry, None)
