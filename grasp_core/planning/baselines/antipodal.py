"""The classical rule: two depth edges that face away from each other, within the opening and the friction cone."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.planning.candidates import Batch, make_batch, reachable
from grasp_core.planning.image_planner import Found, ImagePlanner, SearchSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView


class AntipodalSettings(SearchSettings):
    """Settings of antipodal grasps.

    Attributes:
        edges: edge pixels that are drawn and paired with each other.
        friction: coefficient; its cone bounds the angle between the closing axis and both edges' normals.
        least_step: depth over three pixels that makes an edge, metres.
        fill: share of the opening that the pair may fill.
        pairs: best ones that are checked for collisions.
    """

    edges: int = 500
    friction: float = 0.6
    least_step: float = 0.006
    fill: float = 0.9
    pairs: int = 1000

    def __post_init__(self) -> None:
        super().__post_init__()
        self.need_above_0("edges", "friction", "least_step", "fill", "pairs")


class AntipodalPlanner(ImagePlanner[AntipodalSettings]):
    """See `Planner`; it takes some ten milliseconds, whatever the budget.

    A score is how squarely both fingers meet their edges: the product of the two cosines.
    """

    settings_type = AntipodalSettings

    def search(self, view: TableView, stages: Stages, rng: np.random.Generator) -> Found:
        """See `ImagePlanner`."""
        with stages.stage("candidates"):
            batch, scores = self._pairs(view, rng)
            free = reachable(batch, view, self.gripper)
        none = (
            f"fingers or rod would meet what is seen, or what it hides, in all {len(batch)} antipodal pairs of edges"
            if len(batch)
            else "no two depth edges face away from each other within the opening and the friction cone"
        )
        return Found(batch[free], scores[free], none, np.column_stack([batch.u, batch.v]))

    def _pairs(self, view: TableView, rng: np.random.Generator) -> tuple[Batch, NDArray[np.float64]]:
        """Grasps between antipodal edges, best first, and their scores."""
        s = self.settings
        edge_u, edge_v, out, height = self._edges(view, rng)
        one, two = np.triu_indices(len(edge_u), 1)
        along = np.stack([edge_u[two] - edge_u[one], edge_v[two] - edge_v[one]], axis=-1)
        apart = np.linalg.norm(along, axis=1)
        metres = apart * (view.camera.pose[2, 3] - (height[one] + height[two]) / 2) / view.camera.intrinsics.fx
        near = (apart >= 2) & (metres <= s.fill * self.gripper.opening)
        one, two, along = one[near], two[near], along[near] / apart[near, None]
        cos_one, cos_two = -(out[one] * along).sum(axis=1), (out[two] * along).sum(axis=1)
        cone = 1 / np.sqrt(1 + s.friction**2)
        good = np.flatnonzero((cos_one >= cone) & (cos_two >= cone))
        scores = np.clip(cos_one[good] * cos_two[good], 0, 1)
        best = np.argsort(-scores, kind="stable")
        good, scores = good[best], scores[best]
        u, v = (edge_u[one[good]] + edge_u[two[good]]) / 2, (edge_v[one[good]] + edge_v[two[good]]) / 2
        on_it = view.places[np.rint(v).astype(int), np.rint(u).astype(int)]
        good, scores, u, v = (array[on_it][: s.pairs] for array in (good, scores, u, v))
        batch = make_batch(view, u, v, np.arctan2(-along[good, 1], along[good, 0]))
        tips = view.camera.pose[2, 3] - batch.depth
        reached = np.minimum(height[one[good]], height[two[good]]) > tips
        return batch[reached], scores[reached]

    def _edges(self, view: TableView, rng: np.random.Generator) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Drawn edge pixels of the places: u, v, outward unit normals (N, 2), heights of the upper side in metres."""
        s = self.settings
        height = np.float32(view.camera.pose[2, 3]) - view.smooth
        slope_u = cv2.Sobel(height, cv2.CV_32F, 1, 0) / 4
        slope_v = cv2.Sobel(height, cv2.CV_32F, 0, 1) / 4
        step = np.hypot(slope_u, slope_v)
        edge = np.flatnonzero((step >= s.least_step) & view.places)
        edge = rng.permutation(edge)[: s.edges]
        v, u = np.divmod(edge, height.shape[1])
        out = -np.stack([slope_u, slope_v], axis=-1).reshape(-1, 2)[edge] / step.reshape(-1)[edge, None]
        top = cv2.dilate(height, np.ones((3, 3), np.uint8)).reshape(-1)[edge]
        return u.astype(float), v.astype(float), out.astype(float), top.astype(float)
