"""Values of an image at many places at once."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

_MOST_ROWS = 8192
"""OpenCV takes maps of at most 32,767 rows."""


def look_up(
    values: NDArray[np.float32],
    u: NDArray[np.floating],
    v: NDArray[np.floating],
    *,
    outside: float,
    linear: bool = False,
) -> NDArray[np.float32]:
    """Values of an image (H, W) at pixels (u, v), which have one shape (N,) or (N, M).

    Args:
        values: the image, contiguous.
        u: columns.
        v: rows.
        outside: what lies beyond the border.
        linear: interpolate between the four pixels around instead of taking the nearest.

    Returns:
        Of the shape of u and v.
    """
    found = np.empty((len(u), u[0].size if len(u) else 0), np.float32)
    across, down = (places.astype(np.float32, copy=False).reshape(found.shape) for places in (u, v))
    how = cv2.INTER_LINEAR if linear else cv2.INTER_NEAREST
    for start in range(0, len(found), _MOST_ROWS):
        rows = slice(start, start + _MOST_ROWS)
        found[rows] = cv2.remap(
            values, across[rows], down[rows], how, borderMode=cv2.BORDER_CONSTANT, borderValue=outside
        )
    return found.reshape(u.shape)
