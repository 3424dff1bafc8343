"""What the Refined Network sees of a grasp candidate: a rotated crop of the canonical depth, and the grasp-depth rule.

Planning and training use these same functions, on a canvas: the depth (H, W) of a camera that looks straight down. A
candidate is a canvas pixel (u, v) that shows the surface above p, an angle, and the z-depth of p. p lies straight below
(or above) the surface point, so that off the centre of the canvas it projects to a pixel other than (u, v): positions
come from deprojecting the surface, and only then is the depth offset applied along world z.

A crop is centred on (u, v), its x axis runs along the closing axis, and its side is `context` openings at the depth of
p: the fingers stand at the same pixels of every crop, whatever the height of the object. At table depth the 10 cm
opening is 75 px of the canonical view.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core import config
from grasp_core.camera import Camera
from grasp_core.networks.weights import CropSpec
from grasp_core.sensing.lookup import look_up

CROP_SCALE = 0.05
"""Metres per unit of a crop's content."""

CROP_RANGE = 2.0
"""Crop contents are clipped to ±2 units, 10 cm above and below the finger tips: finger and rod fit in between."""


class DepthRule(config.Settings):
    """How deep a grasp reaches: p = surface − offset, tips never under `clearance` above the table.

    Attributes:
        offset: of p below the surface, metres.
        clearance: of the finger tips above the table, metres.
    """

    offset: float = 0.03
    clearance: float = 0.008

    def __post_init__(self) -> None:
        if self.offset < 0 or self.clearance < 0:
            raise ValueError(f"offset and clearance are at least 0 m, not {self.offset} and {self.clearance}")


PAPER_RULE = DepthRule()
"""The rule that the shipped data and weights were made with."""

_SPEC = CropSpec()


def surface_map(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """z-depth (H, W) of the surface that a grasp at each pixel takes its depth from.

    The nearest of the 3×3 medians of 3×3 pixels: a stray pixel does not count, a thin rim is not missed by a pixel.
    """
    return nearest(without_strays(depth), 3)


def without_strays(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """A depth (H, W) without stray pixels: its 3×3 median."""
    return np.asarray(cv2.medianBlur(np.ascontiguousarray(depth, np.float32), 3))


def nearest(depth: NDArray[np.float32], side: int) -> NDArray[np.float32]:
    """The nearest depth (H, W) in the square of `side` pixels around each pixel."""
    return np.asarray(cv2.erode(depth, np.ones((side, side), np.uint8)))


def sample(values: NDArray, u: ArrayLike, v: ArrayLike) -> NDArray:
    """Values (H, W) at the pixels nearest to (u, v), each (N,); positions outside take the nearest border pixel."""
    columns = np.clip(np.rint(np.asarray(u, float)), 0, values.shape[1] - 1).astype(np.intp)
    rows = np.clip(np.rint(np.asarray(v, float)), 0, values.shape[0] - 1).astype(np.intp)
    return np.asarray(values[rows, columns])


def deepen(surface: ArrayLike, camera: Camera, rule: DepthRule = PAPER_RULE) -> NDArray[np.float64]:
    """z-depth (N,) of p for surfaces at the z-depths (N,) of a straight-down camera, metres."""
    return np.minimum(np.asarray(surface, float) + rule.offset, camera.pose[2, 3] - rule.clearance)


def grasp_positions(
    surface: NDArray[np.float32], camera: Camera, u: ArrayLike, v: ArrayLike, rule: DepthRule = PAPER_RULE
) -> NDArray[np.float64]:
    """World positions p (N, 3), metres, of grasps at canvas pixels (u, v), each (N,); `surface` is a `surface_map`."""
    top = sample(surface, u, v)
    positions = camera.deproject(np.stack(np.broadcast_arrays(u, v), axis=-1), top)
    positions[..., 2] = camera.pose[2, 3] - deepen(top, camera, rule)
    return positions


def canvas_yaw(camera: Camera) -> float:
    """Angle of a straight-down camera's image right in the world, rad: φ = angle on the canvas + this."""
    return math.atan2(camera.pose[1, 0], camera.pose[0, 0])


def grasp_pixels(
    depth: NDArray[np.float32], camera: Camera, positions: NDArray[np.float64], angles: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Where grasps of the world lie on a canvas; the inverse of `grasp_positions`, for known p.

    Args:
        depth: the canvas (H, W), metres.
        camera: its straight-down camera.
        positions: p (N, 3), world, metres.
        angles: φ (N,), rad.

    Returns:
        u, v of the surface above p (pixels, as sampled by `surface_map`), the angle on the canvas (rad) and the z-depth
        of p (metres), each (N,): the arguments of `crops`.
    """
    positions = np.asarray(positions, float)
    surface = surface_map(depth)
    height = camera.pose[2, 3]
    above = positions.copy()
    for _ in range(4):  # the surface that a pixel shows moves the pixel; settles at once but at edges
        pixels = camera.project(above)
        above[:, 2] = height - sample(surface, pixels[:, 0], pixels[:, 1])
    pixels = camera.project(above)
    return pixels[:, 0], pixels[:, 1], np.asarray(angles, float) - canvas_yaw(camera), height - positions[:, 2]


def crops(
    depth: NDArray[np.float32],
    camera: Camera,
    u: ArrayLike,
    v: ArrayLike,
    angle: ArrayLike,
    grasp_depth: ArrayLike,
    spec: CropSpec = _SPEC,
    opening: float = 0.10,
) -> NDArray[np.float32]:
    """Crops of all candidates in one warp.

    Args:
        depth: the canvas (H, W), metres, without holes.
        camera: its straight-down camera.
        u: columns (N,) of the surface points, pixels.
        v: rows (N,), pixels.
        angle: of the closing axis on the canvas, rad (N,), counter-clockwise as displayed.
        grasp_depth: z-depth of p, metres (N,).
        spec: size and context.
        opening: the gripper's, metres.

    Returns:
        (N, size, size) float32: (depth − depth of p) / `CROP_SCALE`, clipped to ±`CROP_RANGE`; what is nearer than the
        finger tips is negative. Outside of the canvas lies bare table.
    """
    u, v, angle, grasp_depth = (
        np.atleast_1d(np.asarray(array, np.float32))[:, None] for array in (u, v, angle, grasp_depth)
    )
    size = spec.size
    step = spec.context * opening * camera.intrinsics.fx / (size * grasp_depth)
    offset = np.arange(size, dtype=np.float32) - np.float32((size - 1) / 2)
    right, down = (plane.reshape(-1) for plane in np.meshgrid(offset, offset))
    cos, sin = np.cos(angle) * step, np.sin(angle) * step
    grid = np.stack([np.ones_like(right), right, down])
    warped = look_up(
        _averaged(depth, spec, camera, opening),
        np.hstack([u, cos, sin]) @ grid,
        np.hstack([v, -sin, cos]) @ grid,
        outside=float(camera.pose[2, 3]),
        linear=True,
    )
    warped -= grasp_depth
    warped /= np.float32(CROP_SCALE)
    np.clip(warped, -CROP_RANGE, CROP_RANGE, out=warped)
    return warped.reshape(len(u), size, size)


def _averaged(depth: NDArray[np.float32], spec: CropSpec, camera: Camera, opening: float) -> NDArray[np.float32]:
    """The canvas averaged over 3×3 pixels where crop pixels are that coarse at table depth, so that none is skipped."""
    depth = np.ascontiguousarray(depth, np.float32)
    step = spec.context * opening * camera.intrinsics.fx / (spec.size * camera.pose[2, 3])
    return np.asarray(cv2.blur(depth, (3, 3), borderType=cv2.BORDER_REPLICATE)) if step >= 1.5 else depth
