import math
import os
from pathlib import Path

import cv2
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, load_camera, look_down
from grasp_core.errors import ImageError
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import Scene, place
from grasp_core.sensing.noise import ImageNoise, add_noise
from grasp_core.sensing.preprocess import read_depth
from grasp_core.sensing.rectify import rectify
from grasp_core.sensing.renderer import render

VGA = CameraIntrinsics(525, 525, 319.5, 239.5, 640, 480)


def box_on_table(x: float, y: float, size=(0.12, 0.06, 0.05), yaw: float = 0.4) -> Scene:
    mesh = trimesh.creation.box(extents=size)
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int32)
    asset = ObjectAsset("box", "test", vertices, faces, (Part(vertices, faces),), mesh.volume, np.eye(3))
    pose = np.eye(4)
    pose[2, 3] = size[2] / 2
    return Scene.single(asset, place(pose, x, y, yaw))


@pytest.mark.parametrize("size", [(300, 300), (640, 480)])
def test_the_canonical_view_comes_back_as_it_is(size):
    width, height = size
    intrinsics = CameraIntrinsics(525, 525, (width - 1) / 2, (height - 1) / 2, width, height)
    image = render(box_on_table(0.02, -0.03), Camera(intrinsics, look_down(0.70)))
    for given_camera in (image.camera, Camera(intrinsics)):
        rectified = rectify(image.with_camera(given_camera))
        assert rectified.image.camera.intrinsics == intrinsics
        assert np.allclose(rectified.image.camera.pose, look_down(0.70), atol=1e-5)
        assert (np.abs(rectified.image.depth - image.depth) < 1e-4).mean() > 0.9995
        assert rectified.seen.mean() > 0.9995 and rectified.missing == 0


@settings(max_examples=20, deadline=None)
@given(
    st.floats(0.45, 1.1),
    st.floats(0, 0.7),
    st.floats(-math.pi, math.pi),
    st.floats(-0.06, 0.06),
    st.floats(-0.06, 0.06),
    st.sampled_from([300.0, 525.0, 900.0]),
)
def test_any_view_becomes_what_the_canonical_camera_would_see(height, tilt, yaw, x, y, focal):
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
    turn[:2, 3] = [0.4, -0.2]
    intrinsics = CameraIntrinsics(focal, focal, 319.5, 239.5, 640, 480)
    scene = box_on_table(0.4 + x, -0.2 + y)
    rectified = rectify(render(scene, Camera(intrinsics, turn @ look_down(height, tilt=tilt))))
    truth = render(scene, rectified.image.camera)
    close = np.abs(rectified.image.depth - truth.depth) < 0.004
    top = truth.depth < 0.66
    assert (close | ~rectified.seen).mean() > 0.97  # what it calls seen is there
    inside = top & (np.roll(top, 2, 0) & np.roll(top, -2, 0) & np.roll(top, 2, 1) & np.roll(top, -2, 1))
    if inside.sum() > 500:
        assert close[inside].mean() > 0.97 and rectified.seen[inside].mean() > 0.95


def test_without_a_pose_the_world_lies_under_the_camera():
    scene = box_on_table(0.0, 0.1)
    camera = Camera(VGA, look_down(0.8, tilt=0.25))
    image = render(scene, camera)
    rectified = rectify(image.with_camera(Camera(VGA)))
    assert rectified.camera.pose[2, 3] == pytest.approx(0.8, abs=1e-3)
    corner = rectified.image.points()[rectified.image.depth < 0.66].mean(axis=0)
    shift = 0.8 * math.tan(0.25)  # the camera stands at y = −shift in the scene's world
    assert np.allclose(corner, [0, 0.1 + shift, 0.05], atol=0.005)


def test_shadows_take_the_background_and_are_not_seen():
    scene = box_on_table(0.0, 0.0, (0.1, 0.1, 0.1), 0.0)
    rectified = rectify(render(scene, Camera(VGA, look_down(0.7, tilt=0.6))))
    truth = render(scene, rectified.image.camera)
    table = truth.depth > 0.699
    shadow = table & ~rectified.seen
    assert shadow.sum() > 1000
    assert np.allclose(rectified.image.depth[shadow], 0.70, atol=1e-4)
    assert rectified.image.valid.all()


@pytest.mark.parametrize("tilt", [0.0, 0.5])
def test_the_canonical_camera_can_stand_over_an_object(tilt):
    scene = box_on_table(0.16, -0.1, (0.08, 0.06, 0.10))
    there = rectify(render(scene, Camera(VGA, look_down(0.7, tilt=tilt))))
    over = there.above(np.array([0.16, -0.1]))
    assert over.image.camera.pose[:2, 3] == pytest.approx([0.16, -0.1], abs=1e-3)
    truth = render(scene, over.image.camera)
    off = np.abs(over.image.depth - truth.depth)[over.seen] > 0.005
    assert off.mean() < 0.003, "as seen from there, but for its outline"
    pixels = np.argwhere((there.image.depth > 0.695) & (over.image.depth > 0.695))[::500, ::-1].astype(float)
    before, after = (view.image.camera.deproject(pixels, np.full(len(pixels), 0.7)) for view in (there, over))
    assert np.allclose(before, after, atol=1e-6), "the table stays where it is"
    assert over.above(np.array([0.16, -0.1])) is over
    assert np.array_equal(over.above(there.image.camera.pose[:2, 3]).image.depth, there.image.depth)


def test_the_table_under_a_bulge_does_not_show_through_it():
    mesh = trimesh.creation.cylinder(radius=0.05, height=0.16, sections=64)
    vertices, faces = np.asarray(mesh.vertices)[:, [2, 0, 1]], np.asarray(mesh.faces, np.int32)  # it lies along x
    asset = ObjectAsset("can", "test", vertices, faces, (Part(vertices, faces),), mesh.volume, np.eye(3))
    pose = np.eye(4)
    pose[2, 3] = 0.05
    scene = Scene.single(asset, place(pose, 0.16, 0.16, 0.5))
    image = add_noise(render(scene, Camera(VGA, look_down(0.7))), ImageNoise(), np.random.default_rng(0))
    over = rectify(image).above(np.array([0.16, 0.16]))
    truth = render(scene, over.image.camera).depth
    inside = cv2.erode((truth < 0.64).astype(np.uint8), np.ones((9, 9), np.uint8)) > 0
    assert inside.sum() > 3000
    assert (over.image.depth[inside] > 0.68).mean() < 0.002


@pytest.mark.parametrize("over", [False, True])
@pytest.mark.parametrize("tilt, yaw", [(0.0, 0.0), (0.5, 0.0), (0.5, 1.3)])
def test_points_are_hidden_where_a_ray_from_the_camera_to_them_meets_something(tilt, yaw, over):
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
    scene = box_on_table(0.08, -0.05, (0.12, 0.06, 0.09))
    image = render(scene, Camera(VGA, turn @ look_down(0.8, tilt=tilt)))
    rectified = rectify(image)
    if over:
        rectified = rectified.above(np.array([0.1, -0.04]))
    rng = np.random.default_rng(0)
    points = np.column_stack(
        [rng.uniform(-0.05, 0.2, 3000), rng.uniform(-0.2, 0.1, 3000), rng.uniform(0.008, 0.12, 3000)]
    )
    canvas = rectified.image.camera
    right, down = ((points - canvas.pose[:3, 3]) @ canvas.pose[:3, :2]).T
    hidden = rectified.hides(right, down, points[:, 2])
    u, v, depth = image.camera.project(points).T
    columns, rows = np.rint(u).astype(int), np.rint(v).astype(int)
    ahead = [image.depth[np.clip(rows + j, 0, 479), np.clip(columns + i, 0, 639)] for i in (-2, 2) for j in (-2, 2)]
    sure = np.ptp(ahead, axis=0) < 0.01  # away from the edges of the box
    truth = image.depth[rows, columns] < depth - 1e-3
    near = np.abs(image.depth[rows, columns] - depth) < 0.003
    assert 0.05 < truth.mean() < 0.6
    assert (hidden == truth)[sure & ~near].mean() > 0.995


def test_points_out_of_the_image_are_not_hidden():
    rectified = rectify(render(box_on_table(0, 0), Camera(VGA, look_down(0.7))))
    assert not rectified.hides(np.array([-2.0, 0.0]), np.array([0.0, 2.0]), np.array([0.01, 0.01])).any()


def test_a_hole_in_a_surface_is_closed_and_its_share_reported():
    image = render(box_on_table(0.0, 0.0, (0.2, 0.2, 0.05), 0.0), Camera(VGA, look_down(0.70)))
    depth = image.depth.copy()
    depth[230:240, 310:330] = np.nan
    rectified = rectify(DepthImage.from_array(depth, image.camera))
    assert rectified.missing == pytest.approx(200 / (640 * 480))
    assert np.allclose(rectified.image.depth[225:245, 300:340], 0.65, atol=1e-4)
    assert not rectified.seen[232:238, 312:328].any()


def test_distorted_images_are_straightened():
    intrinsics = CameraIntrinsics(525, 520, 322, 236, 640, 480, (0.05, -0.08, 0.001, -0.001, 0.0))
    scene = box_on_table(0.1, 0.1)
    rectified = rectify(render(scene, Camera(intrinsics, look_down(0.75, tilt=0.2))))
    truth = render(scene, rectified.image.camera)
    close = np.abs(rectified.image.depth - truth.depth) < 0.004
    assert close[rectified.seen].mean() > 0.99


def test_a_mask_travels_with_the_surface_that_it_marks():
    scene = box_on_table(0.05, 0.05, (0.1, 0.1, 0.12), 0.3)
    image = render(scene, Camera(VGA, look_down(0.7, tilt=0.5)))
    on_box = image.points()[:, :, 2] > 0.005
    rectified = rectify(image)
    carried = rectified.carry(on_box)
    truth = (render(scene, rectified.image.camera).depth < 0.695) & rectified.seen
    assert (carried & truth).sum() > 0.95 * truth.sum()
    assert (carried & ~truth).sum() < 0.08 * truth.sum()
    assert not rectified.carry(np.zeros((480, 640), bool)).any()
    assert np.array_equal(rectified.carry(np.ones((480, 640), bool)), rectified.seen)
    with pytest.raises(ImageError, match="boolean"):
        rectified.carry(np.ones((480, 640)))


def test_the_canvas_is_bounded_and_at_least_as_large_as_in_training():
    wide = rectify(render(Scene((), Camera(CameraIntrinsics(200, 200, 319.5, 239.5, 640, 480), look_down(1.5)))))
    assert wide.image.depth.shape == (1024, 1024) and wide.seen.all()
    near = rectify(render(Scene((), Camera(VGA, look_down(0.25)))))
    assert near.image.depth.shape == (300, 300) and 0.2 < near.seen.mean() < 0.8
    assert np.allclose(near.image.depth, 0.70, atol=1e-4)


def test_the_floor_beyond_the_table_is_raised_and_high_things_are_left_out():
    depth = np.full((480, 640), 0.70, np.float32)
    depth[:, 600:] = 1.5
    depth[:, :20] = 0.1
    rectified = rectify(DepthImage.from_array(depth, Camera(VGA, look_down(0.70))))
    assert rectified.image.depth.max() <= 0.7201
    assert np.allclose(rectified.image.depth[:, :15], 0.70) and not rectified.seen[:, :15].any()


def test_cameras_that_do_not_see_the_table_are_refused():
    image = DepthImage.from_array(np.full((480, 640), 0.7), Camera(VGA, look_down(0.7)))
    up = look_down(0.7) @ np.diag([1.0, -1.0, -1.0, 1.0])
    for pose in (up, look_down(0.7, tilt=1.4), look_down(-0.7)):
        with pytest.raises(ImageError, match="look down"):
            rectify(image.with_camera(Camera(VGA, pose)))
    with pytest.raises(ImageError, match="nothing near the table"):
        rectify(image.with_camera(Camera(VGA, look_down(2.0))))


@pytest.mark.skipif("GRASP_TEST_DATA" not in os.environ, reason="GRASP_TEST_DATA names no folder of real files")
def test_real_views_have_a_flat_table():
    data = Path(os.environ["GRASP_TEST_DATA"])
    flat = rectify(read_depth(data / "primesense" / "depth_2.npy", load_camera("primesense")))
    height = 0.70 - flat.image.depth
    v, u = np.nonzero(flat.seen & (height > 0.015))
    centre = (np.abs(u - 372) < 100) & (np.abs(v - 260) < 100)
    assert 1500 < centre.sum() < 8000  # the bottle, and nothing else
    assert np.abs(np.median(height[200:320, 480:600])) < 0.003
    shelf = rectify(read_depth(data / "realsense" / "depth.png", load_camera("realsense"), 0.001))
    assert shelf.missing == pytest.approx(0.105, abs=0.002)
    assert np.abs(np.median((0.70 - shelf.image.depth)[300:400, 60:200])) < 0.004
