"""The URDF that people see and the boxes that physics uses are the same gripper."""

import numpy as np
import pytest
import yourdfpy

from grasp_core import config
from grasp_core.gripper import load_gripper

NAMES = sorted(config.shipped("grippers"))


def test_a_second_worked_gripper_ships():
    assert {"paper", "compact"} <= set(NAMES)
    assert load_gripper("compact").digest != load_gripper("paper").digest


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("name", NAMES)
def test_boxes_and_urdf_agree_at_every_opening(name, share):
    gripper = load_gripper(name)
    assert gripper.urdf is not None
    robot = yourdfpy.URDF.load(gripper.urdf)
    travel = share * gripper.opening / 2
    robot.update_cfg(dict.fromkeys(robot.actuated_joint_names, travel))
    for part, (box, centre) in gripper.boxes(gripper.opening * (1 - share)).items():
        for shapes in (robot.link_map[part].visuals, robot.link_map[part].collisions):
            assert np.allclose(shapes[0].geometry.box.size, box.size)
        assert np.allclose(robot.get_transform(part, "gripper")[:3, 3], centre, atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_joints_stop_at_the_centre_plane_with_the_grippers_force_and_speed(name):
    gripper = load_gripper(name)
    robot = yourdfpy.URDF.load(str(gripper.urdf))
    for side in ("left", "right"):
        limit = robot.joint_map[f"{side}_finger_joint"].limit
        assert (limit.lower, limit.upper) == (0, pytest.approx(gripper.opening / 2))
        assert (limit.effort, limit.velocity) == (pytest.approx(gripper.force), pytest.approx(gripper.speed))
