import cv2
import pytest

from grasp_core.evaluation import disagreements as module
from grasp_core.evaluation.disagreements import disagreements
from grasp_core.evaluation.suites import object_plans, poses_of
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.scene import Scene
from grasp_core.simulation.crosscheck import Judge
from grasp_core.simulation.physics import load_physics

GRIPPER, PHYSICS = load_gripper(), load_physics()


@pytest.fixture(scope="module")
def scene():
    source = next(plan for plan in object_plans("trials", "keep", 0) if plan.name == "box_900")
    asset = source.make()
    return Scene.single(asset, poses_of(asset, PHYSICS)[0].pose)


@pytest.fixture
def find(scene, tmp_path, monkeypatch):
    """Disagreements, with grasps in the air above the box: every film ends MISSED."""
    titles = []
    real = module.filmstrip

    def strip(*arguments, title):
        titles.append(title)
        return real(*arguments, title=title)

    monkeypatch.setattr(module, "filmstrip", strip)

    def run(first, second):
        air = Grasp((0.0, 0.3, 0.1), 0.0, 0.1)
        found = disagreements(first, second, "half", lambda key: (scene, air), GRIPPER, PHYSICS, tmp_path)
        return found, titles

    return run


def test_every_class_of_different_outcomes_is_counted_by_object(find):
    first = {("a", 0, 0): "MISSED", ("b", 0, 0): "MISSED", ("b", 0, 1): "MISSED", ("b", 1, 0): "SUCCESS"}
    second = {("a", 0, 0): "SLIPPED", ("b", 0, 0): "SLIPPED", ("b", 0, 1): "SLIPPED", ("b", 1, 0): "SUCCESS"}
    found, titles = find(first, second)
    assert set(found) == {"MISSED→SLIPPED"}
    each = found["MISSED→SLIPPED"]
    assert each.count == 3
    assert list(each.objects.items()) == [("b", 2), ("a", 1)]
    assert each.filmed == 2, "those of the object with most"
    assert not each.as_judged
    assert each.words["half"].startswith("MISSED: closed on nothing")
    assert all("NO FILM TRIED ENDS AS JUDGED" in title for title in titles)
    picture = cv2.imread(each.picture)
    assert picture is not None
    assert picture.std() > 10


def test_the_first_film_that_ends_as_judged_is_shown(find, monkeypatch):
    calls = []
    real = Judge.record

    def record(self, grasp):
        film = real(self, grasp)
        calls.append(film)
        ends = ["SLIPPED", "MISSED", "SLIPPED", "SUCCESS"][len(calls) - 1]
        object.__setattr__(film, "outcome", ends)
        return film

    monkeypatch.setattr(Judge, "record", record)
    keys = [("a", 0, number) for number in range(3)]
    found, titles = find(dict.fromkeys(keys, "SLIPPED"), dict.fromkeys(keys, "SUCCESS"))
    each = found["SLIPPED→SUCCESS"]
    assert each.as_judged
    assert each.filmed == 2
    assert each.words["half"].startswith("SUCCESS: ")
    assert titles[0].startswith("dart on box_900, judged SLIPPED; film SLIPPED: ")


def test_diverged_executions_are_no_class(find):
    found, titles = find({("a", 0, 0): "UNSTABLE"}, {("a", 0, 0): "SUCCESS"})
    assert found == {}
    assert titles == []
