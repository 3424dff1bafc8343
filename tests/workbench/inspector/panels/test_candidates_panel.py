from dataclasses import replace

import pytest

from grasp_core.errors import GraspError
from workbench import colours
from workbench.bridge import read_message
from workbench.inspector import actions as a
from workbench.inspector.orders import Choice
from workbench.inspector.panels.candidates_panel import READERS, CandidatesPanel, listing, stages, tools
from workbench.inspector.state import Sweep, TrialState


def test_stages_fill_the_bar_and_names_are_escaped():
    assert "</b>scores 124<" in stages({"scores": 123.6}) and "</b>crops 9.4<" in stages({"crops": 9.44}), (
        "in two lines"
    )
    page = stages({"crops": 1.0, "<b>": 3.0, "none": 0.0})
    assert "width:75.0%" in page and "&lt;b&gt;" in page and "none" not in page


def test_every_candidate_has_its_row(shown, bridge, sight, one_plan):
    page = listing(shown, bridge)
    assert page.count("data-candidate") == 3 and "3 candidates" in page and "cascade in 40 ms" in page
    assert "0.900" in page and "80" in page
    assert "1 candidate <" in listing(replace(shown, scene=replace(shown.scene, sight=sight((one_plan(1),)))), bridge)
    assert "2 hidden" in listing(replace(shown, least=0.8), bridge)
    none = listing(replace(shown, least=1.0), bridge)
    assert "All scores are below 1.00" in none and "<table" not in none and "least score" in none


def test_what_physics_and_people_said_stands_in_the_row(shown, bridge, attempt):
    trial = TrialState({0: attempt(0), 1: attempt(1, "SLIPPED")}, complete=True)
    page = listing(replace(shown.with_trial(Choice(0, 0), trial), verdicts={Choice(0, 1): "bad"}), bridge)
    assert ">1/2<" in page and "✗" in page
    assert f"color:{colours.css(colours.score(0.5))}" in page, "halfway between nothing and all"


def test_empty_plans_and_failures_say_why(shown, state, bridge, empty_scene, sight):
    none = replace(shown, scene=empty_scene, choice=None)
    assert "Move the object, or lower t" in listing(none, bridge)
    own = replace(empty_scene, scene=replace(empty_scene.scene, objects=()))
    unsampled = replace(own.sight.plans[0], sampled=own.sight.plans[0].sampled[:0])
    own = replace(own, sight=replace(own.sight, plans=(unsampled,)))
    assert "Try another image.<" in listing(replace(none, scene=own), bridge), "nothing was scored: t changes nothing"
    assert "nothing stands on the table" in listing(replace(shown, scene=empty_scene, choice=None), bridge)
    assert "first plan" in listing(state, bridge) and "no plan" in listing(replace(state, failure="no"), bridge)
    failed = replace(shown.scene, sight=sight((None,)))
    assert "another gripper" in listing(replace(shown, scene=failed, choice=None), bridge)


def test_the_job_shows_its_progress_and_can_be_cancelled(shown, bridge):
    running = replace(shown, sweep=Sweep(0, (2,), 3)).with_trial(Choice(0, 1), TrialState(running=True))
    page = tools(running, bridge)
    assert 'data-done="1"' in page and "1 of 3 tried" in page and "stop:" in page
    assert "tryall:" in tools(shown, bridge) and "disabled" in tools(replace(shown, scene=None), bridge)


def test_messages_of_the_list():
    assert read_message("select:1.20:1", READERS) == a.Select(Choice(1, 20))
    assert read_message("tint:physics:1", READERS) == a.ColourBy("physics")
    assert read_message("least:0.25:1", READERS) == a.Filter(0.25)


@pytest.mark.parametrize(
    "message", ["select:1:1", "select:a.b:1", "select:1.-1:1", "tint:x:1", "least:2:1", "look:x:1"]
)
def test_forged_messages_are_refused(message):
    with pytest.raises(GraspError):
        read_message(message, READERS)


def test_the_list_is_sent_only_when_it_changed(shown, bridge, client):
    panel = CandidatesPanel(bridge)
    panel.update(None, shown)
    handle = client.only("html") if len([h for h in client.made if h.kind == "html"]) == 1 else client.made[-1]
    page = client.page()
    panel.update(shown, replace(shown, speed=2.0))
    assert client.page() == page and handle is not None
