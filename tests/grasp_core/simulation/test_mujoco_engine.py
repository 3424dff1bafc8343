import numpy as np
import pytest

from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp
from grasp_core.simulation.crosscheck import Judge
from grasp_core.simulation.evidence import Outcome

pytest.importorskip("mujoco")

from grasp_core.simulation.mujoco_engine import MujocoEngine


@pytest.fixture(scope="module")
def asset(shapes):
    return shapes.box(0.04, 0.06, 0.06)


@pytest.fixture(scope="module")
def engine(asset, physics, gripper):
    return MujocoEngine([asset], physics, gripper)


def closed(engine, asset, shapes, steps=400):
    engine.rewind([shapes.standing(asset)])
    engine.grip(Grasp((0, 0, 0.02), 0.0, 0.1).world_from_gripper, (0.0, 0.0))
    engine.advance(steps)


def test_same_masses_and_inertia(engine, asset, physics):
    body = engine.model.body("object_0")
    assert body.mass[0] == pytest.approx(physics.mass(asset))
    expected = np.linalg.eigvalsh(asset.unit_inertia * physics.mass(asset) / asset.volume)
    assert np.sort(body.inertia) == pytest.approx(expected, rel=1e-6)
    assert engine.model.opt.timestep == physics.time_step


def test_objects_rest_and_poses_round_trip(engine, asset, shapes):
    pose = shapes.standing(asset, x=0.1)
    engine.rewind([pose])
    assert np.allclose(engine.objects[0].pose, pose, atol=1e-12)
    engine.advance(300)
    assert np.allclose(engine.objects[0].pose, pose, atol=1e-3)
    assert max(map(abs, engine.objects[0].velocity)) < 0.02


def test_force_speed_and_contacts_match_the_gripper(engine, asset, shapes, gripper):
    closed(engine, asset, shapes, 10)
    before = engine.travel
    engine.advance(5)
    for now, then in zip(engine.travel, before, strict=True):
        assert gripper.speed * 0.9 < (now - then) / (5 * engine.physics.time_step) < gripper.speed * 1.05
    closed(engine, asset, shapes)
    assert engine.touched() == (True, True)
    found = engine.touches()
    for side in (0, 1):
        mine = [touch for touch in found if touch.finger == side]
        assert -sum(float(t.force @ t.normal) for t in mine) == pytest.approx(gripper.force, rel=0.05)
        centre = engine.objects[0].pose[:3, 3]
        assert all(float(t.normal @ (t.point - centre)) > 0 for t in mine)  # out of the object
    left, right = engine.travel
    assert left + right == pytest.approx(0.06, abs=3e-3)


def test_lift_follows_speed_and_acceleration(engine, asset, shapes):
    closed(engine, asset, shapes)
    dt = engine.physics.time_step
    engine.advance(25, 0.0, 3.0)
    assert engine.rising == pytest.approx(25 * dt * 3.0, rel=0.05)
    before = engine.lift
    engine.advance(50, 0.15)
    assert engine.lift - before == pytest.approx(0.15 * 50 * dt, rel=0.05)
    assert engine.objects[0].pose[2, 3] - 0.03 == pytest.approx(engine.lift, abs=1e-3)


def test_rewinding_repeats_bit_for_bit(engine, asset, shapes):
    ends = []
    for _ in range(2):
        closed(engine, asset, shapes)
        ends.append(engine.objects[0].pose.tobytes())
    assert ends[0] == ends[1]
    assert not engine.diverged


def test_the_same_verdicts_where_there_is_no_doubt(asset, shapes, physics, gripper):
    scene = shapes.alone(asset)
    judges = [Judge(name, scene, gripper, physics) for name in ("dart", "mujoco")]
    for grasp, outcome in (
        (Grasp((0, 0, 0.02), 0.0, 0.1), Outcome.SUCCESS),
        (Grasp((0, 0, 0.02), np.pi / 2, 0.1), Outcome.SUCCESS),
        (Grasp((0, 0.038, 0.055), 0.6, 0.1), Outcome.MISSED),
    ):
        assert [judge.verdict(grasp) for judge in judges] == [outcome, outcome]


def test_a_model_that_mujoco_refuses_is_an_error(asset, physics, gripper):
    from dataclasses import replace

    flat = replace(asset, unit_inertia=np.diag([1.0, 1e-9, 1e-9]))
    with pytest.raises(GraspError, match="MuJoCo refuses the scene"):
        MujocoEngine([flat], physics, gripper)
