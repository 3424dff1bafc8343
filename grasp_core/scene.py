"""Scene: objects placed on the table, and the camera that looks at them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, canonical_camera, rigid
from grasp_core.objects.asset import ObjectAsset


@dataclass(frozen=True, eq=False)
class PlacedObject:
    """An object and its pose: `world_from_object`, 4×4, metres."""

    asset: ObjectAsset
    world_from_object: NDArray[np.float64]

    def __post_init__(self) -> None:
        object.__setattr__(self, "world_from_object", rigid(self.world_from_object, "world_from_object"))

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(V, 3) of the visual mesh in the world, metres."""
        pose = self.world_from_object
        return self.asset.vertices @ pose[:3, :3].T + pose[:3, 3]


@dataclass(frozen=True, eq=False)
class Scene:
    """Objects at rest on the table (z = 0) under a camera.

    Attributes:
        objects: the placed objects; a trial grasps whichever it meets, data generation has one.
        camera: what looks at them.
    """

    objects: tuple[PlacedObject, ...]
    camera: Camera

    @classmethod
    def single(cls, asset: ObjectAsset, world_from_object: NDArray[np.float64], camera: Camera | None = None) -> Scene:
        """One object at a pose, under the canonical camera unless told otherwise."""
        return cls((PlacedObject(asset, world_from_object),), camera or canonical_camera())

    def moved(self, index: int, world_from_object: NDArray[np.float64]) -> Scene:
        """The same scene with object `index` at another pose."""
        objects = list(self.objects)
        objects[index] = replace(objects[index], world_from_object=world_from_object)
        return replace(self, objects=tuple(objects))


def place(pose: NDArray[np.float64], x: float, y: float, yaw: float) -> NDArray[np.float64]:
    """A stable pose (4×4, resting on z = 0) turned by `yaw` rad about its own vertical through the object's origin and
    moved so that this origin stands above (x, y), metres."""
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    placed = np.eye(4)
    placed[:3, :3] = turn @ pose[:3, :3]
    placed[:3, 3] = [x, y, pose[2, 3]]
    return placed
