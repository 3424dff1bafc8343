import io
import os
import signal
import time

import numpy as np
import pytest

from grasp_core.dataset.store import DatasetStore
from workbench import actions as shell
from workbench.app import Workbench
from workbench.inspector import actions as a
from workbench.inspector.orders import Choice, SceneRequest, Thing
from workbench.inspector.poses import vector

FIRST = SceneRequest((Thing("can_000"),), 1)
BEST = Choice(0, 0)


class Screen:
    """Stands for a browser."""

    def __init__(self):
        self.state = None
        self.notices = []

    def update(self, old, new):
        self.state = new.of["inspect"]

    def perform(self, effect):
        if isinstance(effect, shell.Notice):
            self.notices.append(effect)
        return isinstance(effect, shell.Notice)


def wait(condition, what, seconds=90):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"waited in vain for {what}"
        time.sleep(0.01)


@pytest.fixture(scope="module")
def workbench(tmp_path_factory):
    made = Workbench(port=0, dataset=tmp_path_factory.mktemp("data") / "own", first=FIRST)
    yield made
    made.close()


@pytest.fixture
def browser(workbench):
    session, _ = workbench._sessions.claim(None, {})
    screen = Screen()
    session.attach(screen)
    session.post(shell.Arrive(""))
    wait(lambda: screen.state is not None and screen.state.scene is not None, "the first plan")
    yield session, screen
    session.attach(None)


def test_the_first_scene_is_planned(workbench, browser):
    _, screen = browser
    assert workbench.url.startswith("http://127.0.0.1:")
    assert screen.state.candidates and screen.state.choice == BEST


def test_a_click_is_tried_replayed_judged_and_stored(workbench, browser):
    session, screen = browser
    session.post(a.Select(BEST))
    wait(lambda: screen.state.trial.complete and screen.state.playback is not None, "the trial")
    assert screen.state.playback.attempt.recording is not None
    wait(lambda: screen.state.playback.position > 0.2, "the replay to move")
    session.post(a.Judge("good"))
    wait(lambda: screen.state.verdicts == {BEST: "good"}, "the verdict")
    with DatasetStore.open(workbench.dataset, readonly=True) as store:
        event = store.events()[-1]
        assert (event.kind, event.value, event.source) == ("value", 1.0, "human")
        assert len(store.attempts(event.grasp)) == 5


def test_what_cannot_be_made_is_reported(browser):
    session, screen = browser
    session.post(a.ShowObject("wishful_000"))
    wait(lambda: screen.state.failure is not None, "the failure")
    assert "wishful" in screen.state.failure and screen.notices[-1].tone == "error"


def test_browsers_are_independent(workbench, browser):
    _, screen = browser
    other, _ = workbench._sessions.claim(None, {})
    second = Screen()
    other.attach(second)
    other.post(shell.Arrive(""))
    wait(lambda: second.state is not None and second.state.scene is not None, "the second browser's scene")
    other.post(a.Toggle("camera"))
    wait(lambda: "camera" not in second.state.shown, "the switch")
    assert "camera" in screen.state.shown


def test_a_worker_that_dies_is_reported_and_replaced(workbench, browser):
    session, screen = browser
    found = []
    workbench._physics.submit(found.append, found.append, os.getpid)
    wait(lambda: found, "the worker's number")
    os.kill(found[0], signal.SIGKILL)
    session.post(a.Select(BEST))
    wait(lambda: screen.state.trial.failed or screen.state.trial.complete, "the trial's end")
    wait(lambda: any(notice.title == "Worker replaced" for notice in screen.notices), "the report")
    session.post(a.Select(BEST))
    wait(lambda: screen.state.trial.complete, "the trial of the new worker")
    assert screen.state.trial.failed is None and screen.state.trial.attempts


def test_an_effect_that_nobody_does_is_an_error(workbench, browser):
    with pytest.raises(TypeError):
        workbench._perform(browser[0], shell.Effect())


def test_plans_follow_a_drag_and_the_object_settles(browser):
    session, screen = browser
    start = screen.state.scene.scene.objects[0].world_from_object
    for step in range(1, 6):
        moved = start.copy()
        moved[:3, 3] += [0.01 * step, 0, 0.004 * step]
        session.post(a.Drag(vector(moved), step == 5, time.monotonic()))
        time.sleep(0.05)
    wait(lambda: not screen.state.opening and screen.state.scene.request.things[0].loose, "the last place")
    assert screen.state.live is not None and screen.state.live.latency_ms > 0
    assert screen.state.scene.scene.objects[0].world_from_object == pytest.approx(moved, abs=1e-4)
    session.post(a.Settle())
    wait(lambda: not screen.state.loose and not screen.state.opening, "the rest")
    assert screen.state.scene.scene.objects[0].world_from_object[2, 3] < moved[2, 3] - 0.01


def test_one_place_is_scored_over_all_angles(browser):
    session, screen = browser
    session.post(a.AskPlace(150.0, 150.0))
    wait(lambda: screen.state.place is not None and screen.state.place.scores is not None, "the scores")
    assert len(screen.state.place.scores.candidates) == 36


def test_an_uploaded_image_is_read_by_the_worker(browser):
    session, screen = browser
    content = io.BytesIO()
    np.save(content, screen.state.scene.sight.image.depth)
    session.post(a.ReadPhotosWith("canonical", None, 0.0))
    session.post(a.OpenFile("image", "bad.npy", b"no array"))
    wait(lambda: screen.state.failure is not None, "the refusal")
    assert "bad.npy" in screen.state.failure
    session.post(a.OpenFile("image", "can.npy", content.getvalue()))
    wait(lambda: screen.state.failure is None and not screen.state.opening, "the image")
    assert screen.state.scene.request.photo is not None and screen.state.candidates


def test_all_candidates_are_tried_until_the_job_is_cancelled(browser):
    session, screen = browser
    shown = screen.state.scene_ticket
    session.post(a.Change("threshold", 0.0))
    wait(lambda: screen.state.scene_ticket != shown and not screen.state.opening, "the new plan")
    assert len(screen.state.candidates) > 3
    session.post(a.TryAll())
    wait(lambda: any(trial.complete for trial in screen.state.trials.values()), "the first trial")
    session.post(a.StopTrying())
    wait(lambda: not screen.state.trying, "the end of the trial under way")
    assert screen.state.sweep is None and len(screen.state.trials) < len(screen.state.candidates)
