import asyncio
from dataclasses import replace
from types import SimpleNamespace

from workbench.bridge import read_message
from workbench.inspector.actions import AnotherObject, AnotherPose, RandomScene, ShowObject, Toggle
from workbench.inspector.panels.scene_panel import READERS, ScenePanel, facts, family_label, layers


def test_facts_say_what_is_shown(shown):
    told = facts(shown)
    assert "box_003" in told and "12.0 × 4.0 × 6.0 cm" in told
    assert "pose 1 of 2" in told and "75 %" in told


def test_facts_while_working_and_after_a_failure(state, shown):
    assert "first scene" in facts(state)
    assert "pen" in facts(replace(shown, making=1, request=replace(shown.request, family="pen")))
    assert "&lt;b&gt;" in facts(replace(shown, failure="<b>no</b>")), "reasons are shown as text, never as HTML"


def test_buttons_send_what_they_say():
    assert isinstance(read_message("object::1", READERS), AnotherObject)
    assert read_message("pose::1", READERS) == AnotherPose()
    assert read_message("random::1", READERS) != read_message("random::1", READERS), "every click draws anew"
    assert isinstance(read_message("random::1", READERS), RandomScene)
    assert read_message("show:camera:1", READERS) == Toggle("camera")


def test_layers_show_what_is_on(shown, bridge):
    page = layers(replace(shown, shown=frozenset({"camera"})), bridge)
    assert page.count('aria-pressed="true"') == 1 and page.count('aria-pressed="false"') == 2


def test_families_have_names_for_people(bridge, client, catalogue, state, posted):
    panel = ScenePanel(bridge, catalogue, state)
    dropdown = client.only("dropdown", "Object")
    assert dropdown.options == ("box", "mug", "pen") and family_label("glue_stick") == "glue stick"
    dropdown.value = "mug"
    for handler in dropdown.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0)))
    assert posted == [ShowObject("mug")]
    panel.update(None, replace(state, request=replace(state.request, family="pen", planner="random")))
    assert dropdown.value == "pen" and client.only("dropdown", "Planner").value == "random"
