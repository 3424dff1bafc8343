import dataclasses

import numpy as np
import pytest

from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError


def test_scene_comes_back_whole(store, asset, make_record):
    given = make_record(asset)
    row = store.scenes("train")[0]
    assert (row.name, row.object, row.category, row.grasps, row.best) == ("box_000-0", "box_000", "box", 4, 1.0)
    assert store.scenes("test") == []
    scene = store.scene(row.id)
    assert np.array_equal(scene.objects[0].world_from_object, given.scene.objects[0].world_from_object)
    assert scene.objects[0].asset.digest == asset.digest
    depth = store.depth(row.id)
    assert np.array_equal(depth.valid, given.depth.valid)
    assert np.abs(depth.depth - given.depth.depth)[depth.valid].max() < 0.6e-4
    assert store.scene_id(row.name) == row.id


def test_objects_and_poses(store, asset, at_rest):
    assert [row.name for row in store.objects()] == ["box_000"]
    assert store.poses("box_000") == [at_rest(asset)]
    with pytest.raises(StoreError, match="no object called 'cup'"):
        store.object("cup")


def test_same_object_twice_is_fine_another_is_not(store, asset, make_box, at_rest):
    assert not store.add_object(asset, "train", [at_rest(asset)])
    with pytest.raises(StoreError, match="another object"):
        store.add_object(asset, "test", [at_rest(asset)])
    with pytest.raises(StoreError, match="another object"):
        store.add_object(make_box(size=(0.1, 0.1, 0.1)), "train", [])


def test_scene_is_stored_once(store, asset, make_record):
    assert not store.add_scene(make_record(asset))
    assert len(store.scenes()) == 1


def test_scene_is_all_or_nothing(store, asset, make_record):
    broken = dataclasses.replace(make_record(asset, "box_000-1"), seed=None)
    with pytest.raises(StoreError):
        store.add_scene(broken)
    stranger = dataclasses.replace(make_record(asset, "cup-1"), object="cup")
    with pytest.raises(StoreError, match="add the object"):
        store.add_scene(stranger)
    short = dataclasses.replace(make_record(asset, "box_000-2"), attempts=[])
    with pytest.raises(StoreError, match="4 grasps but attempts for 0"):
        store.add_scene(short)
    assert store.row("SELECT count(*) FROM grasps")[0] == 4
    assert store.row("SELECT count(*) FROM placements")[0] == 1


def test_missing_image_and_damaged_object_are_named(store):
    image = next((store.path / "depth").iterdir())
    image.unlink()
    with pytest.raises(StoreError, match=image.name):
        store.depth(1)
    file = next((store.path / "objects").iterdir())
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 1
    file.write_bytes(data)
    with pytest.raises(StoreError, match="checksum"):
        store.object("box_000")


def test_readers_see_scenes_while_one_writes(store, asset, make_record):
    with DatasetStore.open(store.path, readonly=True) as reader:
        store.add_scene(make_record(asset, "box_000-1", seed=1))
        assert len(reader.scenes()) == 2
