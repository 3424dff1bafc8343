import math

import cv2
import numpy as np
import pytest
import trimesh

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, look_down
from grasp_core.gripper import Gripper, load_gripper
from grasp_core.networks.weights import Weights
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import PlacedObject, Scene, place
from grasp_core.sensing.renderer import render

VGA = CameraIntrinsics(525, 525, 319.5, 239.5, 640, 480)


class Clock:
    """Time that passes when it is told to, in place of the clock of the stages."""

    def __init__(self) -> None:
        self.now = 0.0

    def perf_counter(self) -> float:
        return self.now


class FakeRuntime:
    """Geometry in place of networks: heat is where something stands; a score says how narrow it is between free ends.

    Attributes:
        scored: sizes of the batches that were scored.
        delay: seconds that a batch takes on the clock.
    """

    def __init__(
        self, gripper: Gripper | None = None, factor: float = 1.0, delay: float = 0.0, clock: Clock | None = None
    ) -> None:
        gripper = gripper or load_gripper()
        self.meta = Weights(name="fake", gripper=gripper.name, gripper_digest=gripper.digest)
        self.digest = "0123"
        self.backend = "fake"
        self.factor = factor
        self.delay = delay
        self.clock = clock or Clock()
        self.scored: list[int] = []

    def quality_map(self, x: np.ndarray) -> np.ndarray:
        self.clock.now += self.delay
        return np.stack([cv2.GaussianBlur((image > 0.1).astype(np.float32), (0, 0), 6) for image in x])

    def scores(self, crops: np.ndarray) -> np.ndarray:
        self.scored.append(len(crops))
        self.clock.now += self.delay
        middle = crops[:, 16:32]
        free = np.minimum(middle[:, :, :7].min((1, 2)), middle[:, :, -7:].min((1, 2))) > 0
        filled = (middle < -0.05).mean(2)  # of every row across the closing axis
        score = 1 - 0.4 * filled.max(1) - 2 * np.ptp(filled, 1)
        return (self.factor * np.where(free, np.clip(score, 0.05, 1), 0.05)).astype(np.float32)


def box(x: float, y: float, size: tuple[float, float, float] = (0.14, 0.05, 0.05), yaw: float = 0.4) -> PlacedObject:
    mesh = trimesh.creation.box(extents=size)
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int32)
    asset = ObjectAsset("box", "test", vertices, faces, (Part(vertices, faces),), mesh.volume, np.eye(3))
    pose = np.eye(4)
    pose[2, 3] = size[2] / 2
    return PlacedObject(asset, place(pose, x, y, yaw))


def photograph(*objects: PlacedObject, height: float = 0.70, tilt: float = 0.0, yaw: float = 0.0) -> DepthImage:
    """A clean image of things on the table, from a camera that looks at the origin and is turned by `yaw`."""
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
    camera = Camera(VGA, turn @ look_down(height, tilt=tilt))
    return render(Scene(tuple(objects), camera))


@pytest.fixture
def make_box():
    return box


@pytest.fixture
def photo():
    return photograph


@pytest.fixture
def make_runtime():
    return FakeRuntime


@pytest.fixture
def clock(monkeypatch):
    own = Clock()
    monkeypatch.setattr("grasp_core.planning.stages.time", own)
    return own


@pytest.fixture
def rng():
    return np.random.default_rng(0)
