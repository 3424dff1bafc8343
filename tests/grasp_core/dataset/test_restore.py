"""Restoring labels that were made by hand: no physics is run, neither here nor there."""

import msgspec
import numpy as np
import pytest

from grasp_core.dataset import archive as archives
from grasp_core.dataset.archive import STEPS, Archive, executed_pose, read_archive, write_archive
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.recipe import Recipe
from grasp_core.dataset.restore import restore
from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import Cancelled, MismatchError, StoreError
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.parallel import Executor
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render
from grasp_core.simulation.physics import load_physics
from grasp_core.simulation.trial import child_seed

HERE = Executor(workers=0)
RECIPE = Recipe(name="hand")


def attempt(grasp: Grasp, seed: int, outcome: str, dynamic: bool, scene: int) -> AttemptRow:
    """An attempt whose fingers went 1 mm farther in each later scene."""
    travel = [round(0.0201 + 0.001 * scene, 4), 0.0213]
    evidence = msgspec.json.encode({"words": "held", "travel": travel, "lift": 0.3, "clearance": 0.2987}).decode()
    comfort = (0.00123, 0.0456) if outcome == "SUCCESS" else None
    row = AttemptRow(outcome, seed, (0, 0, 0, 0), dynamic, comfort=comfort, evidence=evidence if dynamic else None)
    return msgspec.structs.replace(row, executed=executed_pose(grasp, row, RECIPE.noise))


def scene_of(asset, pose, seed: int) -> SceneRecord:
    scene = Scene.single(asset, place(pose.matrix, 0.0, 0.0, 0.3 * seed))
    grasps = [Grasp((0.01 * number, 0.0, 0.02), 0.2 * number, 0.1) for number in range(3)]
    attempts = []
    for number, grasp in enumerate(grasps):
        seeds = [child_seed(child_seed(seed, number), k) for k in range(2)]
        kinds = [("SUCCESS", True), ("SLIPPED", True), ("COLLISION", False)]
        attempts.append([attempt(grasp, own, *kinds[(number + k) % 3], seed) for k, own in enumerate(seeds)])
    return SceneRecord(f"{asset.name}-0", asset.name, 0, seed, scene, render(scene), grasps, attempts)


@pytest.fixture
def made(tmp_path, make_box, at_rest):
    """The original dataset's labels digest, and its archive."""
    boxes = [("train", "box_000"), ("test", "box_001"), ("train", "box_002")]
    physics = load_physics()
    with DatasetStore.create(
        tmp_path / "made", name="hand", gripper=load_gripper(), physics=physics, recipe=RECIPE
    ) as store:
        for seed, (split, name) in enumerate(boxes):
            asset = make_box(name, (0.06, 0.04 + 0.002 * seed, 0.05))
            pose = at_rest(asset)
            store.add_object(asset, split, [pose])
            store.add_scene(scene_of(asset, pose, seed))
        store.refuse("sheet_000", "has no volume")
        write_archive(store, tmp_path / "hand.npz.xz")
        return store.labels_digest(), read_archive(tmp_path / "hand.npz.xz")


def test_labels_come_back_and_numbers_to_a_step(made, tmp_path):
    digest, archive = made
    calls = []
    with restore(archive, tmp_path / "r", executor=HERE, progress=lambda *call: calls.append(call)) as store:
        assert store.labels_digest() == digest
        assert calls == [(0, 3), (1, 3), (2, 3), (3, 3)]
        assert store.refused() == {"sheet_000": "has no volume"}
        assert {row.name: row.split for row in store.objects()}["box_001"] == "test"
        rows = store.attempts(int(store.grasps(store.scene_id("box_001-0")).id[0]))
        assert [row.outcome for row in rows] == ["SUCCESS", "SLIPPED"]
        assert rows[0].seed == child_seed(child_seed(1, 0), 0)
        assert rows[0].comfort == pytest.approx((0.00123, 0.0456), abs=STEPS["comfort_rad"] / 2)
        assert abs(rows[0].comfort[0] - 0.00123) <= STEPS["comfort_m"] / 2
        evidence = msgspec.json.decode(rows[0].evidence)
        assert "restored" in evidence["words"]
        assert evidence["travel"] == pytest.approx([0.0211, 0.0213], abs=1e-9)
        assert evidence["clearance"] == pytest.approx(0.2987) and "time" not in evidence
        assert rows[1].comfort is None
        collided = store.attempts(int(store.grasps(store.scene_id("box_001-0")).id[2]))[0]
        assert collided.outcome == "COLLISION" and collided.evidence is None


def test_images_are_rendered_with_the_scenes_own_object(made, tmp_path):
    _, archive = made
    with restore(archive, tmp_path / "r", executor=HERE) as store:
        for row in store.scenes():
            seen, fresh = store.depth(row.id), render(store.scene(row.id))
            assert np.abs(seen.depth - fresh.depth).max() <= 1.01e-4
        assert len({store.depth(row.id).depth.tobytes() for row in store.scenes()}) == 3


def test_cancelled_it_goes_on_where_it_was(made, tmp_path):
    digest, archive = made
    done = []
    with pytest.raises(Cancelled):
        restore(
            archive,
            tmp_path / "r",
            executor=HERE,
            progress=lambda *call: done.append(call),
            cancelled=lambda: len(done) > 1,
        )
    assert done[-1][0] < 3
    again = []
    with restore(archive, tmp_path / "r", executor=HERE, progress=lambda *call: again.append(call)) as store:
        assert store.labels_digest() == digest
    assert again[0] == done[-1] and again[-1] == (3, 3)


def test_only_some_scenes_and_their_objects(made, tmp_path):
    _, archive = made
    with restore(archive, tmp_path / "r", only=["box_002-0"], executor=HERE) as store:
        assert [row.name for row in store.scenes()] == ["box_002-0"]
        assert [row.name for row in store.objects()] == ["box_002"]
        # its rows are its own, not those of the first scene
        assert store.attempts(int(store.grasps(store.scene_id("box_002-0")).id[0]))[0].seed == child_seed(
            child_seed(2, 0), 0
        )


def test_labels_that_came_out_otherwise_are_reported(made, tmp_path):
    _, archive = made
    columns = dict(archive.columns)
    columns["outcome"] = columns["outcome"].copy()
    columns["outcome"][-1] = archives.OUTCOMES.index("MISSED")
    with pytest.raises(StoreError, match="differ from the archive's"):
        restore(Archive(archive.head, columns), tmp_path / "r", executor=HERE)


def test_another_physics_dataset_in_the_folder_is_refused(made, tmp_path):
    _, archive = made
    physics = msgspec.structs.replace(load_physics(), friction=0.31)
    DatasetStore.create(tmp_path / "r", name="o", gripper=load_gripper(), physics=physics, recipe=RECIPE).close()
    with pytest.raises(MismatchError, match="friction differ"):
        restore(archive, tmp_path / "r", executor=HERE)
