import numpy as np
import pytest

from grasp_core.camera import Camera, CameraIntrinsics, look_down
from grasp_core.dataset.rows import camera_from_json, camera_json, pose_from_json, pose_json
from grasp_core.errors import StoreError


@pytest.mark.parametrize("pose", [None, look_down(0.65, 0.1, -0.2, 0.3)])
def test_camera_round_trip_is_exact(pose):
    camera = Camera(CameraIntrinsics(525.1, 524.9, 319.5, 239.5, 640, 480, (0.1, -0.2, 0.001, 0.002, 0.0)), pose)
    back = camera_from_json(camera_json(camera))
    assert back.intrinsics == camera.intrinsics
    assert (back.world_from_camera is None) == (pose is None)
    if pose is not None:
        assert np.array_equal(back.pose, camera.pose)


def test_pose_round_trip_is_exact():
    pose = look_down(1 / 3, tilt=0.1)
    assert np.array_equal(pose_from_json(pose_json(pose)), pose)
    for bad in ("[1,2]", "nonsense"):
        with pytest.raises(StoreError, match="4×4"):
            pose_from_json(bad)


def test_table_rows_are_grasps(store):
    table = store.grasps(1)
    assert len(list(table)) == len(table) == 4
    assert table.grasp(2).position == (0.02, 0.0, 0.02)
    assert table.used.all()
