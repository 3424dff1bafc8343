"""Exhaustive search: the Refined Network scores every place on a grid with every angle; what the cascade saves."""

from __future__ import annotations

import numpy as np

from grasp_core.planning.candidates import make_batch, reachable
from grasp_core.planning.image_planner import Found, NetworkPlanner, NetworkSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView

_CHUNK = 256
"""Crops that are scored at once."""


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
            batch = make_batch(view, np.repeat(u, s.angles), np.repeat(v, s.angles), np.tile(angles, len(u)))
            free = reachable(batch, view, self.gripper)
        sampled = np.column_stack([u, v])
        if not free.any():
            none = f"fingers or rod would meet what is seen, or what it hides, in all {len(batch)} grasps of the grid"
            return Found(batch[free], np.zeros(0), none, sampled)
        if s.prune:
            batch, free = batch[free], free[free]
        scores = self.judge(batch, view, stages, _CHUNK)
        scores[~free[: len(scores)]] = 0
        none = f"the time was over before any of {len(batch)} grasps was scored"
        return Found(batch[: len(scores)], scores, none, sampled)
