import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from grasp_core.config import Settings
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.rows import AttemptRow, StoredPose
from grasp_core.dataset.store import DatasetStore
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render


class ToyPhysics(Settings):
    friction: float = 0.6


class ToyRecipe(Settings):
    seed: int = 0


def bar(name: str, width: float) -> ObjectAsset:
    mesh = trimesh.creation.box((0.14, width, 0.04))
    part = Part(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))
    volume, inertia = float(mesh.volume), np.array(mesh.moment_inertia)
    return ObjectAsset(name, "bar", part.vertices, part.faces, (part,), volume, inertia)


def bar_record(asset: ObjectAsset, pose: np.ndarray, number: int, grasps: int) -> SceneRecord:
    """Grasps around a turned bar; those across it and over its middle succeed in every attempt."""
    rng = np.random.default_rng(number)
    yaw = rng.uniform(-math.pi, math.pi)
    scene = Scene.single(asset, place(pose, 0.0, 0.0, yaw))
    c, s = math.cos(yaw), math.sin(yaw)
    made, attempts = [], []
    for _ in range(grasps):
        along, across = rng.uniform(-0.09, 0.09), rng.uniform(-0.06, 0.06)
        off = rng.uniform(-math.pi / 2, math.pi / 2) * (rng.random() < 0.7)
        good = abs(along) < 0.06 and abs(across) < 0.02 and abs(off) < 0.4
        outcome = "SUCCESS" if good else "COLLISION" if abs(across) < 0.04 else "MISSED"
        position = (c * along - s * across, s * along + c * across, 0.010)
        grasp = Grasp(position, yaw + math.pi / 2 + off, 0.10)
        made.append(grasp)
        attempts.append([AttemptRow(outcome, k, (*position, grasp.angle)) for k in range(5)])
    return SceneRecord(f"{asset.name}-{number}", asset.name, 0, number, scene, render(scene), made, attempts)


@pytest.fixture
def labelled_dataset(tmp_path: Path) -> Callable[..., Path]:
    """Makes a small dataset of bars on the table, labelled by a simple rule, and gives its folder."""

    def make(train: int = 4, validation: int = 1, test: int = 1, grasps: int = 60) -> Path:
        folder = tmp_path / "bars"
        with DatasetStore.create(
            folder, name="bars", gripper=load_gripper(), physics=ToyPhysics(), recipe=ToyRecipe()
        ) as store:
            number = 0
            for split, count in (("train", train), ("validation", validation), ("test", test)):
                for _ in range(count):
                    asset = bar(f"bar_{number:03d}", 0.03 + 0.005 * (number % 4))
                    pose = np.eye(4)
                    pose[2, 3] = 0.02
                    store.add_object(asset, split, [StoredPose(tuple(pose.reshape(-1).tolist()), 1.0)])  # type: ignore[arg-type]
                    store.add_scene(bar_record(asset, pose, number, grasps))
                    number += 1
        return folder

    return make
