import msgspec
import pytest

from grasp_core.config import Settings
from grasp_core.dataset.merge import merge
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import MismatchError, StoreError
from grasp_core.gripper import load_gripper


class SamePhysics(Settings):
    friction: float = 0.6


@pytest.fixture
def parts(tmp_path, make_store, make_box, make_record, at_rest):
    """A dataset of three boxes, and two with two of them each; all with the same contents."""

    def build(name, indices):
        store = make_store(tmp_path / name)
        for index in indices:
            asset = make_box(f"box_{index:03d}", (0.05 + 0.01 * index, 0.04, 0.05))
            store.add_object(asset, "train", [at_rest(asset)])
            store.add_scene(make_record(asset, f"{asset.name}-0", seed=index))
        return store

    stores = [build("all", [0, 1, 2]), build("one", [0, 1]), build("two", [2, 1])]
    yield stores
    for store in stores:
        store.close()


def test_parts_become_the_whole(parts):
    whole, one, two = parts
    two.add_label(1, "bob", 0.0)
    two.add_label(6, "bob", "exclude")
    one.add_label(1, "ann", "flag")
    result = merge(one, [two])[0]
    assert (result.objects, result.scenes, result.known, result.events) == (1, 1, 1, 2)
    assert one.content_digest() == whole.content_digest()
    assert one.people() == ["ann", "bob"] and len(one.events()) == 3
    assert not one.differing_labels()
    again = merge(one, [two])[0]
    assert (again.objects, again.scenes, again.events) == (0, 0, 0)


def test_scenes_of_one_name_with_other_content_are_refused(parts):
    _, one, two = parts
    with two.transaction() as db:
        db.execute("UPDATE attempts SET outcome = 'MISSED' WHERE grasp IN (SELECT id FROM grasps WHERE scene = 2)")
    with pytest.raises(StoreError, match="box_001-0' has other content"):
        merge(one, [two])


def test_another_gripper_is_refused(parts, tmp_path):
    _, one, _ = parts
    gripper = msgspec.structs.replace(load_gripper(), force=5.0)
    physics = SamePhysics()
    with (
        DatasetStore.create(tmp_path / "g", name="g", gripper=gripper, physics=physics, recipe=physics) as other,
        pytest.raises(MismatchError, match="another gripper"),
    ):
        merge(one, [other])
