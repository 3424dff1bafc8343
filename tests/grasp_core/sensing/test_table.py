import math
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, canonical_camera, load_camera, look_down
from grasp_core.errors import ImageError
from grasp_core.scene import Scene
from grasp_core.sensing.noise import ImageNoise, add_noise
from grasp_core.sensing.preprocess import read_depth
from grasp_core.sensing.renderer import render
from grasp_core.sensing.table import find_table

SMALL = CameraIntrinsics(260, 260, 159.5, 119.5, 320, 240)


def rolled(pose: np.ndarray, roll: float) -> np.ndarray:
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(roll), -math.sin(roll)], [math.sin(roll), math.cos(roll)]]
    return pose @ turn


@settings(max_examples=25, deadline=None)
@given(st.floats(0.35, 1.5), st.floats(0, 0.9), st.floats(-0.6, 0.6), st.integers(0, 1000))
def test_the_pose_of_a_noisy_empty_table_is_found(height, tilt, roll, seed):
    pose = rolled(look_down(height, tilt=tilt), roll)
    image = add_noise(render(Scene((), Camera(SMALL, pose))), ImageNoise(), np.random.default_rng(seed))
    found = find_table(image.with_camera(Camera(SMALL))).pose
    assert found[2, 3] == pytest.approx(height, abs=0.004)
    assert np.allclose(found[:2, 3], 0)
    assert math.acos(min(1, found[2, :3] @ pose[2, :3])) < math.radians(0.5)
    assert abs(found[1, 0]) < 1e-9 and found[0, 0] > 0


def test_a_straight_down_camera_has_the_pose_of_look_down():
    camera = canonical_camera()
    image = render(Scene((), camera))
    found = find_table(image.with_camera(Camera(camera.intrinsics)))
    assert np.allclose(found.pose, look_down(0.70), atol=1e-6)


def test_a_large_lid_above_the_table_is_not_taken_for_it():
    depth = np.full((240, 320), 0.8, np.float32)
    depth[:, :190] = 0.6  # 59 % of the image
    image = DepthImage.from_array(depth, Camera(SMALL))
    assert find_table(image).pose[2, 3] == pytest.approx(0.8, abs=1e-3)


def test_holes_and_clutter_do_not_disturb():
    rng = np.random.default_rng(0)
    depth = np.full((240, 320), 0.7, np.float32)
    depth[rng.random(depth.shape) < 0.3] = np.nan
    depth[100:240, 0:160] = rng.uniform(0.4, 0.6, (140, 160))
    found = find_table(DepthImage.from_array(depth, Camera(SMALL)))
    assert np.allclose(found.pose, look_down(0.7), atol=1e-6)


def test_no_table_is_an_error_that_says_what_to_do():
    rng = np.random.default_rng(0)
    noise = DepthImage.from_array(rng.uniform(0.3, 5, (240, 320)), Camera(SMALL))
    with pytest.raises(ImageError, match="world_from_camera"):
        find_table(noise)
    wall = render(Scene((), Camera(SMALL, look_down(0.3, tilt=math.radians(85)))))
    with pytest.raises(ImageError, match="no table plane"):
        find_table(wall.with_camera(Camera(SMALL)))
    dots = np.zeros((240, 320))
    dots[0, 0] = 0.7
    with pytest.raises(ImageError, match="too few"):
        find_table(DepthImage.from_array(dots, Camera(SMALL)))


@pytest.mark.skipif("GRASP_TEST_DATA" not in os.environ, reason="GRASP_TEST_DATA names no folder of real files")
@pytest.mark.parametrize("name", ["clutter_0", "depth_0", "depth_1", "depth_2", "depth_3", "depth_4"])
def test_real_table_of_the_primesense_images(name):
    path = Path(os.environ["GRASP_TEST_DATA"]) / "primesense" / f"{name}.npy"
    found = find_table(read_depth(path, load_camera("primesense"))).pose
    assert found[2, 3] == pytest.approx(0.713, abs=0.002)
    assert math.degrees(math.acos(-found[2, 2])) == pytest.approx(12.6, abs=0.15)
