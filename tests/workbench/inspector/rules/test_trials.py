from dataclasses import replace

import msgspec
import pytest

from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import Choice, Photo, SceneRequest
from workbench.inspector.rules import reduce
from workbench.inspector.rules.trials import storable
from workbench.inspector.state import Sweep


def run(state, *steps):
    effects = []
    for step in steps:
        state, more = reduce(state, step)
        effects += more
    return state, effects


FIRST, SECOND, THIRD = (Choice(0, index) for index in range(3))


def tried(attempt, *outcomes):
    return tuple(attempt(number, outcome) for number, outcome in enumerate(outcomes))


def test_a_click_records_one_attempt_and_runs_the_others(shown):
    state, effects = run(shown, a.Select(SECOND))
    assert state.choice == SECOND and state.trial.running
    assert effects == [e.RecordAttempt(1, shown.scene, SECOND, 0), e.RunTrial(1, shown.scene, SECOND)]


def test_candidates_are_recorded_ahead_of_clicks_one_after_the_other(shown, attempt):
    _, effects = run(shown, r.Expected(1, FIRST))
    assert effects == [e.ExpectTrial(1, shown.scene, SECOND)]
    tried, _ = run(shown, r.Tried(1, SECOND, (attempt(),)))
    assert run(tried, r.Expected(1, FIRST))[1] == [e.ExpectTrial(1, shown.scene, THIRD)], "what was tried is left out"
    last = Choice(0, len(shown.scene.candidates(0)) - 1)
    assert run(shown, r.Expected(1, last))[1] == []
    assert run(shown, r.Expected(0, FIRST))[1] == [], "of another scene"
    assert run(replace(shown, dragging=True), r.Expected(1, FIRST))[1] == [], "not while the object is dragged"
    assert run(replace(shown, sweep=Sweep(0, (1, 2), 2)), r.Expected(1, FIRST))[1] == [], "all are tried anyway"


def test_the_replay_starts_with_the_recording(shown, attempt):
    state, _ = run(shown, a.Select(FIRST), r.Replayed(1, FIRST, attempt(0)))
    assert state.playback.attempt.number == 0 and state.playback.playing and state.trial.running
    state, _ = run(state, r.Tried(1, FIRST, tried(attempt, "SUCCESS", "SLIPPED")))
    assert state.trial.complete and state.trial.successes == 1 and not state.trying
    assert all(known.recording is None for known in state.trial.attempts.values()), "recordings are large"


def test_one_trial_at_a_time_and_the_last_click_is_next(shown, attempt):
    state, effects = run(shown, a.Select(FIRST), a.Select(SECOND), a.Select(THIRD))
    assert len(effects) == 2 and state.waiting == 0
    state, effects = run(state, r.Tried(1, FIRST, tried(attempt, "SUCCESS")))
    assert effects == [e.RecordAttempt(1, shown.scene, THIRD, 0), e.RunTrial(1, shown.scene, THIRD)]


def test_other_attempts_are_replayed_on_demand(shown, attempt):
    done, _ = run(shown, a.Select(FIRST), r.Replayed(1, FIRST, attempt(0)), r.Tried(1, FIRST, tried(attempt, "MISSED")))
    _state, effects = run(done, a.ReplayAttempt(3))
    assert effects == [e.RecordAttempt(1, shown.scene, FIRST, 3)]
    assert run(done, a.ReplayAttempt(99)) == (done, [])
    again, effects = run(replace(done, playback=replace(done.playback, position=1.0)), a.ReplayAttempt(0))
    assert effects == [] and again.playback.position == 0, "what is recorded starts over"


def test_impossible_candidates_are_ignored(shown):
    for choice in (Choice(0, 3), Choice(0, -1), Choice(1, 0), Choice(9, 9)):
        assert run(shown, a.Select(choice)) == (shown, [])


def test_next_and_previous_pass_over_hidden_ones(shown):
    state, _ = run(shown, a.Filter(0.5), a.SelectNext(1), a.SelectNext(1))
    assert state.choice == FIRST, "the third is hidden"
    assert run(replace(shown, choice=None), a.SelectNext(-1))[0].choice == THIRD
    assert run(replace(shown, least=1.0), a.SelectNext(1))[1] == []


def test_an_object_that_is_not_at_rest_is_not_tried(shown):
    thing = msgspec.structs.replace(shown.request.things[0], loose=True)
    loose = replace(shown, request=SceneRequest((thing,)))
    for action in (a.Select(SECOND), a.TryAll()):
        state, effects = run(loose, action)
        assert effects[0].title == "The object is not at rest" and not state.trying


def test_an_own_image_is_selected_but_not_tried(shown):
    scene = replace(shown.scene, scene=replace(shown.scene.scene, objects=()))
    own = replace(shown, scene=scene, request=SceneRequest((), 1, Photo("image-1")))
    state, effects = run(own, a.Select(SECOND))
    assert state.choice == SECOND and effects == []
    assert run(own, a.TryAll()) == (own, []) and not storable(own)


def test_all_candidates_are_tried_one_after_the_other(shown, attempt):
    state, effects = run(shown, a.TryAll())
    assert state.sweep == Sweep(0, (1, 2), 3) and state.by_physics
    assert effects == [e.RunTrial(1, shown.scene, FIRST)]
    state, effects = run(state, r.Tried(1, FIRST, tried(attempt, "SUCCESS")))
    assert effects == [e.RunTrial(1, shown.scene, SECOND)]
    state, _ = run(state, r.Tried(1, SECOND, tried(attempt, "MISSED")), r.Tried(1, THIRD, tried(attempt, "MISSED")))
    assert state.sweep is None and len(state.trials) == 3 and not state.trying


def test_while_a_new_plan_is_made_the_job_says_that_it_waits_for_it(shown):
    state, effects = run(replace(shown, making=2), a.TryAll())
    assert effects[0].title == "A new plan is on its way" and state.sweep is None and not state.trying


def test_the_job_can_be_cancelled(shown, attempt):
    state, _ = run(shown, a.TryAll(), a.StopTrying())
    state, effects = run(state, r.Tried(1, FIRST, tried(attempt, "SUCCESS")))
    assert effects == [] and state.sweep is None and list(state.trials) == [FIRST], "what was tried stays"


def test_a_click_during_the_job_is_tried_at_once_and_the_job_goes_on(shown, attempt):
    state, _ = run(shown, a.TryAll())
    state, effects = run(state, a.Select(THIRD))
    assert [type(effect) for effect in effects] == [e.RecordAttempt, e.RunTrial]
    state, effects = run(state, r.Replayed(1, THIRD, attempt(0)), r.Tried(1, FIRST, tried(attempt, "SUCCESS")))
    assert state.playback.choice == THIRD and effects == [], "two trials are under way"
    state, effects = run(state, r.Tried(1, THIRD, tried(attempt, "SUCCESS")))
    assert effects == [e.RunTrial(1, shown.scene, SECOND)]


def test_a_failed_trial_is_told_once_and_ends_the_job(shown):
    state, effects = run(shown, a.TryAll(), r.TrialFailed(1, FIRST, "no"), r.TrialFailed(1, FIRST, "no"))
    assert sum(type(effect).__name__ == "Notice" for effect in effects) == 1
    assert state.trial.failed == "no" and state.sweep is None


@pytest.mark.parametrize("judgement", ["good", "bad"])
def test_verdicts_are_stored_with_their_attempts(shown, attempt, judgement):
    done, _ = run(shown, a.Select(FIRST), r.Tried(1, FIRST, tried(attempt, "SUCCESS", "SLIPPED")))
    state, effects = run(done, a.Judge(judgement))
    assert state.judging and effects[0].judgement == judgement and len(effects[0].attempts) == 2
    assert run(state, a.Judge("good"))[1] == [], "one at a time"
    state, _ = run(state, r.Judged(1, FIRST, judgement, 7))
    assert state.verdicts == {FIRST: judgement} and not state.judging


def test_verdicts_wait_for_the_trial_and_failures_are_told(shown):
    running, _ = run(shown, a.Select(FIRST))
    assert run(running, a.Judge("good"))[1][0].title == "The trial is still running"
    state, effects = run(replace(shown, judging=True), r.JudgeFailed(1, "disk full"))
    assert not state.judging and effects[0].tone == "error"


def test_plans_are_looked_at_side_by_side(shown, make_scene):
    setup = msgspec.structs.replace(shown.setup, beside="random")
    two = replace(shown, scene=make_scene(setup=setup), setup=setup)
    state, effects = run(two, a.LookAt(1))
    assert state.choice == Choice(1, 0) and effects == []
    assert run(shown, a.LookAt(1)) == (shown, [])
    assert run(shown, a.ColourBy("physics"))[0].by_physics
