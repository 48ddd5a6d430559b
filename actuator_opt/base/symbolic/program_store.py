"""Programs of recorded functions in a folder of the user, so that later runs need not record again.

A file has a line of JSON with sizes and a checksum, and then the compressed arrays. Files are data
from elsewhere: this module checks their sizes, the machine the slots of every instruction, and
`recorded` compares results with the models. A file that cannot be read or written only costs a new
recording.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import zlib
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from ...version import VERSION
from ..dataclass import dataclass
from ..files import private_part, user_folder
from ..numeric import Array
from .program import MOST_SLOTS, OPERATIONS, Program

FOLDER: Final = "ACTUATOR_OPT_PROGRAMS"
"""Environment variable: folder of the stored programs; "0" stores none."""
MOST_FILES: Final = 200
"""Largest number of files; the least recently used are deleted (our choice: some 30 MB)."""
MOST_RECORDINGS: Final = 3
"""Largest number of recordings of a function; each follows other branches."""
_MOST_KNOWN: Final = 32
"""Largest number of functions whose recordings are kept in memory."""
_MOST_BYTES: Final = 4_000_000
"""Largest size of a file in bytes, and of each array in elements."""
_SUFFIX: Final = ".program"
_KINDS: Final = {"code": "<u2", "extra": "<i4", "outputs": "<i4", "frozen": "<i4",
                 "constants": "<f8", "answers": "u1"}  # fmt: skip
"""Type of the elements of every array, in the order of the file."""


@dataclass(slots=True)
class Recording:
    """A program whose last outputs are guards: conditions on which the function branches.

    `answers` are the truth values of the guards for which the program is correct. `checked` says
    whether this process has compared the program with its function.
    """

    program: Program
    answers: Array
    checked: bool = False

    @property
    def rows(self) -> int:
        """Number of results, without the guards."""
        return len(self.program.outputs) - len(self.answers)

    def covers(self, point: Array) -> bool:
        """Whether a point (inputs,) takes the recorded branches."""
        return bool(self.holds(self.program.values(point[None]))[0])

    def holds(self, results: Array) -> Array:
        """Whether each point (points, outputs) takes the recorded branches."""
        return ((results[:, self.rows :] != 0) == self.answers).all(axis=1)


def folder() -> Path | None:
    """Folder of the stored programs; None if none are stored or the home folder is unknown."""
    stated = os.environ.get(FOLDER, "")
    if stated == "0":
        return None
    with contextlib.suppress(RuntimeError):
        return Path(stated).expanduser() if stated else user_folder("cache") / "programs"
    return None


@cache
def _version() -> bytes:
    """Digest of this version of the package: names, sizes and times of its source files."""
    package = Path(__file__).parents[2]
    digest = hashlib.blake2b(f"{VERSION} {np.__version__} {OPERATIONS}".encode())
    folders = [str(package)]
    while folders:
        entries = sorted(os.scandir(folders.pop()), key=lambda entry: entry.name)
        for entry in entries:
            if entry.name.endswith((".py", ".c", ".h", ".yaml")):
                state = entry.stat()
                digest.update(f"{entry.name} {state.st_size} {state.st_mtime_ns}\n".encode())
            elif entry.name != "__pycache__" and entry.is_dir(follow_symlinks=False):
                folders.append(entry.path)
    return digest.digest()


def key_of(structure: Any) -> str:
    """Key of a function, from JSON data that determine its operations, and from the version."""
    text = json.dumps(structure, sort_keys=True, default=str).encode()
    return hashlib.blake2b(_version() + text, digest_size=16).hexdigest()


def read(key: str) -> list[Recording]:
    """All recordings stored for a key; each follows other branches."""
    if key in _KNOWN:
        return list(_KNOWN[key])
    where, recordings = folder(), []
    for place in range(MOST_RECORDINGS if where is not None else 0):
        path = Path(where or "", f"{key}-{place}{_SUFFIX}")
        with contextlib.suppress(
            OSError, ValueError, LookupError, TypeError, AttributeError, zlib.error, RecursionError
        ):
            if path.is_file() and path.stat().st_size <= _MOST_BYTES:
                recordings.append(_decoded(path.read_bytes()))
                os.utime(path)
    _remember(key, recordings)
    return recordings


def write(key: str, recording: Recording) -> None:
    """Store a further recording, in memory and, if it can be written, in the folder."""
    stored = read(key)[: MOST_RECORDINGS - 1]
    _remember(key, [*stored, recording])
    where = folder()
    if where is None:
        return
    with contextlib.suppress(OSError):
        where.mkdir(mode=0o700, parents=True, exist_ok=True)
        with private_part(where) as (file, part):
            file.write(_encoded(recording))
            file.close()
            part.replace(where / f"{key}-{len(stored)}{_SUFFIX}")
        _make_room(where)


_KNOWN: dict[str, list[Recording]] = {}
"""Recordings used in this process, by key."""


def _remember(key: str, recordings: list[Recording]) -> None:
    while len(_KNOWN) >= _MOST_KNOWN and key not in _KNOWN:
        _KNOWN.pop(next(iter(_KNOWN)))
    _KNOWN[key] = recordings


def _make_room(where: Path) -> None:
    """Delete the least recently used files beyond the largest number."""
    with os.scandir(where) as entries:
        paths = [entry.path for entry in entries if entry.name.endswith(_SUFFIX)]
    if len(paths) > MOST_FILES:
        for path in sorted(paths, key=os.path.getmtime)[:-MOST_FILES]:
            os.unlink(path)


def _encoded(recording: Recording) -> bytes:
    program = recording.program
    arrays = [
        np.ascontiguousarray(
            recording.answers if name == "answers" else getattr(program, name), dtype=kind
        )
        for name, kind in _KINDS.items()
    ]
    body = zlib.compress(b"".join(array.tobytes() for array in arrays), level=1)
    head = {
        "slots": program.slots,
        "inputs": program.inputs,
        "sizes": [array.size for array in arrays],
        "checksum": hashlib.blake2b(body, digest_size=16).hexdigest(),
    }
    return json.dumps(head).encode() + b"\n" + body


def _decoded(data: bytes) -> Recording:
    """The recording in a file; raises ValueError, LookupError or TypeError if it is damaged."""
    text, _, body = data.partition(b"\n")
    head = json.loads(text)
    if head["checksum"] != hashlib.blake2b(body, digest_size=16).hexdigest():
        raise ValueError("the checksum differs")
    slots, inputs, sizes = head["slots"], head["inputs"], head["sizes"]
    whole = [slots, inputs, *sizes]
    if not all(type(number) is int and 0 <= number <= _MOST_BYTES for number in whole):
        raise ValueError("a size is out of range")
    kinds = [np.dtype(kind) for kind in _KINDS.values()]
    total = sum(n * kind.itemsize for n, kind in zip(sizes, kinds, strict=True))
    raw = zlib.decompressobj().decompress(body, total + 1)
    if len(raw) != total or not inputs <= slots <= MOST_SLOTS:
        raise ValueError("a size is wrong")
    arrays: dict[str, Any] = {}
    at = 0
    for (name, kind), size in zip(_KINDS.items(), sizes, strict=True):
        arrays[name] = np.frombuffer(raw, kind, size, at).copy()
        at += arrays[name].nbytes
    answers = arrays.pop("answers").astype(bool)
    arrays["code"] = arrays["code"].reshape(-1, 5)
    if not len(arrays["frozen"]) == len(arrays["outputs"]) > len(answers):
        raise ValueError("a size is wrong")
    return Recording(Program(**arrays, slots=slots, inputs=inputs), answers)
