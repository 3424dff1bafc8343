import asyncio
from dataclasses import replace
from types import SimpleNamespace

import pytest

from workbench.actions import Notice
from workbench.bridge import read_message
from workbench.inspector import actions as a
from workbench.inspector.orders import Item, Photo, SceneRequest
from workbench.inspector.panels.inputs_panel import READERS, TYPED, InputsPanel, opened, typed_intrinsics


def fire(handle, value):
    handle.value = value
    for handler in handle.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0)))


@pytest.fixture
def panel(bridge, catalogue, state):
    return InputsPanel(bridge, catalogue, state)


def test_uploads_and_folders_become_actions(panel, client, posted):
    fire(client.only("upload", "Upload a mesh"), SimpleNamespace(name="a.stl", content=b"x"))
    fire(client.only("upload", "Upload a depth image"), SimpleNamespace(name="a.npy", content=b"y"))
    fire(client.only("upload", "Upload a camera file"), SimpleNamespace(name="a.yaml", content=b"z"))
    fire(client.only("text", "Image folder"), "/data/images ")
    fire(client.only("dropdown", "Mesh unit"), "millimetres")
    assert posted == [
        a.OpenFile("mesh", "a.stl", b"x"), a.OpenFile("image", "a.npy", b"y"), a.OpenFile("camera", "a.yaml", b"z"),
        a.OpenFolder("image", "/data/images"), a.MeshUnit("mm"),
    ]  # fmt: skip


def test_cameras_are_shipped_own_or_typed(panel, client, posted, state):
    fire(client.only("dropdown", "Its camera"), "kinect")
    fire(client.only("text", "fx fy cx cy"), "525 525, 319.5 239.5")
    fire(client.only("dropdown", "Depth unit"), "millimetres")
    assert posted == [
        a.ReadPhotosWith("kinect", None, 0.0), a.ReadPhotosWith("", (525, 525, 319.5, 239.5), 0.0),
        a.ReadPhotosWith("primesense", None, 0.001),
    ]  # fmt: skip
    posted.clear()
    panel.update(None, replace(state, items=(Item("camera-1", "own.yaml", "camera", ""),)))
    fire(client.only("dropdown", "Its camera"), "own.yaml")
    assert posted == [a.ReadPhotosWith("camera-1", None, 0.0)]


def test_a_page_is_made_anew_while_an_own_camera_is_in_use(bridge, client, catalogue, state):
    used = replace(state, photo=Photo("image-1", "camera-1"), items=(Item("camera-1", "own.yaml", "camera", ""),))
    panel = InputsPanel(bridge, catalogue, used)
    shown = client.only("dropdown", "Its camera")
    assert shown.value in shown.options, "viser takes no other"
    panel.update(None, used)
    assert shown.value == "own.yaml" and shown.value in shown.options
    panel.update(used, replace(used, items=()))
    assert shown.value == TYPED, "a file that is gone"


@pytest.mark.parametrize("words", ["", "1 2 3", "1 2 3 4 5", "a b c d", "0 1 1 1", "nan 1 1 1", "inf 1 1 1"])
def test_typed_nonsense_is_refused(panel, client, posted, words):
    assert typed_intrinsics(words) is None
    fire(client.only("text", "fx fy cx cy"), words)
    assert isinstance(posted[0], Notice)


def test_own_files_are_listed_and_can_be_clicked(shown, bridge):
    assert "Nothing leaves this machine" in opened(shown, bridge)
    items = (
        Item("image-1", "<b>.npy", "image", ""),
        Item("image-2", "b.npy", "image", ""),
        Item("camera-1", "c", "camera", ""),
    )
    state = replace(shown, items=items, request=SceneRequest((), 1, Photo("image-2")), photo=Photo("image-2"))
    page = opened(state, bridge)
    assert "&lt;b&gt;" in page and "file:image-1" in page and "image 2 of 2" in page and page.count("gw-held") == 1
    assert "file:camera-1" not in page


def test_messages_of_the_list():
    assert read_message("file:image-12ab:1", READERS) == a.UseFile("image-12ab")
    assert read_message("photo:-9:1", READERS) == a.NextPhoto(-1)
    assert TYPED


def test_what_could_not_be_used_is_marked_and_what_is_shown_stays_marked(shown, bridge):
    good, bad = Item("image-1", "good.npy", "image", ""), Item("image-2", "bad.npy", "image", "")
    state = replace(
        shown,
        items=(good, bad),
        request=SceneRequest((), 0, Photo("image-2")),
        scene=replace(shown.scene, request=SceneRequest((), 0, Photo("image-1"))),
        failure="no image",
    )
    page = opened(state, bridge)
    assert page.index("gw-held") < page.index("good.npy") < page.index("bad.npy") < page.index("could not be used")
    assert page.count("gw-held") == page.count("could not be used") == 1
    assert "could not" not in opened(replace(state, failure=None), bridge)
