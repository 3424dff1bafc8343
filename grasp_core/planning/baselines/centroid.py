"""A rule of thumb: grasp each thing at its centroid, closing along its shorter axis."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.gripper import Gripper
from grasp_core.networks.runtime import Runtime
from grasp_core.planning.candidates import make_batch, reachable, to_candidates
from grasp_core.planning.planner import Plan
from grasp_core.planning.result import begin, finish
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import ViewSettings


class CentroidSettings(config.Settings):
    """Settings of centroid grasps.

    Attributes:
        candidates: at most returned.
        view: what may be grasped.
    """

    candidates: int = 10
    view: ViewSettings = ViewSettings()

    def __post_init__(self) -> None:
        if self.candidates < 1:
            raise ValueError(f"candidates must be at least 1, not {self.candidates}")


class CentroidPlanner:
    """See `Planner`. A score is the thing's share of all that was seen; closing along the longer axis scores half."""

    settings_type = CentroidSettings

    def __init__(self, gripper: Gripper, settings: CentroidSettings | None = None) -> None:
        self.gripper = gripper
        self.settings = settings or CentroidSettings()

    @classmethod
    def make(
        cls, settings: CentroidSettings, gripper: Gripper, *, weights: str | Path, runtime: Runtime | None
    ) -> CentroidPlanner:
        """The planner; it needs no weights."""
        return cls(gripper, settings)

    def __call__(
        self,
        image: DepthImage,
        *,
        mask: NDArray[np.bool_] | None = None,
        budget_ms: float | None = None,
        rng: np.random.Generator,
    ) -> Plan:
        """See `Planner`; nothing in it is random, and it takes a few milliseconds, whatever the budget."""
        s, stages = self.settings, Stages(budget_ms)
        view = begin(image, mask, s.view, stages)
        if isinstance(view, Plan):
            return view
        with stages.stage("candidates"):
            u, v, angle, scores = _axes(view.places)
            batch = make_batch(view, u, v, angle)
            free = np.flatnonzero(reachable(batch, view, self.gripper))
            best = free[np.argsort(-scores[free], kind="stable")][: s.candidates]
        with stages.stage("output"):
            found = to_candidates(batch[best], scores[best], np.zeros(len(best)), view, self.gripper)
        reason = None if found else "fingers or rod would meet what is seen at the centroids of all things"
        return finish(view, None, None, [np.column_stack([u, v])], found, found, reason, stages)


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
