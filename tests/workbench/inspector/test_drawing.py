import numpy as np
import pytest
import trimesh

from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from workbench.inspector.drawing import FAR_AWAY, batch, body_at, force_lines, fork, frame_at, shaded


def test_a_fork_is_as_wide_as_the_gripper_opens():
    gripper = load_gripper()
    low, high = fork(gripper).bounds
    assert high[0] - low[0] == pytest.approx(gripper.opening + 0.0022) and low[2] == pytest.approx(0)


def test_sharp_edges_are_cut_and_round_ones_kept():
    box, ball = trimesh.creation.box((1, 1, 1)), trimesh.creation.icosphere(3)
    assert len(shaded(box)[0]) == 24 and len(shaded(ball)[0]) == len(ball.vertices)


def test_hidden_forks_are_far_away():
    grasps = [Grasp((0.1 * i, 0, 0.05), 0.5, 0.1) for i in range(3)]
    turns, places = batch(grasps, (1,))
    assert turns[0] == pytest.approx([np.cos(0.25), 0, 0, np.sin(0.25)]) and np.array_equal(places[1:2], FAR_AWAY)
    assert len(batch([], ())[0]) == 1


def test_frames_between_frames(attempt):
    recording = attempt().recording
    assert frame_at(recording, 0.25) == (2, 3, pytest.approx(0.5))
    assert frame_at(recording, 99.0)[1:] == (20, 1.0)
    turn, place = body_at(recording, 1, 0.25)
    assert turn == pytest.approx([1, 0, 0, 0]) and place[2] == pytest.approx(0.025)


def test_forces_of_one_frame(attempt):
    recording = attempt().recording
    assert force_lines(recording, 10).shape == (2, 2, 3) and force_lines(recording, 5) is None
