"""What each action does to the state: pure functions from state and action to the next state and effects."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import singledispatch
from typing import Any

import numpy as np

from workbench.actions import Action, Effect, Notice, Tick
from workbench.inspector import actions as a
from workbench.inspector.state import Playback, State, TrialState
from workbench.session import FRAME

_SHAPES = 900
"""Shapes of a family that random scenes draw from; later seeds are for benchmarks only."""
SPEEDS = (0.25, 0.5, 1.0, 2.0)
"""How fast replays may run, times real time."""

Result = tuple[State, tuple[Effect, ...]]


@singledispatch
def _apply(action: Any, state: State) -> Result:
    raise TypeError(f"no reducer for {type(action).__name__}")


def reduce(state: State, action: Action) -> Result:
    """The next state and what has to be done; actions that no longer fit (late answers) change nothing."""
    return _apply(action, state)


def _rule(kind: type) -> Callable[[Callable[[Any, State], Result]], Callable[[Any, State], Result]]:
    return _apply.register(kind)


def _open(state: State, **changes: Any) -> Result:
    """Want another scene; of those wanted while one is being made, the last one is made next."""
    request = replace(state.request, **changes)
    ticket = state.ticket + 1
    asked = replace(state, request=request, ticket=ticket, failure=None)
    return (asked, ()) if state.making is not None else _make(asked)


def _make(state: State) -> Result:
    return replace(state, making=state.ticket), (a.OpenScene(state.ticket, state.request),)


@_rule(a.ShowObject)
def _show_object(action: a.ShowObject, state: State) -> Result:
    if action.family == state.request.family:
        return state, ()
    return _open(state, family=action.family, shape=0, pose=0)


@_rule(a.AnotherObject)
def _another_object(action: a.AnotherObject, state: State) -> Result:
    families = state.catalogue.families
    now = families.index(state.request.family) if state.request.family in families else -1
    return _open(state, family=families[(now + 1) % len(families)], shape=action.draw % _SHAPES, pose=0)


@_rule(a.AnotherPose)
def _another_pose(action: a.AnotherPose, state: State) -> Result:
    if state.scene is not None and state.scene.poses == 1 and not state.opening:
        told = Notice("info", "Only one stable pose", f"A {state.request.family} of this shape rests in one way only.")
        return state, (told,)
    return _open(state, pose=state.request.pose + 1)


@_rule(a.RandomScene)
def _random_scene(action: a.RandomScene, state: State) -> Result:
    rng = np.random.default_rng(action.draw)
    family = state.catalogue.families[int(rng.integers(len(state.catalogue.families)))]
    shape, pose, place = (int(value) for value in rng.integers([_SHAPES, 8, 2**31 - 1]))
    return _open(state, family=family, shape=shape, pose=pose, place=place)


@_rule(a.UsePlanner)
def _use_planner(action: a.UsePlanner, state: State) -> Result:
    return (state, ()) if action.name == state.request.planner else _open(state, planner=action.name)


@_rule(a.Opened)
def _opened(action: a.Opened, state: State) -> Result:
    if action.ticket != state.making:
        return state, ()
    if action.ticket != state.ticket:
        return _make(state)
    shown = replace(
        state,
        request=action.scene.request,
        making=None,
        scene=action.scene,
        scene_ticket=action.ticket,
        failure=None,
        selected=0 if action.scene.plan.candidates else None,
        trials={},
        waiting=None,
        playback=None,
        verdicts={},
        judging=False,
    )
    return shown, ()


@_rule(a.OpenFailed)
def _open_failed(action: a.OpenFailed, state: State) -> Result:
    if action.ticket != state.making:
        return state, ()
    if action.ticket != state.ticket:
        return _make(state)
    told = Notice("error", "This scene could not be made", action.reason)
    return replace(state, making=None, failure=action.reason), (told,)


@_rule(a.Select)
def _select(action: a.Select, state: State) -> Result:
    if state.scene is None or not 0 <= action.index < len(state.candidates):
        return state, ()
    moved = state if action.index == state.selected else replace(state, selected=action.index, playback=None)
    return _show_attempt(moved, 0)


@_rule(a.SelectNext)
def _select_next(action: a.SelectNext, state: State) -> Result:
    if not state.candidates:
        return state, ()
    now = state.selected if state.selected is not None else -1
    return _select(a.Select((now + action.by) % len(state.candidates)), state)


@_rule(a.ReplayAttempt)
def _replay_attempt(action: a.ReplayAttempt, state: State) -> Result:
    if state.selected is None or not 0 <= action.number < state.catalogue.attempts:
        return state, ()
    return _show_attempt(state, action.number)


def _show_attempt(state: State, number: int) -> Result:
    """Replay attempt `number` of the selected candidate; the first time its whole trial runs.

    One trial runs at a time: of the candidates chosen meanwhile, the last one is tried next.
    """
    assert state.scene is not None and state.selected is not None
    playback, trial = state.playback, state.trial
    if playback is not None and playback.attempt.number == number:
        return replace(state, playback=replace(playback, position=0.0, playing=True, at=None), waiting=None), ()
    if state.trying:
        return replace(state, waiting=number), ()
    wanted: list[Effect] = [a.RecordAttempt(state.scene_ticket, state.scene, state.selected, number)]
    if not trial.complete:
        wanted.append(a.RunTrial(state.scene_ticket, state.scene, state.selected))
    running = state.with_trial(state.selected, replace(trial, running=True, failed=None))
    return replace(running, waiting=None), tuple(wanted)


def _next_waiting(state: State, *effects: Effect) -> Result:
    if state.waiting is None or state.selected is None or state.trying:
        return state, effects
    state, more = _show_attempt(state, state.waiting)
    return state, (*effects, *more)


@_rule(a.Replayed)
def _replayed(action: a.Replayed, state: State) -> Result:
    if action.ticket != state.scene_ticket:
        return state, ()
    trial = state.trials.get(action.index, TrialState())
    known = {**trial.attempts, action.attempt.number: replace(action.attempt, recording=None)}
    state = state.with_trial(action.index, replace(trial, attempts=known, running=not trial.complete))
    if action.index == state.selected:
        waiting = None if state.waiting == action.attempt.number else state.waiting
        state = replace(state, playback=Playback(action.attempt), waiting=waiting)
    return _next_waiting(state)


@_rule(a.Tried)
def _tried(action: a.Tried, state: State) -> Result:
    if action.ticket != state.scene_ticket:
        return state, ()
    attempts = {attempt.number: replace(attempt, recording=None) for attempt in action.attempts}
    return _next_waiting(state.with_trial(action.index, TrialState(attempts, running=False, complete=True)))


@_rule(a.TrialFailed)
def _trial_failed(action: a.TrialFailed, state: State) -> Result:
    trial = state.trials.get(action.index, TrialState())
    if action.ticket != state.scene_ticket or not trial.running:
        return state, ()  # told already: a trial is two jobs
    told = Notice("error", "The trial did not run", action.reason)
    return _next_waiting(state.with_trial(action.index, replace(trial, running=False, failed=action.reason)), told)


@_rule(a.TogglePlay)
def _toggle(action: a.TogglePlay, state: State) -> Result:
    playback = state.playback
    if playback is None:
        return state, ()
    ended = playback.position >= playback.duration - 1e-9
    position = 0.0 if ended and not playback.playing else playback.position
    return replace(state, playback=replace(playback, playing=not playback.playing, position=position, at=None)), ()


@_rule(a.Seek)
def _seek(action: a.Seek, state: State) -> Result:
    if state.playback is None:
        return state, ()
    position = float(np.clip(action.time, 0.0, state.playback.duration))
    return replace(state, playback=replace(state.playback, position=position, playing=False, at=None)), ()


@_rule(a.Step)
def _step(action: a.Step, state: State) -> Result:
    if state.playback is None:
        return state, ()
    return _seek(a.Seek(state.playback.position + action.frames * FRAME), state)


@_rule(a.Speed)
def _speed(action: a.Speed, state: State) -> Result:
    return (replace(state, speed=action.factor), ()) if action.factor in SPEEDS else (state, ())


@_rule(Tick)
def _tick(action: Tick, state: State) -> Result:
    playback = state.playback
    if playback is None or not playback.playing:
        return state, ()
    passed = 0.0 if playback.at is None else max(0.0, action.now - playback.at)
    position = playback.position + passed * state.speed
    ended = position >= playback.duration
    moved = replace(
        playback, position=min(position, playback.duration), playing=not ended, at=None if ended else action.now
    )
    return replace(state, playback=moved), ()


@_rule(a.Judge)
def _judge(action: a.Judge, state: State) -> Result:
    if state.scene is None or state.selected is None or state.judging:
        return state, ()
    if state.trial.running:
        told = Notice("info", "The trial is still running", "Judge the grasp when all attempts are in.")
        return state, (told,)
    attempts = tuple(state.trial.attempts[number] for number in sorted(state.trial.attempts))
    store = a.StoreVerdict(state.scene_ticket, state.scene, state.selected, action.judgement, attempts)
    return replace(state, judging=True), (store,)


@_rule(a.Judged)
def _judged(action: a.Judged, state: State) -> Result:
    if action.ticket != state.scene_ticket:
        return state, ()
    return replace(state, judging=False, verdicts={**state.verdicts, action.index: action.judgement}), ()


@_rule(a.JudgeFailed)
def _judge_failed(action: a.JudgeFailed, state: State) -> Result:
    told = Notice("error", "The verdict was not stored", action.reason)
    return (replace(state, judging=False) if action.ticket == state.scene_ticket else state), (told,)


@_rule(a.Toggle)
def _toggle_layer(action: a.Toggle, state: State) -> Result:
    return replace(state, shown=state.shown ^ {action.what}), ()
