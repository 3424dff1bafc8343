import dataclasses

import numpy as np
import pytest
import trimesh

from grasp_core.camera import canonical_camera, load_camera, look_down
from grasp_core.errors import GraspError
from grasp_core.evaluation.scenes import MARGIN, SceneSpec, choose_poses, make_scene, over_the_table, shape_off
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.sensing.renderer import render


def block(x: float = 0.12, y: float = 0.04, z: float = 0.03) -> ObjectAsset:
    mesh = trimesh.creation.box((x, y, z))
    part = Part(np.array(mesh.vertices), np.array(mesh.faces, np.int32))
    return ObjectAsset("block", "block", part.vertices, part.faces, (part,), float(mesh.volume), mesh.moment_inertia)


def resting(z: float = 0.03) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = z / 2
    return pose


def spec(draw: int = 0) -> SceneSpec:
    return SceneSpec("block", "0123abcd", 1, draw)


CAMERAS = {
    "primesense": over_the_table(load_camera("primesense")),
    "canonical": canonical_camera(),
    "tilted": load_camera("primesense").at(look_down(0.7, tilt=0.35)),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_the_whole_object_is_in_view_at_varied_places(name):
    camera = CAMERAS[name]
    k = camera.intrinsics
    centres, yaws = [], []
    for draw in range(60):
        scene = make_scene(block(), resting(), camera, spec(draw), 0)
        u, v, _ = camera.project(scene.objects[0].vertices).T
        assert u.min() >= MARGIN and v.min() >= MARGIN
        assert u.max() <= k.width - 1 - MARGIN and v.max() <= k.height - 1 - MARGIN
        pose = scene.objects[0].world_from_object
        assert scene.objects[0].vertices[:, 2].min() == pytest.approx(0)
        centres.append(pose[:2, 3])
        yaws.append(np.arctan2(pose[1, 0], pose[0, 0]))
    spread = np.ptp(centres, axis=0)
    assert (spread > 0.1).all()  # not only the image's centre
    assert min(yaws) < -2 and max(yaws) > 2


def test_a_scene_follows_from_its_words_and_seed_alone():
    camera = CAMERAS["primesense"]
    poses = [
        make_scene(block(), resting(), camera, spec(d), s).objects[0].world_from_object
        for d, s in [(0, 0), (1, 0), (0, 1)]
    ]
    again = make_scene(block(), resting(), camera, spec(0), 0).objects[0].world_from_object
    assert np.array_equal(poses[0], again)
    assert not np.allclose(poses[0], poses[1]) and not np.allclose(poses[0], poses[2])


def test_an_object_too_big_for_the_view_is_refused_by_name():
    with pytest.raises(GraspError, match=r"block: nowhere.*wider or higher camera"):
        make_scene(block(0.6, 0.6), resting(), canonical_camera(), spec(), 0)


def test_a_camera_that_sees_the_horizon_is_refused():
    with pytest.raises(GraspError, match="horizon"):
        make_scene(block(), resting(), load_camera("primesense").at(look_down(0.7, tilt=1.3)), spec(), 0)


def test_a_camera_without_pose_looks_straight_down():
    camera = over_the_table(load_camera("primesense"))
    assert camera.pose == pytest.approx(look_down(0.7))
    tilted = CAMERAS["tilted"]
    assert over_the_table(tilted) is tilted


def test_names_tell_scenes_apart():
    names = {
        SceneSpec("mug", digest, pose, draw).name for digest in ("aaaa1", "bbbb1") for pose in (0, 1) for draw in (0, 1)
    }
    assert len(names) == 8


def test_poses_are_drawn_by_probability_without_repeats():
    chosen = [choose_poses([0.7, 0.2, 0.1], 1, seed, "mug")[0] for seed in range(600)]
    shares = np.bincount(chosen, minlength=3) / 600
    assert shares == pytest.approx([0.7, 0.2, 0.1], abs=0.06)
    assert sorted(choose_poses([0.7, 0.2, 0.1], 5, 0, "mug")) == [0, 1, 2]


def test_asking_for_more_poses_keeps_the_first_ones():
    for seed in range(20):
        four = choose_poses([0.4, 0.3, 0.2, 0.1], 4, seed, "mug")
        assert choose_poses([0.4, 0.3, 0.2, 0.1], 2, seed, "mug") == four[:2]


def test_parts_that_stand_off_the_mesh_are_measured():
    true = make_scene(block(), resting(), CAMERAS["primesense"], spec(), 0)
    assert shape_off(true, render(true).depth) == 0
    bloated = dataclasses.replace(block(), parts=block(0.12, 0.08, 0.03).parts)
    off = make_scene(bloated, resting(), CAMERAS["primesense"], spec(), 0)
    assert shape_off(off, render(off).depth) == pytest.approx(0.5, abs=0.05)  # half of the broader parts is not seen
