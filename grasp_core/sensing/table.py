"""Finding the table: the plane that a depth image's cloud rests on, and with it the camera's pose.

A plane is linear in inverse depth, 1/z = a · (x, y, 1) for the ray (x, y, 1), and the noise of stereo and structured
light cameras is uniform there: planes are drawn from three points, and the best one is refined by least squares.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import ImageError
from grasp_core.sensing.rays import pixel_rays

_DRAWS = 200
"""Planes tried: where 30 % of the points are the table's, one is drawn from it alone with probability 0.995."""
_SCORED = 600
"""Points that judge a draw."""
_REFINED = 3000
"""Points that refine the best one."""
_TOLERANCE = 0.008
"""Metres at 0.8 m; grows with the square of the distance, as the noise of depth cameras does."""
_STEEPEST = np.cos(np.radians(75))
_BELOW = 0.02
"""Metres below a plane at which a point speaks against its being the table."""
_LEAST_SHARE = 0.15
"""Of the points must lie on the table."""


def find_table(image: DepthImage) -> Camera:
    """The image's camera with the pose that its table plane gives.

    The table is the plane that holds the most points, where points below it count against a plane: lids and shelves are
    flat too. The world has its origin on the table under the camera, z up, x along the image's right.

    Raises:
        ImageError: no plane holds enough of the points; the message says what to do.
    """
    rays, depth = _sample(image, _REFINED)
    rng = np.random.default_rng(0)
    few = rng.choice(len(depth), min(_SCORED, len(depth)), replace=False)
    normals, offsets = _draw((rays * depth[:, None])[few], rng)
    tolerance = _TOLERANCE * max(1.0, float(np.median(depth)) / 0.8) ** 2
    if len(offsets):
        height = offsets[:, None] - normals @ (rays[few] * depth[few, None]).T
        votes = (np.abs(height) < tolerance).sum(axis=1) - 0.5 * (height < -_BELOW).sum(axis=1)
        best = int(np.argmax(votes))
        plane = normals[best] / offsets[best]
        for factor in (1.0, 0.6, 0.5):
            on = np.abs(_heights(plane, rays, depth)) < tolerance * factor
            if on.sum() >= 3:
                plane = _fit(rays[on], 1 / depth[on], plane)
        share = float((np.abs(_heights(plane, rays, depth)) < tolerance).mean())
        if share >= _LEAST_SHARE and plane[2] > _STEEPEST * np.linalg.norm(plane):
            return image.camera.at(_pose(plane))
    raise ImageError(
        "no table plane was found in the depth image; show more of the table, or state the pose of the camera"
        " (world_from_camera) in its file"
    )


def _sample(image: DepthImage, most: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rays (N, 3) and depths (N,) of valid pixels on a regular grid, about `most` of them."""
    stride = max(1, int(np.sqrt(image.depth.size / most)))
    rays, depth = pixel_rays(image.camera.intrinsics)[::stride, ::stride], image.depth[::stride, ::stride]
    usable = image.valid[::stride, ::stride] & np.isfinite(rays[:, :, 0])
    if usable.sum() < 3:
        raise ImageError("the depth image has too few valid pixels to find the table in")
    return rays[usable].astype(float), depth[usable].astype(float)


def _draw(points: NDArray[np.float64], rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Planes through three points each: unit normals (K, 3) away from the camera and distances (K,) from it."""
    one, two, three = points[rng.integers(0, len(points), (3, _DRAWS))]
    normals = np.cross(two - one, three - one)
    length = np.linalg.norm(normals, axis=1)
    usable = length > 1e-6
    normals, one = normals[usable] / length[usable, None], one[usable]
    offsets = (normals * one).sum(axis=1)
    normals *= np.sign(offsets)[:, None]
    offsets = np.abs(offsets)
    usable = (normals[:, 2] > _STEEPEST) & (offsets > 1e-3)
    return normals[usable], offsets[usable]


def _fit(
    rays: NDArray[np.float64], inverse_depth: NDArray[np.float64], start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The plane of least squares through points; `start` where they lie on one line."""
    square = rays.T @ rays
    if np.linalg.cond(square) > 1e10:
        return start
    return np.asarray(np.linalg.solve(square, rays.T @ inverse_depth))


def _heights(plane: NDArray[np.float64], rays: NDArray[np.float64], depth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Heights (N,) of points over the plane 1/z = plane · ray, metres, positive towards the camera."""
    return (1 - depth * (rays @ plane)) / np.linalg.norm(plane)


def _pose(plane: NDArray[np.float64]) -> NDArray[np.float64]:
    """world_from_camera, 4×4, of a camera whose table is 1/z = plane · ray."""
    distance = 1 / np.linalg.norm(plane)
    up = -plane * distance
    right = np.array([1.0, 0.0, 0.0]) - up[0] * up
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = [right, np.cross(up, right), up]
    pose[2, 3] = distance
    return pose
