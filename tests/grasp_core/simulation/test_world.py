import numpy as np
import pytest

import grasp_core.simulation.world as world_module
from grasp_core.simulation.world import World


def sunk(world: World, pose: np.ndarray, seconds: float = 0.6) -> float:
    """How far the lowest point of object 0 is below the table after a while, metres."""
    world.rewind([pose])
    for _ in range(int(seconds / world.physics.time_step)):
        world.step()
    after = world.objects[0].pose
    return -float((world.objects[0].asset.hull.vertices @ after[2, :3]).min() + after[2, 3])


def test_objects_do_not_sink(physics, shapes):
    for asset in (shapes.box(0.04, 0.12, 0.06), shapes.can(), shapes.bowl(), shapes.mug()):
        pose = shapes.standing(asset)
        assert abs(sunk(World([asset], physics, poses=[pose]), pose)) < 2e-4, asset.name


def test_without_feet_they_sink(physics, shapes, monkeypatch):
    """The cure is needed: parts that touch the table themselves let a box of one part in by millimetres."""
    asset = shapes.box(0.04, 0.12, 0.06)
    pose = shapes.standing(asset)
    monkeypatch.setattr(world_module, "support_points", lambda asset, most, pose=None: np.zeros((0, 3)))
    monkeypatch.setattr(World, "_separate", lambda self, table: None)
    assert sunk(World([asset], physics, poses=[pose]), pose) > 0.002


def test_rest_is_reached_at_the_true_height(physics, shapes):
    asset = shapes.box(0.04, 0.12, 0.06)
    pose = shapes.standing(asset)
    above = pose.copy()
    above[2, 3] += 0.003
    world = World([asset], physics, poses=[pose])
    world.rewind([above])
    for _ in range(500):
        world.step()
    assert world.objects[0].pose[2, 3] == pytest.approx(0.03, abs=3e-4)


def test_slow_bodies_stay_awake(physics, shapes):
    """DART's own sleeping would stop a slow slip: an object pushed at 5 mm/s without friction must keep moving."""
    asset = shapes.box(0.04, 0.04, 0.04)
    world = World([asset], physics, poses=[shapes.standing(asset)])
    world.world.setGravity([0.0, 0.0, 0.0])
    world.rewind([shapes.standing(asset)])
    world.objects[0].skeleton.setVelocities(np.array([0, 0, 0, 0.005, 0, 0]))
    for _ in range(1000):
        world.step()
    assert world.objects[0].pose[0, 3] == pytest.approx(0.01, rel=1e-3)


def test_objects_rest_on_each_other(physics, shapes):
    lower, upper = shapes.box(0.1, 0.1, 0.04), shapes.box(0.05, 0.05, 0.03)
    poses = [shapes.standing(lower), shapes.standing(upper)]
    poses[1][2, 3] += 0.04
    world = World([lower, upper], physics, poses=poses)
    world.rewind(poses)
    for _ in range(300):
        world.step()
    assert world.objects[1].pose[2, 3] == pytest.approx(0.055, abs=2e-3)


def test_divergence_is_seen(physics, shapes):
    asset = shapes.can()
    world = World([asset], physics, poses=[shapes.standing(asset)])
    world.rewind([shapes.standing(asset)])
    assert not world.diverged
    world.objects[0].skeleton.setVelocities(np.array([0, 0, 0, 0, 0, 100.0]))
    assert world.diverged
    world.objects[0].skeleton.setVelocities(np.array([0, 0, 0, 0, 0, np.nan]))
    assert world.diverged


def test_fcl_is_a_choice(physics, shapes):
    import msgspec

    asset = shapes.box(0.04, 0.12, 0.06)
    pose = shapes.standing(asset)
    world = World([asset], msgspec.structs.replace(physics, detector="fcl"), poses=[pose])
    assert world.world.getConstraintSolver().getCollisionDetector().getType() == "fcl"
    assert abs(sunk(world, pose, 0.1)) < 2e-4
