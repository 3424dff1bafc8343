import lzma
import shutil

import numpy as np
import pytest

from grasp_core.dataset.archive import locate_archive, read_archive, write_archive
from grasp_core.dataset.generate import generate
from grasp_core.dataset.recipe import Objects, Recipe
from grasp_core.dataset.restore import restore
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.verify import verify
from grasp_core.errors import StoreError
from grasp_core.parallel import Executor

TINY = Recipe(
    name="tiny",
    train=Objects(families={"box": 2, "can": 1}),
    test=Objects(names=("carton_009",)),
    poses=1,
    grid=3,
    angles=2,
    attempts=3,
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """(dataset, archive file)."""
    folder = tmp_path_factory.mktemp("archive")
    generate(TINY, folder / "d", Executor(workers=0))
    with DatasetStore.open(folder / "d") as store:
        store.add_label(1, "ann", 0.0)  # people's work is no part of an archive
        size = write_archive(store, folder / "tiny.npz.xz")
    assert size == (folder / "tiny.npz.xz").stat().st_size < 60_000
    return folder / "d", folder / "tiny.npz.xz"


@pytest.fixture(scope="module")
def restored(made, tmp_path_factory):
    path = tmp_path_factory.mktemp("restored") / "d"
    calls = []
    restore(read_archive(made[1]), path, executor=Executor(workers=0), progress=lambda *c: calls.append(c)).close()
    assert calls == [(done, 4) for done in range(5)]
    return path


def test_same_labels_seeds_and_executed_poses(made, restored):
    with DatasetStore.open(made[0], readonly=True) as a, DatasetStore.open(restored, readonly=True) as b:
        assert a.labels_digest() == b.labels_digest()
        assert a.meta.recipe == b.meta.recipe and a.meta.physics_digest == b.meta.physics_digest
        assert b.events() == []
        for row in a.scenes():
            ours, theirs = a.grasps(row.id), b.grasps(b.scene_id(row.name))
            for name in ("position", "angle", "width", "quality", "slipped", "number"):
                assert np.array_equal(getattr(ours, name), getattr(theirs, name))
            for x, y in zip(ours.id, theirs.id, strict=True):
                for one, two in zip(a.attempts(int(x)), b.attempts(int(y)), strict=True):
                    assert (one.seed, one.executed, one.dynamic) == (two.seed, two.executed, two.dynamic)
                    assert (one.comfort is None) == (two.comfort is None)
                    assert (one.evidence is None) == (two.evidence is None)
                    if one.comfort and two.comfort:
                        assert two.comfort == pytest.approx(one.comfort, abs=0.00051)


def test_same_depth_and_objects(made, restored):
    with DatasetStore.open(made[0], readonly=True) as a, DatasetStore.open(restored, readonly=True) as b:
        for row in a.scenes():
            ours, theirs = a.depth(row.id), b.depth(b.scene_id(row.name))
            assert np.abs(ours.depth - theirs.depth).max() <= 1.01e-4
            assert np.array_equal(ours.valid, theirs.valid)
        for row in a.objects():
            assert a.object(row.name).digest == b.object(row.name).digest
            assert a.poses(row.name) == b.poses(row.name)


def test_restored_dataset_verifies_and_is_not_made_twice(made, restored):
    with restore(read_archive(made[1]), restored, executor=Executor(workers=0)) as store:
        assert len(store.scenes()) == 4
        assert verify(store) == []


def test_a_part_can_be_restored_and_completed(made, tmp_path):
    archive = read_archive(made[1])
    with restore(archive, tmp_path / "p", only=archive.scenes[:1], executor=Executor(workers=0)) as store:
        assert [row.name for row in store.scenes()] == archive.scenes[:1]
        assert len(store.objects()) == 1
    with restore(archive, tmp_path / "p", executor=Executor(workers=0)) as store:
        assert [row.name for row in store.scenes()] == sorted(archive.scenes)


def test_damaged_missing_and_newer_archives(made, tmp_path):
    with pytest.raises(StoreError, match="no such archive"):
        read_archive(tmp_path / "none.npz.xz")
    with pytest.raises(StoreError, match="no shipped archive is called 'nothing'"):
        locate_archive("nothing")
    bad = tmp_path / "bad.npz.xz"
    for data in (b"text", lzma.compress(b"text"), made[1].read_bytes()[:-100]):
        bad.write_bytes(data)
        with pytest.raises(StoreError, match="damaged or no archive"):
            read_archive(bad)
    raw = lzma.decompress(made[1].read_bytes()).replace(b'{"format":1', b'{"format":9')
    bad.write_bytes(lzma.compress(raw))
    with pytest.raises(StoreError, match=r"newer version|damaged"):
        read_archive(bad)


def test_attempts_that_do_not_follow_from_seeds_are_refused(made, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(made[0], copy)
    with DatasetStore.open(copy) as store:
        with store.transaction() as db:
            db.execute("UPDATE attempts SET seed = seed + 1 WHERE grasp = 5")
        with pytest.raises(StoreError, match="do not follow from its scene's seed"):
            write_archive(store, tmp_path / "a.npz.xz")
