from dataclasses import replace

import msgspec
import pytest

from grasp_core.errors import GraspError
from workbench.bridge import read_message
from workbench.inspector import actions as a
from workbench.inspector.orders import Choice, Place
from workbench.inspector.panels.images_panel import (
    READERS,
    ImagesPanel,
    controls,
    detail,
    legend,
    selection,
    speed,
    views,
)  # fmt: skip
from workbench.inspector.state import Live


def test_messages_of_the_image():
    assert read_message("ask:12.5,7.0:1", READERS) == a.AskPlace(12.5, 7.0)
    assert read_message("overlay:0.4:1", READERS) == a.Overlay(0.4)
    assert read_message("range:0.8,0.2:1", READERS) == a.DepthRange(0.2, 0.8)
    assert read_message("mark:samples:1", READERS) == a.ToggleMark("samples")
    assert read_message("colours:turbo:1", READERS) == a.DepthColours("turbo")


@pytest.mark.parametrize(
    "message",
    [
        "ask:1:1",
        "ask:nan,1:1",
        "ask:1,inf:1",
        "overlay:7:1",
        "range:0.1:1",
        "range:a,b:1",
        "mark:x:1",
        "colours:pink:1",
    ],
)
def test_forged_messages_are_refused(message):
    with pytest.raises(GraspError):
        read_message(message, READERS)


def test_two_plans_stand_side_by_side_with_their_times(shown, bridge, make_scene):
    setup = msgspec.structs.replace(shown.setup, beside="random")
    page = views(replace(shown, scene=make_scene(setup=setup)), bridge)
    assert page.count("<svg") == 2 and "3 in 40 ms" in page and "look:1" in page and page.count("gw-looked") == 1


def test_a_plan_that_failed_says_why_in_its_place(shown, bridge, sight, one_plan):
    setup = msgspec.structs.replace(shown.setup, beside="random")
    scene = replace(shown.scene, setup=setup, sight=sight((None, one_plan())))
    page = views(replace(shown, scene=scene, choice=Choice(1, 0)), bridge)
    assert "other gripper" in page or "another gripper" in page
    assert page.count("<svg") == 1


def test_before_the_first_plan(state, bridge):
    assert "first plan" in views(state, bridge) and "no image" in views(replace(state, failure="no"), bridge)
    assert legend(state) == "" and speed(state) == "" and "No candidate" in detail(state)


def test_the_speed_of_a_drag_is_shown(shown):
    assert "drag the gizmo" in speed(shown)
    behind = replace(shown, live=Live(80.0, tuple(n / 11 for n in range(12))))
    assert "11.0/s · 80 ms behind" in speed(replace(behind, dragging=True))
    assert "drag the gizmo" in speed(behind), "it has ended"


def test_the_selected_candidate_is_marked_by_a_style(shown, state):
    assert ".gw-c0-0" in selection(shown) and selection(state) == "<style></style>"


def test_controls_show_what_is_on(shown, bridge):
    page = controls(shown, bridge)
    assert page.count('aria-pressed="true"') == 2 and 'value="0.35"' in page and "<option selected>bone" in page


def test_the_place_that_was_asked_about(shown, scores):
    assert "Click any free pixel" in detail(shown)
    place = Place(5.0, 6.0, 0.66, 0.2)
    assert "Scoring" in detail(replace(shown, place=place))
    assert "gw-polar" in detail(replace(shown, place=replace(place, scores=scores(5.0, 6.0))))
    assert "&lt;b&gt;" in detail(replace(shown, place=replace(place, failed="<b>")))


def test_pictures_are_sent_only_when_something_on_them_changed(shown, bridge, client):
    panel = ImagesPanel(bridge)
    panel.update(None, shown)
    svg = next(handle for handle in client.made if handle.kind == "html" and "gw-depth" in handle.content)
    before = svg.content
    selected = replace(shown, choice=Choice(0, 2), picture=replace(shown.picture, opacity=0.9))
    panel.update(shown, selected)
    assert svg.content is before
    panel.update(selected, replace(selected, least=0.5))
    assert svg.content is not before
