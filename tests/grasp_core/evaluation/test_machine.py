import json
import subprocess
import sys
import time

import pytest

from grasp_core.evaluation import machine as machine_module
from grasp_core.evaluation.machine import Machine, Watch, envelope, machine, print_envelope, versions
from grasp_core.evaluation.report import pool

LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the load of others is read from /proc")


def spin(seconds: float) -> None:
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


@LINUX
def test_own_work_is_not_taken_for_others(monkeypatch):
    # System totals move with whatever else runs here, so the whole machine is replaced by this process alone.
    monkeypatch.setattr(machine_module, "_busy_seconds", time.process_time)
    watch = Watch()
    spin(0.4)
    others = watch.others()
    assert others is not None and others < 0.1


@LINUX
def test_work_of_living_children_is_ones_own():
    before = machine_module._own_seconds()
    child = subprocess.Popen(
        [sys.executable, "-c", "import time\nwhile time.process_time() < 0.5: pass\nprint('x', flush=True)\ninput()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    assert child.stdout is not None
    child.stdout.read(1)
    during = machine_module._own_seconds()
    child.communicate(b"\n")
    after = machine_module._own_seconds()
    assert before is not None and during is not None and after is not None
    assert during - before >= 0.45
    assert after >= during - 0.02  # counted once, before and after it was waited for


@LINUX
def test_what_ends_after_a_stopped_watch_is_not_taken_for_others(monkeypatch):
    # A child that ends its own child without waiting for it, as browsers do: that work then belongs to nobody.
    orphan = "import time\nwhile time.process_time() < 0.5: pass\nprint('x', flush=True)\ntime.sleep(60)"
    start = f"import os, subprocess, sys\nchild = subprocess.Popen([sys.executable, '-c', {orphan!r}])"
    parent = f"{start}\ninput()\nchild.kill()\nos._exit(0)"
    mine = machine_module._own_seconds
    monkeypatch.setattr(machine_module, "_busy_seconds", lambda: most[0])
    most = [mine()]
    stopped, going = Watch(), Watch()
    child = subprocess.Popen([sys.executable, "-c", parent], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert child.stdout is not None
    child.stdout.read(1)
    most[0] = mine()
    stopped.stop()
    child.communicate(b"\n")
    lost, seen = going.others(), stopped.others()
    assert lost is not None and seen is not None
    assert seen < 0.05 and lost * going.seconds > 0.4


@LINUX
def test_other_work_makes_the_machine_busy(monkeypatch):
    clock = iter([100.0, 105.0])
    monkeypatch.setattr(machine_module, "_busy_seconds", lambda: next(clock))
    watch = Watch()
    time.sleep(0.1)
    found = machine(watch)
    assert found.busy is True and found.other_load is not None and found.other_load > 1


def test_where_the_load_is_unknown_nothing_is_claimed(monkeypatch):
    monkeypatch.setattr(machine_module, "_busy_seconds", lambda: None)
    watch = Watch()
    time.sleep(0.06)
    found = machine(watch)
    assert isinstance(found, Machine) and found.busy is None and found.other_load is None
    assert found.cores >= 1 and found.cpu


def test_versions_name_python_and_what_is_installed():
    found = versions()
    assert found["python"].split(".")[0] == "3"
    assert {"numpy", "dartpy", "grasp-workbench"} <= set(found)


def test_envelope_is_one_json_object_with_the_keys_of_the_contract(capsys):
    report = envelope("success", 0, {"rate": pool([1], [2])}, Watch())
    print_envelope(report, json=True, text="not this")
    out = capsys.readouterr().out
    back = json.loads(out)
    assert set(back) == {"benchmark", "machine", "versions", "seed", "results"}
    assert back["seed"] == 0 and back["results"]["rate"]["attempts"] == 2
    assert out.count("\n") == 1


def test_a_busy_machine_is_said_on_stderr_only(capsys):
    report = envelope("latency", 1, {}, Watch())
    report["machine"].update(busy=True, other_load=1.5)
    print_envelope(report, json=False, text="the table")
    captured = capsys.readouterr()
    assert captured.out == "the table\n"
    assert "1.5 of" in captured.err and "idle" in captured.err
    report["machine"]["busy"] = False
    print_envelope(report, json=False, text="the table")
    assert capsys.readouterr().err == ""
