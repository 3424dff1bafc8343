import msgspec
import pytest

from grasp_core.config import Settings
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import MismatchError, StoreError
from grasp_core.gripper import load_gripper


class Physics(Settings):
    friction: float = 0.6


def test_head_is_kept(store):
    meta = store.meta
    assert meta.name == "t" and meta.physics == {"friction": 0.6} and meta.weights is None
    assert store.gripper() == msgspec.structs.replace(load_gripper(), urdf=None)  # a dataset carries no paths


def test_create_refuses_a_dataset_that_is_there(store, make_store):
    with pytest.raises(StoreError, match="holds a dataset already"):
        make_store(store.path)


def test_open_by_folder_or_file(store):
    for path in (store.path, store.file, str(store.path)):
        with DatasetStore.open(path, readonly=True) as again:
            assert again.meta == store.meta


def test_another_gripper_or_physics_is_refused(store):
    store.check(gripper=load_gripper(), physics=Physics())
    with pytest.raises(MismatchError, match="gripper"):
        store.check(gripper=msgspec.structs.replace(load_gripper(), force=30.0))
    with pytest.raises(MismatchError, match="friction"):
        store.check(physics=Physics(friction=0.5))


def test_content_digest_ignores_order_times_and_people(tmp_path, make_store, make_box, make_record, at_rest):
    digests = []
    for order in ([0, 1, 2], [2, 0, 1]):
        with make_store(tmp_path / str(order)) as made:
            for index in order:
                asset = make_box(f"box_{index:03d}", (0.05 + 0.01 * index, 0.04, 0.05))
                made.add_object(asset, "train", [at_rest(asset)])
                made.add_scene(make_record(asset, f"{asset.name}-0", seed=index))
            made.add_label(1, "ann", 0.0)
            digests.append(made.content_digest())
    assert digests[0] == digests[1]


def test_content_digest_sees_another_scene(store, asset, make_record):
    before = store.content_digest()
    store.add_scene(make_record(asset, "box_000-1", seed=1))
    assert store.content_digest() != before
