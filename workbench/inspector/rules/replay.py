"""Rules of the replay: time, comparing two attempts, saving one."""

from __future__ import annotations

from dataclasses import replace

from workbench.actions import Download, Notice, Tick
from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.rules.registry import Result, rule
from workbench.inspector.state import Pinned, State
from workbench.session import FRAME

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""How fast replays may run, times real time."""


@rule(a.TogglePlay)
def _toggle(action: a.TogglePlay, state: State) -> Result:
    return (state if state.playback is None else replace(state, playback=state.playback.toggled())), ()


@rule(a.Seek)
def _seek(action: a.Seek, state: State) -> Result:
    return (state if state.playback is None else replace(state, playback=state.playback.sought(action.time))), ()


@rule(a.Step)
def _step(action: a.Step, state: State) -> Result:
    if state.playback is None:
        return state, ()
    return _seek(a.Seek(state.playback.position + action.frames * FRAME), state)


@rule(a.Speed)
def _speed(action: a.Speed, state: State) -> Result:
    return (replace(state, speed=action.factor), ()) if action.factor in SPEEDS else (state, ())


@rule(a.ToggleLoop)
def _loop(action: a.ToggleLoop, state: State) -> Result:
    return replace(state, loop=not state.loop), ()


@rule(Tick)
def _tick(action: Tick, state: State) -> Result:
    if state.playback is None or not state.playback.playing:
        return state, ()
    return replace(state, playback=state.playback.ticked(action.now, speed=state.speed, loop=state.loop)), ()


@rule(a.Pin)
def _pin(action: a.Pin, state: State) -> Result:
    playback = state.playback
    if playback is None or state.candidate is None:
        return replace(state, pinned=None), ()
    same = state.pinned is not None and (state.pinned.choice, state.pinned.attempt.number) == (
        playback.choice,
        playback.attempt.number,
    )
    pinned = None if same else Pinned(playback.choice, state.candidate.score, playback.attempt)
    return replace(state, pinned=pinned), ()


@rule(a.SaveReplay)
def _save(action: a.SaveReplay, state: State) -> Result:
    if state.playback is None or state.scene is None or state.saving:
        return state, ()
    return replace(state, saving=True), (e.WritePage(state.scene, state.playback.choice, state.playback.attempt),)


@rule(r.ReplaySaved)
def _saved(action: r.ReplaySaved, state: State) -> Result:
    return replace(state, saving=False), (Download(action.name, action.content),)


@rule(r.SaveFailed)
def _save_failed(action: r.SaveFailed, state: State) -> Result:
    return replace(state, saving=False), (Notice("error", "The replay was not saved", action.reason),)
