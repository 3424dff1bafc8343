"""Recorder: collects the frames of an attempt while it runs, and draws those that need no dynamics."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.simulation.contacts import Touch
from grasp_core.simulation.engine import Engine
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.recording import PHASES, Recording

_FROM = 0.15
"""m above the grasp where the approach starts."""
_DESCENT = 0.3
"""m/s of the approach."""
_FRAME = 0.02
"""s between the frames that need no dynamics."""


def pose_rows(poses: Sequence[NDArray[np.float64]]) -> NDArray[np.float32]:
    """(B, 7) x y z qw qx qy qz of 4×4 poses."""
    stack = np.stack(poses)
    turns = Rotation.from_matrix(stack[:, :3, :3]).as_quat()
    return np.concatenate([stack[:, :3, 3], turns[:, [3, 0, 1, 2]]], axis=1).astype(np.float32)


class Recorder:
    """Frames of one attempt, in the order in which they are added."""

    def __init__(self, gripper: Gripper, grasp: Grasp, objects: Sequence[NDArray[np.float64]]) -> None:
        """Start with the objects at their poses (4×4 each) and nothing recorded."""
        self._gripper = gripper
        self._grasp = grasp
        self._start = pose_rows(objects)
        self._times: list[float] = []
        self._phases: list[int] = []
        self._poses: list[NDArray[np.float32]] = []
        self._fingers: list[tuple[float, float]] = []
        self._touches: list[tuple[int, Touch]] = []
        self._begun: float | None = None

    def _bodies(self, lift: float, travel: tuple[float, float]) -> NDArray[np.float32]:
        frame = self._grasp.world_from_gripper
        frame[2, 3] += lift
        boxes = self._gripper.boxes()
        poses = []
        for name in ("base", "rod", "left_finger", "right_finger"):
            centre = boxes[name][1].copy()
            if name == "left_finger":
                centre[0] += travel[0]
            if name == "right_finger":
                centre[0] -= travel[1]
            pose = frame.copy()
            pose[:3, 3] += frame[:3, :3] @ centre
            poses.append(pose)
        return pose_rows(poses)

    def _add(
        self, time: float, phase: str, objects: NDArray[np.float32], lift: float, travel: tuple[float, float]
    ) -> None:
        self._times.append(time)
        self._phases.append(PHASES.index(phase))
        self._poses.append(np.concatenate([objects, self._bodies(lift, travel)]))
        self._fingers.append(travel)

    def approach(self, stop: float) -> None:
        """The way straight down, to `stop` metres above the grasp."""
        opened = (self._gripper.opening - self._grasp.width) / 2
        start = max(_FROM, stop + 0.05)
        count = max(2, int((start - stop) / _DESCENT / _FRAME) + 1)
        for share in np.linspace(0.0, 1.0, count):
            height = start + (stop - start) * float(share)
            self._add((start - height) / _DESCENT, "approach", self._start, height, (opened, opened))

    def free_closing(self, way: float) -> None:
        """The fingers' free way before any contact, metres, at the gripper's speed."""
        opened = (self._gripper.opening - self._grasp.width) / 2
        begun = self._times[-1]
        for share in np.linspace(0.0, 1.0, max(1, int(way / self._gripper.speed / _FRAME)) + 1)[1:]:
            done = way * float(share)
            self._add(begun + done / self._gripper.speed, "close", self._start, 0.0, (opened + done, opened + done))

    def frame(self, engine: Engine, phase: str) -> None:
        """The state of the simulation now."""
        if self._begun is None:
            self._begun = self._times[-1]
        self._add(
            self._begun + engine.time,
            phase,
            pose_rows([item.pose for item in engine.objects]),
            engine.lift,
            engine.travel,
        )
        self._touches += [(len(self._times) - 1, touch) for touch in engine.touches()]

    def finish(self, outcome: Outcome, words: str) -> Recording:
        """Everything that was added."""
        names = (*(f"object_{i}" for i in range(len(self._start))), "base", "rod", "left_finger", "right_finger")
        count = len(self._touches)
        return Recording(
            names,
            np.array(self._times),
            np.array(self._phases, np.int8),
            np.stack(self._poses),
            np.array(self._fingers, np.float32),
            np.array([frame for frame, _ in self._touches], np.int32),
            np.array([touch.point for _, touch in self._touches], np.float32).reshape(count, 3),
            np.array([touch.force for _, touch in self._touches], np.float32).reshape(count, 3),
            np.array([touch.finger for _, touch in self._touches], np.int8),
            np.array([touch.object for _, touch in self._touches], np.int16),
            str(outcome),
            words,
        )
