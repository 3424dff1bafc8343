"""Poses as seven numbers, as they stand in links: x y z (metres), then the quaternion qw qx qy qz."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Vector = tuple[float, float, float, float, float, float, float]
_CLEAR = 5e-3
"""Metres above the table from which on nothing holds an object up: parts may stand off the mesh that is seen."""
_SAME = 0.05
"""Rad between down directions of one stable pose: an object settles a little differently each time."""
_LEVEL = 2e-3
"""Rad between two down directions, and metres between two heights, that count as none."""


def matrix(pose: Vector) -> NDArray[np.float64]:
    """Seven numbers → 4×4."""
    made = np.eye(4)
    made[:3, :3] = Rotation.from_quat(pose[3:], scalar_first=True).as_matrix()
    made[:3, 3] = pose[:3]
    return made


def vector(pose: NDArray[np.float64]) -> Vector:
    """4×4 → seven numbers, to a hundredth of a millimetre and 1e-5."""
    turn = Rotation.from_matrix(pose[:3, :3]).as_quat(scalar_first=True)
    x, y, z = (round(float(value), 5) for value in pose[:3, 3])
    w, a, b, c = (round(float(value), 5) for value in turn)
    return x, y, z, w, a, b, c


def floats(vertices: NDArray[np.float64], pose: NDArray[np.float64]) -> bool:
    """Whether all of a shape (V, 3), metres, put at a pose (4×4) is clearly above the table."""
    return float((vertices @ pose[2, :3]).min() + pose[2, 3]) > _CLEAR


def resting(pose: NDArray[np.float64], stable: Sequence[NDArray[np.float64]]) -> int | None:
    """Which of an object's stable poses (4×4 each) a pose is, anywhere and turned about the vertical; None for none."""
    tilts = [float(np.arccos(np.clip(pose[2, :3] @ other[2, :3], -1, 1))) for other in stable]
    best = int(np.argmin(tilts)) if tilts else 0
    return best if tilts and tilts[best] < _SAME else None


def slid(before: NDArray[np.float64], after: NDArray[np.float64]) -> bool:
    """Whether a pose (4×4) came from another by sliding and turning on the table alone."""
    level = float(np.clip(before[2, :3] @ after[2, :3], -1, 1))
    return bool(np.arccos(level) < _LEVEL and abs(before[2, 3] - after[2, 3]) < _LEVEL)
