import lzma
from collections import Counter

import msgspec
import numpy as np
import pytest

from grasp_core.camera import canonical_camera
from grasp_core.dataset.archive import (
    Archive,
    Head,
    ObjectHead,
    SceneHead,
    executed_pose,
    locate_archive,
    read_archive,
    write_archive,
)
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.recipe import Recipe, load_recipe
from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.sample import SCENES, sample_dataset, sample_scenes
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.verify import verify
from grasp_core.errors import Cancelled, StoreError
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render
from grasp_core.simulation.physics import Physics, load_physics
from grasp_core.simulation.trial import child_seed

RECIPE = Recipe(name="boxes")


def heads(*objects: tuple[str, str, str], pose: int = 0) -> Archive:
    """An archive of (name, category, split), one scene each, without columns."""
    made = [
        ObjectHead(name, kind, split, 1.0, [0.0] * 9, None, "exact", "", {}, [], (0, 0), [])
        for name, kind, split in objects
    ]
    scenes = [
        SceneHead(f"{name}-{pose}", name, pose, 0, 0, np.eye(4).reshape(-1).tolist(), 0, 0) for name, *_ in objects
    ]
    return Archive(Head(1, "h", {}, {}, {}, "", {}, [], made, scenes), {})


def test_new_categories_come_first_and_splits_keep_their_share():
    train = [("box_000", "box", "train"), ("box_002", "box", "train"), ("can_002", "can", "train")]
    archive = heads(*train, ("box_001", "box", "test"), ("pen_000", "pen", "test"))
    assert sample_scenes(archive, {"train": 2}) == ["box_000-0", "can_002-0"]
    assert sample_scenes(archive, {"train": 9}) == ["box_000-0", "can_002-0", "box_002-0"]
    assert sample_scenes(archive, {"train": 1, "test": 1}) == ["box_000-0", "pen_000-0"]
    assert sample_scenes(heads(*train, pose=1)) == []


@pytest.fixture
def archive(tmp_path, make_box, at_rest):
    """The file of an archive of more scenes than the sample takes; no physics is run."""
    with DatasetStore.create(
        tmp_path / "made", name="boxes", gripper=load_gripper(), physics=load_physics(), recipe=RECIPE
    ) as store:
        for split, count in SCENES.items():
            for number in range(count + 1):
                asset = make_box(f"{split}_{number:03d}", (0.06, 0.04 + 0.001 * number, 0.05))
                pose = at_rest(asset)
                store.add_object(asset, split, [pose])
                scene = Scene.single(asset, place(pose.matrix, 0.0, 0.0, 0.1), canonical_camera())
                grasp = Grasp((0.0, 0.0, 0.02), 0.2, 0.1)
                row = AttemptRow("SUCCESS", child_seed(child_seed(number, 0), 0), (0.0,) * 4, False)
                row = msgspec.structs.replace(row, executed=executed_pose(grasp, row, RECIPE.noise))
                store.add_scene(
                    SceneRecord(f"{asset.name}-0", asset.name, 0, number, scene, render(scene), [grasp], [[row]])
                )
        write_archive(store, tmp_path / "boxes.npz.xz")
    return tmp_path / "boxes.npz.xz"


def test_it_is_made_once_and_stays_as_people_left_it(archive, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    calls = []
    path = sample_dataset(archive, progress=lambda *call: calls.append(call))
    assert path.is_relative_to(tmp_path)
    assert calls[-1] == (16, 16)
    with DatasetStore.open(path) as store:
        assert {split: sum(row.split == split for row in store.scenes()) for split in SCENES} == SCENES
        assert verify(store) == []
        store.add_label(1, "ann", 0.0)
    assert sample_dataset(archive, progress=lambda *_: pytest.fail("is there")) == path
    with DatasetStore.open(path, readonly=True) as store:
        assert len(store.events()) == 1


def test_cancelled_it_goes_on(archive, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    done = []
    with pytest.raises(Cancelled):
        sample_dataset(archive, progress=lambda *c: done.append(c), cancelled=lambda: len(done) > 3)
    again = []
    sample_dataset(archive, progress=lambda *call: again.append(call))
    assert 0 < again[0][0] == done[-1][0] < 16 and again[-1] == (16, 16)


def test_another_archive_gets_its_own_copy(archive, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    other = tmp_path / "other.npz.xz"
    other.write_bytes(lzma.compress(lzma.decompress(archive.read_bytes()), preset=0))
    assert sample_dataset(archive) != sample_dataset(other)


def test_no_archive_is_said():
    with pytest.raises(StoreError, match="no shipped archive is called 'nothing'"):
        sample_dataset("nothing")


def test_shipped_archive_is_of_the_recipe_default_and_gives_a_sound_sample(tmp_path, monkeypatch):
    path = locate_archive("default")
    assert path.stat().st_size <= 15e6
    archive = read_archive(path)
    assert msgspec.convert(archive.head.recipe, Recipe) == load_recipe("default")
    assert msgspec.convert(archive.head.physics, Physics) == load_physics()
    splits = Counter(item.split for item in archive.head.objects)
    assert splits["train"] >= 200 and splits["validation"] >= 20 and splits["test"] >= 20
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    with DatasetStore.open(sample_dataset()) as store:
        assert len(list(store.scenes())) == sum(SCENES.values())
        assert verify(store, gripper=load_gripper(), physics=load_physics()) == []
