"""Pinhole cameras, depth images, and the way between pixels and the world (Eq. 2 of the paper).

Camera frame: OpenCV's, x right, y down, z forward. Whole pixel coordinates are pixel centres. World: z up, the table is
z = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core import config
from grasp_core.errors import ConfigError, GraspError, ImageError

_FARTHEST = 20.0
"""Metres: a median depth beyond it means that the values are not metres."""
_LOOKED_AT = 4000
"""Pixels, about, that tell the median."""


def rigid(matrix: ArrayLike, name: str) -> NDArray[np.float64]:
    """Check a rigid transform; returns a read-only copy whose rotation is exactly orthonormal.

    Args:
        matrix: (4, 4); a rotation given with few digits (within 1e-4) is rounded to the nearest one.
        name: what the matrix is called, for the errors.

    Raises:
        GraspError: not 4×4 numbers, not finite, no rotation, or a wrong last row.
    """
    try:
        given = np.asarray(matrix, float)
    except (TypeError, ValueError) as error:
        raise GraspError(f"{name} must be a 4×4 matrix of numbers: four rows of four") from error
    if given.shape != (4, 4) or not np.isfinite(given).all():
        raise GraspError(f"{name} must be a 4×4 matrix of finite numbers, not {given.tolist()}")
    rotation = given[:3, :3]
    off = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    if off > 1e-4 or np.linalg.det(rotation) < 0:
        raise GraspError(f"{name} holds no rotation: its 3×3 part is not orthonormal and right-handed")
    if not np.allclose(given[3], [0, 0, 0, 1]):
        raise GraspError(f"the last row of {name} must be 0 0 0 1, not {given[3].tolist()}")
    checked = given.copy()
    checked[3] = [0, 0, 0, 1]
    if off > 1e-13:
        left, _, right = np.linalg.svd(rotation)
        checked[:3, :3] = left @ right
    checked.setflags(write=False)
    return checked


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

    def pixels(self, rays: ArrayLike) -> NDArray[np.float64]:
        """Directions (…, 2) as x/z, y/z in the camera frame → pixels (…, 2) as u, v, with distortion."""
        x, y = np.moveaxis(np.asarray(rays, float), -1, 0)
        if self.distortion is not None:
            x, y = _distort(x, y, self.distortion)[0]
        return np.stack([self.fx * x + self.cx, self.fy * y + self.cy], axis=-1)

    def rays(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Pixels (…, 2) as u, v → directions (…, 2) as x/z, y/z in the camera frame; inverse of `pixels`.

        NaN where the distortion has no inverse: such coefficients fold the image over before its corners.
        """
        uv = np.asarray(pixels, float)
        x, y = (uv[..., 0] - self.cx) / self.fx, (uv[..., 1] - self.cy) / self.fy
        if self.distortion is not None:
            x, y = _undistort(x, y, self.distortion)
        return np.stack([x, y], axis=-1)


@dataclass(frozen=True, eq=False)
class Camera:
    """Intrinsics and pose.

    Attributes:
        intrinsics: see `CameraIntrinsics`.
        world_from_camera: T_c, 4×4, or None while the pose is unknown (the table plane then gives it).
    """

    intrinsics: CameraIntrinsics
    world_from_camera: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        if self.world_from_camera is not None:
            object.__setattr__(self, "world_from_camera", rigid(self.world_from_camera, "world_from_camera"))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Camera):
            return NotImplemented
        mine, others = self.world_from_camera, other.world_from_camera
        same_pose = mine is others or (mine is not None and others is not None and np.array_equal(mine, others))
        return self.intrinsics == other.intrinsics and same_pose

    def __hash__(self) -> int:
        return hash(self.intrinsics)

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
            pixels = self.intrinsics.pixels(camera[..., :2] / depth[..., None])
        return np.concatenate([pixels, depth[..., None]], axis=-1)

    def sees(self, points: ArrayLike, margin: float) -> bool:
        """Whether world points (N, 3), metres, all project into the image, `margin` pixels off its border."""
        u, v, depth = self.project(points).T
        k = self.intrinsics
        inside = (u >= margin) & (u <= k.width - 1 - margin) & (v >= margin) & (v <= k.height - 1 - margin)
        return bool((inside & (depth > 0)).all())

    def deproject(self, pixels: ArrayLike, depth: ArrayLike) -> NDArray[np.float64]:
        """Pixels (…, 2) and their z-depths (…), metres → world points (…, 3), metres; inverse of `project`."""
        rays = self.intrinsics.rays(pixels)
        z = np.broadcast_to(np.asarray(depth, float), rays.shape[:-1])[..., None]
        camera = np.concatenate([rays * z, z], axis=-1)
        return np.asarray(camera @ self.pose[:3, :3].T + self.pose[:3, 3])

    def horizontal_jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """World points (…, 3) → (…, 2, 2): pixels (u, v) per metre along world x and y there, distortion included."""
        rotation = self.camera_from_world[:3, :3]
        camera = np.asarray(points, float) @ rotation.T + self.camera_from_world[:3, 3]
        z = camera[..., 2, None]
        x, y = camera[..., 0, None] / z, camera[..., 1, None] / z
        dx = (rotation[0, :2] - x * rotation[2, :2]) / z
        dy = (rotation[1, :2] - y * rotation[2, :2]) / z
        k = self.intrinsics
        if k.distortion is not None:
            a, b, c = _distort(x, y, k.distortion)[1]
            dx, dy = a * dx + b * dy, b * dx + c * dy
        return np.stack([k.fx * dx, k.fy * dy], axis=-2)

    def at(self, world_from_camera: ArrayLike) -> Camera:
        """The same intrinsics at another pose."""
        return Camera(self.intrinsics, np.asarray(world_from_camera, float))


_Plane = NDArray[np.float64]


def _distort(
    x: _Plane, y: _Plane, coefficients: tuple[float, ...]
) -> tuple[tuple[_Plane, _Plane], tuple[_Plane, _Plane, _Plane]]:
    """OpenCV's radial-tangential model on normalised coordinates (OpenCV documentation, calib3d), and its derivatives.

    Returns:
        ((x, y) distorted, (∂x/∂x, ∂x/∂y = ∂y/∂x, ∂y/∂y)).
    """
    k1, k2, p1, p2, k3 = coefficients
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3))  # ∂radial/∂x = slope · x
    distorted = (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )
    derivatives = (
        radial + slope * x * x + 2 * p1 * y + 6 * p2 * x,
        slope * x * y + 2 * p1 * x + 2 * p2 * y,
        radial + slope * y * y + 6 * p1 * y + 2 * p2 * x,
    )
    return distorted, derivatives


def _undistort(x: _Plane, y: _Plane, coefficients: tuple[float, ...]) -> tuple[_Plane, _Plane]:
    """Newton's inverse of `_distort`; NaN where it finds none or only one beyond a fold of the model."""
    found_x, found_y = np.array(x), np.array(y)
    with np.errstate(all="ignore"):
        for _ in range(30):
            (dx, dy), (a, b, c) = _distort(found_x, found_y, coefficients)
            off_x, off_y = dx - x, dy - y
            determinant = a * c - b * b
            found_x = found_x - (c * off_x - b * off_y) / determinant
            found_y = found_y - (a * off_y - b * off_x) / determinant
            if max(np.abs(off_x).max(initial=0.0), np.abs(off_y).max(initial=0.0)) < 1e-12:
                break
        (dx, dy), (a, b, c) = _distort(found_x, found_y, coefficients)
        good = (np.hypot(dx - x, dy - y) < 1e-9) & (a * c - b * b > 0) & (a + c > 0)
    return np.where(good, found_x, np.nan), np.where(good, found_y, np.nan)


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


@dataclass(frozen=True, eq=False)
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
                f"the depth image has {self.depth.shape[::-1]} pixels (width, height) but its camera"
                f" {(k.width, k.height)}; give the camera file of this image"
            )
        stride = max(1, int(np.sqrt(self.depth.size / _LOOKED_AT)))
        some = self.depth[::stride, ::stride][self.valid[::stride, ::stride]]
        if len(some) and (median := float(np.median(some))) > _FARTHEST:
            raise ImageError(
                f"the median depth is {median:.0f}: these are not metres (millimetres?); convert them, for the command"
                " line with --depth-scale 0.001"
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
    world_from_camera: tuple[tuple[float, float, float, float], ...] | None = None


def _refuse_folds(intrinsics: CameraIntrinsics) -> None:
    right, bottom = intrinsics.width - 1, intrinsics.height - 1
    across, down = np.linspace(0, right, 50), np.linspace(0, bottom, 50)
    rim = [
        np.stack(np.broadcast_arrays(u, v), axis=-1)
        for u, v in ((across, 0), (across, bottom), (0, down), (right, down))
    ]
    if not np.isfinite(intrinsics.rays(np.concatenate(rim))).all():
        raise GraspError(
            "distortion: these coefficients fold the image over before its border; check their order (k1 k2 p1 p2 k3)"
        )


def load_camera(name: str | Path) -> Camera:
    """Read a camera file (YAML: fx fy cx cy width height, optional distortion and pose) or a shipped camera by name.

    Raises:
        ConfigError: missing file, unknown or ill-typed key, or values that make no camera.
    """
    path = config.locate("cameras", name)
    read = config.load("cameras", name, _CameraFile)
    try:
        intrinsics = CameraIntrinsics(read.fx, read.fy, read.cx, read.cy, read.width, read.height, read.distortion)
        _refuse_folds(intrinsics)
        return Camera(intrinsics, None if read.world_from_camera is None else np.array(read.world_from_camera, float))
    except GraspError as error:
        raise ConfigError(f"{path}: {error}") from error
