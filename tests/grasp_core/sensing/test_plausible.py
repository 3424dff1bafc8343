import numpy as np
import pytest

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, look_down
from grasp_core.errors import ImageError
from grasp_core.sensing.plausible import check_height, check_table
from grasp_core.sensing.rectify import rectify

K = CameraIntrinsics(525, 525, 319.5, 239.5, 640, 480)


def image(scale: float = 1.0, pose: np.ndarray | None = None) -> DepthImage:
    depth = np.full((480, 640), 0.7)
    depth[200:260, 250:400] = 0.65
    return DepthImage.from_array(depth * scale, Camera(K, pose))


@pytest.mark.parametrize("height", [0.25, 0.44, 0.7, 3.0])
def test_cameras_where_cameras_stand_are_taken(height):
    check_height(height, True)
    check_height(height, False)


@pytest.mark.parametrize("scale", [0.1, 0.2, 10])
def test_depths_in_another_unit_put_the_found_table_where_none_can_be(scale):
    with pytest.raises(ImageError, match=rf"{0.7 * scale:.3g} m above the table.*scale.*metres, not dm, cm or mm"):
        rectify(image(scale))
    rectify(image())


@pytest.mark.parametrize("height", [0.07, 7.0])
def test_poses_where_no_camera_stands_are_refused(height):
    with pytest.raises(ImageError, match=r"as its pose has it.*world_from_camera"):
        rectify(image(height / 0.7, look_down(height)))


@pytest.mark.parametrize("scale", [0.1, 0.5, 0.9, 2, 10])
def test_depths_that_do_not_fit_the_pose_are_refused(scale):
    with pytest.raises(ImageError, match=r"world_from_camera"):
        rectify(image(scale, look_down(0.7)))
    rectify(image(1.0, look_down(0.7)))


def test_a_little_of_the_table_is_enough():
    heights = np.full((100, 100), 0.2, np.float32)
    with pytest.raises(ImageError, match=r"\+0\.20 m from there"):
        check_table(heights)
    heights[:, :4] = 0.01
    check_table(heights)
    check_table(np.full((100, 100), -np.inf, np.float32))
