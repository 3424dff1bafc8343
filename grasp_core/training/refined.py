"""Training the Refined Network: P(success) of a depth crop around a grasp (paper section V.C).

The loss is cross-entropy weighted label : 1 − label, which equals the paper's 5q and 5(1 − q) copies of a crop in the
two classes (Eq. 7). Grasps whose every attempt collided are three quarters of a grid and teach little: each epoch uses
a random part of them, weighted up by as much. Crops come from the same function as in planning.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import msgspec
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.errors import ConfigError
from grasp_core.networks.refined import RefinedNetwork
from grasp_core.networks.weights import CropSpec
from grasp_core.planning.crops import crops, deepen
from grasp_core.training.augment import Augmentation, corrupt, mirror_crops
from grasp_core.training.calibration import fit_temperature, fold_temperature
from grasp_core.training.loop import Batch, Fit, Schedule, ahead, fit, half_precision, pick_device
from grasp_core.training.metrics import classification
from grasp_core.training.scenes import TrainingScene, Views, one_view_each

_BARE_HEIGHT = 0.004
"""Metres above the table up to which a pixel counts as bare: half the height of the finger tips."""


class RefinedSettings(config.Settings):
    """How the Refined Network is trained.

    Attributes:
        width: channels of the first stage; 64 is ResNet18.
        crop: size and context of the crops.
        colliding: share of the always-colliding grasps that an epoch uses.
        bare: grasps on bare table added to every image of an epoch; they close on nothing, so their label is 0.
        pool: scenes whose crops are mixed into batches together.
        schedule: how long and how fast.
        augmentation: of scenes and crops.
        views: further renderings of each scene.
    """

    schedule: Schedule
    width: int = 16
    crop: CropSpec = CropSpec()
    colliding: float = 0.3
    bare: int = 8
    pool: int = 48
    augmentation: Augmentation = Augmentation()
    views: Views = Views()

    def __post_init__(self) -> None:
        if self.width < 1 or self.pool < 1 or self.bare < 0 or not 0 < self.colliding <= 1:
            raise ValueError("width and pool are at least 1, bare at least 0, colliding is a share above 0")


@dataclass(frozen=True)
class Samples:
    """Crops (N, S, S), their labels (N,), loss weights (N,) and scenes (N,) as indices."""

    crops: NDArray[np.float32]
    labels: NDArray[np.float32]
    weights: NDArray[np.float32]
    scene: NDArray[np.int64]


def soft_cross_entropy(logits: Tensor, labels: Tensor, weights: Tensor) -> Tensor:
    """Eq. 7 as weights: label · CE(class 1) + (1 − label) · CE(class 0), averaged with `weights`."""
    logs = functional.log_softmax(logits.float(), 1)
    losses = -(labels * logs[:, 1] + (1 - labels) * logs[:, 0])
    return (losses * weights).sum() / weights.sum()


def scene_samples(
    scene: TrainingScene,
    settings: RefinedSettings,
    opening: float,
    rng: np.random.Generator,
    *,
    training: bool,
    index: int = 0,
) -> Samples:
    """Crops of one scene's grasps out of a freshly corrupted image.

    Args:
        scene: the scene.
        settings: crop, thinning and augmentation.
        opening: of the gripper, metres.
        rng: what is random comes from here.
        training: thin, jitter and mirror; else every grasp is cut out as it is, from a noisy image.
        index: of the scene, returned with every sample.
    """
    augmentation = settings.augmentation
    if training and settings.bare:
        scene = with_bare_grasps(scene, settings.bare, opening, rng)
    kept = np.arange(len(scene.labels))
    weights = np.ones(len(kept), np.float32)
    if training:
        weights[scene.colliding] = 1 / settings.colliding
        kept = kept[~scene.colliding | (rng.random(len(kept)) < settings.colliding)]
    clean = DepthImage(scene.depth, scene.camera, np.ones(scene.units.shape, np.bool_))
    image = corrupt(clean, augmentation, rng)
    pixels, depths, context = scene.pixels[kept], scene.depths[kept], settings.crop.context
    if training:
        pixels = pixels + augmentation.grasp_pixel * rng.standard_normal(pixels.shape, np.float32)
        depths = depths + np.float32(augmentation.grasp_depth) * rng.standard_normal(len(depths), np.float32)
        context *= float(np.exp(rng.normal() * augmentation.zoom))
    spec = msgspec.structs.replace(settings.crop, context=context)
    cut = crops(image.depth, scene.camera, pixels[:, 0], pixels[:, 1], scene.angles[kept], depths, spec, opening)
    if training and augmentation.mirror:
        cut = mirror_crops(cut, rng)
    return Samples(cut, scene.labels[kept], weights[kept], np.full(len(kept), index))


def with_bare_grasps(scene: TrainingScene, count: int, opening: float, rng: np.random.Generator) -> TrainingScene:
    """Add up to `count` grasps of label 0 where the whole gripper meets nothing but table.

    A grid covers its object's rectangle only, while planning may sample anywhere.
    """
    depth, height = scene.depth, scene.camera.pose[2, 3]
    table = (depth > height - _BARE_HEIGHT).astype(np.uint8)
    away = cv2.distanceTransform(table, cv2.DIST_L2, 3)
    v, u = np.nonzero(away > opening * scene.camera.intrinsics.fx / height)
    chosen = rng.integers(0, len(u), min(count, len(u))) if len(u) else np.zeros(0, np.intp)
    pixels = np.stack([u[chosen], v[chosen]], axis=-1).astype(np.float32)
    depths = deepen(depth[v[chosen], u[chosen]], scene.camera).astype(np.float32)
    nothing = np.zeros(len(chosen), np.float32)
    return replace(
        scene,
        pixels=np.concatenate([scene.pixels, pixels]),
        angles=np.concatenate([scene.angles, rng.uniform(-np.pi / 2, np.pi / 2, len(chosen)).astype(np.float32)]),
        depths=np.concatenate([scene.depths, depths]),
        labels=np.concatenate([scene.labels, nothing]),
        colliding=np.concatenate([scene.colliding, nothing > 0]),
    )


def gather(parts: Sequence[Samples]) -> Samples:
    """Several scenes' samples as one."""
    return Samples(
        np.concatenate([part.crops for part in parts]),
        np.concatenate([part.labels for part in parts]),
        np.concatenate([part.weights for part in parts]),
        np.concatenate([part.scene for part in parts]),
    )


class RefinedTask:
    """The Refined Network, its scenes and its loss; see `loop.Task`.

    Args:
        training: scenes to learn from.
        validation: scenes of other objects.
        settings: see `RefinedSettings`.
        opening: of the gripper, metres.
        device: where to compute.
    """

    name = "refined"
    measure = "ap"

    def __init__(
        self,
        training: Sequence[TrainingScene],
        validation: Sequence[TrainingScene],
        settings: RefinedSettings,
        opening: float,
        device: torch.device,
    ) -> None:
        torch.manual_seed(settings.schedule.seed)
        self.network = RefinedNetwork(settings.width).to(device)
        self.network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self._training = training
        self._settings = settings
        self._opening = opening
        self._device = device
        self._half = half_precision(device)
        if not any(len(scene.labels) for scene in validation):
            raise ConfigError("no labelled grasp to validate on; the dataset's validation split is empty")
        chosen = one_view_each(validation, np.random.default_rng([settings.schedule.seed, 2]))
        self.held_out = gather(list(self._cut([validation[index] for index in chosen])))

    def _cut(self, scenes: Sequence[TrainingScene]) -> Iterator[Samples]:
        """Every grasp of scenes for evaluation, with noise that is the same each time."""
        seeds = np.random.SeedSequence([self._settings.schedule.seed, 1]).spawn(len(scenes))
        for index, (scene, seed) in enumerate(zip(scenes, seeds, strict=True)):
            rng = np.random.default_rng(seed)
            yield scene_samples(scene, self._settings, self._opening, rng, training=False, index=index)

    def _pool(self, chosen: NDArray[np.int64], rng: np.random.Generator) -> Samples:
        scenes = (self._training[index] for index in chosen)
        samples = gather([scene_samples(scene, self._settings, self._opening, rng, training=True) for scene in scenes])
        order = rng.permutation(len(samples.labels))
        return Samples(samples.crops[order], samples.labels[order], samples.weights[order], samples.scene[order])

    def batches(self, rng: np.random.Generator) -> Iterator[tuple[float, Batch]]:
        """Pools of scenes, each in one of its views, cut in the background while the network learns the pool before."""
        order = one_view_each(self._training, rng)
        pools = [order[start : start + self._settings.pool] for start in range(0, len(order), self._settings.pool)]
        for index, samples in enumerate(ahead(self._pool(pool, rng) for pool in pools)):
            count = max(1, round(len(samples.labels) / self._settings.schedule.batch))
            for step, part in enumerate(np.array_split(np.arange(len(samples.labels)), count)):
                if len(part) < 2:  # normalisation needs two
                    continue
                arrays = samples.crops[part, None], samples.labels[part], samples.weights[part]
                batch = tuple(torch.from_numpy(array).to(self._device) for array in arrays)
                yield (index + (step + 1) / count) / len(pools), batch

    def _logits(self, x: Tensor) -> Tensor:
        moved = x.to(self._device, memory_format=torch.channels_last)
        with torch.autocast(self._device.type, torch.bfloat16, enabled=self._half):
            logits: Tensor = self.network(moved)
        return logits.float()

    def loss(self, batch: Batch) -> Tensor:
        """See `soft_cross_entropy`."""
        cut, labels, weights = batch
        return soft_cross_entropy(self._logits(cut), labels, weights)

    def margins(self, samples: Samples, batch: int = 512) -> NDArray[np.float64]:
        """Logit of class 1 minus logit of class 0, (N,), in evaluation mode."""
        self.network.eval()
        found = []
        with torch.inference_mode():
            for start in range(0, len(samples.labels), batch):
                logits = self._logits(torch.from_numpy(samples.crops[start : start + batch, None]))
                found.append((logits[:, 1] - logits[:, 0]).cpu().numpy())
        return np.concatenate(found).astype(float)

    def judge(self, scenes: Sequence[TrainingScene]) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
        """Margins and labels (N,) of every grasp of scenes; their crops are never all in memory."""
        found = [(self.margins(samples), samples.labels) for samples in self._cut(scenes)]
        margins, labels = zip(*found, strict=True)
        return np.concatenate(margins), np.concatenate(labels)

    def measures(self, scenes: Sequence[TrainingScene]) -> dict[str, float]:
        """Metrics of `metrics.classification` over every grasp of scenes."""
        margins, labels = self.judge(scenes)
        return classification(scores(margins), labels)

    def validate(self) -> dict[str, float]:
        """The metrics on one view of every scene of validation objects."""
        return classification(scores(self.margins(self.held_out)), self.held_out.labels)


def scores(margins: NDArray[np.float64]) -> NDArray[np.float64]:
    """P(class 1) of margins."""
    return 0.5 * (1 + np.tanh(margins / 2))


def train_refined(
    training: Sequence[TrainingScene],
    validation: Sequence[TrainingScene],
    settings: RefinedSettings,
    opening: float,
    folder: Path,
    *,
    about: str = "",
    progress: bool = True,
) -> tuple[RefinedTask, Fit]:
    """Train the Refined Network in a run folder and calibrate it on the validation scenes.

    Returns:
        The task with the best network, its logits already divided by the temperature, and the record of the training
        with the metrics after calibration and the `temperature`.

    Raises:
        ConfigError: see `loop.fit`; no scenes.
    """
    task = RefinedTask(training, validation, settings, opening, pick_device())
    fitted = fit(task, settings.schedule, folder, about=about, progress=progress)
    margins, labels = task.judge(validation)
    temperature = fit_temperature(margins, labels)
    fold_temperature(task.network.fc, temperature)
    metrics = {**classification(scores(margins / temperature), labels), "temperature": temperature}
    return task, Fit(metrics, fitted.history, fitted.stopped)
