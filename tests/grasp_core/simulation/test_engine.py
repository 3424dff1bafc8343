"""One contract for all engines: what `Engine` promises holds in DART and, where it is installed, in MuJoCo."""

import inspect

import numpy as np
import pytest

from grasp_core.grasp import Grasp
from grasp_core.simulation.engine import Engine, EngineObject
from grasp_core.simulation.world import World

GRASP = Grasp((0.01, -0.02, 0.03), 0.4, 0.1)


def members(protocol):
    return {name for name in vars(protocol) if not name.startswith("_")}


@pytest.fixture(params=["dart", "mujoco"])
def engine(request, physics, gripper, shapes):
    """An engine with a box that lies across the gripper's closing axis, 4 cm wide."""
    box = shapes.box(0.04, 0.06, 0.06)
    pose = shapes.standing(box, 0.01, -0.02)
    pose[:3, :3] = GRASP.world_from_gripper[:3, :3]
    if request.param == "dart":
        made = World([box], physics, gripper, poses=[pose])
    else:
        pytest.importorskip("mujoco", reason="MuJoCo is not installed; pip install 'grasp-workbench[crosscheck]'")
        from grasp_core.simulation.mujoco_engine import MujocoEngine

        made = MujocoEngine([box], physics, gripper)
    made.rewind([pose])
    return made, pose


def test_has_all_that_an_attempt_needs(engine):
    made, _ = engine
    assert len(members(Engine)) >= 14 and members(EngineObject) == {"asset", "pose", "velocity"}
    assert all(hasattr(made, name) for name in members(Engine))
    assert all(hasattr(made.objects[0], name) for name in members(EngineObject))
    for name in ("rewind", "grip", "advance"):
        assert list(inspect.signature(getattr(made, name)).parameters) == [
            parameter for parameter in inspect.signature(getattr(Engine, name)).parameters if parameter != "self"
        ]


def test_rewound_all_is_where_it_should_be_and_at_rest(engine, physics, gripper):
    made, pose = engine
    assert made.time == 0 and not made.diverged
    assert made.spec is gripper
    assert (made.physics.friction, made.physics.lift_height) == (physics.friction, physics.lift_height)
    assert np.allclose(made.objects[0].pose, pose, atol=1e-9)
    assert np.allclose(made.objects[0].velocity, 0, atol=1e-9)
    assert made.touched() == (False, False) and made.touches() == []


def test_a_pose_is_a_copy(engine):
    made, pose = engine
    made.objects[0].pose[2, 3] += 1
    assert np.allclose(made.objects[0].pose, pose, atol=1e-9)


def test_fingers_close_on_the_box_and_lift_it(engine):
    made, pose = engine
    step, dart = made.physics.time_step, isinstance(made, World)
    made.grip(GRASP.world_from_gripper, (0.025, 0.025))
    assert made.travel == pytest.approx((0.025, 0.025)) and made.lift == 0
    made.advance(100)
    assert made.time == pytest.approx(100 * step)
    assert made.travel == pytest.approx((0.03, 0.03), abs=1e-3)
    assert made.touched() == (True, True)
    assert {(touch.finger, touch.object) for touch in made.touches()} == {(0, 0), (1, 0)}
    still = made.travel
    made.advance(10)
    assert made.travel == pytest.approx(still, abs=1e-4), "they stand still"
    for finger, sign in ((0, 1.0), (1, -1.0)):
        push = sum(touch.force for touch in made.touches() if touch.finger == finger)
        assert push @ GRASP.closing_axis == pytest.approx(sign * 20, rel=0.15)
        assert all(
            touch.normal @ GRASP.closing_axis * sign < -0.9 for touch in made.touches() if touch.finger == finger
        )
    # 0.2 m/s² for half a second: 25 mm
    made.advance(round(0.5 / step), 0.0, 0.2)
    assert made.rising == pytest.approx(0.1, rel=0.05)
    assert made.lift == pytest.approx(0.025, rel=0.05)
    # MuJoCo's stiff servo lets what is held creep up by a centimetre per second while the base accelerates
    assert made.objects[0].pose[2, 3] - pose[2, 3] == pytest.approx(made.lift, abs=2e-3 if dart else 8e-3)
    assert made.objects[0].velocity[2] == pytest.approx(made.rising, abs=2e-3 if dart else 0.015)
    made.advance(10, 0.1)
    assert made.rising == pytest.approx(0.1, rel=0.02)


def test_a_push_acts_until_it_is_changed_or_rewound(engine):
    """On the table 5 N upwards outweigh 0.072 kg: a = F / m - g, in every step until the push ends."""
    made, pose = engine
    mass, step = made.physics.mass(made.objects[0].asset), made.physics.time_step
    aside = GRASP.world_from_gripper
    aside[2, 3] = 1.0
    made.grip(aside, (0.0, 0.0))
    made.push(0, np.array([0.0, 0.0, 5.0]))
    made.advance(20)
    up = (5.0 / mass - made.physics.gravity) * 20 * step
    assert made.objects[0].velocity[2] == pytest.approx(up, rel=0.02)
    assert np.allclose(made.objects[0].velocity[3:], 0, atol=1e-6)
    made.push(0, np.zeros(3))
    made.advance(10)
    assert made.objects[0].velocity[2] == pytest.approx(up - made.physics.gravity * 10 * step, rel=0.02)
    made.push(0, np.array([0.0, 0.0, 5.0]))
    made.rewind([pose])
    made.advance(10)
    assert np.allclose(made.objects[0].pose, pose, atol=5e-4)


def test_rewinding_forgets(engine):
    made, pose = engine
    made.grip(GRASP.world_from_gripper, (0.028, 0.028))
    made.advance(60, 0.0, 1.0)
    made.rewind([pose])
    assert made.time == 0 and made.touched() == (False, False)
    assert np.allclose(made.objects[0].pose, pose, atol=1e-9)
    made.advance(20)
    assert made.touched() == (False, False)
    assert np.allclose(made.objects[0].pose, pose, atol=5e-4)
