"""What the networks see, in plain numpy, so that planning needs no torch."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import CANONICAL_HEIGHT

HEIGHT_SCALE = 10.0
"""Network units per metre of height: an object of 10 cm stands at 1."""

HEIGHT_RANGE = (-0.05, 0.40)
"""Metres above the table; what lies outside is no graspable object and is clipped."""


def regression_input(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Canonical depth (…, H, W), metres → heights above the table in network units, same shape; empty table is 0."""
    height = np.clip(np.float32(CANONICAL_HEIGHT) - depth, *HEIGHT_RANGE)
    return np.ascontiguousarray(height * HEIGHT_SCALE, dtype=np.float32)
