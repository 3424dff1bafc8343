"""The frame of every image-based planner: what it is told, how its proposals become a plan, and when it says no.

Planners of this kind differ only in `search`: which grasps they look at on the canonical view, and how they score them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, Generic, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.errors import GraspError
from grasp_core.gripper import Gripper
from grasp_core.networks.runtime import Runtime, load_runtime
from grasp_core.planning.candidates import Batch, PoseNoise, cleared, distinct, to_candidates
from grasp_core.planning.crops import crops
from grasp_core.planning.planner import Plan
from grasp_core.planning.result import begin, finish
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView, ViewSettings


class SearchSettings(config.Settings):
    """What all image-based planners can be told.

    Attributes:
        threshold: t, the least score of a candidate.
        candidates: n, at most returned.
        least_distance: between two candidates, metres, unless their angles differ.
        least_angle: between two candidates, rad, unless their positions differ.
        view: what may be grasped.
    """

    threshold: float = 0.0
    candidates: int = 10
    least_distance: float = 0.01
    least_angle: float = 0.26
    view: ViewSettings = ViewSettings()

    def __post_init__(self) -> None:
        if not 0 <= self.threshold <= 1:
            raise ValueError(f"threshold is from 0 to 1, not {self.threshold}")
        self.need_above_0("candidates")

    def need_above_0(self, *names: str) -> None:
        """Refuse values that are not above 0.

        Raises:
            ValueError: names the setting and its value.
        """
        for name in names:
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} must be above 0, not {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class Found:
    """What a search came to, in the pixels of the view's window.

    Attributes:
        batch: the grasps that were scored, in any order; of equal scores the first one counts as better.
        scores: (N,) in [0, 1].
        none: why nothing was scored, where the batch is empty.
        sampled: (K, 2) pixels (u, v) that were looked at.
        heat: the quality map (h, w), or None.
        region: (u, v, radius) that was searched last, or None.
    """

    batch: Batch
    scores: NDArray[np.floating]
    none: str
    sampled: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    heat: NDArray[np.float32] | None = None
    region: tuple[float, float, float] | None = None


S = TypeVar("S", bound=SearchSettings)


class ImagePlanner(ABC, Generic[S]):
    """See `Planner`.

    Attributes:
        gripper: whose grasps are planned.
        settings: of the search.
        weights: name and digest of the weights, "" without networks.
    """

    settings_type: ClassVar[type[SearchSettings]]
    weights: str = ""

    def __init__(self, gripper: Gripper, settings: S | None = None) -> None:
        self.gripper = gripper
        self.settings: S = settings or self.settings_type()  # type: ignore[assignment]

    @classmethod
    def make(cls, settings: S, gripper: Gripper, *, weights: str | Path, runtime: Runtime | None) -> Self:
        """The planner; one without networks needs neither weights nor runtime."""
        return cls(gripper, settings)

    @property
    def identity(self) -> str:
        """What plans follow from besides image and chance: kind, digest of the settings, name and digest of weights."""
        return f"{type(self).__name__} {config.digest(self.settings)} {self.weights}".rstrip()

    @abstractmethod
    def search(self, view: TableView, stages: Stages, rng: np.random.Generator) -> Found:
        """Look for grasps that the gripper can reach, and score them.

        Args:
            view: to plan on; it has places.
            stages: the clock, with what is left of the time.
            rng: all chance comes from it.
        """

    def __call__(
        self,
        image: DepthImage,
        *,
        mask: NDArray[np.bool_] | None = None,
        budget_ms: float | None = None,
        rng: np.random.Generator,
    ) -> Plan:
        """See `Planner`."""
        if budget_ms is not None and not budget_ms > 0:
            raise GraspError(f"budget_ms must be above 0 ms, not {budget_ms}; give no budget for no limit")
        s, stages = self.settings, Stages(budget_ms)
        view = begin(image, mask, s.view, stages, self.weights)
        if isinstance(view, Plan):
            return view
        found = self.search(view, stages, rng)
        with stages.stage("output"):
            columns, rows = found.batch.u.astype(int), found.batch.v.astype(int)
            heats = np.zeros(len(rows)) if found.heat is None else found.heat[rows, columns]
            order = np.lexsort((-heats, -found.scores))
            batch, scores = found.batch[order], found.scores[order]
            scored = to_candidates(batch, scores, heats[order], view, self.gripper)
            good = np.flatnonzero(scores >= s.threshold)
            apart = distinct(batch.position, batch.angle, good, s.least_distance, s.least_angle, s.candidates)
            chosen = tuple(scored[i] for i in apart.tolist())
            reason = None
            if not scored:
                reason = found.none
            elif not chosen:
                reason = f"all {len(scored)} scored grasps are below t = {s.threshold:g}; the best has {scores[0]:.3f}"
        return finish(view, found.heat, found.region, found.sampled, chosen, scored, reason, stages, self.weights)


class NetworkSettings(SearchSettings):
    """What planners whose scores are the Refined Network's can be told.

    Attributes:
        pose_noise: how far the robot strays from the pose that it is told.
    """

    threshold: float = 0.5
    pose_noise: PoseNoise = PoseNoise()


N = TypeVar("N", bound=NetworkSettings)


class NetworkPlanner(ImagePlanner[N]):
    """An image-based planner whose scores are the Refined Network's, `cleared` of tight places.

    The network sees crops of 3 mm pixels and holds tight places too good: of validation candidates that it gave 0.77 on
    average, but of whose surrounding poses less than 0.9 are free, half succeeded.

    Attributes:
        runtime: both networks.
    """

    def __init__(self, runtime: Runtime, gripper: Gripper, settings: N | None = None) -> None:
        """Put a planner together.

        Raises:
            MismatchError: the weights are for another gripper or view.
        """
        super().__init__(gripper, settings)
        runtime.meta.check(gripper)
        self.runtime = runtime
        self.weights = f"{runtime.meta.name} {runtime.digest}"

    @classmethod
    def make(cls, settings: N, gripper: Gripper, *, weights: str | Path, runtime: Runtime | None) -> Self:
        """The planner, with weights loaded unless there is a runtime."""
        return cls(runtime or load_runtime(weights, precision="auto"), gripper, settings)

    def judge(self, batch: Batch, view: TableView, stages: Stages, chunk: int) -> NDArray[np.float32]:
        """P(success) (M,) of the first M of a batch: all of them, or when time runs out those of the chunks till then.

        What the network alone holds below t stays so and is not looked at further.

        Args:
            batch: the grasps.
            view: that they lie on.
            stages: the clock.
            chunk: grasps that are scored at once.
        """
        scores: list[NDArray[np.float32]] = []
        for start in range(0, len(batch), chunk):
            if not stages.allows(stages.step_ms):
                break
            before = stages.elapsed_ms
            part = batch[start : start + chunk]
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
                found = self.runtime.scores(seen)
            with stages.stage("clearance"):
                s = self.settings
                scores.append(cleared(found, part, view, self.gripper, s.pose_noise, s.threshold))
            stages.step_ms = max(stages.step_ms, stages.elapsed_ms - before)
        return np.concatenate([*scores, np.zeros(0, np.float32)])
