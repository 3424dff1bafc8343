from pathlib import Path

import numpy as np
import pytest
import trimesh

from grasp_core.camera import DepthImage, canonical_camera
from grasp_core.config import Settings
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.rows import AttemptRow, StoredPose
from grasp_core.dataset.store import DatasetStore
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import Scene, place


class FakePhysics(Settings):
    friction: float = 0.6


class FakeRecipe(Settings):
    seed: int = 0


def box_asset(name="box_000", size=(0.06, 0.04, 0.05)) -> ObjectAsset:
    mesh = trimesh.creation.box(size)
    part = Part(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))
    return ObjectAsset(
        name,
        "box",
        part.vertices,
        part.faces,
        (part,),
        float(mesh.volume),
        np.array(mesh.moment_inertia),
        source="test",
    )


def resting(asset: ObjectAsset) -> StoredPose:
    pose = np.eye(4)
    pose[2, 3] = -asset.vertices[:, 2].min()
    return StoredPose(tuple(pose.reshape(-1).tolist()), 1.0)


def record(asset: ObjectAsset, name="box_000-0", grasps=4, seed=0) -> SceneRecord:
    rng = np.random.default_rng(seed)
    pose = resting(asset).matrix
    depth = np.full((300, 300), 0.7, np.float32)
    depth[100:200, 120:180] = 0.65
    depth[0, 0] = np.nan
    outcomes = ["SUCCESS", "SLIPPED", "MISSED", "COLLISION"]
    made = [Grasp((0.01 * i, 0.0, 0.02), 0.1 * i, 0.1) for i in range(grasps)]
    attempts = [
        [
            AttemptRow(
                "SUCCESS" if k < 5 - i else outcomes[i % 4],
                int(rng.integers(2**62)),
                (*grasp.position, grasp.angle),
                dynamic=k % 2 == 0,
                comfort=(0.001, 0.02) if k == 0 else None,
                evidence='{"clear":true}' if k == 0 else None,
            )
            for k in range(5)
        ]
        for i, grasp in enumerate(made)
    ]
    camera = canonical_camera()
    return SceneRecord(
        name,
        asset.name,
        0,
        seed,
        Scene.single(asset, place(pose, 0.0, 0.0, 0.3), camera),
        DepthImage.from_array(depth, camera),
        made,
        attempts,
    )


def new_store(path: Path) -> DatasetStore:
    return DatasetStore.create(path, name="t", gripper=load_gripper(), physics=FakePhysics(), recipe=FakeRecipe())


@pytest.fixture
def asset() -> ObjectAsset:
    return box_asset()


@pytest.fixture
def store(tmp_path, asset):
    with new_store(tmp_path / "data") as made:
        made.add_object(asset, "train", [resting(asset)])
        made.add_scene(record(asset))
        yield made


@pytest.fixture
def make_box():
    return box_asset


@pytest.fixture
def make_record():
    return record


@pytest.fixture
def make_store():
    return new_store


@pytest.fixture
def at_rest():
    return resting
