"""The viewing ray of every pixel: shared by rendering and rectification."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import CameraIntrinsics


@lru_cache(maxsize=8)
def pixel_rays(intrinsics: CameraIntrinsics) -> NDArray[np.float32]:
    """Rays (H, W, 3) float32 in the camera frame with z = 1, so that a distance along one is a z-depth; read-only.

    Lens distortion is undone, pixel by pixel.
    """
    v, u = np.mgrid[: intrinsics.height, : intrinsics.width]
    rays = np.ones((intrinsics.height, intrinsics.width, 3), np.float32)
    rays[:, :, :2] = intrinsics.rays(np.stack([u, v], axis=-1))
    rays.setflags(write=False)
    return rays
