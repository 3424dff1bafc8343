from dataclasses import replace

import pytest

from workbench.bridge import read_message
from workbench.inspector import actions as a
from workbench.inspector.panels.trial_panel import READERS, TrialPanel, player, verdict, verdict_of_physics
from workbench.inspector.state import Playback, TrialState


@pytest.fixture
def tried(shown, attempt):
    known = {n: attempt(n, "SUCCESS" if n < 4 else "SLIPPED", recorded=False) for n in range(5)}
    return replace(shown.with_trial(0, TrialState(known, complete=True)), playback=Playback(attempt(0)))


def test_what_happened_is_said_in_words(tried, bridge):
    page = verdict_of_physics(tried, 5, bridge)
    assert 'data-outcome="SUCCESS"' in page and "Held to the end." in page
    assert "4 / 5 succeeded" in page
    assert page.count("data-attempt=") == 5


def test_every_state_of_a_trial_has_its_words(state, shown, bridge):
    assert "No candidate" in verdict_of_physics(state, 5, bridge)
    assert "Try candidate 1" in verdict_of_physics(shown, 5, bridge)
    running = shown.with_trial(0, TrialState(running=True))
    assert "is being tried" in verdict_of_physics(running, 5, bridge)
    failed = shown.with_trial(0, TrialState(failed="<worker> died"))
    assert "&lt;worker&gt; died." in verdict_of_physics(failed, 5, bridge)


def test_the_player_is_off_without_a_replay(shown, tried, bridge):
    assert player(shown, bridge).count("disabled") == 4
    assert "Pause" in player(tried, bridge) and "disabled" not in player(tried, bridge)
    assert "Play" in player(replace(tried, playback=replace(tried.playback, playing=False)), bridge)


def test_the_verdict_says_where_it_goes(tried, bridge):
    assert "goes to ~/data" in verdict(tried, "~/data", bridge)
    assert 'data-stored="good"' in verdict(replace(tried, verdicts={0: "good"}), "~/data", bridge)
    assert verdict(replace(tried, judging=True), "~/data", bridge).count("disabled") == 2


def test_the_scrubber_follows_the_replay_without_flooding_the_page(bridge, client, tried):
    panel = TrialPanel(bridge, 5, "~/data")
    slider = client.only("slider")
    panel.update(None, tried)
    assert slider.max == 2.0 and not slider.disabled
    sent = []
    for frame in range(30):
        panel.update(tried, replace(tried, playback=replace(tried.playback, position=frame / 30)))
        sent.append(slider.value)
    assert 5 < len(set(sent)) < 15
    paused = replace(tried, playback=replace(tried.playback, position=1.2345, playing=False))
    panel.update(tried, paused)
    assert slider.value == 1.23
    panel.update(paused, replace(tried, playback=None))
    assert slider.disabled and slider.value == 0


@pytest.mark.parametrize(
    "message, action",
    [
        ("attempt:3:1", a.ReplayAttempt(3)), ("toggle::1", a.TogglePlay()), ("restart::1", a.Seek(0.0)),
        ("step:-1:1", a.Step(-1)), ("step:9999:1", a.Step(30)), ("speed:0.25:1", a.Speed(0.25)),
        ("judge:bad:1", a.Judge("bad")),
    ],
)  # fmt: skip
def test_buttons_send_what_they_say(message, action):
    assert read_message(message, READERS) == action
