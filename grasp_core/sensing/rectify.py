"""Any camera's view made canonical: what a camera straight above the table would see of the input's cloud.

The canonical camera stands 0.70 m above the point where the input's optical axis meets the table, its image right along
the input's. The way there has two steps. A camera at the input's own place that is turned straight down sees the same
points without any parallax: that is a warp, and with its focal length chosen so that the table has the canonical scale,
every table pixel is in its place already. Only what stands above the table still moves, and is splatted into a z-buffer
point by point, so that nothing bridges the step between two surfaces. What no point reaches, the shadows of objects and
the outside of the view, takes its background.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import CANONICAL_HEIGHT, Camera, CameraIntrinsics, DepthImage, canonical_camera
from grasp_core.errors import ImageError
from grasp_core.sensing.lookup import look_up
from grasp_core.sensing.plausible import check_height, check_table
from grasp_core.sensing.rays import pixel_rays
from grasp_core.sensing.table import find_table

FOCAL = canonical_camera().intrinsics.fx
"""Pixels."""
_DENSITY = FOCAL / CANONICAL_HEIGHT
"""Canvas pixels per metre of table."""
_LEAST_SIZE = 300
_MOST_SIZE = 1024
"""Pixels of a canvas side; a wider view is cut around the optical axis."""
_RAISED = 0.004
"""Metres above the table from which on points are moved; below it they would move by less than a pixel."""
_FLOOR = 0.02
"""Metres below the table; what lies deeper, the floor beyond its edge, is raised to it."""
_CEILING = 0.45
"""Metres above the table; what is higher has no place on the canvas."""
_SAME_SURFACE = 0.01
"""Metres: depths farther apart are not interpolated or taken for one surface."""
_STEEPEST = np.cos(np.radians(75))
_SQUARE = np.ones((3, 3), np.uint8)
_BORDER = 40
"""Points along each border of the image that draw its outline on the canvas."""
_FAR = 8000.0
"""Pixels: farther out nothing is drawn."""


@dataclass(frozen=True, eq=False)
class Rectified:
    """A view made canonical; it is rendered when it is first asked for.

    Attributes:
        canvas: the canonical camera, straight down, in the input's world.
        camera: the input's camera with the pose that was used.
        missing: share of the input's pixels that were invalid.
        turn: how the input is warped to the turned camera; see `_Turn`.
        turned: (H, W) heights above the table in the turned view, metres; −inf where nothing usable was seen.
        foot: (2,) the pixel of the canvas straight below the input's camera.
    """

    canvas: Camera
    camera: Camera
    missing: float
    turn: _Turn
    turned: NDArray[np.float32]
    foot: NDArray[np.float64]

    @property
    def image(self) -> DepthImage:
        """What the canonical camera sees: depth without holes."""
        return self._rendered[0]

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Boolean (H, W), true where the input shows what the canvas holds."""
        return self._rendered[1]

    @property
    def moved(self) -> NDArray[np.intp]:
        """Flat canvas indices (2, M): pixels of the turned view and where on the canvas they are shown."""
        return self._rendered[2]

    @cached_property
    def _rendered(self) -> tuple[DepthImage, NDArray[np.bool_], NDArray[np.intp]]:
        height = self.turned.copy()
        moved = _move_raised(height, self.camera.pose[2, 3], self.foot, self.canvas)
        seen = _close_gaps(height, np.isfinite(height))
        if not np.array_equal(*moved):
            _close_pits(height)
        np.maximum(height, np.float32(-_FLOOR), out=height)
        _fill_background(height, seen)
        depth = np.subtract(np.float32(CANONICAL_HEIGHT), height, out=height)
        return DepthImage(depth, self.canvas, np.ones_like(seen)), seen, moved

    def above(self, place: NDArray[np.float64]) -> Rectified:
        """The same seen from another place: the canonical camera stands over (x, y) of the table, world, metres.

        Pixels of the table stay where they are on the canvas, what stands above it moves. `place` is rounded to pixels.
        """
        pose, k = self.canvas.pose.copy(), self.canvas.intrinsics
        shift = np.rint((np.asarray(place, float) - pose[:2, 3]) @ pose[:2, :2] * _DENSITY)
        if not shift.any():
            return self
        pose[:2, 3] += pose[:2, :2] @ shift / _DENSITY
        return replace(self, canvas=Camera(msgspec.structs.replace(k, cx=k.cx + shift[0], cy=k.cy + shift[1]), pose))

    def middle(self, chosen: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Where on the table, (x, y) in the world, metres, the middle of pixels (H, W) of the turned view is.

        That of the rectangle around them along the canvas; the place below the canonical camera when there are none.
        """
        start = np.flatnonzero(chosen)
        if not len(start):
            return self.canvas.pose[:2, 3].copy()
        k, camera_height = self.canvas.intrinsics, self.camera.pose[2, 3]
        rows, columns = np.divmod(start, k.width)
        shrink = (camera_height - self.turned.reshape(-1)[start]) / camera_height
        pixels = [foot + shrink * (axis - foot) for axis, foot in zip((columns, rows), self.foot, strict=True)]
        offset = [(axis.min() + axis.max()) / 2 - middle for axis, middle in zip(pixels, (k.cx, k.cy), strict=True)]
        return np.asarray(self.canvas.pose[:2, 3] + self.canvas.pose[:2, :2] @ np.array(offset) / _DENSITY)

    @cached_property
    def rim(self) -> NDArray[np.bool_]:
        """Boolean (H, W) of the turned view: what lies within 3 pixels of the border of the input, or outside."""
        k = self.camera.intrinsics
        across, down = np.linspace(3, k.width - 4, _BORDER), np.linspace(3, k.height - 4, _BORDER)
        low, high = np.full(_BORDER, 3.0), (np.full(_BORDER, k.width - 4.0), np.full(_BORDER, k.height - 4.0))
        u = np.concatenate([across, high[0], across[::-1], low])
        v = np.concatenate([low, down, high[1], down[::-1]])
        outside = np.ones(self.turned.shape, np.uint8)
        cv2.fillPoly(outside, [np.rint(self.turn.pixels(np.stack([u, v], axis=-1))).astype(np.int32)], 0)
        return outside > 0

    @cached_property
    def _occluders(self) -> NDArray[np.float32]:
        """The heights of the turned view without stray pixels."""
        return np.asarray(cv2.medianBlur(self.turned, 3))

    @cached_property
    def tallest(self) -> float:
        """Metres above the table that nothing which the input shows is higher than; stray pixels do not count."""
        return float(self._occluders.max())

    def hides(
        self, right: NDArray[np.floating], down: NDArray[np.floating], height: NDArray[np.floating]
    ) -> NDArray[np.bool_]:
        """Whether points lie behind a surface that the input shows, so that what is there is not known.

        A ray from the input's camera passes a point at its height; the surface that the ray ends on hides the point
        where it is higher. Points that no ray of the image passes are not hidden.

        Args:
            right: metres along the canvas's x axis from the place under the canonical camera, any shape.
            down: metres along its y axis.
            height: of the points above the table, metres; all three broadcast.
        """
        k, camera_height = self.canvas.intrinsics, self.camera.pose[2, 3]
        stretch = (camera_height / np.maximum(camera_height - height, 1e-3)).astype(np.float32)
        u, v = (
            np.float32(foot) + (np.float32(_DENSITY) * offset + np.float32(principal - foot)) * stretch
            for offset, principal, foot in ((right, k.cx, self.foot[0]), (down, k.cy, self.foot[1]))
        )
        return np.asarray(look_up(self._occluders, u, v, outside=-np.inf) > height)

    def turn_mask(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """A mask of the input (H, W) → of the turned view.

        Raises:
            ImageError: the mask is not boolean or has another size than the input.
        """
        k = self.camera.intrinsics
        if mask.dtype != np.bool_ or mask.shape != (k.height, k.width):
            raise ImageError(
                f"the mask is {mask.dtype} of the shape {mask.shape}; it must be boolean and {(k.height, k.width)},"
                " the shape of the image"
            )
        return np.asarray(self.turn.warp(np.ascontiguousarray(mask, np.float32), 0.0) > 0.5)

    def carry(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """A mask of the input (H, W) → of the canvas; false where nothing was seen. Raises as `turn_mask`."""
        turned = self.turn_mask(mask)
        carried = turned.copy().reshape(-1)
        carried[self.moved[0]] = False
        carried[self.moved[1]] = turned.reshape(-1)[self.moved[0]]
        closed = cv2.morphologyEx(carried.reshape(turned.shape).view(np.uint8), cv2.MORPH_CLOSE, _SQUARE) > 0
        return closed & self.seen


@dataclass(frozen=True, eq=False)
class _Turn:
    """The warp from the input to a camera at the same place that looks straight down, in table-true scale.

    Attributes:
        intrinsics: the input's.
        shape: (H, W) of the canvas.
        input_from_turned: (3, 3), takes homogeneous pixels of the turned view to rays of the input.
    """

    intrinsics: CameraIntrinsics
    shape: tuple[int, int]
    input_from_turned: NDArray[np.float64]

    def pixels(self, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels (N, 2) of the input → pixels of the turned view; those at or above the horizon end far outside."""
        rays = np.column_stack([self.intrinsics.rays(pixels), np.ones(len(pixels))])
        turned = rays @ np.linalg.inv(self.input_from_turned).T
        return np.clip(turned[:, :2] / np.maximum(turned[:, 2:], 1e-3), -_FAR, _FAR)

    def warp(self, values: NDArray[np.float32], outside: float, linear: bool = False) -> NDArray[np.float32]:
        """Values (H, W) of the input → of the turned view, the nearest or interpolated ones."""
        height, width = self.shape
        flags = cv2.INTER_LINEAR if linear else cv2.INTER_NEAREST
        k = self.intrinsics
        if k.distortion is None:
            homography = k.matrix @ self.input_from_turned
            flags |= cv2.WARP_INVERSE_MAP
            return np.asarray(
                cv2.warpPerspective(values, homography, (width, height), flags=flags, borderValue=outside)
            )
        v, u = np.mgrid[:height, :width]
        rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ self.input_from_turned.T
        with np.errstate(divide="ignore", invalid="ignore"):
            source = k.pixels(rays[:, :, :2] / rays[:, :, 2:]).astype(np.float32)
        return np.asarray(cv2.remap(values, source[:, :, 0], source[:, :, 1], flags, borderValue=outside))


def rectify(image: DepthImage) -> Rectified:
    """Re-render a depth image into the canonical view; without a pose in its camera the table plane is found first.

    Straight down from 0.70 m with the canonical focal length it changes nothing.

    Raises:
        ImageError: no table was found, the camera does not look down at it, or it is not where it should be: the scale
            of the depths is wrong, or the pose.
    """
    posed = image.camera.world_from_camera is not None
    camera = image.camera if posed else find_table(image)
    check_height(float(camera.pose[2, 3]), posed)
    canvas = _canvas(camera)
    turn, foot = _turn(camera, canvas)
    turned = _turned_heights(image, camera, turn)
    if not np.isfinite(turned).any():
        raise ImageError(
            "the depth image shows nothing near the table under its camera; check world_from_camera in the camera file"
        )
    if posed:
        check_table(turned)
    missing = 1 - float(np.count_nonzero(image.valid)) / image.valid.size
    return Rectified(canvas, camera, missing, turn, turned, foot)


def _canvas(camera: Camera) -> Camera:
    """The canonical camera whose image holds all that the input can see of the table, within the bounds on its size."""
    pose = camera.pose
    right, ahead, centre = pose[:3, 0].copy(), pose[:3, 2], pose[:3, 3]
    right[2] = 0
    if ahead[2] > -_STEEPEST or centre[2] <= 0 or np.linalg.norm(right) < 1e-3:
        raise ImageError(
            "the camera does not look down at the table (z = 0) as its pose has it; check world_from_camera in its file"
        )
    right /= np.linalg.norm(right)
    down = np.array([0.0, 0.0, -1.0])
    above = np.eye(4)
    above[:3, :3] = np.stack([right, np.cross(down, right), down], axis=1)
    above[:3, 3] = centre - ahead * centre[2] / ahead[2]
    above[2, 3] = CANONICAL_HEIGHT
    rays = pixel_rays(camera.intrinsics)
    along = [np.linspace(0, side - 1, _BORDER).astype(int) for side in rays.shape[:2]]
    rim = np.concatenate([rays[0, along[1]], rays[-1, along[1]], rays[along[0], 0], rays[along[0], -1]])
    rim = rim @ pose[:3, :3].T.astype(np.float32)
    rim /= np.maximum(-rim[:, 2:], 1e-3)  # a ray above the horizon ends far away, beyond the bounds
    offsets = (rim * centre[2] + centre - above[:3, 3]) @ above[:3, :2] * _DENSITY
    sides = []
    for values, principal in zip(offsets.T, (camera.intrinsics.cx, camera.intrinsics.cy), strict=True):
        low = max(float(np.nanmin(values)), -_MOST_SIZE / 2)
        high = min(float(np.nanmax(values)), _MOST_SIZE / 2)
        lacking = max(_LEAST_SIZE - 1 - (high - low), 0) / 2
        fraction = principal % 1  # keeps pixels on pixels where the input is canonical already
        first = float(np.ceil(lacking - low - fraction - 1e-2) + fraction)
        sides.append((first, min(max(int(np.floor(high + lacking + first + 1e-2)) + 1, _LEAST_SIZE), _MOST_SIZE)))
    (cx, width), (cy, rows) = sides
    return Camera(CameraIntrinsics(FOCAL, FOCAL, cx, cy, width, rows), above)


def _turn(camera: Camera, canvas: Camera) -> tuple[_Turn, NDArray[np.float64]]:
    """The warp to the turned camera, and the pixel (2,) of the canvas that lies straight below the input's camera."""
    k = canvas.intrinsics
    foot = _DENSITY * (camera.pose[:3, 3] - canvas.pose[:3, 3]) @ canvas.pose[:3, :2] + [k.cx, k.cy]
    focal = _DENSITY * camera.pose[2, 3]
    turned_rays = np.array([[1 / focal, 0, -foot[0] / focal], [0, 1 / focal, -foot[1] / focal], [0, 0, 1]])
    input_from_turned = camera.pose[:3, :3].T @ canvas.pose[:3, :3] @ turned_rays
    return _Turn(camera.intrinsics, (k.height, k.width), input_from_turned), foot


def _turned_heights(image: DepthImage, camera: Camera, turn: _Turn) -> NDArray[np.float32]:
    """Heights above the table (H, W), metres, in the turned view; −inf where nothing usable was seen."""
    rays = pixel_rays(camera.intrinsics)
    row = camera.pose[2].astype(np.float32)
    if camera.intrinsics.distortion is None:
        climb = (rays[:1, :, 0] * row[0] + row[2]) + rays[:, :1, 1] * row[1]
    else:
        climb = rays @ row[:3]
    height = climb * image.depth + row[3]
    usable = image.valid & (height < _CEILING)
    heights = np.where(usable, height, np.float32(-np.inf))
    turned = turn.warp(heights, -np.inf)
    distance = camera.pose[2, 3] / -camera.pose[2, 2]
    if _DENSITY * distance / min(camera.intrinsics.fx, camera.intrinsics.fy) > 1.3:
        far, near = cv2.erode(heights, _SQUARE), cv2.dilate(heights, _SQUARE)
        with np.errstate(invalid="ignore"):
            smooth = turn.warp((near - far < _SAME_SURFACE).astype(np.float32), 0.0) > 0
        turned = np.where(smooth, turn.warp(np.where(usable, height, 0).astype(np.float32), -np.inf, True), turned)
    return turned


def _move_raised(
    height: NDArray[np.float32], camera_height: float, foot: NDArray[np.float64], canvas: Camera
) -> NDArray[np.intp]:
    """Move what stands above the table to where the canonical camera sees it, in place.

    Returns:
        Flat indices (2, M) of the moved pixels that stay visible: from, to.
    """
    k = canvas.intrinsics
    flat = height.reshape(-1)
    start = np.flatnonzero(flat > _RAISED)
    raised = flat[start]
    flat[start] = -np.inf
    rows, columns = np.divmod(start, k.width)
    shrink = (
        camera_height - raised
    ) / camera_height  # offsets from the input's camera, at this height, over the table's
    grow = CANONICAL_HEIGHT / (CANONICAL_HEIGHT - raised)
    u = k.cx + grow * (foot[0] - k.cx + shrink * (columns - foot[0]))
    v = k.cy + grow * (foot[1] - k.cy + shrink * (rows - foot[1]))
    columns, rows = np.rint(u).astype(np.intp), np.rint(v).astype(np.intp)
    inside = (columns >= 0) & (columns < k.width) & (rows >= 0) & (rows < k.height)
    target = (rows * k.width + columns)[inside]
    start, raised = start[inside], raised[inside]
    np.maximum.at(flat, target, raised)
    visible = flat[target] == raised
    return np.stack([start[visible], target[visible]])


def _close_gaps(height: NDArray[np.float32], seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Fill gaps of a pixel or two between splatted points, in place, with the lowest beside them; what is seen then."""
    closed = cv2.morphologyEx(seen.view(np.uint8), cv2.MORPH_CLOSE, _SQUARE) > 0
    rows, columns = np.divmod(np.flatnonzero(closed & ~seen), seen.shape[1])
    lowest = np.full(len(rows), np.inf, np.float32)
    for beside in _around(rows, columns, seen.shape):
        np.minimum(lowest, np.where(seen[beside], height[beside], np.inf), out=lowest)
    reached = np.isfinite(lowest)
    closed[rows, columns] = reached
    height[rows[reached], columns[reached]] = lowest[reached]
    return closed


def _close_pits(height: NDArray[np.float32]) -> None:
    """Raise table to what stands around it, in place, where no more than two pixels of it show through.

    Where the input looks under a bulge, the table that it sees there shows between the splatted points of the bulge.
    """
    closed = cv2.morphologyEx(height, cv2.MORPH_CLOSE, _SQUARE).reshape(-1)
    flat = height.reshape(-1)
    deep = np.flatnonzero(closed > flat + _SAME_SURFACE)
    deep = deep[flat[deep] < _RAISED]
    flat[deep] = closed[deep]


def _fill_background(height: NDArray[np.float32], seen: NDArray[np.bool_]) -> None:
    """Give each unseen stretch one height, in place: the lowest on its rim, at least that of the table.

    A shadow lies behind what throws it, and the outside of the view is taken as bare table.
    """
    if seen.all():
        return
    unseen = (~seen).view(np.uint8)
    count, components = cv2.connectedComponents(unseen, connectivity=8, ltype=cv2.CV_32S)
    labels: NDArray[np.int32] = np.asarray(components, np.int32)
    rows, columns = np.divmod(np.flatnonzero((cv2.dilate(unseen, _SQUARE) > 0) & seen), seen.shape[1])
    values = np.maximum(height[rows, columns], np.float32(0))
    lowest = np.full(count, np.inf, np.float32)
    for beside in _around(rows, columns, seen.shape):
        np.minimum.at(lowest, labels[beside], values)
    lowest[lowest < _SAME_SURFACE] = 0
    hidden = np.flatnonzero(unseen)
    height.reshape(-1)[hidden] = lowest[labels.reshape(-1)[hidden]]


def _around(
    rows: NDArray[np.intp], columns: NDArray[np.intp], shape: tuple[int, ...]
) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """The eight neighbours of pixels, those outside of the image moved onto its border."""
    return [
        (np.clip(rows + down, 0, shape[0] - 1), np.clip(columns + right, 0, shape[1] - 1))
        for down in (-1, 0, 1)
        for right in (-1, 0, 1)
        if down or right
    ]
