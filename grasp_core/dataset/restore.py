"""From an archive back to a dataset: images are rendered anew, labels come as they were, no physics is run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.dataset.archive import ABSENT, OUTCOMES, STEPS, Archive, SceneHead, executed_pose, unpack_objects
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.database import FILE
from grasp_core.dataset.recipe import Recipe
from grasp_core.dataset.rows import AttemptRow, camera_from_json
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.parallel import Executor, map_scenes
from grasp_core.scene import Scene
from grasp_core.sensing.renderer import render
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.trial import GraspNoise, child_seed

_WORDS = "restored from an archive; run the attempt again for all of its evidence"


@dataclass(frozen=True)
class _RestoreItem:
    head: SceneHead
    asset: ObjectAsset
    camera: str
    noise: GraspNoise
    columns: dict[str, NDArray]


def _restore_scene(item: _RestoreItem) -> SceneRecord:
    head, columns = item.head, item.columns
    scene = Scene.single(item.asset, np.array(head.world_from_object).reshape(4, 4), camera_from_json(item.camera))
    grasps, attempts = [], []
    row = dynamic = 0
    for number in range(head.grasps):
        x, y, z, angle, width = (float(columns[name][number]) for name in ("x", "y", "z", "angle", "width"))
        grasp = Grasp((x, y, z), angle, width)
        trial = child_seed(head.seed, number)
        rows = []
        for k in range(int(columns["count"][number])):
            made = AttemptRow(
                OUTCOMES[columns["outcome"][row]],
                child_seed(trial, k),
                (0.0, 0.0, 0.0, 0.0),
                bool(columns["dynamic"][row]),
                int(columns["redraws"][row]),
            )
            numbers: dict[str, float | None] = {}
            if made.dynamic:
                numbers = {name: _restored(columns[name][dynamic], step) for name, step in STEPS.items()}
                dynamic += 1
            rows.append(_with_numbers(made, executed_pose(grasp, made, item.noise), numbers))
            row += 1
        grasps.append(grasp)
        attempts.append(rows)
    return SceneRecord(head.name, head.object, head.pose, head.seed, scene, render(scene), grasps, attempts)


def _restored(value: np.uint16, step: float) -> float | None:
    return None if value == ABSENT else round(float(value) * step, 6)


def _with_numbers(
    row: AttemptRow, executed: tuple[float, float, float, float], numbers: dict[str, float | None]
) -> AttemptRow:
    if not numbers:
        return msgspec.structs.replace(row, executed=executed)
    distance, rotation = numbers["comfort_m"], numbers["comfort_rad"]
    evidence: dict[str, Any] = {"words": _WORDS, "travel": [numbers["left"], numbers["right"]]}
    evidence |= {name: numbers[name] for name in ("lift", "time", "clearance") if numbers[name] is not None}
    return msgspec.structs.replace(
        row,
        executed=executed,
        comfort=None if distance is None or rotation is None else (distance, rotation),
        evidence=msgspec.json.encode(evidence).decode(),
    )


def restore(
    archive: Archive,
    path: str | Path,
    *,
    only: Sequence[str] | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> DatasetStore:
    """Rebuild a dataset without a physics step; interrupted, it goes on where it was.

    Args:
        archive: what `read_archive` returned.
        path: folder of the dataset.
        only: names of the scenes to rebuild, None for all.
        executor: where images are rendered.
        progress: called with (done, total) scenes.
        cancelled: asked a few times a second; true ends it.

    Returns:
        The open dataset.

    Raises:
        StoreError: the folder holds another dataset, or cannot be written, or labels came out otherwise.
        Cancelled: `cancelled` said so.
    """
    head = archive.head
    folder = Path(path).expanduser()
    gripper = config.convert(head.gripper, Gripper, "archive")
    physics = config.convert(head.physics, Physics, "archive")
    recipe = config.convert(head.recipe, Recipe, "archive")
    if (folder / FILE).exists():
        store = DatasetStore.open(folder)
        store.check(gripper=gripper, physics=physics)
    else:
        store = DatasetStore.create(folder, name=head.name, gripper=gripper, physics=physics, recipe=recipe)
    try:
        _restore_into(store, archive, recipe, only, executor, progress, cancelled)
    except BaseException:
        store.close()
        raise
    return store


def _restore_into(
    store: DatasetStore,
    archive: Archive,
    recipe: Recipe,
    only: Sequence[str] | None,
    executor: Executor | None,
    progress: Callable[[int, int], None] | None,
    cancelled: Callable[[], bool] | None,
) -> None:
    head = archive.head
    wanted = {scene.name for scene in head.scenes} if only is None else set(only)
    needed = {scene.object for scene in head.scenes if scene.name in wanted}
    assets: dict[str, ObjectAsset] = {}
    for asset, item in unpack_objects(archive):
        if item.name in needed:
            assets[item.name] = asset
            store.add_object(asset, item.split, item.poses)
    for name, reason in head.refused.items():
        store.refuse(name, reason)
    there = {row.name for row in store.scenes()}
    items = _scene_items(archive, assets, recipe.noise, wanted - there)
    done = len(wanted & there)
    if progress:
        progress(done, len(wanted))
    for _, record in map_scenes(_restore_scene, items, executor, cancelled=cancelled):
        store.add_scene(record)
        done += 1
        if progress:
            progress(done, len(wanted))
    if only is None and store.labels_digest() != head.labels:
        raise StoreError(f"{store.path}: the restored labels differ from the archive's; report this as a bug")


def _scene_items(
    archive: Archive, assets: dict[str, ObjectAsset], noise: GraspNoise, wanted: set[str]
) -> list[_RestoreItem]:
    columns = archive.columns
    per_grasp, per_attempt = ("x", "y", "z", "angle", "width", "count"), ("outcome", "dynamic", "redraws")
    grasp = attempt = dynamic = 0
    items = []
    for head in archive.head.scenes:
        grasps, attempts = slice(grasp, grasp + head.grasps), slice(attempt, attempt + head.attempts)
        moved = dynamic + int(columns["dynamic"][attempts].sum())
        if head.name in wanted:
            own = {name: columns[name][grasps] for name in per_grasp}
            own |= {name: columns[name][attempts] for name in per_attempt}
            own |= {name: columns[name][dynamic:moved] for name in STEPS}
            items.append(_RestoreItem(head, assets[head.object], archive.head.cameras[head.camera], noise, own))
        grasp, attempt, dynamic = grasps.stop, attempts.stop, moved
    return items
