import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from grasp_core.errors import StoreError
from workbench.actions import Effect, Notice
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.desk import Desk
from workbench.inspector.orders import Choice
from workbench.inspector.setup import DEFAULT


class Jobs:
    """Answers at once with what it is told to."""

    def __init__(self):
        self.asked = []
        self.answer = None
        self.failure = None

    def submit(self, done, failed, work, *args):
        self.asked.append((work.__name__, args))
        if self.failure is not None:
            failed(self.failure)
        elif self.answer is not None:
            done(self.answer)


class Ledger:
    def __init__(self):
        self.thread = ThreadPoolExecutor(1)

    def record(self, *args):
        raise StoreError("disk full")


@pytest.fixture
def planning():
    return Jobs()


@pytest.fixture
def physics():
    return Jobs()


@pytest.fixture
def desk(planning, physics, state):
    made = Desk(planning, physics, Ledger(), state.request)
    yield made
    made.close()


def wait(posted):
    deadline = time.monotonic() + 5
    while not posted:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return posted[0]


FIRST = Choice(0, 0)


def test_the_first_scene_is_under_way_before_anybody_asks(desk, planning):
    assert [name for name, _ in planning.asked] == ["open_scene"]


@pytest.mark.parametrize(
    ("make", "worker", "job", "answer"),
    [
        (lambda s: e.SeeScene(1, s.request, DEFAULT, None), "planning", "see", r.Seen),
        (
            lambda s: e.ScorePlace(1, s, s.sight.image.camera, 5.0, 6.0),
            "planning",
            "ask_place",
            r.PlaceScored,
        ),
        (lambda s: e.SettleScene(1, s.request, DEFAULT), "physics", "settle_scene", r.Settled),
        (lambda s: e.RecordAttempt(1, s, FIRST, 2), "physics", "record_attempt", r.Replayed),
        (lambda s: e.RunTrial(1, s, FIRST), "physics", "run_trial", r.Tried),
    ],
)
def test_effects_become_jobs_and_answers(desk, planning, physics, opened, make, worker, job, answer):
    jobs, posted = {"planning": planning, "physics": physics}[worker], []
    jobs.answer = "found"
    assert desk.perform(posted.append, make(opened))
    assert jobs.asked[-1][0] == job and isinstance(posted[0], answer) and posted[0].ticket == 1
    jobs.failure = "no"
    desk.perform(posted.append, make(opened))
    assert type(posted[1]).__name__.endswith("Failed") and posted[1].reason == "no"


def test_a_page_gets_a_name(desk, physics, opened, attempt):
    physics.answer, posted = b"<html>", []
    desk.perform(posted.append, e.WritePage(opened, FIRST, attempt(1)))
    assert posted == [r.ReplaySaved("box_003-1-2.html", b"<html>")]


def test_expected_trials_answer_that_they_are_there(desk, physics, opened):
    physics.answer, posted = "done", []
    desk.perform(posted.append, e.ExpectTrial(7, opened, FIRST))
    assert physics.asked[-1][0] == "expect_attempt" and posted == [r.Expected(7, FIRST)]


def test_files_are_kept_or_refused_in_words(desk, tmp_path):
    posted = []
    desk.perform(posted.append, e.KeepFile("mesh", "a.stl", b"x", "mm"))
    assert wait(posted).items[0].name == "a.stl" and desk.shelf.files
    for effect in (e.KeepFile("mesh", "a.exe", b"x", "m"), e.ReadFolder("image", str(tmp_path / "none"), "")):
        posted.clear()
        desk.perform(posted.append, effect)
        assert isinstance(wait(posted), Notice)


def test_a_camera_file_of_no_use_is_told(desk, planning):
    posted = []
    assert desk.perform(posted.append, e.CheckCamera("camera-1")) and planning.asked[-1][0] == "check_camera"
    planning.failure = "cam.yaml: fx is missing"
    desk.perform(posted.append, e.CheckCamera("camera-1"))
    assert posted == [Notice("warning", "This camera file is of no use", "cam.yaml: fx is missing")]


def test_verdicts_that_cannot_be_stored_are_told(desk, opened):
    posted = []
    desk.perform(posted.append, e.StoreVerdict(3, opened, FIRST, "good", ()))
    assert wait(posted) == r.JudgeFailed(3, "disk full")


def test_effects_of_others_are_left_alone(desk):
    assert not desk.perform(print, Effect())
