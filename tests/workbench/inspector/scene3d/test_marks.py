import asyncio
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from workbench import colours
from workbench.inspector import actions as a
from workbench.inspector.orders import Choice, Place
from workbench.inspector.scene3d.marks import Marks, tints
from workbench.inspector.state import TrialState


@pytest.fixture
def marks(bridge, client):
    made = Marks(bridge)
    return made, {handle.label: handle for handle in client.made}


def test_candidates_are_forks_but_for_the_selected_and_the_hidden(marks, shown):
    part, nodes = marks
    part.update(None, replace(shown, least=0.5))
    heights = np.asarray(nodes["/candidates"].batched_positions)[:, 2]
    assert list(heights < -1) == [True, False, True]


def test_a_click_on_a_fork_selects_it(marks, shown, posted):
    part, nodes = marks
    part.update(None, shown)
    for handler in nodes["/candidates"].handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0, instance_index=2)))
    assert posted == [a.Select(Choice(0, 2))]


def test_colours_follow_score_or_physics(shown, attempt):
    assert np.array_equal(tints(shown)[0], colours.lit(colours.score(0.9)))
    trial = TrialState({0: attempt(0, "MISSED")}, complete=True)
    physics = replace(shown.with_trial(Choice(0, 0), trial), by_physics=True)
    assert np.array_equal(tints(physics)[0], colours.lit(colours.score(0.0)))
    assert np.array_equal(tints(physics)[1], colours.lit(np.array(colours.UNKNOWN, np.uint8)))


def test_axes_and_the_place_that_was_asked_about(marks, shown, scores):
    part, nodes = marks
    asked = replace(shown, place=Place(5.0, 6.0, None, 0.0, scores(5.0, 6.0)), shown=frozenset({"frames"}))
    part.update(None, asked)
    assert nodes["/frames/grasp"].visible and nodes["/asked"].visible and not nodes["/candidates"].visible
    assert nodes["/asked"].position[2] == pytest.approx(0.04)
    part.update(asked, shown)
    assert not nodes["/asked"].visible
