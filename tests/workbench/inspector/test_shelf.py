from pathlib import Path

import pytest

from grasp_core.errors import GraspError
from workbench.inspector import shelf as module
from workbench.inspector.shelf import Shelf


@pytest.fixture
def shelf():
    made = Shelf()
    yield made
    made.close()


def test_an_upload_is_kept_under_its_content(shelf):
    item = shelf.add("mesh", "my mug.STL", b"abc", "mm")
    assert item.key.startswith("mesh-") and item.key.endswith("-mm") and item.name == "my mug.STL"
    assert Path(shelf.files[item.key]).read_bytes() == b"abc"
    assert shelf.add("mesh", "other.stl", b"abc", "mm").key == item.key
    long = shelf.add("image", "a_depth_image_with_a_name_" + "x" * 100 + ".png", b"x")
    assert "--a_depth_image_with" in long.path and long.path.endswith("xx.png"), "messages name it by its beginning"
    assert shelf.add("mesh", "my mug.STL", b"abc", "m").key != item.key, "another unit is another object"


@pytest.mark.parametrize(
    "name", ["../../../etc/cron.d/evil.stl", "/etc/passwd.stl", "a/b\\c:d.stl", "." * 200 + ".stl"]
)
def test_names_of_browsers_never_leave_the_folder(shelf, name):

    item = shelf.add("mesh", name, b"x")
    assert Path(item.path).resolve().parent == shelf._folder.resolve()


@pytest.mark.parametrize(
    ("kind", "name"), [("mesh", "a.exe"), ("image", "a.stl"), ("camera", "a.png"), ("mesh", "stl")]
)
def test_other_endings_are_refused(shelf, kind, name):
    with pytest.raises(GraspError, match="ends in"):
        shelf.add(kind, name, b"x")


def test_too_large_files_are_refused(shelf):
    with pytest.raises(GraspError, match="MB"):
        shelf.add("camera", "a.yaml", b"x" * (module.MOST["camera"] + 1))


def test_old_uploads_make_room(shelf, monkeypatch):
    monkeypatch.setattr(module, "_ROOM", 25)
    first = shelf.add("mesh", "a.stl", b"a" * 10)
    for letter in (b"b", b"c"):
        shelf.add("mesh", "x.stl", letter * 10)

    assert not Path(first.path).exists()


def test_a_folder_is_listed_by_kind(shelf, tmp_path):
    for name in ("b.npy", "a.png", "c.txt"):
        (tmp_path / name).write_bytes(b"x")
    (tmp_path / "deep.png").mkdir()
    assert [item.name for item in shelf.open_folder("image", str(tmp_path))] == ["a.png", "b.npy"]


def test_folders_that_hold_nothing_are_refused(shelf, tmp_path, monkeypatch):
    with pytest.raises(GraspError, match="no such folder"):
        shelf.open_folder("mesh", str(tmp_path / "none"))
    with pytest.raises(GraspError, match="holds no mesh"):
        shelf.open_folder("mesh", str(tmp_path))
    monkeypatch.setattr(module, "MOST_FILES", 1)
    for name in ("b.npy", "a.npy"):
        (tmp_path / name).write_bytes(b"x")
    with pytest.raises(GraspError, match="at most 1"):
        shelf.open_folder("image", str(tmp_path))


def test_uploads_go_with_the_app(shelf):
    item = shelf.add("mesh", "a.stl", b"a")
    shelf.close()

    assert not Path(item.path).exists()
