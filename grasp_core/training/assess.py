"""What weights are worth on a dataset: the measures of both networks in total and per object, run as in planning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.networks.inputs import regression_input
from grasp_core.networks.runtime import Runtime
from grasp_core.planning.crops import crops
from grasp_core.training.augment import Augmentation, corrupt
from grasp_core.training.metrics import classification, regression_hit
from grasp_core.training.scenes import TrainingScene


@dataclass(frozen=True)
class Assessment:
    """Both networks on some scenes.

    Attributes:
        scores: (N,) of every grasp.
        labels: (N,).
        objects: (N,) names.
        maps: quality map of each scene, (H, W) each.
        scenes: object of each scene.
        hits: scene's index → whether its best pixel is near a grasp of quality 1, for scenes that have one.
    """

    scores: NDArray[np.float32]
    labels: NDArray[np.float32]
    objects: NDArray[np.str_]
    maps: tuple[NDArray[np.float32], ...]
    scenes: tuple[str, ...]
    hits: dict[int, bool]

    @property
    def totals(self) -> dict[str, float]:
        """Measures over everything; `hit` is NaN without a scene that has a grasp of quality 1."""
        hit = float(np.mean(list(self.hits.values()))) if self.hits else float("nan")
        return {"grasps": float(len(self.labels)), **classification(self.scores, self.labels), "hit": hit}

    def by_object(self) -> dict[str, dict[str, float]]:
        """Object → its measures; AP and AUC are NaN where all its grasps are of one class.

        `hit` is the share of its scenes where the best pixel is near a grasp of quality 1, NaN where none has one.
        """
        found = {}
        for name in np.unique(self.objects):
            own = self.objects == name
            positives = float(np.mean(self.labels[own] > 0.5))
            hits = [hit for index, hit in self.hits.items() if self.scenes[index] == name]
            found[str(name)] = {
                "positives": positives,
                **classification(self.scores[own], self.labels[own]),
                "hit": float(np.mean(hits)) if hits else float("nan"),
            }
        return found


def assess(
    runtime: Runtime,
    scenes: Sequence[TrainingScene],
    opening: float,
    *,
    augmentation: Augmentation | None = None,
    seed: int = 0,
) -> Assessment:
    """Run both networks over every grasp of some scenes, each image with noise of its own.

    Args:
        runtime: both networks.
        scenes: at least one.
        opening: of the gripper, metres.
        augmentation: whose noise, holes and table errors are used; the default ones when None.
        seed: of the noise.
    """
    augmentation = augmentation or Augmentation()
    scores, maps, hits = [], [], {}
    for index, scene in enumerate(scenes):
        rng = np.random.default_rng(np.random.SeedSequence([seed, index]))
        clean = DepthImage(scene.depth, scene.camera, np.ones(scene.units.shape, np.bool_))
        depth = corrupt(clean, augmentation, rng).depth
        maps.append(runtime.quality_map(regression_input(depth)[None])[0])
        u, v = scene.pixels.T
        cut = crops(depth, scene.camera, u, v, scene.angles, scene.depths, runtime.meta.crop, opening)
        scores.append(runtime.scores(cut))
        if len(scene.perfect):
            radius = scene.camera.intrinsics.fx * opening / 3 / float(scene.camera.pose[2, 3])
            hits[index] = regression_hit(maps[-1], scene.perfect, radius)
    return Assessment(
        scores=np.concatenate(scores),
        labels=np.concatenate([scene.labels for scene in scenes]),
        objects=np.concatenate([np.full(len(scene.labels), scene.object) for scene in scenes]),
        maps=tuple(maps),
        scenes=tuple(scene.object for scene in scenes),
        hits=hits,
    )
