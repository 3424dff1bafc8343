"""The truth of the Regression Network: grasp rectangles drawn with their labels (paper section V.B, Fig. 4).

The paper calls a rectangle's "length" a third of the gripper's pixel width and its "width" the whole; which of the two
runs along the closing axis it leaves open, so that is a setting.
"""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.grasp import rectangle_corners

Rectangle = Literal["third_along", "third_across"]
"""`third_along`: a third of the opening along the closing axis, the whole across it; `third_across` the other way."""

Overlap = Literal["larger", "mean"]
"""Where rectangles overlap: `larger` keeps the larger label of good grasps (our reading of the paper); `mean` is the
share of success of all grasps that were tried there, the density that planning's random angles meet."""

_PRIOR = 4.0
"""Failed grasps that are added to every pixel's mean, so that one lucky grasp at the rim is no peak."""

_SHIFT = 4
"""Fractional bits of the corners that OpenCV draws."""


def draw_target(
    shape: tuple[int, int],
    pixels: NDArray[np.floating],
    angles: NDArray[np.floating],
    openings: NDArray[np.floating],
    labels: NDArray[np.floating],
    *,
    rectangle: Rectangle = "third_along",
    least: float = 0.6,
    overlap: Overlap = "larger",
    blur: float = 0.0,
) -> NDArray[np.float32]:
    """Draw the map that the Regression Network shall give.

    Args:
        shape: (H, W) of the image.
        pixels: (G, 2) of the grasps' centres as (u, v).
        angles: (G,) of the closing axes, rad, counter-clockwise as displayed.
        openings: (G,) of the gripper in pixels at each grasp.
        labels: (G,) in [0, 1]; NaN is left out.
        rectangle: how the paper's rectangle is read.
        least: only labels greater than this are drawn, with `larger`; `mean` draws all.
        overlap: what counts where rectangles overlap.
        blur: standard deviation of a Gaussian blur in pixels. Overlapping rectangles of the same label make a plateau,
            on which the best pixel is anywhere; blurred, it lies inside.

    Returns:
        (H, W) in [0, 1], 0 where nothing was drawn.
    """
    drawn = np.flatnonzero(np.isfinite(labels) if overlap == "mean" else labels > least)
    shapes = [_corners(pixels[k], float(angles[k]), float(openings[k]), rectangle) for k in drawn]
    target = _mean(shape, shapes, labels[drawn]) if overlap == "mean" else _larger(shape, shapes, labels[drawn])
    return np.asarray(cv2.GaussianBlur(target, (0, 0), blur)) if blur > 0 else target


def _corners(pixel: NDArray[np.floating], angle: float, opening: float, rectangle: Rectangle) -> NDArray[np.int32]:
    """Corners (4, 2) in OpenCV's fixed point."""
    along, across = (opening / 3, opening) if rectangle == "third_along" else (opening, opening / 3)
    corners = rectangle_corners(float(pixel[0]), float(pixel[1]), angle, along, across)
    return np.rint(corners * (1 << _SHIFT)).astype(np.int32)


def _larger(
    shape: tuple[int, int], shapes: list[NDArray[np.int32]], labels: NDArray[np.floating]
) -> NDArray[np.float32]:
    target = np.zeros(shape, np.float32)
    for index in np.argsort(labels, kind="stable"):
        cv2.fillConvexPoly(target, shapes[index], float(labels[index]), cv2.LINE_8, _SHIFT)
    return target


def _mean(shape: tuple[int, int], shapes: list[NDArray[np.int32]], labels: NDArray[np.floating]) -> NDArray[np.float32]:
    good, tried = np.zeros(shape, np.float32), np.full(shape, _PRIOR, np.float32)
    for corners, label in zip(shapes, labels, strict=True):
        low = np.maximum((corners.min(axis=0) >> _SHIFT) - 1, 0)
        high = np.minimum((corners.max(axis=0) >> _SHIFT) + 2, shape[::-1])
        if (high <= low).any():
            continue
        inside = np.zeros((high[1] - low[1], high[0] - low[0]), np.uint8)
        cv2.fillConvexPoly(inside, corners - (low << _SHIFT), 1, cv2.LINE_8, _SHIFT)
        window = slice(low[1], high[1]), slice(low[0], high[0])
        tried[window] += inside
        if label > 0:
            good[window] += inside * np.float32(label)
    return good / tried
