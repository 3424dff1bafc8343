import asyncio
from dataclasses import replace
from types import SimpleNamespace

import msgspec
import pytest

from workbench.bridge import read_message
from workbench.inspector import actions as a
from workbench.inspector.orders import Item, Photo, SceneRequest, Thing
from workbench.inspector.panels.scene_panel import OWN, READERS, ScenePanel, facts, family_label, layers, moving


def test_facts_say_what_is_shown(shown, bridge):
    told = facts(shown, bridge)
    assert "box_003" in told and "120 × 40 × 60 mm" in told and "pose 1/2, 75 %" in told


def test_facts_while_working_and_after_a_failure(state, shown, bridge):
    assert "first scene" in facts(replace(state, making=0), bridge)
    assert "Making" in facts(replace(shown, making=2), bridge)
    assert "&lt;b&gt;" in facts(replace(shown, failure="<b>no</b>"), bridge), "reasons are text, never HTML"


def test_facts_of_dragged_objects_and_own_images(shown, bridge):
    thing = msgspec.structs.replace(shown.request.things[0], loose=True)
    assert "not at rest" in facts(replace(shown, request=SceneRequest((thing,))), bridge)
    own = replace(
        shown, request=SceneRequest((), 1, Photo("image-1")), items=(Item("image-1", "<i>.npy", "image", ""),)
    )
    assert "300 × 300 px" in facts(own, bridge) and "&lt;i&gt;.npy" in facts(own, bridge)


def test_buttons_send_what_they_say():
    assert isinstance(read_message("object::1", READERS), a.AnotherObject)
    assert read_message("pose::1", READERS) == a.AnotherPose()
    assert read_message("random::1", READERS) != read_message("random::1", READERS), "every click draws anew"
    assert read_message("several::1", READERS).count == 3
    assert read_message("show:camera:1", READERS) == a.Toggle("camera")
    assert read_message("mode:free:1", READERS) == a.DragMode("free")
    assert read_message("grab:2:1", READERS) == a.Grab(2)


@pytest.mark.parametrize("message", ["show:everything:1", "mode:fly:1", "grab:x:1"])
def test_forged_messages_are_refused(message):
    from grasp_core.errors import GraspError

    with pytest.raises(GraspError):
        read_message(message, READERS)


def test_layers_show_what_is_on(shown, bridge):
    page = layers(replace(shown, shown=frozenset({"camera"})), bridge)
    assert page.count('aria-pressed="true"') == 1 and page.count('aria-pressed="false"') == 5


def test_settling_is_offered_where_it_is_needed(shown, bridge):
    thing = msgspec.structs.replace(shown.request.things[0], loose=True)
    assert 'class="gw-main"' in moving(replace(shown, request=SceneRequest((thing,))), bridge)
    assert "disabled" in moving(replace(shown, settling=True), bridge)
    assert moving(replace(shown, request=SceneRequest((), 1, Photo("image-1"))), bridge).count("disabled") == 3


def test_families_have_names_for_people(bridge, client, catalogue, state, posted):
    panel = ScenePanel(bridge, catalogue, state)
    dropdown = client.only("dropdown", "Object")
    assert dropdown.options == (OWN, "box", "mug", "pen") and family_label("glue_stick") == "glue stick"
    dropdown.value = "mug"
    for handler in dropdown.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0)))
    assert posted == [a.ShowObject("mug_000")]
    panel.update(None, replace(state, request=SceneRequest((Thing("pen_007"),))))
    assert dropdown.value == "pen"
    panel.update(None, replace(state, request=SceneRequest((Thing("pen_007"), Thing("mug_000")))))
    assert dropdown.value == OWN
