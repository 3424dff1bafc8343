import math

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from grasp_core.camera import canonical_camera, look_down
from grasp_core.errors import GraspError
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import PlacedObject, Scene, place


def block() -> ObjectAsset:
    mesh = trimesh.creation.box((0.1, 0.04, 0.02))
    part = Part(np.array(mesh.vertices), np.array(mesh.faces, np.int32))
    return ObjectAsset("block", "block", part.vertices, part.faces, (part,), float(mesh.volume), np.eye(3) * 1e-5)


def lying(height: float = 0.01) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = height
    return pose


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-math.pi, math.pi))
def test_place_turns_about_the_origin_and_keeps_the_height(x, y, yaw):
    placed = place(lying(), x, y, yaw)
    assert placed[:3, 3] == pytest.approx([x, y, 0.01])
    assert placed[:3, 0] == pytest.approx([math.cos(yaw), math.sin(yaw), 0])
    assert placed[:3, 2] == pytest.approx([0, 0, 1])


def test_place_keeps_a_tipped_pose_tipped():
    tipped = np.eye(4)
    tipped[:3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]  # the object's x points down
    tipped[:3, 3] = [0.4, 0.4, 0.05]
    placed = place(tipped, 0.0, 0.1, math.pi / 2)
    assert placed[:3, 0] == pytest.approx([0, 0, -1])
    assert placed[:3, 3] == pytest.approx([0, 0.1, 0.05])


def test_vertices_are_in_the_world():
    scene = Scene.single(block(), place(lying(), 0.2, 0.1, math.pi / 2))
    vertices = scene.objects[0].vertices
    assert vertices.min(0) == pytest.approx([0.18, 0.05, 0.0])
    assert vertices.max(0) == pytest.approx([0.22, 0.15, 0.02])


def test_a_scene_has_the_canonical_camera_unless_told_otherwise():
    assert Scene.single(block(), lying()).camera == canonical_camera()
    other = canonical_camera().at(look_down(0.9))
    assert Scene.single(block(), lying(), other).camera == other


def test_moved_changes_one_object_and_leaves_the_scene_alone():
    first = PlacedObject(block(), lying())
    scene = Scene((first, first), canonical_camera())
    moved = scene.moved(1, place(lying(), 0.1, 0, 0))
    assert moved.objects[0] is first and moved.objects[1].asset is first.asset
    assert moved.objects[1].world_from_object[0, 3] == 0.1
    assert scene.objects[1].world_from_object[0, 3] == 0


def test_a_pose_that_is_none_is_refused():
    with pytest.raises(GraspError, match="world_from_object"):
        Scene.single(block(), np.diag([2.0, 1.0, 1.0, 1.0]))
    with pytest.raises(GraspError, match="4×4"):
        PlacedObject(block(), np.eye(3))


def test_a_placed_object_keeps_its_pose():
    pose = lying()
    placed = PlacedObject(block(), pose)
    pose[2, 3] = 5
    assert placed.world_from_object[2, 3] == 0.01
    with pytest.raises(ValueError, match="read-only"):
        placed.world_from_object[2, 3] = 5
