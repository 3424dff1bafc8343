"""SIGKILL at any moment of a labelling session loses no label that was reported as saved."""

import os
import random
import signal
import sqlite3
import subprocess
import sys
import time

import pytest

from grasp_core.dataset.store import DatasetStore

SESSION = """
import random, sys
from grasp_core.dataset.bulk import label_all, plan_bulk
from grasp_core.dataset.queries import Query
from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.undo import undo, redo
from grasp_core.grasp import Grasp

store, draw = DatasetStore.open(sys.argv[1]), random.Random(int(sys.argv[2]))
print("ready", flush=True)
step = 0
while True:
    step += 1
    grasp, kind = draw.randint(1, 4), draw.random()
    if kind < 0.6:
        events = [store.add_label(grasp, "ann", draw.choice([0.0, 1.0, 0.25, "unsure", "exclude", "flag"]), note="rim")]
    elif kind < 0.7:
        events = undo(store, "ann")
    elif kind < 0.75:
        events = redo(store, "ann")
    elif kind < 0.85:
        seed = draw.getrandbits(40)
        events = [store.add_attempts(grasp, [AttemptRow("MISSED", seed, (0.0, 0.0, 0.0, 0.0))], person="ann")]
    elif kind < 0.95:
        bulk = label_all(store, Query(), "ann", 0.5, plan_bulk(store, Query(), 0.5))
        events = store.batch(bulk.batch)
    else:
        new = store.add_grasp(1, Grasp((draw.random(), 0.0, 0.02), 0.0, 0.1), person="ann", parent=grasp)
        events = [store.add_label(new, "ann", 1.0)]
    for event in events:
        print(event.uid, flush=True)
"""


@pytest.mark.slow
def test_no_saved_label_is_lost_at_any_of_sixty_moments(store, tmp_path):
    path = store.path
    store.close()
    draw = random.Random(1)
    saved: list[str] = []
    for moment in range(60):
        process = subprocess.Popen(
            [sys.executable, "-c", SESSION, str(path), str(moment)], stdout=subprocess.PIPE, text=True, env=os.environ
        )
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(draw.uniform(0.0, 0.4))
        process.send_signal(signal.SIGKILL)
        told = process.stdout.read().split("\n")
        process.wait()
        saved += [uid for uid in told[:-1] if uid]  # a line that was cut off was not told whole
        with DatasetStore.open(path) as found:
            assert set(saved) <= {row["uid"] for row in found.rows("SELECT uid FROM label_events")}
            assert found.differing_labels() == []
            batches = found.rows(
                "SELECT count(*) AS n FROM label_events WHERE kind = 'value' AND batch IS NOT NULL GROUP BY batch"
            )
            grasps = found.rows("SELECT count(*) FROM grasps")[0][0]
            assert all(4 <= row["n"] <= grasps for row in batches)  # a bulk action is whole
    with sqlite3.connect(path / "dataset.sqlite") as db:
        assert db.execute("PRAGMA integrity_check").fetchone()[0] == "ok"
    assert len(saved) > 200
