"""Exhaustive search: the Refined Network scores every place on a grid with every angle; what the cascade saves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from grasp_core.planning.candidates import Batch, make_batch, reachable
from grasp_core.planning.image_planner import Found, NetworkPlanner, NetworkSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView

_CHUNK = 256
"""Crops that are scored at once."""
_SHORT = 32
"""Grasps of the grid that are looked at in one go when time is limited."""


class ExhaustiveSettings(NetworkSettings):
    """Settings of the exhaustive search.

    Attributes:
        stride: between places, canvas pixels, along rows and columns.
        angles: tried at each place, evenly spread over half a turn.
        prune: whether grasps that the gripper cannot reach are dropped before they are scored, as the cascade does. A
            search that knows nothing but the network scores them all and drops them afterwards.
    """

    stride: int = 4
    angles: int = 18
    prune: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        self.need_above_0("stride", "angles")


class ExhaustivePlanner(NetworkPlanner[ExhaustiveSettings]):
    """See `Planner`; nothing here is random, and a budget ends the search before the chunk that would overrun it.

    Grasps that the gripper cannot reach have the score 0.
    """

    settings_type = ExhaustiveSettings

    def search(self, view: TableView, stages: Stages, rng: np.random.Generator) -> Found:
        """See `ImagePlanner`."""
        s = self.settings
        with stages.stage("candidates"):
            v, u = np.nonzero(view.places)
            on_grid = (u % s.stride == 0) & (v % s.stride == 0)
            u, v = u[on_grid].astype(float), v[on_grid].astype(float)
            angles = np.arange(s.angles) * np.pi / s.angles - np.pi / 2
            sampled = np.column_stack([u, v])
            u, v, angle = np.repeat(u, s.angles), np.repeat(v, s.angles), np.tile(angles, len(u))
        part = _SHORT if stages.limited else max(len(u), 1)
        batches: list[Batch] = []
        scores: list[NDArray[np.float32]] = []
        tried = 0
        for start in range(0, len(u), part):
            if not stages.allows(stages.step_ms):
                break
            before, some = stages.elapsed_ms, slice(start, start + part)
            with stages.stage("candidates"):
                batch = make_batch(view, u[some], v[some], angle[some])
                free = reachable(batch, view, self.gripper)
            tried += len(batch)
            if s.prune or not free.any():
                batch, free = batch[free], free[free]
            found = self.judge(batch, view, stages, _CHUNK)
            found[~free[: len(found)]] = 0
            batches.append(batch[: len(found)])
            scores.append(found)
            stages.step_ms = max(stages.step_ms, stages.elapsed_ms - before)
        none = (
            f"fingers or rod would meet what is seen, or what it hides, in all {tried} grasps of the grid"
            if tried == len(u)
            else f"the time was over before any of {len(u)} grasps was scored"
        )
        whole = Batch.join(batches) if batches else make_batch(view, [], [], [])
        return Found(whole, np.concatenate([*scores, np.zeros(0, np.float32)]), none, sampled)
