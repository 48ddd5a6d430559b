"""Records of runs: one file each in the user's folder, written completely or not at all.

A record is a file of two lines of JSON: a short head for lists, and the body. Each line ends with a
checksum of its text, which reveals damage. The checksum is no signature: anyone who writes a record
can also write its checksum. This module does not interpret the content of a record, and deletes
records only on request.
"""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .dataclass import dataclass
from .errors import Diagnostic, InputError, shown
from .files import private_part, read_json, user_folder

FOLDER, SWITCH = "ACTUATOR_OPT_RUNS", "ACTUATOR_OPT_NO_RECORD"
"""Environment variables: the folder of the records, and a switch that disables recording if it is
set to anything but "0"."""
FORMAT = 2
"""Version of the file format; newer versions are refused with an explanation. Version 1 has no
checksums."""
SUFFIX = ".run"
_ID = re.compile(r"[0-9]{8}-[0-9]{6}-[0-9a-f]{6}")
_BEGINNING = re.compile(r"[0-9]{4,8}(-[0-9]{0,6}(-[0-9a-f]{0,6})?)?")
_MOST = 200_000_000
"""Largest size of a record in bytes, far above the size of any run."""
_HEAD = 4_000_000
"""Largest size of the first line in bytes: twice that of the longest command line."""
_SEAL = "blake2b"
"""Key of a line's checksum, which is the last key of the JSON object."""


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A record in a list: its file and its head."""

    path: Path
    head: Mapping[str, Any]

    @property
    def id(self) -> str:
        """Id of the record: the name of its file."""
        return self.path.name.removesuffix(SUFFIX)


def folder() -> Path | None:
    """Folder of the records: ACTUATOR_OPT_RUNS, else the user's data folder; None if disabled.

    Raises
    ------
    InputError : if the variable names the home folder of an unknown user
    """
    if os.environ.get(SWITCH, "") not in ("", "0"):
        return None
    stated = os.environ.get(FOLDER, "")
    try:
        return Path(stated).expanduser() if stated else user_folder("data") / "runs"
    except RuntimeError:  # unknown user, or a user without a home folder
        message = f"{FOLDER}: {shown(stated) or 'unset'}, and the home folder is unknown"
        raise InputError(
            Diagnostic(message, f"set {FOLDER} to the full path of a folder")
        ) from None


def write(place: Path, started: str, head: Mapping[str, Any], body: Mapping[str, Any]) -> Path:
    """Write a record to a temporary file, then rename it to a unique name.

    Parameters
    ----------
    place : folder; created if missing
    started : ``20261122-104500``, the beginning of its id
    head, body : plain data; lists show the head

    Raises
    ------
    InputError : if it is not writable; no file remains
    """
    from .tables import encoded

    lines = [
        encoded(part, separators=(",", ":")) for part in ({"record": FORMAT} | dict(head), body)
    ]
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        with private_part(place) as (file, part):
            with open(file.fileno(), "wb", closefd=False) as stream:
                stream.writelines(_sealed(line.encode("ascii")) + b"\n" for line in lines)
            file.close()
            while True:
                path = place / f"{started}-{_random(3)}{SUFFIX}"
                with contextlib.suppress(FileExistsError):
                    _claim(part, path)
                    return path
    except OSError as error:
        reason = f"cannot write: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, "", str(place))) from None


def _random(size: int) -> str:
    """Random hexadecimal digits."""
    return os.urandom(size).hex()


def _claim(part: Path, path: Path) -> None:
    """Rename a written file; raise FileExistsError if the name is in use."""
    try:
        os.link(part, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links
        if path.exists():
            raise FileExistsError(path) from None
        part.replace(path)


def entries(place: Path) -> tuple[list[StoredRun], list[Diagnostic]]:
    """List the records of a folder, newest first, and the faults of unreadable records."""
    runs: list[tuple[int, str, StoredRun]] = []
    faults = []
    try:
        paths = sorted(path for path in place.iterdir() if is_record(path))
    except FileNotFoundError:
        return [], []
    except OSError as error:
        reason = f"cannot be read: {error.strerror or type(error).__name__}"
        raise InputError(
            Diagnostic(reason, f"set {FOLDER} to another folder", str(place))
        ) from None
    for path in paths:
        try:
            with path.open("rb") as stream:
                line, written = stream.readline(_HEAD), os.fstat(stream.fileno()).st_mtime_ns
            entry = StoredRun(path, _parsed(line, path)[0])
        except FileNotFoundError:  # deleted in the meantime
            continue
        except OSError as error:
            reason = f"cannot be read: {error.strerror or type(error).__name__}"
            faults.append(Diagnostic(reason, "", str(path)))
        except InputError as error:
            faults += error.diagnostics
        else:
            runs.append((written, entry.id, entry))
    runs.sort(key=lambda row: row[:2], reverse=True)
    return [entry for _, _, entry in runs], faults


def is_record(path: Path) -> bool:
    """Whether a file name is that of a record."""
    return path.suffix == SUFFIX and _ID.fullmatch(path.stem) is not None


def _parsed(line: bytes, path: Path, *, sealed: bool = False) -> tuple[dict[str, Any], bool]:
    """Parse a line of a record; return the object, and whether the line has a correct checksum.

    Raises
    ------
    InputError : if it is no object, its checksum is wrong, or it lacks a checksum although `sealed`
        is set
    """
    line = line.rstrip()
    try:
        data = read_json(line)
    except ValueError:
        data = None
    if isinstance(data, dict):
        if data.pop(_SEAL, None) is None:
            whole, sealed = not sealed and data.get("record") != FORMAT, False
        else:
            whole, sealed = line == _sealed(_bare(line)), True
        if whole:
            return data, sealed
    remedy = "delete the file and repeat the run"
    raise InputError(Diagnostic("is not a record of a run, or is damaged", remedy, str(path)))


def _sealed(line: bytes) -> bytes:
    """Add the checksum to a line of JSON, as the last key of its object."""
    import hashlib

    checksum = hashlib.blake2b(line, digest_size=16).hexdigest()
    comma = "" if line == b"{}" else ","
    return line[:-1] + f'{comma}"{_SEAL}":"{checksum}"}}'.encode()


def _bare(line: bytes) -> bytes:
    """A line without its checksum."""
    return line.rpartition(f'"{_SEAL}":'.encode())[0].removesuffix(b",") + b"}"


def is_name(text: str) -> bool:
    """Whether a text names a run, as opposed to an existing design file."""
    if Path(text).suffix == SUFFIX:
        return True
    named = text == "last" or _BEGINNING.fullmatch(text) is not None
    return named and not Path(text).exists()


def find(place: Path | None, name: str) -> Path:
    """Find the file of a record by its id, the beginning of its id, ``last``, or a path.

    Raises
    ------
    InputError : if there is no match, or several
    """
    path = Path(name)
    if path.suffix == SUFFIX or os.sep in name:
        return path
    if place is None:
        raise InputError(Diagnostic("no runs are recorded", f"unset {SWITCH}"))
    if name == "last":
        runs, _ = entries(place)
        if not runs:
            raise InputError(
                Diagnostic("no run is recorded yet", "run a command such as optimise", str(place))
            )
        return runs[0].path
    matches = [file for file in _named(place) if file.name.startswith(name)] if name else []
    if len(matches) == 1:
        return matches[0]
    quoted = f'"{shown(name)}"'
    if matches:
        ids = ", ".join(file.stem for file in matches[:3])
        more = f" and {len(matches) - 3} more" if len(matches) > 3 else ""
        raise InputError(
            Diagnostic(f"several runs begin with {quoted}: {ids}{more}", "add more characters")
        )
    raise InputError(Diagnostic(f"no run {quoted}", "see: actuator-opt runs list", str(place)))


def _named(place: Path) -> list[Path]:
    """Files of records in a folder; none if it cannot be read."""
    try:
        return sorted(path for path in place.iterdir() if is_record(path))
    except OSError:
        return []


def read(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Head and body of a record.

    Raises
    ------
    InputError : if the file is missing, no record, damaged, or of a newer format
    """
    from .files import read_bytes

    data = read_bytes(path, most=_MOST, kinds=(SUFFIX,), what="record")
    lines = data.splitlines()
    head, sealed = _parsed(lines[0] if lines else b"", path)
    version_of_file = head.get("record")
    if isinstance(version_of_file, int) and version_of_file > FORMAT:
        version = shown(str(head.get("version", "")))
        message = f"was written by actuator-opt {version}, in a newer format"
        raise InputError(Diagnostic(message, "install that version or a later release", str(path)))
    body, _ = _parsed(lines[1] if len(lines) > 1 else b"", path, sealed=sealed)
    return head, body


def delete(path: Path) -> bool:
    """Delete a record; False if it no longer exists.

    Raises
    ------
    InputError : if it cannot be deleted
    """
    try:
        path.unlink()
        return True
    except FileNotFoundError:
        return False
    except OSError as error:
        reason = f"cannot be deleted: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, "", str(path))) from None
