import numpy as np
import pytest

from grasp_core.grasp import Grasp
from grasp_core.simulation.gripper_model import GripperModel, isometry
from grasp_core.simulation.trial import GraspTrial, Outcome
from grasp_core.simulation.world import World


def closed_on_box(physics, gripper, shapes, steps: int = 300) -> World:
    asset = shapes.box(0.04, 0.06, 0.06)
    pose = shapes.standing(asset)
    world = World([asset], physics, gripper, poses=[pose])
    world.rewind([pose])
    world.gripper.place(Grasp((0, 0, 0.02), 0.0, 0.1).world_from_gripper, (0.0, 0.0))
    for _ in range(steps):
        world.gripper.command(0.0)
        world.step()
    return world


def felt_force(world: World) -> tuple[float, float]:
    """Normal force of the left and the right finger, N."""
    found = world.touches()
    return tuple(-sum(float(t.force @ t.normal) for t in found if t.finger == side) for side in (0, 1))


def test_the_commanded_force_is_felt(physics, gripper, shapes):
    left, right = felt_force(closed_on_box(physics, gripper, shapes))
    assert left == pytest.approx(gripper.force, rel=0.02)
    assert right == pytest.approx(gripper.force, rel=0.02)


def test_a_damping_coefficient_would_weaken_the_grip(physics, gripper, shapes, monkeypatch):
    """The cure is needed: the same drag as DART's own damping loses a third of the force."""

    def damped(self, lift_speed):
        for pad in self.pads:
            pad.getParentJoint().setDampingCoefficient(0, self._drag)
        self.skeleton.setCommands([lift_speed, *[self._push] * 4])

    monkeypatch.setattr(GripperModel, "command", damped)
    left, right = felt_force(closed_on_box(physics, gripper, shapes))
    assert max(left, right) < 0.75 * gripper.force


def fastest_closing(physics, gripper, shapes) -> float:
    asset = shapes.box(0.01, 0.06, 0.06)
    pose = shapes.standing(asset)
    world = World([asset], physics, gripper, poses=[pose])
    world.rewind([pose])
    world.gripper.place(Grasp((0, 0, 0.02), 0.0, 0.1).world_from_gripper, (0.0, 0.0))
    speeds = []
    for _ in range(200):
        world.gripper.command(0.0)
        world.step()
        speeds.append(max(map(abs, world.gripper.skeleton.getVelocities().tolist()[1:])))  # of the four pads
    return max(speeds)


def test_fingers_keep_their_speed_limit(physics, gripper, shapes):
    assert fastest_closing(physics, gripper, shapes) < gripper.speed * 1.05


def test_without_the_drag_fingers_are_far_too_fast(physics, gripper, shapes, monkeypatch):
    made = GripperModel.__init__

    def undamped(self, spec, physics):
        made(self, spec, physics)
        self._drag = 0.0

    monkeypatch.setattr(GripperModel, "__init__", undamped)
    assert fastest_closing(physics, gripper, shapes) > 5 * gripper.speed


def turned(physics, gripper, shapes, rigid: bool) -> float:
    """Degrees by which a 0.3 kg box turns when held 4.5 cm off its centre and lifted."""
    trial = GraspTrial(shapes.alone(shapes.box(0.04, 0.14, 0.06, mass=0.3)), gripper, physics, None, whole=True)
    if rigid:  # one full-width box a finger instead of two pads
        for index, pad in enumerate(trial._executes().engine.gripper.pads):
            if index % 2:
                pad.setCollidable(False)
            else:
                node = pad.getShapeNode(0)
                node.getShape().setSize(gripper.finger.size)
                offset = np.eye(4)
                offset[1, 3] = gripper.finger.y / 4
                node.setRelativeTransform(isometry(offset))
    attempt = trial.attempt(Grasp((0, 0.045, 0.03), 0.0, 0.1), 0)
    assert attempt.outcome is Outcome.SUCCESS
    return float(np.degrees(attempt.comfort.rotation))


def test_split_pads_resist_torsion(physics, gripper, shapes):
    assert turned(physics, gripper, shapes, rigid=False) < 2.0


def test_rigid_fingers_would_let_it_pivot(physics, gripper, shapes):
    assert turned(physics, gripper, shapes, rigid=True) > 20.0


def test_fingers_stop_at_the_centre_plane(physics, gripper, shapes):
    asset = shapes.box(0.04, 0.06, 0.06)
    pose = shapes.standing(asset, x=0.5)
    world = World([asset], physics, gripper, poses=[pose])
    world.rewind([pose])
    world.gripper.place(Grasp((0, 0, 0.02), 0.3, 0.1).world_from_gripper, (0.0, 0.0))
    for _ in range(300):
        world.gripper.command(0.0)
        world.step()
    left, right = world.gripper.travel
    assert left == pytest.approx(gripper.opening / 2, abs=1e-3)
    assert right == pytest.approx(gripper.opening / 2, abs=1e-3)


def test_boxes_stand_where_the_gripper_says(physics, gripper):
    model = GripperModel(gripper, physics)
    grasp = Grasp((0.1, -0.05, 0.03), 0.7, 0.06)
    travel = (gripper.opening - 0.06) / 2
    model.place(grasp.world_from_gripper, (travel, travel))
    origin = [0, 0, physics.table_height]
    for name, first in (("left_finger", 0), ("right_finger", 2)):
        box, centre = gripper.boxes(0.06)[name]
        middle = np.mean([pad.getWorldTransform().translation() for pad in model.pads[first : first + 2]], axis=0)
        expected = grasp.world_from_gripper @ [*centre, 1.0]
        assert np.allclose(middle - origin, expected[:3], atol=1e-12)
        size = model.pads[first].getShapeNode(0).getShape().getSize()
        assert np.allclose(size, [box.x, box.y / 2, box.z])
    for node in model.base.getShapeNodes():
        box, centre = gripper.boxes()[node.getName()]
        assert np.allclose(node.getShape().getSize(), box.size)
        expected = grasp.world_from_gripper @ [*centre, 1.0]
        assert np.allclose(node.getWorldTransform().translation() - origin, expected[:3], atol=1e-12)


def test_lift_follows_the_command(physics, gripper):
    world = World([], physics, gripper)
    world.rewind([])
    world.gripper.place(Grasp((0, 0, 0.1), 0.0, 0.1).world_from_gripper, (0.0, 0.0))
    for _ in range(100):
        world.gripper.command(0.3)
        world.step()
    assert world.gripper.lift == pytest.approx(0.3 * 100 * physics.time_step, rel=1e-6)
