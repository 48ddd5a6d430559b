"""SQLite database of a sweep: rows of numbers, each stored under the hash of its inputs.

Every chunk is written in one transaction, so a process killed at any moment leaves only whole
chunks. Each row is stored once, whichever process computes it.

Every row has a checksum of its study, its key and its numbers; rows with a wrong checksum are
ignored. Each checksum covers one row, not a chunk, because another sweep may group the same rows
differently. The hash is BLAKE2b, as for the keys; a cyclic redundancy check is faster but misses
one change in 2^32. The checksum guards against damage, not against forgery: anyone who edits a row
can also write its checksum.
"""

from __future__ import annotations

import hashlib
import json
import os
import sqlite3
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np

from .errors import Diagnostic, InputError
from .files import make_private, read_bytes
from .numeric import Array

FORMAT = 2
"""Version of the tables below. Rows of format 1 have no checksums and are refused."""

BUSY = 60.0
"""Seconds to wait while another process writes."""

KEYS_PER_QUERY = 500
"""Keys per query; SQLite accepts at least 999 parameters."""

TABLES = frozenset({"meta", "studies", "rows"})
"""Tables that a database must contain to be recognised as one of this program."""

PAUSE = 0.01
"""Seconds between two attempts to open a file that another process is opening."""

CHECK = 8
"""Bytes of a checksum; on average, one damaged row in 2^64 goes unnoticed."""

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


class NumberColumn(NamedTuple):
    """A column of numbers: name and SI unit."""

    name: str
    unit: str


class StoredNumbers(NamedTuple):
    """Numbers stored for several keys, one row per key; a failed design has NaN and a reason."""

    numbers: Array
    failures: dict[int, str]


class Checksums:
    """Computes and checks the checksums of a study's rows."""

    def __init__(self, study: str, width: int) -> None:
        self._size = 8 * width
        self._head = hashlib.blake2b(study.encode(), digest_size=CHECK)

    def of(self, key: bytes, numbers: bytes | None, failure: str | None) -> bytes:
        """Checksum of a row."""
        checksum = self._head.copy()
        checksum.update(key)
        checksum.update(b"failed " + (failure or "").encode() if numbers is None else numbers)
        return checksum.digest()

    def fits(self, key: Any, numbers: Any, failure: Any, checksum: Any) -> bool:
        """Whether a stored row (numbers, or the reason for a failure) matches its checksum."""
        if not isinstance(key, bytes):
            return False
        if numbers is None:
            return isinstance(failure, str) and checksum == self.of(key, None, failure)
        whole = isinstance(numbers, bytes) and len(numbers) == self._size and failure is None
        return whole and checksum == self.of(key, numbers, None)


class Database:
    """Open database of one study: one design, its varied inputs, one version of the models."""

    def __init__(
        self, connection: sqlite3.Connection, number: int, study: str, width: int, path: Path
    ) -> None:
        self.connection, self.number, self.path = connection, number, path
        self.width, self.checksums = width, Checksums(study, width)
        version = self._data_version()  # before looking: rows written in between are then looked up
        self._empty_at = None if self._has_rows() else version

    def missing(self, keys: Sequence[bytes]) -> tuple[list[int], int]:
        """Indices of the keys without an intact row, and how many of them have a damaged row.

        Rows of a study that was empty when it was opened are not looked up until another process
        writes: the caller asks for every key only once.
        """
        if self._empty_at == self._data_version():
            return list(range(len(keys))), 0
        known = self._known(keys)
        sound = [key for key, row in known.items() if row is not None]
        lacking = set(keys).difference(sound)
        return [k for k, key in enumerate(keys) if key in lacking], len(known) - len(sound)

    def known(self, keys: Sequence[bytes]) -> dict[int, tuple[Array | None, str | None]]:
        """Rows already stored, by the index of their key in `keys`; damaged rows are omitted."""
        rows = self._known(keys)
        stored: dict[int, tuple[Array | None, str | None]] = {}
        for k, key in enumerate(keys):
            row = rows.get(key)
            if row is not None:
                blob, failure = row
                stored[k] = (None if blob is None else np.frombuffer(blob, dtype="<f8"), failure)
        return stored

    def _known(self, keys: Sequence[bytes]) -> dict[bytes, tuple[bytes | None, str | None] | None]:
        """Numbers and failure reason of every stored row by key; None for damaged rows."""
        if not self._has_rows():
            return {}
        stored: dict[bytes, tuple[bytes | None, str | None] | None] = {}
        for first in range(0, len(keys), KEYS_PER_QUERY):
            part = keys[first : first + KEYS_PER_QUERY]
            marks = ",".join("?" * len(part))
            select = (
                "SELECT key, numbers, failure, checksum FROM rows"
                f" WHERE study = ? AND key IN ({marks})"
            )
            for row in self.connection.execute(select, (self.number, *part)):
                stored[row[0]] = row[1:3] if self.checksums.fits(*row) else None
        return stored

    def _has_rows(self) -> bool:
        probe = "SELECT 1 FROM rows WHERE study = ? LIMIT 1"
        return self.connection.execute(probe, (self.number,)).fetchone() is not None

    def _data_version(self) -> int:
        """A number that changes when another connection has written to the file."""
        return int(self.connection.execute("PRAGMA data_version").fetchone()[0])

    def put(self, keys: Sequence[bytes], rows: StoredNumbers) -> None:
        """Store a chunk completely or not at all; damaged rows are replaced.

        Rows are written in the order of their keys, so that the index is changed page by page.
        """
        width = 8 * self.width
        data = np.ascontiguousarray(rows.numbers, dtype="<f8").tobytes()
        failures = rows.failures
        records = []
        for key, k in sorted(zip(keys, range(len(keys)), strict=True)):
            failure = failures.get(k)
            numbers = data[k * width : (k + 1) * width] if failure is None else None
            checksum = self.checksums.of(key, numbers, failure)
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
    columns: Sequence[NumberColumn],
    version: str,
    texts: Iterable[tuple[str, str]] = (),
) -> Iterator[Database]:
    """Open the database of a study, or create it.

    Parameters
    ----------
    path : file; created if missing
    study : hash of the design and its varied inputs
    name, design : name and design of the study, for people who inspect the file
    columns : columns of its rows
    version : version of the models; rows of different versions are never mixed
    texts : pairs of a PATH and a text value that it may have, such as a material; rows only contain
        numbers

    Raises
    ------
    InputError
        if it is no database of sweeps, has another version, or is not writable
    """
    make_private(path)
    with _diagnosed(path):
        connection = sqlite3.connect(path.absolute(), timeout=BUSY)  # ":memory:" is a file, too
        try:
            _retried(lambda: _prepare(connection, path, version))
            columns_text = json.dumps([list(column) for column in columns])
            number = _study_number(connection, path, (study, name, design, columns_text))
            with connection:
                put = "INSERT OR IGNORE INTO texts VALUES (?, ?, ?)"
                connection.executemany(put, [(number, *text) for text in texts])
            yield Database(connection, number, study, len(columns), path)
        finally:
            connection.close()


def _study_number(
    connection: sqlite3.Connection, path: Path, study: tuple[str, str, str, str]
) -> int:
    """Index of a study (hash, name, design, columns); add the study if it is missing."""
    hashed, *description = study
    with connection:
        connection.execute(
            "INSERT OR IGNORE INTO studies (hash, name, design, columns, checksum)"
            " VALUES (?,?,?,?,?)",
            (*study, study_checksum(*study)),
        )
    select = "SELECT id, name, design, columns, checksum FROM studies WHERE hash = ?"
    row = connection.execute(select, (hashed,)).fetchone()
    if row is None:  # the index of the table is damaged
        raise damaged(path)
    number, *stored, checksum = row
    if checksum != study_checksum(hashed, *stored):
        with connection:
            connection.execute(
                "UPDATE studies SET name = ?, design = ?, columns = ?, checksum = ? WHERE id = ?",
                (*description, study_checksum(*study), number),
            )
    elif stored[-1] != description[-1]:
        raise refused(path, "contains this study with different columns", "name another file")
    return int(number)


def study_checksum(*about: object) -> bytes:
    """Checksum of a study: of its hash, name, design and columns."""
    text = json.dumps(about, default=repr)
    return hashlib.blake2b(text.encode(), digest_size=CHECK).digest()


def _retried(act: Callable[[], None]) -> None:
    """Repeat a call while SQLite refuses it because another process is opening the file."""
    end = time.monotonic() + BUSY
    while True:
        try:
            return act()
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() > end:
                raise
        time.sleep(PAUSE)


def _prepare(connection: sqlite3.Connection, path: Path, version: str) -> None:
    """Create the tables of a new file; refuse a database of another program."""
    tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_master")}
    if tables and not tables >= TABLES:
        raise refused(path, "is another program's database", "name another file")
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    connection.execute("PRAGMA cache_size = -65536")  # KiB: holds the index of keys
    connection.execute("PRAGMA wal_autocheckpoint = 16384")  # pages, with 4 KiB each also 64 MiB
    with connection:
        connection.execute("BEGIN IMMEDIATE")  # create all tables or none
        for statement in _TABLES.split(";"):
            connection.execute(statement)
        if not tables:
            put = "INSERT OR IGNORE INTO meta VALUES (?, ?)"
            connection.executemany(put, [("format", str(FORMAT)), ("version", version)])
    require_version(connection, path, version, "name another file for the new rows")


def require_version(connection: sqlite3.Connection, path: Path, version: str, remedy: str) -> None:
    """Refuse a database of another format, or with rows of other model versions."""
    meta = dict(connection.execute("SELECT key, value FROM meta"))
    if meta.get("format") != str(FORMAT):
        message = f"has the format {meta.get('format')}, not {FORMAT}"
        if meta.get("format") == "1":
            message = "has no checksums to detect damaged rows (format 1)"
        raise refused(path, message, remedy)
    if meta.get("version") != version:
        message = f"has rows of model version {meta.get('version')}, not {version}"
        raise refused(path, message, remedy)


def refused(path: Path, message: str, remedy: str) -> InputError:
    """A one-line error about a database."""
    return InputError(Diagnostic(message, remedy, str(path)))


def damaged(path: Path) -> InputError:
    """A one-line error about a file that SQLite cannot read completely."""
    return refused(path, "is a damaged database", "run the sweep again with another --store")


@contextmanager
def _diagnosed(path: Path) -> Iterator[None]:
    """Explain in one line what SQLite or the file system refuses."""
    try:
        yield
    except UnicodeDecodeError:  # part of SQLite's message about a malformed file
        raise damaged(path) from None
    except sqlite3.DatabaseError as error:
        text = str(error)
        if "not a database" in text:
            raise refused(path, "is not a database of sweeps", "name another file") from None
        if "malformed" in text or "UTF-8" in text:
            raise damaged(path) from None
        remedy = "stored rows are kept; free disk space, or name a writable file"
        if "unable to open" in text:
            remedy = "name a file in an existing, writable folder"
        raise refused(path, f"cannot be written: {text}", remedy) from None


MAGIC = b"SQLite format 3\0"
"""First bytes of every SQLite file."""
ROWS_PER_QUERY = 4096
"""Rows per query."""
_SELECT = "SELECT key, numbers, failure, checksum FROM rows WHERE study = ?"


class StoredRows(NamedTuple):
    """A study and the number of its rows; `texts` has the possible text values by PATH."""

    number: int
    hash: str
    name: str
    design: str
    columns: tuple[NumberColumn, ...]
    rows: int
    """Number of stored rows, intact or damaged."""
    failures: dict[str, int]
    """Number of failed designs by reason."""
    texts: dict[str, tuple[str, ...]]


class Reader:
    """An open database."""

    def __init__(self, connection: sqlite3.Connection, path: Path) -> None:
        self.connection, self.path = connection, path

    def study(self, number: int | None = None) -> StoredRows:
        """The study with this number, or the newest study.

        Raises
        ------
        InputError
            if there is no such study, or it has no rows
        """
        select = "SELECT id, hash, name, design, columns, checksum FROM studies ORDER BY id"
        studies = self.connection.execute(select).fetchall()
        if not studies:
            raise refused(self.path, "has no study", "run `sweep --store` first to fill it")
        matches = [row for row in studies if number in (None, row[0])]
        if not matches:
            have = ", ".join(f"{row[0]} ({row[2]})" for row in studies[-8:])
            raise refused(self.path, f"has no study {number}", f"choose --study from {have}")
        number, hashed, name, design, columns, checksum = matches[-1]
        if checksum != study_checksum(hashed, name, design, columns):
            message = f"study {number} is damaged"
            raise refused(self.path, message, "run the sweep again with --store")
        stated = self._columns(columns)
        count = "SELECT count(*) FROM rows NOT INDEXED WHERE study = ?"  # it may lack rows
        rows = self.connection.execute(count, (number,)).fetchone()[0]
        if not rows:
            raise refused(self.path, f"study {number} has no rows yet", "run its sweep first")
        failures = self._failures(number, Checksums(hashed, len(stated)))
        return StoredRows(number, hashed, name, design, stated, rows, failures, self._texts(number))

    def _failures(self, number: int, checksums: Checksums) -> dict[str, int]:
        """Number of failed designs by reason, the most frequent first; damaged rows are ignored."""
        select = f"{_SELECT} AND failure IS NOT NULL"
        reasons = Counter(
            row[2] for row in self.connection.execute(select, (number,)) if checksums.fits(*row)
        )
        return dict(sorted(reasons.items(), key=lambda item: (-item[1], item[0])))

    def number(self, hashed: str) -> int:
        """Number of the study with a hash.

        Raises
        ------
        InputError
            if no study has this hash
        """
        row = self.connection.execute("SELECT id FROM studies WHERE hash = ?", (hashed,)).fetchone()
        if row is None:
            message = "does not contain this sweep: file, materials or metrics have changed"
            raise refused(self.path, message, "run the sweep again with --store")
        return int(row[0])

    def _columns(self, text: str) -> tuple[NumberColumn, ...]:
        try:
            data = json.loads(text)
        except (TypeError, ValueError, RecursionError):
            data = None
        if not isinstance(data, list) or not all(
            isinstance(column, list) and len(column) == len(NumberColumn._fields) for column in data
        ):
            raise refused(self.path, "does not name the columns of its rows", "run the sweep again")
        return tuple(NumberColumn(*column) for column in data)

    def _texts(self, number: int) -> dict[str, tuple[str, ...]]:
        tables = {row[0] for row in self.connection.execute("SELECT name FROM sqlite_master")}
        if "texts" not in tables:
            return {}
        texts_by_path: dict[str, tuple[str, ...]] = {}
        select = "SELECT path, text FROM texts WHERE study = ? ORDER BY path, text"
        for path, text in self.connection.execute(select, (number,)):
            texts_by_path[path] = (*texts_by_path.get(path, ()), text)
        return texts_by_path

    def rows(self, study: StoredRows) -> Iterator[tuple[list[bytes], Array]]:
        """Yield keys and numbers of the successful rows, in batches, ordered by key.

        Keys are hashes, so taking every n-th row gives an even sample of the study. Damaged rows
        are omitted.
        """
        select = f"{_SELECT} AND failure IS NULL ORDER BY key"
        cursor = self.connection.execute(select, (study.number,))
        width = len(study.columns)
        checksums = Checksums(study.hash, width)
        while batch := cursor.fetchmany(ROWS_PER_QUERY):
            intact = [row for row in batch if checksums.fits(*row)]
            data = b"".join(row[1] for row in intact)
            if intact:
                yield (
                    [row[0] for row in intact],
                    np.frombuffer(data, dtype="<f8").reshape(-1, width),
                )


@contextmanager
def reading(path: Path, version: str) -> Iterator[Reader]:
    """Open a database of sweeps for reading.

    Raises
    ------
    InputError
        if the file is missing or unreadable, or has another format or other model versions
    """
    kinds = (".db", ".sqlite", ".sqlite3")
    if read_bytes(path, most=len(MAGIC), kinds=kinds, what="database of sweeps") != MAGIC:
        raise refused(path, "is not a database of sweeps", "name a file written by `sweep --store`")
    try:
        connection = _connected(path)
        try:
            _require_tables(connection, path)
            require_version(connection, path, version, "run the sweep again with --store")
            yield Reader(connection, path)
        finally:
            connection.close()
    except UnicodeDecodeError:  # part of SQLite's message about a malformed file
        raise damaged(path) from None
    except sqlite3.DatabaseError as error:
        if "malformed" in str(error) or "UTF-8" in str(error):
            raise damaged(path) from None
        remedy = "name a complete file written by `sweep --store`"
        raise InputError(Diagnostic(f"cannot be read: {error}", remedy, str(path))) from None


def _connected(path: Path) -> sqlite3.Connection:
    """Connect read-only; where no lock file can be created, treat the database as immutable."""
    name = f"file:{quote(os.fsencode(path.resolve()))}?mode=ro"
    connection = sqlite3.connect(name, uri=True, timeout=BUSY)
    try:
        connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    except sqlite3.OperationalError:
        connection.close()
        log = path.with_name(f"{path.name}-wal")
        if log.exists() and log.stat().st_size:
            raise
        connection = sqlite3.connect(f"{name}&immutable=1", uri=True, timeout=BUSY)
    return connection


def _require_tables(connection: sqlite3.Connection, path: Path) -> None:
    tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_master")}
    if not tables >= TABLES:
        raise refused(path, "is not a database of sweeps", "name a file written by `sweep --store`")
