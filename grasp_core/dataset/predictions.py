"""Scores of networks on the grasps of a dataset, kept per weights digest, made scene by scene and resumed at will."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
import numpy as np

from grasp_core.camera import CANONICAL_HEIGHT, DepthImage
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import Cancelled
from grasp_core.networks.inputs import regression_input
from grasp_core.networks.runtime import Runtime
from grasp_core.planning.crops import crops, grasp_pixels, sample
from grasp_core.sensing.rectify import rectify


class Scored(msgspec.Struct, frozen=True):
    """What a run of `score_dataset` did: scenes that it scored, and those that were scored before."""

    scenes: int
    before: int


def unscored_scenes(store: DatasetStore, digest: str) -> list[int]:
    """Ids of the scenes with at least one grasp that the weights of this digest have no score for."""
    found = store.rows(
        """SELECT DISTINCT scene FROM samples WHERE NOT EXISTS (SELECT 1 FROM predictions AS p JOIN weights
           ON weights.id = p.weights WHERE digest = ? AND p.grasp = samples.grasp) ORDER BY scene""",
        (digest,),
    )
    return [int(row["scene"]) for row in found]


def score_dataset(
    store: DatasetStore,
    runtime: Runtime,
    *,
    progress: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Scored:
    """Score every grasp that has no score of these weights yet, and let lists show the scores of these weights.

    Both networks see the clean image; scenes are stored one by one, so that a cancelled run goes on where it stopped.

    Args:
        store: the dataset, open for writing.
        runtime: both networks.
        progress: called with (done, total) scenes, those done before included.
        cancelled: asked before each scene.

    Raises:
        MismatchError: the weights are for another gripper.
        Cancelled: `cancelled` said so; finished scenes are kept.
    """
    gripper = store.gripper()
    runtime.meta.check(gripper)
    missing = unscored_scenes(store, runtime.digest)
    total = store.rows("SELECT count(*) FROM scenes")[0][0]
    for index, scene in enumerate(missing):
        if cancelled is not None and cancelled():
            raise Cancelled("cancelled; the scenes that were scored are kept")
        score_scene(store, scene, runtime, gripper.opening)
        if progress is not None:
            progress(total - len(missing) + index + 1, total)
    if store.row("SELECT 1 FROM weights WHERE digest = ?", (runtime.digest,)) and store.meta.weights != runtime.digest:
        store.use_weights(runtime.digest)
    return Scored(len(missing), total - len(missing))


def score_scene(store: DatasetStore, scene_id: int, runtime: Runtime, opening: float) -> None:
    """Score all grasps of one scene and keep the scores.

    Args:
        store: the dataset.
        scene_id: of the scene.
        runtime: both networks.
        opening: of the gripper, metres.
    """
    table = store.grasps(scene_id)
    canvas = canonical(store.depth(scene_id))
    u, v, angles, depths = grasp_pixels(canvas.depth, canvas.camera, table.position, table.angle)
    heats = sample(runtime.quality_map(regression_input(canvas.depth)[None])[0], u, v)
    scores = runtime.scores(crops(canvas.depth, canvas.camera, u, v, angles, depths, runtime.meta.crop, opening))
    store.add_predictions(runtime.digest, runtime.meta.name, table.id, scores, heats)


def canonical(image: DepthImage) -> DepthImage:
    """The canonical view of a stored image: itself where its camera is canonical, else its rectification."""
    pose = image.camera.pose
    down = np.allclose(pose[:3, 2], [0, 0, -1], atol=1e-6) and abs(pose[2, 3] - CANONICAL_HEIGHT) < 1e-6
    return image if down and image.valid.all() else rectify(image).image
