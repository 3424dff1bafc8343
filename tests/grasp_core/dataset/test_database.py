import os
import sqlite3
import threading

import pytest

from grasp_core.dataset import database, schema
from grasp_core.dataset.database import Database
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError


def test_pragmas(store):
    assert store.row("PRAGMA journal_mode")[0] == "wal"
    assert store.row("PRAGMA synchronous")[0] == 2  # FULL
    assert store.row("PRAGMA foreign_keys")[0] == 1
    assert store.row("PRAGMA user_version")[0] == len(schema.MIGRATIONS)
    tables = store.rows("SELECT name, strict FROM pragma_table_list WHERE type = 'table' AND schema = 'main'")
    assert all(row["strict"] for row in tables if not row["name"].startswith("sqlite_"))


def test_missing_and_foreign_files(tmp_path):
    with pytest.raises(StoreError, match="holds no dataset"):
        DatasetStore.open(tmp_path)
    (tmp_path / "dataset.sqlite").write_bytes(b"this is text, not SQLite" * 100)
    with pytest.raises(StoreError, match="no SQLite file"):
        DatasetStore.open(tmp_path)
    other = tmp_path / "other"
    other.mkdir()
    with sqlite3.connect(other / "dataset.sqlite") as db:
        db.execute("CREATE TABLE t (a)")
    with pytest.raises(StoreError, match="no dataset of this project"):
        DatasetStore.open(other)


def test_newer_version_is_refused(store):
    path = store.path
    store.close()
    with sqlite3.connect(path / "dataset.sqlite") as db:
        db.execute("PRAGMA user_version = 99")
    with pytest.raises(StoreError, match="newer version"):
        DatasetStore.open(path)


def test_corrupt_file(store):
    path = store.path
    store.close()
    file = path / "dataset.sqlite"
    data = bytearray(file.read_bytes())
    data[4096 : 4096 * 8] = os.urandom(4096 * 7)
    file.write_bytes(data)
    with pytest.raises(StoreError, match="restore"), DatasetStore.open(path) as broken:
        broken.scenes()
        broken.content_digest()


def test_migration_keeps_everything_and_a_backup(store, monkeypatch):
    before = store.content_digest()
    path = store.path
    store.close()
    script = "CREATE TABLE later (a INTEGER) STRICT;\nINSERT INTO later VALUES (7);\n"
    monkeypatch.setattr(schema, "MIGRATIONS", (*schema.MIGRATIONS, script))
    with pytest.raises(StoreError, match="older format"):
        DatasetStore.open(path, readonly=True)
    with DatasetStore.open(path) as newer:
        assert newer.row("SELECT a FROM later")[0] == 7
        assert newer.row("PRAGMA user_version")[0] == len(schema.MIGRATIONS)
        assert newer.content_digest() == before
    version = len(schema.MIGRATIONS) - 1
    with sqlite3.connect(path / f"dataset.v{version}.backup.sqlite") as backup:
        assert backup.execute("PRAGMA user_version").fetchone()[0] == version
        assert backup.execute("SELECT count(*) FROM grasps").fetchone()[0] == 4


def test_failed_migration_changes_nothing(store, monkeypatch):
    path = store.path
    store.close()
    monkeypatch.setattr(schema, "MIGRATIONS", (*schema.MIGRATIONS, "CREATE TABLE ok (a);\nCREATE TABLE meta (a);\n"))
    with pytest.raises(StoreError, match="meta"):
        DatasetStore.open(path)
    monkeypatch.undo()
    with DatasetStore.open(path) as same:
        assert same.row("SELECT 1 FROM sqlite_schema WHERE name = 'ok'") is None
        assert len(same.scenes()) == 1


def test_transaction_is_all_or_nothing(store):
    with pytest.raises(RuntimeError), store.transaction() as db:
        db.execute("INSERT INTO people (name, added) VALUES ('ann', 0)")
        raise RuntimeError
    assert store.people() == []


def test_readonly(store):
    path = store.path
    with DatasetStore.open(path, readonly=True) as reader:
        assert len(reader.scenes()) == 1
        with pytest.raises(StoreError, match="may not be written"):
            reader.add_label(1, "ann", 1.0)


def test_locked_database_says_so(store, monkeypatch):
    with store.transaction():
        monkeypatch.setattr(database, "_WAIT_MS", 50)
        with DatasetStore.open(store.path) as other, pytest.raises(StoreError, match="locked"):
            other.add_label(1, "ann", 1.0)


def test_full_disk_says_so_and_loses_nothing(store):
    pages = store.row("PRAGMA page_count")[0]
    store.row(f"PRAGMA max_page_count = {pages}")
    with pytest.raises(StoreError, match="disk is full"):
        for _ in range(500):
            store.add_label(1, "ann", "note", note="x" * 1000)
    saved = len(store.history(1))
    path = store.path
    store.close()
    with DatasetStore.open(path) as again:
        assert len(again.history(1)) == saved


def test_threads_share_one_connection(store):
    def label(grasp):
        for value in range(10):
            store.add_label(grasp, f"person {grasp}", value / 10)

    threads = [threading.Thread(target=label, args=(grasp,)) for grasp in (1, 2, 3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [len(store.history(grasp)) for grasp in (1, 2, 3)] == [10, 10, 10]


def test_backup_is_consistent(store, tmp_path):
    target = tmp_path / "copy.sqlite"
    store.backup(target)
    with sqlite3.connect(target) as db:
        assert db.execute("PRAGMA integrity_check").fetchone()[0] == "ok"
    assert isinstance(store, Database)


def test_rows_one_by_one_may_be_left_early(store):
    for row in store.each("SELECT grasp FROM samples ORDER BY grasp"):
        assert row["grasp"] == 1
        break
    store.add_label(1, "ann", 0.0)  # nothing is locked any more
    assert len(list(store.each("SELECT grasp FROM samples"))) == len(store.rows("SELECT grasp FROM samples"))
    with pytest.raises(StoreError, match="no such table"):
        list(store.each("SELECT 1 FROM nowhere"))
