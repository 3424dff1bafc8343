from dataclasses import replace

from workbench.inspector.state import Playback, State, TrialState


def test_a_new_state_waits_for_its_first_scene(state):
    assert state.opening and state.scene is None and state.candidates == ()
    assert state.trial == TrialState()


def test_the_candidates_are_the_plan_s(shown):
    assert shown.candidates == shown.scene.plan.candidates


def test_a_playback_knows_how_long_it_is(attempt):
    assert Playback(attempt(0)).duration == 2.0
    assert Playback(attempt(0, recorded=False)).duration == 0.0


def test_successes_are_counted(attempt):
    trial = TrialState({0: attempt(0), 1: attempt(1, "SLIPPED"), 2: attempt(2)})
    assert trial.successes == 2


def test_trials_are_kept_per_candidate(shown):
    changed = shown.with_trial(1, TrialState(running=True))
    assert changed.trials[1].running and shown.trials == {}
    assert replace(changed, selected=1).trial.running and not changed.trial.running
    assert isinstance(changed, State)
