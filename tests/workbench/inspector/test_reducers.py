from dataclasses import replace

import pytest

from workbench import actions as shell
from workbench.inspector import actions as a
from workbench.inspector.orders import OpenedScene
from workbench.inspector.reducers import FRAME, SPEEDS, reduce
from workbench.inspector.state import TrialState


def run(state, *steps):
    effects = []
    for step in steps:
        state, more = reduce(state, step)
        effects += more
    return state, effects


def test_every_action_has_a_rule(state):
    kinds = [
        value
        for value in vars(a).values()
        if isinstance(value, type) and issubclass(value, a.Action) and value not in (a.Action, a.InspectorAction)
    ]
    from workbench.inspector.reducers import _apply

    assert len(kinds) > 15
    assert not [kind.__name__ for kind in kinds if _apply.dispatch(kind) is _apply.dispatch(object)]


def test_another_object_is_another_family_with_a_drawn_shape(shown):
    state, effects = run(shown, a.AnotherObject(1234))
    assert state.opening and state.scene is shown.scene, "the old scene stays until the new one is there"
    assert effects == [a.OpenScene(1, state.request)]
    assert (state.request.family, state.request.shape, state.request.pose) == ("mug", 334, 0)


def test_another_pose_keeps_the_object(shown):
    state, _ = run(shown, a.AnotherPose())
    assert state.request == replace(shown.request, pose=1)


def test_an_object_with_one_pose_says_so(shown):
    alone = replace(shown, scene=replace(shown.scene, poses=1))
    state, effects = run(alone, a.AnotherPose())
    assert state is alone and isinstance(effects[0], shell.Notice)


def test_random_scenes_follow_their_draw(shown):
    one, _ = run(shown, a.RandomScene(5))
    same, _ = run(shown, a.RandomScene(5))
    other, _ = run(shown, a.RandomScene(6))
    assert one.request == same.request != other.request
    assert one.request.planner == shown.request.planner


def test_choosing_what_is_shown_already_does_nothing(shown):
    assert run(shown, a.ShowObject("box_"), a.UsePlanner("cascade")) == (shown, [])
    assert run(shown, a.UsePlanner("random"))[0].request == replace(shown.request, planner="random")
    assert run(shown, a.ShowObject("pen"))[0].request.family == "pen"


def test_late_scenes_are_dropped(shown, opened):
    state, effects = run(shown, a.RandomScene(1), a.RandomScene(2), a.RandomScene(3))
    assert [effect.ticket for effect in effects] == [1], "one scene is made at a time"
    for answer in (a.Opened(1, opened), a.OpenFailed(1, "late")):
        after, effects = run(state, answer)
        assert after.scene is shown.scene and effects == [a.OpenScene(3, state.request)], "the last one is made next"
    assert run(state, a.Opened(99, opened)) == (state, [])


def test_a_trial_belongs_to_the_scene_it_was_started_on(shown, opened, attempt):
    state, _ = run(shown, a.AnotherPose(), a.Select(1))
    new, _ = run(state, a.Opened(1, opened), a.Replayed(0, 1, attempt(0)), a.Tried(0, 1, (attempt(0),)))
    assert new.trials == {} and new.playback is None


def test_a_new_scene_starts_with_its_best_candidate_and_nothing_else(shown, opened, attempt):
    tried, _ = run(shown, a.Select(1), a.Replayed(0, 1, attempt(0)), a.Tried(0, 1, (attempt(0),)))
    state, _ = run(replace(tried, ticket=7, making=7, verdicts={1: "good"}), a.Opened(7, opened))
    assert (state.selected, state.trials, state.playback, state.verdicts, state.opening) == (0, {}, None, {}, False)


def test_an_empty_plan_selects_nothing(state, empty_scene):
    shown, _ = run(state, a.Opened(0, empty_scene))
    assert shown.selected is None and not shown.opening
    assert run(shown, a.Select(0), a.SelectNext(1), a.Judge("good"), a.ReplayAttempt(0)) == (shown, [])


def test_a_scene_that_cannot_be_made_is_reported(state):
    failed, effects = run(state, a.OpenFailed(0, "no rest"))
    assert failed.failure == "no rest" and not failed.opening
    assert effects[0].tone == "error"


def test_a_click_selects_and_tries(shown):
    state, effects = run(shown, a.Select(2))
    assert state.selected == 2 and state.trial.running
    assert effects == [a.RecordAttempt(0, shown.scene, 2, 0), a.RunTrial(0, shown.scene, 2)]


def test_a_second_click_while_it_runs_asks_for_nothing_more(shown, attempt):
    state, _ = run(shown, a.Select(2))
    again, effects = run(state, a.Select(2))
    assert effects == []
    again, effects = run(again, a.Replayed(0, 2, attempt(0)), a.Tried(0, 2, (attempt(0),)))
    assert effects == [] and again.playback.playing and again.waiting is None


def test_coming_back_to_a_candidate_whose_trial_still_runs_replays_it(shown, attempt):
    state, _ = run(shown, a.Select(1), a.Replayed(0, 1, attempt(0)), a.Select(2), a.Select(1))
    assert state.playback is None
    state, effects = run(state, a.Tried(0, 1, (attempt(0),)))
    assert effects == [a.RecordAttempt(0, shown.scene, 1, 0)]


@pytest.mark.parametrize("index", [-1, 3, 10**9])
def test_candidates_that_do_not_exist_cannot_be_selected(shown, index):
    assert run(shown, a.Select(index)) == (shown, [])


def test_a_recorded_attempt_plays(shown, attempt):
    state, _ = run(shown, a.Select(1), a.Replayed(0, 1, attempt(0)))
    assert state.playback.playing and state.playback.position == 0
    assert state.trial.attempts[0].recording is None, "one recording is kept, in the playback"
    state, _ = run(state, a.Tried(0, 1, tuple(attempt(n) for n in range(5))))
    assert state.trial.complete and not state.trial.running and len(state.trial.attempts) == 5
    again, effects = run(state, a.Select(1))
    assert effects == [] and again.playback.position == 0, "a click on what is shown replays it"
    _, effects = run(state, a.ReplayAttempt(3))
    assert effects == [a.RecordAttempt(0, shown.scene, 1, 3)]


def test_an_attempt_that_comes_after_the_choice_moved_on_is_kept_but_not_shown(shown, attempt):
    state, _ = run(shown, a.Select(1), a.Select(2), a.Replayed(0, 1, attempt(0)))
    assert state.playback is None and state.trials[1].attempts[0].number == 0


def test_trials_run_one_at_a_time_and_the_last_choice_is_next(shown, attempt):
    state, effects = run(shown, a.Select(0), a.Select(1), a.Select(2))
    assert [effect.index for effect in effects] == [0, 0] and state.waiting == 0
    state, effects = run(state, a.Replayed(0, 0, attempt(0)), a.Tried(0, 0, (attempt(0),)))
    assert [effect.index for effect in effects] == [2, 2] and state.waiting is None
    assert state.trial.running and 1 not in state.trials


def test_a_trial_that_fails_says_why_and_can_be_run_again(shown):
    state, effects = run(shown, a.Select(1), a.TrialFailed(0, 1, "the worker died"))
    assert state.trial == TrialState(failed="the worker died")
    assert isinstance(effects[-1], shell.Notice)
    assert run(state, a.TrialFailed(0, 1, "the worker died")) == (state, []), "told once"
    assert run(state, a.Select(1))[0].trial.running


def test_time_moves_the_replay_to_its_end_and_no_further(shown, attempt):
    state, _ = run(shown, a.Select(0), a.Replayed(0, 0, attempt(0)), shell.Tick(10.0), shell.Tick(10.5))
    assert state.playback.position == pytest.approx(0.5)
    state, _ = run(state, a.Speed(0.5), shell.Tick(11.5))
    assert state.playback.position == pytest.approx(1.0)
    state, _ = run(state, shell.Tick(99.0))
    assert state.playback.position == pytest.approx(2.0) and not state.playback.playing
    assert run(state, a.TogglePlay())[0].playback.position == 0, "play at the end starts over"


def test_pausing_and_scrubbing(shown, attempt):
    state, _ = run(shown, a.Select(0), a.Replayed(0, 0, attempt(0)), shell.Tick(1.0), shell.Tick(1.5), a.TogglePlay())
    assert run(state, shell.Tick(5.0))[0].playback.position == pytest.approx(0.5)
    state, _ = run(state, a.Seek(1.25))
    assert (state.playback.position, state.playback.playing) == (1.25, False)
    assert run(state, a.Step(2))[0].playback.position == pytest.approx(1.25 + 2 * FRAME)
    assert run(state, a.Seek(99.0))[0].playback.position == pytest.approx(2.0)
    assert run(shown, a.Seek(1.0), a.Step(1), a.TogglePlay(), shell.Tick(1.0)) == (shown, [])


def test_speeds_are_those_offered(shown):
    assert [run(shown, a.Speed(factor))[0].speed for factor in SPEEDS] == list(SPEEDS)
    assert run(shown, a.Speed(1000.0)) == (shown, [])


def test_a_verdict_is_stored_with_the_attempts(shown, attempt):
    state, _ = run(shown, a.Select(1), a.Replayed(0, 1, attempt(0)))
    assert isinstance(run(state, a.Judge("good"))[1][0], shell.Notice), "not while the trial runs"
    state, _ = run(state, a.Tried(0, 1, tuple(attempt(n) for n in range(5))))
    judging, effects = run(state, a.Judge("good"))
    assert isinstance(effects[0], a.StoreVerdict) and len(effects[0].attempts) == 5
    assert run(judging, a.Judge("bad")) == (judging, []), "one at a time"
    assert run(judging, a.Judged(0, 1, "good", 17))[0].verdicts == {1: "good"}
    failed, effects = run(judging, a.JudgeFailed(0, 1, "disk full"))
    assert not failed.judging and "disk full" in effects[0].body


def test_layers_and_neighbours(shown):
    state, _ = run(shown, a.Toggle("camera"))
    assert "camera" not in state.shown and run(state, a.Toggle("camera"))[0].shown == shown.shown
    assert run(shown, a.SelectNext(1))[0].selected == 1
    assert run(shown, a.SelectNext(-1))[0].selected == 2


def test_the_old_state_is_never_changed(shown, attempt):
    before = replace(shown)
    run(shown, a.Select(1), a.Replayed(0, 1, attempt(0)), a.Judge("good"), a.RandomScene(3))
    assert shown == before and isinstance(shown.scene, OpenedScene)
