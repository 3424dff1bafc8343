"""The cascaded planner: the Regression Network finds a region, the Refined Network judges grasps in it (Fig. 1)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from grasp_core.networks.inputs import regression_input
from grasp_core.planning.baselines.antipodal import AntipodalPlanner
from grasp_core.planning.candidates import (
    Batch,
    best_region,
    distinct,
    make_batch,
    reachable,
    sample_pixels,
    spread_angles,
)
from grasp_core.planning.image_planner import Found, NetworkPlanner, NetworkSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView

_CHUNK = 16
"""Crops that are scored at once when time is limited."""
_PAIRS_MS = 20.0
"""Milliseconds, about, that pairing edges takes; it cannot be cut short."""
_NEIGHBOURS = 8
"""Grasps drawn around each of the best ones."""
_TRIES = 3
"""Times as many are drawn, since the gripper does not reach all of them."""
_NEAR_PIXELS = 3.0
"""Canvas pixels, 4 mm: standard deviation of the draw along u and v; about that of executed poses."""
_NEAR_ANGLE = 0.14
"""Rad, 8 degrees: standard deviation of the draw of angles; samples are up to 15 degrees apart."""


class CascadeSettings(NetworkSettings):
    """Settings of the cascade.

    Attributes:
        pixels: m, sampled in a region.
        angles: tried at each pixel, evenly spread over half a turn.
        scored: grasps that the Refined Network judges in a region, of those that the gripper can reach.
        polished: further grasps that it judges, drawn around the best ones of the region; 0 draws none.
        radius: R_i, in gripper openings.
        regions: batches that are judged at most, each in the next best region.
        enough: distinct candidates above t after which nothing further is tried.
        paired: grasps between antipodal edges of the depth image that are judged where the regions yielded too few; 0
            judges none.
    """

    pixels: int = 64
    angles: int = 12
    scored: int = 64
    polished: int = 64
    radius: float = 1 / 3
    regions: int = 4
    enough: int = 5
    paired: int = 64

    def __post_init__(self) -> None:
        super().__post_init__()
        self.need_above_0("pixels", "angles", "scored", "radius", "regions", "enough")
        if self.polished < 0 or self.paired < 0:
            raise ValueError(f"polished and paired must be at least 0, not {self.polished} and {self.paired}")


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
        for batch in chain(self._regions(search, stages, rng), self._pairs(search, stages, rng)):
            scores = self._judge(search, batch, stages)
            with stages.stage("candidates"):
                around = self._around(search, batch[: len(scores)], scores, rng)
            self._judge(search, around, stages)
            if self._enough(search):
                break
        batch, scores = search.scored
        none = (
            f"fingers or rod would meet what is seen, or what it hides, in all {search.tried} sampled grasps"
            if search.tried and not search.regions
            else "the time was over before any grasp was scored"
        )
        sampled = np.concatenate([*search.sampled, np.zeros((0, 2))])
        return Found(batch, scores, none, sampled, search.heat, search.region)

    def _judge(self, search: _Search, batch: Batch, stages: Stages) -> NDArray[np.float32]:
        """Score a batch as far as there is time and keep it with its scores."""
        scores = self.judge(batch, search.view, stages, _CHUNK if stages.limited else max(len(batch), 1))
        search.batches.append(batch[: len(scores)])
        search.scores.append(scores)
        return scores

    def _regions(self, search: _Search, stages: Stages, rng: np.random.Generator) -> Iterator[Batch]:
        """What to score in the best region, then in the next best, and so on, while there is time.

        Regions in which the gripper reaches nothing are passed over. When all places have been in a region it begins
        anew with the best one, where other pixels and angles are drawn.
        """
        s = self.settings
        radius = s.radius * self.gripper.opening * search.view.camera.intrinsics.fx / search.view.camera.pose[2, 3]
        for _ in range(s.regions):
            left = search.view.places.copy()
            while search.regions < s.regions and stages.allows(0):
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
                    search.regions += 1
                    yield batch
            if not search.regions:
                return

    def _pairs(self, search: _Search, stages: Stages, rng: np.random.Generator) -> Iterator[Batch]:
        """Antipodal pairs of edges anywhere: what is small on something big lies outside of hot regions."""
        if self.settings.paired and stages.allows(_PAIRS_MS):
            found = AntipodalPlanner(self.gripper).search(search.view, stages, rng)
            search.tried += len(found.sampled)
            if len(found.batch):
                yield found.batch[rng.permutation(len(found.batch))[: self.settings.paired]]

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

    def _around(self, search: _Search, batch: Batch, scores: NDArray[np.float32], rng: np.random.Generator) -> Batch:
        """Reachable grasps near the best ones: the best of a few dozen at random angles is seldom the best there is."""
        count = self.settings.polished
        best = np.argsort(-scores, kind="stable")[: max(1, count // _NEIGHBOURS)]
        best = np.repeat(best[: len(batch)], _TRIES * _NEIGHBOURS if count else 0)
        rng.shuffle(best)
        height, width = search.view.places.shape
        u = np.clip(batch.u[best] + rng.normal(0, _NEAR_PIXELS, len(best)), 0, width - 1)
        v = np.clip(batch.v[best] + rng.normal(0, _NEAR_PIXELS, len(best)), 0, height - 1)
        on = search.view.places[np.rint(v).astype(int), np.rint(u).astype(int)]
        near = make_batch(search.view, u[on], v[on], (batch.angle[best] + rng.normal(0, _NEAR_ANGLE, len(best)))[on])
        return near[np.flatnonzero(reachable(near, search.view, self.gripper))[:count]]

    def _enough(self, search: _Search) -> bool:
        """Whether as many distinct candidates are above t as end the search."""
        s = self.settings
        batch, scores = search.scored
        order = np.argsort(-scores, kind="stable")
        good = order[scores[order] >= s.threshold]
        found = distinct(batch.position, batch.angle, good, s.least_distance, s.least_angle, s.enough)
        return len(found) >= min(s.enough, s.candidates)


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
        self.regions = 0

    @property
    def scored(self) -> tuple[Batch, NDArray[np.float32]]:
        """All that was scored."""
        if not self.batches:
            return make_batch(self.view, [], [], []), np.zeros(0, np.float32)
        return Batch.join(self.batches), np.concatenate(self.scores)
