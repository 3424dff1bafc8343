import asyncio
from types import SimpleNamespace

import pytest

from grasp_core.errors import GraspError
from workbench.actions import Notice
from workbench.bridge import read_message
from workbench.inspector.actions import Judge, Seek, Select, ShowObject
from workbench.inspector.orders import Choice
from workbench.inspector.view import READERS


def fire(handle, **event):
    """What viser does when a person uses a widget."""
    for handler in handle.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0, **event)))


def test_messages_of_the_page_become_actions():
    assert read_message("select:0.2:17", READERS) == Select(Choice(0, 2))
    assert read_message("judge:good:17", READERS) == Judge("good")


@pytest.mark.parametrize(
    "value",
    ["select:2", "select:two:1", "launch:1:1", "judge:perfect:1", "select:2:1;drop", "select:" + "9" * 5000 + ":1"],
)
def test_forged_messages_are_refused(value):
    with pytest.raises(GraspError, match="page sent"):
        read_message(value, READERS)


def test_messages_arrive_through_the_hidden_text(bridge, client, posted):
    inbox = client.only("text")
    inbox.value = "select:0.1:5"
    fire(inbox)
    inbox.value = "hello"
    fire(inbox)
    assert posted[0] == Select(Choice(0, 1))
    assert isinstance(posted[1], Notice)


def test_onclick_takes_messages_of_this_app_only(bridge):
    assert "gwSend('select:3')" in bridge.onclick("select:3")
    with pytest.raises(ValueError):
        bridge.onclick("select:3');alert(1)//")


def test_forged_widget_values_become_notices(bridge, client, posted):
    dropdown = bridge.dropdown("Object", ("mug", "pen"), "mug", ShowObject, "")
    dropdown.value = "rocket"
    fire(dropdown)
    slider = bridge.slider("Time", 0, 2, 0.1, 0, Seek, "")
    for forged in (99.0, float("nan"), -1.0, "1", None, True):
        slider.value = forged
        fire(slider)
    assert [type(action) for action in posted] == [Notice] * 7
    slider.value, dropdown.value = 1.5, "pen"
    fire(slider)
    fire(dropdown)
    assert posted[7:] == [Seek(1.5), ShowObject("pen")]


def test_what_this_app_sets_itself_is_no_action(bridge, client, posted):
    slider = bridge.slider("Time", 0, 2, 0.1, 0, Seek, "")
    asyncio.run(slider.handlers[0](SimpleNamespace(client_id=None)))
    assert posted == []


def test_an_exception_in_a_handler_becomes_a_notice(bridge, client, posted):
    def broken(_: str):
        raise RuntimeError("boom")

    fire(bridge.dropdown("Object", ("mug",), "mug", broken, ""))
    assert posted[0].tone == "error" and "boom" in posted[0].body


def test_clicks_on_impossible_instances_are_refused(bridge, client, posted):
    mesh = client.add_batched_meshes_simple("/m")
    switch = bridge.clickable(mesh, lambda: 2, Select)
    for index in (5, -1, 1.5, "0"):
        fire(mesh, instance_index=index)
    fire(mesh, instance_index=1)
    assert [type(action) for action in posted[:4]] == [Notice] * 4
    assert posted[4] == Select(1)
    switch(False)
    assert not mesh.handlers, "the pointer passes through it"
    switch(True)
    fire(mesh, instance_index=1)
    assert posted[5:] == [Select(1)]


def test_buttons_carry_hint_and_state(bridge):
    button = bridge.button("‹", "step:-1", hint='one "frame" back', off=True)
    assert button.endswith("disabled>‹</button>")
    assert "aria-label" in button and "&quot;frame&quot;" in button


def test_notices_reach_the_browser(bridge, client):
    bridge.notify("error", "Title", "Body")
    assert client.notices == [("Title", "Body.")]
    bridge.notify("error", "Title", "no family of that name; choose one of: " + "family, " * 100)
    told = client.notices[-1][1]
    assert len(told) < 245 and told.startswith("No family of that name") and told.endswith(" …")


def test_texts_are_bounded(bridge, client, posted):
    field = bridge.field("Folder", "", ShowObject, "")
    for value in ("x" * 1001, 5):
        field.value = value
        fire(field)
    field.value = " mug "
    fire(field)
    assert [type(action) for action in posted[:2]] == [Notice] * 2
    assert posted[2] == ShowObject("mug")


def test_uploads_of_other_kinds_are_refused(bridge, client, posted):
    button = bridge.upload("Mesh", (".stl", ".off"), 100, lambda name, content: ShowObject(name), "")
    for name in ("a.exe", "stl", "a" * 300 + ".stl"):
        button.value = SimpleNamespace(name=name, content=b"")
        fire(button)
    button.value = SimpleNamespace(name="A.STL", content=b"1")
    fire(button)
    assert [type(action) for action in posted[:3]] == [Notice] * 3
    assert posted[3] == ShowObject("A.STL")


def test_forged_poses_of_a_gizmo_are_refused(bridge, client, posted):
    gizmo = client.add_transform_controls("/gizmo")
    bridge.draggable(gizmo, lambda turn, place, ended: (turn, place, ended))
    for turn, place in (((0, 0, 0, 0), (0, 0, 0)), ((1, 0, 0, 0), (float("nan"), 0, 0)), ((1, 0, 0, 0), (99, 0, 0))):
        gizmo.wxyz, gizmo.position = turn, place
        fire(gizmo, phase="update")
    gizmo.wxyz, gizmo.position = (1.1, 0, 0, 0), (0.1, 0, 0)
    fire(gizmo, phase="end")
    assert [type(action) for action in posted[:3]] == [Notice] * 3
    assert posted[3] == ((1.0, 0.0, 0.0, 0.0), (0.1, 0.0, 0.0), True)


def test_sections_hide_what_was_made_in_them(bridge, client):
    outside = bridge.html("outside")
    with bridge.section("/part") as section:
        first, second = bridge.html("first"), bridge.html("second")
        assert bridge.node("/table") == "/part/table"
    section.want(second, False)
    assert first.visible and not second.visible
    section.show(False)
    assert not first.visible and outside.visible and not client.only("add_frame").visible
    section.show(True)
    assert first.visible and not second.visible, "what was hidden inside stays hidden"
