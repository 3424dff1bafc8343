from types import SimpleNamespace

import numpy as np
import pytest

from grasp_core.grasp import Grasp
from grasp_core.simulation.contacts import ContactReader, Touch, finger_contacts
from grasp_core.simulation.world import World


class Shape:
    """A shape as DART has it: known by its name, told apart by identity."""

    def __init__(self, name):
        self.getName = lambda: name


NAMES = [f"{finger}_finger/{end}" for finger in ("left", "right") for end in ("front", "back")]
NAMES += ["table", "rod", "base", *(f"object_{number}/{part}" for number in range(13) for part in ("0", "1", "feet"))]
SHAPES = {name: Shape(name) for name in NAMES}
READER = ContactReader(SHAPES.values(), 0.0)


def body(name):
    return SimpleNamespace(getShapeFrame=lambda: SHAPES[name])


def made(first, second, normal=(1.0, 0, 0), force=(2.0, 0, 1.0), point=(0.1, 0.2, 0.3)):
    """A contact as DART reports it: normal and force point from the second body to the first."""
    return SimpleNamespace(
        collisionObject1=body(first),
        collisionObject2=body(second),
        point=np.array(point),
        normal=np.array(normal),
        force=np.array(force),
    )


def test_either_order_gives_the_force_on_the_object():
    (one,) = READER.touches([made("object_3/0", "left_finger/front")])
    (two,) = READER.touches([made("left_finger/back", "object_3/1", (-1.0, 0, 0), (-2.0, 0, -1.0))])
    for touch in (one, two):
        assert (touch.finger, touch.object) == (0, 3)
        assert touch.force.tolist() == [2, 0, 1]
        assert touch.normal.tolist() == [-1, 0, 0]
        assert touch.point.tolist() == [0.1, 0.2, 0.3]


def test_points_count_from_the_table_and_a_contact_at_the_origin_is_none():
    reader = ContactReader(SHAPES.values(), 1.0)
    contacts = [made("object_0/0", "left_finger/front", point=point) for point in ((0.1, 0.2, 1.3), (0.0, 0.0, 0.0))]
    (touch,) = reader.touches(contacts)
    assert np.allclose(touch.point, [0.1, 0.2, 0.3])


def test_what_is_no_finger_on_an_object_is_left_out():
    others = [
        made("table", "object_0/feet"),
        made("object_0/0", "object_1/0"),
        made("rod", "object_0/0"),
        made("left_finger/front", "right_finger/front"),
    ]
    assert READER.touches(others) == []


def test_a_gripped_box_is_pressed_from_both_sides(physics, gripper, shapes):
    """The signs come from DART itself: each finger presses with its 20 N into the box, normals point outwards."""
    box = shapes.box(0.04, 0.06, 0.06)
    pose = shapes.standing(box)
    world = World([box], physics, gripper, poses=[pose])
    world.rewind([pose])
    grasp = Grasp((0, 0, 0.03), 0.0, 0.1)
    world.grip(grasp.world_from_gripper, (0.028, 0.028))
    world.advance(100)
    found = world.touches()
    assert world.touched() == (True, True)
    for finger, side in ((0, -1.0), (1, 1.0)):
        own = [touch for touch in found if touch.finger == finger]
        assert own and all(touch.normal @ [side, 0, 0] > 0.99 for touch in own)
        assert sum(float(touch.force[0]) for touch in own) == pytest.approx(-side * 20, rel=0.1)
        assert all(touch.point[0] * side == pytest.approx(0.02, abs=2e-3) for touch in own)
    left, right = finger_contacts(found, grasp.world_from_gripper)
    assert left.kind == right.kind == "face"


def touch(finger, item, point, normal, force):
    return Touch(finger, item, np.array(point, float), np.array(normal, float), np.array(force, float))


def test_sums_per_finger_in_the_grippers_frame():
    """The gripper is turned by 90°: its x is the world's y."""
    frame = Grasp((1.0, 2.0, 0.5), np.pi / 2 - 1e-12, 0.1).world_from_gripper
    frame[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    found = [
        touch(0, 0, [1.0, 1.98, 0.51], [0, -1, 0], [0, 3, 0]),
        touch(0, 0, [1.0, 1.98, 0.55], [0, -1, 0], [0, 1, 0.5]),
    ]
    left, right = finger_contacts(found, frame)
    assert right is None
    assert left.object == 0
    assert left.force == 4.0
    assert left.friction == 0.5
    assert left.normal == pytest.approx((-1, 0, 0), abs=1e-6)
    assert left.point == pytest.approx((-0.02, 0, 0.02), abs=1e-6)  # three quarters of the force at the lower one
    assert left.kind == "edge"


def test_the_object_pressed_harder_counts():
    found = [
        touch(1, 4, [0, 0, 0], [1, 0, 0], [-1, 0, 0]),
        touch(1, 4, [0, 0, 0.01], [1, 0, 0], [-1, 0, 0]),
        touch(1, 7, [0, 0, 0.03], [1, 0, 0], [-5, 0, 0]),
    ]
    left, right = finger_contacts(found, np.eye(4))
    assert left is None
    assert (right.object, right.force, right.kind) == (7, 5.0, "point")


def test_no_touch_no_contact():
    assert finger_contacts([], np.eye(4)) == (None, None)
