import math

import msgspec
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from grasp_core.camera import Camera, CameraIntrinsics, canonical_camera, look_down
from grasp_core.errors import GraspError
from grasp_core.grasp import (
    Grasp,
    ImageGrasp,
    angle_distance,
    mean_angle,
    rectangle_corners,
    to_image,
    to_world,
    wrap_angle,
)

ANGLES = st.floats(-20, 20)
HALF = math.pi / 2


@st.composite
def cameras(draw) -> Camera:
    """Cameras that look down, tilted up to 50°, rolled about their axis, with or without distortion."""
    pose = look_down(
        draw(st.floats(0.3, 2)), draw(st.floats(-1, 1)), draw(st.floats(-1, 1)), draw(st.floats(-0.87, 0.87))
    )
    c, s = (f(draw(st.floats(-math.pi, math.pi))) for f in (math.cos, math.sin))
    roll = np.eye(4)
    norm = math.hypot(c, s) or 1.0
    roll[:2, :2] = np.array([[c, -s], [s, c]]) / norm
    distortion = draw(st.sampled_from([None, (0.12, -0.25, 0.001, -0.0008, 0.09)]))
    return Camera(CameraIntrinsics(draw(st.floats(300, 900)), 525, 320, 240, 640, 480, distortion), pose @ roll)


@given(ANGLES)
def test_wrapped_angles_are_the_same_axis_in_the_half_open_range(angle):
    wrapped = wrap_angle(angle)
    assert -HALF <= wrapped < HALF
    assert math.sin(wrapped - angle) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("angle", [HALF, -HALF, 3 * HALF, HALF - 1e-17, -HALF - 1e-17, -1e-300])
def test_wrapping_at_the_seam(angle):
    assert -HALF <= wrap_angle(angle) < HALF


@given(ANGLES, ANGLES)
def test_angle_distance_is_a_distance_between_axes(a, b):
    distance = angle_distance(a, b)
    assert 0 <= distance <= HALF
    assert distance == pytest.approx(angle_distance(b, a), abs=1e-9)
    assert distance == pytest.approx(angle_distance(a + math.pi, b), abs=1e-9)
    assert math.cos(2 * distance) == pytest.approx(math.cos(2 * (a - b)), abs=1e-9)


@given(ANGLES, st.floats(-0.7, 0.7))
def test_the_mean_of_two_axes_lies_between_them_across_the_seam_too(middle, half_way):
    mean = mean_angle([middle - half_way, middle + half_way + math.pi])
    assert angle_distance(mean, middle) < 1e-6


def test_the_mean_across_the_seam_is_not_the_raw_mean():
    mean = mean_angle([HALF - 0.1, -HALF + 0.1])
    assert angle_distance(mean, HALF) < 1e-9  # raw averaging gives 0, the worst of all axes


@given(st.lists(st.floats(-0.3, 0.3), min_size=1, max_size=6), st.floats(-3, 3))
def test_the_mean_turns_with_its_angles(angles, turn):
    assert angle_distance(mean_angle([a + turn for a in angles]), mean_angle(angles) + turn) < 1e-9


def test_weights_draw_the_mean():
    assert mean_angle([0.0, 0.4], [1.0, 0.0]) == pytest.approx(0)
    assert mean_angle([0.0, 0.4], [3.0, 1.0]) < 0.2 < mean_angle([0.0, 0.4], [1.0, 3.0])


@pytest.mark.parametrize(("angles", "weights"), [([], None), ([0.0, HALF], None), ([0.3], [0.0])])
def test_angles_without_a_mean_are_refused(angles, weights):
    with pytest.raises(GraspError, match="no mean"):
        mean_angle(angles, weights)


@given(cameras(), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0, 0.2), ANGLES, st.floats(0.005, 0.2))
def test_grasp_to_image_and_back(camera, x, y, z, angle, width):
    grasp = Grasp((x, y, z), angle, width)
    u, v, depth = camera.project([x, y, z])
    assume(depth > 0.1 and 0 <= u < 640 and 0 <= v < 480)
    back = to_world(to_image(grasp, camera), camera)
    assert back.position == pytest.approx(grasp.position, abs=1e-7)
    assert angle_distance(back.angle, grasp.angle) < 1e-7
    assert back.width == pytest.approx(grasp.width, rel=1e-6)


@given(cameras(), st.floats(0, 639), st.floats(0, 479), ANGLES, st.floats(1, 200), st.floats(0.2, 1.5))
def test_image_grasp_to_world_and_back(camera, u, v, angle, width, depth):
    before = ImageGrasp(u, v, angle, width, depth)
    try:
        world = to_world(before, camera)
    except GraspError as error:
        assert "along the table" in str(error)
        return
    back = to_image(world, camera)
    assert (back.u, back.v, back.depth) == pytest.approx((u, v, depth), abs=1e-5)
    assert angle_distance(back.angle, angle) < 1e-6
    assert back.width == pytest.approx(width, rel=1e-6)


@given(cameras(), st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), ANGLES)
def test_angle_and_width_follow_the_projected_finger_tips(camera, x, y, angle):
    camera = Camera(msgspec.structs.replace(camera.intrinsics, distortion=None), camera.pose)
    grasp = Grasp((x, y, 0.03), angle, 1e-4)  # so short that first order is exact
    u, v, depth = camera.project(grasp.position)
    assume(depth > 0.1 and 0 <= u < 640 and 0 <= v < 480)
    ends = [camera.project(np.array(grasp.position) + s * grasp.closing_axis * grasp.width / 2)[:2] for s in (-1, 1)]
    du, dv = ends[1] - ends[0]
    image = to_image(grasp, camera)
    assert image.width == pytest.approx(math.hypot(du, dv), rel=1e-3)
    assert angle_distance(image.angle, math.atan2(-dv, du)) < 1e-3


@given(st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), ANGLES)
def test_in_the_canonical_view_the_image_angle_is_the_world_angle(x, y, angle):
    grasp = Grasp((x, y, 0.0), angle, 0.1)
    image = to_image(grasp, canonical_camera())
    assert angle_distance(image.angle, grasp.angle) < 1e-9
    assert image.width == pytest.approx(75)  # the paper's opening on the table
    assert image.u - 149.5 == pytest.approx(x * 750) and 149.5 - image.v == pytest.approx(y * 750)


def test_the_depth_of_a_grasp_is_applied_along_the_view_not_along_world_z():
    camera = canonical_camera().at(look_down(0.7, tilt=0.5))
    on_surface = ImageGrasp(149.5, 149.5, 0.0, 50, camera.project([0, 0, 0])[2])
    deeper = msgspec.structs.replace(on_surface, depth=on_surface.depth + 0.01)
    moved = np.subtract(to_world(deeper, camera).position, to_world(on_surface, camera).position)
    assert moved == pytest.approx(0.01 * camera.pose[:3, 2], abs=1e-9)


def test_a_grasp_behind_the_camera_is_refused():
    with pytest.raises(GraspError, match="behind the camera"):
        to_image(Grasp((0, 0, 0.9), 0, 0.1), canonical_camera())


def test_a_camera_along_the_table_fixes_no_axis():
    pose = np.eye(4)
    pose[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]  # looks along +y
    camera = Camera(CameraIntrinsics(500, 500, 320, 240, 640, 480), pose)
    with pytest.raises(GraspError, match="along the table"):
        to_world(ImageGrasp(320, 240, 0, 50, 1.0), camera)


@given(st.floats(0, 600), st.floats(0, 400), ANGLES, st.floats(1, 100), st.floats(1, 100))
def test_rectangle_corners(u, v, angle, opening, jaw):
    corners = rectangle_corners(u, v, angle, opening, jaw)
    assert corners.mean(0) == pytest.approx([u, v])
    along, across = corners[1] - corners[0], corners[2] - corners[1]
    assert np.linalg.norm(along) == pytest.approx(opening)
    assert np.linalg.norm(across) == pytest.approx(jaw)
    assert along @ across == pytest.approx(0, abs=1e-6)
    assert angle_distance(math.atan2(-along[1], along[0]), angle) < 1e-6
    image = ImageGrasp(u, v, angle, opening, 0.7)
    assert image.rectangle(jaw) == pytest.approx(rectangle_corners(u, v, image.angle, opening, jaw))


def test_a_positive_angle_turns_counter_clockwise_as_displayed():
    corners = rectangle_corners(0, 0, math.pi / 4, 2, 0)
    assert corners[1] == pytest.approx([math.sqrt(0.5), -math.sqrt(0.5)])  # right and, rows going down, up


def test_poses_of_a_grasp():
    grasp = Grasp((0.1, 0.2, 0.03), math.pi / 6, 0.08)
    pose = grasp.world_from_gripper
    assert pose[:3, 3] == pytest.approx([0.1, 0.2, 0.03])
    assert pose[:3, 0] == pytest.approx(grasp.closing_axis)
    assert pose[:3, 2] == pytest.approx([0, 0, 1])
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)


def test_grasps_hold_plain_floats_and_survive_json():
    grasp = Grasp(tuple(np.array([0.1, 0.2, 0.3], np.float32)), np.float32(2.0), np.float64(0.1))  # type: ignore[arg-type]
    assert all(type(value) is float for value in (*grasp.position, grasp.angle, grasp.width))
    assert grasp.angle == pytest.approx(2.0 - math.pi)
    assert msgspec.json.decode(msgspec.json.encode(grasp), type=Grasp) == grasp


@pytest.mark.parametrize(
    "values",
    [((0, 0, math.nan), 0, 0.1), ((0, 0, 0), math.inf, 0.1), ((0, 0, 0), 0, 0.0), ((0, 0, 0), 0, -1), ((0, 0), 0, 0.1)],
)
def test_impossible_grasps_are_refused(values):
    with pytest.raises(GraspError):
        Grasp(*values)


@pytest.mark.parametrize("values", [(math.nan, 0, 0, 1, 1), (0, 0, 0, 0, 1), (0, 0, 0, 1, 0), (0, 0, 0, 1, -0.7)])
def test_impossible_image_grasps_are_refused(values):
    with pytest.raises(GraspError):
        ImageGrasp(*values)
