"""One connection to a dataset's SQLite file: opening, versions, transactions, and errors in plain words."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Self

from grasp_core.dataset import schema
from grasp_core.errors import StoreError

FILE = "dataset.sqlite"
"""Name of the SQLite file in a dataset's folder."""

_WAIT_MS = 10_000
_WAYS_OUT = {
    "SQLITE_BUSY": "is locked by another program for more than 10 s; close that program, or wait and try again",
    "SQLITE_LOCKED": "is locked by another program; close that program, or wait and try again",
    "SQLITE_READONLY": "may not be written; give write permission to the file and its folder, or work on a copy",
    "SQLITE_FULL": "cannot grow: the disk is full; make room and try again, nothing written before is lost",
    "SQLITE_IOERR": "cannot be read or written: the disk reports an error; check it, then restore a backup",
    "SQLITE_CORRUPT": "is damaged; restore a backup (dataset.v*.backup.sqlite) or run `grasp-core dataset verify`",
    "SQLITE_NOTADB": "is no SQLite file; give the folder of a dataset",
    "SQLITE_CANTOPEN": "cannot be opened; check that the folder exists and may be read and written",
}


def explain(error: sqlite3.Error, path: Path) -> StoreError:
    """A clear error for what SQLite reports, with the way out."""
    name = str(getattr(error, "sqlite_errorname", ""))
    for code, text in _WAYS_OUT.items():
        if name == code or name.startswith(code + "_"):
            return StoreError(f"{path}: {text}")
    return StoreError(f"{path}: {error}")


class Database:
    """A connection to `path`/dataset.sqlite, safe to share between threads; use as a context manager or `close` it.

    Every write happens in `transaction`, and is on disk (WAL, synchronous FULL) when that block ends.
    """

    def __init__(self, path: Path, *, readonly: bool = False, create: bool = False) -> None:
        """Connect; `create`, `open` of DatasetStore are the way for others.

        Raises:
            StoreError: missing, foreign, corrupt, newer, locked or unreadable file.
        """
        if sqlite3.sqlite_version_info < (3, 37):
            raise StoreError(
                f"this Python's SQLite is {sqlite3.sqlite_version}, datasets need 3.37; use a newer Python"
            )
        self.path = path
        self.readonly = readonly
        self.file = path / FILE
        self._lock = threading.RLock()
        if not create and not self.file.is_file():
            raise StoreError(f"{path}: holds no dataset ({FILE} is not there); make one with `grasp-core generate`")
        with self._explained():
            self._db = self._connect()
        try:
            with self._explained():
                self._prepare(create)
        except BaseException:
            self._db.close()
            raise

    def _connect(self) -> sqlite3.Connection:
        mode = "ro" if self.readonly else "rwc"
        uri = f"{self.file.resolve().as_uri()}?mode={mode}"
        db = sqlite3.connect(uri, uri=True, timeout=_WAIT_MS / 1000, isolation_level=None, check_same_thread=False)
        if not self.readonly:
            return db
        try:
            db.execute("SELECT count(*) FROM sqlite_schema").fetchone()
            return db
        except sqlite3.OperationalError:  # WAL needs a writable folder, unless nobody can write at all
            db.close()
            return sqlite3.connect(uri + "&immutable=1", uri=True, isolation_level=None, check_same_thread=False)

    def _prepare(self, create: bool) -> None:
        db = self._db
        db.row_factory = sqlite3.Row
        db.execute(f"PRAGMA busy_timeout = {_WAIT_MS}")
        version = int(db.execute("PRAGMA user_version").fetchone()[0])
        newest = len(schema.MIGRATIONS)
        if not create:
            application = int(db.execute("PRAGMA application_id").fetchone()[0])
            if application != schema.APPLICATION_ID:
                raise StoreError(f"{self.file}: is an SQLite file, but no dataset of this project; give another folder")
            if version > newest:
                raise StoreError(
                    f"{self.file}: was written by a newer version (format {version}, this one knows {newest});"
                    " update with `pip install -U grasp-workbench`"
                )
            if version < newest and self.readonly:
                raise StoreError(
                    f"{self.file}: has the older format {version}; `grasp-core dataset verify --mend` brings it to"
                    f" format {newest} and keeps a backup"
                )
        if not self.readonly:
            db.execute("PRAGMA journal_mode = WAL")
            db.execute("PRAGMA synchronous = FULL")
        db.execute("PRAGMA foreign_keys = ON")
        db.execute("PRAGMA cache_size = -65536")
        db.execute("PRAGMA temp_store = MEMORY")
        if version < newest:
            if version > 0:
                self.backup(self.path / f"dataset.v{version}.backup.sqlite")
            self._migrate(newest)

    def _migrate(self, newest: int) -> None:
        with self.transaction():
            # asked again inside the transaction: another program may have migrated meanwhile
            version = int(self._db.execute("PRAGMA user_version").fetchone()[0])
            for script in schema.MIGRATIONS[version:newest]:
                for statement in _statements(script):
                    self._db.execute(statement)
            self._db.execute(f"PRAGMA application_id = {schema.APPLICATION_ID}")
            self._db.execute(f"PRAGMA user_version = {newest}")

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise explain(error, self.file) from error

    @contextmanager
    def transaction(self) -> Iterator[sqlite3.Connection]:
        """A write transaction: all of it is durable when the block ends, nothing of it when the block raises.

        Raises:
            StoreError: read-only, locked, full or damaged.
        """
        with self._lock, self._explained():
            if self.readonly:
                raise StoreError(f"{self.file}: {_WAYS_OUT['SQLITE_READONLY']}")
            if self._db.in_transaction:
                yield self._db  # a step of an outer transaction
                return
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield self._db
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def rows(self, query: str, values: Sequence[Any] = ()) -> list[sqlite3.Row]:
        """All rows of one reading query."""
        with self._lock, self._explained():
            return self._db.execute(query, values).fetchall()

    def each(self, query: str, values: Sequence[Any] = ()) -> Iterator[sqlite3.Row]:
        """The rows of one reading query one by one; whoever stops early saves finding the others."""
        with self._lock, self._explained():
            yield from self._db.execute(query, values)

    def row(self, query: str, values: Sequence[Any] = ()) -> sqlite3.Row | None:
        """The first row of one reading query, or None."""
        with self._lock, self._explained():
            found: sqlite3.Row | None = self._db.execute(query, values).fetchone()
            return found

    def backup(self, target: Path) -> None:
        """Write a consistent copy of the SQLite file (not of the images) while others may work on it.

        Raises:
            StoreError: the copy cannot be written.
        """
        part = target.with_name(target.name + ".part")
        with self._lock, self._explained():
            part.unlink(missing_ok=True)
            copy = sqlite3.connect(part)
            try:
                self._db.backup(copy)
            finally:
                copy.close()
            part.replace(target)

    def close(self) -> None:
        """Close the connection; nothing is lost by not calling it, and twice is fine."""
        with self._lock:
            if not self.readonly:
                with suppress(sqlite3.Error):  # only statistics for faster lists
                    self._db.execute("PRAGMA optimize")
            self._db.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _statements(script: str) -> Iterator[str]:
    """The statements of a script one by one (`executescript` would commit the transaction under way)."""
    pending = ""
    for line in script.splitlines(keepends=True):
        pending += line
        if sqlite3.complete_statement(pending):
            yield pending
            pending = ""
    if pending.strip():
        yield pending
