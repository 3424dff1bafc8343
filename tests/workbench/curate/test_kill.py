"""SIGKILL of the server's desk at any moment loses no decision that a browser was told is saved."""

import random
import signal
import subprocess
import sys
import time

import pytest

from grasp_core.dataset.store import DatasetStore

SESSION = """
import itertools, sys, threading
from pathlib import Path
from grasp_core.gripper import load_gripper
from workbench.curate import actions as a, effects as e
from workbench.curate.desk import Desk
from workbench.curate.values import Decision

desk, first = Desk(Path(sys.argv[1]), load_gripper()), int(sys.argv[2])
answered = threading.Semaphore(0)

def post(answer):
    if isinstance(answer, a.Saved):
        print(answer.decision.note, flush=True)
    if isinstance(answer, a.Saved | a.Conflicted | a.NotSaved):
        answered.release()

print("ready", flush=True)
for number in itertools.count():
    decision = (1.0, 0.0, "unsure", "exclude", "flag", 0.3)[number % 6]
    note = f"kill{first}x{number}"
    desk.perform(post, e.Save(Decision(number % 30 + 1, decision, note, 2**60), "ann"))
    answered.acquire()
"""


@pytest.mark.slow
def test_no_saved_decision_is_lost_at_any_of_fifty_moments(folder):
    draw = random.Random(2)
    told: list[str] = []
    for moment in range(50):
        process = subprocess.Popen(
            [sys.executable, "-c", SESSION, str(folder), str(moment)], stdout=subprocess.PIPE, text=True
        )
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(draw.uniform(0.02, 0.3))
        process.send_signal(signal.SIGKILL)
        told += process.stdout.read().split("\n")[:-1]  # a line that was cut off was not told whole
        process.wait()
        with DatasetStore.open(folder) as store:
            assert set(told) <= {row["note"] for row in store.rows("SELECT note FROM label_events")}
            assert store.differing_labels() == []
            assert store.row("PRAGMA integrity_check")[0] == "ok"
    assert len(told) > 100
