"""Structure of input files: keys of each block, look-up of values by location, and faults there.

Reader, PATHs, writer and JSON Schema find the keys of each block and the kind of each value here,
so none of them has its own list of keys.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import cache
from types import UnionType
from typing import Any, Literal, Protocol, TypeAlias, Union, get_args, get_origin, runtime_checkable

from ..base.dataclass import dataclass
from ..base.errors import Fault
from ..base.quantities import Quantity
from .kinds import Choice, Fraction, Of, PositionKind, Section, ValueKind, example
from .model import Design

Loc: TypeAlias = tuple[str | int, ...]
"""Location of a value: keys and indices from the root of the tree."""

Shape: TypeAlias = Literal["value", "choice", "section", "list", "table"]


@dataclass(frozen=True, slots=True)
class KeyEntry:
    """A key of a block.

    `kind` is set for a value, a list of values or a choice; `choices` only for a choice. `section`
    is the class of a block, of the entries of a list, or of the entries of a table with free names.
    A table without `section` contains texts, numbers or tables (waivers, objective, materials).
    """

    name: str
    shape: Shape
    required: bool
    default: Any
    kind: ValueKind | None = None
    choices: tuple[str, ...] = ()
    section: type[Section] | None = None
    least: int = 0
    most: int | None = None
    """`least` and `most` are the smallest and largest number of entries of a list."""

    @property
    def meaning(self) -> str:
        """Meaning of the key: help of its value, or first sentence about its block."""
        if self.kind is not None:
            return self.kind.help
        return "" if self.section is None else purpose(self.section)

    def quantity(self, value: object = None) -> Quantity | None:
        """Quantity of the key's number; for a position, it depends on the type of `value`."""
        if isinstance(self.kind, PositionKind):
            return self.kind.quantity_of(value)
        return self.kind.quantity if isinstance(self.kind, Of) else None


def purpose(section: type[Section]) -> str:
    """First paragraph about a block, in one line."""
    return " ".join((section.__doc__ or "").split("\n\n")[0].split())


@cache
def entries(section: type[Section]) -> Mapping[str, KeyEntry]:
    """All keys of a block, in file order."""
    return {name: _entry(name, info) for name, info in section.model_fields.items()}


def _entry(name: str, info: Any) -> KeyEntry:
    required = info.is_required()
    default = None if required else info.default
    kind = _kind(info.metadata)
    if kind is not None and not isinstance(kind, Choice):
        return KeyEntry(name, "value", required, default, kind)
    least = next((m.min_length for m in info.metadata if hasattr(m, "min_length")), 0)
    most = next((m.max_length for m in info.metadata if hasattr(m, "max_length")), None)
    if kind is not None and kind.words:
        return KeyEntry(name, "choice", required, default, kind, choices=kind.words)
    options = [a for a in _options(info.annotation) if a is not type(None)]
    annotation = options[0]
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return KeyEntry(name, "choice", required, default, kind, choices=arguments)
    if origin is tuple:
        kind = _kind(getattr(arguments[0], "__metadata__", ()))
        section = None if kind else arguments[0]
        return KeyEntry(name, "list", required, default, kind, (), section, least, most)
    if origin is dict:
        inner = arguments[1]
        section = inner if isinstance(inner, type) and issubclass(inner, Section) else None
        return KeyEntry(name, "table", required, default, section=section)
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return KeyEntry(name, "section", required, default, section=annotation)
    return KeyEntry(name, "value", required, default)


def _kind(metadata: Iterable[Any]) -> ValueKind | None:
    return next((item for item in metadata if isinstance(item, ValueKind)), None)


def _options(annotation: Any) -> tuple[Any, ...]:
    if get_origin(annotation) in (Union, UnionType):
        return get_args(annotation)
    return (annotation,)


@cache
def templates(section: type[Section] = Design, prefix: str = "") -> dict[str, KeyEntry]:
    """All values in a block by PATH; ``[*]`` replaces the index in a list."""
    parts: dict[str, KeyEntry] = {}
    for name, entry in entries(section).items():
        path = f"{prefix}.{name}" if prefix else name
        if entry.section is not None and entry.shape in ("section", "list"):
            parts |= templates(entry.section, path if entry.shape == "section" else f"{path}[*]")
        elif entry.shape in ("value", "choice") and prefix and not prefix.startswith("objective"):
            parts[path] = entry
    return parts


@cache
def blocks(section: type[Section] = Design, prefix: str = "") -> dict[str, KeyEntry]:
    """All blocks, lists and tables in a block by PATH, without an index at their end."""
    parts: dict[str, KeyEntry] = {}
    for name, entry in entries(section).items():
        path = f"{prefix}.{name}" if prefix else name
        if entry.shape in ("section", "list", "table"):
            parts[path] = entry
        if entry.section is not None and entry.shape in ("section", "list"):
            parts |= blocks(entry.section, path if entry.shape == "section" else f"{path}[*]")
    return parts


def meanings(section: type[Section]) -> Mapping[str, str]:
    """Meaning of every key of a block, by its name."""
    return {name: entry.meaning for name, entry in entries(section).items()}


def child(node: Any, key: str | int) -> Any:
    """Child of a node under a key; None if missing. Nodes are blocks, dicts, lists or None."""
    if isinstance(node, Mapping):
        return node.get(key)
    if isinstance(node, (list, tuple)):
        return node[key] if isinstance(key, int) and -len(node) <= key < len(node) else None
    return getattr(node, str(key), None) if isinstance(node, Section) else None


def child_at(tree: Any, loc: Loc) -> Any:
    """Value at a location of a tree; None if missing."""
    for key in loc:
        tree = child(tree, key)
    return tree


@cache
def lists_of(section_type: type[Section], section: type[Section] = Design) -> tuple[Loc, ...]:
    """Locations of all lists whose entries are of class `section_type`, inside `section`.

    >>> from .model import Ply
    >>> lists_of(Ply)
    (('barrel', 'layup'), ('rod', 'layup'))
    """
    locs: list[Loc] = []
    for name, entry in entries(section).items():
        if entry.shape == "list" and entry.section is section_type:
            locs.append((name,))
        elif entry.shape == "section" and entry.section is not None:
            locs += [(name, *loc) for loc in lists_of(section_type, entry.section)]
    return tuple(locs)


def leaves(
    node: Any, section: type[Section] = Design, loc: Loc = ()
) -> Iterator[tuple[Loc, KeyEntry, Any]]:
    """Yield all stated values and choices below a node: (loc, entry, value).

    Tables with free names (variables, requirements, …) are skipped. In a faulty tree, parts that
    are not a list or block as expected are skipped too.
    """
    for name, entry in entries(section).items():
        below = child(node, name)
        if below is None:
            continue
        if entry.shape in ("value", "choice"):
            yield (*loc, name), entry, below
        elif entry.shape == "section" and entry.section is not None:
            yield from leaves(below, entry.section, (*loc, name))
        elif entry.shape == "list":
            items = below if isinstance(below, (list, tuple)) else ()
            for index, item in enumerate(items):
                if entry.section is not None:
                    yield from leaves(item, entry.section, (*loc, name, index))
                elif item is not None:
                    yield (*loc, name, index), entry, item


def number_of(value: object) -> float | None:
    """SI number of a single value; None for texts."""
    if isinstance(value, Fraction):
        return value.value
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    return None


def value_at(tree: Any, loc: Loc, section: type[Section] = Design) -> Any:
    """Value at a location of a block or its tree; if not stated, the default of its key."""
    node, default = tree, None
    known = True
    for key in loc:
        node = child(node, key)
        if isinstance(key, int):
            default = None
            continue
        entry = entries(section).get(key) if known else None
        if entry is None:  # such as a PATH under `variables`
            known, default = False, None
            continue
        default = entry.default
        section = entry.section or section
    return default if node is None else node


def section_at(root: type[Section], loc: Loc) -> tuple[type[Section] | None, KeyEntry | None]:
    """Class of the block and entry of the key at a location; None inside tables with free keys."""
    section: type[Section] | None = root
    entry: KeyEntry | None = None
    for key in loc:
        if isinstance(key, int):
            continue
        if section is None:
            return None, None
        entry = entries(section).get(key)
        section = entry.section if entry is not None and entry.shape != "table" else None
    return section, entry


NONE = "none"
"""Word that removes an optional block, as the value of a key that the block requires."""


def is_removed_by_none(loc: Loc) -> bool:
    """Whether the value `none` at a location removes its block: an optional block with this key.

    >>> is_removed_by_none(("retention", "sleeve", "material"))
    True
    >>> is_removed_by_none(("caps", "material")), is_removed_by_none(("head", "bearing"))
    (False, False)
    """
    block, key = (section_at(Design, at)[1] for at in (loc[:-1], loc))
    if key is None or not key.required or block is None:
        return False
    return block.shape == "section" and not block.required and block.default is None


def how_to_add(name: str, entry: KeyEntry | None) -> str:
    """Line of YAML that adds a missing key."""
    if entry is None:
        return f'add "{name}: …"'
    if isinstance(entry.kind, Of):
        return f'add e.g. "{name}: {example(entry.kind.quantity)}"'
    if entry.choices:
        return f'add "{name}: {entry.choices[0]}" (or {", ".join(entry.choices[1:])})'
    if entry.section is not None:
        required = [key for key, below in entries(entry.section).items() if below.required]
        dash = "- " if entry.shape == "list" else ""
        return f'add a block "{name}:" with {dash}{", ".join(required)}'
    sample = entry.kind.example if entry.kind is not None else "…"
    return f'add e.g. "{name}: {sample}"'


class MaterialLookup(Protocol):
    """Interface of the material library for input checks (`materials.Library` implements it)."""

    def __contains__(self, name: object) -> bool: ...

    def names(self) -> Sequence[str]:
        """All names."""
        ...

    def kind(self, name: str) -> str | None:
        """Kind of an entry: metal, ply, polymer, fluid, seal, adhesive."""
        ...

    def meanings(self, kinds: Collection[str] = ()) -> Mapping[str, str]:
        """Label and kind in words of every entry of these kinds, or of all, by name."""
        ...


@runtime_checkable
class Properties(Protocol):
    """A material library that also gives the properties of its entries."""

    def numbers(self, name: str) -> Mapping[str, float]:
        """All stated properties, SI."""
        ...


class FileView:
    """Reads the values of a tree in SI.

    A missing value is replaced by its default, an unusable value by None.
    """

    def __init__(self, tree: Any, root: type[Section] = Design) -> None:
        self.tree = tree
        self.root = root

    def value(self, *loc: str | int) -> Any:
        """Value at a location; if not stated, its default."""
        return value_at(self.tree, loc, self.root)

    def number(self, *loc: str | int) -> float | None:
        """The SI number at a location."""
        return number_of(self.value(*loc))

    def bound(self, side: Literal["lower", "upper"], *loc: str) -> float | None:
        """The bound of a variable (SI); the number itself if it is not a variable."""
        bound = number_of(child_at(self.tree, ("variables", ".".join(loc), side)))
        return self.number(*loc) if bound is None else bound

    def text(self, *loc: str | int) -> str | None:
        """The text at a location."""
        value = self.value(*loc)
        return value if isinstance(value, str) else None

    def flag(self, *loc: str | int) -> bool | None:
        """The boolean at a location."""
        value = self.value(*loc)
        return value if isinstance(value, bool) else None

    def items(self, *loc: str | int) -> Sequence[Any]:
        """The entries of a list."""
        value = self.value(*loc)
        return value if isinstance(value, (list, tuple)) else ()

    def has(self, *loc: str | int) -> bool:
        """Whether the file states a value at this location."""
        return child_at(self.tree, loc) is not None


def without_effect(
    view: FileView, loc: Loc, keys: Iterable[str], where: str, remedy: str = "remove the line"
) -> Iterator[Fault]:
    """Yield a fault for each of these keys that the file states, because it has no effect there."""
    for key in keys:
        if view.has(*loc, key):
            yield Fault((*loc, key), f"without effect {where}", remedy, at_key=True)
