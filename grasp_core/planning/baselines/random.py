"""The lowest floor: random grasps on the things that were seen, as long as the gripper reaches them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.gripper import Gripper
from grasp_core.networks.runtime import Runtime
from grasp_core.planning.candidates import distinct, make_batch, reachable, to_candidates
from grasp_core.planning.planner import Plan
from grasp_core.planning.result import begin, finish
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import ViewSettings


class RandomSettings(config.Settings):
    """Settings of random grasps.

    Attributes:
        drawn: pixel and angle pairs that are drawn.
        candidates: at most returned.
        least_distance: between two candidates, metres, unless their angles differ.
        least_angle: between two candidates, rad, unless their positions differ.
        view: what may be grasped.
    """

    drawn: int = 256
    candidates: int = 10
    least_distance: float = 0.01
    least_angle: float = 0.26
    view: ViewSettings = ViewSettings()

    def __post_init__(self) -> None:
        if self.drawn < 1 or self.candidates < 1:
            raise ValueError(f"drawn and candidates must be at least 1, not {self.drawn} and {self.candidates}")


class RandomPlanner:
    """See `Planner`. All scores are 0.5: it has no opinion."""

    settings_type = RandomSettings

    def __init__(self, gripper: Gripper, settings: RandomSettings | None = None) -> None:
        self.gripper = gripper
        self.settings = settings or RandomSettings()

    @classmethod
    def make(
        cls, settings: RandomSettings, gripper: Gripper, *, weights: str | Path, runtime: Runtime | None
    ) -> RandomPlanner:
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
        """See `Planner`; it takes a few milliseconds, whatever the budget."""
        s, stages = self.settings, Stages(budget_ms)
        view = begin(image, mask, s.view, stages)
        if isinstance(view, Plan):
            return view
        with stages.stage("candidates"):
            v, u = np.divmod(rng.choice(np.flatnonzero(view.places), s.drawn), view.places.shape[1])
            batch = make_batch(view, u, v, rng.uniform(-np.pi / 2, np.pi / 2, s.drawn))
            free = np.flatnonzero(reachable(batch, view, self.gripper))
            chosen = batch[distinct(batch, free, s.least_distance, s.least_angle, s.candidates)]
        with stages.stage("output"):
            found = to_candidates(chosen, np.full(len(chosen), 0.5), np.zeros(len(chosen)), view, self.gripper)
        reason = None if found else f"fingers or rod would meet what is seen in all {s.drawn} drawn grasps"
        return finish(view, None, None, [np.column_stack([u, v]).astype(float)], found, found, reason, stages)
