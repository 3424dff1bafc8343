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
) -> NDArray[np.float32]:
    """Draw the map that the Regression Network shall give.

    Args:
        shape: (H, W) of the image.
        pixels: (G, 2) of the grasps' centres as (u, v).
        angles: (G,) of the closing axes, rad, counter-clockwise as displayed.
        openings: (G,) of the gripper in pixels at each grasp.
        labels: (G,) in [0, 1]; NaN is left out.
        rectangle: how the paper's rectangle is read.
        least: only labels greater than this are drawn.

    Returns:
        (H, W): the label inside each rectangle, the larger one where they overlap, 0 elsewhere.
    """
    target = np.zeros(shape, np.float32)
    drawn = np.flatnonzero(labels > least)
    for index in drawn[np.argsort(labels[drawn], kind="stable")]:
        opening = float(openings[index])
        along, across = (opening / 3, opening) if rectangle == "third_along" else (opening, opening / 3)
        u, v = map(float, pixels[index])
        corners = rectangle_corners(u, v, float(angles[index]), along, across)
        fixed = np.rint(corners * (1 << _SHIFT)).astype(np.int32)
        cv2.fillConvexPoly(target, fixed, float(labels[index]), cv2.LINE_8, _SHIFT)
    return target
