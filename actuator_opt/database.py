"""The database of a sweep: rows of numbers by the hash of what they were computed from, in SQLite.

Every chunk is one transaction, so that a process that is killed at any instant leaves whole
chunks and nothing else. A row stands once, whoever computes it.
"""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .errors import Diagnostic, InputError
from .numeric import Array

FORMAT = 1
"""Of the tables below."""

BUSY = 60.0
"""Seconds to wait for another process that writes."""

ASKED = 500
"""Keys of one question; SQLite takes at least 999 parameters."""

OURS = frozenset({"meta", "studies", "rows"})
"""Tables by which a database of ours is known."""

PAUSE = 0.01
"""Seconds between two tries to open a file that another process is opening."""

_PUT = "INSERT OR IGNORE INTO rows (study, key, numbers, failure) VALUES (?, ?, ?, ?)"
_TABLES = """
CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS studies (
  id INTEGER PRIMARY KEY, hash TEXT NOT NULL UNIQUE, name TEXT NOT NULL, design TEXT NOT NULL,
  columns TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS rows (
  id INTEGER PRIMARY KEY, study INTEGER NOT NULL, key BLOB NOT NULL, numbers BLOB, failure TEXT,
  UNIQUE (study, key)
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


class Database:
    """An open database, of one study: a design, what varies and the version of the models."""

    def __init__(self, connection: sqlite3.Connection, study: int, width: int, path: Path) -> None:
        self.connection, self.study, self.width, self.path = connection, study, width, path

    def missing(self, keys: Sequence[bytes]) -> list[int]:
        """Numbers of the keys whose rows do not stand yet."""
        known = self._known(keys, "key")
        return [number for number, key in enumerate(keys) if key not in known]

    def known(self, keys: Sequence[bytes]) -> dict[int, tuple[bytes | None, str | None]]:
        """Rows that stand already, by the number of their key."""
        kept = self._known(keys, "key, numbers, failure")
        return {number: kept[key] for number, key in enumerate(keys) if key in kept}

    def _known(self, keys: Sequence[bytes], columns: str) -> dict[bytes, Any]:
        """Columns, beside the first, of the rows that stand, by their key."""
        some = "SELECT 1 FROM rows WHERE study = ? LIMIT 1"
        if self.connection.execute(some, (self.study,)).fetchone() is None:
            return {}
        kept: dict[bytes, Any] = {}
        for first in range(0, len(keys), ASKED):
            part = keys[first : first + ASKED]
            marks = ",".join("?" * len(part))
            select = f"SELECT {columns} FROM rows WHERE study = ? AND key IN ({marks})"
            for key, *row in self.connection.execute(select, (self.study, *part)):
                kept[key] = tuple(row)
        return kept

    def put(self, keys: Sequence[bytes], rows: Rows) -> None:
        """Keep a chunk, all of it or nothing; what stands already stays."""
        width = 8 * self.width
        data = np.ascontiguousarray(rows.numbers, dtype="<f8").tobytes()
        failures = rows.failures
        records = [
            (self.study, key, None, failures[k])
            if k in failures
            else (self.study, key, data[k * width : (k + 1) * width], None)
            for k, key in enumerate(keys)
        ]
        with self.connection:
            self.connection.executemany(_PUT, records)

    def numbers(self, blob: object) -> Array:
        """The numbers of a row.

        Raises
        ------
        InputError
            there are not as many as its study has columns
        """
        if not isinstance(blob, bytes) or len(blob) != 8 * self.width:
            raise damaged(self.path)
        found: Array = np.frombuffer(blob, dtype="<f8")
        return found


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
    with _diagnosed(path):
        connection = sqlite3.connect(path.absolute(), timeout=BUSY)  # ":memory:" is a file, too
        try:
            _patiently(lambda: _require_ours(connection, path, version))
            told = json.dumps([list(column) for column in columns])
            with connection:
                connection.execute(
                    "INSERT OR IGNORE INTO studies (hash, name, design, columns) VALUES (?,?,?,?)",
                    (study, name, design, told),
                )
            select = "SELECT id, columns FROM studies WHERE hash = ?"
            number, kept = connection.execute(select, (study,)).fetchone()
            if kept != told:
                raise refused(path, "holds other columns of this study", "name another file")
            with connection:
                put = "INSERT OR IGNORE INTO texts VALUES (?, ?, ?)"
                connection.executemany(put, [(number, *one) for one in texts])
            yield Database(connection, number, len(columns), path)
        finally:
            connection.close()


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
        put = "INSERT OR IGNORE INTO meta VALUES (?, ?)"
        connection.executemany(put, [("format", str(FORMAT)), ("version", version)])
    require_version(connection, path, version, "name another file for the new rows")


def require_version(connection: sqlite3.Connection, path: Path, version: str, remedy: str) -> None:
    """Refuse another format, and rows of other models."""
    meta = dict(connection.execute("SELECT key, value FROM meta"))
    if meta.get("format") != str(FORMAT):
        message = f"has the format {meta.get('format')}, not {FORMAT}"
        raise refused(path, message, "name another file")
    if meta.get("version") != version:
        message = f"holds rows of the models {meta.get('version')}, these are {version}"
        raise refused(path, message, remedy)


def refused(path: Path, message: str, remedy: str) -> InputError:
    """What is wrong with a database, in one line."""
    return InputError(Diagnostic(message, remedy, str(path)))


def damaged(path: Path) -> InputError:
    """A row that is none, in one line."""
    return refused(path, "holds a damaged row", "run its sweep anew, with another --store")


@contextmanager
def _diagnosed(path: Path) -> Iterator[None]:
    """Say in one line what SQLite or the file system refuses."""
    try:
        yield
    except sqlite3.DatabaseError as error:
        text = str(error)
        if "not a database" in text or "malformed" in text:
            raise refused(path, "is no database of sweeps", "name another file") from None
        remedy = "rows kept so far stay; make room, or name a file where you may write"
        if "unable to open" in text:
            remedy = "name a file in a folder that is there and where you may write"
        raise refused(path, f"cannot be written: {text}", remedy) from None
