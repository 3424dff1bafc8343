import math
from dataclasses import replace

import pytest

from grasp_core.dataset.review import Review, Rule
from grasp_core.grasp import to_image
from workbench.actions import Notice, Tick
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.state import Playing


def test_one_job_at_a_time(rules, state):
    new, effects = rules.reduce(state, a.Verify(5))
    assert effects == (e.TryMore(2, 5, "ann"),) and new.busy
    assert rules.reduce(new, a.Verify(5)) == (new, ())
    assert rules.reduce(new, a.ReplayAttempt(0)) == (new, ())
    assert rules.reduce(state, a.Verify(1000))[1] == (e.TryMore(2, 50, "ann"),)
    assert rules.reduce(state, a.Verify(5, 9))[1] == (e.TryMore(9, 5, "ann"),)


def test_replays_of_what_is_there(rules, state, played):
    assert rules.reduce(state, a.ReplayAttempt(1))[1] == (e.PlayAttempt(2, 1),)
    assert rules.reduce(state, a.ReplayAttempt(2)) == (state, ())
    shown, _ = rules.reduce(replace(state, busy="replaying"), a.ReplayShown(2, played))
    assert shown.playing.duration == 2.0 and shown.busy == ""
    assert rules.reduce(state, a.ReplayShown(99, played))[0].playing is None
    again, effects = rules.reduce(replace(shown, playing=replace(shown.playing, position=1.5)), a.ReplayAttempt(1))
    assert effects == () and again.playing.position == 0.0


def test_time_passes_only_while_playing(rules, state, played):
    shown = replace(state, playing=Playing(2, played))
    first, _ = rules.reduce(shown, Tick(10.0))
    second, _ = rules.reduce(first, Tick(10.5))
    assert second.playing.position == pytest.approx(0.5)
    ended, _ = rules.reduce(second, Tick(99.0))
    assert (ended.playing.position, ended.playing.playing) == (2.0, False)
    assert rules.reduce(ended, Tick(100.0)) == (ended, ())
    assert rules.reduce(ended, a.TogglePlay())[0].playing.position == 0.0
    assert rules.reduce(shown, a.Seek(9.0))[0].playing.position == 2.0
    assert rules.reduce(state, a.Seek(1.0)) == rules.reduce(state, a.TogglePlay()) == (state, ())


def test_edits_move_turn_and_widen(rules, state):
    start = to_image(state.sample.row.grasp, state.sample.image.camera)
    moved, _ = rules.reduce(state, a.Edit(right=5, turn=0.1, widen=0.5))
    after = moved.edited
    assert after.width == pytest.approx(0.05) and after.angle == pytest.approx(state.sample.row.grasp.angle + 0.1)
    twice, _ = rules.reduce(moved, a.Edit(right=5))
    assert twice.edited.position[0] > after.position[0] > state.sample.row.grasp.position[0]
    ended, _ = rules.reduce(state, a.DragEnd(start.u, start.v - 30))
    assert abs(ended.edited.angle) == pytest.approx(math.pi / 2, abs=0.02)
    assert rules.reduce(state, a.DragEnd(start.u, start.v)) == (state, ())
    assert isinstance(rules.reduce(state, a.Edit(right=999))[1][0], Notice)


def test_an_edit_is_stored_or_forgotten(rules, state):
    moved, _ = rules.reduce(state, a.Edit(right=5))
    stored, effects = rules.reduce(moved, a.EndEdit(store=True, verify=True))
    assert effects == (e.StoreGrasp(2, moved.edited, "ann", 5),) and stored.edited is None
    assert rules.reduce(moved, a.EndEdit(store=False)) == (state, ())


def test_a_review_is_not_edited(rules, state):
    reviewing = replace(state, review=Review(1, "ann", Rule(), 3, 0))
    assert rules.reduce(reviewing, a.Edit(right=5)) == (reviewing, ())
