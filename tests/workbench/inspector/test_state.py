from dataclasses import replace

import msgspec
import numpy as np
import pytest

from workbench.inspector.orders import Choice, SceneRequest, Thing
from workbench.inspector.poses import vector
from workbench.inspector.state import Live, Playback, TrialState


def test_a_playback_lasts_as_long_as_its_recording(attempt):
    assert Playback(Choice(0, 0), attempt()).duration == pytest.approx(2.0)
    assert Playback(Choice(0, 0), attempt(recorded=False)).duration == 0


def test_quality_is_known_once_all_attempts_are(attempt):
    trial = TrialState({0: attempt(0), 1: attempt(1, "SLIPPED")})
    assert trial.successes == 1 and trial.quality is None
    assert replace(trial, complete=True).quality == 0.5


def test_the_filter_hides_low_scores(shown):
    assert shown.visible == (0, 1, 2)
    assert replace(shown, least=0.5).visible == (0, 1)


def test_poses_are_where_things_were_dragged(shown):
    own = shown.scene.scene.objects[0].world_from_object
    assert np.array_equal(shown.pose(0), own) and shown.pose(1) is None
    moved = own.copy()
    moved[0, 3] += 0.05
    thing = msgspec.structs.replace(shown.request.things[0], at=vector(moved), loose=True)
    dragged = replace(shown, request=SceneRequest((thing,)))
    assert dragged.pose(0) == pytest.approx(moved, abs=1e-4) and dragged.loose


def test_the_rate_of_a_drag():
    assert Live(40.0, (1.0,)).rate is None
    assert Live(40.0, (1.0, 1.1, 1.2)).rate == pytest.approx(10)


def test_nothing_is_selected_before_the_first_plan(state):
    assert state.candidates == () and state.candidate is None and state.plan is None
    assert state.trial == TrialState() and not state.trying and not state.loose
    assert Thing("a").at is None
