"""Exhaustive search: the Refined Network scores every place on a grid with every angle; what the cascade saves."""

from __future__ import annotations

import numpy as np

from grasp_core.planning.candidates import make_batch, reachable
from grasp_core.planning.image_planner import Found, NetworkPlanner, SearchSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView

_CHUNK = 256
"""Crops that are scored at once."""


class ExhaustiveSettings(SearchSettings):
    """Settings of the exhaustive search.

    Attributes:
        stride: between places, canvas pixels, along rows and columns.
        angles: tried at each place, evenly spread over half a turn.
    """

    threshold: float = 0.5
    stride: int = 4
    angles: int = 18

    def __post_init__(self) -> None:
        super().__post_init__()
        self.need_above_0("stride", "angles")


class ExhaustivePlanner(NetworkPlanner[ExhaustiveSettings]):
    """See `Planner`; nothing here is random, and a budget ends the search with the chunk that would overrun it."""

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
            tried = len(batch)
            batch = batch[reachable(batch, view, self.gripper)]
        scores = self.judge(batch, view, stages, _CHUNK)
        none = (
            f"the time was over before any of {len(batch)} grasps was scored"
            if len(batch)
            else f"fingers or rod would meet what is seen, or what it hides, in all {tried} grasps of the grid"
        )
        return Found(batch[: len(scores)], scores, none, np.column_stack([u, v]))
