import contextlib
import os
import signal
import threading
import time

import pytest

from grasp_core.gripper import load_gripper
from workbench.jobs import Jobs


class Waiter:
    def __init__(self):
        self.result = self.reason = None
        self._event = threading.Event()

    def done(self, result):
        self.result = result
        self._event.set()

    def failed(self, reason):
        self.reason = reason
        self._event.set()

    def wait(self):
        assert self._event.wait(60), "no answer from the worker"
        return self


@pytest.fixture(scope="module")
def lost():
    return []


@pytest.fixture(scope="module")
def jobs(lost):
    made = Jobs("testing", on_lost=lost.append)
    yield made
    made.close()


def ask(jobs, work, *args):
    waiter = Waiter()
    jobs.submit(waiter.done, waiter.failed, work, *args)
    return waiter


def test_work_is_done_in_another_process(jobs):
    assert ask(jobs, os.getpid).wait().result not in (None, os.getpid())
    assert ask(jobs, divmod, 17, 5).wait().result == (3, 2)


def test_errors_come_back_as_one_line(jobs):
    assert (
        ask(jobs, load_gripper, "tentacle").wait().reason.startswith("no grippers configuration is called 'tentacle'")
    )
    assert ask(jobs, divmod, 1, 0).wait().reason.startswith("ZeroDivisionError: ")


def test_a_killed_worker_is_reported_and_replaced(jobs, lost):
    before = ask(jobs, os.getpid).wait().result
    stuck = ask(jobs, time.sleep, 60)
    waiting = ask(jobs, os.getpid)
    time.sleep(0.2)
    lost.clear()
    os.kill(before, signal.SIGKILL)
    assert "died" in stuck.wait().reason and "died" in waiting.wait().reason
    after = ask(jobs, os.getpid).wait().result
    assert after not in (None, before)
    assert len(lost) == 1, "told once, however many jobs were lost"


def test_a_job_for_a_worker_that_died_idle_goes_to_the_next_one(jobs, lost):
    before = ask(jobs, os.getpid).wait().result
    lost.clear()
    os.kill(before, signal.SIGKILL)
    deadline = time.monotonic() + 30
    while not jobs._pool._broken and time.monotonic() < deadline:
        time.sleep(0.01)
    answer = ask(jobs, os.getpid).wait()
    assert answer.reason is None and answer.result not in (None, before)
    assert len(lost) == 1


def test_ctrl_c_does_not_reach_the_worker(jobs):
    worker = ask(jobs, os.getpid).wait().result
    os.kill(worker, signal.SIGINT)
    assert ask(jobs, os.getpid).wait().result == worker


def test_closing_ends_the_worker():
    jobs = Jobs("testing")
    worker = ask(jobs, os.getpid).wait().result
    jobs.close()
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        try:
            os.kill(worker, 0)
        except ProcessLookupError:
            break
        with contextlib.suppress(ChildProcessError):
            os.waitpid(worker, os.WNOHANG)
        time.sleep(0.05)
    else:
        pytest.fail("the worker still runs")
    jobs.submit(lambda result: None, lambda reason: None, os.getpid)  # nothing happens, nothing is raised
