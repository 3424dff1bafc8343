"""The lowest floor: random grasps on the things that were seen, as long as the gripper reaches them."""

from __future__ import annotations

import numpy as np

from grasp_core.planning.candidates import make_batch, reachable
from grasp_core.planning.image_planner import Found, ImagePlanner, SearchSettings
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView


class RandomSettings(SearchSettings):
    """Settings of random grasps.

    Attributes:
        drawn: pixel and angle pairs that are drawn.
    """

    drawn: int = 256

    def __post_init__(self) -> None:
        super().__post_init__()
        self.need_above_0("drawn")


class RandomPlanner(ImagePlanner[RandomSettings]):
    """See `Planner`; it takes a few milliseconds, whatever the budget. All scores are 0.5: it has no opinion."""

    settings_type = RandomSettings

    def search(self, view: TableView, stages: Stages, rng: np.random.Generator) -> Found:
        """See `ImagePlanner`."""
        drawn = self.settings.drawn
        with stages.stage("candidates"):
            v, u = np.divmod(rng.choice(np.flatnonzero(view.places), drawn), view.places.shape[1])
            batch = make_batch(view, u, v, rng.uniform(-np.pi / 2, np.pi / 2, drawn))
            batch = batch[reachable(batch, view, self.gripper)]
        none = f"fingers or rod would meet what is seen, or what it hides, in all {drawn} drawn grasps"
        return Found(batch, np.full(len(batch), 0.5), none, np.column_stack([u, v]).astype(float))
