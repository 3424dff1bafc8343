"""Whether verdicts depend on the engine: the same grasps in DART, in DART set up otherwise, and in MuJoCo."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.scene import Scene
from grasp_core.simulation.engine import Engine
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.execution import Execution
from grasp_core.simulation.mujoco_engine import MujocoEngine
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.precheck import Verdict
from grasp_core.simulation.recorder import Recorder
from grasp_core.simulation.recording import Recording
from grasp_core.simulation.trial import GraspTrial
from grasp_core.simulation.world import World

_GRID, _ANGLES = 21, 12
"""Positions along each side of the object's bounding rectangle and closing axes: twice as fine as the paper's."""
_DEPTH, _ABOVE = 0.03, 0.008
"""Metres: tips below the surface, and above the table at least."""


@dataclass(frozen=True)
class Kind:
    """A way to judge a grasp.

    Attributes:
        words: for people.
        goal: least share of grasps on which it should call success or failure as DART does.
        build: makes the engine from assets, poses, physics and gripper.
        whole: whether it always lifts the full height.
    """

    words: str
    goal: float
    build: Callable[[Scene, Physics, Gripper], Engine]
    whole: bool = False


def _dart(scene: Scene, physics: Physics, gripper: Gripper) -> Engine:
    poses = [placed.world_from_object for placed in scene.objects]
    return World([placed.asset for placed in scene.objects], physics, gripper, poses=poses)


def _half(scene: Scene, physics: Physics, gripper: Gripper) -> Engine:
    return _dart(scene, msgspec.structs.replace(physics, time_step=physics.time_step / 2), gripper)


def _fcl(scene: Scene, physics: Physics, gripper: Gripper) -> Engine:
    changed = msgspec.structs.replace(physics, detector="fcl", time_step=physics.time_step / 2)
    return _dart(scene, changed, gripper)


def _mujoco(scene: Scene, physics: Physics, gripper: Gripper) -> Engine:
    return MujocoEngine([placed.asset for placed in scene.objects], physics, gripper)


ENGINES: dict[str, Kind] = {
    "dart": Kind("DART as it is used", 1.0, _dart),
    "whole": Kind("the whole 30 cm instead of an early stop", 0.995, _dart, whole=True),
    "half": Kind("half the time step", 0.97, _half),
    "fcl": Kind("FCL's collision detector, at half the time step", 0.93, _fcl),
    "mujoco": Kind("MuJoCo", 0.90, _mujoco),
}
"""What can be compared; the first is what the others are compared with."""


def open_grasps(scene: Scene, gripper: Gripper, physics: Physics, count: int, seed: int) -> list[Grasp]:
    """Up to `count` random grasps of a fine grid on object 0 that need dynamics when executed without noise."""
    trial = GraspTrial(scene, gripper, physics, None)
    low, high = scene.objects[0].vertices.min(axis=0), scene.objects[0].vertices.max(axis=0)
    axes = [np.linspace(low[axis], high[axis], _GRID) for axis in (0, 1)]
    xy = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    z = np.maximum(trial.precheck.map.at(xy[:, 0], xy[:, 1])[1] - _DEPTH, _ABOVE)
    angles = np.arange(_ANGLES) * math.pi / _ANGLES
    rows = np.column_stack(
        [
            np.repeat(np.column_stack([xy, z]), _ANGLES, axis=0),
            np.tile(angles, len(xy)),
            np.full(len(xy) * _ANGLES, gripper.opening),
        ]
    )
    needs = np.flatnonzero(trial.precheck.check(rows).verdict == Verdict.OPEN)
    chosen = np.random.default_rng(seed).permutation(needs)[:count]
    return [Grasp((float(x), float(y), float(z)), float(angle), float(width)) for x, y, z, angle, width in rows[chosen]]


class Judge:
    """One engine on one scene."""

    def __init__(self, name: str, scene: Scene, gripper: Gripper, physics: Physics) -> None:
        """Build the engine `name`.

        Raises:
            GraspError: no such engine, or MuJoCo is not installed.
        """
        if name not in ENGINES:
            raise GraspError(f"'{name}' is no engine; choose from: {', '.join(ENGINES)}")
        self._kind = ENGINES[name]
        self._gripper = gripper
        self._trial = GraspTrial(scene, gripper, physics, None)
        self._poses = [placed.world_from_object for placed in scene.objects]
        self._execution = Execution(self._kind.build(scene, physics, gripper), self._poses)

    def verdict(self, grasp: Grasp) -> Outcome:
        """The outcome of a grasp executed as it is, the height map included."""
        verdict = self._trial.check(grasp)
        if verdict is not Verdict.OPEN:
            return Outcome.COLLISION if verdict is Verdict.COLLISION else Outcome.MISSED
        return self._execution.run(grasp, self._trial.free_way(grasp), whole=self._kind.whole, recorder=None)[0]

    def record(self, grasp: Grasp) -> Recording:
        """The grasp executed as it is, the full height, on film."""
        recorder = Recorder(self._gripper, grasp, self._poses)
        way = self._trial.free_way(grasp)
        recorder.approach(0.0)
        recorder.free_closing(way)
        outcome, evidence, _ = self._execution.run(grasp, way, whole=True, recorder=recorder)
        return recorder.finish(outcome, evidence.words)


class Agreement(msgspec.Struct, frozen=True):
    """How two engines agree.

    Attributes:
        count: grasps.
        agreement: share that both call a success, or both not.
        kappa: Cohen's κ of that.
        outcomes: share with the same outcome.
        confusion: "ONE→OTHER" → count.
    """

    count: int
    agreement: float
    kappa: float
    outcomes: float
    confusion: dict[str, int]


def agree(first: Sequence[str], second: Sequence[str]) -> Agreement:
    """Compare the outcomes of the same grasps.

    Raises:
        GraspError: no outcomes, or not equally many.
    """
    if not first or len(first) != len(second):
        raise GraspError(f"two engines are compared on the same grasps, not on {len(first)} and {len(second)}")
    a = np.array([outcome == Outcome.SUCCESS for outcome in first])
    b = np.array([outcome == Outcome.SUCCESS for outcome in second])
    same = float((a == b).mean())
    chance = float(a.mean() * b.mean() + (1 - a.mean()) * (1 - b.mean()))
    kappa = 1.0 if chance > 1 - 1e-12 else (same - chance) / (1 - chance)
    pairs = Counter(f"{x}→{y}" for x, y in zip(first, second, strict=True))
    equal = sum(x == y for x, y in zip(first, second, strict=True)) / len(first)
    return Agreement(len(first), round(same, 4), round(kappa, 4), round(equal, 4), dict(sorted(pairs.items())))


def correlation(first: Sequence[float], second: Sequence[float]) -> float:
    """Pearson's correlation of qualities; 1 where both are constant and equal."""
    a, b = np.asarray(first, float), np.asarray(second, float)
    if a.std() < 1e-12 or b.std() < 1e-12:
        return 1.0 if np.allclose(a, b) else 0.0
    return float(np.corrcoef(a, b)[0, 1])
