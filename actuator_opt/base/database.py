"""The database of a sweep: rows of numbers by the hash of what they were computed from, in SQLite.

Every chunk is one transaction, so that a process that is killed at any instant leaves whole
chunks and nothing else. A row stands once, whoever computes it.

Every row has a checksum of its study, its key and its numbers, and counts only where that fits.
It is of a row, not of a chunk: another sweep takes the same rows in other chunks. It is BLAKE2b,
as the keys are, since a cyclic redundancy check, the faster one, misses one edit in 2^32. It
guards against damage and slips; whoever changes a row on purpose can write its checksum too.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .errors import Diagnostic, InputError
from .files import make_private
from .numeric import Array

FORMAT = 2
"""Of the tables below. Rows of format 1 have no checksums, so none of them can be trusted."""

BUSY = 60.0
"""Seconds to wait for another process that writes."""

ASKED = 500
"""Keys of one question; SQLite takes at least 999 parameters."""

OURS = frozenset({"meta", "studies", "rows"})
"""Tables by which a database of ours is known."""

PAUSE = 0.01
"""Seconds between two tries to open a file that another process is opening."""

CHECK = 8
"""Bytes of a checksum: damage goes unnoticed once in 2^64 times."""

_PUT = "INSERT OR REPLACE INTO rows (study, key, numbers, failure, checksum) VALUES (?, ?, ?, ?, ?)"
_TABLES = """
CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS studies (
  id INTEGER PRIMARY KEY, hash TEXT NOT NULL UNIQUE, name TEXT NOT NULL, design TEXT NOT NULL,
  columns TEXT NOT NULL, checksum BLOB NOT NULL
);
CREATE TABLE IF NOT EXISTS rows (
  id INTEGER PRIMARY KEY, study INTEGER NOT NULL, key BLOB NOT NULL, numbers BLOB, failure TEXT,
  checksum BLOB NOT NULL, UNIQUE (study, key)
);
CREATE TABLE IF NOT EXISTS texts (
  study INTEGER NOT NULL, path TEXT NOT NULL, text TEXT NOT NULL, PRIMARY KEY (study, path, text)
) WITHOUT ROWID;
"""


class Column(NamedTuple):
    """One number of a row: its name and its SI unit."""

    name: str
    unit: str


class Rows(NamedTuple):
    """Numbers (n, columns) of some keys; NaN rows and a reason where a design failed."""

    numbers: Array
    failures: dict[int, str]


class Seals:
    """Checksums of the rows of a study."""

    def __init__(self, study: str, width: int) -> None:
        self._size = 8 * width
        self._head = hashlib.blake2b(study.encode(), digest_size=CHECK)

    def of(self, key: bytes, numbers: bytes | None, failure: str | None) -> bytes:
        """The checksum of a row."""
        found = self._head.copy()
        found.update(key)
        found.update(b"failed " + (failure or "").encode() if numbers is None else numbers)
        return found.digest()

    def fits(self, key: Any, numbers: Any, failure: Any, checksum: Any) -> bool:
        """Whether a row out of a file is whole: numbers, or a reason why there are none."""
        if not isinstance(key, bytes):
            return False
        if numbers is None:
            return isinstance(failure, str) and checksum == self.of(key, None, failure)
        whole = isinstance(numbers, bytes) and len(numbers) == self._size and failure is None
        return whole and checksum == self.of(key, numbers, None)


class Database:
    """An open database, of one study: a design, what varies and the version of the models."""

    def __init__(
        self, connection: sqlite3.Connection, number: int, study: str, width: int, path: Path
    ) -> None:
        self.connection, self.number, self.path = connection, number, path
        self.width, self.seals = width, Seals(study, width)

    def missing(self, keys: Sequence[bytes]) -> tuple[list[int], int]:
        """Numbers of the keys without a whole row, and how many of their rows are damaged."""
        known = self._known(keys)
        sound = [key for key, row in known.items() if row is not None]
        lacking = set(keys).difference(sound)
        return [k for k, key in enumerate(keys) if key in lacking], len(known) - len(sound)

    def known(self, keys: Sequence[bytes]) -> dict[int, tuple[Array | None, str | None]]:
        """Rows already stored, by the number of their key, without damaged ones."""
        rows = self._known(keys)
        kept: dict[int, tuple[Array | None, str | None]] = {}
        for k, key in enumerate(keys):
            row = rows.get(key)
            if row is not None:
                blob, failure = row
                kept[k] = (None if blob is None else np.frombuffer(blob, dtype="<f8"), failure)
        return kept

    def _known(self, keys: Sequence[bytes]) -> dict[bytes, tuple[bytes | None, str | None] | None]:
        """Numbers and failures of the rows of some keys, by their key; None of damaged ones."""
        some = "SELECT 1 FROM rows WHERE study = ? LIMIT 1"
        if self.connection.execute(some, (self.number,)).fetchone() is None:
            return {}
        kept: dict[bytes, tuple[bytes | None, str | None] | None] = {}
        for first in range(0, len(keys), ASKED):
            part = keys[first : first + ASKED]
            marks = ",".join("?" * len(part))
            select = (
                "SELECT key, numbers, failure, checksum FROM rows"
                f" WHERE study = ? AND key IN ({marks})"
            )
            for row in self.connection.execute(select, (self.number, *part)):
                kept[row[0]] = row[1:3] if self.seals.fits(*row) else None
        return kept

    def put(self, keys: Sequence[bytes], rows: Rows) -> None:
        """Keep a chunk, all of it or nothing, in the place of damaged rows."""
        width = 8 * self.width
        data = np.ascontiguousarray(rows.numbers, dtype="<f8").tobytes()
        failures = rows.failures
        records = []
        for k, key in enumerate(keys):
            failure = failures.get(k)
            numbers = data[k * width : (k + 1) * width] if failure is None else None
            checksum = self.seals.of(key, numbers, failure)
            records.append((self.number, key, numbers, failure, checksum))
        with self.connection:
            self.connection.executemany(_PUT, records)


@contextmanager
def opened(
    path: Path,
    *,
    study: str,
    name: str,
    design: str,
    columns: Sequence[Column],
    version: str,
    texts: Iterable[tuple[str, str]] = (),
) -> Iterator[Database]:
    """Open or begin the database of a study.

    Parameters
    ----------
    path : of the file; made where it is not there
    study : hash of the design and of what varies
    name, design : of the study, for whoever reads the file
    columns : of its rows
    version : of the models; another one's rows are not mixed in
    texts : PATHs with the texts (materials, ...) they take, which rows name by their key alone

    Raises
    ------
    InputError
        the file is no such database, of another version, or cannot be written
    """
    make_private(path)
    with _diagnosed(path):
        connection = sqlite3.connect(path.absolute(), timeout=BUSY)  # ":memory:" is a file, too
        try:
            _patiently(lambda: _require_ours(connection, path, version))
            told = json.dumps([list(column) for column in columns])
            number = _begun(connection, path, (study, name, design, told))
            with connection:
                put = "INSERT OR IGNORE INTO texts VALUES (?, ?, ?)"
                connection.executemany(put, [(number, *one) for one in texts])
            yield Database(connection, number, study, len(columns), path)
        finally:
            connection.close()


def _begun(connection: sqlite3.Connection, path: Path, study: tuple[str, str, str, str]) -> int:
    """The number of a study (hash, name, design, columns), which is entered where it lacks."""
    hashed, *about = study
    with connection:
        connection.execute(
            "INSERT OR IGNORE INTO studies (hash, name, design, columns, checksum)"
            " VALUES (?,?,?,?,?)",
            (*study, study_checksum(*study)),
        )
    select = "SELECT id, name, design, columns, checksum FROM studies WHERE hash = ?"
    row = connection.execute(select, (hashed,)).fetchone()
    if row is None:  # its index is damaged
        raise damaged(path)
    number, *kept, checksum = row
    if checksum != study_checksum(hashed, *kept):
        with connection:
            connection.execute(
                "UPDATE studies SET name = ?, design = ?, columns = ?, checksum = ? WHERE id = ?",
                (*about, study_checksum(*study), number),
            )
    elif kept[-1] != about[-1]:
        raise refused(path, "holds other columns of this study", "name another file")
    return int(number)


def study_checksum(*about: object) -> bytes:
    """The checksum of a study: of its hash, name, design and columns."""
    text = json.dumps(about, default=repr)
    return hashlib.blake2b(text.encode(), digest_size=CHECK).digest()


def _patiently(act: Callable[[], None]) -> None:
    """Do what SQLite refuses while another process opens the file: it waits for rows alone."""
    end = time.monotonic() + BUSY
    while True:
        try:
            return act()
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() > end:
                raise
        time.sleep(PAUSE)


def _require_ours(connection: sqlite3.Connection, path: Path, version: str) -> None:
    """Make the tables of a new file; refuse what is not ours."""
    tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_master")}
    if tables and not tables >= OURS:
        raise refused(path, "is another program's database", "name another file")
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    connection.execute(
        "PRAGMA cache_size = -65536"
    )  # KiB: the index of keys, which come in no order
    with connection:
        connection.execute("BEGIN IMMEDIATE")  # all tables or none
        for statement in _TABLES.split(";"):
            connection.execute(statement)
        if not tables:
            put = "INSERT OR IGNORE INTO meta VALUES (?, ?)"
            connection.executemany(put, [("format", str(FORMAT)), ("version", version)])
    require_version(connection, path, version, "name another file for the new rows")


def require_version(connection: sqlite3.Connection, path: Path, version: str, remedy: str) -> None:
    """Refuse another format, and rows of other models."""
    meta = dict(connection.execute("SELECT key, value FROM meta"))
    if meta.get("format") != str(FORMAT):
        message = f"has the format {meta.get('format')}, not {FORMAT}"
        if meta.get("format") == "1":
            message = "was written without checksums, by which damaged rows are noticed (format 1)"
        raise refused(path, message, remedy)
    if meta.get("version") != version:
        message = f"holds rows of the models {meta.get('version')}, these are {version}"
        raise refused(path, message, remedy)


def refused(path: Path, message: str, remedy: str) -> InputError:
    """What is wrong with a database, in one line."""
    return InputError(Diagnostic(message, remedy, str(path)))


def damaged(path: Path) -> InputError:
    """A file that SQLite cannot read whole, in one line."""
    return refused(path, "is a damaged database", "run its sweep again, with another --store")


@contextmanager
def _diagnosed(path: Path) -> Iterator[None]:
    """Say in one line what SQLite or the file system refuses."""
    try:
        yield
    except UnicodeDecodeError:  # of the message in which SQLite says what is malformed
        raise damaged(path) from None
    except sqlite3.DatabaseError as error:
        text = str(error)
        if "not a database" in text:
            raise refused(path, "is no database of sweeps", "name another file") from None
        if "malformed" in text or "UTF-8" in text:
            raise damaged(path) from None
        remedy = "rows kept so far stay; make room, or name a file where you may write"
        if "unable to open" in text:
            remedy = "name a file in a folder that is there and where you may write"
        raise refused(path, f"cannot be written: {text}", remedy) from None
