import asyncio
from dataclasses import replace
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from workbench.inspector import actions as a
from workbench.inspector.orders import Choice, SceneRequest
from workbench.inspector.poses import matrix, vector
from workbench.inspector.scene3d.bodies import Bodies
from workbench.inspector.state import Pinned, Playback


@pytest.fixture
def bodies(bridge, client):
    made = Bodies(bridge)
    return made, {handle.label: handle for handle in client.made}


def test_the_gripper_stands_open_at_the_selected_grasp(bodies, shown):
    part, nodes = bodies
    part.update(None, shown)
    left, right = (np.array(nodes[f"/gripper/{side}_finger"].position) for side in ("left", "right"))
    grasp = shown.candidate.grasp
    assert (left + right)[:2] / 2 == pytest.approx(grasp.position[:2])
    assert np.linalg.norm(right - left) == pytest.approx(grasp.width + 0.01)


def test_a_replay_moves_all_bodies_and_hides_the_gizmo(bodies, shown, attempt):
    part, nodes = bodies
    part.update(None, shown)
    assert nodes["/gizmo"].visible
    playing = replace(shown, playback=Playback(shown.choice, attempt(), position=1.0))
    part.update(shown, playing)
    assert nodes["/objects/0"].position[2] == pytest.approx(0.1) and not nodes["/gizmo"].visible
    assert nodes["/contacts"].visible, "frame 10 has contacts"
    part.update(playing, shown)
    assert nodes["/objects/0"].position[2] == pytest.approx(0.03) and not nodes["/contacts"].visible


def test_the_objects_of_the_scene_before_stay_where_no_scene_could_be_made(bodies, shown):
    part, nodes = bodies
    part.update(None, shown)
    before = np.array(nodes["/objects/0"].position)
    failed = replace(shown, request=SceneRequest(), failure="no")
    part.update(shown, failed)
    assert nodes["/objects/0"].visible and nodes["/objects/0"].position == pytest.approx(before)
    assert not nodes["/gizmo"].visible
    part.update(failed, shown)
    assert nodes["/gizmo"].visible


def test_two_attempts_play_together(bodies, shown, attempt):
    part, nodes = bodies
    other = replace(shown, playback=Playback(shown.choice, attempt(1)), pinned=Pinned(Choice(0, 1), 0.5, attempt(0)))
    part.update(None, shown)
    part.update(shown, other)
    assert nodes["/compared/gripper/rod"].visible and nodes["/compared/objects/0"].visible
    part.update(other, replace(other, pinned=None))
    assert not nodes["/compared/gripper/rod"].visible


def test_the_object_follows_a_drag_and_the_gizmo_is_left_to_the_page(bodies, shown):
    part, nodes = bodies
    part.update(None, shown)
    before = nodes["/gizmo"].position
    moved = shown.scene.scene.objects[0].world_from_object.copy()
    moved[0, 3] += 0.07
    thing = msgspec.structs.replace(shown.request.things[0], at=vector(moved))
    dragging = replace(shown, request=SceneRequest((thing,)), dragging=True)
    part.update(shown, dragging)
    assert nodes["/objects/0"].position[0] == pytest.approx(moved[0, 3], abs=1e-4)
    assert np.array_equal(nodes["/gizmo"].position, before) and not nodes["/gripper/rod"].visible
    part.update(dragging, replace(dragging, dragging=False))
    assert nodes["/gizmo"].position[0] == pytest.approx(moved[0, 3], abs=1e-4)


def test_the_gizmo_and_clicks_on_objects_send_actions(bodies, posted):
    _, nodes = bodies
    gizmo = nodes["/gizmo"]
    gizmo.position = (0.1, 0.0, 0.05)
    for handler in gizmo.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0, phase="update")))
    for handler in nodes["/objects/2"].handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0, instance_index=None)))
    assert posted[0].at == (0.1, 0.0, 0.05, 1.0, 0.0, 0.0, 0.0) and not posted[0].ended
    assert posted[1] == a.Grab(2)


def test_sliding_follows_the_axes_of_the_table_however_the_object_lies(bodies, shown, posted):
    part, nodes = bodies
    lying = shown.scene.scene.objects[0].world_from_object.copy()
    lying[:3, :3] = Rotation.from_euler("xyz", [1.4, 0.3, 0.8]).as_matrix()
    thing = msgspec.structs.replace(shown.request.things[0], at=vector(lying))
    state = replace(shown, request=SceneRequest((thing,)))
    part.update(None, state)
    gizmo = nodes["/gizmo"]
    assert np.allclose(gizmo.wxyz, [1, 0, 0, 0])
    half = np.sqrt(0.5)
    gizmo.wxyz = np.array([half, 0, 0, half])  # a quarter turn about the vertical
    for handler in gizmo.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0, phase="end")))
    turned = matrix(posted[0].at)
    quarter = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    assert np.allclose(turned[:3, :3], quarter @ lying[:3, :3], atol=1e-4)
    after = replace(state, request=SceneRequest((msgspec.structs.replace(thing, at=posted[0].at),)))
    part.update(state, after)
    assert np.allclose(gizmo.wxyz, [half, 0, 0, half]), "the page's gizmo stays where it was let go"
    free = replace(after, mode="free")
    part.update(after, free)
    assert np.allclose(matrix((0, 0, 0, *gizmo.wxyz))[:3, :3], turned[:3, :3], atol=1e-4), "its own axes"


def test_the_held_object_lets_the_pointer_through_to_its_gizmo(bodies, shown):
    part, nodes = bodies
    part.update(None, shown)
    assert not nodes["/objects/0"].handlers and nodes["/objects/1"].handlers
    part.update(shown, replace(shown, grabbed=1))
    assert nodes["/objects/0"].handlers and not nodes["/objects/1"].handlers


def test_free_mode_has_all_axes(bodies, shown):
    part, nodes = bodies
    part.update(None, shown)
    assert nodes["/gizmo"].active_axes == (True, True, False)
    part.update(shown, replace(shown, mode="free"))
    assert nodes["/gizmo"].active_axes == (True, True, True)
