import numpy as np
import pytest

from grasp_core.errors import GraspError
from workbench.inspector.orders import SceneRequest
from workbench.inspector.workshop import open_scene, prepare, record_attempt, run_trial

REQUEST = SceneRequest("can", 0, 0, 1, "antipodal")


@pytest.fixture(scope="module")
def scene():
    prepare()
    return open_scene(REQUEST)


def test_a_scene_comes_planned(scene):
    assert scene.request == REQUEST
    assert scene.poses == len(scene.rests) >= 1 and 0 < scene.probability <= 1
    assert scene.image.depth.shape == scene.clean.depth.shape
    assert np.abs(scene.image.depth - scene.clean.depth).max() > 0, "planned on a noisy image"
    scores = [candidate.score for candidate in scene.plan.candidates]
    assert scores and scores == sorted(scores, reverse=True)
    assert {"object", "settle", "render", "plan"} <= set(scene.stages_ms)


def test_poses_wrap_around(scene):
    again = open_scene(SceneRequest("can", 0, scene.poses, 1, "antipodal"))
    assert again.request.pose == 0
    assert np.allclose(again.scene.objects[0].world_from_object, scene.scene.objects[0].world_from_object)


def test_the_replayed_attempt_is_one_of_the_trial(scene):
    grasp = scene.plan.candidates[0].grasp
    made = run_trial(scene.scene, grasp, 3)
    assert [attempt.number for attempt in made] == [0, 1, 2]
    for number in (2, 0):
        shown = record_attempt(scene.scene, grasp, number)
        assert (shown.outcome, shown.seed, shown.executed) == (
            made[number].outcome, made[number].seed, made[number].executed,
        )  # fmt: skip
        assert shown.recording is not None and len(shown.recording.times) > 5
        assert made[number].recording is None
        assert shown.words


def test_what_does_not_exist_is_refused():
    with pytest.raises(GraspError):
        open_scene(SceneRequest("rocket", 0, 0, 1, "antipodal"))
    with pytest.raises(GraspError):
        open_scene(SceneRequest("can", 0, 0, 1, "wishful"))
