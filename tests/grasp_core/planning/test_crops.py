import math
import time

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grasp_core.camera import canonical_camera, look_down
from grasp_core.networks.weights import CropSpec
from grasp_core.planning.crops import (
    CROP_RANGE,
    CROP_SCALE,
    DepthRule,
    canvas_yaw,
    crops,
    deepen,
    grasp_pixels,
    grasp_positions,
    sample,
    surface_map,
)

CAMERA = canonical_camera()


def bar(angle: float, height: float = 0.05, length: float = 60, width: float = 16) -> np.ndarray:
    """A canvas with a bar whose long side has this angle (rad, counter-clockwise as displayed)."""
    v, u = np.mgrid[:300, :300] - 149.5
    along = u * math.cos(angle) - v * math.sin(angle)
    across = u * math.sin(angle) + v * math.cos(angle)
    depth = np.full((300, 300), 0.70, np.float32)
    depth[(np.abs(along) < length) & (np.abs(across) < width)] = 0.70 - height
    return depth


@pytest.mark.parametrize("angle", [0.0, 0.5, math.pi / 4, -1.2, -math.pi / 2])
def test_a_crop_is_turned_until_the_closing_axis_is_its_x_axis(angle):
    canvas = bar(angle)
    along, across = crops(canvas, CAMERA, [149.5] * 2, [149.5] * 2, [angle, angle + math.pi / 2], [0.68] * 2)
    assert along.shape == (48, 48) and along.dtype == np.float32
    assert (along[22:26] < 0).all() and (along[:14] > 0).all() and (along[-14:] > 0).all()
    assert (across[:, 22:26] < 0).all() and (across[:, :14] > 0).all()


def test_contents_are_metres_from_the_finger_tips():
    canvas = bar(0.0)
    crop = crops(canvas, CAMERA, 149.5, 149.5, 0.0, 0.68)[0]
    assert crop[24, 24] == pytest.approx((0.65 - 0.68) / CROP_SCALE, abs=1e-5)
    assert crop[0, 0] == pytest.approx((0.70 - 0.68) / CROP_SCALE, abs=1e-5)
    tall = crops(bar(0.0, 0.4), CAMERA, 149.5, 149.5, 0.0, 0.5)[0]
    assert tall.min() == -CROP_RANGE and tall.max() == CROP_RANGE


def test_the_opening_covers_the_same_part_of_the_crop_at_every_height():
    for height in (0.02, 0.10, 0.20):
        focal = 525 / (0.70 - height)
        canvas = bar(0.0, height, length=0.05 * focal, width=0.02 * focal)  # 10 cm × 4 cm at its top
        crop = crops(canvas, CAMERA, 149.5, 149.5, 0.0, 0.70 - height)[0]
        inside = (crop[24] < 0.5 * crop[24].max()).sum()
        assert inside == pytest.approx(48 / 1.4, abs=2)


def test_size_context_and_opening_are_obeyed():
    canvas = bar(0.0)
    crop = crops(canvas, CAMERA, 149.5, 149.5, 0.0, 0.70, CropSpec(size=75, context=1.0))[0]
    expected = cv2.getRectSubPix(canvas, (75, 75), (149.5, 149.5)) - 0.70
    assert np.allclose(crop, expected / CROP_SCALE, atol=0.02)
    wide = crops(canvas, CAMERA, 149.5, 149.5, 0.0, 0.70, CropSpec(size=75, context=1.0), opening=0.05)[0]
    assert (wide < 0).sum() > 1.9 * (crop < 0).sum()


def test_the_outside_of_the_canvas_is_table():
    crop = crops(np.full((300, 300), 0.6, np.float32), CAMERA, 0, 0, 0.0, 0.65)[0]
    assert crop[0, 0] == pytest.approx(1.0, abs=1e-5) and crop[-1, -1] == pytest.approx(-1.0, abs=1e-5)


def test_a_batch_equals_single_crops_and_takes_no_loop_time():
    rng = np.random.default_rng(0)
    canvas = (0.7 - 0.1 * rng.random((300, 300))).astype(np.float32)
    n = 9000
    u, v = rng.uniform(50, 250, (2, n))
    angle, depth = rng.uniform(-1.5, 1.5, n), rng.uniform(0.55, 0.69, n)
    many = crops(canvas, CAMERA, u, v, angle, depth)
    for i in (0, 17, 8191, 8192, n - 1):
        assert np.array_equal(many[i], crops(canvas, CAMERA, u[i], v[i], angle[i], depth[i])[0])
    fastest = math.inf
    for _ in range(5):
        start = time.perf_counter()
        crops(canvas, CAMERA, u[:64], v[:64], angle[:64], depth[:64])
        fastest = min(fastest, time.perf_counter() - start)
    assert fastest < 0.02
    assert crops(canvas, CAMERA, [], [], [], []).shape == (0, 48, 48)


@settings(max_examples=40, deadline=None)
@given(st.floats(-1.5, 1.5), st.floats(80, 220), st.floats(80, 220), st.integers(0, 3))
def test_turning_the_scene_by_quarter_turns_leaves_crops_alone(angle, u, v, turns):
    canvas = bar(0.4)
    turned = np.ascontiguousarray(np.rot90(canvas, turns))
    x, y = u - 149.5, v - 149.5
    for _ in range(turns):
        x, y = y, -x
    one = crops(canvas, CAMERA, u, v, angle, 0.68)
    two = crops(turned, CAMERA, x + 149.5, y + 149.5, angle + turns * math.pi / 2, 0.68)
    assert np.abs(one - two).max() < 0.12  # OpenCV's warp works in 1/32 pixels
    assert np.abs(one - two).mean() < 0.005


def test_grasp_depth_is_three_centimetres_into_the_surface_and_clear_of_the_table():
    canvas = bar(0.0, height=0.06)
    depths = deepen(sample(surface_map(canvas), [149, 149, 10], [149, 140, 10]), CAMERA)
    assert np.allclose(depths, [0.67, 0.67, 0.692])
    low = sample(surface_map(bar(0.0, height=0.02)), 149, 149)
    assert deepen(low, CAMERA) == pytest.approx(0.692)
    rule = DepthRule(offset=0.01, clearance=0.002)
    assert deepen(low, CAMERA, rule) == pytest.approx(0.69)
    assert np.allclose(deepen([0.5, 0.6899], CAMERA), [0.53, 0.692])


def test_a_stray_pixel_is_no_surface_but_a_thin_rim_is():
    canvas = np.full((300, 300), 0.70, np.float32)
    canvas[100, 100] = 0.5
    canvas[200:202] = 0.6
    surface = surface_map(canvas)
    assert (surface[90:110] == np.float32(0.70)).all()
    assert (surface[199:203] == np.float32(0.6)).all() and (surface[204:] == np.float32(0.70)).all()


def test_the_offset_is_applied_along_world_z_under_the_surface_point():
    canvas = np.full((300, 300), 0.60, np.float32)
    u, v = np.array([10.0, 290.0]), np.array([20.0, 150.0])
    positions = grasp_positions(surface_map(canvas), CAMERA, u, v)
    assert np.allclose(positions[:, 0], (u - 149.5) * 0.60 / 525)
    assert np.allclose(positions[:, 1], -(v - 149.5) * 0.60 / 525)
    assert np.allclose(positions[:, 2], 0.10 - 0.03)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-3.1, 3.1),
    st.floats(0.0, 0.2),
    st.lists(st.tuples(st.integers(5, 294), st.integers(5, 294), st.floats(-1.57, 1.57)), min_size=1, max_size=8),
)
def test_pixels_and_world_positions_round_trip(yaw, height, grasps):
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.eye(4)
    turn[:2, :2] = [[c, -s], [s, c]]
    turn[:2, 3] = [0.3, -0.2]
    camera = CAMERA.at(turn @ look_down(0.70))
    assert math.isclose(math.cos(canvas_yaw(camera) - yaw), 1, abs_tol=1e-9)
    canvas = np.full((300, 300), 0.70 - height, np.float32)
    u, v, angle = map(np.array, zip(*grasps, strict=True))
    positions = grasp_positions(surface_map(canvas), camera, u, v)
    back = grasp_pixels(canvas, camera, positions, angle + canvas_yaw(camera))
    depth = deepen(sample(surface_map(canvas), u, v), camera)
    assert np.allclose(back, [u, v, angle, depth], atol=1e-4)
