"""Training the Regression Network: mean squared error against drawn grasp rectangles (paper section V.B)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.errors import ConfigError
from grasp_core.networks.inputs import regression_input
from grasp_core.networks.regression import RegressionNetwork
from grasp_core.training.augment import Augmentation, corrupt, move_image
from grasp_core.training.loop import Batch, Fit, Schedule, ahead, fit, half_precision, pick_device
from grasp_core.training.metrics import best_pixel, regression_hit
from grasp_core.training.scenes import TrainingScene, Views, one_view_each
from grasp_core.training.targets import Overlap, Rectangle, draw_target


class RegressionSettings(config.Settings):
    """How the Regression Network is trained.

    Attributes:
        rectangle: how the paper's rectangle is read.
        overlap: what counts where rectangles overlap.
        least: only labels greater than this are drawn; the mean of overlaps takes all.
        blur: of the drawn map, standard deviation in pixels, so that its best pixel is not anywhere on a plateau.
        colliding: whether grasps of which every attempt collided are drawn, with the mean of overlaps; planning drops
            such grasps by geometry before it scores any.
        schedule: how long and how fast.
        augmentation: of whole images.
        views: further renderings of each scene.
    """

    schedule: Schedule
    rectangle: Rectangle = "third_along"
    overlap: Overlap = "larger"
    least: float = 0.6
    blur: float = 0.0
    colliding: bool = True
    augmentation: Augmentation = Augmentation()
    views: Views = Views()

    def __post_init__(self) -> None:
        if not 0 <= self.least < 1 or self.blur < 0:
            raise ValueError(f"least is a label in [0, 1) and blur at least 0 px, not {self.least} and {self.blur}")


def scene_target(scene: TrainingScene, settings: RegressionSettings, opening: float) -> NDArray[np.float32]:
    """The map (H, W) that the Regression Network shall give on a scene where it stands."""
    dropped = scene.colliding & (not settings.colliding)
    return draw_target(
        scene.units.shape,  # type: ignore[arg-type]
        scene.pixels,
        scene.angles,
        scene.openings(opening),
        np.where(dropped, np.float32(np.nan), scene.labels),
        rectangle=settings.rectangle,
        least=settings.least,
        overlap=settings.overlap,
        blur=settings.blur,
    )


def example(
    scene: TrainingScene, target: NDArray[np.float32], augmentation: Augmentation, rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Heights and target (H, W) of a scene, turned and moved together, freshly corrupted.

    Args:
        scene: the scene.
        target: of the scene where it stands.
        augmentation: what changes.
        rng: what is random comes from here.
    """
    moved = move_image(scene, scene.depth, augmentation, rng)
    image = corrupt(DepthImage(moved.depth, scene.camera, np.ones(moved.depth.shape, np.bool_)), augmentation, rng)
    return regression_input(image.depth), np.asarray(cv2.warpAffine(target, moved.matrix, target.shape[::-1]))


class RegressionTask:
    """The Regression Network, its scenes and its loss; see `loop.Task`.

    Args:
        training: scenes to learn from.
        validation: scenes of other objects.
        settings: see `RegressionSettings`.
        opening: of the gripper, metres.
        device: where to compute.
    """

    name = "regression"
    measure = "skill"

    def __init__(
        self,
        training: Sequence[TrainingScene],
        validation: Sequence[TrainingScene],
        settings: RegressionSettings,
        opening: float,
        device: torch.device,
    ) -> None:
        if not any(len(scene.perfect) for scene in validation):
            raise ConfigError("no validation scene has a grasp of quality 1; generate more data")
        torch.manual_seed(settings.schedule.seed)
        self.network = RegressionNetwork().to(device)
        self.network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self._training = training
        graspable = [scene for scene in validation if len(scene.perfect)]
        chosen = one_view_each(graspable, np.random.default_rng([settings.schedule.seed, 2]))
        self._validation = [graspable[index] for index in chosen]
        self._settings = settings
        self._opening = opening
        self._targets: dict[str, NDArray[np.float16]] = {}
        self._device = device
        self._half = half_precision(device)

    def batches(self, rng: np.random.Generator) -> Iterator[tuple[float, Batch]]:
        """Scenes in random order, each in one of its views, drawn in the background."""
        return ahead(self._draw(rng))

    def _draw(self, rng: np.random.Generator) -> Iterator[tuple[float, Batch]]:
        order = one_view_each(self._training, rng)
        count = max(1, round(len(order) / self._settings.schedule.batch))
        for step, part in enumerate(np.array_split(order, count)):
            scenes = (self._training[index] for index in part)
            pairs = [example(scene, self._target(scene), self._settings.augmentation, rng) for scene in scenes]
            if pairs:
                arrays = (np.stack(images)[:, None] for images in zip(*pairs, strict=True))
                yield (step + 1) / count, tuple(map(torch.from_numpy, arrays))

    def _target(self, scene: TrainingScene) -> NDArray[np.float32]:
        """The target of a scene where it stands, drawn once; drawing hundreds of rectangles takes long."""
        if scene.name not in self._targets:
            self._targets[scene.name] = scene_target(scene, self._settings, self._opening).astype(np.float16)
        return self._targets[scene.name].astype(np.float32)

    def _maps(self, heights: Tensor) -> Tensor:
        moved = heights.to(self._device, memory_format=torch.channels_last)
        with torch.autocast(self._device.type, torch.bfloat16, enabled=self._half):
            maps: Tensor = self.network(moved)
        return maps.float()

    def loss(self, batch: Batch) -> Tensor:
        """Mean squared error."""
        heights, target = batch
        return functional.mse_loss(self._maps(heights), target.to(self._device))

    def measures(self, scenes: Sequence[TrainingScene]) -> dict[str, float]:
        """Measures over scenes that have a grasp of quality 1, each seen with its own fixed noise.

        `hit` is the paper's. It soon saturates, so `skill` (1 less the squared error over that of an empty map) chooses
        the epoch; `region`, the mean label of the grasps within that radius of the best pixel that do not always
        collide, compares settings: it is what planning meets there.
        """
        self.network.eval()
        seeds = np.random.SeedSequence([self._settings.schedule.seed, 1]).spawn(len(scenes))
        hits, regions, errors, powers = [], [], [], []
        with torch.inference_mode():
            for scene, seed in zip(scenes, seeds, strict=True):
                clean = DepthImage(scene.depth, scene.camera, np.ones(scene.units.shape, np.bool_))
                image = corrupt(clean, self._settings.augmentation, np.random.default_rng(seed))
                heights, target = regression_input(image.depth), self._target(scene)
                quality = self._maps(torch.from_numpy(heights)[None, None])[0, 0].cpu().numpy()
                radius = scene.camera.intrinsics.fx * self._opening / 3 / float(scene.camera.pose[2, 3])
                hits.append(regression_hit(quality, scene.perfect, radius))
                near = (np.hypot(*(scene.pixels - best_pixel(quality)).T) <= radius) & ~scene.colliding
                regions.append(float(scene.labels[near].mean()) if near.any() else 0.0)
                errors.append(float(np.mean((quality - target) ** 2)))
                powers.append(float(np.mean(target**2)))
        error = float(np.mean(errors))
        return {
            "hit": float(np.mean(hits)),
            "region": float(np.mean(regions)),
            "mse": error,
            "skill": 1 - error / float(np.mean(powers)),
        }

    def validate(self) -> dict[str, float]:
        """The measures on one view of every graspable scene of validation objects."""
        return self.measures(self._validation)


def train_regression(
    training: Sequence[TrainingScene],
    validation: Sequence[TrainingScene],
    settings: RegressionSettings,
    opening: float,
    folder: Path,
    *,
    about: str = "",
    progress: bool = True,
) -> tuple[RegressionTask, Fit]:
    """Train the Regression Network in a run folder; the task holds the best epoch's network.

    Raises:
        ConfigError: see `loop.fit`; no scene with a grasp of quality 1 to validate on.
    """
    task = RegressionTask(training, validation, settings, opening, pick_device())
    return task, fit(task, settings.schedule, folder, about=about, progress=progress)
