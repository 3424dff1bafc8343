import msgspec
import numpy as np
import pytest

from grasp_core.errors import GraspError
from grasp_core.sensing.renderer import Renderer
from workbench.inspector.orders import Photo, SceneRequest, Thing
from workbench.inspector.poses import vector
from workbench.inspector.setup import DEFAULT
from workbench.inspector.worker.sights import ask_place, open_scene, see

CAN = SceneRequest((Thing("can_000"),), 3)


@pytest.fixture(scope="module")
def opened():
    return open_scene(CAN, msgspec.structs.replace(DEFAULT, beside="antipodal"), {})


def test_a_scene_is_seen_and_planned_on_by_both_planners(opened):
    cascade, antipodal = opened.sight.plans
    assert cascade.quality_map.any() and not antipodal.quality_map.any()
    assert opened.sight.failures == ("", "")
    assert {"scene", "render", "load planner"} <= set(opened.sight.stages_ms)
    for plan, crops in zip(opened.sight.plans, opened.sight.crops, strict=True):
        assert crops.shape == (len(plan.candidates), 48, 48) and plan.scored == plan.candidates


def test_the_same_request_gives_the_same_plan(opened):
    again = open_scene(opened.request, opened.setup, {})
    assert np.array_equal(again.sight.image.depth, opened.sight.image.depth)
    assert again.candidates(0) == opened.candidates(0)


def test_a_moved_object_is_seen_where_it_is(opened):
    pose = opened.scene.objects[0].world_from_object.copy()
    pose[0, 3] += 0.05
    moved = see(CAN.moved(0, Thing("can_000", 0, vector(pose))), opened.setup, {})
    shift = _middle(moved.image) - _middle(opened.sight.image)
    assert shift[0] == pytest.approx(0.05 * 525 / 0.65, abs=5) and abs(shift[1]) < 2


def _middle(image):
    return np.array([axis.mean() for axis in np.nonzero(image.depth < 0.69)[::-1]])


def test_settings_reach_planner_camera_and_noise():
    setup = msgspec.structs.replace(
        DEFAULT, planner="antipodal", candidates=2, camera="primesense", tilt=10, sigma_u=0.0, sigma_v=0.0, sigma_d=0.0
    )
    opened = open_scene(CAN, setup, {})
    assert len(opened.candidates(0)) <= 2 and opened.sight.image.depth.shape == (480, 640)
    assert np.array_equal(opened.sight.image.depth, Renderer(opened.scene).render().depth)


def test_weights_of_another_gripper_fail_one_plan_not_the_scene():
    opened = open_scene(CAN, msgspec.structs.replace(DEFAULT, gripper="compact", beside="antipodal"), {})
    assert opened.sight.plans[0] is None and "gripper" in opened.sight.failures[0]
    assert opened.sight.plans[1] is not None and opened.sight.crops[1] is None
    with pytest.raises(GraspError, match="gripper"):
        ask_place(opened.sight.image, opened.sight.plans[1].canvas.camera, opened.setup, 150, 150)


def test_a_place_is_scored_over_all_angles(opened):
    candidate = opened.candidates(0)[0]
    canvas = opened.sight.plans[0].canvas.camera
    seen = canvas.project(np.array([*candidate.grasp.position[:2], 0.05]))
    found = ask_place(opened.sight.image, canvas, opened.setup, float(seen[0]), float(seen[1]))
    assert len(found.candidates) == 36 and found.height > 0.01
    assert found.best is not None and found.candidates[found.best].score > 0.3


def test_an_own_image_is_planned_on(tmp_path, opened):
    path = tmp_path / "aa--can.npy"
    np.save(path, opened.sight.image.depth)
    photo = Photo("image-a", "canonical")
    own = open_scene(SceneRequest((), 1, photo), DEFAULT, {"image-a": str(path)})
    assert own.scene.objects == ()
    assert own.sight.plans[0].camera.world_from_camera is not None, "the table plane was found"
    assert own.candidates(0)


def test_t_does_not_bind_planners_without_networks():
    opened = open_scene(CAN, msgspec.structs.replace(DEFAULT, beside="random", threshold=1.0), {})
    assert opened.candidates(0) == () and len(opened.candidates(1)) > 3, "all scores of random grasps are 0.5"
