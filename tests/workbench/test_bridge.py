import asyncio
from types import SimpleNamespace

import numpy as np
import pytest

from grasp_core.errors import GraspError
from workbench.actions import Judge, Notice, Seek, Select, ShowObject
from workbench.bridge import plain, pose, put, read_message, sentence, text
from workbench.screen import READERS


def fire(handle, **event):
    """What viser does when a person uses a widget."""
    for handler in handle.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0, **event)))


def test_values_become_builtins():
    out = plain([np.float32(0.5), np.int64(3), np.bool_(True), "a", (np.float64(1.0),)])
    assert out == (0.5, 3, True, "a", (1.0,))
    assert [type(value) for value in out[:3]] == [float, int, bool]
    assert plain(np.zeros(3)) is not None


@pytest.mark.parametrize("value", [object(), {"a": 1}, float("nan"), float("inf"), np.array([object()]), [object()]])
def test_what_viser_cannot_encode_never_reaches_it(value):
    with pytest.raises(GraspError, match="cannot be shown"):
        plain(value)


def test_equal_values_are_not_sent_again():
    sent = []

    class Handle:
        value = 1.0

        def __setattr__(self, name, value):
            sent.append((name, value))

    put(Handle(), value=1.0)
    put(Handle(), value=np.float32(2.0))
    assert sent == [("value", 2.0)]


def test_foreign_text_cannot_become_html():
    assert text('<img src=x onerror="alert(1)">') == "&lt;img src=x onerror=&quot;alert(1)&quot;&gt;"


def test_poses_are_handed_over_as_quaternion_and_place():
    transform = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1.0]])
    turn, place = pose(transform)
    assert np.allclose(turn, [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    assert place == (1.0, 2.0, 3.0)


def test_messages_of_the_page_become_actions():
    assert read_message("select:2:17", READERS) == Select(2)
    assert read_message("judge:good:17", READERS) == Judge("good")


@pytest.mark.parametrize(
    "value",
    ["select:2", "select:two:1", "launch:1:1", "judge:perfect:1", "select:2:1;drop", "select:" + "9" * 100 + ":1"],
)
def test_forged_messages_are_refused(value):
    with pytest.raises(GraspError, match="page sent"):
        read_message(value, READERS)


def test_messages_arrive_through_the_hidden_text(bridge, client, posted):
    inbox = client.only("text")
    inbox.value = "select:1:5"
    fire(inbox)
    inbox.value = "hello"
    fire(inbox)
    assert posted[0] == Select(1)
    assert isinstance(posted[1], Notice)


def test_onclick_takes_messages_of_this_app_only(bridge):
    assert "select:3:" in bridge.onclick("select:3")
    with pytest.raises(ValueError):
        bridge.onclick("select:3');alert(1)//")


def test_forged_widget_values_become_notices(bridge, client, posted):
    dropdown = bridge.dropdown("Object", ("mug", "pen"), "mug", ShowObject, "")
    dropdown.value = "rocket"
    fire(dropdown)
    slider = bridge.slider("Time", 0, 2, 0.1, 0, Seek, "")
    for forged in (99.0, float("nan"), -1.0):
        slider.value = forged
        fire(slider)
    assert [type(action) for action in posted] == [Notice] * 4
    slider.value, dropdown.value = 1.5, "pen"
    fire(slider)
    fire(dropdown)
    assert posted[4:] == [Seek(1.5), ShowObject("pen")]


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
    bridge.clickable(mesh, lambda: 2, Select)
    for index in (5, -1, None, True and "0"):
        fire(mesh, instance_index=index)
    fire(mesh, instance_index=1)
    assert [type(action) for action in posted[:4]] == [Notice] * 4
    assert posted[4] == Select(1)


def test_buttons_carry_hint_and_state(bridge):
    button = bridge.button("‹", "step:-1", hint='one "frame" back', off=True)
    assert button.endswith("disabled>‹</button>")
    assert "aria-label" in button and "&quot;frame&quot;" in button


def test_notices_reach_the_browser(bridge, client):
    bridge.notify("error", "Title", "Body")
    assert client.notices == [("Title", "Body")]


def test_sentences():
    assert sentence("held to the end") == "Held to the end."
    assert sentence("Done!") == "Done!" and sentence("  ") == ""
