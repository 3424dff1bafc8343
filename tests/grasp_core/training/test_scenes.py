import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, canonical_camera, look_down
from grasp_core.errors import MismatchError
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import Scene
from grasp_core.training.scenes import GraspLabels, Views, more_views, one_view_each, training_scene


def bar() -> Scene:
    mesh = trimesh.creation.box((0.12, 0.03, 0.04))
    part = Part(np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int32))
    asset = ObjectAsset("bar", "box", part.vertices, part.faces, (part,), 1.4e-4, np.eye(3) * 1e-7)
    pose = np.eye(4)
    pose[2, 3] = 0.02
    return Scene.single(asset, pose)


def labels() -> GraspLabels:
    positions = np.array([[0.0, 0.0, 0.01], [0.04, 0.0, 0.01], [0.0, 0.0, 0.01], [0.5, 0.0, 0.01]])
    return GraspLabels(
        positions, np.full(4, math.pi / 2), np.array([1.0, 0.8, np.nan, 1.0]), np.array([False, True, False, False])
    )


def test_grasps_are_found_in_the_image_and_unlabelled_ones_left_out() -> None:
    depth = np.full((300, 300), 0.70, np.float32)
    scene = training_scene("s", "o", DepthImage(depth, canonical_camera(), np.ones(depth.shape, np.bool_)), labels())
    np.testing.assert_allclose(scene.labels, [1.0, 0.8])  # no label, outside of the image
    np.testing.assert_array_equal(scene.colliding, [False, True])
    np.testing.assert_allclose(scene.pixels, [[149.5, 149.5], [149.5 + 0.04 * 525 / 0.70, 149.5]], atol=1e-3)
    np.testing.assert_allclose(scene.depths, 0.69, atol=1e-6)
    np.testing.assert_allclose(np.abs(scene.angles), math.pi / 2, atol=1e-6)
    np.testing.assert_allclose(scene.depth, 0.70, atol=5e-5)
    np.testing.assert_allclose(scene.openings(0.10), 525 * 0.10 / 0.69, rtol=1e-5)
    assert len(scene.perfect) == 1


def test_other_views_are_refused() -> None:
    intrinsics = CameraIntrinsics(600.0, 600.0, 149.5, 149.5, 300, 300)
    depth = np.full((300, 300), 0.7, np.float32)
    valid = np.ones(depth.shape, np.bool_)
    for camera in (Camera(intrinsics, look_down(0.7)), canonical_camera().at(look_down(0.6))):
        with pytest.raises(MismatchError, match="canonical"):
            training_scene("s", "o", DepthImage(depth, camera, valid), labels())
    with pytest.raises(MismatchError, match="without holes"):
        training_scene("s", "o", DepthImage(depth, canonical_camera(), ~valid), labels())


@pytest.mark.parametrize("tilted", [0.0, 1.0])
def test_further_views_keep_grasps_on_the_object(tilted: float) -> None:
    views = Views(count=4, reach=0.06, tilted=tilted, tilt=0.6)
    made = list(more_views("s", "bar", bar(), labels(), views, np.random.default_rng(0)))
    assert [scene.name for scene in made] == ["s/1", "s/2", "s/3", "s/4"]
    places = np.array([scene.pixels[0] for scene in made])
    assert np.ptp(places, axis=0).min() > 5
    for scene in made:
        assert scene.units.shape == (300, 300)
        np.testing.assert_allclose(scene.labels, [1.0, 0.8])
        for u, v in np.rint(scene.pixels).astype(int):
            assert scene.depth[v, u] == pytest.approx(0.66, abs=0.003)
        # 4 cm between both grasps, at the depth of the bar's top
        gap = scene.pixels[1] - scene.pixels[0]
        assert np.hypot(*gap) == pytest.approx(0.04 * 525 / 0.66, abs=1.5)
        # the closing axis stays across the bar
        along = math.atan2(-gap[1], gap[0])
        assert abs(math.cos(along - float(scene.angles[0]))) < 0.06
        assert abs(scene.depths[0] - 0.69) < 1e-5


def test_further_views_repeat_with_the_seed() -> None:
    views = Views(count=2, tilted=0.5)
    first, second = (list(more_views("s", "bar", bar(), labels(), views, np.random.default_rng(5))) for _ in range(2))
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a.units, b.units)
        np.testing.assert_array_equal(a.pixels, b.pixels)


def test_settings_refuse_nonsense() -> None:
    with pytest.raises(ValueError, match="share"):
        Views(tilted=2.0)
    with pytest.raises(ValueError, match="focal is a least and a greatest"):
        Views(focal=(700.0, 400.0))


def test_a_pass_shows_every_scene_in_one_of_its_views(toys) -> None:
    scenes = [
        replace(scene, name=name) for scene, name in zip(toys(0, 5), ("a", "a/1", "a/2", "b", "b/1"), strict=True)
    ]
    drawn = [one_view_each(scenes, np.random.default_rng(seed)).tolist() for seed in range(30)]
    assert all(sorted(scenes[k].stored for k in order) == ["a", "b"] for order in drawn)
    assert {k for order in drawn for k in order} == set(range(5))
    assert {scenes[order[0]].stored for order in drawn} == {"a", "b"}
