from dataclasses import replace

from workbench.inspector import scenes as module
from workbench.inspector.scenes import Scenes


class Jobs:
    """Keeps what was asked for until it is answered."""

    def __init__(self):
        self.asked = []

    def submit(self, done, failed, work, request):
        self.asked.append((done, failed, request))


def test_a_scene_is_made_once_for_all_who_want_it(opened):
    jobs = Jobs()
    scenes, got = Scenes(jobs), []
    for _ in range(3):
        scenes.open(opened.request, got.append, got.append)
    assert len(jobs.asked) == 1
    jobs.asked[0][0](opened)
    assert got == [opened] * 3
    scenes.open(opened.request, got.append, got.append)
    assert len(jobs.asked) == 1 and got == [opened] * 4


def test_a_failure_reaches_all_and_is_not_remembered(opened):
    jobs = Jobs()
    scenes, got = Scenes(jobs), []
    scenes.open(opened.request, got.append, got.append)
    scenes.open(opened.request, got.append, got.append)
    jobs.asked[0][1]("the worker died")
    assert got == ["the worker died"] * 2
    scenes.open(opened.request, got.append, got.append)
    assert len(jobs.asked) == 2


def test_only_so_many_are_kept(opened, monkeypatch):
    monkeypatch.setattr(module, "MOST", 2)
    jobs = Jobs()
    scenes = Scenes(jobs)
    for shape in range(3):
        scenes.open(replace(opened.request, shape=shape), lambda scene: None, lambda reason: None)
        jobs.asked[-1][0](opened)
    scenes.open(replace(opened.request, shape=0), lambda scene: None, lambda reason: None)
    assert len(jobs.asked) == 4, "the oldest was forgotten"
