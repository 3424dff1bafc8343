from dataclasses import replace

import msgspec
import pytest

from grasp_core.errors import GraspError
from grasp_core.simulation.evidence import Evidence, FingerContact
from workbench.bridge import read_message
from workbench.inspector import actions as a
from workbench.inspector.orders import Choice, SceneRequest
from workbench.inspector.panels.trial_panel import (
    READERS,
    TrialPanel,
    against,
    chips,
    compared,
    evidence,
    player,
    verdict,
    verdict_of_physics,
)  # fmt: skip
from workbench.inspector.state import Pinned, Playback, TrialState


@pytest.fixture
def tried(shown, attempt):
    trial = TrialState({0: attempt(0), 1: attempt(1, "SLIPPED")}, complete=True)
    return replace(shown.with_trial(shown.choice, trial), playback=Playback(shown.choice, attempt(0)))


def test_before_during_and_after_a_trial(shown, tried, bridge):
    assert "Try candidate 1" in verdict_of_physics(shown, bridge) and "× 5" in verdict_of_physics(shown, bridge)
    assert "being tried" in verdict_of_physics(shown.with_trial(shown.choice, TrialState(running=True)), bridge)
    page = verdict_of_physics(tried, bridge)
    assert 'data-outcome="SUCCESS"' in page and "Held to the end." in page
    assert 'data-successes="1"' in page and "1 / 2" in page and "predicted 0.90" in page


def test_failures_and_names_are_text(shown, bridge):
    page = verdict_of_physics(shown.with_trial(shown.choice, TrialState(failed="<b>no</b>")), bridge)
    assert "&lt;b&gt;" in page and "<b>no" not in page
    assert "Try candidate 1" in page, "it can be tried again at once"


def test_nothing_to_try(state, shown, bridge):
    assert "No candidate" in verdict_of_physics(state, bridge)
    own = replace(shown, scene=replace(shown.scene, scene=replace(shown.scene.scene, objects=())))
    assert "own image" in verdict_of_physics(own, bridge)


def test_evidence_in_short_lines(attempt):
    contact = FingerContact(0, 19.4, 3.0, (1, 0, 0), (0, 0, 0), "edge")
    found = Evidence(words="x", lift=0.12, left=contact, clearance=0.299)
    told = evidence(replace(attempt(0), evidence=msgspec.json.encode(found).decode()))
    assert "lift 12.0 cm" in told and "left finger: edge, 19 N" in told and "29.9 cm above" in told
    lying = Evidence(words="x", lift=0.12, clearance=-0.0008)
    assert "· on the table" in evidence(replace(attempt(0), evidence=msgspec.json.encode(lying).decode()))
    assert "height map" in evidence(replace(attempt(0), evidence=None))


def test_chips_are_one_an_attempt(tried, bridge):
    page = chips(tried, bridge)
    assert page.count("data-attempt") == 5 and page.count("not known yet") == 6 and page.count("gw-on") == 1
    assert "gw-spin" in against(replace(tried, trials={}))


def test_two_attempts_side_by_side(tried, attempt, bridge):
    assert compared(tried) == ""
    pinned = replace(tried, pinned=Pinned(Choice(0, 2), 0.3, attempt(4, "MISSED")))
    page = compared(pinned)
    assert "A (pale): candidate 3, attempt 5, score 0.30" in page and "B: candidate 1, attempt 1" in page
    assert "data-words" in verdict_of_physics(tried, bridge)
    assert "data-words" not in verdict_of_physics(pinned, bridge), "the words stand in the comparison"
    alone = replace(pinned, playback=None)
    assert "Click another" in compared(alone)


def test_the_player_is_off_without_a_replay(shown, tried, bridge):
    assert player(shown, bridge).count(" disabled") == 6 and player(tried, bridge).count("disabled") == 0
    assert 'data-playing="true"' in player(tried, bridge) and "4×" in player(tried, bridge)
    assert "gw-spin" in player(replace(tried, saving=True), bridge)


def test_verdicts_are_offered_where_they_can_be_stored(shown, bridge):
    assert "goes to ~/data/own" in verdict(shown, bridge) and "disabled" not in verdict(shown, bridge)
    assert 'data-stored="good"' in verdict(replace(shown, verdicts={shown.choice: "good"}), bridge)
    thing = msgspec.structs.replace(shown.request.things[0], loose=True)
    loose = verdict(replace(shown, request=SceneRequest((thing,))), bridge)
    assert loose.count("disabled") == 2 and "one object at rest" in loose


def test_messages_of_the_trial():
    assert read_message("attempt:3:1", READERS) == a.ReplayAttempt(3)
    assert read_message("step:-999:1", READERS) == a.Step(-30)
    assert read_message("judge:bad:1", READERS) == a.Judge("bad")
    for message in ("judge:great:1", "speed:fast:1", "attempt:x:1"):
        with pytest.raises(GraspError):
            read_message(message, READERS)


def test_the_time_is_sent_less_often_than_the_frames(tried, bridge, client):
    panel = TrialPanel(bridge)
    panel.update(None, tried)
    slider, sent = client.only("slider"), set()
    for step in range(60):
        panel.update(tried, replace(tried, playback=replace(tried.playback, position=step / 30)))
        sent.add(slider.value)
    assert 10 <= len(sent) <= 25
