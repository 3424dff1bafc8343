from dataclasses import replace

import numpy as np
import pytest

from grasp_core.gripper import load_gripper
from workbench.curate.scene import SampleScene
from workbench.curate.state import Playing


@pytest.fixture
def scene(curation_bridge):
    return SampleScene(curation_bridge, load_gripper())


def part(client, name):
    return next(handle for handle in client.made if handle.label == name)


def test_object_and_gripper_stand_where_the_sample_says(scene, client, state):
    scene.update(None, state)
    shown = part(client, "/objects/0")
    assert shown.visible and shown.position == pytest.approx([0, 0, 0.025])
    assert not part(client, "/objects/1").visible
    left, right = part(client, "/gripper/left_finger"), part(client, "/gripper/right_finger")
    middle = (np.array(left.position) + np.array(right.position)) / 2
    assert middle[:2] == pytest.approx(state.sample.row.grasp.position[:2], abs=1e-6)
    assert not part(client, "/before").visible


def test_an_edit_moves_the_gripper_and_leaves_a_fork(scene, client, state, rules):
    from workbench.curate import actions as a

    moved, _ = rules.reduce(state, a.Edit(right=20))
    scene.update(None, state)
    before = np.array(part(client, "/gripper/rod").position)
    scene.update(state, moved)
    assert part(client, "/gripper/rod").position[0] > before[0] + 0.01
    assert part(client, "/before").visible
    scene.update(moved, state)
    assert np.array(part(client, "/gripper/rod").position) == pytest.approx(before)


def test_a_replay_moves_what_was_recorded(scene, client, state, played):
    scene.update(None, state)
    playing = replace(state, playing=Playing(2, played, position=1.0, playing=False))
    scene.update(state, playing)
    assert part(client, "/objects/0").position[2] == pytest.approx(0.1)
    scene.update(playing, state)
    assert part(client, "/objects/0").position[2] == pytest.approx(0.025)


def test_without_a_sample_nothing_stands_there(scene, client, state):
    scene.update(None, state)
    scene.update(state, replace(state, sample=None))
    assert not part(client, "/objects/0").visible and not part(client, "/gripper/rod").visible
