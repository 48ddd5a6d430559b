"""Words of a design that the page offers as menus: joints, seals, materials, sizes.

A menu offers the words of its key, and for a material those of the same kind in the library. A word
may leave other keys without meaning: these are removed. It may need keys that the design lacks: for
some of them there is a usual entry; otherwise the page shows what is missing.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeAlias, TypeGuard, get_args

from ..api import Actuator, optimise, read
from ..base.arguments import Change
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, Fault, UsageError, remedy, shown
from ..base.quantities import INPUTS, Quantity
from ..design import Design, choices as keys, get, quantity_of
from ..design.build import build, copy_tree, to_tree
from ..design.data_file_reader import attach, folder_of
from ..design.kinds import MATERIAL_EXAMPLES, MaterialName, TableRow, ValueFault
from ..design.material import ROLES
from ..design.materials import Library, load_library
from ..design.paths import numbers as numbers_of, put, remove, resolve, spell, words_of
from ..design.seals import BACK_UPS, SealElement
from ..design.sizes import VariableGroup, groups
from ..design.standard_sizes import SAME, o_ring_sections
from ..design.structure import KeyEntry, Loc, child_at, leaves
from ..design.writer import exact_text
from ..evaluation.plugin import with_own
from ..joints.kinds import JOINTS
from ..optimisation.cures import back_up_entries
from .model import Numbers, Studio
from .saving import Saved
from .worker import Stop

Entries: TypeAlias = dict[str, str | None]
"""Changes of a design by PATH, as `Actuator.changed` takes them; None removes the key."""
MOST = 20
"""Largest number of keys that one word may remove or add (our choice: a joint has fewer)."""
MOST_KEPT = 16
"""Largest number of choices of words whose optimum is kept (our choice)."""
ENDS = ("cap", "head")
_ROWS = tuple(
    get_args(kind)[1]
    for kind in (
        keys.RetentionType, keys.SealType, keys.BackUp,
        keys.Mount, keys.EndStop, keys.PortThread, keys.Bearing,
    )
)  # fmt: skip
"""Kinds of the keys that describe parts; other words choose a model or state the task."""


@dataclass(frozen=True, slots=True)
class Option:
    """A word that a menu offers.

    `reason` says why it cannot be chosen, empty if it can. `size` is the number of a standard size.
    """

    word: str
    label: str
    help: str = ""
    reason: str = ""
    size: float | None = None


@dataclass(frozen=True, slots=True)
class Menu:
    """A key of the design, its present word, and the words that may replace it."""

    path: str
    label: str
    group: str
    word: str
    options: tuple[Option, ...]

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


Reason: TypeAlias = Callable[[str, str], str]
"""Function of a PATH and a word: why the design cannot take the word, empty if it can."""


def menus(actuator: Actuator, sizes: Sequence[VariableGroup] = ()) -> list[Menu]:
    """All menus of a design, in the order of its file; then those of listed `sizes`."""
    library = load_library()

    def reason(path: str, word: str) -> str:
        try:
            _fitted(actuator, path, word, library)
        except _Unfit as unfit:
            return str(unfit)
        return ""

    return [*_menus(actuator.design, library, reason), *_sized(actuator.design, sizes)]


def _menus(design: Design, library: Library, reason: Reason) -> Iterator[Menu]:
    for loc, entry, value in leaves(design):
        path = spell(loc, design)
        if path in design.variables:
            continue
        options = (
            _sections(design, loc, value)
            if loc[-1] == "section"
            else _options(path, entry, str(value), library, reason)
        )
        if len(options) > 1:
            word = next((x.word for x in options if x.size is not None and x.size == value), value)
            yield Menu(path, _label(loc, path), _group(loc, entry), str(word), options)


def _sized(design: Design, sizes: Sequence[VariableGroup]) -> Iterator[Menu]:
    """Menus of the numbers that take listed sizes."""
    for group in sizes:
        for path, values in zip(group.paths, zip(*group.rows, strict=True), strict=True):
            quantity, now = quantity_of(path, design), get(design, path)
            assert isinstance(now, float)
            options = tuple(
                Option(quantity.text(size, 6), quantity.text(size, 6), size=size)
                for size in sorted({*values, now})
            )
            yield Menu(path, words_of(path), "Sizes", quantity.text(now, 6), options)


def _options(
    path: str, entry: KeyEntry, word: str, library: Library, reason: Reason
) -> tuple[Option, ...]:
    """Words of a key that describes a part; empty for any other key."""
    if isinstance(entry.kind, MaterialName):
        kind = library.kind(word)
        labels = library.meanings((kind,) if kind else ())
        if word not in labels:
            return ()
        rows = ((name, label.removesuffix(f", {kind}")) for name, label in labels.items())
        return tuple(Option(name, label) for name, label in sorted(rows, key=lambda row: row[1]))
    if not any(entry.kind is kind for kind in _ROWS):
        return ()
    checked = not isinstance(entry.kind, TableRow)  # a row of a table needs no other keys
    return tuple(
        Option(
            name, name.replace("_", " "), _help(entry, name),
            "" if name == word or not checked else reason(path, name),
        )
        for name in entry.choices
    )  # fmt: skip


def _sections(design: Design, loc: Loc, value: float) -> tuple[Option, ...]:
    """Standard sections of an O-ring, with its own if that is none of them."""
    seal = child_at(design, loc[:-1])
    if not isinstance(seal, SealElement) or not seal.seal_type.o_ring_gland:
        return ()
    quantity, sizes = INPUTS["cross_section"], o_ring_sections("as568")
    own = next((x for x in sizes if abs(x - value) <= SAME * value), value)
    return tuple(
        Option(quantity.text(size, 4), quantity.text(size, 4), size=value if size == own else size)
        for size in sorted({*sizes, own})
    )


def _help(entry: KeyEntry, word: str) -> str:
    """Meaning of a word, as the help of its key states it."""
    found = re.search(rf"(?:^|; ){re.escape(word)}: (.*?)(?=; \w+: |$)", entry.meaning)
    return found[1] if found else ""


def _label(loc: Loc, path: str) -> str:
    """The part or the property that a word describes, in plain words."""
    place = [key for key in loc if isinstance(key, str)]
    key = place[-1]
    if place[0] == "retention":
        end = f" of the {place[1]}" if place[1] in ENDS else " of cap and head"
        what = [x for x in place[1:] if x not in (*ENDS, "type")]
        end = end if place[1] in ENDS or not what else ""
        return " ".join(["joint", *what]).replace("_", " ") + end
    if place[0] == "seals":
        seal = words_of(path).removesuffix(key.replace("_", " "))
        name = {"back_up": "back-up rings"}.get(key, key.replace("back_up", "back-up"))
        return seal + name.replace("_", " ")
    layer = next((x + 1 for x in loc if isinstance(x, int)), None)
    if "layup" in place and layer is not None:
        at_bore = loc[0] == "barrel" and layer == 1
        return f"{place[0]}, layer {layer}{' at the bore' if at_bore else ''}"
    return words_of(path).removesuffix(" material")


def _group(loc: Loc, entry: KeyEntry) -> str:
    if loc[0] in ("retention", "seals"):
        return "Joint" if loc[0] == "retention" else "Seals"
    return "Materials" if isinstance(entry.kind, MaterialName) else "Build"


# ---- what a word brings with it ----


class _Unfit(Exception):
    """A word that the design cannot take; the text says why."""


def entries_of(actuator: Actuator, path: str, word: str) -> Entries:
    """The word with all other changes that it needs, by PATH.

    Raises
    ------
    UsageError : the key has no menu, its menu does not offer the word, or the word does not fit
    """
    library = load_library()
    offered = _menus(actuator.design, library, lambda path, word: "")
    menu = next((x for x in offered if x.path == path), None)
    if menu is None:
        message = "is a word without a menu"
        raise UsageError(Diagnostic(message, "edit the file, and open it again", path=path))
    names = [option.word for option in menu.options]
    if word not in names:
        message = f'"{shown(word)}" is not offered'
        raise UsageError(Diagnostic(message, remedy(word, names), path=path))
    if word == menu.word:
        return {}
    try:
        return _fitted(actuator, path, word, library)
    except _Unfit as unfit:
        raise UsageError(Diagnostic(f"{word}: {unfit}", "choose another", path=path)) from None


def _fitted(actuator: Actuator, path: str, word: str, library: Library) -> Entries:
    """The word, without the keys that it leaves without meaning, and with usual entries."""
    design, metrics = actuator.design, with_own(actuator.plugins)
    tree = to_tree(design, stated=True)
    target = resolve(path, tree, metrics)
    put(tree, target, word)
    changes: Entries = {path: word}
    for _ in range(MOST):
        faults = _faults(tree, design, library, metrics)
        if not faults:
            return changes
        idle = next((x for x in faults if _is_idle(x, tree, target.loc)), None)
        if idle is not None:
            changes[spell(idle.loc, tree)] = None
            remove(tree, idle.loc)
            continue
        usual = _usual(design, target.loc, word, faults)
        usual = {name: value for name, value in usual.items() if name not in changes}
        if not usual:
            raise _Unfit(_why(faults, tree))
        for name, value in usual.items():
            changes[name] = value
            put(tree, resolve(name, tree, metrics), value)
    raise _Unfit(_why(faults, tree))


def _faults(
    tree: dict[str, Any], design: Design, library: Library, metrics: Mapping[str, Quantity]
) -> list[Fault | Diagnostic]:
    copy = copy_tree(tree)
    attached = list(attach(copy, folder_of(design)))
    return attached or list(build(copy, materials=library, metrics=metrics).faults)


def _is_idle(fault: Fault | Diagnostic, tree: dict[str, Any], word: Loc) -> TypeGuard[Fault]:
    """Whether a fault says that a stated key or block, other than the word, has no meaning."""
    return (
        isinstance(fault, Fault)
        and fault.at_key
        and fault.loc != word
        and isinstance(fault.loc[-1], str)
        and child_at(tree, fault.loc) is not None
    )


def _why(faults: Sequence[Fault | Diagnostic], tree: dict[str, Any]) -> str:
    """Missing keys that a word needs, or else the first fault."""
    lacks = dict.fromkeys(
        spell(x.loc, tree)
        for x in faults
        if isinstance(x, Fault) and isinstance(x.loc[-1], str) and child_at(tree, x.loc) is None
    )
    return f"needs {', '.join(lacks)}" if lacks else faults[0].message


def _usual(design: Design, loc: Loc, word: str, faults: Sequence[Fault | Diagnostic]) -> Entries:
    """Usual entries for keys that the word at a location needs, by PATH; mostly none."""
    block = loc[:-1]
    at = spell(block, design)
    lacking = {x.loc[-1] for x in faults if isinstance(x, Fault) and x.loc[:-1] == block}
    if block[0] == "retention" and loc[-1] == "type" and "material" in lacking:
        role = "adhesive" if "adhesive" in JOINTS[word].kinds else "isotropic"
        return {f"{at}.material": MATERIAL_EXAMPLES[role]}
    seal = child_at(design, block)
    if loc[-1] == "back_up" and isinstance(seal, SealElement):
        return {**(back_up_entries(seal, at, BACK_UPS[word]) or {})}
    return {}


# ---- the designs with other words ----


class ChoiceStudio:
    """A studio whose changes may also be words; each choice of words has a studio of its own.

    All functions are those of `Studio`. Like it, it is not safe for threads.

    Parameters
    ----------
    studio : the design as its file states it
    sizes : listed sizes of numbers, which are no variables of this design any more
    """

    def __init__(self, studio: Studio, sizes: Sequence[VariableGroup] = ()) -> None:
        self._file = self._shown = studio
        self._sizes = sizes
        self._studios: dict[tuple[tuple[str, str | None], ...], Studio] = {}
        self._menus: dict[Studio, list[dict[str, Any]]] = {}

    @classmethod
    def opened(
        cls,
        path: str,
        *,
        set: Sequence[Change] = (),
        plugins: Sequence[Path] = (),
        out: Path = Path("reports"),
        seed: int = 0,
    ) -> ChoiceStudio:
        """Open a design file; parameters and errors as for `Studio`.

        Variables with listed sizes stand at the sizes of the best design, and get menus.
        """
        sizes: tuple[VariableGroup, ...] = ()
        if path != "-":
            actuator = read(path, set=set, plugins=plugins)
            sizes = groups(actuator.design)[0]
        settled: list[Change] = []
        if sizes and not actuator.design.choices:
            best = optimise(actuator, seed=seed, prices=False).best_evaluation.design
            for name in (name for group in sizes for name in group.paths):
                value = get(best, name)
                assert isinstance(value, float)
                settled.append((f"variables.{name}", None))
                settled.append((name, exact_text(value, quantity_of(name, best))))
        studio = Studio(path, set=[*set, *settled], plugins=plugins, out=out, seed=seed)
        return cls(studio, sizes)

    def describe(self, changes: Numbers, stop: Stop) -> dict[str, Any]:
        """Names and numbers of the design with these words, and its menus."""
        studio, _ = self._split(changes, stop)
        if studio not in self._menus:
            self._menus[studio] = [x.to_dict() for x in menus(studio.actuator, self._sizes)]
        return studio.describe() | {"menus": self._menus[studio]}

    def first(self, changes: Numbers, stop: Stop) -> dict[str, Any]:
        """As `Studio.first`, with `searched` as for `solve`."""
        studio, numbers = self._split(changes, stop)
        answer = studio.first(numbers, stop)
        self._shown = studio
        return answer | {"searched": studio.searched}

    def solve(
        self, changes: Numbers, stop: Stop, *, explain: bool = False, search: bool = False
    ) -> dict[str, Any]:
        """The optimum with some numbers and words changed.

        Parameters
        ----------
        changes, stop, explain : as for `Studio.solve`; words are those that the menus offer
        search : whether to search the whole range first, if that has not been done
        """
        studio, numbers = self._split(changes, stop)
        if search:
            studio.search(stop)
        answer = studio.solve(numbers, stop, explain=explain)
        self._shown = studio
        return answer | {"searched": studio.searched}

    def prices(
        self, changes: Numbers, paths: Sequence[str], stop: Stop, *, draw: bool = False
    ) -> dict[str, Any]:
        """As `Studio.prices`."""
        studio, numbers = self._split(changes, stop)
        return studio.prices(numbers, paths, stop, draw=draw)

    def curve(
        self,
        changes: Numbers,
        path: str,
        values: Sequence[float],
        stop: Stop,
        *,
        search: bool = False,
        best: str = "",
    ) -> dict[str, Any]:
        """As `Studio.curve`."""
        studio, numbers = self._split(changes, stop)
        return studio.curve(numbers, path, values, stop, search=search, best=best)

    def cycle(self, changes: Numbers, name: str, stop: Stop) -> dict[str, Any]:
        """As `Studio.cycle`."""
        studio, numbers = self._split(changes, stop)
        return studio.cycle(numbers, name, stop)

    def save(self, changes: Numbers, name: str, replacing: str | None) -> Saved:
        """As `Studio.save`."""
        studio, numbers = self._split(changes, _never)
        saved = studio.save(numbers, name, replacing)
        for other in (self._file, *self._studios.values()):
            other.same_file(studio)
        return saved

    def report(self, changes: Numbers) -> list[str]:
        """As `Studio.report`."""
        studio, numbers = self._split(changes, _never)
        return studio.report(numbers)

    def command(self) -> str:
        """The command line that finds the design shown last."""
        return self._shown.command()

    def _split(self, changes: Numbers, stop: Stop) -> tuple[Studio, Numbers]:
        """The studio with the words of some changes, and the numbers among them.

        Changes of keys that these words remove have no effect.
        """
        words = {
            path: value
            for path, value in changes.items()
            if isinstance(value, str) and _is_word(self._file.actuator.design, path)
        }
        studio = self._studio(words, stop) if words else self._file
        gone = self._gone(changes, studio)
        return studio, {
            path: value for path, value in changes.items() if path not in words and path not in gone
        }

    def _gone(self, changes: Numbers, studio: Studio) -> set[str]:
        """PATHs of numbers that the file states, but not the design with other words."""
        if studio is self._file:
            return set()
        before, now = (numbers_of(x.actuator.design) for x in (self._file, studio))
        return {path for path in changes if path in before and path not in now}

    def _studio(self, words: Mapping[str, str], stop: Stop) -> Studio:
        """The studio with these words; kinds of joint and seal come first."""
        actuator, entries = self._file.actuator, Entries()
        for path, word in sorted(words.items(), key=lambda entry: not entry[0].endswith(".type")):
            if get(actuator.design, path) is None and _is_known(actuator.design, path, word):
                continue  # a key of another joint, for instance
            more = entries_of(actuator, path, word)
            actuator = actuator.changed(more) if more else actuator
            entries |= more
        if not entries:
            return self._file
        key = tuple(sorted(entries.items()))
        if key not in self._studios:
            made = self._file.variant(entries, stop)
            made.same_file(self._file)
            self._studios[key] = made
            if len(self._studios) > MOST_KEPT:
                self._menus.pop(self._studios.pop(next(iter(self._studios))), None)
        return self._studios[key]


def _is_word(design: Design, path: str) -> bool:
    """Whether a PATH names a word of a design, stated or not; an unknown PATH does not."""
    try:
        target = resolve(path, design, near=False)
    except ValueFault:
        return False
    return target.quantity is None


def _is_known(design: Design, path: str, word: str) -> bool:
    """Whether a key, stated or not, describes a part and takes a word."""
    entry = resolve(path, design).entry
    if entry is None:
        return False
    if isinstance(entry.kind, MaterialName):
        library = load_library()
        return word in library and library.kind(word) in ROLES[entry.kind.role]
    return any(entry.kind is kind for kind in _ROWS) and word in entry.choices


def _never() -> bool:
    return False
