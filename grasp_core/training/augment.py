"""Augmentation that follows the physics: what may change in an image without changing whether a grasp succeeds.

Turning, moving and mirroring a whole scene with its grasps changes no label; neither does sensor noise (Eq. 5), a lost
pixel, or a small error of the table plane or of the focal length. Noise and holes are drawn anew for every use.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.grasp import wrap_angle
from grasp_core.sensing.noise import ImageNoise, add_noise
from grasp_core.sensing.preprocess import fill_holes
from grasp_core.training.scenes import TrainingScene


class Augmentation(config.Settings):
    """How training images vary.

    Attributes:
        noise: of the depth camera.
        rich: share of images whose noise is `rich_noise`.
        rich_noise: richer noise of other depth cameras: pixels lost at edges, errors that neighbours share.
        clean: share of images without noise and holes.
        holes: mean number of lost patches.
        hole_radius: largest radius of a patch, pixels.
        plane_height: standard deviation of the height of the table plane that planning finds, metres.
        plane_tilt: standard deviation of its slope along x and along y, rad.
        zoom: standard deviation of the relative error of the focal length.
        rotate: whether whole images are turned (crops are turned to the closing axis anyway).
        shift: whole images are moved by up to this much along u and v, pixels.
        mirror: whether images and crops are mirrored.
        grasp_depth: standard deviation of the depth of p that planning reads from a noisy surface, metres.
        grasp_pixel: standard deviation of the pixel that a crop is centred on, pixels.
    """

    noise: ImageNoise = ImageNoise()
    rich: float = 0.25
    rich_noise: ImageNoise = ImageNoise(edge_dropout=0.3, gain_sigma=0.002, field_sigma=0.003)
    clean: float = 0.1
    holes: float = 2.0
    hole_radius: float = 6.0
    plane_height: float = 0.0015
    plane_tilt: float = 0.005
    zoom: float = 0.015
    rotate: bool = True
    shift: float = 60.0
    mirror: bool = True
    grasp_depth: float = 0.0015
    grasp_pixel: float = 0.5

    def __post_init__(self) -> None:
        numbers = ("holes", "hole_radius", "plane_height", "plane_tilt", "zoom", "shift", "grasp_depth", "grasp_pixel")
        for name in numbers:
            if not 0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be finite and at least 0, not {getattr(self, name)}")
        for name in ("clean", "rich"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} is a share from 0 to 1, not {getattr(self, name)}")


def corrupt(image: DepthImage, augmentation: Augmentation, rng: np.random.Generator) -> DepthImage:
    """What planning gets to see of a clean canonical image: noisy, with filled holes, its table a little off."""
    if rng.random() >= augmentation.clean:
        rich = rng.random() < augmentation.rich
        noisy = add_noise(image, augmentation.rich_noise if rich else augmentation.noise, rng)
        valid = noisy.valid
        count = int(rng.poisson(augmentation.holes))
        if count:
            lost = np.zeros(valid.shape, np.uint8)
            for _ in range(count):
                centre = tuple(int(value) for value in rng.integers(0, valid.shape[::-1]))
                axes = tuple(int(value) for value in np.ceil(rng.uniform(0, augmentation.hole_radius, 2)))
                cv2.ellipse(lost, centre, axes, float(rng.uniform(0, 180)), 0, 360, 1, -1)
            valid = valid & (lost == 0)
        image = DepthImage(noisy.depth, image.camera, valid)
        if not valid.all():
            image, _ = fill_holes(image)
    height, width = image.depth.shape
    k = image.camera.intrinsics
    slope = rng.normal(0, 1, 2) * augmentation.plane_tilt * image.camera.pose[2, 3] / (k.fx, k.fy)
    u, v = np.arange(width, dtype=np.float32) - k.cx, np.arange(height, dtype=np.float32) - k.cy
    plane = np.float32(slope[0]) * u[None, :] + np.float32(slope[1]) * v[:, None]
    off = np.float32(rng.normal(0, 1) * augmentation.plane_height)
    return DepthImage(np.asarray(image.depth + plane + off, np.float32), image.camera, image.valid)


@dataclass(frozen=True)
class Placed:
    """A whole image with its grasps after a change of place.

    Attributes:
        depth: (H, W) metres.
        pixels: (G, 2).
        angles: (G,) rad.
        matrix: (2, 3), takes pixels of the old image to the new one.
    """

    depth: NDArray[np.float32]
    pixels: NDArray[np.float32]
    angles: NDArray[np.float32]
    matrix: NDArray[np.float64]


def move_image(
    scene: TrainingScene, depth: NDArray[np.float32], augmentation: Augmentation, rng: np.random.Generator
) -> Placed:
    """Turn, mirror, zoom and move a whole image about its centre, and its grasps with it; new border is bare table.

    Depth keeps its values: the nearest pixel is taken, because mixing both sides of an edge would invent surfaces.
    """
    turn = rng.uniform(-math.pi, math.pi) if augmentation.rotate else 0.0
    flip = bool(augmentation.mirror and rng.random() < 0.5)
    scale = math.exp(rng.normal() * augmentation.zoom)
    shift = rng.uniform(-1, 1, 2) * augmentation.shift
    return moved_by(scene, depth, turn, flip, scale, (float(shift[0]), float(shift[1])))


def moved_by(
    scene: TrainingScene,
    depth: NDArray[np.float32],
    turn: float,
    flip: bool,
    scale: float,
    shift: tuple[float, float],
) -> Placed:
    """Mirror left and right, turn counter-clockwise as displayed by `turn` rad, zoom, move by `shift` pixels."""
    height, width = depth.shape
    centre = np.array([(width - 1) / 2, (height - 1) / 2])
    c, s = math.cos(turn) * scale, math.sin(turn) * scale
    linear = np.array([[c, s], [-s, c]]) @ np.diag([-1.0 if flip else 1.0, 1.0])
    offset = centre + shift - linear @ centre
    matrix = np.concatenate([linear, offset[:, None]], axis=1)
    moved = cv2.warpAffine(
        depth,
        matrix,
        (width, height),
        flags=cv2.INTER_NEAREST,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=float(scene.camera.pose[2, 3]),
    )
    pixels = scene.pixels @ linear.T + offset
    angles = np.array([wrap_angle(a) for a in (-scene.angles if flip else scene.angles) + turn], np.float32)
    return Placed(np.asarray(moved, np.float32), pixels.astype(np.float32), angles, matrix)


def mirror_crops(crops: NDArray[np.float32], rng: np.random.Generator) -> NDArray[np.float32]:
    """Mirror each crop (N, S, S) along and across the closing axis at random: exact symmetries of the gripper."""
    along, across = rng.random((2, len(crops))) < 0.5
    crops = np.where(along[:, None, None], crops[:, :, ::-1], crops)
    return np.where(across[:, None, None], crops[:, ::-1, :], crops)
