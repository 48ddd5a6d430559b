"""Build a `Design`, or the object of another file, from a tree of values; or list all faults."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Generic, TypeVar

from pydantic import ValidationError

from ..base import errors
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, Fault, InputError
from ..base.quantities import Quantity
from ..metrics import METRICS
from . import choice_list, requirements
from .data_file_reader import attach, folder_of
from .faults import cross_field, material_faults
from .kinds import Fraction, Section, ValueFault, shape_in_words
from .model import Design, Ply
from .paths import put, remove, resolve, spell, stated
from .structure import (
    NONE,
    Loc,
    MaterialLookup,
    child_at,
    entries,
    how_to_add,
    is_removed_by_none,
    leaves,
    meanings,
    section_at,
    value_at,
)

MOST_FAULTS = 100

TABLE_KEYS = {
    "variables": "PATHs such as cylinder.bore, each with a lower and an upper bound",
    "requirements": "metrics, each with a smallest (min) or largest (max) value",
    "choices": "PATHs such as seals.rod.compound, each with a list of allowed values",
    "waivers": "metrics such as seal_section, each with the reason why its check is waived",
    "measured": (
        "PATHs such as seals.rod.friction_coefficient, each with the lower and upper "
        "bound from a test record"
    ),
    "materials": "names of materials, each with its changed properties",
    "uncertainty": "PATHs such as cylinder.bore, each with a distribution",
    "set": "PATHs of the design such as cylinder.bore, each with its value",
}
"""For tables whose keys are free names: text that describes their contents."""
Root = TypeVar("Root", bound=Section)


@dataclass(frozen=True, slots=True)
class Built:
    """Result of `build`: a design, or the faults that prevent one."""

    design: Design | None
    faults: tuple[Fault, ...]


@dataclass(frozen=True, slots=True)
class Checked(Generic[Root]):
    """Result of `check`: tree with its valid values in SI, object built from it, and faults."""

    tree: dict[str, Any]
    section: Root | None
    faults: tuple[Fault, ...]


def build(
    tree: Mapping[str, Any],
    *,
    materials: MaterialLookup | None = None,
    metrics: Mapping[str, Quantity] | None = None,
    contradictions: bool = True,
) -> Built:
    """The design that a tree describes, or all of its faults.

    Parameters
    ----------
    tree : dicts, lists, texts with units and SI numbers, in the shape of the design file
    materials : names and kinds of the library; None leaves material names unchecked
    metrics : allowed names of metrics in requirements and objective; default: `metrics.METRICS`
    contradictions : whether values that contradict each other are reported as faults
    """
    metrics = METRICS if metrics is None else metrics
    checked = check(tree, Design, metrics, cross_field if contradictions else None)
    faults = list(checked.faults)
    if materials is not None:
        faults += material_faults(checked.tree, materials)
        faults += choice_list.material_faults(checked.tree, materials)
    return Built(None if faults else checked.section, tuple(faults))


def check(
    tree: Mapping[str, Any],
    root: type[Root],
    metrics: Mapping[str, Quantity],
    cross: Callable[[Any], Iterable[Fault]] | None = None,
) -> Checked[Root]:
    """The object of type `root` that a tree describes, or all of its faults.

    Parameters
    ----------
    tree : dicts, lists, texts with units and SI numbers, in the shape of the file
    root : class of the whole file, such as `Design`
    metrics : allowed names of metrics in requirements
    cross : function that checks the values of a tree in SI against each other
    """
    copy: dict[str, Any] = copy_tree(tree)
    faults = list(_nothing(copy, ()))
    _to_si(copy, root)
    faults += requirements.recheck(copy, metrics, root)
    if "choices" in entries(root):
        faults += choice_list.recheck(copy)
    section = None
    try:
        section = root.model_validate(copy)
    except ValidationError as error:
        faults += _unless_known(_translate(error, root), faults)
    if cross is not None:
        faults += _unless_known(cross(copy), list(_nothing(copy, ())))
    return Checked(copy, None if faults else section, tuple(faults))


def copy_tree(node: Any) -> Any:
    """Copy a tree: dicts and lists are copied, values are shared."""
    if isinstance(node, Mapping):
        return {key: copy_tree(value) for key, value in node.items()}
    return [copy_tree(item) for item in node] if isinstance(node, (list, tuple)) else node


def _nothing(node: Any, loc: Loc) -> Iterator[Fault]:
    """Yield a fault for each key or list entry without a value."""
    pairs = node.items() if isinstance(node, dict) else enumerate(node)
    for key, value in pairs:
        if value is None:
            comma = re.match(r"\d", str(key)) is not None  # "36,2 mm" between braces
            remedy = "write a point, not a comma" if comma else "write one, or remove the line"
            yield Fault((*loc, key), "no value", remedy)
        elif isinstance(value, (dict, list)):
            yield from _nothing(value, (*loc, key))


def _to_si(tree: dict[str, Any], root: type[Section]) -> None:
    """Convert every valid value of a known key to SI; invalid values stay as written."""
    for loc, entry, value in list(leaves(tree, root)):
        if entry.kind is None or not isinstance(value, str):
            continue
        try:
            number = entry.kind.validate(value)
        except ValueFault:
            continue
        child_at(tree, loc[:-1])[loc[-1]] = number


def _unless_known(faults: Iterable[Fault], reported: Sequence[Fault]) -> list[Fault]:
    """Omit new faults at or inside locations that already have a fault; keep one per location."""
    faulty = {fault.loc for fault in reported}
    new = []
    for fault in faults:
        if not any(fault.loc[:depth] in faulty for depth in range(1, len(fault.loc) + 1)):
            new.append(fault)
            faulty.add(fault.loc)
    return new


def _translate(error: ValidationError, root: type[Section]) -> Iterator[Fault]:
    """Translate pydantic's validation errors into faults in the terms of the file."""
    for count, item in enumerate(error.errors(include_url=False)):
        loc: Loc = tuple(item["loc"])
        kind, value = item["type"], item["input"]
        if kind == "default_factory_not_called":  # only repeats another fault
            continue
        section, entry = section_at(root, loc)
        if kind == "value":
            yield Fault(loc, item["ctx"]["message"], item["ctx"]["remedy"])
        elif kind == "missing":
            yield Fault(loc, "missing", how_to_add(str(loc[-1]), entry))
        elif kind == "extra_forbidden":
            yield _unknown_key(loc, root, near=count < MOST_FAULTS)
        elif kind == "literal_error" and entry is not None:
            word = value if isinstance(value, str) else ""
            message = (
                f'"{errors.shown(word)}" is not a choice' if word else "a single word is required"
            )
            yield Fault(loc, message, errors.remedy(word, entry.choices))
        elif kind in ("too_short", "too_long"):
            few = kind == "too_short"
            if few and value:
                continue  # the entries exist and have their own faults
            limit = item["ctx"]["min_length" if few else "max_length"]
            remedy = 'add one, starting with "- "' if few else f"keep at most {limit}"
            yield Fault(loc, "the list is empty" if few else "too many entries", remedy)
        elif kind in ("model_type", "model_attributes_type", "dict_type"):
            keys = ", ".join(list(entries(section))[:6]) if section else TABLE_KEYS[str(loc[0])]
            yield Fault(
                loc, f"need a block, not {_word(value)}", f"write its keys below it: {keys}"
            )
        elif kind == "tuple_type":
            remedy = 'start each entry with "- " on a line of its own'
            yield Fault(loc, f"need a list, not {_word(value)}", remedy)
        elif kind == "string_type":
            yield Fault(loc, f"need a text, not {_word(value)}", "write one value")
        else:
            yield Fault(loc, errors.shown(item["msg"], 120))


def _word(value: object) -> str:
    return f'"{errors.shown(value)}"' if isinstance(value, str) else shape_in_words(value)


def _unknown_key(loc: Loc, root: type[Section], *, near: bool) -> Fault:
    """Fault of an unknown key; with near names, as these take time, only among the first faults."""
    if not near:
        return Fault(loc, "unknown key", "remove it", at_key=True)
    section, _ = section_at(root, loc[:-1])
    table = entries(root).get(str(loc[0]))
    if table is not None and table.shape == "table" and table.section and len(loc) == 3:
        names = dict(meanings(table.section))
    else:
        names = {} if section is None else dict(meanings(section))
        names |= {"plies": "lay-up in compact notation"} if section is Ply else {}
    return Fault(loc, "unknown key", errors.remedy(str(loc[-1]), names), at_key=True)


def to_tree(section: Section, *, stated: bool = False) -> dict[str, Any]:
    """Convert a design or a block to dicts, lists, texts and SI numbers; omit unset values.

    With `stated`, values that are not stated are omitted too, though they have a default: a check
    may allow a key only if another key is not stated.
    """

    def plain(value: Any) -> Any:
        if isinstance(value, Section):
            fields = type(value).model_fields
            names = value.model_fields_set if stated else fields.keys()
            pairs = ((name, getattr(value, name)) for name in fields if name in names)
            return {name: plain(below) for name, below in pairs if below is not None}
        if isinstance(value, Mapping):
            return {key: plain(below) for key, below in value.items()}
        return [plain(item) for item in value] if isinstance(value, tuple) else value

    tree: dict[str, Any] = plain(section)
    return tree


def with_values(
    design: Design,
    values: Mapping[str, float | str | Fraction | None],
    *,
    materials: MaterialLookup | None = None,
    metrics: Mapping[str, Quantity] | None = None,
    contradictions: bool = True,
) -> Design:
    """Copy a design with changed values by PATH (SI numbers, or texts with units); check it.

    The value None removes a key or block before any value is set, and the word `none` the optional
    block that requires the key (see `is_removed_by_none`), both with their variables. If an
    optimisation variable started at the old value, it now starts at the new value. Without
    `contradictions` values may contradict each other; this is needed where a search found no
    feasible design.

    Raises
    ------
    InputError
        if a PATH has no value, a value is unsuitable, or the new values contradict each other
    """
    tree = to_tree(design, stated=True)
    diagnostics, removed, unset = [], list[Loc](), list[Loc]()
    for path, value in sorted(values.items(), key=lambda change: change[1] is not None):
        try:
            if value is None:
                unset.append(stated(path, tree, metrics))
                continue
            while unset:  # before any value is set
                remove(tree, unset.pop())
            target = resolve(path, tree, metrics)
        except ValueFault as fault:
            message = fault.message.removeprefix(f"{path}: ")
            diagnostics.append(Diagnostic(message, fault.remedy, path=path))
            continue
        if value == NONE and is_removed_by_none(target.loc):
            removed.append(target.loc[:-1])
            continue
        number = float(value) if isinstance(value, (int, float)) else value
        old = value_at(tree, target.loc)
        put(tree, target, number)
        variable = tree.get("variables", {}).get(target.path)
        if variable is not None and variable.get("start") == old:
            variable["start"] = number
    for block in (*unset, *removed):
        remove(tree, block)
    diagnostics += [
        Diagnostic(fault.message, fault.remedy, path=spell(fault.loc, tree))
        if isinstance(fault, Fault)
        else fault
        for fault in attach(tree, folder_of(design))
    ]
    if not diagnostics:
        built = build(tree, materials=materials, metrics=metrics, contradictions=contradictions)
        diagnostics = [
            Diagnostic(fault.message, fault.remedy, path=spell(fault.loc, tree))
            for fault in built.faults
        ]
        if built.design is not None:
            return built.design
    raise InputError(diagnostics)
