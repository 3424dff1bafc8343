"""How many distinct grasps there are: planners should return five where as many are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from grasp_core.grasp import Grasp
from grasp_core.planning.candidates import distinct
from grasp_core.planning.image_planner import SearchSettings

FIVE = 5
"""Distinct candidates that a plan should have."""


def count_distinct(grasps: Sequence[Grasp]) -> int:
    """How many of some grasps, best first, a planner with the default settings would have kept as distinct."""
    s, count = SearchSettings(), len(grasps)
    position = np.array([grasp.position for grasp in grasps], float).reshape(count, 3)
    angle = np.array([grasp.angle for grasp in grasps], float)
    return len(distinct(position, angle, np.arange(count), s.least_distance, s.least_angle, count))
