import numpy as np
import pytest

from grasp_core.errors import GraspError
from grasp_core.scene import Scene
from grasp_core.simulation.settling import settle, stable_poses
from grasp_core.simulation.world import World


def test_box_rests_on_its_three_kinds_of_faces(physics, shapes):
    poses = stable_poses(shapes.box(0.06, 0.08, 0.10), physics, drops=40)
    heights = sorted(round(float(pose.pose[2, 3]), 3) for pose in poses)
    assert set(heights) <= {0.03, 0.04, 0.05}
    assert heights[0] == 0.03
    assert poses[0].pose[2, 3] == pytest.approx(0.03, abs=1e-4)  # the largest face is the likeliest
    assert sum(pose.probability for pose in poses) <= 1 + 1e-9
    assert [p.probability for p in poses] == sorted((p.probability for p in poses), reverse=True)


def test_poses_stand_on_the_table_over_the_origin_and_stay(physics, shapes):
    asset = shapes.mug()
    for stable in stable_poses(asset, physics, drops=30, seed=2):
        assert stable.probability >= 0.05
        pose = stable.pose
        assert np.allclose(pose[:2, 3], 0)
        assert (asset.hull.vertices @ pose[2, :3]).min() + pose[2, 3] == pytest.approx(0, abs=1e-9)
        assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-9)
        world = World([asset], physics, poses=[pose])
        world.rewind([pose])
        for _ in range(500):
            world.step()
        assert np.linalg.norm(world.objects[0].pose - pose) < 0.02


def test_upright_and_inverted_bowl_are_two_poses(physics, shapes):
    downs = [stable.pose[2, 2] for stable in stable_poses(shapes.bowl(), physics, drops=40)]
    assert any(down > 0.99 for down in downs)
    assert any(down < -0.99 for down in downs)


def test_a_lying_can_is_one_pose(physics, shapes):
    poses = stable_poses(shapes.can(), physics, drops=30)
    lying = [pose for pose in poses if abs(pose.pose[2, 2]) < 0.1]
    assert len(lying) == 1
    assert lying[0].probability > 0.5


def test_same_seed_same_poses(physics, shapes):
    first = stable_poses(shapes.can(), physics, drops=8, seed=0)
    second = stable_poses(shapes.can(), physics, drops=8, seed=0)
    assert [p.pose.tobytes() for p in first] == [p.pose.tobytes() for p in second]


def test_no_pose_is_an_error(physics, shapes, monkeypatch):
    monkeypatch.setattr("grasp_core.simulation.settling._let_go", lambda *_: False)
    with pytest.raises(GraspError, match="can: none of 3 drops"):
        stable_poses(shapes.can(), physics, drops=3)


def test_scene_settles(physics, shapes):
    a, b = shapes.box(0.06, 0.06, 0.06), shapes.can()
    scene = Scene.single(a, shapes.standing(a))
    scene = Scene((*scene.objects, *Scene.single(b, shapes.standing(b, x=0.12)).objects), scene.camera)
    lifted = scene.moved(0, scene.objects[0].world_from_object + np.diag([0, 0, 0.01], 1)[:4, :4])
    assert lifted.objects[0].world_from_object[2, 3] == pytest.approx(0.04)
    rest = settle(lifted, physics)
    assert rest.objects[0].world_from_object[2, 3] == pytest.approx(0.03, abs=1e-3)
    assert np.allclose(rest.objects[1].world_from_object[:3, 3], [0.12, 0, 0.05], atol=1e-3)


def test_falling_off_the_table_is_an_error(physics, shapes):
    asset = shapes.box(0.06, 0.06, 0.06)
    with pytest.raises(GraspError, match=r"object 0 .*fell off|come to rest"):
        settle(Scene.single(asset, shapes.standing(asset, x=3.0)), physics)
