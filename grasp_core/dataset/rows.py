"""What a dataset's rows look like in Python: small frozen records and the arrays of one scene's grasps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, CameraIntrinsics
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp

Split = Literal["train", "validation", "test"]
SPLITS: tuple[Split, ...] = ("train", "validation", "test")
Origin = Literal["grid", "person", "planner", "import"]
Executed = tuple[float, float, float, float]


class Meta(msgspec.Struct, frozen=True, kw_only=True):
    """What a dataset was made with.

    Attributes:
        name: for people.
        gripper: settings of the gripper, as JSON values.
        gripper_digest: a hash of what matters of them.
        physics: settings of the physics.
        physics_digest: a hash of them.
        recipe: settings of the recipe.
        recipe_digest: a hash of them.
        code_version: of grasp-workbench when the dataset was created.
        weights: digest of the weights whose scores `samples` shows, or none.
    """

    name: str
    gripper: dict
    gripper_digest: str
    physics: dict
    physics_digest: str
    recipe: dict
    recipe_digest: str
    code_version: str
    weights: str | None = None


class ObjectRow(msgspec.Struct, frozen=True):
    """One object of a dataset; its geometry comes from `DatasetStore.object`."""

    id: int
    name: str
    category: str
    split: Split
    digest: str
    file: str
    source: str


class SceneRow(msgspec.Struct, frozen=True):
    """One scene of a dataset: an object at rest, seen by a camera.

    Attributes:
        id: in this copy of the dataset; other copies may number otherwise.
        name: the same in every copy.
        object: name of the object.
        category: of the object.
        split: of the object.
        pose: number of the object's stable pose.
        seed: that yaw and attempts were drawn from.
        grasps: how many it has.
        best: the highest quality among them, None without attempts.
    """

    id: int
    name: str
    object: str
    category: str
    split: Split
    pose: int
    seed: int
    grasps: int
    best: float | None


class StoredPose(msgspec.Struct, frozen=True):
    """A stable pose of an object: 16 numbers of the 4×4 row by row (resting on z = 0), and its probability."""

    values: tuple[float, ...]
    probability: float

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The pose, 4×4."""
        return np.array(self.values).reshape(4, 4)


class AttemptRow(msgspec.Struct, frozen=True):
    """One stored attempt.

    Attributes:
        outcome: name of the outcome.
        seed: that the noise of Eq. 4 was drawn from.
        executed: x, y, z in metres and angle in rad of the pose that was really executed.
        dynamic: whether the physics engine was needed for the verdict.
        redraws: how many diverging runs were drawn again before this one.
        comfort: how far the object moved in the gripper, metres and rad, or None.
        evidence: JSON of what was seen, for dynamic attempts.
        event: the label event that asked for it, None for those made with the scene.
    """

    outcome: str
    seed: int
    executed: Executed
    dynamic: bool = False
    redraws: int = 0
    comfort: tuple[float, float] | None = None
    evidence: str | None = None
    event: int | None = None


class GraspRow(msgspec.Struct, frozen=True):
    """One stored grasp with its current label.

    Attributes:
        id: in this copy.
        scene: id of its scene.
        number: in the scene, the same in every copy.
        grasp: the grasp in the world.
        origin: who made it.
        person: name, for people's own.
        parent: id of the grasp it was edited from.
        attempts: how many have a verdict.
        successes: of them.
        quality: successes / attempts, None without attempts.
        label: what training uses, None leaves the sample out.
        state: labelled, unlabelled, unsure or excluded.
        source: where the label comes from: none, dart or human.
        flagged: somebody marked it.
        last_event: id of its newest label event, None without one.
        score: of the weights in use, None where not computed.
        heat: of the same.
    """

    id: int
    scene: int
    number: int
    grasp: Grasp
    origin: Origin
    person: str | None
    parent: int | None
    attempts: int
    successes: int
    quality: float | None
    label: float | None
    state: str
    source: str
    flagged: bool
    last_event: int | None
    score: float | None
    heat: float | None


@dataclass(frozen=True)
class GraspTable:
    """All grasps of one scene as arrays of length N, in the order of their numbers.

    Attributes:
        id: (N,) int64.
        number: (N,) int64.
        position: (N, 3) of p in the world, metres.
        angle: (N,) rad in [−π/2, π/2).
        width: (N,) metres.
        attempts: (N,) int64, those with a verdict.
        successes: (N,) int64.
        collisions: (N,) int64.
        missed: (N,) int64.
        slipped: (N,) int64.
        quality: (N,) successes / attempts, NaN without attempts.
        label: (N,) what training uses, NaN where the sample is left out.
        human: (N,) bool, the label is a person's decision.
        score: (N,) of the weights in use, NaN where not computed.
        heat: (N,) of the same.
    """

    id: NDArray[np.int64]
    number: NDArray[np.int64]
    position: NDArray[np.float64]
    angle: NDArray[np.float64]
    width: NDArray[np.float64]
    attempts: NDArray[np.int64]
    successes: NDArray[np.int64]
    collisions: NDArray[np.int64]
    missed: NDArray[np.int64]
    slipped: NDArray[np.int64]
    quality: NDArray[np.float64]
    label: NDArray[np.float64]
    human: NDArray[np.bool_]
    score: NDArray[np.float64]
    heat: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.id)

    @property
    def used(self) -> NDArray[np.bool_]:
        """(N,) true where training uses the sample."""
        return np.isfinite(self.label)

    def grasp(self, index: int) -> Grasp:
        """Row `index` as a grasp."""
        x, y, z = map(float, self.position[index])
        return Grasp((x, y, z), float(self.angle[index]), float(self.width[index]))

    def __iter__(self) -> Iterator[Grasp]:
        return (self.grasp(index) for index in range(len(self)))


def pose_json(pose: NDArray[np.float64]) -> str:
    """4×4 → JSON text of its 16 numbers, exact."""
    return msgspec.json.encode([float(value) for value in np.asarray(pose, float).reshape(16)]).decode()


def pose_from_json(text: str) -> NDArray[np.float64]:
    """Inverse of `pose_json`.

    Raises:
        StoreError: not 16 numbers.
    """
    try:
        values = msgspec.json.decode(text, type=list[float])
        return np.array(values, float).reshape(4, 4)
    except (msgspec.DecodeError, ValueError) as error:
        raise StoreError(f"a stored pose is no 4×4 matrix ({error}); restore a backup") from error


class _CameraJson(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int
    distortion: tuple[float, float, float, float, float] | None = None
    world_from_camera: list[list[float]] | None = None


def camera_json(camera: Camera) -> str:
    """A camera as JSON with the keys of a camera file."""
    k = camera.intrinsics
    pose = None if camera.world_from_camera is None else camera.pose.tolist()
    value = _CameraJson(
        fx=k.fx,
        fy=k.fy,
        cx=k.cx,
        cy=k.cy,
        width=k.width,
        height=k.height,
        distortion=k.distortion,
        world_from_camera=pose,
    )
    return msgspec.json.encode(value, order="sorted").decode()


def camera_from_json(text: str) -> Camera:
    """Inverse of `camera_json`.

    Raises:
        StoreError: the text is no camera.
    """
    try:
        value = msgspec.json.decode(text, type=_CameraJson)
    except msgspec.DecodeError as error:
        raise StoreError(f"a stored camera cannot be read ({error}); restore a backup") from error
    intrinsics = CameraIntrinsics(value.fx, value.fy, value.cx, value.cy, value.width, value.height, value.distortion)
    return Camera(intrinsics, None if value.world_from_camera is None else np.array(value.world_from_camera, float))
