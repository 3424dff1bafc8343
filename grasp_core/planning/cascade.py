"""The cascaded planner: the Regression Network finds a region, the Refined Network judges grasps in it (Fig. 1)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.gripper import Gripper
from grasp_core.networks.inputs import regression_input
from grasp_core.networks.runtime import Runtime, load_runtime
from grasp_core.planning.candidates import (
    Batch,
    best_region,
    distinct,
    make_batch,
    reachable,
    sample_pixels,
    spread_angles,
    to_candidates,
)
from grasp_core.planning.crops import crops
from grasp_core.planning.planner import Candidate, Plan
from grasp_core.planning.result import begin, finish
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView, ViewSettings

_CHUNK = 16
"""Crops that are scored at once when time is limited."""


class CascadeSettings(config.Settings):
    """Settings of the cascade.

    Attributes:
        pixels: m, sampled in a region.
        angles: tried at each pixel, evenly spread over half a turn.
        scored: grasps that the Refined Network judges in a region, of those that the gripper can reach.
        radius: R_i, in gripper openings.
        threshold: t, the least score of a candidate.
        candidates: n, at most returned.
        regions: tried at most, one after the other, until one holds a candidate.
        least_distance: between two candidates, metres, unless their angles differ.
        least_angle: between two candidates, rad, unless their positions differ.
        view: what may be grasped.
    """

    pixels: int = 64
    angles: int = 12
    scored: int = 64
    radius: float = 1 / 3
    threshold: float = 0.5
    candidates: int = 10
    regions: int = 3
    least_distance: float = 0.01
    least_angle: float = 0.26
    view: ViewSettings = ViewSettings()

    def __post_init__(self) -> None:
        for name in ("pixels", "angles", "scored", "candidates", "regions"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, not {getattr(self, name)}")
        if self.radius <= 0 or not 0 <= self.threshold <= 1:
            raise ValueError(
                f"radius must be above 0 and threshold from 0 to 1, not {self.radius} and {self.threshold}"
            )


class CascadePlanner:
    """See `Planner`.

    Attributes:
        runtime: both networks.
        gripper: whose grasps are planned.
        settings: see `CascadeSettings`.
    """

    settings_type = CascadeSettings

    def __init__(self, runtime: Runtime, gripper: Gripper, settings: CascadeSettings | None = None) -> None:
        """Put a planner together.

        Raises:
            MismatchError: the weights are for another gripper or view.
        """
        runtime.meta.check(gripper)
        self.runtime = runtime
        self.gripper = gripper
        self.settings = settings or CascadeSettings()

    @classmethod
    def make(
        cls, settings: CascadeSettings, gripper: Gripper, *, weights: str | Path, runtime: Runtime | None
    ) -> CascadePlanner:
        """The planner, with weights loaded unless there is a runtime."""
        return cls(runtime or load_runtime(weights), gripper, settings)

    def __call__(
        self,
        image: DepthImage,
        *,
        mask: NDArray[np.bool_] | None = None,
        budget_ms: float | None = None,
        rng: np.random.Generator,
    ) -> Plan:
        """See `Planner`."""
        s = self.settings
        stages = Stages(budget_ms)
        weights = f"{self.runtime.meta.name} {self.runtime.digest}"
        view = begin(image, mask, s.view, stages, weights)
        if isinstance(view, Plan):
            return view
        with stages.stage("quality map"):
            heat = np.zeros(view.places.shape, np.float32)
            heat[view.core] = self.runtime.quality_map(regression_input(view.depth[view.core])[None])[0]
        search = _Search(view, heat)
        for batch in self._regions(search, stages, rng):
            with stages.stage("crops"):
                seen = crops(
                    view.depth,
                    view.camera,
                    batch.u,
                    batch.v,
                    batch.angle,
                    batch.depth,
                    self.runtime.meta.crop,
                    self.gripper.opening,
                )
            with stages.stage("scores"):
                scores = self._score(seen, stages, budget_ms is not None)
            search.add(batch, scores)
            if (scores >= s.threshold).any():
                break
        with stages.stage("output"):
            chosen, scored, reason = self._choose(search)
        return finish(view, heat, search.region, search.sampled, chosen, scored, reason, stages, weights)

    def _regions(self, search: _Search, stages: Stages, rng: np.random.Generator) -> Iterator[Batch]:
        """What to score in the best region, then in the next best, while there is time; empty regions are passed."""
        s = self.settings
        radius = s.radius * self.gripper.opening * search.view.camera.intrinsics.fx / search.view.camera.pose[2, 3]
        left = search.view.places.copy()
        tried = 0
        started = stages.elapsed_ms
        while tried < s.regions and (tried == 0 or stages.allows((stages.elapsed_ms - started) / tried)):
            with stages.stage("candidates"):
                found = best_region(search.heat, left, radius)
                if found is None:
                    return
                u, v, region = found
                left &= ~region
                search.region = (u, v, radius)
                batch = self._sample(search, region, rng)
            tried += 1
            if len(batch):
                yield batch

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

    def _score(self, seen: NDArray[np.float32], stages: Stages, limited: bool) -> NDArray[np.float32]:
        """P(class 1) (N,) of crops; −1 for those that there was no time for."""
        if not limited:
            return self.runtime.scores(seen)
        scores = np.full(len(seen), -1, np.float32)
        last = 0.0
        for start in range(0, len(seen), _CHUNK):
            if start and not stages.allows(last):
                break
            before = stages.elapsed_ms
            scores[start : start + _CHUNK] = self.runtime.scores(seen[start : start + _CHUNK])
            last = stages.elapsed_ms - before
        return scores

    def _choose(self, search: _Search) -> tuple[tuple[Candidate, ...], tuple[Candidate, ...], str | None]:
        """The candidates, all that was scored, and why there are no candidates."""
        s = self.settings
        if not search.batches:
            reason = f"fingers or rod would meet what is seen in all {search.tried} sampled grasps"
            return (), (), reason
        batch = Batch.join(search.batches)
        scores = np.concatenate(search.scores)
        heats = search.heat[batch.v.astype(int), batch.u.astype(int)]
        order = np.lexsort((-heats, -scores))
        order = order[scores[order] >= 0]
        scored = to_candidates(batch[order], scores[order], heats[order], search.view, self.gripper)
        good = np.flatnonzero(scores[order] >= s.threshold)
        chosen = distinct(batch[order], good, s.least_distance, s.least_angle, s.candidates)
        if len(chosen):
            return tuple(scored[i] for i in chosen), scored, None
        best = scored[0].score
        return (), scored, f"all {len(scored)} scored grasps are below t = {s.threshold:g}; the best has {best:.3f}"


class _Search:
    """What one call has looked at so far."""

    def __init__(self, view: TableView, heat: NDArray[np.float32]) -> None:
        self.view = view
        self.heat = heat
        self.region: tuple[float, float, float] | None = None
        self.sampled: list[NDArray[np.float64]] = []
        self.batches: list[Batch] = []
        self.scores: list[NDArray[np.float32]] = []
        self.tried = 0

    def add(self, batch: Batch, scores: NDArray[np.float32]) -> None:
        self.batches.append(batch)
        self.scores.append(scores)
