from dataclasses import replace

import numpy as np
import pytest
import trimesh

from grasp_core.gripper import load_gripper
from workbench.inspector.actions import Select
from workbench.inspector.scene3d import Scene3d, batch, forces, fork, frame_at, shaded
from workbench.inspector.state import Playback


def test_the_fork_is_as_wide_as_the_gripper_opens():
    small = fork(load_gripper())
    assert np.ptp(small.vertices[:, 0]) == pytest.approx(0.10, abs=0.005)
    assert small.vertices[:, 2].min() == pytest.approx(0.0)
    assert small.is_watertight


def test_sharp_edges_are_cut_and_round_ones_kept():
    box, ball = trimesh.creation.box(), trimesh.creation.icosphere(subdivisions=3)
    assert len(shaded(box)[0]) == 24
    vertices, faces = shaded(ball)
    assert len(vertices) == len(ball.vertices) and len(faces) == len(ball.faces)


def test_forks_stand_at_their_grasps_and_the_selected_one_is_hidden(opened):
    grasps = [candidate.grasp for candidate in opened.plan.candidates]
    turns, places = batch(grasps, 1)
    assert np.allclose(places[[0, 2]], [grasps[0].position, grasps[2].position])
    assert places[1, 2] < -1
    angle = 2 * np.arctan2(turns[0, 3], turns[0, 0])
    assert angle == pytest.approx(grasps[0].angle)
    assert batch([], None)[1].shape == (1, 3)


@pytest.mark.parametrize(
    "position, expected", [(0.0, (0, 1, 0.0)), (0.15, (1, 2, 0.5)), (2.0, (19, 20, 1.0)), (9.0, (19, 20, 1.0))]
)
def test_frames_follow_the_time(attempt, position, expected):
    before, after, part = frame_at(Playback(attempt(0), position))
    assert (before, after) == expected[:2] and part == pytest.approx(expected[2])


def test_forces_end_in_the_contact(attempt):
    recording = attempt(0).recording
    lines = forces(recording, 10)
    assert lines.shape == (2, 2, 3) and np.allclose(lines[:, 1], 0) and (lines[:, 0] < 0).all()
    assert forces(recording, 3) is None


@pytest.fixture
def scene(bridge):
    return Scene3d(bridge, load_gripper())


def node(client, name):
    return next(handle for handle in client.made if getattr(handle, "label", None) == name)


def test_the_scene_shows_object_camera_gripper_and_candidates(scene, client, shown):
    scene.update(None, shown)
    placed = shown.scene.scene.objects[0]
    assert np.allclose(node(client, "/objects/0").position, placed.world_from_object[:3, 3])
    assert node(client, "/objects/0").visible and not node(client, "/objects/1").visible
    assert np.allclose(node(client, "/camera").position, [0, 0, 0.7])
    assert node(client, "/camera").image.shape == (300, 300, 3)
    assert len(node(client, "/candidates").batched_positions) == 3
    grasp = shown.candidates[0].grasp
    fingers = [np.array(node(client, f"/gripper/{side}_finger").position) for side in ("left", "right")]
    assert np.allclose(np.mean(fingers, axis=0)[:2], grasp.position[:2])
    inner = np.linalg.norm(fingers[0] - fingers[1]) - load_gripper().finger.x
    assert inner == pytest.approx(grasp.width)


def test_nothing_is_shown_before_the_first_scene(scene, client, state):
    scene.update(None, state)
    assert not any(node(client, name).visible for name in ("/candidates", "/camera", "/objects/0", "/gripper/rod"))


def test_a_replay_moves_every_body_and_its_end_brings_them_back(scene, client, shown, attempt):
    scene.update(None, shown)
    playing = replace(shown, playback=Playback(attempt(0), 1.0))
    scene.update(shown, playing)
    assert np.allclose(node(client, "/objects/0").position, [0, 0, 0.1], atol=1e-6)
    assert np.allclose(node(client, "/gripper/base").position, [0, 0, 0.1], atol=1e-6)
    assert node(client, "/contacts").visible
    scene.update(playing, shown)
    assert np.allclose(node(client, "/objects/0").position, shown.scene.scene.objects[0].world_from_object[:3, 3])
    assert not node(client, "/contacts").visible


def test_layers_can_be_switched_off(scene, client, shown):
    scene.update(None, replace(shown, shown=frozenset()))
    assert not node(client, "/candidates").visible and not node(client, "/camera").visible


def test_a_click_on_a_fork_selects_it(scene, client, shown, posted):
    import asyncio
    from types import SimpleNamespace

    scene.update(None, shown)
    for handler in node(client, "/candidates").handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0, instance_index=2)))
    assert posted == [Select(2)]
