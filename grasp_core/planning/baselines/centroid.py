"""A rule of thumb: grasp each thing at its centroid, closing along its shorter axis."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.planning.candidates import make_batch, reachable
from grasp_core.planning.image_planner import Found, ImagePlanner, SearchSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView


class CentroidSettings(SearchSettings):
    """Settings of centroid grasps: those of every search."""


class CentroidPlanner(ImagePlanner[CentroidSettings]):
    """See `Planner`; nothing in it is random, and it takes a few milliseconds, whatever the budget.

    A score is the thing's share of all that was seen; closing along the longer axis scores half.
    """

    settings_type = CentroidSettings

    def search(self, view: TableView, stages: Stages, rng: np.random.Generator) -> Found:
        """See `ImagePlanner`."""
        with stages.stage("candidates"):
            u, v, angle, scores = _axes(view.places)
            batch = make_batch(view, u, v, angle)
            free = reachable(batch, view, self.gripper)
        none = "fingers or rod would meet what is seen, or what it hides, at the centroids of all things"
        return Found(batch[free], scores[free], none, np.column_stack([u, v]))


def _axes(places: NDArray[np.bool_]) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Centroids u, v, angles and scores, each (2·things,): of every thing the shorter axis, then the longer one."""
    count, components = cv2.connectedComponents(places.view(np.uint8), connectivity=8)
    labels: NDArray[np.int32] = np.asarray(components, np.int32)
    rows = []
    for thing in range(1, count):
        v, u = np.nonzero(labels == thing)
        centre = np.array([u.mean(), v.mean()])
        spread = np.cov(np.stack([u, -v])) if len(u) > 1 else np.eye(2)
        _, axes = np.linalg.eigh(spread)  # smallest first
        on_it = int(np.argmin((u - centre[0]) ** 2 + (v - centre[1]) ** 2))
        share = len(u) / places.sum()
        for axis, score in ((axes[:, 0], share), (axes[:, 1], share / 2)):
            rows.append((u[on_it], v[on_it], np.arctan2(axis[1], axis[0]), score))
    table = np.array(rows, float)
    return table[:, 0], table[:, 1], table[:, 2], table[:, 3]
