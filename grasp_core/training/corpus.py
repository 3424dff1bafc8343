"""Scenes for training out of a dataset: its three splits by object, with what the weights must remember of it."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from tqdm import tqdm

from grasp_core.dataset.rows import SPLITS, GraspTable, Split
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError
from grasp_core.gripper import Gripper
from grasp_core.training.scenes import GraspLabels, TrainingScene, Views, more_views, training_scene

Labels = Literal["curated", "dart"]
"""`curated`: people's decisions before attempts, the design's rule; `dart`: attempts alone."""


@dataclass(frozen=True)
class Corpus:
    """The scenes of a dataset in memory, further views included.

    Attributes:
        train: to learn from.
        validation: of other objects: chooses epochs and temperature.
        test: of yet other objects: only reported.
        gripper: whose grasps were tried.
        physics: digest of the physics that judged them.
        recipe: name and numbers of the data, for the metadata of weights.
        digest: of every image and label.
    """

    train: tuple[TrainingScene, ...]
    validation: tuple[TrainingScene, ...]
    test: tuple[TrainingScene, ...]
    gripper: Gripper
    physics: str
    recipe: dict[str, str | int | float]
    digest: str


def grasp_labels(table: GraspTable, labels: Labels = "curated") -> GraspLabels:
    """The stored grasps of a scene as labels; those that training leaves out keep NaN."""
    collided = (table.attempts > 0) & (table.collisions == table.attempts)
    if labels == "dart":
        return GraspLabels(table.position, table.angle, table.quality, collided)
    return GraspLabels(table.position, table.angle, table.label, collided & ~table.human)


def load_corpus(
    path: str | Path, views: Views, *, labels: Labels = "curated", seed: int = 0, progress: bool = True
) -> Corpus:
    """Read a dataset and render further views of its scenes.

    Args:
        path: of the dataset.
        views: further views of each scene, in every split: planning meets objects anywhere, under any camera.
        labels: which ones.
        seed: of those views.
        progress: show a progress bar.

    Raises:
        StoreError: no such dataset, or it has no training or no validation scene.
        MismatchError: its scenes are no canonical views.
    """
    found: dict[Split, list[TrainingScene]] = {split: [] for split in SPLITS}
    with DatasetStore.open(path, readonly=True) as store:
        meta = store.meta
        rows = store.scenes()
        for index, row in enumerate(tqdm(rows, desc="scenes", unit="scene", disable=not progress)):
            grasps = grasp_labels(store.grasps(row.id), labels)
            found[row.split].append(training_scene(row.name, row.object, store.depth(row.id), grasps))
            if views.count:
                rng = np.random.default_rng(np.random.SeedSequence([seed, index]))
                found[row.split].extend(more_views(row.name, row.object, store.scene(row.id), grasps, views, rng))
        gripper = store.gripper()
    for split in ("train", "validation"):
        if not found[split]:
            raise StoreError(f"{path}: has no scene in its {split} split; generate more objects or another recipe")
    recipe: dict[str, str | int | float] = {
        "dataset": meta.name,
        "recipe": meta.recipe_digest,
        "labels": labels,
        "objects": len({scene.object for scene in found["train"]}),
        "scenes": len({scene.stored for scene in found["train"]}),
        "images": len(found["train"]),
        "grasps": sum(len(scene.labels) for scene in found["train"]),
    }
    everything = [scene for split in SPLITS for scene in found[split]]
    return Corpus(
        tuple(found["train"]),
        tuple(found["validation"]),
        tuple(found["test"]),
        gripper,
        meta.physics_digest,
        recipe,
        digest_of(everything),
    )


def digest_of(scenes: Sequence[TrainingScene]) -> str:
    """A hash of images and labelled grasps, in their order."""
    h = hashlib.sha256()
    for scene in scenes:
        h.update(scene.name.encode())
        for array in (scene.units, scene.pixels, scene.angles, scene.depths, scene.labels):
            h.update(np.ascontiguousarray(array).tobytes())
    return h.hexdigest()[:12]
