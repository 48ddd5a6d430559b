"""Material libraries: shipped entries, overridden by the user's files; look-up by name."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..base import files as store
from ..base.errors import Diagnostic, InputError
from .material import ROLES, Material, Property, Spread, allowable_factor, compatible, ply_constants
from .material_files import MaterialFile, read_entry, read_file

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


class Library:
    """Materials by name; later files override earlier files. Entries are read on demand."""

    def __init__(self, files: Iterable[MaterialFile]) -> None:
        self._files = tuple(files)
        self._home = {
            name: index for index, file in enumerate(self._files) for name in file.names()
        }
        self._read_already: dict[tuple[int, str], Material] = {}
        self._open: list[tuple[int, str]] = []
        self._check_clashes()

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
        """Names in alphabetical order, of a kind or of the kinds that suit a role."""
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
        found = self._read(name, self._home[name])
        if role is not None and found.kind not in ROLES[role]:
            choices = ", ".join(self.names(role=role)[:8])
            message = f'"{name}" is a {found.kind}, not a {role} material'
            raise InputError(Diagnostic(message, f"use e.g. {choices}"))
        return found

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
        if key in self._read_already:
            return self._read_already[key]
        file = self._files[index]
        if key in self._open:
            raise InputError(
                file.fault(name, "inherits from itself", "remove one inherit: of the circle")
            )
        self._open.append(key)
        try:
            found = read_entry(file, name, functools.partial(self._parent, index))
        finally:
            self._open.remove(key)
        self._read_already[key] = found
        return found

    def _parent(self, index: int, name: str) -> Material | None:
        """The material that `inherit: name` refers to in file `index`.

        Searched in the same file first (except the entry being read), then in overridden files,
        last in the other files of its folder.
        """
        folder = Path(self._files[index].path).parent
        order = [index, *range(index - 1, -1, -1)]
        order += [i for i in range(index + 1, len(self._files))
                  if Path(self._files[i].path).parent == folder]  # fmt: skip
        homes = [i for i in order if name in self._files[i].places]
        others = [i for i in homes if (i, name) not in self._open]
        return self._read(name, (others or homes)[0]) if homes else None

    def _unknown(self, name: str, role: str | None) -> Diagnostic:
        import difflib  # slow, needed for faults only

        names = self.names(role=role)
        folded = name.casefold().replace("-", "_").replace(" ", "_")
        near = difflib.get_close_matches(folded, names, n=3, cutoff=0.5)
        near = near or [n for n in names if folded[:3] and folded[:3] in n][:3]
        listed = ", ".join(f'"{n}"' for n in near)
        remedy = f"best matches are {listed}" if near else "see: actuator-opt materials list"
        return Diagnostic(f'unknown material "{name}"', remedy)


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
    own = tuple(read_file(Path(path)) for path in extra)
    library = _library((*(read_file(path) for path in shipped), *own))
    if own:
        mine = {file.path for file in own}
        faults = [fault for fault in library.check() if fault.file in mine]
        if faults:
            raise InputError(faults)
    return library


@functools.lru_cache(maxsize=16)
def _library(files: tuple[MaterialFile, ...]) -> Library:
    return Library(files)
