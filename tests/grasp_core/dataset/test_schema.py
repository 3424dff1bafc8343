import sqlite3

import pytest

from grasp_core.dataset import schema
from grasp_core.errors import StoreError


def test_label_events_cannot_be_changed_or_removed(store):
    store.add_label(1, "ann", 1.0)
    with pytest.raises(StoreError, match="append-only"), store.transaction() as db:
        db.execute("UPDATE label_events SET value = 0")
    with pytest.raises(StoreError, match="append-only"), store.transaction() as db:
        db.execute("DELETE FROM label_events")
    assert store.history(1)[0].value == 1.0


def test_foreign_keys_and_types_hold(store):
    with pytest.raises(StoreError, match="FOREIGN KEY"), store.transaction() as db:
        db.execute("INSERT INTO attempts VALUES (999, 0, 'SUCCESS', 1, 0, 0, 0, 0, 0, 0, NULL, NULL, NULL, NULL)")
    with pytest.raises(StoreError, match="cannot store TEXT"), store.transaction() as db:
        db.execute("UPDATE grasps SET x = 'left'")


def test_released_scripts_run_on_an_empty_file():
    db = sqlite3.connect(":memory:")
    for script in schema.MIGRATIONS:
        db.executescript(script)
    assert db.execute("SELECT count(*) FROM samples").fetchone() == (0,)
