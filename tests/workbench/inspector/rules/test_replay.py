from dataclasses import replace

import pytest

from workbench.actions import Download, Tick
from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.rules import reduce
from workbench.inspector.rules.replay import SPEEDS
from workbench.inspector.state import Playback
from workbench.session import FRAME


def run(state, *steps):
    effects = []
    for step in steps:
        state, more = reduce(state, step)
        effects += more
    return state, effects


@pytest.fixture
def playing(shown, attempt):
    return replace(shown, playback=Playback(shown.choice, attempt(0)))


def test_time_passes_at_the_chosen_speed(playing):
    for factor in SPEEDS:
        state, _ = run(playing, a.Speed(factor), Tick(10.0), Tick(10.25))
        assert state.playback.position == pytest.approx(0.25 * factor)
    assert run(playing, a.Speed(3.0))[0].speed == 1.0


def test_a_replay_ends_or_starts_over(playing):
    late = replace(playing, playback=replace(playing.playback, position=1.95, at=10.0))
    ended, _ = run(late, Tick(10.2))
    assert not ended.playback.playing and ended.playback.position == ended.playback.duration
    looped, _ = run(late, a.ToggleLoop(), Tick(10.2))
    assert looped.playback.playing and looped.playback.position == 0
    assert run(ended, a.TogglePlay())[0].playback.position == 0


def test_seeking_and_stepping_pause(playing):
    state, _ = run(playing, a.Seek(1.0))
    assert not state.playback.playing and state.playback.position == 1.0
    assert run(state, a.Step(2))[0].playback.position == pytest.approx(1.0 + 2 * FRAME)
    assert run(state, a.Seek(99.0))[0].playback.position == pytest.approx(2.0)
    assert run(state, a.Seek(-1.0))[0].playback.position == 0


def test_nothing_to_play(shown):
    for action in (a.TogglePlay(), a.Seek(1.0), a.Step(1), Tick(1.0), a.SaveReplay()):
        assert run(shown, action) == (shown, [])


def test_an_attempt_is_pinned_replaced_and_let_go(playing, attempt):
    pinned, _ = run(playing, a.Pin())
    assert pinned.pinned.attempt is playing.playback.attempt and pinned.pinned.score == pytest.approx(0.9)
    assert run(pinned, a.Pin())[0].pinned is None
    other = replace(pinned, playback=Playback(playing.choice, attempt(3)))
    assert run(other, a.Pin())[0].pinned.attempt.number == 3


def test_a_replay_is_saved_once_at_a_time(playing):
    state, effects = run(playing, a.SaveReplay())
    assert state.saving and effects == [e.WritePage(playing.scene, playing.choice, playing.playback.attempt)]
    assert run(state, a.SaveReplay())[1] == []
    done, effects = run(state, r.ReplaySaved("a.html", b"x"))
    assert not done.saving and effects == [Download("a.html", b"x")]
    failed, effects = run(state, r.SaveFailed("no"))
    assert not failed.saving and effects[0].tone == "error"
