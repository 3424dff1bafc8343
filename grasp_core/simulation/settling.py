"""How objects come to rest on the table: stable poses of one object, and whole scenes that are let go."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from grasp_core.errors import GraspError
from grasp_core.objects.asset import ObjectAsset
from grasp_core.scene import Scene
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.world import World

_CALM = (0.002, 0.02)
"""m/s and rad/s below which, held for `_CALM_TIME`, a body counts as come to rest."""
_CALM_TIME = 0.1
_PATIENCE = 1.5
"""s of free motion after which speeds are bled by 1 % a step: a body without rolling friction may roll for ever."""
_AGAIN = 8
_LEVEL = 1e-3
"""A drop is let go again, so often at most, until its down direction changes by less than this many rad."""
_LONGEST = 6.0
"""s until a drop is given up."""
_CHECK_TIME = 0.5
_CHECK_SHIFT = 0.0005
_CHECK_TURN = math.radians(0.5)
"""A pose is at rest if, let go there, the object moves by less than this in that time."""
_SAME_TURN = math.radians(8)
_SAME_SHAPE = 0.02
"""Two poses are one if their down directions agree so well, or if turned about the vertical the posed shapes agree to
this share of the object's size (root mean square)."""


@dataclass(frozen=True)
class StablePose:
    """A pose in which the object rests on the table.

    Attributes:
        pose: 4×4, the object's origin above (0, 0), its lowest point on z = 0.
        probability: share of random drops that end so.
    """

    pose: NDArray[np.float64]
    probability: float


def _let_go(world: World, poses: Sequence[NDArray[np.float64]], longest: float) -> bool:
    """Step until every object is calm; False if that takes longer than `longest` seconds or the solver diverges."""
    world.rewind(poses)
    dt = world.physics.time_step
    calm = 0.0
    block = 10
    for count in range(int(longest / dt / block)):
        for _ in range(block):
            world.step()
        if world.diverged:
            return False
        if count * block * dt > _PATIENCE:
            for item in world.objects:
                item.skeleton.setVelocities(item.skeleton.getVelocities() * 0.99**block)
        speeds = [item.speed for item in world.objects]
        still = all(linear < _CALM[0] and angular < _CALM[1] for linear, angular in speeds)
        calm = calm + block * dt if still else 0.0
        if calm >= _CALM_TIME:
            return True
    return False


def _at_rest(world: World, poses: Sequence[NDArray[np.float64]]) -> bool:
    """Whether the objects stay where they are when let go at these poses."""
    world.rewind(poses)
    for _ in range(int(_CHECK_TIME / world.physics.time_step)):
        world.step()
    if world.diverged:
        return False
    for item, before in zip(world.objects, poses, strict=True):
        after = item.pose
        turn = Rotation.from_matrix(after[:3, :3] @ before[:3, :3].T).magnitude()
        if np.linalg.norm(after[:3, 3] - before[:3, 3]) > _CHECK_SHIFT or turn > _CHECK_TURN:
            return False
    return True


def _normalised(rotation: NDArray[np.float64], hull: NDArray[np.float64]) -> NDArray[np.float64]:
    """The pose of that tilt which turns least about the vertical from the source's axes, over (0, 0), on z = 0."""
    yaw = math.atan2(rotation[0, 1] - rotation[1, 0], rotation[0, 0] + rotation[1, 1])
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("z", yaw).as_matrix() @ rotation
    pose[2, 3] = -(hull @ pose[2, :3]).min()
    return pose


def _drop(world: World, rotation: NDArray[np.float64], hull: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Where the one object of a world ends if let go in an orientation (3×3); None if it does not come to rest.

    An impact leaves its contacts up to 2 mm deep, and DART pushes them out at no more than 1 mm/s: the object is put
    back on top of the table and let go again until it no longer moves.
    """
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[2, 3] = -(hull @ rotation[2]).min()
    for _ in range(_AGAIN):
        if not _let_go(world, [pose], _LONGEST):
            return None
        before, pose = pose, _normalised(world.objects[0].pose[:3, :3], hull)
        if math.acos(min(1.0, max(-1.0, float(before[2, :3] @ pose[2, :3])))) < _LEVEL:
            return pose
    return None


class _Shape:
    """Points on an object's surface, to tell whether two poses look the same but for a turn about the vertical."""

    def __init__(self, asset: ObjectAsset) -> None:
        merged = trimesh.util.concatenate([part.mesh for part in asset.parts])
        self._points = np.asarray(trimesh.sample.sample_surface(merged, 600, seed=0)[0])
        self._size = float(np.ptp(self._points, axis=0).max())
        yaws = np.arange(72) * 2 * math.pi / 72
        self._turns = Rotation.from_euler("z", yaws[:, None]).as_matrix()

    def alike(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
        """Whether the poses (4×4) show the same shape, turned about the vertical.

        The down direction alone would split a lying can into one pose per facet; footprint and height alone would
        confuse an upright with an inverted bowl.
        """
        if math.acos(min(1.0, max(-1.0, float(a[2, :3] @ b[2, :3])))) < _SAME_TURN:
            return True
        if abs(a[2, 3] - b[2, 3]) > _SAME_SHAPE * self._size:
            return False
        first = self._points @ a[:3, :3].T + a[:3, 3]
        second = self._points @ b[:3, :3].T + b[:3, 3]
        turned = np.einsum("tij,nj->tni", self._turns, second[::2])
        distances = cKDTree(first).query(turned.reshape(-1, 3))[0].reshape(len(self._turns), -1)
        spacing = cKDTree(first).query(first[::2], k=2)[0][:, 1]
        floor = math.sqrt(float((spacing**2).mean()))
        best = math.sqrt(float((distances**2).mean(axis=1).min()))
        return best < floor + _SAME_SHAPE * self._size


def stable_poses(
    asset: ObjectAsset,
    physics: Physics,
    *,
    drops: int = 60,
    seed: int = 0,
    least: float = 0.05,
) -> list[StablePose]:
    """The poses in which an object comes to rest when dropped at random, likeliest first.

    Each returned pose was checked: let go there, the object stays.

    Args:
        asset: the object.
        physics: of the world.
        drops: how many random orientations are let go just above the table.
        seed: of the orientations.
        least: poses of a smaller share of the drops are left out.

    Returns:
        At least one pose.

    Raises:
        GraspError: no drop came to rest in a pose that holds.
    """
    world = World([asset], physics, parts=False)
    shape = _Shape(asset)
    hull = np.asarray(asset.hull.vertices, float)
    found: list[tuple[NDArray[np.float64], int]] = []
    ended = 0
    quaternions = np.random.default_rng(seed).normal(size=(drops, 4))
    for rotation in Rotation.from_quat(quaternions).as_matrix():
        pose = _drop(world, rotation, hull)
        if pose is None:
            continue
        ended += 1
        for index, (known, count) in enumerate(found):
            if shape.alike(known, pose):
                found[index] = (known, count + 1)
                break
        else:
            found.append((pose, 1))
    found.sort(key=lambda item: -item[1])
    kept = []
    for pose, count in found:
        if count / ended >= least and _at_rest(World([asset], physics, poses=[pose]), [pose]):
            kept.append(StablePose(pose, count / ended))
    if not kept:
        raise GraspError(
            f"{asset.name}: none of {drops} drops came to rest in a pose that holds; raise drops or mend the mesh"
        )
    return kept


def settle(scene: Scene, physics: Physics, *, longest: float = 4.0) -> Scene:
    """Let all objects of a scene go and return the scene at rest.

    Raises:
        GraspError: they do not come to rest, or one falls off the table.
    """
    world = World([placed.asset for placed in scene.objects], physics)
    if not _let_go(world, [placed.world_from_object for placed in scene.objects], longest):
        raise GraspError(
            f"the scene's objects do not come to rest within {longest} s; move them apart or try a new scene"
        )
    for index, item in enumerate(world.objects):
        pose = item.pose
        if pose[2, 3] < 0:
            raise GraspError(f"object {index} ({item.asset.name}) fell off the table; place it nearer to the middle")
        scene = scene.moved(index, pose)
    return scene
