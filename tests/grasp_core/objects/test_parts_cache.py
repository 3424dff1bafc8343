import numpy as np
import pytest
import trimesh

from grasp_core.objects import parts_cache
from grasp_core.objects.asset import Part
from grasp_core.objects.fidelity import Fidelity
from grasp_core.objects.parts_cache import Decomposition


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(parts_cache.platformdirs, "user_cache_dir", lambda name: str(tmp_path))
    return tmp_path / "parts"


@pytest.fixture
def found():
    box = trimesh.creation.box([0.1, 0.05, 0.02])
    part = Part(np.asarray(box.vertices, float), np.asarray(box.faces, np.int32))
    return Decomposition((part, part), "exact", Fidelity(0.001, 0.02, 0.03))


def test_what_was_written_comes_back(folder, found):
    parts_cache.write("key", found)
    again = parts_cache.read("key")
    assert (again.method, again.fidelity) == (found.method, found.fidelity)
    for mine, theirs in zip(again.parts, found.parts, strict=True):
        np.testing.assert_array_equal(mine.vertices, theirs.vertices)
        np.testing.assert_array_equal(mine.faces, theirs.faces)
    assert [file.name for file in folder.iterdir()] == ["key.npz"]


def test_nothing_and_damaged_files_are_nothing(folder, found):
    assert parts_cache.read("key") is None
    parts_cache.write("key", found)
    (folder / "key.npz").write_bytes(b"half a file")
    assert parts_cache.read("key") is None


def test_a_cache_that_cannot_be_written_is_no_error(folder, found):
    folder.write_text("a file where the folder should be")
    parts_cache.write("key", found)
    assert folder.is_file()
