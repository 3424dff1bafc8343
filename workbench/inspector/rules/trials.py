"""Rules of selecting candidates, trying them in physics, and judging them."""

from __future__ import annotations

from dataclasses import replace

from workbench.actions import Effect, Notice
from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import Choice
from workbench.inspector.rules.registry import Result, rule
from workbench.inspector.state import Playback, State, Sweep, TrialState

_LOOSE = Notice(
    "info", "The object is not at rest", "It was lifted or tipped. Let it settle in DART first (button or hotkey X)."
)

_PLANNING = Notice("info", "A new plan is on its way", "Try all of its candidates once it is there.")


@rule(a.Select)
def _select(action: a.Select, state: State) -> Result:
    if state.scene is None or not 0 <= action.choice.index < len(state.scene.candidates(action.choice.side)):
        return state, ()
    moved = state if action.choice == state.choice else replace(state, choice=action.choice, playback=None)
    return show_attempt(moved, 0)


@rule(a.SelectNext)
def _select_next(action: a.SelectNext, state: State) -> Result:
    visible = state.visible
    if not visible:
        return state, ()
    now = visible.index(state.choice.index) if state.choice is not None and state.choice.index in visible else -1
    if now < 0 and action.by < 0:
        now = 0
    return _select(a.Select(Choice(state.side, visible[(now + action.by) % len(visible)])), state)


@rule(a.LookAt)
def _look_at(action: a.LookAt, state: State) -> Result:
    if state.scene is None or not state.scene.candidates(action.side) or action.side == state.side:
        return state, ()
    return replace(state, choice=Choice(action.side, 0), playback=None), ()


@rule(a.Filter)
def _filter(action: a.Filter, state: State) -> Result:
    return replace(state, least=min(max(action.least, 0.0), 1.0)), ()


@rule(a.ReplayAttempt)
def _replay_attempt(action: a.ReplayAttempt, state: State) -> Result:
    if state.choice is None or not 0 <= action.number < state.setup.attempts:
        return state, ()
    return show_attempt(state, action.number)


def show_attempt(state: State, number: int) -> Result:
    """Replay attempt `number` of the selected candidate; the first time its whole trial runs.

    One trial runs at a time: of the candidates chosen meanwhile, the last one is tried next. What is chosen while the
    scene is being seen anew, as when a drag has just ended, is tried in the plan that comes.
    """
    assert state.scene is not None and state.choice is not None
    playback, trial = state.playback, state.trial
    if playback is not None and playback.attempt.number == number:
        return replace(state, playback=replace(playback, position=0.0, playing=True, at=None), waiting=None), ()
    if not state.scene.scene.objects:
        return state, ()  # an own image: selecting is all that can be done
    if state.loose:
        return state, (_LOOSE,)
    if state.making is not None and state.known:
        return replace(state, wanted=state.choice, waiting=number), ()
    if state.trying and state.sweep is None:
        return replace(state, waiting=number), ()
    wanted: list[Effect] = [e.RecordAttempt(state.scene_ticket, state.scene, state.choice, number)]
    if not trial.complete and not trial.running:
        wanted.append(e.RunTrial(state.scene_ticket, state.scene, state.choice))
    running = state.with_trial(state.choice, replace(trial, running=True, failed=None))
    return replace(running, waiting=None), tuple(wanted)


def _next(state: State, *effects: Effect) -> Result:
    """What comes after a trial: the candidate that was clicked meanwhile, or the next one of the job."""
    if state.waiting is not None and state.choice is not None and not state.trying:
        state, more = show_attempt(state, state.waiting)
        effects = (*effects, *more)
    if state.sweep is None or state.scene is None or state.trying:
        return state, effects
    left = [i for i in state.sweep.left if not state.trials.get(Choice(state.sweep.side, i), TrialState()).complete]
    if not left:
        return replace(state, sweep=None), effects
    choice = Choice(state.sweep.side, left[0])
    scene = state.scene
    state = replace(state, sweep=replace(state.sweep, left=tuple(left[1:])))
    trial = state.trials.get(choice, TrialState())
    running = state.with_trial(choice, replace(trial, running=True, failed=None))
    return running, (*effects, e.RunTrial(state.scene_ticket, scene, choice))


@rule(r.Expected)
def _expected(action: r.Expected, state: State) -> Result:
    """One candidate after the other, so that whichever is clicked is replayed at once."""
    if action.ticket != state.scene_ticket or state.scene is None or state.dragging or state.sweep is not None:
        return state, ()
    side = action.choice.side
    for index in range(action.choice.index + 1, len(state.scene.candidates(side))):
        if not state.trials.get(Choice(side, index), TrialState()).attempts:
            return state, (e.ExpectTrial(state.scene_ticket, state.scene, Choice(side, index)),)
    return state, ()


@rule(r.Replayed)
def _replayed(action: r.Replayed, state: State) -> Result:
    if action.ticket != state.scene_ticket:
        return state, ()
    trial = state.trials.get(action.choice, TrialState())
    known = {**trial.attempts, action.attempt.number: replace(action.attempt, recording=None)}
    state = state.with_trial(action.choice, replace(trial, attempts=known, running=not trial.complete))
    if action.choice == state.choice:
        waiting = None if state.waiting == action.attempt.number else state.waiting
        state = replace(state, playback=Playback(action.choice, action.attempt), waiting=waiting)
    return _next(state)


@rule(r.Tried)
def _tried(action: r.Tried, state: State) -> Result:
    if action.ticket != state.scene_ticket:
        return state, ()
    attempts = {attempt.number: replace(attempt, recording=None) for attempt in action.attempts}
    return _next(state.with_trial(action.choice, TrialState(attempts, running=False, complete=True)))


@rule(r.TrialFailed)
def _trial_failed(action: r.TrialFailed, state: State) -> Result:
    trial = state.trials.get(action.choice, TrialState())
    if action.ticket != state.scene_ticket or not trial.running:
        return state, ()  # told already: a trial is two jobs
    told = Notice("error", "The trial did not run", action.reason)
    failed = state.with_trial(action.choice, replace(trial, running=False, failed=action.reason))
    return _next(replace(failed, sweep=None), told)


@rule(a.TryAll)
def _try_all(action: a.TryAll, state: State) -> Result:
    if state.scene is None or not state.candidates or not state.scene.scene.objects or state.sweep is not None:
        return state, ()
    if state.making is not None:
        return state, (_PLANNING,)
    if state.loose:
        return state, (_LOOSE,)
    everything = tuple(range(len(state.candidates)))
    started = replace(state, sweep=Sweep(state.side, everything, len(everything)), by_physics=True)
    return _next(started)


@rule(a.StopTrying)
def _stop(action: a.StopTrying, state: State) -> Result:
    return replace(state, sweep=None), ()


@rule(a.ColourBy)
def _colour_by(action: a.ColourBy, state: State) -> Result:
    return replace(state, by_physics=action.what == "physics"), ()


@rule(a.Judge)
def _judge(action: a.Judge, state: State) -> Result:
    if state.scene is None or state.choice is None or state.judging or not storable(state):
        return state, ()
    if state.trial.running:
        told = Notice("info", "The trial is still running", "Judge the grasp when all attempts are in.")
        return state, (told,)
    attempts = tuple(state.trial.attempts[number] for number in sorted(state.trial.attempts))
    store = e.StoreVerdict(state.scene_ticket, state.scene, state.choice, action.judgement, attempts)
    return replace(state, judging=True), (store,)


def storable(state: State) -> bool:
    """Whether the dataset takes verdicts on this scene: one object of its own, at rest."""
    return state.scene is not None and len(state.scene.scene.objects) == 1 and not state.loose


@rule(r.Judged)
def _judged(action: r.Judged, state: State) -> Result:
    if action.ticket != state.scene_ticket:
        return state, ()
    return replace(state, judging=False, verdicts={**state.verdicts, action.choice: action.judgement}), ()


@rule(r.JudgeFailed)
def _judge_failed(action: r.JudgeFailed, state: State) -> Result:
    told = Notice("error", "The verdict was not stored", action.reason)
    return (replace(state, judging=False) if action.ticket == state.scene_ticket else state), (told,)
