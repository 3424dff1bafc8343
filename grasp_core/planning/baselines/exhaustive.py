"""Exhaustive search: the Refined Network scores every place on a grid with every angle; what the cascade saves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.gripper import Gripper
from grasp_core.networks.runtime import Runtime, load_runtime
from grasp_core.planning.candidates import distinct, make_batch, reachable, to_candidates
from grasp_core.planning.crops import crops
from grasp_core.planning.planner import Plan
from grasp_core.planning.result import begin, finish
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import ViewSettings

_CHUNK = 256
"""Crops that are scored at once."""


class ExhaustiveSettings(config.Settings):
    """Settings of the exhaustive search.

    Attributes:
        stride: between places, canvas pixels, along rows and columns.
        angles: tried at each place, evenly spread over half a turn.
        threshold: t, the least score of a candidate.
        candidates: n, at most returned.
        least_distance: between two candidates, metres, unless their angles differ.
        least_angle: between two candidates, rad, unless their positions differ.
        view: what may be grasped.
    """

    stride: int = 4
    angles: int = 18
    threshold: float = 0.5
    candidates: int = 10
    least_distance: float = 0.01
    least_angle: float = 0.26
    view: ViewSettings = ViewSettings()

    def __post_init__(self) -> None:
        for name in ("stride", "angles", "candidates"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, not {getattr(self, name)}")
        if not 0 <= self.threshold <= 1:
            raise ValueError(f"threshold is from 0 to 1, not {self.threshold}")


class ExhaustivePlanner:
    """See `Planner`; a budget ends the search after the chunk that uses it up."""

    settings_type = ExhaustiveSettings

    def __init__(self, runtime: Runtime, gripper: Gripper, settings: ExhaustiveSettings | None = None) -> None:
        """Put a planner together.

        Raises:
            MismatchError: the weights are for another gripper or view.
        """
        runtime.meta.check(gripper)
        self.runtime = runtime
        self.gripper = gripper
        self.settings = settings or ExhaustiveSettings()

    @classmethod
    def make(
        cls, settings: ExhaustiveSettings, gripper: Gripper, *, weights: str | Path, runtime: Runtime | None
    ) -> ExhaustivePlanner:
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
        """See `Planner`; nothing here is random."""
        s = self.settings
        stages = Stages(budget_ms)
        weights = f"{self.runtime.meta.name} {self.runtime.digest}"
        view = begin(image, mask, s.view, stages, weights)
        if isinstance(view, Plan):
            return view
        with stages.stage("candidates"):
            v, u = np.nonzero(view.places)
            on_grid = (u % s.stride == 0) & (v % s.stride == 0)
            u, v = u[on_grid].astype(float), v[on_grid].astype(float)
            angles = np.arange(s.angles) * np.pi / s.angles - np.pi / 2
            batch = make_batch(view, np.repeat(u, s.angles), np.repeat(v, s.angles), np.tile(angles, len(u)))
            tried = len(batch)
            batch = batch[reachable(batch, view, self.gripper)]
        scores = np.full(len(batch), -1, np.float32)
        for start in range(0, len(batch), _CHUNK):
            if start and not stages.allows(0):
                break
            part = batch[start : start + _CHUNK]
            with stages.stage("crops"):
                seen = crops(
                    view.depth,
                    view.camera,
                    part.u,
                    part.v,
                    part.angle,
                    part.depth,
                    self.runtime.meta.crop,
                    self.gripper.opening,
                )
            with stages.stage("scores"):
                scores[start : start + _CHUNK] = self.runtime.scores(seen)
        with stages.stage("output"):
            order = np.argsort(-scores, kind="stable")
            order = order[scores[order] >= 0]
            scored = to_candidates(batch[order], scores[order], np.zeros(len(order)), view, self.gripper)
            good = np.flatnonzero(scores[order] >= s.threshold)
            chosen = distinct(batch[order], good, s.least_distance, s.least_angle, s.candidates)
            reason = None
            if not len(order):
                reason = f"fingers or rod would meet what is seen in all {tried} grasps of the grid"
            elif not len(chosen):
                reason = (
                    f"all {len(order)} scored grasps are below t = {s.threshold:g}; the best has {scored[0].score:.3f}"
                )
        sampled = [np.column_stack([u, v])]
        return finish(view, None, None, sampled, tuple(scored[i] for i in chosen), scored, reason, stages, weights)
