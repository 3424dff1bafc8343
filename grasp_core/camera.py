"""Pinhole cameras, depth images, and the way between pixels and the world (Eq. 2 of the paper).

Camera frame: OpenCV's, x right, y down, z forward. Whole pixel coordinates are pixel centres. World: z up, table at z = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import cv2
import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core import config
from grasp_core.errors import ConfigError, GraspError, ImageError

_FARTHEST = 20.0
"""Metres: a median depth beyond it means that the values are not metres."""


class CameraIntrinsics(msgspec.Struct, frozen=True):
    """Focal lengths and principal point in pixels, image size in pixels, OpenCV distortion (k1 k2 p1 p2 k3) or none."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int
    distortion: tuple[float, float, float, float, float] | None = None

    def __post_init__(self) -> None:
        values = [self.fx, self.fy, self.cx, self.cy, *(self.distortion or ())]
        if not all(math.isfinite(value) for value in values):
            raise GraspError("camera intrinsics must be finite numbers")
        if self.fx <= 0 or self.fy <= 0 or self.width < 1 or self.height < 1:
            raise GraspError(
                f"fx, fy, width and height must be above 0, not {self.fx}, {self.fy}, {self.width}, {self.height}"
            )

    @property
    def matrix(self) -> NDArray[np.float64]:
        """K_c, 3×3."""
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], float)


@dataclass(frozen=True)
class Camera:
    """Intrinsics and pose.

    Attributes:
        intrinsics: see `CameraIntrinsics`.
        world_from_camera: T_c, 4×4, or None while the pose is unknown (the table plane then gives it).
    """

    intrinsics: CameraIntrinsics
    world_from_camera: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        if self.world_from_camera is None:
            return
        pose = np.asarray(self.world_from_camera, float)
        if pose.shape != (4, 4) or not np.isfinite(pose).all():
            raise GraspError(f"world_from_camera must be a 4×4 matrix of finite numbers, not of shape {pose.shape}")
        rotation = pose[:3, :3]
        if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-4) or np.linalg.det(rotation) < 0:
            raise GraspError("world_from_camera holds no rotation (its 3×3 part is not orthonormal and right-handed)")
        if not np.allclose(pose[3], [0, 0, 0, 1]):
            raise GraspError("the last row of world_from_camera must be 0 0 0 1")
        pose = pose.copy()
        pose.setflags(write=False)
        object.__setattr__(self, "world_from_camera", pose)

    @property
    def pose(self) -> NDArray[np.float64]:
        """world_from_camera, 4×4.

        Raises:
            GraspError: the pose is unknown.
        """
        if self.world_from_camera is None:
            raise GraspError("this camera has no pose; add world_from_camera to its file or find the table plane first")
        return self.world_from_camera

    @cached_property
    def camera_from_world(self) -> NDArray[np.float64]:
        """4×4 inverse of the pose."""
        inverse = np.eye(4)
        inverse[:3, :3] = self.pose[:3, :3].T
        inverse[:3, 3] = -self.pose[:3, :3].T @ self.pose[:3, 3]
        return inverse

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """World points (…, 3), metres → (…, 3) of u, v in pixels and z-depth in metres, with distortion."""
        world = np.asarray(points, float)
        camera = world @ self.camera_from_world[:3, :3].T + self.camera_from_world[:3, 3]
        depth = camera[..., 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            x, y = camera[..., 0] / depth, camera[..., 1] / depth
        k = self.intrinsics
        if k.distortion is not None:
            x, y = _distort(x, y, k.distortion)
        return np.stack([k.fx * x + k.cx, k.fy * y + k.cy, depth], axis=-1)

    def deproject(self, pixels: ArrayLike, depth: ArrayLike) -> NDArray[np.float64]:
        """Pixels (…, 2) and their z-depths (…), metres → world points (…, 3), metres; inverse of `project`."""
        uv = np.asarray(pixels, float)
        z = np.asarray(depth, float)
        k = self.intrinsics
        if k.distortion is None:
            x, y = (uv[..., 0] - k.cx) / k.fx, (uv[..., 1] - k.cy) / k.fy
        else:
            flat = uv.reshape(-1, 1, 2)
            criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-12)
            ideal = cv2.undistortPointsIter(flat, k.matrix, np.array(k.distortion), None, None, criteria)
            x, y = np.moveaxis(ideal.reshape(uv.shape), -1, 0)
        camera = np.stack([x * z, y * z, z], axis=-1)
        return np.asarray(camera @ self.pose[:3, :3].T + self.pose[:3, 3])

    def at(self, world_from_camera: ArrayLike) -> Camera:
        """The same intrinsics at another pose."""
        return Camera(self.intrinsics, np.asarray(world_from_camera, float))


def _distort(
    x: NDArray[np.float64], y: NDArray[np.float64], coefficients: tuple[float, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """OpenCV's radial-tangential model on normalised coordinates (OpenCV documentation, calib3d)."""
    k1, k2, p1, p2, k3 = coefficients
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def look_down(height: float, x: float = 0.0, y: float = 0.0, tilt: float = 0.0) -> NDArray[np.float64]:
    """4×4 world_from_camera of a camera `height` metres above the table whose image right is world x.

    Args:
        height: of the optical centre above the table, metres.
        x: of the table point that the optical axis meets, metres.
        y: of that point, metres.
        tilt: between the optical axis and straight down, rad; positive moves the camera towards −y, so that it looks
            towards +y. The height above the table stays as given.
    """
    c, s = math.cos(tilt), math.sin(tilt)
    pose = np.eye(4)
    pose[:3, :3] = np.array([[1, 0, 0], [0, -c, s], [0, -s, -c]])
    pose[:3, 3] = [x, y - height * math.tan(tilt), height]
    return pose


CANONICAL_HEIGHT = 0.70
"""Metres of the canonical camera above the table."""


def canonical_camera(size: int = 300) -> Camera:
    """The canonical view: straight down, 0.70 m above the table, fx = fy = 525, a square of `size` pixels."""
    centre = (size - 1) / 2
    return Camera(CameraIntrinsics(525.0, 525.0, centre, centre, size, size), look_down(CANONICAL_HEIGHT))


@dataclass(frozen=True)
class DepthImage:
    """A depth image with its camera.

    Attributes:
        depth: float32 z-depth in metres, (H, W); what it holds at invalid pixels means nothing.
        camera: the camera; its size is the image's.
        valid: boolean (H, W), true where the depth was measured.
    """

    depth: NDArray[np.float32]
    camera: Camera
    valid: NDArray[np.bool_]

    def __post_init__(self) -> None:
        k = self.camera.intrinsics
        if self.depth.dtype != np.float32 or self.valid.dtype != np.bool_:
            raise ImageError("depth must be float32 and valid boolean; make depth images with DepthImage.from_array")
        if self.depth.shape != (k.height, k.width) or self.valid.shape != self.depth.shape:
            raise ImageError(
                f"the depth image is {self.depth.shape[1]}×{self.depth.shape[0]} pixels but its camera {k.width}×{k.height};"
                " give the camera file of this image"
            )

    @classmethod
    def from_array(cls, depth: ArrayLike, camera: Camera) -> DepthImage:
        """Metres (H, W) or (H, W, 1) → depth image; NaN, infinite and non-positive pixels become invalid.

        Raises:
            ImageError: wrong shape, not numbers, no valid pixel, or values that cannot be metres.
        """
        array = np.asarray(depth)
        if array.dtype.kind not in "fiu":
            raise ImageError(f"a depth image holds numbers in metres, not values of type {array.dtype}")
        if array.ndim == 3 and array.shape[2] == 1:
            array = array[:, :, 0]
        if array.ndim != 2:
            raise ImageError(
                f"a depth image has the shape (H, W) or (H, W, 1), not {array.shape}; a colour image is no depth"
            )
        metres = array.astype(np.float32)
        valid = np.isfinite(metres) & (metres > 0)
        if not valid.any():
            raise ImageError("the depth image has no valid pixel: every value is NaN, infinite or not above 0")
        median = float(np.median(metres[valid]))
        if median > _FARTHEST:
            raise ImageError(
                f"the median depth is {median:.0f}: these are not metres (millimetres?); convert them, for the command"
                " line with --depth-scale 0.001"
            )
        return cls(np.where(valid, metres, np.float32(0)), camera, valid)

    def with_camera(self, camera: Camera) -> DepthImage:
        """The same pixels seen by another camera of the same size."""
        return replace(self, camera=camera)

    def points(self) -> NDArray[np.float64]:
        """World points (H, W, 3), metres; rows of invalid pixels hold the camera's centre and mean nothing."""
        v, u = np.mgrid[: self.depth.shape[0], : self.depth.shape[1]]
        return self.camera.deproject(np.stack([u, v], axis=-1), self.depth)


class _CameraFile(config.Settings):
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int
    distortion: tuple[float, float, float, float, float] | None = None
    world_from_camera: list[list[float]] | None = None


def load_camera(name: str | Path) -> Camera:
    """Read a camera file (YAML; DESIGN's contract) or a shipped camera by name.

    Raises:
        ConfigError: missing file, unknown or ill-typed key, or values that make no camera.
    """
    read = config.load("cameras", name, _CameraFile)
    try:
        intrinsics = CameraIntrinsics(read.fx, read.fy, read.cx, read.cy, read.width, read.height, read.distortion)
        pose = None if read.world_from_camera is None else np.array(read.world_from_camera, float)
        return Camera(intrinsics, pose)
    except (GraspError, ValueError) as error:
        raise ConfigError(f"{name}: {error}") from error
