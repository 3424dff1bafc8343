"""The cascaded planner: the Regression Network finds a region, the Refined Network judges grasps in it (Fig. 1)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from grasp_core.networks.inputs import regression_input
from grasp_core.planning.candidates import (
    Batch,
    best_region,
    distinct,
    make_batch,
    reachable,
    sample_pixels,
    spread_angles,
)
from grasp_core.planning.image_planner import Found, NetworkPlanner, SearchSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView

_CHUNK = 16
"""Crops that are scored at once when time is limited."""


class CascadeSettings(SearchSettings):
    """Settings of the cascade.

    Attributes:
        pixels: m, sampled in a region.
        angles: tried at each pixel, evenly spread over half a turn.
        scored: grasps that the Refined Network judges in a region, of those that the gripper can reach.
        radius: R_i, in gripper openings.
        regions: batches that are judged at most, each in the next best region.
        enough: distinct candidates above t after which no further region is tried.
    """

    threshold: float = 0.5
    pixels: int = 64
    angles: int = 12
    scored: int = 64
    radius: float = 1 / 3
    regions: int = 4
    enough: int = 5

    def __post_init__(self) -> None:
        super().__post_init__()
        self.need_above_0("pixels", "angles", "scored", "radius", "regions", "enough")


class CascadePlanner(NetworkPlanner[CascadeSettings]):
    """See `Planner`; a budget ends the search before the step that would overrun it, as far as steps are foreseen."""

    settings_type = CascadeSettings

    def search(self, view: TableView, stages: Stages, rng: np.random.Generator) -> Found:
        """See `ImagePlanner`."""
        search = _Search(view)
        if stages.allows(0):
            with stages.stage("quality map"):
                seen = regression_input(view.depth[view.core])
                search.heat[view.core] = self.runtime.quality_map(seen[None])[0]
        for batch in self._regions(search, stages, rng):
            scores = self.judge(batch, view, stages, _CHUNK if stages.limited else len(batch))
            search.batches.append(batch[: len(scores)])
            search.scores.append(scores)
            if self._enough(search):
                break
        batch, scores = search.scored
        none = (
            f"fingers or rod would meet what is seen, or what it hides, in all {search.tried} sampled grasps"
            if search.tried and not search.batches
            else "the time was over before any grasp was scored"
        )
        sampled = np.concatenate([*search.sampled, np.zeros((0, 2))])
        return Found(batch, scores, none, sampled, search.heat, search.region)

    def _regions(self, search: _Search, stages: Stages, rng: np.random.Generator) -> Iterator[Batch]:
        """What to score in the best region, then in the next best, and so on, while there is time.

        Regions in which the gripper reaches nothing are passed over. When all places have been in a region it begins
        anew with the best one, where other pixels and angles are drawn.
        """
        s = self.settings
        radius = s.radius * self.gripper.opening * search.view.camera.intrinsics.fx / search.view.camera.pose[2, 3]
        for _ in range(s.regions):
            left = search.view.places.copy()
            while len(search.batches) < s.regions and stages.allows(0):
                with stages.stage("candidates"):
                    found = best_region(search.heat, left, radius)
                    if found is None:
                        break
                    u, v, region = found
                    left &= ~region
                    batch = self._sample(search, region, rng)
                if len(batch) or search.region is None:
                    search.region = (u, v, radius)
                if len(batch):
                    yield batch
            if not search.batches:
                return

    def _sample(self, search: _Search, region: NDArray[np.bool_], rng: np.random.Generator) -> Batch:
        """Reachable grasps in a region: first one angle of every pixel, then a second one, up to the number scored."""
        s = self.settings
        u, v = sample_pixels(search.heat, region, s.pixels, rng)
        search.sampled.append(np.column_stack([u, v]))
        angles = spread_angles(len(u), s.angles, rng)
        batch = make_batch(search.view, np.repeat(u, s.angles), np.repeat(v, s.angles), angles.reshape(-1))
        free = reachable(batch, search.view, self.gripper).reshape(angles.shape)
        search.tried += free.size
        turn = np.where(free, np.cumsum(free, axis=1), s.angles + 1).reshape(-1)
        first = np.argsort(turn, kind="stable")[: s.scored]
        return batch[first[turn[first] <= s.angles]]

    def _enough(self, search: _Search) -> bool:
        """Whether as many distinct candidates are above t as end the search."""
        s = self.settings
        batch, scores = search.scored
        order = np.argsort(-scores, kind="stable")
        good = order[scores[order] >= s.threshold]
        return len(distinct(batch, good, s.least_distance, s.least_angle, s.enough)) >= min(s.enough, s.candidates)


class _Search:
    """What one call has looked at so far."""

    def __init__(self, view: TableView) -> None:
        self.view = view
        self.heat = np.zeros(view.places.shape, np.float32)
        self.region: tuple[float, float, float] | None = None
        self.sampled: list[NDArray[np.float64]] = []
        self.batches: list[Batch] = []
        self.scores: list[NDArray[np.float32]] = []
        self.tried = 0

    @property
    def scored(self) -> tuple[Batch, NDArray[np.float32]]:
        """All that was scored."""
        if not self.batches:
            return make_batch(self.view, [], [], []), np.zeros(0, np.float32)
        return Batch.join(self.batches), np.concatenate(self.scores)
