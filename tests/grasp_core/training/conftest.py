import math
from collections.abc import Callable

import numpy as np
import pytest

from grasp_core.camera import DepthImage, canonical_camera
from grasp_core.training.scenes import GraspLabels, TrainingScene, training_scene

OPENING = 0.10


def toy_grasps(rng: np.random.Generator, count: int, half: tuple[float, float], yaw: float) -> GraspLabels:
    """Grasps around a bar at the origin; those across its short side and near its middle succeed."""
    c, s = math.cos(yaw), math.sin(yaw)
    along = rng.uniform(-half[0] - 0.02, half[0] + 0.02, count)
    across = rng.uniform(-half[1] - 0.04, half[1] + 0.04, count)
    angles = rng.uniform(-math.pi / 2, math.pi / 2, count)
    off = (angles - (yaw + math.pi / 2) + math.pi / 2) % math.pi - math.pi / 2
    near = (np.abs(along) < half[0] - 0.01) & (np.abs(across) < 0.05 - half[1] - 0.012)
    labels = np.where(near & (np.abs(off) < 0.35), 1.0, np.where(near & (np.abs(off) < 0.5), 0.4, 0.0))
    on = (np.abs(along) < half[0]) & (np.abs(across) < half[1])
    heights = np.where(on, 0.02, 0.008)
    positions = np.stack([c * along - s * across, s * along + c * across, heights], axis=-1)
    return GraspLabels(positions, angles, labels, (labels == 0) & (np.abs(off) > 1.0))


def toy_scene(seed: int, count: int = 120) -> TrainingScene:
    """A bar 16 cm long, 3 to 5 cm wide and 5 cm high on the table, seen without perspective on its height."""
    rng = np.random.default_rng(seed)
    yaw = rng.uniform(-math.pi, math.pi)
    half = (0.08, rng.uniform(0.015, 0.025))
    camera = canonical_camera()
    v, u = np.mgrid[:300, :300] - 149.5
    x, y = u * 0.65 / 525, -v * 0.65 / 525
    c, s = math.cos(yaw), math.sin(yaw)
    inside = (np.abs(c * x + s * y) < half[0]) & (np.abs(-s * x + c * y) < half[1])
    depth = np.where(inside, 0.65, 0.70).astype(np.float32)
    image = DepthImage(depth, camera, np.ones(depth.shape, np.bool_))
    return training_scene(f"toy_{seed}", f"bar_{seed}", image, toy_grasps(rng, count, half, yaw))


@pytest.fixture(scope="session")
def toys() -> Callable[[int, int], list[TrainingScene]]:
    def make(first: int, count: int) -> list[TrainingScene]:
        return [toy_scene(first + index) for index in range(count)]

    return make
