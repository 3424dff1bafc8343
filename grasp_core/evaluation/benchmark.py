"""What a success benchmark measures, and how; its settings decide which log a run goes on with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grasp_core import config
from grasp_core.camera import Camera
from grasp_core.errors import GraspError
from grasp_core.evaluation.records import Run
from grasp_core.evaluation.scenes import over_the_table
from grasp_core.evaluation.suites import Scale
from grasp_core.gripper import Gripper
from grasp_core.sensing.noise import ImageNoise
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.trial import GraspNoise

ORACLE = "oracle"
"""Name under which the ceiling runs beside the planners."""


@dataclass(frozen=True)
class Benchmark:
    """What is measured, and how.

    Attributes:
        objects: folder or suite.
        planners: names or settings files, "oracle" included.
        weights: of the planners with networks, name or path.
        camera: with or without a pose; without one it looks straight down from 0.70 m.
        gripper: what grasps.
        physics: of the attempts.
        scale: of the meshes of a folder.
        poses: stable poses an object, at most.
        draws: scenes a stable pose, each at another place and yaw.
        attempts: executions of each candidate.
        seed: of everything random.
        limit: at most so many scenes; the first pose of every object comes before the second of any.
        image_noise: Eq. 5.
        grasp_noise: Eq. 4.
    """

    objects: str
    planners: tuple[str, ...]
    camera: Camera
    gripper: Gripper
    physics: Physics
    weights: str = "default"
    scale: Scale = "keep"
    poses: int = 2
    draws: int = 1
    attempts: int = 5
    seed: int = 0
    limit: int | None = None
    image_noise: ImageNoise = field(default_factory=ImageNoise)
    grasp_noise: GraspNoise = field(default_factory=GraspNoise)

    def __post_init__(self) -> None:
        for name in ("poses", "draws", "attempts"):
            if getattr(self, name) < 1:
                raise GraspError(f"--{name} must be at least 1, not {getattr(self, name)}")
        if not self.planners:
            raise GraspError("name at least one planner with --planner")
        if self.limit is not None and self.limit < 1:
            raise GraspError(f"--limit must be at least 1, not {self.limit}")

    def run(self, identities: Mapping[str, str]) -> Run:
        """What a log of this benchmark begins with, for planners with these identities (`ImagePlanner.identity`)."""
        camera = over_the_table(self.camera)
        return Run(
            objects=self.objects,
            scale=str(self.scale),
            seed=self.seed,
            attempts=self.attempts,
            weights=self.weights,
            physics=self.physics.digest,
            gripper=self.gripper.digest,
            camera=config.digest(camera.intrinsics) + "-" + "/".join(f"{x:.6g}" for x in camera.pose[:3].ravel()),
            noise=f"{config.digest(self.image_noise)}-{config.digest(self.grasp_noise)}",
            planners=dict(identities),
        )
