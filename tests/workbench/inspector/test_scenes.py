import pytest

from workbench.inspector import scenes as module
from workbench.inspector.orders import SceneRequest, Thing
from workbench.inspector.scenes import Scenes
from workbench.inspector.setup import DEFAULT


class Jobs:
    """Remembers what it was asked for; `finish` answers."""

    def __init__(self):
        self.asked = []

    def submit(self, done, failed, work, *args):
        self.asked.append((done, failed, args))


@pytest.fixture
def jobs():
    return Jobs()


@pytest.fixture
def scenes(jobs):
    return Scenes(jobs, lambda: {"mesh-1": "/a"})


def request(number):
    return SceneRequest((Thing(f"mug_{number:03d}"),))


def test_a_scene_is_made_once_for_all_who_want_it(scenes, jobs, opened):
    got = []
    for _ in range(3):
        scenes.open(request(1), DEFAULT, got.append, got.append)
    assert len(jobs.asked) == 1 and jobs.asked[0][2] == (request(1), DEFAULT, {"mesh-1": "/a"})
    jobs.asked[0][0](opened)
    scenes.open(request(1), DEFAULT, got.append, got.append)
    assert got == [opened] * 4 and len(jobs.asked) == 1


def test_failures_reach_all_and_are_not_remembered(scenes, jobs):
    got = []
    scenes.open(request(1), DEFAULT, print, got.append)
    scenes.open(request(1), DEFAULT, print, got.append)
    jobs.asked[0][1]("no")
    assert got == ["no", "no"]
    scenes.open(request(1), DEFAULT, print, got.append)
    assert len(jobs.asked) == 2


def test_old_scenes_are_forgotten(scenes, jobs, opened):
    for number in range(module.MOST + 1):
        scenes.open(request(number), DEFAULT, lambda scene: None, print)
        jobs.asked[-1][0](opened)
    scenes.open(request(0), DEFAULT, lambda scene: None, print)
    assert len(jobs.asked) == module.MOST + 2
