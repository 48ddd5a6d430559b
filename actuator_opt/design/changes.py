"""Values of a file that the command line, a script or another file sets or removes, by PATH."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from typing import Any, Final, NamedTuple

from ..base import errors, units
from ..base.arguments import Change, SetValues
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, Fault
from ..base.quantities import Quantity
from .build import copy_tree
from .kinds import Section, ValueFault
from .paths import LEAVE_OUT, put, remove, resolve, spell, stated
from .structure import Loc, child_at
from .yaml_source import Document

SET: Final = "--set"
UNSET: Final = "--unset"
MOST: Final = 20
"""Largest number of faults examined for one choice (our choice: a joint has fewer keys)."""


class Override(NamedTuple):
    """A value that replaces a value of the file; the value None removes the key.

    If the new value comes from another file, `file` and `loc` are its location there; `file` is
    None for the command line.

    None comes from ``--unset PATH`` or the list ``unset`` of a scenario. A word, as in
    ``PATH=none``, would collide with values of that name: ``back_up: none`` states that there is no
    back-up ring, and ``none`` in `choices` removes a whole block. A removed key instead takes its
    default, or is missing.
    """

    path: str
    value: str | None
    file: Document | None = None
    loc: Loc = ()

    def diagnostic(
        self, message: str, remedy: str, path: str | None, *, at_key: bool = False
    ) -> Diagnostic:
        """A fault caused by this value."""
        if self.file is None:
            origin = UNSET if self.value is None else SET
            return Diagnostic(message, remedy, origin, path=path)
        span = self.file.keys.get(self.loc) if at_key else None
        span = span or self.file.values.get(self.loc)
        return self.file.diagnostic(span, message, remedy, path)


def pairs(changes: SetValues) -> list[Change]:
    """Changes as texts; None, which removes a key, stays.

    >>> pairs({"cylinder.stroke": 0.11, "cushion": None})
    [('cylinder.stroke', '0.11'), ('cushion', None)]
    """
    given = changes.items() if isinstance(changes, Mapping) else changes
    return [(path, None if value is None else str(value)) for path, value in given]


@dataclass(frozen=True, slots=True)
class Changed:
    """The tree of a file with changed values."""

    tree: dict[str, Any]
    places: dict[Loc, Override] = field(default_factory=dict)
    """The change of each value, by location."""
    faults: list[Diagnostic] = field(default_factory=list)
    choices: list[Override] = field(default_factory=list)
    """The changes of words, such as a type or a material, and the removed keys."""


def changed(
    document: Document,
    root: type[Section],
    metrics: Mapping[str, Quantity] | None,
    changes: Sequence[Override],
) -> Changed:
    """Change the values of a document; keys are removed before any value is set.

    Parameters
    ----------
    document : parsed YAML
    root : class of the object that the file describes
    metrics : metrics that may be named; default: `metrics.METRICS`
    changes : new values, and keys to remove
    """
    result = Changed(copy_tree(document.data))
    for change in sorted(changes, key=lambda change: change.value is not None):
        path, value, file, _ = change
        try:
            if value is None:
                loc = stated(path, result.tree, metrics, root)
                remove(result.tree, loc)
                result.choices.append(change)
            else:
                target = resolve(path, result.tree, metrics, root)
                loc, earlier = target.loc, result.places.get(target.loc)
                if file is not None and earlier is not None and earlier.value is not None:
                    raise ValueFault(f"is also set as {earlier.path}", "keep one of them")
                si = value if file is not None else _bare_is_si(value, target.quantity)
                put(result.tree, target, si)
                if target.quantity is None and target.entry is not None:
                    result.choices.append(change)
            result.places[loc] = change
        except ValueFault as fault:
            message, shown = fault.message.removeprefix(f"{path}: "), errors.shown(path, 120)
            remedy = fault.remedy
            if file is not None and remedy == LEAVE_OUT:
                remedy = "remove this entry"
            result.faults.append(change.diagnostic(message, remedy, shown, at_key=True))
    return result


def _bare_is_si(value: str, quantity: Quantity | None) -> str:
    """Add the SI unit to `value` if it is a bare number."""
    if quantity is None:
        return value
    try:
        number, unit = units.split(value)
    except units.UnitError:
        return value
    if unit:
        return value
    return f"{number * 100!r} %" if quantity.name == "fraction" else f"{value} {quantity.si_unit}"


def meaningless(
    new: Changed,
    faults: Sequence[Fault],
    faults_of: Callable[[dict[str, Any]], Sequence[Fault]],
    without: Callable[[Override], dict[str, Any]],
) -> tuple[list[Diagnostic], list[Fault]]:
    """One line for every changed choice that leaves other stated keys without meaning.

    Such a key has a fault that appears only with this choice, and that its removal cures without
    another fault. This holds for every check, so none of them needs to know of `--unset`. A key
    that is itself among the changes keeps its own fault.

    Parameters
    ----------
    new : the file with all changes
    faults : faults of its tree
    faults_of : function that checks a tree
    without : function that gives the tree without one change

    Returns
    -------
    the lines, and all faults that they do not include
    """
    lines, rest, tree = [], list(faults), new.tree
    for choice in new.choices:
        usual = _marks(faults_of(without(choice)))
        keys: list[str] = []
        for fault in [x for x in rest if x.at_key and _mark(x) not in usual][:MOST]:
            stays = fault.loc in new.places or isinstance(fault.loc[-1], int)
            if stays or child_at(tree, fault.loc) is None:
                continue
            fewer = copy_tree(tree)
            remove(fewer, fault.loc)
            if _marks(faults_of(fewer)) < _marks(rest):
                keys.append(spell(fault.loc, tree))
                tree = fewer
                rest.remove(fault)
        if keys:
            lines.append(_advice(choice, keys))
    return lines, rest


def _mark(fault: Fault) -> tuple[Loc, str]:
    return fault.loc, fault.message


def _marks(faults: Iterable[Fault]) -> set[tuple[Loc, str]]:
    return {_mark(fault) for fault in faults}


def _advice(choice: Override, keys: Sequence[str]) -> Diagnostic:
    """Fault of a choice that leaves keys without meaning, with the options that remove them."""
    listed = " and ".join(filter(None, (", ".join(keys[:-1]), keys[-1])))
    verb = "has" if len(keys) == 1 else "have"
    options = " ".join(f"{UNSET} {_word(key)}" for key in keys)
    if choice.file is not None:
        options = f'{listed} to the list "unset" of the scenario'
    new = "without it" if choice.value is None else f"with {errors.shown(choice.value)}"
    message = f"{new}, {listed} {verb} no meaning"
    return choice.diagnostic(message, f"add {options}", errors.shown(choice.path, 120))


def _word(path: str) -> str:
    """A PATH as a word of a shell, in which brackets need quotes."""
    return f'"{path}"' if "[" in path else path
