"""Noise of depth cameras: Eq. 5 of the paper, and richer effects as options.

Eq. 5 reads the exact depth at a pixel jittered by (χ_u, χ_v) and adds χ_d. The jittered pixel is rounded to the nearest
one, because mixing the two sides of an edge would invent surfaces that are not there.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import DepthImage


class ImageNoise(config.Settings):
    """How noisy a depth image is.

    Attributes:
        sigma_u: standard deviation of χ_u, pixels (Eq. 5).
        sigma_v: of χ_v, pixels.
        sigma_d: of χ_d, metres.
        edge_dropout: share of the pixels beside a depth edge that are lost, 0 to 1.
        edge_step: smallest step between neighbours that counts as such an edge, metres.
        gain_sigma: standard deviation of one factor on the whole image, drawn from a gamma distribution of mean 1.
        field_sigma: standard deviation of spatially correlated noise, metres.
        field_length: its length scale: the correlation over r pixels is exp(−r² / 2 length²).
    """

    sigma_u: float = 0.5
    sigma_v: float = 0.5
    sigma_d: float = 0.001
    edge_dropout: float = 0.0
    edge_step: float = 0.01
    gain_sigma: float = 0.0
    field_sigma: float = 0.0
    field_length: float = 1.414

    def __post_init__(self) -> None:
        for name in ("sigma_u", "sigma_v", "sigma_d", "gain_sigma", "field_sigma"):
            if not 0 <= getattr(self, name) < np.inf:
                raise ValueError(f"{name} is a standard deviation and must be finite and at least 0")
        if not 0 <= self.edge_dropout <= 1:
            raise ValueError(f"edge_dropout is a share from 0 to 1, not {self.edge_dropout}")
        if not 0 < self.edge_step < np.inf:
            raise ValueError(f"edge_step is a step in metres above 0, not {self.edge_step}")
        if not 1 <= self.field_length < np.inf:
            raise ValueError(f"field_length is in pixels and at least 1, not {self.field_length}")


def load_noise(name: str | Path = "paper") -> ImageNoise:
    """Read a noise file or a shipped one.

    Raises:
        ConfigError: missing file, or an unknown or ill-typed key.
    """
    return config.load("noise", name, ImageNoise)


def add_noise(image: DepthImage, noise: ImageNoise, rng: np.random.Generator) -> DepthImage:
    """A noisy copy of a clean depth image; pixels pushed to no depth or to none above 0 become invalid."""
    depth, valid = image.depth, image.valid
    height, width = depth.shape
    if noise.sigma_u > 0 or noise.sigma_v > 0:
        v, u = np.mgrid[:height, :width].astype(np.float32)
        u += np.float32(noise.sigma_u) * rng.standard_normal(depth.shape, np.float32)
        v += np.float32(noise.sigma_v) * rng.standard_normal(depth.shape, np.float32)
        columns = np.clip(np.rint(u), 0, width - 1).astype(np.intp)
        rows = np.clip(np.rint(v), 0, height - 1).astype(np.intp)
        depth, valid = depth[rows, columns], valid[rows, columns]
    else:
        depth, valid = depth.copy(), valid.copy()
    if noise.edge_dropout > 0:
        valid &= ~(depth_edges(depth, valid, noise.edge_step) & (rng.random(depth.shape) < noise.edge_dropout))
    if noise.gain_sigma > 0:
        shape = 1 / noise.gain_sigma**2
        depth *= np.float32(rng.gamma(shape, 1 / shape))
    if noise.sigma_d > 0:
        depth += np.float32(noise.sigma_d) * rng.standard_normal(depth.shape, np.float32)
    if noise.field_sigma > 0:
        depth += np.float32(noise.field_sigma) * _smooth_field(depth.shape, noise.field_length, rng)
    valid &= depth > 0
    depth[~valid] = 0
    return replace(image, depth=depth, valid=valid)


def depth_edges(depth: NDArray[np.float32], valid: NDArray[np.bool_], step: float) -> NDArray[np.bool_]:
    """Boolean (H, W): pixels whose 3×3 neighbourhood holds two valid depths more than `step` metres apart."""
    kernel = np.ones((3, 3), np.uint8)
    far = cv2.dilate(np.where(valid, depth, np.float32(-np.inf)), kernel)
    near = cv2.erode(np.where(valid, depth, np.float32(np.inf)), kernel)
    return np.asarray(far - near > step)


def _smooth_field(shape: tuple[int, ...], length: float, rng: np.random.Generator) -> NDArray[np.float32]:
    """Gaussian noise (H, W) of standard deviation 1 with a squared-exponential correlation of `length` pixels."""
    radius = int(np.ceil(3 * length))
    white = rng.standard_normal((shape[0] + 2 * radius, shape[1] + 2 * radius), np.float32)
    offsets = np.arange(-radius, radius + 1)
    kernel = np.exp(-0.5 * (offsets / (length / np.sqrt(2))) ** 2)
    kernel /= np.sqrt((kernel**2).sum())
    smooth = cv2.sepFilter2D(white, cv2.CV_32F, kernel, kernel)
    return np.asarray(smooth[radius:-radius, radius:-radius])
