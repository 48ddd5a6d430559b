"""Reference pages of the names that `explain` and `list` know, from the same functions."""

from __future__ import annotations

import re
from collections.abc import Iterable

from actuator_opt.api import explaining, reference
from actuator_opt.api.explaining import Explanation
from actuator_opt.api.reference import NO_UNIT, Entry
from actuator_opt.design.build import TABLE_KEYS
from actuator_opt.design.materials import load_library
from actuator_opt.design.scenario.model import Scenario
from actuator_opt.design.structure import KeyEntry, entries as keys_of, templates

from .book import Book
from .markdown import escaped, fence, page, phrase, table
from .models import theory_of

ROLES = {
    "metric": "metric",
    "check": "check",
    "joint": "joint",
    "seal type": "seal",
    "friction law": "law",
    "material property": "property",
    "material": "material",
    "PATH": "key",
    "block": "key",
}
"""Role of each kind of entry; terms have the role of Sphinx."""
PAGES = {
    "metric": ("metrics", "Metrics", "metrics"),
    "check": ("checks", "Checks", "checks"),
    "joint": ("joints", "Joints", "joints"),
    "seal type": ("seals", "Seals", "seals"),
    "friction law": ("friction-laws", "Friction laws", "laws"),
    "material property": ("material-properties", "Material properties", "properties"),
}
"""Kinds on one page each: name of the page, title, and word of `list`."""
INTRO = {
    "metric": "A metric is a number that an evaluation computes. Each can be a requirement or an "
    "objective.",
    "check": "A check is a metric with a usual limit. `optimise` meets all checks except advice "
    "and waived ones.",
    "joint": "A joint holds cap or head on the barrel: `retention.type`.",
    "seal type": "The type of a seal: `seals.piston.type` and `seals.rod.type`.",
    "friction law": "The friction law of a seal: `seals.piston.friction` and `seals.rod.friction`.",
    "material property": "What a material of the library or of a design file states.",
}
SCENARIO = "reference/scenario-keys"
GROUPS = {
    "metal": "Metals",
    "ply": "Plies",
    "polymer": "Polymers",
    "fluid": "Fluids",
    "seal": "Seal compounds",
    "adhesive": "Adhesives",
}
"""Titles of the pages of materials, by kind."""


def _entries() -> dict[str, list[Entry]]:
    found: dict[str, list[Entry]] = {}
    for entry in reference.all_entries():
        found.setdefault(entry.kind, []).append(entry)
    return found


def _place(entry: Entry) -> str:
    """Page of an entry."""
    if entry.kind in PAGES:
        return f"reference/{PAGES[entry.kind][0]}"
    if entry.kind == "material":
        return f"reference/materials/{load_library().get(entry.name).kind}"
    return f"reference/keys/{re.split('[.[]', entry.name)[0]}"


def register(book: Book) -> None:
    """Register every entry with its page."""
    for entry in reference.all_entries():
        if entry.kind != "term":
            book.register(ROLES[entry.kind], entry.name, _place(entry), *entry.aliases)
    for name in keys_of(Scenario):
        book.register("scenario", name, SCENARIO)


def write(book: Book) -> None:
    """Write all pages of entries."""
    found = _entries()
    for kind, (name, title, word) in PAGES.items():
        entries = found[kind]
        intro = f"{INTRO[kind]} In the terminal: `actuator-opt list {word}`."
        book.pages[f"reference/{name}"] = page(
            f"# {title}", intro, _overview(entries), *(_section(entry, book) for entry in entries)
        )
    _write_keys(book, [*found["block"], *found["PATH"]])
    _write_scenario_keys(book)
    _write_materials(book)


def _overview(entries: Iterable[Entry]) -> str:
    """Table of names with unit and meaning, as `list` prints them."""
    rows = [(f"{{{ROLES[e.kind]}}}`{e.name}`", escaped(e.unit), phrase(e.phrase)) for e in entries]
    return table(("name", "unit", "meaning"), rows)


def linked(name: str, book: Book) -> str:
    """A name to look up next, as a link if it is an entry."""
    number = name.removeprefix("check ")
    if number != name:
        return f"{{check}}`{number}`"
    for kind, names in book.labels.items():
        if name in names and kind in ROLES.values():
            return f"{{{kind}}}`{name}`"
    return f"{{term}}`{name}`" if name in book.labels["term"] else f"`{name}`"


def _facts(explanation: Explanation, book: Book) -> list[tuple[str, str]]:
    """Unit, symbol, worst value, valid range, model, source and related names."""
    quantity, facts = explanation.entry.quantity, []
    if quantity is not None:
        unit = explanation.entry.unit
        facts.append(("unit", "none, a ratio" if unit == NO_UNIT else escaped(unit)))
        if quantity.symbol not in ("", "-"):
            facts.append(("symbol", escaped(quantity.symbol)))
        if quantity.worst:
            facts.append(("worst value", "smallest" if quantity.worst == "min" else "largest"))
    models = [name.partition(" (") for name in explanation.model.split(", ") if name]
    names = [name for name, _, _ in models]
    known = book.labels.get("model", {})
    links = [
        (f"{{model}}`{name}`" if name in known else phrase(name))
        + (f" {phrase(brace + where)}" if where else "")
        for name, brace, where in models
    ]
    more = {
        "valid": phrase(explanation.validity),
        "model": ", ".join(links),
        "source": phrase(explanation.source, book.labels.get("source", ())),
        "theory": theory_of(names),
        "see also": ", ".join(linked(name, book) for name in explanation.related),
    }
    return [*facts, *((head, text) for head, text in more.items() if text)]


def _section(entry: Entry, book: Book, level: str = "##") -> str:
    """A section with all that `explain` says; a missing part is noted as a fault."""
    explanation = explaining.explained(entry)
    parts: dict[str, object] = {"definition": explanation.definition.strip()}
    if entry.kind in ("metric", "check", "material property"):
        parts["unit"] = entry.quantity is not None
    if entry.kind not in ("PATH", "block"):
        parts["source"] = explanation.source.strip(" ;")
    book.require(entry.kind, entry.name, **parts)
    title = f"{entry.name} {entry.phrase}" if entry.kind == "check" else entry.name
    lines = [f"- **{head}**: {text}" for head, text in _facts(explanation, book)]
    ask = fence("text", "\n".join(explanation.ask)) if explanation.ask else ""
    return page(
        f"{book.at(ROLES[entry.kind], entry.name)}\n{level} {escaped(title)}",
        phrase(explanation.definition, book.labels.get("source", ())),
        "\n".join(lines),
        ask,
    ).rstrip()


def _write_keys(book: Book, entries: list[Entry]) -> None:
    """A page for each block at the top of a design file, and a list of all."""
    groups: dict[str, list[Entry]] = {}
    for entry in entries:
        groups.setdefault(_place(entry), []).append(entry)
    keys = templates()
    for where, group in groups.items():
        name = where.rpartition("/")[2]
        rows = []
        for entry in group:
            key = keys.get(entry.name)
            default = "block" if key is None else "required" if key.required else "optional"
            rows.append((f"{{key}}`{entry.name}`", escaped(entry.unit), default,
                         phrase(entry.phrase)))  # fmt: skip
        book.pages[where] = page(
            f"# {name}",
            table(("PATH", "unit", "", "meaning"), rows),
            *(_section(entry, book) for entry in group),
        )
    tops = [(f"[{w.rpartition('/')[2]}](/{w}.md)", phrase(g[0].phrase)) for w, g in groups.items()]
    book.pages["reference/keys/index"] = page(
        "# Design keys",
        "A PATH names one value of a design file. `[*]` is the index or the name of an entry of a "
        "list. In the terminal: `actuator-opt list paths`.",
        table(("block", "meaning"), tops),
        fence("{toctree}", ":hidden:\n\n" + "\n".join(w.rpartition("/")[2] for w in groups)),
    )


def _write_scenario_keys(book: Book) -> None:
    """Keys of a scenario file: a table for each block, before them the keys without block."""
    values, tops, parts, single = templates(Scenario), keys_of(Scenario), [], []
    head = ("PATH", "unit", "default", "range or words", "meaning")
    for name, top in tops.items():
        inside = {p: k for p, k in values.items() if re.split("[.[]", p)[0] == name}
        rows = [_scenario_row(p, k, book) for p, k in (inside or {name: top}).items()]
        if inside:
            title = f"{book.at('scenario', name)}\n## {escaped(name)}"
            parts.append(page(title, phrase(top.meaning), table(head, rows)).rstrip())
        else:
            single += rows
            parts.insert(0, book.at("scenario", name))
    book.pages[SCENARIO] = page(
        "# Scenario keys",
        "A scenario is a test of a design over time ([scenarios](/how-to/scenarios.md)).",
        *[part for part in parts if part.endswith(")=")],
        "## Keys without a block",
        table(head, single),
        *[part for part in parts if not part.endswith(")=")],
    )


def _scenario_row(path: str, key: KeyEntry, book: Book) -> tuple[str, ...]:
    """Row of a key: unit, default, range or words, meaning."""
    entry = reference.key_entry(path, key)
    meaning = key.meaning or TABLE_KEYS.get(path, "")
    book.require("scenario key", path, definition=meaning)
    default = "required" if key.required else ""
    if not key.required and key.default not in (None, (), {}):
        default = explaining.value_text(entry.quantity, key.default)
    valid = "" if entry.quantity is None else explaining.range_of(entry.quantity)
    words = ", ".join(f"`{word}`" for word in key.choices)
    return (
        f"`{path}`",
        escaped(entry.unit),
        phrase(default),
        words or phrase(valid),
        phrase(meaning),
    )


def _write_materials(book: Book) -> None:
    """A page for each kind of material: each value with unit, source, scatter and confidence."""
    library, rows = load_library(), []
    for kind, title in GROUPS.items():
        sections, listed = [], []
        for name in library.names(kind=kind):
            material = library.get(name)
            listed.append((f"{{material}}`{name}`", phrase(material.label)))
            values = []
            for prop, entry in material.completed().items():
                book.require("material", f"{name}.{prop}", source=entry.source,
                             confidence=entry.confidence)  # fmt: skip
                points = entry.points or ((None, entry.value),)
                texts = [
                    entry.quantity.text(y) + ("" if x is None else f" at {_argument(entry, x)}")
                    for x, y in points
                ]
                values.append((
                    f"{{property}}`{prop}`", "; ".join(map(escaped, texts)),
                    escaped(entry.scatter.split(";")[0]), entry.basis, entry.confidence,
                    phrase(entry.source) + (f" ({phrase(entry.note)})" if entry.note else ""),
                ))  # fmt: skip
            remarks = [material.label, material.notes, material.warning and
                       f"Warning: {material.warning}"]  # fmt: skip
            sections.append(page(
                f"{book.at('material', name)}\n## {escaped(name)}",
                *(phrase(text) for text in remarks if text),
                table(("property", "value", "scatter", "basis", "confidence", "source"), values),
            ).rstrip())  # fmt: skip
        book.pages[f"reference/materials/{kind}"] = page(
            f"# {title}", table(("name", "meaning"), listed), *sections
        )
        rows.append((f"[{title}](/reference/materials/{kind}.md)", str(len(listed))))
    book.pages["reference/materials/index"] = page(
        "# Materials",
        "Each value states its source, its scatter and how well it was checked (`confidence`). "
        "In the terminal: `actuator-opt materials show NAME`.",
        table(("kind", "materials"), rows),
        fence("{toctree}", ":hidden:\n\n" + "\n".join(GROUPS)),
    )


def _argument(entry: object, x: float) -> str:
    from actuator_opt.pages.material import _argument as words

    return words(entry, x)  # type: ignore[arg-type]
