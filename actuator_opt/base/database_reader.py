"""Read-only access to the database of a sweep: nothing is created, changed or locked."""

from __future__ import annotations

import json
import os
import sqlite3
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

import numpy as np

from .database import BUSY, OURS, Column, Seals, damaged, refused, require_version, study_checksum
from .errors import Diagnostic, InputError
from .files import read_bytes
from .numeric import Array

MAGIC = b"SQLite format 3\0"
"""First bytes of every SQLite file."""

SOME = 4096
"""Rows per query."""

_SELECT = "SELECT key, numbers, failure, checksum FROM rows WHERE study = ?"


class StoredRows(NamedTuple):
    """Stored rows of one study; `texts` lists the text values they may use, by PATH."""

    number: int
    hash: str
    name: str
    design: str
    columns: tuple[Column, ...]
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
            no such study, or the study has no rows
        """
        select = "SELECT id, hash, name, design, columns, checksum FROM studies ORDER BY id"
        every = self.connection.execute(select).fetchall()
        if not every:
            raise refused(self.path, "has no study", "fill it with `sweep --store` first")
        found = [one for one in every if number in (None, one[0])]
        if not found:
            have = ", ".join(f"{one[0]} ({one[2]})" for one in every[-8:])
            raise refused(self.path, f"has no study {number}", f"choose --study from {have}")
        number, hashed, name, design, columns, checksum = found[-1]
        if checksum != study_checksum(hashed, name, design, columns):
            message = f"study {number} is damaged"
            raise refused(self.path, message, "run the sweep again with --store")
        told = self._columns(columns)
        count = "SELECT count(*) FROM rows NOT INDEXED WHERE study = ?"  # an index may lack rows
        rows = self.connection.execute(count, (number,)).fetchone()[0]
        if not rows:
            raise refused(self.path, f"study {number} has no rows yet", "run its sweep first")
        failures = self._failures(number, Seals(hashed, len(told)))
        return StoredRows(number, hashed, name, design, told, rows, failures, self._texts(number))

    def _failures(self, number: int, seals: Seals) -> dict[str, int]:
        """Number of failed designs by reason, the most frequent first; damaged rows are ignored."""
        select = f"{_SELECT} AND failure IS NOT NULL"
        reasons = Counter(
            row[2] for row in self.connection.execute(select, (number,)) if seals.fits(*row)
        )
        return dict(sorted(reasons.items(), key=lambda one: (-one[1], one[0])))

    def number(self, hashed: str) -> int:
        """Number of the study with a hash.

        Raises
        ------
        InputError
            no study has this hash
        """
        row = self.connection.execute("SELECT id FROM studies WHERE hash = ?", (hashed,)).fetchone()
        if row is None:
            message = "does not contain this sweep: file, materials or metrics have changed"
            raise refused(self.path, message, "run the sweep again with --store")
        return int(row[0])

    def _columns(self, text: str) -> tuple[Column, ...]:
        try:
            told = json.loads(text)
        except (TypeError, ValueError, RecursionError):
            told = None
        if not isinstance(told, list) or not all(
            isinstance(one, list) and len(one) == len(Column._fields) for one in told
        ):
            raise refused(self.path, "does not name the columns of its rows", "run the sweep again")
        return tuple(Column(*one) for one in told)

    def _texts(self, number: int) -> dict[str, tuple[str, ...]]:
        tables = {row[0] for row in self.connection.execute("SELECT name FROM sqlite_master")}
        if "texts" not in tables:
            return {}
        found: dict[str, tuple[str, ...]] = {}
        select = "SELECT path, text FROM texts WHERE study = ? ORDER BY path, text"
        for path, text in self.connection.execute(select, (number,)):
            found[path] = (*found.get(path, ()), text)
        return found

    def rows(self, study: StoredRows) -> Iterator[tuple[list[bytes], Array]]:
        """Keys and numbers of the successful rows, in batches, ordered by key.

        Keys are hashes: every n-th row gives an even sample of the study. Damaged rows are left
        out.
        """
        select = f"{_SELECT} AND failure IS NULL ORDER BY key"
        cursor = self.connection.execute(select, (study.number,))
        width = len(study.columns)
        seals = Seals(study.hash, width)
        while every := cursor.fetchmany(SOME):
            some = [row for row in every if seals.fits(*row)]
            data = b"".join(row[1] for row in some)
            if some:
                yield [row[0] for row in some], np.frombuffer(data, dtype="<f8").reshape(-1, width)


@contextmanager
def reading(path: Path, version: str) -> Iterator[Reader]:
    """Open a database of sweeps for reading.

    Raises
    ------
    InputError
        no such file, another format, rows of other models, or not readable
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
    """A read-only connection; immutable where no lock file can be created beside the database."""
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
    if not tables >= OURS:
        raise refused(path, "is not a database of sweeps", "name a file written by `sweep --store`")
