"""What the worker process is asked for and what it answers: plain values that travel between processes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.planning.planner import Plan
from grasp_core.scene import Scene
from grasp_core.simulation.recording import Recording

Judgement = Literal["good", "bad"]
Layer = Literal["candidates", "camera", "contacts"]
LAYERS: tuple[Layer, ...] = ("candidates", "camera", "contacts")
"""What can be switched on and off in the scene."""


@dataclass(frozen=True)
class SceneRequest:
    """A scene that can be made again from these values alone.

    Attributes:
        family: of the parametric object.
        shape: seed of its shape.
        pose: which of its stable poses, counted from the most probable; wraps around.
        place: seed of where it stands and how it is turned.
        planner: name of the planner.
    """

    family: str
    shape: int
    pose: int
    place: int
    planner: str


@dataclass(frozen=True)
class Catalogue:
    """What there is.

    Attributes:
        families: of parametric objects.
        planners: names.
        gripper: that plans and trials use.
        attempts: in a trial.
    """

    families: tuple[str, ...]
    planners: tuple[str, ...]
    gripper: Gripper
    attempts: int


@dataclass(frozen=True)
class OpenedScene:
    """A scene with its image and plan.

    Attributes:
        request: that it was made from, with `pose` wrapped into range.
        scene: the placed object under its camera.
        poses: how many stable poses the object has.
        probability: of this one.
        rests: all stable poses, 4×4, with their probabilities.
        clean: the exact depth image.
        image: what the camera saw, noise included.
        plan: of the planner.
        stages_ms: stage → milliseconds of everything before the plan.
    """

    request: SceneRequest
    scene: Scene
    poses: int
    probability: float
    rests: tuple[tuple[NDArray[np.float64], float], ...]
    clean: DepthImage
    image: DepthImage
    plan: Plan
    stages_ms: dict[str, float]


@dataclass(frozen=True)
class Try:
    """One DART attempt, as the workbench shows it.

    Attributes:
        number: in its trial, from 0.
        outcome: name of the outcome.
        words: what happened and why, one sentence.
        seed: of the attempt's noise.
        executed: the pose that was really executed.
        moved: how far the object moved in the gripper, metres and rad, or None.
        dynamic: whether the physics engine was needed for the verdict.
        redraws: how many diverging runs were drawn again before this one.
        evidence: JSON of what was seen, for dynamic attempts.
        recording: of every body, where it was asked for.
    """

    number: int
    outcome: str
    words: str
    seed: int
    executed: Grasp
    moved: tuple[float, float] | None
    dynamic: bool
    redraws: int
    evidence: str | None
    recording: Recording | None
