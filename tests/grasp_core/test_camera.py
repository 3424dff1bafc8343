import math

import cv2
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from grasp_core import config
from grasp_core.camera import (
    CANONICAL_HEIGHT,
    Camera,
    CameraIntrinsics,
    DepthImage,
    canonical_camera,
    load_camera,
    look_down,
    rigid,
)
from grasp_core.errors import ConfigError, GraspError, ImageError

DISTORTIONS = [None, (0.12, -0.25, 0.001, -0.0008, 0.09), (-0.05, 0.01, -0.002, 0.0015, 0.0)]


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    return cv2.Rodrigues(axis / np.linalg.norm(axis) * angle)[0]


@st.composite
def tilted_cameras(draw) -> Camera:
    """Any camera above the table that looks roughly down: tilted up to 50°, rolled, moved."""
    height = draw(st.floats(0.3, 2.0))
    pose = look_down(height, draw(st.floats(-1, 1)), draw(st.floats(-1, 1)), draw(st.floats(-0.87, 0.87)))
    roll = np.eye(4)
    roll[:3, :3] = rotation(np.array([0.0, 0.0, 1.0]), draw(st.floats(-math.pi, math.pi)))
    intrinsics = CameraIntrinsics(
        draw(st.floats(300, 900)),
        draw(st.floats(300, 900)),
        draw(st.floats(300, 340)),
        draw(st.floats(220, 260)),
        640,
        480,
        draw(st.sampled_from(DISTORTIONS)),
    )
    return Camera(intrinsics, pose @ roll)


@given(tilted_cameras(), st.floats(0, 639), st.floats(0, 479), st.floats(0.05, 5))
def test_pixel_to_world_and_back(camera, u, v, depth):
    world = camera.deproject([u, v], depth)
    assert camera.project(world) == pytest.approx([u, v, depth], abs=1e-6)


@given(tilted_cameras(), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0, 0.25))
def test_world_to_pixel_and_back(camera, x, y, z):
    point = np.array([x, y, z])
    u, v, depth = camera.project(point)
    assume(depth > 0.05 and 0 <= u <= 639 and 0 <= v <= 479)
    assert camera.deproject([u, v], depth) == pytest.approx(point, abs=1e-8)


@given(tilted_cameras(), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_projection_agrees_with_opencv(camera, x, y):
    k = camera.intrinsics
    point = np.array([x, y, 0.05])
    u, v, depth = camera.project(point)
    assume(depth > 0.1)
    # Not cv2.Rodrigues, which takes a turn by nearly π for one about a neighbouring axis.
    r = Rotation.from_matrix(camera.camera_from_world[:3, :3]).as_rotvec()
    t = camera.camera_from_world[:3, 3]
    distortion = np.zeros(5) if k.distortion is None else np.array(k.distortion)
    expected, _ = cv2.projectPoints(point.reshape(1, 3), r, t, k.matrix, distortion)
    assert (u, v) == pytest.approx(tuple(expected.ravel()), rel=1e-6, abs=1e-6)


def test_depth_is_along_the_optical_axis_not_along_the_ray():
    camera = canonical_camera()
    corner = camera.deproject([0, 0], CANONICAL_HEIGHT)
    assert corner[2] == pytest.approx(0, abs=1e-12)  # the whole table has one z-depth from straight above
    assert np.linalg.norm(corner - camera.pose[:3, 3]) > CANONICAL_HEIGHT + 0.05


def test_project_takes_any_leading_shape():
    camera = canonical_camera()
    points = np.zeros((4, 5, 3))
    assert camera.project(points).shape == (4, 5, 3)
    assert camera.deproject(np.zeros((4, 5, 2)), 0.5).shape == (4, 5, 3)
    assert camera.deproject(np.zeros((0, 2)), np.zeros(0)).shape == (0, 3)
    distorted = Camera(CameraIntrinsics(500, 500, 1, 1, 3, 3, DISTORTIONS[1]), look_down(1.0))
    assert distorted.deproject(np.zeros((0, 2)), np.zeros(0)).shape == (0, 3)


@pytest.mark.parametrize("coefficients", DISTORTIONS[1:])
def test_rays_undo_distortion_over_the_whole_image(coefficients):
    k = CameraIntrinsics(525, 520, 321, 237, 640, 480, coefficients)
    v, u = np.mgrid[:480:7, :640:7]
    pixels = np.stack([u, v], axis=-1)
    assert np.abs(k.pixels(k.rays(pixels)) - pixels).max() < 1e-6


def test_a_pixel_beyond_the_fold_of_a_distortion_has_no_ray():
    k = CameraIntrinsics(525, 525, 320, 240, 640, 480, (-1.2, 0.0, 0.0, 0.0, 0.0))
    assert np.isnan(k.rays([639, 479])).all()
    assert k.pixels(k.rays([330, 245])) == pytest.approx([330, 245], abs=1e-6)


def test_canonical_view_shows_world_x_to_the_right_and_world_y_up():
    camera = canonical_camera()
    assert (camera.intrinsics.fx, camera.intrinsics.fy) == (525, 525)
    centre = camera.project([0, 0, 0])
    assert centre == pytest.approx([149.5, 149.5, 0.70])
    right, up = camera.project([0.1, 0, 0]), camera.project([0, 0.1, 0])
    assert right == pytest.approx([149.5 + 75, 149.5, 0.70])  # the 10 cm opening is 75 px
    assert up == pytest.approx([149.5, 149.5 - 75, 0.70])
    assert canonical_camera(301).project([0, 0, 0])[:2] == pytest.approx([150, 150])


def test_the_shipped_canonical_camera_is_the_one_of_the_code():
    assert load_camera("canonical") == canonical_camera()


@given(st.floats(0.3, 1.5), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-1.2, 1.2))
def test_look_down_meets_its_target(height, x, y, tilt):
    pose = look_down(height, x, y, tilt)
    assert pose[2, 3] == pytest.approx(height)
    axis = pose[:3, 2]
    assert axis @ [0, 0, -1] == pytest.approx(math.cos(tilt))
    meets = pose[:3, 3] + axis * height / math.cos(tilt)
    assert meets == pytest.approx([x, y, 0], abs=1e-9)
    assert pose[:3, 0] == pytest.approx([1, 0, 0])
    assert math.copysign(1, pose[1, 3] - y) == -math.copysign(1, tilt) or tilt == pytest.approx(0)


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (np.eye(3), "4×4"),
        (np.full((4, 4), np.nan), "finite"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "right-handed"),
        (np.diag([2.0, 2.0, 2.0, 1.0]), "orthonormal"),
        (np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1.0]]), "last row"),
        ([[1, 2], [3]], "four rows of four"),
    ],
)
def test_poses_that_are_none_are_refused_by_name(matrix, words):
    with pytest.raises(GraspError, match=words) as caught:
        rigid(matrix, "world_from_lamp")
    assert "world_from_lamp" in str(caught.value)


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3), st.floats(0, 3))
def test_a_rotation_with_few_digits_becomes_an_exact_one(axis, angle):
    assume(np.linalg.norm(axis) > 0.1)
    exact = np.eye(4)
    exact[:3, :3] = rotation(np.array(axis), angle)
    checked = rigid(np.round(exact, 5), "pose")
    assert checked[:3, :3] @ checked[:3, :3].T == pytest.approx(np.eye(3), abs=1e-12)
    assert checked == pytest.approx(exact, abs=2e-5)
    assert np.array_equal(rigid(checked, "pose"), checked)


def test_cameras_are_values():
    a, b = canonical_camera(), canonical_camera()
    assert a == b and hash(a) == hash(b)
    assert a != a.at(look_down(0.8)) and a != Camera(a.intrinsics)
    assert Camera(a.intrinsics) == Camera(a.intrinsics)
    assert a != "camera"
    with pytest.raises(ValueError, match="read-only"):
        a.pose[0, 0] = 2
    given_pose = look_down(0.7)
    camera = Camera(a.intrinsics, given_pose)
    given_pose[2, 3] = 9
    assert camera.pose[2, 3] == 0.7


def test_a_camera_without_pose_says_so():
    with pytest.raises(GraspError, match="no pose"):
        _ = Camera(canonical_camera().intrinsics).pose


@pytest.mark.parametrize("wrong", [{"fx": 0.0}, {"fy": -1.0}, {"width": 0}, {"cx": math.inf}, {"fx": math.nan}])
def test_impossible_intrinsics_are_refused(wrong):
    values = {"fx": 500.0, "fy": 500.0, "cx": 1.0, "cy": 1.0, "width": 3, "height": 3} | wrong
    with pytest.raises(GraspError):
        CameraIntrinsics(**values)


# Depth images


def image_camera(width: int = 4, height: int = 3) -> Camera:
    return Camera(CameraIntrinsics(500, 500, 1, 1, width, height), look_down(0.7))


def test_millimetres_are_refused_with_the_way_out():
    with pytest.raises(ImageError, match=r"millimetres.*--depth-scale 0\.001"):
        DepthImage.from_array(np.full((3, 4), 700, np.uint16), image_camera())


def test_holes_are_invalid_whatever_marks_them():
    depth = np.full((3, 4), 0.7)
    depth[0] = [np.nan, 0, -1, np.inf]
    image = DepthImage.from_array(depth, image_camera())
    assert image.valid.tolist() == [[False] * 4, [True] * 4, [True] * 4]
    assert image.depth.dtype == np.float32 and np.isfinite(image.depth).all()


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.zeros((3, 4)), "no valid pixel"),
        (np.full((3, 4), np.nan), "no valid pixel"),
        (np.ones((3, 4, 3)), "colour image"),
        (np.ones(12), "shape"),
        (np.ones((3, 4), bool), "type bool"),
        (np.array([["a"] * 4] * 3), "type"),
        (np.ones((4, 3)), "camera"),
    ],
)
def test_what_is_no_depth_image_is_refused(array, words):
    with pytest.raises(ImageError, match=words):
        DepthImage.from_array(array, image_camera())


def test_one_channel_may_stand_in_a_third_axis():
    assert DepthImage.from_array(np.ones((3, 4, 1)), image_camera()).depth.shape == (3, 4)


def test_wrong_types_of_the_arrays_are_refused():
    with pytest.raises(ImageError, match="from_array"):
        DepthImage(np.ones((3, 4)), image_camera(), np.ones((3, 4), bool))  # type: ignore[arg-type]


def test_points_lie_where_the_pixels_look():
    image = DepthImage.from_array(np.full((3, 4), 0.7), image_camera())
    points = image.points()
    assert points.shape == (3, 4, 3)
    assert points[..., 2] == pytest.approx(np.zeros((3, 4)), abs=1e-7)
    assert points[1, 1] == pytest.approx([0, 0, 0], abs=1e-7)
    assert image.with_camera(image_camera().at(look_down(0.9))).points()[1, 1, 2] == pytest.approx(0.2, abs=1e-6)


# Camera files


def test_a_camera_file_gives_its_camera(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(
        "fx: 5e2\nfy: 500\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\ndistortion: [0.1, 0, 0, 0, 0]\n"
        "world_from_camera: [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.7], [0, 0, 0, 1]]\n"
    )
    camera = load_camera(path)
    assert camera.intrinsics == CameraIntrinsics(500, 500, 320, 240, 640, 480, (0.1, 0, 0, 0, 0))
    assert camera.pose == pytest.approx(look_down(0.7))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("fx: -1", "fx"),
        ("fx: .nan", "fx"),
        ("width: 6.5", "width"),
        ("distortion: [1, 2]", "distortion"),
        ("world_from_camera: [[1, 0], [0, 1]]", "world_from_camera"),
        ("world_from_camera: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]", "world_from_camera"),
        ("skew: 1", "skew"),
    ],
)
def test_wrong_camera_files_are_refused_by_file_and_key(tmp_path, change, words):
    lines = {"fx": "500", "fy": "500", "cx": "320", "cy": "240", "width": "640", "height": "480"}
    key, _, value = change.partition(": ")
    path = tmp_path / "mine.yaml"
    path.write_text("".join(f"{k}: {v}\n" for k, v in (lines | {key: value}).items()))
    with pytest.raises(ConfigError, match=words) as caught:
        load_camera(path)
    assert "mine.yaml" in str(caught.value) and "_CameraFile" not in str(caught.value)


@pytest.mark.parametrize("name", list(config.shipped("cameras")))
def test_shipped_cameras_decode(name):
    camera = load_camera(name)
    assert camera.intrinsics.fx > 100


def test_horizontal_jacobian_follows_the_projection_of_a_distorted_camera():
    lens = CameraIntrinsics(460.0, 455.0, 320.0, 238.0, 640, 480, (-0.28, 0.07, 0.001, -0.002, 0.0))
    camera = Camera(lens, look_down(0.7, tilt=0.3))
    points = np.array([[0.0, 0.0, 0.02], [0.15, 0.1, 0.05], [-0.2, -0.08, 0.0]])
    step = 1e-6
    for axis in (0, 1):
        moved = np.eye(3)[axis] * step
        expected = (camera.project(points + moved) - camera.project(points - moved))[:, :2] / (2 * step)
        np.testing.assert_allclose(camera.horizontal_jacobian(points)[:, :, axis], expected, rtol=1e-5, atol=1e-3)


def test_a_distortion_that_folds_the_image_is_refused(tmp_path):
    path = tmp_path / "fold.yaml"
    path.write_text("fx: 525\nfy: 525\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\ndistortion: [-5, 0, 0, 0, 0]\n")
    with pytest.raises(ConfigError, match=r"fold\.yaml.*distortion"):
        load_camera(path)


def test_a_camera_sees_what_lies_wholly_in_its_image():
    camera = Camera(CameraIntrinsics(525, 525, 319.5, 239.5, 640, 480), look_down(0.7))
    middle, right = [0.0, 0.0, 0.0], [0.41, 0.0, 0.0]  # 307 px right of the middle
    assert camera.sees([middle, right], 10) and not camera.sees([middle, right], 15)
    assert not camera.sees([middle, [0.0, 0.0, 0.8]], 0), "above the camera"


def test_millimetres_are_refused_however_the_image_is_made():
    camera = canonical_camera()
    depth = np.full((300, 300), 700, np.float32)
    for make in (lambda: DepthImage(depth, camera, depth > 0), lambda: DepthImage.from_array(depth, camera)):
        with pytest.raises(ImageError, match=r"median depth is 700.*millimetres"):
            make()
